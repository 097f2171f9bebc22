//! `archrock run` with free hinges: its files, its printed output, overriding the scenario, and refusals.

use crate::common::program;
use crate::common::prose::{golden, shows, skeleton};
use crate::common::results::{Table, json};
use crate::common::{COLUMN, parsed};
use std::fs;
use std::path::PathBuf;

use crate::common::program::{archrock, done, stderr};
use archrock::dynamics::repeatability::Repeatability;
use archrock::dynamics::{Details, FreeHinges, HalfCycle, Summary};
use archrock::studies::run;
use archrock::{Column, Model as _, Pulse, Request};
use serde_json::Value;
use tempfile::TempDir;

/// Seven voussoirs under a pulse: rest within two seconds.
const SEVEN: &str = "title = \"Seven\"\n[arch]\nmean_radius_m = 10.0\nthickness_ratio = 0.15\nembrace_deg = 157.5\n\
                     voussoirs = 7\n[ground.rectangular]\namplitude_g = -0.5336\nduration_s = 0.2\n";
const SHAKEN_COLUMN: &str =
    "height_m = 4.0\nwidth_m = 0.8\n[ground.rectangular]\namplitude_g = -0.4\nduration_s = 0.3\n";

/// The files and words of a run.
struct Results {
    root: TempDir,
    said: String,
}

impl Results {
    /// Runs a scenario; results are in `out`.
    fn of(scenario: &str, arguments: &[&str]) -> Self {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("s.toml"), scenario).unwrap();
        let all = [&["run", "s.toml", "--out", "out"], arguments].concat();
        let output = archrock(root.path(), &all);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let said = String::from_utf8(output.stdout).unwrap();
        Self { root, said }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.path().join("out").join(name)
    }

    fn summary(&self) -> Value {
        json(&self.path("summary.json"))
    }

    fn files(&self, folder: &str) -> Vec<String> {
        program::result_names(&self.path(folder))
    }
}

fn free(scenario: &str) -> String {
    format!("{scenario}[free_hinges]\n")
}

/// The message of a run that is refused.
fn refusal(scenario: &str, arguments: &[&str]) -> String {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), scenario).unwrap();
    let output = archrock(root.path(), &[&["run", "s.toml"], arguments].concat());
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(!root.path().join("results").exists(), "{said}");
    said
}

#[test]
fn tables_of_a_row_are_consistent() {
    let results = Results::of(&free(SEVEN), &["--no-repeat"]);
    let names = [
        "events.csv",
        "history.svg",
        "impacts.csv",
        "joints.csv",
        "report.html",
        "rotations.csv",
        "summary.json",
    ];
    assert_eq!(results.files(""), names);
    let cost = |name| results.summary()[name].as_f64().unwrap();
    assert!(cost("iterations") > cost("steps") && cost("longest_step_us") > 0.0);
    let rotations = Table::read(results.path("rotations.csv"));
    let mut expected: Vec<String> = ["time_s", "ground_acceleration_m_s2", "phase", "state"]
        .map(str::to_owned)
        .to_vec();
    expected.extend((1..=7).map(|block| format!("rotation_{block}_rad")));
    expected.extend((1..=7).map(|block| format!("rate_{block}_rad_s")));
    expected.extend(["open_joints", "friction_demand"].map(str::to_owned));
    assert_eq!(*rotations.header, expected);
    let joints = Table::read(results.path("joints.csv"));
    assert_eq!(joints.header.len(), 1 + 2 * 8);
    assert_eq!(
        joints.header[..3],
        ["time_s", "gap_0_intrados_m", "gap_0_extrados_m"]
    );
    assert_eq!(joints.numbers("time_s"), rotations.numbers("time_s"));

    // A joint is open if one of its gaps is; the difference of the gaps follows from the rotations.
    let thickness_m = 0.15 * 10.0;
    for row in 0..joints.rows.len() {
        let mut open = 0;
        for joint in 0..8 {
            let [intrados_m, extrados_m] = ["intrados", "extrados"]
                .map(|edge| joints.rows[row].number(&format!("gap_{joint}_{edge}_m")));
            assert!(intrados_m >= 0.0 && extrados_m >= 0.0);
            open += usize::from(intrados_m > 0.0 || extrados_m > 0.0);
            let rotation = |block: usize| match block {
                1..=7 => rotations.rows[row].number(&format!("rotation_{block}_rad")),
                _ => 0.0,
            };
            let turn_rad = rotation(joint) - rotation(joint + 1);
            assert!(((extrados_m - intrados_m) / thickness_m - turn_rad).abs() < 1e-9);
        }
        assert_eq!(rotations.rows[row]["open_joints"], open.to_string());
        assert_eq!(
            open == 0,
            rotations.rows[row]["state"] == "rest",
            "row {row}"
        );
    }

    let impacts = Table::read(results.path("impacts.csv"));
    let header = [
        "impact",
        "time_s",
        "joints_shut",
        "edges_shut",
        "joints_opened",
        "edges_opened",
        "energy_before_j",
        "energy_after_j",
        "energy_taken_j",
    ];
    assert_eq!(*impacts.header, header);
    let summary = results.summary();
    assert_eq!(summary["outcome"], "rest");
    assert_eq!(summary["overturning_sway"], Value::Null);
    assert_eq!(summary["impacts"], impacts.rows.len());
    assert!(impacts.numbers("time_s").is_sorted());
    let taken_j: f64 = impacts.numbers("energy_taken_j").iter().sum();
    let all_j = summary["energy_taken_j"].as_f64().unwrap();
    assert!((taken_j / all_j - 1.0).abs() < 1e-9, "{taken_j} {all_j}");
    for row in 0..impacts.rows.len() {
        assert!(
            impacts.rows[row].number("energy_after_j")
                <= impacts.rows[row].number("energy_before_j")
        );
        for column in ["joints_shut", "joints_opened"] {
            let joints = impacts.rows[row][column].split_whitespace();
            let edges = column.replace("joints", "edges");
            let edges: Vec<&str> = impacts.rows[row][&edges].split_whitespace().collect();
            assert_eq!(edges.len(), joints.clone().count());
            for edge in edges {
                assert!(["intrados", "extrados", "both"].contains(&edge), "{edge}");
            }
            assert!(
                joints
                    .map(|joint| joint.parse::<usize>().unwrap())
                    .is_sorted()
            );
        }
    }
    // The structure starts; every impact is an event; after the last impact it rests.
    let events = Table::read(results.path("events.csv"));
    assert_eq!(events.rows.len(), impacts.rows.len() + 2);
    assert_eq!(events.rows[0]["kind"], "uplift");
    assert_eq!(events.rows.last().unwrap()["kind"], "rest");
    assert_eq!(events.rows[0]["mechanism"], "");
    assert_eq!(
        *events.header,
        [
            "time_s",
            "phase",
            "kind",
            "sway",
            "mechanism",
            "energy_j",
            "joints_open",
            "edges_open"
        ]
    );

    // Peaks are those of the half cycles; rows of the table may reach a little less.
    let cycles = summary["half_cycles"].as_array().unwrap();
    let peaks = [8.4125e-3, 5.933e-3, 2.373e-3];
    assert!(cycles.len() >= peaks.len());
    for (cycle, peak) in cycles.iter().zip(peaks) {
        assert!((cycle["peak_rad"].as_f64().unwrap() / peak - 1.0).abs() < 2e-3);
    }
    assert_eq!(cycles[0]["sway"], "right");
    assert_eq!(cycles[1]["sway"], "left");
    for pair in cycles.windows(2) {
        let [start_s, duration_s] =
            ["start_s", "duration_s"].map(|key| pair[0][key].as_f64().unwrap());
        assert!((start_s + duration_s - pair[1]["start_s"].as_f64().unwrap()).abs() < 1e-9);
    }
    assert_eq!(summary["largest_peak_rotation_rad"], cycles[0]["peak_rad"]);
    let of_rows = rotations.numbers("rotation_5_rad");
    let of_rows = of_rows
        .iter()
        .fold(0.0_f64, |most, angle| most.max(angle.abs()));
    let peak_rad = summary["peak_rotation_5_rad"].as_f64().unwrap();
    assert!(of_rows <= peak_rad && of_rows > 0.999 * peak_rad);
    for side in ["right", "left"] {
        let incipient_g = summary["incipient_acceleration_g"][side].as_f64().unwrap();
        assert!((incipient_g - 0.370_010).abs() < 1e-6);
    }
    for key in [
        "least_normal_n",
        "largest_friction_demand",
        "largest_friction_demand_time_s",
        "energy_defect_ratio",
        "closure_error_m",
        "steps",
        "iterations",
        "relaxed",
    ] {
        assert!(summary[key].is_number(), "{key}: {}", summary[key]);
    }
    assert_eq!(summary.get("repeatability"), None);
    assert!(summary["scenario"].get("impact").is_none());
    for name in names {
        let text = fs::read_to_string(results.path(name)).unwrap();
        assert!(!text.contains("NaN") && !text.contains(",inf"), "{name}");
    }
}

