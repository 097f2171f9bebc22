//! Reports thresholds of overturning: their table, JSON and words.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::digits::{rounded, rounded_range};
use super::survival::{self, Survival};
use super::{
    FactorRange, FactorSample, Factors, NoHistory, RangeEnd, Threshold, VariedThreshold, picture,
};
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::Outcome;
use crate::output::table::{column, csv};
use crate::output::{Figure, OutputError, finite, pretty};
use crate::scenario::{Ground, Scenario};
use crate::studies::ending::columns::FAILED;
use crate::studies::ending::{Ending, Verdict};
use crate::studies::kind::GROUND_FALLS;
use crate::studies::remarks::{self, Remarks};
use crate::studies::results::Results;

/// Names of the files, the seal last.
pub const FILES: [&str; 3] = ["threshold.svg", "threshold.csv", "threshold.json"];

/// Checks that a scenario has a ground motion to scale, and starts from rest.
///
/// # Errors
/// Explains what to change.
pub fn check(scenario: &Scenario) -> Result<(), String> {
    scenario.check_from_rest("threshold")?;
    if scenario.ground().is_some() {
        return Ok(());
    }
    Err(
        "a threshold needs a ground motion: give a table such as\n\n\
         [ground.one_cosine]\n\
         amplitude_g = 0.3\n\
         duration_s = 0.5"
            .to_owned(),
    )
}

/// Files and words for the thresholds of scenarios that differ only in their models; one of the files is JSON.
///
/// # Errors
/// When a value is not finite.
pub fn tell(
    scenarios: &[&Scenario],
    factors: &Factors,
    thresholds: &[Threshold],
    figure: Figure,
) -> Result<Results, OutputError> {
    let scenario = scenarios[0];
    let ground = scenario.ground_motion();
    let title = scenario.title();
    let title = title.unwrap_or("Threshold of overturning");
    let peak_g = peak_g(scenario, ground);
    let json = to_json(scenarios, ground, factors, thresholds)?;
    let picture = picture::draw(figure, title, peak_g, factors, thresholds);
    let contents = [
        picture.into_bytes(),
        table(thresholds)?,
        pretty(&json).into_bytes(),
    ];
    Ok(Results {
        files: FILES.into_iter().zip(contents).collect(),
        words: words(scenarios, ground, thresholds),
        summary: json,
        ..Results::default()
    })
}

/// The outcome of a sample, or what stands for it if there is no history.
#[must_use]
pub const fn outcome(sample: &FactorSample) -> &'static str {
    match &sample.result {
        Ok(ending) => ending.outcome_name(),
        Err(NoHistory::GroundFalls(_)) => GROUND_FALLS,
        Err(NoHistory::Failed(_)) => FAILED,
    }
}

/// Largest horizontal acceleration of the ground at the factor 1, in units of gravity.
#[must_use]
pub fn peak_g(scenario: &Scenario, ground: &GroundMotion) -> f64 {
    ground.peaks_m_s2(f64::INFINITY).x / scenario.gravity_m_s2()
}

