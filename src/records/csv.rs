//! Tables of samples with a column of times or a constant step; commas, semicolons, tabs or blanks separate the columns.

use std::borrow::Cow;
use std::io::Read as _;
use std::ops::Range;

use ::csv::{ReaderBuilder, StringRecord, Terminator};
use archrock_text::{ensure, excerpt};

use crate::layout::{Decimal, Format, Layout, Parser, TableColumn, Times};
use crate::samples::*;
use crate::unit::Unit;

impl Format {
    /// A table with a column of samples and one of times, or with samples at a constant step.
    pub const CSV: Self = Self {
        name: "csv",
        label: "table",
        extensions: &["csv", "tsv", "txt", "dat"],
        begins: |_| false,
        parser: Parser::Record(parse, None),
    };
}

/// Reads the samples, in the unit of the file.
///
/// Blank lines and lines that begin with `#` or `%` are skipped, except `%g`. The first of the other lines may contain the names of the columns; names are required
/// if a column is chosen by name. All rows have the same number of cells; only the last of rows with several samples may have fewer.
fn parse(text: &str, layout: &Layout) -> Parsed<Contents> {
    let table = table_of(text, layout)?;
    let (Some(times), Some(unit)) = (&layout.times, layout.unit) else {
        return Err(LineFault::on(1)("a table needs its times and its unit"));
    };
    let chosen = [times.column(), layout.acceleration_column.as_ref()];
    let by_name = chosen.iter().flatten().any(|column| column.is_name());
    let contents = parse_table((text, &table), layout, times, unit, by_name);
    // Times that increase are not the whole parts of decimal numbers.
    let is_sure = by_name || contents.is_ok() && matches!(times, Times::Column(_));
    let row = decimal_commas(&table, layout.decimal).filter(|_| !is_sure);
    row.map_or(contents, |row| {
        let text = excerpt(row.text());
        Err(row.fault(format!(
            "the commas in `{text}` look like decimal marks: give `decimal = \"comma\"`, or a blank after each comma that \
             separates columns"
        )))
    })
}

/// Reads the samples of a table, which is a part of a whole text.
fn parse_table(
    (whole, text): (&str, &str),
    layout: &Layout,
    times: &Times,
    unit: Unit,
    by_name: bool,
) -> Parsed<Contents> {
    let mut rows = Rows::new(text, layout.decimal).peekable();
    let names = rows.next_if(|row| by_name || row.has_no_number(layout.decimal));
    let line = names.as_ref().map_or(0, |row| row.line);
    // A file that is too long is refused before its rows are read.
    let mut lines = text.lines().zip(1..).filter(|(text, _)| is_row(text));
    if let Some((_, line)) = lines.nth(MAX_SAMPLES + usize::from(names.is_some())) {
        return Err(too_many(line));
    }
    let first = rows.peek().ok_or_else(|| no_samples(text, line))?;
    let columns = Columns::find(layout, times.column(), names.as_ref(), first)?;
    let unit_s = columns.time_unit_s();
    let states_unit = unit
        .check_name(columns.name(columns.acceleration))
        .map_err(LineFault::on(line.max(1)))?;
    let (mut clock, mut values, mut read) = (Clock::default(), Values::default(), Vec::new());
    let (first_line, mut rows_read) = (first.line, 0);
    values.line = first_line;
    while let Some(row) = rows.next() {
        let is_last = rows.peek().is_none();
        columns
            .check_width(&row, columns.wrapped && is_last)
            .map_err(LineFault::on(row.line))?;
        let time_s = columns.read(&row, &mut read).map_err(|wrong| {
            let is_of_table = |row: &Row<'_>| columns.read(row, &mut Vec::new()).is_ok();
            row.fault(wrong + &hint(&row, Rows::new(text, layout.decimal), &values, is_of_table))
        })?;
        columns.check_count(&row).map_err(LineFault::on(row.line))?;
        rows_read += 1;
        for value in read.drain(..) {
            values.push(row.line, value)?;
        }
        if columns.time.is_some() {
            clock.push(row.line, time_s * unit_s)?;
        }
    }
    let last_line = values.line;
    let gap = clock.gap();
    let (samples, repeated) = match *times {
        Times::Step(step_s) => {
            columns.check_header(&values, step_s)?;
            checked_step("`dt_s`", step_s).map_err(LineFault::on(last_line))?;
            (values.evenly(step_s, last_line, "`dt_s`")?, None)
        }
        Times::Column(_) => clock.samples(values)?,
    };
    let blank = blank_line(whole, [first_line, last_line], rows_read);
    let contents = Contents {
        columns: columns.described(),
        states_unit,
        ..Contents::new(samples, unit)
    };
    Ok(contents.doubted(repeated.into_iter().chain(gap).chain(blank)))
}

/// Returns a warning about blank lines between the first and the last row of a table, as a phrase that follows the name of the file; `None` if a
/// blank line follows every row.
fn blank_line(text: &str, [first, last]: [usize; 2], rows: usize) -> Option<String> {
    if last - first < rows {
        return None;
    }
    let lines = text.lines().zip(1..).take(last).skip(first);
    let mut blank = lines.filter(|(line, _)| line.trim().is_empty());
    let (_, line) = blank.next()?;
    let others = blank.count();
    let more = match others {
        0 => String::new(),
        _ => format!(" and {others} more"),
    };
    (others + 2 < rows).then(|| {
        format!("has a blank line among its samples (line {line}{more}): are rows missing?")
    })
}

/// Returns the first row if the commas of a table look like decimal marks: they separate whole numbers, at most two in a word, and no names.
fn decimal_commas(text: &str, decimal: Decimal) -> Option<Row<'_>> {
    let is_whole = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let is_decimal = |word: &str| {
        let parts = || word.trim_start_matches('-').split(',');
        parts().count() <= 2 && parts().all(is_whole)
    };
    let mut rows = Rows::new(text, decimal);
    let has_commas = rows.delimiter == b',';
    let first = rows
        .find(|row| row.count() > 1 || !row.has_no_number(decimal))
        .filter(|_| has_commas)?;
    let are_decimal = |row: &Row<'_>| row.text().split_whitespace().all(is_decimal);
    let are_all = are_decimal(&first) && rows.all(|row| are_decimal(&row));
    Some(first).filter(|first| are_all && first.text().contains(','))
}

