//! Row of rigid blocks, the common form of an arch of voussoirs and a column of drums.
//!
//! Blocks `0..N` are side by side, and joint `j` is before block `j`. The first joint is on the left support. A row between [`Supports::Both`] has a
//! joint `N` on the right support. A row on [`Supports::Left`] only is a free-standing stack, in which left and right mean below and above. A joint
//! is a plane face from its *intrados* corner to its *extrados* corner; in a stack these are the left and the right corner of a bed joint.
//!
//! This module describes the undeformed row only: `joints` computes positions of the blocks, `contact` their velocities.

use nalgebra::Vector2;
use thiserror::Error;

pub use super::block::{Block, Joint};
use super::geometry::rigid::mirrored;
use super::tie::TieError;
use crate::mechanics::{Edge, Ring, Tie};

/// Maximum number of blocks of a row. The effort of a step and the number of impacts increase with the number of blocks, while thresholds hardly
/// change beyond a few dozen voussoirs.
pub const MAX_BLOCKS: usize = 500;

/// Default gravity, in m/s2.
pub(crate) const GRAVITY_M_S2: f64 = 9.81;

/// Least size of a row, over its extent.
const LEAST_SIZE_RATIO: f64 = 1e-6;

/// Reason why blocks and joints do not form a row.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RowError {
    /// The thickness of a joint is out of range: index of the joint, from 0, and thickness in metres.
    #[error(
        "thickness in m of joint {0} is {1}: it must be finite, and positive beside the size of the row"
    )]
    Thickness(usize, f64),
    /// A number of a block is not finite, or not in its range: name with unit, index of the block from 0, number, and allowed range.
    #[error("{0} of block {1} is {2}: {3}")]
    Block(&'static str, usize, f64, &'static str),
    /// A dimension of the whole row is out of range: name with unit, and value.
    #[error("{0} is {1}: it must be positive and finite")]
    Dimension(&'static str, f64),
    /// The size is negligible beside the row.
    #[error(
        "size in m is {size_m}: it must be at least a millionth of the extent of the row, {extent_m:.3e}, since steps follow it"
    )]
    Size {
        /// The size.
        size_m: f64,
        /// Largest distance of a corner of a joint from the first corner.
        extent_m: f64,
    },
    /// No block, or too many.
    #[error(
        "{0} blocks: a row has 1 to {MAX_BLOCKS}; with more, a step takes longer to compute and must be shorter"
    )]
    Count(usize),
    /// The arch is a ring without joints.
    #[error("an arch without joints is not a row of blocks: give the number of voussoirs")]
    NoVoussoirs,
    /// The number of joints does not fit.
    #[error(
        "{joints} joints for {blocks} blocks: a row between two supports has one more, a stack as many"
    )]
    Joints {
        /// Number of blocks.
        blocks: usize,
        /// Number of joints.
        joints: usize,
    },
    /// A column has ties as well as loads with constant forces.
    #[error(
        "a column carries ties or constant forces (`thrust_n`, or `moves = false`, of [[load]]), not both: leave one out"
    )]
    TiesAndForces,
    /// Two neighbouring joints have a point in common.
    #[error("joints {0} and {next} cross or touch", next = .0 + 1)]
    Crossing(usize),
    /// A block is on the wrong side of one of its joints, or intrados and extrados are exchanged there.
    #[error(
        "block {block} is not on its side of joint {joint}: corners must be in the same order at every joint"
    )]
    Order {
        /// Index of the block.
        block: usize,
        /// Index of the joint.
        joint: usize,
    },
}

named! {
    /// The supports of a row.
    pub enum Supports {
        /// Abutments before the first block and after the last one: an arch.
        Both = "both",
        /// A base before the first block: a free-standing stack.
        Left = "left",
    }
}

/// A drum of a stack: a symmetric trapezium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drum {
    /// Height in metres.
    pub height_m: f64,
    /// Width at its bottom in metres.
    pub base_width_m: f64,
    /// Width at its top in metres.
    pub top_width_m: f64,
}

/// A row of rigid blocks in its undeformed shape.
#[readonly::make]
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The blocks from left to right.
    pub blocks: Vec<Block>,
    /// The joints from left to right.
    pub joints: Vec<Joint>,
    /// The supports of the row.
    pub supports: Supports,
    /// Length, in metres, that scales energies and steps.
    pub size_m: f64,
    /// Closed polygons to draw the blocks, from left to right, in metres.
    pub outlines_m: Vec<Vec<Vector2<f64>>>,
    /// Sign of `e x n` of its joints: -1 in an arch, 1 in a stack.
    pub handedness: f64,
    /// Flags of the left and the right support: true if the support extends beyond its joint.
    pub supports_extend: [bool; 2],
    /// Ties of the row, or constant forces on its blocks, which are ties of zero stiffness.
    pub ties: Vec<Tie>,
    /// Gravity for which the ties were given, in m/s2.
    pub gravity_m_s2: f64,
}

