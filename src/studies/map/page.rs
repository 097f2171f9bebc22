//! `map.html`: a map with a cursor. It shows the numbers of a cell, and the command that runs the cell.

use askama::Template;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Map, Value, json};

use super::picture::{self, Drawn};
use super::{CellRow, Described, OverturningMap, described};
use crate::output::page::{PROGRAM, script_safe};
use crate::output::{Figure, filters, render};
use crate::scenario::{Ground, Quantity, toml_text};
use crate::studies::outcome_colors::OutcomeColor;
use crate::studies::{Ending, Style};

/// Makes the page of a map.
pub fn page(title: &str, map: &OverturningMap<'_>, rows: &[CellRow], style: Style) -> String {
    let style = Style {
        figure: Figure::SCREEN,
        ..style
    };
    let drawn = picture::drawn(title, map, rows, style);
    let kinds = rows.iter().map(|row| picture::color_of(row, style));
    let doubt = |(index, row): (usize, &CellRow)| {
        let doubt = row.result.as_ref().ok()?.doubt()?;
        Some((index, doubt.to_string()))
    };
    let cells = Cells {
        palette: &OutcomeColor::ALL,
        kinds: kinds.collect(),
        doubts: rows.iter().enumerate().filter_map(doubt).collect(),
        outside: rows.iter().map(CellRow::is_outside_model).collect(),
        columns: columns(rows),
    };
    cells.page(title, map, &drawn)
}

/// The cells of the page.
pub(crate) struct Cells<'c> {
    /// All kinds of cells.
    pub(crate) palette: &'c [OutcomeColor],
    /// The kind of each cell.
    pub(crate) kinds: Vec<OutcomeColor>,
    /// Indices of the uncertain cells, with the reasons.
    pub(crate) doubts: Vec<(usize, String)>,
    /// True for cells outside the model of four links.
    pub(crate) outside: Vec<bool>,
    /// Columns with a number for each cell: name and values; `None` for a cell without a value.
    pub(crate) columns: Vec<(&'static str, Vec<Option<f64>>)>,
}

const SCRIPT: &str = include_str!("page/page.js");

#[derive(Template)]
#[template(path = "studies/map/page/page.html")]
struct Page<'p> {
    title: &'p str,
    picture: &'p str,
    scenario: String,
    data: String,
}

impl Cells<'_> {
    /// Makes the page from a picture for the screen.
    pub(crate) fn page(&self, title: &str, map: &OverturningMap<'_>, drawn: &Drawn) -> String {
        render(&Page {
            title,
            picture: &drawn.picture,
            scenario: map.scenario.to_toml(),
            data: script_safe(&self.data(map, drawn)),
        })
    }

    fn data(&self, map: &OverturningMap<'_>, drawn: &Drawn) -> Value {
        let index = |kind: &OutcomeColor| {
            let place = self.palette.iter().position(|known| known == kind);
            u8::try_from(place.unwrap_or(0)).unwrap_or(0)
        };
        let kinds: Vec<u8> = self.kinds.iter().map(index).collect();
        let columns = self.columns.iter().map(|(name, values)| {
            // NaN marks a missing value.
            let values = values.iter().map(|value| value.unwrap_or(f64::NAN));
            let bytes: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
            json!({ "name": name, "values": BASE64_STANDARD.encode(bytes) })
        });
        let axes = map.axes;
        let values = &map.values;
        let axis = |i: usize| {
            json!({
                "label": described(axes[i]).label,
                "values": values[i],
                "edges_px": drawn.edges_px[i],
            })
        };
        let doubts = self.doubts.iter();
        let doubts: Map<String, Value> = doubts
            .map(|(index, doubt)| (index.to_string(), json!(doubt)))
            .collect();
        let outside = (0..self.outside.len()).filter(|index| self.outside[*index]);
        let labels: Vec<&str> = self.palette.iter().map(|color| color.label).collect();
        json!({
            "axes": [axis(0), axis(1)],
            "sheet_px": { "width": Figure::SCREEN.width_px, "height": drawn.height_px },
            "kinds": BASE64_STANDARD.encode(kinds),
            "doubts": doubts,
            "outside": outside.collect::<Vec<_>>(),
            "labels": labels,
            "columns": columns.collect::<Vec<_>>(),
            "command": command(map),
        })
    }
}

/// Returns the columns with numbers of the cells.
fn columns(rows: &[CellRow]) -> Vec<(&'static str, Vec<Option<f64>>)> {
    type Of = fn(&Ending) -> Option<f64>;
    let all: [(&str, Of); 6] = [
        ("impacts", |of| Some(of.known_impacts()? as f64)),
        ("outcome_time_s", Ending::known_time_s),
        ("peak_rotation_over_critical", |of| of.peak_over_critical),
        ("peak_rotation_rad", Ending::peak_of_row_rad),
        ("energy_defect_ratio", |of| Some(of.energy_defect_ratio)),
        ("thrust_excess_ratio", |of| of.thrust_excess_ratio),
    ];
    let column = |(name, of): (_, Of)| {
        let cells = rows.iter().map(|row| of(row.result.as_ref().ok()?));
        (name, cells.collect())
    };
    all.map(column).into()
}

/// Returns the command that runs a cell, with placeholders for its two values. The command contains the whole scenario, so it depends neither on
/// the location of the page nor on the keys of the scenario file.
fn command(map: &OverturningMap<'_>) -> String {
    let scenario = map.scenario;
    // A command of one cell has no samples.
    let mut table = scenario.clone().without_uncertain().resolved();
    let mut remove = |outer: &str, key: &str| {
        let inner = table.pointer_mut(outer).and_then(Value::as_object_mut);
        inner.and_then(|inner| inner.shift_remove(key));
    };
    for study in ["map", "suite", "demand", "verify"] {
        remove("", study);
    }
    let ground = match scenario.ground.as_ref() {
        Some(Ground::Pulse(pulse)) => pulse.kind.name(),
        _ => "record",
    };
    let set = map.axes.into_iter().zip(["cell.x", "cell.y"]);
    let set = set.map(|(axis, place)| {
        let Described { table, keys, .. } = described(axis);
        let table = match table {
            "ground" => format!("ground.{ground}"),
            table => table.to_owned(),
        };
        for key in keys {
            remove(&format!("/{}", table.replace('.', "/")), key);
        }
        match axis.quantity {
            Quantity::Other => format!(" --set {}={{{place}}}", axis.key),
            Quantity::Frequency => format!(" --set {table}.duration_s={{1/{place}}}"),
            quantity => format!(" --set {table}.{}={{{place}}}", quantity.name()),
        }
    });
    let set: String = set.collect();
    let text = toml_text(&table);
    format!("archrock run -{set} --out cell <<'END'\n{text}END\n")
}
