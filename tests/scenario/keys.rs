//! The keys that a scenario allows, as the reader describes them, and their description in the documents.

use archrock::Scenario;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

pub fn document(name: &str) -> String {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    fs::read_to_string(docs.join(name)).unwrap()
}

/// The parts of a text in backticks.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// The cells of a row of a table in a document.
fn cells(row: &str) -> Vec<&str> {
    row.split('|').map(str::trim).collect()
}

/// Rows of the reference below the heading of a table; `None`: there is no such heading.
fn rows_of<'d>(reference: &'d str, table: &str) -> Option<Vec<Vec<&'d str>>> {
    let heading = format!("| **`[{table}]`** |");
    let mut lines = reference.lines();
    lines.find(|line| line.starts_with(&heading))?;
    let rows = lines.take_while(|line| line.starts_with("| `"));
    Some(rows.map(cells).collect())
}

/// Rows of the reference below the heading of a table: the keys, and the default.
pub fn rows(reference: &str, table: &str) -> Vec<(Vec<String>, String)> {
    let rows = rows_of(reference, table).expect("a heading").into_iter();
    rows.map(|cells| {
        let keys = code(cells[1]).map(str::to_owned).collect();
        (keys, cells[3].to_owned())
    })
    .collect()
}

/// The tables that a schema describes, each with the schemas of its keys and the keys that are required.
type Tables = BTreeMap<String, (BTreeMap<String, Value>, BTreeSet<String>)>;

fn add(tables: &mut Tables, name: &str, schema: &Value) {
    for one in schema["anyOf"].as_array().into_iter().flatten() {
        add(tables, name, one);
    }
    if schema["items"].is_object() {
        add(tables, &format!("[{name}]"), &schema["items"]);
    }
    let Some(properties) = schema["properties"].as_object() else {
        return;
    };
    let (keys, required) = tables.entry(name.to_owned()).or_default();
    for (key, schema) in properties {
        keys.insert(key.clone(), schema.clone());
    }
    let names = schema["required"].as_array().into_iter().flatten();
    required.extend(names.map(|key| key.as_str().unwrap().to_owned()));
    let dotted = &schema["patternProperties"]["\\."];
    let inner = properties
        .iter()
        .map(|(key, schema)| (key.as_str(), schema));
    for (key, schema) in inner.chain([("\"table.key\"", dotted)]) {
        let name = match name.strip_suffix(']') {
            Some(outer) => format!("{outer}.{key}]"),
            None if name.is_empty() => key.to_owned(),
            None => format!("{name}.{key}"),
        };
        add(tables, &name, schema);
    }
}

fn tables() -> Tables {
    let mut tables = Tables::new();
    add(&mut tables, "", &Scenario::schema());
    tables
}

/// The heading of the reference under which a table is described.
fn heading(table: &str) -> &str {
    match table {
        "supports.left" => "supports.right",
        "ground.record" | "ground.right" => table,
        kind if kind.starts_with("ground.") && kind.matches('.').count() == 1 => "ground.<kind>",
        other => other,
    }
}

/// The document that describes tables which the reference only names.
fn other_document(table: &str) -> &'static str {
    let name = table.trim_matches(['[', ']']);
    match name.split('.').next().unwrap_or_default() {
        "demand" | "verify" => "verify.md",
        "uncertain" => "uncertain.md",
        "ground" => "records.md",
        "map" | "suite" => "maps.md",
        _ => "shapes.md",
    }
}

/// Every table of the reader is described: in the reference, which has all of its keys and no others, or in the document to which the
/// reference refers, which names all of them.
#[test]
fn the_documents_have_the_keys_that_are_read() {
    let reference = document("scenario.md");
    let tables = tables();
    assert!(tables.len() > 50, "{} tables", tables.len());
    let mut read: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (name, (keys, _)) in tables.iter().filter(|(name, _)| !name.is_empty()) {
        let keys = keys.keys().map(String::as_str);
        read.entry(heading(name)).or_default().extend(keys);
    }
    let mut compared = 0;
    for (table, mut keys) in read {
        let rows = rows_of(&reference, table).unwrap_or_default();
        if rows.is_empty() {
            let text = document(other_document(table)) + &reference;
            let named: BTreeSet<&str> = code(&text)
                .flat_map(|code| code.split(|c: char| !(c == '_' || c.is_alphanumeric())))
                .collect();
            for key in keys {
                let file = other_document(table);
                assert!(
                    named.contains(key),
                    "{file} does not name `{key}` of [{table}]"
                );
            }
            continue;
        }
        // Joints of unequal voussoirs are described with other shapes.
        keys.remove("joints_deg");
        let described: BTreeSet<&str> = rows.iter().flat_map(|cells| code(cells[1])).collect();
        assert_eq!(keys, described, "[{table}]");
        compared += 1;
    }
    assert!(compared >= 14, "{compared} tables");
}

