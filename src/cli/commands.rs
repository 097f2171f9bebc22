//! The command `limit`, and what commands share.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

use archrock::dynamics::model::{FourLinkModel, MechanismModel};
use archrock::mechanics::blocks::Row;
use archrock::mechanics::chain::Hinge;
use archrock::mechanics::equivalent::{Block, Equivalent};
use archrock::mechanics::friction::{self, FrictionError};
use archrock::mechanics::geometry::ring::Edge;
use archrock::mechanics::stability::onset;
use archrock::mechanics::sway::Sway;
use archrock::output::pretty;
use archrock::output::{Figure, mechanisms, pictures};
use archrock::scenario::{Scenario, Structure};

use super::scenario_file::ScenarioFile;
use serde_json::json;

use super::{Failure, Format, print};

/// The model of a scenario.
pub fn model(scenario: &Scenario) -> Result<Box<dyn MechanismModel>, Failure> {
    let model = scenario.structure.model(scenario.impact);
    model.map_err(|error| Failure::Input(error.to_string()))
}

pub fn limit(
    file: &ScenarioFile,
    format: Format,
    plot: Option<(&Path, Figure, Sway)>,
) -> Result<(), Failure> {
    let scenario = file.open()?.read(None)?;
    if let Some((plot, figure, first)) = plot {
        let model = four_links(&scenario, "--plot is")?;
        write_picture(
            plot,
            &pictures::limit(figure, model.chain_from(first), first),
        )?;
    }
    let gravity_m_s2 = scenario.simulation.gravity_m_s2;
    let row = scenario.row();
    let row = row.map_err(|error| Failure::Input(error.to_string()))?;
    let (mut json, mut text) = if let Some(row) = row {
        row_limit(&scenario, &row)?
    } else {
        let model = model(&scenario)?;
        (
            mechanisms::limit(&*model, gravity_m_s2),
            limit_text(&*model, gravity_m_s2),
        )
    };
    let options = scenario.free_hinges.unwrap_or_default();
    if let Some(coefficient) = options.friction_coefficient {
        let model = scenario.structure.free_hinges(options);
        let model = model.map_err(|error| Failure::Input(error.to_string()))?;
        json["friction"] = mechanisms::friction(model.row(), coefficient)?;
        text += &friction_text(model.row(), coefficient)?;
    }
    match format {
        Format::Json => print(&pretty(&json)),
        Format::Text => print(&text),
    }
}

/// The push that starts a row, by the static programme, and what opens: for programs and for people.
fn row_limit(scenario: &Scenario, row: &Row) -> Result<(serde_json::Value, String), Failure> {
    let gravity_m_s2 = scenario.simulation.gravity_m_s2;
    let onset = |sway| onset(row, sway).map_err(|error| Failure::Input(error.to_string()));
    let onsets = [onset(Sway::Right)?, onset(Sway::Left)?];
    let mut json = mechanisms::row_limit(row, &onsets, gravity_m_s2);
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
             a push to the {side} opens",
            onset.acceleration_g,
            onset.acceleration_g * gravity_m_s2,
        );
        for opening in &onset.openings {
            let edge = opening.hinge.map_or("both edges", Edge::name);
            let corner_m =
                row.joints()[opening.joint].corner_m(opening.hinge.unwrap_or(Edge::Intrados));
            let _ = writeln!(
                text,
                "  joint {:>3} at x {:>10.5} m, y {:>10.5} m, {edge}",
                opening.joint, corner_m.x, corner_m.y
            );
        }
        text.push('\n');
    }
    if let Structure::Column(_) = scenario.structure {
        text += "joints are counted from the base, which is 0; their intrados is the left side\n";
        return Ok((json, text));
    }
    text += "joints are counted from the left, 0 at the left base or springing\n\n";
    match scenario.structure.model(scenario.impact) {
        Err(error) => {
            json["four_links"] = json!({ "none_because": error.to_string() });
            let _ = writeln!(text, "{error}");
        }
        Ok(model) => {
            json["four_links"] = mechanisms::of_both_sides(&*model, gravity_m_s2);
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
    Ok((json, text))
}

impl From<FrictionError> for Failure {
    fn from(error: FrictionError) -> Self {
        match error {
            FrictionError::CannotStand(_) | FrictionError::NeverStands => {
                Self::Input(error.to_string())
            }
            FrictionError::NotSolved(_) => Self::Work(error.to_string()),
        }
    }
}

/// What the limit analysis says of joints that slip.
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
            "sliding governs; it takes joints to open as they slip, and is an upper bound"
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
                [true, true] => Some("opens at both edges"),
                [true, false] => Some("opens at the intrados"),
                [false, true] => Some("opens at the extrados"),
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

/// The four links of a scenario; the error for a column begins with `what`, subject and verb.
pub fn four_links(scenario: &Scenario, what: &str) -> Result<Box<dyn FourLinkModel>, Failure> {
    let model = scenario.structure.four_links(scenario.impact);
    model
        .map_err(|error| Failure::Input(error.to_string()))?
        .ok_or_else(|| Failure::Input(format!("{what} for arches only; the scenario has a column")))
}

/// Writes a picture to the file named by `--plot`.
pub fn write_picture(path: &Path, picture: &str) -> Result<(), Failure> {
    let cannot = |error: io::Error| format!("cannot write {}: {error}", path.display());
    let mut file = File::create(path).map_err(|error| {
        Failure::Input(format!(
            "{}; choose another file with --plot",
            cannot(error)
        ))
    })?;
    file.write_all(picture.as_bytes())
        .map_err(|error| Failure::Work(cannot(error)))
}

/// Values of the bodies with their names, from left to right.
pub fn by_body(bodies: &[String], values: &[f64]) -> String {
    let named = bodies.iter().zip(values);
    let texts: Vec<_> = named
        .map(|(body, value)| format!("{body} {value:.6}").trim_start().to_owned())
        .collect();
    texts.join(", ")
}

fn limit_text(model: &dyn MechanismModel, gravity_m_s2: f64) -> String {
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

/// Names of the hinges of an arch, from left to right.
pub const HINGES: [&str; 4] = ["A", "B", "C", "D"];

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

/// Degrees, with rounding errors at the left springing removed.
pub fn degrees(angle_rad: f64) -> f64 {
    if angle_rad < 1e-12 {
        0.0
    } else {
        angle_rad.to_degrees()
    }
}
