//! Report and tables of an ensemble, for any question.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::influence::{InfluencedAnswer, Influences, NumberInfluence, percent};
use super::samples::ReasonCounts;
use super::{NoAnswer, SampleRow, Samples};
use crate::output::{Cell, Column, Figure, OutputError, Table, column, list};
use crate::scenario::Varied;
use crate::studies::quotable::SurvivorFriction;
use crate::studies::report::Warnings;
use crate::studies::statistics::Share;
use crate::studies::{ModelCheck, one_direction};

/// A row of the table of samples: the number of the sample, from 1, or 0 for the scenario itself; and its values and answer.
pub(super) type Line<'a, A> = (usize, &'a SampleRow<A>);

/// Makes the table of samples: their numbers, their values, and these columns.
pub(super) fn table<'a, A: 'a>(
    samples: &Samples<'a, A>,
    columns: impl IntoIterator<Item = Column<'a, Line<'a, A>>>,
) -> Result<Table, OutputError> {
    let uncertain = &samples.uncertain.keys;
    let keys = uncertain.iter().map(|key| key.key.clone());
    let mut all = vec![
        column("sample", |(number, _): &Line<'_, A>| *number),
        list(keys, |(number, row): &Line<'_, A>| -> Vec<Option<f64>> {
            match number {
                0 => uncertain.iter().map(|key| key.own).collect(),
                _ => row.values.iter().copied().map(Some).collect(),
            }
        }),
    ];
    all.extend(columns);
    Table::new(all, &samples.lines().collect::<Vec<_>>())
}

/// Column of the answers; it is empty for samples without an answer.
pub(super) fn answer_column<'a, A: 'a, C: Into<Cell<'static>>>(
    name: &'static str,
    cell: impl Fn(&A) -> C + 'a,
) -> Column<'a, Line<'a, A>> {
    column(name, move |(_, row): &Line<'_, A>| {
        row.answer.as_ref().ok().map(&cell)
    })
}

/// Column with the reasons for samples without an answer.
pub(super) fn why_not<'a, A: 'a>() -> Column<'a, Line<'a, A>> {
    column("why_not", |(_, row): &Line<'_, A>| {
        row.answer.as_ref().err().map(NoAnswer::name)
    })
}

/// The uncertainty that samples do not cover.
const NOT_CONSIDERED: &str = "not considered: numbers that [uncertain] does not name, other ground motions, and the model of motion itself";

/// The common part of all reports on samples; it comes first.
#[derive(Serialize, Deserialize)]
pub(super) struct SampleSummary {
    /// Name of the program.
    program: String,
    /// Version of the program.
    version: String,
    /// The scenario with all defaults.
    scenario: Value,
    #[serde(flatten)]
    pub(super) warnings: Warnings,
    /// The only direction of the ground motion that was computed, in words; absent if both count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) one_direction: Option<String>,
    /// Number of samples.
    pub(super) samples: usize,
    /// Number of samples with an answer.
    pub(super) answered: usize,
    #[serde(flatten)]
    pub(super) without: ReasonCounts,
    #[serde(flatten)]
    pub(super) model: ModelCheck,
    #[serde(flatten)]
    pub(super) friction: SurvivorFriction,
    /// The reason why the scenario itself has no answer; null if it has one.
    pub(super) own_without_answer: Option<String>,
    /// The samples without an answer.
    without_answer: Vec<WithoutAnswer>,
    /// The uncertainty that samples do not cover.
    pub(super) not_considered: String,
    /// Influence of each uncertain number on each answer.
    pub(super) what_matters: Influences,
}

/// Number of histories outside the model of four links, or the largest excess of the thrust line, in words; `None` if the thrust line stays
/// almost inside.
fn outside_in_words(model: &ModelCheck, checked: &str) -> Option<String> {
    let words = model.in_words(checked)?;
    Some(match model.outside {
        Some(1..) => format!("{words}; they have no verdict, and count only in intervals"),
        _ => words,
    })
}

/// A sample without an answer.
#[derive(Serialize, Deserialize)]
struct WithoutAnswer {
    /// Number of the sample, from 1.
    sample: usize,
    /// `invalid`, `failed`, `incomplete` or `outside_model`.
    why: String,
    /// The reason in words.
    reason: String,
}

