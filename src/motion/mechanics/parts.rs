//! Parts of a structure and their positions, as a common interface of arch, column and row of blocks.

use nalgebra::Vector2;

use super::geometry::curve::{distance, sides};
use crate::mechanics::{Arch, Block, Column, Edge, Ring, Row, Supports};

/// Number of equal parts that represent a continuous ring. The relative error of the participating mass is of the order of the square of their size,
/// 1e-6.
const PARTS: usize = 720;

/// Part of a structure that no hinge divides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Position of its middle along the structure: angle from the left springing in radians, or index of the joint before it plus one half.
    pub place: f64,
    /// Mass of the part, in kg.
    pub mass_kg: f64,
    /// Centre of gravity of the part, in metres.
    pub centre_m: Vector2<f64>,
}

/// Bodies of a drawing of a structure, in metres.
#[derive(Clone, Debug)]
pub enum Outline {
    /// Ring that is cut at its hinges, drawn with these joints.
    Ring {
        /// The ring.
        ring: Ring,
        /// Mean radius of the ring, in metres.
        mean_radius_m: f64,
        /// Joints of the ring, in radians from the left springing; empty if hinges open anywhere.
        joints_rad: Vec<f64>,
    },
    /// One body, with its corners, in metres.
    Block(Vec<Vector2<f64>>),
    /// One body per block, with the corners of each, in metres.
    Row(Vec<Vec<Vector2<f64>>>),
}

/// Undeformed section at which the position of the thrust line is known, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StructureSection {
    /// Midpoint of the section, in metres.
    pub middle_m: Vector2<f64>,
    /// Vector from its intrados end to its extrados end; in a column, from left to right.
    pub across_m: Vector2<f64>,
    /// Angle, in radians from the left springing, for an arch that is cut at its hinges; `None` for other structures.
    pub angle_rad: Option<f64>,
}

/// Access to the parts of a structure and their positions.
pub trait Parts {
    /// Parts from left to right, or upwards.
    fn parts(&self) -> Vec<Part>;

    /// Bodies of its drawing.
    fn outline(&self) -> Outline;

    /// Sections at which the position of the thrust line is known, from left to right, or upwards.
    fn sections(&self) -> Vec<StructureSection>;

    /// Parts in words.
    fn parts_in_words(&self) -> String;

    /// Crown, the highest point: position along the structure, and coordinates in metres.
    fn crown(&self) -> (f64, Vector2<f64>);

    /// Position along the structure of a point in metres; `None` for a point outside the structure.
    fn place_of(&self, at_m: Vector2<f64>) -> Option<f64>;
}

impl Parts for Arch {
    fn parts(&self) -> Vec<Part> {
        let (ring, radius_m) = (self.ring(), self.mean_radius_m);
        let unit_kg = self.density_kg_m3 * self.depth_m * radius_m * radius_m;
        let sections = ring.sections(self.voussoirs.unwrap_or(PARTS));
        let parts = sections.windows(2).map(|ends| {
            let sector = ring.sector(ends[0], ends[1]);
            Part {
                place: 0.5 * (ends[0] + ends[1]),
                mass_kg: sector.mass * unit_kg,
                centre_m: sector.centroid() * radius_m,
            }
        });
        parts.collect()
    }

    fn outline(&self) -> Outline {
        let ring = self.ring();
        Outline::Ring {
            joints_rad: self.voussoirs.map_or_else(Vec::new, |n| ring.sections(n)),
            ring,
            mean_radius_m: self.mean_radius_m,
        }
    }

    fn sections(&self) -> Vec<StructureSection> {
        let (ring, mean_radius_m) = (self.ring(), self.mean_radius_m);
        let sections = self
            .thrust_sections_rad()
            .into_iter()
            .map(|angle_rad| StructureSection {
                middle_m: ring.radial_direction(angle_rad) * mean_radius_m,
                across_m: ring.radial_direction(angle_rad) * (ring.thickness_ratio * mean_radius_m),
                angle_rad: Some(angle_rad),
            });
        sections.collect()
    }

    fn parts_in_words(&self) -> String {
        match self.voussoirs {
            Some(voussoirs) => format!("{voussoirs} voussoirs"),
            None => format!("{PARTS} equal parts of the ring"),
        }
    }

    fn crown(&self) -> (f64, Vector2<f64>) {
        let middle = 0.5 * self.ring().embrace_rad;
        let at_m = self.ring().point(middle, Edge::Extrados) * self.mean_radius_m;
        (middle, at_m)
    }

    fn place_of(&self, at_m: Vector2<f64>) -> Option<f64> {
        let (ring, radius_m) = (self.ring(), self.mean_radius_m);
        let ratio = at_m.norm() / radius_m;
        let half = 0.5 * ring.thickness_ratio * (1.0 + 1e-9);
        let angle_rad = 0.5 * ring.embrace_rad + libm::atan2(at_m.x, at_m.y);
        ((ratio - 1.0).abs() <= half && (0.0..=ring.embrace_rad).contains(&angle_rad))
            .then_some(angle_rad)
    }
}

impl Parts for Column {
    fn parts(&self) -> Vec<Part> {
        let body = self.body();
        vec![Part {
            place: 0.5,
            mass_kg: body.mass_kg,
            centre_m: body.centre_m,
        }]
    }