/// Returns the error that a table has no rows.
fn no_samples(text: &str, last_line: usize) -> LineFault {
    let blank = text.lines().take_while(|line| line.is_empty()).count();
    let line = if last_line > 0 { last_line } else { blank };
    LineFault::on(line.max(1))("there are no samples")
}

/// Returns the text of the table. The lines before it and comments by `%` are blank, so that the others keep their line numbers; the text ends
/// before the end marker.
fn table_of<'t>(text: &'t str, layout: &Layout) -> Parsed<Cow<'t, str>> {
    let skipped = layout.skip_rows;
    // A column may be named by its unit, `%g`.
    let is_comment =
        |line: &str| line.trim_start().starts_with('%') && !line.trim().eq_ignore_ascii_case("%g");
    let end = layout.end_marker.as_deref().map(|marker| {
        // A row of numbers never ends a table, or a marker such as `-` would cut it.
        let is_number = |word: &str| word.is_empty() || layout.decimal.number(word).is_ok();
        let is_row = |line: &str| line.split([' ', '\t', ';', ',']).all(is_number);
        let ends = |line: &str| line.trim_start().starts_with(marker) && !is_row(line);
        let mut lines = text.lines().enumerate().skip(skipped);
        let end = lines.find(|(_, line)| ends(line)).map(|(index, _)| index);
        end.ok_or_else(|| {
            let marker = excerpt(marker);
            LineFault::on(text.lines().count().max(1))(format!(
                "no line of words begins with `{marker}` up to here, the `end_marker` of the table"
            ))
        })
    });
    let end = end.transpose()?;
    let has_comment = || text.contains('%') && text.lines().any(is_comment);
    if skipped == 0 && end.is_none() && !has_comment() {
        return Ok(Cow::Borrowed(text));
    }
    let lines = text.split_inclusive('\n').enumerate();
    let lines = lines.take(end.unwrap_or(usize::MAX));
    let lines = lines.map(|(index, line)| match index < skipped || is_comment(line) {
        true => "\n",
        false => line,
    });
    Ok(lines.collect::<String>().into())
}

/// The columns of times and accelerations, with indices from 0.
struct Columns<'a> {
    layout: &'a Layout,
    /// Index of the column of times; `None` with a constant step.
    time: Option<usize>,
    acceleration: usize,
    /// True if a row contains several samples.
    wrapped: bool,
    /// Names of the columns; empty if there are not as many as columns.
    names: Vec<&'a str>,
    /// Text of the row of names; empty without one.
    title: &'a str,
    /// Text and line of the first row.
    first: (&'a str, usize),
    /// Least and largest number of cells of a row.
    width: [usize; 2],
}

impl<'a> Columns<'a> {
    fn find(
        layout: &'a Layout,
        time: Option<&TableColumn>,
        names: Option<&'a Row<'_>>,
        first: &Row<'a>,
    ) -> Parsed<Self> {
        let fault = LineFault::on::<String>(names.map_or(first.line, |row| row.line));
        let mut columns = Self {
            layout,
            time: None,
            acceleration: 0,
            wrapped: layout.wrapped && time.is_none() && layout.acceleration_column.is_none(),
            names: Vec::new(),
            title: names.map_or("", |row| row.text()),
            first: (first.text(), first.line),
            width: first.width(),
        };
        if let Some(row) = names.filter(|row| columns.fits(row)) {
            columns.names = row.cells().collect();
        } else if let Some(row) = names.filter(|row| !row.by_blanks && row.count() > 1) {
            let (count, text) = (first.count(), excerpt(row.text()));
            let wrong = format!(
                "the names `{text}` are not those of {count} columns: correct them or the row below"
            );
            ensure(count <= 1 || columns.wrapped, || fault(wrong))?;
        }
        if columns.wrapped {
            let title = excerpt(columns.title);
            let wrong = format!(
                "`{title}` names columns, which hold samples of their own: give `acceleration_column` instead of `wrapped`, or \
                 `skip_rows` if this is a title"
            );
            ensure(columns.names.len() <= 1, || fault(wrong))?;
            return Ok(columns);
        }
        let time = time.map(|column| columns.time_index(column));
        columns.time = time.transpose().map_err(fault)?;
        let only = columns.others(first).next();
        let only = only.unwrap_or(usize::from(columns.time == Some(0)));
        let chosen = layout.acceleration_column.as_ref();
        let acceleration = chosen.map_or(Ok(only), |column| columns.index(column));
        columns.acceleration = acceleration.map_err(fault)?;
        let wrong =
            || fault("times and samples are in one column: give `acceleration_column`".into());
        ensure(columns.time != Some(columns.acceleration), wrong)?;
        Ok(columns)
    }

    fn index(&self, column: &TableColumn) -> Result<usize, String> {
        let wanted = match column {
            TableColumn::Number(0) => return Err("columns are counted from 1".to_owned()),
            TableColumn::Number(number) => return Ok(number - 1),
            TableColumn::Name(name) => name,
        };
        let mut found = (0..self.names.len()).filter(|index| self.names[*index] == wanted);
        let (found, name) = ([found.next(), found.next()], excerpt(wanted));
        let (title, count) = (excerpt(self.title), self.width[0]);
        match found {
            [Some(index), None] => Ok(index),
            [Some(_), Some(_)] => Err(format!(
                "there are two columns named `{name}`: choose one by its number"
            )),
            _ if self.names.is_empty() => Err(format!(
                "`{title}` is not one name for each of {count} columns: choose columns by their numbers"
            )),
            _ => Err(format!("there is no column named `{name}` in `{title}`")),
        }
    }

