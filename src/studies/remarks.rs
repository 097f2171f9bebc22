//! Remarks of a study on its cases: their outcomes, failures and uncertainties.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::ending::columns::{
    CANNOT_STAND, FAILED, GROUND_FALLS, NOT_FOUR_LINKS, OVERTURNED, UNCERTAIN,
};
use super::ending::{Ending, NoHistory, Verdict, outcome_name};
use super::quotable::{SurvivorFriction, directions_in_words};
use super::report::Warnings;
use crate::dynamics::{Directions, EXCESS_LEVELS, MODEL_LIMIT, OutcomeCount};
use crate::scenario::Varied;
use crate::{Outcome, Scenario};

/// A failed or uncertain case, as results list it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remark {
    /// The case, in words.
    pub case: String,
    /// The reason.
    pub reason: String,
    /// Count of the outcomes of an uncertain case; absent for failed cases.
    #[serde(flatten)]
    pub count: Option<OutcomeCount>,
}

impl Remark {
    pub(crate) fn new(case: String, reason: &str) -> Self {
        Self {
            case,
            reason: reason.to_owned(),
            count: None,
        }
    }
}

/// Failed and uncertain cases of a study, and the steps of its histories.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Remarks {
    /// The cases that failed, with the reasons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<Remark>,
    /// The cases for which it is uncertain whether they overturn, with the reasons.
    #[serde(
        default,
        rename = "uncertain_cases",
        skip_serializing_if = "Vec::is_empty"
    )]
    pub uncertain: Vec<Remark>,
    /// The histories of four links outside their model.
    #[serde(flatten)]
    pub(crate) model: ModelCheck,
    /// Number of cases with a history; absent if they are not counted.
    #[serde(default, skip_serializing_if = "is_zero")]
    histories: usize,
    /// Number of histories among them that ended too early for a verdict; absent without any.
    #[serde(default, skip_serializing_if = "is_zero")]
    histories_without_verdict: usize,
    /// The longest steps of the cases, in seconds; absent if a tolerance sets the steps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    longest_step_s: Option<StepRange>,
    /// The shortest steps of the cases, in seconds; absent if a tolerance sets the steps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shortest_step_s: Option<StepRange>,
}

/// The range of the steps of several histories, in seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct StepRange {
    /// The smallest.
    min: f64,
    /// The largest.
    max: f64,
}

impl StepRange {
    /// Range with one more step.
    fn with(range: Option<Self>, value: f64) -> Option<Self> {
        let ends = range.map_or((value, value), |Self { min, max }| {
            (min.min(value), max.max(value))
        });
        let (min, max) = ends;
        Some(Self { min, max })
    }
}

impl Remarks {
    /// Adds the ending of a case, or the reason of its failure. A structure that cannot stand, or is no mechanism of four links, is no failure.
    pub(crate) fn add_case(
        &mut self,
        case: impl Fn() -> String,
        result: &Result<Ending, NoHistory>,
    ) {
        match result {
            Ok(ending) => {
                self.uncertain.extend(ending.doubt().map(|count| Remark {
                    count: Some(count.clone()),
                    ..Remark::new(case(), &count.to_string())
                }));
                self.note_history(ending);
            }
            Err(NoHistory::CannotStand | NoHistory::NotFourLinks) => {}
            Err(NoHistory::GroundFalls(reason) | NoHistory::Failed(reason)) => {
                self.failures.push(Remark::new(case(), reason));
            }
        }
    }

    /// Counts a history with or without a verdict, and adds the lengths of its steps.
    pub(crate) fn note_history(&mut self, ending: &Ending) {
        self.histories += 1;
        self.histories_without_verdict += usize::from(ending.verdict() == Verdict::Incomplete);
        self.model.add_history(ending.thrust_excess_ratio);
        if let Some(steps) = ending.steps {
            self.longest_step_s = StepRange::with(self.longest_step_s, steps.longest_s);
            self.shortest_step_s = StepRange::with(self.shortest_step_s, steps.shortest_s);
        }
    }

    /// Warnings about the model of four links, and about histories without a verdict; `cases` are the histories in words.
    pub(crate) fn warnings(&self, cases: &str) -> impl Iterator<Item = String> + use<> {
        let warnings = [self.model.in_words(cases), self.incomplete_in_words()];
        warnings.into_iter().flatten()
    }

    /// Number of histories that ended too early for a verdict, and the remedy, in words; `None` if the number is zero.
    pub(crate) fn incomplete_in_words(&self) -> Option<String> {
        no_verdict(self.histories_without_verdict, self.histories, "histories")
    }

