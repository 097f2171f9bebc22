//! The first edge of every sample: the factor on its ground motion from which the sample overturns. The search goes upwards and ends at the
//! first edge.

use askama::Template;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::influence::InfluencedAnswer;
use super::page::{SAMPLES, SamplePage};
use super::report::{self, Band, Line, SampleSummary, why_not};
use super::{NoAnswer, SampleCases, SampleRow, Samples};
use crate::dynamics::Direction;
use crate::output::{
    Chart, Figure, Key, Mark, OutputError, Scale, Sign, Stroke, Table, color, column, each, list,
};
use crate::scenario::Scenario;
use crate::studies::intervals::{LEAST_FOR_LIMIT, rank_of_lower_limit};
use crate::studies::quotable::{
    self, ModelAnswer, SlipWords, SurvivorFriction, directions_in_words,
};
use crate::studies::report::{Report, Warnings};
use crate::studies::statistics::{
    BAND, Share, ascending, ascending_weighted, band, fractile, weighted_fractile,
};
use crate::studies::threshold::below::Fineness;
use crate::studies::threshold::first_edge::{FirstEdge, TREATMENTS};
use crate::studies::threshold::{Factors, check, format_edge, peak_g, rounded_down};
use crate::studies::{Results, Study, Style};

/// The study of the first edge of each sample.
#[derive(Clone, Copy, Debug)]
pub struct FirstEdges<'a> {
    cases: SampleCases<'a>,
    /// The factors that are tried.
    pub factors: Factors,
}

/// Computes the fractile of the strengths at which cases first overturn, for a `part` of these cases: infinite if too few cases overturn. The truth
/// value is true if the fractile may be lower, because cases overturn at the smallest strength already, or because it lies below that of the lowest
/// case. `None` without cases.
pub(super) fn first_strength<'e>(
    edges: impl Iterator<Item = &'e FirstEdge> + Clone,
    part: f64,
) -> Option<(f64, bool)> {
    let of = |lowest: bool| {
        let strengths = |edge: &FirstEdge| match lowest && edge.at_most {
            // An upper bound counts as 0, so that all fractiles that depend on it are 0.
            true => vec![[0.0, 1.0]],
            false => edge.strengths(TREATMENTS[0]),
        };
        ascending_weighted(edges.clone().flat_map(strengths))
    };
    let strengths = of(false);
    // A part of less than half a case lies below the lowest one.
    let is_below = part * (edges.clone().count() as f64) < 0.5 * strengths.first()?[1] - 1e-9;
    let at_most = is_below || weighted_fractile(&of(true), part)? == 0.0;
    Some((weighted_fractile(&strengths, part)?, at_most))
}

/// Quantiles of the strengths at which cases first overturn.
#[derive(Serialize, Deserialize)]
pub(super) struct StrengthBand {
    /// Null if too few cases overturn.
    #[serde(flatten)]
    quantiles: Band,
    /// True for each of the three quantiles that may be lower, because cases overturn at the smallest strength already, or because it lies below that
    /// of the lowest case.
    at_most: [bool; 3],
}

impl StrengthBand {
    pub(super) fn of<'e>(edges: impl Iterator<Item = &'e FirstEdge> + Clone) -> Self {
        let all = BAND.map(|part| first_strength(edges.clone(), part));
        Self {
            quantiles: all.map(|one| one.map(|(strength, _)| strength)).into(),
            at_most: all.map(|one| one.is_some_and(|(_, at_most)| at_most)),
        }
    }

    /// Quantile, counted from 0, between the words `at` and its unit: `at 0.5028`, `at or below peak_g 0.2000 g`, or `beyond`.
    pub(super) fn in_words(&self, which: usize, around: &[&str; 2], beyond: &str) -> String {
        let Band {
            quantile_05,
            median,
            quantile_95,
        } = self.quantiles;
        let strength = [quantile_05, median, quantile_95][which];
        strength.map_or(beyond.to_owned(), |strength| {
            strength_in_words(strength, self.at_most[which], *around)
        })
    }
}

