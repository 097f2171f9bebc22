//! The repeatability of a motion: its agreement with its repetitions, [equally good ways to compute it](Model::repetitions).
//!
//! If these disagree on whether it overturns, that is **uncertain**: neither overturned nor survived. The side to which it overturns,
//! and whether a survivor has come to rest, do not count. For this question most repetitions can be spared: those of motions that
//! nothing after an impact decides (`is_plain`). With rigid joints, a motion that comes near overturning is uncertain as well if a
//! repetition differs before the largest rotation: then still other steps may end otherwise ([`EarlyDifference`]).

use std::collections::VecDeque;

use serde::{Serialize, Serializer};
use thiserror::Error;

use super::ground::GroundMotion;
use super::history::{Details, HalfCycle, Outcome, Summary};
use super::model::{Case, Job, Jobs, Model, Repetition, Request, SimulationError};
use super::until::Until;
use super::variation::Running;

/// Peaks are called certain to within this fraction of them.
pub const SAME_PEAK_RATIO: f64 = 0.01;

/// The repetitions must agree to this fraction of that, because still other ways to compute the motion may differ by more.
const AGREEMENT: f64 = 0.5;

/// Half cycles that peak below this fraction of the largest peak are not compared.
const LEAST_PEAK_RATIO: f64 = 1e-2;

/// Slips below this, in metres, are none.
const LEAST_SLIP_M: f64 = 1e-6;

/// A motion beside its repetitions: only results on which they agree are reliable.
///
/// After the first change of side, the order of impacts that almost coincide decides the rest of the motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Repeatability {
    /// The settings of the repetitions.
    #[serde(skip)]
    pub repeated: Vec<&'static str>,
    /// Outcomes of the motion itself, then of the repetitions.
    #[serde(skip)]
    pub outcomes: Vec<Outcome>,
    /// The half cycles of the motion itself that peak at a hundredth of its largest peak or more.
    pub half_cycles: Vec<RepeatedHalfCycle>,
    /// Number of these, from the first on, that are certain.
    pub same_until_half_cycle: usize,
    /// When the first of these that differs begins, in seconds; `None` where none differs.
    pub parts_at_s: Option<f64>,
    /// The largest rotation of a block; `None` if one of the motions overturns.
    #[serde(rename = "largest_rotation_rad")]
    pub largest_rad: Option<RepeatedValue>,
    /// The first difference that makes the outcome of a row with rigid joints uncertain.
    #[serde(rename = "early_difference")]
    pub early: Option<EarlyDifference>,
    /// Slips of the joints at the end; empty if one of the motions overturns, and without slip.
    pub slips_m: Vec<RepeatedValue>,
}

/// A half cycle before the largest rotation that differs by more than [`SAME_PEAK_RATIO`] in a repetition.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EarlyDifference {
    /// When it peaks, in seconds.
    pub peak_time_s: f64,
    /// Its difference as a fraction of the larger peak; 1 where the repetition has no half cycle to the same side at that time.
    pub ratio: f64,
    /// The repetition.
    #[serde(serialize_with = "as_key")]
    pub repetition: &'static str,
}

/// The name of a repetition as a key in results.
#[must_use]
pub fn key(repetition: &str) -> String {
    repetition.replace(' ', "_")
}

fn as_key<S: Serializer>(repetition: &str, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&key(repetition))
}

/// A half cycle of a motion beside its counterparts in the repetitions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RepeatedHalfCycle {
    /// The half cycle of the motion itself; in results, the time of its peak, in seconds.
    #[serde(rename = "peak_time_s", serialize_with = "peak_time")]
    pub own: HalfCycle,
    /// Its peak in all motions; `None` if a repetition has no half cycle to the same side at that time.
    pub peak_rad: Option<RepeatedValue>,
}

fn peak_time<S: Serializer>(cycle: &HalfCycle, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(cycle.peak_time_s)
}

impl RepeatedHalfCycle {
    /// Whether its peak is certain.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.peak_rad.is_some_and(|peak| peak.is_certain())
    }
}

/// A quantity of a motion beside that of its repetitions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RepeatedValue {
    /// In the motion itself.
    pub own: f64,
    /// The least of all.
    pub min: f64,
    /// The largest of all.
    pub max: f64,
}

impl RepeatedValue {
    /// The range of the value in the motion itself and of those in its repetitions.
    fn of(own: f64, others: impl IntoIterator<Item = f64>) -> Self {
        let range = Self {
            own,
            min: own,
            max: own,
        };
        others.into_iter().fold(range, |range, other| Self {
            min: range.min.min(other),
            max: range.max.max(other),
            ..range
        })
    }

