//! The tables that were given, and the scenario written with their keys.

use super::change::{is_count, is_replaced};
use super::document::Entries;
use super::model_kind::ModelKind;
use super::prelude::*;
use super::study_table::StudyTable;
use super::{ReadOptions, Scenario, masonry};

/// The tables of the text after all changes, and the way in which they were read. Any two values compare as equal, because scenarios are equal
/// regardless of the keys that give their values.
#[derive(Clone, Debug, Default)]
pub(super) struct Given {
    pub(super) tables: Entries,
    /// The model of motion that the user chose.
    pub(super) model: Option<&'static ModelKind>,
    /// True if the tables were read for static analysis.
    pub(super) statics: bool,
}

impl PartialEq for Given {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Given {
    /// The tables of a text that is read with these options.
    pub(super) fn of(table: &Table<'_>, options: &ReadOptions<'_>) -> Self {
        Self {
            tables: table.all_given(),
            model: options.model,
            statics: options.statics,
        }
    }

    /// Resolved tables with the given keys, and the resolved ones as defaults of keys that are not given.
    pub(super) fn with_defaults(&self, resolved: Value) -> Value {
        let Value::Object(resolved) = resolved else {
            return resolved;
        };
        let written = resolved.into_iter().map(|(name, table)| {
            let given = self.tables.get(&name).filter(|_| is_of_structure(&name));
            let table = match given {
                Some(given) => with_defaults(&[&name], given, table),
                None => table,
            };
            (name, table)
        });
        Value::Object(written.collect())
    }
}

/// True for tables that describe the structure and its motion.
fn is_of_structure(name: &str) -> bool {
    name != "title" && !StudyTable::is_name(name)
}

/// Given value with the resolved one as default. `tables` are the names of the tables around it and its own, the outermost first.
fn with_defaults(tables: &[&str], given: &Value, resolved: Value) -> Value {
    match (given, resolved) {
        (Value::Object(given), Value::Object(mut resolved)) => {
            let shared = shared_defaults(tables, given, &mut resolved);
            // Keys in the order of the file, if some of them replace resolved ones.
            let replaces = given.iter().any(|(key, _)| !resolved.contains_key(key));
            let first = given.iter().filter(|_| replaces);
            let mut written = Entries::new();
            for (key, given) in first.filter(|(_, given)| !given.is_null()) {
                let value = match resolved.shift_remove(key) {
                    Some(resolved) => inner(tables, key, given, resolved),
                    None if is_count(tables, key) => given.clone(),
                    None => length(given, shared.get(key)),
                };
                written.insert(key.clone(), value);
            }
            for (key, default) in shared {
                written.entry(key).or_insert(default);
            }
            for (key, resolved) in resolved {
                match given.get(&key) {
                    Some(given) => {
                        let value = inner(tables, &key, given, resolved);
                        written.insert(key, value);
                    }
                    None if is_replaced(tables, &key, given) => {}
                    None => {
                        written.insert(key, resolved);
                    }
                }
            }
            Value::Object(written)
        }
        (Value::Array(given), Value::Array(resolved)) if given.len() == resolved.len() => {
            let both = given.iter().zip(resolved);
            both.map(|(given, resolved)| with_defaults(tables, given, resolved))
                .collect()
        }
        (given, resolved) => length(given, Some(&resolved)),
    }
}

/// Given value of a key in a table, with the resolved one as default.
fn inner(tables: &[&str], key: &str, given: &Value, resolved: Value) -> Value {
    let tables: Vec<&str> = tables.iter().copied().chain([key]).collect();
    with_defaults(&tables, given, resolved)
}

/// Given value. A length, which may be given as a whole number, has a fraction; `resolved` is the same value after reading.
fn length(given: &Value, resolved: Option<&Value>) -> Value {
    match (given.as_f64(), resolved) {
        (Some(number), None) => Value::from(number),
        (Some(number), Some(resolved)) if resolved.is_f64() => Value::from(number),
        _ => given.clone(),
    }
}

/// Tables whose keys hold for both tables in them.
const SHARED: [(&str, [&str; 2]); 1] = [("piers", ["left", "right"])];

/// Removes the keys from resolved inner tables that a table gives for both, or that are defaults of both, and returns them. Inner tables that are
/// not given and have no key left are removed.
fn shared_defaults(tables: &[&str], given: &Entries, resolved: &mut Entries) -> Entries {
    let mut shared = Entries::new();
    let sides = SHARED.iter().find(|(name, _)| tables == [*name]);
    // A key of both makes both, so it is no default of a single one.
    let has_both = |sides: &[&str; 2]| sides.iter().all(|side| resolved.contains_key(*side));
    let is_given = given.values().any(|value| !value.is_object());
    let Some((_, sides)) = sides.filter(|(_, sides)| is_given && has_both(sides)) else {
        return shared;
    };
    for side in sides {
        let own = given.get(*side).and_then(Value::as_object);
        if let Some(Value::Object(keys)) = resolved.get_mut(*side) {
            for (key, value) in std::mem::take(keys) {
                match own.is_some_and(|own| own.contains_key(&key)) {
                    true => keys.insert(key, value),
                    false => shared.insert(key, value),
                };
            }
            if keys.is_empty() && own.is_none() {
                resolved.shift_remove(*side);
            }
        }
    }
    shared
}

impl Scenario {
    /// Condition that the density is the default, if static results depend on it: with fill, loads, ties or a floor on the top.
    pub(crate) fn default_density_in_words(&self) -> Option<String> {
        let tables = &self.given.tables;
        let given = |name: &str| tables.contains_key(name);
        let top = self.structure.held_column().map(|_| "[column.top]");
        let beside = [
            ("fill", "[fill]"),
            ("load", "[[load]]"),
            ("vehicle", "[vehicle]"),
            ("tie", "[[tie]]"),
        ];
        let beside = beside.into_iter().find(|(name, _)| given(name));
        let beside = top.or(beside.map(|(_, shown)| shown))?;
        let mut shapes = ["arch", "column"].into_iter().chain(masonry::SHAPES);
        let shape = &tables[shapes.find(|shape| given(shape))?];
        let (_, density_kg_m3) = self.structure.depth_and_density();
        shape.get("density_kg_m3").is_none().then(|| {
            format!("the density is the default, {} kg/m3: with {beside} the result depends on it, so give `density_kg_m3`", plain(density_kg_m3))
        })
    }
}
