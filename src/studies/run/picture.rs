//! `history.svg`: a history at a glance, over a shared time axis.

use super::points::Points;
use crate::dynamics::history::{Event, Outcome, Sample, State, Summary};
use crate::mechanics::sway::Sway;
use crate::output::envelope::Envelope;
use crate::output::figure::Panel;
use crate::output::panels::{
    Curve, IMPACT, MAIN, OVERTURNS, Panels, States, Subject, around, draw_curves, mark_impacts,
    mark_overturning,
};
use crate::output::svg::{CURVES, Figure, Key, Sign, Stroke};

/// Collects samples and events of a history, and draws them.
pub(super) trait Picture {
    /// Takes a sample. Samples come in the order of time.
    fn sample(&mut self, sample: &Sample);

    /// Takes an event. Events come in the order of time.
    fn event(&mut self, _event: &Event) {}

    /// Draws the picture, with the summary of the history.
    fn draw(
        &self,
        figure: Figure,
        subject: &Subject<'_>,
        summary: &Summary,
        points: &Points,
    ) -> String;
}

/// The excess of the thrust line is cut off at this value, in thicknesses: a falling structure has
/// values that would hide all others.
pub(super) const LARGEST_EXCESS: f64 = 1.0;

/// A half cycle that comes near the unstable equilibrium or passes it.
#[derive(Clone, Copy, Debug)]
struct FarCycle {
    phase: usize,
    /// The body whose rotation is the coordinate.
    body: usize,
    from_s: f64,
    to_s: f64,
    /// Its rotation at the unstable equilibrium, with its sign.
    unstable_rad: f64,
}

/// The limit is drawn if a motion reaches this fraction of the unstable rotation or of the barrier.
pub(super) const FAR: f64 = 0.25;

/// The stroke for the unstable rotation of a body, in the colour of its curve.
const fn unstable(body: usize) -> Stroke {
    Stroke::new(CURVES[body % CURVES.len()].color, 1.0, "1 3")
}

/// Collects the samples of a history, thinned, and draws them.
#[derive(Clone, Debug)]
pub(super) struct Timeline {
    bodies: Vec<String>,
    rotations_rad: Vec<Envelope>,
    excess_ratio: Envelope,
    energy_ratio: Envelope,
    /// The last phase, and when it began.
    phase: usize,
    phase_from_s: f64,
    /// Half cycles that went far.
    far: Vec<FarCycle>,
    /// The states of the structure over time.
    doing: States,
    impacts_s: Vec<f64>,
    end_s: f64,
}

impl Timeline {
    /// An empty timeline for bodies of these names.
    pub(super) fn new(bodies: &[String]) -> Self {
        Self {
            bodies: bodies.to_vec(),
            rotations_rad: vec![Envelope::new(); bodies.len()],
            excess_ratio: Envelope::new(),
            energy_ratio: Envelope::new(),
            phase: 0,
            phase_from_s: 0.0,
            far: Vec::new(),
            doing: States {
                start: State::Rest,
                changes: Vec::new(),
            },
            impacts_s: Vec::new(),
            end_s: 0.0,
        }
    }

    /// Notes how far a half cycle goes, if it goes far.
    fn note_if_far(&mut self, sample: &Sample) {
        if sample.phase != self.phase {
            (self.phase, self.phase_from_s) = (sample.phase, sample.time_s);
        }
        let (State::Rocking(sway), Some(ratio)) = (sample.state, sample.rotation_over_critical)
        else {
            return;
        };
        // The coordinate is the rotation of the body at the end from which the structure leans away.
        let body = match sway {
            Sway::Right => 0,
            Sway::Left => sample.rotations_rad.len() - 1,
        };
        let last = self.far.last_mut();
        match last.filter(|cycle| cycle.phase == sample.phase) {
            Some(cycle) => cycle.to_s = sample.time_s,
            None if ratio.abs() >= FAR => self.far.push(FarCycle {
                phase: sample.phase,
                body,
                from_s: self.phase_from_s,
                to_s: sample.time_s,
                unstable_rad: sample.rotations_rad[body] / ratio.abs(),
            }),
            None => {}
        }
    }
}

