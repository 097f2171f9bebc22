//! Unlikely values of a record: its peak, its times, its baseline and its ends.

use std::ops::RangeInclusive;

use super::usual::PEAK;
use super::{Unlikely, plain};
use crate::scenario::{Baseline, Format, RecordedQuantity, Scaling, Series, Times};

/// Usual peaks of records, in g. The strongest recorded accelerations are a little above 2 g, and weaker ones than the lower limit move no
/// masonry. Other values are probably in another unit.
pub(super) const PEAK_G: RangeInclusive<f64> = 0.01..=3.0;
/// Longest usual step of a record, in s: records have 50 to 200 samples a second. Longer steps are probably in another unit.
const RECORD_STEP_S: f64 = 0.1;
/// Largest usual mean of a record, over its peak.
const OFFSET: f64 = 0.01;
/// Usual ratio of the largest velocity to the largest acceleration, in s: 0.011 to 0.40 s in 94 records of five networks, and 0.5 s on the lake bed of
/// Mexico City.
const VELOCITY_RATIO_S: RangeInclusive<f64> = 0.01..=0.6;
/// Largest usual acceleration at an end of a record, over its peak: at most 0.10 in these records.
const END_RATIO: f64 = 0.25;
/// Least number of changes of sign of an earthquake. Pulses in tables have fewer, and may have any mean, ends and duration.
const REVERSALS: usize = 20;

impl Series {
    /// Unlikely values of a record, each with the probably intended unit.
    pub fn unlikely(&self, gravity_m_s2: f64) -> Vec<Unlikely> {
        let difference = self.different_header().into_iter();
        difference
            .chain(self.unlikely_values(gravity_m_s2))
            .collect()
    }

    /// Warning about a difference between header and samples.
    pub(super) fn different_header(&self) -> Option<Unlikely> {
        let difference = self.difference.as_ref()?;
        Some(Unlikely {
            value: None,
            ..self.doubt(0.0, "", difference)
        })
    }

    /// Makes a warning about a value of this record, from a phrase that follows its name.
    fn doubt(&self, value: f64, unit: &str, phrase: &str) -> Unlikely {
        let name = self.name();
        let warning = format!("{name} {phrase}");
        Unlikely::new(name, value, unit, warning)
    }

    pub(super) fn unlikely_values(&self, gravity_m_s2: f64) -> Vec<Unlikely> {
        let mut unlikely = Vec::new();
        let peak_g = self.peak_g(gravity_m_s2);
        if !PEAK_G.contains(&peak_g) {
            let unit = self.unit.name();
            let might_be = match self.scaling {
                Scaling::Factor(1.0) if self.states_unit && peak_g < *PEAK_G.start() => {
                    "weaker motions than 0.01 g move no masonry".to_owned()
                }
                Scaling::Factor(1.0) if self.states_unit => "are its samples damaged?".to_owned(),
                Scaling::Factor(1.0) => format!("is its unit {unit:?}?"),
                Scaling::Factor(scale) if self.states_unit => {
                    format!("is `scale` {}?", plain(scale))
                }
                Scaling::Factor(scale) => {
                    format!("is its unit {unit:?}, and `scale` {}?", plain(scale))
                }
                Scaling::PeakG(_) => "is `peak_g` in units of gravity?".to_owned(),
            };
            let phrase = format!("peaks at {} g: {might_be}", plain(peak_g));
            let likely = self.likely_unit(peak_g, gravity_m_s2);
            unlikely.push(self.doubt(peak_g, "g", &phrase).in_likely(likely));
        }
        let shaking = Shaking::of(&self.accelerations_m_s2(gravity_m_s2));
        unlikely.extend(self.unlikely_times(&shaking));
        if let Some(ratio) = shaking.end_ratio.filter(|ratio| *ratio > END_RATIO) {
            let phrase = format!("begins or ends at {ratio:.2} of its peak: is it complete?");
            unlikely.push(self.doubt(ratio, "", &phrase));
        }
        let mean_g = self.mean_g(gravity_m_s2);
        let has_no_mean = shaking.is_long || self.layout.format == Format::KNET;
        if has_no_mean && mean_g.abs() > OFFSET * peak_g {
            let mean = plain(mean_g);
            let phrase = format!(
                "has a mean of {mean} g, the offset of the instrument: give `baseline = \"mean\"` to take it off"
            );
            unlikely.push(self.doubt(mean_g, "g", &phrase));
        }
        unlikely
    }

