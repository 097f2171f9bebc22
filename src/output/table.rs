//! Tables: lists of columns, written as CSV with only finite numbers.

use std::borrow::Cow;
use std::fmt;
use std::io::{self, Write};

use serde::Serialize;

use super::OutputError;

/// A column of a table, or several side by side: their names, and the cells for a row.
pub(crate) struct Column<'a, R> {
    names: Vec<Cow<'a, str>>,
    cells: Cells<'a, R>,
}

/// Adds the cells for a row; the number is that of the row, from 1.
type Cells<'a, R> = Box<dyn for<'r> Fn(&'r R, usize, &mut Vec<Cell<'r>>) + 'a>;

/// One cell, or numbers in several cells; numbers have the fewest digits that read back as the same value.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum Cell<'r> {
    Nothing,
    Text(Cow<'static, str>),
    Count(usize),
    Number(f64),
    Numbers(Cow<'r, [f64]>),
}

/// A column whose cells are computed from the row.
pub(crate) fn column<'a, R, C: Into<Cell<'static>>>(
    name: impl Into<Cow<'a, str>>,
    cell: impl Fn(&R) -> C + 'a,
) -> Column<'a, R> {
    Column {
        names: vec![name.into()],
        cells: Box::new(move |row, _, cells| cells.push(cell(row).into())),
    }
}

/// A column with the row numbers, from 1.
pub(crate) fn row_number<'a, R>(name: &'a str) -> Column<'a, R> {
    Column {
        names: vec![name.into()],
        cells: Box::new(|_, number, cells| cells.push(number.into())),
    }
}

/// Several columns whose cells are computed together, one for each name.
pub(crate) fn several<'a, R>(
    names: impl IntoIterator<Item = String>,
    add: impl for<'r> Fn(&'r R, &mut Vec<Cell<'r>>) + 'a,
) -> Column<'a, R> {
    Column {
        names: names.into_iter().map(Cow::Owned).collect(),
        cells: Box::new(move |row, _, cells| add(row, cells)),
    }
}

/// Columns for numbers that a row holds side by side.
pub(crate) fn numbers<'a, R>(
    names: impl IntoIterator<Item = String>,
    numbers: impl Fn(&R) -> &[f64] + 'a,
) -> Column<'a, R> {
    Column {
        names: names.into_iter().map(Cow::Owned).collect(),
        cells: Box::new(move |row, _, cells| cells.push(Cell::Numbers(numbers(row).into()))),
    }
}

impl From<f64> for Cell<'_> {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<usize> for Cell<'_> {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

impl From<&'static str> for Cell<'_> {
    fn from(text: &'static str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Cell<'_> {
    fn from(text: String) -> Self {
        Self::Text(text.into())
    }
}

impl<C: Into<Self>> From<Option<C>> for Cell<'_> {
    fn from(cell: Option<C>) -> Self {
        cell.map_or(Self::Nothing, Into::into)
    }
}

/// The bytes of a table.
///
/// # Errors
/// When a number is not finite.
pub(crate) fn csv<'a, 'r, R: 'r>(
    columns: impl Into<Vec<Column<'a, R>>>,
    rows: impl IntoIterator<Item = &'r R>,
) -> Result<Vec<u8>, OutputError> {
    let mut bytes = Vec::new();
    let mut table = TableWriter::new(&mut bytes, "cannot make a table", columns.into())?;
    for row in rows {
        table.write(row)?;
    }
    table.finish()?;
    Ok(bytes)
}

/// Writes a table row by row.
pub(crate) struct TableWriter<'a, R, W: Write> {
    csv: Table<W>,
    columns: Vec<Column<'a, R>>,
    rows: usize,
    what: &'static str,
}

impl<'a, R, W: Write> TableWriter<'a, R, W> {
    /// Begins with the header; `what` is the error message if writing fails.
    pub(crate) fn new(
        writer: W,
        what: &'static str,
        columns: Vec<Column<'a, R>>,
    ) -> Result<Self, OutputError> {
        let mut csv = table(writer);
        let names = columns.iter().flat_map(|column| &column.names);
        csv.write_record(names.map(|name| &**name))
            .map_err(OutputError::csv(what))?;
        Ok(Self {
            csv,
            columns,
            rows: 0,
            what,
        })
    }