    /// Returns the index of the column of times. A column without a name beside one with the name of times contains row numbers.
    fn time_index(&self, column: &TableColumn) -> Result<usize, String> {
        const WORDS: [&str; 6] = ["t", "time", "times", "zeit", "temps", "tempo"];
        let is_time = |name: &&str| {
            let word = name.split(|c: char| !c.is_alphanumeric()).next();
            word.is_some_and(|word| WORDS.contains(&&*word.to_lowercase()))
        };
        let time = self.index(column)?;
        let own = self.names.get(time).filter(|name| !is_time(name));
        let own = own.filter(|_| !column.is_name());
        match own.zip(self.names.iter().position(is_time)) {
            Some((&"", other)) => Ok(other),
            Some((own, other)) => {
                let ([own, other], number) = ([own, self.names[other]].map(excerpt), time + 1);
                Err(format!(
                    "column {number} is named `{own}`, another one `{other}`: give the name of the times as `time_column`"
                ))
            }
            None => Ok(time),
        }
    }

    /// Returns the name of a column, or else the whole title.
    fn name(&self, index: usize) -> &'a str {
        self.names.get(index).unwrap_or(&self.title)
    }

    /// Returns the filled columns that may contain samples: not the times, and not row numbers, which have no name before the times.
    fn others(&self, row: &Row<'_>) -> impl Iterator<Item = usize> {
        let is_number = |index| Some(index) < self.time && self.names.get(index) == Some(&"");
        let is_other = move |index| Some(index) != self.time && !is_number(index);
        let filled = row.cells().zip(0..).filter(|(cell, _)| !cell.is_empty());
        filled
            .map(|(_, index)| index)
            .filter(move |index| is_other(*index))
    }

    /// Returns the unit of the times in s, which their name may contain, as `time_ms` or `t [ms]`.
    fn time_unit_s(&self) -> f64 {
        let name = self.time.map_or("", |index| self.name(index));
        let words = name.split(|c: char| !c.is_alphanumeric());
        let mut units = words.filter_map(|word| match word.to_ascii_lowercase().as_str() {
            "ms" | "msec" | "millisecond" | "milliseconds" => Some(1e-3),
            "us" | "usec" | "microsecond" | "microseconds" | "\u{b5}s" | "\u{3bc}s" => Some(1e-6),
            _ => None,
        });
        units.next_back().unwrap_or(1.0)
    }

    /// Returns the read columns, in words that follow the unit.
    fn described(&self) -> String {
        let column = |index: usize| {
            let name = self.names.get(index).filter(|name| !name.is_empty());
            let name = name.map_or_else(String::new, |name| format!(" `{}`", excerpt(name)));
            format!("column {}{name}", index + 1)
        };
        if self.wrapped {
            return format!(", {} a row", self.width[0]);
        }
        let (times, samples) = (self.time.map(column), column(self.acceleration));
        let times = times.map(|times| format!(", times from {times}"));
        format!(" from {samples}{}", times.unwrap_or_default())
    }

    /// Adds the samples of a row to `samples`. Returns its time, or zero without a column of times.
    fn read(&self, row: &Row<'_>, samples: &mut Vec<f64>) -> Result<f64, String> {
        let number = |index: usize| match row.cells().nth(index) {
            Some("") => Err(format!(
                "column {} of `{}` is empty",
                index + 1,
                excerpt(row.text())
            )),
            Some(cell) => self.layout.decimal.number(cell),
            None => Err(self.no_column(index, row)),
        };
        if self.wrapped {
            for cell in row.cells().take(row.count()) {
                samples.push(in_range(self.layout.decimal.number(cell)?)?);
            }
            return Ok(0.0);
        }
        let time_s = self.time.map_or(Ok(0.0), number)?;
        samples.push(in_range(number(self.acceleration)?)?);
        Ok(time_s)
    }

    fn fits(&self, row: &Row<'_>) -> bool {
        let ([least, most], [filled, all]) = (self.width, row.width());
        least <= all && filled <= most
    }

    /// Returns an error if the row has not as many cells as the first one. The last row of several samples may have fewer.
    fn check_width(&self, row: &Row<'_>, may_end: bool) -> Result<(), String> {
        let (count, [least, most], (first, line)) = (row.count(), self.width, self.first);
        ensure(self.fits(row) || may_end && count <= most, || {
            let [text, first] = [row.text(), first].map(excerpt);
            format!(
                "`{text}` has {count} cells, but `{first}` on line {line} has {least}: complete the row, give its first word as `end_marker` if the \
                 table ends above, or `skip_rows = {line}` if it begins below"
            )
        })
    }

    /// Returns an error for a row with several columns of samples if none was chosen.
    fn check_count(&self, row: &Row<'_>) -> Result<(), String> {
        let is_chosen = self.wrapped || self.layout.acceleration_column.is_some();
        let is_one = || self.others(row).all(|index| index == self.acceleration);
        let count = row.count();
        ensure(is_chosen || is_one(), || {
            let is_named = !self.names.is_empty();
            let text = excerpt(if is_named { self.title } else { row.text() });
            let wrapped = match self.time {
                _ if is_named => "",
                None => ", or `wrapped = true`, if a row holds samples one after another",
                Some(_) => {
                    ", or `dt_s` and `wrapped = true`, if a row holds samples one after another"
                }
            };
            format!(
                "there are {count} columns: set `acceleration_column` to the column to read{wrapped}: `{text}`"
            )
        })
    }

    /// Returns an error if the first row looks like a header: it contains the number of samples below, or a large whole number and the step.
    fn check_header(&self, values: &Values, step_s: f64) -> Parsed<()> {
        let (text, line) = self.first;
        let words = || text.split([' ', '\t', ',', ';']);
        let has_step = words().count() > 1 && words().any(|word| number(word) == Ok(step_s));
        let first = if self.wrapped { self.width[0] } else { 1 };
        let below = values.values.len().saturating_sub(first);
        let is_below = |count: usize| count == below || count + 1 == below;
        let mut counts = words().filter_map(|word| word.parse().ok());
        let count = counts.find(|count| *count >= 10 && (has_step || is_below(*count)));
        count.map_or(Ok(()), |count| {
            let text = excerpt(text);
            Err(LineFault::on(line)(format!(
                "`{text}` looks like a header that announces {count} samples: give `skip_rows = {line}`, or write a sample with \
                 a decimal point"
            )))
        })
    }

    fn no_column(&self, index: usize, row: &Row<'_>) -> String {
        let hint = match self.time.is_some() && row.cells.len() == 1 {
            true => "; if the file has accelerations only, give `dt_s`",
            false => "",
        };
        let (place, text) = (index + 1, excerpt(row.text()));
        format!("there is no column {place} in `{text}`{hint}")
    }
}

