//! The history under the mirrored ground motion, which is computed beside the history as given.

use std::mem;
use std::sync::Arc;

use askama::Template;

use super::summary::{ComputedRun, MirroredSummary, OutcomeSummary, RunSummary, VariedRun};
use super::{Drawings, NotableImpacts, REPORT, Run, StudyError, repeat};
use crate::dynamics::repeatability::Repetitions;
use crate::dynamics::{Direction, Directions, OutcomeKind, VariationResult, Variations};
use crate::output::filters;
use crate::scenario::Scenario;
use crate::studies::quotable::directions_in_words;
use crate::work::Pending;
use crate::{Model, Request, SimulationError, Summary, Verdict};

impl MirroredSummary {
    /// Result of a history, from the summary of the scenario in this direction alone.
    pub fn of(summary: &RunSummary) -> Self {
        let mechanisms = summary.mechanisms.as_ref();
        let row = summary.row.as_ref();
        let repeated = summary.repeatability.as_ref();
        Self {
            verdict: summary.own_verdict(),
            outcome: Some(summary.outcome),
            largest_peak_rotation_rad: Some(summary.largest_peak_rotation_rad),
            peak_rotation_over_critical: mechanisms.and_then(|own| own.peak_rotation_over_critical),
            peak_potential_over_barrier: row.and_then(|row| row.row.peak_potential_over_barrier),
            thrust_excess_ratio: mechanisms.and_then(|own| own.thrust_excess_ratio),
            friction_demand: summary.friction_demand,
            certainty: repeated.map(|all| all.repeatability.count.clone()),
            failed: None,
        }
    }

    /// Result of a history that failed.
    pub fn failed(reason: impl ToString) -> Self {
        Self {
            verdict: Verdict::Incomplete,
            outcome: None,
            largest_peak_rotation_rad: None,
            peak_rotation_over_critical: None,
            peak_potential_over_barrier: None,
            thrust_excess_ratio: None,
            friction_demand: None,
            certainty: None,
            failed: Some(reason.to_string()),
        }
    }

    /// Computes a scenario under its mirrored ground motion, and its repetitions if they are requested; `None` if it has no
    /// [second direction](Scenario::has_second_direction).
    pub fn compute(scenario: &Scenario, model: &dyn Model, repeats: bool) -> Option<Self> {
        if !scenario.has_second_direction(model) {
            return None;
        }
        let turned = scenario.in_directions(Directions::Mirrored);
        let history = model.simulate(turned.ground_motion(), &turned.request(), None);
        Some(match history {
            Ok(history) => {
                let repeated = repeats.then(|| repeat(&turned, model, &history)).flatten();
                Self::of(&RunSummary::of(&ComputedRun {
                    scenario: &turned,
                    model,
                    history: &history,
                    impacts: NotableImpacts::default(),
                    repeated: repeated.as_ref(),
                    varied: &[],
                    mirrored: None,
                }))
            }
            Err(error) => Self::failed(error),
        })
    }
}

/// Each result with other properties, with that under the mirrored ground motion if there is one.
pub(super) fn pair_results(
    own: Vec<VariationResult>,
    turned: &[VariationResult],
) -> Vec<VariedRun> {
    let mut turned = turned.iter().cloned();
    own.into_iter().map(|own| (own, turned.next())).collect()
}

/// The end of a history in one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectionEnd {
    /// True under the mirrored ground motion.
    pub is_mirrored: bool,
    pub verdict: Verdict,
    pub outcome: OutcomeSummary,
    pub largest_peak_rotation_rad: f64,
}

/// A history, and its drawings if a page is made.
type DrawnHistory = (Result<Summary, SimulationError>, Option<Box<Drawings>>);

/// A run under the mirrored ground motion, computed in parallel with the motion as given. It makes no tables.
pub(super) struct MirroredRun<'a> {
    scenario: &'a Scenario,
    model: &'a dyn Model,
    motion: Pending<DrawnHistory>,
    repetitions: Option<Repetitions<'a>>,
    variations: Variations,
}

/// The results of a run under the mirrored ground motion.
pub(super) struct FinishedMirrored {
    pub summary: MirroredSummary,
    /// Results with other properties.
    pub varied: Vec<VariationResult>,
    /// The page; `None` if no page is made, or the history failed.
    pub page: Option<MirroredPage>,
}

/// A history for its page.
pub(super) struct MirroredPage {
    pub history: Summary,
    pub summary: RunSummary,
    pub drawings: Box<Drawings>,
}

impl<'a> MirroredRun<'a> {
    /// Starts the motion of a run in the mirrored direction, its repetitions and its variations; `None` without that direction. `request` is that of
    /// the mirrored scenario. The frames of a page are collected with `has_page`.
    pub(super) fn start(
        run: &'a Run<'_>,
        request: Option<&'a Request>,
        has_page: bool,
    ) -> Result<Option<Self>, StudyError> {
        let Some((scenario, request)) = run.mirrored.as_ref().zip(request) else {
            return Ok(None);
        };
        let (ground, model) = (scenario.ground_motion(), &*run.model);
        let mut drawings = has_page.then(|| Box::new(Drawings::new(run, &[REPORT])));
        let (moved, own_ground, own_request) = (Arc::clone(&run.model), ground.clone(), *request);
        let motion = Pending::start(move || {
            let recorder = drawings.as_deref_mut().map(|drawings| drawings as _);
            let history = moved.simulate(&own_ground, &own_request, recorder);
            (history, drawings)
        });
        let repeats = run.repeats();
        Ok(Some(Self {
            scenario,
            model,
            motion,
            repetitions: repeats.then(|| Repetitions::start(model, ground, request)),
            variations: run.variations(scenario)?,
        }))
    }

