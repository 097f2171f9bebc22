//! Files and words of moved springings.

use serde_json::{Value, json};

use super::picture::draw;
use super::{Push, SpreadPath, SpreadSummary, Stage};
use crate::argument::plain;
use crate::mechanics::{Movements, Sides};
use crate::output::page::SpotKind;
use crate::output::{Cell, Figure, OutputError, Scene, Table, column, list, several};
use crate::scenario::Scenario;
use crate::studies::page::{CaseScenario, Page, PageCases};
use crate::studies::{Results, StudyError};

/// Names of the files, the seal last.
pub const FILES: [&str; 4] = ["spread.html", "spread.svg", "spread.csv", "spread.json"];

/// Makes files and words of all paths.
///
/// # Errors
/// When a value is not finite, or the structure is not a row of blocks.
pub fn report(
    scenario: &Scenario,
    spread: &SpreadSummary,
    figure: Figure,
) -> Result<Results, StudyError> {
    let row = scenario.structure.row().map_err(StudyError::scenario)?;
    let scene = Scene::of_row(&row, &scenario.structure);
    let title = scenario.title.as_deref().unwrap_or("Springings that move");
    let drawn = |figure, spots: &[_]| draw(figure, title, spread, (&row, &scene), spots);
    let results = Results::of("spread.json", spread)?
        .with_table("spread.csv", table(spread)?)
        .with_file("spread.svg", drawn(figure, &[]));
    let mut cases = PageCases::default();
    let mut unmoved = scenario.to_json();
    if let Value::Object(tables) = &mut unmoved {
        tables.shift_remove("supports");
    }
    let text = cases.add_text(&unmoved, false);
    let settled = scenario.motion.supports().unwrap_or_default();
    let further = if spread.is_further() { " further" } else { "" };
    for (path, stage) in rows(spread) {
        let push_g = stage.smaller_push(Push::Capacity);
        let words = format!(
            "{}{further} {} m: {}",
            path.movement_in_words(&spread.support),
            plain(stage.movement_m),
            push_g.map_or("no push found".to_owned(), |g| format!(
                "falls at {} g",
                plain(g)
            )),
        );
        let movements = settled + path.direction.movements(stage.movement_m);
        cases.push((SpotKind::Point, false), words, || {
            Some(CaseScenario::of(text, values_of(movements)))
        });
    }
    let own = "the supports move slowly, and joints do not slip; the arch rests on three hinges, or on more with ties, and snaps to others";
    let (what, picture) = (scenario.structure.describe(), |figure| {
        drawn(figure, &cases.spots)
    });
    let mut page = Page::new(title, what, &[own], &[]);
    page.command = "limit -".to_owned();
    let results = results.with_page("spread.html", page, &cases, (&picture, &[]));
    Ok(results.in_order(&FILES))
}

/// Keys and values of `[supports]`.
fn values_of(movements: Movements) -> Vec<(String, f64)> {
    let movements = json!(movements);
    let sides = movements.as_object().into_iter().flatten();
    let values = sides.flat_map(|(side, table)| {
        let table = table.as_object().into_iter().flatten();
        table.filter_map(move |(key, value)| {
            Some((format!("supports.{side}.{key}"), value.as_f64()?))
        })
    });
    values.collect()
}

/// All stages of all paths.
fn rows(spread: &SpreadSummary) -> impl Iterator<Item = (&SpreadPath, &Stage)> {
    let paths = spread.paths.iter();
    paths.flat_map(|path| path.stages.iter().map(move |stage| (path, stage)))
}

/// Makes the table of all stages of all paths.
fn table(spread: &SpreadSummary) -> Result<Table, OutputError> {
    type Row<'a> = (&'a SpreadPath, &'a Stage);
    let rows: Vec<Row<'_>> = rows(spread).collect();
    // Arches with ties may have more than three hinges.
    let most = rows
        .iter()
        .map(|row| row.1.hinges.len())
        .fold(3, usize::max);
    let hinges = (1..=most).flat_map(|hinge| {
        ["joint", "edge", "rotation_rad"].map(|what| format!("hinge_{hinge}_{what}"))
    });
    let sides = |name: &str, pushes: fn(&Stage) -> &Sides<Option<f64>>| {
        let names = ["right", "left"].map(|side| format!("{name}_{side}_g"));
        list(names, move |row: &Row<'_>| <[_; 2]>::from(*pushes(row.1)))
    };
    let columns = [
        column("springing", |row: &Row<'_>| {
            row.0.direction.springing.name()
        }),
        column("angle_deg", |row: &Row<'_>| row.0.direction.angle_deg),
        column("movement_m", |row: &Row<'_>| row.1.movement_m),
        several(hinges, move |row: &Row<'_>, cells: &mut Vec<Cell<'_>>| {
            for index in 0..most {
                let open = row.1.hinges.get(index);
                cells.push(open.map(|open| open.hinge.joint).into());
                cells.push(open.map(|open| open.hinge.edge.name()).into());
                cells.push(open.map(|open| open.rotation_rad).into());
            }
        }),
        column("thrust_n", |row: &Row<'_>| row.1.thrust_n),
        column("thrust_ratio", |row: &Row<'_>| row.1.thrust_ratio),
        column("friction_demand", |row: &Row<'_>| row.1.friction_demand),
        column("crown_drop_m", |row: &Row<'_>| row.1.crown_drop_m),
        sides("first_motion", |stage| &stage.first_motion_g),
        sides("capacity", |stage| &stage.capacity_g),
    ];
    Table::new(columns, &rows)
}
