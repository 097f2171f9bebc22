//! Observation of a motion, common to all steppers of a row: reports, peaks, half cycles, energy balance and outcome.

use std::mem;

use super::events::EventLog;
use super::last_maximum::LastMaximum;
use crate::dynamics::history::{ElasticSummary, RowSummary, Stress, TieSummary};
use crate::dynamics::recorder::Recorder;
use crate::dynamics::request::later_end_s;
use crate::dynamics::thrust::{FrictionDemands, Until};
use crate::dynamics::until::SAFE;
use crate::dynamics::{
    Cost, Details, Event, EventKind, HalfCycle, MotionInput, Outcome, RowMotionError, Sample,
    State, Summary, ThrustRecord,
};
use crate::mechanics::chain::LEAST_LOAD;
use crate::mechanics::{Hinge, Lanes, Sway, Tie, TieMemory};

/// Sway, over the size, below which the side of the motion does not change.
pub const SWAY_RATIO: f64 = 1e-9;
/// Duration, over the square root of size over gravity, in which the largest kinetic energy counts if no barrier is known. It is longer than the time
/// between turning points.
const RECENT_RATIO: f64 = 2.0;
/// Potential energy, over the largest one of a half cycle, above which the blocks have not turned back when the centre of gravity changes its side.
const TURNED_BACK: f64 = 0.5;
/// Kinetic energy, over weight times size, below which a row may be at rest.
pub const REST_ENERGY_RATIO: f64 = 1e-9;
/// Duration of small kinetic energy, over the square root of size over gravity, after which a row is at rest. It is longer than a turning point.
const REST_TIME_RATIO: f64 = 0.5;
/// Rotation of a block, in radians, at which the row has overturned.
pub const OVERTURNED_RAD: f64 = 0.8;
/// Displacement of a block, over the size, at which the row has overturned; without the slip of the row along a support.
pub const OVERTURNED_RATIO: f64 = 0.6;
/// Rise in a fall, over weight times size, above which the row has returned.
const LEAST_RETURN: f64 = 1e-3;
/// Error of the energy balance, over the largest energy of the motion, above which the computation fails.
pub const LARGEST_ENERGY_ERROR: f64 = 1e-2;
/// Least energy, over weight times size, that counts as motion; the balance of smaller energies is a rounding error.
const LEAST_ENERGY_RATIO: f64 = 1e-6;
/// Energy dissipated by friction, over the barrier of the first mechanism, above which a row counts as slipped. The row is then lower than before,
/// and its potential energy is not comparable with the barrier.
const SLIPPED_RATIO: f64 = 0.01;

/// Energy errors, over the largest allowed one, at which default steps are halved. The error then grows at least two times slower, four times with
/// elastic joints.
const HALVED_FROM: [f64; 4] = [0.6, 0.75, 0.85, 0.92];

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
    cycle: Option<HalfCycle>,
    /// Largest potential energy of the current half cycle, in J.
    cycle_highest_j: f64,
    cycle_energy: Option<f64>,
    rising: bool,
    highest_s: f64,
    pub(super) recorder: Option<&'a mut dyn Recorder>,
    /// Largest kinetic energies in the last two periods, the earlier one first, and the start of the later one.
    recent_j: [f64; 2],
    recent_from_s: f64,
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

/// Results up to a time.
#[derive(Clone, Default)]
struct PartialResults {
    time_s: f64,
    peak_rotations_rad: Vec<f64>,
    /// Number of completed half cycles, and the current one.
    half_cycles: usize,
    cycle: Option<HalfCycle>,
    thrust: ThrustRecord,
    friction: Until,
    largest_slips_m: Vec<f64>,
    largest_stress: Stress,
    ties: Vec<TieSummary>,
}

/// Returns right for a positive value, left for any other.
pub(super) fn side_of(value: f64) -> Sway {
    if value > 0.0 { Sway::Right } else { Sway::Left }
}

impl<'a> MotionObserver<'a> {
    /// Returns the record of a motion that begins. `overturned_below_j` is the potential energy in J below which the row has overturned; `None` if
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
            before_fall: PartialResults {
                time_s: start_s,
                peak_rotations_rad: vec![0.0; row.blocks.len()],
                ..PartialResults::default()
            },
            cycle: None,
            cycle_highest_j: 0.0,
            cycle_energy: None,
            rising: false,
            highest_s: start_s,
            recorder,
            recent_j: [0.0; 2],
            recent_from_s: start_s,
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

