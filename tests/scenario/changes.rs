//! A number is changed in one way: by `--set`, an axis, a sample, or `--set` on the text that `check` prints.

use std::fs;
use std::path::{Path, PathBuf};
use std::slice;

use archrock::scenario::{Assignment, MODELS, ReadOptions, Scenario, Source};
use serde_json::Value;

use crate::common::documents::repository;
use crate::common::program::is_for_statics;

/// Tables whose numbers describe studies.
const STUDIES: [&str; 5] = ["map", "suite", "uncertain", "demand", "verify"];

/// Returns the scenario files of the repository.
fn scenario_files() -> Vec<PathBuf> {
    fn add(folder: &Path, files: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                add(&path, files);
            } else if path.extension().is_some_and(|end| end == "toml") {
                files.push(path);
            }
        }
    }
    let mut files = Vec::new();
    add(&repository().join("scenarios"), &mut files);
    files.sort();
    files
}

/// Structures that are given in other ways than by their resolved keys. Each text contains its own ground motion.
fn other_texts() -> Vec<String> {
    let ground = "[ground.one_sine]\namplitude_g = 0.3\nduration_s = 0.5\n";
    let measured =
        "span_m = 6\nrise_m = 2\nthickness_m = 0.6\nmeasured_at = 'intrados'\nvoussoirs = 11\n";
    let drums = "[column]\nheight_m = 4\nwidth_m = 0.8\n";
    [
        format!("[arch]\n{measured}"),
        format!("[arch]\n{measured}[piers]\nheight_m = 1\nwidth_m = 1.2\n"),
        format!("[arch]\n{measured}[piers]\nwidth_m = 1.2\n[piers.left]\nheight_m = 1\n[piers.right]\nheight_m = 1.5\nblocks = 2\n"),
        format!("[basket_arch]\n{measured}[fill]\nabove_crown_m = 0.2\ndensity_kg_m3 = 1500\n"),
        format!("[elliptic_arch]\n{measured}").replace("intrados", "extrados"),
        format!("[pointed_arch]\n{measured}").replace("rise_m = 2", "rise_m = 4"),
        String::from("[arch]\nmean_radius_m = 3\nthickness_m = 0.6\nembrace_deg = 150\njoints_deg = [0.0, 20.0, 50.0, 75.0, 100.0, 150.0]\n[free_hinges]\n"),
        String::from("[arch]\nspan_m = 6\nembrace_deg = 160\nthickness_ratio = 0.15\nmeasured_at = 'extrados'\n[impact]\nmodel = 'prescribed'\nrestitution = 0.8\n"),
        format!("{drums}drum_heights_m = [1.0, 1.0, 2.0]\n[free_hinges]\n"),
        format!("{drums}drums = 4\ntop_width_m = 0.7\n[elastic_joints]\nnormal_stiffness_gpa_m = 10\ndamping_ratio = 0.05\ndamping_frequency_hz = 10\n"),
        format!("{drums}drums = 4\n[elastic_joints]\nstone_modulus_gpa = 20.0\nmortar_modulus_gpa = 2.0\nmortar_thickness_m = 0.01\n"),
        format!("[arch]\n{measured}[[tie]]\nheight_m = 2\narea_mm2 = 500.0\nmodulus_gpa = 200.0\nyield_stress_mpa = 235.0\n[free_hinges]\n"),
        "[column]\nheight_m = 4\nwidth_m = 1\n[initial]\nsway = 'left'\nimpulse_n_s = 100\nheight_m = 2\n".to_owned(),
    ]
    .into_iter()
    .map(|text| match text.contains("[initial]") {
        true => text,
        false => format!("{text}{ground}"),
    })
    .collect()
}

/// Adds the keys of all numbers in a table.
fn numbers(key: &str, value: &Value, all: &mut Vec<(String, Value)>) {
    match value {
        Value::Object(table) => {
            for (name, value) in table {
                numbers(&format!("{key}.{name}"), value, all);
            }
        }
        Value::Array(entries) => {
            for (number, value) in (1..).zip(entries) {
                numbers(&format!("{key}.{number}"), value, all);
            }
        }
        Value::Number(_) => all.push((key.to_owned(), value.clone())),
        _ => {}
    }
}

