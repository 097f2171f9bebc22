//! Commands that compute without long histories: `capacity`, `spread` and `verify`.

use std::ops::ControlFlow;
use std::path::PathBuf;

use archrock::output::Figure;
use archrock::studies::catalogue::{Done, Options, Rows, StudyKind};
use archrock::studies::kept::Writer;
use archrock::studies::results::{Look, StudyError};
use archrock::studies::runner::Runner;

use super::figure::FigureOption;
use super::scenario_file::ScenarioFile;
use super::{Failure, Format, show, warn};

/// Options of these commands.
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

/// Whether a command needs a structure that can be moved.
pub enum Statics {
    Suffice,
    DoNotSuffice,
}

/// Computes a study, writes its results and prints their summary.
pub fn at_once(
    kind: StudyKind,
    writer: Writer,
    (arguments, figure): (&CommonArguments, Option<FigureOption>),
    statics: Statics,
    options: &Options,
    quiet: bool,
) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = match statics {
        Statics::Suffice => input.read_statics()?,
        Statics::DoNotSuffice => input.read(None)?,
    };
    if !quiet {
        warn(&scenario.unlikely());
    }
    let look = Look::of(figure.map_or(Ok(Figure::SCREEN), FigureOption::get)?);
    let mut watch = |_| ControlFlow::Continue(());
    let rows = Rows::Compute(Runner::default(), None, &mut watch);
    let done = kind.compute(&scenario, options, look, rows);
    let done = done.map_err(|error| match error {
        StudyError::Scenario(message) => input.about(Failure::Input(message)),
        error => error.into(),
    })?;
    let Done::Whole(results, _) = done else {
        unreachable!("no part is requested");
    };
    let mut place = input.results(arguments.out.as_deref())?;
    if let Some(figure) = figure {
        place = figure.printed(place);
    }
    place
        .locked(writer, &scenario, quiet)?
        .write(&results, quiet)?;
    show(&results, arguments.format)
}
