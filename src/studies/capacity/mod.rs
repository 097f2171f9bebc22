//! The capacity curves of a scenario: see [`crate::mechanics::capacity`].

mod told;

use nalgebra::Vector2;
use thiserror::Error;

pub use self::told::{FILES, tell};
use crate::dynamics::model::MechanismModel;
use crate::mechanics::arch::Arch;
use crate::mechanics::capacity::{Capacity, CapacityError, Carried, Control};
use crate::mechanics::chain::Hinge;
use crate::mechanics::four_link::arch::FourLinkError;
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::sway::Sway;
use crate::scenario::{Scenario, Structure};

/// Equal parts that a continuous ring is taken as: the participating mass errs by the square of their size, 1e-6.
const PARTS: usize = 720;

/// Why a scenario has no capacity curves.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoCapacity {
    /// It does not move as a mechanism of one degree of freedom.
    #[error(transparent)]
    FourLinks(#[from] FourLinkError),
    /// The control point is not on the structure.
    #[error("the control point ({:?}, {:?}) m is not on the structure", .0.x, .0.y)]
    Outside(Vector2<f64>),
    /// The control point does not move.
    #[error(transparent)]
    Control(#[from] CapacityError),
}

/// The capacity to the right and to the left. The control point is that given (in metres, x from the middle to the right, y
/// as in the drawings: from the centre of a circular arch, else from the springings or the base), or the crown.
///
/// # Errors
/// When there is no mechanism of one degree of freedom, or the control point is not on it or does not move.
pub fn capacity(
    scenario: &Scenario,
    point_m: Option<Vector2<f64>>,
) -> Result<[Capacity; 2], NoCapacity> {
    let model = scenario.mechanisms()?;
    let parts = parts(scenario.structure());
    let control = match point_m {
        Some(at_m) => (
            place_of(scenario.structure(), at_m).ok_or(NoCapacity::Outside(at_m))?,
            at_m,
        ),
        None => crown(scenario.structure()),
    };
    let side = |sway| {
        let carried = carrying(&*model, sway);
        let masses: Vec<(f64, Carried)> = parts
            .iter()
            .map(|(place, mass_kg, centre_m)| (*mass_kg, carried(*place, *centre_m)))
            .collect();
        let (place, at_m) = control;
        let displaced = |part| {
            let displaced = model.displaced(sway, part);
            displaced.expect("a structure has its first mechanism")
        };
        let gravity_m_s2 = scenario.gravity_m_s2();
        let control = Control::point(carried(place, at_m));
        Capacity::new(sway, displaced, &masses, control, gravity_m_s2)
    };
    Ok([side(Sway::Right)?, side(Sway::Left)?])
}

/// The crown as a point of the first mechanism to a side.
pub(super) fn crown_of(structure: &Structure, model: &dyn MechanismModel, sway: Sway) -> Carried {
    let (place, at_m) = crown(structure);
    carrying(model, sway)(place, at_m)
}

/// What carries a point, given with its place along the structure, in the first mechanism to a side.
fn carrying(
    model: &dyn MechanismModel,
    sway: Sway,
) -> impl Fn(f64, Vector2<f64>) -> Carried + use<> {
    let hinges = model.hinges_after(0, sway);
    let hinges: Vec<f64> = hinges.iter().map(place_of_hinge).collect();
    let bodies = model.bodies().len();
    move |place, at_m| {
        let before = hinges.iter().filter(|hinge| **hinge < place).count();
        let body = before.checked_sub(1).filter(|body| *body < bodies);
        Carried { at_m, body }
    }
}

/// Where along the structure a hinge is: an angle, or a joint.
#[expect(clippy::cast_precision_loss, reason = "joints are few")]
fn place_of_hinge(hinge: &Hinge) -> f64 {
    match hinge {
        Hinge::Section { angle_rad, .. } => *angle_rad,
        Hinge::Joint { joint, .. } => *joint as f64,
        Hinge::Toe(_) => 0.0,
    }
}

#[expect(clippy::cast_precision_loss, reason = "blocks are few")]
fn middle_of(block: usize) -> f64 {
    block as f64 + 0.5
}

/// What the masses of these curves are the masses of, in words. The rigid bodies of the mechanism would be fewer, with another
/// participating mass.
#[must_use]
pub fn grouping(structure: &Structure) -> String {
    match structure {
        Structure::Arch(arch) => match arch.voussoirs() {
            Some(voussoirs) => format!("{voussoirs} voussoirs"),
            None => format!("{PARTS} equal parts of the ring"),
        },
        Structure::Column(_) => "the column as one block".to_owned(),
        Structure::Masonry(masonry) => format!("{} blocks", masonry.row().blocks().len()),
    }
}

/// What it consists of: place along the structure, mass in kg, centre of gravity in metres.
fn parts(structure: &Structure) -> Vec<(f64, f64, Vector2<f64>)> {
    match structure {
        Structure::Arch(arch) => {
            let (ring, radius_m) = (arch.ring(), arch.mean_radius_m());
            let unit_kg = arch.density_kg_m3() * arch.depth_m() * radius_m * radius_m;
            let sections = ring.sections(arch.voussoirs().unwrap_or(PARTS));
            let pairs = sections.windows(2);
            pairs
                .map(|ends| {
                    let sector = ring.sector(ends[0], ends[1]);
                    let place = 0.5 * (ends[0] + ends[1]);
                    (place, sector.mass * unit_kg, sector.centroid() * radius_m)
                })
                .collect()
        }
        Structure::Column(column) => {
            let mass_kg =
                column.density_kg_m3() * column.depth_m() * column.height_m() * column.width_m();
            vec![(0.5, mass_kg, Vector2::new(0.0, 0.5 * column.height_m()))]
        }
        Structure::Masonry(masonry) => {
            let blocks = masonry.row().blocks().iter().enumerate();
            blocks
                .map(|(index, block)| (middle_of(index), block.mass_kg, block.centre_m))
                .collect()
        }
    }
}

/// Place and position of the crown: the highest point.
fn crown(structure: &Structure) -> (f64, Vector2<f64>) {
    match structure {
        Structure::Arch(arch) => {
            let middle = 0.5 * arch.ring().embrace_rad();
            let at_m = arch.ring().point(middle, Edge::Extrados) * arch.mean_radius_m();
            (middle, at_m)
        }
        Structure::Column(column) => (0.5, Vector2::new(0.0, column.height_m())),
        Structure::Masonry(masonry) => {
            let outlines = masonry.row().outlines_m().iter().enumerate();
            let corners = outlines.flat_map(|(block, outline)| {
                outline
                    .iter()
                    .map(move |corner| (middle_of(block), *corner))
            });
            corners
                .reduce(|highest, next| {
                    if next.1.y > highest.1.y {
                        next
                    } else {
                        highest
                    }
                })
                .expect("a row has blocks")
        }
    }
}

/// Place along the structure of a point on it.
fn place_of(structure: &Structure, at_m: Vector2<f64>) -> Option<f64> {
    match structure {
        Structure::Arch(arch) => place_on_ring(arch, at_m),
        Structure::Column(column) => {
            let inside = at_m.x.abs() <= 0.5 * column.width_m()
                && (0.0..=column.height_m()).contains(&at_m.y);
            inside.then_some(0.5)
        }
        Structure::Masonry(masonry) => {
            let outlines = masonry.row().outlines_m();
            (0..outlines.len())
                .find(|block| contains(&outlines[*block], at_m))
                .map(middle_of)
        }
    }
}

fn place_on_ring(arch: &Arch, at_m: Vector2<f64>) -> Option<f64> {
    let (ring, radius_m) = (arch.ring(), arch.mean_radius_m());
    let ratio = at_m.norm() / radius_m;
    let half = 0.5 * ring.thickness_ratio() * (1.0 + 1e-9);
    let angle_rad = 0.5 * ring.embrace_rad() + at_m.x.atan2(at_m.y);
    ((ratio - 1.0).abs() <= half && (0.0..=ring.embrace_rad()).contains(&angle_rad))
        .then_some(angle_rad)
}

/// Whether a point is in a polygon or on its edge.
fn contains(outline: &[Vector2<f64>], point: Vector2<f64>) -> bool {
    let next = outline.iter().cycle().skip(1);
    let mut inside = false;
    for (from, to) in outline.iter().zip(next) {
        let along = to - from;
        let arm = point - from;
        let part = (arm.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        if (arm - along * part).norm() <= 1e-9 * along.norm() {
            return true;
        }
        if (from.y > point.y) != (to.y > point.y)
            && point.x < from.x + along.x * (point.y - from.y) / along.y
        {
            inside = !inside;
        }
    }
    inside
}
