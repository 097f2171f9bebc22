//! `history.svg`: a history at a glance, over a shared time axis.

use super::points::Points;
use crate::dynamics::history::{Event, Outcome, Sample, State, Summary};
use crate::mechanics::sway::Sway;
use crate::output::Figure;
use crate::output::chart::{Mark, Shape};
use crate::output::envelope::Envelope;
use crate::output::figure::Panel;
use crate::output::panels::{MAIN, Panels, States, Subject, around, overturning, overturns};
use crate::output::sheet::{Key, Sign};
use crate::output::svg::{CURVES, Stroke, color};

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
    states: States,
    impacts_s: Vec<f64>,
    end_s: f64,
}

impl Timeline {
    /// An empty timeline for bodies of these names.
    pub(super) fn new(bodies: &[String]) -> Self {
        Self {
            bodies: bodies.to_vec(),
            rotations_rad: vec![Envelope::default(); bodies.len()],
            excess_ratio: Envelope::default(),
            energy_ratio: Envelope::default(),
            phase: 0,
            phase_from_s: 0.0,
            far: Vec::new(),
            states: States {
                start: State::Rest,
                changes: Vec::new(),
            },
            impacts_s: Vec::new(),
            end_s: 0.0,
        }
    }

    /// Notes the unstable equilibrium of a half cycle that comes near it.
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
            self.states.start = sample.state;
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
        self.states.changes.push((event.time_s, event.state));
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
        let states = Some(&self.states);
        let shows = |panel| figure.shows(panel, points.any());
        if shows(Panel::Ground) {
            panels.ground(130.0, subject, states);
        }
        if shows(Panel::Rotation) {
            self.add_rotations(&mut panels, summary.overturned_s());
        }
        if shows(Panel::Points) {
            points.draw(&mut panels, states);
        }
        let energy = &self.energy_ratio;
        let excess = &self.excess_ratio;
        for (panel, label, name, envelope) in [
            (Panel::Energy, "Total energy / barrier", "energy", energy),
            (Panel::Thrust, "Thrust line outside / t", "excess", excess),
        ] {
            if shows(panel) {
                let curve = Mark::curve(name, MAIN, envelope.points());
                panels.curves(label, 125.0, vec![curve], states);
            }
        }
        panels.finish(summary.outcome != Outcome::NeverMoved)
    }
}

impl Timeline {
    /// Adds the panel of the rotations, with impacts, unstable equilibria and the instant of overturning.
    fn add_rotations(&self, panels: &mut Panels, overturned_s: Option<f64>) {
        let mut marks = Vec::new();
        let bodies = self.bodies.iter().zip(&self.rotations_rad);
        for ((body, envelope), stroke) in bodies.zip(CURVES) {
            let name = if body.is_empty() { "rotation" } else { body };
            marks.push(Mark::curve(name, stroke, envelope.points()));
            if !body.is_empty() {
                panels.keys.push(Key::line(body, stroke));
            }
        }
        marks.extend(self.far.iter().map(|cycle| {
            let ends = [cycle.from_s, cycle.to_s].map(|time_s| (time_s, cycle.unstable_rad));
            Mark::curve("unstable", unstable(cycle.body), ends)
        }));
        let y = around(&marks, [], 6);
        marks.push(Mark::new(
            "impact",
            IMPACT,
            Shape::Ticks(self.impacts_s.clone()),
        ));
        if !self.impacts_s.is_empty() {
            panels.keys.push(Key::new("impacts", Sign::Tick(IMPACT)));
        }
        if let Some(cycle) = self.far.first() {
            let words = match self.bodies.len() {
                1 => "unstable rotation",
                _ => "unstable rotation of the body of that colour alone: others may go beyond it",
            };
            panels.keys.push(Key::line(words, unstable(cycle.body)));
        }
        if let Some(time_s) = overturned_s {
            marks.push(overturning(time_s, y));
            panels.keys.push(overturns());
        }
        panels.panel("Rotation (rad)", 260.0, y, Some(&self.states), marks);
    }
}

const IMPACT: Stroke = Stroke::new(color::VERMILION, 1.0, "");
