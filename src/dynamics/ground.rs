//! Ground motion: horizontal acceleration as smooth, monotone pieces between known corners.
//!
//! An integrator must not step over a corner, and a search for the instant at which the ground gets
//! strong enough must not step over a peak. So a ground motion is cut at every jump, kink and extremum,
//! and each piece owns its one-sided formula: at a corner two pieces give two values.

use std::f64::consts::PI;

named! {
    /// Shape of a single pulse. Accelerations follow with the amplitude `a`, the duration `T` and the time
    /// `s` since the start.
    pub enum Pulse {
        /// `a` for `0 <= s < T`.
        Rectangular = "rectangular",
        /// `a` for `0 <= s < T`, then `-a/2` for `T <= s < 3 T`: no velocity is left.
        StepPair = "step_pair",
        /// `a sin(pi s / T)` for `0 <= s < T`.
        HalfSine = "half_sine",
        /// `a sin(2 pi s / T)` for `0 <= s < T`.
        OneSine = "one_sine",
        /// `a cos(2 pi s / T)` for `0 <= s < T`: from its peak, with a jump at both ends.
        OneCosine = "one_cosine",
        /// From 0 up to `a` at `s = T/2` and back to 0 at `T`, in straight lines.
        Triangular = "triangular",
        /// Ricker wavelet `a (1 - 2 x^2) exp(-x^2)`, `x = pi (s - 2 T) / T`, for `0 <= s < 4 T`; `T` is the
        /// period of its central frequency and the peak is at `s = 2 T`. Beyond, it would be below
        /// `6e-16 a`, and is zero.
        Ricker = "ricker",
    }
}

/// One-sided formula of a piece, in the time since the start of its pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Formula {
    Linear {
        at_origin: f64,
        slope: f64,
    },
    Sine {
        amplitude: f64,
        frequency_rad_s: f64,
        phase_rad: f64,
    },
    Ricker {
        amplitude: f64,
        period_s: f64,
    },
}

impl Formula {
    const fn constant(acceleration: f64) -> Self {
        Self::Linear {
            at_origin: acceleration,
            slope: 0.0,
        }
    }

    /// Acceleration and its rate of change.
    fn at(&self, since_s: f64) -> (f64, f64) {
        match *self {
            Self::Linear { at_origin, slope } => (at_origin + slope * since_s, slope),
            Self::Sine {
                amplitude,
                frequency_rad_s,
                phase_rad,
            } => {
                let (sin, cos) = (frequency_rad_s * since_s + phase_rad).sin_cos();
                (amplitude * sin, amplitude * frequency_rad_s * cos)
            }
            Self::Ricker {
                amplitude,
                period_s,
            } => {
                let scale = PI / period_s;
                let x = scale * (since_s - 2.0 * period_s);
                let bell = amplitude * (-x * x).exp();
                let square = 2.0 * x * x;
                (
                    bell * (1.0 - square),
                    bell * scale * 2.0 * x * (square - 3.0),
                )
            }
        }
    }
}

/// A piece of ground motion: smooth and monotone from its start to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Start, in seconds.
    pub start_s: f64,
    /// End, in seconds; infinite for the last piece.
    pub end_s: f64,
    /// Time that the formula counts from.
    origin_s: f64,
    formula: Formula,
}

impl Piece {
    /// Acceleration in m/s2 at a time in the piece, the ends included, as the limit from inside.
    #[must_use]
    pub fn acceleration_m_s2(&self, time_s: f64) -> f64 {
        self.formula.at(time_s - self.origin_s).0
    }

    /// Rate of change of the acceleration, in m/s3.
    #[must_use]
    pub fn jerk_m_s3(&self, time_s: f64) -> f64 {
        self.formula.at(time_s - self.origin_s).1
    }

    /// Whether the acceleration is zero from here on for ever.
    #[must_use]
    pub fn is_quiet_for_good(&self) -> bool {
        self.end_s == f64::INFINITY
    }

    /// A step that cannot miss the shape of the piece.
    #[must_use]
    pub fn longest_step_s(&self) -> f64 {
        match self.formula {
            Formula::Linear { .. } => f64::INFINITY,
            Formula::Sine { .. } | Formula::Ricker { .. } => 0.25 * (self.end_s - self.start_s),
        }
    }
}

/// Horizontal ground acceleration from time zero on, positive to +x; zero after the last corner.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundMotion {
    pieces: Vec<Piece>,
}

impl GroundMotion {
    /// The ground stays still.
    #[must_use]
    pub fn still() -> Self {
        Self::from_pieces(0.0, Vec::new())
    }

