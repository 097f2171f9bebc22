//! A suite of records: a history for every record at every level, and the fragility of the structure.

mod fragility;
mod heading;
mod ida;
mod outcomes;
mod picture;
mod report;
pub(super) mod strength;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use self::fragility::group_by_intensity;
pub use self::fragility::{Errors, Fraction, Fragility, NoFit, Observation, fit, fractions};
pub use self::heading::Heading;
pub(super) use self::report::OF_LEVELS;
pub use self::report::SuiteSummary;
pub use self::strength::{Strength, efficiencies};
use super::ending::{Ending, NoHistory, Verdict, check_finite};
use super::threshold::below::{FineHistory, Fineness, search_below_edge};
use super::threshold::first_edge::{FirstEdge, TriedHistory};
use super::threshold::onset_factor;
use super::threshold::survival::{Survival, VerdictRange};
use super::{NoAnswer, Results, Study, Style};
use crate::bisection::{Width, bisect};
use crate::dynamics::{Direction, Directions};
use crate::output::{OutputError, each};
use crate::scenario::{Measure, Scenario, Suite};
use crate::{Case, EndCondition, Model, Outcome};

/// A case of a suite: a record at a level, and the end of its history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseRow {
    /// Name of the record file.
    pub record: String,
    /// True if the record is mirrored.
    pub mirrored: bool,
    /// The factor on the record, above 0.
    pub scale: f64,
    /// Peak acceleration after scaling, in units of gravity.
    pub peak_g: f64,
    /// Outcome of the history, or the reason why there is none.
    pub result: Result<Ending, NoHistory>,
    /// The lowest overturning level between this level and the level below, by bisection. `None` unless this level overturns and the level below
    /// survives.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edge: Option<f64>,
    /// True if lower levels may overturn as well, because a level between the two has no certain verdict.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub edge_at_most: bool,
    /// The largest level up to which the bisection of the edge found certain survival. `None` without an edge, or if the level below does not survive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub safe_below_edge: Option<f64>,
    /// Largest friction coefficient that the histories of the bisection up to `safe_below_edge` require without slip; `None` without such histories, or
    /// if joints slip or are elastic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_below_edge: Option<f64>,
    /// The lowest band or uncertain level between this level and the level below, or the onset, that a finer search found; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub found_below: Option<FirstEdge>,
    /// The level at which that search began, downwards; `None` without a search.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub searched_from: Option<f64>,
    /// Intensities of the unscaled record.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strength: Option<Strength>,
}

impl CaseRow {
    /// Level, in the measure of the suite.
    pub const fn level(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Scale => self.scale,
            Measure::PeakG => self.peak_g,
        }
    }

    /// Level from which the record overturns the structure, if this is its first overturning case: `edge`, or the level without an
    /// edge.
    pub fn overturns_from(&self, measure: Measure) -> f64 {
        self.edge.unwrap_or_else(|| self.level(measure))
    }

    /// Verdict; `None` if there is no history.
    pub fn verdict(&self) -> Option<Verdict> {
        self.result.as_ref().ok().map(Ending::verdict)
    }

    /// Intensities of the scaled record, in the order of [`strength::MEASURES`] after the peak acceleration.
    fn intensities(&self) -> [Option<f64>; 3] {
        let strength = self.strength.as_ref();
        each(strength.map(|strength| strength.at(self.scale)))
    }

    /// Probability of overturning; `None` if there is no history, or the history is incomplete.
    pub fn overturning_share(&self) -> Option<f64> {
        self.result.as_ref().ok()?.overturning_share()
    }

    /// Ending of a complete history; `None` if there is no history, or the history is incomplete.
    pub(super) fn complete_ending(&self) -> Option<&Ending> {
        complete_ending(&self.result)
    }

    /// Verdict; `None` if there is no history, or the history is incomplete.
    pub fn known_verdict(&self) -> Option<Verdict> {
        self.complete_ending().map(Ending::verdict)
    }

    /// True if both cases apply one record with one sign.
    fn has_same_record(&self, other: &Self) -> bool {
        (&self.record, self.mirrored) == (&other.record, other.mirrored)
    }

    /// Name of the record, with "mirrored" if the record is mirrored.
    pub(super) fn record_in_words(&self) -> String {
        let mirrored = if self.mirrored { " mirrored" } else { "" };
        format!("{}{mirrored}", self.record)
    }

    /// True if the structure certainly survived, but had not come to rest.
    pub fn still_rocking(&self) -> bool {
        let rocking = |ending: &Ending| ending.outcome == Outcome::StillRocking;
        self.verdict() == Some(Verdict::Survives) && self.result.as_ref().is_ok_and(rocking)
    }
}

