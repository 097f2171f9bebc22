//! Positions of the blocks of a row with sliding joints, and coordinates of the joint between two blocks.
//!
//! The faces of a joint have rotated relative to each other by `phi`, and have slid. Let `e` be the unit vector from intrados to extrados in the mean
//! direction of the faces, and `n = s k x e` the normal towards the right block (`s` is the handedness of the row). Let `d` be the vector from the
//! intrados corner of the left face to that of the right face. Then the offset is `d . e`, and the gap at position `x` along the joint is
//! `d . n + 2 s tan(phi/2) x`. Offset faces touch at the ends of their overlap. The gaps at these two ends and the offset are the three coordinates
//! of the joint. Their gradients are exact; a solution for their rates only needs a correction for the curvature of the motion.
//!
//! A support that extends beyond its joint, as the ground does, is a straight line of infinite length. Contact is then at the corners of the block's
//! face, at any offset. Gaps are measured normal to the line and the offset along it, at the corner nearer to the line.

use nalgebra::{Matrix3, RowVector3, Vector2, Vector3};

use super::geometry::field::quarter_turn;
use super::geometry::pose::{product, unit};
use crate::mechanics::{Edge, Joint, Pose, Row};

/// Position of a block, for sliding joints: centre of gravity and half the rotation. The motion integrates the velocity of the centre. Half rotations
/// of two blocks add up to the mean angle of their faces. A [`Pose`] stores the full rotation, which is not bitwise equal to twice the half rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Centre of gravity, in metres.
    pub centre_m: Vector2<f64>,
    /// Rotation in radians, anticlockwise.
    pub rotation_rad: f64,
    /// Cosine and sine of half the rotation.
    half: Vector2<f64>,
}

impl Position {
    /// Position of a support that has not moved; its faces are given in the undeformed row.
    #[cfg(any(test, feature = "internals"))]
    pub const HELD: Self = Self {
        centre_m: Vector2::new(0.0, 0.0),
        rotation_rad: 0.0,
        half: Vector2::new(1.0, 0.0),
    };

    /// Position of a block with a given centre and rotation.
    pub fn new(centre_m: Vector2<f64>, rotation_rad: f64) -> Self {
        Self {
            centre_m,
            rotation_rad,
            half: unit(0.5 * rotation_rad),
        }
    }

    /// Position of a support; its faces are given relative to the origin.
    pub fn of(support: &Pose) -> Self {
        Self::new(support.translation, support.rotation_rad())
    }

    /// This position after a displacement.
    pub fn moved(&self, by_m: Vector2<f64>) -> Self {
        Self {
            centre_m: self.centre_m + by_m,
            ..*self
        }
    }

    /// Pose relative to the undeformed row, in which the centre of gravity is at `undeformed_m`.
    pub fn pose(&self, undeformed_m: Vector2<f64>) -> Pose {
        Pose::about(undeformed_m, self.centre_m, self.rotation_rad)
    }

    /// Current position of the point at `arm_m` from the centre in the undeformed row.
    pub(crate) fn current_position(&self, arm_m: Vector2<f64>) -> Vector2<f64> {
        self.centre_m + self.current_direction(arm_m)
    }

    /// Current direction of a vector of the block in the undeformed row.
    fn current_direction(&self, vector: Vector2<f64>) -> Vector2<f64> {
        product(product(self.half, self.half), vector)
    }
}

/// Geometry of a joint relative to its two blocks.
#[derive(Clone, Copy, Debug)]
pub struct Faces {
    /// Vectors from the centres of the left and the right block to the intrados corner.
    arms_m: [Vector2<f64>; 2],
    tangent: Vector2<f64>,
    /// Length of the faces in metres.
    pub thickness_m: f64,
    handedness: f64,
    /// Side of the block (left 0, right 1) at a support that extends beyond the joint; `None` for other joints.
    on_support: Option<usize>,
}

