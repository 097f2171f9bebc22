//! Repeatability of a motion: its agreement with its repetitions, which have [other, equally valid numerical settings](Model::repetitions).
//!
//! If repetitions differ in whether the structure overturns, the outcome is **uncertain**: neither overturned nor survived. The side of overturning,
//! and whether a survivor comes to rest, do not count. Most repetitions can be skipped for this question: those of motions whose outcome no later
//! impact can change (`needs_no_repetition`). With rigid joints, a motion close to overturning is uncertain as well if a repetition differs before
//! the largest rotation: other steps may then change the outcome ([`EarlyDifference`]).

use std::collections::VecDeque;

use serde::{Serialize, Serializer};
use thiserror::Error;

use super::ground::GroundMotion;
use super::history::{Details, HalfCycle, Outcome, Summary};
use super::model::{Case, Job, Jobs, Model, Repetition, Request, SimulationError};
use super::until::EndCondition;
use super::variation::MotionThread;

/// Relative tolerance within which a peak is certain.
pub const SAME_PEAK_RATIO: f64 = 0.01;

/// Range of the repetitions, over [`SAME_PEAK_RATIO`], within which a peak is certain; other settings may differ more than the repetitions.
const AGREEMENT: f64 = 0.5;

/// Peak, over the largest peak, below which half cycles are not compared.
const LEAST_PEAK_RATIO: f64 = 1e-2;

/// Smallest slip that counts, in metres.
const LEAST_SLIP_M: f64 = 1e-6;

/// Motion compared with its repetitions: only results on which they agree are reliable.
///
/// After the first change of side, the motion depends on the order of almost simultaneous impacts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Repeatability {
    /// Names of the repetitions.
    #[serde(skip)]
    pub repeated: Vec<&'static str>,
    /// Outcome of the motion itself, then those of the repetitions.
    #[serde(skip)]
    pub outcomes: Vec<Outcome>,
    /// Half cycles of the motion itself with a peak of at least a hundredth of its largest peak.
    pub half_cycles: Vec<RepeatedHalfCycle>,
    /// Number of half cycles, from the first on, that are certain.
    pub same_until_half_cycle: usize,
    /// Start of the first half cycle that is not certain, in seconds; `None` if all are certain.
    pub parts_at_s: Option<f64>,
    /// Largest rotation of a block; `None` if one of the motions overturns.
    #[serde(rename = "largest_rotation_rad")]
    pub largest_rad: Option<RepeatedValue>,
    /// First difference that makes the outcome of a row with rigid joints uncertain; `None` if there is none.
    #[serde(rename = "early_difference")]
    pub early: Option<EarlyDifference>,
    /// Slips of the joints at the end; empty without slip, and if one of the motions overturns.
    pub slips_m: Vec<RepeatedValue>,
}

/// Half cycle before the largest rotation whose peak differs by more than [`SAME_PEAK_RATIO`] in a repetition.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EarlyDifference {
    /// Time of the peak, in seconds.
    pub peak_time_s: f64,
    /// Difference of the peaks over the larger one; 1 if the repetition has no half cycle to the same side at that time.
    pub ratio: f64,
    /// Name of the repetition.
    #[serde(serialize_with = "as_key")]
    pub repetition: &'static str,
}

/// Returns the name of a repetition as a key in results.
#[must_use]
pub fn key(repetition: &str) -> String {
    repetition.replace(' ', "_")
}

fn as_key<S: Serializer>(repetition: &str, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&key(repetition))
}

/// Half cycle of a motion with its counterparts in the repetitions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RepeatedHalfCycle {
    /// Half cycle of the motion itself; in results, the time of its peak, in seconds.
    #[serde(rename = "peak_time_s", serialize_with = "peak_time")]
    pub own: HalfCycle,
    /// Peaks in all motions, in radians; `None` if a repetition has no half cycle to the same side at that time.
    pub peak_rad: Option<RepeatedValue>,
}

fn peak_time<S: Serializer>(cycle: &HalfCycle, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(cycle.peak_time_s)
}

impl RepeatedHalfCycle {
    /// Returns whether the peak is certain.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.peak_rad.is_some_and(|peak| peak.is_certain())
    }
}