/// Joints and edges in a row of a table, from their columns.
fn hinges(table: &Table, row: usize, what: &str) -> Vec<(usize, String)> {
    let [joints, edges] = ["joints", "edges"].map(|of| &table.rows[row][&format!("{of}_{what}")]);
    let joints = joints.split_whitespace();
    let edges: Vec<&str> = edges.split_whitespace().collect();
    let joints: Vec<usize> = joints.map(|joint| joint.parse().unwrap()).collect();
    assert_eq!(joints.len(), edges.len());
    joints
        .into_iter()
        .zip(edges.into_iter().map(str::to_owned))
        .collect()
}

/// The ground reaches the incipient acceleration of limit analysis at a known instant of its sine, and the hinges of that
/// mechanism open then; a column starts about a toe.
#[test]
fn motion_starts_at_the_push_and_hinges_of_limit_analysis() {
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 12\n";
    let column = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";
    let shaken = |structure: &str, amplitude_g: f64| {
        format!(
            "{structure}[ground.one_sine]\namplitude_g = {amplitude_g}\nduration_s = 2.0\n[simulation]\nduration_s = 1.0\n"
        )
    };
    let limit = |structure: &str| -> Value {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("s.toml"), structure).unwrap();
        let output = archrock(root.path(), &["limit", "s.toml", "--format", "json"]);
        serde_json::from_slice(&output.stdout).unwrap()
    };
    for (amplitude_g, side) in [(-0.2, "right"), (0.2, "left")] {
        let limit = limit(arch);
        let incipient_g = limit["incipient_acceleration_g"][side].as_f64().unwrap();
        let due_s = (incipient_g / 0.2).asin() / std::f64::consts::PI;
        let mechanism = limit["mechanism"][side].as_array().unwrap().iter();
        let due: Vec<(usize, String)> = mechanism
            .map(|hinge| {
                let joint = hinge["angle_deg"].as_f64().unwrap() / 15.0;
                (
                    joint.round() as usize,
                    hinge["edge"].as_str().unwrap().to_owned(),
                )
            })
            .collect();
        for options in ["", "friction_coefficient = 1.5\n"] {
            let scenario = free(&shaken(arch, amplitude_g)) + options;
            let results = Results::of(&scenario, &["--no-repeat", "--no-report"]);
            let events = Table::read(results.path("events.csv"));
            assert_eq!(events.rows[0]["kind"], "uplift");
            assert_eq!(events.rows[0]["phase"], "1");
            assert_eq!(events.rows[0]["sway"], side);
            assert_eq!(hinges(&events, 0, "open"), due);
            // Steps are 0.24 ms long. The push grows slowly, and gaps with the cube of the time since. With slip, gaps count
            // from 1e-9 of the thickness, which takes some 2 ms; without slip, from 1e-12.
            let miss_s = events.rows[0].number("time_s") - due_s;
            let late_s = if options.is_empty() { 5e-4 } else { 3e-3 };
            assert!((-3e-4..late_s).contains(&miss_s), "{miss_s}");
            assert!(events.rows[0].number("energy_j").abs() < 1e-3);
        }
    }
    for (amplitude_g, side, edge) in [(-0.3, "right", "extrados"), (0.3, "left", "intrados")] {
        let scenario = free(&shaken(column, amplitude_g));
        let results = Results::of(&scenario, &["--no-repeat", "--no-report"]);
        let events = Table::read(results.path("events.csv"));
        let due_s = (0.2_f64 / 0.3).asin() / std::f64::consts::PI;
        assert!((events.rows[0].number("time_s") - due_s).abs() < 3e-4);
        assert_eq!(events.rows[0]["sway"], side);
        assert_eq!(hinges(&events, 0, "open"), [(0, edge.to_owned())]);
    }
    // A released structure already moves.
    let released = free(column) + "[initial]\nsway = \"right\"\nrotation_rad = 0.02\n";
    let results = Results::of(&released, &["--no-repeat", "--no-report"]);
    let events = Table::read(results.path("events.csv"));
    assert_eq!(events.rows[0]["kind"], "impact");
    // It lands flat, and continues to the other side, about the other toe.
    for row in 0..events.rows.len() - 1 {
        let (side, edge) = [("left", "intrados"), ("right", "extrados")][row % 2];
        assert_eq!(events.rows[row]["sway"], side);
        assert_eq!(hinges(&events, row, "open"), [(0, edge.to_owned())]);
    }
}

