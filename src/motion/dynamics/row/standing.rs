//! A row of rigid blocks before it moves: push of the first motion, and first mechanism.

use super::input::rise_to_overturn_m;
use crate::argument::ArgumentError;
use crate::dynamics::request::Initial;
use crate::dynamics::{GroundMotion, MotionInput, RowModelError, Settings};
use crate::mechanics::stability::onset;
use crate::mechanics::{
    Edge, Follower, FourLinks, FrictionError, Hinge, ImpactModel, Mechanism, MechanismChain,
    Movements, Row, RowState, SettlingError, Sides, StabilityError, Supports, Sway, friction,
};

/// Stable row of rigid blocks.
#[derive(Clone, Debug)]
pub struct RigidRow {
    /// Blocks and joints.
    pub row: Row,
    /// State in equilibrium: undeformed, or on moved supports.
    pub standing: RowState,
    /// Push of the first motion to the right and to the left without slip, in multiples of gravity; `None` if no push moves the row.
    incipient_g: Sides<Option<f64>>,
    /// Push of the first motion to either side with slip, in multiples of gravity; `None` without friction coefficient.
    with_friction_g: Option<Sides<Option<f64>>>,
    /// First mechanism, if it has four links; `None` for other mechanisms and for stacks, which turn about an edge of their base.
    first_mechanism: Option<FourLinks>,
    /// Side of a wall behind a stack, which carries every push towards it.
    wall_behind: Option<Sway>,
}

impl RigidRow {
    /// Model of a stable row.
    ///
    /// # Errors
    /// If the row does not carry its own weight.
    pub fn new(row: Row) -> Result<Self, StabilityError> {
        let push_g = |sway| onset(&row, sway).map(|onset| Some(onset?.acceleration_g));
        let incipient_g = Sides::try_of(push_g)?;
        // No motion starts from the first mechanism of a row with ties, and the barrier is known only without ties. The impact model is a required
        // argument without effect: the first mechanism precedes all impacts.
        let four_links =
            || FourLinks::of_row(&row.clone().without_ties(), ImpactModel::MaxRestitution).ok();
        Ok(Self {
            first_mechanism: (row.supports == Supports::Both).then(four_links).flatten(),
            standing: RowState::undeformed(&row),
            row,
            incipient_g,
            with_friction_g: None,
            wall_behind: None,
        })
    }

    /// This stack with a wall behind it on this side.
    #[must_use]
    pub fn before_wall(self, side: Option<Sway>) -> Self {
        Self {
            wall_behind: side,
            ..self
        }
    }

    /// Whether the row is its own mirror image, without moved supports and without a wall.
    pub fn is_symmetric(&self) -> bool {
        self.wall_behind.is_none() && !self.is_on_hinges() && self.row.is_symmetric()
    }

    /// Names of the blocks.
    pub fn bodies(&self) -> Vec<String> {
        let blocks = 1..=self.row.blocks.len();
        blocks.map(|block| block.to_string()).collect()
    }

    /// Push of the first motion to a side, in multiples of gravity; `None` if no push moves the row.
    pub fn incipient_acceleration_g(&self, sway: Sway) -> Option<f64> {
        let start_g = *self.with_friction_g.unwrap_or(self.incipient_g).get(sway);
        start_g.filter(|_| self.wall_behind != Some(sway))
    }

    /// This row with sliding joints; limit analysis gives the push of the first motion to either side.
    ///
    /// # Errors
    /// If the row slides apart under its own weight, or this was not determined.
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

