//! The four-link mechanism at finite rotations: a four-bar linkage in closed form.
//!
//! Between impacts the hinges stay where they are in the material. A, D and the ground are one bar, the
//! three moving bodies the others. The coordinate `q` is the **clockwise rotation of the left body** A-B
//! (of the mechanism that sways right): while the arch falls, B flattens until A, B and C are on one
//! line, which is the limit position of the right body. Seen from the right body the others would there
//! turn infinitely fast; seen from the left body nothing happens, and the equation of motion stays
//! well conditioned beyond the limit.

use nalgebra::Vector2;

use super::field::{Momentum, turned};
use super::mechanism::FourLink;
use super::ring::{MassMoments, Ring};
use super::structure::{Coefficients, Mechanism, Motion};
use super::thrust::{Load, Part, ThrustLine};

/// A rigid body that is part of the linkage, about a point of its own.
#[derive(Clone, Copy, Debug)]
struct Body {
    mass: f64,
    /// Centre of gravity relative to the point, undeformed.
    arm: Vector2<f64>,
    /// Polar moment about the point.
    polar: f64,
}

impl Body {
    fn new(moments: &MassMoments, pole: Vector2<f64>) -> Self {
        Self {
            mass: moments.mass,
            arm: moments.centroid() - pole,
            polar: moments.polar_about(pole),
        }
    }
}

/// The four-bar linkage of a mechanism that sways right; lengths in mean radii, unit density.
#[derive(Clone, Copy, Debug)]
pub struct Linkage {
    ring: Ring,
    hinges_rad: [f64; 4],
    points: [Vector2<f64>; 4],
    left: Body,
    /// About hinge B.
    middle: Body,
    right: Body,
    /// Undeformed bars A-B, B-C and D-C.
    bar_left: Vector2<f64>,
    bar_middle: Vector2<f64>,
    bar_right: Vector2<f64>,
}

/// Configuration at some `q`: the bars, and the rotations of their bodies as unit complex numbers.
struct Pose {
    bar_left: Vector2<f64>,
    bar_middle: Vector2<f64>,
    bar_right: Vector2<f64>,
    turn_left: Vector2<f64>,
    turn_middle: Vector2<f64>,
    turn_right: Vector2<f64>,
}

/// Rotates `v` by the angle of the unit complex number `turn`.
fn rotate(turn: Vector2<f64>, v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(turn.x * v.x - turn.y * v.y, turn.x * v.y + turn.y * v.x)
}

/// Undoes [`rotate`].
fn rotate_back(turn: Vector2<f64>, v: Vector2<f64>) -> Vector2<f64> {
    rotate(Vector2::new(turn.x, -turn.y), v)
}

/// The unit complex number that turns `from` into `to`, vectors of equal length.
fn turn_between(from: Vector2<f64>, to: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(from.dot(&to), from.perp(&to)) / from.norm_squared()
}

impl Linkage {
    /// The linkage of `mechanism`.
    #[must_use]
    pub fn new(ring: &Ring, mechanism: &FourLink) -> Self {
        let [a, b, c, d] = mechanism.hinges_rad();
        let [point_a, point_b, point_c, point_d] = mechanism.points();
        Self {
            ring: *ring,
            hinges_rad: mechanism.hinges_rad(),
            points: mechanism.points(),
            left: Body::new(&ring.sector(a, b), point_a),
            middle: Body::new(&ring.sector(b, c), point_b),
            right: Body::new(&ring.sector(c, d), point_d),
            bar_left: point_b - point_a,
            bar_middle: point_c - point_b,
            bar_right: point_c - point_d,
        }
    }

