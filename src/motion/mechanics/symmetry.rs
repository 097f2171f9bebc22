//! Rows of blocks that are their own mirror image, as built.
//!
//! Masses, joints, supports, ties and constant forces are compared with their mirror images about the vertical through the middle between the feet.
//! Outlines only serve drawings and are not compared.

use nalgebra::Vector2;

use super::tie::{Anchor, Tie};
use crate::mechanics::{Block, Joint, Row, Supports};

/// Largest difference of a built quantity from that of its mirror image: of positions over the size of the row, of other numbers relative to their
/// value. Rounding errors of built arches are below 1e-12; a millionth of a millimetre in a metre is no asymmetry.
const SAME_RATIO: f64 = 1e-9;

impl Row {
    /// Whether the row as built is its own mirror image: masses, moments of inertia, joints, supports, ties and constant forces, within 1e-9
    /// of their values, and of the size of the row for positions. Motions under mirrored ground are then mirror images but for rounding errors.
    pub fn is_symmetric(&self) -> bool {
        let [left, right] = self.supports_extend;
        let supports = self.supports == Supports::Left || left == right;
        let blocks = self.blocks.iter().enumerate();
        let mut blocks =
            blocks.map(|(index, block)| (block, &self.blocks[self.mirrored_block(index)]));
        let joints = self.joints.iter().enumerate();
        let mut joints =
            joints.map(|(index, joint)| (joint, &self.joints[self.opposite_joint(index)]));
        supports
            && blocks.all(|(block, other)| self.is_mirror_image(block, other))
            && joints.all(|(joint, other)| self.are_opposite(joint, other))
            && self.opposite_ties().is_some()
    }

    /// Index of the block at the place of the mirror image of a block.
    pub(crate) fn mirrored_block(&self, block: usize) -> usize {
        match self.supports {
            Supports::Both => self.blocks.len() - 1 - block,
            Supports::Left => block,
        }
    }

    /// Index of the joint at the place of the mirror image of a joint.
    pub(crate) fn opposite_joint(&self, joint: usize) -> usize {
        match self.supports {
            Supports::Both => self.joints.len() - 1 - joint,
            Supports::Left => joint,
        }
    }

    /// Returns, for each tie or constant force, the index of the one that is its mirror image; `None` if one of them has none.
    pub(crate) fn opposite_ties(&self) -> Option<Vec<usize>> {
        let mut free: Vec<usize> = (0..self.ties.len()).collect();
        let opposite = |tie: &Tie| {
            let position = free
                .iter()
                .position(|other| self.is_opposite_tie(tie, &self.ties[*other]))?;
            Some(free.swap_remove(position))
        };
        self.ties.iter().map(opposite).collect()
    }

    /// Mirror image of a point about the vertical through the middle between the feet.
    fn image_m(&self, point_m: Vector2<f64>) -> Vector2<f64> {
        let [left_m, right_m] = self.feet_m();
        Vector2::new(left_m.x + right_m.x - point_m.x, point_m.y)
    }

    fn points_coincide(&self, one_m: Vector2<f64>, other_m: Vector2<f64>) -> bool {
        (one_m - other_m).amax() <= SAME_RATIO * self.size_m
    }

    fn is_mirror_image(&self, block: &Block, other: &Block) -> bool {
        is_same(block.mass_kg, other.mass_kg)
            && is_same(block.inertia_kg_m2, other.inertia_kg_m2)
            && self.points_coincide(self.image_m(block.centre_m), other.centre_m)
    }

    fn are_opposite(&self, joint: &Joint, other: &Joint) -> bool {
        let corners_m = match self.supports {
            Supports::Both => [other.intrados_m, other.extrados_m],
            // The left corner of a bed joint is the image of its right one.
            Supports::Left => [other.extrados_m, other.intrados_m],
        };
        let images_m = [joint.intrados_m, joint.extrados_m].map(|corner_m| self.image_m(corner_m));
        let mut pairs_m = images_m.into_iter().zip(corners_m);
        pairs_m.all(|(image_m, corner_m)| self.points_coincide(image_m, corner_m))
    }

    fn is_opposite_tie(&self, tie: &Tie, other: &Tie) -> bool {
        let same_law = tie.is_constant_force() == other.is_constant_force()
            && is_same(tie.stiffness_n_m, other.stiffness_n_m)
            && is_same(tie.prestress_n, other.prestress_n)
            && is_same(tie.yield_force_n, other.yield_force_n)
            && is_same(tie.breaks_at_strain, other.breaks_at_strain);
        let meets = |anchor: &Anchor, other: &Anchor| {
            anchor.block.map(|block| self.mirrored_block(block)) == other.block
                && self.points_coincide(self.image_m(anchor.at_m), other.at_m)
        };
        let [from, to] = &tie.ends;
        let [other_from, other_to] = &other.ends;
        let same_way = meets(from, other_from) && meets(to, other_to);
        let other_way = meets(from, other_to) && meets(to, other_from);
        same_law && (same_way || other_way && !tie.is_constant_force())
    }
}

/// Whether two numbers, which are not negative and may be infinite, are the same.
fn is_same(one: f64, other: f64) -> bool {
    one == other || (one - other).abs() <= SAME_RATIO * one.max(other)
}
