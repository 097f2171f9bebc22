//! Contact stress of a joint, integrated over its length.
//!
//! The penetration is linear from edge to edge, so the part in compression is an interval, computed without branches. Simpson's rule is exact for
//! forces, moments and energies. Its factor of 1/6 and the stiffness of the joint are applied at the end: until then, forces are in metres.

use std::f64::consts::PI;

use super::kinematics::{Gap, JointGeometry};
use crate::mechanics::lanes::{both, remembered};
use crate::mechanics::{Lanes, Real};

/// Method to integrate the stress over a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Contact {
    /// Exact integration over the part in compression.
    #[default]
    Continuous,
    /// Integration at evenly spaced points (2 to 100), two of them on the edges. Points on the edges have half the weight of the others.
    Points(usize),
}

/// Number of cells of a joint that may crush, each with linear stress. Cells are narrower near the edges, where stress concentrates.
const CELLS: usize = 12;

/// Positions along a joint at which the stress is computed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ContactSection {
    /// At the edges only; the stress is linear between them.
    Whole,
    /// At nodes from edge 0 to edge 1, as fractions of the length; the stress is linear between nodes.
    Cells(Vec<f64>),
    /// At points: position as a fraction of the length, and share of the joint's area.
    Points(Vec<[f64; 2]>),
}

impl ContactSection {
    pub(super) fn new(contact: Contact, crushes: bool) -> Self {
        match contact {
            Contact::Continuous if crushes => {
                let node = |index: usize| 0.5 * (1.0 - libm::cos(PI * index as f64 / CELLS as f64));
                Self::Cells((0..=CELLS).map(node).collect())
            }
            Contact::Continuous => Self::Whole,
            Contact::Points(count) => {
                let spaces = (count - 1) as f64;
                let point = |index: usize| {
                    let ends = index == 0 || index + 1 == count;
                    let share = if ends { 0.5 } else { 1.0 } / spaces;
                    [index as f64 / spaces, share]
                };
                Self::Points((0..count).map(point).collect())
            }
        }
    }

    /// Number of positions with a state of crushing.
    pub(super) fn fibres(&self) -> usize {
        match self {
            Self::Whole => 0,
            Self::Cells(nodes) => nodes.len(),
            Self::Points(points) => points.len(),
        }
    }

    /// Rotational stiffness of the closed joint, over its normal stiffness times its length squared; 1/12 for continuous contact.
    pub(super) fn second_moment(&self) -> f64 {
        match self {
            Self::Whole | Self::Cells(_) => 1.0 / 12.0,
            Self::Points(points) => {
                let parts = points.iter();
                parts.map(|[at, share]| share * (at - 0.5).powi(2)).sum()
            }
        }
    }

    /// Edge forces of a joint with tensile strength, per stiffness.
    pub(super) fn bonded_forces<R: Real>(&self, p: [R; 2]) -> [R; 2] {
        let [mean, half] = [(p[0] + p[1]) * 0.5, (p[1] - p[0]) * self.second_moment()];
        [mean * 0.5 - half, mean * 0.5 + half]
    }

    /// Elastic energy of compression, per stiffness.
    #[inline(always)]
    pub(super) fn energy<R: Real>(&self, p: [R; 2], fibres: &[Fibre<R>]) -> R {
        let at = |part: f64| p[0] + (p[1] - p[0]) * part;
        match self {
            Self::Whole => energy(p),
            Self::Cells(nodes) => {
                let mut sum = R::of(0.0);
                for (pair, ends) in nodes.windows(2).zip(fibres.windows(2)) {
                    let q = both!(end: at(pair[end]) - ends[end].crushed_m);
                    sum += energy(q) * (pair[1] - pair[0]);
                }
                sum
            }
            Self::Points(points) => {
                let mut sum = R::of(0.0);
                for ([part, share], fibre) in points.iter().zip(fibres) {
                    let q = (at(*part) - fibre.crushed_m).max(R::of(0.0));
                    sum += q * q * (0.5 * share);
                }
                sum
            }
        }
    }
}

