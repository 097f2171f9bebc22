//! Reads the tables of a TOML text so that every error is found and keeps its place.
//!
//! Nothing here knows the keys of a scenario; each table is read in the module of its subject.

use std::fmt;
use std::ops::{Bound, RangeBounds, RangeInclusive};
use std::path::Path;

use serde::Deserialize as _;
use serde_json::Value;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

use super::assignment::{Appended, Assignment};
use super::error::{Fault, excerpt};
use super::input_file::InputFile;
use crate::argument::short;

/// Stands for a value that could not be read; the reason is recorded as a [`Fault`].
///
/// A reader asks for all its keys before one error makes it give up (with `?`), so that all keys are checked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reported;

/// A value, or [`Reported`] if its fault has been recorded.
pub(super) type Reading<T> = Result<T, Reported>;

/// Reads a whole TOML text with `read`, after replacing values as `set` says, or returns everything that is wrong.
/// Faults of assignments have offsets [behind](Appended) the text.
pub(super) fn read_text<T>(
    text: &str,
    set: &[Assignment],
    read: impl FnOnce(&mut Table<'_>) -> Reading<T>,
) -> Result<T, Vec<Fault>> {
    let mut legible = Legible::of(text);
    if let Some(fault) = legible.is_another_file() {
        return Err(vec![fault]);
    }
    if !legible.is_toml {
        return Err(legible.faults);
    }
    let behind = Appended::new(text, set);
    legible.text += &behind.text();
    let padded = behind.padded();
    let (root, _) = DeTable::parse_recoverable(&legible.text[..text.len()]);
    let mut root = root.into_inner();
    let faults = Appended::assign(&mut root, &padded);
    let mut table = Table {
        name: "the scenario".to_owned(),
        offset: 0,
        entries: &root,
        legible: &legible,
        known: Vec::new(),
        faults,
        files: Vec::new(),
    };
    let value = read(&mut table);
    table.reject_unknown_keys();
    let mut faults = table.faults;
    match value {
        Ok(value) if faults.is_empty() && legible.faults.is_empty() => Ok(value),
        _ => {
            faults.extend(legible.faults);
            Err(faults)
        }
    }
}

/// The part of a text that is TOML.
///
/// A syntax error hides what follows it and causes other errors. So the first error is recorded, its line is
/// blanked out, and the rest is parsed again.
struct Legible {
    /// The text with the faulty lines blanked out, so that offsets are those of the original.
    text: String,
    /// The blanked-out text. A key that occurs in it may have been given, so it is not reported as missing.
    unread: String,
    /// Whether `text` is now valid TOML. It is not if an error spans several lines, such as an unclosed
    /// bracket, or if there are too many errors.
    is_toml: bool,
    faults: Vec<Fault>,
}

impl Legible {
    fn of(text: &str) -> Self {
        // Each fault costs one pass over the text.
        const MAX_SYNTAX_FAULTS: usize = 20;
        let mut legible = Self {
            text: text.to_owned(),
            unread: String::new(),
            is_toml: false,
            faults: Vec::new(),
        };
        while legible.faults.len() < MAX_SYNTAX_FAULTS {
            let (_, errors) = DeTable::parse_recoverable(&legible.text);
            // Only the error about keys that are nested too deeply has no place.
            let start = |error: &toml::de::Error| error.span().map_or(0, |span| span.start);
            let Some(first) = errors.into_iter().min_by_key(start) else {
                legible.is_toml = true;
                break;
            };
            let offset = start(&first);
            let line = faulty_part(&legible.text, offset);
            legible.faults.push(Fault {
                offset,
                of_file: false,
                message: match excerpt(&text[line.clone()]).as_str() {
                    "" => format!("not valid TOML: {}", first.message()),
                    line => format!("not valid TOML in `{line}`: {}", first.message()),
                },
            });
            if legible.text[line.clone()].trim().is_empty() {
                break;
            }
            legible.unread.push_str(&text[line.clone()]);
            let blank = " ".repeat(line.len());
            legible.text.replace_range(line, &blank);
        }
        legible
    }

    /// The single fault of a text that is not a scenario at all, such as a record: several lines are not valid, and no
    /// line begins a table.
    fn is_another_file(&self) -> Option<Fault> {
        const FEW: usize = 2;
        let first = self.faults.first()?;
        let mut lines = self.text.lines();
        if self.faults.len() <= FEW || lines.any(|line| line.trim_start().starts_with('[')) {
            return None;
        }
        Some(Fault {
            offset: first.offset,
            of_file: false,
            message: format!(
                "this is no scenario: {}. If it is a record, name it as `file` in [ground.record] of a scenario",
                first.message
            ),
        })
    }
}

/// The line around `offset`. If it is the header of a table, the whole table: otherwise its keys
/// would be taken for keys of the table before.
fn faulty_part(text: &str, offset: usize) -> std::ops::Range<usize> {
    let bytes = text.as_bytes();
    let start = bytes[..offset.min(bytes.len())]
        .iter()
        .rposition(|&b| b == b'\n')
        .map_or(0, |i| i + 1);
    let end_of_line = |start: usize| text[start..].find('\n').map_or(text.len(), |i| start + i);
    let is_header = |start: usize| {
        text[start..]
            .trim_start_matches([' ', '\t'])
            .starts_with('[')
    };
    let mut end = end_of_line(start);
    if is_header(start) {
        while end < text.len() && !is_header(end + 1) {
            end = end_of_line(end + 1);
        }
    }
    start..end
}

/// A table of the file, and the faults found in it.
///
/// It remembers the keys it was asked for: these are the allowed keys.
pub(super) struct Table<'a> {
    /// Its name in messages.
    name: String,
    /// Offset of its header.
    offset: usize,
    entries: &'a DeTable<'a>,
    legible: &'a Legible,
    known: Vec<String>,
    faults: Vec<Fault>,
    files: Vec<InputFile>,
}