    /// This row on moved supports. The first motion is then a snap of the hinges. On hinges the first mechanism has no single degree of
    /// freedom with a known barrier.
    ///
    /// # Errors
    /// If the row falls or a tie breaks during the movement.
    pub fn on_supports(self, movements: &Movements) -> Result<Self, RowModelError> {
        let mut follower = Follower::new(&self.row)?;
        let way = |part: f64| *movements * part;
        if let Some(part) = follower.move_supports(way, 0.0, 1.0)? {
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
            // The mechanism of the undeformed row gives the scale of energies.
            first_mechanism: self.first_mechanism,
            row: self.row,
            wall_behind: self.wall_behind,
        })
    }

    /// Energy in J that the first mechanism needs to overturn, to the weaker side; `None` if unknown.
    pub fn barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        if self.is_on_hinges() || !self.row.ties.is_empty() {
            return None;
        }
        self.undeformed_barrier_j(gravity_m_s2)
    }

    /// Input to compute the motion on a ground motion. Its scale of energies is the barrier, in J, of the undeformed row without ties:
    /// with open hinges, even a small push causes a motion with almost no energy.
    pub fn input<'a>(
        &'a self,
        ground: &'a GroundMotion,
        gravity_m_s2: f64,
        settings: Settings,
    ) -> MotionInput<'a> {
        let built_j = self.undeformed_barrier_j(gravity_m_s2);
        // If the feet move apart they do work, and the barrier is unknown.
        let parts = ground.right_foot_of(&self.row).is_some();
        let known = self.is_on_hinges() || self.row.ties.is_empty();
        let input = MotionInput::new(&self.row, ground, gravity_m_s2, settings);
        MotionInput {
            barrier_j: self.barrier_j(gravity_m_s2).filter(|_| !parts),
            undeformed_barrier_j: built_j.unwrap_or(input.undeformed_barrier_j),
            energy_scale_j: built_j.filter(|_| known).unwrap_or(0.0),
            ..input
        }
    }

    /// Whether the row stands on hinges of moved supports.
    fn is_on_hinges(&self) -> bool {
        self.standing.placement.open_corners() > 0
    }

    fn undeformed_barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        match (
            &self.first_mechanism,
            &self.row.blocks[..],
            &self.row.joints[..],
        ) {
            (Some(row), ..) => {
                let links = Sway::ALL.iter().filter_map(|sway| row.link_from(*sway, 0));
                let barrier = links.map(|link| link.barrier).reduce(f64::min)?;
                Some(gravity_m_s2 * barrier * row.mass_unit_kg() * row.length_m())
            }
            (None, [block], [base]) => {
                let edges = match self.wall_behind {
                    None => Edge::ALL,
                    Some(Sway::Right) => &[Edge::Intrados],
                    Some(Sway::Left) => &[Edge::Extrados],
                };
                let rise_m = rise_to_overturn_m(block.centre_m, base, edges);
                Some(block.mass_kg * gravity_m_s2 * rise_m)
            }
            _ => None,
        }
    }

    /// Rotations and rates of the blocks at a given opening of the first mechanism.
    ///
    /// # Errors
    /// If the rotation is too large, or the row does not start with a mechanism of one degree of freedom.
    pub fn release(&self, initial: Initial) -> Result<Release, ArgumentError> {
        let blocks = self.row.blocks.len();
        // The mechanism is described in the frame in which it sways right; a sway to the left is reflected.
        let side = initial.sway.sign();
        let row = match &self.first_mechanism {
            Some(row) if !self.is_on_hinges() => row,
            None if self.row.supports == Supports::Left => {
                return Ok(Release {
                    rotations_rad: vec![-side * initial.rotation_rad; blocks],
                    rates_rad_s: vec![-side * initial.rate_rad_s; blocks],
                });
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
        let hinges = row.hinges(0, initial.sway);
        let of_blocks = |mut bodies: [f64; 3]| {
            if initial.sway == Sway::Left {
                bodies.reverse();
            }
            let of_block = |block: usize| {
                let before =
                    |hinge: &&Hinge| matches!(hinge, Hinge::Joint { joint, .. } if *joint <= block);
                let body = hinges.iter().filter(before).count().checked_sub(1);
                side * body.and_then(|body| bodies.get(body)).unwrap_or(&0.0)
            };
            (0..blocks).map(of_block).collect()
        };
        let unit_rates = link.mechanism.rotation_rates(initial.rotation_rad);
        // Without rotation all joints are closed; rounding errors would open some, and end in an impact at once.
        let rotations_rad = match initial.rotation_rad {
            0.0 => [0.0; 3],
            rotation_rad => link.mechanism.rotations(rotation_rad),
        };
        Ok(Release {
            rotations_rad: of_blocks(rotations_rad),
            rates_rad_s: of_blocks(unit_rates.map(|rate| rate * initial.rate_rad_s)),
        })
    }
}

/// Rotations of the blocks from which a row is released, in radians, and their rates in rad/s, anticlockwise.
#[derive(Clone, Debug)]
pub struct Release {
    pub rotations_rad: Vec<f64>,
    pub rates_rad_s: Vec<f64>,
}

impl Release {
    /// Whether blocks have a rate.
    pub fn has_rate(&self) -> bool {
        self.rates_rad_s.iter().any(|rate| *rate != 0.0)
    }
}
