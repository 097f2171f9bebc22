//! Relations between the keys of a table.

use archrock_text::ensure;
use serde_json::{Value, json};

use super::document::KeyGroup;
use super::table::{FaultRecorded, ReadResult, Table};

/// A relation between the given keys of a table.
pub(super) enum Relation<'a> {
    /// Exactly one of these keys. The text replaces the message for a missing key.
    OneOf(&'a [&'a str], Option<&'a str>),
    /// At least one of these keys. The text replaces the message if none is given.
    SomeOf(&'a [&'a str], Option<&'a str>),
    /// At most one of these keys. The text is the remedy if two are given.
    AtMostOne(&'a [&'a str], &'a str),
    /// All of these keys or none.
    Together(&'a [&'a str]),
    /// The first key requires the second. The text follows the second key in the message; it is the reason or another remedy.
    Requires(&'a str, &'a str, &'a str),
    /// The first key excludes the second. The text follows the second key in the message; it is the reason and the remedy.
    Excludes(&'a str, &'a str, &'a str),
}

use Relation::{AtMostOne, Excludes, OneOf, Requires, SomeOf, Together};

impl Relation<'_> {
    /// Relation as a JSON schema.
    pub(super) fn schema(&self) -> Value {
        let given = |key: &&str| json!({ "required": [key] });
        match self {
            OneOf(keys, _) => json!({ "oneOf": keys.iter().map(given).collect::<Vec<_>>() }),
            SomeOf(keys, _) => json!({ "anyOf": keys.iter().map(given).collect::<Vec<_>>() }),
            AtMostOne(keys, _) => {
                let pairs = keys.iter().enumerate().flat_map(|(index, one)| {
                    let others = keys[..index].iter();
                    others.map(move |other| json!({ "not": { "required": [other, one] } }))
                });
                json!({ "allOf": pairs.collect::<Vec<_>>() })
            }
            Together(keys) => {
                let all = keys.iter().map(|key| ((*key).to_owned(), json!(keys)));
                json!({ "dependencies": Value::Object(all.collect()) })
            }
            Requires(key, other, _) => json!({ "dependencies": { *key: [other] } }),
            Excludes(key, other, _) => json!({ "not": { "required": [key, other] } }),
        }
    }

    /// Keys that exclude or need each other, for a table at the outermost level; `None` for other relations.
    fn group(&self) -> Option<KeyGroup> {
        let (keys, are_alternatives) = match self {
            OneOf(keys, _) | AtMostOne(keys, _) => (keys, true),
            Together(keys) => (keys, false),
            SomeOf(..) | Requires(..) | Excludes(..) => return None,
        };
        Some(KeyGroup {
            tables: Vec::new(),
            keys: keys.iter().map(|key| (*key).to_owned()).collect(),
            are_alternatives,
        })
    }

    /// Records faults of keys that violate the relation.
    fn check(&self, table: &mut Table<'_>) {
        match self {
            OneOf(keys, message) => {
                let are_tables = keys.iter().all(|key| table.is_table(key));
                let kind = if are_tables { "tables" } else { "keys" };
                let rule = format!("exactly one of the {kind} {}", keys.join(", "));
                if !exclude(table, keys, &format!("give {rule}")) && !table.may_give(keys) {
                    let needs = format!("needs {rule}");
                    table.fault_of_table(message.unwrap_or(&needs));
                }
            }
            SomeOf(keys, message) => {
                if !table.may_give(keys) {
                    let needs = format!("needs one of the keys {}", keys.join(", "));
                    table.fault_of_table(message.unwrap_or(&needs));
                }
            }
            AtMostOne(keys, remedy) => {
                exclude(table, keys, remedy);
            }
            Together(keys) => {
                let given = keys.iter().find(|key| table.has_key(key));
                let lacking = keys.iter().find(|key| !table.may_give(&[key]));
                if let Some((key, other)) = given.zip(lacking) {
                    table.reject(key, format!("needs `{other}` beside it"));
                }
            }
            Requires(key, other, why) => {
                if table.has_key(key) && !table.may_give(&[other]) {
                    table.reject(key, format!("needs `{other}`{why}"));
                }
            }
            Excludes(key, other, why) => {
                if table.has_key(key) && table.has_key(other) {
                    table.reject(other, why);
                }
            }
        }
    }
}

/// Remedy for two keys of which one is enough.
pub(super) const GIVE_ONE: &str = "give one of them";

/// Records faults of all given keys but the first in the file. Returns true if a key is given.
fn exclude(table: &mut Table<'_>, keys: &[&str], remedy: &str) -> bool {
    let mut given: Vec<_> = keys
        .iter()
        .copied()
        .filter(|key| table.has_key(key))
        .collect();
    given.sort_by_key(|key| table.value_position(key));
    if let [first, others @ ..] = &given[..] {
        for key in others {
            table.reject_excluded(key, first, remedy);
        }
    }
    !given.is_empty()
}

impl Table<'_> {
    /// Records faults of all relations that the table violates.
    pub(super) fn apply_relations(&mut self, relations: &[Relation<'_>]) -> ReadResult<()> {
        let before = self.faults();
        for relation in relations {
            self.describe("allOf", || relation.schema());
            if self.describes() {
                self.groups.extend(relation.group());
            }
            relation.check(self);
        }
        ensure(self.faults() == before, || FaultRecorded)
    }

    /// Records faults of all relations that the table violates. Succeeds if there are none and all values of the table are valid.
    pub(super) fn check_relations(&mut self, relations: &[Relation<'_>]) -> ReadResult<()> {
        self.apply_relations(relations).and(self.check_faultless())
    }
}
