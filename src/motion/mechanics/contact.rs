//! The velocities of a row of blocks whose joints may open but neither close further nor slide.
//!
//! Given the velocities that the blocks would have without each other, the row takes the nearest ones, in the metric of the kinetic
//! energy, among those that close no joint further: a convex quadratic program, with one solution. Its multipliers are the impulses
//! at the corners of the joints. Both are compressive where a joint stays shut: the thrust line then passes between them. Where it
//! reaches a corner, the joint opens about that corner. So the active constraints are the shut joints (both corners active), the
//! hinges (one), and the parted joints (none).
//!
//! Shut joints make rigid bodies of the blocks between open joints. The impulses at open joints solve a block-tridiagonal system of
//! 2x2 blocks, one per open joint; those at the shut joints follow by one running sum of the changes of momentum. The active set is
//! found from the last one by exchanges of many corners at once, which nearly always succeed. The rest is left to the dual method
//! of Goldfarb and Idnani ("A numerically stable dual method for solving strictly convex quadratic programs", Math. Programming 27,
//! 1983): corners that pull are released, then the corner that closes fastest is stopped. Rows that depend on others never become
//! active, so rest, where the impulses are not unique, is no special case.
//!
//! Bodies and pivots do not depend on the motion: those to the left of the first change of corners are kept from solution to
//! solution.

mod answer;
pub mod closing;
mod dual;
mod exchange;
mod factor;
mod placed;

use nalgebra::Vector2;
use thiserror::Error;

use super::blocks::{Row, Supports};
use super::joints::{Closure, Placement};
use super::tie::{TieLine, pull_blocks};
use crate::mechanics::geometry::field::Twist;
use crate::mechanics::geometry::ring::MassMoments;

use answer::Answer;
use exchange::Wrong;
use factor::Factor;

/// Corner impulses pull when they are more negative than this fraction of all momentum, for rows that nothing presses together.
const MOMENTUM_TOLERANCE: f64 = 1e-14;
/// Corners count as closing when they do so faster than this fraction of the largest velocity.
const RATE_TOLERANCE: f64 = 1e-11;
/// A corner depends on the active ones if a unit impulse accelerates it by less than this fraction of what
/// it does to free bodies.
const DEPENDENCE: f64 = 1e-10;

/// Why a program has no solution, or none was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ContactError {
    /// The program was not solved within its number of iterations, at the loosest tolerance.
    #[error(
        "the velocities of the blocks were not found in {iterations} iterations: where the heaviest block is more than some \
         1e5 times as heavy as the lightest, numbers are not exact enough; make their weights more alike"
    )]
    Unsolved {
        /// Iterations spent.
        iterations: usize,
    },
    /// No velocities satisfy the program: whatever the blocks do, the corner of a joint closes further. Supports that approach each other
    /// jam a flat, thick arch.
    #[error(
        "the blocks jam: rigid blocks that do not slide cannot follow the supports, since joint {joint} (from 0 at the left springing) \
         would overlap"
    )]
    Jammed {
        /// Index of the joint, from 0 on the left support.
        joint: usize,
    },
}

/// The cost of a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Systems of pin forces solved.
    pub iterations: usize,
    /// Number of times that the tolerance was relaxed tenfold.
    pub relaxed: usize,
}

/// Corners of a joint, intrados and extrados: true for those concerned.
pub type Corners = [bool; 2];

/// The data of a program, besides the positions.
#[derive(Clone, Debug)]
pub struct Load {
    /// Motion of every block without the others (m/s at the origin, rad/s).
    pub free: Vec<Twist>,
    /// Motion of the right block of every joint relative to its left one that counts as standing still.
    pub jumps: Vec<Twist>,
    /// Corners that may not close further.
    pub touching: Vec<Corners>,
}

impl Load {
    /// None on a row whose joints are shut.
    #[must_use]
    pub fn none(row: &Row) -> Self {
        let (blocks, joints) = (row.blocks.len(), row.joints.len());
        Self {
            free: vec![Twist::ZERO; blocks],
            jumps: vec![Twist::ZERO; joints],
            touching: vec![[true; 2]; joints],
        }
    }

    /// Takes a force per unit mass on all blocks where they are, with impulses of ties; corners that touch there may not close further.
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

/// The program of a row, with all the memory that it needs and the active set of the last solution.
#[derive(Clone, Debug)]
pub struct Program {
    /// Active corners of every joint: where the joint is pressed, in the last solution.
    pub active: Vec<Corners>,
    factor: Factor,
    answer: Answer,
    /// Response to a unit impulse at one corner.
    response: Answer,
    /// Velocities of the blocks in the last solution.
    pub velocities: Vec<Twist>,
    force_floor: f64,
    /// Corners that pull or close.
    wrong: Vec<Wrong>,
    /// The active set before the last exchange.
    earlier: Vec<Corners>,
    /// The joint that closes although all active corners press more the more it is pressed.
    jammed: Option<usize>,
}

impl Program {
    /// A program for the undeformed row that starts with all joints of a stack shut, or with an arch of three pins.
    #[must_use]
    pub fn new(row: &Row) -> Self {
        let (blocks, joints) = (row.blocks.len(), row.joints.len());
        let mut program = Self {
            active: vec![[true; 2]; joints],
            factor: Factor::new(row),
            answer: Answer::with_capacity(joints),
            response: Answer::with_capacity(joints),
            velocities: vec![Twist::ZERO; blocks],
            force_floor: 0.0,
            wrong: Vec::with_capacity(2 * joints),
            earlier: vec![[true; 2]; joints],
            jammed: None,
        };
        program.place(&Placement::new(row));
        program.reset();
        program
    }

