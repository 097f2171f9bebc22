//! Removal of the closure error: the gap between the two parts of an arch due to rounding errors or a linear step.

use super::{ContactProgram, Load};
use crate::mechanics::{Placement, Row};

/// Tolerance of the closure error, relative to the thickness of the thinnest joint.
const CLOSURE_RATIO: f64 = 1e-13;

/// Solver that removes closure errors, with its work space.
#[derive(Clone, Debug)]
pub struct ClosureSolver {
    program: ContactProgram,
    none: Load,
    change: Vec<[f64; 2]>,
    backup: Placement,
    thinnest_m: f64,
}

impl ClosureSolver {
    /// Solver for placements of a row.
    pub fn new(row: &Row) -> Self {
        let thicknesses = row.joints.iter().map(|joint| joint.thickness_m());
        Self {
            program: ContactProgram::new(row),
            none: Load::none(row),
            change: vec![[0.0; 2]; row.joints.len()],
            backup: Placement::new(row),
            thinnest_m: thicknesses.fold(f64::INFINITY, f64::min),
        }
    }

    /// Removes the closure error by displacements at the open joints, without velocities. Each step is the displacement of least kinetic norm, up to
    /// the first closing corner; that corner stays closed in the next step. The steps stop if a step without a closing corner does not halve the
    /// error.
    pub fn remove_closure_error(&mut self, placement: &mut Placement) {
        while let Some(closure) = placement.closure {
            let error_m = closure.error_m.norm();
            if error_m <= CLOSURE_RATIO * self.thinnest_m {
                return;
            }
            if !self
                .program
                .compute_closing(placement, &closure, &self.none)
            {
                return;
            }
            let first_shut = self.program.first_shut(placement, 1.0);
            (self.program).open_until(placement, first_shut, &mut self.change);
            self.backup.copy_from(placement);
            let change = &self.change;
            placement.change_gaps(|joint| change[joint]);
            if first_shut.1.is_none() && placement.closure_error() > 0.5 * error_m {
                placement.copy_from(&self.backup);
                return;
            }
        }
    }
}

/// Time until the first corner closes, and the joint and edge of that corner; `None` if no corner closes before the end of the step.
pub(in crate::mechanics) type FirstShut = (f64, Option<(usize, usize)>);

impl ContactProgram {
    /// Time until the first corner closes with the last velocities, at most `longest`, and that corner.
    pub(in crate::mechanics) fn first_shut(
        &self,
        placement: &Placement,
        longest: f64,
    ) -> FirstShut {
        let mut first = (longest, None);
        for (joint, rates) in self.open_joints() {
            for (edge, rate) in rates.into_iter().enumerate() {
                let gap = placement.gaps_m[joint][edge];
                if gap > 0.0 && gap + first.0 * rate < 0.0 {
                    first = (-gap / rate, Some((joint, edge)));
                }
            }
        }
        first
    }

    /// Writes the changes of all gaps until the first corner closes. That corner loses its whole gap.
    pub(in crate::mechanics) fn open_until(
        &self,
        placement: &Placement,
        (length, shut): FirstShut,
        change_m: &mut [[f64; 2]],
    ) {
        change_m.fill([0.0; 2]);
        for (joint, rates) in self.open_joints() {
            change_m[joint] = rates.map(|rate| rate * length);
        }
        if let Some((joint, edge)) = shut {
            change_m[joint][edge] = -placement.gaps_m[joint][edge];
        }
    }
}
