//! A suite of records: a history for every record at every level, and the fragility that they add up to.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::ending::{Ending, check_finite};
use super::fragility::{Fragility, NoFit, Observation, by_intensity, fit};
use super::runner::Study;
use super::survival::Survival;
use crate::dynamics::history::Outcome;
use crate::dynamics::model::Model;
use crate::scenario::{Measure, ModelError, Scenario, Suite};

/// A record that shakes the structure, and how that ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseRow {
    /// The file.
    pub record: String,
    /// Whether the record is mirrored.
    pub mirrored: bool,
    /// What it is multiplied by, above 0.
    pub scale: f64,
    /// Its peak as scaled, in units of gravity.
    pub peak_g: f64,
    /// How its history ended, or why it could not be computed.
    pub result: Result<Ending, String>,
}

impl CaseRow {
    /// The level, as the suite measures it.
    #[must_use]
    pub const fn level(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Scale => self.scale,
            Measure::PeakG => self.peak_g,
        }
    }

    /// How the history ended, if there is one.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        self.result.as_ref().ok().map(|ending| ending.outcome)
    }

    /// Whether it overturned.
    #[must_use]
    pub fn overturned(&self) -> bool {
        matches!(self.outcome(), Some(Outcome::Overturned(_)))
    }
}

/// The cases of a suite: the levels of a record follow one another, then those of the record mirrored, then the
/// next record.
#[derive(Debug)]
pub struct RecordSuite<'a> {
    scenario: &'a Scenario,
    suite: &'a Suite,
    model: Box<dyn Model>,
    levels: Vec<f64>,
}

impl<'a> RecordSuite<'a> {
    /// The cases of a scenario's suite.
    ///
    /// # Errors
    /// As [`Scenario::model`].
    pub fn new(scenario: &'a Scenario, suite: &'a Suite) -> Result<Self, ModelError> {
        Ok(Self {
            scenario,
            suite,
            model: scenario.model()?,
            levels: suite.levels.values(),
        })
    }

    const fn signs(&self) -> usize {
        if self.suite.both_signs { 2 } else { 1 }
    }
}

impl Study for RecordSuite<'_> {
    type Row = CaseRow;

    const NAME: &'static str = "suite";

    fn scenario(&self) -> String {
        self.scenario.to_toml()
    }

    fn inputs(&self) -> Vec<String> {
        let records = self.suite.records.iter();
        records
            .map(|series| format!("{} {:08x}", series.file, series.checksum()))
            .collect()
    }

    fn count(&self) -> usize {
        self.suite.records.len() * self.signs() * self.levels.len()
    }

    fn row(&self, index: usize) -> CaseRow {
        let level = self.levels[index % self.levels.len()];
        let shake = index / self.levels.len();
        let mirrored = shake % self.signs() == 1;
        let record = shake / self.signs();
        let series = &self.suite.records[record];
        let request = self.scenario.request_from_rest();
        let own_g = series.peak_g(request.gravity_m_s2);
        let (scale, peak_g) = match self.suite.measure {
            Measure::Scale => (level, level * own_g),
            Measure::PeakG => (level / own_g, level),
        };
        let shake = self.suite.shake(record, level, mirrored);
        let ground = shake.motion(request.gravity_m_s2);
        let result = Ending::of(&*self.model, &ground, &request);
        CaseRow {
            record: series.file.clone(),
            mirrored,
            scale,
            peak_g,
            result: check_finite(&[scale, peak_g]).and(result),
        }
    }
}

/// The cases of one intensity. Those that failed are not among the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FragilityRow {
    /// The intensity.
    pub intensity: f64,
    /// Number of cases that have an outcome.
    pub cases: usize,
    /// Number of those that overturned.
    pub overturned: usize,
    /// Number of those that had neither overturned nor come to rest.
    pub still_rocking: usize,
    /// Number of cases whose history could not be computed.
    pub failed: usize,
    /// What the curve says, if there is one.
    pub curve: Option<CurvePoint>,
}

/// A fragility curve at an intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// The probability of overturning.
    pub probability: f64,
    /// Lower end of its band of 95 % confidence.
    pub low: f64,
    /// Upper end of that.
    pub high: f64,
}

