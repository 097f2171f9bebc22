//! The command `capacity`.

use std::path::PathBuf;

use archrock::studies::capacity::{capacity as capacities, report};
use nalgebra::Vector2;

use super::figure::FigureOption;
use super::scenario_file::ScenarioFile;
use super::{Failure, Format, show, warn};
use archrock::studies::kept::CAPACITY;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Control point in metres, such as `--point 0,5.4` [default: the crown, or the top of a column].
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    point: Option<Vector2<f64>>,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOption,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

fn point(text: &str) -> Result<Vector2<f64>, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .filter_map(|part| part.trim().parse().ok())
        .filter(|number: &f64| number.is_finite())
        .collect();
    match numbers[..] {
        [x, y] if text.matches(',').count() == 1 => Ok(Vector2::new(x, y)),
        _ => Err("give two numbers in metres with a comma between them, such as 0,5.4".to_owned()),
    }
}

pub fn capacity(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = input.as_built(input.read_statics()?)?;
    if !quiet {
        warn(&scenario.unlikely());
    }
    let sides = capacities(&scenario, arguments.point)
        .map_err(|error| Failure::Input(error.to_string()))?;
    let place = arguments
        .figure
        .printed(input.results(arguments.out.as_deref())?)
        .locked(CAPACITY, &scenario, quiet)?;
    let results = report(&scenario, &sides, arguments.figure.get()?)?;
    place.write(&results, quiet)?;
    show(&results, arguments.format)
}
