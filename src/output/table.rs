//! Tables as lists of columns, written as CSV; all numbers must be finite.

use std::borrow::Cow;
use std::io::Write;

use serde::Serialize;

use super::OutputError;
use crate::argument::plain;

/// One or several columns of a table: their names, and the cells of a row.
pub(crate) struct Column<'a, R> {
    names: Vec<Cow<'a, str>>,
    cells: Cells<'a, R>,
}

/// Adds the cells of a row. The number is that of the row, from 1.
type Cells<'a, R> = Box<dyn for<'r> Fn(&'r R, usize, &mut Vec<Cell<'r>>) + 'a>;

/// One cell, or numbers in several cells. Numbers have the fewest digits that read back as the same value.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum Cell<'r> {
    Nothing,
    Text(Cow<'static, str>),
    Integer(i64),
    Number(f64),
    Numbers(Cow<'r, [f64]>),
}

impl<R> Column<'_, R> {
    /// Returns its names.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(|name| &**name)
    }
}

/// Makes a column whose cells are computed from the row.
pub(crate) fn column<'a, R, C: Into<Cell<'static>>>(
    name: impl Into<Cow<'a, str>>,
    cell: impl Fn(&R) -> C + 'a,
) -> Column<'a, R> {
    Column {
        names: vec![name.into()],
        cells: Box::new(move |row, _, cells| cells.push(cell(row).into())),
    }
}

/// Makes columns with the names of fields, such as `fields!(|point: &Point| point => time_s, force_n)`.
macro_rules! fields {
    (|$row:ident: $type:ty| $of:expr => $($field:ident),+ $(,)?) => {
        [$($crate::output::table::column(stringify!($field), |$row: $type| $of.$field)),+]
    };
}
pub(crate) use fields;

/// Makes a column with the row numbers, from 1.
pub(crate) fn row_number<'a, R>(name: &'a str) -> Column<'a, R> {
    Column {
        names: vec![name.into()],
        cells: Box::new(|_, number, cells| cells.push(number.into())),
    }
}

/// Makes several columns whose cells are computed together, one for each name.
pub(crate) fn several<'a, R>(
    names: impl IntoIterator<Item = String>,
    add: impl for<'r> Fn(&'r R, &mut Vec<Cell<'r>>) + 'a,
) -> Column<'a, R> {
    Column {
        names: names.into_iter().map(Cow::Owned).collect(),
        cells: Box::new(move |row, _, cells| add(row, cells)),
    }
}

/// Makes several columns of a list, one for each name.
pub(crate) fn list<'a, R, N: Into<Cow<'a, str>>, C: Into<Cell<'static>>, L>(
    names: impl IntoIterator<Item = N>,
    list: impl Fn(&R) -> L + 'a,
) -> Column<'a, R>
where
    L: IntoIterator<Item = C>,
{
    Column {
        names: names.into_iter().map(Into::into).collect(),
        cells: Box::new(move |row, _, cells| {
            for cell in list(row) {
                cells.push(cell.into());
            }
        }),
    }
}

/// Returns the cells of several numbers that a row may lack.
pub(crate) fn each<T: Copy, const N: usize>(numbers: Option<[T; N]>) -> [Option<T>; N] {
    numbers.map_or([None; N], |numbers| numbers.map(Some))
}

/// Makes columns of a slice of numbers in the row.
pub(crate) fn numbers<'a, R>(
    names: impl IntoIterator<Item = String>,
    numbers: impl Fn(&R) -> &[f64] + 'a,
) -> Column<'a, R> {
    several(names, move |row, cells| {
        cells.push(Cell::Numbers(numbers(row).into()))
    })
}

impl From<f64> for Cell<'_> {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<bool> for Cell<'_> {
    fn from(is_true: bool) -> Self {
        Self::Text(if is_true { "true" } else { "false" }.into())
    }
}

impl From<usize> for Cell<'_> {
    fn from(count: usize) -> Self {
        Self::Integer(i64::try_from(count).unwrap_or(i64::MAX))
    }
}

