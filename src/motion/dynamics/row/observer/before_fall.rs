//! The results up to the last time from which the row may have fallen without return.

use super::MotionObserver;
use crate::dynamics::history::{Stress, TieSummary};
use crate::dynamics::thrust::Until;
use crate::dynamics::{HalfCycle, ThrustRecord};

/// Results up to a time.
#[derive(Clone, Default)]
pub(super) struct PartialResults {
    time_s: f64,
    peak_rotations_rad: Vec<f64>,
    /// Number of completed half cycles, and the current one.
    half_cycles: usize,
    cycle: Option<HalfCycle>,
    thrust: ThrustRecord,
    pub(super) friction: Until,
    largest_slips_m: Vec<f64>,
    largest_stress: Stress,
    ties: Vec<TieSummary>,
}

impl PartialResults {
    /// Makes the results of a motion of so many blocks that begins.
    pub(super) fn at_start(time_s: f64, blocks: usize) -> Self {
        Self {
            time_s,
            peak_rotations_rad: vec![0.0; blocks],
            ..Self::default()
        }
    }
}

impl MotionObserver<'_> {
    /// Records the results at this time, at which the row can still return.
    pub fn save_results_before_fall(&mut self) {
        let before_fall = &mut self.before_fall;
        before_fall.time_s = self.time;
        let peaks_rad = &self.peak_rotations_rad;
        before_fall.peak_rotations_rad.clone_from(peaks_rad);
        before_fall.half_cycles = self.row_summary.half_cycles.len();
        before_fall.cycle = self.cycle.current;
        before_fall.thrust = self.thrust;
        before_fall.friction = self.friction.until_now();
        before_fall.largest_stress = self.elastic.largest_stress;
        if let Some(sliding) = &self.row_summary.sliding {
            let slips_m = &sliding.largest_offsets_m;
            before_fall.largest_slips_m.clone_from(slips_m);
        }
        before_fall.ties.clone_from(&self.row_summary.ties);
        self.settle(self.time);
    }

    /// Whether the row can still return at this time.
    pub fn returns(&self) -> bool {
        self.before_fall.time_s == self.time
    }

    /// Resets the results to those at the last time at which the row could still return.
    pub(super) fn restore_results(&mut self, before_fall: PartialResults) {
        self.peak_rotations_rad = before_fall.peak_rotations_rad;
        self.row_summary
            .half_cycles
            .truncate(before_fall.half_cycles);
        self.cycle.current = None;
        if let Some(mut cycle) = before_fall.cycle {
            cycle.duration_s = before_fall.time_s - cycle.start_s;
            self.row_summary.half_cycles.push(cycle);
        }
        self.thrust = before_fall.thrust;
        self.elastic.largest_stress = before_fall.largest_stress;
        if let Some(sliding) = &mut self.row_summary.sliding {
            sliding.largest_offsets_m = before_fall.largest_slips_m;
        }
        for (tie, before) in self.row_summary.ties.iter_mut().zip(before_fall.ties) {
            *tie = before;
        }
    }
}
