//! The overturning map: a history for every cell of a plane of two quantities.

pub(super) mod page;
pub(super) mod picture;
mod report;

use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

pub use self::page::page_of;
pub use self::picture::draw;
pub use self::report::MapSummary;
use super::ending::{Ending, NoHistory, Verdict, answer_valid_cases};
use super::{Results, Study, Style};
use crate::dynamics::repeatability::{CheckedHistory, required_friction};
use crate::dynamics::{Direction, Directions, OutcomeCount, Repetition};
use crate::output::OutputError;
use crate::scenario::{Axis, Ground, ModelError, Quantity, Scaling, Scenario};
use crate::{Case, FourLinks, GroundMotion, Model, PulseShape, SimulationError, Summary};

/// A cell of a map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellRow {
    /// Value along x.
    pub x: f64,
    /// Value along y.
    pub y: f64,
    /// Ending of the history in the worse direction of the ground motion, or the reason why there is none.
    pub result: Result<Ending, NoHistory>,
    /// Number of different outcomes of this history and all its repetitions: one if the outcome does not depend on the computation. Overturning
    /// to either side is one outcome; rest and still rocking are two. The error is the failure of a repetition. `None` if repetitions were not
    /// requested, or there is no history.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outcomes: Option<Result<usize, String>>,
}

impl CellRow {
    /// True if the history is outside the model of four links.
    pub(super) fn is_outside_model(&self) -> bool {
        self.result.as_ref().is_ok_and(Ending::is_outside_model)
    }

    /// Ending, or the outcome to report without one.
    fn ending(&self) -> Result<&Ending, &'static str> {
        self.result.as_ref().map_err(NoHistory::name)
    }

    /// True if the numbers are those of the mirrored ground motion.
    pub(super) fn is_mirrored(&self) -> bool {
        let direction = self.result.as_ref().map(|ending| ending.direction);
        direction == Ok(Direction::Mirrored)
    }

    /// True if the outcome depends on the computation.
    pub(super) const fn is_doubtful(&self) -> bool {
        matches!(self.outcomes, Some(Ok(2..)))
    }
}

/// The cells of a map. Cell `i` has value `i / m` of x and value `i % m` of y, where `m` is the number of values of y.
#[derive(Debug)]
pub struct OverturningMap<'a> {
    /// The scenario that has the map.
    pub scenario: &'a Scenario,
    /// The axes, x and y.
    pub axes: [&'a Axis; 2],
    /// Values along x and y.
    pub values: [Vec<f64>; 2],
    /// True if the repetitions of each cell are computed, to count its outcomes.
    pub(super) repeat: bool,
    /// Four links of the arch of `base`; `None` inside if it has none.
    links: OnceLock<Option<FourLinks>>,
    /// Models that several cells share.
    models: PerAxes<Result<Arc<dyn Model>, ModelError>>,
    pulses: PerAxes<PulseShape>,
    /// The quantities and the keys of the axes. An axis that is named by a key of the ground has the quantity of that key.
    quantities: [Quantity; 2],
    paths: [String; 2],
    /// The scenario, or a sample of it. `variants` are the scenarios with other values of keys outside `[map]`.
    base: Arc<Scenario>,
    variants: Option<PerAxes<Result<Arc<Scenario>, String>>>,
}

/// Label of the ratio of peak velocity and peak acceleration of the ground.
pub(super) const VELOCITY_RATIO_LABEL: &str = "peak velocity / peak acceleration (s)";

/// Label of an axis in pictures.
pub(super) fn label(axis: &Axis) -> &str {
    match axis.quantity {
        Quantity::Duration => "pulse duration (s)",
        Quantity::Frequency => "pulse frequency (Hz)",
        Quantity::VelocityRatio => VELOCITY_RATIO_LABEL,
        Quantity::Amplitude => "pulse amplitude (g)",
        Quantity::Scale => "factor on the record",
        Quantity::PeakG => "peak ground acceleration (g)",
        Quantity::MeanRadius => "mean radius R (m)",
        Quantity::ThicknessRatio => "t / R",
        Quantity::Embrace => "embrace angle (deg)",
        Quantity::Restitution => "restitution coefficient r",
        Quantity::Other => &axis.key,
    }
}

