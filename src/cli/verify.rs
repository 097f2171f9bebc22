//! The command `verify`.

use std::path::PathBuf;

use archrock::studies::verify::{Check, tell};

use super::scenario_file::ScenarioFile;
use super::{Failure, Format, show, warn};
use archrock::studies::kept::VERIFY;

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

pub fn verify(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = input.read_as_built()?;
    if scenario.right_foot().is_some() {
        let message = "the histories of a check shake both feet alike: leave [ground.right] out";
        return Err(input.about(Failure::Input(message.to_owned())));
    }
    if !quiet {
        warn(&scenario.unlikely());
    }
    let check =
        Check::new(&scenario).map_err(|error| input.about(Failure::Input(error.to_string())))?;
    let results = tell(&scenario, &check)?;
    let place = input.results(arguments.out.as_deref())?;
    let place = place.locked(VERIFY, &scenario, quiet)?;
    place.write(&results, quiet)?;
    show(&results, arguments.format)
}
