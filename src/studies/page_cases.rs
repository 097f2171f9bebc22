//! The cases of a page: their marks, and their scenarios, each a text with other values.

use std::fmt::Display;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::ending::{Ending, NoHistory, Verdict};
use super::outcome_colors::OutcomeColor;
use crate::dynamics::Direction;
use crate::output::page::{Spot, SpotKind};
use crate::scenario::{StudyTable, toml_text};

/// Largest number of cases on a page, and of rows in its first table.
pub(super) const MOST_CASES: usize = 1000;

/// The scenario of a case: a text with other values. Without a text there is no valid scenario.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct CaseScenario {
    /// Index of the text.
    text: Option<usize>,
    /// The other values, as arguments of `--set`.
    set: Vec<String>,
}

impl CaseScenario {
    /// Makes the scenario of a text, by its index, with other values of these keys.
    pub(super) fn of<K: Display, V: Display>(
        text: usize,
        values: impl IntoIterator<Item = (K, V)>,
    ) -> Self {
        let values = values.into_iter();
        Self {
            text: Some(text),
            set: values
                .map(|(key, value)| format!("{key}={value}"))
                .collect(),
        }
    }

    /// Makes the scenario of a text, by its index.
    pub(super) const fn unchanged(text: usize) -> Self {
        Self {
            text: Some(text),
            set: Vec::new(),
        }
    }

    /// Returns the scenario in one direction of the ground motion.
    pub(super) fn in_direction(mut self, direction: Direction) -> Self {
        let name = direction.name();
        self.set.push(format!("simulation.direction={name}"));
        self
    }
}

/// The cases of a page, in the order of the last table of its study.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PageCases {
    #[serde(skip)]
    pub(super) spots: Vec<Spot>,
    /// Number of all cases, also of those that are not on the page.
    pub(super) count: usize,
    /// Scenarios as TOML, without studies.
    pub(super) texts: Vec<String>,
    pub(super) cases: Vec<CaseScenario>,
    /// True if a text names record files.
    has_files: bool,
}

impl PageCases {
    /// Adds the text of a scenario, given as JSON, and returns its index. Tables of studies are left out, unless the cases are `suites`.
    pub(super) fn add_text(&mut self, scenario: &Value, suites: bool) -> usize {
        self.has_files |= scenario.pointer("/ground/record").is_some() || suites;
        self.texts.push(text_without_studies(scenario, suites));
        self.texts.len() - 1
    }

    /// Returns true if a command names record files.
    pub(super) const fn has_files(&self) -> bool {
        self.has_files
    }

    /// Adds the texts of another page, and returns the index of the first.
    pub(super) fn add_texts_of(&mut self, other: &Self) -> usize {
        let first = self.texts.len();
        self.texts.extend_from_slice(&other.texts);
        self.has_files |= other.has_files;
        first
    }

    /// Adds a case of another page, with words before its own. `first` is the index of the first text of that page.
    pub(super) fn push_copy(&mut self, before: &str, (other, first): (&Self, usize), row: usize) {
        let spot = other.spots.get(row);
        let mark = spot.map_or((SpotKind::Unknown, false), |spot| (spot.kind, spot.outside));
        let words = spot.map_or("a case without a mark", |spot| &spot.words);
        self.push(mark, format!("{before}{words}"), || {
            let CaseScenario { text, set } = other.cases.get(row)?.clone();
            Some(CaseScenario {
                text: Some(first + text?),
                set,
            })
        });
    }

    /// Adds a case: its outcome, whether it is outside the model of four links, its words, and its scenario, unless it is not valid.
    /// Only the first cases are on the page.
    pub(super) fn push(
        &mut self,
        (kind, outside): (SpotKind, bool),
        words: String,
        scenario: impl FnOnce() -> Option<CaseScenario>,
    ) {
        self.count += 1;
        if self.spots.len() == MOST_CASES {
            return;
        }
        self.spots.push(Spot {
            row: self.spots.len(),
            kind,
            outside,
            words,
        });
        self.cases.push(scenario().unwrap_or_default());
    }

    /// Adds the case of a history.
    pub(super) fn push_history(
        &mut self,
        case: &str,
        result: &Result<Ending, NoHistory>,
        scenario: impl FnOnce() -> Option<CaseScenario>,
    ) {
        let words = match result {
            Ok(ending) => match ending.doubt() {
                Some(doubt) => format!("UNCERTAIN: {doubt}"),
                None => OutcomeColor::of_result(result).label.to_owned(),
            },
            Err(reason) => format!("no verdict: {reason}"),
        };
        let ending = result.as_ref().ok();
        let outside = ending.is_some_and(Ending::is_outside_model);
        let beyond = match outside {
            true => "; OUTSIDE the model of four links",
            false => "",
        };
        self.push(
            (kind_of(ending.map(Ending::verdict)), outside),
            format!("{case}: {words}{beyond}"),
            scenario,
        );
    }
}

/// Returns the text of a scenario, given as JSON, without the tables of studies; `suites` keeps that of suites.
pub(super) fn text_without_studies(scenario: &Value, suites: bool) -> String {
    let mut scenario = scenario.clone();
    if let Value::Object(tables) = &mut scenario {
        let is_kept =
            |name: &str| !StudyTable::is_name(name) || suites && name == StudyTable::Suite.name();
        tables.retain(|name, _| is_kept(name));
    }
    toml_text(&scenario)
}

/// Returns the mark of a verdict; `None` without a history.
pub(super) const fn kind_of(verdict: Option<Verdict>) -> SpotKind {
    match verdict {
        Some(Verdict::Survives) => SpotKind::Survives,
        Some(Verdict::Overturns) => SpotKind::Overturns,
        Some(Verdict::Uncertain) => SpotKind::Uncertain,
        _ => SpotKind::Unknown,
    }
}
