//! The first mechanism of a row, in equilibrium at finite displacements under a decreasing push: for rows on one support, or with ties.
//!
//! A push opens the hinges of the mechanism while the ties pull with their prestress. The hinges stay in the same joints. The mechanism stretches the
//! ties, which may yield and break. A stack without ties that starts to rock as one block about a toe moves as that block up to its unstable
//! equilibrium: push and weight keep their direction relative to the block, so no other joint opens.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Vector2, Vector3};
use thiserror::Error;

use super::pins::{Pins, TieLoads, side, two_bodies};
use super::{Condition, Pin};
use crate::bisection::{Width, bisect};
use crate::mechanics::capacity::{CapacityError, TieEventFractions};
use crate::mechanics::stability::{StabilityError, onset};
use crate::mechanics::{Displaced, Lanes, Pose, Row, RowOnset, Supports, Sway, TieMemory};

/// Rotation of the first body in a step along the mechanism, in radians.
const STEP_RAD: f64 = 1e-3;

/// Reason why a row cannot be followed along a mechanism.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HeldError {
    /// The push that starts it is not found.
    #[error(transparent)]
    Onset(#[from] StabilityError),
    /// No push moves it to this side.
    #[error("no push moves it to the {}", .0.name())]
    NoPush(Sway),
    /// The mechanism to this side has so many hinges, and several degrees of freedom.
    #[error(
        "a push to the {} opens {} hinges, which may go on in several ways: there is no one mechanism to follow", .0.name(), .1
    )]
    SeveralWays(Sway, usize),
    /// The mechanism never loses its strength.
    #[error(transparent)]
    Locks(CapacityError),
    /// The mechanism to this side never loses its strength, because ties hold it.
    #[error(
        "the mechanism that sways to the {} reaches its limit position before its strength is zero, because the ties still \
         hold: it has no ultimate displacement; give the ties a `yield_force_n` or `breaks_at_strain`", .0.name()
    )]
    TiesHold(Sway),
}

/// First mechanism of a row under a push to a side.
#[derive(Clone, Debug)]
pub struct Held<'a> {
    row: &'a Row,
    sway: Sway,
    /// Hinges of the mechanism.
    pub pins: Pins,
    /// 1 if the first body turns anticlockwise, -1 if it turns clockwise.
    sense: f64,
    /// Rotation of the first body at which the push becomes zero, in radians.
    end_rad: f64,
    /// States of the ties after each step.
    ties: Vec<Vec<TieMemory<Lanes<1>>>>,
}

impl<'a> Held<'a> {
    /// Follows the first mechanism of a row until the push becomes zero.
    ///
    /// # Errors
    /// If the first motion is no mechanism of one degree of freedom, or the push never becomes zero.
    pub fn new(row: &'a Row, sway: Sway) -> Result<Self, HeldError> {
        let onset = onset(row, sway)?.ok_or(HeldError::NoPush(sway))?;
        let mut held = Self {
            row,
            sway,
            pins: pins(row, sway, &onset)?,
            sense: 1.0,
            end_rad: 0.0,
            ties: vec![row.ties.iter().map(TieMemory::undeformed).collect()],
        };
        let first = held.pins.hinges[0].joint;
        held.sense = onset.velocities[first].rate.signum();
        for step in 1_u32.. {
            let q_rad = f64::from(step) * STEP_RAD;
            let Some(ties) = held.ties_at(q_rad).filter(|_| q_rad < FRAC_PI_2) else {
                break;
            };
            held.ties.push(ties);
            let bears = |q_rad: f64| {
                held.equilibrium_push_g(q_rad)
                    .is_some_and(|push_g| push_g > 0.0)
            };
            if !bears(q_rad) {
                let (_, end_rad) = bisect(q_rad - STEP_RAD, q_rad, Width::Rounding, |q| !bears(q));
                held.end_rad = end_rad;
                return Ok(held);
            }
        }
        Err(match row.bars().is_empty() {
            true => HeldError::Locks(CapacityError::Locks(sway)),
            false => HeldError::TiesHold(sway),
        })
    }

    /// Number of moving bodies.
    pub fn bodies(&self) -> usize {
        match self.row.supports {
            Supports::Left => 1,
            Supports::Both => self.pins.hinges.len() - 1,
        }
    }

    /// Mechanism at a fraction `part` of its ultimate rotation.
    ///
    /// # Panics
    /// Never: the bodies meet at all displacements of the mechanism.
    pub fn displaced_mechanism(&self, part: f64) -> Displaced {
        let q_rad = part * self.end_rad;
        let poses = self.poses(q_rad).expect("its bodies meet on its way");
        let push_g = self
            .equilibrium_push_g(q_rad)
            .expect("its bodies meet on its way");
        let condition = Condition {
            supports: [Pose::UNDEFORMED; 2],
            force_g: Vector2::new(self.sway.sign() * push_g, -1.0),
        };
        let before = self.tie_states_before(q_rad);
        let state = self.pins.state_at(self.row, &condition, &poses, before);
        let hinges_m = self.pins.positions_m(&poses);
        let poses = poses[1..=self.bodies()].to_vec();
        let from = match self.sway {
            Sway::Right => poses.first(),
            Sway::Left => poses.last(),
        };
        Displaced {
            q_rad: from.map_or(q_rad, |pose| pose.rotation_rad().abs().copysign(q_rad)),
            // A breaking tie may remove all strength at once, so the computed push may not be zero here.
            acceleration_g: if part == 1.0 { 0.0 } else { push_g },
            hinges_m,
            poses,
            friction: state.map_or(0.0, |state| state.friction),
        }
    }

