//! Commands that compute without long histories: `capacity`, `spread` and `verify`.

use std::path::PathBuf;

use archrock::Sway;
use archrock::studies::{CAPACITY, Options, SPREAD, SpringingDirection, StudyKind, Style, VERIFY};
use nalgebra::Vector2;

use super::execution::Execution;
use super::figure::FigureOption;
use super::parsers::{number, point_m, side};
use super::results::DetailsOption;
use super::scenario_file::ScenarioFile;
use super::study::WorkOptions;
use super::{Failure, Format};

/// Options of commands without long histories.
#[derive(clap::Args)]
pub struct CommonArguments {
    #[command(flatten)]
    pub scenario: ScenarioFile,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

#[derive(clap::Args)]
pub struct CapacityArguments {
    #[command(flatten)]
    common: CommonArguments,
    /// Control point in metres, such as `--point 0,5.4` [default: the crown, or the top of a column].
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point_m)]
    point: Option<Vector2<f64>>,
    /// Write no page (HTML) for the browser.
    #[arg(long)]
    no_report: bool,
    #[command(flatten)]
    figure: FigureOption,
}

#[derive(clap::Args)]
pub struct SpreadArguments {
    #[command(flatten)]
    common: CommonArguments,
    /// The springing that moves.
    #[arg(long, value_name = "SIDE", default_value = "right", value_parser = side(["left", "right"]))]
    springing: Sway,
    /// Direction in degrees from outwards (0) over down (90) to inwards (180); up is -90. Can be repeated [default: 0, 180 and 90].
    #[arg(long = "angle", value_name = "DEG", allow_hyphen_values = true, value_parser = angle)]
    angles_deg: Vec<f64>,
    /// Write no page (HTML) for the browser.
    #[arg(long)]
    no_report: bool,
    #[command(flatten)]
    figure: FigureOption,
}

fn angle(text: &str) -> Result<f64, String> {
    let remedy = "give a direction in degrees, from -180 to 180";
    number(text.trim(), -180.0..=180.0, remedy)
}

pub fn capacity(arguments: &CapacityArguments) -> Result<(), Failure> {
    let mut options = Options {
        point_m: arguments.point,
        ..Options::default()
    };
    options.run.no_report = arguments.no_report;
    run(CAPACITY, &arguments.common, arguments.figure, options)
}

pub fn spread(arguments: &SpreadArguments) -> Result<(), Failure> {
    let angles_deg = match &arguments.angles_deg[..] {
        [] => &SpringingDirection::DEFAULT_DEG[..],
        given => given,
    };
    let direction = |angle_deg: &f64| SpringingDirection {
        springing: arguments.springing,
        angle_deg: *angle_deg,
    };
    let mut options = Options {
        directions: angles_deg.iter().map(direction).collect(),
        ..Options::default()
    };
    options.run.no_report = arguments.no_report;
    run(SPREAD, &arguments.common, arguments.figure, options)
}

pub fn verify(arguments: &CommonArguments) -> Result<(), Failure> {
    let figure = FigureOption::default();
    run(VERIFY, arguments, figure, Options::default())
}

/// Computes a study, writes its results and prints their summary.
fn run(
    kind: StudyKind,
    arguments: &CommonArguments,
    figure: FigureOption,
    options: Options,
) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = match kind.needs_motion {
        true => input.read(None)?,
        false => input.read_statics()?,
    };
    let destination = input.results(arguments.out.as_deref());
    let file = input.task(vec![scenario], Some(destination));
    execution(kind, arguments, figure, options)?.execute(vec![file])
}

/// Returns the execution of a study without samples.
pub fn execution(
    kind: StudyKind,
    arguments: &CommonArguments,
    figure: FigureOption,
    options: Options,
) -> Result<Execution, Failure> {
    Ok(Execution {
        kind,
        style: Style::of(figure.get()?),
        options,
        work: WorkOptions::default(),
        pictures: figure.figure_format,
        format: arguments.format,
        detail: DetailsOption::default().get(),
        has_words_apart: false,
    })
}
