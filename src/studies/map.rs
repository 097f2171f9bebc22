//! The overturning map: a history for every cell of a plane of two quantities.

use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

use super::ending::Ending;
use super::impact_free::ScalablePulse;
use super::runner::Study;
use crate::argument::ArgumentError;
use crate::dynamics::free_hinges::spread::REPETITIONS;
use crate::dynamics::free_hinges::{FreeHinges, FreeHingesError};
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::Outcome;
use crate::dynamics::model::{MechanismModel, Model};
use crate::mechanics::column::RockingColumn;
use crate::mechanics::four_link::arch::{FourLinkArch, FourLinkError};
use crate::mechanics::four_link::impact::{ImpactLaw, ImpactModel};
use crate::mechanics::four_link::limit::LimitError;
use crate::mechanics::four_link::row::FourLinkRow;
use crate::mechanics::stability::StabilityError;
use crate::scenario::{Axis, Ground, ModelError, PulseGround, Quantity, Scenario, Structure};

/// What became of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CellResult {
    /// Its history ended.
    Ended(Ending),
    /// There is no such arch: it cannot carry its own weight.
    CannotStand,
    /// The arch is too thick for four links.
    NotFourLinks,
    /// Its history could not be computed, for this reason.
    Failed(String),
}

impl From<ModelError> for CellResult {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::FourLinks(FourLinkError::Limit(LimitError::CannotStand))
            | ModelError::FreeHinges(FreeHingesError::Stability(StabilityError::CannotStand(_))) => {
                Self::CannotStand
            }
            ModelError::FourLinks(FourLinkError::Limit(
                LimitError::OtherMechanism { .. } | LimitError::NoPush,
            )) => Self::NotFourLinks,
            error => Self::Failed(error.to_string()),
        }
    }
}

impl From<Result<Ending, String>> for CellResult {
    fn from(ending: Result<Ending, String>) -> Self {
        ending.map_or_else(Self::Failed, Self::Ended)
    }
}

/// A cell of a map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellRow {
    /// Value along x.
    pub x: f64,
    /// Value along y.
    pub y: f64,
    /// What became of it.
    pub result: CellResult,
    /// How many outcomes it has with the steps as they are, half and double: one, if it does not depend on them. To
    /// which side it overturns does not count. Or why a repetition failed. `None` where that was not asked, or there
    /// is no history.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<Result<usize, String>>,
}

/// The cells of a map: cell `i` has the `i / m`-th value of x and the `i % m`-th of y, of which there are `m`.
#[derive(Debug)]
pub struct OverturningMap<'a> {
    scenario: &'a Scenario,
    pulse: &'a PulseGround,
    axes: [&'a Axis; 2],
    values: [Vec<f64>; 2],
    /// Whether each cell tells how many outcomes it has with other steps.
    spread: bool,
    /// The structures and pulses that serve more than one cell.
    structures: Shared<Result<Standing, ModelError>>,
    pulses: Shared<ScalablePulse>,
}

/// What stands in cells: of any size, but for a row of blocks.
#[derive(Clone, Debug)]
enum Standing {
    Arch(FourLinkArch),
    Column(RockingColumn),
    FourLinkRow(Arc<FourLinkRow>),
    Row(Arc<FreeHinges>),
}

impl Standing {
    fn model(&self) -> &dyn Model {
        match self {
            Self::Arch(arch) => arch,
            Self::Column(column) => column,
            Self::FourLinkRow(row) => &**row,
            Self::Row(row) => &**row,
        }
    }
}

/// Values that depend on no axis or on one, for each of its values; each is made when first asked for.
#[derive(Debug)]
struct Shared<T> {
    axis: Option<usize>,
    values: Vec<OnceLock<T>>,
}

impl<T: Clone> Shared<T> {
    fn new(counts: [usize; 2], depends: [bool; 2]) -> Self {
        let (axis, count) = match depends {
            [false, false] => (None, 1),
            [true, false] => (Some(0), counts[0]),
            [false, true] => (Some(1), counts[1]),
            // Each serves a single cell.
            [true, true] => (None, 0),
        };
        Self {
            axis,
            values: (0..count).map(|_| OnceLock::new()).collect(),
        }
    }

    fn get(&self, place: [usize; 2], make: impl FnOnce() -> T) -> T {
        match self.values.get(self.axis.map_or(0, |axis| place[axis])) {
            Some(shared) => shared.get_or_init(make).clone(),
            None => make(),
        }
    }
}