fn strength_in_words(strength: f64, at_most: bool, [at, unit]: [&str; 2]) -> String {
    let or_below = if at_most { "at or below" } else { "at" };
    format!("{or_below} {at}{}{unit}", format_edge(strength))
}

impl<'a> FirstEdges<'a> {
    /// Makes the study of a scenario with a table `[uncertain]`.
    ///
    /// # Errors
    /// Returns the change that the scenario needs, in words.
    pub fn of(scenario: &'a Scenario, factors: Factors) -> Result<Self, String> {
        check(scenario)?;
        Ok(Self {
            cases: SampleCases::of(scenario)?,
            factors,
        })
    }

    fn answer(&self, scenario: &Scenario) -> Result<FirstEdge, NoAnswer> {
        let edge = FirstEdge::of(scenario, &self.factors, |_| Fineness::SAMPLES)?;
        match edge.is_outside_model() {
            true => Err(NoAnswer::OutsideModel),
            false => Ok(edge),
        }
    }
}

impl Study for FirstEdges<'_> {
    type Row = SampleRow<FirstEdge>;

    const NAME: &'static str = "uncertain_threshold";

    const FILES: &'static [&'static str] = &[
        SAMPLES,
        "probability.svg",
        "matters.svg",
        "probability.csv",
        "samples.csv",
        "uncertain.json",
    ];

    fn base(&self) -> Option<&Scenario> {
        Some(self.cases.scenario)
    }

    fn options(&self) -> Value {
        json!({ "factors": self.factors })
    }

    fn count(&self) -> usize {
        self.cases.count()
    }

    fn rows(&self, cases: &[usize]) -> Vec<Self::Row> {
        self.cases.rows(cases, |scenario, _| self.answer(scenario))
    }

    fn results(
        &self,
        rows: Vec<Self::Row>,
        Style { figure, .. }: Style,
    ) -> Result<Results, OutputError> {
        let samples = &Samples::new(self.cases, &rows);
        let edges = samples.answers();
        // A sample that never overturns counts with the largest factor.
        let strength = |edge: &FirstEdge| edge.factor.unwrap_or(edge.tried_to);
        let influence = samples.influence(false, strength);
        let influences = [(InfluencedAnswer::FirstFactor, influence)];
        let model = samples.model_check(edges.clone().map(|edge| edge.thrust_excess_ratio));
        let demands = edges.clone().map(|edge| edge.friction_demand);
        let study = format!("threshold FILE{}", self.factors.options());
        let scenario = samples.scenario;
        let survivors = (study.as_str(), "surviving motions of samples");
        let friction = SurvivorFriction::of(demands, scenario, survivors);
        let limits = (CHECKED, samples.no_verdict());
        let own = samples.own.as_ref().ok();
        let count = |condition: fn(&&_) -> bool| edges.clone().filter(condition).count();
        let lower_limit = LowerLimit::of(samples);
        let excesses = edges.clone().filter_map(|edge| edge.thrust_excess_ratio);
        let condition = SlipWords::of(scenario).condition(friction.friction_demand, &study);
        let quoted = lower_limit.quotable_answer(scenario, excesses.reduce(f64::max));
        let quoted = quoted.with_friction(condition);
        let report = UncertainThresholdSummary {
            all: SampleSummary::new(
                (samples, &self.factors.varied()),
                model,
                friction,
                limits,
                influences,
            ),
            to_quote: quotable::quote_answers(std::slice::from_ref(&quoted)),
            lower_limit,
            survives_up_to_factor: each(band(
                edges.clone().map(FirstEdge::safe_or_zero).collect(),
                fractile,
            ))
            .into(),
            own_survives_up_to_factor: own.and_then(|edge| edge.survives_up_to),
            first_factor: StrengthBand::of(edges.clone()),
            at_smallest_factor: count(|edge| edge.at_most),
            beyond_largest_factor: count(|edge| edge.factor.is_none()),
            tried_to_factor: edges.clone().map(|edge| edge.tried_to).reduce(f64::max),
            own_first_factor: own.and_then(|edge| edge.factor),
            own_first_factor_at_most: own.is_some_and(|edge| edge.at_most),
            overturned_up_to_factor_1: share_up_to(samples, 1.0),
        };
        let probabilities = probabilities(samples);
        let names = ["probability", "probability_low", "probability_high"];
        let shares = [
            column("factor", |at: &ProbabilityAt| at.0),
            list(names, |at: &ProbabilityAt| at.1.numbers()),
        ];
        let columns = FirstEdge::columns("first_factor", |(_, row): &Line<'_, FirstEdge>| {
            row.answer.as_ref().ok()
        });
        let direction =
            FirstEdge::direction_column(|(_, row): &Line<'_, FirstEdge>| row.answer.as_ref().ok());
        let columns = columns.into_iter().chain([direction, why_not()]);
        let results = Results::of("uncertain.json", &report)?
            .with_table("samples.csv", report::table(samples, columns)?)
            .with_table("probability.csv", Table::new(shares, &probabilities)?)
            .with_file("probability.svg", draw(figure, samples, &probabilities))
            .with_file("matters.svg", report.all.draw_influences(samples, figure));
        let page = SamplePage {
            title: samples.title(TITLE),
            label: "first factor that overturns",
            command: self.factors.command(),
            are_suites: false,
            answer: &|edge: &FirstEdge| (edge.spot_kind(), false, edge.factor),
            picture: &|figure| draw(figure, samples, &probabilities),
        };
        Ok(page
            .add_to(results, samples, &report.all)
            .in_order(Self::FILES))
    }
}

