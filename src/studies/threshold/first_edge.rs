//! The first edge: the strength from which a structure overturns. The search goes upwards and ends at the first edge.

use std::cell::RefCell;

use serde::{Deserialize, Serialize};

use super::below::{Closeness, FineHistory, FineSearch, Fineness, search_below_edge};
use super::factors::{EDGE_WIDTH, Factors, UNCERTAIN_EDGE_WIDTH, onset_factor};
use crate::bisection::{Width, try_bisect};
use crate::dynamics::{Direction, MODEL_LIMIT};
use crate::output::page::SpotKind;
use crate::output::{Column, column};
use crate::studies::ending::columns::yes_or_no;
use crate::studies::ending::{Ending, NoAnswer, NoHistory, Verdict};
use crate::studies::statistics::ascending_weighted;
use crate::{GroundMotion, Model, Scenario, SimulationError};

/// The strengths of a ground motion that a structure certainly survives, and the smallest one that overturns it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FirstEdge {
    /// The largest factor up to which the structure certainly survives all tried factors; `None` if it does not survive the smallest.
    #[serde(default)]
    pub survives_up_to: Option<f64>,
    /// The smallest factor that certainly overturns the structure; `None` if no factor does.
    pub factor: Option<f64>,
    /// True if `factor` is the smallest tried factor, so that a smaller one may overturn the structure too.
    #[serde(default)]
    pub at_most: bool,
    /// The largest tried factor.
    pub tried_to: f64,
    /// The smallest factor below `factor` with an uncertain verdict; `None` without uncertain verdicts.
    pub uncertain_from: Option<f64>,
    /// The smallest tried factor if lower ones may overturn the structure; `None` if it never moves below.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tried_from: Option<f64>,
    /// True if the history at the factor after `tried_to` failed, so that nothing is known of stronger motions.
    #[serde(default)]
    pub failed_beyond: bool,
    /// The uncertain factors below `factor`, ascending, each with the fraction of its repetitions that overturn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub uncertain: Vec<[f64; 2]>,
    /// Largest excess of the thrust line of four links in the history at `factor`, or at `tried_to` without it, over the thickness; `None` for other
    /// models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thrust_excess_ratio: Option<f64>,
    /// Largest friction coefficient that the histories at factors up to `survives_up_to` require without slip; `None` if joints slip or are elastic, or
    /// without such a factor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_demand: Option<f64>,
    /// Worse direction of the ground motion at the first factor that is not certainly survived, or at `tried_to` without it.
    #[serde(default)]
    pub direction: Direction,
}

/// The numbers of a history in the search for a first edge, in the worse direction of the ground motion.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::studies) struct TriedHistory {
    /// Share of the repetitions that overturn; `None` if the history is incomplete.
    pub(in crate::studies) overturning_share: Option<f64>,
    /// Excess of the thrust line, as in [`Ending`].
    pub(in crate::studies) thrust_excess_ratio: Option<f64>,
    /// Friction demand, as in [`Ending`].
    pub(in crate::studies) friction_demand: Option<f64>,
    /// Direction of the ground motion, as in [`Ending`].
    pub(in crate::studies) direction: Direction,
}

impl From<Ending> for TriedHistory {
    fn from(ending: Ending) -> Self {
        Self {
            overturning_share: ending.overturning_share(),
            thrust_excess_ratio: ending.thrust_excess_ratio,
            friction_demand: ending.friction_demand,
            direction: ending.direction,
        }
    }
}

/// Treatment of an uncertain factor: its probability to overturn the structure, from the fraction of the repetitions that overturn.
pub type Treatment = fn(f64) -> f64;

/// The treatments of uncertain factors: by their fractions, as overturning, and as survived.
pub const TREATMENTS: [Treatment; 3] = [|share| share, f64::ceil, f64::floor];

impl FirstEdge {
    /// True if the history at the edge is outside the model of four links; false for other models.
    pub fn is_outside_model(&self) -> bool {
        self.thrust_excess_ratio
            .is_some_and(|ratio| ratio > MODEL_LIMIT)
    }

    /// Mark on a page.
    pub(in crate::studies) const fn spot_kind(&self) -> SpotKind {
        match (self.factor, self.uncertain_from) {
            (_, Some(_)) => SpotKind::Uncertain,
            (Some(_), None) => SpotKind::Overturns,
            (None, None) => SpotKind::Survives,
        }
    }

