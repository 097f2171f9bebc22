//! Number and spacing of samples, and their mean.

use std::fmt;

use crate::samples::is_step;

/// The number and spacing of the samples of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Number of samples.
    pub count: usize,
    /// Time between samples in s; `None` if it is not constant.
    pub step_s: Option<f64>,
    /// Shortest time between samples, in s.
    pub least_step_s: f64,
    /// Time from the first to the last sample, in s.
    pub duration_s: f64,
}

impl Sampling {
    /// Returns number and spacing of at least two samples, in ascending order.
    pub fn of(samples: &[(f64, f64)]) -> Self {
        let steps = || samples.windows(2).map(|pair| pair[1].0 - pair[0].0);
        let [first_s, last_s] = [samples.first(), samples.last()].map(|s| s.map_or(0.0, |s| s.0));
        let duration_s = last_s - first_s;
        let mean_s = duration_s / (samples.len() - 1) as f64;
        Self {
            count: samples.len(),
            step_s: steps().all(is_step(mean_s, last_s)).then_some(mean_s),
            least_step_s: steps().fold(f64::INFINITY, f64::min),
            duration_s,
        }
    }
}

/// Number, spacing and duration of the samples.
impl fmt::Display for Sampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // At most six digits, without trailing zeros.
        let rounded = |value: f64| format!("{value:.5e}").parse().unwrap_or(value);
        let steps = match self.step_s {
            Some(step_s) => format!("every {} s", rounded(step_s)),
            None => format!(
                "at unequal steps (smallest {} s)",
                rounded(self.least_step_s)
            ),
        };
        let duration_s = rounded(self.duration_s);
        write!(f, "{} samples {steps}, {duration_s} s long", self.count)
    }
}

/// Computes the mean over time of samples joined by straight lines; zero without samples.
pub fn mean(samples: &[(f64, f64)]) -> f64 {
    let [Some(first), Some(last)] = [samples.first(), samples.last()] else {
        return 0.0;
    };
    let areas = samples.windows(2).map(|pair| {
        let [(t0, a0), (t1, a1)] = [pair[0], pair[1]];
        0.5 * (a0 + a1) * (t1 - t0)
    });
    areas.sum::<f64>() / (last.0 - first.0)
}
