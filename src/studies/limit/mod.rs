//! Limit analysis of a scenario: the push that starts it, and how.

mod told;

use thiserror::Error;

pub use self::told::{mechanism_json, row_json};
use super::results::Answer;
use crate::dynamics::free_hinges::FreeHingesError;
use crate::mechanics::four_link::arch::FourLinkError;
use crate::mechanics::friction::FrictionError;
use crate::mechanics::stability::StabilityError;
use crate::scenario::{ModelError, Scenario};

/// Why there is no limit analysis.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoLimit {
    /// It makes no row of blocks.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// It does not start as a mechanism of one degree of freedom.
    #[error(transparent)]
    FourLinks(#[from] FourLinkError),
    /// It makes no row of blocks whose joints slip.
    #[error(transparent)]
    FreeHinges(#[from] FreeHingesError),
    /// It does not stand.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// It slides apart, or that could not be told.
    #[error(transparent)]
    Friction(#[from] FrictionError),
}

/// What starts the structure of a scenario, to either side; with its coefficient of friction as well where joints slip.
///
/// # Errors
/// When the structure does not stand, or is none that the analysis is for.
pub fn limit(scenario: &Scenario) -> Result<Answer, NoLimit> {
    let mut answer = match scenario.row()? {
        Some(row) => told::row(scenario, &row)?,
        None => told::mechanism(scenario)?,
    };
    if let Some(coefficient) = scenario.motion().friction_coefficient() {
        let row = scenario.structure().row().map_err(FreeHingesError::from)?;
        told::add_friction(&mut answer, &row, coefficient)?;
    }
    Ok(answer)
}
