//! Tables of times and accelerations: comma-separated values, or parted by semicolons or tabs.

use std::io::Read as _;

use ::csv::{ReaderBuilder, StringRecord, Terminator};

use super::{
    COLUMN_NUMBER, LineFault, MAX_SAMPLES, MAX_TIME_S, MIN_STEP_S, Samples, TableColumn, number,
};
use crate::scenario::error::excerpt;

/// Reads the samples of two columns, in the unit of the file.
///
/// Blank lines and lines that begin with `#` are skipped. The first of the others may hold the names of
/// the columns, and must where a column is chosen by name.
pub(super) fn parse(
    text: &str,
    time: &TableColumn,
    acceleration: &TableColumn,
) -> Result<Samples, LineFault> {
    let mut rows = Rows::new(text);
    let Some(first) = rows.next()? else {
        return Err(LineFault {
            line: 1,
            message: "there are no samples".to_owned(),
        });
    };
    let names: Vec<_> = first.cells().take(*COLUMN_NUMBER.range.end()).collect();
    let column =
        |column: &TableColumn| column.index(&names).map_err(|message| first.fault(message));
    let columns = [column(time)?, column(acceleration)?];
    let by_name = [time, acceleration]
        .iter()
        .any(|column| matches!(column, TableColumn::Name(_)));
    let no_numbers = || {
        let mut cells = columns.iter().filter_map(|index| names.get(*index));
        cells.all(|cell| number(cell).is_err())
    };
    let is_header = by_name || no_numbers();

    let mut samples: Samples = Vec::new();
    let mut last_line = first.line;
    let mut next = if is_header { rows.next()? } else { Some(first) };
    while let Some(row) = next {
        last_line = row.line;
        let fault = |message| row.fault(message);
        let mut values = [0.0; 2];
        for (value, index) in values.iter_mut().zip(columns) {
            let cell = row.cells().nth(index).ok_or_else(|| {
                let place = index + 1;
                fault(format!(
                    "there is no column {place} in `{}`",
                    excerpt(row.text)
                ))
            })?;
            *value = number(cell).map_err(fault)?;
        }
        let [time_s, acceleration] = values;
        if time_s.abs() > MAX_TIME_S {
            return Err(fault(format!(
                "the time {time_s:?} s is out of range; its magnitude must be at most {MAX_TIME_S:?} s"
            )));
        }
        if let Some((before_s, _)) = samples.last()
            && time_s - before_s < MIN_STEP_S
        {
            return Err(fault(format!(
                "the time does not increase: {time_s:?} s follows {before_s:?} s; allowed are steps of at \
                 least {MIN_STEP_S:?} s"
            )));
        }
        if samples.len() == MAX_SAMPLES {
            return Err(fault(format!(
                "more than {MAX_SAMPLES} samples, too many for a record"
            )));
        }
        samples.push((time_s, acceleration));
        next = rows.next()?;
    }
    if samples.len() < 2 {
        return Err(LineFault {
            line: last_line,
            message: format!(
                "the number of samples is {}; must be at least 2",
                samples.len()
            ),
        });
    }
    Ok(samples)
}

/// Rows of exactly so many numbers, each with its line. A first row without any number holds names.
pub(super) fn numbers<const N: usize>(text: &str) -> Result<Vec<(usize, [f64; N])>, LineFault> {
    let mut rows = Rows::new(text);
    let mut found = Vec::new();
    while let Some(row) = rows.next()? {
        if found.is_empty() && row.cells().all(|cell| number(cell).is_err()) {
            continue;
        }
        let cells: Vec<&str> = row.cells().collect();
        if cells.len() != N {
            let message = format!("`{}` has {} cells, not {N}", excerpt(row.text), cells.len());
            return Err(row.fault(message));
        }
        let mut values = [0.0; N];
        for (value, cell) in values.iter_mut().zip(cells) {
            *value = number(cell).map_err(|message| row.fault(message))?;
        }
        if found.len() == MAX_SAMPLES {
            return Err(row.fault(format!("more than {MAX_SAMPLES} rows")));
        }
        found.push((row.line, values));
    }
    Ok(found)
}

/// The rows of a table that are neither blank nor comments.
struct Rows<'a> {
    text: &'a str,
    reader: ::csv::Reader<std::io::Chain<&'a [u8], &'static [u8]>>,
}

