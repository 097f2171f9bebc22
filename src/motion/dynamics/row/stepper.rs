//! Driver that moves a row by a stepper, and reports its motion.

use std::time::Duration;

use nalgebra::Vector2;

use super::clock::Marks;
use super::observer::side_of;
use crate::dynamics::history::Impact;
use crate::dynamics::recorder::Recorder;
use crate::dynamics::{
    Event, EventKind, FallEnd, MotionObserver, OpenHinge, Outcome, RowMotionError, Sample, State,
    Summary, fall,
};
use crate::mechanics::{Edge, Hinge, Pose, Sway};

/// Stepper of a row: computes its motion step by step.
pub trait Stepper<'a>: Sized {
    fn observer(&self) -> &MotionObserver<'a>;
    fn observer_mut(&mut self) -> &mut MotionObserver<'a>;
    /// Takes one step, at most up to `until`, in seconds.
    fn step(&mut self, until: f64) -> Result<(), RowMotionError>;
    /// Writes the current state into a blank sample: rates at this time, offsets, friction demand and, on request, the thrust line. Returns
    /// the kinetic energy in J.
    fn write(&mut self, sample: &mut Sample, thrust_line: bool) -> Result<f64, RowMotionError>;
    /// Rotations of the blocks, and their rates after the last step.
    fn rotations_and_rates(&self) -> impl Iterator<Item = (f64, f64)>;
    /// Poses of the blocks.
    fn poses(&self) -> impl Iterator<Item = Pose>;
    /// Gaps of a joint at intrados and extrados, in metres.
    fn gaps(&self, joint: usize) -> [f64; 2];
    /// Current or last position of contact of a joint at an edge, in metres.
    fn corner(&self, joint: usize, edge: Edge) -> Vector2<f64>;
    fn momentum(&self) -> Vector2<f64>;
    /// Joint as a hinge; `None` if it is closed.
    fn hinge(&self, joint: usize) -> Option<Hinge> {
        open_hinge(joint, self.gaps(joint))
    }
    /// Whether a row with the hinges and rotations of a sample rests.
    fn stands(&self, sample: &Sample) -> bool;
    /// Time since which the row rests, once the ground is quiet; `None` if it moves.
    fn at_rest_since_s(&self) -> Option<f64>;
    /// Last time at which the row could still return, once it has overturned; `None` before.
    fn overturned_s(&self) -> Option<f64> {
        self.observer().overturned_s()
    }
    /// Completes the summaries at the end of the motion.
    fn complete_summaries(&mut self) {}

    /// Side of the centre of gravity; in its undeformed position, the direction of its velocity.
    fn heading(&self) -> Sway {
        let sway = self.observer().sway;
        side_of(if sway == 0.0 { self.momentum().x } else { sway })
    }

    /// State of a row in motion.
    fn moving_state(&self) -> State {
        match self.overturned_s() {
            Some(_) => State::Overturned(self.heading()),
            None => State::Rocking(self.heading()),
        }
    }

    /// Reports the first opening of joints. At `time_s` all joints were still closed; energy, rotations and rates are those at that time.
    fn report_uplift(
        &mut self,
        time_s: f64,
        energy_j: f64,
        rotations_and_rates: (Vec<f64>, Vec<f64>),
    ) {
        if !self.observer().reports_events() {
            return;
        }
        let (rotations_rad, rates_rad_s) = rotations_and_rates;
        let event = Event {
            rotations_rad,
            rates_rad_s,
            energy_j,
            hinges: self.observer().opened.clone(),
            ..Event::new(time_s, EventKind::Uplift, State::Rocking(self.heading()))
        };
        self.observer_mut().report(&event);
    }

    /// Reports an impact. `moves` is true if the row moves afterwards, `stood` if it is in its initial position. Energies are the kinetic energy
    /// before the impact, the energy dissipated, and the part dissipated by friction.
    fn report_impact(
        &mut self,
        [moves, stood]: [bool; 2],
        [energy_before_j, taken_j]: [f64; 2],
        friction_j: Option<f64>,
    ) {
        let observer = self.observer();
        if !observer.reports_events() {
            return;
        }
        let opens_at_once = |joint: usize| {
            let mut opened = observer.opened.iter().copied();
            opened
                .find(|hinge| matches!(hinge, Hinge::Joint { joint: opens, .. } if *opens == joint))
        };
        let hinge = |joint: usize| opens_at_once(joint).or_else(|| self.hinge(joint));
        let hinges = (0..observer.input.row.joints.len()).filter_map(hinge);
        // In a step that also starts the motion, part of the energy arises after its beginning.
        let energy_before_j = energy_before_j.max(taken_j);
        let energy_after_j = energy_before_j - taken_j;
        let event = self.event(EventKind::Impact, moves);
        // A row that lands in its initial position came from the other side.
        let sway = if moves { self.heading() } else { Sway::Right };
        let restitution = energy_after_j / energy_before_j;
        let impact = Impact {
            sway_before: if stood { sway.opposite() } else { sway },
            restitution: if energy_before_j > 0.0 {
                restitution
            } else {
                0.0
            },
            energy_before_j,
            energy_after_j,
            friction_j,
            rates_after_rad_s: event.rates_rad_s.clone(),
            closed: observer.shut.clone(),
            opened: observer.opened.clone(),
            ..Impact::default()
        };
        let event = Event {
            energy_j: energy_after_j + observer.potential,
            hinges: hinges.collect(),
            impact: Some(impact),
            ..event
        };
        self.observer_mut().report(&event);
    }

    /// Reports events of ties in the last step.
    fn report_ties(&mut self, happened: Vec<(usize, EventKind)>) {
        for (tie, kind) in happened {
            if self.observer().reports_events() {
                let tie = Some(tie);
                let event = self.event(kind, self.observer().moved);
                self.observer_mut().report(&Event { tie, ..event });
            }
        }
    }

    /// Event at the current time; `moves` is false if the row rests.
    fn event(&self, kind: EventKind, moves: bool) -> Event {
        let observer = self.observer();
        let (rotations_rad, rates_rad_s) = self.rotations_and_rates().unzip();
        let joints = 0..observer.input.row.joints.len();
        let state = if moves {
            self.moving_state()
        } else {
            State::Rest
        };
        Event {
            rotations_rad,
            rates_rad_s,
            energy_j: observer.kinetic + observer.potential,
            hinges: joints.filter_map(|joint| self.hinge(joint)).collect(),
            ..Event::new(observer.time, kind, state)
        }
    }

    /// Records the state of a row that can still return.
    fn note_return(&mut self) {
        if self.observer().returns() && self.observer().reports_events() {
            let state = self.event(EventKind::Overturned, true);
            self.observer_mut().events.last_return = Some(state);
        }
    }

    /// Sends the poses of the blocks after a step to the recorder. `poses` is reused.
    fn report_poses(&mut self, poses: &mut Vec<Pose>) {
        poses.clear();
        poses.extend(self.poses());
        let observer = self.observer_mut();
        if let Some(recorder) = &mut observer.recorder {
            recorder.step(observer.time, poses, &[]);
        }
    }

    /// Records a sample.
    fn sample(&mut self) -> Result<(), RowMotionError> {
        let (mut sample, thrust_line) = self.observer_mut().blank_sample();
        let kinetic = self.write(&mut sample, thrust_line)?;
        let rotations = self.rotations_and_rates().map(|(rotation, _)| rotation);
        sample.rotations_rad.extend(rotations);
        sample.poses.extend(self.poses());
        for joint in 0..self.observer().input.row.joints.len() {
            let gaps = self.gaps(joint);
            sample.gaps_m.push(gaps);
            if let Some(hinge) = self.hinge(joint) {
                let position_m = self.corner(joint, turning(gaps).unwrap_or(Edge::Intrados));
                sample.hinges.push(OpenHinge { hinge, position_m });
            }
        }
        if !self.stands(&sample) {
            sample.state = self.moving_state();
        }
        self.observer_mut().record(sample, kinetic);
        Ok(())
    }
}

