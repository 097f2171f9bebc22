//! Four-link mechanism in the undeformed configuration.
//!
//! One orientation is sufficient: [`crate::mechanics`] always describes the mechanism that **sways right**, with hinges on intrados, extrados,
//! intrados, extrados from the left springing. A sway to the left is reflected ([`Sway`]). A ring is symmetric, so left and right agree exactly. A
//! row of blocks may not be symmetric, and then has a profile for each side.

use crate::mechanics::{Edge, Field, Hinge, MassMoments, Profile, Sway, Twist};
use nalgebra::Vector2;

/// Edges of the hinges A, B, C, D of a mechanism that sways right.
pub const EDGES: [Edge; 4] = [
    Edge::Intrados,
    Edge::Extrados,
    Edge::Intrados,
    Edge::Extrados,
];

/// Relative rotations at four hinges that leave both ends of the ring at rest, up to a common factor; `None` unless every hinge opens.
///
/// The closure `sum rho_i (1, x_i, y_i) = 0` is solved by the signed areas of the triangles of the
/// other three hinges. Hinges that alternate between the edges as in [`EDGES`] open when their
/// rotations alternate in sign, that is, when A, B, C, D go round a convex quadrilateral. The
/// orientation returned is the opening one: `rho_A < 0`.
pub(crate) fn openings(points: &[Vector2<f64>; 4]) -> Option<[f64; 4]> {
    let area =
        |i: usize, j: usize, k: usize| (points[j] - points[i]).perp(&(points[k] - points[i]));
    let areas = [area(1, 2, 3), area(0, 2, 3), area(0, 1, 3), area(0, 1, 2)];
    let turn = -areas[0].signum();
    areas.iter().all(|area| turn * area < 0.0).then(|| {
        [
            turn * areas[0],
            -turn * areas[1],
            turn * areas[2],
            -turn * areas[3],
        ]
    })
}

/// Kinematically admissible four-link mechanism that sways right.
///
/// The hinges A, B, C, D divide the ring into bodies at rest (before A, after D) and moving bodies: left (A-B), middle (B-C) and right (C-D). The
/// rate `q'` is the clockwise rate of the left body, which rotates about the first hinge; the head of `linkage.rs` has the reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourLink {
    /// Sections of the hinges A, B, C, D, in radians from the left springing.
    pub hinges_rad: [f64; 4],
    /// Relative rotation rate of the part after each hinge to the part before it, at `q' = 1`:
    /// negative at intrados hinges, positive at extrados hinges, -1 at the first.
    pub openings: [f64; 4],
    /// Positions of the hinges.
    pub points: [Vector2<f64>; 4],
    /// Mass moments before the hinges.
    pub(super) before: [MassMoments; 4],
}

impl FourLink {
    /// Mechanism with hinges at the given sections, in radians from the left springing.
    ///
    /// `None` when the sections are not in ascending order within the ring, or when a hinge would
    /// have to close.
    pub fn new(profile: &dyn Profile, hinges_rad: [f64; 4]) -> Option<Self> {
        let [first, .., last] = hinges_rad;
        if !(first >= 0.0 && last <= profile.end() && hinges_rad.is_sorted_by(|a, b| a < b)) {
            return None;
        }
        let points = std::array::from_fn(|i| profile.point(hinges_rad[i], EDGES[i]));
        let openings = openings(&points)?;
        Some(Self {
            hinges_rad,
            openings: openings.map(|opening| opening / -openings[0]),
            points,
            before: hinges_rad.map(|hinge| profile.moments_to(hinge)),
        })
    }

    /// Sections (in radians from the left springing) and edges of the hinges from left to right, as seen when the mechanism sways to the
    /// given side.
    pub fn hinges_from_left(&self, profile: &dyn Profile, sway: Sway) -> [(f64, Edge); 4] {
        std::array::from_fn(|i| match sway {
            Sway::Right => (self.hinges_rad[i], EDGES[i]),
            Sway::Left => (
                sway.convert_section(profile, self.hinges_rad[3 - i]),
                EDGES[3 - i],
            ),
        })
    }

