//! Reads the tables of a TOML text so that every error is found and keeps its place.
//!
//! Nothing here knows the keys of a scenario; each table is read in the module of its subject. A key that is missing or wrong is a fault,
//! and a value that follows its rule stands for it: so a reader names each key once, where it fills its field. Before it compares values, it
//! checks that all of them are those of the file ([`Table::sound`]). A table with faults is never used.
//!
//! Reading describes: from an empty text, [`describe`] collects all tables, keys, rules and defaults that `read` has.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::assignment::Assignment;
use super::document::{Document, Entries, Span, kind};
use super::error::{Fault, ensure, excerpt};
use super::input_file::InputFile;
use super::rule::{Rule, did_you_mean};

/// Stands for a value that could not be read; the reason is recorded as a [`Fault`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Reported;

/// A value, or [`Reported`] if its fault has been recorded.
pub(super) type Reading<T> = Result<T, Reported>;

/// Reads the keys of a table.
pub(super) trait Reader<T>: FnOnce(&mut Table<'_>) -> Reading<T> {}

impl<T, R: FnOnce(&mut Table<'_>) -> Reading<T>> Reader<T> for R {}

/// Reads a whole TOML text with `read`, after replacing values as `set` says, or returns everything that is wrong.
pub(super) fn read_text<T>(
    (text, folder): (&str, &Path),
    set: &[Assignment],
    read: impl Reader<T>,
) -> Result<T, Vec<Fault>> {
    let mut document = Document::parse(text, folder)?;
    document.assign(set);
    read_document(document, read)
}

/// Reads a document with `read`, or returns everything that is wrong.
pub(super) fn read_document<T>(
    mut document: Document<'_>,
    read: impl Reader<T>,
) -> Result<T, Vec<Fault>> {
    let mut faults = std::mem::take(&mut document.faults);
    let mut table = Table::new("the scenario".to_owned(), &document.root, &document);
    let value = read(&mut table);
    table.reject_unknown_keys();
    faults.append(&mut table.faults);
    match value {
        Ok(value) if faults.is_empty() => Ok(value),
        _ => Err(faults),
    }
}

/// The JSON schema of all texts that `read` reads.
pub(super) fn describe<T>(read: impl Reader<T>) -> Value {
    let document = Document::default();
    let mut table = Table::new(String::new(), &document.root, &document);
    table.description = Some(an_object());
    // An empty text is no valid scenario: only the keys count.
    let _ = read(&mut table);
    table.description.unwrap_or_default()
}

/// The JSON schema of a table without keys.
fn an_object() -> Value {
    json!({ "type": "object", "properties": {}, "additionalProperties": false })
}

/// A table of the file, and the faults found in it.
///
/// The keys that have been read are the allowed keys.
pub(super) struct Table<'a> {
    /// Its name in messages.
    name: String,
    /// The text with its header, and the offset of that header.
    place: (usize, usize),
    /// Its path in the document.
    path: String,
    entries: &'a Entries,
    document: &'a Document<'a>,
    /// The keys, and whether each is read as a table.
    known: Vec<(String, bool)>,
    faults: Vec<Fault>,
    files: Vec<InputFile>,
    /// True if a value is unknown without a fault: its line may be one that is not TOML.
    is_partial: bool,
    /// The JSON schema of the keys that were read, if they are collected.
    description: Option<Value>,
}

impl<'a> Table<'a> {
    fn new(name: String, entries: &'a Entries, document: &'a Document<'a>) -> Self {
        Self {
            name,
            place: (0, 0),
            path: String::new(),
            entries,
            document,
            known: Vec::new(),
            faults: Vec::new(),
            files: Vec::new(),
            is_partial: false,
            description: None,
        }
    }

    /// Notes a file that the scenario names and that has been read.
    pub(super) fn note_file(&mut self, file: &str) {
        if let Ok(bytes) = std::fs::read(self.path(file)) {
            self.files.push(InputFile::new(file, &bytes));
        }
    }

    /// The folder to which the names of files are relative.
    pub(super) fn folder(&self) -> &'a Path {
        &self.document.folder
    }

    /// The path of a file that the scenario names.
    pub(super) fn path(&self, file: &str) -> PathBuf {
        self.folder().join(file)
    }

    /// Takes the noted files, of this table and of the tables in it.
    pub(super) fn noted_files(&mut self) -> Vec<InputFile> {
        std::mem::take(&mut self.files)
    }

    /// Gives it another name in messages.
    pub(super) fn rename(&mut self, name: &str) {
        name.clone_into(&mut self.name);
    }

    /// Succeeds if all values that have been read are those of the file.
    pub(super) fn sound(&self) -> Reading<()> {
        let is_sound = self.faults.is_empty() && !self.is_partial;
        ensure(is_sound && self.description.is_none(), || Reported)
    }

    /// The value of a key that must be given.
    pub(super) fn required<R: Rule<Read: Default>>(&mut self, key: &str, rule: &R) -> R::Read {
        let value = self.optional(key, rule);
        self.describe("required", || json!(key));
        self.needed(key, rule, value)
    }

    /// The value of a key that was read as `value`, and that others make necessary.
    pub(super) fn needed<R: Rule<Read: Default>>(
        &mut self,
        key: &str,
        rule: &R,
        value: Option<R::Read>,
    ) -> R::Read {
        if !self.may_give(&[key]) {
            self.wrong_itself(format!("lacks `{key}`: give {}", rule.allowed()));
        }
        value.unwrap_or_default()
    }

    /// The value of a key that can be left out, or `default`.
    pub(super) fn or<R: Rule>(&mut self, key: &str, rule: &R, default: R::Read) -> R::Read {
        let value = self.optional(key, rule);
        if let Some(description) = &mut self.description {
            description["properties"][key]["default"] = json!(default);
        }
        value.unwrap_or(default)
    }

    /// The value of a key that can be left out.
    pub(super) fn optional<R: Rule>(&mut self, key: &str, rule: &R) -> Option<R::Read> {
        self.describe_key(key, || rule.schema());
        match rule.read(self.entry(key, false)?) {
            Ok(value) => Some(value),
            Err(wrong) => {
                self.wrong(key, format!("{wrong}; must be {}", rule.allowed()));
                None
            }
        }
    }

    /// The table of that name as `read` reads it, if given and right.
    pub(super) fn table<T>(&mut self, key: &str, read: impl Reader<T>) -> Option<T> {
        self.given_table(key, read).ok().flatten()
    }

    /// The table of that name as `read` reads it, if given.
    pub(super) fn given_table<T>(&mut self, key: &str, read: impl Reader<T>) -> Reading<Option<T>> {
        match self.entry(key, true) {
            Some(Value::Object(entries)) => {
                let path = format!("{}/{key}", self.path);
                self.descend(key, Some((path, entries)), read).map(Some)
            }
            Some(entry) => Err(self.wrong(key, format!("is {}; must be a table", kind(entry)))),
            None if self.describes() => self.descend(key, None, read).map(Some),
            None if self.may_give(&[key]) => Err(Reported),
            None => Ok(None),
        }
    }

    /// The tables of an array `[[key]]` that are right, each read by `read`; empty if not given.
    pub(super) fn tables<T>(&mut self, key: &str, read: impl Reader<T> + Copy) -> Vec<T> {
        let Some(entry) = self.entry(key, true) else {
            if self.describes() {
                let _ = self.descend(key, None, read);
            }
            if let Some(description) = &mut self.description {
                let items = &mut description["properties"][key];
                *items = json!({ "type": "array", "items": items.take() });
            }
            return Vec::new();
        };
        let Value::Array(elements) = entry else {
            let kind = kind(entry);
            let wrong = format!("is {kind}; must be an array of tables: write [[{key}]]");
            self.wrong(key, wrong);
            return Vec::new();
        };
        let mut tables = Vec::new();
        for (index, element) in elements.iter().enumerate() {
            if let Value::Object(entries) = element {
                let path = format!("{}/{key}/{index}", self.path);
                tables.extend(self.descend(key, Some((path, entries)), read));
            } else {
                let wrong = format!("is {}; must be a table", kind(element));
                self.wrong_element(key, index, wrong);
            }
        }
        tables
    }

    /// The table of that name as `read` reads it; if not given, `read` gets an empty table.
    pub(super) fn table_or_defaults<T>(&mut self, key: &str, read: impl Reader<T>) -> Reading<T> {
        if self.may_give(&[key]) || self.describes() {
            return self.given_table(key, read)?.ok_or(Reported);
        }
        self.entry(key, true);
        self.descend(key, None, read)
    }

    /// The keys that name a value of another table, such as `"arch.depth_m"`, in the order of the file; for a description, one of them.
    pub(super) fn keys_of_other_tables(&self) -> Vec<String> {
        if self.description.is_some() {
            return vec!["table.key".to_owned()];
        }
        let keys = self.entries.keys();
        keys.filter(|key| key.contains('.')).cloned().collect()
    }

    /// A value as the file gives it, if it does.
    pub(super) fn as_given(&self, key: &str) -> Option<Value> {
        self.entries.get(key).cloned()
    }

    /// Whether the file gives a table for the key.
    pub(super) fn gives_table(&self, key: &str) -> bool {
        self.entries.get(key).is_some_and(Value::is_object)
    }

    /// Whether the file gives the key.
    pub(super) fn gives(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// Whether a table inside this one gives the key.
    pub(super) fn gives_in(&self, table: &str, key: &str) -> bool {
        let inner = self.entries.get(table);
        inner.is_some_and(|inner| inner.get(key).is_some())
    }

    /// Whether the file gives one of the keys, or has lines that are not TOML and name one.
    pub(super) fn may_give(&self, keys: &[&str]) -> bool {
        let unread = &self.document.unread;
        let mut keys = keys.iter();
        keys.any(|key| self.gives(key) || unread.contains(key))
    }

    /// Whether the key is read as a table.
    pub(super) fn is_table(&self, key: &str) -> bool {
        let mut known = self.known.iter();
        known.any(|(known, is_table)| known == key && *is_table)
    }

    /// The place of the value that the file gives for a key.
    pub(super) fn place(&self, key: &str) -> Option<(usize, usize)> {
        self.place_of(&format!("{}/{key}", self.path))
    }

    /// The place of the value with this path.
    fn place_of(&self, path: &str) -> Option<(usize, usize)> {
        let Span { text, range, .. } = self.document.spans.get(path)?;
        Some((*text, range.start))
    }

    /// Whether the keys are collected for a description.
    pub(super) const fn describes(&self) -> bool {
        self.description.is_some()
    }

    /// Adds an element to a list of the description.
    pub(super) fn describe(&mut self, list: &str, schema: impl FnOnce() -> Value) {
        match self.description.as_mut().map(|known| &mut known[list]) {
            Some(Value::Array(known)) => known.push(schema()),
            Some(known) => *known = json!([schema()]),
            None => {}
        }
    }

    /// Adds the allowed values of a key to the description; if the key is read in two ways, both are allowed. A key with a dot stands for
    /// all such keys.
    fn describe_key(&mut self, key: &str, schema: impl FnOnce() -> Value) {
        let Some(description) = &mut self.description else {
            return;
        };
        let known = match key.contains('.') {
            true => &mut description["patternProperties"]["\\."],
            false => &mut description["properties"][key],
        };
        *known = match (known.take(), schema()) {
            (Value::Null, schema) => schema,
            (known, schema) if known == schema || key.contains('.') => schema,
            (known, schema) => json!({ "anyOf": [known, schema] }),
        };
    }

    /// Number of faults that have been found.
    pub(super) fn faults(&self) -> usize {
        self.faults.len()
    }

    /// Removes the faults after the first `since`, if all of them are faults of files that the text names. Returns false otherwise.
    pub(super) fn forgives_files(&mut self, since: usize) -> bool {
        let forgives = self.faults[since..].iter().all(|fault| fault.of_file);
        if forgives {
            self.faults.truncate(since);
        }
        forgives
    }

    /// Records that the file which `key` names is missing or wrong: `message` continues the key and its value.
    pub(super) fn wrong_file(&mut self, key: &str, message: impl Display) -> Reported {
        let reported = self.wrong(key, message);
        if let Some(fault) = self.faults.last_mut() {
            fault.of_file = true;
        }
        reported
    }

    /// Records that the given value of `key` is wrong: `message` continues the key and its value.
    pub(super) fn wrong(&mut self, key: &str, message: impl Display) -> Reported {
        self.wrong_in(&[], key, message)
    }

    /// Records that the given value of `key` is wrong, if it is.
    pub(super) fn refuse<M: Display>(&mut self, when: bool, key: &str, message: M) -> Reading<()> {
        ensure(!when, || self.wrong(key, message))
    }

    /// Records that the whole table is wrong, if it is.
    pub(super) fn refuse_all(&mut self, when: bool, message: impl Display) -> Reading<()> {
        ensure(!when, || self.wrong_itself(message))
    }

    /// The result of work with the given value of `key`; an error continues the key and its value.
    pub(super) fn accept<T, E: Display>(&mut self, key: &str, result: Result<T, E>) -> Reading<T> {
        result.map_err(|wrong| self.wrong(key, wrong))
    }

    /// Records that the given value of `key` is wrong in nested tables inside this one. If the innermost table does not give it, the
    /// tables around it are searched; if none does, it is missing in the innermost table that is given.
    pub(super) fn wrong_in<M: Display>(
        &mut self,
        path: &[&str],
        key: &str,
        message: M,
    ) -> Reported {
        let mut around = vec![(self.path.clone(), self.entries)];
        for table in path {
            let (path, entries) = &around[around.len() - 1];
            let Some(Value::Object(inner)) = entries.get(*table) else {
                break;
            };
            around.push((format!("{path}/{table}"), inner));
        }
        let innermost = around.last().and_then(|(path, _)| self.place_of(path));
        // With nested tables, only those are searched.
        let mut searched = around.iter().skip(path.len().min(1)).rev();
        let found =
            searched.find_map(|(path, entries)| Some((format!("{path}/{key}"), entries.get(key)?)));
        let Some((path, value)) = found else {
            let place = innermost.unwrap_or(self.place);
            return self.fault(place, format!("`{key}` {message}"));
        };
        let given = match value {
            Value::Object(_) => format!("table `{key}`"),
            _ if self.document.is_array_of_tables(&path, key) => format!("`[[{key}]]`"),
            _ => format!("`{key} = {}`", self.document.quote(&path, value)),
        };
        let place = self.place_of(&path).unwrap_or_default();
        self.fault(place, format!("{given} {message}"))
    }

    /// Records that an element of the array given for `key` is wrong; elements are counted from 0. A
    /// value that is not an array counts as its only element.
    pub(super) fn wrong_element<M: Display>(&mut self, key: &str, at: usize, wrong: M) -> Reported {
        let Some(element) = self.entries.get(key).and_then(|value| value.get(at)) else {
            return self.wrong(key, wrong);
        };
        let path = format!("{}/{key}/{at}", self.path);
        let value = self.document.quote(&path, element);
        let place = self.place_of(&path).unwrap_or_default();
        self.fault(place, format!("`{value}` in `{key}` {wrong}"))
    }

    /// Records that a key is given which another excludes.
    pub(super) fn excluded(&mut self, key: &str, other: &str, remedy: &str) {
        let place = self.place(key).unwrap_or(self.place);
        let message = format!("`{key}` cannot be combined with `{other}`; {remedy}");
        self.fault(place, message);
    }

    /// Records that the whole table is wrong: `message` continues its name.
    pub(super) fn wrong_itself(&mut self, message: impl Display) -> Reported {
        self.fault(self.place, format!("{} {message}", self.name))
    }

    fn fault(&mut self, (text, offset): (usize, usize), message: String) -> Reported {
        self.faults.push(Fault::new(text, offset, message));
        Reported
    }

    /// The entry of a key, if the file gives it.
    fn entry(&mut self, key: &str, is_table: bool) -> Option<&'a Value> {
        if !self.known.iter().any(|(known, _)| known == key) {
            self.known.push((key.to_owned(), is_table));
        }
        let entry = self.entries.get(key);
        self.is_partial |= entry.is_none() && self.may_give(&[key]);
        entry
    }

    /// Reads the table with this path and these entries, or an empty one.
    fn descend<T>(
        &mut self,
        key: &str,
        table: Option<(String, &Entries)>,
        read: impl Reader<T>,
    ) -> Reading<T> {
        let empty = Entries::new();
        let name = match self.name.strip_suffix(']') {
            Some(parent) => format!("{parent}.{key}]"),
            None => format!("[{key}]"),
        };
        let (path, entries) = table.unwrap_or((String::new(), &empty));
        let mut table = Table {
            place: self.place_of(&path).unwrap_or(self.place),
            path,
            description: self.description.as_ref().map(|_| an_object()),
            ..Table::new(name, entries, self.document)
        };
        let value = read(&mut table);
        table.reject_unknown_keys();
        let value = table.sound().and(value);
        self.faults.append(&mut table.faults);
        self.files.append(&mut table.files);
        self.is_partial |= table.is_partial;
        self.describe_key(key, || table.description.unwrap_or_default());
        value
    }

    fn reject_unknown_keys(&mut self) {
        // A reader that refuses the whole table reads no keys.
        if self.known.is_empty() && !self.faults.is_empty() {
            return;
        }
        let known: Vec<&str> = self.known.iter().map(|(key, _)| key.as_str()).collect();
        let unknown = self.entries.keys();
        for key in unknown.filter(|key| !known.contains(&key.as_str())) {
            let mut replaced = REPLACED.iter();
            let message = match replaced.find(|(table, old, _)| self.name == *table && key == old) {
                Some((_, key, successor)) => format!("`{key}` in {} {successor}", self.name),
                None => format!(
                    "unknown key `{}` in {}{}; known keys: {}",
                    excerpt(key),
                    self.name,
                    did_you_mean(key, &known),
                    known.join(", ")
                ),
            };
            let span = self.document.spans.get(&format!("{}/{key}", self.path));
            let (text, offset) = span.map_or((0, 0), |span| (span.text, span.key));
            self.faults.push(Fault::new(text, offset, message));
        }
    }
}

/// Keys of earlier versions, by their table, and their replacements.
const REPLACED: [(&str, &str, &str); 2] = [
    (
        "the scenario",
        "spectrum",
        "was removed: `archrock threshold SCENARIO --along TABLE.KEY=FROM..TO:COUNT` finds the threshold for each value of a key",
    ),
    ("[map]", "spread", "is now called `repeat`"),
];