/// Joints that are open at an event stay open until the next one, and every joint that is wide open in `joints.csv` was named.
/// The open joints include those that an impact opens, some for less than a step; those that it shuts only if they open again.
#[test]
fn events_name_the_joints_that_are_open() {
    for options in ["", "friction_coefficient = 0.7\n"] {
        let scenario =
            free(SEVEN) + options + "[simulation]\noutput_step_s = 0.0005\nduration_s = 1.0\n";
        let results = Results::of(&scenario, &["--no-repeat", "--no-report"]);
        let events = Table::read(results.path("events.csv"));
        let impacts = Table::read(results.path("impacts.csv"));
        let joints = Table::read(results.path("joints.csv"));
        let rotations = Table::read(results.path("rotations.csv"));
        let of = |rows: std::ops::Range<usize>, table: &Table, what: &str| -> Vec<_> {
            rows.map(|row| hinges(table, row, what)).collect()
        };
        let open = of(0..events.rows.len(), &events, "open");
        let opened = of(0..impacts.rows.len(), &impacts, "opened");
        let shut = of(0..impacts.rows.len(), &impacts, "shut");
        let impact_events =
            (0..events.rows.len()).filter(|row| events.rows[*row]["kind"] == "impact");
        let impact_of: std::collections::HashMap<usize, usize> = impact_events
            .enumerate()
            .map(|(impact, event)| (event, impact))
            .collect();
        assert_eq!(impact_of.len(), impacts.rows.len());
        for (event, impact) in &impact_of {
            assert!(
                opened[*impact]
                    .iter()
                    .all(|hinge| open[*event].contains(hinge))
            );
            let parts = |joint: &usize| opened[*impact].iter().any(|(other, _)| other == joint);
            for (joint, _) in &shut[*impact] {
                let is_open = open[*event].iter().any(|(other, _)| other == joint);
                assert!(
                    !is_open || parts(joint) || !options.is_empty(),
                    "joint {joint}"
                );
            }
        }
        let (mut stay, mut shuts, mut far) = (0, 0, 0);
        for row in 0..rotations.rows.len() {
            let phase = rotations.rows[row].number("phase") as usize;
            let Some(event) = phase.checked_sub(1) else {
                continue;
            };
            // A joint that has just opened needs one step.
            if rotations.rows[row].number("time_s") <= events.rows[event].number("time_s") {
                continue;
            }
            let gaps_m = |joint: usize| {
                ["intrados", "extrados"]
                    .map(|edge| joints.rows[row].number(&format!("gap_{joint}_{edge}_m")))
            };
            let by_impact = impact_of.get(&event).map(|impact| &opened[*impact]);
            for hinge in &open[event] {
                if by_impact.is_none_or(|opened| !opened.contains(hinge)) {
                    let [intrados_m, extrados_m] = gaps_m(hinge.0);
                    let is_open = match hinge.1.as_str() {
                        "intrados" => extrados_m > 0.0,
                        "extrados" => intrados_m > 0.0,
                        _ => intrados_m.max(extrados_m) > 0.0,
                    };
                    // If joints slip, corners with tiny gaps close without an impact.
                    assert!(
                        is_open || !options.is_empty(),
                        "joint {hinge:?} in row {row}"
                    );
                    stay += usize::from(is_open);
                    shuts += usize::from(!is_open);
                }
            }
            // Gaps cannot grow this much between two rows.
            let is_first = rotations.rows[row]["phase"] != rotations.rows[row - 1]["phase"];
            for joint in 0..8 {
                let [intrados_m, extrados_m] = gaps_m(joint);
                if is_first && intrados_m.max(extrados_m) > 2e-3 {
                    let named = open[event].iter().find(|(other, _)| *other == joint);
                    let edge = if extrados_m > intrados_m {
                        "intrados"
                    } else {
                        "extrados"
                    };
                    assert_eq!(
                        named.map(|(_, edge)| edge.as_str()),
                        Some(edge),
                        "row {row}"
                    );
                    far += 1;
                }
            }
        }
        assert!(
            stay > 2000 && shuts < stay / 50 && far > 50,
            "{stay} {shuts} {far}"
        );
    }
}

#[test]
fn the_vertical_ground_has_a_column_and_the_end_of_an_overturning_is_an_event() {
    let scenario = free(SEVEN).replace(
        "amplitude_g = -0.5336",
        "amplitude_g = -1.3\nvertical_amplitude_g = 0.2",
    );
    let results = Results::of(&scenario, &["--no-repeat"]);
    let rotations = Table::read(results.path("rotations.csv"));
    let last = rotations.header.last().unwrap();
    assert_eq!(last, "vertical_acceleration_m_s2");
    assert!((rotations.rows[1].number(last) - 0.2 * 9.81).abs() < 1e-12);
    let summary = results.summary();
    assert_eq!(summary["outcome"], "overturned");
    assert_eq!(summary["overturning_sway"], "right");
    let events = Table::read(results.path("events.csv"));
    let end = events.rows.len() - 1;
    assert_eq!(events.rows[end]["kind"], "overturned");
    assert!(summary["outcome_time_s"].as_f64().unwrap() <= events.rows[end].number("time_s"));
    shows(
        &results.said,
        &[summary["outcome_time_s"].as_f64().unwrap()],
    );
}

#[test]
fn the_picture_shows_every_block_and_which_joints_are_open() {
    let results = Results::of(&free(SEVEN), &["--no-repeat"]);
    let picture = fs::read_to_string(results.path("history.svg")).unwrap();
    for name in [
        "ground", "1", "7", "intrados", "extrados", "energy", "right", "left",
    ] {
        assert!(picture.contains(&format!("data-name=\"{name}\"")), "{name}");
    }
    assert!(picture.contains(">Total energy / barrier<"));
    assert!(picture.contains(">block 5, which turns most<"));
    // For two drums no barrier is known.
    let column = format!("[column]\ndrums = 2\n{SHAKEN_COLUMN}[free_hinges]\n");
    let results = Results::of(&column, &["--no-repeat"]);
    let picture = fs::read_to_string(results.path("history.svg")).unwrap();
    assert!(picture.contains(">Energy (J)<"));
    assert!(picture.contains(">hinge at the left edge<"));
    let joints = Table::read(results.path("joints.csv"));
    assert_eq!(joints.header.len(), 1 + 2 * 2);
}

