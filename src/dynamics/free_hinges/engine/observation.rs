//! What is noted on the way: energies and their balance, peaks, half cycles, impacts and samples.

use nalgebra::Vector2;

use super::{Engine, Piece};
use crate::dynamics::free_hinges::course::{Stepper as _, heading};
use crate::dynamics::free_hinges::{FreeHingeError, Impact, Recorder, Sample, Uplift};
use crate::mechanics::blocks::Row;
use crate::mechanics::chain::Hinge;
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::geometry::ring::Edge;

/// At rest, kinetic and potential energy are below this part of weight times size.
const REST_ENERGY_RATIO: f64 = 1e-9;
/// Joints that open at less than this part of the fastest rate do not count as opened by an impact.
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

/// The edge of the only one of two corners of a joint, intrados and extrados.
pub(in crate::dynamics::free_hinges) fn only(corners: [bool; 2]) -> Option<Edge> {
    match corners {
        [true, false] => Some(Edge::Intrados),
        [false, true] => Some(Edge::Extrados),
        _ => None,
    }
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

impl Engine<'_> {
    pub(super) fn momentum(&self) -> Vector2<f64> {
        momentum(&self.pieces)
    }

    pub(super) fn height_energy(&self) -> f64 {
        self.gravity * rise(self.row, self.placement.centres_m())
    }

    pub(super) fn is_at_rest(&self) -> bool {
        let least = REST_ENERGY_RATIO * self.course.energy_unit;
        kinetic(&self.pieces) < least && self.course.potential.abs() < least
    }

    /// Compares the energy at an instant with its balance.
    pub(super) fn audit(&mut self, kinetic: f64) {
        let due = self.start_energy + self.ground_work - self.course.run.energy_taken_j;
        let defect = (kinetic + self.course.potential - due) / self.course.energy_unit;
        let worst = &mut self.course.run.energy_defect_ratio;
        *worst = worst.max(defect.abs());
    }

    /// Tells the course of the motion about the state after a step.
    pub(super) fn observe(&mut self) {
        self.course.moved |= self.placement.gaps_m().iter().any(|gaps| *gaps != [0.0; 2]);
        let potential = self.height_energy();
        let sway = sway(self.row, self.placement.centres_m());
        let rotations = self.placement.poses().iter().map(Pose::rotation_rad);
        let kinetic = kinetic(&self.pieces);
        self.course.observe(rotations, potential, kinetic, sway);
    }

    pub(super) fn report(&mut self, taken_before: f64, recorder: &mut impl Recorder) {
        self.shut.clear();
        self.opened.clear();
        for joint in 0..self.touching.len() {
            if self.closed[joint] != [true; 2] && self.placement.is_shut(joint) {
                let edge = only(self.closed[joint].map(|closed| !closed));
                self.shut.push(Hinge::Joint { joint, edge });
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
                self.opened.push(Hinge::Joint { joint, edge });
            }
        }
        self.note_rotations();
        for (rate, twist) in self.rates.iter_mut().zip(self.program.velocities()) {
            *rate = twist.rate;
        }
        let energy_taken_j = self.course.run.energy_taken_j - taken_before;
        let gaps_m = self.placement.gaps_m();
        self.stands = self.opened.is_empty() && gaps_m.iter().all(|gaps| *gaps == [0.0; 2]);
        let flow = recorder.impact(&Impact {
            time_s: self.course.time,
            sway: (!self.stands).then(|| heading(self.sway(), self.momentum().x)),
            shut: &self.shut,
            opened: &self.opened,
            energy_before_j: kinetic(&self.pieces) + energy_taken_j,
            energy_taken_j,
            friction_j: None,
            rotations_rad: &self.rotations,
            rates_after_rad_s: &self.rates,
            gaps_m,
            potential_j: self.course.potential,
            overturned: self.overturned_s().is_some(),
        });
        self.course.stopped |= flow.is_break();
    }

    /// Tells of joints that opened in a step from this time on, before which all were shut.
    pub(super) fn report_uplift(&mut self, from_s: f64, recorder: &mut impl Recorder) {
        self.opened.clear();
        for (joint, gaps) in self.placement.gaps_m().iter().enumerate() {
            if *gaps != [0.0; 2] {
                let edge = only(gaps.map(|gap| gap == 0.0));
                self.opened.push(Hinge::Joint { joint, edge });
            }
        }
        self.stands = self.opened.is_empty();
        if self.stands {
            return;
        }
        // With all joints shut the row stood undeformed, and still.
        self.rotations.fill(0.0);
        self.rates.fill(0.0);
        let flow = recorder.uplift(&Uplift {
            time_s: from_s,
            opened: &self.opened,
            sway: heading(self.sway(), self.momentum().x),
            rotations_rad: &self.rotations,
            rates_rad_s: &self.rates,
            energy_j: 0.0,
        });
        self.course.stopped |= flow.is_break();
    }

    pub(super) fn note_rotations(&mut self) {
        for (rotation, pose) in self.rotations.iter_mut().zip(self.placement.poses()) {
            *rotation = pose.rotation_rad();
        }
    }

    pub(super) fn record(&mut self, recorder: &mut impl Recorder) -> Result<(), FreeHingeError> {
        let before = self.momentum();
        let ground = self.half_kick();
        std::mem::swap(&mut self.program, &mut self.auxiliary);
        self.program.place(&self.placement);
        self.program.start_from(self.auxiliary.active());
        let solved = self.solve();
        let kinetic_j = self.kinetic_of_solution();
        for (rate, twist) in self.rates.iter_mut().zip(self.program.velocities()) {
            *rate = twist.rate;
        }
        std::mem::swap(&mut self.program, &mut self.auxiliary);
        solved?;
        let work = ground.dot(&(before + momentum(&self.next_pieces))) * 0.5;
        self.ground_work -= work;
        self.audit(kinetic_j);
        self.ground_work += work;
        self.note_rotations();
        let gaps_m = self.placement.gaps_m();
        let flow = recorder.sample(&Sample {
            time_s: self.course.time,
            rotations_rad: &self.rotations,
            rates_rad_s: &self.rates,
            gaps_m,
            poses: self.placement.poses(),
            frames: self.placement.frames(),
            open_joints: gaps_m.iter().filter(|gaps| **gaps != [0.0; 2]).count(),
            friction_demand: self.friction_demand,
            least_normal_n: self.least_normal,
            // The programs were exchanged: this is the solution of the sample.
            corner_impulses_n_s: self.auxiliary.corner_impulses(),
            offsets_m: &[],
            slipping_joints: 0,
            sway: heading(self.sway(), self.momentum().x),
            overturned: self.overturned_s().is_some(),
            kinetic_j,
            potential_j: self.course.potential,
        });
        self.course.stopped |= flow.is_break();
        Ok(())
    }
}
