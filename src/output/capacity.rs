//! Capacity curves as a table, JSON and a picture.

use std::io::Write;

use serde_json::{Map, Value, json};

use super::OutputError;
use super::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign};
use super::table::table;
use crate::mechanics::capacity::Capacity;

/// Parts of the ultimate displacement at which secant periods are told.
pub const PARTS: [f64; 4] = [0.2, 0.4, 0.6, 0.8];

/// Writes a row for each point of the curves, those to the right first. The secant period is empty at the unstable
/// equilibrium.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_table(writer: impl Write, sides: &[Capacity; 2]) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the capacity curve";
    let mut csv = table(writer);
    csv.write_record([
        "sway",
        "q_rad",
        "displacement_m",
        "acceleration_g",
        "oscillator_displacement_m",
        "oscillator_acceleration_g",
        "secant_period_s",
    ])
    .map_err(OutputError::csv(WHAT))?;
    for side in sides {
        for point in &side.curve {
            let numbers = [
                point.q_rad,
                point.displacement_m,
                point.acceleration_g,
                point.oscillator_displacement_m,
                point.oscillator_acceleration_g,
            ];
            csv.serialize((side.sway.name(), numbers, point.secant_period_s))
                .map_err(OutputError::csv(WHAT))?;
        }
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// Both sides, without the points of the curves.
#[must_use]
pub fn to_json(sides: &[Capacity; 2], gravity_m_s2: f64) -> Value {
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
        json!({
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
        })
    };
    let [right, left] = sides;
    json!({ "capacity": { "right": side(right), "left": side(left) } })
}

/// Acceleration against displacement of the control point, both sides.
#[must_use]
pub fn draw(figure: Figure, title: &str, sides: &[Capacity; 2]) -> String {
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
