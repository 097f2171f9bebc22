//! Files and words of thresholds of overturning.

use serde::Serialize;
use serde_json::Value;

use super::digits::{rounded, rounded_down};
use super::survival::{self, Survival};
use super::{
    EDGE_WIDTH, FactorRange, FactorSample, Factors, RangeEnd, Threshold, VariedThreshold, peak_g,
    picture,
};
use crate::Outcome;
use crate::dynamics::OutcomeCount;
use crate::output::{Figure, OutputError, column, csv, fields};
use crate::scenario::{Ground, Scenario};
use crate::studies::ending::{Ending, NoHistory, Verdict, outcome_name};
use crate::studies::quotable::{self, ModelAnswer};
use crate::studies::statistics::ascending;
use crate::studies::{Remarks, Results};

/// Names of the files, the seal last.
pub const FILES: [&str; 3] = ["threshold.svg", "threshold.csv", "threshold.json"];

/// Summary of the thresholds of scenarios that differ only in their models of motion.
#[derive(Serialize)]
pub struct Summary<'a> {
    /// Name of the program.
    program: &'static str,
    /// Version of the program.
    version: &'static str,
    /// Largest horizontal acceleration of the ground at factor 1, in units of gravity.
    peak_acceleration_g: f64,
    /// The factors that were sampled.
    factors: Factors,
    /// Warnings about unlikely numbers, limits of the models, and histories without a verdict.
    warnings: Vec<String>,
    /// The answer that may be quoted, in words.
    to_quote: Option<String>,
    /// The threshold of each model.
    models: Vec<ModelSummary<'a>>,
}

/// Summary of the threshold of a model.
#[derive(Serialize)]
struct ModelSummary<'a> {
    /// Name of the model.
    model: &'a str,
    /// The scenario with all defaults.
    scenario: Value,
    /// Name and checksum of each record file.
    record_checksums: Vec<String>,
    /// The largest factor up to which the structure certainly survives all sampled factors; null if it does not survive the smallest.
    survives_up_to_factor: Option<f64>,
    /// The smallest factor that certainly overturns the structure; null if no factor does.
    lowest_factor: Option<f64>,
    /// Ranges of factors that overturn the structure, ascending.
    bands: Vec<RangeSummary>,
    /// Safe ranges between bands.
    gaps: Vec<RangeSummary>,
    /// Ranges with an uncertain verdict.
    uncertain: Vec<RangeSummary>,
    /// Ranges whose histories end too early for a verdict.
    incomplete: Vec<RangeSummary>,
    #[serde(flatten)]
    remarks: Remarks,
    /// The lowest factors of structures with other stiffness and contact, and with rigid joints; absent unless joints are elastic.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    variations: Vec<VariedSummary<'a>>,
    /// All histories, in order of ascending factors.
    samples: Vec<SampleSummary>,
}

/// A range of factors.
#[derive(Serialize)]
struct RangeSummary {
    #[serde(flatten)]
    range: FactorRange,
    /// Peak ground acceleration at the smallest factor of the range, in units of gravity.
    from_peak_g: f64,
    /// Peak ground acceleration at the largest factor of the range, in units of gravity.
    to_peak_g: f64,
}

/// The lowest overturning factor of a structure with other properties.
#[derive(Serialize)]
struct VariedSummary<'a> {
    /// The changed property.
    with: &'a str,
    /// The lowest factor that overturns the structure; null if no factor does, or it could not be computed.
    factor: Option<f64>,
    /// Reason why lower factors are not known to overturn the structure.
    from_end: Option<RangeEnd>,
    /// Peak ground acceleration at `factor`, in units of gravity.
    peak_g: Option<f64>,
    /// Number of histories that ended too early for a verdict.
    incomplete: usize,
    /// Reason why the factor could not be computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    failed: Option<&'a str>,
}

/// The history at a factor.
#[derive(Serialize)]
struct SampleSummary {
    /// The factor.
    factor: f64,
    /// Outcome of the history.
    outcome: &'static str,
    #[serde(flatten)]
    history: Option<HistorySummary>,
    /// Count of the outcomes of the history and its repetitions; absent if the history was not repeated.
    #[serde(flatten)]
    count: Option<OutcomeCount>,
    /// Reason why the outcome is uncertain, or why there is no history.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
}

