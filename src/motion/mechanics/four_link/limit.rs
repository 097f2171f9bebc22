//! Incipient rocking: the smallest horizontal acceleration that moves the ring, by limit analysis.

use nalgebra::Vector2;
use thiserror::Error;

use super::mechanism::{EDGES, FourLink, HingeSites};
use super::resultant::ResultantLine;
use super::search::{Lattice, Objective, Quadruple, best_mechanism};
use super::self_weight::carries_its_weight;
use crate::argument::ArgumentError;
use crate::bisection::{Width, try_bisect};
use crate::mechanics::geometry::field::{Side, quarter_turn};
use crate::mechanics::{Edge, Field, Profile, Ring, Twist};

/// Onset of rocking under a push to the right.
#[derive(Clone, Debug)]
pub struct Incipient {
    /// Incipient acceleration `A_L`, in units of gravity.
    pub acceleration_g: f64,
    /// The mechanism that starts.
    pub mechanism: FourLink,
    /// The thrust line under gravity and the push `A_L`.
    pub thrust_line: ResultantLine,
}

/// Reason why a ring does not start to rock as a four-link mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LimitError {
    /// The ring cannot carry its own weight.
    #[error("the arch cannot carry its own weight")]
    CannotStand,
    /// The ring is stable, but the static theorem does not confirm the best four-link mechanism. Its thrust line leaves the ring, or two of its
    /// hinges merge into one section that would open at both edges. The acceleration of this mechanism, in multiples of gravity, is an upper
    /// bound of the true one.
    #[error(
        "the arch stands, but does not start to rock as a four-link mechanism: the best one moves at \
         {0:.4} g, and the thrust line does not confirm it; another mechanism governs, as in thick shallow arches"
    )]
    OtherMechanism(f64),
    /// The ring is stable, and no push moves it as a four-link mechanism.
    #[error("the arch stands, but no horizontal push moves it as a four-link mechanism")]
    NoPush,
}

/// Computes the incipient acceleration, with its mechanism and the thrust line that proves it.
///
/// The stability under self-weight follows from statics ([`carries_its_weight`]). Kinematic theorem: `A_L` is the minimum of `int v_y / int v_x` over
/// the admissible mechanisms that move the ring to the right. Static theorem: the minimum is exact if the thrust line under that push stays inside
/// the ring at every section (at every joint, for voussoirs).
///
/// # Errors
/// When the ring cannot stand, is too thick for a four-link mechanism to govern, or cannot be moved.
pub fn incipient(ring: &Ring, sites: HingeSites) -> Result<Incipient, LimitError> {
    if !carries_its_weight(ring, sites) {
        return Err(LimitError::CannotStand);
    }
    incipient_of(ring, sites)
}

/// Computes the incipient acceleration of a profile that is stable under its own weight, with its mechanism and thrust line.
///
/// # Errors
/// When no four-link mechanism governs, or no push moves one.
pub(crate) fn incipient_of(
    profile: &dyn Profile,
    sites: HingeSites,
) -> Result<Incipient, LimitError> {
    let least = least_acceleration(profile, sites);
    let (acceleration_g, mechanism) = least.ok_or(LimitError::NoPush)?;
    let thrust_line = ResultantLine::through_hinges(profile, &mechanism, push(acceleration_g));
    if !thrust_line.extremes(sites).is_admissible() {
        return Err(LimitError::OtherMechanism(acceleration_g));
    }
    Ok(Incipient {
        acceleration_g,
        mechanism,
        thrust_line,
    })
}

/// Smallest thickness ratio at which a ring of this embrace angle is stable under its own weight. The result exceeds the exact value by
/// at most `accuracy`.
///
/// The result is below 0.11: a semicircle needs 0.1075 (Milankovitch), and any other ring less. Thicker rings are stable too.
///
/// # Errors
/// When the angle is not in `(0, pi]`.
pub fn least_thickness_ratio(
    embrace_rad: f64,
    sites: HingeSites,
    accuracy: f64,
) -> Result<f64, ArgumentError> {
    let stands = |thickness_ratio: f64| {
        let ring = Ring::new(thickness_ratio, embrace_rad)?;
        Ok(carries_its_weight(&ring, sites))
    };
    let (_, least) = try_bisect(1e-9, 1.0, Width::Absolute(accuracy), stands)?;
    Ok(least)
}

/// Gravity and a push of `acceleration_g` to the right, as load per unit mass.
fn push(acceleration_g: f64) -> Field {
    Field::uniform(Twist::translation(Vector2::new(acceleration_g, -1.0)))
}

/// Minimises `int v_y / int v_x` for a stable profile, by the kinematic theorem. `None` if no push moves the profile.
///
/// In a stable profile a mechanism that sways to the right also rises. A mechanism that seems not to rise has zero velocity within rounding error, as
/// with merged hinges, or sways to the left.
fn least_acceleration(profile: &dyn Profile, sites: HingeSites) -> Option<(f64, FourLink)> {
    let lattice = Lattice::new(profile, sites);
    // Moments of the area before each section about both edge points, for a unit load along x and y.
    let moments: Vec<[Vector2<f64>; 2]> = lattice
        .sections_rad
        .iter()
        .map(|angle| {
            let part = profile.moments_to(*angle);
            let arm = |edge| part.first - profile.point(*angle, edge) * part.mass;
            [Edge::Intrados, Edge::Extrados].map(|edge| quarter_turn(arm(edge)))
        })
        .collect();
    let score = |rotations: &[f64; 4], quadruple: &Quadruple| {
        let mut power = Vector2::zeros();
        for i in 0..4 {
            power -= moments[quadruple[i]][EDGES[i] as usize] * rotations[i];
        }
        if power.x > 0.0 && power.y > 0.0 {
            -power.y / power.x
        } else {
            f64::NEG_INFINITY
        }
    };
    let objective = LeastAcceleration { profile };
    let best = best_mechanism(profile, sites, &lattice, &score, &objective);
    let moving = best.filter(|(value, _)| value.is_finite());
    moving.map(|(value, mechanism)| (-value, mechanism))
}

/// Minus the acceleration at which a mechanism starts to move; minus infinity if no push to the right moves it.
struct LeastAcceleration<'a> {
    profile: &'a dyn Profile,
}

impl Objective for LeastAcceleration<'_> {
    fn evaluate(&self, mechanism: &FourLink, _: [bool; 4]) -> (f64, [f64; 4]) {
        let sway = mechanism.field().product(&push_only(), self.profile);
        let acceleration_g = acceleration_g(mechanism, self.profile);
        let load = push(acceleration_g);
        let local = [load.twist_at(0.0, Side::After); 4];
        let line = ResultantLine::through_hinges(self.profile, mechanism, load);
        let gradient = line.power_gradient(mechanism, local);
        let moves = acceleration_g > 0.0;
        let value = if moves {
            -acceleration_g
        } else {
            f64::NEG_INFINITY
        };
        (value, gradient.map(|slope| slope / sway))
    }
}

/// Unit push to the right without gravity.
fn push_only() -> Field {
    Field::uniform(Twist::translation(Vector2::new(1.0, 0.0)))
}

/// Push, in multiples of gravity, at which `mechanism` starts to move.
pub fn acceleration_g(mechanism: &FourLink, profile: &dyn Profile) -> f64 {
    let field = mechanism.field();
    let up = Twist::translation(Vector2::new(0.0, 1.0));
    let rise = field.product(&Field::uniform(up), profile);
    rise / field.product(&push_only(), profile)
}
