//! The overturning map: its table, its boundaries, its picture.

use std::fmt::Write as _;
use std::io::Write;

use super::caption::caption;
use super::ending::{self, Remark, Remarks};
use super::kind::{self, CANNOT_STAND, Kind, NOT_FOUR_LINKS};
use super::rotations::Scales;
use super::svg::{Axes, Drawing, Figure, Key, Scale, Sign, Stroke, color};
use super::table::table;
use super::{OutputError, finite};
use crate::dynamics::history::Outcome;
use crate::scenario::{Axis, Quantity, Scenario, Spacing};
use crate::studies::boundary::{Boundary, BoundaryRow};
use crate::studies::map::{CellResult, CellRow, OverturningMap};

/// The outcome of a cell, as it stands in the table.
#[must_use]
pub const fn outcome(result: &CellResult) -> &'static str {
    match result {
        CellResult::Ended(ending) => ending::outcome(ending),
        CellResult::CannotStand => CANNOT_STAND,
        CellResult::NotFourLinks => NOT_FOUR_LINKS,
        CellResult::Failed(_) => ending::FAILED,
    }
}

/// The number of outcomes of a cell with its repetitions, as it stands in the table.
const SPREAD: &str = "spread";

/// How many cells have an outcome that depends on how they are computed.
#[must_use]
pub fn doubtful(rows: &[CellRow]) -> usize {
    rows.iter().filter(|row| is_doubtful(row)).count()
}

fn is_doubtful(row: &CellRow) -> bool {
    matches!(row.spread, Some(Ok(2..)))
}

/// What is to be remarked of the cells: which failed, and of which a repetition or a boundary did; which are uncertain.
#[must_use]
pub fn remarks(map: &OverturningMap<'_>, cells: &[CellRow], boundaries: &[BoundaryRow]) -> Remarks {
    let [x_name, y_name] = map.axes().map(|axis| axis.key.as_str());
    let mut remarks = Remarks::default();
    for cell in cells {
        let case = || format!("{x_name} {:?}, {y_name} {:?}", cell.x, cell.y);
        match &cell.result {
            CellResult::Ended(ending) => remarks.note(case, Ok(ending)),
            CellResult::Failed(reason) => remarks.note(case, Err(reason)),
            CellResult::CannotStand | CellResult::NotFourLinks => {}
        }
        if let Some(Err(reason)) = &cell.spread {
            remarks.failures.push(Remark::new(case(), reason));
        }
    }
    for row in boundaries {
        if let Err(reason) = &row.result {
            let case = format!("boundary without impact at {x_name} {:?}", row.x);
            remarks.failures.push(Remark::new(case, reason));
        }
    }
    remarks
}

