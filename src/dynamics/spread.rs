//! How certain a motion is: what it shares with its repetitions, [equally good ways to compute it](Model::repetitions).
//!
//! If these disagree on whether it overturns, that is **uncertain**: neither overturned nor survived. The side to which it overturns,
//! and whether a survivor has come to rest, do not count. For this question most repetitions can be spared: those of motions that
//! nothing after an impact decides (`is_plain`).

use std::ops::ControlFlow;
use std::thread::{self, JoinHandle};

use thiserror::Error;

use super::ground::GroundMotion;
use super::history::{HalfCycle, Outcome, Sample, State, Summary};
use super::model::{Case, Model, Recorder, Repetition, Request, SimulationError, Until};
use crate::mechanics::sway::Sway;

/// Peaks are called certain to within this fraction of them.
pub const SAME_PEAK_RATIO: f64 = 0.01;

/// The repetitions must agree to this fraction of that, because still other ways to compute the motion may differ by more.
const AGREEMENT: f64 = 0.5;

/// Half cycles after the last one that peaks above this fraction of the largest peak are not compared.
const LEAST_PEAK_RATIO: f64 = 1e-2;

/// A motion beside its repetitions: only what they agree on can be relied on.
///
/// After the first change of side, the order of impacts that almost coincide decides how the motion goes
/// on.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// How the repetitions were computed.
    pub repeated: Vec<&'static str>,
    /// Outcomes of the motion itself, then of the repetitions.
    pub outcomes: Vec<Outcome>,
    /// The half cycles that all of them have, up to the last that peaks above a hundredth of the largest peak of the motion
    /// itself.
    pub half_cycles: Vec<PeakSpread>,
    /// Number of half cycles, from the first on, that are the same: to one side, with the same peaks.
    pub same_until_half_cycle: usize,
    /// When the first half cycle that differs begins, in seconds; `None` where all are the same.
    pub parts_at_s: Option<f64>,
    /// The largest rotation of a block; `None` if one of the motions overturns.
    pub largest: Option<PeakSpread>,
}

/// A largest rotation of a block, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakSpread {
    /// Largest rotation in the motion itself.
    pub own_rad: f64,
    /// The least of all.
    pub min_rad: f64,
    /// The largest of all.
    pub max_rad: f64,
}

impl PeakSpread {
    /// Peaks of the motion itself, then of its repetitions.
    fn of(peaks_rad: &[f64]) -> Self {
        Self {
            own_rad: peaks_rad[0],
            min_rad: peaks_rad.iter().copied().fold(f64::INFINITY, f64::min),
            max_rad: peaks_rad.iter().copied().fold(0.0, f64::max),
        }
    }

    /// Whether all agree so well that they are certain to [`SAME_PEAK_RATIO`].
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.max_rad - self.min_rad <= AGREEMENT * SAME_PEAK_RATIO * self.max_rad
    }
}