    /// Finds the first edge of a scenario that starts from rest, among these factors on its ground motion. At every factor the worse direction of the
    /// ground motion counts. The search below the edge has the steps for its model.
    ///
    /// # Errors
    /// The reason why there is no answer.
    pub fn of(
        scenario: &Scenario,
        factors: &Factors,
        fineness: impl Fn(&dyn Model) -> Fineness,
    ) -> Result<Self, NoAnswer> {
        let model = scenario.model().map_err(NoAnswer::without_model)?;
        let ground = scenario.ground_motion();
        let request = scenario.request_on(ground, &scenario.structure);
        let directions = scenario.simulation.direction;
        let onset = onset_factor(&*model, directions, (ground, &request));
        let searched = factors
            .factors_to_search(onset)
            .map_err(NoAnswer::Invalid)?;
        let history = |factor: f64| {
            let ground = ground.scaled(factor).map_err(SimulationError::from)?;
            let ending = Ending::of_all_in(directions, &*model, &[(ground, request)]).remove(0);
            ending.map(TriedHistory::from)
        };
        let has_second = directions.has_second(&*model, ground, &request);
        let mirrored = has_second.then(|| ground.mirrored());
        let histories = |factors: &[f64], _| {
            let under = |ground: &GroundMotion| {
                FineHistory::of_all(&*model, &request, factors, |factor| ground.scaled(factor))
            };
            let own = under(ground);
            Ok::<_, NoAnswer>(match &mirrored {
                None => own,
                Some(mirrored) => {
                    let both = own.into_iter().zip(under(mirrored));
                    both.map(|(one, other)| one.or_closer(other)).collect()
                }
            })
        };
        let below = |safe| {
            let edge = (safe, Closeness::EDGE);
            search_below_edge(edge, searched.from, fineness(&*model), histories)
        };
        let edge = Self::search(&searched.values(), EDGE_WIDTH, history, below)?;
        Ok(Self {
            tried_from: searched.lower_not_tried.then_some(searched.from),
            ..edge
        })
    }

    /// Finds the first edge. `strengths` are tried in ascending order, and bisection encloses the edge between two of them to this relative
    /// width. `history` computes the history at a strength.
    pub(in crate::studies) fn find_among(
        strengths: &[f64],
        width: f64,
        history: impl Fn(f64) -> Result<TriedHistory, NoHistory>,
    ) -> Result<Self, NoAnswer> {
        Self::search(strengths, width, history, |_| Ok(FineSearch::default()))
    }

    /// Finds the first edge as [`FirstEdge::find_among`]. `below` searches below the safe strength.
    pub(in crate::studies) fn search(
        strengths: &[f64],
        width: f64,
        history: impl Fn(f64) -> Result<TriedHistory, NoHistory>,
        below: impl FnOnce(f64) -> Result<FineSearch, NoAnswer>,
    ) -> Result<Self, NoAnswer> {
        let tried = RefCell::new(Vec::new());
        let known = |strength| {
            let found = history(strength)?;
            let share = found.overturning_share.ok_or(NoAnswer::Incomplete)?;
            tried.borrow_mut().push(([strength, share], found));
            Ok(verdict_of(share))
        };
        // The ends of the edge between a low and a high strength, of verdicts below and from `least` on, and the verdict at its upper end.
        let narrow = |low: f64, (high, mut verdict): (f64, Verdict), least: Verdict| {
            let is_certain = (least, verdict) == (Verdict::Uncertain, Verdict::Overturns);
            let least_width = if is_certain {
                0.0
            } else {
                UNCERTAIN_EDGE_WIDTH
            };
            let width = width.max(least_width);
            let edge = try_bisect(low, high, Width::Relative(width), |strength| {
                let found = known(strength)?;
                verdict = if found >= least { found } else { verdict };
                Ok::<_, NoAnswer>(found >= least)
            })?;
            Ok::<_, NoAnswer>((edge, verdict))
        };
        let mut edge = Self::default();
        for strength in strengths.iter().copied() {
            let found = match known(strength) {
                // The model may not allow a stronger motion: the ground may fall freely.
                Err(NoAnswer::Failed(_)) if edge.tried_to > 0.0 => {
                    edge.failed_beyond = true;
                    break;
                }
                found => found?,
            };
            let mut below = std::mem::replace(&mut edge.tried_to, strength);
            if found == Verdict::Survives {
                if edge.uncertain_from.is_none() {
                    edge.survives_up_to = Some(strength);
                }
                continue;
            }
            if edge.uncertain_from.is_none() {
                let mut first = (strength, found);
                if below > 0.0 {
                    let ((safe, from), verdict) = narrow(below, first, Verdict::Uncertain)?;
                    edge.survives_up_to = Some(safe);
                    first = (from, verdict);
                }
                if first.1 == Verdict::Overturns {
                    edge.factor = Some(first.0);
                    edge.at_most = below == 0.0;
                    break;
                }
                below = first.0;
                edge.uncertain_from = Some(below);
            }
            if found == Verdict::Overturns {
                let ((_, lowest), _) = narrow(below, (strength, found), found)?;
                edge.factor = Some(lowest);
                break;
            }
        }
        let fine = edge.survives_up_to.map(below).transpose()?;
        let fine = fine.unwrap_or_default();
        if let Some(lowest) = fine.confirm_lowest(known)? {
            let mut first = (lowest.factor, lowest.verdict);
            edge.survives_up_to = None;
            if let Some(lower) = lowest.survived {
                let ((safe, from), verdict) = narrow(lower, first, Verdict::Uncertain)?;
                edge.survives_up_to = Some(safe);
                first = (from, verdict);
            }
            edge.uncertain_from = (first.1 == Verdict::Uncertain).then_some(first.0);
            edge.at_most &= edge.survives_up_to.is_none();
        }
        Ok(edge.with_tried(tried.into_inner(), &fine))
    }

