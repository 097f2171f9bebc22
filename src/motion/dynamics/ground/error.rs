//! Errors of ground motions.

use std::ops::RangeInclusive;

use thiserror::Error;

use crate::argument::ArgumentError;

/// Largest time, in seconds, far beyond any real ground motion; sums, products and slopes stay in the range of an `f64`.
const MAX_TIME_S: f64 = 1e9;
/// Range of times since the start of the motion or of the simulation, in seconds.
pub const TIME_S: RangeInclusive<f64> = 0.0..=MAX_TIME_S;
/// Range of times on the clock of a record, in seconds.
pub const CLOCK_S: RangeInclusive<f64> = -MAX_TIME_S..=MAX_TIME_S;
/// Range of durations, in seconds.
pub const DURATION_S: RangeInclusive<f64> = 1e-12..=MAX_TIME_S;
/// Range of accelerations, in m/s2.
pub const ACCELERATION_M_S2: RangeInclusive<f64> = -1e12..=1e12;

/// Reason why a ground motion is not valid.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{0}")]
pub struct GroundError(pub(super) String);

impl From<ArgumentError> for GroundError {
    fn from(error: ArgumentError) -> Self {
        Self(error.to_string())
    }
}