impl Spread {
    /// Compares a motion of a row with its repetitions, given with their names.
    #[must_use]
    pub fn new(own: &Summary, repetitions: &[(&'static str, Summary)]) -> Self {
        let runs: Vec<&Summary> = std::iter::once(own)
            .chain(repetitions.iter().map(|(_, summary)| summary))
            .collect();
        let cycles: Vec<_> = runs.iter().map(|summary| summary.half_cycles()).collect();
        let largest_rad = cycles[0]
            .iter()
            .map(|cycle| cycle.peak_rad)
            .fold(0.0, f64::max);
        let counts = |cycle: &HalfCycle| cycle.peak_rad > LEAST_PEAK_RATIO * largest_rad;
        let last = cycles[0].iter().rposition(counts);
        let compared = last.map_or(0, |last| last + 1);
        let in_all = cycles
            .iter()
            .map(|cycles| cycles.len())
            .min()
            .unwrap_or(0)
            .min(compared);
        let mut half_cycles = Vec::new();
        let mut same = 0;
        for index in 0..in_all {
            let peaks_rad: Vec<f64> = cycles.iter().map(|cycles| cycles[index].peak_rad).collect();
            let peak = PeakSpread::of(&peaks_rad);
            let side = cycles[0][index].sway;
            let to_one_side = cycles.iter().all(|cycles| cycles[index].sway == side);
            if same == index && to_one_side && peak.is_same() {
                same += 1;
            }
            half_cycles.push(peak);
        }
        let starts_s = cycles
            .iter()
            .filter(|_| same < compared)
            .filter_map(|cycles| Some(cycles.get(same)?.start_s))
            .reduce(f64::min);
        let stands = |summary: &&Summary| !matches!(summary.outcome, Outcome::Overturned(_));
        let largest_rad: Vec<f64> = runs
            .iter()
            .map(|summary| summary.largest_rotation_rad())
            .collect();
        Self {
            repeated: repetitions.iter().map(|(name, _)| *name).collect(),
            outcomes: runs.iter().map(|summary| summary.outcome).collect(),
            half_cycles,
            same_until_half_cycle: same,
            parts_at_s: starts_s,
            largest: runs
                .iter()
                .all(stands)
                .then(|| PeakSpread::of(&largest_rad)),
        }
    }

    /// Whether all ended alike, to the same side if they overturned.
    #[must_use]
    pub fn same_outcome(&self) -> bool {
        self.outcomes.iter().all(|other| *other == self.outcomes[0])
    }
}

/// The repetitions of a motion, computed on threads of their own beside it. If the motion itself fails nobody waits for them: they
/// end with the program.
#[derive(Debug)]
pub struct Repetitions(Vec<(&'static str, JoinHandle<Result<Summary, SimulationError>>)>);

/// Why it is not known how far a motion depends on its computation.
#[derive(Clone, Debug, Error)]
pub enum SpreadError {
    /// A repetition failed.
    #[error("the repetition with {name} failed: {error}")]
    Failed {
        /// Which one.
        name: &'static str,
        /// Why.
        error: SimulationError,
    },
    /// A repetition crashed, which is a defect of the program.
    #[error("the repetition with {0} crashed")]
    Crashed(&'static str),
}

impl Repetitions {
    /// Starts them.
    #[must_use]
    pub fn start(model: &dyn Model, ground: &GroundMotion, request: &Request) -> Self {
        let start = |Repetition { name, model }| {
            let (ground, request) = (ground.clone(), *request);
            let repeated = move || model.simulate(&ground, &request, None);
            (name, thread::spawn(repeated))
        };
        Self(model.repetitions().into_iter().map(start).collect())
    }

    /// Waits for them, and compares the motion with them.
    ///
    /// # Errors
    /// When one of them failed.
    pub fn spread(self, own: &Summary) -> Result<Spread, SpreadError> {
        let ended = |(name, repetition): (_, JoinHandle<Result<_, _>>)| {
            let ended = repetition.join().map_err(|_| SpreadError::Crashed(name))?;
            let summary = ended.map_err(|error| SpreadError::Failed { name, error })?;
            Ok((name, summary))
        };
        let repeated: Result<Vec<_>, _> = self.0.into_iter().map(ended).collect();
        Ok(Spread::new(own, &repeated?))
    }
}

/// Whether a structure overturns, as far as that is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It does not, to the end of the simulation.
    Survives,
    /// That depends on how it is computed.
    Uncertain,
    /// It does.
    Overturns,
}

impl From<Outcome> for Verdict {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Overturned(_) => Self::Overturns,
            Outcome::NeverMoved | Outcome::Rest | Outcome::StillRocking => Self::Survives,
        }
    }
}

impl Verdict {
    /// Its name in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Survives => "survives",
            Self::Uncertain => "uncertain",
            Self::Overturns => "overturns",
        }
    }

    const fn words(self) -> &'static str {
        match self {
            Self::Survives => "survives",
            Self::Uncertain => "is uncertain",
            Self::Overturns => "overturns",
        }
    }
}

/// How a repetition contradicts a history that ended like this; `None` if it agrees.
pub(crate) fn objection(
    own: Outcome,
    name: &str,
    repeated: &Result<Summary, SimulationError>,
) -> Option<String> {
    let own = Verdict::from(own);
    match repeated {
        Ok(summary) => {
            let other = Verdict::from(summary.outcome);
            (other != own).then(|| format!("{}; {} with {name}", own.words(), other.words()))
        }
        Err(error) => Some(format!("{}; failed with {name}: {error}", own.words())),
    }
}

