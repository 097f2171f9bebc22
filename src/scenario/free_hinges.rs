//! Free hinges: joints that may open, close and slip anywhere, `[free_hinges]`.

use std::sync::Arc;

use super::model_kind::{AnyModel, ModelKind, ModelOptions, Site};
use super::prelude::*;
use super::structure::Structure;
use crate::argument::{ArgumentError, rounded_up};
use crate::mechanics::{FrictionError, friction};
use crate::{Column, FreeHinges, Request, RowModelError, RowOptions};

/// A row of rigid blocks whose joints open and close anywhere.
pub static FREE_HINGES: ModelKind = ModelKind {
    option: "free",
    name: "free_hinges",
    table: "free_hinges",
    label: "free hinges",
    assumptions: "free hinges: rigid blocks, whose joints open about either edge and close again at any time; impacts are perfectly inelastic; joints slip only with `friction_coefficient`. After the first reversal the motion depends on the order of impacts, so histories are repeated with other steps",
    has_joints: true,
    has_mechanism: false,
    is_repeated: true,
    has_stiffness: false,
    has_lanes: false,
    ignored: Some("[impact] is ignored: with free hinges impacts follow from the blocks"),
    lacking: None,
    read: |table| Ok(Arc::new(read(table)?)),
};

/// Makes the model of a structure. An error if the structure is an arch without voussoirs, cannot stand, or collapses or slides on its moved
/// supports.
pub(super) fn model(
    options: RowOptions,
    structure: &Structure,
    site: &Site,
) -> Result<FreeHinges, RowModelError> {
    if let Some((_, height_m)) = structure.column().and_then(Column::wall) {
        let allowed = "0 with free hinges, which have no contact with a wall behind a column";
        return Err(ArgumentError::new("height_m", height_m, allowed).into());
    }
    let mut undeformed = options;
    undeformed.friction_coefficient = None;
    let built = structure.free_hinges(undeformed)?;
    built.on_supports(&site.supports)?.with_options(options)
}

impl ModelOptions for RowOptions {
    fn to_json(&self) -> Value {
        json!(self)
    }

    fn model(&self, structure: &Structure, site: &Site) -> AnyModel {
        Ok(Box::new(model(*self, structure, site)?))
    }

    fn friction_coefficient(&self) -> Option<f64> {
        self.friction_coefficient
    }

    fn longest_step_s(&self, structure: &Structure, site: &Site, request: &Request) -> Option<f64> {
        Some(model(*self, structure, site).ok()?.longest_step_s(request))
    }

    /// Rejects a coefficient of friction with which the structure slides on its moved springings. `check_friction` checks the undeformed structure.
    fn check(
        &self,
        table: &mut Table<'_>,
        structure: &Structure,
        site: &Site,
        _end_s: Option<f64>,
    ) -> ReadResult<()> {
        if site.supports.is_none() || self.friction_coefficient.is_none() {
            return Ok(());
        }
        match model(*self, structure, site) {
            Err(RowModelError::Friction(FrictionError::CannotStand(_))) => {
                let wrong = "does not hold the structure on its moved springings: it would slide; give a larger one";
                Err(table.reject_in(&["free_hinges"], "friction_coefficient", wrong))
            }
            // Other users of the row report its faults.
            _ => Ok(()),
        }
    }
}

/// Reads `[free_hinges]`; the table may be empty.
fn read(table: &mut Table<'_>) -> ReadResult<RowOptions> {
    let step_s = within(&RowOptions::STEP_S);
    let coefficient = within(&RowOptions::FRICTION_COEFFICIENT);
    let options = RowOptions {
        longest_step_s: table.optional("longest_step_s", &step_s),
        shortest_step_s: table.optional("shortest_step_s", &step_s),
        friction_coefficient: table.optional("friction_coefficient", &coefficient),
    };
    table.check_faultless()?;
    options
        .checked()
        .map_err(|error| table.reject(error.argument, format!("does not fit: {error}")))
}

/// Rejects a coefficient of friction with which the structure slides under its weight.
pub(super) fn check_friction(structure: &Structure, coefficient: f64) -> Result<(), String> {
    // Other users of the row report its faults.
    let Ok(model) = structure.free_hinges(RowOptions::default()) else {
        return Ok(());
    };
    if friction::stands(model.row(), coefficient) != Ok(false) {
        return Ok(());
    }
    let least = friction::least_coefficient(model.row()).map_err(|error| error.to_string())?;
    let least = plain(rounded_up(least));
    Err(format!(
        "lets the structure slide under its own weight; must be at least {least}"
    ))
}
