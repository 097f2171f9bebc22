//! Thrust line in motion: its excess beyond the ring, and the friction demand.
//!
//! Between impacts gravity, ground acceleration and inertia forces are in equilibrium with the forces at the hinges. In the frame of its material a
//! moving body is undeformed, with the load per unit mass `c + alpha k x r + kappa r` and constants `c`, `alpha` and `kappa` (centrifugal). On a
//! sector the load integrates to its mass, first and polar moment. The thrust line of the displaced ring is therefore computed section by section in
//! the undeformed ring.
//!
//! If the thrust line leaves the ring, four hinges are not enough: the joint there would open and the hinges would move. The four-link motion is then
//! no motion of rigid blocks without tension.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use nalgebra::Vector2;

use super::limit::Incipient;
use super::mechanism::HingeSites;
use super::resultant::{Extremum, SectionResultant, find_maximum};
use crate::bisection::{Width, bisect};
use crate::mechanics::chain::LEAST_LOAD;
use crate::mechanics::geometry::field::quarter_turn;
use crate::mechanics::{Demand, MassMoments, Momentum, Profile, Twist};

/// Samples of a continuous ring per right angle; between two of them the line has at most one maximum.
const SAMPLES: f64 = 90.0;

/// Accuracy of a maximum between samples, in radians: the excess is off by about 1e-10 of the thickness.
const TOP_ACCURACY_RAD: f64 = 1e-6;

/// Tolerance of the excess: the line touches the edge at the hinges, within rounding error.
const ROUNDING: f64 = 1e-9;

impl Demand {
    /// Demand of resultants at their sections; `weight` is that of the whole structure, in the unit of the resultants.
    ///
    /// The excess is `|M| / (N t) - 1/2` and the friction `|V| / N`, with the moment `M` about the axis and the components `N` and `V`. For
    /// `N < 0.01 weight` (`LEAST_LOAD`) the line is hardly ever inside. The excess is then `(|M| - N t / 2) / (0.01 weight t)`. This is a
    /// continuous extension, finite, and increases with the tension. The friction demand is then zero.
    pub fn of_sections(sections: impl Iterator<Item = SectionResultant>, weight: f64) -> Self {
        sections.fold(Self::default(), |demand, section| {
            demand.max(Self::of_section(&section, weight))
        })
    }

    /// Demand of one section; a negative excess is the distance inside.
    fn of_section(section: &SectionResultant, weight: f64) -> Self {
        let least = LEAST_LOAD * weight;
        let SectionResultant { normal, moment, .. } = *section;
        let friction = section.tangential.abs() / normal.max(least);
        Self {
            excess_ratio: excess_ratio(normal, moment, section.thickness, least),
            friction: if normal >= least { friction } else { 0.0 },
        }
    }

    /// Larger value of both demands; excesses within rounding error do not count.
    fn max(self, other: Self) -> Self {
        let mut larger = self;
        larger.friction = self.friction.max(other.friction);
        if other.excess_ratio > ROUNDING {
            larger.excess_ratio = self.excess_ratio.max(other.excess_ratio);
        }
        larger
    }
}

/// Excess of a normal force and its moment about the axis, as in [`Demand::of_sections`]; negative inside.
fn excess_ratio(normal: f64, moment: f64, thickness: f64, least: f64) -> f64 {
    let beyond = moment.abs() - 0.5 * normal * thickness;
    beyond / (normal.max(least) * thickness)
}

/// Section of a profile with its constants, for many thrust lines through it.
#[derive(Clone, Copy, Debug)]
pub struct ProfileSection {
    place: f64,
    before: MassMoments,
    onward: Vector2<f64>,
    middle: Vector2<f64>,
    thickness: f64,
}

/// Parts of a continuous ring between the sections of [`ProfileSection::all`].
const EXCESS_PARTS: usize = 48;

