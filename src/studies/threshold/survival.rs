//! The strengths of a ground motion that a structure survives, in one line of words.

use super::Threshold;
use super::digits::rounded;
use crate::studies::ending::Verdict;

/// The smallest strength that overturns a structure, and the ranges of larger strengths that it survives, or whose verdict is uncertain.
#[derive(Clone, Debug, PartialEq)]
pub struct Survival {
    /// The smallest strength that certainly overturns the structure; `None` if no strength does.
    pub overturns_from: Option<f64>,
    /// True if `overturns_from` is the smallest tried strength, so that a smaller one might overturn the structure too.
    pub from_the_first: bool,
    /// True if smaller strengths may overturn the structure as well, because neighbouring histories have no verdict.
    pub at_most: bool,
    /// Ranges of larger strengths that the structure certainly survives.
    pub again: Vec<[f64; 2]>,
    /// Ranges of strengths with an uncertain verdict.
    pub uncertain: Vec<[f64; 2]>,
    /// Ranges of strengths whose histories end too early for a verdict.
    pub incomplete: Vec<[f64; 2]>,
    /// The largest tried strength.
    pub tried_to: f64,
}

impl Survival {
    /// Makes a survival of ascending strengths with their verdicts; `None` for a strength without a history. Ranges extend from their first to
    /// their last strength.
    #[must_use]
    pub fn of_levels(levels: &[(f64, Option<Verdict>)]) -> Self {
        let known = levels.iter();
        let known = known.filter_map(|(level, verdict)| Some((*level, (*verdict)?)));
        let known: Vec<(f64, Verdict)> = known.collect();
        let runs = known.chunk_by(|a, b| a.1 == b.1);
        let runs = runs.map(|run| (run[0].1, [run[0].0, run[run.len() - 1].0]));
        let tried = [known.first(), known.last()].map(|end| end.map_or(0.0, |end| end.0));
        Self::of_runs(&runs.collect::<Vec<_>>(), tried)
    }

    /// Makes the survival of a threshold, with ranges that end at its edges.
    #[must_use]
    pub fn of_threshold(threshold: &Threshold) -> Self {
        let tried = threshold.samples.iter();
        let tried = tried.filter(|sample| sample.result.is_ok());
        let tried: Vec<f64> = tried.map(|sample| sample.factor).collect();
        let runs = threshold.ranges.iter();
        let runs = runs.map(|(verdict, range)| (*verdict, [range.from, range.to]));
        let tried = [tried.first(), tried.last()].map(|end| end.copied().unwrap_or(0.0));
        Self::of_runs(&runs.collect::<Vec<_>>(), tried)
    }

    /// Makes a survival of ascending ranges of one verdict each, and of the smallest and the largest tried strength.
    fn of_runs(runs: &[(Verdict, [f64; 2])], [tried_from, tried_to]: [f64; 2]) -> Self {
        let first = runs.iter().position(|run| run.0 == Verdict::Overturns);
        let overturns_from = first.map(|first| runs[first].1[0]);
        let of = |runs: &[(Verdict, [f64; 2])], wanted: Verdict| {
            let runs = runs.iter().filter(|run| run.0 == wanted);
            runs.map(|run| run.1).collect()
        };
        Self {
            overturns_from,
            from_the_first: overturns_from == Some(tried_from),
            at_most: false,
            again: of(&runs[first.unwrap_or(runs.len())..], Verdict::Survives),
            uncertain: of(runs, Verdict::Uncertain),
            incomplete: of(runs, Verdict::Incomplete),
            tried_to,
        }
    }
}

/// Words before strengths without a verdict.
const EARLY: &str = "no verdict, since the run ends too early,";

