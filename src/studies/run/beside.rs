//! The first samples of `[uncertain]` beside the history of the scenario itself, for its page.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::film::Film;
use crate::dynamics::history::{Sample, State};
use crate::dynamics::model::WithoutDemand;
use crate::output::envelope::Envelope;
use crate::output::scene::Scene;
use crate::scenario::Scenario;

/// Largest number of samples that are drawn.
const MOST_SAMPLES: usize = 20;
/// Number of columns to which the curve of a sample is thinned.
const COLUMNS: usize = 150;
/// Largest size of the frames of a sample on the page, in bytes.
const FRAME_BYTES: usize = 30_000;
/// Limits on the number of frames of a sample, whatever the number of blocks.
const FRAMES: [usize; 2] = [51, 201];

/// The history of a sample, thinned, until it has overturned, if it does.
#[derive(Clone, Debug)]
pub(super) struct Beside {
    /// The structure of the sample.
    pub(super) scene: Scene,
    /// Its motion.
    pub(super) film: Film,
    /// The rotation of one body over time, in radians.
    pub(super) turning: Envelope,
    /// Whether it overturns.
    pub(super) falls: bool,
}

/// The first samples of a scenario, with the rotation of this body. Samples without a history are left out here: the study of all
/// samples tells them.
pub(super) fn first_samples(scenario: &Scenario, body: usize) -> Vec<Beside> {
    let Some(uncertain) = scenario.uncertain() else {
        return Vec::new();
    };
    let samples = 0..uncertain.samples.min(MOST_SAMPLES);
    let history = |sample| {
        let sample = uncertain.scenario(scenario, &uncertain.values(sample));
        history(&sample.ok()?, body)
    };
    samples.into_par_iter().filter_map(history).collect()
}

/// The history of a sample, with the model and the steps of samples.
fn history(scenario: &Scenario, body: usize) -> Option<Beside> {
    let model = scenario.motion().model_for_many_cases(scenario.structure());
    let model = model.ok()?;
    // Rotation and displacement of each body, time and layout, in base 64.
    let bytes = 4 * (6 * model.bodies().len() + 10) / 3;
    let [fewest, most] = FRAMES;
    let mut beside = Beside {
        scene: super::scene(scenario, &*model),
        film: Film::new((FRAME_BYTES / bytes).clamp(fewest, most)),
        turning: Envelope::of_columns(COLUMNS),
        falls: false,
    };
    let mut record = WithoutDemand(|sample: &Sample| {
        if matches!(sample.state, State::Overturned(_)) {
            beside.falls = true;
            return ControlFlow::Break(());
        }
        beside.film.push(sample);
        if let Some(rotation_rad) = sample.rotations_rad.get(body) {
            beside.turning.push(sample.time_s, *rotation_rad);
        }
        ControlFlow::Continue(())
    });
    let (ground, request) = (scenario.ground_motion(), scenario.request());
    let summary = model.simulate(ground, &request, Some(&mut record));
    summary.ok()?;
    Some(beside)
}
