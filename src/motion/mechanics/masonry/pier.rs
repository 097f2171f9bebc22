//! Piers under the springings of an arch.

use nalgebra::Vector2;
use serde::Serialize;

use super::{MasonryError, Material};
use crate::argument::{ArgumentError, require, require_count, require_within};
use crate::mechanics::arch::MAGNITUDE;
use crate::mechanics::blocks::MAX_BLOCKS;
use crate::mechanics::{Block, Joint, RowError, Sway};

/// Piers under the springings; a springing without a pier is on rigid ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Piers {
    /// Under the left springing.
    pub left: Option<Pier>,
    /// Under the right springing.
    pub right: Option<Pier>,
}

impl Piers {
    /// Whether there is no pier.
    pub const fn are_none(&self) -> bool {
        self.left.is_none() && self.right.is_none()
    }
}

/// Pier of equal courses, as deep as the arch. Its inner side is vertical below the intrados. Its top follows the springing joint, and is level from
/// there outwards.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pier {
    /// Height from the base to the intrados at the springing, in metres.
    pub height_m: f64,
    /// Width in metres.
    pub width_m: f64,
    /// Number of blocks, one on top of the other.
    pub blocks: usize,
    /// Density in kg/m3; `None` for that of the arch.
    pub density_kg_m3: Option<f64>,
    /// True if the pier stands on a pedestal as wide as its base, from which it can slide off; false on ground that extends beyond the base.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub pedestal: bool,
}

/// Blocks with their joints and outlines, in the order of the row.
pub(super) struct Courses {
    pub blocks: Vec<Block>,
    pub joints: Vec<Joint>,
    pub outlines_m: Vec<Vec<Vector2<f64>>>,
}

impl Courses {
    /// Adds the courses of a pier under the springing on this side.
    pub(crate) fn stand_on(
        &mut self,
        pier: &Pier,
        side: Sway,
        material: Material,
    ) -> Result<(), MasonryError> {
        fn add<T>(to: &mut Vec<T>, side: Sway, new: Vec<T>) {
            let at = if side == Sway::Left { 0 } else { to.len() };
            to.splice(at..at, new);
        }
        let springing = match side {
            Sway::Left => self.joints.first(),
            Sway::Right => self.joints.last(),
        };
        let springing = springing.ok_or(RowError::Count(0))?;
        let courses = pier
            .courses(springing, side, material)
            .map_err(|error| MasonryError::Pier(side, error))?;
        let count = self.blocks.len() + courses.blocks.len();
        if count > MAX_BLOCKS {
            return Err(MasonryError::Count(count));
        }
        add(&mut self.blocks, side, courses.blocks);
        add(&mut self.joints, side, courses.joints);
        add(&mut self.outlines_m, side, courses.outlines_m);
        Ok(())
    }
}

impl Pier {
    fn check(&self, springing: &Joint) -> Result<(), ArgumentError> {
        require_within("height_m", self.height_m, MAGNITUDE)?;
        require_within("width_m", self.width_m, MAGNITUDE)?;
        if let Some(density_kg_m3) = self.density_kg_m3 {
            require_within("density_kg_m3", density_kg_m3, MAGNITUDE)?;
        }
        require_count("blocks", self.blocks, 1..=MAX_BLOCKS)?;
        let springing_m = (springing.extrados_m.x - springing.intrados_m.x).abs();
        let fits = self.width_m >= springing_m * (1.0 - 1e-12);
        let allowed =
            format_args!("at least {springing_m:.6}, the width of the springing that it carries");
        require(fits, "width_m", self.width_m, allowed).map(|_| ())
    }

    /// Blocks and all joints except the springing: upwards on the left, downwards on the right.
    fn courses(
        &self,
        springing: &Joint,
        side: Sway,
        material: Material,
    ) -> Result<Courses, ArgumentError> {
        self.check(springing)?;
        let inner = springing.intrados_m;
        let outer_x = inner.x + side.sign() * self.width_m;
        let base_y = inner.y - self.height_m;
        let level = |course: usize| {
            let y = base_y + self.height_m * (course as f64 / self.blocks as f64);
            Joint {
                intrados_m: Vector2::new(inner.x, y),
                extrados_m: Vector2::new(outer_x, y),
            }
        };
        let mut joints: Vec<Joint> = (0..self.blocks).map(level).collect();
        let outline_m = |course: usize| {
            let bottom = level(course);
            if course + 1 < self.blocks {
                return bottom.outline_m(&level(course + 1)).to_vec();
            }
            let shoulder = Vector2::new(outer_x, springing.extrados_m.y);
            let top = [shoulder, springing.extrados_m, inner];
            [[bottom.intrados_m, bottom.extrados_m].as_slice(), &top].concat()
        };
        let mut outlines_m: Vec<_> = (0..self.blocks).map(outline_m).collect();
        if side == Sway::Right {
            joints.reverse();
            outlines_m.reverse();
        }
        let density_kg_m3 = self.density_kg_m3.unwrap_or(material.density_kg_m3);
        let outlines = outlines_m.iter();
        let blocks = outlines.map(|outline| Block::prism(outline, material.depth_m, density_kg_m3));
        Ok(Courses {
            blocks: blocks.collect(),
            joints,
            outlines_m,
        })
    }
}
