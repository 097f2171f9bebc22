//! Motion of a row of rigid blocks whose joints open and shut anywhere, at any time.
//!
//! The driver of rows moves the blocks by a stepper: `landing`, whose steps end where corners land, or `sliding`, in whose equal steps
//! joints may slip too.

mod landing;
mod model;
mod rest;
mod right_support;
mod sliding;
mod ties;

use thiserror::Error;

pub use model::{DOUBTFUL_ENERGY_ERROR, FreeHinges, FreeHingesError, RowOptions};

use self::landing::LandingStepper;
use super::ground::GroundMotion;
use super::history::Summary;
use super::model::{Recorder, SimulationError};
use super::row::course::{self, Clock, Task};
use super::row::standing::estimated_barrier_j;
use crate::mechanics::blocks::Row;
use crate::mechanics::contact::ContactError;
use crate::mechanics::stance::Stance;
use crate::mechanics::tie::square_frequency;

/// The shortest step over the longest one, where it is not given.
const SHORTEST_STEP_RATIO: f64 = 1.0 / 30.0;
/// How much longer the steps of studies of many cases are than those of a run. Of the second peaks of 73 random arches 8 then differ
/// by more than 1 % from those with the shortest steps, and 5 with the steps of a run.
const MANY_CASES_STEP_RATIO: f64 = 1.1 / 0.34;
/// Impacts within the shortest step after which the next landings are merged: an endless series would stop time.
const CROWDED_IMPACTS: usize = 50;
/// The time after an impact in which a repetition merges landings, over the shortest step.
const MERGED_RATIO: f64 = 4.0;
/// Steps over the longest ones with which a block between ties would be stable. Joints make of blocks heavier bodies, whose steps might be
/// longer.
const TIE_STEP_RATIO: f64 = 0.2;
/// The most steps that a motion may have: a month of computing. Much shorter ones are lost in the rounding of the time.
const MOST_STEPS: f64 = 1e12;

/// How a motion is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Longest step in seconds.
    pub longest_step_s: f64,
    /// Whether steps may be halved where the energy balance needs it.
    pub may_halve: bool,
    /// Landings that crowd within this time, in seconds, are taken as one.
    pub shortest_step_s: f64,
    /// Number of impacts within the shortest step after which landings crowd.
    pub merged_after: usize,
    /// When to stop at the latest, in seconds.
    pub end_s: f64,
    /// Time between samples in seconds; if `None`, there are none. Steps end there whether or not samples are wanted.
    pub output_step_s: Option<f64>,
    /// Coulomb's coefficient of friction at every joint; if `None`, joints do not slip.
    pub friction_coefficient: Option<f64>,
}

impl Settings {
    /// Steps that end at landings: at most about 0.35 ms for a size of 10 m. For other sizes they follow the square root of size
    /// over gravity. The shortest step is a thirtieth of the longest.
    #[must_use]
    pub fn to_landings(row: &Row, gravity_m_s2: f64, end_s: f64) -> Self {
        let longest_step_s = 3.4e-4 * (row.size_m() / gravity_m_s2).sqrt();
        Self {
            longest_step_s,
            may_halve: false,
            shortest_step_s: SHORTEST_STEP_RATIO * longest_step_s,
            merged_after: CROWDED_IMPACTS,
            end_s,
            output_step_s: None,
            friction_coefficient: None,
        }
    }

    /// Equal steps, for joints that slip: 0.1 ms for a size of 10 m.
    #[must_use]
    pub fn equal(row: &Row, gravity_m_s2: f64, end_s: f64) -> Self {
        let step_s = 1e-4 * (row.size_m() / gravity_m_s2).sqrt();
        Self {
            longest_step_s: step_s,
            shortest_step_s: step_s,
            ..Self::to_landings(row, gravity_m_s2, end_s)
        }
    }

    /// The same with steps that are short beside the vibration of blocks on the ties of the row.
    fn for_ties(self, row: &Row) -> Self {
        let square = square_frequency(row.ties(), row.blocks());
        if square == 0.0 {
            return self;
        }
        let longest_s = TIE_STEP_RATIO * 2.0 / square.sqrt();
        self.times((longest_s / self.longest_step_s).min(1.0))
    }

    /// The same with all steps multiplied.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            longest_step_s: self.longest_step_s * factor,
            shortest_step_s: self.shortest_step_s * factor,
            ..*self
        }
    }

    const fn clock(&self) -> Clock {
        Clock {
            longest_step_s: self.longest_step_s,
            may_halve: self.may_halve,
            shortest_step_s: self.shortest_step_s,
            end_s: self.end_s,
            output_step_s: self.output_step_s,
        }
    }

    /// The same with the steps that it takes multiplied. Steps also end at output times: where these limit them, the output step
    /// is multiplied as well.
    fn with_steps_times(&self, factor: f64) -> Self {
        let limits = |step_s: f64| step_s < 2.0 * self.longest_step_s;
        let times = |step_s| {
            if limits(step_s) {
                factor * step_s
            } else {
                step_s
            }
        };
        Self {
            output_step_s: self.output_step_s.map(times),
            ..self.times(factor)
        }
    }

    /// The same with steps half as long.
    fn with_half_steps(&self) -> Self {
        self.with_steps_times(0.5)
    }

    /// The same with steps twice as long.
    fn with_double_steps(&self) -> Self {
        self.with_steps_times(2.0)
    }

    /// The same with the landings that follow an impact within four shortest steps merged with each other. Real impacts take time:
    /// nobody knows in which order landings follow within it.
    fn with_landings_merged(&self) -> Self {
        Self {
            shortest_step_s: (MERGED_RATIO * self.shortest_step_s).min(self.longest_step_s),
            merged_after: 0,
            ..*self
        }
    }
}

