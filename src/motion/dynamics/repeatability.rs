//! Repeatability of a motion: its agreement with its repetitions, which have [other, equally valid numerical settings](Model::repetitions).
//!
//! The first two repetitions decide if they agree on the outcome and one of two conditions holds. Either all motions survive far below the barrier.
//! Or the path repeats, so all half cycles up to and including the largest agree, and a survivor does not come close to the barrier. Otherwise all
//! repetitions follow, and the verdict is their [count](OutcomeCount): **uncertain** if some overturn and others survive. The side of overturning, and
//! whether a survivor comes to rest, do not count. Motions whose outcome no later impact can change need no repetition (`needs_no_repetition`).
//!
//! docs/evidence.md has the shares of further histories that contradict this rule. Small changes of the ground motion as repetitions gave more uncertain
//! cases and no better verdicts.

use std::collections::VecDeque;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::model::{Case, Job, Jobs};
use super::until::EndCondition;
use super::variation::{PendingMotion, start_motion};
use crate::dynamics::{
    Details, Directions, GroundMotion, HalfCycle, Model, Outcome, Repetition, Request, RowSummary,
    SimulationError, Sliding, Summary,
};

/// Relative tolerance within which a peak is certain, and within which the half cycles of a path that repeats agree.
pub const SAME_PEAK_RATIO: f64 = 0.01;

/// Number of first repetitions, which decide alone if the path repeats. Models have six repetitions: with the motion itself, seven motions are
/// counted.
pub const FIRST_REPETITIONS: usize = 2;

/// Range of the repetitions, over [`SAME_PEAK_RATIO`], within which a peak is certain; other settings may differ more than the repetitions.
const AGREEMENT: f64 = 0.5;

/// Peak, over the largest peak, below which half cycles are not compared.
const LEAST_PEAK_RATIO: f64 = 1e-2;

/// Smallest slip that counts, in metres.
pub const LEAST_SLIP_M: f64 = 1e-6;

/// Count of a motion and its repetitions by outcome: the certainty of a verdict.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutcomeCount {
    /// Number of motions that overturn, among those with a verdict.
    pub overturns_in: usize,
    /// Number of motions with a verdict, including the motion itself.
    pub of: usize,
    /// True if the path repeats: all half cycles up to the largest agree within 1 % in the first two repetitions.
    pub path_repeats: bool,
    /// Names of the repetitions that end too early for a verdict; absent if all have one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub incomplete: Vec<String>,
    /// Names of the repetitions that failed, with the reasons; absent if none failed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failed: Vec<String>,
}

impl OutcomeCount {
    /// Counts a motion and its repetitions, given with their names.
    pub fn new<'a>(
        own: &Summary,
        repetitions: impl IntoIterator<Item = (&'static str, &'a Result<Summary, SimulationError>)>,
    ) -> Self {
        let mut count = Self {
            path_repeats: true,
            ..Self::default()
        };
        count.add("own", own.outcome);
        for (index, (name, repetition)) in repetitions.into_iter().enumerate() {
            match repetition {
                Ok(other) => {
                    count.add(name, other.outcome);
                    count.path_repeats &= index >= FIRST_REPETITIONS || path_repeats(own, other);
                }
                Err(error) => {
                    count.path_repeats &= index >= FIRST_REPETITIONS;
                    count.failed.push(format!("{name}: {error}"));
                }
            }
        }
        count
    }

    fn add(&mut self, name: &str, outcome: Outcome) {
        match Verdict::from(outcome) {
            Verdict::Incomplete => self.incomplete.push(name.to_owned()),
            verdict => {
                self.of += 1;
                self.overturns_in += usize::from(verdict == Verdict::Overturns);
            }
        }
    }

    /// Whether the verdict is uncertain: some motions overturn and others survive, or at most half of them have a verdict.
    pub const fn is_uncertain(&self) -> bool {
        let is_mixed = 0 < self.overturns_in && self.overturns_in < self.of;
        is_mixed || self.of <= self.incomplete.len() + self.failed.len()
    }

    /// Repetitions without a verdict, in words that follow the count; empty if all have one.
    pub fn without_verdict(&self) -> String {
        let named = |words: &str, names: &[String]| match names {
            [] => String::new(),
            names => format!("; {words} with {}", names.join(" and ")),
        };
        named("incomplete", &self.incomplete) + &named("failed", &self.failed)
    }
}