    /// Draws one block for all drums, or the separate drums of a column with ties.
    fn outline(&self) -> Outline {
        if let Some(row) = self.tied_row() {
            return row.outline();
        }
        let [base_m, top_m] = [self.width_m, self.top_width_m()].map(|width_m| 0.5 * width_m);
        let height_m = self.height_m;
        let corners = [
            (-base_m, 0.0),
            (-top_m, height_m),
            (top_m, height_m),
            (base_m, 0.0),
        ];
        Outline::Block(corners.map(|(x, y)| Vector2::new(x, y)).to_vec())
    }

    fn sections(&self) -> Vec<StructureSection> {
        if let Some(row) = self.tied_row() {
            return row.sections();
        }
        let sections = self
            .thrust_sections_m()
            .into_iter()
            .map(|height_m| StructureSection {
                middle_m: Vector2::new(0.0, height_m),
                across_m: Vector2::new(self.width_m, 0.0),
                angle_rad: None,
            });
        sections.collect()
    }

    fn parts_in_words(&self) -> String {
        "the column as one block".to_owned()
    }

    fn crown(&self) -> (f64, Vector2<f64>) {
        (0.5, Vector2::new(0.0, self.height_m))
    }

    fn place_of(&self, at_m: Vector2<f64>) -> Option<f64> {
        let inside = at_m.x.abs() <= 0.5 * self.width_m && (0.0..=self.height_m).contains(&at_m.y);
        inside.then_some(0.5)
    }
}

impl Column {
    /// Blocks; `None` without ties.
    fn tied_row(&self) -> Option<Row> {
        self.row().ok().filter(|row| !row.bars().is_empty())
    }
}

impl Parts for Row {
    fn parts(&self) -> Vec<Part> {
        let blocks = self.blocks.iter().enumerate();
        let part = |(index, block): (usize, &Block)| Part {
            place: middle_of(index),
            mass_kg: block.mass_kg,
            centre_m: block.centre_m,
        };
        blocks.map(part).collect()
    }

    fn outline(&self) -> Outline {
        Outline::Row(self.outlines_m.to_vec())
    }

    fn sections(&self) -> Vec<StructureSection> {
        let sections = self.joints.iter().map(|joint| StructureSection {
            middle_m: joint.middle_m(),
            across_m: joint.extrados_m - joint.intrados_m,
            angle_rad: None,
        });
        sections.collect()
    }

    fn parts_in_words(&self) -> String {
        match self.blocks.len() {
            1 => "one block".to_owned(),
            blocks => format!("{blocks} blocks"),
        }
    }

    /// For a stack on one support with a level top, the crown is the middle of the top.
    fn crown(&self) -> (f64, Vector2<f64>) {
        let outlines = self.outlines_m.iter().enumerate();
        let corners = outlines.flat_map(|(block, outline)| {
            let corners = outline.iter();
            corners.map(move |corner| (middle_of(block), *corner))
        });
        let highest = corners.clone().reduce(|highest, next| {
            let is_higher = next.1.y > highest.1.y;
            if is_higher { next } else { highest }
        });
        let (place, highest_m) = highest.expect("a row has blocks");
        if self.supports == Supports::Both {
            return (place, highest_m);
        }
        let level_m = highest_m.y - 1e-9 * self.size_m;
        let top = corners.filter(|corner| corner.0 == place && corner.1.y >= level_m);
        let top_m = top.map(|corner| corner.1.x);
        let low_m = top_m.clone().fold(f64::INFINITY, f64::min);
        let high_m = top_m.fold(f64::NEG_INFINITY, f64::max);
        (place, Vector2::new(0.5 * (low_m + high_m), highest_m.y))
    }

    fn place_of(&self, at_m: Vector2<f64>) -> Option<f64> {
        self.blocks_at(at_m).first().map(|block| middle_of(*block))
    }
}

impl Row {
    /// Blocks that contain a point, given in metres, or have it on their edge.
    pub fn blocks_at(&self, at_m: Vector2<f64>) -> Vec<usize> {
        let blocks = 0..self.outlines_m.len();
        blocks
            .filter(|block| contains(&self.outlines_m[*block], at_m))
            .collect()
    }

    /// Distance of a point from a block, in metres; 0 inside the block.
    pub fn distance_m(&self, block: usize, at_m: Vector2<f64>) -> f64 {
        let outline = &self.outlines_m[block];
        if contains(outline, at_m) {
            return 0.0;
        }
        let distances = sides(outline).map(|side| distance(side, at_m));
        distances.fold(f64::INFINITY, f64::min)
    }
}

fn middle_of(block: usize) -> f64 {
    block as f64 + 0.5
}

/// Whether a point is inside a polygon or on its edge.
fn contains(outline: &[Vector2<f64>], point: Vector2<f64>) -> bool {
    let mut inside = false;
    for [from, to] in sides(outline) {
        let direction = to - from;
        if distance([from, to], point) <= 1e-9 * direction.norm() {
            return true;
        }
        if (from.y > point.y) != (to.y > point.y)
            && point.x < from.x + direction.x * (point.y - from.y) / direction.y
        {
            inside = !inside;
        }
    }
    inside
}
