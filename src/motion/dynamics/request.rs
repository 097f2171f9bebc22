//! Request for a history: duration and accuracy.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use serde::Serialize;

use crate::argument::{ArgumentError, require, require_within};
use crate::dynamics::GroundMotion;
use crate::mechanics::Sway;

/// Request for a history: duration and accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Acceleration of gravity in m/s2, from 0.001 to 1000.
    pub gravity_m_s2: f64,
    /// Latest end in seconds, from 1e-6 to 1e6. A history ends earlier if the structure overturns, or rests on quiet ground.
    pub end_s: f64,
    /// Latest end of a history that would be incomplete at `end_s`, in seconds: the time after the ground motion is doubled until the outcome is known.
    /// A history with elastic joints then also ends once its energy is small and decays. `None`: all histories end at `end_s`.
    pub outcome_by_s: Option<f64>,
    /// Interval of the samples in seconds, from 1e-6 to 1e6, for at most 1e7 samples. Some models end their steps at samples.
    pub output_step_s: f64,
    /// Initial position and rate; `None` starts from rest.
    pub initial: Option<Initial>,
    /// Error tolerance of the integrator in a step, relative to the state, from 1e-13 to 1e-3.
    pub relative_tolerance: f64,
    /// Fraction of the energy barrier of the first mechanism, from 1e-16 to 0.1. An impact that leaves less energy ends in rest.
    pub rest_energy_ratio: f64,
}

/// Next end of a history that is incomplete at `end_s`, from [`Request::outcome_by_s`]; `None` if it must end there.
pub(super) fn later_end_s(
    outcome_by_s: Option<f64>,
    ground: &GroundMotion,
    end_s: f64,
) -> Option<f64> {
    let later_s = outcome_by_s.map(|latest_s| latest_s.min(2.0 * end_s - ground.end_s()));
    later_s.filter(|later_s| *later_s > end_s)
}

/// Rotated position from which a structure is released, or rate with which it starts, in the motion of its first mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Initial {
    /// Side of the sway.
    pub sway: Sway,
    /// Rotation, without sign, of the body that carries the coordinate, in radians: the end body on the side from which the structure sways (the left
    /// one in a sway to the right), or the column. Zero if the structure starts from its position at rest.
    pub rotation_rad: f64,
    /// Rate of this rotation in rad/s, negative towards the position at rest; positive if the structure starts from there.
    #[serde(skip_serializing_if = "is_zero")]
    pub rate_rad_s: f64,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Initial {
    /// Smallest initial rotation in radians: rounding errors may exceed the energy of a smaller one.
    pub const MIN_ROTATION_RAD: f64 = 1e-100;
    /// Range of initial rates, in rad/s. The largest rate overturns every column with a half diagonal above 1.5 mm.
    pub const RATE_RAD_S: RangeInclusive<f64> = -1e2..=1e2;

    /// Whether the structure moves after the start: it is rotated, or has a rate away from its position at rest.
    pub fn moves(self) -> bool {
        self.rotation_rad >= Self::MIN_ROTATION_RAD
            || (self.rotation_rad == 0.0 && self.rate_rad_s >= Self::MIN_ROTATION_RAD)
    }

    /// Checks that the rotation is below the limit position of the first mechanism.
    ///
    /// # Errors
    /// If the rotation is not below it.
    pub(super) fn check(self, limit_rad: f64) -> Result<(), ArgumentError> {
        let rotation_rad = self.rotation_rad;
        let allowed =
            format_args!("below {limit_rad:?}, the limit position of the first mechanism");
        let fits = rotation_rad < limit_rad;
        require(fits, "rotation_rad", rotation_rad, allowed).map(drop)
    }
}

impl Default for Request {
    /// Request for ten seconds from rest under 9.81 m/s2, with the defaults of a scenario.
    fn default() -> Self {
        Self {
            gravity_m_s2: 9.81,
            end_s: 10.0,
            outcome_by_s: None,
            output_step_s: 0.005,
            initial: None,
            relative_tolerance: 1e-9,
            rest_energy_ratio: 1e-8,
        }
    }
}

impl Request {
    /// Range of the acceleration of gravity, in m/s2.
    pub const GRAVITY_M_S2: RangeInclusive<f64> = 1e-3..=1e3;
    /// Range of durations and sample intervals, in seconds. At shorter times the errors of a step are below the resolution of floating-point numbers.
    pub const TIME_S: RangeInclusive<f64> = 1e-6..=1e6;
    /// Range of the tolerance of the integrator.
    pub const RELATIVE_TOLERANCE: RangeInclusive<f64> = 1e-13..=1e-3;
    /// Range of the energy at which a structure rests, over the barrier.
    pub const REST_ENERGY_RATIO: RangeInclusive<f64> = 1e-16..=0.1;
    /// Maximum number of samples of a history: about a gigabyte of rows.
    pub const MOST_SAMPLES: f64 = 1e7;

    /// Maximum number of samples of a history on this ground: one at the start, at every output step and at the end.
    pub fn most_samples(&self, ground: &GroundMotion) -> u64 {
        let before = if ground.start_s() < 0.0 { 1 } else { 0 };
        // Invalid numbers are rejected elsewhere.
        (self.lasts_s(ground) / self.output_step_s) as u64 + 2 + before
    }

    /// Longest time from the start of the ground motion to the end of a history, in seconds.
    fn lasts_s(&self, ground: &GroundMotion) -> f64 {
        self.end_s - ground.start_s()
    }

    /// Checks all numbers for a simulation on this ground.
    ///
    /// # Errors
    /// If a number is out of range, or there are too many samples.
    pub fn check(&self, ground: &GroundMotion) -> Result<(), ArgumentError> {
        let (tolerance, rest_ratio) = (self.relative_tolerance, self.rest_energy_ratio);
        for (argument, value, range) in [
            ("gravity_m_s2", self.gravity_m_s2, Self::GRAVITY_M_S2),
            ("end_s", self.end_s, Self::TIME_S),
            ("output_step_s", self.output_step_s, Self::TIME_S),
            ("relative_tolerance", tolerance, Self::RELATIVE_TOLERANCE),
            ("rest_energy_ratio", rest_ratio, Self::REST_ENERGY_RATIO),
        ] {
            require_within(argument, value, range)?;
        }
        if let Some(initial) = self.initial {
            let rotation_rad = require_within("rotation_rad", initial.rotation_rad, 0.0..=PI)?;
            require_within("rate_rad_s", initial.rate_rad_s, Initial::RATE_RAD_S)?;
            let allowed = "at least 1e-100, or 0 with a positive `rate_rad_s`";
            require(initial.moves(), "rotation_rad", rotation_rad, allowed)?;
        }
        let lasts_s = self.lasts_s(ground);
        let (step_s, least_s) = (self.output_step_s, lasts_s / Self::MOST_SAMPLES);
        let allowed = format_args!("at least {least_s:?}, for ten million samples");
        let are_few = lasts_s / step_s <= Self::MOST_SAMPLES;
        require(are_few, "output_step_s", step_s, allowed).map(drop)
    }
}
