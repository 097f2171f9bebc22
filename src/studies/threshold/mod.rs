//! Thresholds: the factors on a ground motion at which structures overturn.
//!
//! A stronger motion is not always more dangerous. After impacts there are **bands** of factors that overturn the structure, with safe **gaps**
//! between them, and **uncertain** ranges in which repetitions disagree. So factors are sampled upwards in equal strides, bisection finds the edge
//! between two neighbours with different verdicts, and a finer search below the first edge finds bands that the strides step over.

pub(super) mod along;
pub(in crate::studies) mod below;
mod digits;
mod factors;
pub(crate) mod first_edge;
mod picture;
mod report;
mod search;
pub(crate) mod survival;
mod varied;

pub use along::{Along, AlongOptions, AlongRow, AlongSummary, KeyRange};
pub(super) use digits::{format_edge, rounded_down, rounded_edge, rounded_range};
use factors::UNCERTAIN_EDGE_WIDTH;
pub use factors::{EDGE_WIDTH, Factors, SearchedFactors, onset_factor};
pub use picture::draw;
pub use report::{FILES, ThresholdSummary};
pub use survival::{Survival, VerdictRange, survival_in_words};
use varied::repeat_governing;
pub use varied::{VariedThreshold, vary};

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use self::search::{OtherHistories, Shaking};
use super::ending::{Ending, NoHistory, Verdict};
use super::{Progress, Results, Runner, StudyError, Watch};
use crate::dynamics::{Direction, Directions};
use crate::output::Figure;
use crate::{GroundMotion, Model, Request, Scenario};

/// The history under the ground motion multiplied by a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct FactorSample {
    /// The factor.
    pub factor: f64,
    /// Ending of the history, or the reason why there is none.
    pub result: Result<Ending, NoHistory>,
}

impl FactorSample {
    /// Verdict; `None` if there is no history.
    pub fn verdict(&self) -> Option<Verdict> {
        self.result.as_ref().ok().map(Ending::verdict)
    }
}

named! {
    /// Reason why a range of factors ends.
    pub enum RangeEnd {
        /// The verdict changes.
        Edge = "edge",
        /// The first or the last sampled factor is reached.
        Sampled = "sampled",
        /// There is no history beyond.
        Unknown = "unknown",
    }
}

/// A range of factors with one verdict, which the histories at both ends have, or a range without histories.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FactorRange {
    /// The verdict; `None` without histories, and in a range that was read from JSON.
    #[serde(skip)]
    pub verdict: Option<Verdict>,
    /// Smallest factor of the range.
    pub from: f64,
    /// Largest factor of the range.
    pub to: f64,
    /// Reason why the range begins at `from`.
    pub from_end: RangeEnd,
    /// Reason why the range ends at `to`.
    pub to_end: RangeEnd,
}

/// The threshold of a model of motion in a direction of the ground motion, with that under the mirrored ground motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Threshold {
    /// Name of the model.
    pub model: String,
    /// Direction of the ground motion of the samples and ranges.
    pub direction: Direction,
    /// The factors of the search in all directions.
    pub factors: SearchedFactors,
    /// The threshold under the mirrored ground motion, up to the first factor that certainly overturns the structure in the first direction; `None`
    /// without a [second direction](Directions::has_second).
    pub mirrored: Option<Box<Self>>,
    /// The histories for all factors, ascending. They include the last history of a bisection that failed or met the third verdict.
    pub samples: Vec<FactorSample>,
    /// All ranges of tried factors, ascending.
    pub ranges: Vec<FactorRange>,
    /// The lowest factors of structures with other stiffness and contact, and with rigid joints; empty unless joints are elastic and a factor
    /// overturns the structure.
    pub varied: Vec<VariedThreshold>,
    /// Largest excess of the thrust line of four links over the thickness at factors up to the largest safe one; `None` for other models.
    pub(crate) safe_excess_ratio: Option<f64>,
    /// Largest friction coefficient that the histories at factors up to the largest safe one require without slip; `None` if joints slip or are
    /// elastic, or without a safe factor.
    pub friction_demand: Option<f64>,
}

impl Threshold {
    /// Ranges with a verdict, ascending.
    pub fn ranges_with(&self, wanted: Verdict) -> Vec<FactorRange> {
        let is_wanted = |range: &FactorRange| range.verdict == Some(wanted);
        self.ranges.iter().copied().filter(is_wanted).collect()
    }

    /// Ranges that overturn the structure, ascending.
    pub fn bands(&self) -> Vec<FactorRange> {
        self.ranges_with(Verdict::Overturns)
    }

