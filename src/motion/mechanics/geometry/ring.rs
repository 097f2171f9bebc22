//! The circular ring: its points, sections and mass moments in closed form.
//!
//! Lengths are in mean radii and the surface density is one, so that a ring is two numbers. A
//! real arch of mean radius `R`, depth `d` and density `rho` has masses `rho d R^2`, first moments
//! `rho d R^3` and polar moments `rho d R^4` times those given here.

use std::f64::consts::PI;

use nalgebra::Vector2;

pub use super::rigid::MassMoments;
use super::rigid::quarter_turn;
use crate::argument::{ArgumentError, require};

named! {
    /// Edge of the ring on which a hinge sits.
    pub enum Edge {
        /// Inner edge, of radius `1 - t/2R`.
        Intrados = "intrados",
        /// Outer edge, of radius `1 + t/2R`.
        Extrados = "extrados",
    }
}

impl Edge {
    /// Opposite edge.
    pub const fn opposite(self) -> Self {
        match self {
            Self::Intrados => Self::Extrados,
            Self::Extrados => Self::Intrados,
        }
    }

    /// The only edge, intrados or extrados, with the value true; `None` if none or both are true.
    pub const fn only(edges: [bool; 2]) -> Option<Self> {
        match edges {
            [true, false] => Some(Self::Intrados),
            [false, true] => Some(Self::Extrados),
            _ => None,
        }
    }
}

/// Longest straight line with which an arc of an outline is drawn.
const OUTLINE_STEP_RAD: f64 = 3.0 * PI / 180.0;

/// A circular ring segment, symmetric about the vertical, of unit mean radius and density.
///
/// Sections are radial cuts, named by their angle from the left springing (0) to the right one
/// (`embrace_rad`), in radians.
#[readonly::make]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Thickness over mean radius.
    pub thickness_ratio: f64,
    /// Embrace angle in radians, also the angle of the right springing.
    pub embrace_rad: f64,
    /// Unit vector from the centre through the left springing.
    left: Vector2<f64>,
}

impl Ring {
    /// Ring of thickness `thickness_ratio` (in mean radii) and embrace angle `embrace_rad`.
    ///
    /// # Errors
    /// When the thickness is not in `(0, 2)`, so that it leaves a hole, or the angle not in `(0, pi]`.
    pub fn new(thickness_ratio: f64, embrace_rad: f64) -> Result<Self, ArgumentError> {
        let has_hole = thickness_ratio > 0.0 && thickness_ratio < 2.0;
        let is_arch = embrace_rad > 0.0 && embrace_rad <= PI;
        let mut ring = Self {
            thickness_ratio: require(has_hole, "thickness_ratio", thickness_ratio, "in (0, 2)")?,
            embrace_rad: require(is_arch, "embrace_rad", embrace_rad, "in (0, pi]")?,
            left: Vector2::zeros(),
        };
        ring.left = ring.radial_direction(0.0);
        Ok(ring)
    }

    /// Radius of an edge, in mean radii.
    pub fn radius(&self, edge: Edge) -> f64 {
        match edge {
            Edge::Intrados => 1.0 - 0.5 * self.thickness_ratio,
            Edge::Extrados => 1.0 + 0.5 * self.thickness_ratio,
        }
    }

    /// Unit vector from the centre through the section at `angle_rad`.
    pub fn radial_direction(&self, angle_rad: f64) -> Vector2<f64> {
        let (sin, cos) = libm::sincos(angle_rad - 0.5 * self.embrace_rad);
        Vector2::new(sin, cos)
    }

    /// Unit vector along the axis at `angle_rad`, towards the right springing.
    pub fn tangent(&self, angle_rad: f64) -> Vector2<f64> {
        -quarter_turn(self.radial_direction(angle_rad))
    }

    /// Point of the section at `angle_rad` on `edge`.
    pub fn point(&self, angle_rad: f64, edge: Edge) -> Vector2<f64> {
        self.radial_direction(angle_rad) * self.radius(edge)
    }

    /// Corners of the sector between two sections, from the first section outwards; its arcs as straight lines of 3 degrees at most.
    pub fn sector_outline(&self, start_rad: f64, end_rad: f64) -> Vec<Vector2<f64>> {
        let lines = ((end_rad - start_rad) / OUTLINE_STEP_RAD).ceil().max(1.0);
        let count = lines as u32;
        let at = |i: u32, edge: Edge| {
            let part = f64::from(i) / lines;
            self.point(start_rad + part * (end_rad - start_rad), edge)
        };
        let out = (0..=count).map(|i| at(i, Edge::Extrados));
        let back = (0..=count).rev().map(|i| at(i, Edge::Intrados));
        out.chain(back).collect()
    }

