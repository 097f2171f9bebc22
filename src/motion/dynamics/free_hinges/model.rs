//! A row of blocks with free hinges as a model of motion.

use std::ops::RangeInclusive;

use serde::Serialize;

use super::motion::motion;
use super::settings::MANY_CASES_STEP_RATIO;
use crate::argument::{ArgumentError, allow, within};
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::Summary;
use crate::dynamics::model::{Model, Recorder, Repetition, Request, SimulationError, check};
use crate::dynamics::recording::Shape;
use crate::dynamics::row::clock::Settings;
use crate::dynamics::row::course::balanced;
use crate::dynamics::row::error::RowModelError;
use crate::dynamics::row::standing::RigidRow;
use crate::mechanics::arch::Arch;
use crate::mechanics::blocks::Row;
use crate::mechanics::column::Column;
use crate::mechanics::settling::Movements;
use crate::mechanics::sway::Sway;

/// Rigid blocks in a row, an arch or a stack, whose joints open about either edge, and shut again, at any time.
///
/// Joints carry no tension and do not slide; impacts are perfectly inelastic. Hinges and restitution follow from the
/// blocks alone.
#[derive(Clone, Debug)]
pub struct FreeHinges {
    rigid: RigidRow,
    options: RowOptions,
    /// True for a study of many cases: its default steps are longer.
    many_cases: bool,
    /// Factor on the steps, for a repetition.
    steps_times: f64,
    /// Whether landings that follow an impact are merged, for a repetition.
    merges_landings: bool,
}

/// Options of the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RowOptions {
    /// The longest step, in seconds (1e-9 to 1); if `None`, it follows the size of the row.
    pub longest_step_s: Option<f64>,
    /// Landings that crowd within this time, in seconds, are taken as one; if `None`, a thirtieth of the longest step.
    pub shortest_step_s: Option<f64>,
    /// Coulomb's coefficient of friction at every joint, in 0.001 to 1000; if `None`, joints do not slip.
    pub friction_coefficient: Option<f64>,
}

impl RowOptions {
    /// With shorter steps a run takes forever; longer ones miss the motion.
    pub const STEP_S: RangeInclusive<f64> = 1e-9..=1.0;
    /// Joints of stone have 0.5 to 0.8. Beyond the upper end nothing slips, and below the lower one nothing stands.
    pub const FRICTION_COEFFICIENT: RangeInclusive<f64> = 1e-3..=1e3;

    /// Refuses steps and coefficients that are not valid.
    pub fn checked(self) -> Result<Self, ArgumentError> {
        let friction = self.friction_coefficient;
        for (argument, value, range) in [
            ("longest_step_s", self.longest_step_s, Self::STEP_S),
            ("shortest_step_s", self.shortest_step_s, Self::STEP_S),
            ("friction_coefficient", friction, Self::FRICTION_COEFFICIENT),
        ] {
            if let Some(value) = value {
                within(argument, value, range)?;
            }
        }
        if let Some(shortest_s) = self.shortest_step_s {
            let allowed = "left out where joints slip: then all steps are the longest";
            allow(friction.is_none(), "shortest_step_s", shortest_s, allowed)?;
            let longest_s = self.longest_step_s.unwrap_or(f64::INFINITY);
            let allowed = format_args!("at least the shortest step, {shortest_s:?}");
            allow(
                longest_s >= shortest_s,
                "longest_step_s",
                longest_s,
                allowed,
            )?;
        }
        Ok(self)
    }
}

/// The step that an error of the energy balance proposes, over the longest step.
const SHORTER: f64 = 0.2;
/// An energy balance that is wrong by more than this fraction of the largest energy of the motion is mentioned.
pub const DOUBTFUL_ENERGY_ERROR: f64 = 1e-3;

impl FreeHinges {
    /// A model of any row that stands.
    ///
    /// # Errors
    /// When the row cannot carry its own weight.
    pub fn new(row: Row) -> Result<Self, RowModelError> {
        Ok(Self {
            rigid: RigidRow::new(row)?,
            options: RowOptions::default(),
            many_cases: false,
            steps_times: 1.0,
            merges_landings: false,
        })
    }

    /// The voussoirs of an arch.
    ///
    /// # Errors
    /// When the arch has no voussoirs, or cannot carry its own weight.
    pub fn of_arch(arch: &Arch) -> Result<Self, RowModelError> {
        Self::new(arch.row()?)
    }

    /// The drums of a column.
    ///
    /// # Errors
    /// When the drums do not make a row, or the column cannot carry its own weight.
    pub fn of_column(column: &Column) -> Result<Self, RowModelError> {
        Self::new(column.row()?)
    }

