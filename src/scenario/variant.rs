//! Variants of a scenario: values that differ from those in the text.

use super::document::{Document, Entries};
use super::prelude::*;
use super::{ReadOptions, Scenario, Series, span, table};

/// Tables of studies and of the check.
const STUDIES: [&str; 5] = ["map", "suite", "uncertain", "demand", "verify"];

impl Scenario {
    /// Returns the scenario with other numbers for some keys, each named `table.key`, without studies and check. Records are not read again.
    ///
    /// # Errors
    /// The fault of the keys or of the changed scenario.
    pub fn with_values(&self, values: &[(&str, f64)]) -> Result<Self, String> {
        let options = ReadOptions {
            model: Some(self.motion.kind),
            ..ReadOptions::default()
        };
        self.with_read_values(values, &options)
    }

    /// As [`Scenario::with_values`]. A circular arch may be unable to stand: its model reports that.
    pub(crate) fn with_unproved_values(&self, values: &[(&str, f64)]) -> Result<Self, String> {
        let options = ReadOptions {
            model: Some(self.motion.kind),
            unproved: true,
            ..ReadOptions::default()
        };
        self.with_read_values(values, &options)
    }

    fn with_read_values(
        &self,
        values: &[(&str, f64)],
        options: &ReadOptions<'_>,
    ) -> Result<Self, String> {
        let mut resolved = Value::Object(self.given.clone());
        if let Value::Object(tables) = &mut resolved {
            tables.retain(|name, _| !STUDIES.contains(&name.as_str()));
            if self.unread_ground.is_some() {
                tables.shift_remove("ground");
            }
        }
        let keys: Vec<Vec<&str>> = values.iter().map(|(key, _)| parts(key)).collect();
        remove_alternatives(&mut resolved, &keys);
        for key in values.iter().map(|(key, _)| key) {
            check_key(key)?;
        }
        let mut document = Document::of_json(resolved, &self.files.place);
        for (keys, (_, number)) in keys.iter().zip(values) {
            let inner = keys.iter().rev();
            let new = inner.fold(value_of(*number), |value, key| json!({ *key: value }));
            let replaced = document.insert(new, keys.len());
            replaced.map_err(|wrong| shown(&wrong))?;
        }
        update_dependent_values(&mut document.root, &keys);
        let known: Vec<Series> = self.series().cloned().collect();
        table::read_document(document, |table| Self::read_table(table, &known, options))
            .map_err(|faults| shown(&faults[0].message))
    }
}

/// Rejects a key that names no number of the structure or of its motion.
fn check_key(key: &str) -> Result<(), String> {
    let parts = parts(key);
    if STUDIES.contains(&parts[0]) {
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

/// Returns a number as a value. Whole numbers may be counts.
fn value_of(number: f64) -> Value {
    match number.fract() == 0.0 && number.abs() < 1e15 {
        true => Value::from(number as i64),
        false => Value::from(number),
    }
}

/// Returns true if a text is a TOML key without quotation marks.
fn is_name(text: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    !text.is_empty() && text.chars().all(is_letter)
}

/// Returns the parts of a key `table.key`.
pub(super) fn parts(key: &str) -> Vec<&str> {
    key.split('.').map(str::trim).collect()
}

/// Returns a value of some tables by its key; entries of lists are counted from 1.
pub(super) fn value<'v>(tables: &'v Value, key: &str) -> Option<&'v Value> {
    parts(key)
        .iter()
        .try_fold(tables, |table, part| match table {
            Value::Array(entries) => entries.get(part.parse::<usize>().ok()?.checked_sub(1)?),
            table => table.get(part),
        })
}

/// Returns a value of a resolved scenario by its key. The thickness of a circular arch is computed from the ratio in the resolved scenario.
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

/// Alternative keys of one quantity: setting one removes the other.
const ALTERNATIVES: [[&str; 3]; 4] = [
    ["/arch", "thickness_m", "thickness_ratio"],
    ["/arch", "rise_m", "embrace_deg"],
    ["/ground/record", "scale", "peak_g"],
    ["/ground/right/record", "scale", "peak_g"],
];

/// Removes the alternatives of new values: an arch keeps either its thickness or its ratio.
fn remove_alternatives(tables: &mut Value, keys: &[Vec<&str>]) {
    let both_ways = ALTERNATIVES.map(|[name, one, other]| [[name, one, other], [name, other, one]]);
    for [name, given, goes] in both_ways.into_iter().flatten() {
        let is_given = |key: &Vec<&str>| format!("/{}", key.join("/")) == format!("{name}/{given}");
        if keys.iter().any(is_given)
            && let Some(Value::Object(table)) = tables.pointer_mut(name)
        {
            table.shift_remove(goes);
        }
    }
}

/// Changes values that depend on new ones. The last joint of an arch moves to the other springing. Drums keep their proportions under a new
/// height of the column; new drums set the height of the column.
fn update_dependent_values(tables: &mut Entries, keys: &[Vec<&str>]) {
    let is_new = |wanted: [&str; 2]| keys.iter().any(|key| key.starts_with(&wanted));
    if let Some(Value::Object(arch)) = tables.get_mut("arch") {
        let number = |key: &str| arch.get(key).and_then(Value::as_f64);
        let measured = number("span_m").zip(number("rise_m"));
        let measured_deg = measured.map(|(span_m, rise_m)| span::embrace_deg(span_m, rise_m));
        let new_deg = number("embrace_deg").filter(|_| is_new(["arch", "embrace_deg"]));
        let joints_deg = numbers(arch, "joints_deg");
        if let Some((embrace_deg, [joints_deg @ .., last_deg])) =
            new_deg.or(measured_deg).zip(joints_deg.as_deref())
        {
            let angles_deg = joints_deg
                .iter()
                .map(|angle_deg| angle_deg / last_deg * embrace_deg);
            let angles_deg: Vec<f64> = angles_deg.chain([embrace_deg]).collect();
            arch.insert("joints_deg".to_owned(), Value::from(angles_deg));
        }
    }
    if let Some(Value::Object(column)) = tables.get_mut("column")
        && let Some(drums_m) = numbers(column, "drum_heights_m")
    {
        let (sum_m, height_m) = (drums_m.iter().sum::<f64>(), column["height_m"].as_f64());
        let is_new = ["height_m", "drum_heights_m"].map(|key| is_new(["column", key]));
        match (is_new, height_m) {
            ([true, false], Some(height_m)) => {
                let ratio = height_m / sum_m;
                let drums_m: Vec<f64> = drums_m.iter().map(|drum_m| drum_m * ratio).collect();
                column.insert("drum_heights_m".to_owned(), Value::from(drums_m));
            }
            ([false, true], _) => {
                column.insert("height_m".to_owned(), Value::from(sum_m));
            }
            // If both are given, the reader checks the sum.
            _ => {}
        }
    }
}

/// Returns the numbers of a list.
fn numbers(table: &Entries, key: &str) -> Option<Vec<f64>> {
    let numbers = table.get(key)?.as_array()?.iter();
    Some(numbers.filter_map(Value::as_f64).collect())
}
