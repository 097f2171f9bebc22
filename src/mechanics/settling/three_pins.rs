//! A row that stands on three hinges: two rigid bodies between three pins, in closed form.

use nalgebra::{Matrix2, Vector2};

use super::Condition;
use crate::mechanics::blocks::Row;
use crate::mechanics::geometry::field::{Momentum, turned};
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::joints::Placement;

/// Joints with less than this part of the weight on them are not pressed.
const LOADED: f64 = 1e-6;

const EDGES: [Edge; 2] = [Edge::Intrados, Edge::Extrados];

/// A joint that turns about one of its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hinge {
    /// Which joint, from 0 on the left support.
    pub joint: usize,
    /// About which corner.
    pub edge: Edge,
}

/// Three hinges, from left to right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreePins {
    hinges: [Hinge; 3],
    /// Corners of the hinges in the undeformed row, in metres.
    pins_m: [Vector2<f64>; 3],
}

/// A row on three hinges: positions and forces.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    hinges: [Hinge; 3],
    /// Of the part right of each hinge against the part left of it, anticlockwise.
    pub turns_rad: [f64; 3],
    /// By how much each hinge is open, in radians; below zero it would have to penetrate.
    pub openings_rad: [f64; 3],
    /// Rotations of the blocks.
    pub rotations_rad: Vec<f64>,
    /// Normal force at intrados and extrados of every joint over the weight of the row; of a hinge, all at its corner.
    pub corners: Vec<[f64; 2]>,
    /// Force of the right support on the row over its weight, with its moment about the origin (in metres).
    pub right_reaction: Momentum,
    /// Friction coefficient without which a joint would slide.
    pub friction: f64,
}

impl State {
    /// The three hinges.
    #[must_use]
    pub const fn hinges(&self) -> &[Hinge; 3] {
        &self.hinges
    }

    /// How far it is from giving way: the least of all openings in radians and of all forces that could pull, over the weight.
    #[must_use]
    pub fn margin(&self) -> f64 {
        let forces = self.pressing().map(|(_, force)| force);
        let openings = self.openings_rad.iter().copied();
        // What is no number is no margin.
        let least = |least: f64, next: f64| if least <= next { least } else { next };
        openings.chain(forces).fold(f64::INFINITY, least)
    }

    /// Where it has less than this margin: the corner at which the thrust line leaves a joint, or a hinge that shuts.
    #[must_use]
    pub fn beyond(&self, margin: f64) -> Vec<Hinge> {
        let pull = self.pressing().filter(|(_, force)| *force < margin);
        // Where one corner would pull the thrust line is at the other.
        let pull = pull.map(|(hinge, _)| Hinge {
            edge: hinge.edge.opposite(),
            ..hinge
        });
        let openings = self.hinges.iter().zip(self.openings_rad);
        let shut = openings.filter(|(_, opening)| *opening < margin);
        pull.chain(shut.map(|(hinge, _)| *hinge)).collect()
    }

    /// All forces that must press.
    fn pressing(&self) -> impl Iterator<Item = (Hinge, f64)> + '_ {
        let corners = self.corners.iter().enumerate();
        corners.flat_map(|(joint, forces)| {
            let hinge = self.hinges.iter().find(|hinge| hinge.joint == joint);
            EDGES
                .into_iter()
                .zip(*forces)
                .filter_map(move |(edge, force)| {
                    let there = hinge.is_none_or(|hinge| hinge.edge == edge);
                    there.then_some((Hinge { joint, edge }, force))
                })
        })
    }
}

impl ThreePins {
    /// These hinges of a row.
    #[must_use]
    pub fn new(row: &Row, hinges: [Hinge; 3]) -> Self {
        Self {
            hinges,
            pins_m: hinges.map(|hinge| row.joints()[hinge.joint].corner_m(hinge.edge)),
        }
    }

    /// The open joints of a placement; `None` where they are not three, or one has parted.
    #[must_use]
    pub fn of(row: &Row, placement: &Placement) -> Option<Self> {
        let open = placement.gaps_m().iter().enumerate();
        let mut hinges = Vec::with_capacity(3);
        for (joint, gaps) in open.filter(|(_, gaps)| **gaps != [0.0; 2]) {
            let edge = match gaps {
                [0.0, _] => Edge::Intrados,
                [_, 0.0] => Edge::Extrados,
                _ => return None,
            };
            hinges.push(Hinge { joint, edge });
        }
        let hinges: [Hinge; 3] = hinges.try_into().ok()?;
        Some(Self::new(row, hinges))
    }

    /// The hinges.
    #[must_use]
    pub const fn hinges(&self) -> &[Hinge; 3] {
        &self.hinges
    }