    /// Number of failed cases, the first reason, and the file that lists the others, in words; `None` if no case failed.
    pub(crate) fn failed_in_words(&self, file: &str) -> Option<String> {
        let failures = first_of(&self.failures, file)?;
        Some(format!("failed: {}; {failures}", self.failures.len()))
    }

    /// First uncertain case and the file that lists the others, in words; `None` if no case is uncertain.
    pub(crate) fn uncertain_in_words(&self, file: &str) -> Option<String> {
        let cases = first_of(&self.uncertain, file)?;
        Some(format!(
            "uncertain cases overturn in some repetitions and survive in others; {cases}"
        ))
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.case, self.reason)
    }
}

/// Histories of four links, and those among them whose thrust line leaves the arch too far for the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModelCheck {
    /// Number of histories of four links that are outside the model; absent for other models.
    #[serde(
        default,
        rename = "outside_model",
        skip_serializing_if = "Option::is_none"
    )]
    pub(crate) outside: Option<usize>,
    /// Number of histories of four links; absent for other models.
    #[serde(
        default,
        rename = "four_link_histories",
        skip_serializing_if = "is_zero"
    )]
    pub(crate) of: usize,
    /// Largest excess of the thrust line, over the thickness; absent if it is unknown, or for other models.
    #[serde(
        default,
        rename = "largest_thrust_excess_ratio",
        skip_serializing_if = "Option::is_none"
    )]
    pub(crate) largest_ratio: Option<f64>,
}

fn is_zero<N: Default + PartialEq>(number: &N) -> bool {
    *number == N::default()
}

impl ModelCheck {
    /// Makes the check of histories with these excesses of the thrust line; `None` for other models.
    pub(crate) fn of(excess_ratios: impl IntoIterator<Item = Option<f64>>) -> Self {
        let mut check = Self::default();
        excess_ratios
            .into_iter()
            .for_each(|ratio| check.add_history(ratio));
        check
    }

    /// Makes the check of a number of histories outside the model and of a number of all; `None` for other models. The excesses are unknown.
    pub(crate) fn counted(counts: Option<[usize; 2]>) -> Self {
        let [outside, of] = counts.unwrap_or_default();
        Self {
            outside: counts.map(|_| outside),
            of,
            largest_ratio: None,
        }
    }

    /// Check with this number of further histories outside the model, whose excess is not known.
    pub(crate) fn with_outside(self, outside: usize) -> Self {
        match outside {
            0 => self,
            _ => Self {
                outside: Some(self.outside.unwrap_or(0) + outside),
                of: self.of + outside,
                largest_ratio: None,
            },
        }
    }

    /// Adds a history.
    fn add_history(&mut self, excess_ratio: Option<f64>) {
        let Some(ratio) = excess_ratio else {
            return;
        };
        self.of += 1;
        *self.outside.get_or_insert(0) += usize::from(ratio > MODEL_LIMIT);
        self.largest_ratio = Some(self.largest_ratio.map_or(ratio, |most| most.max(ratio)));
    }

    /// Number of `cases` outside the model, or the largest excess of the thrust line, and the remedy, in words. `None` if the thrust line
    /// stays almost inside. The text names no options, because the Python package prints it too.
    pub(crate) fn in_words(&self, cases: &str) -> Option<String> {
        let (of, outside) = (self.of, self.outside?);
        if outside > 0 {
            return Some(format!(
                "{outside} of {of} {cases} are outside the model of four links (the thrust line leaves the arch by more than {MODEL_LIMIT} \
                 thicknesses), not on the safe side: compute them with free hinges"
            ));
        }
        let leaves = match self.largest_ratio {
            None if of == 0 => return None,
            None => format!("may leave the arch by up to {MODEL_LIMIT}"),
            Some(ratio) if ratio > EXCESS_LEVELS[1] => {
                format!("leaves the arch by up to {ratio:.3}")
            }
            Some(_) => return None,
        };
        Some(format!(
            "four links are a rough guide, not on the safe side: the thrust line {leaves} thicknesses; compare with free hinges"
        ))
    }
}

