//! Where a rigid body is.

use nalgebra::{Rotation2, Vector2};

/// Position of a rigid body relative to where it is in the undeformed structure: it is turned about the
/// origin, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Rotation in radians, positive anticlockwise.
    pub rotation_rad: f64,
    /// Displacement of the body's point at the origin, in the unit of length of the structure that gives
    /// the pose; metres in a [`Sample`](crate::dynamics::history::Sample).
    pub translation: Vector2<f64>,
}

impl Pose {
    /// Undeformed.
    pub const UNDEFORMED: Self = Self {
        rotation_rad: 0.0,
        translation: Vector2::new(0.0, 0.0),
    };

    /// Turned by `rotation_rad` about the point `pole` of the body, which moves to `moved`.
    #[must_use]
    pub fn about(pole: Vector2<f64>, moved: Vector2<f64>, rotation_rad: f64) -> Self {
        Self {
            // Adding zero makes a negative zero positive.
            rotation_rad: rotation_rad + 0.0,
            translation: moved - Rotation2::new(rotation_rad) * pole,
        }
    }

    /// Where a point of the undeformed body is now.
    #[must_use]
    pub fn of(&self, point: Vector2<f64>) -> Vector2<f64> {
        Rotation2::new(self.rotation_rad) * point + self.translation
    }

    /// The same with lengths in a unit `per_unit` times smaller.
    #[must_use]
    pub fn scaled(&self, per_unit: f64) -> Self {
        Self {
            translation: self.translation * per_unit,
            ..*self
        }
    }

    /// The mirror image about the vertical through the origin.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        Self {
            // Adding zero makes a negative zero positive.
            rotation_rad: -self.rotation_rad + 0.0,
            translation: Vector2::new(-self.translation.x + 0.0, self.translation.y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_turned_about_a_pole_takes_the_pole_along() {
        let (pole, moved) = (Vector2::new(0.7, 0.2), Vector2::new(0.9, -0.1));
        let pose = Pose::about(pole, moved, 0.4);
        assert!((pose.of(pole) - moved).norm() < 1e-15);
        let arm = Vector2::new(0.3, 0.1);
        let turned = pose.of(pole + arm) - moved;
        assert!((turned - Rotation2::new(0.4) * arm).norm() < 1e-15);
    }

    #[test]
    fn mirror_images_of_points_are_points_of_mirror_images() {
        let mirror = |v: Vector2<f64>| Vector2::new(-v.x, v.y);
        let pose = Pose::about(Vector2::new(0.7, 0.2), Vector2::new(0.9, -0.1), 0.4);
        let point = Vector2::new(-0.3, 0.8);
        assert!((pose.mirrored().of(mirror(point)) - mirror(pose.of(point))).norm() < 1e-15);
    }
}