    /// Edge with the results of all tried strengths, each with its share of repetitions that overturn, and of the search below it.
    fn with_tried(mut self, tried: Vec<([f64; 2], TriedHistory)>, fine: &FineSearch) -> Self {
        // The bisection of the first doubt may meet a strength that certainly overturns below one that is uncertain.
        let certain = tried
            .iter()
            .filter(|(own, _)| own[1] == 1.0)
            .map(|(own, _)| own[0]);
        self.factor = self.factor.into_iter().chain(certain).reduce(f64::min);
        let last = self.factor.unwrap_or(self.tried_to);
        let at = |wanted: f64| {
            let mut all = tried.iter();
            let known = all.find(|([strength, _], _)| *strength == wanted);
            known.map(|(_, found)| *found).unwrap_or_default()
        };
        self.thrust_excess_ratio = at(last).thrust_excess_ratio;
        self.direction = at(self.uncertain_from.unwrap_or(last)).direction;
        let safe = self.survives_up_to;
        let up_to_safe = tried
            .iter()
            .filter(|([strength, _], _)| Some(*strength) <= safe);
        let demands = up_to_safe.filter_map(|(_, found)| found.friction_demand);
        let fine = fine
            .histories
            .iter()
            .filter(|history| Some(history.factor) <= safe);
        let demands = demands.chain(fine.filter_map(|history| history.friction_demand));
        self.friction_demand = demands.reduce(f64::max);
        let below = |[strength, share]: &[f64; 2]| *strength < self.strength() && *share < 1.0;
        let shares = tried.into_iter().map(|(share, _)| share);
        self.uncertain = ascending_weighted(shares.filter(below));
        self
    }

    /// Columns of an edge in a table; the name of the factor depends on the table.
    pub(in crate::studies) fn columns<'a, R: 'a>(
        factor: &'static str,
        of: impl Fn(&R) -> Option<&Self> + Copy + 'a,
    ) -> [Column<'a, R>; 7] {
        [
            column("survives_up_to", move |row| of(row)?.survives_up_to),
            column(factor, move |row| of(row)?.factor),
            column("tried_to", move |row| Some(of(row)?.tried_to)),
            column("uncertain_from", move |row| of(row)?.uncertain_from),
            column("at_most", move |row| Some(yes_or_no(of(row)?.at_most))),
            column("thrust_excess_ratio", move |row| {
                of(row)?.thrust_excess_ratio
            }),
            column("friction_demand", move |row| of(row)?.friction_demand),
        ]
    }

