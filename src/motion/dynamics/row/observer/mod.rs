//! Observation of a motion, common to all steppers of a row: samples, events, peaks and forces; `half_cycles`, the energy `balance`, the results
//! `before_fall` and the `outcome`.

mod balance;
mod before_fall;
mod half_cycles;
mod outcome;

use std::mem;

pub use self::balance::{LARGEST_ENERGY_ERROR, require_balance};
use self::before_fall::PartialResults;
use self::half_cycles::CurrentHalfCycle;
use self::outcome::RecentEnergy;
use super::events::EventLog;
use super::last_maximum::LastMaximum;
use crate::dynamics::history::{ElasticSummary, RowSummary, TieSummary};
use crate::dynamics::recorder::Recorder;
use crate::dynamics::thrust::FrictionDemands;
use crate::dynamics::{
    Cost, Details, Event, EventKind, MotionInput, Outcome, Sample, State, Summary, ThrustRecord,
};
use crate::mechanics::chain::LEAST_LOAD;
use crate::mechanics::{Hinge, Lanes, Sway, Tie, TieMemory};

/// Sway, over the size, below which the side of the motion does not change.
pub const SWAY_RATIO: f64 = 1e-9;
/// Kinetic energy, over weight times size, below which a row may be at rest.
pub const REST_ENERGY_RATIO: f64 = 1e-9;
/// Rotation of a block, in radians, at which the row has overturned.
pub const OVERTURNED_RAD: f64 = 0.8;
/// Displacement of a block, over the size, at which the row has overturned; without the slip of the row along a support.
pub const OVERTURNED_RATIO: f64 = 0.6;
/// Rise in a fall, over weight times size, above which the row has returned.
const LEAST_RETURN: f64 = 1e-3;

/// Record of a motion up to the current time, and its evaluation.
pub struct MotionObserver<'a> {
    pub time: f64,
    /// Potential energy above the undeformed row, in J.
    pub potential: f64,
    /// Kinetic energy after the last step, in J.
    pub(super) kinetic: f64,
    /// Horizontal displacement of the centre of gravity times the mass, without the slip of the row along the ground, in kg m.
    pub sway: f64,
    /// True once a joint has opened or slipped; for elastic joints, once the row has moved with more energy than at rest.
    pub moved: bool,
    /// For elastic joints: true once a joint has opened beyond its state at rest, or slipped. `None` for rigid joints.
    pub has_rocked: Option<bool>,
    /// Sway times mass, in kg m, below which the side of the motion does not change.
    pub least_sway_kg_m: f64,
    /// Weight times size, in J.
    pub energy_unit: f64,
    /// Joints that close in a step, also if they open again immediately, with the edge that landed; `None` for both edges.
    pub shut: Vec<Hinge>,
    /// Joints that open in a step, with the edge about which they turn; `None` for parted joints.
    pub opened: Vec<Hinge>,
    pub events: EventLog,
    /// Least potential energy up to now, in J.
    least_potential_j: f64,
    pub cost: Cost,
    peak_rotations_rad: Vec<f64>,
    energy_defect_ratio: f64,
    pub row_summary: RowSummary,
    /// Results for elastic joints.
    pub elastic: ElasticSummary,
    /// Longest step from now on, in seconds.
    pub longest_step_s: f64,
    pub input: MotionInput<'a>,
    /// Last maximum of the height before the final descent, from the heights that the stepper reports.
    pub last_maximum: LastMaximum,
    /// True once the stepper has found that the row has overturned.
    pub overturned: bool,
    /// Time since which the kinetic energy is small, in seconds.
    pub quiet_since_s: f64,
    /// Potential energy below which the row has overturned, in J; minus infinity if the stepper uses other criteria.
    overturned_below_j: f64,
    /// Results up to the last time from which the row may have fallen without return.
    before_fall: PartialResults,
    cycle: CurrentHalfCycle,
    rising: bool,
    highest_s: f64,
    pub(super) recorder: Option<&'a mut dyn Recorder>,
    recent: RecentEnergy,
    /// True once the row certainly cannot overturn and its motion is ended early.
    is_safe: bool,
    /// True if a motion that is ended early counts as come to rest.
    counts_as_rest: bool,
    /// True once the recorder has stopped the history.
    pub(super) stopped: bool,
    /// True once the history is complete and the fall is computed.
    pub(super) is_falling: bool,
    /// Sample, reused to avoid allocations.
    pub(super) sample: Sample,
    thrust: ThrustRecord,
    friction: FrictionDemands,
}

