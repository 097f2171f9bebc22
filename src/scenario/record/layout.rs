//! How a record's file is read: its format, and for tables where times and accelerations stand.

use std::ffi::OsStr;
use std::ops::Bound::Included;
use std::path::Path;

use serde::Serialize;
use toml::de::DeValue;

use super::unit::AnyUnit;
use super::{LineFault, MAX_TIME_S, MIN_STEP_S, Samples, Unit, asc, at2, csv};
use crate::scenario::table::{Count, Number, OneOf, Reading, Rule, Table};

named! {
    /// Format of a record's file.
    pub enum Format {
        /// PEER strong motion database.
        At2 = "at2",
        /// Engineering Strong Motion database.
        Asc = "asc",
        /// A table with a column of accelerations, and one of times or even steps.
        Csv = "csv",
    }
}

named! {
    /// What parts the whole of a number from its fraction.
    pub enum Decimal {
        /// `0.12`.
        Point = "point",
        /// `0,12`; commas then part no columns.
        Comma = "comma",
    }
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum TableColumn {
    /// By its number, from 1.
    Number(usize),
    /// By its name in the first row.
    Name(String),
}

/// Where the times of a table come from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Times {
    /// A column of times in s.
    #[serde(rename = "time_column")]
    Column(TableColumn),
    /// One row follows another after so many seconds, the first at zero.
    #[serde(rename = "dt_s")]
    Step(f64),
}

/// How a table is read. Its columns are parted by semicolons, tabs, commas or blanks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableLayout {
    /// Times.
    #[serde(flatten)]
    pub times: Times,
    /// Accelerations.
    pub acceleration_column: TableColumn,
    /// Their unit.
    pub unit: Unit,
    /// Lines before the table.
    #[serde(skip_serializing_if = "is_none")]
    pub skip_rows: usize,
    /// How numbers are written.
    #[serde(skip_serializing_if = "is_point")]
    pub decimal: Decimal,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
const fn is_none(rows: &usize) -> bool {
    *rows == 0
}

fn is_point(decimal: &Decimal) -> bool {
    *decimal == Decimal::Point
}

impl TableLayout {
    /// A table that begins on the first line, with decimal points.
    #[must_use]
    pub const fn new(times: Times, acceleration_column: TableColumn, unit: Unit) -> Self {
        Self {
            times,
            acceleration_column,
            unit,
            skip_rows: 0,
            decimal: Decimal::Point,
        }
    }
}

/// How a file is read.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "format", rename_all = "snake_case")]
pub enum Layout {
    /// As an AT2 file.
    At2 {
        /// Unit of its accelerations; `None`: the one that its header names, or gravity.
        #[serde(skip_serializing_if = "Option::is_none")]
        unit: Option<Unit>,
    },
    /// As an ASC file, whose header says all.
    Asc,
    /// As a table.
    Csv(TableLayout),
}

/// What is in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    /// Times in s, increasing by at least a microsecond, and accelerations. There are from 2 to 1 800 000, all finite.
    pub samples: Vec<(f64, f64)>,
    /// Unit of the accelerations.
    pub unit: Unit,
}

const STEP_S: Number = Number(Included(MIN_STEP_S), Included(MAX_TIME_S));
pub(super) const COLUMN_NUMBER: Count = Count {
    range: 1..=10_000,
    why: "the first column",
};
const SKIPPED: Count = Count {
    range: 0..=10_000,
    why: "none",
};

/// The keys that only tables have.
const TABLE_KEYS: [&str; 5] = [
    "time_column",
    "dt_s",
    "acceleration_column",
    "skip_rows",
    "decimal",
];

impl Format {
    /// The format that the ending of a file's name tells; the error follows the name.
    pub(in crate::scenario) fn of_ending(file: &str) -> Result<Self, &'static str> {
        let ending = Path::new(file)
            .extension()
            .and_then(OsStr::to_str)
            .unwrap_or_default()
            .to_ascii_lowercase();
        match ending.as_str() {
            "at2" => Ok(Self::At2),
            "asc" => Ok(Self::Asc),
            "csv" | "tsv" | "txt" | "dat" => Ok(Self::Csv),
            _ => Err(
                "has an extension that does not tell the format: give `format` as well, \"at2\", \"asc\" or \"csv\"",
            ),
        }
    }

    /// Whether the ending of a file's name is that of a record.
    #[must_use]
    pub fn is_of_record(file: &Path) -> bool {
        file.to_str()
            .is_some_and(|file| Self::of_ending(file).is_ok())
    }

    pub(in crate::scenario) fn read(table: &mut Table<'_>) -> Reading<Option<Self>> {
        let formats = OneOf {
            all: Self::ALL,
            name: Self::name,
        };
        table.optional("format", &formats)
    }
}