impl Picture for Timeline {
    fn sample(&mut self, sample: &Sample) {
        let time_s = sample.time_s;
        if sample.phase == 0 {
            self.doing.start = sample.state;
        }
        self.end_s = time_s;
        let envelopes = self.rotations_rad.iter_mut();
        for (envelope, rotation) in envelopes.zip(&sample.rotations_rad) {
            envelope.push(time_s, *rotation);
        }
        let excess_ratio = sample.demand.excess_ratio.min(LARGEST_EXCESS);
        self.excess_ratio.push(time_s, excess_ratio);
        self.note_if_far(sample);
        self.energy_ratio
            .push(time_s, sample.energy_ratio.unwrap_or(0.0));
    }

    fn event(&mut self, event: &Event) {
        self.doing.changes.push((event.time_s, event.state));
        if event.impact.is_some() {
            self.impacts_s.push(event.time_s);
        }
    }

    fn draw(
        &self,
        figure: Figure,
        subject: &Subject<'_>,
        summary: &Summary,
        points: &Points,
    ) -> String {
        let span_s = [subject.ground.start_s(), self.end_s];
        let mut panels = Panels::new(figure, subject.title, span_s);
        let doing = Some(&self.doing);
        let watched = points.any();
        let shows = |panel| figure.shows(panel, watched);
        if shows(Panel::Ground) {
            panels.ground(130.0, subject, doing);
        }

        let bodies = self.bodies.iter().zip(CURVES);
        let rotations: Vec<Curve> = bodies
            .clone()
            .zip(&self.rotations_rad)
            .map(|((body, stroke), envelope)| {
                let name = if body.is_empty() { "rotation" } else { body };
                Curve::new(name, envelope.points(), stroke)
            })
            .collect();
        let values = rotations.iter().flat_map(|curve| &curve.points);
        let unstable_rad = self.far.iter().map(|cycle| cycle.unstable_rad);
        let y = around(values.map(|point| point.1).chain(unstable_rad), 6);
        let overturned_s = summary.overturned_s();
        let turns = shows(Panel::Rotation);
        if turns {
            panels.panel("Rotation (rad)", 260.0, y, doing, |drawing, axes| {
                draw_curves(drawing, axes, &rotations);
                for cycle in &self.far {
                    let ends =
                        [cycle.from_s, cycle.to_s].map(|t| axes.place(t, cycle.unstable_rad));
                    drawing.curve("unstable", ends, unstable(cycle.body));
                }
                mark_impacts(drawing, axes, self.impacts_s.iter().copied());
                if let Some(time_s) = overturned_s {
                    mark_overturning(drawing, axes, time_s);
                }
            });
        }

        let (names, mut of_points) = (points.names(), Vec::new());
        if shows(Panel::Points) {
            points.draw(&mut panels, doing, &names, &mut of_points);
        }
        let more = [
            (
                Panel::Energy,
                "Total energy / barrier",
                "energy",
                &self.energy_ratio,
            ),
            (
                Panel::Thrust,
                "Thrust line outside / t",
                "excess",
                &self.excess_ratio,
            ),
        ];
        for (_, label, name, envelope) in more.into_iter().filter(|more| shows(more.0)) {
            let curve = Curve::new(name, envelope.points(), MAIN);
            // An empty panel would only take up room.
            if !curve.is_flat() {
                panels.curves(label, 125.0, &[curve], doing);
            }
        }

        let named = bodies.filter(|(body, _)| turns && !body.is_empty());
        let mut keys: Vec<Key<'_>> = named
            .map(|(body, stroke)| (body.as_str(), Sign::Line(stroke)))
            .collect();
        if turns && !self.impacts_s.is_empty() {
            keys.push(("impacts", Sign::Tick(IMPACT)));
        }
        if let Some(cycle) = self.far.first().filter(|_| turns) {
            let words = match self.bodies.len() {
                1 => "unstable rotation",
                _ => "unstable rotation of the body of that colour alone: others may go beyond it",
            };
            keys.push((words, Sign::Line(unstable(cycle.body))));
        }
        let moved = summary.outcome != Outcome::NeverMoved;
        if turns && overturned_s.is_some() {
            keys.push(OVERTURNS);
        }
        keys.extend(of_points);
        panels.finish(&keys, moved)
    }
}
