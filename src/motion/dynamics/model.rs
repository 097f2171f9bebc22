//! Trait of all models of motion.

use std::error::Error;
use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;

use super::history::JointPressure;
pub use super::recorder::{Recorder, WithoutDemand};
use super::recording::{History, MEMORY_BYTES, MemoryError, Recording};
pub use super::request::{Initial, Request};
use super::until::{EndCondition, SafetyMonitor};
use crate::argument::{ArgumentError, plain};
use crate::dynamics::{
    GroundMotion, OpenHinge, Outcome, RowMotionError, State, Summary, TieSample,
};
use crate::mechanics::{Demand, Displaced, Equivalent, Hinge, MovingBody, MovingForce, Row, Sway};

/// Structure under ground motion, as a model of its motion.
///
/// The trait is called once per history. The equation of motion is evaluated inside the model, not through this trait.
pub trait Model: Debug + Send + Sync {
    /// Names of its bodies from left to right, the order of all lists by body; a single body has an empty name.
    fn bodies(&self) -> Vec<String>;

    /// Horizontal acceleration at which it starts to move from rest to a side, in multiples of gravity; `None` if no push moves it.
    fn incipient_acceleration_g(&self, sway: Sway) -> Option<f64>;

    /// This model as one of mechanisms with one degree of freedom; `None` for other models.
    fn as_mechanisms(&self) -> Option<&dyn MechanismModel> {
        None
    }

    /// Row of blocks, if the model moves its blocks individually.
    fn row(&self) -> Option<&Row> {
        None
    }

    /// Copies of this model with other, equally valid numerical settings: if their results differ, the result is uncertain. Empty if the
    /// settings do not affect the result. A model that [repeats motions mirrored](Model::repeat_mirrored) begins with itself under the mirrored
    /// ground, in place of its first setting.
    fn repetitions(&self) -> Vec<Repetition> {
        Vec::new()
    }

    /// Whether a motion from rest, on ground that moves alike under both feet, covers the mirrored ground as well. The structure is then its own
    /// mirror image, and either the motion repeats to the last bit, or one of its [repetitions](Model::repetitions) is mirrored.
    fn covers_mirrored(&self) -> bool {
        false
    }

    /// Makes the first repetition of a motion the one under the mirrored ground, if the structure is its own mirror image, and its motions are
    /// repeated. Its ground must move alike under both feet, and it must start from rest.
    fn repeat_mirrored(&mut self) {}

    /// Computes the motion on moving ground. The recorder receives samples and events during the computation; without a recorder there are no
    /// samples, as in studies.
    ///
    /// # Errors
    /// If the request is not valid, or the motion cannot be computed.
    fn simulate(
        &self,
        ground: &GroundMotion,
        request: &Request,
        recorder: Option<&mut dyn Recorder>,
    ) -> Result<Summary, SimulationError>;

    /// Energy above that at rest, in J, required to overturn without slip; only for elastic joints, `None` if unknown. With slip, less
    /// energy may suffice.
    fn elastic_barrier_j(&self, _gravity_m_s2: f64) -> Option<f64> {
        None
    }

    /// Whether joints slip.
    fn slips(&self) -> bool {
        false
    }

    /// Whether the structure has impacts; elastic contact lasts.
    fn has_impacts(&self) -> bool {
        true
    }

    /// Whether samples have the forces and stresses of joints.
    fn has_pressures(&self) -> bool {
        false
    }

    /// Whether the structure moves under weaker pushes than that of incipient motion.
    fn moves_below_incipient(&self) -> bool {
        false
    }

    /// This model with the longer steps of a study of many cases; `None` if its longest step is given, or its steps follow from a tolerance. Verdicts
    /// seldom change; docs/maps.md has a measurement.
    fn for_many_cases(&self) -> Option<Box<dyn Model>> {
        None
    }

    /// Number of motions that are computed side by side, faster than one by one.
    fn lanes(&self) -> usize {
        1
    }

    /// Computes the motion without a recorder, as [`Model::simulate`], with the early end `until`.
    ///
    /// # Errors
    /// Those of [`Model::simulate`].
    fn simulate_until(&self, until: EndCondition, case: &Case) -> Result<Summary, SimulationError> {
        let (ground, request) = case;
        let mut monitor = SafetyMonitor::new(until, ground, request);
        if let (Some(monitor), Some(row)) = (&mut monitor, self.row()) {
            monitor.watch(row);
        }
        let recorder = monitor.as_mut().map(|recorder| recorder as _);
        let mut summary = self.simulate(ground, request, recorder)?;
        if monitor.is_some_and(|monitor| monitor.has_ended) {
            summary.is_cut = true;
            if let Outcome::Incomplete | Outcome::StillRocking = summary.outcome {
                summary.outcome = match until {
                    EndCondition::Settled => Outcome::Rest,
                    _ => Outcome::StillRocking,
                };
            }
        }
        Ok(summary)
    }

