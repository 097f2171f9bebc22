//! The verdict of a run in one line: what happened, how sure that is, and on what it depends.

use super::comparison::otherwise;
use super::words::{in_percent, needs};
use crate::dynamics::history::{Outcome, Summary};
use crate::dynamics::repeatability::{Repeatability, RepeatabilityError, Verdict};
use crate::dynamics::thrust::EXCESS_LEVELS;
use crate::dynamics::variation::Varied;
use crate::scenario::{Hinges, Scenario};

/// The evidence for the verdict on a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evidence<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) history: &'a Summary,
    pub(super) spread: Option<&'a Result<Repeatability, RepeatabilityError>>,
    pub(super) varied: &'a [Varied],
}

impl Evidence<'_> {
    /// Whether the structure overturns, as far as this is known.
    pub(super) fn verdict(&self) -> Verdict {
        let own = Verdict::from(self.history.outcome);
        if own != Verdict::Incomplete && self.repeated().is_some_and(Repeatability::is_uncertain) {
            return Verdict::Uncertain;
        }
        own
    }

    /// The verdict, as a line.
    pub(super) fn in_words(&self) -> String {
        let mut doubts = self.doubts();
        let sure = self.how_sure();
        let mut text = self.what_happens();
        if let Some(sure) = sure {
            text += ", ";
            text += &sure;
        }
        doubts.insert(0, text);
        format!("  {}\n", doubts.join("; "))
    }

    fn repeated(&self) -> Option<&Repeatability> {
        self.spread.and_then(|spread| spread.as_ref().ok())
    }

    fn what_happens(&self) -> String {
        let history = self.history;
        if self.verdict() == Verdict::Uncertain {
            let spread = self.repeated();
            let names = spread.map_or(&[][..], |spread| &spread.repeated[..]);
            let own = Verdict::from(history.outcome);
            let outcomes = spread
                .into_iter()
                .flat_map(|spread| spread.outcomes.iter().skip(1));
            let other = names
                .iter()
                .zip(outcomes)
                .filter(|(_, other)| Verdict::from(**other) != own);
            let names: Vec<&str> = other.map(|(name, _)| *name).collect();
            if let (true, Some(early)) = (names.is_empty(), spread.and_then(|spread| spread.early))
            {
                let percent = 100.0 * early.ratio;
                let verdict = if own == Verdict::Overturns {
                    "overturns"
                } else {
                    "survives"
                };
                return format!(
                    "UNCERTAIN: {verdict}, but the half cycle at {:.4} s, before the largest rotation, differs by {percent:.1} % with {}",
                    early.peak_time_s, early.repetition
                );
            }
            let [does, otherwise] = match own {
                Verdict::Overturns => ["overturns", "survives"],
                _ => ["survives", "overturns"],
            };
            return format!(
                "UNCERTAIN: {does}, and {otherwise} with {}",
                names.join(" and ")
            );
        }
        match history.outcome {
            Outcome::Overturned(sway) => format!("overturns to the {}", sway.name()),
            Outcome::NeverMoved => "never moves: the ground is too weak to start it".to_owned(),
            Outcome::Vibrates => "survives: it vibrates, and no joint opens".to_owned(),
            Outcome::Incomplete => no_verdict(self.scenario, history),
            Outcome::Rest | Outcome::StillRocking => {
                let (rotation, energy) = (
                    history.peak_over_critical(),
                    history.peak_potential_over_barrier(),
                );
                let elastic = self.scenario.motion().hinges() == Hinges::Elastic;
                match (rotation, energy) {
                    (Some(part), _) if part < 1.0 => {
                        format!("survives: peak {} of overturning", in_percent(part))
                    }
                    (None, Some(part)) if part < 1.0 => {
                        let percent = in_percent(part);
                        let rigid = if elastic { " with rigid joints" } else { "" };
                        format!("survives: peak potential energy {percent} of overturning{rigid}")
                    }
                    _ => "survives".to_owned(),
                }
            }
        }
    }

    /// How sure the outcome is, from the repetitions or from the line of thrust of four links.
    fn how_sure(&self) -> Option<String> {
        if let Outcome::NeverMoved | Outcome::Incomplete = self.history.outcome {
            return None;
        }
        if let Some(spread) = self.repeated() {
            let known = self.verdict() != Verdict::Uncertain;
            return known.then(|| agreement(spread, self.history.outcome));
        }
        let is_arch = self.scenario.structure().thrusts();
        let four = self.scenario.motion().hinges() == Hinges::Four && is_arch;
        let thrust = self.history.thrust.as_ref().filter(|_| four)?;
        thrust.shares_within()?;
        let excess = thrust.largest_excess.value;
        let grade = if excess <= EXCESS_LEVELS[0] {
            "and four links suffice"
        } else if excess <= EXCESS_LEVELS[1] {
            "and four links are close"
        } else {
            "but four links are a rough guide"
        };
        Some(grade.to_owned())
    }

    /// On what the outcome depends: friction that stone may not have, and properties that change the ending.
    fn doubts(&self) -> Vec<String> {
        if self.history.outcome == Outcome::Incomplete {
            return Vec::new();
        }
        let needed = needs(self.scenario, self.history).into_iter();
        needed.chain(otherwise(self.history, self.varied)).collect()
    }
}

/// In which sense repetitions agree that the structure overturns or survives: it may overturn to either side, or rest earlier.
fn agreement(spread: &Repeatability, own: Outcome) -> String {
    if spread.same_outcome() {
        return "the same with other steps".to_owned();
    }
    let Outcome::Overturned(sway) = own else {
        return "and survives with other steps".to_owned();
    };
    let outcomes = spread.outcomes.iter().skip(1);
    let opposite = spread
        .repeated
        .iter()
        .zip(outcomes)
        .filter(|(_, other)| **other != own)
        .map(|(name, _)| *name);
    let names = opposite.collect::<Vec<_>>().join(" and ");
    format!("and to the {} with {names}", sway.opposite().name())
}

/// Why an incomplete run has no verdict, and what to do.
pub(super) fn no_verdict(scenario: &Scenario, history: &Summary) -> String {
    let (end_s, ground_s) = (history.end_s, scenario.ground_motion().end_s());
    let why = if end_s < ground_s {
        format!("the run ends at {end_s:.4} s and the ground moves until {ground_s:.4} s")
    } else {
        format!(
            "at {end_s:.4} s, the end of the run, it moves with more than a quarter of the energy that overturns it"
        )
    };
    format!("NO VERDICT: {why}; give a longer duration_s in [simulation]")
}
