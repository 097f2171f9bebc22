//! Four-link mechanism at finite rotations: a four-bar linkage in closed form.
//!
//! Between impacts the hinges stay at the same points of the material. A, D and the ground form one bar, the three moving bodies the others. The
//! coordinate `q` is the **clockwise rotation of the left body** A-B (of the mechanism that sways right). While the arch falls, the angle at B
//! flattens until A, B and C are on one line, the limit position of the right body. With the right body's rotation as coordinate, the rates of the
//! others would be infinite there. With that of the left body all rates are finite, and the equation of motion stays well conditioned beyond the
//! limit.

use std::sync::Arc;

use nalgebra::Vector2;

use super::mechanism::FourLink;
use super::thrust::{PartLoad, ProfileSection, ThrustLine, ThrustPart, demand_at_sections};
use crate::mechanics::chain::{Coefficients, MechanismState};
use crate::mechanics::geometry::field::quarter_turn;
use crate::mechanics::geometry::pose::product;
use crate::mechanics::{Demand, MassMoments, Mechanism, Momentum, Pose, Profile};

/// A body of the linkage, about the pivot at which its bar begins.
#[derive(Clone, Copy, Debug)]
struct LinkageBody {
    /// Undeformed bar of the body.
    bar: Vector2<f64>,
    /// First mass moment over the bar, as complex numbers; this ratio is constant, because both rotate together.
    first_per_bar: Vector2<f64>,
    /// Polar mass moment.
    polar: f64,
}

impl LinkageBody {
    fn new(moments: &MassMoments, pivot: Vector2<f64>, bar: Vector2<f64>) -> Self {
        let first = moments.first - pivot * moments.mass;
        Self {
            bar,
            first_per_bar: Vector2::new(bar.dot(&first), bar.perp(&first)) / bar.norm_squared(),
            polar: moments.polar - 2.0 * moments.first.dot(&pivot)
                + moments.mass * pivot.norm_squared(),
        }
    }

    /// Body with a point mass at the end of the bar.
    fn loaded(self, mass: f64) -> Self {
        Self {
            first_per_bar: self.first_per_bar + Vector2::new(mass, 0.0),
            polar: self.polar + mass * self.bar.norm_squared(),
            ..self
        }
    }

    /// First mass moment when the bar is `bar`.
    fn first(&self, bar: Vector2<f64>) -> Vector2<f64> {
        product(bar, self.first_per_bar)
    }
}

/// Four-bar linkage of a mechanism that sways right; lengths in mean radii, unit density.
///
/// The middle body moves with B and rotates about B; its mass counts as a load of the left body at B.
#[derive(Clone, Debug)]
pub struct Linkage {
    profile: Arc<dyn Profile>,
    mechanism: FourLink,
    /// Bar A-B.
    left: LinkageBody,
    /// Bar B-C.
    middle: LinkageBody,
    /// Bar D-C.
    right: LinkageBody,
    /// Vector from A to D.
    ground: Vector2<f64>,
}

/// Bars at a given `q`.
struct Bars {
    left: Vector2<f64>,
    middle: Vector2<f64>,
    right: Vector2<f64>,
    /// Inverse of the cross product of the middle and the right bar.
    per_cross: f64,
}

/// Unit complex number that turns `from` into `to`, vectors of equal length.
fn turn_between(from: Vector2<f64>, to: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(from.dot(&to), from.perp(&to)) / from.norm_squared()
}

/// Reverses the rotation by the angle of the unit complex number `turn`.
fn rotate_back(turn: Vector2<f64>, v: Vector2<f64>) -> Vector2<f64> {
    product(Vector2::new(turn.x, -turn.y), v)
}

/// Angle from the direction of `from` to that of `to`.
fn angle_between(from: Vector2<f64>, to: Vector2<f64>) -> f64 {
    libm::atan2(from.perp(&to), from.dot(&to))
}

