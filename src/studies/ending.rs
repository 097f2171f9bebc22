//! How a history ended, as studies keep it.

use serde::{Deserialize, Serialize};

use super::specimen::{Conditions, Specimen, Verdict};
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::Outcome;

/// How a history ended, in the numbers that studies compare. They are finite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ending {
    /// How it ended.
    pub outcome: Outcome,
    /// When that was decided, in seconds.
    pub outcome_time_s: f64,
    /// Number of impacts; where the structure overturns, all are before.
    pub impacts: usize,
    /// Largest rotation over that at the unstable equilibrium.
    pub peak_over_critical: f64,
    /// Largest gap in the energy balance, over the energy barrier.
    pub energy_defect_ratio: f64,
}

impl Ending {
    /// Shakes a structure and says how that ended.
    ///
    /// # Errors
    /// Says why there is no history, or none that could be kept.
    pub fn of(
        specimen: &Specimen,
        ground: &GroundMotion,
        conditions: &Conditions,
    ) -> Result<Self, String> {
        let Verdict {
            outcome,
            outcome_time_s,
            impacts,
            peak_over_critical,
            energy_defect_ratio,
        } = specimen
            .verdict(ground, conditions)
            .map_err(|error| error.to_string())?;
        check_finite(&[outcome_time_s, peak_over_critical, energy_defect_ratio])?;
        Ok(Self {
            outcome,
            outcome_time_s,
            impacts,
            peak_over_critical,
            energy_defect_ratio,
        })
    }
}

/// Refuses what is not a number. That is a defect of the program.
pub(super) fn check_finite(values: &[f64]) -> Result<(), String> {
    if values.iter().all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err("a result is not a finite number: please report the scenario".to_owned())
    }
}
