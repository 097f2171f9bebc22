//! The balance of the energy of an observed motion, and the steps that it needs.

use super::MotionObserver;
use crate::dynamics::{RowMotionError, Summary};

/// Error of the energy balance, over the largest energy of the motion, above which the computation fails.
pub const LARGEST_ENERGY_ERROR: f64 = 1e-2;

/// Least energy, over weight times size, that counts as motion; the balance of smaller energies is a rounding error.
const LEAST_ENERGY_RATIO: f64 = 1e-6;

/// Energy errors, over the largest allowed one, at which default steps are halved. The error then grows at least two times slower, four times with
/// elastic joints.
const HALVED_FROM: [f64; 4] = [0.6, 0.75, 0.85, 0.92];

impl MotionObserver<'_> {
    /// Records an error of the energy, in J.
    pub fn note_defect(&mut self, energy: f64) {
        let worst = &mut self.energy_defect_ratio;
        *worst = worst.max(energy / self.energy_unit);
    }

    /// Largest error of the energy balance up to now, over the largest energy of the motion or `barrier_j`, whichever is larger.
    pub fn energy_error(&self, barrier_j: f64) -> f64 {
        let kinetic_j = self.row_summary.largest_kinetic_j;
        let least_j = LEAST_ENERGY_RATIO * self.energy_unit;
        let defect_j = self.energy_defect_ratio * self.energy_unit;
        defect_j / kinetic_j.max(barrier_j).max(least_j)
    }

    /// Halves the steps a few times at most, if the error of the energy balance is too large relative to `scale_j` and to another energy, which takes
    /// longer to compute.
    pub fn halve_unbalanced_steps(&mut self, scale_j: f64, other_scale_j: impl FnOnce() -> f64) {
        let part = HALVED_FROM.get(self.row_summary.halvings as usize);
        let most = part.unwrap_or(&f64::INFINITY) * LARGEST_ENERGY_ERROR;
        if self.input.settings.may_halve
            && self.energy_error(scale_j) > most
            && self.energy_error(other_scale_j()) > most
        {
            self.longest_step_s *= 0.5;
            self.row_summary.halvings += 1;
            let shortest_s = &mut self.row_summary.shortest_step_s;
            *shortest_s = shortest_s.min(self.longest_step_s);
        }
    }
}

/// The summary if its energy balances.
///
/// # Errors
/// If the energy balance is wrong. The error names the model's table and proposes a step, in seconds.
pub fn require_balance(
    summary: Summary,
    table: &'static str,
    longest_step_s: f64,
) -> Result<Summary, RowMotionError> {
    let error = summary.row().map_or(0.0, |row| row.energy_error);
    if error > LARGEST_ENERGY_ERROR {
        return Err(RowMotionError::Energy {
            error,
            table,
            longest_step_s,
        });
    }
    Ok(summary)
}
