//! Parsers of the values of options.

use std::ops::RangeInclusive;

use archrock::Sway;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use nalgebra::Vector2;

/// The option of commands that describe one chain of mechanisms: an asymmetric structure has two.
#[derive(clap::Args, Clone, Copy)]
pub struct FirstOption {
    /// The side to which the structure sways first, for results and pictures that show one side only [default: right, or away from a wall behind a
    /// column].
    #[arg(long = "first", value_name = "SIDE", value_parser = side(["right", "left"]))]
    pub sway: Option<Sway>,
}

/// Parses a side. `names` are both names in the order of the help.
pub fn side(names: [&'static str; 2]) -> impl TypedValueParser<Value = Sway> {
    PossibleValuesParser::new(names).map(|name| match name == Sway::Left.name() {
        true => Sway::Left,
        false => Sway::Right,
    })
}

/// Parses a number in a range. `remedy` is the error message.
pub fn number(text: &str, range: RangeInclusive<f64>, remedy: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| remedy.to_owned())
}

/// Parses the coordinates of a point, in metres.
pub fn point_m(text: &str) -> Result<Vector2<f64>, String> {
    const REMEDY: &str = "give two coordinates in metres, such as 0,4.2";
    let (x, y) = text.split_once(',').ok_or(REMEDY)?;
    let coordinate = |text: &str| number(text.trim(), -1e9..=1e9, REMEDY);
    Ok(Vector2::new(coordinate(x)?, coordinate(y)?))
}
