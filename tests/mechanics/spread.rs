//! Rows on slowly moving supports, compared with an independent computation: the minimum of the potential energy of all blocks,
//! found by convex programmes in which any joint may open.

use archrock::ElasticJoints;
use archrock::dynamics::{Model as _, Pulse, Request};
use archrock::mechanics::Row;
use archrock::mechanics::Sway;
use archrock::mechanics::elastic_joint::{ElasticProperties, ElasticStructure, RestError};
use archrock::mechanics::settling::{Follower, Movement, Movements, SettlingError};
use archrock::mechanics::{Anchor, Tie};
use archrock::mechanics::{Edge, Ring};
use archrock::studies::{SpringingDirection, spread};
use archrock_motion::internals::contact::ContactError;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver as _, NonnegativeConeT, SolverStatus, ZeroConeT,
};
use nalgebra::Vector2;
use roxmltree::Document;
use std::f64::consts::FRAC_1_SQRT_2;

use crate::common::program::{printed, refused};
use crate::common::prose::{golden, shows};
use crate::common::results::{Table, json, named, points};
use crate::common::{parsed, pushes_g};

fn arch(embrace_deg: f64, thickness_ratio: f64, voussoirs: usize) -> Row {
    let ring = Ring::new(thickness_ratio, embrace_deg.to_radians()).unwrap();
    Row::arch(&ring, voussoirs, 1.0, 1.0, 1000.0).unwrap()
}

/// Direction of a movement of the right support: components outwards and down.
const OUT: [f64; 2] = [1.0, 0.0];
const INWARDS: [f64; 2] = [-1.0, 0.0];
const DOWN: [f64; 2] = [0.0, 1.0];
const DIAGONAL: [f64; 2] = [FRAC_1_SQRT_2, FRAC_1_SQRT_2];

fn right([spread, settlement]: [f64; 2]) -> impl Fn(f64) -> Movements {
    move |s| Movements {
        right: Movement {
            spread_m: s * spread,
            settlement_m: s * settlement,
            rotation_rad: 0.0,
        },
        ..Movements::default()
    }
}

/// Movement of the right support, in mean radii, at which an arch falls.
fn falls_at(row: &Row, direction: [f64; 2]) -> f64 {
    let mut follower = Follower::new(row).unwrap();
    match follower.move_supports(right(direction), 0.0, 1.6).unwrap() {
        Some(at) => at,
        None => panic!("it stands"),
    }
}

/// An arch of annular voussoirs of unit mean radius.
#[derive(Clone)]
pub struct Blocks {
    masses: Vec<f64>,
    centres: Vec<[f64; 2]>,
    /// Corners of every joint, intrados and extrados.
    joints: Vec<[[f64; 2]; 2]>,
    moved: Vec<[f64; 3]>,
    bars: Vec<Bar>,
    /// Displacement of the right support, outwards and down.
    pub support: [f64; 2],
    /// Horizontal push to the right per unit of mass, in units of gravity.
    push: f64,
}

type Triplets = (Vec<usize>, Vec<usize>, Vec<f64>);

/// A bar that pulls two bodies together. Bodies are numbered as in [`Blocks::place`]; forces are in units of the weight.
#[derive(Clone)]
pub struct Bar {
    ends: [(usize, [f64; 2]); 2],
    stiffness: f64,
    /// Length without force, including the yielding so far.
    natural: f64,
    yields_at: f64,
}

impl Bar {
    /// The same bar as a tie of a row of this weight.
    fn tie(&self, weight: f64, blocks: usize) -> Tie {
        let length =
            (self.ends[1].1[0] - self.ends[0].1[0]).hypot(self.ends[1].1[1] - self.ends[0].1[1]);
        Tie {
            ends: self.ends.map(|(body, point)| Anchor {
                block: (1..=blocks).contains(&body).then(|| body - 1),
                at_m: point.into(),
            }),
            stiffness_n_m: self.stiffness * weight,
            prestress_n: self.stiffness * (length - self.natural) * weight,
            yield_force_n: self.yields_at * weight,
            breaks_at_strain: f64::INFINITY,
        }
    }
}

impl Blocks {
    pub fn new(embrace_deg: f64, thickness: f64, voussoirs: usize) -> Self {
        let half = 0.5 * embrace_deg.to_radians();
        let [inner, outer] = [1.0 - 0.5 * thickness, 1.0 + 0.5 * thickness];
        let angle = |joint: f64| -half + 2.0 * half * joint / voussoirs as f64;
        let at = |angle: f64, radius: f64| [radius * angle.sin(), radius * angle.cos()];
        let own = half / voussoirs as f64;
        let arm = 2.0 / 3.0 * (outer.powi(3) - inner.powi(3)) / (outer.powi(2) - inner.powi(2));
        Self {
            masses: vec![1.0 / voussoirs as f64; voussoirs],
            centres: (0..voussoirs)
                .map(|block| at(angle(block as f64 + 0.5), arm * own.sin() / own))
                .collect(),
            joints: (0..=voussoirs)
                .map(|joint| [inner, outer].map(|radius| at(angle(joint as f64), radius)))
                .collect(),
            moved: vec![[0.0; 3]; voussoirs],
            bars: Vec::new(),
            support: [0.0; 2],
            push: 0.0,
        }
    }

    /// Position of a point of a body. Body 0 is the left support; the blocks follow, then the right support. `more` is an
    /// additional displacement of the body.
    fn place(&self, body: usize, point: [f64; 2], more: [f64; 3]) -> [f64; 2] {
        let blocks = self.masses.len();
        if body == 0 {
            return point;
        }
        if body > blocks {
            return [point[0] + self.support[0], point[1] - self.support[1]];
        }
        let (moved, centre) = (self.moved[body - 1], self.centres[body - 1]);
        let (sin, cos) = (moved[2] + more[2]).sin_cos();
        let arm = [point[0] - centre[0], point[1] - centre[1]];
        [
            centre[0] + moved[0] + more[0] + cos * arm[0] - sin * arm[1],
            centre[1] + moved[1] + more[1] + sin * arm[0] + cos * arm[1],
        ]
    }

    /// Slip of a joint and its gaps at intrados and extrados, measured along and across the mean of its faces. In this frame
    /// hinges at either corner are exact.
    fn opening(&self, joint: usize, more: [[f64; 3]; 2]) -> [f64; 3] {
        let corners = |side: usize| {
            self.joints[joint].map(|corner| self.place(joint + side, corner, more[side]))
        };
        let (left, right) = (corners(0), corners(1));
        let face = |corners: [[f64; 2]; 2]| [0, 1].map(|axis| corners[1][axis] - corners[0][axis]);
        let sum = [0, 1].map(|axis| face(left)[axis] + face(right)[axis]);
        let length = sum[0].hypot(sum[1]);
        let along = sum.map(|part| part / length);
        // Towards the right block: faces point outwards.
        let across = [along[1], -along[0]];
        let apart = [0, 1].map(|edge| [0, 1].map(|axis| right[edge][axis] - left[edge][axis]));
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        [
            dot(apart[0], along),
            dot(apart[0], across),
            dot(apart[1], across),
        ]
    }

    /// Unit vector from the first end of a bar to the second, and the distance of the ends. Body `at` has an additional
    /// displacement.
    fn line(&self, bar: &Bar, at: usize, more: [f64; 3]) -> ([f64; 2], f64) {
        let [first, second] = bar.ends.map(|(body, point)| {
            let more = if body == at { more } else { [0.0; 3] };
            self.place(body, point, more)
        });
        let apart = [0, 1].map(|axis| second[axis] - first[axis]);
        let length = apart[0].hypot(apart[1]);
        (apart.map(|part| part / length), length)
    }

    /// Force of a bar.
    fn pull(&self, bar: &Bar) -> f64 {
        let (_, length) = self.line(bar, 0, [0.0; 3]);
        (bar.stiffness * (length - bar.natural)).clamp(0.0, bar.yields_at)
    }

    /// Adds the gradient of the energy of the bars with respect to the block coordinates, and its elastic second derivatives as
    /// triplets. The geometric stiffness is left out.
    fn add_bars(&self, slopes: &mut [f64], (rows, columns, values): &mut Triplets) {
        for bar in &self.bars {
            let pull = self.pull(bar);
            let step = 1e-6;
            let ends = bar.ends.iter().map(|(body, _)| *body);
            let ends = ends.filter(|body| (1..=self.masses.len()).contains(body));
            let longer: Vec<(usize, f64)> = ends
                .flat_map(|body| (0..3).map(move |axis| (body, axis)))
                .map(|(body, axis)| {
                    let at = |step: f64| {
                        let mut more = [0.0; 3];
                        more[axis] = step;
                        self.line(bar, body, more).1
                    };
                    (3 * (body - 1) + axis, (at(step) - at(-step)) / (2.0 * step))
                })
                .collect();
            let elastic = pull > 0.0 && pull < bar.yields_at;
            for (one, by_one) in &longer {
                slopes[*one] += pull * by_one;
                for (other, by_other) in longer.iter().filter(|(other, _)| elastic && one <= other)
                {
                    rows.push(*one);
                    columns.push(*other);
                    values.push(bar.stiffness * by_one * by_other);
                }
            }
        }
    }