impl Row {
    /// Row of given blocks and joints. `size_m` is the length that scales energies and steps: the mean radius of an arch, the half diagonal
    /// of a stack.
    ///
    /// # Errors
    /// If a number is not finite, or not positive where required; if the size is too small for the row; if joints cross; or if a block is not between
    /// its joints.
    pub fn new(
        blocks: Vec<Block>,
        joints: Vec<Joint>,
        supports: Supports,
        size_m: f64,
    ) -> Result<Self, RowError> {
        check_positive("size in m", size_m)?;
        let count = blocks.len();
        check_block_count(count)?;
        if joints.len() != count + usize::from(supports == Supports::Both) {
            return Err(RowError::Joints {
                blocks: count,
                joints: joints.len(),
            });
        }
        check_joints(&joints, size_m)?;
        check_blocks(&blocks)?;
        let side = |joint: usize, block: usize| {
            let arm_m = blocks[block].centre_m - joints[joint].intrados_m;
            joints[joint].direction().perp(&arm_m)
        };
        let handedness = side(0, 0).signum();
        for joint in 0..joints.len() {
            for (block, sign) in [(Some(joint), 1.0), (joint.checked_sub(1), -1.0)] {
                let block = block.filter(|block| *block < count);
                // NaN is on neither side.
                let is_on = |block: usize| sign * handedness * side(joint, block) > 0.0;
                if let Some(block) = block.filter(|block| !is_on(*block)) {
                    return Err(RowError::Order { block, joint });
                }
            }
        }
        let outlines_m = (0..count)
            .map(|block| {
                let (before, centre_m) = (&joints[block], blocks[block].centre_m);
                // Draw the free top of a stack as its bottom rotated about the centre.
                let after = joints.get(block + 1).copied().unwrap_or(Joint {
                    intrados_m: 2.0 * centre_m - before.extrados_m,
                    extrados_m: 2.0 * centre_m - before.intrados_m,
                });
                before.outline_m(&after).to_vec()
            })
            .collect();
        Ok(Self {
            blocks,
            joints,
            supports,
            size_m,
            outlines_m,
            handedness,
            supports_extend: [false; 2],
            ties: Vec::new(),
            gravity_m_s2: GRAVITY_M_S2,
        })
    }

    /// This row with these ties in place of its own, under this gravity.
    ///
    /// # Errors
    /// If a tie is not valid, with its index.
    pub fn with_ties(
        mut self,
        ties: Vec<Tie>,
        gravity_m_s2: f64,
    ) -> Result<Self, (usize, TieError)> {
        for (index, tie) in ties.iter().enumerate() {
            tie.check(self.blocks.len(), self.size_m)
                .map_err(|error| (index, error))?;
        }
        self.ties = ties;
        self.gravity_m_s2 = gravity_m_s2;
        Ok(self)
    }

    /// This row with constant forces in place of its ties: index of the block, point in metres, and force in N, under this gravity.
    #[must_use]
    pub fn with_constant_forces(
        mut self,
        forces: impl IntoIterator<Item = (usize, Vector2<f64>, Vector2<f64>)>,
        gravity_m_s2: f64,
    ) -> Self {
        let forces = forces
            .into_iter()
            .filter(|(block, _, force_n)| {
                *block < self.blocks.len() && *force_n != Vector2::zeros()
            })
            .map(|(block, at_m, force_n)| Tie::constant_force(block, at_m, force_n));
        self.ties = forces.collect();
        self.gravity_m_s2 = gravity_m_s2;
        self
    }

    /// Ties of the row; empty if it carries constant forces.
    pub fn bars(&self) -> &[Tie] {
        match self.ties.iter().any(Tie::is_constant_force) {
            true => &[],
            false => &self.ties,
        }
    }

    /// Constant forces on the blocks of the row.
    pub fn constant_forces(&self) -> impl Iterator<Item = &Tie> {
        self.ties.iter().filter(|tie| tie.is_constant_force())
    }

    /// This row without ties.
    #[must_use]
    pub fn without_ties(mut self) -> Self {
        self.ties.clear();
        self
    }

    /// This row with other outlines to draw its blocks: closed polygons, in metres.
    #[must_use]
    pub(crate) fn with_outlines_m(self, outlines_m: Vec<Vec<Vector2<f64>>>) -> Self {
        debug_assert_eq!(outlines_m.len(), self.blocks.len());
        Self { outlines_m, ..self }
    }

