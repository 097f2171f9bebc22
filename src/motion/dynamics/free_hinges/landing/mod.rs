//! Motion of a row with free hinges, in steps that end at landings.
//!
//! A leapfrog step is a kick by gravity and ground, the solution for the nearest admissible velocities ([`crate::mechanics::contact`]), and a drift
//! of the gaps. A step ends exactly where a corner lands, at any step length. There the velocity is completed with the old mechanism, then projected
//! onto the velocities that the closed corners allow. This is the perfectly inelastic impact of Moreau.
//!
//! An impact closes more than the expected corner. Four open corners of an arch have one degree of freedom, so all four land simultaneously;
//! numerically, rounding errors of the closure leave the others open. These corners belong to the impact, as does every corner open by less than a
//! billionth of the thickness. Successive projections differ from the projection onto all constraints, and this difference does not decrease with the
//! step length. Landings are merged in time only after too many impacts within the shortest step, or in a repetition.
//!
//! Pins move on arcs. A linear drift of two bodies would part them. This gap over the next step is computed from the last motion, never from the
//! trial one, and compensated by a prescribed relative velocity at the joint.

mod observation;
mod search;

use std::ops::Range;

use nalgebra::Vector2;

use self::observation::{kinetic, momentum};
use super::rest::{InitialPosition, touching_corners};
use super::right_support::RightSupport;
use super::ties::Ties;
use crate::dynamics::recorder::Recorder;
use crate::dynamics::row::standing::Release;
use crate::dynamics::{GroundVelocity, MotionInput, MotionObserver, RowMotionError, Stepper as _};
use crate::mechanics::contact::closing::ClosureSolver;
use crate::mechanics::contact::{ContactProgram, Load};
use crate::mechanics::geometry::field::quarter_turn;
use crate::mechanics::{Corners, Edge, Placement, Pose, Row, RowState, Supports, Twist};

/// Largest closure error of an arch, over the thickness of the thinnest joint; a larger one is an error.
const LARGEST_CLOSURE_RATIO: f64 = 1e-6;
/// Largest gap, over the thickness, of corners that belong to an impact.
const LANDED_RATIO: f64 = 1e-9;
/// Largest gap, over the thickness, at which the last three open corners of an arch belong to an impact. They must satisfy three closure equations,
/// which only closed joints do.
const LAST_THREE_RATIO: f64 = 1e-6;
/// Decrease of potential energy below that at rest, over weight times size, at which a row has overturned.
const FALLEN_ENERGY_RATIO: f64 = 1e-3;

/// Blocks that moved as one body in the last drift.
#[derive(Clone, Copy, Debug, Default)]
struct MovingPiece {
    first: usize,
    mass: f64,
    inertia: f64,
    centre: Vector2<f64>,
    velocity: Vector2<f64>,
    rate: f64,
}

impl MovingPiece {
    fn twist(&self, kick: Vector2<f64>) -> Twist {
        Twist {
            at_center: self.velocity + kick - quarter_turn(self.centre) * self.rate,
            rate: self.rate,
        }
    }

    /// Deviation of the arc of a point from its tangent in a step, over the step length.
    fn arc_deviation(&self, point: Vector2<f64>, step_s: f64) -> Vector2<f64> {
        let (arm, turn) = (point - self.centre, step_s * self.rate);
        arm * (-0.5 * turn * self.rate) - quarter_turn(arm) * (turn * turn * self.rate / 6.0)
    }
}

/// Solved step.
#[derive(Clone, Copy, Debug)]
struct LandingStep {
    /// Expected step length: the impulses act up to its middle.
    expected_s: f64,
    length_s: f64,
    /// True if corners land within the step and not at its end.
    merged: bool,
}

/// Impacts that follow each other within the shortest step.
#[derive(Clone, Copy, Debug, Default)]
struct ImpactCluster {
    /// Time of the first impact, in seconds.
    first_s: f64,
    impacts: usize,
}

