//! Equilibrium of a structure with elastic joints, by Newton's method with exact tangents.

use thiserror::Error;

use super::banded::Banded;
use super::contact::{Fibre, Memory};
use super::kinematics::{Action, BodyPosition};
use super::structure::ElasticStructure;
use crate::mechanics::lanes::Dual;
use crate::mechanics::{Lanes, Real, TieMemory};

/// Number type of a single motion.
type SingleLane = Lanes<1>;

/// Structure in equilibrium.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Displacements (m) and rotations (rad) of the bodies.
    pub moved: Vec<[f64; 3]>,
    /// Displacements (m) and rotations (rad) under the weight alone, on supports in their original position.
    pub self_weight_displacements: Vec<[f64; 3]>,
    /// States of the joints.
    pub memories: Vec<Memory<SingleLane>>,
    /// States of crushing at the positions along the joints, joint by joint.
    pub fibres: Vec<Fibre<SingleLane>>,
    /// States of the ties.
    pub ties: Vec<TieMemory<SingleLane>>,
    /// Unbalanced force over the weight.
    pub unbalanced: f64,
    /// Number of Newton steps.
    pub steps: usize,
}

/// Reason why a structure has no equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RestError {
    /// Equilibrium exists without slip only.
    #[error(
        "the joints slip under the weight of the structure: it needs a larger friction_coefficient"
    )]
    Friction,
    /// Equilibrium exists without crushing only.
    #[error(
        "the joints crush under the weight of the structure: it needs a larger compressive_strength_mpa"
    )]
    Strength,
    /// Equilibrium exists with continuous contact only.
    #[error(
        "with so few contact points the structure is a mechanism: between two points the thrust bends no joint; give more \
         contact_points, or contact = \"continuous\""
    )]
    Points,
    /// Equilibrium exists with stiffer joints only.
    #[error(
        "with joints as soft as these the structure bends so far under its weight that it falls: it needs a larger stiffness, \
         or a greater thickness"
    )]
    Stiffness,
    /// The structure falls at this fraction of the movement of its supports.
    #[error("the structure falls when its supports have moved {:.2} % of the way", 1e2 * .0)]
    Supports(f64),
    /// The tie with this index breaks under the weight.
    #[error("tie {number} breaks under the weight of the structure: it needs a larger breaks_at_strain, or less prestress_n", number = .0 + 1)]
    Tie(usize),
    /// The tie with this index breaks at this fraction of the movement of the supports.
    #[error(
        "tie {number} breaks when the supports have moved {part:.2} % of the way: it needs a larger breaks_at_strain",
        number = .0 + 1,
        part = 1e2 * .1
    )]
    TieDuringMovement(usize, f64),
    /// No equilibrium was found.
    #[error("no equilibrium was found under the weight of the structure: give another stiffness")]
    NotFound,
}

/// Tolerance of unbalanced forces over the weight, at which the iteration stops.
const ROUNDING: f64 = 1e-12;
/// Largest unbalanced force over the weight that counts as equilibrium.
const BALANCED: f64 = 1e-8;
/// Maximum number of Newton steps at one stiffness.
const MOST_STEPS: usize = 80;
/// Factor between the stiffnesses of successive equilibria, if the stiffness is raised in steps.
const RAISED: f64 = 3.162_277_660_168_379_5;
/// First stiffnesses over the full one, tried in turn if no equilibrium is found at full stiffness.
const FIRST_STIFFNESS: [f64; 4] = [0.1, 1e-2, 1e-3, 1e-4];

impl Equilibrium {
    /// Index of the first broken tie.
    fn broken_tie(&self) -> Option<usize> {
        self.ties.iter().position(TieMemory::is_broken)
    }