impl<'a> Table<'a> {
    /// Notes a file that the scenario names and that has been read.
    pub(super) fn note_file(&mut self, folder: &Path, file: &str) {
        if let Ok(bytes) = std::fs::read(folder.join(file)) {
            self.files.push(InputFile::new(file, &bytes));
        }
    }

    /// The files noted so far, of this table and those in it.
    pub(super) fn noted_files(&mut self) -> Vec<InputFile> {
        std::mem::take(&mut self.files)
    }

    /// Gives it another name in messages.
    pub(super) fn rename(&mut self, name: &str) {
        name.clone_into(&mut self.name);
    }

    /// The value of a key that must be given.
    pub(super) fn required<R: Rule>(&mut self, key: &str, rule: &R) -> Reading<R::Value> {
        match self.optional(key, rule)? {
            Some(value) => Ok(value),
            None => {
                let message = format!("{} lacks `{key}`: give {}", self.name, rule.allowed());
                Err(self.fault(self.offset, message))
            }
        }
    }

    /// The value of a key that can be left out, or `default`.
    pub(super) fn or<R: Rule>(
        &mut self,
        key: &str,
        rule: &R,
        default: R::Value,
    ) -> Reading<R::Value> {
        Ok(self.optional(key, rule)?.unwrap_or(default))
    }

    /// The value of a key that can be left out.
    pub(super) fn optional<R: Rule>(&mut self, key: &str, rule: &R) -> Reading<Option<R::Value>> {
        let Some(entry) = self.entry(key)? else {
            return Ok(None);
        };
        match rule.read(entry.get_ref()) {
            Ok(value) => Ok(Some(value)),
            Err(wrong) => Err(self.wrong(key, format!("{wrong}; must be {}", rule.allowed()))),
        }
    }

