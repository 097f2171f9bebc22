//! The initial state of the motion: `[initial]`.

use std::f64::consts::PI;

use super::model_kind::ModelKind;
use super::prelude::*;
use super::structure::Structure;
use crate::argument::rounded_down;
use crate::{Initial, Sway};

const ROTATION_RAD: Number = between(Included(0.0), Excluded(PI));
/// Impulses in N s, from those of grains to those of mountains.
const IMPULSE_N_S: Number = between(Included(1e-12), Included(1e18));

/// Horizontal blow on a column at rest, with the keys of the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Blow {
    /// Side to which the column sways.
    sway: Sway,
    impulse_n_s: f64,
    /// Height of its point above the base, in metres.
    height_m: f64,
}

/// Reads `[initial]` for a structure with this model of motion.
pub(super) fn read(
    table: &mut Table<'_>,
    structure: Option<&Structure>,
    kind: &ModelKind,
) -> ReadResult<(Initial, Option<Blow>)> {
    let mut initial = Initial {
        sway: table.read_required("sway", &one_of(Sway::ALL)),
        rotation_rad: table.or("rotation_rad", &ROTATION_RAD, 0.0),
        rate_rad_s: table.or("rate_rad_s", &within(&Initial::RATE_RAD_S), 0.0),
    };
    let impulse_n_s = table.optional("impulse_n_s", &IMPULSE_N_S);
    let height_m = table.optional("height_m", &MAGNITUDE);
    let at_rest = "a blow strikes the column at rest";
    table.check_relations(&[
        Together(&["impulse_n_s", "height_m"]),
        AtMostOne(&["rate_rad_s", "impulse_n_s"], GIVE_ONE),
        AtMostOne(&["rotation_rad", "impulse_n_s"], at_rest),
    ])?;
    let sway = initial.sway;
    let blow = impulse_n_s
        .zip(height_m)
        .map(|(impulse_n_s, height_m)| Blow {
            sway,
            impulse_n_s,
            height_m,
        });
    let lacks = "starts at rest: give `rotation_rad`, a positive `rate_rad_s`, or `impulse_n_s` with `height_m`";
    table.refuse_all(blow.is_none() && !initial.moves(), lacks)?;
    let wrong = "releases rigid blocks about a hinge, and elastic joints have none: they start under the weight; give `rate_rad_s` alone, or leave [initial] out";
    let is_rotated = initial.rotation_rad > 0.0;
    table.refuse(kind.has_stiffness && is_rotated, "rotation_rad", wrong)?;
    if let Some(structure) = structure {
        check_first_mechanism(table, structure, &initial)?;
        if let Some(blow) = blow {
            initial.rate_rad_s = rate_of_blow(table, structure, &blow)?;
        }
    }
    Ok((initial, blow))
}

/// Rejects an initial state that the first mechanism of the structure cannot have.
fn check_first_mechanism(
    table: &mut Table<'_>,
    structure: &Structure,
    initial: &Initial,
) -> ReadResult<()> {
    let is_held = structure.wall_behind() == Some(initial.sway);
    let wrong = "points to the wall of [column.back]; release the column to the other side";
    table.refuse(is_held, "sway", wrong)?;
    let limit_rad = structure.release_limit_rad();
    let wrong = "releases from the first mechanism of four links, and this arch does not start as one; leave \
                 [initial] out";
    table.refuse_all(limit_rad.is_none(), wrong)?;
    let limit_rad = limit_rad.unwrap_or(f64::INFINITY);
    let wrong = format!(
        "is beyond the limit position of the mechanism; must be below {}",
        short(rounded_down(limit_rad))
    );
    table.refuse(initial.rotation_rad >= limit_rad, "rotation_rad", wrong)
}

/// Rate of the column just after a blow, in rad/s.
fn rate_of_blow(table: &mut Table<'_>, structure: &Structure, blow: &Blow) -> ReadResult<f64> {
    let started = structure.column().and_then(|column| {
        let rate_rad_s = column.rate_of_blow_rad_s(blow.sway, blow.impulse_n_s, blow.height_m);
        rate_rad_s.zip(Some(column.height_m))
    });
    let wrong = "is computed for a column of one block: a blow on one block of several starts another motion; give `rate_rad_s`";
    table.refuse(started.is_none(), "impulse_n_s", wrong)?;
    let (rate_rad_s, top_m) = started.ok_or(FaultRecorded)?;
    let wrong = format!("is above the column; must be at most {} m", short(top_m));
    table.refuse(blow.height_m > top_m, "height_m", wrong)?;
    let most_rad_s = *Initial::RATE_RAD_S.end();
    let wrong = format!(
        "gives the column a rate of {} rad/s; it must be from 1e-100 to {most_rad_s}",
        short(rate_rad_s)
    );
    let fits = (Initial::MIN_ROTATION_RAD..=most_rad_s).contains(&rate_rad_s);
    table.refuse(!fits, "impulse_n_s", wrong)?;
    Ok(rate_rad_s)
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
        table.refuse(holds && table.has_key("initial"), "initial", wrong)?;
    }
    Ok(())
}
