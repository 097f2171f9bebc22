//! Row of blocks with free hinges as a model of motion.

use std::ops::RangeInclusive;

use serde::Serialize;

use super::motion::motion;
use super::settings::{MANY_CASES_STEP_RATIO, MANY_SLIDING_CASES_STEP_RATIO};
use crate::argument::{ArgumentError, require, require_within};
use crate::dynamics::model::{Recorder, check};
use crate::dynamics::row::observer::require_balance;
use crate::dynamics::row::standing::RigidRow;
use crate::dynamics::{
    GroundMotion, Model, Repetition, Request, RowModelError, Settings, SimulationError, Summary,
};
use crate::mechanics::{Arch, Column, Movements, Row, Sway};

/// Row of rigid blocks, as an arch or a stack, whose joints open about either edge and close again at any time.
///
/// Joints carry no tension and do not slide, unless a friction coefficient is given. Impacts are perfectly inelastic. Hinges and restitution are
/// results, not input.
#[derive(Clone, Debug)]
pub struct FreeHinges {
    rigid: RigidRow,
    options: RowOptions,
    /// True in a study of many cases, with longer default steps.
    many_cases: bool,
    /// Factor on the step lengths, for a repetition.
    steps_times: f64,
    /// True if landings shortly after an impact are merged, for a repetition.
    merges_landings: bool,
    /// True if the first repetition is mirrored.
    repeats_mirrored: bool,
}

/// Options of the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RowOptions {
    /// Longest step, in seconds (1e-9 to 1); `None` selects it by the size of the row.
    pub longest_step_s: Option<f64>,
    /// Shortest step, in seconds: landings within this time are merged if impacts are too frequent. `None` selects a thirtieth of the longest step.
    pub shortest_step_s: Option<f64>,
    /// Coulomb's coefficient of friction at all joints, from 0.001 to 1000; `None` prevents slip.
    pub friction_coefficient: Option<f64>,
}

impl RowOptions {
    /// Range of step lengths in seconds. Shorter steps need too much time; longer ones are not accurate.
    pub const STEP_S: RangeInclusive<f64> = 1e-9..=1.0;
    /// Range of friction coefficients; stone joints have 0.5 to 0.8. Above the range nothing slips, below it nothing is stable.
    pub const FRICTION_COEFFICIENT: RangeInclusive<f64> = 1e-3..=1e3;

    /// Checks the options.
    ///
    /// # Errors
    /// If a step or the coefficient is out of range, or if the steps contradict each other.
    pub fn checked(self) -> Result<Self, ArgumentError> {
        let friction = self.friction_coefficient;
        for (argument, value, range) in [
            ("longest_step_s", self.longest_step_s, Self::STEP_S),
            ("shortest_step_s", self.shortest_step_s, Self::STEP_S),
            ("friction_coefficient", friction, Self::FRICTION_COEFFICIENT),
        ] {
            if let Some(value) = value {
                require_within(argument, value, range)?;
            }
        }
        if let Some(shortest_s) = self.shortest_step_s {
            let allowed = "left out where joints slip: then all steps are the longest";
            require(friction.is_none(), "shortest_step_s", shortest_s, allowed)?;
            let longest_s = self.longest_step_s.unwrap_or(f64::INFINITY);
            let allowed = format_args!("at least the shortest step, {shortest_s:?}");
            let fits = longest_s >= shortest_s;
            require(fits, "longest_step_s", longest_s, allowed)?;
        }
        Ok(self)
    }
}

/// Names of the repetitions without friction, their steps over those of the motion, and whether they merge landings.
const OTHER_SETTINGS: [(&str, f64, bool); 6] = [
    ("double steps", 2.0, false),
    ("landings merged", 1.0, true),
    ("half steps", 0.5, false),
    ("quarter steps", 0.25, false),
    ("steps times 0.7", 0.7, false),
    ("steps times 1.4", 1.4, false),
];
/// Names of the repetitions with friction, and their steps over those of the motion.
const OTHER_STEPS: [(&str, f64); 6] = [
    ("half steps", 0.5),
    ("double steps", 2.0),
    ("quarter steps", 0.25),
    ("steps times 0.35", 0.35),
    ("steps times 0.7", 0.7),
    ("steps times 1.4", 1.4),
];
/// Step length proposed after an error of the energy balance, over the longest step.
const SHORTER: f64 = 0.2;
/// Largest number of default steps of a row with ties, times the number of joints and ties: some minutes of computing.
const MOST_TIE_WORK: f64 = 5e8;
/// Error of the energy balance, relative to the largest energy of the motion, above which it is reported.
pub const DOUBTFUL_ENERGY_ERROR: f64 = 1e-3;

