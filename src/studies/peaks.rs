//! Comparison of models of motion by the distribution of their largest rotations in the same cases.
//!
//! After impacts no model predicts a single history, but a model may predict the distribution of many: rocking is validated
//! statistically (Bachmann, Strand, Vassiliou, Broccardo and Stojadinovic, Earthquake Engineering and Structural Dynamics 47, 2018;
//! Vassiliou, Broccardo, Cengiz, Dietz, Dihoru, Gunay, Mosalam, Mylonakis, Sextos and Stojadinovic, ibid. 50, 2021).

use serde::Serialize;
use serde_json::json;

use super::results::Results;
use super::statistics::{ascending, fractile, shares_up_to};
use crate::output::{CURVES, Chart, Figure, Mark, OutputError, Scale, column, csv};

/// The name of a model in words, and the largest rotation of a body in each case, in radians, infinite if the case overturned.
pub type ModelPeaks<'a> = (&'a str, &'a [f64]);

/// The distance between the distributions of two models.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
const FILES: [&str; 3] = ["peaks.svg", "peaks.csv", SUMMARY];
/// The numbers of a comparison.
pub const SUMMARY: &str = "peaks.json";

/// Compares the distributions of several models of the same cases: table, picture, numbers and words.
///
/// # Errors
/// When a value is not finite.
pub fn results(
    title: &str,
    models: &[ModelPeaks<'_>],
    figure: Figure,
) -> Result<Results, OutputError> {
    let distributions = models.iter();
    let distributions: Vec<Distribution<'_>> = distributions
        .map(|(name, peaks)| (*name, shares_up_to(peaks.iter().map(|peak| [*peak, 1.0]))))
        .collect();
    let pairs = models.iter().enumerate().flat_map(|(index, one)| {
        let others = models[index + 1..].iter();
        others.filter_map(|other| distance(*one, *other))
    });
    let pairs: Vec<Distance> = pairs.collect();
    let of_model = |(name, peaks): &ModelPeaks<'_>| {
        let all = ascending(peaks.iter().copied());
        let at = |part| fractile(&all, part).filter(|peak| peak.is_finite());
        json!({
            "model": name,
            "cases": all.len(),
            "overturned": all.iter().filter(|peak| peak.is_infinite()).count(),
            "peak_rotation_16_rad": at(0.16),
            "peak_rotation_50_rad": at(0.5),
            "peak_rotation_84_rad": at(0.84),
        })
    };
    let of_models: Vec<_> = models.iter().map(of_model).collect();
    let summary = json!({ "models": of_models, "pairs": pairs });
    type Row<'a> = (&'a str, (f64, f64));
    let columns = [
        column("model", |(model, _): &Row<'_>| (*model).to_owned()),
        column("peak_rotation_rad", |(_, at): &Row<'_>| at.0),
        column("share", |(_, at): &Row<'_>| at.1),
    ];
    let rows = distributions.iter();
    let rows = rows.flat_map(|(model, all)| all.iter().map(|at| (*model, *at)));
    let table = csv(columns, &rows.collect::<Vec<Row<'_>>>())?;
    let picture = draw(figure, title, &distributions);
    let words: Vec<String> = pairs.iter().map(in_words).collect();
    let others = [picture.into_bytes(), table];
    Results::with_words(&FILES, &summary, words.join("\n  "), others)
}

fn in_words(found: &Distance) -> String {
    let [one, other] = &found.models;
    let [one_there, other_there] = found
        .shares_there
        .map(|share| format!("{:.0} %", 100.0 * share));
    format!(
        "largest rotation, {one} against {other}: Kolmogorov distance {:.2}, at {:.4} rad, which {one_there} and {other_there} of the cases \
         do not exceed",
        found.kolmogorov_distance, found.at_rotation_rad
    )
}

/// Name of a model, and its finite rotations with the share of cases up to each.
type Distribution<'a> = (&'a str, Vec<(f64, f64)>);

fn draw(figure: Figure, title: &str, distributions: &[Distribution<'_>]) -> String {
    let peaks = distributions.iter().flat_map(|(_, all)| all);
    let largest = peaks.map(|at| at.0).fold(1e-3, f64::max);
    let x = Scale::exactly(0.0, 1.05 * largest, figure.ticks(8));
    let curves = distributions.iter().zip(CURVES);
    let curves = curves
        .map(|((name, all), stroke)| Mark::staircase(*name, stroke, (x, 0.0), all.iter().copied()));
    let label = "largest rotation (rad); overturned cases are beyond";
    let y = Scale::exactly(0.0, 1.0, 5);
    let chart = Chart::new(405.0, (label, x), ("share with at most this rotation", y));
    chart.with_named(curves.collect()).draw(figure, title)
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
