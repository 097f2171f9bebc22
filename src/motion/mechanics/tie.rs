//! Ties: bars between two points of blocks or supports that carry tension only.
//!
//! The force of a tie is its stiffness times its stretch beyond the unstressed length, up to the yield force. Plastic elongation reduces the stretch.
//! Beyond its strain limit the tie breaks permanently.
//!
//! A constant force is a tie of zero stiffness whose second end is infinitely far away: its force and its direction do not change, and its stretch is
//! the displacement of its first end against the force. All computations with ties then hold for constant forces as well.

use nalgebra::Vector2;
use thiserror::Error;

use super::block::Block;
use super::geometry::rigid::{Momentum, Twist, mirrored};
use super::lanes::{both, remembered};
use crate::mechanics::{Lanes, Real};

/// End of a tie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// Index of the block; `None` for a support or the ground.
    pub block: Option<usize>,
    /// Position in the undeformed structure, in metres.
    pub at_m: Vector2<f64>,
}

impl Anchor {
    /// Support of an end that is on no block, 0 or 1: the horizontally nearer one.
    pub fn support(&self, feet_m: [Vector2<f64>; 2]) -> usize {
        let [left, right] = feet_m.map(|foot_m| (self.at_m.x - foot_m.x).abs());
        usize::from(right < left)
    }
}

/// Tie in the undeformed structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tie {
    /// Both ends.
    pub ends: [Anchor; 2],
    /// Stiffness: force in N per metre of stretch; zero for a constant force.
    pub stiffness_n_m: f64,
    /// Force in the undeformed structure, in N.
    pub prestress_n: f64,
    /// Yield force, in N; infinite if the tie does not yield.
    pub yield_force_n: f64,
    /// Strain at which the tie breaks, relative to its unstressed length; infinite if it does not break.
    pub breaks_at_strain: f64,
}

/// Reason why a tie is not valid. Messages number blocks from 1.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TieError {
    /// A number is out of range.
    #[error("{0}")]
    Value(String),
    /// An end is on a block that does not exist.
    #[error("there is no block {number}", number = .0 + 1)]
    NoBlock(usize),
    /// Both ends are at the same point.
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
    /// Constant force on a block, in N, at a point in metres.
    pub(super) fn constant_force(block: usize, at_m: Vector2<f64>, force_n: Vector2<f64>) -> Self {
        let force = force_n.norm();
        let ends = [(Some(block), at_m), (None, at_m + force_n / force)];
        Self {
            ends: ends.map(|(block, at_m)| Anchor { block, at_m }),
            stiffness_n_m: 0.0,
            prestress_n: force,
            yield_force_n: force,
            breaks_at_strain: f64::INFINITY,
        }
    }

    /// Whether it is a constant force.
    pub const fn is_constant_force(&self) -> bool {
        self.stiffness_n_m == 0.0
    }

    /// Constant force in N, or the force of the tie in the undeformed structure, on the block at its first end.
    pub fn force_at_rest_n(&self) -> Vector2<f64> {
        self.direction() * self.prestress_n
    }

    /// Checks the numbers of the tie, and that it connects two of `blocks` blocks, or a block and a support. `size_m` is the size of the structure.
    ///
    /// # Errors
    /// If a number is out of range, or both ends are on one body.
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
    pub fn length_m(&self) -> f64 {
        (self.ends[1].at_m - self.ends[0].at_m).norm()
    }

    /// Unstressed length, in metres.
    pub fn slack_length_m(&self) -> f64 {
        self.length_m() - self.prestress_n / self.stiffness_n_m
    }

    /// Unit vector from its first end to its second one, in the undeformed structure.
    pub fn direction(&self) -> Vector2<f64> {
        (self.ends[1].at_m - self.ends[0].at_m) / self.length_m()
    }

    /// Line of action for given positions of its ends, in metres.
    pub fn line(&self, ends_m: [Vector2<f64>; 2]) -> TieLine {
        let moved = [0, 1].map(|end| ends_m[end] - self.ends[end].at_m);
        let span = self.span(moved.map(|by| [Lanes([by.x]), Lanes([by.y])]));
        TieLine {
            ends: self.ends.map(|anchor| anchor.block),
            ends_m,
            direction: Vector2::new(span.direction[0].0[0], span.direction[1].0[0]),
            stretch_m: span.stretch_m.0[0],
        }
    }

    /// This tie mirrored about the y axis, in a mirrored row of `blocks` blocks.
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

    /// Stretch and direction after given displacements of its ends, in m.
    ///
    /// The difference of the squared lengths avoids cancellation for small displacements.
    #[inline(always)]
    pub fn span<R: Real>(&self, moved_m: [[R; 2]; 2]) -> TieSpan<R> {
        if self.is_constant_force() {
            let direction = self.direction();
            let by = moved_m[0];
            return TieSpan {
                stretch_m: -(by[0] * R::of(direction.x) + by[1] * R::of(direction.y)),
                direction: both!(i: R::of(direction[i])),
            };
        }
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
            direction: both!(i: now[i] * per_length),
        }
    }

    /// Force in N for a stretch beyond the unstressed length, in m, if the tie could push and did not yield.
    pub(crate) fn linear_pull_n<R: Real>(&self, stretch_m: R) -> R {
        if self.is_constant_force() {
            return R::of(self.prestress_n);
        }
        stretch_m * self.stiffness_n_m
    }

    /// Force in N for a plastic elongation and a stretch beyond the unstressed length, both in m. The tie does not break here.
    pub(crate) fn pull_n<R: Real>(&self, yielded_m: f64, stretch_m: R) -> R {
        if self.is_constant_force() {
            return R::of(self.prestress_n);
        }
        let elastic_n = (stretch_m - R::of(yielded_m)) * self.stiffness_n_m;
        elastic_n.max(R::of(0.0)).min(R::of(self.yield_force_n))
    }
}

