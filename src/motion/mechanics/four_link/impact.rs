//! Impact at the closure of all hinges: momentum theorems, restitution, and the mechanism that follows.
//!
//! The restitution coefficient `r` is the kinetic energy after the impact over that before it, as in the
//! paper and in Housner.

use super::impulse_line::ImpulseLine;
use super::mechanism::{EDGES, FourLink, HingeSites};
use super::search::{Lattice, Objective, Quadruple, best_mechanism};
use crate::argument::{ArgumentError, require_within};
use crate::mechanics::geometry::field::Side;
use crate::mechanics::{Field, Profile, Twist};

listed! {
    /// Rule that selects the mechanism after an impact.
    ///
    /// All rules assume that the four hinges close simultaneously, that the arch continues with four hinges, and that no joint slides and nothing
    /// rebounds.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum ImpactModel {
        /// The mechanism that keeps the most kinetic energy.
        ///
        /// Assumes that hinges form wherever the least energy is lost, and that impulses pass through the hinges
        /// of the new mechanism only, Eqs. (7)-(10). The model of the paper. The projection onto all admissible
        /// fields ([`project`](super::project)) shows how far four hinges are from the smallest possible loss.
        MaxRestitution = "max_restitution",
        /// Hinges at the opposite edges of the sections that close.
        ///
        /// Assumes that the impacts at the closing sections are the only ones, as at the base of Housner's column;
        /// Fig. 3 of the paper, which attributes it to its references [2, 3]. The rate follows from the same
        /// momentum theorems.
        SameSections = "same_sections",
        /// Hinges at the mirror image of those that close.
        ///
        /// Assumes that the arch sways back as it swayed out. The paper names it as the usual choice of the
        /// literature, and objects that it loses more energy than necessary. The rate follows from the same
        /// momentum theorems, with impulses at the new hinges; its impulse line leaves the ring.
        Mirrored = "mirrored",
        /// Mirrored hinges, and a given restitution coefficient in place of the momentum theorems.
        ///
        /// Assumes that the loss is known from elsewhere, such as an experiment or another computation. There are no
        /// impulses to report: those at the hinges would have to obey the momentum theorems.
        Prescribed {
            /// Energy after the impact over energy before it, from 0 to 1.
            restitution: f64 = 0.0
        } = "prescribed",
    }
}

impl ImpactModel {
    /// Checks a prescribed restitution coefficient.
    pub(crate) fn check(self) -> Result<(), ArgumentError> {
        if let Self::Prescribed { restitution } = self {
            require_within("restitution", restitution, 0.0..=1.0)?;
        }
        Ok(())
    }

    /// Whether the restitution coefficient is prescribed, so that the momentum theorems do not hold.
    pub const fn is_prescribed(self) -> bool {
        matches!(self, Self::Prescribed { .. })
    }
}

/// Impact model, with a factor on its restitution coefficient.
///
/// Experiments lose more or less energy than the momentum theorems predict. The factor adjusts the restitution coefficient to measured values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactLaw {
    /// The model.
    pub model: ImpactModel,
    /// Factor on its restitution coefficient, a ratio of kinetic energies; the product is at most one.
    pub restitution_factor: f64,
}

impl From<ImpactModel> for ImpactLaw {
    fn from(model: ImpactModel) -> Self {
        Self {
            model,
            restitution_factor: 1.0,
        }
    }
}

impl ImpactLaw {
    /// Checks a prescribed restitution coefficient and the factor.
    pub(crate) fn check(self) -> Result<(), ArgumentError> {
        self.model.check()?;
        require_within("restitution_factor", self.restitution_factor, 0.0..=100.0).map(|_| ())
    }

    /// Rate and restitution coefficient of an impact by this law, from those of its model.
    pub(crate) fn rate_and_restitution(self, rate_ratio: f64, restitution: f64) -> (f64, f64) {
        if self.is_theory() || restitution <= 0.0 {
            return (rate_ratio, restitution);
        }
        let measured = (self.restitution_factor * restitution).min(1.0);
        (rate_ratio * (measured / restitution).sqrt(), measured)
    }

    /// Whether the factor is one, so that the momentum theorems hold.
    pub fn is_theory(self) -> bool {
        self.restitution_factor == 1.0
    }
}

