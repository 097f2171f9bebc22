//! The capacity curves of a scenario: see [`crate::mechanics::capacity`].

mod picture;
mod report;

use nalgebra::Vector2;
use thiserror::Error;

pub use self::report::{CapacitySide, FILES, Oscillator, SecantPeriods, Summary, report};
use crate::dynamics::model::MechanismModel;
use crate::mechanics::blocks::{Row, RowError};
use crate::mechanics::capacity::{Capacity, CapacityError, Carried, Control};
use crate::mechanics::chain::Hinge;
use crate::mechanics::four_links::FourLinkError;
use crate::mechanics::parts::Parts;
use crate::mechanics::settling::{Held, HeldError};
use crate::mechanics::sides::Sides;
use crate::mechanics::sway::Sway;
use crate::scenario::{Scenario, Structure};

/// Why a scenario has no capacity curves.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoCapacity {
    /// It does not move as a mechanism of one degree of freedom.
    #[error(transparent)]
    FourLinks(#[from] FourLinkError),
    /// It is no row of blocks.
    #[error(transparent)]
    Row(#[from] RowError),
    /// The row does not move along one mechanism.
    #[error(transparent)]
    Held(#[from] HeldError),
    /// The control point is not on the structure.
    #[error("the control point ({:?}, {:?}) m is not on the structure", .0.x, .0.y)]
    Outside(Vector2<f64>),
    /// The control point does not move.
    #[error(transparent)]
    Control(#[from] CapacityError),
}

/// The capacity to the right and to the left. The control point is the given one, or else the crown, or the top of a column. It is in metres: x from the
/// middle to the right, y as in the drawings, from the centre of a circular arch, otherwise from the springings or the base.
///
/// # Errors
/// When there is no mechanism of one degree of freedom, or the control point is outside it or does not move.
pub fn capacity(
    scenario: &Scenario,
    point_m: Option<Vector2<f64>>,
) -> Result<Sides<Capacity>, NoCapacity> {
    if let Some(row) = held_row(scenario.structure())? {
        return of_row(&row, point_m, scenario.gravity_m_s2());
    }
    let model = scenario.mechanisms()?;
    let structure = scenario.structure().as_parts();
    let control = control(structure, point_m)?;
    let side = |sway| {
        let carried = carrying(&*model, sway);
        let masses = carried_masses(structure, &carried);
        let (place, at_m) = control;
        let displaced = |part| {
            let displaced = model.displaced(sway, part);
            displaced.expect("a structure has its first mechanism")
        };
        let gravity_m_s2 = scenario.gravity_m_s2();
        let control = Control::point(carried(place, at_m));
        Capacity::new(sway, displaced, &masses, control, gravity_m_s2).map_err(NoCapacity::from)
    };
    Sides::try_of(side)
}

/// The blocks of a structure whose first mechanism is followed as a row: one with ties, or a stack on one support that is not
/// Housner's block. `None` for structures that move as four links or as that block.
fn held_row(structure: &Structure) -> Result<Option<Row>, RowError> {
    if !structure.ties().is_empty() {
        return structure.row().map(Some);
    }
    let is_one_prism = matches!(structure, Structure::Column(column) if column.is_one_prism());
    if structure.stands_on_one_support() && !is_one_prism {
        return structure.row().map(Some);
    }
    Ok(None)
}

/// Capacity of a row, whose ties change the push that its first mechanism resists along its way.
fn of_row(
    row: &Row,
    point_m: Option<Vector2<f64>>,
    gravity_m_s2: f64,
) -> Result<Sides<Capacity>, NoCapacity> {
    let (place, at_m) = control(row, point_m)?;
    let side = |sway| -> Result<Capacity, NoCapacity> {
        let held = Held::new(row, sway)?;
        let carried = carried_by_held(&held);
        let masses = carried_masses(row, &carried);
        let control = Control::point(carried(place, at_m));
        let displaced = |part| held.displaced(part);
        let capacity = Capacity::new(sway, displaced, &masses, control, gravity_m_s2)?;
        Ok(capacity.with_ties(&held.ties_give_way(), displaced, gravity_m_s2))
    };
    Sides::try_of(side)
}

/// The given point with its place, or else the crown.
fn control(
    structure: &dyn Parts,
    point_m: Option<Vector2<f64>>,
) -> Result<(f64, Vector2<f64>), NoCapacity> {
    match point_m {
        Some(at_m) => {
            let place = structure.place_of(at_m).ok_or(NoCapacity::Outside(at_m))?;
            Ok((place, at_m))
        }
        None => Ok(structure.crown()),
    }
}

/// The parts of a structure as points, each with its mass.
fn carried_masses(
    structure: &dyn Parts,
    carried: impl Fn(f64, Vector2<f64>) -> Carried,
) -> Vec<(f64, Carried)> {
    let parts = structure.parts().into_iter();
    parts
        .map(|part| (part.mass_kg, carried(part.place, part.centre_m)))
        .collect()
}

/// The crown as a point of the first mechanism to a side.
pub(super) fn crown_of(structure: &dyn Parts, model: &dyn MechanismModel, sway: Sway) -> Carried {
    let (place, at_m) = structure.crown();
    carrying(model, sway)(place, at_m)
}

/// The body that carries a point in the first mechanism to a side; the point is given with its place along the structure.
fn carrying(
    model: &dyn MechanismModel,
    sway: Sway,
) -> impl Fn(f64, Vector2<f64>) -> Carried + use<> {
    let hinges = model.hinges_after(0, sway);
    carried_by(
        hinges.iter().map(place_of_hinge).collect(),
        model.bodies().len(),
    )
}

/// The crown of a row as a point of its first mechanism.
pub(super) fn crown_of_row(row: &Row, held: &Held<'_>) -> Carried {
    let (place, at_m) = row.crown();
    carried_by_held(held)(place, at_m)
}

/// Assigns points of a row to the bodies of its first mechanism.
fn carried_by_held(held: &Held<'_>) -> impl Fn(f64, Vector2<f64>) -> Carried + use<> {
    let hinges = held.pins.hinges.iter();
    let places = hinges.map(|hinge| place_of_joint(hinge.joint));
    carried_by(places.collect(), held.bodies())
}

/// Assigns points to bodies that are separated by hinges at these places.
fn carried_by(hinges: Vec<f64>, bodies: usize) -> impl Fn(f64, Vector2<f64>) -> Carried {
    move |place, at_m| {
        let before = hinges.iter().filter(|hinge| **hinge < place).count();
        let body = before.checked_sub(1).filter(|body| *body < bodies);
        Carried { at_m, body }
    }
}

/// The place of a hinge along the structure: an angle, or the number of a joint.
fn place_of_hinge(hinge: &Hinge) -> f64 {
    match hinge {
        Hinge::Section { angle_rad, .. } => *angle_rad,
        Hinge::Joint { joint, .. } => place_of_joint(*joint),
        Hinge::Toe(_) => 0.0,
    }
}

const fn place_of_joint(joint: usize) -> f64 {
    joint as f64
}
