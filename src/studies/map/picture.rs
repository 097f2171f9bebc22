//! The picture of an overturning map.

use std::fmt::Write as _;

use super::told::{is_doubtful, outcome};
use super::{CellResult, CellRow, OverturningMap};
use crate::dynamics::history::Outcome;
use crate::output::caption::caption;
use crate::output::svg::{Axes, Drawing, Figure, Key, Scale, Sign, Stroke, color};
use crate::scenario::{Axis, Quantity, Spacing};
use crate::studies::kind::{self, Kind};
use crate::studies::results::Look;

/// The kind by which a cell is coloured.
pub(super) fn kind_of(result: &CellResult, look: Look) -> Kind {
    if let (true, CellResult::Ended(ending)) = (look.by_peak, result)
        && let (Outcome::Vibrates | Outcome::Rest | Outcome::StillRocking, Some(peak)) =
            (ending.outcome, ending.peak.over_critical())
    {
        return Kind::survived(peak);
    }
    let impacts = match result {
        CellResult::Ended(ending) => ending.impacts_of_all_hinges(),
        _ => None,
    };
    Kind::of(outcome(result), impacts)
}

pub(in crate::studies) fn label(axis: &Axis) -> &str {
    match axis.quantity {
        Quantity::Duration => "pulse duration (s)",
        Quantity::Frequency => "pulse frequency (Hz)",
        Quantity::MeanRadius => "mean radius R (m)",
        Quantity::ThicknessRatio => "t / R",
        Quantity::Embrace => "embrace angle (deg)",
        Quantity::Restitution => "restitution coefficient r",
        Quantity::Amplitude => "pulse amplitude (g)",
        Quantity::Scale => "factor on the record",
        Quantity::PeakG => "peak ground acceleration (g)",
        Quantity::Other => &axis.key,
    }
}

/// The scale of an axis and the edges of its cells, halfway between the values; the values are multiplied by `factor`.
fn scale(axis: &Axis, factor: f64, figure: Figure) -> (Scale, Vec<f64>) {
    let values: Vec<f64> = axis.sequence.values();
    let values: Vec<f64> = values.into_iter().map(|value| factor * value).collect();
    let logarithmic =
        axis.sequence.spacing() == Spacing::Logarithmic && values.iter().all(|value| *value > 0.0);
    let to = |value: f64| if logarithmic { value.ln() } else { value };
    let from = |place: f64| if logarithmic { place.exp() } else { place };
    let places: Vec<_> = values.iter().map(|value| to(*value)).collect();
    let (first, last) = (places[0], places[places.len() - 1]);
    // A single value gets a cell as wide as the value itself.
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
    // Half a cell beyond the ends there may be impossible values.
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
        Scale::exactly(low, high, figure.ticks(8))
    };
    (scale, edges)
}

/// Draws the map. Only maps whose y is the amplitude have boundaries.
#[must_use]
pub fn draw(title: &str, map: &OverturningMap<'_>, rows: &[CellRow], look: Look) -> String {
    drawn(title, map, rows, look).picture
}

/// The picture of a map, and the positions of its cells.
pub(in crate::studies) struct Drawn {
    pub(in crate::studies) picture: String,
    pub(in crate::studies) height_px: f64,
    /// Edges of the columns from the left, and of the rows from below.
    pub(in crate::studies) edges_px: [Vec<f64>; 2],
}

/// A map to be drawn, whatever fills its cells.
#[derive(Clone, Copy)]
pub(in crate::studies) struct Sheet<'s> {
    pub(in crate::studies) title: &'s str,
    pub(in crate::studies) map: &'s OverturningMap<'s>,
    pub(in crate::studies) look: Look,
}

