//! The overturning spectrum: its table and its picture.

use std::io::Write;

use nalgebra::Vector2;

use super::part::{self, Rows};
use super::svg::{Anchor, Axes, Drawing, Frame, Scale, Stroke, color};
use super::{OutputError, finite};
use crate::scenario::{Point, Points};

/// Names of the columns.
pub const COLUMNS: [&str; 9] = [
    "structure",
    "p_t",
    "duration_s",
    "no_impact_over_incipient",
    "least_over_incipient",
    "impacts_before_overturning",
    "overturning_sway",
    "still_rocking",
    "failed",
];

/// The row of a point.
///
/// # Errors
/// When a value is not finite.
pub fn row(points: &Points<'_>, index: usize) -> Result<String, OutputError> {
    const WHAT: &str = "of a point of the spectrum";
    let Point {
        structure,
        p_t,
        duration_s,
        no_impact_over_incipient,
        least,
        still_rocking,
        failures,
    } = points.point(index);
    finite(WHAT, &[p_t, duration_s])?;
    finite(WHAT, no_impact_over_incipient.as_slice())?;
    finite(WHAT, least.map(|one| one.over_incipient).as_slice())?;
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:?}"));
    let fields = [
        structure.to_owned(),
        format!("{p_t:?}"),
        format!("{duration_s:?}"),
        number(no_impact_over_incipient),
        number(least.map(|one| one.over_incipient)),
        least.map_or(String::new(), |one| one.impacts.to_string()),
        least.map_or(String::new(), |one| one.sway.name().to_owned()),
        still_rocking.to_string(),
        failures.len().to_string(),
    ];
    Ok(fields.join(","))
}

/// The number in a column of a row; `None` where there is none.
#[must_use]
pub fn number(row: &str, column: &str) -> Option<f64> {
    let place = COLUMNS.iter().position(|name| *name == column)?;
    row.split(',').nth(place)?.parse().ok()
}

/// Writes the table: structure by structure, sizes ascending.
///
/// # Errors
/// When the system refuses.
pub fn write_table(writer: impl Write, rows: &Rows) -> Result<(), OutputError> {
    part::write_table(writer, &COLUMNS, rows)
}

/// How a structure is drawn.
struct Look {
    name: &'static str,
    line: Stroke,
    point: Stroke,
}

const ARCH: Look = Look {
    name: "arch",
    line: Stroke::new(color::BLUE, 1.8, ""),
    point: Stroke::new(color::BLUE, 1.4, ""),
};

const COLUMN: Look = Look {
    name: "column",
    line: Stroke::new(color::VERMILION, 1.8, "7 3"),
    point: Stroke::new(color::VERMILION, 1.4, ""),
};

const RADIUS_PX: f64 = 3.0;

/// Draws the spectrum: what overturns without impact as curves, and where less does after impacts, as points.
#[must_use]
pub fn draw(title: &str, points: &Points<'_>, rows: &Rows) -> String {
    let mut drawing = Drawing::new(900.0, 660.0);
    drawing.title(title);
    let axes = Axes {
        frame: Frame {
            left: 85.0,
            top: 100.0,
            width: 790.0,
            height: 500.0,
        },
        x: scale(points.sizes()),
        y: scale(&heights(points, rows)),
    };
    axes.draw(
        &mut drawing,
        Some("size p t_p"),
        "peak acceleration / (g A_L)",
    );
    let rows: Vec<&str> = rows.values().map(String::as_str).collect();
    let size = points.sizes().len();
    let beside_arch = points.structures().len() > 1;
    for (index, ((name, _), rows)) in points
        .structures()
        .iter()
        .zip(rows.chunks(size))
        .enumerate()
    {
        let look = if *name == ARCH.name { ARCH } else { COLUMN };
        drawing.within(&axes.frame, |drawing| curves(drawing, &axes, &look, rows));
        let called = if beside_arch && look.name == COLUMN.name {
            "equivalent column"
        } else {
            look.name
        };
        #[expect(clippy::cast_precision_loss, reason = "one or two")]
        let y = 54.0 + 22.0 * index as f64;
        let text = format!("{called}, without impact");
        drawing.legend(Vector2::new(85.0, y), 0.0, [(text.as_str(), look.line)]);
        if rows.iter().any(|row| less(row).is_some()) {
            drawing.circle("", Vector2::new(415.0, y), RADIUS_PX, look.point);
            let text = format!("{called}, less after impacts (of those tried)");
            drawing.label(Vector2::new(430.0, y + 4.5), Anchor::Start, 0.0, &text);
        }
    }
    drawing.finish()
}

/// What overturns without impact.
fn edge(row: &str) -> Option<f64> {
    number(row, "no_impact_over_incipient")
}

/// What overturns after impacts, and is less than that.
fn less(row: &str) -> Option<f64> {
    number(row, "least_over_incipient").filter(|least| edge(row).is_none_or(|edge| *least < edge))
}

/// Peak accelerations to be drawn, ascending: from the least tried to the largest result, unless that is beyond all
/// that were tried and beyond the half as much again of the least result.
fn heights(points: &Points<'_>, rows: &Rows) -> Vec<f64> {
    let tried = points.over_incipient();
    let last = tried[tried.len() - 1];
    let results = rows.values().flat_map(|row| [edge(row), less(row)]);
    let results: Vec<f64> = results.flatten().collect();
    let least = results.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = last.max(1.5 * least);
    let mut heights: Vec<f64> = results
        .into_iter()
        .map(|height| height.min(highest))
        .chain([tried[0]])
        .collect();
    heights.sort_by(f64::total_cmp);
    heights
}

fn curves(drawing: &mut Drawing, axes: &Axes, look: &Look, rows: &[&str]) {
    // Where there is no value the curve breaks.
    for run in rows.chunk_by(|a, b| edge(a).is_some() == edge(b).is_some()) {
        let places: Vec<_> = run
            .iter()
            .filter_map(|row| Some(axes.place(number(row, "p_t")?, edge(row)?)))
            .collect();
        // A single point is no curve.
        let name = format!("{} no-impact", look.name);
        if let [only] = places[..] {
            let reach = Vector2::new(6.0, 0.0);
            drawing.curve(&name, [only - reach, only + reach], look.line);
        } else {
            drawing.curve(&name, places, look.line);
        }
    }
    for row in rows {
        if let (Some(p_t), Some(least)) = (number(row, "p_t"), less(row)) {
            let name = format!("{} least", look.name);
            drawing.circle(&name, axes.place(p_t, least), RADIUS_PX, look.point);
        }
    }
}

/// The logarithmic scale that holds ascending positive values; a single one gets room.
fn scale(values: &[f64]) -> Scale {
    let (low, high) = (values[0], values[values.len() - 1]);
    if high > 1.01 * low {
        Scale::logarithmic(low, high)
    } else {
        Scale::logarithmic(0.5 * low, 2.0 * high)
    }
}
