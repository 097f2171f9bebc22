//! Unlikely strengths of the ground motion: of pulses, records, levels of suites, axes of maps and factors.

use std::cell::OnceCell;

use super::series::PEAK_G;
use super::usual::PEAK;
use super::{Unlikely, Varied, plain};
use crate::scenario::{
    Axis, Ground, Measure, PulseGround, Quantity, Scaling, Scenario, Sequence, Series, Unit,
};
use crate::{Model, Sway};

/// Largest usual ratio of the peak of a pulse to the acceleration that starts the structure.
const PEAK_OVER_INCIPIENT: f64 = 20.0;
/// Largest usual ratio of the weakest of several motions to the acceleration that starts the structure: levels and axes begin near it.
const WEAKEST_OVER_INCIPIENT: f64 = 4.0;
/// Largest usual peak of the strongest of several motions, in g: thresholds of short pulses reach 12 g (docs/evidence.md).
const STRONGEST_G: f64 = 15.0;

/// The peaks of several motions, in g.
struct Strengths {
    /// Subject of a sentence.
    what: String,
    key: String,
    weakest_g: f64,
    strongest_g: f64,
    question: &'static str,
    /// The unit in which the numbers probably are; `None` if it follows from their size.
    likely: Option<&'static str>,
}

/// The pushes that start the structure to the right and to the left, in g; `None` if they are not known or show no mistake.
type StartsG<'f> = &'f dyn Fn() -> Option<[Option<f64>; 2]>;

impl Scenario {
    /// Unlikely values of the ground motions of a study. `is_sized` is true if size and density of the structure are usual.
    pub(super) fn unlikely_ground(&self, study: &Varied<'_>, is_sized: bool) -> Vec<Unlikely> {
        let gravity_m_s2 = self.simulation.gravity_m_s2;
        let found = OnceCell::new();
        let find = || is_sized.then(|| self.starts_g(study.model)).flatten();
        let starts_g = || *found.get_or_init(find);
        let mut unlikely = Vec::new();
        for series in self.series() {
            unlikely.extend(series.unlikely(gravity_m_s2));
        }
        match &self.ground {
            Some(Ground::Pulse(pulse)) => unlikely.extend(self.unlikely_pulse(pulse, &starts_g)),
            Some(Ground::Record(record)) => {
                unlikely.extend(self.too_weak(&record.main, &starts_g));
            }
            None => {}
        }
        let suite = self.suite.iter().flat_map(|suite| &suite.records);
        unlikely.extend(unlikely_records(suite, "the suite", gravity_m_s2));
        let verify = self
            .verify
            .iter()
            .flat_map(|verify| verify.records.all_records());
        unlikely.extend(unlikely_records(verify, "[verify]", gravity_m_s2));
        let strengths = self.strengths(study);
        unlikely.extend(
            strengths
                .iter()
                .filter_map(|one| one.unlikely_strength(&starts_g)),
        );
        unlikely
    }

    fn unlikely_pulse(&self, pulse: &PulseGround, starts_g: StartsG<'_>) -> Option<Unlikely> {
        let peak_g = pulse
            .amplitude_g
            .abs()
            .max(pulse.vertical_amplitude_g.abs());
        let key = format!("ground.{}.amplitude_g", pulse.kind.name());
        let unit = "is its amplitude in units of gravity?";
        let doubt = |value_g: f64, phrase: String| {
            let warning = format!("the pulse {phrase}: {unit}");
            Unlikely::new(key.clone(), value_g, "g", warning).in_likely(PEAK.nearest_unit(value_g))
        };
        if peak_g > *PEAK_G.end() {
            return Some(doubt(peak_g, format!("peaks at {} g", plain(peak_g))));
        }
        let [push_g, times] = self.largest_push(starts_g)?;
        (times > PEAK_OVER_INCIPIENT).then(|| {
            let push = plain(push_g);
            let phrase = format!(
                "pushes the structure with {push} g, {times:.0} times as much as starts it"
            );
            doubt(push_g, phrase)
        })
    }

