//! The threshold as a function of one key: of a dimension, a stiffness or a duration.

mod no_impact;
mod picture;
mod report;

pub use self::report::AlongSummary;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use self::no_impact::least_without_impact;
use super::below::Fineness;
use super::check;
use super::factors::Factors;
use super::first_edge::FirstEdge;
use crate::dynamics::Direction;
use crate::output::OutputError;
use crate::scenario::{Scenario, Sequence, Spacing, Varied};
use crate::studies::{NoAnswer, Results, Study, Style};

/// Equally spaced values of a key of the scenario, ends included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeyRange {
    /// The key with its table, such as `arch.mean_radius_m`.
    pub key: String,
    /// The first value.
    pub from: f64,
    /// The last value, above the first.
    pub to: f64,
    /// Number of values, 2 to 10000.
    pub count: usize,
}

impl KeyRange {
    /// Values.
    pub fn values(&self) -> Vec<f64> {
        let range = Sequence::Range {
            from: self.from,
            to: self.to,
            count: self.count,
            spacing: Spacing::Linear,
        };
        range.values()
    }
}

impl fmt::Display for KeyRange {
    /// Writes the text that [`KeyRange::from_str`] parses.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            key,
            from,
            to,
            count,
        } = self;
        write!(f, "{key}={from}..{to}:{count}")
    }
}

impl FromStr for KeyRange {
    type Err = &'static str;

    /// Parses text such as `arch.mean_radius_m=4..6:5`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let read = || {
            let (key, range) = text.split_once('=')?;
            let (from, range) = range.split_once("..")?;
            let (to, count) = range.split_once(':')?;
            let number = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite());
            Some(Self {
                key: key.trim().to_owned(),
                from: number(from)?,
                to: number(to)?,
                count: count.trim().parse().ok()?,
            })
        };
        read()
            .filter(|range| range.from < range.to && (2..=10_000).contains(&range.count))
            .ok_or(
                "must be TABLE.KEY=FROM..TO:COUNT with FROM below TO and a COUNT from 2 to 10000, such as arch.mean_radius_m=4..6:5",
            )
    }
}

/// The options of thresholds along a key.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlongOptions {
    /// The values of the key.
    pub along: KeyRange,
    /// The factors that the search for the first edge tries.
    pub factors: Factors,
    /// True to find also the smallest factor that overturns the structure before any impact.
    pub no_impact: bool,
}

impl AlongOptions {
    /// Key, and the largest factor.
    pub(in crate::studies) fn varied(&self) -> Varied<'_> {
        let KeyRange { key, from, to, .. } = &self.along;
        Varied {
            key_range: Some((key, [*from, *to])),
            factor: self.factors.to,
            ..Varied::default()
        }
    }
}

/// The thresholds of a scenario along a range of values.
#[derive(Debug)]
pub struct Along<'a> {
    scenario: &'a Scenario,
    options: AlongOptions,
    values: Vec<f64>,
}

/// The threshold for a value of the key.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlongRow {
    /// The value.
    pub value: f64,
    /// Largest horizontal acceleration of the ground at factor 1, in units of gravity; `None` if the value is not allowed.
    pub peak_g: Option<f64>,
    /// The first edge, or the reason why it is unknown.
    pub edge: Result<FirstEdge, NoAnswer>,
    /// The smallest factor that overturns the structure before any impact; `None` inside if no factor does, `None` outside if it was not
    /// requested. The error is the reason why it is unknown.
    pub no_impact: Option<Result<Option<f64>, String>>,
}

impl<'a> Along<'a> {
    /// Makes the study of a scenario that starts from rest. At least one value must be allowed.
    ///
    /// # Errors
    /// Change that the scenario needs, in words.
    pub fn of(scenario: &'a Scenario, options: AlongOptions) -> Result<Self, String> {
        check(scenario)?;
        if options.no_impact && !scenario.motion.kind.has_mechanism {
            return Err("--no-impact is for four links and columns, whose hinges close all at once: leave it out, or give --hinges four".into());
        }
        let study = Self {
            scenario,
            values: options.along.values(),
            options,
        };
        let fault = |value: f64| study.variant(value).and_then(|one| one.check_restitution());
        let faults = study.values.iter().map(|value| fault(*value).err());
        match faults.collect::<Option<Vec<String>>>().as_deref() {
            Some([first, ..]) => Err(format!(
                "no value of `{}` makes a valid scenario: {first}",
                study.options.along.key
            )),
            _ => Ok(study),
        }
    }

    fn variant(&self, value: f64) -> Result<Scenario, String> {
        self.scenario
            .with_values(&[(self.options.along.key.as_str(), value)])
    }
}