    /// Column of the worse direction at an edge.
    pub(in crate::studies) fn direction_column<'a, R: 'a>(
        of: impl Fn(&R) -> Option<&Self> + Copy + 'a,
    ) -> Column<'a, R> {
        column("direction", move |row| Some(of(row)?.direction.name()))
    }

    /// Largest safe factor; 0 if the smallest tried factor is not safe.
    pub(in crate::studies) fn safe_or_zero(&self) -> f64 {
        self.survives_up_to.unwrap_or(0.0)
    }

    /// Factor; infinite if no factor overturns the structure.
    pub fn strength(&self) -> f64 {
        self.factor.unwrap_or(f64::INFINITY)
    }

    /// Distribution of the strength that first overturns the structure: strengths and their probabilities. The last strength is
    /// infinite if no factor certainly overturns it.
    pub fn strengths(&self, treatment: Treatment) -> Vec<[f64; 2]> {
        let mut reached = 0.0;
        let certain = [self.strength(), 1.0];
        let all = self.uncertain.iter().chain([&certain]);
        let rises = all.map(|[strength, share]| {
            // The probability to overturn up to a strength does not fall.
            let rise = (treatment(*share) - reached).max(0.0);
            reached += rise;
            [*strength, rise]
        });
        rises.filter(|[_, rise]| *rise > 0.0).collect()
    }

    /// Probability that the structure overturns up to this factor; `None` if the tried factors do not determine it.
    pub(in crate::studies) fn overturns_up_to(&self, factor: f64) -> Option<f64> {
        let is_known = match self.factor {
            Some(first) if first <= factor => return Some(1.0),
            Some(_) => !self.at_most,
            None => factor <= self.tried_to,
        };
        // Below the smallest factor nothing is known, unless that factor is survived.
        let doubtful = |[first, _]: &[f64; 2]| *first <= factor;
        let is_tried =
            self.survives_up_to.is_some() || self.uncertain.first().is_some_and(doubtful);
        let reached = self.uncertain.iter().filter(|own| doubtful(own));
        (is_known && is_tried).then(|| reached.map(|[_, share]| *share).fold(0.0, f64::max))
    }
}

/// Verdict of a history of which this share of the repetitions overturns.
fn verdict_of(share: f64) -> Verdict {
    match share {
        ..=0.0 => Verdict::Survives,
        1.0.. => Verdict::Overturns,
        _ => Verdict::Uncertain,
    }
}

