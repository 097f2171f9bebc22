//! Bodies between open joints, and the block-tridiagonal system of the impulses between them, factored from left to right. The part left of the first
//! changed corner is reused.

use std::ops::Range;

use nalgebra::{Matrix2, Vector2};

use super::lower;
use super::placed::Placed;
use crate::mechanics::{Corners, Edge, MassMoments, Placement, Row, Supports};

/// Run of blocks that move as one body, with its inverse inertia; zero for a body fixed to a support.
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidRun {
    pub inverse_mass: f64,
    pub inverse_inertia: f64,
    pub centre: Vector2<f64>,
}

impl RigidRun {
    /// Body with prescribed motion.
    const HELD: Self = Self {
        inverse_mass: 0.0,
        inverse_inertia: 0.0,
        centre: Vector2::new(0.0, 0.0),
    };

    fn free(moments: &MassMoments) -> Self {
        let inverse_mass = 1.0 / moments.mass;
        let centre = moments.first * inverse_mass;
        Self {
            inverse_mass,
            inverse_inertia: 1.0 / (moments.polar - moments.first.dot(&centre)),
            centre,
        }
    }

    pub(crate) fn is_held(&self) -> bool {
        self.inverse_mass == 0.0
    }
}

/// Open joint of the active set, between body `index` and body `index + 1`.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenPin {
    pub joint: usize,
    pub point: Vector2<f64>,
    pub parted: bool,
    /// Unit vectors along and normal to the joint.
    pub axes: [Vector2<f64>; 2],
    /// Moments of unit impulses along the axes about the centres of the left and the right body.
    pub turns: [[f64; 2]; 2],
    /// Inverse of the pivot of the elimination.
    pub pivot: Matrix2<f64>,
    /// Inverse pivot of the previous pin times the coupling with it.
    pub gain: Matrix2<f64>,
}

/// System of equations of a placed row under an active set.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    pub row: Placed,
    /// Active set of the current bodies and pins, at the joints before `factored`.
    pub active: Vec<Corners>,
    factored: usize,
    pub bodies: Vec<RigidRun>,
    pub pins: Vec<OpenPin>,
    /// Least pivot up to each pin, relative to its value before the elimination.
    least: Vec<f64>,
}

impl Factor {
    pub fn new(row: &Row) -> Self {
        let joints = row.joints.len();
        Self {
            row: Placed::new(row),
            active: vec![[true; 2]; joints],
            factored: 0,
            bodies: Vec::with_capacity(joints + 1),
            pins: Vec::with_capacity(joints),
            least: Vec::with_capacity(joints),
        }
    }

    /// Sets the positions of the blocks.
    pub fn set_positions(&mut self, placement: &Placement) {
        self.row.set_positions(placement);
        self.factored = 0;
    }

    /// Computes bodies, pins and pivots of an active set. Returns the least pivot relative to its value before the elimination: zero for linearly
    /// dependent constraints.
    pub fn update(&mut self, active: &[Corners]) -> f64 {
        let known = active.iter().zip(&self.active);
        let same = known.take_while(|(now, then)| now == then).count();
        let from = same.min(self.factored);
        if from == active.len() {
            return self.least_pivot();
        }
        self.active[from..].copy_from_slice(&active[from..]);
        self.factored = active.len();
        // The body after the last kept pin ends at the next pin, which may be new.
        let kept = self.pins.partition_point(|pin| pin.joint < from);
        self.pins.truncate(kept);
        self.bodies.truncate(kept);
        let mut first = self.pins.last().map(|pin| pin.joint);
        for (joint, active) in active.iter().enumerate().skip(from) {
            let frame = &self.row.frames[joint];
            let point = match active {
                [true, true] => continue,
                [false, true] => frame.corner_m(Edge::Extrados),
                _ => frame.intrados_m,
            };
            let axes = [frame.tangent, frame.normal];
            self.bodies.push(match first {
                None => RigidRun::HELD,
                Some(first) => self.body(first, joint),
            });
            self.pins.push(OpenPin {
                joint,
                point,
                parted: *active == [false; 2],
                axes,
                turns: [[0.0; 2]; 2],
                pivot: Matrix2::zeros(),
                gain: Matrix2::zeros(),
            });
            first = Some(joint);
        }
        self.bodies.push(match (self.row.supports, first) {
            (Supports::Left, Some(first)) => self.body(first, self.row.own.len()),
            (Supports::Left, None) | (Supports::Both, _) => RigidRun::HELD,
        });
        // The pivot of a pin depends on the bodies at both sides.
        self.eliminate(kept.saturating_sub(1));
        self.least_pivot()
    }

