//! Motion of a row whose joints open and slip, in equal steps.
//!
//! The state consists of the position of every block, its velocity half a step before, and the offset at which every joint stuck last. A leapfrog
//! step is a kick by gravity and ground, the solution for admissible velocities ([`crate::mechanics::coulomb`]), and a drift. The next step corrects
//! the position errors of gaps and offsets, and includes the curvature of the motion, known from the last velocity. No other correction is needed to
//! keep the row together.
//!
//! Steps do not end at landings: the time of an impact is accurate to a step. In the step of its landing a corner keeps the rate that closes the rest
//! of its gap; the next step removes this rate. An impact is therefore reported one step later, with the energy of both steps.

mod impact;

use std::mem;

use nalgebra::{Vector2, Vector3};

use self::impact::{Dissipation, Landing};
use super::rest::{InitialPosition, touching_corners};
use super::right_support::RightSupport;
use super::ties::Ties;
use crate::dynamics::recorder::Recorder;
use crate::dynamics::row::last_maximum::LastMaximum;
use crate::dynamics::row::observer::{REST_ENERGY_RATIO, SWAY_RATIO};
use crate::dynamics::row::standing::Release;
use crate::dynamics::row::stepper::{eccentricity_ratio, equal_step};
use crate::dynamics::{
    EventKind, GroundVelocity, MotionInput, MotionObserver, RowMotionError, Sample, Sliding,
    Stepper,
};
use crate::mechanics::coulomb::{JointMode, SlipProgram, TangentialMode};
use crate::mechanics::slip::{FaceContact, Faces, Position};
use crate::mechanics::{Corners, Edge, Hinge, Placement, Pose, Row, RowState, Supports};

/// Tolerance of rates, relative to the fastest motion plus the effect of gravity in a step.
const RATE_TOLERANCE: f64 = 1e-9;
/// Largest residual rate due to the proximal term, relative to the fastest motion; above it the impulses are solved for again.
const LARGEST_RESIDUAL_RATE: f64 = 1e-6;
/// Least gap before a landing, over the thickness of the joint.
const APART_RATIO: f64 = 1e-9;
/// Relative error of friction bounds below which these have converged.
const CONVERGED: f64 = 1e-9;
/// Relative error of friction bounds above which the computation fails.
const LARGEST_BOUND_ERROR: f64 = 0.05;

pub struct SlidingStepper<'a> {
    row: &'a Row,
    velocity: GroundVelocity<'a>,
    gravity: f64,
    rest: InitialPosition<'a>,
    right: RightSupport<'a>,
    /// Gaps and offsets of the joints in the initial position.
    initial_coordinates_m: Vec<Vector3<f64>>,
    observer: MotionObserver<'a>,
    faces: Vec<Faces>,
    thinnest_m: f64,
    /// Positions of the left and the right support.
    supports: [Position; 2],
    positions: Vec<Position>,
    velocities: Vec<Vector3<f64>>,
    contacts: Vec<FaceContact>,
    ties: Ties<'a>,
    /// Changes of the velocities of the blocks by ties in a kick.
    tie_velocities: Vec<Vector3<f64>>,
    /// Offset at which every joint stuck last.
    stick_offsets_m: Vec<f64>,
    /// Position error of the joint coordinates at the end of the step without their rates, over the step length.
    position_errors: Vec<Vector3<f64>>,
    /// Rates of the joint coordinates before the step.
    rates_before: Vec<Vector3<f64>>,
    /// Time up to which the kicks have been applied.
    kicked_s: f64,
    last_step: f64,
    program: SlipProgram,
    /// Copy for solutions that must not change the modes.
    auxiliary: SlipProgram,
    modes_before: Vec<JointMode>,
    /// True while the contacts are those of the initial position.
    stands: bool,
    /// Energy dissipated by friction outside impacts.
    sliding_friction_j: f64,
    /// Impact of the last step; `None` if there was none.
    landing: Option<Landing>,
    /// Least energy up to now, without the work of the ground.
    least_energy: f64,
    friction_demand: f64,
    centres: Vec<Vector2<f64>>,
}

