//! A row of rigid blocks before it moves: the push that starts it, and its first mechanism.

use super::clock::Settings;
use super::error::RowModelError;
use super::task::{Task, rise_to_overturn_m};
use crate::argument::ArgumentError;
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::recording::Shape;
use crate::dynamics::request::Initial;
use crate::mechanics::blocks::{Row, Supports};
use crate::mechanics::chain::{Hinge, Mechanism, MechanismChain};
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::four_links::FourLinks;
use crate::mechanics::friction::{self, FrictionError};
use crate::mechanics::settling::{Follower, Movements, Reached, SettlingError};
use crate::mechanics::sides::Sides;
use crate::mechanics::stability::{StabilityError, onset};
use crate::mechanics::stance::Stance;
use crate::mechanics::sway::Sway;

/// A row of rigid blocks that stands.
#[derive(Clone, Debug)]
pub struct RigidRow {
    /// Its blocks.
    pub row: Row,
    /// Its stance: undeformed, or on supports that have moved.
    pub standing: Stance,
    /// The push that starts it to the right and to the left where joints do not slip, in units of gravity.
    incipient_g: Sides<Option<f64>>,
    /// The push that starts it to either side where joints slip, in units of gravity.
    with_friction_g: Option<Sides<Option<f64>>>,
    /// Its first mechanism, if that is one of four links. A stack turns about an edge of its base.
    first: Option<FourLinks>,
}

impl RigidRow {
    /// A row, if it stands.
    ///
    /// # Errors
    /// When the row cannot carry its own weight.
    pub fn new(row: Row) -> Result<Self, StabilityError> {
        let push_g = |sway| onset(&row, sway).map(|onset| Some(onset?.acceleration_g));
        let incipient_g = Sides::try_of(push_g)?;
        // No motion is released from the first mechanism of a row with ties, whose barrier is known only without them. The impact model is
        // required, but not used: the first mechanism comes before any impact.
        let four_links =
            || FourLinks::of_row(&row.clone().without_ties(), ImpactModel::MaxRestitution).ok();
        Ok(Self {
            first: (row.supports == Supports::Both).then(four_links).flatten(),
            standing: Stance::undeformed(&row),
            row,
            incipient_g,
            with_friction_g: None,
        })
    }

    /// The names of its blocks.
    pub fn bodies(&self) -> Vec<String> {
        let blocks = 1..=self.row.blocks.len();
        blocks.map(|block| block.to_string()).collect()
    }

    /// The size of its samples, by whether joints slip, and whether pressures are reported.
    pub fn shape(&self, slips: bool, presses: bool) -> Shape {
        let joints = self.row.joints.len();
        let joints_if = |reported: bool| if reported { joints } else { 0 };
        Shape {
            bodies: self.row.blocks.len(),
            joints,
            slipping: joints_if(slips),
            pressing: joints_if(presses),
            ties: self.row.ties.len(),
        }
    }

    /// The push that starts it to that side, in units of gravity; `None` if no push starts it.
    pub fn incipient_acceleration_g(&self, sway: Sway) -> Option<f64> {
        *self.with_friction_g.unwrap_or(self.incipient_g).to(sway)
    }

    /// This row with joints that slip; the push that starts it to either side follows by limit analysis.
    ///
    /// # Errors
    /// When the row slides apart under its own weight, or this could not be determined.
    pub fn with_friction(mut self, coefficient: Option<f64>) -> Result<Self, FrictionError> {
        self.with_friction_g = None;
        let Some(coefficient) = coefficient else {
            return Ok(self);
        };
        if !friction::stands_at(&self.row, &self.standing, coefficient)? {
            return Err(FrictionError::CannotStand(coefficient));
        }
        let push_g = |sway| {
            friction::onset_of_standing(&self.row, &self.standing, coefficient, sway)
                .map(|onset| Some(onset?.acceleration_g))
        };
        self.with_friction_g = Some(Sides::try_of(push_g)?);
        Ok(self)
    }