/// Lower 95 % confidence limit of the factor that 95 % of all structures survive: one of the lowest factors of the samples.
#[derive(Serialize, Deserialize)]
struct LowerLimit {
    /// Number of samples that count: all valid structures. Those without a verdict count as if they survive no factor.
    counted: usize,
    /// Rank of the sample, from 1 for the lowest; null with fewer than 59 samples, which give no limit.
    rank_of_limit: Option<usize>,
    /// The largest factor up to which that sample certainly survives: 95 % of all structures survive it, with a confidence of 95 %. Null if it does not
    /// survive the smallest factor, or without a rank.
    lower_limit_factor: Option<f64>,
}

impl LowerLimit {
    fn of(samples: &Samples<'_, FirstEdge>) -> Self {
        let known = samples.answers().map(FirstEdge::safe_or_zero);
        let safe = ascending(known.chain(std::iter::repeat_n(0.0, samples.count_unknown())));
        let rank = rank_of_lower_limit(safe.len());
        Self {
            counted: safe.len(),
            rank_of_limit: rank,
            lower_limit_factor: rank.map(|rank| safe[rank - 1]).filter(|safe| *safe > 0.0),
        }
    }

    /// Answer that may be quoted. `excess_ratio` is the largest excess of the thrust line of the samples.
    fn quotable_answer(&self, scenario: &Scenario, excess_ratio: Option<f64>) -> ModelAnswer {
        let (directions, counted) = (scenario.simulation.direction, self.counted);
        let uncertain = scenario
            .uncertain
            .iter()
            .flat_map(|uncertain| &uncertain.keys);
        let has_one_peak = uncertain.clone().all(|key| !key.key.starts_with("ground."));
        let in_g = |factor: f64| match has_one_peak {
            true => format!(" ({} g)", rounded_down(factor * peak_g(scenario))),
            false => " times the ground motion of each sample".to_owned(),
        };
        let answer = match (self.rank_of_limit, self.lower_limit_factor) {
            (None, _) => Err(format!(
                "{counted} samples are too few for the factor that 95 % survive: give at least {LEAST_FOR_LIMIT}"
            )),
            (Some(_), None) => Err(
                "too many samples lack a verdict, or do not certainly survive the smallest factor tried"
                    .to_owned(),
            ),
            (Some(rank), Some(factor)) => Ok(format!(
                "95 % of such structures survive up to {}{}{} (95 % confidence: sample {rank} of {counted}, the weakest first)",
                rounded_down(factor),
                in_g(factor),
                directions_in_words(directions, Direction::AsGiven)
            )),
        };
        let is_arch = scenario.structure.has_horizontal_thrust();
        ModelAnswer::new(scenario.motion.kind, is_arch, excess_ratio, answer)
    }
}