/// Impact of a mechanism that closes at unit rate, with the mechanism that follows.
///
/// The mechanism after the impact sways to the other side. It is given in the frame in which that side is the right: the mirror image of the frame of
/// the mechanism before.
#[derive(Clone, Debug)]
pub struct Impact {
    /// The mechanism after the impact, in its own frame.
    pub mechanism: FourLink,
    /// Rate of the mechanism after the impact for a unit closing rate before it.
    pub rate_ratio: f64,
    /// Restitution coefficient: kinetic energy after over before.
    pub restitution: f64,
    /// The impulses, per unit closing rate, in the frame of the mechanism after; `None` where the
    /// restitution coefficient is prescribed, because the momentum theorems then do not hold.
    pub impulse_line: Option<ImpulseLine>,
}

/// Velocity field of the ring when `mechanism` closes at unit rate, in the frame of the mechanism that follows.
pub fn closing_field(mechanism: &FourLink, profile: &dyn Profile) -> Field {
    mechanism.field().scaled(-1.0).mirrored(profile)
}

/// The impact when `mechanism` closes, by the given model; `None` when no admissible mechanism can follow. The profile is given in the frame
/// of the mechanism that follows: the mirrored one, for a structure that is not its own mirror image.
pub fn impact(
    mechanism: &FourLink,
    profile: &dyn Profile,
    sites: HingeSites,
    model: ImpactModel,
) -> Option<Impact> {
    let next = match model {
        ImpactModel::MaxRestitution => {
            most_energetic(&closing_field(mechanism, profile), profile, sites)?
        }
        ImpactModel::SameSections => {
            let [a, b, c, d] = mechanism.hinges_rad.map(|angle| profile.end() - angle);
            FourLink::new(profile, [d, c, b, a])?
        }
        // The mirror image of a mechanism has, in its own frame, the same hinges.
        ImpactModel::Mirrored | ImpactModel::Prescribed { .. } => {
            FourLink::new(profile, mechanism.hinges_rad)?
        }
    };
    impact_onto(next, mechanism, profile, model)
}

/// Impact of a closing `mechanism` if `next` follows; `None` if `next` would have to move backwards.
pub(crate) fn impact_onto(
    next: FourLink,
    mechanism: &FourLink,
    profile: &dyn Profile,
    model: ImpactModel,
) -> Option<Impact> {
    let closing = closing_field(mechanism, profile);
    let (rate_ratio, restitution) = match model {
        ImpactModel::Prescribed { restitution } => (restitution.sqrt(), restitution),
        _ => projection(&next, &closing, profile),
    };
    (rate_ratio > 0.0).then(|| Impact {
        mechanism: next,
        rate_ratio,
        restitution,
        impulse_line: (!model.is_prescribed()).then(|| {
            let opening = next.field().scaled(rate_ratio);
            ImpulseLine::new(profile, &next, &closing, &opening)
        }),
    })
}

/// Rate of `mechanism` after the impact and restitution coefficient, as the orthogonal projection of the velocity field `before` onto the
/// mechanism in the kinetic-energy metric.
///
/// The impulses act at hinges of the new mechanism and so do no work on it: `<u', u' q'> = <u', before>`.
/// The restitution coefficient is then a squared cosine. It solves Eqs. (7)-(10) of the paper.
pub fn projection(mechanism: &FourLink, before: &Field, profile: &dyn Profile) -> (f64, f64) {
    let field = mechanism.field();
    let [own, shared] = [&field, before].map(|other| field.product(other, profile));
    let kept = shared * shared / (own * before.product(before, profile));
    (shared / own, kept)
}

/// Admissible mechanism with the largest retained part of the kinetic energy of `before`.
fn most_energetic(before: &Field, profile: &dyn Profile, sites: HingeSites) -> Option<FourLink> {
    let lattice = Lattice::new(profile, sites);
    let table = ProductTable::new(&lattice, before, profile);
    let score = |rotations: &[f64; 4], quadruple: &Quadruple| {
        table.twice_retained_energy(rotations, quadruple)
    };
    let objective = RetainedEnergy { before, profile };
    best_mechanism(profile, sites, &lattice, &score, &objective).map(|(_, mechanism)| mechanism)
}

/// `<u', before>^2 / <u', u'>`: twice the kinetic energy that a mechanism keeps.
struct RetainedEnergy<'a> {
    before: &'a Field,
    profile: &'a dyn Profile,
}

