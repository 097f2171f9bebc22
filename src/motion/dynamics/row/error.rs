//! Why a row of blocks has no model, or no motion.

use thiserror::Error;

use crate::argument::ArgumentError;
use crate::mechanics::blocks::RowError;
use crate::mechanics::contact::ContactError;
use crate::mechanics::elastic_joint::RestError;
use crate::mechanics::friction::FrictionError;
use crate::mechanics::settling::SettlingError;
use crate::mechanics::stability::StabilityError;

/// Why a row of blocks has no model of motion.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RowModelError {
    /// There are no blocks, or they do not make a row.
    #[error(transparent)]
    Row(#[from] RowError),
    /// The row does not stand with rigid joints, or this could not be determined.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// An argument is not allowed.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// The row slides apart under its own weight.
    #[error(transparent)]
    Friction(#[from] FrictionError),
    /// The row does not rest on its elastic joints.
    #[error(transparent)]
    Rest(#[from] RestError),
    /// The row falls when its supports have moved by this part of their way.
    #[error("with rigid joints the structure falls when its supports have moved {:.2} % of the way", 1e2 * .0)]
    Falls(f64),
    /// A tie breaks, of this index, before its supports have moved all of their way.
    #[error("with rigid joints tie {} breaks before its supports have moved all of the way", .0 + 1)]
    TieBreaks(usize),
    /// The row cannot be followed as its supports move.
    #[error(transparent)]
    Settling(#[from] SettlingError),
}

/// Why a motion of a row of blocks could not be computed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RowMotionError {
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
         `longest_step_s` in [{table}] to at most {longest_step_s:.1e} s",
        1e2 * .error
    )]
    Energy {
        /// Its error, over the larger of the barrier and the largest kinetic energy.
        error: f64,
        /// The table of the model in a scenario.
        table: &'static str,
        /// A step that is short enough, in seconds.
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
    /// The row does not rest on its elastic joints under this gravity.
    #[error(transparent)]
    Rest(#[from] RestError),
    /// A step is too long for elastic joints.
    #[error(
        "a step of {step_s:.3e} s is not stable with these joints: the longest one is {longest_s:.3e} s; leave \
         longest_step_s out, or take a smaller stiffness or damping time"
    )]
    Unstable {
        /// The step, in seconds.
        step_s: f64,
        /// The longest one that is stable.
        longest_s: f64,
    },
    /// The steps are too many.
    #[error("a motion of {end_s} s takes {:.1e} steps: {remedy}", .end_s / .step_s)]
    TooLong {
        /// The longest step, in seconds.
        step_s: f64,
        /// The length of the motion, in seconds.
        end_s: f64,
        /// Remedy, as an instruction to the user.
        remedy: &'static str,
    },
    /// Numbers left their range.
    #[error("at {time_s} s the motion has grown beyond all numbers: give a shorter longest_step_s")]
    Lost {
        /// When, in seconds.
        time_s: f64,
    },
}