    /// Joint with the largest eccentricity of the thrust, and this eccentricity over the length of the joint.
    pub(crate) fn largest_eccentricity(&self, structure: &ElasticStructure) -> (usize, f64) {
        let each = structure.fibres();
        let moved = |body: usize| self.moved.get(body).unwrap_or(structure.support(body));
        let joints = structure.row_joints().iter().enumerate();
        let eccentricities = joints.map(|(index, joint)| {
            let [first, second] = joint
                .geometry
                .bodies
                .map(|body| BodyPosition::at(moved(body)));
            let mut fibres = self.fibres[index * each..(index + 1) * each].to_vec();
            let memory = &self.memories[index];
            let places = [&first, &second];
            let ([one_n, other_n], _) = structure.elastic_n(joint, places, memory, &mut fibres);
            (index, 0.5 * ((other_n - one_n) / (one_n + other_n)).abs())
        });
        eccentricities.fold(
            (0, 0.0),
            |most, other| {
                if other.1 > most.1 { other } else { most }
            },
        )
    }
}

impl ElasticStructure {
    /// Finds the equilibrium under a load per unit mass, in m/s2, to the right and upwards. The search starts from the undeformed structure, with a
    /// first step for joints with tensile strength.
    ///
    /// # Errors
    /// If no equilibrium is found, with the reason.
    pub fn rest(&self, load_m_s2: [f64; 2]) -> Result<Equilibrium, RestError> {
        if self.has_settled() {
            let built = self.clone().on_supports([[0.0; 3]; 2]);
            return self.find_settled_equilibrium(load_m_s2, built.rest(load_m_s2)?);
        }
        if let Some(rest) = self.find_equilibrium(load_m_s2) {
            return match rest.broken_tie() {
                Some(tie) => Err(RestError::Tie(tie)),
                None => Ok(rest),
            };
        }
        let (law, without_slip) = (&self.law, self.without_slip());
        let continuous = without_slip.continuous();
        let uncrushed = without_slip.without_crushing();
        let stiffer = continuous.stiffness_times(1e3);
        let easier = [
            (law.friction[0] > 0.0, without_slip, RestError::Friction),
            (law.crushes, uncrushed, RestError::Strength),
            (true, continuous, RestError::Points),
            (true, stiffer, RestError::Stiffness),
        ];
        let mut causes = easier.into_iter();
        let cause =
            causes.find(|(may, other, _)| *may && other.find_equilibrium(load_m_s2).is_some());
        Err(cause.map_or(RestError::NotFound, |(.., error)| error))
    }

    /// Finds the equilibrium after a slow movement of the supports, from the equilibrium `built` before it. The movement is divided into steps; each
    /// starts from a linear extrapolation of the last two equilibria. Slip accumulates over the whole movement. The plastic elongation of ties remains.
    fn find_settled_equilibrium(
        &self,
        load_m_s2: [f64; 2],
        built: Equilibrium,
    ) -> Result<Equilibrium, RestError> {
        let self_weight_displacements = built.self_weight_displacements.clone();
        let length_m = Search::new(self, load_m_s2).length_m;
        let far = |moved: &[f64; 3]| libm::hypot(moved[0], moved[1]).max(length_m * moved[2].abs());
        // A common displacement of both supports causes no forces.
        let (along_m, along) = self.moved_along();
        let from = along.supports.iter().zip(self.supports);
        let ways = from.map(|(from, to)| far(&[0, 1, 2].map(|axis| to[axis] - from[axis])));
        let extent_m = ways.sum::<f64>();
        // Fractions of the whole movement.
        let longest = LONGEST_SETTLING * length_m / extent_m;
        let (mut part, mut stride) = (0.0, 0.1 * longest);
        let mut here = built;
        for moved in &mut here.moved {
            for axis in 0..2 {
                moved[axis] += along_m[axis];
            }
        }
        let mut before: Option<(f64, Vec<[f64; 3]>)> = None;
        while part < 1.0 {
            let next = (part + stride).min(1.0);
            let expected = match &before {
                Some((earlier, moved)) => {
                    extrapolated(&here.moved, moved, (next - part) / (part - earlier))
                }
                None => here.moved.clone(),
            };
            let on_way = self.at_movement_fraction(next);
            let most_m = (FARTHEST * (next - part) * extent_m).max(NOT_FAR * length_m);
            let near = |rest: &Equilibrium| {
                let moved = rest.moved.iter().zip(&here.moved);
                let by = |(now, then): (&[f64; 3], &[f64; 3])| {
                    far(&[0, 1, 2].map(|axis| now[axis] - then[axis]))
                };
                moved.map(by).fold(0.0, f64::max) < most_m
            };
            let search = Search::new(&on_way, load_m_s2).with_ties(&here.ties);
            let found = search.solve_from(expected, here.steps).filter(near);
            let Some(found) = found else {
                stride *= 0.5;
                if stride < SHORTEST_SETTLING * longest {
                    return Err(RestError::Supports(part));
                }
                continue;
            };
            if let Some(tie) = found.broken_tie() {
                return Err(RestError::TieDuringMovement(tie, next));
            }
            if found.steps - here.steps <= QUICK_STEPS {
                stride = (1.5 * stride).min(longest);
            }
            before = Some((part, here.moved));
            (here, part) = (found, next);
        }
        here.self_weight_displacements = self_weight_displacements;
        Ok(here)
    }