    /// Fractions of the ultimate rotation at which each tie yields and breaks. Yielding after the break does not count.
    pub fn tie_event_fractions(&self) -> Vec<TieEventFractions> {
        let ties = self.row.bars().iter().enumerate().map(|(index, tie)| {
            let yields_m = tie.yield_force_n / tie.stiffness_n_m;
            let yields = self.first(index, |memory| {
                memory.yielded_m.0[0] > 0.0 || memory.stretch_m.0[0] >= yields_m
            });
            let breaks = self.first(index, TieMemory::is_broken);
            let in_time =
                |[_, yields]: &[f64; 2]| breaks.is_none_or(|[_, broken]| *yields < broken);
            let yields = yields.filter(in_time).map(|[_, yields]| yields);
            TieEventFractions { yields, breaks }
        });
        ties.collect()
    }

    /// Interval of fractions of the ultimate rotation in which an irreversible event of a tie happens: neighbouring numbers, or twice
    /// zero if it has happened at the start; `None` if it never happens.
    fn first(&self, tie: usize, does: impl Fn(&TieMemory<Lanes<1>>) -> bool) -> Option<[f64; 2]> {
        let does_at = |part: f64| {
            let ties = self.ties_at(part * self.end_rad);
            ties.is_some_and(|ties| does(&ties[tie]))
        };
        match [0.0, 1.0].map(does_at) {
            [true, _] => Some([0.0; 2]),
            [_, false] => None,
            _ => Some(bisect(0.0, 1.0, Width::Rounding, does_at).into()),
        }
    }

    /// Poses of the parts: before the first hinge, between hinges, after the last hinge; `None` if the bodies cannot meet.
    fn poses(&self, q_rad: f64) -> Option<Vec<Pose>> {
        let built = Pose::UNDEFORMED;
        let pins_m = &self.pins.pins_m;
        let first = Pose::about(pins_m[0], pins_m[0], self.sense * q_rad);
        match pins_m[1..] {
            [second, third, last] => {
                let ends = [first, built];
                let others = two_bodies([second, third, last], &ends, side(&pins_m[1..]))?;
                Some(vec![built, first, others[0], others[1], built])
            }
            _ => Some(vec![built, first]),
        }
    }

    /// States of the ties at a rotation of the first body.
    fn ties_at(&self, q_rad: f64) -> Option<Vec<TieMemory<Lanes<1>>>> {
        let poses = self.poses(q_rad)?;
        Some(self.pulls(q_rad, &poses).0)
    }

    /// States, forces and lines of the ties at a rotation of the first body.
    fn pulls(&self, q_rad: f64, poses: &[Pose]) -> TieLoads {
        let built = [Pose::UNDEFORMED; 2];
        self.pins
            .pulls(self.row, &built, poses, self.tie_states_before(q_rad))
    }

    /// States of the ties at the last step before a rotation of the first body.
    fn tie_states_before(&self, q_rad: f64) -> &[TieMemory<Lanes<1>>] {
        let step = (q_rad / STEP_RAD).max(0.0) as usize;
        &self.ties[step.min(self.ties.len() - 1)]
    }

    /// Push in equilibrium with weight and ties, in multiples of gravity: the loads then have no moment about any pin.
    fn equilibrium_push_g(&self, q_rad: f64) -> Option<f64> {
        let (row, poses) = (self.row, self.poses(q_rad)?);
        let (_, pulls) = self.pulls(q_rad, &poses);
        let (push, weight) = (Vector2::new(self.sway.sign(), 0.0), Vector2::new(0.0, -1.0));
        let held = self.pins.loads(row, &poses, weight, &pulls);
        let pushed = self.pins.loads(row, &poses, push, &[]);
        let pins_m = self.pins.positions_m(&poses);
        let joint = |hinge: usize| self.pins.hinges[hinge].joint;
        if row.supports == Supports::Left {
            let blocks = row.blocks.len();
            let [held, pushed] = [held, pushed].map(|loads| loads[blocks] - loads[joint(0)]);
            return Some(-held.moment_about(pins_m[0]) / pushed.moment_about(pins_m[0]));
        }
        // Unknowns: the force in the first pin, and the push.
        let mut equations = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for other in 1..=3 {
            let between = [&held, &pushed].map(|loads| loads[joint(other)] - loads[joint(0)]);
            let [held, pushed] = between.map(|load| load.moment_about(pins_m[other]));
            let arm = pins_m[0] - pins_m[other];
            let row = Vector3::new(-arm.y, arm.x, pushed);
            equations.set_row(other - 1, &row.transpose());
            right[other - 1] = -held;
        }
        Some(equations.lu().solve(&right)?.z)
    }
}

/// Hinges that a push opens.
///
/// # Errors
/// If the hinges are no mechanism of one degree of freedom.
fn pins(row: &Row, sway: Sway, onset: &RowOnset) -> Result<Pins, HeldError> {
    let hinges: Vec<Pin> = onset
        .openings
        .iter()
        .filter_map(|opening| {
            let (joint, edge) = (opening.joint, opening.hinge?);
            Some(Pin { joint, edge })
        })
        .collect();
    let due = match row.supports {
        Supports::Left => 1,
        Supports::Both => 4,
    };
    if hinges.len() != due || onset.openings.len() != due {
        return Err(HeldError::SeveralWays(sway, onset.openings.len()));
    }
    Ok(Pins::new(row, hinges))
}
