//! The displacement between the feet of a structure that move differently.

use nalgebra::Vector2;
use serde::Serialize;

use crate::dynamics::history::Summary as History;
use crate::scenario::Scenario;

/// Displacements of the right foot relative to the left one, to the right and upwards.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FeetApart {
    /// Time at which the history starts, in seconds: zero or negative.
    pub start_s: f64,
    /// The largest displacement of the right foot relative to the left one at output steps, in metres.
    pub feet_farthest_apart_m: Vector2<f64>,
    /// Time of the largest displacement, in seconds.
    pub feet_farthest_apart_time_s: f64,
    /// The displacement of the right foot relative to the left one at the end of the run, in metres.
    pub feet_apart_at_end_m: Vector2<f64>,
}

impl FeetApart {
    /// Computes the displacements in a run; `None` if both feet move together.
    pub(super) fn of(scenario: &Scenario, history: &History) -> Option<Self> {
        let ground = scenario.ground_motion();
        ground.right_foot()?;
        let step_s = scenario.simulation.output_step_s;
        let first = (ground.start_s() / step_s).ceil() as i32;
        let last = (history.end_s / step_s).floor() as i32;
        let mut times_s = vec![ground.start_s()];
        times_s.extend((first..=last).map(|step| step_s * f64::from(step)));
        times_s.push(history.end_s);
        let apart_m = ground.feet_apart_m(&times_s);
        let all = || times_s.iter().copied().zip(apart_m.iter().copied());
        let (feet_farthest_apart_time_s, feet_farthest_apart_m) =
            all().max_by(|one, other| one.1.norm().total_cmp(&other.1.norm()))?;
        let (_, feet_apart_at_end_m) = all().next_back()?;
        Some(Self {
            start_s: ground.start_s(),
            feet_farthest_apart_m,
            feet_farthest_apart_time_s,
            feet_apart_at_end_m,
        })
    }
}
