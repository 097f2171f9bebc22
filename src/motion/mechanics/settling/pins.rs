//! A row in equilibrium on hinges: two rigid bodies between three pins, in closed form, or more bodies held by ties.
//!
//! With more than three hinges the equilibrium is a minimum of the potential energy of weight and ties, subject to the condition that the pins meet.
//! Newton's method solves for the rotations of the bodies and the force in the last pin.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::Condition;
use crate::mechanics::chain::LEAST_LOAD;
use crate::mechanics::geometry::field::quarter_turn;
use crate::mechanics::row_state::lines;
use crate::mechanics::tie::sum_pulls;
use crate::mechanics::{
    Anchor, Edge, Lanes, Momentum, Placement, Pose, Row, RowState, Supports, Tie, TieLine,
    TieMemory,
};

/// Maximum number of Newton steps.
const MOST_STEPS: usize = 16;
/// Tolerance: relative to the weight for forces, relative to the size of the row for gaps.
const BALANCED: f64 = 1e-12;
/// Newton steps below this value, in radians and relative to the weight, end the iteration.
const SMALL_STEP: f64 = 1e-8;
/// Largest rotation of a body from its start, in radians, in the search for an equilibrium.
const FAR_RAD: f64 = 1.0;
/// Stiffness of pins over stiffness of bodies, in the test of stability of an equilibrium.
const STIFFER: f64 = 1e6;

/// Signs of the two ends of a tie: a tie lengthens as its first end moves backwards, and as its second end moves forwards.
const ENDS: [f64; 2] = [-1.0, 1.0];

/// Hinge: a joint that turns about one of its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pin {
    /// Index of the joint, from 0 on the left support.
    pub joint: usize,
    /// Edge at which the joint stays closed.
    pub edge: Edge,
}

/// Hinges, from left to right: three or more.
#[derive(Clone, Debug, PartialEq)]
pub struct Pins {
    /// Joint and edge of every hinge.
    pub hinges: Vec<Pin>,
    /// Corners of the hinges in the undeformed row, in metres.
    pub(super) pins_m: Vec<Vector2<f64>>,
}

/// States of the ties, and their forces in N with the lines of action.
pub(super) type TieLoads = (Vec<TieMemory<Lanes<1>>>, Vec<(TieLine, f64)>);

/// Positions and forces of a row on hinges.
#[derive(Clone, Debug, PartialEq)]
pub struct HingeState {
    /// Joint and edge of every hinge.
    pub hinges: Vec<Pin>,
    /// Rotation of the part after each hinge relative to the part before it, anticlockwise.
    pub hinge_rotations_rad: Vec<f64>,
    /// Opening of each hinge, in radians; negative if the blocks would overlap.
    pub openings_rad: Vec<f64>,
    /// Rotations of the blocks.
    pub rotations_rad: Vec<f64>,
    /// Normal forces at intrados and extrados of every joint, over the weight of the row. A hinge has its whole force at its corner.
    pub corners: Vec<[f64; 2]>,
    /// Force of the right support on the row over the weight, and its moment about the origin in metres.
    pub right_reaction: Momentum,
    /// Friction coefficient required to prevent sliding at every joint.
    pub friction: f64,
    /// States of the ties.
    pub ties: Vec<TieMemory<Lanes<1>>>,
}

impl HingeState {
    /// Safety margin of the hinges: the least of all openings in radians and of all normal forces over the weight. A state is admissible
    /// if the margin is not negative.
    pub fn margin(&self) -> f64 {
        let forces = self.compressive_forces().map(|(_, force)| force);
        let openings = self.openings_rad.iter().copied();
        // NaN stays, so that a margin with NaN is never admissible.
        let lower = |least: f64, next: f64| match next < least || next.is_nan() {
            true => next,
            false => least,
        };
        openings.chain(forces).fold(f64::INFINITY, lower)
    }

    /// Whether the state is admissible within a tolerance.
    pub(super) fn is_admissible(&self, slack: f64) -> bool {
        self.margin() >= -slack
    }

