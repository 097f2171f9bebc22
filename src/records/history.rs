//! A history of a file, as its header describes it, and the fields of headers.

use std::ops::Range;

use archrock_text::{ensure, excerpt};

use crate::samples::{Clock, LineFault, Parsed, Values, checked_step, in_range, number, words};
use crate::unit::RecordedQuantity;

/// A history of a file, as the header describes it.
pub(crate) struct History {
    /// Name of its channel in the file; may be empty.
    pub(crate) name: String,
    /// The quantity of the samples: the name of a [`RecordedQuantity`] or of another quantity.
    pub(crate) quantity: String,
    /// Line of the header that describes the samples, from 1.
    pub(crate) line: usize,
    /// Unit of the samples, as files write it.
    pub(crate) unit: String,
    /// Factor that converts the numbers of the file to samples in this unit.
    pub(crate) factor: f64,
    /// Step between samples, in s; `None` if the first number of every row is the time in s.
    pub(crate) step_s: Option<f64>,
    /// Number of samples.
    pub(crate) count: f64,
    /// Number of numbers for one sample, and index of the sample among them.
    pub(crate) columns: (usize, usize),
    /// True if every line has the numbers of one sample.
    pub(crate) is_table: bool,
    /// The peak that the header states, in the unit of the samples.
    pub(crate) peak: Option<String>,
    /// Indices of the lines with the numbers.
    pub(crate) data: Range<usize>,
    /// Number of characters of a number, for numbers that touch; 0 if unknown.
    pub(crate) width: usize,
}

/// Finds the histories in the lines of a file.
pub(crate) type Finder = fn(&[&str]) -> Parsed<Vec<History>>;

impl History {
    /// Returns a history of accelerations, one number per sample, that this line of the header describes. Name, unit, peak and data are empty.
    pub(crate) fn new(line: usize, count: f64, step_s: Option<f64>) -> Self {
        Self {
            name: String::new(),
            quantity: RecordedQuantity::Acceleration.name().to_owned(),
            line,
            unit: String::new(),
            factor: 1.0,
            step_s,
            count,
            columns: (1, 0),
            is_table: false,
            peak: None,
            data: 0..0,
            width: 0,
        }
    }

    /// Reads the numbers: the times, if the file has them, and the samples.
    pub(crate) fn numbers(&self, lines: &[&str]) -> Parsed<(Clock, Values)> {
        let (mut clock, (of_sample, wanted)) = (Clock::default(), self.columns);
        let mut values = Values {
            line: self.data.start.max(1),
            ..Values::default()
        };
        for index in self.data.clone() {
            let fault = LineFault::on::<String>(index + 1);
            let row = fields(lines[index], self.width);
            let (found, is_table) = (row.len(), self.is_table);
            let fits = found.is_multiple_of(of_sample) && (!is_table || found <= of_sample);
            ensure(fits, || {
                let allowed = if is_table { "" } else { "a multiple of " };
                fault(format!(
                    "`{}` has {found} numbers; must have {allowed}{of_sample}",
                    excerpt(lines[index])
                ))
            })?;
            for (at, word) in row.into_iter().enumerate() {
                let value = number(word).and_then(in_range).map_err(fault)?;
                let column = at % of_sample;
                // The times of samples beyond their number mean nothing.
                let is_counted = (values.values.len() as f64) < self.count;
                if column == 0 && self.step_s.is_none() && is_counted {
                    clock.push(index + 1, value)?;
                }
                if column == wanted {
                    values.push(index + 1, value * self.factor)?;
                }
            }
        }
        Ok((clock, values))
    }
}

/// Splits a line into numbers. Numbers that touch have `width` characters each; 0 if unknown. A line that lost characters is not cut, because all
/// numbers after them would be wrong.
pub(crate) fn fields(line: &str, width: usize) -> Vec<&str> {
    let separate: Vec<_> = words(line).collect();
    let is_number = |word: &&str| number(word).is_ok();
    let line = line.trim_end();
    let is_whole = width > 0 && line.is_ascii() && line.len().is_multiple_of(width);
    if !is_whole || separate.iter().all(is_number) {
        return separate;
    }
    let cells = (0..line.len()).step_by(width);
    let cells = cells.map(|at| line[at..at + width].trim());
    cells.filter(|cell| !cell.is_empty()).collect()
}

