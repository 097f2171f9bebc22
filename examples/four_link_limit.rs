//! How far four links can be trusted: thresholds with four links and with free hinges, for 300 random arches and pulses, over the excess of the
//! thrust line. Prints a table and writes a picture. Run with
//! `cargo run --release --example four_link_limit docs/pictures/four-link-limit.svg`.

#![allow(clippy::print_stdout, reason = "an example prints its results")]
#![allow(
    clippy::disallowed_methods,
    reason = "digits of an example may depend on the machine"
)]

use std::error::Error;
use std::fmt::Write as _;
use std::ops::ControlFlow;

use archrock::{
    Arch, FourLinks, FreeHinges, ImpactModel, Model, Outcome, Pulse, PulseShape, Recorder, Request,
    Sample,
};

const GRAVITY_M_S2: f64 = 9.81;
/// The limit of the program, in thicknesses.
const MODEL_LIMIT: f64 = 0.5;
/// Amplitudes are tried from the incipient one up to this multiple of it, in these strides; bisection encloses an edge to a tenth of a stride.
const MOST: f64 = 40.0;
const STRIDE: f64 = 1.15;
const BISECTIONS: u32 = 4;
/// Ratios of the thresholds below which four links are called unsafe, and above which they are called too safe.
const AGREEMENT: [f64; 2] = [0.8, 1.25];

/// Random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let part = ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
        low + part * (high - low)
    }

    /// Logarithmically uniform.
    fn scaled(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }
}

/// Ends a history on quiet ground: a motion with a quarter of the energy that overturns it survives.
struct Stop {
    quiet_s: f64,
}

impl Recorder for Stop {
    fn wants_demand(&self) -> bool {
        false
    }

    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        let is_safe = sample.energy_ratio.is_some_and(|ratio| ratio < 0.25);
        match sample.time_s > self.quiet_s && is_safe {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

/// A history: whether the arch overturns, and the excess of the thrust line of four links.
fn history(model: &dyn Model, pulse: &PulseShape, amplitude_g: f64) -> Option<(bool, f64)> {
    let ground = pulse.horizontal_m_s2(amplitude_g * GRAVITY_M_S2).ok()?;
    let quiet_s = ground.end_s();
    let request = Request {
        end_s: quiet_s + 20.0,
        ..Request::default()
    };
    let mut stop = Stop { quiet_s };
    let found = model.simulate(&ground, &request, Some(&mut stop)).ok()?;
    let overturns = matches!(found.outcome, Outcome::Overturned(_));
    Some((overturns, found.thrust_excess_ratio().unwrap_or(0.0)))
}

/// Largest excess, in thicknesses, that counts in the lasting excess.
const LARGEST_LASTING: f64 = 2.0;

/// Integrates the excess of the thrust line over time, up to the largest rotation.
#[derive(Default)]
struct Lasting {
    /// Time and excess of the last sample, and the integral up to it.
    last: (f64, f64),
    integral_s: f64,
    /// Largest rotation over the critical one, and the integral up to it.
    peak: f64,
    at_peak_s: f64,
}

impl Recorder for Lasting {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        let rotation = sample.rotation_over_critical.unwrap_or(0.0).abs();
        if rotation > 1.0 {
            self.at_peak_s = self.integral_s;
            return ControlFlow::Break(());
        }
        let now = (
            sample.time_s,
            sample.demand.excess_ratio.min(LARGEST_LASTING),
        );
        self.integral_s += 0.5 * (now.1 + self.last.1) * (now.0 - self.last.0);
        self.last = now;
        if rotation > self.peak {
            (self.peak, self.at_peak_s) = (rotation, self.integral_s);
        }
        ControlFlow::Continue(())
    }
}

/// The lasting excess of four links over sqrt(R/g).
fn lasting_excess(
    arch: &Arch,
    model: &dyn Model,
    pulse: &PulseShape,
    amplitude_g: f64,
) -> Option<f64> {
    let ground = pulse.horizontal_m_s2(amplitude_g * GRAVITY_M_S2).ok()?;
    let request = Request {
        end_s: ground.end_s() + 20.0,
        output_step_s: 1e-3,
        ..Request::default()
    };
    let mut lasting = Lasting::default();
    model.simulate(&ground, &request, Some(&mut lasting)).ok()?;
    Some(lasting.at_peak_s / (arch.mean_radius_m / GRAVITY_M_S2).sqrt())
}

/// Lowest amplitude that overturns the arch, in g, with the excess there; the largest amplitude if none does.
struct Threshold {
    amplitude_g: f64,
    excess_ratio: f64,
    is_found: bool,
}

fn threshold(model: &dyn Model, pulse: &PulseShape, from_g: f64) -> Option<Threshold> {
    let (mut below_g, mut amplitude_g) = (from_g, from_g);
    while !history(model, pulse, amplitude_g)?.0 {
        if amplitude_g > MOST * from_g {
            let (is_found, excess_ratio) = history(model, pulse, amplitude_g)?;
            return Some(Threshold {
                amplitude_g,
                excess_ratio,
                is_found,
            });
        }
        (below_g, amplitude_g) = (amplitude_g, amplitude_g * STRIDE);
    }
    for _ in 0..BISECTIONS {
        let middle_g = 0.5 * (below_g + amplitude_g);
        match history(model, pulse, middle_g)?.0 {
            true => amplitude_g = middle_g,
            false => below_g = middle_g,
        }
    }
    let (is_found, excess_ratio) = history(model, pulse, amplitude_g)?;
    Some(Threshold {
        amplitude_g,
        excess_ratio,
        is_found,
    })
}

/// Thresholds of an arch under a pulse.
struct Case {
    words: String,
    four: Threshold,
    free: Threshold,
    /// Integral of the excess of four links over time under their own threshold, over sqrt(R/g).
    lasting: f64,
    /// Excess with four links under the amplitude from which the arch overturns with free hinges.
    excess_at_free: f64,
}

impl Case {
    fn random(number: usize) -> Option<Self> {
        let mut random = Random(number as u64 + 1);
        let pulse = Pulse::ALL[number % Pulse::ALL.len()];
        let duration_s = random.scaled(0.1, 1.5);
        let (radius_m, embrace_deg) = (random.scaled(2.0, 10.0), random.between(90.0, 180.0));
        let thickness_ratio = random.between(0.06, 0.28);
        let voussoirs = random.scaled(12.0, 37.0) as usize;
        let arch = Arch::new(radius_m, thickness_ratio, embrace_deg).ok()?;
        let arch = arch.with_voussoirs(voussoirs).ok()?;
        let words = format!(
            "{:22} {duration_s:.3} {radius_m:6.3} {thickness_ratio:.3} {embrace_deg:5.1} {voussoirs:2}",
            pulse.name()
        );
        Self::of(words, &arch, &pulse.lasting_s(duration_s))
    }

