//! A record of ground motion: its acceleration and the quantities derived from it.

use super::envelope::Envelope;
use super::panels::{Curve, Panels, around, draw_curves};
use super::svg::{Figure, Frame, Scale, Sign, Stroke, color};
use crate::dynamics::ground::intensity::Intensity;

/// Draws acceleration, velocity, displacement and the build-up of the Arias intensity. The significant duration is
/// shaded. Samples are times in s and accelerations in m/s2.
#[must_use]
pub fn draw(
    figure: Figure,
    title: &str,
    samples: &[(f64, f64)],
    intensity: &Intensity,
    gravity_m_s2: f64,
) -> String {
    let span = [samples.first(), samples.last()].map(|end| end.map_or(0.0, |end| end.0));
    let mut panels = Panels::new(figure, title, span);
    let course = |index: usize| intensity.course.iter().map(move |course| course[index]);
    let curves: [(&str, &str, Box<dyn Iterator<Item = f64>>); 4] = [
        (
            "acceleration",
            "Acceleration (g)",
            Box::new(samples.iter().map(|sample| sample.1 / gravity_m_s2)),
        ),
        ("velocity", "Velocity (m/s)", Box::new(course(0))),
        ("displacement", "Displacement (m)", Box::new(course(1))),
        ("arias", "Arias, part", Box::new(course(2))),
    ];
    for (name, label, values) in curves {
        let mut envelope = Envelope::new();
        for (sample, value) in samples.iter().zip(values) {
            envelope.push(sample.0, value);
        }
        let curve = Curve::new(name, envelope.points(), CURVE);
        let values = curve.points.iter().map(|point| point.1);
        let y = if name == "arias" {
            Scale::around(values.chain([0.0]), 4)
        } else {
            around(values, 4)
        };
        panels.panel(label, 145.0, y, None, |drawing, axes| {
            let [from, to] = intensity
                .significant_s
                .map(|time_s| axes.place(time_s, axes.y.low).x);
            let shaded = Frame {
                left: from,
                width: to - from,
                ..axes.frame
            };
            drawing.band("significant", &shaded, color::SKY, SHADE);
            draw_curves(drawing, axes, &[curve]);
        });
    }
    let words = "from 5 % to 95 % of the Arias intensity";
    panels.finish(&[(words, Sign::Band(color::SKY, SHADE))], false)
}

const CURVE: Stroke = Stroke::new(color::BLACK, 1.0, "");
/// Opacity of the significant duration.
const SHADE: f64 = 0.18;
