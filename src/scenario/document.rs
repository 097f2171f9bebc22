//! A parsed TOML text: its values, and the positions of values in the text or in an assignment.

use std::collections::HashMap;
use std::mem;
use std::ops::Range;

use archrock_text::excerpt;
use serde_json::{Map, Value};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::assignment::Assignment;
use super::error::Fault;
use super::files::Files;
use super::toml_text::inline;

/// Position of a value: a range of bytes in the text with this number. Text 0 is the scenario; the others are the assignments, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) text: usize,
    pub(super) range: Range<usize>,
    /// Offset of the key.
    pub(super) key: usize,
}

/// Positions of values by path, such as `/load/0/mass_kg`. A value from a program has no position.
type Spans = HashMap<String, Span>;

/// Text before the digits of a number that is not finite, which JSON does not have; usual texts do not begin with it.
pub(super) const NOT_FINITE: char = '\0';

/// The entries of a table in the order of the file. A number that is not finite is kept as text, and a date, which no key allows, as null.
pub(super) type Entries = Map<String, Value>;

/// Keys of a table that a new value of one of them affects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct KeyGroup {
    /// Names of the tables around the keys, the outermost first; without numbers of list entries.
    pub(super) tables: Vec<String>,
    pub(super) keys: Vec<String>,
    /// True: the keys are alternatives, so each replaces the others. False: each needs all others.
    pub(super) are_alternatives: bool,
}

/// Largest depth of nested values. Deeper values are ignored, because no key has this depth.
const DEEPEST: usize = 16;

/// Kind of a value for messages.
pub(super) fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "a date or time",
        Value::Bool(_) => "a boolean",
        Value::Number(number) if number.is_f64() => "a number with a fraction",
        Value::Number(_) => "a whole number",
        Value::String(text) if text.starts_with(NOT_FINITE) => "not finite",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "a table",
    }
}

/// Parses the values of a text and records their positions.
#[derive(Default)]
struct Parser {
    text: usize,
    spans: Spans,
}

impl Parser {
    fn value(&mut self, path: String, key: usize, value: Spanned<DeValue<'_>>) -> Value {
        let is_deep = path.matches('/').count() > DEEPEST + 1;
        let (range, text) = (value.span(), self.text);
        let parsed = match value.into_inner() {
            DeValue::Array(_) | DeValue::Table(_) if is_deep => Value::Array(Vec::new()),
            DeValue::String(string) => Value::from(string),
            // An integer outside this type is outside the bounds of all counts.
            DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix())
                .map_or_else(
                    |_| whole.as_str().parse().unwrap_or(f64::MAX).into(),
                    Value::from,
                ),
            DeValue::Float(number) => match number.as_str().parse::<f64>() {
                Ok(finite) if finite.is_finite() => Value::from(finite),
                _ => format!("{NOT_FINITE}{}", number.as_str()).into(),
            },
            DeValue::Boolean(value) => Value::from(value),
            DeValue::Datetime(_) => Value::Null,
            DeValue::Array(elements) => {
                let elements = elements.into_iter().enumerate();
                let parsed = elements
                    .map(|(index, element)| self.value(format!("{path}/{index}"), 0, element));
                parsed.collect()
            }
            DeValue::Table(table) => Value::Object(self.table(&path, table)),
        };
        self.spans.insert(path, Span { text, range, key });
        parsed
    }

    fn table(&mut self, path: &str, table: DeTable<'_>) -> Entries {
        let entries = table.into_iter().map(|(key, value)| {
            let (offset, key) = (key.span().start, key.into_inner().into_owned());
            let value = self.value(format!("{path}/{key}"), offset, value);
            (key, value)
        });
        entries.collect()
    }
}

/// Reason why a text gives no document.
pub(super) enum ParseError {
    /// It is something else than a scenario, such as a record.
    NoScenario(Fault),
    /// No part of it is TOML.
    NoToml(Vec<Fault>),
}

impl From<ParseError> for Vec<Fault> {
    fn from(error: ParseError) -> Self {
        match error {
            ParseError::NoScenario(fault) => vec![fault],
            ParseError::NoToml(faults) => faults,
        }
    }
}

/// A TOML text with its assignments.
#[derive(Debug, Default)]
pub(super) struct Document<'a> {
    pub(super) root: Entries,
    pub(super) spans: Spans,
    /// The text, followed by the text of each assignment.
    texts: Vec<&'a str>,
    /// The lines of the text that are not TOML. A key in these lines may have been given, so it is not reported as missing.
    pub(super) unread: String,
    pub(super) faults: Vec<Fault>,
    /// The files that the text may name.
    pub(super) files: Files,
}