    /// The table of that name as `read` reads it, if given.
    pub(super) fn table<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&mut Table<'_>) -> Reading<T>,
    ) -> Reading<Option<T>> {
        let Some(entry) = self.entry(key)? else {
            return Ok(None);
        };
        let DeValue::Table(entries) = entry.get_ref() else {
            let wrong = format!("is {}; must be a table", kind_of(entry.get_ref()));
            return Err(self.wrong(key, wrong));
        };
        self.descend(key, entry.span().start, entries, read)
            .map(Some)
    }

    /// The tables of an array `[[key]]`, each read by `read`; empty if not given.
    pub(super) fn tables<T>(
        &mut self,
        key: &str,
        read: impl Fn(&mut Table<'_>) -> Reading<T>,
    ) -> Reading<Vec<T>> {
        let Some(entry) = self.entry(key)? else {
            return Ok(Vec::new());
        };
        let DeValue::Array(elements) = entry.get_ref() else {
            let wrong = format!(
                "is {}; must be an array of tables: write [[{key}]]",
                kind_of(entry.get_ref())
            );
            return Err(self.wrong(key, wrong));
        };
        let mut tables = Vec::new();
        for (index, element) in elements.iter().enumerate() {
            tables.push(match element.get_ref() {
                DeValue::Table(entries) => self.descend(key, element.span().start, entries, &read),
                other => {
                    let wrong = format!("is {}; must be a table", kind_of(other));
                    Err(self.wrong_element(key, index, wrong))
                }
            });
        }
        tables.into_iter().collect()
    }

    /// The table of that name as `read` reads it; if not given, `read` gets an empty table.
    pub(super) fn table_or_defaults<T>(
        &mut self,
        key: &str,
        read: impl Fn(&mut Table<'_>) -> Reading<T>,
    ) -> Reading<T> {
        match self.table(key, &read)? {
            Some(value) => Ok(value),
            None => self.descend(key, self.offset, &DeTable::new(), read),
        }
    }

    /// The value of the only key that is given, out of several that exclude each other.
    pub(super) fn exactly_one<T>(
        &mut self,
        what: &str,
        candidates: Vec<(&'static str, Reading<Option<T>>)>,
    ) -> Reading<T> {
        let keys: Vec<_> = candidates.iter().map(|(key, _)| *key).collect();
        let mut given: Vec<_> = keys
            .iter()
            .filter_map(|key| Some((self.entries.get(*key)?.span().start, *key)))
            .collect();
        given.sort_unstable();
        let rule = format!("exactly one of the {what} {}", keys.join(", "));
        match given.as_slice() {
            // The line of a candidate could not be read.
            [] if candidates.iter().any(|(_, value)| value.is_err()) => return Err(Reported),
            [] => {
                let message = format!("{} needs {rule}", self.name);
                return Err(self.fault(self.offset, message));
            }
            [_] => {}
            [(_, first), others @ ..] => {
                for (offset, key) in others {
                    let message = format!("`{key}` cannot be combined with `{first}`; give {rule}");
                    self.fault(*offset, message);
                }
                return Err(Reported);
            }
        }
        // If there is no value, the given key is faulty.
        candidates
            .into_iter()
            .find_map(|(_, value)| value.ok().flatten())
            .ok_or(Reported)
    }

    /// The keys that name a value of another table, such as `"arch.depth_m"`, in the order of the file.
    pub(super) fn keys_of_other_tables(&self) -> Vec<String> {
        let keys = self.entries.keys().map(|key| key.get_ref().as_ref());
        let keys = keys.filter(|key: &&str| key.contains('.'));
        keys.map(str::to_owned).collect()
    }

    /// A value as the file gives it, if it does.
    pub(super) fn as_given(&self, key: &str) -> Option<Value> {
        let given = ValueDeserializer::from(self.entries.get(key)?.clone());
        Value::deserialize(given).ok()
    }

    /// Whether the file gives a table for the key.
    pub(super) fn gives_table(&self, key: &str) -> bool {
        let entry = self.entries.get(key);
        entry.is_some_and(|entry| matches!(entry.get_ref(), DeValue::Table(_)))
    }

    /// Whether the file gives the key.
    pub(super) fn gives(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// How many faults were found so far.
    pub(super) fn faults(&self) -> usize {
        self.faults.len()
    }

    /// Takes back the faults found since there were so many, if all of them are faults of files that the text names; false where they are not.
    pub(super) fn forgives_files(&mut self, since: usize) -> bool {
        let forgives = self.faults[since..].iter().all(|fault| fault.of_file);
        if forgives {
            self.faults.truncate(since);
        }
        forgives
    }

    /// Records that the file which `key` names is missing or wrong: `message` continues the key and its value.
    pub(super) fn wrong_file(&mut self, key: &str, message: impl fmt::Display) -> Reported {
        let reported = self.wrong(key, message);
        if let Some(fault) = self.faults.last_mut() {
            fault.of_file = true;
        }
        reported
    }

    /// Records that the given value of `key` is wrong: `message` continues the key and its value.
    pub(super) fn wrong(&mut self, key: &str, message: impl fmt::Display) -> Reported {
        self.wrong_entry(self.entries.get(key), key, message)
    }

    /// The same for a value in a table inside this one.
    pub(super) fn wrong_in(
        &mut self,
        table: &str,
        key: &str,
        message: impl fmt::Display,
    ) -> Reported {
        let outer = self.entries.get(table);
        let entry = outer.and_then(|outer| outer.get_ref().as_table()?.get(key));
        match (outer, entry) {
            // What is not given is missing in its table.
            (Some(outer), None) => self.fault(outer.span().start, format!("`{key}` {message}")),
            _ => self.wrong_entry(entry, key, message),
        }
    }

    /// The same for a value in nested tables inside this one. If the innermost table does not give it, the table
    /// around it is used.
    pub(super) fn wrong_within(
        &mut self,
        tables: &[&str],
        key: &str,
        message: impl fmt::Display,
    ) -> Reported {
        let mut entries = Some(self.entries);
        let mut entry = None;
        for table in tables {
            let inner = entries.and_then(|entries| entries.get(*table));
            entries = inner.and_then(|inner| inner.get_ref().as_table());
            entry = entries.and_then(|entries| entries.get(key)).or(entry);
        }
        self.wrong_entry(entry, key, message)
    }

    /// Whether a table inside this one gives the key.
    pub(super) fn gives_in(&self, table: &str, key: &str) -> bool {
        let inner = self.entries.get(table).map(Spanned::get_ref);
        inner.is_some_and(|inner| {
            inner
                .as_table()
                .is_some_and(|inner| inner.contains_key(key))
        })
    }

    fn wrong_entry(
        &mut self,
        entry: Option<&Spanned<DeValue<'_>>>,
        key: &str,
        message: impl fmt::Display,
    ) -> Reported {
        let Some(entry) = entry else {
            return self.fault(self.offset, format!("`{key}` {message}"));
        };
        let span = entry.span();
        let message = match entry.get_ref() {
            DeValue::Table(_) => format!("table `{key}` {message}"),
            // The span of an array of tables is the first of their headers.
            DeValue::Array(_) if self.legible.text[span.clone()] == format!("[[{key}]]") => {
                format!("`[[{key}]]` {message}")
            }
            _ => {
                let value = excerpt(&self.legible.text[span.clone()]);
                format!("`{key} = {value}` {message}")
            }
        };
        self.fault(span.start, message)
    }

    /// Records that an element of the array given for `key` is wrong; elements are counted from 0. A
    /// value that is not an array counts as its only element.
    pub(super) fn wrong_element(
        &mut self,
        key: &str,
        index: usize,
        message: impl fmt::Display,
    ) -> Reported {
        let array = self.entries.get(key).map(Spanned::get_ref);
        let Some(element) = array.and_then(|array| array.as_array()?.get(index)) else {
            return self.wrong(key, message);
        };
        let span = element.span();
        let value = excerpt(&self.legible.text[span.clone()]);
        self.fault(span.start, format!("`{value}` in `{key}` {message}"))
    }

    /// Records that the whole table is wrong: `message` continues its name.
    pub(super) fn wrong_itself(&mut self, message: impl fmt::Display) -> Reported {
        self.fault(self.offset, format!("{} {message}", self.name))
    }

    fn fault(&mut self, offset: usize, message: String) -> Reported {
        self.faults.push(Fault {
            offset,
            message,
            of_file: false,
        });
        Reported
    }

    fn entry(&mut self, key: &str) -> Reading<Option<&'a Spanned<DeValue<'a>>>> {
        if !self.known.iter().any(|known| known == key) {
            self.known.push(key.to_owned());
        }
        match self.entries.get(key) {
            None if self.legible.unread.contains(key) => Err(Reported),
            entry => Ok(entry),
        }
    }

    fn descend<T>(
        &mut self,
        key: &str,
        offset: usize,
        entries: &DeTable<'_>,
        read: impl FnOnce(&mut Table<'_>) -> Reading<T>,
    ) -> Reading<T> {
        let mut table = Table {
            name: match self.name.strip_suffix(']') {
                Some(parent) => format!("{parent}.{key}]"),
                None => format!("[{key}]"),
            },
            offset,
            entries,
            legible: self.legible,
            known: Vec::new(),
            faults: Vec::new(),
            files: Vec::new(),
        };
        let value = read(&mut table);
        table.reject_unknown_keys();
        self.faults.append(&mut table.faults);
        self.files.append(&mut table.files);
        value
    }

    fn reject_unknown_keys(&mut self) {
        // A reader that refused the whole table has not asked for its keys.
        if self.known.is_empty() && !self.faults.is_empty() {
            return;
        }
        for key in self.entries.keys() {
            let (name, offset) = (key.get_ref().as_ref(), key.span().start);
            if !self.known.iter().any(|known| known == name) {
                let mut replaced = REPLACED.iter();
                let replaced = replaced.find(|(table, key, _)| self.name == *table && name == *key);
                let message = match replaced {
                    Some((_, key, successor)) => format!("`{key}` in {} {successor}", self.name),
                    None => format!(
                        "unknown key `{}` in {}{}; known keys: {}",
                        excerpt(name),
                        self.name,
                        did_you_mean(name, &self.known),
                        self.known.join(", ")
                    ),
                };
                self.faults.push(Fault {
                    offset,
                    message,
                    of_file: false,
                });
            }
        }
    }
}

/// Keys of earlier versions, by their table, and what replaces them.
const REPLACED: [(&str, &str, &str); 2] = [
    (
        "the scenario",
        "spectrum",
        "was removed: `archrock threshold SCENARIO --along TABLE.KEY=FROM..TO:COUNT` finds the threshold for each value of a key",
    ),
    ("[map]", "spread", "is now called `repeat`"),
];

/// A rule for a value.
pub(super) trait Rule {
    /// The type it is read as.
    type Value;
    /// The rule in words.
    fn allowed(&self) -> String;
    /// The value, or what is wrong with it.
    fn read(&self, value: &DeValue<'_>) -> Result<Self::Value, String>;
}

/// A finite number between two bounds. Whole numbers need no decimal point.
pub(super) struct Number(pub(super) Bound<f64>, pub(super) Bound<f64>);

impl Number {
    /// The numbers of a range, ends included.
    pub(super) const fn within(range: &RangeInclusive<f64>) -> Self {
        Self(
            Bound::Included(*range.start()),
            Bound::Included(*range.end()),
        )
    }

    pub(super) fn contains(&self, x: f64) -> bool {
        (self.0, self.1).contains(&x)
    }
}

impl Rule for Number {
    type Value = f64;

    fn allowed(&self) -> String {
        if let (Bound::Included(low), Bound::Included(high)) = (self.0, self.1) {
            return format!("a number from {} to {}", short(low), short(high));
        }
        let bounds = [
            match self.0 {
                Bound::Included(low) => Some(format!("of at least {}", short(low))),
                Bound::Excluded(low) => Some(format!("above {}", short(low))),
                Bound::Unbounded => None,
            },
            match self.1 {
                Bound::Included(high) => Some(format!("at most {}", short(high))),
                Bound::Excluded(high) => Some(format!("below {}", short(high))),
                Bound::Unbounded => None,
            },
        ];
        let bounds: Vec<_> = bounds.into_iter().flatten().collect();
        format!("a number {}", bounds.join(" and "))
    }

    fn read(&self, value: &DeValue<'_>) -> Result<f64, String> {
        let x = match value {
            DeValue::Float(float) => float.as_str().parse().ok(),
            DeValue::Integer(whole) => i128::from_str_radix(whole.as_str(), whole.radix())
                .ok()
                .map(|i| i as f64),
            _ => return Err(format!("is {}", kind_of(value))),
        };
        match x {
            Some(x) if !f64::is_finite(x) => Err("is not finite".to_owned()),
            Some(x) if self.contains(x) => Ok(x),
            _ => Err("is out of range".to_owned()),
        }
    }
}

/// An array whose elements follow a rule.
pub(super) struct List<'a, R>(pub(super) &'a R);

impl<R: Rule> Rule for List<'_, R> {
    type Value = Vec<R::Value>;

    fn allowed(&self) -> String {
        format!("an array, each element {}", self.0.allowed())
    }

    fn read(&self, value: &DeValue<'_>) -> Result<Self::Value, String> {
        let DeValue::Array(elements) = value else {
            return Err(format!("is {}", kind_of(value)));
        };
        let read = |(index, element): (usize, &Spanned<DeValue<'_>>)| {
            let place = index + 1;
            let wrong = |wrong| format!("has an element (number {place}) that {wrong}");
            self.0.read(element.get_ref()).map_err(wrong)
        };
        elements.iter().enumerate().map(read).collect()
    }
}

/// Values that follow a rule: a single one, or an array of at least one.
pub(super) struct OneOrMore<'a, R>(pub(super) &'a R);

impl<R: Rule> Rule for OneOrMore<'_, R> {
    type Value = Vec<R::Value>;

    fn allowed(&self) -> String {
        format!("{} or an array of at least one", self.0.allowed())
    }

    fn read(&self, value: &DeValue<'_>) -> Result<Self::Value, String> {
        match value {
            DeValue::Array(elements) if elements.is_empty() => Err("is empty".to_owned()),
            DeValue::Array(_) => List(self.0).read(value),
            _ => Ok(vec![self.0.read(value)?]),
        }
    }
}

/// True or false.
pub(super) struct Switch;

impl Rule for Switch {
    type Value = bool;

    fn allowed(&self) -> String {
        "true or false".to_owned()
    }

    fn read(&self, value: &DeValue<'_>) -> Result<bool, String> {
        match value {
            DeValue::Boolean(value) => Ok(*value),
            _ => Err(format!("is {}", kind_of(value))),
        }
    }
}

/// A whole number in a range.
pub(super) struct Count {
    pub(super) range: RangeInclusive<usize>,
    /// Why the range begins where it does.
    pub(super) why: &'static str,
}

impl Rule for Count {
    type Value = usize;

    fn allowed(&self) -> String {
        let (low, high) = (self.range.start(), self.range.end());
        format!("a whole number from {low} ({}) to {high}", self.why)
    }

    fn read(&self, value: &DeValue<'_>) -> Result<usize, String> {
        let DeValue::Integer(whole) = value else {
            return Err(format!("is {}", kind_of(value)));
        };
        usize::from_str_radix(whole.as_str(), whole.radix())
            .ok()
            .filter(|n| self.range.contains(n))
            .ok_or_else(|| "is out of range".to_owned())
    }
}

/// Any string.
pub(super) struct Text;

impl Rule for Text {
    type Value = String;

    fn allowed(&self) -> String {
        "a string".to_owned()
    }

    fn read(&self, value: &DeValue<'_>) -> Result<String, String> {
        match value {
            DeValue::String(text) => Ok(text.to_string()),
            _ => Err(format!("is {}", kind_of(value))),
        }
    }
}

/// One of several things, each by its name.
pub(super) struct OneOf<'a, T> {
    pub(super) all: &'a [T],
    pub(super) name: fn(T) -> &'static str,
}

