//! Masonry of other shapes than the circular arch of equal voussoirs, on piers, with fill and loads: rows of blocks given by their dimensions.
//!
//! Coordinates are in metres, x from the middle of the span to the right. An arch is the area within half a thickness of its middle line, cut by
//! joints normal to this line (`cut`).

mod cut;
mod fill;
mod given;
mod live;
mod load;
mod middle_line;
mod pier;
mod pointed;
mod remedy;

use nalgebra::Vector2;
use serde::Serialize;
use thiserror::Error;

use super::arch::{DENSITY_KG_M3, DEPTH_M, MAGNITUDE, VOUSSOIRS};
use super::blocks::MAX_BLOCKS;
pub use super::load::PlacedLoad;
use super::stability::collapse_mechanism;
use super::tie::TieError;
use crate::argument::{ArgumentError, require, require_count, require_within};
use crate::mechanics::contact::ContactError;
use crate::mechanics::{Joint, Row, RowError, Supports, Sway, Tie};
use cut::CutArch;
pub use fill::{Fill, FillColumn, FillLevel};
pub use given::{GivenBlocks, OutlineError};
pub use live::{LoadedExtrados, MAX_AXLES, Spread, Vehicle};
use middle_line::cut_elliptic;
pub use middle_line::{BasketArch, CircularArch};
use pier::Courses;
pub use pier::{Pier, Piers};
use pointed::cut_pointed;
pub use remedy::Remedy;

/// Depth out of plane and density of a structure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Material {
    /// Length out of plane, in metres.
    pub depth_m: f64,
    /// Density, in kg/m3.
    pub density_kg_m3: f64,
}

impl Default for Material {
    /// Default material: 1 m deep, of 2000 kg/m3.
    fn default() -> Self {
        Self {
            depth_m: DEPTH_M,
            density_kg_m3: DENSITY_KG_M3,
        }
    }
}

impl Material {
    fn check(&self) -> Result<(), ArgumentError> {
        require_within("depth_m", self.depth_m, MAGNITUDE)?;
        require_within("density_kg_m3", self.density_kg_m3, MAGNITUDE)?;
        Ok(())
    }
}

/// Common dimensions of arches of different shapes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Dimensions {
    /// Distance of the springings, from middle to middle, in metres.
    pub span_m: f64,
    /// Height of the middle line at the crown above the springings, in metres.
    pub rise_m: f64,
    /// Thickness normal to the middle line, in metres.
    pub thickness_m: f64,
    /// Number of voussoirs.
    pub voussoirs: usize,
    /// Depth and density.
    #[serde(flatten)]
    pub material: Material,
}

impl Dimensions {
    fn check(&self) -> Result<(), ArgumentError> {
        require_within("span_m", self.span_m, MAGNITUDE)?;
        require_within("rise_m", self.rise_m, MAGNITUDE)?;
        require_within("thickness_m", self.thickness_m, 1e-6..=1e6)?;
        self.material.check()?;
        require_count("voussoirs", self.voussoirs, VOUSSOIRS).map(|_| ())
    }

    /// Checks that the intrados does not turn back on itself where the curvature of the middle line is largest.
    fn check_curvature(&self, least_radius_m: f64) -> Result<(), ArgumentError> {
        let fits = 0.5 * self.thickness_m < least_radius_m;
        let most_m = 2.0 * least_radius_m;
        let allowed = format_args!("below {most_m:.6}, twice the least radius of the middle line");
        require(fits, "thickness_m", self.thickness_m, allowed).map(|_| ())
    }
}

/// Shape of an arch, or blocks of any shape.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MasonryShape {
    /// A circular arch.
    #[serde(rename = "arch")]
    Circular(CircularArch),
    /// Two arcs that meet at an angle.
    PointedArch(Dimensions),
    /// Half an ellipse.
    EllipticArch(Dimensions),
    /// Three arcs.
    BasketArch(BasketArch),
    /// Blocks given by their joints.
    Blocks(GivenBlocks),
}

impl MasonryShape {
    /// Name in scenarios and results.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Circular(_) => "arch",
            Self::PointedArch(_) => "pointed_arch",
            Self::EllipticArch(_) => "elliptic_arch",
            Self::BasketArch(_) => "basket_arch",
            Self::Blocks(_) => "blocks",
        }
    }

    /// Material; for blocks with individual densities, that of the first block.
    pub fn material(&self) -> Material {
        match self {
            Self::Circular(arch) => arch.material(),
            Self::PointedArch(dimensions)
            | Self::EllipticArch(dimensions)
            | Self::BasketArch(BasketArch { dimensions, .. }) => dimensions.material,
            Self::Blocks(blocks) => Material {
                depth_m: blocks.depth_m,
                density_kg_m3: *blocks.density_kg_m3.first().unwrap_or(&DENSITY_KG_M3),
            },
        }
    }

    fn cut(&self) -> Result<CutArch, MasonryError> {
        Ok(match self {
            Self::Circular(arch) => arch.cut(),
            Self::PointedArch(dimensions) => cut_pointed(dimensions)?,
            Self::EllipticArch(dimensions) => cut_elliptic(dimensions)?,
            Self::BasketArch(arch) => arch.cut()?,
            Self::Blocks(blocks) => {
                blocks.check()?;
                for (block, corners) in &blocks.outlines {
                    blocks.check_outline(*block, corners)?;
                }
                return Ok(blocks.cut());
            }
        })
    }

    /// Length that scales energies and steps: the mean radius of a circle, otherwise half the span; for blocks half the diagonal of the
    /// rectangle around their joints.
    fn size_m(&self) -> f64 {
        match self {
            Self::Circular(arch) => arch.arch.mean_radius_m,
            Self::PointedArch(dimensions)
            | Self::EllipticArch(dimensions)
            | Self::BasketArch(BasketArch { dimensions, .. }) => 0.5 * dimensions.span_m,
            Self::Blocks(blocks) => blocks.size_m(),
        }
    }
}

