//! What a motion depends on: the same motion with other values of properties that are not known exactly.

use std::panic;
use std::thread::{self, JoinHandle};

use super::ground::GroundMotion;
use super::history::Summary;
use super::model::{Model, Request, SimulationError};

/// A copy of a model with a property that is equally likely.
#[derive(Debug)]
pub struct Variation {
    /// What is different, in words that follow "with".
    pub name: String,
    /// The same structure; or why it does not stand.
    pub model: Result<Box<dyn Model>, String>,
}

/// The outcome of a variation.
#[derive(Clone, Debug)]
pub struct Varied {
    /// What is different.
    pub name: String,
    /// Its motion; or why there is none.
    pub result: Result<Summary, String>,
}

/// The motions of variations, computed on threads of their own. If the motion itself fails nobody waits for them.
#[derive(Debug)]
pub struct Variations(Vec<(String, Result<Running, String>)>);

type Running = JoinHandle<Result<Summary, SimulationError>>;

impl Variations {
    /// Starts them.
    #[must_use]
    pub fn start(variations: Vec<Variation>, ground: &GroundMotion, request: &Request) -> Self {
        let start = |Variation { name, model }| {
            let running = model.map(|model| {
                let (ground, request) = (ground.clone(), *request);
                thread::spawn(move || model.simulate(&ground, &request, None))
            });
            (name, running)
        };
        Self(variations.into_iter().map(start).collect())
    }

    /// Waits for them.
    #[must_use]
    pub fn ended(self) -> Vec<Varied> {
        let ended = |(name, running): (String, Result<Running, String>)| {
            let result = running.and_then(|running| {
                let ended = running.join();
                let ended = ended.unwrap_or_else(|panicked| panic::resume_unwind(panicked));
                ended.map_err(|error| error.to_string())
            });
            Varied { name, result }
        };
        self.0.into_iter().map(ended).collect()
    }
}
