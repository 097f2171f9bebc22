//! Reports an overturning map: its table, its boundaries and its words.

use super::boundary::{Boundary, BoundaryRow, MapRow};
use super::{CellResult, CellRow, OverturningMap, page, picture};
use crate::argument::plain;
use crate::dynamics::history::Outcome;
use crate::output::table::{Column, column, csv};
use crate::output::{OutputError, pretty};
use crate::scenario::{Quantity, Scenario};
use crate::studies::ending::columns::{self, FAILED, number};
use crate::studies::kind::{CANNOT_STAND, NOT_FOUR_LINKS};
use crate::studies::remarks::{self, Remark, Remarks, counts, in_words};
use crate::studies::results::{Look, Results};
use crate::studies::run::Scales;

const SUMMARY: &str = "map.json";
const BOUNDARY: &str = "no_impact.csv";

impl OverturningMap<'_> {
    /// The files and words for all rows.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn tell(&self, rows: Vec<MapRow>, look: Look) -> Result<Results, OutputError> {
        let scenario = self.scenario();
        let (cells, boundaries) = MapRow::sorted(rows);
        let title = scenario.title().unwrap_or("Overturning map");
        let remarks = remarks(self, &cells, &boundaries);
        let summary = remarks::summary(scenario, cells.len(), &remarks);
        let picture = look.figure.fitted(|figure| {
            picture::draw(title, self, &cells, &boundaries, Look { figure, ..look })
        });
        let page = page::page(title, self, &cells, &boundaries, look);
        let mut files = vec![
            ("map.svg", picture.into_bytes()),
            ("map.html", page.into_bytes()),
            (SUMMARY, pretty(&summary).into_bytes()),
            ("map.csv", csv(self.columns(), &cells)?),
        ];
        if look.no_impact {
            files.insert(0, (BOUNDARY, self.boundary_table(&boundaries)?));
        }
        Ok(Results {
            files,
            obsolete: (!look.no_impact).then_some(BOUNDARY),
            words: words(self, &cells, &remarks),
            summary,
            peaks: Vec::new(),
        })
    }

    /// The columns for one row per cell: x varies slowly, y fast.
    fn columns(&self) -> Vec<Column<'_, CellRow>> {
        let [x, y] = self.axes().map(|axis| axis.key.as_str());
        let mut all = vec![
            column(x, |row: &CellRow| number(row.x)),
            column(y, |row: &CellRow| number(row.y)),
        ];
        all.extend(columns::columns(
            self.has_free_hinges(),
            |row: &CellRow| match &row.result {
                CellResult::Ended(ending) => Ok(ending),
                other => Err(outcome(other)),
            },
        ));
        if self.has_spread() {
            all.push(column(SPREAD, |row: &CellRow| {
                let spread = row.spread.as_ref();
                spread.map(|spread| match spread {
                    Ok(count) => count.to_string(),
                    Err(_) => FAILED.to_owned(),
                })
            }));
        }
        all
    }

    /// The boundaries that were found, one row per value of x.
    fn boundary_table(&self, boundaries: &[BoundaryRow]) -> Result<Vec<u8>, OutputError> {
        type Row = (f64, Boundary);
        let rows: Vec<Row> = found(boundaries).collect();
        let columns = [
            column(self.axes()[0].key.as_str(), |row: &Row| row.0),
            column("incipient_acceleration_g", |row: &Row| row.1.incipient_g),
            column("no_impact_amplitude_g", |row: &Row| row.1.impact_free_g),
        ];
        csv(columns, &rows)
    }
}

/// The boundaries that were found, with their x.
pub(super) fn found(boundaries: &[BoundaryRow]) -> impl Iterator<Item = (f64, Boundary)> {
    let rows = boundaries.iter();
    rows.filter_map(|row| Some((row.x, row.result.as_ref().ok().copied()??)))
}

