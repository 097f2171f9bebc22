//! Ground motion: acceleration as smooth, monotone pieces between known corners.
//!
//! An integrator must not step over a corner, and a search for the instant at which the ground gets
//! strong enough must not step over a peak. So a ground motion is cut at every jump, kink and extremum,
//! and each piece owns its one-sided formula: at a corner two pieces give two values.
//!
//! The ground may also move vertically. Within a piece either both components are straight lines, or they
//! are multiples of one monotone shape: **every linear combination of the two is monotone**, and so is the
//! distance from the onset of rocking.

use std::f64::consts::PI;

use nalgebra::Vector2;

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
        /// Antisymmetric Ricker wavelet `(a / b) (y^3 - 3 y) exp(-y^2 / 2)`, `y = 2 pi (s - 5 T / 2) / (sqrt(3) T)`,
        /// for `0 <= s < 5 T`, first to the side of `a` and then to the other; `b = 1.3801` makes `a` the
        /// peak, and `T` is the period of its central frequency. Beyond, it would be below `8e-16 a`, and is
        /// zero. Source: Vassiliou and Makris, "Estimating time scales and length scales in pulselike
        /// earthquake acceleration records with wavelet analysis", BSSA 101(2), 2011.
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
    /// Whether it pushes to one side only.
    #[must_use]
    pub const fn is_one_sided(self) -> bool {
        matches!(self, Self::Rectangular | Self::HalfSine | Self::Triangular)
    }

    /// Whether the shape depends on a [`WaveTrain`].
    #[must_use]
    pub const fn is_wave_train(self) -> bool {
        matches!(
            self,
            Self::MavroeidisPapageorgiou | Self::Gabor | Self::WindowedSine
        )
    }
}

/// Parameters of the pulses that are an oscillation under an envelope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveTrain {
    /// Length of the envelope in periods of the oscillation, at least 1: `gamma`, or the number of cycles.
    pub cycles: f64,
    /// Phase of the oscillation, in radians.
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
struct Sine {
    amplitude: f64,
    frequency_rad_s: f64,
    phase_rad: f64,
}

impl Sine {
    fn at(&self, since_s: f64) -> (f64, f64) {
        let (sin, cos) = (self.frequency_rad_s * since_s + self.phase_rad).sin_cos();
        (
            self.amplitude * sin,
            self.amplitude * self.frequency_rad_s * cos,
        )
    }

