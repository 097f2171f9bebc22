//! Writes the resolved scenario as TOML text.

use serde_json::{Map, Value};

use archrock_text::is_hidden;

/// Text of a table and of all tables in it. A table with the key `from` or `deviation` is a range or a distribution, and is written
/// in one line.
pub(crate) fn toml_text(table: &Value) -> String {
    let mut text = String::new();
    write_table(&mut text, "", table.as_object().unwrap_or(&Map::new()));
    text
}

fn write_table(text: &mut String, name: &str, table: &Map<String, Value>) {
    let (tables, keys): (Vec<_>, Vec<_>) = table.iter().partition(|(_, value)| {
        let is_distribution =
            |table: &Map<_, _>| table.contains_key("from") || table.contains_key("deviation");
        value
            .as_object()
            .is_some_and(|table| !is_distribution(table))
    });
    // An empty table has a meaning too, so its header is written.
    if !name.is_empty() && (!keys.is_empty() || tables.is_empty()) {
        if !text.is_empty() {
            text.push('\n');
        }
        *text += &format!("[{name}]\n");
    }
    for (key, value) in keys {
        *text += &format!("{} = {}\n", bare(key), inline(value));
    }
    for (key, value) in tables {
        let name = match name {
            "" => key.clone(),
            parent => format!("{parent}.{key}"),
        };
        write_table(text, &name, value.as_object().unwrap_or(&Map::new()));
    }
}

pub(super) fn inline(value: &Value) -> String {
    let all = |values: &[Value]| values.iter().map(inline).collect::<Vec<_>>();
    match value {
        Value::String(text) => quote_string(text),
        Value::Array(values) if values.iter().any(Value::is_string) => {
            format!("[\n    {},\n]", all(values).join(",\n    "))
        }
        Value::Array(values) => format!("[{}]", all(values).join(", ")),
        Value::Object(table) => {
            let pairs = table
                .iter()
                .map(|(key, value)| format!("{key} = {}", inline(value)));
            format!("{{ {} }}", pairs.collect::<Vec<_>>().join(", "))
        }
        // The shortest digits that read back as the same number; TOML libraries would write all zeros of 1e-9.
        Value::Number(number) if number.is_f64() => {
            format!("{:?}", number.as_f64().unwrap_or(f64::NAN))
        }
        Value::Null | Value::Bool(_) | Value::Number(_) => value.to_string(),
    }
}

/// Key, in quotation marks if it contains a dot.
fn bare(key: &str) -> String {
    if key.contains('.') {
        quote_string(key)
    } else {
        key.to_owned()
    }
}

/// String in the syntax of TOML.
pub(super) fn quote_string(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if is_hidden(c) => quoted += &format!("\\u{:04x}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}
