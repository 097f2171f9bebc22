//! How histories ended, as columns of a table.

use std::fmt;

use serde_json::{Value, json};

use super::{OutputError, finite};
use crate::dynamics::history::Outcome;
use crate::studies::ending::{Ending, Steps};

/// Names of the columns of any model.
const COLUMNS: [&str; 7] = [
    "outcome",
    "overturning_sway",
    "impacts",
    "impacts_before_overturning",
    "outcome_time_s",
    "peak_rotation_over_critical",
    "energy_defect_ratio",
];

/// What rows of blocks have besides.
const PEAK_ROTATION: &str = "peak_rotation_rad";

/// Names of the columns.
pub(super) fn columns(free_hinges: bool) -> impl Iterator<Item = &'static str> {
    COLUMNS
        .into_iter()
        .chain(free_hinges.then_some(PEAK_ROTATION))
}

/// Outcome where a history could not be computed.
pub const FAILED: &str = "failed";
/// Outcome where it is uncertain whether it overturns.
pub(super) const UNCERTAIN: &str = "uncertain";

/// The outcome of a case of a study.
#[must_use]
pub const fn outcome(ending: &Ending) -> &'static str {
    match ending.uncertain {
        Some(_) => UNCERTAIN,
        None => ending.outcome.name(),
    }
}

/// To which side a case overturned, where it certainly did.
pub(super) const fn overturning_sway(ending: &Ending) -> Option<&'static str> {
    match (ending.outcome, &ending.uncertain) {
        (Outcome::Overturned(sway), None) => Some(sway.name()),
        _ => None,
    }
}

/// The fields of an ending, as many as columns. Only what certainly overturned has a sway and impacts before it; the numbers of
/// what is uncertain are those of the history itself, not of its repetitions.
///
/// # Errors
/// When a value is not finite.
pub(super) fn fields(ending: &Ending) -> Result<Vec<String>, OutputError> {
    let Ending {
        outcome_time_s,
        impacts,
        energy_defect_ratio,
        peak,
        ..
    } = *ending;
    finite("of a history", &[outcome_time_s, energy_defect_ratio])?;
    finite("of a history", peak.over_critical().as_slice())?;
    finite("of a history", peak.rad().as_slice())?;
    let sway = overturning_sway(ending);
    let mut fields = vec![
        outcome(ending).to_owned(),
        sway.unwrap_or_default().to_owned(),
        impacts.to_string(),
        sway.map_or(String::new(), |_| impacts.to_string()),
        number(outcome_time_s),
        peak.over_critical().map_or(String::new(), number),
        number(energy_defect_ratio),
    ];
    fields.extend(peak.rad().map(number));
    Ok(fields)
}

/// The fields where there is no history, for the reason named.
pub(super) fn none(reason: &str, free_hinges: bool) -> Vec<String> {
    let mut fields = vec![String::new(); columns(free_hinges).count()];
    reason.clone_into(&mut fields[0]);
    fields
}

/// A number with the fewest digits that read back as the same `f64`.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A case of a study that failed or is uncertain, as results list it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// Which case, in words.
    pub case: String,
    /// Why.
    pub reason: String,
}

impl Remark {
    pub(super) fn new(case: String, reason: &str) -> Self {
        Self {
            case,
            reason: reason.to_owned(),
        }
    }
}

/// What a study says of its cases beside their rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Remarks {
    /// The cases that failed, and why.
    pub failures: Vec<Remark>,
    /// The cases of which it is uncertain whether they overturn, and why.
    pub uncertain: Vec<Remark>,
    /// The shortest and the longest of the longest steps of the cases, in seconds, and of their shortest ones.
    steps_s: Option<[[f64; 2]; 2]>,
}

impl Remarks {
    /// Notes how a case ended.
    pub(super) fn note(&mut self, case: impl Fn() -> String, ended: Result<&Ending, &str>) {
        let ending = match ended {
            Ok(ending) => ending,
            Err(reason) => return self.failures.push(Remark::new(case(), reason)),
        };
        if let Some(reason) = &ending.uncertain {
            self.uncertain.push(Remark::new(case(), reason));
        }
        self.note_steps(ending);
    }

    /// Notes the steps of a case.
    pub(super) fn note_steps(&mut self, ending: &Ending) {
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

    /// Adds them to a summary, as far as there are any.
    pub(super) fn add_to(&self, summary: &mut Value) {
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
