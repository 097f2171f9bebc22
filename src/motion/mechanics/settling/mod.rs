//! Equilibrium path of a row between two supports that move slowly, and the push that the displaced row then carries.
//!
//! The blocks are rigid, without tension or sliding, and inertia is neglected. With moved supports the row stands on three hinges: two bodies between
//! three pins, with positions and forces in closed form (`pins`). Such a state is admissible while the hinges stay open and the thrust line stays
//! inside all other joints. Beyond that, a hinge cannot move to the next joint gradually: with a fourth hinge the row is an unstable mechanism. The
//! mechanism snaps to three other hinges, or the row falls (`descent`). An equilibrium path thus consists of pieces, and these depend on the start of
//! the path: here, the undeformed row.
//!
//! A push that grows while the supports rest moves nothing until the hinges snap. That push is the first motion. The push at which the row falls is
//! the capacity, and may be many times larger.
//!
//! Ties lengthen as the row moves, and pull back. Ties may hold the row on more than three hinges, where hinges change gradually: the next hinge is
//! then at the joint where the last equilibrium becomes inadmissible.

mod descent;
mod held;
mod pins;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use self::descent::Descent;
pub use self::held::{Held, HeldError};
pub use self::pins::{HingeState, Pin, Pins};
use super::contact::ContactError;
use super::geometry::rigid::linear;
use super::stability::{collapse_mechanism_at, onset_at};
use crate::bisection::{Width, falls_below_zero, try_bisect};
use crate::mechanics::{Lanes, Pose, Row, RowState, StabilityError, Supports, Sway, TieMemory};

/// Length of a step along the path: a fraction of the row's size, radians, or multiples of gravity.
const STEP: f64 = 1e-3;
/// Relative difference of rotation rates between steps below which the step length doubles, for rows with ties.
const EVEN: f64 = 0.05;
/// Longest step with ties, in the units of [`STEP`].
const LONGEST_STEP: f64 = 0.064;
/// Perturbations beyond an inadmissible state, in the units of [`STEP`], tried in turn until the row finds other hinges.
const PERTURBATIONS: [f64; 3] = [1e-6, 1e-5, 1e-4];
/// Horizontal pushes, in multiples of gravity, that break the symmetry of a row; tried in turn.
const TILTS_G: [f64; 3] = [0.0, 1e-6, 1e-4];
/// Tolerance: relative to the weight for forces, in radians for rotations.
const ROUNDING: f64 = 1e-12;
/// Maximum number of hinge exchanges at one point of the path, for a row held by ties.
const MOST_EXCHANGES: usize = 20;
/// Pushes above this multiple of gravity are not searched for.
const LARGEST_PUSH_G: f64 = 100.0;

/// Movement of a support from its original position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Movement {
    /// Outwards, away from the other support, in metres.
    pub spread_m: f64,
    /// Downwards, in metres.
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
    /// Displacement over the size of the row plus the rotation in radians.
    fn extent(&self, size_m: f64) -> f64 {
        libm::hypot(self.spread_m, self.settlement_m) / size_m + self.rotation_rad.abs()
    }
}

/// Movements of the supports of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Movements {
    /// Movement of the left support.
    pub left: Movement,
    /// Movement of the right support.
    pub right: Movement,
}

linear!(Movements { left, right });

impl Movements {
    /// Whether neither support has moved.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Whether both supports have moved as one rigid body, within rounding error.
    fn are_rigid_motion(&self, row: &Row) -> bool {
        let [left, right] = self.poses(row);
        let moved_m = left.translation.norm().max(row.size_m);
        (left.translation - right.translation).norm() <= ROUNDING * moved_m
            && (left.rotation_rad() - right.rotation_rad()).abs() <= ROUNDING
    }

    /// Displacements of the left and the right support: to the right and upwards in metres, and anticlockwise in radians.
    pub fn displacements(&self) -> [[f64; 3]; 2] {
        [(-1.0, self.left), (1.0, self.right)].map(|(outwards, moved)| {
            let outwards_m = outwards * moved.spread_m;
            [outwards_m, -moved.settlement_m, moved.rotation_rad]
        })
    }

    /// Poses of the left and the right support of a row after these movements.
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

/// Loading of a row: the poses of its supports, and the force on a unit of its mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Poses of the left and the right support.
    pub supports: [Pose; 2],
    /// Gravity and inertia force on a unit of mass, in multiples of gravity.
    pub force_g: Vector2<f64>,
}

/// Snap of a row from one set of hinges to another, or its fall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snap {
    /// Position along the path, in metres if supports move.
    #[serde(rename = "at_m")]
    pub at: f64,
    /// Hinges before the snap; `None` if the row was undeformed.
    #[serde(rename = "hinges_before")]
    pub before: Option<Vec<Pin>>,
    /// Hinges after the snap; `None` if the row fell.
    #[serde(rename = "hinges_after")]
    pub after: Option<Vec<Pin>>,
    /// Joints whose thrust line reached an edge, and hinges that closed; empty if the row had no hinges.
    #[serde(rename = "by")]
    pub causes: Vec<Pin>,
}

