//! The output of `run` that can be drawn: poses, snapshots, hinges in the tables; and `limit` as JSON and as text.

use std::fs;
use std::path::Path;

use crate::common::program::{archrock, scenarios, stderr};
use crate::common::results::{Row, Table, named, points};
use nalgebra::{Rotation2, Vector2};
use roxmltree::Document;
use serde_json::Value;

fn run(folder: &Path, scenario: &str, more: &[&str]) -> String {
    let path = scenarios().join(scenario);
    let arguments = [&["run", path.to_str().unwrap(), "--out", "."], more].concat();
    let output = archrock(folder, &arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// A point of a body in a row of `poses.csv`, moved as its documentation says.
fn moved(row: &Row, body: &str, point: Vector2<f64>) -> Vector2<f64> {
    let [x, y, rotation] = [("x", "m"), ("y", "m"), ("rotation", "rad")]
        .map(|(quantity, unit)| row.number(&format!("{quantity}_{body}_{unit}")));
    Vector2::new(x, y) + Rotation2::new(rotation) * point
}

/// The arch of most scenarios: 5 m, t/R = 0.15, a semicircle.
fn point(angle_deg: f64, edge: &str) -> Vector2<f64> {
    let radius = match edge {
        "intrados" => 5.0 * 0.925,
        "extrados" => 5.0 * 1.075,
        other => panic!("{other}"),
    };
    let (sin, cos) = (angle_deg - 90.0).to_radians().sin_cos();
    Vector2::new(sin, cos) * radius
}

/// With the hinges of `events.csv`, the poses keep the bodies together at each hinge, and the outer bodies on the ground.
/// Places of hinges, edges of hinges and poses come from three independent tables.
#[test]
fn bodies_meet_at_the_hinges_of_the_tables() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "semicircle-pulse.toml", &["--poses"]);
    let (poses, rotations, events) = (
        Table::read(folder.path().join("poses.csv")).rows,
        Table::read(folder.path().join("rotations.csv")).rows,
        Table::read(folder.path().join("events.csv")).rows,
    );
    assert_eq!(poses.len(), rotations.len());
    let mut checked = 0;
    for (pose, rotation) in poses.iter().zip(&rotations) {
        assert_eq!(pose["time_s"], rotation["time_s"]);
        assert_eq!(pose["rotation_left_rad"], rotation["rotation_left_rad"]);
        let phase: usize = rotation["phase"].parse().unwrap();
        if phase == 0 || rotation["state"] == "rest" {
            continue;
        }
        let event = &events[phase - 1];
        assert_eq!(event["phase"], rotation["phase"]);
        let [a, b, c, d] = ["a", "b", "c", "d"].map(|hinge| {
            let angle_deg = event.number(&format!("hinge_{hinge}_deg"));
            point(angle_deg, &event[&format!("hinge_{hinge}_edge")])
        });
        let on = |body: &str, at| moved(pose, body, at);
        for (one, other) in [
            (on("left", a), a),
            (on("left", b), on("middle", b)),
            (on("middle", c), on("right", c)),
            (on("right", d), d),
        ] {
            assert!(
                (one - other).norm() < 1e-11,
                "{one} {other} at {}",
                pose["time_s"]
            );
        }
        checked += 1;
    }
    assert!(checked > 500);
}

#[test]
fn an_impact_closes_the_hinges_that_opened_before() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "semicircle-pulse.toml", &[]);
    let impacts = Table::read(folder.path().join("impacts.csv")).rows;
    let cells = |row: &Row, what: &str| {
        ["a", "b", "c", "d"].map(|hinge| {
            let place = row.number(&format!("{what}_{hinge}_deg"));
            (place, row[&format!("{what}_{hinge}_edge")].to_owned())
        })
    };
    // The hinges of `archrock limit`, from the README.
    let first = [24.01353, 81.78741, 139.56130, 180.0];
    for ((place, edge), due) in cells(&impacts[0], "closed").into_iter().zip(first) {
        assert!((place - due).abs() < 1e-5);
        assert!(
            edge == if due == first[0] || due == first[2] {
                "intrados"
            } else {
                "extrados"
            }
        );
    }
    for pair in impacts.windows(2) {
        assert_eq!(cells(&pair[0], "hinge"), cells(&pair[1], "closed"));
    }
    // Columns have toes, and no cells for edges.
    run(folder.path(), "column-pulse.toml", &[]);
    for name in ["impacts.csv", "events.csv"] {
        let header = fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(!header.lines().next().unwrap().contains("edge"), "{name}");
    }
}

/// Corners of the bodies of that name, panel by panel.
fn bodies(document: &Document<'_>, name: &str) -> Vec<Vec<Vector2<f64>>> {
    named(document, name).iter().map(points).collect()
}

fn snapshots(folder: &Path) -> String {
    fs::read_to_string(folder.join("snapshots.svg")).unwrap()
}