impl Linkage {
    /// Linkage of `mechanism`.
    pub fn new(profile: &dyn Profile, mechanism: &FourLink) -> Self {
        let [point_a, point_b, point_c, point_d] = mechanism.points;
        let [left, middle, right] = Self::sectors(&mechanism.before);
        Self {
            profile: profile.to_shared(),
            mechanism: *mechanism,
            left: LinkageBody::new(&left, point_a, point_b - point_a).loaded(middle.mass),
            middle: LinkageBody::new(&middle, point_b, point_c - point_b),
            right: LinkageBody::new(&right, point_d, point_c - point_d),
            ground: point_d - point_a,
        }
    }

    /// Mass moments of the three bodies.
    fn sectors(before: &[MassMoments; 4]) -> [MassMoments; 3] {
        std::array::from_fn(|body| before[body + 1] - before[body])
    }

    /// Solves the loop A-B-C-D for the pose at `q`, on the branch continuous with `q = 0`.
    ///
    /// NaN where the bars B-C and C-D do not reach each other.
    fn bars(&self, q_rad: f64) -> Bars {
        let (sin, cos) = libm::sincos(q_rad);
        let left = product(self.left.bar, Vector2::new(cos, -sin));
        // C is where the circles about B and D meet, on the left of the line from B to D.
        let line = self.ground - left;
        let square = line.norm_squared();
        let [middle_square, right_square] =
            [self.middle.bar, self.right.bar].map(|bar| bar.norm_squared());
        // Dot and cross product of the line and the middle bar.
        let along = 0.5 * (square + middle_square - right_square);
        let cross = (middle_square * square - along * along).sqrt();
        let middle = (line * along + quarter_turn(line) * cross) * square.recip();
        Bars {
            left,
            middle,
            right: middle - line,
            per_cross: cross.recip(),
        }
    }

    /// Rotation rates of the middle and the right body per unit `q'`; that of the left body is -1. They satisfy the closure of
    /// velocities.
    fn rates(bars: &Bars) -> (f64, f64) {
        let [middle, right] = [bars.right, bars.middle].map(|bar| bars.left.perp(&bar));
        (middle * bars.per_cross, right * bars.per_cross)
    }

    /// Derivatives by `q` of the rates of the middle and the right body. They satisfy the closure of accelerations, with known
    /// accelerations along the bars.
    fn slopes(bars: &Bars, middle_rate: f64, right_rate: f64) -> (f64, f64) {
        let inward = bars.left + bars.middle * (middle_rate * middle_rate)
            - bars.right * (right_rate * right_rate);
        let [middle, right] = [bars.right, bars.middle].map(|bar| inward.dot(&bar));
        (middle * bars.per_cross, right * bars.per_cross)
    }

    /// Thrust line in motion, from the dynamic equilibrium of the three bodies.
    ///
    /// The moments of the right body about D and of the middle body about B give the force at C, and the
    /// equilibrium of forces the others. `B-C` and `C-D` are never on one line before the limit position.
    /// The equation of motion makes the line pass through B on the left body's side as well.
    pub fn thrust_line(&self, motion: &MechanismState) -> ThrustLine {
        ThrustLine::new(&*self.profile, self.parts(motion).to_vec())
    }

    /// Thrust excess and friction demand in motion at these sections of the profile.
    pub(crate) fn demand_at_sections(
        &self,
        motion: &MechanismState,
        sections: &[ProfileSection],
    ) -> Demand {
        demand_at_sections(&self.parts(motion), sections)
    }

