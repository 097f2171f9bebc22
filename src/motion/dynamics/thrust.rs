//! Thrust line in a history: measures the validity of the four-link assumption.

use super::peak::Peak;
use crate::mechanics::Demand;

/// Largest thrust excess and friction demand of a history, and the fraction of its rocking time in which the thrust line stays (almost) inside.
///
/// Largest values are those of all steps of the computation, fractions of time those of the output samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThrustRecord {
    /// Largest excess of the thrust line over the thickness, and the time at which it is first reached, in seconds.
    pub largest_excess: Peak,
    /// Largest friction coefficient required to prevent sliding.
    pub largest_friction: Peak,
    /// Friction coefficient that a row of blocks requires for [`LASTING`] of its time in motion; `None` for mechanisms.
    pub lasting_friction: Option<f64>,
    /// Number of samples in motion.
    moving: u64,
    /// Number of samples in motion with an excess of at most each of [`EXCESS_LEVELS`].
    within: [u64; 2],
}

/// Levels of the excess, over the thickness, for the fractions of time. They grade the assumption and do not bound the error of the motion. Peaks
/// with free hinges differed by 3 % for seven voussoirs with an excess of 0.05, and by 23 % for a continuous semicircle with an excess of 0.02.
pub const EXCESS_LEVELS: [f64; 2] = [0.01, 0.05];

/// Fraction of the time in motion for which the lasting friction demand is exceeded. Larger values of rows last so shortly that they depend on the
/// steps: forces just after impacts, or at almost unloaded joints.
pub const LASTING: f64 = 0.01;

/// Friction demands of the steps of a row, each with the duration of its step in seconds.
#[derive(Clone, Debug, Default)]
pub(super) struct FrictionDemands {
    /// Time in motion, in seconds.
    pub moving_s: f64,
    pub demands: Vec<[f32; 2]>,
}

impl FrictionDemands {
    /// Adds a step of a row, which `moves` or is at rest.
    pub fn note(&mut self, demand: f64, lasts_s: f64, moves: bool) {
        self.demands.push([demand as f32, lasts_s as f32]);
        if moves {
            self.moving_s += lasts_s;
        }
    }

    /// Returns the demand that is exceeded for [`LASTING`] of the time in motion; the largest one without motion.
    pub fn lasting(&mut self) -> f64 {
        self.demands.sort_by(|a, b| b[0].total_cmp(&a[0]));
        let mut left_s = LASTING * self.moving_s;
        let lasts = |[_, lasts_s]: &&[f32; 2]| {
            left_s -= f64::from(*lasts_s);
            left_s <= 0.0
        };
        let lasting = self.demands.iter().find(lasts);
        lasting.map_or(0.0, |[demand, _]| f64::from(*demand))
    }
}

/// Largest excess of the thrust line, over the thickness and up to the largest rotation, of histories that four links describe. Histories with a
/// larger one are outside the model: the mechanism cannot transmit its own forces. `docs/evidence.md` has the data from which it was chosen.
pub const MODEL_LIMIT: f64 = 0.5;

impl ThrustRecord {
    /// Adds the demand at an instant.
    pub(crate) fn note_demand(&mut self, time_s: f64, demand: &Demand) {
        self.largest_excess.note(demand.excess_ratio, time_s);
        self.largest_friction.note(demand.friction, time_s);
    }

    /// Adds a sample; `moving` is false at rest.
    pub fn note(&mut self, time_s: f64, moving: bool, demand: &Demand) {
        self.note_demand(time_s, demand);
        if moving {
            self.moving += 1;
            for (count, level) in self.within.iter_mut().zip(EXCESS_LEVELS) {
                *count += u64::from(demand.excess_ratio <= level);
            }
        }
    }

    /// Returns the fractions of the time in motion in which the excess is at most each of [`EXCESS_LEVELS`]; `None` if no sample is in motion.
    pub fn shares_within(&self) -> Option<[f64; 2]> {
        (self.moving > 0).then(|| self.within.map(|count| count as f64 / self.moving as f64))
    }
}
