//! Files of results: tables as CSV, summaries as JSON. Files are written completely or not at all.
//!
//! Numbers are written with the shortest digits that read back as the same `f64`.

pub(crate) mod caption;
pub(crate) mod columns;
pub(crate) mod elevation;
mod folder;
pub(crate) mod ground;
mod manifest;
pub(crate) mod mechanisms;
pub(crate) mod page;
pub(crate) mod panels;
pub(crate) mod point;
pub(crate) mod record;
pub(crate) mod scene;
pub(crate) mod summary;
pub(crate) mod table;
pub(crate) mod template;

use std::io;
use std::path::PathBuf;

pub(crate) use archrock_draw::{
    Anchor, Axes, BELOW_PX, COLUMNS, CURVES, Chart, Drawing, Envelope, Frame, Key, LEFT_PX, Mark,
    Panels, PartHeight, Reel, Scale, Shape, Sheet, Sign, Stroke, Symbol, TEXT_PX, Text, Thinned,
    color, escaped, scale_around,
};
pub use archrock_draw::{
    Background, Figure, FilmFormat, Height, PictureFormat, PrintError, text_px,
};
use archrock_text::shown_lines;
pub use elevation::draw as draw_elevation;
pub(crate) use folder::NewFile;
pub use folder::{Folder, UnpublishedFiles, check_named_file, write_named_file};
pub use manifest::{Manifest, Origin};
pub(crate) use panels::{HistoryPanels, StateHistory};
pub use panels::{Panel, Subject};
pub use point::StructurePoint;
pub use record::draw as draw_record;
pub(crate) use scene::Piece;
pub use scene::Scene;
use serde_json::Value;
pub(crate) use summary::{Named, summary_of};
pub(crate) use table::{
    Cell, Column, Table, TableWriter, column, each, fields, list, numbers, row_number, several,
};
pub(crate) use template::{filters, render, render_in};
use thiserror::Error;

/// Errors of writing results.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The system reported an error.
    #[error("{what}: {}", in_words(source))]
    Io {
        /// The failed action, with the path.
        what: String,
        /// The error of the system.
        source: io::Error,
    },
    /// The system does not let the program write to the folder for the results.
    #[error("{what}: {}", in_words(source))]
    Unusable {
        /// The failed action, with the path.
        what: String,
        /// The error of the system.
        source: io::Error,
    },
    /// The folder is named after a scenario file, and has the results of another one.
    #[error("{} holds the results of {}", .0.display(), .1)]
    OfOtherScenario(PathBuf, String),
    /// Another run is writing to the folder, or another program has locked it.
    #[error("the folder {} is being written to by another run, or a program such as `flock` has locked it", .0.display())]
    InUse(PathBuf),
    /// A result would replace an input of the scenario.
    #[error("{} is an input of the scenario or a part to be merged, and a result has its name", .0.display())]
    IsInput(PathBuf),
    /// A result would replace a file that the command has not written.
    #[error("{} is there, and archrock.json does not list it as a result of `archrock {command}`", path.display())]
    Taken {
        /// Path of the file.
        path: PathBuf,
        /// The command.
        command: String,
    },
    /// The place of an earlier result has something else than a file, such as a folder or a link.
    #[error("{} is not a file, but archrock.json lists a result of this name", .0.display())]
    NoFile(PathBuf),
    /// A folder inside the one for the results is a link, which may lead anywhere.
    #[error("{} is a link, and no result is written through it", .0.display())]
    IsLink(PathBuf),
    /// Complete results could not get their names, for this reason.
    #[error("{0}; {1}")]
    Unpublished(Box<OutputError>, UnpublishedFiles),
    /// A file with the name of a manifest is none.
    #[error("{} does not list results of this program", .0.display())]
    NoManifest(PathBuf),
    /// There is no folder for a file that the user named.
    #[error("cannot write {}: there is no folder {}", .0.display(), .1.display())]
    NoFolder(PathBuf, PathBuf),
    /// A file that the user named is there and was not written by this program.
    #[error("{} is there, and archrock did not write it", .0.display())]
    NotWrittenHere(PathBuf),
    /// The result with this column or key is not a finite number. This is a bug in the program; nothing is written.
    #[error("the result {0} is not a finite number: please report the scenario")]
    NotFinite(String),
}

impl OutputError {
    /// Returns true if the reader of a pipe has closed it, which is not a failure.
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Io { source, .. } if source.kind() == io::ErrorKind::BrokenPipe)
    }

    pub(crate) fn io(what: impl Into<String>) -> impl FnOnce(io::Error) -> Self {
        let what = what.into();
        |source| Self::Io { what, source }
    }

    fn unusable(what: String) -> impl FnOnce(io::Error) -> Self {
        |source| match is_too_many_files(&source) {
            // Another folder would not help.
            true => Self::Io { what, source },
            false => Self::Unusable { what, source },
        }
    }

    fn csv(what: impl Into<String>) -> impl FnOnce(csv::Error) -> Self {
        let failed = Self::io(what);
        |error| {
            let message = error.to_string();
            failed(match error.into_kind() {
                csv::ErrorKind::Io(source) => source,
                _ => io::Error::other(message),
            })
        }
    }
}

/// Returns an error of the system in words, with a remedy for the errors that do not name the exhausted resource.
fn in_words(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::StorageFull => {
            format!("{error}: free some, or inodes if space is left (`df -i`)")
        }
        _ if is_too_many_files(error) => format!("{error}: allow more with `ulimit -n`"),
        _ => error.to_string(),
    }
}

/// Returns true if the program or the system has too many open files.
fn is_too_many_files(error: &io::Error) -> bool {
    // ENFILE and EMFILE, which have no `ErrorKind`.
    cfg!(unix) && matches!(error.raw_os_error(), Some(23 | 24))
}

/// Formats JSON for people: indented, with invisible characters escaped.
pub fn pretty(value: &Value) -> String {
    shown_lines(&format!("{value:#}\n"))
}

/// Formats the two ends of a range with this number of decimals, or with as many as needed to distinguish them.
pub(crate) fn range_ends([from, to]: [f64; 2], decimals: usize) -> [String; 2] {
    // Enough decimals for any two different numbers of this program.
    const MOST: usize = 15;
    let with = |decimals: usize| [from, to].map(|end| format!("{end:.decimals$}"));
    (decimals..MOST)
        .map(with)
        .find(|[low, high]| low != high || from == to)
        .unwrap_or_else(|| with(MOST))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_a_range_can_be_distinguished() {
        for (ends, printed) in [
            ([0.98791, 1.2], ["0.988", "1.200"]),
            ([0.98791, 0.98794], ["0.98791", "0.98794"]),
            ([1e-8, 2e-8], ["0.00000001", "0.00000002"]),
            ([0.5, 0.5], ["0.500", "0.500"]),
        ] {
            assert_eq!(range_ends(ends, 3), printed);
        }
        // The search for decimals ends at neighbouring numbers.
        let _ = range_ends([1.0, 1.0 + f64::EPSILON], 3);
    }
}
