//! The keys that a scenario allows, and their description in the documents.

use crate::common::{ARCH, parsed};
use archrock::Scenario;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

pub fn document(name: &str) -> String {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    fs::read_to_string(docs.join(name)).unwrap()
}

/// The keys that the reader allows in a table, or in `[name]` for one of a list, taken from the error about an unknown one.
fn known(table: &str) -> BTreeSet<String> {
    const UNKNOWN: &str = "no_such_key";
    let lines = format!("[{table}]\n{UNKNOWN} = 1\n");
    let arch = if table == "arch" || table == "column" {
        ""
    } else {
        ARCH
    };
    let errors = Scenario::parse(&format!("{arch}{lines}"), "s.toml").unwrap_err();
    let name = table.trim_matches(['[', ']']);
    let said = format!("unknown key `{UNKNOWN}` in [{name}]; known keys: ");
    let keys = errors
        .as_slice()
        .iter()
        .find_map(|error| error.message.strip_prefix(&said));
    let keys = keys.unwrap_or_else(|| panic!("{errors}"));
    keys.split(", ").map(str::to_owned).collect()
}

/// The parts of a text in backticks.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Rows of the reference below the heading of a table: the keys, and the default.
pub fn rows(reference: &str, table: &str) -> Vec<(Vec<String>, String)> {
    let heading = format!("| **`[{table}]`** |");
    let mut lines = reference
        .lines()
        .skip_while(|line| !line.starts_with(&heading));
    assert!(lines.next().is_some(), "{heading} is a heading");
    let rows = lines.take_while(|line| line.starts_with("| `"));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let keys = code(cells[1]).map(str::to_owned).collect();
        (keys, cells[3].to_owned())
    })
    .collect()
}

/// The reference names every key of a table, and no other.
#[test]
fn the_reference_has_the_keys_that_are_read() {
    let reference = document("scenario.md");
    let tables = [
        ("arch", vec!["arch"]),
        ("column", vec!["column"]),
        ("free_hinges", vec!["free_hinges"]),
        ("elastic_joints", vec!["elastic_joints"]),
        ("supports", vec!["supports"]),
        ("supports.right", vec!["supports.right", "supports.left"]),
        ("[tie]", vec!["[tie]"]),
        (
            "ground.<kind>",
            vec!["ground.rectangular", "ground.gabor", "ground.windowed_sine"],
        ),
        ("ground.right", vec!["ground.right"]),
        ("impact", vec!["impact"]),
        ("initial", vec!["initial"]),
        ("simulation", vec!["simulation"]),
        ("suite", vec!["suite"]),
        ("uncertain", vec!["uncertain"]),
    ];
    for (heading, tables) in tables {
        let mut read: BTreeSet<String> = tables.into_iter().flat_map(known).collect();
        // Joints of unequal voussoirs are described with other shapes.
        read.remove("joints_deg");
        let rows = rows(&reference, heading);
        let told: BTreeSet<String> = rows.into_iter().flat_map(|(keys, _)| keys).collect();
        assert_eq!(read, told, "[{heading}]");
    }
}

/// Documents that describe a table elsewhere name all its keys.
#[test]
fn other_documents_name_all_keys() {
    for (file, tables) in [
        ("maps.md", &["map"][..]),
        ("records.md", &["ground.record"]),
        ("verify.md", &["demand", "verify"]),
        ("uncertain.md", &["uncertain"]),
        (
            "shapes.md",
            &[
                "pointed_arch",
                "elliptic_arch",
                "basket_arch",
                "blocks",
                "piers",
                "fill",
            ],
        ),
    ] {
        let text = document(file) + &document("scenario.md");
        let told: BTreeSet<&str> = code(&text).collect();
        for table in tables {
            for key in known(table) {
                let mut words = told
                    .iter()
                    .flat_map(|code| code.split(|c: char| !(c == '_' || c.is_alphanumeric())));
                let is_told = words.any(|word| word == key);
                assert!(is_told, "{file} does not name `{key}` of [{table}]");
            }
        }
    }
}

/// The reference names the actual defaults.
#[test]
fn the_reference_has_the_defaults_that_are_taken() {
    let reference = document("scenario.md");
    let ground = "[ground.gabor]\namplitude_g = 0.1\nduration_s = 0.5\n";
    let arch = parsed(&format!("{ARCH}{ground}")).to_json();
    let column = parsed("[column]\nheight_m = 1.0\nwidth_m = 0.5\n").to_json();
    let mut compared = 0;
    for (table, taken) in [
        ("arch", &arch["arch"]),
        ("column", &column["column"]),
        ("ground.<kind>", &arch["ground"]["gabor"]),
        ("impact", &arch["impact"]),
        ("simulation", &arch["simulation"]),
    ] {
        for (keys, defaults) in rows(&reference, table) {
            for (key, default) in keys.iter().zip(defaults.split(", ")) {
                let default = default.trim_matches('`');
                let said = match default.parse::<f64>() {
                    Ok(number) => number.into(),
                    Err(_) => serde_json::Value::from(default),
                };
                let is = match &taken[key] {
                    serde_json::Value::Number(number) => number.as_f64().into(),
                    other => other.clone(),
                };
                if !is.is_null() && default != "required" && default != "one required" {
                    assert_eq!(said, is, "`{key}` of [{table}]");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared >= 14, "{compared} defaults");
}