/// State of a joint after the last step.
#[derive(Clone, Copy, Debug)]
pub struct Memory<R> {
    /// Penetrations at the edges, in m.
    pub penetrations_m: [R; 2],
    /// Slip, in m.
    pub slip_m: R,
    /// Elastic shear force, in N.
    pub shear_n: R,
    /// Permanent slip, in m.
    pub permanent_slip_m: R,
    /// Normal forces of damping at the edges, in N.
    viscous_n: [R; 2],
    /// Shear force of damping, in N.
    viscous_shear_n: R,
}

/// State of crushing at one position along a joint.
#[derive(Clone, Copy, Debug)]
pub struct Fibre<R> {
    /// Depth of crushing, in m.
    pub crushed_m: R,
    /// Six times the elastic force at the position, per stiffness.
    force_m: R,
}

remembered!(Memory { slip_m, shear_n, permanent_slip_m, viscous_shear_n; penetrations_m, viscous_n });
remembered!(Fibre { crushed_m, force_m });

/// Normal forces of a joint, and the energy dissipated with them.
#[derive(Clone, Copy, Debug)]
pub struct NormalForces<R> {
    /// Statically equivalent normal forces at the edges, in N.
    pub edges_n: [R; 2],
    /// Energy dissipated by damping in the step, in J, by the trapezoidal rule.
    pub damped_j: R,
    /// Energy dissipated by crushing in the step, in J, by the trapezoidal rule.
    pub crushed_j: R,
}

/// Shear force of a joint, and the energy dissipated with it.
#[derive(Clone, Copy, Debug)]
pub struct ShearForce<R> {
    /// Shear force, in N.
    pub shear_n: R,
    /// Energy dissipated by damping in the step, in J.
    pub damped_j: R,
    /// Energy dissipated by friction in the step, in J, never negative: the slip times the mean of the forces before and after the step. If the force
    /// changes sign, the force after the step replaces the mean.
    pub friction_j: R,
    /// Energy lost by slip in the balance of the discrete motion, in J, by the trapezoidal rule. It is negative if the force changes sign within a
    /// step, which adds energy.
    pub balance_j: R,
}

/// Elastic joint between two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticJoint {
    /// Geometry of the joint.
    pub geometry: JointGeometry,
    /// Normal stiffness of the closed joint, in N/m.
    pub normal_n_m: f64,
    /// Shear stiffness of the closed joint, in N/m; zero for a contact without friction.
    pub shear_n_m: f64,
    /// Penetration at which the joint crushes, in m; infinite without crushing.
    pub crushing_penetration_m: f64,
    /// Area of the joint, in m2.
    pub area_m2: f64,
}

/// Contact law of all joints of a structure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ContactLaw {
    pub section: ContactSection,
    pub crushes: bool,
    /// Coefficient of friction, and a constant added to the bound of the shear force: zero, or infinity to prevent slip.
    pub friction: [f64; 2],
}

