//! The relative position of the two faces of a joint.

use crate::mechanics::lanes::{Real, both};

/// Where a body is: how far its centre has moved, and how it has turned.
#[derive(Clone, Copy, Debug)]
pub struct Place<R> {
    /// Displacement of the centre, in m.
    pub moved_m: [R; 2],
    /// Cosine less one, and sine, of the rotation: small rotations keep all their digits.
    pub turn: [R; 2],
}

impl<R: Real> Place<R> {
    /// Undeformed.
    #[must_use]
    pub fn undeformed() -> Self {
        let zero = R::of(0.0);
        Self {
            moved_m: [zero; 2],
            turn: [zero; 2],
        }
    }

    /// Moved and turned by this much, in m and rad.
    #[must_use]
    pub fn at(moved: &[f64; 3]) -> Self {
        let half = (0.5 * moved[2]).sin();
        Self {
            moved_m: [R::of(moved[0]), R::of(moved[1])],
            turn: [R::of(-2.0 * half * half), R::of(moved[2].sin())],
        }
    }

    /// How far rotation moves the end of an arm that starts at the centre.
    #[inline(always)]
    pub(super) fn swing(&self, arm_m: [f64; 2]) -> [R; 2] {
        let [cos, sin] = self.turn;
        let [x, y] = arm_m;
        [cos * x - sin * y, sin * x + cos * y]
    }
}

/// What a joint joins, undeformed: the first body is before the joint, the second one after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The indices of the two bodies.
    pub bodies: [usize; 2],
    /// From the centres of the bodies to the middle of the joint, in m.
    pub arms_m: [[f64; 2]; 2],
    /// Unit vector along the joint, from edge 0 (intrados) to edge 1 (extrados).
    pub along: [f64; 2],
    /// 1 where the second body is to the left of that vector, else -1.
    pub handedness: f64,
    /// Length of the joint, in m.
    pub length_m: f64,
}

/// The relative position of the faces of a joint.
#[derive(Clone, Copy, Debug)]
pub struct Gap<R> {
    /// By how much they penetrate each other at edge 0 and edge 1, in m; in between it changes linearly.
    pub penetrations_m: [R; 2],
    /// By how much the second face has slipped towards edge 1, in m.
    pub slip_m: R,
    /// Mean direction of the faces.
    along: [R; 2],
    /// Normal of that, towards the second body.
    normal: [R; 2],
    /// Cosine of half the angle between the faces, times the handedness and half the length.
    half_cos: R,
    /// From the centres of the bodies to midway between the middles of the faces.
    levers_m: [[R; 2]; 2],
}

/// The action of a joint on its two bodies, at their centres.
#[derive(Clone, Copy, Debug)]
pub struct Action<R> {
    /// Force on the second body, in N; the first one feels its opposite.
    pub force_n: [R; 2],
    /// Moments on the first and on the second body, in N m.
    pub moments_n_m: [R; 2],
}

impl Link {
    /// The relative position of the faces with the bodies at these places.
    ///
    /// With `e_a`, `e_b` the directions of the faces, `e` the mean direction and `n` its normal, `e_b - e_a` is along `n` whatever the
    /// angle. So the gap is linear along the joint, and the slip the same everywhere.
    #[inline(always)]
    pub fn gap<R: Real>(&self, first: &Place<R>, second: &Place<R>) -> Gap<R> {
        let swings = [first.swing(self.arms_m[0]), second.swing(self.arms_m[1])];
        let apart = both!(i: second.moved_m[i] - first.moved_m[i] + (swings[1][i] - swings[0][i]));
        // The sum of the directions of the faces, and their cross product, in the frame of the undeformed joint.
        let ([cos_a, sin_a], [cos_b, sin_b]) = (first.turn, second.turn);
        let (sum_x, sum_y) = (cos_a + cos_b + R::of(2.0), sin_a + sin_b);
        let cross = (sin_b - sin_a) + (cos_a * sin_b - sin_a * cos_b);
        let length = (sum_x * sum_x + sum_y * sum_y).sqrt();
        let per_length = R::of(1.0) / length;
        let (x, y) = (sum_x * per_length, sum_y * per_length);
        let [ex, ey] = self.along;
        let along = [x * ex - y * ey, y * ex + x * ey];
        let q = self.handedness;
        let normal = [along[1] * -q, along[0] * q];
        let half_t = 0.5 * self.length_m;
        let gap = dot(apart, normal);
        // Twice the sine of half the angle between the faces, times half the length.
        let tilt = cross * per_length * (2.0 * q * half_t);
        let half = both!(i: apart[i] * 0.5);
        Gap {
            penetrations_m: [tilt - gap, -gap - tilt],
            slip_m: dot(apart, along),
            along,
            normal,
            half_cos: length * (0.5 * q * half_t),
            levers_m: [
                both!(i: swings[0][i] + R::of(self.arms_m[0][i]) + half[i]),
                both!(i: swings[1][i] + R::of(self.arms_m[1][i]) - half[i]),
            ],
        }
    }
}

impl<R: Real> Gap<R> {
    /// The action of the joint for these pressing forces at its edges and this shear force, which resists slip. The work of the
    /// action equals theirs on the penetrations and the slip.
    ///
    /// The force acts midway between the middles of the faces, since both bodies share in turning the mean direction.
    #[inline(always)]
    pub fn action(&self, edges_n: [R; 2], shear_n: R) -> Action<R> {
        let pressing = edges_n[0] + edges_n[1];
        let force_n = both!(i: self.normal[i] * pressing - self.along[i] * shear_n);
        // `half_cos` includes the handedness and half the length.
        let couple = (edges_n[1] - edges_n[0]) * self.half_cos;
        Action {
            force_n,
            moments_n_m: [
                -(cross(self.levers_m[0], force_n) + couple),
                cross(self.levers_m[1], force_n) + couple,
            ],
        }
    }
}

#[inline(always)]
fn dot<R: Real>(one: [R; 2], other: [R; 2]) -> R {
    one[0] * other[0] + one[1] * other[1]
}

#[inline(always)]
pub(super) fn cross<R: Real>(one: [R; 2], other: [R; 2]) -> R {
    one[0] * other[1] - one[1] * other[0]
}
