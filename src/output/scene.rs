//! The drawable parts of a structure at an instant: outlines of its bodies, hinges and the thrust line. All are points of bodies, so poses move
//! them.

use nalgebra::Vector2;

use crate::mechanics::masonry::FillColumn;
use crate::mechanics::{Anchor, BodyPoint, Edge, Parts, PlacedLoad, Tie};
use crate::mechanics::{Outline, StructureSection};
use crate::scenario::{Dimension, Structure, forces_in_words, load_in_words, metres};
use crate::{Hinge, OpenHinge, Pose, Row, Sample, Sway};

/// A structure to be drawn, undeformed.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(super) outline: Outline,
    /// True if the blocks between two hinges form one body and those outside the hinges do not move.
    linked: bool,
    /// Sections at which the position of the thrust line is known.
    pub sections: Vec<StructureSection>,
    /// Poses of the left and the right support of an arch.
    pub supports: [Pose; 2],
    /// Poses and hinges of the structure at rest; empty if it is undeformed.
    pub stands: (Vec<Pose>, Vec<OpenHinge>),
    ties: Vec<Tie>,
    /// The fill on blocks: index of the block and outline.
    pub fill_m: Vec<FillColumn>,
    /// The loads, each with its block and the position of its middle in the undeformed structure, in metres.
    loads: Vec<((usize, Vector2<f64>), PlacedLoad)>,
    /// Outline of the wall behind a column, in metres.
    wall_m: Option<[Vector2<f64>; 4]>,
    /// Floor that holds the top: the point of its weight in metres, and its weight in words.
    floor: Option<(Vector2<f64>, String)>,
    /// The dimensions of the structure.
    pub dimensions: Vec<Dimension>,
}

/// The compressed part of a joint, from the intrados to the extrados.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompressedJoint {
    /// Ends of the compressed part.
    pub ends: [BodyPoint; 2],
    /// Compressive stresses at the ends, in Pa.
    pub stresses_pa: [f64; 2],
    /// Unit normal of the undeformed joint, towards the block after it.
    pub across: Vector2<f64>,
}

/// Arrow that shows weight or thrust of a load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadArrow {
    /// Point of the load; for a patch, its middle.
    pub at: BodyPoint,
    /// Direction of the arrow: 0 downwards, 1 to the right, -1 to the left.
    pub sideways: f64,
    /// Width of the patch, in metres; zero for a point.
    pub width_m: f64,
    /// True for a load on the side of a column or pier, false for one on top.
    pub is_beside: bool,
    /// The force in words.
    pub label: String,
}

impl CompressedJoint {
    /// Returns the stress as a wedge on the joint, with this height in metres per Pa.
    pub fn wedge(&self, metres_per_pa: f64) -> [BodyPoint; 4] {
        let [first, last] = self.ends;
        let top = |end: BodyPoint, stress_pa: f64| BodyPoint {
            at_m: end.at_m + self.across * (stress_pa * metres_per_pa),
            ..end
        };
        let [of_first, of_last] = self.stresses_pa;
        [first, top(first, of_first), top(last, of_last), last]
    }
}

/// A piece of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Index of the body; `None` for a part that does not move.
    pub body: Option<usize>,
    /// Undeformed corners along the outline, in metres.
    pub outline_m: Vec<Vector2<f64>>,
}

impl Piece {
    /// Returns the current positions of the corners, with their displacements multiplied by `exaggeration`.
    pub fn moved(&self, poses: &[Pose], exaggeration: f64) -> Vec<Vector2<f64>> {
        let (body, corners) = (self.body, self.outline_m.iter());
        let corners = corners
            .map(|at_m| BodyPoint { body, at_m: *at_m }.current_position(poses, exaggeration));
        corners.collect()
    }
}

impl Scene {
    /// Makes the scene of a structure that rocks as mechanisms; the blocks of an arch are linked.
    pub fn new(structure: &Structure) -> Self {
        let (parts, ties) = (structure.as_parts(), structure.ties());
        Self::of(structure, parts, structure.has_horizontal_thrust(), ties)
    }

    /// Makes the scene of a structure that moves as the blocks of this row.
    pub fn of_row(row: &Row, structure: &Structure) -> Self {
        Self::of(structure, row, false, row.bars())
    }