/// Value of a quantity in a motion, and its range in the motion and all repetitions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RepeatedValue {
    /// Value in the motion itself.
    pub own: f64,
    /// Least value of all.
    pub min: f64,
    /// Largest value of all.
    pub max: f64,
}

impl RepeatedValue {
    /// Returns the range of a value of the motion itself and of its repetitions.
    fn of(own: f64, others: impl IntoIterator<Item = f64>) -> Self {
        let (mut min, mut max) = (own, own);
        for other in others {
            (min, max) = (min.min(other), max.max(other));
        }
        Self { own, min, max }
    }

    /// Returns whether the value is certain to [`SAME_PEAK_RATIO`].
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.max - self.min <= AGREEMENT * SAME_PEAK_RATIO * self.max
    }
}

impl Repeatability {
    /// Compares a motion of a row with its repetitions, given with their names.
    #[must_use]
    pub fn new(own: &Summary, repetitions: &[(&'static str, Summary)]) -> Self {
        let others: Vec<&Summary> = repetitions.iter().map(|(_, other)| other).collect();
        let runs: Vec<&Summary> = [&[own], &others[..]].concat();
        let mut cycles = own.half_cycles();
        let peaks_rad = cycles.iter().map(|cycle| cycle.peak_rad);
        let least_rad = LEAST_PEAK_RATIO * peaks_rad.fold(0.0, f64::max);
        cycles.retain(|cycle| cycle.peak_rad >= least_rad);
        let beside = |own: HalfCycle| {
            let peak_rad =
                |other: &&Summary| Some(own.counterpart(&other.row()?.half_cycles)?.peak_rad);
            let peaks_rad: Option<Vec<f64>> = others.iter().map(peak_rad).collect();
            let peak_rad = peaks_rad.map(|peaks_rad| RepeatedValue::of(own.peak_rad, peaks_rad));
            RepeatedHalfCycle { own, peak_rad }
        };
        let half_cycles: Vec<_> = cycles.into_iter().map(beside).collect();
        let differs = |cycle: &RepeatedHalfCycle| !cycle.is_certain();
        let parts = half_cycles.iter().position(differs);
        let all_stand = runs.iter().all(|run| run.overturned_s().is_none());
        let largest_rad = || {
            let others_rad = others.iter().map(|other| other.largest_rotation_rad());
            RepeatedValue::of(own.largest_rotation_rad(), others_rad)
        };
        let early = |(name, other): &(&'static str, Summary)| early_difference(own, name, other);
        let slips_m = all_stand.then(|| slips_m(&runs)).flatten();
        Self {
            repeated: repetitions.iter().map(|(name, _)| *name).collect(),
            outcomes: runs.iter().map(|run| run.outcome).collect(),
            same_until_half_cycle: parts.unwrap_or(half_cycles.len()),
            parts_at_s: parts.map(|parts| half_cycles[parts].own.start_s),
            half_cycles,
            largest_rad: all_stand.then(largest_rad),
            early: repetitions.iter().find_map(early),
            slips_m: slips_m.unwrap_or_default(),
        }
    }

    /// Returns whether the outcome is uncertain: a repetition has another outcome, or differs too early.
    #[must_use]
    pub fn is_uncertain(&self) -> bool {
        let mut verdicts = self.outcomes.iter().map(|outcome| Verdict::from(*outcome));
        let own = verdicts.next();
        self.early.is_some() || verdicts.any(|other| Some(other) != own)
    }

    /// Returns whether any joint has slipped at the end.
    #[must_use]
    pub fn has_slipped(&self) -> bool {
        self.most_slip_m() > LEAST_SLIP_M
    }

    fn most_slip_m(&self) -> f64 {
        let ends_m = self.slips_m.iter().flat_map(|slip| [slip.min, slip.max]);
        ends_m.fold(0.0, |most_m, end_m| most_m.max(end_m.abs()))
    }

    /// Returns the joint whose final slips differ most, if they are not certain to [`SAME_PEAK_RATIO`] of the largest slip of any joint; `None` if
    /// all are certain.
    #[must_use]
    pub fn uncertain_slip(&self) -> Option<usize> {
        let range_m = |joint: &usize| self.slips_m[*joint].max - self.slips_m[*joint].min;
        let joints = 0..self.slips_m.len();
        let worst = joints.max_by(|one, other| range_m(one).total_cmp(&range_m(other)));
        let same_m = AGREEMENT * SAME_PEAK_RATIO * self.most_slip_m();
        worst.filter(|joint| self.has_slipped() && range_m(joint) > same_m)
    }

    /// Returns whether all outcomes are the same, including the side of overturning.
    #[must_use]
    pub fn same_outcome(&self) -> bool {
        self.outcomes.iter().all(|other| *other == self.outcomes[0])
    }
}

/// Returns the final slips of the joints in all these motions; `None` if joints do not slip.
fn slips_m(runs: &[&Summary]) -> Option<Vec<RepeatedValue>> {
    let slipped = runs.iter().map(|run| run.row()?.sliding.as_ref());
    let all: Vec<_> = slipped.collect::<Option<_>>()?;
    let joint = |joint: usize| {
        let mut slips_m = all.iter().map(|sliding| sliding.offsets_m[joint]);
        Some(RepeatedValue::of(slips_m.next()?, slips_m))
    };
    (0..all[0].offsets_m.len()).map(joint).collect()
}

/// Returns the first half cycle before the largest rotation whose peak differs in a repetition by more than [`SAME_PEAK_RATIO`]. `None` for elastic
/// joints, for motions that stay far from overturning, and for incomplete histories.
fn early_difference(
    own: &Summary,
    repetition: &'static str,
    other: &Summary,
) -> Option<EarlyDifference> {
    let row = own.row()?;
    let is_clear = match Verdict::from(own.outcome) {
        Verdict::Overturns => false,
        Verdict::Incomplete => true,
        Verdict::Survives | Verdict::Uncertain => is_far(row.peak_potential_over_barrier),
    };
    if own.elastic().is_some() || is_clear {
        return None;
    }
    let others = &other.row()?.half_cycles;
    let cycles = own.half_cycles();
    let peaks_rad = cycles.iter().map(|cycle| cycle.peak_rad);
    let largest_rad = peaks_rad.fold(0.0, f64::max);
    let before = cycles
        .iter()
        .take_while(|cycle| cycle.peak_rad < largest_rad)
        .filter(|cycle| cycle.peak_rad >= LEAST_PEAK_RATIO * largest_rad);
    let mut differences = before.map(|cycle| {
        let ratio = cycle.counterpart(others).map_or(1.0, |other| {
            let [one_rad, other_rad] = [cycle.peak_rad, other.peak_rad];
            (one_rad - other_rad).abs() / one_rad.max(other_rad)
        });
        EarlyDifference {
            peak_time_s: cycle.peak_time_s,
            ratio,
            repetition,
        }
    });
    differences.find(|difference| difference.ratio > SAME_PEAK_RATIO)
}

/// Repetitions of a motion, computed on separate threads in parallel with the motion. If the motion itself fails, nobody waits for them, and they end
/// with the program.
#[derive(Debug)]
pub struct Repetitions(Vec<(&'static str, MotionThread)>);

/// Error if a repetition failed, so that the repeatability is unknown.
#[derive(Clone, Debug, Error)]
#[error("the repetition with {name} failed: {error}")]
pub struct RepeatabilityError {
    /// Name of the repetition.
    name: &'static str,
    /// Reason of the failure.
    error: SimulationError,
}

impl Repetitions {
    /// Starts all repetitions.
    #[must_use]
    pub fn start(model: &dyn Model, ground: &GroundMotion, request: &Request) -> Self {
        let start =
            |Repetition { name, model }| (name, MotionThread::start(model, ground, request));
        Self(model.repetitions().into_iter().map(start).collect())
    }

    /// Waits for all repetitions, and compares the motion with them.
    ///
    /// # Errors
    /// If a repetition failed.
    pub fn compare(self, own: &Summary) -> Result<Repeatability, RepeatabilityError> {
        let ended = |(name, running): (_, MotionThread)| match running.wait() {
            Ok(summary) => Ok((name, summary)),
            Err(error) => Err(RepeatabilityError { name, error }),
        };
        let repeated: Result<Vec<_>, _> = self.0.into_iter().map(ended).collect();
        Ok(Repeatability::new(own, &repeated?))
    }
}

named! {
    /// Verdict on whether a structure overturns.
    #[derive(PartialOrd, Ord)]
    pub enum Verdict {
        /// The structure survives.
        Survives = "survives",
        /// The history ends too early: [`Outcome::Incomplete`].
        Incomplete = "incomplete",
        /// The verdict depends on the numerical settings.
        Uncertain = "uncertain",
        /// The structure overturns.
        Overturns = "overturns",
    }
}

impl From<Outcome> for Verdict {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Overturned(_) => Self::Overturns,
            Outcome::Incomplete => Self::Incomplete,
            Outcome::NeverMoved | Outcome::Vibrates | Outcome::Rest | Outcome::StillRocking => {
                Self::Survives
            }
        }
    }
}

impl Verdict {
    fn words(self) -> String {
        match self {
            Self::Survives | Self::Overturns => self.name().to_owned(),
            Self::Incomplete | Self::Uncertain => format!("is {}", self.name()),
        }
    }
}

/// Returns the reason why a repetition makes the outcome of a history uncertain; `None` if it confirms the outcome.
pub fn objection(
    own: &Summary,
    name: &'static str,
    repeated: &Result<Summary, SimulationError>,
) -> Option<String> {
    let verdict = Verdict::from(own.outcome);
    let words = verdict.words();
    let repeated = match repeated {
        Ok(repeated) => repeated,
        Err(error) => return Some(format!("{words}; failed with {name}: {error}")),
    };
    let other = Verdict::from(repeated.outcome);
    if other != verdict {
        return Some(format!("{words}; {} with {name}", other.words()));
    }
    let early = early_difference(own, name, repeated)?;
    let (time_s, percent) = (early.peak_time_s, 100.0 * early.ratio);
    Some(format!(
        "{words}; the half cycle at {time_s:.4} s differs by {percent:.1} % with {name}"
    ))
}

/// History with the results that studies of many cases need.
pub struct CheckedHistory {
    /// Summary of the history.
    pub own: Result<Summary, SimulationError>,
    /// Time in seconds at which the history was ended early, because the structure cannot overturn and comes to rest in time; `None` for complete
    /// histories.
    pub safe_from_s: Option<f64>,
    /// Reason why the outcome is uncertain; `None` if it is certain.
    pub doubt: Option<String>,
}

/// Computes the histories of cases, in their order, with repetitions where these may change the verdict. Histories with the early end
/// [`EndCondition::Settled`] count as come to rest.
pub fn checked(model: &dyn Model, cases: &[Case], until: EndCondition) -> Vec<CheckedHistory> {
    let mut checks = Checks::new(model, cases);
    checks.settles = until == EndCondition::Settled;
    // Models without repetitions are faster up to the end: an early end needs samples.
    let repeats = !checks.names.is_empty();
    let until = if repeats { until } else { EndCondition::End };
    checks.waiting = (0..cases.len()).map(|case| Job::of(case, until)).collect();
    model.work(cases, &mut checks);
    checks.answers()
}

/// Repeats known histories of cases where repetitions may change the verdict. Returns them in the order of the cases.
pub fn repeated(
    model: &dyn Model,
    cases: &[Case],
    own: Vec<Result<Summary, SimulationError>>,
) -> Vec<CheckedHistory> {
    let mut checks = Checks::new(model, cases);
    for (case, own) in own.into_iter().enumerate() {
        checks.store_result(case, own);
    }
    model.work(cases, &mut checks);
    checks.answers()
}

/// Queue of histories to compute, with the results up to now.
struct Checks<'a> {
    model: &'a dyn Model,
    cases: &'a [Case],
    /// Names of the repetitions.
    names: Vec<&'static str>,
    waiting: VecDeque<Job>,
    /// True if histories that were ended early count as come to rest.
    settles: bool,
    own: Vec<Option<Result<Summary, SimulationError>>>,
    doubts: Vec<Option<String>>,
}

impl<'a> Checks<'a> {
    fn new(model: &'a dyn Model, cases: &'a [Case]) -> Self {
        let repetitions = model.repetitions().into_iter();
        Self {
            model,
            cases,
            names: repetitions.map(|repetition| repetition.name).collect(),
            waiting: VecDeque::new(),
            settles: false,
            own: cases.iter().map(|_| None).collect(),
            doubts: vec![None; cases.len()],
        }
    }

    /// Stores the history of a case, and queues its first repetition if that may change the verdict.
    fn store_result(&mut self, case: usize, own: Result<Summary, SimulationError>) {
        let (_, request) = &self.cases[case];
        let matters = |own: &Summary| !needs_no_repetition(self.model, request, own);
        if own.as_ref().is_ok_and(matters) {
            self.queue_repetition(case, 0);
        }
        self.own[case] = Some(own);
    }

    /// Queues a repetition, if there is one with this index. It goes to the front of the queue: the repetitions of a case follow each other, and at
    /// the end of the queue the last of them would run without other motions in parallel.
    fn queue_repetition(&mut self, case: usize, repetition: usize) {
        if repetition < self.names.len() {
            let job = Job::of(case, EndCondition::Safe);
            let repetition = Some(repetition);
            self.waiting.push_front(Job { repetition, ..job });
        }
    }

    fn answers(self) -> Vec<CheckedHistory> {
        let each = self.own.into_iter().zip(self.doubts).zip(self.cases);
        each.map(|((own, doubt), (_, request))| {
            let mut own = own.expect("every case was a job");
            let mut safe_from_s = None;
            if self.settles
                && let Ok(own) = &mut own
                && let Outcome::StillRocking | Outcome::Vibrates = own.outcome
                && own.end_s < request.end_s
            {
                safe_from_s = Some(own.end_s);
                if own.outcome == Outcome::StillRocking {
                    own.outcome = Outcome::Rest;
                }
            }
            CheckedHistory {
                own,
                safe_from_s,
                doubt,
            }
        })
        .collect()
    }
}

impl Jobs for Checks<'_> {
    fn next(&mut self) -> Option<Job> {
        self.waiting.pop_front()
    }

    fn ended(&mut self, job: Job, answer: Result<Summary, SimulationError>) {
        let case = job.case;
        let Some(repetition) = job.repetition else {
            return self.store_result(case, answer);
        };
        if let Some(Ok(own)) = &self.own[case] {
            self.doubts[case] = objection(own, self.names[repetition], &answer);
        }
        if self.doubts[case].is_none() {
            self.queue_repetition(case, repetition + 1);
        }
    }
}

/// Energy dissipated by slip and crushing, over the barrier, above which the barrier of elastic joints is no longer valid.
pub(super) const LARGEST_LOSS_RATIO: f64 = 0.01;

/// Largest energy, over the energy barrier of the first mechanism, below which survivors are not repeated.
const FAR_FROM_OVERTURNING: f64 = 0.5;

/// Returns whether repetitions can be skipped: the history is incomplete, the structure never moved, it overturned before its first change of side,
/// or it survived far from overturning. Up to the first change of side all settings agree.
fn needs_no_repetition(model: &dyn Model, request: &Request, own: &Summary) -> bool {
    match own.outcome {
        Outcome::NeverMoved | Outcome::Incomplete => true,
        Outcome::Overturned(_) => own.row().is_some_and(|row| row.half_cycles_with_fall <= 1),
        Outcome::Vibrates | Outcome::Rest | Outcome::StillRocking => {
            let ratio = match &own.details {
                Details::Mechanisms(_) => None,
                Details::Rigid(row) => row.peak_potential_over_barrier,
                // Elastic joints overturn below the barrier of rigid joints.
                Details::Elastic(row, elastic) => {
                    let barrier_j = model.elastic_barrier_j(request.gravity_m_s2);
                    let gone_j = elastic.friction_j + elastic.crushed_j;
                    let barrier_j =
                        barrier_j.filter(|barrier_j| gone_j < LARGEST_LOSS_RATIO * barrier_j);
                    barrier_j.map(|barrier_j| row.largest_potential_j / barrier_j)
                }
            };
            is_far(ratio)
        }
    }
}

/// Returns whether the ratio of the largest potential energy to the barrier is known and far below one.
fn is_far(ratio: Option<f64>) -> bool {
    ratio.is_some_and(|ratio| ratio < FAR_FROM_OVERTURNING)
}