/// Reason why a row could not be followed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SettlingError {
    /// The row is a stack, with one support only.
    #[error("the structure stands on one support: a movement of a springing needs two")]
    OneSupport,
    /// The row carries constant forces.
    #[error(
        "moving supports are followed without constant forces (`thrust_n`, or `moves = false`, of [[load]]); leave these out"
    )]
    ConstantForces,
    /// The undeformed row is not stable.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// The contact solver found no velocities.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The forces of the ties were not found.
    #[error(
        "the forces of the ties were not found at a change of hinges: give the ties less stiffness, or other positions"
    )]
    Ties,
    /// No other hinges were found on which the row is in equilibrium, at this position along the path.
    #[error("its hinges give way, and no others were found on which it rests")]
    NoEquilibrium(f64),
    /// The row comes to rest with a joint that is open at both edges.
    #[error(
        "its hinges give way, and joint {joint} (from 0 at the left springing) parts: blocks that do not touch are not followed"
    )]
    Parted {
        /// Position along the path.
        at: f64,
        /// Index of the joint, from 0 on the left support.
        joint: usize,
    },
}

impl SettlingError {
    /// Position along the path at which the row was lost; `None` if unknown.
    pub const fn path_position(&self) -> Option<f64> {
        match self {
            Self::NoEquilibrium(at) | Self::Parted { at, .. } => Some(*at),
            Self::OneSupport
            | Self::ConstantForces
            | Self::Stability(_)
            | Self::Contact(_)
            | Self::Ties => None,
        }
    }
}

/// Row that follows slow changes of its supports or of a push, in equilibrium.
#[derive(Clone, Debug)]
pub struct Follower<'a> {
    /// Undeformed row.
    pub row: &'a Row,
    descent: Descent<'a>,
    /// Hinges of the present state; `None` while the row is undeformed.
    pub hinges: Option<Pins>,
    /// Present loading.
    pub condition: Condition,
    /// Poses of the blocks, and state of the ties.
    pub stance: RowState,
    /// Snaps of the path followed up to now.
    pub snaps: Vec<Snap>,
    /// Tolerance of the hinges: forces over the weight, and openings in radians, below this value are rounding errors.
    slack: f64,
}

