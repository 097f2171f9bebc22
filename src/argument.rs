//! The error of an argument out of range.

use std::ops::RangeInclusive;

use thiserror::Error;

/// An argument of a constructor that is not allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("`{argument} = {value:?}` is not allowed: it must be {allowed}")]
pub struct ArgumentError {
    /// Name of the argument, with its unit.
    pub argument: &'static str,
    /// Its value.
    pub value: f64,
    /// What is allowed instead.
    pub allowed: String,
}

/// The value, if it is in the range; NaN never is.
pub(crate) fn within(
    argument: &'static str,
    value: f64,
    range: RangeInclusive<f64>,
) -> Result<f64, ArgumentError> {
    if range.contains(&value) {
        return Ok(value);
    }
    Err(ArgumentError {
        argument,
        value,
        allowed: format!(
            "a number from {} to {}",
            short(*range.start()),
            short(*range.end())
        ),
    })
}

/// The value, if it is above the first bound and at most the second; NaN never is.
pub(crate) fn above(
    argument: &'static str,
    value: f64,
    low: f64,
    high: f64,
) -> Result<f64, ArgumentError> {
    if value > low && value <= high {
        return Ok(value);
    }
    Err(ArgumentError {
        argument,
        value,
        allowed: format!("a number above {} and at most {}", short(low), short(high)),
    })
}

/// A bound as people write it: 1e6, not 1000000.0.
pub(crate) fn short(x: f64) -> String {
    if x != 0.0 && !(1e-3..1e5).contains(&x.abs()) {
        format!("{x:e}")
    } else {
        format!("{x}")
    }
}
