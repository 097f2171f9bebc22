//! The overturning spectrum: `[spectrum]`.
//!
//! ```toml
//! [spectrum]
//! p_t = { from = 0.2, to = 10.0, count = 50, spacing = "logarithmic" }
//! acceleration_over_incipient = { from = 1.0, to = 20.0, count = 400, spacing = "logarithmic" }
//! ```
//!
//! How strong must a pulse be to overturn a structure of a given size? The measure of size is `p t_p`: the frequency
//! parameter `p` of the equivalent block at the unstable equilibrium (see [`crate::mechanics::equivalent`]) times
//! the duration `t_p` of the pulse. Similar structures under pulses of one shape respond alike at the same `p t_p`
//! and the same peak acceleration over `g A_L`. So the structure stays the same, and the duration of the pulse varies
//! with its horizontal amplitude; a vertical amplitude stays the same.

use std::ops::Bound::{Excluded, Included};

use serde::Serialize;

use super::ground::DURATION_S;
use super::sequence::{Sequence, Spacing};
use super::table::{Number, Reading, Rule as _, Table};
use super::{Ground, Structure};
use crate::argument::plain;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::equivalent::{Block, Equivalent};
use crate::mechanics::four_link::impact::ImpactModel;

/// The cases of a spectrum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spectrum {
    /// The sizes `p t_p`.
    pub p_t: Sequence,
    /// Peak accelerations of the pulse over `g A_L`, as magnitudes: the sign of the scenario's own amplitude gives the
    /// side.
    pub acceleration_over_incipient: Sequence,
}

/// Any shorter pulse is a blow, any longer one a constant acceleration.
const P_T: Number = Number(Included(1e-3), Included(1e3));
/// Relative to `g A_L`, in magnitude.
const ACCELERATION_OVER_INCIPIENT: Number = Number(Excluded(0.0), Included(1e6));

impl Default for Spectrum {
    fn default() -> Self {
        let range = |from, to, count| Sequence::Range {
            from,
            to,
            count,
            spacing: Spacing::Logarithmic,
        };
        Self {
            p_t: range(0.2, 10.0, 50),
            acceleration_over_incipient: range(1.0, 20.0, 400),
        }
    }
}

impl Spectrum {
    /// Reads `[spectrum]`, and checks it against those other tables that are valid.
    pub(super) fn read(
        table: &mut Table<'_>,
        structure: Option<&Structure>,
        ground: Option<&Option<Ground>>,
        gravity_m_s2: Reading<f64>,
    ) -> Reading<Self> {
        let default = Self::default();
        let p_t = Sequence::read(table, "p_t", &P_T);
        let accelerations = Sequence::read(
            table,
            "acceleration_over_incipient",
            &ACCELERATION_OVER_INCIPIENT,
        );
        let spectrum = Self {
            p_t: p_t?.unwrap_or(default.p_t),
            acceleration_over_incipient: accelerations?
                .unwrap_or(default.acceleration_over_incipient),
        };
        Ground::check_pulse(table, ground)?;
        let model = structure.and_then(|s| s.model(ImpactModel::MaxRestitution).ok());
        if let (Some(model), Ok(gravity_m_s2)) = (model, gravity_m_s2)
            && let Some((_, block)) = block(&*model, gravity_m_s2)
            && let Some(largest) = spectrum.p_t.values().last()
        {
            let longest_s = largest / block.frequency_rad_s;
            if !DURATION_S.contains(longest_s) {
                let wrong = format!(
                    "makes a pulse of {} s, since p is {} rad/s; the duration must be {}",
                    plain(longest_s),
                    plain(block.frequency_rad_s),
                    DURATION_S.allowed()
                );
                return Err(table.wrong("p_t", wrong));
            }
        }
        Ok(spectrum)
    }
}

/// The equivalent block of a model at the unstable equilibrium, and its slenderness in radians.
pub(crate) fn block(model: &dyn MechanismModel, gravity_m_s2: f64) -> Option<(f64, Block)> {
    let Equivalent {
        slenderness_rad,
        at_critical,
        ..
    } = model.equivalent(gravity_m_s2)?;
    Some((slenderness_rad, at_critical?))
}
