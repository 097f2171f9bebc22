//! `history.svg`: curves of a history over a shared time axis.

use super::open_joints::OpenJoints;
use super::points::ObservedPoints;
use crate::dynamics::HalfCycle;
use crate::output::panels::{MAIN, overturning, overturns};
use crate::output::{
    COLUMNS, CURVES, Envelope, Figure, HistoryPanels, Key, Mark, Panel, Scale, Shape, Sign,
    StateHistory, Stroke, Subject, color, scale_around,
};
use crate::{Event, Model, Outcome, Sample, State, Summary, Sway};

/// Upper limit of the drawn excess of the thrust line, in thicknesses. The values of a falling structure would hide all others.
pub(super) const LARGEST_EXCESS: f64 = 1.0;

/// A half cycle that reaches a quarter of the unstable rotation.
#[derive(Clone, Copy, Debug)]
struct LargeCycle {
    phase: usize,
    /// The body whose rotation is the coordinate of the mechanism.
    body: usize,
    from_s: f64,
    to_s: f64,
    /// Rotation of the body at the unstable equilibrium, with its sign.
    unstable_rad: f64,
}

/// Fraction of the unstable rotation, or of the barrier, from which the limit is drawn.
const LARGE_RATIO: f64 = 0.25;

/// Stroke for the unstable rotation of a body, in the colour of its curve.
const fn unstable_stroke(body: usize) -> Stroke {
    Stroke::new(CURVES[body % CURVES.len()].color, 1.0, "1 3")
}

/// Number of columns of all curves of rotations together. It limits the size of pictures of long rows.
const COLUMNS_OF_ALL: usize = 16_000;
/// Smallest number of columns of a curve.
const LEAST_COLUMNS: usize = 200;

/// Collects and thins the samples of a history, and draws them.
#[derive(Clone, Debug, Default)]
pub(super) struct Timeline {
    bodies: Vec<String>,
    rotations_rad: Vec<Envelope>,
    excess_ratio: Envelope,
    energy: Envelope,
    /// True if energies are relative to a barrier, false if they are in J.
    in_barriers: bool,
    /// Displacement of the right foot relative to the left one, to the right and upwards, in millimetres.
    feet_mm: [Envelope; 2],
    slips_mm: Vec<Envelope>,
    /// The joints of a row of blocks.
    joints: Option<OpenJoints>,
    /// The last phase.
    phase: usize,
    phase_from_s: f64,
    /// Half cycles that reach a quarter of the unstable rotation.
    large_cycles: Vec<LargeCycle>,
    /// The states of mechanisms over time, and their impacts.
    states: StateHistory,
    impacts_s: Vec<f64>,
    end_s: f64,
}

/// Makes empty envelopes for a number of curves.
fn envelopes(count: usize) -> Vec<Envelope> {
    let columns = (COLUMNS_OF_ALL / count.max(1)).clamp(LEAST_COLUMNS, COLUMNS);
    vec![Envelope::of_columns(columns); count]
}

/// Adds a value to each envelope.
fn push(envelopes: &mut [Envelope], time_s: f64, values: impl IntoIterator<Item = f64>) {
    for (envelope, value) in envelopes.iter_mut().zip(values) {
        envelope.push(time_s, value);
    }
}

impl Timeline {
    /// Makes an empty timeline for a model of motion.
    pub(super) fn new(model: &dyn Model) -> Self {
        let bodies = model.bodies();
        let slipping = model.row().filter(|_| model.slips());
        Self {
            rotations_rad: envelopes(bodies.len()),
            bodies,
            slips_mm: envelopes(slipping.map_or(0, |row| row.joints.len())),
            joints: model.row().map(OpenJoints::new),
            ..Self::default()
        }
    }

    /// Adds a sample. Samples come in the order of time.
    pub(super) fn sample(&mut self, sample: &Sample) {
        let time_s = sample.time_s;
        if sample.phase == 0 {
            self.states.start = sample.state;
        }
        self.end_s = time_s;
        let in_mm = |metres: &f64| 1e3 * metres;
        let rotations_rad = sample.rotations_rad.iter().copied();
        push(&mut self.rotations_rad, time_s, rotations_rad);
        let slips_mm = sample.offsets_m.iter().map(in_mm);
        push(&mut self.slips_mm, time_s, slips_mm);
        let apart_mm = sample.feet_apart_m.iter().map(in_mm);
        push(&mut self.feet_mm, time_s, apart_mm);
        let excess_ratio = sample.demand.excess_ratio.min(LARGEST_EXCESS);
        self.excess_ratio.push(time_s, excess_ratio);
        self.in_barriers = sample.energy_ratio.is_some();
        let energy = sample.energy_ratio.unwrap_or(sample.energy_j);
        self.energy.push(time_s, energy);
        self.note_large_cycle(sample);
        if let Some(joints) = &mut self.joints {
            joints.push(sample);
        }
    }

