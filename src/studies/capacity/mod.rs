//! The capacity curves of a scenario: see [`crate::mechanics::capacity`].

mod told;

use nalgebra::Vector2;
use thiserror::Error;

pub use self::told::{FILES, tell};
use crate::dynamics::model::MechanismModel;
use crate::mechanics::capacity::{Capacity, CapacityError, Carried, Control};
use crate::mechanics::chain::Hinge;
use crate::mechanics::four_link::arch::FourLinkError;
use crate::mechanics::parts::Parts;
use crate::mechanics::sway::Sway;
use crate::scenario::Scenario;

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

/// The capacity to the right and to the left. The control point is the given one, or else the crown. It is in metres: x from the
/// middle to the right, y as in the drawings, from the centre of a circular arch, otherwise from the springings or the base.
///
/// # Errors
/// When there is no mechanism of one degree of freedom, or the control point is outside it or does not move.
pub fn capacity(
    scenario: &Scenario,
    point_m: Option<Vector2<f64>>,
) -> Result<[Capacity; 2], NoCapacity> {
    let model = scenario.mechanisms()?;
    let structure = scenario.structure().as_parts();
    let parts = structure.parts();
    let control = match point_m {
        Some(at_m) => (
            structure.place_of(at_m).ok_or(NoCapacity::Outside(at_m))?,
            at_m,
        ),
        None => structure.crown(),
    };
    let side = |sway| {
        let carried = carrying(&*model, sway);
        let masses: Vec<(f64, Carried)> = parts
            .iter()
            .map(|part| (part.mass_kg, carried(part.place, part.centre_m)))
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
pub(super) fn crown_of(structure: &dyn Parts, model: &dyn MechanismModel, sway: Sway) -> Carried {
    let (place, at_m) = structure.crown();
    carrying(model, sway)(place, at_m)
}

/// What carries a point in the first mechanism to a side; the point is given with its place along the structure.
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

/// The place of a hinge along the structure: an angle, or the number of a joint.
#[expect(clippy::cast_precision_loss, reason = "joints are few")]
fn place_of_hinge(hinge: &Hinge) -> f64 {
    match hinge {
        Hinge::Section { angle_rad, .. } => *angle_rad,
        Hinge::Joint { joint, .. } => *joint as f64,
        Hinge::Toe(_) => 0.0,
    }
}
