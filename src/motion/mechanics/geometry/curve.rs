//! Smooth plane curves, and the area moments of what they enclose.
//!
//! The outlines of voussoirs consist of straight lines, of arcs, and of curves parallel to an ellipse. The area swept
//! by the line from a pole to the point that runs along a curve `r(u)` has the moments
//!
//! `A = 1/2 int r x dr`, `first = 1/3 int r (r x dr)`, `polar = 1/4 int |r|^2 (r x dr)`
//!
//! about the pole; summed over a closed outline they are those of the enclosed area.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::rigid::{MassMoments, mirrored, quarter_turn};
use crate::bisection::{Width, bisect, middle};

/// Parts into which a curve is cut for quadrature.
const PANELS: u32 = 8;

/// Nodes (on one side of the middle) and weights of Gauss-Legendre quadrature with eight points on (-1, 1).
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// A curve from its start (part 0) to its end (part 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// A straight line.
    Line {
        /// Start of the line.
        from: Vector2<f64>,
        /// End of the line.
        to: Vector2<f64>,
    },
    /// An arc of a circle.
    Arc {
        /// Centre of the circle.
        centre: Vector2<f64>,
        /// Radius of the circle.
        radius: f64,
        /// Angles at its start and its end, anticlockwise from the x axis, in radians.
        angles_rad: [f64; 2],
    },
    /// A curve at a constant distance from an ellipse about the origin.
    Ellipse {
        /// Semi-axes along x and y.
        semi_axes: Vector2<f64>,
        /// Distance from the ellipse, positive outwards.
        offset: f64,
        /// Eccentric anomalies at its start and its end, in radians.
        angles_rad: [f64; 2],
    },
}

impl Curve {
    pub(crate) const fn line(from: Vector2<f64>, to: Vector2<f64>) -> Self {
        Self::Line { from, to }
    }

    /// Point at a parameter from 0 to 1, and its derivative by the parameter.
    pub fn point_and_derivative(&self, part: f64) -> (Vector2<f64>, Vector2<f64>) {
        match *self {
            Self::Line { from, to } => (from + (to - from) * part, to - from),
            Self::Arc {
                centre,
                radius,
                angles_rad: [from_rad, to_rad],
            } => {
                let (sin, cos) = libm::sincos(from_rad + (to_rad - from_rad) * part);
                let arm = Vector2::new(cos, sin) * radius;
                (centre + arm, quarter_turn(arm) * (to_rad - from_rad))
            }
            Self::Ellipse {
                semi_axes,
                offset,
                angles_rad: [from_rad, to_rad],
            } => {
                let (sin, cos) = libm::sincos(from_rad + (to_rad - from_rad) * part);
                let on_ellipse = Vector2::new(semi_axes.x * cos, semi_axes.y * sin);
                let outward = Vector2::new(semi_axes.y * cos, semi_axes.x * sin);
                let speed = outward.norm();
                let normal = outward / speed;
                // The normal turns by a b / speed^2 per unit of the anomaly.
                let parallel = speed + offset * semi_axes.x * semi_axes.y / (speed * speed);
                (
                    on_ellipse + normal * offset,
                    quarter_turn(normal) * (parallel * (to_rad - from_rad)),
                )
            }
        }
    }

    /// Point at a parameter from 0 to 1.
    pub fn point(&self, part: f64) -> Vector2<f64> {
        self.point_and_derivative(part).0
    }

    /// Piece between two parameters; reversed if the first one is larger.
    pub fn between(&self, from: f64, to: f64) -> Self {
        let mut piece = *self;
        match &mut piece {
            Self::Line { .. } => piece = Self::line(self.point(from), self.point(to)),
            Self::Arc { angles_rad, .. } | Self::Ellipse { angles_rad, .. } => {
                let [start, end] = *angles_rad;
                *angles_rad = [from, to].map(|part| start + (end - start) * part);
            }
        }
        piece
    }

    /// Curve with reversed direction.
    pub fn reversed(&self) -> Self {
        self.between(1.0, 0.0)
    }