impl<'a> Follower<'a> {
    /// Follower of the undeformed row.
    ///
    /// # Errors
    /// If the row is a stack, carries constant forces, or is not stable.
    pub fn new(row: &'a Row) -> Result<Self, SettlingError> {
        if row.supports == Supports::Left {
            return Err(SettlingError::OneSupport);
        }
        if row.constant_forces().next().is_some() {
            return Err(SettlingError::ConstantForces);
        }
        if let Some(openings) = super::stability::collapse_mechanism(row)? {
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
            stance: RowState::undeformed(row),
            snaps: Vec::new(),
            slack: ROUNDING,
        })
    }

    /// Whether the row stands on more than three hinges, which is only possible with ties.
    pub fn is_held_by_ties(&self) -> bool {
        let hinges = self.hinges.as_ref();
        hinges.is_some_and(|pins| pins.hinges.len() > 3)
    }

    /// Present forces and rotations; `None` while the row is undeformed, where the forces are indeterminate.
    pub fn state(&self) -> Option<HingeState> {
        self.state_in(&self.condition)
    }

    /// Forces and rotations under another loading, on the present hinges.
    fn state_in(&self, condition: &Condition) -> Option<HingeState> {
        let hinges = self.hinges.as_ref()?;
        hinges.state(self.row, condition, &self.stance)
    }

    /// Moves the supports from `movements(from)` to `movements(to)`, along a straight line. Returns the parameter at which the row falls;
    /// `None` if it reaches the end.
    ///
    /// # Errors
    /// If no equilibrium is found where the hinges become inadmissible.
    pub fn move_supports(
        &mut self,
        movements: impl Fn(f64) -> Movements,
        from: f64,
        to: f64,
    ) -> Result<Option<f64>, SettlingError> {
        let (row, force_g) = (self.row, self.condition.force_g);
        let (first, last) = (movements(from), movements(to));
        let extent = (last - first).extent(row.size_m);
        if extent == 0.0 {
            return Ok(None);
        }
        if self.hinges.is_none() && last.are_rigid_motion(row) {
            return Ok(self.move_along(&movements, [from, to])?);
        }
        let path = |at: f64| Condition {
            supports: movements(at).poses(row),
            force_g,
        };
        self.follow_path(&path, [from, to], (to - from) / extent)
    }

    /// Moves the undeformed row as one rigid body with its supports, until gravity opens joints of the rotated row.
    fn move_along(
        &mut self,
        movements: &impl Fn(f64) -> Movements,
        [from, to]: [f64; 2],
    ) -> Result<Option<f64>, ContactError> {
        let row = self.row;
        let there = |part: f64| {
            let [pose, _] = movements(part).poses(row);
            let mut stance = RowState::undeformed(row);
            stance.placement.move_supports([pose; 2]);
            stance.placement.change_gaps(|_| [0.0; 2]);
            stance
        };
        let falls = |part: f64| Ok(collapse_mechanism_at(row, &there(part))?.is_some());
        if falls(to)? {
            let (last, _) = try_bisect(from, to, Width::Rounding, falls)?;
            return Ok(Some(last));
        }
        self.stance = there(to);
        self.condition.supports = self.stance.placement.support_poses;
        Ok(None)
    }

    /// Push to a side, in multiples of gravity, that starts a motion of the present state; `None` if no push does. The push is zero if
    /// ties hold the row on more than three hinges.
    ///
    /// # Errors
    /// If the velocities of a trial mechanism are not found.
    pub fn first_motion_g(&self, sway: Sway) -> Result<Option<f64>, ContactError> {
        if self.is_held_by_ties() {
            return Ok(Some(0.0));
        }
        match onset_at(self.row, &self.stance, sway) {
            // Rounding errors may make the push negative if the row is about to fall.
            Ok(onset) => Ok(onset.map(|onset| onset.acceleration_g.max(0.0))),
            Err(StabilityError::CannotStand(_)) => Ok(Some(0.0)),
            Err(StabilityError::Contact(error)) => Err(error),
        }
    }

    /// Push to a side, in multiples of gravity, at which the row falls; `None` if it does not fall below 100 times gravity. `first_g` is
    /// the push of the first motion. The row itself stays in its present state.
    ///
    /// # Errors
    /// If no equilibrium is found where the hinges become inadmissible.
    pub fn capacity_g(&self, sway: Sway, first_g: f64) -> Result<Option<f64>, SettlingError> {
        // The first motion of an undeformed row is a mechanism with four hinges; only ties can then carry more push.
        let is_built = self.hinges.is_none();
        if is_built && self.row.ties.is_empty() {
            return Ok(Some(first_g));
        }
        let from_g = if is_built { first_g } else { 0.0 };
        // At the end of a path the margin may be minus the tolerance, in a force that a push may not change (the force at the crown where the thrust
        // vanishes). Measure the tolerance from the present margin, so that rounding errors of that force are no fall.
        let lacks = self.state().map_or(0.0, |state| -state.margin().min(0.0));
        let mut pushed = self.clone();
        pushed.slack = ROUNDING + lacks;
        let condition = self.condition;
        let path = move |push_g: f64| Condition {
            force_g: condition.force_g + Vector2::new(sway.sign() * push_g, 0.0),
            ..condition
        };
        let falls_g = pushed.follow_path(&path, [from_g, LARGEST_PUSH_G], 1.0)?;
        // Two computations of the same push differ by rounding errors.
        Ok(falls_g.map(|capacity_g| capacity_g.max(first_g)))
    }

    /// Follows the equilibrium along a path from one parameter to another. The parameter changes by `unit` while a support moves by the size of the
    /// row or turns by a radian, or while a push grows by gravity. Returns the parameter at which the row falls; `None` if it reaches the end.
    fn follow_path(
        &mut self,
        path: &impl Fn(f64) -> Condition,
        [from, to]: [f64; 2],
        unit: f64,
    ) -> Result<Option<f64>, SettlingError> {
        let mut low = from;
        if self.hinges.is_none() {
            match self.exchange_hinges(path, low, unit)? {
                Some(at) => low = at,
                None => return Ok(Some(low)),
            }
        }
        let (mut step, mut rates) = (STEP, Vec::new());
        while low < to {
            let next = (low + step * unit).min(to);
            let condition = path(next);
            let state = self.state_in(&condition);
            let margin_there = self.margin(state.as_ref());
            let held = state.filter(|_| margin_there >= 0.0);
            let is_steady = |state: &HingeState| self.is_steady(state, &rates, next - low);
            let steady = held.as_ref().is_some_and(is_steady);
            if step > STEP && !steady {
                step = (0.25 * step).max(STEP);
                continue;
            }
            if let Some(state) = held {
                // The state of ties depends on the path.
                if !self.row.ties.is_empty() {
                    rates = self.rates(&state, next - low).collect();
                    self.set_state(&condition, state);
                }
                if steady {
                    step = (2.0 * step).min(LONGEST_STEP);
                }
                low = next;
                continue;
            }
            let margin = |at: f64| self.margin(self.state_in(&path(at)).as_ref());
            // With ties the forces are accurate to the tolerance only.
            let is_held = self.is_held_by_ties();
            let rounding = if is_held { self.slack } else { 0.0 };
            let (last, _) = falls_below_zero(low, (next, margin_there), rounding, margin);
            self.move_to(&path(last));
            match self.exchange_hinges(path, last, unit)? {
                Some(at) => low = at,
                None => return Ok(Some(last)),
            }
            (step, rates) = (STEP, Vec::new());
        }
        self.move_to(&path(to.max(low)));
        Ok(None)
    }

    /// Rotation rates of the blocks between here and another state, over `distance` along the path.
    fn rates(&self, there: &HingeState, distance: f64) -> impl Iterator<Item = f64> {
        let here = self.stance.placement.poses.iter();
        let turns = there.rotations_rad.iter().zip(here);
        turns.map(move |(there_rad, here)| (there_rad - here.rotation_rad()) / distance)
    }

    /// Whether all blocks turn as fast as in the step `before`, and no tie yields or breaks. Returns false without a step before, as without
    /// ties.
    fn is_steady(&self, there: &HingeState, before: &[f64], distance: f64) -> bool {
        let most = before.iter().map(|rate| rate.abs()).fold(0.0, f64::max);
        let alike =
            |(before, now): (&f64, f64)| (before - now).abs() <= EVEN * most + ROUNDING / distance;
        let yielded = |memory: &TieMemory<Lanes<1>>| (memory.yielded_m, memory.is_broken());
        let mut before_and_now = before.iter().zip(self.rates(there, distance));
        let ties = self.stance.ties.iter().map(yielded);
        !before.is_empty() && before_and_now.all(alike) && ties.eq(there.ties.iter().map(yielded))
    }

    /// Margin of a state plus the tolerance; NaN without a state.
    fn margin(&self, state: Option<&HingeState>) -> f64 {
        state.map_or(f64::NAN, |state| state.margin() + self.slack)
    }

    /// Moves the row to a loading that its hinges can carry.
    fn move_to(&mut self, condition: &Condition) {
        if let Some(state) = self.state_in(condition) {
            self.set_state(condition, state);
        }
    }

    /// Moves the row to a loading, with a known state of its hinges.
    fn set_state(&mut self, condition: &Condition, state: HingeState) {
        self.condition = *condition;
        self.stance.placement.move_supports(condition.supports);
        self.stance.placement.turn(&state.rotations_rad);
        self.stance.ties = state.ties;
    }

    /// Other hinges, and their state, that carry a loading beyond the present one. Inadmissible joints become hinges and closing hinges
    /// leave, as is possible only with ties; `None` without ties, or if no such hinges are found.
    fn find_other_hinges(&self, condition: &Condition) -> Option<(Pins, HingeState)> {
        if self.row.ties.is_empty() {
            return None;
        }
        let mut pins = self.hinges.clone()?;
        for _ in 0..MOST_EXCHANGES {
            let state = pins.state(self.row, condition, &self.stance)?;
            let wrong = state.pins_below_margin(-self.slack);
            if wrong.is_empty() {
                return Some((pins, state));
            }
            pins = pins.exchanged(self.row, &wrong)?;
        }
        None
    }

    /// Replaces hinges that become inadmissible. Returns the position along the path from which other hinges carry the row; `None` if it falls.
    fn exchange_hinges(
        &mut self,
        path: &impl Fn(f64) -> Condition,
        at: f64,
        unit: f64,
    ) -> Result<Option<f64>, SettlingError> {
        let before = self.hinges.clone();
        let last = path(at);
        let mut parted = None;
        for perturbation in PERTURBATIONS {
            let beyond = at + perturbation * unit;
            let condition = path(beyond);
            let state = self.state_in(&condition);
            let causes = state.map_or_else(Vec::new, |state| state.pins_below_margin(-self.slack));
            let snap = |after: Option<&Pins>| Snap {
                at,
                before: before.as_ref().map(|hinges| hinges.hinges.to_vec()),
                after: after.map(|hinges| hinges.hinges.to_vec()),
                causes: causes.clone(),
            };
            if let Some((hinges, state)) = self.find_other_hinges(&condition) {
                self.snaps.push(snap(Some(&hinges)));
                self.hinges = Some(hinges);
                self.set_state(&condition, state);
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
                if let Some(state) = state.filter(|state| state.is_admissible(self.slack)) {
                    self.snaps.push(snap(Some(&hinges)));
                    self.hinges = Some(hinges);
                    self.stance = stance;
                    self.set_state(&condition, state);
                    return Ok(Some(beyond));
                }
            }
        }
        Err(match parted {
            Some(joint) => SettlingError::Parted { at, joint },
            None => SettlingError::NoEquilibrium(at),
        })
    }
}