/// Keys of other numbers that set the same quantities, with a value for any scenario. Most are refused by most scenarios.
const ALTERNATIVES: [(&str, f64); 21] = [
    ("arch.thickness_ratio", 0.2),
    ("arch.thickness_m", 0.7),
    ("arch.mean_radius_m", 4.5),
    ("arch.span_m", 6.2),
    ("arch.rise_m", 1.9),
    ("arch.embrace_deg", 150.5),
    ("arch.voussoirs", 13.0),
    ("column.drums", 5.0),
    ("column.height_m", 4.1),
    ("piers.height_m", 1.25),
    ("piers.left.height_m", 1.25),
    ("piers.blocks", 2.0),
    ("fill.height_m", 3.5),
    ("elastic_joints.damping_time_s", 1e-4),
    ("elastic_joints.damping_ratio", 0.04),
    ("elastic_joints.normal_stiffness_gpa_m", 12.0),
    ("elastic_joints.contact_points", 4.0),
    ("tie.1.stiffness_n_m", 1e7),
    ("ground.record.scale", 0.9),
    ("ground.record.peak_g", 0.2),
    ("initial.rate_rad_s", 0.1),
];

/// A scenario as text, with the name that gives its folder.
struct Text {
    text: String,
    name: String,
}

impl Text {
    fn read(&self, set: &[String]) -> Result<Scenario, String> {
        let set: Vec<Assignment> = set.iter().map(|one| one.parse().unwrap()).collect();
        let options = ReadOptions {
            set: &set,
            statics: is_for_statics(Path::new(&self.name)),
            ..ReadOptions::default()
        };
        let read = Scenario::of(&Source::of_text(&self.text, &self.name), &options);
        read.map_err(|errors| errors.to_string())
    }
}

/// Returns a scenario without studies.
fn bare(scenario: &Scenario) -> Scenario {
    scenario.with_values(&[]).unwrap()
}

/// Returns errors without the names and positions before them, which begin with the name of a file and end at the first blank.
fn without_places(errors: &str) -> Vec<&str> {
    let lines = errors.lines();
    let message = |line: &'_ str| match line.starts_with("--set") {
        true => 0,
        false => line
            .find(".toml:")
            .or(line.find("other "))
            .map_or(0, |_| line.find(": ").map_or(0, |place| place + 2)),
    };
    lines.map(|line| &line[message(line)..]).collect()
}

/// Checks that all ways to set a key make one scenario, or are refused with one message. Returns true if they make one.
fn check(text: &Text, written: &Text, scenario: &Scenario, (key, own): (&str, &Value)) -> bool {
    let value = own.as_f64().unwrap();
    let mut values = match own.is_f64() {
        true => [value, if value == 0.0 { 1e-3 } else { 0.99 * value }],
        false => [value + 1.0; 2],
    };
    values.sort_by(f64::total_cmp);
    let at = format!("{}: {key} = {value}", text.name);
    // A sample of a range gives the value for all ways.
    let sampled = own.is_f64().then(|| {
        let [from, to] = values;
        let uncertain = format!("uncertain={{samples=1, \"{key}\"={{from={from:?}, to={to:?}}}}}");
        let scenario = text.read(&[uncertain]);
        scenario.map(|scenario| {
            let uncertain = scenario.uncertain.clone().unwrap();
            let values = uncertain.values(0);
            (values[0], uncertain.scenario(&scenario, &values))
        })
    });
    let value = match &sampled {
        Some(Ok((value, _))) => *value,
        _ => values[0],
    };
    let set = format!("{key}={value:?}");
    let set = match own.is_f64() {
        true => set,
        false => set.replace(".0", ""),
    };
    let by_set = text.read(slice::from_ref(&set));
    let on_written = written.read(slice::from_ref(&set));
    let by_axis = scenario.with_values(&[(key, value)]);
    match by_set {
        Ok(by_set) => {
            let by_set = bare(&by_set);
            let json = by_set.to_resolved_json();
            let by_axis = by_axis.unwrap_or_else(|error| panic!("{at}: {error}"));
            let on_written = on_written.unwrap_or_else(|error| panic!("{at}: {error}"));
            let mut others = vec![by_axis, bare(&on_written)];
            if let Some(Ok((_, sample))) = sampled {
                others.push(sample.unwrap_or_else(|error| panic!("{at}: {error}")));
            }
            for (way, other) in ["axis", "set on check", "sample"].iter().zip(&others) {
                assert_eq!(other, &by_set, "{at}: {way}");
                assert_eq!(other.to_resolved_json(), json, "{at}: {way}");
            }
            true
        }
        Err(errors) => {
            let error = by_axis.expect_err(&at);
            // Errors have another line in the written text. An axis reports the first of them, without an assignment.
            assert!(errors.contains(&error), "{at}: {errors} for {error}");
            assert_eq!(
                without_places(&on_written.expect_err(&at)),
                without_places(&errors),
                "{at}"
            );
            false
        }
    }
}