    fn of(words: String, arch: &Arch, pulse: &PulseShape) -> Option<Self> {
        let from_g = arch.incipient().ok()?.acceleration_g;
        if from_g < 0.03 {
            return None;
        }
        let four_links = FourLinks::of_arch(arch, ImpactModel::MaxRestitution).ok()?;
        let free_hinges = FreeHinges::of_arch(arch).ok()?.for_many_cases()?;
        let four = threshold(&four_links, pulse, from_g)?;
        let free = threshold(&*free_hinges, pulse, from_g)?;
        // Beyond the largest amplitude, the models need not be compared.
        if !free.is_found {
            return None;
        }
        Some(Self {
            words,
            lasting: lasting_excess(arch, &four_links, pulse, four.amplitude_g)?,
            excess_at_free: history(&four_links, pulse, free.amplitude_g)?.1,
            four,
            free,
        })
    }

    fn ratio(&self) -> f64 {
        self.free.amplitude_g / self.four.amplitude_g
    }
}

/// Numbers of unsafe cases within the limit, of all unsafe ones, of agreeing cases beyond it, and of all agreeing ones.
fn errors(cases: &[Case], excess: fn(&Case) -> f64, limit: f64) -> [usize; 4] {
    let [low, high] = AGREEMENT;
    let count = |wanted: &dyn Fn(&Case) -> bool| cases.iter().filter(|case| wanted(case)).count();
    let unsafe_one = |case: &Case| !case.four.is_found || case.ratio() < low;
    let agrees = |case: &Case| !unsafe_one(case) && case.ratio() < high;
    let within = |case: &Case| excess(case) <= limit;
    [
        count(&|case| unsafe_one(case) && within(case)),
        count(&unsafe_one),
        count(&|case| agrees(case) && !within(case)),
        count(&agrees),
    ]
}

fn main() -> Result<(), Box<dyn Error>> {
    let first = std::env::args()
        .nth(2)
        .map_or(Ok(0), |first| first.parse())?;
    let cases: Vec<Case> = (first..).filter_map(Case::random).take(300).collect();
    println!(
        "pulse, duration, R, t/R, embrace, voussoirs | four links, free hinges (g), ratio | excess there"
    );
    for case in &cases {
        let least = if case.four.is_found { "" } else { ">" };
        println!(
            "{} | {least}{:.4} {:.4} {:.3} | {:.3} {:.3} {:.3}",
            case.words,
            case.four.amplitude_g,
            case.free.amplitude_g,
            case.ratio(),
            case.four.excess_ratio,
            case.excess_at_free,
            case.lasting
        );
    }
    let limits = [
        0.01, 0.05, 0.1, 0.167, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.5, 2.0, 5.0,
    ];
    let largest: fn(&Case) -> f64 = |case| case.four.excess_ratio;
    for (name, excess) in [("largest", largest), ("lasting", |case| case.lasting)] {
        println!("limit of the {name} excess | unsafe within it, of | agree beyond it, of");
        for limit in limits {
            let [missed, all_unsafe, alarms, all_agree] = errors(&cases, excess, limit);
            println!("{limit:5} | {missed:3} of {all_unsafe} | {alarms:3} of {all_agree}");
        }
    }
    let picture = std::env::args().nth(1);
    if let Some(path) = picture {
        std::fs::write(path, draw(&cases)?)?;
    }
    Ok(())
}

/// Draws the ratio of the thresholds over the excess, on logarithmic axes; a triangle if four links never overturn.
fn draw(cases: &[Case]) -> Result<String, std::fmt::Error> {
    let (width, height, left, bottom) = (640.0, 420.0, 70.0, 370.0);
    let ([x_low, x_high], [y_low, y_high]) = ([0.003_f64, 10_000.0_f64], [0.02_f64, 2.0_f64]);
    let x = |excess: f64| {
        let part = (excess.clamp(x_low, x_high) / x_low).ln() / (x_high / x_low).ln();
        left + part * (width - left - 20.0)
    };
    let y = |ratio: f64| {
        let part = (ratio.clamp(y_low, y_high) / y_low).ln() / (y_high / y_low).ln();
        bottom - part * (bottom - 30.0)
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    let (top, right, limit) = (y(y_high), x(x_high), x(MODEL_LIMIT));
    writeln!(
        svg,
        "<rect x=\"{limit:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#eeeeee\"/>\n\
         <text x=\"{:.1}\" y=\"{:.1}\">outside the model</text>",
        right - limit,
        bottom - top,
        limit + 6.0,
        top + 16.0
    )?;
    for ratio in [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0] {
        let at = y(ratio);
        writeln!(
            svg,
            "<path d=\"M{left} {at:.1}H{right:.1}\" stroke=\"#d0d0d0\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{ratio}</text>",
            left - 6.0,
            at + 4.0
        )?;
    }
    for excess in [0.01, 0.1, 0.5, 10.0, 100.0, 1000.0] {
        let at = x(excess);
        writeln!(
            svg,
            "<path d=\"M{at:.1} {bottom}V{top:.1}\" stroke=\"#d0d0d0\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{excess}</text>",
            bottom + 16.0
        )?;
    }
    for case in cases {
        let (at_x, at_y) = (x(case.four.excess_ratio), y(case.ratio()));
        match case.four.is_found {
            true => writeln!(
                svg,
                "<circle cx=\"{at_x:.1}\" cy=\"{at_y:.1}\" r=\"3\" fill=\"#0072b2\" fill-opacity=\"0.6\"/>"
            )?,
            false => writeln!(
                svg,
                "<path d=\"M{at_x:.1} {at_y:.1}m-4 -3h8l-4 7z\" fill=\"#d55e00\"/>"
            )?,
        }
    }
    writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">largest excess of the thrust line of four links, in thicknesses</text>\n\
         <text transform=\"translate(20 {:.1})rotate(-90)\" text-anchor=\"middle\">threshold: free hinges over four links</text>\n\
         <text x=\"{left}\" y=\"20\">triangles: four links never overturn (up to {MOST} times the incipient acceleration)</text>\n</svg>",
        0.5 * (left + right),
        height - 12.0,
        0.5 * (top + bottom)
    )?;
    Ok(svg)
}
