//! Warnings about input that is possible but unlikely, such as a length in centimetres.

mod ground;
mod series;
mod structure;
mod usual;

use std::fmt;
use std::ops::RangeInclusive;

use serde::Deserialize;

use self::usual::{USUAL, Usual, usual_forces};
use super::prelude::*;
use super::structure::bounds_m;
use super::{Ground, MotionModel, Scenario, Structure};
use crate::Model;
use crate::mechanics::{MasonryShape, PlacedLoad};

/// Gravity on Earth, from the equator to the poles, and the rounded one of many papers, in m/s2.
const GRAVITY_M_S2: RangeInclusive<f64> = 9.75..=10.0;
/// Number of steps beyond which a computation takes minutes.
const STEPS: f64 = 1e7;
/// Computing time of a step and block of elastic and of rigid joints, in s: 0.05 to 0.2 and 0.2 to 0.32 microseconds were measured.
const STEP_S_A_BLOCK: [f64; 2] = [1e-7, 3e-7];
/// Duration beyond which a computation with four links takes minutes, in s.
const DURATION_S: f64 = 1e5;

/// An unlikely number of the input. Its `Display` is the warning; it is empty for a number that was read from JSON, beside which `warnings` has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unlikely {
    /// Key of the scenario with its table, or the name of the record.
    pub key: String,
    /// The unlikely number; null if the warning is about several.
    pub value: Option<f64>,
    /// Unit of the number; empty without a unit.
    pub unit: String,
    /// The unit in which the number was probably meant; null if that is unknown.
    pub likely: Option<String>,
    /// The warning.
    #[serde(skip)]
    warning: String,
}

impl Unlikely {
    fn new(key: impl Into<String>, value: f64, unit: &str, warning: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            value: Some(value),
            unit: unit.to_owned(),
            likely: None,
            warning: warning.into(),
        }
    }

    /// Warnings about unlikely numbers.
    pub fn sentences(unlikely: &[Self]) -> Vec<String> {
        unlikely.iter().map(Self::to_string).collect()
    }

    fn in_unit(self, likely: &str) -> Self {
        self.in_likely(Some(likely))
    }

    /// Adds the probable unit, also to the warning unless its question has it.
    fn in_likely(mut self, likely: Option<&str>) -> Self {
        if let Some(unit) = likely
            && !self.warning.contains(&format!("in {unit}"))
        {
            self.warning += &format!(" It looks like {unit}");
        }
        self.likely = likely.map(str::to_owned);
        self
    }

    /// Outermost table of the key.
    fn table(&self) -> &str {
        self.key.split('.').next().unwrap_or_default()
    }
}

impl fmt::Display for Unlikely {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.warning)
    }
}

/// The options of a study that are not part of the scenario.
#[derive(Clone, Copy, Default)]
pub struct Varied<'a> {
    /// The model of motion, if it is known already.
    pub model: Option<&'a dyn Model>,
    /// A key, and the ends of the range along which it varies.
    pub key_range: Option<(&'a str, [f64; 2])>,
    /// The largest factor on the ground motion.
    pub factor: Option<f64>,
}

impl<'a> Varied<'a> {
    /// No options, for a known model of motion.
    pub fn of_model(model: &'a dyn Model) -> Self {
        Self {
            model: Some(model),
            ..Self::default()
        }
    }
}

impl Scenario {
    /// Sentences about unlikely values, each with the probably intended unit.
    pub fn unlikely_values(&self) -> Vec<String> {
        Unlikely::sentences(&self.unlikely_in(&Varied::default()))
    }

    /// Unlikely values of a study: of the structure, the ground motion, the levels of a suite, the axes of a map and the options. Each mistake
    /// has one warning.
    pub fn unlikely_in(&self, study: &Varied<'_>) -> Vec<Unlikely> {
        let json = self.to_json();
        let mut numbers = Numbers::of(&json);
        numbers.add_computed(&self.structure);
        numbers.add_ranges(self, study);
        let mut unlikely: Vec<Unlikely> = Vec::new();
        let mut by_key = numbers.unlikely_numbers(&[]);
        // Weights and pushes depend on size and density.
        let is_sized = !by_key
            .iter()
            .any(|one| ["m", "kg/m3"].contains(&&*one.unit));
        if is_sized {
            by_key = numbers.unlikely_numbers(&self.usual_forces(&numbers));
        }
        let all = by_key.into_iter().chain(self.unlikely_together(&numbers));
        for one in all.chain(self.unlikely_gravity()) {
            // The lengths of a table are usually in one unit, so one warning suffices.
            let is_known =
                |known: &Unlikely| (known.table(), &known.unit) == (one.table(), &one.unit);
            if !unlikely.iter().any(is_known) {
                unlikely.push(one);
            }
        }
        unlikely.extend(self.unlikely_ground(study, is_sized));
        unlikely.extend(self.takes_long());
        unlikely
    }

