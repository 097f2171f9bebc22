//! The active set of the same program by an interior-point method, for changes of many corners that follow each other along the
//! row: in two dozen iterations, however many they are.
//!
//! Unknown are the impulses of every joint, along it and at its two corners. They solve `rate = A impulse + drive`, with the rate
//! along a joint zero, and at its corners neither rate nor impulse negative and one of them zero; `A` is block-tridiagonal with 3x3
//! blocks. The method is Mehrotra's ("On the implementation of a primal-dual interior point method", SIAM Journal on Optimization 2,
//! 1992).

use nalgebra::{Matrix3, Vector2, Vector3};

use super::{Corners, EDGES, Program};
use crate::mechanics::blocks::Supports;

/// Iterations after which it gives up.
const ITERATIONS: usize = 50;
/// Mean product of rate and impulse at which the corners are known, as part of that at the beginning.
const KNOWN: f64 = 1e-12;
/// A step that leaves more than this part of the mean product is followed by one that only centres ...
const STALLED: f64 = 0.5;
/// ... on this part of it.
const CENTRED: f64 = 0.2;
/// Part of the way to the boundary that a step takes.
const WAY: f64 = 0.995;
/// Keeps the pivots along joints apart from zero.
const REGULAR: f64 = 1e-13;

/// Memory for a row; rows are scaled to a unit diagonal of `A`.
#[derive(Clone, Debug, Default)]
pub(super) struct Interior {
    own: Vec<Matrix3<f64>>,
    next: Vec<Matrix3<f64>>,
    drive: Vec<Vector3<f64>>,
    impulses: Vec<Vector3<f64>>,
    rates: Vec<Vector3<f64>>,
    /// By how much the equations of the rates are missed.
    misses: Vec<Vector3<f64>>,
    /// One over the impulses at corners, zero along joints and where none can be.
    inverses: Vec<Vector3<f64>>,
    pivots: Vec<Matrix3<f64>>,
    gains: Vec<Matrix3<f64>>,
    right: Vec<Vector3<f64>>,
    impulse_steps: Vec<Vector3<f64>>,
    rate_steps: Vec<Vector3<f64>>,
    /// Corners that take part.
    touching: Vec<Corners>,
    /// Corners that press in the solution.
    active: Vec<Corners>,
}

impl Interior {
    pub fn with_joints(joints: usize) -> Self {
        Self {
            own: vec![Matrix3::zeros(); joints],
            next: vec![Matrix3::zeros(); joints],
            drive: vec![Vector3::zeros(); joints],
            impulses: vec![Vector3::zeros(); joints],
            rates: vec![Vector3::zeros(); joints],
            misses: vec![Vector3::zeros(); joints],
            inverses: vec![Vector3::zeros(); joints],
            pivots: vec![Matrix3::zeros(); joints],
            gains: vec![Matrix3::zeros(); joints],
            right: vec![Vector3::zeros(); joints],
            impulse_steps: vec![Vector3::zeros(); joints],
            rate_steps: vec![Vector3::zeros(); joints],
            touching: vec![[false; 2]; joints],
            active: vec![[false; 2]; joints],
        }
    }

    /// Exchanges the corners that press in the solution with those of the list.
    pub fn exchange_active(&mut self, active: &mut [Corners]) {
        self.active.swap_with_slice(active);
    }

    /// Finds the corners that press in a program that is placed and loaded; returns the number of iterations, or `None` if it does
    /// not get there.
    pub fn solve(&mut self, program: &Program, touching: &[Corners]) -> Option<usize> {
        self.take(program, touching);
        let corners = touching.iter().flatten().filter(|touches| **touches);
        #[expect(clippy::cast_precision_loss, reason = "a number of corners")]
        let share = 1.0 / corners.count() as f64;
        let mut mean_before = f64::INFINITY;
        for iteration in 1..=ITERATIONS {
            let mean = share * self.product(0.0);
            if mean < KNOWN {
                for (joint, active) in self.active.iter_mut().enumerate() {
                    let (impulse, rate) = (&self.impulses[joint], &self.rates[joint]);
                    let touches = self.touching[joint];
                    *active = [0, 1].map(|e| touches[e] && impulse[e + 1] >= rate[e + 1]);
                }
                return Some(iteration);
            }
            let miss = self.miss();
            self.factor()?;
            if miss < mean && mean > STALLED * mean_before {
                self.step(CENTRED * mean, 0.0);
            } else {
                // Straight to the solution, to see how far that leads; then with what that leaves out, and off the boundary.
                self.step(0.0, 0.0);
                let reached = share * self.product(self.longest(1.0));
                self.step((reached / mean).powi(3) * mean, 1.0);
            }
            mean_before = mean;
            let part = self.longest(WAY);
            for joint in 0..self.own.len() {
                self.impulses[joint] += self.impulse_steps[joint] * part;
                self.rates[joint] += self.rate_steps[joint] * part;
            }
        }
        None
    }

