//! Global search for the best four-link mechanism.
//!
//! Two problems have the same form: which mechanism moves first, and which mechanism follows an impact. Both maximise a function of four ordered
//! angles with several local maxima, often on the bounds. The search is deterministic. It scores every quadruple of a lattice of sections and refines
//! each local maximum of the lattice: by Newton's method if hinges may be anywhere, by steps to neighbouring joints otherwise.

use nalgebra::{DMatrix, DVector, Vector2};

use super::mechanism::{EDGES, FourLink, HingeSites, openings};
use crate::mechanics::{Edge, Profile};

/// Number of lattice intervals if hinges may be anywhere. From 12 to 60 intervals give the same A_L and the same
/// first six restitution coefficients, to 1e-9, for 138 arches from 70 to 180 degrees and t/R 0.03 to 0.29.
const LATTICE_INTERVALS: usize = 20;

/// Position of an additional lattice section near each springing, as a fraction of an interval, for maxima close to the springings.
const NEAR_SPRINGING: f64 = 0.002;

/// Largest number of voussoirs for which the lattice contains every joint, so that the search is exhaustive.
const EXHAUSTIVE_VOUSSOIRS: usize = 48;

/// Sections of a lattice, with their points on both edges.
pub(crate) struct Lattice {
    /// Sections in radians, ascending, springings included.
    pub sections_rad: Vec<f64>,
    /// Edge points: `points[section][edge]`, in the order of their definition.
    points: Vec<[Vector2<f64>; 2]>,
    /// Number of joints between neighbouring lattice sections; 1 if the lattice contains all joints.
    stride: usize,
}

/// Lattice indices of the hinges A, B, C, D.
pub(crate) type Quadruple = [usize; 4];

/// Score of a mechanism of a lattice, from its opening rotations and its indices; minus infinity for mechanisms to ignore.
pub(crate) trait Score: Fn(&[f64; 4], &Quadruple) -> f64 {}
impl<F: Fn(&[f64; 4], &Quadruple) -> f64> Score for F {}

impl Lattice {
    /// Lattice for the given sites: a fixed number of equal intervals, or the joints.
    pub fn new(profile: &dyn Profile, sites: HingeSites) -> Self {
        let (intervals, stride) = match sites {
            HingeSites::Anywhere => (LATTICE_INTERVALS, 1),
            HingeSites::Voussoirs(count) => (count, count.div_ceil(EXHAUSTIVE_VOUSSOIRS)),
        };
        let mut sections_rad = profile.sections(intervals);
        if sites == HingeSites::Anywhere {
            let near = sections_rad[1] * NEAR_SPRINGING;
            sections_rad.insert(1, near);
            sections_rad.insert(intervals + 1, profile.end() - near);
        }
        let edges = [Edge::Intrados, Edge::Extrados];
        let points = sections_rad
            .iter()
            .map(|at| edges.map(|edge| profile.point(*at, edge)));
        Self {
            points: points.collect(),
            sections_rad,
            stride,
        }
    }

    fn hinge_points(&self, quadruple: &Quadruple) -> [Vector2<f64>; 4] {
        std::array::from_fn(|i| self.points[quadruple[i]][EDGES[i] as usize])
    }

    /// Local maxima of `score`, best first.
    pub(crate) fn maxima(&self, score: &impl Score) -> Vec<Quadruple> {
        let last = self.points.len() - 1;
        let mut coarse: Vec<usize> = (0..last).step_by(self.stride).collect();
        coarse.push(last);
        let mut maxima = self.best_by_inner_pair(&coarse, score);
        if self.stride > 1 {
            for (value, quadruple) in &mut maxima {
                self.climb(value, quadruple, score);
            }
        }
        maxima.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        maxima.into_iter().map(|(_, quadruple)| quadruple).collect()
    }

    fn evaluate(&self, quadruple: &Quadruple, score: &impl Score) -> f64 {
        openings(&self.hinge_points(quadruple))
            .map_or(f64::NEG_INFINITY, |rotations| score(&rotations, quadruple))
    }

