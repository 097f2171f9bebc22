//! A scenario with values that differ from those in its text.

use super::document::Document;
use super::prelude::*;
use super::{Assignment, Changes, Scenario, Series, span, table};

/// Tables that describe a study or the check, not the structure or ground motion under study.
const STUDIES: [&str; 5] = ["map", "suite", "uncertain", "demand", "verify"];

impl Scenario {
    /// The scenario with other numbers for some keys, each named `table.key`. Studies and the check are left out. The samples
    /// of a record stay the same.
    ///
    /// # Errors
    /// Explains the fault of the keys or of the changed scenario.
    pub fn with_values(&self, values: &[(&str, f64)]) -> Result<Self, String> {
        let mut resolved = self.resolved();
        if let Value::Object(tables) = &mut resolved {
            tables.retain(|name, _| !STUDIES.contains(&name.as_str()));
            if self.unread_ground.is_some() {
                tables.shift_remove("ground");
            }
        }
        make_room(&mut resolved, values);
        let set = values.iter().map(|(key, value)| assignment(key, *value));
        let set = set.collect::<Result<Vec<_>, String>>()?;
        let mut document = Document::of_json(resolved, &self.files.folder);
        document.assign(&set);
        let known: Vec<Series> = self.series().cloned().collect();
        let changes = Changes::default();
        table::read_document(document, |table| Self::read_table(table, &known, &changes))
            .map_err(|faults| shown(&faults[0].message))
    }
}

/// Sets a number of the structure or of its motion.
fn assignment(key: &str, value: f64) -> Result<Assignment, String> {
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
    )?;
    // Whole numbers may stand for counts.
    let number = match value.fract() == 0.0 && value.abs() < 1e15 {
        true => format!("{value:.0}"),
        false => format!("{value:?}").to_lowercase(),
    };
    Ok(Assignment {
        given: key.to_owned(),
        text: format!("{} = {number}", parts.join(".")),
        depth: parts.len(),
    })
}

/// Whether a text is a key of TOML without quotation marks.
fn is_name(text: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    !text.is_empty() && text.chars().all(is_letter)
}

/// The parts of a key, `table.key`.
pub(super) fn parts(key: &str) -> Vec<&str> {
    key.split('.').map(str::trim).collect()
}

/// A value of some tables by its key, entries of lists counted from 1.
pub(super) fn value<'v>(tables: &'v Value, key: &str) -> Option<&'v Value> {
    parts(key)
        .iter()
        .try_fold(tables, |table, part| match table {
            Value::Array(entries) => entries.get(part.parse::<usize>().ok()?.checked_sub(1)?),
            table => table.get(part),
        })
}

/// A value of a resolved scenario by its key; also the thickness of a circular arch, of which the resolved scenario has the ratio.
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

/// Pairs of keys for one quantity: setting one removes the other.
const ALTERNATIVES: [[&str; 3]; 4] = [
    ["/arch", "thickness_m", "thickness_ratio"],
    ["/arch", "rise_m", "embrace_deg"],
    ["/ground/record", "scale", "peak_g"],
    ["/ground/right/record", "scale", "peak_g"],
];

/// Changes values that depend on the new ones: an arch keeps either its thickness or its ratio, its last joint is at the other
/// springing, and the drums of a column add up to its height.
fn make_room(table: &mut Value, values: &[(&str, f64)]) {
    let keys: Vec<Vec<&str>> = values.iter().map(|(key, _)| parts(key)).collect();
    let given = |wanted: [&str; 2]| {
        let index = keys.iter().position(|key| key[..] == wanted)?;
        Some(values[index].1)
    };
    let both_ways = ALTERNATIVES.map(|[name, one, other]| [[name, one, other], [name, other, one]]);
    for [name, is_given, goes] in both_ways.into_iter().flatten() {
        let is_given =
            |key: &Vec<&str>| format!("/{}", key.join("/")) == format!("{name}/{is_given}");
        if keys.iter().any(is_given)
            && let Some(Value::Object(table)) = table.pointer_mut(name)
        {
            table.shift_remove(goes);
        }
    }
    let of_arch = |key: &str| given(["arch", key]).or_else(|| table["arch"][key].as_f64());
    let measured = of_arch("span_m").zip(of_arch("rise_m"));
    let measured_deg = measured.map(|(span_m, rise_m)| span::embrace_deg(span_m, rise_m));
    if let (Some(embrace_deg), Some(Value::Array(joints_deg))) = (
        given(["arch", "embrace_deg"]).or(measured_deg),
        table.pointer_mut("/arch/joints_deg"),
    ) && let Some(last_deg) = joints_deg.last().and_then(Value::as_f64)
    {
        let angles_deg = joints_deg.iter().filter_map(Value::as_f64);
        let angles_deg = angles_deg.map(|angle_deg| angle_deg / last_deg * embrace_deg);
        let mut angles_deg: Vec<f64> = angles_deg.collect();
        if let Some(last) = angles_deg.last_mut() {
            *last = embrace_deg;
        }
        *joints_deg = angles_deg.into_iter().map(Value::from).collect();
    }
    let height_m = given(["column", "height_m"]);
    let is_drum = |key: &[&str]| matches!(key, ["column", "drum_heights_m", _]);
    fit_drums(table, values, height_m, keys.iter().any(|key| is_drum(key)));
}

/// Drums share a new height in their proportions; the height is that of new drums.
fn fit_drums(table: &mut Value, values: &[(&str, f64)], height_m: Option<f64>, drums_change: bool) {
    let Some(Value::Object(column)) = table.get_mut("column") else {
        return;
    };
    let Some(Value::Array(drums)) = column.get("drum_heights_m") else {
        return;
    };
    let mut drums_m: Vec<f64> = drums.iter().filter_map(Value::as_f64).collect();
    let sum_m: f64 = drums_m.iter().sum();
    match (height_m, drums_change) {
        (Some(height_m), false) => {
            for drum_m in &mut drums_m {
                *drum_m *= height_m / sum_m;
            }
            column.insert("drum_heights_m".to_owned(), Value::from(drums_m));
        }
        (None, true) => {
            for (key, value) in values {
                if let ["column", "drum_heights_m", entry] = parts(key)[..]
                    && let Some(index) = entry.parse::<usize>().ok().and_then(|n| n.checked_sub(1))
                    && let Some(drum_m) = drums_m.get_mut(index)
                {
                    *drum_m = *value;
                }
            }
            let sum_m: f64 = drums_m.iter().sum();
            column.insert("height_m".to_owned(), Value::from(sum_m));
        }
        // If both are given, the reader checks that they add up.
        _ => {}
    }
}