    /// Parts of the thrust line in motion.
    fn parts(&self, motion: &MechanismState) -> [ThrustPart; 5] {
        let bars = self.bars(motion.q_rad);
        let (middle_rate, right_rate) = Self::rates(&bars);
        let (middle_slope, right_slope) = Self::slopes(&bars, middle_rate, right_rate);
        let square = motion.rate * motion.rate;
        let spin = |(rate, slope): (f64, f64)| {
            let acceleration = rate * motion.acceleration + slope * square;
            (acceleration, rate * rate * square)
        };
        let rates = [
            (-1.0, 0.0),
            (middle_rate, middle_slope),
            (right_rate, right_slope),
        ];
        let [left_spin, middle_spin, right_spin] = rates.map(spin);
        let turn_left = turn_between(self.left.bar, bars.left);
        let turn_middle = turn_between(self.middle.bar, bars.middle);
        let turn_right = turn_between(self.right.bar, bars.right);
        let force = motion.body_force_g;
        let at_b = quarter_turn(bars.left) * left_spin.0 - bars.left * left_spin.1;
        let [point_a, point_b, _, point_d] = self.mechanism.points;
        let left = PartLoad::of_body(point_a, rotate_back(turn_left, force), left_spin);
        let middle =
            PartLoad::of_body(point_b, rotate_back(turn_middle, force - at_b), middle_spin);
        let right = PartLoad::of_body(point_d, rotate_back(turn_right, force), right_spin);

        let [a, b, c, d] = self.mechanism.hinges_rad;
        let sectors = Self::sectors(&self.mechanism.before);
        let on_left = left.resultant(&sectors[0]);
        let on_middle = middle.resultant(&sectors[1]);
        let on_right = right.resultant(&sectors[2]);
        let force_c = (bars.right * on_middle.moment_about(point_b)
            + bars.middle * on_right.moment_about(point_d))
            * bars.per_cross;
        let force_b = force_c - product(turn_middle, on_middle.linear);
        let force_a = force_b - product(turn_left, on_left.linear);
        let force_d = force_c + product(turn_right, on_right.linear);

        let still = PartLoad::uniform(force);
        let part = |hinge: usize, end_rad: f64, load: PartLoad, force: Vector2<f64>| {
            let at_hinge = Momentum::applied_at(self.mechanism.points[hinge], force);
            ThrustPart::after(&self.mechanism.before[hinge], end_rad, load, at_hinge)
        };
        [
            part(0, a, still, force_a),
            part(0, b, left, rotate_back(turn_left, force_a)),
            part(1, c, middle, rotate_back(turn_middle, force_b)),
            part(2, d, right, rotate_back(turn_right, force_c)),
            part(3, self.profile.end(), still, force_d),
        ]
    }

    /// Limit position: the smallest `q` at which A, B, C, or else C, D, A, are on one line, so that the right body or the ground bar
    /// cannot move further.
    pub fn limit_rad(&self) -> f64 {
        let [left, middle, right, base] =
            [self.left.bar, self.middle.bar, self.right.bar, self.ground].map(|bar| bar.norm());
        let cosine = |near: f64, other: f64, opposite: f64| {
            (near * near + other * other - opposite * opposite) / (2.0 * near * other)
        };
        // Angle from A-D to A-B, undeformed and at the limit.
        let start = angle_between(self.ground, self.left.bar);
        let end = if left + middle < right + base {
            libm::acos(cosine(left + middle, base, right))
        } else {
            libm::acos(cosine(left, right + base, middle))
        };
        start - end
    }
}