    /// Finds the best A and D for each pair (B, C). Returns the pairs that are better than all neighbouring pairs.
    fn best_by_inner_pair(&self, sections: &[usize], score: &impl Score) -> Vec<(f64, Quadruple)> {
        let count = sections.len();
        let inner = (1..count - 2).flat_map(|b| (b + 1..count - 1).map(move |c| [b, c]));
        let mut best = vec![(f64::NEG_INFINITY, [0; 4]); count * count];
        for [b, c] in inner.clone() {
            let top = &mut best[b * count + c];
            for a in 0..b {
                for d in c + 1..count {
                    let quadruple = [sections[a], sections[b], sections[c], sections[d]];
                    let value = self.evaluate(&quadruple, score);
                    if value > top.0 {
                        *top = (value, quadruple);
                    }
                }
            }
        }
        let maxima = inner.filter_map(|[b, c]| {
            let top = best[b * count + c];
            let mut near =
                (b - 1..=b + 1).flat_map(|i| &best[i * count + c - 1..=i * count + c + 1]);
            let beaten = near.any(|other| other.0 > top.0);
            (top.0 > f64::NEG_INFINITY && !beaten).then_some(top)
        });
        maxima.collect()
    }

    /// Steps by `stride` joints, then by ever fewer, to a quadruple that is better than all neighbours.
    fn climb(&self, value: &mut f64, quadruple: &mut Quadruple, score: &impl Score) {
        let last = self.points.len() - 1;
        let mut step = self.stride;
        while step > 0 {
            let center = *quadruple;
            for code in 0..81_usize {
                // The digits of `code` in base three: each hinge steps back, stays, or steps on.
                let moved = |i: u32| (code / 3_usize.pow(i) % 3) * step + center[i as usize];
                let neighbour = [moved(0), moved(1), moved(2), moved(3)];
                let is_sorted = neighbour.is_sorted_by(|a, b| a < b);
                if !is_sorted || neighbour[0] < step || neighbour[3] - step > last {
                    continue;
                }
                let neighbour = neighbour.map(|joint| joint - step);
                let score = self.evaluate(&neighbour, score);
                if score > *value {
                    (*value, *quadruple) = (score, neighbour);
                }
            }
            if *quadruple == center {
                step /= 2;
            }
        }
    }
}

/// Function of a mechanism, to be maximised.
pub(crate) trait Objective {
    /// Sections where the gradient may jump, in radians.
    fn kinks_rad(&self) -> &[f64] {
        &[]
    }
    /// Value and its derivatives by the sections of the hinges. If left and right derivatives differ, `above` selects for each hinge the
    /// derivative towards larger angles.
    fn evaluate(&self, mechanism: &FourLink, above: [bool; 4]) -> (f64, [f64; 4]);
}

/// Mechanism with the largest value of `objective`. `score` gives the value of the mechanisms of `lattice`. `None` if there is no
/// mechanism.
pub(crate) fn best_mechanism(
    profile: &dyn Profile,
    sites: HingeSites,
    lattice: &Lattice,
    score: &impl Score,
    objective: &impl Objective,
) -> Option<(f64, FourLink)> {
    let maxima = lattice.maxima(score).into_iter();
    let mut starts = maxima.map(|quadruple| quadruple.map(|i| lattice.sections_rad[i]));
    if let HingeSites::Voussoirs(_) = sites {
        let mechanism = FourLink::new(profile, starts.next()?)?;
        return Some((objective.evaluate(&mechanism, [false; 4]).0, mechanism));
    }
    let mut ends = [objective.kinks_rad(), &[0.0, profile.end()]].concat();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
    let tops = starts.filter_map(|start| ascend_all_sides(profile, &ends, start, objective));
    tops.max_by(|(a, _), (b, _)| a.total_cmp(b))
}

/// Relative differences of values below this are rounding.
const ROUNDING: f64 = 1e-12;

/// Runs Newton's method from `start` to a local maximum of `objective` over ordered sections of `profile`.
///
/// The `ends` (bounds and kinks) divide the range of every hinge into cells in which the objective is smooth. A hinge at the end of its cell stays
/// there if the slope beyond points back, and crosses otherwise.
fn ascend(
    profile: &dyn Profile,
    ends: &[f64],
    start: [f64; 4],
    objective: &impl Objective,
) -> Option<(f64, FourLink)> {
    let mut ascent = Ascent {
        profile,
        objective,
        cells: start.map(|angle| SearchCell::containing(ends, angle)),
    };
    let mut mechanism = FourLink::new(profile, start)?;
    for _ in 0..MAX_NEWTON_STEPS {
        match ascent.step(&mechanism) {
            Some(better) => mechanism = better,
            None if ascent.cross_kinks(&mechanism, ends) => {}
            None => break,
        }
    }
    Some((ascent.evaluate(&mechanism).0, mechanism))
}