impl Decimal {
    /// Parses the number in a cell.
    fn number(self, cell: &str) -> Result<f64, String> {
        let with_point = || {
            let is_one = cell.matches(',').count() == 1;
            is_one
                .then(|| number(&cell.replace(',', ".")).ok())
                .flatten()
        };
        match self {
            Self::Comma if cell.contains(',') && !cell.contains('.') => {
                with_point().ok_or_else(|| format!("`{}` is not a finite number", excerpt(cell)))
            }
            Self::Comma => number(cell),
            Self::Point => number(cell).map_err(|wrong| match with_point() {
                Some(_) => {
                    format!("{wrong}; if the comma is its decimal mark, give `decimal = \"comma\"`")
                }
                None => wrong,
            }),
        }
    }
}

/// Returns true if a cell of the first row is the name of a column. A damaged number is not a name: more than half of its characters are those
/// of numbers, or half of them including the first.
fn names_column(cell: &str, decimal: Decimal) -> bool {
    let is_of_numbers = |c: char| c.is_ascii_digit() || ".,+-".contains(c);
    let of_numbers = cell.chars().filter(|c| is_of_numbers(*c)).count();
    let is_damaged =
        2 * of_numbers + usize::from(cell.starts_with(is_of_numbers)) > cell.chars().count();
    let is_number = cell.parse::<f64>().is_ok() || decimal.number(cell).is_ok();
    // A unit or a number of samples may stand alone, as in `acceleration (600)`.
    let is_word = cell.contains(char::is_alphabetic) || cell.starts_with(['(', '[']);
    cell.is_empty() || is_word && !is_number && !is_damaged
}

/// Largest magnitude of a number in a table that is not a record.
const MAX_NUMBER: f64 = 1e6;

/// Reads rows of exactly `N` numbers. Returns each with its line. A first row without any number contains names.
pub(crate) fn numbers<const N: usize>(
    text: &str,
    decimal: Decimal,
) -> Parsed<Vec<(usize, [f64; N])>> {
    let mut found = Vec::new();
    for row in Rows::new(text, decimal) {
        if found.is_empty() && row.has_no_number(decimal) {
            continue;
        }
        let values = row.cells().map(|cell| {
            let value = decimal.number(cell)?;
            let wrong = || format!("`{value:?}` is out of range; must be within 1e6 of zero");
            ensure(value.abs() <= MAX_NUMBER, wrong).map(|()| value)
        });
        let values = values.collect::<Result<Vec<_>, String>>();
        let values = <[f64; N]>::try_from(values.map_err(LineFault::on(row.line))?);
        let values = values.map_err(|values| {
            let (text, count) = (excerpt(row.text()), values.len());
            row.fault(format!("`{text}` has {count} cells, not {N}"))
        })?;
        let many = || row.fault(format!("more than {MAX_SAMPLES} rows"));
        ensure(found.len() < MAX_SAMPLES, many)?;
        found.push((row.line, values));
    }
    Ok(found)
}

/// The rows of a table that are neither blank nor comments.
struct Rows<'a> {
    text: &'a str,
    delimiter: u8,
    reader: ::csv::Reader<std::io::Chain<&'a [u8], &'static [u8]>>,
}

struct Row<'a> {
    /// Line on which the row ends, from 1.
    line: usize,
    /// The table up to the end of that line.
    read: &'a str,
    by_blanks: bool,
    record: StringRecord,
    /// Places of the cells in the text of the record. Every check of a row asks for them, so they are found once.
    cells: Vec<Range<usize>>,
}

impl<'a> Rows<'a> {
    fn new(text: &'a str, decimal: Decimal) -> Self {
        // The first row may contain names with blanks and commas.
        let mut rows = text.lines().filter(|line| is_row(line));
        let first = rows.next().unwrap_or_default();
        let second = rows.next().unwrap_or(first);
        // Delimiters inside quotation marks do not separate cells.
        let parts = |row: &str, c: char| row.split('"').step_by(2).any(|part| part.contains(c));
        let either = |c: char| parts(first, c) || parts(second, c);
        let delimiter = if either(';') {
            b';'
        } else if either('\t') {
            b'\t'
        } else if decimal == Decimal::Point
            && (parts(second, ',') || parts(first, ',') && !second.trim().contains(' '))
        {
            b','
        } else {
            b' '
        };
        // If the text ends with a line break, the line number after a row is that of the next line.
        let end: &[u8] = if text.ends_with('\n') { b"" } else { b"\n" };
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter)
            .terminator(Terminator::Any(b'\n'))
            .comment(Some(b'#'))
            .from_reader(text.as_bytes().chain(end));
        Self {
            text,
            delimiter,
            reader,
        }
    }
}

impl<'a> Iterator for Rows<'a> {
    type Item = Row<'a>;

    fn next(&mut self) -> Option<Row<'a>> {
        let mut record = StringRecord::with_capacity(32, 4);
        // Rows of a text in memory may have any number of cells, so reading cannot fail.
        while self.reader.read_record(&mut record).unwrap_or(false) {
            let end = self.reader.position();
            let [line, end] = [end.line() - 1, end.byte()].map(|at| at as usize);
            let read = &self.text[..end.min(self.text.len())];
            let begins = record.as_slice().trim_start();
            let is_certain = !begins.is_empty() && !begins.starts_with('#');
            if is_certain || is_row(last_line(read)) {
                return Some(Row::new(line, read, self.delimiter == b' ', record));
            }
        }
        None
    }
}

