//! Which strengths of a ground motion a structure survives, in brief.

use super::ending::Verdict;
use super::threshold::Threshold;

/// Where a structure first overturns as its ground motion gets stronger, where it survives again, and where that is uncertain.
#[derive(Clone, Debug, PartialEq)]
pub struct Survival {
    /// The least strength that certainly overturns; `None` where none does.
    pub overturns_from: Option<f64>,
    /// Whether that is the least strength that was tried, so that a smaller one may overturn as well.
    pub from_the_first: bool,
    /// From and to which strengths it is certainly survived above that.
    pub again: Vec<[f64; 2]>,
    /// From and to which strengths it is uncertain whether it overturns.
    pub uncertain: Vec<[f64; 2]>,
    /// The greatest strength that was tried.
    pub tried_to: f64,
}

impl Survival {
    /// Of strengths that were tried, ascending, and whether they overturn, where there is a history. What is survived again or
    /// uncertain goes from the first to the last of those tried that are.
    #[must_use]
    pub fn of_levels(levels: &[(f64, Option<Verdict>)]) -> Self {
        let known: Vec<(f64, Verdict)> = levels
            .iter()
            .filter_map(|(level, verdict)| Some((*level, (*verdict)?)))
            .collect();
        let runs = known.chunk_by(|a, b| a.1 == b.1);
        let runs = runs.map(|run| (run[0].1, [run[0].0, run[run.len() - 1].0]));
        let tried = [known.first(), known.last()].map(|end| end.map_or(0.0, |end| end.0));
        Self::of_runs(&runs.collect::<Vec<_>>(), tried)
    }

    /// Of a threshold, whose edges are enclosed.
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

    /// Of ranges of one verdict each, ascending, and the least and the greatest strength that was tried.
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
            again: of(&runs[first.unwrap_or(runs.len())..], Verdict::Survives),
            uncertain: of(runs, Verdict::Uncertain),
            tried_to,
        }
    }
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
        // What is not known does not count.
        assert_eq!(of("?x.?.x?"), (Some(2.0), true, vec![[3.0, 5.0]], 6.0));
        assert_eq!(of("??"), (None, false, vec![], 0.0));
        // What is uncertain has neither overturned nor been survived.
        assert_eq!(of(".~x~.~"), (Some(3.0), false, vec![[5.0, 5.0]], 6.0));
        assert_eq!(of("~~"), (None, false, vec![], 2.0));
        let uncertain = |outcomes| survival(outcomes).uncertain;
        assert_eq!(uncertain(".~x~~.~"), [[2.0, 2.0], [4.0, 5.0], [7.0, 7.0]]);
        assert_eq!(uncertain("..xx"), [[0.0; 2]; 0]);
    }
}