/// Runs [`ascend`], then searches from the reflections of the maximum at nearby kinks. If the slope jumps up at a kink, there is a maximum on both
/// sides, often within one lattice interval. The lattice then gives only one of them as a start.
fn ascend_all_sides(
    profile: &dyn Profile,
    ends: &[f64],
    start: [f64; 4],
    objective: &impl Objective,
) -> Option<(f64, FourLink)> {
    let mut top = ascend(profile, ends, start, objective)?;
    let interval = profile.end() / LATTICE_INTERVALS as f64;
    loop {
        let angles = top.1.hinges_rad;
        let twins = (0..4).flat_map(|i| {
            objective.kinks_rad().iter().filter_map(move |kink| {
                let distance = (angles[i] - kink).abs();
                let mut twin = angles;
                twin[i] = 2.0 * kink - angles[i];
                (distance > 0.0 && distance <= interval).then_some(twin)
            })
        });
        let tops = twins.filter_map(|twin| ascend(profile, ends, twin, objective));
        match tops.max_by(|(a, _), (b, _)| a.total_cmp(b)) {
            Some(best) if best.0 > top.0 + ROUNDING * top.0.abs() => top = best,
            _ => return Some(top),
        }
    }
}

/// Newton's method converges in under ten steps from the lattice; crossing kinks adds a few.
const MAX_NEWTON_STEPS: usize = 100;

/// A shorter body counts as vanished: its hinges have merged.
const MIN_BODY_RAD: f64 = 1e-7;

/// Interval of a hinge in which the objective is smooth.
#[derive(Clone, Copy, Debug)]
struct SearchCell {
    index: usize,
    low: f64,
    high: f64,
}

impl SearchCell {
    fn new(ends: &[f64], index: usize) -> Self {
        Self {
            index,
            low: ends[index],
            high: ends[index + 1],
        }
    }

    fn containing(ends: &[f64], angle: f64) -> Self {
        let after = ends.partition_point(|end| *end <= angle);
        Self::new(ends, after.clamp(1, ends.len() - 1) - 1)
    }

    /// Whether an end of the cell stops a hinge at `angle` that moves along `slope`.
    fn stops_hinge(&self, angle: f64, slope: f64) -> bool {
        (angle <= self.low && slope < 0.0) || (angle >= self.high && slope > 0.0)
    }
}

struct Ascent<'a, O> {
    profile: &'a dyn Profile,
    objective: &'a O,
    cells: [SearchCell; 4],
}