/// Returns the line of words, with this unit of strengths, which may be empty: `first overturns at 2.113; survives again at 2.401 to 2.604`.
#[must_use]
pub fn in_words(survival: &Survival, unit: &str) -> String {
    let at = |strength: f64| format!("{}{unit}", rounded(strength));
    let mut words = match survival.overturns_from {
        None => {
            let is_certain = survival.uncertain.is_empty() && survival.incomplete.is_empty();
            let certainly = if is_certain { "" } else { "certainly " };
            format!(
                "does not {certainly}overturn up to {}",
                at(survival.tried_to)
            )
        }
        Some(first) if survival.from_the_first => {
            format!("overturns at {} already, the smallest tried", at(first))
        }
        Some(first) if survival.at_most => format!("first overturns at or below {}", at(first)),
        Some(first) => format!("first overturns at {}", at(first)),
    };
    for (what, ranges) in [
        ("survives again", &survival.again),
        ("uncertain", &survival.uncertain),
        (EARLY, &survival.incomplete),
    ] {
        let ranges: Vec<String> = ranges
            .iter()
            .map(|[from, to]| match (at(*from), at(*to)) {
                (from, to) if from == to => to,
                (_, to) => format!("{} to {to}", rounded(*from)),
            })
            .collect();
        if !ranges.is_empty() {
            words += &format!("; {what} at {}", ranges.join(", "));
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strengths_that_are_survived_again_are_found() {
        let survival = |outcomes: &str| {
            let levels: Vec<_> = outcomes
                .bytes()
                .zip(1..)
                .map(|(outcome, level)| {
                    let verdict = match outcome {
                        b'x' => Some(Verdict::Overturns),
                        b'.' => Some(Verdict::Survives),
                        b'/' => Some(Verdict::Incomplete),
                        b'~' => Some(Verdict::Uncertain),
                        _ => None,
                    };
                    (f64::from(level), verdict)
                })
                .collect();
            Survival::of_levels(&levels)
        };
        let of = |outcomes: &str| {
            let survival = survival(outcomes);
            (
                survival.overturns_from,
                survival.from_the_first,
                survival.again,
                survival.tried_to,
            )
        };
        assert_eq!(of("...."), (None, false, vec![], 4.0));
        assert_eq!(of("..xx"), (Some(3.0), false, vec![], 4.0));
        assert_eq!(
            of(".x..xx.x."),
            (
                Some(2.0),
                false,
                vec![[3.0, 4.0], [7.0, 7.0], [9.0, 9.0]],
                9.0
            )
        );
        assert_eq!(of("xx"), (Some(1.0), true, vec![], 2.0));
        // A strength without a history does not count.
        assert_eq!(of("?x.?.x?"), (Some(2.0), true, vec![[3.0, 5.0]], 6.0));
        assert_eq!(of("??"), (None, false, vec![], 0.0));
        // An uncertain strength counts neither as overturned nor as survived.
        assert_eq!(of(".~x~.~"), (Some(3.0), false, vec![[5.0, 5.0]], 6.0));
        assert_eq!(of("~~"), (None, false, vec![], 2.0));
        let uncertain = |outcomes| survival(outcomes).uncertain;
        assert_eq!(uncertain(".~x~~.~"), [[2.0, 2.0], [4.0, 5.0], [7.0, 7.0]]);
        assert_eq!(uncertain("..xx"), [[0.0; 2]; 0]);
        // An incomplete history is no verdict.
        assert_eq!(of("./x/.x"), (Some(3.0), false, vec![[5.0, 5.0]], 6.0));
        assert_eq!(survival(".//").incomplete, [[2.0, 3.0]]);
    }

    #[test]
    fn the_words_are_one_line() {
        let survival = |from: Option<f64>, again: &[[f64; 2]]| Survival {
            overturns_from: from,
            from_the_first: from == Some(0.1),
            at_most: false,
            again: again.to_vec(),
            uncertain: Vec::new(),
            incomplete: Vec::new(),
            tried_to: 4.0,
        };
        assert_eq!(
            in_words(&survival(None, &[]), " g"),
            "does not overturn up to 4.000 g"
        );
        assert_eq!(
            in_words(&survival(Some(2.113_06), &[[2.4, 2.6], [3.0, 3.0]]), " g"),
            "first overturns at 2.113 g; survives again at 2.400 to 2.600 g, 3.000 g"
        );
        assert_eq!(
            in_words(&survival(Some(0.1), &[]), ""),
            "overturns at 0.1000 already, the smallest tried"
        );
        let at_most = Survival {
            at_most: true,
            ..survival(Some(2.5), &[])
        };
        assert_eq!(
            in_words(&at_most, " g"),
            "first overturns at or below 2.500 g"
        );
        let uncertain = |from, uncertain: &[[f64; 2]]| Survival {
            uncertain: uncertain.to_vec(),
            ..survival(from, &[])
        };
        assert_eq!(
            in_words(&uncertain(Some(2.5), &[[2.1, 2.4], [3.0, 3.0]]), " g"),
            "first overturns at 2.500 g; uncertain at 2.100 to 2.400 g, 3.000 g"
        );
        assert_eq!(
            in_words(&uncertain(None, &[[3.0, 4.0]]), ""),
            "does not certainly overturn up to 4.000; uncertain at 3.000 to 4.000"
        );
    }
}