impl fmt::Display for OutcomeCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (overturns_in, of, others) = (self.overturns_in, self.of, self.without_verdict());
        write!(f, "overturns in {overturns_in} of {of} repetitions{others}")
    }
}

/// Motion compared with its repetitions: only results on which they agree are reliable.
///
/// After the first change of side, the motion depends on the order of almost simultaneous impacts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Repeatability {
    /// Count of the outcomes.
    #[serde(flatten)]
    pub count: OutcomeCount,
    /// Names of the repetitions that did not fail.
    #[serde(skip)]
    pub repeated: Vec<&'static str>,
    /// Outcome of the motion itself, then those of the repetitions.
    #[serde(skip)]
    pub outcomes: Vec<Outcome>,
    /// Half cycles of the motion itself with a peak of at least a hundredth of its largest peak, up to the earliest end of a repetition that was
    /// ended early.
    pub half_cycles: Vec<RepeatedHalfCycle>,
    /// Number of half cycles, from the first on, that are certain.
    pub same_until_half_cycle: usize,
    /// Start of the first half cycle that is not certain, in seconds; `None` if all are certain.
    pub parts_at_s: Option<f64>,
    /// Largest rotation of a block; `None` if one of the motions overturns.
    #[serde(rename = "largest_rotation_rad")]
    pub largest_rad: Option<RepeatedValue>,
    /// Slips of the joints at the end; empty without slip, and if one of the motions overturns.
    pub slips_m: Vec<RepeatedValue>,
    /// Largest slip of any joint at any time, in m; `None` without slip, and if one of the motions overturns.
    pub largest_slip_m: Option<RepeatedValue>,
    /// Energy dissipated by friction, in J; `None` without slip, and if one of the motions overturns.
    pub friction_j: Option<RepeatedValue>,
    /// Largest friction coefficient that the motion and its repetitions require without slip; `None` if joints slip or are elastic.
    #[serde(skip)]
    pub friction_demand: Option<f64>,
}

/// Largest friction coefficient that these motions require; `None` if joints slip or are elastic.
pub fn required_friction<'a>(motions: impl IntoIterator<Item = &'a Summary>) -> Option<f64> {
    let required = motions.into_iter().filter_map(Summary::required_friction);
    required.reduce(f64::max)
}

/// Name of a repetition as a key in results.
pub fn key(repetition: &str) -> String {
    repetition.replace(' ', "_")
}

/// Half cycle of a motion with its counterparts in the repetitions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RepeatedHalfCycle {
    /// Time of the peak in the motion itself, in seconds.
    pub peak_time_s: f64,
    /// Peaks in all motions, in radians; `None` if a repetition has no half cycle to the same side at that time.
    pub peak_rad: Option<RepeatedValue>,
}

impl RepeatedHalfCycle {
    /// Whether the peak is certain.
    pub fn is_certain(&self) -> bool {
        self.peak_rad.is_some_and(|peak| peak.is_certain())
    }
}

/// Value of a quantity in a motion, and its range in the motion and all repetitions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RepeatedValue {
    /// Value in the motion itself.
    pub own: f64,
    /// Least value of all.
    pub min: f64,
    /// Largest value of all.
    pub max: f64,
}

impl RepeatedValue {
    /// Range of a value of the motion itself and of its repetitions.
    fn of(own: f64, others: impl IntoIterator<Item = f64>) -> Self {
        let (mut min, mut max) = (own, own);
        for other in others {
            (min, max) = (min.min(other), max.max(other));
        }
        Self { own, min, max }
    }

    /// Whether the value is certain to [`SAME_PEAK_RATIO`].
    pub fn is_certain(&self) -> bool {
        self.max - self.min <= AGREEMENT * SAME_PEAK_RATIO * self.max
    }
}

