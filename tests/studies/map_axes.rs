//! Maps as papers draw them: any number of the scenario along an axis, records, colours and dimensionless axes.

use std::fs;
use std::path::Path;

use crate::common::ARCH;
use crate::common::program::{archrock, scenarios};
use crate::common::program::{refusal, stdout};
use crate::common::results::{Row, Table, named, number};
use roxmltree::Document;
use serde_json::Value;

const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[simulation]\nduration_s = 30\n";

fn refused(folder: &Path, text: &str, arguments: &[&str]) -> String {
    fs::write(folder.join("s.toml"), text).unwrap();
    refusal(&archrock(folder, &[&["map", "s.toml"], arguments].concat()))
}

/// The rows of a map, by the names of their columns.
fn rows(folder: &Path, text: &str, arguments: &[&str]) -> Vec<Row> {
    fs::write(folder.join("s.toml"), text).unwrap();
    stdout(&archrock(folder, &[&["map", "s.toml"], arguments].concat()));
    Table::read(folder.join("results/s/map.csv")).rows
}

/// The summary of a run with values replaced.
fn run(folder: &Path, set: &[String]) -> Value {
    let mut arguments = vec!["run", "s.toml", "--format", "json"];
    for one in set {
        arguments.extend(["--set", one]);
    }
    serde_json::from_str(&stdout(&archrock(folder, &arguments))).unwrap()
}

#[test]
fn a_cell_under_a_record_is_the_run_with_its_values() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::copy(scenarios().join("records/wave-1.at2"), path.join("r.at2")).unwrap();
    let text = format!(
        "{COLUMN}[ground.record]\nfile = 'r.at2'\n\
         [map]\n'column.width_m' = [0.6, 0.8]\nscale = [0.5, 1.7, 4]\n"
    );
    let cells = rows(path, &text, &[]);
    assert_eq!(cells.len(), 6);
    // The page gives the command of a cell.
    let page = fs::read_to_string(path.join("results/s/map.html")).unwrap();
    assert!(page.contains(
        "archrock run - --set column.width_m={cell.x} --set ground.record.scale={cell.y} --out cell"
    ));
    let mut outcomes = Vec::new();
    for cell in &cells {
        let set = [
            format!("column.width_m={}", cell["column.width_m"]),
            format!("ground.record.scale={}", cell["scale"]),
        ];
        let summary = run(path, &set);
        assert_eq!(summary["outcome"], cell["outcome"]);
        let time_s = cell.number("outcome_time_s");
        assert_eq!(summary["outcome_time_s"].as_f64().unwrap(), time_s);
        outcomes.push(cell["outcome"].to_owned());
    }
    outcomes.sort();
    outcomes.dedup();
    assert!(outcomes.len() > 1, "{outcomes:?}");

    // Scaled to a peak: the record itself has 0.3 g.
    let text = text.replace("scale = [0.5, 1.7, 4]", "peak_g = [0.15, 0.51, 1.2]");
    for (by_peak, by_scale) in rows(path, &text, &[]).iter().zip(&cells) {
        assert_eq!(by_peak["outcome"], by_scale["outcome"]);
        assert_eq!(by_peak["impacts"], by_scale["impacts"]);
    }
    // Computed in parts as well.
    let whole = fs::read(path.join("results/s/map.csv")).unwrap();
    for part in ["1/2", "2/2"] {
        stdout(&archrock(path, &["map", "s.toml", "--shard", part]));
    }
    let parts = ["results/s/map-1-of-2.part", "results/s/map-2-of-2.part"];
    stdout(&archrock(
        path,
        &[&["merge", "--out", "m"], &parts[..]].concat(),
    ));
    assert_eq!(fs::read(path.join("m/map.csv")).unwrap(), whole);
}

