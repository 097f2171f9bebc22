//! Fill above an arch and its piers, as weight and mass that move with the block below.
//!
//! The fill vertically above the extrados of a voussoir, up to a level top, is part of its rigid block; that above the top of a pier, outside the
//! extrados, is part of its top block. Other effects of real fill are neglected: lateral pressure, spreading of loads, passive resistance against the
//! haunches, and shear between columns that move differently.

use nalgebra::Vector2;
use serde::Serialize;

use super::cut::{CutArch, top};
use super::{Material, Piers};
use crate::argument::{ArgumentError, require_within};
use crate::mechanics::arch::MAGNITUDE;
use crate::mechanics::load::is_true;
use crate::mechanics::{Block, Curve, Row};

/// Fill up to a level top.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fill {
    /// Level of its top.
    #[serde(flatten)]
    pub level: FillLevel,
    /// Density of the fill in kg/m3.
    pub density_kg_m3: f64,
    /// True if it also lies on the tops of piers outside the extrados, as part of their top blocks.
    #[serde(skip_serializing_if = "is_true")]
    pub on_piers: bool,
}

/// Level of the top of the fill.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum FillLevel {
    /// Height above the extrados at the left springing, in metres; below the crown the fill covers the haunches only.
    #[serde(rename = "height_m")]
    AboveSpringing(f64),
    /// Height above the crown of the extrados, in metres.
    #[serde(rename = "above_crown_m")]
    AboveCrown(f64),
}

impl Fill {
    pub(super) fn add_to(
        &self,
        extra: &mut [Option<Block>],
        arch: &CutArch,
        material: Material,
    ) -> Result<(), ArgumentError> {
        require_within("density_kg_m3", self.density_kg_m3, MAGNITUDE)?;
        let level_m = self.level_m(arch)?;
        for (voussoir, extra) in extra.iter_mut().enumerate() {
            let pieces = arch
                .extrados_of(voussoir)
                .into_iter()
                .flat_map(|piece| parts_below(&piece, level_m));
            let columns = pieces.map(|piece| {
                let (from, to) = (piece.point(0.0), piece.point(1.0));
                let corners = [to.x, from.x].map(|x| Vector2::new(x, level_m));
                let ends = [to, corners[0], corners[1], from];
                let sides = ends.windows(2).map(|ends| Curve::line(ends[0], ends[1]));
                let outline = [piece].into_iter().chain(sides);
                Block::bounded(outline, from, material.depth_m, self.density_kg_m3)
            });
            // Slivers without area, as at a level joint, have no weight.
            let heavy = columns.filter(|block| block.mass_kg > 0.0 && block.inertia_kg_m2 > 0.0);
            if let Some(below) = heavy.reduce(|sum, next| sum.with(&next)) {
                *extra = Some(extra.map_or(below, |known| known.with(&below)));
            }
        }
        Ok(())
    }

    /// Lays fill on the tops of the piers of a row whose first voussoir has this index. Returns the row, and all fill to draw. The extrados of an arch
    /// leans inwards from its springings, so nothing is above such fill.
    pub(super) fn lay_on(
        &self,
        mut row: Row,
        (piers, first): (&Piers, usize),
        arch: &CutArch,
        depth_m: f64,
    ) -> Result<(Row, Vec<FillColumn>), ArgumentError> {
        let (joints, level_m) = (arch.joints(), self.level_m(arch)?);
        let mut columns = self.outlines_for_drawing(arch)?;
        columns.iter_mut().for_each(|(block, _)| *block += first);
        let sides = [
            (piers.left, -1.0, 0, first.wrapping_sub(1)),
            (piers.right, 1.0, joints.len() - 1, first + arch.voussoirs()),
        ];
        for (pier, sign, springing, top) in sides {
            let from = joints[springing].extrados_m;
            let width_m = pier.map_or(0.0, |pier| pier.width_m);
            let to_x = joints[springing].intrados_m.x + sign * width_m;
            let is_covered = sign * (to_x - from.x) > 1e-9 * width_m && level_m > from.y;
            if self.on_piers && is_covered {
                let corners = [
                    (from.x, from.y),
                    (to_x, from.y),
                    (to_x, level_m),
                    (from.x, level_m),
                ];
                let corners_m = corners.map(|(x, y)| Vector2::new(x, y)).to_vec();
                row = row.with_body(top, &Block::prism(&corners_m, depth_m, self.density_kg_m3));
                columns.push((top, corners_m));
            }
        }
        Ok((row, columns))
    }

    /// Height of its top, in metres.
    pub(super) fn level_m(&self, arch: &CutArch) -> Result<f64, ArgumentError> {
        match self.level {
            FillLevel::AboveSpringing(height_m) => {
                require_within("height_m", height_m, MAGNITUDE)?;
                Ok(arch.joints()[0].extrados_m.y + height_m)
            }
            FillLevel::AboveCrown(height_m) => {
                require_within("above_crown_m", height_m, 0.0..=1e6)?;
                Ok(arch.crown_m() + height_m)
            }
        }
    }

    /// Fill above each voussoir: index of the voussoir, and corners of a polygon to draw the fill.
    fn outlines_for_drawing(&self, arch: &CutArch) -> Result<Vec<FillColumn>, ArgumentError> {
        let level_m = self.level_m(arch)?;
        let outline = |piece: &Curve| {
            let parts = (0..=DRAWN_POINTS).map(|i| f64::from(i) / f64::from(DRAWN_POINTS));
            let mut outline: Vec<Vector2<f64>> = parts.map(|part| piece.point(part)).collect();
            let ends = [outline[outline.len() - 1].x, outline[0].x];
            outline.extend(ends.map(|x| Vector2::new(x, level_m)));
            outline
        };
        let columns = (0..arch.voussoirs()).flat_map(|voussoir| {
            let pieces = arch.extrados_of(voussoir).into_iter();
            let below = pieces.flat_map(|piece| parts_below(&piece, level_m));
            below.map(move |piece| (voussoir, outline(&piece)))
        });
        Ok(columns.collect())
    }
}

/// Fill above a block: index of the block, and corners of a polygon to draw the fill, in metres.
pub type FillColumn = (usize, Vec<Vector2<f64>>);

/// Number of segments to draw the curved side of a column of fill.
const DRAWN_POINTS: u32 = 4;

/// Parts of a piece of the extrados that lie below a level.
fn parts_below(piece: &Curve, level_m: f64) -> Vec<Curve> {
    let top = top(piece);
    let under = |part: f64| piece.point(part).y < level_m;
    // The piece rises up to its top and falls from there.
    let rising = (top > 0.0 && under(0.0)).then(|| {
        let half = piece.between(0.0, top);
        half.between(0.0, half.first(|part| half.point(part).y >= level_m))
    });
    let falling = (top < 1.0 && under(1.0)).then(|| {
        let half = piece.between(top, 1.0);
        half.between(half.first(|part| half.point(part).y < level_m), 1.0)
    });
    rising.into_iter().chain(falling).collect()
}
