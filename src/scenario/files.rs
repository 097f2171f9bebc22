//! The files that a scenario names, in a folder or in memory.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use archrock_text::{ensure, shown};
use glob::{MatchOptions, Pattern, PatternError};

/// The place of the files of a scenario.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Files {
    /// The folder to which names are relative; empty for files in memory.
    pub(super) folder: PathBuf,
    /// The contents of the files by name; `None` if they are on disk.
    pub(super) in_memory: Option<Arc<BTreeMap<PathBuf, FileContents>>>,
}

/// The contents of a file in memory.
#[derive(Clone, Debug, PartialEq)]
pub enum FileContents {
    /// The bytes of the file.
    Bytes(Vec<u8>),
    /// Times in s, and accelerations or velocities in the unit that the scenario gives: a record that is checked, but not written and parsed.
    Samples(Vec<(f64, f64)>),
}

impl From<Vec<u8>> for FileContents {
    fn from(bytes: Vec<u8>) -> Self {
        Self::Bytes(bytes)
    }
}

/// Equal contents have equal bits, also those of samples that are no numbers.
impl Eq for FileContents {}

impl FileContents {
    /// Bytes of the file: of samples, a table with a column of times and one of values, whose numbers have all digits.
    pub fn bytes(&self) -> Cow<'_, [u8]> {
        match self {
            Self::Bytes(bytes) => bytes.into(),
            Self::Samples(samples) => {
                let rows = samples
                    .iter()
                    .map(|(time_s, value)| format!("{time_s:?},{value:?}\n"));
                rows.collect::<String>().into_bytes().into()
            }
        }
    }
}

impl Files {
    /// Path of a file.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        match self.in_memory {
            Some(_) => without_current_folders(Path::new(name)),
            None => self.folder.join(name),
        }
    }

    /// Reads the contents of a file of at most 64 MiB. The error is a phrase that follows the name.
    pub(super) fn read(&self, path: &Path) -> Result<Vec<u8>, String> {
        read_at_most(self.open(path)?, 64, "record")
    }

    /// Reads up to this number of bytes from the start of a file. The error is a phrase that follows the name.
    pub(super) fn read_start(&self, path: &Path, bytes: usize) -> Result<Vec<u8>, String> {
        let mut start = Vec::new();
        let read = self.open(path)?.take(bytes as u64).read_to_end(&mut start);
        read.map(|_| start).map_err(describe_error)
    }

    /// Samples that a program has given in place of a file.
    pub(super) fn samples(&self, path: &Path) -> Option<&[(f64, f64)]> {
        match self.in_memory.as_ref()?.get(path)? {
            FileContents::Bytes(_) => None,
            FileContents::Samples(samples) => Some(samples),
        }
    }

    fn open(&self, path: &Path) -> Result<Box<dyn Read + '_>, String> {
        if let Some(in_memory) = &self.in_memory {
            let contents = in_memory.get(path).ok_or("is not among the given files")?;
            return Ok(Box::new(io::Cursor::new(contents.bytes())));
        }
        let is_file = fs::metadata(path).map_err(describe_error)?.is_file();
        ensure(is_file, || "is not a file")?;
        Ok(Box::new(fs::File::open(path).map_err(describe_error)?))
    }

    /// One path of a file that may have several.
    pub(super) fn identity(&self, path: PathBuf) -> PathBuf {
        match self.in_memory {
            Some(_) => path,
            None => path.canonicalize().unwrap_or(path),
        }
    }

    /// True if there is a file with this path.
    fn has_file(&self, path: &Path) -> bool {
        match &self.in_memory {
            Some(in_memory) => in_memory.contains_key(path),
            None => path.is_file(),
        }
    }

    /// Files that match a pattern, relative to the folder. The error is a phrase that follows the pattern.
    pub(super) fn find(&self, pattern: &str) -> Result<Vec<String>, String> {
        // A name that looks like a pattern is a file if such a file exists: so a resolved scenario reads back the same.
        let path = self.path(pattern);
        let no_file =
            |is: &str| format!("{is}; must be a file or a pattern such as \"folder/*.at2\"");
        let is_folder = self.in_memory.is_none() && path.is_dir();
        ensure(!is_folder, || no_file("is a folder"))?;
        if self.has_file(&path) {
            return Ok(vec![file_name(Path::new(pattern))?]);
        }
        let is_pattern = pattern.contains(['*', '?', '[']);
        ensure(is_pattern, || no_file("does not exist"))?;
        let options = MatchOptions {
            // As in a shell, `*` does not match hidden files.
            require_literal_leading_dot: true,
            require_literal_separator: true,
            case_sensitive: true,
        };
        let invalid = |error: PatternError| format!("is not a valid file pattern: {}", error.msg);
        let mut files = Vec::new();
        if let Some(in_memory) = &self.in_memory {
            let pattern = Pattern::new(pattern).map_err(invalid)?;
            let names = in_memory
                .keys()
                .map(Path::new)
                .filter(|name| pattern.matches_path_with(name, options));
            files = names.map(file_name).collect::<Result<_, _>>()?;
            ensure(!files.is_empty(), || "matches no file")?;
            return Ok(files);
        }
        let here = self.folder.as_os_str().is_empty();
        let folder = if here { Path::new(".") } else { &*self.folder };
        // `glob` has no base folder, so patterns are made absolute.
        let folder =
            std::path::absolute(folder).map_err(|error| format!("cannot be found: {error}"))?;
        let escaped = folder.to_str().map(Pattern::escape).ok_or(
            "is relative to a folder whose name is not UTF-8 text; name the files one by one",
        )?;
        let absolute = Path::new(&escaped).join(pattern);
        let matches = glob::glob_with(&absolute.to_string_lossy(), options).map_err(invalid)?;
        for path in matches {
            let path = path.map_err(|error| format!("cannot be searched: {}", error.error()))?;
            if path.is_file() {
                files.push(file_name(path.strip_prefix(&folder).unwrap_or(&path))?);
            }
        }
        ensure(!files.is_empty(), || "matches no file")?;
        Ok(files)
    }
}

fn describe_error(error: io::Error) -> String {
    format!("cannot be read: {error}")
}

/// Reads the bytes of a file of at most `mib` MiB.
pub(super) fn read_at_most(reader: impl Read, mib: u64, what: &str) -> Result<Vec<u8>, String> {
    let (most, mut bytes) = (mib << 20, Vec::new());
    // The limit applies while reading, because not every file has a known size.
    let read = reader.take(most + 1).read_to_end(&mut bytes);
    read.map_err(describe_error)?;
    ensure(bytes.len() as u64 <= most, || {
        format!("is larger than {mib} MiB, too large for a {what}")
    })?;
    Ok(bytes)
}

/// First characters of cells that spreadsheets interpret as formulas. A tab would be another, but it is a control character.
const FORMULA: [char; 4] = ['=', '+', '-', '@'];

/// Path without the parts `.`.
pub(super) fn without_current_folders(path: &Path) -> PathBuf {
    let parts = path.components();
    parts.filter(|part| *part != Component::CurDir).collect()
}

/// Name of a file for scenarios and results. The name must fit on one line and in one cell.
fn file_name(path: &Path) -> Result<String, String> {
    let plain = without_current_folders(path);
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