impl RetainedEnergy<'_> {
    /// Retained energy and the rate of the mechanism.
    fn energy_and_rate(&self, mechanism: &FourLink) -> (f64, f64) {
        let field = mechanism.field();
        let shared = field.product(self.before, self.profile);
        let rate = shared / field.product(&field, self.profile);
        // A mechanism that would have to move backwards retains no energy.
        (if rate > 0.0 { shared * rate } else { -f64::MAX }, rate)
    }
}

impl Objective for RetainedEnergy<'_> {
    fn kinks_rad(&self) -> &[f64] {
        &self.before.cuts_rad
    }

    /// Retained energy and its derivatives. The energy is the maximum over the rate `s` of `2 s <u', before> - s^2 <u', u'>`, so its
    /// derivative is `2 s` times that of the power of the load `before - s u'`: the moments of the impulse line. At a hinge the new field counts with
    /// the mean of both sides.
    fn evaluate(&self, mechanism: &FourLink, above: [bool; 4]) -> (f64, [f64; 4]) {
        let (value, rate) = self.energy_and_rate(mechanism);
        let after = mechanism.field().scaled(rate);
        let angles = mechanism.hinges_rad;
        let local: [Twist; 4] = std::array::from_fn(|i| {
            let side = if above[i] { Side::After } else { Side::Before };
            let mean = (after.twist_at(angles[i], Side::Before)
                + after.twist_at(angles[i], Side::After))
                * 0.5;
            self.before.twist_at(angles[i], side) - mean
        });
        let line = ImpulseLine::new(self.profile, mechanism, self.before, &after);
        let gradient = line.resultants.power_gradient(mechanism, local);
        (value, gradient.map(|slope| 2.0 * rate * slope))
    }
}

/// Products of unit rotations about the edge points of a lattice, each moving all that lies to its right.
///
/// A mechanism is a sum of four of them, and its products follow by a few multiplications.
struct ProductTable {
    /// With the field before the impact: `with_before[2 section + edge]`.
    with_before: Vec<f64>,
    /// With each other: `mutual[(2 section + edge) * size + (2 section + edge)]`.
    mutual: Vec<f64>,
}

impl ProductTable {
    fn new(lattice: &Lattice, before: &Field, profile: &dyn Profile) -> Self {
        let end = profile.end();
        let whole = before.momentum_to(profile, end);
        let rotations: Vec<_> = lattice
            .sections_rad
            .iter()
            .flat_map(|angle| {
                let moments = profile.sector(*angle, end);
                let momentum = whole - before.momentum_to(profile, *angle);
                [EDGES[0], EDGES[1]].map(|edge| (profile.point(*angle, edge), moments, momentum))
            })
            .collect();
        let shares = rotations
            .iter()
            .map(|(point, _, momentum)| momentum.moment_about(*point));
        let with_before = shares.collect();
        let size = rotations.len();
        let mut mutual = vec![0.0; size * size];
        for (i, (point, _, _)) in rotations.iter().enumerate() {
            for (j, (other, moments, _)) in rotations.iter().enumerate().skip(i - i % 2) {
                let product = Twist::rotation(*point, 1.0)
                    .power(&Twist::rotation(*other, 1.0).momentum(moments));
                mutual[i * size + j] = product;
                mutual[j * size + i] = product;
            }
        }
        Self {
            with_before,
            mutual,
        }
    }

    /// Twice the kinetic energy that the mechanism keeps.
    fn twice_retained_energy(&self, rotations: &[f64; 4], quadruple: &Quadruple) -> f64 {
        let size = self.with_before.len();
        let index: [usize; 4] = std::array::from_fn(|i| 2 * quadruple[i] + EDGES[i] as usize);
        let (mut shared, mut own) = (0.0, 0.0);
        for i in 0..4 {
            shared += rotations[i] * self.with_before[index[i]];
            let row = &self.mutual[index[i] * size..][..size];
            let mut sum = 0.5 * rotations[i] * row[index[i]];
            for j in i + 1..4 {
                sum += rotations[j] * row[index[j]];
            }
            own += 2.0 * rotations[i] * sum;
        }
        if shared > 0.0 {
            shared * shared / own
        } else {
            f64::NEG_INFINITY
        }
    }
}
