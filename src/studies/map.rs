//! The overturning map: a history for every cell of a plane of two quantities.

use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

use super::ending::Ending;
use super::impact_free::ScalablePulse;
use super::runner::Study;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::column::RockingColumn;
use crate::mechanics::four_link::arch::{FourLinkArch, FourLinkError};
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::four_link::limit::LimitError;
use crate::scenario::{Axis, Ground, PulseGround, Quantity, Scenario, Structure};

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

impl From<FourLinkError> for CellResult {
    fn from(error: FourLinkError) -> Self {
        match error {
            FourLinkError::Limit(LimitError::CannotStand) => Self::CannotStand,
            FourLinkError::Limit(LimitError::OtherMechanism { .. } | LimitError::NoPush) => {
                Self::NotFourLinks
            }
            FourLinkError::Argument(error) => Self::Failed(error.to_string()),
        }
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
}

/// The cells of a map: cell `i` has the `i / m`-th value of x and the `i % m`-th of y, of which there are `m`.
#[derive(Debug)]
pub struct OverturningMap<'a> {
    scenario: &'a Scenario,
    pulse: &'a PulseGround,
    axes: [&'a Axis; 2],
    values: [Vec<f64>; 2],
    /// The structures and pulses that serve more than one cell.
    structures: Shared<Result<Standing, FourLinkError>>,
    pulses: Shared<ScalablePulse>,
}

/// What stands in cells of any size.
#[derive(Clone, Debug)]
enum Standing {
    Arch(FourLinkArch),
    Column(RockingColumn),
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
        let durations = [Quantity::Duration, Quantity::Frequency];
        Some(Self {
            scenario,
            pulse,
            axes,
            structures: Shared::new(counts, depends(&shapes)),
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

    /// The model of what stands in a cell.
    pub(super) fn model(&self, index: usize) -> Result<Arc<dyn MechanismModel>, FourLinkError> {
        let make = || self.make_standing(index);
        let standing = self.structures.get(self.place(index), make)?;
        Ok(match (standing, self.value(index, Quantity::MeanRadius)) {
            (Standing::Arch(arch), Some(mean_radius_m)) => {
                Arc::new(arch.with_mean_radius_m(mean_radius_m)?)
            }
            (Standing::Arch(arch), None) => Arc::new(arch),
            (Standing::Column(column), _) => Arc::new(column),
        })
    }

    /// The same, but for its size.
    fn make_standing(&self, index: usize) -> Result<Standing, FourLinkError> {
        let impact = match self.scenario.impact {
            ImpactModel::Prescribed { restitution } => ImpactModel::Prescribed {
                restitution: self
                    .value(index, Quantity::Restitution)
                    .unwrap_or(restitution),
            },
            impact => impact,
        };
        match &self.scenario.structure {
            Structure::Arch(arch) => {
                let mut arch = arch.clone();
                // Arches of one shape share their limit analysis.
                if let Some(thickness_ratio) = self.value(index, Quantity::ThicknessRatio) {
                    arch = arch.with_thickness_ratio(thickness_ratio)?;
                }
                if let Some(embrace_deg) = self.value(index, Quantity::Embrace) {
                    arch = arch.with_embrace_deg(embrace_deg)?;
                }
                FourLinkArch::new(arch, impact).map(Standing::Arch)
            }
            Structure::Column(column) => {
                Ok(RockingColumn::new(column, impact).map(Standing::Column)?)
            }
        }
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

    fn result(&self, index: usize) -> CellResult {
        let model = match self.model(index) {
            Ok(model) => model,
            Err(error) => return error.into(),
        };
        let amplitude_g = self.value(index, Quantity::Amplitude);
        let ground = self
            .pulse(index)
            .motion(amplitude_g.unwrap_or(self.pulse.amplitude_g));
        match Ending::of(&*model, &ground, &self.scenario.request_from_rest()) {
            Ok(ending) => CellResult::Ended(ending),
            Err(reason) => CellResult::Failed(reason),
        }
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
        CellRow {
            x,
            y,
            result: self.result(index),
        }
    }
}
