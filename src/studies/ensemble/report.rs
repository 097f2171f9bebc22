//! Files, JSON and words of an ensemble, for any question.

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::influence::{self, Influence, percent};
use super::{NoAnswer, Samples};
use crate::output::{Cell, Column, Figure, OutputError, column, csv, each, list};
use crate::scenario::Uncertain;
use crate::studies::statistics::Share;
use crate::studies::{ModelCheck, Results};

/// The findings about the answers to a question.
pub struct Findings<'a, A, D> {
    /// First sentence of the words, before the influence of the uncertain numbers; `None` if no sample has an answer.
    pub(super) first: Option<String>,
    /// Further lines of the words.
    pub(super) lines: Vec<String>,
    /// The influences of the uncertain numbers. The words show the first known influence.
    pub(super) influences: Vec<Influence<'a>>,
    /// Number of histories without a verdict, and the remedy, in words; `None` if the number is zero.
    pub(super) no_verdict: Option<String>,
    /// The histories of four links outside their model.
    pub(super) model: ModelCheck,
    /// The checked histories in words.
    pub(super) checked: &'static str,
    /// The part of the summary that is specific to the question.
    pub(super) details: D,
    /// Pictures and pages.
    pub(super) pictures: Vec<String>,
    /// Tables before the table of samples.
    pub(super) tables: Vec<Vec<u8>>,
    /// Columns of the table of samples; without columns there is no such table.
    pub(super) columns: Vec<Column<'a, Line<'a, A>>>,
    /// Largest rotations, as in [`Results`].
    pub(super) peaks: Vec<f64>,
}

/// A row of the table of samples: the number of the sample, from 1, or 0 for the scenario itself; its values; and its answer.
pub(super) struct Line<'a, A> {
    pub(super) number: usize,
    values: Vec<Option<f64>>,
    pub(super) answer: &'a Result<A, NoAnswer>,
}

/// Returns the rows of the table of samples: the scenario itself, then all samples.
pub(super) fn lines<'a, A>(samples: &Samples<'a, A>) -> Vec<Line<'a, A>> {
    let own = Line {
        number: 0,
        values: samples.uncertain.keys.iter().map(|key| key.own).collect(),
        answer: samples.own,
    };
    let rows = samples.rows.iter().zip(1..).map(|(row, number)| Line {
        number,
        values: row.values.iter().copied().map(Some).collect(),
        answer: &row.answer,
    });
    [own].into_iter().chain(rows).collect()
}

/// Returns the columns with the numbers of the samples and their values.
fn sample_columns<'a, A: 'a>(uncertain: &Uncertain) -> Vec<Column<'a, Line<'a, A>>> {
    let names: Vec<String> = uncertain.keys.iter().map(|key| key.key.clone()).collect();
    vec![
        column("sample", |line: &Line<'_, A>| line.number),
        list(names, |line: &Line<'_, A>| line.values.clone()),
    ]
}

/// Returns a column of the answers; it is empty for samples without an answer.
pub(super) fn of_answer<'a, A: 'a, C: Into<Cell<'static>>>(
    name: &'static str,
    cell: impl Fn(&A) -> C + 'a,
) -> Column<'a, Line<'a, A>> {
    column(name, move |line: &Line<'_, A>| {
        line.answer.as_ref().ok().map(&cell)
    })
}

/// Returns the column with the reasons of samples without an answer.
pub(super) fn why_not<'a, A: 'a>() -> Column<'a, Line<'a, A>> {
    column("why_not", |line: &Line<'_, A>| {
        line.answer.as_ref().err().map(NoAnswer::name)
    })
}

/// The uncertainty that samples do not cover.
const NOT_CONSIDERED: &str = "not considered: numbers that [uncertain] does not name, other ground motions, and the model of motion itself";

/// Summary of the samples of a scenario.
#[derive(Serialize)]
struct SampleSummary<'a, D> {
    /// Name of the program.
    program: &'static str,
    /// Version of the program.
    version: &'static str,
    /// The scenario with all defaults.
    scenario: Value,
    /// Warnings about unlikely numbers, limits of the model, and histories without a verdict.
    warnings: Vec<String>,
    /// Number of samples.
    samples: usize,
    /// Number of samples with an answer.
    answered: usize,
    /// Number of samples whose values give no valid structure.
    invalid: usize,
    /// Number of samples that could not be computed.
    failed: usize,
    /// Number of samples whose histories ended too early for a verdict.
    incomplete: usize,
    #[serde(flatten)]
    model: ModelCheck,
    /// The samples without an answer, with the reasons.
    without_answer: Vec<Value>,
    /// The uncertainty that samples do not cover.
    not_considered: &'static str,
    #[serde(flatten)]
    details: &'a D,
    /// Influence of each uncertain number on each answer.
    what_matters: Map<String, Value>,
}

