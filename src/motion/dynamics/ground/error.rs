//! Errors of ground motions.

use thiserror::Error;

use crate::argument::{ArgumentError, within};

/// Durations, spacings of samples and times in seconds that a ground motion may have. Far wider than any
/// real ground motion; no sum, product or slope of them leaves the range of an `f64`.
const MIN_STEP_S: f64 = 1e-12;
const MAX_TIME_S: f64 = 1e9;
/// Magnitudes of accelerations, in m/s2.
const MAX_ACCELERATION_M_S2: f64 = 1e12;

/// Why a ground motion cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GroundError {
    /// An argument is outside its range.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// A line needs two samples.
    #[error("`{argument}` has too few samples ({count}): it must have at least 2")]
    TooFewSamples {
        /// Name of the argument.
        argument: &'static str,
        /// Its number of samples.
        count: usize,
    },
    /// A sample is not allowed.
    #[error("sample {index} of `{argument}`: {fault}")]
    Sample {
        /// Name of the argument.
        argument: &'static str,
        /// Place of the sample, from 0.
        index: usize,
        /// What is wrong with it.
        fault: ArgumentError,
    },
    /// Times do not rise.
    #[error(
        "sample {index} of `{argument}` is at {time_s:?} s and the one before at {before_s:?} s: times must rise by \
         at least 1e-8 s"
    )]
    Order {
        /// Name of the argument.
        argument: &'static str,
        /// Place of the sample, from 0.
        index: usize,
        /// Its time.
        time_s: f64,
        /// Time of the sample before.
        before_s: f64,
    },
}

/// A time since the start of the motion or of the simulation.
pub(super) fn time_s(argument: &'static str, value: f64) -> Result<f64, ArgumentError> {
    within(argument, value, 0.0..=MAX_TIME_S)
}

/// A time on the clock of a record.
pub(super) fn clock_s(argument: &'static str, value: f64) -> Result<f64, ArgumentError> {
    within(argument, value, -MAX_TIME_S..=MAX_TIME_S)
}

/// A length of time that is not zero.
pub(super) fn duration_s(argument: &'static str, value: f64) -> Result<f64, ArgumentError> {
    within(argument, value, MIN_STEP_S..=MAX_TIME_S)
}

pub(super) fn acceleration_m_s2(argument: &'static str, value: f64) -> Result<f64, ArgumentError> {
    within(
        argument,
        value,
        -MAX_ACCELERATION_M_S2..=MAX_ACCELERATION_M_S2,
    )
}
