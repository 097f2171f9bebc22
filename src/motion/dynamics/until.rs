//! How far a motion is followed, in studies of many cases that need only whether it overturns.

use std::ops::ControlFlow;

use super::ground::GroundMotion;
use super::history::{Sample, State};
use super::recorder::Recorder;
use super::request::Request;
use crate::mechanics::sway::Sway;

/// The end of the computation of a motion. One that is not followed further is [`StillRocking`](super::history::Outcome::StillRocking) before its
/// end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Until {
    /// To its end.
    End,
    /// Up to where it cannot overturn any more, turns no block as far as it did, and comes to rest by its end.
    Settled,
    /// Up to where it cannot overturn any more.
    Safe,
}

/// On ground that stays quiet, a structure with less than this fraction of the energy barrier of its first mechanism cannot overturn
/// any more. Rows overturn by other mechanisms as well: 125 histories of random rows that overturned never had less than 0.45 of the
/// barrier on quiet ground before.
pub(super) const SAFE: f64 = 0.25;

/// With less than this fraction of the largest energy that it had, a structure turns no block as far as it did.
const DECAYED: f64 = 0.1;

/// A history that may be ended early comes to rest before its end if this many times its last half cycle fit into the time that is
/// left: half cycles shorten at least as fast as those of a block whose impacts leave 0.95 of the energy.
const HALF_CYCLES_LEFT: f64 = 40.0;

/// Ends a history that cannot overturn any more.
#[derive(Default)]
pub(super) struct UntilSafe {
    /// From when on the ground is quiet, in seconds.
    quiet_s: f64,
    /// By when it must have come to rest, in seconds; infinite where that does not matter.
    rest_by_s: f64,
    /// The side to which it sways, and since when, in seconds.
    sways: Option<(Sway, f64)>,
    /// Duration of the previous half cycle, in seconds.
    half_cycle_s: f64,
    /// The largest energy so far, over the barrier.
    largest_ratio: f64,
    /// True once the history was ended early.
    pub(super) has_ended: bool,
}

impl UntilSafe {
    /// Of a motion that is followed as far as `until` says; `None` if that is to its end.
    pub(super) fn new(until: Until, ground: &GroundMotion, request: &Request) -> Option<Self> {
        let rest_by_s = match until {
            Until::End => return None,
            Until::Settled => request.end_s,
            Until::Safe => f64::INFINITY,
        };
        Some(Self {
            quiet_s: ground.end_s(),
            rest_by_s,
            ..Self::default()
        })
    }

    /// Longest duration of a half cycle from now on.
    fn longest_half_cycle_s(&mut self, sample: &Sample) -> f64 {
        let State::Rocking(sway) = sample.state else {
            return f64::INFINITY;
        };
        let now_s = sample.time_s;
        let (side, since_s) = *self.sways.get_or_insert((sway, now_s));
        if side != sway {
            self.half_cycle_s = now_s - since_s;
            self.sways = Some((sway, now_s));
        }
        // The half cycle under way may be longer than the one before, which the ground drove.
        self.half_cycle_s
            .max(now_s - self.sways.map_or(now_s, |(_, since_s)| since_s))
    }
}

impl Recorder for UntilSafe {
    fn wants_demand(&self) -> bool {
        false
    }

    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        let half_cycle_s = self.longest_half_cycle_s(sample);
        // A row that has slipped stands lower: its energy says nothing.
        let slips = !sample.offsets_m.is_empty();
        let ratio = sample.energy_ratio.unwrap_or(f64::INFINITY);
        self.largest_ratio = self.largest_ratio.max(ratio);
        let safe = ratio < SAFE;
        if sample.time_s < self.quiet_s || !safe || slips {
            return ControlFlow::Continue(());
        }
        let rests = sample.time_s + HALF_CYCLES_LEFT * half_cycle_s < self.rest_by_s;
        let decayed = self.half_cycle_s > 0.0 && ratio < DECAYED * self.largest_ratio;
        if self.rest_by_s < f64::INFINITY && !(rests && decayed) {
            return ControlFlow::Continue(());
        }
        self.has_ended = true;
        ControlFlow::Break(())
    }
}
