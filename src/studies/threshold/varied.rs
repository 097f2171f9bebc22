//! Thresholds of a structure with other stiffness and contact, and with rigid joints.

use std::cell::Cell;
use std::ops::ControlFlow;

use super::first_edge::find_lowest_strength;
use super::{EDGE_WIDTH, Factors, SearchedFactors, threshold};
use crate::dynamics::{Directions, Variation};
use crate::studies::ending::answer_valid_cases;
use crate::studies::runner::{Progress, Runner, RunnerError};
use crate::studies::{StudyError, Watch};
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
    /// The largest factor up to which the structure with this property certainly survives, from repeated histories; `None` inside if it does not
    /// certainly survive the first factor, `None` outside if the histories were not repeated.
    pub repeated: Option<Option<f64>>,
}

/// Part of the lowest factor of a variation from which its histories are repeated.
const REPEATED_FROM: f64 = 0.8;

impl VariedThreshold {
    /// Largest factor that the structure with this property survives; `None` if it survives all.
    pub fn survives_up_to(&self) -> Option<f64> {
        let lowest = self.factor.as_ref().ok().copied().flatten();
        match self.repeated {
            Some(repeated) => Some(repeated.unwrap_or(0.0)),
            None => lowest.map(|factor| factor / (1.0 + EDGE_WIDTH)),
        }
    }
}

/// Repeats the histories of the variation that governs a quote, which survives less than `safe` and than all others, until the governing one has been
/// repeated.
///
/// # Errors
/// When `watch` returns `Break`, or threads cannot be started.
pub fn repeat_governing(
    varied: &mut [VariedThreshold],
    variations: &[Variation],
    (safe, searched): (f64, &SearchedFactors),
    (directions, ground, request): (Directions, &GroundMotion, &Request),
    runner: &Runner,
    watch: Watch<'_>,
) -> Result<(), StudyError> {
    loop {
        let known = varied
            .iter()
            .enumerate()
            .filter_map(|(index, one)| Some((index, one.survives_up_to()?)));
        let governing = known.min_by(|(_, one), (_, other)| one.total_cmp(other));
        let Some((index, factor)) = governing.filter(|(_, factor)| *factor < safe) else {
            return Ok(());
        };
        let (one, variation) = (&mut varied[index], &variations[index]);
        let (None, Ok(model)) = (one.repeated, &variation.model) else {
            return Ok(());
        };
        let mut from = searched.from.max(REPEATED_FROM * factor);
        loop {
            let to = Some(factor.max(from * (1.0 + EDGE_WIDTH)));
            let factors = Factors {
                from: Some(from),
                to,
                stride: searched.stride,
            };
            let named = (variation.name.as_str(), &**model);
            let found = threshold(
                named,
                (directions, ground),
                request,
                &factors,
                runner,
                &mut *watch,
            )?;
            one.repeated = Some(found.survives_up_to());
            if found.survives_up_to().is_some() || from == searched.from {
                break;
            }
            from = searched.from;
        }
    }
}

/// Number of histories that are computed together; some models are faster that way.
const TOGETHER: usize = 4;

/// Computes the thresholds of variations under a ground motion, and under the mirrored one if `has_second` is true. Histories are not repeated, and stop once they can no longer overturn.
///
/// # Errors
/// When `watch` returns `Break`, or threads cannot be started.
pub fn vary(
    variations: &[Variation],
    factors: &SearchedFactors,
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
            repeated: None,
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
        let histories = answer_valid_cases(cases, |cases| {
            model.simulate_all_until(EndCondition::Safe, cases)
        });
        factors.iter().copied().zip(histories).collect()
    };
    let histories = factors
        .chunks(TOGETHER)
        .flat_map(histories)
        .map(|(factor, history)| (factor, falls(history)));
    find_lowest_strength(histories, EDGE_WIDTH, |factor| {
        falls(model.simulate_until(EndCondition::Safe, &case(factor)?))
    })
}
