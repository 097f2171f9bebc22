//! Ties between bodies with elastic joints.

use nalgebra::Vector2;

use super::kinematics::{Action, Place, cross};
use crate::mechanics::blocks::Block;
use crate::mechanics::lanes::{Real, both};
use crate::mechanics::tie::{Tie, TieSpan};

/// A tie with the bodies that it holds on to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundTie {
    /// The tie.
    pub tie: Tie,
    /// The bodies at its ends; beyond the last one are the left support and the right one.
    pub bodies: [usize; 2],
    /// From their centres to its ends, in m; from the middle of its joint where that is a support.
    pub arms_m: [[f64; 2]; 2],
}

impl BoundTie {
    /// Of a row between these feet: the ground moves an end as it does the nearer one.
    pub(super) fn new(tie: Tie, blocks: &[Block], feet_m: [Vector2<f64>; 2]) -> Self {
        let body = |end: usize| {
            let anchor = &tie.ends[end];
            match anchor.block {
                Some(block) => (block, blocks[block].centre_m),
                None => {
                    let support = anchor.support(feet_m);
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

    /// Its line with its bodies at these places.
    #[inline(always)]
    #[must_use]
    pub fn span<R: Real>(&self, places: [&Place<R>; 2]) -> TieSpan<R> {
        let swings = both!(end: places[end].swing(self.arms_m[end]));
        let first = both!(i: places[0].moved_m[i] + swings[0][i]);
        let second = both!(i: places[1].moved_m[i] + swings[1][i]);
        self.tie.span([first, second])
    }

    /// The action of the tie on its bodies with this force.
    #[inline(always)]
    #[must_use]
    pub fn action<R: Real>(
        &self,
        places: [&Place<R>; 2],
        span: &TieSpan<R>,
        force_n: R,
    ) -> Action<R> {
        let pull = both!(i: span.along[i] * -force_n);
        let swings = both!(end: places[end].swing(self.arms_m[end]));
        let first = both!(i: swings[0][i] + R::of(self.arms_m[0][i]));
        let second = both!(i: swings[1][i] + R::of(self.arms_m[1][i]));
        Action {
            force_n: pull,
            moments_n_m: [-cross(first, pull), cross(second, pull)],
        }
    }
}