impl<'a> Document<'a> {
    /// Parses a text.
    ///
    /// A syntax error hides later errors and causes others. So the first error is recorded, its line is replaced by blanks, and the text is
    /// parsed again.
    ///
    /// # Errors
    /// When the text is no scenario, or no part of it is TOML: an error covers several lines, such as an unclosed bracket, or there are too many errors.
    pub(super) fn parse(text: &'a str, files: &Files) -> Result<Self, ParseError> {
        // Each fault needs another pass over the text.
        const MAX_SYNTAX_FAULTS: usize = 20;
        let mut blanked = text.to_owned();
        let (mut unread, mut faults) = (String::new(), Vec::new());
        while faults.len() < MAX_SYNTAX_FAULTS {
            let (root, errors) = DeTable::parse_recoverable(&blanked);
            // Only the error about too deep nesting has no position.
            let start = |error: &toml::de::Error| error.span().map_or(0, |span| span.start);
            let Some(first) = errors.into_iter().min_by_key(start) else {
                if let Some(fault) = not_a_scenario([text, &blanked], &faults) {
                    return Err(ParseError::NoScenario(fault));
                }
                let mut parser = Parser::default();
                return Ok(Self {
                    root: parser.table("", root.into_inner()),
                    spans: parser.spans,
                    texts: vec![text],
                    unread,
                    faults,
                    files: files.clone(),
                });
            };
            let offset = start(&first);
            let line = faulty_part(&blanked, offset);
            let message = match excerpt(&text[line.clone()]).as_str() {
                "" => format!("not valid TOML: {}", first.message()),
                line => format!("not valid TOML in `{line}`: {}", first.message()),
            };
            faults.push(Fault::new(0, offset, message));
            if blanked[line.clone()].trim().is_empty() {
                break;
            }
            unread.push_str(&text[line.clone()]);
            let blank = " ".repeat(line.len());
            blanked.replace_range(line, &blank);
        }
        match not_a_scenario([text, &blanked], &faults) {
            Some(fault) => Err(ParseError::NoScenario(fault)),
            None => Err(ParseError::NoToml(faults)),
        }
    }

    /// Makes a document of JSON values from a program.
    pub(super) fn of_json(root: Value, files: &Files) -> Self {
        let Value::Object(root) = root else {
            return Self::default();
        };
        Self {
            root,
            files: files.clone(),
            ..Self::default()
        }
    }

    /// Applies all assignments, and returns the paths of the keys that they set. A fault is recorded if a name is not an entry of a list.
    pub(super) fn assign(&mut self, assignments: &'a [Assignment]) -> Vec<String> {
        let mut paths = Vec::new();
        for assignment in assignments {
            self.texts.push(&assignment.text);
            let (text, spans) = (self.texts.len() - 1, Spans::new());
            let (value, _) = DeTable::parse_recoverable(&assignment.text);
            let mut parser = Parser { text, spans };
            let value = Value::Object(parser.table("", value.into_inner()));
            match self.insert(value, assignment.depth) {
                Ok([path, new_path, key_path]) => {
                    let spans = parser.spans.into_iter().filter_map(|(inner, span)| {
                        let inner = inner.strip_prefix(&new_path)?;
                        Some((format!("{path}{inner}"), span))
                    });
                    self.spans.extend(spans);
                    paths.push(key_path);
                }
                Err(message) => self.faults.push(Fault::new(text, 0, message)),
            }
        }
        paths
    }

    /// Inserts the only value of `new` at the depth of `depth` tables, as [`replace`]. Returns the paths of the replaced value, of its replacement
    /// in `new`, and of the key.
    ///
    /// # Errors
    /// When a name is not an entry of a list.
    pub(super) fn insert(&mut self, new: Value, depth: usize) -> Result<[String; 3], String> {
        let mut names = vec![];
        let mut value = &new;
        while names.len() < depth
            && let Some((name, inner)) = value.as_object().and_then(|table| table.iter().next())
        {
            names.push(name.clone());
            value = inner;
        }
        let mut root = Value::Object(mem::take(&mut self.root));
        let replaced = replace(&mut root, new, depth);
        if let Value::Object(root) = root {
            self.root = root;
        }
        let [path, new_path] = replaced?;
        // The tables of the key that did not exist are within the replacement.
        let new_names = names.iter().skip(new_path.matches('/').count());
        let inner: String = new_names.map(|name| format!("/{name}")).collect();
        let key_path = format!("{path}{inner}");
        Ok([path, new_path, key_path])
    }

