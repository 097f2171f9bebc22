//! Moves a row by a stepper, and reports its motion.

use std::time::{Duration, Instant};

use nalgebra::Vector2;

use super::clock::Marks;
use super::course::{Course, towards};
use super::error::RowMotionError;
use crate::dynamics::fall::{self, FallEnd};
use crate::dynamics::history::{
    Elapsed, Event, EventKind, Impact, OpenHinge, Outcome, Sample, State, Summary,
};
use crate::dynamics::recorder::Recorder;
use crate::mechanics::chain::Hinge;
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::sway::Sway;

/// Moves a row, step by step.
pub trait Stepper<'a>: Sized {
    fn course(&self) -> &Course<'a>;
    fn course_mut(&mut self) -> &mut Course<'a>;
    /// One step, at most to the given time.
    fn step(&mut self, until: f64) -> Result<(), RowMotionError>;
    /// Writes into a blank sample where the blocks are, their rates at that instant, offsets, friction and, if it is wanted, the line
    /// of thrust. Returns the kinetic energy at that instant.
    fn write(&mut self, sample: &mut Sample, thrust_line: bool) -> Result<f64, RowMotionError>;
    /// Rotations of the blocks, and their rates after the last step.
    fn turns(&self) -> impl Iterator<Item = (f64, f64)>;
    /// Gaps of a joint at intrados and extrados.
    fn gaps(&self, joint: usize) -> [f64; 2];
    /// The place at which a joint is pressed, or was last pressed, on the given edge.
    fn corner(&self, joint: usize, edge: Edge) -> Vector2<f64>;
    fn momentum(&self) -> Vector2<f64>;
    /// A joint as a hinge, if it is open.
    fn hinge(&self, joint: usize) -> Option<Hinge> {
        open_hinge(joint, self.gaps(joint))
    }
    /// Whether a row with these hinges and rotations stands.
    fn stands(&self, sample: &Sample) -> bool;
    /// Since when it stands still for good, once the ground is still.
    fn rests_since(&self) -> Option<f64>;
    /// When the row passed its last point of return, once it has overturned.
    fn overturned_s(&self) -> Option<f64> {
        self.course().overturned_s()
    }
    /// Completes the summaries of the course at its end.
    fn complete(&mut self) {}

    /// The side to which the centre of gravity sways; if that is at its undeformed place, the side to which it moves.
    fn heading(&self) -> Sway {
        let sway = self.course().sway;
        towards(if sway == 0.0 { self.momentum().x } else { sway })
    }

    /// The state of a row that moves.
    fn moving(&self) -> State {
        match self.overturned_s() {
            Some(_) => State::Overturned(self.heading()),
            None => State::Rocking(self.heading()),
        }
    }

    /// Reports that all joints were shut before this time, with this energy, rotations and rates, and that some have opened
    /// since.
    fn report_uplift(&mut self, time_s: f64, energy_j: f64, turns: (Vec<f64>, Vec<f64>)) {
        if !self.course().is_followed() {
            return;
        }
        let (rotations_rad, rates_rad_s) = turns;
        let event = Event {
            rotations_rad,
            rates_rad_s,
            energy_j,
            hinges: self.course().opened.clone(),
            ..Event::new(time_s, EventKind::Uplift, State::Rocking(self.heading()))
        };
        self.course_mut().report(&event);
    }

    /// Reports that corners have landed: whether the row moves on, whether it lies where it stood before it moved, the kinetic energy before
    /// and the part taken, and how much of that friction took.
    fn report_impact(
        &mut self,
        [moves, stood]: [bool; 2],
        [energy_before_j, taken_j]: [f64; 2],
        friction_j: Option<f64>,
    ) {
        let course = self.course();
        if !course.is_followed() {
            return;
        }
        let opens_at_once = |joint: usize| {
            let mut opened = course.opened.iter().copied();
            opened
                .find(|hinge| matches!(hinge, Hinge::Joint { joint: opens, .. } if *opens == joint))
        };
        let hinge = |joint: usize| opens_at_once(joint).or_else(|| self.hinge(joint));
        let hinges = (0..course.task.row.joints.len()).filter_map(hinge);
        let energy_after_j = (energy_before_j - taken_j).max(0.0);
        let event = self.event(EventKind::Impact, moves);
        // A row that lands where it stood came from the other side.
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
            closed: course.shut.clone(),
            opened: course.opened.clone(),
            ..Impact::default()
        };
        let event = Event {
            energy_j: energy_after_j + course.potential,
            hinges: hinges.collect(),
            impact: Some(impact),
            ..event
        };
        self.course_mut().report(&event);
    }

    /// Reports events of ties in the last step.
    fn report_ties(&mut self, happened: Vec<(usize, EventKind)>) {
        for (tie, kind) in happened {
            if self.course().is_followed() {
                let tie = Some(tie);
                let event = self.event(kind, self.course().moved);
                self.course_mut().report(&Event { tie, ..event });
            }
        }
    }

    /// An event that happens now to a row that moves on, or rests.
    fn event(&self, kind: EventKind, moves: bool) -> Event {
        let course = self.course();
        let (rotations_rad, rates_rad_s) = self.turns().unzip();
        let joints = 0..course.task.row.joints.len();
        let state = if moves { self.moving() } else { State::Rest };
        Event {
            rotations_rad,
            rates_rad_s,
            energy_j: course.kinetic + course.potential,
            hinges: joints.filter_map(|joint| self.hinge(joint)).collect(),
            ..Event::new(course.time, kind, state)
        }
    }

    /// Makes a sample.
    fn sample(&mut self) -> Result<(), RowMotionError> {
        let (mut sample, thrust_line) = self.course_mut().blank_sample();
        let kinetic = self.write(&mut sample, thrust_line)?;
        let rotations = self.turns().map(|(rotation, _)| rotation);
        sample.rotations_rad.extend(rotations);
        for joint in 0..self.course().task.row.joints.len() {
            let gaps = self.gaps(joint);
            sample.gaps_m.push(gaps);
            if let Some(hinge) = self.hinge(joint) {
                let position_m = self.corner(joint, turning(gaps).unwrap_or(Edge::Intrados));
                sample.hinges.push(OpenHinge { hinge, position_m });
            }
        }
        if !self.stands(&sample) {
            sample.state = self.moving();
        }
        self.course_mut().record(sample, kinetic);
        Ok(())
    }
}

