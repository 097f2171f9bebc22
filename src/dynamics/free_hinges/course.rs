//! The course of a motion, whichever engine steps it: its clock and driver, peaks, half cycles and outcome.

use std::time::{Duration, Instant};

use crate::dynamics::ground::GroundMotion;
use crate::mechanics::blocks::Row;
use crate::mechanics::sway::Sway;

use super::{Cost, Elapsed, FreeHingeError, HalfCycle, Outcome, Recorder, Run, Settings};

/// Sways below this part of the size do not count as a change of side.
pub(super) const SWAY_RATIO: f64 = 1e-9;

/// What has happened so far.
pub(super) struct Course {
    pub time: f64,
    /// Potential energy above the undeformed row.
    pub potential: f64,
    /// Whether a joint has opened or slipped.
    pub moved: bool,
    /// Whether the recorder broke.
    pub stopped: bool,
    /// Weight times size.
    pub energy_unit: f64,
    pub run: Run,
    gravity: f64,
    /// Potential energy below which the row has overturned, where that tells.
    fallen: f64,
    cycle: Option<HalfCycle>,
    cycle_energy: Option<f64>,
    rising: bool,
    highest_s: f64,
}

/// An engine that steps a row.
pub(super) trait Stepper {
    fn course(&self) -> &Course;
    fn course_mut(&mut self) -> &mut Course;
    /// One step, at most to the given time.
    fn step(&mut self, until: f64, recorder: &mut impl Recorder) -> Result<(), FreeHingeError>;
    /// Hands the present state to the recorder.
    fn sample(&mut self, recorder: &mut impl Recorder) -> Result<(), FreeHingeError>;
    /// Since when it stands still for good, once the ground does.
    fn rests_since(&self) -> Option<f64>;
    /// When the row passed its last way back, once it has overturned.
    fn overturned_s(&self) -> Option<f64> {
        let course = self.course();
        (course.potential < course.fallen).then_some(course.highest_s)
    }
    /// Horizontal displacement of the centre of gravity times the mass, without what the row slid along the ground.
    fn sway(&self) -> f64;
    /// Completes the run with what belongs to the engine.
    fn finish(self) -> Run;
}

/// Steps a row until it rests, has overturned, or the time is over.
pub(super) fn run(
    mut engine: impl Stepper,
    ground: &GroundMotion,
    settings: &Settings,
    recorder: &mut impl Recorder,
) -> Result<Run, FreeHingeError> {
    let mut samples = 0_u32;
    let mut sampled_s = None;
    let quiet_s = ground.end_s();
    let samples_are_made = settings.output_step_s.is_some() && recorder.wants_samples();
    let mut longest_step = samples_are_made.then_some(Duration::ZERO);
    loop {
        let mark = settings
            .output_step_s
            .map_or(f64::INFINITY, |step| f64::from(samples) * step);
        let course = engine.course();
        let time = course.time;
        if time >= mark - 1e-9 * settings.shortest_step_s {
            samples += 1;
            if samples_are_made {
                engine.sample(recorder)?;
                sampled_s = Some(time);
            }
            continue;
        }
        let outcome = if course.stopped {
            Some(Outcome::Rocking)
        } else if let Some(time_s) = engine.overturned_s() {
            let sway = towards(engine.sway());
            Some(Outcome::Overturned { sway, time_s })
        } else if time >= quiet_s
            && let Some(time_s) = engine.rests_since()
        {
            Some(if course.moved {
                Outcome::Rest { time_s }
            } else {
                Outcome::NeverMoved
            })
        } else if time >= settings.end_s {
            Some(Outcome::Rocking)
        } else {
            None
        };
        if let Some(outcome) = outcome {
            engine.course_mut().run.outcome = outcome;
            break;
        }
        let begun = longest_step.map(|_| Instant::now());
        engine.step(mark.min(settings.end_s), recorder)?;
        longest_step = longest_step.max(begun.map(|begun| begun.elapsed()));
    }
    let course = engine.course();
    let unsampled = samples_are_made && sampled_s != Some(course.time);
    if unsampled && !course.stopped {
        engine.sample(recorder)?;
    }
    let course = engine.course_mut();
    course.end_cycle(None);
    course.run.end_s = course.time;
    course.run.longest_step_s = settings.longest_step_s;
    course.run.shortest_step_s = settings.shortest_step_s;
    course.run.cost.longest_step = Elapsed(longest_step);
    Ok(engine.finish())
}

