//! Result files and printed results of a column, and the events of any run.

use std::fs;
use std::path::Path;

use crate::common::COLUMN;
use crate::common::program::{printed, refused};
use crate::common::results::{Row, Table, summary};
use serde_json::{Value, json};

fn archrock(arguments: &[&str], scenario: &Path) -> String {
    let arguments = [arguments, &[scenario.to_str().unwrap()]].concat();
    printed(Path::new("."), &arguments)
}

/// A folder with the results of a run of this scenario.
fn results(scenario: &str, arguments: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    fs::write(&path, scenario).unwrap();
    let out = folder.path().to_str().unwrap();
    archrock(&[&["run", "--out", out], arguments].concat(), &path);
    folder
}

/// The tangent of the slenderness, 0.8 m over 4 m, except for the last digit.
fn assert_incipient(both: &Value) {
    for side in ["right", "left"] {
        assert!((both[side].as_f64().unwrap() - 0.2).abs() < 1e-16);
    }
}

#[test]
fn files_have_one_body_and_no_hinges() {
    let scenario = format!("{COLUMN}[ground.half_sine]\namplitude_g = -0.5\nduration_s = 0.4\n");
    let folder = results(&scenario, &[]);
    let table = Table::read(folder.path().join("rotations.csv"));
    let (header, rows) = (table.header.join(","), table.rows);
    let expected = "time_s,ground_acceleration_m_s2,phase,state,rotation_rad,rate_rad_s,\
                    thrust_excess_ratio,friction_demand";
    assert_eq!(header, expected);
    let table = Table::read(folder.path().join("impacts.csv"));
    let (header, impacts) = (table.header.join(","), table.rows);
    let expected = "impact,time_s,sway_before,sway_after,restitution,energy_before_j,energy_after_j,\
                    rate_before_rad_s,rate_after_rad_s";
    assert_eq!(header, expected);
    // The first impact goes from the right toe to the left one, at Housner's rates.
    let first = &impacts[0];
    let rate_ratio = 1.0 - 1.5 * (0.04 / 1.04);
    assert_eq!(
        (&*first["sway_before"], &*first["sway_after"]),
        ("right", "left")
    );
    assert!((first.number("restitution") - rate_ratio * rate_ratio).abs() < 1e-15);
    let (before, after) = (
        first.number("rate_before_rad_s"),
        first.number("rate_after_rad_s"),
    );
    assert!(before > 0.0 && (after / before - rate_ratio).abs() < 1e-15);
    // Half of m (H^2 + W^2) / 3 times the square of the rate.
    let inertia = 4.0 * 0.8 * 2000.0 * (16.0 + 0.64) / 3.0;
    let energy_j = 0.5 * inertia * before * before;
    assert!((first.number("energy_before_j") / energy_j - 1.0).abs() < 1e-13);

    let summary = summary(folder.path());
    let peak = summary["peak_rotation_rad"].as_f64().unwrap();
    let sampled = rows.iter().map(|row| row.number("rotation_rad").abs());
    let sampled = sampled.fold(0.0, f64::max);
    // The difference is at most p^2 alpha dt^2 / 8.
    assert!(peak >= sampled && peak - sampled < 3e-6);
    assert_incipient(&summary["incipient_acceleration_g"]);
    assert_eq!(summary["impacts"], impacts.len());
}

#[test]
fn dimensionless_columns_come_last() {
    let scenario = format!(
        "{COLUMN}[ground.half_sine]\namplitude_g = -0.5\nduration_s = 0.4\n[simulation]\nduration_s = 1\n"
    );
    let (plain, with) = (
        results(&scenario, &[]),
        results(&scenario, &["--dimensionless"]),
    );
    let plain_rows = Table::read(plain.path().join("rotations.csv")).rows;
    let table = Table::read(with.path().join("rotations.csv"));
    let (header, rows) = (table.header.join(","), table.rows);
    assert!(
        header.ends_with("friction_demand,p_t,acceleration_over_incipient,rotation_over_critical")
    );
    let p = (0.75 * 9.81 / 1.04_f64.sqrt() / 2.0).sqrt();
    assert_eq!(rows.len(), plain_rows.len());
    for (row, plain) in rows.iter().zip(&plain_rows) {
        assert!(plain.cells().all(|(column, value)| row[column] == value));
        let close = |column, expected: f64| (row.number(column) - expected).abs() < 1e-11;
        assert!(close("p_t", p * row.number("time_s")));
        let push = row.number("ground_acceleration_m_s2") / (0.2 * 9.81);
        assert!(close("acceleration_over_incipient", push));
        let rotation = row.number("rotation_rad") / 0.2_f64.atan();
        assert!(close("rotation_over_critical", rotation));
    }
    let scales = &summary(plain.path())["dimensionless"];
    for (key, expected) in [
        ("p_rad_s", p),
        ("p_t_p", 0.4 * p),
        ("peak_acceleration_over_incipient", 2.5),
    ] {
        assert!(
            (scales[key].as_f64().unwrap() - expected).abs() < 1e-11,
            "{key}"
        );
    }
}