impl Layout {
    /// What is in the bytes of a file.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong with them.
    pub fn parse(&self, bytes: &[u8]) -> Result<Contents, LineFault> {
        // Headers may be in any encoding; the numbers are the same in all of them.
        let text = String::from_utf8_lossy(bytes);
        let text = text.trim_start_matches('\u{feff}');
        match self {
            Self::At2 { unit } => at2::parse(text, *unit),
            Self::Asc => asc::parse(text),
            Self::Csv(layout) => Ok(Contents {
                samples: csv::parse(text, layout)?,
                unit: layout.unit,
            }),
        }
    }

    pub(in crate::scenario) fn read(
        table: &mut Table<'_>,
        format: Reading<Format>,
    ) -> Reading<Self> {
        let dt_s = table.optional("dt_s", &STEP_S);
        let time_column = table.optional("time_column", &AnyColumn);
        let acceleration_column = table.optional("acceleration_column", &AnyColumn);
        let skip_rows = table.or("skip_rows", &SKIPPED, 0);
        let decimals = OneOf {
            all: Decimal::ALL,
            name: Decimal::name,
        };
        let decimal = table.or("decimal", &decimals, Decimal::Point);
        let unit = table.optional("unit", &AnyUnit);
        let format = format?;
        if format != Format::Csv
            && let Some(key) = TABLE_KEYS.into_iter().find(|key| table.gives(key))
        {
            return Err(table.wrong(key, "applies to `format = \"csv\"` only"));
        }
        match format {
            Format::At2 => Ok(Self::At2 { unit: unit? }),
            Format::Asc if table.gives("unit") => Err(table.wrong(
                "unit",
                "does not apply to an ASC file, whose header has UNITS",
            )),
            Format::Asc => Ok(Self::Asc),
            Format::Csv => {
                let unit = match unit? {
                    Some(unit) => Ok(unit),
                    None => table.required("unit", &AnyUnit),
                };
                if table.gives("dt_s") && table.gives("time_column") {
                    let wrong = "cannot be combined with `time_column`; give one of them";
                    return Err(table.wrong("dt_s", wrong));
                }
                let (times, acceleration_column) = match dt_s? {
                    Some(step_s) => (Times::Step(step_s), acceleration_column?.unwrap_or(FIRST)),
                    None => {
                        let times = Times::Column(time_column?.unwrap_or(FIRST));
                        (times, acceleration_column?.unwrap_or(SECOND))
                    }
                };
                Ok(Self::Csv(TableLayout {
                    times,
                    acceleration_column,
                    unit: unit?,
                    skip_rows: skip_rows?,
                    decimal: decimal?,
                }))
            }
        }
    }

    /// Whether a key of `[ground.record]` is of tables only.
    #[must_use]
    pub fn is_of_tables(key: &str) -> bool {
        TABLE_KEYS.contains(&key) || key == "unit"
    }

    /// The format of the file.
    pub(in crate::scenario) const fn format(&self) -> Format {
        match self {
            Self::At2 { .. } => Format::At2,
            Self::Asc => Format::Asc,
            Self::Csv(_) => Format::Csv,
        }
    }
}

const FIRST: TableColumn = TableColumn::Number(1);
const SECOND: TableColumn = TableColumn::Number(2);

/// Name or number of a column.
struct AnyColumn;

impl Rule for AnyColumn {
    type Value = TableColumn;

    fn allowed(&self) -> String {
        format!("the name of a column, or {}", COLUMN_NUMBER.allowed())
    }

    fn read(&self, value: &DeValue<'_>) -> Result<TableColumn, String> {
        match value {
            DeValue::String(name) => Ok(TableColumn::Name(name.to_string())),
            _ => COLUMN_NUMBER.read(value).map(TableColumn::Number),
        }
    }
}

/// Times of samples at even steps, which must not last too long; the error follows what makes them.
pub(super) fn evenly(step_s: f64, accelerations: Vec<f64>) -> Result<Samples, String> {
    // Counts below 2^53 are exact.
    #[expect(clippy::cast_precision_loss, reason = "counts are below 2^53")]
    let time_s = |index: usize| index as f64 * step_s;
    let last_s = time_s(accelerations.len().saturating_sub(1));
    if last_s > MAX_TIME_S {
        return Err(too_long(last_s));
    }
    let samples = accelerations.into_iter().enumerate();
    Ok(samples.map(|(index, a)| (time_s(index), a)).collect())
}

/// Says that a record is too long.
pub(super) fn too_long(last_s: f64) -> String {
    use crate::argument::{plain, short};
    format!(
        "make a record of {} s; at most {} s are allowed",
        plain(last_s),
        short(MAX_TIME_S)
    )
}