impl ProfileSection {
    /// Joints of a profile, or equidistant sections of a continuous ring. Between these the excess exceeds the largest of them by some
    /// per cent of its value at most.
    pub(crate) fn all(profile: &dyn Profile, sites: HingeSites) -> Vec<Self> {
        let parts = match sites {
            HingeSites::Voussoirs(count) => count,
            HingeSites::Anywhere => EXCESS_PARTS,
        };
        let of = |place: f64| Self {
            place,
            before: profile.moments_to(place),
            onward: profile.onward_normal(place),
            middle: profile.middle(place),
            thickness: profile.thickness(place),
        };
        profile.sections(parts).into_iter().map(of).collect()
    }
}

/// Thrust excess and friction demand over these parts, at sections in ascending order.
pub(crate) fn demand_at_sections(parts: &[ThrustPart], sections: &[ProfileSection]) -> Demand {
    let weight = sections.last().map_or(0.0, |section| section.before.mass);
    let least = LEAST_LOAD * weight;
    let (mut parts, mut largest, mut friction) = (parts, ROUNDING, 0.0_f64);
    for section in sections {
        while let [part, _, ..] = parts
            && part.end_rad < section.place
        {
            parts = &parts[1..];
        }
        let Some(part) = parts.first() else {
            break;
        };
        let resultant = part.start + part.load.resultant(&section.before);
        let normal = resultant.linear.dot(&section.onward);
        // As in `SectionResultant`; the sign does not matter.
        let moment = resultant.moment_about(section.middle);
        largest = largest.max(excess_ratio(normal, moment, section.thickness, least));
        if normal >= least {
            // The components along the section and along the axis are perpendicular.
            let tangential = resultant.linear.perp(&section.onward);
            friction = friction.max(tangential.abs() / normal);
        }
    }
    Demand {
        excess_ratio: if largest > ROUNDING { largest } else { 0.0 },
        friction,
    }
}

/// Load per unit mass `c + alpha k x r + kappa r` on a part of the ring, in the frame of its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartLoad {
    /// `c` and `alpha`.
    turning: Twist,
    /// `kappa`.
    centrifugal: f64,
}

impl PartLoad {
    /// Load of one force per unit mass everywhere.
    pub const fn uniform(force: Vector2<f64>) -> Self {
        Self {
            turning: Twist::translation(force),
            centrifugal: 0.0,
        }
    }

    /// Body force minus the inertia force of a rotating body: `at_pole` is the body force minus the acceleration of the body's point
    /// `pole`, `(alpha, omega^2)` its angular acceleration and squared rate.
    pub(crate) fn of_body(
        pole: Vector2<f64>,
        at_pole: Vector2<f64>,
        (acceleration, squared_rate): (f64, f64),
    ) -> Self {
        Self {
            turning: Twist {
                at_center: at_pole + quarter_turn(pole) * acceleration - pole * squared_rate,
                rate: -acceleration,
            },
            centrifugal: squared_rate,
        }
    }

    /// Resultant on a body of the given moments.
    pub fn resultant(&self, body: &MassMoments) -> Momentum {
        let mut resultant = self.turning.momentum(body);
        resultant.linear += body.first * self.centrifugal;
        resultant
    }
}

/// Rigid part of the ring, in the frame of its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustPart {
    /// Last section of the part.
    pub end_rad: f64,
    load: PartLoad,
    /// Resultant at the left springing if the part extended to it.
    start: Momentum,
}

impl ThrustPart {
    /// Part that ends at `end_rad`, under `load`, with the resultant `known` at the section `known_rad`.
    pub fn new(
        profile: &dyn Profile,
        end_rad: f64,
        load: PartLoad,
        (known_rad, known): (f64, Momentum),
    ) -> Self {
        Self::after(&profile.moments_to(known_rad), end_rad, load, known)
    }

    /// Part that ends at `end_rad`, under `load`, with the resultant `known` at the section behind a part of these mass moments.
    pub(crate) fn after(
        before: &MassMoments,
        end_rad: f64,
        load: PartLoad,
        known: Momentum,
    ) -> Self {
        let start = known - load.resultant(before);
        Self {
            end_rad,
            load,
            start,
        }
    }

