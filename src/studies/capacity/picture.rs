//! The picture of capacity curves.

use crate::mechanics::capacity::Capacity;
use crate::mechanics::sides::Sides;
use crate::mechanics::sway::Sway;
use crate::output::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign};

/// Draws acceleration against displacement of the control point, for both sides.
pub(super) fn draw(figure: Figure, title: &str, sides: &Sides<Capacity>) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(title);
    let names = [Sway::Right, Sway::Left].map(|sway| format!("to the {}", sway.name()));
    let keys: Vec<Key<'_>> = names
        .iter()
        .zip(CURVES)
        .map(|(name, stroke)| (name.as_str(), Sign::Line(stroke)))
        .collect();
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let points = || sides.iter().flat_map(|(_, side)| &side.curve);
    let height = figure.height_px(330.0);
    let axes = Axes {
        frame: figure.plot(top, height),
        x: Scale::around(points().map(|point| point.displacement_m), figure.ticks(8)),
        y: Scale::around(points().map(|point| point.acceleration_g), 6),
    };
    let label = "displacement of the control point (m)";
    axes.draw(&mut drawing, Some(label), "a (g)");
    for (((_, side), name), stroke) in sides.iter().zip(&names).zip(CURVES) {
        let curve = side.curve.iter();
        let points = curve.map(|point| axes.place(point.displacement_m, point.acceleration_g));
        drawing.curve(name, points, stroke);
    }
    drawing.finish(top + height + 60.0)
}
