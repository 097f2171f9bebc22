//! Warnings about input that is possible but unlikely, such as a length in centimetres.

use std::ops::RangeInclusive;

use super::prelude::*;
use super::structure::bounds_m;
use super::{Format, Ground, MotionModel, PulseGround, Scaling, Scenario, Series, Structure};
use crate::{Column, Model, Sway};

/// Usual peaks of records, in g. The strongest recorded accelerations are a little above 2 g, and weaker ones than the lower limit move no
/// masonry. Other values are probably in another unit.
const PEAK_G: RangeInclusive<f64> = 0.01..=3.0;
/// Longest usual step of a record, in s: records have 50 to 200 samples a second. Longer steps are probably in another unit.
const RECORD_STEP_S: f64 = 0.1;
/// Largest usual ratio of the peak of a pulse to the acceleration that starts the structure.
const PEAK_OVER_INCIPIENT: f64 = 20.0;
/// Largest usual radius, in m: the largest masonry arches span 140 m.
const RADIUS_M: f64 = 100.0;
/// Largest usual thickness of an arch, in m.
const THICKNESS_M: f64 = 5.0;
/// Largest usual size of a column or of an arch on piers, in m.
const SIZE_M: f64 = 200.0;
/// Gravity on Earth, from the equator to the poles, in m/s2.
const GRAVITY_M_S2: RangeInclusive<f64> = 9.75..=9.85;
/// Largest usual mean of a record, over its peak.
const OFFSET: f64 = 0.01;
/// Number of steps beyond which a computation takes minutes.
const STEPS: f64 = 1e7;
/// Duration beyond which a computation with four links takes minutes, in s.
const DURATION_S: f64 = 1e5;

impl Scenario {
    /// Returns sentences about unlikely values, each with the probably intended value.
    pub fn unlikely(&self) -> Vec<String> {
        self.unlikely_of(None)
    }

    /// Returns the sentences of [`Scenario::unlikely`] for a scenario whose model of motion may be known.
    pub fn unlikely_of(&self, model: Option<&dyn Model>) -> Vec<String> {
        let gravity_m_s2 = self.simulation.gravity_m_s2;
        let of_series = |series: &Series| series.unlikely(gravity_m_s2);
        let mut unlikely = self.structure.unlikely();
        if !GRAVITY_M_S2.contains(&gravity_m_s2) {
            let gravity = plain(gravity_m_s2);
            unlikely.push(format!("gravity is {gravity} m/s2, not that of the Earth"));
        }
        match &self.ground {
            Some(Ground::Record(record)) => unlikely.extend(record.series().flat_map(of_series)),
            Some(Ground::Pulse(pulse)) => unlikely.extend(self.unlikely_pulse(pulse, model)),
            None => {}
        }
        let records = self.suite.iter().flat_map(|suite| &suite.records);
        unlikely.extend(records.clone().filter_map(Series::different_header));
        // A wrong unit affects all tables, so only the first record is described.
        let values = records.map(|series| series.unlikely_values(gravity_m_s2));
        let mut values = values.filter(|faults| !faults.is_empty());
        unlikely.extend(values.next().into_iter().flatten());
        let others = values.count();
        let more = match others {
            1 => "1 more record of the suite is like that".to_owned(),
            _ => format!("{others} more records of the suite are like that"),
        };
        unlikely.extend(Some(more).filter(|_| others > 0));
        unlikely.extend(self.takes_long());
        unlikely
    }

    fn unlikely_pulse(&self, pulse: &PulseGround, model: Option<&dyn Model>) -> Option<String> {
        let peak_g = pulse.amplitude_g.abs();
        let peak_g = peak_g.max(pulse.vertical_amplitude_g.abs());
        let unit = "is its amplitude in units of gravity?";
        if peak_g > *PEAK_G.end() {
            return Some(format!("the pulse peaks at {} g: {unit}", plain(peak_g)));
        }
        // On moved springings the structure stands on three hinges, and a small push starts it.
        if self.motion.supports().is_some() {
            return None;
        }
        let [push_g, times] = match model {
            Some(model) => self.largest_push(model)?,
            None => self.largest_push(&*self.model().ok()?)?,
        };
        (times > PEAK_OVER_INCIPIENT).then(|| {
            let push = plain(push_g);
            format!("the pulse pushes the structure with {push} g, {times:.0} times as much as starts it: {unit}")
        })
    }

    /// Returns the largest push of the ground, in g, and its ratio to the push that starts the structure to the same side; of the side with the
    /// larger ratio. `None` if no push starts the structure, or any push does, because ties hold it on its hinges.
    fn largest_push(&self, model: &dyn Model) -> Option<[f64; 2]> {
        let pushes_m_s2 = self.ground_motion().pushes_m_s2(f64::INFINITY);
        let sides = [Sway::Right, Sway::Left].into_iter().zip(pushes_m_s2);
        let ratios = sides.filter_map(|(sway, push_m_s2)| {
            let starts_g = model.incipient_acceleration_g(sway)?;
            let push_g = push_m_s2 / self.gravity_m_s2();
            (starts_g > 0.0).then(|| [push_g, push_g / starts_g])
        });
        ratios.max_by(|one, other| one[1].total_cmp(&other[1]))
    }

