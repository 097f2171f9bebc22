//! Velocities of a row of blocks under unilateral contact: joints may open, but may neither close beyond contact nor slide.
//!
//! Input are the free velocities: those of the blocks without contact forces. The solution is the nearest admissible set of velocities, in the metric
//! of the kinetic energy. This is a strictly convex quadratic program with a unique solution. Its multipliers are the impulses at the corners of the
//! joints. In a closed joint both impulses are compressive: the thrust line passes between the corners. Where the thrust line reaches a corner, the
//! joint opens about that corner. The active set thus has both corners of closed joints, one corner of hinges, and no corner of parted joints.
//!
//! The blocks between open joints form rigid bodies. The impulses at open joints solve a block-tridiagonal system with one 2x2 block per open joint.
//! The impulses at closed joints follow from a running sum of momentum changes. The search for the active set starts from the last one and exchanges
//! many corners at once, which nearly always succeeds. Otherwise the dual method of Goldfarb and Idnani takes over ("A numerically stable dual method
//! for solving strictly convex quadratic programs", Math. Programming 27, 1983): it releases corners that pull, then adds the corner that closes
//! fastest. Linearly dependent constraints never become active. A row at rest, with impulses that are not unique, is therefore no special case.
//!
//! Bodies and pivots do not depend on the velocities: those left of the first changed corner are reused from one solution to the next.

mod answer;
pub mod closing;
mod dual;
mod exchange;
mod factor;
mod placed;

use nalgebra::Vector2;
use thiserror::Error;

use super::joints::Closure;
use super::tie::pull_blocks;

use crate::mechanics::{MassMoments, Placement, Row, Supports, TieLine, Twist};
use answer::PinSolution;
use exchange::WrongCorner;
use factor::Factor;

/// Tolerance for tensile corner impulses, relative to the sum of all momenta; it matters for rows without compression.
const MOMENTUM_TOLERANCE: f64 = 1e-14;
/// Tolerance for closing rates of corners, relative to the largest velocity.
const RATE_TOLERANCE: f64 = 1e-11;
/// A corner is linearly dependent on the active ones if its compliance under a unit impulse is below this fraction of the compliance of free bodies.
const DEPENDENCE: f64 = 1e-10;

/// Reason why a quadratic program has no solution, or why none was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ContactError {
    /// The active set was not found within this number of iterations, at the loosest tolerance.
    #[error(
        "the velocities of the blocks were not found in {0} iterations. A likely reason is a heaviest block of more than some 1e5 times \
         the weight of the lightest: use more similar weights"
    )]
    Unsolved(usize),
    /// No velocities are admissible: the corner of this joint, from 0 on the left support, closes further under any motion of the blocks. An
    /// example is a flat, thick arch whose supports approach each other.
    #[error(
        "the blocks jam: rigid blocks that do not slide cannot follow the supports, since joint {0} (from 0 at the left springing) \
         would overlap"
    )]
    Jammed(usize),
}

/// Computational effort of a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Number of solved pin systems.
    pub iterations: usize,
    /// Number of times the tolerance was relaxed, tenfold each time.
    pub relaxed: usize,
}

/// Flags of the two corners of a joint: intrados, extrados.
pub type Corners = [bool; 2];

/// Input of a quadratic program, besides the positions.
#[derive(Clone, Debug)]
pub struct Load {
    /// Free velocity of every block, without contact forces (m/s at the origin, rad/s).
    pub free: Vec<Twist>,
    /// Prescribed relative velocity of the block after each joint against the block before it, at which the joint counts as at rest.
    pub jumps: Vec<Twist>,
    /// Corners in contact, which may not close further.
    pub touching: Vec<Corners>,
}

impl Load {
    /// Zero load of a row with all joints closed.
    pub fn none(row: &Row) -> Self {
        let (blocks, joints) = (row.blocks.len(), row.joints.len());
        Self {
            free: vec![Twist::ZERO; blocks],
            jumps: vec![Twist::ZERO; joints],
            touching: vec![[true; 2]; joints],
        }
    }

