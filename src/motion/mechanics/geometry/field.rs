//! Piecewise rigid fields over the ring, and their momenta.
//!
//! A field consists of rigid motions ([`Twist`]) on consecutive sectors. Examples are a velocity field with rigid parts of the ring, a uniform
//! acceleration field such as gravity, and the change of velocity in an impact. Two fields have a scalar product, the integral of `rho v . w`. It is
//! twice a kinetic energy for `v = w`, and a virtual power if one of the fields is a load per unit mass.

use crate::mechanics::{MassMoments, Profile};
use std::iter::zip;
use std::mem;
use std::ops::Add;

pub use super::rigid::{Momentum, Twist, quarter_turn};

/// The side of a section from which a field is taken, if it jumps there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The value just before the section (towards the left springing).
    Before,
    /// The value just after the section (towards the right springing).
    After,
}

/// Rigid motions on consecutive sectors: `twists[i]` between `cuts_rad[i - 1]` and `cuts_rad[i]`, with
/// the springings as outermost bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Sections where the field may jump, in radians, ascending.
    pub cuts_rad: Vec<f64>,
    /// Mass moments of the profile before each cut. A search for an impact needs them again and again.
    before: Vec<MassMoments>,
    twists: Vec<Twist>,
}

impl Field {
    /// Field with the same motion everywhere.
    pub fn uniform(twist: Twist) -> Self {
        Self {
            cuts_rad: Vec::new(),
            before: Vec::new(),
            twists: vec![twist],
        }
    }

    /// Field that jumps by `jumps[i].1` at section `jumps[i].0` (angles ascending) and is zero before the first of them.
    pub fn from_jumps(profile: &dyn Profile, jumps: &[(f64, Twist)]) -> Self {
        let before = jumps.iter().map(|(angle, _)| profile.moments_to(*angle));
        Self::with_moments(before.collect(), jumps)
    }

    /// [`Self::from_jumps`], given the mass moments before each jump.
    pub(crate) fn with_moments(before: Vec<MassMoments>, jumps: &[(f64, Twist)]) -> Self {
        let mut twist = Twist::ZERO;
        let mut twists = vec![twist];
        for (_, jump) in jumps {
            twist = twist + *jump;
            twists.push(twist);
        }
        Self {
            cuts_rad: jumps.iter().map(|(angle, _)| *angle).collect(),
            before,
            twists,
        }
    }

    /// Motion at a section.
    pub fn twist_at(&self, angle_rad: f64, side: Side) -> Twist {
        let index = self.cuts_rad.partition_point(|cut| match side {
            Side::Before => *cut < angle_rad,
            Side::After => *cut <= angle_rad,
        });
        self.twists[index]
    }

