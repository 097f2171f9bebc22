//! Reports a chart of shapes: a table, and a picture of incipient acceleration and restitution against the thickness ratio.

use super::{Chart, ShapeResult};
use crate::output::OutputError;
use crate::output::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign, Stroke, color};
use crate::output::table::{column, csv};
use crate::studies::results::Results;

/// Names of the files, the seal last.
pub const FILES: [&str; 2] = ["chart.svg", "chart.csv"];

impl Chart {
    /// The files and words of the chart.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn tell(&self, figure: Figure) -> Result<Results, OutputError> {
        let picture = figure.fitted(|figure| draw(figure, &self.shapes, self.own.as_ref()));
        let contents = [picture.into_bytes(), table(&self.shapes)?];
        Ok(Results {
            files: FILES.into_iter().zip(contents).collect(),
            words: format!("{} arches", self.shapes.len()),
            ..Results::default()
        })
    }
}

/// One row per shape. The restitution coefficient is empty if an impact stops the arch.
fn table(results: &[ShapeResult]) -> Result<Vec<u8>, OutputError> {
    let columns = [
        column("embrace_deg", |shape: &ShapeResult| shape.embrace_deg),
        column("thickness_ratio", |shape: &ShapeResult| {
            shape.thickness_ratio
        }),
        column("incipient_acceleration_g", |shape: &ShapeResult| {
            shape.incipient_g
        }),
        column("first_restitution", |shape: &ShapeResult| {
            shape.first_restitution
        }),
        column("last_restitution", |shape: &ShapeResult| {
            shape.last_restitution
        }),
    ];
    csv(columns, results)
}

/// A quantity of a shape, if it has it.
type Quantity = fn(&ShapeResult) -> Option<f64>;

/// Draws three panels with a curve for each embrace angle, and marks the results of the scenario's own arch. The results
/// must come one embrace angle after another, with ascending thicknesses.
fn draw(figure: Figure, results: &[ShapeResult], own: Option<&ShapeResult>) -> String {
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
