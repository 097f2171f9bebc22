//! A record of ground motion: its acceleration and the quantities derived from it.

use super::{Envelope, Figure, Key, Mark, Panels, Scale, Shape, Sign, Stroke, color, scale_around};
use crate::dynamics::Intensity;

/// Draws acceleration, velocity, displacement and the build-up of the Arias intensity, with the significant duration shaded. `samples` are times
/// in s and accelerations in m/s2.
pub fn draw(
    figure: Figure,
    title: &str,
    samples: &[(f64, f64)],
    intensity: &Intensity,
    gravity_m_s2: f64,
) -> String {
    let span = [samples.first(), samples.last()].map(|end| end.map_or(0.0, |end| end.0));
    let mut panels = Panels::new(figure, title, span);
    let courses = [
        ("acceleration", "Acceleration (g)"),
        ("velocity", "Velocity (m/s)"),
        ("displacement", "Displacement (m)"),
        ("arias", "Arias, part"),
    ];
    for (index, (name, label)) in courses.into_iter().enumerate() {
        let mut envelope = Envelope::default();
        for ((time_s, acceleration_m_s2), course) in samples.iter().zip(&intensity.course) {
            let value = match index {
                0 => acceleration_m_s2 / gravity_m_s2,
                _ => course[index - 1],
            };
            envelope.push(*time_s, value);
        }
        let curve = Mark::curve(name, CURVE, envelope.points());
        let y = match name {
            "arias" => Scale::around([0.0, 1.0], 4),
            _ => scale_around(std::slice::from_ref(&curve), [], 4),
        };
        let range = Shape::Range(intensity.significant_s, SHADE.1);
        let shade = Mark::new("significant", Stroke::new(SHADE.0, 0.0, ""), range);
        panels.panel(label, 145.0, y, Vec::new(), vec![shade, curve]);
    }
    let words = "from 5 % to 95 % of the Arias intensity";
    panels.keys = vec![Key::new(words, Sign::Band(SHADE.0, SHADE.1))];
    panels.finish()
}

const CURVE: Stroke = Stroke::new(color::BLACK, 1.0, "");
/// Colour and opacity of the significant duration.
const SHADE: (&str, f64) = (color::SKY, 0.18);