    /// Finds the equilibrium on supports that stay in place; `None` if the search does not converge.
    fn find_equilibrium(&self, load_m_s2: [f64; 2]) -> Option<Equilibrium> {
        let bonded = Search::new(self, load_m_s2).bonded_displacements()?;
        if let Some(rest) = Search::new(self, load_m_s2).solve_from(bonded.clone(), 0) {
            return Some(rest);
        }
        FIRST_STIFFNESS.into_iter().find_map(|first| {
            let mut stiffness = first;
            let softened = bonded.iter().map(|moved| moved.map(|part| part / first));
            let mut moved: Vec<_> = softened.collect();
            let mut steps = 0;
            loop {
                let softer = self.stiffness_times(stiffness);
                let rest = Search::new(&softer, load_m_s2).solve_from(moved, steps)?;
                if stiffness == 1.0 {
                    return Some(rest);
                }
                let next = stiffness * RAISED;
                let next = if next < 0.999 { next } else { 1.0 };
                let raised = |moved: &[f64; 3]| moved.map(|part| part * stiffness / next);
                moved = rest.moved.iter().map(raised).collect();
                (stiffness, steps) = (next, rest.steps);
            }
        })
    }

    /// Lower bound, in J, of the energy above that at rest that the structure needs to overturn without slip. `None` if the bound is not
    /// found, or if a joint crushes on the path. With slip, less energy may suffice.
    ///
    /// The structure is pushed over slowly. This path may be lost if the joints are too stiff or have contact points. The path of softer joints with
    /// continuous contact then gives a lower bound: their energy is lower in every shape, because a sum over points, as the trapezoidal rule,
    /// overestimates a convex function.
    pub fn barrier_j(&self, rest: &Equilibrium, gravity_m_s2: f64) -> Option<f64> {
        // Ties and walls are not supported.
        if !self.ties.is_empty() || self.wall.is_some() {
            return None;
        }
        let load_m_s2 = [0.0, -gravity_m_s2];
        let rest_j = Search::new(self, load_m_s2).energy_j(rest);
        if let Some(summit_j) = self.summit_j(rest, gravity_m_s2) {
            return Some(summit_j - rest_j);
        }
        // With moved supports the state depends on the path, which is different for softer joints.
        if self.law.crushes || self.has_settled() {
            return None;
        }
        let mut softer = self.without_slip().continuous();
        let tried = softer == self.without_slip();
        (usize::from(tried)..SOFTER).find_map(|step| {
            if step > 0 {
                softer = softer.stiffness_times(1.0 / RAISED);
            }
            let summit_j = softer.summit_j(&softer.find_equilibrium(load_m_s2)?, gravity_m_s2)?;
            Some(summit_j - rest_j).filter(|barrier_j| *barrier_j > 0.0)
        })
    }

