//! The part file of a running study: a header that identifies the study, and the rows computed until now.
//!
//! The first line is the header. Every other line holds a checksum, the index of a case and the row of the case, separated by commas. Header and
//! rows are JSON, whose numbers read back as the same `f64`. The program only appends lines, so the file of a killed program is valid up to its
//! last complete line. The checksums detect other damage. `merge` joins the part files of a study that was computed in shards on several
//! machines.

use std::collections::BTreeMap;
use std::fmt::{self, Display};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

/// Largest number of shards of a study; larger numbers are input errors.
const MAX_SHARDS: usize = 100_000;

/// A part of the cases of a study: case number `index`, counted from 1, and every `count`-th case after it.
///
/// Neighbouring cases cost about the same, so all shards of this kind take about the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// All cases.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Indices of the cases of this shard, in a study of `all` cases.
    pub fn cases(self, all: usize) -> impl Iterator<Item = usize> {
        (self.index - 1..all).step_by(self.count)
    }

    /// True if the case with this index belongs to the shard.
    pub const fn has_case(self, case: usize) -> bool {
        case % self.count == self.index - 1
    }

    /// True if the shard contains all cases.
    pub const fn is_whole(self) -> bool {
        self.count == 1
    }

    /// Name of the part file, such as `map-2-of-4.part`.
    pub fn file_name(self, study: &str) -> String {
        if self.is_whole() {
            format!("{study}.part")
        } else {
            format!("{study}-{}-of-{}.part", self.index, self.count)
        }
    }
}

impl Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl FromStr for Shard {
    type Err = String;

    /// Parses text such as `2/4`.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "{text:?} is not a part; must be I/N with 1 <= I <= N <= {MAX_SHARDS}, such as 2/4"
            )
        };
        let (index, count) = text.split_once('/').ok_or_else(wrong)?;
        let number = |text: &str| text.parse::<usize>().map_err(|_| wrong());
        let (index, count) = (number(index)?, number(count)?);
        if (1..=count).contains(&index) && count <= MAX_SHARDS {
            Ok(Self { index, count })
        } else {
            Err(wrong())
        }
    }
}

/// Number of the format of headers and rows. It changes with the meaning of the rows, so that rows of other programs are refused.
pub(super) const ROW_FORMAT: u32 = 1;

/// Identifies the study to which the rows of a file belong. The headers of the shards of one study differ only in the shard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Name of the program.
    pub(super) program: String,
    /// [`ROW_FORMAT`] of the program that wrote the file; 0 before version 0.3.0.
    #[serde(default)]
    pub(super) row_format: u32,
    /// Version of the program.
    pub version: String,
    /// The study: [`NAME`](super::Study::NAME).
    pub study: String,
    /// Number of cases of the whole study.
    pub cases: usize,
    /// The shard whose cases are in this file.
    pub shard: Shard,
    /// The scenario, with every default filled in.
    pub scenario: String,
    /// Options of the study: [`options`](super::Study::options).
    #[serde(default, skip_serializing_if = "Value::is_null")]
    pub options: Value,
    /// Other input of the cases: checksums of the files that the scenario names.
    pub inputs: Vec<String>,
}

impl Header {
    /// Number of cases of the shard.
    pub fn shard_cases(&self) -> usize {
        self.shard.cases(self.cases).count()
    }

    /// First difference from another header, in words; `None` if both belong to the same part.
    fn first_difference(&self, other: &Self) -> Option<String> {
        self.difference(other).or_else(|| {
            let (here, there) = (self.shard, other.shard);
            (here != there).then(|| format!("part {there} instead of {here}"))
        })
    }

