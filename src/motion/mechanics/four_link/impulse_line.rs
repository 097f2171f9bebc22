//! The impulses of an impact, at the hinges of the new mechanism and at every section.
//!
//! During the impact every part of the ring obeys impulse = change of momentum. The impulse that crosses a section
//! is then known up to the impulse at one springing. The four hinges of the new mechanism, which carry no moment,
//! determine that one. The points where the impulses cross their sections are the impulse line of the paper (Fig.
//! 10).

use nalgebra::Vector2;

use super::mechanism::{FourLink, HingeSites};
use super::resultant::{Extremes, ResultantLine, SectionResultant};
use crate::mechanics::{Field, Profile, Sway};

/// The impulses of an impact over the ring.
///
/// Per unit rate of the closing mechanism, in units of `rho d R^3`, and in the frame in which the new mechanism
/// sways right, unless a name ends in `from_left`.
#[derive(Clone, Debug)]
pub struct ImpulseLine {
    mechanism: FourLink,
    /// The impulse that each part transmits to its neighbour on the right.
    pub resultants: ResultantLine,
}

impl ImpulseLine {
    /// Impulses that turn the velocity field `before` into `after`, a motion of `mechanism`.
    ///
    /// `after` has to be the projection of `before` onto the mechanism ([`super::impact::projection`]); the line
    /// then passes through all four hinges.
    pub fn new(profile: &dyn Profile, mechanism: &FourLink, before: &Field, after: &Field) -> Self {
        Self {
            mechanism: *mechanism,
            resultants: ResultantLine::through_hinges(profile, mechanism, before.minus(after)),
        }
    }

    /// Impulses at the hinges A, B, C, D on the part towards the crown. At A and D the ground acts on the left and the right body; at B
    /// and C these bodies act on the middle one.
    ///
    /// The outer two are the unknowns `F' dt` of Eqs. (7)-(10) of the paper.
    pub fn hinge_impulses(&self) -> [Vector2<f64>; 4] {
        let sides = [1.0, 1.0, -1.0, -1.0];
        let hinges = self.mechanism.hinges_rad;
        std::array::from_fn(|i| self.resultants.resultant_at(hinges[i]).linear * sides[i])
    }

    /// [`Self::hinge_impulses`] at the hinges from left to right, in the frame of the ground, when the new mechanism sways to the given side.
    pub fn hinge_impulses_from_left(&self, sway: Sway) -> [Vector2<f64>; 4] {
        let mut impulses = self.hinge_impulses();
        if sway == Sway::Left {
            impulses.reverse();
            for impulse in &mut impulses {
                impulse.x = -impulse.x;
            }
        }
        impulses
    }

    /// Resultant at a section, by its angle from the left springing, when the new mechanism sways to the given side.
    pub fn section_from_left(&self, angle_rad: f64, sway: Sway) -> SectionResultant {
        let angle_rad = sway.convert_section(&*self.resultants.profile, angle_rad);
        let mut section = self.resultants.section(angle_rad);
        // A reflection exchanges the parts before and after the section.
        section.tangential *= sway.sign();
        section
    }

    /// [`ResultantLine::extremes`], with angles from the left springing when the new mechanism sways to the given side.
    pub fn extremes_from_left(&self, sites: HingeSites, sway: Sway) -> Extremes {
        let mut extremes = self.resultants.extremes(sites);
        for extremum in [
            &mut extremes.eccentricity_ratio,
            &mut extremes.normal,
            &mut extremes.friction_ratio,
        ] {
            extremum.angle_rad =
                sway.convert_section(&*self.resultants.profile, extremum.angle_rad);
        }
        extremes
    }
}
