//! Coulomb's law at all joints as a linear complementarity problem, the last resort.

use nalgebra::{DMatrix, Vector3};

use super::pins::{PASSES, PROXIMAL, PinProgram};
use super::{JointMode, TangentialMode};
use crate::mechanics::complementarity;

/// Maximum number of joints for Lemke's method; its effort grows with their cube.
const COMPLEMENTED: usize = 80;

impl PinProgram {
    /// Finds modes and impulses by Lemke's method. Returns false if the row has too many joints, or if the method fails.
    pub(super) fn solve_by_pivoting(&mut self, tolerance: f64, passes: &mut usize) -> bool {
        if self.modes.len() > COMPLEMENTED || !self.complement() {
            return false;
        }
        let modes = self.modes.clone();
        if !self.newton(PASSES, false, tolerance, passes) {
            // Modes at a transition do not converge in Newton's method, but the impulses are right.
            self.impulses.copy_from_slice(&self.kept);
            self.modes = modes;
        }
        true
    }

    /// Finds the modes by Lemke's method. Normal impulses are complementary to the rates of the ends. Friction in each direction is complementary to
    /// a speed `g` plus or minus the rate along the joint, and `g` to the slack of the friction bound. Returns false if the method fails.
    pub(super) fn complement(&mut self) -> bool {
        const SIZE: usize = 5;
        let joints = self.own.len();
        let n = SIZE * joints;
        // Coordinate of the joint that an unknown belongs to, and sign; `None` for the speed.
        let part = |unknown: usize| match unknown % SIZE {
            row @ 0..=2 => Some((row, 1.0)),
            3 => Some((2, -1.0)),
            _ => None,
        };
        let root = |joint: usize, row: usize| self.own[joint][(row, row)].sqrt();
        let mut matrix = DMatrix::zeros(n, n);
        let mut constant = vec![0.0; n];
        for joint in 0..joints {
            for unknown in SIZE * joint..SIZE * (joint + 1) {
                let Some((row, sign)) = part(unknown) else {
                    let along = root(joint, 2);
                    for end in 0..2 {
                        matrix[(unknown, SIZE * joint + end)] =
                            self.coefficient * along / root(joint, end);
                    }
                    for side in [2, 3] {
                        matrix[(unknown, SIZE * joint + side)] = -1.0;
                        matrix[(SIZE * joint + side, unknown)] = 1.0;
                    }
                    continue;
                };
                let proximal = PROXIMAL * self.own[joint][(row, row)] * self.before[joint][row];
                constant[unknown] = sign * (self.drive[joint][row] - proximal) / root(joint, row);
                let near = [
                    joint
                        .checked_sub(1)
                        .map(|other| (other, self.next[other].transpose())),
                    Some((joint, self.own[joint])),
                    Some((joint + 1, self.next[joint])).filter(|(other, _)| *other < joints),
                ];
                for (other, compliance) in near.into_iter().flatten() {
                    for column in SIZE * other..SIZE * (other + 1) {
                        if let Some((other_row, other_sign)) = part(column) {
                            let own = other == joint && other_row == row;
                            let entry = compliance[(row, other_row)]
                                * if own { 1.0 + PROXIMAL } else { 1.0 };
                            matrix[(unknown, column)] = sign * other_sign * entry
                                / (root(joint, row) * root(other, other_row));
                        }
                    }
                }
            }
        }
        let Some(solution) = complementarity::solve(&matrix, &constant) else {
            return false;
        };
        for (joint, found) in solution.chunks(SIZE).enumerate() {
            let tangential = match (found[4] > 0.0, found[2] > found[3]) {
                (false, _) => TangentialMode::Stick,
                (true, true) => TangentialMode::Slip(1.0),
                (true, false) => TangentialMode::Slip(-1.0),
            };
            self.modes[joint] = JointMode {
                pressed: [found[0] > 0.0, found[1] > 0.0],
                tangential,
            }
            .settled();
            let impulse = Vector3::new(found[0], found[1], found[2] - found[3]);
            self.kept[joint] = impulse.component_div(&self.own[joint].diagonal().map(f64::sqrt));
        }
        true
    }
}
