//! Pieces of ground motion.

use nalgebra::Vector2;

use super::shape::Shape;

/// One-sided formula of a piece in the time since its origin, horizontal and vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Formula {
    /// A straight line: its acceleration at the origin, and its slope.
    Linear(Vector2<f64>, Vector2<f64>),
    /// An amplitude times a shape.
    Shaped(Vector2<f64>, Shape),
}

impl Formula {
    pub fn constant(acceleration: Vector2<f64>) -> Self {
        Self::Linear(acceleration, Vector2::zeros())
    }

    /// The formula times a factor.
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Linear(at_origin, slope) => Self::Linear(at_origin * factor, slope * factor),
            Self::Shaped(amplitude, shape) => Self::Shaped(amplitude * factor, shape),
        }
    }

    /// Acceleration and its rate of change.
    pub fn at(&self, since_s: f64) -> (Vector2<f64>, Vector2<f64>) {
        match *self {
            Self::Linear(at_origin, slope) => (at_origin + slope * since_s, slope),
            Self::Shaped(amplitude, shape) => {
                let (value, rate) = shape.at(since_s);
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

/// A piece of ground motion: smooth, and every combination of its components monotone, from its start to
/// its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Start, in seconds.
    pub start_s: f64,
    /// End, in seconds; infinite for the last piece.
    pub end_s: f64,
    /// Time that the formula counts from.
    pub(super) origin_s: f64,
    pub(super) formula: Formula,
}

impl Piece {
    /// Change of the velocity of the ground from the start of the piece to a time in it, in m/s: the integral of
    /// the acceleration.
    pub fn velocity_gained_m_s(&self, time_s: f64) -> Vector2<f64> {
        let (from_s, to_s) = (self.start_s - self.origin_s, time_s - self.origin_s);
        self.formula.integral(from_s, to_s)
    }

    /// Acceleration in m/s2 and its rate of change in m/s3, both horizontal and vertical (positive to the
    /// right and upwards), at a time in the piece, the ends included, as the limit from inside.
    #[must_use]
    pub fn at(&self, time_s: f64) -> (Vector2<f64>, Vector2<f64>) {
        self.formula.at(time_s - self.origin_s)
    }

    /// Horizontal acceleration in m/s2, as [`Piece::at`].
    #[must_use]
    pub fn acceleration_m_s2(&self, time_s: f64) -> f64 {
        self.at(time_s).0.x
    }

    /// Whether the acceleration is zero from here on.
    #[must_use]
    pub fn stays_still(&self) -> bool {
        self.end_s == f64::INFINITY
    }

    /// Whether the acceleration is zero throughout.
    pub fn is_quiet(&self) -> bool {
        self.ends_m_s2() == [Vector2::zeros(); 2]
    }

    /// Longest step that resolves the shape of the piece.
    #[must_use]
    pub fn longest_step_s(&self) -> f64 {
        match self.formula {
            Formula::Linear(..) => f64::INFINITY,
            Formula::Shaped(..) => 0.25 * (self.end_s - self.start_s),
        }
    }

    /// The accelerations at both ends, which bound those in between.
    pub fn ends_m_s2(&self) -> [Vector2<f64>; 2] {
        if self.stays_still() {
            [Vector2::zeros(); 2]
        } else {
            [self.start_s, self.end_s].map(|time_s| self.at(time_s).0)
        }
    }
}