    /// Energy in J, above that of the undeformed structure, at the top of the lower one of the paths to the right and to the left.
    fn summit_j(&self, rest: &Equilibrium, gravity_m_s2: f64) -> Option<f64> {
        let to = |sense| self.summit_towards_j(rest, gravity_m_s2, sense);
        Some(to(1.0)?.min(to(-1.0)?))
    }

    /// Energy in J at the top of the path to the right (`sense` 1) or to the left (-1): there the structure falls without a push. The
    /// horizontal position of the centre of gravity is prescribed. Everything else is in equilibrium without slip, and the push does the work. `None`
    /// if the path is lost, or if a joint crushes on the path.
    ///
    /// A structure that overturns passes through all positions of its centre of gravity. Among nearby shapes with the same position, those on the
    /// path have the least energy. A structure with less energy than at the top cannot pass it.
    fn summit_towards_j(&self, rest: &Equilibrium, gravity_m_s2: f64, sense: f64) -> Option<f64> {
        let without_slip = self.without_slip();
        let search = Search::new(&without_slip, [0.0, -gravity_m_s2]);
        let mass_kg = self.mass_kg();
        let first_m = FIRST_STRIDE * search.length_m;
        let (mut stride_m, mut work_j) = (first_m, 0.0);
        let mut here = PushedEquilibrium {
            moved: rest.moved.clone(),
            push_m_s2: 0.0,
            sway_m: search.sway_m(&rest.moved),
        };
        let mut before: Option<PushedEquilibrium> = None;
        for _ in 0..MOST_STRIDES {
            let there = search.find_pushed(before.as_ref(), &here, sense * stride_m);
            let Some((there, steps)) = there else {
                stride_m *= 0.5;
                if stride_m < SHORTEST_STRIDE * first_m {
                    return None;
                }
                continue;
            };
            // In the last step the push decreases linearly to zero.
            let (from, to) = (sense * here.push_m_s2, sense * there.push_m_s2);
            let part = if to > 0.0 { 1.0 } else { from / (from - to) };
            work_j += 0.5 * (from + to.max(0.0)) * part * stride_m * mass_kg;
            let shape = search.equilibrium_at(there.moved.clone(), 0.0, 0);
            if shape.fibres.iter().any(|fibre| fibre.crushed_m.0[0] > 0.0) {
                return None;
            }
            if to <= 0.0 {
                // If the search jumped to another path, the work differs from the energy gained by the structure.
                let rest_j = search.energy_j(rest);
                let gained_j = search.energy_j(&shape) - rest_j;
                let same = (work_j - gained_j).abs() < SAME_ENERGY * work_j;
                return same.then_some(rest_j + work_j.min(gained_j));
            }
            if steps <= 4 {
                stride_m = (1.5 * stride_m).min(10.0 * first_m);
            }
            before = Some(std::mem::replace(&mut here, there));
        }
        None
    }
}

/// Longest step of the supports, over the mean length of the joints.
const LONGEST_SETTLING: f64 = 2e-2;
/// Shortest step of the supports over the longest one; the structure falls if shorter steps would be required.
const SHORTEST_SETTLING: f64 = 1e-5;
/// Largest displacement of a body in a step, over the displacement of the supports. A larger one is a jump to another equilibrium.
const FARTHEST: f64 = 50.0;
/// Displacements below this fraction of the length of a joint are rounding errors.
const NOT_FAR: f64 = 1e-9;
/// Largest number of Newton steps after which the next step of the supports is longer.
const QUICK_STEPS: usize = 8;

