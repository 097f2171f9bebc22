//! Slow collapse of a row: steepest descent of its potential energy.
//!
//! The blocks move as in a viscous fluid whose resistance is proportional to mass. The velocities are then the admissible ones nearest to
//! the load: the contact program of a motion ([`crate::mechanics::contact`]). Descents in which rotations had ten and a hundred times the
//! weight led to the same hinges.
//!
//! Explicit forces of stiff ties would limit the step length. So the forces are implicit: those at the end of the step. Velocities are
//! linear in these forces while the set of closed corners stays, and the energy of a step is convex in them. Newton's method with a line
//! search therefore finds the forces of all ties together.
//!
//! The residual of a tie is a length, not a force: a stiff tie turns the rounding error of a length into a large force.

use nalgebra::{DMatrix, DVector, Vector2};

use super::{Condition, Pins, ROUNDING};
use crate::mechanics::contact::closing::{ClosureSolver, FirstShut};
use crate::mechanics::contact::{ContactError, ContactProgram, Load};
use crate::mechanics::{Corners, Pose, Row, RowState, SettlingError, TieLine, Twist};

/// Velocities below this part of those without contact are zero.
const STANDSTILL: f64 = 1e-9;
/// Longest movement of a point in a step, over the size of the row.
const STEP: f64 = 1e-3;
/// Longest movement in a step of a row with ties, over the movement since the start of the descent; the larger of both limits holds.
const STRIDE: f64 = 0.02;
/// Factor of `STRIDE` while the descent accelerates: an equilibrium is then not near.
const ACCELERATING: f64 = 2.0;
/// A row falls once a block has moved by this part of the size, or turned by as many radians.
const FALLEN: f64 = 0.5;
/// An arch has fallen apart once the gap at its closure exceeds this part of its size.
const PARTED: f64 = 1e-6;
/// Limit of the number of steps of a descent. Only a descent that oscillates reaches it.
const MOST_STEPS: usize = 20_000;
/// An equilibrium held by ties is near if no block turns by more than this on the way to it, in radians.
const NEAR_RAD: f64 = 1e-2;
/// Tolerance of tie forces, over the weight.
const FORCE_TOLERANCE: f64 = 1e-11;
/// Lengths below this part of the movement under gravity alone in a step are rounding errors.
const ROUNDING_LENGTH: f64 = 1e-14;
/// Limit of the number of Newton steps for the tie forces.
const MOST_ROUNDS: usize = 100;
/// Limit of the number of trials of a line search.
const MOST_TRIALS: usize = 20;
/// A line search ends when the slope of the energy is below this part of its initial slope.
const LINE_SEARCH_SLOPE: f64 = 0.1;
/// Responses to tie forces below this part of those of free blocks are rounding errors.
const NO_MOTION: f64 = 1e-9;
/// Shortest step after tie forces were not found, over the original step.
const SHORTEST: f64 = 1e-6;
/// Longest step of a descent with ties: in it gravity alone moves the row by this multiple of its size.
const LONGEST: f64 = 1e3;

/// A step of a descent with ties.
struct DescentStep<'a> {
    stance: &'a RowState,
    /// Lines of the ties at the beginning of the step.
    lines: &'a [TieLine],
    /// Smallest and largest force of each tie, over gravity.
    bounds_kg: Vec<[f64; 2]>,
    force_g: Vector2<f64>,
    length: f64,
    /// Closed corners for which `elongation_rates` was computed; empty before that.
    closed_corners: Vec<Corners>,
    /// The matrix of [`Descent::elongation_rates`].
    elongation_rates: DMatrix<f64>,
}

impl<'a> DescentStep<'a> {
    fn new(row: &Row, stance: &'a RowState, lines: &'a [TieLine], force_g: Vector2<f64>) -> Self {
        let ties = row.ties.iter().zip(&stance.ties);
        let most_kg = ties.map(|(tie, memory)| {
            let (broken, most_n) = (memory.is_broken(), tie.yield_force_n);
            (if broken { 0.0 } else { most_n }) / row.gravity_m_s2
        });
        Self {
            stance,
            lines,
            bounds_kg: most_kg.map(|most_kg| [0.0, most_kg]).collect(),
            force_g,
            length: 0.0,
            closed_corners: Vec::new(),
            elongation_rates: DMatrix::zeros(0, 0),
        }
    }
}

