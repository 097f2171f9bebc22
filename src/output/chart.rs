//! The chart of shapes: incipient acceleration and restitution over the thickness ratio.

use std::io::Write;

use nalgebra::Vector2;

use super::svg::{Axes, CURVES, Drawing, Frame, Scale};
use super::{OutputError, finite};
use crate::studies::survey::ShapeResult;

/// Writes a row per shape. Where an impact stops the arch the restitution coefficient is left empty.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_table(writer: impl Write, results: &[ShapeResult]) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the chart";
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record([
        "embrace_deg",
        "thickness_ratio",
        "incipient_acceleration_g",
        "first_restitution",
        "last_restitution",
    ])
    .map_err(OutputError::csv(WHAT))?;
    for result in results {
        finite("of a row of chart.csv", &[result.incipient_g])?;
        let restitutions = [result.first_restitution, result.last_restitution];
        for restitution in restitutions.into_iter().flatten() {
            finite("of a row of chart.csv", &[restitution])?;
        }
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

/// Draws three panels, a curve for each embrace angle. Results come embrace by embrace, thicknesses ascending.
#[must_use]
pub fn draw(results: &[ShapeResult]) -> String {
    let mut drawing = Drawing::new(900.0, 940.0);
    let title = "Circular arches of several embrace angles";
    drawing.title(title);
    let groups: Vec<&[ShapeResult]> = results
        .chunk_by(|a, b| a.embrace_deg.to_bits() == b.embrace_deg.to_bits())
        .collect();
    let names: Vec<String> = groups
        .iter()
        .filter_map(|group| group.first())
        .map(|first| format!("{} deg", first.embrace_deg))
        .collect();
    let legend = names.iter().map(String::as_str).zip(CURVES);
    drawing.legend(Vector2::new(85.0, 54.0), 130.0, legend);
    let thickness = Scale::around(results.iter().map(|result| result.thickness_ratio), 8);
    let panels: [(&str, Quantity); 3] = [
        ("A_L (g)", |result| Some(result.incipient_g)),
        ("r, first impact", |result| result.first_restitution),
        ("r, repeating impacts", |result| result.last_restitution),
    ];
    let mut top = 80.0;
    for (index, (label, quantity)) in panels.into_iter().enumerate() {
        let axes = Axes {
            frame: Frame {
                left: 85.0,
                top,
                width: 790.0,
                height: 250.0,
            },
            x: thickness,
            y: Scale::around(results.iter().filter_map(quantity).chain([0.0]), 6),
        };
        axes.draw(&mut drawing, (index == 2).then_some("t / R"), label);
        for ((group, name), stroke) in groups.iter().zip(&names).zip(CURVES) {
            let points = group.iter().filter_map(|result| {
                quantity(result).map(|value| axes.place(result.thickness_ratio, value))
            });
            drawing.curve(&format!("{label} {name}"), points, stroke);
        }
        top += 270.0;
    }
    drawing.finish()
}
