//! What springings that move make of an arch, told: table, JSON, picture, words.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::picture::draw;
use super::{NotFound, Path, Push, SIDES, SpreadPaths, Stage};
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::settling::{Hinge, Snap};
use crate::mechanics::sway::Sway;
use crate::output::scene::Scene;
use crate::output::table::{Cell, column, csv, several};
use crate::output::{Figure, OutputError, pretty};
use crate::scenario::Scenario;
use crate::studies::results::Results;

/// Names of the files, the seal last.
pub const FILES: [&str; 3] = ["spread.svg", "spread.csv", "spread.json"];

/// Parts of a way that are told in words.
const PARTS: [usize; 5] = [0, 5, 10, 15, 20];

/// Files and words of all ways; and the JSON among the files.
///
/// # Errors
/// When a value is not finite.
pub fn tell(
    scenario: &Scenario,
    spread: &SpreadPaths,
    figure: Figure,
) -> Result<Results, OutputError> {
    let scene = Scene::of_row(&spread.row).of_structure(scenario.structure());
    let weight_n = spread.row.mass_kg() * scenario.gravity_m_s2();
    let title = scenario.title().unwrap_or("Springings that move");
    let mut json = to_json(spread, weight_n);
    json["scenario"] = scenario.to_json();
    let contents = [
        draw(figure, title, spread, &scene).into_bytes(),
        table(spread, weight_n)?,
        pretty(&json).into_bytes(),
    ];
    Ok(Results {
        files: FILES.into_iter().zip(contents).collect(),
        words: words(spread, scenario.motion().friction_coefficient()),
        summary: json,
        ..Results::default()
    })
}

