//! Ties: bars that pull between two points of blocks or supports, and never push.
//!
//! Beyond its unstressed length a tie pulls with its stiffness times what it has stretched, at most with the force at which it yields; what
//! it has yielded is lost to it. Stretched too far it breaks for good.

use nalgebra::Vector2;
use thiserror::Error;

use super::block::Block;
use super::geometry::rigid::{Momentum, Twist, mirrored};
use super::lanes::{Lanes, Real, both, remembered};

/// An end of a tie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// Index of the block; `None`: a support, or the ground.
    pub block: Option<usize>,
    /// Its position in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
}

impl Anchor {
    /// Support of an end that is on no block, 0 or 1: the horizontally nearer one.
    #[must_use]
    pub fn support(&self, feet_m: [Vector2<f64>; 2]) -> usize {
        let [left, right] = feet_m.map(|foot_m| (self.at_m.x - foot_m.x).abs());
        usize::from(right < left)
    }
}

/// A tie, as it is in the undeformed structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tie {
    /// Its two ends.
    pub ends: [Anchor; 2],
    /// Force in N for each metre that it is stretched.
    pub stiffness_n_m: f64,
    /// Its force in the undeformed structure, in N.
    pub prestress_n: f64,
    /// Its largest force, in N; infinite if it does not yield.
    pub yield_force_n: f64,
    /// Its stretch when it breaks, over its unstressed length; infinite if it does not break.
    pub breaks_at_strain: f64,
}

/// Why a tie is not possible. Blocks count from 1 in words.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TieError {
    /// A number is out of range.
    #[error("{0}")]
    Value(String),
    /// An end is on a block that does not exist.
    #[error("there is no block {number}", number = .0 + 1)]
    NoBlock(usize),
    /// Both ends are at one place.
    #[error("both ends are at one point: a tie has a length")]
    NoLength,
    /// Both ends are on one block.
    #[error("both ends are on block {number}, which is rigid: such a tie does nothing", number = .0 + 1)]
    OneBlock(usize),
    /// Both ends are on supports.
    #[error("both ends are on supports, which a tie cannot move: such a tie does nothing")]
    OnSupports,
}

const NOT_NEGATIVE: &str = "a number that is not negative: a tie does not push";

impl Tie {
    /// Checks its numbers, and that it is between two of so many blocks, or one of them and a support. `size_m` is the length of the
    /// structure.
    ///
    /// # Errors
    /// When a number is out of range, or its ends are on one body.
    pub fn check(&self, blocks: usize, size_m: f64) -> Result<(), TieError> {
        let [from, to] = &self.ends;
        let (stiffness_n_m, prestress_n) = (self.stiffness_n_m, self.prestress_n);
        let (yield_force_n, breaks_at_strain) = (self.yield_force_n, self.breaks_at_strain);
        let (positive, infinite) = ("a positive number", f64::INFINITY);
        let value = |message: String| Err(TieError::Value(message));
        for (key, number, most, allowed) in [
            ("stiffness_n_m", stiffness_n_m, f64::MAX, positive),
            ("prestress_n", prestress_n, f64::MAX, NOT_NEGATIVE),
            ("yield_force_n", yield_force_n, infinite, positive),
            ("breaks_at_strain", breaks_at_strain, infinite, positive),
        ] {
            let may_be_zero = allowed == NOT_NEGATIVE;
            if !(number > 0.0 || number == 0.0 && may_be_zero) || number > most {
                return value(format!("`{key} = {number:?}` of a tie must be {allowed}"));
            }
        }
        let mut parts = from.at_m.iter().chain(&to.at_m);
        if let Some(number) = parts.find(|part| !part.is_finite()) {
            return value(format!("`point = {number:?}` of a tie must be finite"));
        }
        let mut named = [from.block, to.block].into_iter().flatten();
        if let Some(block) = named.find(|block| *block >= blocks) {
            return Err(TieError::NoBlock(block));
        }
        match [from.block, to.block] {
            [Some(one), Some(other)] if one == other => return Err(TieError::OneBlock(one)),
            [None, None] => return Err(TieError::OnSupports),
            _ => {}
        }
        let (length_m, stretched_m) = (self.length_m(), prestress_n / stiffness_n_m);
        let strain = stretched_m / (length_m - stretched_m);
        if length_m <= LEAST_LENGTH_RATIO * size_m {
            return Err(TieError::NoLength);
        }
        if stretched_m >= length_m {
            return value(format!(
                "a prestress of {prestress_n:?} N stretches it by {stretched_m:?} m, and it is only {length_m:?} m long: give less, or \
                 a stiffer tie"
            ));
        }
        if prestress_n > yield_force_n {
            return value(format!(
                "a prestress of {prestress_n:?} N is above the force at which it yields, {yield_force_n:?} N"
            ));
        }
        if strain >= breaks_at_strain {
            return value(format!(
                "it breaks at a strain of {breaks_at_strain:?}, and its prestress alone strains it by {strain:?}"
            ));
        }
        Ok(())
    }

