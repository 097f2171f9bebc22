//! Reasons why a study has no results.

use std::fmt;

use thiserror::Error;

use super::part::PartError;
use super::runner::RunnerError;
use crate::SimulationError;
use crate::output::{OutputError, PrintError};
use crate::scenario::ScenarioErrors;

/// Errors of studies.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The scenario or an option does not fit the study.
    #[error("{0}")]
    Scenario(String),
    /// The computation failed.
    #[error("{0}")]
    Failed(String),
    /// The rows are incomplete.
    #[error(transparent)]
    Runner(#[from] RunnerError),
    /// The parts cannot be joined.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The scenario in the parts cannot be read.
    #[error(transparent)]
    Read(#[from] ScenarioErrors),
    /// A result is not a number.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A film cannot be made.
    #[error(transparent)]
    Film(#[from] PrintError),
}

impl StudyError {
    /// Returns the error for a scenario that does not fit the study.
    pub(super) fn scenario(reason: impl fmt::Display) -> Self {
        Self::Scenario(reason.to_string())
    }

    /// Returns the error for a failed computation.
    pub(super) fn failed(reason: impl fmt::Display) -> Self {
        Self::Failed(reason.to_string())
    }
}

impl From<SimulationError> for StudyError {
    fn from(error: SimulationError) -> Self {
        match error {
            SimulationError::Row(_) | SimulationError::Computation(_) => Self::failed(error),
            _ => Self::scenario(error),
        }
    }
}
