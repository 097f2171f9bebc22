//! The command `verify`.

use std::io::Write as _;
use std::path::PathBuf;

use archrock::output::pretty;
use archrock::studies::verify::{Check, page, to_json, today, words};

use super::scenario_file::ScenarioFile;
use super::study::say;
use super::{Failure, Format, print, warn};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

const PAGE: &str = "verify.html";
/// Written last: a folder that has it is complete.
const SUMMARY: &str = "verify.json";

pub fn verify(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = input.read(None)?;
    if !quiet {
        warn(&scenario.unlikely());
    }
    let check =
        Check::new(&scenario).map_err(|error| input.about(Failure::Input(error.to_string())))?;
    let json = pretty(&to_json(&scenario, &check)?);
    let place = input.results(arguments.out.as_deref())?;
    let page = page(&scenario, &check, &today());
    let mut folder = place.open(&[PAGE, SUMMARY])?;
    for (name, text) in [(PAGE, &page), (SUMMARY, &json)] {
        folder
            .file(name)
            .write_all(text.as_bytes())
            .map_err(|error| Failure::Work(format!("cannot write {name}: {error}")))?;
    }
    let path = folder.path().to_owned();
    folder.complete()?;
    if !quiet {
        say(&format!("results in {}: {PAGE}, {SUMMARY}", path.display()));
    }
    match arguments.format {
        Format::Json => print(&json),
        Format::Text => print(&words(&check)),
    }
}
