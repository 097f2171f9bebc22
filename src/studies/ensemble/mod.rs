//! What follows from what is not known: a question answered for every sample of the uncertain numbers of a scenario.
//!
//! An ensemble is a study whose first case is the scenario itself; each other case is a sample of [`Uncertain`]. What is asked of a
//! case is a [`Question`]: how a history ends and goes ([`histories`]), from which factor on it overturns ([`edges`]), which records do ([`records`]).
//! The study knows nothing of the question but its answers, so that shards, resuming and threads are the same for all.

pub mod edges;
pub mod histories;
pub mod matters;
mod picture;
pub mod records;
pub mod statistics;
mod told;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use self::matters::{Matters, what_matters};
use super::runner::Study;
use crate::scenario::{Scenario, Uncertain};

/// What is asked of every sample.
pub trait Question: Sync {
    /// What is known of a sample once it is computed.
    type Answer: Serialize + DeserializeOwned + Send;

    /// Name of the study in the files of its parts.
    const NAME: &'static str;

    /// The answer of a scenario that starts from what the sample gives it.
    ///
    /// # Errors
    /// Says why there is none.
    fn answer(&self, scenario: &Scenario) -> Result<Self::Answer, NoAnswer>;

    /// What else the answers depend on, in words.
    fn settings(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Why a sample has no answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoAnswer {
    /// Its values make no structure that stands.
    Invalid(String),
    /// Its history could not be computed.
    Failed(String),
}

impl NoAnswer {
    /// Its name in tables.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Invalid(_) => "invalid",
            Self::Failed(_) => super::ending::columns::FAILED,
        }
    }

    /// Why.
    #[must_use]
    pub fn reason(&self) -> &str {
        match self {
            Self::Invalid(reason) | Self::Failed(reason) => reason,
        }
    }
}

/// A sample, and what it came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleRow<A> {
    /// Its values, in the order of the keys; empty of the scenario itself.
    pub values: Vec<f64>,
    /// Its answer.
    pub answer: Result<A, NoAnswer>,
}

/// The samples of a scenario and what is asked of each. The first case is the scenario itself.
#[derive(Debug)]
pub struct Ensemble<'a, Q> {
    scenario: &'a Scenario,
    uncertain: &'a Uncertain,
    question: Q,
}

impl<'a, Q: Question> Ensemble<'a, Q> {
    /// Of a scenario with a table `[uncertain]`.
    ///
    /// # Errors
    /// In words, that it has none.
    pub fn new(scenario: &'a Scenario, question: Q) -> Result<Self, String> {
        let uncertain = scenario.uncertain().ok_or_else(|| {
            "the scenario has no [uncertain]: give it a table such as\n\n\
             [uncertain]\n\
             samples = 100\n\
             \"arch.thickness_ratio\" = { deviation = 0.003 }"
                .to_owned()
        })?;
        Ok(Self {
            scenario,
            uncertain,
            question,
        })
    }
}

impl<Q: Question> Study for Ensemble<'_, Q> {
    type Row = SampleRow<Q::Answer>;

    const NAME: &'static str = Q::NAME;

    fn scenario(&self) -> String {
        self.scenario.to_toml()
    }

    fn inputs(&self) -> Vec<String> {
        let record = match self.scenario.ground() {
            Some(crate::scenario::Ground::Record(record)) => Some(record),
            _ => None,
        };
        let series = record.into_iter().flat_map(|record| record.series());
        let suite = self.scenario.suite().into_iter();
        let series = series.chain(suite.flat_map(|suite| &suite.records));
        series
            .map(|series| format!("{} {:08x}", series.file, series.checksum()))
            .chain(self.question.settings())
            .collect()
    }

    fn count(&self) -> usize {
        1 + self.uncertain.samples
    }

    fn row(&self, index: usize) -> Self::Row {
        let Some(sample) = index.checked_sub(1) else {
            return SampleRow {
                values: Vec::new(),
                answer: self.question.answer(self.scenario),
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

/// The rows of an ensemble, that of the scenario itself apart.
pub(crate) struct Told<'a, A> {
    /// What was asked.
    pub(crate) scenario: &'a Scenario,
    pub(crate) uncertain: &'a Uncertain,
    /// The answer of the scenario itself.
    pub(crate) own: &'a Result<A, NoAnswer>,
    /// The samples, in their order.
    pub(crate) samples: &'a [SampleRow<A>],
}

impl<'a, A> Told<'a, A> {
    pub(crate) fn new(
        scenario: &'a Scenario,
        uncertain: &'a Uncertain,
        rows: &'a [SampleRow<A>],
    ) -> Self {
        let (own, samples) = rows.split_first().expect("the scenario itself is a case");
        Self {
            scenario,
            uncertain,
            own: &own.answer,
            samples,
        }
    }

    /// The samples that have an answer.
    pub(crate) fn answered(&self) -> impl Iterator<Item = (&'a [f64], &'a A)> {
        let samples = self.samples.iter();
        samples.filter_map(|row| Some((&*row.values, row.answer.as_ref().ok()?)))
    }

    /// How many have none for this reason: by its name.
    pub(crate) fn without(&self, name: &str) -> usize {
        let reasons = self
            .samples
            .iter()
            .filter_map(|row| row.answer.as_ref().err());
        reasons.filter(|reason| reason.name() == name).count()
    }

    /// What matters for a number of each sample that has an answer, in their order.
    pub(crate) fn what_matters(&self, numbers: &[f64]) -> Option<Vec<Matters>> {
        let values: Vec<Vec<f64>> = self.answered().map(|(values, _)| values.to_vec()).collect();
        what_matters(&values, numbers)
    }
}