    /// A single pulse that starts at `start_s >= 0`, with peak acceleration `amplitude_m_s2` and
    /// length `duration_s > 0`.
    #[must_use]
    pub fn pulse(pulse: Pulse, amplitude_m_s2: f64, duration_s: f64, start_s: f64) -> Self {
        let (a, t) = (amplitude_m_s2, duration_s);
        let sine = |periods: f64, phase_rad: f64| Formula::Sine {
            amplitude: a,
            frequency_rad_s: periods * 2.0 * PI / t,
            phase_rad,
        };
        let ricker = Formula::Ricker {
            amplitude: a,
            period_s: t,
        };
        // The troughs of the wavelet are at x^2 = 3/2.
        let trough = 1.5_f64.sqrt() / PI;
        let pieces = match pulse {
            Pulse::Rectangular => vec![(t, Formula::constant(a))],
            Pulse::StepPair => {
                vec![
                    (t, Formula::constant(a)),
                    (3.0 * t, Formula::constant(-0.5 * a)),
                ]
            }
            Pulse::HalfSine => vec![(0.5 * t, sine(0.5, 0.0)), (t, sine(0.5, 0.0))],
            Pulse::OneSine => [0.25, 0.75, 1.0]
                .map(|end| (end * t, sine(1.0, 0.0)))
                .to_vec(),
            Pulse::OneCosine => [0.5, 1.0]
                .map(|end| (end * t, sine(1.0, 0.5 * PI)))
                .to_vec(),
            Pulse::Triangular => {
                let slope = 2.0 * a / t;
                let up = Formula::Linear {
                    at_origin: 0.0,
                    slope,
                };
                let down = Formula::Linear {
                    at_origin: 2.0 * a,
                    slope: -slope,
                };
                vec![(0.5 * t, up), (t, down)]
            }
            Pulse::Ricker => [2.0 - trough, 2.0, 2.0 + trough, 4.0]
                .map(|end| (end * t, ricker))
                .to_vec(),
        };
        Self::from_pieces(start_s, pieces)
    }

    /// Pieces given by their ends and formulas in the time since `start_s`.
    fn from_pieces(start_s: f64, formulas: Vec<(f64, Formula)>) -> Self {
        let quiet = Formula::constant(0.0);
        let mut ends = vec![(start_s, quiet)];
        ends.extend(
            formulas
                .into_iter()
                .map(|(end, formula)| (start_s + end, formula)),
        );
        ends.push((f64::INFINITY, quiet));
        let mut pieces = Vec::with_capacity(ends.len());
        let mut piece_start_s = 0.0;
        for (end_s, formula) in ends {
            // Nothing is left of a piece that is shorter than the spacing of times around it.
            if end_s > piece_start_s {
                pieces.push(Piece {
                    start_s: piece_start_s,
                    end_s,
                    origin_s: start_s,
                    formula,
                });
                piece_start_s = end_s;
            }
        }
        Self { pieces }
    }

    /// The pieces in order, without gaps, from zero to infinity.
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Largest magnitude of the acceleration, in m/s2: pieces are monotone, so it is at one of their ends.
    #[must_use]
    pub fn peak_m_s2(&self) -> f64 {
        let ends = self
            .pieces
            .iter()
            .filter(|piece| !piece.is_quiet_for_good());
        ends.flat_map(|piece| {
            [piece.start_s, piece.end_s].map(|t| piece.acceleration_m_s2(t).abs())
        })
        .fold(0.0, f64::max)
    }

