//! The pose of a rigid body.

use nalgebra::Vector2;

/// Position of a rigid body relative to the undeformed structure: a rotation about the origin, then a displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Rotation in radians, positive anticlockwise.
    rotation_rad: f64,
    /// Cosine and sine of the rotation.
    turn: Vector2<f64>,
    /// Displacement of the body's point at the origin, in the unit of length of the structure that gives
    /// the pose; metres in a [`Sample`](crate::dynamics::Sample).
    pub translation: Vector2<f64>,
}

impl Pose {
    /// Pose of an undeformed body.
    pub const UNDEFORMED: Self = Self {
        rotation_rad: 0.0,
        turn: Vector2::new(1.0, 0.0),
        translation: Vector2::new(0.0, 0.0),
    };

    /// Pose after a rotation by `rotation_rad` about the origin and a displacement.
    pub fn new(rotation_rad: f64, translation: Vector2<f64>) -> Self {
        Self {
            rotation_rad,
            turn: unit(rotation_rad),
            translation,
        }
    }

    /// Pose after a rotation by `rotation_rad` about the point `pole` of the body, which moves to `moved`.
    pub fn about(pole: Vector2<f64>, moved: Vector2<f64>, rotation_rad: f64) -> Self {
        // Adding zero makes a negative zero positive.
        let turned = Self::new(rotation_rad + 0.0, Vector2::zeros());
        Self {
            translation: moved - turned.current_direction(pole),
            ..turned
        }
    }

    /// Rotation in radians, positive anticlockwise.
    pub const fn rotation_rad(&self) -> f64 {
        self.rotation_rad
    }

    /// Present position of a point of the undeformed body.
    pub fn current_position(&self, point: Vector2<f64>) -> Vector2<f64> {
        self.current_direction(point) + self.translation
    }

    /// Present direction of a vector of the undeformed body.
    pub fn current_direction(&self, vector: Vector2<f64>) -> Vector2<f64> {
        product(self.turn, vector)
    }

    /// This pose with lengths in a unit `per_unit` times smaller.
    pub fn scaled(&self, per_unit: f64) -> Self {
        Self {
            translation: self.translation * per_unit,
            ..*self
        }
    }

    /// Mirror image about the vertical through the origin.
    pub fn mirrored(&self) -> Self {
        // Adding zero makes a negative zero positive.
        Self {
            rotation_rad: -self.rotation_rad + 0.0,
            turn: Vector2::new(self.turn.x, -self.turn.y + 0.0),
            translation: Vector2::new(-self.translation.x + 0.0, self.translation.y),
        }
    }
}

/// Unit vector at an angle from the x axis.
pub(crate) fn unit(angle_rad: f64) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(angle_rad);
    Vector2::new(cos, sin)
}

/// Vector rotated by the angle of a unit vector: a product of complex numbers.
pub(crate) fn product(unit: Vector2<f64>, vector: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(
        unit.x * vector.x - unit.y * vector.y,
        unit.y * vector.x + unit.x * vector.y,
    )
}

/// Point that moves with a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPoint {
    /// Index of the body; `None` for a point that does not move.
    pub body: Option<usize>,
    /// Position in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
}

impl BodyPoint {
    /// Current position of the point, with its displacement multiplied by `exaggeration`. At any exaggeration, coincident points
    /// stay coincident and closed joints stay closed; in return, bodies grow with the square of their rotation.
    pub fn current_position(&self, poses: &[Pose], exaggeration: f64) -> Vector2<f64> {
        let (pose, at_m) = (self.body.and_then(|body| poses.get(body)), self.at_m);
        pose.map_or(at_m, |pose| {
            at_m + (pose.current_position(at_m) - at_m) * exaggeration
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation2;

    use super::*;

    #[test]
    fn a_body_turned_about_a_pole_takes_the_pole_along() {
        let (pole, moved) = (Vector2::new(0.7, 0.2), Vector2::new(0.9, -0.1));
        let pose = Pose::about(pole, moved, 0.4);
        assert!((pose.current_position(pole) - moved).norm() < 1e-15);
        let arm = Vector2::new(0.3, 0.1);
        let turned = pose.current_position(pole + arm) - moved;
        assert!((turned - Rotation2::new(0.4) * arm).norm() < 1e-15);
    }

    #[test]
    fn mirror_images_of_points_are_points_of_mirror_images() {
        let mirror = |v: Vector2<f64>| Vector2::new(-v.x, v.y);
        let pose = Pose::about(Vector2::new(0.7, 0.2), Vector2::new(0.9, -0.1), 0.4);
        let point = Vector2::new(-0.3, 0.8);
        assert!(
            (pose.mirrored().current_position(mirror(point))
                - mirror(pose.current_position(point)))
            .norm()
                < 1e-15
        );
    }
}
