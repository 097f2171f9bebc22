//! A parsed TOML text: its values with their places, whether they come from the text, an assignment or a program.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde_json::Value;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::assignment::Assignment;
use super::error::{Fault, excerpt};
use super::toml_text::inline;

/// The place of a value: bytes of the text with this number. Text 0 is the scenario's; the others are those of the assignments, in
/// their order. A value without text has an empty range.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) text: usize,
    pub(super) range: Range<usize>,
}

/// A value with its place.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) value: Node,
    pub(super) span: Span,
}

/// The entries of a table in the order of the file, each with its key and the offset of that key.
pub(super) type Tree = Vec<(String, usize, Entry)>;

/// Values that lie deeper than this are dropped: no key is so deep.
const DEEPEST: usize = 16;

/// A TOML value.
#[derive(Clone, Debug)]
pub(super) enum Node {
    Text(String),
    Whole(i128),
    Number(f64),
    Boolean(bool),
    /// A date or a time, which no key takes.
    Date(String),
    Array(Vec<Entry>),
    Table(Tree),
}

/// The entry of a table with this key.
pub(super) fn entry<'t>(tree: &'t Tree, key: &str) -> Option<&'t Entry> {
    let mut entries = tree.iter();
    entries.find_map(|(name, _, entry)| (name == key).then_some(entry))
}

impl Entry {
    fn parsed(value: Spanned<DeValue<'_>>, text: usize, depth: usize) -> Self {
        let range = value.span();
        Self {
            value: Node::parsed(value.into_inner(), text, depth + 1),
            span: Span { text, range },
        }
    }

    /// A value that a program gives.
    pub(super) fn given(value: Node) -> Self {
        Self {
            value,
            span: Span::default(),
        }
    }

    /// The table that it is.
    pub(super) fn as_table(&self) -> Option<&Tree> {
        match &self.value {
            Node::Table(tree) => Some(tree),
            _ => None,
        }
    }
}

impl Node {
    fn parsed(value: DeValue<'_>, text: usize, depth: usize) -> Self {
        match value {
            DeValue::Array(_) | DeValue::Table(_) if depth > DEEPEST => Self::Array(Vec::new()),
            DeValue::String(string) => Self::Text(string.into_owned()),
            // A number beyond this type is beyond all bounds as well.
            DeValue::Integer(whole) => Self::Whole(
                i128::from_str_radix(whole.as_str(), whole.radix()).unwrap_or(i128::MAX),
            ),
            DeValue::Float(number) => Self::Number(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(value) => Self::Boolean(value),
            DeValue::Datetime(date) => Self::Date(date.to_string()),
            DeValue::Array(elements) => {
                let elements = elements.into_iter();
                Self::Array(
                    elements
                        .map(|one| Entry::parsed(one, text, depth))
                        .collect(),
                )
            }
            DeValue::Table(table) => Self::Table(parsed_tree(table, text, depth)),
        }
    }

    /// A number; whole numbers may stand for counts.
    pub(super) fn of_number(number: f64) -> Self {
        if number.fract() == 0.0 && number.abs() < 1e15 {
            #[expect(clippy::cast_possible_truncation, reason = "a whole number below 1e15")]
            return Self::Whole(number as i128);
        }
        Self::Number(number)
    }

    /// The value of a scenario written as JSON.
    pub(super) fn of_json(value: &Value) -> Self {
        match value {
            Value::Null => Self::Table(Tree::new()),
            Value::Bool(value) => Self::Boolean(*value),
            Value::Number(number) => match number.as_i64() {
                Some(whole) => Self::Whole(whole.into()),
                None => Self::Number(number.as_f64().unwrap_or(f64::NAN)),
            },
            Value::String(text) => Self::Text(text.clone()),
            Value::Array(elements) => {
                let elements = elements.iter().map(Self::of_json);
                Self::Array(elements.map(Entry::given).collect())
            }
            Value::Object(table) => {
                let entries = table.iter();
                let entries = entries
                    .map(|(key, value)| (key.clone(), 0, Entry::given(Self::of_json(value))));
                Self::Table(entries.collect())
            }
        }
    }

    /// The value as JSON.
    pub(super) fn to_json(&self) -> Value {
        match self {
            Self::Text(text) | Self::Date(text) => Value::from(text.as_str()),
            #[expect(
                clippy::cast_possible_truncation,
                reason = "beyond this type it is an error"
            )]
            Self::Whole(whole) => Value::from(*whole as i64),
            Self::Number(number) => Value::from(*number),
            Self::Boolean(value) => Value::from(*value),
            Self::Array(elements) => elements.iter().map(|one| one.value.to_json()).collect(),
            Self::Table(tree) => {
                let entries = tree.iter();
                let entries = entries.map(|(key, _, entry)| (key.clone(), entry.value.to_json()));
                Value::Object(entries.collect())
            }
        }
    }

    /// The kind of the value in messages.
    pub(super) const fn kind(&self) -> &'static str {
        match self {
            Self::Text(_) => "a string",
            Self::Whole(_) => "a whole number",
            Self::Number(_) => "a number with a fraction",
            Self::Boolean(_) => "a boolean",
            Self::Date(_) => "a date or time",
            Self::Array(_) => "an array",
            Self::Table(_) => "a table",
        }
    }
}

