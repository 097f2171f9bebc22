//! The request for a history: how long it lasts, and how accurate it is.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use serde::Serialize;

use super::ground::GroundMotion;
use crate::argument::{ArgumentError, allow, within};
use crate::mechanics::sway::Sway;

/// A request for a history: how long it lasts, and how accurate it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Acceleration of gravity, in 0.001 to 1000.
    pub gravity_m_s2: f64,
    /// Upper bound of the time, in 1e-6 to 1e6: a history ends earlier if the structure overturns, or rests on ground that stays
    /// quiet.
    pub end_s: f64,
    /// Interval of the samples, in 1e-6 to 1e6, of which there are at most 1e7. Some models end their steps there.
    pub output_step_s: f64,
    /// The start of the motion; `None`: from rest.
    pub initial: Option<Initial>,
    /// Error that the integrator may make in a step, relative to the state, in 1e-13 to 1e-3.
    pub relative_tolerance: f64,
    /// An impact that leaves less than this fraction of the energy barrier of the first mechanism ends in rest; in 1e-16 to 0.1.
    pub rest_energy_ratio: f64,
}

/// A rotated position from which a structure is released at no velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Initial {
    /// The side to which it has swayed.
    pub sway: Sway,
    /// Magnitude of the rotation of the body that carries the coordinate: the end body on the side from which
    /// the structure sways (the left one of a sway to the right), or the column.
    pub rotation_rad: f64,
}

impl Initial {
    /// Smallest rotation that a structure can be released from: the energy of a smaller one may vanish in rounding.
    pub const MIN_ROTATION_RAD: f64 = 1e-100;

    /// Refuses a rotation that is not below the limit position of the first mechanism.
    pub(super) fn check(self, limit_rad: f64) -> Result<(), ArgumentError> {
        let rotation_rad = self.rotation_rad;
        let allowed =
            format_args!("below {limit_rad:?}, the limit position of the first mechanism");
        allow(
            rotation_rad < limit_rad,
            "rotation_rad",
            rotation_rad,
            allowed,
        )
        .map(drop)
    }
}

impl Default for Request {
    /// Ten seconds from rest under gravity of 9.81 m/s2, with the defaults of a scenario.
    fn default() -> Self {
        Self {
            gravity_m_s2: 9.81,
            end_s: 10.0,
            output_step_s: 0.005,
            initial: None,
            relative_tolerance: 1e-9,
            rest_energy_ratio: 1e-8,
        }
    }
}

impl Request {
    /// Accelerations of gravity.
    pub const GRAVITY_M_S2: RangeInclusive<f64> = 1e-3..=1e3;
    /// Lengths of a history, and intervals of its samples. At shorter times the errors of a step fall below the resolution of
    /// numbers.
    pub const TIME_S: RangeInclusive<f64> = 1e-6..=1e6;
    /// Tolerances of the integrator.
    pub const RELATIVE_TOLERANCE: RangeInclusive<f64> = 1e-13..=1e-3;
    /// Energies at which a structure is at rest.
    pub const REST_ENERGY_RATIO: RangeInclusive<f64> = 1e-16..=0.1;
    /// Samples that a history may have: about a gigabyte of rows.
    pub const MOST_SAMPLES: f64 = 1e7;

    /// Largest number of samples of a history on this ground: one at the start, at every output step and at the end.
    #[must_use]
    pub fn most_samples(&self, ground: &GroundMotion) -> u64 {
        let before = if ground.start_s() < 0.0 { 1 } else { 0 };
        // Numbers that cannot count samples are refused elsewhere.
        (self.lasts_s(ground) / self.output_step_s) as u64 + 2 + before
    }

    /// Longest time from the start of the ground motion to the end of a history, in seconds.
    fn lasts_s(&self, ground: &GroundMotion) -> f64 {
        self.end_s - ground.start_s()
    }

    /// Refuses numbers that no simulation on this ground can work with.
    pub fn check(&self, ground: &GroundMotion) -> Result<(), ArgumentError> {
        let (tolerance, rest_ratio) = (self.relative_tolerance, self.rest_energy_ratio);
        for (argument, value, range) in [
            ("gravity_m_s2", self.gravity_m_s2, Self::GRAVITY_M_S2),
            ("end_s", self.end_s, Self::TIME_S),
            ("output_step_s", self.output_step_s, Self::TIME_S),
            ("relative_tolerance", tolerance, Self::RELATIVE_TOLERANCE),
            ("rest_energy_ratio", rest_ratio, Self::REST_ENERGY_RATIO),
        ] {
            within(argument, value, range)?;
        }
        if let Some(Initial { rotation_rad, .. }) = self.initial {
            within("rotation_rad", rotation_rad, Initial::MIN_ROTATION_RAD..=PI)?;
        }
        let lasts_s = self.lasts_s(ground);
        let (step_s, least_s) = (self.output_step_s, lasts_s / Self::MOST_SAMPLES);
        let allowed = format_args!("at least {least_s:?}, for ten million samples");
        let are_few = lasts_s / step_s <= Self::MOST_SAMPLES;
        allow(are_few, "output_step_s", step_s, allowed).map(drop)
    }
}