    /// This row with supports, left and right, that extend beyond their joints or not (a stack has only the left one, its base). A support
    /// that extends, as the ground around a base, carries the block at any slip. Otherwise the block can slide off. Without slip both are equivalent.
    #[must_use]
    pub const fn with_supports_that_extend(mut self, sides: [bool; 2]) -> Self {
        let right = matches!(self.supports, Supports::Both);
        self.supports_extend = [sides[0], sides[1] && right];
        self
    }

    /// This row with another mass, centre and inertia of a block.
    #[must_use]
    pub(crate) fn with_block(mut self, index: usize, block: Block) -> Self {
        self.blocks[index] = block;
        self
    }

    /// This row with a body fixed to a block.
    #[must_use]
    pub fn with_body(mut self, block: usize, body: &Block) -> Self {
        if let Some(block) = self.blocks.get_mut(block) {
            *block = block.with(body);
        }
        self
    }

    /// Mirror image about the y axis, in which the right support becomes the left one. `None` for a stack, whose blocks would keep their
    /// order.
    pub fn mirrored(&self) -> Option<Self> {
        if self.supports == Supports::Left {
            return None;
        }
        let [left, right] = self.supports_extend;
        let outlines_m = self.outlines_m.iter().rev();
        let ties = self.ties.iter();
        Some(Self {
            blocks: self.blocks.iter().rev().map(Block::mirrored).collect(),
            joints: self.joints.iter().rev().map(Joint::mirrored).collect(),
            outlines_m: outlines_m
                .map(|outline| outline.iter().rev().copied().map(mirrored).collect())
                .collect(),
            supports_extend: [right, left],
            ties: ties.map(|tie| tie.mirrored(self.blocks.len())).collect(),
            ..*self
        })
    }

    /// Annular voussoirs between sections of a ring (radians from the left springing, ascending, both springings included), with exact
    /// sectors. The size is the mean radius.
    ///
    /// # Errors
    /// When a dimension is not positive and finite, or the sections are fewer than two or not ascending.
    pub fn annular(
        ring: &Ring,
        sections_rad: &[f64],
        mean_radius_m: f64,
        depth_m: f64,
        density_kg_m3: f64,
    ) -> Result<Self, RowError> {
        let surface_kg_m2 = surface_density(depth_m, density_kg_m3)?;
        check_positive("mean radius in m", mean_radius_m)?;
        let blocks = sections_rad.windows(2).map(|ends| {
            let sector = ring.sector(ends[0], ends[1]);
            Block {
                mass_kg: sector.mass * surface_kg_m2 * mean_radius_m.powi(2),
                centre_m: sector.centroid() * mean_radius_m,
                inertia_kg_m2: sector.central_polar() * surface_kg_m2 * mean_radius_m.powi(4),
            }
        });
        let corner = |angle: f64, edge| ring.point(angle, edge) * mean_radius_m;
        let joints = sections_rad.iter().map(|angle| Joint {
            intrados_m: corner(*angle, Edge::Intrados),
            extrados_m: corner(*angle, Edge::Extrados),
        });
        let outlines_m = sections_rad.windows(2).map(|ends| {
            let outline = ring.sector_outline(ends[0], ends[1]).into_iter();
            outline.map(|corner| corner * mean_radius_m).collect()
        });
        let (blocks, joints) = (blocks.collect(), joints.collect());
        let row = Self::new(blocks, joints, Supports::Both, mean_radius_m)?;
        Ok(row.with_outlines_m(outlines_m.collect()))
    }

    /// Arch of `voussoirs` equal annular voussoirs.
    ///
    /// # Errors
    /// When a dimension is not positive and finite, or the number of voussoirs out of range.
    pub fn arch(
        ring: &Ring,
        voussoirs: usize,
        mean_radius_m: f64,
        depth_m: f64,
        density_kg_m3: f64,
    ) -> Result<Self, RowError> {
        check_block_count(voussoirs)?;
        let sections_rad = ring.sections(voussoirs);
        Self::annular(ring, &sections_rad, mean_radius_m, depth_m, density_kg_m3)
    }