/// First step of the overturning path, over the mean length of the joints; the longest step is ten times as long.
const FIRST_STRIDE: f64 = 2e-3;
/// Shortest step of the overturning path, over the first one. The path is lost if shorter steps would be required.
const SHORTEST_STRIDE: f64 = 1e-6;
/// Tolerance between the energy gained by the structure and the work of the push, relative to the work.
const SAME_ENERGY: f64 = 0.03;
/// Maximum number of steps of the overturning path.
const MOST_STRIDES: usize = 1000;
/// Number of softer structures for which a path is searched.
const SOFTER: usize = 6;
/// Largest unbalanced force over the weight on the overturning path.
const BALANCED_ON_WAY: f64 = 1e-7;

/// Structure in equilibrium with a sideways push.
struct PushedEquilibrium {
    moved: Vec<[f64; 3]>,
    /// Push to the right per unit mass, in m/s2.
    push_m_s2: f64,
    /// Displacement of the centre of gravity to the right, in m.
    sway_m: f64,
}

/// Search for the equilibrium of a structure.
struct Search<'a> {
    structure: &'a ElasticStructure,
    load_m_s2: [f64; 2],
    /// Plastic elongation of the ties before the search, in m.
    yielded_m: Vec<f64>,
    weight_n: f64,
    /// Scale of rotations and moments, in m.
    length_m: f64,
    width: usize,
}

impl<'a> Search<'a> {
    fn new(structure: &'a ElasticStructure, load_m_s2: [f64; 2]) -> Self {
        let joints = &structure.joints;
        let bodies = structure.bodies.len();
        let ties = structure.ties.iter().map(|tie| tie.bodies);
        let pairs = joints.iter().map(|joint| joint.geometry.bodies).chain(ties);
        let reach = pairs.map(|pair| match pair {
            [one, other] if one < bodies && other < bodies => one.abs_diff(other),
            _ => 0,
        });
        let lengths: f64 = joints.iter().map(|joint| joint.geometry.length_m).sum();
        Self {
            structure,
            load_m_s2,
            yielded_m: vec![0.0; structure.ties.len()],
            weight_n: structure.mass_kg() * libm::hypot(load_m_s2[0], load_m_s2[1]),
            length_m: lengths / joints.len() as f64,
            width: 3 * reach.max().unwrap_or(0) + 2,
        }
    }

    /// Search with given states of the ties.
    fn with_ties(mut self, ties: &[TieMemory<SingleLane>]) -> Self {
        self.yielded_m = ties.iter().map(|tie| tie.yielded_m.0[0]).collect();
        self
    }

    /// Computes the unbalanced forces (moments over the length). Fills the matrix, if given, with minus their derivatives by the coordinates.
    fn compute_unbalanced_forces(
        &self,
        moved: &[[f64; 3]],
        bonded: bool,
        matrix: Option<&mut Banded>,
        forces: &mut [f64],
    ) {
        let bodies = &self.structure.bodies;
        for (index, body) in bodies.iter().enumerate() {
            forces[3 * index] = body.mass_kg * self.load_m_s2[0];
            forces[3 * index + 1] = body.mass_kg * self.load_m_s2[1];
            forces[3 * index + 2] = 0.0;
        }
        let units = [1.0, 1.0, self.length_m];
        let Some(matrix) = matrix else {
            let place = |body: usize, _| self.body_position(moved, body);
            self.act(bonded, place, |row, _, force: SingleLane| {
                forces[row] += force.0[0] / units[row % 3];
            });
            return;
        };
        let place = |body: usize, end| self.variable(moved, body, end);
        self.act(bonded, place, |row, pair, force| {
            forces[row] += force.value / units[row % 3];
            for (end, of) in pair.into_iter().enumerate() {
                for by in 0..3 {
                    if of < bodies.len() {
                        let slope = force.slope[3 * end + by];
                        matrix.add(row, 3 * of + by, -slope / (units[row % 3] * units[by]));
                    }
                }
            }
        });
    }

