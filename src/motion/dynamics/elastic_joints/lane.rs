//! One motion of a group, and when it ends.

use nalgebra::Vector2;

use super::motion::{ElasticMotion, ElasticStep, SlidingSupport};
use super::stillness::Stillness;
use crate::dynamics::ground::FeetApart;
use crate::dynamics::recorder::Recorder;
use crate::dynamics::repeatability::LARGEST_LOSS_RATIO;
use crate::dynamics::row::clock::Marks;
use crate::dynamics::row::observer::REST_ENERGY_RATIO;
use crate::dynamics::row::stepper::equal_step;
use crate::dynamics::until::{EndCondition, comparable_slip_m};
use crate::dynamics::{
    EventKind, GroundVelocity, MotionInput, MotionObserver, RowMotionError, Sliding,
};
use crate::mechanics::Lanes;

/// Number of steps between observations of a motion: one to four periods of the fastest vibration. The structure rocks much more slowly.
const STRIDE: u64 = 16;
/// Energy, over the barrier, below which a row on quiet ground cannot overturn.
const SAFE: f64 = 0.5;
/// Energy, over the largest one up to now, below which no block exceeds its largest rotation.
const DECAYED: f64 = 0.25;
/// Factor by which energy is assumed to decay more slowly than up to now.
const SLOWER: f64 = 4.0;
/// Longest observation of a row that cannot overturn, to predict whether it comes to rest, over the duration of small energy at rest.
const OBSERVED_RESTS: f64 = 8.0;
/// Duration of vibration alone after which a motion is calm, over the duration of small energy at rest. A row that comes to rest soon has then done
/// so.
const CALM_RESTS: f64 = 4.0;

/// One motion of a group.
pub struct Lane<'a> {
    pub observer: MotionObserver<'a>,
    until: EndCondition,
    velocity: GroundVelocity<'a>,
    /// Relative motion of the feet, and their current relative displacement; `None` if both feet move alike.
    pub feet: Option<FeetApart<'a>>,
    pub feet_apart_m: Vector2<f64>,
    pub quiet_from_s: f64,
    /// Time up to which the lane steps without interruption, in seconds.
    pub until_s: f64,
    /// True if the current position has been observed.
    pub is_observed: bool,
    /// Time up to which the kicks have been applied, and ground velocity at this time.
    kicked_s: f64,
    ground_m_s: Vector2<f64>,
    pub monitor: MotionMonitor,
    /// Barrier with rigid joints in J, if known; otherwise that with elastic joints, once computed.
    pub barrier_j: Option<f64>,
    /// Last time at which the row moved more than by vibration, in seconds.
    quiet_since_s: f64,
    pub stillness: Stillness,
    pub marks: Marks,
    /// Error that ends the motion.
    pub error: Option<RowMotionError>,
    /// Events of ties since the last observation.
    pub tie_events: Vec<(usize, EventKind)>,
}

/// Observations of a motion up to now.
#[derive(Default)]
pub struct MotionMonitor {
    /// Potential and elastic energy at the start, and kinetic energy, in J; `None` before the first observation.
    pub start_j: Option<(f64, f64)>,
    pub rest_sway_kg_m: f64,
    /// Gaps above which a joint counts as open, at intrados and extrados, in m; empty before the first observation, at rest.
    pub opening_m: Vec<[f64; 2]>,
    /// Largest energy of a row that only vibrates, in J.
    pub vibration_j: f64,
    /// Largest energy, in J.
    pub largest_j: f64,
    /// True while the centre of gravity moves back to its position at rest.
    pub moves_back: bool,
    /// Time and energy of the first observation on quiet ground.
    pub quiet: Option<(f64, f64)>,
}

impl<'a> Lane<'a> {
    pub fn new(
        input: MotionInput<'a>,
        until: EndCondition,
        recorder: Option<&'a mut dyn Recorder>,
    ) -> Self {
        let velocity = GroundVelocity::new(input.ground);
        let start_s = input.ground.start_s();
        Self {
            until,
            ground_m_s: velocity.velocity_at(start_s),
            velocity,
            feet: FeetApart::of(input.row, input.ground),
            feet_apart_m: Vector2::zeros(),
            quiet_from_s: input.ground.end_s(),
            until_s: start_s,
            is_observed: false,
            kicked_s: start_s,
            monitor: MotionMonitor::default(),
            barrier_j: input.barrier_j,
            quiet_since_s: start_s,
            stillness: Stillness::new(
                input.undeformed_barrier_j,
                REST_ENERGY_RATIO * input.row.mass_kg() * input.gravity_m_s2 * input.row.size_m,
            ),
            marks: Marks::new(input.settings, start_s),
            error: None,
            tie_events: Vec::new(),
            observer: MotionObserver::new(input, None, recorder),
        }
    }

