//! A suite of records: a history for every record at every level, and the fragility that follows from them.

pub mod fragility;
mod heading;
mod ida;
mod picture;
mod report;
pub mod strength;

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use self::fragility::{Fragility, NoFit, Observation, by_intensity, fit};
pub use self::heading::Heading;
use self::strength::Strength;
use super::ending::{Ending, Verdict, check_finite};
use super::remarks::warnings;
use super::results::{Reported, Results, Style};
use super::runner::Study;
use super::threshold::survival::Survival;
use crate::bisection::{Width, bisect};
use crate::dynamics::history::Outcome;
use crate::dynamics::model::{Case, Model};
use crate::output::OutputError;
use crate::scenario::{Measure, Scenario, Suite};

/// A record that shakes the structure, and how its history ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseRow {
    /// The file.
    pub record: String,
    /// Whether the record is mirrored.
    pub mirrored: bool,
    /// The factor on the record, above 0.
    pub scale: f64,
    /// Its peak after scaling, in units of gravity.
    pub peak_g: f64,
    /// Outcome of its history, or the reason for which it could not be computed.
    pub result: Result<Ending, String>,
    /// The lowest level that overturns between this level and the one below, by bisection; `None` unless this level overturns and the
    /// one below does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edge: Option<f64>,
    /// Whether lower levels may overturn as well, since a level between the two has no verdict.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub edge_at_most: bool,
    /// Intensities of the unscaled record.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strength: Option<Strength>,
}

impl CaseRow {
    /// The level, in the measure of the suite.
    #[must_use]
    pub const fn level(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Scale => self.scale,
            Measure::PeakG => self.peak_g,
        }
    }

    /// The level from which a case overturns that is the first of its record: its edge by bisection, if it has one.
    #[must_use]
    pub fn overturns_from(&self, measure: Measure) -> f64 {
        self.edge.unwrap_or_else(|| self.level(measure))
    }

    /// Whether it overturned, as far as this is known; `None` if there is no history.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        self.result.as_ref().ok().map(Ending::verdict)
    }

    /// The verdict; `None` if there is no history, or an incomplete one.
    #[must_use]
    pub fn known_verdict(&self) -> Option<Verdict> {
        self.verdict()
            .filter(|verdict| *verdict != Verdict::Incomplete)
    }

    /// True if both cases apply one record with one sign.
    fn has_shake_of(&self, other: &Self) -> bool {
        (&self.record, self.mirrored) == (&other.record, other.mirrored)
    }

    /// The record in words.
    pub(super) fn record_in_words(&self) -> String {
        let mirrored = if self.mirrored { " mirrored" } else { "" };
        format!("{}{mirrored}", self.record)
    }

    /// Whether its history overturned, whether certain or not.
    fn overturned_itself(&self) -> bool {
        let ending = self.result.as_ref();
        ending.is_ok_and(|ending| matches!(ending.outcome, Outcome::Overturned(_)))
    }

    /// Whether it certainly survived, but had not come to rest.
    #[must_use]
    pub fn still_rocking(&self) -> bool {
        let rocking = |ending: &Ending| ending.outcome == Outcome::StillRocking;
        self.verdict() == Some(Verdict::Survives) && self.result.as_ref().is_ok_and(rocking)
    }

    /// Whether its result is exactly that of another case, to the other side.
    fn is_mirror_image_of(&self, other: &Self) -> bool {
        let ended = self.result.as_ref().map(Ending::mirrored);
        ended.ok() == other.result.as_ref().ok().cloned()
    }
}

/// The cases of a suite: first the levels of a record, then those of the mirrored record, then the
/// next record.
#[derive(Debug)]
pub struct RecordSuite<'a> {
    scenario: &'a Scenario,
    suite: &'a Suite,
    model: Box<dyn Model>,
    levels: Vec<f64>,
    /// Intensities of each unscaled record.
    strengths: Vec<Strength>,
}

impl<'a> RecordSuite<'a> {
    /// The suite of a scenario, which must start from rest.
    ///
    /// # Errors
    /// Explains what to change.
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
        Ok(Self {
            scenario,
            suite,
            model: scenario.model().map_err(|error| error.to_string())?,
            levels: suite.levels.values(),
            strengths: strengths.collect(),
        })
    }

    const fn signs(&self) -> usize {
        if self.suite.both_signs { 2 } else { 1 }
    }
}

