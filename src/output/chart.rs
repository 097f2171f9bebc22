//! The chart of shapes: incipient acceleration and restitution over the thickness ratio.

use std::io::Write;

use super::OutputError;
use super::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign, Stroke, color};
use super::table::table;
use crate::studies::survey::ShapeResult;

/// Writes a row per shape. Where an impact stops the arch the restitution coefficient is left empty.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_table(writer: impl Write, results: &[ShapeResult]) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the chart";
    let mut csv = table(writer);
    csv.write_record([
        "embrace_deg",
        "thickness_ratio",
        "incipient_acceleration_g",
        "first_restitution",
        "last_restitution",
    ])
    .map_err(OutputError::csv(WHAT))?;
    for result in results {
        let restitutions = [result.first_restitution, result.last_restitution];
        csv.serialize((
            result.embrace_deg,
            result.thickness_ratio,
            result.incipient_g,
            restitutions,
        ))
        .map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// A quantity of a shape, if it has it.
type Quantity = fn(&ShapeResult) -> Option<f64>;

/// Draws three panels, a curve for each embrace angle, and marks the results of the scenario's own arch. Results come
/// embrace by embrace, thicknesses ascending.
#[must_use]
pub fn draw(figure: Figure, results: &[ShapeResult], own: Option<&ShapeResult>) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title("Circular arches of several embrace angles");
    let groups: Vec<&[ShapeResult]> = results
        .chunk_by(|a, b| a.embrace_deg.to_bits() == b.embrace_deg.to_bits())
        .collect();
    let names: Vec<String> = groups
        .iter()
        .filter_map(|group| group.first())
        .map(|first| format!("{} deg", first.embrace_deg))
        .collect();
    let own_name = own.map(|own| {
        let (embrace_deg, thickness_ratio) = (own.embrace_deg, own.thickness_ratio);
        format!("the scenario's arch, {embrace_deg} deg, t/R = {thickness_ratio}")
    });
    let mut keys: Vec<Key<'_>> = names
        .iter()
        .zip(CURVES)
        .map(|(name, stroke)| (name.as_str(), Sign::Line(stroke)))
        .collect();
    keys.extend(
        own_name
            .iter()
            .map(|name| (name.as_str(), Sign::Circle(4.0, OWN))),
    );
    let mut top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let thicknesses = results.iter().map(|result| result.thickness_ratio);
    let thickness = Scale::around(thicknesses, figure.ticks(8));
    let panels: [(&str, Quantity); 3] = [
        ("A_L (g)", |result| Some(result.incipient_g)),
        ("r, first impact", |result| result.first_restitution),
        ("r, repeating impacts", |result| result.last_restitution),
    ];
    for (index, (label, quantity)) in panels.into_iter().enumerate() {
        let height = figure.height_px(250.0);
        let axes = Axes {
            frame: figure.plot(top, height),
            x: thickness,
            y: Scale::around(results.iter().filter_map(quantity).chain([0.0]), 6),
        };
        axes.draw(&mut drawing, (index == 2).then_some("t / R"), label);
        let place = |result: &ShapeResult| {
            quantity(result).map(|value| axes.place(result.thickness_ratio, value))
        };
        for ((group, name), stroke) in groups.iter().zip(&names).zip(CURVES) {
            let points = group.iter().filter_map(place);
            drawing.curve(&format!("{label} {name}"), points, stroke);
        }
        if let Some(at) = own.and_then(place) {
            drawing.circle(&format!("{label} own"), at, 4.0, OWN);
        }
        top += height + 20.0;
    }
    drawing.finish(top + 40.0)
}

/// The scenario's own arch.
const OWN: Stroke = Stroke::new(color::BLACK, 1.8, "");
