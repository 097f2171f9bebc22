//! Records that a table names by files or patterns of file names, with the keys that describe the files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component as PathPart, Path, PathBuf};

use glob::MatchOptions;

use super::prelude::*;
use super::record::{Format, Layout, Series};

/// The files that keys of a table name, and their format.
pub(super) struct RecordListing {
    files: Vec<ListedFile>,
    layout: Layout,
}

/// A record file.
struct ListedFile {
    /// The key that names the file.
    key: &'static str,
    file: String,
    /// Index of the first list element that names the file.
    element: usize,
    format: Format,
}

impl RecordListing {
    /// Finds the files that match the patterns of the keys, and reads the keys that describe tables. `format` applies to all files; without it
    /// the file extensions determine the formats.
    pub(super) fn read(
        table: &mut Table<'_>,
        keys: &[(&'static str, Vec<String>)],
        format: Option<Format>,
    ) -> Self {
        let keys = keys.iter();
        let files: Vec<_> = keys
            .flat_map(|(key, patterns)| list(table, (key, patterns), format))
            .collect();
        // The keys of tables are needed if and only if one of the files is a table.
        let mut formats = files.iter().map(|listed| listed.format);
        let format = formats.clone().next();
        let format = formats.find(|format| *format == Format::Csv).or(format);
        let layout = Layout::read(table, format);
        Self { files, layout }
    }

    /// Returns the number of files.
    pub(super) const fn len(&self) -> usize {
        self.files.len()
    }

    /// Reads the records. Returns each with the key that names it, sorted by file name within each key. `accept` returns the error of a record
    /// that cannot be used.
    pub(super) fn series(
        self,
        table: &mut Table<'_>,
        accept: impl Fn(&Series) -> Result<(), String>,
    ) -> ReadResult<Vec<(&'static str, Series)>> {
        let layout = self.layout;
        let read = |listed: ListedFile| {
            let ListedFile { key, file, .. } = listed;
            let mut own = layout.clone();
            if listed.format != layout.format {
                own = Layout::new(listed.format);
                (own.quantity, own.remove_mean) = (layout.quantity, layout.remove_mean);
            }
            let series = Series::of_file(table.folder(), file.clone(), own)
                .and_then(|series| accept(&series).map(|()| (key, series)));
            if let Err(wrong) = &series {
                let wrong = format!("names {}, which {wrong}", shown(&file));
                table.wrong_element(key, listed.element, wrong);
            }
            series.ok()
        };
        let records: Vec<_> = self.files.into_iter().filter_map(read).collect();
        table.sound().map(|()| records)
    }
}

/// Returns records as entries of a table: the files of each key, and the keys of their layout.
pub(super) fn written(keys: &[(&str, &[Series])]) -> Map<String, Value> {
    let keys = keys.iter().filter(|(_, records)| !records.is_empty());
    let files = keys.clone().map(|(key, records)| {
        let files = records.iter().map(|series| Value::from(&*series.file));
        ((*key).to_owned(), files.collect())
    });
    let mut layouts = keys.flat_map(|(_, records)| records.iter().map(|series| &series.layout));
    // All CSV tables share the same keys; without CSV tables, AT2 files may share a unit.
    let tables = layouts.clone().find(|layout| layout.format == Format::Csv);
    let telling = tables.or_else(|| layouts.clone().next());
    let mut layout = json!(telling);
    // If formats differ, the file extensions determine them.
    if let Some(layout) = layout.as_object_mut()
        && layouts.any(|layout| Some(layout.format) != telling.map(|layout| layout.format))
    {
        layout.shift_remove("format");
    }
    let layout = layout.as_object().cloned().into_iter().flatten();
    files.chain(layout).collect()
}

/// Returns all files that match the patterns, sorted by name, without duplicates.
fn list(
    table: &mut Table<'_>,
    (key, patterns): (&'static str, &[String]),
    format: Option<Format>,
) -> Vec<ListedFile> {
    let mut found = BTreeMap::new();
    // A file with several names counts once.
    let mut seen = BTreeSet::new();
    for (element, pattern) in patterns.iter().enumerate() {
        let files = find(table.folder(), pattern).map_err(|wrong| {
            table.wrong_element(key, element, wrong);
        });
        for file in files.into_iter().flatten() {
            let path = table.path(&file);
            if seen.insert(path.canonicalize().unwrap_or(path)) {
                found.insert(file, element);
            }
        }
    }
    let listed = found.into_iter().filter_map(|(file, element)| {
        let format = format.map_or_else(|| Format::of_ending(&file), Ok);
        let format = format.map_err(|wrong| {
            let wrong = format!("names {}, which {wrong}", shown(&file));
            table.wrong_element(key, element, wrong)
        });
        Some(ListedFile {
            key,
            format: format.ok()?,
            file,
            element,
        })
    });
    listed.collect()
}

/// Returns the files that match a pattern, relative to the folder. The error is a phrase that follows the pattern.
fn find(folder: &Path, pattern: &str) -> Result<Vec<String>, String> {
    // A name that looks like a pattern is a file if such a file exists: so a resolved scenario reads back the same.
    let path = folder.join(pattern);
    let no_file = |is: &str| format!("{is}; must be a file or a pattern such as \"folder/*.at2\"");
    ensure(!path.is_dir(), || no_file("is a folder"))?;
    if path.is_file() {
        return Ok(vec![file_name(Path::new(pattern))?]);
    }
    let is_pattern = pattern.contains(['*', '?', '[']);
    ensure(is_pattern, || no_file("does not exist"))?;
    let here = folder.as_os_str().is_empty();
    let folder = if here { Path::new(".") } else { folder };
    // `glob` has no base folder, so patterns are made absolute.
    let folder =
        std::path::absolute(folder).map_err(|error| format!("cannot be found: {error}"))?;
    let escaped = folder
        .to_str()
        .map(glob::Pattern::escape)
        .ok_or("is relative to a folder whose name is not UTF-8 text; name the files one by one")?;
    let absolute = Path::new(&escaped).join(pattern);
    let options = MatchOptions {
        // As in a shell, `*` does not match hidden files.
        require_literal_leading_dot: true,
        require_literal_separator: true,
        case_sensitive: true,
    };
    let matches = glob::glob_with(&absolute.to_string_lossy(), options)
        .map_err(|error| format!("is not a valid file pattern: {}", error.msg))?;
    let mut files = Vec::new();
    for path in matches {
        let path = path.map_err(|error| format!("cannot be searched: {}", error.error()))?;
        if path.is_file() {
            files.push(file_name(path.strip_prefix(&folder).unwrap_or(&path))?);
        }
    }
    ensure(!files.is_empty(), || "matches no file")?;
    Ok(files)
}

/// First characters of cells that spreadsheets interpret as formulas. A tab would be another, but it is a control character.
const FORMULA: [char; 4] = ['=', '+', '-', '@'];

/// Returns the name of a file for scenarios and results. The name must fit on one line and in one cell.
fn file_name(path: &Path) -> Result<String, String> {
    let parts = path.components();
    let plain: PathBuf = parts.filter(|part| *part != PathPart::CurDir).collect();
    match plain.to_str() {
        Some(name) if name.starts_with(FORMULA) => Err(format!(
            "names {}, which spreadsheets that open the table of results would take for a formula: give the file a name \
             that does not begin with any of = + - @",
            shown(name)
        )),
        Some(name) if !name.contains(char::is_control) => Ok(name.to_owned()),
        _ => Err(format!(
            "names \"{}\"; file names must be UTF-8 without control characters",
            shown(&plain.display().to_string())
        )),
    }
}
