//! The factor on its ground motion from which every sample overturns: searched upwards, up to the first edge only.

use serde::{Deserialize, Serialize};

use super::statistics::{BAND, Share, fractile};
use super::{Ensemble, NoAnswer, Question, SampleRow, Told, told};
use crate::bisection::{Width, try_bisect};
use crate::output::OutputError;
use crate::scenario::Scenario;
use crate::studies::ending::{Ending, Verdict};
use crate::studies::results::{Look, Results};
use crate::studies::threshold::{EDGE_WIDTH, Factors, check, rounded};

/// The factors to try, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstEdges {
    /// The factors of a threshold.
    pub factors: Factors,
}

/// Where a sample first overturns as its ground motion gets stronger.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FirstEdge {
    /// The least factor that certainly overturns; `None` if none does.
    pub factor: Option<f64>,
    /// Whether that is also the least factor tried, so that a smaller one may overturn too.
    #[serde(default)]
    pub at_most: bool,
    /// The greatest factor tried.
    pub tried_to: f64,
    /// The least factor below that for which overturning is uncertain, if there is one.
    pub uncertain_from: Option<f64>,
}

impl FirstEdge {
    /// The factor; infinite if none overturns.
    #[must_use]
    pub fn strength(&self) -> f64 {
        self.factor.unwrap_or(f64::INFINITY)
    }

    /// True if it overturns up to this factor; `None` if no tried factor decides that.
    fn overturns_up_to(&self, factor: f64) -> Option<bool> {
        match self.factor {
            Some(first) if first <= factor => Some(true),
            Some(_) => (!self.at_most).then_some(false),
            None => (factor <= self.tried_to).then_some(false),
        }
    }
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

/// Where a structure first overturns, from strengths that are tried in ascending order. Bisection narrows the edge between two of
/// them to this relative width.
pub(super) fn first_edge(
    strengths: &[f64],
    width: f64,
    verdict: impl Fn(f64) -> Result<Verdict, String>,
) -> Result<FirstEdge, NoAnswer> {
    let mut edge = FirstEdge {
        factor: None,
        at_most: false,
        tried_to: 0.0,
        uncertain_from: None,
    };
    for strength in strengths.iter().copied() {
        let found = match verdict(strength) {
            Ok(Verdict::Incomplete) => return Err(NoAnswer::Incomplete),
            Ok(found) => found,
            // A stronger motion may exceed what the model allows: the ground may fall freely.
            Err(_) if edge.tried_to > 0.0 => break,
            Err(reason) => return Err(NoAnswer::Failed(reason)),
        };
        if found == Verdict::Overturns {
            edge.factor = Some(if edge.tried_to > 0.0 {
                let overturns = |at| verdict(at).map(|found| found == Verdict::Overturns);
                let ends = try_bisect(edge.tried_to, strength, Width::Relative(width), overturns);
                ends.map_err(NoAnswer::Failed)?.1
            } else {
                edge.at_most = true;
                strength
            });
            edge.tried_to = strength;
            break;
        }
        edge.tried_to = strength;
        if found == Verdict::Uncertain {
            edge.uncertain_from.get_or_insert(strength);
        }
    }
    Ok(edge)
}

impl FirstEdges {
    /// The factors on the ground motion of a scenario, which must start from rest.
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

    fn answer(&self, scenario: &Scenario) -> Result<FirstEdge, NoAnswer> {
        let model = scenario
            .model()
            .map_err(|error| NoAnswer::Invalid(error.to_string()))?;
        let request = scenario.request_from_rest();
        let verdict = |factor: f64| {
            let ground = scenario.ground_motion().scaled(factor);
            let ground = ground.map_err(|error| error.to_string())?;
            let ending = Ending::of(&*model, &ground, &request);
            ending.map(|ending| ending.verdict())
        };
        first_edge(&self.factors.values(), EDGE_WIDTH, verdict)
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

impl Ensemble<'_, FirstEdges> {
    /// The files and words for all rows.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn tell(&self, rows: &[SampleRow<FirstEdge>], look: Look) -> Result<Results, OutputError> {
        let told = Told::new(self.scenario, self.uncertain, rows);
        told::edges(&told, look.figure)
    }
}
