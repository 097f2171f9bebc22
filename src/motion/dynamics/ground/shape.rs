//! Shapes of pulses in time, and their extrema.

use std::f64::consts::PI;

use crate::bisection::{Width, bisect, middle};

/// Parameters of the pulses that are an oscillation under an envelope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveTrain {
    /// Length of the envelope in periods of the oscillation, 1 to 1000: `gamma`, or the number of cycles.
    pub cycles: f64,
    /// Phase of the oscillation, at most 1000 in magnitude.
    pub phase_rad: f64,
}

impl Default for WaveTrain {
    fn default() -> Self {
        Self {
            cycles: 2.0,
            phase_rad: 0.0,
        }
    }
}

/// `amplitude sin(frequency s + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    pub(super) amplitude: f64,
    pub(super) frequency_rad_s: f64,
    pub(super) phase_rad: f64,
}

impl Sine {
    pub fn value_and_rate(&self, since_s: f64) -> (f64, f64) {
        let (sin, cos) = libm::sincos(self.frequency_rad_s * since_s + self.phase_rad);
        let rate = self.amplitude * self.frequency_rad_s * cos;
        (self.amplitude * sin, rate)
    }

    /// Integral between two times, by the chord of the unit circle: exact at any frequency, zero included.
    fn integral(&self, from_s: f64, to_s: f64) -> f64 {
        let half_angle = 0.5 * self.frequency_rad_s * (to_s - from_s);
        let per_angle = if half_angle == 0.0 {
            1.0
        } else {
            libm::sin(half_angle) / half_angle
        };
        let middle = 0.5 * self.frequency_rad_s * (from_s + to_s) + self.phase_rad;
        self.amplitude * (to_s - from_s) * libm::sin(middle) * per_angle
    }
}

/// A cosine under a bell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gabor {
    pub(super) centre_s: f64,
    pub(super) frequency_rad_s: f64,
    pub(super) train: WaveTrain,
}

impl Gabor {
    /// Angle of the oscillation from the middle of the bell, and sine and cosine of this angle plus the phase.
    fn angle(&self, since_s: f64) -> (f64, (f64, f64)) {
        let angle = self.frequency_rad_s * (since_s - self.centre_s);
        (angle, libm::sincos(angle + self.train.phase_rad))
    }
}

/// Nodes, on both sides of the middle, and weights of the Gauss-Legendre rule of eight points on `[-1, 1]`.
/// Source: Abramowitz and Stegun, table 25.4.
const GAUSS_LEGENDRE_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// A smooth function of the time since the start of a pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Waveform {
    Sine(Sine),
    /// A sum of sines: an oscillation under a cosine-shaped envelope.
    Beat([Sine; 3]),
    /// A Ricker wavelet of this period, in seconds.
    Ricker(f64),
    /// An antisymmetric Ricker wavelet of this period, in seconds.
    AntisymmetricRicker(f64),
    Gabor(Gabor),
}

impl Waveform {
    /// Value and its rate of change.
    pub fn value_and_rate(&self, since_s: f64) -> (f64, f64) {
        match *self {
            Self::Sine(sine) => sine.value_and_rate(since_s),
            Self::Beat(sines) => sines
                .iter()
                .map(|sine| sine.value_and_rate(since_s))
                .fold((0.0, 0.0), |sum, term| (sum.0 + term.0, sum.1 + term.1)),
            Self::Ricker(period_s) => {
                let scale = PI / period_s;
                let x = scale * (since_s - 2.0 * period_s);
                let bell = libm::exp(-x * x);
                let square = 2.0 * x * x;
                let rate = bell * scale * 2.0 * x * (square - 3.0);
                (bell * (1.0 - square), rate)
            }
            Self::AntisymmetricRicker(period_s) => {
                let scale = 2.0 * PI / (3.0_f64.sqrt() * period_s);
                let y = scale * (since_s - 2.5 * period_s);
                let bell = libm::exp(-0.5 * y * y);
                let square = y * y;
                let rate = bell * scale * (square * (6.0 - square) - 3.0);
                (bell * y * (square - 3.0), rate)
            }
            Self::Gabor(gabor) => {
                let (angle, (sin, cos)) = gabor.angle(since_s);
                let square = gabor.train.cycles * gabor.train.cycles;
                let bell = libm::exp(-angle * angle / square);
                let rate = -bell * gabor.frequency_rad_s * (2.0 * angle / square * cos + sin);
                (bell * cos, rate)
            }
        }
    }