    /// Computes the motions of several cases, in their order.
    fn simulate_all(&self, cases: &[Case]) -> Vec<Result<Summary, SimulationError>> {
        self.simulate_all_until(EndCondition::End, cases)
    }

    /// Computes the motions of several cases, in their order, with the early end `until`.
    fn simulate_all_until(
        &self,
        until: EndCondition,
        cases: &[Case],
    ) -> Vec<Result<Summary, SimulationError>> {
        let mut queue = CaseQueue {
            until,
            waiting: 0..cases.len(),
            answers: vec![None; cases.len()],
        };
        self.work(cases, &mut queue);
        let answers: Option<Vec<_>> = queue.answers.into_iter().collect();
        answers.expect("all jobs have ended")
    }

    /// Computes all jobs on these cases. A model may compute several motions in parallel; no result depends on the other motions.
    fn work(&self, cases: &[Case], jobs: &mut dyn Jobs) {
        one_by_one(self, cases, jobs);
    }

    /// Memory of all samples of a motion in bytes, at most: as if all hinges were open all the time.
    fn sample_bytes(&self, ground: &GroundMotion, request: &Request) -> u64 {
        let bodies = self.bodies().len();
        // Times, two accelerations, two displacements of feet, energies; number of events and index of the first hinge; two optional ratios.
        let alone = 6 * size_of::<f64>()
            + 2 * size_of::<usize>()
            + 2 * size_of::<Option<f64>>()
            + size_of::<State>()
            + size_of::<Demand>();
        let by_body = 2 * size_of::<f64>() + size_of::<[f64; 3]>();
        // There is at most one hinge more than bodies: a row between supports has one joint more than blocks.
        let hinges = (bodies + 1) * size_of::<OpenHinge>();
        let of_row = self.row().map_or(0, |row| {
            let by_joint = size_of::<[f64; 2]>()
                + usize::from(self.slips()) * size_of::<f64>()
                + usize::from(self.has_pressures()) * size_of::<JointPressure>();
            row.joints.len() * by_joint + row.ties.len() * size_of::<TieSample>()
        });
        let each = alone + bodies * by_body + hinges + of_row;
        request.most_samples(ground).saturating_mul(each as u64)
    }

    /// Computes the motion with all samples and events, which may take up to [`MEMORY_BYTES`] of memory.
    ///
    /// # Errors
    /// Those of [`Model::simulate`], and if the history needs more memory. If this is known in advance, nothing is computed.
    fn history(
        &self,
        ground: &GroundMotion,
        request: &Request,
    ) -> Result<History, SimulationError> {
        request.check(ground)?;
        let mut recording = Recording::new(self.sample_bytes(ground, request), MEMORY_BYTES)?;
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

/// Motion to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Job {
    /// Index of its case.
    pub case: usize,
    /// Index of the [repetition](Model::repetitions) of the model that computes it; `None` for the model itself.
    pub repetition: Option<usize>,
    /// Early end of its computation.
    pub until: EndCondition,
}

impl Job {
    /// Job of a model itself, without repetition, in a case.
    pub(super) const fn of(case: usize, until: EndCondition) -> Self {
        Self {
            case,
            repetition: None,
            until,
        }
    }
}

/// Queue of motions to compute; the result of one motion may add others.
pub trait Jobs {
    /// Next job; `None` if there is none until another one has ended.
    fn next_job(&mut self) -> Option<Job>;

    /// Receives the result of a job.
    fn receive_result(&mut self, job: Job, answer: Result<Summary, SimulationError>);
}

/// Computes jobs one by one.
pub(super) fn one_by_one<M: Model + ?Sized>(model: &M, cases: &[Case], jobs: &mut dyn Jobs) {
    let repetitions = model.repetitions();
    while let Some(job) = jobs.next_job() {
        let case = &cases[job.case];
        let answer = match job.repetition {
            None => model.simulate_until(job.until, case),
            Some(index) => repetitions[index].model.simulate_until(job.until, case),
        };
        jobs.receive_result(job, answer);
    }
}

/// Queue of all cases with the same early end, with their results.
struct CaseQueue {
    until: EndCondition,
    waiting: Range<usize>,
    answers: Vec<Option<Result<Summary, SimulationError>>>,
}

impl Jobs for CaseQueue {
    fn next_job(&mut self) -> Option<Job> {
        self.waiting.next().map(|case| Job::of(case, self.until))
    }