    /// Moves the blocks down the energy, against a resistance to displacements. Returns the largest displacement; `None` if the
    /// programme has no solution because the arch has collapsed.
    fn descend(&mut self, resistance: f64) -> Option<f64> {
        let blocks = self.masses.len();
        let joints = blocks + 1;
        let (mut rows, mut columns, mut values): Triplets = Default::default();
        let mut right = vec![0.0; 3 * joints];
        for joint in 0..joints {
            let here = self.opening(joint, [[0.0; 3]; 2]);
            // The slip is zero, and gaps are not negative.
            let places = [joint, joints + 2 * joint, joints + 2 * joint + 1];
            for (kind, row) in places.into_iter().enumerate() {
                right[row] = if kind == 0 { -here[0] } else { here[kind] };
            }
            for side in 0..2 {
                let body = joint + side;
                if body == 0 || body > blocks {
                    continue;
                }
                for axis in 0..3 {
                    let step = 1e-6;
                    let at = |step: f64| {
                        let mut more = [[0.0; 3]; 2];
                        more[side][axis] = step;
                        self.opening(joint, more)
                    };
                    let (before, after) = (at(-step), at(step));
                    for (kind, row) in places.into_iter().enumerate() {
                        let slope = (after[kind] - before[kind]) / (2.0 * step);
                        rows.push(row);
                        columns.push(3 * (body - 1) + axis);
                        values.push(if kind == 0 { slope } else { -slope });
                    }
                }
            }
        }
        let count = 3 * blocks;
        let weights = self
            .masses
            .iter()
            .flat_map(|mass| [*mass, *mass, 0.1 * mass]);
        let weights: Vec<f64> = weights.map(|weight| weight * resistance).collect();
        let slopes = self.masses.iter();
        let mut slopes: Vec<f64> = slopes
            .flat_map(|mass| [-mass * self.push, *mass, 0.0])
            .collect();
        let mut curvature = ((0..count).collect(), (0..count).collect(), weights);
        self.add_bars(&mut slopes, &mut curvature);
        let (places, others, weights) = curvature;
        let hessian = CscMatrix::new_from_triplets(count, count, places, others, weights);
        let matrix = CscMatrix::new_from_triplets(right.len(), count, rows, columns, values);
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-11,
            tol_gap_rel: 1e-11,
            tol_feas: 1e-11,
            ..DefaultSettings::default()
        };
        let cones = [ZeroConeT(joints), NonnegativeConeT(2 * joints)];
        let mut solver =
            DefaultSolver::new(&hessian, &slopes, &matrix, &right, &cones, settings).unwrap();
        solver.solve();
        let solved = [SolverStatus::Solved, SolverStatus::AlmostSolved];
        if !solved.contains(&solver.solution.status) {
            return None;
        }
        let x = &solver.solution.x;
        let farthest = x.iter().fold(0.0_f64, |most, step| most.max(step.abs()));
        // Gaps are linear for small steps only.
        let part = (0.03 / farthest).min(1.0);
        for (index, moved) in self.moved.iter_mut().enumerate() {
            for axis in 0..3 {
                moved[axis] += part * x[3 * index + axis];
            }
        }
        Some(farthest)
    }

    /// Moves the blocks to their equilibrium; false if the arch falls.
    pub fn settle(&mut self) -> bool {
        let start = self.moved.clone();
        for _ in 0..400 {
            let Some(farthest) = self.descend(0.3) else {
                return false;
            };
            if farthest < 1e-7 {
                for index in 0..self.bars.len() {
                    let bar = &self.bars[index];
                    let (_, length) = self.line(bar, 0, [0.0; 3]);
                    let longest = bar.natural + bar.yields_at / bar.stiffness;
                    self.bars[index].natural += (length - longest).max(0.0);
                }
                return true;
            }
            let gone = self.moved.iter().zip(&start);
            let gone =
                gone.flat_map(|(now, then)| (0..3).map(move |axis| (now[axis] - then[axis]).abs()));
            if gone.fold(0.0, f64::max) > 0.5 {
                return false;
            }
        }
        false
    }

    /// Largest push at which forces at the closed corners hold all blocks in their present position.
    pub fn first_motion(&self) -> f64 {
        let (blocks, joints) = (self.masses.len(), self.joints.len());
        // Unknowns of each joint: the force along it and the normal forces at both corners. The last unknown is the push.
        let (mut rows, mut columns, mut values): Triplets = Default::default();
        let mut right = vec![0.0; 3 * blocks];
        let mut pulls = Vec::new();
        for joint in 0..joints {
            let [_, inner, outer] = self.opening(joint, [[0.0; 3]; 2]);
            // A hinge transmits force at its closed corner.
            let touching = [inner < 1e-6, outer < 1e-6];
            let left = self.joints[joint].map(|corner| self.place(joint, corner, [0.0; 3]));
            let other = self.joints[joint].map(|corner| self.place(joint + 1, corner, [0.0; 3]));
            let sum =
                [0, 1].map(|axis| left[1][axis] - left[0][axis] + other[1][axis] - other[0][axis]);
            let length = sum[0].hypot(sum[1]);
            let along = sum.map(|part| part / length);
            let across = [along[1], -along[0]];
            let held = usize::from(!touching[0]);
            let forces = [(along, left[held]), (across, left[0]), (across, left[1])];
            for (kind, (force, point)) in forces.into_iter().enumerate() {
                let column = 3 * joint + kind;
                if kind > 0 {
                    pulls.push((column, touching[kind - 1]));
                }
                for (body, sign) in [(joint, -1.0), (joint + 1, 1.0)] {
                    if body == 0 || body > blocks {
                        continue;
                    }
                    let centre = self.place(body, self.centres[body - 1], [0.0; 3]);
                    let turn =
                        (point[0] - centre[0]) * force[1] - (point[1] - centre[1]) * force[0];
                    for (axis, value) in [force[0], force[1], turn].into_iter().enumerate() {
                        rows.push(3 * (body - 1) + axis);
                        columns.push(column);
                        values.push(sign * value);
                    }
                }
            }
        }
        let push = 3 * joints;
        for (block, mass) in self.masses.iter().enumerate() {
            rows.push(3 * block);
            columns.push(push);
            values.push(*mass);
            right[3 * block + 1] = *mass;
        }
        for bar in &self.bars {
            let (along, pull) = (self.line(bar, 0, [0.0; 3]).0, self.pull(bar));
            for ((body, point), sign) in bar.ends.iter().zip([1.0, -1.0]) {
                if (1..=blocks).contains(body) {
                    let centre = self.place(*body, self.centres[body - 1], [0.0; 3]);
                    let end = self.place(*body, *point, [0.0; 3]);
                    let force = along.map(|part| sign * pull * part);
                    let turn = (end[0] - centre[0]) * force[1] - (end[1] - centre[1]) * force[0];
                    for (axis, value) in [force[0], force[1], turn].into_iter().enumerate() {
                        right[3 * (body - 1) + axis] -= value;
                    }
                }
            }
        }
        let equations = right.len();
        let parted = pulls.iter().filter(|(_, touching)| !touching).count();
        let (mut zero, mut press) = (equations, equations + parted);
        for (column, touching) in pulls {
            let row = if touching { &mut press } else { &mut zero };
            rows.push(*row);
            columns.push(column);
            values.push(-1.0);
            right.push(0.0);
            *row += 1;
        }
        let matrix = CscMatrix::new_from_triplets(right.len(), push + 1, rows, columns, values);
        let mut goal = vec![0.0; push + 1];
        goal[push] = -1.0;
        let none = CscMatrix::zeros((push + 1, push + 1));
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-11,
            tol_gap_rel: 1e-11,
            tol_feas: 1e-11,
            ..DefaultSettings::default()
        };
        let cones = [
            ZeroConeT(equations + parted),
            NonnegativeConeT(right.len() - equations - parted),
        ];
        let mut solver =
            DefaultSolver::new(&none, &goal, &matrix, &right, &cones, settings).unwrap();
        solver.solve();
        assert_eq!(solver.solution.status, SolverStatus::Solved);
        solver.solution.x[push]
    }

    /// How far the extrados of the crown has come down.
    fn crown_drop(&self) -> f64 {
        let joint = self.joints.len() / 2;
        let crown = self.joints[joint][1];
        crown[1] - self.place(joint, crown, [0.0; 3])[1]
    }
}