    /// Length in the undeformed structure, in metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        (self.ends[1].at_m - self.ends[0].at_m).norm()
    }

    /// Length without stress, in metres.
    #[must_use]
    pub fn slack_length_m(&self) -> f64 {
        self.length_m() - self.prestress_n / self.stiffness_n_m
    }

    /// Unit vector from its first end to its second one.
    #[must_use]
    pub fn along(&self) -> Vector2<f64> {
        (self.ends[1].at_m - self.ends[0].at_m) / self.length_m()
    }

    /// Its line with its ends there.
    #[must_use]
    pub fn line(&self, ends_m: [Vector2<f64>; 2]) -> TieLine {
        let moved = [0, 1].map(|end| ends_m[end] - self.ends[end].at_m);
        let span = self.span(moved.map(|by| [Lanes([by.x]), Lanes([by.y])]));
        TieLine {
            ends: self.ends.map(|anchor| anchor.block),
            ends_m,
            along: Vector2::new(span.along[0].0[0], span.along[1].0[0]),
            stretch_m: span.stretch_m.0[0],
        }
    }

    /// This tie with its ends mirrored about the y axis, in a row of so many blocks that is mirrored too.
    pub(super) fn mirrored(&self, blocks: usize) -> Self {
        let mirror = |anchor: Anchor| Anchor {
            block: anchor.block.map(|block| blocks - 1 - block),
            at_m: mirrored(anchor.at_m),
        };
        Self {
            ends: self.ends.map(mirror),
            ..*self
        }
    }

    /// Its stretch and direction after these displacements of its ends, in m.
    ///
    /// The square of the length is taken less that at rest, so that small changes keep their digits.
    #[inline(always)]
    #[must_use]
    pub fn span<R: Real>(&self, moved_m: [[R; 2]; 2]) -> TieSpan<R> {
        let apart = self.ends[1].at_m - self.ends[0].at_m;
        let length_m = self.length_m();
        let by = both!(i: moved_m[1][i] - moved_m[0][i]);
        let now = both!(i: by[i] + R::of(apart[i]));
        let length = (now[0] * now[0] + now[1] * now[1]).sqrt();
        let more = both!(i: by[i] * (by[i] + R::of(2.0 * apart[i])));
        let lengthened = (more[0] + more[1]) / (length + R::of(length_m));
        let per_length = R::of(1.0) / length;
        TieSpan {
            stretch_m: lengthened + R::of(self.prestress_n / self.stiffness_n_m),
            along: both!(i: now[i] * per_length),
        }
    }

    /// Its force in N, if it has yielded so much before, is now stretched so far beyond its unstressed length, and does not
    /// break.
    #[must_use]
    pub(crate) fn pull_n<R: Real>(&self, yielded_m: f64, stretch_m: R) -> R {
        let elastic_n = (stretch_m - R::of(yielded_m)) * self.stiffness_n_m;
        elastic_n.max(R::of(0.0)).min(R::of(self.yield_force_n))
    }
}

/// Square of the highest angular frequency, in (rad/s)2, that ties make of blocks that nothing else holds, at most.
#[must_use]
pub(crate) fn square_frequency(ties: &[Tie], blocks: &[Block]) -> f64 {
    let flexibility = |anchor: &Anchor| {
        let block = anchor.block.and_then(|block| blocks.get(block));
        block.map_or(0.0, |block| {
            let arm_m = anchor.at_m - block.centre_m;
            1.0 / block.mass_kg + arm_m.norm_squared() / block.inertia_kg_m2
        })
    };
    // The largest eigenvalue of a sum is at most the sum of the largest.
    let each = ties.iter().map(|tie| {
        let ends = tie.ends.iter().map(flexibility);
        tie.stiffness_n_m * ends.sum::<f64>()
    });
    each.sum()
}

