//! Rest of a row with elastic joints: the time since which its rotations and its energy hardly change.

/// Change of a rotation, over the largest rotation of the motion, below which a row is still.
const ROTATION_RATIO: f64 = 0.01;
/// Energy, over the barrier, below which a row is still.
const BARRIER_RATIO: f64 = 1e-4;

/// Observes whether a row is still.
pub(super) struct Stillness {
    /// Time since which the row is still, in seconds.
    pub since_s: f64,
    /// Energy below which the row is still, in J.
    pub limit_j: f64,
    /// Least and largest values since then: rotations of the blocks in rad, then the potential energy in J.
    ranges: Vec<[f64; 2]>,
}

impl Stillness {
    /// Observer of a row with this energy barrier. Energies below `least_j` always count as none.
    pub fn new(barrier_j: f64, least_j: f64) -> Self {
        Self {
            since_s: f64::NEG_INFINITY,
            limit_j: least_j.max(BARRIER_RATIO * barrier_j),
            ranges: Vec::new(),
        }
    }

    /// Records the state after a step. `peak_rad` is the largest rotation up to now.
    pub fn record_step(
        &mut self,
        time_s: f64,
        [kinetic_j, potential_j]: [f64; 2],
        rotations_rad: impl Iterator<Item = f64> + Clone,
        peak_rad: f64,
    ) {
        let values = || rotations_rad.clone().chain([potential_j]);
        let mut still = kinetic_j < self.limit_j && !self.ranges.is_empty();
        if still {
            let last = self.ranges.len() - 1;
            for (index, (range, value)) in self.ranges.iter_mut().zip(values()).enumerate() {
                *range = [range[0].min(value), range[1].max(value)];
                let most = if index < last {
                    ROTATION_RATIO * peak_rad
                } else {
                    self.limit_j
                };
                still &= range[1] - range[0] < most;
            }
        }
        if !still {
            self.since_s = time_s;
            self.ranges.clear();
            self.ranges.extend(values().map(|value| [value; 2]));
        }
    }
}