/// The cases of a suite. Their order: the levels of a record, the levels of the mirrored record, then the next record. There are no mirrored records if
/// the structure has no second direction: see [`Directions::has_second`](crate::dynamics::Directions::has_second).
#[derive(Debug)]
pub struct RecordSuite<'a> {
    scenario: &'a Scenario,
    suite: &'a Suite,
    model: Box<dyn Model>,
    /// The directions in which each record acts.
    directions: &'static [Direction],
    levels: Vec<f64>,
    /// Intensities of each unscaled record.
    strengths: Vec<Strength>,
    /// The lowest level at which a record overturns the structure, without repetitions; infinite if none does. Computed at the first request.
    lowest: OnceLock<f64>,
}

impl<'a> RecordSuite<'a> {
    /// Makes the suite of a scenario, which must start from rest.
    ///
    /// # Errors
    /// Change that the scenario needs, in words.
    pub fn of(scenario: &'a Scenario) -> Result<Self, String> {
        scenario.check_from_rest("suite")?;
        let suite = scenario.suite.as_ref().ok_or(
            "the scenario has no [suite]: give it a table with records and levels, such as\n\n\
             [suite]\n\
             records = \"records/*.at2\"\n\
             peaks_g = { from = 0.1, to = 2.0, count = 20, spacing = \"logarithmic\" }",
        )?;
        let (records, gravity_m_s2) = (suite.records.iter(), scenario.gravity_m_s2());
        let strengths = records.map(|series| Strength::of(series, suite.spectral, gravity_m_s2));
        let model = scenario.model().map_err(|error| error.to_string())?;
        Ok(Self {
            scenario,
            suite,
            directions: directions(scenario, suite, &*model),
            model,
            levels: suite.level_values(),
            strengths: strengths.collect(),
            lowest: OnceLock::new(),
        })
    }
}

impl Study for RecordSuite<'_> {
    type Row = CaseRow;

    const NAME: &'static str = "suite";

    const FILES: &'static [&'static str] = &report::FILES;

    fn base(&self) -> Option<&Scenario> {
        Some(self.scenario)
    }

    fn options(&self) -> Value {
        json!(self.heading())
    }

    fn count(&self) -> usize {
        self.suite.records.len() * self.directions.len() * self.levels.len()
    }

    /// Index of the record, with its sign: a level needs the result of the level below to know whether it has an edge.
    fn family(&self, index: usize) -> Option<usize> {
        Some(index / self.levels.len())
    }

    fn rows(&self, indices: &[usize]) -> Vec<CaseRow> {
        let cases: Vec<Case> = indices
            .iter()
            .map(|index| {
                let (level, record, direction) = self.case_parts(*index);
                case(self.scenario, self.suite, record, level, direction)
            })
            .collect();
        let results = Ending::of_all(&*self.model, &cases);
        let overturn: Vec<Option<bool>> = results.iter().map(overturns_certainly).collect();
        let edge = |case: usize| {
            let index = indices[case];
            let below = self.level_below(index)?;
            let is_first = index.is_multiple_of(self.levels.len());
            let known = indices
                .iter()
                .position(|other| !is_first && *other == index - 1);
            let survives_below = known.map(|known| overturn[known] == Some(false));
            let upper = overturn[case] == Some(true) && survives_below != Some(false);
            upper.then(|| self.edge(index, below, survives_below.is_some()))?
        };
        let edges: Vec<Option<BisectedEdge>> = (0..indices.len()).map(edge).collect();
        let row = |((index, result), edge): ((&usize, _), Option<BisectedEdge>)| {
            let (level, record, direction) = self.case_parts(*index);
            let series = &self.suite.records[record];
            let own_g = series.peak_g(self.scenario.gravity_m_s2());
            let (scale, peak_g) = match self.suite.measure {
                Measure::Scale => (level, level * own_g),
                Measure::PeakG => (level / own_g, level),
            };
            let searched_from = self.search_from(*index, &result, edge);
            let found_below =
                searched_from.and_then(|at| self.search_below(*index, (&result, edge), at));
            CaseRow {
                record: series.name.clone(),
                mirrored: direction == Direction::Mirrored,
                scale,
                peak_g,
                result: check_finite(&[scale, peak_g])
                    .and(result)
                    .map(|ending| Ending {
                        direction,
                        ..ending
                    }),
                edge: edge.map(|edge| edge.lowest),
                edge_at_most: edge.is_some_and(|edge| edge.at_most),
                safe_below_edge: edge.and_then(|edge| edge.safe),
                friction_below_edge: edge.and_then(|edge| edge.friction_demand),
                found_below,
                searched_from,
                strength: Some(self.strengths[record]),
            }
        };
        let rows = indices.iter().zip(results).zip(edges);
        rows.map(row).collect()
    }

    fn results(&self, rows: Vec<CaseRow>, style: Style) -> Result<Results, OutputError> {
        self.heading().report(rows, style.figure)
    }
}