pub struct LandingStepper<'a> {
    row: &'a Row,
    velocity: GroundVelocity<'a>,
    gravity: f64,
    thinnest: f64,
    rest: InitialPosition<'a>,
    right: RightSupport<'a>,
    observer: MotionObserver<'a>,
    /// Time up to which gravity and ground have been applied to the velocities.
    kicked_s: f64,
    pub placement: Placement,
    program: ContactProgram,
    /// Copy for solutions that must not change the active set.
    auxiliary: ContactProgram,
    closure_solver: ClosureSolver,
    ties: Ties<'a>,
    pieces: Vec<MovingPiece>,
    next_pieces: Vec<MovingPiece>,
    /// Corner about which each joint turned in the last drift, the intrados for a parted joint; `None` for closed joints.
    turning: Vec<Option<Edge>>,
    load: Load,
    /// Rates of the gaps in the solution before the last one.
    earlier_rates: Vec<[f64; 2]>,
    /// Rates that close the gaps of landing corners within the step.
    landing: Vec<[f64; 2]>,
    /// Corners that land in a merged step: joint and edge.
    landed: Vec<(usize, usize)>,
    change: Vec<[f64; 2]>,
    shares: Vec<[f64; 2]>,
    /// Corners in contact at the beginning of the step.
    closed: Vec<Corners>,
    /// True while the row is in its initial position.
    stands: bool,
    /// Corners in contact in the step that ended at an impact.
    pressed: Vec<Corners>,
    start_energy: f64,
    friction_demand: f64,
    step_iterations: u64,
    cluster: ImpactCluster,
    /// Time, in seconds, since which the row rests in its initial position; `None` while it moves.
    rest_since_s: Option<f64>,
}

impl<'a> LandingStepper<'a> {
    /// Stepper that starts from a state of the row in equilibrium, or released with initial rotations and rates.
    ///
    /// # Errors
    /// If the initial rotations leave a closure error.
    pub fn new(
        input: MotionInput<'a>,
        standing: &RowState,
        release: Option<&Release>,
        recorder: Option<&'a mut dyn Recorder>,
    ) -> Result<Self, RowMotionError> {
        let (row, ground, gravity) = (input.row, input.ground, input.gravity_m_s2);
        let (blocks, joints) = (row.blocks.len(), row.joints.len());
        let rest = InitialPosition::new(row, &standing.placement);
        let mut program = ContactProgram::new(row);
        program.set_positions(&standing.placement);
        if rest.is_on_hinges() {
            program.start_from(&rest.touching);
        }
        let thicknesses = row.joints.iter().map(|joint| joint.thickness_m());
        let fallen = -FALLEN_ENERGY_RATIO * row.mass_kg() * gravity * row.size_m;
        let right = RightSupport::new(row, ground);
        let may_end_on_hinges = rest.is_on_hinges() || right.moves();
        let mut stepper = Self {
            row,
            velocity: GroundVelocity::new(ground),
            right,
            gravity,
            thinnest: thicknesses.fold(f64::INFINITY, f64::min),
            observer: MotionObserver::new(
                input,
                Some(fallen).filter(|_| !may_end_on_hinges),
                recorder,
            ),
            kicked_s: ground.start_s(),
            placement: standing.placement.clone(),
            rest,
            auxiliary: program.clone(),
            program,
            closure_solver: ClosureSolver::new(row),
            ties: Ties::new(row, standing),
            pieces: vec![MovingPiece::default()],
            next_pieces: Vec::with_capacity(blocks),
            turning: vec![None; joints],
            load: Load::none(row),
            earlier_rates: vec![[0.0; 2]; joints],
            landing: vec![[0.0; 2]; joints],
            landed: Vec::with_capacity(2 * joints),
            change: vec![[0.0; 2]; joints],
            shares: vec![[0.0; 2]; joints],
            closed: vec![[true; 2]; joints],
            stands: true,
            pressed: vec![[true; 2]; joints],
            start_energy: 0.0,
            friction_demand: 0.0,
            step_iterations: 0,
            cluster: ImpactCluster::default(),
            rest_since_s: None,
        };
        stepper.update_piece_centres();
        stepper.observer.note_ties(stepper.ties.memories());
        stepper.observer.save_results_before_fall();
        if let Some(release) = release {
            stepper.release(release)?;
        }
        Ok(stepper)
    }