impl FreeHinges {
    /// Model of a stable row.
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
            repeats_mirrored: false,
        })
    }

    /// Model of an arch of voussoirs.
    ///
    /// # Errors
    /// When the arch has no voussoirs, or cannot carry its own weight.
    pub fn of_arch(arch: &Arch) -> Result<Self, RowModelError> {
        Self::new(arch.row()?)
    }

    /// Model of a column of drums.
    ///
    /// # Errors
    /// When the drums do not make a row, or the column cannot carry its own weight.
    pub fn of_column(column: &Column) -> Result<Self, RowModelError> {
        Self::new(column.row()?)
    }

    /// This model on supports that moved slowly before time zero. The motion starts on the hinges that this movement opened; displacements
    /// and rotations are relative to that position.
    ///
    /// # Errors
    /// If the row falls, a tie breaks or a joint slides during the movement.
    pub fn on_supports(self, movements: &Movements) -> Result<Self, RowModelError> {
        if movements.is_none() {
            return Ok(self);
        }
        let rigid = self
            .rigid
            .on_supports(movements)?
            .with_friction(self.options.friction_coefficient)?;
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

    /// Coulomb's coefficient of friction; `None` if joints do not slip.
    pub const fn friction_coefficient(&self) -> Option<f64> {
        self.options.friction_coefficient
    }

    /// Row of blocks.
    pub const fn row(&self) -> &Row {
        &self.rigid.row
    }

    /// Energy in J that the first mechanism needs to overturn, to the weaker side; `None` if unknown.
    pub fn barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        self.rigid.barrier_j(gravity_m_s2)
    }

    /// Longest step of a history, in seconds.
    pub fn longest_step_s(&self, request: &Request) -> f64 {
        self.settings(request).longest_step_s
    }

    /// Numerical settings of a motion.
    fn settings(&self, request: &Request) -> Settings {
        let (row, gravity_m_s2, end_s) = (self.row(), request.gravity_m_s2, request.end_s);
        let of = |(settings, many_cases_ratio): (Settings, f64)| match self.many_cases {
            true => settings.times(many_cases_ratio),
            false => settings,
        };
        let mut settings = of(match self.options.friction_coefficient {
            None => (
                Settings::to_landings(row, gravity_m_s2, end_s),
                MANY_CASES_STEP_RATIO,
            ),
            Some(_) => (
                Settings::equal(row, gravity_m_s2, end_s),
                MANY_SLIDING_CASES_STEP_RATIO,
            ),
        });
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
        settings.outcome_by_s = request.outcome_by_s;
        settings.friction_coefficient = self.options.friction_coefficient;
        if self.many_cases {
            settings.merged_after = 0;
        }
        if self.merges_landings {
            settings = settings.with_landings_merged();
        }
        settings.with_steps_times(self.steps_times)
    }
}

impl Model for FreeHinges {
    fn repetitions(&self) -> Vec<Repetition> {
        let others = match self.options.friction_coefficient {
            None => OTHER_SETTINGS,
            Some(_) => OTHER_STEPS.map(|(name, steps_times)| (name, steps_times, false)),
        };
        let repetition = |(name, steps_times, merges_landings)| Repetition {
            name,
            model: Box::new(Self {
                steps_times,
                merges_landings,
                ..self.clone()
            }),
        };
        Repetition::first_mirrored(others.map(repetition).into(), self)
    }

    fn covers_mirrored(&self) -> bool {
        self.repeats_mirrored
    }

    fn repeat_mirrored(&mut self) {
        self.repeats_mirrored = self.rigid.is_symmetric();
    }

    fn row(&self) -> Option<&Row> {
        Some(self.row())
    }

    fn bodies(&self) -> Vec<String> {
        self.rigid.bodies()
    }

    fn for_many_cases(&self) -> Option<Box<dyn Model>> {
        self.options.longest_step_s.is_none().then(|| {
            Box::new(Self {
                many_cases: true,
                ..self.clone()
            }) as _
        })
    }

    fn slips(&self) -> bool {
        self.options.friction_coefficient.is_some()
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
        if self.options.longest_step_s.is_none() && !self.row().bars().is_empty() {
            let step_s = settings.longest_step_s;
            let remedy = format!(
                "the ties are too stiff; give them a smaller stiffness_n_m, combine ties that are close to each other, or give \
                 longest_step_s = {step_s:.1e} in [free_hinges] to compute the motion nevertheless"
            );
            let parts = self.row().ties.len() + self.row().joints.len();
            settings.within(MOST_TIE_WORK / parts as f64, &remedy)?;
        }
        let release = request.initial.map(|initial| self.rigid.release(initial));
        let input = self.rigid.input(ground, request.gravity_m_s2, settings);
        let release = release.transpose()?;
        let standing = &self.rigid.standing;
        let summary = motion(input, standing, release.as_ref(), recorder)?;
        let halvings = summary.row().map_or(0, |row| row.halvings);
        let step_s = SHORTER * (settings.longest_step_s * libm::pow(0.5, halvings.into()));
        Ok(require_balance(summary, "free_hinges", step_s)?)
    }
}