/// Directions in which each record of a suite acts: the second one only if its histories are not mirror images.
pub(super) fn directions(
    scenario: &Scenario,
    suite: &Suite,
    model: &dyn Model,
) -> &'static [Direction] {
    let directions = scenario.simulation.direction;
    let first = directions.first();
    let level = suite.level_values().first().copied().unwrap_or(1.0);
    let (ground, request) = case(scenario, suite, 0, level, first);
    match (directions.has_second(model, &ground, &request), first) {
        (true, _) => Direction::ALL,
        (false, Direction::AsGiven) => &[Direction::AsGiven],
        (false, Direction::Mirrored) => &[Direction::Mirrored],
    }
}

/// Ground motion of a case, and the request for its history.
pub(super) fn case(
    scenario: &Scenario,
    suite: &Suite,
    record: usize,
    level: f64,
    direction: Direction,
) -> Case {
    let shake = suite
        .record_at(record, level)
        .ground_motion(scenario.gravity_m_s2());
    let ground = scenario.move_both_feet_in(direction, shake);
    let request = scenario.request_on(&ground, &scenario.structure);
    (ground, request)
}

/// Number of records in words.
pub(super) fn records_in_words(records: usize) -> String {
    match records {
        1 => "1 record".to_owned(),
        count => format!("{count} records"),
    }
}

/// Ending of a complete history; `None` if there is none.
fn complete_ending(result: &Result<Ending, NoHistory>) -> Option<&Ending> {
    let ending = result.as_ref().ok();
    ending.filter(|ending| ending.verdict() != Verdict::Incomplete)
}

/// True if a history certainly overturns; `None` without a complete history.
fn overturns_certainly(result: &Result<Ending, NoHistory>) -> Option<bool> {
    complete_ending(result).map(|ending| ending.verdict() == Verdict::Overturns)
}

/// The edge below a level that overturns.
#[derive(Clone, Copy)]
struct BisectedEdge {
    /// The lowest overturning level of the bisection.
    lowest: f64,
    /// True if the edge may lie lower, because a level without a verdict counted as surviving.
    at_most: bool,
    /// The largest level of the bisection below all levels that do not certainly survive.
    safe: Option<f64>,
    /// Largest friction coefficient that the histories of the bisection up to `safe` require.
    friction_demand: Option<f64>,
}

/// Relative width to which bisection encloses an edge: much less than the scatter of records.
const EDGE_WIDTH: f64 = 2e-3;

