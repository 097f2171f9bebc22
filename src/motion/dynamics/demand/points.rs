//! Spectrum given by points, with linear interpolation.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{damping_factor, displacement_m};

/// Accelerations at increasing periods, at one damping.
#[readonly::make]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointSpectrum {
    /// Damping of the given spectrum, in per cent.
    pub damping_percent: f64,
    /// Periods in seconds, and accelerations in g.
    #[serde(rename = "points_s_g")]
    pub points: Vec<(f64, f64)>,
}

/// Reason why points do not form a spectrum.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{reason}")]
pub struct PointError {
    /// Index of the wrong row, from 0; `None` if there are too few rows.
    pub row: Option<usize>,
    reason: String,
}

/// Error for a period outside the given ones.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the spectrum is given from {:?} to {:?} s, and is needed at {period_s:?} s: add rows", .given_s[0], .given_s[1])]
pub struct PeriodOutOfRange {
    /// The period that is needed, in seconds.
    pub period_s: f64,
    /// First and last period that are given, in seconds.
    pub given_s: [f64; 2],
}

impl PointSpectrum {
    /// Spectrum through points: period in seconds, acceleration in g, at a damping in per cent.
    ///
    /// # Errors
    /// When there are fewer than two points, periods do not rise, or a number is not allowed.
    pub fn new(points: Vec<(f64, f64)>, damping_percent: f64) -> Result<Self, PointError> {
        let wrong = |row, reason| Err(PointError { row, reason });
        if points.len() < 2 {
            let reason = "has fewer than two rows; give a row for each corner of the spectrum";
            return wrong(None, reason.to_owned());
        }
        let mut before_s = f64::NEG_INFINITY;
        for (row, (period_s, acceleration_g)) in points.iter().copied().enumerate() {
            let reason = if !(period_s >= 0.0 && period_s.is_finite()) {
                format!("the period {period_s:?} s must be a number of at least 0")
            } else if period_s <= before_s {
                format!(
                    "the period {period_s:?} s is not above the one before; sort the rows by period"
                )
            } else if !(acceleration_g > 0.0 && acceleration_g.is_finite()) {
                format!("the acceleration {acceleration_g:?} g must be a number above 0")
            } else {
                before_s = period_s;
                continue;
            };
            return wrong(Some(row), reason);
        }
        Ok(Self {
            points,
            damping_percent,
        })
    }

    /// Peak acceleration: that at the period zero, in g.
    ///
    /// # Errors
    /// When there is no row for it.
    pub fn peak_g(&self) -> Result<f64, PeriodOutOfRange> {
        // The peak acceleration does not depend on the damping.
        self.acceleration_g(0.0, self.damping_percent)
    }

    /// Spectral acceleration at a period and a damping, in g.
    ///
    /// # Errors
    /// When the period is not within the rows.
    pub fn acceleration_g(
        &self,
        period_s: f64,
        damping_percent: f64,
    ) -> Result<f64, PeriodOutOfRange> {
        let [from_s, to_s] = self.range_s();
        if !(from_s..=to_s).contains(&period_s) {
            return Err(PeriodOutOfRange {
                period_s,
                given_s: [from_s, to_s],
            });
        }
        let after = self
            .points
            .partition_point(|point| point.0 < period_s)
            .clamp(1, self.points.len() - 1);
        let (low, high) = (self.points[after - 1], self.points[after]);
        let part = (period_s - low.0) / (high.0 - low.0);
        Ok(self.scale(damping_percent) * (low.1 + part * (high.1 - low.1)))
    }

    /// Largest spectral displacement between two periods, in metres, and the period where it is: at an end, at a row, or where between
    /// two rows the acceleration `p + s T` makes `p T^2 + s T^3` largest, at `T = -2 p / (3 s)`.
    ///
    /// # Errors
    /// When the periods are not within the rows.
    pub fn largest_displacement(
        &self,
        periods_s: [f64; 2],
        damping_percent: f64,
        gravity_m_s2: f64,
    ) -> Result<(f64, f64), PeriodOutOfRange> {
        let [from_s, to_s] = periods_s;
        let within = |period_s: &f64| (from_s..=to_s).contains(period_s);
        let rows = self.points.iter().map(|point| point.0);
        let between = self.points.windows(2).filter_map(|pair| {
            let slope = (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
            let at_zero = pair[0].1 - slope * pair[0].0;
            let period_s = -2.0 * at_zero / (3.0 * slope);
            let between = pair[0].0..=pair[1].0;
            between.contains(&period_s).then_some(period_s)
        });
        let mut largest = (0.0, from_s);
        for period_s in rows.chain(between).filter(within).chain(periods_s) {
            let acceleration_g = self.acceleration_g(period_s, damping_percent)?;
            let own = displacement_m(acceleration_g, period_s, gravity_m_s2);
            if own > largest.0 {
                largest = (own, period_s);
            }
        }
        Ok(largest)
    }

    /// First and last period, in seconds.
    pub fn range_s(&self) -> [f64; 2] {
        [self.points[0].0, self.points[self.points.len() - 1].0]
    }

    fn scale(&self, damping_percent: f64) -> f64 {
        damping_factor(damping_percent) / damping_factor(self.damping_percent)
    }
}
