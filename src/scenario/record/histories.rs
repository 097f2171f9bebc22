//! Files whose header describes one or several histories: quantity, unit, step, number of samples and peak of each.
//!
//! A reader of such a format only finds the histories; this module chooses one of them, reads its numbers, and compares them with the header.

use std::ops::Range;

use super::layout::{Layout, TableColumn};
use super::samples::{
    Clock, Contents, LineFault, Parsed, Values, checked_step, different_peak, in_range, number,
    peak_of, words,
};
use super::unit::{RecordedQuantity, Unit};
use crate::scenario::prelude::*;

/// A history of a file, as the header describes it.
pub(super) struct History {
    /// Name of its channel in the file; may be empty.
    pub(super) name: String,
    /// The quantity of the samples: the name of a [`RecordedQuantity`] or of another quantity.
    pub(super) quantity: String,
    /// Line of the header that describes the samples, from 1.
    pub(super) line: usize,
    /// Unit of the samples, as files write it.
    pub(super) unit: String,
    /// Factor that converts the numbers of the file to samples in this unit.
    pub(super) factor: f64,
    /// Step between samples, in s; `None` if the first number of every row is the time in s.
    pub(super) step_s: Option<f64>,
    /// Number of samples.
    pub(super) count: f64,
    /// Number of numbers for one sample, and index of the sample among them.
    pub(super) columns: (usize, usize),
    /// True if every line has the numbers of one sample.
    pub(super) is_table: bool,
    /// The peak that the header states, in the unit of the samples.
    pub(super) peak: Option<String>,
    /// Indices of the lines with the numbers.
    pub(super) data: Range<usize>,
    /// Number of characters of a number, for numbers that touch; 0 if unknown.
    pub(super) width: usize,
}

/// Finds the histories in the lines of a file.
pub(super) type Finder = fn(&[&str]) -> Parsed<Vec<History>>;

/// Returns the number of channels of a file: of its histories of the wanted quantity.
pub(super) fn count(text: &str, layout: &Layout, histories: Finder) -> Parsed<usize> {
    let lines: Vec<&str> = text.lines().collect();
    let histories = histories(&lines)?;
    let wanted = layout.quantity.name();
    Ok(histories
        .iter()
        .filter(|one| one.quantity == wanted)
        .count())
}

/// Reads the history that the layout chooses among those of a file.
pub(super) fn read(text: &str, layout: &Layout, histories: Finder) -> Parsed<Contents> {
    let lines: Vec<&str> = text.lines().collect();
    let histories = histories(&lines)?;
    ensure(!histories.is_empty(), || {
        LineFault::on(1)("the header announces no samples")
    })?;
    let wanted = layout.quantity.name();
    let fits = |one: &&History| one.quantity == wanted;
    let fitting: Vec<_> = histories.iter().filter(fits).collect();
    let index = choose(&fitting, layout.channel.as_ref()).map_err(|wrong| {
        let other = histories.first().filter(|_| fitting.is_empty());
        let line = other.or(fitting.first().copied()).map_or(1, |one| one.line);
        LineFault::on(line)(other.map_or(wrong, |_| holds(&histories, layout.quantity)))
    })?;
    let history = fitting[index];
    let fault = LineFault::on::<String>(history.line);
    let remedy = "such samples are not read; convert them";
    let unit = Unit::of_header(&history.unit, layout.quantity, remedy).map_err(fault)?;
    let is_factor = (1e-6..=1e6).contains(&history.factor);
    ensure(is_factor, || {
        let factor = plain(history.factor);
        fault(format!("the factor {factor} is not from 1e-6 to 1e6"))
    })?;
    let (clock, values) = history.numbers(&lines)?;
    values.check_count((history.line, history.count), "samples")?;
    let peak = history.peak.as_deref();
    let difference =
        peak.and_then(|peak| different_peak(peak, peak_of(&values.values, 0.0), unit, ""));
    let (samples, repeated) = match history.step_s {
        Some(step_s) => (values.evenly(step_s, history.line, "the step")?, None),
        None => clock.samples(values)?,
    };
    let (count, name) = (fitting.len(), excerpt(&history.name));
    let columns = match (count, &*name) {
        (1, "") => String::new(),
        (1, name) => format!(" of channel `{name}`"),
        (count, name) => format!(" of channel {} of {count} `{name}`", index + 1),
    };
    let contents = Contents {
        columns,
        channel: Some((index + 1, history.name.clone())).filter(|_| layout.format.has_channels()),
        ..Contents::new(samples, unit)
    };
    Ok(contents.doubted(repeated.into_iter().chain(difference)))
}