/// The samples, model by model, with ascending factors.
fn table(thresholds: &[Threshold]) -> Result<Vec<u8>, OutputError> {
    type Row<'a> = (&'a str, &'a FactorSample);
    let rows: Vec<Row<'_>> = thresholds
        .iter()
        .flat_map(|threshold| {
            let samples = threshold.samples.iter();
            samples.map(|sample| (&*threshold.model, sample))
        })
        .collect();
    fn ending<'a>(row: &Row<'a>) -> Option<&'a Ending> {
        row.1.result.as_ref().ok()
    }
    let columns = [
        column("model", |row: &Row<'_>| row.0.to_owned()),
        column("factor", |row: &Row<'_>| row.1.factor),
        column("outcome", |row: &Row<'_>| outcome(row.1)),
        column("overturning_sway", |row| {
            ending(row).and_then(Ending::overturning_sway)
        }),
        column("impacts", |row| {
            ending(row).and_then(|ending| ending.impacts)
        }),
        column("outcome_time_s", |row| {
            ending(row).map(|ending| ending.outcome_time_s)
        }),
        column("peak_rotation_over_critical", |row| {
            ending(row).and_then(|ending| ending.peak.over_critical())
        }),
        column("peak_rotation_rad", |row: &Row<'_>| row.1.peak_rotation_rad),
    ];
    csv(columns, &rows)
}

/// All results as JSON: for each model the least factor that overturns, the bands that overturn, the safe gaps between
/// them, the uncertain ranges, those without a verdict, the steps if the model has any, and all samples. Edges also have the peak ground acceleration, in g.
///
/// # Errors
/// When a value is not finite.
fn to_json(
    scenarios: &[&Scenario],
    ground: &GroundMotion,
    factors: &Factors,
    thresholds: &[Threshold],
) -> Result<Value, OutputError> {
    let peak_g = scenarios.first().map_or(0.0, |first| peak_g(first, ground));
    finite("peak_acceleration_g", &[peak_g])?;
    let ranges = |ranges: Vec<FactorRange>| -> Vec<Value> {
        let ranges = ranges.iter();
        ranges.map(|range| range_to_json(range, peak_g)).collect()
    };
    let models: Vec<Value> = thresholds
        .iter()
        .zip(scenarios)
        .map(|(threshold, scenario)| {
            let samples: Vec<Value> = threshold.samples.iter().map(sample_to_json).collect();
            let mut model = json!({
                "model": threshold.model,
                "scenario": scenario.to_json(),
                "record_checksums": scenario.record_checksums(),
                "lowest_factor": threshold.lowest_factor(),
                "bands": ranges(threshold.bands()),
                "gaps": ranges(threshold.gaps()),
                "uncertain": ranges(threshold.uncertain()),
                "incomplete": ranges(threshold.incomplete()),
            });
            remarks(threshold).add_to(&mut model);
            if !threshold.varied.is_empty() {
                model["variations"] = threshold
                    .varied
                    .iter()
                    .map(|one| varied_to_json(one, threshold, peak_g))
                    .collect();
            }
            model["samples"] = samples.into();
            model
        })
        .collect();
    let mut warnings: Vec<String> = Vec::new();
    for warning in scenarios
        .iter()
        .flat_map(|scenario| remarks::warnings(scenario))
    {
        if !warnings.contains(&warning) {
            warnings.push(warning);
        }
    }
    let incomplete = thresholds.iter().map(remarks);
    warnings.extend(incomplete.filter_map(|remarks| remarks.incomplete_in_words()));
    let varied = thresholds.iter().flat_map(|threshold| &threshold.varied);
    warnings.extend(
        varied.filter_map(|varied| Some(format!("with {}: {}", varied.name, varied.no_verdict()?))),
    );
    Ok(json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "peak_acceleration_g": peak_g,
        "factors": { "from": factors.first(), "to": factors.last(), "stride": factors.stride() },
        "warnings": warnings,
        "models": models,
    }))
}

/// The remarks on the histories of a model.
fn remarks(threshold: &Threshold) -> Remarks {
    let mut remarks = Remarks::default();
    for ending in threshold.samples.iter().flat_map(|sample| &sample.result) {
        remarks.note_history(ending);
    }
    remarks
}

fn range_to_json(range: &FactorRange, peak_g: f64) -> Value {
    json!({
        "from": range.from,
        "to": range.to,
        "from_end": range.from_end.name(),
        "to_end": range.to_end.name(),
        "from_peak_g": range.from * peak_g,
        "to_peak_g": range.to * peak_g,
    })
}

fn varied_to_json(varied: &VariedThreshold, threshold: &Threshold, peak_g: f64) -> Value {
    let name = &varied.name;
    match varied.factor {
        Ok(factor) => json!({
            "with": name,
            "factor": factor,
            "from_end": factor.map(|factor| {
                let is_first = is_first(factor, threshold);
                if is_first { RangeEnd::Sampled } else { RangeEnd::Edge }.name()
            }),
            "peak_g": factor.map(|factor| factor * peak_g),
            "incomplete": varied.incomplete,
        }),
        Err(ref reason) => json!({ "with": name, "failed": reason }),
    }
}

fn sample_to_json(sample: &FactorSample) -> Value {
    match &sample.result {
        Ok(ending) => {
            let mut json = json!({
                "factor": sample.factor,
                "outcome": outcome(sample),
                "overturning_sway": ending.overturning_sway(),
                "impacts": ending.impacts,
                "outcome_time_s": ending.outcome_time_s,
                "peak_rotation_over_critical": ending.peak.over_critical(),
                "peak_rotation_rad": sample.peak_rotation_rad,
            });
            if let Some(reason) = &ending.uncertain {
                json["reason"] = json!(reason);
            }
            json
        }
        Err(error) => json!({
            "factor": sample.factor,
            "outcome": outcome(sample),
            "reason": error.to_string(),
        }),
    }
}

/// The results in words: one line for a record, one line per range for a pulse.
fn words(scenarios: &[&Scenario], ground: &GroundMotion, thresholds: &[Threshold]) -> String {
    let scenario = scenarios[0];
    let mut text = String::new();
    let peak_g = peak_g(scenario, ground);
    for threshold in thresholds {
        let model = threshold.model.replace('_', " ");
        let several = thresholds.len() > 1;
        if let Some(Ground::Record(record)) = scenario.ground() {
            let model = if several {
                format!(", {model}")
            } else {
                String::new()
            };
            let line = survival::in_words(&Survival::of_threshold(threshold), "");
            let file = record.main.name();
            let _ = writeln!(text, "  {file}{model}: {line} (1 is {} g)", rounded(peak_g));
        } else {
            if several {
                let _ = writeln!(text, "{model}");
            }
            ranges(&mut text, peak_g, threshold);
        }
        doubts(&mut text, threshold);
        text += &hangs_on(threshold, peak_g);
    }
    if let Some(caveat) = scenarios
        .iter()
        .find_map(|scenario| remarks::rough_guide(scenario))
    {
        let _ = writeln!(text, "  {caveat}");
    }
    text
}

impl Factors {
    /// The factors that were tried, in words.
    #[must_use]
    pub fn in_words(&self) -> String {
        format!(
            "sampled from {} to {} in strides of {} %: narrower bands and gaps may be missed",
            self.first(),
            self.last(),
            (1e6 * self.stride()).round() / 1e4,
        )
    }
}

/// Whether a factor is the smallest one tried, so that smaller ones may overturn as well.
fn is_first(factor: f64, threshold: &Threshold) -> bool {
    let first = threshold.samples.first();
    first.is_some_and(|first| first.factor == factor)
}

/// The lowest factors that overturn the structure with other properties, in words.
fn hangs_on(threshold: &Threshold, peak_g: f64) -> String {
    let mut text = String::new();
    for varied in &threshold.varied {
        let no_verdict = varied.no_verdict();
        let answer = match &varied.factor {
            Ok(Some(factor)) => {
                let begins = format!("{} ({} g)", rounded(*factor), rounded(factor * peak_g));
                if is_first(*factor, threshold) {
                    format!("overturns at factor {begins} already, the smallest tried")
                } else {
                    format!("from factor {begins}")
                }
            }
            Ok(None) if no_verdict.is_some() => {
                "does not certainly overturn at any factor tried".to_owned()
            }
            Ok(None) => "does not overturn at any factor tried".to_owned(),
            Err(reason) => reason.clone(),
        };
        let _ = write!(text, "  with {}: {answer}", varied.name);
        let _ = writeln!(
            text,
            "{}",
            no_verdict.map_or(String::new(), |words| format!("; {words}"))
        );
    }
    text
}

/// Adds a line for each range.
fn ranges(text: &mut String, peak_g: f64, threshold: &Threshold) {
    let at = |factor: f64| format!("{} ({} g)", rounded(factor), rounded(factor * peak_g));
    let certainly = if threshold.uncertain().is_empty() && threshold.incomplete().is_empty() {
        ""
    } else {
        "certainly "
    };
    if threshold.bands().is_empty() {
        let mut known = threshold.samples.iter().rev();
        let last = known.find(|sample| sample.result.is_ok());
        let last = at(last.map_or(0.0, |sample| sample.factor));
        let _ = writeln!(text, "  does not {certainly}overturn up to factor {last}");
    }
    if let Some((verdict, first)) = threshold.ranges.first()
        && *verdict != Verdict::Survives
        && first.from_end == RangeEnd::Sampled
    {
        let (what, range) = match verdict {
            Verdict::Overturns => ("overturns", "band"),
            other => (other.name(), "range"),
        };
        let _ = writeln!(
            text,
            "  {what} at the smallest factor already: a smaller --from finds where this {range} begins"
        );
    }
    // A line for each band, with the range that follows it.
    let mut lines: Vec<String> = Vec::new();
    let mut printed_end: Option<f64> = None;
    for (verdict, range) in &threshold.ranges {
        let factors = [range.from, range.to];
        let factor = rounded_range(factors);
        let accelerations_g = rounded_range(factors.map(|factor| factor * peak_g));
        let [begins, mut to] =
            [0, 1].map(|end| format!("{} ({} g)", factor[end], accelerations_g[end]));
        // After "up to" only ends are printed, so each must differ from the last one.
        if let (Some(last), false) = (printed_end, *verdict == Verdict::Overturns) {
            let [_, factor] = rounded_range([last, range.to]);
            let [_, acceleration_g] = rounded_range([last, range.to].map(|end| end * peak_g));
            to = format!("{factor} ({acceleration_g} g)");
        }
        printed_end = Some(range.to);
        let (ends, beyond) = match range.to_end {
            RangeEnd::Sampled => ("up to the largest factor".to_owned(), ""),
            RangeEnd::Unknown => (format!("to {to}"), "; not known beyond"),
            RangeEnd::Edge => (format!("to {to}"), ""),
        };
        let all = if range.from == range.to && range.to_end != RangeEnd::Sampled {
            format!("at factor {begins}{beyond}")
        } else {
            format!("from factor {begins} {ends}{beyond}")
        };
        match (verdict, lines.last_mut()) {
            (Verdict::Overturns, _) => {
                lines.push(format!("overturns {all}"));
            }
            (Verdict::Survives, None) => {}
            (verdict, None) => {
                let what = verdict.name();
                lines.push(format!("{what} {all}"));
            }
            (verdict, Some(line)) => {
                let what = verdict.name();
                *line += &match range.to_end {
                    RangeEnd::Sampled => format!("; {what} from there on"),
                    _ if what == "survives" => format!("; survives again up to {to}{beyond}"),
                    _ => format!("; {what} up to {to}{beyond}"),
                };
            }
        }
    }
    for line in lines {
        let _ = writeln!(text, "  {line}");
    }
}

/// Adds what is doubtful about the ranges.
fn doubts(text: &mut String, threshold: &Threshold) {
    let falls = |sample: &&FactorSample| matches!(sample.result, Err(NoHistory::GroundFalls(_)));
    let samples = &threshold.samples;
    let histories = samples.iter().filter(|sample| !falls(sample)).count();
    let uncertain = samples.iter().filter_map(|sample| {
        let reason = sample.result.as_ref().ok()?.uncertain.as_ref()?;
        Some((sample.factor, reason))
    });
    let uncertain: Vec<_> = uncertain.collect();
    if let Some((factor, reason)) = uncertain.first() {
        let _ = writeln!(
            text,
            "  uncertain: {} of {} histories; the first, at factor {}: {reason}",
            uncertain.len(),
            histories,
            rounded(*factor)
        );
    }
    if let Some(first) = samples.iter().find(falls) {
        let _ = writeln!(
            text,
            "  from factor {} on, the ground falls as fast as a free body at some time, which this model does \
             not cover",
            rounded(first.factor)
        );
    }
    let failed: Vec<_> = samples
        .iter()
        .filter(|sample| !falls(sample))
        .filter_map(|sample| Some((sample.factor, sample.result.as_ref().err()?)))
        .collect();
    if let Some((factor, reason)) = failed.first() {
        let _ = writeln!(
            text,
            "  failed: {} of {} histories; the first, at factor {}: {reason}",
            failed.len(),
            histories,
            rounded(*factor)
        );
    }
    if let Some(words) = remarks(threshold).incomplete_in_words() {
        let _ = writeln!(text, "  {words}");
    }
    let rocking = samples.iter().filter(|sample| {
        let ending = sample.result.as_ref();
        ending.is_ok_and(|ending| ending.outcome == Outcome::StillRocking)
    });
    let rocking = rocking.count();
    if rocking > 0 {
        let _ = writeln!(
            text,
            "  still rocking at the end of the run, which counts as survived: {rocking} of {histories} histories"
        );
    }
}