impl<T: Copy> OneOf<'_, T> {
    fn names(&self) -> Vec<&'static str> {
        self.all.iter().map(|&one| (self.name)(one)).collect()
    }
}

impl<T: Copy> Rule for OneOf<'_, T> {
    type Value = T;

    fn allowed(&self) -> String {
        let names: Vec<_> = self.names().iter().map(|s| format!("{s:?}")).collect();
        format!("one of {}", names.join(", "))
    }

    fn read(&self, value: &DeValue<'_>) -> Result<T, String> {
        let DeValue::String(text) = value else {
            return Err(format!("is {}", kind_of(value)));
        };
        self.all
            .iter()
            .copied()
            .find(|&one| (self.name)(one) == text)
            .ok_or_else(|| format!("is unknown{}", did_you_mean(text, &self.names())))
    }
}

fn kind_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number with a fraction",
        DeValue::Boolean(_) => "a boolean",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    }
}

/// Suggests the known name nearest to `name`; empty when none is near.
fn did_you_mean(name: &str, known: &[impl AsRef<str>]) -> String {
    // At least half the name in common: enough to match a forgotten unit or prefix, too much for a chance match.
    const NEAR: f64 = 0.5;
    let name = excerpt(name);
    known
        .iter()
        .map(AsRef::as_ref)
        .map(|known: &str| (strsim::normalized_damerau_levenshtein(&name, known), known))
        .filter(|(likeness, _)| *likeness > NEAR)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, known)| format!(" (did you mean `{known}`?)"))
        .unwrap_or_default()
}
