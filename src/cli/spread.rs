//! The command `spread`.

use std::path::PathBuf;

use archrock::studies::spread::{NoSpread, Springing, Way, spread as paths, tell};
use clap::ValueEnum;

use super::figure::FigureOption;
use super::scenario_file::ScenarioFile;
use super::{Failure, Format, show, warn};
use archrock::studies::kept::SPREAD;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// The springing that moves.
    #[arg(long, value_enum, value_name = "SIDE", default_value_t)]
    springing: Side,
    /// Direction in degrees from outwards (0) over down (90) to inwards (180); up is -90. Can be repeated [default: 0, 180 and 90].
    #[arg(long = "angle", value_name = "DEG", allow_hyphen_values = true, value_parser = angle)]
    angles_deg: Vec<f64>,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOption,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum Side {
    Left,
    #[default]
    Right,
}

fn angle(text: &str) -> Result<f64, String> {
    let angle: Option<f64> = text.trim().parse().ok();
    angle
        .filter(|angle| (-180.0..=180.0).contains(angle))
        .ok_or_else(|| "give a direction in degrees, from -180 to 180".to_owned())
}

impl From<NoSpread> for Failure {
    fn from(error: NoSpread) -> Self {
        Self::Input(error.to_string())
    }
}

pub fn spread(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = input.read_statics()?;
    if !quiet {
        warn(&scenario.unlikely());
    }
    let springing = match arguments.springing {
        Side::Left => Springing::Left,
        Side::Right => Springing::Right,
    };
    let angles_deg = match &arguments.angles_deg[..] {
        [] => &Way::USUAL_DEG[..],
        given => given,
    };
    let ways: Vec<Way> = angles_deg
        .iter()
        .map(|angle_deg| Way {
            springing,
            angle_deg: *angle_deg,
        })
        .collect();
    let found = paths(&scenario, &ways).map_err(|error| input.about(error.into()))?;
    let place = arguments
        .figure
        .printed(input.results(arguments.out.as_deref())?)
        .locked(SPREAD, &scenario, quiet)?;
    let results = tell(&scenario, &found, arguments.figure.get()?)?;
    place.write(&results, quiet)?;
    show(&results, arguments.format)
}