impl Mechanism for Linkage {
    /// Left, middle and right body.
    type Rotations = [f64; 3];
    const BODIES: &'static [&'static str] = &["left", "middle", "right"];

    fn moments(&self) -> Vec<MassMoments> {
        Self::sectors(&self.mechanism.before).to_vec()
    }

    /// Coefficients of the equation of motion at `q`, masses in `rho d R^2`, lengths in `R`.
    fn coefficients(&self, q_rad: f64) -> Coefficients {
        let bars = self.bars(q_rad);
        let (middle_rate, right_rate) = Self::rates(&bars);
        let (middle_slope, right_slope) = Self::slopes(&bars, middle_rate, right_rate);
        let first = self.middle.first(bars.middle);
        let path = quarter_turn(
            first * middle_rate + self.right.first(bars.right) * right_rate
                - self.left.first(bars.left),
        );
        // The middle body moves with B and rotates about B, which couples its rate with that of the left body.
        let coupling = bars.left.dot(&first);
        let coupling_slope = -(1.0 + middle_rate) * bars.left.perp(&first);
        Coefficients {
            inertia: self.left.polar
                + self.middle.polar * middle_rate * middle_rate
                + self.right.polar * right_rate * right_rate
                - 2.0 * coupling * middle_rate,
            inertia_slope: 2.0
                * ((self.middle.polar * middle_rate - coupling) * middle_slope
                    + self.right.polar * right_rate * right_slope
                    - coupling_slope * middle_rate),
            s_x: path.x,
            s_y: path.y,
            s_f: 0.0,
        }
    }

    /// Mass times the displacement of the common centre of gravity at `q`: the integrals of `S_x` and `S_y` from zero. The second one
    /// times gravity is the potential energy.
    fn displacement(&self, q_rad: f64) -> Vector2<f64> {
        let bars = self.bars(q_rad);
        self.left.first(bars.left - self.left.bar)
            + self.middle.first(bars.middle - self.middle.bar)
            + self.right.first(bars.right - self.right.bar)
    }

    /// Rotations of the three bodies at `q`.
    fn rotations(&self, q_rad: f64) -> [f64; 3] {
        let bars = self.bars(q_rad);
        let middle = angle_between(self.middle.bar, bars.middle);
        [-q_rad, middle, angle_between(self.right.bar, bars.right)]
    }

    /// Rotation rates of the three bodies at `q` for `q' = 1`.
    fn rotation_rates(&self, q_rad: f64) -> [f64; 3] {
        let (middle, right) = Self::rates(&self.bars(q_rad));
        [-1.0, middle, right]
    }

    /// Writes poses and hinges, in mean radii from the centre of the ring.
    fn write_poses(&self, q_rad: f64, poses: &mut Vec<Pose>, hinges: &mut Vec<Vector2<f64>>) {
        let bars = self.bars(q_rad);
        let [point_a, point_b, _, point_d] = self.mechanism.points;
        let at_b = point_a + bars.left;
        let middle_rad = angle_between(self.middle.bar, bars.middle);
        let right_rad = angle_between(self.right.bar, bars.right);
        poses.clear();
        poses.extend([
            Pose::about(point_a, point_a, -q_rad),
            Pose::about(point_b, at_b, middle_rad),
            Pose::about(point_d, point_d, right_rad),
        ]);
        hinges.clear();
        hinges.extend([point_a, at_b, at_b + bars.middle, point_d]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::four_link::limit::incipient;
    use crate::mechanics::four_link::mechanism::HingeSites;
    use crate::mechanics::geometry::ring::Ring;
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
            prop_assert!((slope - Vector2::new(exact.s_x, exact.s_y)).norm() < 1e-8);
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
            let bars = linkage.bars(part * linkage.limit_rad());
            let end = bars.left + bars.middle - bars.right;
            prop_assert!((end - linkage.ground).norm() < 1e-14);
            prop_assert!((bars.right.norm() - linkage.right.bar.norm()).abs() < 1e-14);
            prop_assert!((bars.middle.norm() - linkage.middle.bar.norm()).abs() < 1e-14);
            prop_assert!((bars.middle.perp(&bars.right) - bars.per_cross.recip()).abs() < 1e-14);
        }
    }

    #[test]
    fn at_rest_the_linkage_is_the_velocity_field() {
        let (ring, mechanism, linkage) = semicircle();
        let field = mechanism.field();
        let coefficients = linkage.coefficients(0.0);
        assert!((coefficients.inertia - field.product(&field, &ring)).abs() < 1e-14);
        let ratio = coefficients.s_y / coefficients.s_x;
        assert!(
            (ratio - crate::mechanics::four_link::limit::acceleration_g(&mechanism, &ring)).abs()
                < 1e-12
        );
        assert!(linkage.displacement(0.0).norm() < 1e-15);
        assert!(
            linkage
                .rotations(0.0)
                .iter()
                .all(|angle| angle.abs() < 1e-15)
        );
    }
}