    /// The unit in which the peak of unscaled accelerations would be nearest to usual ones; `None` if the file states its unit, or none fits.
    fn likely_unit(&self, peak_g: f64, gravity_m_s2: f64) -> Option<&'static str> {
        let is_doubted = self.scaling == Scaling::Factor(1.0) && !self.states_unit;
        let is_acceleration = self.unit.quantity() == RecordedQuantity::Acceleration;
        let likely = match peak_g * gravity_m_s2 / self.unit.in_si(gravity_m_s2) {
            0.05..=1.5 => Some("g"),
            number => PEAK.nearest_unit(number),
        };
        likely.filter(|_| is_doubted && is_acceleration)
    }

    /// Warning about the step of the samples, or about the frequency at which the ground shakes.
    fn unlikely_times(&self, shaking: &Shaking) -> Option<Unlikely> {
        let sampling = self.sampling();
        let step_s = sampling.duration_s / (sampling.count - 1) as f64;
        let step = plain(step_s);
        if step_s > RECORD_STEP_S {
            let phrase = format!("has a sample every {step} s: are its times in milliseconds?");
            return Some(self.doubt(step_s, "s", &phrase).in_unit("milliseconds"));
        }
        let ratio_s = shaking.velocity_ratio_s?;
        if VELOCITY_RATIO_S.contains(&ratio_s) {
            return None;
        }
        let are_minutes = ratio_s < *VELOCITY_RATIO_S.start()
            && matches!(self.layout.times, Some(Times::Column(_)));
        let question = match are_minutes {
            true => "are its times in minutes?",
            false => "is its step right?",
        };
        let frequency = plain(1.0 / (std::f64::consts::TAU * ratio_s));
        let phrase =
            format!("has a sample every {step} s, and shakes at some {frequency} Hz: {question}");
        let doubt = self.doubt(step_s, "s", &phrase);
        Some(match are_minutes {
            true => doubt.in_unit("minutes"),
            false => doubt,
        })
    }
}

/// The course of a record that reverses often.
struct Shaking {
    /// True if the acceleration changes its sign as often as in an earthquake.
    is_long: bool,
    /// Largest velocity, without a linear drift, over the largest acceleration, in s; `None` unless `is_long`.
    velocity_ratio_s: Option<f64>,
    /// The larger acceleration at the ends, over the largest; `None` unless `is_long`.
    end_ratio: Option<f64>,
}

impl Shaking {
    /// Finds the course of accelerations in m/s2 over times in s.
    fn of(accelerations: &[(f64, f64)]) -> Self {
        let count = accelerations.len() as f64;
        let sum: f64 = accelerations.iter().map(|sample| sample.1).sum();
        let mean = sum / count;
        let above = |sample: &(f64, f64)| sample.1 > mean;
        let pairs = accelerations.windows(2);
        let reversals = pairs.filter(|pair| above(&pair[0]) != above(&pair[1]));
        let is_long = reversals.count() >= REVERSALS;
        let own = accelerations.iter().map(|sample| (sample.1 - mean).abs());
        let peak = own.fold(0.0, f64::max);
        let ends = [accelerations.first(), accelerations.last()]
            .into_iter()
            .flatten();
        let end = ends
            .map(|sample| (sample.1 - mean).abs())
            .fold(0.0, f64::max);
        Self {
            is_long,
            velocity_ratio_s: is_long.then(|| peak_velocity(accelerations) / peak),
            end_ratio: is_long.then_some(end / peak),
        }
    }
}

/// Computes the largest velocity of accelerations without its line of least squares.
fn peak_velocity(accelerations: &[(f64, f64)]) -> f64 {
    let mut velocity = 0.0;
    let mut velocities: Vec<_> = accelerations
        .windows(2)
        .map(|pair| {
            let [(t0, a0), (t1, a1)] = [pair[0], pair[1]];
            velocity += 0.5 * (a0 + a1) * (t1 - t0);
            (t1, velocity)
        })
        .collect();
    Baseline::Linear.subtract(&mut velocities);
    velocities
        .iter()
        .map(|sample| sample.1.abs())
        .fold(0.0, f64::max)
}