    /// Whether all peaks agree so well that they are certain to [`SAME_PEAK_RATIO`].
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

    /// Whether the outcome is uncertain: a repetition ends otherwise, or differs too early.
    #[must_use]
    pub fn is_uncertain(&self) -> bool {
        let mut verdicts = self.outcomes.iter().map(|outcome| Verdict::from(*outcome));
        let own = verdicts.next();
        self.early.is_some() || verdicts.any(|other| Some(other) != own)
    }

    /// Whether some joint has slipped in the end.
    #[must_use]
    pub fn has_slipped(&self) -> bool {
        self.most_slip_m() > LEAST_SLIP_M
    }

    fn most_slip_m(&self) -> f64 {
        let ends_m = self.slips_m.iter().flat_map(|slip| [slip.min, slip.max]);
        ends_m.fold(0.0, |most_m, end_m| most_m.max(end_m.abs()))
    }

    /// The joint whose slips at the end differ most, if they differ so much that they are not certain to [`SAME_PEAK_RATIO`] of the
    /// largest slip of any joint.
    #[must_use]
    pub fn uncertain_slip(&self) -> Option<usize> {
        let range_m = |joint: &usize| self.slips_m[*joint].max - self.slips_m[*joint].min;
        let joints = 0..self.slips_m.len();
        let worst = joints.max_by(|one, other| range_m(one).total_cmp(&range_m(other)));
        let same_m = AGREEMENT * SAME_PEAK_RATIO * self.most_slip_m();
        worst.filter(|joint| self.has_slipped() && range_m(joint) > same_m)
    }

    /// Whether all ended alike, to the same side if they overturned.
    #[must_use]
    pub fn same_outcome(&self) -> bool {
        self.outcomes.iter().all(|other| *other == self.outcomes[0])
    }
}

/// Slips of the joints at the end of all these motions; `None` where joints do not slip.
fn slips_m(runs: &[&Summary]) -> Option<Vec<RepeatedValue>> {
    let slipped = runs.iter().map(|run| run.row()?.sliding.as_ref());
    let all: Vec<_> = slipped.collect::<Option<_>>()?;
    let joint = |joint: usize| {
        let mut slips_m = all.iter().map(|sliding| sliding.offsets_m[joint]);
        Some(RepeatedValue::of(slips_m.next()?, slips_m))
    };
    (0..all[0].offsets_m.len()).map(joint).collect()
}

/// The first half cycle before the largest rotation whose peak differs in a repetition by more than [`SAME_PEAK_RATIO`]. `None` for
/// elastic joints, for motions that are known to stay far from overturning, and for those that ended too early for any verdict.
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