/// Every key in the tables of the documents is a key of the reader.
#[test]
fn the_documents_name_no_other_keys() {
    let tables = tables();
    let keys: BTreeSet<&str> = tables
        .values()
        .flat_map(|(keys, _)| keys.keys())
        .map(String::as_str)
        .collect();
    for file in ["scenario.md", "verify.md"] {
        let text = document(file);
        let mut lines = text.lines();
        while lines.any(|line| line.starts_with("| key |")) {
            let rows = lines.by_ref().take_while(|line| line.starts_with('|'));
            for row in rows.filter(|row| row.starts_with("| `")) {
                for key in code(cells(row)[1]) {
                    assert!(keys.contains(key), "{file} has `{key}`, which is not read");
                }
            }
        }
    }
}

/// The two numbers of `3 to 200` in a text.
fn bounds(text: &str) -> Option<[f64; 2]> {
    let words: Vec<&str> = text.split([' ', '(', ')', ';', ',']).collect();
    let number = |word: &str| word.parse::<f64>().ok();
    words.windows(3).find_map(|words| match words {
        [from, "to", to] => Some([number(from)?, number(to)?]),
        _ => None,
    })
}

/// The bounds of a number, or of the numbers of an array.
fn limits(schema: &Value) -> Option<[f64; 2]> {
    let any = schema["anyOf"].as_array().into_iter().flatten();
    let numbers = any.map(|one| &one["items"]).chain([schema]);
    let mut limits =
        numbers.filter_map(|one| Some([one["minimum"].as_f64()?, one["maximum"].as_f64()?]));
    limits.next()
}

/// The reference has the defaults and bounds of the reader, and says which keys are required.
#[test]
fn the_reference_has_the_defaults_and_bounds_that_are_read() {
    let reference = document("scenario.md");
    let (mut defaults, mut ranges) = (0, 0);
    for (table, (schemas, required)) in tables() {
        for cells in rows_of(&reference, heading(&table)).unwrap_or_default() {
            let keys: Vec<&str> = code(cells[1]).collect();
            for (key, default) in keys.iter().zip(cells[3].split(", ")) {
                let Some(schema) = schemas.get(*key) else {
                    continue;
                };
                if required.contains(*key) {
                    assert!(
                        default.ends_with("required"),
                        "`{key}` of [{table}] is required"
                    );
                }
                let default = default.trim_matches('`');
                let described = match default.parse::<f64>() {
                    Ok(number) => Value::from(number),
                    Err(_) => default.into(),
                };
                let read = match &schema["default"] {
                    Value::Number(number) => number.as_f64().into(),
                    Value::Bool(value) => value.to_string().into(),
                    other => other.clone(),
                };
                if !read.is_null() && described != "" || described.is_number() {
                    assert_eq!(described, read, "`{key}` of [{table}]");
                    defaults += 1;
                }
            }
            if let ([key], Some(bounds)) = (&keys[..], bounds(cells[2]))
                && let Some(schema) = schemas.get(*key)
                && let Some(read) = limits(schema)
            {
                assert_eq!(bounds, read, "`{key}` of [{table}]");
                ranges += 1;
            }
        }
    }
    assert!(defaults >= 25, "{defaults} defaults");
    assert!(ranges >= 8, "{ranges} ranges");
}

/// All scenarios of the repository follow the schema, as an editor checks them: no key is unknown, and all required ones are there.
#[test]
fn scenarios_follow_the_schema() {
    let tables = tables();
    let check = |table: &toml::Table, name: &str| {
        let (keys, required) = &tables[name];
        for key in table.keys().filter(|key| !key.contains('.')) {
            assert!(keys.contains_key(key), "`{key}` of [{name}]");
        }
        if !matches!(name, "demand" | "demand.slv" | "demand.slc" | "demand.sld") {
            assert!(
                required.iter().all(|key| table.contains_key(key)),
                "[{name}]"
            );
        }
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut checked = 0;
    for file in fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            let text = fs::read_to_string(&path).unwrap();
            let root: toml::Table = toml::from_str(&text).unwrap();
            check(&root, "");
            for (name, value) in &root {
                if let Some(table) = value.as_table() {
                    check(table, name);
                }
            }
            checked += 1;
        }
    }
    assert!(checked > 10);
}