    /// Returns the outcome of the motion and its time; `None` if the motion continues. `overturned_s` is the time of overturning, `at_rest_since_s` the
    /// time since which the row rests.
    pub fn ending(
        &self,
        overturned_s: Option<f64>,
        at_rest_since_s: impl FnOnce() -> Option<f64>,
    ) -> Option<(Outcome, f64)> {
        let closed = self.outcome_with_closed_joints();
        let moving = match self.counts_as_rest {
            true => Outcome::Rest,
            false => Outcome::StillRocking,
        };
        let still = (closed.unwrap_or(moving), self.time);
        if self.stopped || self.is_safe {
            return Some(still);
        }
        if let Some(time_s) = overturned_s {
            return Some((Outcome::Overturned(side_of(self.sway)), time_s));
        }
        if self.time >= self.input.ground.end_s()
            && let Some(time_s) = at_rest_since_s()
        {
            let time_s = time_s.max(self.events.last_impact_s.unwrap_or(time_s));
            let rest = (Outcome::Rest, time_s);
            return Some(closed.map_or(rest, |closed| (closed, self.time)));
        }
        (self.time >= self.input.settings.end_s).then_some(still)
    }

    /// Lengthens a motion that would end with this outcome, if it is incomplete. Returns its new end in seconds, `None` if it ends.
    pub fn lengthened_s(&mut self, outcome: Outcome) -> Option<f64> {
        let settings = &self.input.settings;
        let is_known = self.stopped
            || self.is_safe
            || matches!(outcome, Outcome::Overturned(_) | Outcome::Rest);
        if is_known || !self.is_incomplete() {
            return None;
        }
        let end_s = later_end_s(settings.outcome_by_s, self.input.ground, settings.end_s)?;
        self.input.settings.end_s = end_s;
        Some(end_s)
    }

    /// Returns the outcome while no joint has opened or slipped; `None` afterwards.
    fn outcome_with_closed_joints(&self) -> Option<Outcome> {
        let least_j = REST_ENERGY_RATIO * self.energy_unit;
        match self.has_rocked {
            None => (!self.moved).then_some(Outcome::NeverMoved),
            Some(true) => None,
            Some(false) if self.row_summary.largest_kinetic_j < least_j => {
                Some(Outcome::NeverMoved)
            }
            Some(false) => Some(Outcome::Vibrates),
        }
    }

    /// Returns whether the history ends too early to decide the outcome; see [`Outcome`].
    fn is_incomplete(&self) -> bool {
        if self.is_safe || self.elastic.vibrates_since_s.is_some() {
            return false;
        }
        let lies = |barrier_j: &f64| self.elastic.crushed_j <= SLIPPED_RATIO * barrier_j;
        let energy_ratio = match self.known_barrier_j().filter(lies) {
            Some(barrier_j) => (self.kinetic + self.potential) / barrier_j,
            None => self.recent_j[0].max(self.recent_j[1]) / self.input.undeformed_barrier_j,
        };
        self.time < self.input.ground.end_s() || energy_ratio > SAFE
    }

    /// Returns the energy barrier, in J; `None` if unknown, or if the row has slipped so much that its potential energy is not comparable.
    fn known_barrier_j(&self) -> Option<f64> {
        let sliding = self.row_summary.sliding.as_ref();
        let rubbed_j = sliding.map_or(0.0, |sliding| sliding.friction_j);
        let known = |barrier_j: &f64| rubbed_j <= SLIPPED_RATIO * barrier_j;
        self.input.barrier_j.filter(known)
    }

    /// Returns the duration of small kinetic energy after which the row is at rest, in seconds.
    pub fn rest_time_s(&self) -> f64 {
        REST_TIME_RATIO * (self.input.row.size_m / self.input.gravity_m_s2).sqrt()
    }

