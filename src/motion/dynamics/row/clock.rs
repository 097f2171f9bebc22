//! Steps of a motion, and times of its samples.

use crate::argument::plain;
use crate::dynamics::{RowMotionError, fall};

/// Relative tolerance, in output steps, within which a start before a multiple of the output step counts as that multiple.
const ALIGNED: f64 = 1e-6;

/// Numerical settings of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Longest step, in seconds.
    pub longest_step_s: f64,
    /// True if steps may be halved after errors of the energy balance.
    pub may_halve: bool,
    /// Time, in seconds, within which landings are merged if impacts are too frequent.
    pub shortest_step_s: f64,
    /// Number of impacts within the shortest step after which landings are merged.
    pub merged_after: usize,
    /// End of the motion, in seconds.
    pub end_s: f64,
    /// Latest end of a motion that is incomplete at its end, in seconds; see [`Request`](crate::dynamics::request::Request).
    pub outcome_by_s: Option<f64>,
    /// Time between samples, in seconds; `None` without samples. Steps also end at these times if nobody records samples.
    pub output_step_s: Option<f64>,
    /// Coulomb's coefficient of friction at all joints; `None` prevents slip.
    pub friction_coefficient: Option<f64>,
}

impl Settings {
    /// Whether a motion ends once elastic joints only vibrate: if its end is not given.
    pub const fn ends_calm(&self) -> bool {
        self.outcome_by_s.is_some()
    }

    /// These settings.
    ///
    /// # Errors
    /// If a motion takes more than `most_steps` steps; `remedy` is part of the message.
    pub fn within(self, most_steps: f64, remedy: &str) -> Result<Self, RowMotionError> {
        let (end_s, steps) = (self.end_s, self.end_s / self.longest_step_s);
        if steps <= most_steps {
            return Ok(self);
        }
        let end = plain(end_s);
        let why = format!("a motion of {end} s takes {steps:.1e} steps: {remedy}");
        Err(RowMotionError::Failed(why))
    }
}

/// Times of samples, at which steps end: the start, and multiples of the output step after it.
pub struct Marks {
    pub(in crate::dynamics) settings: Settings,
    start_s: f64,
    /// Index of the next multiple of the output step; the start precedes it.
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

    /// Sample times of a fall from `from_s` on.
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

    /// Time at which the next step must end.
    pub fn next_s(&self) -> f64 {
        self.mark_s().min(self.settings.end_s)
    }
}
