//! A row where it stands: undeformed, or between supports that have moved.

use super::blocks::Row;
use super::joints::Placement;
use super::lanes::Lanes;
use super::tie::{TieLine, TieMemory};
use crate::mechanics::geometry::pose::Pose;

/// Positions of the blocks of a row, and the memory of its ties.
#[derive(Clone, Debug)]
pub struct Stance {
    /// Positions of its blocks.
    pub placement: Placement,
    /// Memory of its ties.
    pub ties: Vec<TieMemory<Lanes<1>>>,
}

impl Stance {
    /// The undeformed row.
    #[must_use]
    pub fn undeformed(row: &Row) -> Self {
        Self {
            placement: Placement::new(row),
            ties: row.ties.iter().map(TieMemory::undeformed).collect(),
        }
    }

    /// Lines of the ties of the row.
    pub fn lines(&self, row: &Row) -> impl Iterator<Item = TieLine> {
        let poses = &self.placement.poses;
        lines(row, &self.placement.support_poses, |block| poses[block])
    }

    /// Forces of its ties, in N.
    pub fn forces_n(&self) -> impl Iterator<Item = f64> {
        self.ties.iter().map(|tie| tie.force_n.0[0])
    }

    /// The ties follow the blocks, slowly. Returns how they lie then.
    pub(crate) fn stretch_ties(&mut self, row: &Row) -> Vec<TieLine> {
        let lines: Vec<TieLine> = self.lines(row).collect();
        for ((memory, tie), line) in self.ties.iter_mut().zip(&row.ties).zip(&lines) {
            *memory = memory.then(tie, line.stretch_m);
        }
        lines
    }

    /// The first of its ties that has broken.
    #[must_use]
    pub fn broken_tie(&self) -> Option<usize> {
        self.ties.iter().position(TieMemory::is_broken)
    }
}

/// Lines of the ties of a row between supports and blocks at these poses.
pub fn lines(
    row: &Row,
    supports: &[Pose; 2],
    pose: impl Fn(usize) -> Pose,
) -> impl Iterator<Item = TieLine> {
    let feet_m = row.feet_m();
    row.ties.iter().map(move |tie| {
        tie.line(tie.ends.map(|anchor| {
            let support = || supports[anchor.support(feet_m)];
            anchor.block.map_or_else(support, &pose).of(anchor.at_m)
        }))
    })
}