/// The descent of a row, with its buffers.
#[derive(Clone, Debug)]
pub(super) struct Descent<'a> {
    row: &'a Row,
    program: ContactProgram,
    load: Load,
    closure_solver: ClosureSolver,
    /// Force of each tie over gravity.
    ties_kg: Vec<f64>,
    /// Flexibility of each tie, in m/kg.
    ties_m_kg: Vec<f64>,
}

impl<'a> Descent<'a> {
    pub fn new(row: &'a Row) -> Self {
        let ties = row.ties.iter();
        let m_kg = ties.map(|tie| row.gravity_m_s2 / tie.stiffness_n_m);
        Self {
            row,
            program: ContactProgram::new(row),
            load: Load::none(row),
            closure_solver: ClosureSolver::new(row),
            ties_kg: vec![0.0; row.ties.len()],
            ties_m_kg: m_kg.collect(),
        }
    }

    /// Changes the condition of a row by a small step, and lets the row come to rest. Returns false if it falls. A push of `tilt_g`
    /// makes a symmetric row choose a side.
    pub fn settle(
        &mut self,
        stance: &mut RowState,
        from: &Condition,
        to: &Condition,
        tilt_g: f64,
    ) -> Result<bool, SettlingError> {
        let size_m = self.row.size_m;
        let force_g = to.force_g + Vector2::new(tilt_g, 0.0);
        let gravity_m_s2 = self.row.gravity_m_s2;
        let forces = stance.forces_n().map(|force_n| force_n / gravity_m_s2);
        self.ties_kg = forces.collect();
        self.program.reset();
        self.program.set_positions(&stance.placement);
        let mut lines = self.move_supports(stance, from, to, force_g)?;
        self.load.jumps.fill(Twist::ZERO);
        let start_m = stance.placement.centres_m.to_vec();
        let turns = |stance: &RowState| {
            let poses = stance.placement.poses.iter();
            poses.map(Pose::rotation_rad).collect::<Vec<f64>>()
        };
        let start_rad = turns(stance);
        let (mut farthest_m, mut longest) = (STEP * size_m, STEP * size_m);
        let (mut hinges, mut stayed) = (Vec::new(), 0_u32);
        let (mut before, mut accelerates) = (f64::INFINITY, false);
        for step in 0..MOST_STEPS {
            // An equilibrium costs as much as many steps, and new hinges are seldom those of rest: look for it ever more rarely.
            let pins = (!self.ties_kg.is_empty()).then(|| Pins::of(self.row, &stance.placement));
            if let Some(pins) = pins.flatten() {
                stayed = if pins.hinges == hinges { stayed + 1 } else { 0 };
                hinges = pins.hinges.to_vec();
                let due = step == 0 || stayed.is_power_of_two() && !accelerates;
                if due && self.is_near_equilibrium(&pins, stance, to) {
                    return Ok(true);
                }
            }
            let fastest = if self.ties_kg.is_empty() {
                let fastest = self.solve(stance, &[], force_g, 1.0)?;
                longest = farthest_m / fastest;
                fastest
            } else {
                self.solve_with_ties(stance, &lines, force_g, farthest_m, &mut longest)?
            };
            if fastest <= STANDSTILL {
                return Ok(true);
            }
            let first_shut = self.program.first_shut(&stance.placement, longest);
            lines = self.move_blocks(stance, first_shut);
            let allowed = (2.0 * longest).min(LONGEST * size_m);
            longest = (0.9 * farthest_m / fastest).min(allowed);
            let centres = start_m.iter().zip(&stance.placement.centres_m);
            let moved = centres.map(|(start, now)| (now - start).norm() / size_m);
            let turned = start_rad
                .iter()
                .zip(turns(stance))
                .map(|(start, now)| (now - start).abs());
            let gone = moved.chain(turned).fold(0.0, f64::max);
            if gone > FALLEN || stance.placement.closure_error() > PARTED * size_m {
                return Ok(false);
            }
            if !self.ties_kg.is_empty() {
                accelerates = fastest > before;
                let times = if accelerates { ACCELERATING } else { 1.0 };
                farthest_m = size_m * STEP.max(times * STRIDE * gone);
            }
            before = fastest;
        }
        Ok(false)
    }

