//! `map.html`: a map with a cursor. It shows the numbers of a cell, and the command that runs the cell.

use std::collections::BTreeMap;

use askama::Template;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::{Deserialize, Serialize};

use super::picture::{ColoredCells, Drawn};
use super::{CellRow, OverturningMap, label};
use crate::output::caption::caption;
use crate::output::page::{BASE, PROGRAM, STYLE, script_safe};
use crate::output::{Figure, filters, render};
use crate::scenario::{Ground, Quantity};
use crate::studies::Statement;
use crate::studies::ending::columns::NUMBERS;
use crate::studies::page::{assumptions, text_without_studies};

const SCRIPT: &str = include_str!("page/page.js");

/// The page: a picture for the screen, and all other data, as JSON inside it. Encoded numbers are in base 64.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/map/page/page.html")]
struct MapPage {
    #[serde(skip)]
    picture: String,
    title: String,
    scenario: String,
    /// The input in one line.
    what: String,
    verdict: String,
    warnings: Vec<String>,
    /// The details of the report in words.
    words: String,
    assumptions: Vec<String>,
    axes: [PageAxis; 2],
    /// The drawings for wide and for narrow screens.
    sheets: [PageSheet; 2],
    /// The colour of each cell, as the number of its label.
    kinds: String,
    /// The reasons of uncertain cells, by the number of the cell.
    doubts: BTreeMap<usize, String>,
    /// Cells outside the model of four links.
    outside: Vec<usize>,
    /// Cells with the numbers of the mirrored ground motion.
    #[serde(default)]
    mirrored: Vec<usize>,
    labels: Vec<String>,
    columns: Vec<PageColumn>,
    command: String,
}

#[derive(Serialize, Deserialize)]
struct PageAxis {
    label: String,
    values: Vec<f64>,
}

/// Size of a drawing, and the edges of its columns and rows.
#[derive(Serialize, Deserialize)]
struct PageSheet {
    width_px: f64,
    height_px: f64,
    edges_px: [Vec<f64>; 2],
}

/// A number for each cell; NaN for a cell without a value.
#[derive(Serialize, Deserialize)]
struct PageColumn {
    name: String,
    values: String,
}

/// Renders a page of a map again from its picture and the JSON inside it.
///
/// # Errors
/// When the JSON is not that of a page.
pub fn page_of(picture: &str, data: &str) -> serde_json::Result<String> {
    let page = serde_json::from_str::<MapPage>(data)?;
    let picture = picture.to_owned();
    Ok(render(&MapPage { picture, ..page }))
}

/// Name and numbers of a column; `None` for a cell without a value.
pub(crate) type CellNumbers = (&'static str, Vec<Option<f64>>);

impl ColoredCells {
    /// Makes the page from a picture of any width, with the statements of the report, reasons for uncertain cells, and columns of numbers.
    pub(crate) fn page(
        &self,
        title: &str,
        map: &OverturningMap<'_>,
        draw: impl Fn(Figure) -> Drawn,
        said: &Statement,
        (doubts, columns): (
            BTreeMap<usize, String>,
            impl IntoIterator<Item = CellNumbers>,
        ),
    ) -> String {
        let index = |color| {
            let place = self.palette.iter().position(|known| known == color);
            u8::try_from(place.unwrap_or(0)).unwrap_or(0)
        };
        let kinds: Vec<u8> = self.colors.iter().map(index).collect();
        let columns = columns.into_iter().map(|(name, values)| {
            let values = values.iter().map(|value| value.unwrap_or(f64::NAN));
            let bytes: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
            PageColumn {
                name: name.to_owned(),
                values: BASE64_STANDARD.encode(bytes),
            }
        });
        let drawn = [Figure::PAGE, Figure::PHONE].map(|figure| (figure, draw(figure)));
        let pictures: Vec<String> = ["wide", "narrow"]
            .into_iter()
            .zip(&drawn)
            .map(|(name, (_, drawn))| {
                format!("<div class=\"picture {name}\">{}</div>", drawn.picture)
            })
            .collect();
        let axis = |i: usize| PageAxis {
            label: label(map.axes[i]).to_owned(),
            values: map.values[i].clone(),
        };
        let are = |cells: &[bool]| -> Vec<usize> {
            (0..cells.len()).filter(|index| cells[*index]).collect()
        };
        let labels = self.palette.iter().map(|color| color.label.to_owned());
        render(&MapPage {
            title: title.to_owned(),
            scenario: map.scenario.to_toml(),
            axes: [axis(0), axis(1)],
            sheets: drawn.each_ref().map(|(figure, drawn)| PageSheet {
                width_px: figure.width_px,
                height_px: drawn.height_px,
                edges_px: drawn.edges_px.clone(),
            }),
            what: caption(map.scenario, &map.axes),
            verdict: said.verdict.clone(),
            warnings: said.warnings(),
            words: said.details_outdented(),
            assumptions: assumptions(&[], &[map.scenario.motion.kind]),
            kinds: BASE64_STANDARD.encode(kinds),
            doubts,
            outside: are(&self.outside),
            mirrored: are(&self.mirrored),
            labels: labels.collect(),
            columns: columns.collect(),
            command: command(map),
            picture: pictures.concat(),
        })
    }
}

/// Reasons for uncertain cells, by the number of the cell.
pub(super) fn doubts(rows: &[CellRow]) -> BTreeMap<usize, String> {
    let doubt = |row: &CellRow| Some(row.result.as_ref().ok()?.doubt()?.to_string());
    let doubts = rows.iter().map(doubt).enumerate();
    doubts
        .filter_map(|(index, doubt)| Some((index, doubt?)))
        .collect()
}

/// Columns with numbers of the cells.
pub(super) fn columns(rows: &[CellRow]) -> impl Iterator<Item = CellNumbers> {
    let endings = move || rows.iter().map(|row| row.result.as_ref().ok());
    let impacts = endings().map(|ending| Some(ending?.known_impacts()? as f64));
    let numbers = NUMBERS.into_iter().map(move |(name, of)| {
        let cells = endings().map(|ending| of(ending?));
        (name, cells.collect())
    });
    [("impacts", impacts.collect())].into_iter().chain(numbers)
}

/// Command that runs a cell, with placeholders for its two values. The command contains the whole scenario, so it depends neither on
/// the location of the page nor on the keys of the scenario file.
fn command(map: &OverturningMap<'_>) -> String {
    // A command of one cell has no samples and no other studies.
    let set = map.axes.iter().zip(&map.paths);
    let set: String = set
        .zip(["cell.x", "cell.y"])
        .map(|((axis, path), place)| {
            let of_value = match (axis.quantity, &map.base.ground) {
                (Quantity::Frequency, _) => "1/".to_owned(),
                (Quantity::VelocityRatio, Some(Ground::Pulse(pulse))) => {
                    let duration_s = axis.quantity.duration_s(1.0, pulse);
                    format!("{}*", duration_s.unwrap_or(1.0))
                }
                _ => String::new(),
            };
            format!(" --set {path}={{{of_value}{place}}}")
        })
        .collect();
    let text = text_without_studies(&map.base.to_json(), false);
    format!("archrock run -{set} --out cell <<'END'\n{text}END\n")
}
