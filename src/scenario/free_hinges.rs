//! Joints that open and shut anywhere: `[free_hinges]`.

use std::ops::Bound::Included;

use super::table::{Number, Reading, Table};
use crate::dynamics::free_hinges::Steps;

/// With shorter steps a run takes forever; longer ones miss the motion.
const STEP_S: Number = Number(Included(1e-9), Included(1.0));

/// Reads `[free_hinges]`, which may be empty.
pub(super) fn read(table: &mut Table<'_>) -> Reading<Steps> {
    let longest_step_s = table.optional("longest_step_s", &STEP_S);
    let shortest_step_s = table.optional("shortest_step_s", &STEP_S);
    let steps = Steps {
        longest_step_s: longest_step_s?,
        shortest_step_s: shortest_step_s?,
    };
    steps
        .checked()
        .map_err(|error| table.wrong("longest_step_s", format!("does not fit: {error}")))
}
