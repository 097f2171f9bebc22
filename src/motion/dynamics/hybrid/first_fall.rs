//! Overturning without impact: in the first fall from rest, before the hinges ever close. Independent of the
//! impact model.

use std::ops::ControlFlow;

use super::engine::{EngineError, Observer, Settings, Transition, simulate};
use super::rocking::{Guard, Mode, Phase, Rocking, RockingState};
use crate::mechanics::chain::MechanismChain;
use crate::mechanics::sway::Sway;

/// Time after the end of the ground motion by which the first fall is over, in seconds: near the unstable
/// equilibrium a motion dwells for some forty of its time scales before rounding decides.
const AFTER_S: f64 = 1e6;

/// The side to which a structure at rest is overturned before its first impact; `None` if it is not.
///
/// # Errors
/// When the integration fails.
pub fn overturns<C: MechanismChain>(
    rocking: &Rocking<'_, C>,
    relative_tolerance: f64,
) -> Result<Option<Sway>, EngineError> {
    let settings = Settings {
        end_s: rocking.ground.end_s() + AFTER_S,
        relative_tolerance,
        // Uplift, and the event that ends the first fall.
        max_transitions: 2,
    };
    let state = RockingState::zeros();
    let finish = simulate(rocking, Phase::Rest, state, &settings, &mut FirstFall)?;
    Ok(match finish.now.mode {
        Phase::Overturned(swing) => Some(swing.sway),
        Phase::Rest | Phase::Rocking(_) => None,
    })
}

/// Breaks when the hinges close.
struct FirstFall;

impl<'a, C: MechanismChain> Observer<Rocking<'a, C>, 3> for FirstFall {
    fn transition(
        &mut self,
        _: &Rocking<'a, C>,
        transition: &Transition<Mode<'a, C::Mechanism>, Guard, 3>,
    ) -> ControlFlow<()> {
        match transition.guard {
            Guard::Closing => ControlFlow::Break(()),
            Guard::Uplift(_) | Guard::Critical | Guard::Limit => ControlFlow::Continue(()),
        }
    }
}
