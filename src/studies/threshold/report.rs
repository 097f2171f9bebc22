//! Report and files of thresholds of overturning.

use askama::Template;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::digits::{format_edge, rounded_down};
use super::survival::{Survival, VerdictRange, survival_in_words};
use super::{
    EDGE_WIDTH, FactorRange, FactorSample, Factors, RangeEnd, SearchedFactors, Threshold,
    UNCERTAIN_EDGE_WIDTH, VariedThreshold, peak_g, picture,
};
use crate::argument::plain;
use crate::dynamics::{Direction, MODEL_LIMIT, OutcomeCount};
use crate::output::{Figure, OutputError, Table, column, fields};
use crate::scenario::{Ground, ModelKind, Scenario};
use crate::studies::ending::columns::{GROUND_FALLS, OVERTURNED};
use crate::studies::ending::{NoHistory, Verdict, outcome_name};
use crate::studies::page::{CaseScenario, Page, PageCases, input_in_words};
use crate::studies::quotable::{
    self, FrictionCondition, ModelAnswer, SlipWords, directions_in_words, restitution_in_words,
};
use crate::studies::report::{Report, Warnings};
use crate::studies::statistics::ascending;
use crate::studies::{Remarks, Results};
use crate::{Outcome, Sway};

/// Names of the files, the seal last.
pub const FILES: [&str; 4] = [
    "threshold.html",
    "threshold.svg",
    "threshold.csv",
    "threshold.json",
];

/// Report on the thresholds of scenarios that differ only in their models of motion.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/threshold/words.txt")]
pub struct ThresholdSummary {
    /// Name of the program.
    program: String,
    /// Version of the program.
    version: String,
    /// Name of the record file; absent under a pulse.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    record: Option<String>,
    /// Largest horizontal acceleration of the ground at factor 1, in units of gravity.
    peak_acceleration_g: f64,
    /// The factors as given; null for those that follow from each model.
    factors: Factors,
    /// The factor from which on the ground falls as fast as a free body at some time; absent without such a factor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    free_fall_factor: Option<f64>,
    #[serde(flatten)]
    warnings: Warnings,
    /// The answer that may be quoted, in words.
    to_quote: Option<String>,
    /// The threshold of each model.
    models: Vec<ModelSummary>,
}

/// Summary of the threshold of a model.
#[derive(Serialize, Deserialize)]
struct ModelSummary {
    /// Name of the model.
    model: String,
    /// The scenario with all defaults.
    scenario: Value,
    /// Name and checksum of each record file.
    record_checksums: Vec<String>,
    /// The factors of the search.
    searched_factors: SearchedFactors,
    /// The largest factor up to which the structure certainly survives all sampled factors in all directions; null if it does not survive the smallest.
    survives_up_to_factor: Option<f64>,
    /// The smallest factor that certainly overturns the structure in any direction; null if no factor does.
    lowest_factor: Option<f64>,
    /// Largest friction coefficient that the histories up to `survives_up_to_factor` and their repetitions require without slip; null if joints slip or
    /// are elastic, or if the structure does not survive the smallest factor.
    #[serde(default)]
    friction_demand: Option<f64>,
    /// The direction of the ground motion in which the structure survives less.
    direction: Direction,
    #[serde(flatten)]
    given: DirectionSummary,
    /// The ranges and histories under the mirrored ground motion, up to the first factor that certainly overturns the structure as given; absent without
    /// a second direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mirrored: Option<DirectionSummary>,
    #[serde(flatten)]
    remarks: Remarks,
    /// The lowest factors of structures with other stiffness and contact, and with rigid joints; absent unless joints are elastic.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    variations: Vec<VariedSummary>,
}

/// Ranges and histories in a direction of the ground motion: as given, unless only the mirrored direction is requested.
#[derive(Serialize, Deserialize)]
struct DirectionSummary {
    /// All ranges of sampled factors with one verdict, ascending.
    ranges: Vec<VerdictRange>,
    /// Ranges of factors that overturn the structure, ascending.
    bands: Vec<RangeSummary>,
    /// Safe ranges between bands.
    gaps: Vec<RangeSummary>,
    /// Ranges with an uncertain verdict.
    uncertain: Vec<RangeSummary>,
    /// Ranges whose histories end too early for a verdict.
    incomplete: Vec<RangeSummary>,
    /// All histories, in order of ascending factors.
    samples: Vec<TriedFactor>,
}