/// The minimum of the energy of all blocks vanishes in the same step of the support in which the path of hinges ends. Halfway
/// there, the crown has come down equally in both computations. The cases are thin and thick semicircles and a flatter arch.
#[test]
fn an_arch_falls_when_its_energy_minimum_vanishes() {
    for (embrace_deg, thickness, voussoirs, direction, steps) in [
        (180.0, 0.12, 12, OUT, 20),
        (180.0, 0.15, 20, OUT, 40),
        (180.0, 0.20, 16, OUT, 30),
        (180.0, 0.12, 12, DOWN, 20),
        (180.0, 0.15, 16, DOWN, 30),
        (180.0, 0.15, 16, INWARDS, 20),
        (157.5, 0.20, 12, DIAGONAL, 30),
    ] {
        let what = format!("{embrace_deg} degrees, {thickness}, {voussoirs}, {direction:?}");
        let row = arch(embrace_deg, thickness, voussoirs);
        let falls_at = falls_at(&row, direction);
        let mut blocks = Blocks::new(embrace_deg, thickness, voussoirs);
        let stride = falls_at / (f64::from(steps) - 0.5);
        for step in 1..=steps {
            blocks.support = direction.map(|part| part * stride * f64::from(step));
            let stands = blocks.settle();
            assert_eq!(stands, step < steps, "{what}: step {step}");
            if step == steps / 2 {
                let mut follower = Follower::new(&row).unwrap();
                let reached =
                    follower.move_supports(right(direction), 0.0, stride * f64::from(step));
                assert_eq!(reached.unwrap(), None);
                let crown = row.joints[voussoirs / 2].extrados_m;
                let pose = follower.stance.placement.poses[voussoirs / 2 - 1];
                let drop = (crown - pose.current_position(crown)).y;
                // The judge rests where no block goes by more than 1e-7.
                assert!((drop - blocks.crown_drop()).abs() < 1e-6, "{what}: {drop}");
            }
        }
    }
}

/// The push of the first motion on moved supports agrees with a linear programme of forces at the closed corners. The push at
/// which the arch falls is that of the programme in the last equilibrium under a growing push.
#[test]
fn both_pushes_are_those_of_limit_analysis_at_moved_positions() {
    for (embrace_deg, thickness, voussoirs, direction, at) in [
        (180.0, 0.15, 16, OUT, 0.04),
        (180.0, 0.15, 16, DOWN, 0.1),
        (157.5, 0.15, 12, OUT, 0.08),
    ] {
        let what = format!("{embrace_deg} degrees, {direction:?}");
        let row = arch(embrace_deg, thickness, voussoirs);
        let mut follower = Follower::new(&row).unwrap();
        follower.move_supports(right(direction), 0.0, at).unwrap();
        let [first_g, capacity_g] = pushes_g(&follower, Sway::Right);
        let mut blocks = Blocks::new(embrace_deg, thickness, voussoirs);
        for step in 1..=20 {
            blocks.support = direction.map(|part| part * at * f64::from(step) / 20.0);
            assert!(blocks.settle(), "{what}");
        }
        assert!(
            (blocks.first_motion() - first_g).abs() < 1e-6,
            "{what}: {first_g}"
        );
        let mut last = blocks.clone();
        for step in 1.. {
            blocks.push = 0.004 * f64::from(step);
            if !blocks.settle() {
                break;
            }
            last = blocks.clone();
        }
        let own_g = last.first_motion();
        assert!(
            (own_g - capacity_g).abs() < 1e-6,
            "{what}: {own_g} {capacity_g}"
        );
        assert!(capacity_g >= first_g, "{what}");
    }
}

/// A bar between the intrados corners of a joint and of its mirror image. With `ground` it connects the first of these corners to
/// the ground near the left foot.
fn bar(
    blocks: &Blocks,
    joint: usize,
    [stiffness, prestress, yields_at]: [f64; 3],
    ground: bool,
) -> Bar {
    let other = blocks.joints.len() - 1 - joint;
    let first = (joint + 1, blocks.joints[joint][0]);
    let ends = if ground {
        [(0, [-0.4, 0.0]), first]
    } else {
        [first, (other, blocks.joints[other][0])]
    };
    let length = (ends[1].1[0] - ends[0].1[0]).hypot(ends[1].1[1] - ends[0].1[1]);
    Bar {
        ends,
        stiffness,
        natural: length - prestress / stiffness,
        yields_at,
    }
}

/// A semicircle with these bars, as a row and as blocks.
fn with_bars(voussoirs: usize, bars: impl Fn(&Blocks) -> Vec<Bar>) -> (Row, Blocks) {
    let mut blocks = Blocks::new(180.0, 0.15, voussoirs);
    blocks.bars = bars(&blocks);
    let row = arch(180.0, 0.15, voussoirs);
    let weight_n = row.mass_kg() * 9.81;
    let ties = blocks.bars.iter().map(|bar| bar.tie(weight_n, voussoirs));
    let ties = ties.collect();
    (row.with_ties(ties, 9.81).unwrap(), blocks)
}

/// A semicircle with one bar at a quarter of its joints, as a row and as blocks.
fn tied(
    voussoirs: usize,
    stiffness: f64,
    prestress: f64,
    yields_at: f64,
    ground: bool,
) -> (Row, Blocks) {
    let law = [stiffness, prestress, yields_at];
    with_bars(voussoirs, |blocks| {
        vec![bar(blocks, voussoirs / 4, law, ground)]
    })
}

/// A tied arch on a moving right foot stays at the minimum of the energy of blocks and bar. The cases have three hinges with a
/// soft tie (also anchored in the ground), four hinges held by a stiff tie, and a yielding tie. The arch falls in the step in
/// which the minimum vanishes. With three hinges, the push of the first motion agrees with the programme that includes the force
/// of the bar; with four hinges it is zero.
#[test]
fn a_tied_arch_follows_its_energy_minimum() {
    let unbounded = f64::INFINITY;
    let (mut most, mut yielded) = (3, 0.0_f64);
    for (stiffness, prestress, yields_at, ground, direction, stride, steps, falls) in [
        (1.0, 0.05, unbounded, false, OUT, 0.01, 12, false),
        (1.0, 0.05, unbounded, true, OUT, 0.005, 10, false),
        (5.0, 0.03, unbounded, false, DOWN, 0.009, 22, false),
        (
            1.0,
            0.0,
            unbounded,
            false,
            OUT,
            0.235_399_9 / 29.5,
            30,
            true,
        ),
        (20.0, 0.0, unbounded, false, INWARDS, 0.0065, 20, false),
        (150.0, 0.0, 0.1, false, OUT, 0.0025, 12, false),
        (150.0, 0.0, 0.1, false, DOWN, 0.01, 24, false),
    ] {
        let what = format!("{stiffness} {prestress} {yields_at} {ground} {direction:?}");
        let (row, mut blocks) = tied(16, stiffness, prestress, yields_at, ground);
        let weight_n = row.mass_kg() * 9.81;
        let mut follower = Follower::new(&row).unwrap();
        for step in 1..=steps {
            let [from, to] = [step - 1, step].map(|step| stride * f64::from(step));
            let reached = follower.move_supports(right(direction), from, to).unwrap();
            blocks.support = direction.map(|part| part * to);
            let stands = blocks.settle();
            let last = falls && step == steps;
            assert_eq!((reached.is_none(), stands), (!last, !last), "{what}: {to}");
            if last {
                break;
            }
            let crown = row.joints[8].extrados_m;
            let drop = (crown - follower.stance.placement.poses[7].current_position(crown)).y;
            let force = follower.stance.forces_n().sum::<f64>() / weight_n;
            let due = blocks.pull(&blocks.bars[0]);
            // The judge rests where no block goes by more than 1e-7, and where it is that times the stiffness.
            let (off, loose) = ((force - due).abs(), 1e-6 * (1.0 + stiffness));
            assert!(off < loose, "{what} {to}: {force} {due}");
            assert!(
                (drop - blocks.crown_drop()).abs() < 2e-6,
                "{what} {to}: {drop}"
            );
            let hinges = follower.hinges.as_ref().unwrap().hinges.len();
            most = most.max(hinges);
            let [first_g, capacity_g] = pushes_g(&follower, Sway::Right);
            assert!(
                capacity_g >= first_g && (hinges == 3 || first_g == 0.0),
                "{what}"
            );
            if step % 5 == 0 && hinges == 3 {
                // The push changes with the force of the bar.
                let own_g = blocks.first_motion();
                assert!(
                    (own_g - first_g).abs() < loose,
                    "{what} {to}: {own_g} {first_g}"
                );
            }
        }
        yielded = yielded.max(follower.stance.ties[0].yielded_m.0[0]);
    }
    assert!(most == 4 && yielded > 0.01, "{most} {yielded}");
}

