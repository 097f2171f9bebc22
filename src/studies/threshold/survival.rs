//! The strengths of a ground motion that a structure survives, in one line of words that begins with the safe ones.

use super::Threshold;
use super::digits::{rounded, rounded_down, rounded_range};
use crate::studies::ending::Verdict;

/// A range of strengths with one verdict; `None` without histories.
type Run = (Option<Verdict>, [f64; 2]);

/// The strengths that a structure certainly survives, the smallest strength that certainly overturns it, and all ranges of one verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Survival {
    /// The largest strength up to which all tried strengths are certainly survived; `None` if the smallest tried strength is not.
    pub survives_up_to: Option<f64>,
    /// The smallest strength that certainly overturns the structure; `None` if no strength does.
    pub overturns_from: Option<f64>,
    /// True if smaller strengths may overturn the structure as well, because neighbouring histories have no verdict.
    pub at_most: bool,
    /// All ranges of tried strengths, ascending.
    pub runs: Vec<Run>,
}

impl Survival {
    /// Makes a survival of ascending strengths with their verdicts; `None` for a strength without a history. Ranges extend from their first to
    /// their last strength.
    pub fn of_levels(levels: &[(f64, Option<Verdict>)]) -> Self {
        let runs = levels.chunk_by(|a, b| a.1 == b.1);
        let runs = runs.map(|run| (run[0].1, [run[0].0, run[run.len() - 1].0]));
        Self::of_runs(runs.collect())
    }

    /// Makes the survival of a threshold, with ranges that end at its edges.
    pub fn of_threshold(threshold: &Threshold) -> Self {
        let mut ranges = threshold.ranges.iter();
        let samples = threshold
            .samples
            .chunk_by(|a, b| a.verdict() == b.verdict());
        let runs = samples.map(|run| match run[0].verdict().and_then(|_| ranges.next()) {
            Some((verdict, range)) => (Some(*verdict), [range.from, range.to]),
            None => (None, [run[0].factor, run[run.len() - 1].factor]),
        });
        Self::of_runs(runs.collect())
    }

    fn of_runs(runs: Vec<Run>) -> Self {
        let safe = runs.first().filter(|run| run.0 == Some(Verdict::Survives));
        let mut overturned = runs.iter().filter(|run| run.0 == Some(Verdict::Overturns));
        Self {
            survives_up_to: safe.map(|run| run.1[1]),
            overturns_from: overturned.next().map(|run| run.1[0]),
            at_most: false,
            runs,
        }
    }
}

/// Returns the word before strengths with a verdict; those that are survived are gaps above others that overturn.
const fn word(verdict: Option<Verdict>) -> &'static str {
    match verdict {
        Some(Verdict::Survives) => "gaps",
        Some(Verdict::Incomplete) => "no verdict",
        Some(Verdict::Uncertain) => "uncertain",
        Some(Verdict::Overturns) => "overturns",
        _ => "not known",
    }
}

/// Verdicts whose ranges are listed.
const KINDS: [Option<Verdict>; 4] = [
    Some(Verdict::Survives),
    Some(Verdict::Uncertain),
    Some(Verdict::Incomplete),
    None,
];

/// Largest number of ranges of one verdict in a line of words.
const LISTED: usize = 6;

/// Returns the ranges of each kind in words, with `beside` between kind and ranges.
fn listed(runs: &[Run], kinds: &[Option<Verdict>], beside: &str, unit: &str) -> Vec<String> {
    let of_kind = kinds.iter().filter_map(|kind| {
        let of_kind = runs.iter().filter(|run| run.0 == *kind);
        let mut all: Vec<String> = of_kind
            .map(|(_, ends)| match rounded_range(*ends) {
                _ if ends[0] == ends[1] => rounded(ends[0]) + unit,
                [from, to] => format!("{from} to {to}{unit}"),
            })
            .collect();
        let more = all.len().saturating_sub(LISTED);
        all.truncate(LISTED);
        all.extend((more > 0).then(|| format!("{more} more")));
        (!all.is_empty()).then(|| format!("{}{beside} {}", word(*kind), all.join(", ")))
    });
    of_kind.collect()
}

/// Returns the line of words: `survives up to 2.113; uncertain from there; certainly overturns from 2.401 (gaps above: 2.604 to 2.871)`. The unit
/// of strengths may be empty. For factors, `peak_g` is the peak ground acceleration at factor 1.
pub fn in_words(survival: &Survival, unit: &str, peak_g: Option<f64>) -> String {
    let at = |strength: f64, rounded: fn(f64) -> String| match peak_g {
        Some(peak_g) => format!("{} ({} g)", rounded(strength), rounded(strength * peak_g)),
        None => rounded(strength) + unit,
    };
    let runs = &survival.runs[..];
    let Some((verdict, [from, _])) = runs.first() else {
        return "no history".to_owned();
    };
    let mut parts = vec![match survival.survives_up_to {
        Some(safe) => format!("survives up to {}", at(safe, rounded_down)),
        None => {
            let (what, from) = (word(*verdict), at(*from, rounded));
            format!("{what} at {from} already, the smallest tried")
        }
    }];
    let overturns = runs
        .iter()
        .position(|run| run.0 == Some(Verdict::Overturns));
    let (below, above) = runs.split_at(overturns.unwrap_or(runs.len()));
    let is_certain = below.iter().all(|run| run.0 == Some(Verdict::Survives));
    match below.get(1..).unwrap_or_default() {
        [(verdict, _)] if survival.survives_up_to.is_some() => {
            parts.push(format!("{} from there", word(*verdict)));
        }
        between => parts.extend(listed(between, &KINDS[1..], " at", unit)),
    }
    let certainly = if is_certain { "" } else { "certainly " };
    let known = below.iter().rfind(|run| run.0.is_some());
    match (survival.overturns_from, known) {
        (Some(strength), _) if !below.is_empty() => {
            let strength = at(strength, rounded);
            let from = if survival.at_most {
                "at or below"
            } else {
                "from"
            };
            parts.push(format!("{certainly}overturns {from} {strength}"));
        }
        (None, Some(_)) if is_certain => parts[0] += ", the largest tried",
        (None, Some((_, [_, to]))) => {
            parts.push(format!(
                "does not certainly overturn up to {}",
                at(*to, rounded)
            ));
        }
        _ => {}
    }
    let above = listed(above, &KINDS, " above:", unit).join("; ");
    let above = if above.is_empty() {
        above
    } else {
        format!(" ({above})")
    };
    parts.join("; ") + &above
}
