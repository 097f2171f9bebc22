//! Report and files of thresholds along a key.

use askama::Template;
use serde::{Deserialize, Serialize};

use super::{Along, AlongOptions, AlongRow, KeyRange, Point, picture};
use crate::argument::plain;
use crate::output::{OutputError, column, csv, fields, filters};
use crate::studies::threshold::{Factors, rounded, rounded_down};
use crate::studies::{
    CaseSummary, ModelCheck, NoAnswer, Remark, Remarks, ReportedStudy, Results, Style, no_verdict,
};

/// Report on the threshold for each value of a key.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/threshold/along/words.txt")]
pub struct Summary {
    #[serde(flatten)]
    all: CaseSummary,
    /// Number of values without a verdict, because their histories end too early.
    values_without_verdict: usize,
    /// The key and its values.
    along: KeyRange,
    /// The tried factors.
    factors: Factors,
    /// True if the factor that overturns the structure before any impact was requested.
    no_impact: bool,
    /// The threshold for each value.
    values: Vec<Point>,
}

const SUMMARY: &str = "threshold_along.json";

impl ReportedStudy for Along<'_> {
    const FILES: &'static [&'static str] = &["threshold_along.svg", SUMMARY, "threshold_along.csv"];

    fn results(&self, rows: Vec<AlongRow>, style: Style) -> Result<Results, OutputError> {
        let incomplete = |row: &&AlongRow| row.edge == Err(NoAnswer::Incomplete);
        let remarks = self.remarks(&rows);
        let values_without_verdict = rows.iter().filter(incomplete).count();
        let limits = limits(&remarks, values_without_verdict, rows.len());
        let AlongOptions {
            along,
            factors,
            no_impact,
        } = self.options.clone();
        let report = Summary {
            all: CaseSummary::new(self.scenario, rows.len(), remarks, limits),
            values_without_verdict,
            along,
            factors,
            no_impact,
            values: rows.iter().map(Point::of).collect(),
        };
        let key = report.along.key.as_str();
        let mut columns = vec![column(key, |point: &Point| point.value)];
        columns.extend(fields!(
            |point: &Point| point => survives_up_to_factor, survives_up_to_g, overturns_from_factor,
            overturns_from_g, at_most, uncertain_from_factor, tried_to_factor, failed_beyond, no_impact_factor, no_impact_g,
            thrust_excess_ratio
        ));
        columns.push(column("why_not", |point: &Point| point.why_not.clone()));
        let title = self.scenario.title.as_deref();
        let title = title.unwrap_or("Threshold of overturning");
        let picture = picture::draw(style.figure, title, key, &report.values);
        let others = [picture.into_bytes(), csv(columns, &report.values)?];
        Results::new(Self::FILES, &report, others)
    }
}

/// Returns limits of the model, and the number of values without a verdict, in words.
fn limits(
    remarks: &Remarks,
    without_verdict: usize,
    values: usize,
) -> impl Iterator<Item = String> + use<> {
    let no_verdict = no_verdict(without_verdict, values, "values");
    let limits = [remarks.model.in_words("thresholds"), no_verdict];
    limits.into_iter().flatten()
}

impl Along<'_> {
    /// Returns the values without an answer, with the reasons.
    fn remarks(&self, rows: &[AlongRow]) -> Remarks {
        let edges = rows.iter().flat_map(|row| &row.edge);
        let mut remarks = Remarks::default();
        remarks.model = ModelCheck::of(edges.map(|edge| edge.thrust_excess_ratio));
        for row in rows {
            let case = format!("{} = {}", self.options.along.key, plain(row.value));
            if let Err(NoAnswer::Invalid(reason) | NoAnswer::Failed(reason)) = &row.edge {
                remarks.failures.push(Remark::new(case, reason));
            } else if let Some(Err(reason)) = &row.no_impact {
                remarks
                    .failures
                    .push(Remark::new(case + ", without impact", reason));
            }
        }
        remarks
    }
}

impl Summary {
    /// Returns the ranges of the thresholds, and the numbers of values without one, in words.
    fn ranges(&self) -> String {
        let points = &self.values;
        // The lowest and the highest acceleration, with their values.
        let range = |what: &str, of: fn(&Point) -> Option<f64>, rounded: fn(f64) -> String| {
            let known = points.iter();
            let known = known.filter_map(|point| Some((of(point)?, point.value)));
            let least = known.clone().min_by(|a, b| a.0.total_cmp(&b.0))?;
            let most = known.max_by(|a, b| a.0.total_cmp(&b.0))?;
            let at = |end: &str, (g, value): (f64, f64)| {
                format!("{} g ({end}, at {})", rounded(g), plain(value))
            };
            Some(format!(
                "{what} {} and {}",
                at("lowest", least),
                at("highest", most)
            ))
        };
        let count = |what: &str, at: fn(&&Point) -> bool| {
            let count = points.iter().filter(at).count();
            let values = ["value", "values"][usize::from(count > 1)];
            (count > 0).then(|| format!("{what} at {count} {values}"))
        };
        let no_impact = || {
            let ends = range(
                "without impact overturns from",
                |point| point.no_impact_g,
                rounded,
            );
            ends.unwrap_or_else(|| "no factor overturns it without impact".to_owned())
        };
        let parts = [
            range(
                "survives up to",
                |point| point.survives_up_to_g,
                rounded_down,
            ),
            count("not certain to survive the smallest factor", |point| {
                point.tried_to_factor.is_some() && point.survives_up_to_g.is_none()
            }),
            count("uncertain above", |point| {
                point.uncertain_from_factor.is_some()
            }),
            range(
                "certainly overturns from",
                |point| point.overturns_from_g,
                rounded,
            ),
            count("no factor certainly overturns it", |point| {
                let reached = point.tried_to_factor.is_some() && !point.failed_beyond;
                reached && point.overturns_from_g.is_none()
            }),
            count(
                "not known beyond the factor from which on the ground falls freely or the model fails,",
                |point| point.failed_beyond,
            ),
            count("no verdict", |point| point.why_not.is_some()),
            self.no_impact.then(no_impact),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}
