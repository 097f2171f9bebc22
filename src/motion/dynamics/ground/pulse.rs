//! Pulses: ground accelerations by formula.

use std::f64::consts::PI;
use std::sync::OnceLock;

use nalgebra::Vector2;

use super::error::{ACCELERATION_M_S2, DURATION_S, GroundError, TIME_S};
use super::motion::GroundMotion;
use super::piece::{Formula, GroundPiece};
use super::shape::{Gabor, Sine, WaveTrain, Waveform};
use super::velocity::GroundVelocity;
use crate::argument::require_within;

named! {
    /// Shape of a single pulse. Accelerations follow with the amplitude `a`, which is the peak acceleration,
    /// the duration `T` and the time `s` since the start; where there are two more parameters, see
    /// [`WaveTrain`].
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
        /// Symmetric Ricker wavelet `a (1 - 2 x^2) exp(-x^2)`, `x = pi (s - 2 T) / T`, for `0 <= s < 4 T`; `T`
        /// is the period of its central frequency and the peak is at `s = 2 T`. Beyond, it would be below
        /// `6e-16 a`, and is zero.
        Ricker = "ricker",
        /// Antisymmetric Ricker wavelet `(a / b) (y^3 - 3 y) exp(-y^2 / 2)`,
        /// `y = 2 pi (s - 5 T / 2) / (sqrt(3) T)`, for `0 <= s < 5 T`, first to the side of `a` and then to the
        /// other; `b = 1.3801` makes `a` the peak, and `T` is the period of its central frequency. Beyond, it
        /// would be below `8e-16 a`, and is zero. Source: Vassiliou and Makris, "Estimating time scales and length
        /// scales in pulselike earthquake acceleration records with wavelet analysis", BSSA 101(2), 2011.
        AntisymmetricRicker = "antisymmetric_ricker",
        /// Pulse of Mavroeidis and Papageorgiou ("A mathematical representation of near-fault ground
        /// motions", BSSA 93(3), 2003): the ground velocity is a multiple of
        /// `(1 + cos(w (s - c) / gamma)) cos(w (s - c) + phase)`, `w = 2 pi / T`, for `0 <= s < gamma T`,
        /// `c = gamma T / 2`; the acceleration, its derivative, is scaled to the peak `a`. It begins and
        /// ends at zero, with kinks, and leaves no velocity.
        MavroeidisPapageorgiou = "mavroeidis_papageorgiou",
        /// Gabor wavelet: a multiple of `exp(-(w (s - c) / gamma)^2) cos(w (s - c) + phase)`, `w = 2 pi / T`,
        /// scaled to the peak `a`, for `0 <= s < 2 c`, `c = 3 gamma T / pi`; beyond, the exponential would be
        /// below `3e-16`, and the acceleration is zero. Source: Gabor, "Theory of communication", J. IEE
        /// 93(III), 1946; as a ground acceleration in Vassiliou and Makris (2011).
        Gabor = "gabor",
        /// Sine in a Hann window: a multiple of `sin(w s + phase) sin^2(w s / (2 n))`, `w = 2 pi / T`, scaled to
        /// the peak `a`, for `0 <= s < n T` with `n` cycles. It begins and ends smoothly; with a whole number
        /// of at least two cycles it leaves no velocity.
        WindowedSine = "windowed_sine",
    }
}

impl Pulse {
    /// Whether the pulse pushes to one side only.
    pub const fn is_one_sided(self) -> bool {
        match self {
            Self::Rectangular | Self::HalfSine | Self::Triangular => true,
            Self::StepPair | Self::OneSine | Self::OneCosine => false,
            Self::Ricker | Self::AntisymmetricRicker => false,
            Self::MavroeidisPapageorgiou | Self::Gabor | Self::WindowedSine => false,
        }
    }

    /// Whether the shape depends on a [`WaveTrain`].
    pub const fn is_wave_train(self) -> bool {
        match self {
            Self::MavroeidisPapageorgiou | Self::Gabor | Self::WindowedSine => true,
            Self::Rectangular | Self::StepPair | Self::HalfSine | Self::OneSine => false,
            Self::OneCosine | Self::Triangular => false,
            Self::Ricker | Self::AntisymmetricRicker => false,
        }
    }

