//! The initial state of the motion: `[initial]`.

use std::f64::consts::PI;

use super::model_kind::ModelKind;
use super::prelude::*;
use super::structure::Structure;
use crate::argument::rounded_down;
use crate::{Initial, Sway};

const ROTATION_RAD: Number = between(Included(Initial::MIN_ROTATION_RAD), Excluded(PI));

/// Reads `[initial]` for a structure with this model of motion.
pub(super) fn read(
    table: &mut Table<'_>,
    structure: Option<&Structure>,
    kind: &ModelKind,
) -> ReadResult<Initial> {
    let wrong = "releases rigid blocks about a hinge, and elastic joints have none: they start from rest under the weight; leave \
                 [initial] out";
    table.refuse_all(!kind.is_rigid, wrong)?;
    let initial = Initial {
        sway: table.required("sway", &one_of(Sway::ALL)),
        rotation_rad: table.required("rotation_rad", &ROTATION_RAD),
    };
    table.check_faultless()?;
    if let Some(structure) = structure {
        let is_held = structure.wall_behind() == Some(initial.sway);
        table.refuse(
            is_held,
            "sway",
            "points to the wall of [column.back]; release the column to the other side",
        )?;
        let limit_rad = structure.release_limit_rad();
        let wrong = "releases from the first mechanism of four links, and this arch does not start as one; leave \
                     [initial] out";
        table.refuse_all(limit_rad.is_none(), wrong)?;
        let limit_rad = limit_rad.unwrap_or(f64::INFINITY);
        let wrong = format!(
            "is beyond the limit position of the mechanism; must be below {}",
            short(rounded_down(limit_rad))
        );
        table.refuse(initial.rotation_rad >= limit_rad, "rotation_rad", wrong)?;
    }
    Ok(initial)
}

/// Rejects `[initial]` for a structure that has ties or stands on moved springings.
pub(super) fn check_structure(
    table: &mut Table<'_>,
    has_ties: bool,
    is_moved: bool,
) -> ReadResult<()> {
    let ties = "[[tie]], which holds the structure where it stands";
    let moved = "[supports]: on moved springings the structure stands on other hinges";
    for (holds, by) in [(has_ties, ties), (is_moved, moved)] {
        let wrong = format!("cannot be combined with {by}; leave one out");
        table.refuse(holds && table.gives("initial"), "initial", wrong)?;
    }
    Ok(())
}