#[test]
fn differences_of_repetitions_are_printed_and_written() {
    let results = Results::of(&free(SEVEN), &[]);
    let summary = results.summary();
    let spread = &summary["repeatability"];
    for which in ["own", "mirrored", "landings_merged"] {
        assert_eq!(spread["outcomes"][which], "rest");
    }
    let same = spread["same_until_half_cycle"].as_u64().unwrap();
    assert!(same >= 2, "{same}");
    let cycles = spread["half_cycles"].as_array().unwrap();
    assert!(cycles.len() as u64 > same);
    let reported = summary["half_cycles"].as_array().unwrap();
    for (index, cycle) in cycles.iter().enumerate() {
        let [own, min, max] =
            ["own", "min", "max"].map(|key| cycle["peak_rad"][key].as_f64().unwrap());
        assert!(min <= own && own <= max);
        let same_time = |one: &&Value| one["peak_time_s"] == cycle["peak_time_s"];
        let its_own = reported.iter().find(same_time).unwrap();
        assert_eq!(its_own["peak_rad"].as_f64(), Some(own));
        if (index as u64) < same {
            assert!(max - min <= 0.01 * max);
        }
    }
    // The first half cycle does not depend on the steps.
    let first = &cycles[0]["peak_rad"];
    let ratio = first["max"].as_f64().unwrap() / first["min"].as_f64().unwrap();
    assert!(ratio < 1.001, "{ratio}");
    let said = &results.said;
    // This motion decays: its largest half cycles are the first three.
    let largest = format!("the {} largest half cycles within 1 %", same.min(3));
    let (_, rest) = said.split_once(&largest).unwrap();
    shows(rest, &[spread["parts_at_s"].as_f64().unwrap()]);
}

/// Three short pushes make the arch rattle, then a longer one makes it rock. The reported and judged half cycles are those of the
/// rocking, not the first ones.
#[test]
fn the_largest_half_cycles_are_reported() {
    let root = tempfile::tempdir().unwrap();
    let mut record = "time_s,acceleration_g\n".to_owned();
    for index in 0..=300 {
        let acceleration_g = match index {
            50..53 => -0.48,
            80..83 | 110..113 => 0.48,
            200..220 => -0.5336,
            _ => 0.0,
        };
        record += &format!("{},{acceleration_g}\n", 0.01 * f64::from(index));
    }
    fs::write(root.path().join("record.csv"), record).unwrap();
    let scenario = "[arch]\nmean_radius_m = 10.0\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 7\n\
                    [free_hinges]\n[ground.record]\nfile = \"record.csv\"\nunit = \"g\"\n[simulation]\nduration_s = 10\n";
    fs::write(root.path().join("s.toml"), scenario).unwrap();
    let output = archrock(
        root.path(),
        &["run", "s.toml", "--out", "out", "--no-report"],
    );
    let said = String::from_utf8(output.stdout).unwrap();
    let summary = json(&root.path().join("out/summary.json"));
    let number = |value: &Value, key: &str| value[key].as_f64().unwrap();
    let largest_rad = number(&summary, "largest_peak_rotation_rad");
    let cycles = summary["half_cycles"].as_array().unwrap();
    assert!(number(&cycles[0], "peak_rad") < 0.02 * largest_rad);
    for cycle in cycles {
        assert!(number(cycle, "peak_rad") >= 1e-3 * largest_rad, "{cycle}");
        let since_s = number(cycle, "peak_time_s") - number(cycle, "start_s");
        assert!(
            (0.0..=number(cycle, "duration_s")).contains(&since_s),
            "{cycle}"
        );
    }
    let mut largest: Vec<&Value> = cycles.iter().collect();
    largest.sort_by(|a, b| number(b, "peak_rad").total_cmp(&number(a, "peak_rad")));
    largest.truncate(3);
    largest.sort_by(|a, b| number(a, "start_s").total_cmp(&number(b, "start_s")));
    assert!(
        largest
            .iter()
            .any(|cycle| number(cycle, "peak_rad") == largest_rad)
    );
    // The words list them in this order.
    let order = largest.iter().map(|cycle| {
        let (peak_rad, time_s) = (number(cycle, "peak_rad"), number(cycle, "peak_time_s"));
        [format!("{peak_rad:.6}"), format!("{time_s:.4}")]
    });
    let order: Vec<String> = order.flatten().collect();
    let (_, printed) = skeleton(&said);
    assert!(
        printed.windows(order.len()).any(|some| some == order),
        "{said}"
    );
    golden("run-free-hinges", &said);
    // The repetitions differ after the rattling.
    assert!(
        summary["repeatability"]["parts_at_s"]
            .as_f64()
            .is_none_or(|at_s| at_s > 2.0)
    );
}

fn half_cycles_mut(summary: &mut Summary) -> &mut Vec<HalfCycle> {
    match &mut summary.details {
        Details::Rigid(row) => &mut row.half_cycles,
        Details::Mechanisms(_) | Details::Elastic(..) => panic!("its joints are rigid"),
    }
}

/// Rattling may change the number of half cycles before the largest one; such a repetition still has the same large half cycles.
#[test]
fn half_cycles_are_compared_at_the_same_time() {
    let column = Column::new(4.0, 0.8).unwrap();
    let model = FreeHinges::of_column(&column).unwrap();
    let ground = Pulse::Rectangular
        .lasting_s(0.3)
        .starting_at_s(0.5)
        .horizontal_m_s2(3.0)
        .unwrap();
    let own = model.simulate(&ground, &Request::default(), None).unwrap();
    assert!(own.half_cycles().len() > 2);
    let mut rattles = own.clone();
    let cycles = half_cycles_mut(&mut rattles);
    let before = HalfCycle {
        start_s: 0.1,
        duration_s: 0.1,
        peak_rad: 1e-6,
        peak_time_s: 0.15,
        ..cycles[0]
    };
    cycles.insert(0, before);
    let spread = Repeatability::new(&own, &[("double steps", Ok(rattles))]);
    assert_eq!(spread.parts_at_s, None);
    assert!(spread.half_cycles.iter().all(|cycle| cycle.is_certain()));
    // A repetition without such a half cycle differs there.
    let mut shorter = own.clone();
    half_cycles_mut(&mut shorter).truncate(1);
    let spread = Repeatability::new(&own, &[("double steps", Ok(shorter))]);
    assert_eq!(spread.same_until_half_cycle, 1);
    assert_eq!(spread.half_cycles[1].peak_rad, None);
    assert_eq!(spread.parts_at_s, Some(own.half_cycles()[1].start_s));
}

/// A leaning block starts more easily to one side. Ground that pushes to one side only is compared with the onset on that side.
#[test]
fn a_push_is_compared_with_the_onset_on_its_side() {
    let root = tempfile::tempdir().unwrap();
    // The centre is at 0.7 m of a base of 1 m, and 1 m high: 0.3 g to the right, 0.7 g to the left.
    fs::write(root.path().join("j.csv"), "0,0,1,0\n0.4,2,1.4,2\n").unwrap();
    for (amplitude_g, ratio) in [(-0.2, 0.2 / 0.3), (0.2, 0.2 / 0.7)] {
        let scenario = format!(
            "[blocks]\njoints = 'j.csv'\nsupports = 'left'\n[free_hinges]\n\
             [ground.rectangular]\namplitude_g = {amplitude_g}\nduration_s = 0.2\n"
        );
        fs::write(root.path().join("s.toml"), scenario).unwrap();
        let arguments = [
            "run",
            "s.toml",
            "--out",
            "out",
            "--no-report",
            "--no-repeat",
        ];
        let output = archrock(root.path(), &arguments);
        let said = String::from_utf8(output.stdout).unwrap();
        shows(&said, &[0.3, 0.7, 0.2, ratio]);
        if amplitude_g > 0.0 {
            golden("run-leaning-block", &said);
        }
    }
}

