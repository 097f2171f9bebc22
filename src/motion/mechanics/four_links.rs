//! Structures that rock as four links: an arch with hinges at sections of its ring, or a row of blocks between two supports with hinges at its
//! joints.

use std::sync::Arc;

use nalgebra::Vector2;
use thiserror::Error;

use super::arch::{DEPTH_M, MAGNITUDE};
use super::chain::MechanismState;
use super::contact::ContactError;
use super::four_link::chain::Chain;
use super::four_link::jointed::JointedProfile;
use super::four_link::limit::incipient_of;
use super::four_link::linkage::Linkage;
use super::four_link::mechanism::HingeSites;
use super::four_link::thrust::ThrustLine;
use super::stability::collapse_mechanism;
use crate::argument::{ArgumentError, require_within};
use crate::mechanics::{
    Arch, Demand, Hinge, ImpactLaw, LimitError, Link, MechanismChain, NoWallRatio, Profile as _,
    Row, Sides, Sway,
};

/// Structure with its sequences of four-link mechanisms under an impact law. The sequences depend on neither size nor material, and clones share
/// them.
#[derive(Clone, Debug)]
pub struct FourLinks {
    size: Size,
    /// Sections at which thrust lines are reported.
    sections: Vec<f64>,
    /// Sequence of mechanisms for a first sway to each side; both are the same for a symmetric structure.
    chains: Sides<Arc<Chain>>,
    /// True if the structure is its own mirror image.
    is_symmetric: bool,
}

/// The units of a structure.
#[derive(Clone, Copy, Debug)]
struct Size {
    length_m: f64,
    mass_kg: f64,
    impulse_n_s_per_m: f64,
}

impl Size {
    fn of(arch: &Arch) -> Self {
        let (length_m, density_kg_m3) = (arch.mean_radius_m, arch.density_kg_m3);
        Self {
            length_m,
            mass_kg: density_kg_m3 * arch.depth_m * length_m * length_m,
            impulse_n_s_per_m: density_kg_m3 * length_m.powi(3),
        }
    }
}

/// Reason why a structure does not rock as four links.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FourLinkError {
    /// The structure does not start as four links.
    #[error("{}{}", .0, if *.0 == LimitError::CannotStand { "" } else { VOUSSOIRS })]
    Limit(#[from] LimitError),
    /// The structure is a free-standing stack.
    #[error("a stack on one support has no four links: give [free_hinges] or [elastic_joints]")]
    Stack,
    /// The structure has ties.
    #[error(
        "four links cannot have ties: the tie force changes during the motion; give [free_hinges] or [elastic_joints]"
    )]
    Ties,
    /// The structure has constant forces.
    #[error(
        "four links cannot have constant forces (`thrust_n`, or `moves = false`, of [[load]]): mechanisms after impacts follow from \
         moving masses alone; give [free_hinges] or [elastic_joints]"
    )]
    ConstantForces,
    /// A row of blocks does not start as four links to this side.
    #[error(
        "to the {side} four links do not describe this row of blocks ({1}); give [free_hinges] or \
         [elastic_joints], which take any mechanism", side = .0.name()
    )]
    Row(Sway, LimitError),
    /// The stability of the row was not determined.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The top of the column is held.
    #[error(
        "holds the top of a column, for which there is no model of motion, because the impact of its two bodies is not computed: run `archrock limit`, \
         `capacity` or `verify`, without [free_hinges] and [elastic_joints], or leave [column.top] out"
    )]
    HeldTop,
    /// The restitution coefficient is out of range.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// The wall behind a column needs a restitution that is not given.
    #[error(transparent)]
    Wall(#[from] NoWallRatio),
}

const VOUSSOIRS: &str = "; `limit` and [free_hinges] take any mechanism of voussoirs";

impl FourLinkError {
    /// True if the structure is stable and does not start as four links.
    pub fn is_other_mechanism(&self) -> bool {
        matches!(self, Self::Limit(error) | Self::Row(_, error) if *error != LimitError::CannotStand)
    }
}

impl FourLinks {
    /// Four-link model of an arch.
    ///
    /// # Errors
    /// When the arch cannot stand or does not start as a four-link mechanism, or when a number of the law is not allowed.
    pub fn of_arch(arch: &Arch, law: impl Into<ImpactLaw>) -> Result<Self, FourLinkError> {
        let law = law.into();
        law.check()?;
        let incipient = arch.incipient()?.clone();
        let ring = arch.ring().to_shared();
        let chain = Chain::new([ring.clone(), ring], arch.sites(), incipient, law);
        let chain = Arc::new(chain);
        Ok(Self {
            size: Size::of(arch),
            sections: arch.thrust_sections_rad(),
            chains: Sides::of(|_| chain.clone()),
            is_symmetric: true,
        })
    }