    /// Hinges from left to right with the names of their sections: angles of a ring, joints of a row.
    pub fn named_hinges_from_left(&self, profile: &dyn Profile, sway: Sway) -> [Hinge; 4] {
        self.hinges_from_left(profile, sway)
            .map(|(section, edge)| match profile.joint(section) {
                Some(joint) => Hinge::Joint {
                    joint,
                    edge: Some(edge),
                },
                None => Hinge::Section {
                    angle_rad: section,
                    edge,
                },
            })
    }

    /// Velocity field at `q' = 1`.
    ///
    /// Every hinge adds a rotation about itself to the motion of all that lies to its right; this
    /// needs no division by distances between centres, unlike Eq. (2) of the paper.
    pub fn field(&self) -> Field {
        let jumps: [(f64, Twist); 4] = std::array::from_fn(|i| {
            (
                self.hinges_rad[i],
                Twist::rotation(self.points[i], self.openings[i]),
            )
        });
        Field::with_moments(self.before.to_vec(), &jumps)
    }
}

/// Sections at which hinges may form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HingeSites {
    /// At any section.
    Anywhere,
    /// At the joints of this many equal voussoirs, the springings included; at least three.
    Voussoirs(usize),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::field::Side;
    use crate::mechanics::geometry::ring::Ring;

    fn semicircle() -> (Ring, FourLink) {
        let ring = Ring::new(0.15, std::f64::consts::PI).unwrap();
        let hinges = [24.0_f64, 82.0, 140.0, 180.0].map(f64::to_radians);
        (ring, FourLink::new(&ring, hinges).unwrap())
    }

    #[test]
    fn the_field_is_continuous_at_hinges_and_zero_outside() {
        let (_, mechanism) = semicircle();
        let field = mechanism.field();
        for (angle, point) in mechanism.hinges_rad.into_iter().zip(mechanism.points) {
            let jump = field.twist_at(angle, Side::After).velocity_at(point)
                - field.twist_at(angle, Side::Before).velocity_at(point);
            assert!(jump.norm() < 1e-15);
        }
        let after = field.twist_at(3.2, Side::After);
        assert!(after.rate.abs() < 1e-15 && after.at_center.norm() < 1e-15);
        assert!((field.twist_at(1.0, Side::After).rate + 1.0).abs() < 1e-15);
    }

    #[test]
    fn rates_agree_with_the_centres_of_rotation() {
        // Eq. (2) of the paper with all rotations anticlockwise: the middle body's centre C3 is where
        // AB and CD meet, k31 = (x_B - x_A) / (x_B - x_C3), and likewise from the right.
        let (_, mechanism) = semicircle();
        let [a, b, c, d] = mechanism.points;
        let (ab, cd) = (b - a, d - c);
        let center = a + ab * ((c - a).perp(&cd) / ab.perp(&cd));
        let field = mechanism.field();
        let rate = |angle: f64| field.twist_at(angle.to_radians(), Side::After).rate;
        let k31 = (b.x - a.x) / (b.x - center.x);
        let k32 = (c.x - d.x) / (c.x - center.x);
        assert!((rate(100.0) / rate(50.0) - k31).abs() < 1e-12);
        assert!((rate(100.0) / rate(170.0) - k32).abs() < 1e-12);
    }

    #[test]
    fn every_hinge_opens() {
        let (ring, mechanism) = semicircle();
        let field = mechanism.field();
        for (angle, edge) in mechanism.hinges_rad.into_iter().zip(EDGES) {
            let far = ring.point(angle, edge.opposite());
            let gap = field.twist_at(angle, Side::After).velocity_at(far)
                - field.twist_at(angle, Side::Before).velocity_at(far);
            assert!(gap.dot(&ring.tangent(angle)) > 0.0);
        }
    }

    #[test]
    fn unordered_or_closing_hinges_are_no_mechanism() {
        let ring = Ring::new(0.15, std::f64::consts::PI).unwrap();
        let mechanism = |hinges: [f64; 4]| FourLink::new(&ring, hinges.map(f64::to_radians));
        assert!(mechanism([24.0, 24.0, 140.0, 180.0]).is_none());
        assert!(mechanism([24.0, 82.0, 140.0, 180.1]).is_none());
        assert!(mechanism([f64::NAN, 82.0, 140.0, 180.0]).is_none());
        // The intrados hinge C lies below the line from B to D, and would have to close.
        assert!(mechanism([0.0, 160.0, 170.0, 180.0]).is_none());
    }
}
