//! What a threshold depends on: the thresholds of the same structure with other properties that are as likely.

use std::ops::ControlFlow;

use super::Threshold;
use crate::bisection::{Width, try_bisect};
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::model::{Model, Request, SimulationError};
use crate::dynamics::spread::Verdict;
use crate::dynamics::variation::Variation;
use crate::studies::runner::{Progress, Runner, RunnerError};

/// The threshold of a variation.
#[derive(Clone, Debug, PartialEq)]
pub struct VariedThreshold {
    /// What differs, in words that follow "with".
    pub name: String,
    /// The factor from which it overturns, nearest to the lowest factor of the structure itself, to half a percent. `None` if there
    /// is none within a tenth to ten times that factor. Or why it is unknown.
    pub factor: Result<Option<f64>, String>,
}

/// Ratio of the factors between which a change is searched for.
const STRIDE: f64 = 1.25;
/// Largest ratio to the structure's own threshold in that search.
const FARTHEST: f64 = 10.0;
/// Relative width to which the change is bisected.
const WIDTH: f64 = 5e-3;

/// The thresholds of these variations, near the lowest factor of the structure itself; empty if it has none. Bands
/// elsewhere are not searched for, and no history is repeated.
///
/// # Errors
/// When `watch` breaks, or threads cannot be started.
pub fn vary(
    own: &Threshold,
    variations: &[Variation],
    ground: &GroundMotion,
    request: &Request,
    runner: &Runner,
    watch: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<VariedThreshold>, RunnerError> {
    let Some(own_factor) = own.lowest_factor() else {
        return Ok(Vec::new());
    };
    let search = |index: usize| {
        let Variation { name, model } = &variations[index];
        let factor = match model {
            Ok(model) => {
                least_near(&**model, ground, request, own_factor).map_err(|error| error.to_string())
            }
            Err(reason) => Err(reason.clone()),
        };
        VariedThreshold {
            name: name.clone(),
            factor,
        }
    };
    runner.each(variations.len(), search, watch)
}

fn least_near(
    model: &dyn Model,
    ground: &GroundMotion,
    request: &Request,
    own: f64,
) -> Result<Option<f64>, SimulationError> {
    let overturns = |factor: f64| {
        let history = model.simulate(&ground.scaled(factor)?, request, None)?;
        Ok::<_, SimulationError>(Verdict::from(history.outcome) == Verdict::Overturns)
    };
    let falls = overturns(own)?;
    // Downwards if the factor overturns, upwards if it does not.
    let stride = if falls { 1.0 / STRIDE } else { STRIDE };
    let mut last = own;
    loop {
        let next = last * stride;
        if !(own / FARTHEST..=own * FARTHEST).contains(&next) {
            return Ok(None);
        }
        if overturns(next)? != falls {
            let (low, high) = if falls { (next, last) } else { (last, next) };
            let edge = try_bisect(low, high, Width::Relative(WIDTH), overturns)?;
            return Ok(Some(edge.1));
        }
        last = next;
    }
}
