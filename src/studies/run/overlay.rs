//! `overlay.svg`: histories of one structure by several models of motion in one picture.

use crate::output::page::{Spot, SpotKind};
use crate::output::{CURVES, Envelope, Figure, HistoryPanels, Mark, Subject, scale_around};
use crate::{Sample, Sway};

/// Curves of a history that every model of motion has, thinned.
#[derive(Clone, Debug, Default)]
pub struct Curves {
    rotation_rad: Envelope,
    /// Times and largest rotations of samples before the first sway, whose sign is not known yet.
    unsigned: Vec<(f64, f64)>,
    /// The sign of the present or last sway.
    sign: Option<f64>,
    energy_j: Envelope,
    end_s: f64,
}

impl Curves {
    /// Adds a sample. Samples come in the order of time.
    pub fn push(&mut self, sample: &Sample) {
        let time_s = sample.time_s;
        self.end_s = time_s;
        let largest_rad = sample
            .rotations_rad
            .iter()
            .fold(0.0_f64, |most, rotation| most.max(rotation.abs()));
        if let Some(sway) = sample.state.sway() {
            self.sign = Some(if sway == Sway::Right { -1.0 } else { 1.0 });
        }
        match self.sign {
            Some(sign) => {
                for (time_s, rad) in self.unsigned.drain(..) {
                    self.rotation_rad.push(time_s, sign * rad);
                }
                self.rotation_rad.push(time_s, sign * largest_rad);
            }
            // Zero needs no sign.
            None if largest_rad == 0.0 && self.unsigned.is_empty() => {
                self.rotation_rad.push(time_s, 0.0);
            }
            None => self.unsigned.push((time_s, largest_rad)),
        }
        self.energy_j.push(time_s, sample.energy_j);
    }

    /// Rotations with their signs; they are positive if the structure never sways.
    fn rotation_rad(&self) -> Envelope {
        let mut all = self.rotation_rad.clone();
        for (time_s, rad) in &self.unsigned {
            all.push(*time_s, *rad);
        }
        all
    }
}

/// Draws named histories: the ground, the largest rotation of a body, and the energy. Rotations are positive (anticlockwise) while the structure
/// sways left, and negative while it sways right; elastic joints are open a little before the state names a sway, and then have the sign of the first
/// one. On a page each history has a mark: at its largest rotation, or at its end if it overturned.
pub fn draw(
    figure: Figure,
    subject: &Subject<'_>,
    histories: &[(&str, &Curves)],
    spots: &[Spot],
) -> String {
    let ends_s = histories.iter().map(|(_, curves)| curves.end_s);
    let end_s = ends_s.fold(subject.ground.start_s(), f64::max);
    let mut panels = HistoryPanels::new(figure, subject, end_s, None);
    panels.ground(110.0);
    let each = |quantity: fn(&Curves) -> Envelope| -> Vec<Mark> {
        let named = histories.iter().zip(CURVES);
        named
            .map(|((name, curves), stroke)| Mark::curve(*name, stroke, quantity(curves).points()))
            .collect()
    };
    let mut rotations = each(Curves::rotation_rad);
    panels.panels.keys = rotations.iter().map(Mark::key).collect();
    let y = scale_around(&rotations, [], 6);
    let marks = rotations.iter().zip(spots).filter_map(|(curve, spot)| {
        let points = curve.points().iter();
        let at = match spot.kind {
            SpotKind::Overturns => points.last(),
            _ => points.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())),
        };
        Some(spot.mark(*at?))
    });
    let marks: Vec<Mark> = marks.collect();
    rotations.extend(marks);
    panels.panel(
        "Largest rotation (rad), swaying left positive",
        280.0,
        y,
        rotations,
    );
    panels.curves("Energy (J)", 120.0, each(|curves| curves.energy_j.clone()));
    panels.finish(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::State;

    /// A column that sways right turns clockwise. Its rotation is negative, as in the table and on the page.
    #[test]
    fn a_sway_to_the_right_is_negative_as_everywhere() {
        for (sway, rotation_rad) in [(Sway::Right, -0.02), (Sway::Left, 0.03)] {
            let mut curves = Curves::default();
            curves.push(&Sample {
                state: State::Rocking(sway),
                rotations_rad: vec![rotation_rad],
                ..Sample::default()
            });
            let drawn: Vec<(f64, f64)> = curves.rotation_rad.points().collect();
            assert_eq!(drawn, [(0.0, rotation_rad)]);
        }
    }

    /// Elastic joints open before the state names a sway, and stay open a little after it.
    #[test]
    fn rotations_before_the_first_sway_have_its_sign() {
        let rest = (State::Rest, 0.0);
        let right = State::Rocking(Sway::Right);
        let states = [
            (State::Rest, 1e-3),
            (State::Rest, 3e-3),
            (right, 4e-3),
            (State::Rest, 1e-3),
        ];
        let drawn = |states: &[(State, f64)]| -> Vec<f64> {
            let mut curves = Curves::default();
            for (time_s, (state, rad)) in (0..).map(f64::from).zip(states) {
                curves.push(&Sample {
                    time_s,
                    state: *state,
                    rotations_rad: vec![0.5 * rad, *rad],
                    ..Sample::default()
                });
            }
            curves.rotation_rad().points().map(|(_, rad)| rad).collect()
        };
        assert_eq!(drawn(&states), [-1e-3, -3e-3, -4e-3, -1e-3]);
        let all = [&[rest; 2][..], &states].concat();
        assert_eq!(drawn(&all)[2..], drawn(&states));
        assert_eq!(drawn(&states[..2]), [1e-3, 3e-3], "never sways");
    }
}
