//! Why a row of blocks has no model, or no motion.

use thiserror::Error;

use crate::argument::ArgumentError;
use crate::mechanics::blocks::RowError;
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
    /// The row does not rest on its elastic joints under this gravity.
    #[error(transparent)]
    Rest(#[from] RestError),
    /// The motion cannot begin, or a step failed: why, with a remedy.
    #[error("{0}")]
    Failed(String),
}