    /// Joints with less than this margin: those where the thrust line leaves the joint, with the edge there, and hinges that close.
    pub(crate) fn pins_below_margin(&self, margin: f64) -> Vec<Pin> {
        let pull = self
            .compressive_forces()
            .filter(|(_, force)| *force < margin);
        // If one corner would pull, the thrust line is beyond the opposite one.
        let pull = pull.map(|(hinge, _)| Pin {
            edge: hinge.edge.opposite(),
            ..hinge
        });
        let openings = self.hinges.iter().zip(&self.openings_rad);
        let shut = openings.filter(|(_, opening)| **opening < margin);
        pull.chain(shut.map(|(hinge, _)| *hinge)).collect()
    }

    /// All normal forces that must be compressive, with their corners.
    fn compressive_forces(&self) -> impl Iterator<Item = (Pin, f64)> + '_ {
        let corners = self.corners.iter().enumerate();
        corners.flat_map(|(joint, forces)| {
            let hinge = self.hinges.iter().find(|hinge| hinge.joint == joint);
            let edges = Edge::ALL.iter().zip(*forces);
            edges.filter_map(move |(&edge, force)| {
                let there = hinge.is_none_or(|hinge| hinge.edge == edge);
                there.then_some((Pin { joint, edge }, force))
            })
        })
    }
}

impl Pins {
    /// Hinges of a row, given from left to right; three or more between two supports.
    pub fn new(row: &Row, hinges: Vec<Pin>) -> Self {
        let pin_m = |hinge: &Pin| row.joints[hinge.joint].corner_m(hinge.edge);
        Self {
            pins_m: hinges.iter().map(pin_m).collect(),
            hinges,
        }
    }

    /// Open joints of a placement as hinges; `None` if these are fewer than three, or if a joint is open at both edges.
    pub fn of(row: &Row, placement: &Placement) -> Option<Self> {
        let open = placement.gaps_m.iter().enumerate();
        let mut hinges = Vec::with_capacity(3);
        for (joint, gaps) in open.filter(|(_, gaps)| **gaps != [0.0; 2]) {
            let edge = Edge::only(gaps.map(|gap| gap == 0.0))?;
            hinges.push(Pin { joint, edge });
        }
        (hinges.len() >= 3).then(|| Self::new(row, hinges))
    }

    /// These hinges exchanged with others: hinges present in both sets leave, new ones are added. `None` if fewer than three remain, or if a
    /// joint would be open at both edges.
    pub(super) fn exchanged(&self, row: &Row, others: &[Pin]) -> Option<Self> {
        let stay = self.hinges.iter().filter(|hinge| !others.contains(hinge));
        let new = others.iter().filter(|hinge| !self.hinges.contains(hinge));
        let mut hinges: Vec<Pin> = stay.chain(new).copied().collect();
        hinges.sort_by_key(|hinge| hinge.joint);
        let apart = hinges.windows(2).all(|pair| pair[0].joint < pair[1].joint);
        (hinges.len() >= 3 && apart).then(|| Self::new(row, hinges))
    }

    /// Poses of the bodies between the pins, for a row that comes from the state `before`; `None` if the pins cannot meet, or no stable
    /// equilibrium is found.
    fn bodies(&self, row: &Row, condition: &Condition, before: &RowState) -> Option<Vec<Pose>> {
        match self.pins_m[..] {
            // A snap may have moved the middle pin to the other side of the line between the outer pins.
            [left, middle, right] => {
                let side = side(&self.pins_in(before));
                two_bodies([left, middle, right], &condition.supports, side)
            }
            _ => Chain::new(self, row, condition, before).find_equilibrium(),
        }
    }

    /// Positions of the pins in a given state of the row, in metres.
    fn pins_in(&self, stance: &RowState) -> Vec<Vector2<f64>> {
        let placement = &stance.placement;
        let last = &placement.support_poses[1];
        let pins = self.hinges.iter().zip(&self.pins_m);
        pins.map(|(hinge, pin_m)| {
            placement
                .poses
                .get(hinge.joint)
                .unwrap_or(last)
                .current_position(*pin_m)
        })
        .collect()
    }

