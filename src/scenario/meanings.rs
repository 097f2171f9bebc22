//! Meanings of the keys of a scenario, for editors and for the reference in the documents.

use serde_json::Value;

/// Sections, each headed by the names of tables in brackets, with a line `key: meaning` for each key.
const TEXT: &str = include_str!("meanings.txt");

/// Adds the meaning of each key to the schema of the table with this path, and to those of the tables in it.
pub(super) fn add(schema: &mut Value, path: &str) {
    let join = |key: &str| match path {
        "" => key.to_owned(),
        _ => format!("{path}.{key}"),
    };
    let Some(keywords) = schema.as_object_mut() else {
        return;
    };
    for (keyword, value) in keywords {
        match (keyword.as_str(), value) {
            ("anyOf", Value::Array(ways)) => ways.iter_mut().for_each(|way| add(way, path)),
            ("items", items) => add(items, path),
            ("properties" | "patternProperties", Value::Object(keys)) => {
                for (key, schema) in keys {
                    let key = if key == "\\." { "\"table.key\"" } else { key };
                    add(schema, &join(key));
                    if let Some(meaning) = meaning(path, key) {
                        schema["description"] = meaning.into();
                    }
                }
            }
            _ => {}
        }
    }
}

/// Meaning of a key: that of the first section of its table that has the key.
fn meaning(table: &str, key: &str) -> Option<&'static str> {
    let mut sections = TEXT
        .split("\n\n[")
        .skip(1)
        .filter_map(|section| section.split_once("]\n"));
    sections.find_map(|(tables, lines)| {
        tables.split("] [").find(|name| fits(name, table))?;
        let mut lines = lines.lines().filter_map(|line| line.split_once(": "));
        let (_, meaning) = lines.find(|(known, _)| fits(known, key))?;
        Some(meaning)
    })
}

/// True if a name is the given one, of which a part `*` stands for any part.
fn fits(given: &str, name: &str) -> bool {
    let [given, name] = [given, name].map(|path| path.split('.').collect::<Vec<_>>());
    let mut parts = given.iter().zip(&name);
    given.len() == name.len() && parts.all(|(given, part)| ["*", part].contains(given))
}
