//! How a row between two supports follows them when they move slowly, and what push it then bears.
//!
//! Rigid blocks without tension or sliding, at rest at every instant. Where supports have moved, the row stands on three hinges: two bodies between
//! three pins, whose positions and forces are closed forms (`pins`). Such a state lasts while its joints open no way back and the thrust
//! line stays inside all others. Where that ends, a joint cannot hand its hinge on little by little: with a fourth hinge the row is an unstable mechanism,
//! which snaps to three other hinges, or falls (`descent`). So a path of equilibria is made of pieces, and which ones they are depends
//! on where it began: here, at the undeformed row.
//!
//! Likewise for a push that grows while the supports stand still: it moves nothing until it makes hinges snap. That push is the first motion; the
//! push at which the row falls, its capacity, may be many times larger.
//!
//! Ties are stretched by what the row does, and pull back. They may hold it on more than three hinges, where it goes on little by little: the
//! next hinge is then the one that the last equilibrium lacks.

mod descent;
mod held;
mod pins;

use nalgebra::Vector2;
use serde::Serialize;
use thiserror::Error;

use self::descent::Descent;
pub use self::held::{Held, HeldError};
pub use self::pins::{Pin, Pins, State};
use super::blocks::{Row, Supports};
use super::contact::ContactError;
use super::geometry::pose::Pose;
use super::geometry::rigid::linear;
use super::lanes::Lanes;
use super::stability::{StabilityError, falls_at, onset_at};
use super::stance::Stance;
use super::sway::Sway;
use super::tie::TieMemory;
use crate::bisection::{Width, falls_below_zero, try_bisect};

/// A way is gone in steps of this part of the row's size, of a radian, or of gravity.
const STEP: f64 = 1e-3;
/// With ties, steps double as long as blocks turn at the same rates, but for this part of these,
const EVEN: f64 = 0.05;
/// up to this one.
const LONGEST_STEP: f64 = 0.064;
/// A row that gives way is pushed on by these parts of size, radian, or gravity, one after the other until it has found other hinges.
const NUDGES: [f64; 3] = [1e-6, 1e-5, 1e-4];
/// Pushes by which a symmetric row chooses a side, in units of gravity.
const TILTS_G: [f64; 3] = [0.0, 1e-6, 1e-4];
/// Forces below this part of the weight, and rotations below it, are rounding.
const ROUNDING: f64 = 1e-12;
/// Hinges of a row that ties hold are exchanged so many times at once, at most.
const MOST_EXCHANGES: usize = 20;
/// No row bears a push of so many times gravity that is found by following it.
const LARGEST_PUSH_G: f64 = 100.0;

/// Movement of a support from its original position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Movement {
    /// Outwards, away from the other support, in metres.
    pub spread_m: f64,
    /// Down, in metres.
    pub settlement_m: f64,
    /// Anticlockwise about the middle of its joint, in radians.
    pub rotation_rad: f64,
}

linear!(Movement {
    spread_m,
    settlement_m,
    rotation_rad
});

impl Movement {
    /// Its size over that of the row, or in radians.
    fn extent(&self, size_m: f64) -> f64 {
        self.spread_m.hypot(self.settlement_m) / size_m + self.rotation_rad.abs()
    }
}

/// Movements of the supports of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Movements {
    /// The left one.
    pub left: Movement,
    /// The right one.
    pub right: Movement,
}

linear!(Movements { left, right });

impl Movements {
    /// Whether nothing has moved.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Whether both supports of a row have moved as one body, but for rounding.
    fn are_one_motion(&self, row: &Row) -> bool {
        let [left, right] = self.poses(row);
        let gone_m = left.translation.norm().max(row.size_m);
        (left.translation - right.translation).norm() <= ROUNDING * gone_m
            && (left.rotation_rad() - right.rotation_rad()).abs() <= ROUNDING
    }