    /// Sets the initial rotations and rates.
    ///
    /// # Errors
    /// If they leave a closure error.
    fn release(&mut self, release: &Release) -> Result<(), RowMotionError> {
        self.placement.turn(&release.rotations_rad);
        let error_m = self.placement.closure_error();
        if error_m > LARGEST_CLOSURE_RATIO * self.thinnest {
            return Err(RowMotionError::Failed(format!(
                "with the initial rotations the ends of the arch miss each other by {error_m:.3e} m: give rotations of the blocks \
                 with which it stays closed; a smaller `rotation_rad` in [initial] may do"
            )));
        }
        self.closure_solver
            .remove_closure_error(&mut self.placement);
        let mut active: Vec<Corners> = touching_corners(&self.placement.gaps_m).collect();
        if release.has_rate() {
            self.set_motions(&release.rates_rad_s, &mut active);
        }
        let is_open = |corners: &&Corners| **corners != [true; 2];
        let open = active.iter().filter(is_open).count();
        // With fewer than three hinges an arch does not move, so keep the initial active set.
        if self.row.supports == Supports::Left || open >= 3 {
            self.program.start_from(&active);
        }
        self.program.set_positions(&self.placement);
        self.update_piece_centres();
        let poses = &self.placement.poses;
        self.ties.stretch(|block| poses[block]);
        let (energy, sway) = (self.energy(), self.sway_kg_m());
        let kinetic = kinetic(&self.pieces);
        self.start_energy = energy + kinetic;
        self.stands = open == 0;
        let rotations = self.placement.poses.iter().map(Pose::rotation_rad);
        self.observer
            .record_release(rotations, [energy, kinetic], sway, open > 0);
        Ok(())
    }

    /// Sets the rates of the blocks, each a piece of its own, and the corners about which joints turn.
    fn set_motions(&mut self, rates_rad_s: &[f64], active: &mut [Corners]) {
        let (motions, pivots) = self.placement.motions(rates_rad_s);
        let blocks = self.row.blocks.iter().zip(&self.placement.centres_m);
        let moving = motions.iter().zip(blocks).enumerate();
        let pieces = moving.map(|(first, (motion, (block, centre)))| MovingPiece {
            first,
            mass: block.mass_kg,
            inertia: block.inertia_kg_m2,
            centre: *centre,
            velocity: motion.velocity_at(*centre),
            rate: motion.rate,
        });
        self.pieces = pieces.collect();
        for (active, pivot) in active.iter_mut().zip(&pivots) {
            if let Some(edge) = pivot {
                *active = [Edge::Intrados, Edge::Extrados].map(|other| other == *edge);
            }
        }
        self.turning = pivots;
    }

    /// Whether the last step ended at an impact after too many impacts within the shortest step, so that the next landings are merged.
    fn has_impact_cluster(&self) -> bool {
        self.has_just_landed() && self.cluster.impacts > self.observer.input.settings.merged_after
    }

    /// Whether the last step ended at an impact.
    fn has_just_landed(&self) -> bool {
        self.kicked_s == self.observer.time && self.observer.events.impacts() > 0
    }

    /// Constrains the corners in contact.
    fn constrain_closed_corners(&mut self) {
        for (touching, gaps) in self.load.touching.iter_mut().zip(&self.placement.gaps_m) {
            *touching = gaps.map(|gap| gap == 0.0);
        }
    }

    /// Blocks of a piece.
    fn blocks_of(&self, piece: usize) -> Range<usize> {
        let next = self.pieces.get(piece + 1);
        self.pieces[piece].first..next.map_or(self.load.free.len(), |next| next.first)
    }