impl RecordSuite<'_> {
    fn heading(&self) -> Heading {
        let has_both = self.directions.len() > 1;
        Heading::new(self.scenario, self.suite, has_both)
    }

    /// Level of a case, the index of its record, and the direction in which the record acts.
    fn case_parts(&self, index: usize) -> (f64, usize, Direction) {
        let (shake, level) = (index / self.levels.len(), index % self.levels.len());
        let all = self.directions.len();
        (
            self.levels[level],
            shake / all,
            self.directions[shake % all],
        )
    }

    /// Level below that of a case; for the lowest level, that at which the structure starts to move under its record. `None` if that is
    /// unknown or higher, or if each record acts once, unscaled.
    fn level_below(&self, index: usize) -> Option<f64> {
        self.suite.levels.as_ref()?;
        if let Some(below) = (index % self.levels.len()).checked_sub(1) {
            return Some(self.levels[below]);
        }
        let (level, record, direction) = self.case_parts(index);
        let (ground, request) = case(self.scenario, self.suite, record, level, direction);
        let onset = onset_factor(&*self.model, Directions::AsGiven, (&ground, &request))?;
        Some(level * onset).filter(|onset| *onset < level)
    }

    /// Lowest edge of all records, without repetitions: below the lowest level at which one of them overturns the structure. Infinite if none
    /// does.
    fn find_lowest_edge(&self) -> f64 {
        *self.lowest.get_or_init(|| {
            let shakes = 0..self.count() / self.levels.len();
            let overturns = |index: usize, level: f64| {
                let (_, record, direction) = self.case_parts(index);
                let case = case(self.scenario, self.suite, record, level, direction);
                let history = self.model.simulate_until(EndCondition::Safe, &case);
                history.is_ok_and(|one| Verdict::from(one.outcome) == Verdict::Overturns)
            };
            let lowest_at = |level: usize| {
                let indices = shakes
                    .clone()
                    .map(|shake| shake * self.levels.len() + level);
                indices.fold(None, |lowest: Option<f64>, index| {
                    let high = lowest.unwrap_or(self.levels[level]);
                    if !overturns(index, high) {
                        return lowest;
                    }
                    let below = self.level_below(index).filter(|below| *below < high);
                    let width = Width::Relative(EDGE_WIDTH);
                    let edge = |below| bisect(below, high, width, |at| overturns(index, at)).1;
                    Some(below.map_or(high, edge))
                })
            };
            (0..self.levels.len())
                .find_map(lowest_at)
                .unwrap_or(f64::INFINITY)
        })
    }

    fn ending(&self, record: usize, level: f64, direction: Direction) -> Result<Ending, NoHistory> {
        let (ground, request) = case(self.scenario, self.suite, record, level, direction);
        Ending::of(&*self.model, &ground, &request)
    }

    /// Level from which on a finer search goes down to the level below: a level that survives, or the safe level of the edge below one that
    /// overturns; at most the lowest edge of all records, because the quote is the least of them. `None` if there is nothing to search.
    fn search_from(
        &self,
        index: usize,
        own: &Result<Ending, NoHistory>,
        edge: Option<BisectedEdge>,
    ) -> Option<f64> {
        let (level, ..) = self.case_parts(index);
        let survives = own
            .as_ref()
            .is_ok_and(|own| own.verdict() == Verdict::Survives);
        let safe = edge.map_or(survives.then_some(level), |edge| edge.safe)?;
        let below = self.level_below(index)?;
        let at = safe.min(self.find_lowest_edge());
        (below < at).then_some(at)
    }

    /// Searches finely from `at` down to the level below. `None` if nothing is found; or if `at` does not survive, nor does the level below.
    fn search_below(
        &self,
        index: usize,
        (own, edge): (&Result<Ending, NoHistory>, Option<BisectedEdge>),
        at: f64,
    ) -> Option<FirstEdge> {
        let (level, record, direction) = self.case_parts(index);
        let from = self.level_below(index)?;
        let first = match at == level {
            true => own.clone(),
            false => self.ending(record, at, direction),
        };
        let survives = first.as_ref().ok()?.verdict() == Verdict::Survives;
        let (_, request) = case(self.scenario, self.suite, record, at, direction);
        let histories = |levels: &[f64], _| {
            let ground = |level| Ok(case(self.scenario, self.suite, record, level, direction).0);
            let found = FineHistory::of_all(&*self.model, &request, levels, ground);
            Ok::<_, NoAnswer>(found)
        };
        let below = |safe| {
            let close = histories(&[safe], 0)?[0].close;
            search_below_edge((safe, close), from, Fineness::LEVELS, histories)
        };
        let history = |strength: f64| match strength == at {
            true => first.clone().map(TriedHistory::from),
            false => self
                .ending(record, strength, direction)
                .map(TriedHistory::from),
        };
        let strengths = &[from, at][usize::from(survives)..];
        let mut found = FirstEdge::search(strengths, EDGE_WIDTH, history, below).ok()?;
        if !survives {
            found.survives_up_to?;
            // The structure survives again from the safe level above on.
            found.tried_to = edge.and_then(|edge| edge.safe).unwrap_or(level);
        }
        (found.factor.is_some() || found.uncertain_from.is_some()).then_some(found)
    }

    /// Finds the edge between the level of a case that overturns and the level `below`; `None` if that level overturns as well.
    fn edge(&self, index: usize, below: f64, survives_below: bool) -> Option<BisectedEdge> {
        let (level, record, direction) = self.case_parts(index);
        let ending = |level: f64| self.ending(record, level, direction);
        if !survives_below && overturns_certainly(&ending(below))? {
            return None;
        }
        let (mut at_most, mut safe, mut doubtful) = (false, None, level);
        let mut demands = Vec::new();
        let (_, lowest) = bisect(below, level, Width::Relative(EDGE_WIDTH), |level| {
            let ending = ending(level);
            let answer = overturns_certainly(&ending);
            at_most |= answer.is_none();
            // A level above a doubtful one is not safe.
            let demand = ending
                .as_ref()
                .ok()
                .and_then(|ending| ending.friction_demand);
            demands.extend(demand.map(|demand| (level, demand)));
            match ending.as_ref().map(Ending::verdict) {
                Ok(Verdict::Survives) => safe = Some(level).filter(|_| level < doubtful).or(safe),
                _ => doubtful = doubtful.min(level),
            }
            answer == Some(true)
        });
        let up_to_safe = demands
            .into_iter()
            .filter(|(level, _)| Some(*level) <= safe);
        Some(BisectedEdge {
            lowest,
            at_most,
            safe,
            friction_demand: up_to_safe.map(|(_, demand)| demand).reduce(f64::max),
        })
    }
}