/// Steps a row until it rests, has overturned, or reaches the end of time.
///
/// # Errors
/// If a step fails.
pub fn step_to_end<'a, S>(mut stepper: S) -> Result<Summary, RowMotionError>
where
    S: Stepper<'a>,
{
    let settings = stepper.observer().input.settings;
    let mut marks = Marks::new(settings, stepper.observer().time);
    let mut sampled_s = None;
    let samples_are_made = settings.output_step_s.is_some() && stepper.observer().has_recorder();
    let now = |stepper: &S| stepper.observer().recorder.as_ref()?.clock();
    let mut longest_step = now(&stepper).map(|_| Duration::ZERO);
    let mut poses = Vec::new();
    stepper.note_return();
    let (outcome, outcome_time_s) = loop {
        let observer = stepper.observer();
        let time = observer.time;
        if marks.is_due(time) {
            marks.pass();
            if samples_are_made {
                stepper.sample()?;
                sampled_s = Some(time);
            }
            continue;
        }
        if let Some(ending) = observer.ending(stepper.overturned_s(), || stepper.at_rest_since_s())
        {
            let Some(end_s) = stepper.observer_mut().lengthened_s(ending.0) else {
                break ending;
            };
            marks.settings.end_s = end_s;
        }
        let begun = now(&stepper);
        stepper.step(marks.next_s())?;
        stepper.note_return();
        if let Some((begun, ended)) = begun.zip(now(&stepper)) {
            longest_step = longest_step.max(Some(ended.saturating_sub(begun)));
        }
        if samples_are_made {
            stepper.report_poses(&mut poses);
        }
    };
    let observer = stepper.observer();
    if samples_are_made && sampled_s != Some(observer.time) && !observer.stopped {
        stepper.sample()?;
    }
    stepper.complete_summaries();
    let observer = stepper.observer_mut();
    observer.row_summary.longest_step = longest_step;
    let summary = observer.end(outcome, outcome_time_s);
    if let Outcome::Overturned(_) = outcome {
        follow_fall(&mut stepper);
    }
    Ok(summary)
}

