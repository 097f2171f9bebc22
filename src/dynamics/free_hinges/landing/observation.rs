//! What is recorded and reported on the way: energies and their balance, impacts and samples.

use nalgebra::Vector2;

use super::{LandingStepper, Piece};
use crate::dynamics::free_hinges::FreeHingeError;
use crate::dynamics::history::Sample;
use crate::dynamics::row::course::{
    Course, Stepper, eccentricity_ratio, equal_step, only, open_hinge,
};
use crate::mechanics::blocks::Row;
use crate::mechanics::chain::Hinge;
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::geometry::ring::Edge;

/// At rest, kinetic and potential energy are below this fraction of weight times size.
const REST_ENERGY_RATIO: f64 = 1e-9;
/// Joints that open at less than this fraction of the fastest rate do not count as opened by an
/// impact.
const LEAST_OPENING: f64 = 1e-9;

pub(super) fn kinetic(pieces: &[Piece]) -> f64 {
    let twice = |piece: &Piece| {
        piece.mass * piece.velocity.norm_squared() + piece.inertia * piece.rate * piece.rate
    };
    0.5 * pieces.iter().map(twice).sum::<f64>()
}

pub(super) fn momentum(pieces: &[Piece]) -> Vector2<f64> {
    pieces.iter().map(|piece| piece.velocity * piece.mass).sum()
}

/// Rise of the blocks with their centres at the given places, times their masses.
pub(in crate::dynamics::free_hinges) fn rise(row: &Row, centres_m: &[Vector2<f64>]) -> f64 {
    let rises = row.blocks().iter().zip(centres_m);
    rises
        .map(|(block, centre)| block.mass_kg * (centre.y - block.centre_m.y))
        .sum()
}

/// Horizontal displacement of the centre of gravity times the mass.
pub(in crate::dynamics::free_hinges) fn sway(row: &Row, centres_m: &[Vector2<f64>]) -> f64 {
    let shifts = row.blocks().iter().zip(centres_m);
    shifts
        .map(|(block, centre)| block.mass_kg * (centre.x - block.centre_m.x))
        .sum()
}

impl LandingStepper<'_> {
    pub(super) fn height_energy(&self) -> f64 {
        self.gravity * rise(self.row, self.placement.centres_m())
    }

    /// Potential energy of the blocks.
    fn height(&self) -> f64 {
        if self.ties.are_none() {
            self.course.potential
        } else {
            self.height_energy()
        }
    }

    /// Potential energy of the blocks, and what is in the ties beyond that at rest.
    pub(super) fn energy(&self) -> f64 {
        self.height_energy() + self.ties.energy_j()
    }

    /// Compares the energy at an instant with its balance.
    pub(super) fn audit(&mut self, kinetic: f64) {
        let taken = self.course.of_row.energy_taken_j + self.ties.taken_j();
        let due = self.start_energy + self.ground_work - taken;
        let defect = kinetic + self.course.potential - due;
        self.course.note_defect(defect.abs());
    }

    /// Reports the state after a step to the course of the motion.
    fn observe(&mut self) {
        self.course.moved |= self.placement.gaps_m().iter().any(|gaps| *gaps != [0.0; 2]);
        let potential = self.energy();
        let sway = sway(self.row, self.placement.centres_m());
        let rotations = self.placement.poses().iter().map(Pose::rotation_rad);
        let kinetic = kinetic(&self.pieces);
        self.course.observe(rotations, potential, kinetic, sway);
    }

    fn report_impact(&mut self, taken_before: f64) {
        let (shut, opened) = (&mut self.course.shut, &mut self.course.opened);
        shut.clear();
        opened.clear();
        for joint in 0..self.touching.len() {
            if self.closed[joint] != [true; 2] && self.placement.is_shut(joint) {
                let edge = only(self.closed[joint].map(|closed| !closed));
                shut.push(Hinge::Joint { joint, edge });
            }
        }
        let fastest = self
            .program
            .open_joints()
            .flat_map(|(_, rates)| rates)
            .fold(0.0, f64::max);
        for (joint, rates) in self.program.open_joints() {
            let opens = rates[0].max(rates[1]) > LEAST_OPENING * fastest;
            let was_shut = self.closed[joint] == [true; 2] || self.placement.is_shut(joint);
            if was_shut && opens {
                let edge = only(self.program.active()[joint]);
                opened.push(Hinge::Joint { joint, edge });
            }
        }
        let taken_j = self.course.of_row.energy_taken_j - taken_before;
        let gaps_m = self.placement.gaps_m();
        self.stands = self.course.opened.is_empty() && gaps_m.iter().all(|gaps| *gaps == [0.0; 2]);
        let before_j = kinetic(&self.pieces) + taken_j;
        self.tell_impact(!self.stands, [before_j, taken_j], None);
    }

    /// Reports the joints that opened in a step that began at this time with all joints shut.
    fn report_uplift(&mut self, from_s: f64) {
        let opened = &mut self.course.opened;
        opened.clear();
        let gaps = self.placement.gaps_m().iter().enumerate();
        opened.extend(gaps.filter_map(|(joint, gaps)| open_hinge(joint, *gaps)));
        self.stands = opened.is_empty();
        if !self.stands {
            // With all joints shut the row stood undeformed, and still.
            let blocks = self.row.blocks().len();
            self.tell_uplift(from_s, 0.0, |_| (vec![0.0; blocks], vec![0.0; blocks]));
        }
    }
}