    /// True if ties hold the row on these hinges in an equilibrium near by. Without ties the descent ends by itself.
    fn is_near_equilibrium(&self, pins: &Pins, stance: &RowState, condition: &Condition) -> bool {
        let state = pins.state(self.row, condition, stance);
        state.is_some_and(|state| {
            let pairs = state.rotations_rad.iter().zip(&stance.placement.poses);
            let mut turns = pairs.map(|(there, here)| (there - here.rotation_rad()).abs());
            state.is_admissible(ROUNDING) && turns.all(|turn_rad| turn_rad < NEAR_RAD)
        })
    }

    /// Moves the supports, and the row with them: of all admissible velocities the load selects those nearest to it. Each part of the
    /// movement ends when a joint closes. Returns the lines of the ties.
    fn move_supports(
        &mut self,
        stance: &mut RowState,
        from: &Condition,
        to: &Condition,
        force_g: Vector2<f64>,
    ) -> Result<Vec<TieLine>, ContactError> {
        let mut lines: Vec<TieLine> = stance.lines(self.row).collect();
        let mut here = from.supports;
        let last = self.row.joints.len() - 1;
        for _ in 0..=2 * last {
            if here == to.supports {
                break;
            }
            let moved = [0, 1].map(|side| twist_between(&here[side], &to.supports[side]));
            let jumps = &mut self.load.jumps;
            jumps.fill(Twist::ZERO);
            jumps[0] = moved[0];
            jumps[last] = jumps[last] - moved[1];
            self.solve(stance, &lines, force_g, self.row.size_m)?;
            let (part, shut) = self.program.first_shut(&stance.placement, 1.0);
            here = match shut {
                None => to.supports,
                Some(_) => {
                    [0, 1].map(|side| interpolate_pose(&here[side], &to.supports[side], part))
                }
            };
            stance.placement.move_supports(here);
            lines = self.move_blocks(stance, (part, shut));
        }
        Ok(lines)
    }

    /// Computes the velocities in the present position under a multiple of the load and of the tie forces. Returns the largest one.
    fn solve(
        &mut self,
        stance: &RowState,
        lines: &[TieLine],
        force_g: Vector2<f64>,
        times: f64,
    ) -> Result<f64, ContactError> {
        let placement = &stance.placement;
        let ties = lines.iter().zip(self.ties_kg.iter().map(|kg| kg * times));
        self.load.push(self.row, placement, force_g * times, ties);
        self.program.fastest(&self.load, self.row, placement)
    }

    /// Largest velocity with the tie forces at the end of the step. Shortens the step until no point moves farther than
    /// `farthest_m`.
    fn solve_with_ties(
        &mut self,
        stance: &RowState,
        lines: &[TieLine],
        force_g: Vector2<f64>,
        farthest_m: f64,
        longest: &mut f64,
    ) -> Result<f64, SettlingError> {
        let mut step = DescentStep::new(self.row, stance, lines, force_g);
        let (before_kg, shortest) = (self.ties_kg.clone(), SHORTEST * *longest);
        loop {
            step.length = *longest;
            let fastest = match self.balance_ties(&mut step) {
                // The shorter a step, the smaller the change of the forces.
                Err(SettlingError::Ties) if *longest > shortest => {
                    *longest *= 0.1;
                    self.ties_kg.clone_from(&before_kg);
                    continue;
                }
                result => result?,
            };
            if *longest * fastest <= farthest_m {
                return Ok(fastest);
            }
            *longest = (0.9 * farthest_m / fastest).max(0.1 * *longest);
        }
    }