impl Repeatability {
    /// Compares a motion of a row with its repetitions, given with their names.
    pub fn new(own: &Summary, repetitions: &[NamedResult]) -> Self {
        let named = || repetitions.iter().map(|(name, other)| (*name, other));
        let computed = named().filter_map(|(name, other)| Some((name, other.as_ref().ok()?)));
        let (repeated, others): (Vec<_>, Vec<&Summary>) = computed.unzip();
        let runs: Vec<&Summary> = [&[own], &others[..]].concat();
        let mut cycles = own.half_cycles();
        let peaks_rad = cycles.iter().map(|cycle| cycle.peak_rad);
        let least_rad = LEAST_PEAK_RATIO * peaks_rad.fold(0.0, f64::max);
        cycles.retain(|cycle| cycle.peak_rad >= least_rad);
        let rows = others.iter().map(|other| other.row());
        let joined = rows.map(|row| row.map_or_else(Vec::new, RowSummary::joined_half_cycles));
        let others_cycles: Vec<_> = joined.collect();
        let beside = |own: HalfCycle| {
            let peak_rad = |other: &Vec<HalfCycle>| Some(own.counterpart(other)?.peak_rad);
            let peaks_rad: Option<Vec<f64>> = others_cycles.iter().map(peak_rad).collect();
            let peak_rad = peaks_rad.map(|peaks_rad| RepeatedValue::of(own.peak_rad, peaks_rad));
            RepeatedHalfCycle {
                peak_time_s: own.peak_time_s,
                peak_rad,
            }
        };
        // A repetition that was ended early lacks the last half cycles.
        let cuts_s = others.iter().filter(|other| other.is_cut);
        let until_s = cuts_s.fold(f64::INFINITY, |until_s, other| until_s.min(other.end_s));
        cycles.retain(|cycle| cycle.start_s + cycle.duration_s < until_s);
        let half_cycles: Vec<_> = cycles.iter().copied().map(beside).collect();
        let differs = |cycle: &RepeatedHalfCycle| !cycle.is_certain();
        let parts = half_cycles.iter().position(differs);
        let all_stand = runs.iter().all(|run| run.overturned_s().is_none());
        let largest_rad = || {
            let others_rad = others.iter().map(|other| other.largest_rotation_rad());
            RepeatedValue::of(own.largest_rotation_rad(), others_rad)
        };
        let slips_m = all_stand.then(|| slips_m(&runs)).flatten();
        Self {
            count: OutcomeCount::new(own, named()),
            repeated,
            outcomes: runs.iter().map(|run| run.outcome).collect(),
            same_until_half_cycle: parts.unwrap_or(half_cycles.len()),
            parts_at_s: parts.map(|parts| cycles[parts].start_s),
            half_cycles,
            largest_rad: all_stand.then(largest_rad),
            slips_m: slips_m.unwrap_or_default(),
            largest_slip_m: all_stand
                .then(|| repeated_slip(&runs, Sliding::largest_m))
                .flatten(),
            friction_j: all_stand
                .then(|| repeated_slip(&runs, |sliding| sliding.friction_j))
                .flatten(),
            friction_demand: required_friction(runs),
        }
    }

    /// Whether any joint has slipped at the end.
    pub fn has_slipped(&self) -> bool {
        self.most_slip_m() > LEAST_SLIP_M
    }

    fn most_slip_m(&self) -> f64 {
        let ends_m = self.slips_m.iter().flat_map(|slip| [slip.min, slip.max]);
        ends_m.fold(0.0, |most_m, end_m| most_m.max(end_m.abs()))
    }

    /// Joint whose final slips differ most, if they are not certain to [`SAME_PEAK_RATIO`] of the largest slip of any joint; `None` if
    /// all are certain.
    pub fn uncertain_slip(&self) -> Option<usize> {
        let range_m = |joint: &usize| self.slips_m[*joint].max - self.slips_m[*joint].min;
        let joints = 0..self.slips_m.len();
        let worst = joints.max_by(|one, other| range_m(one).total_cmp(&range_m(other)));
        let same_m = AGREEMENT * SAME_PEAK_RATIO * self.most_slip_m();
        worst.filter(|joint| self.has_slipped() && range_m(joint) > same_m)
    }
}

