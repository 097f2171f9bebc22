//! Interior-point method for Coulomb's law at all joints.
//!
//! The unknowns of a joint are `N_I`, `N_E`, friction `T+` and `T-` in both directions, and a speed `g`. In this order they are complementary to the
//! rates of the two ends, to `g + u_T` and `g - u_T`, and to the slack of the friction bound, `mu (N_I + N_E) - T+ - T-`. All variables stay
//! positive. Newton's method reduces all complementary products to a common target, which decreases with the residuals. Friction and speed are
//! eliminated analytically, so a step costs one elimination along the row. At intervals the modes suggested by the variables are tested by Newton's
//! method on the modes. If they converge, Coulomb's law holds exactly, and the growing rounding errors of the interior-point method have no effect.
//!
//! The problem is not monotone, so convergence is not guaranteed. The method has solved the problems in which the friction bounds did not converge,
//! in 20 to 40 steps.

use nalgebra::{Matrix3, RowVector3, Vector3};

use super::pins::{Balance, PASSES, PinProgram};
use super::{JointMode, TangentialMode};

const STEPS: usize = 60;
/// Mean products, relative to the first one, at which the modes are tested.
const TESTED_PRODUCTS: [f64; 3] = [1e-4, 1e-7, 1e-10];
/// Initial impulses relative to the expected ones, tried in turn.
const STARTS: [f64; 3] = [1.0, 3.0, 10.0];
/// Initial rates relative to the largest rate for unchanged impulses.
const START_RATE: f64 = 0.1;
/// Step length relative to the step at which the first variable becomes zero.
const REACH: f64 = 0.99;
/// Lower bound of the target of the products, relative to the reduction of the residuals.
const FLOOR: f64 = 0.3;
/// Tolerance for products, relative to tolerance times impulse.
const ZERO_PRODUCT: f64 = 1e-2;
/// Tolerance for the slack of a friction bound, relative to the impulse.
const SAME_BOUND: f64 = 1e-10;

/// Positive variables of a joint, and their complementary variables.
#[derive(Clone, Copy)]
struct Pairs {
    own: [f64; 5],
    other: [f64; 5],
}

/// Newton step of a joint with friction and speed eliminated.
#[derive(Clone, Copy)]
struct Eliminated {
    /// Changes of friction in both directions and of the speed, for constant rate and normal impulses.
    constant: [f64; 3],
    /// Magnitudes of the derivatives of friction in both directions by the slip; the first derivative is negative.
    yielding: [f64; 2],
    /// Minus the derivative of the speed by the friction bound.
    following: f64,
}

impl Pairs {
    /// Residuals of the equations between the variables, for given rates of the joint.
    fn errors(&self, rate: &Vector3<f64>, coefficient: f64) -> [f64; 5] {
        let ([intrados, extrados, plus, minus, speed], other) = (self.own, self.other);
        [
            rate.x - other[0],
            rate.y - other[1],
            speed + rate.z - other[2],
            speed - rate.z - other[3],
            coefficient * (intrados + extrados) - plus - minus - other[4],
        ]
    }

    fn products(&self) -> impl Iterator<Item = f64> {
        let pairs = self.own.into_iter().zip(self.other);
        pairs.map(|(own, other)| own * other)
    }

    /// Newton equations for the three impulses of the joint, to be added to its compliance: matrix, right-hand side, and the data to
    /// recover the eliminated unknowns.
    fn newton_equations(
        &self,
        errors: &[f64; 5],
        target: f64,
        coefficient: f64,
    ) -> (Matrix3<f64>, Vector3<f64>, Eliminated) {
        let ([_, _, plus, minus, speed], other) = (self.own, self.other);
        let change = |pair: usize| target / self.own[pair] - other[pair] - errors[pair];
        let yielding = [plus / other[2], minus / other[3]];
        let [p, m] = yielding;
        let pushed = [
            target / other[2] - plus - p * errors[2],
            target / other[3] - minus - m * errors[3],
        ];
        let stiff = other[4] / speed;
        let following = 1.0 / (stiff + p + m);
        let sped = following * (target / speed - other[4] + pushed[0] + pushed[1] - errors[4]);
        let slack = following * ((p + m) * stiff + 4.0 * p * m);
        let lean = (p - m) * following * coefficient / slack;
        let mut matrix = Matrix3::zeros();
        matrix[(0, 0)] = other[0] / self.own[0];
        matrix[(1, 1)] = other[1] / self.own[1];
        matrix.set_row(2, &RowVector3::new(-lean, -lean, 1.0 / slack));
        let along = (pushed[0] - pushed[1] - (p - m) * sped) / slack;
        let right = Vector3::new(change(0), change(1), along);
        let rest = Eliminated {
            constant: [pushed[0], pushed[1], sped],
            yielding,
            following,
        };
        (matrix, right, rest)
    }