    /// Safe ranges between bands, ascending.
    pub fn gaps(&self) -> Vec<FactorRange> {
        let bands = self.bands();
        let between = |gap: &FactorRange| {
            bands.iter().any(|band| band.to < gap.from)
                && bands.iter().any(|band| band.from > gap.to)
        };
        let mut gaps = self.ranges_with(Verdict::Survives);
        gaps.retain(between);
        gaps
    }

    /// This threshold, then that under the mirrored ground motion.
    pub fn directions(&self) -> impl Iterator<Item = &Self> {
        [self].into_iter().chain(self.mirrored.as_deref())
    }

    /// Threshold in the direction that survives less: its safe factors end first.
    pub fn governing(&self) -> &Self {
        let safe = |one: &Self| Survival::of_threshold(one).survives_up_to.unwrap_or(0.0);
        let mirrored = self.mirrored.as_deref();
        mirrored
            .filter(|mirrored| safe(mirrored) < safe(self))
            .unwrap_or(self)
    }

    /// Largest factor up to which the structure certainly survives all sampled factors in all directions; `None` if it does not survive the
    /// smallest.
    pub fn survives_up_to(&self) -> Option<f64> {
        Survival::of_threshold(self.governing()).survives_up_to
    }

    /// Smallest factor that certainly overturns the structure in any direction; `None` if no factor does.
    pub fn lowest_factor(&self) -> Option<f64> {
        let lowest = |one: &Self| one.bands().first().map(|band| band.from);
        self.directions().filter_map(lowest).reduce(f64::min)
    }

    /// An error if no history could be computed.
    fn check_known(&self) -> Result<(), StudyError> {
        let mut results = self.samples.iter().map(|sample| &sample.result);
        match results.clone().find_map(|result| result.as_ref().err()) {
            Some(reason) if results.all(Result::is_err) => Err(match reason {
                NoHistory::GroundFalls(reason) => StudyError::Scenario(reason.clone()),
                reason => StudyError::failed(reason),
            }),
            _ => Ok(()),
        }
    }

    fn new(
        model: String,
        factors: SearchedFactors,
        samples: Vec<FactorSample>,
        edges: &[(f64, f64)],
    ) -> Self {
        // The edge at an end of a range, if there is one, and the reason why the range ends.
        let end = |below: Option<&FactorSample>, above: Option<&FactorSample>| {
            let Some((below, above)) = below.zip(above) else {
                return (None, RangeEnd::Sampled);
            };
            let mut edges = edges.iter();
            let edge = edges.find(|(low, high)| below.factor <= *low && *high <= above.factor);
            let why = edge.map_or(RangeEnd::Unknown, |_| RangeEnd::Edge);
            (edge, why)
        };
        let mut ranges = Vec::new();
        let mut start = 0_usize;
        for run in samples.chunk_by(|a, b| a.verdict() == b.verdict()) {
            let (first, last) = (&run[0], &run[run.len() - 1]);
            let before = start.checked_sub(1).map(|index| &samples[index]);
            start += run.len();
            let (edge, from_end) = end(before, Some(first));
            let from = edge.map_or(first.factor, |(_, high)| *high);
            let (edge, to_end) = end(Some(last), samples.get(start));
            let to = edge.map_or(last.factor, |(low, _)| *low);
            ranges.push(FactorRange {
                verdict: first.verdict(),
                from,
                to,
                from_end,
                to_end,
            });
        }
        Self {
            model,
            factors,
            direction: Direction::AsGiven,
            mirrored: None,
            samples,
            ranges,
            varied: Vec::new(),
            safe_excess_ratio: None,
            friction_demand: None,
        }
    }

    /// Follows thrust line and friction demand up to the largest safe factor, in the samples of all directions and in these other histories.
    fn add_thrust_and_friction(&mut self, others: &[OtherHistories]) {
        let Some(safe) = self.survives_up_to() else {
            return;
        };
        let samples = self.directions().flat_map(|one| &one.samples);
        let up_to = samples
            .chain(others.iter().flat_map(|one| &one.bisected))
            .filter(|sample| sample.factor <= safe);
        let endings = up_to.flat_map(|sample| &sample.result);
        let fine = others
            .iter()
            .flat_map(|one| &one.fine)
            .filter(|history| history.factor <= safe);
        let of_endings = endings.map(|one| (one.thrust_excess_ratio, one.friction_demand));
        let of_fine = fine.map(|one| (one.thrust_excess_ratio, one.friction_demand));
        let (excess_ratios, demands): (Vec<_>, Vec<_>) = of_endings.chain(of_fine).unzip();
        let largest = |known: Vec<Option<f64>>| known.into_iter().flatten().reduce(f64::max);
        self.safe_excess_ratio = largest(excess_ratios);
        self.friction_demand = largest(demands);
    }
}

