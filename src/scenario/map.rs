//! The overturning map: `[map]`.
//!
//! ```toml
//! [map]
//! duration_s = { from = 0.05, to = 1.0, count = 60 }
//! amplitude_g = { from = 0.15, to = 1.5, count = 80, spacing = "logarithmic" }
//! ```
//!
//! Two quantities of the scenario vary; all else stays as it is.

use std::sync::OnceLock;

use super::keys::{
    AMPLITUDE_G, DURATION_S, EMBRACE_DEG, FREQUENCY_HZ, MAGNITUDE, RESTITUTION, THICKNESS_RATIO,
};
use super::sequence::Sequence;
use super::table::{Number, Reading, Table, Writer};
use super::{Ground, PulseGround, Scenario, Simulation, Structure};
use crate::dynamics::model::SimulationError;
use crate::mechanics::four_link::arch::FourLinkError;
use crate::mechanics::four_link::impact::ImpactModel;
use crate::studies::specimen::{Specimen, Verdict};

named! {
    /// What may vary over a map, by its key in `[map]`. Of two, the first in this order goes along x.
    pub enum Quantity {
        /// Duration of the pulse.
        Duration = "duration_s",
        /// Its inverse.
        Frequency = "frequency_hz",
        /// Mean radius of the arch; its thickness ratio stays.
        MeanRadius = "mean_radius_m",
        /// Thickness over mean radius.
        ThicknessRatio = "thickness_ratio",
        /// Embrace angle.
        Embrace = "embrace_deg",
        /// Restitution coefficient, with the model `prescribed`.
        Restitution = "restitution",
        /// Peak acceleration of the pulse.
        Amplitude = "amplitude_g",
    }
}

impl Quantity {
    /// What the scenario's own key allows.
    const fn range(self) -> &'static Number {
        match self {
            Self::Duration => &DURATION_S,
            Self::Frequency => &FREQUENCY_HZ,
            Self::MeanRadius => &MAGNITUDE,
            Self::ThicknessRatio => &THICKNESS_RATIO,
            Self::Embrace => &EMBRACE_DEG,
            Self::Restitution => &RESTITUTION,
            Self::Amplitude => &AMPLITUDE_G,
        }
    }
}

/// One direction of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What varies.
    pub quantity: Quantity,
    /// Its values.
    pub sequence: Sequence,
}

/// Which cells a map has.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// To the right.
    pub x: Axis,
    /// Upwards; the amplitude where it is one of the two.
    pub y: Axis,
}

/// Cells of a map: more would not fit into a picture, nor their rows into memory.
const MOST_CELLS: usize = 1_000_000;

impl Map {
    /// Reads `[map]`; whether it suits what stands and how it is shaken is told where they are known.
    pub(super) fn read(
        table: &mut Table<'_>,
        structure: Option<&Structure>,
        ground: Option<&Option<Ground>>,
        impact: Option<&ImpactModel>,
        simulation: Option<&Simulation>,
    ) -> Reading<Self> {
        let read: Vec<_> = Quantity::ALL
            .iter()
            .map(|&quantity| {
                let sequence = Sequence::read(table, quantity.name(), quantity.range())?;
                if sequence.is_some() {
                    suits(table, quantity, structure, impact)?;
                }
                Ok(sequence.map(|sequence| Axis { quantity, sequence }))
            })
            .collect();
        let axes: Vec<_> = read.into_iter().collect::<Reading<Vec<_>>>()?;
        let mut axes = axes.into_iter().flatten();
        let (Some(x), Some(y), None) = (axes.next(), axes.next(), axes.next()) else {
            let keys: Vec<_> = Quantity::ALL.iter().map(|one| one.name()).collect();
            return Err(
                table.wrong_itself(format!("needs exactly two of the keys {}", keys.join(", ")))
            );
        };
        if (x.quantity, y.quantity) == (Quantity::Duration, Quantity::Frequency) {
            let wrong = "stands beside `duration_s`, its inverse; allowed is one of them";
            return Err(table.wrong("frequency_hz", wrong));
        }
        let cells = x.sequence.values().len() * y.sequence.values().len();
        if cells > MOST_CELLS {
            return Err(table.wrong_itself(format!(
                "has {cells} cells; allowed are at most {MOST_CELLS}"
            )));
        }
        Ground::check_pulse(table, ground)?;
        let map = Self { x, y };
        if let (Some(Some(Ground::Pulse(pulse))), Some(simulation)) = (ground, simulation) {
            map.check_end(table, pulse, simulation)?;
        }
        Ok(map)
    }

