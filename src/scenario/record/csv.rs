//! Tables of samples with a column of times or a constant step; commas, semicolons, tabs or blanks separate the columns.

mod wrapped;

use std::borrow::Cow;
use std::io::Read as _;

use ::csv::{ReaderBuilder, StringRecord, Terminator};

use super::layout::{COLUMN_NUMBER, Decimal, Layout, TableColumn, Times};
use super::samples::*;
use crate::scenario::prelude::*;

/// Reads the samples, in the unit of the file.
///
/// Blank lines and lines that begin with `#` are skipped. The first of the other lines may contain the names of the columns; names are required
/// if a column is chosen by name.
pub(super) fn parse(text: &str, layout: &Layout) -> Parsed<Contents> {
    let table = without_first(text, layout.skip_rows);
    let (Some(times), Some(unit)) = (&layout.times, layout.unit) else {
        return Err(LineFault::on(1)("a table needs its times and its unit"));
    };
    if let (Times::Step(step_s), None) = (times, &layout.acceleration_column)
        && (layout.wrapped || wrapped::is_shown(text, &table, layout))
    {
        return Ok(Contents {
            wrapped: true,
            ..Contents::new(wrapped::parse(&table, *step_s, layout.decimal)?, unit)
        });
    }
    Ok(Contents::new(parse_columns(&table, layout, times)?, unit))
}

/// Reads a table with one sample per row.
fn parse_columns(text: &str, layout: &Layout, times: &Times) -> Parsed<Samples> {
    let mut rows = Rows::new(text, layout.decimal);
    let first = rows.next().ok_or_else(|| nothing(text, 0))?;
    let columns = Columns::find(layout, times, &first)?;
    let unit_s = columns.time_unit_s(&first);
    let (mut times_s, mut values) = (Vec::new(), Values::default());
    values.line = first.line;
    let begin = if columns.has_names {
        let second = rows.next();
        first.check_names(second.as_ref().filter(|_| columns.by_name))?;
        second
    } else {
        Some(first)
    };
    for row in begin.into_iter().chain(rows) {
        let [time_s, value] = columns.values(&row).map_err(|wrong| {
            let rows = Rows::new(text, layout.decimal);
            let hint = begin_below(&row, rows, &values, |row| columns.values(row).is_ok());
            row.fault(wrong + &hint)
        })?;
        columns.check_count(&row).map_err(LineFault::on(row.line))?;
        values.push(row.line, value)?;
        if columns.time.is_some() {
            let time_s = time_s * unit_s;
            check_time(time_s, times_s.last().copied()).map_err(LineFault::on(row.line))?;
            times_s.push(time_s);
        }
    }
    match *times {
        Times::Step(step_s) => {
            let line = values.line;
            values.evenly(step_s, line, "`dt_s`")
        }
        Times::Column(_) => {
            values.check_enough()?;
            Ok(times_s.into_iter().zip(values.values).collect())
        }
    }
}

/// Returns the error that a table has no rows.
fn nothing(text: &str, last_line: usize) -> LineFault {
    let blank = text.lines().take_while(|line| line.is_empty()).count();
    let line = if last_line > 0 { last_line } else { blank };
    LineFault::on(line.max(1))("there are no samples")
}

/// Replaces the first lines of a text by blank lines, so that the others keep their line numbers.
fn without_first(text: &str, lines: usize) -> Cow<'_, str> {
    if lines == 0 {
        return Cow::Borrowed(text);
    }
    let mut ends = text.match_indices('\n').map(|(at, _)| at + 1);
    match ends.nth(lines - 1) {
        Some(end) => Cow::Owned("\n".repeat(lines) + &text[end..]),
        None => Cow::Owned("\n".repeat(text.lines().count())),
    }
}

/// Returns an error if a time is out of range, or not later than the previous time.
fn check_time(time_s: f64, before_s: Option<f64>) -> Result<(), String> {
    ensure(time_s.abs() <= MAX_TIME_S, || {
        let (time, most) = (plain(time_s), short(MAX_TIME_S));
        format!("the time {time} s is out of range; its magnitude must be at most {most} s")
    })?;
    let before_s = before_s.unwrap_or(f64::NEG_INFINITY);
    ensure(time_s - before_s >= MIN_STEP_S, || {
        let [time, before, least] = [time_s, before_s, MIN_STEP_S].map(short);
        format!(
            "the time does not increase: {time} s follows {before} s; allowed are steps of at least {least} s"
        )
    })
}

/// The indices of the columns of times and accelerations, counted from 0.
struct Columns<'a> {
    layout: &'a Layout,
    /// Index of the column of times; `None` with a constant step.
    time: Option<usize>,
    acceleration: usize,
    /// True if a column is chosen by its name.
    by_name: bool,
    /// True if the first row contains names instead of numbers.
    has_names: bool,
}

