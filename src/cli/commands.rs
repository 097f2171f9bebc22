//! The command `limit`, and functions that several commands share.

use std::path::{Path, PathBuf};

use archrock::output::print::{PictureFormat, PrintError};
use archrock::output::scene::Scene;
use archrock::output::write_named_file;
use archrock::scenario::Scenario;
use archrock::studies::{limit, pictures};
use archrock::{FourLinkError, FourLinks};

use super::figure::FigureOption;
use super::parsers::FirstOption;
use super::scenario_file::ScenarioFile;
use super::{Failure, Format, show, warn};

#[derive(clap::Args)]
pub struct LimitArguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Also draw the mechanism and the thrust line to this SVG file.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    first: FirstOption,
    #[command(flatten)]
    figure: FigureOption,
}

pub fn limit(arguments: &LimitArguments) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let mut scenario = input.read_statics()?;
    if arguments.plot.is_some() {
        scenario = input.as_built(scenario)?;
    }
    warn(&scenario.unlikely());
    if let Some(plot) = &arguments.plot {
        let first = arguments.first.sway;
        let model =
            four_links(&scenario, "--plot is").map_err(|wrong| input.with_file_name(wrong))?;
        let (figure, scene) = (arguments.figure.get()?, Scene::new(&scenario.structure));
        let picture = pictures::limit(figure, &model, first, &scene);
        write_picture(plot, &picture)?;
    }
    let found = limit::limit(&scenario).map_err(|wrong| input.with_file_name(wrong.into()))?;
    show(&found.json, &found.text, arguments.format)
}

/// Makes the four-link model of a scenario. `what` is the subject and verb of the error for a column.
pub fn four_links(scenario: &Scenario, what: &str) -> Result<FourLinks, Failure> {
    let model = scenario.structure.four_links(scenario.motion.impact());
    model
        .map_err(|error| {
            Failure::Input(match error {
                FourLinkError::Ties => {
                    format!("{what} for arches without ties only: four links take none")
                }
                error => error.to_string(),
            })
        })?
        .ok_or_else(|| Failure::Input(format!("{what} for arches only; the scenario has a column")))
}

/// Writes a picture to the file named by `--plot`.
pub fn write_picture(path: &Path, picture: &str) -> Result<(), Failure> {
    let input = |wrong: PrintError| Failure::Input(format!("--plot: {wrong}"));
    let format = PictureFormat::of_file(path).map_err(input)?;
    let picture = format.of_picture(picture).map_err(input)?;
    write_named(path, &picture, "--plot")
}

/// Writes a file that this option names.
pub fn write_named(path: &Path, contents: &[u8], option: &str) -> Result<(), Failure> {
    let written = write_named_file(path, contents);
    written.map_err(|error| Failure::Input(format!("{error}; choose another file with {option}")))
}
