//! The consequences of uncertain numbers: a question answered for every sample of a scenario.
//!
//! An ensemble is a study. Its first case is the scenario itself; each other case is a sample of [`Uncertain`]. A [`Question`] is
//! asked of each case: how its history ends and proceeds ([`histories`]), from which factor it overturns ([`edges`]), or which
//! records overturn it ([`records`]). The study knows only the answers, so shards, resuming and threads work alike for all questions.
//! The cells of a map ([`cells`]) are a study of their own, whose cases are cells of samples.

pub mod cells;
pub mod edges;
pub mod histories;
pub mod matters;
mod picture;
pub mod records;
mod told;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use self::matters::{Matters, total_indices, what_matters};
pub use super::ending::NoAnswer;
use super::remarks::no_verdict;
use super::results::{Look, Reported, Results};
use super::runner::Study;
pub use super::statistics;
use crate::output::{Figure, OutputError};
use crate::scenario::{Scenario, Uncertain};

/// A question that is asked of every sample.
pub trait Question: Sync {
    /// The result for a sample.
    type Answer: Serialize + DeserializeOwned + Send;

    /// Name of the study in the files of its parts.
    const NAME: &'static str;

    /// The files and words of all answers.
    ///
    /// # Errors
    /// When a value is not finite.
    fn results(
        &self,
        told: &Told<'_, Self::Answer>,
        figure: Figure,
    ) -> Result<Results, OutputError>;

    /// The answer for a scenario that has the values of the sample.
    ///
    /// # Errors
    /// Explains why there is none.
    fn answer(&self, scenario: &Scenario) -> Result<Self::Answer, NoAnswer>;

    /// The answer for the scenario itself, where that is computed with more care than its samples.
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

/// A sample and its answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleRow<A> {
    /// Its values, in the order of the keys; empty for the scenario itself.
    pub values: Vec<f64>,
    /// Its answer.
    pub answer: Result<A, NoAnswer>,
}

/// The samples of a scenario and the question asked of each. The first case is the scenario itself.
#[derive(Debug)]
pub struct Ensemble<'a, Q> {
    scenario: &'a Scenario,
    uncertain: &'a Uncertain,
    question: Q,
}

impl<'a, Q: Question> Ensemble<'a, Q> {
    /// The ensemble of a scenario with a table `[uncertain]`.
    ///
    /// # Errors
    /// Explains that the scenario has no such table.
    pub fn new(scenario: &'a Scenario, question: Q) -> Result<Self, String> {
        Ok(Self {
            scenario,
            uncertain: uncertain(scenario)?,
            question,
        })
    }
}

/// What is uncertain in a scenario, or in words that nothing is.
fn uncertain(scenario: &Scenario) -> Result<&Uncertain, String> {
    scenario.uncertain().ok_or_else(|| {
        "the scenario has no [uncertain]: give it a table such as\n\n\
         [uncertain]\n\
         samples = 100\n\
         \"arch.thickness_ratio\" = { deviation = 0.003 }"
            .to_owned()
    })
}

impl<Q: Question> Study for Ensemble<'_, Q> {
    type Row = SampleRow<Q::Answer>;

    const NAME: &'static str = Q::NAME;

    fn scenario(&self) -> String {
        self.scenario.to_toml()
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
    fn results(&self, rows: Vec<Self::Row>, look: Look) -> Result<Results, OutputError> {
        let told = Told::new(self.scenario, self.uncertain, &rows);
        self.question.results(&told, look.figure)
    }
}

/// The rows of an ensemble, with that of the scenario itself set apart.
pub struct Told<'a, A> {
    /// The scenario.
    pub(crate) scenario: &'a Scenario,
    pub(crate) uncertain: &'a Uncertain,
    /// The answer of the scenario itself.
    pub(crate) own: &'a Result<A, NoAnswer>,
    /// The samples, in their order.
    pub(crate) samples: &'a [SampleRow<A>],
    /// Those in which one number has another value, as [`Uncertain::cases`] says; empty unless total indices are asked for.
    moved: &'a [SampleRow<A>],
}

impl<'a, A> Told<'a, A> {
    pub(crate) fn new(
        scenario: &'a Scenario,
        uncertain: &'a Uncertain,
        rows: &'a [SampleRow<A>],
    ) -> Self {
        let (own, samples) = rows.split_first().expect("the scenario itself is a case");
        let (samples, moved) = samples.split_at(uncertain.samples.min(samples.len()));
        Self {
            scenario,
            uncertain,
            own: &own.answer,
            samples,
            moved,
        }
    }

    /// The samples that have an answer.
    pub(crate) fn answered(&self) -> impl Iterator<Item = (&'a [f64], &'a A)> + Clone {
        let samples = self.samples.iter();
        samples.filter_map(|row| Some((&*row.values, row.answer.as_ref().ok()?)))
    }

    /// How many samples ended too early for a verdict, and what to do; `None` if none did.
    fn no_verdict(&self) -> Option<String> {
        let incomplete = self.without(NoAnswer::Incomplete.name());
        no_verdict(incomplete, self.samples.len(), "samples")
    }

    /// The number of samples without an answer for this reason, given by its name.
    pub(crate) fn without(&self, name: &str) -> usize {
        let reasons = self
            .samples
            .iter()
            .filter_map(|row| row.answer.as_ref().err());
        reasons.filter(|reason| reason.name() == name).count()
    }

    /// Which uncertain numbers matter for a number of each sample, or for its rank.
    pub(crate) fn what_matters(
        &self,
        by_rank: bool,
        number: impl Fn(&A) -> f64,
    ) -> Option<Vec<Matters>> {
        let known = |rows: &[SampleRow<A>]| -> Vec<Option<f64>> {
            let answers = rows.iter().map(|row| row.answer.as_ref().ok());
            answers.map(|answer| answer.map(&number)).collect()
        };
        let values: Vec<Vec<f64>> = self.answered().map(|(values, _)| values.to_vec()).collect();
        let own = numbers(&known(self.samples), by_rank);
        let answers: Vec<f64> = own.iter().flatten().copied().collect();
        let mut matters = what_matters(&values, &answers)?;
        if !self.moved.is_empty() {
            let all = [self.samples, self.moved].map(known).concat();
            let all = numbers(&all, by_rank);
            let (own, moved) = all.split_at(self.samples.len());
            for (matters, total) in matters.iter_mut().zip(total_indices(own, moved)?) {
                matters.total = Some(total);
            }
        }
        Some(matters)
    }
}

/// The numbers that there are as they are, or their ranks.
fn numbers(of: &[Option<f64>], by_rank: bool) -> Vec<Option<f64>> {
    if !by_rank {
        return of.to_vec();
    }
    let known: Vec<f64> = of.iter().flatten().copied().collect();
    let mut ranks = statistics::ranks(&known).into_iter();
    of.iter()
        .map(|number| number.and_then(|_| ranks.next()))
        .collect()
}