/// A cap that bears half a hundredth of the weight on a face of 30 degrees needs a friction coefficient of 0.58 there, and does not count; one with two
/// hundredths does. Under a push too weak to move it the rest needs the ratio of that push to gravity.
#[test]
fn needed_friction_counts_joints_bearing_a_hundredth_of_the_weight() {
    for (share, needed) in [(0.005, 0.1_f64), (0.02, 0.5773)] {
        let root = tempfile::tempdir().unwrap();
        // Faces from 30 degrees below to level: the cap is a wedge whose lower face is inclined.
        let (width_m, height_m) = (1.0, 2.0);
        let rise_m = width_m * (30.0_f64).to_radians().tan();
        let area_m2 = width_m * (height_m + 0.5 * rise_m);
        let top_m = height_m + rise_m;
        let cap_m2 = share * area_m2 / (1.0 - share);
        let thick_m = cap_m2 / width_m;
        let joints = format!(
            "0,0,1,0\n0,{height_m},1,{top_m}\n0,{},1,{}\n",
            height_m + thick_m,
            top_m + thick_m
        );
        fs::write(root.path().join("j.csv"), joints).unwrap();
        let scenario = "[blocks]\njoints = 'j.csv'\nsupports = 'left'\n[free_hinges]\n\
                        [ground.rectangular]\namplitude_g = 0.1\nduration_s = 0.2\n";
        fs::write(root.path().join("s.toml"), scenario).unwrap();
        let arguments = [
            "run",
            "s.toml",
            "--out",
            "out",
            "--no-report",
            "--no-repeat",
        ];
        let output = archrock(root.path(), &arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let summary = json(&root.path().join("out/summary.json"));
        assert_eq!(summary["outcome"], "never_moved");
        let told = summary["largest_friction_demand"].as_f64().unwrap();
        assert!(
            told > 0.99 * needed && told < 1.35 * needed,
            "{share} {told}"
        );
    }
}

/// With far too long steps the ends of the arch may separate in the computation, or its energy balance may fail. Rounding decides
/// which steps cause this; among a few, one makes a repetition fail but not the history itself.
#[test]
fn a_failed_repetition_keeps_the_history_and_its_reason() {
    let scenario = |step_s: f64| {
        free(SEVEN).replace("amplitude_g = -0.5336", "amplitude_g = 0.6")
            + &format!("longest_step_s = {step_s}\n[simulation]\nduration_s = 4.0\n")
    };
    let failed = [0.08, 0.13, 0.16, 0.2, 0.04, 0.06, 0.1, 0.5]
        .into_iter()
        .find_map(|step_s| {
            let results = Results::of(&scenario(step_s), &[]);
            let reason = results.summary()["repeatability"]["failed"][0]
                .as_str()
                .map(str::to_owned);
            reason.map(|reason| (step_s, results, reason))
        });
    let (step_s, results, reason) = failed.expect("a repetition that fails");
    let said = &results.said;
    assert!(said.contains(&reason), "{said}");
    // Everything else is as without repetitions.
    let alone = Results::of(&scenario(step_s), &["--no-repeat"]);
    assert_eq!(results.files(""), alone.files(""));
    for name in [
        "rotations.csv",
        "joints.csv",
        "events.csv",
        "impacts.csv",
        "history.svg",
    ] {
        let read = |results: &Results| fs::read(results.path(name)).unwrap();
        assert!(read(&results) == read(&alone), "{name}");
    }
    let without = |key: &[&str], mut summary: Value| {
        for key in key {
            assert!(summary.as_object_mut().unwrap().remove(*key).is_some());
        }
        summary
    };
    let differs = ["friction_demand", "longest_step_us", "to_quote"];
    assert_eq!(
        without(
            &[&["repeatability"], &differs[..]].concat(),
            results.summary()
        ),
        without(&differs, alone.summary())
    );
    // The friction demand is the largest of the history and its repetitions.
    let demands = [results.summary(), alone.summary()]
        .map(|summary| summary["friction_demand"].as_f64().unwrap());
    assert!(demands[0] >= demands[1], "{demands:?}");
    let own = &alone.summary()["lasting_friction_demand"];
    assert_eq!(own.as_f64(), Some(demands[1]));
}

#[test]
fn repeatability_includes_other_outcomes() {
    let column = Column::new(4.0, 0.8).unwrap();
    let model = FreeHinges::of_column(&column).unwrap();
    let pulse = |amplitude_m_s2| {
        let ground = Pulse::Rectangular
            .lasting_s(0.3)
            .horizontal_m_s2(amplitude_m_s2)
            .unwrap();
        model.simulate(&ground, &Request::default(), None).unwrap()
    };
    let (rests, falls) = (pulse(3.0), pulse(20.0));
    let alike = Repeatability::new(&rests, &[("double steps", Ok(rests.clone()))]);
    assert!(alike.outcomes.iter().all(|one| *one == alike.outcomes[0]));
    assert_eq!(alike.parts_at_s, None);
    assert_eq!(alike.same_until_half_cycle, alike.half_cycles.len());
    let other = Repeatability::new(
        &rests,
        &[
            ("double steps", Ok(rests.clone())),
            ("half steps", Ok(falls.clone())),
        ],
    );
    assert!(other.outcomes.iter().any(|one| *one != other.outcomes[0]));
    assert_eq!(other.same_until_half_cycle, 0);
    // They part in the first half cycle, which begins with the first step.
    assert!(other.parts_at_s.unwrap() < 1e-3);
    // JSON has the side to which each overturns.
    let left = pulse(-20.0);
    let spread = Repeatability::new(
        &falls,
        &[
            ("double steps", Ok(left)),
            ("half steps", Ok(rests.clone())),
        ],
    );
    let scenario = parsed(&format!("{COLUMN}[free_hinges]\n"));
    let summary = run::summary(&run::ComputedRun {
        scenario: &scenario,
        model: &model,
        history: &falls,
        impacts: Default::default(),
        repeated: Some(&spread),
        varied: &[],
        mirrored: None,
    })
    .unwrap();
    let spread = &summary["repeatability"];
    assert_eq!(spread["outcomes"]["double_steps"], "overturned");
    let sides =
        ["own", "double_steps", "half_steps"].map(|name| &spread["overturning_sways"][name]);
    assert_eq!(sides[0], &summary["overturning_sway"]);
    assert!(sides[1].is_string() && sides[1] != sides[0] && sides[2].is_null());
}

#[test]
fn hinges_override_the_scenario() {
    let four = Results::of(SEVEN, &[]);
    assert!(four.summary().get("evaluations").is_some());
    // The model chosen by the command overrides that of the scenario.
    let overridden = Results::of(&free(SEVEN), &["--hinges", "four"]);
    for name in ["rotations.csv", "impacts.csv", "summary.json"] {
        let read = |results: &Results| fs::read(results.path(name)).unwrap();
        assert!(read(&four) == read(&overridden), "{name}");
    }
    let impact = "[impact]\nmodel = \"same_sections\"\n";
    let free_of_four = Results::of(
        &format!("{SEVEN}{impact}"),
        &["--hinges", "free", "--no-repeat"],
    );
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), format!("{SEVEN}{impact}")).unwrap();
    let free_hinges = ["run", "s.toml", "--hinges", "free", "--no-repeat"];
    let said = done(folder.path(), &free_hinges);
    assert!(said.contains("[impact]"), "{said}");
    let chosen = Results::of(&free(SEVEN), &["--no-repeat"]);
    let read = |results: &Results| fs::read(results.path("rotations.csv")).unwrap();
    assert!(read(&free_of_four) == read(&chosen));
}

