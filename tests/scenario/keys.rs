//! The keys that a scenario allows, as the reader describes them, and their description in the documents.

use crate::common::schema::violations;
use crate::common::{ARCH, COLUMN};
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
fn the_documents_list_all_keys_of_the_reader() {
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
fn the_reference_has_the_defaults_and_bounds_of_the_reader() {
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

/// All scenarios of the repository, and those to start from, are valid by the schema that editors use.
#[test]
fn scenarios_follow_the_schema() {
    let schema = Scenario::schema();
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut checked = 0;
    for folder in [
        "scenarios",
        "scenarios/recipes",
        "scenarios/uncertain",
        "src/cli/init",
    ] {
        for file in fs::read_dir(repository.join(folder)).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "toml") {
                let text = fs::read_to_string(&path).unwrap();
                let value: Value = toml::from_str(&text).unwrap();
                let place = path.display().to_string();
                assert_eq!(violations(&schema, &value, &place), [""; 0]);
                checked += 1;
            }
        }
    }
    assert!(checked >= 25, "{checked}");
}

/// Scenarios that the reader accepts and that give some keys in a rare place are valid by the schema as well.
#[test]
fn the_schema_allows_all_ways_to_give_a_table() {
    let schema = Scenario::schema();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("slv.csv"), "0,0.2\n0.5,0.4\n4,0.1\n").unwrap();
    for more in [
        "[demand.slv]\nspectrum = 'slv.csv'\n",
        "[piers]\nwidth_m = 2.0\n[piers.left]\nheight_m = 3.0\n[piers.right]\nheight_m = 2.0\n[free_hinges]\n",
    ] {
        let text = format!("{ARCH}voussoirs = 9\n{more}");
        let name = folder.path().join("s.toml");
        Scenario::parse(&text, name.to_str().unwrap()).unwrap();
        let value = toml::from_str(&text).unwrap();
        assert_eq!(violations(&schema, &value, ""), [""; 0]);
    }
}

