//! Variations of a motion, with other values of uncertain properties.

use crate::dynamics::{GroundMotion, Model, Request, SimulationError, Summary};
use std::panic;
use std::thread::{self, JoinHandle};

/// Copy of a model with another plausible value of a property.
#[derive(Debug)]
pub struct Variation {
    /// Description of the difference, in words that follow "with".
    pub name: String,
    /// Model, or the reason why the structure is not stable.
    pub model: Result<Box<dyn Model>, String>,
}

/// Result of a variation.
#[derive(Clone, Debug)]
pub struct VariationResult {
    /// Description of the difference.
    pub name: String,
    /// Summary of the motion, or the reason why there is none.
    pub result: Result<Summary, String>,
}

/// Motion that is computed on a separate thread. The thread ends with the program if nobody waits for the result.
#[derive(Debug)]
pub(super) struct MotionThread(JoinHandle<Result<Summary, SimulationError>>);

impl MotionThread {
    pub(super) fn start(model: Box<dyn Model>, ground: &GroundMotion, request: &Request) -> Self {
        let (ground, request) = (ground.clone(), *request);
        let simulate = move || model.simulate(&ground, &request, None);
        Self(thread::spawn(simulate))
    }

    /// Waits for the result. A panic of the thread continues in the caller.
    pub(super) fn wait(self) -> Result<Summary, SimulationError> {
        let joined = self.0.join();
        joined.unwrap_or_else(|panicked| panic::resume_unwind(panicked))
    }
}

/// Motions of variations that are being computed.
#[derive(Debug)]
pub struct Variations(Vec<(String, Result<MotionThread, String>)>);

impl Variations {
    /// Starts the computations.
    pub fn start(variations: Vec<Variation>, ground: &GroundMotion, request: &Request) -> Self {
        let running = |model| MotionThread::start(model, ground, request);
        let start = |variation: Variation| (variation.name, variation.model.map(running));
        Self(variations.into_iter().map(start).collect())
    }

    /// Waits for all results.
    pub fn wait(self) -> Vec<VariationResult> {
        let ended = |(name, running): (_, Result<MotionThread, String>)| VariationResult {
            name,
            result: running.and_then(|running| running.wait().map_err(|error| error.to_string())),
        };
        self.0.into_iter().map(ended).collect()
    }
}