/// Upper bound of the square of the highest angular frequency, in (rad/s)2, of free blocks held by ties.
pub(crate) fn square_frequency(ties: &[Tie], blocks: &[Block]) -> f64 {
    let flexibility = |anchor: &Anchor| {
        let block = anchor.block.and_then(|block| blocks.get(block));
        block.map_or(0.0, |block| {
            let arm_m = anchor.at_m - block.centre_m;
            1.0 / block.mass_kg + arm_m.norm_squared() / block.inertia_kg_m2
        })
    };
    // The largest eigenvalue of a sum is at most the sum of the largest eigenvalues.
    let each = ties.iter().map(|tie| {
        let ends = tie.ends.iter().map(flexibility);
        tie.stiffness_n_m * ends.sum::<f64>()
    });
    each.sum()
}

/// Least length of a tie, over the size of the structure; shorter ties have no direction.
const LEAST_LENGTH_RATIO: f64 = 1e-9;

/// Stretch and direction of a tie.
#[derive(Clone, Copy, Debug)]
pub struct TieSpan<R> {
    /// Stretch beyond the unstressed length, in m.
    pub stretch_m: R,
    /// Unit vector from its first end to its second one.
    pub direction: [R; 2],
}

/// Line of action of a tie between blocks in any position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TieLine {
    /// Indices of the blocks at its ends; `None` for a support or the ground.
    pub ends: [Option<usize>; 2],
    /// Positions of its ends, in metres.
    pub ends_m: [Vector2<f64>; 2],
    /// Unit vector from its first end to its second one.
    pub direction: Vector2<f64>,
    /// Stretch beyond the unstressed length, in m.
    pub stretch_m: f64,
}

impl TieLine {
    /// Computes the effect of an impulse of the tie on the blocks at its ends, with given centres. `gain` receives block, change of velocity and
    /// change of rotation rate.
    pub fn pull(
        &self,
        blocks: &[Block],
        centres_m: &[Vector2<f64>],
        impulse: f64,
        mut gain: impl FnMut(usize, Vector2<f64>, f64),
    ) {
        let impulse = self.direction * impulse;
        for (end, impulse) in [impulse, -impulse].into_iter().enumerate() {
            let Some(index) = self.ends[end] else {
                continue;
            };
            let (block, centre_m) = (&blocks[index], centres_m[index]);
            let turning = (self.ends_m[end] - centre_m).perp(&impulse) / block.inertia_kg_m2;
            gain(index, impulse / block.mass_kg, turning);
        }
    }

    /// Unit force on the block at its first end; the force on the block at its second end is opposite.
    fn unit_pull(&self) -> Momentum {
        Momentum::applied_at(self.ends_m[0], self.direction)
    }

    /// Rate at which the tie lengthens for given velocities of the blocks; supports are at rest.
    pub fn lengthening(&self, velocities: &[Twist]) -> f64 {
        let pull = self.unit_pull();
        let power = |block: usize| velocities[block].power(&pull);
        let [first, second] = self.ends.map(|block| block.map_or(0.0, power));
        second - first
    }
}

/// Sum of the impulses of ties on each block.
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
    // Consecutive ties are often between the same blocks, so sum them in registers.
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

