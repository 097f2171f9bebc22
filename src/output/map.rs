//! The overturning map: its table, its boundaries, its picture.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write;

use nalgebra::Vector2;

use super::part::{self, Rows};
use super::svg::{Anchor, Axes, Drawing, Frame, Scale, Stroke, color};
use super::{OutputError, finite, verdict};
use crate::mechanics::four_link::arch::FourLinkError;
use crate::mechanics::four_link::limit::LimitError;
use crate::scenario::{Axis, Boundary, Cell, Cells, Quantity, Spacing};

/// Outcome of a cell whose arch cannot carry its own weight.
const CANNOT_STAND: &str = "cannot_stand";
/// Outcome of a cell whose arch is too thick for four links.
const NOT_FOUR_LINKS: &str = "not_four_links";

/// The row of a cell.
///
/// # Errors
/// When a value is not finite.
pub fn row(cells: &Cells<'_>, index: usize) -> Result<String, OutputError> {
    let fields = match cells.cell(index) {
        Cell::Shaken(ended) => verdict::fields(&ended)?,
        Cell::NoArch(FourLinkError::Limit(LimitError::CannotStand)) => verdict::none(CANNOT_STAND),
        Cell::NoArch(_) => verdict::none(NOT_FOUR_LINKS),
        Cell::Failed(_) => verdict::none(verdict::FAILED),
    };
    let [x, y] = cells.coordinates(index);
    Ok(format!("{x:?},{y:?},{}", fields.join(",")))
}

/// The outcome of a row.
#[must_use]
pub fn outcome(row: &str) -> &str {
    row.split(',').nth(2).unwrap_or_default()
}

/// How many rows have each outcome.
#[must_use]
pub fn counts(rows: &Rows) -> BTreeMap<&str, usize> {
    let mut counts = BTreeMap::new();
    for row in rows.values() {
        *counts.entry(outcome(row)).or_default() += 1;
    }
    counts
}

/// Writes the table, a row per cell: x varies slowly, y fast.
///
/// # Errors
/// When the system refuses.
pub fn write_table(writer: impl Write, cells: &Cells<'_>, rows: &Rows) -> Result<(), OutputError> {
    let axes = cells.axes().map(|axis| axis.quantity.name());
    part::write_table(writer, &[&axes[..], &verdict::COLUMNS].concat(), rows)
}

/// Writes the boundaries, a row per value of x.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_boundaries(
    writer: impl Write,
    cells: &Cells<'_>,
    boundaries: &[Boundary],
) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the boundary";
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record([
        cells.axes()[0].quantity.name(),
        "incipient_acceleration_g",
        "no_impact_amplitude_g",
    ])
    .map_err(OutputError::csv(WHAT))?;
    for boundary in boundaries {
        let Boundary {
            x,
            incipient_g,
            impact_free_g,
        } = *boundary;
        finite("of a boundary", &[x, incipient_g])?;
        finite("of a boundary", impact_free_g.as_slice())?;
        csv.serialize((x, incipient_g, impact_free_g))
            .map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// What a cell is coloured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kind {
    name: &'static str,
    label: &'static str,
    fill: &'static str,
}

const fn kind(name: &'static str, label: &'static str, fill: &'static str) -> Kind {
    Kind { name, label, fill }
}

/// In the order of the legend.
const KINDS: [Kind; 10] = [
    kind("never_moved", "never moves", "#e4e4e4"),
    kind("rest", "comes to rest", "#bcdcf0"),
    kind("still_rocking", "still rocking", "#6f8ba0"),
    kind("overturned-0", "overturns without impact", color::VERMILION),
    kind("overturned-1", "overturns after 1 impact", color::ORANGE),
    kind("overturned-2", "overturns after 2 impacts", "#f0e442"),
    kind("overturned-more", "overturns after more", color::PURPLE),
    kind(CANNOT_STAND, "cannot stand", "#ffffff"),
    kind(NOT_FOUR_LINKS, "not four links", "#c8bfae"),
    kind(verdict::FAILED, "failed", color::BLACK),
];

impl Kind {
    fn of(row: &str) -> Self {
        let impacts = row.split(',').nth(5).unwrap_or_default();
        let name = match (outcome(row), impacts) {
            ("overturned", "0") => "overturned-0",
            ("overturned", "1") => "overturned-1",
            ("overturned", "2") => "overturned-2",
            ("overturned", _) => "overturned-more",
            (outcome, _) => outcome,
        };
        let known = KINDS.into_iter().find(|kind| kind.name == name);
        known.unwrap_or(KINDS[KINDS.len() - 1])
    }
}

const fn label(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Duration => "pulse duration (s)",
        Quantity::Frequency => "pulse frequency (Hz)",
        Quantity::MeanRadius => "mean radius R (m)",
        Quantity::ThicknessRatio => "t / R",
        Quantity::Embrace => "embrace angle (deg)",
        Quantity::Restitution => "restitution coefficient r",
        Quantity::Amplitude => "pulse amplitude (g)",
    }
}