impl<'a> Columns<'a> {
    fn find(layout: &'a Layout, times: &Times, first: &Row<'_>) -> Parsed<Self> {
        let names: Vec<_> = first.cells().take(*COLUMN_NUMBER.0.end()).collect();
        let index = |column: &TableColumn| column.index(&names).map_err(|wrong| first.fault(wrong));
        let time = match times {
            Times::Column(column) => Some(column),
            Times::Step(_) => None,
        };
        let chosen = layout.acceleration_column.as_ref();
        let is_name = |column: &&TableColumn| matches!(column, TableColumn::Name(_));
        let by_name = time.iter().chain(&chosen).any(is_name);
        let time = time.map(index).transpose()?;
        let acceleration = chosen.map_or(Ok(usize::from(time.is_some())), index)?;
        let mut read = time.iter().chain([&acceleration]).map(|at| names.get(*at));
        let has_names =
            by_name || read.all(|cell| cell.is_none_or(|cell| names_column(cell, layout.decimal)));
        Ok(Self {
            layout,
            time,
            acceleration,
            by_name,
            has_names,
        })
    }

    /// Returns the unit of the times in s, which their name may contain, as `time_ms` or `t [ms]`.
    fn time_unit_s(&self, first: &Row<'_>) -> f64 {
        let name = self.time.and_then(|index| first.cells().nth(index));
        let name = name.filter(|_| self.has_names).unwrap_or_default();
        let words = name.split(|c: char| !c.is_alphanumeric());
        let mut units = words.filter_map(|word| match word.to_ascii_lowercase().as_str() {
            "ms" | "msec" | "millisecond" | "milliseconds" => Some(1e-3),
            "us" | "usec" | "microsecond" | "microseconds" | "\u{b5}s" | "\u{3bc}s" => Some(1e-6),
            _ => None,
        });
        units.next_back().unwrap_or(1.0)
    }

    /// Returns time, or zero without a column of times, and acceleration.
    fn values(&self, row: &Row<'_>) -> Result<[f64; 2], String> {
        let value = |index: usize| match row.cells().nth(index) {
            Some(cell) => self.layout.decimal.number(cell),
            None => Err(self.no_column(index, row)),
        };
        let time_s = self.time.map_or(Ok(0.0), value)?;
        Ok([time_s, in_range(value(self.acceleration)?)?])
    }

    /// Returns an error for a row with several columns if none was chosen.
    fn check_count(&self, row: &Row<'_>) -> Result<(), String> {
        let count = row.count();
        let is_chosen = self.layout.acceleration_column.is_some();
        let is_one = count - usize::from(self.time.is_some()) <= 1;
        ensure(is_chosen || is_one, || match self.time {
            None => format!(
                "there are {count} columns: give `acceleration_column`, the one to read, or `wrapped = true`, if a \
                 row holds {count} samples, one after another"
            ),
            Some(_) => format!(
                "there are {count} columns: give `acceleration_column`, the one to read; or, if a row holds {count} \
                 samples, one after another, `dt_s` and `wrapped = true`"
            ),
        })
    }

    fn no_column(&self, index: usize, row: &Row<'_>) -> String {
        let hint = match self.time.is_some() && row.cells().count() == 1 {
            true => "; if the file has accelerations only, give `dt_s`",
            false => "",
        };
        let (place, text) = (index + 1, excerpt(row.text));
        format!("there is no column {place} in `{text}`{hint}")
    }
}