/// Steps of a movement grow while blocks rotate steadily, but end where a tie yields. One long movement gives the yielding and
/// the capacities of 1000 short ones, to a millionth of the radius, of the weight and of gravity.
#[test]
fn yielding_of_ties_does_not_depend_on_step_length() {
    for (direction, end_m) in [(OUT, 0.03), (DOWN, 0.24)] {
        let law = |yields_at| [75.0, 0.0, yields_at];
        let (row, _) = with_bars(16, |blocks| {
            let bars = [(4, 0.06), (3, 0.04)];
            let bars = bars.map(|(joint, yields_at)| bar(blocks, joint, law(yields_at), false));
            bars.to_vec()
        });
        let [one, many] = [1, 1000].map(|pieces| {
            let mut follower = Follower::new(&row).unwrap();
            let at_m = |piece: u32| end_m * f64::from(piece) / f64::from(pieces);
            for piece in 0..pieces {
                let ends_m = [piece, piece + 1].map(at_m);
                let reached = follower.move_supports(right(direction), ends_m[0], ends_m[1]);
                assert_eq!(reached, Ok(None), "{direction:?} {ends_m:?}");
            }
            let weight_n = row.mass_kg() * 9.81;
            let ties = follower.stance.ties.iter();
            let mut numbers: Vec<f64> = ties
                .flat_map(|tie| [tie.yielded_m.0[0], tie.force_n.0[0] / weight_n])
                .collect();
            for sway in [Sway::Right, Sway::Left] {
                numbers.extend(pushes_g(&follower, sway));
            }
            numbers
        });
        assert!(one[0].max(one[2]) > 1e-3, "{direction:?}: {one:?}");
        for (one, many) in one.iter().zip(&many) {
            assert!((one - many).abs() < 1e-6, "{direction:?}: {one} {many}");
        }
    }
}

/// Two stiff bars at different heights hold an arch on five hinges. Each has the force that it has at the minimum of the energy
/// of blocks and bars. With two bars, the force of one depends on the other.
#[test]
fn an_arch_with_two_ties_follows_its_energy_minimum() {
    let (mut most, mut pulling) = (3, 0);
    for (stiffnesses, direction, stride, steps) in [
        ([150.0, 100.0], OUT, 0.005, 12),
        ([150.0, 100.0], DOWN, 0.02, 20),
    ] {
        let (row, mut blocks) = with_bars(16, |blocks| {
            let bars = [4, 2].into_iter().zip(stiffnesses);
            bars.map(|(joint, stiffness)| {
                bar(blocks, joint, [stiffness, 0.0, f64::INFINITY], false)
            })
            .collect()
        });
        let weight_n = row.mass_kg() * 9.81;
        let mut follower = Follower::new(&row).unwrap();
        for step in 1..=steps {
            let [from, to] = [step - 1, step].map(|step| stride * f64::from(step));
            let what = format!("{stiffnesses:?} {direction:?} {to}");
            let reached = follower.move_supports(right(direction), from, to).unwrap();
            assert_eq!(reached, None, "{what}");
            blocks.support = direction.map(|part| part * to);
            assert!(blocks.settle(), "{what}");
            let crown = row.joints[8].extrados_m;
            let drop = (crown - follower.stance.placement.poses[7].current_position(crown)).y;
            assert!((drop - blocks.crown_drop()).abs() < 2e-6, "{what}: {drop}");
            let forces = follower.stance.forces_n().map(|force_n| force_n / weight_n);
            let pairs: Vec<(f64, f64)> = forces
                .zip(blocks.bars.iter().map(|bar| blocks.pull(bar)))
                .collect();
            // The judge rests where no block goes by more than 1e-7, which times the stiffness is force.
            for ((force, due), stiffness) in pairs.iter().zip(stiffnesses) {
                let loose = 1e-6 * (1.0 + stiffness);
                assert!((force - due).abs() < loose, "{what}: {pairs:?}");
            }
            pulling += u32::from(pairs.iter().all(|(force, _)| *force > 0.01));
            most = most.max(follower.hinges.as_ref().unwrap().hinges.len());
        }
    }
    assert!(most == 5 && pulling > 5, "{most} {pulling}");
}

/// For an arch that its tie holds on four hinges, and on three once the tie yields, commands print the results of the library:
/// the force of the tie, the pushes, every hinge in the table and in the picture, and the position of the tie.
#[test]
fn commands_report_an_arch_held_by_its_tie() {
    let text = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 16\n[free_hinges]\n\
                [[tie]]\nheight_m = 3.3\nstiffness_n_m = 7e6\nyield_force_n = 2.5e4\n\
                [supports]\nright = { settlement_m = 0.3 }\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), text).unwrap();
    let scenario = parsed(text);
    let row = scenario.structure.row().unwrap();
    let movements = scenario.motion.supports().unwrap();
    let mut follower = Follower::new(&row).unwrap();
    let direction = |part: f64| movements * part;
    follower.move_supports(direction, 0.0, 1.0).unwrap();
    let hinges = &follower.hinges.as_ref().unwrap().hinges;
    assert_eq!(hinges.len(), 4);
    let force_n = follower.stance.forces_n().next().unwrap();

    let reported = printed(folder.path(), &["limit", "a.toml", "--format", "json"]);
    let reported: serde_json::Value = serde_json::from_str(&reported).unwrap();
    let words = printed(folder.path(), &["limit", "a.toml"]);
    assert_eq!(
        reported["ties"],
        serde_json::json!({ "forces_at_rest_n": [force_n], "mechanism_without": true })
    );
    let listed = hinges
        .iter()
        .map(|hinge| serde_json::json!({ "joint": hinge.joint, "edge": hinge.edge.name() }));
    assert_eq!(reported["hinges"], listed.collect::<serde_json::Value>());
    shows(&words, &[force_n / 1e3]);
    golden("limit-held-by-tie", &words);
    for sway in [Sway::Right, Sway::Left] {
        let side = sway.name();
        let [first_g, falls_g] = pushes_g(&follower, sway);
        assert_eq!(first_g, 0.0);
        assert_eq!(reported["incipient_acceleration_g"][side], first_g);
        assert_eq!(reported["capacity_g"][side], falls_g);
        assert_eq!(reported["mechanism"][side], serde_json::json!([]));
        shows(&words, &[falls_g]);
    }

    let angles_deg = [90.0, 0.0];
    let directions = angles_deg.map(|angle_deg| SpringingDirection {
        springing: Sway::Right,
        angle_deg,
    });
    let found = spread(&scenario, &directions).unwrap();
    printed(
        folder.path(),
        &["spread", "a.toml", "--angle", "90", "--angle", "0"],
    );
    let results = folder.path().join("results/a");
    let table = Table::read(results.join("spread.csv"));
    let picture = std::fs::read_to_string(results.join("spread.svg")).unwrap();
    let picture = Document::parse(&picture).unwrap();
    let stages = found.paths.iter().flat_map(|path| &path.stages);
    let mut counts = Vec::new();
    for (row, stage) in table.rows.iter().zip(stages) {
        let state = stage.state.as_ref().unwrap();
        counts.push(state.hinges.len());
        let mut open = state.hinges.iter().zip(&state.hinge_rotations_rad);
        for number in 1..=4 {
            let cell = |what: &str| &row[&format!("hinge_{number}_{what}")];
            let (hinge, turn_rad) = open.next().unzip();
            let joint = hinge.map(|hinge| hinge.joint.to_string());
            assert_eq!(*cell("joint"), joint.unwrap_or_default());
            assert_eq!(cell("edge"), hinge.map_or("", |hinge| hinge.edge.name()));
            assert_eq!(cell("rotation_rad").parse().ok(), turn_rad.copied());
        }
    }
    assert_eq!(counts.len(), table.rows.len());
    assert!(
        [3, 4].iter().all(|count| counts.contains(count)),
        "{counts:?}"
    );
    let last = found.paths.iter().map(|path| path.stages.last().unwrap());
    let due: usize = last.clone().map(|stage| stage.hinges.len()).sum();
    assert_eq!(named(&picture, "hinge").len(), due);
    let ties = named(&picture, "tie");
    let blocks = named(&picture, "block 1");
    assert_eq!((ties.len(), blocks.len()), (2, 2));
    for ((tie, block), stage) in ties.iter().zip(&blocks).zip(last) {
        let corner_m = |corner: usize| stage.poses[0].current_position(row.outlines_m[0][corner]);
        let (tie_px, block_px) = (points(tie), points(block));
        let apart_m = corner_m(1) - corner_m(0);
        let scale = (block_px[1] - block_px[0]).norm() / apart_m.norm();
        for (end_px, anchor) in tie_px.iter().zip(row.ties[0].ends) {
            let end_m = stage.poses[anchor.block.unwrap()].current_position(anchor.at_m);
            let from_m = end_m - corner_m(0);
            let due_px = block_px[0] + Vector2::new(from_m.x, -from_m.y) * scale;
            // Coordinates have two digits of a pixel, and the scale is that of a joint.
            let off_px = (end_px - due_px).norm();
            assert!(off_px < 1e-3 * from_m.norm() * scale, "{off_px}");
        }
        assert_eq!(tie_px.len(), 2);
    }
}