    /// This model on supports that moved slowly before time zero, from where they were built. It starts on the hinges that this
    /// movement opened; displacements and rotations count from there.
    ///
    /// # Errors
    /// When it falls or a tie breaks on the way, or it slides there.
    pub fn on_supports(self, movements: &Movements) -> Result<Self, RowModelError> {
        if movements.is_none() {
            return Ok(self);
        }
        let rigid = self.rigid.on_supports(movements)?;
        let rigid = rigid.with_friction(self.options.friction_coefficient)?;
        Ok(Self { rigid, ..self })
    }

    /// This model with other options.
    ///
    /// # Errors
    /// When a step or the coefficient is out of range, the longest step is shorter than the shortest, a
    /// shortest step is given for joints that slip, or the row slides apart under its own weight.
    pub fn with_options(self, options: RowOptions) -> Result<Self, RowModelError> {
        let options = options.checked()?;
        let rigid = self.rigid.with_friction(options.friction_coefficient)?;
        Ok(Self {
            rigid,
            options,
            ..self
        })
    }

    /// This model for a study of many cases. Without slip its default steps are longer. Few answers change, and where one does,
    /// repetitions disagree.
    #[must_use]
    pub const fn for_many_cases(mut self) -> Self {
        self.many_cases = true;
        self
    }

    /// Coulomb's coefficient of friction; `None` if joints do not slip.
    #[must_use]
    pub const fn friction_coefficient(&self) -> Option<f64> {
        self.options.friction_coefficient
    }

    /// The blocks.
    #[must_use]
    pub const fn row(&self) -> &Row {
        &self.rigid.row
    }

    /// Energy that the first mechanism has to gain to overturn, in J, to the side where that is less; `None` where it is
    /// not known.
    #[must_use]
    pub fn barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        self.rigid.barrier_j(gravity_m_s2)
    }

    /// The longest step that a history takes, in seconds.
    pub fn longest_step_s(&self, request: &Request) -> f64 {
        self.settings(request).longest_step_s
    }

    /// Settings of the computation of a motion.
    fn settings(&self, request: &Request) -> Settings {
        let (row, gravity_m_s2, end_s) = (self.row(), request.gravity_m_s2, request.end_s);
        let mut settings = match self.options.friction_coefficient {
            None if self.many_cases => {
                Settings::to_landings(row, gravity_m_s2, end_s).times(MANY_CASES_STEP_RATIO)
            }
            None => Settings::to_landings(row, gravity_m_s2, end_s),
            Some(_) => Settings::equal(row, gravity_m_s2, end_s),
        };
        if let Some(longest_s) = self.options.longest_step_s {
            settings = settings.times(longest_s / settings.longest_step_s);
        }
        if let Some(shortest_s) = self.options.shortest_step_s {
            settings.shortest_step_s = shortest_s;
            settings.longest_step_s = settings.longest_step_s.max(shortest_s);
        }
        settings = settings.for_ties(row);
        settings.may_halve = self.options.longest_step_s.is_none();
        settings.output_step_s = Some(request.output_step_s);
        settings.friction_coefficient = self.options.friction_coefficient;
        if self.merges_landings {
            settings.with_landings_merged()
        } else {
            settings.with_steps_times(self.steps_times)
        }
    }
}

impl Model for FreeHinges {
    fn repetitions(&self) -> Vec<Repetition> {
        let others = match self.options.friction_coefficient {
            None => [("double steps", 2.0, false), ("landings merged", 1.0, true)],
            Some(_) => [("half steps", 0.5, false), ("double steps", 2.0, false)],
        };
        let repetition = |(name, steps_times, merges_landings)| Repetition {
            name,
            model: Box::new(Self {
                steps_times,
                merges_landings,
                ..self.clone()
            }),
        };
        others.map(repetition).into()
    }

    fn row(&self) -> Option<&Row> {
        Some(self.row())
    }

    fn bodies(&self) -> Vec<String> {
        self.rigid.bodies()
    }

    fn shape(&self) -> Shape {
        let slips = self.options.friction_coefficient.is_some();
        self.rigid.shape(slips, false)
    }

    fn incipient_acceleration_g(&self, sway: Sway) -> Option<f64> {
        self.rigid.incipient_acceleration_g(sway)
    }

    fn simulate(
        &self,
        ground: &GroundMotion,
        request: &Request,
        recorder: Option<&mut dyn Recorder>,
    ) -> Result<Summary, SimulationError> {
        check(ground, request)?;
        let settings = self.settings(request);
        let initial = request.initial.map(|initial| self.rigid.released(initial));
        let task = self.rigid.task(ground, request.gravity_m_s2, settings);
        let initial_rad = initial.transpose()?;
        let standing = &self.rigid.standing;
        let summary = motion(task, standing, initial_rad.as_deref(), recorder)?;
        let halvings = summary.row().map_or(0, |row| row.halvings);
        let step_s = SHORTER * (settings.longest_step_s * 0.5_f64.powf(halvings.into()));
        Ok(balanced(summary, "free_hinges", step_s)?)
    }
}