    fn receive_result(&mut self, job: Job, answer: Result<Summary, SimulationError>) {
        self.answers[job.case] = Some(answer);
    }
}

/// Copy of a model with other numerical settings.
#[derive(Debug)]
pub struct Repetition {
    /// Description of the settings, in words.
    pub name: &'static str,
    /// Copy of the model.
    pub model: Box<dyn Model>,
}

/// Model that moves as a sequence of mechanisms with one degree of freedom, with the properties of such models.
pub trait MechanismModel: Model {
    /// Restitution coefficient of the impact that starts the mechanism after `impacts` impacts and a first sway to a side, 1 for the
    /// first mechanism. `None` if an earlier impact stops the structure.
    fn restitution_from(&self, first: Sway, impacts: usize) -> Option<f64>;

    /// Side to which the structure sways after `impacts` impacts and a first sway to a side. Every impact changes the side unless a
    /// wall stands behind the structure.
    fn sway_after(&self, first: Sway, impacts: usize) -> Sway;

    /// Returns right if a push can start the structure to the right, otherwise left, the only side to which it then moves.
    fn first_side(&self) -> Sway {
        match self.incipient_acceleration_g(Sway::Right) {
            Some(_) => Sway::Right,
            None => Sway::Left,
        }
    }

    /// Hinges, from left to right, of the mechanism after `impacts` impacts that now sways to `sway`; empty without such a mechanism.
    fn hinges_after(&self, impacts: usize, sway: Sway) -> Vec<Hinge>;

    /// Rotations of the bodies, in radians, at the unstable equilibrium of the first mechanism to a side.
    fn critical_rotations_rad(&self, sway: Sway) -> Vec<f64>;

    /// Coordinate at the limit position of the first mechanism to a side; releases must start below it.
    fn limit_rad(&self, sway: Sway) -> f64;

    /// Free-standing blocks equivalent to the first mechanism to a side.
    fn equivalent(&self, sway: Sway, gravity_m_s2: f64) -> Option<Equivalent>;

    /// First mechanism to a side at a fraction `part` of the rotation at its unstable equilibrium; `None` without such a mechanism.
    fn displaced_mechanism(&self, sway: Sway, part: f64) -> Option<Displaced>;

    /// Rigid bodies of the first mechanism to a side; `None` without such a mechanism.
    fn moving_bodies(&self, sway: Sway) -> Option<Vec<MovingBody>>;

    /// Constant forces on these bodies; `None` without such a mechanism.
    fn moving_forces(&self, sway: Sway) -> Option<Vec<MovingForce>>;

    /// Side to which moving ground overturns the structure from rest before its first impact; `None` if it does not.
    ///
    /// # Errors
    /// Those of [`Model::simulate`].
    fn overturns_without_impact(
        &self,
        ground: &GroundMotion,
        request: &Request,
    ) -> Result<Option<Sway>, SimulationError>;
}

/// Checks a request for a ground motion.
///
/// # Errors
/// If a number is not valid, or the ground accelerates downwards faster than a free body: models do not follow a structure that loses contact.
pub(super) fn check(ground: &GroundMotion, request: &Request) -> Result<(), SimulationError> {
    request.check(ground)?;
    let falls_s = ground.free_fall_s(request.gravity_m_s2);
    falls_s.map_or(Ok(()), |time_s| Err(SimulationError::FreeFall(time_s)))
}

/// Reason why four links cannot follow feet that move differently.
pub const FEET_NEED_JOINTS: &str =
    "four links assume that all hinges close at once, and feet that move differently prevent this";

/// Reason why a motion was not computed.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A number of the request is out of range.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// The ground accelerates downwards faster than a free body from this time on, in seconds.
    #[error(
        "the ground falls as fast as a free body at {} s and no longer carries the structure: \
         vertical accelerations must stay above -1 g", plain(*.0)
    )]
    FreeFall(f64),
    /// The feet move differently, and the hinges cannot follow.
    #[error("{FEET_NEED_JOINTS}: choose free hinges or elastic joints")]
    Feet,
    /// The history needs too much memory.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// The motion of a row of blocks was not computed.
    #[error(transparent)]
    Row(#[from] RowMotionError),
    /// The motion was not computed, for a reason of its model.
    #[error(transparent)]
    Computation(Arc<dyn Error + Send + Sync>),
}

impl SimulationError {
    /// Error for a reason of the model.
    pub fn computation(reason: impl Error + Send + Sync + 'static) -> Self {
        Self::Computation(Arc::new(reason))
    }
}