    /// Free-standing stack of drums from the bottom up, on one vertical axis. Drums of different width touch on the narrower face. The size
    /// is half the diagonal of total height and base width.
    ///
    /// # Errors
    /// When a dimension is not positive and finite, or the number of drums out of range.
    pub fn stack(drums: &[Drum], depth_m: f64, density_kg_m3: f64) -> Result<Self, RowError> {
        surface_density(depth_m, density_kg_m3)?;
        check_block_count(drums.len())?;
        let face = |width_m: f64, y: f64| Joint {
            intrados_m: Vector2::new(-0.5 * width_m, y),
            extrados_m: Vector2::new(0.5 * width_m, y),
        };
        let (mut blocks, mut joints, mut y) = (Vec::new(), Vec::new(), 0.0);
        let mut outlines_m = Vec::new();
        let mut below_m = f64::INFINITY;
        for drum in drums {
            check_positive("height of a drum in m", drum.height_m)?;
            check_positive("width of a drum in m", drum.base_width_m)?;
            check_positive("width of a drum in m", drum.top_width_m)?;
            joints.push(face(drum.base_width_m.min(below_m), y));
            let top = face(drum.top_width_m, y + drum.height_m);
            let outline = face(drum.base_width_m, y).outline_m(&top);
            blocks.push(Block::prism(&outline, depth_m, density_kg_m3));
            outlines_m.push(outline.to_vec());
            (y, below_m) = (y + drum.height_m, drum.top_width_m);
        }
        let size_m = 0.5 * libm::hypot(y, drums[0].base_width_m);
        Ok(Self::new(blocks, joints, Supports::Left, size_m)?.with_outlines_m(outlines_m))
    }

    /// Stack of drums of given heights from the bottom up, with a width that varies linearly from `base_width_m` to `top_width_m`.
    ///
    /// # Errors
    /// Those of [`Row::stack`].
    pub fn tapered_stack(
        heights_m: &[f64],
        base_width_m: f64,
        top_width_m: f64,
        depth_m: f64,
        density_kg_m3: f64,
    ) -> Result<Self, RowError> {
        let total_m: f64 = heights_m.iter().sum();
        let width = |y: f64| base_width_m + (top_width_m - base_width_m) * (y / total_m);
        let mut y = 0.0;
        let drums = heights_m.iter().map(|height_m| {
            let base_width_m = width(y);
            y += height_m;
            Drum {
                height_m: *height_m,
                base_width_m,
                top_width_m: width(y),
            }
        });
        Self::stack(&drums.collect::<Vec<_>>(), depth_m, density_kg_m3)
    }

    /// Middles of the joints on the left and the right support, in metres; twice the same point for a stack.
    pub fn feet_m(&self) -> [Vector2<f64>; 2] {
        let last = match self.supports {
            Supports::Left => 0,
            Supports::Both => self.joints.len() - 1,
        };
        [0, last].map(|joint| self.joints[joint].middle_m())
    }

    /// Mass of all blocks in kg.
    pub fn mass_kg(&self) -> f64 {
        self.blocks.iter().map(|block| block.mass_kg).sum()
    }
}

fn check_positive(name: &'static str, value: f64) -> Result<(), RowError> {
    let holds = value > 0.0 && value < f64::INFINITY;
    let error = RowError::Dimension(name, value);
    holds.then_some(()).ok_or(error)
}

/// Mass per unit area, in kg/m2.
fn surface_density(depth_m: f64, density_kg_m3: f64) -> Result<f64, RowError> {
    check_positive("depth in m", depth_m)?;
    check_positive("density in kg/m3", density_kg_m3)?;
    Ok(depth_m * density_kg_m3)
}

fn check_block_count(blocks: usize) -> Result<(), RowError> {
    let holds = (1..=MAX_BLOCKS).contains(&blocks);
    holds.then_some(()).ok_or(RowError::Count(blocks))
}

/// Error for joints without thickness, for a size too small for the row, and for joints that cross.
fn check_joints(joints: &[Joint], size_m: f64) -> Result<(), RowError> {
    for (index, joint) in joints.iter().enumerate() {
        let value = joint.thickness_m();
        if !(value > 1e-9 * size_m && value < f64::INFINITY) {
            return Err(RowError::Thickness(index, value));
        }
    }
    let joints_m = joints.iter();
    let corners = joints_m.flat_map(|joint| [joint.intrados_m, joint.extrados_m]);
    let distances = corners.map(|corner| (corner - joints[0].intrados_m).norm());
    let extent_m = distances.fold(0.0, f64::max);
    if size_m < LEAST_SIZE_RATIO * extent_m {
        return Err(RowError::Size { size_m, extent_m });
    }
    let crossing = joints.windows(2).position(|pair| pair[0].meets(&pair[1]));
    crossing.map_or(Ok(()), |first| Err(RowError::Crossing(first)))
}

/// Error for blocks without mass or inertia, and for centres that are not finite.
fn check_blocks(blocks: &[Block]) -> Result<(), RowError> {
    let (positive, finite) = ("it must be positive and finite", "it must be finite");
    for (index, block) in blocks.iter().enumerate() {
        let [x, y] = block.centre_m.into();
        for (name, value, allowed) in [
            ("mass in kg", block.mass_kg, positive),
            ("inertia in kg m2", block.inertia_kg_m2, positive),
            ("centre in m", x, finite),
            ("centre in m", y, finite),
        ] {
            if !value.is_finite() || (allowed == positive && value <= 0.0) {
                return Err(RowError::Block(name, index, value, allowed));
            }
        }
    }
    Ok(())
}