    /// Integral between two times, by the chord of the unit circle: exact at any frequency, zero included.
    fn integral(&self, from_s: f64, to_s: f64) -> f64 {
        let half_angle = 0.5 * self.frequency_rad_s * (to_s - from_s);
        let per_angle = if half_angle == 0.0 {
            1.0
        } else {
            half_angle.sin() / half_angle
        };
        let middle = 0.5 * self.frequency_rad_s * (from_s + to_s) + self.phase_rad;
        self.amplitude * (to_s - from_s) * middle.sin() * per_angle
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
enum Shape {
    Sine(Sine),
    /// A sum of sines: an oscillation under a cosine-shaped envelope.
    Beat([Sine; 3]),
    Ricker {
        period_s: f64,
    },
    AntisymmetricRicker {
        period_s: f64,
    },
    Gabor {
        centre_s: f64,
        frequency_rad_s: f64,
        train: WaveTrain,
    },
}

impl Shape {
    /// Value and rate of change.
    fn at(&self, since_s: f64) -> (f64, f64) {
        match *self {
            Self::Sine(sine) => sine.at(since_s),
            Self::Beat(sines) => sines
                .iter()
                .map(|sine| sine.at(since_s))
                .fold((0.0, 0.0), |sum, term| (sum.0 + term.0, sum.1 + term.1)),
            Self::Ricker { period_s } => {
                let scale = PI / period_s;
                let x = scale * (since_s - 2.0 * period_s);
                let bell = (-x * x).exp();
                let square = 2.0 * x * x;
                (
                    bell * (1.0 - square),
                    bell * scale * 2.0 * x * (square - 3.0),
                )
            }
            Self::AntisymmetricRicker { period_s } => {
                let scale = 2.0 * PI / (3.0_f64.sqrt() * period_s);
                let y = scale * (since_s - 2.5 * period_s);
                let bell = (-0.5 * y * y).exp();
                let square = y * y;
                (
                    bell * y * (square - 3.0),
                    bell * scale * (square * (6.0 - square) - 3.0),
                )
            }
            Self::Gabor {
                centre_s,
                frequency_rad_s,
                train,
            } => {
                let angle = frequency_rad_s * (since_s - centre_s);
                let (sin, cos) = (angle + train.phase_rad).sin_cos();
                let square = train.cycles * train.cycles;
                let bell = (-angle * angle / square).exp();
                (
                    bell * cos,
                    -bell * frequency_rad_s * (2.0 * angle / square * cos + sin),
                )
            }
        }
    }

    /// Integral over a piece, or over a part of it.
    fn integral(&self, from_s: f64, to_s: f64) -> f64 {
        match *self {
            Self::Sine(sine) => sine.integral(from_s, to_s),
            Self::Beat(sines) => sines.iter().map(|sine| sine.integral(from_s, to_s)).sum(),
            Self::Ricker { period_s } => {
                let scale = PI / period_s;
                let antiderivative = |since_s: f64| {
                    let x = scale * (since_s - 2.0 * period_s);
                    x * (-x * x).exp()
                };
                (antiderivative(to_s) - antiderivative(from_s)) / scale
            }
            Self::AntisymmetricRicker { period_s } => {
                let scale = 2.0 * PI / (3.0_f64.sqrt() * period_s);
                let antiderivative = |since_s: f64| {
                    let y = scale * (since_s - 2.5 * period_s);
                    (1.0 - y * y) * (-0.5 * y * y).exp()
                };
                (antiderivative(to_s) - antiderivative(from_s)) / scale
            }
            // Its antiderivative is an error function of a complex argument: quadrature is simpler, and exact to
            // rounding over the half period that a piece lasts.
            Self::Gabor { .. } => {
                let quarter_s = 0.25 * (to_s - from_s);
                let quarters = [0.5, 1.5, 2.5, 3.5].map(|part| from_s + part * quarter_s);
                let panel = |middle_s: f64| {
                    GAUSS_LEGENDRE_8
                        .iter()
                        .map(|(node, weight)| {
                            let offset_s = 0.5 * quarter_s * node;
                            weight
                                * (self.at(middle_s - offset_s).0 + self.at(middle_s + offset_s).0)
                        })
                        .sum::<f64>()
                };
                0.5 * quarter_s * quarters.map(panel).iter().sum::<f64>()
            }
        }
    }

    /// The times at which a wave train of the given length and period has its extrema.
    fn extrema_s(&self, length_s: f64, period_s: f64) -> Vec<f64> {
        // The rate of change up to a positive factor, and a bound of the slope of that.
        let (zero_with_rate, steepest): (Box<dyn Fn(f64) -> f64>, f64) = match *self {
            Self::Beat(sines) => {
                let steepest = sines
                    .iter()
                    .map(|sine| sine.amplitude.abs() * sine.frequency_rad_s.powi(2))
                    .sum();
                (Box::new(|since_s| self.at(since_s).1), steepest)
            }
            Self::Gabor {
                centre_s,
                frequency_rad_s,
                train,
            } => {
                let bend = 2.0 / (train.cycles * train.cycles);
                let rate = move |since_s: f64| {
                    let angle = frequency_rad_s * (since_s - centre_s);
                    let (sin, cos) = (angle + train.phase_rad).sin_cos();
                    -(bend * angle * cos + sin)
                };
                let widest = frequency_rad_s * centre_s;
                let steepest = frequency_rad_s * (bend * (1.0 + widest) + 1.0);
                (Box::new(rate), steepest)
            }
            Self::Sine(_) | Self::Ricker { .. } | Self::AntisymmetricRicker { .. } => {
                unreachable!("their extrema are known in closed form")
            }
        };
        // Two extrema at a distance h differ by h^3/12 times the third derivative at most, here by about
        // 1e-12 of the amplitude.
        let resolution_s = 1e-5 * period_s;
        zeros(zero_with_rate, steepest, length_s, resolution_s)
    }
}

/// The zeros of `function` between 0 and `end` at which it changes its sign, in order, to rounding.
/// `steepest` bounds the magnitude of its slope.
///
/// A part in whose middle the function is farther from zero than it can fall over the length of the part
/// has no zero, not even at its ends to rounding; others are halved. Pairs of zeros closer than `resolution` may be missed.
fn zeros(function: impl Fn(f64) -> f64, steepest: f64, end: f64, resolution: f64) -> Vec<f64> {
    let mut zeros = Vec::new();
    let mut parts = vec![(0.0, end)];
    while let Some((low, high)) = parts.pop() {
        let middle = 0.5 * (low + high);
        let half = 0.5 * (high - low);
        if function(middle).abs() > steepest * (high - low) {
            continue;
        }
        if half > resolution {
            parts.extend([(middle, high), (low, middle)]);
        } else {
            let starts_positive = function(low) > 0.0;
            if (function(high) > 0.0) != starts_positive {
                zeros.push(bisect(low, high, |at| {
                    (function(at) > 0.0) == starts_positive
                }));
            }
        }
    }
    zeros
}

/// The time at which `early` turns from true to false.
fn bisect(start_s: f64, end_s: f64, early: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (start_s, end_s);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if early(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// One-sided formula of a piece in the time since its origin, horizontal and vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Formula {
    Linear {
        at_origin: Vector2<f64>,
        slope: Vector2<f64>,
    },
    Shaped {
        amplitude: Vector2<f64>,
        shape: Shape,
    },
}

impl Formula {
    fn constant(acceleration: Vector2<f64>) -> Self {
        Self::Linear {
            at_origin: acceleration,
            slope: Vector2::zeros(),
        }
    }

    /// Acceleration and its rate of change.
    fn at(&self, since_s: f64) -> (Vector2<f64>, Vector2<f64>) {
        match *self {
            Self::Linear { at_origin, slope } => (at_origin + slope * since_s, slope),
            Self::Shaped { amplitude, shape } => {
                let (value, rate) = shape.at(since_s);
                (amplitude * value, amplitude * rate)
            }
        }
    }

    /// Integral of the acceleration between two times.
    fn integral(&self, from_s: f64, to_s: f64) -> Vector2<f64> {
        match *self {
            Self::Linear { at_origin, slope } => {
                (at_origin + slope * (0.5 * (from_s + to_s))) * (to_s - from_s)
            }
            Self::Shaped { amplitude, shape } => amplitude * shape.integral(from_s, to_s),
        }
    }
}

/// A piece of ground motion: smooth, and every combination of its components monotone, from its start to
/// its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Start, in seconds.
    pub start_s: f64,
    /// End, in seconds; infinite for the last piece.
    pub end_s: f64,
    /// Time that the formula counts from.
    origin_s: f64,
    formula: Formula,
    /// Velocity of the ground at the start.
    start_m_s: Vector2<f64>,
}

impl Piece {
    /// Acceleration in m/s2 and its rate of change in m/s3, both horizontal and vertical (positive to the
    /// right and upwards), at a time in the piece, the ends included, as the limit from inside.
    #[must_use]
    pub fn at(&self, time_s: f64) -> (Vector2<f64>, Vector2<f64>) {
        self.formula.at(time_s - self.origin_s)
    }

    /// Velocity of the ground in m/s, horizontal and vertical, at a time in the piece, its ends included: the
    /// integral of the acceleration since time zero, in closed form.
    #[must_use]
    pub fn velocity_m_s(&self, time_s: f64) -> Vector2<f64> {
        let (from_s, to_s) = (self.start_s - self.origin_s, time_s - self.origin_s);
        self.start_m_s + self.formula.integral(from_s, to_s)
    }

    /// Horizontal acceleration in m/s2, as [`Piece::at`].
    #[must_use]
    pub fn acceleration_m_s2(&self, time_s: f64) -> f64 {
        self.at(time_s).0.x
    }

    /// Vertical acceleration in m/s2, as [`Piece::at`].
    #[must_use]
    pub fn vertical_m_s2(&self, time_s: f64) -> f64 {
        self.at(time_s).0.y
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
            Formula::Shaped { .. } => 0.25 * (self.end_s - self.start_s),
        }
    }

    /// The accelerations at both ends, between which all others lie.
    fn ends_m_s2(&self) -> [Vector2<f64>; 2] {
        if self.is_quiet_for_good() {
            [Vector2::zeros(); 2]
        } else {
            [self.start_s, self.end_s].map(|time_s| self.at(time_s).0)
        }
    }
}

/// Corners of a record that are closer than this, in seconds, are one.
const LEAST_SPACING_S: f64 = 1e-9;

/// Ground acceleration from time zero on, zero after the last corner.
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