#[test]
fn both_models_stand_side_by_side_with_one_picture() {
    let results = Results::of(SEVEN, &["--hinges", "both", "--no-repeat"]);
    assert_eq!(
        results.files(""),
        ["four", "free", "overlay.svg", "report.html"]
    );
    let outcome = |name: &str| json(&results.path(name))["outcome"].clone();
    assert_eq!(outcome("four/summary.json"), "rest");
    assert_eq!(outcome("free/summary.json"), "rest");
    let picture = fs::read_to_string(results.path("overlay.svg")).unwrap();
    for name in ["ground", "four links", "free hinges"] {
        assert!(picture.contains(&format!("data-name=\"{name}\"")), "{name}");
    }
    // A run with one model after a run with both: the folder has only its files, and none of an earlier model.
    let root = results.root.path();
    for (hinges, joints) in [("free", true), ("four", false)] {
        let arguments = ["run", "s.toml", "--out", "out", "--hinges", hinges];
        assert_eq!(archrock(root, &arguments).status.code(), Some(0));
        assert_eq!(results.path("joints.csv").exists(), joints);
        assert!(!results.path("overlay.svg").exists());
    }
    let arguments = ["run", "s.toml", "--out", "out", "--hinges", "both"];
    assert_eq!(archrock(root, &arguments).status.code(), Some(0));
    assert_eq!(
        results.files(""),
        ["four", "free", "overlay.svg", "report.html"]
    );
}

#[test]
fn rotations_go_to_standard_output() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), free(SEVEN)).unwrap();
    let arguments = ["run", "s.toml", "--no-repeat", "--rotations", "-"];
    let output = archrock(root.path(), &arguments);
    assert_eq!(output.status.code(), Some(0));
    assert!(!root.path().join("results").exists());
    let table = String::from_utf8(output.stdout).unwrap();
    let results = Results::of(&free(SEVEN), &["--no-repeat"]);
    let file = fs::read_to_string(results.path("rotations.csv")).unwrap();
    assert!(table == file);
}

/// Released drums turn about the base as one, like a single block, until the first impact.
#[test]
fn a_column_of_drums_is_released_from_its_base() {
    let released = |drums: &str| {
        let text = format!(
            "[column]\nheight_m = 4.0\nwidth_m = 0.8\n{drums}[free_hinges]\n[initial]\nsway = \"right\"\n\
             rotation_rad = 0.05\n[simulation]\nduration_s = 1.0\n"
        );
        Table::read(Results::of(&text, &["--no-repeat"]).path("rotations.csv"))
    };
    let [one, three] = ["", "drums = 3\n"].map(released);
    // The first impact is at 0.38 s.
    for row in 0..70 {
        let expected_rad = one.rows[row].number("rotation_1_rad");
        assert!(expected_rad < 0.0, "{row}");
        for block in 1..=3 {
            let rotation_rad = three.rows[row].number(&format!("rotation_{block}_rad"));
            assert!(
                (rotation_rad - expected_rad).abs() < 1e-9,
                "{row}: {rotation_rad} {expected_rad}"
            );
        }
    }
    assert!((three.rows[0].number("rotation_3_rad") + 0.05).abs() < 1e-15);
}

/// Released below the unstable equilibrium of its first mechanism, an arch of any shape comes to rest; released beyond, it falls at once.
#[test]
fn an_arch_of_any_shape_is_released_from_its_first_mechanism() {
    let released = |rotation_rad: f64| {
        let text = format!(
            "[pointed_arch]\nspan_m = 6.0\nrise_m = 4.0\nthickness_m = 0.6\nvoussoirs = 14\n[free_hinges]\n\
             [initial]\nsway = \"left\"\nrotation_rad = {rotation_rad}\n"
        );
        json(&Results::of(&text, &["--no-repeat"]).path("summary.json"))
    };
    let rested = released(0.05);
    assert_eq!(rested["outcome"], "rest");
    assert!(rested["peak_rotation_13_rad"].as_f64().unwrap() >= 0.05);
    let fallen = released(0.3);
    assert_eq!(fallen["outcome"], "overturned");
    assert_eq!(fallen["overturning_sway"], "left");
    // Only the released body moved.
    let peak_rad = fallen["peak_rotation_13_rad"].as_f64().unwrap();
    assert!((peak_rad - 0.3).abs() < 1e-12);
}

#[test]
fn requests_beyond_a_model_are_refused() {
    let whole = SEVEN.replace("voussoirs = 7\n", "");
    let said = refusal(&whole, &["--hinges", "free"]);
    assert!(said.contains("voussoirs"), "{said}");
    let said = refusal(&whole, &["--hinges", "both"]);
    assert!(said.contains("voussoirs"), "{said}");
    let drums = format!("[column]\ndrums = 3\n{SHAKEN_COLUMN}[free_hinges]\n");
    let said = refusal(&drums, &["--hinges", "four"]);
    assert!(said.contains("drums"), "{said}");
    let thick = SEVEN
        .replace("thickness_ratio = 0.15", "thickness_ratio = 0.6")
        .replace("157.5", "60.0");
    let said = refusal(&thick, &["--hinges", "four"]);
    assert!(said.contains("too thick"), "{said}");
    // There are no repetitions to leave out.
    for more in [&[][..], &["--hinges", "four"]] {
        let said = refusal(SEVEN, &[&["--no-repeat"], more].concat());
        assert!(said.contains("--no-repeat goes with free hinges"), "{said}");
    }
    // An arch that does not start as four links cannot be released in a mechanism.
    let released = free(&thick) + "[initial]\nsway = \"left\"\nrotation_rad = 0.001\n";
    let said = refusal(&released, &["--no-repeat"]);
    assert!(
        said.starts_with("error: s.toml:11:1: ") && said.contains("does not start as one"),
        "{said}"
    );
    let said = refusal(&free(SEVEN), &["--dimensionless"]);
    assert!(said.contains("--dimensionless"), "{said}");
    let said = refusal(SEVEN, &["--hinges", "both", "--rotations", "-"]);
    assert!(said.contains("--rotations"), "{said}");
    let said = refusal(SEVEN, &["--hinges", "five"]);
    assert!(
        said.contains("[possible values: four, free, elastic, both]"),
        "{said}"
    );
}