    /// Computes the tie forces at the end of a step. Returns the largest velocity with these forces.
    ///
    /// # Errors
    /// When Newton's method does not converge.
    fn balance_ties(&mut self, step: &mut DescentStep<'_>) -> Result<f64, SettlingError> {
        // Some may have broken in the step before.
        for tie in 0..step.lines.len() {
            let [least_kg, most_kg] = step.bounds_kg[tie];
            self.ties_kg[tie] = self.ties_kg[tie].clamp(least_kg, most_kg);
        }
        let mut fastest = self.solve(step.stance, step.lines, step.force_g, 1.0)?;
        for _ in 0..MOST_ROUNDS {
            let residuals_m = self.residuals_m(step);
            // A tie alone would change its force by more than together with the others, so this bounds the errors.
            let least_kg = FORCE_TOLERANCE * self.row.mass_kg();
            let mut each = residuals_m.iter().zip(&self.ties_m_kg);
            if each.all(|(residuals_m, m_kg)| residuals_m.abs() <= least_kg * m_kg) {
                return Ok(fastest);
            }
            let responded = self.update_elongation_rates(step);
            let Some(newton_step_kg) = self.newton_step_kg(step, &residuals_m) else {
                break;
            };
            let pairs = newton_step_kg.iter().zip(&residuals_m);
            let wrong =
                pairs.filter(|(_, residuals_m)| residuals_m.abs() > ROUNDING_LENGTH * step.length);
            let left_kg = wrong.fold(0.0, |most: f64, (kg, _)| kg.abs().max(most));
            if left_kg <= FORCE_TOLERANCE * self.row.mass_kg() {
                if responded {
                    // The computation of responses overwrote the velocities.
                    fastest = self.solve(step.stance, step.lines, step.force_g, 1.0)?;
                }
                return Ok(fastest);
            }
            fastest = self.search_line(step, &newton_step_kg, residuals_m.dot(&newton_step_kg))?;
        }
        Err(SettlingError::Ties)
    }

    /// Residual of each tie with the last velocities, in m: its length at the end of the step less the length under its force.
    fn residuals_m(&self, step: &DescentStep<'_>) -> DVector<f64> {
        let velocities = &self.program.velocities;
        let residuals_m = step.lines.iter().enumerate().map(|(tie, line)| {
            let then_m = line.stretch_m + step.length * line.lengthening(velocities);
            let elastic_m = self.ties_kg[tie] * self.ties_m_kg[tie];
            then_m - step.stance.ties[tie].yielded_m.0[0] - elastic_m
        });
        DVector::from_iterator(self.ties_kg.len(), residuals_m)
    }

    /// Newton step of the tie forces, over gravity, for the present set of closed corners. Forces at a bound stay there if the
    /// step would exceed it. `None` if the step is not determined.
    ///
    /// The unknowns are the speeds of the few degrees of freedom of the row. The forces of many ties follow from them.
    fn newton_step_kg(
        &self,
        step: &DescentStep<'_>,
        residuals_m: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let elongation_rates = &step.elongation_rates;
        let modes = elongation_rates.ncols();
        let kg_m = self.ties_m_kg.iter().map(|m_kg| 1.0 / m_kg);
        let mut kg_m = DVector::from_iterator(residuals_m.len(), kg_m);
        let (mut newton_step_kg, mut found) = (residuals_m.clone(), false);
        loop {
            let mut all_go = true;
            for (tie, kg_m) in kg_m.iter_mut().enumerate() {
                if *kg_m != 0.0 && !self.may_change(step, tie, newton_step_kg[tie]) {
                    *kg_m = 0.0;
                    all_go = false;
                }
            }
            if found && all_go {
                return newton_step_kg
                    .iter()
                    .all(|kg| kg.is_finite())
                    .then_some(newton_step_kg);
            }
            let mut pulls = elongation_rates.clone();
            for mut mode in pulls.column_iter_mut() {
                mode.component_mul_assign(&kg_m);
            }
            let mut equations = DMatrix::identity(modes, modes);
            equations.gemm_tr(step.length, &pulls, elongation_rates, 1.0);
            let speeds = equations.cholesky()?.solve(&pulls.tr_mul(residuals_m));
            newton_step_kg.copy_from(residuals_m);
            newton_step_kg.gemv(-step.length, elongation_rates, &speeds, 1.0);
            newton_step_kg.component_mul_assign(&kg_m);
            found = true;
        }
    }

    /// True if the bounds of the force of a tie allow this change.
    fn may_change(&self, step: &DescentStep<'_>, tie: usize, change: f64) -> bool {
        let end_kg = step.bounds_kg[tie][usize::from(change > 0.0)];
        (end_kg - self.ties_kg[tie]) * change > 0.0 || change == 0.0
    }

