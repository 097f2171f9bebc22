//! Reports the thresholds along a range: table, summary and words.

use serde::Serialize;
use serde_json::json;

use super::{Along, AlongRow, picture};
use crate::argument::plain;
use crate::output::table::{column, csv};
use crate::output::{OutputError, pretty};
use crate::studies::ending::NoAnswer;
use crate::studies::remarks::{self, Remark, Remarks, no_verdict};
use crate::studies::results::{Look, Reported, Results};
use crate::studies::threshold::rounded;

/// Names of the files, the seal last.
pub const FILES: [&str; 3] = [
    "threshold_along.svg",
    "threshold_along.json",
    "threshold_along.csv",
];

/// The threshold for a value, as in the table and in the summary.
#[derive(Serialize)]
pub(super) struct Point {
    /// The value of the key.
    pub(super) value: f64,
    /// The least factor that certainly overturns the structure; absent if none does.
    overturns_from_factor: Option<f64>,
    /// The peak ground acceleration at that factor.
    pub(super) overturns_from_g: Option<f64>,
    /// Whether that is the least factor tried, so that a smaller one may overturn as well.
    at_most: bool,
    /// The least factor below that for which overturning is uncertain.
    uncertain_from_factor: Option<f64>,
    /// The least factor that overturns before any impact, if it was searched for and found.
    no_impact_factor: Option<f64>,
    /// The peak ground acceleration at that factor.
    pub(super) no_impact_g: Option<f64>,
    /// Why the threshold is unknown.
    why_not: Option<&'static str>,
}

impl Point {
    pub(super) fn of(row: &AlongRow) -> Self {
        let in_g = |factor: Option<f64>| Some(factor? * row.peak_g?);
        let edge = row.edge.as_ref().ok();
        let overturns_from_factor = edge.and_then(|edge| edge.factor);
        let no_impact_factor = row.no_impact.as_ref().and_then(|found| found.clone().ok()?);
        Self {
            value: row.value,
            overturns_from_factor,
            overturns_from_g: in_g(overturns_from_factor),
            at_most: edge.is_some_and(|edge| edge.at_most),
            uncertain_from_factor: edge.and_then(|edge| edge.uncertain_from),
            no_impact_factor,
            no_impact_g: in_g(no_impact_factor),
            why_not: row.edge.as_ref().err().map(NoAnswer::name),
        }
    }
}

impl Reported for Along<'_> {
    fn results(&self, rows: Vec<AlongRow>, look: Look) -> Result<Results, OutputError> {
        let (rows, figure) = (&rows[..], look.figure);
        let points: Vec<Point> = rows.iter().map(Point::of).collect();
        let remarks = self.remarks(rows);
        let mut summary = remarks::summary(self.scenario, rows.len(), &remarks);
        let incomplete = rows
            .iter()
            .filter(|row| row.edge == Err(NoAnswer::Incomplete));
        let no_verdict = no_verdict(incomplete.count(), rows.len(), "values");
        if let (Some(warnings), Some(words)) = (summary["warnings"].as_array_mut(), &no_verdict) {
            warnings.push(words.as_str().into());
        }
        summary["along"] = json!(self.options.along);
        summary["factors"] = json!(self.options.factors);
        summary["values"] = json!(points);
        let key = self.options.along.key.as_str();
        let columns = vec![
            column(key, |point: &Point| point.value),
            column("overturns_from_factor", |point: &Point| {
                point.overturns_from_factor
            }),
            column("overturns_from_g", |point: &Point| point.overturns_from_g),
            column("at_most", |point: &Point| point.at_most.to_string()),
            column("uncertain_from_factor", |point: &Point| {
                point.uncertain_from_factor
            }),
            column("no_impact_factor", |point: &Point| point.no_impact_factor),
            column("no_impact_g", |point: &Point| point.no_impact_g),
            column("why_not", |point: &Point| point.why_not),
        ];
        let title = self.scenario.title().unwrap_or("Threshold of overturning");
        let picture = picture::draw(figure, title, key, &points);
        let contents = [
            picture.into_bytes(),
            pretty(&summary).into_bytes(),
            csv(columns, &points)?,
        ];
        let mut words = vec![self.first_words(&points)];
        words.extend(remarks::rough_guide(self.scenario).map(str::to_owned));
        words.extend(no_verdict);
        words.extend(remarks.failed_in_words("threshold_along.json"));
        words.push(self.options.factors.in_words());
        Ok(Results {
            files: FILES.into_iter().zip(contents).collect(),
            words: words.join("\n  ") + "\n",
            summary,
            ..Results::default()
        })
    }
}

impl Along<'_> {
    /// The values without an answer, and why.
    fn remarks(&self, rows: &[AlongRow]) -> Remarks {
        let mut remarks = Remarks::default();
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

    fn first_words(&self, points: &[Point]) -> String {
        let along = &self.options.along;
        let mut text = format!(
            "{} values of {} from {} to {}: ",
            points.len(),
            along.key,
            plain(along.from),
            plain(along.to)
        );
        let range = |of: fn(&Point) -> Option<f64>| {
            let known = points
                .iter()
                .filter_map(|point| Some((of(point)?, point.value)));
            let known: Vec<(f64, f64)> = known.collect();
            let least = known.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
            let most = known.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
            let at = |(g, value): &(f64, f64)| format!("{} g at {}", rounded(*g), plain(*value));
            Some((known.len(), format!("from {} to {}", at(least), at(most))))
        };
        text += &match range(|point| point.overturns_from_g) {
            Some((count, ends)) => format!("the threshold is {ends}, at {count} values"),
            None => "no factor overturns the structure".to_owned(),
        };
        if self.options.no_impact {
            text += &match range(|point| point.no_impact_g) {
                Some((count, ends)) => {
                    format!("; without impact it overturns {ends}, at {count} values")
                }
                None => "; no factor overturns it without impact".to_owned(),
            };
        }
        text
    }
}