/// Why it is uncertain whether histories overturn. They are repeated where that may matter; those that failed are not.
pub(crate) fn doubts<E>(
    model: &dyn Model,
    cases: &[Case],
    own: &[Result<Summary, E>],
) -> Vec<Option<String>> {
    let mut doubts = vec![None; cases.len()];
    let outcome = |index: &usize| own[*index].as_ref().ok().map(|own| own.outcome);
    let is_open = |index: &usize| {
        let (_, request) = &cases[*index];
        own[*index]
            .as_ref()
            .is_ok_and(|own| !is_plain(model, request, own))
    };
    let mut open: Vec<usize> = (0..cases.len()).filter(is_open).collect();
    if open.is_empty() {
        return doubts;
    }
    for Repetition { name, model } in model.repetitions() {
        let cases: Vec<Case> = open.iter().map(|index| cases[*index].clone()).collect();
        let repeated = until_decided(&*model, &cases);
        for (index, repeated) in open.iter().zip(&repeated) {
            doubts[*index] = outcome(index).and_then(|own| objection(own, name, repeated));
        }
        open.retain(|index| doubts[*index].is_none());
    }
    doubts
}

/// Histories up to where they cannot overturn any more.
fn until_decided(model: &dyn Model, cases: &[Case]) -> Vec<Result<Summary, SimulationError>> {
    if model.is_faster_together() {
        return model.simulate_until(Until::Safe, cases);
    }
    let alone = |(ground, request): &Case| {
        let mut until_safe = UntilSafe::new(ground, f64::INFINITY);
        model.simulate(ground, request, Some(&mut until_safe))
    };
    cases.iter().map(alone).collect()
}

/// If slip and crushing took more than this fraction of the barrier, elastic joints no longer lie as they did when it was found.
pub(super) const GONE: f64 = 0.01;

/// A survivor that never reached this fraction of the energy barrier of its first mechanism is not repeated.
const FAR_FROM_OVERTURNING: f64 = 0.5;

/// Whether repetitions can be spared: the structure never moved, it overturned before its first change of side, up to which
/// all ways agree, or it survived far from overturning.
fn is_plain(model: &dyn Model, request: &Request, own: &Summary) -> bool {
    match own.outcome {
        Outcome::NeverMoved => true,
        Outcome::Overturned(_) => own
            .row
            .as_ref()
            .is_some_and(|row| row.half_cycles.len() <= 1),
        Outcome::Rest | Outcome::StillRocking => {
            let row = own.row.as_ref();
            let elastic = row.and_then(|row| Some((row, row.elastic.as_ref()?)));
            let ratio = match elastic {
                None => own.peak_potential_over_barrier,
                // Elastic joints overturn below the barrier of rigid joints.
                Some((row, elastic)) => {
                    let barrier_j = model.elastic_barrier_j(request.gravity_m_s2);
                    let gone_j = elastic.friction_j + elastic.crushed_j;
                    let barrier_j = barrier_j.filter(|barrier_j| gone_j < GONE * barrier_j);
                    barrier_j.map(|barrier_j| row.largest_potential_j / barrier_j)
                }
            };
            ratio.is_some_and(|ratio| ratio < FAR_FROM_OVERTURNING)
        }
    }
}

/// On ground that stays quiet, a structure with less than this fraction of the energy barrier of its first mechanism cannot overturn
/// any more. Rows overturn by other mechanisms as well: 125 histories of random rows that overturned never had less than 0.45 of the
/// barrier on quiet ground before.
const SAFE: f64 = 0.25;

/// With less than this fraction of the largest energy that it had, a structure turns no block as far as it did.
const DECAYED: f64 = 0.1;

/// A history that may be ended early comes to rest before its end if this many times its last half cycle fit into the time that is
/// left: half cycles shorten at least as fast as those of a block whose impacts leave 0.95 of the energy.
const HALF_CYCLES_LEFT: f64 = 40.0;