/// The repetitions of a motion, computed on threads of their own beside it. If the motion itself fails nobody waits for them: they
/// end with the program.
#[derive(Debug)]
pub struct Repetitions(Vec<(&'static str, Running)>);

/// A repetition failed, so the repeatability is unknown.
#[derive(Clone, Debug, Error)]
#[error("the repetition with {name} failed: {error}")]
pub struct RepeatabilityError {
    /// The repetition.
    name: &'static str,
    /// The reason.
    error: SimulationError,
}

impl Repetitions {
    /// Starts them.
    #[must_use]
    pub fn start(model: &dyn Model, ground: &GroundMotion, request: &Request) -> Self {
        let start = |Repetition { name, model }| (name, Running::start(model, ground, request));
        Self(model.repetitions().into_iter().map(start).collect())
    }

    /// Waits for them, and compares the motion with them.
    ///
    /// # Errors
    /// When one of them failed.
    pub fn compare(self, own: &Summary) -> Result<Repeatability, RepeatabilityError> {
        let ended = |(name, running): (_, Running)| match running.ended() {
            Ok(summary) => Ok((name, summary)),
            Err(error) => Err(RepeatabilityError { name, error }),
        };
        let repeated: Result<Vec<_>, _> = self.0.into_iter().map(ended).collect();
        Ok(Repeatability::new(own, &repeated?))
    }
}

named! {
    /// Whether a structure overturns, as far as that is known.
    #[derive(PartialOrd, Ord)]
    pub enum Verdict {
        /// The structure survives.
        Survives = "survives",
        /// The history ended too early: [`Outcome::Incomplete`].
        Incomplete = "incomplete",
        /// That depends on how it is computed.
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

/// Why a repetition makes the outcome of a history uncertain; `None` if it confirms it.
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

/// A history with what studies of many cases ask of it.
pub struct Checked {
    /// The history.
    pub own: Result<Summary, SimulationError>,
    /// When it was ended, in seconds, since it cannot overturn any more and comes to rest in time; `None` where it was followed to its end.
    pub safe_from_s: Option<f64>,
    /// Why it is uncertain whether it overturns, if it is.
    pub doubt: Option<String>,
}

/// Histories of cases, in their order, repeated where that may matter. Those followed until they have settled count as come to rest.
pub fn checked(model: &dyn Model, cases: &[Case], until: Until) -> Vec<Checked> {
    let mut checks = Checks::new(model, cases);
    checks.settles = until == Until::Settled;
    // If the result does not depend on how it is computed, the fast way serves.
    let repeats = !checks.names.is_empty();
    let until = if repeats { until } else { Until::End };
    checks.waiting = (0..cases.len()).map(|case| Job::of(case, until)).collect();
    model.work(cases, &mut checks);
    checks.answers()
}

/// Histories of cases that are known already, in their order, repeated where that may matter.
pub fn repeated(
    model: &dyn Model,
    cases: &[Case],
    own: Vec<Result<Summary, SimulationError>>,
) -> Vec<Checked> {
    let mut checks = Checks::new(model, cases);
    for (case, own) in own.into_iter().enumerate() {
        checks.keep(case, own);
    }
    model.work(cases, &mut checks);
    checks.answers()
}

/// The histories that are still to be computed, and the answers so far.
struct Checks<'a> {
    model: &'a dyn Model,
    cases: &'a [Case],
    /// Names of the repetitions.
    names: Vec<&'static str>,
    waiting: VecDeque<Job>,
    /// Whether histories that were ended early count as come to rest.
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

    /// Keeps the history of a case, and queues its first repetition if that may matter.
    fn keep(&mut self, case: usize, own: Result<Summary, SimulationError>) {
        let (_, request) = &self.cases[case];
        let matters = |own: &Summary| !is_plain(self.model, request, own);
        if own.as_ref().is_ok_and(matters) {
            self.repeat(case, 0);
        }
        self.own[case] = Some(own);
    }

    /// Queues a repetition, if there is another one. It goes to the front of the queue: the repetitions of a case come one after the
    /// other, and left to the end the last of them would run with nothing beside it.
    fn repeat(&mut self, case: usize, repetition: usize) {
        if repetition < self.names.len() {
            let job = Job::of(case, Until::Safe);
            let repetition = Some(repetition);
            self.waiting.push_front(Job { repetition, ..job });
        }
    }

    fn answers(self) -> Vec<Checked> {
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
            Checked {
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
            return self.keep(case, answer);
        };
        if let Some(Ok(own)) = &self.own[case] {
            self.doubts[case] = objection(own, self.names[repetition], &answer);
        }
        if self.doubts[case].is_none() {
            self.repeat(case, repetition + 1);
        }
    }
}

/// If slip and crushing took more than this fraction of the barrier, elastic joints no longer lie as they did when it was found.
pub(super) const GONE: f64 = 0.01;

/// A survivor that never reached this fraction of the energy barrier of its first mechanism is not repeated.
const FAR_FROM_OVERTURNING: f64 = 0.5;

/// Whether repetitions can be spared: the history is incomplete, the structure never moved, it overturned before its first change of side, up to which
/// all ways agree, or it survived far from overturning.
fn is_plain(model: &dyn Model, request: &Request, own: &Summary) -> bool {
    match own.outcome {
        Outcome::NeverMoved | Outcome::Incomplete => true,
        Outcome::Overturned(_) => own.row().is_some_and(|row| row.half_cycles_with_fall <= 1),
        Outcome::Vibrates | Outcome::Rest | Outcome::StillRocking => {
            let ratio = match &own.details {
                Details::Mechanisms { .. } => None,
                Details::Rigid(row) => row.peak_potential_over_barrier,
                // Elastic joints overturn below the barrier of rigid joints.
                Details::Elastic(row, elastic) => {
                    let barrier_j = model.elastic_barrier_j(request.gravity_m_s2);
                    let gone_j = elastic.friction_j + elastic.crushed_j;
                    let barrier_j = barrier_j.filter(|barrier_j| gone_j < GONE * barrier_j);
                    barrier_j.map(|barrier_j| row.largest_potential_j / barrier_j)
                }
            };
            is_far(ratio)
        }
    }
}

/// Whether the largest potential energy over the barrier is known, and far from it.
fn is_far(ratio: Option<f64>) -> bool {
    ratio.is_some_and(|ratio| ratio < FAR_FROM_OVERTURNING)
}