/// Events match the phases of the rotations, and include the impacts: for a column that rocks until rest, one that
/// overturns after an impact, and an arch.
#[test]
fn events_are_the_phases_of_the_rotations() {
    let arch = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\n";
    let rectangle = |push, duration| {
        format!("[ground.rectangular]\namplitude_g = {push}\nduration_s = {duration}\n")
    };
    let column = |push, duration| format!("{COLUMN}{}", rectangle(push, duration));
    for (scenario, end) in [
        (
            format!("{}[simulation]\nduration_s = 40\n", column(0.4, 0.25)),
            "rest",
        ),
        (
            format!(
                "{}[initial]\nsway = 'left'\nrotation_rad = 0.1\n",
                column(-0.3, 9.0)
            ),
            "overturned",
        ),
        (format!("{arch}{}", rectangle(-0.3, 0.2)), "rest"),
    ] {
        let folder = results(&scenario, &[]);
        let table = Table::read(folder.path().join("events.csv"));
        let (header, events) = (table.header.join(","), table.rows);
        assert!(header.starts_with("time_s,phase,kind,sway,mechanism,rotation_"));
        let hinged = "energy_j,hinge_a_deg,hinge_a_edge,hinge_b_deg,hinge_b_edge,hinge_c_deg,hinge_c_edge,\
                      hinge_d_deg,hinge_d_edge";
        assert!(header.ends_with("energy_j") || header.ends_with(hinged));
        let impacts = Table::read(folder.path().join("impacts.csv")).rows;
        let rows = Table::read(folder.path().join("rotations.csv")).rows;
        let closing = |event: &&Row| ["impact", "rest"].contains(&event["kind"].as_str());
        let closings: Vec<_> = events.iter().filter(closing).collect();
        assert_eq!(closings.len(), impacts.len());
        for (event, impact) in closings.iter().zip(&impacts) {
            assert_eq!(event["time_s"], impact["time_s"]);
            if event["kind"] == "impact" {
                assert_eq!(event["sway"], impact["sway_after"]);
                let (energy, after) = (event.number("energy_j"), impact.number("energy_after_j"));
                // Positions of the linkage at `q = 0` are rounded: 1e-16 of its weight times its size.
                assert!((energy - after).abs() < 1e-9);
                for (column, value) in impact.cells() {
                    if column.contains("_after_rad") {
                        assert_eq!(&event[&*column.replace("_after", "")], value, "{column}");
                    }
                }
            } else {
                assert!(event["sway"].is_empty() && event["mechanism"].is_empty());
                assert!(event.number("energy_j") == 0.0);
            }
        }
        for (index, event) in events.iter().enumerate() {
            assert_eq!(event["phase"], (index + 1).to_string());
            let begun = event.number("time_s");
            let phase = |row: &&Row| row.number("phase") > index as f64;
            assert!(
                rows.iter()
                    .filter(phase)
                    .all(|row| row.number("time_s") >= begun)
            );
            if let Some(row) = rows.iter().find(|row| row["phase"] == event["phase"]) {
                let state = match event["kind"].as_str() {
                    kind @ ("rest" | "overturned") => kind,
                    _ => &event["sway"],
                };
                assert_eq!(&row["state"], state);
            }
        }
        assert_eq!(events.last().unwrap()["kind"], end);
        assert_eq!(rows.last().unwrap()["phase"], events.len().to_string());
    }
}

#[test]
fn limit_and_impact_name_the_toes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    fs::write(&path, COLUMN).unwrap();
    let limit: Value =
        serde_json::from_str(&archrock(&["limit", "--format", "json"], &path)).unwrap();
    assert_incipient(&limit["incipient_acceleration_g"]);
    let toes = json!({ "right": [{ "toe": "right" }], "left": [{ "toe": "left" }] });
    assert_eq!(limit["mechanism"], toes);
    let block = &limit["equivalent_block"]["at_critical"];
    let half_diagonal_m = block["half_diagonal_m"].as_f64().unwrap();
    assert!((half_diagonal_m - 1.04_f64.sqrt() * 2.0).abs() < 1e-10);
    let arguments = ["impact", "--count", "3", "--format", "json"];
    let impact: Value = serde_json::from_str(&archrock(&arguments, &path)).unwrap();
    assert_eq!(impact["impacts"].as_array().unwrap().len(), 3);
    let after = json!({ "sway": "left", "hinges": [{ "toe": "left" }] });
    assert_eq!(impact["impacts"][2]["after"], after);
    assert!(archrock(&["limit"], &path).contains("right"));
    assert!(archrock(&["impact"], &path).contains("left"));
    assert!(archrock(&["check"], &path).contains("density_kg_m3 = 2000.0"));

    // Pictures of mechanisms exist for arches only; the error comes before anything is drawn.
    for command in ["limit", "impact"] {
        let picture = folder.path().join("p.svg");
        let arguments = [command, "--plot", "p.svg", "s.toml"];
        refused(folder.path(), &arguments, &["arches"]);
        assert!(!picture.exists());
    }

    // A flat column stops at the first impact.
    fs::write(&path, "[column]\nheight_m = 1\nwidth_m = 2\n").unwrap();
    let impact: Value = serde_json::from_str(&archrock(&arguments, &path)).unwrap();
    assert_eq!(
        [&impact["impacts"], &impact["warnings"]],
        [&json!([]), &json!([])]
    );
    assert!(!archrock(&["impact"], &path).is_empty());
    let flat = "[column]\nheight_m = 1\nwidth_m = 2\n[initial]\nsway = 'left'\nrotation_rad = 0.3";
    let folder = results(flat, &[]);
    let impacts = Table::read(folder.path().join("impacts.csv")).rows;
    assert_eq!(impacts[0].number("restitution"), 0.0);
    assert_eq!(impacts[0].number("rate_after_rad_s"), 0.0);
    assert_eq!(summary(folder.path())["outcome"], "rest");
}
