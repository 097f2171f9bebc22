//! Impulses at the pins between bodies: the joints that may open or slip.
//!
//! An end of a joint is in contact (rate zero, compressive impulse) or free. Along the joint there are three modes: the joint sticks (rate zero,
//! `|T| <= mu (N_I + N_E)`), slips (`T = +-mu (N_I + N_E)` against the slip), or has no contact and no impulse. For given modes the impulses solve a
//! block-tridiagonal system with 3x3 blocks. Newton's method updates the modes, starting from those of the last step. Once the solution confirms the
//! modes, Coulomb's law holds exactly.
//!
//! If Newton's method fails, the friction bounds are fixed at those of the last impulses (Tresca). This problem is convex; projected Newton steps
//! solve its dual. Newton's method restarts from the modes of this solution. If it fails again, the bounds are updated from the impulses. This
//! fixed-point iteration fails in one case in a hundred thousand, and more often in long rows close to the least friction coefficient for
//! equilibrium. An interior-point method ([`super::interior`]) handles these cases, and as a last resort Lemke's method
//! ([`crate::mechanics::complementarity`]). In every result friction never adds energy and contact forces are never tensile: without convergence a
//! friction bound is wrong, but never the sign of the work.

use nalgebra::{Matrix3, RowVector3, Vector3};

use super::{JointMode, TangentialMode};

/// Weight of the proximal term, as a fraction of the diagonal.
pub(super) const PROXIMAL: f64 = 1e-6;
/// Maximum number of Newton steps from the modes of the last solution.
pub(super) const PASSES: usize = 8;
/// Maximum number of Newton steps that change one mode at a time, after a problem with fixed bounds.
const SINGLE_PASSES: usize = 12;
/// Maximum number of projected Newton steps with fixed bounds.
const BOUNDED_STEPS: usize = 60;
/// Maximum number of updates of the bounds; bounds that have not converged by then oscillate.
const BOUND_PASSES: usize = 5;
/// Tolerance for changes of the bounds, relative to the largest bound.
const SAME_BOUND: f64 = 1e-10;
/// Least decrease in a line search, relative to the decrease predicted by the slope.
const DESCENT: f64 = 1e-4;
/// Shortest step of the line search, as a fraction of the Newton step.
const LEAST_PART: f64 = 1e-6;

/// Equation for one coordinate of a joint.
#[derive(Clone, Copy, Debug)]
enum Equation {
    /// The rate is zero.
    ZeroRate,
    /// The impulse is given, in N s.
    GivenImpulse(f64),
    /// The impulse is this multiple of the sum of the impulses at both ends.
    Friction(f64),
}

/// Equations of a joint: matrices for its own impulses, for those of the joint before and after it, and the right-hand side.
pub(super) struct Balance {
    pub matrix: Matrix3<f64>,
    pub coupling: Matrix3<f64>,
    pub onward: Matrix3<f64>,
    pub right: Vector3<f64>,
}

/// Contact problem of the pins of a row, with work space.
#[derive(Clone, Debug)]
pub(super) struct PinProgram {
    pub coefficient: f64,
    /// Compliance matrices within a pin, and with the next pin.
    pub own: Vec<Matrix3<f64>>,
    pub next: Vec<Matrix3<f64>>,
    /// Rates without impulses.
    pub drive: Vec<Vector3<f64>>,
    pub modes: Vec<JointMode>,
    /// Impulses in N s: at both ends of every joint, and along the joint.
    pub impulses: Vec<Vector3<f64>>,
    /// Impulses of the last solution, for the proximal term.
    pub before: Vec<Vector3<f64>>,
    pub rates: Vec<Vector3<f64>>,
    bounds: Vec<f64>,
    equations: Vec<[Equation; 3]>,
    gains: Vec<Matrix3<f64>>,
    pub target: Vec<Vector3<f64>>,
    pub kept: Vec<Vector3<f64>>,
}

impl PinProgram {
    pub fn new(coefficient: f64) -> Self {
        Self {
            coefficient,
            own: Vec::new(),
            next: Vec::new(),
            drive: Vec::new(),
            modes: Vec::new(),
            impulses: Vec::new(),
            before: Vec::new(),
            rates: Vec::new(),
            bounds: Vec::new(),
            equations: Vec::new(),
            gains: Vec::new(),
            target: Vec::new(),
            kept: Vec::new(),
        }
    }