    /// Usual masses and forces of the loads and ties of this structure; empty without loads, ties and blow.
    fn usual_forces(&self, numbers: &Numbers) -> Vec<Usual> {
        let has_forces = numbers.0.iter().any(|(path, _)| {
            let tables = ["load.", "tie.", "initial.impulse"];
            tables.iter().any(|table| path.starts_with(table))
        });
        let row = has_forces.then(|| self.structure.row().ok()).flatten();
        row.map_or_else(Vec::new, |row| {
            let (_, loads) = self.structure.fill_and_loads();
            let moving_kg = loads.iter().map(PlacedLoad::moving_mass_kg);
            let mass_kg = row.mass_kg() - moving_kg.sum::<f64>();
            usual_forces(mass_kg, self.structure.size_m(), self.gravity_m_s2()).into()
        })
    }

    /// Unlikely values of a study of several scenarios, each once.
    pub fn unlikely_of_all<'s>(
        scenarios: impl IntoIterator<Item = &'s Self>,
        study: &Varied<'_>,
    ) -> Vec<Unlikely> {
        let mut all: Vec<Unlikely> = Vec::new();
        for scenario in scenarios {
            let mut own = scenario.unlikely_in(study);
            // The same mistake has other words under another model of motion, whose push at the onset differs.
            own.retain(|one| {
                let mut known = all.iter();
                !known.any(|known| (&known.key, &known.unit) == (&one.key, &one.unit))
            });
            all.append(&mut own);
        }
        all
    }

    fn unlikely_gravity(&self) -> Option<Unlikely> {
        let gravity_m_s2 = self.simulation.gravity_m_s2;
        (!GRAVITY_M_S2.contains(&gravity_m_s2)).then(|| {
            let gravity = plain(gravity_m_s2);
            let warning = format!("gravity is {gravity} m/s2, not that of the Earth");
            Unlikely::new("simulation.gravity_m_s2", gravity_m_s2, "m/s2", warning)
        })
    }

    /// A warning if a motion up to the end of the simulation takes long to compute.
    fn takes_long(&self) -> Option<Unlikely> {
        let request = self.request();
        let begin = format!("the simulation lasts {} s", plain(request.end_s));
        let warning = if self.motion.kind.is_repeated {
            let MotionModel { options, site, .. } = &self.motion;
            let longest_s = options.longest_step_s(&self.structure, site, &request)?;
            let steps = request.end_s / longest_s;
            (steps > STEPS).then(|| {
                let step_s = STEP_S_A_BLOCK[usize::from(!self.motion.kind.has_stiffness)];
                let blocks = self.structure.row().map_or(1, |row| row.blocks.len());
                let minutes = steps * step_s * blocks as f64 / 60.0;
                let lasts = match minutes < 120.0 {
                    true => format!("{minutes:.0} minutes"),
                    false => format!("{:.0} hours", minutes / 60.0),
                };
                format!(
                    "{begin}, some {steps:.0e} steps of {longest_s:.1e} s: unless it rests or overturns before, they take about \
                     {lasts}, and some 0.1 GB of memory"
                )
            })
        } else {
            (request.end_s > DURATION_S).then(|| {
                format!("{begin}: unless it rests or overturns before, that takes minutes or more")
            })
        };
        warning.map(|warning| Unlikely::new("simulation.duration_s", request.end_s, "s", warning))
    }
}

/// All numbers of a scenario, each with its key and tables, such as `load.1.mass_kg`, in their order.
struct Numbers(Vec<(String, f64)>);

impl Numbers {
    fn of(json: &Value) -> Self {
        let mut numbers = Self(Vec::new());
        let tables = json.as_object().into_iter().flatten();
        // Maps and samples change the numbers of other tables.
        for (name, table) in tables.filter(|(name, _)| !["map", "uncertain"].contains(&&***name)) {
            numbers.add(name, table);
        }
        numbers
    }

