//! Synthetic ground motions, the files with them, and the histories of an arch under them.

use std::f64::consts::PI;
use std::fmt::Write as _;

pub use crate::common::{Random, semicircle};
use archrock::{FourLinks, GroundMotion, History, Initial, Model as _, Request, Sample};

pub const G: f64 = 9.81;

/// History with samples every 5 ms. It comes to rest below 1e-8 of the energy barrier for the gravity `G`,
/// whatever the actual gravity.
pub fn run(
    model: &FourLinks,
    ground: &GroundMotion,
    gravity_m_s2: f64,
    initial: Option<Initial>,
    end_s: f64,
) -> (History, Vec<Sample>) {
    let request = Request {
        gravity_m_s2,
        end_s,
        outcome_by_s: None,
        output_step_s: 0.005,
        initial,
        relative_tolerance: 1e-10,
        rest_energy_ratio: 1e-8 * G / gravity_m_s2,
    };
    let history = model.history(ground, &request).unwrap();
    let samples = history.samples.iter().collect();
    (history, samples)
}

/// An earthquake from a seed: forty waves of 0.3 to 8 Hz with random phases, weaker at higher frequencies, which swell
/// over the first tenth of the duration and fade over the second half, with a peak of 1.
pub fn synthetic(seed: u64, duration_s: f64, step_s: f64) -> Vec<(f64, f64)> {
    let mut random = Random(seed);
    let waves: Vec<_> = (0..40)
        .map(|_| {
            let frequency = 0.3 * (8.0_f64 / 0.3).powf(random.next());
            (frequency, 2.0 * PI * random.next())
        })
        .collect();
    let count = (duration_s / step_s).round() as i32;
    let mut samples: Vec<_> = (0..count)
        .map(|i| {
            let time = f64::from(i) * step_s;
            let part = time / duration_s;
            let envelope = (10.0 * part).min(1.0) * (2.0 - 2.0 * part).min(1.0);
            let wave = |&(f, phase): &(f64, f64)| (2.0 * PI * f * time + phase).sin() / f.sqrt();
            (time, envelope * waves.iter().map(wave).sum::<f64>())
        })
        .collect();
    let peak = samples.iter().map(|s| s.1.abs()).fold(0.0, f64::max);
    for sample in &mut samples {
        sample.1 /= peak;
    }
    samples
}

pub fn scaled(samples: &[(f64, f64)], factor: f64) -> Vec<(f64, f64)> {
    samples.iter().map(|&(t, a)| (t, a * factor)).collect()
}

/// A number as Fortran's `Ew.d` writes it, without a zero before the point: ` .1234567E-02`.
fn fortran(x: f64, digits: usize) -> String {
    let scientific = format!("{:.*e}", digits - 1, x.abs());
    let (mantissa, exponent) = scientific.split_once('e').unwrap();
    let exponent = exponent.parse::<i32>().unwrap() + i32::from(x != 0.0);
    let sign = if x < 0.0 { '-' } else { ' ' };
    let digits = mantissa.replace('.', "");
    let sign_of_exponent = if exponent < 0 { '-' } else { '+' };
    format!("{sign}.{digits}E{sign_of_exponent}{:02}", exponent.abs())
}

/// Layout of an AT2 file.
pub struct Style {
    /// The line with `{npts}` and `{dt}`.
    pub counts: &'static str,
    pub per_line: usize,
    /// Text between values; if empty, only signs separate them, or the blank in place of a sign.
    pub gap: &'static str,
    pub line_end: &'static str,
}

/// The style of the NGA-West2 database.
pub const NGA_WEST2: Style = Style {
    counts: "NPTS=  {npts}, DT=   {dt} SEC",
    per_line: 5,
    gap: "  ",
    line_end: "\n",
};

/// The text of an AT2 file with evenly spaced samples.
pub fn at2(samples: &[(f64, f64)], title: &str, style: &Style) -> String {
    let step_s = samples[1].0 - samples[0].0;
    let counts = style.counts;
    let counts = counts.replace("{npts}", &samples.len().to_string());
    let counts = counts.replace("{dt}", &format!("{step_s:.4}"));
    let mut text = format!(
        "PEER NGA STRONG MOTION DATABASE RECORD (FORMAT ONLY)\n{title}\n\
         ACCELERATION TIME SERIES IN UNITS OF G\n{counts}\n"
    );
    for line in samples.chunks(style.per_line) {
        let values: Vec<_> = line.iter().map(|s| fortran(s.1, 7)).collect();
        let _ = writeln!(text, "{}", values.join(style.gap));
    }
    text.replace('\n', style.line_end)
}
