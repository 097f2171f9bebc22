//! Ties of a row with rigid joints.

use nalgebra::Vector2;

use crate::dynamics::history::{EventKind, TieSample, TieSummary};
use crate::mechanics::blocks::Row;
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::lanes::Lanes;
use crate::mechanics::tie::{Tie, TieMemory};

/// A tie that moves.
struct Pulling<'a> {
    tie: &'a Tie,
    memory: TieMemory<Lanes<1>>,
    /// Where its ends are, and the unit vector from the first to the second.
    ends_m: [Vector2<f64>; 2],
    along: Vector2<f64>,
    summary: TieSummary,
}

/// The ties of a row.
pub(super) struct Ties<'a> {
    row: &'a Row,
    ties: Vec<Pulling<'a>>,
    /// Where the left and the right support are.
    supports: [Pose; 2],
    /// Elastic energy in the undeformed row.
    at_rest_j: f64,
}

impl<'a> Ties<'a> {
    pub fn new(row: &'a Row) -> Self {
        let ties = row.ties().iter().map(|tie| {
            let memory = TieMemory::undeformed(tie);
            Pulling {
                tie,
                ends_m: tie.ends.map(|anchor| anchor.at_m),
                along: tie.along(),
                summary: TieSummary::at_rest(tie, &memory),
                memory,
            }
        });
        let mut ties = Self {
            row,
            ties: ties.collect(),
            supports: [Pose::UNDEFORMED; 2],
            at_rest_j: 0.0,
        };
        ties.at_rest_j = ties.energy_j();
        ties
    }

    pub fn are_none(&self) -> bool {
        self.ties.is_empty()
    }

    /// The supports have moved, and with them what is on the ground nearer to each.
    pub const fn move_supports(&mut self, poses: [Pose; 2]) {
        self.supports = poses;
    }

    /// Forces on the right support.
    pub fn on_right_support_n(&self) -> Vector2<f64> {
        let feet_m = self.row.feet_m();
        let ends = self.ties.iter().flat_map(|tie| {
            let force = tie.along * tie.memory.force_n.0[0];
            tie.tie.ends.into_iter().zip([force, -force])
        });
        ends.filter(|(anchor, _)| anchor.block.is_none() && anchor.support(feet_m) == 1)
            .map(|(_, force)| force)
            .sum()
    }

    /// The blocks have moved to these poses.
    pub fn stretch(&mut self, pose: impl Fn(usize) -> Pose) {
        let feet_m = self.row.feet_m();
        for tie in &mut self.ties {
            let moved = tie.tie.ends.map(|anchor| {
                let support = || self.supports[anchor.support(feet_m)];
                anchor.block.map_or_else(support, &pose).of(anchor.at_m)
            });
            let by_m = [0, 1].map(|end| moved[end] - tie.tie.ends[end].at_m);
            let span = tie.tie.span(by_m.map(|by| [Lanes([by.x]), Lanes([by.y])]));
            tie.memory.stretch(tie.tie, span.stretch_m);
            tie.ends_m = moved;
            tie.along = Vector2::new(span.along[0].0[0], span.along[1].0[0]);
        }
    }

    /// What the ties add to the motion of free blocks, with their centres there, in a time: to the velocity of the centre and the rate of
    /// rotation of a block.
    pub fn pull(
        &self,
        centres_m: &[Vector2<f64>],
        lasts_s: f64,
        mut gain: impl FnMut(usize, Vector2<f64>, f64),
    ) {
        for tie in &self.ties {
            let impulse = tie.along * (tie.memory.force_n.0[0] * lasts_s);
            for (end, impulse) in [impulse, -impulse].into_iter().enumerate() {
                let Some(index) = tie.tie.ends[end].block else {
                    continue;
                };
                let (block, centre_m) = (&self.row.blocks()[index], centres_m[index]);
                let turning = (tie.ends_m[end] - centre_m).perp(&impulse) / block.inertia_kg_m2;
                gain(index, impulse / block.mass_kg, turning);
            }
        }
    }

    /// Elastic energy in them, above that in the undeformed row.
    pub fn energy_j(&self) -> f64 {
        let each = self
            .ties
            .iter()
            .map(|tie| tie.memory.energy_j(tie.tie).0[0]);
        each.sum::<f64>() - self.at_rest_j
    }

    /// What they took as they yielded and broke.
    pub fn taken_j(&self) -> f64 {
        self.ties.iter().map(|tie| tie.memory.taken_j.0[0]).sum()
    }

    /// What happened to them since the last time.
    pub fn happened(&mut self, time_s: f64) -> Vec<(usize, EventKind)> {
        let mut happened = Vec::new();
        for (index, tie) in self.ties.iter_mut().enumerate() {
            let kinds = tie.summary.note(tie.tie, &tie.memory, time_s);
            happened.extend(kinds.into_iter().flatten().map(|kind| (index, kind)));
        }
        happened
    }

    pub fn samples(&self) -> impl Iterator<Item = TieSample> {
        let ties = self.ties.iter();
        ties.map(|tie| TieSample::of(tie.tie, &tie.memory))
    }

    pub fn summaries(&self) -> Vec<TieSummary> {
        self.ties.iter().map(|tie| tie.summary).collect()
    }
}
