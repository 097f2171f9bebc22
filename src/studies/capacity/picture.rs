//! `capacity.svg`: acceleration against displacement of the control point, for both sides.

use crate::mechanics::{Capacity, Sides};
use crate::output::{CURVES, Chart, Figure, Mark};

pub(super) fn draw(figure: Figure, title: &str, sides: &Sides<Capacity>) -> String {
    let curves = sides.iter().zip(CURVES).map(|((sway, side), stroke)| {
        let points = side.curve.iter();
        let points = points.map(|point| (point.displacement_m, point.acceleration_g));
        Mark::curve(format!("to the {}", sway.name()), stroke, points)
    });
    let labels = ["displacement of the control point (m)", "a (g)"];
    Chart::around(figure, 330.0, labels, curves.collect()).draw(figure, title)
}