    /// Pulse with duration `duration_s` (1e-12 to 1e9) that starts at time zero. A wave train has [`WaveTrain::default`].
    pub fn lasting_s(self, duration_s: f64) -> PulseShape {
        PulseShape {
            pulse: self,
            duration_s,
            start_s: 0.0,
            train: WaveTrain::default(),
            cut: OnceLock::new(),
        }
    }
}

/// A pulse of any amplitude: its kind, its duration, and when it starts.
///
/// ```
///
/// # use archrock_motion::dynamics::{GroundError, Pulse};
/// let ground = Pulse::OneSine.lasting_s(0.5).starting_at_s(1.0).horizontal_m_s2(-2.0)?;
/// assert_eq!(ground.end_s(), 1.5);
///
/// # Ok::<(), GroundError>(())
/// ```
///
/// Finding the extrema of a wave train takes far longer than one history under it. They do not depend on the
/// amplitude, so they are found once, for the first ground motion.
#[derive(Clone, Debug)]
pub struct PulseShape {
    pulse: Pulse,
    duration_s: f64,
    start_s: f64,
    train: WaveTrain,
    cut: OnceLock<CutTrain>,
}

/// A wave train, cut at its extrema.
#[derive(Clone, Debug)]
struct CutTrain {
    shape: Waveform,
    /// Extrema and end, in seconds since the start.
    ends_s: Vec<f64>,
    /// Largest magnitude of the shape.
    peak: f64,
}

impl PulseShape {
    /// This pulse with the start `start_s` (0 to 1e9).
    #[must_use]
    pub fn starting_at_s(self, start_s: f64) -> Self {
        Self { start_s, ..self }
    }

    /// This pulse with another wave train; without effect for pulses that are no wave trains.
    #[must_use]
    pub fn with_train(self, train: WaveTrain) -> Self {
        let cut = OnceLock::new();
        Self { train, cut, ..self }
    }

    /// Peak velocity over peak acceleration, over the duration: a number of the shape alone.
    ///
    /// # Errors
    /// When a number of the pulse is outside its range.
    pub fn velocity_ratio(&self) -> Result<f64, GroundError> {
        let ground = self.horizontal_m_s2(1.0)?;
        let velocity = GroundVelocity::new(&ground);
        // The velocities are exact, and flat at a maximum between corners: that of the samples is too small by less than 1e-6 of itself.
        let times_s = |piece: &GroundPiece| {
            let (start_s, lasts_s) = (piece.start_s, piece.end_s - piece.start_s);
            (0..=1000).map(move |sample| start_s + lasts_s * f64::from(sample) / 1e3)
        };
        let pieces = ground.pieces.iter().filter(|piece| piece.end_s.is_finite());
        let speeds_m_s = pieces
            .flat_map(times_s)
            .map(|time_s| velocity.velocity_at(time_s).x.abs());
        Ok(speeds_m_s.fold(0.0, f64::max) / self.duration_s)
    }

    /// Ground motion with this horizontal peak acceleration (at most 1e12 in magnitude, positive to the right).
    ///
    /// # Errors
    /// When a number of the pulse is outside its range.
    pub fn horizontal_m_s2(&self, amplitude_m_s2: f64) -> Result<GroundMotion, GroundError> {
        self.inclined_m_s2(Vector2::new(amplitude_m_s2, 0.0))
    }

    /// Ground motion with these horizontal and vertical peak accelerations (at most 1e12 in magnitude), of a common shape.
    ///
    /// # Errors
    /// When a number of the pulse is outside its range.
    pub fn inclined_m_s2(&self, amplitude_m_s2: Vector2<f64>) -> Result<GroundMotion, GroundError> {
        require_within("duration_s", self.duration_s, DURATION_S)?;
        require_within("start_s", self.start_s, TIME_S)?;
        if self.pulse.is_wave_train() {
            require_within("cycles", self.train.cycles, 1.0..=1e3)?;
            require_within("phase_rad", self.train.phase_rad, -1e3..=1e3)?;
        }
        require_within("amplitude_m_s2.x", amplitude_m_s2.x, ACCELERATION_M_S2)?;
        require_within("amplitude_m_s2.y", amplitude_m_s2.y, ACCELERATION_M_S2)?;
        let pieces = self.pieces(amplitude_m_s2);
        Ok(GroundMotion::from_pieces(self.start_s, pieces))
    }

