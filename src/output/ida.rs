//! Incremental dynamic analysis: how far each record drives the structure as it gets stronger.

use super::suite::{Heading, intensity_label, intensity_scale};
use super::svg::{Axes, CURVES, Drawing, Figure, Key, Scale, Sign, Stroke, color};
use crate::studies::suite::{CaseRow, SuiteFragility};

/// Records that get curves of their own looks and names.
const NAMED: usize = CURVES.len();
/// Where what overturns is drawn, in parts of the width.
const OVERTURNED: f64 = 1.0;
/// How far what survives may be drawn.
const SURVIVED: f64 = 0.94;

/// Draws the intensity against the peak rotation, over the critical one where that is known: a curve for every record as
/// it is, and at the right end what overturns.
#[must_use]
pub fn draw(figure: Figure, heading: &Heading, results: &SuiteFragility) -> String {
    let mut drawing = Drawing::new(figure);
    let mut top = drawing.title(heading.title());
    let records = records(results);
    let all = format!("a curve for each of {} records", records.len());
    let keys: Vec<Key<'_>> = if records.len() <= NAMED {
        let named = records.iter().zip(CURVES);
        named
            .map(|(cases, stroke)| (cases[0].record.as_str(), Sign::Line(stroke)))
            .collect()
    } else {
        vec![(all.as_str(), Sign::Line(MANY))]
    };
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
    let survived = results.cases.iter().filter(|case| !case.overturned());
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
    for (cases, stroke) in records.iter().zip(looks) {
        let place = |case: &&&CaseRow| {
            let x = if case.overturned() {
                overturned
            } else {
                peak(case)?
            };
            Some((
                axes.place(x, case.level(results.measure)),
                case.overturned(),
            ))
        };
        let places: Vec<_> = cases.iter().filter_map(|case| place(&case)).collect();
        let name = &cases[0].record;
        drawing.curve(name, places.iter().map(|(at, _)| *at), stroke);
        for (at, fell) in places {
            let mark = if fell { "overturned" } else { "survived" };
            drawing.circle(mark, at, 2.2, Stroke::new(stroke.color, 1.0, ""));
        }
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

const MANY: Stroke = Stroke::new(color::BLUE, 0.9, "");
const CRITICAL: Stroke = Stroke::new(color::BLACK, 1.0, "6 4");

/// The cases of each record as it is, weakest first.
fn records(results: &SuiteFragility) -> Vec<Vec<&CaseRow>> {
    let cases: Vec<&CaseRow> = results.cases.iter().filter(|case| !case.mirrored).collect();
    cases
        .chunk_by(|a, b| a.record == b.record)
        .map(<[_]>::to_vec)
        .collect()
}