/// Under a growing push the tied arch falls in the same step in both computations.
#[test]
fn a_tied_arch_falls_at_the_push_that_removes_its_energy_minimum() {
    for (stiffness, prestress, direction, at) in [(1.0, 0.05, OUT, 0.06), (20.0, 0.0, DOWN, 0.06)] {
        let (row, mut blocks) = tied(16, stiffness, prestress, f64::INFINITY, false);
        let mut follower = Follower::new(&row).unwrap();
        follower.move_supports(right(direction), 0.0, at).unwrap();
        let [_, capacity_g] = pushes_g(&follower, Sway::Right);
        for step in 1..=20 {
            blocks.support = direction.map(|part| part * at * f64::from(step) / 20.0);
            assert!(blocks.settle());
        }
        let stride = capacity_g / 29.5;
        for step in 1..=30 {
            blocks.push = stride * f64::from(step);
            assert_eq!(blocks.settle(), step < 30, "{stiffness}: {step}");
        }
    }
}

/// Force and yielding of a tie on elastic joints tend to those on rigid joints as the joints get stiffer, on three hinges and on
/// four. The tie breaks at the movement at which it breaks on rigid joints.
#[test]
fn ties_on_elastic_joints_tend_to_those_on_rigid_ones() {
    for (stiffness, prestress, yields_at, direction, at) in [
        (1.0, 0.05, f64::INFINITY, OUT, 0.06),
        (150.0, 0.03, f64::INFINITY, DOWN, 0.12),
        (150.0, 0.0, 0.1, OUT, 0.03),
    ] {
        let (row, _) = tied(16, stiffness, prestress, yields_at, false);
        let weight_n = row.mass_kg() * 9.81;
        let mut follower = Follower::new(&row).unwrap();
        follower.move_supports(right(direction), 0.0, at).unwrap();
        let rigid = follower.stance.ties[0];
        let joints = |normal_pa_m: f64| {
            let properties = ElasticProperties {
                friction_coefficient: None,
                ..ElasticProperties::of_stiffness(normal_pa_m)
            };
            let joints = ElasticStructure::of_row(&row, &properties).unwrap();
            joints.on_supports(right(direction)(at).displacements())
        };
        let mut last = f64::INFINITY;
        for normal_pa_m in [1e9, 1e11, 1e13] {
            let rest = joints(normal_pa_m).rest([0.0, -9.81]).unwrap();
            let tie = rest.ties[0];
            let force = (tie.force_n.0[0] - rigid.force_n.0[0]) / weight_n;
            let off = force.abs() + (tie.yielded_m.0[0] - rigid.yielded_m.0[0]).abs();
            assert!(
                off < 0.5 * last,
                "{stiffness} {normal_pa_m:e}: {off:e} {last:e}"
            );
            last = off;
        }
        assert!(last < 1e-3, "{stiffness}: {last:e}");
    }
    let (row, _) = tied(16, 1.0, 0.05, f64::INFINITY, false);
    let tie = Tie {
        breaks_at_strain: 0.07,
        ..row.ties[0]
    };
    let breaks_m = 0.07 * tie.slack_length_m();
    let row = row.with_ties(vec![tie], 9.81).unwrap();
    let mut follower = Follower::new(&row).unwrap();
    let mut at = 0.0;
    while follower.stance.broken_tie().is_none() {
        follower.move_supports(right(OUT), at, at + 1e-3).unwrap();
        at += 1e-3;
    }
    let properties = ElasticProperties {
        friction_coefficient: None,
        ..ElasticProperties::of_stiffness(1e12)
    };
    let joints = ElasticStructure::of_row(&row, &properties).unwrap();
    let joints = joints.on_supports(right(OUT)(0.1).displacements());
    let Err(RestError::TieDuringMovement(0, part)) = joints.rest([0.0, -9.81]) else {
        panic!("it holds");
    };
    // The search for the break takes steps of 3 % of the movement.
    assert!((0.1 * part - at).abs() < 5e-3, "{part} {at} {breaks_m}");
}

/// A translation of both supports changes nothing: with rigid and elastic joints, with ties to blocks and to the ground, for
/// short and long movements, and if the two movements differ by rounding.
#[test]
fn translation_does_not_change_an_arch() {
    for (ground, far, off) in [(false, 0.3, 0.0), (true, 40.0, 0.0), (true, 0.3, 5e-17)] {
        let (row, _) = tied(16, 5.0, 0.03, f64::INFINITY, ground);
        let movement = |spread_m| Movement {
            spread_m,
            settlement_m: 0.5 * far,
            rotation_rad: 0.0,
        };
        let along = Movements {
            left: movement(-far),
            right: movement(far + off),
        };
        let mut follower = Follower::new(&row).unwrap();
        let direction = |part: f64| along * part;
        assert_eq!(follower.move_supports(direction, 0.0, 1.0).unwrap(), None);
        let built = Follower::new(&row).unwrap();
        for sway in [Sway::Right, Sway::Left] {
            let [now, then] =
                [&follower, &built].map(|row| row.first_motion_g(sway).unwrap().unwrap());
            // Large coordinates have larger rounding errors, which the stiffness of the tie turns into forces.
            assert!((now - then).abs() < 1e-11, "{far}: {now} {then}");
        }
        let model = ElasticJoints::new(row.clone(), ElasticProperties::of_stiffness(1e9)).unwrap();
        let moved = model.clone().on_supports(along).unwrap();
        let [here, there] = [&model, &moved].map(|model| model.rest(9.81).unwrap());
        for (here, there) in here.moved.iter().zip(&there.moved) {
            for (axis, by) in [far, -0.5 * far, 0.0].into_iter().enumerate() {
                assert!((there[axis] - here[axis] - by).abs() < 1e-12 * (1.0 + far));
            }
        }
        let ground = Pulse::Rectangular
            .lasting_s(0.05)
            .horizontal_m_s2(-2.0)
            .unwrap();
        let request = Request {
            end_s: 0.05,
            ..Request::default()
        };
        let turned = |model: &ElasticJoints| {
            let history = model.history(&ground, &request).unwrap();
            let [first, last] = [history.samples.iter().next(), history.samples.iter().last()]
                .map(|sample| sample.unwrap().rotations_rad.to_vec());
            let by = last.iter().zip(&first).map(|(last, first)| last - first);
            by.collect::<Vec<f64>>()
        };
        let [first, second] = [&model, &moved].map(turned);
        let off = first
            .iter()
            .zip(&second)
            .map(|(one, other)| (one - other).abs());
        let off = off.fold(0.0, f64::max);
        let most = first
            .iter()
            .fold(0.0_f64, |most, turn| most.max(turn.abs()));
        assert!(
            most > 1e-4 && off < 1e-11 * (1.0 + far),
            "{far}: {off:e} {most}"
        );
    }
}

/// An arch rotated as a whole has the capacity of the undeformed arch under gravity rotated by the opposite angle. The reference
/// is the linear programme of forces of the built arch, whose push then has a component along its height. Rotated too far, the
/// arch falls.
#[test]
fn rotation_of_a_whole_arch_acts_as_inclined_gravity() {
    let row = arch(157.5, 0.15, 12);
    let joints = &row.joints;
    let turned = |angle: f64| {
        let movement = |joint: usize, outwards: f64| {
            let middle = joints[joint].middle_m();
            let (sin, cos) = angle.sin_cos();
            let by = [
                cos * middle.x - sin * middle.y - middle.x,
                sin * middle.x + cos * middle.y - middle.y,
            ];
            Movement {
                spread_m: outwards * by[0],
                settlement_m: -by[1],
                rotation_rad: angle,
            }
        };
        Movements {
            left: movement(0, -1.0),
            right: movement(12, 1.0),
        }
    };
    let built_g = Follower::new(&row)
        .unwrap()
        .first_motion_g(Sway::Left)
        .unwrap()
        .unwrap();
    let falls_at = built_g.atan();
    for (angle, stands) in [
        (0.1, true),
        (0.999 * falls_at, true),
        (1.001 * falls_at, false),
    ] {
        let mut follower = Follower::new(&row).unwrap();
        let movements = turned(angle);
        let reached = follower
            .move_supports(|part| movements * part, 0.0, 1.0)
            .unwrap();
        assert_eq!(reached.is_none(), stands, "{angle}");
        if !stands {
            continue;
        }
        // Rotated anticlockwise, the arch leans to the left. The remaining push to the left is the part of the angle that the
        // lean has not used.
        let left_g = follower.first_motion_g(Sway::Left).unwrap().unwrap();
        assert!(
            (left_g.atan() + angle - falls_at).abs() < 1e-9,
            "{angle}: {left_g}"
        );
    }
}

