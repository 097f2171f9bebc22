//! Ties between bodies with elastic joints.

use nalgebra::Vector2;

use super::kinematics::{Action, BodyPosition, cross};
use crate::mechanics::lanes::both;
use crate::mechanics::tie::TieSpan;
use crate::mechanics::{Block, Real, Tie};

/// Tie with the bodies at its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundTie {
    /// Properties of the tie.
    pub tie: Tie,
    /// Indices of the bodies at its ends; the left and the right support follow after the last body.
    pub bodies: [usize; 2],
    /// Vectors from the centres of the bodies to the ends of the tie, in m; from the middle of its joint for a support.
    pub arms_m: [[f64; 2]; 2],
}

impl BoundTie {
    /// Tie of a row with given feet. An end in the ground moves with the nearer support.
    pub(super) fn new(tie: Tie, blocks: &[Block], feet_m: [Vector2<f64>; 2]) -> Self {
        let body = |end: usize| {
            let anchor = &tie.ends[end];
            match anchor.block {
                Some(block) => (block, blocks[block].centre_m),
                None => {
                    // The second end of a constant force is at no support: the left one receives no force in any result.
                    let support = match tie.is_constant_force() {
                        true => 0,
                        false => anchor.support(feet_m),
                    };
                    (blocks.len() + support, feet_m[support])
                }
            }
        };
        let bodies = [0, 1].map(body);
        let arm = |end: usize| {
            let arm_m = tie.ends[end].at_m - bodies[end].1;
            [arm_m.x, arm_m.y]
        };
        Self {
            bodies: bodies.map(|(body, _)| body),
            arms_m: [arm(0), arm(1)],
            tie,
        }
    }

    /// Length, stretch and direction of the tie for given positions of its bodies.
    #[inline(always)]
    pub fn span<R: Real>(&self, places: [&BodyPosition<R>; 2]) -> TieSpan<R> {
        let swings = both!(end: places[end].swing(self.arms_m[end]));
        let first = both!(i: places[0].moved_m[i] + swings[0][i]);
        let second = both!(i: places[1].moved_m[i] + swings[1][i]);
        self.tie.span([first, second])
    }

    /// Forces of the tie on its bodies for a given tie force.
    #[inline(always)]
    pub fn action<R: Real>(
        &self,
        places: [&BodyPosition<R>; 2],
        span: &TieSpan<R>,
        force_n: R,
    ) -> Action<R> {
        let pull = both!(i: span.direction[i] * -force_n);
        let swings = both!(end: places[end].swing(self.arms_m[end]));
        let first = both!(i: swings[0][i] + R::of(self.arms_m[0][i]));
        let second = both!(i: swings[1][i] + R::of(self.arms_m[1][i]));
        Action {
            force_n: pull,
            moments_n_m: [-cross(first, pull), cross(second, pull)],
        }
    }
}
