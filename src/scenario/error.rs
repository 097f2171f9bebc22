//! Errors of scenarios, with their positions in the file.

use archrock_text::{excerpt, shown};
use thiserror::Error;

use super::assignment::Assignment;

/// An error of a scenario.
///
/// Displayed as `file:line:column: message`, a format that editors recognize.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}:{} {message}", shown(file), position_prefix(place.as_ref()))]
pub struct ScenarioError {
    /// Name of the file as the caller gave it, or the assignment after `--set`.
    pub file: String,
    /// Position in the file; `None` for an assignment, or if the file cannot be read.
    pub place: Option<TextPosition>,
    /// The wrong key and value, and the allowed values.
    pub message: String,
}

/// A position in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextPosition {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

/// Position before a message.
fn position_prefix(place: Option<&TextPosition>) -> String {
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
    /// Single error of a file that cannot be read.
    pub(super) fn unreadable(file: &str, message: impl Into<String>) -> Self {
        Self(vec![ScenarioError {
            file: file.to_owned(),
            place: None,
            message: message.into(),
        }])
    }

    /// Removes the positions, for a text that the program wrote itself.
    pub(super) fn without_places(mut self) -> Self {
        for error in &mut self.0 {
            error.place = None;
        }
        self
    }

    /// Converts the offset of each fault in the text to a line and a column.
    ///
    /// An error in an assignment has the assignment instead of the file, and no position.
    pub(super) fn placed(source: (&str, &str), set: &[Assignment], mut faults: Vec<Fault>) -> Self {
        let (text, name) = source;
        faults.sort_by_key(|fault| (fault.text, fault.offset));
        // Several tables may have the same default.
        faults.dedup_by(|one, other| {
            (one.text, one.offset, &one.message) == (other.text, other.offset, &other.message)
        });
        // A single pass over the text for all faults: a malicious file can have very many.
        let mut chars = text.char_indices().peekable();
        let mut place = TextPosition { line: 1, column: 1 };
        let errors = faults.into_iter().map(|fault| {
            // Keys may contain control characters.
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

/// Errors, one per line.
fn lines(errors: &[ScenarioError]) -> String {
    let lines: Vec<_> = errors.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

/// An error with its byte offset in a text of the document.
#[derive(Debug)]
pub(super) struct Fault {
    /// Number of the text, as in [`Span`](super::document::Span).
    pub(super) text: usize,
    pub(super) offset: usize,
    pub(super) message: String,
    /// True if the error is a missing or faulty file that the text names.
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
