//! The file of a study at work: what it computes, and the rows that it has so far.
//!
//! The first line is JSON and says to what the rows belong; every other line is a checksum, the index of a case
//! and its row, with commas between. Lines are only ever appended, so what a killed program leaves is good up to
//! its last complete line, and the checksums tell if anything else happened to them. A study that is computed in
//! parts, on several machines, is joined from such files.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde_json::{Value, json};
use thiserror::Error;

use super::OutputError;

/// Parts of a study: more than any cluster has nodes.
const MOST_PARTS: usize = 100_000;

/// Which part of the cases: those whose index, counted from 1, is `index` and every `count`-th after.
///
/// Neighbouring cases cost alike, so dealing them out like cards gives all parts the same work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// All cases.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Its cases out of all.
    pub fn cases(self, all: usize) -> impl Iterator<Item = usize> {
        (self.index - 1..all).step_by(self.count)
    }

    /// Whether it is all there is.
    #[must_use]
    pub const fn is_whole(self) -> bool {
        self.count == 1
    }

    /// What its file is called: `map-2-of-4.part`.
    #[must_use]
    pub fn file_name(self, study: &str) -> String {
        if self.is_whole() {
            format!("{study}.part")
        } else {
            format!("{study}-{}-of-{}.part", self.index, self.count)
        }
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "{text:?} is no part of a whole; allowed is i/n with 1 <= i <= n <= {MOST_PARTS}, such as 2/4"
            )
        };
        let (index, count) = text.split_once('/').ok_or_else(wrong)?;
        let number = |text: &str| text.parse::<usize>().map_err(|_| wrong());
        let (index, count) = (number(index)?, number(count)?);
        if (1..=count).contains(&index) && count <= MOST_PARTS {
            Ok(Self { index, count })
        } else {
            Err(wrong())
        }
    }
}

/// To what rows belong: equal headers, but for the part, are of one study.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Which study.
    pub study: String,
    /// Version of the program.
    pub version: String,
    /// The scenario, every default resolved.
    pub scenario: String,
    /// What else the cases depend on: checksums of the files that the scenario names.
    pub inputs: Vec<String>,
    /// Number of cases of the whole study.
    pub cases: usize,
    /// Which of them are here.
    pub shard: Shard,
}

impl Header {
    /// The header of a study by this version of the program.
    #[must_use]
    pub fn new(study: &str, scenario: String, inputs: Vec<String>, cases: usize) -> Self {
        Self {
            study: study.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scenario,
            inputs,
            cases,
            shard: Shard::WHOLE,
        }
    }

    fn to_line(&self) -> String {
        let Self {
            study,
            version,
            scenario,
            inputs,
            cases,
            shard,
        } = self;
        let value = json!({
            "program": env!("CARGO_PKG_NAME"),
            "version": version,
            "study": study,
            "cases": cases,
            "shard": shard.to_string(),
            "scenario": scenario,
            "inputs": inputs,
        });
        format!("{value}\n")
    }

    fn from_line(line: &str) -> Option<Self> {
        let value: Value = serde_json::from_str(line).ok()?;
        let text = |key: &str| Some(value.get(key)?.as_str()?.to_owned());
        let inputs = value.get("inputs")?.as_array()?.iter();
        Some(Self {
            study: text("study")?,
            version: text("version")?,
            scenario: text("scenario")?,
            inputs: inputs
                .map(|input| Some(input.as_str()?.to_owned()))
                .collect::<Option<_>>()?,
            cases: usize::try_from(value.get("cases")?.as_u64()?).ok()?,
            shard: text("shard")?.parse().ok()?,
        })
    }

    /// What another header has that makes it one of other rows; `None` if both are of the very same part.
    fn other(&self, other: &Self) -> Option<String> {
        self.difference(other).or_else(|| {
            let (here, there) = (self.shard, other.shard);
            (here != there).then(|| format!("part {there} instead of {here}"))
        })
    }

