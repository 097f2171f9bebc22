//! Relative position of the two faces of a joint.

use crate::mechanics::lanes::{both, remembered};
use crate::mechanics::{Lanes, Real};

/// Position of a body: displacement of its centre, and rotation.
#[derive(Clone, Copy, Debug)]
pub struct BodyPosition<R> {
    /// Displacement of the centre, in m.
    pub moved_m: [R; 2],
    /// Cosine minus one, and sine, of half the rotation. This form is accurate for small rotations.
    pub half_turn: [R; 2],
}

remembered!(BodyPosition { ; moved_m, half_turn });

impl<R: Real> BodyPosition<R> {
    /// Position for displacements in m and a rotation in rad.
    pub fn at(moved: &[f64; 3]) -> Self {
        let quarter = libm::sin(0.25 * moved[2]);
        let half_turn = [-2.0 * quarter * quarter, libm::sin(0.5 * moved[2])];
        Self {
            moved_m: [moved[0], moved[1]].map(R::of),
            half_turn: half_turn.map(R::of),
        }
    }

    /// Displacement of the end of an arm relative to the centre, due to the rotation.
    #[inline(always)]
    pub(super) fn swing(&self, arm_m: [f64; 2]) -> [R; 2] {
        let [half_cos, half_sin] = self.half_turn;
        let twice = half_sin + half_sin;
        let (cos, sin) = (-(half_sin * twice), twice + half_cos * twice);
        let [x, y] = arm_m;
        [cos * x - sin * y, sin * x + cos * y]
    }
}

/// Geometry of an undeformed joint between a first body, before the joint, and a second body after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointGeometry {
    /// Indices of the two bodies.
    pub bodies: [usize; 2],
    /// Vectors from the centres of the bodies to the middle of the joint, in m.
    pub arms_m: [[f64; 2]; 2],
    /// Unit vector along the joint, from edge 0 (intrados) to edge 1 (extrados).
    pub tangent: [f64; 2],
    /// 1 if the second body is left of the vector `tangent`, -1 if it is right.
    pub handedness: f64,
    /// Length of the joint, in m.
    pub length_m: f64,
    /// Components along and across the joint (a quarter turn anticlockwise from `tangent`), in m: of the arm of the first body, of twice the difference
    /// of both arms, and of their sum.
    first_m: [f64; 2],
    twice_between_m: [f64; 2],
    sum_m: [f64; 2],
}

/// Relative position of the two faces of a joint.
#[derive(Clone, Copy, Debug)]
pub struct Gap<R> {
    /// Penetrations at edge 0 and edge 1, in m; linear between the edges.
    pub penetrations_m: [R; 2],
    /// Slip of the second face towards edge 1, in m.
    pub slip_m: R,
    /// Displacement of the second face across the mean direction, a quarter turn anticlockwise from it, in m.
    rise_m: R,
    /// Displacement of the second body relative to the first one, in m.
    apart_m: [R; 2],
    /// Unit vector in the mean direction of the faces.
    tangent: [R; 2],
    /// Cosine and sine of half the angle between the faces.
    half: [R; 2],
}

/// Forces of a joint on its two bodies, with moments about their centres.
#[derive(Clone, Copy, Debug)]
pub struct Action<R> {
    /// Force on the second body, in N; the force on the first body is opposite.
    pub force_n: [R; 2],
    /// Moments on the first and the second body, in N m.
    pub moments_n_m: [R; 2],
}

remembered!(Gap { slip_m, rise_m; penetrations_m, apart_m, tangent, half });

impl JointGeometry {
    /// Joint between the bodies with these indices.
    ///
    /// - `arms_m`: vectors from the centres of the bodies to the middle of the joint, in m.
    /// - `tangent`: unit vector along the joint, from edge 0 (intrados) to edge 1 (extrados).
    /// - `handedness`: 1 if the second body is left of that vector, -1 if it is right.
    /// - `length_m`: length of the joint, in m.
    pub fn new(
        bodies: [usize; 2],
        arms_m: [[f64; 2]; 2],
        tangent: [f64; 2],
        handedness: f64,
        length_m: f64,
    ) -> Self {
        let [ex, ey] = tangent;
        let [first_m, second_m] = arms_m.map(|[x, y]| [ex * x + ey * y, ex * y - ey * x]);
        Self {
            bodies,
            arms_m,
            tangent,
            handedness,
            length_m,
            first_m,
            twice_between_m: both!(i: 2.0 * (second_m[i] - first_m[i])),
            sum_m: both!(i: first_m[i] + second_m[i]),
        }
    }

