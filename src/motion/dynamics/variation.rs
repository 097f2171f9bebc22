//! Variations of a motion, with other values of uncertain properties.

use super::until::EndCondition;
use crate::dynamics::{GroundMotion, Model, Request, SimulationError, Summary};
use crate::work::Pending;

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

/// Motion whose summary is awaited later.
pub(super) type PendingMotion = Pending<Result<Summary, SimulationError>>;

/// Starts the computation of a motion, with the early end `until`.
pub(super) fn start_motion(
    model: Box<dyn Model>,
    until: EndCondition,
    (ground, request): (&GroundMotion, &Request),
) -> PendingMotion {
    let case = (ground.clone(), *request);
    Pending::start(move || model.simulate_until(until, &case))
}

/// Motions of variations that are being computed.
#[derive(Default)]
pub struct Variations(Vec<(String, Result<PendingMotion, String>)>);

impl Variations {
    /// Starts the computations.
    pub fn start(variations: Vec<Variation>, ground: &GroundMotion, request: &Request) -> Self {
        let running = |model| start_motion(model, EndCondition::End, (ground, request));
        let start = |variation: Variation| (variation.name, variation.model.map(running));
        Self(variations.into_iter().map(start).collect())
    }

    /// Waits for all results.
    pub fn wait(self) -> Vec<VariationResult> {
        let ended = |(name, running): (_, Result<PendingMotion, String>)| VariationResult {
            name,
            result: running.and_then(|running| running.wait().map_err(|error| error.to_string())),
        };
        self.0.into_iter().map(ended).collect()
    }
}
