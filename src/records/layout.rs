//! Layout of a record file: its format, and, for tables, the columns of times and accelerations.

use std::fmt;

use archrock_text::shown;
use serde::{Serialize, Serializer};

use crate::correction::Baseline;
use crate::history::Finder;
use crate::samples::{Contents, Parsed};
use crate::unit::{RecordedQuantity, Unit};

/// A format of record files. Each is a constant in the file of its reader.
#[derive(Clone, Copy)]
pub struct Format {
    /// Name in scenarios.
    pub(crate) name: &'static str,
    /// Name of a file of this format in reports.
    pub(crate) label: &'static str,
    /// Extensions of file names, in lower case, that determine the format of a file whose contents do not.
    pub(crate) extensions: &'static [&'static str],
    /// Returns true if the first lines of a file, at least one, are of this format.
    pub(crate) begins: fn(&[&str]) -> bool,
    /// Reader of the files.
    pub(crate) parser: Parser,
}

/// Reader of the files of a format.
#[derive(Clone, Copy)]
pub(crate) enum Parser {
    /// Reads the only record of a file; with the reason for which the key `unit` is refused, `None` if it applies.
    Record(fn(&str, &Layout) -> Parsed<Contents>, Option<&'static str>),
    /// Finds the only history of a file, which its header describes.
    History(Finder),
    /// Finds the histories of all channels of a file, which its header describes.
    Channels(Finder),
}

/// Formats are equal if their names are.
impl PartialEq for Format {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Format {}

impl fmt::Debug for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl Default for Format {
    fn default() -> Self {
        Self::CSV
    }
}

impl Serialize for Format {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}

named! {
    /// The decimal mark.
    #[derive(Default)]
    pub enum Decimal {
        /// `0.12`.
        #[default]
        Point = "point",
        /// `0,12`; commas then do not separate columns.
        Comma = "comma",
    }
}

/// A column of a table, or a channel of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum TableColumn {
    /// Number, from 1.
    Number(usize),
    /// Name of the column in the first row; or name of the channel in the header, or whole words of it.
    Name(String),
}

/// The name or number as a part of the name of a record. Slashes become `_`, because a name may be part of a path.
impl fmt::Display for TableColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) => f.write_str(&shown(name).replace(['/', '\\'], "_")),
        }
    }
}

/// The times of the samples of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Times {
    /// A column of times in s.
    #[serde(rename = "time_column")]
    Column(TableColumn),
    /// Step between rows, in s; the first row is at time zero.
    #[serde(rename = "dt_s")]
    Step(f64),
}

/// Layout of a file. Semicolons, tabs, commas or blanks separate the columns of tables.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Layout {
    /// The format of the file.
    pub format: Format,
    /// Times of a table; `None` for other formats.
    #[serde(flatten)]
    pub times: Option<Times>,
    /// Column of accelerations or velocities of a table. `None` if there is only one such column, or if a row contains several samples and the
    /// header gives their number.
    pub acceleration_column: Option<TableColumn>,
    /// True if a row of a table contains several consecutive samples, even if the table does not show this. Used only with a constant step, and
    /// if no column is chosen.
    #[serde(skip_serializing_if = "is_default")]
    pub wrapped: bool,
    /// Unit of the samples; `None` for the unit in the header. An AT2 file of accelerations without a unit is in units of gravity.
    pub unit: Option<Unit>,
    /// Channel to read; `None` for the only one.
    #[serde(skip_serializing_if = "is_default")]
    pub channel: Option<TableColumn>,
    /// Number of lines before a table.
    #[serde(skip_serializing_if = "is_default")]
    pub skip_rows: usize,
    /// Beginning of the first line of words after a table; `None` if the table ends with the file.
    #[serde(skip_serializing_if = "is_default")]
    pub end_marker: Option<String>,
    /// Decimal mark of the numbers of a table.
    #[serde(skip_serializing_if = "is_default")]
    pub decimal: Decimal,
    /// The quantity that the samples measure.
    #[serde(skip_serializing_if = "is_default")]
    pub quantity: RecordedQuantity,
    /// Baseline to subtract from the accelerations; `None` for none.
    #[serde(skip_serializing_if = "is_default")]
    pub baseline: Option<Baseline>,
    /// Corner of the high-pass filter of the accelerations, in Hz; `None` without a filter.
    #[serde(skip_serializing_if = "is_default")]
    pub high_pass_hz: Option<f64>,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Layout {
    /// Makes the layout of a file of accelerations in this format; tables also need times and unit.
    pub fn new(format: Format) -> Self {
        Self {
            format,
            ..Self::default()
        }
    }

    /// Makes the layout of a table that begins on the first line, with decimal points and a single column of accelerations.
    pub fn table(times: Times, unit: Unit) -> Self {
        Self {
            times: Some(times),
            unit: Some(unit),
            ..Self::new(Format::CSV)
        }
    }
}