/// The common part of reports on many cases; it comes first.
#[derive(Serialize, Deserialize)]
pub(crate) struct CaseSummary {
    /// Name of the program.
    program: String,
    /// Version of the program.
    version: String,
    /// The scenario with all defaults.
    scenario: Value,
    #[serde(flatten)]
    pub(crate) warnings: Warnings,
    /// Name and checksum of each record file.
    record_checksums: Vec<String>,
    /// The only direction of the ground motion that was computed, in words; absent if both count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) one_direction: Option<String>,
    /// Number of cases.
    pub(crate) cases: usize,
    #[serde(flatten)]
    pub(super) friction: SurvivorFriction,
    #[serde(flatten)]
    pub(crate) remarks: Remarks,
}

impl CaseSummary {
    /// Makes the summary, with warnings about the results. `study` are options that are not part of the scenario.
    pub(crate) fn new(
        (scenario, study): (&Scenario, &Varied<'_>),
        cases: usize,
        remarks: Remarks,
        friction: SurvivorFriction,
        warnings: impl IntoIterator<Item = String>,
    ) -> Self {
        let one_direction = one_direction(scenario);
        let warnings = warnings
            .into_iter()
            .chain(friction.friction_condition.clone())
            .chain(one_direction.clone());
        Self {
            program: env!("CARGO_PKG_NAME").to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scenario: scenario.to_json(),
            warnings: Warnings::new(scenario.unlikely_in(study), warnings),
            record_checksums: scenario.record_checksums(),
            one_direction,
            cases,
            friction,
            remarks,
        }
    }
}

/// The only direction of the ground motion that a study of many cases computes, in words; `None` if the structure has no second direction, or
/// both count.
pub(crate) fn one_direction(scenario: &Scenario) -> Option<String> {
    let directions = scenario.simulation.direction;
    if directions == Directions::Both {
        return None;
    }
    let both = scenario.in_directions(Directions::Both);
    let model = both.model().ok()?;
    let only = directions_in_words(directions, directions.first());
    both.has_second_direction(&*model).then(|| {
        format!("computed{only}; the opposite direction may overturn the structure earlier")
    })
}

/// Number of cases that ended too early for a verdict, and the remedy, in words; `None` if the number is zero.
pub(crate) fn no_verdict(incomplete: usize, of: usize, cases: &str) -> Option<String> {
    let what_to_do = Ending::INCOMPLETE;
    (incomplete > 0).then(|| format!("no verdict from {incomplete} of {of} {cases}; {what_to_do}"))
}

/// First remark, and the file that lists the others, in words; `None` without remarks.
fn first_of(remarks: &[Remark], file: &str) -> Option<String> {
    let (first, others) = remarks.split_first()?;
    let listed = match others {
        [] => String::new(),
        _ => format!("; all are in {file}"),
    };
    Some(format!("the first: {first}{listed}"))
}

/// Number of cases with each outcome, by its name in tables; falling ground counts as failed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct OutcomeCounts(BTreeMap<String, usize>);

/// The outcomes of cases: names in tables, and words, in the order of a sentence.
const OUTCOME_WORDS: [(&str, &str); 10] = [
    (Outcome::NeverMoved.name(), "never moved"),
    (Outcome::Vibrates.name(), "vibrated without opening"),
    (Outcome::Rest.name(), "came to rest"),
    (OVERTURNED, "overturned"),
    (STILL_ROCKING, "still rocking"),
    (UNCERTAIN, "uncertain"),
    (Outcome::Incomplete.name(), "incomplete"),
    (CANNOT_STAND, "unable to stand"),
    (NOT_FOUR_LINKS, "too thick for four links"),
    (FAILED, "failed"),
];
const STILL_ROCKING: &str = Outcome::StillRocking.name();

impl OutcomeCounts {
    /// Counts the results of cases.
    pub(crate) fn of<'r>(results: impl Iterator<Item = &'r Result<Ending, NoHistory>>) -> Self {
        let mut counts = BTreeMap::new();
        for result in results {
            let name = match outcome_name(result) {
                GROUND_FALLS => FAILED,
                name => name,
            };
            *counts.entry(name.to_owned()).or_insert(0) += 1;
        }
        Self(counts)
    }

    /// Number of all cases.
    pub(crate) fn total(&self) -> usize {
        self.0.values().sum()
    }

    /// True if cases still rock at the end.
    pub(crate) fn has_still_rocking(&self) -> bool {
        self.0.contains_key(STILL_ROCKING)
    }
}

impl fmt::Display for OutcomeCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = OUTCOME_WORDS
            .iter()
            .filter_map(|(name, words)| Some((self.0.get(*name)?, words)));
        for (index, (count, words)) in known.enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{count} {words}")?;
        }
        Ok(())
    }
}