    /// Solves the loop A-B-C-D for the pose at `q`, on the branch continuous with `q = 0`.
    ///
    /// Not a number where the bars B-C and C-D do not reach each other.
    fn pose(&self, q_rad: f64) -> Pose {
        let (sin, cos) = q_rad.sin_cos();
        let turn_left = Vector2::new(cos, -sin);
        let bar_left = rotate(turn_left, self.bar_left);
        // C is where the circles about B and D meet, on the left of the line from B to D.
        let line = self.ground_bar() - bar_left;
        let square = line.norm_squared();
        let middle_square = self.bar_middle.norm_squared();
        let along = 0.5 * (1.0 + (middle_square - self.bar_right.norm_squared()) / square);
        let across = (middle_square / square - along * along).sqrt();
        let bar_middle = line * along + turned(line) * across;
        let bar_right = bar_middle - line;
        Pose {
            bar_left,
            bar_middle,
            bar_right,
            turn_left,
            turn_middle: turn_between(self.bar_middle, bar_middle),
            turn_right: turn_between(self.bar_right, bar_right),
        }
    }

    /// Rotation rates of the bodies per unit `q'`: the loop's velocities closed by cross products.
    fn rates(pose: &Pose) -> (f64, f64, f64) {
        let cross = pose.bar_middle.perp(&pose.bar_right);
        let middle = pose.bar_left.perp(&pose.bar_right) / cross;
        let right = pose.bar_left.perp(&pose.bar_middle) / cross;
        (-1.0, middle, right)
    }

    /// Derivatives of the rates of the middle and the right body with respect to `q`: the loop's
    /// accelerations, with those along the bars on the right.
    fn slopes(pose: &Pose, middle_rate: f64, right_rate: f64) -> (f64, f64) {
        let inward = pose.bar_left + pose.bar_middle * (middle_rate * middle_rate)
            - pose.bar_right * (right_rate * right_rate);
        let cross = pose.bar_middle.perp(&pose.bar_right);
        (
            inward.dot(&pose.bar_right) / cross,
            inward.dot(&pose.bar_middle) / cross,
        )
    }

    /// From A to D.
    fn ground_bar(&self) -> Vector2<f64> {
        self.points[3] - self.points[0]
    }

    /// The thrust line in motion: from the dynamic equilibrium of the three bodies.
    ///
    /// The moments of the right body about D and of the middle body about B give the force at C, and
    /// forces alone the others. `B-C` and `C-D` are never on one line before the limit position. That the
    /// line passes through B on the left body's side as well is the equation of motion.
    #[must_use]
    pub fn thrust_line(&self, motion: &Motion) -> ThrustLine {
        let pose = self.pose(motion.q_rad);
        let (left_rate, middle_rate, right_rate) = Self::rates(&pose);
        let (middle_slope, right_slope) = Self::slopes(&pose, middle_rate, right_rate);
        let square = motion.rate * motion.rate;
        let spin = |rate: f64, slope: f64| {
            (
                rate * motion.acceleration + slope * square,
                rate * rate * square,
            )
        };
        let (left_spin, middle_spin, right_spin) = (
            spin(left_rate, 0.0),
            spin(middle_rate, middle_slope),
            spin(right_rate, right_slope),
        );
        let body_force = motion.body_force_g;
        let at_b = turned(pose.bar_left) * left_spin.0 - pose.bar_left * left_spin.1;
        let [point_a, point_b, _, point_d] = self.points;
        let left = Load::of_body(point_a, rotate_back(pose.turn_left, body_force), left_spin);
        let middle = Load::of_body(
            point_b,
            rotate_back(pose.turn_middle, body_force - at_b),
            middle_spin,
        );
        let right = Load::of_body(
            point_d,
            rotate_back(pose.turn_right, body_force),
            right_spin,
        );

        let [a, b, c, d] = self.hinges_rad;
        let on_left = left.resultant(&self.ring.sector(a, b));
        let on_middle = middle.resultant(&self.ring.sector(b, c));
        let on_right = right.resultant(&self.ring.sector(c, d));
        let force_c = (pose.bar_right * on_middle.about(point_b)
            + pose.bar_middle * on_right.about(point_d))
            / pose.bar_middle.perp(&pose.bar_right);
        let force_b = force_c - rotate(pose.turn_middle, on_middle.linear);
        let force_a = force_b - rotate(pose.turn_left, on_left.linear);
        let force_d = force_c + rotate(pose.turn_right, on_right.linear);

        let still = Load::uniform(body_force);
        let part = |hinge: usize, end_rad: f64, load: Load, force: Vector2<f64>| {
            let at_hinge = Momentum::applied_at(self.points[hinge], force);
            let known = (self.hinges_rad[hinge], at_hinge);
            Part::new(&self.ring, end_rad, load, known)
        };
        ThrustLine::new(
            &self.ring,
            vec![
                part(0, a, still, force_a),
                part(0, b, left, rotate_back(pose.turn_left, force_a)),
                part(1, c, middle, rotate_back(pose.turn_middle, force_b)),
                part(2, d, right, rotate_back(pose.turn_right, force_c)),
                part(3, self.ring.embrace_rad(), still, force_d),
            ],
        )
    }

