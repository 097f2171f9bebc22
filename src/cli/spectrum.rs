//! The command `spectrum`.

use std::io::Write as _;
use std::path::Path;

use archrock::output::part::{Header, Rows};
use archrock::output::{Folder, spectrum as output};
use archrock::scenario::{NoSpectrum, Points, Scenario};

use super::Failure;
use super::study::{Options, say, write_summary};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    options: Options,
}

/// Name of the study in its parts.
pub const STUDY: &str = "spectrum";

const PICTURE: &str = "spectrum.svg";
const SUMMARY: &str = "spectrum.json";
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
    let points = Points::new(&scenario).map_err(|error| options.about_scenario(error.into()))?;
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
    let mut folder = Folder::open(path, &[PICTURE, SUMMARY, TABLE])?;
    let title = scenario.title.as_deref().unwrap_or("Overturning spectrum");
    folder
        .file(PICTURE)
        .write_all(output::draw(title, &points, rows).as_bytes())
        .map_err(|error| Failure::Work(format!("cannot write the picture: {error}")))?;
    write_summary(folder.file(SUMMARY), scenario, rows)?;
    output::write_table(folder.file(TABLE), rows)?;
    folder.complete()?;
    if !quiet {
        say(&summary(&points, rows));
        say(&format!(
            "  results in {}: {PICTURE}, {SUMMARY}, {TABLE}",
            path.display()
        ));
    }
    Ok(())
}

/// How many points came to what, and what is not certain about them.
fn summary(points: &Points<'_>, rows: &Rows) -> String {
    let impacts = |row: &String| output::number(row, "impacts_before_overturning");
    let count = |wanted: fn(Option<f64>) -> bool| {
        let rows = rows.values();
        rows.filter(|row| wanted(impacts(row))).count()
    };
    let mut text = format!(
        "{} points: the least that overturns does so without impact at {}, after impacts at {}",
        rows.len(),
        count(|impacts| impacts == Some(0.0)),
        count(|impacts| impacts > Some(0.0)),
    );
    let none = count(|impacts| impacts.is_none());
    if let Some(last) = points.over_incipient().last()
        && none > 0
    {
        text += &format!("; at {none} nothing up to {last} A_L overturns");
    }
    let total = |column: &str| -> f64 {
        let numbers = rows.values().filter_map(|row| output::number(row, column));
        numbers.sum()
    };
    let rocking = total("still_rocking");
    if rocking > 0.0 {
        text += &format!(
            "; {rocking} histories were still rocking long after their pulse, and count as survived"
        );
    }
    let failed = total("failed");
    if failed > 0.0 {
        text += &format!("; {failed} histories failed");
        let first = rows
            .iter()
            .find(|(_, row)| output::number(row, "failed") > Some(0.0))
            .and_then(|(index, _)| points.point(*index).failures.first().cloned());
        if let Some(error) = first {
            text += &format!("; the first that failed: {error}");
        }
    }
    text
}
