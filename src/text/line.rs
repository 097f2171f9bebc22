//! Lines of limited length.

/// Largest number of characters of a line: with an indent it stays below 100.
pub const LINE: usize = 97;

/// Divides a line at blanks into lines of at most [`LINE`] characters where possible; those after the first one are indented.
pub fn wrapped(text: &str) -> Vec<String> {
    let mut words = words_with_units(text).into_iter();
    let mut line = words.next().unwrap_or_default();
    let mut lines = Vec::new();
    for word in words {
        match length(&line) + 1 + length(&word) <= LINE {
            true => line += &format!(" {word}"),
            false => lines.push(std::mem::replace(&mut line, format!("  {word}"))),
        }
    }
    lines.push(line);
    lines
}

/// Divides words at blanks, but not between a number and its unit.
fn words_with_units(words: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for word in words.split(' ') {
        let begins_as_unit = word.starts_with(|c: char| c.is_alphabetic() || c == '%');
        let is_unit = begins_as_unit && length(word.trim_end_matches([')', ',', ';'])) <= 3;
        match found.last_mut() {
            Some(last) if is_unit && last.ends_with(|c: char| c.is_ascii_digit()) => {
                *last += &format!(" {word}");
            }
            _ => found.push(word.to_owned()),
        }
    }
    found
}

/// Returns the number of characters.
pub fn length(text: &str) -> usize {
    text.chars().count()
}
