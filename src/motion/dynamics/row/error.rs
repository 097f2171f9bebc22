//! Errors of models and motions of rows of blocks.

use thiserror::Error;

use crate::argument::ArgumentError;
use crate::mechanics::elastic_joint::RestError;
use crate::mechanics::{FrictionError, RowError, SettlingError, StabilityError};

/// Reason why a row of blocks has no model of motion.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RowModelError {
    /// There are no blocks, or they do not make a row.
    #[error(transparent)]
    Row(#[from] RowError),
    /// The row is not stable with rigid joints, or its stability was not determined.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// An argument is not allowed.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// The row slides apart under its own weight.
    #[error(transparent)]
    Friction(#[from] FrictionError),
    /// The row has no equilibrium on its elastic joints.
    #[error(transparent)]
    Rest(#[from] RestError),
    /// The row falls at this fraction of the movement of its supports.
    #[error("with rigid joints the structure falls when its supports have moved {:.2} % of the way", 1e2 * .0)]
    Falls(f64),
    /// The tie with this index breaks during the movement of the supports.
    #[error("with rigid joints tie {} breaks before its supports have moved all of the way", .0 + 1)]
    TieBreaks(usize),
    /// No equilibrium was found during the movement of the supports.
    #[error(transparent)]
    Settling(#[from] SettlingError),
    /// No damping gives the rebound.
    #[error("the rebound ratio {0}")]
    Rebound(#[from] ReboundError),
}

/// Reason why no damping gives a rebound.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ReboundError {
    /// The structure is not a column of one block.
    #[error(
        "is the rebound of one block, a [column] without drums, taper and ties, or a [body]: impacts of several blocks have no common ratio; give \
         `damping_time_s`"
    )]
    SeveralBlocks,
    /// The block slides before it rocks: it needs this coefficient of friction.
    #[error(
        "needs a `friction_coefficient` above {0:.3}: with less the block slides before it rocks"
    )]
    Slides(f64),
    /// The nearest damping gives ratios from the first to the second, in impacts from both sides and with different rates.
    #[error(
        "does not hold for all impacts: with the nearest damping the ratio is from {0:.3} to {1:.3}, by the rate and the side of the impact; give another \
         ratio or contact, or `damping_time_s`"
    )]
    Varies(f64, f64),
    /// Damping gives ratios from the first to the second.
    #[error(
        "cannot be reached by damping: with this stiffness, contact and friction the ratio is from {0:.3} to {1:.3}; two contact points lose most, and \
         continuous contact least"
    )]
    OutOfReach(f64, f64),
}

/// Reason why a motion of a row of blocks was not computed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RowMotionError {
    /// The error of the energy balance is too large.
    #[error(
        "the energy balance is wrong by {:.2} % of the largest energy of the motion, so its result is not usable: set \
         `longest_step_s` in [{table}] to at most {longest_step_s:.1e} s",
        1e2 * .error
    )]
    Energy {
        /// Error of the energy, over the larger value of the barrier and the largest kinetic energy.
        error: f64,
        /// Name of the model's table in a scenario.
        table: &'static str,
        /// Sufficiently short step, in seconds.
        longest_step_s: f64,
    },
    /// The row has no equilibrium on its elastic joints under this gravity.
    #[error(transparent)]
    Rest(#[from] RestError),
    /// The motion cannot begin, or a step failed; the message gives the reason and a remedy.
    #[error("{0}")]
    Failed(String),
}