/// Report on the first edges of samples.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/ensemble/uncertain_threshold.txt")]
pub struct UncertainThresholdSummary {
    #[serde(flatten)]
    all: SampleSummary,
    /// The answer that may be quoted, in words.
    to_quote: Option<String>,
    #[serde(flatten)]
    lower_limit: LowerLimit,
    /// The largest factor up to which a sample certainly survives; 0 if it does not survive the smallest.
    survives_up_to_factor: Band,
    /// The largest factor up to which the scenario itself certainly survives; null if it does not survive the smallest.
    own_survives_up_to_factor: Option<f64>,
    /// The first factor that overturns a sample; uncertain factors count with the fraction of the repetitions that overturn.
    first_factor: StrengthBand,
    /// Number of samples that overturn at the smallest factor already.
    at_smallest_factor: usize,
    /// Number of samples that do not overturn up to the largest factor.
    beyond_largest_factor: usize,
    /// The largest factor that was tried for any sample; null without answers.
    tried_to_factor: Option<f64>,
    /// The first factor of the scenario itself; null if no factor overturns it.
    own_first_factor: Option<f64>,
    /// True if the scenario itself overturns at the smallest factor already, so that its first factor may be lower.
    own_first_factor_at_most: bool,
    /// Share of the samples that overturn up to factor 1; null if the factors do not determine the share.
    overturned_up_to_factor_1: Option<Share>,
}

/// A factor at which a sample first overturns, and the share of samples that overturn up to it.
type ProbabilityAt = (f64, Share);

/// Distribution of the first factors of the samples, ascending.
fn probabilities(samples: &Samples<'_, FirstEdge>) -> Vec<ProbabilityAt> {
    let edges = samples.answers();
    let strengths = |how| edges.clone().flat_map(move |edge| edge.strengths(how));
    let [steps, possible, certain] = TREATMENTS.map(|how| ascending_weighted(strengths(how)));
    let (all, unknown, mut expected) = (edges.clone().count(), samples.count_unknown(), 0.0);
    let at = |alike: &[[f64; 2]]| {
        let factor = alike[0][0];
        expected += alike.iter().map(|[_, share]| share).sum::<f64>();
        let [certain, possible] =
            [&certain, &possible].map(|end| end.partition_point(|at| at[0] <= factor));
        let share = Share::of_counts([certain, possible, all, unknown], expected);
        factor.is_finite().then_some((factor, share?))
    };
    let alike = steps.chunk_by(|a, b| a[0] == b[0]);
    alike.filter_map(at).collect()
}

/// Computes the share of samples that overturn up to this factor; `None` if the tried factors do not determine the share.
fn share_up_to(samples: &Samples<'_, FirstEdge>, factor: f64) -> Option<Share> {
    let mut answers = samples.answers();
    let known = answers.all(|edge| edge.overturns_up_to(factor).is_some());
    known.then(|| samples.share(|edge| edge.overturns_up_to(factor).unwrap_or(0.0)))?
}

