//! The report of a study: a value that states verdict, warnings and the answer to quote. JSON, words and pages follow from it.

use archrock_text::{LINE, length, wrapped};
use askama::Template;
use serde::{Deserialize, Serialize};

use super::quotable::{NO_ANSWER, THOUGHT_END};
use crate::output::render;
use crate::scenario::Unlikely;

/// The report of a study. Its `Serialize` is the JSON, and its template gives the details in words.
pub trait Report: Serialize + Template {
    /// True if the template is a table in words, complete without the verdict.
    const IS_TABLE: bool = false;

    /// Returns the verdict: a line for each model and record.
    fn verdict(&self) -> String;

    /// Returns the answer that may be quoted, or the reason why there is none; `None` if the study has no answer to quote.
    fn quote(&self) -> Option<&str> {
        None
    }

    /// Returns the main numbers, in lines; by default those of the verdict.
    fn numbers(&self) -> Vec<String> {
        self.verdict().lines().map(str::to_owned).collect()
    }

    /// Returns the warnings; none by default.
    fn warnings(&self) -> &Warnings {
        const NONE: &Warnings = &Warnings {
            warnings: Vec::new(),
            unlikely: Vec::new(),
        };
        NONE
    }
}

/// The warnings of a report.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Warnings {
    /// Warnings about unlikely numbers, limits of the model, and histories without a verdict.
    warnings: Vec<String>,
    /// The numbers of the warnings about unlikely input, which come first in `warnings`, in their order.
    #[serde(default)]
    unlikely: Vec<Unlikely>,
}

impl Warnings {
    /// Makes the warnings about unlikely numbers, and about the limits of the answer.
    pub(super) fn new(unlikely: Vec<Unlikely>, limits: impl IntoIterator<Item = String>) -> Self {
        let mut warnings = Unlikely::sentences(&unlikely);
        warnings.extend(limits);
        Self { warnings, unlikely }
    }

    /// Returns all warnings.
    pub fn all(&self) -> &[String] {
        &self.warnings
    }

    /// Returns the warnings about unlikely numbers, and those that limit the answer.
    pub(super) fn parts(&self) -> [&[String]; 2] {
        // A warning stands for each unlikely number.
        let first = self.unlikely.len().min(self.warnings.len());
        let (unlikely, limits) = self.warnings.split_at(first);
        [unlikely, limits]
    }

    /// Returns the warnings with more that limit the answer.
    pub(super) fn with(mut self, limits: impl IntoIterator<Item = String>) -> Self {
        self.extend(limits);
        self
    }

    /// Adds warnings that limit the answer.
    pub(super) fn extend(&mut self, limits: impl IntoIterator<Item = String>) {
        self.warnings.extend(limits);
    }
}

/// The statements of a report, in words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statement {
    /// The input in lines before the verdict, such as the records of a history; empty without lines.
    pub input: String,
    /// The verdict: a line for each model and record.
    pub verdict: String,
    /// Details, in indented lines; empty without details.
    pub details: String,
    /// The warnings about unlikely numbers.
    pub unlikely: Vec<String>,
    /// The warnings that limit the answer.
    pub limits: Vec<String>,
    /// The answer that may be quoted, or the reason why there is none.
    pub quote: Option<String>,
    /// The main numbers, in lines.
    pub numbers: Vec<String>,
    /// The command that a user needs next, with `FILE` for the scenario, without `archrock`; `None` if there is none.
    pub next: Option<String>,
    /// True if the details are a table in words, complete without the verdict.
    pub is_table: bool,
}

/// Verdicts that begin an answer. Each is printed in capitals.
const VERDICTS: [&str; 6] = [
    "survives",
    "overturns",
    "never moves",
    "vibrates",
    NO_ANSWER,
    "no verdict",
];

impl Statement {
    /// Makes the statements of a report.
    pub fn of<R: Report>(report: &R) -> Self {
        let [unlikely, limits] = report.warnings().parts();
        Self {
            input: String::new(),
            verdict: report.verdict(),
            details: render(report).trim_end().to_owned(),
            unlikely: unlikely.to_vec(),
            limits: limits.to_vec(),
            quote: report.quote().map(str::to_owned),
            numbers: report.numbers(),
            next: None,
            is_table: R::IS_TABLE,
        }
    }

    /// Returns the report in words: the first line is not indented, the others are, and the last has no line break.
    pub fn in_words(&self) -> String {
        match self.is_table {
            true => self.details.clone(),
            false => self.lines(&self.details),
        }
    }