    /// A single horizontal pulse that starts at `start_s >= 0`, with peak acceleration `amplitude_m_s2` and
    /// length `duration_s > 0`.
    #[must_use]
    pub fn pulse(pulse: Pulse, amplitude_m_s2: f64, duration_s: f64, start_s: f64) -> Self {
        Self::pulse_along(
            pulse,
            Vector2::new(amplitude_m_s2, 0.0),
            duration_s,
            start_s,
            WaveTrain::default(),
        )
    }

    /// A single pulse, as [`GroundMotion::pulse`], with horizontal and vertical peak accelerations of one
    /// common shape. `train` matters only to pulses that are wave trains.
    #[must_use]
    pub fn pulse_along(
        pulse: Pulse,
        amplitude_m_s2: Vector2<f64>,
        duration_s: f64,
        start_s: f64,
        train: WaveTrain,
    ) -> Self {
        let (a, t) = (amplitude_m_s2, duration_s);
        let shaped = |shape: Shape| Formula::Shaped {
            amplitude: a,
            shape,
        };
        let sine = |periods: f64, phase_rad: f64| {
            shaped(Shape::Sine(Sine {
                amplitude: 1.0,
                frequency_rad_s: periods * 2.0 * PI / t,
                phase_rad,
            }))
        };
        let cut =
            |ends: &[f64], formula: Formula| ends.iter().map(|end| (end * t, formula)).collect();
        let pieces: Vec<_> = match pulse {
            Pulse::Rectangular => vec![(t, Formula::constant(a))],
            Pulse::StepPair => {
                vec![
                    (t, Formula::constant(a)),
                    (3.0 * t, Formula::constant(-0.5 * a)),
                ]
            }
            Pulse::HalfSine => cut(&[0.5, 1.0], sine(0.5, 0.0)),
            Pulse::OneSine => cut(&[0.25, 0.75, 1.0], sine(1.0, 0.0)),
            Pulse::OneCosine => cut(&[0.5, 1.0], sine(1.0, 0.5 * PI)),
            Pulse::Triangular => {
                let slope = 2.0 * a / t;
                let up = Formula::Linear {
                    at_origin: Vector2::zeros(),
                    slope,
                };
                let down = Formula::Linear {
                    at_origin: 2.0 * a,
                    slope: -slope,
                };
                vec![(0.5 * t, up), (t, down)]
            }
            Pulse::Ricker => {
                // The troughs of the wavelet are at x^2 = 3/2.
                let trough = 1.5_f64.sqrt() / PI;
                let ricker = shaped(Shape::Ricker { period_s: t });
                cut(&[2.0 - trough, 2.0, 2.0 + trough, 4.0], ricker)
            }
            Pulse::AntisymmetricRicker => {
                // The extrema are the zeros of the Hermite polynomial y^4 - 6 y^2 + 3.
                let [inner, outer] = [-1.0, 1.0].map(|sign| (3.0 + sign * 6.0_f64.sqrt()).sqrt());
                let peak = inner * 6.0_f64.sqrt() * (-0.5 * inner * inner).exp();
                let ends =
                    [-outer, -inner, inner, outer].map(|y| 2.5 + y * 3.0_f64.sqrt() / (2.0 * PI));
                let wavelet = Formula::Shaped {
                    amplitude: a / peak,
                    shape: Shape::AntisymmetricRicker { period_s: t },
                };
                cut(&[ends[0], ends[1], ends[2], ends[3], 5.0], wavelet)
            }
            Pulse::MavroeidisPapageorgiou => {
                // The product of cosines is a sum of three; about its middle the derivative is this.
                let length_s = train.cycles * t;
                let term = |part: f64, periods: f64| {
                    let frequency_rad_s = periods * 2.0 * PI / t;
                    Sine {
                        amplitude: -part * periods,
                        frequency_rad_s,
                        phase_rad: train.phase_rad - 0.5 * frequency_rad_s * length_s,
                    }
                };
                let side = 1.0 / train.cycles;
                let shape =
                    Shape::Beat([term(1.0, 1.0), term(0.5, 1.0 - side), term(0.5, 1.0 + side)]);
                train_pieces(a, shape, length_s, t)
            }
            Pulse::Gabor => {
                let centre_s = 3.0 * train.cycles * t / PI;
                let shape = Shape::Gabor {
                    centre_s,
                    frequency_rad_s: 2.0 * PI / t,
                    train,
                };
                train_pieces(a, shape, 2.0 * centre_s, t)
            }
            Pulse::WindowedSine => {
                // sin^2(w s / (2 n)) is (1 - cos(w s / n)) / 2.
                let term = |amplitude: f64, periods: f64| Sine {
                    amplitude,
                    frequency_rad_s: periods * 2.0 * PI / t,
                    phase_rad: train.phase_rad,
                };
                let side = 1.0 / train.cycles;
                let shape = Shape::Beat([
                    term(0.5, 1.0),
                    term(-0.25, 1.0 - side),
                    term(-0.25, 1.0 + side),
                ]);
                train_pieces(a, shape, train.cycles * t, t)
            }
        };
        Self::from_pieces(start_s, pieces)
    }