    /// Sets the load to a force per unit mass on all blocks of a placement, with forces of ties. Corners in contact are constrained.
    pub(super) fn push<'a>(
        &mut self,
        row: &Row,
        placement: &Placement,
        force: Vector2<f64>,
        ties: impl Iterator<Item = (&'a TieLine, f64)>,
    ) {
        self.free.fill(Twist::translation(force));
        pull_blocks(&row.blocks, &placement.centres_m, ties, &mut self.free);
        for (touching, gaps) in self.touching.iter_mut().zip(&placement.gaps_m) {
            *touching = gaps.map(|gap| gap == 0.0);
        }
    }
}

/// Quadratic program of a row, with its work space and the active set of the last solution.
#[derive(Clone, Debug)]
pub struct ContactProgram {
    /// Active corners of every joint in the last solution: those with a compressive impulse.
    pub active: Vec<Corners>,
    factor: Factor,
    answer: PinSolution,
    /// Response to a unit impulse at one corner.
    response: PinSolution,
    /// Velocities of the blocks in the last solution.
    pub velocities: Vec<Twist>,
    force_floor: f64,
    /// Corners that violate a condition: active ones that pull, or inactive ones that close.
    wrong: Vec<WrongCorner>,
    /// Active set before the last exchange.
    earlier: Vec<Corners>,
    /// Joint that closes although an impulse there makes no active corner pull.
    jammed: Option<usize>,
}

impl ContactProgram {
    /// Program for the undeformed row. The initial active set has all joints of a stack closed, or three pins in an arch.
    pub fn new(row: &Row) -> Self {
        let (blocks, joints) = (row.blocks.len(), row.joints.len());
        let mut program = Self {
            active: vec![[true; 2]; joints],
            factor: Factor::new(row),
            answer: PinSolution::with_capacity(joints),
            response: PinSolution::with_capacity(joints),
            velocities: vec![Twist::ZERO; blocks],
            force_floor: 0.0,
            wrong: Vec::with_capacity(2 * joints),
            earlier: vec![[true; 2]; joints],
            jammed: None,
        };
        program.set_positions(&Placement::new(row));
        program.reset();
        program
    }

    /// Sets the positions of the blocks.
    pub fn set_positions(&mut self, placement: &Placement) {
        self.factor.set_positions(placement);
    }

    /// Resets the active set to the initial one.
    pub fn reset(&mut self) {
        self.active.fill([true; 2]);
        if self.factor.row.supports == Supports::Both {
            let last = self.active.len() - 1;
            // Three hinges make the impulses at rest unique; a single block has two joints only.
            self.active[0] = [true, false];
            self.active[last] = [last > 1, false];
            if last > 1 {
                self.active[last / 2] = [false, true];
            }
        }
    }

    /// Sets the active corners from which the next solution starts.
    pub(crate) fn start_from(&mut self, active: &[Corners]) {
        self.active.copy_from_slice(active);
    }

    /// Adds a corner to the active set from which the next solution starts.
    pub fn press(&mut self, joint: usize, edge: usize) {
        self.active[joint][edge] = true;
    }

    /// Mass moments about the origin of all blocks before each joint.
    pub fn moments(&self) -> &[MassMoments] {
        &self.factor.row.moments
    }

    /// Open joints of the last solution, with the rates of their gaps in m/s beyond the prescribed ones. Active corners have the rate
    /// zero.
    pub fn open_joints(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let joints = self.factor.pins.iter().map(|pin| pin.joint);
        joints.zip(self.answer.rates.iter().copied())
    }

    /// Impulses in N s at the corners of every joint: intrados, extrados.
    pub(crate) fn corner_impulses(&self) -> &[[f64; 2]] {
        &self.answer.corners
    }

    /// Writes the impulses in N s on the block after each joint: along the joint towards the extrados, and normal to it.
    pub(crate) fn joint_impulses(&self, into: &mut [[f64; 2]]) {
        self.answer.joint_impulses(&self.factor, into);
    }

