//! The samples of a scenario's `[uncertain]`, computed in addition to the scenario itself.

use archrock::output::Figure;
use archrock::scenario::Scenario;
use archrock::studies::catalogue::{StudyKind, first_edges};
use archrock::studies::results::{Look, Results};
use archrock::studies::threshold::Factors;

use super::Failure;
use super::scenario_file::Destination;
use super::study::{Pending, Work};

/// How the samples are computed and reported.
#[derive(Clone, Copy)]
pub struct Telling {
    pub work: Work,
    pub figure: Figure,
    pub quiet: bool,
}

/// What is asked of the samples.
#[derive(Clone, Copy)]
pub enum Asked {
    /// How their histories end, and how they proceed.
    Histories,
    /// The first of these factors from which they overturn.
    FirstEdges(Factors),
    /// Which records overturn them, and from which intensity.
    Suite,
    /// What becomes of the cells of a map, which looks like this.
    Map(Look),
}

impl Telling {
    /// Whether only a part of the samples is asked for; an error if a scenario has no samples.
    pub fn is_part<'s>(
        self,
        scenarios: impl IntoIterator<Item = &'s Scenario>,
    ) -> Result<bool, Failure> {
        let mut scenarios = scenarios.into_iter();
        if self.work.is_part() && !scenarios.all(|scenario| scenario.uncertain().is_some()) {
            let message =
                "--shard computes a part of the samples of [uncertain], which the scenario lacks";
            return Err(Failure::Input(message.to_owned()));
        }
        Ok(self.work.is_part())
    }

    /// Computes the samples of a scenario that has `[uncertain]`, and prepares their results in their own folder inside
    /// `place`, which the words name. Returns `None` if the scenario has no `[uncertain]`, or if only a part is computed.
    pub fn tell(
        self,
        scenario: &Scenario,
        asked: Asked,
        place: &Destination,
        pending: &mut Pending,
    ) -> Result<Option<Results>, Failure> {
        if scenario.uncertain().is_none() {
            return Ok(None);
        }
        let look = match asked {
            Asked::Map(look) => look.of_samples(),
            _ => Look::of(self.figure),
        };
        let kind = match asked {
            Asked::Histories => StudyKind::Uncertain,
            Asked::FirstEdges(_) => StudyKind::UncertainThreshold,
            Asked::Suite => StudyKind::UncertainSuite,
            Asked::Map(_) => StudyKind::UncertainMap,
        };
        let place = place.within(kind.name());
        let done = self
            .work
            .compute(kind.name(), &place, self.quiet, |runner, task, watch| {
                let task = Some(task);
                Ok(match asked {
                    Asked::Histories | Asked::Suite | Asked::Map(_) => {
                        kind.compute(scenario, look, runner, task, watch)?
                    }
                    Asked::FirstEdges(factors) => {
                        first_edges(scenario, factors, look, runner, task, watch)?
                    }
                })
            })?;
        let Some((mut results, part)) = done else {
            return Ok(None);
        };
        pending.prepare(&place, &results, part)?;
        results.words = format!(
            "  {}\n  results in {}\n",
            results.words,
            place.holds(&results)
        );
        Ok(Some(results))
    }
}

/// Heading before the report on the scenario itself. The report on its samples comes first, with the probability of overturning.
pub const ITSELF: &str = "the scenario itself:\n";