impl<'a> OverturningMap<'a> {
    /// The cells of a scenario's map; `None` if it has no map or no pulse.
    #[must_use]
    pub fn new(scenario: &'a Scenario) -> Option<Self> {
        let (Some(map), Some(Ground::Pulse(pulse))) = (&scenario.map, &scenario.ground) else {
            return None;
        };
        let axes = [&map.x, &map.y];
        let values = axes.map(|axis| axis.sequence.values());
        let counts = [values[0].len(), values[1].len()];
        let depends = |on: &[Quantity]| axes.map(|axis| on.contains(&axis.quantity));
        let shapes = [
            Quantity::ThicknessRatio,
            Quantity::Embrace,
            Quantity::Restitution,
        ];
        let mut structures = depends(&shapes);
        if scenario.free_hinges.is_some() {
            for (depends, of_size) in structures.iter_mut().zip(depends(&[Quantity::MeanRadius])) {
                *depends |= of_size;
            }
        }
        let durations = [Quantity::Duration, Quantity::Frequency];
        Some(Self {
            scenario,
            pulse,
            axes,
            spread: map.spread,
            structures: Shared::new(counts, structures),
            pulses: Shared::new(counts, depends(&durations)),
            values,
        })
    }

    /// The scenario.
    #[must_use]
    pub const fn scenario(&self) -> &'a Scenario {
        self.scenario
    }

    /// Values along x and y.
    #[must_use]
    pub const fn values(&self) -> &[Vec<f64>; 2] {
        &self.values
    }

    /// The axes, x and y.
    #[must_use]
    pub const fn axes(&self) -> [&'a Axis; 2] {
        self.axes
    }

    /// Whether cells are rows of blocks with free hinges.
    #[must_use]
    pub const fn has_free_hinges(&self) -> bool {
        self.scenario.free_hinges.is_some()
    }

    /// Whether each cell tells how many outcomes it has with other steps.
    #[must_use]
    pub const fn has_spread(&self) -> bool {
        self.spread
    }

    /// Whether the ground moves vertically too.
    #[must_use]
    pub fn moves_vertically(&self) -> bool {
        self.pulse.vertical_amplitude_g != 0.0
    }

    /// Indices along x and y.
    fn place(&self, index: usize) -> [usize; 2] {
        let rows = self.values[1].len();
        [index / rows, index % rows]
    }

    /// Values of x and y.
    #[must_use]
    pub fn coordinates(&self, index: usize) -> [f64; 2] {
        let [x, y] = self.place(index);
        [self.values[0][x], self.values[1][y]]
    }

    /// The value that a quantity has in a cell, where it varies.
    fn value(&self, index: usize, quantity: Quantity) -> Option<f64> {
        let axis = self
            .axes
            .iter()
            .position(|axis| axis.quantity == quantity)?;
        Some(self.coordinates(index)[axis])
    }

    /// What stands in a cell.
    fn standing(&self, index: usize) -> Result<Standing, ModelError> {
        let make = || match self.scenario.free_hinges {
            Some(steps) => {
                let structure = self.structure(index).map_err(FreeHingesError::from)?;
                Ok(Standing::Row(Arc::new(structure.free_hinges(steps)?)))
            }
            None => Ok(self.mechanisms(index)?),
        };
        let standing = self.structures.get(self.place(index), make)?;
        Ok(match (standing, self.value(index, Quantity::MeanRadius)) {
            (Standing::Arch(arch), Some(mean_radius_m)) => {
                let arch = arch.with_mean_radius_m(mean_radius_m);
                Standing::Arch(arch.map_err(FourLinkError::from)?)
            }
            (standing, _) => standing,
        })
    }

    /// The model of what stands in a cell, where it has one degree of freedom at a time.
    pub(super) fn mechanism_model(
        &self,
        index: usize,
    ) -> Result<Option<Box<dyn MechanismModel>>, ModelError> {
        Ok(match self.standing(index)? {
            Standing::Arch(arch) => Some(Box::new(arch)),
            Standing::Column(column) => Some(Box::new(column)),
            Standing::FourLinkRow(row) => Some(Box::new((*row).clone())),
            Standing::Row(_) => None,
        })
    }

    /// The structure of a cell.
    fn structure(&self, index: usize) -> Result<Structure, ArgumentError> {
        let arch = match &self.scenario.structure {
            Structure::Arch(arch) => arch,
            other @ (Structure::Column(_) | Structure::Masonry(_)) => return Ok(other.clone()),
        };
        let mut arch = arch.clone();
        if let Some(thickness_ratio) = self.value(index, Quantity::ThicknessRatio) {
            arch = arch.with_thickness_ratio(thickness_ratio)?;
        }
        if let Some(embrace_deg) = self.value(index, Quantity::Embrace) {
            arch = arch.with_embrace_deg(embrace_deg)?;
        }
        // Arches of one shape share their limit analysis.
        if let Some(mean_radius_m) = self.value(index, Quantity::MeanRadius) {
            arch = arch.with_mean_radius_m(mean_radius_m)?;
        }
        Ok(Structure::Arch(arch))
    }

    /// The mechanisms of the structure of a cell.
    fn mechanisms(&self, index: usize) -> Result<Standing, FourLinkError> {
        let model = match self.scenario.impact.model {
            ImpactModel::Prescribed { restitution } => ImpactModel::Prescribed {
                restitution: self
                    .value(index, Quantity::Restitution)
                    .unwrap_or(restitution),
            },
            model => model,
        };
        let impact = ImpactLaw {
            model,
            ..self.scenario.impact
        };
        Ok(match self.structure(index)? {
            Structure::Arch(arch) => Standing::Arch(FourLinkArch::new(arch, impact)?),
            Structure::Column(column) => Standing::Column(RockingColumn::new(&column, impact)?),
            Structure::Masonry(masonry) => {
                Standing::FourLinkRow(Arc::new(FourLinkRow::new(masonry.row(), impact)?))
            }
        })
    }

    /// The pulse of a cell, of any amplitude.
    pub(super) fn pulse(&self, index: usize) -> ScalablePulse {
        self.pulses.get(self.place(index), || {
            let duration_s = match self.value(index, Quantity::Frequency) {
                Some(frequency_hz) => 1.0 / frequency_hz,
                None => {
                    let value = self.value(index, Quantity::Duration);
                    value.unwrap_or(self.pulse.duration_s)
                }
            };
            let pulse = PulseGround {
                duration_s,
                ..self.pulse.clone()
            };
            ScalablePulse::new(pulse, self.scenario.simulation.gravity_m_s2)
        })
    }

    /// What becomes of a cell, and how many outcomes it has with other steps.
    fn result(&self, index: usize) -> (CellResult, Option<Result<usize, String>>) {
        let standing = match self.standing(index) {
            Ok(standing) => standing,
            Err(error) => return (error.into(), None),
        };
        let amplitude_g = self.value(index, Quantity::Amplitude);
        let ground = self
            .pulse(index)
            .motion(amplitude_g.unwrap_or(self.pulse.amplitude_g));
        let request = self.scenario.request_from_rest();
        let ending = Ending::of(standing.model(), &ground, &request);
        let spread = match (&standing, &ending) {
            (Standing::Row(row), Ok(own)) if self.spread => {
                Some(self.outcomes(row, &ground, own.outcome))
            }
            _ => None,
        };
        (ending.into(), spread)
    }

    /// How many outcomes a row of blocks has with its own steps, half of them and double.
    fn outcomes(
        &self,
        row: &FreeHinges,
        ground: &GroundMotion,
        own: Outcome,
    ) -> Result<usize, String> {
        let request = self.scenario.request_from_rest();
        let mut names = vec![own.name()];
        for factor in REPETITIONS {
            let row = row.with_coarse_steps_times(factor, &request);
            let ending = Ending::of(&row, ground, &request)
                .map_err(|error| format!("with {factor} times the steps: {error}"))?;
            let other = ending.outcome.name();
            if !names.contains(&other) {
                names.push(other);
            }
        }
        Ok(names.len())
    }
}

impl Study for OverturningMap<'_> {
    type Row = CellRow;

    const NAME: &'static str = "cells";

    fn scenario(&self) -> String {
        self.scenario.to_toml()
    }

    fn count(&self) -> usize {
        self.values[0].len() * self.values[1].len()
    }

    fn row(&self, index: usize) -> CellRow {
        let [x, y] = self.coordinates(index);
        let (result, spread) = self.result(index);
        CellRow {
            x,
            y,
            result,
            spread,
        }
    }
}