impl Faces {
    /// Joints of a row.
    pub fn of_row(row: &Row) -> Vec<Self> {
        let centre = |block: Option<usize>| {
            let block = block.and_then(|block| row.blocks.get(block));
            block.map_or(Vector2::zeros(), |block| block.centre_m)
        };
        let [first, last] = row.supports_extend;
        let ends = row.joints.len() - 1;
        let faces = |(index, joint): (usize, &Joint)| Self {
            on_support: match index {
                0 if first => Some(1),
                _ if index == ends && last => Some(0),
                _ => None,
            },
            arms_m: [centre(index.checked_sub(1)), centre(Some(index))]
                .map(|centre| joint.intrados_m - centre),
            tangent: joint.direction(),
            thickness_m: joint.thickness_m(),
            handedness: row.handedness,
        };
        row.joints.iter().enumerate().map(faces).collect()
    }

    /// Joint between two blocks at given positions.
    pub fn contact(&self, left: &Position, right: &Position) -> FaceContact {
        if let Some(side) = self.on_support {
            let bodies = [left, right];
            return self.contact_with_support(bodies[side], bodies[1 - side], side);
        }
        let s = self.handedness;
        let half = product(right.half, Vector2::new(left.half.x, -left.half.y));
        let tangent = product(product(left.half, right.half), self.tangent);
        let normal = quarter_turn(tangent) * s;
        let corners = [
            left.current_position(self.arms_m[0]),
            right.current_position(self.arms_m[1]),
        ];
        let apart = corners[1] - corners[0];
        let offset_m = apart.dot(&tangent);
        let tan_half = half.y / half.x;
        let inset_m = 0.5 * offset_m.abs();
        let ends_m = [inset_m, self.thickness_m * half.x - inset_m];
        let gap = |x: f64| apart.dot(&normal) + 2.0 * s * tan_half * x;
        FaceContact {
            middle_m: (corners[0] + corners[1]) * 0.5,
            tangent,
            normal,
            half,
            ends_m,
            coordinates_m: Vector3::new(gap(ends_m[0]), gap(ends_m[1]), offset_m),
        }
    }

    /// Joint between a block, on the given side, and a support that extends beyond the joint.
    fn contact_with_support(
        &self,
        block: &Position,
        support: &Position,
        side: usize,
    ) -> FaceContact {
        let tangent = support.current_direction(self.tangent);
        let normal = quarter_turn(tangent) * self.handedness;
        // Coordinates are those of the right face; for a block on the left, the sign is opposite.
        let sign = if side == 1 { 1.0 } else { -1.0 };
        let intrados_m = block.current_position(self.arms_m[side]);
        let face = block.current_direction(self.tangent) * self.thickness_m;
        let moved = intrados_m - support.current_position(self.arms_m[1 - side]);
        let gaps_m = [moved, moved + face].map(|corner| sign * corner.dot(&normal));
        let reach_m = face.dot(&tangent);
        let (middle_m, ends_m, shift_m) = if gaps_m[0] <= gaps_m[1] {
            (intrados_m, [0.0, reach_m], 0.0)
        } else {
            let shift_m = reach_m - self.thickness_m;
            (intrados_m + face, [-reach_m, 0.0], shift_m)
        };
        FaceContact {
            middle_m,
            tangent,
            normal,
            half: Vector2::new(1.0, 0.0),
            ends_m,
            coordinates_m: Vector3::new(
                gaps_m[0],
                gaps_m[1],
                sign * (moved.dot(&tangent) + shift_m),
            ),
        }
    }
}

/// Joint in the current position of its blocks.
#[derive(Clone, Copy, Debug)]
pub struct FaceContact {
    /// Midpoint between the intrados corners of the faces, in metres; on a support that extends beyond the joint, the corner nearer to the support.
    pub middle_m: Vector2<f64>,
    /// Unit vector from intrados to extrados in the mean direction of the faces; along the support if that extends beyond the joint.
    pub tangent: Vector2<f64>,
    /// Unit normal towards the right block.
    pub normal: Vector2<f64>,
    /// Cosine and sine of half the angle between the faces; also the inclination of the forces on offset faces.
    half: Vector2<f64>,
    /// Ends of the overlap of the faces along the joint, measured from `middle_m`, in metres.
    pub ends_m: [f64; 2],
    /// Gaps at both ends of the overlap, and offset of the right face towards the extrados, in metres.
    pub coordinates_m: Vector3<f64>,
}