/// Arch of any shape, with its piers, fill and loads.
#[readonly::make]
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Masonry {
    /// Shape of the arch.
    #[serde(flatten)]
    pub shape: MasonryShape,
    /// Piers under its springings.
    #[serde(skip_serializing_if = "Piers::are_none")]
    pub piers: Piers,
    /// Fill above the arch.
    pub fill: Option<Fill>,
    /// Loads on its extrados and on its piers.
    #[serde(rename = "load", skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<PlacedLoad>,
    /// Vehicle that crosses it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vehicle: Option<Vehicle>,
    /// Blocks and joints.
    #[serde(skip)]
    pub row: Row,
    /// Fill and loads in pictures.
    #[serde(skip)]
    pub load_outlines: LoadOutlines,
}

/// Fill and loads of an arch for pictures, each with the block that carries it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOutlines {
    /// Corners of the fill above each block, in metres.
    pub fill_m: Vec<FillColumn>,
    /// Block of each load, and the position of its middle, in metres.
    pub loads_m: Vec<(usize, Vector2<f64>)>,
}

/// Places loads on an arch and its piers; `first` is the index of the first voussoir. Returns the row with the moving masses on its piers, and the
/// loads for pictures.
fn place_loads(
    loads: &[PlacedLoad],
    arch: &CutArch,
    (piers, first): (&Piers, usize),
    mut row: Row,
) -> Result<(Row, LoadOutlines), MasonryError> {
    let mut placed = LoadOutlines::default();
    let loads_m = &mut placed.loads_m;
    for (index, load) in loads.iter().enumerate() {
        let Some(side) = load.pier else {
            let place = load.place_m(arch);
            loads_m.extend(place.map(|(voussoir, at_m)| (first + voussoir, at_m)));
            continue;
        };
        let pier = match side {
            Sway::Left => piers.left,
            Sway::Right => piers.right,
        };
        let pier = pier.ok_or(MasonryError::NoPier(index, side))?;
        let place = load.place_on_pier_m(side, &pier, &row);
        let (block, at_m) = place.map_err(|error| MasonryError::Load(index, error))?;
        if let Some(body) = load.moving_body(at_m) {
            row = row.with_body(block, &body);
        }
        loads_m.push((block, at_m));
    }
    Ok((row, placed))
}

