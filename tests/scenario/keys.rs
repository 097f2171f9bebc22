//! The keys that a scenario allows, as the reader describes them, and their reference in the documents, which is written from this description.
//! `ARCHROCK_GOLDEN=write cargo test --test all -- summaries keys columns_have` writes it anew.

use crate::common::documents::assert_generated;
use crate::common::schema::violations;
use crate::common::{ARCH, COLUMN};
use archrock::Scenario;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// A table of a scenario: its path, and its schema.
type Described = (String, Value);

/// The alternatives of a schema.
fn ways(schema: &Value) -> Vec<&Value> {
    let any = schema["anyOf"].as_array();
    any.map_or(vec![schema], |any| any.iter().flat_map(ways).collect())
}

/// Returns true for a table `{ from, to, count }`, which is a range of values.
fn is_range(schema: &Value) -> bool {
    schema["properties"]["count"].is_object()
}

/// The keys of a table with their schemas.
fn properties(schema: &Value) -> impl Iterator<Item = (&str, &Value)> {
    let dotted = schema["patternProperties"].get("\\.");
    let dotted = dotted.map(|schema| ("\"table.key\"", schema));
    let keys = schema["properties"].as_object().into_iter().flatten();
    keys.map(|(key, schema)| (key.as_str(), schema))
        .chain(dotted)
}

/// Adds the tables of a schema, each before those in it.
fn add(tables: &mut Vec<Described>, path: &str, schema: &Value) {
    for way in ways(schema) {
        let (way, path) = match way["items"].is_object() {
            true => (&way["items"], format!("[{path}]")),
            false => (way, path.to_owned()),
        };
        if !way["properties"].is_object() || is_range(way) {
            continue;
        }
        tables.push((path.clone(), way.clone()));
        for (key, schema) in properties(way) {
            let inner = match path.strip_suffix(']') {
                Some(outer) if key != "\"table.key\"" => format!("{outer}.{key}]"),
                _ if path.is_empty() => key.to_owned(),
                _ => format!("{path}.{key}"),
            };
            add(tables, &inner, schema);
        }
    }
}

/// The order of the reference.
const ORDER: [&str; 25] = [
    "",
    "arch",
    "pointed_arch",
    "elliptic_arch",
    "basket_arch",
    "blocks",
    "column",
    "body",
    "piers",
    "fill",
    "load",
    "vehicle",
    "tie",
    "supports",
    "free_hinges",
    "elastic_joints",
    "impact",
    "initial",
    "ground",
    "simulation",
    "map",
    "suite",
    "uncertain",
    "demand",
    "verify",
];

fn tables() -> Vec<Described> {
    let mut tables = Vec::new();
    add(&mut tables, "", &Scenario::schema());
    tables.sort_by_key(|(path, _)| {
        let first = path.trim_matches(['[', ']']).split('.').next();
        ORDER
            .iter()
            .position(|name| Some(*name) == first)
            .expect("a place in the order")
    });
    tables
}

/// The keys of the tables with these paths.
pub fn keys_of(paths: &[&str]) -> BTreeSet<String> {
    let tables = tables();
    let named = tables
        .iter()
        .filter(|(path, _)| paths.contains(&path.as_str()));
    let keys: BTreeSet<String> = named
        .flat_map(|(_, schema)| properties(schema).map(|(key, _)| key.to_owned()))
        .collect();
    assert!(!keys.is_empty(), "{paths:?}");
    keys
}

