//! The two directions in which a structure sways. Everything is computed in a frame in which the sway goes right;
//! a sway to the left is the same seen in a mirror.

use crate::mechanics::geometry::profile::Profile;

named! {
    /// Direction in which a mechanism carries the structure.
    #[derive(Default, PartialOrd, Ord)]
    pub enum Sway {
        #[default]
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

    /// The side to which it swayed that many impacts earlier: every impact changes the side.
    #[must_use]
    pub const fn before(self, impacts: usize) -> Self {
        if impacts.is_multiple_of(2) {
            self
        } else {
            self.opposite()
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

    /// Converts a section counted in the frame in which this sway goes right to one counted from the left
    /// springing, or the other way round: an angle in radians, or a joint.
    #[must_use]
    pub fn from_left(self, profile: &dyn Profile, section: f64) -> f64 {
        match self {
            Self::Right => section,
            Self::Left => profile.end() - section,
        }
    }
}
