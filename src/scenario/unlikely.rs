//! Finds input that is possible but unlikely, such as a length in centimetres.

use std::ops::RangeInclusive;

use super::bounds::LIKELY_EMBRACE_DEG;
use super::structure::bounds_m;
use super::{Format, Ground, PulseGround, Scaling, Scenario, Series, Structure};
use crate::argument::{plain, short};
use crate::dynamics::model::Model;
use crate::mechanics::sway::Sway;

/// The strongest recorded ground accelerations are a little above 2 g, and those below the lower limit move no masonry. A value outside is
/// probably in another unit.
const PEAK_G: RangeInclusive<f64> = 0.01..=3.0;
/// Records have 50 to 200 samples a second. Longer steps than this are probably in another unit.
const RECORD_STEP_S: f64 = 0.1;
/// A pulse this many times as strong as the one that starts the structure would throw it.
const PEAK_OVER_INCIPIENT: f64 = 20.0;
/// The largest masonry arches span 140 m.
const RADIUS_M: f64 = 100.0;
/// More than the thickness of any arch.
const THICKNESS_M: f64 = 5.0;
/// More than the size of any column or arch on piers.
const SIZE_M: f64 = 200.0;
/// Gravity on Earth, from the equator to the poles.
const GRAVITY_M_S2: RangeInclusive<f64> = 9.75..=9.85;
/// Offset of a record relative to its peak.
const OFFSET: f64 = 0.01;
/// More steps than these take minutes.
const STEPS: f64 = 1e7;
/// With four links, a motion this long takes minutes.
const DURATION_S: f64 = 1e5;

impl Scenario {
    /// The unlikely values, a sentence each, with a suggestion what was meant.
    #[must_use]
    pub fn unlikely(&self) -> Vec<String> {
        self.unlikely_with(|| starts_g(&*self.model().ok()?))
    }

    /// The unlikely values, as [`Scenario::unlikely`], of a scenario whose model of motion is at hand.
    #[must_use]
    pub fn unlikely_of(&self, model: &dyn Model) -> Vec<String> {
        self.unlikely_with(|| starts_g(model))
    }

    /// The unlikely values; `starts_g` finds the least acceleration that starts the structure, in g.
    fn unlikely_with(&self, starts_g: impl FnOnce() -> Option<f64>) -> Vec<String> {
        let gravity_m_s2 = self.simulation.gravity_m_s2;
        let mut unlikely = self.structure.unlikely();
        if !GRAVITY_M_S2.contains(&gravity_m_s2) {
            unlikely.push(format!(
                "gravity is {} m/s2, not that of the Earth",
                plain(gravity_m_s2)
            ));
        }
        match &self.ground {
            Some(Ground::Record(record)) => {
                unlikely.extend(
                    record
                        .series()
                        .flat_map(|series| series.unlikely(gravity_m_s2)),
                );
            }
            Some(Ground::Pulse(pulse)) => unlikely.extend(self.unlikely_pulse(pulse, starts_g)),
            None => {}
        }
        if let Some(suite) = &self.suite {
            let mut records = suite
                .records
                .iter()
                .map(|series| series.unlikely(gravity_m_s2));
            // A wrong unit is wrong in all tables, so only the first record is described.
            if let Some(first) = records.find(|unlikely| !unlikely.is_empty()) {
                let others = records.filter(|unlikely| !unlikely.is_empty()).count();
                unlikely.extend(first);
                if others > 0 {
                    unlikely.push(format!("{others} more records of the suite are like that"));
                }
            }
        }
        unlikely.extend(self.takes_long());
        unlikely
    }

    fn unlikely_pulse(
        &self,
        pulse: &PulseGround,
        starts_g: impl FnOnce() -> Option<f64>,
    ) -> Option<String> {
        let peak_g = pulse
            .amplitude_g
            .abs()
            .max(pulse.vertical_amplitude_g.abs());
        if peak_g > *PEAK_G.end() {
            return Some(format!(
                "the pulse peaks at {} g: is its amplitude in units of gravity?",
                plain(peak_g)
            ));
        }
        // On springings that have moved the structure stands on three hinges, and a fraction of its own strength starts it.
        if self.motion.supports().is_some() {
            return None;
        }
        let starts_g = starts_g()?;
        let times = pulse.amplitude_g.abs() / starts_g;
        // What stands on hinges that ties hold is started by any push.
        (starts_g > 0.0 && times > PEAK_OVER_INCIPIENT).then(|| {
            format!(
                "the pulse peaks at {} g, {times:.0} times what starts the structure: is its amplitude in units of \
                 gravity?",
                plain(pulse.amplitude_g.abs())
            )
        })
    }

