//! Right support of a row with rigid joints on feet that move differently: a body with prescribed motion relative to the left support.
//!
//! In a step the support moves at the mean velocity between its two positions, so that joints follow it exactly. At an instant, as in an impact, it
//! has its velocity at this time. Its work is the impulse on it times the mean of its velocities before and after. The energy of the blocks follows
//! the same rule, so the energies balance.

use nalgebra::Vector2;

use crate::dynamics::GroundMotion;
use crate::dynamics::ground::FeetApart;
use crate::mechanics::{Pose, Row};

/// Right support with prescribed motion.
#[derive(Default)]
pub(super) struct RightSupport<'a> {
    /// Relative motion of the feet; `None` if both feet move alike, or the row has only one.
    feet: Option<FeetApart<'a>>,
    /// Displacement relative to the left support, in metres.
    pub displacement_m: Vector2<f64>,
    /// Displacement at which the joints last followed the support, in metres. Movements too small to open a joint accumulate.
    pub joint_displacement_m: Vector2<f64>,
    /// Velocity in the last step or after the last impact, then the velocity in the current solution.
    pub velocity_m_s: Vector2<f64>,
    pub solution_m_s: Vector2<f64>,
}

impl<'a> RightSupport<'a> {
    pub fn new(row: &Row, ground: &'a GroundMotion) -> Self {
        Self {
            feet: FeetApart::of(row, ground),
            ..Self::default()
        }
    }

    /// Whether the right support ever moves relative to the left one.
    pub const fn moves(&self) -> bool {
        self.feet.is_some()
    }

    /// Current poses of both supports for given initial poses.
    pub fn poses(&self, stood: &[Pose; 2]) -> [Pose; 2] {
        let [left, mut right] = *stood;
        right.translation += self.displacement_m;
        [left, right]
    }

    /// Prescribes the mean velocity over a step that starts at `from_s` for the current solution.
    pub fn prescribe_mean_velocity(&mut self, from_s: f64, lasts_s: f64) {
        if let Some(feet) = &self.feet {
            self.solution_m_s =
                (feet.displacement_at(from_s + lasts_s) - self.joint_displacement_m) / lasts_s;
        }
    }

    /// Prescribes the velocity at an instant for the current solution.
    pub fn prescribe_velocity_at(&mut self, time_s: f64) {
        if let Some(feet) = &self.feet {
            self.solution_m_s = feet.velocity_m_s(time_s);
        }
    }

    /// Mean of the velocities in the last step and in the current solution.
    pub fn mean_m_s(&self) -> Vector2<f64> {
        (self.velocity_m_s + self.solution_m_s) * 0.5
    }

    /// Moves the right support to its position at `time_s`.
    pub fn move_to(&mut self, time_s: f64) {
        if let Some(feet) = &mut self.feet {
            self.displacement_m = feet.advance_to(time_s);
        }
    }
}
