//! Comparison of several models of motion of one structure: the result of each, the most reliable one, and the differences of the others.

use std::fmt::Write as _;

use super::{ModelResults, Run};
use crate::dynamics::history::{Outcome, Summary as History};
use crate::dynamics::repeatability::Verdict;
use crate::dynamics::variation::VariationResult;
use crate::scenario::Hinges;

/// Returns a table of the runs of one structure with different models of motion, followed by the conclusion.
pub(super) fn comparison_words(runs: &[ModelResults<'_>]) -> String {
    let rows: Vec<[String; 3]> = runs
        .iter()
        .map(|ModelResults { run, history, .. }| {
            let peak = match history.outcome {
                Outcome::Overturned(_) => String::new(),
                _ => format!("{:.6} rad", history.largest_rotation_rad()),
            };
            [run.name().to_owned(), outcome_words(history), peak]
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

fn outcome_words(history: &History) -> String {
    match history.outcome {
        outcome @ (Outcome::NeverMoved | Outcome::Vibrates) => outcome.to_string(),
        outcome => format!("{outcome} at {:.4} s", history.outcome_time_s),
    }
}

/// Returns the conclusion: the model with the fewest assumptions, the dependence of its outcome on its joints, and the differences of the other
/// models.
fn conclusion(runs: &[ModelResults<'_>]) -> String {
    let rank = |run: &Run<'_>| run.scenario.motion.hinges() as usize;
    let Some(best) = runs.iter().max_by_key(|results| rank(results.run)) else {
        return String::new();
    };
    let (best, own, varied) = (best.run, &best.history, &best.varied);
    let is_elastic = best.scenario.motion.hinges() == Hinges::Elastic;
    let name = best.name();
    let happens = match own.outcome {
        Outcome::Incomplete => {
            return format!("  {name}: no verdict, so there is nothing to compare\n");
        }
        Outcome::Overturned(_) => "overturns",
        _ => "survives",
    };
    let mut text = match changed_outcome(own, varied) {
        Some(change) => format!(
            "  {name}: THE OUTCOME DEPENDS ON JOINT STIFFNESS AND CONTACT: it {happens} as given, and {change}\n"
        ),
        None if is_elastic && !all_agree(own, varied) => {
            format!(
                "  {name} assume least, but the dependence of the outcome on joint stiffness is unknown\n"
            )
        }
        None => {
            let why = best.scenario.motion.hinges().model().trusted_because;
            format!("  believe {name}: {why}\n")
        }
    };
    let others = runs.iter().map(|results| (results.run, &results.history));
    for (run, other) in others.filter(|(run, _)| rank(run) != rank(best)) {
        let (name, verdict) = (run.name(), Verdict::from(own.outcome));
        let late_s = other.outcome_time_s - own.outcome_time_s;
        let when = if late_s < 0.0 { "earlier" } else { "later" };
        let times = other.largest_rotation_rad() / own.largest_rotation_rad();
        let differs = match Verdict::from(other.outcome) {
            Verdict::Incomplete => continue,
            other if other != verdict => "ANOTHER OUTCOME".to_owned(),
            Verdict::Overturns => format!("overturns too, {:.4} s {when}", late_s.abs()),
            _ if own.largest_rotation_rad() == 0.0 => continue,
            _ => format!("survives too, with {times:.2} times that rotation"),
        };
        let _ = writeln!(text, "  {name}: {differs}");
    }
    text
}

/// Returns the opposite outcome and the properties with which it occurs, in words; `None` if no property changes the outcome.
pub(super) fn changed_outcome(own: &History, varied: &[VariationResult]) -> Option<String> {
    let (opposite, verb) = match Verdict::from(own.outcome) {
        Verdict::Overturns => (Verdict::Survives, "survives"),
        Verdict::Survives => (Verdict::Overturns, "overturns"),
        Verdict::Incomplete | Verdict::Uncertain => return None,
    };
    let others = varied.iter().filter_map(|one| {
        let other = Verdict::from(one.result.as_ref().ok()?.outcome);
        (other == opposite).then_some(one.name.as_str())
    });
    let others: Vec<&str> = others.collect();
    (!others.is_empty()).then(|| format!("{verb} with {}", others.join(" and with ")))
}

/// Returns true if the motion was computed with other properties, and all outcomes agree.
fn all_agree(own: &History, varied: &[VariationResult]) -> bool {
    let own = Verdict::from(own.outcome);
    let ends = varied.iter().map(|one| one.result.as_ref());
    let mut agree = ends.map(|end| end.is_ok_and(|other| Verdict::from(other.outcome) == own));
    !varied.is_empty() && agree.all(|agrees| agrees)
}
