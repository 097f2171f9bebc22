//! Positions of an arch whose two parts meet again, from those that rounding or a straight step has parted.

use super::{Load, Program};
use crate::mechanics::blocks::Row;
use crate::mechanics::joints::Placement;

/// Below this part of the thickness of a joint the closure error is left alone.
const CLOSURE_RATIO: f64 = 1e-13;

/// Takes up closure errors, with all the memory that it needs.
#[derive(Clone, Debug)]
pub struct Closer {
    program: Program,
    none: Load,
    change: Vec<[f64; 2]>,
    backup: Placement,
    thinnest_m: f64,
}

impl Closer {
    /// For placements of a row.
    #[must_use]
    pub fn new(row: &Row) -> Self {
        let thicknesses = row.joints.iter().map(|joint| joint.thickness_m());
        Self {
            program: Program::new(row),
            none: Load::none(row),
            change: vec![[0.0; 2]; row.joints.len()],
            backup: Placement::new(row),
            thinnest_m: thicknesses.fold(f64::INFINITY, f64::min),
        }
    }

    /// Takes up the closure error by the open joints, in positions only, while that at least halves it: the displacement of
    /// least kinetic norm, as far as the first corner shuts. That one stays shut, and the others take up the rest.
    pub fn close(&mut self, placement: &mut Placement) {
        while let Some(closure) = placement.closure {
            let error_m = closure.error_m.norm();
            if error_m <= CLOSURE_RATIO * self.thinnest_m {
                return;
            }
            if !self.program.close(placement, &closure, &self.none) {
                return;
            }
            let first_shut = self.program.first_shut(placement, 1.0);
            (self.program).open_until(placement, first_shut, &mut self.change);
            self.backup.copy_from(placement);
            let change = &self.change;
            placement.open(|joint| change[joint]);
            if first_shut.1.is_none() && placement.closure_error() > 0.5 * error_m {
                placement.copy_from(&self.backup);
                return;
            }
        }
    }
}

/// How long open joints move, and the joint and the edge of the corner that shuts then.
pub(in crate::mechanics) type FirstShut = (f64, Option<(usize, usize)>);

impl Program {
    /// Time until a corner shuts with the last velocities, at most `longest`, and that corner.
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

    /// Changes of the gaps until then; the corner that shuts loses its whole gap.
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
