//! A value given in addition to the text of a scenario: `table.key=value`.

use std::str::FromStr;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::toml_text::quote_string;

/// A value that replaces a value in the text of a scenario, or is added to the text.
///
/// The names of the tables are parts of the key, as in TOML: `arch.thickness_ratio=0.12`. A value that is not valid TOML is read as a string, so
/// `impact.model=mirrored` needs no quotation marks. A table in braces replaces the whole table of that name. Entries of lists are counted from
/// 1: `load.2.mass_kg=800`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// The text as the user gives it.
    pub(super) given: String,
    /// The assignment in TOML.
    pub(super) text: String,
    /// Number of parts of the key.
    pub(super) depth: usize,
}

impl Assignment {
    /// The assignment as the user gives it.
    pub fn given(&self) -> &str {
        &self.given
    }

    /// Key in the text of the user.
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
        let zero = format!("{key} = 0");
        let zero = DeTable::parse(&zero).map_err(|_| wrong())?;
        if value.is_empty() {
            return Err(wrong());
        }
        let text = [value.to_owned(), quote_string(value)]
            .into_iter()
            .map(|value| format!("{key} = {value}"))
            .find(|text| DeTable::parse(text).is_ok_and(|table| table.get_ref().len() == 1))
            .ok_or_else(wrong)?;
        Ok(Self {
            given: given.to_owned(),
            text,
            depth: depth(zero.get_ref()),
        })
    }
}

/// Number of parts of the key of an assignment.
fn depth(table: &DeTable<'_>) -> usize {
    match table.values().next().map(Spanned::get_ref) {
        Some(DeValue::Table(inner)) => 1 + depth(inner),
        _ => 1,
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