impl<'a> SlidingStepper<'a> {
    /// Stepper for a row that starts from a state in equilibrium, or is released at a placement, at rest or with rates.
    pub fn new(
        (standing, placement, with_rates): (&RowState, &Placement, Option<&Release>),
        input: MotionInput<'a>,
        coefficient: f64,
        recorder: Option<&'a mut dyn Recorder>,
    ) -> Self {
        let (row, ground, gravity) = (input.row, input.ground, input.gravity_m_s2);
        let (blocks, joints) = (row.blocks.len(), row.joints.len());
        let rest = InitialPosition::new(row, &standing.placement);
        let faces = Faces::of_row(row);
        let thicknesses_m = faces.iter().map(|faces| faces.thickness_m);
        let thinnest_m = thicknesses_m.fold(f64::INFINITY, f64::min);
        let supports = placement.support_poses.map(|pose| Position::of(&pose));
        let contacts_at = |placement: &Placement| -> (Vec<Position>, Vec<FaceContact>) {
            let at = placement.centres_m.iter().zip(&placement.poses);
            let at = at.map(|(centre, pose)| Position::new(*centre, pose.rotation_rad()));
            let positions: Vec<Position> = at.collect();
            let contacts = (0..joints).map(|joint| contact(&faces, &supports, &positions, joint));
            let contacts = contacts.collect();
            (positions, contacts)
        };
        let (positions, contacts) = contacts_at(placement);
        let (_, stood) = contacts_at(&rest.placement);
        let mut program = SlipProgram::new(row, coefficient);
        program.set_contacts(&match with_rates {
            Some(_) => touching_corners(&placement.gaps_m).collect::<Vec<Corners>>(),
            None => rest.touching.clone(),
        });
        let ties = Ties::new(row, standing);
        let mut observer = MotionObserver::new(input, None, recorder);
        observer.row_summary.sliding = Some(Sliding::none(joints));
        observer.note_ties(ties.memories());
        observer.save_results_before_fall();
        let start_energy = gravity * rest.mass_displacement_kg_m(&placement.centres_m).y;
        // Heights include the energy dissipated by friction: friction may hold the row up to its highest position.
        observer.last_maximum = LastMaximum::new(start_energy, ground.start_s());
        let velocities = with_rates.map(|release| placement.velocities(&release.rates_rad_s));
        let velocities = velocities.unwrap_or_else(|| vec![Vector3::zeros(); blocks]);
        let stands = with_rates.is_none() && rest.has_contacts(&placement.gaps_m);
        if !stands {
            let rotations = positions.iter().map(|position| position.rotation_rad);
            let rotations = rest.relative_rotations_rad(rotations);
            let sway = rest.mass_displacement_kg_m(&placement.centres_m).x;
            let energies = [start_energy, kinetic_j(row, &velocities)];
            observer.record_release(rotations, energies, sway, true);
        }
        Self {
            row,
            velocity: GroundVelocity::new(ground),
            gravity,
            observer,
            velocities,
            stick_offsets_m: contacts.iter().map(|c| c.coordinates_m.z).collect(),
            position_errors: vec![Vector3::zeros(); joints],
            rates_before: vec![Vector3::zeros(); joints],
            kicked_s: ground.start_s(),
            last_step: input.settings.longest_step_s,
            auxiliary: program.clone(),
            program,
            modes_before: vec![JointMode::STICKING; joints],
            initial_coordinates_m: stood.iter().map(|c| c.coordinates_m).collect(),
            rest,
            right: RightSupport::new(row, ground),
            supports,
            stands,
            ties,
            tie_velocities: vec![Vector3::zeros(); blocks],
            sliding_friction_j: 0.0,
            landing: None,
            least_energy: f64::INFINITY,
            friction_demand: 0.0,
            centres: placement.centres_m.to_vec(),
            faces,
            thinnest_m,
            positions,
            contacts,
        }
    }

    /// Change of velocity by gravity and ground from the last kick to a time, and the part of the ground alone.
    fn kick(&self, to_s: f64) -> (Vector2<f64>, Vector2<f64>) {
        let ground = self.velocity.velocity_at(to_s) - self.velocity.velocity_at(self.kicked_s);
        let fall = Vector2::new(0.0, self.gravity * (to_s - self.kicked_s));
        (-ground - fall, ground)
    }