    /// The first input that another header has and this one has not, or the other way round.
    fn other_input(&self, other: &Self) -> Option<String> {
        fn only<'h>(here: &'h Header, there: &Header) -> Option<&'h str> {
            let input = here.inputs.iter().find(|i| !there.inputs.contains(i))?;
            // The checksum is no news to anybody.
            Some(input.rsplit_once(' ').map_or(input, |(name, _)| name))
        }
        match (only(self, other), only(other, self)) {
            (Some(here), Some(there)) if here == there => {
                Some(format!("other contents of {there}"))
            }
            (_, Some(there)) => Some(format!("{there} as well")),
            (Some(here), None) => Some(format!("no {here}")),
            (None, None) => None,
        }
    }

    /// What parts the study of another header from this one's; `None` if they belong together.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Option<String> {
        let differ = |what: &str, here: &str, there: &str| {
            (here != there).then(|| format!("{what} {there:?} instead of {here:?}"))
        };
        differ("the study", &self.study, &other.study)
            .or_else(|| differ("the program version", &self.version, &other.version))
            .or_else(|| self.other_input(other))
            .or_else(|| {
                let mut lines = self.scenario.lines().zip(other.scenario.lines());
                let (here, there) = lines
                    .find(|(here, there)| here != there)
                    .unwrap_or((&self.scenario, &other.scenario));
                differ("in the scenario", here, there)
            })
            .or_else(|| {
                let (here, there) = (self.cases, other.cases);
                (here != there).then(|| format!("{there} cases instead of {here}"))
            })
    }
}

/// A line for a row.
fn to_line(index: usize, row: &str) -> String {
    let content = format!("{index},{row}");
    format!("{:08x},{content}\n", crc32fast::hash(content.as_bytes()))
}

/// The index and the row of a line, if it is as it was written.
fn from_line(line: &str) -> Option<(usize, &str)> {
    let (checksum, content) = line.split_once(',')?;
    let checksum = u32::from_str_radix(checksum, 16).ok()?;
    let (index, row) = content.split_once(',')?;
    let intact = crc32fast::hash(content.as_bytes()) == checksum;
    Some((index.parse().ok()?, row)).filter(|_| intact)
}

/// Rows by the index of their case.
pub type Rows = BTreeMap<usize, String>;

/// Writes rows as a table with these columns.
///
/// # Errors
/// When the system refuses.
pub fn write_table(
    mut writer: impl io::Write,
    columns: &[&str],
    rows: &Rows,
) -> Result<(), OutputError> {
    let mut text = columns.join(",") + "\n";
    for row in rows.values() {
        text += row;
        text.push('\n');
    }
    writer
        .write_all(text.as_bytes())
        .map_err(OutputError::io("cannot write the table"))
}

/// Why the file of a part cannot be used.
#[derive(Debug, Error)]
pub enum PartError {
    /// The system refused.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The file is not one of ours, or was damaged.
    #[error("{path}: {what}")]
    Unusable {
        /// The file.
        path: String,
        /// What is the matter, and the remedy.
        what: String,
    },
}

fn unusable(path: &Path, what: impl Into<String>) -> PartError {
    PartError::Unusable {
        path: path.display().to_string(),
        what: what.into(),
    }
}

/// Reads a part; the header is `None` if the program was killed before it was written. Returns how many
/// bytes of the file are complete lines as well.
fn read_lines(path: &Path) -> Result<(Option<Header>, Rows, u64), PartError> {
    let mut bytes =
        fs::read(path).map_err(|error| unusable(path, format!("cannot be read: {error}")))?;
    // A line without end was being written when the program was killed.
    let complete = bytes
        .iter()
        .rposition(|byte| *byte == b'\n')
        .map_or(0, |last| last + 1);
    bytes.truncate(complete);
    let text = String::from_utf8(bytes).map_err(|_| unusable(path, "is not a part of a study"))?;
    let mut lines = text.lines();
    let Some(first) = lines.next() else {
        return Ok((None, Rows::new(), 0));
    };
    let header = Header::from_line(first)
        .ok_or_else(|| unusable(path, "is not a part of a study by this program"))?;
    let mut rows = Rows::new();
    for (number, line) in lines.enumerate() {
        let damaged = |what: &str| {
            let what = format!("line {}: {what}; compute this part again", number + 2);
            unusable(path, what)
        };
        let (index, row) =
            from_line(line).ok_or_else(|| damaged("not as this program wrote it"))?;
        if header
            .shard
            .cases(header.cases)
            .nth(index / header.shard.count)
            != Some(index)
        {
            return Err(damaged("a case that does not belong here"));
        }
        if rows.insert(index, row.to_owned()).is_some() {
            return Err(damaged("a case for the second time"));
        }
    }
    Ok((Some(header), rows, complete as u64))
}

/// Reads a part that was computed before, complete or not.
///
/// # Errors
/// When the file cannot be read or is not a part.
pub fn read(path: &Path) -> Result<(Header, Rows), PartError> {
    match read_lines(path)? {
        (Some(header), rows, _) => Ok((header, rows)),
        (None, ..) => Err(unusable(path, "is empty")),
    }
}