    /// First input that only one of the two headers has, in words.
    fn other_input(&self, other: &Self) -> Option<String> {
        fn key_only_here<'h>(here: &'h Header, there: &Header) -> Option<&'h str> {
            let input = here.inputs.iter().find(|i| !there.inputs.contains(i))?;
            // A checksum means nothing to the user.
            Some(input.rsplit_once(' ').map_or(input, |(name, _)| name))
        }
        match (key_only_here(self, other), key_only_here(other, self)) {
            (Some(here), Some(there)) if here == there => {
                Some(format!("other contents of {there}"))
            }
            (_, Some(there)) => Some(format!("{there} as well")),
            (Some(here), None) => Some(format!("no {here}")),
            (None, None) => None,
        }
    }

    /// First difference from another header apart from the shard, in words; `None` if both belong to the same study.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let differ = |what: &str, here: &str, there: &str| {
            (here != there).then(|| format!("{what} {there:?} instead of {here:?}"))
        };
        let mut lines = self.scenario.lines().zip(other.scenario.lines());
        let lines = lines
            .find(|(here, there)| here != there)
            .unwrap_or((&self.scenario, &other.scenario));
        let [options, other_options] = [self, other].map(|header| header.options.to_string());
        let (here, there) = (self.cases, other.cases);
        let all = [
            differ("the study", &self.study, &other.study),
            differ("the program version", &self.version, &other.version),
            self.other_input(other),
            differ("in the scenario", lines.0, lines.1),
            differ("the options", &options, &other_options),
            (here != there).then(|| format!("{there} cases instead of {here}")),
        ];
        all.into_iter().flatten().next()
    }
}

/// Writes the line of a row.
fn to_line(index: usize, row: &impl Serialize) -> Result<String, serde_json::Error> {
    let content = format!("{index},{}", serde_json::to_string(row)?);
    let checksum = crc32fast::hash(content.as_bytes());
    Ok(format!("{checksum:08x},{content}\n"))
}

/// Reads the index and the row from a line; `None` if the line is damaged.
fn parse_line<R: DeserializeOwned>(line: &str) -> Option<(usize, R)> {
    let (checksum, content) = line.split_once(',')?;
    let checksum = u32::from_str_radix(checksum, 16).ok()?;
    let (index, row) = content.split_once(',')?;
    if crc32fast::hash(content.as_bytes()) != checksum {
        return None;
    }
    Some((index.parse().ok()?, serde_json::from_str(row).ok()?))
}

/// Rows by the index of their case.
pub type Rows<R> = BTreeMap<usize, R>;

/// Errors of part files.
#[derive(Debug, Error)]
#[error("{message}")]
pub struct PartError {
    /// Kind of the error.
    pub kind: PartErrorKind,
    /// The file and the problem.
    pub message: String,
}

/// The kind of a [`PartError`], which determines the remedy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PartErrorKind {
    /// The system reported an error.
    System,
    /// The folder cannot be created.
    Folder,
    /// The file is not a part file of this program, is damaged, or is in use.
    Unusable,
    /// The file holds rows of another study.
    Other,
    /// The file already holds some of the requested cases, and resuming was not requested.
    Interrupted,
    /// A shard to be merged lacks cases.
    Incomplete(Shard),
}

impl PartErrorKind {
    /// An error of this kind in a file.
    fn error(self, path: &Path, problem: impl Display) -> PartError {
        PartError {
            kind: self,
            message: format!("{}: {problem}", path.display()),
        }
    }
}

fn unusable_part(path: &Path, problem: impl Display) -> PartError {
    PartErrorKind::Unusable.error(path, problem)
}

/// Error for a path that exists but is not a file: reading a pipe would never end.
fn check_file(path: &Path) -> Result<(), PartError> {
    match fs::metadata(path) {
        Ok(found) if !found.is_file() => Err(unusable_part(path, "is not a file")),
        _ => Ok(()),
    }
}

/// The complete lines of a part file.
struct Lines<'p> {
    path: &'p Path,
    text: String,
}

impl<'p> Lines<'p> {
    fn of(path: &'p Path) -> Result<Self, PartError> {
        check_file(path)?;
        let mut bytes = fs::read(path)
            .map_err(|error| unusable_part(path, format!("cannot be read: {error}")))?;
        // An incomplete last line was being written when the program was killed.
        let last = bytes.iter().rposition(|byte| *byte == b'\n');
        let begins_header = bytes.starts_with(HEADER) || HEADER.starts_with(&bytes);
        if last.is_none() && !begins_header {
            return Err(unusable_part(path, NO_PART));
        }
        bytes.truncate(last.map_or(0, |last| last + 1));
        let text = String::from_utf8(bytes).map_err(|_| unusable_part(path, NO_PART))?;
        Ok(Self { path, text })
    }