impl fmt::Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&inline(&self.to_json()))
    }
}

fn parsed_tree(table: DeTable<'_>, text: usize, depth: usize) -> Tree {
    let entries = table.into_iter();
    let entries = entries.map(|(key, value)| {
        let offset = key.span().start;
        (
            key.into_inner().into_owned(),
            offset,
            Entry::parsed(value, text, depth),
        )
    });
    entries.collect()
}

/// A TOML text with assignments into it.
#[derive(Debug, Default)]
pub(super) struct Document<'a> {
    pub(super) root: Tree,
    /// The text, and then that of each assignment.
    texts: Vec<&'a str>,
    /// The parts of the text that are not TOML. A key that occurs there may have been given, so it is not reported as missing.
    pub(super) unread: String,
    pub(super) faults: Vec<Fault>,
    /// The folder to which the names of files are relative.
    pub(super) folder: PathBuf,
}

impl<'a> Document<'a> {
    /// Parses a text.
    ///
    /// A syntax error hides what follows it and causes other errors. So the first error is recorded, its line is blanked out, and the rest
    /// is parsed again.
    ///
    /// # Errors
    /// If no part of the text is TOML: an error spans several lines, such as an unclosed bracket, or there are too many.
    pub(super) fn parse(text: &'a str, folder: &Path) -> Result<Self, Vec<Fault>> {
        // Each fault costs one pass over the text.
        const MAX_SYNTAX_FAULTS: usize = 20;
        let mut legible = text.to_owned();
        let (mut unread, mut faults) = (String::new(), Vec::new());
        while faults.len() < MAX_SYNTAX_FAULTS {
            let (root, errors) = DeTable::parse_recoverable(&legible);
            // Only the error about keys that are nested too deeply has no place.
            let start = |error: &toml::de::Error| error.span().map_or(0, |span| span.start);
            let Some(first) = errors.into_iter().min_by_key(start) else {
                if let Some(fault) = not_a_scenario(&legible, &faults) {
                    return Err(vec![fault]);
                }
                return Ok(Self {
                    root: parsed_tree(root.into_inner(), 0, 0),
                    texts: vec![text],
                    unread,
                    faults,
                    folder: folder.to_owned(),
                });
            };
            let offset = start(&first);
            let line = faulty_part(&legible, offset);
            let message = match excerpt(&text[line.clone()]).as_str() {
                "" => format!("not valid TOML: {}", first.message()),
                line => format!("not valid TOML in `{line}`: {}", first.message()),
            };
            faults.push(Fault::new(0, offset, message));
            if legible[line.clone()].trim().is_empty() {
                break;
            }
            unread.push_str(&text[line.clone()]);
            let blank = " ".repeat(line.len());
            legible.replace_range(line, &blank);
        }
        match not_a_scenario(&legible, &faults) {
            Some(fault) => Err(vec![fault]),
            None => Err(faults),
        }
    }

    /// A document that a program gives as JSON.
    pub(super) fn of_json(value: &Value, folder: &Path) -> Self {
        let root = match Node::of_json(value) {
            Node::Table(root) => root,
            _ => Tree::new(),
        };
        Self {
            root,
            folder: folder.to_owned(),
            ..Self::default()
        }
    }