    /// Displacements to the right and upwards, in metres, and rotations of the left and the right support.
    #[must_use]
    pub fn displacements(&self) -> [[f64; 3]; 2] {
        [(-1.0, self.left), (1.0, self.right)].map(|(outwards, moved)| {
            let outwards_m = outwards * moved.spread_m;
            [outwards_m, -moved.settlement_m, moved.rotation_rad]
        })
    }

    /// Positions of the left and the right support of a row then.
    #[must_use]
    pub fn poses(&self, row: &Row) -> [Pose; 2] {
        let joints = &row.joints;
        let pose = |joint: usize, [x, y, rotation_rad]: [f64; 3]| {
            let middle = joints[joint].middle_m();
            Pose::about(middle, middle + Vector2::new(x, y), rotation_rad)
        };
        let [left, right] = self.displacements();
        [pose(0, left), pose(joints.len() - 1, right)]
    }

    fn extent(&self, size_m: f64) -> f64 {
        self.left.extent(size_m) + self.right.extent(size_m)
    }
}

/// The condition of a row: where its supports are, and the force on a unit of its mass, in units of gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Positions of the left and the right support.
    pub supports: [Pose; 2],
    /// Gravity and inertia over gravity.
    pub force_g: Vector2<f64>,
}

/// Hinges that gave way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Snap {
    /// Place along the way, in metres if supports move.
    #[serde(rename = "at_m")]
    pub at: f64,
    /// The hinges before; `None` where the row was undeformed.
    #[serde(rename = "hinges_before")]
    pub before: Option<Vec<Pin>>,
    /// The hinges after; `None` where it fell.
    #[serde(rename = "hinges_after")]
    pub after: Option<Vec<Pin>>,
    /// Causes, if the row had hinges: joints whose line of thrust reached an edge, or that shut.
    #[serde(rename = "by")]
    pub causes: Vec<Pin>,
}

/// The end of a followed path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reached {
    /// To the end of the way.
    End,
    /// To here, where it falls.
    Falls(f64),
}

/// Why a row could not be followed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SettlingError {
    /// A stack has one support.
    #[error("the row stands on one support alone, and nothing moves against it")]
    OneSupport,
    /// The undeformed row does not stand.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// Velocities were not found.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The forces of ties were not found.
    #[error(
        "what the ties pull with was not found where the row gives way: give them less stiffness, or other places"
    )]
    Ties,
    /// No hinges were found on which it stands.
    #[error("its hinges give way, and no others were found on which it rests")]
    Lost {
        /// Place along the way.
        at: f64,
    },
    /// The row rests with a joint that is open at both edges.
    #[error(
        "its hinges give way, and joint {joint} (from 0 at the left springing) parts: blocks that do not touch are not followed"
    )]
    Parted {
        /// Place along the way.
        at: f64,
        /// Index of the joint, from 0 on the left support.
        joint: usize,
    },
}

impl SettlingError {
    /// Place along the way at which the row was lost; `None` if that is not known.
    #[must_use]
    pub const fn at(&self) -> Option<f64> {
        match self {
            Self::Lost { at } | Self::Parted { at, .. } => Some(*at),
            Self::OneSupport | Self::Stability(_) | Self::Contact(_) | Self::Ties => None,
        }
    }
}

/// A row that follows slow changes.
#[derive(Clone, Debug)]
pub struct Follower<'a> {
    /// The row undeformed.
    pub row: &'a Row,
    descent: Descent<'a>,
    /// The hinges on which it stands; none while it is undeformed.
    pub hinges: Option<Pins>,
    /// Its condition.
    pub condition: Condition,
    /// Positions of its blocks, and the memory of its ties.
    pub stance: Stance,
    /// Hinges that gave way so far.
    pub snaps: Vec<Snap>,
    /// Tolerance of its hinges: forces over the weight and openings in radians below this are rounding.
    slack: f64,
}

