//! Strength of a recorded ground motion: peaks, Arias intensity and significant duration.
//!
//! All values are exact for accelerations that are linear between samples. Velocity and displacement are zero at the first sample. There is no
//! baseline correction, so the displacement of an uncorrected record drifts.

use std::f64::consts::PI;

use crate::bisection::{Width, bisect};
use crate::dynamics::peak::Peak;

/// Fractions of the Arias intensity at the start and end of the significant duration (Trifunac and Brady, 1975).
pub(crate) const SIGNIFICANT: [f64; 2] = [0.05, 0.95];

/// Strength of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Intensity {
    /// Peak ground acceleration, in m/s2.
    pub acceleration_m_s2: Peak,
    /// Peak ground velocity, in m/s.
    pub velocity_m_s: Peak,
    /// Peak ground displacement, in m.
    pub displacement_m: Peak,
    /// Arias intensity, pi / (2 g) times the integral of the squared acceleration, in m/s (Arias, 1970).
    pub arias_m_s: f64,
    /// Times at which 5 % and 95 % of the Arias intensity are reached, in s; both are the first time for ground without motion.
    pub significant_s: [f64; 2],
    /// At each sample: velocity in m/s, displacement in m, and the fraction of the Arias intensity reached.
    pub course: Vec<[f64; 3]>,
}

impl Intensity {
    /// Computes the intensity of samples: times in s, increasing except at jumps of the acceleration, and accelerations in m/s2. Gravity, in m/s2, is
    /// used in the Arias intensity.
    pub fn of(samples: &[(f64, f64)], gravity_m_s2: f64) -> Self {
        let mut intensity = Self {
            significant_s: [samples.first().map_or(0.0, |sample| sample.0); 2],
            course: vec![[0.0; 3]; samples.len()],
            ..Self::default()
        };
        for &(time_s, acceleration) in samples {
            intensity
                .acceleration_m_s2
                .record_value(acceleration.abs(), time_s);
        }
        let mut state = [0.0; 3];
        for (pair, after) in samples.windows(2).zip(1..) {
            let line = LinearPiece::between(pair[0], pair[1]);
            intensity.peaks_within(&line, state);
            state = line.advance(state, line.duration_s);
            intensity.course[after] = state;
        }
        let squares = state[2];
        intensity.arias_m_s = 0.5 * PI / gravity_m_s2 * squares;
        if squares > 0.0 {
            intensity.significant_s = SIGNIFICANT.map(|part| {
                let target = part * squares;
                let reached = |course: &[f64; 3]| course[2] < target;
                let after = intensity.course.partition_point(reached).max(1);
                let line = LinearPiece::between(samples[after - 1], samples[after]);
                line.start_s + line.time_of_squares(target - intensity.course[after - 1][2])
            });
            for course in &mut intensity.course {
                course[2] /= squares;
            }
        }
        intensity
    }

    /// Duration from 5 % to 95 % of the Arias intensity, in s.
    pub fn significant_duration_s(&self) -> f64 {
        let [from_s, to_s] = self.significant_s;
        to_s - from_s
    }

    /// Records the peaks of velocity and displacement after a state: at the end, and where their rates are zero.
    fn peaks_within(&mut self, line: &LinearPiece, state: [f64; 3]) {
        let [velocity, ..] = state;
        let turns = roots([line.acceleration, line.slope, 0.0])
            .into_iter()
            .chain(roots([velocity, line.acceleration, 0.5 * line.slope]))
            .filter(|after_s| (0.0..line.duration_s).contains(after_s));
        for after_s in turns.chain([line.duration_s]) {
            let [velocity, displacement, _] = line.advance(state, after_s);
            let time_s = line.start_s + after_s;
            self.velocity_m_s.record_value(velocity.abs(), time_s);
            self.displacement_m.record_value(displacement.abs(), time_s);
        }
    }
}

/// Acceleration between two samples.
struct LinearPiece {
    start_s: f64,
    duration_s: f64,
    acceleration: f64,
    slope: f64,
}

impl LinearPiece {
    fn between(from: (f64, f64), to: (f64, f64)) -> Self {
        let duration_s = to.0 - from.0;
        let slope = (to.1 - from.1) / duration_s;
        Self {
            start_s: from.0,
            duration_s,
            acceleration: from.1,
            slope: if duration_s > 0.0 { slope } else { 0.0 },
        }
    }

    /// Velocity, displacement and the integral of the squared acceleration `after_s` after the given values at its start.
    fn advance(&self, [velocity, displacement, squares]: [f64; 3], after_s: f64) -> [f64; 3] {
        let (s, a, m) = (after_s, self.acceleration, self.slope);
        [
            velocity + s * (a + s * m / 2.0),
            displacement + s * (velocity + s * (a / 2.0 + s * m / 6.0)),
            squares + s * (a * a + s * m * (a + s * m / 3.0)),
        ]
    }