    /// Positions and forces of a row on these hinges that comes from the state `before`. `None` if the pins cannot meet, the equilibrium
    /// equations are singular, or no stable equilibrium is found.
    pub fn state(&self, row: &Row, condition: &Condition, before: &RowState) -> Option<HingeState> {
        let mut poses = vec![condition.supports[0]];
        poses.extend(self.bodies(row, condition, before)?);
        poses.push(condition.supports[1]);
        self.state_at(row, condition, &poses, &before.ties)
    }

    /// Positions of the pins, in metres, for given poses of the parts before, between and after the pins.
    pub(super) fn positions_m(&self, poses: &[Pose]) -> Vec<Vector2<f64>> {
        let pins = self.pins_m.iter().zip(&poses[1..]);
        pins.map(|(pin_m, pose)| pose.current_position(*pin_m))
            .collect()
    }

    /// Number of hinges before each block.
    fn parts(&self, row: &Row) -> impl Iterator<Item = usize> {
        (0..row.blocks.len()).map(|block| self.part_of(block))
    }

    /// Number of hinges before a block.
    pub(super) fn part_of(&self, block: usize) -> usize {
        let before = self.hinges.iter().filter(|hinge| hinge.joint <= block);
        before.count()
    }

    /// Forces of a row for given poses of the parts before, between and after the hinges. `before` are the states of the ties in the step
    /// before. `None` if the equilibrium equations are singular.
    pub(super) fn state_at(
        &self,
        row: &Row,
        condition: &Condition,
        poses: &[Pose],
        before: &[TieMemory<Lanes<1>>],
    ) -> Option<HingeState> {
        let joints: Vec<usize> = self.hinges.iter().map(|hinge| hinge.joint).collect();
        let turn = |pair: &[Pose]| pair[1].rotation_rad() - pair[0].rotation_rad();
        let hinge_rotations_rad: Vec<f64> = poses.windows(2).map(turn).collect();
        let mut openings_rad = hinge_rotations_rad.clone();
        for (opening, hinge) in openings_rad.iter_mut().zip(&self.hinges) {
            let inside = hinge.edge == Edge::Intrados;
            *opening *= row.handedness * if inside { 1.0 } else { -1.0 };
        }
        let (ties, pulls) = self.pulls(row, &condition.supports, poses, before);
        let loads = self.loads(row, poses, condition.force_g, &pulls);
        let blocks = row.blocks.len();
        let start = match row.supports {
            // The end of a stack is free.
            Supports::Left => loads[blocks] * -1.0,
            Supports::Both => {
                let pins_m = self.positions_m(poses);
                let between = |last: usize| loads[joints[last]] - loads[joints[0]];
                // Moment equilibrium of the loads about two other pins gives the force at the first pin.
                let others = [joints.len() / 2, joints.len() - 1];
                let arms = others.map(|other| pins_m[0] - pins_m[other]);
                let equations = Matrix2::new(-arms[0].y, arms[0].x, -arms[1].y, arms[1].x);
                let moments = others.map(|other| -between(other).moment_about(pins_m[other]));
                let first = equations.lu().solve(&Vector2::from(moments))?;
                Momentum::applied_at(pins_m[0], first) - loads[joints[0]]
            }
        };
        let mut friction = 0.0_f64;
        let mut corners = Vec::with_capacity(row.joints.len());
        for (index, joint) in row.joints.iter().enumerate() {
            let force = start + loads[index];
            // The faces of a closed joint, and the corner of a hinge, move with the block after the joint.
            let pose = poses[self.part_of(index)];
            let hinge = self.hinges.iter().position(|hinge| hinge.joint == index);
            let mut tangent = pose.current_direction(joint.direction());
            if let Some(index) = hinge {
                // Direction of the joint: mean of the directions of its two faces.
                tangent = Pose::new(-0.5 * hinge_rotations_rad[index], Vector2::zeros())
                    .current_direction(tangent);
            }
            let normal = quarter_turn(tangent) * row.handedness;
            let pressed = force.linear.dot(&normal);
            if pressed >= LEAST_LOAD {
                friction = friction.max((force.linear.dot(&tangent) / pressed).abs());
            }
            corners.push(match hinge.map(|index| self.hinges[index].edge) {
                Some(Edge::Intrados) => [pressed, 0.0],
                Some(Edge::Extrados) => [0.0, pressed],
                None => {
                    let about = force.moment_about(pose.current_position(joint.intrados_m));
                    let outer = row.handedness * about / joint.thickness_m();
                    [pressed - outer, outer]
                }
            });
        }
        let rotations = (self.parts(row)).map(|part| poses[part].rotation_rad());
        Some(HingeState {
            hinges: self.hinges.clone(),
            hinge_rotations_rad,
            openings_rad,
            rotations_rad: rotations.collect(),
            corners,
            right_reaction: (start + loads[blocks]) * -1.0,
            friction,
            ties,
        })
    }

