//! An arch that rocks as four-link mechanisms.

use std::sync::Arc;

use nalgebra::Vector2;
use thiserror::Error;

use super::chain::Chain;
use super::impact::ImpactModel;
use super::limit::LimitError;
use super::linkage::Linkage;
use super::thrust::ThrustLine;
use crate::argument::ArgumentError;
use crate::mechanics::arch::Arch;
use crate::mechanics::chain::{Demand, Hinge, Link, MechanismChain, Motion};
use crate::mechanics::sway::Sway;

/// An arch with its chain of four-link mechanisms under an impact model. The chain depends on neither size nor
/// material, and clones share it.
#[derive(Clone, Debug)]
pub struct FourLinkArch {
    arch: Arch,
    chain: Arc<Chain>,
}

/// Why an arch does not rock as four-link mechanisms.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FourLinkError {
    /// It does not start as one.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// It is a row of blocks of another shape.
    #[error("four links are for circular arches without piers and loads: give [free_hinges]")]
    Blocks,
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
    pub fn new(arch: Arch, model: ImpactModel) -> Result<Self, FourLinkError> {
        model.check()?;
        let incipient = arch.incipient()?.clone();
        let chain = Chain::new(arch.ring(), arch.sites(), incipient, model);
        Ok(Self {
            arch,
            chain: Arc::new(chain),
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
        &self.chain
    }

    /// An arch of the same shape with another mean radius, in metres, and the same chain.
    ///
    /// # Errors
    /// When it is outside 0.001 to 1e6.
    pub fn with_mean_radius_m(&self, mean_radius_m: f64) -> Result<Self, ArgumentError> {
        Ok(Self {
            arch: self.arch.clone().with_mean_radius_m(mean_radius_m)?,
            chain: self.chain.clone(),
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

    fn incipient_g(&self) -> f64 {
        self.chain.incipient().acceleration_g
    }

    fn demand(&self, mechanism: &Linkage, motion: &Motion) -> Demand {
        mechanism.thrust_line(motion).demand(self.chain.sites())
    }

    fn demand_at_rest(&self, body_force_g: Vector2<f64>) -> Demand {
        ThrustLine::at_rest(self.chain.incipient(), self.chain.ring(), body_force_g)
            .demand(self.chain.sites())
    }

    fn eccentricity_ratios(&self, mechanism: &Linkage, motion: &Motion) -> Vec<Option<f64>> {
        let line = mechanism.thrust_line(motion);
        line.eccentricity_ratios(&self.arch.thrust_sections_rad())
    }

    fn eccentricity_ratios_at_rest(&self, body_force_g: Vector2<f64>) -> Vec<Option<f64>> {
        let (incipient, ring) = (self.chain.incipient(), self.chain.ring());
        let line = ThrustLine::at_rest(incipient, ring, body_force_g);
        line.eccentricity_ratios(&self.arch.thrust_sections_rad())
    }

    fn link(&self, impacts: usize) -> Option<&Link<Linkage>> {
        self.chain.link(impacts).map(|link| &link.link)
    }

    fn hinges(&self, impacts: usize, sway: Sway) -> Vec<Hinge> {
        self.chain.link(impacts).map_or(Vec::new(), |link| {
            let hinges = link.mechanism.hinges_from_left(self.chain.ring(), sway);
            hinges
                .map(|(angle_rad, edge)| Hinge::Section { angle_rad, edge })
                .to_vec()
        })
    }

    fn hinge_impulses(&self, impacts: usize, sway: Sway) -> Vec<Vector2<f64>> {
        let line = self
            .chain
            .link(impacts)
            .and_then(|link| link.impulse_line.as_ref());
        line.map_or(Vec::new(), |line| {
            line.hinge_impulses_from_left(sway).to_vec()
        })
    }
}
