//! Layout of a record file: its format, and, for tables, the columns of times and accelerations.

use std::fmt;

use super::correction::{self, Baseline};
use super::history::Finder;
use super::samples::{Contents, MAX_TIME_S, MIN_STEP_S, Parsed};
use super::unit::{RecordedQuantity, Unit, any_unit};
use crate::scenario::prelude::*;

/// A format of record files. Each is a constant in the file of its reader.
#[derive(Clone, Copy)]
pub struct Format {
    /// Name in scenarios.
    pub(super) name: &'static str,
    /// Name of a file of this format in reports.
    pub(super) label: &'static str,
    /// Extensions of file names, in lower case, that determine the format of a file whose contents do not.
    pub(super) extensions: &'static [&'static str],
    /// Returns true if the first lines of a file, at least one, are of this format.
    pub(super) begins: fn(&[&str]) -> bool,
    /// Reader of the files.
    pub(super) parser: Parser,
}

/// Reader of the files of a format.
#[derive(Clone, Copy)]
pub(super) enum Parser {
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

    /// Reads the keys that describe files of these formats. The layout is that of tables if one of them is a table, or else that of the first. The
    /// fault of an unknown format is recorded elsewhere.
    pub(in crate::scenario) fn read(table: &mut Table<'_>, formats: &[Format]) -> Self {
        let mut tables = formats.iter().filter(|format| **format == Format::CSV);
        let format = tables.next().or(formats.first()).copied();
        let step_s = within(&(MIN_STEP_S..=MAX_TIME_S));
        let dt_s = table.optional("dt_s", &step_s);
        let time_column = table.optional("time_column", &numbered_or_named("column"));
        let acceleration_column =
            table.optional("acceleration_column", &numbered_or_named("column"));
        let wrapped = table.or("wrapped", &switch(), false);
        let quantities = one_of(RecordedQuantity::ALL);
        let (baseline, high_pass_hz) = correction::read(table);
        let mut layout = Self {
            acceleration_column,
            wrapped,
            baseline,
            high_pass_hz,
            channel: table.optional("channel", &numbered_or_named("channel")),
            skip_rows: table.or("skip_rows", &SKIPPED, 0),
            end_marker: table.optional("end_marker", &text()),
            decimal: Decimal::read(table),
            unit: table.optional("unit", &any_unit()),
            quantity: table.or("quantity", &quantities, RecordedQuantity::Acceleration),
            ..Self::new(format.unwrap_or_default())
        };
        let (Some(format), quantity) = (format, layout.quantity) else {
            return layout;
        };
        let is_table = format == Format::CSV;
        if let Some(key) = TABLE_KEYS.into_iter().find(|key| table.gives(key)) {
            let _ = table.refuse(!is_table, key, "applies to `format = \"csv\"` only");
        }
        if let Some(unit) = layout.unit.filter(|unit| unit.quantity() != quantity) {
            table.wrong("unit", format!("is {}", unit.other_quantity()));
        }
        let is_blank = |marker: &String| marker.trim_start().len() < marker.len().max(1);
        let wrong =
            "begins with a blank or is empty; must be the beginning of the line after the table";
        let is_wrong = layout.end_marker.as_ref().is_some_and(is_blank);
        let _ = table.refuse(is_wrong, "end_marker", wrong);
        let is_velocity = quantity == RecordedQuantity::Velocity;
        let wrong = "does not apply to a file of K-NET, which holds accelerations";
        let _ = table.refuse(is_velocity && format == Format::KNET, "quantity", wrong);
        if is_velocity {
            correction::refuse(table, (layout.baseline, layout.high_pass_hz));
        }
        let refusal = match format.parser {
            Parser::Record(_, refusal) => refusal,
            _ => Some("does not apply to this format, whose files have their unit"),
        };
        if let Some(refusal) = refusal {
            let _ = table.refuse(table.gives("unit"), "unit", refusal);
        }
        if layout.channel.is_some() && !formats.iter().any(Format::has_channels) {
            let all = Format::ALL.iter().filter(|format| format.has_channels());
            let names: Vec<_> = all.map(|format| format!("{:?}", format.name())).collect();
            let wrong = "applies to formats with several channels only";
            table.wrong("channel", format!("{wrong}: {}", names.join(", ")));
        }
        if is_table {
            let wrong = "cannot be combined with `time_column`; give one of them";
            let _ = table.refuse(dt_s.is_some() && time_column.is_some(), "dt_s", wrong);
            if wrapped && layout.acceleration_column.is_some() {
                let wrong = "cannot be combined with `acceleration_column`; give one of them";
                table.wrong("wrapped", wrong);
            } else if wrapped && !table.gives("dt_s") {
                let wrong = "needs `dt_s`: rows of several samples have no column of times";
                table.wrong("wrapped", wrong);
            }
            let column = time_column.unwrap_or(TableColumn::Number(1));
            layout.times = Some(dt_s.map_or(Times::Column(column), Times::Step));
            layout.unit = Some(table.needed("unit", &any_unit(), layout.unit));
        }
        layout
    }