    /// Takes the compliances and the rates without impulses from a program that is placed and loaded.
    fn take(&mut self, program: &Program, touching: &[Corners]) {
        let joints = program.frames.len();
        self.touching.copy_from_slice(touching);
        self.own.fill(Matrix3::zeros());
        self.next.fill(Matrix3::zeros());
        self.impulses.fill(Vector3::zeros());
        self.rates.fill(Vector3::zeros());
        self.impulse_steps.fill(Vector3::zeros());
        self.rate_steps.fill(Vector3::zeros());
        // Rows of the joint left of a block, in its motions.
        let mut before = Matrix3::zeros();
        for joint in 0..joints {
            let frame = &program.frames[joint];
            let rows = [
                (frame.along, frame.intrados_m),
                (frame.normal, frame.corner_m(EDGES[0])),
                (frame.normal, frame.corner_m(EDGES[1])),
            ];
            let [intrados, extrados] = self.touching[joint];
            let takes_part = [true, intrados, extrados];
            // A body by its central velocity and rate, scaled with the roots of mass and inertia.
            let gradient = |mass: f64, inertia: f64, centre: Vector2<f64>| {
                let mut gradient = Matrix3::zeros();
                for (row, (direction, point)) in rows.iter().enumerate() {
                    if takes_part[row] {
                        let linear = direction / mass.sqrt();
                        let turn = (point - centre).perp(direction) / inertia.sqrt();
                        gradient.set_row(row, &Vector3::new(linear.x, linear.y, turn).transpose());
                    }
                }
                gradient
            };
            let mut drive = Vector3::zeros();
            if let Some(left) = joint.checked_sub(1) {
                let (mass, inertia) = program.masses[left];
                let gradient = -gradient(mass, inertia, program.centre(left));
                self.own[joint] += gradient * gradient.transpose();
                self.next[left] = before * gradient.transpose();
                drive += gradient * program.scaled_motion(left);
            }
            if let Some((mass, inertia)) = program.masses.get(joint) {
                let gradient = gradient(*mass, *inertia, program.centre(joint));
                self.own[joint] += gradient * gradient.transpose();
                drive += gradient * program.scaled_motion(joint);
                before = gradient;
            } else if program.supports == Supports::Both {
                let support = program.datum[program.masses.len()] * -1.0;
                for (row, (direction, point)) in rows.iter().enumerate() {
                    if takes_part[row] {
                        drive[row] += direction.dot(&support.at(*point));
                    }
                }
            }
            self.drive[joint] = drive;
        }
        self.scale();
    }

    /// Scales the rows to a unit diagonal and the drive to one, and begins.
    fn scale(&mut self) {
        let joints = self.own.len();
        for joint in 0..joints {
            // What takes no part has no compliance.
            let scale = |own: &Matrix3<f64>| {
                own.diagonal()
                    .map(|a| if a > 0.0 { a.sqrt().recip() } else { 1.0 })
            };
            let here = Matrix3::from_diagonal(&scale(&self.own[joint]));
            if let Some(after) = self.own.get(joint + 1) {
                let there = Matrix3::from_diagonal(&scale(after));
                self.next[joint] = here * self.next[joint] * there;
            }
            self.drive[joint] = here * self.drive[joint];
            self.pivots[joint] = here;
        }
        let largest = self
            .drive
            .iter()
            .map(Vector3::amax)
            .fold(f64::MIN_POSITIVE, f64::max);
        for joint in 0..joints {
            let here = self.pivots[joint];
            self.own[joint] = here * self.own[joint] * here;
            self.drive[joint] /= largest;
            for edge in 0..2 {
                if self.touching[joint][edge] {
                    self.impulses[joint][edge + 1] = 1.0;
                    self.rates[joint][edge + 1] = 1.0;
                } else {
                    self.own[joint][(edge + 1, edge + 1)] = 1.0;
                }
            }
            self.own[joint][(0, 0)] += REGULAR;
        }
    }