    /// Recorded motion: straight lines between samples `(time in s, acceleration in m/s2)`, zero before the
    /// first and after the last. Either component may be empty.
    ///
    /// Times count from `start_s`; they increase, and none falls before time zero.
    #[must_use]
    pub fn record(horizontal: &[(f64, f64)], vertical: &[(f64, f64)], start_s: f64) -> Self {
        let mut corners: Vec<f64> = horizontal.iter().chain(vertical).map(|s| s.0).collect();
        corners.sort_unstable_by(f64::total_cmp);
        corners.dedup_by(|later, earlier| *later - *earlier < LEAST_SPACING_S);
        let mut components = [Polyline::new(horizontal), Polyline::new(vertical)];
        let lines = corners.windows(2).map(|ends| {
            let [x, y] = components
                .each_mut()
                .map(|component| component.line(ends[0], ends[1]));
            let formula = Formula::Linear {
                at_origin: Vector2::new(x.0, y.0),
                slope: Vector2::new(x.1, y.1),
            };
            (start_s + ends[1], start_s + ends[0], formula)
        });
        let first_s = start_s + corners.first().copied().unwrap_or(0.0);
        Self::join(first_s, lines)
    }

    /// Pieces given by their ends and formulas in the time since `start_s`.
    fn from_pieces(start_s: f64, formulas: Vec<(f64, Formula)>) -> Self {
        let formulas = formulas.into_iter();
        Self::join(
            start_s,
            formulas.map(|(end, formula)| (start_s + end, start_s, formula)),
        )
    }