/// Quantity of the slip in all these motions; `None` if joints do not slip.
fn repeated_slip(runs: &[&Summary], value: impl Fn(&Sliding) -> f64) -> Option<RepeatedValue> {
    let values: Vec<f64> = runs
        .iter()
        .map(|run| Some(value(run.row()?.sliding.as_ref()?)))
        .collect::<Option<_>>()?;
    let (own, others) = values.split_first()?;
    Some(RepeatedValue::of(*own, others.iter().copied()))
}

/// Final slips of the joints in all these motions; `None` if joints do not slip.
fn slips_m(runs: &[&Summary]) -> Option<Vec<RepeatedValue>> {
    let slipped = runs.iter().map(|run| run.row()?.sliding.as_ref());
    let all: Vec<_> = slipped.collect::<Option<_>>()?;
    let joint = |joint: usize| {
        let mut slips_m = all.iter().map(|sliding| sliding.offsets_m[joint]);
        Some(RepeatedValue::of(slips_m.next()?, slips_m))
    };
    (0..all[0].offsets_m.len()).map(joint).collect()
}

/// Whether two motions follow the same path: the half cycles of each, up to its largest, have counterparts in the other with the same peaks.
/// The fall of a motion that overturns does not count.
fn path_repeats(one: &Summary, other: &Summary) -> bool {
    one.outcome.overturning_sway() == other.outcome.overturning_sway()
        && has_same_half_cycles(one, other)
        && has_same_half_cycles(other, one)
}

/// Whether the half cycles of a motion up to its largest have counterparts with the same peaks in another motion.
fn has_same_half_cycles(own: &Summary, other: &Summary) -> bool {
    let others = other.row().map_or(&[][..], |row| &row.half_cycles);
    let cycles = own.row().map_or(&[][..], |row| &row.half_cycles);
    let peaks_rad = cycles.iter().map(|cycle| cycle.peak_rad);
    let largest_rad = peaks_rad.fold(0.0, f64::max);
    let largest = cycles.iter().position(|one| one.peak_rad == largest_rad);
    let until = match own.outcome {
        Outcome::Overturned(_) => cycles.len().saturating_sub(1),
        _ => largest.map_or(0, |largest| largest + 1),
    };
    let mut compared = cycles[..until]
        .iter()
        .filter(|cycle| cycle.peak_rad >= LEAST_PEAK_RATIO * largest_rad);
    compared.all(|cycle| {
        cycle.counterpart(others).is_some_and(|other| {
            let [one_rad, other_rad] = [cycle.peak_rad, other.peak_rad];
            (one_rad - other_rad).abs() <= SAME_PEAK_RATIO * one_rad.max(other_rad)
        })
    })
}

/// A repetition with its name.
pub type NamedResult = (&'static str, Result<Summary, SimulationError>);

/// Repetitions of a motion, computed in parallel with the motion. If the motion itself fails, nobody waits for them, and they end with the program.
pub struct Repetitions<'a> {
    model: &'a dyn Model,
    ground: &'a GroundMotion,
    request: &'a Request,
    first: Vec<(&'static str, PendingMotion)>,
    others: Vec<Repetition>,
}

impl<'a> Repetitions<'a> {
    /// Starts the first repetitions.
    pub fn start(model: &'a dyn Model, ground: &'a GroundMotion, request: &'a Request) -> Self {
        let mut first = model.repetitions();
        let others = first.split_off(FIRST_REPETITIONS.min(first.len()));
        Self {
            model,
            ground,
            request,
            first: start_repetitions(first, ground, request),
            others,
        }
    }

    /// Waits for the repetitions, computes all others if the first ones do not suffice, and compares the motion with them.
    pub fn compare(self, own: &Summary) -> Repeatability {
        let ended = |(name, running): (_, PendingMotion)| (name, running.wait());
        let mut repeated: Vec<_> = self.first.into_iter().map(ended).collect();
        let first = repeated.iter().map(|(_, result)| result);
        if !repetitions_suffice(self.model, self.request, own, first) {
            let others = start_repetitions(self.others, self.ground, self.request);
            repeated.extend(others.into_iter().map(ended));
        }
        Repeatability::new(own, &repeated)
    }
}

fn start_repetitions(
    repetitions: Vec<Repetition>,
    ground: &GroundMotion,
    request: &Request,
) -> Vec<(&'static str, PendingMotion)> {
    let case = (ground, request);
    let start = |Repetition { name, model }| {
        let motion = start_motion(model, EndCondition::Calm, case);
        (name, motion)
    };
    repetitions.into_iter().map(start).collect()
}

/// Whether the first repetitions of a motion decide on its verdict, or no repetition can give one.
fn repetitions_suffice<'a>(
    model: &dyn Model,
    request: &Request,
    own: &Summary,
    first: impl IntoIterator<Item = &'a Result<Summary, SimulationError>>,
) -> bool {
    let verdict = Verdict::from(own.outcome);
    let is_clear = |motion: &Summary| needs_no_repetition(model, request, motion);
    let is_close = verdict == Verdict::Survives
        && energy_over_barrier(model, request, own).is_some_and(|ratio| ratio > CLOSE_TO_BARRIER);
    let confirms = |other: &Summary| {
        let repeats = || !is_close && path_repeats(own, other);
        Verdict::from(other.outcome) == verdict && (is_clear(own) && is_clear(other) || repeats())
    };
    let mut first = first.into_iter();
    verdict == Verdict::Incomplete || first.all(|other| other.as_ref().is_ok_and(confirms))
}

