//! The picture of thresholds along a range.

use super::Point;
use crate::output::page::Spot;
use crate::output::{CURVES, Chart, Figure, Mark, Shape};

/// Function that returns a quantity of a point, in g.
type Quantity = fn(&Point) -> Option<f64>;

const CURVES_OF: [(&str, Quantity); 3] = [
    ("survives up to", |point| point.survives_up_to_g),
    ("certainly overturns from", |point| point.overturns_from_g),
    ("overturns without impact", |point| point.no_impact_g),
];

/// Draws the peak ground acceleration that overturns the structure against the values of a key. On a page each value has a mark: where the structure
/// first overturns, or where it survives the largest factor.
pub(super) fn draw(
    figure: Figure,
    (title, key): (&str, &str),
    points: &[Point],
    spots: &[Spot],
) -> String {
    let curves = CURVES_OF
        .into_iter()
        .zip(CURVES)
        .map(|((name, of), stroke)| {
            // Missing values interrupt the curve.
            let points = points
                .iter()
                .map(|point| (point.value, of(point).unwrap_or(f64::NAN)));
            Mark::curve(name, stroke, points)
        });
    let is_known = |point: &(f64, f64)| point.1.is_finite();
    let curves: Vec<Mark> = curves
        .filter(|curve| curve.points().iter().any(is_known))
        .collect();
    let circles: Vec<Mark> = curves
        .iter()
        .flat_map(|curve| {
            let known = curve.points().iter().copied().filter(is_known);
            known.map(|at| Mark::new(&curve.name, curve.stroke, Shape::Circle(at, 2.5)))
        })
        .collect();
    let labels = [key, "peak ground acceleration (g)"];
    let mut chart = Chart::around(figure, 405.0, labels, curves);
    chart.marks.extend(circles);
    let spots = points.iter().zip(spots).map(|(point, spot)| {
        let known_g = point.overturns_from_g.or(point.survives_up_to_g);
        spot.mark((point.value, known_g.unwrap_or(0.0)))
    });
    chart.marks.extend(spots);
    chart.draw(figure, title)
}
