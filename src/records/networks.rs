//! Texts of national networks with a header in words: its lines, and the numbers below it.

use std::ops::Range;

use archrock_text::excerpt;

use crate::history::{is_text, single_blanks, word_after};
use crate::samples::{LineFault, Parsed, words};

/// Largest number of lines of a header.
const MAX_HEADER_LINES: usize = 64;

/// Finds the line of a header with a phrase in lower case, single blanks between words. Returns its number, from 1, and the word after the phrase.
pub(crate) fn find(header: &[&str], phrase: &str) -> Parsed<(usize, String)> {
    let mut lines = header.iter().zip(1..).take(MAX_HEADER_LINES);
    let found = lines.find_map(|(line, number)| {
        let line = single_blanks(line);
        Some((number, word_after(&line, phrase)?.to_owned()))
    });
    found.ok_or_else(|| {
        let wrong = format!("the header has no `{}` up to here", phrase.trim_end());
        LineFault::on(header.len().clamp(1, MAX_HEADER_LINES))(wrong)
    })
}

/// Splits a file into header and numbers. The header extends to the line with a phrase, and over further lines that are blank or satisfy `is_header`.
/// Words among the numbers are a fault, or the numbers of another record would be read with this header.
pub(crate) fn header_and_data<'l, 't>(
    lines: &'l [&'t str],
    phrase: &str,
    is_header: fn(&str) -> bool,
) -> Parsed<(&'l [&'t str], Range<usize>)> {
    let (above, _) = find(lines, phrase)?;
    let is_data = |line: &&str| words(line).next().is_some() && !is_header(line);
    let length = lines[above..].iter().position(is_data);
    let data = length.map_or(lines.len(), |length| above + length)..lines.len();
    refuse_words(lines, data.clone())?;
    Ok((&lines[..data.start], data))
}

/// Returns a fault if there are words among the numbers.
pub(crate) fn refuse_words(lines: &[&str], mut data: Range<usize>) -> Parsed<()> {
    if let Some(index) = data.find(|index| is_text(lines[*index])) {
        let text = excerpt(lines[index]);
        return Err(LineFault::on(index + 1)(format!(
            "`{text}` is not a row of numbers; if another record begins here, give it a file of its own"
        )));
    }
    Ok(())
}