#[test]
fn a_column_of_one_block_moves_as_housners_block() {
    let column = format!("[column]\n{SHAKEN_COLUMN}");
    let results = Results::of(&column, &["--hinges", "both", "--no-repeat"]);
    let [four, free] = ["four", "free"].map(|model| {
        let table = Table::read(results.path(&format!("{model}/rotations.csv")));
        let name = if model == "four" {
            "rotation_rad"
        } else {
            "rotation_1_rad"
        };
        (table.numbers("time_s"), table.numbers(name))
    });
    let rows = 200;
    assert_eq!(four.0[..rows], free.0[..rows]);
    let peak_rad = four
        .1
        .iter()
        .fold(0.0_f64, |most, angle| most.max(angle.abs()));
    for (four_rad, free_rad) in four.1[..rows].iter().zip(&free.1[..rows]) {
        assert!(
            (four_rad - free_rad).abs() < 2e-4 * peak_rad,
            "{four_rad} {free_rad}"
        );
    }
    let [of_four, of_free] =
        ["four", "free"].map(|model| json(&results.path(&format!("{model}/summary.json"))));
    let incipient_g = |of: &Value| of["incipient_acceleration_g"]["right"].as_f64().unwrap();
    assert!((incipient_g(&of_four) - incipient_g(&of_free)).abs() < 1e-9);
    let impacts =
        ["four", "free"].map(|model| Table::read(results.path(&format!("{model}/impacts.csv"))));
    let kept = |table: &Table| {
        table.rows[0].number("energy_after_j") / table.rows[0].number("energy_before_j")
    };
    assert!((kept(&impacts[0]) - kept(&impacts[1])).abs() < 1e-9);
    let restitution = (1.0 - 1.5 * 0.04 / 1.04_f64).powi(2);
    assert!((kept(&impacts[1]) - restitution).abs() < 1e-9);
}

/// The friction is far less than this pulse requires: voussoirs slip and stay displaced.
#[test]
fn slipping_joints_are_reported() {
    let slipping = format!(
        "{SEVEN}[free_hinges]\nfriction_coefficient = 0.4\n[simulation]\nduration_s = 12\n"
    );
    let results = Results::of(&slipping, &["--no-repeat"]);
    let summary = results.summary();
    assert_eq!(summary["friction_coefficient"], 0.4);
    // The block has slipped so far down that its height no longer indicates overturning.
    assert_eq!(summary["peak_potential_over_barrier"], Value::Null);
    assert_eq!(summary["unconverged_steps"], 0);
    let slips_m: Vec<f64> = serde_json::from_value(summary["slips_m"].clone()).unwrap();
    assert_eq!(slips_m.len(), 8);
    let largest_m = slips_m
        .iter()
        .fold(0.0_f64, |most, slip| most.max(slip.abs()));
    assert!(
        largest_m > 0.05 && summary["friction_j"].as_f64().unwrap() > 1e4,
        "{summary:#}"
    );
    assert_eq!(summary["outcome"], "rest");
    // The last row has the remaining slips; the energy that friction took in impacts is at most the total.
    let joints = Table::read(results.path("joints.csv"));
    for (joint, (column, slip_m)) in joints.header[17..].iter().zip(&slips_m).enumerate() {
        assert_eq!(*column, format!("slip_{joint}_m"));
        assert!((joints.rows.last().unwrap().number(17 + joint) - slip_m).abs() < 1e-9);
    }
    assert_eq!(joints.header.len(), 17 + 8);
    // In every impact a corner lands; a joint that opens again at once turns about that corner.
    let table = Table::read(results.path("impacts.csv"));
    let list = |row: usize, name: &str| -> Vec<&str> {
        table.rows[row][name].split_whitespace().collect()
    };
    let mut turned = 0;
    for row in 0..table.rows.len() {
        let [shut, landed] = ["joints_shut", "edges_shut"].map(|name| list(row, name));
        let [opened, about] = ["joints_opened", "edges_opened"].map(|name| list(row, name));
        assert!(!shut.is_empty(), "{row}");
        for (joint, edge) in shut.iter().zip(landed) {
            if let Some(at) = opened.iter().position(|opened| opened == joint) {
                assert_eq!(about[at], edge, "{row}");
                turned += 1;
            }
        }
    }
    assert!(turned > 10, "{turned}");
    assert_eq!(table.header.last().unwrap(), "friction_j");
    let in_impacts_j: f64 = table.numbers("friction_j").iter().sum();
    assert!(in_impacts_j >= 0.0 && in_impacts_j <= summary["friction_j"].as_f64().unwrap());
    let picture = fs::read_to_string(results.path("history.svg")).unwrap();
    assert!(picture.contains("Slip (mm)"));
    let joint = slips_m
        .iter()
        .position(|slip| slip.abs() == largest_m)
        .unwrap();
    let slip = format!("joint {joint} slipped {:.3} mm", 1e3 * largest_m);
    assert!(results.said.contains(&slip), "{}", results.said);
    // Limit analysis also finds that sliding governs.
    let limit = archrock(
        results.root.path(),
        &["limit", "s.toml", "--format", "json"],
    );
    let limit: Value = serde_json::from_slice(&limit.stdout).unwrap();
    let friction = &limit["friction"];
    assert_eq!(friction["right"]["sliding_governs"], true);
    let acceleration_g = friction["left"]["incipient_acceleration_g"]
        .as_f64()
        .unwrap();
    assert!((acceleration_g - 0.26376).abs() < 1e-5);
    let least = friction["least_coefficient"].as_f64().unwrap();
    assert!(least > 0.1 && least < 0.3);

    for (options, words) in [
        ("friction_coefficient = 0", "friction_coefficient"),
        (
            "friction_coefficient = 0.7\nshortest_step_s = 1e-5",
            "all steps are the longest",
        ),
        (
            "friction_coefficient = 0.1",
            ":11:24: `friction_coefficient = 0.1` lets the structure slide under its own weight; must be at least 0.2063",
        ),
    ] {
        let refused = refusal(&format!("{SEVEN}[free_hinges]\n{options}\n"), &[]);
        assert!(refused.contains(words), "{options}\n{refused}");
    }
}