    /// Solves the program for the current positions.
    ///
    /// # Errors
    /// If the active set is not found.
    pub fn solve(&mut self, load: &Load) -> Result<Effort, ContactError> {
        let largest_rate = self.set_up(load);
        for (active, touching) in self.active.iter_mut().zip(&load.touching) {
            for edge in 0..2 {
                active[edge] &= touching[edge];
            }
        }
        let mut effort = Effort::default();
        if !pivot_exceeds(self.factor.update(&self.active), DEPENDENCE * DEPENDENCE) {
            self.active.fill([false; 2]);
            self.factor.update(&self.active);
        }
        self.answer.take_load(&self.factor, None);
        effort.iterations += 1;
        let tolerance = RATE_TOLERANCE * largest_rate;
        let touching = &load.touching;
        if !self.exchange(touching, tolerance, &mut effort.iterations) {
            self.exchange_tolerantly(touching, largest_rate, &mut effort)?;
        }
        let (finite, iterations) = (self.set_velocities(), effort.iterations);
        let found = finite.then_some(effort);
        found.ok_or(ContactError::Unsolved(iterations))
    }

    /// Largest velocity in m/s under a load: of a block's centre, or of a block's rotation times the size of the row.
    ///
    /// # Errors
    /// If the active set is not found.
    pub(super) fn fastest(
        &mut self,
        load: &Load,
        row: &Row,
        placement: &Placement,
    ) -> Result<f64, ContactError> {
        self.solve(load)?;
        let velocities = self.velocities.iter();
        let speeds = velocities.zip(&placement.centres_m).map(|(twist, centre)| {
            let turning = twist.rate.abs() * row.size_m;
            twist.velocity_at(*centre).norm().max(turning)
        });
        Ok(speeds.fold(0.0, f64::max))
    }

    /// Computes the velocities under another load with the active corners of the last solution, even if some of these pull.
    pub(crate) fn solve_with_last_corners(&mut self, load: &Load) {
        self.set_up(load);
        self.answer.take_load(&self.factor, None);
        self.set_velocities();
    }

    /// Number of degrees of freedom under the active constraints.
    pub(crate) fn freedom(&self) -> usize {
        let moving = self.factor.bodies.iter().filter(|body| !body.is_held());
        let pressed = self.factor.pins.iter().filter(|pin| !pin.parted);
        (3 * moving.count()).saturating_sub(2 * pressed.count())
    }

    /// Sets the load and returns the largest velocity.
    fn set_up(&mut self, load: &Load) -> f64 {
        let (largest_rate, momentum) = self.factor.row.load(load);
        self.force_floor = MOMENTUM_TOLERANCE * momentum;
        largest_rate
    }

    /// Computes the velocities of the blocks. Returns false if they are not finite.
    fn set_velocities(&mut self) -> bool {
        let mut sum = 0.0;
        for body in 0..self.factor.bodies.len() {
            let twist = self.answer.motions[body].twist();
            let blocks = self.factor.blocks(body);
            let velocities = self.velocities[blocks.clone()].iter_mut();
            for (velocity, datum) in velocities.zip(&self.factor.row.datum[blocks]) {
                *velocity = twist + *datum;
                sum += velocity.rate + velocity.at_center.x + velocity.at_center.y;
            }
        }
        sum.is_finite()
    }

    /// Computes the displacement of least kinetic norm that removes the closure error of an arch, without opening or closing joints.
    /// [`ContactProgram::open_joints`] then returns the changes of the gaps. Returns false if the open joints allow no such displacement.
    pub fn compute_closing(
        &mut self,
        placement: &Placement,
        closure: &Closure,
        load: &Load,
    ) -> bool {
        self.set_positions(placement);
        self.set_up(load);
        for (active, gaps) in self.active.iter_mut().zip(&placement.gaps_m) {
            *active = gaps.map(|gap| gap == 0.0);
        }
        let independent = pivot_exceeds(self.factor.update(&self.active), DEPENDENCE * DEPENDENCE);
        let closes = independent && !self.factor.pins.is_empty();
        if closes {
            self.answer.take_closure(&self.factor, closure);
        }
        closes
    }
}

