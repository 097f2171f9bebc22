//! Reports limit analysis, for programs and for people.

mod ties;

use std::fmt::Write as _;

use serde_json::{Value, json};

pub(super) use self::ties::forces;
use super::{Answer, NoLimit};
use crate::argument::fixed;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::blocks::Row;
use crate::mechanics::chain::Hinge;
use crate::mechanics::equivalent::{Block, Equivalent};
use crate::mechanics::four_links::FourLinkError;
use crate::mechanics::friction::{self, FrictionError, FrictionOnset};
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::stability::{RowOnset, onset};
use crate::mechanics::sway::Sway;
use crate::output::mechanisms::columns;
use crate::output::mechanisms::{HINGES, by_body, degrees, hinges};
use crate::scenario::Scenario;

/// The acceleration that starts a row, by the static programme, and the joints that open, as JSON and in words.
pub(super) fn row(scenario: &Scenario, row: &Row) -> Result<Answer, NoLimit> {
    let gravity_m_s2 = scenario.gravity_m_s2();
    let onsets = [onset(row, Sway::Right)?, onset(row, Sway::Left)?];
    let mut json = row_json(row, &onsets, gravity_m_s2);
    let mut text = String::new();
    for (sway, onset) in [Sway::Right, Sway::Left].into_iter().zip(&onsets) {
        let side = sway.name();
        let Some(onset) = onset else {
            let _ = writeln!(text, "no push to the {side} moves it without sliding\n");
            continue;
        };
        let _ = writeln!(
            text,
            "incipient rocking acceleration A_L to the {side}: {:.8} g = {:.6} m/s2\n\
             a push to the {side} opens hinges at",
            onset.acceleration_g,
            onset.acceleration_g * gravity_m_s2,
        );
        text += &openings_text(row, onset);
        text.push('\n');
    }
    if !row.ties().is_empty() {
        let tied = ties::Tied::of(row)?;
        json["ties"] = tied.json(row);
        text += &places_of_ties(scenario);
        text += &tied.text(row);
    }
    if !scenario.structure().thrusts() {
        text += "joints are counted from the base, which is 0; their intrados is the left side\n";
        return Ok(Answer { json, text });
    }
    text += "joints are counted from the left, 0 at the left base or springing\n\n";
    match scenario.mechanisms() {
        // Nothing is wrong then: limit analysis is done.
        Err(FourLinkError::Ties) => {
            let reason = "four links take no ties, so there are no unstable equilibrium and no equivalent block of theirs";
            json["four_links"] = json!({ "none_because": reason });
            let _ = writeln!(text, "{reason}");
        }
        Err(error) => {
            json["four_links"] = json!({ "none_because": error.to_string() });
            let _ = writeln!(text, "{error}");
        }
        Ok(model) => {
            json["four_links"] = of_both_sides(&*model, gravity_m_s2);
            text += "as four links, which the static programme confirms, unstable equilibrium under gravity alone at \
                     rotations (rad,\nanticlockwise) and equivalent free-standing block\n";
            for sway in [Sway::Right, Sway::Left] {
                let _ = writeln!(
                    text,
                    "  swaying {}: {}",
                    sway.name(),
                    by_body(&model.bodies(), &model.critical_rotations_towards_rad(sway))
                );
                if let Some(blocks) = model.equivalent_towards(sway, gravity_m_s2) {
                    text += &equivalent_text(&blocks);
                }
            }
        }
    }
    Ok(Answer { json, text })
}

/// The frame of reference and the place of each tie, a line each.
pub(super) fn places_of_ties(scenario: &Scenario) -> String {
    let places = scenario.structure().tie_places().into_iter();
    places.map(|place| place + "\n").collect()
}