/// Ties shorter than this part of the size have no direction.
const LEAST_LENGTH_RATIO: f64 = 1e-9;

/// The stretch and the direction of a tie.
#[derive(Clone, Copy, Debug)]
pub struct TieSpan<R> {
    /// Stretch beyond its unstressed length, in m.
    pub stretch_m: R,
    /// Unit vector from its first end to its second one.
    pub along: [R; 2],
}

/// The line of a tie between blocks in any position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TieLine {
    /// Indices of the blocks at its ends; `None`: a support, or the ground.
    pub ends: [Option<usize>; 2],
    /// Positions of its ends.
    pub ends_m: [Vector2<f64>; 2],
    /// Unit vector from its first end to its second one.
    pub along: Vector2<f64>,
    /// Stretch beyond its unstressed length, in m.
    pub stretch_m: f64,
}

impl TieLine {
    /// Gains of the blocks at its ends, with their centres there, under an impulse of it: in velocity of the centre and in rate of
    /// rotation.
    pub fn pull(
        &self,
        blocks: &[Block],
        centres_m: &[Vector2<f64>],
        impulse: f64,
        mut gain: impl FnMut(usize, Vector2<f64>, f64),
    ) {
        let impulse = self.along * impulse;
        for (end, impulse) in [impulse, -impulse].into_iter().enumerate() {
            let Some(index) = self.ends[end] else {
                continue;
            };
            let (block, centre_m) = (&blocks[index], centres_m[index]);
            let turning = (self.ends_m[end] - centre_m).perp(&impulse) / block.inertia_kg_m2;
            gain(index, impulse / block.mass_kg, turning);
        }
    }

    /// A pull of 1 on the block at its first end; the one at its second end gets it the other way.
    fn unit_pull(&self) -> Momentum {
        Momentum::applied_at(self.ends_m[0], self.along)
    }

    /// Rate at which it lengthens while blocks move so and supports do not.
    #[must_use]
    pub fn lengthening(&self, velocities: &[Twist]) -> f64 {
        let pull = self.unit_pull();
        let power = |block: usize| velocities[block].power(&pull);
        let [first, second] = self.ends.map(|block| block.map_or(0.0, power));
        second - first
    }
}

/// Impulses of ties on each block, summed.
pub(crate) fn sum_pulls<'a>(
    blocks: usize,
    ties: impl Iterator<Item = (&'a TieLine, f64)>,
) -> Vec<Momentum> {
    let mut pulls = vec![Momentum::ZERO; blocks];
    let mut add = |ends: [Option<usize>; 2], pull: Momentum| {
        for (end, pull) in ends.iter().zip([pull, pull * -1.0]) {
            if let Some(block) = *end {
                pulls[block] = pulls[block] + pull;
            }
        }
    };
    // Of many ties, neighbours are between the same blocks: their sum stays in registers.
    let (mut ends, mut pull) = ([None; 2], Momentum::ZERO);
    for (line, impulse) in ties {
        if line.ends != ends {
            add(ends, pull);
            (ends, pull) = (line.ends, Momentum::ZERO);
        }
        pull = pull + line.unit_pull() * impulse;
    }
    add(ends, pull);
    pulls
}

/// Adds to the velocities of blocks, with their centres there, what impulses of ties that lie so give them.
pub(crate) fn pull_blocks<'a>(
    blocks: &[Block],
    centres_m: &[Vector2<f64>],
    ties: impl Iterator<Item = (&'a TieLine, f64)>,
    velocities: &mut [Twist],
) {
    let pulls = sum_pulls(blocks.len(), ties);
    let bodies = blocks.iter().zip(centres_m).zip(&pulls);
    for (((block, centre_m), pull), velocity) in bodies.zip(velocities) {
        let rate = pull.about(*centre_m) / block.inertia_kg_m2;
        let gained = Twist::translation(pull.linear / block.mass_kg);
        *velocity = *velocity + gained + Twist::rotation(*centre_m, rate);
    }
}