    /// Sets the free velocities after a kick up to `to_s`, with the tie forces during this time.
    fn load(&mut self, kick: Vector2<f64>, to_s: f64) {
        let lasts_s = to_s - self.kicked_s;
        self.tie_velocities.fill(Vector3::zeros());
        let tie_velocities = &mut self.tie_velocities;
        self.ties
            .pull(&self.centres, lasts_s, |block, velocity, turning| {
                tie_velocities[block] += Vector3::new(velocity.x, velocity.y, turning);
            });
        let (velocities, kick) = (&self.velocities, Vector3::new(kick.x, kick.y, 0.0));
        self.program
            .load(|block| velocities[block] + kick + tie_velocities[block]);
    }

    fn kinetic(&self) -> f64 {
        0.5 * self.program.twice_kinetic_j()
    }

    /// Computes the position errors of the coordinates at the end of a step over the step length, for the velocities of the last solution. They
    /// contain the current coordinates and the curvature of the motion, without the effect of the rates.
    fn update_position_errors(&mut self, step: f64) {
        let moved = |block: usize| {
            let Some(position) = self.positions.get(block) else {
                let way_m = self.right.solution_m_s * step;
                return self.supports[1].moved(way_m);
            };
            let v = self.program.velocity(block) * step;
            Position::new(position.centre_m + v.xy(), position.rotation_rad + v.z)
        };
        // Position of the block before, if it has been computed.
        let mut left = Some(self.supports[0]);
        for joint in 0..self.faces.len() {
            let now = self.contacts[joint].coordinates_m;
            let mut error = now - Vector3::new(0.0, 0.0, self.stick_offsets_m[joint]);
            // A joint between blocks that move as one has no curvature; linear motion would produce some.
            let mut right = None;
            if self.program.modes[joint] != JointMode::STICKING {
                let left = left.unwrap_or_else(|| moved(joint - 1));
                let then = self.faces[joint].contact(&left, right.insert(moved(joint)));
                error += then.coordinates_m - now - self.program.joint_rate(joint) * step;
            } else {
                error += self.right_support_rates(joint, self.right.solution_m_s) * step;
            }
            self.position_errors[joint] = error / step;
            left = right;
        }
    }

    /// Rates of the coordinates of a joint due to a velocity of the right support.
    fn right_support_rates(&self, joint: usize, velocity_m_s: Vector2<f64>) -> Vector3<f64> {
        if self.right.moves() && joint + 1 == self.faces.len() {
            self.contacts[joint]
                .frame(&self.faces[joint])
                .rates(velocity_m_s, 0.0)
        } else {
            Vector3::zeros()
        }
    }

    /// Counts a step in which the friction bounds did not converge.
    ///
    /// # Errors
    /// If their relative error is above 5 %.
    fn check_friction_bounds(&mut self, error: f64) -> Result<(), RowMotionError> {
        if error <= CONVERGED {
            return Ok(());
        }
        let sliding = self.sliding();
        sliding.unconverged += 1;
        sliding.bound_error = sliding.bound_error.max(error);
        if error <= LARGEST_BOUND_ERROR {
            return Ok(());
        }
        let time_s = self.observer.time;
        Err(RowMotionError::Failed(format!(
            "at {time_s} s the bound of friction at a joint is wrong by {error:.1e} of the largest one: give another \
             longest_step_s in [free_hinges], or a friction_coefficient farther from the least one with which the row stands"
        )))
    }