    /// Puts the values of all assignments into the document; a name that is no entry of a list is a fault.
    pub(super) fn assign(&mut self, assignments: &'a [Assignment]) {
        for assignment in assignments {
            self.texts.push(&assignment.text);
            let text = self.texts.len() - 1;
            let (value, _) = DeTable::parse_recoverable(&assignment.text);
            let value = parsed_tree(value.into_inner(), text, 0);
            if let Err(message) = put(&mut self.root, value, assignment.depth) {
                self.faults.push(Fault::new(text, 0, message));
            }
        }
    }

    /// Puts a number at the place that a key such as `load.2.mass_kg` names.
    pub(super) fn put_number(&mut self, key: &[&str], number: f64) -> Result<(), String> {
        let value = Entry::given(Node::of_number(number));
        let value = key.iter().rev().fold(value, |inner, part| {
            Entry::given(Node::Table(vec![((*part).to_owned(), 0, inner)]))
        });
        match value.value {
            Node::Table(value) => put(&mut self.root, value, key.len()),
            _ => Ok(()),
        }
    }

    /// The text of an entry, as a message quotes it.
    pub(super) fn quote(&self, entry: &Entry) -> String {
        if entry.span.range.is_empty() {
            return excerpt(&entry.value.to_string());
        }
        excerpt(&self.texts[entry.span.text][entry.span.range.clone()])
    }

    /// Whether an entry is an array of tables `[[key]]`. Its span is the first of their headers.
    pub(super) fn is_array_of_tables(&self, key: &str, entry: &Entry) -> bool {
        let Span { text, range } = entry.span.clone();
        let text = self.texts.get(text);
        matches!(entry.value, Node::Array(_))
            && text.is_some_and(|text| text[range] == format!("[[{key}]]"))
    }
}

/// The single fault of a text that is not a scenario at all, such as a record: several lines are not valid, and no line begins a table.
fn not_a_scenario(legible: &str, faults: &[Fault]) -> Option<Fault> {
    const FEW: usize = 2;
    let first = faults.first().filter(|_| faults.len() > FEW)?;
    let mut lines = legible.lines();
    if lines.any(|line| line.trim_start().starts_with('[')) {
        return None;
    }
    let message = format!(
        "this is no scenario: {}. If it is a record, name it as `file` in [ground.record] of a scenario",
        first.message
    );
    Some(Fault::new(0, first.offset, message))
}

/// The line around `offset`. If it is the header of a table, the whole table: otherwise its keys
/// would be taken for keys of the table before.
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

/// Puts the value of the only key of `assignment`, which lies `depth` tables deep, at the same place in `tree`.
fn put(tree: &mut Tree, assignment: Tree, depth: usize) -> Result<(), String> {
    for (key, offset, value) in assignment {
        match tree.iter_mut().find(|(name, ..)| *name == key) {
            Some((_, _, known)) => replace(known, &key, value, depth)?,
            None => tree.push((key, offset, value)),
        }
    }
    Ok(())
}

/// Replaces the known value by a new one, `depth` tables deep. Entries of lists are counted from 1.
fn replace(known: &mut Entry, name: &str, new: Entry, depth: usize) -> Result<(), String> {
    match (&mut known.value, new.value) {
        (Node::Table(known), Node::Table(inner)) if depth > 1 => put(known, inner, depth - 1),
        (Node::Array(entries), Node::Table(inner)) if depth > 1 => {
            let count = entries.len();
            for (number, _, value) in inner {
                let place = number.parse::<usize>().ok();
                let entry = place.and_then(|place| entries.get_mut(place.checked_sub(1)?));
                let Some(entry) = entry else {
                    return Err(format!(
                        "`{name}` is a list, whose entries are `{name}.1` to `{name}.{count}`: `{name}.{number}` is none"
                    ));
                };
                replace(entry, &format!("{name}.{number}"), value, depth - 1)?;
            }
            Ok(())
        }
        (_, value) => {
            *known = Entry {
                value,
                span: new.span,
            };
            Ok(())
        }
    }
}
