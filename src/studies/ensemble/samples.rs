//! The answers of all samples.

use serde::{Deserialize, Serialize};

use super::influence::NumberInfluence;
use super::sensitivity::{Total, sensitivities, total_indices};
use super::{NoAnswer, SampleCases};
use crate::scenario::{Scenario, Uncertain};
use crate::studies::statistics::{Share, ranks};
use crate::studies::{ModelCheck, no_verdict};

/// A sample and its answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleRow<A> {
    /// Values of the sample, in the order of the keys; empty for the scenario itself.
    pub values: Vec<f64>,
    /// Answer of the sample, or the reason why there is none.
    pub answer: Result<A, NoAnswer>,
}

/// The answers of a study of samples, with the answer of the scenario itself separate.
pub struct Samples<'a, A> {
    /// The scenario.
    pub(crate) scenario: &'a Scenario,
    pub(crate) uncertain: &'a Uncertain,
    /// The scenario itself, and the samples in their order.
    all: &'a [SampleRow<A>],
    /// The answer of the scenario itself.
    pub(crate) own: &'a Result<A, NoAnswer>,
    /// The samples, in their order.
    pub(crate) rows: &'a [SampleRow<A>],
    /// Samples in which a single number has another value (see [`Uncertain::cases`]); empty without total indices.
    moved: &'a [SampleRow<A>],
}

impl<'a, A> Samples<'a, A> {
    /// Separates the answers of all cases.
    pub(super) fn new(cases: SampleCases<'a>, rows: &'a [SampleRow<A>]) -> Self {
        let SampleCases {
            scenario,
            uncertain,
        } = cases;
        let (all, moved) = rows.split_at((1 + uncertain.samples).min(rows.len()));
        let (own, rows) = all.split_first().expect("the scenario itself is a case");
        Self {
            scenario,
            uncertain,
            all,
            own: &own.answer,
            rows,
            moved,
        }
    }

