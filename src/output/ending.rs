//! How histories ended, as columns of a table.

use std::fmt;

use serde_json::{Value, json};

use super::{OutputError, finite};
use crate::dynamics::history::Outcome;
use crate::studies::ending::Ending;

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

/// The fields of an ending, as many as columns. Only what overturned has a sway and impacts before it.
///
/// # Errors
/// When a value is not finite.
pub(super) fn fields(ending: &Ending) -> Result<Vec<String>, OutputError> {
    let Ending {
        outcome,
        outcome_time_s,
        impacts,
        energy_defect_ratio,
        peak,
    } = *ending;
    finite("of a history", &[outcome_time_s, energy_defect_ratio])?;
    finite("of a history", peak.over_critical().as_slice())?;
    finite("of a history", peak.rad().as_slice())?;
    let (sway, before) = match outcome {
        Outcome::Overturned(sway) => (sway.name().to_owned(), impacts.to_string()),
        _ => (String::new(), String::new()),
    };
    let mut fields = vec![
        outcome.name().to_owned(),
        sway,
        impacts.to_string(),
        before,
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

/// A case of a study that failed, as results list it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failed {
    /// Which case, in words.
    pub case: String,
    /// Why.
    pub reason: String,
}

impl Failed {
    pub(super) fn new(case: String, reason: &str) -> Self {
        Self {
            case,
            reason: reason.to_owned(),
        }
    }

    /// Adds the list of failures to a summary, if there are any.
    pub(super) fn list_in(summary: &mut Value, failures: &[Self]) {
        if !failures.is_empty() {
            let list = failures
                .iter()
                .map(|failed| json!({ "case": failed.case, "reason": failed.reason }));
            summary["failures"] = list.collect();
        }
    }
}

impl fmt::Display for Failed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.case, self.reason)
    }
}