    /// Waits for the results.
    pub(super) fn finish(self) -> FinishedMirrored {
        let (history, mut drawings) = self.motion.wait();
        let history = match history {
            Ok(history) => history,
            Err(error) => {
                return FinishedMirrored {
                    summary: MirroredSummary::failed(error),
                    varied: self.variations.wait(),
                    page: None,
                };
            }
        };
        let repetitions = self.repetitions;
        let repeated = repetitions.map(|repetitions| repetitions.compare(&history));
        let notable = drawings
            .as_mut()
            .map(|drawings| mem::take(&mut drawings.notable));
        let mut summary = RunSummary::of(&ComputedRun {
            scenario: self.scenario,
            model: self.model,
            history: &history,
            impacts: notable.unwrap_or_default(),
            repeated: repeated.as_ref(),
            varied: &[],
            mirrored: None,
        });
        // The answer is that of both directions.
        summary.to_quote = None;
        FinishedMirrored {
            summary: MirroredSummary::of(&summary),
            varied: self.variations.wait(),
            page: drawings.map(|drawings| MirroredPage {
                history,
                summary,
                drawings,
            }),
        }
    }
}

/// The result under the mirrored ground motion in words, beside the verdict as given.
#[derive(Template)]
#[template(path = "studies/run/words/mirrored.txt")]
pub(super) struct MirroredWords<'a> {
    mirrored: &'a MirroredSummary,
}

impl RunSummary {
    /// Verdict of the motion itself, with its repetitions; [`RunSummary::verdict`] is the worse one of both directions.
    pub fn own_verdict(&self) -> Verdict {
        let repeated = self.repeatability.as_ref();
        let count = repeated.map(|all| &all.repeatability.count);
        Verdict::counted(self.outcome.with_side(), count)
    }

    /// Worse verdict of both directions without repetitions, with which variations are compared.
    pub(super) fn verdict_without_repetitions(&self) -> Verdict {
        let mirrored = self.mirrored.as_ref().and_then(|mirrored| mirrored.outcome);
        let own = Verdict::from(self.outcome.with_side());
        mirrored.map_or(own, |mirrored| own.max(mirrored.with_side().into()))
    }

    /// Result under the mirrored ground motion if its verdict is worse than that of the motion as given, or the same with a larger
    /// rotation. Overturned structures have no largest rotation.
    pub fn worse_mirrored(&self) -> Option<&MirroredSummary> {
        let mirrored = self.mirrored.as_ref()?;
        let own = self.own_verdict();
        let has_overturned = self.outcome.outcome == OutcomeKind::Overturned;
        let is_larger = mirrored.largest_peak_rotation_rad > Some(self.largest_peak_rotation_rad);
        let is_worse =
            mirrored.verdict > own || mirrored.verdict == own && is_larger && !has_overturned;
        is_worse.then_some(mirrored)
    }

    /// End of the worse direction.
    pub(super) fn worse_direction(&self) -> DirectionEnd {
        let mirrored = self.worse_mirrored().and_then(|mirrored| {
            Some(DirectionEnd {
                is_mirrored: true,
                verdict: mirrored.verdict,
                outcome: mirrored.outcome?,
                largest_peak_rotation_rad: mirrored.largest_peak_rotation_rad?,
            })
        });
        mirrored.unwrap_or(DirectionEnd {
            is_mirrored: false,
            verdict: self.own_verdict(),
            outcome: self.outcome,
            largest_peak_rotation_rad: self.largest_peak_rotation_rad,
        })
    }

    /// Words about the mirrored ground motion, and whether they precede the verdict as given, because they are worse; `None` without a
    /// second direction.
    pub(super) fn mirrored_words(&self) -> Option<(MirroredWords<'_>, bool)> {
        let mirrored = self.mirrored.as_ref()?;
        let is_worse = mirrored.verdict > self.own_verdict();
        Some((MirroredWords { mirrored }, is_worse))
    }

    /// Outcome in words that precede "this motion", with the direction in words that follow it. `only` is the single direction that is
    /// computed, if the other one is another problem.
    pub(super) fn outcome_in_words(&self, only: Option<Directions>) -> [&'static str; 2] {
        let overturns = |verdict| verdict == Verdict::Overturns;
        let mirrored = self.mirrored.as_ref();
        let mirrored = mirrored.map(|mirrored| overturns(mirrored.verdict));
        let governing = match self.worse_mirrored() {
            Some(_) => Direction::Mirrored,
            None => Direction::AsGiven,
        };
        match (overturns(self.own_verdict()), mirrored, only) {
            (true, Some(true), _) => ["overturns under", " in both directions"],
            (_, Some(true), _) | (true, None, Some(Directions::Mirrored)) => {
                ["overturns under", " in the mirrored direction"]
            }
            (true, Some(false), _) | (true, None, Some(_)) => {
                ["overturns under", " in the direction as given"]
            }
            (true, None, None) => ["overturns under", " in both directions"],
            (false, Some(_), _) => ["survives", directions_in_words(Directions::Both, governing)],
            (false, None, Some(only)) => ["survives", directions_in_words(only, governing)],
            (false, None, None) => ["survives", " in both directions"],
        }
    }
}