    /// This field times `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            cuts_rad: self.cuts_rad.clone(),
            before: self.before.clone(),
            twists: self.twists.iter().map(|twist| *twist * factor).collect(),
        }
    }

    /// Mirror image about the vertical axis of the profile.
    pub fn mirrored(&self, profile: &dyn Profile) -> Self {
        let cuts_rad: Vec<f64> = self
            .cuts_rad
            .iter()
            .rev()
            .map(|cut| profile.end() - cut)
            .collect();
        let before = cuts_rad.iter().map(|cut| profile.moments_to(*cut));
        Self {
            before: before.collect(),
            cuts_rad,
            twists: self.twists.iter().rev().map(Twist::mirrored).collect(),
        }
    }

    /// This field minus another: rigid on the sectors between the cuts of both.
    pub fn minus(&self, other: &Self) -> Self {
        let mut cuts: Vec<_> = zip(&self.cuts_rad, &self.before)
            .chain(zip(&other.cuts_rad, &other.before))
            .collect();
        cuts.sort_by(|a, b| a.0.total_cmp(b.0));
        cuts.dedup_by_key(|cut| *cut.0);
        let (cuts_rad, before): (Vec<f64>, Vec<MassMoments>) = cuts.into_iter().unzip();
        let after = |cut: f64| self.twist_at(cut, Side::After) - other.twist_at(cut, Side::After);
        let starts = std::iter::once(f64::NEG_INFINITY).chain(cuts_rad.iter().copied());
        let twists = starts.map(after).collect();
        Self {
            cuts_rad,
            before,
            twists,
        }
    }

    /// Rigid sectors: bounds and motion of each.
    fn sectors(&self, end: f64) -> impl Iterator<Item = (f64, f64, Twist)> {
        let starts = std::iter::once(0.0).chain(self.cuts_rad.iter().copied());
        let ends = self.cuts_rad.iter().copied().chain(std::iter::once(end));
        let sectors = starts.zip(ends).zip(&self.twists);
        sectors.map(|((start, end), twist)| (start, end, *twist))
    }

    /// Mass moments before the end of a sector.
    fn moments_to_end(&self, sector: usize, profile: &dyn Profile) -> MassMoments {
        let known = self.before.get(sector).copied();
        known.unwrap_or_else(|| profile.moments_to(profile.end()))
    }

    /// Momentum of the part of the profile from the left springing to `angle_rad`.
    pub fn momentum_to(&self, profile: &dyn Profile, angle_rad: f64) -> Momentum {
        let sectors = self.sectors(profile.end());
        let before = sectors.take_while(|(start, ..)| *start < angle_rad);
        let mut from = MassMoments::default();
        let momenta = before.enumerate().map(|(sector, (_, end, twist))| {
            let to = if end <= angle_rad {
                self.moments_to_end(sector, profile)
            } else {
                profile.moments_to(angle_rad)
            };
            twist.momentum(&(to - mem::replace(&mut from, to)))
        });
        momenta.fold(Momentum::ZERO, Add::add)
    }

    /// Scalar product with another field: the integral of `rho v . w` over the ring. The sum runs over the sectors between the sections
    /// of both fields.
    pub fn product(&self, other: &Self, profile: &dyn Profile) -> f64 {
        let end_of =
            |field: &Self, sector| field.cuts_rad.get(sector).map_or(profile.end(), |cut| *cut);
        let (mut from, mut before) = (0.0, MassMoments::default());
        let (mut own, mut others, mut sum) = (0, 0, 0.0);
        while own < self.twists.len() && others < other.twists.len() {
            let ends = [end_of(self, own), end_of(other, others)];
            let to = ends[0].min(ends[1]);
            if from < to {
                let after = if ends[0] <= to {
                    self.moments_to_end(own, profile)
                } else {
                    other.moments_to_end(others, profile)
                };
                sum += self.twists[own].power(&other.twists[others].momentum(&(after - before)));
                (from, before) = (to, after);
            }
            own += usize::from(ends[0] <= to);
            others += usize::from(ends[1] <= to);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::ring::Ring;
    use nalgebra::Vector2;

    fn example() -> (Ring, Field, Field) {
        let ring = Ring::new(0.2, 2.8).unwrap();
        let twist = |x, y, rate| Twist {
            at_center: Vector2::new(x, y),
            rate,
        };
        let u = Field::from_jumps(
            &ring,
            &[(0.3, twist(0.1, -0.2, 0.7)), (1.2, twist(-0.4, 0.3, 0.1))],
        );
        let w = Field::from_jumps(
            &ring,
            &[(0.3, twist(0.5, 0.2, -0.3)), (0.8, twist(0.2, 0.2, 0.2))],
        );
        (ring, u, w)
    }

    #[test]
    fn product_equals_the_integral_of_the_velocities() {
        let (ring, u, w) = example();
        let (n, m) = (2800, 40);
        let mut sum = 0.0;
        for i in 0..n {
            let angle = ring.embrace_rad * (f64::from(i) + 0.5) / f64::from(n);
            for j in 0..m {
                let r = 0.9 + 0.2 * (f64::from(j) + 0.5) / f64::from(m);
                let point = ring.radial_direction(angle) * r;
                let mass = r * ring.embrace_rad / f64::from(n) * 0.2 / f64::from(m);
                sum += mass
                    * u.twist_at(angle, Side::Before)
                        .velocity_at(point)
                        .dot(&w.twist_at(angle, Side::Before).velocity_at(point));
            }
        }
        // The mesh has its lines on the cuts; the midpoint rule errs by (0.001)^2 and (0.005)^2 / 24.
        let exact = u.product(&w, &ring);
        assert!((exact - sum).abs() < 1e-5, "{exact} {sum}");
        assert!((exact - w.product(&u, &ring)).abs() < 1e-15);
    }

    #[test]
    fn the_mirror_image_has_the_same_products() {
        let (ring, u, w) = example();
        let mirrored = u.mirrored(&ring).product(&w.mirrored(&ring), &ring);
        assert!((mirrored - u.product(&w, &ring)).abs() < 1e-14);
    }

    #[test]
    fn the_difference_is_linear_in_the_product() {
        let (ring, u, w) = example();
        let difference = u.minus(&w);
        let expanded = u.product(&u, &ring) - 2.0 * u.product(&w, &ring) + w.product(&w, &ring);
        assert!((difference.product(&difference, &ring) - expanded).abs() < 1e-14);
    }

    #[test]
    fn momentum_is_the_product_with_a_rigid_motion_of_the_part() {
        let (ring, u, _) = example();
        let part = Twist::rotation(Vector2::new(0.3, -0.1), 0.4);
        let stop = Field::from_jumps(&ring, &[(0.0, part), (1.0, part * -1.0)]);
        let expected = part.power(&u.momentum_to(&ring, 1.0));
        assert!((stop.product(&u, &ring) - expected).abs() < 1e-15);
    }
}
