//! The first edge of every sample: the factor on its ground motion from which the sample overturns. The search goes upwards and ends at the
//! first edge.

use serde::Serialize;

use super::report::{Band, Findings, Line, doubts_in_words, share_in_words, why_not};
use super::{NoAnswer, Question, Samples};
use crate::output::{
    Chart, Figure, Key, Mark, OutputError, Scale, Sign, Stroke, color, column, csv, list,
};
use crate::scenario::Scenario;
use crate::studies::remarks::ModelCheck;
use crate::studies::statistics::{
    BAND, Share, ascending, ascending_weighted, fractile, weighted_fractile,
};
use crate::studies::threshold::first_edge::{FirstEdge, TREATMENTS};
use crate::studies::threshold::{Factors, check, rounded, rounded_down};

/// The question for the first edge of each sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstEdges {
    /// The factors that are tried.
    pub factors: Factors,
}

/// A fractile of the strengths at which cases first overturn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstStrength {
    /// The strength; infinite if too few cases overturn.
    pub strength: f64,
    /// True if the fractile may be lower, because cases overturn at the smallest strength already, or because it lies below that of the lowest
    /// case.
    pub at_most: bool,
}

impl FirstStrength {
    /// Computes the fractile for a `part` of these cases; `None` without cases.
    pub(super) fn of<'e>(
        edges: impl Iterator<Item = &'e FirstEdge> + Clone,
        part: f64,
    ) -> Option<Self> {
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
        Some(Self {
            strength: weighted_fractile(&strengths, part)?,
            at_most: is_below || weighted_fractile(&of(true), part)? == 0.0,
        })
    }

    /// Returns words that follow `at`: `at 0.5028`, `at or below 0.2000`, or `beyond`.
    pub(super) fn in_words(self, at: &str, beyond: &str) -> String {
        let Self { strength, at_most } = self;
        if !strength.is_finite() {
            return beyond.to_owned();
        }
        let or_below = if at_most { "at or below" } else { "at" };
        format!("{or_below} {at}{}", rounded(strength))
    }
}

impl Question for FirstEdges {
    type Answer = FirstEdge;

    const NAME: &'static str = "uncertain_threshold";

    const FILES: &'static [&'static str] = &[
        "probability.svg",
        "matters.svg",
        "probability.csv",
        "samples.csv",
        "uncertain.json",
    ];

    fn of(scenario: &Scenario, factors: Factors) -> Result<Self, String> {
        check(scenario)?;
        Ok(Self { factors })
    }

    fn findings<'a>(
        &'a self,
        samples: &Samples<'a, FirstEdge>,
        figure: Figure,
    ) -> Result<Findings<'a, FirstEdge, impl Serialize>, OutputError> {
        // A sample that never overturns counts with the largest factor.
        let strength = |edge: &FirstEdge| edge.factor.unwrap_or(edge.tried_to);
        let answer = ["first_factor", "the first factor that overturns"];
        let [low, median, high] = BAND.map(|part| FirstStrength::of(samples.answers(), part));
        let band = low.zip(median).zip(high);
        let band = band.map(|((low, median), high)| [low, median, high]);
        let at_one = share_up_to(samples, 1.0);
        let safe = samples.answers().map(FirstEdge::safe_or_zero);
        let safe = ascending(safe);
        let safe = band.map(|_| BAND.map(|part| fractile(&safe, part).unwrap_or(0.0)));
        let own = samples.own.as_ref().ok();
        let count = |condition: fn(&&_) -> bool| samples.answers().filter(condition).count();
        let probabilities = probabilities(samples);
        let names = ["probability", "probability_low", "probability_high"];
        let shares = [
            column("factor", |at: &ProbabilityAt| at.0),
            list(names, |at: &ProbabilityAt| at.1.numbers()),
        ];
        let columns = FirstEdge::columns("first_factor", |line: &Line<'a, FirstEdge>| {
            line.answer.as_ref().ok()
        });
        Ok(Findings {
            first: band.zip(safe).map(|(band, safe)| {
                safe_words(samples, safe) + &first_words(samples, band, at_one)
            }),
            lines: Vec::new(),
            influences: vec![samples.influence(answer, false, strength)],
            no_verdict: samples.no_verdict(),
            model: ModelCheck::of(samples.answers().map(|edge| edge.thrust_excess_ratio)),
            checked: "thresholds of samples",
            details: Details {
                survives_up_to_factor: safe.into(),
                own_survives_up_to_factor: own.and_then(|edge| edge.survives_up_to),
                first_factor: band.map(|band| band.map(|one| one.strength)).into(),
                at_smallest_factor: count(|edge| edge.at_most),
                beyond_largest_factor: count(|edge| edge.factor.is_none()),
                own_first_factor: own.and_then(|edge| edge.factor),
                overturned_up_to_factor_1: at_one,
            },
            pictures: vec![draw(figure, samples, &probabilities)],
            tables: vec![csv(shares, &probabilities)?],
            columns: columns.into_iter().chain([why_not()]).collect(),
            peaks: Vec::new(),
        })
    }

    fn answer(&self, scenario: &Scenario) -> Result<FirstEdge, NoAnswer> {
        FirstEdge::of(scenario, &self.factors)
    }

    fn settings(&self) -> Vec<String> {
        let factors = self.factors;
        let (from, to, stride) = (factors.from, factors.to, factors.stride);
        vec![format!("factors:{from:?}:{to:?}:{stride:?}")]
    }
}

