//! The structure of a check in numbers: dimensions, corners and masses of its blocks, fill, and loads.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::mechanics::masonry::{Fill, FillLevel};
use crate::mechanics::{MasonryShape, PlacedLoad};
use crate::scenario::{Scenario, Structure};
use crate::{Masonry, Row};

/// The structure of a check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Geometry {
    /// Name of the structure, as the table of the scenario.
    pub shape: String,
    /// Depth out of plane, in metres.
    pub depth_m: f64,
    /// Density of the masonry, in kg/m3; of the first block, if blocks differ.
    pub density_kg_m3: f64,
    /// The ring of an arch between two circles; `None` for other structures.
    pub ring: Option<RingGeometry>,
    /// The blocks from left to right, or upwards; empty for a ring.
    pub blocks: Vec<PlacedBlock>,
    /// Fill above the arch; `None` without fill.
    pub fill: Option<FillGeometry>,
    /// Loads.
    pub loads: Vec<LoadAt>,
}

/// The ring of a circular arch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RingGeometry {
    /// Mean radius, in metres.
    pub mean_radius_m: f64,
    /// Thickness, in metres.
    pub thickness_m: f64,
    /// Embrace angle, in degrees.
    pub embrace_deg: f64,
    /// Number of equal voussoirs; `None` without joints.
    pub voussoirs: Option<usize>,
}

/// A block with its masses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedBlock {
    /// Corners of the block in metres, in order; curved sides have points in between.
    pub corners_m: Vec<Vector2<f64>>,
    /// Density of the masonry, in kg/m3.
    pub density_kg_m3: f64,
    /// Mass of the masonry, in kg.
    pub masonry_kg: f64,
    /// Mass of the fill that moves with the block, in kg.
    pub fill_kg: f64,
    /// Mass of the loads that move with the block, in kg.
    pub loads_kg: f64,
    /// Centre of gravity of all these masses, in metres.
    pub centre_m: Vector2<f64>,
}

/// Fill up to a level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FillGeometry {
    /// Height of its top, in metres.
    pub height_m: f64,
    /// True if the height is above the crown of the extrados, false if it is above its left springing.
    pub is_above_crown: bool,
    /// Density, in kg/m3.
    pub density_kg_m3: f64,
}

impl FillGeometry {
    const fn new(fill: Fill) -> Self {
        let (height_m, is_above_crown) = match fill.level {
            FillLevel::AboveSpringing(height_m) => (height_m, false),
            FillLevel::AboveCrown(height_m) => (height_m, true),
        };
        Self {
            height_m,
            is_above_crown,
            density_kg_m3: fill.density_kg_m3,
        }
    }
}

/// A load with its position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadAt {
    /// Number of the block that carries the load, from 1.
    pub block: usize,
    /// Position of the load, or of its middle, in metres.
    pub at_m: Vector2<f64>,
    /// Width over which the mass is distributed, in metres.
    pub width_m: f64,
    /// Mass, in kg.
    pub mass_kg: f64,
    /// True if the mass moves with the block; false if only its weight acts.
    pub moves: bool,
    /// Constant horizontal force, in kN, positive to the right.
    pub thrust_kn: f64,
}

impl Geometry {
    /// Geometry of the structure of a scenario.
    pub(super) fn of(scenario: &Scenario) -> Self {
        let structure = &scenario.structure;
        let (depth_m, density_kg_m3) = structure.depth_and_density();
        let row = structure.row().ok();
        let mut geometry = Self {
            shape: "arch".to_owned(),
            depth_m,
            density_kg_m3,
            ring: None,
            blocks: Vec::new(),
            fill: None,
            loads: Vec::new(),
        };
        match structure {
            Structure::Arch(arch) => {
                geometry.ring = Some(RingGeometry {
                    mean_radius_m: arch.mean_radius_m,
                    thickness_m: arch.thickness_ratio * arch.mean_radius_m,
                    embrace_deg: arch.embrace_deg,
                    voussoirs: arch.voussoirs,
                });
            }
            Structure::Column(column) => {
                let bare = column
                    .clone()
                    .with_loads(Vec::new(), scenario.gravity_m_s2());
                let bare = bare.ok().and_then(|bare| bare.row().ok());
                let shape = column.given.map_or("column", |_| "body");
                geometry.shape = shape.to_owned();
                let rows = [row.as_ref(), bare.as_ref(), bare.as_ref()];
                geometry.blocks = blocks(rows, |_| density_kg_m3);
                geometry.loads = loads(&column.loads, &column.load_outlines().loads_m);
            }
            Structure::Masonry(masonry) => {
                let without = |fill| {
                    let (shape, piers) = (masonry.shape.clone(), masonry.piers);
                    Masonry::new(shape, piers, fill, Vec::new()).ok()
                };
                let (filled, bare) = (without(masonry.fill), without(None));
                let rows = [&filled, &bare].map(|one| one.as_ref().map(|one| &one.row));
                geometry.shape = masonry.shape.name().to_owned();
                let given = match &masonry.shape {
                    MasonryShape::Blocks(given) => &*given.density_kg_m3,
                    _ => &[],
                };
                let [left, right] = masonry.springing_joints().unwrap_or([0, usize::MAX]);
                let of_pier = |block| match block {
                    _ if block < left => masonry.piers.left?.density_kg_m3,
                    _ if block >= right => masonry.piers.right?.density_kg_m3,
                    _ => None,
                };
                let density = |block| {
                    let own = given.get(block).copied().or_else(|| of_pier(block));
                    own.unwrap_or(density_kg_m3)
                };
                geometry.blocks = blocks([row.as_ref(), rows[0], rows[1]], density);
                geometry.fill = masonry.fill.map(FillGeometry::new);
                geometry.loads = loads(&masonry.loads, &masonry.load_outlines.loads_m);
            }
        }
        geometry
    }

    /// True if the page prints the density of each block.
    pub(super) fn has_densities(&self) -> bool {
        let mut blocks = self.blocks.iter();
        self.shape == "blocks" || blocks.any(|one| one.density_kg_m3 != self.density_kg_m3)
    }
}

/// Blocks of a row, given as well without its loads, and without loads and fill.
fn blocks(
    [row, filled, bare]: [Option<&Row>; 3],
    density_kg_m3: impl Fn(usize) -> f64,
) -> Vec<PlacedBlock> {
    let (Some(row), Some(filled), Some(bare)) = (row, filled, bare) else {
        return Vec::new();
    };
    let outlines = row.outlines_m.iter().zip(&row.blocks);
    let blocks = outlines.zip(filled.blocks.iter().zip(&bare.blocks));
    let placed =
        (0..).zip(blocks).map(
            |(index, ((corners_m, whole), (filled, bare)))| PlacedBlock {
                corners_m: corners_m.clone(),
                density_kg_m3: density_kg_m3(index),
                masonry_kg: bare.mass_kg,
                fill_kg: filled.mass_kg - bare.mass_kg,
                loads_kg: whole.mass_kg - filled.mass_kg,
                centre_m: whole.centre_m,
            },
        );
    placed.collect()
}

fn loads(loads: &[PlacedLoad], places_m: &[(usize, Vector2<f64>)]) -> Vec<LoadAt> {
    let placed = loads
        .iter()
        .zip(places_m)
        .map(|(load, (block, at_m))| LoadAt {
            block: block + 1,
            at_m: *at_m,
            width_m: load.width_m,
            mass_kg: load.mass_kg,
            moves: load.moves,
            thrust_kn: load.thrust_n / 1000.0,
        });
    placed.collect()
}
