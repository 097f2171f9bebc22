//! The trait of every model of motion: the seam between models and everything that uses them.

use std::error::Error;
use std::fmt::Debug;
use std::ops::{ControlFlow, Range, RangeInclusive};
use std::sync::Arc;

use serde::Serialize;

use super::fall::FallEnd;
use super::ground::GroundMotion;
use super::history::{
    Event, History, MEMORY_BYTES, MemoryError, Outcome, Recording, Sample, Shape, Summary,
};
use super::until::{Until, UntilSafe};
use crate::argument::{ArgumentError, within};
use crate::mechanics::blocks::Row;
use crate::mechanics::capacity::Displaced;
use crate::mechanics::chain::Hinge;
use crate::mechanics::equivalent::Equivalent;
use crate::mechanics::sway::Sway;
use crate::mechanics::virtual_work::MovingBody;

/// A structure under ground motion, as a model of its motion.
///
/// The trait is called once per history; the equation of motion is evaluated inside the model, not through this
/// trait.
pub trait Model: Debug + Send + Sync {
    /// Names of its bodies from left to right, the order of all lists by body; a single body has an empty
    /// name.
    fn bodies(&self) -> Vec<String>;

    /// Horizontal acceleration at which it starts to move from rest towards that side, in units of gravity;
    /// `None` if no push moves it.
    fn incipient_acceleration_g(&self, sway: Sway) -> Option<f64>;

    /// This model as one of mechanisms with one degree of freedom, if it is one.
    fn as_mechanisms(&self) -> Option<&dyn MechanismModel> {
        None
    }

    /// The row of blocks, if the model moves its blocks one by one.
    fn row(&self) -> Option<&Row> {
        None
    }

    /// The same structure, computed in other, equally good ways: where they disagree, the result is not known. Empty if
    /// the way of computing does not matter.
    fn repetitions(&self) -> Vec<Repetition> {
        Vec::new()
    }

    /// Its motion on moving ground. Samples and events go to the recorder as they happen; without a recorder none
    /// are made, as in studies.
    ///
    /// # Errors
    /// When the request is not possible, or the motion cannot be computed.
    fn simulate(
        &self,
        ground: &GroundMotion,
        request: &Request,
        recorder: Option<&mut dyn Recorder>,
    ) -> Result<Summary, SimulationError>;

    /// Energy above that at rest, in J, that it must reach to overturn while no joint slips; only for elastic joints, and where it is
    /// known. What slips may overturn with less.
    fn elastic_barrier_j(&self, _gravity_m_s2: f64) -> Option<f64> {
        None
    }

    /// Whether it computes several motions at once, faster than one after the other.
    fn is_faster_together(&self) -> bool {
        false
    }

    /// Its motion, as [`Model::simulate`] gives it without a recorder, followed as far as `until` says.
    ///
    /// # Errors
    /// As [`Model::simulate`].
    fn simulate_until(&self, until: Until, case: &Case) -> Result<Summary, SimulationError> {
        let (ground, request) = case;
        let mut until_safe = UntilSafe::new(until, ground, request);
        let recorder = until_safe.as_mut().map(|recorder| recorder as _);
        let mut summary = self.simulate(ground, request, recorder)?;
        if until_safe.is_some_and(|until_safe| until_safe.has_ended)
            && summary.outcome == Outcome::Incomplete
        {
            summary.outcome = Outcome::StillRocking;
        }
        Ok(summary)
    }

    /// Its motions on several grounds, in their order.
    fn simulate_all(&self, cases: &[Case]) -> Vec<Result<Summary, SimulationError>> {
        self.simulate_all_until(Until::End, cases)
    }

    /// Its motions on several grounds, in their order, followed as far as `until` says.
    fn simulate_all_until(
        &self,
        until: Until,
        cases: &[Case],
    ) -> Vec<Result<Summary, SimulationError>> {
        let mut all = All {
            until,
            waiting: 0..cases.len(),
            answers: vec![None; cases.len()],
        };
        self.work(cases, &mut all);
        let answers = all.answers.into_iter();
        answers
            .map(|answer| answer.expect("all jobs have ended"))
            .collect()
    }

    /// Does all jobs on these cases. A model that computes several motions at once does so here; no result depends on what is beside it.
    fn work(&self, cases: &[Case], jobs: &mut dyn Jobs) {
        one_by_one(self, cases, jobs);
    }

    /// The size of its samples.
    fn shape(&self) -> Shape {
        Shape {
            bodies: self.bodies().len(),
            joints: 0,
            slipping: 0,
            pressing: 0,
            ties: 0,
        }
    }

