//! Incremental dynamic analysis: the response to each record as it gets stronger.

use std::fmt::Write as _;

use super::fragility::by_intensity;
use super::picture::{intensity_label, intensity_scale};
use super::told::Heading;
use super::{CaseRow, SuiteFragility};
use crate::dynamics::history::Outcome;
use crate::output::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign, Stroke, color};
use crate::studies::ending::Verdict;
use crate::studies::ensemble::statistics;

/// Number of records whose curves have looks and names of their own.
const NAMED: usize = CURVES.len();
/// Where overturned cases are drawn, as a fraction of the width.
const OVERTURNED: f64 = 1.0;
/// How far to the right surviving cases may be drawn, as a fraction of the width.
const SURVIVED: f64 = 0.94;

/// Draws the intensity against the peak rotation, relative to the critical one if that is known. Every record has a curve, also
/// when mirrored if mirrored cases count. Overturned cases are at the right end; an uncertain case is marked where its own history went.
#[must_use]
pub fn draw(figure: Figure, heading: &Heading, results: &SuiteFragility) -> String {
    let mut drawing = Drawing::new(figure);
    let mut top = drawing.title(heading.title());
    let records = records(results);
    let both = if results.mirrored_count {
        ", also mirrored"
    } else {
        ""
    };
    let count = results.record_count();
    let all = format!("a curve for each of {count} records{both}");
    let names: Vec<String> = records.iter().map(|cases| name(cases[0])).collect();
    let mut keys: Vec<Key<'_>> = if records.len() <= NAMED {
        let named = names.iter().map(String::as_str).zip(CURVES);
        named
            .map(|(name, stroke)| (name, Sign::Line(stroke)))
            .collect()
    } else {
        vec![(all.as_str(), Sign::Line(MANY))]
    };
    if results.has_uncertain() {
        keys.push((
            "uncertain whether it overturns",
            Sign::Circle(4.0, UNCERTAIN),
        ));
    }
    keys.extend(FRACTILES.map(|(name, stroke)| (name, Sign::Line(stroke))));
    let over_critical = over_critical(results);
    if over_critical {
        keys.push(("critical rotation", Sign::Line(CRITICAL)));
    }
    top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let survived = results.cases.iter().filter(|case| !goes_over(case));
    let largest = survived.filter_map(peak).fold(0.0, f64::max);
    let largest = if over_critical {
        largest.max(1.0)
    } else {
        largest.max(1e-3)
    };
    let axes = Axes {
        frame: figure.plot(top + 8.0, figure.height_px(480.0)),
        x: Scale::exactly(0.0, largest / SURVIVED, figure.ticks(8)),
        y: intensity_scale(heading, &results.levels, figure),
    };
    let label = if over_critical {
        "peak / critical rotation; arrows: overturned"
    } else {
        "peak rotation (rad); arrows: overturned"
    };
    axes.draw(&mut drawing, Some(label), intensity_label(results.measure));
    if over_critical {
        let [low, high] = [axes.y.low, axes.y.high].map(|y| axes.place(1.0, y));
        drawing.curve("critical", [low, high], CRITICAL);
    }
    let overturned = axes.x.at(OVERTURNED);
    let looks = (0..).map(|index: usize| {
        if records.len() > NAMED {
            MANY
        } else {
            CURVES[index % NAMED]
        }
    });
    for ((cases, name), stroke) in records.iter().zip(&names).zip(looks) {
        let at = |case: &CaseRow, x: f64| axes.place(x, case.level(results.measure));
        // What overturned is no point of the curve: it ends before, and goes on where the record is survived again.
        let mut curve = String::new();
        for survived in cases.split(|case| goes_over(case)) {
            let points = survived
                .iter()
                .filter_map(|case| Some(at(case, peak(case)?)));
            for (at, letter) in points.zip(["M"].into_iter().chain(std::iter::repeat("L"))) {
                let _ = write!(curve, "{letter}{:.2} {:.2}", at.x, at.y);
            }
        }
        if !curve.is_empty() {
            drawing.path(name, &curve, "none", stroke);
        }
        for case in cases {
            let plain = Stroke::new(stroke.color, 1.0, "");
            let Some(verdict) = case.known_verdict() else {
                continue;
            };
            if goes_over(case) {
                let (mark, look) = match verdict {
                    Verdict::Uncertain => ("uncertain", UNCERTAIN),
                    _ => ("overturned", plain),
                };
                let tip = at(case, overturned);
                let arrow = format!(
                    "M{:.2} {y:.2}H{:.2}M{:.2} {:.2}L{:.2} {y:.2}L{:.2} {:.2}",
                    tip.x - 11.0,
                    tip.x,
                    tip.x - 5.0,
                    tip.y - 3.0,
                    tip.x,
                    tip.x - 5.0,
                    tip.y + 3.0,
                    y = tip.y,
                );
                drawing.path(mark, &arrow, "none", look);
            } else if let Some(peak) = peak(case) {
                let (mark, radius, look) = match verdict {
                    Verdict::Uncertain => ("uncertain", 4.0, UNCERTAIN),
                    _ => ("survived", 2.2, plain),
                };
                drawing.circle(mark, at(case, peak), radius, look);
            }
        }
    }
    for (fractile, (name, stroke)) in FRACTILES.into_iter().enumerate() {
        let known = fractiles(results).into_iter();
        let points =
            known.filter_map(|level| Some(axes.place(level.peaks[fractile]?, level.intensity)));
        drawing.curve(name, points, stroke);
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

const MANY: Stroke = Stroke::new(color::GREY, 0.9, "");
/// Fractiles of the peaks at each level, over all records.
const FRACTILES: [(&str, Stroke); 3] = [
    ("16 %", Stroke::new(color::BLACK, 1.8, "2 3")),
    ("median", Stroke::new(color::BLACK, 2.6, "")),
    ("84 %", Stroke::new(color::BLACK, 1.8, "8 4")),
];

/// The peaks at a level, over all records that count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fractiles {
    /// The level.
    pub intensity: f64,
    /// Number of cases with a history.
    pub cases: usize,
    /// Number of those that overturned.
    pub overturned: usize,
    /// The fractiles of 16, 50 and 84 % of the peaks, over critical if that is known, otherwise in rad; what overturned is beyond
    /// all, and `None` is a fractile there.
    pub peaks: [Option<f64>; 3],
}