    /// Returns a warning if a motion up to the end of the simulation takes long to compute.
    fn takes_long(&self) -> Option<String> {
        let request = self.request();
        let begin = format!("the simulation lasts {} s", plain(request.end_s));
        if !self.motion.kind.has_joints {
            return (request.end_s > DURATION_S).then(|| {
                format!("{begin}: unless it rests or overturns before, that takes minutes or more")
            });
        }
        let MotionModel { options, site, .. } = &self.motion;
        let longest_s = options.longest_step_s(&self.structure, site, &request)?;
        let steps = request.end_s / longest_s;
        (steps > STEPS).then(|| {
            format!(
                "{begin}, some {steps:.0e} steps of {longest_s:.1e} s: unless it rests or overturns before, every \
                 million of them takes several seconds"
            )
        })
    }
}

impl Structure {
    fn unlikely(&self) -> Vec<String> {
        let longest = match self {
            Self::Arch(arch) => {
                let (radius_m, embrace_deg) = (arch.mean_radius_m, arch.embrace_deg);
                let thick_m = radius_m * arch.thickness_ratio;
                let in_radians = (embrace_deg < LIKELY_EMBRACE_DEG).then(|| {
                    let angle = plain(embrace_deg);
                    format!("the embrace angle is {angle} degrees: is it in radians?")
                });
                let radius = long("the mean radius is", radius_m, RADIUS_M);
                let thickness = long("the thickness is", thick_m, THICKNESS_M);
                let all = [radius, thickness, in_radians];
                return all.into_iter().flatten().collect();
            }
            Self::Column(column) => {
                let longest_m = column.height_m.max(column.width_m);
                let size = long("the column measures", longest_m, SIZE_M);
                return size.into_iter().chain(loads_beside(column)).collect();
            }
            Self::Masonry(masonry) => {
                let [low_m, high_m] = bounds_m(&masonry.row);
                long("the structure measures", (high_m - low_m).max(), SIZE_M)
            }
        };
        longest.into_iter().collect()
    }
}

/// Returns warnings about loads that are more than its width outside of the faces of a column.
fn loads_beside(column: &Column) -> impl Iterator<Item = String> {
    let width_m = column.width_m;
    let loads = column.loads.iter().enumerate();
    let beside = loads.filter(move |(_, load)| load.x_m.abs() > 1.5 * width_m);
    beside.map(move |(index, load)| {
        let (number, x, width) = (index + 1, plain(load.x_m), plain(width_m));
        format!("load {number} is at x = {x} m, far beside the column, {width} m wide: is it in metres from the axis?")
    })
}

/// Returns a warning if a length is larger than usual, with a unit in which it would be usual.
fn long(what: &str, length_m: f64, usual_m: f64) -> Option<String> {
    let is_huge = length_m > 10.0 * usual_m;
    let unit = ["centimetres", "millimetres"][usize::from(is_huge)];
    (length_m > usual_m).then(|| format!("{what} {} m: is it in {unit}?", plain(length_m)))
}

impl Series {
    /// Returns sentences about unlikely values of a record, each with the probably intended value.
    pub fn unlikely(&self, gravity_m_s2: f64) -> Vec<String> {
        let difference = self.different_header().into_iter();
        difference
            .chain(self.unlikely_values(gravity_m_s2))
            .collect()
    }

    /// Returns a sentence about a difference between header and samples.
    fn different_header(&self) -> Option<String> {
        let difference = self.difference.as_ref()?;
        Some(format!("{} {difference}", self.name()))
    }

    fn unlikely_values(&self, gravity_m_s2: f64) -> Vec<String> {
        let (name, peak_g) = (self.name(), self.peak_g(gravity_m_s2));
        let (unit, sampling) = (self.unit.name(), self.sampling());
        let mut unlikely = Vec::new();
        if !PEAK_G.contains(&peak_g) {
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
            unlikely.push(format!("{name} peaks at {} g: {might_be}", plain(peak_g)));
        }
        let step_s = sampling.duration_s / (sampling.count - 1) as f64;
        if step_s > RECORD_STEP_S {
            let step = plain(step_s);
            unlikely.push(format!(
                "{name} has a sample every {step} s: are its times in milliseconds?"
            ));
        }
        let mean_g = self.mean_g(gravity_m_s2);
        if self.layout.format == Format::Knet && mean_g.abs() > OFFSET * peak_g {
            let mean = plain(mean_g);
            unlikely.push(format!(
                "{name} has a mean of {mean} g, the offset of the instrument: give `baseline = \"mean\"` to take it off"
            ));
        }
        unlikely
    }
}