/// A row for each stage of every way.
fn table(spread: &SpreadPaths, weight_n: f64) -> Result<Vec<u8>, OutputError> {
    type Row<'a> = (&'a Path, &'a Stage);
    let paths = spread.paths.iter();
    let rows: Vec<Row<'_>> = paths
        .flat_map(|path| path.stages.iter().map(move |stage| (path, stage)))
        .collect();
    let states = rows.iter().filter_map(|(_, stage)| stage.state.as_ref());
    // Ties may hold it on more.
    let most = states.map(|state| state.hinges.len()).fold(3, usize::max);
    let hinges = (1..=most).flat_map(|hinge| {
        ["joint", "edge", "rotation_rad"].map(|what| format!("hinge_{hinge}_{what}"))
    });
    let pushes = ["first_motion", "capacity"]
        .into_iter()
        .flat_map(|push| ["right", "left"].map(|side| format!("{push}_{side}_g")));
    let columns = [
        column("springing", |row: &Row<'_>| row.0.way.springing.name()),
        column("angle_deg", |row: &Row<'_>| row.0.way.angle_deg),
        column("movement_m", |row: &Row<'_>| row.1.movement_m),
        several(hinges, |row: &Row<'_>, cells: &mut Vec<Cell<'_>>| {
            for index in 0..most {
                let state = row.1.state.as_ref();
                let hinge = state.and_then(|state| state.hinges.get(index));
                let turn_rad = state.and_then(|state| state.turns_rad.get(index));
                cells.push(hinge.map(|hinge| hinge.joint).into());
                cells.push(hinge.map(|hinge| hinge.edge.name()).into());
                cells.push(turn_rad.copied().into());
            }
        }),
        column("thrust_n", move |row: &Row<'_>| {
            row.1.thrust_ratio().map(|ratio| ratio * weight_n)
        }),
        column("thrust_ratio", |row: &Row<'_>| row.1.thrust_ratio()),
        column("friction_demand", |row: &Row<'_>| {
            row.1.state.as_ref().map(|state| state.friction)
        }),
        column("crown_drop_m", |row: &Row<'_>| row.1.crown_drop_m),
        several(pushes, |row: &Row<'_>, cells: &mut Vec<Cell<'_>>| {
            for push in Push::ALL {
                cells.extend(row.1.sides(*push).map(Cell::from));
            }
        }),
    ];
    csv(columns, &rows)
}

fn to_json(spread: &SpreadPaths, weight_n: f64) -> Value {
    let paths: Vec<Value> = spread
        .paths
        .iter()
        .map(|path| {
            let causes = path.falls_at_m.and(path.snaps.last());
            let causes = causes.map_or(&[][..], |fall| &fall.causes[..]);
            json!({
                "springing": path.way.springing.name(),
                "angle_deg": path.way.angle_deg,
                "falls_at_m": path.falls_at_m,
                "falls_at_part_of_clear_span": path.falls_at_m.map(|at_m| at_m / spread.clear_span_m),
                "falls_by": hinges(causes),
                "lost": path.lost.as_ref().map(ToString::to_string),
                "snaps": path.snaps.iter().map(snap).collect::<Vec<_>>(),
                "stages": path.stages.iter().map(|stage| stage_json(stage, weight_n)).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({
        "clear_span_m": spread.clear_span_m,
        "weight_n": weight_n,
        "paths": paths,
    })
}

fn hinges(hinges: &[Hinge]) -> Value {
    let hinge = |hinge: &Hinge| json!({ "joint": hinge.joint, "edge": hinge.edge.name() });
    hinges.iter().map(hinge).collect()
}

fn snap(snap: &Snap) -> Value {
    let of = |all: &Option<Vec<Hinge>>| all.as_ref().map_or(Value::Null, |all| hinges(all));
    json!({
        "at_m": snap.at,
        "hinges_before": of(&snap.before),
        "hinges_after": of(&snap.after),
        "by": hinges(&snap.causes),
    })
}

fn stage_json(stage: &Stage, weight_n: f64) -> Value {
    let state = stage.state.as_ref();
    let open: Vec<Value> = state.map_or_else(Vec::new, |state| {
        let hinges = state.hinges.iter().zip(&state.turns_rad);
        let open = hinges.map(|(hinge, turn_rad)| {
            json!({ "joint": hinge.joint, "edge": hinge.edge.name(), "rotation_rad": turn_rad })
        });
        open.collect()
    });
    let sides = |push: Push| {
        let [right, left] = stage.sides(push);
        json!({ "right": right, "left": left })
    };
    let not_found = |missing: &NotFound| {
        json!({
            "push": missing.push.name(),
            "side": missing.sway.name(),
            "reason": missing.reason.to_string(),
        })
    };
    json!({
        "movement_m": stage.movement_m,
        "hinges": open,
        "thrust_n": stage.thrust_ratio().map(|ratio| ratio * weight_n),
        "thrust_ratio": stage.thrust_ratio(),
        "right_support_force_n": state.map(|state| {
            let force = state.right_reaction.linear * weight_n;
            [force.x, force.y]
        }),
        "friction_demand": state.map(|state| state.friction),
        "crown_drop_m": stage.crown_drop_m,
        "first_motion_g": sides(Push::FirstMotion),
        "capacity_g": sides(Push::Capacity),
        "not_found": stage.not_found.iter().map(not_found).collect::<Vec<_>>(),
    })
}

/// A hinge by its joint and the letter of its edge.
fn short(hinge: &Hinge) -> String {
    let edge = match hinge.edge {
        Edge::Intrados => 'i',
        Edge::Extrados => 'e',
    };
    format!("{}{edge}", hinge.joint)
}

/// A line about the stages of a way at which a push to a side was not found.
fn not_found(text: &mut String, path: &Path, push: Push, sway: Sway) {
    let stages = path.stages.iter();
    let missing: Vec<(f64, &NotFound)> = stages
        .filter_map(|stage| {
            let mut missing = stage.not_found.iter();
            let missing = missing.find(|missing| missing.push == push && missing.sway == sway)?;
            Some((stage.movement_m, missing))
        })
        .collect();
    if let [(first_m, first), ..] = missing[..] {
        let _ = writeln!(
            text,
            "  {} to the {} not found at {} of {} stages, first at {first_m:.6} m: {}",
            push.name(),
            sway.name(),
            missing.len(),
            path.stages.len(),
            first.reason
        );
    }
}

fn words(spread: &SpreadPaths, friction_coefficient: Option<f64>) -> String {
    let mut text = String::new();
    let clear_span_m = spread.clear_span_m;
    for path in &spread.paths {
        let (springing, way) = (path.way.springing.name(), path.way.words());
        let last = path.stages.len() - 1;
        let _ = match (path.falls_at_m, &path.lost) {
            (Some(at_m), _) => writeln!(
                text,
                "{springing} springing {way}: falls at {at_m:.6} m, {:.5} of the clear span of {clear_span_m:.3} m",
                at_m / clear_span_m
            ),
            (None, Some(reason)) => writeln!(
                text,
                "{springing} springing {way}: stands up to {:.6} m, and was not followed further: {reason}",
                path.stages[last].movement_m
            ),
            (None, None) => writeln!(
                text,
                "{springing} springing {way}: stands as far as it was moved, the clear span of {clear_span_m:.3} m"
            ),
        };
        let _ = writeln!(
            text,
            "  movement m   hinges          thrust/weight  crown drop m  first motion g  capacity g"
        );
        for part in PARTS.map(|part| part.min(last)) {
            let stage = &path.stages[part];
            let hinges: Vec<String> = stage.hinges().iter().map(short).collect();
            let number = |value: Option<f64>, digits: usize| {
                value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
            };
            let _ = writeln!(
                text,
                "  {:<11.6}  {:<15} {:>12}  {:>12.6}  {:>14}  {:>10}",
                stage.movement_m,
                hinges.join(" "),
                number(stage.thrust_ratio(), 6),
                stage.crown_drop_m,
                number(stage.least(Push::FirstMotion), 6),
                number(stage.least(Push::Capacity), 6),
            );
        }
        for push in Push::ALL {
            for side in SIDES {
                not_found(&mut text, path, *push, side);
            }
        }
        let demands = path.stages.iter().filter_map(|stage| stage.state.as_ref());
        let demand = demands.map(|state| state.friction).fold(0.0, f64::max);
        if let Some(coefficient) = friction_coefficient
            && demand > coefficient
        {
            let _ = writeln!(
                text,
                "  joints would slip: this way needs a coefficient of friction of {demand:.3}, and has {coefficient}"
            );
        }
    }
    text.push_str(
        "hinges: joint from 0 at the left springing, i at the intrados, e at the extrados; first motion: the push to the weaker side \
         at which hinges give way to others; capacity: that at which the arch falls\n",
    );
    text
}