/// How far a case went, if its history is complete.
fn peak(case: &CaseRow) -> Option<f64> {
    case.known_verdict()?;
    let peak = case.result.as_ref().ok()?.peak;
    peak.over_critical().or(peak.rad())
}

/// The fractiles of the peaks (Vamvatsikos and Cornell, Earthquake Engineering and Structural Dynamics 31, 2002), level by level.
#[must_use]
pub fn fractiles(results: &SuiteFragility) -> Vec<Fractiles> {
    let counts = |case: &&CaseRow| results.mirrored_count || !case.mirrored;
    let cases: Vec<&CaseRow> = results.cases.iter().filter(counts).collect();
    let levels = by_intensity(cases, |case| case.level(results.measure)).into_iter();
    levels
        .map(|(intensity, cases)| {
            let beyond = |case: &&CaseRow| {
                if goes_over(case) {
                    Some(f64::INFINITY)
                } else {
                    peak(case)
                }
            };
            let mut peaks: Vec<f64> = cases.iter().filter_map(beyond).collect();
            peaks.sort_by(f64::total_cmp);
            let fractile =
                |part| statistics::fractile(&peaks, part).filter(|peak| peak.is_finite());
            Fractiles {
                intensity,
                cases: peaks.len(),
                overturned: peaks.iter().filter(|peak| peak.is_infinite()).count(),
                peaks: [0.16, 0.5, 0.84].map(fractile),
            }
        })
        .collect()
}
/// Grey, since dashed black lines are fractiles.
const CRITICAL: Stroke = Stroke::new(color::GREY, 1.4, "6 4");
const UNCERTAIN: Stroke = Stroke::new(color::GREEN, 1.6, "");

