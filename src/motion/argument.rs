//! Error for an argument out of range.

use std::fmt::Display;
use std::ops::RangeInclusive;

pub use archrock_text::{format_fixed, plain, short};
use thiserror::Error;

/// Argument of a constructor that is out of range.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("`{argument} = {value:?}` is not allowed: it must be {allowed}")]
pub struct ArgumentError {
    /// Name of the argument, with its unit.
    pub argument: &'static str,
    /// Value of the argument.
    pub value: f64,
    /// Allowed range, in words.
    pub allowed: String,
}

impl ArgumentError {
    /// Error for a value.
    pub fn new(argument: &'static str, value: f64, allowed: impl Into<String>) -> Self {
        Self {
            argument,
            value,
            allowed: allowed.into(),
        }
    }
}

/// The value if the condition holds.
///
/// # Errors
/// If the condition does not hold. The error names the allowed values.
pub fn require(
    holds: bool,
    argument: &'static str,
    value: f64,
    allowed: impl Display,
) -> Result<f64, ArgumentError> {
    if holds {
        return Ok(value);
    }
    Err(ArgumentError::new(argument, value, allowed.to_string()))
}

/// The value if it is in the range; NaN never is.
pub fn require_within(
    argument: &'static str,
    value: f64,
    range: RangeInclusive<f64>,
) -> Result<f64, ArgumentError> {
    if range.contains(&value) {
        return Ok(value);
    }
    let (low, high) = (short(*range.start()), short(*range.end()));
    let allowed = format!("a number from {low} to {high}");
    Err(ArgumentError::new(argument, value, allowed))
}

/// The count if it is in the range.
pub fn require_count(
    argument: &'static str,
    count: usize,
    range: RangeInclusive<usize>,
) -> Result<usize, ArgumentError> {
    let allowed = format_args!("from {} to {}", range.start(), range.end());
    require(range.contains(&count), argument, count as f64, allowed)?;
    Ok(count)
}

/// The value if it is above the first bound and at most the second one; NaN never is.
pub fn require_above(
    argument: &'static str,
    value: f64,
    low: f64,
    high: f64,
) -> Result<f64, ArgumentError> {
    let allowed = format_args!("a number above {} and at most {}", short(low), short(high));
    require(value > low && value <= high, argument, value, allowed)
}

/// Rounds up to four significant digits, so that a bound in a message is itself allowed.
pub fn rounded_up(x: f64) -> f64 {
    let unit = digits_factor(x, 4.0);
    (x * unit).ceil() / unit
}

/// Rounds down to six significant digits, so that a bound in a message is itself allowed.
pub fn rounded_down(x: f64) -> f64 {
    let unit = digits_factor(x, 6.0);
    (x * unit).floor() / unit
}

/// Factor that gives a positive number `digits` digits before the decimal point.
fn digits_factor(x: f64, digits: f64) -> f64 {
    libm::pow(10.0, digits - 1.0 - libm::log10(x).floor())
}
