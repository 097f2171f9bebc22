//! Floors that hold the top of a column sideways: `[column.top]`.

use super::prelude::*;
use crate::mechanics::{HeldMechanism, HeldTop};
use crate::{Column, FourLinkError, Sway};

/// Message about a wall behind a column whose top is held.
pub(super) const NO_WALL: &str = "cannot be combined with [column.back]: a wall behind the column holds it to one side over its height; leave one out";

/// Reads `[column.top]`.
pub(super) fn read(table: &mut Table<'_>) -> ReadResult<HeldTop> {
    let weight_n = table.read_required("weight_n", &within(&(1e-3..=1e12)));
    let x_m = table.or("x_m", &within(&(-1e6..=1e6)), 0.0);
    table.check_faultless()?;
    Ok(HeldTop { weight_n, x_m })
}

/// Holds the top of a column.
pub(super) fn hold(
    table: &mut Table<'_>,
    column: Column,
    top: Option<HeldTop>,
    gravity_m_s2: f64,
) -> ReadResult<Column> {
    let Some(top) = top else {
        return Ok(column);
    };
    column.with_top(top, gravity_m_s2).map_err(|error| {
        let path: &[&str] = match error.argument {
            "top_width_m" => &["column"],
            _ => &["column", "top"],
        };
        let wrong = format!("does not fit: it must be {}", error.allowed);
        table.reject_in(path, error.argument, wrong)
    })
}

/// Rejects a column whose top is held if it cannot stand or bend, and models of motion beside it. `moves` is true if a model of motion follows.
pub(super) fn check(table: &mut Table<'_>, column: &Column, moves: bool) -> ReadResult<()> {
    if column.top.is_none() {
        return Ok(());
    }
    if moves {
        return Err(table.reject_in(&["column"], "top", FourLinkError::HeldTop));
    }
    let found = HeldMechanism::new(column, Sway::Right);
    let wrong = |error| format!("does not fit: {error}");
    let found = found.map(drop).map_err(wrong);
    found.map_err(|wrong| table.reject_in(&["column"], "top", wrong))
}