/// `--set`, axes, samples and `--set` on the text that `check` prints make equal scenarios for every number of every scenario, or all refuse with
/// one message.
#[test]
fn all_ways_to_change_a_number_agree() {
    let texts = scenario_files().into_iter().map(|path| Text {
        text: fs::read_to_string(&path).unwrap(),
        name: path.display().to_string(),
    });
    let others = (1..).zip(other_texts()).map(|(number, text)| Text {
        text,
        name: format!("other {number}"),
    });
    let texts: Vec<Text> = texts.chain(others).collect();
    let next = std::sync::atomic::AtomicUsize::new(0);
    let counts = std::sync::Mutex::new([0, 0]);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    let Some(text) = texts.get(index) else {
                        break;
                    };
                    let done = check_text(text);
                    let mut counts = counts.lock().unwrap();
                    counts[0] += done[0];
                    counts[1] += done[1];
                }
            });
        }
    });
    let [agree, refused] = counts.into_inner().unwrap();
    assert!(agree > 250 && refused > 30, "{agree} {refused}");
}

/// Returns the text that `check` prints for a text, and the scenario of both.
fn written(text: &Text) -> (Text, Scenario) {
    let scenario = text.read(&[]).unwrap();
    let written = Text {
        text: scenario.to_toml(),
        name: text.name.clone(),
    };
    let again = written.read(&[]).unwrap();
    assert_eq!(again, scenario, "{}", text.name);
    assert_eq!(again.to_toml(), written.text, "{}", text.name);
    (written, scenario)
}

/// Returns a text without the studies that read records: changed scenarios are compared without studies, and each of them would read all records.
fn without_records(text: &Text) -> Text {
    let mut is_kept = true;
    let lines = text.text.lines().filter(|line| {
        if let Some(header) = line.trim_start().strip_prefix('[') {
            let table = header.trim_start_matches('[').split(['.', ']']).next();
            is_kept = !["suite", "verify"].contains(&table.unwrap());
        }
        is_kept
    });
    Text {
        text: lines.map(|line| format!("{line}\n")).collect(),
        name: text.name.clone(),
    }
}

/// Checks all keys of a text. Returns the number of changes that are allowed and refused.
fn check_text(text: &Text) -> [usize; 2] {
    let _ = written(text);
    let text = &without_records(text);
    let (written, scenario) = written(text);
    let mut keys = Vec::new();
    for (name, table) in scenario.to_json().as_object().unwrap() {
        if !STUDIES.contains(&name.as_str()) {
            numbers(name, table, &mut keys);
        }
    }
    let has_table = |key: &str| {
        let name = key.split('.').next().unwrap();
        scenario.to_json().get(name).is_some()
    };
    for (key, value) in ALTERNATIVES.into_iter().filter(|(key, _)| has_table(key)) {
        let is_whole = ["voussoirs", "drums", "blocks", "contact_points"];
        let value = match is_whole.iter().any(|end| key.ends_with(end)) {
            true => Value::from(value as i64),
            false => Value::from(value),
        };
        keys.push((key.to_owned(), value));
    }
    let mut counts = [0, 0];
    for (key, value) in &keys {
        let agree = check(text, &written, &scenario, (key, value));
        counts[usize::from(!agree)] += 1;
    }
    counts
}

/// A kind of model states what its models have, without making one.
#[test]
fn a_kind_of_model_agrees_with_its_models() {
    let text = "[arch]\nspan_m = 6.0\nrise_m = 2.0\nthickness_m = 0.6\nmeasured_at = \"mean\"\nvoussoirs = 7\n[ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.2\n\
                [elastic_joints]\nnormal_stiffness_gpa_m = 10\n";
    for kind in MODELS {
        let options = ReadOptions {
            model: Some(kind),
            ..ReadOptions::default()
        };
        let scenario = Scenario::of(&Source::of_text(text, "s.toml"), &options).unwrap();
        let model = scenario.model().unwrap();
        assert_eq!(kind.has_joints, model.row().is_some(), "{}", kind.name);
        assert_eq!(
            kind.has_mechanism,
            model.as_mechanisms().is_some(),
            "{}",
            kind.name
        );
        assert_eq!(
            kind.is_repeated,
            !model.repetitions().is_empty(),
            "{}",
            kind.name
        );
        assert_eq!(kind.has_lanes, model.lanes() > 1, "{}", kind.name);
        assert_eq!(
            kind.has_stiffness,
            !scenario.variations().unwrap().is_empty(),
            "{}",
            kind.name
        );
        assert_eq!(kind.has_stiffness, model.has_pressures(), "{}", kind.name);
    }
}
