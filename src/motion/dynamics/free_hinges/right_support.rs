//! The right support of a row with rigid joints on feet that move differently: a body whose motion relative to the left support
//! is prescribed.
//!
//! Over a step it moves at the mean velocity between its positions, so that joints follow it exactly. At an instant, as at an impact, it
//! moves at its velocity then. Its work is the impulse on it, times the mean of its velocities before and after. The energy of the
//! blocks follows the same rule, so both balance.

use nalgebra::Vector2;

use crate::dynamics::ground::{FeetApart, GroundMotion};
use crate::mechanics::blocks::Row;
use crate::mechanics::geometry::pose::Pose;

/// The right support.
#[derive(Default)]
pub(super) struct RightSupport<'a> {
    /// `None` if both feet move alike, or the row has only one.
    feet: Option<FeetApart<'a>>,
    /// Its displacement relative to the left support, in metres.
    pub gone_m: Vector2<f64>,
    /// That displacement when the joints last followed it: movements too small to open a joint add up.
    pub followed_m: Vector2<f64>,
    /// Its velocity over the last step or after the last impact, and in the present solution.
    pub velocity_m_s: Vector2<f64>,
    pub next_m_s: Vector2<f64>,
}

impl<'a> RightSupport<'a> {
    pub fn new(row: &Row, ground: &'a GroundMotion) -> Self {
        Self {
            feet: FeetApart::of(row, ground),
            ..Self::default()
        }
    }

    /// True if it ever moves relative to the left one.
    pub const fn moves(&self) -> bool {
        self.feet.is_some()
    }

    /// Positions of the supports, from their initial ones.
    pub fn poses(&self, stood: &[Pose; 2]) -> [Pose; 2] {
        let [left, mut right] = *stood;
        right.translation += self.gone_m;
        [left, right]
    }

    /// Takes the velocity over a step from this time, for the present solution.
    pub fn step(&mut self, from_s: f64, lasts_s: f64) {
        if let Some(feet) = &self.feet {
            self.next_m_s = (feet.ahead(from_s + lasts_s) - self.followed_m) / lasts_s;
        }
    }

    /// Takes the velocity at an instant, for the present solution.
    pub fn stop_at(&mut self, time_s: f64) {
        if let Some(feet) = &self.feet {
            self.next_m_s = feet.velocity_m_s(time_s);
        }
    }

    /// The mean of its velocities before and in the present solution.
    pub fn mean_m_s(&self) -> Vector2<f64> {
        (self.velocity_m_s + self.next_m_s) * 0.5
    }

    /// Moves to its position at a time.
    pub fn go(&mut self, time_s: f64) {
        if let Some(feet) = &mut self.feet {
            self.gone_m = feet.at(time_s);
        }
    }
}
