//! Reader of the tables of a TOML text that finds all errors and keeps their positions.
//!
//! This module knows no keys of scenarios; each table is read in the module of its subject. For a missing or wrong key the reader records a
//! fault and continues with a default value. So a reader names each key once, where it fills its field. Before it compares values, it
//! checks that all of them are from the file ([`Table::check_faultless`]). A table with faults is never used.
//!
//! Reading also describes: with an empty text, [`describe`] collects all tables, keys, rules and defaults of `read`.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::sync::LazyLock;

use archrock_text::{ensure, excerpt, shown};
use serde_json::{Value, json};

use super::assignment::Assignment;
use super::change;
use super::document::{Document, Entries, KeyGroup, Span, kind};
use super::error::Fault;
use super::files::Files;
use super::input_file::InputFile;
use super::rule::{Rule, did_you_mean};

/// Error of a value that could not be read; its reason is recorded as a [`Fault`].
#[derive(Clone, Copy, Debug)]
pub struct FaultRecorded;

/// A value, or [`FaultRecorded`] if a fault was recorded.
pub type ReadResult<T> = Result<T, FaultRecorded>;

/// Function that reads the keys of a table.
pub(super) trait Reader<T>: FnOnce(&mut Table<'_>) -> ReadResult<T> {}

impl<T, R: FnOnce(&mut Table<'_>) -> ReadResult<T>> Reader<T> for R {}

/// Reads a TOML text with `read` after the assignments `set`. Returns all faults if there are any.
pub(super) fn read_text<T>(
    (text, files): (&str, &Files),
    set: &[Assignment],
    read: impl Reader<T>,
) -> Result<T, Vec<Fault>> {
    let mut document = Document::parse(text, files)?;
    let set = document.assign(set);
    change::adjust_others(&mut document.root, &set);
    read_document(document, read)
}

/// Reads a document with `read`. Returns all faults if there are any.
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

/// JSON schema of all texts that `read` reads, and the groups of keys in all tables.
pub(super) fn describe<T>(read: impl Reader<T>) -> (Value, Vec<KeyGroup>) {
    let document = Document::default();
    let mut table = Table::new(String::new(), &document.root, &document);
    table.description = Some(an_object());
    // An empty text is not a valid scenario, but the collected keys are complete.
    let _ = read(&mut table);
    (table.description.unwrap_or_default(), table.groups)
}

/// JSON schema of a table without keys.
fn an_object() -> Value {
    json!({ "type": "object", "properties": {}, "additionalProperties": false })
}

/// A table of the file, with its faults.
///
/// The keys that have been read are the allowed keys.
pub struct Table<'a> {
    /// Name of the table in messages.
    name: String,
    /// Number of the text with the header of the table, and offset of the header.
    place: (usize, usize),
    /// Path of the table in the document.
    path: String,
    entries: &'a Entries,
    /// Path and entries of the outer table.
    outer: Option<(String, &'a Entries)>,
    /// Keys whose values in the outer table are defaults of this table.
    inherited: Vec<&'static str>,
    /// Keys whose values were read from the outer table, because this table does not give them.
    taken: Vec<String>,
    /// Keys of this table that tables in it have taken as defaults.
    defaults: BTreeSet<String>,
    document: &'a Document<'a>,
    /// The keys that were read, and true for keys of tables.
    known: Vec<(String, bool)>,
    faults: Vec<Fault>,
    /// The files that were noted in this table and in the tables in it.
    pub(super) noted_files: Vec<InputFile>,
    /// True if a value is unknown without a fault, because a line that is not TOML may contain it.
    is_partial: bool,
    /// JSON schema of the keys that were read; `None` unless they are collected.
    description: Option<Value>,
    /// Groups of keys in this table and in the tables in it; empty unless they are collected.
    pub(super) groups: Vec<KeyGroup>,
}

impl<'a> Table<'a> {
    fn new(name: String, entries: &'a Entries, document: &'a Document<'a>) -> Self {
        Self {
            name,
            place: (0, 0),
            path: String::new(),
            entries,
            outer: None,
            inherited: Vec::new(),
            taken: Vec::new(),
            defaults: BTreeSet::new(),
            document,
            known: Vec::new(),
            faults: Vec::new(),
            noted_files: Vec::new(),
            is_partial: false,
            description: None,
            groups: Vec::new(),
        }
    }

    /// Records a file that the scenario names and that has been read.
    pub(super) fn note_file(&mut self, file: &str) {
        let files = self.files();
        if let Ok(bytes) = files.read(&files.path(file)) {
            self.noted_files.push(InputFile::new(file, &bytes));
        }
    }

    /// Files that the scenario may name.
    pub(super) fn files(&self) -> &'a Files {
        &self.document.files
    }

    /// Sets the name of the table in messages.
    pub(super) fn rename(&mut self, name: &str) {
        name.clone_into(&mut self.name);
    }

    /// Succeeds if all values that were read are from the file.
    pub(super) fn check_faultless(&self) -> ReadResult<()> {
        let is_faultless = self.faults.is_empty() && !self.is_partial;
        ensure(is_faultless && self.description.is_none(), || FaultRecorded)
    }

    /// Value of a key that must be given.
    pub(super) fn read_required<R: Rule<Output: Default>>(
        &mut self,
        key: &str,
        rule: &R,
    ) -> R::Output {
        let value = self.optional(key, rule);
        self.describe("required", || json!(key));
        self.needed(key, rule, value)
    }

    /// Value of an optional key that other keys make necessary. `value` is the result of reading the key.
    pub(super) fn needed<R: Rule<Output: Default>>(
        &mut self,
        key: &str,
        rule: &R,
        value: Option<R::Output>,
    ) -> R::Output {
        if !self.may_give(&[key]) {
            self.fault_of_table(format!("lacks `{key}`: give {}", rule.allowed()));
        }
        value.unwrap_or_default()
    }

    /// Value of an optional key, or `default`.
    pub(super) fn or<R: Rule>(&mut self, key: &str, rule: &R, default: R::Output) -> R::Output {
        let value = self.optional(key, rule);
        if let Some(description) = &mut self.description {
            description["properties"][key]["default"] = json!(default);
        }
        value.unwrap_or(default)
    }

    /// Value of an optional key; `None` if it is not given or wrong.
    pub(super) fn optional<R: Rule>(&mut self, key: &str, rule: &R) -> Option<R::Output> {
        self.describe_key(key, || rule.schema());
        match rule.read(self.entry(key, false)?) {
            Ok(value) => Some(value),
            Err(wrong) => {
                self.reject(key, format!("{wrong}; must be {}", rule.allowed()));
                None
            }
        }
    }

    /// Reads the table with this name; `None` if it is not given or faulty.
    pub(super) fn table<T>(&mut self, key: &str, read: impl Reader<T>) -> Option<T> {
        self.given_table(key, read).ok().flatten()
    }

    /// Reads the table with this name; `None` if it is not given.
    pub(super) fn given_table<T>(
        &mut self,
        key: &str,
        read: impl Reader<T>,
    ) -> ReadResult<Option<T>> {
        match self.entry(key, true) {
            Some(Value::Object(entries)) => {
                let path = format!("{}/{key}", self.path);
                self.descend(key, Some((path, entries)), read).map(Some)
            }
            Some(entry) => Err(self.reject(key, format!("is {}; must be a table", kind(entry)))),
            None if self.describes() => self.descend(key, None, read).map(Some),
            None if self.may_give(&[key]) => Err(FaultRecorded),
            None => Ok(None),
        }
    }

    /// Reads the valid tables of an array `[[key]]`; empty if it is not given.
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
            let name = format!("{}/{key}", self.path)[1..].replace('/', ".");
            let wrong = format!("is {kind}; must be an array of tables: write [[{name}]]");
            self.reject(key, wrong);
            return Vec::new();
        };
        let mut tables = Vec::new();
        for (index, element) in elements.iter().enumerate() {
            if let Value::Object(entries) = element {
                let path = format!("{}/{key}/{index}", self.path);
                tables.extend(self.descend(key, Some((path, entries)), read));
            } else {
                let wrong = format!("is {}; must be a table", kind(element));
                self.reject_element(key, index, wrong);
            }
        }
        tables
    }

    /// Reads the table with this name; if it is not given, `read` gets an empty table.
    pub(super) fn table_or_defaults<T>(
        &mut self,
        key: &str,
        read: impl Reader<T>,
    ) -> ReadResult<T> {
        if self.may_give(&[key]) || self.describes() {
            return self.given_table(key, read)?.ok_or(FaultRecorded);
        }
        self.entry(key, true);
        self.descend(key, None, read)
    }

    /// Keys that name a value of another table, such as `"arch.depth_m"`, in the order of the file. For a description it returns one
    /// such key.
    pub(super) fn keys_of_other_tables(&self) -> Vec<String> {
        if self.description.is_some() {
            return vec!["table.key".to_owned()];
        }
        let keys = self.entries.keys();
        keys.filter(|key| key.contains('.')).cloned().collect()
    }

    /// Value as in the file; `None` if it is not given.
    pub(super) fn as_given(&self, key: &str) -> Option<Value> {
        self.entries.get(key).cloned()
    }

    /// All entries as in the file.
    pub(super) fn all_given(&self) -> Entries {
        self.entries.clone()
    }

    /// True if the file has a table with this key.
    pub(super) fn has_table(&self, key: &str) -> bool {
        self.entries.get(key).is_some_and(Value::is_object)
    }

    /// True if the file has this key, here or as a default in the outer table.
    pub(super) fn has_key(&self, key: &str) -> bool {
        self.entries.contains_key(key) || self.default_of(key).is_some()
    }

    /// Takes values that the outer table gives for these keys as defaults.
    pub(super) fn inherit(&mut self, keys: impl Iterator<Item = &'static str>) {
        self.inherited.extend(keys);
    }

    /// True if a table in this one has read the value of this key as a default.
    pub(super) fn is_default(&self, key: &str) -> bool {
        self.defaults.contains(key)
    }

    /// Path and value of a default in the outer table.
    fn default_of(&self, key: &str) -> Option<(String, &'a Value)> {
        let (path, entries) = self.outer.as_ref()?;
        let value = entries.get(key).filter(|_| self.inherited.contains(&key))?;
        Some((format!("{path}/{key}"), value))
    }

    /// True if a table inside this one has the key.
    pub(super) fn has_key_in(&self, table: &str, key: &str) -> bool {
        let inner = self.entries.get(table);
        inner.is_some_and(|inner| inner.get(key).is_some())
    }

    /// True if the file has one of the keys, or if lines that are not TOML contain one.
    pub(super) fn may_give(&self, keys: &[&str]) -> bool {
        let unread = &self.document.unread;
        let mut keys = keys.iter();
        keys.any(|key| self.has_key(key) || unread.contains(key))
    }

    /// True if the key is read as a table.
    pub(super) fn is_table(&self, key: &str) -> bool {
        let mut known = self.known.iter();
        known.any(|(known, is_table)| known == key && *is_table)
    }

    /// Position of the value of a key.
    pub(super) fn value_position(&self, key: &str) -> Option<(usize, usize)> {
        self.place_of(&format!("{}/{key}", self.path))
    }

    /// Position of the value with this path.
    fn place_of(&self, path: &str) -> Option<(usize, usize)> {
        let Span { text, range, .. } = self.document.spans.get(path)?;
        Some((*text, range.start))
    }

    /// True if the keys are collected for a description.
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

    /// Adds the allowed values of a key to the description. If the key is read in two ways, both are allowed. A key with a dot represents all
    /// such keys.
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

    /// Number of faults.
    pub(super) fn faults(&self) -> usize {
        self.faults.len()
    }

    /// Removes the faults after the first `since` if all of them are faults of files that the text names. Returns true if it has removed them.
    pub(super) fn drop_file_faults(&mut self, since: usize) -> bool {
        let drops = self.faults[since..].iter().all(|fault| fault.of_file);
        if drops {
            self.faults.truncate(since);
        }
        drops
    }

    /// Records that the file of `key` is missing or wrong. `message` follows the key and its value.
    pub(super) fn reject_file(&mut self, key: &str, message: impl Display) -> FaultRecorded {
        let reported = self.reject(key, message);
        if let Some(fault) = self.faults.last_mut() {
            fault.of_file = true;
        }
        reported
    }

    /// Records that the value of `key` is wrong. `message` follows the key and its value.
    pub(super) fn reject(&mut self, key: &str, message: impl Display) -> FaultRecorded {
        self.reject_in(&[], key, message)
    }

    /// Records that the value of `key` is wrong if `when` is true.
    pub(super) fn refuse<M: Display>(
        &mut self,
        when: bool,
        key: &str,
        message: M,
    ) -> ReadResult<()> {
        ensure(!when, || self.reject(key, message))
    }

    /// Records that the whole table is wrong if `when` is true.
    pub(super) fn refuse_all(&mut self, when: bool, message: impl Display) -> ReadResult<()> {
        ensure(!when, || self.fault_of_table(message))
    }

    /// Value of a result. An error is recorded as a fault of `key`; it follows the key and its value.
    pub(super) fn accept<T, E: Display>(
        &mut self,
        key: &str,
        result: Result<T, E>,
    ) -> ReadResult<T> {
        result.map_err(|wrong| self.reject(key, wrong))
    }

    /// Records that the value of `key` is wrong in nested tables inside this one. If the innermost table does not give the key, the
    /// outer tables are searched. If none gives it, the fault is at the innermost given table.
    pub(super) fn reject_in<M: Display>(
        &mut self,
        path: &[&str],
        key: &str,
        message: M,
    ) -> FaultRecorded {
        let mut around = vec![(self.path.clone(), self.entries)];
        for table in path {
            let (path, entries) = &around[around.len() - 1];
            let Some(Value::Object(inner)) = entries.get(*table) else {
                break;
            };
            around.push((format!("{path}/{table}"), inner));
        }
        let innermost = around.last().and_then(|(path, _)| self.place_of(path));
        // With nested tables, only these are searched.
        let mut searched = around.iter().skip(path.len().min(1)).rev();
        let found = searched
            .find_map(|(path, entries)| Some((format!("{path}/{key}"), entries.get(key)?)))
            .or_else(|| self.default_of(key));
        let Some((path, value)) = found else {
            let place = innermost.unwrap_or(self.place);
            return self.fault(place, format!("`{key}` {message}"));
        };
        let given = match value {
            // [uncertain] and [map] name keys of other tables, such as `arch.depth_m`.
            Value::Object(_) if key.contains('.') => format!("`{key}`"),
            Value::Object(_) => format!("table `{key}`"),
            _ if self.document.is_array_of_tables(&path, value) => format!("`[[{key}]]`"),
            Value::String(name) if key == "file" && self.has_samples(name) => {
                format!("the record \"{}\"", shown(name))
            }
            _ => format!("`{key} = {}`", self.document.quote(&path, value)),
        };
        let assigned = value.is_array().then(|| self.document.assigned(&path));
        let place = assigned
            .flatten()
            .or_else(|| self.place_of(&path))
            .unwrap_or_default();
        self.fault(place, format!("{given} {message}"))
    }

    /// Records that an element of the array of `key` is wrong; elements are counted from 0. A value that is not an array counts as
    /// its only element.
    pub(super) fn reject_element<M: Display>(
        &mut self,
        key: &str,
        at: usize,
        wrong: M,
    ) -> FaultRecorded {
        let Some(element) = self.entries.get(key).and_then(|value| value.get(at)) else {
            return self.reject(key, wrong);
        };
        let path = format!("{}/{key}/{at}", self.path);
        let value = self.document.quote(&path, element);
        let place = self.place_of(&path).unwrap_or_default();
        self.fault(place, format!("`{value}` in `{key}` {wrong}"))
    }

    /// Records that `key` is wrong or missing in an element of the array `[[name]]`; elements are counted from 0. `message` follows the key, its value
    /// and the element.
    pub(super) fn reject_in_element<M: Display>(
        &mut self,
        (name, at): (&str, usize),
        key: &str,
        message: M,
    ) -> FaultRecorded {
        let element = format!("{}/{name}/{at}", self.path);
        let path = format!("{element}/{key}");
        let value = self
            .entries
            .get(name)
            .and_then(|value| value.get(at)?.get(key));
        let given = match value {
            Some(value) => format!("`{key} = {}`", self.document.quote(&path, value)),
            None => format!("`{key}`"),
        };
        let place = self
            .place_of(&path)
            .or_else(|| self.place_of(&element))
            .unwrap_or_default();
        self.fault(place, format!("{given} of {name} {} {message}", at + 1))
    }

    /// Records that a key is given which another key excludes.
    pub(super) fn reject_excluded(&mut self, key: &str, other: &str, remedy: &str) {
        let place = self.value_position(key).unwrap_or(self.place);
        let message = format!("`{key}` cannot be combined with `{other}`; {remedy}");
        self.fault(place, message);
    }

    /// True if a program has given samples in place of the file with this name.
    fn has_samples(&self, name: &str) -> bool {
        let files = self.files();
        files.samples(&files.path(name)).is_some()
    }

    /// Records that the whole table is wrong. `message` follows its name.
    pub(super) fn fault_of_table(&mut self, message: impl Display) -> FaultRecorded {
        self.fault(self.place, format!("{} {message}", self.name))
    }

    fn fault(&mut self, (text, offset): (usize, usize), message: String) -> FaultRecorded {
        self.faults.push(Fault::new(text, offset, message));
        FaultRecorded
    }

    /// Entry of a key; `None` if the file does not give it.
    fn entry(&mut self, key: &str, is_table: bool) -> Option<&'a Value> {
        if !self.known.iter().any(|(known, _)| known == key) {
            self.known.push((key.to_owned(), is_table));
        }
        let own = self.entries.get(key);
        let entry = own.or_else(|| self.default_of(key).map(|(_, value)| value));
        if own.is_none() && entry.is_some() {
            self.taken.push(key.to_owned());
        }
        self.is_partial |= entry.is_none() && self.may_give(&[key]);
        entry
    }

    /// Reads the table with this path and these entries, or an empty one.
    fn descend<T>(
        &mut self,
        key: &str,
        table: Option<(String, &'a Entries)>,
        read: impl Reader<T>,
    ) -> ReadResult<T> {
        let mut table = self.inner(key, table);
        let value = read(&mut table);
        self.close_nested(key, table).and(value)
    }

    /// Opens the table with this path and these entries, or an empty one.
    fn inner(&self, key: &str, table: Option<(String, &'a Entries)>) -> Self {
        let name = match self.name.strip_suffix(']') {
            Some(parent) => format!("{parent}.{key}]"),
            None => format!("[{key}]"),
        };
        let (path, entries) = table.unwrap_or((String::new(), &NO_ENTRIES));
        Self {
            place: self.place_of(&path).unwrap_or(self.place),
            path,
            outer: Some((self.path.clone(), self.entries)),
            description: self.description.as_ref().map(|_| an_object()),
            ..Self::new(name, entries, self.document)
        }
    }

    /// Takes over what a table in this one has recorded. Succeeds if that table is faultless.
    fn close_nested(&mut self, key: &str, mut table: Self) -> ReadResult<()> {
        table.reject_unknown_keys();
        let faultless = table.check_faultless();
        self.faults.append(&mut table.faults);
        self.noted_files.append(&mut table.noted_files);
        self.defaults.extend(table.taken);
        self.is_partial |= table.is_partial;
        for mut group in table.groups.drain(..) {
            group.tables.insert(0, key.to_owned());
            self.groups.push(group);
        }
        self.describe_key(key, || table.description.unwrap_or_default());
        faultless
    }

    fn reject_unknown_keys(&mut self) {
        // After a fault of the whole table no key has been read.
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
                    did_you_mean(key, known.iter().copied()),
                    known.join(", ")
                ),
            };
            let span = self.document.spans.get(&format!("{}/{key}", self.path));
            let (text, offset) = span.map_or((0, 0), |span| (span.text, span.key));
            self.faults.push(Fault::new(text, offset, message));
        }
    }
}

/// Entries of a table that is not given.
static NO_ENTRIES: LazyLock<Entries> = LazyLock::new(Entries::new);

/// Keys of earlier versions: table, key, and message with the replacement.
const REPLACED: [(&str, &str, &str); 2] = [
    (
        "the scenario",
        "spectrum",
        "was removed: `archrock threshold SCENARIO --along TABLE.KEY=FROM..TO:COUNT` finds the threshold for each value of a key",
    ),
    ("[map]", "spread", "is now called `repeat`"),
];