    /// Header; `None` if the program was killed before it wrote the header.
    fn header(&self) -> Result<Option<Header>, PartError> {
        let first = self.text.lines().next();
        let header = first.map(|first| match serde_json::from_str::<Header>(first) {
            Ok(header) if header.program != env!("CARGO_PKG_NAME") => {
                Err(unusable_part(self.path, NO_PART))
            }
            Ok(header) if header.row_format != ROW_FORMAT => {
                let (version, format) = (&header.version, header.row_format);
                Err(unusable_part(
                    self.path,
                    format!(
                        "was written by archrock {version}, with rows of format {format}, and this version reads format {ROW_FORMAT}: delete the file and compute the part again, or use archrock {version}"
                    ),
                ))
            }
            Ok(header) => Ok(header),
            Err(_) => Err(unusable_part(self.path, NO_PART)),
        });
        header.transpose()
    }

    /// Header, or an error if the file has none.
    fn known_header(&self) -> Result<Header, PartError> {
        self.header()?
            .ok_or_else(|| unusable_part(self.path, "is empty"))
    }

    /// Number of rows, damaged ones included.
    fn count(&self) -> usize {
        self.text.lines().skip(1).count()
    }

    /// Reads all rows.
    fn rows<R: DeserializeOwned>(&self, header: &Header) -> Result<Rows<R>, PartError> {
        let mut rows = Rows::new();
        for (number, line) in (1..).zip(self.text.lines()).skip(1) {
            let damaged = |what: &str| {
                let what = format!("line {number}: {what}; compute this part again");
                unusable_part(self.path, what)
            };
            let (index, row) = parse_line(line).ok_or_else(|| damaged("damaged"))?;
            if !header.shard.has_case(index) || index >= header.cases {
                return Err(damaged("a case of another part"));
            }
            if rows.insert(index, row).is_some() {
                return Err(damaged("a case that appears twice"));
            }
        }
        Ok(rows)
    }
}

/// Beginning of a header.
const HEADER: &[u8] = concat!("{\"program\":\"", env!("CARGO_PKG_NAME"), "\"").as_bytes();

const NO_PART: &str = "is not a part of a study (a .part file of archrock)";

/// Reads the header of a part file. The rows may be incomplete.
///
/// # Errors
/// When the file cannot be read or is not a part.
pub fn read_header(path: &Path) -> Result<Header, PartError> {
    Lines::of(path)?.known_header()
}

/// Number of complete rows in a file; `None` if the file is not a part file.
pub fn rows_in(path: &Path) -> Option<usize> {
    let lines = Lines::of(path).ok()?;
    lines.header().ok()?;
    Some(lines.count())
}

/// The part file of a shard that is being computed. It stays locked while this value exists.
#[derive(Debug)]
pub struct PartFile {
    path: PathBuf,
    file: File,
}

impl Drop for PartFile {
    /// Releases the lock. Closing the file is not enough: a process that another thread has just started may also hold the file open.
    fn drop(&mut self) {
        // Fails only if the file system has no locks.
        drop(self.file.unlock());
    }
}