    /// Solves for the velocities after the kick of a step; the kick lasts up to `to_s`.
    fn solve(&mut self, step: f64, to_s: f64, kick: Vector2<f64>) -> Result<(), RowMotionError> {
        self.program
            .set_positions(&self.faces, &self.contacts, &self.positions);
        self.modes_before.copy_from_slice(&self.program.modes);
        for joint in 0..self.faces.len() {
            self.rates_before[joint] = self.program.joint_rate(joint);
        }
        self.right.prescribe_mean_velocity(self.observer.time, step);
        self.update_position_errors(step);
        self.load(kick, to_s);
        let speeds = self.velocities.iter().map(|v| v.x.abs() + v.y.abs());
        let fastest = speeds.fold(0.0, f64::max);
        let tolerance = RATE_TOLERANCE * (self.gravity * step + fastest);
        let mut solution = self
            .program
            .solve(|joint| self.position_errors[joint], tolerance);
        let mut passes = solution.passes;
        let again = solution.changed;
        if again {
            self.update_position_errors(step);
        }
        if again || solution.residual_m_s > LARGEST_RESIDUAL_RATE * (self.gravity * step + fastest)
        {
            solution = self
                .program
                .solve(|joint| self.position_errors[joint], tolerance);
            passes += solution.passes;
        }
        let passes = passes as u64;
        let (cost, row_summary) = (&mut self.observer.cost, &mut self.observer.row_summary);
        cost.steps += 1;
        cost.evaluations += passes;
        row_summary.programs += 1;
        row_summary.most_iterations = row_summary.most_iterations.max(passes);
        self.check_friction_bounds(solution.bound_error)
    }

    fn note_forces(&mut self, time_s: f64) {
        let impulses = self
            .program
            .impulses
            .iter()
            .map(|impulse| [impulse.z, impulse.x + impulse.y]);
        self.friction_demand = self.observer.note_forces(impulses, time_s);
    }

    /// Moves the blocks for a step, and returns the events of ties in it.
    fn drift(&mut self, step: f64) -> Vec<(usize, EventKind)> {
        for ((position, velocity), centre) in self
            .positions
            .iter_mut()
            .zip(&self.velocities)
            .zip(&mut self.centres)
        {
            *centre = position.centre_m + velocity.xy() * step;
            *position = Position::new(*centre, position.rotation_rad + velocity.z * step);
        }
        self.observer.time += step;
        if self.right.moves() {
            self.right.velocity_m_s = self.right.solution_m_s;
            self.right.move_to(self.observer.time);
            self.right.joint_displacement_m = self.right.displacement_m;
            let poses = self.right.poses(&self.rest.placement.support_poses);
            self.supports = poses.map(|pose| Position::of(&pose));
            self.ties.supports = poses;
        }
        for joint in 0..self.faces.len() {
            let contact = contact(&self.faces, &self.supports, &self.positions, joint);
            let offset_m = contact.coordinates_m.z;
            if self.program.modes[joint].tangential != TangentialMode::Stick {
                self.stick_offsets_m[joint] = offset_m;
            }
            let offset_m = self.stick_offsets_m[joint].abs();
            let largest = &mut self.sliding().largest_offsets_m[joint];
            *largest = largest.max(offset_m);
            let least = APART_RATIO * self.faces[joint].thickness_m;
            let initial_coordinates_m = &self.initial_coordinates_m[joint];
            let slipped_m = (self.stick_offsets_m[joint] - initial_coordinates_m.z).abs();
            let [intrados, extrados, _] = (contact.coordinates_m - initial_coordinates_m).into();
            self.observer.moved |= slipped_m.max(intrados).max(extrados) > least;
            self.observer.overturned |= contact.ends_m[1] <= contact.ends_m[0];
            self.contacts[joint] = contact;
        }
        let kinetic = self.kinetic();
        let (blocks, positions) = (&self.row.blocks, &self.positions);
        let before = self.observer.potential + self.ties.taken_j();
        self.ties
            .stretch(|block| positions[block].pose(blocks[block].centre_m));
        let tie_events = self.observer.note_ties(self.ties.memories());
        let height = self.gravity * self.rest.mass_displacement_kg_m(&self.centres).y;
        let potential = height + self.ties.energy_j();
        let taken = self.ties.taken_j();
        self.check_energy(kinetic + 0.5 * (before + potential + taken));
        let sway = self.sway_kg_m();
        let rotations = self.positions.iter().map(|position| position.rotation_rad);
        let rotations = self.rest.relative_rotations_rad(rotations);
        self.observer.observe(rotations, potential, kinetic, sway);
        self.observer.overturned |= self.has_fallen();
        let height = potential + self.sliding_friction_j + taken;
        let height = (!self.right.moves()).then_some(height);
        self.observer.note_height(height);
        tie_events
    }

