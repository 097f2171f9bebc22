//! Positions of the bodies of a mechanism, in the frame of the ground.

use super::rocking::{Mode, Phase, Rocking, RockingState, Swing, SystemState};
use crate::dynamics::State;
use crate::mechanics::{Link, Mechanism, MechanismChain, Sway};

/// Rotations of the bodies of a mechanism, or their rates.
pub(super) type Rotations<C> = <<C as MechanismChain>::Mechanism as Mechanism>::Rotations;

/// State of a structure on moving ground at one time.
pub(super) type StructureState<'a, C> = SystemState<'a, <C as MechanismChain>::Mechanism>;

/// Rotations (or rates) of a mechanism in its own frame, times `factor`, in the frame of the ground. A sway to the left is reflected,
/// which reverses the order of the bodies and the sign of their rotations.
pub(super) fn seen_from_ground<C: MechanismChain>(
    sway: Sway,
    mut rotations: Rotations<C>,
    factor: f64,
) -> Rotations<C> {
    if sway == Sway::Left {
        rotations.as_mut().reverse();
    }
    for rotation in rotations.as_mut() {
        // Adding zero makes a negative zero positive.
        *rotation = *rotation * (sway.sign() * factor) + 0.0;
    }
    rotations
}

/// Rotations of the bodies and their rates, in the frame of the ground.
pub(super) fn posture<C: MechanismChain>(
    rocking: &Rocking<'_, C>,
    mode: Mode<'_, C::Mechanism>,
    state: &RockingState,
) -> (Rotations<C>, Rotations<C>) {
    let seen = |sway, link: &Link<C::Mechanism>, q_rad, moved, rate| {
        (
            seen_from_ground::<C>(sway, link.mechanism.rotations(q_rad), moved),
            seen_from_ground::<C>(sway, link.mechanism.rotation_rates(q_rad), rate),
        )
    };
    match mode.swing() {
        Some(Swing { sway, link, .. }) => seen(sway, link, state[0], 1.0, state[1]),
        None => {
            let mut first = [Sway::Right, Sway::Left].into_iter();
            let link = first
                .find_map(|side| rocking.chain.link_from(side, 0))
                .expect("a structure has its first mechanism");
            seen(Sway::Right, link, 0.0, 0.0, 0.0)
        }
    }
}

/// State of motion in a mode.
pub(super) fn state<M>(mode: Mode<'_, M>) -> State {
    match mode {
        Phase::Rest => State::Rest,
        Phase::Rocking(swing) => State::Rocking(swing.sway),
        Phase::Overturned(swing) => State::Overturned(swing.sway),
    }
}