/// Returns the index of the channel that is chosen, or of the only one.
fn choose(histories: &[&History], channel: Option<&TableColumn>) -> Result<usize, String> {
    /// Largest number of channels in a message.
    const LISTED: usize = 9;
    let named = |fits: &dyn Fn(&str) -> bool| {
        let names = histories.iter().map(|one| one.name.to_lowercase());
        let fitting = names.enumerate().filter(|(_, name)| fits(name));
        fitting.map(|(index, _)| index).collect::<Vec<_>>()
    };
    let found = match channel {
        None => (0..histories.len()).collect(),
        Some(TableColumn::Number(number)) => {
            let indices = 0..histories.len();
            indices.filter(|index| index + 1 == *number).collect()
        }
        Some(TableColumn::Name(name)) => {
            let name = squeezed(name).to_lowercase();
            let equal = named(&|own| own == name);
            match equal.is_empty() {
                true => named(&|own| has_words(own, &name)),
                false => equal,
            }
        }
    };
    if let [index] = found[..] {
        return Ok(index);
    }
    let names = histories.iter().zip(1..).take(LISTED);
    let names = names.map(|(one, number)| format!("{number} `{}`", excerpt(&one.name)));
    let mut listed = names.collect::<Vec<_>>().join(", ");
    if histories.len() > LISTED {
        listed += " and others";
    }
    Err(match channel {
        None => format!(
            "the file has {} channels: set `channel` to the number or to a part of the name of one of them: {listed}",
            histories.len()
        ),
        Some(TableColumn::Number(number)) => {
            format!("there is no channel {number}; the file has {listed}")
        }
        Some(TableColumn::Name(name)) => {
            let matches = match found.is_empty() {
                true => "no channel matches",
                false => "several channels match",
            };
            let number = match name.trim().parse::<usize>() {
                Ok(number) => format!(" (its number has no quotation marks: `channel = {number}`)"),
                Err(_) => String::new(),
            };
            format!(
                "{matches} `{}`{number}; the file has {listed}",
                excerpt(name)
            )
        }
    })
}

/// Returns true if a name contains a part that neither begins nor ends inside a word of the name.
fn has_words(name: &str, part: &str) -> bool {
    let is_inside = |left: Option<char>, right: Option<char>| {
        let mut sides = [left, right].into_iter();
        sides.all(|side| side.is_some_and(char::is_alphanumeric))
    };
    name.match_indices(part).any(|(start, _)| {
        let (before, after) = (&name[..start], &name[start + part.len()..]);
        !is_inside(before.chars().next_back(), part.chars().next())
            && !is_inside(part.chars().next_back(), after.chars().next())
    })
}

/// Returns the message that a file has no history of the wanted quantity.
fn holds(histories: &[History], wanted: RecordedQuantity) -> String {
    let mut held: Vec<_> = histories.iter().map(|one| excerpt(&one.quantity)).collect();
    held.dedup();
    held.truncate(3);
    let other = RecordedQuantity::ALL
        .iter()
        .find(|other| histories.iter().any(|one| one.quantity == other.name()));
    let remedy = match other {
        Some(RecordedQuantity::Velocity) => ", unless you give `quantity = \"velocity\"`",
        Some(RecordedQuantity::Acceleration) => ", unless you leave out `quantity = \"velocity\"`",
        None => "",
    };
    format!(
        "the file holds {}; must be {}{remedy}",
        held.join(" and "),
        wanted.name()
    )
}

impl History {
    /// Returns a history of accelerations, one number per sample, that this line of the header describes. Name, unit, peak and data are empty.
    pub(super) fn new(line: usize, count: f64, step_s: Option<f64>) -> Self {
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
    fn numbers(&self, lines: &[&str]) -> Parsed<(Clock, Values)> {
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
pub(super) fn fields(line: &str, width: usize) -> Vec<&str> {
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
pub(super) fn header_fields<'t>(
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
pub(super) fn lines_of_numbers(lines: &[&str], from: usize) -> Range<usize> {
    let from = from.min(lines.len());
    let ends = |line: &&str| is_text(line) || line.starts_with("/&");
    let end = lines[from..].iter().position(ends);
    from..end.map_or(lines.len(), |end| from + end)
}

/// Returns true for a line with letters other than those of exponents.
pub(super) fn is_text(line: &str) -> bool {
    line.contains(|c: char| c.is_alphabetic() && !"eEdD".contains(c))
}

/// Returns the part of a line after a phrase in lower case.
pub(super) fn rest<'t>(line: &'t str, phrase: &str) -> Option<&'t str> {
    let at = line.to_ascii_lowercase().find(phrase)? + phrase.len();
    Some(&line[at..])
}

/// Returns the first word after a phrase in lower case.
pub(super) fn word_after<'t>(line: &'t str, phrase: &str) -> Option<&'t str> {
    let word = rest(line, phrase)?.split_whitespace().next()?;
    Some(word.trim_end_matches([',', ';', ')']))
}

/// Returns the width of numbers in a line with their Fortran format, as `(8F10.5)`; 0 if there is none.
pub(super) fn width_in(line: &str) -> usize {
    let format = line.rsplit_once('(').map_or("", |(_, format)| format);
    let width = format.trim_start_matches(|c: char| c.is_ascii_digit());
    let width = width.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    let digits = width.split(|c: char| !c.is_ascii_digit()).next();
    let width = digits.and_then(|digits| digits.parse().ok());
    width.filter(|width| *width <= 40).unwrap_or(0)
}

/// Returns a name with single blanks between its words.
pub(super) fn squeezed(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns the number with the largest magnitude, as text.
pub(super) fn largest<'t>(words: impl Iterator<Item = &'t str>) -> Option<String> {
    let numbers = words.filter_map(|word| Some((number(word).ok()?.abs(), word)));
    let largest = numbers.max_by(|one, other| one.0.total_cmp(&other.0));
    largest.map(|(_, word)| word.to_owned())
}

/// Reads the number of samples on a line, and their step in s on the same or another line.
pub(super) fn count_and_step(
    (line, count): (usize, &str),
    (step_line, step_s): (usize, Result<f64, String>),
) -> Parsed<(f64, f64)> {
    let step_s = step_s.and_then(|step_s| checked_step("the step", step_s));
    Ok((
        number(count).map_err(LineFault::on(line))?,
        step_s.map_err(LineFault::on(step_line))?,
    ))
}