    /// The same motion with further corners, which change nothing: for tests of the integration.
    #[must_use]
    pub fn cut_at(&self, times_s: &[f64]) -> Self {
        let mut pieces = self.pieces.clone();
        for time in times_s {
            if let Some(index) = pieces
                .iter()
                .position(|p| p.start_s < *time && *time < p.end_s)
            {
                let mut rest = pieces[index];
                pieces[index].end_s = *time;
                rest.start_s = *time;
                pieces.insert(index + 1, rest);
            }
        }
        Self { pieces }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_follow_one_another_from_zero_to_infinity() {
        for pulse in Pulse::ALL.iter().copied() {
            for start in [0.0, 0.7] {
                let ground = GroundMotion::pulse(pulse, 2.0, 0.3, start);
                let pieces = ground.pieces();
                assert!(pieces[0].start_s == 0.0);
                assert!(
                    pieces
                        .windows(2)
                        .all(|pair| pair[0].end_s == pair[1].start_s)
                );
                let last = pieces.last().unwrap();
                assert!(last.is_quiet_for_good() && last.acceleration_m_s2(99.0) == 0.0);
            }
        }
    }

    #[test]
    fn pieces_are_monotone_and_their_jerk_is_the_derivative() {
        for pulse in Pulse::ALL.iter().copied() {
            for piece in GroundMotion::pulse(pulse, -3.0, 0.4, 0.2).pieces() {
                let end = piece.end_s.min(piece.start_s + 10.0);
                let at = |i: i32| piece.start_s + (end - piece.start_s) * f64::from(i) / 100.0;
                let rises = (0..100)
                    .map(|i| piece.acceleration_m_s2(at(i + 1)) - piece.acceleration_m_s2(at(i)));
                let (up, down) = rises.fold((0.0_f64, 0.0_f64), |(up, down), rise| {
                    (up.max(rise), down.min(rise))
                });
                assert!(up < 1e-13 || down > -1e-13, "{pulse:?} {piece:?}");
                let (middle, h) = (at(37), 1e-6);
                let slope = (piece.acceleration_m_s2(middle + h)
                    - piece.acceleration_m_s2(middle - h))
                    / (2.0 * h);
                assert!((slope - piece.jerk_m_s3(middle)).abs() < 1e-6, "{pulse:?}");
            }
        }
    }

    /// Integral of the acceleration by Gauss-like quadrature on the pieces (Simpson, 2000 intervals).
    fn final_velocity(ground: &GroundMotion) -> f64 {
        let integral = |piece: &Piece| {
            let (n, width) = (2000, piece.end_s - piece.start_s);
            let h = width / f64::from(n);
            (0..n)
                .map(|i| {
                    let at =
                        |x: f64| piece.acceleration_m_s2(piece.start_s + h * (f64::from(i) + x));
                    h / 6.0 * (at(0.0) + 4.0 * at(0.5) + at(1.0))
                })
                .sum::<f64>()
        };
        ground
            .pieces()
            .iter()
            .filter(|piece| piece.end_s.is_finite())
            .map(integral)
            .sum()
    }

    #[test]
    fn velocities_left_by_the_pulses_are_the_closed_forms() {
        let velocity = |pulse| final_velocity(&GroundMotion::pulse(pulse, 2.0, 0.3, 0.1));
        assert!((velocity(Pulse::Rectangular) - 0.6).abs() < 1e-12);
        assert!(velocity(Pulse::StepPair).abs() < 1e-12);
        assert!((velocity(Pulse::HalfSine) - 1.2 / PI).abs() < 1e-12);
        assert!(velocity(Pulse::OneSine).abs() < 1e-12);
        assert!(velocity(Pulse::OneCosine).abs() < 1e-12);
        assert!((velocity(Pulse::Triangular) - 0.3).abs() < 1e-12);
        assert!(velocity(Pulse::Ricker).abs() < 1e-12);
    }

    #[test]
    fn pulses_reach_their_amplitude_where_they_say() {
        let peak = |pulse, at: f64| {
            let ground = GroundMotion::pulse(pulse, 2.0, 0.3, 0.1);
            let inside = |p: &&Piece| p.start_s <= 0.1 + at && 0.1 + at < p.end_s;
            ground
                .pieces()
                .iter()
                .find(inside)
                .unwrap()
                .acceleration_m_s2(0.1 + at)
        };
        assert!((peak(Pulse::HalfSine, 0.15) - 2.0).abs() < 1e-12);
        assert!((peak(Pulse::OneSine, 0.075) - 2.0).abs() < 1e-12);
        assert!((peak(Pulse::OneCosine, 0.0) - 2.0).abs() < 1e-12);
        assert!((peak(Pulse::Triangular, 0.15) - 2.0).abs() < 1e-12);
        assert!((peak(Pulse::Ricker, 0.6) - 2.0).abs() < 1e-12);
        assert!((peak(Pulse::StepPair, 0.5) + 1.0).abs() < 1e-12);
        // A tiny pulse keeps its piece, however long the time before it.
        let short = GroundMotion::pulse(Pulse::Rectangular, 2.0, 1e-12, 100.0);
        assert_eq!(short.pieces().len(), 3);
    }

    #[test]
    fn cuts_change_no_value() {
        let ground = GroundMotion::pulse(Pulse::OneSine, 2.0, 0.3, 0.1);
        let cut = ground.cut_at(&[0.05, 0.11, 0.3, 5.0]);
        assert_eq!(cut.pieces().len(), ground.pieces().len() + 4);
        for piece in cut.pieces() {
            let time = piece.start_s;
            let original = ground.pieces().iter().rfind(|p| p.start_s <= time).unwrap();
            assert!(piece.acceleration_m_s2(time) == original.acceleration_m_s2(time));
        }
    }
}
