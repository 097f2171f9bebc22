//! What is noted on the way: energies and their balance, peaks, half cycles, impacts and samples.

use nalgebra::Vector2;

use super::{Engine, Piece};
use crate::dynamics::free_hinges::{FreeHingeError, HalfCycle, Impact, Recorder, Sample};
use crate::mechanics::geometry::field::Twist;
use crate::mechanics::sway::Sway;

/// At rest, kinetic and potential energy are below this part of weight times size.
const REST_ENERGY_RATIO: f64 = 1e-9;
/// Sways below this part of the size do not count as a change of side.
const SWAY_RATIO: f64 = 1e-9;
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

impl Engine<'_> {
    pub(super) fn momentum(&self) -> Vector2<f64> {
        momentum(&self.pieces)
    }

    /// Potential energy above the undeformed row.
    pub(super) fn height_energy(&self) -> f64 {
        let rises = self.row.blocks().iter().zip(self.placement.centres_m());
        let sum: f64 = rises
            .map(|(block, centre)| block.mass_kg * (centre.y - block.centre_m.y))
            .sum();
        self.gravity * sum
    }

    /// Horizontal displacement of the centre of gravity times the mass.
    pub(super) fn sway(&self) -> f64 {
        let shifts = self.row.blocks().iter().zip(self.placement.centres_m());
        shifts
            .map(|(block, centre)| block.mass_kg * (centre.x - block.centre_m.x))
            .sum()
    }

    pub(super) fn rests(&self) -> bool {
        let least = REST_ENERGY_RATIO * self.energy_unit;
        kinetic(&self.pieces) < least && self.potential.abs() < least
    }

    /// Compares the energy at an instant with its balance.
    pub(super) fn audit(&mut self, kinetic: f64) {
        let due = self.start_energy + self.ground_work - self.run.energy_taken_j;
        let defect = (kinetic + self.potential - due) / self.energy_unit;
        let worst = &mut self.run.energy_defect_ratio;
        *worst = worst.max(defect.abs());
    }

    /// Peaks, half cycles and energy after a step.
    pub(super) fn observe(&mut self) {
        let mut largest = 0.0_f64;
        for (peak, pose) in self.run.peaks_rad.iter_mut().zip(self.placement.poses()) {
            let rotation = pose.rotation_rad.abs();
            *peak = peak.max(rotation);
            largest = largest.max(rotation);
        }
        self.moved |= self.placement.gaps_m().iter().any(|gaps| *gaps != [0.0; 2]);
        let before = self.potential;
        self.potential = self.height_energy();
        if self.potential >= before {
            self.rising = true;
        } else if self.rising {
            self.rising = false;
            self.highest_s = self.time;
        }
        let sway = self.sway();
        let least = SWAY_RATIO * self.energy_unit / self.gravity;
        if sway.abs() > least {
            let side = if sway > 0.0 { Sway::Right } else { Sway::Left };
            if self.cycle.is_none_or(|cycle| cycle.sway != side) {
                self.end_cycle(Some(kinetic(&self.pieces) + self.potential));
                self.cycle = Some(HalfCycle {
                    sway: side,
                    start_s: self.time,
                    duration_s: 0.0,
                    peak_rad: 0.0,
                    energy_ratio: None,
                });
            }
        }
        if let Some(cycle) = &mut self.cycle {
            cycle.peak_rad = cycle.peak_rad.max(largest);
        }
    }

    /// Files the half cycle that ends now, with the energy that is left if it is known.
    pub(super) fn end_cycle(&mut self, energy: Option<f64>) {
        if let Some(mut cycle) = self.cycle.take() {
            cycle.duration_s = self.time - cycle.start_s;
            let ratio = energy
                .zip(self.cycle_energy)
                .map(|(after, before)| after / before);
            cycle.energy_ratio = ratio.filter(|ratio| ratio.is_finite());
            self.run.half_cycles.push(cycle);
            self.cycle_energy = energy;
        }
    }

    pub(super) fn report(&mut self, taken_before: f64, recorder: &mut impl Recorder) {
        self.shut.clear();
        self.opened.clear();
        for joint in 0..self.touching.len() {
            if self.closed[joint] != [true; 2] && self.placement.is_shut(joint) {
                self.shut.push(joint);
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
                self.opened.push(joint);
            }
        }
        self.note_rotations();
        for (rate, twist) in self.rates.iter_mut().zip(self.program.velocities()) {
            *rate = twist.rate;
        }
        let energy_taken_j = self.run.energy_taken_j - taken_before;
        let flow = recorder.impact(&Impact {
            time_s: self.time,
            shut: &self.shut,
            opened: &self.opened,
            energy_before_j: kinetic(&self.pieces) + energy_taken_j,
            energy_taken_j,
            rotations_rad: &self.rotations,
            rates_after_rad_s: &self.rates,
            potential_j: self.potential,
            poses: self.placement.poses(),
        });
        self.stopped |= flow.is_break();
    }

    pub(super) fn note_rotations(&mut self) {
        for (rotation, pose) in self.rotations.iter_mut().zip(self.placement.poses()) {
            *rotation = pose.rotation_rad;
        }
    }

    pub(super) fn sample(&mut self, recorder: &mut impl Recorder) -> Result<(), FreeHingeError> {
        let before = self.momentum();
        let (impulse, ground) = self.impulse(self.time - 0.5 * self.last_step, self.time);
        self.kick(impulse);
        self.jumps.fill(Twist::ZERO);
        self.landing.fill([0.0; 2]);
        self.touch_shut();
        std::mem::swap(&mut self.program, &mut self.auxiliary);
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
            time_s: self.time,
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
            kinetic_j,
            potential_j: self.potential,
        });
        self.stopped |= flow.is_break();
        Ok(())
    }
}
