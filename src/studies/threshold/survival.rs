//! The strengths of a ground motion that a structure survives, in one line of words that begins with the safe ones.

use serde::{Deserialize, Serialize};

use super::Threshold;
use super::digits::{format_edge, rounded_edge, rounded_range};
use super::first_edge::FirstEdge;
use crate::studies::ending::Verdict;

/// A range of tried strengths with one verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VerdictRange {
    /// The verdict; null without histories.
    pub verdict: Option<Verdict>,
    /// The smallest strength of the range.
    pub from: f64,
    /// The largest strength of the range.
    pub to: f64,
}

/// The strengths that a structure certainly survives, the smallest strength that certainly overturns it, and all ranges of one verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Survival {
    /// The largest strength up to which all tried strengths are certainly survived; `None` if the smallest tried strength is not.
    pub survives_up_to: Option<f64>,
    /// The smallest strength that certainly overturns the structure; `None` if no strength does.
    pub overturns_from: Option<f64>,
    /// True if smaller strengths may overturn the structure as well, because neighbouring histories have no verdict.
    pub at_most: bool,
    /// All ranges of tried strengths, ascending.
    pub ranges: Vec<VerdictRange>,
}

impl Survival {
    /// Makes a survival of ascending strengths with their verdicts; `None` for a strength without a history. Ranges extend from their first to
    /// their last strength.
    pub fn of_levels(levels: &[(f64, Option<Verdict>)]) -> Self {
        let runs = levels.chunk_by(|a, b| a.1 == b.1);
        let ranges = runs.map(|run| VerdictRange {
            verdict: run[0].1,
            from: run[0].0,
            to: run[run.len() - 1].0,
        });
        Self::of_ranges(ranges.collect())
    }

    /// Makes the survival of a threshold, with ranges that end at its edges.
    pub fn of_threshold(threshold: &Threshold) -> Self {
        let ranges = threshold.ranges.iter().map(|range| VerdictRange {
            verdict: range.verdict,
            from: range.from,
            to: range.to,
        });
        Self::of_ranges(ranges.collect())
    }

    /// Inserts the lowest band or uncertain strength that a finer search found, if all lower strengths survive.
    pub(in crate::studies) fn insert(&mut self, found: &FirstEdge) {
        let (uncertain, certain) = (found.uncertain_from, found.factor);
        let Some(first) = uncertain.into_iter().chain(certain).reduce(f64::min) else {
            return;
        };
        if self.survives_up_to.is_some_and(|safe| safe < first)
            || self
                .overturns_from
                .is_some_and(|overturns| overturns < first)
        {
            return;
        }
        self.survives_up_to = found.survives_up_to;
        if let Some(certain) = certain {
            self.overturns_from = Some(certain);
            self.at_most = false;
        }
        let (below, mut above): (Vec<_>, Vec<_>) =
            self.ranges.drain(..).partition(|range| range.from < first);
        let range = |verdict, from: f64, to: f64| VerdictRange {
            verdict: Some(verdict),
            from,
            to,
        };
        if let Some(safe) = found.survives_up_to {
            let from = below.first().map_or(safe, |range| range.from);
            self.ranges.push(range(Verdict::Survives, from, safe));
        }
        let verdict = if uncertain.is_some() {
            Verdict::Uncertain
        } else {
            Verdict::Overturns
        };
        self.ranges.push(range(verdict, first, first));
        // The rest of the range in which the strength was found.
        if let Some(rest) = below.last().filter(|rest| rest.to > first) {
            self.ranges.push(VerdictRange {
                from: found.tried_to,
                ..*rest
            });
        }
        self.ranges.append(&mut above);
    }

    /// Makes the survival of all ranges of tried strengths, ascending.
    pub(super) fn of_ranges(ranges: Vec<VerdictRange>) -> Self {
        let is = |verdict| move |range: &&VerdictRange| range.verdict == Some(verdict);
        let safe = ranges.first().filter(is(Verdict::Survives));
        let overturned = ranges.iter().find(is(Verdict::Overturns));
        Self {
            survives_up_to: safe.map(|range| range.to),
            overturns_from: overturned.map(|range| range.from),
            at_most: false,
            ranges,
        }
    }
}