    /// Quiet until `start_s`, then the pieces given by end, origin and formula, then quiet for good.
    fn join(start_s: f64, moving: impl Iterator<Item = (f64, f64, Formula)>) -> Self {
        let quiet = |end_s: f64| (end_s, start_s, Formula::constant(Vector2::zeros()));
        let all = [quiet(start_s)]
            .into_iter()
            .chain(moving)
            .chain([quiet(f64::INFINITY)]);
        let mut pieces: Vec<Piece> = Vec::new();
        let mut piece_start_s = 0.0;
        for (end_s, origin_s, formula) in all {
            // Nothing is left of a piece that is shorter than the spacing of times around it.
            if end_s > piece_start_s {
                let start_m_s = pieces.last().map_or(Vector2::zeros(), |before| {
                    before.velocity_m_s(piece_start_s)
                });
                pieces.push(Piece {
                    start_s: piece_start_s,
                    end_s,
                    origin_s,
                    formula,
                    start_m_s,
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

    /// Largest magnitudes of the horizontal and the vertical acceleration up to a time, in m/s2: pieces are
    /// monotone, so they are at ends of pieces, or at that time.
    #[must_use]
    pub fn peaks_m_s2(&self, until_s: f64) -> Vector2<f64> {
        let pieces = self.pieces.iter().filter(|piece| piece.start_s < until_s);
        pieces
            .filter(|piece| !piece.is_quiet_for_good())
            .flat_map(|piece| {
                [piece.start_s, piece.end_s.min(until_s)].map(|t| piece.at(t).0.abs())
            })
            .fold(Vector2::zeros(), |peaks, at| peaks.sup(&at))
    }

    /// Velocity of the ground in m/s, horizontal and vertical, at a time that is not negative, when it starts
    /// from rest: the integral of its acceleration, in closed form.
    #[must_use]
    pub fn velocity_m_s(&self, time_s: f64) -> Vector2<f64> {
        let after = self.pieces.partition_point(|piece| piece.start_s <= time_s);
        self.pieces[after.max(1) - 1].velocity_m_s(time_s)
    }

    /// When the ground falls quiet for good, in seconds.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.pieces.last().map_or(0.0, |piece| piece.start_s)
    }

    /// Whether the ground ever moves vertically.
    #[must_use]
    pub fn has_vertical(&self) -> bool {
        let mut ends = self.pieces.iter().flat_map(Piece::ends_m_s2);
        ends.any(|end| end.y != 0.0)
    }

    /// The first time at which the ground falls as fast as a free body or faster, `g + a_v <= 0`, so that
    /// nothing presses a structure on it any more; `None` if that never happens.
    #[must_use]
    pub fn free_fall_s(&self, gravity_m_s2: f64) -> Option<f64> {
        let falls = |acceleration: Vector2<f64>| gravity_m_s2 + acceleration.y <= 0.0;
        let piece = self
            .pieces
            .iter()
            .find(|piece| piece.ends_m_s2().into_iter().any(falls))?;
        if falls(piece.ends_m_s2()[0]) {
            return Some(piece.start_s);
        }
        let pressed = |time_s: f64| !falls(piece.at(time_s).0);
        Some(bisect(piece.start_s, piece.end_s, pressed))
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
                rest.start_m_s = rest.velocity_m_s(*time);
                rest.start_s = *time;
                pieces.insert(index + 1, rest);
            }
        }
        Self { pieces }
    }
}

/// The pieces of a wave train, cut at its extrema and scaled so that the largest is the amplitude.
fn train_pieces(
    amplitude: Vector2<f64>,
    shape: Shape,
    length_s: f64,
    period_s: f64,
) -> Vec<(f64, Formula)> {
    let mut ends = shape.extrema_s(length_s, period_s);
    ends.push(length_s);
    // Where the train begins it is no stronger than at its strongest extremum or its end.
    let peak = ends
        .iter()
        .map(|end| shape.at(*end).0.abs())
        .fold(0.0, f64::max);
    let formula = Formula::Shaped {
        amplitude: amplitude / peak,
        shape,
    };
    ends.into_iter().map(|end| (end, formula)).collect()
}

/// Straight lines between samples, asked for from left to right.
struct Polyline<'a> {
    samples: &'a [(f64, f64)],
}

impl<'a> Polyline<'a> {
    const fn new(samples: &'a [(f64, f64)]) -> Self {
        Self { samples }
    }