/// Quantiles of the answers; null if they are unknown or infinite.
#[derive(Serialize)]
pub(super) struct Band {
    quantile_05: Option<f64>,
    median: Option<f64>,
    quantile_95: Option<f64>,
}

impl From<Option<[f64; 3]>> for Band {
    fn from(band: Option<[f64; 3]>) -> Self {
        let finite = |value: Option<f64>| value.filter(|value| value.is_finite());
        let [quantile_05, median, quantile_95] = each(band).map(finite);
        Self {
            quantile_05,
            median,
            quantile_95,
        }
    }
}

impl<'a, A: 'a, D: Serialize> Findings<'a, A, D> {
    pub(super) fn results(
        self,
        samples: &Samples<'a, A>,
        names: &[&'static str],
        figure: Figure,
    ) -> Result<Results, OutputError> {
        let without = |name: &str| {
            let reasons = samples.without().filter(|(_, why)| why.name() == name);
            reasons.map(|(_, why)| why).collect::<Vec<_>>()
        };
        let [invalid, failed] = ["invalid", "failed"].map(without);
        let reason = |(sample, why): (usize, &NoAnswer)| json!({ "sample": sample, "why": why.name(), "reason": why.reason() });
        let influences = self.influences.iter();
        let outside = self.model.in_words(self.checked);
        let limits = outside.clone().into_iter().chain(self.no_verdict);
        let summary = SampleSummary {
            program: env!("CARGO_PKG_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            scenario: samples.scenario.to_json(),
            warnings: samples
                .scenario
                .unlikely()
                .into_iter()
                .chain(limits)
                .collect(),
            samples: samples.rows.len(),
            answered: samples.answers().count(),
            invalid: invalid.len(),
            failed: failed.len(),
            incomplete: without("incomplete").len(),
            model: self.model,
            without_answer: samples.without().map(reason).collect(),
            not_considered: NOT_CONSIDERED,
            details: &self.details,
            what_matters: influences
                .map(|influence| (influence.name.to_owned(), json!(influence.numbers)))
                .collect(),
        };
        let mut influences = self.influences.iter();
        let mut known = influences.clone();
        let known = known.find(|influence| influence.numbers.is_some());
        let decides = known.or(influences.next_back());
        let decides = decides.map_or(String::new(), Influence::in_words);
        let first = self.first;
        let first = first.map(|first| format!("{first};\n    {decides};\n    {NOT_CONSIDERED}"));
        let mut words = vec![first.unwrap_or("no sample has an answer".to_owned())];
        words.extend(self.lines);
        words.extend(outside);
        for (reasons, what) in [
            (invalid, "make no valid structure, and do not count"),
            (failed, "could not be computed"),
        ] {
            words.extend(reasons.first().map(|first| {
                format!(
                    "{} of {} samples {what}; the first: {}",
                    reasons.len(),
                    samples.rows.len(),
                    first.reason()
                )
            }));
        }
        words.extend(samples.no_verdict());
        let title = samples.title("Influence of uncertain data");
        let mut contents: Vec<Vec<u8>> =
            self.pictures.into_iter().map(String::into_bytes).collect();
        contents.push(influence::draw(figure, title, &self.influences).into_bytes());
        contents.extend(self.tables);
        if !self.columns.is_empty() {
            let mut columns = sample_columns(samples.uncertain);
            columns.extend(self.columns);
            contents.push(csv(columns, &lines(samples))?);
        }
        Ok(Results {
            peaks: self.peaks,
            ..Results::with_words(names, &summary, words.join("\n  "), contents)?
        })
    }
}

/// Returns a share with its interval in words.
pub(super) fn share_in_words(share: &Share) -> String {
    let [part, low, high] = share.numbers().map(percent);
    let certain = match share.uncertain {
        0 => share.count.to_string(),
        uncertain => format!("{} certain and {uncertain} uncertain", share.count),
    };
    let of = share.of;
    format!("{part} (95 %: {low} to {high}), {certain} of {of} samples")
}

/// Returns the treatment of uncertain samples, and of samples without a verdict, in a probability of overturning, in words; empty without such
/// samples.
pub(super) fn doubts_in_words(share: &Share) -> String {
    let (uncertain, no_verdict) = (share.uncertain, share.no_verdict);
    match uncertain + no_verdict {
        0 => String::new(),
        _ => format!(
            ";\n    the interval holds whether {uncertain} uncertain samples, counted with the fraction of their repetitions that overturn, \
             and {no_verdict} samples without a verdict survive or overturn"
        ),
    }
}
