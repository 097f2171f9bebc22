//! The displacement between the feet of a structure that move differently.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::Summary;
use crate::dynamics::NO_RISE;
use crate::scenario::Scenario;

/// Number of equal steps at which the displacement is computed.
const STEPS: u32 = 200_000;

/// Displacements of the right foot relative to the left one, to the right and upwards.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct FeetApart {
    /// Time at which the history starts, in seconds: zero or negative.
    pub start_s: f64,
    /// The largest displacement of the right foot relative to the left one, in metres.
    pub feet_farthest_apart_m: Vector2<f64>,
    /// First time of the largest displacement, in seconds.
    pub feet_farthest_apart_time_s: f64,
    /// The displacement of the right foot relative to the left one at the end of the run, in metres.
    pub feet_apart_at_end_m: Vector2<f64>,
    /// Ends of the motions of the left and the right foot, in seconds; absent if the right foot has no record.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub records_end_s: Option<[f64; 2]>,
}

impl FeetApart {
    /// Computes the displacements in a run; `None` if both feet move together.
    pub(super) fn of(scenario: &Scenario, history: &Summary) -> Option<Self> {
        let ground = scenario.ground_motion();
        ground.right_foot()?;
        let (start_s, lasts_s) = (ground.start_s(), history.end_s - ground.start_s());
        let time_s = |step: u32| start_s + lasts_s * (f64::from(step) / f64::from(STEPS));
        let times_s: Vec<f64> = (0..=STEPS).map(time_s).collect();
        let apart_m = ground.feet_apart_m(&times_s);
        let largest_m = apart_m.iter().map(|m| m.norm()).fold(0.0, f64::max);
        let farthest = apart_m
            .iter()
            .position(|m| m.norm() >= largest_m * (1.0 - NO_RISE))?;
        let (feet_farthest_apart_time_s, feet_farthest_apart_m) =
            (times_s[farthest], apart_m[farthest]);
        let feet_apart_at_end_m = *apart_m.last()?;
        let right = scenario.right_foot.as_ref();
        let right_record = right.and_then(|right| right.record());
        Some(Self {
            start_s: ground.start_s(),
            feet_farthest_apart_m,
            feet_farthest_apart_time_s,
            feet_apart_at_end_m,
            records_end_s: right_record.map(|_| ground.ends_s()),
        })
    }
}