/// Adds the effect of tie impulses to the velocities of blocks with given centres.
pub(crate) fn pull_blocks<'a>(
    blocks: &[Block],
    centres_m: &[Vector2<f64>],
    ties: impl Iterator<Item = (&'a TieLine, f64)>,
    velocities: &mut [Twist],
) {
    let pulls = sum_pulls(blocks.len(), ties);
    let bodies = blocks.iter().zip(centres_m).zip(&pulls);
    for (((block, centre_m), pull), velocity) in bodies.zip(velocities) {
        let rate = pull.moment_about(*centre_m) / block.inertia_kg_m2;
        let gained = Twist::translation(pull.linear / block.mass_kg);
        *velocity = *velocity + gained + Twist::rotation(*centre_m, rate);
    }
}

/// State of a tie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TieMemory<R> {
    /// Stretch beyond the unstressed length, in m.
    pub stretch_m: R,
    /// Current force, in N.
    pub force_n: R,
    /// Largest force up to now, in N.
    pub peak_n: R,
    /// Plastic elongation, in m.
    pub yielded_m: R,
    /// 1 for an intact tie, 0 after its break.
    pub intact: R,
    /// Energy dissipated up to now by yield and break, in J.
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
    /// State of a tie after slow stretching to `stretch_m` beyond its unstressed length; `yielded_m` is the plastic elongation before.
    /// The dissipated energy starts from zero.
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

    /// Updates the state for a new stretch beyond the unstressed length, in m.
    ///
    /// The dissipated energy is the mean force of the step times the plastic elongation. Together with the elastic energy this equals the work by the
    /// trapezoidal rule, except in steps in which the tie begins to yield or becomes slack.
    #[inline(always)]
    pub fn stretch(&mut self, tie: &Tie, stretch_m: R) {
        if tie.is_constant_force() {
            self.stretch_m = stretch_m;
            self.force_n = R::of(tie.prestress_n);
            self.peak_n = self.force_n;
            return;
        }
        let zero = R::of(0.0);
        let pulls_n = ((stretch_m - self.yielded_m) * tie.stiffness_n_m).max(zero);
        let force_n = pulls_n.min(R::of(tie.yield_force_n));
        let more_m = (pulls_n - force_n) * (1.0 / tie.stiffness_n_m);
        // The unstressed length is positive.
        let breaks_m = R::of(tie.breaks_at_strain * tie.slack_length_m());
        // A tie that breaks within the step has its largest force at the break.
        let pulls_n = (stretch_m.min(breaks_m) - self.yielded_m) * tie.stiffness_n_m;
        let hardest_n = pulls_n.max(zero).min(R::of(tie.yield_force_n));
        self.peak_n = self.peak_n.max(hardest_n * self.intact);
        self.yielded_m += more_m * self.intact;
        let yielded_j = (self.force_n + force_n) * more_m * 0.5 * self.intact;
        let left_m = breaks_m - stretch_m;
        let intact = left_m.positive(self.intact, zero);
        // Elastic energy before the break, and the work of this step by the trapezoidal rule with zero force at its end.
        let last_j = self.force_n * (stretch_m - self.stretch_m) * 0.5;
        let lost_j = (self.energy_j(tie) + last_j) * (self.intact - intact);
        self.taken_j += yielded_j * intact + lost_j;
        self.stretch_m = stretch_m;
        self.force_n = force_n * intact;
        self.intact = intact;
    }

    /// State of a tie in the undeformed structure.
    pub fn undeformed(tie: &Tie) -> Self {
        let stretch_m = match tie.is_constant_force() {
            true => 0.0,
            false => tie.prestress_n / tie.stiffness_n_m,
        };
        Self::stretched(tie, 0.0, R::of(stretch_m))
    }

    /// Elastic energy, or the potential energy of a constant force above that in the undeformed structure, in J.
    #[inline(always)]
    pub fn energy_j(&self, tie: &Tie) -> R {
        if tie.is_constant_force() {
            return self.force_n * self.stretch_m;
        }
        self.force_n * self.force_n * (0.5 / tie.stiffness_n_m)
    }
}

impl TieMemory<Lanes<1>> {
    /// State after slow stretching to `stretch_m`, without dissipated energy.
    pub fn then(&self, tie: &Tie, stretch_m: f64) -> Self {
        let stretch_m = Lanes([stretch_m]);
        if self.is_broken() {
            return Self { stretch_m, ..*self };
        }
        Self::stretched(tie, self.yielded_m.0[0], stretch_m)
    }

    /// Whether the tie has broken.
    pub fn is_broken(&self) -> bool {
        self.intact.0[0] == 0.0
    }
}
