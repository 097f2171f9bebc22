//! Incremental dynamic analysis: the response to each record as it gets stronger.

use super::fragility::by_intensity;
use super::picture::{intensity_label, intensity_scale};
use super::told::Heading;
use super::{CaseRow, SuiteFragility};
use crate::dynamics::history::Outcome;
use crate::output::Figure;
use crate::output::axes::Scale;
use crate::output::chart::{Chart, Mark, Shape};
use crate::output::sheet::{Key, Sign};
use crate::output::svg::{CURVES, Stroke, color};
use crate::studies::ending::Verdict;
use crate::studies::statistics;

/// Number of records whose curves have looks and names of their own.
const NAMED: usize = CURVES.len();
/// Surviving cases are drawn left of this fraction of the width, and overturned cases at its end.
const SURVIVED: f64 = 0.94;

/// Draws the intensity against the peak rotation, relative to the critical one if that is known. Every record has a curve, also
/// when mirrored if mirrored cases count. Overturned cases are at the right end; an uncertain case is marked by the outcome of its own history.
#[must_use]
pub fn draw(figure: Figure, heading: &Heading, results: &SuiteFragility) -> String {
    let over_critical = over_critical(results);
    let survived = results.cases.iter().filter(|case| !goes_over(case));
    let least = if over_critical { 1.0 } else { 1e-3 };
    let largest = survived.filter_map(peak).fold(least, f64::max);
    let x = Scale::exactly(0.0, largest / SURVIVED, figure.ticks(8));
    let y = intensity_scale(heading, &results.levels, figure);
    let label = if over_critical {
        "peak / critical rotation; arrows: overturned"
    } else {
        "peak rotation (rad); arrows: overturned"
    };
    let y_axis = (intensity_label(results.measure), y);
    let mut chart = Chart::new(480.0, (label, x), y_axis);
    if over_critical {
        chart
            .marks
            .push(Mark::upright("critical", CRITICAL, 1.0, y));
    }
    let records = records(results);
    let are_named = records.len() <= NAMED;
    for (cases, named) in records.iter().zip(CURVES.into_iter().cycle()) {
        let stroke = if are_named { named } else { MANY };
        let mirrored = if cases[0].mirrored { " mirrored" } else { "" };
        let name = format!("{}{mirrored}", cases[0].record);
        if are_named {
            chart.keys.push(Key::line(&name, stroke));
        }
        chart.marks.extend(of_record(&name, stroke, cases, results));
    }
    if !are_named {
        let both = if results.mirrored_count {
            ", also mirrored"
        } else {
            ""
        };
        let count = results.record_count();
        let all = format!("a curve for each of {count} records{both}");
        chart.keys.push(Key::line(all, MANY));
    }
    if results.has_uncertain() {
        let sign = Sign::Circle(4.0, UNCERTAIN);
        chart
            .keys
            .push(Key::new("uncertain whether it overturns", sign));
    }
    let levels = fractiles(results);
    let fractiles = FRACTILES.into_iter().enumerate();
    let fractiles = fractiles.map(|(fractile, (name, stroke))| {
        let known = levels.iter();
        let points = known.filter_map(|level| Some((level.peaks[fractile]?, level.intensity)));
        Mark::curve(name, stroke, points)
    });
    let mut chart = chart.with_named(fractiles.collect());
    if over_critical {
        chart.keys.push(Key::line("critical rotation", CRITICAL));
    }
    chart.draw(figure, heading.title())
}

/// The curve of a record through the cases that it survives, and a mark for each case.
fn of_record(
    name: &str,
    stroke: Stroke,
    cases: &[&CaseRow],
    results: &SuiteFragility,
) -> Vec<Mark> {
    let level = |case: &CaseRow| case.level(results.measure);
    // Overturned cases are no points of the curve: it is interrupted there.
    let points = cases.iter().filter_map(|case| match goes_over(case) {
        true => Some((f64::NAN, level(case))),
        false => Some((peak(case)?, level(case))),
    });
    let mut marks = vec![Mark::curve(name, stroke, points)];
    let plain = Stroke::new(stroke.color, 1.0, "");
    for case in cases {
        let Some(verdict) = case.known_verdict() else {
            continue;
        };
        let is_certain = verdict != Verdict::Uncertain;
        let mark = |certain: &'static str| match is_certain {
            true => (certain, plain, 2.2),
            false => ("uncertain", UNCERTAIN, 4.0),
        };
        if goes_over(case) {
            let (name, look, _) = mark("overturned");
            marks.push(Mark::new(name, look, Shape::Beyond(level(case))));
        } else if let Some(peak) = peak(case) {
            let (name, look, radius_px) = mark("survived");
            let circle = Shape::Circle((peak, level(case)), radius_px);
            marks.push(Mark::new(name, look, circle));
        }
    }
    marks
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
    let peaks = peaks(results);
    let largest = peaks.last().map_or(1.0, |at| at.peak).max(1e-3);
    let x = Scale::exactly(0.0, 1.05 * largest, figure.ticks(8));
    let label = if over_critical(results) {
        "peak / critical rotation"
    } else {
        "peak rotation (rad)"
    };
    let rises = peaks.iter().map(|at| (at.peak, at.share));
    let y_axis = ("share with at most this peak", Scale::exactly(0.0, 1.0, 5));
    let words = "share of all records and levels; overturned cases are beyond";
    let chart = Chart {
        keys: vec![Key::line(words, PEAKS)],
        marks: vec![Mark::staircase("peaks", PEAKS, (x, 0.0), rises)],
        ..Chart::new(405.0, (label, x), y_axis)
    };
    chart.draw(figure, heading.title())
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
