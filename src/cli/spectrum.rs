//! The command `spectrum`.

use std::io::Write as _;
use std::path::Path;

use archrock::output::part::{Header, Rows};
use archrock::output::{Folder, spectrum as output};
use archrock::scenario::{NoSpectrum, Points, Scenario};

use super::Failure;
use super::study::{Options, say};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    options: Options,
}

/// Name of the study in its parts.
pub const STUDY: &str = "spectrum";

const PICTURE: &str = "spectrum.svg";
/// Written last: a folder that has it is complete.
const TABLE: &str = "spectrum.csv";

impl From<NoSpectrum> for Failure {
    fn from(error: NoSpectrum) -> Self {
        Self::Input(error.to_string())
    }
}

pub fn spectrum(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let options = &arguments.options;
    let scenario = Scenario::read(&options.scenario)?;
    let points = Points::new(&scenario)?;
    let header = Header::new(STUDY, scenario.to_toml(), Vec::new(), points.count());
    let row = |index| output::row(&points, index);
    let Some(computed) = options.compute(header, quiet, row)? else {
        return Ok(());
    };
    finish(&scenario, &computed.rows, &options.folder(), quiet)?;
    computed.remove_part()
}

/// The results of a spectrum whose rows are all there, from a part of it or from several.
pub fn merge(scenario: &str, rows: &Rows, folder: &Path, quiet: bool) -> Result<(), Failure> {
    let scenario = Scenario::parse(scenario, "the scenario of the parts")?;
    finish(&scenario, rows, folder, quiet)
}

/// Writes the results.
fn finish(scenario: &Scenario, rows: &Rows, path: &Path, quiet: bool) -> Result<(), Failure> {
    let points = Points::new(scenario)?;
    let mut folder = Folder::open(path, &[PICTURE, TABLE])?;
    let title = scenario.title.as_deref().unwrap_or("Overturning spectrum");
    folder
        .file(PICTURE)
        .write_all(output::draw(title, &points, rows).as_bytes())
        .map_err(|error| Failure::Work(format!("cannot write the picture: {error}")))?;
    output::write_table(folder.file(TABLE), rows)?;
    folder.complete()?;
    if !quiet {
        say(&summary(&points, rows));
        say(&format!(
            "  results in {}: {PICTURE}, {TABLE}",
            path.display()
        ));
    }
    Ok(())
}

/// How many points came to what, and why some to less.
fn summary(points: &Points<'_>, rows: &Rows) -> String {
    let given = |column| {
        let rows = rows.values();
        rows.filter(|row| output::number(row, column).is_some())
            .count()
    };
    let after_impacts = rows
        .values()
        .filter(|row| output::number(row, "impacts_before_overturning") > Some(0.0))
        .count();
    let mut text = format!(
        "{} points: {} overturn, {after_impacts} of them after impacts with less than without, and {} without \
         impact",
        rows.len(),
        given("least_over_incipient"),
        given("no_impact_over_incipient"),
    );
    let total = |column: &str| -> f64 {
        let numbers = rows.values().filter_map(|row| output::number(row, column));
        numbers.sum()
    };
    let rocking = total("still_rocking");
    if rocking > 0.0 {
        text += &format!("; {rocking} histories were still rocking long after the pulse: survived");
    }
    let failed = total("failed");
    if failed > 0.0 {
        text += &format!("; {failed} histories failed");
        let first = rows
            .iter()
            .find(|(_, row)| output::number(row, "failed") > Some(0.0))
            .and_then(|(index, _)| points.point(*index).failures.first().copied());
        if let Some(error) = first {
            text += &format!("; the first that failed: {error}");
        }
    }
    text
}
