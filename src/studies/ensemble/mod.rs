//! Ensembles: a question that is answered for every sample of a scenario with uncertain numbers.
//!
//! An ensemble is a study. Its first case is the scenario itself; each other case is a sample of [`Uncertain`]. A [`Question`] is answered for
//! each case: the history of the sample (`uncertain_run`), the first factor that overturns it (`uncertain_threshold`), or the intensity of each
//! record that overturns it (`uncertain_suite`). Shards, resuming, threads, shares and influences are common to all questions. The cells of a map
//! (`uncertain_map`) are a separate study, whose cases are cells of samples.

mod influence;
mod page;
mod report;
mod samples;
mod sensitivity;
pub(super) mod uncertain_map;
pub(super) mod uncertain_run;
pub(super) mod uncertain_suite;
pub(super) mod uncertain_threshold;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

pub use self::samples::{SampleRow, Samples};
pub use self::sensitivity::{sensitivities, total_indices};
pub use self::uncertain_map::{CellsOfSamples, UncertainMapSummary};
pub use self::uncertain_run::{Histories, HistoryAnswer, UncertainRunSummary};
pub use self::uncertain_suite::UncertainSuiteSummary;
pub use self::uncertain_threshold::UncertainThresholdSummary;
pub use super::ending::NoAnswer;
use super::threshold::Factors;
use super::{ReportedStudy, Results, Study, Style};
use crate::output::{Figure, OutputError};
use crate::scenario::{Scenario, Uncertain};

/// A question that is answered for every sample.
pub trait Question: Sized + Sync {
    /// The answer for a sample.
    type Answer: Serialize + DeserializeOwned + Send;

    /// Name of the study, in part files and in their names.
    const NAME: &'static str;

    /// Names of the files, the report last.
    const FILES: &'static [&'static str];

    /// Makes the question for a scenario. `factors` are those on the ground motion that a threshold tries.
    ///
    /// # Errors
    /// Returns the change that the scenario needs, in words.
    fn of(scenario: &Scenario, factors: Factors) -> Result<Self, String>;

    /// Makes the report and the other files of all answers.
    ///
    /// # Errors
    /// When a value is not finite.
    fn results(
        &self,
        samples: &Samples<'_, Self::Answer>,
        figure: Figure,
    ) -> Result<Results, OutputError>;

    /// Computes the answer of a scenario that has the values of a sample.
    ///
    /// # Errors
    /// The reason why there is no answer.
    fn answer(&self, scenario: &Scenario) -> Result<Self::Answer, NoAnswer>;

    /// Computes the answer of the scenario itself, which may be more accurate than those of the samples.
    ///
    /// # Errors
    /// As [`Question::answer`].
    fn own_answer(&self, scenario: &Scenario) -> Result<Self::Answer, NoAnswer> {
        self.answer(scenario)
    }

    /// Returns the options on which the answers depend, as [`Study::options`].
    fn options(&self) -> Value {
        Value::Null
    }
}

/// A study that answers a question for every sample of a scenario. The first case is the scenario itself.
#[derive(Debug)]
pub struct Ensemble<'a, Q> {
    scenario: &'a Scenario,
    uncertain: &'a Uncertain,
    question: Q,
}

impl<'a, Q: Question> Ensemble<'a, Q> {
    /// Makes the ensemble of a scenario with a table `[uncertain]`.
    ///
    /// # Errors
    /// When the question does not fit the scenario, or the scenario has no table `[uncertain]`.
    pub fn of(scenario: &'a Scenario, factors: Factors) -> Result<Self, String> {
        Ok(Self {
            question: Q::of(scenario, factors)?,
            uncertain: uncertain(scenario)?,
            scenario,
        })
    }

    /// Computes the answer of the scenario itself, or of a sample, counted from 1.
    fn row(&self, index: usize) -> SampleRow<Q::Answer> {
        let Some(sample) = index.checked_sub(1) else {
            return SampleRow {
                values: Vec::new(),
                answer: self.question.own_answer(self.scenario),
            };
        };
        let values = self.uncertain.values(sample);
        let scenario = self.uncertain.scenario(self.scenario, &values);
        let answer = scenario
            .map_err(NoAnswer::Invalid)
            .and_then(|scenario| self.question.answer(&scenario));
        SampleRow { values, answer }
    }
}

/// Returns the uncertain numbers of a scenario, or the error that the scenario has none.
fn uncertain(scenario: &Scenario) -> Result<&Uncertain, String> {
    Ok(scenario.uncertain.as_ref().ok_or(
        "the scenario has no [uncertain]: give it a table such as\n\n\
         [uncertain]\n\
         samples = 100\n\
         \"arch.thickness_ratio\" = { deviation = 0.003 }",
    )?)
}

impl<Q: Question> Study for Ensemble<'_, Q> {
    type Row = SampleRow<Q::Answer>;

    const NAME: &'static str = Q::NAME;

    fn base(&self) -> Option<&Scenario> {
        Some(self.scenario)
    }

    fn options(&self) -> Value {
        self.question.options()
    }

    fn count(&self) -> usize {
        1 + self.uncertain.cases()
    }

    fn rows(&self, indices: &[usize]) -> Vec<Self::Row> {
        indices.iter().map(|index| self.row(*index)).collect()
    }
}

impl<Q: Question> ReportedStudy for Ensemble<'_, Q> {
    const FILES: &'static [&'static str] = Q::FILES;

    fn results(&self, rows: Vec<Self::Row>, style: Style) -> Result<Results, OutputError> {
        let samples = Samples::new(self.scenario, self.uncertain, &rows);
        self.question.results(&samples, style.figure)
    }
}