/// Reference values from an independent program: Newton's method on the stationary energy of hinges, bisection of the changes of
/// hinges, and block-coordinate descents in between.
#[test]
fn paths_agree_with_an_independent_program() {
    let e = Edge::Extrados;
    let i = Edge::Intrados;
    for (embrace_deg, thickness, voussoirs, direction, expected) in [
        (180.0, 0.15, 20, OUT, 0.107_852),
        (180.0, 0.15, 36, OUT, 0.111_646_18),
        (180.0, 0.15, 72, OUT, 0.123_689),
        (180.0, 0.15, 36, INWARDS, 0.070_144_98),
        (180.0, 0.15, 36, DOWN, 0.262_390_91),
        (180.0, 0.15, 36, DIAGONAL, 0.158_417_79),
        (180.0, 0.20, 36, OUT, 0.269_296_76),
        (180.0, 0.20, 72, INWARDS, 0.193_854),
        (157.5, 0.15, 36, OUT, 0.199_574_50),
        (157.5, 0.20, 72, DOWN, 0.766_293),
        (140.0, 0.15, 72, OUT, 0.221_228),
        (140.0, 0.20, 36, DIAGONAL, 0.448_308),
    ] {
        let found = falls_at(&arch(embrace_deg, thickness, voussoirs), direction);
        // The reference values have six digits.
        assert!(
            (found - expected).abs() < 6e-7,
            "{embrace_deg} {thickness} {direction:?}: {found}"
        );
    }
    let semicircle = arch(180.0, 0.15, 36);
    for (direction, at, thrust, hinges) in [
        (
            OUT,
            0.027_912,
            0.185_861,
            [(6, i, -0.02314), (18, e, 0.04627), (30, i, -0.02314)],
        ),
        (
            OUT,
            0.111_646,
            0.231_941,
            [(7, i, -0.11139), (18, e, 0.22278), (29, i, -0.11139)],
        ),
        (
            INWARDS,
            0.035_072,
            0.206_553,
            [(0, e, 0.01009), (27, i, -0.05291), (36, e, 0.04282)],
        ),
        (
            DOWN,
            0.131_195,
            0.196_615,
            [(7, i, -0.10368), (18, e, 0.05616), (36, e, 0.04752)],
        ),
        (
            DIAGONAL,
            0.079_209,
            0.198_102,
            [(6, i, -0.08225), (18, e, 0.09784), (29, i, -0.01559)],
        ),
    ] {
        let mut follower = Follower::new(&semicircle).unwrap();
        follower.move_supports(right(direction), 0.0, at).unwrap();
        let state = follower.state().unwrap();
        // The movement has six digits, and the thrust changes up to three times as fast.
        assert!(
            (state.right_reaction.linear.x.abs() - thrust).abs() < 2e-6,
            "{at}"
        );
        for ((hinge, turn), (joint, edge, expected)) in state
            .hinges
            .iter()
            .zip(&state.hinge_rotations_rad)
            .zip(hinges)
        {
            assert_eq!((hinge.joint, hinge.edge), (joint, edge), "{at}");
            assert!((turn - expected).abs() < 6e-6, "{at}: {turn}");
        }
    }
    for (at, first_g, capacity_g) in [
        (0.25, 0.006_437_48, 0.115_773),
        (0.5, 0.006_302_81, 0.094_315),
        (0.9, 0.001_970_59, 0.020_574),
    ] {
        let mut follower = Follower::new(&semicircle).unwrap();
        follower
            .move_supports(right(OUT), 0.0, at * 0.111_646_18)
            .unwrap();
        for sway in [Sway::Right, Sway::Left] {
            let [first, capacity] = pushes_g(&follower, sway);
            assert!((first - first_g).abs() < 2e-8, "{at}: {first}");
            assert!((capacity - capacity_g).abs() < 1e-6, "{at}: {capacity}");
        }
    }
}

/// An arch that spreads and returns falls inwards at the same movement as without the excursion. With a settlement as well,
/// joints close on the way back in the step in which another one must open; hinges were once lost there.
#[test]
fn a_return_path_does_not_change_the_collapse() {
    let row = arch(180.0, 0.15, 20);
    let inwards_from = |out: [f64; 2]| {
        let mut follower = Follower::new(&row).unwrap();
        let reached = follower.move_supports(right(out), 0.0, 1.0).unwrap();
        assert!(reached.is_none());
        let back = |s: f64| right([out[0] - s, out[1]])(1.0);
        match follower.move_supports(back, 0.0, 1.6).unwrap() {
            Some(at) => at,
            None => panic!("it stands"),
        }
    };
    let fall = inwards_from([0.04, 0.0]);
    assert!((fall - 0.04 - falls_at(&row, INWARDS)).abs() < 1e-9);
    let settled = inwards_from([0.04, 0.01]);
    assert!((settled - fall).abs() < 0.01, "{settled} {fall}");
}

/// Moving the left springing is equivalent to moving the right one, or each by half.
#[test]
fn moving_either_springing_is_equivalent() {
    let row = arch(157.5, 0.15, 15);
    let both = |s: f64, [left, right]: [f64; 2]| Movements {
        left: Movement {
            spread_m: s * left,
            settlement_m: 0.5 * s * left,
            rotation_rad: -0.2 * s * left,
        },
        right: Movement {
            spread_m: s * right,
            settlement_m: 0.5 * s * right,
            rotation_rad: 0.2 * s * right,
        },
    };
    let fall = |parts: [f64; 2]| {
        let mut follower = Follower::new(&row).unwrap();
        match follower
            .move_supports(|s| both(s, parts), 0.0, 0.5)
            .unwrap()
        {
            Some(at) => at,
            None => panic!("it stands"),
        }
    };
    assert!((fall([1.0, 0.0]) - fall([0.0, 1.0])).abs() < 1e-12);
    // Without rotation and settlement only the distance counts.
    let spread = |parts: [f64; 2]| {
        let mut follower = Follower::new(&row).unwrap();
        let movements = |s: f64| Movements {
            left: Movement {
                spread_m: s * parts[0],
                ..Movement::default()
            },
            right: Movement {
                spread_m: s * parts[1],
                ..Movement::default()
            },
        };
        match follower.move_supports(movements, 0.0, 0.5).unwrap() {
            Some(at) => at,
            None => panic!("it stands"),
        }
    };
    assert!((spread([0.5, 0.5]) - spread([0.0, 1.0])).abs() < 1e-12);
}

/// A springing rotates about the middle of its joint. The resulting three-pin arch keeps the distances of its hinges and closes
/// at both ends.
#[test]
fn a_rotated_springing_leaves_a_compatible_three_pin_arch() {
    let row = arch(157.5, 0.15, 20);
    let mut follower = Follower::new(&row).unwrap();
    let turned = |s: f64| Movements {
        right: Movement {
            rotation_rad: -s,
            ..Movement::default()
        },
        ..Movements::default()
    };
    assert_eq!(follower.move_supports(turned, 0.0, 0.02).unwrap(), None);
    let state = follower.state().unwrap();
    let sum: f64 = state.hinge_rotations_rad.iter().sum();
    assert!((sum + 0.02).abs() < 1e-14 && state.margin() >= -1e-12);
    assert!(follower.stance.placement.closure_error() < 1e-13);
}

const SEMICIRCLE: &str =
    "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n";

#[test]
fn spread_reports_the_collapse_movement_and_the_remaining_push() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arch.toml"), SEMICIRCLE).unwrap();
    let words = printed(folder.path(), &["spread", "arch.toml"]);
    let reported = json(&folder.path().join("results/arch/spread.json"));
    let path = &reported["paths"][0];
    let falls_at_m = path["falls_at_m"].as_f64().unwrap();
    assert!((falls_at_m - 0.558_230_9).abs() < 1e-6);
    shows(&words, &[falls_at_m, falls_at_m / 9.25, 9.25]);
    let undeformed = &path["stages"][0]["capacity_g"]["right"];
    assert!((undeformed.as_f64().unwrap() - 0.144_799_62).abs() < 1e-8);
    assert!(path["stages"][0]["thrust_n"].is_null());
    let rows = Table::read(folder.path().join("results/arch/spread.csv"));
    assert_eq!(rows.numbers("movement_m").len(), 3 * 21);
    // At the brink of collapse any push moves the arch: `limit` prints zero and nothing negative.
    let brink_m = path["falls_at_m"].as_f64().unwrap() * (1.0 - 1e-13);
    let moved = format!("supports={{right={{spread_m={brink_m:?}}}}}");
    let limit = [
        "limit",
        "arch.toml",
        "--format",
        "json",
        "--set",
        &moved,
        "--set",
        "free_hinges={}",
    ];
    let limit: serde_json::Value = serde_json::from_str(&printed(folder.path(), &limit)).unwrap();
    for side in ["right", "left"] {
        assert_eq!(path["stages"][20]["first_motion_g"][side], 0.0);
        assert_eq!(limit["incipient_acceleration_g"][side], 0.0);
    }
    // The radius is 5 m; the thrust is relative to the weight of the ring.
    let half = &path["stages"][10];
    let weight_n = reported["weight_n"].as_f64().unwrap();
    let thrust = half["thrust_n"].as_f64().unwrap() / weight_n;
    assert!((thrust - 0.197_138).abs() < 2e-6, "{thrust}");
    let picture = std::fs::read_to_string(folder.path().join("results/arch/spread.svg")).unwrap();
    assert_eq!(picture.matches("data-name=\"hinge\"").count(), 9);
    assert!(!picture.contains("NaN"));
    // The left springing gives the mirrored path.
    let left = printed(
        folder.path(),
        &[
            "spread",
            "arch.toml",
            "--springing",
            "left",
            "--angle",
            "0",
            "--format",
            "json",
            "--out",
            "left",
        ],
    );
    let left: serde_json::Value = serde_json::from_str(&left).unwrap();
    let at = left["paths"][0]["falls_at_m"].as_f64().unwrap();
    assert!((at - 0.558_230_9).abs() < 1e-6);
}

