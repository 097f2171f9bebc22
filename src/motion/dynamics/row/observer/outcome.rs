//! The outcome of an observed motion: whether it has ended, and whether it ends too early to decide.

use super::{MotionObserver, REST_ENERGY_RATIO, side_of};
use crate::dynamics::Outcome;
use crate::dynamics::request::later_end_s;
use crate::dynamics::until::{SAFE, comparable_slip_m};

/// Duration of small kinetic energy, over the square root of size over gravity, after which a row is at rest. It is longer than a turning point.
const REST_TIME_RATIO: f64 = 0.5;
/// Energy dissipated by friction, over the barrier of the first mechanism, above which a row counts as slipped. The row is then lower than before,
/// and its potential energy is not comparable with the barrier.
const SLIPPED_RATIO: f64 = 0.01;

/// Duration, over the square root of size over gravity, in which the largest kinetic energy counts if no barrier is known. It is longer than the time
/// between turning points.
const RECENT_RATIO: f64 = 2.0;

/// The largest kinetic energy in the last two periods.
pub(super) struct RecentEnergy {
    /// That of the earlier and of the later period, in J.
    largest_j: [f64; 2],
    /// Start of the later one.
    from_s: f64,
}

impl RecentEnergy {
    pub(super) const fn new(from_s: f64) -> Self {
        Self {
            largest_j: [0.0; 2],
            from_s,
        }
    }

    /// Notes the kinetic energy at a time. `scale_s` is the square root of size over gravity.
    pub(super) fn record_energy(&mut self, kinetic_j: f64, time_s: f64, scale_s: f64) {
        if time_s - self.from_s > RECENT_RATIO * scale_s {
            *self = Self {
                largest_j: [self.largest_j[1], 0.0],
                from_s: time_s,
            };
        }
        self.largest_j[1] = self.largest_j[1].max(kinetic_j);
    }

    fn largest_j(&self) -> f64 {
        self.largest_j[0].max(self.largest_j[1])
    }
}

impl MotionObserver<'_> {
    /// Outcome of the motion and its time; `None` if the motion continues. `overturned_s` is the time of overturning, `at_rest_since_s` the
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

    /// Extends the simulated time if the history would end incomplete with this outcome. Returns its new end in seconds, `None` if it ends.
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

    /// Outcome while no joint has opened or slipped; `None` afterwards.
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

    /// Whether the history ends too early to decide the outcome; see [`Outcome`].
    pub(super) fn is_incomplete(&self) -> bool {
        if self.is_safe || self.elastic.vibrates_since_s.is_some() {
            return false;
        }
        let crushed_little = |barrier_j: &f64| self.elastic.crushed_j <= SLIPPED_RATIO * barrier_j;
        let energy_ratio = match self.known_barrier_j().filter(crushed_little) {
            Some(barrier_j) => {
                (self.kinetic + self.potential - self.rest_potential_j()) / barrier_j
            }
            None => self.recent.largest_j() / self.input.undeformed_barrier_j,
        };
        self.time < self.input.ground.end_s() || energy_ratio > SAFE
    }

    /// Energy barrier, in J; `None` if unknown, or if the row has slipped so much that its potential energy is not comparable. Rigid joints
    /// that slip a little to and fro take much energy, and leave the barrier as it was.
    pub(super) fn known_barrier_j(&self) -> Option<f64> {
        let Some(sliding) = &self.row_summary.sliding else {
            return self.input.barrier_j;
        };
        let is_rigid = self.has_rocked.is_none();
        let slips_little = || sliding.largest_m() < comparable_slip_m(self.input.row);
        let rubs_little = |barrier_j: f64| sliding.friction_j <= SLIPPED_RATIO * barrier_j;
        let known = |barrier_j: &f64| rubs_little(*barrier_j) || is_rigid && slips_little();
        self.input.barrier_j.filter(known)
    }

    /// Potential energy at rest, in J: the least one up to now. A row that has slipped may rest lower than before.
    pub(super) fn rest_potential_j(&self) -> f64 {
        let slips = self.row_summary.sliding.is_some();
        if slips { self.least_potential_j } else { 0.0 }
    }

    /// Duration of small kinetic energy after which the row is at rest, in seconds.
    pub fn rest_time_s(&self) -> f64 {
        REST_TIME_RATIO * (self.input.row.size_m / self.input.gravity_m_s2).sqrt()
    }

    /// Whether a row with small kinetic energy since `since_s` is at rest.
    pub(crate) fn is_quiet(&self, since_s: f64) -> bool {
        self.time - since_s > self.rest_time_s()
    }

    /// Last time at which the row could still return, if the stepper has found that it has overturned.
    pub fn overturned_s(&self) -> Option<f64> {
        self.overturned.then_some(self.last_maximum.time)
    }

    /// Last time at which the row could still return, if its potential energy shows that it has overturned.
    pub fn fallen_s(&self, potential: f64) -> Option<f64> {
        (potential < self.overturned_below_j).then_some(self.highest_s)
    }

    /// Ends the motion early: the row cannot overturn. `rests` is true if it is predicted to come to rest.
    pub const fn end_early(&mut self, rests: bool) {
        self.is_safe = true;
        self.counts_as_rest = rests;
    }
}