named! {
    /// Verdict on whether a structure overturns.
    #[derive(PartialOrd, Ord)]
    #[non_exhaustive]
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
    /// Verdict on a motion with this outcome, uncertain if the count of its repetitions says so.
    pub fn counted(outcome: Outcome, count: Option<&OutcomeCount>) -> Self {
        match Self::from(outcome) {
            Self::Incomplete => Self::Incomplete,
            _ if count.is_some_and(OutcomeCount::is_uncertain) => Self::Uncertain,
            own => own,
        }
    }
}

/// History with the results that studies of many cases need.
pub struct CheckedHistory {
    /// Summary of the history.
    pub own: Result<Summary, SimulationError>,
    /// Count of the outcomes of the history and its repetitions; `None` without repetitions.
    pub count: Option<OutcomeCount>,
    /// Largest friction coefficient that the history and its repetitions require without slip; `None` if joints slip or are elastic, or if there is
    /// no history.
    pub friction_demand: Option<f64>,
}

/// Computes the histories of cases, in their order, with repetitions where these may change the verdict.
pub fn checked(model: &dyn Model, cases: &[Case], until: EndCondition) -> Vec<CheckedHistory> {
    let mut checks = Checks::new(model, cases);
    checks.compute(until, cases.len());
    checks.answers().into_iter().flatten().collect()
}

/// History of a case, and the history under its mirrored ground motion.
pub struct CheckedDirections {
    /// History as given.
    pub own: CheckedHistory,
    /// History under the mirrored ground motion; `None` if the case has no [second direction](Directions::has_second), or if the history as given
    /// decides, because it certainly overturns, or has no verdict.
    pub mirrored: Option<CheckedHistory>,
}

/// Computes the histories of cases in all their directions, in their order, as [`checked`] does. The mirrored history of a case follows as soon as the
/// history as given survives or is uncertain, in the same queue, so that models that compute several motions in parallel stay busy.
pub fn checked_in(
    directions: Directions,
    model: &dyn Model,
    cases: &[Case],
    until: EndCondition,
) -> Vec<CheckedDirections> {
    let mut all = Vec::new();
    let mut mirrored_cases = vec![None; cases.len()];
    for (case, (ground, request)) in cases.iter().enumerate() {
        if directions.has_second(model, ground, request) {
            mirrored_cases[case] = Some(cases.len() + all.len());
            all.push((ground.mirrored(), *request));
        }
    }
    if !all.is_empty() {
        all.splice(0..0, cases.iter().cloned());
    }
    let mut checks = Checks::new(model, if all.is_empty() { cases } else { &all });
    checks.mirrored_cases.clone_from(&mirrored_cases);
    checks.compute(until, cases.len());
    let mut answers = checks.answers();
    let mirrored: Vec<_> = mirrored_cases
        .into_iter()
        .map(|case| answers[case?].take())
        .collect();
    let own = answers.into_iter().flatten();
    let both = own.zip(mirrored);
    both.map(|(own, mirrored)| CheckedDirections { own, mirrored })
        .collect()
}