    /// Computes the free velocities of the blocks after a kick of this duration.
    fn kick(&mut self, kick: Vector2<f64>, lasts_s: f64) {
        for index in 0..self.pieces.len() {
            let twist = self.pieces[index].twist(kick);
            let blocks = self.blocks_of(index);
            self.load.free[blocks].fill(twist);
        }
        let (centres_m, free) = (&self.placement.centres_m, &mut self.load.free);
        let gain = |block: usize, velocity, turning| {
            let turning = Twist::rotation(centres_m[block], turning);
            free[block] = free[block] + (Twist::translation(velocity) + turning);
        };
        self.ties.pull(centres_m, lasts_s, gain);
    }

    /// Change of velocity by gravity and ground over an interval, and the part of the ground alone.
    fn impulse(&self, from_s: f64, to_s: f64) -> (Vector2<f64>, Vector2<f64>) {
        let ground = self.velocity.velocity_at(to_s) - self.velocity.velocity_at(from_s);
        let fall = Vector2::new(0.0, self.gravity * (to_s - from_s));
        (-ground - fall, ground)
    }

    /// Applies the rest of the last kick, up to the time of the positions, with the contacts at that time. Returns the change of velocity by the
    /// ground.
    fn half_kick(&mut self) -> Vector2<f64> {
        let time = self.observer.time;
        let (impulse, ground) = self.impulse(self.kicked_s, time);
        self.kick(impulse, time - self.kicked_s);
        self.right.prescribe_velocity_at(time);
        self.load.jumps.fill(Twist::ZERO);
        self.add_right_support_velocity();
        self.landing.fill([0.0; 2]);
        self.constrain_closed_corners();
        ground
    }

    /// Interval of the kick of a step.
    fn kick_interval(&self, step: f64) -> (f64, f64) {
        (self.kicked_s, self.observer.time + 0.5 * step)
    }

    fn solve_step(&mut self, step: f64) -> Result<(), RowMotionError> {
        let (from_s, to_s) = self.kick_interval(step);
        self.kick(self.impulse(from_s, to_s).0, to_s - from_s);
        self.right.prescribe_mean_velocity(self.observer.time, step);
        self.set_relative_velocities(step);
        self.solve()
    }

    fn solve(&mut self) -> Result<(), RowMotionError> {
        let effort = self.program.solve(&self.load);
        let time_s = self.observer.time;
        let remedy = "or give another `longest_step_s` in [free_hinges]";
        let why = |reason| RowMotionError::Failed(format!("at {time_s} s {reason}, {remedy}"));
        let effort = effort.map_err(why)?;
        let iterations = effort.iterations as u64;
        self.observer.cost.evaluations += iterations;
        self.observer.row_summary.programs += 1;
        self.observer.row_summary.relaxed += effort.relaxed as u64;
        self.step_iterations += iterations;
        Ok(())
    }

    /// Computes the prescribed relative velocities at the joints: corrections for arcs over the next step, and rates that close landing corners.
    fn set_relative_velocities(&mut self, step: f64) {
        self.load.jumps.fill(Twist::ZERO);
        let count = self.pieces.len();
        let boundaries = count + usize::from(self.row.supports == Supports::Both);
        for index in 0..boundaries {
            let right = self.pieces.get(index);
            let joint = right.map_or(self.load.free.len(), |piece| piece.first);
            let Some(edge) = self.turning[joint] else {
                continue;
            };
            let gaps = self.placement.gaps_m[joint];
            let nearer = if gaps[0] < gaps[1] {
                Edge::Intrados
            } else if gaps[0] > gaps[1] {
                Edge::Extrados
            } else {
                edge
            };
            let point = self.placement.frames[joint].corner_m(nearer);
            let arc_deviation = |piece: &MovingPiece| piece.arc_deviation(point, step);
            let left = index.checked_sub(1).map(|left| &self.pieces[left]);
            let jump = left.map_or(Vector2::zeros(), arc_deviation)
                - right.map_or(Vector2::zeros(), arc_deviation);
            self.load.jumps[joint] = Twist::translation(jump);
        }
        for (joint, rates) in self.landing.iter().enumerate() {
            if *rates != [0.0; 2] {
                let frame = &self.placement.frames[joint];
                let rate = self.row.handedness * (rates[1] - rates[0]) / frame.thickness_m;
                self.load.jumps[joint] = self.load.jumps[joint]
                    + Twist::translation(frame.normal * rates[0])
                    + Twist::rotation(frame.intrados_m, rate);
            }
        }
        self.add_right_support_velocity();
    }