/// Writes the table, a row per cell: x varies slowly, y fast.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_table(
    writer: impl Write,
    map: &OverturningMap<'_>,
    rows: &[CellRow],
) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the table";
    let mut csv = table(writer);
    let axes = map.axes().map(|axis| axis.key.as_str());
    let free_hinges = map.has_free_hinges();
    let columns = ending::columns(free_hinges).map(|column| -> &str { column });
    let columns = axes.into_iter().chain(columns);
    csv.write_record(columns.chain(map.has_spread().then_some(SPREAD)))
        .map_err(OutputError::csv(WHAT))?;
    for row in rows {
        finite("of a cell", &[row.x, row.y])?;
        let mut fields = [row.x, row.y].map(ending::number).to_vec();
        fields.extend(match &row.result {
            CellResult::Ended(ended) => ending::fields(ended)?,
            other => ending::none(outcome(other), free_hinges),
        });
        if map.has_spread() {
            fields.push(match &row.spread {
                None => String::new(),
                Some(Ok(count)) => count.to_string(),
                Some(Err(_)) => ending::FAILED.to_owned(),
            });
        }
        csv.write_record(fields).map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// Writes the boundaries that were found, a row per value of x.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_boundaries(
    writer: impl Write,
    x_axis: &Axis,
    boundaries: &[BoundaryRow],
) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the boundary";
    let mut csv = table(writer);
    csv.write_record([
        x_axis.key.as_str(),
        "incipient_acceleration_g",
        "no_impact_amplitude_g",
    ])
    .map_err(OutputError::csv(WHAT))?;
    for (x, boundary) in found(boundaries) {
        let Boundary {
            incipient_g,
            impact_free_g,
        } = boundary;
        finite("of a boundary", &[x, incipient_g])?;
        finite("of a boundary", impact_free_g.as_slice())?;
        csv.serialize((x, incipient_g, impact_free_g))
            .map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// The boundaries that there are, with their x.
fn found(boundaries: &[BoundaryRow]) -> impl Iterator<Item = (f64, Boundary)> {
    let rows = boundaries.iter();
    rows.filter_map(|row| Some((row.x, row.result.as_ref().ok().copied()??)))
}

/// How a map is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Its width, and the size of its text.
    pub figure: Figure,
    /// Whether what survives is coloured by its largest rotation over the critical one, where that is known.
    pub by_peak: bool,
    /// What the axes, pulse duration and amplitude, are multiplied by to have no dimension; `None`: as they are.
    pub factors: Option<[f64; 2]>,
}

impl Look {
    /// A map coloured by outcome, its axes as they are.
    #[must_use]
    pub const fn of(figure: Figure) -> Self {
        Self {
            figure,
            by_peak: false,
            factors: None,
        }
    }

    /// The factors that make p t_p of durations, and a / A_L of amplitudes.
    ///
    /// # Errors
    /// Says what a map needs for that.
    pub fn dimensionless(scenario: &Scenario) -> Result<[f64; 2], &'static str> {
        let map = scenario.map.as_ref().ok_or("there is no map")?;
        if (map.x.quantity, map.y.quantity) != (Quantity::Duration, Quantity::Amplitude) {
            return Err("needs the axes `duration_s` and `amplitude_g`");
        }
        if scenario.free_hinges.is_some() {
            return Err("goes with four links and columns: free hinges have no p");
        }
        let model = scenario.structure.model(scenario.impact);
        let scales = model
            .ok()
            .and_then(|model| Scales::new(&*model, scenario.simulation.gravity_m_s2))
            .ok_or("needs a mechanism that has an unstable equilibrium")?;
        let gravity_m_s2 = scenario.simulation.gravity_m_s2;
        Ok([scales.frequency_rad_s, gravity_m_s2 / scales.incipient_m_s2])
    }
}

