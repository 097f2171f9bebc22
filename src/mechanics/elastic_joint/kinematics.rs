//! The relative position of the two faces of a joint.

use crate::mechanics::lanes::{Real, both};

/// Where a body is: how far its centre has moved, and how it has turned.
#[derive(Clone, Copy, Debug)]
pub struct Place<R> {
    /// Displacement of the centre, in m.
    pub moved_m: [R; 2],
    /// Cosine less one, and sine, of half the rotation: small rotations keep all their digits.
    pub half_turn: [R; 2],
}

impl<R: Real> Place<R> {
    /// Undeformed.
    #[must_use]
    pub fn undeformed() -> Self {
        let zero = R::of(0.0);
        Self {
            moved_m: [zero; 2],
            half_turn: [zero; 2],
        }
    }

    /// Moved and turned by this much, in m and rad.
    #[must_use]
    pub fn at(moved: &[f64; 3]) -> Self {
        let quarter = (0.25 * moved[2]).sin();
        let half_turn = [-2.0 * quarter * quarter, (0.5 * moved[2]).sin()];
        Self {
            moved_m: [moved[0], moved[1]].map(R::of),
            half_turn: half_turn.map(R::of),
        }
    }

    /// How far rotation moves the end of an arm that starts at the centre.
    #[inline(always)]
    pub(super) fn swing(&self, arm_m: [f64; 2]) -> [R; 2] {
        let [half_cos, half_sin] = self.half_turn;
        let twice = half_sin + half_sin;
        let (cos, sin) = (-(half_sin * twice), twice + half_cos * twice);
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
        // In the frame of the undeformed joint: the mean direction of the faces, turned by the mean of both rotations, and half the
        // angle between them. With the halves of the rotations both are products, without a root.
        let ([cos_a, sin_a], [cos_b, sin_b]) = (first.half_turn, second.half_turn);
        let (cosines, sines) = (cos_a * cos_b, sin_a * sin_b);
        let (forth, back) = (cos_a * sin_b, sin_a * cos_b);
        let both_cos = cos_a + cos_b;
        let x = R::of(1.0) + (both_cos + (cosines - sines));
        let y = (sin_a + sin_b) + (forth + back);
        let half_cos = R::of(1.0) + (both_cos + (cosines + sines));
        let half_sin = (sin_b - sin_a) + (forth - back);
        let [ex, ey] = self.along;
        let along = [x * ex - y * ey, y * ex + x * ey];
        let q = self.handedness;
        let normal = [along[1] * -q, along[0] * q];
        let half_t = 0.5 * self.length_m;
        let gap = dot(apart, normal);
        let tilt = half_sin * (2.0 * q * half_t);
        let half = both!(i: apart[i] * 0.5);
        Gap {
            penetrations_m: [tilt - gap, -gap - tilt],
            slip_m: dot(apart, along),
            along,
            normal,
            half_cos: half_cos * (q * half_t),
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
