//! The command `capacity`.

use archrock::studies::catalogue::{CAPACITY, Options};
use nalgebra::Vector2;

use super::Failure;
use super::at_once::{CommonArguments, at_once};
use super::figure::FigureOption;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    common: CommonArguments,
    /// Control point in metres, such as `--point 0,5.4` [default: the crown, or the top of a column].
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    point: Option<Vector2<f64>>,
    #[command(flatten)]
    figure: FigureOption,
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

pub fn capacity(arguments: &Arguments) -> Result<(), Failure> {
    let options = Options {
        point_m: arguments.point,
        ..Options::default()
    };
    let figure = Some(arguments.figure);
    at_once(CAPACITY, &arguments.common, figure, &options)
}
