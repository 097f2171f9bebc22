//! Early end of histories, for studies of many cases that only need to know whether the structure overturns.

use std::ops::ControlFlow;

use super::recorder::Recorder;
use super::request::Request;
use crate::dynamics::{GroundMotion, Sample, State};
use crate::mechanics::{Joint, Row, Sway};

/// End of the computation of a motion. A motion that is ended early has the outcome [`Rest`](super::history::Outcome::Rest) if it is predicted to
/// come to rest before its regular end, otherwise [`StillRocking`](super::history::Outcome::StillRocking).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndCondition {
    /// The regular end of the history.
    End,
    /// A row with elastic joints rests or only vibrates: its energy is small and decays. Other models continue to the regular end.
    Calm,
    /// The structure cannot overturn, and no block exceeds its largest rotation. With rigid joints it also comes to rest before the end of the history.
    Settled,
    /// The structure cannot overturn.
    Safe,
}

/// Fraction of the energy barrier of the first mechanism below which a structure on quiet ground cannot overturn. Rows may overturn by other
/// mechanisms: 125 histories of random rows that overturned never had less than 0.45 of the barrier on quiet ground before.
pub(super) const SAFE: f64 = 0.25;

/// Fraction of the largest energy of the motion below which no block exceeds its largest rotation.
const DECAYED: f64 = 0.1;

/// Slip, over the thickness of the thinnest joint, up to which the barrier is that of the row before slip.
const COMPARABLE_SLIP: f64 = 0.01;

/// Slip, in metres, up to which the barrier of a row is that before slip.
pub(super) fn comparable_slip_m(row: &Row) -> f64 {
    let thicknesses_m = row.joints.iter().map(Joint::thickness_m);
    COMPARABLE_SLIP * thicknesses_m.fold(f64::INFINITY, f64::min)
}

/// Number of durations of the last half cycle that must fit into the time left, so that a history comes to rest before its end. Half cycles shorten
/// at least as fast as those of a block whose impacts leave 0.95 of the energy.
const HALF_CYCLES_LEFT: f64 = 40.0;

/// Fraction of the largest energy of the motion below which no later half cycle has half of the largest peak.
const FADED: f64 = 0.25;

/// Peak of the current half cycle, over the largest one, below which the half cycle is not [strong](super::thrust::STRONG). Lower than that limit,
/// because the peaks of samples are lower than those of steps.
const WEAK: f64 = 0.4;

/// Recorder that ends a history once the structure cannot overturn, and its friction demand is known.
#[derive(Default)]
pub(super) struct SafetyMonitor {
    /// Time from which on the ground is quiet, in seconds.
    quiet_from_s: f64,
    /// Time of the latest rest, in seconds; infinite without this condition.
    rest_by_s: f64,
    /// Side of the current sway, and its start in seconds.
    sways: Option<(Sway, f64)>,
    /// Duration of the previous half cycle, in seconds.
    half_cycle_s: f64,
    /// Largest energy up to now, over the barrier.
    largest_ratio: f64,
    /// Largest rotation of a block in the current half cycle, and up to now, in radians.
    peaks_rad: [f64; 2],
    /// Largest slip with which energies are comparable with the barrier, in metres.
    largest_slip_m: f64,
    /// True once the history is ended early.
    pub(super) has_ended: bool,
}

impl SafetyMonitor {
    /// Recorder for a motion with this end; `None` for the regular end.
    pub(super) fn new(
        until: EndCondition,
        ground: &GroundMotion,
        request: &Request,
    ) -> Option<Self> {
        let rest_by_s = match until {
            EndCondition::End | EndCondition::Calm => return None,
            EndCondition::Settled => request.end_s,
            EndCondition::Safe => f64::INFINITY,
        };
        Some(Self {
            quiet_from_s: ground.end_s(),
            rest_by_s,
            ..Self::default()
        })
    }

    /// Sets the row whose slips end the comparison with its barrier.
    pub(super) fn watch(&mut self, row: &Row) {
        self.largest_slip_m = comparable_slip_m(row);
    }

    /// Longest duration of a half cycle from now on, in seconds.
    fn longest_half_cycle_s(&mut self, sample: &Sample) -> f64 {
        let State::Rocking(sway) = sample.state else {
            return f64::INFINITY;
        };
        let now_s = sample.time_s;
        let (side, since_s) = *self.sways.get_or_insert((sway, now_s));
        if side != sway {
            self.half_cycle_s = now_s - since_s;
            self.sways = Some((sway, now_s));
            self.peaks_rad[0] = 0.0;
        }
        // The current half cycle may be longer than the last one, which the ground affected.
        self.half_cycle_s
            .max(now_s - self.sways.map_or(now_s, |(_, since_s)| since_s))
    }

    /// Whether the friction demand cannot change any more. If joints slip it is not needed.
    fn knows_demand(&mut self, sample: &Sample, ratio: f64) -> bool {
        let rotations_rad = sample.rotations_rad.iter().map(|rotation| rotation.abs());
        let largest_rad = rotations_rad.fold(0.0, f64::max);
        self.peaks_rad = self.peaks_rad.map(|peak_rad| peak_rad.max(largest_rad));
        let [current_rad, most_rad] = self.peaks_rad;
        let has_faded = ratio < FADED * self.largest_ratio && current_rad < WEAK * most_rad;
        has_faded || !sample.offsets_m.is_empty()
    }
}

impl Recorder for SafetyMonitor {
    fn wants_demand(&self) -> bool {
        false
    }

    fn wants_events(&self) -> bool {
        false
    }

    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        let half_cycle_s = self.longest_half_cycle_s(sample);
        // A row that has slipped far has another barrier.
        let far = |offset_m: &f64| offset_m.abs() > self.largest_slip_m;
        let slips = sample.offsets_m.iter().any(far);
        let ratio = sample.energy_ratio.unwrap_or(f64::INFINITY);
        self.largest_ratio = self.largest_ratio.max(ratio);
        let safe = self.knows_demand(sample, ratio) && ratio < SAFE;
        if sample.time_s < self.quiet_from_s || !safe || slips {
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