    /// Its motion with all samples and events, which may take [`MEMORY_BYTES`] of memory.
    ///
    /// # Errors
    /// Those of [`Model::history_within`].
    fn history(
        &self,
        ground: &GroundMotion,
        request: &Request,
    ) -> Result<History, SimulationError> {
        self.history_within(MEMORY_BYTES, ground, request)
    }

    /// The same with another bound of memory, in bytes. [`Shape::bytes`] of [`Request::most_samples`] gives the
    /// memory of the samples.
    ///
    /// # Errors
    /// Those of [`Model::simulate`], and when the history takes more memory: if that is known beforehand, nothing is
    /// computed.
    fn history_within(
        &self,
        memory_bytes: u64,
        ground: &GroundMotion,
        request: &Request,
    ) -> Result<History, SimulationError> {
        request.check(ground)?;
        let most_samples = request.most_samples(ground);
        let mut recording = Recording::new(self.shape(), most_samples, memory_bytes)?;
        let summary = self.simulate(ground, request, Some(&mut recording))?;
        let (samples, events) = recording.finish()?;
        Ok(History {
            bodies: self.bodies(),
            summary,
            samples,
            events,
        })
    }
}

/// A ground motion, and a request for the motion on it.
pub type Case = (GroundMotion, Request);

/// A motion to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Job {
    /// The index of its case.
    pub case: usize,
    /// Which of the [repetitions](Model::repetitions) of the model computes it; `None` for the model itself.
    pub repetition: Option<usize>,
    /// How far it is followed.
    pub until: Until,
}

/// Motions to compute, where the answer to one may ask for others.
pub trait Jobs {
    /// The next one; `None` if there is none until another one has ended.
    fn next(&mut self) -> Option<Job>;

    /// Receives the answer to a job.
    fn ended(&mut self, job: Job, answer: Result<Summary, SimulationError>);
}

/// Does jobs one after the other.
pub(super) fn one_by_one<M: Model + ?Sized>(model: &M, cases: &[Case], jobs: &mut dyn Jobs) {
    let repetitions = model.repetitions();
    while let Some(job) = jobs.next() {
        let case = &cases[job.case];
        let answer = match job.repetition {
            None => model.simulate_until(job.until, case),
            Some(index) => repetitions[index].model.simulate_until(job.until, case),
        };
        jobs.ended(job, answer);
    }
}

/// Every case followed equally far, with the answers so far.
struct All {
    until: Until,
    waiting: Range<usize>,
    answers: Vec<Option<Result<Summary, SimulationError>>>,
}

impl Jobs for All {
    fn next(&mut self) -> Option<Job> {
        self.waiting.next().map(|case| Job {
            case,
            repetition: None,
            until: self.until,
        })
    }

    fn ended(&mut self, job: Job, answer: Result<Summary, SimulationError>) {
        self.answers[job.case] = Some(answer);
    }
}

/// A copy of a model that is computed in another way.
#[derive(Debug)]
pub struct Repetition {
    /// The other way, in words.
    pub name: &'static str,
    /// The same structure.
    pub model: Box<dyn Model>,
}

/// A model that moves as one mechanism with one degree of freedom at a time, with what only such a model has.
pub trait MechanismModel: Model {
    /// Restitution coefficient of the impact that leads to the mechanism after this many impacts and a first sway
    /// to this side, 1 for the first; `None` when an impact before it stops the structure.
    fn restitution_from(&self, first: Sway, impacts: usize) -> Option<f64>;

    /// The same after a first sway to the right; for a structure that is its own mirror image, to either side.
    fn restitution_after(&self, impacts: usize) -> Option<f64> {
        self.restitution_from(Sway::Right, impacts)
    }

    /// Hinges of that mechanism from left to right when it sways to that side; none if there is no such
    /// mechanism.
    fn hinges_after(&self, impacts: usize, sway: Sway) -> Vec<Hinge>;

    /// Rotations of the bodies at the unstable equilibrium of the first mechanism, swaying to this side, in radians.
    fn critical_rotations_towards_rad(&self, sway: Sway) -> Vec<f64>;

    /// The same swaying right.
    fn critical_rotations_rad(&self) -> Vec<f64> {
        self.critical_rotations_towards_rad(Sway::Right)
    }

    /// Coordinate at the limit position of the first mechanism to this side: no release can start from there or beyond.
    fn limit_towards_rad(&self, sway: Sway) -> f64;