/// The numbers of a history.
#[derive(Clone, Copy, Serialize)]
struct HistorySummary {
    /// The side to which the structure overturned; null unless overturning is certain.
    overturning_sway: Option<&'static str>,
    /// Number of impacts.
    impacts: Option<usize>,
    /// The time of the outcome, in seconds.
    outcome_time_s: f64,
    /// Largest rotation over the critical rotation; null if the critical rotation is unknown.
    peak_rotation_over_critical: Option<f64>,
    /// Largest rotation of any body, in radians.
    peak_rotation_rad: Option<f64>,
    /// Largest excess of the thrust line of four links, over the thickness; null for other models.
    thrust_excess_ratio: Option<f64>,
}

/// Makes files and words of the thresholds of scenarios that differ only in their models of motion.
///
/// # Errors
/// When a value is not finite.
pub fn report(
    scenarios: &[Scenario],
    factors: &Factors,
    thresholds: &[Threshold],
    figure: Figure,
) -> Result<Results, OutputError> {
    let scenario = &scenarios[0];
    let title = scenario.title.as_deref();
    let title = title.unwrap_or("Threshold of overturning");
    let peak_g = peak_g(scenario);
    let models = thresholds.iter().zip(scenarios);
    let answers = models
        .clone()
        .map(|(one, scenario)| one.answer(scenario, peak_g));
    let to_quote = quotable::in_words(&answers.collect::<Vec<_>>());
    let mut words = words(scenarios, thresholds);
    words.extend(to_quote.iter().map(|quote| format!("  {quote}\n")));
    let summary = Summary {
        program: env!("CARGO_PKG_NAME"),
        version: env!("CARGO_PKG_VERSION"),
        peak_acceleration_g: peak_g,
        factors: *factors,
        warnings: warnings(scenarios, thresholds),
        to_quote,
        models: models
            .map(|(threshold, scenario)| threshold.summary(scenario, peak_g))
            .collect(),
    };
    let picture = picture::draw(figure, title, peak_g, factors, thresholds);
    let others = [picture.into_bytes(), table(&summary.models)?];
    Results::new(&FILES, &summary, words, others)
}

