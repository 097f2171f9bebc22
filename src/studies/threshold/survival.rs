//! The strengths of a ground motion that a structure survives, in one line of words that begins with the safe ones.

use super::Threshold;
use super::digits::{rounded, rounded_down};
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
    #[must_use]
    pub fn of_levels(levels: &[(f64, Option<Verdict>)]) -> Self {
        let runs = levels.chunk_by(|a, b| a.1 == b.1);
        let runs = runs.map(|run| (run[0].1, [run[0].0, run[run.len() - 1].0]));
        Self::of_runs(runs.collect())
    }

    /// Makes the survival of a threshold, with ranges that end at its edges.
    #[must_use]
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

    /// Returns the words for the smallest tried strengths: the safe ones, or the reason why none is known to be safe.
    fn first_words(&self, at: impl Fn(f64, fn(f64) -> String) -> String) -> String {
        let Some((verdict, [from, to])) = self.runs.first() else {
            return "no history".to_owned();
        };
        let what = match verdict {
            Some(Verdict::Survives) => {
                let all = if self.runs.len() == 1 {
                    ", the largest tried"
                } else {
                    ""
                };
                let safe = self.survives_up_to.unwrap_or(*to);
                return format!("survives up to {}{all}", at(safe, rounded_down));
            }
            Some(Verdict::Overturns) => "overturns",
            other => doubt(*other),
        };
        format!(
            "{what} at {} already, the smallest tried",
            at(*from, rounded)
        )
    }
}

/// Returns the words for a verdict that is neither survival nor overturning.
const fn doubt(verdict: Option<Verdict>) -> &'static str {
    match verdict {
        Some(Verdict::Uncertain) => "uncertain",
        Some(_) => "no verdict, since the run ends too early,",
        None => "not known",
    }
}

/// Verdicts without certainty.
const DOUBTS: [Option<Verdict>; 3] = [Some(Verdict::Uncertain), Some(Verdict::Incomplete), None];

/// Largest number of ranges of one verdict in a line of words.
const LISTED: usize = 6;

/// Returns the ranges with a verdict in words; `None` without such ranges.
fn listed(runs: &[Run], verdict: Option<Verdict>, unit: &str) -> Option<String> {
    let of_verdict = runs.iter().filter(|run| run.0 == verdict);
    let mut all: Vec<String> = of_verdict
        .map(|(_, ends)| match ends.map(rounded) {
            [from, to] if from == to => format!("{to}{unit}"),
            [from, to] => format!("{from} to {to}{unit}"),
        })
        .collect();
    let more = all.len().saturating_sub(LISTED);
    all.truncate(LISTED);
    all.extend((more > 0).then(|| format!("{more} more")));
    (!all.is_empty()).then(|| all.join(", "))
}

/// Returns the line of words: `survives up to 2.113; uncertain from there; certainly overturns from 2.401 (gaps above: 2.604 to 2.871)`. The unit
/// of strengths may be empty. For factors, `peak_g` is the peak ground acceleration at factor 1.
#[must_use]
pub fn in_words(survival: &Survival, unit: &str, peak_g: Option<f64>) -> String {
    let at = |strength: f64, rounded: fn(f64) -> String| match peak_g {
        Some(peak_g) => format!("{} ({} g)", rounded(strength), rounded(strength * peak_g)),
        None => format!("{}{unit}", rounded(strength)),
    };
    let runs = &survival.runs[..];
    let mut parts = vec![survival.first_words(at)];
    let overturns = |run: &Run| run.0 == Some(Verdict::Overturns);
    let first = runs.iter().position(overturns);
    // The ranges between the safe strengths and the first that overturns.
    let from = usize::from(survival.survives_up_to.is_some());
    let between = runs.get(from..first.unwrap_or(runs.len())).unwrap_or(&[]);
    match between {
        // The first words are about this range.
        [_] if from == 0 => {}
        [(verdict, _)] => parts.push(format!("{} from there", doubt(*verdict))),
        _ => parts.extend(DOUBTS.into_iter().filter_map(|verdict| {
            let ranges = listed(between, verdict, unit)?;
            Some(format!("{} at {ranges}", doubt(verdict)))
        })),
    }
    let certainly = if between.is_empty() { "" } else { "certainly " };
    match survival.overturns_from {
        Some(_) if first == Some(0) => {}
        Some(strength) => {
            let from = if survival.at_most {
                "at or below"
            } else {
                "from"
            };
            parts.push(format!(
                "{certainly}overturns {from} {}",
                at(strength, rounded)
            ));
        }
        None => {
            let known = runs.iter().rfind(|run| run.0.is_some());
            let all = known.filter(|_| !between.is_empty()).map(|run| run.1[1]);
            parts.extend(
                all.map(|to| format!("does not certainly overturn up to {}", at(to, rounded))),
            );
        }
    }
    let above = &runs[first.map_or(runs.len(), |first| first + 1)..];
    let named = [("gaps", Some(Verdict::Survives))]
        .into_iter()
        .chain(DOUBTS.map(|verdict| (doubt(verdict).trim_end_matches(','), verdict)));
    let above = named.filter_map(|(what, verdict)| {
        Some(format!("{what} above: {}", listed(above, verdict, unit)?))
    });
    let above = above.collect::<Vec<_>>().join("; ");
    let above = if above.is_empty() {
        above
    } else {
        format!(" ({above})")
    };
    parts.join("; ") + &above
}