    /// Record of slip.
    fn sliding(&mut self) -> &mut Sliding {
        let sliding = self.observer.row_summary.sliding.as_mut();
        sliding.expect("joints may slip")
    }

    /// Slip of the row along the left and the right support, in metres.
    fn support_slips_m(&self) -> [Vector2<f64>; 2] {
        let slide = |joint: usize, sign: f64| {
            let support = self.rest.placement.support_poses[usize::from(joint > 0)];
            let tangent = support.current_direction(self.row.joints[joint].direction());
            tangent * (sign * self.contacts[joint].coordinates_m.z)
        };
        // At the right support the block is on the left of the joint.
        match self.row.supports {
            Supports::Left => [slide(0, 1.0); 2],
            Supports::Both => [slide(0, 1.0), slide(self.contacts.len() - 1, -1.0)],
        }
    }

    /// Whether a block has turned too far, or is too far from its initial positions relative to both feet.
    fn has_fallen(&self) -> bool {
        let [left, right] = self.support_slips_m();
        let blocks = self
            .positions
            .iter()
            .map(|position| (position.centre_m, position.rotation_rad));
        let feet_m = [left, right + self.right.displacement_m];
        self.rest.has_left(blocks, feet_m)
    }

    /// Compares the energy in the middle of a step, without the work of the ground, with the least value up to now; an increase is a numerical error.
    /// In the middle of a step, velocities and heights are known, and their energy is constant in equal steps without impulses at the joints.
    fn check_energy(&mut self, energy: f64) {
        let left =
            energy - self.observer.row_summary.ground_j - self.observer.row_summary.right_foot_j;
        self.observer.note_defect(left - self.least_energy);
        self.least_energy = self.least_energy.min(left);
    }

    /// Solves for the velocities at the time of the positions, in the auxiliary program, from the velocities half a step before. Returns the kinetic
    /// energy in J.
    fn synchronise(&mut self) -> f64 {
        let (kick, _) = self.kick(self.observer.time);
        self.right.prescribe_velocity_at(self.observer.time);
        let rates_at_gaps = |joint: usize| {
            let [intrados, extrados] = self.gaps(joint).map(|gap| gap / self.last_step);
            Vector3::new(intrados, extrados, 0.0)
        };
        let mut apart: Vec<_> = (0..self.faces.len()).map(rates_at_gaps).collect();
        let last = apart.len() - 1;
        apart[last] += self.right_support_rates(last, self.right.solution_m_s);
        mem::swap(&mut self.program, &mut self.auxiliary);
        self.program
            .set_positions(&self.faces, &self.contacts, &self.positions);
        self.program.start_from(&self.auxiliary, 0.5);
        self.load(kick, self.observer.time);
        let tolerance = RATE_TOLERANCE * self.gravity * self.last_step;
        self.program.solve(|joint| apart[joint], tolerance);
        mem::swap(&mut self.program, &mut self.auxiliary);
        0.5 * self.auxiliary.twice_kinetic_j()
    }

    /// Reports the joints that open in a step from the closed row. The step begins at `from_s`, with this energy, and with these rotations and rates.
    fn note_uplift(&mut self, from_s: f64, energy_j: f64, rotations_and_rates: Vec<(f64, f64)>) {
        let opened = &mut self.observer.opened;
        opened.clear();
        for (joint, mode) in self.program.modes.iter().enumerate() {
            let stood = self.rest.touching[joint];
            if mode.pressed != stood && mode.pressed != [true; 2] {
                let edge = Edge::only(mode.pressed);
                opened.push(Hinge::Joint { joint, edge });
            }
            let gaps = &self.contacts[joint].coordinates_m;
            let least = APART_RATIO * self.faces[joint].thickness_m;
            let is_open = (0..2).any(|end| stood[end] && !mode.pressed[end] && gaps[end] > least);
            self.stands &= !is_open;
        }
        if !self.stands {
            self.report_uplift(from_s, energy_j, rotations_and_rates.into_iter().unzip());
        }
    }