/// The horizontal peak of a pulse is reported with the push that starts the structure. With friction, that push is the result of
/// limit analysis: for a low block Coulomb's coefficient, for a slender one width over height.
#[test]
fn with_friction_the_onset_includes_friction() {
    for (height_m, width_m, friction, push_g) in [
        (0.3, 2.0, 0.2, 0.2),
        (2.0, 0.3, 0.2, 0.15),
        (2.0, 0.3, 0.1, 0.1),
    ] {
        let scenario = format!(
            "[column]\nheight_m = {height_m}\nwidth_m = {width_m}\n[free_hinges]\nfriction_coefficient = {friction}\n\
             [ground.half_sine]\namplitude_g = 0.5\nduration_s = 0.1\n[simulation]\nduration_s = 0.2\n"
        );
        let results = Results::of(&scenario, &["--no-repeat"]);
        shows(&results.said, &[push_g, 0.5, 0.5 / push_g]);
        for side in ["right", "left"] {
            let told_g = &results.summary()["incipient_acceleration_g"][side];
            // Accurate to the tolerance of the interior point method.
            assert!((told_g.as_f64().unwrap() - push_g).abs() < 1e-6, "{told_g}");
        }
    }
}

#[test]
fn sliding_without_rotation_reports_no_half_cycles() {
    let scenario = "[column]\nheight_m = 0.3\nwidth_m = 2\n[free_hinges]\nfriction_coefficient = 0.2\n\
                    [ground.half_sine]\namplitude_g = 0.5\nduration_s = 0.3\n[simulation]\nduration_s = 2\n";
    let results = Results::of(scenario, &[]);
    let said = results.said.clone();
    let slip_m = results.summary()["slips_m"][0].as_f64().unwrap();
    assert!((slip_m.abs() - 0.1015).abs() < 5e-4, "{slip_m}");
    shows(&said, &[1e3 * slip_m.abs()]);
    for words in ["half cycle", "0.000000"] {
        assert!(!said.contains(words), "{said}");
    }
}

/// A mechanism with a lower barrier than the first may overturn the arch.
#[test]
fn an_overturned_run_reports_no_fraction_of_the_barrier() {
    let scenario = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.138\nembrace_deg = 120\nvoussoirs = 9\n\
                    [free_hinges]\n[ground.one_sine]\namplitude_g = 2.309\nduration_s = 0.482\n\
                    [simulation]\nduration_s = 3\n";
    let results = Results::of(scenario, &["--no-repeat"]);
    let summary = results.summary();
    assert_eq!(summary["outcome"], "overturned");
    assert!(summary["peak_potential_over_barrier"].as_f64().unwrap() < 1.0);
    // A fraction of the barrier would suggest that the arch has not passed it.
    let percent = 100.0 * summary["peak_potential_over_barrier"].as_f64().unwrap();
    assert!(
        !results.said.contains(&format!("{percent:.1} %")),
        "{}",
        results.said
    );
}

#[test]
fn limit_analysis_of_drums_reports_the_onset() {
    let root = tempfile::tempdir().unwrap();
    let limit = |more: &str| -> Value {
        let text = format!("[column]\nheight_m = 6\nwidth_m = 1\n{more}");
        fs::write(root.path().join("s.toml"), text).unwrap();
        let arguments = ["limit", "s.toml", "--format", "json"];
        serde_json::from_str(&program::printed(root.path(), &arguments)).unwrap()
    };
    let pushes_g = |json: &Value| {
        ["right", "left"].map(|side| json["incipient_acceleration_g"][side].as_f64().unwrap())
    };
    // It starts as one block about the base, at width over height.
    let drums = limit("drums = 6\n[free_hinges]\n");
    let sides = [("right", "extrados"), ("left", "intrados")];
    for (push_g, (side, edge)) in pushes_g(&drums).into_iter().zip(sides) {
        assert!((push_g - 1.0 / 6.0).abs() < 1e-9, "{push_g}");
        let mechanism = drums["mechanism"][side].as_array().unwrap();
        assert_eq!(mechanism.len(), 1);
        assert_eq!(mechanism[0]["joint"], 0);
        assert_eq!(mechanism[0]["edge"], edge);
    }
    // A taper: the lever of the centre of gravity of a trapezoid with sides 1 and 0.5 is 6 / 3 * (1 + 2 * 0.5) / 1.5.
    let tapered = limit("drums = 6\ntop_width_m = 0.5\n[free_hinges]\n");
    for push_g in pushes_g(&tapered) {
        assert!((push_g - 0.5 / (2.0 * 2.0 / 1.5)).abs() < 1e-9, "{push_g}");
    }
    let slippery = limit("drums = 6\n[free_hinges]\nfriction_coefficient = 0.1\n");
    for side in ["right", "left"] {
        let push_g = slippery["friction"][side]["incipient_acceleration_g"]
            .as_f64()
            .unwrap();
        assert!((push_g - 0.1).abs() < 1e-6, "{push_g}");
    }
    golden(
        "limit-drums",
        &program::printed(root.path(), &["limit", "s.toml"]),
    );
}

/// A run with free hinges proposes a table for elastic joints. It runs; a scenario that has one gets no other.
#[test]
fn the_proposed_comparison_runs() {
    let column = format!("[column]\n{SHAKEN_COLUMN}");
    let scenario = format!("{column}[free_hinges]\n");
    let own = format!("{scenario}[elastic_joints]\nnormal_stiffness_gpa_m = 20\n");
    let proposed = |scenario: &str, options: &[&str]| {
        let printed = Results::of(scenario, options).said;
        let (_, proposed) = printed.split_once("elastic: compare with ").unwrap();
        proposed.lines().next().unwrap().to_owned()
    };
    let added = proposed(&scenario, &[]);
    let table = added.strip_prefix("elastic joints: ").unwrap();
    let table = table.strip_suffix("`, instead of [free_hinges]").unwrap();
    let table = table.replace(" with `", "\n");
    let compared = Results::of(&format!("{column}{table}\n"), &[]).said;
    // The stiffness is varied, three a decade.
    assert!(compared.contains("with 21.5 GPa/m: "), "{compared}");
    assert_eq!(proposed(&own, &["--hinges", "free"]), "elastic joints");
    // Without a stiffness the error proposes it.
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), &scenario).unwrap();
    let lacking = archrock(root.path(), &["run", "s.toml", "--hinges", "elastic"]);
    let error = stderr(&lacking);
    let option = "--set elastic_joints.normal_stiffness_gpa_m=10";
    assert!(error.contains(option), "{error}");
}