    /// Computes the forces between the bodies of each joint and of each tie. `place` gives the position of a body as the first or second of a pair.
    /// `found` receives, for each coordinate of a body, the index of the coordinate, the pair, and the force or moment.
    fn act<R: Real>(
        &self,
        bonded: bool,
        place: impl Fn(usize, usize) -> BodyPosition<R>,
        mut found: impl FnMut(usize, [usize; 2], R),
    ) {
        let bodies = self.structure.bodies.len();
        let mut between = |pair: [usize; 2], action: &Action<R>| {
            let [x, y] = action.force_n;
            let [first, second] = action.moments_n_m;
            let on = [[-x, -y, first], [x, y, second]];
            for (body, on) in pair.into_iter().zip(on) {
                for (axis, force) in on.into_iter().enumerate() {
                    if body < bodies {
                        found(3 * body + axis, pair, force);
                    }
                }
            }
        };
        for joint in &self.structure.joints {
            let pair = joint.geometry.bodies;
            let [first, second] = [0, 1].map(|end| place(pair[end], end));
            let section = &self.structure.law.section;
            let action = if bonded {
                let gap = joint.geometry.gap(&first, &second);
                let edges = section.bonded_forces(gap.penetrations_m);
                let edges_n = edges.map(|edge| edge * joint.normal_n_m);
                let shear_n = gap.slip_m * joint.shear_n_m;
                joint.geometry.action(&gap, edges_n, shear_n)
            } else {
                let (mut memory, mut fibres) = (Memory::none(), [Fibre::none(); MOST_FIBRES]);
                let fibres = &mut fibres[..section.fibres()];
                let places = [&first, &second];
                let (action, ..) = self.structure.act(joint, places, None, &mut memory, fibres);
                action
            };
            between(pair, &action);
        }
        for (bound, yielded_m) in self.structure.ties.iter().zip(&self.yielded_m) {
            let pair = bound.bodies;
            let [first, second] = [0, 1].map(|end| place(pair[end], end));
            let span = bound.span([&first, &second]);
            let force_n = match bonded {
                true => bound.tie.linear_pull_n(span.stretch_m),
                false => bound.tie.pull_n(*yielded_m, span.stretch_m),
            };
            between(pair, &bound.action([&first, &second], &span, force_n));
        }
    }

    /// Position of a body or a support.
    fn body_position(&self, moved: &[[f64; 3]], body: usize) -> BodyPosition<SingleLane> {
        BodyPosition::at(moved.get(body).unwrap_or(self.structure.support(body)))
    }

    /// Position of the first or second body of a pair, with the derivatives by the coordinates of both.
    fn variable(&self, moved: &[[f64; 3]], body: usize, end: usize) -> BodyPosition<Dual<6>> {
        let Some(at) = moved.get(body) else {
            return BodyPosition::at(self.structure.support(body));
        };
        let variable = |axis: usize| Dual::<6>::variable(at[axis], 3 * end + axis);
        let angle = variable(2);
        let (sin, cos) = libm::sincos(0.5 * at[2]);
        let quarter = libm::sin(0.25 * at[2]);
        let half_turn = [
            angle.chained(-2.0 * quarter * quarter, -0.5 * sin),
            angle.chained(sin, 0.5 * cos),
        ];
        BodyPosition {
            moved_m: [variable(0), variable(1)],
            half_turn,
        }
    }

    fn norm(&self, forces: &[f64]) -> f64 {
        forces.iter().map(|force| force * force).sum::<f64>().sqrt() / self.weight_n
    }

    /// Computes the displacements with joints of unlimited tensile strength, in one linear step.
    fn bonded_displacements(&self) -> Option<Vec<[f64; 3]>> {
        let bodies = self.structure.bodies.len();
        let moved = vec![[0.0; 3]; bodies];
        let mut matrix = Banded::new(3 * bodies, self.width);
        let mut forces = vec![0.0; 3 * bodies];
        self.compute_unbalanced_forces(&moved, true, Some(&mut matrix), &mut forces);
        let found = matrix.solve([&mut forces]);
        found.then(|| self.stepped(&moved, &forces, 1.0))
    }