/// A number as a user writes it.
fn number(value: &Value) -> String {
    if let Some(whole) = value.as_u64() {
        return whole.to_string();
    }
    let value = value.as_f64().unwrap();
    match value.abs() {
        PI => "pi".to_owned(),
        0.0 | 1e-3..1e6 => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// The allowed values of a schema, in words.
fn values(schema: &Value) -> String {
    let bounds = || {
        let bound = |key: &str| schema.get(key).map(number);
        let lowest =
            bound("minimum").or(bound("exclusiveMinimum").map(|low| format!("above {low}")));
        let highest =
            bound("maximum").or(bound("exclusiveMaximum").map(|high| format!("below {high}")));
        match (lowest, highest) {
            (Some(low), Some(high)) => format!(", {low} to {high}"),
            (Some(one), None) | (None, Some(one)) => format!(", {one}"),
            (None, None) => String::new(),
        }
    };
    if let Some(names) = schema["enum"].as_array() {
        let names: Vec<String> = names
            .iter()
            .map(|name| format!("`{}`", name.as_str().unwrap()))
            .collect();
        return names.join(", ");
    }
    if schema["anyOf"].is_array() {
        let mut ways: Vec<String> = ways(schema).into_iter().map(values).collect();
        ways.dedup();
        return ways.join(" or ");
    }
    match schema["type"].as_str().unwrap() {
        "object" if is_range(schema) => "range".to_owned(),
        "object" => "table".to_owned(),
        "array" if schema["items"]["type"] == "object" => "list of tables".to_owned(),
        "array" => format!("list: {}", values(&schema["items"])),
        "string" => match schema["examples"].as_array() {
            Some(examples) => {
                let examples: Vec<String> = examples
                    .iter()
                    .map(|one| format!("`{}`", one.as_str().unwrap()))
                    .collect();
                examples.join(", ")
            }
            None => "text".to_owned(),
        },
        "boolean" => "true or false".to_owned(),
        "integer" => format!("whole number{}", bounds()),
        "number" => format!("number{}", bounds()),
        other => panic!("{other}"),
    }
}

/// The rows of a table.
fn rows(schema: &Value) -> String {
    let required = schema["required"].as_array().into_iter().flatten();
    let required: Vec<&str> = required.map(|key| key.as_str().unwrap()).collect();
    let mut text = String::new();
    for (key, schema) in properties(schema) {
        let default = match &schema["default"] {
            _ if required.contains(&key) => "required".to_owned(),
            Value::Null => String::new(),
            Value::String(word) => format!("`{word}`"),
            Value::Bool(value) => value.to_string(),
            other if other.is_number() => number(other),
            _ => String::new(),
        };
        let meaning = schema["description"]
            .as_str()
            .unwrap_or_else(|| panic!("`{key}` has no meaning"));
        writeln!(
            text,
            "| `{key}` | {meaning} | {} | {default} |",
            values(schema)
        )
        .unwrap();
    }
    text
}

/// The relations between the keys of a table, each as a sentence.
fn relations(schema: &Value, sentences: &mut Vec<String>) {
    let code = |key: &Value| format!("`{}`", key.as_str().unwrap());
    let codes = |keys: &Value| {
        keys.as_array()
            .unwrap()
            .iter()
            .map(code)
            .collect::<Vec<_>>()
            .join(", ")
    };
    let each = |ways: &Value| {
        let ways = ways.as_array().unwrap().iter();
        ways.map(|way| codes(&way["required"]))
            .collect::<Vec<_>>()
            .join(", ")
    };
    for relation in schema["allOf"].as_array().into_iter().flatten() {
        let relation: &Map<String, Value> = relation.as_object().unwrap();
        let (keyword, rule) = relation.iter().next().unwrap();
        match keyword.as_str() {
            "oneOf" => sentences.push(format!("Exactly one of {}.", each(rule))),
            "anyOf" => sentences.push(format!("At least one of {}.", each(rule))),
            "not" => sentences.push(format!("Not both of {}.", codes(&rule["required"]))),
            "allOf" => relations(&Value::Object(relation.clone()), sentences),
            "dependencies" => {
                for (key, needed) in rule.as_object().unwrap() {
                    let needed = needed
                        .as_array()
                        .unwrap()
                        .iter()
                        .filter(|other| *other != key);
                    let needed: Vec<String> = needed.map(code).collect();
                    sentences.push(format!("`{key}` needs {}.", needed.join(", ")));
                }
            }
            other => panic!("{other}"),
        }
    }
}

/// The keys that describe a record file: those that `[suite]` and `[verify]` share.
fn keys_of_a_record_file(tables: &[Described]) -> (Vec<String>, Vec<String>) {
    let described = |path: &str| {
        let (_, schema) = tables.iter().find(|(known, _)| known == path).unwrap();
        let mut sentences = Vec::new();
        relations(schema, &mut sentences);
        let rows = rows(schema).lines().map(str::to_owned).collect();
        (rows, sentences)
    };
    let (rows, sentences): (Vec<String>, Vec<String>) = described("suite");
    let (others, other_sentences): (Vec<String>, Vec<String>) = described("verify");
    let shared = |one: Vec<String>, other: &[String]| -> Vec<String> {
        one.into_iter()
            .filter(|line| other.contains(line))
            .collect()
    };
    (shared(rows, &others), shared(sentences, &other_sentences))
}

/// Name of a table, the way to give its spectra, and its text. The keys of a record file stand in a table of their own.
fn section(
    path: &str,
    schema: &Value,
    (of_a_file, relations_of_a_file): &(Vec<String>, Vec<String>),
) -> (String, &'static str, String) {
    let mut sentences = Vec::new();
    relations(schema, &mut sentences);
    let rows = rows(schema);
    let has_file = of_a_file
        .iter()
        .all(|row| rows.lines().any(|own| own == row));
    let mut text = "| key | meaning | values | default |\n|---|---|---|---|\n".to_owned();
    for row in rows.lines() {
        if !has_file || !of_a_file.iter().any(|known| known == row) {
            writeln!(text, "{row}").unwrap();
        }
    }
    if has_file {
        sentences.retain(|sentence| !relations_of_a_file.contains(sentence));
        sentences.push("Also the [keys of a record file](#keys-of-a-record-file).".to_owned());
    }
    if !sentences.is_empty() {
        write!(text, "\n{}\n", sentences.join(" ")).unwrap();
    }
    // The check reads its spectra from files, or computes them by the code: each way has tables with these names.
    let has_spectra = |schema: &Value| schema["properties"]["spectrum"].is_object();
    let way = match path {
        "demand" if has_spectra(&schema["properties"]["slv"]) => ", spectra from files",
        "demand.sld" | "demand.slv" | "demand.slc" if has_spectra(schema) => ", spectra from files",
        "demand" | "demand.sld" | "demand.slv" | "demand.slc" => ", spectra by the code",
        _ => "",
    };
    let name = match path {
        "" => "Tables of a scenario".to_owned(),
        _ => format!("`[{path}]`"),
    };
    (name, way, text)
}

/// Tables with the same keys share a section.
#[test]
fn the_reference_of_keys_is_written_from_the_schema() {
    let mut sections: Vec<(Vec<String>, &str, String)> = Vec::new();
    let tables = tables();
    let of_a_file = keys_of_a_record_file(&tables);
    assert!(of_a_file.0.len() > 10, "{of_a_file:?}");
    for (path, schema) in &tables {
        let (name, way, text) = section(path, schema, &of_a_file);
        match sections.iter_mut().find(|(_, _, known)| *known == text) {
            Some((names, ..)) => names.push(name),
            None => sections.push((vec![name], way, text)),
        }
    }
    assert!(sections.len() > 30, "{} sections", sections.len());
    let mut text = String::new();
    for (names, way, table) in sections {
        write!(text, "\n### {}{way}\n\n{table}", names.join(", ")).unwrap();
    }
    let (rows, sentences) = of_a_file;
    write!(
        text,
        "\n### Keys of a record file\n\n| key | meaning | values | default |\n|---|---|---|---|\n{}\n\n{}\n",
        rows.join("\n"),
        sentences.join(" ")
    )
    .unwrap();
    assert_generated(
        "docs/scenario.md",
        "tests/scenario/keys.rs from the reader",
        &text,
    );
}

/// All meanings in a schema, ranges included.
fn descriptions<'s>(schema: &'s Value, found: &mut BTreeSet<&'s str>) {
    found.extend(schema["description"].as_str());
    let inner = [
        schema.as_object().map(|all| all.values().collect()),
        schema.as_array().map(|all| all.iter().collect()),
    ];
    let inner: Vec<Vec<&Value>> = inner.into_iter().flatten().collect();
    inner
        .into_iter()
        .flatten()
        .for_each(|schema| descriptions(schema, found));
}

/// No meaning is left over from a key that is no longer read.
#[test]
fn every_meaning_is_that_of_a_key() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scenario/meanings.txt");
    let text = fs::read_to_string(path).unwrap();
    let schema = Scenario::schema();
    let mut used = BTreeSet::new();
    descriptions(&schema, &mut used);
    let mut meanings = 0;
    for line in text.lines().filter(|line| !line.starts_with(['#', '['])) {
        let Some((key, meaning)) = line.split_once(": ") else {
            assert!(line.is_empty(), "{line}");
            continue;
        };
        assert!(
            used.contains(meaning),
            "`{key}` is not read, or a section above has it"
        );
        assert!(!meaning.contains('|') && !meaning.ends_with('.'), "{line}");
        meanings += 1;
    }
    assert!(meanings > 150, "{meanings}");
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
            &format!("{normal}damping_time_s = 1e-4\nrebound_ratio = 0.9\n"),
            &not_with("rebound_ratio", "damping_time_s"),
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
            format!("[impact]\nmodel = 'mirrored'\n{elastic}"),
            "table `impact` cannot be combined with [elastic_joints]",
        ),
        (
            "[impact]\nmodel = 'mirrored'\n[free_hinges]\n".to_owned(),
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

/// Paths of the tables with numbers that describe the structure and its motion, without marks of lists.
pub fn tables_with_numbers() -> BTreeSet<String> {
    let studies = ["map", "suite", "uncertain", "demand", "verify"];
    let is_number = |(_, schema): (&str, &Value)| {
        let mut ways = ways(schema).into_iter();
        ways.any(|way| way["type"] == "number" || way["type"] == "integer")
    };
    let tables = tables().into_iter();
    let numeric = tables.filter(|(_, schema)| properties(schema).any(is_number));
    let paths = numeric.map(|(path, _)| path.replace(['[', ']'], ""));
    let of_structure = |path: &String| !studies.iter().any(|study| path.starts_with(study));
    paths.filter(of_structure).collect()
}