    /// Wave train of this shape, cut when it is first needed.
    fn cut_train(&self, shape: TrainShape) -> &CutTrain {
        let period_s = self.duration_s;
        let cut = || CutTrain::new(shape(period_s, self.train), period_s);
        self.cut.get_or_init(cut)
    }

    /// Pieces: ends in the time since the start, and formulas.
    fn pieces(&self, amplitude_m_s2: Vector2<f64>) -> Vec<(f64, Formula)> {
        let (a, t) = (amplitude_m_s2, self.duration_s);
        let sine = |periods: f64, phase_rad: f64| {
            let sine = Sine {
                amplitude: 1.0,
                frequency_rad_s: periods * 2.0 * PI / t,
                phase_rad,
            };
            Formula::Shaped(a, Waveform::Sine(sine))
        };
        let cut =
            |ends: &[f64], formula: Formula| ends.iter().map(|end| (end * t, formula)).collect();
        match self.pulse {
            Pulse::Rectangular => vec![(t, Formula::constant(a))],
            Pulse::StepPair => {
                let back = Formula::constant(-0.5 * a);
                vec![(t, Formula::constant(a)), (3.0 * t, back)]
            }
            Pulse::HalfSine => cut(&[0.5, 1.0], sine(0.5, 0.0)),
            Pulse::OneSine => cut(&[0.25, 0.75, 1.0], sine(1.0, 0.0)),
            Pulse::OneCosine => cut(&[0.5, 1.0], sine(1.0, 0.5 * PI)),
            Pulse::Triangular => {
                let slope = 2.0 * a / t;
                let up = Formula::Linear(Vector2::zeros(), slope);
                vec![(0.5 * t, up), (t, Formula::Linear(2.0 * a, -slope))]
            }
            Pulse::Ricker => {
                // The troughs of the wavelet are at x^2 = 3/2.
                let trough = 1.5_f64.sqrt() / PI;
                let ricker = Formula::Shaped(a, Waveform::Ricker(t));
                cut(&[2.0 - trough, 2.0, 2.0 + trough, 4.0], ricker)
            }
            Pulse::AntisymmetricRicker => {
                // The extrema are the zeros of the Hermite polynomial y^4 - 6 y^2 + 3.
                let [inner, outer] = [-1.0, 1.0].map(|sign| (3.0 + sign * 6.0_f64.sqrt()).sqrt());
                let peak = inner * 6.0_f64.sqrt() * libm::exp(-0.5 * inner * inner);
                let ends =
                    [-outer, -inner, inner, outer].map(|y| 2.5 + y * 3.0_f64.sqrt() / (2.0 * PI));
                let wavelet = Formula::Shaped(a / peak, Waveform::AntisymmetricRicker(t));
                cut(&[&ends[..], &[5.0]].concat(), wavelet)
            }
            Pulse::MavroeidisPapageorgiou => self.cut_train(mavroeidis_papageorgiou).pieces(a),
            Pulse::Gabor => self.cut_train(gabor).pieces(a),
            Pulse::WindowedSine => self.cut_train(windowed_sine).pieces(a),
        }
    }
}

/// Makes the shape of a wave train with a period in s, and its length in s.
type TrainShape = fn(f64, WaveTrain) -> (Waveform, f64);

fn mavroeidis_papageorgiou(period_s: f64, train: WaveTrain) -> (Waveform, f64) {
    let (less, more) = (1.0 - 1.0 / train.cycles, 1.0 + 1.0 / train.cycles);
    // The product of cosines is a sum of three; about its middle the derivative is this.
    let terms = [(-1.0, 1.0), (-0.5 * less, less), (-0.5 * more, more)];
    let length_s = train.cycles * period_s;
    (beat(terms, period_s, train, 0.5 * length_s), length_s)
}