    fn stepped(&self, moved: &[[f64; 3]], step: &[f64], part: f64) -> Vec<[f64; 3]> {
        let units = [1.0, 1.0, self.length_m];
        let by = moved.iter().zip(step.chunks_exact(3));
        by.map(|(moved, step)| [0, 1, 2].map(|axis| moved[axis] + part * step[axis] / units[axis]))
            .collect()
    }

    /// Runs Newton's method from given displacements; `None` if it does not converge.
    fn solve_from(&self, mut moved: Vec<[f64; 3]>, steps_before: usize) -> Option<Equilibrium> {
        let size = 3 * moved.len();
        let mut matrix = Banded::new(size, self.width);
        let (mut forces, mut trial) = (vec![0.0; size], vec![0.0; size]);
        self.compute_unbalanced_forces(&moved, false, None, &mut forces);
        let mut norm = self.norm(&forces);
        let mut steps = 0;
        while norm > ROUNDING && steps < MOST_STEPS {
            steps += 1;
            matrix.clear();
            self.compute_unbalanced_forces(&moved, false, Some(&mut matrix), &mut forces);
            if !matrix.solve([&mut forces]) {
                break;
            }
            let mut parts = (0..12).map(|halvings| 0.5_f64.powi(halvings));
            let shortened = parts.find_map(|part| {
                let there = self.stepped(&moved, &forces, part);
                self.compute_unbalanced_forces(&there, false, None, &mut trial);
                let other = self.norm(&trial);
                (other < norm * (1.0 - 1e-4 * part)).then_some((there, other))
            });
            let Some(better) = shortened else { break };
            (moved, norm) = better;
        }
        (norm < BALANCED).then(|| self.equilibrium_at(moved, norm, steps_before + steps))
    }

    /// Displacement of the centre of gravity to the right.
    fn sway_m(&self, moved: &[[f64; 3]]) -> f64 {
        let bodies = self.structure.bodies.iter().zip(moved);
        let moments: f64 = bodies.map(|(body, moved)| body.mass_kg * moved[0]).sum();
        moments / self.structure.mass_kg()
    }

    /// Finds the equilibrium with the centre of gravity `stride_m` farther to the right, from an extrapolation of the last two. Returns also the
    /// number of Newton steps; `None` if it does not converge.
    fn find_pushed(
        &self,
        before: Option<&PushedEquilibrium>,
        here: &PushedEquilibrium,
        stride_m: f64,
    ) -> Option<(PushedEquilibrium, usize)> {
        let bodies = &self.structure.bodies;
        let size = 3 * bodies.len();
        let sway_m = here.sway_m + stride_m;
        let (mut moved, mut push_m_s2) = (here.moved.clone(), here.push_m_s2);
        if let Some(before) = before {
            let part = stride_m / (here.sway_m - before.sway_m);
            moved = extrapolated(&moved, &before.moved, part);
            push_m_s2 += part * (push_m_s2 - before.push_m_s2);
        }
        let mut matrix = Banded::new(size, self.width);
        let (mut forces, mut by_push) = (vec![0.0; size], vec![0.0; size]);
        let none = vec![[0.0; 3]; bodies.len()];
        let missing_m = |moved: &[[f64; 3]]| sway_m - self.sway_m(moved);
        let (mut norm, mut missing) = (f64::INFINITY, missing_m(&moved));
        for steps in 0..MOST_STEPS {
            matrix.clear();
            self.compute_unbalanced_forces(&moved, false, Some(&mut matrix), &mut forces);
            self.push(push_m_s2, &mut forces);
            if steps == 0 {
                norm = self.norm(&forces);
            }
            if norm < BALANCED_ON_WAY && missing.abs() < 1e-6 * stride_m.abs() {
                let there = PushedEquilibrium {
                    moved,
                    push_m_s2,
                    sway_m,
                };
                return Some((there, steps));
            }
            by_push.fill(0.0);
            self.push(1.0, &mut by_push);
            if !matrix.solve([&mut forces, &mut by_push]) {
                return None;
            }
            let [free_m, pushed_m] =
                [&forces, &by_push].map(|step| self.sway_m(&self.stepped(&none, step, 1.0)));
            let more_m_s2 = (missing - free_m) / pushed_m;
            for (step, by_push) in forces.iter_mut().zip(&by_push) {
                *step += more_m_s2 * by_push;
            }
            let step = forces.clone();
            let mut parts = (0..8).map(|halvings| 0.5_f64.powi(halvings));
            let better = parts.find_map(|part| {
                let there = self.stepped(&moved, &step, part);
                let push_m_s2 = push_m_s2 + part * more_m_s2;
                self.compute_unbalanced_forces(&there, false, None, &mut forces);
                self.push(push_m_s2, &mut forces);
                let other = self.norm(&forces);
                let closer = other < norm || other < BALANCED_ON_WAY;
                closer.then(|| (missing_m(&there), other, there, push_m_s2))
            });
            (missing, norm, moved, push_m_s2) = better?;
        }
        None
    }

