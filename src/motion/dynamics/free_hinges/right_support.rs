//! The right support of a row with rigid joints on feet that move differently: a body whose motion beside the left support is
//! prescribed.
//!
//! Over a step it moves at the mean velocity that brings it where it has to be, so that joints follow it exactly; at an instant, as at an
//! impact, at its velocity then. Its work is the impulse that it takes, times the mean of its velocities before and after: with what the
//! blocks gain by the same rule this leaves no energy over.

use nalgebra::Vector2;

use crate::dynamics::ground::{FeetApart, GroundMotion};
use crate::mechanics::blocks::Row;
use crate::mechanics::geometry::pose::Pose;

/// The right support.
pub(super) struct RightSupport<'a> {
    /// `None` where both feet move alike, and of a row with only one.
    feet: Option<FeetApart<'a>>,
    /// How far it has gone away from where it was beside the left one.
    pub gone_m: Vector2<f64>,
    /// How far it had gone when the joints last followed it: movements that are too small to open a joint add up.
    followed_m: Vector2<f64>,
    /// Its velocity over the last step or after the last impact, and in the present solution.
    velocity_m_s: Vector2<f64>,
    pub next_m_s: Vector2<f64>,
}

impl<'a> RightSupport<'a> {
    pub fn new(row: &Row, ground: &'a GroundMotion) -> Self {
        Self {
            feet: FeetApart::of(row, ground),
            gone_m: Vector2::zeros(),
            followed_m: Vector2::zeros(),
            velocity_m_s: Vector2::zeros(),
            next_m_s: Vector2::zeros(),
        }
    }

    /// Whether it moves beside the left one at all.
    pub const fn moves(&self) -> bool {
        self.feet.is_some()
    }

    /// Whether it is farther than this from where it was.
    pub fn is_gone(&self, least_m: f64) -> bool {
        self.moves() && self.gone_m.norm() > least_m
    }

    /// Positions of supports that stood there.
    pub fn poses(&self, stood: &[Pose; 2]) -> [Pose; 2] {
        let [left, mut right] = *stood;
        right.translation += self.gone_m;
        [left, right]
    }

    /// The present solution is that of a step from this time on.
    pub fn step(&mut self, from_s: f64, lasts_s: f64) {
        if let Some(feet) = &self.feet {
            self.next_m_s = (feet.ahead(from_s + lasts_s) - self.followed_m) / lasts_s;
        }
    }

    /// The present solution is that of an instant.
    pub fn stop_at(&mut self, time_s: f64) {
        if let Some(feet) = &self.feet {
            self.next_m_s = feet.velocity_m_s(time_s);
        }
    }

    /// The mean of its velocities before and in the present solution.
    pub fn mean_m_s(&self) -> Vector2<f64> {
        (self.velocity_m_s + self.next_m_s) * 0.5
    }

    /// The present solution becomes that of the motion.
    pub const fn take(&mut self) {
        self.velocity_m_s = self.next_m_s;
    }

    /// Moves to its position at a time.
    pub fn go(&mut self, time_s: f64) {
        if let Some(feet) = &mut self.feet {
            self.gone_m = feet.at(time_s);
        }
    }

    /// The joints have followed it.
    pub const fn is_followed(&mut self) {
        self.followed_m = self.gone_m;
    }
}