    /// Updates `step.elongation_rates` if the set of closed corners has changed. Returns true if it has; the velocities are then lost.
    fn update_elongation_rates(&mut self, step: &mut DescentStep<'_>) -> bool {
        let unknown = step.closed_corners != self.program.active;
        if unknown {
            step.closed_corners = self.program.active.to_vec();
            step.elongation_rates = self.elongation_rates(step);
        }
        unknown
    }

    /// Rates of elongation of the ties (rows) in the motions (columns) that tie forces can cause while the set of closed corners stays.
    /// The motions are orthonormal with respect to kinetic energy.
    ///
    /// The response to tie forces is the projection of the free motion on the admissible motions. So responses to arbitrary forces span
    /// all these motions: the basis is complete once a response lies in it, or it has as many motions as there are degrees of freedom.
    fn elongation_rates(&mut self, step: &DescentStep<'_>) -> DMatrix<f64> {
        let (row, count) = (self.row, step.lines.len());
        let centres_m = &step.stance.placement.centres_m;
        let product = |one: &[Twist], other: &[Twist]| -> f64 {
            let pairs = one.iter().zip(other).zip(row.blocks.iter().zip(centres_m));
            let each = pairs.map(|((one, other), (block, centre_m))| {
                block.mass_kg
                    * one
                        .velocity_at(*centre_m)
                        .dot(&other.velocity_at(*centre_m))
                    + block.inertia_kg_m2 * one.rate * other.rate
            });
            each.sum()
        };
        let mut motions: Vec<Vec<Twist>> = Vec::new();
        while motions.len() < count.min(self.program.freedom()) {
            // Forces in irrational ratios, other ones in each trial.
            let ratio = (f64::sqrt(2.0) * motions.len() as f64).fract();
            let mut part = 0.0;
            self.respond(step, |_| {
                part += ratio - if part + ratio < 1.0 { 0.0 } else { 1.0 };
                part - 0.5
            });
            let mut motion = self.program.velocities.to_vec();
            // Gram-Schmidt twice, against rounding errors.
            for known in motions.iter().chain(&motions) {
                let part = product(known, &motion);
                for (twist, known) in motion.iter_mut().zip(known) {
                    *twist = *twist - *known * part;
                }
            }
            let size = product(&motion, &motion).sqrt();
            // A response that is not a number ends the search as well.
            if size.is_nan() || size <= NO_MOTION * product(&self.load.free, &self.load.free).sqrt()
            {
                break;
            }
            motions.push(motion.iter().map(|twist| *twist * (1.0 / size)).collect());
        }
        DMatrix::from_fn(count, motions.len(), |tie, motion| {
            step.lines[tie].lengthening(&motions[motion])
        })
    }

    /// Computes the response of the row to tie forces alone, over gravity, for the present set of closed corners.
    fn respond(&mut self, step: &DescentStep<'_>, mut kg: impl FnMut(usize) -> f64) {
        let ties = step
            .lines
            .iter()
            .enumerate()
            .map(|(tie, line)| (line, kg(tie)));
        (self.load).push(self.row, &step.stance.placement, Vector2::zeros(), ties);
        self.program.solve_with_last_corners(&self.load);
    }