    /// Four-link model of a row of blocks, with a depth of 1 m.
    ///
    /// # Errors
    /// If the row is a stack, has ties or constant forces, falls under its own weight, starts as another mechanism to either side, or if a number of the
    /// law is not allowed.
    pub fn of_row(row: &Row, law: impl Into<ImpactLaw>) -> Result<Self, FourLinkError> {
        let law = law.into();
        law.check()?;
        if row.constant_forces().next().is_some() {
            return Err(FourLinkError::ConstantForces);
        }
        if !row.ties.is_empty() {
            return Err(FourLinkError::Ties);
        }
        let profiles = [Some(row), row.mirrored().as_ref()].map(|row| JointedProfile::new(row?));
        let [Some(own), Some(mirrored)] = profiles else {
            return Err(FourLinkError::Stack);
        };
        if collapse_mechanism(row)?.is_some() {
            return Err(LimitError::CannotStand.into());
        }
        let sections = own.sections(0);
        let sites = HingeSites::Voussoirs(row.blocks.len());
        let [own, mirrored] = [own, mirrored].map(|profile| profile.to_shared());
        let chain = |sway| {
            let profiles = match sway {
                Sway::Right => [own.clone(), mirrored.clone()],
                Sway::Left => [mirrored.clone(), own.clone()],
            };
            let incipient = if sections.len() < 4 {
                Err(LimitError::NoPush)
            } else {
                incipient_of(&*profiles[0], sites)
            };
            let incipient = incipient.map_err(|error| FourLinkError::Row(sway, error))?;
            Ok::<_, FourLinkError>(Arc::new(Chain::new(profiles, sites, incipient, law)))
        };
        let chains = Sides::try_of(chain)?;
        let size = Size {
            length_m: row.size_m,
            mass_kg: row.mass_kg(),
            impulse_n_s_per_m: row.mass_kg() * row.size_m / DEPTH_M,
        };
        Ok(Self {
            size,
            sections,
            chains,
            is_symmetric: row.is_symmetric(),
        })
    }

    /// Whether the structure is its own mirror image.
    pub const fn is_symmetric(&self) -> bool {
        self.is_symmetric
    }

    /// Model of an arch with this shape and another size, which shares the sequences of mechanisms.
    pub fn with_size_of(&self, arch: &Arch) -> Self {
        Self {
            size: Size::of(arch),
            ..self.clone()
        }
    }

    /// Model with another depth out of plane, in metres. The depth affects only the impulses, which are per metre of depth; the masses of
    /// the blocks are given.
    ///
    /// # Errors
    /// When it is outside 0.001 to 1e6.
    pub fn with_depth_m(mut self, depth_m: f64) -> Result<Self, ArgumentError> {
        require_within("depth_m", depth_m, MAGNITUDE)?;
        self.size.impulse_n_s_per_m = self.size.mass_kg * self.size.length_m / depth_m;
        Ok(self)
    }

    /// Sequence of mechanisms after a first sway to the right; for a symmetric structure, to either side.
    pub fn chain(&self) -> &Chain {
        self.chain_from(Sway::Right)
    }

    /// Sequence of mechanisms after a first sway to this side.
    pub fn chain_from(&self, first: Sway) -> &Chain {
        self.chains.get(first)
    }

    /// Unit of the impulses of an impact: N s per metre of depth and per rad/s of the closing mechanism.
    pub const fn impulse_unit_n_s_per_m(&self) -> f64 {
        self.size.impulse_n_s_per_m
    }

    /// Thrust line at rest, seen such that a push to this side is one to the right.
    fn thrust_at_rest(&self, side: Sway, body_force_g: Vector2<f64>) -> ThrustLine {
        let [towards, away] = [side, side.opposite()].map(|side| &self.chain_from(side).incipient);
        let force_g = Vector2::new(side.sign() * body_force_g.x, body_force_g.y);
        ThrustLine::at_rest(towards, away, self.chain_from(side).profile(0), force_g)
    }
}

impl MechanismChain for FourLinks {
    type Mechanism = Linkage;

    fn length_m(&self) -> f64 {
        self.size.length_m
    }

    fn mass_unit_kg(&self) -> f64 {
        self.size.mass_kg
    }

    fn incipient_towards_g(&self, sway: Sway) -> f64 {
        self.chain_from(sway).incipient.acceleration_g
    }

    const THRUSTS: bool = true;

    fn demand_at_sections(
        &self,
        first: Sway,
        impacts: usize,
        mechanism: &Linkage,
        motion: &MechanismState,
    ) -> Demand {
        mechanism.demand_at_sections(motion, self.chain_from(first).sections(impacts))
    }

    fn demand(&self, mechanism: &Linkage, motion: &MechanismState) -> Demand {
        mechanism.thrust_line(motion).demand(self.chain().sites)
    }

    fn demand_at_rest(&self, body_force_g: Vector2<f64>) -> Demand {
        // A push to the left on a symmetric structure is the mirror image of one to the right, to the last bit.
        let side = match body_force_g.x < 0.0 {
            true => Sway::Left,
            false => Sway::Right,
        };
        let line = self.thrust_at_rest(side, body_force_g);
        line.demand(self.chain().sites)
    }

    fn eccentricity_ratios(
        &self,
        mechanism: &Linkage,
        motion: &MechanismState,
    ) -> Vec<Option<f64>> {
        let line = mechanism.thrust_line(motion);
        line.eccentricity_ratios(&self.sections)
    }

    fn eccentricity_ratios_at_rest(&self, body_force_g: Vector2<f64>) -> Vec<Option<f64>> {
        let line = self.thrust_at_rest(Sway::Right, body_force_g);
        line.eccentricity_ratios(&self.sections)
    }

    fn link_from(&self, first: Sway, impacts: usize) -> Option<&Link<Linkage>> {
        let link = self.chain_from(first).link(impacts);
        link.map(|link| &link.link)
    }

    fn repeats_from(&self, first: Sway) -> Option<usize> {
        self.chain_from(first).repeats_from()
    }

    fn hinges(&self, impacts: usize, sway: Sway) -> Vec<Hinge> {
        let chain = self.chain_from(sway.after(impacts));
        chain.link(impacts).map_or(Vec::new(), |link| {
            let profile = chain.profile(impacts);
            let hinges = link.mechanism.named_hinges_from_left(profile, sway);
            hinges.to_vec()
        })
    }

    fn hinge_impulses(&self, impacts: usize, sway: Sway) -> Vec<Vector2<f64>> {
        let link = self.chain_from(sway.after(impacts)).link(impacts);
        let line = link.and_then(|link| link.impulse_line.as_ref());
        line.map_or(Vec::new(), |line| {
            line.hinge_impulses_from_left(sway).to_vec()
        })
    }
}