    /// Whether the contacts are those of the initial position.
    fn has_initial_contacts(&self) -> bool {
        let mut modes = self.program.modes.iter().zip(&self.rest.touching);
        modes.all(|(mode, stood)| mode.pressed == *stood) && !self.right_support_is_displaced()
    }

    /// Whether the right support is displaced relative to the left one.
    fn right_support_is_displaced(&self) -> bool {
        self.right.displacement_m.norm() > APART_RATIO * self.thinnest_m
    }

    /// Horizontal displacement of the centre of gravity relative to the middle of the feet, times the mass, without the slip of the row
    /// along the ground.
    fn sway_kg_m(&self) -> f64 {
        let on_ground = match (self.row.supports, self.row.supports_extend) {
            (Supports::Left, [base, _]) => [base; 2],
            (Supports::Both, both) => both,
        };
        // A block can slide off a support that ends at the joint, so slip on such a support is included.
        let slides = self
            .support_slips_m()
            .into_iter()
            .zip(on_ground)
            .filter(|(_, on_ground)| *on_ground);
        let slid: f64 = slides.map(|(slide, _)| 0.5 * slide.x).sum();
        let mass = self.row.mass_kg();
        let sway = self.rest.mass_displacement_kg_m(&self.centres).x
            - mass * (slid + 0.5 * self.right.displacement_m.x);
        let least = SWAY_RATIO * mass * self.row.size_m;
        if sway.abs() > least { sway } else { 0.0 }
    }
}

/// Kinetic energy of blocks with these velocities (x, y) and rotation rates, in J.
fn kinetic_j(row: &Row, velocities: &[Vector3<f64>]) -> f64 {
    let twice =
        row.blocks.iter().zip(velocities).map(|(block, v)| {
            block.mass_kg * v.xy().norm_squared() + block.inertia_kg_m2 * v.z * v.z
        });
    0.5 * twice.sum::<f64>()
}

/// Joint with this index at given positions of supports and blocks.
fn contact(
    faces: &[Faces],
    supports: &[Position; 2],
    positions: &[Position],
    joint: usize,
) -> FaceContact {
    let block = |index: Option<usize>| index.and_then(|index| positions.get(index));
    let (left, right) = (block(joint.checked_sub(1)), block(Some(joint)));
    faces[joint].contact(left.unwrap_or(&supports[0]), right.unwrap_or(&supports[1]))
}

