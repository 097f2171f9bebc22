//! The keys of a layout.

use archrock_records::{
    Baseline, Decimal, Format, Layout, MAX_TIME_S, MIN_STEP_S, RecordedQuantity, TableColumn,
    Times, Unit,
};

use crate::scenario::prelude::*;

/// Reads the keys that describe files of these formats. The layout is that of tables if one of them is a table, or else that of the first. The
/// fault of an unknown format is recorded elsewhere.
pub(in crate::scenario) fn read(table: &mut Table<'_>, formats: &[Format]) -> Layout {
    let mut tables = formats.iter().filter(|format| **format == Format::CSV);
    let format = tables.next().or(formats.first()).copied();
    let step_s = within(&(MIN_STEP_S..=MAX_TIME_S));
    let dt_s = table.optional("dt_s", &step_s);
    let time_column = table.optional("time_column", &numbered_or_named("column"));
    let acceleration_column = table.optional("acceleration_column", &numbered_or_named("column"));
    let wrapped = table.or("wrapped", &switch(), false);
    let quantities = one_of(RecordedQuantity::ALL);
    let (baseline, high_pass_hz) = read_corrections(table);
    let mut layout = Layout {
        acceleration_column,
        wrapped,
        baseline,
        high_pass_hz,
        channel: table.optional("channel", &numbered_or_named("channel")),
        skip_rows: table.or("skip_rows", &SKIPPED, 0),
        end_marker: table.optional("end_marker", &text()),
        decimal: decimal(table),
        unit: table.optional("unit", &any_unit()),
        quantity: table.or("quantity", &quantities, RecordedQuantity::Acceleration),
        ..Layout::new(format.unwrap_or_default())
    };
    let (Some(format), quantity) = (format, layout.quantity) else {
        return layout;
    };
    let is_table = format == Format::CSV;
    if let Some(key) = TABLE_KEYS.into_iter().find(|key| table.has_key(key)) {
        let _ = table.refuse(!is_table, key, "applies to `format = \"csv\"` only");
    }
    if let Some(unit) = layout.unit.filter(|unit| unit.quantity() != quantity) {
        table.reject("unit", format!("is {}", unit.other_quantity()));
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
        refuse_corrections(table, (layout.baseline, layout.high_pass_hz));
    }
    if let Some(refusal) = format.unit_refusal() {
        let _ = table.refuse(table.has_key("unit"), "unit", refusal);
    }
    if layout.channel.is_some() && !formats.iter().any(Format::has_channels) {
        let all = Format::ALL.iter().filter(|format| format.has_channels());
        let names: Vec<_> = all.map(|format| format!("{:?}", format.name())).collect();
        let wrong = "applies to formats with several channels only";
        table.reject("channel", format!("{wrong}: {}", names.join(", ")));
    }
    if is_table {
        let wrong = "cannot be combined with `time_column`; give one of them";
        let _ = table.refuse(dt_s.is_some() && time_column.is_some(), "dt_s", wrong);
        if wrapped && layout.acceleration_column.is_some() {
            let wrong = "cannot be combined with `acceleration_column`; give one of them";
            table.reject("wrapped", wrong);
        } else if wrapped && !table.has_key("dt_s") {
            let wrong = "needs `dt_s`: rows of several samples have no column of times";
            table.reject("wrapped", wrong);
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
    let has_channels = formats.iter().any(Format::has_channels);
    let is_velocity = table.as_given("quantity") == Some(json!(RecordedQuantity::Velocity));
    let groups = [
        (&TABLE_KEYS[..], has_tables),
        (&["unit"], has_tables),
        (&["channel"], has_channels),
        (&["quantity"], true),
        (&CORRECTION_KEYS, !is_velocity),
    ];
    let applying = groups.into_iter().filter(|(_, applies)| *applies);
    let is_excluded = |key: &&str| {
        let mut pairs = EXCLUSIVE.iter().filter(|pair| pair.contains(key));
        pairs.any(|pair| {
            pair.iter()
                .any(|other| other != key && table.has_key(other))
        })
    };
    let keys = applying.flat_map(|(keys, _)| keys.iter().copied());
    let keys: Vec<_> = keys.filter(|key| !is_excluded(key)).collect();
    table.inherit(keys.into_iter());
}

/// Returns true if the value of a key of this layout describes one of the files, whose formats are `listed`. Files of other formats than that of the
/// layout have only its quantity, channel and corrections.
pub(in crate::scenario) fn describes(layout: &Layout, key: &str, listed: &[Format]) -> bool {
    let mut listed = listed.iter();
    match key {
        "channel" => listed.any(Format::has_channels),
        key if describes_tables(key) => listed.any(|format| *format == layout.format),
        _ => listed.next().is_some(),
    }
}

/// Returns the keys that describe files.
pub(in crate::scenario) fn keys() -> impl Iterator<Item = &'static str> {
    let others = ["format", "unit", "channel", "quantity"];
    TABLE_KEYS.into_iter().chain(others).chain(CORRECTION_KEYS)
}

/// Returns true if one of the keys for tables only is given.
pub(in crate::scenario) fn has_table_keys(table: &Table<'_>) -> bool {
    TABLE_KEYS.iter().any(|key| table.has_key(key))
}

/// Returns true if a key of `[ground.record]` describes tables: the keys for tables only, and `unit`.
pub fn describes_tables(key: &str) -> bool {
    TABLE_KEYS.contains(&key) || key == "unit"
}

const COLUMN_NUMBER: Count = Count(1..=10_000, "the first column");
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

/// Reads the key `decimal`.
pub(in crate::scenario) fn decimal(table: &mut Table<'_>) -> Decimal {
    table.or("decimal", &one_of(Decimal::ALL), Decimal::Point)
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

/// Returns the rule for a unit, by its name or a spelling in files.
fn any_unit() -> Custom<'static, Unit> {
    let names = one_of(Unit::ALL);
    let allowed = format!("{} or \"gal\"", names.allowed());
    let read = move |value: &Value| {
        let written = value.as_str().and_then(Unit::written);
        written.map_or_else(|| names.read(value), Ok)
    };
    let schema = json!({ "type": "string", "examples": Unit::ALL });
    Custom(allowed, schema, Box::new(read))
}

/// Keys of the baseline and of the filter, and an older key of the mean.
const CORRECTION_KEYS: [&str; 3] = [BASELINE, FILTER, REMOVE_MEAN];
const BASELINE: &str = "baseline";
const FILTER: &str = "high_pass_hz";
const REMOVE_MEAN: &str = "remove_mean";

/// Range of the corner of the filter, in Hz.
const HIGH_PASS_HZ: Number = within(&(1e-3..=100.0));

/// Baseline and corner of the high-pass filter, in Hz.
type Corrections = (Option<Baseline>, Option<f64>);

/// Reads the keys of the corrections.
fn read_corrections(table: &mut Table<'_>) -> Corrections {
    let baseline = table.optional(BASELINE, &one_of(Baseline::ALL));
    let corner_hz = table.optional(FILTER, &HIGH_PASS_HZ);
    let mean = table.or(REMOVE_MEAN, &switch(), false);
    let newer = "`baseline = \"mean\"` is the newer name of `remove_mean = true`";
    let _ = table.apply_relations(&[AtMostOne(&[BASELINE, REMOVE_MEAN], newer)]);
    (baseline.or(mean.then_some(Baseline::Mean)), corner_hz)
}

/// Records a fault for each correction of a record of velocities.
fn refuse_corrections(table: &mut Table<'_>, (baseline, corner_hz): Corrections) {
    let wrong = "applies to accelerations: a uniform velocity shakes nothing; leave it out";
    let given = match table.has_key(BASELINE) {
        true => BASELINE,
        false => REMOVE_MEAN,
    };
    let _ = table.refuse(baseline.is_some(), given, wrong);
    let wrong = "applies to accelerations: filter the velocities before, or leave it out";
    let _ = table.refuse(corner_hz.is_some(), FILTER, wrong);
}
