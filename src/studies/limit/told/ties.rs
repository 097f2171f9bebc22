//! What ties do for the push that starts a row: as they pull at rest, and with any force up to that at which they yield.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::{openings_json, openings_text};
use crate::argument::fixed;
use crate::mechanics::blocks::Row;
use crate::mechanics::stability::{StabilityError, TiedLimit, limit_with_yielding_ties, onset};
use crate::mechanics::sway::Sway;
use crate::mechanics::tie::Tie;

/// Both sides, right first.
const SIDES: [Sway; 2] = [Sway::Right, Sway::Left];

/// What is told of a row with ties.
pub(super) struct Tied {
    /// The push that starts it without them, to the right and to the left.
    without: Without,
    yielding: [Option<TiedLimit>; 2],
}

/// The same row without its ties.
enum Without {
    Falls,
    Stands([Option<f64>; 2]),
}

impl Tied {
    /// Of a row that stands with its ties.
    ///
    /// # Errors
    /// When the velocities of a trial are not found.
    pub fn of(row: &Row) -> Result<Self, StabilityError> {
        let untied = row.clone().without_ties();
        let push_g = |sway| Ok(onset(&untied, sway)?.map(|onset| onset.acceleration_g));
        let [right, left] = SIDES.map(push_g);
        let without = match (right, left) {
            (Ok(right), Ok(left)) => Without::Stands([right, left]),
            (Err(StabilityError::CannotStand(_)), _) | (_, Err(StabilityError::CannotStand(_))) => {
                Without::Falls
            }
            (Err(error), _) | (_, Err(error)) => return Err(error),
        };
        let [right, left] = SIDES.map(|sway| limit_with_yielding_ties(row, sway));
        Ok(Self {
            without,
            yielding: [right?, left?],
        })
    }

    pub fn json(&self, row: &Row) -> Value {
        let [right, left] = match self.without {
            Without::Falls => [None, None],
            Without::Stands(pushes) => pushes,
        };
        let side = |limit: &Option<TiedLimit>| {
            let onset = limit.as_ref().map(|limit| &limit.onset);
            json!({
                "incipient_acceleration_g": onset.map(|onset| onset.acceleration_g),
                "forces_n": limit.as_ref().map(|limit| &limit.forces_n),
                "mechanism": openings_json(row, onset),
            })
        };
        let forces_n = row.ties().iter().map(|tie| tie.prestress_n);
        json!({
            "forces_at_rest_n": forces_n.collect::<Vec<_>>(),
            "stands_without": matches!(self.without, Without::Stands(_)),
            "without": { "right": right, "left": left },
            "yielding": { "right": side(&self.yielding[0]), "left": side(&self.yielding[1]) },
        })
    }

    pub fn text(&self, row: &Row) -> String {
        let at_rest = forces(row.ties().iter().map(|tie| tie.prestress_n));
        let mut text = format!("this is with {} at rest: {at_rest}\n", ties(row.ties()));
        text += &match self.without {
            Without::Falls => "without, it falls under its own weight\n".to_owned(),
            Without::Stands(pushes) => {
                let said = SIDES.iter().zip(pushes).map(|(sway, push_g)| match push_g {
                    Some(push_g) => format!("{push_g:.8} g to the {}", sway.name()),
                    None => format!("no push to the {}", sway.name()),
                });
                format!("without: {}\n", said.collect::<Vec<_>>().join(", "))
            }
        };
        text +=
            "what it bears at most, ties pulling with any force up to that at which they yield:\n";
        for (sway, limit) in SIDES.into_iter().zip(&self.yielding) {
            let side = sway.name();
            let Some(limit) = limit else {
                let _ = writeln!(text, "to the {side} any push, as long as ties hold");
                continue;
            };
            let _ = writeln!(
                text,
                "to the {side} {:.8} g with {}; then hinges open at",
                limit.onset.acceleration_g,
                forces(limit.forces_n.iter().copied()),
            );
            text += &openings_text(row, &limit.onset);
        }
        text.push('\n');
        text
    }
}

fn ties(ties: &[Tie]) -> &'static str {
    match ties {
        [_] => "the tie as it pulls",
        _ => "the ties as they pull",
    }
}

/// Forces of ties, in words.
pub fn forces(forces_n: impl Iterator<Item = f64>) -> String {
    let each: Vec<String> = forces_n
        .map(|force_n| format!("{} kN", fixed(1e-3 * force_n, 6)))
        .collect();
    each.join(", ")
}
