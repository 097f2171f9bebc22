//! State of a row: undeformed, or displaced between moved supports.

use crate::mechanics::{Lanes, Placement, Pose, Row, TieLine, TieMemory};

/// Positions of the blocks of a row, and states of its ties.
#[derive(Clone, Debug)]
pub struct RowState {
    /// Positions of its blocks.
    pub placement: Placement,
    /// States of the ties.
    pub ties: Vec<TieMemory<Lanes<1>>>,
}

impl RowState {
    /// State of the undeformed row.
    pub fn undeformed(row: &Row) -> Self {
        Self {
            placement: Placement::new(row),
            ties: row.ties.iter().map(TieMemory::undeformed).collect(),
        }
    }

    /// Lines of action of the ties.
    pub fn lines(&self, row: &Row) -> impl Iterator<Item = TieLine> {
        let poses = &self.placement.poses;
        lines(row, &self.placement.support_poses, |block| poses[block])
    }

    /// Forces of the ties, in N.
    pub fn forces_n(&self) -> impl Iterator<Item = f64> {
        self.ties.iter().map(|tie| tie.force_n.0[0])
    }

    /// Updates the ties for the current positions of the blocks, and returns their lines of action.
    pub(crate) fn stretch_ties(&mut self, row: &Row) -> Vec<TieLine> {
        let lines: Vec<TieLine> = self.lines(row).collect();
        for ((memory, tie), line) in self.ties.iter_mut().zip(&row.ties).zip(&lines) {
            *memory = memory.then(tie, line.stretch_m);
        }
        lines
    }

    /// Index of the first broken tie.
    pub fn broken_tie(&self) -> Option<usize> {
        self.ties.iter().position(TieMemory::is_broken)
    }
}

/// Lines of action of the ties for given poses of supports and blocks.
pub fn lines(
    row: &Row,
    supports: &[Pose; 2],
    pose: impl Fn(usize) -> Pose,
) -> impl Iterator<Item = TieLine> {
    let feet_m = row.feet_m();
    row.ties.iter().map(move |tie| {
        tie.line(tie.ends.map(|anchor| {
            let support = || supports[anchor.support(feet_m)];
            anchor
                .block
                .map_or_else(support, &pose)
                .current_position(anchor.at_m)
        }))
    })
}
