//! Records during the motion: energy balance, impacts and samples.

use nalgebra::Vector2;

use super::{LandingStepper, MovingPiece};
use crate::dynamics::row::observer::REST_ENERGY_RATIO;
use crate::dynamics::row::stepper::{eccentricity_ratio, equal_step, open_hinge};
use crate::dynamics::{MotionObserver, RowMotionError, Sample, Stepper};
use crate::mechanics::joints::SHUT_RATIO;
use crate::mechanics::{Edge, Hinge, Pose};

/// Least opening rate, relative to the fastest one, of a joint that an impact opens.
const LEAST_OPENING: f64 = 1e-9;
/// Rate of a gap after an impact, relative to the fastest one, up to which gravity probably closes it in the next step.
const SLOW_RATIO: f64 = 1e-3;

pub fn kinetic(pieces: &[MovingPiece]) -> f64 {
    let twice = |piece: &MovingPiece| {
        piece.mass * piece.velocity.norm_squared() + piece.inertia * piece.rate * piece.rate
    };
    0.5 * pieces.iter().map(twice).sum::<f64>()
}

pub fn momentum(pieces: &[MovingPiece]) -> Vector2<f64> {
    pieces.iter().map(|piece| piece.velocity * piece.mass).sum()
}

/// Kinetic energy, relative to weight times size, that counts as zero.
const LEAST_SWING_RATIO: f64 = 1e-18;

