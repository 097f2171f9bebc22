//! The picture of thresholds along a range.

use super::report::Point;
use crate::output::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign};

/// A quantity of a point, in g.
type Quantity = fn(&Point) -> Option<f64>;

const CURVES_OF: [(&str, Quantity); 2] = [
    ("overturns", |point| point.overturns_from_g),
    ("overturns without impact", |point| point.no_impact_g),
];

/// Draws the peak ground acceleration that overturns the structure over the values of a key, each value a point of a curve.
pub(super) fn draw(figure: Figure, title: &str, key: &str, points: &[Point]) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(title);
    let shown = CURVES_OF
        .into_iter()
        .zip(CURVES)
        .filter(|((_, of), _)| points.iter().any(|point| of(point).is_some()));
    let shown: Vec<_> = shown.collect();
    let keys: Vec<Key<'_>> = shown
        .iter()
        .map(|((name, _), stroke)| (*name, Sign::Line(*stroke)))
        .collect();
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let heights = shown
        .iter()
        .flat_map(|((_, of), _)| points.iter().filter_map(of));
    let axes = Axes {
        frame: figure.plot(top, figure.height_px(405.0)),
        x: Scale::around(points.iter().map(|point| point.value), figure.ticks(8)),
        y: Scale::around(heights.chain([0.0]), 6),
    };
    axes.draw(&mut drawing, Some(key), "peak ground acceleration (g)");
    for ((name, of), stroke) in shown {
        // The curve is interrupted where there is no value.
        for run in points.chunk_by(|a, b| of(a).is_some() == of(b).is_some()) {
            let places = run
                .iter()
                .filter_map(|point| Some(axes.place(point.value, of(point)?)));
            drawing.curve(name, places.clone(), stroke);
            for place in places {
                drawing.circle(name, place, 2.5, stroke);
            }
        }
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}
