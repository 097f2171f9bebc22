//! Mechanisms, limit analysis and the chain of impacts as JSON.

use serde_json::{Value, json};

use crate::mechanics::equivalent::{Block, equivalent};
use crate::mechanics::mechanism::Sway;
use crate::mechanics::structure::{Hinge, Structure};

/// Hinges from left to right: `{angle_deg, edge}`, the angle from the left springing, for an arch,
/// `{toe}` for a column.
#[must_use]
pub fn hinges(hinges: &[Hinge]) -> Value {
    hinges
        .iter()
        .map(|hinge| match hinge {
            Hinge::Section { angle_rad, edge } => {
                json!({ "angle_deg": angle_rad.to_degrees(), "edge": edge.name() })
            }
            Hinge::Toe(side) => json!({ "toe": side.name() }),
        })
        .collect()
}

/// Result of `limit`: incipient acceleration and mechanism on both sides, and the equivalent blocks
/// (see [`crate::mechanics::equivalent`]), the same on both.
#[must_use]
pub fn limit<S: Structure>(structure: &S, gravity_m_s2: f64) -> Value {
    let both =
        |of: &dyn Fn(Sway) -> Value| json!({ "right": of(Sway::Right), "left": of(Sway::Left) });
    let block = |block: Block| json!({ "p_rad_s": block.frequency_rad_s, "half_diagonal_m": block.half_diagonal_m });
    let equivalent = equivalent(structure, gravity_m_s2).map(|blocks| {
        json!({
            "slenderness_rad": blocks.slenderness_rad,
            "at_rest": blocks.at_rest.map(block),
            "at_critical": blocks.at_critical.map(block),
        })
    });
    json!({
        "incipient_acceleration_g": both(&|_| structure.incipient_g().into()),
        "mechanism": both(&|sway| hinges(&structure.hinges(0, sway))),
        "equivalent_block": equivalent,
    })
}

/// Result of `impact`: the first `count` links of the chain that begins with a sway to the right; fewer
/// when an impact stops the structure.
#[must_use]
pub fn impacts<S: Structure>(structure: &S, count: usize) -> Value {
    let mut sway = Sway::Right;
    let mut impacts = Vec::new();
    for index in 1..=count {
        let Some(after) = structure.link(index) else {
            break;
        };
        let side = |impacts: usize, sway: Sway| json!({ "sway": sway.name(), "hinges": hinges(&structure.hinges(impacts, sway)) });
        impacts.push(json!({
            "index": index,
            "restitution": after.restitution,
            "before": side(index - 1, sway),
            "after": side(index, sway.opposite()),
        }));
        sway = sway.opposite();
    }
    json!({ "impacts": impacts })
}
