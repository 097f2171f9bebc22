//! Commands that compute without long histories: `capacity`, `spread` and `verify`.

use std::path::PathBuf;

use archrock::output::Origin;
use archrock::studies::catalogue::{Options, StudyKind, VERIFY};
use archrock::studies::results::Style;

use super::figure::FigureOption;
use super::scenario_file::ScenarioFile;
use super::study::{Session, WorkOptions};
use super::{Failure, Format, warn};

/// Options of commands without long histories.
#[derive(clap::Args)]
pub struct CommonArguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Computes a study, writes its results and prints their summary.
pub fn run_short_study(
    kind: StudyKind,
    arguments: &CommonArguments,
    figure: FigureOption,
    options: Options,
) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    // Only `verify` needs a model of motion.
    let scenario = match kind == VERIFY {
        true => input.read(None)?,
        false => input.read_statics()?,
    };
    warn(&scenario.unlikely());
    let style = Style::of(figure.get()?);
    let session = Session::new(Some(&input), WorkOptions::default(), style, options);
    let place = figure.with_picture_format(input.results(arguments.out.as_deref())?);
    place.lock(kind, Origin::of(&scenario), false)?;
    session.finish(kind, &scenario, &place, arguments.format)
}
