//! Several models of motion of one structure side by side: the result of each, the most reliable one, and the differences of the others.

use std::fmt::Write as _;

use super::{Run, RunResults};
use crate::dynamics::history::{Outcome, Summary};
use crate::dynamics::repeatability::Verdict;
use crate::dynamics::variation::Varied;
use crate::scenario::Hinges;

/// A table of the runs of one structure with different models of motion and their results, followed by the conclusion.
#[must_use]
pub fn compared(runs: &[RunResults<'_>]) -> String {
    let rows: Vec<[String; 3]> = runs
        .iter()
        .map(|RunResults { run, history, .. }| {
            let peak = match history.outcome {
                Outcome::Overturned(_) => String::new(),
                _ => format!("{:.6} rad", history.largest_rotation_rad()),
            };
            [run.name().to_owned(), ends(history), peak]
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
    text + &believed(runs)
}

fn ends(
    Summary {
        outcome,
        outcome_time_s,
        ..
    }: &Summary,
) -> String {
    match outcome {
        Outcome::NeverMoved | Outcome::Vibrates => outcome.to_string(),
        _ => format!("{outcome} at {outcome_time_s:.4} s"),
    }
}

/// The model with the fewest assumptions, the dependence of its outcome on its joints, and the differences of the other models.
fn believed(runs: &[RunResults<'_>]) -> String {
    let trust = |run: &Run<'_>| run.scenario.motion().hinges() as usize;
    let Some(best) = runs.iter().max_by_key(|results| trust(results.run)) else {
        return String::new();
    };
    let (best, own, varied) = (best.run, &best.history, &best.varied);
    let is_elastic = best.scenario.motion().hinges() == Hinges::Elastic;
    if own.outcome == Outcome::Incomplete {
        return format!(
            "  {}: no verdict, so there is nothing to compare\n",
            best.name()
        );
    }
    let mut text = match otherwise(own, varied) {
        Some(otherwise) => format!(
            "  {}: THE OUTCOME DEPENDS ON JOINT STIFFNESS AND CONTACT: it {} as given, and {otherwise}\n",
            best.name(),
            happens(own)
        ),
        None if is_elastic && !all_agree(own, varied) => format!(
            "  {} assume least, but the dependence of the outcome on joint stiffness is unknown\n",
            best.name()
        ),
        None => {
            let why = best.scenario.motion().hinges().model().trusted_because;
            format!("  believe {}: {why}\n", best.name())
        }
    };
    let others = runs.iter().map(|results| (results.run, &results.history));
    for (run, other) in others.filter(|(run, _)| trust(run) != trust(best)) {
        let (name, verdict) = (run.name(), Verdict::from(own.outcome));
        let late_s = other.outcome_time_s - own.outcome_time_s;
        let when = if late_s < 0.0 { "earlier" } else { "later" };
        let times = other.largest_rotation_rad() / own.largest_rotation_rad();
        let _ = match Verdict::from(other.outcome) {
            Verdict::Incomplete => Ok(()),
            other if other != verdict => writeln!(text, "  {name}: ANOTHER OUTCOME"),
            Verdict::Overturns => {
                let apart_s = late_s.abs();
                writeln!(text, "  {name}: overturns too, {apart_s:.4} s {when}")
            }
            _ if own.largest_rotation_rad() > 0.0 => {
                writeln!(
                    text,
                    "  {name}: survives too, with {times:.2} times that rotation"
                )
            }
            _ => Ok(()),
        };
    }
    text
}

/// The other ending of a motion, and the properties with which it occurs; `None` if there are none.
pub(super) fn otherwise(own: &Summary, varied: &[Varied]) -> Option<String> {
    let (opposite, otherwise) = match Verdict::from(own.outcome) {
        Verdict::Overturns => (Verdict::Survives, "survives"),
        Verdict::Survives => (Verdict::Overturns, "overturns"),
        Verdict::Incomplete | Verdict::Uncertain => return None,
    };
    let others = varied.iter().filter_map(|Varied { name, result }| {
        let other = Verdict::from(result.as_ref().ok()?.outcome);
        (other == opposite).then_some(name.as_str())
    });
    let others: Vec<&str> = others.collect();
    (!others.is_empty()).then(|| format!("{otherwise} with {}", others.join(" and with ")))
}

/// Whether the motion was computed with other properties, and ends alike with all of them.
fn all_agree(own: &Summary, varied: &[Varied]) -> bool {
    let own = Verdict::from(own.outcome);
    let agrees = |Varied { result, .. }: &Varied| {
        let other = result.as_ref().map(|other| Verdict::from(other.outcome));
        other.is_ok_and(|other| other == own)
    };
    !varied.is_empty() && varied.iter().all(agrees)
}

const fn happens(history: &Summary) -> &'static str {
    match history.outcome {
        Outcome::Overturned(_) => "overturns",
        _ => "survives",
    }
}
