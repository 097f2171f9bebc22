//! Thrust line in a history: measures the validity of the four-link assumption.

use super::peak::Peak;
use crate::mechanics::chain::Demand;

/// Largest thrust excess and friction demand of a history, and the fraction of its rocking time in which the thrust line stays (almost) inside.
///
/// The values are from output samples: peaks between samples are missed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThrustRecord {
    /// Largest excess of the thrust line over the thickness, and the time at which it is first reached, in seconds.
    pub largest_excess: Peak,
    /// Largest friction coefficient required to prevent sliding.
    pub largest_friction: Peak,
    /// Number of samples in motion.
    moving: u64,
    /// Number of samples in motion with an excess of at most each of [`EXCESS_LEVELS`].
    within: [u64; 2],
}

/// Levels of the excess, over the thickness, for the fractions of time. They grade the assumption and do not bound the error of the motion. Peaks
/// with free hinges differed by 3 % for seven voussoirs with an excess of 0.05, and by 23 % for a continuous semicircle with an excess of 0.02.
pub const EXCESS_LEVELS: [f64; 2] = [0.01, 0.05];

impl ThrustRecord {
    /// Adds a sample; `moving` is false at rest.
    pub fn note(&mut self, time_s: f64, moving: bool, demand: &Demand) {
        self.largest_excess.note(demand.excess_ratio, time_s);
        self.largest_friction.note(demand.friction, time_s);
        if moving {
            self.moving += 1;
            for (count, level) in self.within.iter_mut().zip(EXCESS_LEVELS) {
                *count += u64::from(demand.excess_ratio <= level);
            }
        }
    }

    /// Returns the fractions of the time in motion in which the excess is at most each of [`EXCESS_LEVELS`]; `None` if no sample is in motion.
    #[must_use]
    pub fn shares_within(&self) -> Option<[f64; 2]> {
        (self.moving > 0).then(|| self.within.map(|count| count as f64 / self.moving as f64))
    }
}