    /// Line search: changes the tie forces along `newton_step_kg`, each up to its bound, until the energy of the step is close to its minimum.
    /// `falls` is the initial slope of the energy. Returns the largest velocity.
    fn search_line(
        &mut self,
        step: &mut DescentStep<'_>,
        newton_step_kg: &DVector<f64>,
        falls: f64,
    ) -> Result<f64, ContactError> {
        let from_kg = self.ties_kg.clone();
        // Part of the way at which the force of each tie reaches its bound.
        let bounds = from_kg.iter().zip(newton_step_kg).zip(&step.bounds_kg);
        let ends: Vec<f64> = bounds
            .map(|((kg, change_kg), bounds_kg)| {
                let end_kg = bounds_kg[usize::from(*change_kg > 0.0)];
                match *change_kg {
                    0.0 => f64::INFINITY,
                    change_kg => (end_kg - kg) / change_kg,
                }
            })
            .collect();
        // Up to here no force reaches its bound.
        let all = ends.iter().copied().fold(1.0, f64::min);
        let (mut part, mut near, mut far) = (1.0, 0.0, all);
        for _ in 0..MOST_TRIALS {
            for (tie, from_kg) in from_kg.iter().enumerate() {
                self.ties_kg[tie] = if part >= ends[tie] {
                    step.bounds_kg[tie][usize::from(newton_step_kg[tie] > 0.0)]
                } else {
                    from_kg + part * newton_step_kg[tie]
                };
            }
            let fastest = self.solve(step.stance, step.lines, step.force_g, 1.0)?;
            let falls_on = self.residuals_m(step).component_mul(newton_step_kg);
            // A force at its bound stays there, unless the slope points inwards.
            let goes = falls_on
                .iter()
                .zip(&ends)
                .filter(|(falls, end)| part <= **end || **falls < 0.0);
            let left: f64 = goes.map(|(falls, _)| falls).sum();
            if left.abs() <= LINE_SEARCH_SLOPE * falls || (part >= all && left > 0.0) {
                return Ok(fastest);
            }
            if part > all {
                part = all;
                continue;
            }
            if left > 0.0 {
                near = part;
            } else {
                far = part;
            }
            // Newton's method: the slope changes abruptly near forces at which the row stands still.
            self.update_elongation_rates(step);
            let elastic: f64 = self
                .ties_m_kg
                .iter()
                .zip(newton_step_kg)
                .map(|(m_kg, kg)| kg * kg * m_kg)
                .sum();
            let slope =
                elastic + step.length * step.elongation_rates.tr_mul(newton_step_kg).norm_squared();
            let next = part + left / slope;
            let (middle, lies_between) = (0.5 * (near + far), near < next && next < far);
            part = if lies_between { next } else { middle };
        }
        self.solve(step.stance, step.lines, step.force_g, 1.0)
    }

    /// Moves the blocks with the last velocities for the given time, and closes the given corner. Returns the lines of the ties.
    fn move_blocks(&mut self, stance: &mut RowState, first_shut: FirstShut) -> Vec<TieLine> {
        let placement = &mut stance.placement;
        let mut change = vec![[0.0; 2]; placement.gaps_m.len()];
        (self.program).open_until(placement, first_shut, &mut change);
        placement.change_gaps(|joint| change[joint]);
        self.closure_solver.remove_closure_error(placement);
        self.program.set_positions(placement);
        stance.stretch_ties(self.row)
    }
}

/// Interpolates linearly between two neighbouring poses.
fn interpolate_pose(from: &Pose, to: &Pose, part: f64) -> Pose {
    let between = |from: f64, to: f64| from + part * (to - from);
    let translation = from.translation + (to.translation - from.translation) * part;
    Pose::new(between(from.rotation_rad(), to.rotation_rad()), translation)
}

