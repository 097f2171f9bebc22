//! How far the models of motion rock a structure in the same cases, compared as distributions.
//!
//! Where impacts decide, no model foretells a history, but it may well foretell the distribution of many: rocking is validated
//! statistically (Bachmann, Strand, Vassiliou, Broccardo and Stojadinovic, Earthquake Engineering and Structural Dynamics 47, 2018;
//! Vassiliou, Broccardo, Cengiz, Dietz, Dihoru, Gunay, Mosalam, Mylonakis, Sextos and Stojadinovic, ibid. 50, 2021).

use serde_json::{Value, json};

use super::ensemble::statistics::{fractile, swaps};
use super::results::Results;
use crate::output::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign};
use crate::output::table::{Column, column, csv};
use crate::output::{OutputError, pretty};

/// How far a structure rocked in a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// The record or the sample of the case: what is chance to one case of it may be chance to all.
    pub group: usize,
    /// The largest rotation of a body, in radians; infinite if it overturned.
    pub rotation_rad: f64,
}

/// The peaks of one model, by its name in words.
pub type OfModel<'a> = (&'a str, &'a [Peak]);

/// How far the distributions of two models are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// The largest difference between the shares with at most some peak: the statistic of Kolmogorov and Smirnov.
    pub distance: f64,
    /// That peak, in radians.
    pub at_rad: f64,
    /// The shares of the two there.
    pub shares: [f64; 2],
    /// How often as large a distance arises where it is left to chance, group by group, which cases are of which model.
    pub p: f64,
}

/// The peaks of two models in ascending order, and whether each is of the second.
type Mixed = Vec<(Peak, bool)>;

/// How far two models are apart; `None` if one of them has no case.
#[must_use]
pub fn apart(one: &[Peak], other: &[Peak]) -> Option<Apart> {
    if one.is_empty() || other.is_empty() {
        return None;
    }
    let of = |peaks: &[Peak], second: bool| -> Mixed {
        peaks.iter().map(|peak| (*peak, second)).collect()
    };
    let mut mixed = [of(one, false), of(other, true)].concat();
    mixed.sort_by(|a, b| a.0.rotation_rad.total_cmp(&b.0.rotation_rad));
    let (distance, at_rad, shares) = farthest(&mixed, &[]);
    let groups = mixed.iter().map(|(peak, _)| peak.group + 1).max()?;
    let mut tries = 0;
    // One counts for the cases as they are.
    let mut as_far = 1;
    for swapped in swaps(groups) {
        tries += 1;
        // Rounding makes no difference of its own.
        as_far += u32::from(farthest(&mixed, &swapped).0 > distance - 1e-9);
    }
    Some(Apart {
        distance,
        at_rad,
        shares,
        p: f64::from(as_far) / f64::from(tries + 1),
    })
}

/// The largest difference between the shares up to a finite peak, that peak, and the shares. Groups may be of the other model.
fn farthest(mixed: &Mixed, swapped: &[bool]) -> (f64, f64, [f64; 2]) {
    let is_second = |(peak, second): &(Peak, bool)| {
        *second != swapped.get(peak.group).copied().unwrap_or(false)
    };
    let seconds = mixed.iter().filter(|case| is_second(case)).count();
    let all = [mixed.len() - seconds, seconds].map(|count| count.max(1) as f64);
    let mut found = (0.0, 0.0, [0.0; 2]);
    let mut counts = [0.0; 2];
    for alike in mixed.chunk_by(|a, b| a.0.rotation_rad == b.0.rotation_rad) {
        for case in alike {
            counts[usize::from(is_second(case))] += 1.0;
        }
        let rotation_rad = alike[0].0.rotation_rad;
        let shares = [counts[0] / all[0], counts[1] / all[1]];
        let difference = (shares[0] - shares[1]).abs();
        if rotation_rad.is_finite() && difference > found.0 {
            found = (difference, rotation_rad, shares);
        }
    }
    found
}

/// The share of the cases of a model with at most this peak.
struct UpTo<'a> {
    model: &'a str,
    rotation_rad: f64,
    share: f64,
}