impl PartFile {
    /// Creates a part file, or opens it to continue. Returns the file and the rows that are already in it. The folder must exist. The rows of a
    /// complete part are reused.
    ///
    /// # Errors
    /// When the system reports an error, another program uses the file, a part to `resume` belongs to another study, or rows of an interrupted
    /// part would be lost because `resume` is false.
    pub fn open<R: DeserializeOwned>(
        path: &Path,
        header: &Header,
        resume: bool,
    ) -> Result<(Self, Rows<R>), PartError> {
        check_file(path)?;
        if path.is_symlink() {
            return Err(unusable_part(
                path,
                "is a link, and no part is written through it",
            ));
        }
        let file = OpenOptions::new()
            .create(true)
            .read(true)
            .append(true)
            .open(path)
            .map_err(|error| unusable_part(path, format!("cannot be written: {error}")))?;
        // On systems where files cannot be locked, two programs may write to the same file.
        if let Err(fs::TryLockError::WouldBlock) = file.try_lock() {
            return Err(unusable_part(
                path,
                "another archrock is writing this file: wait until it ends",
            ));
        }
        let mut part = Self {
            path: path.to_owned(),
            file,
        };
        let lines = Lines::of(path)?;
        let rows = match lines.header()? {
            None => Rows::new(),
            Some(found) => {
                // Only a header without rows may be overwritten without `resume`.
                let begun = resume || lines.count() > 0;
                if begun && let Some(difference) = header.first_difference(&found) {
                    let problem = format!("belongs to another study: {difference}");
                    return Err(PartErrorKind::Other.error(path, problem));
                }
                lines.rows(header)?
            }
        };
        let done = rows.len();
        if !resume && (1..header.shard_cases()).contains(&done) {
            let problem = format!("has {done} cases of this study, from an interrupted run");
            return Err(PartErrorKind::Interrupted.error(path, problem));
        }
        let length = match rows.is_empty() {
            true => 0,
            false => lines.text.len() as u64,
        };
        part.file
            .set_len(length)
            .map_err(part.error_of("shorten"))?;
        if length == 0 {
            let mut line = serde_json::to_string(header).map_err(part.error_of("write"))?;
            line.push('\n');
            part.write(&line)?;
        }
        Ok((part, rows))
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends rows. They stay in the file even if the program is killed afterwards.
    ///
    /// # Errors
    /// When the system reports an error.
    pub fn append<R: Serialize>(&mut self, rows: &[(usize, R)]) -> Result<(), PartError> {
        let mut lines = String::new();
        for (index, row) in rows {
            lines += &to_line(*index, row).map_err(self.error_of("write"))?;
        }
        self.write(&lines)
    }

    fn write(&mut self, lines: &str) -> Result<(), PartError> {
        let written = self.file.write_all(lines.as_bytes());
        written.map_err(self.error_of("write"))
    }

    /// Removes the file, after the results are complete.
    ///
    /// # Errors
    /// When the file exists and the system cannot remove it.
    pub fn remove(self) -> Result<(), PartError> {
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(self.error_of("remove")(error))
            }
            _ => Ok(()),
        }
    }

    /// Checks that the file still exists. For a shard the part file itself is the result.
    pub(super) fn check_there(&self) -> Result<(), PartError> {
        if self.path.exists() {
            return Ok(());
        }
        let gone = "it was removed while it was written; compute this part again";
        Err(self.error_of("keep")(gone))
    }

    fn error_of<E: Display>(&self, what: &str) -> impl FnOnce(E) -> PartError + use<E> {
        let what = format!("cannot {what} {}", self.path.display());
        move |error| PartError {
            kind: PartErrorKind::System,
            message: format!("{what}: {error}"),
        }
    }
}

/// Joins the parts of a study. Returns the header of the whole study, and all rows in the order of the cases.
///
/// # Errors
/// When a file is not a part file, the parts belong to different studies, a part is missing or incomplete, or the rows do not have type `R`.
pub fn merge<R: DeserializeOwned>(paths: &[PathBuf]) -> Result<(Header, Vec<R>), PartError> {
    let mut whole: Option<(Header, Rows<R>)> = None;
    let mut places: BTreeMap<usize, &Path> = BTreeMap::new();
    for path in paths {
        let lines = Lines::of(path)?;
        let header = lines.known_header()?;
        let shard = header.shard;
        if let Some((first, _)) = &whole {
            let difference = first.difference(&header).or_else(|| {
                let (here, there) = (first.shard.count, shard.count);
                (here != there).then(|| format!("a study in {there} parts instead of {here}"))
            });
            if let Some(difference) = difference {
                let what = format!("does not belong to {}: {difference}", paths[0].display());
                return Err(unusable_part(path, what));
            }
        }
        let rows = lines.rows(&header)?;
        let (done, all) = (rows.len(), header.shard_cases());
        if done < all {
            let problem = format!("part {shard} has {done} of its {all} cases");
            return Err(PartErrorKind::Incomplete(shard).error(path, problem));
        }
        if let Some(earlier) = places.insert(shard.index, path) {
            let what = format!("is part {shard}, and so is {}", earlier.display());
            return Err(unusable_part(path, what));
        }
        match &mut whole {
            Some((_, all)) => all.extend(rows),
            None => whole = Some((header, rows)),
        }
    }
    let Some((mut header, rows)) = whole else {
        return Err(unusable_part(Path::new("merge"), "no parts given"));
    };
    let count = header.shard.count;
    if let Some(first) = (1..=count).find(|index| !places.contains_key(index)) {
        let missing = count - places.len();
        let what = format!("{missing} of {count} parts missing: the first is {first}/{count}");
        return Err(unusable_part(&paths[0], what));
    }
    header.shard = Shard::WHOLE;
    Ok((header, rows.into_values().collect()))
}