/// Right for a positive value, left for any other.
pub(super) fn side_of(value: f64) -> Sway {
    if value > 0.0 { Sway::Right } else { Sway::Left }
}

impl<'a> MotionObserver<'a> {
    /// Record of a motion that begins. `overturned_below_j` is the potential energy in J below which the row has overturned; `None` if
    /// the stepper uses other criteria.
    pub fn new(
        input: MotionInput<'a>,
        overturned_below_j: Option<f64>,
        recorder: Option<&'a mut dyn Recorder>,
    ) -> Self {
        let MotionInput { row, settings, .. } = input;
        let energy_unit = row.mass_kg() * input.gravity_m_s2 * row.size_m;
        let start_s = input.ground.start_s();
        Self {
            time: start_s,
            potential: 0.0,
            kinetic: 0.0,
            sway: 0.0,
            moved: false,
            has_rocked: None,
            least_sway_kg_m: SWAY_RATIO * energy_unit / input.gravity_m_s2,
            energy_unit,
            shut: Vec::new(),
            opened: Vec::new(),
            longest_step_s: settings.longest_step_s,
            input,
            last_maximum: LastMaximum::new(0.0, start_s),
            overturned: false,
            quiet_since_s: start_s,
            overturned_below_j: overturned_below_j.unwrap_or(f64::NEG_INFINITY),
            before_fall: PartialResults::at_start(start_s, row.blocks.len()),
            cycle: CurrentHalfCycle::default(),
            rising: false,
            highest_s: start_s,
            recorder,
            recent: RecentEnergy::new(start_s),
            is_safe: false,
            counts_as_rest: false,
            stopped: false,
            is_falling: false,
            sample: Sample::default(),
            thrust: ThrustRecord::default(),
            friction: FrictionDemands::default(),
            events: EventLog::default(),
            least_potential_j: 0.0,
            peak_rotations_rad: vec![0.0; row.blocks.len()],
            energy_defect_ratio: 0.0,
            cost: Cost::default(),
            row_summary: RowSummary {
                least_normal_n: f64::INFINITY,
                longest_step_s: settings.longest_step_s,
                shortest_step_s: settings.shortest_step_s,
                ..RowSummary::default()
            },
            elastic: ElasticSummary::default(),
        }
    }

    /// Least normal force of a joint that counts in the friction demand, in N.
    pub fn least_load_n(&self) -> f64 {
        LEAST_LOAD * self.energy_unit / self.input.row.size_m
    }

    /// Records the least normal force at a joint, from tangential and normal impulses during `lasts_s`. Returns the friction demand.
    pub fn note_forces(&mut self, impulses: impl Iterator<Item = [f64; 2]>, lasts_s: f64) -> f64 {
        let loaded = self.least_load_n() * lasts_s;
        let (mut least, mut friction) = (f64::INFINITY, 0.0_f64);
        for [tangential, normal] in impulses {
            least = least.min(normal);
            if normal >= loaded {
                friction = friction.max(tangential.abs() / normal);
            }
        }
        let least_n = &mut self.row_summary.least_normal_n;
        // Which of 0 and -0 is the smaller one depends on the machine. Adding zero gives 0.
        *least_n = least_n.min(least / lasts_s) + 0.0;
        self.note_friction(friction, lasts_s);
        friction
    }

    /// Records the friction demand of a step that lasts so many seconds. If joints slip or are elastic, it is not needed without a recorder.
    pub fn note_friction(&mut self, demand: f64, lasts_s: f64) {
        let is_free_of_slip = self.has_rocked.is_none() && self.row_summary.sliding.is_none();
        if self.is_falling || !(is_free_of_slip || self.wants_demand()) {
            return;
        }
        let moves = self.quiet_since_s == self.time;
        (self.friction).add_step(demand, [self.time, lasts_s], moves);
    }

    /// Whether there is a recorder that needs friction demands.
    pub fn wants_demand(&self) -> bool {
        let recorder = self.recorder.as_ref();
        recorder.is_some_and(|recorder| recorder.wants_demand())
    }

    /// Whether there is a recorder.
    pub const fn has_recorder(&self) -> bool {
        self.recorder.is_some()
    }

    /// Whether there is a recorder that needs events.
    pub fn reports_events(&self) -> bool {
        let recorder = self.recorder.as_ref();
        recorder.is_some_and(|recorder| recorder.wants_events())
    }

