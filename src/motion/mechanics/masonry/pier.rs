//! Piers: the springings of an arch stand on them.

use nalgebra::Vector2;
use serde::Serialize;

use crate::argument::{ArgumentError, within};
use crate::mechanics::arch::MAGNITUDE;
use crate::mechanics::blocks::{Block, Joint, MAX_BLOCKS};
use crate::mechanics::sway::Sway;

/// Piers under the springings; a springing without one stands on rigid ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Piers {
    /// Under the left springing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<Pier>,
    /// Under the right springing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right: Option<Pier>,
}

impl Piers {
    /// Whether there is no pier.
    #[must_use]
    pub const fn are_none(&self) -> bool {
        self.left.is_none() && self.right.is_none()
    }
}

/// A pier of equal courses, as deep as the arch. Its inner side is vertical below the intrados; its top rises along
/// the springing, and is level from there outwards.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pier {
    /// From the base to the intrados at the springing, in metres.
    pub height_m: f64,
    /// Width in metres.
    pub width_m: f64,
    /// Number of blocks, one on top of the other.
    pub blocks: usize,
    /// Density in kg/m3; `None`: that of the arch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density_kg_m3: Option<f64>,
    /// Whether it stands on a pedestal as wide as its base, off which it falls if it slips too far; else on ground that extends
    /// beyond the base.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub pedestal: bool,
}

/// The blocks of a pier in the order of the row: upwards at the left, downwards at the right.
pub(super) struct Courses {
    /// Joints without the springing.
    pub joints: Vec<Joint>,
    pub outlines_m: Vec<Vec<Vector2<f64>>>,
}

impl Courses {
    pub fn blocks(&self, depth_m: f64, density_kg_m3: f64) -> Vec<Block> {
        let outlines = self.outlines_m.iter();
        outlines
            .map(|outline| Block::prism(outline, depth_m, density_kg_m3))
            .collect()
    }
}

impl Pier {
    fn check(&self, springing: &Joint) -> Result<(), ArgumentError> {
        within("height_m", self.height_m, MAGNITUDE)?;
        within("width_m", self.width_m, MAGNITUDE)?;
        if let Some(density_kg_m3) = self.density_kg_m3 {
            within("density_kg_m3", density_kg_m3, MAGNITUDE)?;
        }
        if !(1..=MAX_BLOCKS).contains(&self.blocks) {
            return Err(ArgumentError {
                argument: "blocks",
                value: self.blocks as f64,
                allowed: format!("from 1 to {MAX_BLOCKS}"),
            });
        }
        let springing_m = (springing.extrados_m.x - springing.intrados_m.x).abs();
        if self.width_m < springing_m * (1.0 - 1e-12) {
            return Err(ArgumentError {
                argument: "width_m",
                value: self.width_m,
                allowed: format!(
                    "at least {springing_m:.6}, the width of the springing that it carries"
                ),
            });
        }
        Ok(())
    }

    pub(super) fn courses(&self, springing: &Joint, side: Sway) -> Result<Courses, ArgumentError> {
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
        let mut outlines_m: Vec<Vec<Vector2<f64>>> = (0..self.blocks)
            .map(|course| {
                let bottom = level(course);
                let mut outline = vec![bottom.intrados_m, bottom.extrados_m];
                if course + 1 < self.blocks {
                    let top = level(course + 1);
                    outline.extend([top.extrados_m, top.intrados_m]);
                } else {
                    let shoulder = Vector2::new(outer_x, springing.extrados_m.y);
                    outline.extend([shoulder, springing.extrados_m, inner]);
                }
                outline
            })
            .collect();
        if side == Sway::Right {
            joints.reverse();
            outlines_m.reverse();
        }
        Ok(Courses { joints, outlines_m })
    }
}