impl FragilityRow {
    /// The part of the cases that overturned.
    #[must_use]
    pub fn fraction(&self) -> Option<f64> {
        (self.cases > 0).then(|| self.overturned as f64 / self.cases as f64)
    }
}

/// What a record does as it gets stronger.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordSurvival<'a> {
    /// The file.
    pub record: &'a str,
    /// Whether it is mirrored.
    pub mirrored: bool,
    /// What it does.
    pub survival: Survival,
}

/// What all cases say together. Those that are still rocking have not overturned; those that failed do not
/// count. Nor do mirrored records: the structures are symmetric, so that they do the same to the other side, and
/// are no further evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct SuiteFragility {
    /// What the intensities are.
    pub measure: Measure,
    /// All cases.
    pub cases: Vec<CaseRow>,
    /// By intensity, lowest first.
    pub levels: Vec<FragilityRow>,
    /// The curve, if there is one.
    pub fit: Result<Fragility, NoFit>,
}

impl SuiteFragility {
    /// What these cases say.
    #[must_use]
    pub fn new(measure: Measure, cases: Vec<CaseRow>) -> Self {
        let evidence: Vec<&CaseRow> = cases.iter().filter(|case| !case.mirrored).collect();
        let indices: BTreeMap<&str, usize> = names(&cases).into_iter().zip(0..).collect();
        let observations: Vec<Observation> = evidence
            .iter()
            .filter(|case| case.result.is_ok())
            .map(|case| Observation {
                intensity: case.level(measure),
                overturned: case.overturned(),
                record: indices[case.record.as_str()],
            })
            .collect();
        let fit = fit(&observations);
        let levels = by_intensity(evidence, |case| case.level(measure));
        let levels = levels.into_iter().map(|(intensity, cases)| {
            let count = |which: fn(&CaseRow) -> bool| cases.iter().filter(|c| which(c)).count();
            let failed = count(|case| case.result.is_err());
            FragilityRow {
                intensity,
                cases: cases.len() - failed,
                overturned: count(CaseRow::overturned),
                still_rocking: count(|case| case.outcome() == Some(Outcome::StillRocking)),
                failed,
                curve: fit.as_ref().ok().map(|fit| {
                    let (low, high) = fit.band(intensity);
                    CurvePoint {
                        probability: fit.probability(intensity),
                        low,
                        high,
                    }
                }),
            }
        });
        Self {
            measure,
            levels: levels.collect(),
            fit,
            cases,
        }
    }

    /// Where each record first overturns and is survived again, by intensity; mirrored ones only where these differ.
    #[must_use]
    pub fn survivals(&self) -> Vec<RecordSurvival<'_>> {
        let shakes = self
            .cases
            .chunk_by(|a, b| a.record == b.record && a.mirrored == b.mirrored);
        let mut survivals: Vec<RecordSurvival<'_>> = Vec::new();
        for cases in shakes {
            let levels: Vec<_> = cases
                .iter()
                .map(|case| {
                    let overturned = case.outcome().map(|_| case.overturned());
                    (case.level(self.measure), overturned)
                })
                .collect();
            let survival = Survival::of_levels(&levels);
            let (record, mirrored) = (cases[0].record.as_str(), cases[0].mirrored);
            let same =
                |other: &RecordSurvival<'_>| other.record == record && other.survival == survival;
            if !(mirrored && survivals.last().is_some_and(same)) {
                survivals.push(RecordSurvival {
                    record,
                    mirrored,
                    survival,
                });
            }
        }
        survivals
    }

    /// Number of records.
    #[must_use]
    pub fn record_count(&self) -> usize {
        names(&self.cases).len()
    }

    /// Names of the records of whose cases all overturned, or none, as `wanted`.
    #[must_use]
    pub fn always(&self, overturned: bool) -> Vec<&str> {
        let mut alike: BTreeMap<&str, bool> = BTreeMap::new();
        for case in self.cases.iter().filter(|case| case.result.is_ok()) {
            *alike.entry(&case.record).or_insert(true) &= case.overturned() == overturned;
        }
        let alike = alike.into_iter().filter(|(_, alike)| *alike);
        alike.map(|(record, _)| record).collect()
    }
}

/// Names of the records.
fn names(cases: &[CaseRow]) -> BTreeSet<&str> {
    cases.iter().map(|case| case.record.as_str()).collect()
}
