//! Input that is possible but unlikely, such as a length in centimetres.

use std::ops::RangeInclusive;

use super::{Ground, Scenario, Structure};
use crate::argument::plain;

/// Strongest recorded ground accelerations are a little above 2 g; what is more is another unit.
const PEAK_G: f64 = 3.0;
/// The largest masonry arches span 140 m.
const MEAN_RADIUS_M: f64 = 100.0;
/// A straight angle in radians, in degrees it is almost nothing.
const EMBRACE_DEG: f64 = 3.2;
/// Thicker than any arch.
const THICKNESS_M: f64 = 5.0;
/// Gravity on Earth, from the equator to the poles.
const GRAVITY_M_S2: RangeInclusive<f64> = 9.75..=9.85;

impl Scenario {
    /// What is possible but unlikely, a sentence each, with what it might be instead.
    #[must_use]
    pub fn unlikely(&self) -> Vec<String> {
        let mut unlikely = Vec::new();
        if let Structure::Arch(arch) = &self.structure {
            let mean_radius_m = arch.mean_radius_m();
            let thickness_m = mean_radius_m * arch.thickness_ratio();
            let embrace_deg = arch.embrace_deg();
            if mean_radius_m > MEAN_RADIUS_M {
                unlikely.push(format!(
                    "the mean radius is {} m: is it in metres?",
                    plain(mean_radius_m)
                ));
            }
            if thickness_m > THICKNESS_M {
                unlikely.push(format!(
                    "the arch is {} m thick: is its thickness in metres?",
                    plain(thickness_m)
                ));
            }
            if embrace_deg < EMBRACE_DEG {
                unlikely.push(format!(
                    "the embrace angle is {} degrees: is it in radians?",
                    plain(embrace_deg)
                ));
            }
        }
        let gravity_m_s2 = self.simulation.gravity_m_s2;
        if !GRAVITY_M_S2.contains(&gravity_m_s2) {
            unlikely.push(format!(
                "gravity is {} m/s2, not that of the Earth",
                plain(gravity_m_s2)
            ));
        }
        match &self.ground {
            Some(Ground::Record(record)) => {
                for series in record.series() {
                    let peak_g = series.peak_g(gravity_m_s2);
                    if peak_g > PEAK_G {
                        unlikely.push(format!(
                            "{} peaks at {} g: is its unit {:?}?",
                            series.file,
                            plain(peak_g),
                            series.unit.name()
                        ));
                    }
                }
            }
            Some(Ground::Pulse(pulse)) => {
                let peak_g = pulse
                    .amplitude_g
                    .abs()
                    .max(pulse.vertical_amplitude_g.abs());
                if peak_g > PEAK_G {
                    unlikely.push(format!(
                        "the pulse peaks at {} g: is its amplitude in units of gravity?",
                        plain(peak_g)
                    ));
                }
            }
            None => {}
        }
        unlikely
    }
}
