//! Files and words of thresholds along a key.

use serde::Serialize;

use super::{Along, AlongOptions, AlongRow, KeyRange, Point, picture};
use crate::argument::plain;
use crate::output::{OutputError, column, csv, fields};
use crate::studies::threshold::{Factors, rounded, rounded_down};
use crate::studies::{
    CaseSummary, ModelCheck, NoAnswer, Remark, Remarks, ReportedStudy, Results, Style, no_verdict,
};

/// The part of the summary that is specific to thresholds along a key.
#[derive(Serialize)]
struct Details<'a> {
    /// The key and its values.
    along: &'a KeyRange,
    /// The tried factors.
    factors: &'a Factors,
    /// The threshold for each value.
    values: &'a [Point],
}

impl ReportedStudy for Along<'_> {
    const FILES: &'static [&'static str] = &[
        "threshold_along.svg",
        "threshold_along.json",
        "threshold_along.csv",
    ];

    fn results(&self, rows: Vec<AlongRow>, style: Style) -> Result<Results, OutputError> {
        let (rows, figure) = (&rows[..], style.figure);
        let points: Vec<Point> = rows.iter().map(Point::of).collect();
        let remarks = self.remarks(rows);
        let incomplete = rows
            .iter()
            .filter(|row| row.edge == Err(NoAnswer::Incomplete));
        let no_verdict = no_verdict(incomplete.count(), rows.len(), "values");
        let AlongOptions { along, factors, .. } = &self.options;
        let details = Details {
            along,
            factors,
            values: &points,
        };
        let limits = [remarks.model.in_words("thresholds"), no_verdict];
        let limits = limits.into_iter().flatten();
        let cases = rows.len();
        let summary = CaseSummary::new(self.scenario, cases, &remarks, limits.clone(), details);
        let key = along.key.as_str();
        let mut columns = vec![column(key, |point: &Point| point.value)];
        columns.extend(fields!(
            |point: &Point| point => survives_up_to_factor, survives_up_to_g, overturns_from_factor,
            overturns_from_g, at_most, uncertain_from_factor, tried_to_factor, failed_beyond, no_impact_factor, no_impact_g,
            thrust_excess_ratio, why_not
        ));
        let title = self.scenario.title.as_deref();
        let title = title.unwrap_or("Threshold of overturning");
        let picture = picture::draw(figure, title, key, &points);
        let mut words = vec![self.first_words(&points)];
        words.extend(limits);
        words.extend(remarks.failed_in_words("threshold_along.json"));
        words.push(factors.in_words());
        let others = [picture.into_bytes(), csv(columns, &points)?];
        Results::new(Self::FILES, &summary, words.join("\n  ") + "\n", others)
    }
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

    fn first_words(&self, points: &[Point]) -> String {
        let along = &self.options.along;
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
            self.options.no_impact.then(no_impact),
        ];
        format!(
            "{} values of {} from {} to {}: {}",
            points.len(),
            along.key,
            plain(along.from),
            plain(along.to),
            parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
        )
    }
}