/// The scale of an axis and the edges of the cells along it, halfway between their values.
fn scale(axis: &Axis) -> (Scale, Vec<f64>) {
    let values = axis.sequence.values();
    let logarithmic =
        axis.sequence.spacing() == Spacing::Logarithmic && values.iter().all(|value| *value > 0.0);
    let to = |value: f64| if logarithmic { value.ln() } else { value };
    let from = |place: f64| if logarithmic { place.exp() } else { place };
    let places: Vec<_> = values.iter().map(|value| to(*value)).collect();
    let (first, last) = (places[0], places[places.len() - 1]);
    // A single value gets room of its own size.
    let [before, after] = match places[..] {
        [only] => [0.5 * only.abs().max(1e-9); 2],
        [first, second, ..] => [
            0.5 * (second - first),
            0.5 * (last - places[places.len() - 2]),
        ],
        [] => [0.0; 2],
    };
    let middles = places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let edges: Vec<_> = [first - before]
        .into_iter()
        .chain(middles)
        .chain([last + after])
        .map(from)
        .collect();
    let (low, high) = (edges[0], edges[edges.len() - 1]);
    // Half a cell beyond the ends there may be nothing that could be.
    let low = if values[0] >= 0.0 { low.max(0.0) } else { low };
    let high = match axis.quantity {
        Quantity::Embrace => high.min(180.0),
        Quantity::Restitution => high.min(1.0),
        _ => high,
    };
    let edges: Vec<_> = edges
        .into_iter()
        .map(|edge| edge.clamp(low, high))
        .collect();
    let scale = if logarithmic {
        Scale::logarithmic(low, high)
    } else {
        Scale::exactly(low, high, 8)
    };
    (scale, edges)
}

/// Draws the map. Boundaries are of maps whose y is the amplitude.
#[must_use]
pub fn draw(title: &str, cells: &Cells<'_>, rows: &Rows, boundaries: &[Boundary]) -> String {
    let mut drawing = Drawing::new(900.0, 720.0);
    drawing.title(title);
    let kinds: Vec<_> = rows.values().map(|row| Kind::of(row)).collect();
    let top = legend(&mut drawing, cells, &kinds, !boundaries.is_empty());
    let [(x, x_edges), (y, y_edges)] = cells.axes().map(scale);
    let axes = Axes {
        frame: Frame {
            left: LEFT,
            top,
            width: WIDTH,
            height: 660.0 - top,
        },
        x,
        y,
    };
    let high = cells.values()[1].len();
    for kind in KINDS {
        let mut path = String::new();
        for (column, kinds) in kinds.chunks(high).enumerate() {
            let mut bottom = 0;
            for run in kinds.chunk_by(|a, b| a == b) {
                let top = bottom + run.len();
                if run[0] == kind {
                    let low = axes.place(x_edges[column], y_edges[bottom]);
                    let high = axes.place(x_edges[column + 1], y_edges[top]);
                    let _ = write!(
                        path,
                        "M{:.2} {:.2}H{:.2}V{:.2}H{:.2}Z",
                        low.x, low.y, high.x, high.y, low.x
                    );
                }
                bottom = top;
            }
        }
        if !path.is_empty() {
            // The stroke closes the seams between cells.
            drawing.path(kind.name, &path, kind.fill, Stroke::new(kind.fill, 0.4, ""));
        }
    }
    let [x_label, y_label] = cells.axes().map(|axis| label(axis.quantity));
    axes.draw(&mut drawing, Some(x_label), y_label);
    let signs: Vec<f64> = [1.0, -1.0]
        .into_iter()
        .filter(|sign| cells.values()[1].iter().any(|value| sign * value > 0.0))
        .collect();
    drawing.within(&axes.frame, |drawing| {
        for sign in &signs {
            let mut curve = |name, stroke, value: fn(&Boundary) -> Option<f64>| {
                let points = boundaries.iter().filter_map(|boundary| {
                    let value = sign * value(boundary)?;
                    Some(axes.place(boundary.x, value))
                });
                drawing.curve(name, points, stroke);
            };
            curve("incipient", INCIPIENT, |b| Some(b.incipient_g));
            curve("no-impact", IMPACT_FREE, |b| b.impact_free_g);
        }
    });
    drawing.finish()
}

const INCIPIENT: Stroke = Stroke::new(color::BLUE, 2.0, "7 4");
const IMPACT_FREE: Stroke = Stroke::new(color::BLACK, 2.2, "");

const LEFT: f64 = 85.0;
const WIDTH: f64 = 790.0;

/// What the colours and lines mean, in as many rows as it takes; returns where these end.
fn legend(drawing: &mut Drawing, cells: &Cells<'_>, kinds: &[Kind], boundaries: bool) -> f64 {
    const ROW: f64 = 24.0;
    let (mut x, mut y) = (LEFT, 46.0);
    for kind in KINDS.into_iter().filter(|kind| kinds.contains(kind)) {
        #[expect(clippy::cast_precision_loss, reason = "the length of a label")]
        let advance = 46.0 + 6.6 * kind.label.len() as f64;
        if x + advance > LEFT + WIDTH {
            (x, y) = (LEFT, y + ROW);
        }
        let swatch = format!("M{x} {y}h22v14h-22z");
        let outline = Stroke::new(color::GREY, 0.8, "");
        drawing.path("", &swatch, kind.fill, outline);
        let at = Vector2::new(x + 28.0, y + 12.0);
        drawing.label(at, Anchor::Start, 0.0, kind.label);
        x += advance;
    }
    y += ROW;
    if boundaries {
        let incipient = if cells.moves_vertically() {
            "incipient acceleration, were there no vertical motion"
        } else {
            "incipient acceleration"
        };
        let entries = [
            (incipient, INCIPIENT),
            ("least amplitude that overturns without impact", IMPACT_FREE),
        ];
        drawing.legend(Vector2::new(LEFT, y + 10.0), 395.0, entries);
        y += ROW;
    }
    y + 6.0
}