    /// Changes of all variables for given changes of the impulses and of the rate along the joint.
    fn changes(
        &self,
        rest: &Eliminated,
        errors: &[f64; 5],
        target: f64,
        coefficient: f64,
        (impulse, slip): (&Vector3<f64>, f64),
    ) -> Self {
        let [p, m] = rest.yielding;
        let pressure = coefficient * (impulse.x + impulse.y);
        let speed = rest.constant[2] - rest.following * (pressure + (p - m) * slip);
        let plus = rest.constant[0] - p * (speed + slip);
        let minus = rest.constant[1] - m * (speed - slip);
        let rate = |pair: usize, change: f64| {
            (target - self.other[pair] * change) / self.own[pair] - self.other[pair]
        };
        Self {
            own: [impulse.x, impulse.y, plus, minus, speed],
            other: [
                rate(0, impulse.x),
                rate(1, impulse.y),
                speed + slip + errors[2],
                speed - slip + errors[3],
                pressure - plus - minus + errors[4],
            ],
        }
    }

    /// Largest fraction of a change that keeps all variables positive.
    fn largest_part(&self, change: &Self) -> f64 {
        let own = self.own.iter().zip(&change.own);
        let pairs = own.chain(self.other.iter().zip(&change.other));
        let falling = pairs.filter(|(_, change)| **change < 0.0);
        let parts = falling.map(|(value, change)| -value / change);
        parts.fold(f64::INFINITY, f64::min)
    }

    fn advance(&mut self, change: &Self, part: f64) {
        for pair in 0..5 {
            self.own[pair] += part * change.own[pair];
            self.other[pair] += part * change.other[pair];
        }
    }

    fn impulse(&self) -> Vector3<f64> {
        Vector3::new(self.own[0], self.own[1], self.own[2] - self.own[3])
    }

    /// Mode of the joint. The compliance converts impulses to rates for the comparison.
    fn mode(&self, compliance: &Vector3<f64>) -> JointMode {
        let (own, other) = (self.own, self.other);
        let pressed = [0, 1].map(|end| own[end] * compliance[end] > other[end]);
        let tangential = if own[4] < other[4] * compliance.z {
            TangentialMode::Stick
        } else {
            TangentialMode::Slip((own[2] - own[3]).signum())
        };
        JointMode {
            pressed,
            tangential,
        }
        .settled()
    }
}

impl PinProgram {
    /// Finds modes and impulses by Coulomb's law. Returns false if no start converges.
    pub(super) fn interior(&mut self, tolerance: f64, passes: &mut usize) -> bool {
        let mut starts = STARTS.iter();
        starts.any(|start| self.interior_from(*start, tolerance, passes))
    }