/// A text that breaks one relation between keys is refused by the reader in these words, and by the schema.
#[test]
fn every_relation_between_keys_is_checked() {
    let schema = Scenario::schema();
    let refused = |text: &str, words: &str| {
        let errors = Scenario::parse(text, "s.toml").unwrap_err().to_string();
        assert!(errors.contains(words), "{words:?} is not in: {errors}");
        let value = toml::from_str(text).unwrap();
        assert!(!violations(&schema, &value, "").is_empty(), "{text}");
    };
    let one = "needs exactly one of the";
    let not_with = |key: &str, other: &str| format!("`{key}` cannot be combined with `{other}`");
    let needs = |other: &str| format!("needs `{other}`");
    refused("", one);
    refused(&format!("{ARCH}{COLUMN}"), &not_with("column", "arch"));
    let drums = "drums = 2\ndrum_heights_m = [2, 2]\n[free_hinges]\n";
    refused(
        &format!("{COLUMN}{drums}"),
        &not_with("drum_heights_m", "drums"),
    );
    let shape = "[arch]\nthickness_ratio = 0.15\n";
    for (keys, words) in [
        ("embrace_deg = 180.0\n", "lacks `mean_radius_m`: give"),
        (
            "mean_radius_m = 5\nspan_m = 10\nmeasured_at = 'mean'\nrise_m = 5\n",
            &not_with("span_m", "mean_radius_m"),
        ),
        ("mean_radius_m = 5\n", one),
        (
            "span_m = 10\nmeasured_at = 'mean'\nrise_m = 5\nembrace_deg = 180.0\n",
            &not_with("embrace_deg", "rise_m"),
        ),
        ("mean_radius_m = 5\nrise_m = 5\n", &needs("span_m")),
        (
            "mean_radius_m = 5\nembrace_deg = 180.0\nmeasured_at = 'mean'\n",
            &needs("span_m"),
        ),
        ("span_m = 10\nrise_m = 5\n", &needs("measured_at")),
        (
            "mean_radius_m = 5\nembrace_deg = 180.0\nthickness_m = 1\n",
            &not_with("thickness_m", "thickness_ratio"),
        ),
        (
            "mean_radius_m = 5\nembrace_deg = 180.0\nvoussoirs = 9\njoints_deg = [0, 90, 180]\n",
            &not_with("joints_deg", "voussoirs"),
        ),
    ] {
        refused(&format!("{shape}{keys}"), words);
    }
    let arch = format!("{ARCH}voussoirs = 9\n");
    let tie = "from_m = [0, 1]\nto_m = [1, 1]\n";
    let bar = "height_m = 2\narea_mm2 = 400\nmodulus_gpa = 200\n";
    for (keys, words) in [
        ("stiffness_n_m = 1e6\n", one),
        (
            &format!("{bar}between = 'springings'\n"),
            &not_with("between", "height_m"),
        ),
        (
            &format!("{bar}from_m = [0, 1]\n"),
            &not_with("from_m", "height_m"),
        ),
        ("from_m = [0, 1]\nstiffness_n_m = 1e6\n", &needs("to_m")),
        (&format!("{bar}from_block = 1\n"), &needs("from_m")),
        (&format!("{bar}to_block = 1\n"), &needs("to_m")),
        (tie, one),
        (
            &format!("{bar}stiffness_n_m = 1e6\n"),
            &not_with("stiffness_n_m", "area_mm2"),
        ),
        (&format!("{tie}area_mm2 = 400\n"), &needs("modulus_gpa")),
        (
            &format!("{tie}stiffness_n_m = 1e6\nmodulus_gpa = 200\n"),
            &needs("area_mm2"),
        ),
        (
            &format!("{bar}yield_force_n = 1e5\nyield_stress_mpa = 200\n"),
            &not_with("yield_stress_mpa", "yield_force_n"),
        ),
        (
            &format!("{tie}stiffness_n_m = 1e6\nyield_stress_mpa = 200\n"),
            &needs("area_mm2"),
        ),
    ] {
        refused(&format!("{arch}[[tie]]\n{keys}"), words);
    }
    let (normal, stone) = ("normal_stiffness_gpa_m = 10\n", "stone_modulus_gpa = 10\n");
    for (keys, words) in [
        ("", "lacks a stiffness"),
        (
            &format!("{normal}{stone}"),
            &not_with("stone_modulus_gpa", "normal_stiffness_gpa_m"),
        ),
        (
            &format!("{stone}shear_stiffness_gpa_m = 4\n"),
            "goes with `normal_stiffness_gpa_m`",
        ),
        (
            &format!("{stone}mortar_modulus_gpa = 1\n"),
            &needs("mortar_thickness_m"),
        ),
        (
            &format!("{stone}mortar_thickness_m = 0.01\n"),
            &needs("mortar_modulus_gpa"),
        ),
        (
            &format!("{normal}mortar_modulus_gpa = 1\nmortar_thickness_m = 0.01\n"),
            "goes with `stone_modulus_gpa`",
        ),
        (
            &format!(
                "{normal}damping_time_s = 1e-4\ndamping_ratio = 0.1\ndamping_frequency_hz = 10\n"
            ),
            &not_with("damping_ratio", "damping_time_s"),
        ),
        (
            &format!(
                "{normal}damping_time_s = 1e-4\ndamping_ratio = 0.1\ndamping_frequency_hz = 10\n"
            ),
            &not_with("damping_frequency_hz", "damping_time_s"),
        ),
        (
            &format!("{normal}damping_ratio = 0.1\n"),
            &needs("damping_frequency_hz"),
        ),
        (
            &format!("{normal}damping_frequency_hz = 10\n"),
            &needs("damping_ratio"),
        ),
        (
            &format!("{normal}contact = 'continuous'\ncontact_points = 3\n"),
            &not_with("contact_points", "contact"),
        ),
    ] {
        refused(&format!("{arch}[elastic_joints]\n{keys}"), words);
    }
    let uncertain = |spread: &str| format!("[uncertain]\n\"arch.depth_m\" = {{ {spread} }}\n");
    let (code, state) = (
        "[demand]\nsoil = 'B'\n",
        "[demand.slv]\nag_g = 0.2\nf0 = 2.4\ntc_star_s = 0.3\n",
    );
    let (half, sine) = (
        "[ground.half_sine]\n",
        "amplitude_g = 0.1\nduration_s = 1\n",
    );
    let record = "[ground.record]\nfile = 'a.at2'\n";
    for (tables, words) in [
        (uncertain("distribution = 'normal'"), "must be a range"),
        (uncertain("from = 1, to = 2, deviation = 0.1"), &not_with("deviation", "from")),
        (uncertain("from = 1"), &needs("to")),
        (uncertain("deviation = 0.1, spacing = 'linear'"), &needs("from")),
        (uncertain("from = 1, to = 2, distribution = 'normal'"), &needs("deviation")),
        (uncertain("from = 1, to = 2, distribution = 'normal'"), &not_with("distribution", "from")),
        (format!("{code}{state}"), one),
        (format!("{code}topography = 'T1'\ntopographic_factor = 1.1\n{state}"), &not_with("topographic_factor", "topography")),
        ("[verify.free_standing]\n".to_owned(), one),
        ("[verify]\nfree_standing = { t0_s = 0.1, kappa = 6.2, length_m = 4, thickness_m = 0.8, modulus_gpa = 1 }\n".to_owned(), &not_with("kappa", "t0_s")),
        ("[verify]\nfree_standing = { kappa = 6.2, thickness_m = 0.8, modulus_gpa = 1 }\n".to_owned(), &needs("length_m")),
        ("[fill]\ndensity_kg_m3 = 1800\n".to_owned(), one),
        ("[fill]\ndensity_kg_m3 = 1800\nheight_m = 6\nabove_crown_m = 0.5\n".to_owned(), &not_with("above_crown_m", "height_m")),
        ("[ground]\n".to_owned(), one),
        (format!("{half}{sine}[ground.ricker]\n{sine}"), &not_with("ricker", "half_sine")),
        (format!("{half}{sine}[ground.right]\n"), one),
        (format!("{half}{sine}[ground.right]\ndelay_s = 1\napparent_velocity_m_s = 100\n"), &not_with("apparent_velocity_m_s", "delay_s")),
        (format!("{record}scale = 2\npeak_g = 0.3\n"), &not_with("peak_g", "scale")),
        ("[suite]\nrecords = 'a.at2'\n".to_owned(), one),
        ("[suite]\nrecords = 'a.at2'\nscales = [1]\npeaks_g = [1]\n".to_owned(), &not_with("peaks_g", "scales")),
    ] {
        refused(&format!("{arch}[free_hinges]\n{tables}"), words);
    }
    // The option `--hinges` chooses one of these tables, so only the reader refuses them together.
    let elastic = format!("[elastic_joints]\n{normal}");
    for (tables, words) in [
        (
            format!("[free_hinges]\n{elastic}"),
            "table `free_hinges` cannot be combined with [elastic_joints]",
        ),
        (
            format!("[impact]\n{elastic}"),
            "table `impact` cannot be combined with [elastic_joints]",
        ),
        (
            "[impact]\n[free_hinges]\n".to_owned(),
            "table `impact` cannot be combined with [free_hinges]",
        ),
    ] {
        let errors = Scenario::parse(&format!("{arch}{tables}"), "s.toml").unwrap_err();
        assert!(
            errors.to_string().contains(words),
            "{words:?} is not in: {errors}"
        );
    }
    // All broken relations are reported together.
    let tie = "from_block = 1\nto_block = 2\nmodulus_gpa = 200\nyield_stress_mpa = 200\nyield_force_n = 1\n";
    let errors = Scenario::parse(&format!("{arch}[[tie]]\n{tie}"), "s.toml").unwrap_err();
    assert_eq!(errors.0.len(), 7, "{errors}");
}
