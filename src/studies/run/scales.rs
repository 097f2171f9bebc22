//! Scales that make a history dimensionless, as in papers.

use crate::{MechanismModel, Sway};

/// Scales that make a history dimensionless, as in papers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Frequency parameter `p` of the equivalent block at the unstable equilibrium (see [`Equivalent`](crate::mechanics::Equivalent)); the `p` of a column
    /// itself.
    pub frequency_rad_s: f64,
    /// `g A_L`: the acceleration that starts the structure to the right and to the left; infinite if no push starts it.
    pub incipient_m_s2: [f64; 2],
}

impl Scales {
    /// Computes the scales of a model under gravity; `None` if the model has no unstable equilibrium.
    pub fn new(model: &dyn MechanismModel, gravity_m_s2: f64) -> Option<Self> {
        let incipient_g = |sway| model.incipient_acceleration_g(sway);
        let incipient_m_s2 = [Sway::Right, Sway::Left]
            .map(|sway| incipient_g(sway).map_or(f64::INFINITY, |start_g| start_g * gravity_m_s2));
        Some(Self {
            frequency_rad_s: model
                .equivalent(model.first_side(), gravity_m_s2)?
                .at_critical?
                .frequency_rad_s,
            incipient_m_s2,
        })
    }

    /// Larger ratio of a push, to the right or to the left, to the push that starts the structure to that side.
    pub fn ratio_to_incipient(&self, pushes_m_s2: [f64; 2]) -> f64 {
        let [right, left] = [0, 1].map(|side: usize| pushes_m_s2[side] / self.incipient_m_s2[side]);
        right.max(left)
    }
}
