//! Sequence of mechanisms of an arch, from impact to impact.
//!
//! The mechanism after an impact depends on the mechanism before it, not on the velocity. The sequence therefore follows from the mechanism that
//! starts at the incipient acceleration, and is a property of the arch. Links are computed at the first request and cached. Threads may share a
//! chain.

use std::sync::{Arc, OnceLock};

use super::impact::{Impact, impact, impact_onto};
use super::impulse_line::ImpulseLine;
use super::limit::Incipient;
use super::linkage::Linkage;
use super::mechanism::{FourLink, HingeSites};
use super::thrust::ProfileSection;
use crate::mechanics::chain::critical_rad;
use crate::mechanics::{ImpactLaw, Link, Profile};

/// Tolerance, in radians, within which a link has the hinges of the link two before it, so that the last two links repeat. The effect on `r`, which
/// is stationary at a maximum, is far below the accuracy of the search.
const REPETITION_RAD: f64 = 1e-9;

/// Maximum number of links. Chains converge to a repeating pair within 20 to 120 links; a longer one (none is known) repeats its last two links.
const MAX_CHAIN_LENGTH: usize = 256;

/// A mechanism of the chain: in the undeformed configuration, and in motion.
#[derive(Clone, Debug)]
pub struct ArchLink {
    /// The mechanism in the undeformed configuration.
    pub mechanism: FourLink,
    /// Mechanism at finite rotations, with the impact that starts it.
    pub link: Link<Linkage>,
    /// Impulses of the impact that starts the mechanism, per unit closing rate. `None` for the first link, and for a prescribed restitution
    /// coefficient.
    pub impulse_line: Option<ImpulseLine>,
}

impl ArchLink {
    fn new(profile: &dyn Profile, impact: Impact, law: ImpactLaw) -> Self {
        let linkage = Linkage::new(profile, &impact.mechanism);
        let limit_rad = linkage.limit_rad();
        let critical_rad = critical_rad(&linkage, limit_rad);
        let (rate_ratio, restitution) =
            law.rate_and_restitution(impact.rate_ratio, impact.restitution);
        Self {
            mechanism: impact.mechanism,
            link: Link::new(linkage, critical_rad, limit_rad, rate_ratio, restitution),
            // The momentum theorems hold only for the restitution that they give.
            impulse_line: impact.impulse_line.filter(|_| law.is_theory()),
        }
    }
}

/// Profile with its sequence of mechanisms. These do not depend on size, density or ground motion.
#[derive(Debug)]
pub struct Chain {
    /// The profile in the frames in which the mechanisms with an even and with an odd number of impacts sway right.
    profiles: [Arc<dyn Profile>; 2],
    /// Sections of both profiles at which the excess of thrust lines is computed.
    sections: [Vec<ProfileSection>; 2],
    /// Sections at which hinges may form.
    pub sites: HingeSites,
    law: ImpactLaw,
    /// Onset of rocking; its mechanism is link 0.
    pub incipient: Incipient,
    /// Boxed, because a chain has room for many links and usually needs few.
    links: Box<[OnceLock<Option<Box<ArchLink>>>]>,
    /// First link of the pair that repeats; the second has the mechanism of the link before it.
    pair: OnceLock<usize>,
}

impl Chain {
    /// Sequence of mechanisms of a profile and its mirror image under an impact law, from its onset by
    /// [`incipient`](super::limit::incipient_of).
    pub(crate) fn new(
        profiles: [Arc<dyn Profile>; 2],
        sites: HingeSites,
        incipient: Incipient,
        law: ImpactLaw,
    ) -> Self {
        let sections = profiles
            .each_ref()
            .map(|profile| ProfileSection::all(&**profile, sites));
        Self {
            profiles,
            sections,
            sites,
            law,
            incipient,
            links: (0..MAX_CHAIN_LENGTH).map(|_| OnceLock::new()).collect(),
            pair: OnceLock::new(),
        }
    }

    /// Profile in the frame in which the mechanism after `impacts` impacts sways right.
    pub fn profile(&self, impacts: usize) -> &dyn Profile {
        &*self.profiles[impacts % 2]
    }

    /// Sections of that profile at which the excess of thrust lines is computed.
    pub(crate) fn sections(&self, impacts: usize) -> &[ProfileSection] {
        &self.sections[impacts % 2]
    }