impl Study for RecordSuite<'_> {
    type Row = CaseRow;

    const NAME: &'static str = "suite";

    fn base(&self) -> Option<&Scenario> {
        Some(self.scenario)
    }

    fn warnings(&self) -> Vec<String> {
        warnings(self.scenario)
    }

    fn count(&self) -> usize {
        self.suite.records.len() * self.signs() * self.levels.len()
    }

    /// The levels of a record: whether a level has an edge below it is then known from its neighbour.
    fn family(&self, index: usize) -> Option<usize> {
        Some(index / self.levels.len())
    }

    fn rows(&self, indices: &[usize]) -> Vec<CaseRow> {
        let cases = indices.iter().map(|index| {
            let (level, record, mirrored) = self.place(*index);
            case(self.scenario, self.suite, record, level, mirrored)
        });
        let cases: Vec<Case> = cases.collect();
        let results = Ending::of_all(&*self.model, &cases);
        let overturn: Vec<Option<bool>> = results.iter().map(overturns_certainly).collect();
        let edge = |case: usize| {
            let index = indices[case];
            let below = (index % self.levels.len()).checked_sub(1)?;
            let known = indices.iter().position(|other| *other == index - 1);
            let survives_below = known.map(|known| overturn[known] == Some(false));
            let upper = overturn[case] == Some(true) && survives_below != Some(false);
            upper.then(|| self.edge(index, below, survives_below.is_some()))?
        };
        let edges: Vec<Option<(f64, bool)>> = (0..indices.len()).map(edge).collect();
        let row = |((index, result), edge): ((&usize, _), Option<(f64, bool)>)| {
            let (level, record, mirrored) = self.place(*index);
            let series = &self.suite.records[record];
            let own_g = series.peak_g(self.scenario.gravity_m_s2());
            let (scale, peak_g) = match self.suite.measure {
                Measure::Scale => (level, level * own_g),
                Measure::PeakG => (level / own_g, level),
            };
            CaseRow {
                record: series.file.clone(),
                mirrored,
                scale,
                peak_g,
                result: check_finite(&[scale, peak_g]).and(result),
                edge: edge.map(|(edge, _)| edge),
                edge_at_most: edge.is_some_and(|(_, at_most)| at_most),
                strength: Some(self.strengths[record]),
            }
        };
        let rows = indices.iter().zip(results).zip(edges);
        rows.map(row).collect()
    }
}

impl Reported for RecordSuite<'_> {
    const FILES: &'static [&'static str] = &report::FILES;

    fn results(&self, rows: Vec<CaseRow>, style: Style) -> Result<Results, OutputError> {
        let heading = Heading::of_resolved(&self.scenario.to_toml(), warnings(self.scenario));
        let heading = heading.expect("the scenario has a suite");
        heading.report(rows, style.figure)
    }
}

/// The ground motion of a case, and the request for its history.
pub(super) fn case(
    scenario: &Scenario,
    suite: &Suite,
    record: usize,
    level: f64,
    mirrored: bool,
) -> Case {
    let shake = suite.shake(record, level, mirrored);
    let ground = scenario.under_both_feet(shake.motion(scenario.gravity_m_s2()));
    let request = scenario.request_on(&ground, &scenario.structure);
    (ground, request)
}

/// Whether a history certainly overturns, if there is one that is complete.
fn overturns_certainly(result: &Result<Ending, String>) -> Option<bool> {
    let verdict = result.as_ref().ok()?.verdict();
    (verdict != Verdict::Incomplete).then_some(verdict == Verdict::Overturns)
}

/// How closely an edge is enclosed, as a part of it: far closer than records agree.
const EDGE_WIDTH: f64 = 2e-3;