    /// Warning about a table in m/s2 that moves nothing, and would move the structure if it were in g.
    fn too_weak(&self, series: &Series, starts_g: StartsG<'_>) -> Option<Unlikely> {
        let peak_g = series.peak_g(self.gravity_m_s2());
        let in_gravities_g = peak_g * self.gravity_m_s2();
        let is_given = series.layout.unit == Some(Unit::MetrePerS2);
        if !is_given || series.scaling != Scaling::Factor(1.0) || !PEAK_G.contains(&in_gravities_g)
        {
            return None;
        }
        let [_, times] = self.largest_push(starts_g)?;
        (times < 1.0 && times * self.gravity_m_s2() > 1.0).then(|| {
            let (name, peak) = (series.name(), plain(peak_g));
            let warning = format!(
                "{name} peaks at {peak} g, too weak to move the structure: is its unit \"m/s2\"?"
            );
            Unlikely::new(name, peak_g, "g", warning).in_unit("g")
        })
    }

    /// Largest push of the ground, in g, and its ratio to the push that starts the structure to the same side; of the side with the
    /// larger ratio. `None` if no push starts the structure, or any push does, because ties hold it on its hinges, or its springings have moved.
    fn largest_push(&self, starts_g: StartsG<'_>) -> Option<[f64; 2]> {
        let pushes_m_s2 = self.ground_motion().pushes_m_s2(f64::INFINITY);
        let starts_g = starts_g()?;
        let ratios = pushes_m_s2
            .into_iter()
            .zip(starts_g)
            .filter_map(|(push_m_s2, starts_g)| {
                let push_g = push_m_s2 / self.gravity_m_s2();
                Some([push_g, push_g / starts_g?])
            });
        ratios.max_by(|one, other| one[1].total_cmp(&other[1]))
    }

    /// Push that starts the structure to the right and to the left, in g, if it has one. `None` on moved springings: there the structure
    /// stands on three hinges, and a small push starts it.
    fn starts_g(&self, model: Option<&dyn Model>) -> Option<[Option<f64>; 2]> {
        if self.motion.supports().is_some() {
            return None;
        }
        let made;
        let model = match model {
            Some(model) => model,
            None => {
                made = self.model().ok()?;
                &*made
            }
        };
        let starts_g = [Sway::Right, Sway::Left].map(|sway| model.incipient_acceleration_g(sway));
        Some(starts_g.map(|starts_g| starts_g.filter(|starts_g| *starts_g > 0.0)))
    }

    /// Strengths over which the studies of this scenario vary.
    fn strengths(&self, study: &Varied<'_>) -> Vec<Strengths> {
        let mut all = Vec::new();
        if let Some(ground) = &self.ground {
            let axes = self
                .map
                .iter()
                .flat_map(|map| [&map.x, &map.y])
                .filter_map(|axis| self.axis_strengths(axis, ground));
            all.extend(axes);
            let axis = study.key_range.map(|(key, ends)| Axis {
                quantity: Quantity::Other,
                key: key.to_owned(),
                sequence: Sequence::List(ends.into()),
            });
            all.extend(axis.and_then(|axis| self.axis_strengths(&axis, ground)));
        }
        if let Some(suite) = &self.suite
            && let Some(levels) = &suite.levels
        {
            let peaks_g = suite
                .records
                .iter()
                .map(|series| series.peak_g(self.gravity_m_s2()));
            let (key, unit_g) = match suite.measure {
                Measure::Scale => ("suite.scales", peaks_g.fold(0.0, f64::max)),
                Measure::PeakG => ("suite.peaks_g", 1.0),
            };
            let question = "are its levels in units of gravity?";
            let levels = levels.values();
            all.extend(Strengths::of(key, ("the suite", question), &levels, unit_g));
        }
        if let Some(factor) = study.factor {
            let peak_m_s2 = self.ground_motion().peaks_m_s2(f64::INFINITY).x;
            all.push(Strengths {
                what: "the largest factor on the ground motion".to_owned(),
                key: "factors.to".to_owned(),
                weakest_g: 0.0,
                strongest_g: factor * peak_m_s2 / self.gravity_m_s2(),
                question: "is it in per cent?",
                likely: Some("per cent"),
            });
        }
        all
    }