impl<'a> Stepper<'a> for LandingStepper<'a> {
    type Error = FreeHingeError;

    fn course(&self) -> &Course<'a> {
        &self.course
    }

    fn course_mut(&mut self) -> &mut Course<'a> {
        &mut self.course
    }

    fn completed(&mut self) -> &mut Course<'a> {
        self.course.of_row.ties = self.ties.summaries();
        &mut self.course
    }

    /// It ends at its landing, if there is one.
    fn step(&mut self, until: f64) -> Result<(), FreeHingeError> {
        self.step_iterations = 0;
        let longest = equal_step(self.course.time, until, self.settings.longest_step_s);
        self.touch_shut();
        self.closed.copy_from_slice(&self.touching);
        let from_s = self.course.time;
        let taken_before = self.course.of_row.energy_taken_j;
        self.landing.fill([0.0; 2]);
        if self.has_just_landed() {
            self.press_again();
        }
        let step = self.solve_to_landing(longest)?;
        self.account(&step);
        self.drift(&step)?;
        let landed = self.has_landed();
        if landed {
            self.impact()?;
        }
        self.observe();
        if landed {
            self.report_impact(taken_before);
        } else if self.stands {
            self.report_uplift(from_s);
        }
        for (tie, kind) in self.ties.happened(self.course.time) {
            self.tell_tie(tie, kind);
        }
        self.course.summary.cost.steps += 1;
        let of_row = &mut self.course.of_row;
        of_row.merged += u64::from(step.merged);
        of_row.most_iterations = of_row.most_iterations.max(self.step_iterations);
        Ok(())
    }

    fn write(&mut self, sample: &mut Sample, thrust_line: bool) -> Result<f64, FreeHingeError> {
        let before = self.momentum();
        let ground = self.half_kick();
        std::mem::swap(&mut self.program, &mut self.auxiliary);
        self.program.place(&self.placement);
        self.program.start_from(self.auxiliary.active());
        let solved = self.solve();
        let kinetic_j = self.kinetic_of_solution();
        let rates = self.program.velocities().iter().map(|twist| twist.rate);
        sample.rates_rad_s.extend(rates);
        if thrust_line {
            let impulses = self.program.corner_impulses().iter().copied();
            sample
                .eccentricity_ratios
                .extend(impulses.map(eccentricity_ratio));
        }
        std::mem::swap(&mut self.program, &mut self.auxiliary);
        solved?;
        let work = ground.dot(&(before + momentum(&self.next_pieces))) * 0.5;
        self.ground_work -= work;
        self.audit(kinetic_j);
        self.ground_work += work;
        sample.poses.extend(self.placement.poses());
        sample.ties.extend(self.ties.samples());
        sample.demand.friction = self.friction_demand;
        Ok(kinetic_j)
    }

    fn turns(&self) -> impl Iterator<Item = (f64, f64)> {
        let rates = self.program.velocities().iter().map(|twist| twist.rate);
        let poses = self.placement.poses().iter();
        poses.map(Pose::rotation_rad).zip(rates)
    }

    fn gaps(&self, joint: usize) -> [f64; 2] {
        self.placement.gaps_m()[joint]
    }

    fn corner(&self, joint: usize, edge: Edge) -> Vector2<f64> {
        self.placement.frames()[joint].corner_m(edge)
    }

    fn momentum(&self) -> Vector2<f64> {
        momentum(&self.pieces)
    }

    fn rests_since(&self) -> Option<f64> {
        let least = REST_ENERGY_RATIO * self.course.energy_unit;
        // Ties that have yielded or broken hold another energy where the row rests.
        let height = self.height();
        let rests = kinetic(&self.pieces) < least && height.abs() < least;
        rests.then_some(self.course.time)
    }

    /// By its height: what is in ties may be less than at rest.
    fn overturned_s(&self) -> Option<f64> {
        self.course.fallen_s(self.height())
    }
}