    /// Writes a row.
    pub(crate) fn write(&mut self, row: &R) -> Result<(), OutputError> {
        self.rows += 1;
        let mut cells = Vec::with_capacity(self.columns.len());
        for column in &self.columns {
            (column.cells)(row, self.rows, &mut cells);
        }
        let written = self.csv.serialize(cells);
        written.map_err(OutputError::csv(self.what))
    }

    /// Ends the table and returns the number of its rows.
    pub(crate) fn finish(mut self) -> Result<usize, OutputError> {
        self.csv.flush().map_err(OutputError::io(self.what))?;
        Ok(self.rows)
    }
}

/// Writes text as CSV.
type Table<W> = csv::Writer<Finite<W>>;

/// Begins a table.
fn table<W: Write>(writer: W) -> Table<W> {
    csv::Writer::from_writer(Finite {
        writer,
        columns: Vec::new(),
        in_header: true,
        quoted: false,
        column: 0,
        cell: Vec::new(),
    })
}

/// Passes the text of a table on to its file, and refuses cells that hold the text of a number that is not
/// finite.
struct Finite<W> {
    writer: W,
    /// Names of the columns.
    columns: Vec<String>,
    in_header: bool,
    /// Whether the current text is between quotation marks.
    quoted: bool,
    /// Number of the current column.
    column: usize,
    /// The current cell so far, or its beginning.
    cell: Vec<u8>,
}

/// The column in which a number is not finite.
#[derive(Debug)]
pub(super) struct NotFinite(pub(super) String);

impl fmt::Display for NotFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is not finite", self.0)
    }
}

impl std::error::Error for NotFinite {}

/// Length of the longest text of a number that is not finite.
const LONGEST: usize = "-inf".len();

impl<W> Finite<W> {
    fn read(&mut self, byte: u8) -> io::Result<()> {
        match byte {
            b',' | b'\n' if !self.quoted => {
                self.end_cell()?;
                if byte == b',' {
                    self.column += 1;
                } else {
                    self.column = 0;
                    self.in_header = false;
                }
            }
            _ => {
                self.quoted ^= byte == b'"';
                if self.in_header || self.cell.len() <= LONGEST {
                    self.cell.push(byte);
                }
            }
        }
        Ok(())
    }

    fn end_cell(&mut self) -> io::Result<()> {
        if self.in_header {
            let name = String::from_utf8_lossy(&self.cell).into_owned();
            self.columns.push(name);
        } else if matches!(&self.cell[..], b"NaN" | b"inf" | b"-inf") {
            let name = self.columns.get(self.column).cloned();
            return Err(io::Error::other(NotFinite(name.unwrap_or_default())));
        }
        self.cell.clear();
        Ok(())
    }
}

impl<W: Write> Write for Finite<W> {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        for byte in text {
            self.read(*byte)?;
        }
        self.writer.write_all(text)?;
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::super::OutputError;
    use super::*;

    fn written(number: f64, text: &str) -> Result<String, OutputError> {
        let mut bytes = Vec::new();
        {
            let mut table = table(&mut bytes);
            let what = "cannot write";
            let csv = |error| OutputError::csv(what)(error);
            table.write_record(["a", "b\"c"]).map_err(csv)?;
            // Much more text than is buffered.
            for row in 0..10_000 {
                table.serialize((f64::from(row), 0.5)).map_err(csv)?;
            }
            table.serialize((text, number)).map_err(csv)?;
            table.flush().map_err(OutputError::io(what))?;
        }
        Ok(String::from_utf8(bytes).unwrap())
    }

    #[test]
    fn no_number_that_is_not_finite_is_written() {
        for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = written(number, "x").unwrap_err();
            let words = r#"the result "b""c" is not a finite number: please report the scenario"#;
            assert_eq!(error.to_string(), words);
            assert!(matches!(error, OutputError::NotFinite { .. }));
        }
        for text in ["", "NaN,inf", "NaNs", "-info", "a\"NaN", "\nNaN\n", ",inf,"] {
            let table = written(-1e300, text).unwrap();
            assert!(table.starts_with("a,\"b\"\"c\"\n0.0,0.5\n"));
            assert!(
                table.ends_with("-1e300\n"),
                "{}",
                &table[table.len() - 30..]
            );
            let mut reader = csv::Reader::from_reader(table.as_bytes());
            let last = reader.records().last().unwrap().unwrap();
            assert_eq!(&last[0], text);
        }
    }
}