    fn of(structure: &Structure, parts: &dyn Parts, linked: bool, ties: &[Tie]) -> Self {
        let (carried, loads) = structure.fill_and_loads();
        let loads = carried.loads_m.into_iter().zip(loads.iter().copied());
        Self {
            outline: parts.outline(),
            linked,
            sections: parts.sections(),
            supports: [Pose::UNDEFORMED; 2],
            stands: (Vec::new(), Vec::new()),
            ties: ties.to_vec(),
            fill_m: carried.fill_m,
            loads: loads.collect(),
            wall_m: structure.wall_outline_m(),
            floor: structure.held_column().and_then(|column| {
                let (top, height_m) = (column.top?, column.height_m);
                let words = format!("floor {} kN", metres(1e-3 * top.weight_n));
                Some((Vector2::new(top.x_m, height_m), words))
            }),
            dimensions: structure.dimensions(),
        }
    }

    /// Returns true if a support has moved.
    pub fn has_settled(&self) -> bool {
        self.supports != [Pose::UNDEFORMED; 2]
    }

    /// Returns the ends of the ties while these hinges are open.
    pub fn ties(&self, hinges: &[OpenHinge]) -> Vec<[BodyPoint; 2]> {
        let end = |anchor: Anchor| BodyPoint {
            body: anchor.block.and_then(|block| self.body_of(block, hinges)),
            at_m: anchor.at_m,
        };
        self.ties.iter().map(|tie| tie.ends.map(end)).collect()
    }

    /// Returns the faces of the supports of an arch, in metres, from the intrados to the extrados, with their displacements multiplied by
    /// `exaggeration`. Empty for a column, which stands on the ground.
    pub fn supports_m(&self, exaggeration: f64) -> Vec<[Vector2<f64>; 2]> {
        let is_arch = match &self.outline {
            Outline::Ring { .. } => true,
            Outline::Block(_) => false,
            Outline::Row(outlines_m) => self.sections.len() > outlines_m.len(),
        };
        let ends = [self.sections.first(), self.sections.last()];
        let faces = ends.into_iter().zip(&self.supports);
        let faces = faces.filter_map(|(section, pose)| Some((section?, pose)));
        faces
            .filter(|_| is_arch)
            .map(|(section, pose)| {
                [-0.5, 0.5].map(|part| {
                    let built_m = section.middle_m + section.across_m * part;
                    built_m + (pose.current_position(built_m) - built_m) * exaggeration
                })
            })
            .collect()
    }

    /// Returns the lower left and the upper right corner of the undeformed structure, in metres.
    pub fn bounds_m(&self) -> [Vector2<f64>; 2] {
        let ends = self.ties.iter().flat_map(|tie| &tie.ends);
        widened(self.blocks_m(), ends.map(|end| end.at_m))
    }

    /// Returns the wall behind a column, which does not move.
    pub fn wall(&self) -> Option<Piece> {
        let outline_m = self.wall_m?.to_vec();
        Some(Piece {
            body: None,
            outline_m,
        })
    }

    /// Returns the lower left and the upper right corner of the undeformed blocks and of the wall behind them, in metres.
    pub fn blocks_m(&self) -> [Vector2<f64>; 2] {
        let empty = [f64::INFINITY, f64::NEG_INFINITY].map(Vector2::repeat);
        let pieces = self.pieces(&[]).into_iter().chain(self.wall());
        widened(empty, pieces.flat_map(|piece| piece.outline_m))
    }

    /// Returns the lower left and the upper right corner of the structure with fill and loads, undeformed and at rest, in metres.
    pub fn frame_m(&self) -> [Vector2<f64>; 2] {
        let (fill, loads) = (self.fill(&[]), self.loads.iter());
        let built = fill.iter().flat_map(|piece| piece.outline_m.clone());
        let built = built.chain(loads.map(|((_, at_m), _)| *at_m));
        let all = self.pieces(&[]).into_iter().chain(fill.clone());
        let there = all.flat_map(|piece| piece.moved(&self.stands.0, 1.0));
        widened(self.bounds_m(), built.chain(there))
    }

    /// Returns the fill in pieces while these hinges are open.
    pub fn fill(&self, hinges: &[OpenHinge]) -> Vec<Piece> {
        let columns = self.fill_m.iter();
        let pieces = columns.map(|(block, outline_m)| self.piece(*block, outline_m, hinges));
        pieces.collect()
    }

