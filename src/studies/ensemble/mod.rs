//! The consequences of uncertain numbers: a question answered for every sample of a scenario.
//!
//! An ensemble is a study. Its first case is the scenario itself; each other case is a sample of [`Uncertain`]. A [`Question`] is
//! answered for each case: the ending and course of its history ([`histories`]), the factor that first overturns it ([`edges`]), or the
//! records that overturn it ([`records`]). The study knows only the answers, so shards, resuming and threads work alike for all questions;
//! so do the shares, the influence of each number and the files.
//! The cells of a map ([`cells`]) are a study of their own, whose cases are cells of samples.

pub mod cells;
pub mod edges;
pub mod histories;
mod influence;
pub mod matters;
pub mod records;
mod report;
mod samples;

use serde::Serialize;
use serde::de::DeserializeOwned;

pub use self::report::Findings;
pub use self::samples::{SampleRow, Samples};
pub use super::ending::NoAnswer;
use super::results::{Reported, Results, Style};
use super::runner::Study;
use crate::output::{Figure, OutputError};
use crate::scenario::{Scenario, Uncertain};

/// A question that is answered for every sample.
pub trait Question: Sync {
    /// The answer for a sample.
    type Answer: Serialize + DeserializeOwned + Send;

    /// Name of the study in the files of its parts.
    const NAME: &'static str;

    /// Names of the files of its findings, the summary last.
    const FILES: &'static [&'static str];

    /// The findings from all answers.
    ///
    /// # Errors
    /// When a value is not finite.
    fn findings<'a>(
        &'a self,
        samples: &Samples<'a, Self::Answer>,
        figure: Figure,
    ) -> Result<Findings<'a, Self::Answer, impl Serialize>, OutputError>;

    /// The answer for a scenario that has the values of the sample.
    ///
    /// # Errors
    /// Explains why there is none.
    fn answer(&self, scenario: &Scenario) -> Result<Self::Answer, NoAnswer>;

    /// The answer for the scenario itself, which may be computed more accurately than those of its samples.
    ///
    /// # Errors
    /// As [`Question::answer`].
    fn own_answer(&self, scenario: &Scenario) -> Result<Self::Answer, NoAnswer> {
        self.answer(scenario)
    }

    /// Other settings on which the answers depend, in words.
    fn settings(&self) -> Vec<String> {
        Vec::new()
    }
}

/// The samples of a scenario and the question about each. The first case is the scenario itself.
#[derive(Debug)]
pub struct Ensemble<'a, Q> {
    scenario: &'a Scenario,
    uncertain: &'a Uncertain,
    question: Q,
}

impl<'a, Q: Question> Ensemble<'a, Q> {
    /// The ensemble of a scenario with a table `[uncertain]`, unless the question does not fit the scenario.
    ///
    /// # Errors
    /// Explains that the question does not fit, or that the scenario has no such table.
    pub fn new(scenario: &'a Scenario, question: Result<Q, String>) -> Result<Self, String> {
        Ok(Self {
            question: question?,
            uncertain: uncertain(scenario)?,
            scenario,
        })
    }
}

/// The uncertain numbers of a scenario, or an explanation that it has none.
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

    fn inputs(&self) -> Vec<String> {
        let mut inputs = self.scenario.record_checksums();
        inputs.extend(self.question.settings());
        inputs
    }

    fn count(&self) -> usize {
        1 + self.uncertain.cases()
    }

    fn row(&self, index: usize) -> Self::Row {
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

impl<Q: Question> Reported for Ensemble<'_, Q> {
    const FILES: &'static [&'static str] = Q::FILES;

    fn results(&self, rows: Vec<Self::Row>, style: Style) -> Result<Results, OutputError> {
        let samples = Samples::new(self.scenario, self.uncertain, &rows);
        let findings = self.question.findings(&samples, style.figure)?;
        findings.results(&samples, Q::FILES, style.figure)
    }
}