/// Returns true for a line that is neither blank nor a comment.
fn is_row(line: &str) -> bool {
    let line = line.trim_start();
    !line.is_empty() && !line.starts_with('#')
}

/// Returns the last line of a text, without surrounding blanks.
fn last_line(text: &str) -> &str {
    text.lines().next_back().unwrap_or_default().trim()
}

/// Returns a hint for the error of a row: in the first one, the row with which the table begins; in a row of words below the table, how to skip it;
/// empty if there is none.
fn hint(
    wrong: &Row<'_>,
    mut rows: Rows<'_>,
    before: &Values,
    is_of_table: impl Fn(&Row<'_>) -> bool,
) -> String {
    const BETWEEN: [char; 3] = [' ', '\t', ';'];
    let is_number = |word: &str| number(word).is_ok();
    if !before.values.is_empty() {
        let has_number = wrong.text().split(BETWEEN).any(is_number);
        let remedy = "; begin the line with `#` to skip it, or give its first word as `end_marker` if the table ends before it";
        return remedy.repeat((!has_number).into());
    }
    let is_of_numbers = |row: &Row<'_>| {
        let mut words = row.text().split(BETWEEN).filter(|word| !word.is_empty());
        words.all(is_number)
    };
    // If the first row has numbers as well, numbers alone do not begin the table.
    let has_words = !is_of_numbers(wrong);
    let begins = |row: &Row<'_>| is_of_table(row) || has_words && is_of_numbers(row);
    let row = rows.find(|row| row.line > wrong.line && begins(row));
    row.map_or_else(String::new, |row| {
        let (line, skipped) = (row.line, row.line - 1);
        format!("; numbers begin on line {line}: give `skip_rows = {skipped}` if the table does")
    })
}

/// Splits a cell into numbers that touch, as in `-0.123-0.456`. Other cells, such as the date 2009-04-06, stay whole.
fn touching(cell: &str, by_blanks: bool) -> impl Iterator<Item = &str> {
    let is_decimal = |word: &str| word.contains('.') && number(word).is_ok();
    let touch = by_blanks && words(cell).nth(1).is_some() && words(cell).all(is_decimal);
    let (whole, parts) = match touch {
        true => (None, cell),
        false => (Some(cell), ""),
    };
    whole.into_iter().chain(words(parts))
}

impl<'a> Row<'a> {
    /// Finds the cells of a record, without surrounding blanks. A quotation mark after a blank is not a quotation for the CSV reader, so it is
    /// removed here.
    fn new(line: usize, read: &'a str, by_blanks: bool, record: StringRecord) -> Self {
        let whole = record.as_slice();
        let mut cells = Vec::with_capacity(record.len());
        for cell in &record {
            let cell = cell.trim();
            // Consecutive blanks count as one separator.
            if by_blanks && cell.is_empty() {
                continue;
            }
            let cell = cell.trim_matches('"').trim();
            cells.extend(touching(cell, by_blanks).map(|part| {
                let start = part.as_ptr().addr() - whole.as_ptr().addr();
                start..start + part.len()
            }));
        }
        Self {
            line,
            read,
            by_blanks,
            record,
            cells,
        }
    }

    /// Returns the line on which the row ends.
    fn text(&self) -> &'a str {
        last_line(self.read)
    }

    fn cells(&self) -> impl DoubleEndedIterator<Item = &str> + ExactSizeIterator {
        let whole = self.record.as_slice();
        self.cells.iter().map(move |cell| &whole[cell.clone()])
    }

    /// Returns the number of cells up to the last one that is not empty.
    fn count(&self) -> usize {
        let filled = self.cells().rposition(|cell| !cell.is_empty());
        filled.map_or(0, |last| last + 1)
    }

    /// Returns true if all cells are names.
    fn has_no_number(&self, decimal: Decimal) -> bool {
        self.cells().all(|cell| names_column(cell, decimal))
    }

    /// Returns the number of columns of this row, without and with empty cells at its end.
    fn width(&self) -> [usize; 2] {
        [self.count(), self.cells.len()]
    }

    fn fault(&self, message: String) -> LineFault {
        LineFault::on(self.line)(message)
    }
}

impl TableColumn {
    const fn is_name(&self) -> bool {
        matches!(self, Self::Name(_))
    }
}