    /// States, forces and lines of the ties for given poses of the parts.
    pub(super) fn pulls(
        &self,
        row: &Row,
        supports: &[Pose; 2],
        poses: &[Pose],
        before: &[TieMemory<Lanes<1>>],
    ) -> TieLoads {
        let parts: Vec<usize> = self.parts(row).collect();
        let lines = lines(row, supports, |block| poses[parts[block]]);
        let ties = row
            .ties
            .iter()
            .zip(lines)
            .zip(before)
            .map(|((tie, line), memory)| {
                let memory = memory.then(tie, line.stretch_m);
                (memory, (line, memory.force_n.0[0]))
            });
        ties.unzip()
    }

    /// Sums of the loads on all blocks before each joint, then on all blocks, over the weight. Loads are a force on a unit of mass, in
    /// multiples of gravity, and tie forces in N.
    pub(super) fn loads(
        &self,
        row: &Row,
        poses: &[Pose],
        force_g: Vector2<f64>,
        pulls: &[(TieLine, f64)],
    ) -> Vec<Momentum> {
        let weight = 1.0 / row.mass_kg();
        let own = row.blocks.iter().enumerate().map(|(block, body)| {
            let centre = poses[self.part_of(block)].current_position(body.centre_m);
            Momentum::applied_at(centre, force_g * (body.mass_kg * weight))
        });
        let per_weight = weight / row.gravity_m_s2;
        let pulls = pulls
            .iter()
            .map(|(line, force_n)| (line, force_n * per_weight));
        let pulls = sum_pulls(row.blocks.len(), pulls);
        let mut loads = vec![Momentum::ZERO];
        loads.extend(own.zip(pulls).scan(Momentum::ZERO, |sum, (own, pull)| {
            *sum = *sum + (own + pull);
            Some(*sum)
        }));
        loads
    }
}

/// 1 if the middle one of three pins is left of the line from the first to the last, -1 if it is right.
pub(super) fn side(pins_m: &[Vector2<f64>]) -> f64 {
    let [left, middle, right] = [0, 1, 2].map(|pin| pins_m[pin]);
    (right - left).perp(&(middle - left)).signum()
}

/// Poses of two bodies between three pins, with the middle pin on the given side of the outer pins. `None` if the outer pins are too far
/// apart.
pub(super) fn two_bodies(
    [left, middle, right]: [Vector2<f64>; 3],
    supports: &[Pose; 2],
    side: f64,
) -> Option<Vec<Pose>> {
    let ends = [
        supports[0].current_position(left),
        supports[1].current_position(right),
    ];
    let (first, second) = (middle - left, right - middle);
    let apart = ends[1] - ends[0];
    let distance = apart.norm();
    // Components of the middle pin along and across the line between the outer pins.
    let squares = [distance, first.norm(), second.norm()].map(|length| length * length);
    let along = (squares[0] + squares[1] - squares[2]) / (2.0 * distance);
    let height_squared = squares[1] - along * along;
    if !(height_squared > 0.0 && distance > 0.0) {
        return None;
    }
    let axis = apart / distance;
    let pin = ends[0] + axis * along + quarter_turn(axis) * (side * height_squared.sqrt());
    let body = |from: Vector2<f64>, to: Vector2<f64>, end: Vector2<f64>, arm: Vector2<f64>| {
        let now = to - from;
        Pose::about(end, from, libm::atan2(arm.perp(&now), arm.dot(&now)))
    };
    Some(vec![
        body(ends[0], pin, left, first),
        body(pin, ends[1], middle, second),
    ])
}

