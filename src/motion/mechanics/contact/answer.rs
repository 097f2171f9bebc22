//! Impulses between bodies under a load, and the resulting velocities of the bodies.

use nalgebra::{Matrix2, Vector2};

use super::factor::{Factor, OpenPin, RigidRun};
use crate::mechanics::geometry::field::quarter_turn;
use crate::mechanics::joints::Closure;
use crate::mechanics::{Edge, Momentum, Supports, Twist};

/// Velocities of a body at its centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyVelocity {
    centre: Vector2<f64>,
    velocity: Vector2<f64>,
    rate: f64,
}

impl BodyVelocity {
    /// Velocities of a body with a given momentum.
    fn with(body: &RigidRun, momentum: &Momentum) -> Self {
        Self {
            centre: body.centre,
            velocity: momentum.linear * body.inverse_mass,
            rate: momentum.moment_about(body.centre) * body.inverse_inertia,
        }
    }

    /// Velocities of a body fixed to a support.
    fn held(twist: Twist) -> Self {
        Self {
            centre: Vector2::zeros(),
            velocity: twist.at_center,
            rate: twist.rate,
        }
    }

    fn velocity_at(&self, point: Vector2<f64>) -> Vector2<f64> {
        let arm = point - self.centre;
        self.velocity + quarter_turn(arm) * self.rate
    }

    pub fn twist(&self) -> Twist {
        Twist {
            at_center: self.velocity_at(Vector2::zeros()),
            rate: self.rate,
        }
    }

    fn push(&mut self, body: &RigidRun, point: Vector2<f64>, impulse: Vector2<f64>) {
        self.velocity += impulse * body.inverse_mass;
        self.rate += (point - self.centre).perp(&impulse) * body.inverse_inertia;
    }
}

impl OpenPin {
    /// Velocity of the right body relative to the left one at the pin, along and normal to the joint.
    fn rate(&self, left: &BodyVelocity, right: &BodyVelocity) -> Vector2<f64> {
        let apart = right.velocity - left.velocity;
        let [on_left, on_right] = self.turns;
        let rate = |axis: usize| {
            self.axes[axis].dot(&apart) + (on_right[axis] * right.rate - on_left[axis] * left.rate)
        };
        Vector2::new(rate(0), rate(1))
    }

    /// Impulse vector with given components along and normal to the joint.
    fn impulse(&self, shares: &Vector2<f64>) -> Vector2<f64> {
        self.axes[0] * shares.x + self.axes[1] * shares.y
    }
}

/// Impulse at one corner of an open joint, on both its bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct CornerImpulse {
    pub pin: usize,
    pub edge: usize,
    pub impulse: f64,
}

/// Solution of a pin system for a load, or for a unit impulse.
#[derive(Clone, Debug, Default)]
pub(super) struct PinSolution {
    pub motions: Vec<BodyVelocity>,
    /// Impulses on the right body at the open joints, along and normal to the joint.
    pub pins: Vec<Vector2<f64>>,
    /// Impulses at the corners of all joints.
    pub corners: Vec<[f64; 2]>,
    /// Rates of the gaps at the open joints.
    pub rates: Vec<[f64; 2]>,
}

impl PinSolution {
    pub fn with_capacity(joints: usize) -> Self {
        Self {
            motions: Vec::with_capacity(joints + 1),
            pins: Vec::with_capacity(joints),
            corners: vec![[0.0; 2]; joints],
            rates: Vec::with_capacity(joints),
        }
    }

    /// Solves for the load, with an optional impulse at one corner.
    pub fn take_load(&mut self, factor: &Factor, press: Option<CornerImpulse>) {
        self.free_motions(factor);
        self.add_body_impulses(factor, press, None, true);
    }