/// The parts of a case that an axis changes, and that cells may share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Changes {
    /// The amplitude or the scaling of the ground motion.
    Strength,
    /// The duration of the pulse.
    Duration,
    /// Other keys of the ground motion.
    Ground,
    /// Keys of other tables, on which the model depends.
    Model,
}

impl Changes {
    fn of(quantity: Quantity, path: &str) -> Self {
        match quantity {
            Quantity::Amplitude | Quantity::Scale | Quantity::PeakG => Self::Strength,
            quantity if quantity.gives_duration() => Self::Duration,
            _ if path.starts_with("ground.") => Self::Ground,
            _ => Self::Model,
        }
    }
}

/// Values that depend on one axis or on none. Each value is computed at its first use.
#[derive(Debug)]
struct PerAxes<T> {
    axis: Option<usize>,
    values: Vec<OnceLock<T>>,
}

impl<T: Clone> PerAxes<T> {
    fn new(counts: [usize; 2], depends: [bool; 2]) -> Self {
        let (axis, count) = match depends {
            [false, false] => (None, 1),
            [true, false] => (Some(0), counts[0]),
            [false, true] => (Some(1), counts[1]),
            // Each value would serve a single cell, so values are not kept.
            [true, true] => (None, 0),
        };
        Self {
            axis,
            values: (0..count).map(|_| OnceLock::new()).collect(),
        }
    }

    /// Index of the value for a cell; `None` if values are not shared.
    fn value_index(&self, place: [usize; 2]) -> Option<usize> {
        let index = self.axis.map_or(0, |axis| place[axis]);
        (index < self.values.len()).then_some(index)
    }

    fn get_or_make(&self, place: [usize; 2], make: impl FnOnce() -> T) -> T {
        match self.value_index(place) {
            Some(index) => self.values[index].get_or_init(make).clone(),
            None => make(),
        }
    }
}

impl<'a> OverturningMap<'a> {
    /// Makes the map of a scenario that starts from rest. At least one cell must be valid.
    ///
    /// # Errors
    /// Change that the scenario needs, in words.
    pub fn of(scenario: &'a Scenario) -> Result<Self, String> {
        scenario.check_from_rest("map")?;
        if let Some(map) = &scenario.map {
            map.check(scenario.ground.as_ref(), &scenario.simulation)?;
        }
        let map = Self::with_sample(scenario, scenario.clone()).ok_or(
            "the scenario has no [map]: give it a table with two axes, such as\n\n\
             [map]\n\
             duration_s = { from = 0.05, to = 1.0, count = 40 }\n\
             amplitude_g = { from = 0.1, to = 1.5, count = 40 }",
        )?;
        // Keys of other tables may not exist, or may allow none of the values.
        let fault = |index| map.variant(index).and_then(|one| one.check_restitution());
        let faults = (0..map.count()).map(|index| fault(index).err());
        match faults.collect::<Option<Vec<String>>>().as_deref() {
            Some([fault, ..]) => Err(format!("no cell of [map] makes a valid scenario: {fault}")),
            _ => Ok(map),
        }
    }

    /// Makes the map of a scenario whose other values are those of `sample`. `None` if the scenario has no map or no ground motion.
    pub(super) fn with_sample(scenario: &'a Scenario, sample: Scenario) -> Option<Self> {
        let (Some(map), Some(ground)) = (&scenario.map, scenario.ground.as_ref()) else {
            return None;
        };
        let axes = [&map.x, &map.y];
        let values = axes.map(|axis| axis.sequence.values());
        let counts = [values[0].len(), values[1].len()];
        let quantities = axes.map(|axis| axis.quantity_under(ground));
        let paths = axes.map(|axis| axis.path(Some(ground)));
        let changes = [0, 1].map(|axis| Changes::of(quantities[axis], &paths[axis]));
        let depends = |on: &[Changes]| changes.map(|change| on.contains(&change));
        let variants = depends(&[Changes::Ground, Changes::Model]);
        let has_variants = variants.contains(&true);
        let base = Self::with_constant_ratio(&quantities, &sample).unwrap_or(sample);
        Some(Self {
            scenario,
            axes,
            repeat: map.repeat,
            models: PerAxes::new(counts, depends(&[Changes::Model])),
            pulses: PerAxes::new(counts, depends(&[Changes::Ground, Changes::Duration])),
            quantities,
            paths,
            links: OnceLock::new(),
            base: Arc::new(base),
            variants: has_variants.then(|| PerAxes::new(counts, variants)),
            values,
        })
    }

