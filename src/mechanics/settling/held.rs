//! The first mechanism of a row with ties, held at finite displacements: what push it bears there.
//!
//! Its hinges are those that a push opens while the ties pull with their prestress. They stay where they are; a tie pulls by how far the
//! mechanism has stretched it, yields and breaks.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Vector2, Vector3};
use thiserror::Error;

use super::pins::{Pins, two_bodies};
use super::{Condition, Hinge};
use crate::bisection::{Width, bisect};
use crate::mechanics::blocks::{Row, Supports};
use crate::mechanics::capacity::Displaced;
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::lanes::Lanes;
use crate::mechanics::stability::{RowOnset, StabilityError, onset};
use crate::mechanics::stance::Stance;
use crate::mechanics::sway::Sway;
use crate::mechanics::tie::{Tie, TieMemory};

/// The way of a mechanism is gone in steps of this many radians.
const STEP_RAD: f64 = 1e-3;

/// Why a row is not held along a mechanism.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum HeldError {
    /// It does not stand, or what moves it was not found.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// No push moves it.
    #[error("no push moves it to the {}", .0.name())]
    NoPush(Sway),
    /// Its mechanism may go on in several ways.
    #[error(
        "a push to the {side} opens {hinges} hinges, which may go on in several ways: there is no one mechanism to follow",
        side = sway.name()
    )]
    Several {
        /// To which side.
        sway: Sway,
        /// How many joints open.
        hinges: usize,
    },
    /// Its ties hold it, or its bodies come to the end of their way.
    #[error(
        "the mechanism that sways to the {side} comes to the end of its way before it loses its strength, which its ties keep: it has no \
         ultimate displacement; give them a `yield_force_n` or `breaks_at_strain`",
        side = .0.name()
    )]
    Holds(Sway),
}

/// The first mechanism of a row to a side.
#[derive(Clone, Debug)]
pub struct Held<'a> {
    row: &'a Row,
    sway: Sway,
    pins: Pins,
    /// 1 where the first body turns anticlockwise, or -1.
    sense: f64,
    /// Where it has lost its strength.
    end_rad: f64,
    /// By how much each tie has been stretched at most, step by step.
    most_m: Vec<Vec<f64>>,
}

impl<'a> Held<'a> {
    /// That of a row.
    ///
    /// # Errors
    /// When it does not start as a mechanism of one degree of freedom, or has no end.
    pub fn new(row: &'a Row, sway: Sway) -> Result<Self, HeldError> {
        let onset = onset(row, sway)?.ok_or(HeldError::NoPush(sway))?;
        let mut held = Self {
            row,
            sway,
            pins: pins(row, sway, &onset)?,
            sense: 1.0,
            end_rad: 0.0,
            most_m: Vec::new(),
        };
        let first = held.pins.hinges()[0].joint;
        held.sense = onset.velocities[first].rate.signum();
        let mut steps = 0_u32;
        loop {
            let q_rad = f64::from(steps) * STEP_RAD;
            let (true, Some(stretch_m)) = (q_rad < FRAC_PI_2, held.stretch_m(q_rad)) else {
                return Err(HeldError::Holds(sway));
            };
            let before = held.most_m.last();
            let most_m = stretch_m.iter().enumerate().map(|(tie, stretch_m)| {
                before.map_or(*stretch_m, |before| stretch_m.max(before[tie]))
            });
            let most_m = most_m.collect();
            held.most_m.push(most_m);
            let bears = |q_rad: f64| held.bears_g(q_rad).is_some_and(|push_g| push_g > 0.0);
            if !bears(q_rad) {
                let (_, end_rad) = bisect(q_rad - STEP_RAD, q_rad, Width::Rounding, |q| !bears(q));
                held.end_rad = end_rad;
                return Ok(held);
            }
            steps += 1;
        }
    }

    /// Its hinges.
    #[must_use]
    pub fn hinges(&self) -> &[Hinge] {
        self.pins.hinges()
    }

    /// How many bodies move.
    #[must_use]
    pub fn bodies(&self) -> usize {
        match self.row.supports() {
            Supports::Left => 1,
            Supports::Both => self.hinges().len() - 1,
        }
    }

    /// It displaced by this part of its way.
    ///
    /// # Panics
    /// Never: its bodies meet on all of its way.
    #[must_use]
    pub fn displaced(&self, part: f64) -> Displaced {
        let q_rad = part * self.end_rad;
        let poses = self.poses(q_rad).expect("its bodies meet on its way");
        let push_g = self.bears_g(q_rad).expect("its bodies meet on its way");
        let condition = self.condition(push_g);
        let state = self
            .pins
            .state_at(self.row, &condition, &poses, &self.before(q_rad));
        Displaced {
            q_rad,
            // A tie that breaks may take all strength at once.
            acceleration_g: if part == 1.0 { 0.0 } else { push_g },
            hinges_m: self.pins.at_m(&poses),
            poses: poses[1..=self.bodies()].to_vec(),
            friction: state.map_or(0.0, |state| state.friction),
        }
    }