/// Bodies between more than three pins, in equilibrium with the ties that hold them. Forces are relative to the weight.
struct Chain<'a> {
    pins: &'a Pins,
    row: &'a Row,
    condition: &'a Condition,
    /// Vector from the first to the last pin of every body, in metres.
    arms_m: Vec<Vector2<f64>>,
    /// First moment of mass of every body about its first pin, with the mass of all later bodies at its last pin, over the mass of the row, in
    /// metres.
    moments_m: Vec<Vector2<f64>>,
    bars: Vec<Bar>,
    rotations_rad: Vec<f64>,
}

/// Unbroken tie of a chain. Forces are relative to the weight.
struct Bar {
    /// Number of hinges before each end.
    parts: [usize; 2],
    /// Ends in the undeformed row, the vector between them, and its length.
    ends_m: [Vector2<f64>; 2],
    apart_m: Vector2<f64>,
    length_m: f64,
    /// Elastic stretch in the undeformed row: the initial stretch minus the plastic stretch.
    stretch_m: f64,
    /// Stretch at which the tie breaks, minus the plastic stretch.
    breaks_m: f64,
    stiffness_m: f64,
    most: f64,
}

impl Bar {
    fn new(tie: &Tie, parts: [usize; 2], yielded_m: f64, weight_n: f64) -> Self {
        let ends_m = tie.ends.map(|anchor| anchor.at_m);
        let (length_m, prestress_m) = (tie.length_m(), tie.prestress_n / tie.stiffness_n_m);
        Self {
            parts,
            ends_m,
            apart_m: ends_m[1] - ends_m[0],
            length_m,
            stretch_m: prestress_m - yielded_m,
            breaks_m: tie.breaks_at_strain * (length_m - prestress_m) - yielded_m,
            stiffness_m: tie.stiffness_n_m / weight_n,
            most: tie.yield_force_n / weight_n,
        }
    }
}

/// Gradient and Hessian of the energy of all ties between two bodies. The coordinates of a body are the position of its first pin and its rotation.
/// Signs are as if a tie pulled both bodies in the same direction.
#[derive(Default)]
struct PairDerivatives {
    force: Vector2<f64>,
    moments: Vector2<f64>,
    direction: Vector2<f64>,
    places: Matrix2<f64>,
    /// Second derivatives by positions (rows) and rotations (columns).
    mixed: Matrix2<f64>,
    rotations: Matrix2<f64>,
}

impl PairDerivatives {
    /// Sums the ties between two bodies at these poses; `pins_m` are the first pins of the bodies.
    fn new(bars: &[Bar], poses: [&Pose; 2], pins_m: [Vector2<f64>; 2]) -> Self {
        let mut all = Self::default();
        for bar in bars {
            let ends_m = [0, 1].map(|end| poses[end].current_position(bar.ends_m[end]));
            let by_m = (ends_m[1] - bar.ends_m[1]) - (ends_m[0] - bar.ends_m[0]);
            let now_m = bar.apart_m + by_m;
            let length_m = now_m.norm();
            // This form avoids cancellation for small changes, as in `Tie::span`.
            let lengthened_m = by_m.dot(&(by_m + bar.apart_m * 2.0)) / (length_m + bar.length_m);
            let stretch_m = lengthened_m + bar.stretch_m;
            if stretch_m <= 0.0 || stretch_m >= bar.breaks_m {
                continue;
            }
            let elastic = bar.stiffness_m * stretch_m;
            let (force, stiffness_m) = if elastic < bar.most {
                (elastic, bar.stiffness_m)
            } else {
                (bar.most, 0.0)
            };
            let per_length = 1.0 / length_m;
            let direction = now_m * per_length;
            let arms_m = [ends_m[0] - pins_m[0], ends_m[1] - pins_m[1]];
            let turns = Vector2::new(arms_m[0].perp(&direction), arms_m[1].perp(&direction));
            let across = Vector2::new(arms_m[0].dot(&direction), arms_m[1].dot(&direction));
            all.force += direction * force;
            all.moments += turns * force;
            all.direction += across * force;
            // Material stiffness along the tie, geometric stiffness across it.
            for (way, turns, stiffness_m) in [
                (direction, turns, stiffness_m),
                (quarter_turn(direction), across, force * per_length),
            ] {
                let (push, turning) = (way * stiffness_m, turns * stiffness_m);
                all.places += push * way.transpose();
                all.mixed += push * turns.transpose();
                all.rotations += turning * turns.transpose();
            }
        }
        all
    }
}