/// The side of what is positive to the right.
fn towards(value: f64) -> Sway {
    if value > 0.0 { Sway::Right } else { Sway::Left }
}

/// The side to which a row that moves sways, by the displacement of its centre of gravity; where that is none the one to which
/// it goes, by its momentum to the right.
pub(super) fn heading(sway: f64, momentum: f64) -> Sway {
    towards(if sway == 0.0 { momentum } else { sway })
}

/// Length of the next step of a leapfrog: equal steps up to the given time.
pub(super) fn equal_step(time: f64, until: f64, longest: f64) -> f64 {
    let left = until - time;
    left / (left / longest - 1e-9).ceil().max(1.0)
}

impl Course {
    /// Below the potential energy `fallen` the row has overturned; `None` where the engine tells by other signs.
    pub(super) fn new(row: &Row, gravity: f64, fallen: Option<f64>) -> Self {
        Self {
            time: 0.0,
            potential: 0.0,
            moved: false,
            stopped: false,
            energy_unit: row.mass_kg() * gravity * row.size_m(),
            gravity,
            fallen: fallen.unwrap_or(f64::NEG_INFINITY),
            cycle: None,
            cycle_energy: None,
            rising: false,
            highest_s: 0.0,
            run: Run {
                outcome: Outcome::Rocking,
                end_s: 0.0,
                longest_step_s: 0.0,
                shortest_step_s: 0.0,
                peaks_rad: vec![0.0; row.blocks().len()],
                peak_potential_j: 0.0,
                largest_kinetic_j: 0.0,
                half_cycles: Vec::new(),
                least_normal_n: f64::INFINITY,
                friction_demand: 0.0,
                energy_taken_j: 0.0,
                energy_defect_ratio: 0.0,
                closure_error_m: 0.0,
                sliding: None,
                cost: Cost::default(),
            },
        }
    }

    /// The row is released at rest, with these rotations and this potential energy.
    pub(super) fn released(
        &mut self,
        rotations_rad: impl Iterator<Item = f64>,
        potential: f64,
        moved: bool,
    ) {
        self.note_peaks(rotations_rad);
        self.potential = potential;
        self.run.peak_potential_j = potential.max(0.0);
        self.moved = moved;
        self.rising = true;
    }

    /// Peaks, half cycles and energy after a step, from the rotations of the blocks, the potential and kinetic energy, and the
    /// displacement of the centre of gravity times the mass.
    pub(super) fn observe(
        &mut self,
        rotations_rad: impl Iterator<Item = f64>,
        potential: f64,
        kinetic: f64,
        sway: f64,
    ) {
        let largest = self.note_peaks(rotations_rad);
        if potential >= self.potential {
            self.rising = true;
        } else if self.rising {
            self.rising = false;
            self.highest_s = self.time;
        }
        self.potential = potential;
        self.run.peak_potential_j = self.run.peak_potential_j.max(potential);
        self.run.largest_kinetic_j = self.run.largest_kinetic_j.max(kinetic);
        let least = SWAY_RATIO * self.energy_unit / self.gravity;
        if sway.abs() > least {
            let side = towards(sway);
            if self.cycle.is_none_or(|cycle| cycle.sway != side) {
                self.end_cycle(Some(kinetic + potential));
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

    /// Raises the peaks to the rotations of the blocks now; returns the largest of these.
    fn note_peaks(&mut self, rotations_rad: impl Iterator<Item = f64>) -> f64 {
        let mut largest = 0.0_f64;
        for (peak, rotation_rad) in self.run.peaks_rad.iter_mut().zip(rotations_rad) {
            let rotation = rotation_rad.abs();
            *peak = peak.max(rotation);
            largest = largest.max(rotation);
        }
        largest
    }

    /// Files the half cycle that ends now, with the energy that is left if it is known.
    fn end_cycle(&mut self, energy: Option<f64>) {
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
}