/// Finds the lowest strength that overturns a structure. `histories` are ascending strengths, each with true if the structure overturns. Bisection
/// with `overturns` encloses the edge to this relative width. Returns the first strength if it already overturns the structure, and `None` if no
/// strength does.
///
/// # Errors
/// The first error of a history.
pub(super) fn find_lowest_strength<E>(
    histories: impl Iterator<Item = (f64, Result<bool, E>)>,
    width: f64,
    overturns: impl FnMut(f64) -> Result<bool, E>,
) -> Result<Option<f64>, E> {
    let mut survived = None;
    for (strength, history) in histories {
        if history? {
            let below = survived.unwrap_or(strength);
            let (_, lowest) = try_bisect(below, strength, Width::Relative(width), overturns)?;
            return Ok(Some(lowest));
        }
        survived = Some(strength);
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first edge of histories with these shares.
    fn edge_among(
        strengths: &[f64],
        share: impl Fn(f64) -> Result<Option<f64>, NoHistory>,
    ) -> Result<FirstEdge, NoAnswer> {
        FirstEdge::find_among(strengths, EDGE_WIDTH, |strength| {
            Ok(TriedHistory {
                overturning_share: share(strength)?,
                ..TriedHistory::default()
            })
        })
    }

    /// The safe strengths end at the first doubt, whose edge is narrowed as well; so does the lowest overturning strength.
    #[test]
    fn safe_strengths_end_where_doubt_begins() {
        let verdict = |strength: f64| {
            Ok(Some(match strength {
                _ if (0.953..1.672).contains(&strength) && !(1.1..1.2).contains(&strength) => 0.5,
                _ if strength >= 1.672 => 1.0,
                _ => 0.0,
            }))
        };
        for strengths in [&[0.5, 1.0, 1.15, 2.0][..], &[0.5, 3.0], &[0.9, 1.15, 1.7]] {
            let edge = edge_among(strengths, verdict).unwrap();
            let near = |found: Option<f64>, known: f64| {
                assert!(
                    (found.unwrap() / known - 1.0).abs() <= UNCERTAIN_EDGE_WIDTH,
                    "{edge:?}"
                );
            };
            near(edge.factor, 1.672);
            // A safe range above a missed uncertain one is not known to be unsafe.
            let doubt = if strengths.contains(&1.0) { 0.953 } else { 1.2 };
            near(edge.survives_up_to, doubt);
            near(edge.uncertain_from, doubt);
            assert!(edge.survives_up_to < edge.uncertain_from);
        }
        let edge = edge_among(&[0.96, 2.0], verdict).unwrap();
        assert_eq!(
            (edge.survives_up_to, edge.uncertain_from),
            (None, Some(0.96))
        );
        let edge = edge_among(&[1.7, 2.0], verdict).unwrap();
        assert_eq!(
            (edge.survives_up_to, edge.factor, edge.at_most),
            (None, Some(1.7), true)
        );
    }

    /// From 0.5 on three of four repetitions overturn, from 0.6 on one of four, from 0.7 on all: the probability does not fall again.
    #[test]
    fn uncertain_strengths_count_with_their_fractions() {
        let share = |strength: f64| {
            let shares = [(0.7, 1.0), (0.6, 0.25), (0.5, 0.75), (0.0, 0.0)];
            let share = shares.into_iter().find(|(from, _)| strength >= *from);
            Ok(share.map(|(_, share)| share))
        };
        let edge = edge_among(&[0.3, 0.65, 1.0], share).unwrap();
        let (from, first) = (edge.uncertain_from.unwrap(), edge.strength());
        for (found, known) in [(from, 0.5), (first, 0.7)] {
            assert!(
                (found / known - 1.0).abs() < UNCERTAIN_EDGE_WIDTH,
                "{found}"
            );
        }
        let known = [
            vec![[from, 0.75], [first, 0.25]],
            vec![[from, 1.0]],
            vec![[first, 1.0]],
        ];
        assert_eq!(TREATMENTS.map(|how| edge.strengths(how)), known);
        let up_to = [0.4, from, 0.69, 0.71].map(|factor| edge.overturns_up_to(factor));
        assert_eq!(up_to, [Some(0.0), Some(0.75), Some(0.75), Some(1.0)]);
    }

    /// A history without a verdict is neither survived nor overturned, also where an edge is narrowed.
    #[test]
    fn an_incomplete_history_next_to_an_edge_answers_nothing() {
        let verdict = |incomplete_to: f64| {
            move |strength: f64| {
                Ok(if strength >= 0.7 {
                    Some(1.0)
                } else if strength >= 0.5 && strength < incomplete_to {
                    None
                } else {
                    Some(0.0)
                })
            }
        };
        let edge = |to| edge_among(&[0.4, 1.0], verdict(to));
        assert!(matches!(edge(0.7), Err(NoAnswer::Incomplete)));
        let found = edge(0.0).unwrap().factor.unwrap();
        assert!((found - 0.7).abs() < 0.7 * EDGE_WIDTH, "{found}");
    }

    /// Histories certainly overturn from 0.7 to 0.8, and are uncertain below and above. The bisection of the first doubt meets 0.75.
    #[test]
    fn a_certain_strength_that_a_bisection_meets_is_the_first_edge() {
        let share = |strength: f64| {
            let shares = [(0.8, 0.6), (0.7, 1.0), (0.6, 0.5)];
            let own = shares.into_iter().find(|(from, _)| strength >= *from);
            Ok(Some(own.map_or(0.0, |(_, share)| share)))
        };
        let edge = edge_among(&[0.5, 1.0, 1.5], share).unwrap();
        assert_eq!(edge.factor, Some(0.75));
        assert!((edge.uncertain_from.unwrap() / 0.6 - 1.0).abs() < UNCERTAIN_EDGE_WIDTH);
        assert!(edge.uncertain.iter().all(|[strength, _]| *strength < 0.75));
        assert_eq!(edge.overturns_up_to(0.8), Some(1.0));
    }

    #[test]
    fn below_an_uncertain_smallest_strength_nothing_is_known() {
        let share = |strength: f64| Ok(Some(if strength < 1.5 { 0.5 } else { 1.0 }));
        let edge = edge_among(&[1.0, 2.0], share).unwrap();
        assert_eq!(
            (edge.survives_up_to, edge.overturns_up_to(0.9)),
            (None, None)
        );
        assert_eq!(edge.overturns_up_to(1.2), Some(0.5));
    }
}
