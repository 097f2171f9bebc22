//! What a study reports about its cases in addition to their rows: their outcomes, failures and uncertainties.

use std::collections::BTreeMap;
use std::fmt;

use serde_json::{Value, json};

use super::ending::{Ending, Steps, Verdict};
use crate::dynamics::history::Outcome;
use crate::scenario::{Hinges, Scenario};

/// A case of a study that failed or is uncertain, as results list it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// The case, in words.
    pub case: String,
    /// The reason.
    pub reason: String,
}

impl Remark {
    pub(crate) fn new(case: String, reason: &str) -> Self {
        Self {
            case,
            reason: reason.to_owned(),
        }
    }
}

/// What a study reports about its cases in addition to their rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Remarks {
    /// The cases that failed, with the reasons.
    pub failures: Vec<Remark>,
    /// The cases for which it is uncertain whether they overturn, with the reasons.
    pub uncertain: Vec<Remark>,
    /// Number of histories that were computed.
    histories: usize,
    /// Number of histories among them that ended too early for a verdict.
    incomplete: usize,
    /// Smallest and largest, over the cases, of the longest step of a case, and of its shortest step, in seconds.
    steps_s: Option<[[f64; 2]; 2]>,
}

impl Remarks {
    /// Notes how a case ended.
    pub(crate) fn note(&mut self, case: impl Fn() -> String, ended: Result<&Ending, &str>) {
        let ending = match ended {
            Ok(ending) => ending,
            Err(reason) => return self.failures.push(Remark::new(case(), reason)),
        };
        if let Some(reason) = &ending.uncertain {
            self.uncertain.push(Remark::new(case(), reason));
        }
        self.note_history(ending);
    }

    /// Notes whether a history has a verdict, and the lengths of its steps.
    pub(crate) fn note_history(&mut self, ending: &Ending) {
        self.histories += 1;
        self.incomplete += usize::from(ending.verdict() == Verdict::Incomplete);
        if let Some(Steps {
            longest_s,
            shortest_s,
        }) = ending.steps
        {
            let own_s = [longest_s, shortest_s].map(|step_s| [step_s; 2]);
            let all_s = self.steps_s.get_or_insert(own_s);
            for ([least_s, most_s], [step_s, _]) in all_s.iter_mut().zip(own_s) {
                *least_s = least_s.min(step_s);
                *most_s = most_s.max(step_s);
            }
        }
    }

    /// Adds the remarks to a summary, if there are any.
    pub(crate) fn add_to(&self, summary: &mut Value) {
        let list = |remarks: &[Remark]| -> Value {
            let list = remarks.iter();
            list.map(|remark| json!({ "case": remark.case, "reason": remark.reason }))
                .collect()
        };
        let lists = [
            ("failures", &self.failures),
            ("uncertain_cases", &self.uncertain),
        ];
        for (name, remarks) in lists {
            if !remarks.is_empty() {
                summary[name] = list(remarks);
            }
        }
        if let Some(steps_s) = self.steps_s {
            let names = ["longest_step_s", "shortest_step_s"];
            for (name, [least_s, most_s]) in names.into_iter().zip(steps_s) {
                summary[name] = json!({ "min": least_s, "max": most_s });
            }
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.case, self.reason)
    }
}

/// How far results of many cases with four links can be trusted: their line of thrust is not followed. The program and the Python package
/// issue it, so it names no options.
const FOUR_LINKS: &str = "four links are a rough guide, not on the safe side, unless the thrust line stays inside the arch, which is not \
                          checked here: check it in single runs, and compare with free hinges";

/// How far the results of many cases can be trusted; `None` if the model of motion is not four links of an arch.
pub(crate) fn rough_guide(scenario: &Scenario) -> Option<&'static str> {
    let four = scenario.motion().hinges() == Hinges::Four && scenario.structure().thrusts();
    four.then_some(FOUR_LINKS)
}