/// Reason why masonry is not valid.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MasonryError {
    /// A number of the shape is out of range.
    #[error("{0}")]
    Shape(#[from] ArgumentError),
    /// A number of the pier on this side is out of range.
    #[error("{side} pier: {1}", side = .0.name())]
    Pier(Sway, ArgumentError),
    /// A number of the fill is out of range.
    #[error("fill: {0}")]
    Fill(ArgumentError),
    /// A number of the load of this index, from 0, is out of range.
    #[error("load {number}: {1}", number = .0 + 1)]
    Load(usize, ArgumentError),
    /// The load with this index is on a pier that the arch does not have.
    #[error("load {number} is on the {side} pier, and there is none", number = .0 + 1, side = .1.name())]
    NoPier(usize, Sway),
    /// The order of the joints or the outline of a block is not valid.
    #[error(transparent)]
    Outline(#[from] OutlineError),
    /// The blocks do not form a row.
    #[error(transparent)]
    Row(#[from] RowError),
    /// A number of the vehicle is out of range.
    #[error("vehicle: {0}")]
    Vehicle(ArgumentError),
    /// A vehicle crosses blocks that are no arch.
    #[error("a vehicle crosses an arch between two supports, whose extrados is its upper side")]
    NoRoad,
    /// A vehicle spreads through fill, and there is none.
    #[error("the axles spread through fill, and there is none")]
    NoFill,
    /// Blocks have piers or fill, which are possible only for arches given by their dimensions.
    #[error("blocks have no piers and no fill: give those as blocks")]
    Blocks,
    /// The number of blocks exceeds the maximum of a row.
    #[error("{0} blocks with the piers: a row has at most {MAX_BLOCKS}")]
    Count(usize),
}

impl Masonry {
    /// Arch on its piers, with fill and loads. Its stability is not checked: see [`Masonry::stands`].
    ///
    /// # Errors
    /// If a number is out of range, or the blocks do not form a row.
    pub fn new(
        shape: MasonryShape,
        piers: Piers,
        fill: Option<Fill>,
        loads: Vec<PlacedLoad>,
    ) -> Result<Self, MasonryError> {
        let arch = shape.cut()?;
        let mut extra = vec![None; arch.voussoirs()];
        let given = match &shape {
            MasonryShape::Blocks(given) => Some(given),
            _ => None,
        };
        if given.is_some() && (!piers.are_none() || fill.is_some()) {
            return Err(MasonryError::Blocks);
        }
        let material = shape.material();
        if let Some(fill) = &fill {
            fill.add_to(&mut extra, &arch, material)
                .map_err(MasonryError::Fill)?;
        }
        for (index, load) in loads.iter().enumerate() {
            let fits = load.check_on_arch().and_then(|()| match load.pier {
                None => load.add_to(&mut extra, &arch),
                Some(_) => Ok(()),
            });
            fits.map_err(|error| MasonryError::Load(index, error))?;
        }
        let (blocks, outlines_m) = match given {
            Some(given) => (given.blocks(), given.outlines_m()),
            None => (arch.blocks(material), arch.outlines_for_drawing()),
        };
        let mut courses = Courses {
            blocks,
            joints: arch.joints(),
            outlines_m,
        };
        let supports = given.map_or(Supports::Both, |given| given.supports);
        if supports == Supports::Left {
            courses.joints.pop();
        }
        for (side, pier) in [(Sway::Left, &piers.left), (Sway::Right, &piers.right)] {
            if let Some(pier) = pier {
                courses.stand_on(pier, side, material)?;
            }
        }
        let first = piers.left.map_or(0, |pier| pier.blocks);
        let on_ground = given.map_or_else(
            || [piers.left, piers.right].map(|pier| pier.is_some_and(|pier| !pier.pedestal)),
            GivenBlocks::ground_supports,
        );
        let mut row = Row::new(courses.blocks, courses.joints, supports, shape.size_m())?
            .with_outlines_m(courses.outlines_m)
            .with_supports_that_extend(on_ground);
        given.map_or(Ok(()), GivenBlocks::check_order)?;
        for (voussoir, extra) in extra.iter().enumerate() {
            if let Some(extra) = extra {
                row = row.with_body(first + voussoir, extra);
            }
        }
        let (row, fill_m) = match &fill {
            Some(fill) => fill.lay_on(row, (&piers, first), &arch, material.depth_m),
            None => Ok((row, Vec::new())),
        }
        .map_err(MasonryError::Fill)?;
        let (row, mut load_outlines) = place_loads(&loads, &arch, (&piers, first), row)?;
        load_outlines.fill_m = fill_m;
        Ok(Self {
            shape,
            piers,
            fill,
            loads,
            vehicle: None,
            row,
            load_outlines,
        })
    }

    /// Joints at the springings of the arch; `None` for given blocks, whose springings are unknown.
    pub fn springings(&self) -> Option<[Joint; 2]> {
        let joints = self.springing_joints()?;
        Some(joints.map(|joint| self.row.joints[joint]))
    }

    /// Whether the masonry is stable under its own weight.
    ///
    /// # Errors
    /// If the velocities under the weight are not found.
    pub fn stands(&self) -> Result<bool, ContactError> {
        Ok(collapse_mechanism(&self.row)?.is_none())
    }

    /// Indices of the joints at the left and the right springing; `None` for given blocks, whose springings are unknown.
    pub fn springing_joints(&self) -> Option<[usize; 2]> {
        if matches!(self.shape, MasonryShape::Blocks(_)) {
            return None;
        }
        let courses =
            [self.piers.left, self.piers.right].map(|pier| pier.map_or(0, |pier| pier.blocks));
        Some([courses[0], self.row.joints.len() - 1 - courses[1]])
    }

    /// This masonry with the constant forces of its loads in place of ties, under this gravity.
    #[must_use]
    pub fn with_constant_forces(mut self, gravity_m_s2: f64) -> Self {
        let loads = self.loads.iter().zip(&self.load_outlines.loads_m);
        let forces: Vec<_> = loads
            .map(|(load, (block, at_m))| (*block, *at_m, load.constant_force_n(gravity_m_s2)))
            .collect();
        self.row = self.row.with_constant_forces(forces, gravity_m_s2);
        self
    }

    /// This masonry with these ties in place of its own, under this gravity.
    ///
    /// # Errors
    /// If a tie is not valid, with its index.
    pub fn with_ties(
        mut self,
        ties: Vec<Tie>,
        gravity_m_s2: f64,
    ) -> Result<Self, (usize, TieError)> {
        self.row = self.row.with_ties(ties, gravity_m_s2)?;
        Ok(self)
    }
}
