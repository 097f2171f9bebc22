//! The scales that make a history dimensionless, as papers plot it.

use crate::dynamics::model::MechanismModel;
use crate::mechanics::sway::Sway;

/// The scales that make a history dimensionless, as papers plot it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// `p` of the equivalent block at the unstable equilibrium (see
    /// [`crate::mechanics::equivalent`]); for a column, its own `p`.
    pub frequency_rad_s: f64,
    /// `g A_L`, the acceleration that starts the structure.
    pub incipient_m_s2: f64,
}

impl Scales {
    /// The scales of a model under gravity; `None` if it has no unstable equilibrium.
    #[must_use]
    pub fn new(model: &dyn MechanismModel, gravity_m_s2: f64) -> Option<Self> {
        Some(Self {
            frequency_rad_s: model.equivalent(gravity_m_s2)?.at_critical?.frequency_rad_s,
            incipient_m_s2: model.incipient_acceleration_g(Sway::Right)? * gravity_m_s2,
        })
    }
}
