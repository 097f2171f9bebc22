//! Commands that compute without long histories: `capacity`, `spread` and `verify`.

use std::ops::ControlFlow;
use std::path::PathBuf;

use archrock::output::Figure;
use archrock::studies::catalogue::{Done, Options, Rows, StudyKind, VERIFY};
use archrock::studies::kept::{Origin, Writer};
use archrock::studies::results::{StudyError, Style};
use archrock::studies::runner::Runner;

use super::figure::FigureOption;
use super::progress::say;
use super::scenario_file::ScenarioFile;
use super::{Failure, Format, show, warn};

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
pub fn at_once(
    kind: StudyKind,
    arguments: &CommonArguments,
    figure: Option<FigureOption>,
    options: &Options,
) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    // Only `verify` needs a model of motion.
    let scenario = match kind == VERIFY {
        true => input.read(None)?,
        false => input.read_statics()?,
    };
    warn(&scenario.unlikely());
    let style = Style::of(figure.map_or(Ok(Figure::SCREEN), FigureOption::get)?);
    let mut watch = |_| ControlFlow::Continue(());
    let rows = Rows::Compute(Runner::default(), None, &mut watch);
    let done = kind.compute(&scenario, options, style, rows);
    let done = done.map_err(|error| match error {
        StudyError::Scenario(message) => input.wrong(message),
        error => error.into(),
    })?;
    let Done::Whole(results, _) = done else {
        unreachable!("no part is requested");
    };
    let mut place = input.results(arguments.out.as_deref())?;
    if let Some(figure) = figure {
        place = figure.printed(place);
    }
    let place = place.locked_for(Writer::of(kind), &Origin::of(&scenario))?;
    place.prepare(&results)?;
    place.publish()?;
    say(&format!("results in {}", place.holds(&results)));
    show(&results, arguments.format)
}