    /// This row on supports that have moved: the push that starts it is that which makes its hinges give way, and where it stands on
    /// hinges its first mechanism is none of one degree of freedom whose barrier is known.
    ///
    /// # Errors
    /// When it falls on the way, or a tie breaks.
    pub fn on_supports(self, movements: &Movements) -> Result<Self, RowModelError> {
        let mut follower = Follower::new(&self.row)?;
        let way = |part: f64| *movements * part;
        if let Reached::Falls(part) = follower.move_supports(way, 0.0, 1.0)? {
            return Err(RowModelError::Falls(part));
        }
        if let Some(tie) = follower.stance.broken_tie() {
            return Err(RowModelError::TieBreaks(tie));
        }
        let first_g = |sway| follower.first_motion_g(sway).map_err(SettlingError::from);
        Ok(Self {
            incipient_g: Sides::try_of(first_g)?,
            with_friction_g: None,
            standing: follower.stance.clone(),
            // That of the blocks alone: energies are judged beside it.
            first: self.first,
            row: self.row,
        })
    }

    /// Energy that the first mechanism has to gain to overturn, in J, to the side where that is less; `None` where it is
    /// not known.
    #[must_use]
    pub fn barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        if self.is_on_hinges() || !self.row.ties.is_empty() {
            return None;
        }
        self.built_barrier_j(gravity_m_s2)
    }

    /// Its motion on this ground. Energies are judged beside the barrier of the row as it was built, without its ties, in J: where hinges are
    /// open a small push sets it in a motion of hardly any energy.
    pub fn task<'a>(
        &'a self,
        ground: &'a GroundMotion,
        gravity_m_s2: f64,
        settings: Settings,
    ) -> Task<'a> {
        let built_j = self.built_barrier_j(gravity_m_s2);
        // Where its feet part the feet do work, so it overturns at another energy, if at all.
        let parts = ground.right_foot_of(&self.row).is_some();
        let known = self.is_on_hinges() || self.row.ties.is_empty();
        let task = Task::new(&self.row, ground, gravity_m_s2, settings);
        Task {
            barrier_j: self.barrier_j(gravity_m_s2).filter(|_| !parts),
            built_barrier_j: built_j.unwrap_or(task.built_barrier_j),
            energy_scale_j: built_j.filter(|_| known).unwrap_or(0.0),
            ..task
        }
    }

    /// Whether it stands on hinges, of supports that have moved.
    fn is_on_hinges(&self) -> bool {
        self.standing.placement.open_corners() > 0
    }

    fn built_barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        match (&self.first, &self.row.blocks[..], &self.row.joints[..]) {
            (Some(row), ..) => {
                let links = Sway::ALL.iter().filter_map(|sway| row.link_from(*sway, 0));
                let barrier = links.map(|link| link.barrier).reduce(f64::min)?;
                Some(gravity_m_s2 * barrier * row.mass_unit_kg() * row.length_m())
            }
            (None, [block], [base]) => {
                let rise_m = rise_to_overturn_m(block.centre_m, base);
                Some(block.mass_kg * gravity_m_s2 * rise_m)
            }
            _ => None,
        }
    }

    /// Rotations of the blocks when the first mechanism is open this far.
    pub fn released(&self, initial: Initial) -> Result<Vec<f64>, ArgumentError> {
        let blocks = self.row.blocks.len();
        // Swaying right, in the frame in which the mechanism does so; the other side is its mirror image.
        let side = initial.sway.sign();
        let row = match &self.first {
            Some(row) if !self.is_on_hinges() => row,
            None if self.row.supports == Supports::Left => {
                return Ok(vec![-side * initial.rotation_rad; blocks]);
            }
            _ => {
                let allowed = "left out: this row does not start as a mechanism from which it could be released";
                let given_rad = initial.rotation_rad;
                return Err(ArgumentError::new("rotation_rad", given_rad, allowed));
            }
        };
        let first = row.link_from(initial.sway, 0);
        let link = first.expect("a row that starts as four links has its first mechanism");
        initial.check(link.limit_rad)?;
        let mut bodies_rad = link.mechanism.rotations(initial.rotation_rad);
        if initial.sway == Sway::Left {
            bodies_rad.reverse();
        }
        let hinges = row.hinges(0, initial.sway);
        let rotation_rad = |block: usize| {
            let before =
                |hinge: &&Hinge| matches!(hinge, Hinge::Joint { joint, .. } if *joint <= block);
            let body = hinges.iter().filter(before).count().checked_sub(1);
            side * body.and_then(|body| bodies_rad.get(body)).unwrap_or(&0.0)
        };
        Ok((0..blocks).map(rotation_rad).collect())
    }
}