#[test]
fn every_numeric_key_can_be_an_axis() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let text = format!(
        "{ARCH}[ground.half_sine]\namplitude_g = -0.5\nduration_s = 0.4\n\
         [map]\n'arch.voussoirs' = {{ from = 9, to = 15, count = 4 }}\namplitude_g = [-0.75, -0.5]\n"
    );
    for cell in rows(path, &text, &[]) {
        let set = [
            format!(
                "arch.voussoirs={}",
                cell["arch.voussoirs"].trim_end_matches(".0")
            ),
            format!("ground.half_sine.amplitude_g={}", cell["amplitude_g"]),
        ];
        let summary = run(path, &set);
        assert_eq!(summary["outcome"], cell["outcome"]);
        let impacts = summary["impacts"].as_u64().unwrap();
        assert_eq!(impacts.to_string(), cell["impacts"]);
    }
    // A value that is not allowed makes only its own cells fail, with the reason.
    let wrong = text.replace(
        "'arch.voussoirs' = { from = 9, to = 15, count = 4 }",
        "'arch.depth_m' = [-1.0, 1.0]",
    );
    let cells = rows(path, &wrong, &[]);
    assert_eq!(
        [&cells[0]["outcome"], &cells[1]["outcome"]],
        ["failed", "failed"]
    );
    assert_ne!(cells[2]["outcome"], "failed");
    let summary = fs::read_to_string(path.join("results/s/map.json")).unwrap();
    assert!(summary.contains("is out of range; must be a number from"));
    // The resolved scenario reads back the same.
    let resolved = stdout(&archrock(path, &["check", "s.toml"]));
    fs::write(path.join("t.toml"), &resolved).unwrap();
    assert_eq!(stdout(&archrock(path, &["check", "t.toml"])), resolved);
}

/// A scenario may contain a map of pulses and a record for `run`; only `map` refuses the combination.
#[test]
fn a_scenario_may_have_a_map_of_pulses_and_a_record() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::copy(scenarios().join("records/wave-1.at2"), path.join("r.at2")).unwrap();
    let text = format!(
        "{COLUMN}[ground.record]\nfile = 'r.at2'\n[map]\nduration_s = [0.2, 0.4]\namplitude_g = [0.5, 1.0]\n"
    );
    let said = refused(path, &text, &[]);
    assert!(
        said.contains("`duration_s` in [map] goes with a pulse, and [ground] has a record"),
        "{said}"
    );
    assert_eq!(run(path, &[])["outcome"], "rest");
    let checked = stdout(&archrock(path, &["check", "s.toml"]));
    assert!(checked.contains("duration_s = [0.2, 0.4]"), "{checked}");
}

#[test]
fn invalid_axes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::copy(scenarios().join("records/wave-1.at2"), path.join("r.at2")).unwrap();
    let pulse = "[ground.half_sine]\namplitude_g = -0.5\nduration_s = 0.4\n";
    let record = "[ground.record]\nfile = 'r.at2'\n";
    let refused = |ground: &str, axes: &str| {
        let text = format!("{ARCH}{ground}[map]\n{axes}\n");
        refused(path, &text, &[])
    };
    let said = refused(pulse, "amplitude_g = [1, 2]\n'arch.depht_m' = [1, 2]");
    assert!(
        said.contains("no cell of [map] makes a valid scenario: unknown key `depht_m`"),
        "{said}"
    );
    let said = refused(pulse, "amplitude_g = [1, 2]\n'map.repeat' = [1, 2]");
    assert!(said.contains("names no number of the structure"), "{said}");
    let said = refused(pulse, "amplitude_g = [1, 2]");
    assert!(
        said.contains("needs exactly two of the keys duration_s"),
        "{said}"
    );
    let said = refused(pulse, "scale = [1, 2]\nduration_s = [1, 2]");
    assert!(
        said.contains("`scale` in [map] goes with a record"),
        "{said}"
    );
    let said = refused(
        record,
        "thickness_ratio = [0.15, 0.2]\namplitude_g = [1, 2]",
    );
    assert!(
        said.contains("`amplitude_g` in [map] goes with a pulse"),
        "{said}"
    );
    let said = refused("", "thickness_ratio = [0.15, 0.2]\nscale = [1, 2]");
    assert!(said.contains("[map] needs a ground motion"), "{said}");
    let short = format!("{record}[simulation]\nduration_s = 1\n");
    let said = refused(&short, "thickness_ratio = [0.15, 0.2]\nscale = [1, 2]");
    assert!(
        said.contains("has a record that lasts until 5.98 s and would be cut off at 1 s"),
        "{said}"
    );
}

/// The values of `d` of the marks of that name.
fn paths<'a>(document: &'a Document<'a>, name: &str) -> Vec<&'a str> {
    let marks = named(document, name);
    marks
        .iter()
        .filter_map(|mark| mark.attribute("d"))
        .collect()
}

fn text_place(document: &Document<'_>, text: &str) -> (f64, f64) {
    let mut nodes = document.descendants();
    let node = nodes
        .find(|node| node.has_tag_name("text") && node.text() == Some(text))
        .unwrap();
    (number(&node, "x"), number(&node, "y"))
}

