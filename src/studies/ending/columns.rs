//! The endings of histories as columns of a table.

use super::{Ending, NoHistory, Verdict};
use crate::dynamics::OutcomeKind;
use crate::output::{Column, column, each, list};
use crate::{Outcome, Sway};

/// Outcome of a case whose history could not be computed.
pub(crate) const FAILED: &str = "failed";
/// Outcome of a sample outside the model of four links.
pub(crate) const OUTSIDE_MODEL: &str = "outside_model";
/// Outcome of a case whose overturning is uncertain.
pub(crate) const UNCERTAIN: &str = "uncertain";

/// Outcome of a case that overturned.
pub(crate) const OVERTURNED: &str = OutcomeKind::Overturned.name();

/// Names of the outcomes that count, the first is overturning.
pub(crate) const OUTCOMES: [&str; 6] = [
    OVERTURNED,
    UNCERTAIN,
    Outcome::Rest.name(),
    Outcome::NeverMoved.name(),
    Outcome::Vibrates.name(),
    Outcome::StillRocking.name(),
];

/// Outcome of an arch that cannot carry its own weight.
pub(crate) const CANNOT_STAND: &str = "cannot_stand";
/// Outcome of an arch that is too thick to rock as four links.
pub(crate) const NOT_FOUR_LINKS: &str = "not_four_links";
/// Outcome if the ground accelerates downwards as fast as a free fall.
pub(crate) const GROUND_FALLS: &str = "ground_falls";

impl NoHistory {
    /// Name of the reason in tables, in place of an outcome.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::CannotStand => CANNOT_STAND,
            Self::NotFourLinks => NOT_FOUR_LINKS,
            Self::GroundFalls(_) => GROUND_FALLS,
            Self::Failed(_) => FAILED,
        }
    }
}

/// True if all histories are of mechanisms: their rotations are drawn over the critical one, those of rows of blocks in radians.
pub(crate) fn are_over_critical<'a>(
    results: impl IntoIterator<Item = &'a Result<Ending, NoHistory>>,
) -> bool {
    let mut endings = results.into_iter().flatten();
    endings.all(|ending| ending.peak_over_critical.is_some())
}

/// Outcome of a case by its name in tables, or the reason why the case has no history.
pub fn outcome_name(result: &Result<Ending, NoHistory>) -> &'static str {
    let ending = result.as_ref();
    ending.map_or_else(NoHistory::name, Ending::outcome_name)
}

impl Ending {
    /// Name of the outcome of a case.
    pub fn outcome_name(&self) -> &'static str {
        match self.verdict() {
            Verdict::Uncertain => UNCERTAIN,
            _ => self.outcome.name(),
        }
    }

    /// Side to which a case overturned; `None` unless overturning is certain.
    pub(crate) fn certain_overturning_sway(&self) -> Option<Sway> {
        let sway = self.outcome.overturning_sway();
        sway.filter(|_| self.doubt().is_none())
    }
}

/// Function that returns a number of an ending; `None` if the number is unknown.
type NumberOf = fn(&Ending) -> Option<f64>;

/// Numbers of an ending, by name.
pub(crate) const NUMBERS: [(&str, NumberOf); 6] = [
    ("outcome_time_s", Ending::known_time_s),
    ("peak_rotation_over_critical", |ending| {
        ending.peak_over_critical
    }),
    ("peak_rotation_rad", Ending::peak_of_row_rad),
    ("energy_defect_ratio", |ending| {
        Some(ending.energy_defect_ratio)
    }),
    ("thrust_excess_ratio", |ending| ending.thrust_excess_ratio),
    ("friction_demand", |ending| ending.friction_demand),
];

/// Function that returns the ending of a row, or the outcome to report if the row has none.
type Ended<R> = fn(&R) -> Result<&Ending, &'static str>;

/// Columns of the ending of a row. Sway, and impacts before overturning, are empty unless overturning is certain. The numbers of an
/// uncertain case are those of the history itself, not of its repetitions, whose count stands beside them if histories are repeated.
pub(crate) fn columns<'a, R: 'a>(is_repeated: bool, ended: Ended<R>) -> Vec<Column<'a, R>> {
    let number = |which: usize| {
        let (name, of) = NUMBERS[which];
        column(name, move |row| of(ended(row).ok()?))
    };
    let mut columns = vec![
        column("outcome", move |row| {
            ended(row).map_or_else(|reason| reason, Ending::outcome_name)
        }),
        column("overturning_sway", move |row| {
            ended(row).ok()?.certain_overturning_sway().map(Sway::name)
        }),
        column("impacts", move |row| ended(row).ok()?.known_impacts()),
        column("impacts_before_overturning", move |row| {
            let ending = ended(row).ok()?;
            ending.certain_overturning_sway().and(ending.impacts)
        }),
    ];
    columns.extend([0, 1, 3, 4, 5].map(number));
    if is_repeated {
        columns.push(number(2));
        columns.push(list(["overturns_in", "of"], move |row| {
            let count = ended(row).ok().and_then(|ending| ending.count.as_ref());
            each(count.map(|count| [count.overturns_in, count.of]))
        }));
    }
    columns
}

/// Column of the direction of the ground motion to which the numbers of a row belong; empty without a history.
pub(crate) fn direction<'a, R: 'a>(ended: Ended<R>) -> Column<'a, R> {
    column("direction", move |row| {
        Some(ended(row).ok()?.direction.name())
    })
}

/// Truth value for the cell of a table.
pub(crate) const fn yes_or_no(is_true: bool) -> &'static str {
    if is_true { "yes" } else { "no" }
}