    fn interior_from(&mut self, start: f64, tolerance: f64, passes: &mut usize) -> bool {
        let joints = self.own.len();
        let count = joints as f64;
        self.impulses.copy_from_slice(&self.before);
        self.find_rates();
        let fastest = self.rates.iter().map(Vector3::amax).fold(0.0, f64::max);
        let pressure = |impulse: &Vector3<f64>| impulse.x.max(0.0) + impulse.y.max(0.0);
        let mean = self.before.iter().map(pressure).sum::<f64>() / count;
        let compliance = self.own.iter().map(|own| own.m11).sum::<f64>() / count;
        let impulse = start * (mean + fastest / compliance);
        let rate = START_RATE * fastest + 1e3 * tolerance;
        let bound = self.coefficient * impulse;
        let (half, quarter) = (0.5 * impulse, 0.25 * bound);
        let pair = Pairs {
            own: [half, half, quarter, quarter, rate],
            other: [rate, rate, rate, rate, 0.5 * bound],
        };
        let mut pairs = vec![pair; joints];
        let mut errors = vec![[0.0; 5]; joints];
        // Mean product and residual at the start.
        let mut first: Option<[f64; 2]> = None;
        let mut centring = 0.5;
        let mut tried = TESTED_PRODUCTS.iter().peekable();
        for _ in 0..STEPS {
            for (impulse, pairs) in self.impulses.iter_mut().zip(&pairs) {
                *impulse = pairs.impulse();
            }
            self.find_rates();
            let (mut off, mut unbound) = (0.0_f64, 0.0_f64);
            for ((errors, pairs), rate) in errors.iter_mut().zip(&pairs).zip(&self.rates) {
                *errors = pairs.errors(rate, self.coefficient);
                let rates = errors[..4].iter();
                off = rates.fold(off, |off, error| off.max(error.abs()));
                unbound = unbound.max(errors[4].abs() / impulse);
            }
            let products = || pairs.iter().flat_map(Pairs::products);
            let largest = products().fold(0.0, f64::max);
            let mean = products().sum::<f64>() / (5.0 * count);
            let wrong = off / rate + unbound;
            let [mean_first, wrong_first] = *first.get_or_insert([mean, wrong]);
            let found = largest < ZERO_PRODUCT * tolerance * impulse
                && off < tolerance
                && unbound < SAME_BOUND;
            if found || tried.next_if(|part| mean < **part * mean_first).is_some() {
                self.take_interior(&pairs);
                if self.newton(PASSES, false, tolerance, passes) {
                    return true;
                }
            }
            if found {
                // Modes at a transition do not converge in Newton's method, but the impulses are right.
                self.take_interior(&pairs);
                self.impulses.copy_from_slice(&self.kept);
                return true;
            }
            let floor = FLOOR * mean_first * (wrong / wrong_first).min(1.0);
            let target = (centring * mean).max(floor).min(2.0 * mean);
            *passes += 1;
            let part = self.step_towards(target, &errors, &mut pairs);
            centring = match part {
                0.9.. => 0.03,
                0.5.. => 0.2,
                0.1.. => 0.5,
                _ => 0.9,
            };
        }
        false
    }

    /// Takes the largest fraction of a Newton step that keeps all variables positive, and returns this fraction.
    fn step_towards(&mut self, target: f64, errors: &[[f64; 5]], pairs: &mut [Pairs]) -> f64 {
        let coefficient = self.coefficient;
        let joints = pairs.iter().zip(errors);
        let eliminated: Vec<_> = joints
            .map(|(pairs, errors)| pairs.newton_equations(errors, target, coefficient))
            .collect();
        self.sweep(|program, joint| {
            let (matrix, right, _) = &eliminated[joint];
            let mut matrix = program.own[joint] + matrix;
            for row in 0..3 {
                matrix[(row, row)] += program.proximal_term(joint, row);
            }
            Balance {
                matrix,
                coupling: program.coupling(joint),
                onward: program.next[joint],
                right: *right,
            }
        });
        let changes = (0..pairs.len()).map(|joint| {
            let change = &self.target[joint];
            // Computed from the changes: a difference of two rates would have too large rounding errors near convergence.
            let slip =
                self.response(joint, &self.target).z + self.proximal_term(joint, 2) * change.z;
            let rest = &eliminated[joint].2;
            pairs[joint].changes(rest, &errors[joint], target, coefficient, (change, slip))
        });
        let changes: Vec<Pairs> = changes.collect();
        let parts = pairs
            .iter()
            .zip(&changes)
            .map(|(pairs, change)| REACH * pairs.largest_part(change));
        let part = parts.fold(1.0, f64::min);
        for (pairs, change) in pairs.iter_mut().zip(&changes) {
            pairs.advance(change, part);
        }
        part
    }

