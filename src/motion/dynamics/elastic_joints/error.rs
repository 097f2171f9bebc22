//! Why there is no motion with elastic joints.

use thiserror::Error;

use crate::argument::ArgumentError;
use crate::dynamics::model::SimulationError;
use crate::dynamics::row::standing::SettledError;
use crate::mechanics::elastic_joint::RestError;
use crate::mechanics::friction::FrictionError;
use crate::mechanics::stability::StabilityError;

/// Why there is no such model.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ElasticJointsError {
    /// The row does not stand even with rigid joints, or this could not be determined.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// An argument is not allowed.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// It slides apart under its own weight.
    #[error(transparent)]
    Friction(#[from] FrictionError),
    /// It does not rest on its joints.
    #[error(transparent)]
    Rest(#[from] RestError),
    /// It cannot follow its supports with rigid joints.
    #[error(transparent)]
    Settled(#[from] SettledError),
}

/// Why a motion could not be computed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ElasticJointError {
    /// It does not rest on its joints under this gravity.
    #[error(transparent)]
    Rest(#[from] RestError),
    /// A step is too long.
    #[error(
        "a step of {step_s:.3e} s is not stable with these joints: the longest one is {longest_s:.3e} s; leave \
         longest_step_s out, or take a smaller stiffness or damping time"
    )]
    Unstable {
        /// The step asked for, in seconds.
        step_s: f64,
        /// The longest one that is stable.
        longest_s: f64,
    },
    /// The steps are too many.
    #[error(
        "with these joints a motion of {end_s} s takes {:.1e} steps: take a smaller damping time or stiffness, or free hinges, \
         the limit of stiff joints",
        .end_s / .step_s
    )]
    TooLong {
        /// The longest step, in seconds.
        step_s: f64,
        /// The length of the motion, in seconds.
        end_s: f64,
    },
    /// Numbers left their range.
    #[error("at {time_s} s the motion has grown beyond all numbers: give a shorter longest_step_s")]
    Lost {
        /// When, in seconds.
        time_s: f64,
    },
    /// Energy was created or lost.
    #[error(
        "the energy balance is wrong by {:.2} % of the largest energy of the motion, which says nothing then: give a \
         longest_step_s of at most {:.1e} s",
        1e2 * .error, 0.3 * .longest_step_s
    )]
    Energy {
        /// Its error, over the larger of the barrier and the largest kinetic energy.
        error: f64,
        /// The longest step, in seconds.
        longest_step_s: f64,
    },
}

impl From<ElasticJointError> for SimulationError {
    fn from(error: ElasticJointError) -> Self {
        Self::computation(error)
    }
}
