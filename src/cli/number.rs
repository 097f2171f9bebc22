//! Parsers of numbers in options.

use std::ops::RangeInclusive;

use nalgebra::Vector2;

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
