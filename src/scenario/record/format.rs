//! The format of a file: its key, or else what the file shows.

use std::path::Path;

use archrock_records::{Format, binary_kind, not_plain};

use super::layout;
use crate::scenario::document::is_scenario;
use crate::scenario::error::ScenarioErrors;
use crate::scenario::files::Files;
use crate::scenario::prelude::*;

/// Number of bytes of a header that are searched.
const SEARCHED: usize = 4096;

/// Reads the key `format`.
pub(in crate::scenario) fn read(table: &mut Table<'_>) -> Option<Format> {
    table.optional("format", &one_of(Format::ALL))
}

/// Reads the format; that of the outer table is the default.
pub(in crate::scenario) fn inherit(table: &mut Table<'_>) -> Option<Format> {
    table.inherit(["format"].into_iter());
    read(table)
}

/// Reads the format, or determines it from the file if there is one.
pub(super) fn read_or_ending(table: &mut Table<'_>, file: &str) -> Option<Format> {
    let (format, is_key) = (read(table), table.has_key("file"));
    if format.is_some() || table.has_key("format") || file.is_empty() && !is_key {
        return format;
    }
    let found = find(table.files(), file, layout::has_table_keys(table));
    let report = |wrong| match is_key {
        true => table.reject("file", wrong),
        false => table.fault_of_table(wrong),
    };
    found.map_err(report).ok()
}

/// Returns the format of a file from its contents, or else from its extension. The error is a phrase that follows the name.
///
/// With the keys of tables, files with an extension of tables are tables. The contents of a scenario are ignored, because it may quote a header.
pub(in crate::scenario) fn find(
    files: &Files,
    file: &str,
    has_table_keys: bool,
) -> Result<Format, String> {
    let ending = Format::of_ending(file);
    let by_ending = ending.ok_or_else(|| {
        format!(
            "has an unknown extension: give `format` as well, {}",
            one_of(Format::ALL).allowed()
        )
    });
    let is_table = has_table_keys && ending == Some(Format::CSV);
    if is_table || has_scenario_ending(Path::new(file)) {
        return by_ending;
    }
    let contents = files.read_start(&files.path(file), SEARCHED);
    let contents = contents.unwrap_or_default();
    let kind = binary_kind(&contents).filter(|_| ending.is_none());
    match (Format::of_contents(&contents), kind) {
        (Some(format), _) => Ok(format),
        (None, Some(kind)) => Err(format!("is {kind}")),
        (None, None) => by_ending,
    }
}

/// Returns the error of a file on disk that is neither a scenario nor a record of a known format; `None` for other files.
pub fn unknown_format(file: &Path) -> Option<ScenarioErrors> {
    if format_of_file(file).is_some() || has_scenario_ending(file) {
        return None;
    }
    let bytes = Files::default().read_start(file, SEARCHED).ok()?;
    let start = String::from_utf8_lossy(&bytes);
    let wrong = match not_plain(&bytes) {
        Some(wrong) => wrong,
        None if is_scenario(&start) => return None,
        None => {
            let known = Format::names();
            format!("unknown record format; known: {known}; a table needs `format = \"csv\"`")
        }
    };
    Some(ScenarioErrors::unreadable(
        &file.display().to_string(),
        wrong,
    ))
}

/// Returns the format of a file on disk from its contents, or else from its extension; `None` if they are not those of a record.
pub fn format_of_file(file: &Path) -> Option<Format> {
    find(&Files::default(), file.to_str()?, false).ok()
}

/// Returns true for the usual ending of scenarios.
fn has_scenario_ending(file: &Path) -> bool {
    let ending = file.extension().unwrap_or_default();
    ending.eq_ignore_ascii_case("toml")
}
