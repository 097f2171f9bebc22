//! The trait of every model of motion: the seam between models and everything that uses them.

use std::error::Error;
use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;

use super::ground::GroundMotion;
use super::history::{Outcome, Summary};
pub use super::recorder::{Recorder, WithoutDemand};
use super::recording::{History, MEMORY_BYTES, MemoryError, Recording, Shape};
pub use super::request::{Initial, Request};
use super::row::error::RowMotionError;
use super::until::{Until, UntilSafe};
use crate::argument::ArgumentError;
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

    /// Copies of this model that are computed in other, equally good ways: where they disagree, the result is uncertain. Empty if
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
    /// known. A structure that slips may overturn with less.
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
    /// Those of [`Model::simulate`].
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
        let answers: Option<Vec<_>> = all.answers.into_iter().collect();
        answers.expect("all jobs have ended")
    }

    /// Does all jobs on these cases. A model that computes several motions at once does so here; no result depends on what is beside it.
    fn work(&self, cases: &[Case], jobs: &mut dyn Jobs) {
        one_by_one(self, cases, jobs);
    }

    /// The size of its samples.
    fn shape(&self) -> Shape {
        Shape {
            bodies: self.bodies().len(),
            ..Shape::default()
        }
    }

    /// Its motion with all samples and events, which may take [`MEMORY_BYTES`] of memory.
    ///
    /// # Errors
    /// Those of [`Model::simulate`], and when the history takes more memory: if that is known beforehand, nothing is
    /// computed.
    fn history(
        &self,
        ground: &GroundMotion,
        request: &Request,
    ) -> Result<History, SimulationError> {
        request.check(ground)?;
        let most_samples = request.most_samples(ground);
        let mut recording = Recording::new(self.shape(), most_samples, MEMORY_BYTES)?;
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
    /// Index of the [repetition](Model::repetitions) of the model that computes it; `None` for the model itself.
    pub repetition: Option<usize>,
    /// The end of its computation.
    pub until: Until,
}

impl Job {
    /// The motion of a model itself in a case.
    pub(super) const fn of(case: usize, until: Until) -> Self {
        Self {
            case,
            repetition: None,
            until,
        }
    }
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
        self.waiting.next().map(|case| Job::of(case, self.until))
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
    /// The copy.
    pub model: Box<dyn Model>,
}

/// A model that moves as one mechanism with one degree of freedom at a time, with what only such a model has.
pub trait MechanismModel: Model {
    /// Restitution coefficient of the impact that leads to the mechanism after this many impacts and a first sway
    /// to this side, 1 for the first; `None` when an impact before it stops the structure.
    fn restitution_from(&self, first: Sway, impacts: usize) -> Option<f64>;

    /// Hinges of that mechanism from left to right when it sways to that side; none if there is no such
    /// mechanism.
    fn hinges_after(&self, impacts: usize, sway: Sway) -> Vec<Hinge>;

    /// Rotations of the bodies at the unstable equilibrium of the first mechanism, swaying to this side, in radians.
    fn critical_rotations_rad(&self, sway: Sway) -> Vec<f64>;

    /// Coordinate at the limit position of the first mechanism to this side: no release can start from there or beyond.
    fn limit_rad(&self, sway: Sway) -> f64;

    /// The free-standing blocks that rock like the first mechanism to this side.
    fn equivalent(&self, sway: Sway, gravity_m_s2: f64) -> Option<Equivalent>;

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
    /// Those of [`Model::simulate`].
    fn overturns_without_impact(
        &self,
        ground: &GroundMotion,
        request: &Request,
    ) -> Result<Option<Sway>, SimulationError>;
}

/// Refuses numbers that no simulation on this ground can work with, and ground that falls away under the structure: no model follows a
/// structure that flies.
pub(super) fn check(ground: &GroundMotion, request: &Request) -> Result<(), SimulationError> {
    request.check(ground)?;
    match ground.free_fall_s(request.gravity_m_s2) {
        Some(time_s) => Err(SimulationError::FreeFall { time_s }),
        None => Ok(()),
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
    /// The motion of a row of blocks could not be computed.
    #[error(transparent)]
    Row(#[from] RowMotionError),
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
