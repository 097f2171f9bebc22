//! A value given in addition to the text of a scenario: `table.key=value`.

use std::ops::Range;
use std::str::FromStr;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::Fault;
use super::toml_text::quoted;

/// A value that replaces the one in a scenario's text, or is added to it.
///
/// The names of the tables are parts of the key, as in TOML: `arch.thickness_ratio=0.12`. A value that is not valid TOML
/// is taken as a string, so that `impact.model=mirrored` needs no quotation marks. A table in braces replaces the whole
/// table of that name. Entries of lists are counted from 1: `load.2.mass_kg=800`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// As it was given.
    given: String,
    /// The same in TOML.
    text: String,
    /// Number of parts of its key.
    depth: usize,
}

impl Assignment {
    /// Its key, as it was given.
    #[must_use]
    pub fn key(&self) -> &str {
        self.given.split('=').next().unwrap_or_default().trim()
    }
}

impl FromStr for Assignment {
    type Err = String;

    fn from_str(given: &str) -> Result<Self, String> {
        let wrong = || {
            "must be a key, `=` and a value, such as arch.thickness_ratio=0.12 or impact.model=mirrored"
                .to_owned()
        };
        let (key, value) = given.split_once('=').ok_or_else(wrong)?;
        let (key, value) = (key.trim(), value.trim());
        let depth = depth(key).ok_or_else(wrong)?;
        if value.is_empty() {
            return Err(wrong());
        }
        let text = [value.to_owned(), quoted(value)]
            .into_iter()
            .map(|value| format!("{key} = {value}"))
            .find(|text| DeTable::parse(text).is_ok_and(|table| table.get_ref().len() == 1))
            .ok_or_else(wrong)?;
        Ok(Self {
            given: given.to_owned(),
            text,
            depth,
        })
    }
}

/// Number of parts of a key; `None` if the text is not a key.
fn depth(key: &str) -> Option<usize> {
    let text = format!("{key} = 0");
    let table = DeTable::parse(&text).ok()?;
    let mut parts = 1;
    let mut table = table.get_ref();
    while let Some(DeValue::Table(inner)) = only(table) {
        (parts, table) = (parts + 1, inner);
    }
    Some(parts)
}

/// The only value of a table.
fn only<'a, 'i>(table: &'a DeTable<'i>) -> Option<&'a DeValue<'i>> {
    let mut values = table.values();
    let value = values.next()?;
    values.next().is_none().then(|| value.get_ref())
}

/// Assignments that follow a text of that length, each on a line of its own. Their offsets tell them apart from the text
/// and from one another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Appended<'a> {
    length: usize,
    assignments: &'a [Assignment],
}

impl<'a> Appended<'a> {
    pub(super) const fn new(text: &str, assignments: &'a [Assignment]) -> Self {
        Self {
            length: text.len(),
            assignments,
        }
    }

    /// The assignments, each with the range of its text.
    fn places(self) -> impl Iterator<Item = (Range<usize>, &'a Assignment)> {
        self.assignments
            .iter()
            .scan(self.length, |end, assignment| {
                let start = *end + 1;
                *end = start + assignment.text.len();
                Some((start..*end, assignment))
            })
    }

    /// The assignment at this offset, as it was given.
    pub(super) fn at(self, offset: usize) -> Option<&'a str> {
        let mut places = self.places();
        let found = places.find(|(place, _)| place.start <= offset && offset <= place.end);
        found.map(|(_, assignment)| assignment.given.as_str())
    }

    /// The text that is appended.
    pub(super) fn text(self) -> String {
        let lines = self.assignments.iter();
        lines
            .map(|assignment| format!("\n{}", assignment.text))
            .collect()
    }

    /// The text of each assignment, padded with blanks up to its offset, as [`Appended::assign`] needs it.
    pub(super) fn padded(self) -> Vec<(String, usize)> {
        self.places()
            .map(|(place, assignment)| {
                let text = format!("{}{}", " ".repeat(place.start), assignment.text);
                (text, assignment.depth)
            })
            .collect()
    }

    /// Puts the values of all assignments into the table, or reports the names that are not entries of a list.
    pub(super) fn assign<'i>(table: &mut DeTable<'i>, padded: &'i [(String, usize)]) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (text, depth) in padded {
            let (assignment, _) = DeTable::parse_recoverable(text);
            if let Err(fault) = put(table, assignment.into_inner(), *depth) {
                faults.push(fault);
            }
        }
        faults
    }
}

/// Puts the value of the only key of `assignment`, which lies `depth` tables deep, at the same place in `table`.
fn put<'i>(table: &mut DeTable<'i>, assignment: DeTable<'i>, depth: usize) -> Result<(), Fault> {
    for (key, value) in assignment {
        match table.get_mut(&key) {
            Some(known) => replace(known, key.get_ref(), value, depth)?,
            None => {
                table.insert(key, value);
            }
        }
    }
    Ok(())
}

/// Replaces the known value by a new one, `depth` tables deep. Entries of lists are counted from 1.
fn replace<'i>(
    known: &mut Spanned<DeValue<'i>>,
    name: &str,
    value: Spanned<DeValue<'i>>,
    depth: usize,
) -> Result<(), Fault> {
    let span = value.span();
    match (known.get_mut(), value.into_inner()) {
        (DeValue::Table(known), DeValue::Table(inner)) if depth > 1 => put(known, inner, depth - 1),
        (DeValue::Array(entries), DeValue::Table(inner)) if depth > 1 => {
            for (number, value) in inner {
                let number = number.get_ref();
                let entry = match number.parse::<usize>() {
                    Ok(place) if place > 0 => entries.get_mut(place - 1),
                    _ => None,
                };
                let Some(entry) = entry else {
                    return Err(Fault {
                        offset: span.start,
                        of_file: false,
                        message: format!(
                            "`{name}` is a list, whose entries are `{name}.1` to `{name}.{}`: `{name}.{number}` is none",
                            entries.len()
                        ),
                    });
                };
                replace(entry, &format!("{name}.{number}"), value, depth - 1)?;
            }
            Ok(())
        }
        (_, value) => {
            *known = Spanned::new(span, value);
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_have_parts_and_values_need_no_marks() {
        let text = |given: &str| {
            let assignment: Assignment = given.parse().unwrap();
            (assignment.text, assignment.depth)
        };
        assert_eq!(
            text("arch.thickness_ratio=0.12"),
            ("arch.thickness_ratio = 0.12".to_owned(), 2)
        );
        assert_eq!(text("title = A = B"), ("title = \"A = B\"".to_owned(), 1));
        assert_eq!(
            text("ground.record.unit=cm/s2"),
            ("ground.record.unit = \"cm/s2\"".to_owned(), 3)
        );
        assert_eq!(text("a={b=1}").1, 1);
        for wrong in ["", "a", "=1", "a=", "a b=1", "a..b=1", "[a]=1", "a=1\nb=2"] {
            let result = wrong.parse::<Assignment>();
            assert!(
                result.as_ref().is_err() || result.as_ref().is_ok_and(|one| one.text.contains('"')),
                "{wrong:?} {result:?}"
            );
        }
    }
}