/// From moved supports `spread` prints the further movement, and the command of a point on the page repeats the total one.
#[test]
fn spread_from_moved_supports_prints_the_further_movement() {
    let folder = tempfile::tempdir().unwrap();
    let moved = format!("{SEMICIRCLE}[free_hinges]\n[supports]\nright = {{ spread_m = 0.1 }}\n");
    std::fs::write(folder.path().join("arch.toml"), moved).unwrap();
    let words = printed(folder.path(), &["spread", "arch.toml"]);
    let reported = json(&folder.path().join("results/arch/spread.json"));
    let path = &reported["paths"][0];
    let falls_at_m = path["falls_at_m"].as_f64().unwrap();
    assert!((falls_at_m + 0.1 - 0.558_230_9).abs() < 1e-6);
    assert!(words.starts_with("right springing outwards, further than `[supports]`: falls at"));
    assert!(words.contains("\n  further m "));
    let page = std::fs::read_to_string(folder.path().join("results/arch/spread.html")).unwrap();
    let total_m = 0.1 + path["stages"][20]["movement_m"].as_f64().unwrap();
    let digits = format!("{total_m:?}");
    assert!(
        page.contains(&format!("supports.right.spread_m={}", &digits[..10])),
        "{total_m}"
    );
    // An arch on piers stands on feet.
    let piers = format!("{SEMICIRCLE}[piers]\nheight_m = 2.0\nwidth_m = 2.5\n");
    std::fs::write(folder.path().join("piers.toml"), piers).unwrap();
    let words = printed(folder.path(), &["spread", "piers.toml"]);
    assert!(words.starts_with("right foot outwards: "), "{words}");
    assert!(words.contains("joint from 0 at the left foot"), "{words}");
}

/// Shallow arches lose their thrust as a springing moves inwards. Their capacity then equals the push of the first motion, for
/// every radius. Rounding once made the program miss it.
#[test]
fn an_arch_without_thrust_has_the_capacity_of_its_first_motion() {
    for (embrace_deg, thickness, voussoirs, due_g) in [
        (140.0, 0.18, 36, 0.004_489),
        (140.0, 0.18, 20, 0.004_492),
        (90.0, 0.15, 36, 0.007_099),
        (120.0, 0.2, 20, 0.016_469),
    ] {
        let ring = Ring::new(thickness, f64::to_radians(embrace_deg)).unwrap();
        for radius_m in [1.0, 2.0, 3.0, 4.0, 6.0, 8.0] {
            let row = Row::arch(&ring, voussoirs, radius_m, 1.0, 2000.0).unwrap();
            let direction = |part: f64| right([-1.0, 0.0])(radius_m * part);
            let Some(at) = Follower::new(&row)
                .and_then(|mut scout| scout.move_supports(direction, 0.0, 1.7))
                .unwrap()
            else {
                panic!("it stands");
            };
            let mut follower = Follower::new(&row).unwrap();
            follower.move_supports(direction, 0.0, at).unwrap();
            let state = follower.state().unwrap();
            assert!(state.right_reaction.linear.x.abs() < 1e-9);
            for sway in [Sway::Right, Sway::Left] {
                let first_g = follower.first_motion_g(sway).unwrap().unwrap();
                let capacity_g = follower.capacity_g(sway, 0.0).unwrap().unwrap();
                assert!((first_g - due_g).abs() < 1e-6, "{first_g}");
                assert!(
                    (capacity_g - first_g).abs() < 1e-8,
                    "{radius_m} m: {first_g} {capacity_g}"
                );
            }
        }
    }
}

/// A snap may move the middle pin of three to the other side of the line between the outer pins. Results of every stage are
/// found, and no capacity is below the push of the first motion.
#[test]
fn pins_may_change_sides() {
    let text = "[arch]\nmean_radius_m = 4.0\nthickness_ratio = 0.18\nembrace_deg = 100.0\nvoussoirs = 20\n";
    let scenario = parsed(text);
    let down = SpringingDirection {
        springing: Sway::Right,
        angle_deg: 90.0,
    };
    let found = spread(&scenario, &[down]).unwrap();
    let [path] = &found.paths[..] else {
        panic!("one way");
    };
    assert_eq!(path.lost, None);
    assert_eq!(path.stages.len(), 21);
    for stage in &path.stages {
        assert_eq!(stage.not_found, []);
        for (sway, first_g) in stage.first_motion_g.iter() {
            assert!(first_g.unwrap() <= stage.capacity_g.get(sway).unwrap());
        }
    }
}

/// A flat arch on spreading springings snaps through when its three hinges lie on one line. Its forces then exceed all bounds:
/// thrust and pushes are omitted with the reason, and the stage before has a large thrust.
#[test]
fn an_unbounded_thrust_is_omitted() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[arch]\nmean_radius_m = 4.0\nthickness_ratio = 0.1\nembrace_deg = 40\nvoussoirs = 12\n[free_hinges]\n";
    std::fs::write(folder.path().join("flat.toml"), text).unwrap();
    let words = printed(folder.path(), &["spread", "flat.toml", "--angle", "0"]);
    let reported = json(&folder.path().join("results/flat/spread.json"));
    let path = &reported["paths"][0];
    let [before, last] = [19, 20].map(|stage: usize| &path["stages"][stage]);
    assert_eq!(path["falls_at_m"], last["movement_m"]);
    assert!((1.0..100.0).contains(&before["thrust_ratio"].as_f64().unwrap()));
    assert_eq!(before["not_found"], serde_json::json!([]));
    for force in ["thrust_n", "thrust_ratio", "right_support_force_n"] {
        assert!(last[force].is_null(), "{force}");
    }
    assert!(last["friction_demand"].as_f64().unwrap() < 1.0);
    let reasons = last["not_found"].as_array().unwrap();
    assert_eq!(reasons.len(), 2);
    for (reason, side) in reasons.iter().zip(["right", "left"]) {
        assert_eq!(
            (&reason["push"], &reason["side"]),
            (&"first motion".into(), &side.into())
        );
        assert!(last["first_motion_g"][side].is_null() && last["capacity_g"][side].is_null());
        assert!(words.contains(reason["reason"].as_str().unwrap()));
    }
    let table = Table::read(folder.path().join("results/flat/spread.csv"));
    assert_eq!(table.rows[20]["thrust_n"], "");
}

/// Under a push of several g this flat arch leaves one springing and leans on the other. The program does not follow that, so it
/// omits this capacity with the reason and reports everything else.
#[test]
fn a_push_that_is_not_found_is_omitted_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[arch]\nmean_radius_m = 1.0\nthickness_ratio = 0.15\nembrace_deg = 74.3\nvoussoirs = 7\n[free_hinges]\n";
    std::fs::write(folder.path().join("flat.toml"), text).unwrap();
    let words = printed(
        folder.path(),
        &["spread", "flat.toml", "--angle", "67", "--angle", "0"],
    );
    golden("spread", &words);
    let reported = json(&folder.path().join("results/flat/spread.json"));
    let falls_at_m =
        [0, 1].map(|path: usize| reported["paths"][path]["falls_at_m"].as_f64().unwrap());
    assert!((falls_at_m[0] - 0.358_811).abs() < 5e-7);
    shows(&words, &falls_at_m);
    let stages = reported["paths"][0]["stages"].as_array().unwrap();
    let mut missing = 0;
    for stage in stages {
        for side in ["right", "left"] {
            assert!(stage["first_motion_g"][side].is_number());
            let mut reasons = stage["not_found"].as_array().unwrap().iter();
            let reason = reasons.find(|reason| reason["side"] == side);
            assert_eq!(reason.is_some(), stage["capacity_g"][side].is_null());
            if let Some(reason) = reason {
                missing += 1;
                assert_eq!(reason["push"], "capacity");
                assert!(!reason["reason"].as_str().unwrap().is_empty());
                // One side alone is not the weaker one.
                let row = format!("  {:<11.6}", stage["movement_m"].as_f64().unwrap());
                let mut shown = words.lines().filter(|line| line.starts_with(&row));
                assert!(shown.all(|line| line.ends_with("           -")), "{words}");
            }
        }
    }
    assert!(missing > 0);
}