/// A range of factors.
#[derive(Serialize, Deserialize)]
struct RangeSummary {
    #[serde(flatten)]
    range: FactorRange,
    /// Peak ground acceleration at the smallest factor of the range, in units of gravity.
    from_peak_g: f64,
    /// Peak ground acceleration at the largest factor of the range, in units of gravity.
    to_peak_g: f64,
}

/// The lowest overturning factor of a structure with other properties.
#[derive(Serialize, Deserialize)]
struct VariedSummary {
    /// The changed property.
    with: String,
    /// The lowest factor that overturns the structure; null if no factor does, or it could not be computed.
    factor: Option<f64>,
    /// Reason why lower factors are not known to overturn the structure.
    from_end: Option<RangeEnd>,
    /// Peak ground acceleration at `factor`, in units of gravity.
    peak_g: Option<f64>,
    /// Number of histories that ended too early for a verdict.
    incomplete: usize,
    /// The largest factor that the structure survives; null if it survives all, or if none is known.
    survives_up_to_factor: Option<f64>,
    /// True if the histories near that factor were repeated, because it governs the answer that may be quoted.
    is_repeated: bool,
    /// Reason why the factor could not be computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    failed: Option<String>,
}

/// The history at a factor.
#[derive(Serialize, Deserialize)]
struct TriedFactor {
    /// The factor.
    factor: f64,
    /// Outcome of the history.
    outcome: String,
    #[serde(flatten)]
    history: Option<HistorySummary>,
    /// Count of the outcomes of the history and its repetitions; absent if the history was not repeated.
    #[serde(flatten)]
    count: Option<OutcomeCount>,
    /// Reason why the outcome is uncertain, or why there is no history.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
}

/// The numbers of a history.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct HistorySummary {
    /// The side to which the structure overturned; null unless overturning is certain.
    overturning_sway: Option<Sway>,
    /// Number of impacts; null for elastic joints, which have none.
    impacts: Option<usize>,
    /// The time of the outcome, in seconds.
    outcome_time_s: f64,
    /// Largest rotation over the critical rotation; null for rows of blocks, which have no critical rotation.
    peak_rotation_over_critical: Option<f64>,
    /// Largest rotation of any body, in radians.
    peak_rotation_rad: Option<f64>,
    /// Largest excess of the thrust line of four links, over the thickness; null for other models.
    thrust_excess_ratio: Option<f64>,
    /// Friction coefficient that the history and its repetitions require without slip; null if joints slip or are elastic.
    #[serde(default)]
    friction_demand: Option<f64>,
}

/// Makes report and files of the thresholds of scenarios that differ only in their models of motion.
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
    let title = scenario
        .title
        .as_deref()
        .unwrap_or("Threshold of overturning");
    let peak_g = peak_g(scenario);
    let models = thresholds.iter().zip(scenarios);
    let study = format!("threshold FILE{}", factors.options());
    let frictions: Vec<_> = models
        .clone()
        .map(|(one, scenario)| SlipWords::of(scenario).condition(one.friction_demand, &study))
        .collect();
    let answers = models
        .clone()
        .zip(&frictions)
        .map(|((one, scenario), friction)| {
            let answer = one
                .answer(scenario, peak_g)
                .unless_uncertain(scenario.uncertain.is_some());
            answer.with_friction(friction.clone())
        })
        .collect::<Vec<_>>();
    let models: Vec<ModelSummary> = models
        .map(|(threshold, scenario)| threshold.summary(scenario, peak_g))
        .collect();
    let falls = ground_falls(thresholds);
    let (ground, gravity_m_s2) = (scenario.ground_motion(), scenario.gravity_m_s2());
    let unlikely = Scenario::unlikely_of_all(scenarios, &factors.varied());
    let report = ThresholdSummary {
        program: env!("CARGO_PKG_NAME").to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        record: match scenario.ground.as_ref() {
            Some(Ground::Record(record)) => Some(record.main.name().to_owned()),
            _ => None,
        },
        peak_acceleration_g: peak_g,
        factors: *factors,
        free_fall_factor: ground.free_fall_factor(gravity_m_s2).filter(|_| falls),
        warnings: Warnings::new(unlikely, limits(&models, frictions)),
        to_quote: quotable::quote_answers(&answers),
        models,
    };
    let picture = picture::draw(figure, title, peak_g, thresholds);
    let results = Results::of("threshold.json", &report)?
        .with_table("threshold.csv", table(&report.models)?)
        .with_file("threshold.svg", picture);
    let mut cases = PageCases::default();
    for (threshold, scenario) in thresholds.iter().zip(scenarios) {
        threshold.add_to(&mut cases, scenario, peak_g);
    }
    let draw = |figure| picture::draw_marked(figure, title, peak_g, thresholds, &cases.spots);
    let mut searched: Vec<String> = thresholds
        .iter()
        .map(|one| one.factors.in_words())
        .collect();
    searched.dedup();
    let edges = format!(
        "{}. The edge between two neighbours with different verdicts is bisected to {} %, beside an uncertain one to {} %",
        searched.join("; "),
        plain(100.0 * EDGE_WIDTH),
        plain(100.0 * UNCERTAIN_EDGE_WIDTH)
    );
    let models: Vec<&ModelKind> = scenarios.iter().map(|one| one.motion.kind).collect();
    let what = input_in_words(&scenarios.iter().collect::<Vec<_>>());
    let page = Page::new(title, what, &[&edges], &models);
    let results = results.with_page("threshold.html", page, &cases, (&draw, &[]));
    Ok(results.in_order(&FILES))
}

