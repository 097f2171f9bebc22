//! Initial position of a row with rigid joints: undeformed, or on the hinges of moved supports. Displacements and rotations are relative to this
//! position.

use nalgebra::Vector2;

use crate::dynamics::row::observer::{OVERTURNED_RAD, OVERTURNED_RATIO};
use crate::mechanics::{Corners, Placement, Pose, Row};

/// Initial position of a row.
#[derive(Clone, Debug)]
pub(super) struct InitialPosition<'a> {
    row: &'a Row,
    pub placement: Placement,
    /// Corners in contact in this position.
    pub touching: Vec<Corners>,
}

impl<'a> InitialPosition<'a> {
    pub fn new(row: &'a Row, placement: &Placement) -> Self {
        Self {
            row,
            touching: touching_corners(&placement.gaps_m).collect(),
            placement: placement.clone(),
        }
    }

    /// Whether joints are open in this position.
    pub fn is_on_hinges(&self) -> bool {
        self.placement.open_corners() > 0
    }

    /// Whether a row with these gaps is in this position, by its contacts: three hinges determine the position.
    pub fn has_contacts(&self, gaps_m: &[[f64; 2]]) -> bool {
        touching_corners(gaps_m).eq(self.touching.iter().copied())
    }

    /// Rotations of the blocks relative to this position.
    pub fn relative_rotations_rad(
        &self,
        poses: impl Iterator<Item = f64>,
    ) -> impl Iterator<Item = f64> {
        let stood = self.placement.poses.iter().map(Pose::rotation_rad);
        poses.zip(stood).map(|(now, stood)| now - stood)
    }

    /// Sum of displacements of the blocks from this position times their masses, in kg m, for given centres.
    pub fn mass_displacement_kg_m(&self, centres_m: &[Vector2<f64>]) -> Vector2<f64> {
        let stood = self.placement.centres_m.iter();
        let blocks = self.row.blocks.iter().zip(centres_m.iter().zip(stood));
        let moved = blocks.map(|(block, (now, stood))| (now - stood) * block.mass_kg);
        moved.sum()
    }

    /// Whether a block has turned too far, or is too far from its initial positions relative to both feet. `feet_m` are the displacements of
    /// the feet.
    pub fn has_left(
        &self,
        blocks: impl Iterator<Item = (Vector2<f64>, f64)>,
        feet_m: [Vector2<f64>; 2],
    ) -> bool {
        let far = (OVERTURNED_RATIO * self.row.size_m).powi(2);
        let stood = self.placement.centres_m.iter().zip(&self.placement.poses);
        let is_left = |((centre_m, rotation_rad), (initial_m, pose)): ((_, f64), (_, &Pose))| {
            let moved_m: Vector2<f64> = centre_m - initial_m;
            let is_far = |foot_m: &Vector2<f64>| (moved_m - foot_m).norm_squared() >= far;
            (rotation_rad - pose.rotation_rad()).abs() >= OVERTURNED_RAD
                || feet_m.iter().all(is_far)
        };
        blocks.zip(stood).any(is_left)
    }
}

/// Corners in contact, for given gaps of the joints.
pub(super) fn touching_corners(gaps_m: &[[f64; 2]]) -> impl Iterator<Item = Corners> {
    gaps_m.iter().map(|gaps| gaps.map(|gap| gap == 0.0))
}