    /// Sections that cut the ring into `parts` equal parts, springings included, in radians.
    pub fn sections(&self, parts: usize) -> Vec<f64> {
        let part = |i: usize| i as f64 / parts as f64;
        (0..=parts).map(|i| self.embrace_rad * part(i)).collect()
    }

    /// Mass moments of the part from the left springing to `angle_rad`.
    ///
    /// Annular sector: with `c = t (1 + t^2/12)` the first moment is `c` times the integral of the
    /// radial unit vector, the mass is `t` and the polar moment `t (1 + t^2/4)` per radian.
    pub fn moments_to(&self, angle_rad: f64) -> MassMoments {
        let (start, end) = (self.left, self.radial_direction(angle_rad));
        MassMoments {
            mass: self.thickness_ratio * angle_rad,
            first: Vector2::new(start.y - end.y, end.x - start.x) * self.first_moment_per_rad(),
            polar: self.polar_moment_per_rad() * angle_rad,
        }
    }

    /// Mass moments of the sector between two sections.
    pub fn sector(&self, from_rad: f64, to_rad: f64) -> MassMoments {
        self.moments_to(to_rad) - self.moments_to(from_rad)
    }

    /// Mass moments per radian at a section: the derivative of [`Ring::moments_to`].
    pub fn slice(&self, angle_rad: f64) -> MassMoments {
        MassMoments {
            mass: self.thickness_ratio,
            first: self.radial_direction(angle_rad) * self.first_moment_per_rad(),
            polar: self.polar_moment_per_rad(),
        }
    }

    fn first_moment_per_rad(&self) -> f64 {
        let t = self.thickness_ratio;
        t * (1.0 + t * t / 12.0)
    }

    fn polar_moment_per_rad(&self) -> f64 {
        let t = self.thickness_ratio;
        t * (1.0 + 0.25 * t * t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint rule on a polar mesh: an independent value of the sector's integrals.
    fn quadrature(ring: &Ring, from: f64, to: f64) -> MassMoments {
        let (n, m) = (400, 60);
        let mut sum = MassMoments {
            mass: 0.0,
            first: Vector2::zeros(),
            polar: 0.0,
        };
        for i in 0..n {
            let angle = from + (to - from) * (f64::from(i) + 0.5) / f64::from(n);
            for j in 0..m {
                let r = ring.radius(Edge::Intrados)
                    + ring.thickness_ratio * (f64::from(j) + 0.5) / f64::from(m);
                let mass = r * (to - from) / f64::from(n) * ring.thickness_ratio / f64::from(m);
                sum = sum
                    + MassMoments {
                        mass,
                        first: ring.radial_direction(angle) * (r * mass),
                        polar: r * r * mass,
                    };
            }
        }
        sum
    }

    #[test]
    fn sector_moments_equal_quadrature() {
        // The midpoint rule errs by about (interval)^2 / 24, here below 1e-5.
        for (t, beta, from, to) in [
            (0.15, PI, 0.3, 1.1),
            (0.6, 1.7, 0.0, 1.7),
            (0.05, 2.7, 2.0, 2.1),
        ] {
            let ring = Ring::new(t, beta).unwrap();
            let (exact, sum) = (ring.sector(from, to), quadrature(&ring, from, to));
            assert!((exact.mass - sum.mass).abs() < 1e-5 * exact.mass);
            assert!((exact.first - sum.first).norm() < 1e-5 * exact.mass);
            assert!((exact.polar - sum.polar).abs() < 1e-4 * exact.polar);
        }
    }

    #[test]
    fn slice_is_the_derivative_of_the_moments() {
        let ring = Ring::new(0.3, 2.5).unwrap();
        let (angle, h) = (0.9, 1e-5);
        let difference = ring.sector(angle - h, angle + h);
        let slice = ring.slice(angle);
        // Central difference: truncation h^2/6, rounding 1e-16/h.
        assert!((difference.first / (2.0 * h) - slice.first).norm() < 1e-9);
        assert!((difference.mass / (2.0 * h) - slice.mass).abs() < 1e-9);
        assert!((difference.polar / (2.0 * h) - slice.polar).abs() < 1e-9);
    }

    #[test]
    fn rings_without_a_hole_or_beyond_a_semicircle_are_refused() {
        assert!(Ring::new(0.0, 1.0).is_err());
        assert!(Ring::new(2.0, 1.0).is_err());
        assert!(Ring::new(f64::NAN, 1.0).is_err());
        assert!(Ring::new(0.1, 0.0).is_err());
        assert!(Ring::new(0.1, 3.2).is_err());
        assert!(Ring::new(0.1, PI).is_ok());
    }
}