/// The joints that open in a mechanism, a line each.
pub(super) fn openings_text(row: &Row, onset: &RowOnset) -> String {
    let mut text = String::new();
    for opening in &onset.openings {
        let edge = opening.hinge.map_or("both edges", Edge::name);
        let corner_m =
            row.joints()[opening.joint].corner_m(opening.hinge.unwrap_or(Edge::Intrados));
        let _ = writeln!(
            text,
            "  joint {:>3} at x {:>10} m, y {:>10} m, {edge}",
            opening.joint,
            fixed(corner_m.x, 5),
            fixed(corner_m.y, 5)
        );
    }
    text
}

/// The acceleration that starts the first mechanism of one degree of freedom.
pub(super) fn mechanism(scenario: &Scenario) -> Result<Answer, NoLimit> {
    let model = scenario.mechanisms()?;
    let gravity_m_s2 = scenario.gravity_m_s2();
    Ok(Answer {
        json: mechanism_json(&*model, gravity_m_s2),
        text: mechanism_text(&*model, gravity_m_s2),
    })
}

/// Adds the onset of motion of a row whose joints slip with this coefficient.
pub(super) fn add_friction(
    answer: &mut Answer,
    row: &Row,
    coefficient: f64,
) -> Result<(), FrictionError> {
    answer.json["friction"] = friction_json(row, coefficient)?;
    answer.text += &friction_text(row, coefficient)?;
    Ok(())
}

/// The result of limit analysis for joints that slip, in words.
fn friction_text(row: &Row, coefficient: f64) -> Result<String, FrictionError> {
    let mut text =
        format!("\nwith joints that slip at a coefficient of friction of {coefficient:?}:\n");
    for sway in [Sway::Right, Sway::Left] {
        let side = sway.name();
        let Some(onset) = friction::onset(row, coefficient, sway)? else {
            let _ = writeln!(text, "  no push to the {side} starts it");
            continue;
        };
        let governs = if onset.sliding_governs() {
            "sliding governs; this is an upper bound, since joints are taken to open as they slip"
        } else {
            "no joint slips"
        };
        let _ = writeln!(
            text,
            "  a push of {:.8} g starts it to the {side}: {governs}",
            onset.acceleration_g
        );
        for joint in &onset.yields {
            let open = match joint.opens {
                // Named by the edge about which it turns, as above.
                [true, true] => Some("parts at both edges"),
                [true, false] => Some("opens with its hinge at the extrados"),
                [false, true] => Some("opens with its hinge at the intrados"),
                [false, false] => None,
            };
            let slips = joint
                .slips
                .map(|edge| format!("slips, its right side towards the {}", edge.name()));
            let does: Vec<String> = open.map(str::to_owned).into_iter().chain(slips).collect();
            let _ = writeln!(text, "    joint {} {}", joint.joint, does.join(" and "));
        }
    }
    let least = friction::least_coefficient(row)?;
    let _ = writeln!(
        text,
        "  the least coefficient at which it stands is {least:.6}"
    );
    Ok(text)
}

fn mechanism_text(model: &dyn MechanismModel, gravity_m_s2: f64) -> String {
    let incipient_g = model
        .incipient_acceleration_g(Sway::Right)
        .unwrap_or(f64::INFINITY);
    let mut text = format!(
        "incipient rocking acceleration A_L, either side: {incipient_g:.8} g = {:.6} m/s2\n",
        incipient_g * gravity_m_s2,
    );
    for sway in [Sway::Right, Sway::Left] {
        let hinges = model.hinges_after(0, sway);
        let _ = write!(
            text,
            "\na push to the {} starts the mechanism with {} at\n",
            sway.name(),
            if hinges.len() == 1 {
                "its hinge"
            } else {
                "hinges"
            },
        );
        text += &hinge_list(&hinges);
    }
    let _ = write!(
        text,
        "\nunstable equilibrium of this first mechanism under gravity alone, swaying right, at rotations of\n  \
         {} rad (anticlockwise);\nthe mechanisms after impacts have their own\n",
        by_body(&model.bodies(), &model.critical_rotations_rad()),
    );
    if let Some(blocks) = model.equivalent(gravity_m_s2) {
        let _ = writeln!(
            text,
            "\nequivalent free-standing block of the same A_L, slenderness alpha {:.6} rad",
            blocks.slenderness_rad,
        );
        text += &equivalent_text(&blocks);
    }
    text
}