/// Why a motion could not be computed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FreeHingeError {
    /// A setting is out of range.
    #[error("{name} is {value}: {allowed}")]
    Setting {
        /// Which one, with its unit.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// The initial rotations are not one finite number per block.
    #[error("initial rotations: {given} finite numbers for {blocks} blocks")]
    Rotations {
        /// How many were given that are finite.
        given: usize,
        /// How many blocks there are.
        blocks: usize,
    },
    /// The initial rotations do not close an arch.
    #[error(
        "with the initial rotations the ends of the arch miss each other by {error_m:.3e} m: give rotations of the blocks \
         with which it stays closed; a smaller `rotation_rad` in [initial] may do"
    )]
    Open {
        /// By how much.
        error_m: f64,
    },
    /// The velocities of a step were not found.
    #[error("at {time_s} s {reason}, or give another `longest_step_s` in [free_hinges]")]
    Contact {
        /// When, in seconds.
        time_s: f64,
        /// Why.
        reason: ContactError,
    },
    /// Friction was not found.
    #[error(
        "at {time_s} s the bound of friction at a joint is wrong by {error:.1e} of the largest one: give another \
         longest_step_s in [free_hinges], or a friction_coefficient farther from the least one with which the row stands"
    )]
    Friction {
        /// When, in seconds.
        time_s: f64,
        /// By how much.
        error: f64,
    },
    /// Energy was created or lost.
    #[error(
        "the energy balance is wrong by {:.2} % of the largest energy of the motion, so its result is not usable: set \
         `longest_step_s` in [free_hinges] to at most {:.1e} s",
        1e2 * .error, 0.2 * .longest_step_s
    )]
    Energy {
        /// Its error, over the larger of the barrier and the largest kinetic energy.
        error: f64,
        /// The longest step at the end, in seconds.
        longest_step_s: f64,
    },
    /// The ends of an arch parted in the computation.
    #[error(
        "at {time_s} s the ends of the arch miss each other by {error_m:.3e} m: give a shorter `longest_step_s` in \
         [free_hinges]"
    )]
    Closure {
        /// When, in seconds.
        time_s: f64,
        /// By how much.
        error_m: f64,
    },
}

impl From<FreeHingeError> for SimulationError {
    fn from(error: FreeHingeError) -> Self {
        Self::computation(error)
    }
}

/// Computes the motion of a row on moving ground, from rest or released from given rotations of its blocks
/// (radians; hinges only).
///
/// # Errors
/// When a setting is out of range, the initial rotations do not fit, or a step fails.
pub fn simulate(
    row: &Row,
    ground: &GroundMotion,
    gravity_m_s2: f64,
    settings: &Settings,
    initial_rad: Option<&[f64]>,
    recorder: Option<&mut dyn Recorder>,
) -> Result<Summary, FreeHingeError> {
    let task = Task {
        row,
        ground,
        gravity_m_s2,
        clock: settings.clock(),
        barrier_j: None,
        built_barrier_j: estimated_barrier_j(row, gravity_m_s2),
        energy_scale_j: 0.0,
    };
    motion(
        task,
        settings,
        &Stance::undeformed(row),
        initial_rad,
        recorder,
    )
}

/// The same for any task and a row that stands anywhere.
fn motion(
    task: Task<'_>,
    settings: &Settings,
    standing: &Stance,
    initial_rad: Option<&[f64]>,
    recorder: Option<&mut dyn Recorder>,
) -> Result<Summary, FreeHingeError> {
    // A recorder of any lifetime serves for as long as the task.
    let recorder = recorder.map(|recorder| recorder as _);
    check(task.gravity_m_s2, settings)?;
    let Some(coefficient) = settings.friction_coefficient else {
        return course::run(LandingStepper::released(
            task,
            settings,
            standing,
            initial_rad,
            recorder,
        )?);
    };
    let placement = match initial_rad {
        Some(_) => {
            LandingStepper::released(task, settings, standing, initial_rad, None)?.into_placement()
        }
        None => standing.placement.clone(),
    };
    course::run(sliding::SlidingStepper::new(
        standing,
        &placement,
        task,
        settings,
        coefficient,
        recorder,
    ))
}

fn check(gravity_m_s2: f64, settings: &Settings) -> Result<(), FreeHingeError> {
    let output_step_s = settings.output_step_s.unwrap_or(1.0);
    for (name, value) in [
        ("gravity in m/s2", gravity_m_s2),
        ("longest step in s", settings.longest_step_s),
        ("shortest step in s", settings.shortest_step_s),
        ("end in s", settings.end_s),
        ("output step in s", output_step_s),
        (
            "coefficient of friction",
            settings.friction_coefficient.unwrap_or(1.0),
        ),
    ] {
        if !(value > 0.0 && value < f64::INFINITY) {
            let allowed = "it must be positive and finite";
            return Err(FreeHingeError::Setting {
                name,
                value,
                allowed,
            });
        }
    }
    let refused = |name, value, allowed| {
        Err(FreeHingeError::Setting {
            name,
            value,
            allowed,
        })
    };
    if settings.shortest_step_s > settings.longest_step_s {
        let allowed = "it must not exceed the longest step";
        return refused("shortest step in s", settings.shortest_step_s, allowed);
    }
    for (name, step_s) in [
        ("longest step in s", settings.longest_step_s),
        ("output step in s", output_step_s),
    ] {
        if settings.end_s / step_s > MOST_STEPS {
            let allowed = "a motion of more than 1e12 such steps would never end";
            return refused(name, step_s, allowed);
        }
    }
    Ok(())
}