    /// Time at which the integral of the squared acceleration reaches `target`.
    fn time_of_squares(&self, target: f64) -> f64 {
        let reached = |after_s: f64| self.advance([0.0; 3], after_s)[2] >= target;
        bisect(0.0, self.duration_s, Width::Rounding, reached).1
    }
}

/// Real roots of c + b x + a x^2; none for a constant.
fn roots([c, b, a]: [f64; 3]) -> Vec<f64> {
    if a == 0.0 {
        return if b == 0.0 { Vec::new() } else { vec![-c / b] };
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return Vec::new();
    }
    // This form avoids cancellation.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    if q == 0.0 {
        vec![0.0]
    } else {
        vec![q / a, c / q]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(value: f64, expected: f64) {
        assert!(
            (value - expected).abs() < 1e-12 * expected.abs().max(1.0),
            "{value} {expected}"
        );
    }

    /// A triangle of peak A and base T from time t on: velocity A T / 2 at its end, displacement A T^2 / 4 there by
    /// symmetry, squares A^2 T / 3, of which 5 % are reached after T / 2 times the cube root of 0.1.
    #[test]
    fn intensities_of_a_triangle_are_its_closed_forms() {
        let (a, base, start) = (-2.5, 0.8, 3.0);
        let triangle = [(start, 0.0), (start + base / 2.0, a), (start + base, 0.0)];
        let intensity = Intensity::of(&triangle, 9.81);
        assert_close(intensity.acceleration_m_s2.value, 2.5);
        assert_close(intensity.acceleration_m_s2.time_s, start + 0.4);
        assert_close(intensity.velocity_m_s.value, 2.5 * base / 2.0);
        assert_close(intensity.displacement_m.value, 2.5 * base * base / 4.0);
        assert_close(
            intensity.arias_m_s,
            PI / (2.0 * 9.81) * 2.5 * 2.5 * base / 3.0,
        );
        let early = 0.5 * base * 0.1_f64.cbrt();
        assert_close(intensity.significant_s[0], start + early);
        assert_close(intensity.significant_s[1], start + base - early);
        assert_close(intensity.significant_duration_s(), base - 2.0 * early);
        assert_eq!(intensity.course[0], [0.0; 3]);
        assert_close(intensity.course[1][2], 0.5);
        assert_close(intensity.course[2][2], 1.0);
    }

    /// The acceleration 1 - 2 t falls through zero at 0.5 s, where the velocity peaks at 1/4; the velocity vanishes at
    /// 1 s, where the displacement peaks at 1/6. Neither is at a sample.
    #[test]
    fn peaks_between_samples_are_found() {
        let line = [(0.0, 1.0), (1.2, -1.4)];
        let intensity = Intensity::of(&line, 1.0);
        assert_close(intensity.velocity_m_s.value, 0.25);
        assert_close(intensity.velocity_m_s.time_s, 0.5);
        assert_close(intensity.displacement_m.value, 1.0 / 6.0);
        assert_close(intensity.displacement_m.time_s, 1.0);
    }

    /// A full sine of amplitude A and period T: velocity A T / pi, displacement A T^2 / (2 pi), squares A^2 T / 2; lines
    /// between 2000 samples err by about 1e-6.
    #[test]
    fn intensities_of_a_sampled_sine_are_its_closed_forms() {
        let (a, period) = (3.0, 0.5);
        let count = 2000;
        let samples: Vec<_> = (0..=count)
            .map(|i| {
                let t = period * f64::from(i) / f64::from(count);
                (t, a * (2.0 * PI * t / period).sin())
            })
            .collect();
        let intensity = Intensity::of(&samples, 9.81);
        let near = |value: f64, exact: f64| assert!((value / exact - 1.0).abs() < 2e-6);
        near(intensity.velocity_m_s.value, a * period / PI);
        near(
            intensity.displacement_m.value,
            a * period * period / (2.0 * PI),
        );
        near(
            intensity.arias_m_s,
            PI / (2.0 * 9.81) * a * a * period / 2.0,
        );
    }

    #[test]
    fn still_ground_has_no_intensity() {
        let intensity = Intensity::of(&[(1.0, 0.0), (2.0, 0.0)], 9.81);
        assert_eq!(intensity.arias_m_s, 0.0);
        assert_eq!(intensity.significant_s, [1.0; 2]);
        assert_eq!(intensity.displacement_m.value, 0.0);
    }
}