    /// Sets the modes, and impulses consistent with them.
    fn take_interior(&mut self, pairs: &[Pairs]) {
        for (joint, pairs) in pairs.iter().enumerate() {
            let mode = pairs.mode(&self.own[joint].diagonal());
            let mut impulse = pairs.impulse();
            for end in 0..2 {
                if !mode.pressed[end] {
                    impulse[end] = 0.0;
                }
            }
            match mode.tangential {
                TangentialMode::Free => impulse.z = 0.0,
                TangentialMode::Stick => {}
                TangentialMode::Slip(sign) => {
                    impulse.z = sign * self.coefficient * (impulse.x + impulse.y)
                }
            }
            self.modes[joint] = mode;
            self.kept[joint] = impulse;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::SlipProgram;
    use super::*;
    use crate::mechanics::blocks::Row;
    use crate::mechanics::geometry::ring::Ring;
    use crate::mechanics::slip::{FaceContact, Faces, Position};

    /// Largest violation of Coulomb's law, as a rate; impulses count as the rates that they cause.
    fn largest_violation(program: &PinProgram) -> f64 {
        let joints = program
            .impulses
            .iter()
            .zip(&program.rates)
            .zip(&program.own);
        let breaches = joints.map(|((impulse, rate), own)| {
            let scale = own.diagonal();
            let end = |end: usize| {
                let impulse = impulse[end] * scale[end];
                (-impulse).max(-rate[end]).max(impulse.min(rate[end]))
            };
            let left = program.coefficient * (impulse.x + impulse.y) - impulse.z.abs();
            // Friction must not act along the slip, and must not allow a slip that it could prevent.
            let driven = (rate.z * impulse.z.signum()).min(impulse.z.abs() * scale.z);
            let slip = driven.max((left * scale.z).min(rate.z.abs()));
            end(0).max(end(1)).max(-left * scale.z).max(slip)
        });
        breaches.fold(0.0, f64::max)
    }

    /// The blocks of an arch at rest get incompatible velocities of about 1 m/s. The solution satisfies Coulomb's law. Lemke's method, which is
    /// independent, finds the same velocities within rounding error and the proximal term, 1e-6. With friction the law may have several solutions;
    /// both methods may then find different ones.
    #[test]
    fn velocities_are_those_of_lemkes_method() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let part = (state >> 11) as f64 / (1_u64 << 53) as f64;
            2.0 * part - 1.0
        };
        let ring = Ring::new(0.15, 2.7).unwrap();
        let (mut slipping, mut open, mut same) = (0, 0, 0);
        for case in 0..60 {
            let row = Row::arch(&ring, 4 + case % 9, 10.0, 1.0, 2000.0).unwrap();
            let faces = Faces::of_row(&row);
            let positions: Vec<Position> = row
                .blocks
                .iter()
                .map(|block| Position::new(block.centre_m, 0.0))
                .collect();
            let at = |block: Option<usize>| block.and_then(|block| positions.get(block));
            let contacts: Vec<FaceContact> = (0..faces.len())
                .map(|joint| {
                    let left = at(joint.checked_sub(1)).unwrap_or(&Position::HELD);
                    faces[joint].contact(left, at(Some(joint)).unwrap_or(&Position::HELD))
                })
                .collect();
            let mut program = SlipProgram::new(&row, 0.5 + 0.2 * random());
            program.set_positions(&faces, &contacts, &positions);
            let motions: Vec<Vector3<f64>> = positions
                .iter()
                .map(|_| Vector3::new(random(), random() - 0.5, 0.2 * random()))
                .collect();
            program.load(|block| motions[block]);
            program.set_pins(true);
            let mut row = program;
            let mut program = row.program.clone();
            let mut other = program.clone();
            assert!(program.interior(1e-9, &mut 0), "{case}");
            assert!(other.complement(), "{case}");
            // Newton's passes leave out the rates of joints that stick.
            program.find_rates();
            assert!(
                largest_violation(&program) < 1e-8,
                "{case} {}",
                largest_violation(&program)
            );
            other.impulses.copy_from_slice(&other.kept);
            other.find_rates();
            assert!(
                largest_violation(&other) < 1e-6,
                "{case} {}",
                largest_violation(&other)
            );
            let mut velocities = |solved: &PinProgram| {
                row.set_pins(true);
                row.program.impulses.copy_from_slice(&solved.impulses);
                row.read_pins();
                row.velocities.clone()
            };
            let (found, judge) = (velocities(&program), velocities(&other));
            let miss = |block: usize| (found[block] - judge[block]).norm();
            let miss = (0..positions.len()).map(miss).fold(0.0, f64::max);
            same += usize::from(miss < 1e-4);
            let modes = program.modes;
            slipping += modes
                .iter()
                .filter(|mode| matches!(mode.tangential, TangentialMode::Slip(_)))
                .count();
            open += modes
                .iter()
                .filter(|mode| mode.pressed != [true; 2])
                .count();
        }
        assert!(slipping > 60 && open > 60, "{slipping} {open}");
        assert!(same >= 58, "{same}");
    }
}