impl Sheet<'_> {
    /// What axes are multiplied by.
    pub(in crate::studies) fn factors(&self) -> [f64; 2] {
        self.look.factors.unwrap_or([1.0; 2])
    }

    /// Fills the cells by their kinds, which are in the palette. `keys` are those of the legend, for the scale of y; `over` draws
    /// over the cells, whose edges it is given.
    pub(in crate::studies) fn draw<'k>(
        self,
        palette: &[Kind],
        kinds: &[Kind],
        keys: impl FnOnce(&Scale) -> Vec<Key<'k>>,
        over: impl FnOnce(&mut Drawing, &Axes, [&[f64]; 2]),
    ) -> Drawn {
        let Self { title, map, look } = self;
        let figure = look.figure;
        let mut drawing = Drawing::new(figure);
        let top = drawing.title(title);
        let top = drawing.subtitle(top, &caption(map.scenario(), &map.axes()));
        let factors = self.factors();
        let [x_axis, y_axis] = map.axes();
        let (x, x_edges) = scale(x_axis, factors[0], figure);
        let (y, y_edges) = scale(y_axis, factors[1], figure);
        let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys(&y)) + 8.0;
        let axes = Axes {
            frame: figure.plot(top, figure.height_px(560.0)),
            x,
            y,
        };
        let edges = [x_edges, y_edges];
        for kind in palette {
            let path = cells(&axes, &edges, kinds, *kind);
            if !path.is_empty() {
                // The stroke closes the seams between cells.
                drawing.path(kind.name, &path, kind.fill, Stroke::new(kind.fill, 0.4, ""));
            }
        }
        let [x_label, y_label] = match look.factors {
            Some(_) => ["p t_p", "a / A_L"],
            None => map.axes().map(label),
        };
        axes.draw(&mut drawing, Some(x_label), y_label);
        over(&mut drawing, &axes, [&edges[0], &edges[1]]);
        let height_px = axes.frame.top + axes.frame.height + 56.0;
        let [x_edges, y_edges] = edges;
        Drawn {
            picture: drawing.finish(height_px),
            height_px,
            edges_px: [
                x_edges
                    .iter()
                    .map(|x| axes.place(*x, axes.y.low).x)
                    .collect(),
                y_edges
                    .iter()
                    .map(|y| axes.place(axes.x.low, *y).y)
                    .collect(),
            ],
        }
    }
}

/// The path around the cells of a kind.
fn cells(axes: &Axes, [x_edges, y_edges]: &[Vec<f64>; 2], kinds: &[Kind], kind: Kind) -> String {
    let mut path = String::new();
    for (column, kinds) in kinds.chunks(y_edges.len() - 1).enumerate() {
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
    path
}

/// As [`draw`].
pub(super) fn drawn(title: &str, map: &OverturningMap<'_>, rows: &[CellRow], look: Look) -> Drawn {
    let kinds: Vec<_> = rows.iter().map(|row| kind_of(&row.result, look)).collect();
    let sheet = Sheet { title, map, look };
    sheet.draw(
        &Kind::ALL,
        &kinds,
        |_| legend(map, &kinds),
        |drawing, axes, edges| hatch(drawing, axes, edges, rows),
    )
}

/// Hatches the cells whose outcome depends on how they are computed.
fn hatch(drawing: &mut Drawing, axes: &Axes, edges: [&[f64]; 2], rows: &[CellRow]) {
    let [x_edges, y_edges] = edges;
    let mut path = String::new();
    for (index, _) in (0..).zip(rows).filter(|(_, row)| is_doubtful(row)) {
        let [column, line] = [index / (y_edges.len() - 1), index % (y_edges.len() - 1)];
        let low = axes.place(x_edges[column], y_edges[line]);
        let high = axes.place(x_edges[column + 1], y_edges[line + 1]);
        let _ = write!(
            path,
            "M{:.2} {:.2}L{:.2} {:.2}",
            low.x, low.y, high.x, high.y
        );
    }
    if !path.is_empty() {
        drawing.path("doubtful", &path, "none", DOUBTFUL);
    }
}

/// Light, as most cells: lines are drawn on cells, so the legend draws them on this.
const CELL: &str = "#ffffff";
const DOUBTFUL: Stroke = Stroke::new(color::BLACK, 1.2, "");
/// The legend of the colours, and of the hatching if cells are repeated.
fn legend(map: &OverturningMap<'_>, kinds: &[Kind]) -> Vec<Key<'static>> {
    let mut keys = kind::keys(kinds);
    if map.is_repeated() {
        let words = "another outcome in a repetition";
        keys.push((words, Sign::LineOn(CELL, "doubtful", DOUBTFUL)));
    }
    keys
}