impl<'a> Follower<'a> {
    /// The undeformed row.
    ///
    /// # Errors
    /// When it is a stack, or does not stand.
    pub fn new(row: &'a Row) -> Result<Self, SettlingError> {
        if row.supports == Supports::Left {
            return Err(SettlingError::OneSupport);
        }
        if let Some(openings) = super::stability::falls(row)? {
            return Err(StabilityError::CannotStand(openings).into());
        }
        Ok(Self {
            row,
            descent: Descent::new(row),
            hinges: None,
            condition: Condition {
                supports: [Pose::UNDEFORMED; 2],
                force_g: Vector2::new(0.0, -1.0),
            },
            stance: Stance::undeformed(row),
            snaps: Vec::new(),
            slack: ROUNDING,
        })
    }

    /// Whether it stands on more hinges than three, which ties alone hold.
    #[must_use]
    pub fn is_held_by_ties(&self) -> bool {
        let hinges = self.hinges.as_ref();
        hinges.is_some_and(|pins| pins.hinges.len() > 3)
    }

    /// Its forces and rotations; none while it is undeformed, where they are not determined.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        self.state_in(&self.condition)
    }

    /// Its forces and rotations in another condition, on the present hinges.
    fn state_in(&self, condition: &Condition) -> Option<State> {
        let hinges = self.hinges.as_ref()?;
        hinges.state(self.row, condition, &self.stance)
    }

    /// Moves the supports on from where they are, in a straight line, from this part of a movement to that.
    ///
    /// # Errors
    /// When the row is lost where it gives way.
    pub fn move_supports(
        &mut self,
        movements: impl Fn(f64) -> Movements,
        from: f64,
        to: f64,
    ) -> Result<Reached, SettlingError> {
        let (row, force_g) = (self.row, self.condition.force_g);
        let (first, last) = (movements(from), movements(to));
        let extent = (last - first).extent(row.size_m);
        if extent == 0.0 {
            return Ok(Reached::End);
        }
        if self.hinges.is_none() && last.are_one_motion(row) {
            return Ok(self.move_along(&movements, [from, to])?);
        }
        let way = |at: f64| Condition {
            supports: movements(at).poses(row),
            force_g,
        };
        self.follow(&way, [from, to], (to - from) / extent)
    }

    /// Moves the undeformed row along as a whole, the left foot in a straight line: it is as it was, until gravity on what has turned opens
    /// its joints.
    fn move_along(
        &mut self,
        movements: &impl Fn(f64) -> Movements,
        [from, to]: [f64; 2],
    ) -> Result<Reached, ContactError> {
        let row = self.row;
        let there = |part: f64| {
            let [pose, _] = movements(part).poses(row);
            let mut stance = Stance::undeformed(row);
            stance.placement.move_supports([pose; 2]);
            stance.placement.open(|_| [0.0; 2]);
            stance
        };
        let falls = |part: f64| Ok(falls_at(row, &there(part))?.is_some());
        if falls(to)? {
            let (last, _) = try_bisect(from, to, Width::Rounding, falls)?;
            return Ok(Reached::Falls(last));
        }
        self.stance = there(to);
        self.condition.supports = self.stance.placement.support_poses;
        Ok(Reached::End)
    }

    /// The push to a side, in units of gravity, that makes the row give way where it stands; `None` where none does. Zero where ties hold it
    /// on more than three hinges.
    ///
    /// # Errors
    /// When the velocities of a trial are not found.
    pub fn first_motion_g(&self, sway: Sway) -> Result<Option<f64>, ContactError> {
        if self.is_held_by_ties() {
            return Ok(Some(0.0));
        }
        match onset_at(self.row, &self.stance, sway) {
            // Where it is about to fall, rounding may leave it on either side of zero.
            Ok(onset) => Ok(onset.map(|onset| onset.acceleration_g.max(0.0))),
            Err(StabilityError::CannotStand(_)) => Ok(Some(0.0)),
            Err(StabilityError::Contact(error)) => Err(error),
        }
    }

    /// Pushes the row to a side until it falls, and returns that push in units of gravity; `None` where none was met. `first_g` is the push
    /// of its first motion. The row itself stays where it is.
    ///
    /// # Errors
    /// When the row is lost where it gives way.
    pub fn capacity_g(&self, sway: Sway, first_g: f64) -> Result<Option<f64>, SettlingError> {
        // Undeformed, its joints hold it until they are four; then only ties can.
        let is_built = self.hinges.is_none();
        if is_built && self.row.ties.is_empty() {
            return Ok(Some(first_g));
        }
        let from_g = if is_built { first_g } else { 0.0 };
        // At the end of a way it lacks all the slack, with a force that a push may not even change: where the thrust vanishes, the force at
        // the crown. The slack is counted from there, so that the last digit of that force does not make it fall.
        let lacks = self.state().map_or(0.0, |state| -state.margin().min(0.0));
        let mut pushed = self.clone();
        pushed.slack = ROUNDING + lacks;
        let condition = self.condition;
        let way = move |push_g: f64| Condition {
            force_g: condition.force_g + Vector2::new(sway.sign() * push_g, 0.0),
            ..condition
        };
        let reached = pushed.follow(&way, [from_g, LARGEST_PUSH_G], 1.0)?;
        Ok(match reached {
            // Two computations of one push differ by rounding.
            Reached::Falls(capacity_g) => Some(capacity_g.max(first_g)),
            Reached::End => None,
        })
    }

    /// Follows what changes along a way whose parameter changes by `unit` while a support goes by the size of the row, or turns by a radian,
    /// or a push grows by gravity.
    fn follow(
        &mut self,
        way: &impl Fn(f64) -> Condition,
        [from, to]: [f64; 2],
        unit: f64,
    ) -> Result<Reached, SettlingError> {
        let mut low = from;
        if self.hinges.is_none() {
            match self.give_way(way, low, unit)? {
                Some(at) => low = at,
                None => return Ok(Reached::Falls(low)),
            }
        }
        let (mut step, mut rates) = (STEP, Vec::new());
        while low < to {
            let next = (low + step * unit).min(to);
            let condition = way(next);
            let state = self.state_in(&condition);
            let margin_there = self.margin(state.as_ref());
            let held = state.filter(|_| margin_there >= 0.0);
            let goes_evenly = |state: &State| self.goes_evenly(state, &rates, next - low);
            let evenly = held.as_ref().is_some_and(goes_evenly);
            if step > STEP && !evenly {
                step = (0.25 * step).max(STEP);
                continue;
            }
            if let Some(state) = held {
                // The memory of ties depends on the path.
                if !self.row.ties.is_empty() {
                    rates = self.rates(&state, next - low).collect();
                    self.stand(&condition, state);
                }
                if evenly {
                    step = (2.0 * step).min(LONGEST_STEP);
                }
                low = next;
                continue;
            }
            let margin = |at: f64| self.margin(self.state_in(&way(at)).as_ref());
            // Where ties hold it, its forces are found to this much.
            let is_held = self.is_held_by_ties();
            let rounding = if is_held { self.slack } else { 0.0 };
            let (last, _) = falls_below_zero(low, (next, margin_there), rounding, margin);
            self.stand_in(&way(last));
            match self.give_way(way, last, unit)? {
                Some(at) => low = at,
                None => return Ok(Reached::Falls(last)),
            }
            (step, rates) = (STEP, Vec::new());
        }
        self.stand_in(&way(to.max(low)));
        Ok(Reached::End)
    }

    /// Rates at which blocks turn on the way to another state.
    fn rates(&self, there: &State, way: f64) -> impl Iterator<Item = f64> {
        let here = self.stance.placement.poses.iter();
        let turns = there.rotations_rad.iter().zip(here);
        turns.map(move |(there_rad, here)| (there_rad - here.rotation_rad()) / way)
    }

    /// Whether blocks turn on the way to a state so far on as fast as before, and no tie yields or breaks. Without ties there is no before.
    fn goes_evenly(&self, there: &State, before: &[f64], way: f64) -> bool {
        let most = before.iter().map(|rate| rate.abs()).fold(0.0, f64::max);
        let alike =
            |(before, now): (&f64, f64)| (before - now).abs() <= EVEN * most + ROUNDING / way;
        let yielded = |memory: &TieMemory<Lanes<1>>| (memory.yielded_m, memory.is_broken());
        let mut before_and_now = before.iter().zip(self.rates(there, way));
        let ties = self.stance.ties.iter().map(yielded);
        !before.is_empty() && before_and_now.all(alike) && ties.eq(there.ties.iter().map(yielded))
    }

    /// Margin of a state above the slack; not a number if there is none.
    fn margin(&self, state: Option<&State>) -> f64 {
        state.map_or(f64::NAN, |state| state.margin() + self.slack)
    }

    /// Places the row on its hinges in a condition in which they hold it.
    fn stand_in(&mut self, condition: &Condition) {
        if let Some(state) = self.state_in(condition) {
            self.stand(condition, state);
        }
    }

    /// Places the row on its hinges in a condition in which their state is known.
    fn stand(&mut self, condition: &Condition, state: State) {
        self.condition = *condition;
        self.stance.placement.move_supports(condition.supports);
        self.stance.placement.turn(&state.rotations_rad);
        self.stance.ties = state.ties;
    }

    /// Other hinges that hold the row in a condition beyond that of its own, where ties let it go there little by little: those that the last
    /// equilibrium lacks, without those that would shut.
    fn exchanged(&self, condition: &Condition) -> Option<(Pins, State)> {
        if self.row.ties.is_empty() {
            return None;
        }
        let mut pins = self.hinges.clone()?;
        for _ in 0..MOST_EXCHANGES {
            let state = pins.state(self.row, condition, &self.stance)?;
            let wrong = state.beyond(-self.slack);
            if wrong.is_empty() {
                return Some((pins, state));
            }
            pins = pins.exchanged(self.row, &wrong)?;
        }
        None
    }

    /// Goes on from where the present hinges hold it last. Returns from where on others do; `None` where it falls.
    fn give_way(
        &mut self,
        way: &impl Fn(f64) -> Condition,
        at: f64,
        unit: f64,
    ) -> Result<Option<f64>, SettlingError> {
        let before = self.hinges.clone();
        let last = way(at);
        let mut parted = None;
        for nudge in NUDGES {
            let beyond = at + nudge * unit;
            let condition = way(beyond);
            let state = self.state_in(&condition);
            let causes = state.map_or_else(Vec::new, |state| state.beyond(-self.slack));
            let snap = |after: Option<&Pins>| Snap {
                at,
                before: before.as_ref().map(|hinges| hinges.hinges.to_vec()),
                after: after.map(|hinges| hinges.hinges.to_vec()),
                causes: causes.clone(),
            };
            if let Some((hinges, state)) = self.exchanged(&condition) {
                self.snaps.push(snap(Some(&hinges)));
                self.hinges = Some(hinges);
                self.stand(&condition, state);
                return Ok(Some(beyond));
            }
            for tilt_g in TILTS_G {
                let mut stance = self.stance.clone();
                if !(self.descent).settle(&mut stance, &last, &condition, tilt_g)? {
                    self.snaps.push(snap(None));
                    return Ok(None);
                }
                let Some(hinges) = Pins::of(self.row, &stance.placement) else {
                    parted = stance.placement.parted_joint();
                    continue;
                };
                let state = hinges.state(self.row, &condition, &stance);
                if let Some(state) = state.filter(|state| state.holds(self.slack)) {
                    self.snaps.push(snap(Some(&hinges)));
                    self.hinges = Some(hinges);
                    self.stance = stance;
                    self.stand(&condition, state);
                    return Ok(Some(beyond));
                }
            }
        }
        Err(match parted {
            Some(joint) => SettlingError::Parted { at, joint },
            None => SettlingError::Lost { at },
        })
    }
}
