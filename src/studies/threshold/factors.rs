//! The factors on a ground motion that the search for thresholds tries.

use serde::{Deserialize, Serialize};

use crate::argument::{ArgumentError, above, within};

/// Relative width to which bisection encloses an edge: far less than the uncertainty of a ground motion, and more than the integration error.
pub const EDGE_WIDTH: f64 = 1e-4;

/// A geometric sequence of factors: each is larger than the previous one by a stride; the last step may be shorter.
#[readonly::make]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Factors {
    /// The first factor.
    pub from: f64,
    /// The last factor.
    pub to: f64,
    /// The relative step between factors.
    pub stride: f64,
}

impl Default for Factors {
    /// Returns factors from 0.1 to 10 in strides of 2 %.
    fn default() -> Self {
        Self {
            from: 0.1,
            to: 10.0,
            stride: 0.02,
        }
    }
}

impl Factors {
    /// Makes factors from `from`, at least 1e-6, to `to`, which is larger and at most 1e6. Each step is `stride` times the factor; `stride` is
    /// between 1e-4 and 1.
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

    /// Returns the options of a command that searches these factors, with a space before each; empty for the default.
    pub(in crate::studies) fn options(&self) -> String {
        let Self { from, to, stride } = self;
        match *self == Self::default() {
            true => String::new(),
            false => format!(" --from {from} --to {to} --stride {stride}"),
        }
    }

    /// Returns the command that searches these factors for a scenario on standard input, without `archrock`.
    pub(in crate::studies) fn command(&self) -> String {
        let Self { from, to, stride } = self;
        format!("threshold - --from {from:?} --to {to:?} --stride {stride:?} --out case")
    }

    /// Returns all factors, ascending.
    pub fn values(&self) -> Vec<f64> {
        // Drops a last step that is due to rounding errors only.
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
