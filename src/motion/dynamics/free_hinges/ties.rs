//! Ties of a row with rigid joints.

use nalgebra::Vector2;

use crate::dynamics::TieSample;
use crate::mechanics::row_state::lines;
use crate::mechanics::{Lanes, Pose, Row, RowState, Tie, TieLine, TieMemory};

/// Ties of a row, with their states.
pub(super) struct Ties<'a> {
    row: &'a Row,
    memories: Vec<TieMemory<Lanes<1>>>,
    /// Current lines of action.
    lines: Vec<TieLine>,
    /// Poses of the left and the right support. The end of a tie in the ground moves with the nearer support.
    pub supports: [Pose; 2],
    /// Elastic energy in the initial position, in J.
    at_rest_j: f64,
}

impl<'a> Ties<'a> {
    /// Ties of a row whose motion starts from a given state.
    pub fn new(row: &'a Row, standing: &RowState) -> Self {
        let mut ties = Self {
            row,
            memories: standing.ties.clone(),
            lines: standing.lines(row).collect(),
            supports: standing.placement.support_poses,
            at_rest_j: 0.0,
        };
        ties.at_rest_j = ties.energy_j();
        ties
    }

    pub fn are_none(&self) -> bool {
        self.memories.is_empty()
    }

    /// Force of the ties on the right support, in N.
    pub fn right_support_force_n(&self) -> Vector2<f64> {
        let feet_m = self.row.feet_m();
        let ends = self
            .memories()
            .zip(&self.lines)
            .filter(|((tie, _), _)| !tie.is_constant_force());
        let ends = ends
            .flat_map(|((tie, memory), line)| {
                let force = line.direction * memory.force_n.0[0];
                tie.ends.into_iter().zip([force, -force])
            })
            .filter(|(end, _)| end.block.is_none() && end.support(feet_m) == 1);
        ends.map(|(_, force)| force).sum()
    }

    /// Updates the ties for given poses of the blocks.
    pub fn stretch(&mut self, pose: impl Fn(usize) -> Pose) {
        let lines = lines(self.row, &self.supports, pose);
        let ties = self.row.ties.iter().zip(&mut self.memories);
        for ((now, (tie, memory)), line) in self.lines.iter_mut().zip(ties).zip(lines) {
            *now = line;
            memory.stretch(tie, Lanes([line.stretch_m]));
        }
    }

    /// Computes the effect of the ties on free blocks with given centres, during `lasts_s`. `gain` receives block, change of velocity and change of
    /// rotation rate.
    pub fn pull(
        &self,
        centres_m: &[Vector2<f64>],
        lasts_s: f64,
        mut gain: impl FnMut(usize, Vector2<f64>, f64),
    ) {
        for (memory, line) in self.memories.iter().zip(&self.lines) {
            let impulse = memory.force_n.0[0] * lasts_s;
            line.pull(&self.row.blocks, centres_m, impulse, &mut gain);
        }
    }

    /// Elastic energy of the ties above that in the initial position, in J.
    pub fn energy_j(&self) -> f64 {
        let memories = self.memories();
        let each_j = memories.map(|(tie, memory)| memory.energy_j(tie).0[0]);
        each_j.sum::<f64>() - self.at_rest_j
    }

    /// Energy dissipated by yield and break of the ties, in J.
    pub fn taken_j(&self) -> f64 {
        self.memories.iter().map(|memory| memory.taken_j.0[0]).sum()
    }

    /// Ties with their states.
    pub fn memories(&self) -> impl Iterator<Item = (&Tie, TieMemory<Lanes<1>>)> {
        self.row.ties.iter().zip(self.memories.iter().copied())
    }

    pub fn samples(&self) -> impl Iterator<Item = TieSample> {
        let ties = self.memories().filter(|(tie, _)| !tie.is_constant_force());
        ties.map(|(tie, memory)| TieSample::of(tie, &memory))
    }
}
