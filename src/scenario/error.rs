//! Errors of scenarios, with their places.

use thiserror::Error;

use super::assignment::Assignment;
use super::shown;

/// An error of a scenario.
///
/// Displayed as `file:line:column: message`, the form that editors follow.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}:{} {message}", shown(file), before(place.as_ref()))]
pub struct ScenarioError {
    /// Name of the file, as the caller gave it, or the assignment after `--set`.
    pub file: String,
    /// Place in the file; `None` for an assignment, and if the file could not be read.
    pub place: Option<Place>,
    /// The wrong key and value, and the allowed values.
    pub message: String,
}

/// A place in a text, as editors count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

/// The place before a message.
fn before(place: Option<&Place>) -> String {
    place.map_or_else(String::new, |place| {
        format!("{}:{}:", place.line, place.column)
    })
}

/// All errors of a scenario, at least one, in the order of the file.
///
/// Displayed with one error per line.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}", lines(.0))]
pub struct ScenarioErrors(pub Vec<ScenarioError>);

impl ScenarioErrors {
    /// The one error of a file that could not be read.
    pub(super) fn unreadable(file: &str, message: impl Into<String>) -> Self {
        Self(vec![ScenarioError {
            file: file.to_owned(),
            place: None,
            message: message.into(),
        }])
    }

    /// These errors without their places, for a text that no user wrote.
    pub(super) fn without_places(mut self) -> Self {
        for error in &mut self.0 {
            error.place = None;
        }
        self
    }

    /// Gives each fault found in the text its line and column.
    ///
    /// For a fault in an assignment, the assignment stands in place of the file, and there is no place.
    pub(super) fn placed(source: (&str, &str), set: &[Assignment], mut faults: Vec<Fault>) -> Self {
        let (text, name) = source;
        faults.sort_by_key(|fault| (fault.text, fault.offset));
        // One pass over the text serves all faults: a hostile file can have very many.
        let mut chars = text.char_indices().peekable();
        let mut place = Place { line: 1, column: 1 };
        let errors = faults.into_iter().map(|fault| {
            // Keys may hold control characters.
            let message = shown(&fault.message);
            if let Some(assignment) = fault.text.checked_sub(1).and_then(|index| set.get(index)) {
                return ScenarioError {
                    file: format!("--set {}", excerpt(&assignment.given)),
                    place: None,
                    message,
                };
            }
            while let Some((_, c)) = chars.next_if(|&(offset, _)| offset < fault.offset) {
                if c == '\n' {
                    (place.line, place.column) = (place.line + 1, 1);
                } else {
                    place.column += 1;
                }
            }
            ScenarioError {
                file: name.to_owned(),
                place: Some(place),
                message,
            }
        });
        Self(errors.collect())
    }
}

/// The errors, one per line.
fn lines(errors: &[ScenarioError]) -> String {
    let lines: Vec<_> = errors.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

/// An error with its byte offset in a text of the document.
#[derive(Debug)]
pub(super) struct Fault {
    /// The text, as in [`Span`](super::document::Span).
    pub(super) text: usize,
    pub(super) offset: usize,
    pub(super) message: String,
    /// True if a file that the text names is missing or faulty.
    pub(super) of_file: bool,
}

impl Fault {
    pub(super) fn new(text: usize, offset: usize, message: String) -> Self {
        Self {
            text,
            offset,
            message,
            of_file: false,
        }
    }
}

/// Succeeds if a condition holds, else returns the message.
pub(super) fn ensure<E>(holds: bool, wrong: impl FnOnce() -> E) -> Result<(), E> {
    holds.then_some(()).ok_or_else(wrong)
}

/// An excerpt of the file for a message: its first line, shortened if it is long.
pub(super) fn excerpt(text: &str) -> String {
    const MAX_CHARS: usize = 50;
    let line = text.trim().lines().next().unwrap_or_default();
    // Escaping makes the text longer.
    let whole = shown(&line.chars().take(MAX_CHARS + 1).collect::<String>());
    let mut short: String = whole.chars().take(MAX_CHARS).collect();
    if short.len() < whole.len() {
        short.push_str("...");
    }
    short
}