fn equivalent_text(blocks: &Equivalent) -> String {
    let mut text = String::new();
    for (where_to, block) in [
        ("from rest", blocks.at_rest),
        ("at the unstable equilibrium", blocks.at_critical),
    ] {
        if let Some(Block {
            frequency_rad_s,
            half_diagonal_m,
        }) = block
        {
            let _ = writeln!(
                text,
                "  {where_to:27}  p {frequency_rad_s:.6} rad/s, half diagonal {half_diagonal_m:.6} m",
            );
        }
    }
    text
}

fn hinge_list(hinges: &[Hinge]) -> String {
    let mut text = String::new();
    for (name, hinge) in HINGES.iter().zip(hinges) {
        let _ = match hinge {
            Hinge::Section { angle_rad, edge } => writeln!(
                text,
                "  {name}  {:10.5} deg from the left springing, {}",
                degrees(*angle_rad),
                edge.name()
            ),
            Hinge::Toe(side) => writeln!(text, "  the {} toe", side.name()),
            Hinge::Joint { joint, edge } => {
                let edge = edge.map_or("parted", Edge::name);
                writeln!(text, "  joint {joint}, {edge}")
            }
        };
    }
    text
}

/// Limit analysis of a row whose joints slip with this coefficient: the associated bound to either side, whether sliding governs
/// it, its mechanism, and the least coefficient with which the row stands.
///
/// # Errors
/// When the row does not stand with this coefficient, or a programme cannot be solved.
fn friction_json(row: &Row, coefficient: f64) -> Result<Value, FrictionError> {
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

/// Result of `limit` for a row of blocks: the acceleration that starts it to each side, by the static programme, and the
/// joints that open.
#[must_use]
pub fn row_json(row: &Row, onsets: &[Option<RowOnset>; 2], gravity_m_s2: f64) -> Value {
    let starts_g = onsets
        .each_ref()
        .map(|onset| onset.as_ref().map(|onset| onset.acceleration_g));
    starts_json(row, starts_g, onsets, gravity_m_s2)
}

/// The same where it starts at these accelerations, with or without a mechanism to tell.
pub(super) fn starts_json(
    row: &Row,
    [right_g, left_g]: [Option<f64>; 2],
    [right, left]: &[Option<RowOnset>; 2],
    gravity_m_s2: f64,
) -> Value {
    let mechanism = |onset: &Option<RowOnset>| openings_json(row, onset.as_ref());
    json!({
        "incipient_acceleration_g": { "right": right_g, "left": left_g },
        "incipient_acceleration_m_s2": {
            "right": right_g.map(|g| g * gravity_m_s2),
            "left": left_g.map(|g| g * gravity_m_s2),
        },
        "mechanism": { "right": mechanism(right), "left": mechanism(left) },
    })
}

/// The joints that open in a mechanism; none where there is none.
fn openings_json(row: &Row, onset: Option<&RowOnset>) -> Value {
    let openings = onset.into_iter().flat_map(|onset| &onset.openings);
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
}

/// What is specific to four links, for each side: unstable equilibrium and equivalent blocks.
fn of_both_sides(model: &dyn MechanismModel, gravity_m_s2: f64) -> Value {
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

/// Result of `limit`: incipient acceleration and mechanism on both sides; rotations of the bodies at the unstable
/// equilibrium of the first mechanism swaying right (those swaying left are its mirror image); and the equivalent blocks
/// (see [`crate::mechanics::equivalent`]), which are the same on both sides.
#[must_use]
pub fn mechanism_json(model: &dyn MechanismModel, gravity_m_s2: f64) -> Value {
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
