//! What a study shakes: an arch or a column, and how it ends.

use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::{Outcome, Summary};
use crate::dynamics::model::{MechanismModel, Request, SimulationError};
use crate::mechanics::column::RockingColumn;
use crate::mechanics::equivalent::Equivalent;
use crate::mechanics::four_link::arch::FourLinkArch;
use crate::mechanics::four_link::mechanism::Sway;

/// How all histories of a study are computed: from rest, without samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Acceleration of gravity.
    pub gravity_m_s2: f64,
    /// Upper bound of the time of a history, in seconds.
    pub end_s: f64,
    /// Relative tolerance of the integration.
    pub relative_tolerance: f64,
    /// An impact that leaves less than this part of the energy barrier ends in rest.
    pub rest_energy_ratio: f64,
}

impl Conditions {
    /// What is asked of a history.
    #[must_use]
    pub const fn request(&self) -> Request {
        Request {
            gravity_m_s2: self.gravity_m_s2,
            end_s: self.end_s,
            output_step_s: self.end_s,
            initial: None,
            relative_tolerance: self.relative_tolerance,
            rest_energy_ratio: self.rest_energy_ratio,
        }
    }
}

/// How a history ended, in the numbers that studies compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// How it ended.
    pub outcome: Outcome,
    /// When that was decided, in seconds: see [`Summary::outcome_time_s`].
    pub outcome_time_s: f64,
    /// Number of impacts; where the structure overturns, all are before.
    pub impacts: usize,
    /// Largest rotation over that at the unstable equilibrium.
    pub peak_over_critical: f64,
    /// Largest gap in the energy balance, over the energy barrier.
    pub energy_defect_ratio: f64,
}

impl From<Summary> for Verdict {
    fn from(history: Summary) -> Self {
        Self {
            outcome: history.outcome,
            outcome_time_s: history.outcome_time_s,
            impacts: history.impacts,
            peak_over_critical: history.peak_over_critical,
            energy_defect_ratio: history.energy_defect_ratio,
        }
    }
}

/// A structure of either kind, ready to rock.
#[derive(Clone, Debug)]
pub enum Specimen {
    /// A circular arch.
    Arch(FourLinkArch),
    /// A free-standing column.
    Column(RockingColumn),
}

impl Specimen {
    /// The model of its motion.
    #[must_use]
    pub fn model(&self) -> &dyn MechanismModel {
        match self {
            Self::Arch(arch) => arch,
            Self::Column(column) => column,
        }
    }

    /// Horizontal acceleration at which it starts to rock, in units of gravity.
    #[must_use]
    pub fn incipient_g(&self) -> f64 {
        let model = self.model();
        model
            .incipient_acceleration_g(Sway::Right)
            .unwrap_or(f64::INFINITY)
    }

    /// The free-standing blocks that rock like it.
    #[must_use]
    pub fn equivalent(&self, gravity_m_s2: f64) -> Option<Equivalent> {
        self.model().equivalent(gravity_m_s2)
    }

    /// Its history on moving ground, from rest to its outcome.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn verdict(
        &self,
        ground: &GroundMotion,
        conditions: &Conditions,
    ) -> Result<Verdict, SimulationError> {
        let summary = self.model().simulate(ground, &conditions.request(), None)?;
        Ok(summary.into())
    }

    /// The side to which moving ground overturns it from rest before its first impact; `None` if it does not.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn overturns_without_impact(
        &self,
        ground: &GroundMotion,
        conditions: &Conditions,
    ) -> Result<Option<Sway>, SimulationError> {
        self.model()
            .overturns_without_impact(ground, &conditions.request())
    }
}
