//! Several models of motion of one structure side by side: the result of each, which to believe, and how far the others differ.

use std::fmt::Write as _;

use super::Run;
use crate::dynamics::history::{Outcome, Summary};
use crate::dynamics::spread::Verdict;
use crate::scenario::Hinges;

/// A table of the runs of one structure with different models of motion and their results, followed by the conclusion.
#[must_use]
pub fn compared(runs: &[Run<'_>], histories: &[Summary]) -> String {
    let rows: Vec<[String; 3]> = runs
        .iter()
        .zip(histories)
        .map(|(run, history)| {
            let peak = match history.outcome {
                Outcome::Overturned(_) => String::new(),
                _ => format!("{:.6} rad", history.largest_rotation_rad()),
            };
            [run.name().to_owned(), ends(history), peak]
        })
        .collect();
    let header = ["model", "what happens", "largest rotation"].map(str::to_owned);
    let wide = [0, 1].map(|column| {
        let cells = rows.iter().chain([&header]);
        cells.map(|row| row[column].len()).max().unwrap_or(0)
    });
    let mut text = String::new();
    for [model, ends, peak] in [&header].into_iter().chain(&rows) {
        let line = format!("  {model:0$}  {ends:1$}  {peak}", wide[0], wide[1]);
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text + &believed(runs, histories)
}

fn ends(history: &Summary) -> String {
    let time_s = history.outcome_time_s;
    match history.outcome {
        Outcome::NeverMoved => "never moves".to_owned(),
        Outcome::Vibrates => "vibrates without opening".to_owned(),
        Outcome::Incomplete => format!("no verdict: the run ends too early, at {time_s:.4} s"),
        Outcome::Rest => format!("rests at {time_s:.4} s"),
        Outcome::Overturned(sway) => format!("overturns to the {} at {time_s:.4} s", sway.name()),
        Outcome::StillRocking => format!("still rocks at {time_s:.4} s"),
    }
}

/// The model with the fewest assumptions, and how the others differ from its answer.
fn believed(runs: &[Run<'_>], histories: &[Summary]) -> String {
    let trust = |run: &Run<'_>| match run.scenario.motion().hinges() {
        Hinges::Four => 0,
        Hinges::Free => 1,
        Hinges::Elastic => 2,
    };
    let all = runs.iter().zip(histories);
    let Some((best, own)) = all.clone().max_by_key(|(run, _)| trust(run)) else {
        return String::new();
    };
    let why = match best.scenario.motion().hinges() {
        Hinges::Elastic => "joints of stone give way, by as much as the stiffness says",
        Hinges::Free => "hinges open at any joint",
        Hinges::Four => "it is the only one",
    };
    let mut text = format!("  believe {}: {why}\n", best.name());
    for (run, other) in all.filter(|(run, _)| trust(run) != trust(best)) {
        let [own_verdict, other_verdict] = [own, other].map(|one| Verdict::from(one.outcome));
        let (own_rad, other_rad) = (own.largest_rotation_rad(), other.largest_rotation_rad());
        let _ = if own_verdict != other_verdict {
            writeln!(text, "  {}: ANOTHER OUTCOME", run.name())
        } else if own_verdict == Verdict::Overturns {
            let late_s = other.outcome_time_s - own.outcome_time_s;
            writeln!(
                text,
                "  {}: overturns too, {late_s:+.4} s later",
                run.name()
            )
        } else if own_rad > 0.0 {
            let times = other_rad / own_rad;
            writeln!(
                text,
                "  {}: the same, with {times:.2} times that rotation",
                run.name()
            )
        } else {
            Ok(())
        };
    }
    text
}