    /// At which parts of its way each tie yields for the first time, and breaks.
    #[must_use]
    pub fn ties_give_way(&self) -> Vec<[Option<f64>; 2]> {
        let ties = self.row.ties().iter().enumerate();
        ties.map(|(index, tie)| {
            let limits_m = [
                tie.yield_force_n / tie.stiffness_n_m,
                tie.breaks_at_strain * tie.slack_length_m(),
            ];
            limits_m.map(|limit_m| {
                let reaches = |q_rad: f64| {
                    let stretch_m = self.stretch_m(q_rad);
                    stretch_m.is_some_and(|stretch_m| stretch_m[index] >= limit_m)
                };
                let step = self
                    .most_m
                    .iter()
                    .position(|most_m| most_m[index] >= limit_m)?;
                let last = u32::try_from(step).ok()?;
                let q_rad = f64::from(last) * STEP_RAD;
                let at_rad = match last {
                    0 => 0.0,
                    _ => bisect(q_rad - STEP_RAD, q_rad, Width::Rounding, reaches).1,
                };
                (at_rad < self.end_rad).then_some(at_rad / self.end_rad)
            })
        })
        .collect()
    }

    /// Poses of its parts, before the first hinge, between them and after the last; `None` where they do not meet.
    fn poses(&self, q_rad: f64) -> Option<Vec<Pose>> {
        let built = Pose::UNDEFORMED;
        let pins_m = &self.pins.pins_m;
        let first = Pose::about(pins_m[0], pins_m[0], self.sense * q_rad);
        match pins_m[1..] {
            [second, third, last] => {
                let others = two_bodies([second, third, last], &[first, built])?;
                Some(vec![built, first, others[0], others[1], built])
            }
            _ => Some(vec![built, first]),
        }
    }

    /// By how much its ties are stretched.
    fn stretch_m(&self, q_rad: f64) -> Option<Vec<f64>> {
        let poses = self.poses(q_rad)?;
        let built = Stance::undeformed(self.row);
        let (_, pulls) = self
            .pins
            .pulls(self.row, &[Pose::UNDEFORMED; 2], &poses, &built);
        Some(pulls.iter().map(|(line, _)| line.stretch_m).collect())
    }

    /// What its ties remember on the way there.
    fn before(&self, q_rad: f64) -> Stance {
        let mut before = Stance::undeformed(self.row);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "steps of less than a quarter of a turn, from zero on"
        )]
        let steps = (q_rad / STEP_RAD).max(0.0) as usize;
        if let Some(most_m) = self.most_m.get(steps).or_else(|| self.most_m.last()) {
            let ties = before.ties.iter_mut().zip(self.row.ties()).zip(most_m);
            for ((memory, tie), most_m) in ties {
                *memory = stretched(tie, *most_m);
            }
        }
        before
    }

    fn condition(&self, push_g: f64) -> Condition {
        Condition {
            supports: [Pose::UNDEFORMED; 2],
            force_g: Vector2::new(self.sway.sign() * push_g, -1.0),
        }
    }

    /// The push, in units of gravity, with which it is in equilibrium: its loads have no moment about any pin.
    fn bears_g(&self, q_rad: f64) -> Option<f64> {
        let (row, poses) = (self.row, self.poses(q_rad)?);
        let built = [Pose::UNDEFORMED; 2];
        let (_, pulls) = self.pins.pulls(row, &built, &poses, &self.before(q_rad));
        let held = self
            .pins
            .loads(row, &poses, Vector2::new(0.0, -1.0), &pulls);
        let push = Vector2::new(self.sway.sign(), 0.0);
        let pushed = self.pins.loads(row, &poses, push, &[]);
        let pins_m = self.pins.at_m(&poses);
        let joint = |hinge: usize| self.hinges()[hinge].joint;
        if row.supports() == Supports::Left {
            let blocks = row.blocks().len();
            let [held, pushed] = [held, pushed].map(|loads| loads[blocks] - loads[joint(0)]);
            return Some(-held.about(pins_m[0]) / pushed.about(pins_m[0]));
        }
        // With the force in the first pin.
        let mut equations = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for other in 1..=3 {
            let between = [&held, &pushed].map(|loads| loads[joint(other)] - loads[joint(0)]);
            let [held, pushed] = between.map(|load| load.about(pins_m[other]));
            let arm = pins_m[0] - pins_m[other];
            let row = Vector3::new(-arm.y, arm.x, pushed);
            equations.set_row(other - 1, &row.transpose());
            right[other - 1] = -held;
        }
        Some(equations.lu().solve(&right)?.z)
    }
}

/// What a tie remembers that was stretched so far at most.
fn stretched(tie: &Tie, most_m: f64) -> TieMemory<Lanes<1>> {
    TieMemory::stretched(tie, 0.0, Lanes([most_m]))
}

/// The hinges that a push opens, if these are a mechanism of one degree of freedom.
fn pins(row: &Row, sway: Sway, onset: &RowOnset) -> Result<Pins, HeldError> {
    let hinges: Vec<Hinge> = onset
        .openings
        .iter()
        .filter_map(|opening| {
            let (joint, edge) = (opening.joint, opening.hinge?);
            Some(Hinge { joint, edge })
        })
        .collect();
    let due = match row.supports() {
        Supports::Left => 1,
        Supports::Both => 4,
    };
    if hinges.len() != due || onset.openings.len() != due {
        let hinges = onset.openings.len();
        return Err(HeldError::Several { sway, hinges });
    }
    Ok(Pins::new(row, hinges))
}