    /// Records a release, with rotations of the blocks, potential and kinetic energy, and displacement of the centre of gravity times the mass.
    pub fn record_release(
        &mut self,
        rotations_rad: impl Iterator<Item = f64>,
        [potential, kinetic]: [f64; 2],
        sway: f64,
        moved: bool,
    ) {
        self.note_peaks(rotations_rad);
        self.potential = potential;
        self.kinetic = kinetic;
        self.row_summary.largest_kinetic_j = kinetic;
        self.sway = sway;
        self.row_summary.largest_potential_j = potential.max(0.0);
        self.moved = moved;
        self.rising = true;
        self.save_results_before_fall();
    }

    /// Updates peaks, half cycles and energies after a step, from the rotations of the blocks, the potential and kinetic energy, and the displacement
    /// of the centre of gravity times the mass.
    pub fn observe(
        &mut self,
        rotations_rad: impl Iterator<Item = f64>,
        potential: f64,
        kinetic: f64,
        sway: f64,
    ) {
        let largest = self.note_peaks(rotations_rad);
        if potential > self.potential {
            self.rising = true;
        } else if self.rising {
            self.rising = false;
            self.highest_s = self.time;
        }
        self.potential = potential;
        self.least_potential_j = self.least_potential_j.min(potential);
        self.kinetic = kinetic;
        if kinetic >= REST_ENERGY_RATIO * self.energy_unit {
            self.quiet_since_s = self.time;
        }
        self.sway = sway;
        let row_summary = &mut self.row_summary;
        row_summary.largest_potential_j = row_summary.largest_potential_j.max(potential);
        row_summary.largest_kinetic_j = row_summary.largest_kinetic_j.max(kinetic);
        let period_s = (self.input.row.size_m / self.input.gravity_m_s2).sqrt();
        self.recent.record_energy(kinetic, self.time, period_s);
        self.note_half_cycle(largest);
        if self.highest_s == self.time && self.overturned_below_j > f64::NEG_INFINITY {
            self.save_results_before_fall();
        }
    }

    /// Records the height of the row after a step, and the results while the row has not begun its final descent. A rise above the lowest point
    /// counts as a return, and so does a half cycle to the other side, which may have a lower maximum. `None` if the feet move apart: the feet do
    /// work, so heights do not decide whether the row returns. The row has then not begun to fall while its kinetic energy is small.
    pub fn note_height(&mut self, height: Option<f64>) {
        let (least, last_maximum) = (LEAST_RETURN * self.energy_unit, &mut self.last_maximum);
        if let Some(height) = height {
            let begins = self
                .cycle
                .current
                .is_some_and(|cycle| cycle.start_s == self.time);
            last_maximum.record_height((height, self.time), least, begins && height >= -least);
        } else if self.kinetic < least {
            last_maximum.time = self.time;
        }
        if last_maximum.time == self.time {
            self.save_results_before_fall();
        }
    }

    /// Updates the summaries of the ties; the first call has the state at rest. Returns the events of ties since the last call, with their indices.
    pub fn note_ties<'t>(
        &mut self,
        ties: impl Iterator<Item = (&'t Tie, TieMemory<Lanes<1>>)>,
    ) -> Vec<(usize, EventKind)> {
        let mut happened = Vec::new();
        let ties = ties.filter(|(tie, _)| !tie.is_constant_force());
        for (index, (tie, memory)) in ties.enumerate() {
            if let Some(known) = self.row_summary.ties.get_mut(index) {
                let kinds = known
                    .record_state(tie, &memory, self.time)
                    .into_iter()
                    .flatten();
                happened.extend(kinds.map(|kind| (index, kind)));
            } else {
                let at_rest = TieSummary::at_rest(tie, &memory, self.time);
                self.row_summary.ties.push(at_rest);
            }
        }
        happened
    }

    /// Records an impact at this time.
    pub fn note_impact(&mut self) {
        self.events.note_impact(self.time);
    }

    /// Counts the impacts and sends the events up to a time, in seconds.
    fn settle(&mut self, until_s: f64) {
        for event in self.events.settle(until_s) {
            if let Some(recorder) = &mut self.recorder {
                self.stopped |= recorder.event(&event).is_break();
            }
        }
    }

    /// Updates the peak rotations of the blocks, and returns the largest current rotation.
    fn note_peaks(&mut self, rotations_rad: impl Iterator<Item = f64>) -> f64 {
        let mut largest = 0.0_f64;
        let peaks = self.peak_rotations_rad.iter_mut();
        for (peak, rotation_rad) in peaks.zip(rotations_rad) {
            let rotation = rotation_rad.abs();
            *peak = peak.max(rotation);
            largest = largest.max(rotation);
        }
        largest
    }