    /// Warns that a motion up to the end of the simulation takes long to compute.
    fn takes_long(&self) -> Option<String> {
        let duration_s = self.request().end_s;
        let begin = format!("the simulation lasts {} s", short(duration_s));
        if !self.motion.hinges().has_joints() {
            return (duration_s > DURATION_S).then(|| {
                format!("{begin}: unless it rests or overturns before, that takes minutes or more")
            });
        }
        let longest_s = self
            .motion
            .longest_step_s(&self.structure, &self.request())?;
        let steps = duration_s / longest_s;
        (steps > STEPS).then(|| {
            format!(
                "{begin}, some {steps:.0e} steps of {longest_s:.1e} s: unless it rests or overturns before, every \
                 million of them takes several seconds"
            )
        })
    }
}

/// The least acceleration that starts the structure of a model to either side, in g.
fn starts_g(model: &dyn Model) -> Option<f64> {
    let sides = Sway::ALL.iter();
    let sides = sides.filter_map(|sway| model.incipient_acceleration_g(*sway));
    sides.reduce(f64::min)
}

impl Structure {
    fn unlikely(&self) -> Vec<String> {
        match self {
            Self::Arch(arch) => {
                let mean_radius_m = arch.mean_radius_m();
                let thickness_m = mean_radius_m * arch.thickness_ratio();
                let embrace_deg = arch.embrace_deg();
                let in_radians = (embrace_deg < LIKELY_EMBRACE_DEG).then(|| {
                    format!(
                        "the embrace angle is {} degrees: is it in radians?",
                        plain(embrace_deg)
                    )
                });
                [
                    long("the mean radius is", mean_radius_m, RADIUS_M),
                    long("the thickness is", thickness_m, THICKNESS_M),
                    in_radians,
                ]
                .into_iter()
                .flatten()
                .collect()
            }
            Self::Column(column) => {
                let longest_m = column.height_m().max(column.width_m());
                long("the column measures", longest_m, SIZE_M)
                    .into_iter()
                    .collect()
            }
            Self::Masonry(masonry) => {
                let [low_m, high_m] = bounds_m(masonry.row());
                let longest_m = (high_m - low_m).max();
                long("the structure measures", longest_m, SIZE_M)
                    .into_iter()
                    .collect()
            }
        }
    }
}

/// Warns that a length is larger than usual, and names a unit in which it would be usual.
fn long(what: &str, length_m: f64, usual_m: f64) -> Option<String> {
    let unit = if length_m > 10.0 * usual_m {
        "millimetres"
    } else {
        "centimetres"
    };
    (length_m > usual_m).then(|| format!("{what} {} m: is it in {unit}?", plain(length_m)))
}

impl Series {
    /// The unlikely values of a record, a sentence each, with a suggestion what was meant.
    #[must_use]
    pub fn unlikely(&self, gravity_m_s2: f64) -> Vec<String> {
        let mut unlikely = Vec::new();
        let (name, peak_g) = (self.name(), self.peak_g(gravity_m_s2));
        if !PEAK_G.contains(&peak_g) {
            let might_be = match self.scaling {
                Scaling::Factor(1.0) => format!("is its unit {:?}?", self.unit.name()),
                Scaling::Factor(scale) => format!(
                    "is its unit {:?}, and `scale` {}?",
                    self.unit.name(),
                    plain(scale)
                ),
                Scaling::PeakG(_) => "is `peak_g` in units of gravity?".to_owned(),
            };
            unlikely.push(format!("{name} peaks at {} g: {might_be}", plain(peak_g)));
        }
        let sampling = self.sampling();
        let step_s = sampling.duration_s / (sampling.count - 1) as f64;
        if step_s > RECORD_STEP_S {
            unlikely.push(format!(
                "{name} has a sample every {} s: are its times in milliseconds?",
                plain(step_s)
            ));
        }
        let mean_g = self.mean_g(gravity_m_s2);
        if self.layout.format == Format::Knet && mean_g.abs() > OFFSET * peak_g {
            unlikely.push(format!(
                "{name} has a mean of {} g, the offset of the instrument: give `remove_mean = true` to take it off",
                plain(mean_g)
            ));
        }
        unlikely
    }
}