    /// Scenario of a cell, with the values of keys outside `[map]`.
    fn variant(&self, index: usize) -> Result<Arc<Scenario>, String> {
        let Some(variants) = &self.variants else {
            return Ok(Arc::clone(&self.base));
        };
        variants.get_or_make(self.axis_indices(index), || {
            let coordinates = self.coordinates(index);
            let values = coordinates.into_iter().enumerate();
            let changes = values.filter(|(axis, _)| self.is_of_variant(*axis));
            let values: Vec<_> = changes
                .map(|(axis, value)| (&*self.paths[axis], value))
                .collect();
            self.base.with_unproved_values(&values).map(Arc::new)
        })
    }

    /// True if an axis sets a key by another reading of the scenario; strength and duration of the ground motion change without it.
    fn is_of_variant(&self, axis: usize) -> bool {
        let changes = Changes::of(self.quantities[axis], &self.paths[axis]);
        matches!(changes, Changes::Ground | Changes::Model)
    }

    /// Scenario with the thickness ratio of its arch, which is constant under a mean radius; `None` without that axis.
    fn with_constant_ratio(quantities: &[Quantity; 2], sample: &Scenario) -> Option<Scenario> {
        let arch = sample
            .structure
            .circular_arch()
            .filter(|_| quantities.contains(&Quantity::MeanRadius))?;
        let ratio = ("arch.thickness_ratio", arch.thickness_ratio);
        sample.with_unproved_values(&[ratio]).ok()
    }

    /// Indices of a cell along x and y.
    fn axis_indices(&self, index: usize) -> [usize; 2] {
        let rows = self.values[1].len();
        [index / rows, index % rows]
    }

    /// Values of x and y of a cell.
    pub fn coordinates(&self, index: usize) -> [f64; 2] {
        let [x, y] = self.axis_indices(index);
        [self.values[0][x], self.values[1][y]]
    }

    /// Value of a quantity in a cell; `None` if no axis varies the quantity.
    fn value(&self, index: usize, quantity: Quantity) -> Option<f64> {
        let mut quantities = self.quantities.iter();
        let axis = quantities.position(|known| *known == quantity)?;
        Some(self.coordinates(index)[axis])
    }

    /// Model of motion of a cell, whose scenario has the values of keys outside `[map]`.
    fn model(&self, index: usize, scenario: &Scenario) -> Result<Arc<dyn Model>, ModelError> {
        self.models.get_or_make(self.axis_indices(index), || {
            if let Some(links) = self.links_of_size(scenario) {
                return Ok(Arc::new(links) as Arc<dyn Model>);
            }
            let model = scenario.model_for_many_cases();
            model.map(Arc::from)
        })
    }

    /// Four links of an arch that differs from that of the scenario in size only: they share the sequence of mechanisms. `None` for
    /// other structures and models.
    fn links_of_size(&self, scenario: &Scenario) -> Option<FourLinks> {
        let shape = |scenario: &Scenario| {
            let law = scenario.motion.options.law()?;
            let arch = scenario.structure.circular_arch()?;
            Some((arch.thickness_ratio, arch.embrace_deg, arch.voussoirs, law))
        };
        let (own, other) = (shape(&self.base)?, shape(scenario)?);
        if own != other {
            return None;
        }
        let links = self.links.get_or_init(|| {
            let arch = self.base.structure.circular_arch()?;
            FourLinks::of_arch(arch, own.3).ok()
        });
        let arch = scenario.structure.circular_arch()?;
        Some(links.as_ref()?.with_size_of(arch))
    }

