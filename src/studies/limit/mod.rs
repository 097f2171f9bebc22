//! Limit analysis of a scenario: the ground acceleration that starts the structure, and its mechanism.

mod settled;
mod told;

use thiserror::Error;

pub use self::told::{mechanism_json, row_json};
use super::results::Answer;
use crate::dynamics::free_hinges::FreeHingesError;
use crate::mechanics::four_links::FourLinkError;
use crate::mechanics::friction::FrictionError;
use crate::mechanics::settling::SettlingError;
use crate::mechanics::stability::StabilityError;
use crate::scenario::{ModelError, Scenario};

/// Why there is no limit analysis.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoLimit {
    /// The structure is not a row of blocks.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The structure does not start as a mechanism of one degree of freedom.
    #[error(transparent)]
    FourLinks(#[from] FourLinkError),
    /// The structure is not a row of blocks whose joints can slip.
    #[error(transparent)]
    FreeHinges(#[from] FreeHingesError),
    /// The structure does not stand.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// It does not follow its supports.
    #[error(transparent)]
    Settling(#[from] SettlingError),
    /// The structure slides apart, or the analysis failed.
    #[error(transparent)]
    Friction(#[from] FrictionError),
}

/// The onset of motion of a scenario's structure, to either side; if joints may slip, also with their coefficient of friction. Of one whose
/// supports have moved: where it then stands, and also the push at which it falls.
///
/// # Errors
/// When the structure does not stand, or the analysis does not apply to it.
pub fn limit(scenario: &Scenario) -> Result<Answer, NoLimit> {
    if let Some(movements) = scenario.motion().supports() {
        let row = scenario.structure().row().map_err(FreeHingesError::from)?;
        return settled::limit(scenario, &row, &movements);
    }
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