    /// The same to the right.
    fn limit_rad(&self) -> f64 {
        self.limit_towards_rad(Sway::Right)
    }

    /// The free-standing blocks that rock like the first mechanism to this side.
    fn equivalent_towards(&self, sway: Sway, gravity_m_s2: f64) -> Option<Equivalent>;

    /// The same to the right.
    fn equivalent(&self, gravity_m_s2: f64) -> Option<Equivalent> {
        self.equivalent_towards(Sway::Right, gravity_m_s2)
    }

    /// Its first mechanism to this side, displaced by this fraction of the way to the unstable equilibrium; `None` if it has
    /// none.
    fn displaced(&self, sway: Sway, part: f64) -> Option<Displaced>;

    /// Mass times horizontal displacement of the common centre of gravity, in kg m towards the side of the sway, at this
    /// coordinate of the mechanism after this many impacts and a first sway to this side; `None` when there is no such mechanism.
    fn shift_kg_m(&self, first: Sway, impacts: usize, q_rad: f64) -> Option<f64>;

    /// The rigid bodies of its first mechanism to this side, as [`crate::mechanics::capacity::moving_bodies`]; `None` if it
    /// has none.
    fn moving_bodies(&self, sway: Sway) -> Option<Vec<MovingBody>>;

    /// The side to which moving ground overturns it from rest before its first impact; `None` if it does not.
    ///
    /// # Errors
    /// As [`Model::simulate`].
    fn overturns_without_impact(
        &self,
        ground: &GroundMotion,
        request: &Request,
    ) -> Result<Option<Sway>, SimulationError>;
}

/// What is to be simulated, and how accurately.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Acceleration of gravity, in 0.001 to 1000.
    pub gravity_m_s2: f64,
    /// Upper bound of the time, in 1e-6 to 1e6: a history ends earlier if the structure overturns, or rests on ground that stays
    /// quiet.
    pub end_s: f64,
    /// Interval of the samples, in 1e-6 to 1e6, of which there are at most 1e7. Some models end their steps there.
    pub output_step_s: f64,
    /// Where the motion starts from; `None`: from rest.
    pub initial: Option<Initial>,
    /// Error that the integrator may make in a step, relative to the state, in 1e-13 to 1e-3.
    pub relative_tolerance: f64,
    /// An impact that leaves less than this fraction of the energy barrier of the first mechanism ends in rest; in 1e-16 to 0.1.
    pub rest_energy_ratio: f64,
}

/// A rotated position from which a structure is released at no velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Initial {
    /// The side to which it has swayed.
    pub sway: Sway,
    /// Magnitude of the rotation of the body that carries the coordinate: the end body on the side from which
    /// the structure sways (the left one of a sway to the right), or the column.
    pub rotation_rad: f64,
}

impl Initial {
    /// Smallest rotation that a structure can be released from: the energy of a smaller one may vanish in rounding.
    pub const MIN_ROTATION_RAD: f64 = 1e-100;
}

impl Default for Request {
    /// Ten seconds from rest under gravity of 9.81 m/s2, with the defaults of a scenario.
    fn default() -> Self {
        Self {
            gravity_m_s2: 9.81,
            end_s: 10.0,
            output_step_s: 0.005,
            initial: None,
            relative_tolerance: 1e-9,
            rest_energy_ratio: 1e-8,
        }
    }
}

impl Request {
    /// Accelerations of gravity.
    pub const GRAVITY_M_S2: RangeInclusive<f64> = 1e-3..=1e3;
    /// Lengths of a history, and intervals of its samples. At shorter times the errors of a step fall below the resolution of
    /// numbers.
    pub const TIME_S: RangeInclusive<f64> = 1e-6..=1e6;
    /// Tolerances of the integrator.
    pub const RELATIVE_TOLERANCE: RangeInclusive<f64> = 1e-13..=1e-3;
    /// Energies at which a structure is at rest.
    pub const REST_ENERGY_RATIO: RangeInclusive<f64> = 1e-16..=0.1;
    /// Samples that a history may have: about a gigabyte of rows.
    pub const MOST_SAMPLES: f64 = 1e7;

    /// Largest number of samples of a history on this ground: one at the start, at every output step and at the end.
    #[must_use]
    pub fn most_samples(&self, ground: &GroundMotion) -> u64 {
        let before = if ground.start_s() < 0.0 { 1 } else { 0 };
        // Numbers that cannot count samples are refused elsewhere.
        (self.lasts_s(ground) / self.output_step_s) as u64 + 2 + before
    }