    /// Ground motion of a cell.
    fn motion(&self, index: usize, scenario: &Scenario) -> Result<GroundMotion, String> {
        let gravity_m_s2 = scenario.gravity_m_s2();
        let value = |quantity| self.value(index, quantity);
        let motion = match scenario.ground.as_ref() {
            Some(Ground::Pulse(pulse)) => {
                let shape = self.pulses.get_or_make(self.axis_indices(index), || {
                    let mut given = self.quantities.iter().zip(self.coordinates(index));
                    let duration_s =
                        given.find_map(|(quantity, value)| quantity.duration_s(value, pulse));
                    let mut pulse = pulse.clone();
                    pulse.duration_s = duration_s.unwrap_or(pulse.duration_s);
                    pulse.shape()
                });
                let amplitude_g = value(Quantity::Amplitude).unwrap_or(pulse.amplitude_g);
                let amplitude_g = Vector2::new(amplitude_g, pulse.vertical_amplitude_g);
                let motion = shape.inclined_m_s2(amplitude_g * gravity_m_s2);
                Some(motion.map_err(|error| error.to_string())?)
            }
            Some(Ground::Record(record)) => {
                let factor = value(Quantity::Scale).map(Scaling::Factor);
                let scaling = factor.or(value(Quantity::PeakG).map(Scaling::PeakG));
                let rescaled = scaling.map(|scaling| record.rescaled(scaling, gravity_m_s2));
                rescaled.transpose()?
            }
            None => None,
        };
        Ok(match motion {
            Some(motion) => scenario.move_both_feet(motion),
            None => scenario.ground_motion().clone(),
        })
    }

    /// Model of a cell, with its ground motion and request.
    fn case(&self, index: usize) -> Result<(Arc<dyn Model>, Case), NoHistory> {
        let scenario = self.variant(index).map_err(NoHistory::Failed)?;
        let model = self.model(index, &scenario)?;
        let ground = self.motion(index, &scenario).map_err(NoHistory::Failed)?;
        let request = scenario.request_on(&ground, &scenario.structure);
        Ok((model, (ground, request)))
    }

    /// Computes the endings of cells with the same structure in the worse direction of their ground motion, and, if requested, the number of outcomes
    /// of each with its repetitions.
    fn endings(&self, model: &dyn Model, cases: &[Case]) -> Vec<Result<Ended, NoHistory>> {
        let directions = self.base.simulation.direction;
        let ended = match self.repeat {
            true => all_outcomes_in(directions, model, cases),
            false => {
                let ended = Ending::of_all_in(directions, model, cases).into_iter();
                ended.map(|ending| Ok((ending?, None))).collect()
            }
        };
        // In a map, a cell whose ground falls has failed.
        let failed = |reason: NoHistory| NoHistory::Failed(reason.to_string());
        ended
            .into_iter()
            .map(|ended| ended.map_err(failed))
            .collect()
    }
}

/// The ending of the history of a cell, and, if requested, the number of outcomes with its repetitions, or the reason why it is unknown.
type Ended = (Ending, Option<Result<usize, String>>);

/// Computes the endings of histories in the worse of these directions, and the number of outcomes of each with its repetitions. The second direction is
/// computed if the first survives or is uncertain.
fn all_outcomes_in(
    directions: Directions,
    model: &dyn Model,
    cases: &[Case],
) -> Vec<Result<Ended, NoHistory>> {
    let mut all = endings_with_repetitions(model, cases);
    for (ending, _) in all.iter_mut().flatten() {
        ending.direction = directions.first();
    }
    let is_open = |index: &usize| {
        let (ground, request) = &cases[*index];
        let verdict = all[*index].as_ref().map(|(ending, _)| ending.verdict());
        matches!(verdict, Ok(Verdict::Survives | Verdict::Uncertain))
            && directions.has_second(model, ground, request)
    };
    let open: Vec<usize> = (0..cases.len()).filter(is_open).collect();
    let mirrored = open.iter().map(|index| {
        let (ground, request) = &cases[*index];
        (ground.mirrored(), *request)
    });
    let mirrored = endings_with_repetitions(model, &mirrored.collect::<Vec<_>>());
    for (index, mirrored) in open.into_iter().zip(mirrored) {
        let (mirrored, of_mirrored) = match mirrored {
            Ok((ending, outcomes)) => (Ok(ending), outcomes),
            Err(reason) => (Err(reason), None),
        };
        let worse = |(given, outcomes): Ended| {
            let worse = given.or_worse(Some(mirrored))?;
            let outcomes = match worse.direction {
                Direction::AsGiven => outcomes,
                Direction::Mirrored => of_mirrored,
            };
            Ok((worse, outcomes))
        };
        all[index] = all[index].clone().and_then(worse);
    }
    all
}