    /// Index of the first link of the pair that repeats; `None` while it is not known.
    pub fn repeats_from(&self) -> Option<usize> {
        self.pair.get().copied()
    }

    /// Mechanism after `index` impacts. `None` if an earlier impact stops the ring, because no admissible mechanism can follow.
    pub fn link(&self, index: usize) -> Option<&ArchLink> {
        for known in 0..MAX_CHAIN_LENGTH {
            let wanted = match self.pair.get() {
                Some(pair) if index > *pair => pair + (index - pair) % 2,
                _ => index,
            };
            if let Some(link) = self.links.get(wanted).and_then(OnceLock::get) {
                return link.as_deref();
            }
            self.links[known].get_or_init(|| self.compute(known).map(Box::new));
        }
        self.link(index)
    }

    fn compute(&self, index: usize) -> Option<ArchLink> {
        let Some(previous) = index.checked_sub(1) else {
            let first = Impact {
                mechanism: self.incipient.mechanism,
                rate_ratio: 1.0,
                restitution: 1.0,
                impulse_line: None,
            };
            let theory = ImpactLaw::from(self.law.model);
            return Some(ArchLink::new(self.profile(index), first, theory));
        };
        let (profile, model) = (self.profile(index), self.law.model);
        let mechanism = |index: usize| Some(self.links[index].get()?.as_ref()?.mechanism);
        let closing = mechanism(previous)?;
        if index == MAX_CHAIN_LENGTH - 1 {
            self.pair.get_or_init(|| previous);
        }
        let impact = if self.pair.get() == Some(&previous) {
            impact_onto(mechanism(previous - 1)?, &closing, profile, model)?
        } else {
            impact(&closing, profile, self.sites, model)?
        };
        if let Some(earlier) = previous.checked_sub(1).and_then(mechanism) {
            let (hinges, earlier) = (impact.mechanism.hinges_rad, earlier.hinges_rad);
            if (0..4).all(|i| (hinges[i] - earlier[i]).abs() < REPETITION_RAD) {
                self.pair.get_or_init(|| index);
            }
        }
        Some(ArchLink::new(profile, impact, self.law))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::chain::Mechanism as _;
    use crate::mechanics::four_link::impact::ImpactModel;
    use crate::mechanics::four_link::limit::incipient;
    use crate::mechanics::geometry::ring::Ring;

    fn chain(thickness_ratio: f64, embrace_deg: f64, sites: HingeSites) -> Chain {
        let ring = Ring::new(thickness_ratio, embrace_deg.to_radians()).unwrap();
        let onset = incipient(&ring, sites).unwrap();
        Chain::new(
            [ring.to_shared(), ring.to_shared()],
            sites,
            onset,
            ImpactModel::MaxRestitution.into(),
        )
    }

    #[test]
    fn links_do_not_depend_on_the_order_of_calls() {
        let (forwards, at_once) = (
            chain(0.15, 180.0, HingeSites::Anywhere),
            chain(0.15, 180.0, HingeSites::Anywhere),
        );
        let stepwise: Vec<_> = (0..150)
            .map(|i| forwards.link(i).unwrap().link.restitution)
            .collect();
        for index in [149, 30, 148, 0, 149] {
            let restitution = at_once.link(index).unwrap().link.restitution;
            assert_eq!(restitution.to_bits(), stepwise[index].to_bits(), "{index}");
        }
    }

    #[test]
    fn the_chain_ends_in_a_pair() {
        for chain in [
            chain(0.15, 157.5, HingeSites::Voussoirs(7)),
            chain(0.15, 157.5, HingeSites::Anywhere),
            chain(0.12, 180.0, HingeSites::Anywhere),
        ] {
            let hinges = |i| chain.link(i).unwrap().mechanism.hinges_rad;
            assert_eq!(hinges(400), hinges(402));
            let pair = *chain.pair.get().unwrap();
            assert!(pair < MAX_CHAIN_LENGTH - 2, "{pair}");
            // Each link of the pair keeps the energy that its own impact leaves, also where the chain closes.
            for index in pair..pair + 4 {
                let (before, after) = (chain.link(index).unwrap(), chain.link(index + 1).unwrap());
                let inertia = |link: &ArchLink| link.link.mechanism.coefficients(0.0).inertia;
                let kept = after.link.rate_ratio.powi(2) * inertia(after) / inertia(before);
                assert!((kept / after.link.restitution - 1.0).abs() < 1e-13);
            }
        }
    }
}