impl FaceContact {
    /// End of the overlap at an edge.
    pub fn corner_m(&self, edge: Edge) -> Vector2<f64> {
        let intrados_m = self.middle_m + self.tangent * self.ends_m[0];
        match edge {
            Edge::Intrados => intrados_m,
            Edge::Extrados => intrados_m + self.tangent * (self.ends_m[1] - self.ends_m[0]),
        }
    }

    /// Inclination along the joint of the forces at the ends of the overlap. These forces are normal to the face that they act on.
    fn lean(&self, faces: &Faces) -> f64 {
        let offset_m = self.coordinates_m.z;
        if offset_m == 0.0 {
            0.0
        } else {
            faces.handedness * self.half.y / self.half.x * offset_m.signum()
        }
    }

    /// Directions of the three coordinates.
    pub fn frame(&self, faces: &Faces) -> ContactFrame {
        let s = faces.handedness;
        let c = self.half.x;
        let squared = c * c;
        ContactFrame {
            middle_m: self.middle_m,
            tangent: self.tangent,
            normal: self.normal,
            lean: self.lean(faces),
            couples_m: [
                s * self.ends_m[0] / squared,
                s * (self.ends_m[1] / squared - faces.thickness_m * self.half.y * self.half.y / c),
            ],
        }
    }
}

/// Directions of the three coordinates of a joint: of their rates for a motion of the right block relative to the left one, and of the impulses on
/// the right block that belong to them.
#[derive(Clone, Copy, Debug)]
pub struct ContactFrame {
    /// Point at which relative velocities are taken, and about which moments are.
    pub middle_m: Vector2<f64>,
    tangent: Vector2<f64>,
    normal: Vector2<f64>,
    lean: f64,
    /// Moments of unit impulses at both ends.
    couples_m: [f64; 2],
}

impl ContactFrame {
    /// Frame without directions.
    pub(crate) const NONE: Self = Self {
        middle_m: Vector2::new(0.0, 0.0),
        tangent: Vector2::new(0.0, 0.0),
        normal: Vector2::new(0.0, 0.0),
        lean: 0.0,
        couples_m: [0.0; 2],
    };

    /// Rates of the three coordinates for a relative velocity at the middle, and a relative rotation rate.
    pub fn rates(&self, velocity_m_s: Vector2<f64>, rotation_rad_s: f64) -> Vector3<f64> {
        let (apart, along) = (
            self.normal.dot(&velocity_m_s),
            self.tangent.dot(&velocity_m_s),
        );
        let [intrados, extrados] = self.couples_m.map(|couple| couple * rotation_rad_s);
        Vector3::new(
            apart + self.lean * along + intrados,
            apart - self.lean * along + extrados,
            along,
        )
    }

    /// Relative velocity at the middle and rotation rate with these rates of the coordinates: the inverse of [`Self::rates`].
    pub(crate) fn motion(&self, rates_m_s: &Vector3<f64>) -> (Vector2<f64>, f64) {
        let along = rates_m_s.z;
        let [intrados, extrados] = [
            rates_m_s.x - self.lean * along,
            rates_m_s.y + self.lean * along,
        ];
        let rate = (intrados - extrados) / (self.couples_m[0] - self.couples_m[1]);
        let apart = intrados - self.couples_m[0] * rate;
        (self.normal * apart + self.tangent * along, rate)
    }

    /// Force on the right block, and its moment about the middle, of these impulses.
    pub(crate) fn wrench(&self, impulses: &Vector3<f64>) -> (Vector2<f64>, f64) {
        let along = impulses.z + self.lean * (impulses.x - impulses.y);
        (
            self.normal * (impulses.x + impulses.y) + self.tangent * along,
            impulses.x * self.couples_m[0] + impulses.y * self.couples_m[1],
        )
    }

    /// Impulses with this force on the right block, and this moment about the middle: the inverse of [`Self::wrench`].
    pub(crate) fn impulses(&self, force: Vector2<f64>, moment: f64) -> Vector3<f64> {
        let (normal, [first, second]) = (self.normal.dot(&force), self.couples_m);
        let intrados = (moment - normal * second) / (first - second);
        let extrados = normal - intrados;
        let along = self.tangent.dot(&force) - self.lean * (intrados - extrados);
        Vector3::new(intrados, extrados, along)
    }

