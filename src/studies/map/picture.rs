//! The picture of an overturning map.

use super::{CellRow, OverturningMap, label};
use crate::Outcome;
use crate::output::caption::caption;
use crate::output::{
    Axes, Chart, Figure, Key, LEFT_PX, Mark, Scale, Shape, Sheet, Sign, Stroke, color,
};
use crate::scenario::{Axis, Quantity};
use crate::studies::outcome_colors::{self, OutcomeColor};
use crate::studies::results::Style;

/// The cells of a map by colour, for any kinds of cells.
pub(crate) struct ColoredCells {
    /// All colours, in the order of the legend.
    pub(crate) palette: &'static [OutcomeColor],
    /// The colour of each cell.
    pub(crate) colors: Vec<OutcomeColor>,
    /// True for cells outside the model of four links.
    pub(crate) outside: Vec<bool>,
    /// True for cells with the numbers of the mirrored ground motion.
    pub(crate) mirrored: Vec<bool>,
}

impl ColoredCells {
    /// Makes the cells of a map of outcomes.
    pub(super) fn of_outcomes(rows: &[CellRow], style: Style) -> Self {
        Self {
            palette: &OutcomeColor::ALL,
            colors: rows.iter().map(|row| color_of(row, style)).collect(),
            outside: rows.iter().map(CellRow::is_outside_model).collect(),
            mirrored: rows.iter().map(CellRow::is_mirrored).collect(),
        }
    }
}

/// Colour of a cell.
fn color_of(cell: &CellRow, style: Style) -> OutcomeColor {
    if let (true, Ok(ending)) = (style.by_peak, &cell.result)
        && let (Outcome::Vibrates | Outcome::Rest | Outcome::StillRocking, Some(peak)) =
            (ending.outcome, ending.peak_over_critical)
    {
        return OutcomeColor::survived(peak);
    }
    OutcomeColor::of_result(&cell.result)
}

/// True for an axis of negative values.
fn is_negative(axis: &Axis) -> bool {
    axis.sequence.values().iter().all(|value| *value < 0.0)
}

/// Scale of an axis, and the edges of its cells halfway between the values. The values are multiplied by `factor`.
fn scale(axis: &Axis, factor: f64, figure: Figure) -> (Scale, Vec<f64>) {
    let values: Vec<f64> = axis.sequence.values();
    let values: Vec<f64> = values.into_iter().map(|value| factor * value).collect();
    let logarithmic = axis.sequence.is_logarithmic(&values);
    let to = |value: f64| if logarithmic { libm::log(value) } else { value };
    let from = |place: f64| if logarithmic { libm::exp(place) } else { place };
    let places: Vec<_> = values.iter().map(|value| to(*value)).collect();
    let (first, last) = (places[0], places[places.len() - 1]);
    // A single value has a cell as wide as the value itself.
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
    // Negative values are drawn as positive ones, which then descend.
    let ends = [edges[0], edges[edges.len() - 1]];
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    // Half a cell beyond the ends may contain invalid values.
    let low = if values.iter().all(|value| *value >= 0.0) {
        low.max(0.0)
    } else {
        low
    };
    let high = match axis.quantity {
        Quantity::Embrace => high.min(180.0),
        Quantity::Restitution => high.min(1.0),
        _ => high,
    };
    let edges = edges.into_iter().map(|edge| edge.clamp(low, high));
    let scale = if logarithmic {
        Scale::logarithmic(low, high)
    } else {
        Scale::exactly(low, high, figure.ticks(8))
    };
    (scale, edges.collect())
}

/// The picture of a map, and the positions of its cells.
pub(crate) struct Drawn {
    pub(crate) picture: String,
    pub(crate) height_px: f64,
    /// Edges of the columns from left to right, and of the rows from bottom to top, in pixels.
    pub(crate) edges_px: [Vec<f64>; 2],
}

/// The chart of a map, for any kinds of cells.
pub(crate) struct MapChart<'s> {
    title: &'s str,
    map: &'s OverturningMap<'s>,
    style: Style,
    /// The values of the axes are drawn times these factors. Negative values become positive, so that the strongest pulse is on top.
    factors: [f64; 2],
    scales: [Scale; 2],
    /// Edges of the columns and of the rows, in the units of the axes.
    edges: [Vec<f64>; 2],
}

impl<'s> MapChart<'s> {
    /// Makes the chart of a map, without cells.
    pub(crate) fn new(title: &'s str, map: &'s OverturningMap<'s>, style: Style) -> Self {
        let factors = style.factors.unwrap_or([1.0; 2]);
        let factors = [0, 1].map(|i: usize| match is_negative(map.axes[i]) {
            true => -factors[i],
            false => factors[i],
        });
        let [x, y] = [0, 1].map(|i: usize| scale(map.axes[i], factors[i], style.figure));
        Self {
            title,
            map,
            style,
            factors,
            scales: [x.0, y.0],
            edges: [x.1, y.1],
        }
    }

    /// Point of the map in the units of the axes, which may be dimensionless.
    pub(crate) fn point(&self, x: f64, y: f64) -> (f64, f64) {
        (self.factors[0] * x, self.factors[1] * y)
    }