impl SampleSummary {
    /// Makes the summary of samples. `checked` are the histories whose `model` is checked, in words, and `no_verdict` is the warning about incomplete ones.
    /// `study` are options that are not part of the scenario.
    pub(super) fn new<A, const N: usize>(
        (samples, study): (&Samples<'_, A>, &Varied<'_>),
        model: ModelCheck,
        friction: SurvivorFriction,
        (checked, no_verdict): (&str, Option<String>),
        influences: [(InfluencedAnswer, Option<Vec<NumberInfluence>>); N],
    ) -> Self {
        let scenario = samples.scenario;
        let condition = friction.friction_condition.clone();
        let one_direction = one_direction(scenario);
        let limits = [outside_in_words(&model, checked), no_verdict]
            .into_iter()
            .flatten()
            .chain(condition)
            .chain(one_direction.clone());
        let own = samples.own.as_ref().err();
        let without = samples
            .samples_without_answer()
            .map(|(sample, why)| WithoutAnswer {
                sample,
                why: why.name().to_owned(),
                reason: why.reason().to_owned(),
            });
        Self {
            program: env!("CARGO_PKG_NAME").to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scenario: scenario.to_json(),
            warnings: Warnings::new(scenario.unlikely_in(study), limits),
            one_direction,
            samples: samples.rows.len(),
            answered: samples.answers().count(),
            without: samples.reasons(),
            model,
            friction,
            own_without_answer: own.map(|why| why.reason().to_owned()),
            without_answer: without.collect(),
            not_considered: NOT_CONSIDERED.to_owned(),
            what_matters: Influences(influences.into()),
        }
    }

    /// Draws the influence of each number on each answer.
    pub(super) fn draw_influences<A>(&self, samples: &Samples<'_, A>, figure: Figure) -> String {
        let title = samples.title("Influence of uncertain data");
        self.what_matters.draw(figure, title)
    }

    /// Verdict on the samples; that there is none without an answer.
    pub(super) fn verdict(&self, verdict: impl FnOnce() -> String) -> String {
        match self.answered {
            0 => "no sample has a verdict".to_owned(),
            _ => verdict(),
        }
    }

    /// Reason of the first sample that has no answer for this reason.
    pub(super) fn first_reason(&self, why: &str) -> Option<&str> {
        let first = self.without_answer.iter().find(|one| one.why == why)?;
        Some(&first.reason)
    }
}

/// Quantiles of the answers; null if they are unknown or infinite.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Band {
    /// 5 % quantile.
    pub(super) quantile_05: Option<f64>,
    /// Median.
    pub(super) median: Option<f64>,
    /// 95 % quantile.
    pub(super) quantile_95: Option<f64>,
}

impl From<[Option<f64>; 3]> for Band {
    fn from(quantiles: [Option<f64>; 3]) -> Self {
        let finite = |value: Option<f64>| value.filter(|value| value.is_finite());
        let [quantile_05, median, quantile_95] = quantiles.map(finite);
        Self {
            quantile_05,
            median,
            quantile_95,
        }
    }
}

impl Share {
    /// Share of samples with its interval in words.
    pub(super) fn in_words(&self) -> String {
        let [part, low, high] = self.numbers().map(percent);
        let certain = match self.uncertain {
            0 => self.count.to_string(),
            uncertain => format!("{} certain and {uncertain} uncertain", self.count),
        };
        let of = self.of;
        match self.is_known_by_interval_only() {
            true => format!("{low} to {high} (95 %; {certain} of {of} samples with a verdict)"),
            false => format!("{part} (95 %: {low} to {high}), {certain} of {of} samples"),
        }
    }

    /// Treatment of uncertain samples, and of samples without a verdict, in a probability of overturning, in words; `None` without such
    /// samples.
    pub(super) fn doubts_in_words(&self) -> Option<String> {
        let (uncertain, no_verdict) = (self.uncertain, self.no_verdict);
        (uncertain + no_verdict > 0).then(|| {
            format!(
                "the interval holds whether {uncertain} uncertain samples, counted with the fraction of their repetitions that \
                 overturn, and {no_verdict} samples without a verdict survive or overturn"
            )
        })
    }
}