/// Residuals of the equilibrium equations of a chain, and their derivatives.
struct Residuals {
    /// Derivatives of the energy by the rotations.
    slopes: DVector<f64>,
    curvature: DMatrix<f64>,
    /// Gap between the last pin and its position on the support, and its derivatives.
    gap_m: Vector2<f64>,
    reach: DMatrix<f64>,
}

impl Residuals {
    /// Adds the force of the right support on the last pin.
    fn with_reaction(mut self, reaction: Vector2<f64>) -> Self {
        for (body, reach) in self.reach.column_iter().enumerate() {
            self.slopes[body] -= reach[0] * reaction.x + reach[1] * reaction.y;
            self.curvature[(body, body)] += reach[1] * reaction.x - reach[0] * reaction.y;
        }
        self
    }
}

impl<'a> Chain<'a> {
    fn new(pins: &'a Pins, row: &'a Row, condition: &'a Condition, before: &'a RowState) -> Self {
        let count = pins.hinges.len() - 1;
        let pairs = pins.pins_m.windows(2);
        let arms_m: Vec<_> = pairs.map(|pair| pair[1] - pair[0]).collect();
        let per_mass = 1.0 / row.mass_kg();
        let mut moments_m = vec![Vector2::zeros(); count];
        for (body, moment) in moments_m.iter_mut().enumerate() {
            let [first, after] = [body, body + 1].map(|pin| pins.hinges[pin].joint);
            let last = pins.hinges[count].joint;
            for (index, block) in row.blocks.iter().enumerate().take(last).skip(first) {
                let own_m = block.centre_m - pins.pins_m[body];
                let arm_m = if index < after { own_m } else { arms_m[body] };
                *moment += arm_m * (block.mass_kg * per_mass);
            }
        }
        let poses = &before.placement.poses;
        let bodies = pins.hinges.iter().take(count);
        let parts: Vec<usize> = pins.parts(row).collect();
        let part = |anchor: Anchor| match anchor.block {
            Some(block) => parts[block],
            None => anchor.support(row.feet_m()) * (count + 1),
        };
        let weight_n = row.mass_kg() * row.gravity_m_s2;
        let ties = row
            .ties
            .iter()
            .zip(&before.ties)
            .filter(|(_, memory)| !memory.is_broken());
        let bars = ties.map(|(tie, memory)| {
            let yielded_m = memory.yielded_m.0[0];
            Bar::new(tie, tie.ends.map(part), yielded_m, weight_n)
        });
        let rotations = bodies.map(|hinge| poses[hinge.joint].rotation_rad());
        Self {
            rotations_rad: rotations.collect(),
            bars: bars.collect(),
            pins,
            row,
            condition,
            arms_m,
            moments_m,
        }
    }

    /// Poses of the bodies.
    fn poses(&self) -> Vec<Pose> {
        let mut at = self.condition.supports[0].current_position(self.pins.pins_m[0]);
        let bodies = self.rotations_rad.iter().enumerate();
        let poses = bodies.map(|(body, rotation_rad)| {
            let pose = Pose::about(self.pins.pins_m[body], at, *rotation_rad);
            at = pose.current_position(self.pins.pins_m[body + 1]);
            pose
        });
        poses.collect()
    }

    /// Gradient and Hessian of the energy, without the force of the right support.
    fn residuals(&self) -> Residuals {
        let count = self.rotations_rad.len();
        let poses = self.poses();
        let mut slopes = DVector::zeros(count);
        let mut curvature = DMatrix::zeros(count, count);
        let mut reach = DMatrix::zeros(2, count);
        for (body, pose) in poses.iter().enumerate() {
            let [arm, moment] =
                [&self.arms_m, &self.moments_m].map(|of| pose.current_direction(of[body]));
            let force = self.condition.force_g;
            slopes[body] -= force.dot(&quarter_turn(moment));
            curvature[(body, body)] += force.dot(&moment);
            reach.set_column(body, &quarter_turn(arm));
        }
        self.add_ties(&poses, &mut slopes, &mut curvature);
        let last = self.pins.pins_m.len() - 1;
        let there = poses[count - 1].current_position(self.pins.pins_m[last]);
        Residuals {
            slopes,
            curvature,
            gap_m: there - self.condition.supports[1].current_position(self.pins.pins_m[last]),
            reach,
        }
    }