    /// Resultant at a section.
    pub fn resultant_at(&self, profile: &dyn Profile, angle_rad: f64) -> Momentum {
        self.start + self.load.resultant(&profile.moments_to(angle_rad))
    }
}

/// Resultants over all sections of a ring that moves as rigid parts, or rests.
///
/// Forces are in weights of `rho d R^2`. Each force is in the frame of its part's material: components and positions refer to the displaced section.
#[derive(Clone, Debug)]
pub struct ThrustLine {
    profile: Arc<dyn Profile>,
    /// The parts.
    pub parts: Vec<ThrustPart>,
}

impl ThrustLine {
    /// Line over consecutive parts, from the left springing to the right one.
    pub(crate) fn new(profile: &dyn Profile, parts: Vec<ThrustPart>) -> Self {
        Self {
            profile: profile.to_shared(),
            parts,
        }
    }

    /// Admissible thrust line of the structure at rest under a force per unit mass, in multiples of gravity.
    ///
    /// The structure at rest is statically indeterminate, and one admissible line proves that it can stay at rest. This line is the weighted mean of
    /// the two limit lines, at `A_L` to the right and to the left (the latter as its mirror image, which sways right). The weights are such that the
    /// loads add up to the given load. Moments and normal forces are linear in the load, so the mean is inside if both limit lines are. At the onset
    /// of rocking it equals the line of the mechanism.
    pub fn at_rest(
        to_right: &Incipient,
        to_left: &Incipient,
        profile: &dyn Profile,
        body_force_g: Vector2<f64>,
    ) -> Self {
        let right = to_right.thrust_line.resultant_at(0.0);
        let mut left = to_left.thrust_line.resultant_at(profile.end());
        // A reflection exchanges the parts before and after the section, which changes the sign.
        left.linear.y = -left.linear.y;
        let both_g = to_right.acceleration_g + to_left.acceleration_g;
        let (weight, push) = (-body_force_g.y, body_force_g.x / both_g);
        let shares = [to_left, to_right].map(|onset| 2.0 * onset.acceleration_g / both_g);
        let start = (right * shares[0] + left * shares[1]) * (0.5 * weight) + (right - left) * push;
        let load = PartLoad::uniform(body_force_g);
        let part = ThrustPart::new(profile, profile.end(), load, (0.0, start));
        Self::new(profile, vec![part])
    }

    /// Resultant at a section; at the end of a part, that of the part before.
    pub fn resultant_at(&self, angle_rad: f64) -> Momentum {
        let index = self.parts.partition_point(|part| part.end_rad < angle_rad);
        self.parts[index.min(self.parts.len() - 1)].resultant_at(&*self.profile, angle_rad)
    }

    /// Components and position at a section.
    pub fn section(&self, angle_rad: f64) -> SectionResultant {
        SectionResultant::new(&*self.profile, angle_rad, &self.resultant_at(angle_rad))
    }

    /// Crossings of the line with these sections, outwards from the axis over the thickness: -0.5 to 0.5 inside the ring. `None` for a
    /// section without compression.
    pub fn eccentricity_ratios(&self, sections_rad: &[f64]) -> Vec<Option<f64>> {
        let sections = sections_rad
            .iter()
            .map(|angle_rad| self.section(*angle_rad));
        let pressed =
            sections.map(|section| (section.normal > 0.0).then_some(section.eccentricity_ratio));
        pressed.collect()
    }