    /// Value at `start` and slope of the line that holds between two times, which no sample parts.
    fn line(&mut self, start: f64, end: f64) -> (f64, f64) {
        let middle = 0.5 * (start + end);
        while self.samples.len() > 1 && self.samples[1].0 <= middle {
            self.samples = &self.samples[1..];
        }
        match *self.samples {
            [(t0, a0), (t1, a1), ..] if t0 <= middle => {
                let slope = (a1 - a0) / (t1 - t0);
                (a0 + slope * (start - t0), slope)
            }
            _ => (0.0, 0.0),
        }
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

    /// Wave trains with all sorts of parameters.
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

    #[test]
    fn combinations_of_the_components_are_monotone_and_the_jerk_is_the_derivative() {
        let default = WaveTrain::default();
        let plain = Pulse::ALL.iter().map(|pulse| (*pulse, default));
        let amplitude = Vector2::new(-3.0, 1.5);
        for (pulse, train) in plain.chain(trains()) {
            let ground = GroundMotion::pulse_along(pulse, amplitude, 0.4, 0.2, train);
            for piece in ground.pieces() {
                let end = piece.end_s.min(piece.start_s + 10.0);
                let at = |i: i32| piece.start_s + (end - piece.start_s) * f64::from(i) / 100.0;
                for direction in [Vector2::x(), Vector2::y(), Vector2::new(-1.0, 0.35)] {
                    let along = |i: i32| piece.at(at(i)).0.dot(&direction);
                    let rises = (0..100).map(|i| along(i + 1) - along(i));
                    let (up, down) = rises.fold((0.0_f64, 0.0_f64), |(up, down), rise| {
                        (up.max(rise), down.min(rise))
                    });
                    // Sums of angles up to 250 are rounded to 3e-14.
                    assert!(up < 2e-13 || down > -2e-13, "{pulse:?} {train:?} {piece:?}");
                }
                let (middle, h) = (at(37), 1e-6);
                let slope = (piece.at(middle + h).0 - piece.at(middle - h).0) / (2.0 * h);
                assert!(
                    (slope - piece.at(middle).1).norm() < 1e-6,
                    "{pulse:?} {train:?}"
                );
            }
        }
    }

    #[test]
    fn wave_trains_reach_their_amplitude_and_not_more() {
        for (pulse, train) in trains() {
            let amplitude = Vector2::new(2.0, 0.0);
            let ground = GroundMotion::pulse_along(pulse, amplitude, 0.3, 0.1, train);
            assert!((ground.peaks_m_s2(f64::INFINITY).x - 2.0).abs() < 1e-12);
            // The pieces end at the extrema: nothing between is beyond.
            let moving = ground.pieces().iter().filter(|p| !p.is_quiet_for_good());
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
        let piece = ground.pieces().iter().rfind(|p| p.start_s <= time_s);
        piece.unwrap().acceleration_m_s2(time_s)
    }

    /// The formulas as they are published, up to the factor of the amplitude.
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
            let ground = GroundMotion::pulse_along(pulse, Vector2::x(), t, 0.0, train);
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
        let ground = GroundMotion::pulse(Pulse::AntisymmetricRicker, 1.0, t, 0.0);
        for since in [0.1, 0.4, 0.7, 0.75, 0.9, 1.2] {
            let y = 2.0 * PI * (since - 2.5 * t) / (3.0_f64.sqrt() * t);
            let published = (y * y * y - 3.0 * y) * (-0.5 * y * y).exp() / b;
            let ours = acceleration_at(&ground, since);
            // b is published with five digits.
            assert!((ours - published).abs() < 4e-5, "{since}");
        }
        assert!((ground.peaks_m_s2(f64::INFINITY).x - 1.0).abs() < 1e-14);
    }

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
        assert!(velocity(Pulse::AntisymmetricRicker).abs() < 1e-12);
        assert!(velocity(Pulse::MavroeidisPapageorgiou).abs() < 1e-12);
        assert!(velocity(Pulse::WindowedSine).abs() < 1e-12);
        // The Fourier transform of the bell; the peak is in the middle.
        let gabor = 2.0 * 0.3 / PI.sqrt() * (-1.0_f64).exp();
        assert!((velocity(Pulse::Gabor) - gabor).abs() < 1e-12);
    }

