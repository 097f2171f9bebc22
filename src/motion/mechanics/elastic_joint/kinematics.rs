//! The relative position of the two faces of a joint.

use crate::mechanics::lanes::{Lanes, Real, both, remembered};

/// Position of a body: how far its centre has moved, and how it has turned.
#[derive(Clone, Copy, Debug)]
pub struct Place<R> {
    /// Displacement of the centre, in m.
    pub moved_m: [R; 2],
    /// Cosine less one, and sine, of half the rotation: small rotations keep all their digits.
    pub half_turn: [R; 2],
}

remembered!(Place { ; moved_m, half_turn });

impl<R: Real> Place<R> {
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

    /// Displacement of the end of an arm from the centre by a rotation.
    #[inline(always)]
    pub(super) fn swing(&self, arm_m: [f64; 2]) -> [R; 2] {
        let [half_cos, half_sin] = self.half_turn;
        let twice = half_sin + half_sin;
        let (cos, sin) = (-(half_sin * twice), twice + half_cos * twice);
        let [x, y] = arm_m;
        [cos * x - sin * y, sin * x + cos * y]
    }
}

/// The geometry of a joint, undeformed: the first body is before the joint, the second one after it.
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
    /// The arm of the first body along the joint, and across it, a quarter turn anticlockwise from there. Twice the second one less
    /// the first one, and their sum, likewise.
    first_m: [f64; 2],
    twice_between_m: [f64; 2],
    sum_m: [f64; 2],
}

/// The relative position of the faces of a joint.
#[derive(Clone, Copy, Debug)]
pub struct Gap<R> {
    /// Penetration at edge 0 and edge 1, in m; it changes linearly between them.
    pub penetrations_m: [R; 2],
    /// Slip of the second face towards edge 1, in m.
    pub slip_m: R,
    /// Displacement in the direction a quarter turn anticlockwise from there, in m.
    rise_m: R,
    /// Displacement of the second body relative to the first one, in m.
    apart_m: [R; 2],
    /// Mean direction of the faces.
    along: [R; 2],
    /// Cosine and sine of half the angle between the faces.
    half: [R; 2],
}

/// The action of a joint on its two bodies, at their centres.
#[derive(Clone, Copy, Debug)]
pub struct Action<R> {
    /// Force on the second body, in N; the first one feels its opposite.
    pub force_n: [R; 2],
    /// Moments on the first and on the second body, in N m.
    pub moments_n_m: [R; 2],
}

remembered!(Gap { slip_m, rise_m; penetrations_m, apart_m, along, half });

impl Link {
    /// A joint between the bodies with these indices.
    ///
    /// * `arms_m`: from the centres of the bodies to the middle of the joint.
    /// * `along`: unit vector along the joint, from edge 0 (intrados) to edge 1 (extrados).
    /// * `handedness`: 1 where the second body is to the left of that vector, else -1.
    /// * `length_m`: length of the joint.
    #[must_use]
    pub fn new(
        bodies: [usize; 2],
        arms_m: [[f64; 2]; 2],
        along: [f64; 2],
        handedness: f64,
        length_m: f64,
    ) -> Self {
        let [ex, ey] = along;
        let [first_m, second_m] = arms_m.map(|[x, y]| [ex * x + ey * y, ex * y - ey * x]);
        Self {
            bodies,
            arms_m,
            along,
            handedness,
            length_m,
            first_m,
            twice_between_m: both!(i: 2.0 * (second_m[i] - first_m[i])),
            sum_m: both!(i: first_m[i] + second_m[i]),
        }
    }

    /// The relative position of the faces with the bodies at these places.
    ///
    /// With `e_a`, `e_b` the directions of the faces, `e` the mean direction and `n` its normal, `e_b - e_a` is along `n` whatever the
    /// angle. So the gap is linear along the joint, and the slip the same everywhere.
    ///
    /// The bodies turn by `m - d` and `m + d`, so their arms `a`, `b` move the middles of the faces apart by
    /// `R(m) (cos d (b - a) + sin d J (a + b)) - (b - a)`, with `J` a quarter turn. Along `e = R(m) e_0` and `J e` that is, by the
    /// components of the arms along `e_0` and `J e_0`, a sum of terms that are small while the turns are: they keep all their digits.
    #[inline(always)]
    pub fn gap<R: Real>(&self, first: &Place<R>, second: &Place<R>) -> Gap<R> {
        let apart = both!(i: second.moved_m[i] - first.moved_m[i]);
        // Cosines and sines of `m` and `d` are products, without a root, of those of the halves of the rotations.
        let ([cos_a, sin_a], [cos_b, sin_b]) = (first.half_turn, second.half_turn);
        let (cosines, sines) = (cos_a * cos_b, sin_a * sin_b);
        let (forth, back) = (cos_a * sin_b, sin_a * cos_b);
        let both_cos = R::of(1.0) + (cos_a + cos_b);
        let mean_cos = both_cos + (cosines - sines);
        let mean_sin = (sin_a + sin_b) + (forth + back);
        let half_cos = both_cos + (cosines + sines);
        let half_sin = (sin_b - sin_a) + (forth - back);
        let [ex, ey] = self.along;
        let along = [mean_cos * ex - mean_sin * ey, mean_sin * ex + mean_cos * ey];
        // `cos d - cos m` is twice the product of the sines.
        let (twice, sum) = (self.twice_between_m, self.sum_m);
        let slip = sines * twice[0] - half_sin * sum[1] - mean_sin * (0.5 * twice[1]);
        let rise = sines * twice[1] + half_sin * sum[0] + mean_sin * (0.5 * twice[0]);
        let slip_m = dot(along, apart) + slip;
        let rise_m = cross(along, apart) + rise;
        let tilt = half_sin * self.length_m;
        let q = self.handedness;
        Gap {
            penetrations_m: [(tilt - rise_m) * q, (tilt + rise_m) * -q],
            slip_m,
            rise_m,
            apart_m: apart,
            along,
            half: [half_cos, half_sin],
        }
    }

    /// The action of the joint with this gap, for these pressing forces at its edges and this shear force, which resists slip. The
    /// work of the action equals theirs on the penetrations and the slip.
    ///
    /// The force acts midway between the middles of the faces, since both bodies share in turning the mean direction.
    #[inline(always)]
    pub fn action<R: Real>(&self, gap: &Gap<R>, edges_n: [R; 2], shear_n: R) -> Action<R> {
        let q = self.handedness;
        let across_n = (edges_n[0] + edges_n[1]) * q;
        let [ex, ey] = gap.along;
        let force_n = [
            -(ey * across_n + ex * shear_n),
            ex * across_n - ey * shear_n,
        ];
        // Twice the lever from the centre of the first body, along the mean direction and across it.
        let ([half_cos, half_sin], [a, b]) = (gap.half, both!(i: 2.0 * self.first_m[i]));
        let lever_m = [
            half_cos * a + half_sin * b + gap.slip_m,
            half_cos * b - half_sin * a + gap.rise_m,
        ];
        let couple = (edges_n[1] - edges_n[0]) * (half_cos * (q * self.length_m));
        let about_first = (lever_m[0] * across_n + lever_m[1] * shear_n + couple) * 0.5;
        // From the centre of the first body to that of the second one.
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