impl ContactLaw {
    /// Computes the normal forces of a joint for a gap, and updates the state of the joint. `damping` is the damping time over the length of the
    /// step.
    #[inline(always)]
    pub fn normal_forces<R: Real>(
        &self,
        joint: &ElasticJoint,
        damping: Option<R>,
        gap: &Gap<R>,
        memory: &mut Memory<R>,
        fibres: &mut [Fibre<R>],
    ) -> NormalForces<R> {
        let zero = R::of(0.0);
        let p = gap.penetrations_m;
        let moved = both!(end: p[end] - memory.penetrations_m[end]);
        memory.penetrations_m = p;
        #[expect(
            clippy::manual_map,
            reason = "in functions as large as a step the compiler leaves calls of closures"
        )]
        let damping_m = match damping {
            Some(damping) => Some(both!(end: moved[end] * damping)),
            None => None,
        };
        let limit = self.crushes.then_some(joint.crushing_penetration_m);
        let (elastic, total, crushed) = match &self.section {
            ContactSection::Whole => {
                let elastic = compressive_forces(p);
                let total = match damping_m {
                    Some(b) => damped_compressive_forces(p, both!(end: p[end] + b[end])),
                    None => elastic,
                };
                (elastic, total, zero)
            }
            ContactSection::Cells(nodes) => sum_in_cells(nodes, limit, p, damping_m, fibres),
            ContactSection::Points(points) => sum_at_points(points, limit, p, damping_m, fibres),
        };
        let k = joint.normal_n_m * (1.0 / 6.0);
        let mut damped_j = zero;
        if damping.is_some() {
            let before = memory.viscous_n;
            let viscous = both!(end: (total[end] - elastic[end]) * k);
            let taken = both!(end: (viscous[end] + before[end]) * moved[end]);
            damped_j = (taken[0] + taken[1]) * 0.5;
            memory.viscous_n = viscous;
        }
        NormalForces {
            edges_n: both!(end: total[end] * k),
            damped_j,
            crushed_j: crushed * k,
        }
    }

    /// Computes the shear force of a joint for a gap and given normal forces at the edges, and updates the state of the joint.
    #[inline(always)]
    pub(crate) fn shear_force<R: Real>(
        &self,
        joint: &ElasticJoint,
        damping: Option<R>,
        gap: &Gap<R>,
        edges_n: [R; 2],
        memory: &mut Memory<R>,
    ) -> ShearForce<R> {
        let zero = R::of(0.0);
        if joint.shear_n_m == 0.0 {
            return ShearForce {
                shear_n: zero,
                damped_j: zero,
                friction_j: zero,
                balance_j: zero,
            };
        }
        let [coefficient, lock] = self.friction;
        let bound = (edges_n[0] + edges_n[1]) * coefficient + R::of(lock);
        let kt = joint.shear_n_m;
        let slid = gap.slip_m - memory.slip_m;
        let trial = memory.shear_n + slid * kt;
        let elastic = clamped(trial, bound);
        let slipped = (trial - elastic) * (1.0 / kt);
        let balance_j = (memory.shear_n + elastic) * slipped * 0.5;
        let [before, after] = [memory.shear_n * slipped, elastic * slipped];
        let friction_j = before.positive(balance_j, after);
        let (mut shear_n, mut damped_j) = (elastic, zero);
        if let Some(damping) = damping {
            shear_n = clamped(elastic + slid * damping * kt, bound);
            let viscous = shear_n - elastic;
            damped_j = (viscous + memory.viscous_shear_n) * slid * 0.5;
            memory.viscous_shear_n = viscous;
        }
        memory.slip_m = gap.slip_m;
        memory.shear_n = elastic;
        memory.permanent_slip_m += slipped;
        ShearForce {
            shear_n,
            damped_j,
            friction_j,
            balance_j,
        }
    }
}

/// Limits a force to `-bound..=bound`.
#[inline(always)]
fn clamped<R: Real>(force: R, bound: R) -> R {
    force.min(bound).max(-bound)
}

/// Six times the edge forces, elastic and with damping, and the work of crushing; all per stiffness.
type Sums<R> = ([R; 2], [R; 2], R);

/// Computes, at a position given as a fraction of the length, the elastic stress, the stress with damping, and the increment of crushing.
#[inline(always)]
fn fibre<R: Real>(
    at: f64,
    p: [R; 2],
    damping_m: Option<[R; 2]>,
    limit: Option<f64>,
    memory: &mut Fibre<R>,
) -> (R, R, R) {
    let mut q = p[0] * (1.0 - at) + p[1] * at - memory.crushed_m;
    let mut over = R::of(0.0);
    if let Some(limit) = limit {
        over = (q - R::of(limit)).max(over);
        memory.crushed_m += over;
        q -= over;
    }
    let mut v = q;
    if let Some(damping_m) = damping_m {
        v += damping_m[0] * (1.0 - at) + damping_m[1] * at;
    }
    if let Some(limit) = limit {
        v = v.min(R::of(limit));
    }
    (q, v, over)
}

#[inline(always)]
fn sum_at_points<R: Real>(
    points: &[[f64; 2]],
    limit: Option<f64>,
    p: [R; 2],
    damping_m: Option<[R; 2]>,
    fibres: &mut [Fibre<R>],
) -> Sums<R> {
    let zero = R::of(0.0);
    let (mut elastic_sum, mut total_sum, mut crushed) = ([zero; 2], [zero; 2], zero);
    let mut index = 0;
    while index < points.len() {
        let ([at, share], memory) = (points[index], &mut fibres[index]);
        index += 1;
        let (q, v, over) = fibre(at, p, damping_m, limit, memory);
        let share = 6.0 * share;
        let elastic = q.max(zero) * share;
        let total = q.positive(v.max(zero), zero) * share;
        let parts = [1.0 - at, at];
        elastic_sum = both!(end: elastic_sum[end] + elastic * parts[end]);
        total_sum = both!(end: total_sum[end] + total * parts[end]);
        crushed += (memory.force_m + elastic) * over * 0.5;
        memory.force_m = elastic;
    }
    (elastic_sum, total_sum, crushed)
}