    /// Gradients of the three coordinates, one row each, by the velocity (x, y) and the rotation rate of the left body, then of the
    /// right body. `centres_m` are the centres of the bodies.
    pub fn gradients(&self, centres_m: [Vector2<f64>; 2]) -> [Matrix3<f64>; 2] {
        let forces = [
            self.normal + self.tangent * self.lean,
            self.normal - self.tangent * self.lean,
            self.tangent,
        ];
        let couples = [self.couples_m[0], self.couples_m[1], 0.0];
        let rows = |centre_m: Vector2<f64>, sign: f64| {
            let arm = self.middle_m - centre_m;
            Matrix3::from_rows(&[0, 1, 2].map(|row| {
                let (force, turning) = (forces[row], arm.perp(&forces[row]) + couples[row]);
                RowVector3::new(force.x, force.y, turning) * sign
            }))
        };
        [rows(centres_m[0], -1.0), rows(centres_m[1], 1.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::ring::Ring;

    /// Checks joints between two blocks, and between a block and an extended support on either side.
    #[test]
    fn gradients_are_those_of_the_coordinates() {
        let ring = Ring::new(0.2, 2.5).unwrap();
        let row = Row::arch(&ring, 3, 2.0, 1.0, 1.0)
            .unwrap()
            .with_supports_that_extend([true; 2]);
        for joint in [1, 0, 3] {
            check_gradients(&row, joint);
        }
    }

    /// Central differences with steps of 1e-6 have errors of about 1e-10 here.
    fn check_gradients(row: &Row, joint: usize) {
        let faces = Faces::of_row(row)[joint];
        let block = |index: Option<usize>| index.and_then(|index| row.blocks.get(index));
        let sides = [block(joint.checked_sub(1)), block(Some(joint))];
        let centres = sides.map(|block| block.map_or(Vector2::zeros(), |block| block.centre_m));
        for (shift, turns) in [
            (Vector2::new(0.03, 0.01), [0.1, -0.2]),
            (Vector2::new(-0.02, 0.02), [0.05, 0.3]),
        ] {
            let base = [
                [centres[0].x, centres[0].y, turns[0]],
                [centres[1].x + shift.x, centres[1].y + shift.y, turns[1]],
            ];
            let place = |at: &[[f64; 3]; 2]| {
                let [left, right] = [0, 1].map(|side| {
                    let [x, y, turn] = at[side];
                    sides[side].map_or(Position::HELD, |_| Position::new(Vector2::new(x, y), turn))
                });
                (faces.contact(&left, &right), left, right)
            };
            let (contact, left, right) = place(&base);
            let gradients = contact
                .frame(&faces)
                .gradients([left.centre_m, right.centre_m]);
            assert!(contact.coordinates_m.z.abs() > 1e-3);
            for block in (0..2).filter(|side| sides[*side].is_some()) {
                for axis in 0..3 {
                    let moved = |by: f64| {
                        let mut at = base;
                        at[block][axis] += by;
                        place(&at).0.coordinates_m
                    };
                    let slope = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                    let miss: Vector3<f64> = slope - gradients[block].column(axis);
                    assert!(miss.norm() < 1e-8, "{block} {axis} {miss}");
                }
            }
        }
    }

    #[test]
    fn an_undeformed_row_is_shut() {
        let ring = Ring::new(0.15, 2.7).unwrap();
        let row = Row::arch(&ring, 7, 10.0, 1.0, 1.0).unwrap();
        let position = |block: Option<usize>| {
            let block = block.and_then(|block| row.blocks.get(block));
            block.map_or(Position::HELD, |block| Position::new(block.centre_m, 0.0))
        };
        for (joint, faces) in Faces::of_row(&row).iter().enumerate() {
            let (left, right) = (position(joint.checked_sub(1)), position(Some(joint)));
            let contact = faces.contact(&left, &right);
            assert!(contact.coordinates_m.norm() < 1e-14);
            assert!(contact.ends_m[0] < 1e-14 && (contact.ends_m[1] - 1.5).abs() < 1e-14);
        }
    }
}
