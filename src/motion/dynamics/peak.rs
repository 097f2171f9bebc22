//! Largest values over time.

/// Rise of a value, relative to it, below which it counts as constant.
pub const NO_RISE: f64 = 1e-12;

/// Largest value over time, and the time at which it is first reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Largest value.
    pub value: f64,
    /// Time of the largest value, in s.
    pub time_s: f64,
}

impl Peak {
    pub(super) fn record_value(&mut self, value: f64, time_s: f64) {
        if value > self.value * (1.0 + NO_RISE) {
            *self = Self { value, time_s };
        }
    }
}
