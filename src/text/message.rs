//! Messages about text from outside.

use crate::shown;

/// Returns the message as error unless a condition holds.
///
/// # Errors
/// If the condition does not hold.
pub fn ensure<E>(holds: bool, wrong: impl FnOnce() -> E) -> Result<(), E> {
    holds.then_some(()).ok_or_else(wrong)
}

/// Returns an excerpt of a text for a message: the first line, shortened if it is long.
pub fn excerpt(text: &str) -> String {
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