/// The distribution of the peaks of a model, ascending; what overturned is beyond all.
fn distribution<'a>((model, peaks): OfModel<'a>) -> Vec<UpTo<'a>> {
    let mut finite = rotations_rad(peaks);
    finite.retain(|rotation_rad| rotation_rad.is_finite());
    let shares = (1..).map(|count: u32| f64::from(count) / peaks.len() as f64);
    let at = |(rotation_rad, share)| UpTo {
        model,
        rotation_rad,
        share,
    };
    finite.into_iter().zip(shares).map(at).collect()
}

/// Ascending.
fn rotations_rad(peaks: &[Peak]) -> Vec<f64> {
    let mut all: Vec<f64> = peaks.iter().map(|peak| peak.rotation_rad).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Names of the files, the seal last.
pub const FILES: [&str; 3] = ["peaks.svg", "peaks.csv", "peaks.json"];

/// The distributions of several models of the same cases, side by side: table, picture, numbers and words.
///
/// # Errors
/// When a value is not finite.
pub fn tell(title: &str, models: &[OfModel<'_>], figure: Figure) -> Result<Results, OutputError> {
    let distributions: Vec<_> = models.iter().map(|model| distribution(*model)).collect();
    let pairs =
        (0..models.len()).flat_map(|one| (one + 1..models.len()).map(move |two| [one, two]));
    let pairs: Vec<([&str; 2], Apart)> = pairs
        .filter_map(|pair| {
            let [one, other] = pair.map(|index| models[index]);
            Some(([one.0, other.0], apart(one.1, other.1)?))
        })
        .collect();
    let summary = json!({
        "models": models.iter().map(|model| of_model(*model)).collect::<Vec<_>>(),
        "pairs": pairs.iter().map(|([one, other], apart)| json!({
            "models": [one, other],
            "kolmogorov_distance": apart.distance,
            "at_rotation_rad": apart.at_rad,
            "shares_there": apart.shares,
            "p": apart.p,
        })).collect::<Vec<_>>(),
    });
    let columns: [Column<'_, &UpTo<'_>>; 3] = [
        column("model", |at: &&UpTo<'_>| at.model.to_owned()),
        column("peak_rotation_rad", |at: &&UpTo<'_>| at.rotation_rad),
        column("share", |at: &&UpTo<'_>| at.share),
    ];
    let rows: Vec<&UpTo<'_>> = distributions.iter().flatten().collect();
    let words: Vec<String> = pairs
        .iter()
        .map(|(names, apart)| in_words(*names, apart))
        .collect();
    Ok(Results {
        files: FILES
            .into_iter()
            .zip([
                figure
                    .fitted(|figure| draw(figure, title, models, &distributions))
                    .into_bytes(),
                csv(columns, &rows)?,
                pretty(&summary).into_bytes(),
            ])
            .collect(),
        words: words.join("\n  "),
        summary,
        ..Results::default()
    })
}

fn of_model((name, peaks): OfModel<'_>) -> Value {
    let all = rotations_rad(peaks);
    let at = |part| fractile(&all, part).filter(|rotation_rad| rotation_rad.is_finite());
    json!({
        "model": name,
        "cases": all.len(),
        "overturned": all.iter().filter(|rotation_rad| rotation_rad.is_infinite()).count(),
        "peak_rotation_16_rad": at(0.16),
        "peak_rotation_50_rad": at(0.5),
        "peak_rotation_84_rad": at(0.84),
    })
}

/// Distances that chance makes more rarely than this are told as differences.
const RARE: f64 = 0.05;

fn in_words([one, other]: [&str; 2], apart: &Apart) -> String {
    let Apart {
        distance,
        at_rad,
        shares,
        p,
    } = apart;
    let verdict = if *p < RARE {
        "more than chance explains"
    } else {
        "no more than chance explains"
    };
    let [one_there, other_there] = shares.map(|share| format!("{:.0} %", 100.0 * share));
    format!(
        "distributions of the largest rotation, {one} against {other}: {distance:.2} apart at most (Kolmogorov), {verdict} (p = {}): up to \
         {at_rad:.4} rad rock {one_there} and {other_there}",
        if *p < 0.01 {
            format!("{p:.3}")
        } else {
            format!("{p:.2}")
        }
    )
}

fn draw(
    figure: Figure,
    title: &str,
    models: &[OfModel<'_>],
    distributions: &[Vec<UpTo<'_>>],
) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(title);
    let named = models.iter().map(|(name, _)| *name).zip(CURVES);
    let keys: Vec<Key<'_>> = named
        .clone()
        .map(|(name, stroke)| (name, Sign::Line(stroke)))
        .collect();
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let peaks = distributions.iter().flatten().map(|at| at.rotation_rad);
    let largest = peaks.fold(1e-3, f64::max);
    let axes = Axes {
        frame: figure.plot(top, figure.height_px(405.0)),
        x: Scale::exactly(0.0, 1.05 * largest, figure.ticks(8)),
        y: Scale::exactly(0.0, 1.0, 5),
    };
    let label = "largest rotation (rad); what overturned is beyond";
    axes.draw(
        &mut drawing,
        Some(label),
        "share with at most this rotation",
    );
    for ((name, stroke), distribution) in named.zip(distributions) {
        let rises = distribution.iter().map(|at| (at.rotation_rad, at.share));
        drawing.curve(name, axes.staircase(0.0, rises), stroke);
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peaks(of: impl IntoIterator<Item = f64>) -> Vec<Peak> {
        let of = of.into_iter().enumerate();
        of.map(|(group, rotation_rad)| Peak {
            group,
            rotation_rad,
        })
        .collect()
    }

    /// The probability of as large a distance between samples that are independent and large (Kolmogorov 1933; Smirnov 1948).
    fn kolmogorov(distance: f64, one: usize, other: usize) -> f64 {
        let (one, other) = (one as f64, other as f64);
        let scaled = distance * (one * other / (one + other)).sqrt();
        let term = |k: i32| {
            let sign = if k % 2 == 1 { 2.0 } else { -2.0 };
            sign * (-2.0 * (f64::from(k) * scaled).powi(2)).exp()
        };
        (1..100).map(term).sum::<f64>().clamp(0.0, 1.0)
    }

    #[test]
    fn the_distance_is_between_the_shares() {
        let one = peaks([1.0, 2.0, 3.0, 4.0]);
        let other = peaks([3.0, 4.0, f64::INFINITY, f64::INFINITY]);
        let found = apart(&one, &other).unwrap();
        assert_eq!(
            (found.distance, found.at_rad, found.shares),
            (0.5, 2.0, [0.5, 0.0])
        );
        // The same cases are no distance apart, whatever is swapped.
        let same = apart(&one, &one).unwrap();
        assert_eq!((same.distance, same.p), (0.0, 1.0));
        assert_eq!(apart(&one, &[]), None);
    }

    /// Values without any pairing: then the chance to be as far apart is that of the limit theorem, to three deviations (of 0.016 at
    /// most) of a thousand draws.
    #[test]
    fn chance_is_that_of_kolmogorov() {
        let value = |index: u64, shift: f64| {
            // The golden ratio's multiples, mixed, are as good as random here.
            let mixed = index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            ((mixed >> 11) as f64 / (1_u64 << 53) as f64) + shift
        };
        for (seed, shift) in [(1, 0.0), (2, 0.05), (3, 0.1), (4, 0.2)] {
            let sample = |from: u64, shift: f64| {
                peaks((from..from + 150).map(|index| value(1_000_003 * seed + index, shift)))
            };
            let found = apart(&sample(0, 0.0), &sample(500, shift)).unwrap();
            let known = kolmogorov(found.distance, 150, 150);
            assert!((found.p - known).abs() < 0.05, "{shift}: {found:?} {known}");
        }
        // Far apart: nothing that chance does is as far.
        let far = apart(
            &peaks((0..50).map(f64::from)),
            &peaks((0..50).map(|peak| f64::from(peak) + 40.0)),
        );
        assert_eq!(far.unwrap().p, 0.001);
    }
}