/// A part that is being computed.
#[derive(Debug)]
pub struct Part {
    path: PathBuf,
    file: File,
}

impl Part {
    /// Begins a part, or goes on with it; returns the rows that it has. A part that is complete is as good as
    /// computed again. The folder must be there.
    ///
    /// # Errors
    /// When the system refuses, another program is at work on it, a part to `resume` is of something else, or
    /// one that was interrupted would be lost.
    pub fn open(path: &Path, header: &Header, resume: bool) -> Result<(Self, Rows), PartError> {
        let cannot = |what: &str| OutputError::io(format!("cannot {what} {}", path.display()));
        let mut file = OpenOptions::new()
            .create(true)
            .read(true)
            .append(true)
            .open(path)
            .map_err(|error| unusable(path, format!("cannot be written: {error}")))?;
        // Where files cannot be locked, two programs are not kept apart.
        if let Err(fs::TryLockError::WouldBlock) = file.try_lock() {
            return Err(unusable(path, "another program is at work on it"));
        }
        let (found, rows, length) = read_lines(path)?;
        // Work is not thrown away unasked.
        if let Some(found) = found
            && (resume || !rows.is_empty())
        {
            if let Some(other) = header.other(&found) {
                let what = format!(
                    "belongs to something else, with {other}: remove it, or choose another folder with --out"
                );
                return Err(unusable(path, what));
            }
            let (done, all) = (rows.len(), header.shard.cases(header.cases).count());
            if !resume && done < all {
                let what = format!(
                    "has {done} cases of this very study, interrupted: go on with --resume, or remove it to \
                     start over"
                );
                return Err(unusable(path, what));
            }
        }
        file.set_len(length).map_err(cannot("shorten"))?;
        if length == 0 {
            file.write_all(header.to_line().as_bytes())
                .map_err(cannot("write"))?;
        }
        let path = path.to_owned();
        Ok((Self { path, file }, rows))
    }

    /// Appends rows. They survive if the program is killed thereafter.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn append<'r>(
        &mut self,
        rows: impl IntoIterator<Item = (usize, &'r str)>,
    ) -> Result<(), OutputError> {
        let lines: String = rows
            .into_iter()
            .map(|(index, row)| to_line(index, row))
            .collect();
        self.file.write_all(lines.as_bytes()).map_err(self.failed())
    }

    fn failed(&self) -> impl FnOnce(io::Error) -> OutputError {
        OutputError::io(format!("cannot write {}", self.path.display()))
    }

    /// Takes it away, when its rows have found their place.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn remove(&self) -> Result<(), OutputError> {
        fs::remove_file(&self.path).map_err(self.failed())
    }
}

/// Joins the parts of a study: its header as a whole, and all its rows.
///
/// # Errors
/// When a file is no part, or they do not belong together, or do not make up the whole.
pub fn merge(paths: &[PathBuf]) -> Result<(Header, Rows), PartError> {
    let mut whole: Option<(Header, Rows)> = None;
    let mut places: BTreeMap<usize, &Path> = BTreeMap::new();
    for path in paths {
        let (header, rows) = read(path)?;
        let shard = header.shard;
        let expected = shard.cases(header.cases).count();
        if rows.len() < expected {
            let what = format!(
                "part {shard} has {} of its {expected} cases: finish it with --shard {shard} --resume",
                rows.len()
            );
            return Err(unusable(path, what));
        }
        let Some((first, all)) = &mut whole else {
            places.insert(shard.index, path);
            whole = Some((header, rows));
            continue;
        };
        let difference = first.difference(&header).or_else(|| {
            let (here, there) = (first.shard.count, shard.count);
            (here != there).then(|| format!("a study in {there} parts instead of {here}"))
        });
        if let Some(difference) = difference {
            let what = format!("does not belong to {}: {difference}", paths[0].display());
            return Err(unusable(path, what));
        }
        if let Some(earlier) = places.insert(shard.index, path) {
            let what = format!("is part {shard}, and so is {}", earlier.display());
            return Err(unusable(path, what));
        }
        all.extend(rows);
    }
    let Some((mut header, rows)) = whole else {
        return Err(unusable(Path::new("merge"), "no parts"));
    };
    let count = header.shard.count;
    if let Some(first) = (1..=count).find(|index| !places.contains_key(index)) {
        let missing = count - places.len();
        let what =
            format!("goes with parts of which {missing} are missing: the first is {first}/{count}");
        return Err(unusable(&paths[0], what));
    }
    header.shard = Shard::WHOLE;
    Ok((header, rows))
}
