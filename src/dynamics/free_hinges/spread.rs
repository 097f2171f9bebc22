//! How far a motion depends on the steps that it is computed with.

use crate::dynamics::history::{Outcome, Summary};
use crate::dynamics::model::{Model as _, Request, SimulationError};

use super::FreeHinges;
use crate::dynamics::ground::GroundMotion;

/// Half cycles are the same while their peaks differ by no more than this part of the largest.
pub const SAME_PEAK_RATIO: f64 = 0.01;

/// How many times as long the steps of the repetitions are.
pub const REPETITIONS: [f64; 2] = [0.5, 2.0];

/// A motion beside its repetitions with half and with double steps.
///
/// After the first change of side the order of impacts that almost coincide decides, and shorter steps need not
/// converge: that belongs to the model. What the three agree in can be relied on, and nothing else.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// How it ended: itself, with half and with double steps.
    pub outcomes: [Outcome; 3],
    /// The half cycles that all three have.
    pub half_cycles: Vec<PeakSpread>,
    /// Half cycles from the first on that are the same: to one side, with peaks within [`SAME_PEAK_RATIO`].
    pub same_until_half_cycle: usize,
    /// When the first half cycle begins that is not, in seconds; `None` where all are the same.
    pub parts_at_s: Option<f64>,
}

/// Peak of a half cycle, in radians: largest rotation of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakSpread {
    /// That of the motion itself.
    pub own_rad: f64,
    /// The least of the three.
    pub min_rad: f64,
    /// The largest of the three.
    pub max_rad: f64,
}

impl Spread {
    /// Compares a motion of a row with its repetitions.
    #[must_use]
    pub fn new(own: &Summary, half_steps: &Summary, double_steps: &Summary) -> Self {
        let runs = [own, half_steps, double_steps];
        let cycles = runs.map(|summary| {
            let run = summary.free_hinges.as_deref();
            run.map_or(&[][..], |run| &run.half_cycles)
        });
        let in_all = cycles[0].iter().zip(cycles[1]).zip(cycles[2]);
        let triples = in_all.map(|((own, half), double)| [own, half, double]);
        let mut half_cycles = Vec::new();
        let mut same = 0;
        for triple in triples {
            let peaks_rad = triple.map(|cycle| cycle.peak_rad);
            let peak = PeakSpread {
                own_rad: peaks_rad[0],
                min_rad: peaks_rad.into_iter().fold(f64::INFINITY, f64::min),
                max_rad: peaks_rad.into_iter().fold(0.0, f64::max),
            };
            let to_one_side = triple.iter().all(|cycle| cycle.sway == triple[0].sway);
            let close = peak.max_rad - peak.min_rad <= SAME_PEAK_RATIO * peak.max_rad;
            if same == half_cycles.len() && to_one_side && close {
                same += 1;
            }
            half_cycles.push(peak);
        }
        let most = cycles.map(<[_]>::len).into_iter().max().unwrap_or(0);
        let starts_s = cycles
            .iter()
            .filter_map(|cycles| Some(cycles.get(same)?.start_s));
        Self {
            outcomes: runs.map(|summary| summary.outcome),
            half_cycles,
            same_until_half_cycle: same,
            parts_at_s: (same < most).then(|| starts_s.fold(f64::INFINITY, f64::min)),
        }
    }

    /// Whether all three ended alike, to the same side if they overturned.
    #[must_use]
    pub fn same_outcome(&self) -> bool {
        self.outcomes.iter().all(|other| *other == self.outcomes[0])
    }
}

impl FreeHinges {
    /// What becomes of it with all steps so many times as long as for a history with samples.
    ///
    /// # Errors
    /// Those of [`Model::simulate`](crate::dynamics::model::Model::simulate).
    pub fn repeated(
        &self,
        factor: f64,
        ground: &GroundMotion,
        request: &Request,
    ) -> Result<Summary, SimulationError> {
        self.with_steps_times(factor, request)
            .simulate(ground, request, None)
    }
}
