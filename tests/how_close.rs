//! How close it was: per record in a line, and in the picture of incremental dynamic analysis.

#![allow(clippy::unwrap_used)]

mod program;

use std::fs;
use std::path::Path;
use std::process::Output;

use program::{archrock, scenarios, stderr};
use serde_json::Value;

const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[simulation]\nduration_s = 30\n";

fn stdout(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// A folder with two records and a scenario of them.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for record in ["wave-1.at2", "wave-2.at2"] {
        fs::copy(
            scenarios().join("records").join(record),
            folder.path().join(record),
        )
        .unwrap();
    }
    let text = format!(
        "{COLUMN}[ground.record]\nfile = 'wave-1.at2'\n\
         [suite]\nrecords = 'wave-*.at2'\npeaks_g = {{ from = 0.2, to = 4.0, count = 20, spacing = 'logarithmic' }}\n"
    );
    fs::write(folder.path().join("s.toml"), text).unwrap();
    folder
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// The words as they follow from the bands and gaps of `threshold.json`.
fn words(threshold: &Value) -> String {
    let model = &threshold["models"][0];
    let four = |value: &Value| {
        let value = value.as_f64().unwrap();
        let digits = (3.0 - value.log10().floor()).max(0.0) as usize;
        format!("{value:.digits$}")
    };
    let first = four(&model["lowest_factor"]);
    let mut again: Vec<String> = model["gaps"]
        .as_array()
        .unwrap()
        .iter()
        .map(|gap| format!("{} to {}", four(&gap["from"]), four(&gap["to"])))
        .collect();
    let last = model["bands"].as_array().unwrap().last().unwrap();
    if last["to_end"] == "edge" {
        again.push(format!(
            "{} to {}",
            four(&last["to"]),
            four(&threshold["factors"]["to"])
        ));
    }
    if again.is_empty() {
        format!("first overturns at {first}")
    } else {
        format!(
            "first overturns at {first}; survives again at {}",
            again.join(", ")
        )
    }
}

const OPTIONS: [&str; 6] = ["--from", "0.5", "--to", "12", "--stride", "0.05"];

#[test]
fn a_threshold_of_a_record_is_one_line() {
    let folder = folder();
    let path = folder.path();
    let said = stdout(&archrock(
        path,
        &[&["threshold", "s.toml"], &OPTIONS[..]].concat(),
    ));
    let found = json(&path.join("results/s/threshold.json"));
    let line = format!("  wave-1.at2: {} (1 is 0.3000 g)", words(&found));
    assert_eq!(said.lines().next().unwrap(), line, "{said}");
    assert_eq!(said.matches("overturns").count(), 1, "{said}");
}

#[test]
fn each_record_of_a_suite_can_be_run_and_have_its_threshold() {
    let folder = folder();
    let path = folder.path();
    let all = archrock(
        path,
        &[&["threshold", "s.toml", "--suite"], &OPTIONS[..]].concat(),
    );
    let said = stdout(&all);
    for (line, record) in said.lines().zip(["wave-1.at2", "wave-2.at2"]) {
        let found = json(&path.join("results/s").join(record).join("threshold.json"));
        assert_eq!(
            line,
            format!("  {record}: {} (1 is 0.3000 g)", words(&found))
        );
        let scenario = &found["models"][0]["scenario"];
        assert_eq!(scenario["ground"]["record"]["file"], record);
        assert_eq!(scenario.get("suite"), None);
    }
    // The first is what [ground] asks for too.
    let single = archrock(
        path,
        &[&["threshold", "s.toml", "--out", "o"], &OPTIONS[..]].concat(),
    );
    assert_eq!(stdout(&single).lines().next(), said.lines().next());
    let both = [
        &["threshold", "s.toml", "--suite", "--format", "json"],
        &OPTIONS[..],
    ]
    .concat();
    let both: Value = serde_json::from_str(&stdout(&archrock(path, &both))).unwrap();
    assert_eq!(
        both[1],
        json(&path.join("results/s/wave-2.at2/threshold.json"))
    );

    let said = stdout(&archrock(path, &["run", "s.toml", "--suite"]));
    for record in ["wave-1.at2", "wave-2.at2"] {
        assert!(said.contains(&format!("  {record}: ")), "{said}");
        let summary = json(&path.join("results/s").join(record).join("summary.json"));
        assert_eq!(summary["scenario"]["ground"]["record"]["file"], record);
    }
    // As if it were the ground of the scenario.
    stdout(&archrock(path, &["run", "s.toml", "--out", "o"]));
    assert_eq!(
        fs::read(path.join("o/rotations.csv")).unwrap(),
        fs::read(path.join("results/s/wave-1.at2/rotations.csv")).unwrap()
    );
    fs::write(path.join("t.toml"), COLUMN).unwrap();
    for command in ["run", "threshold"] {
        let refused = archrock(path, &[command, "t.toml", "--suite"]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(
            stderr(&refused).contains("t.toml: --suite is for a scenario with a table [suite]")
        );
    }
}

#[test]
fn a_suite_says_a_line_per_record_and_draws_how_far_each_goes() {
    let folder = folder();
    let path = folder.path();
    let output = archrock(path, &["suite", "s.toml"]);
    stdout(&output);
    let said = stderr(&output);
    let mut table = csv::Reader::from_path(path.join("results/s/suite.csv")).unwrap();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    let picture = fs::read_to_string(path.join("results/s/ida.svg")).unwrap();
    let picture = roxmltree::Document::parse(&picture).unwrap();
    let marks = |name: &str| {
        let nodes = picture.descendants();
        nodes
            .filter(|node| node.attribute("data-name") == Some(name))
            .count()
    };
    let mut overturned = 0;
    for record in ["wave-1.at2", "wave-2.at2"] {
        let own: Vec<_> = rows
            .iter()
            .filter(|row| &row[0] == record && &row[1] == "1")
            .collect();
        assert_eq!(own.len(), 20);
        overturned += own.iter().filter(|row| &row[4] == "overturned").count();
        // The least level that overturns, and from there on the others, each run of survivors by its ends.
        let first = own.iter().position(|row| &row[4] == "overturned").unwrap();
        let four = |row: &csv::StringRecord| {
            let value: f64 = row[3].parse().unwrap();
            let digits = (3.0 - value.log10().floor()).max(0.0) as usize;
            format!("{value:.digits$}")
        };
        let mut expected = format!("  {record}: first overturns at {} g", four(own[first]));
        let again: Vec<String> = own[first..]
            .chunk_by(|a, b| (&a[4] == "overturned") == (&b[4] == "overturned"))
            .filter(|run| &run[0][4] != "overturned")
            .map(|run| match run {
                [only] => format!("{} g", four(only)),
                [from, .., to] => format!("{} to {} g", four(from), four(to)),
                [] => unreachable!(),
            })
            .collect();
        if !again.is_empty() {
            expected += &format!("; survives again at {}", again.join(", "));
        }
        assert!(
            said.lines().any(|line| line == expected),
            "{expected}\n{said}"
        );
        assert_eq!(marks(record), 1, "a curve");
    }
    assert_eq!(marks("overturned"), overturned);
    assert_eq!(marks("survived"), 40 - overturned);
    // Mirrored records do the same to the other side, and need no line of their own.
    assert!(!said.contains("mirrored"), "{said}");
}
