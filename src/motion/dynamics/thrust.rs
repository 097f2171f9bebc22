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
    /// Coefficient that prevents slip, except for short peaks of rows.
    pub fn required_coefficient(&self) -> f64 {
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

    /// Whether no half cycle has ended yet.
    pub const fn are_none(&self) -> bool {
        self.largest.is_none()
    }
}

/// Friction demands of the steps of a row.
#[derive(Clone, Debug, Default)]
pub(super) struct FrictionDemands {
    demands: Thinned,
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
    pub fn add_step(&mut self, demand: f64, [time_s, lasts_s]: [f64; 2], moves: bool) {
        self.demands.push(demand as f32, lasts_s as f32);
        self.until.steps += 1;
        self.until.largest.record_value(demand, time_s);
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

    /// Part of the history up to now.
    pub const fn until_now(&self) -> Until {
        self.until
    }

    /// Record of the part that counts: up to overturning if the row `overturned` from there, or else up to the end of the last strong
    /// half cycle. `None` if no step was noted.
    pub fn record(&mut self, overturned: Option<Until>) -> Option<FrictionRecord> {
        let of_motion = match self.half_cycles.are_none() {
            true => self.until,
            false => self.counted,
        };
        let counted = overturned.unwrap_or(of_motion);
        let demands = self.demands.first(counted.steps);
        (!demands.is_empty()).then(|| FrictionRecord {
            largest: counted.largest,
            lasting: Some(exceeded_for(demands, LASTING * counted.moving_s)),
        })
    }
}

/// Largest number of demands that a history keeps, 32 MiB of memory. A history of more steps keeps every second one, then every fourth and so on.
const MOST_DEMANDS: usize = 1 << 22;

/// Demands of steps, each with a duration in seconds: that of its step, or after thinning of the `stride` steps up to it.
#[derive(Clone, Debug)]
struct Thinned {
    kept: Vec<[f32; 2]>,
    /// Number of steps for each kept demand: a power of two.
    stride: usize,
    /// Number and duration of the steps after the last kept one.
    after: (usize, f32),
}

impl Default for Thinned {
    fn default() -> Self {
        Self {
            kept: Vec::new(),
            stride: 1,
            after: (0, 0.0),
        }
    }
}

impl Thinned {
    /// Adds the demand of the next step.
    fn push(&mut self, demand: f32, lasts_s: f32) {
        let (steps, before_s) = self.after;
        let lasts_s = before_s + lasts_s;
        if steps + 1 < self.stride {
            self.after = (steps + 1, lasts_s);
            return;
        }
        self.after = (0, 0.0);
        self.kept.push([demand, lasts_s]);
        if self.kept.len() == MOST_DEMANDS {
            self.stride *= 2;
            for index in 0..MOST_DEMANDS / 2 {
                let [[_, one_s], [demand, other_s]] =
                    [self.kept[2 * index], self.kept[2 * index + 1]];
                self.kept[index] = [demand, one_s + other_s];
            }
            self.kept.truncate(MOST_DEMANDS / 2);
        }
    }

    /// Kept demands of the first steps.
    fn first(&mut self, steps: usize) -> &mut [[f32; 2]] {
        let count = (steps / self.stride).min(self.kept.len());
        &mut self.kept[..count]
    }
}

/// Demand that is exceeded for a time, in seconds; the largest one for zero. Sorts the demands, which are given with the durations of their
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
        self.largest_excess
            .record_value(demand.excess_ratio, time_s);
    }

    /// Adds a sample; `moving` is false at rest.
    pub fn add_sample(&mut self, time_s: f64, moving: bool, demand: &Demand) {
        self.note_demand(time_s, demand);
        if moving {
            self.moving += 1;
            for (count, level) in self.within.iter_mut().zip(EXCESS_LEVELS) {
                *count += u64::from(demand.excess_ratio <= level);
            }
        }
    }

    /// Fractions of the time in motion in which the excess is at most each of [`EXCESS_LEVELS`]; `None` if no sample is in motion.
    pub fn shares_within(&self) -> Option<[f64; 2]> {
        (self.moving > 0).then(|| self.within.map(|count| count as f64 / self.moving as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A long history keeps a bounded number of demands, and the demand that a sine exceeds for a hundredth of its time: `cos(pi / 200)`.
    #[test]
    fn demands_of_a_long_history_take_bounded_memory() {
        let mut demands = FrictionDemands::default();
        let steps = 5 * MOST_DEMANDS / 2;
        for step in 0..steps {
            let time_s = 1e-3 * step as f64;
            // Steps of different lengths, as those at impacts.
            let lasts_s = if step % 7 == 0 { 1e-4 } else { 1e-3 };
            demands.add_step(libm::sin(0.37 * time_s).abs(), [time_s, lasts_s], true);
        }
        assert!(demands.demands.kept.len() <= MOST_DEMANDS);
        let lasts_s: f64 = demands
            .demands
            .kept
            .iter()
            .map(|[_, lasts_s]| f64::from(*lasts_s))
            .sum();
        let moving_s = demands.until.moving_s;
        assert!(
            (lasts_s / moving_s - 1.0).abs() < 1e-5,
            "{lasts_s} {moving_s}"
        );
        let record = demands.record(None).unwrap();
        let exceeded = libm::cos(std::f64::consts::PI / 200.0);
        assert!(
            (record.lasting.unwrap() - exceeded).abs() < 1e-5,
            "{record:?}"
        );
        assert!(record.largest.value > 1.0 - 1e-6);
    }
}