    /// Where the two bodies between the pins are; `None` where the outer pins are too far apart.
    fn bodies(&self, supports: &[Pose; 2]) -> Option<[Pose; 2]> {
        let [left, middle, right] = self.pins_m;
        let ends = [supports[0].of(left), supports[1].of(right)];
        let (first, second) = (middle - left, right - middle);
        let apart = ends[1] - ends[0];
        let distance = apart.norm();
        // The middle pin by its components along the line between the outer ones, and across it on the side on which it was built.
        let squares = [distance, first.norm(), second.norm()].map(|length| length * length);
        let along = (squares[0] + squares[1] - squares[2]) / (2.0 * distance);
        let height_squared = squares[1] - along * along;
        if !(height_squared > 0.0 && distance > 0.0) {
            return None;
        }
        let side = (right - left).perp(&first).signum();
        let axis = apart / distance;
        let pin = ends[0] + axis * along + turned(axis) * (side * height_squared.sqrt());
        let body = |from: Vector2<f64>, to: Vector2<f64>, end: Vector2<f64>, arm: Vector2<f64>| {
            let now = to - from;
            Pose::about(end, from, arm.perp(&now).atan2(arm.dot(&now)))
        };
        Some([
            body(ends[0], pin, left, first),
            body(pin, ends[1], middle, second),
        ])
    }

    /// Positions and forces of a row on these hinges; `None` where they cannot meet, or carry no force.
    #[must_use]
    pub fn state(&self, row: &Row, condition: &Condition) -> Option<State> {
        let bodies = self.bodies(&condition.supports)?;
        let poses = [
            condition.supports[0],
            bodies[0],
            bodies[1],
            condition.supports[1],
        ];
        let joints = self.hinges.map(|hinge| hinge.joint);
        let body_of = |block: usize| joints.iter().filter(|joint| **joint <= block).count();
        let turns_rad = [0, 1, 2].map(|i| poses[i + 1].rotation_rad() - poses[i].rotation_rad());
        let mut openings_rad = turns_rad;
        for (opening, hinge) in openings_rad.iter_mut().zip(&self.hinges) {
            let inside = hinge.edge == Edge::Intrados;
            *opening *= row.handedness() * if inside { 1.0 } else { -1.0 };
        }
        // Sums of the loads on the blocks before every joint, over the weight.
        let weight = 1.0 / row.mass_kg();
        let mut loads = vec![Momentum::ZERO];
        for (block, body) in row.blocks().iter().enumerate() {
            let centre = poses[body_of(block)].of(body.centre_m);
            let load = Momentum::applied_at(centre, condition.force_g * (body.mass_kg * weight));
            loads.push(loads[block] + load);
        }
        let pins = [0, 1, 2].map(|i| poses[i + 1].of(self.pins_m[i]));
        let between = |first: usize, last: usize| loads[joints[last]] - loads[joints[first]];
        // The force at the first pin has no moment with the loads about the other two.
        let arms = [pins[0] - pins[1], pins[0] - pins[2]];
        let equations = Matrix2::new(-arms[0].y, arms[0].x, -arms[1].y, arms[1].x);
        let moments = Vector2::new(-between(0, 1).about(pins[1]), -between(0, 2).about(pins[2]));
        let first = equations.lu().solve(&moments)?;
        let start = Momentum::applied_at(pins[0], first) - loads[joints[0]];
        let mut friction = 0.0_f64;
        let mut corners = Vec::with_capacity(row.joints().len());
        for (index, joint) in row.joints().iter().enumerate() {
            let force = start + loads[index];
            // Either face of a shut joint, and the corner of a hinge, are where the block after it is.
            let pose = poses[body_of(index)];
            let hinge = self.hinges.iter().position(|hinge| hinge.joint == index);
            let along = match hinge {
                // At the mean angle of its faces.
                Some(pin) => {
                    let half = Pose::new(-0.5 * turns_rad[pin], Vector2::zeros());
                    half.turned(pose.turned(joint.along()))
                }
                None => pose.turned(joint.along()),
            };
            let normal = turned(along) * row.handedness();
            let pressed = force.linear.dot(&normal);
            if pressed > LOADED {
                friction = friction.max((force.linear.dot(&along) / pressed).abs());
            }
            corners.push(match hinge.map(|pin| self.hinges[pin].edge) {
                Some(Edge::Intrados) => [pressed, 0.0],
                Some(Edge::Extrados) => [0.0, pressed],
                None => {
                    let about = force.about(pose.of(joint.intrados_m));
                    let outer = row.handedness() * about / joint.thickness_m();
                    [pressed - outer, outer]
                }
            });
        }
        let blocks = row.blocks().len();
        Some(State {
            hinges: self.hinges,
            turns_rad,
            openings_rad,
            rotations_rad: (0..blocks)
                .map(|block| poses[body_of(block)].rotation_rad())
                .collect(),
            corners,
            right_reaction: (start + loads[blocks]) * -1.0,
            friction,
        })
    }
}
