//! Coulomb's law at every joint by an interior-point method.
//!
//! The unknowns of a joint are `N_I`, `N_E`, friction `T+` and `T-` to either side, and a speed `g`. They are complementary, in this
//! order, to the rates of the two ends, `g + u_T` and `g - u_T`, and what is left of the bound, `mu (N_I + N_E) - T+ - T-`. All are
//! kept positive. Newton's method brings their products down together, to a target that shrinks with the errors of the equations. Slip
//! and speed are eliminated by hand, so that a step costs one elimination along the row. On the way the modes that the numbers point to
//! are tried. Where they confirm themselves the law holds exactly, and rounding, which the equations magnify more and more, no longer
//! matters.
//!
//! The problem is not monotone, and convergence is not proved. The method solved what the bounds did not, in 20 to 40 steps.

use nalgebra::{Matrix3, RowVector3, Vector3};

use super::{Along, Balance, Mode, PASSES, Program};

const STEPS: usize = 60;
/// The modes are tried when the products have fallen to these fractions of the first ones.
const TRIED: [f64; 3] = [1e-4, 1e-7, 1e-10];
/// Impulses to start from, over the expected ones, tried one after the other.
const STARTS: [f64; 3] = [1.0, 3.0, 10.0];
/// Rates to start from, over the largest rate with the impulses unchanged.
const START_RATE: f64 = 0.1;
/// A step goes this fraction of the way to where the first number vanishes.
const REACH: f64 = 0.99;
/// Products do not shrink below this fraction of what the errors of the equations have shrunk to.
const FLOOR: f64 = 0.3;
/// Products are zero below this fraction of tolerance times impulse, ...
const ZERO_PRODUCT: f64 = 1e-2;
/// ... and what is left of a bound agrees to within this fraction of the impulse.
const SAME_BOUND: f64 = 1e-10;

/// Numbers of a joint that stay positive, and their complements.
#[derive(Clone, Copy)]
struct Pairs {
    own: [f64; 5],
    other: [f64; 5],
}

/// A step of the unknowns of a joint from which slip and speed have been eliminated.
#[derive(Clone, Copy)]
struct Eliminated {
    /// Changes of the friction to either side, and of the speed, without a change of the rate and the pressure.
    constant: [f64; 3],
    /// Derivative of friction to either side by the slip.
    yielding: [f64; 2],
    /// Derivative of the speed by the bound.
    following: f64,
}

impl Pairs {
    /// Errors of the equations between them, at the given rates of the joint.
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