impl Report for UncertainThresholdSummary {
    fn verdict(&self) -> String {
        self.all.verdict(|| {
            let Band {
                quantile_05, median, ..
            } = &self.survives_up_to_factor;
            format!(
                "95 % of the samples certainly survive up to {}, half of them up to {}, the scenario itself up to {}",
                safe_factor_in_words(quantile_05),
                safe_factor_in_words(median),
                self.own_safe()
            )
        })
    }

    fn quote(&self) -> Option<&str> {
        self.to_quote.as_deref()
    }

    fn warnings(&self) -> &Warnings {
        &self.all.warnings
    }
}

impl UncertainThresholdSummary {
    /// Factor up to which the scenario itself certainly survives, in words.
    fn own_safe(&self) -> String {
        match self.all.own_without_answer {
            Some(_) => "an unknown factor".to_owned(),
            None => safe_factor_in_words(&self.own_survives_up_to_factor),
        }
    }

    /// Quantile of the first factors, counted from 0, in words.
    fn first(&self, which: usize) -> String {
        let beyond = format!(
            "beyond {}",
            format_edge(self.tried_to_factor.unwrap_or(0.0))
        );
        self.first_factor.in_words(which, &[""; 2], &beyond)
    }

    /// First factor of the scenario itself in words.
    fn own_first(&self) -> String {
        match (self.own_first_factor, &self.all.own_without_answer) {
            (Some(factor), _) => strength_in_words(factor, self.own_first_factor_at_most, [""; 2]),
            (None, None) => "at no factor that was tried".to_owned(),
            (None, Some(_)) => "has no answer".to_owned(),
        }
    }
}

/// Factor up to which a structure certainly survives, in words.
fn safe_factor_in_words(factor: &Option<f64>) -> String {
    let factor = factor.filter(|factor| *factor > 0.0);
    factor.map_or("less than the smallest factor".to_owned(), rounded_down)
}

/// The histories that are checked, in words.
const CHECKED: &str = "thresholds of samples";

const BAND_FILL: &str = "#cfe3f1";
const SHARE: Stroke = Stroke::new(color::BLUE, 1.6, "");
const OWN: Stroke = Stroke::new(color::BLACK, 1.4, "6 4");

/// Draws the probability of overturning against the factor, with its interval, and the first factor of the scenario itself.
fn draw(
    figure: Figure,
    samples: &Samples<'_, FirstEdge>,
    probabilities: &[ProbabilityAt],
) -> String {
    let own = samples.own.as_ref().ok().and_then(|edge| edge.factor);
    let factors = probabilities.iter().map(|at| at.0).chain(own).chain([1.0]);
    let ends = factors.flat_map(|factor| [0.97 * factor, 1.03 * factor]);
    let x = Scale::around(ends, figure.ticks(8));
    let y = Scale::exactly(0.0, 1.0, 5);
    // The share rises at the first factor of each sample.
    let steps = |name, of: fn(&Share) -> f64, first: f64| {
        let rises = probabilities.iter().map(|at| (at.0, of(&at.1)));
        Mark::staircase(name, SHARE, (x, first), rises)
    };
    let none = samples.share(|_| 0.0).map_or(1.0, |none| none.high);
    let ends = [steps("", |at| at.low, 0.0), steps("", |at| at.high, none)];
    let [low, high] = ends.each_ref().map(|curve| curve.points().iter().copied());
    let mut marks = vec![steps("probability", |at| at.share, 0.0)];
    marks.extend(own.map(|own| Mark::upright("own", OWN, own, y)));
    let x_axis = ("factor on the ground motion", x);
    let chart = Chart {
        keys: vec![
            Key::line("share of the samples", SHARE),
            Key::new("95 % interval", Sign::Band(BAND_FILL, 1.0)),
            Key::line("the scenario itself", OWN),
        ],
        below: vec![Mark::between("band", BAND_FILL, low, high)],
        marks,
        ..Chart::new(405.0, x_axis, ("probability of overturning", y))
    };
    chart.draw(figure, samples.title(TITLE))
}

const TITLE: &str = "Probability of overturning";
