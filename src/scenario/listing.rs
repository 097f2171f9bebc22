//! Records that a table names by files or patterns of file names, with the keys that describe the files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use super::prelude::*;
use super::record::{Format, Layout, Series, format, layout};

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
    /// Finds the files that match the patterns of the keys, except files of `others`, and reads the keys that describe them. These keys may be meant
    /// for `others` only, as defaults. `format` applies to all files; without it the contents or the extensions of the files determine the formats.
    pub(super) fn read(
        table: &mut Table<'_>,
        keys: &[(&'static str, Vec<String>)],
        format: Option<Format>,
        others: &[Series],
    ) -> Self {
        let identity = |file: &str| table.files().identity(table.files().path(file));
        let seen: BTreeSet<_> = others.iter().map(|other| identity(&other.file)).collect();
        let keys = keys.iter();
        let files: Vec<_> = keys
            .flat_map(|(key, patterns)| list_files(table, (key, patterns), format, seen.clone()))
            .collect();
        let mut formats = formats(&files);
        let has_tables = formats.contains(&Format::CSV);
        formats.extend(others.iter().map(|other| other.layout.format));
        if !has_tables && formats.contains(&Format::CSV) {
            // Each of the other tables has its required keys, here or in its entry.
            formats.clear();
        }
        let layout = layout::read(table, &formats);
        Self { files, layout }
    }

    /// Finds the files that the key `file` of an entry matches, and reads the keys that describe them. Keys of the outer table are defaults, if
    /// they apply to such files.
    pub(super) fn of_entry(table: &mut Table<'_>) -> Self {
        let pattern = table.read_required(FILE, &text());
        let format = format::inherit(table);
        let given = Some(pattern).filter(|pattern| !pattern.is_empty() || table.has_key(FILE));
        let patterns: Vec<_> = given.into_iter().collect();
        let files = list_files(table, (FILE, &patterns), format, BTreeSet::new());
        let formats = formats(&files);
        layout::inherit(table, &formats);
        let layout = layout::read(table, &formats);
        Self { files, layout }
    }

    /// Records a fault of each given key that describes neither a listed file nor an entry, which takes it as a default.
    pub(super) fn refuse_without_effect(&self, table: &mut Table<'_>) -> ReadResult<()> {
        let formats = formats(&self.files);
        let describes =
            |key| layout::describes(&self.layout, key, &formats) || table.is_default(key);
        let given = layout::keys().filter(|key| table.has_key(key));
        let vain: Vec<_> = given.filter(|key| !describes(key)).collect();
        for key in vain {
            let wrong = "has no effect: each entry [[suite.record]] gives its own value or cannot use it; leave it out";
            table.reject(key, wrong);
        }
        table.check_faultless()
    }

    /// Number of files.
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
                own.quantity = layout.quantity;
                (own.baseline, own.high_pass_hz) = (layout.baseline, layout.high_pass_hz);
            }
            let channel = layout.channel.clone();
            own.channel = channel.filter(|_| listed.format.has_channels());
            let series = Series::of_file(table.files(), file.clone(), own)
                .and_then(|series| accept(&series).map(|()| (key, series)));
            if let Err(wrong) = &series {
                let wrong = format!("names {}, which {wrong}", shown(&file));
                table.reject_element(key, listed.element, wrong);
            }
            series.ok()
        };
        let records: Vec<_> = self.files.into_iter().filter_map(read).collect();
        table.check_faultless().map(|()| records)
    }
}

/// The key of the file of an entry.
const FILE: &str = "file";

/// Records as entries of a table: the files of each key, and the keys of their layout.
pub(super) fn table_entries(keys: &[(&str, &[Series])]) -> Map<String, Value> {
    let keys = keys.iter().filter(|(_, records)| !records.is_empty());
    let files = keys.clone().map(|(key, records)| {
        let files = records.iter().map(|series| Value::from(&*series.file));
        ((*key).to_owned(), files.collect())
    });
    let mut layouts = keys.flat_map(|(_, records)| records.iter().map(|series| &series.layout));
    // All CSV tables share the same keys; without CSV tables, AT2 files may share a unit.
    let tables = layouts.clone().find(|layout| layout.format == Format::CSV);
    let layout_source = tables.or_else(|| layouts.clone().next());
    let layout = json!(layout_source);
    let mut keys = layout.as_object().cloned().unwrap_or_default();
    if let Some(channel) = layouts.clone().find_map(|layout| layout.channel.as_ref()) {
        keys.insert("channel".to_owned(), json!(channel));
    }
    // If formats differ, the files determine them.
    if layouts.any(|layout| Some(layout.format) != layout_source.map(|layout| layout.format)) {
        keys.shift_remove("format");
    }
    files.chain(keys).collect()
}

/// Formats of files: the keys of tables are needed if and only if one of them is a table.
fn formats(files: &[ListedFile]) -> Vec<Format> {
    files.iter().map(|listed| listed.format).collect()
}

/// All files that match the patterns, sorted by name, without duplicates. Paths in `seen` are left out.
fn list_files(
    table: &mut Table<'_>,
    (key, patterns): (&'static str, &[String]),
    format: Option<Format>,
    mut seen: BTreeSet<PathBuf>,
) -> Vec<ListedFile> {
    // A file with several names counts once.
    let mut found = BTreeMap::new();
    for (element, pattern) in patterns.iter().enumerate() {
        let files = table.files().find(pattern).map_err(|wrong| {
            table.reject_element(key, element, wrong);
        });
        for file in files.into_iter().flatten() {
            let path = table.files().path(&file);
            if seen.insert(table.files().identity(path)) {
                found.insert(file, element);
            }
        }
    }
    let listed = found.into_iter().filter_map(|(file, element)| {
        let found = || format::find(table.files(), &file, layout::has_table_keys(table));
        let format = format.map_or_else(found, Ok);
        let format = format.map_err(|wrong| {
            let wrong = format!("names {}, which {wrong}", shown(&file));
            table.reject_element(key, element, wrong)
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