    /// Mirror image about the y axis with reversed direction, so that a curve from left to right stays one.
    pub fn mirrored(&self) -> Self {
        let mut image = self.reversed();
        match &mut image {
            Self::Line { from, to } => (*from, *to) = (mirrored(*from), mirrored(*to)),
            Self::Arc { angles_rad, .. } | Self::Ellipse { angles_rad, .. } => {
                *angles_rad = angles_rad.map(|angle_rad| PI - angle_rad);
            }
        }
        if let Self::Arc { centre, .. } = &mut image {
            *centre = mirrored(*centre);
        }
        image
    }

    /// Integral over the curve of a function of the point and the derivative.
    pub(crate) fn integral<T>(&self, of: impl Fn(Vector2<f64>, Vector2<f64>) -> T) -> T
    where
        T: std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        let half = 0.5 / f64::from(PANELS);
        let panel = |panel: u32| {
            let middle = half * f64::from(2 * panel + 1);
            let node = |(node, weight): (f64, f64)| {
                let at = |part| {
                    let (point, derivative) = self.point_and_derivative(part);
                    of(point, derivative)
                };
                (at(middle - half * node) + at(middle + half * node)) * (weight * half)
            };
            let [a, b, c, d] = GAUSS.map(node);
            a + b + c + d
        };
        (1..PANELS).fold(panel(0), |sum, next| sum + panel(next))
    }

    /// Length.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { from, to } => (to - from).norm(),
            Self::Arc {
                radius,
                angles_rad: [from_rad, to_rad],
                ..
            } => radius * (to_rad - from_rad).abs(),
            Self::Ellipse { .. } => self.integral(|_, derivative| derivative.norm()),
        }
    }

    /// Parameter at which the curve has reached a length.
    pub(crate) fn part_at(&self, length: f64) -> f64 {
        match self {
            Self::Line { .. } | Self::Arc { .. } => length / self.length(),
            Self::Ellipse { .. } => self.first(|part| self.between(0.0, part).length() >= length),
        }
    }

    /// Parameter from which on a condition holds.
    pub(crate) fn first(&self, holds: impl Fn(f64) -> bool) -> f64 {
        let (low, high) = bisect(0.0, 1.0, Width::Absolute(1e-16), holds);
        middle(low, high)
    }

    /// Moments, about a pole, of the area swept by the line from the pole to the point on the curve; positive if the line rotates
    /// anticlockwise.
    pub(crate) fn swept_moments(&self, pole: Vector2<f64>) -> MassMoments {
        if let Self::Line { from, to } = self {
            // A triangle.
            let (a, b) = (from - pole, to - pole);
            let twice = a.perp(&b);
            return MassMoments {
                mass: twice / 2.0,
                first: (a + b) * (twice / 6.0),
                polar: (a.norm_squared() + a.dot(&b) + b.norm_squared()) * (twice / 12.0),
            };
        }
        self.integral(|point, derivative| {
            let arm = point - pole;
            let twice = arm.perp(&derivative);
            MassMoments {
                mass: twice / 2.0,
                first: arm * (twice / 3.0),
                polar: arm.norm_squared() * (twice / 4.0),
            }
        })
    }
}

/// Straight lines from corner to corner and back to the first.
pub fn polygon(corners: &[Vector2<f64>]) -> impl Iterator<Item = Curve> {
    sides(corners).map(|[from, to]| Curve::Line { from, to })
}

/// Sides of a polygon, the last one back to the first corner.
pub(crate) fn sides(corners: &[Vector2<f64>]) -> impl Iterator<Item = [Vector2<f64>; 2]> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(from, to)| [*from, *to])
}