/// Computes the endings of histories, and the number of outcomes of each with its repetitions. All histories run to their end.
fn endings_with_repetitions(model: &dyn Model, cases: &[Case]) -> Vec<Result<Ended, NoHistory>> {
    let repetitions = model.repetitions().into_iter();
    let repeated: Vec<(_, Vec<_>)> = repetitions
        .map(|Repetition { name, model }| (name, model.simulate_all(cases)))
        .collect();
    let outcomes = |(index, own): (usize, Result<Summary, SimulationError>)| {
        let own = own?;
        let others = || repeated.iter().map(|(name, all)| (*name, &all[index]));
        let computed = others().filter_map(|(_, other)| other.as_ref().ok());
        let outcomes: BTreeSet<&str> = computed
            .clone()
            .chain([&own])
            .map(|one| one.outcome.name())
            .collect();
        let count = OutcomeCount::new(&own, others());
        let failed = count.failed.first();
        let failed = failed.map(|failed| format!("with {failed}"));
        let outcomes = failed.map_or(Ok(outcomes.len()), Err);
        let friction_demand = required_friction(computed.chain([&own]));
        let ending = Ending::of_checked(CheckedHistory {
            own: Ok(own),
            count: Some(count),
            friction_demand,
        })?;
        Ok((ending, Some(outcomes)))
    };
    let own = model.simulate_all(cases).into_iter();
    own.enumerate().map(outcomes).collect()
}

impl Study for OverturningMap<'_> {
    type Row = CellRow;

    const NAME: &'static str = "map";

    const FILES: &'static [&'static str] = &report::FILES;

    fn base(&self) -> Option<&Scenario> {
        Some(self.scenario)
    }

    fn count(&self) -> usize {
        self.values[0].len() * self.values[1].len()
    }

    /// Family of cells with the same structure; `None` unless their model computes several motions faster together.
    fn family(&self, index: usize) -> Option<usize> {
        let has_lanes = self.scenario.motion.kind.has_lanes;
        has_lanes.then(|| self.models.value_index(self.axis_indices(index)))?
    }

    fn rows(&self, indices: &[usize]) -> Vec<CellRow> {
        let shared = OnceCell::new();
        let cases = indices.iter().map(|index| {
            let (model, case) = self.case(*index)?;
            shared.get_or_init(|| model);
            Ok(case)
        });
        let ended = answer_valid_cases(cases, |cases| {
            let model = shared.get();
            model.map_or(Vec::new(), |model| self.endings(&**model, cases))
        });
        let row = |(index, ended): (&usize, Result<Ended, NoHistory>)| {
            let [x, y] = self.coordinates(*index);
            let (result, outcomes) = match ended {
                Ok((ending, outcomes)) => (Ok(ending), outcomes),
                Err(reason) => (Err(reason), None),
            };
            CellRow {
                x,
                y,
                result,
                outcomes,
            }
        };
        indices.iter().zip(ended).map(row).collect()
    }

    fn results(&self, rows: Vec<CellRow>, style: Style) -> Result<Results, OutputError> {
        self.report(&rows, style)
    }
}

/// Use of a map of four links of an arch, in words, with the measured shares of wrong cells; `None` for other models and for columns.
fn use_in_words(scenario: &Scenario) -> Option<&'static str> {
    let is_looked_at =
        scenario.motion.kind.has_mechanism && scenario.structure.has_horizontal_thrust();
    is_looked_at.then_some(
        "a map of four links is for looking: in the map of docs/recipes.md, 22 % of the surviving cells inside the model and 41 % of those outside \
         overturn with free hinges; compute a map with free hinges to quote it",
    )
}