/// Constant velocity that moves a body from one pose to a neighbouring one in a unit of time.
fn twist_between(from: &Pose, to: &Pose) -> Twist {
    let rate = to.rotation_rad() - from.rotation_rad();
    Twist {
        at_center: to.translation
            - from.translation
            - Twist::rotation(Vector2::zeros(), rate).velocity_at(from.translation),
        rate,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::mechanics::geometry::ring::Ring;
    use crate::mechanics::tie::{Anchor, Tie};

    /// A row of 8 blocks with ties of the given joints and stiffnesses, each to the opposite joint.
    fn row_with_ties(ties: &[(usize, f64)]) -> Row {
        let ring = Ring::new(0.15, PI).unwrap();
        let row = Row::arch(&ring, 8, 1.0, 1.0, 1000.0).unwrap();
        let across = |(joint, stiffness_n_m): &(usize, f64)| Tie {
            ends: [(*joint, *joint), (7 - joint, 8 - joint)].map(|(block, joint)| Anchor {
                block: Some(block),
                at_m: row.joints[joint].intrados_m,
            }),
            stiffness_n_m: *stiffness_n_m,
            prestress_n: 0.0,
            yield_force_n: f64::INFINITY,
            breaks_at_strain: f64::INFINITY,
        };
        let ties = ties.iter().map(across).collect();
        row.with_ties(ties, 9.81).unwrap()
    }

    fn step<'a>(
        row: &Row,
        (stance, lines): &'a (RowState, Vec<TieLine>),
        force_g: Vector2<f64>,
        length: f64,
    ) -> DescentStep<'a> {
        DescentStep {
            length,
            ..DescentStep::new(row, stance, lines, force_g)
        }
    }

    fn undeformed_state(row: &Row) -> (RowState, Vec<TieLine>) {
        let stance = RowState::undeformed(row);
        let lines = stance.lines(row).collect();
        (stance, lines)
    }

    /// Two ties that one mechanism stretches: the force of each is that at the end of the step.
    #[test]
    fn ties_that_depend_on_each_other_are_balanced_together() {
        let row = row_with_ties(&[(2, 1e6), (1, 6e5)]);
        let (stance, length) = (undeformed_state(&row), 0.01);
        let mut descent = Descent::new(&row);
        let push_g = Vector2::new(0.6, -1.0);
        let mut step = step(&row, &stance, push_g, length);
        let fastest = descent.balance_ties(&mut step).unwrap();
        assert!(fastest > 0.01, "{fastest}");
        for (index, (tie, line)) in row.ties.iter().zip(&stance.1).enumerate() {
            let longer_m = length * line.lengthening(&descent.program.velocities);
            let then_kg = tie.stiffness_n_m * longer_m / row.gravity_m_s2;
            let kg = descent.ties_kg[index];
            assert!(kg > 0.01 * row.mass_kg(), "{kg}");
            assert!(
                (kg - then_kg).abs() < FORCE_TOLERANCE * row.mass_kg(),
                "{kg} {then_kg}"
            );
        }
    }

    /// The interaction of any number of ties follows from a few motions: the product of their rates is the response to each tie alone.
    #[test]
    fn many_ties_depend_on_each_other_through_few_motions() {
        let ties: Vec<(usize, f64)> = (0..200).map(|tie| (tie % 4, 1e4)).collect();
        let row = row_with_ties(&ties);
        let stance = undeformed_state(&row);
        let mut descent = Descent::new(&row);
        let force_g = Vector2::new(2.0, -1.0);
        let mut step = step(&row, &stance, force_g, 0.01);
        descent.balance_ties(&mut step).unwrap();
        let elongation_rates = descent.elongation_rates(&step);
        assert!(
            (1..=5).contains(&elongation_rates.ncols()),
            "{}",
            elongation_rates.ncols()
        );
        let found = &elongation_rates * elongation_rates.transpose();
        for pulling in 0..4 {
            descent.respond(&step, |tie| f64::from(u8::from(tie == pulling)));
            for (lacking, line) in step.lines.iter().enumerate() {
                let due = -line.lengthening(&descent.program.velocities);
                let off = (found[(lacking, pulling)] - due).abs();
                assert!(off < 1e-9 * found.amax(), "{lacking} {pulling}: {off:e}");
            }
        }
    }

    /// Two very stiff parallel ties have the force of one tie with the sum of their stiffnesses, although a stiffness of millions of
    /// weights per metre turns rounding errors of a length into forces.
    #[test]
    fn very_stiff_ties_are_balanced() {
        let pulls_kg = |ties: &[(usize, f64)], length: f64| {
            let row = row_with_ties(ties);
            let mut descent = Descent::new(&row);
            let stance = undeformed_state(&row);
            let mut step = step(&row, &stance, Vector2::new(0.6, -1.0), length);
            descent.balance_ties(&mut step)?;
            Ok::<f64, SettlingError>(descent.ties_kg.iter().sum())
        };
        for length in [1e-3, 1.0, 1e3] {
            let one_kg = pulls_kg(&[(2, 3e10)], length).unwrap();
            let two_kg = pulls_kg(&[(2, 1e10), (2, 2e10)], length).unwrap();
            let mass_kg = row_with_ties(&[]).mass_kg();
            assert!(one_kg > 0.01 * mass_kg, "{one_kg}");
            assert!(
                (one_kg - two_kg).abs() < 1e-9 * mass_kg,
                "{one_kg} {two_kg}"
            );
        }
        let error = pulls_kg(&[(2, 3e10)], f64::NAN).unwrap_err().to_string();
        assert!(
            error.contains("the forces of the ties were not found"),
            "{error}"
        );
    }
}