    /// Largest demands over the joints, or over all sections of a continuous ring.
    pub fn demand(&self, sites: HingeSites) -> Demand {
        let weight = self.profile.moments_to(self.profile.end()).mass;
        match sites {
            HingeSites::Voussoirs(count) => {
                let joints = self.profile.sections(count).into_iter();
                Demand::of_sections(joints.map(|angle| self.section(angle)), weight)
            }
            HingeSites::Anywhere => {
                let starts = std::iter::once(0.0).chain(self.parts.iter().map(|part| part.end_rad));
                let mut demand = Demand::default();
                for (start, part) in starts.zip(&self.parts) {
                    let at = |angle_rad: f64| {
                        let resultant = part.resultant_at(&*self.profile, angle_rad);
                        let section = SectionResultant::new(&*self.profile, angle_rad, &resultant);
                        Demand::of_section(&section, weight)
                    };
                    if start < part.end_rad {
                        demand = find_largest_demand(demand, start, part.end_rad, &at);
                    }
                }
                demand
            }
        }
    }
}

/// Largest of `known` and of the demands at all sections of a rigid part, over which they are smooth except for a few kinks.
fn find_largest_demand(
    known: Demand,
    start_rad: f64,
    end_rad: f64,
    at: &impl Fn(f64) -> Demand,
) -> Demand {
    let intervals = (SAMPLES * (end_rad - start_rad) / FRAC_PI_2)
        .ceil()
        .max(4.0);
    let part = |i: u32| start_rad + (end_rad - start_rad) * (f64::from(i) / intervals);
    let samples: Vec<(f64, Demand)> = (0..=intervals as u32)
        .map(|i| (part(i), at(part(i))))
        .collect();
    let demands = samples.iter().map(|(_, sample)| *sample);
    let mut demand = demands.fold(known, Demand::max);
    for i in 0..samples.len() {
        let floor = demand.excess_ratio.max(ROUNDING);
        let excess_ratio = top_near(i, &samples, floor, at, |d| d.excess_ratio);
        let friction = top_near(i, &samples, demand.friction, at, |d| d.friction);
        let next = samples.get(i + 1);
        let edge = next.map_or(0.0, |next| load_edge(&samples[i], next, at));
        demand.friction = demand.friction.max(edge);
        demand = demand.max(Demand {
            excess_ratio: excess_ratio.unwrap_or(0.0),
            friction: friction.unwrap_or(0.0),
        });
    }
    demand
}

/// Friction at the section between two samples where the normal force reaches `LEAST_LOAD`; zero if both samples count, or neither.
fn load_edge(
    (from_rad, from): &(f64, Demand),
    (to_rad, to): &(f64, Demand),
    at: &impl Fn(f64) -> Demand,
) -> f64 {
    let [counts, counts_after] = [from, to].map(|demand| demand.friction > 0.0);
    if counts == counts_after {
        return 0.0;
    }
    let changed = |angle_rad: f64| (at(angle_rad).friction > 0.0) == counts_after;
    let (before, after) = bisect(*from_rad, *to_rad, Width::Rounding, changed);
    at(if counts { before } else { after }).friction
}

/// Maximum of a quantity between the neighbours of a sample; `None` if it cannot exceed `floor`.
fn top_near(
    i: usize,
    samples: &[(f64, Demand)],
    floor: f64,
    at: &impl Fn(f64) -> Demand,
    of: impl Fn(&Demand) -> f64,
) -> Option<f64> {
    let last = samples.len() - 1;
    let value = |i: usize| of(&samples[i].1);
    let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
    if value(i) < value(before) || value(i) < value(after) {
        return None;
    }
    // A parabola through equidistant samples exceeds the largest by at most an eighth of the drop to the smallest.
    let near = i.saturating_sub(2)..=(i + 2).min(last);
    let drop = near.map(|near| value(i) - value(near)).fold(0.0, f64::max);
    if value(i) + drop <= floor {
        return None;
    }
    let inwards = match i {
        0 => TOP_ACCURACY_RAD,
        _ if i == last => -TOP_ACCURACY_RAD,
        _ => 0.0,
    };
    if inwards != 0.0 && of(&at(samples[i].0 + inwards)) <= value(i) {
        return None;
    }
    let at = |angle_rad: f64| Extremum {
        value: of(&at(angle_rad)),
        angle_rad,
    };
    Some(find_maximum(samples[before].0, samples[after].0, TOP_ACCURACY_RAD, &at).value)
}