const MAP: &str = "[ground.one_cosine]\namplitude_g = 0.5\nduration_s = 0.8\n[simulation]\nduration_s = 30\n\
                   [map]\nduration_s = [0.2, 0.4, 0.6, 0.8]\namplitude_g = { from = 0.1, to = 1.0, count = 10 }\n";

#[test]
fn dimensionless_axes_are_in_units_of_p_and_of_the_onset() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("s.toml"), format!("{ARCH}{MAP}")).unwrap();
    stdout(&archrock(path, &["map", "s.toml", "--dimensionless"]));
    let picture = fs::read_to_string(path.join("results/s/map.svg")).unwrap();
    let picture = Document::parse(&picture).unwrap();
    text_place(&picture, "p t_p");
    text_place(&picture, "a / A_L");
    let caption = "arch: R 5 m, t/R 0.15, 180 degrees, no joints given; one cosine pulse; four links, largest restitution";
    text_place(&picture, caption);

    let other = format!(
        "{ARCH}{}",
        MAP.replace(
            "duration_s = [0.2, 0.4, 0.6, 0.8]",
            "thickness_ratio = [0.15, 0.2]"
        )
    );
    let said = refused(path, &other, &["--dimensionless"]);
    assert!(
        said.contains("--dimensionless needs the axes `duration_s` and `amplitude_g`"),
        "{said}"
    );
}

#[test]
fn survivors_can_be_coloured_by_their_distance_from_overturning() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let cells = rows(path, &format!("{ARCH}{MAP}"), &["--color", "peak"]);
    let picture = fs::read_to_string(path.join("results/s/map.svg")).unwrap();
    let picture = Document::parse(&picture).unwrap();
    assert!(paths(&picture, "rest").is_empty());
    let mut bins = 0;
    for (name, low, high) in [
        ("survived-0", 0.0, 0.2),
        ("survived-20", 0.2, 0.4),
        ("survived-40", 0.4, 0.6),
        ("survived-60", 0.6, 0.8),
        ("survived-80", 0.8, 1.0),
        ("survived-100", 1.0, f64::INFINITY),
    ] {
        let within = cells.iter().filter(|cell| {
            cell["outcome"] == "rest" && {
                let peak: f64 = cell["peak_rotation_over_critical"].parse().unwrap();
                (low..high).contains(&peak)
            }
        });
        let count = within.count();
        bins += usize::from(count > 0);
        assert_eq!(!paths(&picture, name).is_empty(), count > 0, "{name}");
    }
    assert!(bins >= 3, "{bins}");
    let free = format!("{ARCH}voussoirs = 9\n[free_hinges]\n{MAP}");
    let said = refused(path, &free, &["--color", "peak"]);
    assert!(
        said.contains("free hinges have no critical rotation"),
        "{said}"
    );
}

#[test]
fn an_axis_that_is_no_key_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for axis in [
        "column.height m",
        "column..height_m",
        "column.",
        ".height_m",
        "column.[x]",
    ] {
        let text = format!(
            "{COLUMN}[ground.one_sine]\namplitude_g = 0.1\nduration_s = 0.5\n[map]\n'{axis}' = [1, 2]\namplitude_g = [0.1, 0.2]\n"
        );
        let said = refused(folder.path(), &text, &[]);
        let words = format!("`{axis}` names no number of another table, as \"arch.depth_m\" does");
        assert!(said.contains(&words), "{said}");
    }
}

#[test]
fn without_a_title_a_map_has_no_subtitle() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "title = 'Mine'\n{COLUMN}[ground.one_sine]\namplitude_g = 0.1\nduration_s = 0.5\n[map]\nduration_s = [0.1, 0.2]\namplitude_g = [0.1, 0.2]\n"
    );
    let texts = |arguments: &[&str]| -> Vec<String> {
        rows(folder.path(), &text, arguments);
        let picture = fs::read_to_string(folder.path().join("results/s/map.svg")).unwrap();
        let picture = Document::parse(&picture).unwrap();
        let texts = picture
            .descendants()
            .filter(|node| node.has_tag_name("text"));
        texts
            .filter_map(|text| text.text().map(str::to_owned))
            .collect()
    };
    let (with, without) = (texts(&[]), texts(&["--no-title"]));
    let below_the_title = &with[1];
    assert_eq!(with[0], "Mine");
    assert!(
        !without.contains(&with[0]) && !without.contains(below_the_title),
        "{without:?}"
    );
}