impl From<i64> for Cell<'_> {
    fn from(number: i64) -> Self {
        Self::Integer(number)
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

/// A table in memory: the contents of its file, and its first rows with rounded numbers.
#[derive(Debug, Default)]
pub(crate) struct Table {
    /// The table as CSV.
    pub(crate) csv: Vec<u8>,
    /// Names of the columns.
    pub(crate) header: Vec<String>,
    /// The first rows, at most [`Table::FIRST`], with numbers of six digits.
    pub(crate) first: Vec<Vec<String>>,
    /// Number of all rows.
    pub(crate) rows: usize,
    /// Whether each column has text in any row.
    pub(crate) is_text: Vec<bool>,
}

impl Table {
    /// Largest number of first rows.
    pub(crate) const FIRST: usize = 1000;

    /// Makes a table of all rows.
    ///
    /// # Errors
    /// When a number is not finite.
    pub(crate) fn new<'a, 'r, R: 'r>(
        columns: impl Into<Vec<Column<'a, R>>>,
        rows: impl IntoIterator<Item = &'r R>,
    ) -> Result<Self, OutputError> {
        let (mut csv, columns) = (Vec::new(), columns.into());
        let names = columns.iter().flat_map(|column| &column.names);
        let header: Vec<String> = names.map(|name| name.to_string()).collect();
        let mut table = Self {
            is_text: vec![false; header.len()],
            header,
            ..Self::default()
        };
        let mut writer = TableWriter::new(&mut csv, "cannot make a table", columns)?;
        for row in rows {
            writer.write_and_see(row, |cells| table.note(cells))?;
        }
        table.rows = writer.finish()?;
        Ok(Self { csv, ..table })
    }

    /// Notes the cells of the next row.
    fn note(&mut self, cells: &[Cell<'_>]) {
        let mut at = 0;
        for cell in cells {
            self.is_text[at] |= matches!(cell, Cell::Text(_));
            at += cell.width();
        }
        if self.first.len() < Self::FIRST {
            self.first
                .push(cells.iter().flat_map(Cell::rounded).collect());
        }
    }

    /// Returns the names of the columns with text.
    pub(crate) fn text_columns(&self) -> Vec<String> {
        let columns = self.header.iter().zip(&self.is_text);
        let with_text = columns.filter(|(_, is_text)| **is_text);
        with_text.map(|(name, _)| name.clone()).collect()
    }
}

impl Cell<'_> {
    /// Returns the number of columns.
    fn width(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            _ => 1,
        }
    }

    /// Returns the text of each column, with numbers rounded to six digits.
    fn rounded(&self) -> Vec<String> {
        match self {
            Self::Nothing => vec![String::new()],
            Self::Text(text) => vec![text.to_string()],
            Self::Integer(number) => vec![number.to_string()],
            Self::Number(number) => vec![plain(*number)],
            Self::Numbers(numbers) => numbers.iter().map(|number| plain(*number)).collect(),
        }
    }
}

/// Writes a table row by row.
pub(crate) struct TableWriter<'a, R, W: Write> {
    csv: csv::Writer<W>,
    columns: Vec<Column<'a, R>>,
    rows: usize,
    what: String,
}

impl<'a, R, W: Write> TableWriter<'a, R, W> {
    /// Writes the header. `what` is the error message if writing fails.
    pub(crate) fn new(
        writer: W,
        what: impl Into<String>,
        columns: Vec<Column<'a, R>>,
    ) -> Result<Self, OutputError> {
        let (what, mut csv) = (what.into(), csv::Writer::from_writer(writer));
        let names = columns.iter().flat_map(|column| &column.names);
        csv.write_record(names.map(|name| &**name))
            .map_err(OutputError::csv(&*what))?;
        Ok(Self {
            csv,
            columns,
            rows: 0,
            what,
        })
    }

    /// Writes a row.
    pub(crate) fn write(&mut self, row: &R) -> Result<(), OutputError> {
        self.write_and_see(row, |_| ())
    }

    /// Writes a row, and passes its cells to a function.
    fn write_and_see(&mut self, row: &R, see: impl FnOnce(&[Cell<'_>])) -> Result<(), OutputError> {
        self.rows += 1;
        let mut cells = Vec::with_capacity(self.columns.len());
        for column in &self.columns {
            (column.cells)(row, self.rows, &mut cells);
        }
        let mut at = 0;
        for cell in &cells {
            let (numbers, width) = match cell {
                Cell::Number(number) => (std::slice::from_ref(number), 1),
                Cell::Numbers(numbers) => (&**numbers, numbers.len()),
                _ => (&[][..], 1),
            };
            if let Some(wrong) = numbers.iter().position(|number| !number.is_finite()) {
                let mut names = self.columns.iter().flat_map(|column| &column.names);
                let what = names.nth(at + wrong).map_or("", |name| name).to_owned();
                return Err(OutputError::NotFinite(what));
            }
            at += width;
        }
        see(&cells);
        let written = self.csv.serialize(cells);
        written.map_err(OutputError::csv(&*self.what))
    }

    /// Ends the table. Returns the number of its rows.
    pub(crate) fn finish(mut self) -> Result<usize, OutputError> {
        self.csv.flush().map_err(OutputError::io(self.what))?;
        Ok(self.rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Row = (String, [f64; 2]);

    fn written(number: f64, text: &str) -> Result<String, OutputError> {
        let columns = [
            column("a", |row: &Row| row.0.clone()),
            numbers(["b", "c\"d"].map(String::from), |row: &Row| &row.1),
            column("e", |row: &Row| row.1[0]),
        ];
        // The text is longer than the buffer.
        let mut rows: Vec<_> = (0..10_000)
            .map(|row| (row.to_string(), [0.5, f64::from(row)]))
            .collect();
        rows.push((text.to_owned(), [1.0, number]));
        Ok(String::from_utf8(Table::new(columns, &rows)?.csv).unwrap())
    }

    #[test]
    fn no_number_that_is_not_finite_is_written() {
        for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = written(number, "x").unwrap_err();
            let words = r#"the result c"d is not a finite number: please report the scenario"#;
            assert_eq!(error.to_string(), words);
            assert!(matches!(error, OutputError::NotFinite { .. }));
        }
        for text in ["", "NaN,inf", "NaNs", "-info", "a\"NaN", "\nNaN\n", ",inf,"] {
            let table = written(-1e300, text).unwrap();
            assert!(table.starts_with("a,b,\"c\"\"d\",e\n0,0.5,0.0,0.5\n"));
            assert!(table.ends_with("1.0,-1e300,1.0\n"));
            let mut reader = ::csv::Reader::from_reader(table.as_bytes());
            let last = reader.records().last().unwrap().unwrap();
            assert_eq!(&last[0], text);
        }
    }
}