/// The outcome of a cell, as in the table.
#[must_use]
pub const fn outcome(result: &CellResult) -> &'static str {
    match result {
        CellResult::Ended(ending) => ending.outcome_name(),
        CellResult::CannotStand => CANNOT_STAND,
        CellResult::NotFourLinks => NOT_FOUR_LINKS,
        CellResult::Failed(_) => FAILED,
    }
}

/// The column with the number of outcomes of a cell and its repetitions.
const SPREAD: &str = "spread";

/// How many cells have an outcome that depends on how they are computed.
fn doubtful(rows: &[CellRow]) -> usize {
    rows.iter().filter(|row| is_doubtful(row)).count()
}

pub(super) fn is_doubtful(row: &CellRow) -> bool {
    matches!(row.spread, Some(Ok(2..)))
}

/// The remarks on the cells: those that failed, those with a failed repetition or boundary, and those that are uncertain.
fn remarks(map: &OverturningMap<'_>, cells: &[CellRow], boundaries: &[BoundaryRow]) -> Remarks {
    let [x_name, y_name] = map.axes().map(|axis| axis.key.as_str());
    let mut remarks = Remarks::default();
    for cell in cells {
        let case = || format!("{x_name} {}, {y_name} {}", plain(cell.x), plain(cell.y));
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
            let case = format!("boundary without impact at {x_name} {}", plain(row.x));
            remarks.failures.push(Remark::new(case, reason));
        }
    }
    remarks
}

/// How many cells had each outcome, what is doubtful about them, and what failed.
fn words(map: &OverturningMap<'_>, cells: &[CellRow], remarks: &Remarks) -> String {
    let words = |cell: &CellRow| match &cell.result {
        CellResult::Ended(ending)
            if ending.uncertain.is_none() && ending.outcome == Outcome::StillRocking =>
        {
            (4, "are still rocking at the end, which counts as survived")
        }
        CellResult::Ended(ending) => in_words(ending),
        CellResult::CannotStand => (7, "cannot stand"),
        CellResult::NotFourLinks => (8, "are too thick for four links"),
        CellResult::Failed(_) => (9, "failed"),
    };
    let counts = counts(cells.iter().map(words));
    let mut lines = vec![format!("{} cells: {counts}", cells.len())];
    if map.has_spread() {
        lines.push(format!(
            "{} of them have another outcome in a repetition, if only rest instead of still rocking",
            doubtful(cells)
        ));
    }
    if map.has_free_hinges() && map.axes()[1].quantity == Quantity::Amplitude {
        let model = map.scenario().motion().words();
        lines.push(format!(
            "{model}: no boundary of overturning without impact, which only four links have"
        ));
    }
    lines.extend(remarks::rough_guide(map.scenario()).map(str::to_owned));
    lines.extend(remarks.incomplete_in_words());
    lines.extend(remarks.uncertain_in_words(SUMMARY));
    lines.extend(remarks.failed_in_words(SUMMARY));
    lines.join("\n  ")
}

impl Look {
    /// The factors that turn durations into p t_p, and amplitudes into a / A_L.
    ///
    /// # Errors
    /// Explains what the map lacks for that.
    pub fn dimensionless(scenario: &Scenario) -> Result<[f64; 2], &'static str> {
        let map = scenario.map().ok_or("there is no map")?;
        if (map.x.quantity, map.y.quantity) != (Quantity::Duration, Quantity::Amplitude) {
            return Err("needs the axes `duration_s` and `amplitude_g`");
        }
        if scenario.motion().hinges().has_joints() {
            return Err("goes with four links and columns: free hinges have no p");
        }
        let model = scenario.mechanisms();
        let scales = model
            .ok()
            .and_then(|model| Scales::new(&*model, scenario.gravity_m_s2()))
            .ok_or("needs a mechanism that has an unstable equilibrium")?;
        let gravity_m_s2 = scenario.gravity_m_s2();
        let [right, left] = scales.incipient_m_s2;
        Ok([scales.frequency_rad_s, gravity_m_s2 / right.min(left)])
    }
}