    /// Advances the clock by one step, and returns the step.
    pub fn next(&mut self, damping_time_s: f64) -> ElasticStep<Lanes<1>> {
        let step_s = equal_step(
            self.observer.time,
            self.until_s,
            self.observer.longest_step_s,
        );
        let to_s = self.observer.time + 0.5 * step_s;
        let (mut step, ground_m_s) = self.kick(to_s);
        step.drift_s = Lanes([step_s]);
        step.damping = Lanes([damping_time_s / step_s]);
        (self.kicked_s, self.ground_m_s) = (to_s, ground_m_s);
        // Set the end of the last of equal steps exactly, without rounding error.
        let left_s = self.until_s - self.observer.time;
        self.observer.time = if step_s > 0.75 * left_s {
            self.until_s
        } else {
            self.observer.time + step_s
        };
        if let Some(feet) = &mut self.feet {
            let feet_apart_m = feet.advance_to(self.observer.time);
            let by_m = feet_apart_m - self.feet_apart_m;
            step.feet_apart_change_m = [Lanes([by_m.x]), Lanes([by_m.y])];
            self.feet_apart_m = feet_apart_m;
        }
        self.observer.cost.steps += 1;
        self.is_observed = false;
        step
    }

    /// Kick up to `to_s`, and the ground velocity at this time, which is constant once the ground is quiet.
    pub fn kick(&self, to_s: f64) -> (ElasticStep<Lanes<1>>, Vector2<f64>) {
        let ground_m_s = if self.is_shaken() {
            self.velocity.velocity_at(to_s)
        } else {
            self.ground_m_s
        };
        let shift = ground_m_s - self.ground_m_s;
        let step = ElasticStep {
            kick_s: Lanes([to_s - self.kicked_s]),
            ground_change_m_s: [Lanes([shift.x]), Lanes([shift.y])],
            ..ElasticStep::none()
        };
        (step, ground_m_s)
    }

    pub fn is_shaken(&self) -> bool {
        self.kicked_s < self.quiet_from_s
    }

    pub fn ends_stride(&self) -> bool {
        self.observer.cost.steps.is_multiple_of(STRIDE)
    }

    pub fn is_due(&self) -> bool {
        self.ends_stride() || self.observer.time >= self.until_s
    }

    /// Whether a joint is open beyond its state at rest, by more than the largest penetration under self-weight.
    fn is_open(&mut self, penetrations_m: impl Iterator<Item = [f64; 2]>) -> bool {
        if self.monitor.opening_m.is_empty() {
            let at_rest: Vec<[f64; 2]> = penetrations_m.collect();
            let most_m = at_rest.iter().flatten().copied().fold(0.0, f64::max);
            self.observer.elastic.opening_tolerance_m = most_m;
            let opens = |end: f64| (-end).max(0.0) + most_m;
            self.monitor.opening_m = at_rest.iter().map(|ends| ends.map(opens)).collect();
            return false;
        }
        let mut joints = penetrations_m.zip(&self.monitor.opening_m);
        joints.any(|(ends, from)| (0..2).any(|end| -ends[end] > from[end]))
    }

    /// Records open and slipped joints of the lane with this index. Returns the slip of the structure along its supports, in m to the right.
    pub fn note_joints<const L: usize>(
        &mut self,
        index: usize,
        motion: &ElasticMotion<'_, L>,
        supports: &[SlidingSupport],
    ) -> f64 {
        if self.observer.has_rocked != Some(true) {
            let edges = motion
                .memories
                .iter()
                .map(|edges| edges.penetrations_m)
                .take(motion.structure.row_joints().len());
            let is_open = self.is_open(edges.map(|ends| ends.map(|end| end.0[index])));
            let slips =
                self.observer.elastic.friction_j > REST_ENERGY_RATIO * self.observer.energy_unit;
            self.observer.has_rocked = Some(is_open || slips);
        }
        let observer = &mut self.observer;
        let mut slid = 0.0;
        for (joint, with_joint) in motion.structure.row_joints().iter().enumerate() {
            let permanent_slip_m = motion.memories[joint].permanent_slip_m.0[index];
            if let Some(sliding) = &mut observer.row_summary.sliding {
                sliding.friction_j = observer.elastic.friction_j;
                sliding.offsets_m[joint] = permanent_slip_m;
                let largest = &mut sliding.largest_offsets_m[joint];
                *largest = largest.max(permanent_slip_m.abs());
            }
            // A block can slide off a support that ends at the joint: it has fallen after a slip by the length of the joint.
            let on_support = |support: &&SlidingSupport| support.joint == joint && support.extends;
            match supports.iter().find(on_support) {
                Some(support) => slid += permanent_slip_m * support.along_x,
                None => {
                    observer.overturned |= permanent_slip_m.abs() >= with_joint.geometry.length_m
                }
            }
        }
        slid
    }