    /// Largest rotation of a block up to now, in radians.
    pub fn largest_rotation_rad(&self) -> f64 {
        self.peak_rotations_rad.iter().copied().fold(0.0, f64::max)
    }

    /// Sample without data of blocks and joints, and whether the recorder needs the thrust line.
    pub(super) fn blank_sample(&mut self) -> (Sample, bool) {
        let mut sample = mem::take(&mut self.sample);
        let ground = self.input.ground;
        let (ground_m_s2, _) =
            ground.pieces[ground.piece_at(self.time)].acceleration_and_rate(self.time);
        sample.reset_to_rest(self.time, ground_m_s2, self.events.phase);
        let recorder = self.recorder.as_ref();
        let thrust_line = recorder.is_some_and(|recorder| recorder.wants_thrust_line());
        (sample, thrust_line)
    }

    /// Sends a complete sample to the recorder.
    pub(super) fn record(&mut self, sample: Sample, kinetic: f64) {
        let rest_j = self.rest_potential_j();
        self.sample = sample;
        let sample = &mut self.sample;
        sample.energy_j = kinetic + self.potential;
        let ratio = |barrier_j| (sample.energy_j - rest_j) / barrier_j;
        sample.energy_ratio = self.input.barrier_j.map(ratio);
        if self.is_falling {
            if let Some(recorder) = &mut self.recorder {
                self.stopped = recorder.fall_sample(sample).is_break();
            }
            return;
        }
        let moves = sample.state != State::Rest;
        self.thrust.add_sample(sample.time_s, moves, &sample.demand);
        if let Some(recorder) = &mut self.recorder {
            self.stopped |= recorder.sample(sample).is_break();
        }
    }

    /// Records an event that begins a phase. The recorder receives it once it is certain that it does not belong to a fall.
    pub(super) fn report(&mut self, event: &Event) {
        if !self.is_falling {
            self.events.report(event);
        }
    }

    /// Begins the phase of an impact that is reported after the next step, when its energy is known.
    pub fn await_impact(&mut self) {
        if self.reports_events() && !self.is_falling {
            self.events.await_impact();
        }
    }

    /// Returns the summary, and reports the end if the row rests or has overturned.
    pub fn end(&mut self, outcome: Outcome, outcome_time_s: f64) -> Summary {
        self.row_summary.half_cycles_with_fall =
            self.row_summary.half_cycles.len() + usize::from(self.cycle.current.is_some());
        let before_fall = match outcome {
            Outcome::Overturned(_) => {
                let before_fall = mem::take(&mut self.before_fall);
                let friction = before_fall.friction;
                self.restore_results(before_fall);
                Some(friction)
            }
            _ => None,
        };
        self.end_cycle(None);
        let settled_s = match outcome {
            Outcome::Overturned(_) => outcome_time_s,
            _ => f64::INFINITY,
        };
        self.settle(settled_s);
        self.events.drop_late();
        let outcome = match outcome {
            Outcome::Overturned(_) | Outcome::Rest => outcome,
            _ if self.is_incomplete() => Outcome::Incomplete,
            _ => outcome,
        };
        let potential_j = self.row_summary.largest_potential_j - self.rest_potential_j();
        let over = |barrier_j: f64| potential_j / barrier_j;
        self.row_summary.peak_potential_over_barrier = self.known_barrier_j().map(over);
        self.row_summary.energy_error = self.energy_error(self.input.energy_scale_j);
        let row = Box::new(self.row_summary.clone());
        let summary = Summary {
            outcome,
            outcome_time_s,
            end_s: self.time,
            is_cut: self.is_safe,
            impacts: self.events.impacts(),
            peak_rotations_rad: self.peak_rotations_rad.clone(),
            energy_defect_ratio: self.energy_defect_ratio,
            thrust: self.recorder.is_some().then_some(self.thrust),
            friction: self.friction.record(before_fall),
            cost: self.cost,
            details: match self.has_rocked {
                None => Details::Rigid(row),
                Some(_) => Details::Elastic(row, self.elastic),
            },
        };
        let (kind, state, at) = match outcome {
            Outcome::Rest => (EventKind::Rest, State::Rest, None),
            Outcome::Overturned(sway) => {
                let at = self.events.last_return.take();
                (EventKind::Overturned, State::Overturned(sway), at)
            }
            _ => return summary,
        };
        if let Some(recorder) = &mut self.recorder {
            let ending = Event {
                time_s: outcome_time_s,
                kind,
                state,
                ..at.unwrap_or_else(|| Event::of_sample(&self.sample))
            };
            // The history ends here in any case.
            let _ = recorder.event(&ending);
        }
        summary
    }
}