    /// Simpson's rule on parts that respect the corners errs by the fourth power of their length, below 1e-11.
    #[test]
    fn the_velocity_is_the_integral_of_the_acceleration() {
        let simple = [
            Pulse::Rectangular,
            Pulse::StepPair,
            Pulse::HalfSine,
            Pulse::OneSine,
            Pulse::OneCosine,
            Pulse::Triangular,
            Pulse::Ricker,
            Pulse::AntisymmetricRicker,
        ];
        let simple = simple.map(|pulse| (pulse, WaveTrain::default()));
        let amplitude = Vector2::new(2.0, -0.7);
        for (pulse, train) in trains().chain(simple) {
            let ground = GroundMotion::pulse_along(pulse, amplitude, 0.3, 0.1, train);
            let (mut velocity, n) = (Vector2::zeros(), 400);
            for piece in ground.pieces().iter().filter(|p| p.end_s.is_finite()) {
                let h = (piece.end_s - piece.start_s) / f64::from(n);
                for i in 0..n {
                    let time = piece.start_s + h * f64::from(i);
                    let miss: Vector2<f64> = ground.velocity_m_s(time) - velocity;
                    assert!(miss.norm() < 1e-10, "{pulse:?} {train:?} {time} {miss}");
                    let at = |part: f64| piece.at(time + part * h).0;
                    velocity += (at(0.0) + at(0.5) * 4.0 + at(1.0)) * (h / 6.0);
                }
            }
            assert!((ground.velocity_m_s(100.0) - velocity).norm() < 1e-10);
        }
        let record = GroundMotion::record(&[(0.5, 1.0), (1.0, -2.0), (1.5, 0.5)], &[], 0.25);
        // Trapezia of -1/2 * 1/2 and -3/2 * 1/2.
        assert!((record.velocity_m_s(1.25).x + 0.25).abs() < 1e-15);
        assert!((record.velocity_m_s(9.0).x + 0.625).abs() < 1e-15);
        let cut = record.cut_at(&[0.9, 1.4]);
        assert!((cut.velocity_m_s(1.6) - record.velocity_m_s(1.6)).norm() < 1e-15);
    }