fn gabor(period_s: f64, train: WaveTrain) -> (Waveform, f64) {
    let centre_s = 3.0 * train.cycles * period_s / PI;
    let gabor = Gabor {
        centre_s,
        frequency_rad_s: 2.0 * PI / period_s,
        train,
    };
    (Waveform::Gabor(gabor), 2.0 * centre_s)
}

fn windowed_sine(period_s: f64, train: WaveTrain) -> (Waveform, f64) {
    let (less, more) = (1.0 - 1.0 / train.cycles, 1.0 + 1.0 / train.cycles);
    // sin^2(w s / (2 n)) is (1 - cos(w s / n)) / 2.
    let terms = [(0.5, 1.0), (-0.25, less), (-0.25, more)];
    (beat(terms, period_s, train, 0.0), train.cycles * period_s)
}

/// Sum of sines of these amplitudes and numbers of periods, with the phase of the train at a time.
fn beat(terms: [(f64, f64); 3], period_s: f64, train: WaveTrain, middle_s: f64) -> Waveform {
    Waveform::Beat(terms.map(|(amplitude, periods)| {
        let frequency_rad_s = periods * 2.0 * PI / period_s;
        let phase_rad = train.phase_rad - frequency_rad_s * middle_s;
        Sine {
            amplitude,
            frequency_rad_s,
            phase_rad,
        }
    }))
}

impl CutTrain {
    fn new((shape, length_s): (Waveform, f64), period_s: f64) -> Self {
        let mut ends_s = shape.extrema_s(length_s, period_s);
        ends_s.push(length_s);
        // The value at the start of the train does not exceed its strongest extremum or its end.
        let values = ends_s.iter().map(|end| shape.value_and_rate(*end).0.abs());
        let peak = values.fold(0.0, f64::max);
        Self {
            shape,
            ends_s,
            peak,
        }
    }