/// The part of the summary that is specific to first edges.
#[derive(Serialize)]
struct Details {
    /// The largest factor up to which a sample certainly survives; 0 if it does not survive the smallest.
    survives_up_to_factor: Band,
    /// The largest factor up to which the scenario itself certainly survives; null if it does not survive the smallest.
    own_survives_up_to_factor: Option<f64>,
    /// The first factor that overturns a sample; uncertain factors count with the fraction of the repetitions that overturn.
    first_factor: Band,
    /// Number of samples that overturn at the smallest factor already.
    at_smallest_factor: usize,
    /// Number of samples that do not overturn up to the largest factor.
    beyond_largest_factor: usize,
    /// The first factor of the scenario itself; null if no factor overturns it.
    own_first_factor: Option<f64>,
    /// Share of the samples that overturn up to factor 1; null if the factors do not determine the share.
    overturned_up_to_factor_1: Option<Share>,
}

/// A factor at which a sample first overturns, and the share of samples that overturn up to it.
type ProbabilityAt = (f64, Share);

/// Returns the distribution of the first factors of the samples, ascending.
fn probabilities(samples: &Samples<'_, FirstEdge>) -> Vec<ProbabilityAt> {
    let edges = samples.answers();
    let strengths = |how| edges.clone().flat_map(move |edge| edge.strengths(how));
    let [steps, possible, certain] = TREATMENTS.map(|how| ascending_weighted(strengths(how)));
    let (all, mut expected) = (edges.clone().count(), 0.0);
    let at = |alike: &[[f64; 2]]| {
        let factor = alike[0][0];
        expected += alike.iter().map(|[_, share]| share).sum::<f64>();
        let [certain, possible] =
            [&certain, &possible].map(|end| end.partition_point(|at| at[0] <= factor));
        let share = Share::of_counts([certain, possible, all, samples.unknown()], expected);
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

/// Returns words for the factors that are safe for the samples, with these fractiles, and for the scenario itself.
fn safe_words(samples: &Samples<'_, FirstEdge>, [low, median, _]: [f64; 3]) -> String {
    let up_to = |factor: f64| match factor > 0.0 {
        true => rounded_down(factor),
        false => "less than the smallest factor".to_owned(),
    };
    let own = samples.own.as_ref().map(FirstEdge::safe_or_zero);
    let own = own.map_or("an unknown factor".to_owned(), up_to);
    let [low, median] = [low, median].map(up_to);
    format!(
        "95 % of the samples certainly survive up to {low}, half of them up to {median}, the scenario itself up to {own};\n    "
    )
}

fn first_words(
    samples: &Samples<'_, FirstEdge>,
    band: [FirstStrength; 3],
    at_one: Option<Share>,
) -> String {
    let tried_to = samples.answers().map(|edge| edge.tried_to);
    let beyond = format!("beyond {}", rounded(tried_to.fold(0.0, f64::max)));
    let [low, median, high] = band.map(|factor| factor.in_words("", &beyond));
    let probability = at_one.map_or(
        "with an unknown probability up to the factor 1, which is outside the factors that were tried"
            .to_owned(),
        |at_one| {
            let (share, doubts) = (share_in_words(&at_one), doubts_in_words(&at_one));
            format!("up to the factor 1 with a probability of {share}{doubts}")
        },
    );
    let own = match samples.own.as_ref().map(|own| (own.factor, own.at_most)) {
        Ok((Some(own), true)) => format!("at or below {}", rounded(own)),
        Ok((Some(own), false)) => format!("at {}", rounded(own)),
        Ok((None, _)) => "at no factor that was tried".to_owned(),
        Err(_) => "has no answer".to_owned(),
    };
    format!(
        "overturns {probability};\n    half of the samples first overturn {median} (5 %: {low}, 95 %: {high}), the scenario itself {own}"
    )
}

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
    let factors = probabilities.iter().map(|at| at.0);
    let factors = factors.chain(own).chain([1.0]);
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
    chart.draw(figure, samples.title("Probability of overturning"))
}