    #[test]
    fn records_are_straight_lines_between_their_samples() {
        let horizontal = [(0.5, 1.0), (1.0, -2.0), (1.5, 0.5)];
        let vertical = [(0.75, 4.0), (1.0 + 1e-12, 2.0), (3.0, 0.0)];
        let ground = GroundMotion::record(&horizontal, &vertical, 0.25);
        let corners: Vec<_> = ground.pieces().iter().map(|p| p.start_s).collect();
        assert_eq!(corners, [0.0, 0.75, 1.0, 1.25, 1.75, 3.25]);
        let at = |time: f64| {
            let piece = ground.pieces().iter().rfind(|p| p.start_s <= time).unwrap();
            piece.at(time).0
        };
        for (time, x, y) in [
            (0.7, 0.0, 0.0),
            (0.75, 1.0, 0.0),
            (1.0, -0.5, 4.0),
            (1.125, -1.25, 3.0),
            (1.25, -2.0, 2.0),
            (1.5, -0.75, 1.75),
            (1.75, 0.0, 1.5),
            (2.25, 0.0, 1.0),
            (3.25, 0.0, 0.0),
        ] {
            assert!((at(time) - Vector2::new(x, y)).norm() < 1e-11, "{time}");
        }
        assert!(ground.has_vertical() && ground.peaks_m_s2(f64::INFINITY).x == 2.0);
        let none = GroundMotion::record(&[], &[], 0.25);
        assert!(none.pieces().len() == 2 && !none.has_vertical());
    }

    #[test]
    fn free_fall_is_found_at_corners_and_within_pieces() {
        let ground = |vertical: &[(f64, f64)]| GroundMotion::record(&[], vertical, 0.0);
        assert_eq!(ground(&[(0.0, 0.0), (1.0, -9.0)]).free_fall_s(9.81), None);
        let sloping = ground(&[(0.0, 0.0), (1.0, -20.0), (2.0, 5.0)]);
        assert!((sloping.free_fall_s(10.0).unwrap() - 0.5).abs() < 1e-15);
        assert_eq!(
            ground(&[(0.5, -12.0), (1.0, 0.0)]).free_fall_s(9.81),
            Some(0.5)
        );
        let wave = |a| {
            GroundMotion::pulse_along(
                Pulse::OneSine,
                Vector2::new(1.0, a),
                1.0,
                0.0,
                WaveTrain::default(),
            )
        };
        assert_eq!(wave(9.0).free_fall_s(9.81), None);
        // 20 sin(2 pi s) = -10 first at 7/12.
        assert!((wave(20.0).free_fall_s(10.0).unwrap() - 7.0 / 12.0).abs() < 1e-14);
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