/// Memory of a tie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TieMemory<R> {
    /// Stretch beyond its unstressed length, in m.
    pub stretch_m: R,
    /// Its force, in N.
    pub force_n: R,
    /// The most that it has pulled with, in N.
    pub peak_n: R,
    /// Plastic lengthening, in m.
    pub yielded_m: R,
    /// 1 until it breaks, then 0.
    pub intact: R,
    /// Energy taken for good so far, by yielding and by breaking, in J.
    pub taken_j: R,
}

remembered!(TieMemory {
    stretch_m,
    force_n,
    peak_n,
    yielded_m,
    intact,
    taken_j
});

impl<R: Real> TieMemory<R> {
    /// Of a tie that had yielded so much before and is now stretched so far beyond its unstressed length, slowly. It has taken nothing
    /// yet.
    #[must_use]
    pub fn stretched(tie: &Tie, yielded_m: f64, stretch_m: R) -> Self {
        let mut memory = Self {
            stretch_m,
            yielded_m: R::of(yielded_m),
            intact: R::of(1.0),
            ..Self::none()
        };
        memory.stretch(tie, stretch_m);
        memory.taken_j = R::of(0.0);
        memory
    }

    /// The tie is stretched so far beyond its unstressed length, or shortened.
    ///
    /// The mean of the forces before and after, times what it yields, is what it takes: with the elastic energy that is, up to the steps in
    /// which it begins to yield or goes slack, the trapezoid of its work.
    #[inline(always)]
    pub fn stretch(&mut self, tie: &Tie, stretch_m: R) {
        let zero = R::of(0.0);
        let pulls_n = ((stretch_m - self.yielded_m) * tie.stiffness_n_m).max(zero);
        let force_n = pulls_n.min(R::of(tie.yield_force_n));
        let more_m = (pulls_n - force_n) * (1.0 / tie.stiffness_n_m);
        // The unstressed length is positive.
        let breaks_m = R::of(tie.breaks_at_strain * tie.slack_length_m());
        // A tie that breaks within the step pulls hardest where it breaks.
        let pulls_n = (stretch_m.min(breaks_m) - self.yielded_m) * tie.stiffness_n_m;
        let hardest_n = pulls_n.max(zero).min(R::of(tie.yield_force_n));
        self.peak_n = self.peak_n.max(hardest_n * self.intact);
        self.yielded_m += more_m * self.intact;
        let yielded_j = (self.force_n + force_n) * more_m * 0.5 * self.intact;
        let left_m = breaks_m - stretch_m;
        let intact = left_m.positive(self.intact, zero);
        // Its energy as it broke, and the trapezoid of its work in that step, at whose end it no longer pulls.
        let last_j = self.force_n * (stretch_m - self.stretch_m) * 0.5;
        let lost_j = (self.energy_j(tie) + last_j) * (self.intact - intact);
        self.taken_j += yielded_j * intact + lost_j;
        self.stretch_m = stretch_m;
        self.force_n = force_n * intact;
        self.intact = intact;
    }

    /// Memory of a tie whose ends are where they are in the undeformed structure.
    #[must_use]
    pub fn undeformed(tie: &Tie) -> Self {
        Self::stretched(tie, 0.0, R::of(tie.prestress_n / tie.stiffness_n_m))
    }

    /// Elastic energy, in J.
    #[inline(always)]
    #[must_use]
    pub fn energy_j(&self, tie: &Tie) -> R {
        self.force_n * self.force_n * (0.5 / tie.stiffness_n_m)
    }
}

impl TieMemory<Lanes<1>> {
    /// Memory of the tie once it is stretched so far, slowly; it takes no energy.
    #[must_use]
    pub fn then(&self, tie: &Tie, stretch_m: f64) -> Self {
        let stretch_m = Lanes([stretch_m]);
        if self.is_broken() {
            return Self { stretch_m, ..*self };
        }
        Self::stretched(tie, self.yielded_m.0[0], stretch_m)
    }

    /// Whether it has broken.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        self.intact.0[0] == 0.0
    }
}