impl RecordSuite<'_> {
    /// The level of a case, the index of its record, and whether the record is mirrored.
    fn place(&self, index: usize) -> (f64, usize, bool) {
        let level = self.levels[index % self.levels.len()];
        let shake = index / self.levels.len();
        (level, shake / self.signs(), shake % self.signs() == 1)
    }

    /// The lowest level that overturns, between the level of a case that overturns and the level with the index `below`; `None` if that
    /// overturns as well. Also whether the edge may lie lower: a level without a verdict narrows the interval as one that survives.
    fn edge(&self, index: usize, below: usize, survives_below: bool) -> Option<(f64, bool)> {
        let (level, record, mirrored) = self.place(index);
        let overturns = |level: f64| {
            let (ground, request) = case(self.scenario, self.suite, record, level, mirrored);
            let ending = Ending::of(&*self.model, &ground, &request);
            overturns_certainly(&ending)
        };
        let below = self.levels[below];
        if !survives_below && overturns(below)? {
            return None;
        }
        let mut at_most = false;
        let (_, lowest) = bisect(below, level, Width::Relative(EDGE_WIDTH), |level| {
            let answer = overturns(level);
            at_most |= answer.is_none();
            answer == Some(true)
        });
        Some((lowest, at_most))
    }
}

/// The cases of one intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FragilityRow {
    /// The intensity.
    pub intensity: f64,
    /// The number of cases with each outcome.
    pub counts: Counts,
    /// The probability by the curve at this intensity, and the ends of its 95 % band, if there is a curve.
    pub curve: Option<[f64; 3]>,
    /// The curve with uncertain cases counted as overturned.
    pub curve_with_uncertain: Option<[f64; 3]>,
}

/// The number of cases with each outcome.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Counts {
    /// Number of cases that have an outcome.
    pub cases: usize,
    /// Number of those that certainly overturned.
    pub overturned: usize,
    /// Number of those for which overturning is uncertain.
    pub uncertain: usize,
    /// Number of those that had neither overturned nor come to rest.
    #[serde(rename = "still_rocking_counted_as_not_overturned")]
    pub still_rocking: usize,
    /// Number of cases whose history ended too early for a verdict. They do not count.
    #[serde(rename = "incomplete_left_out")]
    pub incomplete: usize,
    /// Number of cases whose history could not be computed. They do not count.
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
        Self {
            cases: cases.len() - failed - incomplete,
            overturned: of(Some(Verdict::Overturns)),
            uncertain: of(Some(Verdict::Uncertain)),
            still_rocking: cases.iter().filter(|case| case.still_rocking()).count(),
            incomplete,
            failed,
        }
    }
}

impl FragilityRow {
    /// The fraction of the cases that certainly overturned.
    #[must_use]
    pub fn fraction(&self) -> Option<f64> {
        self.part(self.counts.overturned)
    }

    /// The fraction of the cases that overturned or may have.
    #[must_use]
    pub fn fraction_with_uncertain(&self) -> Option<f64> {
        self.part(self.counts.overturned + self.counts.uncertain)
    }

    fn part(&self, count: usize) -> Option<f64> {
        let cases = self.counts.cases;
        (cases > 0).then(|| count as f64 / cases as f64)
    }
}

/// The results of all cases together. Cases that are still rocking have not overturned; failed cases do not
/// count. There are two curves if cases are uncertain: these count as survived in one, and as overturned in the other.
///
/// Both signs of a record count, as cases of one record, which are not independent. If every mirrored case is exactly the
/// mirror image of the other, as with four links on a symmetric structure, it adds no evidence and does not count.
/// With free hinges this symmetry is broken by rounding and by the order of impacts that almost coincide.
#[derive(Clone, Debug, PartialEq)]
pub struct SuiteFragility {
    /// The measure of the intensities.
    pub measure: Measure,
    /// All cases.
    pub cases: Vec<CaseRow>,
    /// Whether mirrored cases count.
    pub mirrored_count: bool,
    /// The intensities, lowest first.
    pub levels: Vec<FragilityRow>,
    /// The curve with uncertain cases counted as survived, if there is one.
    pub fit: Result<Fragility, NoFit>,
    /// The curve with uncertain cases counted as overturned, if there is one.
    pub fit_with_uncertain: Result<Fragility, NoFit>,
}