/// The column is drawn as a rectangle of its own proportions, turned by the rotation of the table.
#[test]
fn snapshots_are_to_scale() {
    let folder = tempfile::tempdir().unwrap();
    let times = ["--snapshots", "0.5,1.0,2.345", "--poses"];
    run(folder.path(), "column-pulse.toml", &times);
    let picture = snapshots(folder.path());
    let document = Document::parse(&picture).unwrap();
    let rotations = Table::read(folder.path().join("rotations.csv")).rows;
    let drawn = bodies(&document, "body 0");
    assert_eq!(drawn.len(), 3);
    for (corners, time_s) in drawn.iter().zip([0.5, 1.0, 2.345]) {
        let row = rotations
            .iter()
            .find(|row| (row.number("time_s") - time_s).abs() < 1e-9)
            .unwrap();
        let (side, top) = (corners[1] - corners[0], corners[2] - corners[1]);
        assert!((side.norm() / top.norm() - 4.0 / 0.8).abs() < 2e-3);
        // On the sheet y points down.
        let turned_rad = (-side.x).atan2(-side.y);
        assert!(
            (turned_rad - row.number("rotation_rad")).abs() < 2e-4,
            "{time_s} {turned_rad}"
        );
        assert!(picture.contains(&format!("{time_s:.3} s, sways")));
    }
    assert!(picture.contains("to scale"));
}

#[test]
fn exaggerated_snapshots_scale_displacements() {
    let folder = tempfile::tempdir().unwrap();
    let corners = |more: &[&str]| {
        run(
            folder.path(),
            "free-hinges.toml",
            &[
                &["--no-repeat", "--snapshots", "0.6"][..],
                &["--set", "simulation.duration_s=0.7"],
                more,
            ]
            .concat(),
        );
        let picture = snapshots(folder.path());
        let document = Document::parse(&picture).unwrap();
        assert!(!named(&document, "thrust line").is_empty());
        bodies(&document, "body 25").remove(0)
    };
    let tenfold = corners(&["--exaggerate", "10"]);
    let (once, twice) = (corners(&[]), corners(&["--exaggerate", "2"]));
    for ((once, twice), tenfold) in once.iter().zip(twice).zip(tenfold) {
        let shift = twice - once;
        assert!(shift.norm() > 1.0, "it moves");
        assert!(
            (tenfold - once - shift * 9.0).norm() < 0.2,
            "{shift} {tenfold}"
        );
    }
}

#[test]
fn snapshots_that_cannot_be_written_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let said = run(
        folder.path(),
        "semicircle-pulse.toml",
        &["--snapshots", "0.5,99"],
    );
    assert!(
        said.contains("snapshots at 99 s are after the end"),
        "{said}"
    );
    run(folder.path(), "semicircle-pulse.toml", &[]);
    assert!(
        !folder.path().join("snapshots.svg").exists(),
        "snapshots of an earlier run are removed"
    );
    let path = scenarios().join("semicircle-pulse.toml");
    let path = path.to_str().unwrap();
    for (arguments, said) in [
        (
            &["--rotations", "-", "--snapshots", "1"][..],
            "--snapshots writes a file",
        ),
        (&["--rotations", "-", "--poses"], "--poses writes a file"),
        (&["--snapshots", "1e10"], "0.2,0.5,1.0"),
        (&["--snapshots", "nan"], "0.2,0.5,1.0"),
        (&["--snapshots", "1", "--exaggerate", "0"], "such as 10"),
        (&["--exaggerate", "3"], "--snapshots"),
    ] {
        let output = archrock(folder.path(), &[&["run", path], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            stderr(&output).contains(said),
            "{arguments:?}: {}",
            stderr(&output)
        );
    }
}

/// The JSON has every number of the text.
#[test]
fn limit_prints_the_same_as_json() {
    for scenario in [
        "semicircle-pulse.toml",
        "column-pulse.toml",
        "voussoirs-step-pair.toml",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = scenarios().join(scenario);
        let limit = |more: &[&str]| {
            let output = archrock(
                folder.path(),
                &[&["limit", path.to_str().unwrap()], more].concat(),
            );
            assert!(output.status.success(), "{}", stderr(&output));
            String::from_utf8(output.stdout).unwrap()
        };
        let text = limit(&[]);
        let json: Value = serde_json::from_str(&limit(&["--format", "json"])).unwrap();
        let mut known = Vec::new();
        collect(&json, &mut known);
        let words = text.split(|c: char| c.is_whitespace() || c == ',' || c == ';');
        let decimals = words.filter(|word| word.contains('.') && word.parse::<f64>().is_ok());
        let mut count = 0;
        for word in decimals {
            let digits = word.split_once('.').unwrap().1.len();
            let shown = |value: &f64| format!("{value:.digits$}") == word.trim_start_matches('+');
            let zero = word.parse::<f64>().unwrap() == 0.0;
            assert!(
                zero || known.iter().any(shown),
                "{word} of {scenario}: {known:?}"
            );
            count += 1;
        }
        assert!(count > 5);
        for said in [
            "unstable_rotations",
            "incipient_acceleration_m_s2",
            "equivalent_block",
        ] {
            assert!(json.get(said).is_some(), "{said}");
        }
    }
}

fn collect(json: &Value, numbers: &mut Vec<f64>) {
    match json {
        Value::Number(number) => numbers.push(number.as_f64().unwrap()),
        Value::Array(values) => values.iter().for_each(|value| collect(value, numbers)),
        Value::Object(values) => values.values().for_each(|value| collect(value, numbers)),
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}
