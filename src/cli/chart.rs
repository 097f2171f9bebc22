//! The command `chart`.

use std::path::PathBuf;

use archrock::studies::chart::{Chart, FILES};

use super::figure::FigureOption;
use super::scenario_file::ScenarioFile;
use super::study::say;
use super::{Failure, commands};
use archrock::studies::kept::CHART;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOption,
}

pub fn chart(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = input.read_as_built()?;
    let Some(arch) = scenario.structure().circular() else {
        let message = "chart is for arches only; the scenario has a column";
        return Err(Failure::Input(message.to_owned()));
    };
    // An arch that has no results of its own is refused here, with the reason.
    commands::model(&scenario)?;
    let place = arguments
        .figure
        .printed(input.results(arguments.out.as_deref())?)
        .locked(CHART, &scenario, quiet)?;
    // Opened before the work starts, so that a folder that cannot be written costs no time.
    let folder = place.open(&FILES)?;
    let law = scenario.motion().impact();
    let results = Chart::of(arch, law).tell(arguments.figure.get()?)?;
    results.write(folder)?;
    place.publish()?;
    if !quiet {
        say(&format!("{} in {}", results.words, place.holds(&results)));
    }
    Ok(())
}