/// Continues the motion of an overturned row if the recorder wants its fall.
fn follow_fall<'a, S: Stepper<'a>>(stepper: &mut S) {
    let observer = stepper.observer_mut();
    let wanted = |recorder: &&mut dyn Recorder| recorder.wants_fall();
    if !observer.recorder.as_ref().is_some_and(wanted) {
        return;
    }
    observer.is_falling = true;
    let mut marks = Marks::of_fall(observer.input.settings, observer.time);
    let end =
        step_fall(stepper, &mut marks).unwrap_or_else(|error| FallEnd::Model(error.to_string()));
    if let Some(recorder) = &mut stepper.observer_mut().recorder {
        recorder.fall_end(end);
    }
}

/// Steps a falling row and returns the reason for the end.
fn step_fall<'a, S: Stepper<'a>>(
    stepper: &mut S,
    marks: &mut Marks,
) -> Result<FallEnd, RowMotionError> {
    for _ in 0..fall::MOST_STEPS {
        let observer = stepper.observer();
        if let Some(end) = fall::end_at(&observer.sample) {
            return Ok(end);
        }
        if observer.stopped || observer.time >= marks.settings.end_s {
            break;
        }
        stepper.step(marks.next_s())?;
        if marks.is_due(stepper.observer().time) {
            marks.pass();
            stepper.sample()?;
        }
    }
    Ok(FallEnd::Slow)
}

/// Length of the next leapfrog step: equal steps up to `until`.
pub fn equal_step(time: f64, until: f64, longest: f64) -> f64 {
    let left = until - time;
    left / (left / longest - 1e-9).ceil().max(1.0)
}

/// Edge about which a joint with these gaps turns; `None` for parted and closed joints.
fn turning(gaps: [f64; 2]) -> Option<Edge> {
    Edge::only(gaps.map(|gap| gap == 0.0))
}

/// Joint with these gaps as a hinge; `None` if it is closed.
pub fn open_hinge(joint: usize, gaps: [f64; 2]) -> Option<Hinge> {
    let edge = turning(gaps);
    (gaps != [0.0; 2]).then_some(Hinge::Joint { joint, edge })
}

/// Eccentricity of the thrust at a joint, towards the extrados, over the thickness, from the impulses at its corners. Tensile impulses
/// within the solver's tolerance count as zero. `None` if neither impulse is compressive.
pub fn eccentricity_ratio(corner_impulses: [f64; 2]) -> Option<f64> {
    let [intrados, extrados] = corner_impulses.map(|impulse| impulse.max(0.0));
    let normal = intrados + extrados;
    (normal > 0.0).then(|| 0.5 * (extrados - intrados) / normal)
}