    /// Records whether the row moves more than by vibration.
    pub fn note_vibration(&mut self, kinetic_j: f64, potential_j: f64) {
        let most_j = self.monitor.vibration_j;
        let vibrates = kinetic_j < most_j && potential_j < most_j;
        // A row without motion that stands higher than before is held by friction.
        if !vibrates && kinetic_j >= REST_ENERGY_RATIO * self.observer.energy_unit {
            self.quiet_since_s = self.observer.time;
            self.observer.moved = true;
        }
        let since_s = self.quiet_since_s;
        self.observer.elastic.vibrates_since_s = self.lasts(since_s).then_some(since_s);
    }

    /// Whether the row has been in a state since this time for long enough, on quiet ground.
    fn lasts(&self, since_s: f64) -> bool {
        self.observer.is_quiet(since_s.max(self.quiet_from_s))
    }

    pub fn at_rest_since_s(&self) -> Option<f64> {
        let mut since_s = self.quiet_since_s;
        if self.observer.has_rocked == Some(true) {
            since_s = since_s.max(self.stillness.since_s);
        }
        self.lasts(since_s).then_some(since_s)
    }

    /// Ends the motion early if its end condition holds at this energy. On quiet ground a structure gains no energy.
    pub fn end_early(&mut self, energy_j: f64, barrier_j: impl Fn() -> Option<f64>) {
        if self.observer.time < self.quiet_from_s {
            return;
        }
        let (from_s, quiet_j) = *self
            .monitor
            .quiet
            .get_or_insert((self.observer.time, energy_j));
        let (observed_s, rest_s) = (self.observer.time - from_s, self.observer.rest_time_s());
        // Assume that the energy decays `SLOWER` times more slowly from now on.
        let rate = libm::log(quiet_j / energy_j) / observed_s;
        let rests_s = SLOWER * libm::log(energy_j / self.stillness.limit_j).max(0.0) / rate;
        let rested_s = self.observer.time + rests_s + rest_s;
        let settles = self.until == EndCondition::Settled;
        let rests = settles && rate > 0.0 && rested_s < self.observer.input.settings.end_s;
        // A calm row may still exceed its largest rotation a little, if that is as small.
        let decayed = energy_j < DECAYED * self.monitor.largest_j;
        let may_end = self.is_calm() && (decayed || !settles);
        if may_end && barrier_j().is_some_and(|barrier_j| self.keeps_barrier(barrier_j)) {
            self.observer.end_early(rests);
            return;
        }
        // With feet that move apart, the barrier is unknown. A row beyond its barrier falls to that side, with any damping.
        if self.feet.is_some() || !self.monitor.moves_back {
            return;
        }
        let ends = match self.until {
            EndCondition::End | EndCondition::Calm => false,
            EndCondition::Settled => {
                self.observer.moved && decayed && (rests || observed_s > OBSERVED_RESTS * rest_s)
            }
            EndCondition::Safe => true,
        };
        let gone_j = self.observer.elastic.friction_j + self.observer.elastic.crushed_j;
        let is_safe =
            |barrier_j: f64| energy_j < SAFE * barrier_j && gone_j < LARGEST_LOSS_RATIO * barrier_j;
        if ends && barrier_j().is_some_and(is_safe) {
            self.observer.end_early(rests);
        }
    }

    /// Whether the motion ends because the row has only vibrated for some time, if its barrier is that of the row before.
    fn is_calm(&self) -> bool {
        let ends = self.until != EndCondition::End || self.observer.input.settings.ends_calm();
        let calm_s = CALM_RESTS * self.observer.rest_time_s();
        let since_s = self.quiet_since_s.max(self.quiet_from_s);
        let has_lasted = self.observer.time - since_s > calm_s;
        // A row that stands lower than before may be falling slowly.
        let is_low = self.observer.potential < -self.monitor.vibration_j;
        ends && has_lasted && !is_low && self.feet.is_none() && self.at_rest_since_s().is_none()
    }

    /// Whether crushing and slip have hardly changed the barrier. A row that has crushed may continue to crush, and fall without much energy.
    fn keeps_barrier(&self, barrier_j: f64) -> bool {
        let (row, summary) = (self.observer.input.row, &self.observer.row_summary);
        let slips_little = |sliding: &Sliding| sliding.largest_m() < comparable_slip_m(row);
        let lost_j = LARGEST_LOSS_RATIO * barrier_j;
        self.observer.elastic.crushed_j < lost_j
            && (self.observer.elastic.friction_j < lost_j
                || summary.sliding.as_ref().is_none_or(slips_little))
    }
}
