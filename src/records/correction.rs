//! Corrections of uncorrected records: baseline and high-pass filter.

use std::f64::consts::{PI, SQRT_2};

use archrock_text::{ensure, plain, short};

use crate::samples::{LineFault, MAX_SAMPLES, Parsed, Samples, check_time};
use crate::sampling::{Sampling, mean};

named! {
    /// The baseline that is subtracted from accelerations.
    pub enum Baseline {
        /// The mean over time: the velocity ends at zero.
        Mean = "mean",
        /// The line of least squares over time: velocity and displacement end at zero.
        Linear = "linear",
    }
}

impl Baseline {
    /// Subtracts the baseline from accelerations that straight lines join.
    pub fn subtract(self, samples: &mut [(f64, f64)]) {
        let [(first_s, _), .., (last_s, _)] = *samples else {
            return;
        };
        let (middle_s, duration_s) = (0.5 * (first_s + last_s), last_s - first_s);
        let mean = mean(samples);
        let slope = match self {
            Self::Mean => 0.0,
            Self::Linear => slope(samples, middle_s, duration_s),
        };
        for (time_s, acceleration) in samples {
            *acceleration -= mean;
            if slope != 0.0 {
                *acceleration -= slope * (*time_s - middle_s) / duration_s;
            }
        }
    }
}

/// Computes the slope of the line of least squares, per duration of the samples. If the residual is orthogonal to 1 and to the time, its first
/// and second integrals end at zero.
fn slope(samples: &[(f64, f64)], middle_s: f64, duration_s: f64) -> f64 {
    let moments = samples.windows(2).map(|pair| {
        let [(t0, a0), (t1, a1)] = [pair[0], pair[1]];
        let [x0, x1] = [t0, t1].map(|time_s| (time_s - middle_s) / duration_s);
        // Simpson's rule is exact for the product of two lines.
        (x1 - x0) * (a0 * x0 + (a0 + a1) * (x0 + x1) + a1 * x1) / 6.0
    });
    12.0 * moments.sum::<f64>()
}

/// Zeros before and after the record during the filter, in periods of the corner. The impulse response has then decayed to exp(-3 sqrt(2) pi), 2e-6.
/// Converse and Brady (USGS Open-File Report 92-296A, 1992) take 1.5 periods times the order of the filter, for both ends together.
const PADS: f64 = 3.0;

/// Filters accelerations by a Butterworth filter of order 2, forwards and backwards: without a shift in phase, and with the amplitude response
/// `1 / (1 + (corner / f)^4)`. The bilinear transform replaces each frequency `f` by `tan(pi f step)`.
///
/// The zeros before and after the record, filtered, are part of the result: without them velocity and displacement would not end at zero (Boore
/// and Bommer, Soil Dynamics and Earthquake Engineering 25, 2005). Times before the record may be negative.
pub(crate) fn high_pass(samples: &[(f64, f64)], corner_hz: f64) -> Parsed<Samples> {
    let fault = LineFault::on::<String>(1);
    let sampling = Sampling::of(samples);
    let step_s = sampling
        .step_s
        .ok_or_else(|| fault("`high_pass_hz` needs a constant step between samples".to_owned()))?;
    ensure(corner_hz > 0.0, || {
        fault(format!(
            "`high_pass_hz = {}` must be above 0",
            plain(corner_hz)
        ))
    })?;
    let highest_hz = 0.5 / step_s;
    ensure(corner_hz < highest_hz, || {
        let [corner, highest] = [corner_hz, highest_hz].map(plain);
        fault(format!(
            "`high_pass_hz = {corner}` must be below half of the rate of the samples, {highest} Hz"
        ))
    })?;
    // A whole number of steps stays whole in spite of rounding errors.
    let pad = ((1.0 - 1e-12) * PADS / (corner_hz * step_s)).ceil();
    let count = 2.0 * pad + samples.len() as f64;
    ensure(count <= MAX_SAMPLES as f64, || {
        let (corner, count) = (plain(corner_hz), short(count));
        fault(format!(
            "`high_pass_hz = {corner}` needs {count} samples with the zeros before and after; at most {MAX_SAMPLES} are allowed"
        ))
    })?;
    let (pad, first_s, last_s) = (pad as usize, samples[0].0, samples[samples.len() - 1].0);
    for time_s in [first_s - pad as f64 * step_s, last_s + pad as f64 * step_s] {
        check_time(time_s, None).map_err(fault)?;
    }
    let zeros = || std::iter::repeat_n(0.0, pad);
    let values = samples.iter().map(|sample| sample.1);
    let mut values: Vec<f64> = zeros().chain(values).chain(zeros()).collect();
    let filter = Butterworth::high_pass(corner_hz * step_s);
    filter.apply(values.iter_mut());
    filter.apply(values.iter_mut().rev());
    // Rounded, because a message names the first time.
    let at = |from_s: f64, steps: f64| ((from_s + steps * step_s) * 1e10).round() / 1e10;
    let before = (1..=pad).rev().map(|index| at(first_s, -(index as f64)));
    let after = (1..=pad).map(|index| at(last_s, index as f64));
    let times = before
        .chain(samples.iter().map(|sample| sample.0))
        .chain(after);
    Ok(times.zip(values).collect())
}