/// The results of all cases of one intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FragilityRow {
    /// The intensity.
    pub intensity: f64,
    /// The number of cases with each outcome.
    pub counts: Counts,
    /// The probability by the curve at this intensity, and the ends of the 95 % band, which contains the bands of both ends; `None` without a curve.
    pub curve: Option<[f64; 3]>,
}

/// The number of cases with each outcome.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Number of cases with a verdict.
    pub cases: usize,
    /// Number of cases that certainly overturned.
    pub overturned: usize,
    /// Number of cases whose overturning is uncertain.
    pub uncertain: usize,
    /// Number of overturned cases, with uncertain ones by the fraction of their repetitions that overturn.
    #[serde(skip)]
    pub expected: f64,
    /// Number of cases that had neither overturned nor come to rest.
    #[serde(rename = "still_rocking_counted_as_not_overturned")]
    pub still_rocking: usize,
    /// Number of cases whose history ended too early for a verdict: left out of `cases` and of the curve. Only the curves `with_uncertain_as_survived`
    /// and `with_uncertain_as_overturned` count them.
    #[serde(rename = "incomplete_left_out")]
    pub incomplete: usize,
    /// Number of cases whose history could not be computed: left out and counted as incomplete ones.
    #[serde(rename = "failed_left_out")]
    pub failed: usize,
}

impl Counts {
    fn of(cases: &[&CaseRow]) -> Self {
        let of = |verdict: Option<Verdict>| {
            let cases = cases.iter();
            cases.filter(|case| case.verdict() == verdict).count()
        };
        let (failed, incomplete) = (of(None), of(Some(Verdict::Incomplete)));
        let shares = cases.iter().filter_map(|case| case.overturning_share());
        Self {
            // Adding zero makes a negative zero positive.
            expected: shares.sum::<f64>() + 0.0,
            cases: cases.len() - failed - incomplete,
            overturned: of(Some(Verdict::Overturns)),
            uncertain: of(Some(Verdict::Uncertain)),
            still_rocking: cases.iter().filter(|case| case.still_rocking()).count(),
            incomplete,
            failed,
        }
    }

    /// Number of doubtful cases: uncertain, incomplete or failed.
    pub const fn doubtful(&self) -> usize {
        self.uncertain + self.incomplete + self.failed
    }
}