    /// Adds an event. Events come in the order of time.
    pub(super) fn event(&mut self, event: &Event) {
        // Rows have thousands of events; half cycles from the summary replace them.
        if self.joints.is_none() {
            self.states.changes.push((event.time_s, event.state));
            let time_s = event.impact.as_ref().map(|_| event.time_s);
            self.impacts_s.extend(time_s);
        }
    }

    /// Adds the half cycle of a sample that reaches a quarter of the unstable rotation.
    fn note_large_cycle(&mut self, sample: &Sample) {
        if sample.phase != self.phase {
            (self.phase, self.phase_from_s) = (sample.phase, sample.time_s);
        }
        let (State::Rocking(sway), Some(ratio)) = (sample.state, sample.rotation_over_critical)
        else {
            return;
        };
        // The coordinate is the rotation of the body at the left end if the structure sways right, and at the right end if it sways left.
        let body = match sway {
            Sway::Right => 0,
            Sway::Left => sample.rotations_rad.len() - 1,
        };
        let last = self.large_cycles.last_mut();
        match last.filter(|cycle| cycle.phase == sample.phase) {
            Some(cycle) => cycle.to_s = sample.time_s,
            None if ratio.abs() >= LARGE_RATIO => self.large_cycles.push(LargeCycle {
                phase: sample.phase,
                body,
                from_s: self.phase_from_s,
                to_s: sample.time_s,
                unstable_rad: sample.rotations_rad[body] / ratio.abs(),
            }),
            None => {}
        }
    }

    /// Draws the picture of the history.
    pub(super) fn draw(
        &self,
        figure: Figure,
        chosen: &[Panel],
        subject: &Subject<'_>,
        history: &Summary,
        points: &ObservedPoints,
    ) -> String {
        let span_s = [subject.ground.start_s(), self.end_s];
        let states = match history.row() {
            Some(row) => &row_states(history, &row.half_cycles),
            None => &self.states,
        };
        let mut panels = HistoryPanels::new(figure, subject, self.end_s, Some(states));
        let shows = |panel: Panel| panel.is_drawn(chosen, figure, points.has_points());
        let [ground_px, rotation_px, energy_px] = match self.joints {
            Some(_) => [110.0, 240.0, 120.0],
            None => [130.0, 260.0, 125.0],
        };
        if shows(Panel::Ground) {
            panels.ground(ground_px);
            self.add_feet(&mut panels);
        }
        if shows(Panel::Rotation) {
            let (mut marks, y) = match self.joints {
                Some(_) => self.rotations_of_row(&mut panels, history.largest_body()),
                None => self.rotations(&mut panels),
            };
            let overturned_s = history.overturned_s();
            marks.extend(overturned_s.map(|time_s| overturning(time_s, y)));
            panels.panel("Rotation (rad)", rotation_px, y, marks);
        }
        if shows(Panel::Joints)
            && let Some(joints) = &self.joints
        {
            joints.add_to(&mut panels.panels, figure, self.end_s);
        }
        if shows(Panel::Slip) {
            let slips = self.slips_mm.iter().enumerate();
            let slips = slips
                .map(|(joint, slip)| Mark::curve(format!("slip {joint}"), BLOCK, slip.points()));
            let slips = slips.filter(|slip| !slip.is_flat()).collect();
            panels.curves("Slip (mm)", 120.0, slips);
        }
        if shows(Panel::Points) {
            points.draw(&mut panels);
        }
        let energy = Mark::curve("energy", MAIN, self.energy.points());
        // The energy of a structure that never moved is a rounding error.
        let moves = history.outcome != Outcome::NeverMoved;
        if shows(Panel::Energy) && moves && !energy.is_flat() {
            let label = match self.in_barriers {
                true => "Total energy / barrier",
                false => "Energy (J)",
            };
            let mut curves = vec![energy];
            // A barrier far above the curve would flatten the curve.
            let over_barrier = history.peak_potential_over_barrier();
            if over_barrier.is_some_and(|peak| peak >= LARGE_RATIO) {
                let ends = span_s.map(|time_s| (time_s, 1.0));
                curves.push(Mark::curve("barrier", BARRIER, ends));
                let label = "the first mechanism overturns on quiet ground";
                panels.panels.keys.push(Key::line(label, BARRIER));
            }
            panels.curves(label, energy_px, curves);
        }
        if shows(Panel::Thrust) && self.joints.is_none() {
            let excess = Mark::curve("excess", MAIN, self.excess_ratio.points());
            panels.curves("Thrust line outside / t", energy_px, vec![excess]);
        }
        if shows(Panel::Rotation) && history.overturned_s().is_some() {
            panels.panels.keys.push(overturns());
        }
        panels.finish(moves)
    }

