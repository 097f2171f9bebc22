//! The factor on its ground motion from which every sample overturns: searched upwards, up to the first edge only.

use super::{NoAnswer, Question, Told, told};
use crate::output::{Figure, OutputError};
use crate::scenario::Scenario;
use crate::studies::results::Results;
use crate::studies::statistics::{BAND, Share, fractile};
use crate::studies::threshold::first_edge::FirstEdge;
use crate::studies::threshold::{Factors, check, rounded};

/// The factors to try, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstEdges {
    /// The factors of a threshold.
    pub factors: Factors,
}

/// A fractile of the strengths that first overturn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstStrength {
    /// The strength; infinite if too few cases overturn.
    pub strength: f64,
    /// Whether the fractile may be lower, because cases overturn at the least strength tried already.
    pub at_most: bool,
}

impl FirstStrength {
    /// The fractile for a `part` of these cases; `None` if there are none.
    pub(super) fn of<'e>(
        edges: impl Iterator<Item = &'e FirstEdge> + Clone,
        part: f64,
    ) -> Option<Self> {
        let sorted = |strength: fn(&FirstEdge) -> f64| {
            let mut strengths: Vec<f64> = edges.clone().map(strength).collect();
            strengths.sort_by(f64::total_cmp);
            strengths
        };
        // Below a bound anything above 0 is possible, and 0 makes the fractiles 0 that depend on it.
        let lowest = sorted(|edge| if edge.at_most { 0.0 } else { edge.strength() });
        Some(Self {
            strength: fractile(&sorted(FirstEdge::strength), part)?,
            at_most: fractile(&lowest, part)? == 0.0,
        })
    }

    /// In words, after `at`: `at 0.5028`, `at or below 0.2000`, or `beyond`.
    pub(super) fn in_words(self, at: &str, beyond: &str) -> String {
        let Self { strength, at_most } = self;
        if !strength.is_finite() {
            return beyond.to_owned();
        }
        let or_below = if at_most { "at or below" } else { "at" };
        format!("{or_below} {at}{}", rounded(strength))
    }
}

impl FirstEdges {
    /// The question about a scenario.
    ///
    /// # Errors
    /// Explains what to change.
    pub fn of(scenario: &Scenario, factors: Factors) -> Result<Self, String> {
        check(scenario)?;
        Ok(Self { factors })
    }
}

impl Question for FirstEdges {
    type Answer = FirstEdge;

    const NAME: &'static str = "uncertain_threshold";

    fn results(
        &self,
        told: &Told<'_, Self::Answer>,
        figure: Figure,
    ) -> Result<Results, OutputError> {
        told::edges(told, figure)
    }

    fn answer(&self, scenario: &Scenario) -> Result<FirstEdge, NoAnswer> {
        FirstEdge::of(scenario, &self.factors)
    }

    fn settings(&self) -> Vec<String> {
        let (from, to, stride) = (
            self.factors.first(),
            self.factors.last(),
            self.factors.stride(),
        );
        vec![format!("factors:{from:?}:{to:?}:{stride:?}")]
    }
}

/// The probability of overturning up to a factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbabilityAt {
    /// The factor at which a sample first overturns.
    pub factor: f64,
    /// The share of samples that overturn up to this factor.
    pub share: Share,
}

impl Told<'_, FirstEdge> {
    /// The distribution of the factors at which samples overturn, ascending.
    pub(crate) fn probabilities(&self) -> Vec<ProbabilityAt> {
        let mut factors: Vec<f64> = self
            .answered()
            .filter_map(|(_, edge)| edge.factor)
            .collect();
        factors.sort_by(f64::total_cmp);
        let all = self.answered().count();
        let at = |(index, factor): (usize, &f64)| {
            let share = Share::of(index + 1, all)?;
            Some(ProbabilityAt {
                factor: *factor,
                share,
            })
        };
        factors.iter().enumerate().filter_map(at).collect()
    }

    /// The share of samples that overturn at this factor or below it; `None` if the factors that were tried do not decide that.
    pub(crate) fn share_up_to(&self, factor: f64) -> Option<Share> {
        let all = self.answered().count();
        let known: Option<Vec<bool>> = self
            .answered()
            .map(|(_, edge)| edge.overturns_up_to(factor))
            .collect();
        let overturned = known?.into_iter().filter(|overturns| *overturns);
        Share::of(overturned.count(), all)
    }

    /// The 5 % quantile, the median and the 95 % quantile of the factors.
    pub(crate) fn band(&self) -> Option<[FirstStrength; 3]> {
        let edges = self.answered().map(|(_, edge)| edge);
        let [low, median, high] = BAND.map(|part| FirstStrength::of(edges.clone(), part));
        Some([low?, median?, high?])
    }
}