    /// Makes room for a number of pins.
    pub fn resize(&mut self, pins: usize) {
        for matrices in [&mut self.own, &mut self.next, &mut self.gains] {
            matrices.resize(pins, Matrix3::zeros());
        }
        let vectors = [&mut self.drive, &mut self.impulses, &mut self.before];
        let more = [&mut self.rates, &mut self.target, &mut self.kept];
        for vectors in vectors.into_iter().chain(more) {
            vectors.resize(pins, Vector3::zeros());
        }
        self.modes.resize(pins, JointMode::STICKING);
        self.bounds.resize(pins, 0.0);
        self.equations.resize(pins, [Equation::ZeroRate; 3]);
    }

    /// Largest residual rate due to the proximal term, in m/s.
    pub fn residual_m_s(&self) -> f64 {
        let proximal_rates = (0..self.own.len()).map(|joint| self.proximal_rates(joint).amax());
        proximal_rates.fold(0.0, f64::max)
    }

    /// Runs Newton's method on the modes, and returns whether the modes converge. With `one`, a step only changes the worst mode.
    pub fn newton(&mut self, passes: usize, one: bool, tolerance: f64, count: &mut usize) -> bool {
        for _ in 0..passes {
            for (equations, mode) in self.equations.iter_mut().zip(&self.modes) {
                let end = |pressed| {
                    [Equation::GivenImpulse(0.0), Equation::ZeroRate][usize::from(pressed)]
                };
                *equations = [
                    end(mode.pressed[0]),
                    end(mode.pressed[1]),
                    match mode.tangential {
                        TangentialMode::Free => Equation::GivenImpulse(0.0),
                        TangentialMode::Stick => Equation::ZeroRate,
                        TangentialMode::Slip(sign) => Equation::Friction(sign * self.coefficient),
                    },
                ];
            }
            self.balance();
            *count += 1;
            std::mem::swap(&mut self.impulses, &mut self.target);
            self.find_free_rates();
            if self.correct_modes(one, tolerance) {
                return true;
            }
        }
        false
    }

    /// Changes the modes that contradict the impulses and rates. Returns true if there are none.
    fn correct_modes(&mut self, one: bool, tolerance: f64) -> bool {
        let mut right = true;
        let mut worst = (0.0, 0, JointMode::STICKING);
        for joint in 0..self.modes.len() {
            let (impulse, rate) = (&self.impulses[joint], &self.rates[joint]);
            let compliance = self.own[joint].diagonal();
            let (mode, by) = self.modes[joint].corrected(
                [impulse, rate],
                &compliance,
                self.coefficient,
                tolerance,
            );
            if mode != self.modes[joint] {
                right = false;
                if !one {
                    self.modes[joint] = mode;
                } else if by >= worst.0 {
                    worst = (by, joint, mode);
                }
            }
        }
        if one && !right {
            self.modes[worst.1] = worst.2;
        }
        right
    }

    /// Solves the equations of the modes for the impulses `target`.
    fn balance(&mut self) {
        self.sweep(|program, joint| {
            let mut balance = Balance {
                matrix: program.own[joint],
                coupling: program.coupling(joint),
                onward: program.next[joint],
                right: -program.drive[joint],
            };
            for row in 0..3 {
                match program.equations[joint][row] {
                    Equation::ZeroRate => {
                        let proximal = program.proximal_term(joint, row);
                        balance.matrix[(row, row)] += proximal;
                        balance.right[row] += proximal * program.before[joint][row];
                        continue;
                    }
                    Equation::GivenImpulse(value) => {
                        balance.matrix.set_row(row, &RowVector3::zeros());
                        balance.matrix[(row, row)] = 1.0;
                        balance.right[row] = value;
                    }
                    Equation::Friction(factor) => {
                        let friction = RowVector3::new(-factor, -factor, 1.0);
                        balance.matrix.set_row(row, &friction);
                        balance.right[row] = 0.0;
                    }
                }
                balance.coupling.set_row(row, &RowVector3::zeros());
                balance.onward.set_row(row, &RowVector3::zeros());
            }
            balance
        });
    }

