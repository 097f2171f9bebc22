//! Active-set search by exchanges of many corners at once.

use super::{ContactProgram, DEPENDENCE, higher_number, pivot_exceeds};
use crate::mechanics::Corners;

/// Number of exchanges without progress before only the worst corners are exchanged; after as many again the dual method takes over.
const EXCHANGE_PATIENCE: usize = 30;
/// Tolerance for tensile corner impulses, relative to the largest impulse.
const FORCE_TOLERANCE: f64 = 1e-9;

/// Corner that pulls or closes, and the range of joints whose corners change with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct WrongCorner {
    joint: usize,
    edge: usize,
    /// Impulse or closing rate of the corner, below zero.
    by: f64,
    first: usize,
    last: usize,
}

impl WrongCorner {
    fn new(joint: usize, edge: usize, by: f64) -> Self {
        Self {
            joint,
            edge,
            by,
            first: joint,
            last: joint,
        }
    }
}

impl ContactProgram {
    /// Exchanges many corners at once until none pulls or closes, and returns whether that succeeds.
    ///
    /// In each run of neighbouring corners that pull, only the worst one is released: the others often become compressive again. All closing corners
    /// become active. Without progress, only the fastest closing corner of each run becomes active. Impacts with many changed corners converge in a
    /// few rounds. The exchanges may cycle: the dual method then takes over.
    pub(super) fn exchange(
        &mut self,
        touching: &[Corners],
        tolerance: f64,
        iterations: &mut usize,
    ) -> bool {
        let mut fewest = usize::MAX;
        let mut patience = EXCHANGE_PATIENCE;
        let mut worst_only = false;
        self.earlier.copy_from_slice(&self.active);
        loop {
            self.find_wrong(touching, tolerance);
            if self.wrong.is_empty() {
                return true;
            }
            if self.wrong.len() < fewest {
                fewest = self.wrong.len();
                patience = EXCHANGE_PATIENCE;
            } else if patience > 0 {
                patience -= 1;
            } else if worst_only {
                return false;
            } else {
                worst_only = true;
                patience = EXCHANGE_PATIENCE;
            }
            self.keep_worst(worst_only);
            if !worst_only {
                self.extend_runs(touching);
            }
            self.flip_wrong();
            if !pivot_exceeds(self.factor.update(&self.active), DEPENDENCE) {
                self.active.copy_from_slice(&self.earlier);
                self.factor.update(&self.active);
                if worst_only {
                    return false;
                }
                worst_only = true;
                continue;
            }
            self.answer.take_load(&self.factor, None);
            *iterations += 1;
        }
    }

    /// Finds the corners that pull and those that close, edge by edge from left to right.
    fn find_wrong(&mut self, touching: &[Corners], tolerance: f64) {
        let pulling = self.pull_limit();
        self.wrong.clear();
        for edge in 0..2 {
            self.find_pulling(edge, pulling);
            for (pin, rates) in self.factor.pins.iter().zip(&self.answer.rates) {
                let free = touching[pin.joint][edge] && !self.active[pin.joint][edge];
                if free && rates[edge] < -tolerance {
                    self.wrong
                        .push(WrongCorner::new(pin.joint, edge, rates[edge]));
                }
            }
        }
    }

    /// Adds the corners of an edge with impulses below a limit. Inactive corners have zero impulse.
    pub(super) fn find_pulling(&mut self, edge: usize, limit: f64) {
        for (joint, impulses) in self.answer.corners.iter().enumerate() {
            if impulses[edge] < limit {
                self.wrong
                    .push(WrongCorner::new(joint, edge, impulses[edge]));
            }
        }
    }

    /// Keeps only the worst corner of each run of neighbours that pull; with `of_closing` also of each run that closes.
    pub(super) fn keep_worst(&mut self, of_closing: bool) {
        let active = &self.active;
        let mut end = None;
        self.wrong.dedup_by(|next, kept| {
            let pulls = [&*kept, &*next].map(|wrong| active[wrong.joint][wrong.edge]);
            let alike = pulls[0] == pulls[1] && (pulls[0] || of_closing);
            let follows = next.edge == kept.edge && next.joint == end.unwrap_or(kept.joint) + 1;
            let run = alike && follows;
            end = run.then_some(next.joint);
            if run && next.by < kept.by {
                *kept = *next;
            }
            run
        });
    }

    /// Extends each run of joints by as many joints as the last exchange changed next to it in the same way: openings and closings propagate along
    /// the row.
    fn extend_runs(&mut self, touching: &[Corners]) {
        let (active, earlier) = (&self.active, &self.earlier);
        for wrong in &mut self.wrong {
            let (joint, edge) = (wrong.joint, wrong.edge);
            let before = active[joint][edge];
            let changed = |j: &usize| active[*j][edge] != before && earlier[*j][edge] == before;
            let same = |j: &usize| active[*j][edge] == before && touching[*j][edge];
            let (left, right) = (0..joint, joint + 1..active.len());
            let from_left = left.clone().rev().take_while(changed).count();
            let from_right = right.clone().take_while(changed).count();
            wrong.first -= left.rev().take(from_right).take_while(same).count();
            wrong.last += right.take(from_left).take_while(same).count();
        }
    }

    /// Removes wrong corners from the active set, or adds them if they are inactive.
    pub(super) fn flip_wrong(&mut self) {
        self.earlier.copy_from_slice(&self.active);
        for wrong in &self.wrong {
            let before = self.earlier[wrong.joint][wrong.edge];
            for corners in &mut self.active[wrong.first..=wrong.last] {
                corners[wrong.edge] = !before;
            }
        }
    }

    /// Limit below which an impulse counts as tension.
    pub(super) fn pull_limit(&self) -> f64 {
        // Two independent maxima are faster than one.
        let corners = self.answer.corners.iter();
        let [intrados, extrados] = corners.fold([0.0_f64; 2], |most, corner| {
            [0, 1].map(|edge| higher_number(most[edge], corner[edge].abs()))
        });
        -(FORCE_TOLERANCE * higher_number(intrados, extrados)).max(self.force_floor)
    }
}