    /// Text of a value for messages.
    pub(super) fn quote(&self, path: &str, value: &Value) -> String {
        // The text of a list lacks the entries that assignments have replaced.
        let span = self.spans.get(path);
        match span.filter(|_| self.assigned(path).is_none()) {
            Some(span) => excerpt(&self.texts[span.text][span.range.clone()]),
            None => excerpt(&inline(value)),
        }
    }

    /// True if a value is an array of tables `[[key]]`. The span of such a value is the first header. An array of tables from a program counts as
    /// one.
    pub(super) fn is_array_of_tables(&self, path: &str, value: &Value) -> bool {
        let Some(span) = self.spans.get(path) else {
            let elements = value.as_array();
            return elements.is_some_and(|elements| elements.iter().all(Value::is_object));
        };
        let given = &self.texts[span.text][span.range.clone()];
        given.starts_with("[[") && value[0].is_object()
    }

    /// Position of the last value inside another one that an assignment replaces; `None` if all values are from the text.
    pub(super) fn assigned(&self, path: &str) -> Option<(usize, usize)> {
        let inside = format!("{path}/");
        let spans = self
            .spans
            .iter()
            .filter(|(path, _)| path.starts_with(&inside));
        let places = spans.map(|(_, span)| (span.text, span.range.start));
        places.max().filter(|(text, _)| *text > 0)
    }
}

/// True unless a text is something else than a scenario, such as a record.
pub(super) fn is_scenario(text: &str) -> bool {
    let parsed = Document::parse(text, &Files::default());
    !matches!(parsed, Err(ParseError::NoScenario(_)))
}

/// Single fault of a text that is not a scenario, such as a record: several lines are not valid, or none sets a key, and no line begins a
/// table. `None` for other texts.
fn not_a_scenario([text, blanked]: [&str; 2], faults: &[Fault]) -> Option<Fault> {
    const FEW: usize = 2;
    let has_keys = text.contains('=');
    let first = faults.first().filter(|_| faults.len() > FEW || !has_keys)?;
    let mut lines = blanked.lines();
    if lines.any(|line| line.trim_start().starts_with('[')) {
        return None;
    }
    let message = format!(
        "this is no scenario: {}. If it is a record, name it as `file` in [ground.record] of a scenario; if its extension \
         is unknown, give `format` as well, such as format=csv",
        first.message
    );
    Some(Fault::new(0, first.offset, message))
}

/// Line at `offset`. If it is the header of a table, returns the whole table: its keys would otherwise belong to the previous table.
fn faulty_part(text: &str, offset: usize) -> Range<usize> {
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

/// Replaces a value by the only value of `new` at the depth of `depth` tables. Entries of lists are counted from 1. Returns the paths of the
/// value and of `new`.
fn replace(mut known: &mut Value, mut new: Value, depth: usize) -> Result<[String; 2], String> {
    let [mut path, mut new_path] = [String::new(), String::new()];
    for _ in 0..depth {
        let only = new.as_object_mut().and_then(|new| new.iter_mut().next());
        let Some((key, value)) = only else {
            break;
        };
        match known {
            Value::Object(entries) => {
                let inner = value.as_object().and_then(|inner| inner.keys().next());
                let entry = inner.filter(|inner| inner.parse::<usize>().is_ok());
                if let Some(entry) = entry.filter(|_| !entries.contains_key(key)) {
                    let name = format!("{path}/{key}")[1..].replace('/', ".");
                    return Err(format!(
                        "`{name}.{entry}` is an entry of a list, and the scenario has no `{name}`; give the list, as [[{name}]] in the file"
                    ));
                }
                path += &format!("/{key}");
                known = entries.entry(key).or_insert(Value::Null);
            }
            Value::Array(entries) => {
                let count = entries.len();
                let index = key
                    .parse()
                    .ok()
                    .and_then(|place: usize| place.checked_sub(1));
                let Some(index) = index.filter(|index| *index < count) else {
                    let name = path.rsplit('/').next().unwrap_or_default();
                    return Err(format!(
                        "`{name}` is a list, whose entries are `{name}.1` to `{name}.{count}`: `{name}.{key}` is none"
                    ));
                };
                path += &format!("/{index}");
                known = &mut entries[index];
            }
            _ => break,
        }
        new_path += &format!("/{key}");
        new = value.take();
    }
    *known = new;
    Ok([path, new_path])
}