    /// Returns an outline that moves with a block.
    fn piece(&self, block: usize, outline_m: &[Vector2<f64>], hinges: &[OpenHinge]) -> Piece {
        Piece {
            body: self.body_of(block, hinges),
            outline_m: outline_m.to_vec(),
        }
    }

    /// Returns the arrows of the loads while these hinges are open.
    pub fn load_arrows(&self, hinges: &[OpenHinge]) -> Vec<LoadArrow> {
        let loads = self.loads.iter().flat_map(|((block, at_m), load)| {
            let (body, at_m) = (self.body_of(*block, hinges), *at_m);
            let forces = forces_in_words(load).into_iter();
            forces.map(move |(sideways, label)| LoadArrow {
                at: BodyPoint { body, at_m },
                sideways,
                width_m: load.width_m,
                is_beside: load.height_m.is_some(),
                label,
            })
        });
        let floor = self.floor.iter().map(|(at_m, words)| LoadArrow {
            at: BodyPoint {
                body: self.body_of(self.pieces(&[]).len() - 1, hinges),
                at_m: *at_m,
            },
            sideways: 0.0,
            width_m: 0.0,
            is_beside: false,
            label: words.clone(),
        });
        loads.chain(floor).collect()
    }

    /// Returns dimensions and loads in words, for pictures without space to draw them; may be empty.
    pub fn sizes_in_words(&self) -> String {
        let lengths = self.dimensions.iter();
        let lengths = lengths.map(|dimension| dimension.words.clone());
        // The dimensions have the height of a lower wall.
        let is_full = self.wall_m.is_some_and(|wall_m| {
            let pieces = self.pieces(&[]).into_iter();
            let corners = pieces.flat_map(|piece| piece.outline_m);
            corners.map(|corner| corner.y).fold(0.0, f64::max) <= wall_m[1].y
        });
        let wall = is_full.then(|| "wall behind it over its full height".to_owned());
        let loads = self.loads.iter();
        let loads = loads.map(|(_, load)| format!("load {}", load_in_words(load)));
        lengths
            .chain(wall)
            .chain(loads)
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// Returns the joints from left to right, or from bottom to top, each from the intrados to the extrados, in metres. Empty if hinges may open
    /// anywhere.
    pub fn joints_m(&self) -> Vec<[Vector2<f64>; 2]> {
        match &self.outline {
            Outline::Ring { joints_rad, .. } => {
                let ends = |angle_rad: &f64| {
                    let [inner, outer] = [Edge::Intrados, Edge::Extrados]
                        .map(|edge| self.on_ring_m(*angle_rad, edge));
                    Some([inner?, outer?])
                };
                joints_rad.iter().filter_map(ends).collect()
            }
            Outline::Block(_) => Vec::new(),
            Outline::Row(_) => (0..)
                .map_while(|joint| self.corners(joint))
                .map(|corners| corners.map(|corner| corner.current_position(&self.stands.0, 1.0)))
                .collect(),
        }
    }

    /// Returns the body of a block while these hinges are open; `None` if the block does not move.
    pub(super) fn body_of(&self, block: usize, hinges: &[OpenHinge]) -> Option<usize> {
        match self.outline {
            Outline::Row(_) if self.linked => linked_body(hinges, block),
            _ => Some(block),
        }
    }

    /// Returns the bodies as pieces while these hinges are open. A ring is divided at its hinges and its joints.
    pub fn pieces(&self, hinges: &[OpenHinge]) -> Vec<Piece> {
        match &self.outline {
            Outline::Block(outline_m) => vec![self.piece(0, outline_m, hinges)],
            Outline::Row(outlines_m) => {
                let outlines = outlines_m.iter().enumerate();
                let pieces =
                    outlines.map(|(block, outline_m)| self.piece(block, outline_m, hinges));
                pieces.collect()
            }
            Outline::Ring {
                ring,
                mean_radius_m,
                joints_rad,
            } => {
                let hinges_rad = sections_rad(hinges);
                let mut cuts_rad =
                    [&[0.0, ring.embrace_rad], &joints_rad[..], &hinges_rad].concat();
                cuts_rad.sort_by(f64::total_cmp);
                cuts_rad.dedup_by(|a, b| (*a - *b).abs() < SAME_SECTION_RAD);
                let pairs = cuts_rad.windows(2);
                pairs
                    .map(|ends| {
                        let outline = ring.sector_outline(ends[0], ends[1]).into_iter();
                        Piece {
                            body: link(&hinges_rad, 0.5 * (ends[0] + ends[1])),
                            outline_m: outline.map(|corner| corner * *mean_radius_m).collect(),
                        }
                    })
                    .collect()
            }
        }
    }

    /// Returns the positions of the open hinges, as points of the body to the right of the hinge, or above it.
    pub fn hinges(&self, hinges: &[OpenHinge]) -> Vec<BodyPoint> {
        let last = hinges.len().saturating_sub(1);
        let marks = hinges.iter().enumerate();
        let marks = marks.filter_map(|(index, open)| {
            let point = self.hinge(open.hinge)?;
            // The last hinge is on the part that does not move.
            let link = (index < last).then_some(index);
            let body = if self.linked { link } else { point.body };
            Some(BodyPoint { body, ..point })
        });
        marks.collect()
    }

    /// Returns the position of a hinge; `None` if the structure does not have it.
    pub(crate) fn hinge(&self, hinge: Hinge) -> Option<BodyPoint> {
        let (body, at_m) = match (hinge, &self.outline) {
            (Hinge::Section { angle_rad, edge }, Outline::Ring { .. }) => {
                (None, self.on_ring_m(angle_rad, edge)?)
            }
            (Hinge::Toe(Sway::Left), Outline::Block(outline_m)) => (Some(0), outline_m[0]),
            (Hinge::Toe(Sway::Right), Outline::Block(outline_m)) => {
                (Some(0), outline_m[outline_m.len() - 1])
            }
            (Hinge::Joint { joint, edge }, Outline::Row(_)) => {
                let [intrados, extrados] = self.corners(joint)?;
                return Some(match edge? {
                    Edge::Intrados => intrados,
                    Edge::Extrados => extrados,
                });
            }
            _ => return None,
        };
        Some(BodyPoint { body, at_m })
    }

    /// Returns a point on an edge of a ring, in metres; `None` for other structures.
    fn on_ring_m(&self, angle_rad: f64, edge: Edge) -> Option<Vector2<f64>> {
        match &self.outline {
            Outline::Ring {
                ring,
                mean_radius_m,
                ..
            } => Some(ring.point(angle_rad, edge) * *mean_radius_m),
            _ => None,
        }
    }

    /// Returns the corners of a joint of a row at intrados and extrados, as points of the block after it; `None` if several blocks move as one
    /// body.
    pub fn joint(&self, joint: usize) -> Option<[BodyPoint; 2]> {
        match &self.outline {
            Outline::Row(_) if !self.linked => self.corners(joint),
            _ => None,
        }
    }

    fn corners(&self, joint: usize) -> Option<[BodyPoint; 2]> {
        let Outline::Row(outlines_m) = &self.outline else {
            return None;
        };
        let section = self.sections.get(joint)?;
        // The support comes after the last block of an arch. If the support has moved, that block has its pose.
        let last = self.has_settled().then(|| outlines_m.len() - 1);
        Some([-0.5, 0.5].map(|part| BodyPoint {
            body: (joint < outlines_m.len()).then_some(joint).or(last),
            at_m: section.middle_m + section.across_m * part,
        }))
    }

    /// Returns the compressed parts of the elastic joints of a row; empty for rigid joints.
    pub fn compressed_joints(&self, sample: &Sample) -> Vec<CompressedJoint> {
        let pressures = sample.pressures.iter().enumerate();
        pressures
            .filter_map(|(joint, pressure)| {
                let [intrados_pa, extrados_pa] = pressure.edge_stresses_pa;
                let [intrados, extrados] = self.joint(joint)?;
                let along_m = extrados.at_m - intrados.at_m;
                // The stress is linear over the compressed part.
                let [from, to] = match (intrados_pa > 0.0, extrados_pa > 0.0) {
                    (true, true) => [0.0, 1.0],
                    (true, false) => [0.0, pressure.contact_ratio],
                    (false, true) => [1.0 - pressure.contact_ratio, 1.0],
                    (false, false) => return None,
                };
                let at = |part: f64| BodyPoint {
                    at_m: intrados.at_m + along_m * part,
                    ..intrados
                };
                Some(CompressedJoint {
                    ends: [at(from), at(to)],
                    stresses_pa: pressure.edge_stresses_pa,
                    across: self.across(joint)?,
                })
            })
            .collect()
    }

    /// Returns the unit normal of an undeformed joint of a row, towards the block after it.
    pub fn across(&self, joint: usize) -> Option<Vector2<f64>> {
        let Outline::Row(outlines_m) = &self.outline else {
            return None;
        };
        let section = self.sections.get(joint)?;
        let across = Vector2::new(section.across_m.y, -section.across_m.x).normalize();
        // The normal must point away from the block before the joint, or into the block after it.
        let (block, into) = match joint.checked_sub(1) {
            Some(before) => (before, -1.0),
            None => (joint, 1.0),
        };
        let from_joint_m = outlines_m.get(block)?.iter();
        let from_joint_m = from_joint_m.map(|corner| corner - section.middle_m);
        let towards: f64 = from_joint_m.map(|away_m| across.dot(&away_m)).sum();
        Some(across * (into * towards.signum()))
    }

    /// Returns the body that carries each of [`Scene::sections`] while these hinges are open.
    pub fn bodies_of_sections(&self, hinges: &[OpenHinge]) -> Vec<Option<usize>> {
        let hinges_rad = sections_rad(hinges);
        let sections = self.sections.iter().enumerate();
        sections
            .map(|(index, section)| match section.angle_rad {
                Some(angle_rad) => link(&hinges_rad, angle_rad),
                None => match self.outline {
                    Outline::Block(_) => Some(0),
                    Outline::Row(_) if self.linked => linked_body(hinges, index),
                    Outline::Row(_) | Outline::Ring { .. } => {
                        self.joint(index).and_then(|[corner, _]| corner.body)
                    }
                },
            })
            .collect()
    }

    /// Returns the thrust line of a sample, as stretches of consecutive compressed sections.
    pub fn thrust_line(&self, sample: &Sample) -> Vec<Vec<BodyPoint>> {
        let bodies = self.bodies_of_sections(&sample.hinges);
        let sections = self.sections.iter().zip(bodies);
        let mut stretches = vec![Vec::new()];
        for ((section, body), ratio) in sections.zip(&sample.eccentricity_ratios) {
            match ratio {
                Some(ratio) => {
                    let ratio = ratio.clamp(-FARTHEST, FARTHEST);
                    let at_m = section.middle_m + section.across_m * ratio;
                    let last = stretches.len() - 1;
                    stretches[last].push(BodyPoint { body, at_m });
                }
                None => stretches.push(Vec::new()),
            }
        }
        stretches.retain(|stretch| stretch.len() > 1);
        stretches
    }
}

/// Returns the link to which a block of a row belongs while hinges are open at these joints; `None` if the block does not move.
fn linked_body(hinges: &[OpenHinge], block: usize) -> Option<usize> {
    let before = hinges
        .iter()
        .filter(|open| matches!(open.hinge, Hinge::Joint { joint, .. } if joint <= block));
    let link = before.count().checked_sub(1)?;
    (link + 1 < hinges.len()).then_some(link)
}

/// Returns the corners of a box that is enlarged to contain these points.
pub(crate) fn widened(
    corners: [Vector2<f64>; 2],
    points: impl IntoIterator<Item = Vector2<f64>>,
) -> [Vector2<f64>; 2] {
    let points = points.into_iter();
    points.fold(corners, |[low, high], point| {
        [low.inf(&point), high.sup(&point)]
    })
}

/// Sections closer together than this are the same.
const SAME_SECTION_RAD: f64 = 1e-9;

/// Eccentricity, in thicknesses, beyond which a thrust line is cut off.
pub const FARTHEST: f64 = 1.5;

/// Returns the hinges at sections of a ring, in radians from the left springing.
pub(super) fn sections_rad(hinges: &[OpenHinge]) -> Vec<f64> {
    let angles = hinges.iter().filter_map(|open| match open.hinge {
        Hinge::Section { angle_rad, .. } => Some(angle_rad),
        Hinge::Toe(_) | Hinge::Joint { .. } | Hinge::Face { .. } => None,
    });
    angles.collect()
}

/// Returns the body to which a section of a ring belongs; `None` if the section does not move.
pub(super) fn link(hinges_rad: &[f64], angle_rad: f64) -> Option<usize> {
    let before = hinges_rad
        .iter()
        .filter(|hinge| **hinge < angle_rad)
        .count();
    (before < hinges_rad.len()).then(|| before.checked_sub(1))?
}