/// Repeats known histories of cases where repetitions may change the verdict. Returns them in the order of the cases.
pub fn repeat_cases(
    model: &dyn Model,
    cases: &[Case],
    own: Vec<Result<Summary, SimulationError>>,
) -> Vec<CheckedHistory> {
    let mut checks = Checks::new(model, cases);
    for (case, own) in own.into_iter().enumerate() {
        checks.store_result(case, own);
    }
    model.work(cases, &mut checks);
    checks.answers().into_iter().flatten().collect()
}

/// Queue of histories to compute, with the results up to now.
struct Checks<'a> {
    model: &'a dyn Model,
    cases: &'a [Case],
    /// Names of the repetitions.
    repetitions: Vec<&'static str>,
    waiting: VecDeque<Job>,
    /// Early end of the histories of the cases; their repetitions end as soon as the outcome is known.
    until: EndCondition,
    /// For each case the index of its mirrored case, which follows if the case survives or is uncertain.
    mirrored_cases: Vec<Option<usize>>,
    results: Vec<CaseResults>,
}

/// Results of a case.
#[derive(Default)]
struct CaseResults {
    own: Option<Result<Summary, SimulationError>>,
    /// Known results of the repetitions, in their order; empty again once they are counted.
    repeated: Vec<Option<Result<Summary, SimulationError>>>,
    count: Option<OutcomeCount>,
    /// Largest friction coefficient that the counted repetitions require.
    friction_demand: Option<f64>,
}

impl<'a> Checks<'a> {
    fn new(model: &'a dyn Model, cases: &'a [Case]) -> Self {
        let repetitions = model.repetitions().into_iter();
        Self {
            model,
            cases,
            repetitions: repetitions.map(|repetition| repetition.name).collect(),
            waiting: VecDeque::new(),
            until: EndCondition::End,
            mirrored_cases: Vec::new(),
            results: cases.iter().map(|_| CaseResults::default()).collect(),
        }
    }

    /// Computes the first `count` cases, with the early end `until`.
    fn compute(&mut self, until: EndCondition, count: usize) {
        // Models without repetitions are faster up to the end: an early end needs samples.
        if !self.repetitions.is_empty() {
            self.until = until;
        }
        self.waiting = (0..count).map(|case| Job::of(case, self.until)).collect();
        let (model, cases) = (self.model, self.cases);
        model.work(cases, self);
    }

    /// Stores the history of a case, and queues its first repetitions if they may change the verdict.
    fn store_result(&mut self, case: usize, own: Result<Summary, SimulationError>) {
        let (_, request) = &self.cases[case];
        let matters = |own: &Summary| !needs_no_repetition(self.model, request, own);
        if own.as_ref().is_ok_and(matters) {
            self.queue_repetitions(case, FIRST_REPETITIONS);
        }
        self.results[case].own = Some(own);
        if self.results[case].repeated.is_empty() {
            self.queue_mirrored(case);
        }
    }

    /// Queues the mirrored case of a case whose verdict is known and does not decide. It goes to the front of the queue, as repetitions do.
    fn queue_mirrored(&mut self, case: usize) {
        let CaseResults { own, count, .. } = &self.results[case];
        let Some(Ok(own)) = own else { return };
        let verdict = Verdict::counted(own.outcome, count.as_ref());
        if let Verdict::Survives | Verdict::Uncertain = verdict
            && let Some(Some(mirrored)) = self.mirrored_cases.get(case)
        {
            self.waiting.push_front(Job::of(*mirrored, self.until));
        }
    }

    /// Queues the repetitions of a case up to this number. They go to the front of the queue: the repetitions of a case follow each other, and at
    /// the end of the queue the last of them would run without other motions in parallel.
    fn queue_repetitions(&mut self, case: usize, until: usize) {
        let job = Job::of(case, EndCondition::Safe);
        let repeated = &mut self.results[case].repeated;
        let queued = repeated.len()..until.min(self.repetitions.len());
        for repetition in queued.rev() {
            let repetition = Some(repetition);
            repeated.push(None);
            self.waiting.push_front(Job { repetition, ..job });
        }
    }