/// Makes the table of the samples, ordered by model, then by factor.
fn table(models: &[ModelSummary<'_>]) -> Result<Vec<u8>, OutputError> {
    type Row<'a> = (&'a str, &'a SampleSummary);
    let rows = models.iter().flat_map(|model| {
        let samples = model.samples.iter();
        samples.map(|sample| (model.model, sample))
    });
    let mut columns = vec![column("model", |row: &Row<'_>| row.0.to_owned())];
    columns.extend(fields!(|row: &Row<'_>| row.1 => factor, outcome));
    columns.extend(fields!(|row: &Row<'_>| row.1.history? => overturning_sway, impacts));
    columns.push(column("outcome_time_s", |row: &Row<'_>| {
        Some(row.1.history?.outcome_time_s)
    }));
    columns.extend(fields!(
        |row: &Row<'_>| row.1.history? => peak_rotation_over_critical, peak_rotation_rad, thrust_excess_ratio
    ));
    csv(columns, &rows.collect::<Vec<_>>())
}

/// Returns the warnings of all models without duplicates, and histories without a verdict.
fn warnings(scenarios: &[Scenario], thresholds: &[Threshold]) -> Vec<String> {
    let mut warnings: Vec<String> = Vec::new();
    for warning in scenarios.iter().flat_map(Scenario::unlikely) {
        if !warnings.contains(&warning) {
            warnings.push(warning);
        }
    }
    let remarks = thresholds.iter().map(Threshold::remarks);
    warnings.extend(remarks.flat_map(|remarks| remarks.warnings("histories")));
    let varied = thresholds.iter().flat_map(|threshold| &threshold.varied);
    warnings.extend(
        varied.filter_map(|varied| Some(format!("with {}: {}", varied.name, varied.no_verdict()?))),
    );
    warnings
}

impl Threshold {
    fn summary(&self, scenario: &Scenario, peak_g: f64) -> ModelSummary<'_> {
        let ranges = |ranges: Vec<FactorRange>| {
            let ranges = ranges.into_iter().map(|range| RangeSummary {
                from_peak_g: range.from * peak_g,
                to_peak_g: range.to * peak_g,
                range,
            });
            ranges.collect()
        };
        let from_end = |factor| match self.is_first(factor) {
            true => RangeEnd::Sampled,
            false => RangeEnd::Edge,
        };
        let varied = self.varied.iter().map(|varied| {
            let factor = varied.factor.as_ref().ok().copied().flatten();
            VariedSummary {
                with: &varied.name,
                factor,
                from_end: factor.map(from_end),
                peak_g: factor.map(|factor| factor * peak_g),
                incomplete: varied.incomplete,
                failed: varied.factor.as_ref().err().map(String::as_str),
            }
        });
        ModelSummary {
            model: &self.model,
            scenario: scenario.to_json(),
            record_checksums: scenario.record_checksums(),
            survives_up_to_factor: self.survives_up_to(),
            lowest_factor: self.lowest_factor(),
            bands: ranges(self.bands()),
            gaps: ranges(self.gaps()),
            uncertain: ranges(self.of(Verdict::Uncertain)),
            incomplete: ranges(self.of(Verdict::Incomplete)),
            remarks: self.remarks(),
            variations: varied.collect(),
            samples: self.samples.iter().map(SampleSummary::of).collect(),
        }
    }

    /// Returns the answer that may be quoted: the largest safe factor, with its range over other stiffness and contact.
    fn answer(&self, scenario: &Scenario, peak_g: f64) -> ModelAnswer {
        let is_known = |one: &VariedThreshold| one.factor.is_ok() && one.incomplete == 0;
        let over = match &self.varied[..] {
            _ if scenario.motion.kind.is_rigid => "",
            [] => ", other stiffness and contact unknown",
            varied if varied.iter().all(is_known) => " over stiffness and contact",
            _ => " over stiffness and contact, as far as they have verdicts",
        };
        let others = self
            .varied
            .iter()
            .filter_map(|one| one.factor.clone().ok()?);
        let others: Vec<f64> = others.collect();
        let answer = match self.survives_up_to() {
            Some(safe) if !others.iter().any(|other| self.is_first(*other)) => {
                let safe = ascending(
                    others
                        .iter()
                        .map(|other| other / (1.0 + EDGE_WIDTH))
                        .chain([safe]),
                );
                let [least, most] = [safe[0], safe[safe.len() - 1]].map(|factor| {
                    format!(
                        "{} ({} g)",
                        rounded_down(factor),
                        rounded_down(factor * peak_g)
                    )
                });
                let most = if most == least {
                    String::new()
                } else {
                    format!(" to {most}")
                };
                Ok(format!("survives up to {least}{most}{over}"))
            }
            _ => Err("the smallest factor tried is not certainly survived".to_owned()),
        };
        let (hinges, is_arch) = (
            scenario.motion.kind,
            scenario.structure.has_horizontal_thrust(),
        );
        ModelAnswer::new(hinges, is_arch, self.safe_excess_ratio, answer)
    }

    /// Returns the remarks on the histories.
    fn remarks(&self) -> Remarks {
        let mut remarks = Remarks::default();
        for ending in self.samples.iter().flat_map(|sample| &sample.result) {
            remarks.note_history(ending);
        }
        remarks
    }

    /// Returns words about the first history that overturns the structure, if it is outside the model of four links.
    fn edge_outside_model(&self) -> &'static str {
        let mut endings = self.samples.iter().flat_map(|sample| &sample.result);
        let first = endings.find(|ending| ending.verdict() == Verdict::Overturns);
        match first.is_some_and(Ending::is_outside_model) {
            true => "; the first that overturns is one of them",
            false => "",
        }
    }

    /// Returns true if a factor is the smallest tried factor, so that smaller ones may overturn the structure as well.
    fn is_first(&self, factor: f64) -> bool {
        let first = self.samples.first();
        first.is_some_and(|first| first.factor == factor)
    }

    /// Returns lines with the lowest factors that overturn the structure with other properties.
    fn varied_in_words(&self, peak_g: f64) -> impl Iterator<Item = String> {
        self.varied.iter().map(move |varied| {
            let no_verdict = varied.no_verdict();
            let certainly = no_verdict.as_ref().map_or("", |_| "certainly ");
            let answer = match &varied.factor {
                Ok(Some(factor)) if self.is_first(*factor) => {
                    let at = at(*factor, peak_g);
                    format!("overturns at factor {at} already, the smallest tried")
                }
                Ok(Some(factor)) => format!("from factor {}", at(*factor, peak_g)),
                Ok(None) => format!("does not {certainly}overturn at any factor tried"),
                Err(reason) => reason.clone(),
            };
            let no_verdict = no_verdict.map_or(String::new(), |words| format!("; {words}"));
            format!("  with {}: {answer}{no_verdict}", varied.name)
        })
    }

    /// Returns lines about uncertain, failed and incomplete histories.
    fn doubts_in_words(&self, scenario: &Scenario) -> Vec<String> {
        let falls =
            |sample: &&FactorSample| matches!(sample.result, Err(NoHistory::GroundFalls(_)));
        let histories = self.samples.iter().filter(|sample| !falls(sample));
        let all = histories.clone().count();
        let listed = |what: &str, reasons: Vec<(f64, String)>| {
            let (factor, reason) = reasons.first()?;
            let (count, factor) = (reasons.len(), rounded(*factor));
            Some(format!(
                "  {what}: {count} of {all} histories; the first, at factor {factor}: {reason}"
            ))
        };
        let reasons = |failed: bool| {
            let samples = histories.clone().map(SampleSummary::of);
            let of_kind = samples.filter(|sample| sample.history.is_none() == failed);
            let reasons = of_kind.filter_map(|sample| Some((sample.factor, sample.reason?)));
            reasons.collect()
        };
        let mut lines = Vec::from_iter(listed("uncertain", reasons(false)));
        let falls = self.samples.iter().any(|sample| falls(&sample));
        let factor = scenario
            .ground_motion()
            .free_fall_factor(scenario.gravity_m_s2());
        lines.extend(factor.filter(|_| falls).map(|factor| {
            let factor = rounded(factor);
            format!("  from factor {factor} on, the ground falls as fast as a free body at some time, which this model does not cover")
        }));
        lines.extend(listed("failed", reasons(true)));
        let incomplete = self.remarks().incomplete_in_words();
        lines.extend(incomplete.map(|words| format!("  {words}")));
        let outcomes = histories.flat_map(|sample| &sample.result);
        let outcomes = outcomes.map(|ending| ending.outcome);
        let rocking = outcomes.filter(|outcome| *outcome == Outcome::StillRocking);
        let rocking = rocking.count();
        lines.extend((rocking > 0).then(|| {
            format!("  still rocking at the end of the run, which counts as survived: {rocking} of {all} histories")
        }));
        lines
    }
}

impl SampleSummary {
    fn of(sample: &FactorSample) -> Self {
        let ending = sample.result.as_ref();
        Self {
            factor: sample.factor,
            outcome: outcome_name(&sample.result),
            history: ending.ok().map(|ending| HistorySummary {
                overturning_sway: ending.overturning_sway(),
                impacts: ending.impacts,
                outcome_time_s: ending.outcome_time_s,
                peak_rotation_over_critical: ending.peak_over_critical,
                peak_rotation_rad: Some(ending.peak_rotation_rad),
                thrust_excess_ratio: ending.thrust_excess_ratio,
            }),
            count: ending.ok().and_then(|ending| ending.count.clone()),
            reason: match ending {
                Ok(ending) => ending.doubt().map(ToString::to_string),
                Err(reason) => Some(reason.to_string()),
            },
        }
    }
}

/// Returns a factor with the peak ground acceleration, in words.
fn at(factor: f64, peak_g: f64) -> String {
    format!("{} ({} g)", rounded(factor), rounded(factor * peak_g))
}

/// Returns the results in words: for each model a line that begins with the safe factor, and lines about doubtful histories.
fn words(scenarios: &[Scenario], thresholds: &[Threshold]) -> String {
    let peak_g = peak_g(&scenarios[0]);
    let mut lines = Vec::new();
    for threshold in thresholds {
        let record = match scenarios[0].ground.as_ref() {
            Some(Ground::Record(record)) => Some(record.main.name().to_owned()),
            _ => None,
        };
        let model = (thresholds.len() > 1).then(|| threshold.model.replace('_', " "));
        let subject = record
            .into_iter()
            .chain(model)
            .collect::<Vec<_>>()
            .join(", ");
        let colon = if subject.is_empty() { "" } else { ": " };
        let survival = Survival::of_threshold(threshold);
        let strengths = survival::in_words(&survival, "", Some(peak_g));
        lines.push(format!("  {subject}{colon}{strengths}"));
        let unsafe_from_first = survival.survives_up_to.is_none();
        lines.extend(
            unsafe_from_first
                .then(|| "  a smaller --from finds the factors that it survives".to_owned()),
        );
        lines.extend(threshold.doubts_in_words(&scenarios[0]));
        lines.extend(threshold.varied_in_words(peak_g));
        let outside = threshold.remarks().model.in_words("histories");
        lines.extend(outside.map(|words| format!("  {words}{}", threshold.edge_outside_model())));
    }
    lines.join("\n") + "\n"
}

impl Factors {
    /// Returns the tried factors in words.
    pub fn in_words(&self) -> String {
        format!(
            "sampled from {} to {} in strides of {} %: narrower bands and gaps may be missed",
            self.from,
            self.to,
            (1e6 * self.stride).round() / 1e4,
        )
    }
}