    /// Adds gradient and Hessian of the ties. Each tie acts on two bodies, described by positions of first pins and rotations. The chain rule then
    /// gives the derivatives by the rotations of all bodies.
    fn add_ties(&self, poses: &[Pose], slopes: &mut DVector<f64>, curvature: &mut DMatrix<f64>) {
        let count = poses.len();
        let supports = &self.condition.supports;
        let parts = [&supports[..1], poses, &supports[1..]].concat();
        let pins_m = self.pins.positions_m(&parts);
        let mut forces = DVector::zeros(3 * count);
        let mut stiffnesses = DMatrix::zeros(3 * count, 3 * count);
        let alike = self.bars.chunk_by(|one, next| one.parts == next.parts);
        for bars in alike {
            let tied = bars[0].parts;
            let body = tied.map(|part| part.checked_sub(1).filter(|body| *body < count));
            // Supports have no first pin and do not turn.
            let pins_m = body.map(|body| body.map_or(Vector2::zeros(), |body| pins_m[body]));
            let all = PairDerivatives::new(bars, tied.map(|part| &parts[part]), pins_m);
            for (one, first) in body.iter().enumerate() {
                let Some(first) = first else { continue };
                let on_body = Vector3::new(all.force.x, all.force.y, all.moments[one]);
                let mut forces = forces.fixed_rows_mut::<3>(3 * first);
                forces += on_body * ENDS[one];
                stiffnesses[(3 * first + 2, 3 * first + 2)] -= ENDS[one] * all.direction[one];
                for (other, second) in body.iter().enumerate() {
                    let Some(second) = second else { continue };
                    let mut between = all.places.to_homogeneous();
                    (between.fixed_view_mut::<2, 1>(0, 2)).copy_from(&all.mixed.column(other));
                    (between.fixed_view_mut::<1, 2>(2, 0)).tr_copy_from(&all.mixed.column(one));
                    between.m33 = all.rotations[(one, other)];
                    let mut stiffnesses = stiffnesses.fixed_view_mut::<3, 3>(3 * first, 3 * second);
                    stiffnesses += between * (ENDS[one] * ENDS[other]);
                }
            }
        }
        // The rotation of a body moves the pins of all bodies after it.
        let mut by_rotations = DMatrix::zeros(3 * count, count);
        for (body, pose) in poses.iter().enumerate() {
            let arm_m = pose.current_direction(self.arms_m[body]);
            by_rotations[(3 * body + 2, body)] = 1.0;
            for after in body + 1..count {
                let mut moves = by_rotations.fixed_view_mut::<2, 1>(3 * after, body);
                moves.copy_from(&quarter_turn(arm_m));
                curvature[(body, body)] -= forces.fixed_rows::<2>(3 * after).dot(&arm_m);
            }
        }
        *slopes += by_rotations.tr_mul(&forces);
        *curvature += by_rotations.tr_mul(&(stiffnesses * &by_rotations));
    }

