//! The cases of a page: their marks, and their scenarios as text.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::ending::{Ending, NoHistory, Verdict};
use super::outcome_colors::OutcomeColor;
use crate::output::page::{Spot, SpotKind};
use crate::scenario::{StudyTable, toml_text};

/// Largest number of cases on a page, and of rows in its first table.
pub(super) const MOST_CASES: usize = 1000;

/// The scenario of a case: an earlier text with some other lines. Texts without a number have no valid scenario.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct CaseText {
    text: Option<usize>,
    lines: Vec<(usize, String)>,
}

/// The cases of a page, in the order of the last table of its study.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PageCases {
    #[serde(skip)]
    pub(super) spots: Vec<Spot>,
    /// True if the command of a case is a suite.
    #[serde(skip)]
    pub(super) are_suites: bool,
    /// Number of all cases, also of those that are not on the page.
    pub(super) count: usize,
    pub(super) texts: Vec<String>,
    pub(super) cases: Vec<CaseText>,
}

impl PageCases {
    /// Adds a case: its outcome, whether it is outside the model of four links, its words, and its scenario as JSON, unless it is not valid.
    /// Only the first cases are on the page.
    pub(super) fn push(
        &mut self,
        mark: (SpotKind, bool),
        words: String,
        scenario: impl FnOnce() -> Option<Value>,
    ) {
        let are_suites = self.are_suites;
        self.push_text(mark, words, || {
            let mut scenario = scenario()?;
            if let Value::Object(tables) = &mut scenario {
                tables.retain(|name, _| {
                    let is_of_suites = are_suites && name == "suite";
                    is_of_suites || !StudyTable::is_name(name)
                });
            }
            Some(toml_text(&scenario))
        });
    }

    /// Adds a case of another page, with words before its own.
    pub(super) fn push_copy(&mut self, before: &str, other: &Self, row: usize) {
        let spot = other.spots.get(row);
        let mark = spot.map_or((SpotKind::Unknown, false), |spot| (spot.kind, spot.outside));
        let words = spot.map_or("a case without a mark", |spot| &spot.words);
        self.push_text(mark, format!("{before}{words}"), || {
            let CaseText { text, lines } = other.cases.get(row)?;
            let mut all: Vec<&str> = other.texts[(*text)?].split('\n').collect();
            for (index, line) in lines {
                all[*index] = line;
            }
            Some(all.join("\n"))
        });
    }

    fn push_text(
        &mut self,
        (kind, outside): (SpotKind, bool),
        words: String,
        text: impl FnOnce() -> Option<String>,
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
        let case = text().map(|text| self.text(&text));
        self.cases.push(case.unwrap_or_default());
    }

    /// Adds the case of a history.
    pub(super) fn push_history(
        &mut self,
        case: &str,
        result: &Result<Ending, NoHistory>,
        scenario: impl FnOnce() -> Option<Value>,
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

    /// Returns a text as the last one with other lines, or as a new one.
    fn text(&mut self, text: &str) -> CaseText {
        let last = self.texts.last().map_or("", |last| last);
        let (old, new): (Vec<&str>, Vec<&str>) =
            (last.split('\n').collect(), text.split('\n').collect());
        if old.len() != new.len() || self.texts.is_empty() {
            self.texts.push(text.to_owned());
            return self.text(text);
        }
        let changed = new.iter().zip(old).enumerate();
        let changed = changed.filter(|(_, (new, old))| *new != old);
        CaseText {
            text: Some(self.texts.len() - 1),
            lines: changed
                .map(|(index, (new, _))| (index, (*new).to_owned()))
                .collect(),
        }
    }
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