    /// Diagonal in each chosen cell; `ends` are 0 at its lower edge and 1 at its upper edge.
    fn hatch(&self, name: &'static str, line: Stroke, ends: [usize; 2], cells: &[bool]) -> Mark {
        let [x_edges, y_edges] = &self.edges;
        let count = y_edges.len() - 1;
        let chosen = (0..).zip(cells).filter(|(_, chosen)| **chosen);
        let diagonals = chosen.flat_map(|(index, _): (usize, _)| {
            let [column, row] = [index / count, index % count];
            let [one, other] = [y_edges[row], y_edges[row + 1]];
            let y = [one.min(other), one.max(other)];
            let at = |side: usize| (x_edges[column + side], y[ends[side]]);
            [at(0), at(1), (f64::NAN, f64::NAN)]
        });
        Mark::curve(name, line, diagonals)
    }

    /// Fills the cells with their colours, which the palette must contain, hatches cells outside the model of four links, and draws marks over them.
    /// The legend has the colours, then these keys.
    pub(crate) fn draw(
        self,
        cells: &ColoredCells,
        mut keys: Vec<Key>,
        mut marks: Vec<Mark>,
    ) -> Drawn {
        let ColoredCells {
            palette,
            colors,
            outside,
            ..
        } = cells;
        if outside.contains(&true) {
            let name = "outside-model";
            let sign = Sign::Hatched(CELL, name, OUTSIDE, false);
            keys.push(Key::new("outside the model of four links", sign));
            marks.insert(0, self.hatch(name, OUTSIDE, [1, 0], outside));
        }
        let Self {
            title,
            map,
            style,
            scales: [x, y],
            ref edges,
            ..
        } = self;
        let figure = style.figure;
        let [x_label, y_label] = match style.factors {
            Some(_) => ["p t_p", "a / A_L"],
            None => map.axes.map(label),
        };
        let [x_label, y_label] = [(x_label, 0), (y_label, 1)].map(|(label, i): (&str, usize)| {
            let sign = if is_negative(map.axes[i]) {
                "minus "
            } else {
                ""
            };
            format!("{sign}{label}")
        });
        let mut chart = Chart::new(560.0, (&x_label, x), (&y_label, y));
        // The stroke closes gaps between cells.
        let fills = palette.iter().map(|color| {
            let cells = runs(edges, colors).filter(|(own, _)| own == color);
            let boxes = Shape::Boxes(cells.map(|(_, corners)| corners).collect());
            Mark::new(color.name, Stroke::new(color.fill, 0.4, ""), boxes)
        });
        chart.below = fills.collect();
        chart.keys = [outcome_colors::keys(palette, colors), keys].concat();
        chart.marks = marks;
        let mut sheet = Sheet::new(figure, title);
        if figure.has_title {
            sheet.caption(11.0, &caption(map.scenario, &map.axes));
        }
        let plot = chart.add_to(&mut sheet);
        let drawn = sheet.drawn();
        let axes = Axes {
            frame: figure.right_of(LEFT_PX, drawn.frames[plot]),
            x,
            y,
        };
        let [columns, rows] = edges.each_ref().map(|edges| edges.iter());
        Drawn {
            picture: drawn.svg,
            height_px: drawn.height_px,
            edges_px: [
                columns.map(|edge| axes.place(*edge, y.low).x).collect(),
                rows.map(|edge| axes.place(x.low, *edge).y).collect(),
            ],
        }
    }
}

/// Runs of equal cells in each column: their colour and two opposite corners.
fn runs<'c>(
    [x_edges, y_edges]: &'c [Vec<f64>; 2],
    colors: &'c [OutcomeColor],
) -> impl Iterator<Item = (OutcomeColor, [(f64, f64); 2])> + 'c {
    let columns = colors.chunks(y_edges.len() - 1).zip(x_edges.windows(2));
    columns.flat_map(move |(colors, x)| {
        let mut bottom = 0;
        colors.chunk_by(|a, b| a == b).map(move |run| {
            let low = (x[0], y_edges[bottom]);
            bottom += run.len();
            (run[0], [low, (x[1], y_edges[bottom])])
        })
    })
}

/// Draws a map.
pub fn draw(title: &str, map: &OverturningMap<'_>, rows: &[CellRow], style: Style) -> String {
    let cells = ColoredCells::of_outcomes(rows, style);
    draw_cells(title, map, rows, &cells, style).picture
}

/// Picture of a map, with the positions of its cells.
pub(super) fn draw_cells(
    title: &str,
    map: &OverturningMap<'_>,
    rows: &[CellRow],
    cells: &ColoredCells,
    style: Style,
) -> Drawn {
    let chart = MapChart::new(title, map, style);
    let sign = Sign::Hatched(CELL, "doubtful", DOUBTFUL, true);
    let key = Key::new("another outcome in a repetition", sign);
    let keys = map.repeat.then_some(key).into_iter().collect();
    let doubtful: Vec<bool> = rows.iter().map(CellRow::is_doubtful).collect();
    let hatch = chart.hatch("doubtful", DOUBTFUL, [0, 1], &doubtful);
    chart.draw(cells, keys, vec![hatch])
}

/// Background of hatching in the legend: light, as most cells.
const CELL: &str = "#ffffff";
const DOUBTFUL: Stroke = Stroke::new(color::BLACK, 1.2, "");
const OUTSIDE: Stroke = Stroke::new(color::BLACK, 0.8, "");