impl LandingStepper<'_> {
    pub fn height_energy(&self) -> f64 {
        self.gravity
            * self
                .rest
                .mass_displacement_kg_m(&self.placement.centres_m)
                .y
    }

    /// Potential energy of the blocks, in J.
    fn height(&self) -> f64 {
        if self.ties.are_none() {
            self.observer.potential
        } else {
            self.height_energy()
        }
    }

    /// Potential energy of the blocks plus the elastic energy of the ties above that at rest, in J.
    pub fn energy(&self) -> f64 {
        self.height_energy() + self.ties.energy_j()
    }

    /// Compares the energy at an instant with the energy balance.
    pub fn check_energy(&mut self, kinetic: f64) {
        let taken = self.observer.row_summary.energy_taken_j + self.ties.taken_j();
        let due = self.start_energy
            + self.observer.row_summary.ground_j
            + self.observer.row_summary.right_foot_j
            - taken;
        let defect = kinetic + self.observer.potential - due;
        self.observer.note_defect(defect.abs());
    }

    /// Reports the state after a step to the course of the motion.
    fn observe(&mut self) {
        let lies = self.lies_at_rest();
        let potential = self.energy();
        // At rest on hinges, the sway is only a rounding error.
        let sway = if lies { 0.0 } else { self.sway_kg_m() };
        let kinetic = kinetic(&self.pieces);
        // On hinges a row may move without a change of contacts.
        let swings =
            self.rest.is_on_hinges() && kinetic > LEAST_SWING_RATIO * self.observer.energy_unit;
        self.observer.moved |= !lies || swings;
        let rotations = self.placement.poses.iter().map(Pose::rotation_rad);
        let rotations = self.rest.relative_rotations_rad(rotations);
        self.observer.observe(rotations, potential, kinetic, sway);
        let least = REST_ENERGY_RATIO * self.observer.energy_unit;
        // Ties that have yielded or broken have another elastic energy at rest.
        let rests = kinetic < least && self.height().abs() < least;
        let known_s = self.rest_since_s.filter(|_| lies);
        self.rest_since_s = rests.then(|| known_s.unwrap_or(self.observer.time));
        if self.may_end_on_hinges() {
            self.observe_hinges();
        }
    }

    /// Whether the row may come to rest on hinges: it started on hinges, or its feet move differently.
    fn may_end_on_hinges(&self) -> bool {
        self.rest.is_on_hinges() || self.right.moves()
    }

    /// Records heights and displacements of a row that may end on hinges. Its position at rest may be higher or lower, so energy shows neither rest
    /// nor overturning. A block has left if it is far from its initial positions relative to both feet.
    fn observe_hinges(&mut self) {
        let height = (!self.right.moves()).then_some(self.observer.potential);
        self.observer.note_height(height);
        let rotations = self.placement.poses.iter().map(Pose::rotation_rad);
        let blocks = self.placement.centres_m.iter().copied().zip(rotations);
        let feet_m = [Vector2::zeros(), self.right.displacement_m];
        self.observer.overturned |= self.rest.has_left(blocks, feet_m);
    }

    /// Whether the row is in its initial position.
    fn lies_at_rest(&self) -> bool {
        self.rest.has_contacts(&self.placement.gaps_m) && !self.right_support_is_displaced()
    }

    /// Whether the right support is displaced relative to the left one.
    pub fn right_support_is_displaced(&self) -> bool {
        self.right.displacement_m.norm() > SHUT_RATIO * self.thinnest
    }

    /// Horizontal displacement of the centre of gravity relative to the middle of the feet, times the mass, in kg m.
    pub fn sway_kg_m(&self) -> f64 {
        let sway = self
            .rest
            .mass_displacement_kg_m(&self.placement.centres_m)
            .x;
        sway - 0.5 * self.row.mass_kg() * self.right.displacement_m.x
    }

    fn note_impact(&mut self, taken_before: f64) {
        let (shut, opened) = (&mut self.observer.shut, &mut self.observer.opened);
        shut.clear();
        opened.clear();
        for joint in 0..self.load.touching.len() {
            if self.closed[joint] != [true; 2] && self.placement.is_shut(joint) {
                let edge = Edge::only(self.closed[joint].map(|closed| !closed));
                shut.push(Hinge::Joint { joint, edge });
            }
        }
        let rates = self.program.open_joints().flat_map(|(_, rates)| rates);
        let fastest = rates.fold(0.0, f64::max);
        for (joint, rates) in self.program.open_joints() {
            let opens = rates[0].max(rates[1]) > LEAST_OPENING * fastest;
            let was_shut = self.closed[joint] == [true; 2] || self.placement.is_shut(joint);
            if was_shut && opens {
                let edge = Edge::only(self.program.active[joint]);
                opened.push(Hinge::Joint { joint, edge });
            }
        }
        let taken_j = self.observer.row_summary.energy_taken_j - taken_before;
        self.stands = self.observer.opened.is_empty() && self.lies_at_rest();
        let before_j = kinetic(&self.pieces) + taken_j;
        let lies = self.lies_at_rest();
        self.report_impact([!self.stands, lies], [before_j, taken_j], None);
    }

    /// Reports the joints that open in a step from the initial position. The step begins at `from_s`.
    fn note_uplift(&mut self, from_s: f64) {
        let opened = &mut self.observer.opened;
        opened.clear();
        let gaps = self.placement.gaps_m.iter().enumerate();
        let stood = &self.rest.touching;
        let shut = gaps.filter(|(joint, _)| stood[*joint] == [true; 2]);
        opened.extend(shut.filter_map(|(joint, gaps)| open_hinge(joint, *gaps)));
        self.stands = opened.is_empty() && !self.right_support_is_displaced();
        if !self.stands {
            // The row was at rest until then.
            let still = vec![0.0; self.row.blocks.len()];
            self.report_uplift(from_s, 0.0, (still.clone(), still));
        }
    }
}