    /// Takes the keys of the outer table that apply to files of these formats as defaults. Keys of tables, and `unit`, apply if one of the files is
    /// a table, corrections if the samples are accelerations. Keys that the given ones exclude are no defaults.
    pub(in crate::scenario) fn inherit(table: &mut Table<'_>, formats: &[Format]) {
        let has_tables = formats.contains(&Format::CSV);
        let has_channels = formats.iter().any(|format| format.has_channels());
        let is_velocity = table.as_given("quantity") == Some(json!(RecordedQuantity::Velocity));
        let groups = [
            (&TABLE_KEYS[..], has_tables),
            (&["unit"], has_tables),
            (&["channel"], has_channels),
            (&["quantity"], true),
            (&correction::KEYS, !is_velocity),
        ];
        let applying = groups.into_iter().filter(|(_, applies)| *applies);
        let is_excluded = |key: &&str| {
            let mut pairs = EXCLUSIVE.iter().filter(|pair| pair.contains(key));
            pairs.any(|pair| pair.iter().any(|other| other != key && table.gives(other)))
        };
        let keys = applying.flat_map(|(keys, _)| keys.iter().copied());
        let keys: Vec<_> = keys.filter(|key| !is_excluded(key)).collect();
        table.inherit(keys.into_iter());
    }

    /// Returns true if the value of a key describes one of the files, whose formats are `listed`. Files of other formats than that of this layout have
    /// only its quantity, channel and corrections.
    pub(in crate::scenario) fn describes(&self, key: &str, listed: &[Format]) -> bool {
        let mut listed = listed.iter();
        match key {
            "channel" => listed.any(Format::has_channels),
            key if Self::is_of_tables(key) => listed.any(|format| *format == self.format),
            _ => listed.next().is_some(),
        }
    }

    /// Returns the keys that describe files.
    pub(in crate::scenario) fn keys() -> impl Iterator<Item = &'static str> {
        let others = ["format", "unit", "channel", "quantity"];
        TABLE_KEYS.into_iter().chain(others).chain(correction::KEYS)
    }

    /// Returns true if one of the keys for tables only is given.
    pub(in crate::scenario) fn has_table_keys(table: &Table<'_>) -> bool {
        TABLE_KEYS.iter().any(|key| table.gives(key))
    }

    /// Returns true if a key of `[ground.record]` describes tables: the keys for tables only, and `unit`.
    pub fn is_of_tables(key: &str) -> bool {
        TABLE_KEYS.contains(&key) || key == "unit"
    }
}

pub(super) const COLUMN_NUMBER: Count = Count(1..=10_000, "the first column");
const SKIPPED: Count = Count(0..=10_000, "none");

/// Keys for tables only.
const TABLE_KEYS: [&str; 7] = [
    "time_column",
    "dt_s",
    "acceleration_column",
    "wrapped",
    "skip_rows",
    "end_marker",
    "decimal",
];

/// Pairs of keys that exclude each other: if an entry gives one, the other has no default.
const EXCLUSIVE: [[&str; 2]; 4] = [
    ["time_column", "dt_s"],
    ["time_column", "wrapped"],
    ["acceleration_column", "wrapped"],
    ["baseline", "remove_mean"],
];

impl Decimal {
    pub(in crate::scenario) fn is_point(&self) -> bool {
        *self == Self::Point
    }

    /// Reads the key `decimal`.
    pub(in crate::scenario) fn read(table: &mut Table<'_>) -> Self {
        table.or("decimal", &one_of(Self::ALL), Self::Point)
    }
}

/// Returns the rule for the name or number of a column or channel.
fn numbered_or_named(what: &str) -> Custom<'static, TableColumn> {
    let allowed = format!("the name of a {what}, or {}", COLUMN_NUMBER.allowed());
    let read = |value: &Value| match string(value) {
        Some(name) => Ok(TableColumn::Name(name.to_owned())),
        None => COLUMN_NUMBER.read(value).map(TableColumn::Number),
    };
    let schema = json!({ "anyOf": [{ "type": "string" }, COLUMN_NUMBER.schema()] });
    Custom(allowed, schema, Box::new(read))
}
