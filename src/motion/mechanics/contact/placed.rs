//! A row in its present position with its load, as cumulative sums over the blocks from the left. The sum over any run of blocks is a difference of
//! two.

use super::{Load, higher_number};
use crate::mechanics::joints::Frame;
use crate::mechanics::{Block, MassMoments, Momentum, Placement, Row, Supports, Twist};

#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub supports: Supports,
    pub handedness: f64,
    /// Mass and moment of inertia of every block.
    blocks: Vec<Block>,
    pub frames: Vec<Frame>,
    /// Mass moments of every block.
    pub own: Vec<MassMoments>,
    /// Cumulative mass moments of the blocks before each joint.
    pub moments: Vec<MassMoments>,
    pub momenta: Vec<Momentum>,
    /// Cumulative prescribed relative velocities up to each block.
    pub datum: Vec<Twist>,
}

impl Placed {
    pub fn new(row: &Row) -> Self {
        let (blocks, joints) = (row.blocks.len(), row.joints.len());
        Self {
            supports: row.supports,
            handedness: row.handedness,
            blocks: row.blocks.clone(),
            frames: Vec::with_capacity(joints),
            own: vec![MassMoments::default(); blocks],
            moments: vec![MassMoments::default(); blocks + 1],
            momenta: vec![Momentum::ZERO; blocks + 1],
            datum: vec![Twist::ZERO; blocks + 1],
        }
    }

    /// Sets the positions of the blocks.
    pub fn set_positions(&mut self, placement: &Placement) {
        self.frames.clear();
        self.frames.extend_from_slice(&placement.frames);
        let mut moments = MassMoments::default();
        for (block, centre) in placement.centres_m.iter().enumerate() {
            let own = self.blocks[block].moments_at(*centre);
            moments = moments + own;
            self.own[block] = own;
            self.moments[block + 1] = moments;
        }
    }

    /// Sets the load. Returns the largest velocity, and the sum of the magnitudes of all momenta.
    pub fn load(&mut self, load: &Load) -> (f64, f64) {
        let (mut momentum, mut datum) = (Momentum::ZERO, Twist::ZERO);
        let (mut largest, mut total) = (0.0_f64, 0.0);
        for block in 0..self.own.len() {
            datum = datum + load.jumps[block];
            self.datum[block] = datum;
            let motion = load.free[block] - datum;
            let added = motion.momentum(&self.own[block]);
            let (x, y) = (added.linear.x.abs(), added.linear.y.abs());
            total += x + y;
            largest = higher_number(largest, (x + y) / self.own[block].mass);
            momentum = momentum + added;
            self.momenta[block + 1] = momentum;
        }
        if self.supports == Supports::Both {
            datum = datum + load.jumps[self.own.len()];
        }
        let count = self.own.len();
        self.datum[count] = datum;
        (largest, total)
    }

    /// Change of momentum of all blocks before a joint if they move together with this velocity.
    pub fn momentum_change(&self, twist: &Twist, joint: usize, loaded: bool) -> Momentum {
        let change = twist.momentum(&self.moments[joint]);
        if loaded {
            change - self.momenta[joint]
        } else {
            change
        }
    }
}
