//! Thrust line and friction in a history: the validity of the four-link assumption, and of the assumption that no joint slips.

use super::peak::Peak;
use crate::mechanics::Demand;

/// Largest thrust excess of a history, and the fraction of its rocking time in which the thrust line stays (almost) inside.
///
/// The largest excess is that of all steps of the computation, fractions of time those of the output samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThrustRecord {
    /// Largest excess of the thrust line over the thickness, and the time at which it is first reached, in seconds.
    pub largest_excess: Peak,
    /// Number of samples in motion.
    moving: u64,
    /// Number of samples in motion with an excess of at most each of [`EXCESS_LEVELS`].
    within: [u64; 2],
}

/// Levels of the excess, over the thickness, for the fractions of time. They grade the assumption and do not bound the error of the motion. Peaks
/// with free hinges differed by 3 % for seven voussoirs with an excess of 0.05, and by 23 % for a continuous semicircle with an excess of 0.02.
pub const EXCESS_LEVELS: [f64; 2] = [0.01, 0.05];

/// Friction coefficient that a motion without slip requires, outside impacts.
///
/// A history counts up to the end of its last half cycle whose peak is at least half of the largest, so that the demand does not depend on the time
/// at which the history ends. Without half cycles all of it counts; of a structure that overturns, the part up to overturning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionRecord {
    /// Largest coefficient, and the time at which it is first reached, in seconds.
    pub largest: Peak,
    /// Coefficient that a row of blocks requires for [`LASTING`] of its time in motion; `None` for mechanisms.
    pub lasting: Option<f64>,
}

impl FrictionRecord {
    /// Returns the coefficient that prevents slip, except for short peaks of rows.
    pub fn required(&self) -> f64 {
        self.lasting.unwrap_or(self.largest.value)
    }
}

/// Fraction of the time in motion for which the lasting friction demand is exceeded. Larger values of rows last so shortly that they depend on the
/// steps: forces just after impacts, or at almost unloaded joints.
pub const LASTING: f64 = 0.01;

/// Peak of a half cycle, over the largest peak up to its end, from which on friction demands count up to its end.
pub(super) const STRONG: f64 = 0.5;

/// Half cycles up to now.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HalfCycles {
    /// Largest peak up to now; `None` before the end of the first half cycle.
    largest: Option<f64>,
}

impl HalfCycles {
    /// Adds the peak of a half cycle that ends. Returns whether the motion up to its end counts in the friction demand. Later peaks cannot change
    /// this: if one of them is larger, the motion counts up to that one.
    pub fn end(&mut self, peak: f64) -> bool {
        let largest = self.largest.map_or(peak, |largest| largest.max(peak));
        self.largest = Some(largest);
        peak >= STRONG * largest
    }

    /// Returns whether no half cycle has ended yet.
    pub const fn are_none(&self) -> bool {
        self.largest.is_none()
    }
}

/// Friction demands of the steps of a row.
#[derive(Clone, Debug, Default)]
pub(super) struct FrictionDemands {
    /// Demands of the steps, each with the duration of its step in seconds.
    demands: Vec<[f32; 2]>,
    until: Until,
    /// Part that counts for sure.
    counted: Until,
    half_cycles: HalfCycles,
}

/// Part of a history up to a time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Until {
    /// Number of steps.
    steps: usize,
    /// Time in motion, in seconds.
    moving_s: f64,
    largest: Peak,
}

impl FrictionDemands {
    /// Adds a step of a row that ends at `time_s` and lasts `lasts_s`, in seconds. The row `moves` or is at rest.
    pub fn note(&mut self, demand: f64, [time_s, lasts_s]: [f64; 2], moves: bool) {
        self.demands.push([demand as f32, lasts_s as f32]);
        self.until.steps += 1;
        self.until.largest.note(demand, time_s);
        if moves {
            self.until.moving_s += lasts_s;
        }
    }

    /// Ends a half cycle with this peak.
    pub fn end_half_cycle(&mut self, peak_rad: f64) {
        if self.half_cycles.end(peak_rad) {
            self.counted = self.until;
        }
    }

    /// Returns the part of the history up to now.
    pub const fn until_now(&self) -> Until {
        self.until
    }

    /// Returns the record of the part that counts: up to overturning if the row `overturned` from there, or else up to the end of the last strong
    /// half cycle. `None` if no step was noted.
    pub fn record(&mut self, overturned: Option<Until>) -> Option<FrictionRecord> {
        let of_motion = match self.half_cycles.are_none() {
            true => self.until,
            false => self.counted,
        };
        let counted = overturned.unwrap_or(of_motion);
        let demands = self.demands.get_mut(..counted.steps)?;
        (!demands.is_empty()).then(|| FrictionRecord {
            largest: counted.largest,
            lasting: Some(exceeded_for(demands, LASTING * counted.moving_s)),
        })
    }
}

/// Returns the demand that is exceeded for a time, in seconds; the largest one for zero. Sorts the demands, which are given with the durations of their
/// steps.
fn exceeded_for(demands: &mut [[f32; 2]], time_s: f64) -> f64 {
    demands.sort_unstable_by(|a, b| b[0].total_cmp(&a[0]));
    let mut left_s = time_s;
    let lasts = |[_, lasts_s]: &&[f32; 2]| {
        left_s -= f64::from(*lasts_s);
        left_s <= 0.0
    };
    let lasting = demands.iter().find(lasts);
    lasting.map_or(0.0, |[demand, _]| f64::from(*demand))
}

/// Largest excess of the thrust line, over the thickness and up to the largest rotation, of histories that four links describe. Histories with a
/// larger one are outside the model: the mechanism cannot transmit its own forces. `docs/evidence.md` has the data from which it was chosen.
pub const MODEL_LIMIT: f64 = 0.5;

impl ThrustRecord {
    /// Adds the demand at an instant.
    pub(crate) fn note_demand(&mut self, time_s: f64, demand: &Demand) {
        self.largest_excess.note(demand.excess_ratio, time_s);
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