    /// Solves for a unit impulse at one corner, without the load.
    pub(crate) fn take_unit(&mut self, factor: &Factor, pin: usize, edge: usize) {
        self.motions.clear();
        let still = |body: &RigidRun| BodyVelocity::with(body, &Momentum::ZERO);
        self.motions.extend(factor.bodies.iter().map(still));
        let impulse = 1.0;
        self.add_body_impulses(
            factor,
            Some(CornerImpulse { pin, edge, impulse }),
            None,
            false,
        );
    }

    /// Solves for the load and the closure error of an arch.
    pub(crate) fn take_closure(&mut self, factor: &Factor, closure: &Closure) {
        self.free_motions(factor);
        self.add_body_impulses(factor, None, Some(closure), true);
    }

    /// Computes the velocities of the bodies without impulses between them.
    fn free_motions(&mut self, factor: &Factor) {
        let row = &factor.row;
        self.motions.clear();
        for (index, body) in factor.bodies.iter().enumerate() {
            self.motions.push(if body.is_held() {
                BodyVelocity::held(match row.supports {
                    Supports::Both if index > 0 => row.datum[row.own.len()] * -1.0,
                    _ => Twist::ZERO,
                })
            } else {
                let blocks = factor.blocks(index);
                BodyVelocity::with(body, &(row.momenta[blocks.end] - row.momenta[blocks.start]))
            });
        }
    }

    /// Adds impulses between the bodies to velocities without them, and computes gap rates and corner impulses.
    fn add_body_impulses(
        &mut self,
        factor: &Factor,
        press: Option<CornerImpulse>,
        closure: Option<&Closure>,
        loaded: bool,
    ) {
        if let Some(CornerImpulse { pin, edge, impulse }) = press {
            let frame = &factor.row.frames[factor.pins[pin].joint];
            let (corner, impulse) = (frame.corner_m(Edge::ALL[edge]), frame.normal * impulse);
            self.motions[pin].push(&factor.bodies[pin], corner, -impulse);
            self.motions[pin + 1].push(&factor.bodies[pin + 1], corner, impulse);
        }
        self.solve_pins(factor, closure);
        self.move_bodies(factor);
        self.open_gaps(factor);
        self.press_corners(factor, press, loaded);
    }

    /// Solves for the impulses at the pins.
    fn solve_pins(&mut self, factor: &Factor, closure: Option<&Closure>) {
        self.pins.clear();
        let mut carried = Vector2::zeros();
        for (pin, sides) in factor.pins.iter().zip(self.motions.windows(2)) {
            let mut rate = pin.rate(&sides[0], &sides[1]);
            if let Some(closure) = closure.filter(|closure| closure.joint == pin.joint) {
                rate += Vector2::from(pin.axes.map(|axis| axis.dot(&closure.error_m)));
            }
            if pin.parted {
                rate.y = 0.0;
            }
            carried = -rate - pin.gain.transpose() * carried;
            self.pins.push(carried);
        }
        let mut next = Vector2::zeros();
        let mut gain = Matrix2::zeros();
        for (pin, impulse) in factor.pins.iter().zip(&mut self.pins).rev() {
            *impulse = pin.pivot * *impulse - gain * next;
            (next, gain) = (*impulse, pin.gain);
        }
    }

    /// Adds the impulses of the pins at both ends to each body.
    fn move_bodies(&mut self, factor: &Factor) {
        let mut left: Option<(&OpenPin, Vector2<f64>)> = None;
        for (index, (body, motion)) in factor.bodies.iter().zip(&mut self.motions).enumerate() {
            let right = factor.pins.get(index).map(|pin| (pin, self.pins[index]));
            let (mut linear, mut angular) = (Vector2::zeros(), 0.0);
            if let Some((pin, shares)) = left {
                linear += pin.impulse(&shares);
                angular += pin.turns[1][0] * shares.x + pin.turns[1][1] * shares.y;
            }
            if let Some((pin, shares)) = right {
                linear -= pin.impulse(&shares);
                angular -= pin.turns[0][0] * shares.x + pin.turns[0][1] * shares.y;
            }
            motion.velocity += linear * body.inverse_mass;
            motion.rate += angular * body.inverse_inertia;
            left = right;
        }
    }