    /// The limit position: the least `q` at which A, B, C, or else C, D, A, are on one line, so that
    /// the right body or the ground bar cannot follow any further.
    #[must_use]
    pub fn limit_rad(&self) -> f64 {
        let ground = self.ground_bar();
        let [left, middle, right, base] =
            [self.bar_left, self.bar_middle, self.bar_right, ground].map(|bar| bar.norm());
        let cosine = |near: f64, other: f64, opposite: f64| {
            (near * near + other * other - opposite * opposite) / (2.0 * near * other)
        };
        // Angle from A-D to A-B, undeformed and at the limit.
        let start = ground
            .perp(&self.bar_left)
            .atan2(ground.dot(&self.bar_left));
        let end = if left + middle < right + base {
            cosine(left + middle, base, right).acos()
        } else {
            cosine(left, right + base, middle).acos()
        };
        start - end
    }
}

impl Mechanism for Linkage {
    /// Left, middle and right body.
    type Rotations = [f64; 3];
    const BODIES: &'static [&'static str] = &["left", "middle", "right"];

    /// Coefficients of the equation of motion at `q`, masses in `rho d R^2`, lengths in `R`.
    fn coefficients(&self, q_rad: f64) -> Coefficients {
        let pose = self.pose(q_rad);
        let (left_rate, middle_rate, right_rate) = Self::rates(&pose);
        let (middle_slope, right_slope) = Self::slopes(&pose, middle_rate, right_rate);
        let arm = rotate(pose.turn_middle, self.middle.arm);
        let at_b = turned(pose.bar_left) * left_rate;
        let middle_velocity = at_b + turned(arm) * middle_rate;
        let middle_velocity_slope =
            turned(arm) * middle_slope - arm * (middle_rate * middle_rate) - pose.bar_left;
        let central_polar = self.middle.polar - self.middle.mass * self.middle.arm.norm_squared();

        let left_arm = rotate(pose.turn_left, self.left.arm);
        let right_arm = rotate(pose.turn_right, self.right.arm);
        let path = turned(left_arm) * (self.left.mass * left_rate)
            + middle_velocity * self.middle.mass
            + turned(right_arm) * (self.right.mass * right_rate);
        Coefficients {
            inertia: self.left.polar
                + self.right.polar * right_rate * right_rate
                + self.middle.mass * middle_velocity.norm_squared()
                + central_polar * middle_rate * middle_rate,
            inertia_slope: 2.0
                * (self.right.polar * right_rate * right_slope
                    + self.middle.mass * middle_velocity.dot(&middle_velocity_slope)
                    + central_polar * middle_rate * middle_slope),
            sway: path.x,
            rise: path.y,
        }
    }

    /// Mass times displacement of the common centre of gravity at `q`: the integrals of `S_x` and
    /// `S_y` from zero. Times gravity the second is the potential energy.
    fn displacement(&self, q_rad: f64) -> Vector2<f64> {
        let pose = self.pose(q_rad);
        let left = rotate(pose.turn_left, self.left.arm) - self.left.arm;
        let middle = pose.bar_left - self.bar_left + rotate(pose.turn_middle, self.middle.arm)
            - self.middle.arm;
        let right = rotate(pose.turn_right, self.right.arm) - self.right.arm;
        left * self.left.mass + middle * self.middle.mass + right * self.right.mass
    }

    /// Rotations of the three bodies at `q`.
    fn rotations(&self, q_rad: f64) -> [f64; 3] {
        let pose = self.pose(q_rad);
        let angle = |turn: Vector2<f64>| turn.y.atan2(turn.x);
        [-q_rad, angle(pose.turn_middle), angle(pose.turn_right)]
    }

    /// Rotation rates of the three bodies at `q` for `q' = 1`.
    fn rotation_rates(&self, q_rad: f64) -> [f64; 3] {
        let (left, middle, right) = Self::rates(&self.pose(q_rad));
        [left, middle, right]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::limit::incipient;
    use crate::mechanics::mechanism::HingeSites;
    use proptest::prelude::*;

    fn linkage(
        thickness_ratio: f64,
        embrace_deg: f64,
        sites: HingeSites,
    ) -> (Ring, FourLink, Linkage) {
        let ring = Ring::new(thickness_ratio, embrace_deg.to_radians()).unwrap();
        let mechanism = incipient(&ring, sites).unwrap().mechanism;
        (ring, mechanism, Linkage::new(&ring, &mechanism))
    }

    fn semicircle() -> (Ring, FourLink, Linkage) {
        linkage(0.15, 180.0, HingeSites::Anywhere)
    }

    #[test]
    fn the_limit_of_the_semicircle_is_the_published_one() {
        let (_, _, linkage) = semicircle();
        let [_, _, right] = linkage.rotations(linkage.limit_rad());
        assert!((right + 0.557).abs() < 5e-4, "{right}");
    }

    proptest! {
        /// Derivatives of positions by central differences, which err by h^2 and by 1e-16/h.
        #[test]
        fn coefficients_are_derivatives(part in 0.01_f64..0.95, thick in 0.12_f64..0.3) {
            let (_, _, linkage) = linkage(thick, 180.0, HingeSites::Anywhere);
            let q = part * linkage.limit_rad();
            let h = 1e-5;
            let exact = linkage.coefficients(q);
            let slope = (linkage.displacement(q + h) - linkage.displacement(q - h)) / (2.0 * h);
            prop_assert!((slope - Vector2::new(exact.sway, exact.rise)).norm() < 1e-8);
            let inertia = |q| linkage.coefficients(q).inertia;
            let slope = (inertia(q + h) - inertia(q - h)) / (2.0 * h);
            prop_assert!((slope - exact.inertia_slope).abs() < 1e-6 * (1.0 + slope.abs()));
            let (after, before) = (linkage.rotations(q + h), linkage.rotations(q - h));
            for (i, rate) in linkage.rotation_rates(q).into_iter().enumerate() {
                prop_assert!(((after[i] - before[i]) / (2.0 * h) - rate).abs() < 1e-7 * (1.0 + rate.abs()));
            }
        }

        /// The loop stays closed: the bars end at the other pivot, with their lengths kept.
        #[test]
        fn the_loop_is_closed(part in 0.0_f64..1.2) {
            let (_, _, linkage) = semicircle();
            let pose = linkage.pose(part * linkage.limit_rad());
            let end = pose.bar_left + pose.bar_middle - pose.bar_right;
            prop_assert!((end - linkage.ground_bar()).norm() < 1e-14);
            prop_assert!((pose.bar_right.norm() - linkage.bar_right.norm()).abs() < 1e-14);
            prop_assert!((pose.bar_middle.norm() - linkage.bar_middle.norm()).abs() < 1e-14);
        }
    }

    #[test]
    fn at_rest_the_linkage_is_the_velocity_field() {
        let (ring, mechanism, linkage) = semicircle();
        let field = mechanism.field();
        let coefficients = linkage.coefficients(0.0);
        assert!((coefficients.inertia - field.product(&field, &ring)).abs() < 1e-14);
        let ratio = coefficients.rise / coefficients.sway;
        assert!((ratio - crate::mechanics::limit::acceleration_g(&mechanism, &ring)).abs() < 1e-12);
        assert!(linkage.displacement(0.0).norm() < 1e-15);
        assert!(
            linkage
                .rotations(0.0)
                .iter()
                .all(|angle| angle.abs() < 1e-15)
        );
    }
}
