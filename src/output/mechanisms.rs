//! Mechanisms and limit analysis as JSON.

use serde_json::{Value, json};

use super::rotations::columns;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::blocks::Row;
use crate::mechanics::chain::Hinge;
use crate::mechanics::equivalent::Block;
use crate::mechanics::friction::{self, FrictionError, FrictionOnset};
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::stability::RowOnset;
use crate::mechanics::sway::Sway;

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
            Hinge::Joint { joint, edge } => {
                json!({ "joint": joint, "edge": edge.map(Edge::name) })
            }
        })
        .collect()
}

/// Limit analysis of a row whose joints slip with this coefficient: the associated bound to either side, whether sliding governs
/// it, its mechanism, and the least coefficient with which the row stands.
///
/// # Errors
/// When the row does not stand with this coefficient, or a programme is not solved.
pub fn friction(row: &Row, coefficient: f64) -> Result<Value, FrictionError> {
    let mut sides = serde_json::Map::new();
    for sway in [Sway::Right, Sway::Left] {
        let onset = friction::onset(row, coefficient, sway)?;
        let mechanism = |onset: &FrictionOnset| -> Value {
            let joints = onset.yields.iter().map(|joint| {
                let [intrados, extrados] = joint.opens;
                json!({
                    "joint": joint.joint,
                    "opens_intrados": intrados,
                    "opens_extrados": extrados,
                    "slips_towards": joint.slips.map(Edge::name),
                })
            });
            joints.collect()
        };
        sides.insert(
            sway.name().to_owned(),
            json!({
                "incipient_acceleration_g": onset.as_ref().map(|onset| onset.acceleration_g),
                "sliding_governs": onset.as_ref().is_some_and(FrictionOnset::sliding_governs),
                "mechanism": onset.as_ref().map(mechanism),
            }),
        );
    }
    let least_coefficient = friction::least_coefficient(row)?;
    let mut result = json!({ "coefficient": coefficient, "least_coefficient": least_coefficient });
    if let Some(more) = result.as_object_mut() {
        more.append(&mut sides);
    }
    Ok(result)
}

/// Result of `limit` for a row of blocks: the push that starts it to each side, by the static programme, and the joints
/// that open.
#[must_use]
pub fn row_limit(row: &Row, onsets: &[Option<RowOnset>; 2], gravity_m_s2: f64) -> Value {
    let [right, left] = onsets;
    let mechanism = |onset: &Option<RowOnset>| -> Value {
        let openings = onset.iter().flat_map(|onset| &onset.openings);
        openings
            .map(|opening| {
                let joint = &row.joints()[opening.joint];
                let corner_m = joint.corner_m(opening.hinge.unwrap_or(Edge::Intrados));
                json!({
                    "joint": opening.joint,
                    "edge": opening.hinge.map(Edge::name),
                    "x_m": corner_m.x,
                    "y_m": corner_m.y,
                })
            })
            .collect()
    };
    let acceleration_g =
        |onset: &Option<RowOnset>| onset.as_ref().map(|onset| onset.acceleration_g);
    json!({
        "incipient_acceleration_g": { "right": acceleration_g(right), "left": acceleration_g(left) },
        "incipient_acceleration_m_s2": {
            "right": acceleration_g(right).map(|g| g * gravity_m_s2),
            "left": acceleration_g(left).map(|g| g * gravity_m_s2),
        },
        "mechanism": { "right": mechanism(right), "left": mechanism(left) },
    })
}

/// What four links know of each side: unstable equilibrium and equivalent blocks.
#[must_use]
pub fn of_both_sides(model: &dyn MechanismModel, gravity_m_s2: f64) -> Value {
    let side = |sway| {
        json!({
            "hinges": hinges(&model.hinges_after(0, sway)),
            "unstable_equilibrium_rad": model.critical_rotations_towards_rad(sway),
            "equivalent_block": equivalent_json(model, sway, gravity_m_s2),
        })
    };
    json!({ "right": side(Sway::Right), "left": side(Sway::Left) })
}

fn equivalent_json(model: &dyn MechanismModel, sway: Sway, gravity_m_s2: f64) -> Option<Value> {
    let block = |block: Block| json!({ "p_rad_s": block.frequency_rad_s, "half_diagonal_m": block.half_diagonal_m });
    model.equivalent_towards(sway, gravity_m_s2).map(|blocks| {
        json!({
            "slenderness_rad": blocks.slenderness_rad,
            "at_rest": blocks.at_rest.map(block),
            "at_critical": blocks.at_critical.map(block),
        })
    })
}

/// Result of `limit`: incipient acceleration and mechanism on both sides, rotations of the bodies at the unstable
/// equilibrium of the first mechanism swaying right (those swaying left are its mirror image), and the equivalent blocks
/// (see [`crate::mechanics::equivalent`]), the same on both sides.
#[must_use]
pub fn limit(model: &dyn MechanismModel, gravity_m_s2: f64) -> Value {
    let both =
        |of: &dyn Fn(Sway) -> Value| json!({ "right": of(Sway::Right), "left": of(Sway::Left) });
    let equivalent = equivalent_json(model, Sway::Right, gravity_m_s2);
    let bodies = model.bodies();
    let keys = columns(&bodies, "rotation", "rad").into_iter();
    let unstable: serde_json::Map<_, _> = keys
        .zip(model.critical_rotations_rad().into_iter().map(Value::from))
        .collect();
    json!({
        "incipient_acceleration_g": both(&|sway| model.incipient_acceleration_g(sway).into()),
        "incipient_acceleration_m_s2": both(&|sway| {
            let incipient_g = model.incipient_acceleration_g(sway);
            incipient_g.map(|incipient_g| incipient_g * gravity_m_s2).into()
        }),
        "mechanism": both(&|sway| hinges(&model.hinges_after(0, sway))),
        "unstable_rotations": unstable,
        "equivalent_block": equivalent,
    })
}