impl<'a> Stepper<'a> for SlidingStepper<'a> {
    fn observer(&self) -> &MotionObserver<'a> {
        &self.observer
    }

    fn observer_mut(&mut self) -> &mut MotionObserver<'a> {
        &mut self.observer
    }

    fn complete_summaries(&mut self) {
        self.end_landing(Dissipation::default(), true);
        let offsets_m = self.stick_offsets_m.clone();
        self.sliding().offsets_m = offsets_m;
    }

    fn step(&mut self, until: f64) -> Result<(), RowMotionError> {
        let step = equal_step(self.observer.time, until, self.observer.longest_step_s);
        let to_s = self.observer.time + 0.5 * step;
        let (kick, ground) = self.kick(to_s);
        let momentum = self.momentum();
        let stood = self.stands.then(|| {
            let energy_j = self.kinetic() + self.observer.potential;
            (
                self.observer.time,
                energy_j,
                self.rotations_and_rates().collect(),
            )
        });
        self.solve(step, to_s, kick)?;
        let mean_m_s = self.right.mean_m_s();
        if self.right.moves() {
            let last = self.faces.len() - 1;
            let work_j = self.program.impulses[last].dot(&self.right_support_rates(last, mean_m_s));
            self.observer.row_summary.right_foot_j -= work_j;
            let impulse = self.ties.right_support_force_n() * (to_s - self.kicked_s);
            self.observer.row_summary.right_foot_j -= impulse.dot(&mean_m_s);
        }
        for (block, velocity) in self.velocities.iter_mut().enumerate() {
            *velocity = self.program.velocity(block);
        }
        self.observer.row_summary.ground_j -= ground.dot(&((momentum + self.momentum()) * 0.5));
        self.note_forces(to_s - self.kicked_s);
        self.kicked_s = to_s;
        self.last_step = step;
        let landing = self.find_landing(step);
        let [mut late, taken] = self.dissipation(mean_m_s);
        self.sliding().friction_j += late.friction_j + taken.friction_j;
        if landing.is_none() {
            late.add(taken);
            // Friction in an impact does not count as holding the row up.
            self.sliding_friction_j += self.step_friction_j();
        }
        self.end_landing(late, landing.is_none());
        if let Some(landing) = landing {
            self.landing = Some(Landing {
                energy_before_j: self.kinetic() + taken.total_j,
                dissipation: taken,
                ..landing
            });
            self.observer.await_impact();
        }
        let tie_events = self.drift(step);
        if self.landing.is_some() {
            self.observer.note_impact();
        }
        if let Some((from_s, energy_j, rotations_and_rates)) = stood {
            self.note_uplift(from_s, energy_j, rotations_and_rates);
        } else {
            self.stands = self.has_initial_contacts();
        }
        let scale_j = self.observer.input.energy_scale_j;
        self.observer.halve_unbalanced_steps(scale_j, || scale_j);
        self.report_ties(tie_events);
        Ok(())
    }

    fn write(&mut self, sample: &mut Sample, thrust_line: bool) -> Result<f64, RowMotionError> {
        let kinetic_j = self.synchronise();
        let rates = (0..self.positions.len()).map(|index| self.auxiliary.velocity(index).z);
        sample.rates_rad_s.extend(rates);
        sample.feet_apart_m = self.right.displacement_m;
        sample.offsets_m.extend(&self.stick_offsets_m);
        sample.ties.extend(self.ties.samples());
        sample.demand.friction = self.friction_demand;
        if thrust_line {
            let impulses = self.auxiliary.impulses.iter();
            let ratios = impulses.map(|impulse| eccentricity_ratio([impulse.x, impulse.y]));
            sample.eccentricity_ratios.extend(ratios);
        }
        Ok(kinetic_j)
    }

    fn rotations_and_rates(&self) -> impl Iterator<Item = (f64, f64)> {
        let rotations = self.positions.iter().map(|position| position.rotation_rad);
        let rates = self.velocities.iter().map(|velocity| velocity.z);
        self.rest.relative_rotations_rad(rotations).zip(rates)
    }

    fn poses(&self) -> impl Iterator<Item = Pose> {
        let blocks = self.row.blocks.iter().zip(&self.positions);
        blocks.map(|(block, position)| position.pose(block.centre_m))
    }

    fn gaps(&self, joint: usize) -> [f64; 2] {
        let pressed = self.program.modes[joint].pressed;
        let gaps = &self.contacts[joint].coordinates_m;
        [0, 1].map(|end| {
            if pressed[end] {
                0.0
            } else {
                gaps[end].max(0.0)
            }
        })
    }

    fn corner(&self, joint: usize, edge: Edge) -> Vector2<f64> {
        self.contacts[joint].corner_m(edge)
    }

    fn momentum(&self) -> Vector2<f64> {
        let blocks = self.row.blocks.iter().zip(&self.velocities);
        blocks.map(|(block, v)| v.xy() * block.mass_kg).sum()
    }

    fn stands(&self, sample: &Sample) -> bool {
        let stood = &self.rest.touching;
        let touches = |joint: usize| self.gaps(joint).map(|gap| gap == 0.0) == stood[joint];
        let lies = if self.right_support_is_displaced() {
            self.observer.is_quiet(self.observer.quiet_since_s)
        } else {
            (0..self.faces.len()).all(touches)
        };
        let slips = |mode: &JointMode| matches!(mode.tangential, TangentialMode::Slip(_));
        (lies && !self.program.modes.iter().any(slips))
            || sample.rotations_rad.iter().all(|angle| *angle == 0.0)
    }

    fn at_rest_since_s(&self) -> Option<f64> {
        let low = self.observer.potential.abs() < REST_ENERGY_RATIO * self.observer.energy_unit;
        let undeformed = low && !self.right_support_is_displaced();
        let rests = if undeformed {
            self.observer.time > self.observer.quiet_since_s
        } else {
            self.observer.is_quiet(self.observer.quiet_since_s)
        };
        rests.then_some(self.observer.quiet_since_s)
    }
}