    /// Stores a repetition of a case. After the last of those queued, queues the others or counts the outcomes.
    fn store_repetition(
        &mut self,
        case: usize,
        repetition: usize,
        answer: Result<Summary, SimulationError>,
    ) {
        let results = &mut self.results[case];
        results.repeated[repetition] = Some(answer);
        let known = results.repeated.iter().flatten();
        let Some(Ok(own)) = &results.own else { return };
        if known.clone().count() < results.repeated.len() {
            return;
        }
        let (all, request) = (self.repetitions.len(), &self.cases[case].1);
        if results.repeated.len() == all
            || repetitions_suffice(self.model, request, own, known.clone())
        {
            let named = self.repetitions.iter().copied().zip(known.clone());
            results.count = Some(OutcomeCount::new(own, named));
            results.friction_demand = required_friction(known.flatten());
            results.repeated = Vec::new();
            self.queue_mirrored(case);
        } else {
            self.queue_repetitions(case, all);
        }
    }

    /// Results of all cases; `None` for mirrored cases that were not computed.
    fn answers(self) -> Vec<Option<CheckedHistory>> {
        let each = self.results.into_iter();
        each.map(|results| {
            let own = results.own?;
            let own_demand = own.as_ref().ok().and_then(Summary::required_friction);
            Some(CheckedHistory {
                own,
                count: results.count,
                friction_demand: own_demand
                    .into_iter()
                    .chain(results.friction_demand)
                    .reduce(f64::max),
            })
        })
        .collect()
    }
}

impl Jobs for Checks<'_> {
    fn next_job(&mut self) -> Option<Job> {
        self.waiting.pop_front()
    }

    fn receive_result(&mut self, job: Job, answer: Result<Summary, SimulationError>) {
        match job.repetition {
            None => self.store_result(job.case, answer),
            Some(repetition) => self.store_repetition(job.case, repetition, answer),
        }
    }
}

/// Energy dissipated by slip and crushing, over the barrier, above which the barrier of elastic joints is no longer valid.
pub(super) const LARGEST_LOSS_RATIO: f64 = 0.01;

/// Largest energy, over the energy barrier of the first mechanism, below which a survivor is certain without a repetition of its path.
const FAR_FROM_OVERTURNING: f64 = 0.5;
/// [`FAR_FROM_OVERTURNING`] of elastic joints. Under records, survivors between a third and half of the barrier overturned with other steps.
const ELASTIC_FAR_FROM_OVERTURNING: f64 = 0.25;

/// Largest energy, over the same barrier, above which a survivor is certain only with all repetitions, although its path repeats.
const CLOSE_TO_BARRIER: f64 = 0.8;

/// Whether repetitions can be skipped: the history is incomplete, the structure never moved, it overturned before its first change of side,
/// or it survived far from overturning. Up to the first change of side all settings agree.
fn needs_no_repetition(model: &dyn Model, request: &Request, own: &Summary) -> bool {
    match own.outcome {
        Outcome::NeverMoved | Outcome::Incomplete => true,
        Outcome::Overturned(_) => own.row().is_some_and(|row| row.half_cycles_with_fall <= 1),
        Outcome::Vibrates | Outcome::Rest | Outcome::StillRocking => {
            let far = match own.details {
                Details::Elastic(..) => ELASTIC_FAR_FROM_OVERTURNING,
                _ => FAR_FROM_OVERTURNING,
            };
            energy_over_barrier(model, request, own).is_some_and(|ratio| ratio < far)
        }
    }
}

/// Largest potential energy of a motion over the energy barrier of the first mechanism; `None` if the barrier is not known.
pub fn energy_over_barrier(model: &dyn Model, request: &Request, own: &Summary) -> Option<f64> {
    match &own.details {
        Details::Mechanisms(_) => None,
        Details::Rigid(row) => row.peak_potential_over_barrier,
        // Elastic joints overturn below the barrier of rigid joints.
        Details::Elastic(row, elastic) => {
            let barrier_j = model.elastic_barrier_j(request.gravity_m_s2)?;
            let gone_j = elastic.friction_j + elastic.crushed_j;
            (gone_j < LARGEST_LOSS_RATIO * barrier_j).then_some(row.largest_potential_j / barrier_j)
        }
    }
}
