//! The threshold for each value of one key along a range: how the answer depends on a dimension, a stiffness or a duration.

mod no_impact;
mod picture;
mod report;

pub use report::FILES;

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use self::no_impact::least_without_impact;
use super::check;
use super::factors::Factors;
use super::first_edge::FirstEdge;
use crate::scenario::{Scenario, Sequence, Spacing};
use crate::studies::ending::NoAnswer;
use crate::studies::runner::Study;

/// Equally spaced values of a key of the scenario, ends included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeyRange {
    /// The key with its table, such as `arch.mean_radius_m`.
    pub key: String,
    /// The first value.
    pub from: f64,
    /// The last value, above the first.
    pub to: f64,
    /// How many values, 2 to 10000.
    pub count: usize,
}

impl KeyRange {
    /// The values.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        let Self {
            from, to, count, ..
        } = *self;
        let spacing = Spacing::Linear;
        Sequence::Range {
            from,
            to,
            count,
            spacing,
        }
        .values()
    }
}

impl FromStr for KeyRange {
    type Err = &'static str;

    /// Reads `arch.mean_radius_m=4..6:5`.
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

/// What is computed for each value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlongOptions {
    /// The values.
    pub along: KeyRange,
    /// The factors that are tried in the search for the first edge.
    pub factors: Factors,
    /// Whether also the least factor is found that overturns in the first fall, before any impact.
    pub no_impact: bool,
}

/// The thresholds of a scenario along a range of values.
#[derive(Debug)]
pub struct Along<'a> {
    scenario: &'a Scenario,
    options: AlongOptions,
    values: Vec<f64>,
}

/// The threshold for a value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlongRow {
    /// The value.
    pub value: f64,
    /// Largest horizontal acceleration of the ground at the factor 1, in units of gravity; `None` if the value is not allowed.
    pub peak_g: Option<f64>,
    /// Where the structure first overturns, or why this is unknown.
    pub edge: Result<FirstEdge, NoAnswer>,
    /// The least factor that overturns before any impact, if it was searched for: `None` if none does, or why this is unknown.
    pub no_impact: Option<Result<Option<f64>, String>>,
}

impl<'a> Along<'a> {
    /// The thresholds of a scenario that starts from rest; at least one value must be allowed.
    ///
    /// # Errors
    /// Explains what to change.
    pub fn of(scenario: &'a Scenario, options: AlongOptions) -> Result<Self, String> {
        check(scenario)?;
        if options.no_impact && scenario.motion().hinges().has_joints() {
            return Err(
                "--no-impact goes with four links and columns, whose hinges close all at once: leave it out, or give --hinges four"
                    .to_owned(),
            );
        }
        let study = Self {
            scenario,
            values: options.along.values(),
            options,
        };
        let faults = study.values.iter();
        let faults: Option<Vec<String>> = faults.map(|value| study.variant(*value).err()).collect();
        match faults.as_deref() {
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

impl Study for Along<'_> {
    type Row = AlongRow;

    const NAME: &'static str = "threshold_along";

    fn scenario(&self) -> String {
        self.scenario.to_toml()
    }

    fn inputs(&self) -> Vec<String> {
        self.scenario.record_checksums()
    }

    fn options(&self) -> serde_json::Value {
        serde_json::json!({ "along": self.options })
    }

    fn count(&self) -> usize {
        self.values.len()
    }

    fn row(&self, index: usize) -> AlongRow {
        let value = self.values[index];
        match self.variant(value) {
            Err(reason) => AlongRow {
                value,
                peak_g: None,
                no_impact: self.options.no_impact.then(|| Err(reason.clone())),
                edge: Err(NoAnswer::Invalid(reason)),
            },
            Ok(scenario) => AlongRow {
                value,
                peak_g: Some(super::peak_g(&scenario, scenario.ground_motion())),
                edge: FirstEdge::of(&scenario, &self.options.factors),
                no_impact: self
                    .options
                    .no_impact
                    .then(|| least_without_impact(&scenario, &self.options.factors)),
            },
        }
    }
}
