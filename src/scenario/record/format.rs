//! The list of all formats of record files, and the format of a file.

use std::ffi::OsStr;
use std::path::Path;

use super::layout::{Format, Layout, Parser};
use crate::scenario::document::is_scenario;
use crate::scenario::error::ScenarioErrors;
use crate::scenario::files::Files;
use crate::scenario::plain_text::{binary_kind, not_plain};
use crate::scenario::prelude::*;

/// Number of bytes of a header that are searched.
const SEARCHED: usize = 4096;

impl Format {
    /// All formats, in the order of messages. If the first lines of a file fit several formats, the last of them is chosen: files of USC and GeoNet may
    /// begin like those of CSMIP.
    pub const ALL: &[Self] = &[
        Self::AT2,
        Self::ASC,
        Self::KNET,
        Self::SMC,
        Self::CSMIP,
        Self::USC,
        Self::BHRC,
        Self::COSMOS,
        Self::GEONET,
        Self::AFAD,
        Self::CWB,
        Self::CSMNC,
        Self::UNAM,
        Self::CSV,
    ];

    /// Returns the name in scenarios.
    pub const fn name(self) -> &'static str {
        self.name
    }

    /// Returns the name of a file of this format in reports.
    pub(crate) const fn label(self) -> &'static str {
        self.label
    }

    /// Returns the names of all formats, separated by commas.
    pub fn names() -> String {
        Self::ALL
            .iter()
            .map(|format| format.name)
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// Returns true if a file of this format may have several channels.
    pub(in crate::scenario) const fn has_channels(&self) -> bool {
        matches!(self.parser, Parser::Channels(_))
    }

    /// Returns the format of a file name from its extension. The error is a phrase that follows the name.
    pub(in crate::scenario) fn of_ending(file: &str) -> Result<Self, String> {
        let ending = Path::new(file).extension().and_then(OsStr::to_str);
        let ending = ending.unwrap_or_default().to_ascii_lowercase();
        let mut formats = Self::ALL.iter();
        let found = formats.find(|format| format.extensions.contains(&&*ending));
        found.copied().ok_or_else(|| {
            format!(
                "has an unknown extension: give `format` as well, {}",
                one_of(Self::ALL).allowed()
            )
        })
    }

    /// Reads the key `format`.
    pub(in crate::scenario) fn read(table: &mut Table<'_>) -> Option<Self> {
        table.optional("format", &one_of(Self::ALL))
    }

    /// Reads the format; that of the outer table is the default.
    pub(in crate::scenario) fn inherit(table: &mut Table<'_>) -> Option<Self> {
        table.inherit(["format"].into_iter());
        Self::read(table)
    }

    /// Reads the format, or determines it from the file if there is one.
    pub(super) fn read_or_ending(table: &mut Table<'_>, file: &str) -> Option<Self> {
        let (format, is_key) = (Self::read(table), table.gives("file"));
        if format.is_some() || table.gives("format") || file.is_empty() && !is_key {
            return format;
        }
        let found = Self::find(table.files(), file, Layout::has_table_keys(table));
        let report = |wrong| match is_key {
            true => table.wrong("file", wrong),
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
    ) -> Result<Self, String> {
        let by_ending = Self::of_ending(file);
        let is_table = has_table_keys && by_ending == Ok(Self::CSV);
        if is_table || has_scenario_ending(Path::new(file)) {
            return by_ending;
        }
        let contents = files.read_start(&files.path(file), SEARCHED);
        let contents = contents.unwrap_or_default();
        let kind = binary_kind(&contents).filter(|_| by_ending.is_err());
        match (Self::of_contents(&contents), kind) {
            (Some(format), _) => Ok(format),
            (None, Some(kind)) => Err(format!("is {kind}")),
            (None, None) => by_ending,
        }
    }

    /// Returns the error of a file on disk that is neither a scenario nor a record of a known format; `None` for other files.
    pub fn unknown(file: &Path) -> Option<ScenarioErrors> {
        if Self::of_file(file).is_some() || has_scenario_ending(file) {
            return None;
        }
        let bytes = Files::default().read_start(file, SEARCHED).ok()?;
        let start = String::from_utf8_lossy(&bytes);
        let wrong = match not_plain(&bytes) {
            Some(wrong) => wrong,
            None if is_scenario(&start) => return None,
            None => {
                let known = Self::names();
                format!("unknown record format; known: {known}; a table needs `format = \"csv\"`")
            }
        };
        Some(ScenarioErrors::unreadable(
            &file.display().to_string(),
            wrong,
        ))
    }

    /// Returns the format of a file on disk from its contents, or else from its extension; `None` if they are not those of a record.
    pub fn of_file(file: &Path) -> Option<Self> {
        Self::find(&Files::default(), file.to_str()?, false).ok()
    }

    /// Returns the format that the first bytes of a file show; `None` for tables and other files.
    pub fn of_contents(bytes: &[u8]) -> Option<Self> {
        let text = String::from_utf8_lossy(bytes);
        let lines: Vec<&str> = text.trim_start_matches('\u{feff}').lines().collect();
        lines.first()?;
        let mut formats = Self::ALL.iter().rev();
        formats.find(|format| (format.begins)(&lines)).copied()
    }
}

/// Returns true for the usual ending of scenarios.
fn has_scenario_ending(file: &Path) -> bool {
    let ending = file.extension().unwrap_or_default();
    ending.eq_ignore_ascii_case("toml")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Only CSMIP fits files of other formats, which are after it in the list.
    #[test]
    fn the_first_lines_of_a_file_fit_one_format() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/scenario/formats");
        for file in std::fs::read_dir(folder).unwrap() {
            let path = file.unwrap().path();
            let text = std::fs::read_to_string(&path).unwrap();
            let lines: Vec<&str> = text.lines().collect();
            let mut fitting: Vec<_> = Format::ALL.to_vec();
            fitting.retain(|format| (format.begins)(&lines));
            assert!(
                fitting.len() == 1 || fitting.len() == 2 && fitting[0] == Format::CSMIP,
                "{path:?} {fitting:?}"
            );
        }
    }
}
