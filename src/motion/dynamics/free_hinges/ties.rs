//! Ties of a row with rigid joints.

use nalgebra::Vector2;

use crate::dynamics::history::TieSample;
use crate::mechanics::blocks::Row;
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::lanes::Lanes;
use crate::mechanics::stance::{Stance, lines};
use crate::mechanics::tie::{Tie, TieLine, TieMemory};

/// The ties of a row.
pub(super) struct Ties<'a> {
    row: &'a Row,
    memories: Vec<TieMemory<Lanes<1>>>,
    /// Their present lines.
    lines: Vec<TieLine>,
    /// Positions of the left and the right support: with each the ends of ties on the ground nearer to it move.
    pub supports: [Pose; 2],
    /// Elastic energy at the initial position.
    at_rest_j: f64,
}

impl<'a> Ties<'a> {
    /// Ties of a row whose motion starts from this stance.
    pub fn new(row: &'a Row, standing: &Stance) -> Self {
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

    /// Forces on the right support.
    pub fn on_right_support_n(&self) -> Vector2<f64> {
        let feet_m = self.row.feet_m();
        let ends = self.memories().zip(&self.lines);
        let ends = ends.flat_map(|((tie, memory), line)| {
            let force = line.along * memory.force_n.0[0];
            tie.ends.into_iter().zip([force, -force])
        });
        let ends = ends.filter(|(end, _)| end.block.is_none() && end.support(feet_m) == 1);
        ends.map(|(_, force)| force).sum()
    }

    /// Stretches the ties to these poses of the blocks.
    pub fn stretch(&mut self, pose: impl Fn(usize) -> Pose) {
        let lines = lines(self.row, &self.supports, pose);
        let ties = self.row.ties.iter().zip(&mut self.memories);
        for ((now, (tie, memory)), line) in self.lines.iter_mut().zip(ties).zip(lines) {
            *now = line;
            memory.stretch(tie, Lanes([line.stretch_m]));
        }
    }

    /// Contributions of the ties to the motion of free blocks with these centres, in a time: to the velocity of the centre and the rate of
    /// rotation of a block.
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

    /// Their elastic energy, above that at the initial position.
    pub fn energy_j(&self) -> f64 {
        let memories = self.memories();
        let each_j = memories.map(|(tie, memory)| memory.energy_j(tie).0[0]);
        each_j.sum::<f64>() - self.at_rest_j
    }

    /// Energy that they dissipated by yielding and breaking.
    pub fn taken_j(&self) -> f64 {
        self.memories.iter().map(|memory| memory.taken_j.0[0]).sum()
    }

    /// The ties and their memories.
    pub fn memories(&self) -> impl Iterator<Item = (&Tie, TieMemory<Lanes<1>>)> {
        self.row.ties.iter().zip(self.memories.iter().copied())
    }

    pub fn samples(&self) -> impl Iterator<Item = TieSample> {
        self.memories()
            .map(|(tie, memory)| TieSample::of(tie, &memory))
    }
}
