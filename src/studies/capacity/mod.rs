//! The capacity curves of a scenario: see [`crate::mechanics::Capacity`].

mod report;

use nalgebra::Vector2;
use thiserror::Error;

pub use self::report::{CapacitySummary, FILES, report};
use crate::mechanics::settling::{Held, HeldError};
use crate::mechanics::{
    BodyPoint, Capacity, CapacityError, Control, HeldMechanism, HeldTopError, Parts, RowError,
    Sides,
};
use crate::{FourLinkError, Hinge, MechanismModel, Row, Scenario, Structure, Sway};

/// Reasons why a scenario has no capacity curves.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CapacityCurveError {
    /// The structure does not move as a mechanism of one degree of freedom.
    #[error(transparent)]
    FourLinks(#[from] FourLinkError),
    /// The structure is not a row of blocks.
    #[error(transparent)]
    Row(#[from] RowError),
    /// The column with a held top has no mechanism.
    #[error(transparent)]
    HeldTop(#[from] HeldTopError),
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

/// Computes the capacity curves to the right and to the left; `None` for the side of a wall behind a column. The control point `point_m` is in metres: x
/// from the middle to the right; y from the centre of a circular arch, otherwise from the springings or the base, upwards. `None` chooses the crown, or
/// the top of a column.
///
/// # Errors
/// When there is no mechanism of one degree of freedom, or the control point is outside the structure or does not move.
pub fn capacity(
    scenario: &Scenario,
    point_m: Option<Vector2<f64>>,
) -> Result<Sides<Option<Capacity>>, CapacityCurveError> {
    let gravity_m_s2 = scenario.gravity_m_s2();
    if let Some(column) = scenario.structure.held_column() {
        let right = HeldMechanism::new(column, Sway::Right)?;
        // The top does not move sideways: the default is the axis at the hinge.
        let hinge_m = Vector2::new(0.0, right.hinges_m()[1].y);
        return Sides::try_of(|sway| {
            let held = HeldMechanism::new(column, sway)?;
            let (row, end_rad) = (&held.row, held.end_rad()?);
            let control = control(row, Some(point_m.unwrap_or(hinge_m)))?;
            let displaced = |part| held.displaced(part * end_rad);
            let (masses, control) = Bodies::of_held_top(&held).masses(row, control);
            let capacity = Capacity::new(sway, displaced, &masses, control, gravity_m_s2)?;
            Ok(Some(capacity))
        });
    }
    if let Some(row) = held_row(&scenario.structure)? {
        let control = control(&row, point_m)?;
        return Sides::try_of(|sway| {
            if scenario.structure.wall_behind() == Some(sway) {
                return Ok(None);
            }
            let held = Held::new(&row, sway)?;
            let displaced = |part| held.displaced_mechanism(part);
            let (masses, control) = Bodies::of_row(&held).masses(&row, control);
            let capacity = Capacity::new(sway, displaced, &masses, control, gravity_m_s2)?;
            // Ties change the push that the first mechanism of a row resists.
            let events = held.tie_event_fractions();
            Ok(Some(capacity.with_ties(&events, displaced, gravity_m_s2)))
        });
    }
    let model = scenario.mechanisms_without_impacts()?;
    let structure = scenario.structure.as_parts();
    let control = control(structure, point_m)?;
    Sides::try_of(|sway| {
        if scenario.structure.wall_behind() == Some(sway) {
            return Ok(None);
        }
        let displaced = |part| {
            let displaced = model.displaced_mechanism(sway, part);
            displaced.expect("a structure has its first mechanism")
        };
        let (masses, control) = Bodies::of_model(&*model, sway).masses(structure, control);
        let capacity = Capacity::new(sway, displaced, &masses, control, gravity_m_s2)?;
        Ok(Some(capacity))
    })
}

/// Blocks of a structure whose first mechanism is that of a row: a structure with ties, an arch with constant forces, or a stack on one
/// support other than Housner's block. `None` for structures that move as four links or as Housner's block.
fn held_row(structure: &Structure) -> Result<Option<Row>, RowError> {
    let is_one_prism = structure.column().is_some_and(crate::Column::is_one_prism);
    let is_stack = structure.stands_on_one_support() && !is_one_prism;
    let is_held = match structure {
        Structure::Masonry(masonry) => !masonry.row.ties.is_empty(),
        _ => !structure.ties().is_empty(),
    };
    (is_stack || is_held).then(|| structure.row()).transpose()
}

/// Control point with its place along the structure: the given point, or the crown.
fn control(
    structure: &dyn Parts,
    point_m: Option<Vector2<f64>>,
) -> Result<(f64, Vector2<f64>), CapacityCurveError> {
    match point_m {
        Some(at_m) => {
            let place = structure.place_of(at_m);
            Ok((place.ok_or(CapacityCurveError::Outside(at_m))?, at_m))
        }
        None => Ok(structure.crown()),
    }
}

/// The bodies of a mechanism, separated by hinges at places along the structure.
pub(super) struct Bodies {
    hinges: Vec<f64>,
    count: usize,
}

impl Bodies {
    /// Bodies of the first mechanism of a model to a side.
    pub(super) fn of_model(model: &dyn MechanismModel, sway: Sway) -> Self {
        let hinges = model
            .hinges_after(0, sway)
            .into_iter()
            .map(|hinge| match hinge {
                Hinge::Section { angle_rad, .. } => angle_rad,
                Hinge::Joint { joint, .. } => joint as f64,
                Hinge::Toe(_) | Hinge::Face { .. } => 0.0,
            });
        Self {
            hinges: hinges.collect(),
            count: model.bodies().len(),
        }
    }

    /// Bodies of the first mechanism of a row.
    pub(super) fn of_row(held: &Held<'_>) -> Self {
        let hinges = held.pins.hinges.iter().map(|hinge| hinge.joint as f64);
        Self {
            hinges: hinges.collect(),
            count: held.bodies(),
        }
    }

    /// Bodies of a wall whose top is held.
    pub(super) fn of_held_top(held: &HeldMechanism) -> Self {
        Self {
            hinges: held.pins.iter().map(|pin| pin.joint as f64).collect(),
            count: held.pins.len(),
        }
    }

    /// Attaches a point, given with its place along the structure, to the body that carries it.
    pub(super) fn body_point(&self, (place, at_m): (f64, Vector2<f64>)) -> BodyPoint {
        let before = self.hinges.iter().filter(|hinge| **hinge < place).count();
        let body = before.checked_sub(1).filter(|body| *body < self.count);
        BodyPoint { at_m, body }
    }

    /// Parts of a structure as points with masses, and its control point.
    fn masses(
        &self,
        structure: &dyn Parts,
        control: (f64, Vector2<f64>),
    ) -> (Vec<(f64, BodyPoint)>, Control) {
        let parts = structure.parts().into_iter();
        let points = parts.map(|part| (part.mass_kg, (part.place, part.centre_m)));
        let masses = points.map(|(mass_kg, at)| (mass_kg, self.body_point(at)));
        (masses.collect(), Control::point(self.body_point(control)))
    }
}