    /// Longest time from the start of the ground motion to the end of a history, in seconds.
    fn lasts_s(&self, ground: &GroundMotion) -> f64 {
        self.end_s - ground.start_s()
    }

    /// Refuses numbers that no simulation on this ground can work with, and ground that falls away under the structure: no model follows a
    /// structure that flies.
    pub(in crate::dynamics) fn check_on(
        &self,
        ground: &GroundMotion,
    ) -> Result<(), SimulationError> {
        self.check(ground)?;
        match ground.free_fall_s(self.gravity_m_s2) {
            Some(time_s) => Err(SimulationError::FreeFall { time_s }),
            None => Ok(()),
        }
    }

    /// Refuses numbers that no simulation on this ground can work with.
    pub fn check(&self, ground: &GroundMotion) -> Result<(), ArgumentError> {
        within("gravity_m_s2", self.gravity_m_s2, Self::GRAVITY_M_S2)?;
        within("end_s", self.end_s, Self::TIME_S)?;
        within("output_step_s", self.output_step_s, Self::TIME_S)?;
        within(
            "relative_tolerance",
            self.relative_tolerance,
            Self::RELATIVE_TOLERANCE,
        )?;
        within(
            "rest_energy_ratio",
            self.rest_energy_ratio,
            Self::REST_ENERGY_RATIO,
        )?;
        if let Some(initial) = self.initial {
            within(
                "rotation_rad",
                initial.rotation_rad,
                Initial::MIN_ROTATION_RAD..=std::f64::consts::PI,
            )?;
        }
        let lasts_s = self.lasts_s(ground);
        if lasts_s / self.output_step_s <= Self::MOST_SAMPLES {
            return Ok(());
        }
        Err(ArgumentError {
            argument: "output_step_s",
            value: self.output_step_s,
            allowed: format!(
                "at least {:?}, for ten million samples",
                lasts_s / Self::MOST_SAMPLES
            ),
        })
    }
}

/// Why four links do not take feet that move differently.
pub const FEET_NEED_JOINTS: &str = "between feet that move differently joints are open at every instant, and the hinges of four links all shut at once";

/// Why a motion could not be computed.
#[derive(Clone, Debug, thiserror::Error)]
pub enum SimulationError {
    /// A number of the request is out of range.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// The ground falls away under the structure.
    #[error(
        "the ground falls as fast as a free body at {time_s:?} s and no longer carries the structure: \
         vertical accelerations must stay above -1 g"
    )]
    FreeFall {
        /// When, in seconds.
        time_s: f64,
    },
    /// The feet move differently, and the hinges cannot follow.
    #[error("{FEET_NEED_JOINTS}: choose free hinges or elastic joints")]
    Feet,
    /// The history takes too much memory.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// The motion could not be computed, for a reason of its model.
    #[error(transparent)]
    Computation(Arc<dyn Error + Send + Sync>),
}

impl SimulationError {
    /// An error for a reason of the model.
    pub fn computation(reason: impl Error + Send + Sync + 'static) -> Self {
        Self::Computation(Arc::new(reason))
    }
}

/// Receives the samples and events of a history. Breaking ends the history there.
///
/// Samples arrive in order of time, and so do events; the last sample before an event may arrive after it.
pub trait Recorder {
    /// A sample: one at every multiple of the output step from zero on, and a last one at the end.
    fn sample(&mut self, _sample: &Sample) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// An event.
    fn event(&mut self, _event: &Event) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Whether samples need the thrust excess and the friction demand, which take most of the time of a history of four links. Without
    /// them, the summary of mechanisms has no record of thrust.
    fn wants_demand(&self) -> bool {
        true
    }

    /// Whether samples need the line of thrust, which takes time to compute.
    fn wants_thrust_line(&self) -> bool {
        false
    }

    /// Whether it follows the fall of a structure that has overturned.
    fn wants_fall(&self) -> bool {
        false
    }

    /// A sample of the fall. They come after all samples and events of the history, of which they are no part. Breaking ends the fall.
    fn fall(&mut self, _sample: &Sample) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Why the fall is followed no further.
    fn fell(&mut self, _end: FallEnd) {}
}

/// A function records samples.
impl<F: FnMut(&Sample) -> ControlFlow<()>> Recorder for F {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self(sample)
    }
}

/// A function records samples without the demand of the line of thrust.
pub struct WithoutDemand<F>(pub F);

impl<F: FnMut(&Sample) -> ControlFlow<()>> Recorder for WithoutDemand<F> {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        (self.0)(sample)
    }

    fn wants_demand(&self) -> bool {
        false
    }
}