    /// Returns the answer with its conditions and warnings, in lines; with the main numbers if `has_numbers`. Without an answer the verdict follows the
    /// reason.
    pub fn answer(&self, has_numbers: bool) -> String {
        let quote = self.quote.as_deref();
        let has_answer = quote.is_some_and(|quote| !quote.starts_with(NO_ANSWER));
        let verdict = Some(&*self.verdict).filter(|_| !has_answer);
        let said = [quote, verdict];
        let words = said.iter().flatten().flat_map(|words| words.lines());
        let mut lines: Vec<String> = words
            .flat_map(|words| in_lines(words.split(THOUGHT_END)))
            .collect();
        with_capitals(&mut lines);
        let said: String = said.into_iter().flatten().collect();
        let numbers = self.numbers.iter().filter(|_| has_numbers);
        for words in self.limits.iter().chain(numbers) {
            lines.extend(in_lines(new_thoughts(words, &said)));
        }
        lines.join("\n  ")
    }

    /// Returns the warnings, without the thoughts of the answer.
    pub(super) fn warnings(&self) -> Vec<String> {
        let said = self.quote.as_deref().unwrap_or_default();
        let all = self.unlikely.iter().chain(&self.limits);
        let new = all.map(|words| {
            new_thoughts(words, said)
                .collect::<Vec<_>>()
                .join(THOUGHT_END)
        });
        new.filter(|words| !words.is_empty()).collect()
    }

    /// Returns the details without their indent.
    pub(super) fn details_outdented(&self) -> String {
        let lines = self.details.lines();
        let lines = lines.map(|line| line.strip_prefix("  ").unwrap_or(line));
        lines.collect::<Vec<_>>().join("\n")
    }

    fn lines(&self, details: &str) -> String {
        let details = Some(details).filter(|details| !details.is_empty());
        let verdict = self.verdict.replace('\n', "\n  ");
        // The verdict and the answer contain some limits.
        let quote = self.quote.as_deref().unwrap_or_default();
        let is_new = |limit: &&String| !quote.contains(*limit) && !verdict.contains(*limit);
        let limits = self.limits.iter().filter(is_new);
        let after = limits.chain(&self.quote);
        let lines = details.into_iter().map(str::to_owned);
        let lines = lines.chain(after.map(|line| format!("  {line}")));
        let lines: String = lines.map(|line| format!("\n{line}")).collect();
        format!("{verdict}{lines}")
    }
}

/// Returns the thoughts of some words that `said` does not contain. Friction is a need among the limits, and a condition in an answer.
fn new_thoughts<'w>(words: &'w str, said: &str) -> impl Iterator<Item = &'w str> {
    // 0.5 is not said where 0.51 stands.
    let ends = |after: &str| !after.starts_with(|c: char| c.is_ascii_digit());
    let is_said = move |thought: &str| {
        let thought = thought.strip_prefix("needs ").unwrap_or(thought);
        said.match_indices(thought)
            .any(|(at, _)| ends(&said[at + thought.len()..]))
    };
    let thoughts = words.split(THOUGHT_END);
    thoughts.filter(move |thought| !is_said(thought))
}

/// Writes thoughts in lines: several short ones on a line, and a long one on several.
fn in_lines<'t>(thoughts: impl IntoIterator<Item = &'t str>) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for thought in thoughts {
        match lines.last_mut() {
            Some(line) if length(line) + length(THOUGHT_END) + length(thought) <= LINE => {
                *line += THOUGHT_END;
                *line += thought;
            }
            _ => lines.extend(wrapped(thought)),
        }
    }
    lines
}

/// Writes the verdict at the beginning of an answer in capitals.
fn with_capitals(lines: &mut [String]) {
    if let Some(first) = lines.first_mut()
        && let Some(verdict) = VERDICTS
            .into_iter()
            .find(|verdict| first.starts_with(verdict))
    {
        *first = first.replacen(verdict, &verdict.to_uppercase(), 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thoughts_of_the_answer_are_not_repeated() {
        let said = "survives up to 1.19, with four links; if its joints have a friction coefficient of 0.51";
        let new = |words| new_thoughts(words, said).collect::<Vec<_>>();
        assert!(new("needs a friction coefficient of 0.51; survives up to 1.19").is_empty());
        let other = "needs a friction coefficient of 0.5";
        assert_eq!(new(other), [other]);
        assert_eq!(
            new("survives up to 1.1; slips"),
            ["survives up to 1.1", "slips"]
        );
    }

    #[test]
    fn lines_keep_numbers_with_their_units() {
        let long = format!("{} 0.40260 g (highest)", "x".repeat(LINE - 8));
        let lines = in_lines([long.as_str(), "next"]);
        assert_eq!(lines[1], "  0.40260 g (highest); next");
    }
}
