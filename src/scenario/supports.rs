//! Movements of the springings before time 0: `[supports]`.

use super::prelude::*;
use super::structure::Structure;
use crate::mechanics::settling::Movement;
use crate::mechanics::{Follower, Movements, SettlingError, Supports};

/// Range of movements; no structure stands on springings that have moved farther.
const MOVEMENT_M: Number = within(&(-1e3..=1e3));

/// Reads `[supports]`.
pub(super) fn read(table: &mut Table<'_>) -> ReadResult<Movements> {
    Ok(Movements {
        left: table.table("left", read_one).unwrap_or_default(),
        right: table.table("right", read_one).unwrap_or_default(),
    })
}

fn read_one(table: &mut Table<'_>) -> ReadResult<Movement> {
    Ok(Movement {
        spread_m: table.or("spread_m", &MOVEMENT_M, 0.0),
        settlement_m: table.or("settlement_m", &MOVEMENT_M, 0.0),
        rotation_rad: table.or("rotation_rad", &within(&(-1.0..=1.0)), 0.0),
    })
}

/// Rejects movements on which a structure of rigid blocks cannot stand. Elastic joints collapse earlier.
pub(super) fn check(
    table: &mut Table<'_>,
    structure: &Structure,
    moved: Movements,
) -> ReadResult<()> {
    // Other users of the row report its faults.
    let Ok(row) = structure.row() else {
        return Ok(());
    };
    if row.supports == Supports::Left {
        let alone = "needs two springings, of which one can move against the other, and this stands on one support: leave it out";
        return Err(table.reject("supports", alone));
    }
    let joints = &row.joints;
    let apart_m = (joints[joints.len() - 1].intrados_m - joints[0].intrados_m).x;
    let closer_m = -(moved.left.spread_m + moved.right.spread_m);
    let wrong = format!(
        "pushes the springings {} m towards each other, and they are {} m apart: spread_m is positive outwards",
        plain(closer_m),
        short(apart_m)
    );
    table.refuse(closer_m >= apart_m, "supports", wrong)?;
    let is_pushed = row.constant_forces().next().is_some();
    table.refuse(is_pushed, "supports", SettlingError::ConstantForces)?;
    let Ok(mut follower) = Follower::new(&row) else {
        return Ok(());
    };
    let wrong = match follower.move_supports(|part| moved * part, 0.0, 1.0) {
        Ok(Some(part)) => format!(
            "makes the arch fall at {:.2} % of this movement, with rigid joints: reduce it; `archrock spread SCENARIO` finds how far the \
             springings may move",
            1e2 * part
        ),
        Ok(None) => {
            let Some(tie) = follower.stance.broken_tie() else {
                return Ok(());
            };
            let wrong = "breaks before the end of the movement of [supports], with rigid joints: give a larger `breaks_at_strain`, \
                         or less movement";
            return Err(table.reject_element("tie", tie, wrong));
        }
        Err(error) => {
            let place = error.path_position().map_or_else(String::new, |part| {
                format!(" beyond {:.2} % of this movement", 1e2 * part)
            });
            format!("cannot be followed{place}: {error}; give another movement or other joints")
        }
    };
    Err(table.reject("supports", wrong))
}