    fn least_pivot(&self) -> f64 {
        match (self.least.last(), self.row.supports) {
            (Some(least), _) => *least,
            (None, Supports::Left) => 1.0,
            // An arch without hinges is fixed at both ends.
            (None, Supports::Both) => 0.0,
        }
    }

    fn body(&self, first: usize, end: usize) -> RigidRun {
        RigidRun::free(&(self.row.moments[end] - self.row.moments[first]))
    }

    /// Eliminates the compliances at the pins from `start` on, in axes along and normal to each joint.
    fn eliminate(&mut self, start: usize) {
        self.least.truncate(start);
        let mut least = self.least.last().copied().unwrap_or(1.0);
        for index in start..self.pins.len() {
            let (before, from) = self.pins.split_at_mut(index);
            let pin = &mut from[0];
            let sides = [&self.bodies[index], &self.bodies[index + 1]];
            pin.turns = sides.map(|body| {
                let arm = pin.point - body.centre;
                pin.axes.map(|axis| arm.perp(&axis))
            });
            let mut own = Matrix2::<f64>::zeros();
            for (body, turn) in sides.iter().zip(&pin.turns) {
                let share = body.inverse_inertia;
                own.m11 += body.inverse_mass + share * turn[0] * turn[0];
                own.m12 += share * turn[0] * turn[1];
                own.m22 += body.inverse_mass + share * turn[1] * turn[1];
            }
            let free = [own.m11, own.m22];
            if let Some(previous) = before.last() {
                let body = sides[0];
                let coupling = |p: usize, q: usize| {
                    -(body.inverse_mass * previous.axes[p].dot(&pin.axes[q])
                        + body.inverse_inertia * previous.turns[1][p] * pin.turns[0][q])
                };
                let mut b = Matrix2::from_fn(coupling);
                if previous.parted {
                    b.row_mut(1).fill(0.0);
                }
                if pin.parted {
                    b.column_mut(1).fill(0.0);
                }
                pin.gain = previous.pivot * b;
                own -= b.transpose() * pin.gain;
            }
            least = lower(least, own.m11 / free[0]);
            if pin.parted {
                pin.pivot = Matrix2::new(1.0 / own.m11, 0.0, 0.0, 0.0);
            } else {
                let determinant = own.m11 * own.m22 - own.m12 * own.m12;
                least = lower(least, determinant / (own.m11 * free[1]));
                let inverse = 1.0 / determinant;
                pin.pivot = Matrix2::new(own.m22, -own.m12, -own.m12, own.m11) * inverse;
            }
            self.least.push(least);
        }
    }

    /// Open joints at the two ends of a body; `None` at a support or a free end.
    fn open_ends(&self, body: usize) -> [Option<usize>; 2] {
        let pin = |pin: usize| Some(self.pins.get(pin)?.joint);
        [body.checked_sub(1).and_then(pin), pin(body)]
    }

    /// Closed joints inside a body.
    pub(crate) fn shut_joints(&self, body: usize) -> Range<usize> {
        let [first, last] = self.open_ends(body);
        first.map_or(0, |joint| joint + 1)..last.unwrap_or(self.active.len())
    }

    /// Blocks of a body.
    pub fn blocks(&self, body: usize) -> Range<usize> {
        let [first, last] = self.open_ends(body);
        first.unwrap_or(0)..last.unwrap_or(self.row.own.len())
    }
}
