//! Comparison of models of motion by the distribution of their largest rotations in the same cases.
//!
//! After impacts no model predicts a single history, but a model may predict the distribution of many: rocking is validated
//! statistically (Bachmann, Strand, Vassiliou, Broccardo and Stojadinovic, Earthquake Engineering and Structural Dynamics 47, 2018;
//! Vassiliou, Broccardo, Cengiz, Dietz, Dihoru, Gunay, Mosalam, Mylonakis, Sextos and Stojadinovic, ibid. 50, 2021).

use askama::Template;
use serde::{Deserialize, Serialize};

use super::page::{Page, PageCases, input_in_words};
use super::report::Report;
use super::results::Results;
use super::statistics::{ascending, fractile, shares_up_to};
use crate::argument::format_fixed;
use crate::output::page::Spot;
use crate::output::{CURVES, Chart, Figure, Mark, OutputError, Scale, Table, column};
use crate::scenario::{ModelKind, Scenario};

/// The name of a model in words, and the largest rotation of a body in each case, in radians, infinite if the case overturned.
pub type ModelPeaks<'a> = (&'a str, &'a [f64]);

/// The distance between the distributions of two models.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distance {
    /// The two models.
    pub models: [String; 2],
    /// The Kolmogorov-Smirnov statistic: the largest difference between the shares of cases up to the same rotation.
    pub kolmogorov_distance: f64,
    /// The rotation with the largest difference, in radians.
    pub at_rotation_rad: f64,
    /// The shares of cases of both models up to that rotation.
    pub shares_there: [f64; 2],
}

/// Computes the distance between the distributions of two models; `None` if one of them has no case.
pub fn distance(one: ModelPeaks<'_>, other: ModelPeaks<'_>) -> Option<Distance> {
    let both = [one, other];
    if both.iter().any(|(_, peaks)| peaks.is_empty()) {
        return None;
    }
    let mut found = Distance {
        models: both.map(|(name, _)| name.to_owned()),
        kolmogorov_distance: 0.0,
        at_rotation_rad: 0.0,
        shares_there: [0.0; 2],
    };
    let sorted = both.map(|(_, peaks)| ascending(peaks.iter().copied()));
    for (at_rad, _) in shares_up_to(sorted.concat().into_iter().map(|peak| [peak, 1.0])) {
        let shares = sorted
            .each_ref()
            .map(|peaks| peaks.partition_point(|peak| *peak <= at_rad) as f64 / peaks.len() as f64);
        let difference = (shares[0] - shares[1]).abs();
        if difference > found.kolmogorov_distance {
            found.kolmogorov_distance = difference;
            found.at_rotation_rad = at_rad;
            found.shares_there = shares;
        }
    }
    Some(found)
}

/// Names of the files, the seal last.
pub const FILES: [&str; 4] = ["peaks.html", "peaks.svg", "peaks.csv", "peaks.json"];

/// Comparison of models of motion by the distributions of their largest rotations in the same cases.
#[derive(Serialize, Deserialize, Template)]
#[template(source = "", ext = "txt")]
pub struct PeaksSummary {
    /// The distribution of each model.
    models: Vec<ModelSummary>,
    /// The distances between the distributions of any two models.
    pairs: Vec<Distance>,
}

impl Report for PeaksSummary {
    fn verdict(&self) -> String {
        let distances = self.pairs.iter().map(Distance::in_words);
        distances.collect::<Vec<_>>().join("\n")
    }
}

impl Distance {
    fn in_words(&self) -> String {
        let ([one, other], at_rad) = (&self.models, format_fixed(self.at_rotation_rad, 4));
        let [one_there, other_there] = self
            .shares_there
            .map(|share| format_fixed(100.0 * share, 0));
        format!(
            "largest rotation, {one} against {other}: Kolmogorov distance {}, at {at_rad} rad, which {one_there} % and {other_there} % of \
             the cases do not exceed",
            format_fixed(self.kolmogorov_distance, 2)
        )
    }
}

/// The distribution of a model.
#[derive(Serialize, Deserialize)]
struct ModelSummary {
    /// The model.
    model: String,
    /// Number of cases.
    cases: usize,
    /// Number of cases that overturned.
    overturned: usize,
    /// 16 % fractile of the largest rotation, in radians; null if it is in the range of overturned cases.
    peak_rotation_16_rad: Option<f64>,
    /// Median of the largest rotation, in radians; null if it is in the range of overturned cases.
    peak_rotation_50_rad: Option<f64>,
    /// 84 % fractile of the largest rotation, in radians; null if it is in the range of overturned cases.
    peak_rotation_84_rad: Option<f64>,
}

impl ModelSummary {
    fn of((name, peaks): &ModelPeaks<'_>) -> Self {
        let all = ascending(peaks.iter().copied());
        let at = |part| fractile(&all, part).filter(|peak| peak.is_finite());
        Self {
            model: (*name).to_owned(),
            cases: all.len(),
            overturned: all.iter().filter(|peak| peak.is_infinite()).count(),
            peak_rotation_16_rad: at(0.16),
            peak_rotation_50_rad: at(0.5),
            peak_rotation_84_rad: at(0.84),
        }
    }
}

