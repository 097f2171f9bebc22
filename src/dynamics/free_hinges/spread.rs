//! How far a motion depends on the way it is computed.

use super::{HalfCycle, Settings};
use crate::dynamics::history::{Outcome, Summary};

/// To this part of them peaks are called certain.
pub const SAME_PEAK_RATIO: f64 = 0.01;

/// The repetitions must agree to this part of that, because still other ways to compute the motion may differ by more.
const AGREEMENT: f64 = 0.5;

/// After the last half cycle that peaks above this part of the largest peak nothing is compared.
const LEAST_PEAK_RATIO: f64 = 1e-2;

named! {
    /// Other ways to compute the motion of a row.
    pub enum Repeated {
        /// With steps half as long.
        HalfSteps = "half steps",
        /// With steps twice as long.
        DoubleSteps = "double steps",
        /// With the landings that follow an impact within four shortest steps merged with each other. Real impacts last: in which order
        /// landings follow within that time nobody knows.
        MergedLandings = "landings merged",
    }
}

/// The time after an impact in which landings are merged, over the shortest step.
const MERGED_RATIO: f64 = 4.0;

impl Repeated {
    /// These settings, in this way.
    pub(super) fn of(self, settings: &Settings) -> Settings {
        // Steps end at output times as well: where these limit them, they must vary too.
        let limits = |output_step_s: &f64| *output_step_s < 2.0 * settings.longest_step_s;
        let times = |factor: f64| Settings {
            output_step_s: settings.output_step_s.map(|step_s| {
                if limits(&step_s) {
                    factor * step_s
                } else {
                    step_s
                }
            }),
            ..settings.times(factor)
        };
        match self {
            Self::HalfSteps => times(0.5),
            Self::DoubleSteps => times(2.0),
            Self::MergedLandings => Settings {
                shortest_step_s: (MERGED_RATIO * settings.shortest_step_s)
                    .min(settings.longest_step_s),
                merged_after: 0,
                ..*settings
            },
        }
    }
}

/// A motion beside its repetitions: what they agree in can be relied on, and nothing else.
///
/// After the first change of side the order of impacts that almost coincide decides.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// How the repetitions were computed.
    pub repeated: Vec<&'static str>,
    /// How it ended: itself, then the repetitions.
    pub outcomes: Vec<Outcome>,
    /// The half cycles that all have, up to the last that peaks above a hundredth of the largest peak of the motion itself.
    pub half_cycles: Vec<PeakSpread>,
    /// Half cycles from the first on that are the same: to one side, with peaks that are the same.
    pub same_until_half_cycle: usize,
    /// When the first half cycle begins that is not, in seconds; `None` where all are the same.
    pub parts_at_s: Option<f64>,
    /// The largest rotation of a block; `None` where it overturns in one of them.
    pub largest: Option<PeakSpread>,
}

/// A largest rotation of a block, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakSpread {
    /// That of the motion itself.
    pub own_rad: f64,
    /// The least of all.
    pub min_rad: f64,
    /// The largest of all.
    pub max_rad: f64,
}

impl PeakSpread {
    /// Of the motion itself, then its repetitions.
    fn of(peaks_rad: &[f64]) -> Self {
        Self {
            own_rad: peaks_rad[0],
            min_rad: peaks_rad.iter().copied().fold(f64::INFINITY, f64::min),
            max_rad: peaks_rad.iter().copied().fold(0.0, f64::max),
        }
    }

    /// Whether all agree so well that they are certain to [`SAME_PEAK_RATIO`].
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.max_rad - self.min_rad <= AGREEMENT * SAME_PEAK_RATIO * self.max_rad
    }
}

impl Spread {
    /// Compares a motion of a row with its repetitions, given with their names.
    #[must_use]
    pub fn new(own: &Summary, repetitions: &[(&'static str, Summary)]) -> Self {
        let runs: Vec<&Summary> = std::iter::once(own)
            .chain(repetitions.iter().map(|(_, summary)| summary))
            .collect();
        let cycles: Vec<_> = runs
            .iter()
            .map(|summary| {
                let run = summary.free_hinges.as_deref();
                run.map_or(&[][..], |run| &run.half_cycles)
            })
            .collect();
        let largest_rad = cycles[0]
            .iter()
            .map(|cycle| cycle.peak_rad)
            .fold(0.0, f64::max);
        let counts = |cycle: &HalfCycle| cycle.peak_rad > LEAST_PEAK_RATIO * largest_rad;
        let last = cycles[0].iter().rposition(counts);
        let compared = last.map_or(0, |last| last + 1);
        let in_all = cycles
            .iter()
            .map(|cycles| cycles.len())
            .min()
            .unwrap_or(0)
            .min(compared);
        let mut half_cycles = Vec::new();
        let mut same = 0;
        for index in 0..in_all {
            let peaks_rad: Vec<f64> = cycles.iter().map(|cycles| cycles[index].peak_rad).collect();
            let peak = PeakSpread::of(&peaks_rad);
            let side = cycles[0][index].sway;
            let to_one_side = cycles.iter().all(|cycles| cycles[index].sway == side);
            if same == index && to_one_side && peak.is_same() {
                same += 1;
            }
            half_cycles.push(peak);
        }
        let starts_s = cycles
            .iter()
            .filter(|_| same < compared)
            .filter_map(|cycles| Some(cycles.get(same)?.start_s))
            .reduce(f64::min);
        let stands = |summary: &&Summary| !matches!(summary.outcome, Outcome::Overturned(_));
        let largest_rad: Vec<f64> = runs
            .iter()
            .map(|summary| summary.largest_rotation_rad())
            .collect();
        Self {
            repeated: repetitions.iter().map(|(name, _)| *name).collect(),
            outcomes: runs.iter().map(|summary| summary.outcome).collect(),
            half_cycles,
            same_until_half_cycle: same,
            parts_at_s: starts_s,
            largest: runs
                .iter()
                .all(stands)
                .then(|| PeakSpread::of(&largest_rad)),
        }
    }

    /// Whether all ended alike, to the same side if they overturned.
    #[must_use]
    pub fn same_outcome(&self) -> bool {
        self.outcomes.iter().all(|other| *other == self.outcomes[0])
    }
}