/// What a cell is coloured by.
pub(super) fn kind_of(result: &CellResult, look: Look) -> Kind {
    if let (true, CellResult::Ended(ending)) = (look.by_peak, result)
        && let (Outcome::Rest | Outcome::StillRocking, Some(peak)) =
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

pub(super) fn label(axis: &Axis) -> &str {
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

/// The scale of an axis and the edges of the cells along it, halfway between their values, which are multiplied.
fn scale(axis: &Axis, factor: f64, figure: Figure) -> (Scale, Vec<f64>) {
    let values: Vec<f64> = axis.sequence.values();
    let values: Vec<f64> = values.into_iter().map(|value| factor * value).collect();
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
        Scale::exactly(low, high, figure.ticks(8))
    };
    (scale, edges)
}

/// Draws the map. Boundaries are of maps whose y is the amplitude.
#[must_use]
pub fn draw(
    title: &str,
    map: &OverturningMap<'_>,
    rows: &[CellRow],
    boundaries: &[BoundaryRow],
    look: Look,
) -> String {
    drawn(title, map, rows, boundaries, look).picture
}

/// The picture of a map, and where its cells are.
pub(super) struct Drawn {
    pub(super) picture: String,
    pub(super) height_px: f64,
    /// Edges of the columns from the left, and of the lines from below.
    pub(super) edges_px: [Vec<f64>; 2],
}

/// As [`draw`].
pub(super) fn drawn(
    title: &str,
    map: &OverturningMap<'_>,
    rows: &[CellRow],
    boundaries: &[BoundaryRow],
    look: Look,
) -> Drawn {
    let boundaries: Vec<_> = found(boundaries).collect();
    let figure = look.figure;
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(title);
    let top = drawing.caption(top + 11.0, &caption(map.scenario(), &map.axes()));
    let kinds: Vec<_> = rows.iter().map(|row| kind_of(&row.result, look)).collect();
    let factors = look.factors.unwrap_or([1.0; 2]);
    let [x_axis, y_axis] = map.axes();
    let (x, x_edges) = scale(x_axis, factors[0], figure);
    let (y, y_edges) = scale(y_axis, factors[1], figure);
    let keys = legend(map, &kinds, &boundaries, factors[1], &y);
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let axes = Axes {
        frame: figure.plot(top, figure.height_px(560.0)),
        x,
        y,
    };
    let high = map.values()[1].len();
    for kind in Kind::ALL {
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
    hatch(&mut drawing, &axes, [&x_edges, &y_edges], rows);
    let [x_label, y_label] = match look.factors {
        Some(_) => ["p t_p", "a / A_L"],
        None => map.axes().map(label),
    };
    axes.draw(&mut drawing, Some(x_label), y_label);
    let signs: Vec<f64> = [1.0, -1.0]
        .into_iter()
        .filter(|sign| map.values()[1].iter().any(|value| sign * value > 0.0))
        .collect();
    drawing.within(&axes.frame, |drawing| {
        for sign in &signs {
            let mut curve = |name, stroke, value: fn(&Boundary) -> Option<f64>| {
                let points = boundaries.iter().filter_map(|(x, boundary)| {
                    let value = sign * value(boundary)?;
                    Some(axes.place(factors[0] * x, factors[1] * value))
                });
                drawing.curve(name, points, stroke);
            };
            curve("incipient", INCIPIENT, |b| Some(b.incipient_g));
            curve("no-impact", IMPACT_FREE, |b| b.impact_free_g);
        }
    });
    let height_px = axes.frame.top + axes.frame.height + 56.0;
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

/// Strikes out the cells whose outcome depends on how they are computed.
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
        drawing.path("spread", &path, "none", DOUBTFUL);
    }
}

const DOUBTFUL: Stroke = Stroke::new(color::BLACK, 1.2, "");
const INCIPIENT: Stroke = Stroke::new(color::BLUE, 2.0, "7 4");
const IMPACT_FREE: Stroke = Stroke::new(color::BLACK, 2.2, "");

/// What the colours mean, and the lines that are on these axes.
fn legend(
    map: &OverturningMap<'_>,
    kinds: &[Kind],
    boundaries: &[(f64, Boundary)],
    factor: f64,
    y: &Scale,
) -> Vec<Key<'static>> {
    let mut keys = kind::keys(kinds);
    if map.has_spread() {
        let words = "another outcome in a repetition";
        keys.push((words, Sign::Line(DOUBTFUL)));
    }
    let shown = |value: fn(&Boundary) -> Option<f64>| {
        let mut values = boundaries
            .iter()
            .filter_map(|(_, boundary)| Some(factor * value(boundary)?));
        values.any(|value| (y.low..=y.high).contains(&value) || (y.low..=y.high).contains(&-value))
    };
    if shown(|boundary| Some(boundary.incipient_g)) {
        let incipient = if map.moves_vertically() {
            "incipient acceleration, were there no vertical motion"
        } else {
            "incipient acceleration"
        };
        keys.push((incipient, Sign::Line(INCIPIENT)));
    }
    if shown(|boundary| boundary.impact_free_g) {
        let words = "least amplitude that overturns without impact";
        keys.push((words, Sign::Line(IMPACT_FREE)));
    }
    keys
}
