//! The picture of unscaled records: a mark for each by outcome, over two measures of intensity.

use super::{CaseRow, Heading, SuiteFragility};
use crate::output::page::{Spot, SpotKind};
use crate::output::{Chart, Figure, Key, Mark, Scale, Shape, Sign, Stroke, color};
use crate::studies::map::VELOCITY_RATIO_LABEL;
use crate::studies::page_cases::kind_of;

/// Mark of an outcome: radius and stroke of its circle. An overturned case is a dot.
const MARKS: [(SpotKind, f64, Stroke); 4] = [
    (SpotKind::Survives, 3.5, Stroke::new(color::BLUE, 1.4, "")),
    (
        SpotKind::Overturns,
        1.8,
        Stroke::new(color::VERMILION, 3.6, ""),
    ),
    (
        SpotKind::Uncertain,
        4.5,
        Stroke::new(SpotKind::Uncertain.fill(), 1.8, ""),
    ),
    (SpotKind::Unknown, 3.5, Stroke::new(color::GREY, 1.4, "2 2")),
];

/// Factor from the outermost marks to the ends of an axis.
const MARGIN: f64 = 1.1;

/// Draws the peak acceleration over the ratio of peak velocity and peak acceleration, the axes of a map of pulses. On a page every case has a mark of
/// its own.
pub(super) fn draw(
    figure: Figure,
    heading: &Heading,
    results: &SuiteFragility,
    spots: &[Spot],
) -> String {
    let gravity_m_s2 = heading.gravity_m_s2();
    let at = |case: &CaseRow| {
        let [velocity_m_s, ..] = case.intensities();
        let ratio_s = velocity_m_s.unwrap_or(0.0) / (case.peak_g * gravity_m_s2);
        (ratio_s, case.peak_g)
    };
    let all: Vec<(f64, f64)> = results.cases.iter().map(at).collect();
    // Measures of records spread over decades.
    let scale = |values: &mut dyn Iterator<Item = f64>| {
        let positive = values.filter(|value| *value > 0.0);
        let [low, high] = positive.fold([f64::INFINITY, 0.0], |[low, high], value| {
            [value.min(low), value.max(high)]
        });
        match low <= high {
            true => Scale::logarithmic(low / MARGIN, high * MARGIN),
            false => Scale::exactly(0.0, 1.0, figure.ticks(8)),
        }
    };
    let x_axis = (VELOCITY_RATIO_LABEL, scale(&mut all.iter().map(|at| at.0)));
    let y_axis = (
        "peak ground acceleration (g)",
        scale(&mut all.iter().map(|at| at.1)),
    );
    let mut chart = Chart::new(480.0, x_axis, y_axis);
    let marked = all.iter().zip(spots).map(|(at, spot)| spot.mark(*at));
    chart.marks.extend(marked);
    for (kind, radius_px, stroke) in MARKS.into_iter().filter(|_| spots.is_empty()) {
        let of_kind = results.cases.iter().zip(&all);
        let of_kind = of_kind.filter(|(case, at)| kind_of(case.verdict()) == kind && at.0 > 0.0);
        let circle = |(_, at): (&CaseRow, &(f64, f64))| {
            Mark::new(kind.name(), stroke, Shape::Circle(*at, radius_px))
        };
        let before = chart.marks.len();
        chart.marks.extend(of_kind.map(circle));
        let count = chart.marks.len() - before;
        let key = Key::new(
            format!("{}: {count}", kind.label()),
            Sign::Circle(radius_px, stroke),
        );
        chart.keys.extend((count > 0).then_some(key));
    }
    chart.draw(figure, heading.title())
}
