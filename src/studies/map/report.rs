//! Report and files of an overturning map.

use askama::Template;
use serde::{Deserialize, Serialize};

use super::picture::{self, ColoredCells};
use super::{CellRow, OverturningMap, page};
use crate::argument::plain;
use crate::output::{Column, OutputError, Table, column};
use crate::scenario::{Quantity, Scenario, Varied};
use crate::studies::ending::Verdict;
use crate::studies::ending::columns::{self, FAILED};
use crate::studies::quotable::SurvivorFriction;
use crate::studies::report::{Report, Warnings};
use crate::studies::run::Scales;
use crate::studies::{CaseSummary, OutcomeCounts, Remark, Remarks, Results, Style};

const SUMMARY: &str = "map.json";

/// Report on a map.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/map/words.txt")]
pub struct MapSummary {
    #[serde(flatten)]
    all: CaseSummary,
    /// Number of cells with each outcome.
    outcomes: OutcomeCounts,
    /// Number of cells whose numbers are those of the mirrored ground motion.
    #[serde(default)]
    mirrored: usize,
    /// The use of a map of four links, in words; absent for other models and for columns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    for_looking: Option<String>,
    /// Number of cells with another outcome in a repetition, including rest instead of still rocking; absent unless cells are repeated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    other_outcomes_in_repetitions: Option<usize>,
}

/// Names of the files, the seal last.
pub(super) const FILES: [&str; 4] = ["map.svg", "map.html", SUMMARY, "map.csv"];

impl OverturningMap<'_> {
    /// Makes the report and the other files of all cells.
    pub(super) fn report(&self, cells: &[CellRow], style: Style) -> Result<Results, OutputError> {
        let scenario = self.scenario;
        let title = scenario.title.as_deref().unwrap_or("Overturning map");
        let remarks = remarks(self, cells);
        let for_looking = super::use_in_words(scenario).map(str::to_owned);
        let warnings = remarks.warnings("cells").chain(for_looking.clone());
        let survivors = cells
            .iter()
            .filter_map(|cell| cell.result.as_ref().ok())
            .filter(|ending| ending.verdict() == Verdict::Survives && !ending.is_outside_model());
        let demands = survivors.map(|ending| ending.friction_demand);
        let friction = SurvivorFriction::of(demands, scenario, ("map FILE", "surviving cells"));
        let doubtful = cells.iter().filter(|cell| cell.is_doubtful());
        let report = MapSummary {
            outcomes: OutcomeCounts::of(cells.iter().map(|cell| &cell.result)),
            mirrored: cells.iter().filter(|cell| cell.is_mirrored()).count(),
            for_looking,
            other_outcomes_in_repetitions: self.repeat.then(|| doubtful.count()),
            all: CaseSummary::new(
                (scenario, &Varied::default()),
                cells.len(),
                remarks,
                friction,
                warnings,
            ),
        };
        let colored = ColoredCells::of_outcomes(cells, style);
        let picture = |style| picture::draw_cells(title, self, cells, &colored, style);
        let results = Results::of(SUMMARY, &report)?;
        let (doubts, columns) = (page::doubts(cells), page::columns(cells));
        let page = colored.page(
            title,
            self,
            |figure| picture(style.with(figure)),
            &results.statement,
            (doubts, columns),
        );
        let results = results
            .with_table("map.csv", Table::new(self.columns(), cells)?)
            .with_file("map.svg", picture(style).picture)
            .with_file("map.html", page);
        Ok(results.in_order(&FILES))
    }
}

impl Report for MapSummary {
    fn verdict(&self) -> String {
        format!("{} cells: {}", self.all.cases, self.outcomes)
    }

    fn warnings(&self) -> &Warnings {
        &self.all.warnings
    }
}

impl OverturningMap<'_> {
    /// Columns of `map.csv`, one row per cell: x varies slowly, y fast.
    fn columns(&self) -> Vec<Column<'_, CellRow>> {
        let [x, y] = self.axes.map(|axis| axis.key.as_str());
        let mut all = vec![
            column(x, |row: &CellRow| row.x),
            column(y, |row: &CellRow| row.y),
        ];
        let is_repeated = self.scenario.motion.kind.is_repeated;
        all.extend(columns::columns(is_repeated, CellRow::ending));
        all.push(columns::direction(CellRow::ending));
        if self.repeat {
            all.push(column("outcomes", |row: &CellRow| {
                let outcomes = row.outcomes.as_ref();
                outcomes.map(|outcomes| match outcomes {
                    Ok(count) => count.to_string(),
                    Err(_) => FAILED.to_owned(),
                })
            }));
        }
        all
    }
}

/// Failed cells, cells with a failed repetition, and uncertain cells.
fn remarks(map: &OverturningMap<'_>, cells: &[CellRow]) -> Remarks {
    let [x_name, y_name] = map.axes.map(|axis| axis.key.as_str());
    let mut remarks = Remarks::default();
    for cell in cells {
        let case = || format!("{x_name} {}, {y_name} {}", plain(cell.x), plain(cell.y));
        remarks.add_case(case, &cell.result);
        if let Some(Err(reason)) = &cell.outcomes {
            remarks.failures.push(Remark::new(case(), reason));
        }
    }
    remarks
}

impl Style {
    /// Factors that convert durations to p t_p, and amplitudes to a / A_L.
    ///
    /// # Errors
    /// Property that the map lacks, in words.
    pub fn dimensionless(scenario: &Scenario) -> Result<[f64; 2], &'static str> {
        let map = scenario.map.as_ref().ok_or("there is no map")?;
        if (map.x.quantity, map.y.quantity) != (Quantity::Duration, Quantity::Amplitude) {
            return Err("needs the axes `duration_s` and `amplitude_g`");
        }
        if !scenario.motion.kind.has_mechanism {
            return Err("is for four links and columns: free hinges have no p");
        }
        let (model, gravity_m_s2) = (
            scenario.mechanisms_without_impacts(),
            scenario.gravity_m_s2(),
        );
        let scales = model
            .ok()
            .and_then(|model| Scales::new(&*model, gravity_m_s2))
            .ok_or("needs a mechanism that has an unstable equilibrium")?;
        let [right, left] = scales.incipient_m_s2;
        Ok([scales.frequency_rad_s, gravity_m_s2 / right.min(left)])
    }
}