    /// Solves the equations of all joints for `target`, by block elimination from left to right.
    pub fn sweep(&mut self, system: impl Fn(&Self, usize) -> Balance) {
        let joints = self.own.len();
        let mut carried = Vector3::zeros();
        let mut gain = Matrix3::zeros();
        for joint in 0..joints {
            let mut balance = system(self, joint);
            balance.matrix -= balance.coupling * gain;
            balance.right -= balance.coupling * carried;
            let pivot = inverse(&balance.matrix);
            carried = pivot * balance.right;
            gain = pivot * balance.onward;
            self.target[joint] = carried;
            self.gains[joint] = gain;
        }
        for joint in (0..joints.saturating_sub(1)).rev() {
            let later = self.gains[joint] * self.target[joint + 1];
            self.target[joint] -= later;
        }
    }

    /// Compliance between a joint and the one before it.
    pub fn coupling(&self, joint: usize) -> Matrix3<f64> {
        let before = joint.checked_sub(1);
        before.map_or(Matrix3::zeros(), |before| self.next[before].transpose())
    }

    /// Proximal term that is added to the compliance of one coordinate of a joint.
    pub fn proximal_term(&self, joint: usize, row: usize) -> f64 {
        PROXIMAL * self.own[joint][(row, row)]
    }

    /// Computes the rates for the impulses, with the proximal term.
    pub fn find_rates(&mut self) {
        for joint in 0..self.rates.len() {
            let rate = self.drive[joint] + self.response(joint, &self.impulses);
            self.rates[joint] = rate + self.proximal_rates(joint);
        }
    }

    /// Computes the rates of the joints that are open or slip. The modes of closed joints that stick depend on their impulses alone.
    fn find_free_rates(&mut self) {
        for joint in 0..self.rates.len() {
            if self.modes[joint] != JointMode::STICKING {
                let rate = self.drive[joint] + self.response(joint, &self.impulses);
                self.rates[joint] = rate + self.proximal_rates(joint);
            }
        }
    }

    /// Rates of a joint due to impulses alone.
    pub fn response(&self, joint: usize, impulses: &[Vector3<f64>]) -> Vector3<f64> {
        let mut rate = self.own[joint] * impulses[joint];
        if let Some(before) = joint.checked_sub(1) {
            rate += self.next[before].tr_mul(&impulses[before]);
        }
        if let Some(after) = impulses.get(joint + 1) {
            rate += self.next[joint] * after;
        }
        rate
    }

    /// Rates of a joint due to the proximal term.
    fn proximal_rates(&self, joint: usize) -> Vector3<f64> {
        let change = self.impulses[joint] - self.before[joint];
        self.own[joint].diagonal().component_mul(&change) * PROXIMAL
    }

    /// Solves problems with fixed bounds, until the modes converge or the bounds agree with the impulses. Returns the relative error of the bounds.
    pub fn solve_bounded(&mut self, tolerance: f64, count: &mut usize) -> f64 {
        self.impulses.copy_from_slice(&self.before);
        for (bound, impulse) in self.bounds.iter_mut().zip(&self.impulses) {
            *bound = self.coefficient * (impulse.x.max(0.0) + impulse.y.max(0.0));
        }
        let mut error = 0.0;
        for pass in 0..BOUND_PASSES {
            self.descend(tolerance, count);
            error = self.bound_error();
            self.read_modes();
            self.kept.copy_from_slice(&self.impulses);
            for (passes, one) in [(PASSES, false), (SINGLE_PASSES, true)] {
                if (!one || pass % 4 == 0) && self.newton(passes, one, tolerance, count) {
                    return 0.0;
                }
                self.impulses.copy_from_slice(&self.kept);
                self.read_modes();
            }
            if error <= SAME_BOUND {
                return error;
            }
            for (bound, impulse) in self.bounds.iter_mut().zip(&self.impulses) {
                *bound = (self.coefficient * (impulse.x + impulse.y)).max(0.0);
            }
        }
        let impulses = self.kept.clone();
        if self.interior(tolerance, count) || self.solve_by_pivoting(tolerance, count) {
            return 0.0;
        }
        self.impulses.copy_from_slice(&impulses);
        self.read_modes();
        error
    }

    /// Largest error of a bound, relative to the largest bound.
    fn bound_error(&self) -> f64 {
        let (mut largest, mut error) = (f64::MIN_POSITIVE, 0.0_f64);
        for (bound, impulse) in self.bounds.iter().zip(&self.impulses) {
            let allowed = self.coefficient * (impulse.x + impulse.y);
            largest = largest.max(*bound).max(allowed);
            error = error.max((bound - allowed).abs());
        }
        error / largest
    }