    fn add(&mut self, path: &str, value: &Value) {
        match value {
            Value::Object(table) => {
                for (key, value) in table {
                    self.add(&format!("{path}.{key}"), value);
                }
            }
            Value::Array(values) => {
                for (index, value) in values.iter().enumerate() {
                    match value.as_f64() {
                        Some(number) => self.0.push((path.to_owned(), number)),
                        None => self.add(&format!("{path}.{}", index + 1), value),
                    }
                }
            }
            value => self
                .0
                .extend(value.as_f64().map(|number| (path.to_owned(), number))),
        }
    }

    /// Adds the thickness of an arch that has a ratio instead, and the size of blocks from files.
    fn add_computed(&mut self, structure: &Structure) {
        let (key, length_m) = match structure {
            Structure::Arch(arch) if self.get("arch.thickness_m").is_none() => (
                "arch.thickness_m",
                arch.mean_radius_m * arch.thickness_ratio,
            ),
            Structure::Masonry(masonry) if matches!(masonry.shape, MasonryShape::Blocks(_)) => {
                let [low_m, high_m] = bounds_m(&masonry.row);
                ("blocks.joints", (high_m - low_m).max())
            }
            _ => return,
        };
        self.0.push((key.to_owned(), length_m));
    }

    /// Adds the ends of the axes of a map, of uniform distributions and of the range of a study.
    fn add_ranges(&mut self, scenario: &Scenario, study: &Varied<'_>) {
        let axes = scenario.map.iter().flat_map(|map| [&map.x, &map.y]);
        for axis in axes {
            let path = axis.path(scenario.ground.as_ref());
            let values = axis.sequence.values();
            let ends = [values.first(), values.last()].into_iter().flatten();
            let duration_s = |value: f64| match &scenario.ground {
                Some(Ground::Pulse(pulse)) => axis.quantity.duration_s(value, pulse),
                _ => None,
            };
            let ends = ends.map(|value| duration_s(*value).unwrap_or(*value));
            self.0.extend(ends.map(|value| (path.clone(), value)));
        }
        let uncertain = json!(scenario.uncertain);
        for (key, range) in uncertain.as_object().into_iter().flatten() {
            let ends = [&range["from"], &range["to"]]
                .into_iter()
                .filter_map(Value::as_f64);
            self.0.extend(ends.map(|value| (key.clone(), value)));
        }
        if let Some((key, ends)) = study.key_range {
            self.0.extend(ends.map(|value| (key.to_owned(), value)));
        }
    }

    /// Number of a key in the scenario itself.
    fn get(&self, key: &str) -> Option<f64> {
        let mut numbers = self.0.iter();
        numbers
            .find(|(path, _)| path == key)
            .map(|(_, number)| *number)
    }

    /// Numbers outside the usual range of their key. `forces` are the usual forces of the structure.
    fn unlikely_numbers(&self, forces: &[Usual]) -> Vec<Unlikely> {
        let numbers = self.0.iter().filter_map(|(path, value)| {
            let mut all = USUAL.iter().chain(forces);
            let usual = all.find(|usual| usual.fits(path))?;
            let magnitude = value.abs();
            let is_usual =
                usual.range.contains(&magnitude) || usual.on_purpose.contains(&magnitude);
            (!is_usual).then(|| usual.warning(path, *value))
        });
        numbers.collect()
    }
}

impl Usual {
    /// True if these are the usual numbers of a key with its tables.
    fn fits(&self, path: &str) -> bool {
        let mut given = path.split('.').rev();
        let (mut own, last) = (self.key.split('.').rev(), given.next());
        // Tables of entries, sides and pulses may stand between.
        own.next() == last && own.all(|table| given.any(|given| given == table))
    }

    /// Warning about an unusual value.
    fn warning(&self, path: &str, value: f64) -> Unlikely {
        let table = path.rsplit_once('.').map_or("", |(table, _)| table);
        let of = match table.rsplit_once('.') {
            Some((entries, number)) if number.parse::<usize>().is_ok() => {
                format!("{entries} {number}")
            }
            _ => format!("[{table}]"),
        };
        let what = self.what.replace("{of}", &of);
        let unit = match self.unit {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let likely = self.nearest_unit(value.abs());
        let end = likely.map_or(", which is unlikely".to_owned(), |unit| {
            format!(": is it in {unit}?")
        });
        let warning = format!("{what} {}{unit}{end}", plain(value));
        Unlikely::new(path, value, self.unit, warning).in_likely(likely)
    }
}
