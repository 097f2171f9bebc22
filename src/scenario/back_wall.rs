//! Walls behind columns: `[column.back]`.

use super::prelude::*;
use crate::argument::ArgumentError;
use crate::{BackWall, Column, Sway};

/// Message about a wall behind a row of rigid blocks.
const NO_RIGID_BLOCKS: &str = "cannot be combined with free hinges: the wall would stop the column at the first impact; give [elastic_joints], or Housner's column, or leave [column.back] out";

/// Reads `[column.back]`.
pub(super) fn read(table: &mut Table<'_>) -> ReadResult<BackWall> {
    let back = BackWall {
        side: table.read_required("side", &one_of(Sway::ALL)),
        height_m: table.optional("height_m", &within(&(0.0..=1e12))),
        rate_ratio: table.optional("restitution", &within(&(0.0..=1.0))),
    };
    table.check_faultless()?;
    Ok(back)
}

/// Puts a wall behind a column. With `lands` its drums are rigid blocks that land on each other.
pub(super) fn place_before_wall(
    table: &mut Table<'_>,
    column: Column,
    back: Option<BackWall>,
    (has_joints, lands): (bool, bool),
) -> ReadResult<Column> {
    let Some(back) = back else {
        return Ok(column);
    };
    let held = column
        .with_back(back)
        .and_then(|column| {
            if has_joints {
                column.wall_behind_drums()?;
            }
            Ok(column)
        })
        .map_err(|error| wrong_wall(table, &error));
    if lands && back.height_m != Some(0.0) {
        return Err(table.reject_in(&["column"], "back", NO_RIGID_BLOCKS));
    }
    held
}

/// Records that a wall behind the column does not fit the column and its loads.
pub(super) fn wrong_wall(table: &mut Table<'_>, error: &ArgumentError) -> FaultRecorded {
    let wrong = format!("does not fit: it must be {}", error.allowed);
    table.reject_in(&["column", "back"], error.argument, wrong)
}