    /// Finds the stable equilibrium by Newton's method and returns the poses of the bodies. `None` if a body turns by more than a radian, an
    /// equilibrium is unstable, or the iteration does not converge.
    fn find_equilibrium(mut self) -> Option<Vec<Pose>> {
        let count = self.rotations_rad.len();
        let size_m = self.row.size_m;
        // Start with the least-squares force of the support.
        let mut free = self.residuals();
        let squares = &free.reach * free.reach.transpose();
        let force = squares.lu().solve(&(&free.reach * &free.slopes))?;
        let mut reaction = Vector2::new(force[0], force[1]);
        let start_rad = self.rotations_rad.clone();
        for _ in 0..MOST_STEPS {
            let left = free.with_reaction(reaction);
            // Stability: the Hessian is positive definite in all directions in which the pins still meet.
            let pins = left.reach.transpose() * &left.reach;
            let held = STIFFER * left.curvature.amax() / pins.amax();
            (&left.curvature + pins * held).cholesky()?;
            let slopes = left.slopes.amax() / size_m;
            let rounding = BALANCED + 8.0 * f64::EPSILON * left.curvature.amax() / size_m;
            if slopes < rounding && left.gap_m.amax() < BALANCED * size_m {
                return Some(self.poses());
            }
            let mut matrix = left.curvature.resize(count + 2, count + 2, 0.0);
            (matrix.view_mut((count, 0), (2, count))).copy_from(&left.reach);
            (matrix.view_mut((0, count), (count, 2))).copy_from(&-left.reach.transpose());
            let residuals = left.slopes.iter().chain(&left.gap_m).map(|part| -part);
            let right = DVector::from_iterator(count + 2, residuals);
            let step = matrix.lu().solve(&right)?;
            for (rotation_rad, by) in self.rotations_rad.iter_mut().zip(step.iter()) {
                *rotation_rad += by;
            }
            reaction += Vector2::new(step[count], step[count + 1]);
            // Newton's method converges quadratically: the remaining error is of the order of the square of the step.
            if step.amax() < SMALL_STEP {
                return Some(self.poses());
            }
            let mut turns = start_rad.iter().zip(&self.rotations_rad);
            if turns.any(|(start, now)| (now - start).abs() > FAR_RAD) {
                return None;
            }
            free = self.residuals();
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::mechanics::geometry::ring::Ring;

    /// The Hessian of the energy equals central differences of its gradient: for a chain on five hinges, with ties between bodies and to the ground.
    #[test]
    fn the_hessian_is_the_derivative_of_the_gradient() {
        let ring = Ring::new(0.15, PI).unwrap();
        let row = Row::arch(&ring, 8, 1.0, 1.0, 1000.0).unwrap();
        let weight_n = row.mass_kg() * 9.81;
        let end = |block: usize| Anchor {
            block: Some(block),
            at_m: row.blocks[block].centre_m,
        };
        let foot = Anchor {
            block: None,
            at_m: Vector2::new(-0.4, 0.0),
        };
        let tie = |ends, parts: f64| Tie {
            ends,
            stiffness_n_m: 4.0 * parts * weight_n,
            prestress_n: parts * weight_n,
            yield_force_n: f64::INFINITY,
            breaks_at_strain: f64::INFINITY,
        };
        let ties = vec![
            tie([end(1), end(6)], 0.7),
            tie([end(2), end(5)], 0.9),
            tie([foot, end(3)], 0.5),
        ];
        let row = row.with_ties(ties, 9.81).unwrap();
        let hinges = Edge::ALL
            .iter()
            .copied()
            .cycle()
            .zip([0, 2, 4, 6, 8])
            .map(|(edge, joint)| Pin { joint, edge });
        let pins = Pins::new(&row, hinges.collect());
        let condition = Condition {
            supports: [Pose::UNDEFORMED; 2],
            force_g: Vector2::new(0.3, -1.0),
        };
        let before = RowState::undeformed(&row);
        let mut chain = Chain::new(&pins, &row, &condition, &before);
        chain.rotations_rad = vec![0.02, -0.03, 0.01, 0.04];
        let reaction = Vector2::new(-0.2, 0.5);
        let found = chain.residuals().with_reaction(reaction).curvature;
        let step = 1e-5;
        for body in 0..4 {
            let mut slopes_at = |by: f64| {
                let own = chain.rotations_rad[body];
                chain.rotations_rad[body] = own + by;
                let slopes = chain.residuals().with_reaction(reaction).slopes;
                chain.rotations_rad[body] = own;
                slopes
            };
            let due = (slopes_at(step) - slopes_at(-step)) / (2.0 * step);
            // Truncation error of the difference, and rounding error over the step.
            let off = (found.column(body) - due).amax();
            assert!(off < 1e-8 * found.amax(), "{body}: {off:e}");
        }
    }
}
