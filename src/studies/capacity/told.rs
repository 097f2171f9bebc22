//! Reports capacity curves: as a table, JSON, a picture and words.

use std::fmt::Write as _;

use serde_json::{Map, Value, json};

use super::held_row;
use crate::argument::fixed;
use crate::mechanics::capacity::{Capacity, CurvePoint, TieOnTheWay};
use crate::mechanics::parts::Parts as _;
use crate::mechanics::sway::Sway;
use crate::output::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign};
use crate::output::table::{column, csv};
use crate::output::{OutputError, pretty};
use crate::scenario::Scenario;
use crate::studies::results::Results;

/// Fractions of the ultimate displacement at which secant periods are reported.
const PARTS: [f64; 4] = [0.2, 0.4, 0.6, 0.8];

/// Names of the files, the seal last.
pub const FILES: [&str; 3] = ["capacity.svg", "capacity.csv", "capacity.json"];

/// Files and words for the curves of a scenario to both sides; one of the files is JSON.
///
/// # Errors
/// When a value is not finite.
pub fn tell(
    scenario: &Scenario,
    sides: &[Capacity; 2],
    figure: Figure,
) -> Result<Results, OutputError> {
    let gravity_m_s2 = scenario.gravity_m_s2();
    let title = scenario.title().unwrap_or("Capacity");
    let masses = match held_row(scenario.structure()) {
        Ok(Some(row)) => row.parts_in_words(),
        _ => scenario.structure().as_parts().parts_in_words(),
    };
    let words = words(sides, &masses, gravity_m_s2);
    let mut json = to_json(sides, gravity_m_s2);
    json["masses"] = masses.into();
    json["scenario"] = scenario.to_json();
    let contents = [
        figure
            .fitted(|figure| draw(figure, title, sides))
            .into_bytes(),
        table(sides)?,
        pretty(&json).into_bytes(),
    ];
    Ok(Results {
        files: FILES.into_iter().zip(contents).collect(),
        words,
        summary: json,
        ..Results::default()
    })
}