    /// Adds the motion of the right support: its joint gets the opposite relative velocity, as if the support were at rest.
    fn add_right_support_velocity(&mut self) {
        if self.right.moves()
            && let Some(last) = self.load.jumps.last_mut()
        {
            *last = *last - Twist::translation(self.right.solution_m_s);
        }
    }

    /// Work of the right support by the impulses of the last solution, and by tie forces during `lasts_s`.
    fn work_of_right_support(&mut self, lasts_s: f64) -> f64 {
        let (true, Some(frame)) = (self.right.moves(), self.placement.frames.last()) else {
            return 0.0;
        };
        self.program.joint_impulses(&mut self.shares);
        let [tangent, normal] = self.shares[self.shares.len() - 1];
        let by_row = frame.tangent * tangent + frame.normal * normal;
        let impulse = by_row + self.ties.right_support_force_n() * lasts_s;
        -impulse.dot(&self.right.mean_m_s())
    }

    /// Adds the work of the right support to the energy balance, and returns the work.
    fn note_right_support(&mut self, lasts_s: f64) -> f64 {
        let work = self.work_of_right_support(lasts_s);
        self.observer.row_summary.right_foot_j += work;
        work
    }

    /// Starts the next solution with selected corners active.
    fn press(&mut self, presses: impl Fn(&Self, usize, usize) -> bool) {
        for joint in 0..self.load.touching.len() {
            for edge in 0..2 {
                if presses(self, joint, edge) {
                    self.program.press(joint, edge);
                }
            }
        }
    }

    fn kinetic_of_solution(&mut self) -> f64 {
        self.form_pieces();
        kinetic(&self.next_pieces)
    }

    /// Computes the pieces that move as one body in the last solution.
    fn form_pieces(&mut self) {
        self.next_pieces.clear();
        let (blocks, mut first) = (self.load.free.len(), 0);
        let moments = self.program.moments();
        for joint in 1..=blocks {
            let ends = joint == blocks
                || self.program.active[joint] != [true; 2]
                || self.load.jumps[joint] != Twist::ZERO;
            if ends {
                let sum = moments[joint] - moments[first];
                let centre = sum.centroid();
                let twist = self.program.velocities[first];
                self.next_pieces.push(MovingPiece {
                    first,
                    mass: sum.mass,
                    inertia: sum.central_polar(),
                    centre,
                    velocity: twist.velocity_at(centre),
                    rate: twist.rate,
                });
                first = joint;
            }
        }
    }

    /// Records the work of the ground and the forces of a solved step, and computes its pieces.
    fn record_step(&mut self, step: &LandingStep) {
        let before = self.momentum();
        let (from_s, to_s) = self.kick_interval(step.expected_s);
        self.form_pieces();
        let mean = (before + momentum(&self.next_pieces)) * 0.5;
        self.observer.row_summary.ground_j -= self.impulse(from_s, to_s).1.dot(&mean);
        self.note_right_support(to_s - from_s);
        let is_short = to_s - from_s < self.observer.input.settings.shortest_mean_s();
        if step.merged || is_short {
            return;
        }
        self.program.joint_impulses(&mut self.shares);
        let impulses = self.shares.iter().copied();
        self.friction_demand = self.observer.note_forces(impulses, to_s - from_s);
    }

