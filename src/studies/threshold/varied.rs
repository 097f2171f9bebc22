//! Thresholds of a structure with other stiffness and contact, and with rigid joints.

use std::cell::Cell;
use std::ops::ControlFlow;

use super::first_edge::lowest;
use super::{EDGE_WIDTH, Factors};
use crate::dynamics::Variation;
use crate::studies::ending::answered;
use crate::studies::runner::{Progress, Runner, RunnerError};
use crate::{Case, EndCondition, GroundMotion, Model, Request, SimulationError, Summary, Verdict};

/// The threshold of a variation.
#[derive(Clone, Debug, PartialEq)]
pub struct VariedThreshold {
    /// The changed property, in words that follow "with".
    pub name: String,
    /// The lowest factor that overturns the structure with this property in any direction, searched among the sampled factors of the structure itself; the first
    /// factor if it already overturns the structure, `None` if no factor does. The error is the reason why the factor is unknown.
    pub factor: Result<Option<f64>, String>,
    /// Number of histories of the search that ended too early for a verdict.
    pub incomplete: usize,
}

/// Number of histories that are computed together; some models are faster that way.
const TOGETHER: usize = 4;

/// Computes the thresholds of variations under a ground motion, and under the mirrored one if `has_second` is true. Histories are not repeated, and stop once they can no longer overturn.
///
/// # Errors
/// When `watch` returns `Break`, or threads cannot be started.
pub fn vary(
    variations: &[Variation],
    factors: &Factors,
    (ground, request, has_second): (&GroundMotion, &Request, bool),
    runner: &Runner,
    watch: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<VariedThreshold>, RunnerError> {
    let factors = factors.values();
    let mirrored = has_second.then(|| ground.mirrored());
    let search = |index: usize| {
        let Variation { name, model } = &variations[index];
        let incomplete = Cell::new(0);
        let factor = match model {
            Ok(model) => {
                let lowest = |ground: &GroundMotion, factors: &[f64]| {
                    lowest_factor_of(&**model, (ground, request), factors, &incomplete)
                        .map_err(|error| error.to_string())
                };
                lowest(ground, &factors).and_then(|first| {
                    let Some(mirrored) = &mirrored else {
                        return Ok(first);
                    };
                    let below = |factor: &f64| first.is_none_or(|first| *factor < first);
                    let end = factors.partition_point(below) + 1;
                    let second = lowest(mirrored, &factors[..end.min(factors.len())])?;
                    Ok(first.into_iter().chain(second).reduce(f64::min))
                })
            }
            Err(reason) => Err(reason.clone()),
        };
        VariedThreshold {
            name: name.clone(),
            factor,
            incomplete: incomplete.get(),
        }
    };
    runner.each(variations.len(), search, watch)
}

/// Finds the lowest factor that overturns a model, and counts the histories without a verdict.
fn lowest_factor_of(
    model: &dyn Model,
    (ground, request): (&GroundMotion, &Request),
    factors: &[f64],
    incomplete: &Cell<usize>,
) -> Result<Option<f64>, SimulationError> {
    let falls = |history: Result<Summary, SimulationError>| {
        history.map(|history| {
            let verdict = Verdict::from(history.outcome);
            incomplete.set(incomplete.get() + usize::from(verdict == Verdict::Incomplete));
            verdict == Verdict::Overturns
        })
    };
    let case =
        |factor: f64| -> Result<Case, SimulationError> { Ok((ground.scaled(factor)?, *request)) };
    let histories = |factors: &[f64]| -> Vec<(f64, Result<Summary, SimulationError>)> {
        let cases = factors.iter().map(|factor| case(*factor));
        let histories = answered(cases, |cases| {
            model.simulate_all_until(EndCondition::Safe, cases)
        });
        factors.iter().copied().zip(histories).collect()
    };
    let histories = factors.chunks(TOGETHER).flat_map(histories);
    let histories = histories.map(|(factor, history)| (factor, falls(history)));
    lowest(histories, EDGE_WIDTH, |factor| {
        falls(model.simulate_until(EndCondition::Safe, &case(factor)?))
    })
}
