//! A scenario with values that differ from those in its text.

use serde_json::Value;

use super::toml_text::toml_text;
use super::{Assignment, Changes, Ground, Scenario, Source};
use std::sync::Arc;

/// Tables that describe a study, not the structure or ground motion under study.
const STUDIES: [&str; 4] = ["map", "spectrum", "suite", "uncertain"];
/// Tables of the check, which needs no history.
const CHECK: [&str; 2] = ["demand", "verify"];
/// What precedes the keys of a record.
const RECORD: &str = "ground.record.";

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
        let set = others
            .into_iter()
            .map(|(key, value)| assignment(key, value))
            .collect::<Result<Vec<_>, _>>()?;
        let mut table = self.to_json();
        if let Value::Object(table) = &mut table {
            for left_out in STUDIES.iter().chain(&CHECK) {
                table.shift_remove(*left_out);
            }
            if record.is_some() {
                table.shift_remove("ground");
            }
        }
        let text = table.as_object().map_or(String::new(), toml_text);
        let changes = Changes {
            hinges: None,
            set: &set,
        };
        let mut changed = Self::of(&Source::of_text(&text, ""), &changes)
            .map_err(|errors| errors.as_slice()[0].message.clone())?;
        if let Some(record) = record {
            let gravity_m_s2 = changed.simulation.gravity_m_s2;
            let of_record: Vec<_> = of_record
                .iter()
                .map(|(key, value)| (&key[RECORD.len()..], *value))
                .collect();
            let record = record.with_values(&of_record, gravity_m_s2)?;
            changed.ground_motion = Arc::new(record.motion(gravity_m_s2));
            changed.ground = Some(Ground::Record(Box::new(record)));
        }
        Ok(changed)
    }
}

/// An assignment of a number to a key of a table; whole numbers may stand for counts.
fn assignment(key: &str, value: f64) -> Result<Assignment, String> {
    let is_study = key
        .split('.')
        .next()
        .is_some_and(|table| STUDIES.contains(&table.trim()));
    if is_study || !key.contains('.') {
        return Err("names no number of another table, as \"arch.depth_m\" does".to_owned());
    }
    let whole = value.fract() == 0.0 && value.abs() < 1e15;
    let text = if whole {
        format!("{key}={value:.0}")
    } else {
        format!("{key}={value:?}")
    };
    text.parse()
}