    /// Adds a push to the right per unit mass to the forces.
    fn push(&self, push_m_s2: f64, forces: &mut [f64]) {
        for (index, body) in self.structure.bodies.iter().enumerate() {
            forces[3 * index] += body.mass_kg * push_m_s2;
        }
    }

    /// Elastic and potential energy, in J.
    fn energy_j(&self, rest: &Equilibrium) -> f64 {
        let bodies = self.structure.bodies.iter().zip(&rest.moved);
        let lifted = bodies.map(|(body, moved)| -self.load_m_s2[1] * body.mass_kg * moved[1]);
        let each = self.structure.fibres();
        let joints = self.structure.joints.iter().zip(&rest.memories).enumerate();
        let elastic = joints.map(|(index, (joint, memory))| {
            let fibres = &rest.fibres[index * each..(index + 1) * each];
            self.structure.energy_j(joint, memory, fibres).0[0]
        });
        lifted.sum::<f64>() + elastic.sum::<f64>()
    }

    fn equilibrium_at(&self, moved: Vec<[f64; 3]>, unbalanced: f64, steps: usize) -> Equilibrium {
        let joints = &self.structure.joints;
        let each = self.structure.fibres();
        let mut memories = vec![Memory::none(); joints.len()];
        let mut fibres = vec![Fibre::none(); joints.len() * each];
        let place = |body: usize| self.body_position(&moved, body);
        let ties = self
            .structure
            .ties
            .iter()
            .zip(&self.yielded_m)
            .map(|(bound, yielded_m)| {
                let [first, second] = bound.bodies.map(place);
                let stretch_m = bound.span([&first, &second]).stretch_m;
                TieMemory::stretched(&bound.tie, *yielded_m, stretch_m)
            })
            .collect();
        for (index, joint) in joints.iter().enumerate() {
            let [one, other] = joint.geometry.bodies.map(place);
            let fibres = &mut fibres[index * each..(index + 1) * each];
            let memory = &mut memories[index];
            (self.structure).act(joint, [&one, &other], None, memory, fibres);
        }
        Equilibrium {
            self_weight_displacements: moved.clone(),
            moved,
            memories,
            fibres,
            ties,
            unbalanced,
            steps,
        }
    }
}

/// Extrapolates displacements linearly, by `times` the last step.
fn extrapolated(here: &[[f64; 3]], before: &[[f64; 3]], times: f64) -> Vec<[f64; 3]> {
    let ahead = |here: f64, before: f64| here + times * (here - before);
    let pairs = here.iter().zip(before);
    pairs
        .map(|(here, before)| [0, 1, 2].map(|axis| ahead(here[axis], before[axis])))
        .collect()
}

/// Maximum number of positions along a joint.
const MOST_FIBRES: usize = 100;