    /// Sets the modes that correspond to the impulses of a problem with fixed bounds.
    fn read_modes(&mut self) {
        for (joint, mode) in self.modes.iter_mut().enumerate() {
            let (impulse, bound) = (&self.impulses[joint], self.bounds[joint]);
            *mode = JointMode {
                pressed: [impulse.x > 0.0, impulse.y > 0.0],
                tangential: if impulse.z.abs() < bound {
                    TangentialMode::Stick
                } else {
                    TangentialMode::Slip(impulse.z.signum())
                },
            }
            .settled();
        }
    }

    /// Lower and upper limits of the impulses of a joint for fixed bounds.
    fn limits(&self, joint: usize) -> [(f64, f64); 3] {
        let (pressed, bound) = ((0.0, f64::INFINITY), self.bounds[joint]);
        [pressed, pressed, (-bound, bound)]
    }

    /// Solves the problem with fixed bounds by projected Newton steps with a line search.
    fn descend(&mut self, tolerance: f64, count: &mut usize) {
        for joint in 0..self.impulses.len() {
            for (row, (least, most)) in self.limits(joint).into_iter().enumerate() {
                self.impulses[joint][row] = self.impulses[joint][row].clamp(least, most);
            }
        }
        let mut objective = self.objective_j();
        for _ in 0..BOUNDED_STEPS {
            // `objective_j` has set the rates for these impulses.
            let mut open = 0.0_f64;
            for joint in 0..self.impulses.len() {
                for (row, (least, most)) in self.limits(joint).into_iter().enumerate() {
                    let (impulse, rate) = (self.impulses[joint][row], self.rates[joint][row]);
                    let held = (impulse <= least && rate > 0.0) || (impulse >= most && rate < 0.0);
                    self.equations[joint][row] = if held || least >= most {
                        Equation::GivenImpulse(impulse)
                    } else {
                        open = open.max(rate.abs());
                        Equation::ZeroRate
                    };
                }
            }
            if open <= 0.1 * tolerance {
                break;
            }
            self.balance();
            *count += 1;
            let (start, slopes) = (self.impulses.clone(), self.rates.clone());
            let mut part = 1.0;
            loop {
                let mut slope = 0.0;
                for joint in 0..self.impulses.len() {
                    for (row, (least, most)) in self.limits(joint).into_iter().enumerate() {
                        let from = start[joint][row];
                        let to = from + part * (self.target[joint][row] - from);
                        self.impulses[joint][row] = to.clamp(least, most);
                        slope += slopes[joint][row] * (self.impulses[joint][row] - from);
                    }
                }
                let reached = self.objective_j();
                if reached <= objective + DESCENT * slope || part < LEAST_PART {
                    objective = reached;
                    break;
                }
                part *= 0.5;
            }
        }
    }

    /// Returns the objective of the problem with fixed bounds, in J, and sets the rates.
    fn objective_j(&mut self) -> f64 {
        self.find_rates();
        let mut twice = 0.0;
        for joint in 0..self.impulses.len() {
            let impulse = &self.impulses[joint];
            let proximal = self.proximal_rates(joint);
            twice += impulse.dot(&(self.rates[joint] + self.drive[joint] - proximal))
                + (impulse - self.before[joint]).dot(&proximal);
        }
        0.5 * twice
    }
}

/// Inverse of a matrix by cofactors.
fn inverse(m: &Matrix3<f64>) -> Matrix3<f64> {
    let cofactor = |a: f64, b: f64, c: f64, d: f64| a * d - b * c;
    let (c11, c12, c13) = (
        cofactor(m.m22, m.m23, m.m32, m.m33),
        cofactor(m.m23, m.m21, m.m33, m.m31),
        cofactor(m.m21, m.m22, m.m31, m.m32),
    );
    let scale = 1.0 / (m.m11 * c11 + m.m12 * c12 + m.m13 * c13);
    Matrix3::new(
        c11,
        cofactor(m.m13, m.m12, m.m33, m.m32),
        cofactor(m.m12, m.m13, m.m22, m.m23),
        c12,
        cofactor(m.m11, m.m13, m.m31, m.m33),
        cofactor(m.m13, m.m11, m.m23, m.m21),
        c13,
        cofactor(m.m12, m.m11, m.m32, m.m31),
        cofactor(m.m11, m.m12, m.m21, m.m22),
    ) * scale
}
