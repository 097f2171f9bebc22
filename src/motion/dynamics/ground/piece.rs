//! Pieces of ground motion.

use nalgebra::Vector2;

use super::shape::Waveform;
use crate::mechanics::mirrored;

/// One-sided formula of a piece in the time since its origin, for both components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Formula {
    /// Linear acceleration: value at the origin, and slope.
    Linear(Vector2<f64>, Vector2<f64>),
    /// Amplitude times a shape.
    Shaped(Vector2<f64>, Waveform),
}

impl Formula {
    pub fn constant(acceleration: Vector2<f64>) -> Self {
        Self::Linear(acceleration, Vector2::zeros())
    }

    /// Formula times a factor.
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Linear(at_origin, slope) => Self::Linear(at_origin * factor, slope * factor),
            Self::Shaped(amplitude, shape) => Self::Shaped(amplitude * factor, shape),
        }
    }

    /// Formula with the opposite horizontal acceleration.
    pub fn mirrored(self) -> Self {
        match self {
            Self::Linear(at_origin, slope) => Self::Linear(mirrored(at_origin), mirrored(slope)),
            Self::Shaped(amplitude, shape) => Self::Shaped(mirrored(amplitude), shape),
        }
    }

    /// Acceleration and its rate of change.
    pub fn acceleration_and_rate(&self, since_s: f64) -> (Vector2<f64>, Vector2<f64>) {
        match *self {
            Self::Linear(at_origin, slope) => (at_origin + slope * since_s, slope),
            Self::Shaped(amplitude, shape) => {
                let (value, rate) = shape.value_and_rate(since_s);
                (amplitude * value, amplitude * rate)
            }
        }
    }

    /// Integral of the acceleration between two times.
    fn integral(&self, from_s: f64, to_s: f64) -> Vector2<f64> {
        match *self {
            Self::Linear(at_origin, slope) => {
                (at_origin + slope * (0.5 * (from_s + to_s))) * (to_s - from_s)
            }
            Self::Shaped(amplitude, shape) => amplitude * shape.integral(from_s, to_s),
        }
    }
}

/// Piece of ground motion: smooth, and every linear combination of its components is monotone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundPiece {
    /// Start, in seconds.
    pub start_s: f64,
    /// End, in seconds; infinite for the last piece.
    pub end_s: f64,
    /// Origin of the formula's time, in seconds.
    pub(super) origin_s: f64,
    pub(super) formula: Formula,
}

impl GroundPiece {
    /// Change of the ground velocity from the start of the piece to a time in it, in m/s.
    pub(crate) fn velocity_gained_m_s(&self, time_s: f64) -> Vector2<f64> {
        let (from_s, to_s) = (self.start_s - self.origin_s, time_s - self.origin_s);
        self.formula.integral(from_s, to_s)
    }

    /// Acceleration in m/s2 and its rate of change in m/s3, horizontal and vertical (positive to the right and upwards), at a time in the
    /// piece. At its ends the values are limits from inside.
    pub fn acceleration_and_rate(&self, time_s: f64) -> (Vector2<f64>, Vector2<f64>) {
        self.formula.acceleration_and_rate(time_s - self.origin_s)
    }

    /// Horizontal acceleration in m/s2, as [`GroundPiece::acceleration_and_rate`].
    pub fn acceleration_m_s2(&self, time_s: f64) -> f64 {
        self.acceleration_and_rate(time_s).0.x
    }

    /// Whether the piece is the last one, with zero acceleration from here on.
    pub fn stays_still(&self) -> bool {
        self.end_s == f64::INFINITY
    }

    /// Whether the acceleration is zero in the whole piece.
    pub(crate) fn is_quiet(&self) -> bool {
        self.ends_m_s2() == [Vector2::zeros(); 2]
    }

    /// Longest step that resolves the shape of the piece, in seconds.
    pub fn longest_step_s(&self) -> f64 {
        match self.formula {
            Formula::Linear(..) => f64::INFINITY,
            Formula::Shaped(..) => 0.25 * (self.end_s - self.start_s),
        }
    }

    /// Accelerations at both ends, which bound those in between.
    pub(crate) fn ends_m_s2(&self) -> [Vector2<f64>; 2] {
        if self.stays_still() {
            [Vector2::zeros(); 2]
        } else {
            [self.start_s, self.end_s].map(|time_s| self.acceleration_and_rate(time_s).0)
        }
    }
}