/// The largest rotation of each case that counts, in radians, infinite if it overturned.
pub(super) fn rotations_rad(cases: &[CaseRow]) -> Vec<f64> {
    let known = cases.iter().filter(|case| case.known_verdict().is_some());
    known
        .filter_map(|case| {
            let peak_rad = case.result.as_ref().ok()?.peak_rotation_rad;
            Some(if goes_over(case) {
                f64::INFINITY
            } else {
                peak_rad
            })
        })
        .collect()
}

/// Whether the history itself overturned, whether certain or not.
fn goes_over(case: &CaseRow) -> bool {
    let ending = case.result.as_ref();
    ending.is_ok_and(|ending| matches!(ending.outcome, Outcome::Overturned(_)))
}

fn name(case: &CaseRow) -> String {
    let mirrored = if case.mirrored { " mirrored" } else { "" };
    format!("{}{mirrored}", case.record)
}

/// The cases of each record that count, weakest first.
fn records(results: &SuiteFragility) -> Vec<Vec<&CaseRow>> {
    let counts = |case: &&CaseRow| results.mirrored_count || !case.mirrored;
    let cases: Vec<&CaseRow> = results.cases.iter().filter(counts).collect();
    cases
        .chunk_by(|a, b| (&a.record, a.mirrored) == (&b.record, b.mirrored))
        .map(<[_]>::to_vec)
        .collect()
}

/// The share of cases whose peak is at most this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakUpTo {
    /// The peak, as in [`Fractiles`].
    pub peak: f64,
    /// The share of all cases with a history.
    pub share: f64,
}

/// The distribution of the peaks of all cases that count, ascending; what overturned is beyond all, so that the share ends below 1.
#[must_use]
pub fn peaks(results: &SuiteFragility) -> Vec<PeakUpTo> {
    let counts = |case: &&CaseRow| results.mirrored_count || !case.mirrored;
    let cases = results.cases.iter().filter(counts);
    let cases: Vec<&CaseRow> = cases
        .filter(|case| case.known_verdict().is_some())
        .collect();
    let survived = cases.iter().filter(|case| !goes_over(case));
    let mut peaks: Vec<f64> = survived.filter_map(|case| peak(case)).collect();
    peaks.sort_by(f64::total_cmp);
    let share = |(index, peak): (usize, f64)| PeakUpTo {
        peak,
        share: (index + 1) as f64 / cases.len() as f64,
    };
    peaks.into_iter().enumerate().map(share).collect()
}

/// Draws the distribution of the peaks.
#[must_use]
pub fn draw_peaks(figure: Figure, heading: &Heading, results: &SuiteFragility) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(heading.title());
    let peaks = peaks(results);
    let words = "share of all records and levels; what overturned is beyond";
    let keys = [(words, Sign::Line(PEAKS))];
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let largest = peaks.last().map_or(1.0, |at| at.peak).max(1e-3);
    let axes = Axes {
        frame: figure.plot(top, figure.height_px(405.0)),
        x: Scale::exactly(0.0, 1.05 * largest, figure.ticks(8)),
        y: Scale::exactly(0.0, 1.0, 5),
    };
    let label = if over_critical(results) {
        "peak / critical rotation"
    } else {
        "peak rotation (rad)"
    };
    axes.draw(&mut drawing, Some(label), "share with at most this peak");
    let rises = peaks.iter().map(|at| (at.peak, at.share));
    drawing.curve("peaks", axes.staircase(0.0, rises), PEAKS);
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

const PEAKS: Stroke = Stroke::new(color::BLUE, 2.0, "");

/// Whether all peaks are known over the critical rotation.
fn over_critical(results: &SuiteFragility) -> bool {
    let mut endings = results
        .cases
        .iter()
        .filter_map(|case| case.result.as_ref().ok());
    endings.all(|ending| ending.peak.over_critical().is_some())
}
