//! Comparison of several models of motion of one structure: the result of each, the most reliable one, and the differences of the others.

use std::fmt::Write as _;

use super::ModelResults;
use super::caveats::vibrates_since_s;
use crate::dynamics::variation::VariationResult;
use crate::scenario::MODELS;
use crate::{Outcome, Summary as History, Verdict};

/// Returns a table of the runs of one structure with different models of motion, followed by the conclusion.
pub(super) fn comparison_words(runs: &[ModelResults<'_>]) -> String {
    let rows: Vec<[String; 3]> = runs
        .iter()
        .map(|results| {
            let (run, history) = (results.run, &results.history);
            let peak = match history.outcome {
                Outcome::Overturned(_) => String::new(),
                _ => format!("{:.6} rad", history.largest_rotation_rad()),
            };
            [run.label().to_owned(), outcome_words(results), peak]
        })
        .collect();
    let header = ["model", "what happened", "largest rotation"].map(str::to_owned);
    let wide = [0, 1].map(|column| {
        let cells = rows.iter().chain([&header]);
        cells.map(|row| row[column].len()).max().unwrap_or(0)
    });
    let mut text = String::new();
    for [model, ends, peak] in [&header].into_iter().chain(&rows) {
        let line = format!("  {model:0$}  {ends:1$}  {peak}", wide[0], wide[1]);
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text + &conclusion(runs)
}

fn outcome_words(results: &ModelResults<'_>) -> String {
    let history = &results.history;
    let uncertain = match results.verdict {
        Verdict::Uncertain => " (uncertain)",
        _ => "",
    };
    match history.outcome {
        outcome @ (Outcome::NeverMoved | Outcome::Vibrates) => format!("{outcome}{uncertain}"),
        _ if vibrates_since_s(history).is_some() => {
            format!(
                "still vibrates at {:.4} s{uncertain}",
                history.outcome_time_s
            )
        }
        outcome => format!("{outcome} at {:.4} s{uncertain}", history.outcome_time_s),
    }
}

/// Returns the differences between the model with the fewest assumptions and the others.
fn conclusion(runs: &[ModelResults<'_>]) -> String {
    let rank = |results: &ModelResults<'_>| {
        let kind = results.run.scenario.motion.kind;
        MODELS.iter().position(|model| *model == kind)
    };
    let best = runs.iter().max_by_key(|results| rank(results));
    let others = best.into_iter().flat_map(|best| {
        let others = runs.iter().filter(|results| rank(results) != rank(best));
        others.filter_map(|other| {
            let (name, best_name) = (other.run.label(), best.run.label());
            let differs = difference(best, other)?;
            Some(format!("{name}, compared with {best_name}: {differs}"))
        })
    });
    others.map(|line| format!("  {line}\n")).collect()
}

/// Returns the difference of a model from the one with the fewest assumptions, in words; `None` if one has no verdict, or none moves.
fn difference(best: &ModelResults<'_>, other: &ModelResults<'_>) -> Option<String> {
    let late_s = other.history.outcome_time_s - best.history.outcome_time_s;
    let when = if late_s < 0.0 { "earlier" } else { "later" };
    let [own_rad, other_rad] = [best, other].map(|one| one.history.largest_rotation_rad());
    Some(match (best.verdict, other.verdict) {
        (Verdict::Incomplete, _) | (_, Verdict::Incomplete) => return None,
        (Verdict::Uncertain, other) => other.name().to_owned(),
        (own, other) if other != own => format!(
            "ANOTHER OUTCOME: {} instead of {}",
            other.name(),
            own.name()
        ),
        (Verdict::Overturns, _) => format!("overturns too, {:.4} s {when}", late_s.abs()),
        _ if own_rad == 0.0 => return None,
        _ => format!(
            "survives too, with {:.2} times that rotation",
            other_rad / own_rad
        ),
    })
}

/// Returns the opposite outcome and the properties with which it occurs, in words; `None` if no property changes the outcome.
pub(super) fn changed_outcome(own: &History, varied: &[VariationResult]) -> Option<String> {
    let (opposite, verb) = match Verdict::from(own.outcome) {
        Verdict::Overturns => (Verdict::Survives, "survives"),
        Verdict::Survives => (Verdict::Overturns, "overturns"),
        _ => return None,
    };
    let others = varied.iter().filter_map(|one| {
        let other = Verdict::from(one.result.as_ref().ok()?.outcome);
        (other == opposite).then_some(one.name.as_str())
    });
    let others: Vec<&str> = others.collect();
    (!others.is_empty()).then(|| format!("{verb} with {}", others.join(" and with ")))
}

/// Returns the properties with which the motion has no verdict, in words; `None` if it has one with all.
pub(super) fn without_verdict(varied: &[VariationResult]) -> Option<String> {
    let ends_early = |history: &History| history.outcome == Outcome::Incomplete;
    let unknown = |one: &&VariationResult| one.result.as_ref().map_or(true, ends_early);
    let names = varied.iter().filter(unknown).map(|one| one.name.as_str());
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| format!("no verdict with {}", names.join(" and with ")))
}