    /// Scenario itself and all samples, with their numbers from 0.
    pub(super) fn lines(&self) -> impl Iterator<Item = (usize, &'a SampleRow<A>)> + use<'a, A> {
        self.all.iter().enumerate()
    }

    /// Title of the scenario, or `otherwise` without one.
    pub(crate) fn title(&self, otherwise: &'a str) -> &'a str {
        self.scenario.title.as_deref().unwrap_or(otherwise)
    }

    /// Answers of all samples that have one.
    pub(crate) fn answers(&self) -> impl Iterator<Item = &'a A> + Clone + use<'a, A> {
        self.rows.iter().filter_map(|row| row.answer.as_ref().ok())
    }

    /// Numbers of the samples without an answer, from 1, and the reasons.
    pub(super) fn samples_without_answer(
        &self,
    ) -> impl Iterator<Item = (usize, &'a NoAnswer)> + use<'a, A> {
        let rows = self.lines().skip(1);
        rows.filter_map(|(number, row)| Some((number, row.answer.as_ref().err()?)))
    }

    /// Share of samples with a property, from its probability in each answer. Samples without an answer have no verdict, but those
    /// that are no valid structure do not count. `None` without answers.
    pub(crate) fn share(&self, chance: impl Fn(&A) -> f64) -> Option<Share> {
        let chance = |row: &'a SampleRow<A>| match &row.answer {
            Ok(answer) => Some(Some(chance(answer))),
            Err(why) => (!matches!(why, NoAnswer::Invalid(_))).then_some(None),
        };
        Share::of_chances(self.rows.iter().filter_map(chance))
    }

    /// Histories of four links outside their model; `excess_ratios` are those of the samples with an answer.
    pub(super) fn model_check(
        &self,
        excess_ratios: impl IntoIterator<Item = Option<f64>>,
    ) -> ModelCheck {
        ModelCheck::of(excess_ratios).with_outside(self.reasons().outside)
    }

    /// Number of valid structures without an answer.
    pub(super) fn count_unknown(&self) -> usize {
        let reasons = self.reasons();
        reasons.failed + reasons.incomplete + reasons.outside
    }

    /// Numbers of samples without an answer.
    pub(super) fn reasons(&self) -> ReasonCounts {
        ReasonCounts::of(self.samples_without_answer().map(|(_, why)| why))
    }

    /// Number of samples without a verdict, and the remedy, in words; `None` if the number is zero.
    pub(super) fn no_verdict(&self) -> Option<String> {
        self.reasons().no_verdict(self.rows.len(), "samples")
    }

    /// Computes the influence of the uncertain numbers on a number of each sample, or on the rank of that number, in the order of the keys. `None` if
    /// the samples do not differ or are too few.
    pub(super) fn influence(
        &self,
        by_rank: bool,
        number: impl Fn(&A) -> f64,
    ) -> Option<Vec<NumberInfluence>> {
        let known = |rows: &[SampleRow<A>]| -> Vec<Option<f64>> {
            let answers = rows.iter().map(|row| row.answer.as_ref().ok());
            answers.map(|answer| answer.map(&number)).collect()
        };
        let answered = self.rows.iter().filter(|row| row.answer.is_ok());
        let values: Vec<Vec<f64>> = answered.map(|row| row.values.clone()).collect();
        let own = numbers(known(self.rows), by_rank);
        let answers: Vec<f64> = own.into_iter().flatten().collect();
        let mut all = sensitivities(&values, &answers)?;
        if !self.moved.is_empty() {
            let answers = numbers([self.rows, self.moved].map(known).concat(), by_rank);
            let (own, moved) = answers.split_at(self.rows.len());
            for (one, total) in all.iter_mut().zip(total_indices(own, moved)?) {
                one.total = Some(total);
            }
        }
        // A number without others has all of the influence.
        if let [only] = &mut all[..] {
            (only.first_order, only.first_order_interval) = (1.0, [1.0; 2]);
            only.total = only.total.map(|_| Total {
                total: 1.0,
                total_interval: [1.0; 2],
            });
        }
        let keys = self.uncertain.keys.iter().map(|key| key.key.clone());
        let of_keys = keys
            .zip(all)
            .map(|(key, sensitivity)| NumberInfluence { key, sensitivity });
        Some(of_keys.collect())
    }
}

/// Numbers of samples or histories without an answer.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct ReasonCounts {
    /// Number with values that give no valid structure.
    pub(super) invalid: usize,
    /// Number that could not be computed.
    pub(super) failed: usize,
    /// Number that ended too early for a verdict.
    pub(super) incomplete: usize,
    /// Number outside the model of four links, which have no verdict.
    pub(super) outside: usize,
}

impl ReasonCounts {
    pub(super) fn of<'r>(reasons: impl Iterator<Item = &'r NoAnswer>) -> Self {
        let mut counts = Self::default();
        for reason in reasons {
            *match reason {
                NoAnswer::Invalid(_) => &mut counts.invalid,
                NoAnswer::Failed(_) => &mut counts.failed,
                NoAnswer::Incomplete => &mut counts.incomplete,
                NoAnswer::OutsideModel => &mut counts.outside,
            } += 1;
        }
        counts
    }

    pub(super) const fn total(&self) -> usize {
        self.invalid + self.failed + self.incomplete + self.outside
    }

    /// Number of `cases` that ended too early for a verdict, and the remedy, in words; `None` if the number is zero.
    pub(super) fn no_verdict(&self, of: usize, cases: &str) -> Option<String> {
        no_verdict(self.incomplete, of, cases)
    }
}

/// Known numbers, or their ranks.
fn numbers(of: Vec<Option<f64>>, by_rank: bool) -> Vec<Option<f64>> {
    if !by_rank {
        return of;
    }
    let known: Vec<f64> = of.iter().flatten().copied().collect();
    let mut ranks = ranks(&known).into_iter();
    of.into_iter()
        .map(|number| number.and_then(|_| ranks.next()))
        .collect()
}
