//! A masonry arch: a ring with its size and material.

use std::sync::Arc;

use nalgebra::Vector2;

use super::structure::{Demand, Hinge, Link, Motion, Structure};
use crate::mechanics::four_link::chain::Chain;
use crate::mechanics::four_link::linkage::Linkage;
use crate::mechanics::four_link::mechanism::Sway;
use crate::mechanics::four_link::thrust::ThrustLine;

/// An arch. Its chain of mechanisms does not depend on size or material, and may be shared.
#[derive(Clone, Debug)]
pub struct Arch {
    /// Mean radius in metres.
    pub mean_radius_m: f64,
    /// Depth out of plane in metres.
    pub depth_m: f64,
    /// Density in kg/m3.
    pub density_kg_m3: f64,
    /// Shape, and what follows from it.
    pub chain: Arc<Chain>,
}

impl Arch {
    /// Unit of the impulses of an impact: N s per metre of depth and per rad/s of the closing mechanism.
    #[must_use]
    pub fn impulse_unit_n_s_per_m(&self) -> f64 {
        self.density_kg_m3 * self.mean_radius_m.powi(3)
    }
}

impl Structure for Arch {
    type Mechanism = Linkage;

    fn length_m(&self) -> f64 {
        self.mean_radius_m
    }

    fn mass_unit_kg(&self) -> f64 {
        self.density_kg_m3 * self.depth_m * self.mean_radius_m * self.mean_radius_m
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
