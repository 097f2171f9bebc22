//! Incremental dynamic analysis: the response to each record at increasing intensity.

use super::fragility::group_by_intensity;
use super::{CaseRow, Heading, SuiteFragility};
use crate::output::page::{Spot, SpotKind};
use crate::output::{CURVES, Chart, Figure, Key, Mark, Scale, Shape, Sign, Stroke, color};
use crate::studies::ending::Ending;
use crate::studies::ending::columns::are_over_critical;
use crate::studies::statistics::{ascending, fractile, shares_up_to};

/// Largest number of records whose curves have their own stroke and name.
const NAMED: usize = CURVES.len();
/// Surviving cases are drawn left of this fraction of the width. Overturned cases are drawn at the right end.
const SURVIVED: f64 = 0.94;

/// Draws the intensity against the peak rotation, relative to the critical rotation if that is known. Every record has a curve, and a second one
/// for the mirrored record. Overturned cases are at the right end; the position of an uncertain case shows the outcome
/// of its own history. On a page every case has a mark.
pub fn draw(figure: Figure, heading: &Heading, results: &SuiteFragility, spots: &[Spot]) -> String {
    let over_critical = are_over_critical(results.cases.iter().map(|case| &case.result));
    let endings = results.cases.iter().filter_map(CaseRow::complete_ending);
    let survived = endings.filter(|ending| !ending.overturned_itself());
    let least = if over_critical { 1.0 } else { 1e-3 };
    let largest = survived.map(peak).fold(least, f64::max);
    let x = Scale::exactly(0.0, largest / SURVIVED, figure.ticks(8));
    let (y_label, y) = heading.axis(results, figure);
    // Marks of a page cover the arrows.
    let sign = if spots.is_empty() {
        "arrows"
    } else {
        "crosses"
    };
    let label = format!("{}; {sign}: overturned", peak_in_words(over_critical));
    let mut chart = Chart::new(480.0, (&label, x), (y_label, y));
    let critical = Mark::upright("critical", CRITICAL, 1.0, y);
    chart.marks.extend(over_critical.then_some(critical));
    let records: Vec<&[CaseRow]> = results.cases_by_record().collect();
    let are_named = records.len() <= NAMED;
    for (cases, named) in records.iter().zip(CURVES.into_iter().cycle()) {
        let stroke = if are_named { named } else { MANY };
        let name = cases[0].record_in_words();
        if are_named {
            chart.keys.push(Key::line(&name, stroke));
        }
        chart
            .marks
            .extend(draw_record(&name, stroke, cases, results));
    }
    if !are_named {
        let both = match results.has_both_signs() {
            true => ", also mirrored",
            false => "",
        };
        let count = results.record_count();
        let all = format!("a curve for each of {count} records{both}");
        chart.keys.push(Key::line(all, MANY));
    }
    let circle = Sign::Circle(4.0, UNCERTAIN);
    let uncertain = Key::new("uncertain whether it overturns", circle);
    chart
        .keys
        .extend(results.has_uncertain().then_some(uncertain));
    let levels = fractiles(results);
    let fractiles = FRACTILES
        .into_iter()
        .enumerate()
        .map(|(which, (_, name, stroke))| {
            let known = levels.iter();
            let points = known.filter_map(|level| Some((level.peaks[which]?, level.intensity)));
            Mark::curve(name, stroke, points)
        });
    let mut chart = chart.with_named(fractiles.collect());
    if over_critical {
        chart.keys.push(Key::line("critical rotation", CRITICAL));
    }
    chart
        .marks
        .extend(results.cases.iter().zip(spots).map(|(case, spot)| {
            let peak = peak_or_infinity(case).unwrap_or(0.0);
            spot.mark((peak, case.level(results.measure)))
        }));
    chart.draw(figure, heading.title())
}

/// Draws the curve of a record through its surviving cases, and a mark for each case.
fn draw_record(
    name: &str,
    stroke: Stroke,
    cases: &[CaseRow],
    results: &SuiteFragility,
) -> Vec<Mark> {
    let level = |case: &CaseRow| case.level(results.measure);
    // Overturned cases interrupt the curve.
    let points = cases
        .iter()
        .filter_map(|case| Some((peak_or_infinity(case)?, level(case))));
    let mut marks = vec![Mark::curve(name, stroke, points)];
    let plain = Stroke::new(stroke.color, 1.0, "");
    for case in cases {
        let Some(ending) = case.complete_ending() else {
            continue;
        };
        let is_certain = ending.doubt().is_none();
        let mark = |certain: &'static str| match is_certain {
            true => (certain, plain, 2.2),
            false => ("uncertain", UNCERTAIN, 4.0),
        };
        if ending.overturned_itself() {
            let (name, stroke, _) = mark("overturned");
            marks.push(Mark::new(name, stroke, Shape::Beyond(level(case))));
        } else {
            let (name, stroke, radius_px) = mark("survived");
            let circle = Shape::Circle((peak(ending), level(case)), radius_px);
            marks.push(Mark::new(name, stroke, circle));
        }
    }
    marks
}