struct Row<'a> {
    /// Line on which it ends, from 1.
    line: usize,
    /// That line.
    text: &'a str,
    record: StringRecord,
}

impl<'a> Rows<'a> {
    fn new(text: &'a str) -> Self {
        let is_row = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with('#');
        let first = text.lines().find(is_row).unwrap_or_default();
        // What stands in quotation marks does not part cells.
        let parted_by = |c: char| first.split('"').step_by(2).any(|part| part.contains(c));
        let delimiter = match (parted_by(';'), parted_by('\t')) {
            (true, _) => b';',
            (false, true) => b'\t',
            (false, false) => b',',
        };
        // Where the last line has an end, the line number after a row is that of the next line.
        let end: &[u8] = if text.ends_with('\n') { b"" } else { b"\n" };
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter)
            .terminator(Terminator::Any(b'\n'))
            .comment(Some(b'#'))
            .from_reader(text.as_bytes().chain(end));
        Self { text, reader }
    }

    fn next(&mut self) -> Result<Option<Row<'a>>, LineFault> {
        let mut record = StringRecord::new();
        loop {
            let read = self.reader.read_record(&mut record);
            let end = self.reader.position();
            let line = usize::try_from(end.line() - 1).unwrap_or(usize::MAX);
            let fault = |error: ::csv::Error| LineFault {
                line,
                message: error.to_string(),
            };
            if !read.map_err(fault)? {
                return Ok(None);
            }
            let end = usize::try_from(end.byte()).unwrap_or(usize::MAX);
            let read = &self.text[..end.min(self.text.len())];
            let text = read.lines().next_back().unwrap_or_default().trim();
            if !text.is_empty() && !text.starts_with('#') {
                return Ok(Some(Row { line, text, record }));
            }
        }
    }
}

impl Row<'_> {
    /// The cells, without blanks around them. A quotation mark that follows a blank does not quote, but surely was
    /// meant to.
    fn cells(&self) -> impl Iterator<Item = &str> {
        let cells = self.record.iter();
        cells.map(|cell| cell.trim().trim_matches('"').trim())
    }

    fn fault(&self, message: String) -> LineFault {
        LineFault {
            line: self.line,
            message,
        }
    }
}

impl TableColumn {
    /// The index from 0.
    fn index(&self, names: &[&str]) -> Result<usize, String> {
        let wanted = match self {
            Self::Number(number) => return Ok(number - 1),
            Self::Name(name) => name,
        };
        let mut found = (0..names.len()).filter(|index| names[*index] == wanted);
        match (found.next(), found.next()) {
            (Some(index), None) => Ok(index),
            (Some(_), Some(_)) => Err(format!(
                "there are two columns named `{}`: choose one by its number",
                excerpt(wanted)
            )),
            (None, _) => Err(format!(
                "there is no column named `{}` in `{}`",
                excerpt(wanted),
                excerpt(&names.join(", "))
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::scenario::record::tests::{assert_fault, csv_layout};
    use crate::scenario::record::{Layout, TableColumn, Unit, parse};

    #[test]
    fn tables_of_all_kinds_are_read() {
        let columns = |time, acceleration| Layout::Csv {
            time_column: time,
            acceleration_column: acceleration,
            unit: Unit::Gravity,
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
            // Quotation marks hold delimiters, line breaks and their like together.
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
        // A mark that is not closed quotes all that follows.
        fault("t,a\n0,1\n1,\"2\n2,3\n", 4, "`2` is not a finite number");
        fault("t,a\n0,1\n1,\"2\n2,3", 4, "`2` is not a finite number");
        fault("t,a\n0,1\n1,inf\n", 3, "`inf` is not a finite number");
        fault(
            "t,a\n0,1\n1,2\n1,3\n",
            4,
            "does not increase: 1.0 s follows 1.0 s",
        );
        fault("t,a\n0,1\n-1,2\n", 3, "does not increase");
        fault("t,a\n0,1\n1e7,2\n", 3, "out of range");
        fault("t,a\n0,1\n", 2, "number of samples is 1");
        // A first row that is half a number is not a header.
        let numbered = Layout::Csv {
            time_column: TableColumn::Number(1),
            acceleration_column: TableColumn::Number(2),
            unit: Unit::Gravity,
        };
        assert_fault("0,1x\n1,2\n", &numbered, 1, "`1x`");
    }
}