/// A high-pass filter of order 2.
struct Butterworth {
    gain: f64,
    feedback: [f64; 2],
}

impl Butterworth {
    /// Makes the filter with the corner at this multiple of the rate, by the bilinear transform.
    fn high_pass(corner_over_rate: f64) -> Self {
        let warped = libm::tan(PI * corner_over_rate);
        let gain = 1.0 / (1.0 + SQRT_2 * warped + warped * warped);
        Self {
            gain,
            feedback: [
                2.0 * (warped * warped - 1.0) * gain,
                (1.0 - SQRT_2 * warped + warped * warped) * gain,
            ],
        }
    }

    fn apply<'v>(&self, values: impl Iterator<Item = &'v mut f64>) {
        let ([mut x1, mut x2], [mut y1, mut y2]) = ([0.0; 2], [0.0; 2]);
        let [a1, a2] = self.feedback;
        for value in values {
            let (x, y) = (
                *value,
                self.gain * (*value - 2.0 * x1 + x2) - a1 * y1 - a2 * y2,
            );
            ([x1, x2], [y1, y2]) = ([x, x1], [y, y1]);
            *value = y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Velocity and displacement at the end, from zero, of accelerations that straight lines join.
    fn ends(samples: &[(f64, f64)]) -> [f64; 2] {
        samples
            .windows(2)
            .fold([0.0; 2], |[velocity, displacement], pair| {
                let [(t0, a0), (t1, a1)] = [pair[0], pair[1]];
                let step = t1 - t0;
                [
                    velocity + 0.5 * (a0 + a1) * step,
                    displacement + velocity * step + (2.0 * a0 + a1) * step * step / 6.0,
                ]
            })
    }

    fn shaken(count: usize, step_s: f64, acceleration: impl Fn(f64) -> f64) -> Samples {
        let times = (0..count).map(|index| index as f64 * step_s);
        times.map(|time_s| (time_s, acceleration(time_s))).collect()
    }

    #[test]
    fn constants_and_lines_are_removed_exactly() {
        for (baseline, slope) in [(Baseline::Mean, 0.0), (Baseline::Linear, -0.7)] {
            let mut samples: Samples = [-1.0, 0.0, 0.3, 0.35, 2.0, 7.0]
                .map(|time_s| (time_s, 3.0 + slope * time_s))
                .to_vec();
            baseline.subtract(&mut samples);
            for (time_s, left) in samples {
                assert!(left.abs() < 1e-14, "{baseline:?} {time_s}: {left}");
            }
        }
    }

    /// A parabola keeps its part that is orthogonal to lines: the Legendre polynomial of degree 2.
    #[test]
    fn a_parabola_keeps_its_curvature() {
        let mut samples = shaken(20_001, 1e-3, |time_s| 1.0 + time_s * time_s);
        Baseline::Linear.subtract(&mut samples);
        for (time_s, left) in samples {
            let x = time_s / 10.0 - 1.0;
            let expected = 100.0 * (x * x - 1.0 / 3.0);
            assert!(
                (left - expected).abs() < 1e-4,
                "{time_s}: {left} {expected}"
            );
        }
    }

    /// As in corrected records of networks, the velocity ends at zero, with a line the displacement too, also at uneven steps.
    #[test]
    fn velocities_and_displacements_end_at_zero() {
        let mut times: Vec<f64> = (0..400).map(|index| 0.02 * index as f64).collect();
        times
            .iter_mut()
            .skip(1)
            .step_by(3)
            .for_each(|time_s| *time_s += 0.007);
        let drifting = |time_s: &f64| {
            (
                *time_s,
                (9.0 * time_s).sin() * (-0.3 * time_s).exp() + 0.05 * time_s,
            )
        };
        let given: Samples = times.iter().map(drifting).collect();
        let [velocity, displacement] = ends(&given);
        assert!(velocity > 1.0 && displacement > 1.0);
        let mut mean = given.clone();
        Baseline::Mean.subtract(&mut mean);
        assert!(ends(&mean)[0].abs() < 1e-12 && ends(&mean)[1].abs() > 0.1);
        let mut linear = given;
        Baseline::Linear.subtract(&mut linear);
        assert!(
            ends(&linear).iter().all(|end| end.abs() < 1e-11),
            "{:?}",
            ends(&linear)
        );
    }

    /// A long sine keeps its phase, and its amplitude follows the formula. Far below half the rate this is the response of an analogue filter.
    #[test]
    fn sines_have_the_response_of_the_formula() {
        let (step_s, corner_hz) = (0.01, 0.2);
        for frequency_hz in [0.05, 0.1, 0.2, 0.4, 1.0, 2.0, 10.0] {
            let omega = 2.0 * PI * frequency_hz;
            let given = shaken(60_001, step_s, |time_s| (omega * time_s).cos());
            let filtered = high_pass(&given, corner_hz).unwrap();
            let expected = 1.0 / (1.0 + (corner_hz / frequency_hz).powi(4));
            let inside = filtered
                .iter()
                .filter(|sample| (200.0..400.0).contains(&sample.0));
            for (time_s, found) in inside {
                let analogue = expected * (omega * time_s).cos();
                assert!(
                    (found - analogue).abs() < 1e-3,
                    "{frequency_hz}: {found} {analogue}"
                );
                let warped = |frequency_hz: f64| (PI * frequency_hz * step_s).tan();
                let ratio = warped(corner_hz) / warped(frequency_hz);
                let exact = (omega * time_s).cos() / (1.0 + ratio.powi(4));
                assert!(
                    (found - exact).abs() < 1e-9,
                    "{frequency_hz}: {found} {exact}"
                );
            }
        }
    }

    /// The filtered record contains the zeros before and after it: a pulse and a drift end without velocity and displacement.
    #[test]
    fn filtered_motions_end_at_rest() {
        for (step_s, corner_hz) in [(0.005, 0.05), (0.02, 0.5), (0.01, 2.0)] {
            let given = shaken(2001, step_s, |time_s| {
                let growth = if time_s < 3.0 {
                    (4.0 * time_s).sin()
                } else {
                    0.0
                };
                growth + 0.1
            });
            let before = ends(&given);
            let filtered = high_pass(&given, corner_hz).unwrap();
            let pad = (3.0 / corner_hz / step_s).ceil();
            assert_eq!(filtered.len(), 2001 + 2 * pad as usize);
            assert!((filtered[0].0 + pad * step_s).abs() < 1e-9);
            assert!(
                filtered
                    .windows(2)
                    .all(|pair| (pair[1].0 - pair[0].0 - step_s).abs() < 1e-9)
            );
            let after = ends(&filtered);
            for (before, after) in before.into_iter().zip(after) {
                assert!(
                    after.abs() < 1e-4 * before.abs(),
                    "{corner_hz}: {before} {after}"
                );
            }
        }
    }

    /// The filter is symmetric in time: the mirrored record gives the mirror image.
    #[test]
    fn the_filter_has_no_direction() {
        let given = shaken(501, 0.01, |time_s| (7.0 * time_s).sin() * (-time_s).exp());
        let mut mirrored = given.clone();
        for (at, from) in mirrored.iter_mut().zip(given.iter().rev()) {
            at.1 = from.1;
        }
        let [found, mirrored] = [given, mirrored].map(|samples| high_pass(&samples, 0.5).unwrap());
        for (one, other) in found.iter().zip(mirrored.iter().rev()) {
            assert!((one.1 - other.1).abs() < 1e-5, "{one:?} {other:?}");
        }
    }

    #[test]
    fn impossible_filters_are_refused() {
        let even = shaken(10, 0.01, |time_s| time_s);
        let mut uneven = even.clone();
        uneven[3].0 += 0.004;
        for (samples, corner_hz, words) in [
            (&uneven, 1.0, "needs a constant step"),
            (&even, 0.0, "`high_pass_hz = 0` must be above 0"),
            (&even, f64::NAN, "must be above 0"),
            (
                &even,
                50.0,
                "must be below half of the rate of the samples, 50 Hz",
            ),
            (
                &shaken(10, 1e-4, |time_s| time_s),
                0.01,
                "at most 1800000 are allowed",
            ),
        ] {
            let fault = high_pass(samples, corner_hz).unwrap_err();
            assert!(fault.message.contains(words), "{fault:?}");
        }
    }
}
