//! The command `spread`.

use archrock::mechanics::sway::Sway;
use archrock::studies::catalogue::{Options, SPREAD};
use archrock::studies::spread::Direction;
use clap::ValueEnum;

use super::Failure;
use super::figure::FigureOption;
use super::number::number;
use super::short_study::{CommonArguments, run_short_study};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    common: CommonArguments,
    /// The springing that moves.
    #[arg(long, value_enum, value_name = "SIDE", default_value_t)]
    springing: Side,
    /// Direction in degrees from outwards (0) over down (90) to inwards (180); up is -90. Can be repeated [default: 0, 180 and 90].
    #[arg(long = "angle", value_name = "DEG", allow_hyphen_values = true, value_parser = angle)]
    angles_deg: Vec<f64>,
    #[command(flatten)]
    figure: FigureOption,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum Side {
    Left,
    #[default]
    Right,
}

fn angle(text: &str) -> Result<f64, String> {
    let remedy = "give a direction in degrees, from -180 to 180";
    number(text.trim(), -180.0..=180.0, remedy)
}

pub fn spread(arguments: &Arguments) -> Result<(), Failure> {
    let springing = match arguments.springing {
        Side::Left => Sway::Left,
        Side::Right => Sway::Right,
    };
    let angles_deg = match &arguments.angles_deg[..] {
        [] => &Direction::DEFAULT_DEG[..],
        given => given,
    };
    let direction = |angle_deg: &f64| Direction {
        springing,
        angle_deg: *angle_deg,
    };
    let options = Options {
        directions: angles_deg.iter().map(direction).collect(),
        ..Options::default()
    };
    run_short_study(SPREAD, &arguments.common, arguments.figure, options)
}