const MANY: Stroke = Stroke::new(color::GREY, 0.9, "");
/// Fractiles of the peaks at each level over all records: part, name and stroke.
const FRACTILES: [(f64, &str, Stroke); 3] = [
    (0.16, "16 %", Stroke::new(color::BLACK, 1.8, "2 3")),
    (0.5, "median", Stroke::new(color::BLACK, 2.6, "")),
    (0.84, "84 %", Stroke::new(color::BLACK, 1.8, "8 4")),
];

/// The distribution of the peaks at a level, over all records that count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fractiles {
    /// The level.
    pub intensity: f64,
    /// Number of cases with a history.
    pub cases: usize,
    /// Number of overturned cases.
    pub overturned: usize,
    /// The 16 % fractile, the median and the 84 % fractile of the peaks, over the critical rotation if that is known, otherwise in rad. `None`
    /// for a fractile among overturned cases.
    pub peaks: [Option<f64>; 3],
}

/// Peak of a history over the critical rotation, or of a row of blocks in radians.
fn peak(ending: &Ending) -> f64 {
    let of_row = ending.peak_rotation_rad;
    ending.peak_over_critical.unwrap_or(of_row)
}

/// Computes the fractiles of the peaks at each level (Vamvatsikos and Cornell, Earthquake Engineering and Structural Dynamics 31, 2002).
pub fn fractiles(results: &SuiteFragility) -> Vec<Fractiles> {
    let levels = group_by_intensity(results.cases.iter().collect(), |case: &CaseRow| {
        case.level(results.measure)
    })
    .into_iter();
    levels
        .map(|(intensity, cases)| {
            let peaks = ascending(cases.into_iter().filter_map(peak_or_infinity));
            let finite = |peak: &f64| peak.is_finite();
            Fractiles {
                intensity,
                cases: peaks.len(),
                overturned: peaks.iter().filter(|peak| peak.is_infinite()).count(),
                peaks: FRACTILES.map(|(part, ..)| fractile(&peaks, part).filter(finite)),
            }
        })
        .collect()
}
/// Grey, because dashed black lines are fractiles.
const CRITICAL: Stroke = Stroke::new(color::GREY, 1.4, "6 4");
const UNCERTAIN: Stroke = Stroke::new(SpotKind::Uncertain.fill(), 1.6, "");

/// Largest rotation of each case, in radians, infinite if the case overturned; `None` without a complete history.
pub(super) fn rotations_rad(cases: &[CaseRow]) -> Vec<Option<f64>> {
    let endings = cases.iter().map(CaseRow::complete_ending);
    endings
        .map(|ending| ending.map(Ending::peak_or_infinite_rad))
        .collect()
}

/// Distribution of the peaks of all cases: ascending finite peaks, as in [`Fractiles`], each with the share of cases up
/// to the peak. The last share is below 1 if cases overturned.
pub fn peaks(results: &SuiteFragility) -> Vec<(f64, f64)> {
    let peaks = results.cases.iter().filter_map(peak_or_infinity);
    shares_up_to(peaks.map(|peak| [peak, 1.0]))
}

/// Peak of a case with a complete history, infinite if the case overturned.
fn peak_or_infinity(case: &CaseRow) -> Option<f64> {
    let ending = case.complete_ending()?;
    match ending.overturned_itself() {
        true => Some(f64::INFINITY),
        false => Some(peak(ending)),
    }
}

/// Draws the distribution of the peaks.
pub fn draw_peaks(figure: Figure, heading: &Heading, results: &SuiteFragility) -> String {
    let peaks = peaks(results);
    let largest = peaks.last().map_or(1.0, |(peak, _)| *peak).max(1e-3);
    let x = Scale::exactly(0.0, 1.05 * largest, figure.ticks(8));
    let label = peak_in_words(are_over_critical(
        results.cases.iter().map(|case| &case.result),
    ));
    let y_axis = ("share with at most this peak", Scale::exactly(0.0, 1.0, 5));
    let words = "share of all cases (records at all levels); overturned cases count as infinite";
    let chart = Chart {
        keys: vec![Key::line(words, PEAKS)],
        marks: vec![Mark::staircase("peaks", PEAKS, (x, 0.0), peaks)],
        ..Chart::new(405.0, (label, x), y_axis)
    };
    chart.draw(figure, heading.title())
}

const PEAKS: Stroke = Stroke::new(color::BLUE, 2.0, "");

const fn peak_in_words(over_critical: bool) -> &'static str {
    match over_critical {
        true => "peak / critical rotation",
        false => "peak rotation (rad)",
    }
}