impl<'a> Stepper<'a> for LandingStepper<'a> {
    fn observer(&self) -> &MotionObserver<'a> {
        &self.observer
    }

    fn observer_mut(&mut self) -> &mut MotionObserver<'a> {
        &mut self.observer
    }

    /// Takes a step, which ends at the first landing if there is one.
    fn step(&mut self, until: f64) -> Result<(), RowMotionError> {
        self.step_iterations = 0;
        let longest = equal_step(self.observer.time, until, self.observer.longest_step_s);
        self.constrain_closed_corners();
        self.closed.copy_from_slice(&self.load.touching);
        let from_s = self.observer.time;
        let taken_before = self.observer.row_summary.energy_taken_j;
        self.landing.fill([0.0; 2]);
        if self.has_just_landed() {
            // Most corners that were in contact before the impact are in contact again under gravity, but for those that open fast.
            self.note_rates();
            let rates = self.program.open_joints().flat_map(|(_, rates)| rates);
            let slow = SLOW_RATIO * rates.fold(0.0, f64::max);
            self.press(|stepper, joint, edge| {
                stepper.pressed[joint][edge] && stepper.earlier_rates[joint][edge] <= slow
            });
        }
        let step = self.solve_to_landing(longest)?;
        self.record_step(&step);
        self.drift(&step)?;
        let mut joints = 0..self.load.touching.len();
        let landed = joints.any(|joint| (0..2).any(|edge| self.has_landed(joint, edge)));
        if landed {
            self.impact()?;
        }
        let tie_events = self.observer.note_ties(self.ties.memories());
        self.observe();
        if landed {
            self.note_impact(taken_before);
        } else if self.stands {
            self.note_uplift(from_s);
        }
        let scale_j = self.observer.input.energy_scale_j;
        self.observer.halve_unbalanced_steps(scale_j, || scale_j);
        self.report_ties(tie_events);
        self.observer.cost.steps += 1;
        let row_summary = &mut self.observer.row_summary;
        row_summary.merged += u64::from(step.merged);
        row_summary.most_iterations = row_summary.most_iterations.max(self.step_iterations);
        Ok(())
    }

    fn write(&mut self, sample: &mut Sample, thrust_line: bool) -> Result<f64, RowMotionError> {
        let before = self.momentum();
        let ground = self.half_kick();
        std::mem::swap(&mut self.program, &mut self.auxiliary);
        self.program.set_positions(&self.placement);
        self.program.start_from(&self.auxiliary.active);
        let solved = self.solve();
        let kinetic_j = self.kinetic_of_solution();
        let rates = self.program.velocities.iter().map(|twist| twist.rate);
        sample.rates_rad_s.extend(rates);
        if thrust_line {
            let impulses = self.program.corner_impulses().iter().copied();
            let ratios = impulses.map(eccentricity_ratio);
            sample.eccentricity_ratios.extend(ratios);
        }
        let right_j = self.work_of_right_support(self.observer.time - self.kicked_s);
        std::mem::swap(&mut self.program, &mut self.auxiliary);
        solved?;
        let work = ground.dot(&(before + momentum(&self.next_pieces))) * 0.5;
        self.observer.row_summary.ground_j -= work;
        self.observer.row_summary.right_foot_j += right_j;
        self.check_energy(kinetic_j);
        self.observer.row_summary.ground_j += work;
        self.observer.row_summary.right_foot_j -= right_j;
        sample.feet_apart_m = self.right.displacement_m;
        sample.ties.extend(self.ties.samples());
        sample.demand.friction = self.friction_demand;
        Ok(kinetic_j)
    }

    fn rotations_and_rates(&self) -> impl Iterator<Item = (f64, f64)> {
        let rates = self.program.velocities.iter().map(|twist| twist.rate);
        let rotations = self.placement.poses.iter().map(Pose::rotation_rad);
        self.rest.relative_rotations_rad(rotations).zip(rates)
    }

    fn poses(&self) -> impl Iterator<Item = Pose> {
        self.placement.poses.iter().copied()
    }

    fn gaps(&self, joint: usize) -> [f64; 2] {
        self.placement.gaps_m[joint]
    }

    fn corner(&self, joint: usize, edge: Edge) -> Vector2<f64> {
        self.placement.frames[joint].corner_m(edge)
    }

    fn momentum(&self) -> Vector2<f64> {
        momentum(&self.pieces)
    }

    fn stands(&self, sample: &Sample) -> bool {
        let quiet = || self.observer.is_quiet(self.observer.quiet_since_s);
        let lies = self.lies_at_rest() || (self.may_end_on_hinges() && quiet());
        lies || sample.rotations_rad.iter().all(|angle| *angle == 0.0)
    }

    fn at_rest_since_s(&self) -> Option<f64> {
        let on_hinges = self.rest.is_on_hinges() || self.right_support_is_displaced();
        if on_hinges && !self.lies_at_rest() {
            let quiet = self.observer.is_quiet(self.observer.quiet_since_s);
            return quiet.then_some(self.observer.quiet_since_s);
        }
        self.rest_since_s
    }

    /// Decides by height only: the elastic energy of ties may be less than at rest.
    fn overturned_s(&self) -> Option<f64> {
        if self.may_end_on_hinges() {
            return self.observer.overturned_s();
        }
        self.observer.fallen_s(self.height())
    }
}