/// Steps a row until it rests, has overturned, or the time is over.
pub fn run<'a, S>(mut stepper: S) -> Result<Summary, RowMotionError>
where
    S: Stepper<'a>,
{
    let settings = stepper.course().task.settings;
    let mut marks = Marks::new(settings, stepper.course().time);
    let mut sampled_s = None;
    let samples_are_made = settings.output_step_s.is_some() && stepper.course().is_followed();
    let mut longest_step = samples_are_made.then_some(Duration::ZERO);
    let (outcome, outcome_time_s) = loop {
        let course = stepper.course();
        let time = course.time;
        if marks.is_due(time) {
            marks.pass();
            if samples_are_made {
                stepper.sample()?;
                sampled_s = Some(time);
            }
            continue;
        }
        if let Some(ending) = course.ending(stepper.overturned_s(), || stepper.rests_since()) {
            break ending;
        }
        let begun = longest_step.map(|_| Instant::now());
        stepper.step(marks.next_s())?;
        longest_step = longest_step.max(begun.map(|begun| begun.elapsed()));
    };
    let course = stepper.course();
    if samples_are_made && sampled_s != Some(course.time) && !course.stopped {
        stepper.sample()?;
    }
    stepper.complete();
    let course = stepper.course_mut();
    course.of_row.longest_step = Elapsed(longest_step);
    let summary = course.end(outcome, outcome_time_s);
    if let Outcome::Overturned(_) = outcome {
        follow_fall(&mut stepper);
    }
    Ok(summary)
}

/// Steps a row on that has overturned, if its recorder follows falls.
fn follow_fall<'a, S: Stepper<'a>>(stepper: &mut S) {
    let course = stepper.course_mut();
    let wanted = |recorder: &&mut dyn Recorder| recorder.wants_fall();
    if !course.recorder.as_ref().is_some_and(wanted) {
        return;
    }
    course.falls = true;
    let mut marks = Marks::of_fall(course.task.settings, course.time);
    let end = fall(stepper, &mut marks).unwrap_or_else(|error| FallEnd::Model(error.to_string()));
    if let Some(recorder) = &mut stepper.course_mut().recorder {
        recorder.fell(end);
    }
}

/// Steps a row that falls, and says why its fall is followed no further.
fn fall<'a, S: Stepper<'a>>(stepper: &mut S, marks: &mut Marks) -> Result<FallEnd, RowMotionError> {
    for _ in 0..fall::MOST_STEPS {
        let course = stepper.course();
        if let Some(end) = fall::end_at(&course.sample) {
            return Ok(end);
        }
        if course.stopped || course.time >= marks.settings.end_s {
            break;
        }
        stepper.step(marks.next_s())?;
        if marks.is_due(stepper.course().time) {
            marks.pass();
            stepper.sample()?;
        }
    }
    Ok(FallEnd::Slow)
}

/// Length of the next step of a leapfrog: equal steps up to the given time.
pub fn equal_step(time: f64, until: f64, longest: f64) -> f64 {
    let left = until - time;
    left / (left / longest - 1e-9).ceil().max(1.0)
}

/// The edge of the only corner of a joint, intrados or extrados, for which this is true; else `None`.
pub fn only(corners: [bool; 2]) -> Option<Edge> {
    match corners {
        [true, false] => Some(Edge::Intrados),
        [false, true] => Some(Edge::Extrados),
        _ => None,
    }
}

/// The edge about which a joint with these gaps turns; `None` where it parts, or is shut.
fn turning(gaps: [f64; 2]) -> Option<Edge> {
    only(gaps.map(|gap| gap == 0.0))
}

/// A joint with these gaps as a hinge, if it is open.
pub fn open_hinge(joint: usize, gaps: [f64; 2]) -> Option<Hinge> {
    let edge = turning(gaps);
    (gaps != [0.0; 2]).then_some(Hinge::Joint { joint, edge })
}

/// Distance of the thrust from the middle of a joint towards the extrados, by the impulses at its corners, over the thickness; `None`
/// if neither presses. A pull below the tolerance of the solver counts as zero.
pub fn eccentricity_ratio(corner_impulses: [f64; 2]) -> Option<f64> {
    let [intrados, extrados] = corner_impulses.map(|impulse| impulse.max(0.0));
    let normal = intrados + extrados;
    (normal > 0.0).then(|| 0.5 * (extrados - intrados) / normal)
}
