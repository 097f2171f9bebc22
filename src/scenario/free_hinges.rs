//! Free hinges, joints that may open, shut and slip anywhere: `[free_hinges]`.

use super::structure::Structure;
use super::table::{Number, Reading, Table};
use crate::argument::{plain, rounded_up};
use crate::dynamics::free_hinges::RowOptions;
use crate::mechanics::friction;

const STEP_S: Number = Number::within(&RowOptions::STEP_S);
const COEFFICIENT: Number = Number::within(&RowOptions::FRICTION_COEFFICIENT);

/// Reads `[free_hinges]`, which may be empty.
pub(super) fn read(table: &mut Table<'_>) -> Reading<RowOptions> {
    let longest_step_s = table.optional("longest_step_s", &STEP_S);
    let shortest_step_s = table.optional("shortest_step_s", &STEP_S);
    let friction_coefficient = table.optional("friction_coefficient", &COEFFICIENT);
    let options = RowOptions {
        longest_step_s: longest_step_s?,
        shortest_step_s: shortest_step_s?,
        friction_coefficient: friction_coefficient?,
    };
    options
        .checked()
        .map_err(|error| table.wrong(error.argument, format!("does not fit: {error}")))
}

/// Refuses friction that cannot carry the weight of the structure; `name` is the table in which it is given.
pub(super) fn carries(
    table: &mut Table<'_>,
    name: &str,
    structure: &Structure,
    coefficient: Option<f64>,
) -> Reading<()> {
    let Some(coefficient) = coefficient else {
        return Ok(());
    };
    // Anything else that is wrong with the row is reported where the row is used.
    let Ok(model) = structure.free_hinges(RowOptions::default()) else {
        return Ok(());
    };
    if friction::stands(model.row(), coefficient) != Ok(false) {
        return Ok(());
    }
    let wrong = match friction::least_coefficient(model.row()) {
        Ok(least) => format!(
            "does not carry the weight of the structure; must be at least {}",
            plain(rounded_up(least))
        ),
        Err(error) => error.to_string(),
    };
    Err(table.wrong_in(name, "friction_coefficient", wrong))
}