/// Computes the factors on the ground motion by which a model, given with its name, overturns in these directions. The ground motion is that of the
/// first one. The second one is searched up to the first factor that certainly overturns the model in the first direction.
///
/// `watch` receives the progress as in [`Runner::rows`], for each step of the search.
///
/// # Errors
/// When `watch` returns `Break`, threads cannot be started, or the request or the factors are not valid. Failed histories are part of the results.
pub fn threshold(
    (name, model): (&str, &dyn Model),
    (directions, ground): (Directions, &GroundMotion),
    request: &Request,
    factors: &Factors,
    runner: &Runner,
    mut watch: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<Threshold, StudyError> {
    request.check(ground).map_err(StudyError::scenario)?;
    let onset = onset_factor(model, directions, (ground, request));
    let searched = factors
        .factors_to_search(onset)
        .map_err(StudyError::Scenario)?;
    let many_cases = model.for_many_cases();
    let shaking = Shaking {
        direction: directions.first(),
        model,
        faster: many_cases.as_deref(),
        ground,
        request,
        searched: &searched,
    };
    let mut values = searched.values();
    let (mut threshold, own) = shaking.threshold(name, &values, runner, &mut watch)?;
    let mut others = vec![own];
    if directions.has_second(model, ground, request) {
        let overturns = |sample: &&FactorSample| sample.verdict() == Some(Verdict::Overturns);
        if let Some(first) = threshold.samples.iter().find(overturns) {
            let below = values.partition_point(|factor| *factor < first.factor);
            values.truncate(below + 1);
        }
        let shaking = Shaking {
            direction: Direction::Mirrored,
            ground: &ground.mirrored(),
            ..shaking
        };
        let (mirrored, of_mirrored) = shaking.threshold(name, &values, runner, &mut watch)?;
        others.push(of_mirrored);
        threshold.mirrored = Some(Box::new(mirrored));
    }
    threshold.add_thrust_and_friction(&others);
    Ok(threshold)
}

/// Checks that a scenario has a ground motion to scale, and starts from rest.
///
/// # Errors
/// Change that the scenario needs, in words.
pub fn check(scenario: &Scenario) -> Result<(), String> {
    scenario.check_from_rest("threshold")?;
    scenario.ground.as_ref().ok_or(
        "a threshold needs a ground motion: give a table such as\n\n\
         [ground.one_cosine]\n\
         amplitude_g = 0.3\n\
         duration_s = 0.5",
    )?;
    Ok(())
}

/// Largest horizontal acceleration of the ground at factor 1, in units of gravity.
pub(super) fn peak_g(scenario: &Scenario) -> f64 {
    scenario.ground_motion().peaks_m_s2(f64::INFINITY).x / scenario.gravity_m_s2()
}

/// Computes results of scenarios that differ only in their models of motion, with the thresholds of variations.
///
/// # Errors
/// When a scenario has no threshold, no history can be computed, or `watch` returns `Break`.
pub fn results(
    scenarios: &[Scenario],
    factors: &Factors,
    figure: Figure,
    runner: &Runner,
    watch: Watch<'_>,
) -> Result<Results, StudyError> {
    let scenario = &scenarios[0];
    check(scenario).map_err(StudyError::Scenario)?;
    let (ground, request) = (scenario.ground_motion(), scenario.request());
    // The search with one model may take hours, so errors of all models come first.
    let models: Vec<_> = scenarios
        .iter()
        .map(Scenario::model)
        .collect::<Result<_, _>>()
        .map_err(StudyError::scenario)?;
    let mut found = Vec::new();
    for (scenario, model) in scenarios.iter().zip(&models) {
        let named = (scenario.model_name(), &**model);
        let directions = scenario.simulation.direction;
        let shaken = (directions, ground);
        let mut threshold = threshold(named, shaken, &request, factors, runner, &mut *watch)?;
        threshold.check_known()?;
        if threshold.lowest_factor().is_some() {
            let variations = scenario.variations().map_err(StudyError::failed)?;
            let has_second = threshold.mirrored.is_some();
            let case = (ground, &request, has_second);
            let searched = &threshold.factors;
            let mut varied = vary(&variations, searched, case, runner, &mut *watch)?;
            if let Some(safe) = threshold.survives_up_to() {
                let moving = (directions, ground, &request);
                repeat_governing(
                    &mut varied,
                    &variations,
                    (safe, searched),
                    moving,
                    runner,
                    watch,
                )?;
            }
            threshold.varied = varied;
        }
        found.push(threshold);
    }
    Ok(report::report(scenarios, factors, &found, figure)?)
}