    /// Moves the row over a solved step.
    ///
    /// # Errors
    /// If the closure error of the arch is too large.
    fn drift(&mut self, step: &LandingStep) -> Result<(), RowMotionError> {
        self.kicked_s = self.kick_interval(step.expected_s).1;
        for (change, rates) in self.change.iter_mut().zip(&self.landing) {
            *change = rates.map(|rate| rate * step.length_s);
        }
        for (joint, rates) in self.program.open_joints() {
            for (change, rate) in self.change[joint].iter_mut().zip(rates) {
                *change += rate * step.length_s;
            }
        }
        self.open_gaps(self.observer.time + step.length_s);
        self.adopt_pieces();
        self.observer.time += step.length_s;
        self.closure_solver
            .remove_closure_error(&mut self.placement);
        let poses = &self.placement.poses;
        self.ties.stretch(|block| poses[block]);
        self.program.set_positions(&self.placement);
        let error_m = self.placement.closure_error();
        let row_summary = &mut self.observer.row_summary;
        row_summary.closure_error_m = row_summary.closure_error_m.max(error_m);
        // NaN is also an error.
        if error_m <= LARGEST_CLOSURE_RATIO * self.thinnest {
            self.update_piece_centres();
            Ok(())
        } else {
            let time_s = self.observer.time;
            Err(RowMotionError::Failed(format!(
                "at {time_s} s the ends of the arch miss each other by {error_m:.3e} m: give a shorter `longest_step_s` in \
                 [free_hinges]"
            )))
        }
    }

    /// Changes the gaps, with the right support at its position at `time_s`.
    fn open_gaps(&mut self, time_s: f64) {
        let change = &self.change;
        if !self.right.moves() {
            self.placement.change_gaps(|joint| change[joint]);
            return;
        }
        let was_open = self.placement.open_corners() > 0;
        self.right.move_to(time_s);
        let stood = &self.rest.placement.support_poses;
        let poses = self.right.poses(stood);
        self.placement.move_supports(poses);
        self.ties.supports = poses;
        self.placement.change_gaps(|joint| change[joint]);
        if was_open || self.placement.open_corners() > 0 {
            self.right.joint_displacement_m = self.right.displacement_m;
        }
    }

    /// Replaces the pieces of the motion by those of the solution, and stores the corners about which joints turn.
    fn adopt_pieces(&mut self) {
        self.right.velocity_m_s = self.right.solution_m_s;
        std::mem::swap(&mut self.pieces, &mut self.next_pieces);
        self.turning.fill(None);
        for (joint, _) in self.program.open_joints() {
            let edge = Edge::only(self.program.active[joint]);
            self.turning[joint] = edge.or(Some(Edge::Intrados));
        }
    }

    /// Computes the centres of the pieces in the current position.
    fn update_piece_centres(&mut self) {
        for index in 0..self.pieces.len() {
            let (mut first, mut mass) = (Vector2::zeros(), 0.0);
            for block in self.blocks_of(index) {
                let mass_kg = self.row.blocks[block].mass_kg;
                first += self.placement.centres_m[block] * mass_kg;
                mass += mass_kg;
            }
            let piece = &mut self.pieces[index];
            (piece.centre, piece.mass) = (first / mass, mass);
        }
    }

    /// Whether a corner is in contact that was open at the beginning of the step.
    fn has_landed(&self, joint: usize, edge: usize) -> bool {
        self.placement.gaps_m[joint][edge] == 0.0 && !self.closed[joint][edge]
    }

    /// Completes the velocity at a landing with the old mechanism, then projects it onto the admissible velocities.
    fn impact(&mut self) -> Result<(), RowMotionError> {
        self.close_landed_corners();
        self.pressed.copy_from_slice(&self.program.active);
        self.complete_kick()?;
        let kinetic_before = kinetic(&self.next_pieces);
        self.observer.potential = self.energy();
        self.check_energy(kinetic_before);
        self.load.free.copy_from_slice(&self.program.velocities);
        self.constrain_closed_corners();
        self.program.start_from(&self.pressed);
        // Most landing corners get a compressive impulse.
        self.press(Self::has_landed);
        self.solve()?;
        let kinetic_after = self.kinetic_of_solution();
        let work = self.note_right_support(0.0);
        self.observer.row_summary.energy_taken_j += kinetic_before + work - kinetic_after;
        self.adopt_pieces();
        self.kicked_s = self.observer.time;
        self.observer.note_impact();
        let since_s = self.observer.time - self.cluster.first_s;
        if self.cluster.impacts == 0 || since_s > self.observer.input.settings.shortest_step_s {
            self.cluster.first_s = self.observer.time;
            self.cluster.impacts = 0;
        }
        self.cluster.impacts += 1;
        Ok(())
    }