    /// Returns the least normal force of a joint that counts in the friction demand, in N.
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
        *least_n = least_n.min(least / lasts_s);
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
        (self.friction).note(demand, [self.time, lasts_s], moves);
    }

    /// Returns whether there is a recorder that needs friction demands.
    pub fn wants_demand(&self) -> bool {
        let recorder = self.recorder.as_ref();
        recorder.is_some_and(|recorder| recorder.wants_demand())
    }

    /// Returns whether a row with small kinetic energy since `since_s` is at rest.
    pub(crate) fn is_quiet(&self, since_s: f64) -> bool {
        self.time - since_s > self.rest_time_s()
    }

    /// Returns the last time at which the row could still return, if the stepper has found that it has overturned.
    pub fn overturned_s(&self) -> Option<f64> {
        self.overturned.then_some(self.last_maximum.time)
    }

    /// Returns the last time at which the row could still return, if its potential energy shows that it has overturned.
    pub fn fallen_s(&self, potential: f64) -> Option<f64> {
        (potential < self.overturned_below_j).then_some(self.highest_s)
    }

    /// Returns whether there is a recorder.
    pub const fn has_recorder(&self) -> bool {
        self.recorder.is_some()
    }

    /// Returns whether there is a recorder that needs events.
    pub fn reports_events(&self) -> bool {
        let recorder = self.recorder.as_ref();
        recorder.is_some_and(|recorder| recorder.wants_events())
    }

    /// Records a release, with rotations of the blocks, potential and kinetic energy, and displacement of the centre of gravity times the mass.
    pub fn released(
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
        let recent_s = RECENT_RATIO * (self.input.row.size_m / self.input.gravity_m_s2).sqrt();
        if self.time - self.recent_from_s > recent_s {
            self.recent_from_s = self.time;
            self.recent_j = [self.recent_j[1], 0.0];
        }
        self.recent_j[1] = self.recent_j[1].max(kinetic);
        if sway.abs() > self.least_sway_kg_m {
            let side = side_of(sway);
            if self.cycle.is_none_or(|cycle| cycle.sway != side) {
                let feet_part = self.input.ground.right_foot_of(self.input.row).is_some();
                let is_high = potential > TURNED_BACK * self.cycle_highest_j;
                let continues = self.cycle.is_some() && is_high && !feet_part;
                self.end_cycle(Some(kinetic + potential));
                self.cycle_highest_j = potential;
                self.cycle = Some(HalfCycle {
                    sway: side,
                    start_s: self.time,
                    peak_time_s: self.time,
                    continues,
                    ..HalfCycle::default()
                });
            }
        }
        if let Some(cycle) = &mut self.cycle
            && largest > cycle.peak_rad
        {
            (cycle.peak_rad, cycle.peak_time_s) = (largest, self.time);
        }
        self.cycle_highest_j = self.cycle_highest_j.max(potential);
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
            let begins = self.cycle.is_some_and(|cycle| cycle.start_s == self.time);
            last_maximum.note((height, self.time), least, begins && height >= -least);
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
                let kinds = known.note(tie, &memory, self.time).into_iter().flatten();
                happened.extend(kinds.map(|kind| (index, kind)));
            } else {
                let at_rest = TieSummary::at_rest(tie, &memory, self.time);
                self.row_summary.ties.push(at_rest);
            }
        }
        happened
    }

    /// Records the results at this time, at which the row can still return.
    pub fn save_results_before_fall(&mut self) {
        let before_fall = &mut self.before_fall;
        before_fall.time_s = self.time;
        let peaks_rad = &self.peak_rotations_rad;
        before_fall.peak_rotations_rad.clone_from(peaks_rad);
        before_fall.half_cycles = self.row_summary.half_cycles.len();
        before_fall.cycle = self.cycle;
        before_fall.thrust = self.thrust;
        before_fall.friction = self.friction.until_now();
        before_fall.largest_stress = self.elastic.largest_stress;
        if let Some(sliding) = &self.row_summary.sliding {
            let slips_m = &sliding.largest_offsets_m;
            before_fall.largest_slips_m.clone_from(slips_m);
        }
        before_fall.ties.clone_from(&self.row_summary.ties);
        self.settle(self.time);
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

    /// Returns whether the row can still return at this time.
    pub fn returns(&self) -> bool {
        self.before_fall.time_s == self.time
    }

    /// Resets the results to those at the last time at which the row could still return.
    fn restore_results(&mut self, before_fall: PartialResults) {
        self.peak_rotations_rad = before_fall.peak_rotations_rad;
        self.row_summary
            .half_cycles
            .truncate(before_fall.half_cycles);
        self.cycle = None;
        if let Some(mut cycle) = before_fall.cycle {
            cycle.duration_s = before_fall.time_s - cycle.start_s;
            self.row_summary.half_cycles.push(cycle);
        }
        self.thrust = before_fall.thrust;
        self.elastic.largest_stress = before_fall.largest_stress;
        if let Some(sliding) = &mut self.row_summary.sliding {
            sliding.largest_offsets_m = before_fall.largest_slips_m;
        }
        for (tie, before) in self.row_summary.ties.iter_mut().zip(before_fall.ties) {
            *tie = before;
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

    /// Returns the largest rotation of a block up to now, in radians.
    pub fn largest_rotation_rad(&self) -> f64 {
        self.peak_rotations_rad.iter().copied().fold(0.0, f64::max)
    }

    /// Completes the current half cycle, with the remaining energy if known.
    fn end_cycle(&mut self, energy: Option<f64>) {
        if let Some(mut cycle) = self.cycle.take() {
            cycle.duration_s = self.time - cycle.start_s;
            let energies = energy.zip(self.cycle_energy);
            let ratio = energies.map(|(after, before)| after / before);
            cycle.energy_ratio = ratio.filter(|ratio| ratio.is_finite());
            self.friction.end_half_cycle(cycle.peak_rad);
            self.row_summary.half_cycles.push(cycle);
            self.cycle_energy = energy;
        }
    }

    /// Records an error of the energy, in J.
    pub fn note_defect(&mut self, energy: f64) {
        let worst = &mut self.energy_defect_ratio;
        *worst = worst.max(energy / self.energy_unit);
    }

    /// Returns the largest error of the energy balance up to now, over the largest energy of the motion or `barrier_j`, whichever is larger.
    pub fn energy_error(&self, barrier_j: f64) -> f64 {
        let kinetic_j = self.row_summary.largest_kinetic_j;
        let least_j = LEAST_ENERGY_RATIO * self.energy_unit;
        let defect_j = self.energy_defect_ratio * self.energy_unit;
        defect_j / kinetic_j.max(barrier_j).max(least_j)
    }

    /// Halves the steps a few times at most, if the error of the energy balance is too large relative to `scale_j` and to another energy, which takes
    /// longer to compute.
    pub fn halve_unbalanced_steps(&mut self, scale_j: f64, other_scale_j: impl FnOnce() -> f64) {
        let part = HALVED_FROM.get(self.row_summary.halvings as usize);
        let most = part.unwrap_or(&f64::INFINITY) * LARGEST_ENERGY_ERROR;
        if self.input.settings.may_halve
            && self.energy_error(scale_j) > most
            && self.energy_error(other_scale_j()) > most
        {
            self.longest_step_s *= 0.5;
            self.row_summary.halvings += 1;
            let shortest_s = &mut self.row_summary.shortest_step_s;
            *shortest_s = shortest_s.min(self.longest_step_s);
        }
    }

    /// Ends the motion early: the row cannot overturn. `rests` is true if it is predicted to come to rest.
    pub const fn decide(&mut self, rests: bool) {
        self.is_safe = true;
        self.counts_as_rest = rests;
    }

    /// Returns a sample without data of blocks and joints, and whether the recorder needs the thrust line.
    pub(super) fn blank_sample(&mut self) -> (Sample, bool) {
        let mut sample = mem::take(&mut self.sample);
        let ground = self.input.ground;
        let (ground_m_s2, _) = ground.pieces[ground.piece_at(self.time)].at(self.time);
        sample.begin(self.time, ground_m_s2, self.events.phase);
        let recorder = self.recorder.as_ref();
        let thrust_line = recorder.is_some_and(|recorder| recorder.wants_thrust_line());
        (sample, thrust_line)
    }

    /// Sends a complete sample to the recorder.
    pub(super) fn record(&mut self, sample: Sample, kinetic: f64) {
        self.sample = sample;
        let sample = &mut self.sample;
        sample.energy_j = kinetic + self.potential;
        // A row that has slipped may rest lower than before.
        let slips = self.row_summary.sliding.is_some();
        let rest_j = if slips { self.least_potential_j } else { 0.0 };
        let ratio = |barrier_j| (sample.energy_j - rest_j) / barrier_j;
        sample.energy_ratio = self.input.barrier_j.map(ratio);
        if self.is_falling {
            if let Some(recorder) = &mut self.recorder {
                self.stopped = recorder.fall(sample).is_break();
            }
            return;
        }
        let moves = sample.state != State::Rest;
        self.thrust.note(sample.time_s, moves, &sample.demand);
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

    /// Subtracts energy that an impact at this time dissipated in the step after it, in J, from the energy of the half cycle that began with the
    /// impact.
    pub fn subtract_late_dissipation(&mut self, taken_j: f64) {
        if self.cycle.is_none_or(|cycle| cycle.start_s != self.time) {
            return;
        }
        let Some(energy) = &mut self.cycle_energy else {
            return;
        };
        let before = mem::replace(energy, *energy - taken_j);
        let ended = self.row_summary.half_cycles.last_mut();
        if let Some(ratio) = ended.and_then(|cycle| cycle.energy_ratio.as_mut()) {
            *ratio *= *energy / before;
        }
    }

    /// Returns the summary, and reports the end if the row rests or has overturned.
    pub fn end(&mut self, outcome: Outcome, outcome_time_s: f64) -> Summary {
        self.row_summary.half_cycles_with_fall =
            self.row_summary.half_cycles.len() + usize::from(self.cycle.is_some());
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
        let potential_j = self.row_summary.largest_potential_j;
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

/// Returns the summary if its energy balances.
///
/// # Errors
/// If the energy balance is wrong. The error names the model's table and proposes a step, in seconds.
pub fn balanced(
    summary: Summary,
    table: &'static str,
    longest_step_s: f64,
) -> Result<Summary, RowMotionError> {
    let error = summary.row().map_or(0.0, |row| row.energy_error);
    if error > LARGEST_ENERGY_ERROR {
        return Err(RowMotionError::Energy {
            error,
            table,
            longest_step_s,
        });
    }
    Ok(summary)
}