/// True if the ground falls as fast as a free body under a factor that was tried.
fn ground_falls(thresholds: &[Threshold]) -> bool {
    let falls = |sample: &FactorSample| matches!(sample.result, Err(NoHistory::GroundFalls(_)));
    let all = thresholds.iter().flat_map(Threshold::directions);
    all.flat_map(|one| &one.samples).any(falls)
}

/// Makes the table of the samples, ordered by model and direction, then by factor.
fn table(models: &[ModelSummary]) -> Result<Table, OutputError> {
    type Row<'a> = (&'a str, &'a TriedFactor, Direction);
    let rows = models.iter().flat_map(|model| {
        let all = model.directions();
        all.flat_map(move |(direction, of)| {
            let samples = of.samples.iter();
            samples.map(move |sample| (&*model.model, sample, direction))
        })
    });
    let mut columns = vec![column("model", |row: &Row<'_>| row.0.to_owned())];
    columns.extend([
        column("factor", |row: &Row<'_>| row.1.factor),
        column("outcome", |row: &Row<'_>| row.1.outcome.clone()),
        column("overturning_sway", |row: &Row<'_>| {
            Some(row.1.history?.overturning_sway?.name())
        }),
        column("impacts", |row: &Row<'_>| row.1.history?.impacts),
        column("outcome_time_s", |row: &Row<'_>| {
            Some(row.1.history?.outcome_time_s)
        }),
    ]);
    columns.extend(fields!(
        |row: &Row<'_>| row.1.history? => peak_rotation_over_critical, peak_rotation_rad, thrust_excess_ratio,
        friction_demand
    ));
    columns.push(column("direction", |row: &Row<'_>| row.2.name()));
    Table::new(columns, &rows.collect::<Vec<_>>())
}

/// Warnings about the model and histories without a verdict, and conditions on friction.
fn limits(models: &[ModelSummary], frictions: Vec<Option<FrictionCondition>>) -> Vec<String> {
    let of_models = models.iter().flat_map(|model| {
        let outside = model.outside_in_words();
        outside
            .into_iter()
            .chain(model.remarks.incomplete_in_words())
    });
    let mut warnings: Vec<String> = of_models.collect();
    let frictions = frictions.into_iter().flatten();
    warnings.extend(frictions.map(|friction| friction.to_string()));
    let varied = models.iter().flat_map(|model| &model.variations);
    warnings.extend(
        varied.filter_map(|varied| Some(format!("with {}: {}", varied.with, varied.no_verdict()?))),
    );
    warnings
}

impl Report for ThresholdSummary {
    fn verdict(&self) -> String {
        let mut lines = Vec::new();
        for model in &self.models {
            let label = (self.models.len() > 1).then(|| model.model.replace('_', " "));
            let before: Vec<&str> = self
                .record
                .iter()
                .chain(&label)
                .map(String::as_str)
                .collect();
            let before = before.join(", ");
            for strengths in model.strengths(&self.peak_acceleration_g) {
                lines.push(match before.is_empty() {
                    true => strengths,
                    false => format!("{before}: {strengths}"),
                });
            }
        }
        lines.join("\n")
    }

    fn quote(&self) -> Option<&str> {
        self.to_quote.as_deref()
    }

    fn warnings(&self) -> &Warnings {
        &self.warnings
    }
}

impl Threshold {
    /// Adds its histories to the cases of a page.
    fn add_to(&self, cases: &mut PageCases, scenario: &Scenario, peak_g: f64) {
        let text = cases.add_text(&scenario.to_json(), false);
        for one in self.directions() {
            for sample in &one.samples {
                let (name, factor) = (one.name_in_words(), sample.factor);
                let case = format!("{name}, factor {}", factor_in_words(&factor, &peak_g));
                cases.push_history(&case, &sample.result, || {
                    let case = CaseScenario::of(text, scenario.ground_values_times(factor));
                    Some(match self.mirrored {
                        Some(_) => case.in_direction(one.direction),
                        None => case,
                    })
                });
            }
        }
    }

    /// Name of the model, with "mirrored" under the mirrored ground motion.
    pub(super) fn name(&self) -> String {
        match self.direction {
            Direction::AsGiven => self.model.clone(),
            Direction::Mirrored => format!("{}_mirrored", self.model),
        }
    }

    /// [`Threshold::name`] in words.
    pub(super) fn name_in_words(&self) -> String {
        self.name().replace('_', " ")
    }

    fn direction_summary(&self, peak_g: f64) -> DirectionSummary {
        let ranges = |ranges: Vec<FactorRange>| {
            let ranges = ranges.into_iter().map(|range| RangeSummary {
                from_peak_g: range.from * peak_g,
                to_peak_g: range.to * peak_g,
                range,
            });
            ranges.collect()
        };
        DirectionSummary {
            ranges: Survival::of_threshold(self).ranges,
            bands: ranges(self.bands()),
            gaps: ranges(self.gaps()),
            uncertain: ranges(self.ranges_with(Verdict::Uncertain)),
            incomplete: ranges(self.ranges_with(Verdict::Incomplete)),
            samples: self.samples.iter().map(TriedFactor::of).collect(),
        }
    }

    fn summary(&self, scenario: &Scenario, peak_g: f64) -> ModelSummary {
        let from_end = |factor| match self.is_first(factor) {
            true => RangeEnd::Sampled,
            false => RangeEnd::Edge,
        };
        let varied = self.varied.iter().map(|varied| {
            let factor = varied.factor.as_ref().ok().copied().flatten();
            VariedSummary {
                with: varied.name.clone(),
                factor,
                from_end: factor.map(from_end),
                peak_g: factor.map(|factor| factor * peak_g),
                incomplete: varied.incomplete,
                survives_up_to_factor: varied.survives_up_to().filter(|safe| *safe > 0.0),
                is_repeated: varied.repeated.is_some(),
                failed: varied.factor.as_ref().err().cloned(),
            }
        });
        ModelSummary {
            model: self.model.clone(),
            scenario: scenario.to_json(),
            record_checksums: scenario.record_checksums(),
            searched_factors: self.factors,
            survives_up_to_factor: self.survives_up_to(),
            lowest_factor: self.lowest_factor(),
            friction_demand: self.friction_demand,
            direction: self.governing().direction,
            given: self.direction_summary(peak_g),
            mirrored: self
                .mirrored
                .as_ref()
                .map(|one| one.direction_summary(peak_g)),
            remarks: self.remarks(),
            variations: varied.collect(),
        }
    }

    /// Answer that may be quoted: the largest safe factor, with its range over other stiffness and contact.
    fn answer(&self, scenario: &Scenario, peak_g: f64) -> ModelAnswer {
        let is_known = |one: &VariedThreshold| one.factor.is_ok() && one.incomplete == 0;
        let unknown = match &self.varied[..] {
            _ if !scenario.motion.kind.has_stiffness => "",
            [] => ", other stiffness and contact unknown",
            varied if varied.iter().all(is_known) => "",
            _ => ", as far as they have verdicts",
        };
        let others: Vec<f64> = self
            .varied
            .iter()
            .filter_map(VariedThreshold::survives_up_to)
            .collect();
        let answer = match self.survives_up_to() {
            Some(safe) if others.iter().all(|other| *other >= self.factors.from) => {
                let all = ascending(others.into_iter().chain([safe]));
                let (least, most) = (all[0], all[all.len() - 1]);
                let survives_all =
                    |one: &VariedThreshold| is_known(one) && one.survives_up_to().is_none();
                let best = match self.varied.iter().any(survives_all) {
                    true => "all".to_owned(),
                    false => rounded_down(most),
                };
                let over = match self.varied.len() {
                    0 => String::new(),
                    varied => format!(
                        ", the worst of {} stiffnesses and contacts of joints ({} as given, {best} at best) at factors {} % apart",
                        1 + varied,
                        rounded_down(safe),
                        in_percent(self.factors.stride)
                    ),
                };
                let [factor, strength_g] = [least, least * peak_g].map(rounded_down);
                let directions = self.directions_in_words(scenario);
                let lower = self.factors.lower_in_words();
                Ok(format!(
                    "survives up to {factor} ({strength_g} g){directions}{over}{unknown}{lower}"
                ))
            }
            _ => Err("the smallest factor tried is not certainly survived".to_owned()),
        };
        let (model, is_arch) = (
            scenario.motion.kind,
            scenario.structure.has_horizontal_thrust(),
        );
        ModelAnswer::new(model, is_arch, self.safe_excess_ratio, answer)
            .with_restitution(restitution_in_words(scenario))
    }

    /// Directions of the answer, in words that follow it.
    fn directions_in_words(&self, scenario: &Scenario) -> &'static str {
        let has_horizontal = scenario.ground_motion().has_horizontal();
        match has_horizontal {
            true => directions_in_words(scenario.simulation.direction, self.governing().direction),
            false => "",
        }
    }

    /// Remarks on the histories.
    fn remarks(&self) -> Remarks {
        let mut remarks = Remarks::default();
        let samples = self.directions().flat_map(|one| &one.samples);
        for ending in samples.flat_map(|sample| &sample.result) {
            remarks.note_history(ending);
        }
        remarks
    }

    /// True if a factor is the smallest tried factor, so that smaller ones may overturn the structure as well.
    fn is_first(&self, factor: f64) -> bool {
        let first = self.samples.first();
        first.is_some_and(|first| first.factor == factor)
    }
}

impl ModelSummary {
    /// Summaries of all directions.
    fn directions(&self) -> impl Iterator<Item = (Direction, &DirectionSummary)> {
        // Without a second direction, the only one is the governing one.
        let first = match self.mirrored {
            Some(_) => Direction::AsGiven,
            None => self.direction,
        };
        let mirrored = self.mirrored.iter().map(|one| (Direction::Mirrored, one));
        [(first, &self.given)].into_iter().chain(mirrored)
    }

    /// Factors that are survived, and those that are not, in words: a line for each direction, with the direction if there are two.
    fn strengths(&self, peak_g: &f64) -> Vec<String> {
        let in_words = |(direction, of): (Direction, &DirectionSummary)| {
            let survival = Survival::of_ranges(of.ranges.clone());
            let words = survival_in_words(&survival, "", Some(*peak_g));
            match &self.mirrored {
                Some(_) => format!("{}: {words}", direction.name().replace('_', " ")),
                None => words,
            }
        };
        self.directions().map(in_words).collect()
    }

    /// Samples with a history on ground that does not fall.
    fn histories(&self) -> impl Iterator<Item = &TriedFactor> {
        let samples = self.directions().flat_map(|(_, of)| &of.samples);
        samples.filter(|sample| sample.outcome != GROUND_FALLS)
    }

    /// Number of uncertain or failed histories, and the first of them, in words; `None` if there are none.
    fn doubts(&self, what: &str, failed: bool) -> Option<String> {
        let mut reasons = self.histories().filter_map(|sample| {
            let reason = sample.reason.as_ref();
            Some((sample.factor, reason?)).filter(|_| sample.history.is_none() == failed)
        });
        let (factor, reason) = reasons.next()?;
        let (count, all) = (1 + reasons.count(), self.histories().count());
        let factor = format_edge(factor);
        Some(format!(
            "{what}: {count} of {all} histories; the first, at factor {factor}: {reason}"
        ))
    }

    /// Number of histories that still rock at the end, and of all.
    fn still_rocking(&self) -> [usize; 2] {
        let rocking = |sample: &&TriedFactor| sample.outcome == Outcome::StillRocking.name();
        [
            self.histories().filter(rocking).count(),
            self.histories().count(),
        ]
    }

    /// Number of histories outside the model of four links, and whether the first that overturns is one of them, in words; `None` if the
    /// thrust line stays almost inside.
    fn outside_in_words(&self) -> Option<String> {
        let outside = self.remarks.model.in_words("histories")?;
        Some(match self.overturns_outside_model() {
            true => format!("{outside}; the first that overturns is one of them"),
            false => outside,
        })
    }

    /// True if the first history that overturns the structure is outside the model of four links.
    fn overturns_outside_model(&self) -> bool {
        let samples = self.histories();
        let overturned = samples.filter(|sample| sample.outcome == OVERTURNED);
        let first = overturned.min_by(|a, b| a.factor.total_cmp(&b.factor));
        let excess = first.and_then(|first| first.history?.thrust_excess_ratio);
        excess.is_some_and(|ratio| ratio > MODEL_LIMIT)
    }
}

impl VariedSummary {
    /// Number of histories without a verdict, in words; `None` if all have one.
    fn no_verdict(&self) -> Option<String> {
        let below = self.factor.map_or("", |_| " of weaker motions");
        let count = self.incomplete;
        (count > 0).then(|| format!("no verdict from {count} histories{below}"))
    }
}

impl TriedFactor {
    fn of(sample: &FactorSample) -> Self {
        let ending = sample.result.as_ref();
        Self {
            factor: sample.factor,
            outcome: outcome_name(&sample.result).to_owned(),
            history: ending.ok().map(|ending| HistorySummary {
                overturning_sway: ending.certain_overturning_sway(),
                impacts: ending.impacts,
                outcome_time_s: ending.outcome_time_s,
                peak_rotation_over_critical: ending.peak_over_critical,
                peak_rotation_rad: Some(ending.peak_rotation_rad),
                thrust_excess_ratio: ending.thrust_excess_ratio,
                friction_demand: ending.friction_demand,
            }),
            count: ending.ok().and_then(|ending| ending.count.clone()),
            reason: match ending {
                Ok(ending) => ending.doubt().map(ToString::to_string),
                Err(reason) => Some(reason.to_string()),
            },
        }
    }
}

/// Factor with the peak ground acceleration, in words.
fn factor_in_words(factor: &f64, peak_g: &f64) -> String {
    format!(
        "{} ({} g)",
        format_edge(*factor),
        format_edge(factor * peak_g)
    )
}

impl Factors {
    /// Factors as given, in words.
    pub fn in_words(&self) -> String {
        let from = self.from.map_or("the onset of motion".to_owned(), plain);
        let to = self.to.map_or("the first collapse".to_owned(), plain);
        sampled_in_words(&from, &to, self.stride)
    }
}

impl SearchedFactors {
    /// Factors in words.
    fn in_words(&self) -> String {
        let from = match self.begins_at_onset {
            true => format!("{}, the onset of motion,", format_edge(self.from)),
            false => plain(self.from),
        };
        let to = match self.ends_at_collapse {
            true => "the first collapse".to_owned(),
            false => plain(self.to),
        };
        sampled_in_words(&from, &to, self.stride)
    }

    /// Words of a quote about factors that were not tried; empty if the structure does not move under lower ones.
    pub(in crate::studies) fn lower_in_words(&self) -> String {
        lower_in_words(self.lower_not_tried.then_some(self.from))
    }
}

/// Words of a quote about factors below this one, which may overturn the structure; empty without it.
pub(super) fn lower_in_words(from: Option<f64>) -> String {
    from.map_or(String::new(), |from| {
        format!(", lower factors than {} not tried", plain(from))
    })
}

fn sampled_in_words(from: &str, to: &str, stride: f64) -> String {
    let percent = in_percent(stride);
    format!(
        "sampled from {from} to {to} in strides of {percent} %, and finely below the first edge"
    )
}

/// A stride in percent, without rounding errors.
fn in_percent(stride: f64) -> f64 {
    (1e6 * stride).round() / 1e4
}