    /// Pieces, scaled so that the largest extremum is the amplitude.
    fn pieces(&self, amplitude: Vector2<f64>) -> Vec<(f64, Formula)> {
        let formula = Formula::Shaped(amplitude / self.peak, self.shape);
        self.ends_s.iter().map(|end| (*end, formula)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::GroundPiece;
    use super::*;

    /// Wave trains with various numbers of cycles and phases.
    fn trains() -> impl Iterator<Item = (Pulse, WaveTrain)> {
        let kinds = Pulse::ALL.iter().copied().filter(|p| p.is_wave_train());
        kinds.flat_map(|pulse| {
            [1.0, 1.001, 1.7, 2.0, 3.5, 40.0]
                .into_iter()
                .flat_map(move |cycles| {
                    [0.0, 0.4, 0.5 * PI, -2.0, PI]
                        .map(|phase_rad| (pulse, WaveTrain { cycles, phase_rad }))
                })
        })
    }

    /// Against integrals by hand: a constant for the duration, half a period of a sine, a period of a sine and of a cosine, a triangle.
    #[test]
    fn the_velocity_ratio_is_that_of_the_integral() {
        let exact = [
            (Pulse::Rectangular, 1.0),
            (Pulse::StepPair, 1.0),
            (Pulse::HalfSine, 2.0 / PI),
            (Pulse::OneSine, 1.0 / PI),
            (Pulse::OneCosine, 0.5 / PI),
            (Pulse::Triangular, 0.5),
        ];
        for (pulse, ratio) in exact {
            for duration_s in [0.01, 0.7, 30.0] {
                let shape = pulse.lasting_s(duration_s).starting_at_s(0.4);
                let found = shape.velocity_ratio().unwrap();
                assert!((found / ratio - 1.0).abs() < 1e-6, "{pulse:?}: {found}");
            }
        }
    }

    #[test]
    fn combinations_of_the_components_are_monotone_and_the_jerk_is_the_derivative() {
        let default = WaveTrain::default();
        let plain = Pulse::ALL.iter().map(|pulse| (*pulse, default));
        let amplitude = Vector2::new(-3.0, 1.5);
        for (pulse, train) in plain.chain(trains()) {
            let ground = pulse
                .lasting_s(0.4)
                .starting_at_s(0.2)
                .with_train(train)
                .inclined_m_s2(amplitude)
                .unwrap();
            for piece in &ground.pieces {
                let end = piece.end_s.min(piece.start_s + 10.0);
                let at = |i: i32| piece.start_s + (end - piece.start_s) * f64::from(i) / 100.0;
                for direction in [Vector2::x(), Vector2::y(), Vector2::new(-1.0, 0.35)] {
                    let component = |i: i32| piece.acceleration_and_rate(at(i)).0.dot(&direction);
                    let rises = (0..100).map(|i| component(i + 1) - component(i));
                    let (up, down) = rises.fold((0.0_f64, 0.0_f64), |(up, down), rise| {
                        (up.max(rise), down.min(rise))
                    });
                    // Sums of angles up to 250 are rounded to 3e-14.
                    assert!(up < 2e-13 || down > -2e-13, "{pulse:?} {train:?} {piece:?}");
                }
                let (middle, h) = (at(37), 1e-6);
                let slope = (piece.acceleration_and_rate(middle + h).0
                    - piece.acceleration_and_rate(middle - h).0)
                    / (2.0 * h);
                assert!(
                    (slope - piece.acceleration_and_rate(middle).1).norm() < 1e-6,
                    "{pulse:?} {train:?}"
                );
            }
        }
    }

    #[test]
    fn the_largest_acceleration_of_a_wave_train_is_its_amplitude() {
        for (pulse, train) in trains() {
            let amplitude = Vector2::new(2.0, 0.0);
            let ground = pulse
                .lasting_s(0.3)
                .starting_at_s(0.1)
                .with_train(train)
                .inclined_m_s2(amplitude)
                .unwrap();
            assert!((ground.peaks_m_s2(f64::INFINITY).x - 2.0).abs() < 1e-12);
            // Pieces end at the extrema, so their ends bound all values between them.
            let moving = ground.pieces.iter().filter(|p| !p.stays_still());
            let inside = moving.flat_map(|piece| {
                let width = piece.end_s - piece.start_s;
                (1..500)
                    .map(move |i| piece.start_s + width * f64::from(i) / 500.0)
                    .map(|time| piece.acceleration_m_s2(time).abs())
            });
            let largest = inside.fold(0.0, f64::max);
            assert!(
                largest < 2.0 + 1e-12 && largest > 1.999,
                "{pulse:?} {train:?} {largest}"
            );
        }
    }

    fn acceleration_at(ground: &GroundMotion, time_s: f64) -> f64 {
        let piece = ground.pieces.iter().rfind(|p| p.start_s <= time_s);
        piece.unwrap().acceleration_m_s2(time_s)
    }

    /// Compares accelerations with the published formulas, up to the factor of the amplitude.
    #[test]
    fn wave_trains_are_the_published_formulas() {
        for (pulse, train) in trains() {
            let (t, n, phase) = (0.3, train.cycles, train.phase_rad);
            let w = 2.0 * PI / t;
            let length = match pulse {
                Pulse::Gabor => 6.0 * n * t / PI,
                _ => n * t,
            };
            let formula = |s: f64| {
                let x = w * (s - 0.5 * length);
                match pulse {
                    Pulse::MavroeidisPapageorgiou => {
                        let velocity = |x: f64| (1.0 + (x / n).cos()) * (x + phase).cos();
                        (velocity(x + 1e-5) - velocity(x - 1e-5)) / 2e-5
                    }
                    Pulse::Gabor => (-(x / n).powi(2)).exp() * (x + phase).cos(),
                    _ => (w * s + phase).sin() * (w * s / (2.0 * n)).sin().powi(2),
                }
            };
            let ground = pulse
                .lasting_s(t)
                .with_train(train)
                .inclined_m_s2(Vector2::x())
                .unwrap();
            let ours = |part: f64| acceleration_at(&ground, part * length);
            let strongest = (1..50)
                .map(|i| f64::from(i) / 50.0)
                .max_by(|a, b| ours(*a).abs().total_cmp(&ours(*b).abs()))
                .unwrap();
            let factor = formula(strongest * length) / ours(strongest);
            assert!(factor > 0.0, "{pulse:?} {train:?}");
            for part in [0.07, 0.21, 0.36, 0.5, 0.64, 0.89] {
                let miss = formula(part * length) - factor * ours(part);
                // Central differences err by 1e-10, and are rounded to 1e-11.
                assert!(
                    miss.abs() < 2e-9 * factor.max(1.0),
                    "{pulse:?} {train:?} {miss}"
                );
            }
        }
    }

    #[test]
    fn the_antisymmetric_wavelet_is_the_published_one() {
        let (t, b) = (0.3, 1.3801);
        let ground = Pulse::AntisymmetricRicker
            .lasting_s(t)
            .horizontal_m_s2(1.0)
            .unwrap();
        for since in [0.1, 0.4, 0.7, 0.75, 0.9, 1.2] {
            let y = 2.0 * PI * (since - 2.5 * t) / (3.0_f64.sqrt() * t);
            let published = (y * y * y - 3.0 * y) * (-0.5 * y * y).exp() / b;
            let ours = acceleration_at(&ground, since);
            // b is published with five digits.
            assert!((ours - published).abs() < 4e-5, "{since}");
        }
        assert!((ground.peaks_m_s2(f64::INFINITY).x - 1.0).abs() < 1e-14);
    }

    /// Integral of the acceleration by Simpson's rule on the pieces (2000 intervals).
    fn final_velocity(ground: &GroundMotion) -> f64 {
        let integral = |piece: &GroundPiece| {
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
            .pieces
            .iter()
            .filter(|piece| piece.end_s.is_finite())
            .map(integral)
            .sum()
    }

    #[test]
    fn velocities_left_by_the_pulses_are_the_closed_forms() {
        let velocity = |pulse: Pulse| {
            final_velocity(
                &pulse
                    .lasting_s(0.3)
                    .starting_at_s(0.1)
                    .horizontal_m_s2(2.0)
                    .unwrap(),
            )
        };
        assert!((velocity(Pulse::Rectangular) - 0.6).abs() < 1e-12);
        assert!(velocity(Pulse::StepPair).abs() < 1e-12);
        assert!((velocity(Pulse::HalfSine) - 1.2 / PI).abs() < 1e-12);
        assert!(velocity(Pulse::OneSine).abs() < 1e-12);
        assert!(velocity(Pulse::OneCosine).abs() < 1e-12);
        assert!((velocity(Pulse::Triangular) - 0.3).abs() < 1e-12);
        assert!(velocity(Pulse::Ricker).abs() < 1e-12);
        assert!(velocity(Pulse::AntisymmetricRicker).abs() < 1e-12);
        assert!(velocity(Pulse::MavroeidisPapageorgiou).abs() < 1e-12);
        assert!(velocity(Pulse::WindowedSine).abs() < 1e-12);
        // The Fourier transform of the bell; the peak is in the middle.
        let gabor = 2.0 * 0.3 / PI.sqrt() * (-1.0_f64).exp();
        assert!((velocity(Pulse::Gabor) - gabor).abs() < 1e-12);
    }

    #[test]
    fn pulses_reach_their_amplitude_at_their_peak_time() {
        let peak = |pulse: Pulse, at: f64| {
            let ground = pulse
                .lasting_s(0.3)
                .starting_at_s(0.1)
                .horizontal_m_s2(2.0)
                .unwrap();
            let inside = |p: &&GroundPiece| p.start_s <= 0.1 + at && 0.1 + at < p.end_s;
            ground
                .pieces
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
        // A very short pulse keeps its piece, also after a long time.
        let short = Pulse::Rectangular
            .lasting_s(1e-12)
            .starting_at_s(100.0)
            .horizontal_m_s2(2.0)
            .unwrap();
        assert_eq!(short.pieces.len(), 3);
    }
}
