//! Incipient rocking: the least horizontal acceleration that moves the ring, by limit analysis.

use nalgebra::Vector2;
use thiserror::Error;

use super::mechanism::{EDGES, FourLink, HingeSites};
use super::resultant::ResultantLine;
use super::search::{Lattice, Objective, Quadruple, best_mechanism, edge_index};
use crate::bisection::{Width, bisect};
use crate::mechanics::geometry::field::{Field, Side, Twist};
use crate::mechanics::geometry::ring::{Edge, Ring};

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

/// Why a ring does not start to rock as a four-link mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LimitError {
    /// The ring cannot carry its own weight.
    #[error("the arch cannot carry its own weight")]
    CannotStand,
    /// Statics does not confirm the best four-link mechanism: its thrust line leaves the ring, or two
    /// of its hinges merge into one section that would part altogether.
    #[error(
        "the best four-link mechanism moves at {acceleration_g:.4} g, but statics does not confirm it: \
         another mechanism governs, as in thick shallow rings"
    )]
    OtherMechanism {
        /// Acceleration of the best four-link mechanism found, in units of gravity: not below the true
        /// one.
        acceleration_g: f64,
    },
    /// No push moves the ring as a four-link mechanism.
    #[error("no horizontal push moves the ring as a four-link mechanism")]
    NoPush,
}

/// The incipient acceleration, its mechanism and the thrust line that proves it.
///
/// Kinematic theorem: `A_L` is the least of `int v_y / int v_x` over the admissible mechanisms that
/// move the ring to the right. Static theorem: it is the true one when the thrust line under that push
/// passes inside the ring at every section (at every joint, for voussoirs).
///
/// # Errors
/// When the ring cannot stand, is too thick for a four-link mechanism to govern, or cannot be moved.
pub fn incipient(ring: &Ring, sites: HingeSites) -> Result<Incipient, LimitError> {
    let (acceleration_g, mechanism) = least_acceleration(ring, sites).ok_or(LimitError::NoPush)?;
    if acceleration_g <= 0.0 {
        return Err(LimitError::CannotStand);
    }
    let thrust_line = ResultantLine::through_hinges(ring, &mechanism, push(acceleration_g));
    if !thrust_line.extremes(sites).is_admissible() {
        return Err(LimitError::OtherMechanism { acceleration_g });
    }
    Ok(Incipient {
        acceleration_g,
        mechanism,
        thrust_line,
    })
}

/// The least thickness ratio at which a ring of this embrace angle carries its own weight, to
/// `1e-6`; `None` when no thickness does.
#[must_use]
pub fn least_thickness_ratio(embrace_rad: f64, sites: HingeSites) -> Option<f64> {
    let stands = |thickness_ratio: f64| {
        Ring::new(thickness_ratio, embrace_rad)
            .ok()
            .is_some_and(|ring| !matches!(incipient(&ring, sites), Err(LimitError::CannotStand)))
    };
    let (thinnest, thickest) = (1e-9, 1.0);
    stands(thickest).then(|| bisect(thinnest, thickest, Width::Absolute(1e-6), stands).1)
}

/// Gravity and a push of `acceleration_g` to the right, as load per unit mass.
fn push(acceleration_g: f64) -> Field {
    Field::uniform(Twist::translation(Vector2::new(acceleration_g, -1.0)))
}

/// Minimum of `int v_y / int v_x`, the kinematic theorem.
fn least_acceleration(ring: &Ring, sites: HingeSites) -> Option<(f64, FourLink)> {
    let lattice = Lattice::new(ring, sites);
    // Moments of the area before each section about both edge points, for a unit load along x and y.
    let moments: Vec<[Vector2<f64>; 2]> = lattice
        .sections_rad
        .iter()
        .map(|angle| {
            let part = ring.moments_to(*angle);
            [Edge::Intrados, Edge::Extrados].map(|edge| {
                let arm = part.first - ring.point(*angle, edge) * part.mass;
                Vector2::new(-arm.y, arm.x)
            })
        })
        .collect();
    let score = |rotations: &[f64; 4], quadruple: &Quadruple| {
        let mut power = Vector2::zeros();
        for i in 0..4 {
            power -= moments[quadruple[i]][edge_index(EDGES[i])] * rotations[i];
        }
        if power.x > 0.0 {
            -power.y / power.x
        } else {
            f64::NEG_INFINITY
        }
    };
    let objective = Weakness { ring };
    best_mechanism(ring, sites, &lattice, &score, &objective)
        .map(|(value, mechanism)| (-value, mechanism))
}

/// Minus the acceleration at which a mechanism starts to move.
struct Weakness<'a> {
    ring: &'a Ring,
}

impl Objective for Weakness<'_> {
    fn kinks_rad(&self) -> &[f64] {
        &[]
    }

    fn evaluate(&self, mechanism: &FourLink, _: [bool; 4]) -> (f64, [f64; 4]) {
        let field = mechanism.field();
        let sway = field.product(&push_only(), self.ring);
        let acceleration_g = acceleration_g(mechanism, self.ring);
        let load = push(acceleration_g);
        let local = [load.at(0.0, Side::After); 4];
        let line = ResultantLine::through_hinges(self.ring, mechanism, load);
        let gradient = line.power_gradient(mechanism, local);
        (-acceleration_g, gradient.map(|slope| slope / sway))
    }
}

/// A unit push to the right without gravity.
fn push_only() -> Field {
    Field::uniform(Twist::translation(Vector2::new(1.0, 0.0)))
}

/// The push, in units of gravity, at which `mechanism` starts to move.
#[must_use]
pub fn acceleration_g(mechanism: &FourLink, ring: &Ring) -> f64 {
    let field = mechanism.field();
    let rise = field.product(
        &Field::uniform(Twist::translation(Vector2::new(0.0, 1.0))),
        ring,
    );
    rise / field.product(&push_only(), ring)
}