#[inline(always)]
fn sum_in_cells<R: Real>(
    nodes: &[f64],
    limit: Option<f64>,
    p: [R; 2],
    damping_m: Option<[R; 2]>,
    fibres: &mut [Fibre<R>],
) -> Sums<R> {
    let zero = R::of(0.0);
    let (mut elastic_sum, mut total_sum, mut crushed) = ([zero; 2], [zero; 2], zero);
    let mut before = (0.0, (zero, zero, zero));
    // Force at the previous node from the cell before it.
    let mut carried = zero;
    let mut index = 0;
    while index <= nodes.len() {
        let (at, here) = match nodes.get(index) {
            Some(&at) => (at, fibre(at, p, damping_m, limit, &mut fibres[index])),
            None => before,
        };
        if index > 0 {
            let (left, (q, v, over)) = before;
            let width = at - left;
            let ends = [q, here.0];
            let elastic = compressive_forces(ends);
            let total = match damping_m {
                None => elastic,
                Some(_) => damped_compressive_forces(ends, [v, here.1]),
            };
            let elastic = both!(end: elastic[end] * width);
            let total = both!(end: total[end] * width);
            let shares = [[1.0 - left, 1.0 - at], [left, at]];
            elastic_sum = both!(end: {
                let [from, to] = shares[end];
                elastic_sum[end] + (elastic[0] * from + elastic[1] * to)
            });
            total_sum = both!(end: {
                let [from, to] = shares[end];
                total_sum[end] + (total[0] * from + total[1] * to)
            });
            let memory = &mut fibres[index - 1];
            let force = carried + elastic[0];
            crushed += (memory.force_m + force) * over * 0.5;
            memory.force_m = force;
            carried = elastic[1];
        }
        before = (at, here);
        index += 1;
    }
    (elastic_sum, total_sum, crushed)
}

/// Interval in which a linear function with given end values is positive, as fractions of the length; empty if it is positive nowhere.
#[inline(always)]
fn positive_part<R: Real>(ends: [R; 2]) -> [R; 2] {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let crossing = ends[0] / (ends[0] - ends[1]);
    [
        ends[0].positive(zero, ends[1].positive(crossing, zero)),
        ends[1].positive(one, ends[0].positive(crossing, zero)),
    ]
}

/// Six times the end forces that are equivalent to a stress on a part of the length, linear between the values `low` and `high`.
#[inline(always)]
fn end_forces<R: Real>([from, to]: [R; 2], [low, high]: [R; 2]) -> [R; 2] {
    let (part, sum) = (to - from, from + to);
    let whole = (low + high) * 3.0;
    let at_one = low * (from + sum) + high * (to + sum);
    [part * (whole - at_one), part * at_one]
}

/// Six times the end forces of the compressive part of a stress that is linear between the ends.
#[inline(always)]
fn compressive_forces<R: Real>(ends: [R; 2]) -> [R; 2] {
    let zero = R::of(0.0);
    end_forces(positive_part(ends), both!(end: ends[end].max(zero)))
}

/// Six times the end forces of a second linear stress, over the part where both stresses are compressive.
#[inline(always)]
fn damped_compressive_forces<R: Real>(ends: [R; 2], stress: [R; 2]) -> [R; 2] {
    let (touching, pressing) = (positive_part(ends), positive_part(stress));
    let from = touching[0].max(pressing[0]);
    let to = touching[1].min(pressing[1]).max(from);
    let (ends, slope) = ([from, to], stress[1] - stress[0]);
    let presses = both!(end: (stress[0] + slope * ends[end]).max(R::of(0.0)));
    end_forces(ends, presses)
}

/// Energy of the compressive part.
#[inline(always)]
fn energy<R: Real>(ends: [R; 2]) -> R {
    let [from, to] = positive_part(ends);
    let [low, high] = both!(end: ends[end].max(R::of(0.0)));
    (to - from) * (low * low + low * high + high * high) * (1.0 / 6.0)
}
