//! How histories ended, as columns of a table.

use super::{OutputError, finite};
use crate::dynamics::history::Outcome;
use crate::studies::specimen::Verdict;

/// Names of the columns.
pub const COLUMNS: [&str; 7] = [
    "outcome",
    "overturning_sway",
    "impacts",
    "impacts_before_overturning",
    "outcome_time_s",
    "peak_rotation_over_critical",
    "energy_defect_ratio",
];

/// Outcome where a history could not be computed.
pub const FAILED: &str = "failed";

/// The fields of a verdict. Only what overturned has a sway and impacts before it.
///
/// # Errors
/// When a value is not finite.
pub fn fields(verdict: &Verdict) -> Result<[String; 7], OutputError> {
    let Verdict {
        outcome,
        outcome_time_s,
        impacts,
        peak_over_critical,
        energy_defect_ratio,
    } = *verdict;
    finite(
        "of a history",
        &[outcome_time_s, peak_over_critical, energy_defect_ratio],
    )?;
    let (sway, before) = match outcome {
        Outcome::Overturned(sway) => (sway.name().to_owned(), impacts.to_string()),
        _ => (String::new(), String::new()),
    };
    Ok([
        outcome.name().to_owned(),
        sway,
        impacts.to_string(),
        before,
        format!("{outcome_time_s:?}"),
        format!("{peak_over_critical:?}"),
        format!("{energy_defect_ratio:?}"),
    ])
}

/// The fields where there is no history, for the reason named.
#[must_use]
pub fn none(reason: &str) -> [String; 7] {
    let mut fields = <[String; 7]>::default();
    reason.clone_into(&mut fields[0]);
    fields
}
