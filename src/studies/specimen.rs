//! What a study shakes: an arch or a column, and how it ends.

use std::ops::ControlFlow;

use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::{History, Outcome, Request, history};
use crate::dynamics::hybrid::engine::EngineError;
use crate::dynamics::hybrid::rocking::Rocking;
use crate::mechanics::arch::Arch;
use crate::mechanics::column::Column;
use crate::mechanics::equivalent::{Equivalent, equivalent};
use crate::mechanics::four_link::mechanism::Sway;
use crate::mechanics::structure::Structure;

use super::impact_free;

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
            end_s: self.end_s,
            relative_tolerance: self.relative_tolerance,
            initial: None,
            output_step_s: None,
        }
    }

    fn rocking<'a, S: Structure>(
        &self,
        structure: &'a S,
        ground: &'a GroundMotion,
    ) -> Rocking<'a, S> {
        Rocking::new(structure, ground, self.gravity_m_s2, self.rest_energy_ratio)
    }
}

/// How a history ended, in the numbers that studies compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// How it ended.
    pub outcome: Outcome,
    /// When that was decided, in seconds: see [`History::outcome_time_s`].
    pub outcome_time_s: f64,
    /// Number of impacts; where the structure overturns, all are before.
    pub impacts: usize,
    /// Largest rotation over that at the unstable equilibrium.
    pub peak_over_critical: f64,
    /// Largest gap in the energy balance, over the energy barrier.
    pub energy_defect_ratio: f64,
}

impl<S: Structure> From<&History<'_, S>> for Verdict {
    fn from(history: &History<'_, S>) -> Self {
        Self {
            outcome: history.outcome,
            outcome_time_s: history.outcome_time_s,
            impacts: history.impacts.len(),
            peak_over_critical: history.peak_over_critical,
            energy_defect_ratio: history.energy_defect_ratio,
        }
    }
}

/// A structure of either kind, ready to rock.
#[derive(Clone, Debug)]
pub enum Specimen {
    /// A circular arch.
    Arch(Arch),
    /// A free-standing column.
    Column(Column),
}

/// Does with the structure inside what can be done with any.
macro_rules! each {
    ($specimen:expr, $structure:ident => $do:expr) => {
        match $specimen {
            Specimen::Arch($structure) => $do,
            Specimen::Column($structure) => $do,
        }
    };
}

impl Specimen {
    /// Horizontal acceleration at which it starts to rock, in units of gravity.
    #[must_use]
    pub fn incipient_g(&self) -> f64 {
        each!(self, structure => structure.incipient_g())
    }

    /// The free-standing blocks that rock like it.
    #[must_use]
    pub fn equivalent(&self, gravity_m_s2: f64) -> Option<Equivalent> {
        each!(self, structure => equivalent(structure, gravity_m_s2))
    }

    /// Its history on moving ground, from rest to its outcome.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn verdict(
        &self,
        ground: &GroundMotion,
        conditions: &Conditions,
    ) -> Result<Verdict, EngineError> {
        each!(self, structure => {
            let rocking = conditions.rocking(structure, ground);
            let history = history(&rocking, &conditions.request(), |_| ControlFlow::Continue(()))?;
            Ok(Verdict::from(&history))
        })
    }

    /// The side to which moving ground overturns it from rest before its first impact; `None` if it does not.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn overturns_without_impact(
        &self,
        ground: &GroundMotion,
        conditions: &Conditions,
    ) -> Result<Option<Sway>, EngineError> {
        each!(self, structure => {
            let rocking = conditions.rocking(structure, ground);
            impact_free::overturns(&rocking, conditions.relative_tolerance)
        })
    }
}
