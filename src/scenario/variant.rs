//! Variants of a scenario: values that differ from those in the text.

use super::document::Document;
use super::given::Given;
use super::prelude::*;
use super::{ReadOptions, Scenario, Series, StudyTable, change, table};

impl Scenario {
    /// Scenario with other numbers for some keys, each named `table.key`, without studies and check. Records are not read again.
    ///
    /// # Errors
    /// The fault of the keys or of the changed scenario.
    pub fn with_values(&self, values: &[(&str, f64)]) -> Result<Self, String> {
        self.with_read_values(values, false)
    }

    /// As [`Scenario::with_values`]. The structure need not be able to stand: its model reports that.
    pub(crate) fn with_unproved_values(&self, values: &[(&str, f64)]) -> Result<Self, String> {
        self.with_read_values(values, true)
    }

    fn with_read_values(&self, values: &[(&str, f64)], unproved: bool) -> Result<Self, String> {
        let Given {
            tables,
            model,
            statics,
        } = &self.given;
        let mut tables = tables.clone();
        tables.retain(|name, _| !StudyTable::is_name(name));
        if self.unread_ground.is_some() {
            tables.shift_remove("ground");
        }
        let mut document = Document::of_json(Value::Object(tables), &self.files.place);
        let mut paths = Vec::new();
        for (key, number) in values {
            check_key(key)?;
            let keys = parts(key);
            let inner = keys.iter().rev();
            let new = inner.fold(value_of(*number), |value, key| json!({ *key: value }));
            let replaced = document.insert(new, keys.len());
            let [.., path] = replaced.map_err(|wrong| shown(&wrong))?;
            paths.push(path);
        }
        change::adjust_others(&mut document.root, &paths);
        let known: Vec<Series> = self.series().cloned().collect();
        let options = ReadOptions {
            model: *model,
            statics: *statics,
            ..ReadOptions::default()
        };
        table::read_document(document, |table| {
            Self::read_table(table, &known, &options, unproved)
        })
        .map_err(|faults| shown(&faults[0].message))
    }
}

/// True if setting one key sets or replaces the other.
pub(crate) fn replaces(new: &str, other: &str) -> bool {
    let ([outer @ .., new], [others @ .., other]) = (&parts(new)[..], &parts(other)[..]) else {
        return false;
    };
    let other = Map::from_iter([((*other).to_owned(), Value::Null)]);
    outer == others && (other.contains_key(*new) || change::is_replaced(outer, new, &other))
}

/// Rejects a key that names no number of the structure or of its motion.
fn check_key(key: &str) -> Result<(), String> {
    let parts = parts(key);
    if StudyTable::is_name(parts[0]) {
        return Err(format!(
            "names no number of the structure or of its motion, as \"arch.depth_m\" does: [{}] describes a study",
            parts[0]
        ));
    }
    ensure(
        parts.len() > 1 && parts.iter().all(|part| is_name(part)),
        || format!("`{key}` names no number of another table, as \"arch.depth_m\" does"),
    )
}

/// Number as a value. Whole numbers may be counts.
fn value_of(number: f64) -> Value {
    match number.fract() == 0.0 && number.abs() < 1e15 {
        true => Value::from(number as i64),
        false => Value::from(number),
    }
}

/// True if a text is a TOML key without quotation marks.
fn is_name(text: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    !text.is_empty() && text.chars().all(is_letter)
}

/// Parts of a key `table.key`.
pub(super) fn parts(key: &str) -> Vec<&str> {
    key.split('.').map(str::trim).collect()
}

/// Value of some tables by its key; entries of lists are counted from 1.
pub(super) fn value<'v>(tables: &'v Value, key: &str) -> Option<&'v Value> {
    parts(key)
        .iter()
        .try_fold(tables, |table, part| match table {
            Value::Array(entries) => entries.get(part.parse::<usize>().ok()?.checked_sub(1)?),
            table => table.get(part),
        })
}

/// Value of a resolved scenario by its key. The thickness of a circular arch is computed from the ratio in the resolved scenario.
pub(super) fn number(resolved: &Value, key: &str) -> Option<Value> {
    if let Some(found) = value(resolved, key) {
        return Some(found.clone());
    }
    let of_arch = |key: &str| resolved.get("arch")?.get(key)?.as_f64();
    match parts(key)[..] {
        ["arch", "thickness_m"] => {
            let thickness_m = of_arch("thickness_ratio")? * of_arch("mean_radius_m")?;
            Some(Value::from(thickness_m))
        }
        _ => None,
    }
}
