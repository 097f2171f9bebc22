//! How a history ended, as studies keep it.

use serde::{Deserialize, Serialize};

use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::{Outcome, Summary};
use crate::dynamics::model::{Model, Request};

/// How a history ended, in the numbers that studies compare. They are finite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ending {
    /// How it ended.
    pub outcome: Outcome,
    /// When, in seconds.
    pub outcome_time_s: f64,
    /// Number of impacts; where the structure overturns, all are before.
    pub impacts: usize,
    /// Largest rotation over that at the unstable equilibrium, where that is known.
    pub peak_over_critical: Option<f64>,
    /// Largest gap in the energy balance, over the energy barrier.
    pub energy_defect_ratio: f64,
    /// Largest rotation of any block, in radians; with free hinges only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_rotation_rad: Option<f64>,
}

impl Ending {
    /// Number of impacts at which all hinges close at once; `None` of free hinges, which land one by one.
    #[must_use]
    pub const fn impacts_of_all_hinges(&self) -> Option<usize> {
        match self.peak_rotation_rad {
            Some(_) => None,
            None => Some(self.impacts),
        }
    }

    /// Simulates a structure from rest and returns how that ended.
    ///
    /// # Errors
    /// Says why there is no history, or none that could be kept.
    pub fn of(model: &dyn Model, ground: &GroundMotion, request: &Request) -> Result<Self, String> {
        let summary = model
            .simulate(ground, request, None)
            .map_err(|error| error.to_string())?;
        Self::from_summary(&summary)
    }

    /// What a history came to.
    ///
    /// # Errors
    /// Says that a number is not finite.
    pub(super) fn from_summary(summary: &Summary) -> Result<Self, String> {
        let ending = Self {
            outcome: summary.outcome,
            outcome_time_s: summary.outcome_time_s,
            impacts: summary.impacts,
            peak_over_critical: summary.peak_over_critical,
            energy_defect_ratio: summary.energy_defect_ratio,
            peak_rotation_rad: summary.free_hinges.is_some().then(|| {
                summary
                    .peak_rotations_rad
                    .iter()
                    .copied()
                    .fold(0.0, f64::max)
            }),
        };
        check_finite(&[ending.outcome_time_s, ending.energy_defect_ratio])?;
        check_finite(ending.peak_over_critical.as_slice())?;
        check_finite(ending.peak_rotation_rad.as_slice())?;
        Ok(ending)
    }
}

/// Refuses what is not finite, which is a defect of the program.
pub(super) fn check_finite(values: &[f64]) -> Result<(), String> {
    if values.iter().all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err("a result is not a finite number: please report the scenario".to_owned())
    }
}
