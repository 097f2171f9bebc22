//! Which strengths of a ground motion a structure survives, in brief.

use super::threshold::{RangeEnd, Threshold};

/// Where a structure first overturns as its ground motion gets stronger, and where it survives again.
#[derive(Clone, Debug, PartialEq)]
pub struct Survival {
    /// The least strength that overturns; `None` where none does.
    pub overturns_from: Option<f64>,
    /// Whether that is the least strength that was tried, so that a smaller one may overturn as well.
    pub from_the_first: bool,
    /// From and to which strengths it is survived above that.
    pub again: Vec<[f64; 2]>,
    /// The greatest strength that was tried.
    pub tried_to: f64,
}

impl Survival {
    /// Of strengths that were tried, ascending, and whether they overturn, where that is known. What is survived again
    /// goes from the first to the last of those tried that are.
    #[must_use]
    pub fn of_levels(levels: &[(f64, Option<bool>)]) -> Self {
        let known: Vec<(f64, bool)> = levels
            .iter()
            .filter_map(|(level, overturns)| Some((*level, (*overturns)?)))
            .collect();
        let first = known.iter().position(|(_, overturns)| *overturns);
        let again = known[first.unwrap_or(known.len())..]
            .chunk_by(|a, b| a.1 == b.1)
            .filter(|run| !run[0].1)
            .map(|run| [run[0].0, run[run.len() - 1].0]);
        Self {
            overturns_from: first.map(|first| known[first].0),
            from_the_first: first == Some(0),
            again: again.collect(),
            tried_to: known.last().map_or(0.0, |last| last.0),
        }
    }

    /// Of a threshold, whose edges are enclosed.
    #[must_use]
    pub fn of_threshold(threshold: &Threshold) -> Self {
        let known = threshold.samples.iter().rev();
        let tried_to = known
            .filter(|sample| sample.result.is_ok())
            .map(|sample| sample.factor)
            .next();
        let tried_to = tried_to.unwrap_or(0.0);
        let first = threshold.bands.first();
        let mut again: Vec<[f64; 2]> = threshold
            .gaps
            .iter()
            .map(|gap| [gap.from, gap.to])
            .collect();
        if let Some(last) = threshold.bands.last()
            && last.to_end == RangeEnd::Edge
            && last.to < tried_to
        {
            again.push([last.to, tried_to]);
        }
        Self {
            overturns_from: first.map(|band| band.from),
            from_the_first: first.is_some_and(|band| band.from_end == RangeEnd::Sampled),
            again,
            tried_to,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strengths_that_are_survived_again_are_found() {
        let of = |outcomes: &str| {
            let levels: Vec<_> = outcomes
                .bytes()
                .zip(1..)
                .map(|(outcome, level)| {
                    let overturns = match outcome {
                        b'x' => Some(true),
                        b'.' => Some(false),
                        _ => None,
                    };
                    (f64::from(level), overturns)
                })
                .collect();
            let survival = Survival::of_levels(&levels);
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
    }
}