    /// Takes the positions of the blocks.
    pub fn place(&mut self, placement: &Placement) {
        self.factor.place(placement);
    }

    /// Goes back to the initial active set.
    pub fn reset(&mut self) {
        self.active.fill([true; 2]);
        if self.factor.row.supports == Supports::Both {
            let last = self.active.len() - 1;
            // Three hinges, so that the impulses at rest are determined; one block has two joints only.
            self.active[0] = [true, false];
            self.active[last] = [last > 1, false];
            if last > 1 {
                self.active[last / 2] = [false, true];
            }
        }
    }

    /// Starts the next solution from these active corners.
    pub(crate) fn start_from(&mut self, active: &[Corners]) {
        self.active.copy_from_slice(active);
    }

    /// Starts the next solution with this corner active too.
    pub fn press(&mut self, joint: usize, edge: usize) {
        self.active[joint][edge] = true;
    }

    /// Mass moments of the blocks before each joint, about the origin.
    #[must_use]
    pub fn moments(&self) -> &[MassMoments] {
        &self.factor.row.moments
    }

    /// The joints that are open in the last solution, and the rates of their gaps in m/s, relative to the
    /// jumps. A corner that is pressed has the rate zero.
    pub fn open_joints(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let joints = self.factor.pins.iter().map(|pin| pin.joint);
        joints.zip(self.answer.rates.iter().copied())
    }

    /// Impulses in N s at the corners of every joint, intrados and extrados.
    #[must_use]
    pub(crate) fn corner_impulses(&self) -> &[[f64; 2]] {
        &self.answer.corners
    }

    /// Impulses in N s on the right block of every joint: along the joint towards the extrados, and normal.
    pub(crate) fn joint_impulses(&self, into: &mut [[f64; 2]]) {
        self.answer.joint_impulses(&self.factor, into);
    }

    /// Solves the program for the row where it was placed.
    ///
    /// # Errors
    /// When the active set is not found.
    pub fn solve(&mut self, load: &Load) -> Result<Effort, ContactError> {
        let largest_rate = self.set_up(load);
        for (active, touching) in self.active.iter_mut().zip(&load.touching) {
            for edge in 0..2 {
                active[edge] &= touching[edge];
            }
        }
        let mut effort = Effort::default();
        if !exceeds(self.factor.update(&self.active), DEPENDENCE * DEPENDENCE) {
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
        found.ok_or(ContactError::Unsolved { iterations })
    }

    /// The fastest velocity under a load on the row where it was placed: of a centre, or the rate of a block times the size of the row.
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
            twist.at(*centre).norm().max(turning)
        });
        Ok(speeds.fold(0.0, f64::max))
    }

    /// Velocities under another load while the same corners press as in the last solution, even where they would pull.
    pub(crate) fn solve_alike(&mut self, load: &Load) {
        self.set_up(load);
        self.answer.take_load(&self.factor, None);
        self.set_velocities();
    }

    /// Number of independent motions that the pressed corners allow.
    pub(crate) fn freedom(&self) -> usize {
        let moving = self.factor.bodies.iter().filter(|body| !body.is_held());
        let pressed = self.factor.pins.iter().filter(|pin| !pin.parted);
        (3 * moving.count()).saturating_sub(2 * pressed.count())
    }

    /// Takes the load; returns the largest velocity.
    fn set_up(&mut self, load: &Load) -> f64 {
        let (largest_rate, momentum) = self.factor.row.load(load);
        self.force_floor = MOMENTUM_TOLERANCE * momentum;
        largest_rate
    }

    /// Velocities of the blocks in the last solution. False where they are not finite.
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

    /// The displacement of least kinetic norm that takes up the closure error of an arch, without opening or shutting a
    /// joint: changes of the gaps at the open joints, through [`Program::open_joints`]. False when the open joints
    /// leave no such displacement.
    pub fn close(&mut self, placement: &Placement, closure: &Closure, load: &Load) -> bool {
        self.place(placement);
        self.set_up(load);
        for (active, gaps) in self.active.iter_mut().zip(&placement.gaps_m) {
            *active = gaps.map(|gap| gap == 0.0);
        }
        let independent = exceeds(self.factor.update(&self.active), DEPENDENCE * DEPENDENCE);
        let closes = independent && !self.factor.pins.is_empty();
        if closes {
            self.answer.take_closure(&self.factor, closure);
        }
        closes
    }
}

/// False also for a pivot that is NaN.
fn exceeds(pivot: f64, least: f64) -> bool {
    pivot > least
}

/// The lower of two numbers; the second one if either is NaN.
pub(super) fn lower(one: f64, other: f64) -> f64 {
    if one <= other { one } else { other }
}

/// The higher of two numbers; the first one if either is NaN.
fn higher(one: f64, other: f64) -> f64 {
    if other > one { other } else { one }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::ring::Ring;

    /// Whatever the motion of the blocks, exchanges of many corners lead to the same velocities as the dual method alone, which
    /// starts from the initial corners. Nearly always they do so without its help, in a few dozen rounds.
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
                let mut program = Program::new(&row);
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
                    let begin = |program: &mut Program| {
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
                        let off_m_s = (*twist - solution[block]).at(centre).norm();
                        assert!(off_m_s < 1e-8 * largest_rate, "{blocks}: {off_m_s:e}");
                    }
                }
            }
        }
        // Measured: 153 of 160 in at most 39 rounds; in the others corners depend on each other, and the dual method is needed.
        let counts = [settled, programs, most];
        assert!(20 * settled >= 19 * programs && most <= 60, "{counts:?}");
    }
}
