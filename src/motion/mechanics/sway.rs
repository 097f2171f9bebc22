//! Directions in which a structure sways. Everything is computed in a frame in which the sway goes right; a sway to the left is reflected.

use nalgebra::Vector2;

use crate::mechanics::Profile;

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
    pub const fn opposite(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }

    /// Side of the sway `impacts` impacts later or earlier, if every impact changes the side.
    pub const fn after(self, impacts: usize) -> Self {
        if impacts.is_multiple_of(2) {
            self
        } else {
            self.opposite()
        }
    }

    /// +1 to the right and -1 to the left: the sign of x in the frame in which this sway goes right.
    pub const fn sign(self) -> f64 {
        match self {
            Self::Right => 1.0,
            Self::Left => -1.0,
        }
    }

    /// Converts a vector from the frame in which this sway goes right to the frame of the ground, or back.
    pub fn seen(self, vector: Vector2<f64>) -> Vector2<f64> {
        Vector2::new(self.sign() * vector.x, vector.y)
    }

    /// Converts a section from the frame in which this sway goes right to the frame of the ground, or back. A section is an angle in radians from the
    /// left springing, or a joint.
    pub fn convert_section(self, profile: &dyn Profile, section: f64) -> f64 {
        match self {
            Self::Right => section,
            Self::Left => profile.end() - section,
        }
    }
}