/// The four-link caveat among the warnings of a study, if it applies.
pub(crate) fn rough_guide_of(warnings: &[String]) -> Option<&'static str> {
    let given = warnings.iter().any(|warning| warning == FOUR_LINKS);
    given.then_some(FOUR_LINKS)
}

/// Warnings about the results of many cases: unlikely numbers of the scenario, and how far four links can be trusted.
#[must_use]
pub fn warnings(scenario: &Scenario) -> Vec<String> {
    let mut warnings = scenario.unlikely();
    warnings.extend(rough_guide(scenario).map(str::to_owned));
    warnings
}

/// The summary of a study as JSON: its scenario, warnings, the number of its cases, and the remarks on them.
pub(crate) fn summary(scenario: &Scenario, cases: usize, remarks: &Remarks) -> Value {
    let mut summary = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "scenario": scenario.to_json(),
        "warnings": remarks.with_incomplete(warnings(scenario)),
        "record_checksums": scenario.record_checksums(),
        "cases": cases,
    });
    remarks.add_to(&mut summary);
    summary
}

/// How many of these cases ended too early for a verdict, and what to do; `None` if none did.
pub(crate) fn no_verdict(incomplete: usize, of: usize, cases: &str) -> Option<String> {
    let what_to_do = Ending::INCOMPLETE;
    (incomplete > 0).then(|| format!("no verdict from {incomplete} of {of} {cases}; {what_to_do}"))
}

impl Remarks {
    /// How many histories ended too early for a verdict, and what to do; `None` if none did.
    pub(crate) fn incomplete_in_words(&self) -> Option<String> {
        no_verdict(self.incomplete, self.histories, "histories")
    }

    /// The warnings of a study, and one about histories without a verdict if there are any.
    pub(crate) fn with_incomplete(&self, mut warnings: Vec<String>) -> Vec<String> {
        warnings.extend(self.incomplete_in_words());
        warnings
    }

    /// How many cases failed, why the first one did, and which file lists the others; `None` if none failed.
    pub(crate) fn failed_in_words(&self, file: &str) -> Option<String> {
        let (count, first) = (self.failures.len(), self.failures.first()?);
        let others = if count > 1 {
            format!("; all are in {file}")
        } else {
            String::new()
        };
        Some(format!("failed: {count}; the first: {first}{others}"))
    }

    /// How many cases are uncertain, and which file lists them; `None` if none is.
    pub(crate) fn uncertain_in_words(&self, file: &str) -> Option<String> {
        let first = self.uncertain.first()?;
        let listed = match self.uncertain.len() {
            1 => String::new(),
            _ => format!("; all are in {file}"),
        };
        Some(format!(
            "uncertain: with other steps, or with landings merged, they end otherwise or differ before the largest rotation; the first: {first}{listed}"
        ))
    }
}

/// Words for an outcome, and their position in the list of counts.
pub(crate) type Words = (u8, &'static str);

/// How a case ended, in words.
pub(crate) const fn in_words(ending: &Ending) -> Words {
    match (&ending.uncertain, ending.outcome) {
        (Some(_), _) => (5, "are uncertain"),
        (None, Outcome::NeverMoved) => (0, "never move"),
        (None, Outcome::Vibrates) => (1, "vibrate without opening"),
        (None, Outcome::Rest) => (2, "come to rest"),
        (None, Outcome::Overturned(_)) => (3, "overturn"),
        (None, Outcome::StillRocking) => (4, "are still rocking"),
        (None, Outcome::Incomplete) => (6, "are incomplete"),
    }
}

/// The number of cases with each outcome, in words.
pub(crate) fn counts(cases: impl Iterator<Item = Words>) -> String {
    let mut counts = BTreeMap::new();
    for words in cases {
        *counts.entry(words).or_insert(0_usize) += 1;
    }
    let parts = counts
        .into_iter()
        .map(|((_, words), count)| format!("{count} {words}"));
    parts.collect::<Vec<_>>().join(", ")
}