    /// Integral over a piece, or over a part of it.
    pub fn integral(&self, from_s: f64, to_s: f64) -> f64 {
        match *self {
            Self::Sine(sine) => sine.integral(from_s, to_s),
            Self::Beat(sines) => sines.iter().map(|sine| sine.integral(from_s, to_s)).sum(),
            Self::Ricker(period_s) => {
                let scale = PI / period_s;
                let antiderivative = |since_s: f64| {
                    let x = scale * (since_s - 2.0 * period_s);
                    x * libm::exp(-x * x)
                };
                (antiderivative(to_s) - antiderivative(from_s)) / scale
            }
            Self::AntisymmetricRicker(period_s) => {
                let scale = 2.0 * PI / (3.0_f64.sqrt() * period_s);
                let antiderivative = |since_s: f64| {
                    let y = scale * (since_s - 2.5 * period_s);
                    (1.0 - y * y) * libm::exp(-0.5 * y * y)
                };
                (antiderivative(to_s) - antiderivative(from_s)) / scale
            }
            // The antiderivative is an error function of a complex argument. Quadrature is simpler, and exact within rounding error over the half
            // period of a piece.
            Self::Gabor(_) => {
                let quarter_s = 0.25 * (to_s - from_s);
                let quarters = [0.5, 1.5, 2.5, 3.5].map(|part| from_s + part * quarter_s);
                let panel = |middle_s: f64| {
                    let pair = |(node, weight): (f64, f64)| {
                        let offset_s = 0.5 * quarter_s * node;
                        weight
                            * (self.value_and_rate(middle_s - offset_s).0
                                + self.value_and_rate(middle_s + offset_s).0)
                    };
                    GAUSS_LEGENDRE_8.map(pair).iter().sum::<f64>()
                };
                0.5 * quarter_s * quarters.map(panel).iter().sum::<f64>()
            }
        }
    }

    /// Times of the extrema of a wave train with a given length and period.
    pub fn extrema_s(&self, length_s: f64, period_s: f64) -> Vec<f64> {
        // Rate of change up to a positive factor, and a bound of the slope of this function.
        let (zero_with_rate, steepest): (Box<dyn Fn(f64) -> f64>, f64) = match *self {
            Self::Beat(sines) => {
                let bend = |sine: Sine| sine.amplitude.abs() * sine.frequency_rad_s.powi(2);
                let steepest = sines.map(bend).into_iter().sum();
                (Box::new(|since_s| self.value_and_rate(since_s).1), steepest)
            }
            Self::Gabor(gabor) => {
                let bend = 2.0 / (gabor.train.cycles * gabor.train.cycles);
                let rate = move |since_s: f64| {
                    let (angle, (sin, cos)) = gabor.angle(since_s);
                    -(bend * angle * cos + sin)
                };
                let widest = gabor.frequency_rad_s * gabor.centre_s;
                let steepest = gabor.frequency_rad_s * (bend * (1.0 + widest) + 1.0);
                (Box::new(rate), steepest)
            }
            Self::Sine(_) | Self::Ricker(_) | Self::AntisymmetricRicker(_) => {
                unreachable!("their extrema are known in closed form")
            }
        };
        // Two extrema at a distance h differ by h^3/12 times the third derivative at most, here by about
        // 1e-12 of the amplitude.
        let resolution_s = 1e-5 * period_s;
        zeros(zero_with_rate, steepest, length_s, resolution_s)
    }
}

/// Zeros of `function` between 0 and `end` at which its sign changes, in order, within rounding error. `steepest` bounds the magnitude of
/// its slope.
///
/// A part has no zero if the function in its middle is farther from zero than the slope allows over the length of the part. Other parts are halved.
/// Pairs of zeros closer than `resolution` may be missed.
fn zeros(function: impl Fn(f64) -> f64, steepest: f64, end: f64, resolution: f64) -> Vec<f64> {
    let mut zeros = Vec::new();
    let mut parts = vec![(0.0, end)];
    while let Some((low, high)) = parts.pop() {
        let centre = middle(low, high);
        let half = 0.5 * (high - low);
        if function(centre).abs() > steepest * (high - low) {
            continue;
        }
        if half > resolution {
            parts.extend([(centre, high), (low, centre)]);
        } else {
            let starts_positive = function(low) > 0.0;
            if (function(high) > 0.0) != starts_positive {
                let (low, high) = bisect(low, high, Width::Rounding, |at| {
                    (function(at) > 0.0) != starts_positive
                });
                zeros.push(middle(low, high));
            }
        }
    }
    zeros
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_found_singly_in_pairs_and_at_the_borders_of_parts() {
        let cubic = |x: f64| (x - 0.25) * (x - 0.5) * (x - 0.50001);
        let found = zeros(cubic, 3.0, 1.0, 1e-7);
        assert_eq!(found.len(), 3);
        for (x, exact) in found.into_iter().zip([0.25, 0.5, 0.50001]) {
            assert!((x - exact).abs() < 1e-12);
        }
        assert!(zeros(|x| (x - 0.3).powi(2), 2.0, 1.0, 1e-7).is_empty());
    }
}