impl SuiteFragility {
    /// The results of these cases.
    #[must_use]
    pub fn new(measure: Measure, cases: Vec<CaseRow>) -> Self {
        let mirrored_count = !mirrored_are_images(&cases);
        let evidence = counting(&cases, mirrored_count);
        let indices: BTreeMap<&str, usize> = names(&cases).into_iter().zip(0..).collect();
        let fit_from = |least: Verdict| {
            let known = evidence.iter().filter_map(|case| {
                Some(Observation {
                    intensity: case.level(measure),
                    overturned: case.known_verdict()? >= least,
                    record: indices[case.record.as_str()],
                })
            });
            fit(&known.collect::<Vec<_>>())
        };
        let fit = fit_from(Verdict::Overturns);
        let fit_with_uncertain = fit_from(Verdict::Uncertain);
        let curve = |fit: &Result<Fragility, NoFit>, intensity: f64| {
            let fit = fit.as_ref().ok()?;
            let (low, high) = fit.band(intensity);
            Some([fit.probability(intensity), low, high])
        };
        let levels = by_intensity(evidence, |case| case.level(measure));
        let levels = levels.into_iter().map(|(intensity, cases)| FragilityRow {
            intensity,
            counts: Counts::of(&cases),
            curve: curve(&fit, intensity),
            curve_with_uncertain: curve(&fit_with_uncertain, intensity),
        });
        Self {
            measure,
            levels: levels.collect(),
            fit,
            fit_with_uncertain,
            mirrored_count,
            cases,
        }
    }

    /// Whether it is uncertain for any case that counts whether it overturned.
    #[must_use]
    pub fn has_uncertain(&self) -> bool {
        self.levels.iter().any(|level| level.counts.uncertain > 0)
    }

    /// The first case of each record, and the intensities that the structure survives under it; mirrored records only if their results
    /// differ. The first intensity that overturns is found by bisection, the others are levels of the suite.
    #[must_use]
    pub fn survivals(&self) -> Vec<(&CaseRow, Survival)> {
        let mut survivals: Vec<(&CaseRow, Survival)> = Vec::new();
        for cases in self.cases.chunk_by(CaseRow::has_shake_of) {
            let level = |case: &CaseRow| (case.level(self.measure), case.verdict());
            let levels: Vec<_> = cases.iter().map(level).collect();
            let mut survival = Survival::of_levels(&levels);
            let overturns = |case: &CaseRow| case.verdict() == Some(Verdict::Overturns);
            if let Some(first) = cases.iter().position(overturns) {
                let is_known_below = first == 0 || cases[first - 1].known_verdict().is_some();
                survival.overturns_from = Some(cases[first].overturns_from(self.measure));
                survival.at_most = cases[first].edge_at_most || !is_known_below;
            }
            let case = &cases[0];
            let last = survivals.last();
            let last = last.filter(|(other, _)| case.mirrored && other.record == case.record);
            if last.is_none_or(|(_, other)| *other != survival) {
                survivals.push((case, survival));
            }
        }
        survivals
    }

    /// The cases that count.
    fn evidence(&self) -> Vec<&CaseRow> {
        counting(&self.cases, self.mirrored_count)
    }

    /// The cases of each record that count, weakest first.
    fn shakes(&self) -> Vec<Vec<&CaseRow>> {
        let evidence = self.evidence();
        let shakes = evidence.chunk_by(|a, b| a.has_shake_of(b));
        shakes.map(<[_]>::to_vec).collect()
    }

    /// Number of records.
    #[must_use]
    pub fn record_count(&self) -> usize {
        names(&self.cases).len()
    }

    /// Names of the records whose cases all certainly overturned, or all certainly survived: cases with this `verdict`.
    #[must_use]
    pub fn always(&self, verdict: Verdict) -> Vec<&str> {
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

/// The cases that count: all, or those whose record is not mirrored.
fn counting(cases: &[CaseRow], mirrored_count: bool) -> Vec<&CaseRow> {
    let counts = |case: &&CaseRow| mirrored_count || !case.mirrored;
    cases.iter().filter(counts).collect()
}

/// Whether every mirrored case has the result of the original, to the other side.
fn mirrored_are_images(cases: &[CaseRow]) -> bool {
    let key = |case: &CaseRow| (case.record.clone(), case.scale.to_bits());
    let own = cases.iter().filter(|case| !case.mirrored);
    let own: BTreeMap<_, &CaseRow> = own.map(|case| (key(case), case)).collect();
    let mut mirrored = cases.iter().filter(|case| case.mirrored);
    mirrored.all(|case| {
        let own = own.get(&key(case));
        own.is_some_and(|own| case.is_mirror_image_of(own))
    })
}

/// Names of the records.
fn names(cases: &[CaseRow]) -> BTreeSet<&str> {
    cases.iter().map(|case| case.record.as_str()).collect()
}