    /// Closes the corners that belong to an impact, besides those closed by the removal of the closure error.
    fn close_landed_corners(&mut self) {
        loop {
            // On moved supports three joints stay open.
            let moved = self.rest.is_on_hinges() || self.right_support_is_displaced();
            let may_shut = self.row.supports == Supports::Both && !moved;
            let few = may_shut && self.placement.open_corners() <= 3;
            let near = self.placement.largest_gap_ratio() < LAST_THREE_RATIO;
            let ratio = if few && near {
                LAST_THREE_RATIO
            } else {
                LANDED_RATIO
            };
            if !self.placement.shut_below(ratio) {
                break;
            }
        }
        self.program.set_positions(&self.placement);
        self.update_piece_centres();
    }

    /// Solves for the velocities at the time of the positions, with the contacts of the beginning of the step.
    fn complete_kick(&mut self) -> Result<(), RowMotionError> {
        let before = self.momentum();
        let ground = self.half_kick();
        for (touching, closed) in self.load.touching.iter_mut().zip(&self.closed) {
            for edge in 0..2 {
                touching[edge] &= closed[edge];
            }
        }
        self.solve()?;
        self.form_pieces();
        self.observer.row_summary.ground_j -=
            ground.dot(&((before + momentum(&self.next_pieces)) * 0.5));
        self.note_right_support(self.observer.time - self.kicked_s);
        self.right.velocity_m_s = self.right.solution_m_s;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use clarabel::algebra::CscMatrix;
    use clarabel::solver::{
        DefaultSettings, DefaultSolver, IPSolver as _, NonnegativeConeT, SolverStatus, ZeroConeT,
    };

    use super::*;
    use crate::dynamics::ground::Pulse;
    use crate::dynamics::row::clock::Settings;
    use crate::mechanics::geometry::ring::Ring;

    /// Solves the quadratic program of a step with an interior-point solver, with up to three rows per joint. The unknowns of a block are the
    /// velocity of its centre and its rotation rate times the radius of gyration, all times the root of its mass.
    fn reference_velocities(stepper: &LandingStepper) -> Option<Vec<Twist>> {
        let blocks = &stepper.row.blocks;
        let centres = &stepper.placement.centres_m;
        let gyration = |b: usize| (blocks[b].inertia_kg_m2 / blocks[b].mass_kg).sqrt();
        let root = |b: usize| (blocks[b].mass_kg / blocks[0].mass_kg).sqrt();
        let scale = 1e-2;
        let goal: Vec<f64> = (0..blocks.len())
            .flat_map(|b| {
                let free = stepper.load.free[b];
                let v = free.velocity_at(centres[b]);
                [v.x, v.y, free.rate * gyration(b)].map(|x| -x * root(b) / scale)
            })
            .collect();
        let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        let joints = stepper.row.joints.len();
        let gates: usize = stepper
            .load
            .touching
            .iter()
            .flatten()
            .filter(|t| **t)
            .count();
        let mut right = vec![0.0; joints + gates];
        let mut gate = joints;
        for (joint, frame) in stepper.placement.frames.iter().enumerate() {
            let jump = stepper.load.jumps[joint];
            let mut kinds = vec![(joint, frame.intrados_m, frame.tangent, 1.0)];
            for (edge, touching) in [Edge::Intrados, Edge::Extrados]
                .into_iter()
                .zip(stepper.load.touching[joint])
            {
                if touching {
                    kinds.push((gate, frame.corner_m(edge), frame.normal, -1.0));
                    gate += 1;
                }
            }
            for (row, point, direction, sense) in kinds {
                right[row] = sense * direction.dot(&jump.velocity_at(point)) / scale;
                for (block, sign) in [(joint.checked_sub(1), -sense), (Some(joint), sense)] {
                    if let Some(b) = block.filter(|b| *b < blocks.len()) {
                        let turn = (point - centres[b]).perp(&direction) / gyration(b);
                        for (axis, value) in
                            [direction.x, direction.y, turn].into_iter().enumerate()
                        {
                            rows.push(row);
                            columns.push(3 * b + axis);
                            values.push(sign * value / root(b));
                        }
                    }
                }
            }
        }
        let matrix = CscMatrix::new_from_triplets(right.len(), goal.len(), rows, columns, values);
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-14,
            tol_gap_rel: 1e-14,
            tol_feas: 1e-12,
            ..DefaultSettings::default()
        };
        let cones = [ZeroConeT(joints), NonnegativeConeT(gates)];
        let identity = CscMatrix::identity(goal.len());
        let mut solver =
            DefaultSolver::new(&identity, &goal, &matrix, &right, &cones, settings).unwrap();
        solver.solve();
        if solver.solution.status != SolverStatus::Solved {
            return None;
        }
        let x = &solver.solution.x;
        let twists = (0..blocks.len()).map(|b| {
            let [vx, vy, vr] = [0, 1, 2].map(|axis| x[3 * b + axis] * scale / root(b));
            let rate = vr / gyration(b);
            Twist {
                at_center: Vector2::new(vx, vy) - quarter_turn(centres[b]) * rate,
                rate,
            }
        });
        Some(twists.collect())
    }