/// Whether a pivot exceeds a limit; false for NaN.
fn pivot_exceeds(pivot: f64, least: f64) -> bool {
    pivot > least
}

/// Lower of two numbers; the second one if either is NaN.
pub(super) fn lower(one: f64, other: f64) -> f64 {
    if one <= other { one } else { other }
}

/// Higher of two numbers; the first one if either is NaN.
fn higher_number(one: f64, other: f64) -> f64 {
    if other > one { other } else { one }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::ring::Ring;

    /// Exchanges of many corners give the same velocities as the dual method alone, which starts from the initial active set. In nearly all programs
    /// they converge without the dual method, within a few dozen rounds.
    #[test]
    fn the_dual_method_alone_has_the_same_solution() {
        let mut state = 7_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            f64::from((state >> 40) as u32) / f64::from(1_u32 << 24)
        };
        let (mut programs, mut settled, mut most) = (0, 0, 0);
        for blocks in [3, 20, 60, 150] {
            let arch = Row::arch(&Ring::new(0.15, 2.5).unwrap(), blocks, 5.0, 1.0, 2000.0);
            let stack = Row::tapered_stack(&vec![0.5; blocks], 2.0, 1.0, 1.0, 2000.0);
            for row in [arch.unwrap(), stack.unwrap()] {
                let mut program = ContactProgram::new(&row);
                let joints = row.joints.len();
                for _ in 0..20 {
                    let motion = |x: f64, y: f64, rate: f64| {
                        Twist::translation(Vector2::new(x - 0.5, y - 0.5))
                            + Twist::rotation(Vector2::zeros(), rate - 0.5)
                    };
                    let free: Vec<Twist> = (0..blocks)
                        .map(|_| motion(next(), next(), next()))
                        .collect();
                    let jumps = vec![Twist::translation(Vector2::new(0.01 * next(), 0.0)); joints];
                    let touching: Vec<Corners> =
                        (0..joints).map(|_| [next() < 0.9, next() < 0.9]).collect();
                    let load = Load {
                        free,
                        jumps,
                        touching,
                    };
                    let touching = &load.touching;
                    let begin = |program: &mut ContactProgram| {
                        program.reset();
                        let largest_rate = program.set_up(&load);
                        for (active, touching) in program.active.iter_mut().zip(touching) {
                            *active = [0, 1].map(|edge| active[edge] && touching[edge]);
                        }
                        program.factor.update(&program.active);
                        program.answer.take_load(&program.factor, None);
                        largest_rate
                    };
                    let tolerance = RATE_TOLERANCE * begin(&mut program);
                    let mut iterations = 0;
                    programs += 1;
                    settled += usize::from(program.exchange(touching, tolerance, &mut iterations));
                    most = most.max(iterations);
                    program.solve(&load).unwrap();
                    let solution = program.velocities.clone();

                    let largest_rate = begin(&mut program);
                    let mut effort = Effort::default();
                    program
                        .exchange_tolerantly(touching, largest_rate, &mut effort)
                        .unwrap();
                    program.set_velocities();
                    for (block, twist) in program.velocities.iter().enumerate() {
                        let centre = program.factor.row.own[block].centroid();
                        let off_m_s = (*twist - solution[block]).velocity_at(centre).norm();
                        assert!(off_m_s < 1e-8 * largest_rate, "{blocks}: {off_m_s:e}");
                    }
                }
            }
        }
        // Measured: 153 of 160 converge within 39 rounds; the others have dependent corners and need the dual method.
        let counts = [settled, programs, most];
        assert!(20 * settled >= 19 * programs && most <= 60, "{counts:?}");
    }
}
