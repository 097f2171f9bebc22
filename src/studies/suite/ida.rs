//! Incremental dynamic analysis: the response to each record as it gets stronger.

use super::picture::{intensity_label, intensity_scale};
use super::told::Heading;
use super::{CaseRow, SuiteFragility};
use crate::dynamics::history::Outcome;
use crate::output::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign, Stroke, color};
use crate::studies::ending::Verdict;

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
    top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let over_critical = results
        .cases
        .iter()
        .filter_map(|case| case.result.as_ref().ok())
        .all(|ending| ending.peak.over_critical().is_some());
    let peak = |case: &CaseRow| {
        let peak = case.result.as_ref().ok()?.peak;
        peak.over_critical().or(peak.rad())
    };
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
        "peak / critical rotation; right end: overturned"
    } else {
        "peak rotation (rad); right end: overturned"
    };
    axes.draw(&mut drawing, Some(label), intensity_label(results.measure));
    if over_critical {
        let [low, high] = [axes.y.low, axes.y.high].map(|y| axes.place(1.0, y));
        drawing.line(low, high, CRITICAL);
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
        let place = |case: &&&CaseRow| {
            let x = if goes_over(case) {
                overturned
            } else {
                peak(case)?
            };
            let at = axes.place(x, case.level(results.measure));
            Some((at, case.verdict()?))
        };
        let places: Vec<_> = cases.iter().filter_map(|case| place(&case)).collect();
        drawing.curve(name, places.iter().map(|(at, _)| *at), stroke);
        for (at, verdict) in places {
            let plain = Stroke::new(stroke.color, 1.0, "");
            let (mark, radius, look) = match verdict {
                Verdict::Overturns => ("overturned", 2.2, plain),
                Verdict::Survives => ("survived", 2.2, plain),
                Verdict::Uncertain => ("uncertain", 4.0, UNCERTAIN),
            };
            drawing.circle(mark, at, radius, look);
        }
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

const MANY: Stroke = Stroke::new(color::BLUE, 0.9, "");
const CRITICAL: Stroke = Stroke::new(color::BLACK, 1.0, "6 4");
const UNCERTAIN: Stroke = Stroke::new(color::GREEN, 1.6, "");

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