/// Histories for a study of many cases. One that cannot overturn any more, and has ample time to come to rest, is ended there and
/// counts as coming to rest. Also returns when each was ended, in seconds; `None` where the history was followed to its end.
pub(crate) fn until_safe(
    model: &dyn Model,
    cases: &[Case],
) -> (Vec<Result<Summary, SimulationError>>, Vec<Option<f64>>) {
    // If the result does not depend on how it is computed, the fast way serves.
    if model.repetitions().is_empty() {
        return (model.simulate_all(cases), vec![None; cases.len()]);
    }
    let resting = |mut own: Result<Summary, SimulationError>, ended: bool| {
        let ended = own.as_mut().ok().filter(|_| ended);
        let safe_from_s = ended.map(|summary| {
            summary.outcome = Outcome::Rest;
            summary.end_s
        });
        (own, safe_from_s)
    };
    if model.is_faster_together() {
        let own = model.simulate_until(Until::Settled, cases);
        let own = own.into_iter().zip(cases);
        return own
            .map(|(own, (_, request))| {
                let before_its_end = |own: &Summary| {
                    own.outcome == Outcome::StillRocking && own.end_s < request.end_s
                };
                let ended = own.as_ref().is_ok_and(before_its_end);
                resting(own, ended)
            })
            .unzip();
    }
    let alone = |(ground, request): &Case| {
        let mut until_safe = UntilSafe::new(ground, request.end_s);
        let own = model.simulate(ground, request, Some(&mut until_safe));
        resting(own, until_safe.ended)
    };
    cases.iter().map(alone).unzip()
}

/// Ends a history that cannot overturn any more.
struct UntilSafe {
    /// From when on the ground is quiet, in seconds.
    quiet_s: f64,
    /// By when it must have come to rest, in seconds; infinite where that does not matter.
    rest_by_s: f64,
    /// The side to which it sways, and since when, in seconds.
    sways: Option<(Sway, f64)>,
    /// How long the half cycle before took, in seconds.
    half_cycle_s: f64,
    /// The largest energy so far, over the barrier.
    largest_ratio: f64,
    ended: bool,
}

impl UntilSafe {
    fn new(ground: &GroundMotion, rest_by_s: f64) -> Self {
        Self {
            quiet_s: ground.end_s(),
            rest_by_s,
            sways: None,
            half_cycle_s: 0.0,
            largest_ratio: 0.0,
            ended: false,
        }
    }

    /// How long a half cycle takes at most, from now on.
    fn longest_half_cycle_s(&mut self, sample: &Sample) -> f64 {
        let State::Rocking(sway) = sample.state else {
            return f64::INFINITY;
        };
        let now_s = sample.time_s;
        let (side, since_s) = *self.sways.get_or_insert((sway, now_s));
        if side != sway {
            self.half_cycle_s = now_s - since_s;
            self.sways = Some((sway, now_s));
        }
        // The half cycle under way may be longer than the one before, which the ground drove.
        self.half_cycle_s
            .max(now_s - self.sways.map_or(now_s, |(_, since_s)| since_s))
    }
}

impl Recorder for UntilSafe {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        let half_cycle_s = self.longest_half_cycle_s(sample);
        // A row that has slipped stands lower, and elastic joints overturn below the barrier of rigid joints: their energy says
        // nothing.
        let slips = !sample.offsets_m.is_empty() || !sample.pressures.is_empty();
        let ratio = sample.energy_ratio.unwrap_or(f64::INFINITY);
        self.largest_ratio = self.largest_ratio.max(ratio);
        let safe = ratio < SAFE;
        if sample.time_s < self.quiet_s || !safe || slips {
            return ControlFlow::Continue(());
        }
        let rests = sample.time_s + HALF_CYCLES_LEFT * half_cycle_s < self.rest_by_s;
        let decayed = self.half_cycle_s > 0.0 && ratio < DECAYED * self.largest_ratio;
        if self.rest_by_s < f64::INFINITY && !(rests && decayed) {
            return ControlFlow::Continue(());
        }
        self.ended = true;
        ControlFlow::Break(())
    }
}