    /// Checks that no pulse is cut off.
    fn check_end(
        &self,
        table: &mut Table<'_>,
        pulse: &PulseGround,
        simulation: &Simulation,
    ) -> Reading<()> {
        let longest_s = [&self.x, &self.y].into_iter().find_map(|axis| {
            let values = axis.sequence.values();
            match axis.quantity {
                Quantity::Duration => values.last().copied(),
                Quantity::Frequency => values.first().map(|frequency_hz| 1.0 / frequency_hz),
                _ => None,
            }
        });
        let longest = PulseGround {
            duration_s: longest_s.unwrap_or(pulse.duration_s),
            ..pulse.clone()
        };
        let end_s = longest.motion(1.0).end_s();
        if end_s <= simulation.duration_s {
            return Ok(());
        }
        Err(table.wrong_itself(format!(
            "has pulses that last until {end_s:?} s and would be cut off; allowed is a `duration_s` in [simulation] \
             of at least that, and here it is {:?}",
            simulation.duration_s
        )))
    }

    pub(super) fn write(&self, out: &mut Writer) {
        out.table("map");
        for axis in [&self.x, &self.y] {
            axis.sequence.write(axis.quantity.name(), out);
        }
    }
}

/// Refuses a quantity that the scenario does not have.
fn suits(
    table: &mut Table<'_>,
    quantity: Quantity,
    structure: Option<&Structure>,
    impact: Option<&ImpactModel>,
) -> Reading<()> {
    let wrong = match quantity {
        Quantity::MeanRadius | Quantity::ThicknessRatio | Quantity::Embrace
            if matches!(structure, Some(Structure::Column(_))) =>
        {
            "goes with an [arch], and this is a column"
        }
        Quantity::Restitution
            if impact.is_some_and(|model| !matches!(model, ImpactModel::Prescribed { .. })) =>
        {
            "goes with model = \"prescribed\" in [impact]"
        }
        _ => return Ok(()),
    };
    Err(table.wrong(quantity.name(), wrong))
}

/// What became of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Its history.
    Shaken(Verdict),
    /// There is no such arch, or none that four links describe.
    NoArch(FourLinkError),
    /// Its history could not be computed.
    Failed(SimulationError),
}

/// The cells of a map, each a function of its index alone: cell `i` has the `i / m`-th value of x and the
/// `i % m`-th of y, of which there are `m`.
#[derive(Debug)]
pub struct Cells<'a> {
    scenario: &'a Scenario,
    pulse: &'a PulseGround,
    axes: [&'a Axis; 2],
    values: [Vec<f64>; 2],
    /// The structures that serve more than one cell, of which only the size may yet vary, in the order of the
    /// values on which they depend; each is made when first asked for.
    structures: Vec<OnceLock<Result<Specimen, FourLinkError>>>,
}

impl<'a> Cells<'a> {
    /// The cells of a scenario's map; `None` if it has no map or no pulse.
    #[must_use]
    pub fn new(scenario: &'a Scenario) -> Option<Self> {
        let (Some(map), Some(Ground::Pulse(pulse))) = (&scenario.map, &scenario.ground) else {
            return None;
        };
        let axes = [&map.x, &map.y];
        let values = axes.map(|axis| axis.sequence.values());
        let mut cells = Self {
            scenario,
            pulse,
            axes,
            values,
            structures: Vec::new(),
        };
        let kept = match (cells.shapes(0), cells.shapes(1)) {
            (false, false) => 1,
            (true, false) => cells.values[0].len(),
            (false, true) => cells.values[1].len(),
            // Each serves a single cell.
            (true, true) => 0,
        };
        cells.structures = (0..kept).map(|_| OnceLock::new()).collect();
        Some(cells)
    }