/// Compares the distributions of scenarios that differ only in their models of motion, from the results of their suites or samples: report, table,
/// picture and page.
///
/// # Errors
/// When a value is not finite.
pub fn results(all: &[(&Scenario, &Results)], figure: Figure) -> Result<Results, OutputError> {
    let (scenario, _) = all[0];
    let title = scenario
        .title
        .as_deref()
        .unwrap_or("Largest rotations of several models");
    let peaks: Vec<_> = all
        .iter()
        .map(|(scenario, found)| {
            let known = found.largest_rotations_rad.iter().copied().flatten();
            (scenario.motion.kind.label, known.collect::<Vec<f64>>())
        })
        .collect();
    let models: Vec<ModelPeaks<'_>> = peaks.iter().map(|(name, all)| (*name, &all[..])).collect();
    let distributions: Vec<Distribution<'_>> = models
        .iter()
        .map(|(name, peaks)| (*name, shares_up_to(peaks.iter().map(|peak| [*peak, 1.0]))))
        .collect();
    let pairs = models.iter().enumerate().flat_map(|(index, one)| {
        let others = models[index + 1..].iter();
        others.filter_map(|other| distance(*one, *other))
    });
    let report = PeaksSummary {
        models: models.iter().map(ModelSummary::of).collect(),
        pairs: pairs.collect(),
    };
    type Row<'a> = (&'a str, (f64, f64));
    let columns = [
        column("model", |(model, _): &Row<'_>| (*model).to_owned()),
        column("peak_rotation_rad", |(_, at): &Row<'_>| at.0),
        column("share", |(_, at): &Row<'_>| at.1),
    ];
    let rows: Vec<Row<'_>> = distributions
        .iter()
        .flat_map(|(model, all)| all.iter().map(|at| (*model, *at)))
        .collect();
    let draw = |figure, spots: &[Spot]| draw(figure, title, &distributions, spots);
    let results = Results::of("peaks.json", &report)?
        .with_table("peaks.csv", Table::new(columns, &rows)?)
        .with_file("peaks.svg", draw(figure, &[]));
    let mut cases = PageCases::default();
    for ((_, found), (model, distribution)) in all.iter().zip(&distributions) {
        let known = found
            .largest_rotations_rad
            .iter()
            .enumerate()
            .filter_map(|(row, peak)| Some(((*peak)?, row)));
        let mut ranked: Vec<(f64, usize)> = known.collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let first = cases.add_texts_of(&found.cases);
        for ((_, row), (_, share)) in ranked.iter().zip(distribution) {
            let share = format_fixed(100.0 * share, 1);
            let before = format!("{model}, {share} % of the cases up to here; ");
            cases.push_copy(&before, (&found.cases, first), *row);
        }
    }
    let overturned = report.models.iter();
    let overturned = overturned
        .map(|one| format!("{}: {} of {}", one.model, one.overturned, one.cases))
        .collect::<Vec<_>>()
        .join(", ");
    let own = format!("overturned cases count as infinite and have no mark ({overturned})");
    let kinds: Vec<&ModelKind> = all.iter().map(|(one, _)| one.motion.kind).collect();
    let still = scenario.with_ground(None);
    let what = input_in_words(&[&still, &still]);
    let page = Page::new(title, what, &[&own], &kinds);
    let marked = |figure| draw(figure, &cases.spots);
    let results = results.with_page("peaks.html", page, &cases, (&marked, &[]));
    Ok(results.in_order(&FILES))
}

/// Name of a model, and its finite rotations with the share of cases up to each.
type Distribution<'a> = (&'a str, Vec<(f64, f64)>);

/// Draws the distributions; on a page with a mark for each row of the table.
fn draw(figure: Figure, title: &str, distributions: &[Distribution<'_>], spots: &[Spot]) -> String {
    let peaks = distributions.iter().flat_map(|(_, all)| all);
    let largest = peaks.map(|at| at.0).fold(1e-3, f64::max);
    let x = Scale::exactly(0.0, 1.05 * largest, figure.ticks(8));
    let curves = distributions
        .iter()
        .zip(CURVES)
        .map(|((name, all), stroke)| Mark::staircase(*name, stroke, (x, 0.0), all.iter().copied()));
    let label = "largest rotation (rad); overturned cases count as infinite";
    let y = Scale::exactly(0.0, 1.0, 5);
    let mut chart = Chart::new(405.0, (label, x), ("share with at most this rotation", y))
        .with_named(curves.collect());
    let rows = distributions.iter().flat_map(|(_, all)| all);
    let marks = rows.zip(spots).map(|(at, spot)| spot.mark(*at));
    chart.marks.extend(marks);
    chart.draw(figure, title)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_is_between_the_shares() {
        let one = ("one", &[1.0, 2.0, 3.0, 4.0][..]);
        let other = ("other", &[3.0, 4.0, f64::INFINITY, f64::INFINITY][..]);
        let found = distance(one, other).unwrap();
        assert_eq!(
            (
                found.kolmogorov_distance,
                found.at_rotation_rad,
                found.shares_there
            ),
            (0.5, 2.0, [0.5, 0.0])
        );
        assert_eq!(distance(one, one).unwrap().kolmogorov_distance, 0.0);
        assert_eq!(distance(one, ("none", &[])), None);
    }
}