impl FragilityRow {
    /// Fraction of cases that overturned, with uncertain ones by their fractions; `None` without cases.
    pub fn fraction(&self) -> Option<f64> {
        let cases = self.counts.cases;
        (cases > 0).then(|| self.counts.expected / cases as f64)
    }

    /// Fraction of cases that overturned if doubtful ones survive, and if they overturn; `None` without cases.
    pub fn fraction_ends(&self) -> Option<[f64; 2]> {
        let (cases, overturned) = (self.counts.cases, self.counts.overturned);
        let all = cases + self.counts.incomplete + self.counts.failed;
        let ends = [overturned, overturned + self.counts.doubtful()];
        (cases > 0).then(|| ends.map(|count| count as f64 / all as f64))
    }
}

/// The results of a suite. Cases that are still rocking count as survived, and uncertain ones by the fraction of their repetitions that overturn.
/// If cases are doubtful (uncertain, incomplete or failed), there are two more curves: one counts them as survived, the other as overturned.
///
/// Both signs of a record count as cases of one record, which are not independent.
#[derive(Clone, Debug, PartialEq)]
pub struct SuiteFragility {
    /// The measure of the intensities.
    pub measure: Measure,
    /// All cases.
    pub cases: Vec<CaseRow>,
    /// The intensities, lowest first.
    pub levels: Vec<FragilityRow>,
    /// The curve with uncertain cases counted by their fractions, or the reason why there is none.
    pub fit: Result<Fragility, NoFit>,
    /// The curves with doubtful cases counted as survived, and as overturned, or the reasons why there is none.
    pub ends: [Result<Fragility, NoFit>; 2],
}

impl SuiteFragility {
    /// Computes the results of these cases.
    pub fn new(measure: Measure, cases: Vec<CaseRow>) -> Self {
        let indices: BTreeMap<&str, usize> = names(&cases).into_iter().zip(0..).collect();
        // Each curve counts a share of 0 to 1 in its own way; `None` does not count.
        let fit_of = |overturned: fn(Option<f64>) -> Option<f64>| {
            let known = cases.iter().filter_map(|case| {
                Some(Observation {
                    intensity: case.level(measure),
                    overturned: overturned(case.overturning_share())?,
                    record: indices[case.record.as_str()],
                })
            });
            fit(&known.collect::<Vec<_>>())
        };
        let fit = fit_of(|share| share);
        let ends = [
            fit_of(|share| Some(share.map_or(0.0, f64::floor))),
            fit_of(|share| Some(share.map_or(1.0, f64::ceil))),
        ];
        let curve = |fit: &Result<Fragility, NoFit>, intensity: f64| {
            let fit = fit.as_ref().ok()?;
            let (low, high) = fit.band(intensity);
            Some([fit.probability(intensity), low, high])
        };
        let levels =
            group_by_intensity(cases.iter().collect(), |case: &CaseRow| case.level(measure))
                .into_iter()
                .map(|(intensity, cases)| {
                    let others = ends.iter().filter_map(|fit| curve(fit, intensity));
                    let widened = |[at, low, high]: [f64; 3], end: [f64; 3]| {
                        [at, low.min(end[1]), high.max(end[2])]
                    };
                    FragilityRow {
                        intensity,
                        counts: Counts::of(&cases),
                        curve: curve(&fit, intensity).map(|own| others.fold(own, widened)),
                    }
                });
        Self {
            measure,
            levels: levels.collect(),
            fit,
            ends,
            cases,
        }
    }

    /// True if a case that counts is uncertain.
    pub fn has_uncertain(&self) -> bool {
        self.levels.iter().any(|level| level.counts.uncertain > 0)
    }

    /// Curve, and those of both ends if a case is doubtful.
    pub(super) fn fits(&self) -> impl Iterator<Item = &Result<Fragility, NoFit>> {
        let in_doubt = self.levels.iter().any(|level| level.counts.doubtful() > 0);
        let shown = if in_doubt { 3 } else { 1 };
        [&self.fit].into_iter().chain(&self.ends).take(shown)
    }

