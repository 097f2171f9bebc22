//! Friction that a sequence of mechanisms requires.

use super::posture::StructureState;
use super::rocking::Rocking;
use crate::dynamics::thrust::{FrictionRecord, HalfCycles};
use crate::dynamics::{Outcome, Peak};
use crate::mechanics::MechanismChain;

/// Friction demand up to now: see [`FrictionRecord`]. A half cycle ends at an impact; its peak is that of the rotation over the critical one.
pub(super) struct FrictionCollector<'a, C: MechanismChain> {
    largest: Peak,
    /// Largest demand of the part that counts for sure.
    counted: Peak,
    /// Largest demand up to the last instant below the unstable equilibrium.
    before_critical: Peak,
    half_cycles: HalfCycles,
    /// Largest rotation of the current half cycle, over the critical one.
    peak: f64,
    /// Largest pushes at rest to the right and to the left, with their states until their demand is noted.
    pushes: [(f64, Option<StructureState<'a, C>>); 2],
}

impl<'a, C: MechanismChain> FrictionCollector<'a, C> {
    pub(super) fn new() -> Self {
        Self {
            largest: Peak::default(),
            counted: Peak::default(),
            before_critical: Peak::default(),
            half_cycles: HalfCycles::default(),
            peak: 0.0,
            pushes: [(f64::NEG_INFINITY, None); 2],
        }
    }

    /// Adds a rotation, over the critical one.
    pub(super) fn note_rotation(&mut self, over_critical: f64) {
        self.peak = self.peak.max(over_critical);
    }

    /// Adds the demand at an instant in motion.
    pub(super) fn add_demand(&mut self, time_s: f64, friction: f64, is_below_critical: bool) {
        self.largest.record_value(friction, time_s);
        if is_below_critical {
            self.before_critical = self.largest;
        }
    }

    /// Adds an instant at rest. The demand of a section is largest at the largest push to a side, so the largest demand at rest follows from these
    /// two pushes alone.
    pub(super) fn note_rest(&mut self, rocking: &Rocking<'a, C>, now: &StructureState<'a, C>) {
        let push = rocking.push_at_rest(now);
        for ((largest, at), push) in self.pushes.iter_mut().zip([push, -push]) {
            if push > *largest {
                (*largest, *at) = (push, Some(*now));
            }
        }
    }

    /// Ends a time at rest.
    pub(super) fn end_rest(&mut self, rocking: &Rocking<'a, C>) {
        for (_, at) in &mut self.pushes {
            if let Some(now) = at.take() {
                self.largest
                    .record_value(rocking.demand(&now).friction, now.time_s);
            }
        }
        self.before_critical = self.largest;
    }

    /// Ends a half cycle.
    pub(super) fn end_half_cycle(&mut self) {
        if self.half_cycles.end(self.peak) {
            self.counted = self.largest;
        }
        self.peak = 0.0;
    }

    /// Record of a motion that ends in this state, with this outcome.
    pub(super) fn record(
        &mut self,
        rocking: &Rocking<'a, C>,
        outcome: Outcome,
        moves: bool,
    ) -> FrictionRecord {
        if moves {
            self.end_half_cycle();
        }
        if self.half_cycles.are_none() {
            self.end_rest(rocking);
        }
        let largest = match outcome {
            Outcome::Overturned(_) => self.before_critical,
            _ if self.half_cycles.are_none() => self.largest,
            _ => self.counted,
        };
        FrictionRecord {
            largest,
            lasting: None,
        }
    }
}
