//! A record of ground motion: its acceleration, and what follows from it.

use super::svg::{Axes, Drawing, Frame, Scale, Stroke, color};
use super::timeline::Envelope;
use crate::dynamics::ground::intensity::Intensity;

/// Draws acceleration, velocity, displacement and the build-up of the Arias intensity, whose significant part is
/// shaded. Samples are times in s and accelerations in m/s2.
#[must_use]
pub fn draw(
    title: &str,
    samples: &[(f64, f64)],
    intensity: &Intensity,
    gravity_m_s2: f64,
) -> String {
    let mut drawing = Drawing::new(900.0, 760.0);
    drawing.title(title);
    let [first, last] = [samples.first(), samples.last()].map(|end| end.map_or(0.0, |end| end.0));
    let time = Scale::exactly(first, last, 10);
    let course = |index: usize| intensity.course.iter().map(move |course| course[index]);
    let panels: [(&str, &str, Box<dyn Iterator<Item = f64>>); 4] = [
        (
            "acceleration",
            "Acceleration (g)",
            Box::new(samples.iter().map(|sample| sample.1 / gravity_m_s2)),
        ),
        ("velocity", "Velocity (m/s)", Box::new(course(0))),
        ("displacement", "Displacement (m)", Box::new(course(1))),
        ("arias", "Arias, part", Box::new(course(2))),
    ];
    let count = panels.len();
    let mut top = 50.0;
    for (index, (name, label, values)) in panels.into_iter().enumerate() {
        let mut envelope = Envelope::of_columns(super::timeline::COLUMNS);
        for (sample, value) in samples.iter().zip(values) {
            envelope.push(sample.0, value);
        }
        // A little room, so that no curve runs along the frame.
        let room = if name == "arias" { 1.0 } else { 1.03 };
        let values = envelope.values().map(|value| room * value);
        let axes = Axes {
            frame: Frame {
                left: 85.0,
                top,
                width: 790.0,
                height: 145.0,
            },
            x: time,
            y: Scale::around(values.chain([0.0]), 4),
        };
        let [from, to] = intensity
            .significant_s
            .map(|time_s| axes.place(time_s, axes.y.low).x);
        let shaded = Frame {
            left: from,
            width: to - from,
            ..axes.frame
        };
        drawing.band("significant", &shaded, color::SKY, 0.18);
        axes.draw(
            &mut drawing,
            (index + 1 == count)
                .then_some("Time (s); shaded: from 5 % to 95 % of the Arias intensity"),
            label,
        );
        let points = envelope.points().map(|(t, value)| axes.place(t, value));
        drawing.curve(name, points, Stroke::new(color::BLACK, 1.0, ""));
        top += 167.0;
    }
    drawing.finish()
}
