//! The half cycles of an observed motion.

use std::mem;

use super::{MotionObserver, side_of};
use crate::dynamics::HalfCycle;

/// Potential energy, over the largest one of a half cycle, above which the blocks have not turned back when the centre of gravity changes its side.
const TURNED_BACK: f64 = 0.5;

/// The current half cycle.
#[derive(Default)]
pub(super) struct CurrentHalfCycle {
    /// `None` before the first one, and after the end.
    pub(super) current: Option<HalfCycle>,
    /// Its largest potential energy, in J.
    highest_j: f64,
    /// The energy at its beginning, in J; `None` of the first one.
    energy_j: Option<f64>,
}

impl MotionObserver<'_> {
    /// Updates the half cycles after a step, from the largest rotation of a block, in radians.
    pub(super) fn note_half_cycle(&mut self, largest: f64) {
        if self.sway.abs() > self.least_sway_kg_m {
            let side = side_of(self.sway);
            if self.cycle.current.is_none_or(|cycle| cycle.sway != side) {
                let feet_part = self.input.ground.right_foot_of(self.input.row).is_some();
                let is_high = self.potential > TURNED_BACK * self.cycle.highest_j;
                let continues = self.cycle.current.is_some() && is_high && !feet_part;
                self.end_cycle(Some(self.kinetic + self.potential));
                self.cycle.highest_j = self.potential;
                self.cycle.current = Some(HalfCycle {
                    sway: side,
                    start_s: self.time,
                    peak_time_s: self.time,
                    continues,
                    ..HalfCycle::default()
                });
            }
        }
        if let Some(cycle) = &mut self.cycle.current
            && largest > cycle.peak_rad
        {
            (cycle.peak_rad, cycle.peak_time_s) = (largest, self.time);
        }
        self.cycle.highest_j = self.cycle.highest_j.max(self.potential);
    }

    /// Completes the current half cycle, with the remaining energy if known.
    pub(super) fn end_cycle(&mut self, energy: Option<f64>) {
        if let Some(mut cycle) = self.cycle.current.take() {
            cycle.duration_s = self.time - cycle.start_s;
            let energies = energy.zip(self.cycle.energy_j);
            let ratio = energies.map(|(after, before)| after / before);
            cycle.energy_ratio = ratio.filter(|ratio| ratio.is_finite());
            self.friction.end_half_cycle(cycle.peak_rad);
            self.row_summary.half_cycles.push(cycle);
            self.cycle.energy_j = energy;
        }
    }

    /// Subtracts energy that an impact at this time dissipated in the step after it, in J, from the energy of the half cycle that began with the
    /// impact.
    pub fn subtract_late_dissipation(&mut self, taken_j: f64) {
        if self
            .cycle
            .current
            .is_none_or(|cycle| cycle.start_s != self.time)
        {
            return;
        }
        let Some(energy) = &mut self.cycle.energy_j else {
            return;
        };
        let before = mem::replace(energy, *energy - taken_j);
        let ended = self.row_summary.half_cycles.last_mut();
        if let Some(ratio) = ended.and_then(|cycle| cycle.energy_ratio.as_mut()) {
            *ratio *= *energy / before;
        }
    }
}
