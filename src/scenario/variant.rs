//! A scenario with values that differ from those in its text.

use serde_json::Value;

use super::span;
use super::toml_text::toml_text;
use super::{Assignment, Changes, Ground, Scenario, Source};
use std::sync::Arc;

/// Tables that describe a study, not the structure or ground motion under study.
const STUDIES: [&str; 3] = ["map", "suite", "uncertain"];
/// Tables of the check, which needs no history.
const CHECK: [&str; 2] = ["demand", "verify"];
/// What precedes the keys of a record.
const RECORD: &str = "ground.record.";
/// What precedes the keys of the right foot.
const RIGHT: &str = "ground.right.";

impl Scenario {
    /// The scenario with other numbers for some keys, each named `table.key`. Studies and the check are left out. The samples
    /// of a record stay the same.
    ///
    /// # Errors
    /// Explains what is wrong with the keys or with the changed scenario.
    pub fn with_values(&self, values: &[(&str, f64)]) -> Result<Self, String> {
        let record = match &self.ground {
            Some(Ground::Record(record)) => Some(record),
            Some(Ground::Pulse(_)) | None => None,
        };
        let (of_record, others): (Vec<_>, Vec<_>) = values
            .iter()
            .partition(|(key, _)| record.is_some() && key.starts_with(RECORD));
        let right = self.right_foot.as_ref();
        let (of_right, others): (Vec<_>, Vec<_>) = others
            .into_iter()
            .partition(|(key, _)| right.is_some() && key.starts_with(RIGHT));
        let set = others
            .into_iter()
            .map(|(key, value)| assignment(key, value))
            .collect::<Result<Vec<_>, _>>()?;
        let mut table = self.resolved();
        if let Value::Object(table) = &mut table {
            for left_out in STUDIES.iter().chain(&CHECK) {
                table.shift_remove(*left_out);
            }
            if record.is_some() || self.unread_ground.is_some() {
                table.shift_remove("ground");
            } else if let Some(Value::Object(ground)) = table.get_mut("ground") {
                ground.shift_remove("right");
            }
        }
        make_room(&mut table, values);
        let text = table.as_object().map_or(String::new(), toml_text);
        let changes = Changes {
            set: &set,
            ..Changes::default()
        };
        let mut changed = Self::of(&Source::of_text(&text, ""), &changes)
            .map_err(|errors| errors.as_slice()[0].message.clone())?;
        let gravity_m_s2 = changed.simulation.gravity_m_s2;
        let inner = |values: &[(&str, f64)], outer: &str| -> Vec<(String, f64)> {
            let inner = values.iter();
            inner
                .map(|(key, value)| (key[outer.len()..].to_owned(), *value))
                .collect()
        };
        if let Some(record) = record {
            let of_record = inner(&of_record, RECORD);
            let of_record: Vec<_> = of_record
                .iter()
                .map(|(key, value)| (&**key, *value))
                .collect();
            let record = record.with_values(&of_record, gravity_m_s2)?;
            changed.ground_motion = Arc::new(record.motion(gravity_m_s2));
            changed.ground = Some(Ground::Record(Box::new(record)));
        }
        if let Some(right) = right {
            let of_right = inner(&of_right, RIGHT);
            let of_right: Vec<_> = of_right
                .iter()
                .map(|(key, value)| (&**key, *value))
                .collect();
            changed.right_foot = Some(right.with_values(&of_right, gravity_m_s2)?);
            let left = (*changed.ground_motion).clone();
            changed.ground_motion = Arc::new(changed.under_both_feet(left));
        }
        Ok(changed)
    }
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
    let parts = parts(key);
    let other = |keys: &[&str]| {
        let found = keys.iter().try_fold(resolved, |table, key| table.get(key));
        found.and_then(Value::as_f64)
    };
    match parts[..] {
        ["arch", "thickness_m"] => {
            let ratio = other(&["arch", "thickness_ratio"])?;
            Some(Value::from(ratio * other(&["arch", "mean_radius_m"])?))
        }
        _ => None,
    }
}

/// Keys of an arch that say the same in two ways: where one is given, the other goes.
const SAME: [[&str; 2]; 4] = [
    ["thickness_m", "thickness_ratio"],
    ["thickness_ratio", "thickness_m"],
    ["rise_m", "embrace_deg"],
    ["embrace_deg", "rise_m"],
];

/// Changes what has to go with other numbers in a resolved scenario: of an arch either the thickness is there or its ratio, its last
/// joint is at the other springing, and the drums of a column add up to its height.
fn make_room(table: &mut Value, values: &[(&str, f64)]) {
    let keys: Vec<Vec<&str>> = values.iter().map(|(key, _)| parts(key)).collect();
    let given = |wanted: [&str; 2]| {
        let index = keys.iter().position(|key| key[..] == wanted)?;
        Some(values[index].1)
    };
    for [is_given, goes] in SAME {
        if given(["arch", is_given]).is_some()
            && let Some(Value::Object(arch)) = table.get_mut("arch")
        {
            arch.shift_remove(goes);
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
        let mut angles_deg: Vec<f64> = angles_deg
            .map(|angle_deg| angle_deg / last_deg * embrace_deg)
            .collect();
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
        // Both: they say different things, unless they add up.
        _ => {}
    }
}

/// An assignment of a number to a key of a table; whole numbers may stand for counts.
fn assignment(key: &str, value: f64) -> Result<Assignment, String> {
    let table = parts(key)[0];
    if STUDIES.contains(&table) || CHECK.contains(&table) {
        return Err(format!(
            "names no number of the structure or of its motion, as \"arch.depth_m\" does: [{table}] says what is asked of them"
        ));
    }
    if !key.contains('.') {
        return Err("names no number of another table, as \"arch.depth_m\" does".to_owned());
    }
    let whole = value.fract() == 0.0 && value.abs() < 1e15;
    let text = if whole {
        format!("{key}={value:.0}")
    } else {
        format!("{key}={value:?}")
    };
    text.parse()
        .map_err(|_| format!("`{key}` names no number of another table, as \"arch.depth_m\" does"))
}