    /// Newton's equations for the three impulses of the joint, to be added to its compliance: matrix, right side, and what
    /// recovers the eliminated unknowns.
    fn eliminated(
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

    /// The changes that belong to changes of the impulses and of the rate along the joint.
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

    /// Largest part of a change before one of the numbers vanishes.
    fn room(&self, change: &Self) -> f64 {
        let own = self.own.iter().zip(&change.own);
        let pairs = own.chain(self.other.iter().zip(&change.other));
        let falling = pairs.filter(|(_, change)| **change < 0.0);
        let rooms = falling.map(|(value, change)| -value / change);
        rooms.fold(f64::INFINITY, f64::min)
    }

    fn go(&mut self, change: &Self, part: f64) {
        for pair in 0..5 {
            self.own[pair] += part * change.own[pair];
            self.other[pair] += part * change.other[pair];
        }
    }

    fn impulse(&self) -> Vector3<f64> {
        Vector3::new(self.own[0], self.own[1], self.own[2] - self.own[3])
    }

    /// The mode of the joint; its compliance converts impulses to rates, to compare the two.
    fn mode(&self, compliance: &Vector3<f64>) -> Mode {
        let (own, other) = (self.own, self.other);
        let pressed = [0, 1].map(|end| own[end] * compliance[end] > other[end]);
        let along = if own[4] < other[4] * compliance.z {
            Along::Stick
        } else {
            Along::Slip((own[2] - own[3]).signum())
        };
        Mode { pressed, along }.settled()
    }
}

impl Program {
    /// Modes and impulses by Coulomb's law; false where no start leads to them.
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
        // Mean of the products, and the errors, at the start.
        let mut first: Option<[f64; 2]> = None;
        let mut centring = 0.5;
        let mut tried = TRIED.iter().peekable();
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
                // Modes on the verge of others do not confirm themselves, but the impulses are right.
                self.take_interior(&pairs);
                self.impulses.copy_from_slice(&self.kept);
                return true;
            }
            let floor = FLOOR * mean_first * (wrong / wrong_first).min(1.0);
            let target = (centring * mean).max(floor).min(2.0 * mean);
            *passes += 1;
            let part = self.go_towards(target, &errors, &mut pairs);
            centring = match part {
                0.9.. => 0.03,
                0.5.. => 0.2,
                0.1.. => 0.5,
                _ => 0.9,
            };
        }
        false
    }

    /// Takes the largest part of a Newton step that keeps all numbers positive, and returns that part.
    fn go_towards(&mut self, target: f64, errors: &[[f64; 5]], pairs: &mut [Pairs]) -> f64 {
        let coefficient = self.coefficient;
        let joints = pairs.iter().zip(errors);
        let eliminated =
            joints.map(|(pairs, errors)| pairs.eliminated(errors, target, coefficient));
        let eliminated: Vec<_> = eliminated.collect();
        self.sweep(|program, joint| {
            let (matrix, right, _) = &eliminated[joint];
            let mut matrix = program.own[joint] + matrix;
            for row in 0..3 {
                matrix[(row, row)] += program.proximal(joint, row);
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
            // Computed from the changes themselves: the difference of two rates is only rounding in the end.
            let slip = self.response(joint, &self.target).z + self.proximal(joint, 2) * change.z;
            let rest = &eliminated[joint].2;
            pairs[joint].changes(rest, &errors[joint], target, coefficient, (change, slip))
        });
        let changes: Vec<Pairs> = changes.collect();
        let rooms = pairs.iter().zip(&changes);
        let parts = rooms.map(|(pairs, change)| REACH * pairs.room(change));
        let part = parts.fold(1.0, f64::min);
        for (pairs, change) in pairs.iter_mut().zip(&changes) {
            pairs.go(change, part);
        }
        part
    }

    /// Takes over the modes, and impulses that they allow.
    fn take_interior(&mut self, pairs: &[Pairs]) {
        for (joint, pairs) in pairs.iter().enumerate() {
            let mode = pairs.mode(&self.own[joint].diagonal());
            let mut impulse = pairs.impulse();
            for end in 0..2 {
                if !mode.pressed[end] {
                    impulse[end] = 0.0;
                }
            }
            match mode.along {
                Along::Free => impulse.z = 0.0,
                Along::Stick => {}
                Along::Slip(sign) => impulse.z = sign * self.coefficient * (impulse.x + impulse.y),
            }
            self.modes[joint] = mode;
            self.kept[joint] = impulse;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::blocks::Row;
    use crate::mechanics::geometry::ring::Ring;
    use crate::mechanics::slip::{Contact, Faces, Position};

    /// The largest rate by which a solution breaks the law; impulses count as the rates that they cause.
    fn breach(program: &Program) -> f64 {
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
            // Friction must not drive a slip, and may leave none that it could stop.
            let driven = (rate.z * impulse.z.signum()).min(impulse.z.abs() * scale.z);
            let slip = driven.max((left * scale.z).min(rate.z.abs()));
            end(0).max(end(1)).max(-left * scale.z).max(slip)
        });
        breaches.fold(0.0, f64::max)
    }

    /// An arch at rest is hit: its blocks get velocities of about 1 m/s that do not fit together. The solution obeys the law. Lemke's
    /// method, an independent one, finds the same velocities, to within its rounding and the proximal term, 1e-6. The exception is where
    /// the law has several solutions, as it may with friction, and each method finds one.
    #[test]
    fn it_finds_what_lemkes_method_finds() {
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
            let contacts: Vec<Contact> = (0..faces.len())
                .map(|joint| {
                    let left = at(joint.checked_sub(1)).unwrap_or(&Position::HELD);
                    faces[joint].contact(left, at(Some(joint)).unwrap_or(&Position::HELD))
                })
                .collect();
            let mut program = Program::new(&row, 0.5 + 0.2 * random());
            program.place(&faces, &contacts, &positions);
            let motions: Vec<Vector3<f64>> = positions
                .iter()
                .map(|_| Vector3::new(random(), random() - 0.5, 0.2 * random()))
                .collect();
            program.load(|block| motions[block]);
            for joint in 0..faces.len() {
                program.drive[joint] = program.rate(joint, &program.free);
            }
            let mut other = program.clone();
            assert!(program.interior(1e-9, &mut 0), "{case}");
            assert!(other.complement(), "{case}");
            assert!(breach(&program) < 1e-8, "{case} {}", breach(&program));
            other.impulses.copy_from_slice(&other.kept);
            other.find_rates();
            assert!(breach(&other) < 1e-6, "{case} {}", breach(&other));
            program.set_velocities();
            other.set_velocities();
            let miss = |block| (program.velocity(block) - other.velocity(block)).norm();
            let miss = (0..positions.len()).map(miss).fold(0.0, f64::max);
            same += usize::from(miss < 1e-4);
            let modes = program.modes;
            slipping += modes
                .iter()
                .filter(|mode| matches!(mode.along, Along::Slip(_)))
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
