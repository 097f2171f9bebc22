//! The clock of a motion: its steps, and the times of its samples.

use crate::dynamics::fall;

/// A start within this fraction of the output step before a multiple of it counts as that multiple.
const ALIGNED: f64 = 1e-6;

/// How long a motion is computed, and in which steps.
#[derive(Clone, Copy)]
pub struct Clock {
    /// Longest step in seconds.
    pub longest_step_s: f64,
    /// Whether steps may be halved where the energy balance needs it.
    pub may_halve: bool,
    /// Shortest step in seconds.
    pub shortest_step_s: f64,
    /// When to stop at the latest, in seconds.
    pub end_s: f64,
    /// Time between samples in seconds; if `None`, there are none. Steps end there whether or not samples are wanted.
    pub output_step_s: Option<f64>,
}

/// The times at which samples are due and steps end: the start, and multiples of the output step after it.
pub struct Marks {
    pub(super) clock: Clock,
    start_s: f64,
    /// The next multiple; before the start, the start is next.
    passed: f64,
}

impl Marks {
    pub fn new(clock: Clock, start_s: f64) -> Self {
        let steps = clock.output_step_s.map_or(0.0, |step_s| start_s / step_s);
        Self {
            clock,
            start_s,
            passed: (steps + ALIGNED).floor(),
        }
    }

    /// The marks of a fall from this time on.
    pub(super) fn of_fall(clock: Clock, from_s: f64) -> Self {
        let given_s = clock.output_step_s.unwrap_or(f64::INFINITY);
        let step_s = given_s.min(fall::SAMPLED_S);
        let clock = Clock {
            end_s: from_s + fall::LONGEST_S,
            output_step_s: Some(step_s),
            ..clock
        };
        Self {
            clock,
            start_s: from_s,
            passed: (from_s / step_s).floor() + 1.0,
        }
    }

    fn mark_s(&self) -> f64 {
        let Some(step_s) = self.clock.output_step_s else {
            return f64::INFINITY;
        };
        let mark_s = self.passed * step_s;
        if mark_s < self.start_s + ALIGNED * step_s {
            self.start_s
        } else {
            mark_s
        }
    }

    /// Whether a sample is due.
    pub fn is_due(&self, time_s: f64) -> bool {
        time_s >= self.mark_s() - 1e-9 * self.clock.shortest_step_s
    }

    pub fn pass(&mut self) {
        self.passed += 1.0;
    }

    /// Time of the next end of a step.
    pub fn next_s(&self) -> f64 {
        self.mark_s().min(self.clock.end_s)
    }
}
