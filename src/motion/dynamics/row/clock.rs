//! The clock of a motion: its steps, and the times of its samples.

use super::error::RowMotionError;
use crate::dynamics::fall;

/// A start within this fraction of the output step before a multiple of it counts as that multiple.
const ALIGNED: f64 = 1e-6;

/// Settings of the computation of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Longest step in seconds.
    pub longest_step_s: f64,
    /// Whether steps may be halved where the energy balance needs it.
    pub may_halve: bool,
    /// Landings that crowd within this time, in seconds, are taken as one.
    pub shortest_step_s: f64,
    /// Number of impacts within the shortest step after which landings crowd.
    pub merged_after: usize,
    /// Latest end, in seconds.
    pub end_s: f64,
    /// Time between samples in seconds; if `None`, there are none. Steps end there whether or not samples are wanted.
    pub output_step_s: Option<f64>,
    /// Coulomb's coefficient of friction at every joint; if `None`, joints do not slip.
    pub friction_coefficient: Option<f64>,
}

impl Settings {
    /// These settings, if a motion takes at most so many steps.
    pub fn within(self, most_steps: f64, remedy: &str) -> Result<Self, RowMotionError> {
        let (end_s, steps) = (self.end_s, self.end_s / self.longest_step_s);
        if steps <= most_steps {
            return Ok(self);
        }
        let why = format!("a motion of {end_s} s takes {steps:.1e} steps: {remedy}");
        Err(RowMotionError::Failed(why))
    }
}

/// The times at which samples are due and steps end: the start, and multiples of the output step after it.
pub struct Marks {
    pub(super) settings: Settings,
    start_s: f64,
    /// The next multiple; before the start, the start is next.
    passed: f64,
}

impl Marks {
    pub fn new(settings: Settings, start_s: f64) -> Self {
        let step_s = settings.output_step_s;
        let steps = step_s.map_or(0.0, |step_s| start_s / step_s);
        Self {
            settings,
            start_s,
            passed: (steps + ALIGNED).floor(),
        }
    }

    /// The marks of a fall from this time on.
    pub(super) fn of_fall(settings: Settings, from_s: f64) -> Self {
        let given_s = settings.output_step_s.unwrap_or(f64::INFINITY);
        let step_s = given_s.min(fall::SAMPLED_S);
        let settings = Settings {
            end_s: from_s + fall::LONGEST_S,
            output_step_s: Some(step_s),
            ..settings
        };
        Self {
            settings,
            start_s: from_s,
            passed: (from_s / step_s).floor() + 1.0,
        }
    }

    fn mark_s(&self) -> f64 {
        let Some(step_s) = self.settings.output_step_s else {
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
        time_s >= self.mark_s() - 1e-9 * self.settings.shortest_step_s
    }

    pub fn pass(&mut self) {
        self.passed += 1.0;
    }

    /// Time of the next end of a step.
    pub fn next_s(&self) -> f64 {
        self.mark_s().min(self.settings.end_s)
    }
}