    /// Sum of the products of impulses and rates after a part of the step.
    fn product(&self, part: f64) -> f64 {
        let mut sum = 0.0;
        for joint in 0..self.own.len() {
            for row in 1..3 {
                let impulse = self.impulses[joint][row] + part * self.impulse_steps[joint][row];
                sum += impulse * (self.rates[joint][row] + part * self.rate_steps[joint][row]);
            }
        }
        sum
    }

    /// Rates by the impulses less those at hand; returns the largest.
    fn miss(&mut self) -> f64 {
        let mut largest = 0.0_f64;
        for joint in 0..self.own.len() {
            self.misses[joint] =
                self.drive[joint] - self.rates[joint] + self.compliant(joint, &self.impulses);
            largest = largest.max(self.misses[joint].amax());
        }
        largest
    }

    /// Rates of a joint by impulses.
    fn compliant(&self, joint: usize, impulses: &[Vector3<f64>]) -> Vector3<f64> {
        let mut rate = self.own[joint] * impulses[joint];
        if let Some(before) = joint.checked_sub(1) {
            rate += self.next[before].tr_mul(&impulses[before]);
        }
        if let Some(after) = impulses.get(joint + 1) {
            rate += self.next[joint] * after;
        }
        rate
    }

    /// Eliminates from left to right.
    fn factor(&mut self) -> Option<()> {
        for joint in 0..self.own.len() {
            let impulse = &self.impulses[joint];
            let inverse = |row: usize| {
                if self.touching[joint][row - 1] {
                    1.0 / impulse[row]
                } else {
                    0.0
                }
            };
            self.inverses[joint] = Vector3::new(0.0, inverse(1), inverse(2));
            let mut pivot = self.own[joint];
            for row in 1..3 {
                pivot[(row, row)] += self.rates[joint][row] * self.inverses[joint][row];
            }
            if let Some(before) = joint.checked_sub(1) {
                pivot -= self.next[before].transpose() * self.gains[before];
            }
            self.pivots[joint] = pivot.try_inverse()?;
            self.gains[joint] = self.pivots[joint] * self.next[joint];
        }
        Some(())
    }

    /// A step towards products of this size, of impulses and of rates; `second` times the product of the last steps is left out.
    fn step(&mut self, centre: f64, second: f64) {
        let joints = self.own.len();
        for joint in 0..joints {
            // What the rates change by where the impulses do not: nothing along joints and where none can be.
            let left_out =
                self.impulse_steps[joint].component_mul(&self.rate_steps[joint]) * second;
            let products = left_out.map(|left_out| centre - left_out);
            let change = products.component_mul(&self.inverses[joint]) - self.rates[joint];
            self.rate_steps[joint] = change;
            let mut right = change - self.misses[joint];
            if let Some(before) = joint.checked_sub(1) {
                right -= self.gains[before].tr_mul(&self.right[before]);
            }
            self.right[joint] = right;
        }
        for joint in (0..joints).rev() {
            let mut step = self.pivots[joint] * self.right[joint];
            if let Some(after) = self.impulse_steps.get(joint + 1) {
                step -= self.gains[joint] * after;
            }
            self.impulse_steps[joint] = step;
            let slope = self.rates[joint].component_mul(&self.inverses[joint]);
            self.rate_steps[joint] -= slope.component_mul(&step);
        }
    }

    /// The longest part of the step, up to the whole, that leaves impulses and rates positive by the same part of the way.
    fn longest(&self, way: f64) -> f64 {
        let mut longest = 1.0_f64;
        for joint in 0..self.own.len() {
            for row in 1..3 {
                for (value, step) in [
                    (self.impulses[joint][row], self.impulse_steps[joint][row]),
                    (self.rates[joint][row], self.rate_steps[joint][row]),
                ] {
                    if value + longest * step / way < 0.0 {
                        longest = -way * value / step;
                    }
                }
            }
        }
        longest
    }
}