/// Distance of a point from a side.
pub(crate) fn distance([from, to]: [Vector2<f64>; 2], point: Vector2<f64>) -> f64 {
    let (direction, arm) = (to - from, point - from);
    let part = (arm.dot(&direction) / direction.norm_squared()).clamp(0.0, 1.0);
    (arm - direction * part).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::ring::Ring;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn arc(radius: f64, from_rad: f64, to_rad: f64) -> Curve {
        Curve::Arc {
            centre: Vector2::zeros(),
            radius,
            angles_rad: [from_rad, to_rad],
        }
    }

    fn line(from: Vector2<f64>, to: Vector2<f64>) -> Curve {
        Curve::Line { from, to }
    }

    fn moments(outline: &[Curve], pole: Vector2<f64>) -> MassMoments {
        let swept = outline.iter().map(|curve| curve.swept_moments(pole));
        swept.reduce(|sum, next| sum + next).unwrap()
    }

    #[test]
    fn the_quadrature_is_that_of_gauss() {
        // The rule is exact for powers up to 15 on each panel, so its nodes and weights are correct to the last digit.
        let axis = line(Vector2::zeros(), Vector2::new(1.0, 0.0));
        for power in 0..16 {
            let value = axis.integral(|point, _| point.x.powi(power));
            assert!(
                (value * f64::from(power + 1) - 1.0).abs() < 1e-14,
                "{power}"
            );
        }
    }

    #[test]
    fn a_sector_between_arcs_has_the_moments_of_the_ring() {
        let ring = Ring::new(0.3, 2.5).unwrap();
        let (from, to) = (0.4, 1.3);
        let angle = |section: f64| FRAC_PI_2 + 0.5 * ring.embrace_rad - section;
        let (outer, inner) = (
            arc(1.15, angle(from), angle(to)),
            arc(0.85, angle(from), angle(to)),
        );
        let outline = [
            line(inner.point(0.0), outer.point(0.0)),
            outer,
            line(outer.point(1.0), inner.point(1.0)),
            inner.reversed(),
        ];
        let exact = ring.sector(from, to);
        let found = moments(&outline, Vector2::zeros());
        // The outline runs clockwise.
        assert!((found.mass + exact.mass).abs() < 1e-15);
        assert!((found.first + exact.first).norm() < 1e-15);
        assert!((found.polar + exact.polar).abs() < 1e-15);
    }

    /// Steiner and Archimedes: the area between parallel curves is the distance times the length in the middle, and
    /// an ellipse has the area pi a b.
    #[test]
    fn parallel_curves_of_an_ellipse() {
        let ellipse = |offset| Curve::Ellipse {
            semi_axes: Vector2::new(3.0, 2.0),
            offset,
            angles_rad: [0.0, FRAC_PI_2],
        };
        let quarter = ellipse(0.0).swept_moments(Vector2::zeros());
        assert!((quarter.mass - 1.5 * PI).abs() < 1e-13);
        // First moments a^2 b / 3 and a b^2 / 3, polar pi a b (a^2 + b^2) / 16.
        assert!((quarter.first - Vector2::new(6.0, 4.0)).norm() < 1e-13);
        assert!((quarter.polar - PI * 6.0 * 13.0 / 16.0).abs() < 1e-12);
        let outline = [ellipse(0.2), ellipse(-0.2).reversed()];
        let strip = moments(&outline, Vector2::zeros()).mass;
        assert!((strip - 0.4 * ellipse(0.0).length()).abs() < 1e-12);
        let part = ellipse(0.1).part_at(1.0);
        assert!((ellipse(0.1).between(0.0, part).length() - 1.0).abs() < 1e-13);
    }

    #[test]
    fn an_ellipse_with_equal_axes_is_a_circle_and_derivatives_are_derivatives() {
        let ellipse = |semi_axes| Curve::Ellipse {
            semi_axes,
            offset: 0.3,
            angles_rad: [2.8, 0.4],
        };
        let circle = arc(2.3, 2.8, 0.4);
        for part in [0.1, 0.5, 0.8] {
            let round = ellipse(Vector2::new(2.0, 2.0));
            assert!((round.point(part) - circle.point(part)).norm() < 1e-15);
            for curve in [round, ellipse(Vector2::new(3.0, 1.0)), circle] {
                let h = 1e-5;
                let slope = (curve.point(part + h) - curve.point(part - h)) / (2.0 * h);
                assert!((slope - curve.point_and_derivative(part).1).norm() < 1e-8);
                let mirrored = curve.mirrored().point(1.0 - part);
                let point = curve.point(part);
                assert!((mirrored - Vector2::new(-point.x, point.y)).norm() < 1e-14);
            }
        }
    }
}
