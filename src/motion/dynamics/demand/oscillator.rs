//! Response spectrum of a record: peaks of damped oscillators, exact for accelerations that are linear between samples, except for peaks between
//! steps (Nigam and Jennings, "Calculation of response spectra from strong-motion earthquake records", Bulletin of the Seismological Society of
//! America 59, 1969).

use std::f64::consts::PI;

/// Computes the spectral displacement of samples: increasing times in seconds, and accelerations. It is the largest displacement relative to the
/// ground, up to the last sample, of an oscillator of this period and damping that is at rest before the first sample. Its unit is that of the
/// accelerations, times s2.
///
/// Over equal steps the motion follows one linear map. The relative error of a peak between two steps is at most `(pi h / T)^2 / 2` for the step `h`;
/// steps are cut until this is below a thousandth.
pub fn peak_displacement(samples: &[(f64, f64)], period_s: f64, damping_percent: f64) -> f64 {
    let omega = 2.0 * PI / period_s;
    let mut state = [0.0, 0.0];
    let mut peak = 0.0_f64;
    let mut known: Option<(f64, Advance)> = None;
    for pair in samples.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let whole_s = to.0 - from.0;
        let pieces = (whole_s / (0.014 * period_s)).ceil().max(1.0);
        let step_s = whole_s / pieces;
        let advance = match known {
            // Times of equal steps differ by rounding errors.
            Some((step, advance)) if (step / step_s - 1.0).abs() < 1e-9 => advance,
            _ => Advance::new(omega, damping_percent / 100.0, step_s),
        };
        known = Some((step_s, advance));
        let slope = (to.1 - from.1) / pieces;
        let mut ground = from.1;
        let mut piece = 0.0;
        while piece < pieces {
            state = advance.apply(state, ground, ground + slope);
            ground += slope;
            piece += 1.0;
            peak = peak.max(state[0].abs());
        }
    }
    peak
}

/// Coefficients of displacement and velocity of an oscillator after a step.
#[derive(Clone, Copy, Debug)]
struct Advance {
    /// Of displacement and velocity before.
    own: [[f64; 2]; 2],
    /// Of the ground's acceleration at the beginning and at the end.
    forced: [[f64; 2]; 2],
}

impl Advance {
    /// Computes the coefficients for a step. With `x'' + 2 z w x' + w^2 x = -(a + b s)`, the particular motion is `-(a + b s) / w^2 + 2 z b / w^3`.
    fn new(omega: f64, ratio: f64, step_s: f64) -> Self {
        let damped = omega * (1.0 - ratio * ratio).sqrt();
        let decay = libm::exp(-ratio * omega * step_s);
        let (sin, cos) = libm::sincos(damped * step_s);
        let lean = ratio * omega / damped;
        let own = [
            [decay * (cos + lean * sin), decay * sin / damped],
            [
                -decay * omega * omega / damped * sin,
                decay * (cos - lean * sin),
            ],
        ];
        // The particular motion for a constant and for a slope of one, at both ends of the step.
        let square = omega * omega;
        let constant = -1.0 / square;
        let sloped = |s: f64| -s / square + 2.0 * ratio / (square * omega);
        let response = |start: [f64; 2], end: [f64; 2]| -> [f64; 2] {
            std::array::from_fn(|i| end[i] - own[i][0] * start[0] - own[i][1] * start[1])
        };
        let of_constant = response([constant, 0.0], [constant, 0.0]);
        let of_slope = response([sloped(0.0), constant], [sloped(step_s), constant]);
        let forced = std::array::from_fn(|i| {
            let end = of_slope[i] / step_s;
            [of_constant[i] - end, end]
        });
        Self { own, forced }
    }

    fn apply(&self, state: [f64; 2], from: f64, to: f64) -> [f64; 2] {
        std::array::from_fn(|i| {
            self.own[i][0] * state[0]
                + self.own[i][1] * state[1]
                + self.forced[i][0] * from
                + self.forced[i][1] * to
        })
    }
}