    #[test]
    fn velocities_are_those_of_an_interior_point_method() {
        let arch = |degrees: f64, voussoirs, radius_m| {
            let ring = Ring::new(0.15, degrees.to_radians()).unwrap();
            Row::arch(&ring, voussoirs, radius_m, 1.0, 2000.0).unwrap()
        };
        let drums = [0.82, 0.82, 0.82, 0.82, 0.82, 0.82, 0.82, 0.21];
        let column = Row::tapered_stack(&drums, 1.11, 0.90, 1.0, 2620.0).unwrap();
        for (row, amplitude_g, duration_s) in [
            (arch(157.5, 7, 10.0), 0.6, 0.05),
            (arch(179.0, 12, 5.0), 0.5, 0.03),
            (column, 1.0, 0.1),
        ] {
            let ground = Pulse::OneSine
                .lasting_s(duration_s)
                .horizontal_m_s2(amplitude_g * 9.81)
                .unwrap();
            let settings = Settings::to_landings(&row, 9.81, 60.0).times(1.1 / 0.34);
            let input = MotionInput::new(&row, &ground, 9.81, settings);
            let mut stepper =
                LandingStepper::new(input, &RowState::undeformed(&row), None, None).unwrap();
            let mut fastest = 0.0_f64;
            let mut worst = 0.0_f64;
            let mut compared = 0;
            for _ in 0..500 {
                stepper.constrain_closed_corners();
                stepper.landing.fill([0.0; 2]);
                stepper.solve_step(settings.longest_step_s).unwrap();
                // The solver fails near rest, where the impulses are not unique.
                let reference = reference_velocities(&stepper);
                compared += usize::from(reference.is_some());
                let velocities = &stepper.program.velocities;
                for (block, (ours, reference)) in velocities
                    .iter()
                    .zip(reference.iter().flatten())
                    .enumerate()
                {
                    let centre = stepper.placement.centres_m[block];
                    fastest = fastest.max(ours.velocity_at(centre).norm());
                    worst = worst
                        .max((ours.velocity_at(centre) - reference.velocity_at(centre)).norm());
                }
                stepper.step(60.0).unwrap();
            }
            assert!(
                fastest > 0.05 && stepper.observer.events.impacts() > 3,
                "{fastest}"
            );
            // The solver stops when its objective is accurate to 1e-14, so the errors are some 1e-7 for velocities of 1 m/s.
            assert!(worst < 2e-8 && compared > 250, "{worst} {compared}");
        }
    }
}
