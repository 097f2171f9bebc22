//! The factors on a ground motion that a search for thresholds tries.

use serde::{Deserialize, Serialize};

use crate::argument::{ArgumentError, above, within};

/// Relative width to which an edge is bisected: far less than the uncertainty of any ground motion,
/// and wide enough that integration errors do not decide.
pub const EDGE_WIDTH: f64 = 1e-4;

/// The factors to sample, from the first to the last. Each is larger than the one before by a stride, or by
/// less if that reaches the last.
#[readonly::make]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Factors {
    /// The first factor.
    pub from: f64,
    /// The last factor.
    pub to: f64,
    /// The relative step from one factor to the next.
    pub stride: f64,
}

impl Default for Factors {
    /// From 0.1 to 10, in strides of 2 %.
    fn default() -> Self {
        Self {
            from: 0.1,
            to: 10.0,
            stride: 0.02,
        }
    }
}

impl Factors {
    /// Factors from `from`, at least 1e-6, to `to`, which is larger and at most 1e6. Each stride is `stride`, 1e-4 to 1,
    /// times the factor.
    ///
    /// # Errors
    /// When a number is not allowed.
    pub fn new(from: f64, to: f64, stride: f64) -> Result<Self, ArgumentError> {
        Ok(Self {
            from: within("from", from, 1e-6..=1e6)?,
            to: above("to", to, from, 1e6)?,
            stride: within("stride", stride, 1e-4..=1.0)?,
        })
    }

    /// All factors, ascending.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        // A last stride that is due to rounding only is dropped.
        let end = self.to * (1.0 - 1e-9);
        let next = |factor: &f64| Some(factor * (1.0 + self.stride));
        let mut values: Vec<f64> = std::iter::successors(Some(self.from), next)
            .take_while(|factor| *factor < end)
            .collect();
        values.push(self.to);
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(from: f64, to: f64, stride: f64) -> Vec<f64> {
        Factors::new(from, to, stride).unwrap().values()
    }

    #[test]
    fn factors_rise_by_strides_from_the_first_to_the_last() {
        assert_eq!(values(1.0, 8.0, 1.0), [1.0, 2.0, 4.0, 8.0]);
        assert_eq!(values(1.0, 5.0, 1.0), [1.0, 2.0, 4.0, 5.0]);
        assert_eq!(values(1.0, 1.02, 0.02), [1.0, 1.02]);
        let default = Factors::default().values();
        assert_eq!((default.len(), default[0]), (234, 0.1));
        assert!(
            default
                .windows(2)
                .all(|pair| pair[1] <= pair[0] * 1.0200001)
        );
    }

    #[test]
    fn factors_that_are_none_are_refused() {
        for (from, to, stride, argument) in [
            (0.0, 1.0, 0.1, "from"),
            (f64::NAN, 1.0, 0.1, "from"),
            (1.0, 1.0, 0.1, "to"),
            (1.0, f64::INFINITY, 0.1, "to"),
            (1.0, 2.0, 0.0, "stride"),
            (1.0, 2.0, f64::NAN, "stride"),
        ] {
            let error = Factors::new(from, to, stride).unwrap_err();
            assert_eq!(error.argument, argument);
        }
    }
}