impl Decimal {
    /// Parses the number in a cell.
    fn number(self, cell: &str) -> Result<f64, String> {
        let commas = cell.matches(',').count();
        match self {
            Self::Comma if commas == 1 && !cell.contains('.') => number(&cell.replace(',', "."))
                .map_err(|_| format!("`{}` is not a finite number", excerpt(cell))),
            Self::Point if commas == 1 && number(&cell.replace(',', ".")).is_ok() => Err(format!(
                "`{}` is not a finite number; if the comma is its decimal mark, give `decimal = \"comma\"`",
                excerpt(cell)
            )),
            _ => number(cell),
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
pub(super) fn numbers<const N: usize>(text: &str) -> Parsed<Vec<(usize, [f64; N])>> {
    let mut found = Vec::new();
    for row in Rows::new(text, Decimal::Point) {
        if found.is_empty() && row.has_no_number(Decimal::Point) {
            continue;
        }
        let values = row.cells().map(|cell| {
            let value = number(cell)?;
            let wrong = || format!("`{value:?}` is out of range; must be within 1e6 of zero");
            ensure(value.abs() <= MAX_NUMBER, wrong).map(|()| value)
        });
        let values = values.collect::<Result<Vec<_>, String>>();
        let values = <[f64; N]>::try_from(values.map_err(LineFault::on(row.line))?);
        let values = values.map_err(|values| {
            let (text, count) = (excerpt(row.text), values.len());
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
    by_blanks: bool,
    reader: ::csv::Reader<std::io::Chain<&'a [u8], &'static [u8]>>,
}

struct Row<'a> {
    /// Line on which the row ends, from 1.
    line: usize,
    /// Text of that line.
    text: &'a str,
    by_blanks: bool,
    record: StringRecord,
}

impl<'a> Rows<'a> {
    fn new(text: &'a str, decimal: Decimal) -> Self {
        let is_row = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with('#');
        // The first row may contain names with blanks and commas.
        let mut rows = text.lines().filter(is_row);
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
            by_blanks: delimiter == b' ',
            reader,
        }
    }
}

impl<'a> Iterator for Rows<'a> {
    type Item = Row<'a>;

    fn next(&mut self) -> Option<Row<'a>> {
        let mut record = StringRecord::new();
        // Rows of a text in memory may have any number of cells, so reading cannot fail.
        while self.reader.read_record(&mut record).unwrap_or(false) {
            let end = self.reader.position();
            let [line, end] = [end.line() - 1, end.byte()].map(|at| at as usize);
            let read = &self.text[..end.min(self.text.len())];
            let text = read.lines().next_back().unwrap_or_default().trim();
            if !text.is_empty() && !text.starts_with('#') {
                return Some(Row {
                    line,
                    text,
                    by_blanks: self.by_blanks,
                    record,
                });
            }
        }
        None
    }
}

/// Returns a hint for the error of the first row without values: the next row that begins the table; empty if there is none.
fn begin_below(
    first: &Row<'_>,
    mut rows: Rows<'_>,
    before: &Values,
    is_of_table: impl Fn(&Row<'_>) -> bool,
) -> String {
    let is_first = before.values.is_empty();
    let row = rows.find(|row| is_first && row.line > first.line && is_of_table(row));
    row.map_or_else(String::new, |row| {
        let (line, skipped) = (row.line, row.line - 1);
        format!("; numbers begin on line {line}: give `skip_rows = {skipped}` if the table does")
    })
}

impl Row<'_> {
    /// Returns the cells, without surrounding blanks. A quotation mark after a blank is not a quotation for the CSV reader, so it is removed
    /// here.
    fn cells(&self) -> impl Iterator<Item = &str> {
        let cells = self.record.iter();
        // Consecutive blanks count as one separator.
        let cells = cells.filter(|cell| !(self.by_blanks && cell.trim().is_empty()));
        cells.map(|cell| cell.trim().trim_matches('"').trim())
    }

    /// Returns the number of cells up to the last one that is not empty.
    fn count(&self) -> usize {
        let filled = self.cells().zip(1..).filter(|(cell, _)| !cell.is_empty());
        filled.last().map_or(0, |(_, count)| count)
    }

    /// Returns true if all cells are names.
    fn has_no_number(&self, decimal: Decimal) -> bool {
        self.cells().all(|cell| names_column(cell, decimal))
    }

    /// Returns an error if the number of names separated by blanks differs from the number of columns, because a name contains a blank.
    fn check_names(&self, below: Option<&Self>) -> Parsed<()> {
        let names = self.cells().count();
        let columns = below.map_or(names, |row| row.cells().count());
        ensure(!self.by_blanks || names == columns, || {
            self.fault(format!(
                "there are {names} names between blanks for {columns} columns: choose columns by their numbers"
            ))
        })
    }

    fn fault(&self, message: String) -> LineFault {
        LineFault::on(self.line)(message)
    }
}

impl TableColumn {
    /// Returns the index of the column, from 0.
    fn index(&self, names: &[&str]) -> Result<usize, String> {
        let wanted = match self {
            Self::Number(number) => return Ok(number - 1),
            Self::Name(name) => name,
        };
        let mut found = (0..names.len()).filter(|index| names[*index] == wanted);
        let (found, name) = ([found.next(), found.next()], excerpt(wanted));
        match found {
            [Some(index), None] => Ok(index),
            [Some(_), Some(_)] => Err(format!(
                "there are two columns named `{name}`: choose one by its number"
            )),
            [None, _] => {
                let names = excerpt(&names.join(", "));
                Err(format!("there is no column named `{name}` in `{names}`"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::scenario::record::tests::parse;
    use crate::scenario::record::tests::{assert_fault, csv_layout};
    use crate::scenario::record::{Decimal, Layout, TableColumn, Times, Unit};

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
        fault("t,b\n0,1", 1, "no column named `a` in `t, b`");
        fault("t,a,a\n0,1", 1, "two columns named `a`");
        fault("t,a\n0,1\n# x\n1\n", 4, "no column 2 in `1`");
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
        assert_fault(text, &named, 1, "4 names between blanks for 2 columns");
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
}
