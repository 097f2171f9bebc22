//! The two pushes of a row on supports that have moved: see [`crate::mechanics::settling`].

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::told::{forces, openings_text, places_of_ties, starts_json};
use super::{Answer, NoLimit};
use crate::mechanics::blocks::Row;
use crate::mechanics::friction;
use crate::mechanics::settling::{Follower, Hinge, Movements, SettlingError};
use crate::mechanics::stability::{RowOnset, onset_at};
use crate::mechanics::sway::Sway;
use crate::scenario::Scenario;

/// Both sides, right first.
const SIDES: [Sway; 2] = [Sway::Right, Sway::Left];

/// The push of the first motion and the one at which it falls, to either side, as JSON and in words.
pub(super) fn limit(
    scenario: &Scenario,
    row: &Row,
    movements: &Movements,
) -> Result<Answer, NoLimit> {
    let mut follower = Follower::new(row)?;
    // That it follows them was seen when the scenario was read.
    follower.move_supports(|part| *movements * part, 0.0, 1.0)?;
    let stance = &follower.stance;
    let starts = |sway| follower.first_motion_g(sway).map_err(SettlingError::from);
    let starts_g = [starts(Sway::Right)?, starts(Sway::Left)?];
    let onsets = SIDES.map(|sway| mechanism(row, &follower, sway));
    let falls = [0, 1].map(|side| match starts_g[side] {
        Some(start_g) => follower.capacity_g(SIDES[side], start_g),
        None => Ok(None),
    });
    let hinges = follower.hinges().map_or(&[][..], |pins| &pins.hinges);

    let mut json = starts_json(row, starts_g, &onsets, scenario.gravity_m_s2());
    let [right, left] = [0, 1].map(|side| falls[side].as_ref().ok());
    json["capacity_g"] = json!({ "right": right, "left": left });
    let [right, left] = [0, 1].map(|side| falls[side].as_ref().err().map(ToString::to_string));
    json["capacity_not_found"] = json!({ "right": right, "left": left });
    json["hinges"] = hinges
        .iter()
        .map(|hinge| json!({ "joint": hinge.joint, "edge": hinge.edge.name() }))
        .collect();

    let mut text = format!(
        "its springings have moved; it stands on hinges at {}\n",
        list(hinges)
    );
    if !row.ties().is_empty() {
        let forces_n: Vec<f64> = stance.forces_n().collect();
        text += &places_of_ties(scenario);
        let _ = writeln!(text, "{}", pulls(&forces_n, follower.is_held_by_ties()));
        json["ties"] = json!({ "forces_at_rest_n": forces_n });
    }
    text.push('\n');
    for (((sway, start_g), onset), falls) in
        SIDES.into_iter().zip(starts_g).zip(&onsets).zip(&falls)
    {
        let side = sway.name();
        let Some(start_g) = start_g else {
            let _ = writeln!(text, "no push to the {side} moves it without sliding\n");
            continue;
        };
        if let Some(onset) = onset {
            let _ = writeln!(
                text,
                "first motion to the {side}, where hinges give way to others: {start_g:.8} g; then hinges open at"
            );
            text += &openings_text(row, onset);
        } else {
            let _ = writeln!(text, "any push to the {side} moves it");
        }
        let _ = match falls {
            Ok(Some(falls_g)) => writeln!(
                text,
                "capacity to the {side}, where it falls: {falls_g:.8} g\n"
            ),
            Ok(None) => writeln!(text, "no push to the {side} was found at which it falls\n"),
            Err(reason) => writeln!(text, "capacity to the {side} not found: {reason}\n"),
        };
    }
    if let Some(coefficient) = scenario.motion().friction_coefficient() {
        let mut sides = [Value::Null, Value::Null];
        let _ = writeln!(
            text,
            "with joints that slip at a coefficient of friction of {coefficient:?}:"
        );
        for (sway, told) in SIDES.into_iter().zip(&mut sides) {
            let onset = friction::onset_at(row, stance, coefficient, sway)?;
            *told = onset.as_ref().map(|onset| onset.acceleration_g).into();
            let _ = match onset {
                Some(onset) => writeln!(
                    text,
                    "  first motion to the {} at {:.8} g",
                    sway.name(),
                    onset.acceleration_g
                ),
                None => writeln!(text, "  no push to the {} starts it", sway.name()),
            };
        }
        let [right, left] = sides;
        json["friction"] = json!({
            "coefficient": coefficient,
            "incipient_acceleration_g": { "right": right, "left": left },
        });
        text.push('\n');
    }
    text += "joints are counted from the left, 0 at the left base or springing; places are those of the structure as it was built\n";
    Ok(Answer { json, text })
}

/// The mechanism in which its hinges give way to a push; none where any push moves it: ties hold it on more than three hinges, or it is about
/// to fall.
fn mechanism(row: &Row, follower: &Follower<'_>, sway: Sway) -> Option<RowOnset> {
    if follower.is_held_by_ties() {
        return None;
    }
    onset_at(row, &follower.stance, sway).ok().flatten()
}

/// What its ties do, in words.
fn pulls(forces_n: &[f64], they_hold: bool) -> String {
    let (ties, holds) = match forces_n {
        [_] => ("its tie pulls", "it holds"),
        _ => ("its ties pull", "they hold"),
    };
    let held = if they_hold {
        format!(", and {holds} it there: it is a mechanism without")
    } else {
        String::new()
    };
    format!("{ties} with {}{held}", forces(forces_n.iter().copied()))
}

fn list(hinges: &[Hinge]) -> String {
    let each: Vec<String> = hinges
        .iter()
        .map(|hinge| format!("joint {} ({})", hinge.joint, hinge.edge.name()))
        .collect();
    match &each[..] {
        [] => "no joint: they moved as one".to_owned(),
        each => each.join(", "),
    }
}