    /// Relative position of the faces for given positions of the bodies.
    ///
    /// Let `e_a`, `e_b` be the directions of the faces, `e` the mean direction and `n` its normal. `e_b - e_a` is parallel to `n` at any angle. The
    /// gap is therefore linear along the joint, and the slip is constant.
    ///
    /// The bodies rotate by `m - d` and `m + d`. Their arms `a`, `b` then move the middles of the faces apart by
    /// `R(m) (cos d (b - a) + sin d J (a + b)) - (b - a)`, where `J` is a quarter turn. The components along `e = R(m) e_0` and `J e` are sums of
    /// terms that are small for small rotations, without cancellation.
    #[inline(always)]
    pub fn gap<R: Real>(&self, first: &BodyPosition<R>, second: &BodyPosition<R>) -> Gap<R> {
        let apart = both!(i: second.moved_m[i] - first.moved_m[i]);
        // Cosines and sines of `m` and `d` follow from those of the half rotations without a square root.
        let ([cos_a, sin_a], [cos_b, sin_b]) = (first.half_turn, second.half_turn);
        let (cosines, sines) = (cos_a * cos_b, sin_a * sin_b);
        let (forth, back) = (cos_a * sin_b, sin_a * cos_b);
        let both_cos = R::of(1.0) + (cos_a + cos_b);
        let mean_cos = both_cos + (cosines - sines);
        let mean_sin = (sin_a + sin_b) + (forth + back);
        let half_cos = both_cos + (cosines + sines);
        let half_sin = (sin_b - sin_a) + (forth - back);
        let [ex, ey] = self.tangent;
        let tangent = [mean_cos * ex - mean_sin * ey, mean_sin * ex + mean_cos * ey];
        // `cos d - cos m` is twice the product of the sines.
        let (twice, sum) = (self.twice_between_m, self.sum_m);
        let slip = sines * twice[0] - half_sin * sum[1] - mean_sin * (0.5 * twice[1]);
        let rise = sines * twice[1] + half_sin * sum[0] + mean_sin * (0.5 * twice[0]);
        let slip_m = dot(tangent, apart) + slip;
        let rise_m = cross(tangent, apart) + rise;
        let tilt = half_sin * self.length_m;
        let q = self.handedness;
        Gap {
            penetrations_m: [(tilt - rise_m) * q, (tilt + rise_m) * -q],
            slip_m,
            rise_m,
            apart_m: apart,
            tangent,
            half: [half_cos, half_sin],
        }
    }

    /// Forces of the joint on its bodies for a gap, compressive edge forces, and a shear force that resists slip. The work of these
    /// forces equals the work of the edge forces on the penetrations plus that of the shear force on the slip.
    ///
    /// The force acts midway between the middles of the faces, because both bodies contribute equally to the mean direction.
    #[inline(always)]
    pub fn action<R: Real>(&self, gap: &Gap<R>, edges_n: [R; 2], shear_n: R) -> Action<R> {
        let q = self.handedness;
        let across_n = (edges_n[0] + edges_n[1]) * q;
        let [ex, ey] = gap.tangent;
        let force_n = [
            -(ey * across_n + ex * shear_n),
            ex * across_n - ey * shear_n,
        ];
        // Twice the lever arm from the centre of the first body, along and across the mean direction.
        let ([half_cos, half_sin], [a, b]) = (gap.half, both!(i: 2.0 * self.first_m[i]));
        let lever_m = [
            half_cos * a + half_sin * b + gap.slip_m,
            half_cos * b - half_sin * a + gap.rise_m,
        ];
        let couple = (edges_n[1] - edges_n[0]) * (half_cos * (q * self.length_m));
        let about_first = (lever_m[0] * across_n + lever_m[1] * shear_n + couple) * 0.5;
        // Vector from the centre of the first body to the centre of the second.
        let [from, to] = self.arms_m;
        let between_m = both!(i: gap.apart_m[i] + R::of(from[i] - to[i]));
        Action {
            force_n,
            moments_n_m: [-about_first, about_first - cross(between_m, force_n)],
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
