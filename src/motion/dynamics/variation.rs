//! Variations of a motion: other values of properties that are uncertain.

use std::panic;
use std::thread::{self, JoinHandle};

use super::ground::GroundMotion;
use super::history::Summary;
use super::model::{Model, Request, SimulationError};

/// A copy of a model with a property that is equally likely.
#[derive(Debug)]
pub struct Variation {
    /// The difference, in words that follow "with".
    pub name: String,
    /// The model; or why the structure does not stand.
    pub model: Result<Box<dyn Model>, String>,
}

/// The outcome of a variation.
#[derive(Clone, Debug)]
pub struct Varied {
    /// The difference.
    pub name: String,
    /// Its motion; or why there is none.
    pub result: Result<Summary, String>,
}

/// A motion that is computed on a thread of its own. If nobody waits for it, it ends with the program.
#[derive(Debug)]
pub(super) struct Running(JoinHandle<Result<Summary, SimulationError>>);

impl Running {
    pub(super) fn start(model: Box<dyn Model>, ground: &GroundMotion, request: &Request) -> Self {
        let (ground, request) = (ground.clone(), *request);
        let simulate = move || model.simulate(&ground, &request, None);
        Self(thread::spawn(simulate))
    }

    /// Waits for it. A panic of its thread continues here.
    pub(super) fn ended(self) -> Result<Summary, SimulationError> {
        let joined = self.0.join();
        joined.unwrap_or_else(|panicked| panic::resume_unwind(panicked))
    }
}

/// The motions of variations, while they are computed.
#[derive(Debug)]
pub struct Variations(Vec<(String, Result<Running, String>)>);

impl Variations {
    /// Starts them.
    #[must_use]
    pub fn start(variations: Vec<Variation>, ground: &GroundMotion, request: &Request) -> Self {
        let running = |model| Running::start(model, ground, request);
        let start = |variation: Variation| (variation.name, variation.model.map(running));
        Self(variations.into_iter().map(start).collect())
    }

    /// Waits for them.
    #[must_use]
    pub fn ended(self) -> Vec<Varied> {
        let ended = |(name, running): (_, Result<Running, String>)| Varied {
            name,
            result: running.and_then(|running| running.ended().map_err(|error| error.to_string())),
        };
        self.0.into_iter().map(ended).collect()
    }
}