/// The threshold for a value, for the table and the summary.
#[derive(Serialize, Deserialize)]
struct Point {
    /// The value of the key.
    value: f64,
    /// The largest factor up to which the structure certainly survives all tried factors; null if it does not survive the smallest.
    survives_up_to_factor: Option<f64>,
    /// The peak ground acceleration at that factor, in units of gravity.
    survives_up_to_g: Option<f64>,
    /// The smallest factor that certainly overturns the structure; null if no factor does.
    overturns_from_factor: Option<f64>,
    /// The peak ground acceleration at that factor, in units of gravity.
    overturns_from_g: Option<f64>,
    /// True if that factor is the smallest tried one, so that a smaller factor may overturn the structure as well.
    at_most: bool,
    /// The smallest factor below `overturns_from_factor` with an uncertain verdict; null without uncertain verdicts.
    uncertain_from_factor: Option<f64>,
    /// The largest factor with a history.
    tried_to_factor: Option<f64>,
    /// True if the history at the next factor failed, because the ground falls freely for example: nothing is known of stronger motions.
    failed_beyond: bool,
    /// The smallest factor that overturns the structure before any impact; null if it was not requested or not found.
    no_impact_factor: Option<f64>,
    /// The peak ground acceleration at `no_impact_factor`, in units of gravity.
    no_impact_g: Option<f64>,
    /// Largest excess of the thrust line of four links at `overturns_from_factor`, or at the largest tried factor without it; null for other models.
    thrust_excess_ratio: Option<f64>,
    /// Largest friction coefficient that the histories up to `survives_up_to_factor` and their repetitions require without slip; null if joints slip or
    /// are elastic.
    #[serde(default)]
    friction_demand: Option<f64>,
    /// Worse direction of the ground motion at the first factor that is not certainly survived, or at the largest tried factor without it; null without
    /// a threshold.
    direction: Option<Direction>,
    /// Reason why the threshold is unknown.
    why_not: Option<String>,
}

impl Point {
    fn of(row: &AlongRow) -> Self {
        let in_g = |factor: Option<f64>| Some(factor? * row.peak_g?);
        let edge = row.edge.as_ref().ok();
        let overturns_from_factor = edge.and_then(|edge| edge.factor);
        let survives_up_to_factor = edge.and_then(|edge| edge.survives_up_to);
        let no_impact_factor = row.no_impact.as_ref().and_then(|found| found.clone().ok()?);
        Self {
            value: row.value,
            survives_up_to_factor,
            survives_up_to_g: in_g(survives_up_to_factor),
            overturns_from_factor,
            overturns_from_g: in_g(overturns_from_factor),
            at_most: edge.is_some_and(|edge| edge.at_most),
            uncertain_from_factor: edge.and_then(|edge| edge.uncertain_from),
            tried_to_factor: edge.map(|edge| edge.tried_to),
            failed_beyond: edge.is_some_and(|edge| edge.failed_beyond),
            no_impact_factor,
            no_impact_g: in_g(no_impact_factor),
            thrust_excess_ratio: edge.and_then(|edge| edge.thrust_excess_ratio),
            friction_demand: edge.and_then(|edge| edge.friction_demand),
            direction: edge.map(|edge| edge.direction),
            why_not: row.edge.as_ref().err().map(|why| why.name().to_owned()),
        }
    }
}

impl Along<'_> {
    /// Computes the threshold of a value of the key.
    fn row(&self, value: f64) -> AlongRow {
        let (scenario, factors) = (self.variant(value), &self.options.factors);
        let scenario = scenario.as_ref().map_err(String::clone);
        let no_impact = || least_without_impact(scenario.clone()?, factors);
        let edge = scenario.clone().map_err(NoAnswer::Invalid);
        AlongRow {
            value,
            peak_g: scenario.as_ref().ok().map(|one| super::peak_g(one)),
            no_impact: self.options.no_impact.then(no_impact),
            edge: edge.and_then(|one| FirstEdge::of(one, factors, Fineness::of_threshold)),
        }
    }
}

impl Study for Along<'_> {
    type Row = AlongRow;

    const NAME: &'static str = "threshold_along";

    const FILES: &'static [&'static str] = &report::FILES;

    fn base(&self) -> Option<&Scenario> {
        Some(self.scenario)
    }

    fn options(&self) -> serde_json::Value {
        serde_json::json!({ "along": self.options })
    }

    fn count(&self) -> usize {
        self.values.len()
    }

    fn rows(&self, indices: &[usize]) -> Vec<AlongRow> {
        indices
            .iter()
            .map(|index| self.row(self.values[*index]))
            .collect()
    }

    fn results(&self, rows: Vec<AlongRow>, style: Style) -> Result<Results, OutputError> {
        self.report(&rows, style)
    }
}
