//! The command `capacity`.

use archrock::studies::catalogue::{CAPACITY, Options};
use nalgebra::Vector2;

use super::Failure;
use super::figure::FigureOption;
use super::number::point_m;
use super::short_study::{CommonArguments, run_short_study};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    common: CommonArguments,
    /// Control point in metres, such as `--point 0,5.4` [default: the crown, or the top of a column].
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point_m)]
    point: Option<Vector2<f64>>,
    #[command(flatten)]
    figure: FigureOption,
}

pub fn capacity(arguments: &Arguments) -> Result<(), Failure> {
    let options = Options {
        point_m: arguments.point,
        ..Options::default()
    };
    run_short_study(CAPACITY, &arguments.common, arguments.figure, options)
}