    fn open_gaps(&mut self, factor: &Factor) {
        self.rates.clear();
        for (pin, sides) in factor.pins.iter().zip(self.motions.windows(2)) {
            let frame = &factor.row.frames[pin.joint];
            let (left, right) = (&sides[0], &sides[1]);
            let opening = factor.row.handedness * frame.thickness_m * (right.rate - left.rate);
            self.rates.push(match factor.active[pin.joint] {
                [true, _] => [0.0, opening],
                [_, true] => [-opening, 0.0],
                _ => {
                    let gap =
                        right.velocity_at(frame.intrados_m) - left.velocity_at(frame.intrados_m);
                    let intrados = frame.normal.dot(&gap);
                    [intrados, intrados + opening]
                }
            });
        }
    }

    /// Computes the corner impulses: at hinges from the pins, at closed joints from the running sum of momentum changes.
    fn press_corners(&mut self, factor: &Factor, press: Option<CornerImpulse>, loaded: bool) {
        let row = &factor.row;
        for body in 0..factor.bodies.len() {
            let joints = factor.shut_joints(body);
            if joints.is_empty() {
                continue;
            }
            let start = self.starting_impulse(factor, body, press, loaded);
            let twist = self.motions[body].twist();
            for joint in joints {
                let resultant = start - row.momentum_change(&twist, joint, loaded);
                let frame = &row.frames[joint];
                let normal = frame.normal.dot(&resultant.linear);
                let extrados =
                    row.handedness * resultant.moment_about(frame.intrados_m) / frame.thickness_m;
                self.corners[joint] = [normal - extrados, extrados];
            }
        }
        for (pin, impulse) in factor.pins.iter().zip(&self.pins) {
            self.corners[pin.joint] = match factor.active[pin.joint] {
                [true, _] => [impulse.y, 0.0],
                [_, true] => [0.0, impulse.y],
                _ => [0.0; 2],
            };
        }
    }

    /// Resultant impulse at a joint of a body plus the change of momentum before that joint. This sum is constant along the body. A hinge
    /// or the free end gives its value.
    fn starting_impulse(
        &self,
        factor: &Factor,
        body: usize,
        press: Option<CornerImpulse>,
        loaded: bool,
    ) -> Momentum {
        let row = &factor.row;
        let twist = self.motions[body].twist();
        let index = body.saturating_sub(1);
        let Some(pin) = factor.pins.get(index) else {
            return row.momentum_change(&twist, row.own.len(), loaded);
        };
        let impulse = pin.impulse(&self.pins[index]);
        let mut resultant = Momentum::applied_at(pin.point, impulse);
        if let Some(press) = press.filter(|press| press.pin == index) {
            let frame = &row.frames[pin.joint];
            let corner = frame.corner_m(Edge::ALL[press.edge]);
            resultant = resultant + Momentum::applied_at(corner, frame.normal * press.impulse);
        }
        resultant + row.momentum_change(&twist, pin.joint, loaded)
    }

    /// Writes the impulses under the load on the block after each joint: along the joint towards the extrados, and normal to it.
    pub(crate) fn joint_impulses(&self, factor: &Factor, into: &mut [[f64; 2]]) {
        let row = &factor.row;
        for body in 0..factor.bodies.len() {
            let start = self.starting_impulse(factor, body, None, true);
            let twist = self.motions[body].twist();
            for joint in factor.shut_joints(body) {
                let linear = (start - row.momentum_change(&twist, joint, true)).linear;
                let frame = &row.frames[joint];
                into[joint] = [frame.tangent.dot(&linear), frame.normal.dot(&linear)];
            }
        }
        for (pin, impulse) in factor.pins.iter().zip(&self.pins) {
            into[pin.joint] = [impulse.x, impulse.y];
        }
    }
}