/// A row for each point of the curves, those to the right first. The secant period is empty at the unstable equilibrium.
fn table(sides: &[Capacity; 2]) -> Result<Vec<u8>, OutputError> {
    type Row<'a> = (Sway, &'a CurvePoint);
    let rows: Vec<Row<'_>> = sides
        .iter()
        .flat_map(|side| side.curve.iter().map(|point| (side.sway, point)))
        .collect();
    let columns = [
        column("sway", |row: &Row<'_>| row.0.name()),
        column("q_rad", |row: &Row<'_>| row.1.q_rad),
        column("displacement_m", |row: &Row<'_>| row.1.displacement_m),
        column("acceleration_g", |row: &Row<'_>| row.1.acceleration_g),
        column("oscillator_displacement_m", |row: &Row<'_>| {
            row.1.oscillator_displacement_m
        }),
        column("oscillator_acceleration_g", |row: &Row<'_>| {
            row.1.oscillator_acceleration_g
        }),
        column("secant_period_s", |row: &Row<'_>| row.1.secant_period_s),
    ];
    csv(columns, &rows)
}

/// The JSON for both sides, without the points of the curves.
fn to_json(sides: &[Capacity; 2], gravity_m_s2: f64) -> Value {
    let side = |capacity: &Capacity| {
        let periods: Map<String, Value> = PARTS
            .iter()
            .map(|part| {
                (
                    format!("{part}"),
                    capacity.secant_period_s(*part, gravity_m_s2).into(),
                )
            })
            .collect();
        let mut told = json!({
            "control_point_m": [capacity.control.at_m.x, capacity.control.at_m.y],
            "acceleration_g": capacity.start().acceleration_g,
            "ultimate_displacement_m": capacity.end().displacement_m,
            "oscillator": {
                "participating_mass_kg": capacity.participating_mass_kg,
                "mass_fraction": capacity.mass_fraction,
                "acceleration_g": capacity.start().oscillator_acceleration_g,
                "ultimate_displacement_m": capacity.end().oscillator_displacement_m,
                "secant_period_s_at_part_of_ultimate": periods,
            },
        });
        if !capacity.ties.is_empty() {
            let ties = capacity.ties.iter();
            let ties = ties.map(
                |tie| json!({ "yields_at_m": tie.yields_at_m, "breaks_at_m": tie.breaks_at_m }),
            );
            told["ties"] = ties.collect();
        }
        told
    };
    let [right, left] = sides;
    json!({ "capacity": { "right": side(right), "left": side(left) } })
}

/// Draws acceleration against displacement of the control point, for both sides.
fn draw(figure: Figure, title: &str, sides: &[Capacity; 2]) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(title);
    let names = sides
        .each_ref()
        .map(|side| format!("to the {}", side.sway.name()));
    let keys: Vec<Key<'_>> = names
        .iter()
        .zip(CURVES)
        .map(|(name, stroke)| (name.as_str(), Sign::Line(stroke)))
        .collect();
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let points = || sides.iter().flat_map(|side| &side.curve);
    let height = figure.height_px(330.0);
    let axes = Axes {
        frame: figure.plot(top, height),
        x: Scale::around(points().map(|point| point.displacement_m), figure.ticks(8)),
        y: Scale::around(points().map(|point| point.acceleration_g), 6),
    };
    let label = "displacement of the control point (m)";
    axes.draw(&mut drawing, Some(label), "a (g)");
    for ((side, name), stroke) in sides.iter().zip(&names).zip(CURVES) {
        let curve = side.curve.iter();
        let points = curve.map(|point| axes.place(point.displacement_m, point.acceleration_g));
        drawing.curve(name, points, stroke);
    }
    drawing.finish(top + height + 60.0)
}

fn words(sides: &[Capacity; 2], masses: &str, gravity_m_s2: f64) -> String {
    let control = sides[0].control.at_m;
    let mut text = format!(
        "quasi-static capacity of the first mechanism, control point at x {} m, y {} m\n\
         masses at the centres of {masses}; `archrock verify` takes the rigid bodies of the mechanism\n",
        fixed(control.x, 4),
        fixed(control.y, 4)
    );
    for side in sides {
        let (start, end) = (side.start(), side.end());
        let _ = write!(
            text,
            "\nto the {}\n  a(0) = A_L                     {:>12.6} g\n  ultimate displacement          {:>12.6} m\n  \
             participating mass M*          {:>12.1} kg, fraction e* {:.4}\n  \
             equivalent oscillator a0*      {:>12.6} g\n  \
             equivalent oscillator d0*      {:>12.6} m\n  secant periods at",
            side.sway.name(),
            start.acceleration_g,
            end.displacement_m,
            side.participating_mass_kg,
            side.mass_fraction,
            start.oscillator_acceleration_g,
            end.oscillator_displacement_m,
        );
        for part in PARTS {
            let period_s = side
                .secant_period_s(part, gravity_m_s2)
                .unwrap_or(f64::INFINITY);
            let _ = write!(text, "  {part} d0*: {period_s:.4} s");
        }
        text.push('\n');
        for (number, tie) in (1..).zip(&side.ties) {
            let _ = writeln!(text, "  tie {number} {}", gives_way(tie));
        }
    }
    text
}

/// What a tie does on the way, in words.
fn gives_way(tie: &TieOnTheWay) -> String {
    let does = [("yields", tie.yields_at_m), ("breaks", tie.breaks_at_m)];
    let does = does
        .into_iter()
        .filter_map(|(what, at_m)| Some(format!("{what} at {:.6} m", at_m?)));
    match does.collect::<Vec<_>>().join(" and ") {
        nothing if nothing.is_empty() => "holds".to_owned(),
        does => does,
    }
}