    /// Whether another value along an axis makes another chain of mechanisms.
    fn shapes(&self, axis: usize) -> bool {
        matches!(
            self.axes[axis].quantity,
            Quantity::ThicknessRatio | Quantity::Embrace | Quantity::Restitution
        )
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

    /// Number of cells.
    #[must_use]
    pub fn count(&self) -> usize {
        self.values[0].len() * self.values[1].len()
    }

    /// Indices along x and y.
    fn place(&self, index: usize) -> [usize; 2] {
        let high = self.values[1].len();
        [index / high, index % high]
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
    fn specimen(&self, index: usize) -> Result<Specimen, FourLinkError> {
        let place = self.place(index);
        let which = (0..2)
            .filter(|axis| self.shapes(*axis))
            .fold(0, |which, axis| {
                which * self.values[axis].len() + place[axis]
            });
        let mut specimen = match self.structures.get(which) {
            Some(kept) => kept.get_or_init(|| self.make(index)).clone()?,
            None => self.make(index)?,
        };
        if let (Specimen::Arch(arch), Some(mean_radius_m)) =
            (&mut specimen, self.value(index, Quantity::MeanRadius))
        {
            *arch = arch.with_mean_radius_m(mean_radius_m)?;
        }
        Ok(specimen)
    }

    fn make(&self, index: usize) -> Result<Specimen, FourLinkError> {
        let value = |quantity, otherwise| self.value(index, quantity).unwrap_or(otherwise);
        let model = match self.scenario.impact {
            ImpactModel::Prescribed { restitution } => ImpactModel::Prescribed {
                restitution: value(Quantity::Restitution, restitution),
            },
            model => model,
        };
        let mut structure = self.scenario.structure.clone();
        if let Structure::Arch(arch) = &mut structure {
            arch.thickness_ratio = value(Quantity::ThicknessRatio, arch.thickness_ratio);
            arch.embrace_deg = value(Quantity::Embrace, arch.embrace_deg);
        }
        structure.specimen(model)
    }

    /// The pulse of a cell.
    fn pulse(&self, index: usize) -> PulseGround {
        let value = |quantity, otherwise| self.value(index, quantity).unwrap_or(otherwise);
        let duration_s = match self.value(index, Quantity::Frequency) {
            Some(frequency_hz) => 1.0 / frequency_hz,
            None => value(Quantity::Duration, self.pulse.duration_s),
        };
        PulseGround {
            amplitude_g: value(Quantity::Amplitude, self.pulse.amplitude_g),
            duration_s,
            ..self.pulse.clone()
        }
    }

    /// The history of a cell.
    #[must_use]
    pub fn cell(&self, index: usize) -> Cell {
        let specimen = match self.specimen(index) {
            Ok(specimen) => specimen,
            Err(error) => return Cell::NoArch(error),
        };
        let conditions = self.scenario.conditions();
        let ground = self.pulse(index).motion(conditions.gravity_m_s2);
        match specimen.verdict(&ground, &conditions) {
            Ok(verdict) => Cell::Shaken(verdict),
            Err(error) => Cell::Failed(error),
        }
    }

    /// Along x, the amplitudes that are boundaries of a map whose y is the amplitude: incipient, and least
    /// without impact.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn boundary(&self, x: usize) -> Result<Option<Boundary>, SimulationError> {
        let index = x * self.values[1].len();
        let Ok(specimen) = self.specimen(index) else {
            return Ok(None);
        };
        let conditions = self.scenario.conditions();
        // The cells are looked at as well, so that none contradicts the boundary.
        let sampled_g: Vec<f64> = self.values[1].iter().map(|value| value.abs()).collect();
        let without_impact =
            self.pulse(index)
                .without_impact(&specimen, &conditions, &sampled_g)?;
        Ok(Some(Boundary {
            x: self.values[0][x],
            incipient_g: specimen.incipient_g(),
            impact_free_g: without_impact.map(|(amplitude_g, _)| amplitude_g),
        }))
    }
}

/// Boundaries of a map at some x, as magnitudes: the mirror image of a pulse has the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Where.
    pub x: f64,
    /// Below this peak acceleration nothing moves, in g.
    pub incipient_g: f64,
    /// From this amplitude on the first fall overturns, before any impact, in g; `None` where no amplitude
    /// does that a scenario may have.
    pub impact_free_g: Option<f64>,
}
