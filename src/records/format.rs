//! The list of all formats of record files, and the format of a file.

use std::ffi::OsStr;
use std::path::Path;

use crate::layout::{Format, Parser};

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
    pub const fn label(self) -> &'static str {
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
    pub const fn has_channels(&self) -> bool {
        matches!(self.parser, Parser::Channels(_))
    }

    /// Returns the reason why the unit of a layout does not apply to files of this format, as a phrase; `None` if it applies.
    pub const fn unit_refusal(self) -> Option<&'static str> {
        match self.parser {
            Parser::Record(_, refusal) => refusal,
            _ => Some("does not apply to this format, whose files have their unit"),
        }
    }

    /// Returns the format of a file name from its extension; `None` if the extension is unknown.
    pub fn of_ending(file: &str) -> Option<Self> {
        let ending = Path::new(file).extension().and_then(OsStr::to_str);
        let ending = ending.unwrap_or_default().to_ascii_lowercase();
        let mut formats = Self::ALL.iter();
        let found = formats.find(|format| format.extensions.contains(&&*ending));
        found.copied()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Only CSMIP fits files of other formats, which are after it in the list.
    #[test]
    fn the_first_lines_of_a_file_fit_one_format() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/scenario/formats");
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