    /// Cases of each record, and the intensities that the structure survives under the record; mirrored records only if their
    /// results differ. The first overturning intensity is found by bisection and a finer search, the others are levels of the suite.
    pub fn survivals(&self) -> Vec<(&[CaseRow], Survival)> {
        let mut survivals: Vec<(&[CaseRow], Survival)> = Vec::new();
        for cases in self.cases_by_record() {
            let survival = self.survival(cases);
            let case = &cases[0];
            let last = survivals
                .last()
                .filter(|(other, _)| case.mirrored && other[0].record == case.record);
            if last.is_none_or(|(_, other)| *other != survival) {
                survivals.push((cases, survival));
            }
        }
        survivals
    }

    /// Intensities that the structure survives under a record, from its cases with one sign, the weakest first.
    fn survival(&self, cases: &[CaseRow]) -> Survival {
        let mut survival = self.survival_of_levels(cases);
        let found = cases.iter().find_map(|case| case.found_below.as_ref());
        if let Some(found) = found {
            survival.insert(found);
        }
        survival
    }

    /// True if lower intensities than `survives_up_to` of these cases with one sign were tried at the levels only.
    fn is_of_levels_only(cases: &[CaseRow], survival: &Survival) -> bool {
        let searched = cases.iter().filter_map(|case| case.searched_from);
        survival.survives_up_to > searched.reduce(f64::max)
    }

    /// Intensities that the structure survives under a record, without those found between the levels.
    fn survival_of_levels(&self, cases: &[CaseRow]) -> Survival {
        let level = |case: &CaseRow| (case.level(self.measure), case.verdict());
        let levels: Vec<_> = cases.iter().map(level).collect();
        let mut survival = Survival::of_levels(&levels);
        let is = |verdict| move |case: &CaseRow| case.verdict() == Some(verdict);
        let Some(first) = cases.iter().position(is(Verdict::Overturns)) else {
            return survival;
        };
        let is_known_below = first == 0 || cases[first - 1].known_verdict().is_some();
        let lowest = cases[first].overturns_from(self.measure);
        survival.overturns_from = Some(lowest);
        survival.at_most = cases[first].edge_at_most || !is_known_below;
        if first == 0 {
            survival.at_most |= cases[first].edge.is_none();
            survival.survives_up_to = cases[first].safe_below_edge;
            let safe = survival.survives_up_to.map(|safe| VerdictRange {
                verdict: Some(Verdict::Survives),
                from: safe,
                to: safe,
            });
            survival.ranges.splice(0..0, safe);
        }
        if first > 0 && cases[..first].iter().all(is(Verdict::Survives)) {
            let safe = cases[first].safe_below_edge.or(survival.survives_up_to);
            survival.survives_up_to = safe;
            // If the bisection met levels without a certain verdict, they are a range of their own.
            let doubtful = safe
                .filter(|safe| lowest > safe * (1.0 + 2.0 * EDGE_WIDTH))
                .map(|safe| VerdictRange {
                    verdict: Some(Verdict::Uncertain),
                    from: safe,
                    to: lowest,
                });
            survival.ranges.splice(1..1, doubtful);
        }
        survival
    }

    /// Cases, grouped by record and sign, the weakest first.
    fn cases_by_record(&self) -> impl Iterator<Item = &[CaseRow]> + Clone {
        self.cases.chunk_by(CaseRow::has_same_record)
    }

    /// True if records act with both signs.
    fn has_both_signs(&self) -> bool {
        let mut signs = self.cases.iter().map(|case| case.mirrored);
        let first = signs.next();
        signs.any(|mirrored| Some(mirrored) != first)
    }

    /// Number of records.
    pub fn record_count(&self) -> usize {
        names(&self.cases).len()
    }

    /// Names of the records whose cases all have this verdict.
    pub fn records_with(&self, verdict: Verdict) -> Vec<&str> {
        let mut alike: BTreeMap<&str, bool> = BTreeMap::new();
        for case in &self.cases {
            if let Some(known) = case.known_verdict() {
                *alike.entry(&case.record).or_insert(true) &= known == verdict;
            }
        }
        let alike = alike.into_iter().filter(|(_, alike)| *alike);
        alike.map(|(record, _)| record).collect()
    }
}

/// Names of the records.
fn names(cases: &[CaseRow]) -> BTreeSet<&str> {
    cases.iter().map(|case| case.record.as_str()).collect()
}