impl Times {
    const fn column(&self) -> Option<&TableColumn> {
        match self {
            Self::Column(column) => Some(column),
            Self::Step(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::parse;
    use crate::tests::{assert_fault, csv_layout};
    use crate::{Decimal, Layout, TableColumn, Times, Unit};

    #[test]
    fn tables_of_all_kinds_are_read() {
        let columns = |time, acceleration| Layout {
            acceleration_column: Some(acceleration),
            ..Layout::table(Times::Column(time), Unit::Gravity)
        };
        let name = |name: &str| TableColumn::Name(name.to_owned());
        let number = TableColumn::Number;
        for (text, layout) in [
            ("t,a\n0,1\n0.5,-2\n", csv_layout()),
            ("# made by hand\n\nt;a\r\n0;1\r\n0.5;-2", csv_layout()),
            ("t\tb\ta\n0\t\t1\n\n0.5\t\t-2\n", csv_layout()),
            ("0,1\n0.5,-2\n", columns(number(1), number(2))),
            (
                "x,t,\"a\"\n9, 0.0 ,1e0\n9,\"0.5\",-2D0\n",
                columns(name("t"), name("a")),
            ),
            ("a,t\n1,0\n-2,.5\n", columns(number(2), number(1))),
            // Quoted cells may contain delimiters and line breaks.
            (
                "\"x; \"\"raw\"\"\",t,\"a\"\n\"1,5\",0,1\n;,\"0.5\", \"-2\" \n",
                columns(name("t"), name("a")),
            ),
            (
                "t;\"acceleration\nin g\"\r\n\r\n  # x\r\n0;\"1\"\r\n0.5;-2\r\n",
                columns(name("t"), name("acceleration\nin g")),
            ),
        ] {
            assert_eq!(
                parse(text, &layout),
                Ok(vec![(0.0, 1.0), (0.5, -2.0)]),
                "{text}"
            );
        }
    }

    #[test]
    fn faults_of_tables_have_lines() {
        let fault = |text: &str, line, words| assert_fault(text, &csv_layout(), line, words);
        fault("", 1, "no samples");
        fault("# x\n\n", 1, "no samples");
        fault("t,b\n0,1", 1, "no column named `a` in `t,b`");
        fault("t,a,a\n0,1,2", 1, "two columns named `a`");
        fault(
            "t,a\n0,1\n# x\n1\n",
            4,
            "`1` has 1 cells, but `0,1` on line 2 has 2",
        );
        fault("t,a\n0,1\n\n1,x\n", 4, "`x` is not a finite number");
        fault(
            "t,\"a\"\n\n0,\"1\"\r\n\n1,\"x\"",
            5,
            "`x` is not a finite number",
        );
        fault("t,a\n0,1\n1,\"2\n3\"\n", 4, "`2` is not a finite number");
        // Without a closing quotation mark all further text is quoted.
        fault("t,a\n0,1\n1,\"2\n2,3\n", 4, "`2` is not a finite number");
        fault("t,a\n0,1\n1,\"2\n2,3", 4, "`2` is not a finite number");
        fault("t,a\n0,1\n1,inf\n", 3, "`inf` is not a finite number");
        fault(
            "t,a\n0,1\n1,2\n1,3\n",
            4,
            "does not increase: 1 s follows 1 s",
        );
        fault("t,a\n0,1\n-1,2\n", 3, "does not increase");
        fault("t,a\n0,1\n1e7,2\n", 3, "out of range");
        fault("t,a\n0,1\n", 2, "number of samples is 1");
        // A first row with a number is not a header.
        assert_fault("0,1x\n1,2\n", &numbered(), 1, "`1x`");
    }

    /// Times in the first column and accelerations in the second.
    fn numbered() -> Layout {
        Layout::table(Times::Column(TableColumn::Number(1)), Unit::Gravity)
    }

    #[test]
    fn columns_may_be_parted_by_blanks() {
        let layout = numbered();
        for text in [
            "0 1\n0.5 -2\n",
            "  0.0     1.0E+00\n  0.5    -2.0E+00  \n",
            "time  acc\n0 1\n0.5 -2\n",
            "time (s)   acc (g)\n\n# x\n0 1\r\n0.5 -2",
            "time, acceleration\n0 1\n0.5 -2",
            "time acceleration\n0,1\n0.5, -2",
        ] {
            assert_eq!(
                parse(text, &layout),
                Ok(vec![(0.0, 1.0), (0.5, -2.0)]),
                "{text}"
            );
        }
        let named = Layout {
            acceleration_column: Some(TableColumn::Name("acc".to_owned())),
            ..numbered()
        };
        let text = "time  acc\n0 1\n0.5 -2\n";
        assert_eq!(parse(text, &named), Ok(vec![(0.0, 1.0), (0.5, -2.0)]));
        // A name with a blank would be two names.
        let text = "time (s) acc (g)\n0 1\n0.5 -2\n";
        assert_fault(
            text,
            &named,
            1,
            "`time (s) acc (g)` is not one name for each of 2 columns",
        );
    }

    #[test]
    fn a_single_column_has_even_steps() {
        let layout = |step_s| Layout::table(Times::Step(step_s), Unit::Gravity);
        for text in [
            "1\n-2\n3\n",
            "acc in g\n1\n-2\n3",
            " 1\r\n\r\n -2\r\n 3\r\n",
        ] {
            assert_eq!(
                parse(text, &layout(0.25)),
                Ok(vec![(0.0, 1.0), (0.25, -2.0), (0.5, 3.0)]),
                "{text}"
            );
        }
        let fault = |text: &str, line, words| assert_fault(text, &layout(1e6), line, words);
        fault(
            "1\n2\n3\n",
            3,
            "`dt_s` and the number of samples make a record of 2e6 s",
        );
        fault("1\n", 1, "number of samples is 1");
        for step_s in [0.0, -1.0, f64::NAN] {
            assert_fault("1\n2\n", &layout(step_s), 2, "must be at least 1e-6 s");
        }
        let column_0 = Layout {
            acceleration_column: Some(TableColumn::Number(0)),
            ..layout(0.1)
        };
        assert_fault("1\n2\n", &column_0, 1, "columns are counted from 1");
        let message =
            "there is no column 2 in `1`; if the file has accelerations only, give `dt_s`";
        assert_fault("1\n2\n", &numbered(), 1, message);
    }

    #[test]
    fn lines_before_the_table_are_skipped_and_hinted_at() {
        let text = "Station X; 12.5 E\nDate; 2009\n\nt; a\n0; 1\n0.5; -2\n";
        let skipping = |skip_rows| Layout {
            skip_rows,
            ..numbered()
        };
        let expected = Ok(vec![(0.0, 1.0), (0.5, -2.0)]);
        assert_eq!(parse(text, &skipping(3)), expected);
        assert_eq!(parse(text, &skipping(4)), expected);
        let named = Layout {
            acceleration_column: Some(TableColumn::Name("a".to_owned())),
            skip_rows: 3,
            ..numbered()
        };
        assert_eq!(parse(text, &named), expected);
        assert_fault(
            text,
            &skipping(0),
            1,
            "`Station X` is not a finite number; numbers begin on line 5: give `skip_rows = 4` if the table does",
        );
        // Errors have the line numbers of the file.
        let text = text.replace("-2", "x");
        assert_fault(&text, &skipping(3), 6, "`x` is not a finite number");
        assert_fault("a\nb\n", &skipping(5), 2, "there are no samples");
        assert_fault("a\nb\n0;1\n1;2", &skipping(3), 4, "number of samples is 1");
    }

    #[test]
    fn comments_by_percent_signs_are_skipped() {
        let expected = Ok(vec![(0.0, 1.0), (0.5, -2.0)]);
        for text in [
            "% time in s, \"acc\nt,a\n0,1\n % half\n0.5,-2\n",
            "\u{feff}% made by hand\r\n%\r\nt,a\r\n0,1\r\n0.5,-2",
        ] {
            assert_eq!(parse(text, &csv_layout()), expected, "{text}");
        }
        // Errors have the line numbers of the file.
        assert_fault("% x\nt,a\n%\n0,x", &csv_layout(), 4, "`x`");
        // The unit of a column is no comment.
        let layout = Layout::table(Times::Step(0.01), Unit::Gravity);
        for name in ["%g", " %G "] {
            let text = format!("{name}\n1.0\n2.0\n-3\n");
            assert_fault(&text, &layout, 1, "the column is named `%");
        }
    }

    #[test]
    fn a_table_ends_before_its_end_marker() {
        let until = |marker: &str| Layout {
            end_marker: Some(marker.to_owned()),
            skip_rows: 1,
            ..numbered()
        };
        let expected = Ok(vec![(0.0, 1.0), (0.5, -2.0)]);
        for (text, marker) in [
            ("END\n0 1\n0.5 -2\n END OF DATA\n9 9 9\n", "END"),
            ("\r\n0,1\r\n0.5,-2\r\n-----\r\n3 samples", "-"),
            ("\u{feff}x\n0 1\n0.5 -2\n-999 end", "-999"),
        ] {
            assert_eq!(parse(text, &until(marker)), expected, "{text}");
        }
        let text = "x\n0 1\n0.5 -2\n-999 -999\n";
        assert_fault(
            text,
            &until("-999"),
            4,
            "no line of words begins with `-999`",
        );
        assert_fault("x\n0 1\nEND\n0.5 -2\n", &until("END"), 2, "samples is 1");
        // The footer of a single column, and of rows of several samples whose last one is shorter.
        let step = Layout::table(Times::Step(0.5), Unit::Gravity);
        for wrapped in [false, true] {
            let layout = Layout {
                wrapped,
                end_marker: Some("END".to_owned()),
                ..step.clone()
            };
            let rows = if wrapped { "1 -2\n3\n" } else { "1\n-2\n3\n" };
            let samples = parse(&format!("{rows}END 3\n"), &layout);
            assert_eq!(samples, Ok(vec![(0.0, 1.0), (0.5, -2.0), (1.0, 3.0)]));
        }
    }

    #[test]
    fn numbers_between_blanks_may_touch() {
        let text = " 0.123-0.456-1.E-03 7.000\n-2.000-3.000-4.000\n";
        let samples = parse(text, &wrapped()).unwrap();
        let values: Vec<_> = samples.iter().map(|sample| sample.1).collect();
        assert_eq!(values, [0.123, -0.456, -0.001, 7.0, -2.0, -3.0, -4.0]);
        let expected = Ok(vec![(0.0, -1.5), (0.5, -2.0)]);
        assert_eq!(parse("0.000-1.500\n0.500-2.000\n", &numbered()), expected);
        // A date is one cell.
        let dated = Layout {
            acceleration_column: Some(TableColumn::Number(2)),
            ..step()
        };
        let samples = parse("2009-04-06 1\n2009-04-06 -2\n", &dated);
        assert_eq!(samples, Ok(vec![(0.0, 1.0), (0.5, -2.0)]));
    }

    fn step() -> Layout {
        Layout::table(Times::Step(0.5), Unit::Gravity)
    }

    #[test]
    fn decimal_commas_are_read_where_they_are_announced() {
        let comma = Layout {
            decimal: Decimal::Comma,
            ..numbered()
        };
        for text in [
            "0,0;1,0\n0,5;-2,0\n",
            "t\ta\n0\t1,0\n,5\t-2E0\n",
            "0,0  1,0\n0,5 -2,0\n",
            "0;1\n0.5;-2\n",
        ] {
            assert_eq!(
                parse(text, &comma),
                Ok(vec![(0.0, 1.0), (0.5, -2.0)]),
                "{text}"
            );
        }
        assert_fault("0;1\n1;1,2,3", &comma, 2, "`1,2,3` is not a finite number");
        assert_fault("0;1\n1;1.2,3", &comma, 2, "`1.2,3` is not a finite number");
        let point = numbered();
        assert_fault("0;1\n1;1,2", &point, 2, "give `decimal = \"comma\"`");
    }

    fn wrapped() -> Layout {
        Layout {
            wrapped: true,
            ..Layout::table(Times::Step(0.5), Unit::Gravity)
        }
    }

    #[test]
    fn rows_of_several_samples_are_read_where_that_is_said() {
        let comma = Layout {
            decimal: Decimal::Comma,
            ..wrapped()
        };
        for (text, layout) in [
            ("1 -2 3\n4 5 6\n", &wrapped()),
            ("  1.0E+00 -2.0 3.\r\n\r\n 4 5 6", &wrapped()),
            ("1,-2,3,\n4,5,6,\n", &wrapped()),
            ("1;-2;3;4\n5;6\n", &wrapped()),
            ("acceleration in g\n1 -2\n3 4\n# half\n5 6\n", &wrapped()),
            ("1\n-2\n3\n4\n5\n6\n", &wrapped()),
            ("1 -2 3 4 5 6", &wrapped()),
            ("1,0 -2,0 3,0\n4,0 5,0 6,0\n", &comma),
        ] {
            let times_s = (0..6).map(|i| 0.5 * f64::from(i));
            let expected: Vec<_> = times_s.zip([1.0, -2.0, 3.0, 4.0, 5.0, 6.0]).collect();
            assert_eq!(parse(text, layout), Ok(expected), "{text}");
        }
        let fault = |text: &str, line, words| assert_fault(text, &wrapped(), line, words);
        fault("", 1, "no samples");
        fault("a b\n", 1, "no samples");
        fault("1\n", 1, "number of samples is 1");
        fault("1 2\n3 x\n", 2, "`x` is not a finite number");
        fault("1 2\n\n3 1e308\n", 3, "`1e308` is out of range");
        fault(
            "PEER\nNPTS= 4\n1 2\n3 4\n",
            2,
            "numbers begin on line 3: give `skip_rows = 2`",
        );
        // Only the last row may be shorter, and names of columns are no title.
        fault(
            "1 -2 3\n4 5\n6\n",
            2,
            "`4 5` has 2 cells, but `1 -2 3` on line 1 has 3",
        );
        fault("1 -2 3\n4 5 6 7\n", 2, "has 4 cells");
        fault(
            "N-S E-W U-D\n1 2 3\n4 5\n",
            1,
            "`N-S E-W U-D` names columns",
        );
    }

    /// A header of numbers is not read as samples: it gives the number of samples or rows below, or a number beside the step.
    #[test]
    fn headers_of_numbers_are_refused() {
        let column = "0.5\n".repeat(12);
        let rows = "1.5 -2.5 3.5\n".repeat(4);
        let one = Layout {
            wrapped: false,
            ..wrapped()
        };
        for (text, layout) in [
            (format!("12\n{column}"), &one),
            (format!("12\n0.01\n{column}"), &one),
            (format!("12 0.01 0\n{rows}"), &wrapped()),
            (format!("4000 0.5 0\n{rows}"), &wrapped()),
        ] {
            assert_fault(&text, layout, 1, "looks like a header that announces");
        }
        for (text, count, layout) in [
            (format!("12.\n{column}"), 13, &one),
            (format!("14\n{column}"), 13, &one),
            (format!("4000 0.6 0\n{rows}"), 15, &wrapped()),
        ] {
            assert_eq!(parse(&text, layout).unwrap().len(), count, "{text}");
        }
    }

    /// A table that can be read in two ways is refused.
    #[test]
    fn columns_are_not_confused() {
        let step = Layout::table(Times::Step(0.5), Unit::Gravity);
        let second = |layout: Layout| Layout {
            acceleration_column: Some(TableColumn::Number(2)),
            ..layout
        };
        let say = "there are 3 columns: set `acceleration_column` to the column to read, or `wrapped = true`";
        for text in [
            "1 -2 3\n4 5 6\n",
            "# 6 samples\n1 -2 3\n4 5 6\n",
            "1 -2 3\n4 5\n",
        ] {
            assert_fault(text, &step, 1 + usize::from(text.starts_with('#')), say);
        }
        let say = "there are 3 columns: set `acceleration_column` to the column to read, or `dt_s` and `wrapped = true`";
        assert_fault("0 -2 3\n4 5 6\n", &numbered(), 1, say);
        // Rows with a missing cell.
        for (layout, text, line) in [
            (second(step.clone()), "1 -2 3\n4 5\n", 2),
            (second(numbered()), "t ns ew\n0.00 1 2\n0.02  2.2\n", 3),
            (second(numbered()), "t ns ew\n0.00 1\n0.02 1 2.2\n", 3),
            (second(numbered()), "t,ns,ew\n0,1\n1,2\n", 1),
        ] {
            let words = if line == 1 {
                "not those of 2 columns"
            } else {
                "cells, but"
            };
            assert_fault(text, &layout, line, words);
        }
        // Empty columns, row numbers and other names of the times.
        let expected = Ok(vec![(0.0, 1.5), (1.0, -2.0)]);
        for text in [
            "0,1.5,\n1,-2,\n",
            "0\t\t1.5\n1\t\t-2\n",
            ",time,acc\n0,0,1.5\n1,1,-2\n",
            "t,acc,note\n0,1.5,\n1,-2,\n",
        ] {
            assert_eq!(parse(text, &numbered()), expected, "{text}");
        }
        assert_eq!(
            parse("\t1.5\n\t-2\n", &step),
            Ok(vec![(0.0, 1.5), (0.5, -2.0)])
        );
        let times = Layout {
            times: Some(Times::Column(TableColumn::Number(2))),
            ..numbered()
        };
        assert_eq!(parse("a,t\n1.5,0\n-2,1\n", &times), expected);
        assert_fault(
            "n,time,acc\n0,0,1\n",
            &numbered(),
            1,
            "column 1 is named `n`, another one `time`",
        );
        assert_fault("0,1\n1,\n", &numbered(), 2, "column 2 of `1,` is empty");
        assert_fault(
            "0,1\n1,2\nend\n",
            &second(numbered()),
            3,
            "`end` has 1 cells",
        );
        assert_fault("1\n2\nEND\n", &step, 3, "begin the line with `#`");
    }

    #[test]
    fn decimal_commas_are_not_columns() {
        let step = Layout::table(Times::Step(0.5), Unit::Gravity);
        for (text, layout) in [
            ("0,00 0,10\n0,01 0,25\n0,02 -0,3\n", &numbered()),
            ("12,5\n-8,25\n30,1\n", &numbered()),
            ("12,5\n-8,25\n30,1\n", &step),
            (
                "12,5\n18,25\n",
                &Layout {
                    wrapped: true,
                    ..step.clone()
                },
            ),
        ] {
            assert_fault(
                text,
                layout,
                1,
                "look like decimal marks: give `decimal = \"comma\"`",
            );
        }
        assert_eq!(parse("0,1\n1,2\n", &numbered()).unwrap().len(), 2);
    }

    #[test]
    fn a_name_contradicts_the_unit() {
        let metres = Layout {
            unit: Some(Unit::MetrePerS2),
            ..numbered()
        };
        for name in [
            "acc(g)",
            "a [cm/s^2]",
            "acc_gal",
            "acceleration in g",
            "a (mg)",
            "v [m/s]",
        ] {
            let text = format!("time,{name}\n0,1\n1,2\n");
            assert_fault(&text, &metres, 1, "but `unit` is \"m/s2\"");
        }
        for name in ["acc (m/s^2)", "a", "a (NS)", "acc_ns", "a [M/SEC/SEC]"] {
            assert!(
                parse(&format!("time,{name}\n0,1\n1,2\n"), &metres).is_ok(),
                "{name}"
            );
        }
        assert_fault("time (s) acc (g)\n0 1\n1 2\n", &metres, 1, "but `unit`");
    }
}
