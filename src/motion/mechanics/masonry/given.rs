//! Blocks of any shape, given by the corners of their joints.

use nalgebra::Vector2;
use serde::{Serialize, Serializer};
use thiserror::Error;

use super::cut::{CutArch, EdgePosition};
use crate::argument::{ArgumentError, require, require_within};
use crate::mechanics::arch::MAGNITUDE;
use crate::mechanics::geometry::curve::{distance, sides};
use crate::mechanics::{Block, Curve, Joint, RowError, Supports};

/// Difference in height, over the size, below which corners are at one level.
const LEVEL_RATIO: f64 = 1e-9;

/// Reason, in words, why given blocks are not valid: the order of their joints, or an outline. Blocks are numbered from 1.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{0}")]
pub struct OutlineError(String);

/// Blocks between joints, from left to right (of a stack: from the base up).
///
/// A block is the quadrilateral between its joints unless it has an outline. The last joint of a stack is its free top.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GivenBlocks {
    /// Name of the file of the joints.
    #[serde(rename = "joints")]
    pub joints_file: String,
    /// File of the outlines.
    #[serde(rename = "outlines")]
    pub outlines_file: Option<String>,
    /// Decimal mark of the numbers in these files, as in scenarios; `None` for the point.
    pub decimal: Option<&'static str>,
    /// The supports of the row.
    pub supports: Supports,
    /// Length out of plane, in metres.
    pub depth_m: f64,
    /// Densities in kg/m3: one for all, or one for each block.
    #[serde(serialize_with = "one_or_more")]
    pub density_kg_m3: Vec<f64>,
    /// Corners of every joint.
    #[serde(skip)]
    pub joints: Vec<Joint>,
    /// Outlines of blocks that are not the quadrilateral between their joints: index, and corners in order.
    #[serde(skip)]
    pub outlines: Vec<(usize, Vec<Vector2<f64>>)>,
}

/// Writes a single number without a list.
fn one_or_more<S: Serializer>(numbers: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    match numbers {
        [one] => serializer.serialize_f64(*one),
        all => serializer.collect_seq(all),
    }
}

impl GivenBlocks {
    /// Checks the numbers that are not in the files, and that there are at least two joints.
    ///
    /// # Errors
    /// When a number is out of range, or there are fewer joints than two.
    pub fn check(&self) -> Result<(), ArgumentError> {
        require_within("depth_m", self.depth_m, MAGNITUDE)?;
        for density_kg_m3 in &self.density_kg_m3 {
            require_within("density_kg_m3", *density_kg_m3, MAGNITUDE)?;
        }
        let blocks = self.joints.len().saturating_sub(1);
        let densities = self.density_kg_m3.len();
        let fits = blocks > 0 && (densities == 1 || densities == blocks);
        let allowed = format_args!("one number, or one for each of the {blocks} blocks");
        require(fits, "density_kg_m3", densities as f64, allowed).map(|_| ())
    }

    /// Checks that the joints of an arch are listed from left to right, with the intrados corner below the extrados corner. Otherwise the results
    /// would exchange left and right, or intrados and extrados.
    ///
    /// # Errors
    /// When one of these does not hold.
    pub(crate) fn check_order(&self) -> Result<(), OutlineError> {
        let ([first, .., last], Supports::Both) = (&*self.joints, self.supports) else {
            return Ok(());
        };
        let [from_m, to_m] = [first, last].map(|joint| joint.middle_m().x);
        let blocks = self
            .joints
            .windows(2)
            .map(|pair| pair[0].outline_m(&pair[1]));
        let turn = |[a, b, c, d]: [Vector2<f64>; 4]| (c - a).perp(&(d - b));
        Err(OutlineError(if to_m < from_m {
            format!(
                "the joints are listed from right to left, from x = {from_m:.3} m to x = {to_m:.3} m: list joints, blocks and \
                 densities from left to right"
            )
        } else if blocks.map(turn).sum::<f64>() > 0.0 {
            "intrados and extrados are exchanged: list the intrados corner (the lower side of the arch) first at every joint".to_owned()
        } else {
            return Ok(());
        }))
    }

    /// Checks the outline of a block: its sides do not cross, and the corners of its joints are on them.
    ///
    /// # Errors
    /// When one of these does not hold.
    pub fn check_outline(
        &self,
        block: usize,
        corners: &[Vector2<f64>],
    ) -> Result<(), OutlineError> {
        let number = block + 1;
        let refused = |message: String| Err(OutlineError(message));
        let joints = self.joints.get(block..);
        let Some([before, after]) = joints.and_then(|joints| joints.first_chunk()) else {
            return refused(format!("there is no block {number}"));
        };
        if corners.len() < 3 {
            let count = corners.len();
            return refused(format!(
                "block {number} has {count} corners; give at least three"
            ));
        }
        if let Some((one, two)) = crossing_sides(corners) {
            return refused(format!(
                "the outline of block {number} crosses itself (sides {} and {}): give its corners in order around it",
                one + 1,
                two + 1
            ));
        }
        let mut corners_m = before.outline_m(after).into_iter();
        if let Some(corner_m) = corners_m.find(|corner_m| !is_on_outline(corners, *corner_m)) {
            return refused(format!(
                "the outline of block {number} does not pass through the corner ({:?}, {:?}) of its joint",
                corner_m.x, corner_m.y
            ));
        }
        Ok(())
    }