    /// Strengths along an axis; `None` if it varies another quantity.
    fn axis_strengths(&self, axis: &Axis, ground: &Ground) -> Option<Strengths> {
        let unit_g = match (axis.quantity_under(ground), ground) {
            (Quantity::Amplitude | Quantity::PeakG, _) => 1.0,
            (Quantity::Scale, Ground::Record(record)) => {
                let unscaled = record.main.scaled(Scaling::Factor(1.0));
                unscaled.peak_g(self.gravity_m_s2())
            }
            _ => return None,
        };
        let (key, what) = (
            axis.path(Some(ground)),
            format!("the range of `{}`", axis.key),
        );
        let question = "is it in units of gravity?";
        Strengths::of(&key, (&what, question), &axis.sequence.values(), unit_g)
    }
}

impl Strengths {
    /// Makes the strengths of at least two ascending values, each times `unit_g`.
    fn of(
        key: &str,
        (what, question): (&str, &'static str),
        values: &[f64],
        unit_g: f64,
    ) -> Option<Self> {
        let [first, .., last] = values else {
            return None;
        };
        let (first_g, last_g) = (first * unit_g, last * unit_g);
        let crosses_zero = first_g <= 0.0 && last_g >= 0.0;
        let [one_g, other_g] = [first_g.abs(), last_g.abs()];
        Some(Self {
            what: what.to_owned(),
            key: key.to_owned(),
            weakest_g: if crosses_zero {
                0.0
            } else {
                one_g.min(other_g)
            },
            strongest_g: one_g.max(other_g),
            question,
            likely: None,
        })
    }

    /// Middle of the peaks on a logarithmic scale, in g.
    fn middle_g(&self) -> f64 {
        match self.weakest_g {
            0.0 => self.strongest_g,
            weakest_g => (weakest_g * self.strongest_g).sqrt(),
        }
    }

    /// Warning about motions that are too strong, or all too weak or too strong for the structure.
    fn unlikely_strength(&self, starts_g: StartsG<'_>) -> Option<Unlikely> {
        let doubt = |value_g: f64, (verb, end): (&str, &str)| {
            let (what, value, question) = (&self.what, plain(value_g), self.question);
            let warning = format!("{what} {verb} {value} g{end}: {question}");
            let likely = self.likely.or_else(|| PEAK.nearest_unit(self.middle_g()));
            Unlikely::new(self.key.clone(), value_g, "g", warning).in_likely(likely)
        };
        let (weakest_g, strongest_g) = (self.weakest_g, self.strongest_g);
        if strongest_g > STRONGEST_G {
            return Some(doubt(strongest_g, ("reaches", "")));
        }
        let starts_g = starts_g()?.into_iter().flatten();
        let (least_g, most_g) = (
            starts_g.clone().reduce(f64::min)?,
            starts_g.reduce(f64::max)?,
        );
        let times = weakest_g / most_g;
        if times > WEAKEST_OVER_INCIPIENT {
            let phrase = format!(", {times:.0} times as much as starts the structure");
            return Some(doubt(weakest_g, ("begins at", &phrase)));
        }
        let phrase = ", too weak to move the structure";
        (strongest_g < least_g).then(|| doubt(strongest_g, ("reaches", phrase)))
    }
}

/// Warnings about several records. A wrong unit affects all tables, so only the first record is described.
fn unlikely_records<'s>(
    records: impl Iterator<Item = &'s Series> + Clone,
    of: &str,
    gravity_m_s2: f64,
) -> Vec<Unlikely> {
    let mut unlikely: Vec<_> = records
        .clone()
        .filter_map(Series::different_header)
        .collect();
    let mut values = records
        .map(|series| series.unlikely_values(gravity_m_s2))
        .filter(|faults| !faults.is_empty());
    unlikely.extend(values.next().into_iter().flatten());
    let others = values.count();
    let more = match others {
        0 => return unlikely,
        1 => format!("1 more record of {of} is like that"),
        _ => format!("{others} more records of {of} are like that"),
    };
    unlikely.push(Unlikely::new("records", others as f64, "", more));
    unlikely
}
