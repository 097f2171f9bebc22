//! The two directions in which a structure sways. Everything is computed in a frame in which the sway goes right;
//! a sway to the left is the same seen in a mirror.

use crate::mechanics::geometry::ring::Ring;

named! {
    /// Direction in which a mechanism carries the structure.
    pub enum Sway {
        /// Towards +x, as started by a ground acceleration towards -x.
        Right = "right",
        /// Towards -x, as started by a ground acceleration towards +x.
        Left = "left",
    }
}

impl Sway {
    /// The other direction.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }

    /// The side to which a horizontal ground acceleration pushes a structure: against it.
    #[must_use]
    pub fn pushed_by(ground_acceleration: f64) -> Self {
        if ground_acceleration.is_sign_negative() {
            Self::Right
        } else {
            Self::Left
        }
    }

    /// +1 to the right, -1 to the left: the sign of x in the frame in which this sway goes right.
    #[must_use]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Right => 1.0,
            Self::Left => -1.0,
        }
    }

    /// Angle of a section from the left springing, from its angle in the frame in which this sway goes
    /// right, or the other way round.
    #[must_use]
    pub fn from_left_rad(self, ring: &Ring, angle_rad: f64) -> f64 {
        match self {
            Self::Right => angle_rad,
            Self::Left => ring.embrace_rad() - angle_rad,
        }
    }
}
