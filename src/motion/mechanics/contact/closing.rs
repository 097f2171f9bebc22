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
            let shuts = self.closing_change(placement);
            self.backup.copy_from(placement);
            let change = &self.change;
            placement.open(|joint| change[joint]);
            if !shuts && placement.closure_error() > 0.5 * error_m {
                placement.copy_from(&self.backup);
                return;
            }
        }
    }

    /// Changes of the gaps by the solution of the closure, as far as the first corner shuts; whether one does.
    fn closing_change(&mut self, placement: &Placement) -> bool {
        let gaps_m = &placement.gaps_m;
        let mut first = (1.0, None);
        for (joint, changes) in self.program.open_joints() {
            for edge in 0..2 {
                let (gap, change) = (gaps_m[joint][edge], changes[edge]);
                if gap > 0.0 && gap + first.0 * change < 0.0 {
                    first = (gap / -change, Some((joint, edge)));
                }
            }
        }
        self.change.fill([0.0; 2]);
        for (joint, changes) in self.program.open_joints() {
            self.change[joint] = changes.map(|change| change * first.0);
        }
        if let Some((joint, edge)) = first.1 {
            self.change[joint][edge] = -gaps_m[joint][edge];
        }
        first.1.is_some()
    }
}