/// Word before strengths with a verdict; those that are survived are gaps above others that overturn.
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

/// Largest number of ranges of one verdict that are listed in a line of words; of more, their number, the first and the last strength are given.
const LISTED: usize = 3;

/// Ranges of each kind in words, with `beside` between kind and ranges.
fn listed(
    ranges: &[VerdictRange],
    kinds: &[Option<Verdict>],
    beside: &str,
    unit: &str,
) -> Vec<String> {
    let of_kind = kinds.iter().filter_map(|kind| {
        let own = ranges.iter().filter(|range| range.verdict == *kind);
        let own: Vec<&VerdictRange> = own.collect();
        let in_words = |range: &&VerdictRange| match rounded_range([range.from, range.to]) {
            _ if range.from == range.to => format_edge(range.from) + unit,
            [from, to] => format!("{from} to {to}{unit}"),
        };
        let words = match &own[..] {
            [] => return None,
            [first, .., last] if own.len() > LISTED => {
                let [from, to] = [first.from, last.to].map(format_edge);
                format!("{} from {from} to {to}{unit}", own.len())
            }
            all => all.iter().map(in_words).collect::<Vec<_>>().join(", "),
        };
        Some(format!("{}{beside} {words}", word(*kind)))
    });
    of_kind.collect()
}

/// Line of words: `survives up to 2.113; uncertain above; certainly overturns at 2.401 (gaps above: 2.604 to 2.871)`. The unit
/// of strengths may be empty. For factors, `peak_g` is the peak ground acceleration at factor 1.
pub fn survival_in_words(survival: &Survival, unit: &str, peak_g: Option<f64>) -> String {
    let both = |strength: String, in_g: String| match peak_g {
        Some(_) => format!("{strength} ({in_g} g)"),
        None => strength + unit,
    };
    let to_g = peak_g.unwrap_or(1.0);
    let at =
        |strength: f64, format: fn(f64) -> String| both(format(strength), format(strength * to_g));
    let ends = [survival.survives_up_to, survival.overturns_from];
    let [own, in_g] = [1.0, to_g].map(|unit| rounded_edge(ends.map(|end| Some(end? * unit))));
    let ([safe, overturns_from], [safe_g, from_g]) = (own, in_g);
    let safe = safe.zip(safe_g).map(|(own, in_g)| both(own, in_g));
    let overturns_from = overturns_from
        .zip(from_g)
        .map(|(own, in_g)| both(own, in_g));
    let ranges = &survival.ranges[..];
    let Some(first) = ranges.first() else {
        return "no history".to_owned();
    };
    let mut parts = vec![match safe {
        Some(safe) => format!("survives up to {safe}"),
        None => {
            let (what, from) = (word(first.verdict), at(first.from, format_edge));
            format!("{what} at {from} already, the smallest tried")
        }
    }];
    let is = |verdict| move |range: &VerdictRange| range.verdict == Some(verdict);
    let overturns = ranges.iter().position(is(Verdict::Overturns));
    let (below, above) = ranges.split_at(overturns.unwrap_or(ranges.len()));
    let is_certain = below.iter().all(is(Verdict::Survives));
    match below.get(1..).unwrap_or_default() {
        [only] if survival.survives_up_to.is_some() => {
            parts.push(format!("{} above", word(only.verdict)));
        }
        between => parts.extend(listed(between, &KINDS[1..], " at", unit)),
    }
    let certainly = if is_certain { "" } else { "certainly " };
    let known = below.iter().rfind(|range| range.verdict.is_some());
    match (overturns_from, known) {
        (Some(strength), _) if !below.is_empty() => {
            let from = match is_certain {
                _ if survival.at_most => "at or below",
                true => "from",
                // Factors beside the uncertain ones may overturn it as well.
                false => "at",
            };
            parts.push(format!("{certainly}overturns {from} {strength}"));
        }
        (None, Some(_)) if is_certain => parts[0] += ", the largest tried",
        (None, Some(known)) => {
            let to = at(known.to, format_edge);
            parts.push(format!("does not certainly overturn up to {to}"));
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