/// Returns the numbers on lines of a header, as text. Fewer than `least` are a fault.
pub(crate) fn header_fields<'t>(
    lines: &[&'t str],
    at: Range<usize>,
    width: usize,
    least: usize,
) -> Parsed<Vec<&'t str>> {
    let end = at.end.min(lines.len());
    let rows = lines[at.start.min(end)..end].iter();
    let fields: Vec<_> = rows.flat_map(|line| fields(line, width)).collect();
    let fault = LineFault::on::<String>(end.max(1));
    ensure(fields.len() >= least, || {
        let (found, from) = (fields.len(), at.start + 1);
        fault(format!(
            "the header has {found} numbers from line {from} to here; must have {least}"
        ))
    })?;
    for field in &fields {
        number(field).map_err(fault)?;
    }
    Ok(fields)
}

/// Returns the lines with numbers from an index on: those before the next line with words, or with the mark `/&` of an end.
pub(crate) fn lines_of_numbers(lines: &[&str], from: usize) -> Range<usize> {
    let from = from.min(lines.len());
    let ends = |line: &&str| is_text(line) || line.starts_with("/&");
    let end = lines[from..].iter().position(ends);
    from..end.map_or(lines.len(), |end| from + end)
}

/// Returns true for a line with letters other than those of exponents.
pub(crate) fn is_text(line: &str) -> bool {
    line.contains(|c: char| c.is_alphabetic() && !"eEdD".contains(c))
}

/// Returns the part of a line after a phrase in lower case.
pub(crate) fn rest<'t>(line: &'t str, phrase: &str) -> Option<&'t str> {
    let at = line.to_ascii_lowercase().find(phrase)? + phrase.len();
    Some(&line[at..])
}

/// Returns the first word after a phrase in lower case.
pub(crate) fn word_after<'t>(line: &'t str, phrase: &str) -> Option<&'t str> {
    let word = rest(line, phrase)?.split_whitespace().next()?;
    Some(word.trim_end_matches([',', ';', ')']))
}

/// Returns the width of numbers in a line with their Fortran format, as `(8F10.5)`; 0 if there is none.
pub(crate) fn width_in(line: &str) -> usize {
    let format = line.rsplit_once('(').map_or("", |(_, format)| format);
    let width = format.trim_start_matches(|c: char| c.is_ascii_digit());
    let width = width.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    let digits = width.split(|c: char| !c.is_ascii_digit()).next();
    let width = digits.and_then(|digits| digits.parse().ok());
    width.filter(|width| *width <= 40).unwrap_or(0)
}

/// Returns a name with single blanks between its words.
pub(crate) fn single_blanks(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns the number with the largest magnitude, as text.
pub(crate) fn largest<'t>(words: impl Iterator<Item = &'t str>) -> Option<String> {
    let numbers = words.filter_map(|word| Some((number(word).ok()?.abs(), word)));
    let largest = numbers.max_by(|one, other| one.0.total_cmp(&other.0));
    largest.map(|(_, word)| word.to_owned())
}

/// Reads the number of samples on a line, and their step in s on the same or another line.
pub(crate) fn count_and_step(
    (line, count): (usize, &str),
    (step_line, step_s): (usize, Result<f64, String>),
) -> Parsed<(f64, f64)> {
    let step_s = step_s.and_then(|step_s| checked_step("the step", step_s));
    Ok((
        number(count).map_err(LineFault::on(line))?,
        step_s.map_err(LineFault::on(step_line))?,
    ))
}

/// Returns true if one of the lines contains a phrase.
pub(crate) fn has(lines: &[&str], phrase: &str) -> bool {
    lines.iter().any(|line| line.contains(phrase))
}
