//! Free hinges: joints that may open, close and slip anywhere, `[free_hinges]`.

use super::prelude::*;
use super::structure::Structure;
use crate::argument::rounded_up;
use crate::mechanics::{FrictionError, Movements, friction};
use crate::{FreeHinges, RowModelError, RowOptions};

/// Free hinges on supports that may have moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeTable {
    /// Options in `[free_hinges]`.
    pub options: RowOptions,
    /// Movements of the supports before time 0, from `[supports]`.
    pub supports: Movements,
}

impl FreeTable {
    /// Makes the model of a structure.
    ///
    /// # Errors
    /// When the structure is an arch without voussoirs, cannot stand, or collapses or slides on its moved supports.
    pub fn model(&self, structure: &Structure) -> Result<FreeHinges, RowModelError> {
        let mut options = self.options;
        options.friction_coefficient = None;
        let built = structure
            .free_hinges(options)?
            .on_supports(&self.supports)?;
        built.with_options(self.options)
    }
}

/// Reads `[free_hinges]`; the table may be empty.
pub(super) fn read(table: &mut Table<'_>) -> ReadResult<RowOptions> {
    let step_s = within(&RowOptions::STEP_S);
    let coefficient = within(&RowOptions::FRICTION_COEFFICIENT);
    let options = RowOptions {
        longest_step_s: table.optional("longest_step_s", &step_s),
        shortest_step_s: table.optional("shortest_step_s", &step_s),
        friction_coefficient: table.optional("friction_coefficient", &coefficient),
    };
    table.sound()?;
    options
        .checked()
        .map_err(|error| table.wrong(error.argument, format!("does not fit: {error}")))
}

/// Rejects a coefficient of friction with which the structure slides on its moved springings. [`carries`] checks the undeformed structure.
pub(super) fn holds(
    table: &mut Table<'_>,
    structure: &Structure,
    free: &FreeTable,
) -> ReadResult<()> {
    match free.model(structure) {
        Err(RowModelError::Friction(FrictionError::CannotStand(_))) => {
            let wrong = "does not hold the structure where its springings have gone: it would slide there; give a larger one";
            Err(table.wrong_in(&["free_hinges"], "friction_coefficient", wrong))
        }
        // Other users of the row report its faults.
        _ => Ok(()),
    }
}

/// Rejects a coefficient of friction with which the structure slides under its weight.
pub(super) fn carries(structure: &Structure, coefficient: f64) -> Result<(), String> {
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
        "does not carry the weight of the structure; must be at least {least}"
    ))
}
