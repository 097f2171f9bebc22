//! `overlay.svg`: histories of several models of motion of one structure in one picture.

use nalgebra::Vector2;

use super::svg::{Axes, CURVES, Drawing, Frame, Scale, Stroke, color};
use super::timeline::{COLUMNS, Envelope};
use crate::dynamics::history::Sample;
use crate::mechanics::sway::Sway;

/// What any model tells of a history, thinned.
#[derive(Clone, Debug)]
pub struct Curves {
    gravity_m_s2: f64,
    ground_g: Envelope,
    rotation_rad: Envelope,
    energy_j: Envelope,
    end_s: f64,
}

impl Curves {
    /// Of a history under this gravity, without samples yet.
    #[must_use]
    pub const fn new(gravity_m_s2: f64) -> Self {
        Self {
            gravity_m_s2,
            ground_g: Envelope::of_columns(COLUMNS),
            rotation_rad: Envelope::of_columns(COLUMNS),
            energy_j: Envelope::of_columns(COLUMNS),
            end_s: 0.0,
        }
    }

    /// Takes a sample. Samples come in the order of time.
    pub fn push(&mut self, sample: &Sample) {
        let time_s = sample.time_s;
        self.end_s = time_s;
        let ground_g = sample.ground_acceleration_m_s2 / self.gravity_m_s2;
        self.ground_g.push(time_s, ground_g);
        let largest_rad = sample
            .rotations_rad
            .iter()
            .fold(0.0_f64, |most, rotation| most.max(rotation.abs()));
        let rotation_rad = match sample.state.sway() {
            Some(Sway::Left) => -largest_rad,
            Some(Sway::Right) | None => largest_rad,
        };
        self.rotation_rad.push(time_s, rotation_rad);
        self.energy_j.push(time_s, sample.energy_j);
    }
}

/// A curve with its name.
type Curve<'a> = (&'a str, &'a Envelope, Stroke);

/// The picture of histories with their names: the ground, the largest rotation of a body, upwards while the structure
/// sways right and downwards while it sways left, and the energy.
#[must_use]
pub fn draw(title: &str, histories: &[(&str, &Curves)]) -> String {
    let mut drawing = Drawing::new(900.0, 720.0);
    drawing.title(title);
    let ends_s = histories.iter().map(|(_, curves)| curves.end_s);
    let end_s = ends_s.fold(f64::MIN_POSITIVE, f64::max);
    let time = Scale::exactly(0.0, end_s, 10);
    let black = Stroke::new(color::BLACK, 1.4, "");
    // The ground is the same for all, and the longest shows the most of it.
    let longest = histories
        .iter()
        .max_by(|a, b| a.1.end_s.total_cmp(&b.1.end_s));
    let ground = longest.map(|(_, curves)| ("ground", &curves.ground_g, black));
    let each = |quantity: fn(&Curves) -> &Envelope| {
        let named = histories.iter().zip(CURVES);
        named
            .map(|((name, curves), stroke)| (*name, quantity(curves), stroke))
            .collect()
    };
    let panels: [(&str, f64, Vec<Curve<'_>>); 3] = [
        ("Ground (g)", 110.0, ground.into_iter().collect()),
        (
            "Largest rotation (rad)",
            280.0,
            each(|curves| &curves.rotation_rad),
        ),
        ("Energy (J)", 120.0, each(|curves| &curves.energy_j)),
    ];
    let mut top = 70.0;
    let last = panels.len() - 1;
    for (index, (label, height, curves)) in panels.into_iter().enumerate() {
        // A little room, so that no curve runs along the frame.
        let values = curves
            .iter()
            .flat_map(|(_, envelope, _)| envelope.values().map(|value| 1.03 * value));
        let axes = Axes {
            frame: Frame {
                left: 85.0,
                top,
                width: 790.0,
                height,
            },
            x: time,
            y: Scale::around(values.chain([0.0]), if height > 200.0 { 6 } else { 3 }),
        };
        axes.draw(&mut drawing, (index == last).then_some("Time (s)"), label);
        for (name, envelope, stroke) in curves {
            let points = envelope.points().map(|(t, value)| axes.place(t, value));
            drawing.curve(name, points, stroke);
        }
        top += height + 22.0;
    }
    let names = histories.iter().map(|(name, _)| *name).zip(CURVES);
    drawing.legend(Vector2::new(85.0, top + 44.0), 180.0, names);
    drawing.finish()
}