#[test]
fn spread_refuses_structures_without_two_springings() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("ring.toml"),
        SEMICIRCLE.replace("voussoirs = 36", ""),
    )
    .unwrap();
    std::fs::write(
        folder.path().join("column.toml"),
        "[column]\nheight_m = 4\nwidth_m = 1\n",
    )
    .unwrap();
    refused(
        folder.path(),
        &["spread", "ring.toml"],
        &["give the number of voussoirs"],
    );
    refused(
        folder.path(),
        &["spread", "column.toml"],
        &["stands on one support"],
    );
    refused(
        folder.path(),
        &["spread", "ring.toml", "--angle", "200"],
        &["from -180 to 180"],
    );
}

/// If the extrados of the springings lies above the intrados of the crown, no hinges allow the springings to approach each other:
/// the arch jams. The message blames neither weights nor iterations.
#[test]
fn a_flat_thick_arch_jams() {
    let direction = |embrace_deg, direction| {
        let row = arch(embrace_deg, 0.41, 12);
        Follower::new(&row)
            .unwrap()
            .move_supports(right(direction), 0.0, 1e-3)
    };
    for jams in [INWARDS, DOWN] {
        let error = direction(97.0, jams).unwrap_err();
        assert!(
            matches!(error, SettlingError::Contact(ContactError::Jammed(_))),
            "{error}"
        );
    }
    assert_eq!(direction(97.0, OUT), Ok(None));
    // (1 + 0.205) cos(51.5 degrees) = 0.750 is below 1 - 0.205.
    assert_eq!(direction(103.0, INWARDS), Ok(None));

    let text = "[arch]\nmean_radius_m = 4.0\nthickness_ratio = 0.41\nembrace_deg = 97.0\nvoussoirs = 12\n[free_hinges]\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("flat.toml"), text).unwrap();
    let words = printed(folder.path(), &["spread", "flat.toml"]);
    let jammed = "right springing inwards: stands up to 0.000000 m, and cannot be followed further: the blocks jam";
    assert!(words.contains(jammed), "{words}");
    assert!(
        words.contains("right springing outwards: falls at"),
        "{words}"
    );
}

/// [`SEMICIRCLE`] with elastic joints of this normal stiffness.
fn elastic(normal_gpa_m: f64) -> ElasticProperties {
    ElasticProperties {
        friction_coefficient: None,
        ..ElasticProperties::of_stiffness(1e9 * normal_gpa_m)
    }
}

fn semicircle_of_5_m() -> Row {
    let ring = Ring::new(0.15, std::f64::consts::PI).unwrap();
    Row::arch(&ring, 36, 5.0, 1.0, 2000.0).unwrap()
}

/// Reference movements at collapse over the radius, from explicit steps of an independent program with mass damping: springings
/// spread over 300 s, half to each side. Delay and damping are worth 0.002. The movements tend to those of rigid joints.
#[test]
fn arches_of_elastic_joints_fall_earlier_and_tend_to_rigid_ones() {
    let row = semicircle_of_5_m();
    let mut last = 0.0;
    for (normal_gpa_m, expected) in [(1.0, 0.0657), (10.0, 0.0956), (100.0, 0.1064)] {
        let joints = ElasticStructure::of_row(&row, &elastic(normal_gpa_m)).unwrap();
        let joints = joints.on_supports([[-0.3, 0.0, 0.0], [0.3, 0.0, 0.0]]);
        let Err(RestError::Supports(part)) = joints.rest([0.0, -9.81]) else {
            panic!("it stands");
        };
        let found = part * 0.6 / 5.0;
        assert!((found - expected).abs() < 0.003, "{normal_gpa_m}: {found}");
        assert!(found > last && found < 0.111_646, "{normal_gpa_m}: {found}");
        last = found;
    }
}

fn spread_out(spread_m: f64) -> Movements {
    Movements {
        right: Movement {
            spread_m,
            settlement_m: 0.3 * spread_m,
            rotation_rad: -0.002,
        },
        ..Movements::default()
    }
}

/// An arch on moved springings stays at rest until the ground moves: from 10 s on, by too little to be seen.
#[test]
fn a_settled_arch_is_at_rest() {
    let model = ElasticJoints::new(semicircle_of_5_m(), elastic(10.0)).unwrap();
    let model = model.on_supports(spread_out(0.15)).unwrap();
    let ground = Pulse::HalfSine
        .lasting_s(0.2)
        .starting_at_s(9.9)
        .horizontal_m_s2(1e-9)
        .unwrap();
    let request = Request {
        end_s: 10.2,
        ..Request::default()
    };
    let summary = model.simulate(&ground, &request, None).unwrap();
    // Rounding of the equilibrium, and then the pulse of 1e-10 g.
    let largest = summary
        .peak_rotations_rad
        .iter()
        .fold(0.0_f64, |most, peak| most.max(*peak));
    assert!(largest < 1e-8, "{largest:e}");
    assert!(summary.end_s > 10.0, "{}", summary.end_s);
}

/// The push that starts a settled arch of elastic joints agrees with the push of the first motion of its rigid twin. A symmetric
/// arch translated as a whole is unchanged.
#[test]
fn the_onset_of_a_settled_elastic_arch_agrees_with_its_rigid_twin() {
    let row = semicircle_of_5_m();
    let movements = spread_out(0.15);
    let mut follower = Follower::new(&row).unwrap();
    follower
        .move_supports(|part| movements * part, 0.0, 1.0)
        .unwrap();
    let model = ElasticJoints::new(row.clone(), elastic(10.0)).unwrap();
    let settled = model.clone().on_supports(movements).unwrap();
    for sway in [Sway::Right, Sway::Left] {
        let [first_g, _] = pushes_g(&follower, sway);
        assert_eq!(settled.incipient_acceleration_g(sway), Some(first_g));
        assert!(first_g < 0.5 * model.incipient_acceleration_g(sway).unwrap());
    }
    let along = Movements {
        left: Movement {
            spread_m: -0.2,
            settlement_m: 0.1,
            rotation_rad: 0.0,
        },
        right: Movement {
            spread_m: 0.2,
            settlement_m: 0.1,
            rotation_rad: 0.0,
        },
    };
    let built = model.rest(9.81).unwrap();
    let joints = model.structure.clone().on_supports(along.displacements());
    let moved = joints.rest([0.0, -9.81]).unwrap();
    for (built, moved) in built.moved.iter().zip(&moved.moved) {
        for (axis, shift) in [0.2, -0.1, 0.0].into_iter().enumerate() {
            // Equilibria are found to 1e-8 of the weight or better, with a compliance of 1e-4 m per weight.
            assert!((moved[axis] - built[axis] - shift).abs() < 1e-10);
        }
    }
}

const ELASTIC: &str = "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n[ground.half_sine]\namplitude_g = 0.03\nduration_s = 0.2\n";

#[test]
fn a_scenario_can_give_the_movement_of_its_springings() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, supports: &str| {
        let text = format!("{SEMICIRCLE}{ELASTIC}[supports]\n{supports}\n");
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    write(
        "arch.toml",
        "right = { spread_m = 0.15, settlement_m = 0.05 }",
    );
    let resolved = printed(folder.path(), &["check", "arch.toml"]);
    assert!(
        resolved.contains("spread_m = 0.15") && resolved.contains("settlement_m = 0.05"),
        "{resolved}"
    );
    let reported = printed(
        folder.path(),
        &["run", "arch.toml", "--no-repeat", "--format", "json"],
    );
    let reported: serde_json::Value = serde_json::from_str(&reported).unwrap();
    assert!(
        reported["incipient_acceleration_g"]["right"]
            .as_f64()
            .unwrap()
            < 0.08
    );
    // The rigid twin has moved by the same amount.
    let said = printed(folder.path(), &["run", "arch.toml"]);
    assert!(
        said.contains("with rigid joints (free hinges)") && !said.contains("that were built"),
        "{said}"
    );
    for (supports, words) in [
        (
            "right = { spread_m = -9.5 }",
            "pushes the springings 9.5 m towards each other",
        ),
        ("right = { spread_m = 0.7 }", "with rigid joints"),
        (
            "right = { spread_m = 0.53 }",
            "with joints as soft as these",
        ),
        ("right = { spread = 0.1 }", "unknown key `spread`"),
        ("right = { rotation_rad = 3.0 }", "out of range"),
    ] {
        write("wrong.toml", supports);
        refused(
            folder.path(),
            &["run", "wrong.toml"],
            &[words, "wrong.toml:"],
        );
    }
    refused(
        folder.path(),
        &["run", "arch.toml", "--hinges", "four"],
        &["four links start undeformed"],
    );
    refused(
        folder.path(),
        &["capacity", "arch.toml"],
        &["leave [supports] out"],
    );
    std::fs::write(folder.path().join("column.toml"), format!("[column]\nheight_m = 4\nwidth_m = 1\n{ELASTIC}[supports]\nright = {{ spread_m = 0.1 }}\n")).unwrap();
    refused(
        folder.path(),
        &["run", "column.toml"],
        &["stands on one support"],
    );
}