impl<O: Objective> Ascent<'_, O> {
    fn evaluate(&self, mechanism: &FourLink) -> (f64, [f64; 4]) {
        let angles = mechanism.hinges_rad;
        // At the lower end of its cell a hinge uses the derivative above, at the upper end the one below.
        let above =
            std::array::from_fn(|i| angles[i] < 0.5 * (self.cells[i].low + self.cells[i].high));
        self.objective.evaluate(mechanism, above)
    }

    /// Interval in which a hinge may move while the others stay: within its cell, and between its neighbours.
    fn range(&self, angles: &[f64; 4], i: usize) -> (f64, f64) {
        let (cell, before, after) = (self.cells[i], i.checked_sub(1), angles.get(i + 1));
        let low = before.map_or(cell.low, |before| angles[before] + MIN_BODY_RAD);
        let high = after.map_or(cell.high, |angle| angle - MIN_BODY_RAD);
        (cell.low.max(low), cell.high.min(high))
    }

    /// Whether a hinge that moves along `slope` is stopped by an end of its cell, or by merging with a neighbour.
    fn is_stopped(&self, angles: &[f64; 4], i: usize, slope: f64) -> bool {
        let (low, high) = self.range(angles, i);
        (angles[i] <= low && slope < 0.0) || (angles[i] >= high && slope > 0.0)
    }

    /// Mechanism after a Newton step of the free hinges; `None` if no step improves the objective.
    fn step(&self, mechanism: &FourLink) -> Option<FourLink> {
        let angles = mechanism.hinges_rad;
        let (value, gradient) = self.evaluate(mechanism);
        let goes = |i: &usize| !self.is_stopped(&angles, *i, gradient[*i]);
        let free: Vec<usize> = (0..4).filter(goes).collect();
        let slope = free.iter().map(|i| gradient[*i].abs()).fold(0.0, f64::max);
        if slope <= 1e-15 * value.abs() {
            return None;
        }
        let curvature = self.curvature(mechanism, &free)?;
        let gradient = DVector::from_iterator(free.len(), free.iter().map(|i| gradient[*i]));
        // Add damping until the quadratic model has a maximum; far from a maximum it may have none.
        let scale = curvature.amax().max(f64::MIN_POSITIVE);
        let mut damping = 0.0;
        let mut step = loop {
            let model = DMatrix::identity(free.len(), free.len()) * damping - &curvature;
            if let Some(factors) = model.cholesky() {
                break factors.solve(&gradient);
            }
            damping = (4.0 * damping).max(1e-3 * scale);
            if !damping.is_finite() {
                // Rounding errors dominate the second derivatives, as in extremely thin rings.
                return None;
            }
        };
        for _ in 0..40 {
            let mut moved = angles;
            for (i, change) in free.iter().zip(step.iter()) {
                let (low, high) = self.range(&moved, *i);
                moved[*i] = (moved[*i] + change).min(high).max(low);
            }
            if let Some(candidate) = FourLink::new(self.profile, moved) {
                let (trial, trial_gradient) = self.evaluate(&candidate);
                let goes = |i: &&usize| !self.is_stopped(&moved, **i, trial_gradient[**i]);
                let slopes = free.iter().filter(goes).map(|i| trial_gradient[*i].abs());
                let trial_slope = slopes.fold(0.0, f64::max);
                // Near the maximum the value is constant within rounding error, so compare slopes.
                let level = trial >= value - ROUNDING * value.abs();
                if trial > value + ROUNDING * value.abs() || (level && trial_slope < 0.5 * slope) {
                    return Some(candidate);
                }
            }
            step *= 0.5;
        }
        None
    }

    /// Second derivatives for the free hinges, by differences of the exact gradient inside the cells.
    fn curvature(&self, mechanism: &FourLink, free: &[usize]) -> Option<DMatrix<f64>> {
        let angles = mechanism.hinges_rad;
        let mut matrix = DMatrix::zeros(free.len(), free.len());
        for (column, i) in free.iter().enumerate() {
            let h = 1e-6;
            let shifted = |by: f64| {
                let mut moved = angles;
                let (low, high) = self.range(&angles, *i);
                moved[*i] = (moved[*i] + by).min(high).max(low);
                let mechanism = FourLink::new(self.profile, moved)?;
                Some((moved[*i], self.evaluate(&mechanism).1))
            };
            let ((low, before), (high, after)) = (shifted(-h)?, shifted(h)?);
            for (row, j) in free.iter().enumerate() {
                matrix[(row, column)] = (after[*j] - before[*j]) / (high - low);
            }
        }
        Some((&matrix + matrix.transpose()) * 0.5)
    }

    /// Lets hinges at a kink cross it if the slope beyond has the same sign. Returns whether any hinge crosses.
    fn cross_kinks(&mut self, mechanism: &FourLink, ends: &[f64]) -> bool {
        let angles = mechanism.hinges_rad;
        let gradient = self.evaluate(mechanism).1;
        let mut crossed = false;
        for i in 0..4 {
            let cell = self.cells[i];
            let next = match gradient[i] {
                _ if !cell.stops_hinge(angles[i], gradient[i]) => continue,
                slope if slope < 0.0 && cell.index > 0 => cell.index - 1,
                slope if slope > 0.0 && cell.index + 2 < ends.len() => cell.index + 1,
                _ => continue,
            };
            self.cells[i] = SearchCell::new(ends, next);
            let beyond = self.evaluate(mechanism).1[i];
            if beyond * gradient[i] > 0.0 {
                crossed = true;
            } else {
                self.cells[i] = cell;
            }
        }
        crossed
    }
}
