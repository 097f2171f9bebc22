//! An arch that rocks as four-link mechanisms.

use nalgebra::Vector2;
use thiserror::Error;

use super::chain::{Chain, Chains};
use super::impact::ImpactLaw;
use super::limit::LimitError;
use super::linkage::Linkage;
use crate::argument::ArgumentError;
use crate::mechanics::arch::Arch;
use crate::mechanics::chain::{Demand, Hinge, Link, MechanismChain, Motion};
use crate::mechanics::contact::ContactError;
use crate::mechanics::geometry::profile::Profile as _;
use crate::mechanics::sway::Sway;

/// An arch with its chain of four-link mechanisms under an impact model. The chain depends on neither size nor
/// material, and clones share it.
#[derive(Clone, Debug)]
pub struct FourLinkArch {
    arch: Arch,
    chains: Chains,
}

/// Why an arch does not rock as four-link mechanisms.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FourLinkError {
    /// It does not start as one.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// It is a free-standing stack.
    #[error("a stack on one support has no four links: give [free_hinges] or [elastic_joints]")]
    Stack,
    /// It has ties.
    #[error(
        "four links take no ties: what a tie pulls changes as the links move, and the mechanisms after impacts are found from \
         weights alone; give [free_hinges] or [elastic_joints]"
    )]
    Ties,
    /// A row of blocks does not start as four links to this side.
    #[error(
        "to the {side} four links do not describe this row of blocks ({error}); give [free_hinges] or \
         [elastic_joints], which take any mechanism", side = .sway.name()
    )]
    Row {
        /// To which side.
        sway: Sway,
        /// Why.
        error: LimitError,
    },
    /// It could not be determined whether the row stands.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The restitution coefficient is out of range.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
}

impl FourLinkArch {
    /// The arch under an impact model.
    ///
    /// # Errors
    /// When the arch cannot stand or does not start as a four-link mechanism, or when a prescribed restitution
    /// coefficient is not in 0 to 1.
    pub fn new(arch: Arch, law: impl Into<ImpactLaw>) -> Result<Self, FourLinkError> {
        let law = law.into();
        law.check()?;
        let incipient = arch.incipient()?.clone();
        let ring = arch.ring().shared();
        let chain = Chain::new([ring.clone(), ring], arch.sites(), incipient, law);
        Ok(Self {
            arch,
            chains: Chains::symmetric(chain),
        })
    }

    /// The arch.
    #[must_use]
    pub const fn arch(&self) -> &Arch {
        &self.arch
    }

    /// Its chain of mechanisms.
    #[must_use]
    pub fn chain(&self) -> &Chain {
        self.chains.from(Sway::Right)
    }

    /// An arch of the same shape with another mean radius, in metres, and the same chain.
    ///
    /// # Errors
    /// When it is outside 0.001 to 1e6.
    pub fn with_mean_radius_m(&self, mean_radius_m: f64) -> Result<Self, ArgumentError> {
        Ok(Self {
            arch: self.arch.clone().with_mean_radius_m(mean_radius_m)?,
            chains: self.chains.clone(),
        })
    }

    /// Unit of the impulses of an impact: N s per metre of depth and per rad/s of the closing mechanism.
    #[must_use]
    pub fn impulse_unit_n_s_per_m(&self) -> f64 {
        self.arch.density_kg_m3() * self.arch.mean_radius_m().powi(3)
    }
}

impl MechanismChain for FourLinkArch {
    type Mechanism = Linkage;

    fn length_m(&self) -> f64 {
        self.arch.mean_radius_m()
    }

    fn mass_unit_kg(&self) -> f64 {
        let radius_m = self.arch.mean_radius_m();
        self.arch.density_kg_m3() * self.arch.depth_m() * radius_m * radius_m
    }

    fn incipient_towards_g(&self, sway: Sway) -> f64 {
        self.chains.from(sway).incipient().acceleration_g
    }

    fn demand(&self, mechanism: &Linkage, motion: &Motion) -> Demand {
        mechanism.thrust_line(motion).demand(self.chain().sites())
    }

    fn demand_at_rest(&self, body_force_g: Vector2<f64>) -> Demand {
        self.chains.demand_at_rest(body_force_g)
    }

    fn eccentricity_ratios(&self, mechanism: &Linkage, motion: &Motion) -> Vec<Option<f64>> {
        let line = mechanism.thrust_line(motion);
        line.eccentricity_ratios(&self.arch.thrust_sections_rad())
    }

    fn eccentricity_ratios_at_rest(&self, body_force_g: Vector2<f64>) -> Vec<Option<f64>> {
        let line = self.chains.thrust_at_rest(body_force_g);
        line.eccentricity_ratios(&self.arch.thrust_sections_rad())
    }

    fn link_from(&self, first: Sway, impacts: usize) -> Option<&Link<Linkage>> {
        self.chains.link(first, impacts)
    }

    fn hinges(&self, impacts: usize, sway: Sway) -> Vec<Hinge> {
        self.chains.hinges(impacts, sway)
    }

    fn hinge_impulses(&self, impacts: usize, sway: Sway) -> Vec<Vector2<f64>> {
        self.chains.hinge_impulses(impacts, sway)
    }
}
