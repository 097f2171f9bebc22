//! Largest values over time.

/// A largest value, and when it is first reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// The value.
    pub value: f64,
    /// Its time, in s.
    pub time_s: f64,
}

impl Peak {
    pub(super) fn note(&mut self, value: f64, time_s: f64) {
        if value > self.value {
            *self = Self { value, time_s };
        }
    }
}