    /// Outline of every block.
    pub(super) fn outlines_m(&self) -> Vec<Vec<Vector2<f64>>> {
        let pairs = self.joints.windows(2);
        let between = pairs.map(|pair| pair[0].outline_m(&pair[1]).to_vec());
        let mut outlines: Vec<_> = between.collect();
        for (block, outline) in &self.outlines {
            if let Some(known) = outlines.get_mut(*block) {
                known.clone_from(outline);
            }
        }
        outlines
    }

    pub(super) fn blocks(&self) -> Vec<Block> {
        let outlines = self.outlines_m();
        let density = |block: usize| {
            let own = self.density_kg_m3.get(block);
            own.or(self.density_kg_m3.first()).copied().unwrap_or(0.0)
        };
        let outlines = outlines.iter().enumerate();
        outlines
            .map(|(block, outline)| Block::prism(outline, self.depth_m, density(block)))
            .collect()
    }

    pub(super) fn cut(&self) -> CutArch {
        let edge = |corner: fn(&Joint) -> Vector2<f64>| {
            let line = |pair: &[Joint]| Curve::line(corner(&pair[0]), corner(&pair[1]));
            self.joints.windows(2).map(line).collect::<Vec<_>>()
        };
        let last = self.joints.len() - 1;
        let place = |joint: usize| {
            let (piece, part) = match joint < last {
                true => (joint, 0.0),
                false => (joint - 1, 1.0),
            };
            [EdgePosition { piece, part }; 2]
        };
        CutArch {
            intrados: edge(|joint| joint.intrados_m),
            extrados: edge(|joint| joint.extrados_m),
            joints: (0..=last).map(place).collect(),
        }
    }

    /// Whether the left and the right support are ground that extends beyond the joint: the joint is level, and no corner is lower.
    pub(super) fn ground_supports(&self) -> [bool; 2] {
        let corners = self.outlines_m().into_iter().flatten();
        let lowest_m = corners.map(|corner| corner.y).fold(f64::INFINITY, f64::min);
        let least_m = LEVEL_RATIO * self.size_m();
        [0, self.joints.len() - 1].map(|joint| {
            let joint = &self.joints[joint];
            let mut levels_m = [joint.intrados_m.y, joint.extrados_m.y].into_iter();
            levels_m.all(|level_m| level_m - lowest_m <= least_m)
        })
    }

    /// Half the diagonal of the rectangle around the joints, in metres.
    pub(super) fn size_m(&self) -> f64 {
        let corners = || {
            let joints = self.joints.iter();
            joints.flat_map(|joint| [joint.intrados_m, joint.extrados_m])
        };
        let extent = |of: fn(&Vector2<f64>) -> f64| {
            let values = || corners().map(|corner| of(&corner));
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        };
        0.5 * libm::hypot(extent(|corner| corner.x), extent(|corner| corner.y))
    }

    /// Index, from 0, of the block or joint of an error, as a line of the file of joints; `None` for other errors.
    pub fn joint_of(error: &RowError) -> Option<usize> {
        match error {
            RowError::Crossing(joint) => Some(joint + 1),
            RowError::Order { joint, .. } => Some(*joint),
            RowError::Thickness(index, _) | RowError::Block(_, index, ..) => Some(*index),
            _ => None,
        }
    }
}

fn is_on_outline(corners: &[Vector2<f64>], point: Vector2<f64>) -> bool {
    sides(corners).any(|side| distance(side, point) <= 1e-6 * (side[1] - side[0]).norm())
}

/// Indices of two sides of a polygon that cross; `None` if no sides cross.
fn crossing_sides(corners: &[Vector2<f64>]) -> Option<(usize, usize)> {
    let sides: Vec<_> = sides(corners).collect();
    let turns =
        |[from, to]: [Vector2<f64>; 2], point: Vector2<f64>| (to - from).perp(&(point - from));
    let crosses = |one: [Vector2<f64>; 2], two: [Vector2<f64>; 2]| {
        turns(one, two[0]) * turns(one, two[1]) < 0.0
            && turns(two, one[0]) * turns(two, one[1]) < 0.0
    };
    (0..sides.len()).find_map(|one| {
        let two = (one + 1..sides.len()).find(|two| crosses(sides[one], sides[*two]))?;
        Some((one, two))
    })
}
