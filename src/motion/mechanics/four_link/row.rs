//! A row of blocks between two supports that rocks as four-link mechanisms, hinges at its joints.

use nalgebra::Vector2;

use super::arch::FourLinkError;
use super::chain::{Chain, Chains};
use super::impact::ImpactLaw;
use super::limit::{Incipient, LimitError, incipient_of};
use super::linkage::Linkage;
use super::mechanism::HingeSites;
use crate::argument::{ArgumentError, within};
use crate::mechanics::arch;
use crate::mechanics::blocks::Row;
use crate::mechanics::chain::{Demand, Hinge, Link, MechanismChain, Motion};
use crate::mechanics::geometry::profile::{JointedProfile, Profile as _};
use crate::mechanics::stability::falls;
use crate::mechanics::sway::Sway;

/// A row with its chains of four-link mechanisms after a first sway to either side.
#[derive(Clone, Debug)]
pub struct FourLinkRow {
    length_m: f64,
    mass_unit_kg: f64,
    depth_m: f64,
    chains: Chains,
}

impl FourLinkRow {
    /// The row under an impact law.
    ///
    /// # Errors
    /// When it is a stack, has ties, falls under its own weight, starts as another mechanism to either side, or the law has a
    /// number that is not allowed.
    pub fn new(row: &Row, law: impl Into<ImpactLaw>) -> Result<Self, FourLinkError> {
        let law = law.into();
        law.check()?;
        if !row.ties().is_empty() {
            return Err(FourLinkError::Ties);
        }
        let (Some(own), Some(mirrored)) = (
            JointedProfile::new(row),
            row.mirrored().as_ref().and_then(JointedProfile::new),
        ) else {
            return Err(FourLinkError::Stack);
        };
        if falls(row)?.is_some() {
            return Err(LimitError::CannotStand.into());
        }
        let sites = HingeSites::Voussoirs(row.blocks().len());
        let onset = |profile: &JointedProfile, sway| -> Result<Incipient, FourLinkError> {
            if own.joints() < 4 {
                let error = LimitError::NoPush;
                return Err(FourLinkError::Row { sway, error });
            }
            incipient_of(profile, sites).map_err(|error| FourLinkError::Row { sway, error })
        };
        let (right, left) = (onset(&own, Sway::Right)?, onset(&mirrored, Sway::Left)?);
        let [own, mirrored] = [own, mirrored].map(|profile| profile.shared());
        let profiles = [own.clone(), mirrored.clone()];
        Ok(Self {
            length_m: row.size_m(),
            mass_unit_kg: row.mass_kg(),
            depth_m: arch::DEPTH_M,
            chains: Chains::new(
                Chain::new(profiles, sites, right, law),
                Chain::new([mirrored, own], sites, left, law),
            ),
        })
    }

    /// The same row with its depth out of plane in metres, which is 1 m unless given. It affects only the impulses, which
    /// are given per metre of depth: the blocks have their masses.
    ///
    /// # Errors
    /// When it is outside 0.001 to 1e6.
    pub fn with_depth_m(self, depth_m: f64) -> Result<Self, ArgumentError> {
        Ok(Self {
            depth_m: within("depth_m", depth_m, arch::MAGNITUDE)?,
            ..self
        })
    }

    /// The chain of mechanisms after a first sway to this side.
    #[must_use]
    pub fn chain(&self, first: Sway) -> &Chain {
        self.chains.from(first)
    }

    /// Unit of the impulses of an impact: N s per metre of depth and per rad/s of the closing mechanism.
    #[must_use]
    pub fn impulse_unit_n_s_per_m(&self) -> f64 {
        self.mass_unit_kg * self.length_m / self.depth_m
    }
}

impl MechanismChain for FourLinkRow {
    type Mechanism = Linkage;

    fn length_m(&self) -> f64 {
        self.length_m
    }

    fn mass_unit_kg(&self) -> f64 {
        self.mass_unit_kg
    }

    fn incipient_towards_g(&self, sway: Sway) -> f64 {
        self.chains.from(sway).incipient().acceleration_g
    }

    fn demand(&self, mechanism: &Linkage, motion: &Motion) -> Demand {
        let sites = self.chain(Sway::Right).sites();
        mechanism.thrust_line(motion).demand(sites)
    }

    fn demand_at_rest(&self, body_force_g: Vector2<f64>) -> Demand {
        self.chains.demand_at_rest(body_force_g)
    }

    fn eccentricity_ratios(&self, mechanism: &Linkage, motion: &Motion) -> Vec<Option<f64>> {
        let sections = self.chain(Sway::Right).profile(0).sections(0);
        mechanism.thrust_line(motion).eccentricity_ratios(&sections)
    }

    fn eccentricity_ratios_at_rest(&self, body_force_g: Vector2<f64>) -> Vec<Option<f64>> {
        let sections = self.chain(Sway::Right).profile(0).sections(0);
        let line = self.chains.thrust_at_rest(body_force_g);
        line.eccentricity_ratios(&sections)
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