    /// Adds the panel of the right foot, if it moves.
    fn add_feet(&self, panels: &mut HistoryPanels<'_>) {
        let names = ["right foot to the right", "right foot upwards"];
        let feet: Vec<Mark> = names
            .into_iter()
            .zip(&self.feet_mm)
            .zip([MAIN, UPWARDS])
            .map(|((name, foot), stroke)| Mark::curve(name, stroke, foot.points()))
            .filter(|foot| !foot.is_flat())
            .collect();
        if feet.len() > 1 {
            panels.panels.keys.extend(feet.iter().map(Mark::key));
        }
        panels.curves("Right foot (mm)", 110.0, feet);
    }

    /// Returns the curves of the rotations of a mechanism, with impacts and unstable equilibria, and their scale.
    fn rotations(&self, panels: &mut HistoryPanels<'_>) -> (Vec<Mark>, Scale) {
        let mut marks = Vec::new();
        let bodies = self.bodies.iter().zip(&self.rotations_rad);
        for ((body, envelope), stroke) in bodies.zip(CURVES) {
            let name = if body.is_empty() { "rotation" } else { body };
            marks.push(Mark::curve(name, stroke, envelope.points()));
            if !body.is_empty() {
                panels.panels.keys.push(Key::line(body, stroke));
            }
        }
        marks.extend(self.large_cycles.iter().map(|cycle| {
            let ends = [cycle.from_s, cycle.to_s].map(|time_s| (time_s, cycle.unstable_rad));
            Mark::curve("unstable", unstable_stroke(cycle.body), ends)
        }));
        let y = scale_around(&marks, [], 6);
        let ticks = Shape::Ticks(self.impacts_s.clone());
        marks.push(Mark::new("impact", IMPACT, ticks));
        if !self.impacts_s.is_empty() {
            panels
                .panels
                .keys
                .push(Key::new("impacts", Sign::Tick(IMPACT)));
        }
        if let Some(cycle) = self.large_cycles.first() {
            let label = match self.bodies.len() {
                1 => "unstable rotation",
                _ => "unstable rotation of the body of that colour alone: others may go beyond it",
            };
            panels
                .panels
                .keys
                .push(Key::line(label, unstable_stroke(cycle.body)));
        }
        (marks, y)
    }

    /// Returns the curves of the rotations of blocks and their scale. The block with the largest rotation is drawn last, on top.
    fn rotations_of_row(
        &self,
        panels: &mut HistoryPanels<'_>,
        largest: usize,
    ) -> (Vec<Mark>, Scale) {
        let others = (0..self.rotations_rad.len()).filter(|block| *block != largest);
        let strokes = others.map(|block| (block, BLOCK));
        let curves = strokes.chain([(largest, LARGEST)]).map(|(block, stroke)| {
            let points = self.rotations_rad[block].points();
            Mark::curve((block + 1).to_string(), stroke, points)
        });
        let marks: Vec<Mark> = curves.collect();
        if marks.len() > 1 {
            let name = format!("block {}, which turns most", largest + 1);
            let keys = [Key::line(name, LARGEST), Key::line("others", BLOCK)];
            panels.panels.keys.extend(keys);
        }
        let y = scale_around(&marks, [], 6);
        (marks, y)
    }
}

/// States of a row: its half cycles, and the end.
fn row_states(history: &Summary, half_cycles: &[HalfCycle]) -> StateHistory {
    let end = match history.outcome {
        Outcome::Rest => Some(State::Rest),
        Outcome::Overturned(sway) => Some(State::Overturned(sway)),
        _ => None,
    };
    let cycles = half_cycles.iter();
    let changes = cycles.map(|cycle| (cycle.start_s, State::Rocking(cycle.sway)));
    let end = end.map(|state| (history.outcome_time_s, state));
    StateHistory {
        start: State::Rest,
        changes: changes.chain(end).collect(),
    }
}

const IMPACT: Stroke = Stroke::new(color::VERMILION, 1.0, "");
const UPWARDS: Stroke = Stroke::new(color::GREEN, 1.6, "7 3");
const BARRIER: Stroke = Stroke::new(color::VERMILION, 1.0, "1 3");
const LARGEST: Stroke = Stroke::new(color::BLUE, 1.8, "");
const BLOCK: Stroke = Stroke::new(color::BLACK, 0.5, "");
