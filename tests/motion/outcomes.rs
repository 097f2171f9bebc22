//! Outcomes: incomplete histories, vibrating joints, times of rest, and results up to overturning.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use archrock::scenario::Scenario;
use archrock::{Outcome, Sample, Summary};
use serde_json::Value;

use crate::common::program::{archrock, done, printed, refused, stdout};
use crate::common::prose::{golden, shows};
use crate::common::results::{Table, json, summary};

/// An arch under a record that is quiet for `quiet_s` and then has two strong pulses.
fn late(folder: &Path, quiet_s: f64, more: &str) {
    let mut record = "time_s,acceleration_g\n0.0,0.0\n".to_owned();
    for step in 0..=60 {
        let time_s = f64::from(step) * 0.02;
        let push_g = 1.1 * (5.0 * time_s).sin();
        let _ = writeln!(record, "{:.2},{push_g:.6}", quiet_s + time_s);
    }
    let _ = writeln!(record, "{:.2},0.0", quiet_s + 1.22);
    fs::write(folder.join("late.csv"), record).unwrap();
    let text = format!(
        "[arch]\nmean_radius_m = 3.0\nthickness_ratio = 0.15\nembrace_deg = 150\nvoussoirs = 13\n\
         [ground.record]\nfile = \"late.csv\"\nunit = \"g\"\n{more}"
    );
    fs::write(folder.join("s.toml"), text).unwrap();
}

/// A record whose shaking begins after ten seconds: by default the run lasts until after it. A run that is cut off before has no verdict,
/// in any model, and no study counts it.
#[test]
fn a_run_that_ends_before_the_ground_has_no_verdict() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    late(at, 11.0, "");
    let checked = printed(at, &["check", "s.toml"]);
    assert!(
        default_duration(&checked).ends_with(": 23.2800 s"),
        "{checked}"
    );
    printed(at, &["run", "s.toml", "--out", "o"]);
    assert_eq!(summary(&at.join("o"))["verdict"], "overturns");
    let threshold = |more: &[&str]| {
        let fixed = [
            "threshold",
            "s.toml",
            "--out",
            "t",
            "--from",
            "0.3",
            "--to",
            "1.5",
        ];
        let said = printed(at, &[&fixed[..], more].concat());
        (
            said,
            json(&at.join("t/threshold.json"))["models"][0].clone(),
        )
    };
    let (_, whole) = threshold(&[]);
    let (_, longer) = threshold(&["--set", "simulation.duration_s=40"]);
    assert!(whole["lowest_factor"].as_f64().unwrap() < 1.0);
    assert_eq!(whole["lowest_factor"], longer["lowest_factor"]);
    assert!(whole["incomplete"].as_array().unwrap().is_empty());
    for short in ["10", "11.2"] {
        let set = format!("simulation.duration_s={short}");
        for hinges in ["four", "free"] {
            let arguments = [
                "run", "s.toml", "--out", "c", "--set", &set, "--hinges", hinges,
            ];
            let said = printed(at, &arguments);
            assert!(
                !said.contains("never") && !said.contains("survives"),
                "{said}"
            );
            let told = summary(&at.join("c"));
            assert_eq!([&told["verdict"], &told["outcome"]], ["incomplete"; 2]);
        }
        let (said, cut) = threshold(&["--set", &set]);
        assert!(!said.contains("does not overturn"), "{said}");
        assert_eq!(cut["lowest_factor"], Value::Null);
        assert_eq!(cut["incomplete"].as_array().unwrap().len(), 1);
        assert!(warns_of_no_verdict(&at.join("t/threshold.json")));
    }
}

/// The comment of `check` with the default duration of the run.
fn default_duration(checked: &str) -> &str {
    let comment = "# default duration_s of [simulation]";
    let mut lines = checked.lines();
    lines.find(|line| line.starts_with(comment)).unwrap()
}

/// Whether the warnings of a study count histories without a verdict.
fn warns_of_no_verdict(file: &Path) -> bool {
    let file = json(file);
    let mut warnings = file["warnings"].as_array().unwrap().iter();
    warnings.any(|warning| warning.as_str().unwrap().starts_with("no verdict from "))
}

/// The records of a suite last as long as they do; a map counts cells without a verdict as such.
#[test]
fn studies_follow_the_ground_motion_of_each_case() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    late(
        at,
        11.0,
        "[map]\nscale = [0.2, 1.0]\n\"arch.density_kg_m3\" = [2000]\n",
    );
    printed(at, &["map", "s.toml", "--out", "m", "--quiet"]);
    let outcomes = |folder: &str, file: &str| -> Vec<String> {
        let table = Table::read(at.join(folder).join(file));
        table
            .rows
            .iter()
            .map(|row| row["outcome"].clone())
            .collect()
    };
    assert_eq!(outcomes("m", "map.csv"), ["never_moved", "overturned"]);
    assert!(!warns_of_no_verdict(&at.join("m/map.json")));
    let record = "[ground.record]\nfile = \"late.csv\"\nunit = \"g\"\n";
    let text = fs::read_to_string(at.join("s.toml")).unwrap();
    let (structure, _) = text.split_once(record).unwrap();
    let suite = "[suite]\nrecords = [\"late.csv\"]\nunit = \"g\"\nscales = [0.2, 1.0]\nboth_signs = false\n";
    fs::write(at.join("s.toml"), format!("{structure}{suite}")).unwrap();
    printed(at, &["suite", "s.toml", "--out", "u", "--quiet"]);
    assert_eq!(outcomes("u", "suite.csv"), ["never_moved", "overturned"]);
    refused(
        at,
        &["suite", "s.toml", "--set", "simulation.duration_s=10"],
        &[
            "has a record that lasts longer",
            "would be cut off at 10 s: late.csv (",
            "give at least",
        ],
    );
    // The default follows a pulse that a map varies, and the structure.
    let pulses = format!(
        "{structure}[ground.rectangular]\namplitude_g = 0.01\nduration_s = 1.0\n[map]\nduration_s = [1.0, 30.0]\namplitude_g = [0.01]\n"
    );
    fs::write(at.join("s.toml"), pulses).unwrap();
    printed(at, &["map", "s.toml", "--out", "p", "--quiet"]);
    assert_eq!(outcomes("p", "map.csv"), ["never_moved"; 2]);
    // A map counts histories without a verdict in its warnings: here one has not yet lost three quarters of the energy barrier.
    let column = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[free_hinges]\n[ground.rectangular]\namplitude_g = 0.6\nduration_s = 0.2\n\
                  [simulation]\nduration_s = 10.2\n[map]\nduration_s = [0.2]\namplitude_g = [0.1, 0.6]\n";
    fs::write(at.join("k.toml"), column).unwrap();
    let said = done(at, &["map", "k.toml", "--out", "k"]);
    assert!(said.contains("no verdict from 1 of 2 histories"), "{said}");
    assert_eq!(outcomes("k", "map.csv"), ["never_moved", "incomplete"]);
    assert!(warns_of_no_verdict(&at.join("k/map.json")));
    // Bisection passes levels without a verdict, so the first intensity that overturns is an upper bound.
    let pulse = "t,a\n0,1\n0.2,1\n0.201,0\n0.3,0\n";
    fs::write(at.join("pulse.csv"), pulse).unwrap();
    // Without joints the energy decides, and the last intensity that it survives is next to it.
    let column = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[suite]\nrecords = [\"pulse.csv\"]\nunit = \"g\"\npeaks_g = [0.1, 3.0]\n[simulation]\nduration_s = 10.3\n";
    for (joints, at_most, gap) in [
        ("[free_hinges]\n", "yes", 0.05..0.3),
        // The accuracy of the bisection.
        ("", "no", 0.0..0.002),
    ] {
        fs::write(at.join("b.toml"), format!("{column}{joints}")).unwrap();
        let said = done(at, &["suite", "b.toml", "--out", "b"]);
        assert_eq!(
            outcomes("b", "suite.csv")[..2],
            ["never_moved", "overturned"]
        );
        let capacity = &Table::read(at.join("b/capacities.csv")).rows[0];
        let [level_g, survives_g] =
            ["peak_g", "survives_up_to_scale"].map(|name| capacity[name].parse::<f64>().unwrap());
        assert!((0.6..1.5).contains(&level_g), "{level_g}");
        assert_eq!(capacity["at_most"], at_most);
        // The peak of the record is 1 g.
        let relative = 1.0 - survives_g / level_g;
        assert!(gap.contains(&relative), "{joints}{survives_g} {level_g}");
        shows(&said, &[survives_g, level_g]);
    }
    let large = ["check", "s.toml", "--set", "arch.mean_radius_m=98.1"];
    let said = printed(at, &large);
    // 1 s of ground motion, and 20 sqrt(98.1 m / g).
    assert!(default_duration(&said).ends_with(": 64.2456 s"), "{said}");
}

/// A row that still has more than a quarter of the energy barrier has no verdict either; with less it survives. A single block survives with any
/// energy below its barrier.
#[test]
fn the_remaining_energy_decides_the_verdict() {
    let block = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";
    for (model, soon) in [
        ("", Outcome::StillRocking),
        ("[free_hinges]\n", Outcome::Incomplete),
    ] {
        let outcomes = [1e-3, 16.0].map(|end_s| {
            let text = format!(
                "{block}{model}[initial]\nsway = \"right\"\nrotation_rad = 0.17\n[simulation]\nduration_s = {end_s}\noutput_step_s = 1e-3\n"
            );
            simulated(&text).outcome
        });
        assert_eq!(outcomes, [soon, Outcome::StillRocking], "{model}");
    }
}

fn simulated(text: &str) -> Summary {
    let scenario = Scenario::parse(text, "s.toml").unwrap();
    let model = scenario.model().unwrap();
    let summary = model.simulate(scenario.ground_motion(), &scenario.request(), None);
    summary.unwrap()
}

/// By default a history lasts until its outcome is known: a slender row still has more than a quarter of the energy barrier at its default end, and
/// is continued. A given duration is kept. A block without joints survives with any energy below its barrier, and is not continued.
#[test]
fn a_default_duration_is_lengthened_until_there_is_a_verdict() {
    let block = "[column]\nheight_m = 7.0\nwidth_m = 1.2\n";
    let pulse = "[ground.one_sine]\namplitude_g = 0.3\nduration_s = 1.0\n";
    let text = format!("{block}[free_hinges]\n{pulse}");
    let free = simulated(&text);
    let default_s = Scenario::parse(&text, "s.toml").unwrap().request().end_s;
    let given = format!("[simulation]\nduration_s = {default_s:?}\n");
    let cut = simulated(&format!("{text}{given}"));
    assert_eq!((cut.outcome, cut.end_s), (Outcome::Incomplete, default_s));
    assert!(
        matches!(free.outcome, Outcome::Rest | Outcome::StillRocking),
        "{free:?}"
    );
    assert!(free.end_s > default_s, "{free:?}");
    // The longer history continues the shorter one.
    assert_eq!(free.peak_rotations_rad, cut.peak_rotations_rad);
    for given in ["", &given] {
        let rigid = simulated(&format!("{block}{pulse}{given}"));
        assert_eq!(
            (rigid.outcome, rigid.end_s),
            (Outcome::StillRocking, default_s)
        );
        assert!((0.25..1.0).contains(&rigid.remaining_over_barrier().unwrap()));
    }
}

/// On weak ground rigid joints never move, and elastic ones vibrate. A block rocks once a joint opens, by any amount.
#[test]
fn a_structure_without_open_joints_does_not_rock() {
    let arch = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 150\nvoussoirs = 15\n[free_hinges]\n\
                [ground.one_sine]\namplitude_g = 0.1\nduration_s = 3\n";
    assert_eq!(simulated(arch).outcome, Outcome::NeverMoved);
    let cut = simulated(&format!("{arch}[simulation]\nduration_s = 2\n"));
    assert_eq!(cut.outcome, Outcome::Incomplete);
    let column = |amplitude_g: f64| {
        simulated(&format!(
            "[column]\nheight_m = 7.25\nwidth_m = 1.85\n[elastic_joints]\nnormal_stiffness_gpa_m = 1.0\ndamping_time_s = 1e-4\n\
             [ground.half_sine]\namplitude_g = {amplitude_g:?}\nduration_s = 0.274\n[simulation]\nduration_s = 3.0\n"
        ))
    };
    assert_eq!(column(0.0).outcome, Outcome::NeverMoved);
    assert_eq!(column(0.03).outcome, Outcome::Vibrates);
    let rocks = column(0.2831);
    assert!(rocks.largest_rotation_rad() > 4e-3);
    let rests = matches!(rocks.outcome, Outcome::Rest | Outcome::StillRocking);
    assert!(rests && rocks.outcome_time_s > 0.3, "{rocks:?}");
    // A block that barely lifts off rotates and does not slide.
    let folder = tempfile::tempdir().unwrap();
    let block = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[free_hinges]\n[ground.rectangular]\namplitude_g = 0.20000001\nduration_s = 0.3\n";
    fs::write(folder.path().join("s.toml"), block).unwrap();
    let said = printed(folder.path(), &["run", "s.toml", "--out", "o"]);
    assert!(!said.contains("slides"), "{said}");
    let (_, ground) = said.split_once("the ground reaches ").unwrap();
    shows(ground, &[0.2, 1.0]);
}

/// A row comes to rest when it stops, not when the ground does.
#[test]
fn the_time_of_rest_is_that_of_the_motion() {
    let folder = tempfile::tempdir().unwrap();
    let mut record = "time_s,acceleration_g\n0.0,0.0\n".to_owned();
    for step in 1..=20 {
        let push_g = 0.25 * (std::f64::consts::TAU * f64::from(step) / 20.0).sin();
        let _ = writeln!(record, "{:.2},{push_g:.6}", f64::from(step) * 0.02);
    }
    record += "39.0,0.01\n40.0,0.0\n";
    fs::write(folder.path().join("r.csv"), record).unwrap();
    for model in ["four", "free"] {
        let text = "[column]\nheight_m = 2.0\nwidth_m = 0.8\n[ground.record]\nfile = \"r.csv\"\nunit = \"g\"\nscale = 3.0\n";
        fs::write(folder.path().join("s.toml"), text).unwrap();
        let arguments = ["run", "s.toml", "--out", "o", "--hinges", model];
        let said = printed(folder.path(), &arguments);
        let told = summary(&folder.path().join("o"));
        assert_eq!(told["outcome"], "rest", "{said}");
        let time_s = told["outcome_time_s"].as_f64().unwrap();
        assert!((0.4..30.0).contains(&time_s), "{model}: {said}");
    }
}

/// What happens while it falls is no part of the results of a structure that overturns.
#[test]
fn results_end_at_overturning() {
    let block = "[column]\nheight_m = 1.0\nwidth_m = 1.0\npedestal = true\n[free_hinges]\nfriction_coefficient = 0.2\n\
                 [ground.rectangular]\namplitude_g = 1.5\nduration_s = 0.8\n[simulation]\nduration_s = 12.0\n";
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), block).unwrap();
    let said = printed(folder.path(), &["run", "s.toml", "--out", "o"]);
    let told = summary(&folder.path().join("o"));
    assert_eq!(told["overturning_sway"], "left");
    assert_eq!(told["impacts"], 0);
    golden("run-overturned-without-impact", &said);
    // A block that a pulse overturns at once passes its critical rotation, and the largest rotation is no other.
    let critical_rad = (0.8_f64 / 4.0).atan();
    let elastic = "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n";
    for model in [
        "",
        "[free_hinges]\n",
        "[free_hinges]\nfriction_coefficient = 2.0\n",
        elastic,
    ] {
        let text = format!(
            "[column]\nheight_m = 4.0\nwidth_m = 0.8\n{model}[ground.half_sine]\namplitude_g = 0.8\nduration_s = 0.6\n"
        );
        let summary = simulated(&text);
        let peak = summary.largest_rotation_rad() / critical_rad;
        assert!(matches!(summary.outcome, Outcome::Overturned(_)));
        assert!((0.5..1.1).contains(&peak), "{model}: {peak}");
    }
}

/// A scenario is written without a `duration_s` that was not given; `check` prints the time as a comment, and writes it in JSON.
#[test]
fn a_default_duration_is_not_written_to_toml() {
    let folder = tempfile::tempdir().unwrap();
    late(folder.path(), 2.0, "");
    let scenario = Scenario::read(&folder.path().join("s.toml")).unwrap();
    assert!(!scenario.to_toml().contains("duration_s"));
    let slower = scenario
        .with_values(&[("ground.record.start_s", 50.0)])
        .unwrap();
    assert!((slower.request().end_s - scenario.request().end_s - 50.0).abs() < 1e-9);
    let end_s = scenario.request().end_s;
    let text = stdout(&archrock(folder.path(), &["check", "s.toml"]));
    let comment = default_duration(&text);
    assert!(comment.ends_with(&format!(": {end_s:.4} s")), "{comment}");
    let name = folder.path().join("t.toml");
    let resolved = Scenario::parse(&text, &name.to_string_lossy()).unwrap();
    assert_eq!(resolved.simulation.duration_s, None);
    assert_eq!(resolved.request().end_s, end_s);
    let checked = archrock(folder.path(), &["check", "s.toml", "--format", "json"]);
    let checked: Value = serde_json::from_str(&stdout(&checked)).unwrap();
    // To the nanosecond.
    let written_s = checked["simulation"]["duration_s"].as_f64().unwrap();
    assert!((written_s - end_s).abs() < 1e-9);
}

/// A block before a lower wall that a pulse of 0.6 g leaves with more than a quarter of the energy barrier for long.
const ROCKING_LONG: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[column.back]\nside = \"right\"\nheight_m = 3.0\nrestitution = 0.9999\n";

/// A threshold along a range has no value where a history has no verdict, and warns of it.
#[test]
fn a_threshold_along_a_range_needs_verdicts() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let text = format!("{ROCKING_LONG}[ground.rectangular]\namplitude_g = 1.0\nduration_s = 0.2\n");
    fs::write(at.join("s.toml"), text).unwrap();
    let along = "column.width_m=0.8..0.9:2";
    let said = printed(at, &["threshold", "s.toml", "--along", along, "--out", "o"]);
    let row = &Table::read(at.join("o/threshold_along.csv")).rows[0];
    assert_eq!(
        (&*row["overturns_from_factor"], &*row["why_not"]),
        ("", "incomplete")
    );
    let summary = at.join("o/threshold_along.json");
    assert_eq!(json(&summary).get("failures"), None);
    assert!(
        warns_of_no_verdict(&summary) && !said.contains("failed"),
        "{said}"
    );
}

/// Samples without a verdict are no failures: they are counted and warned of, and no share contains them.
#[test]
fn samples_without_a_verdict_are_counted_apart() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let text = format!(
        "{ROCKING_LONG}[ground.rectangular]\namplitude_g = 0.4\nduration_s = 0.2\n\
         [map]\nduration_s = [0.2]\namplitude_g = [0.1, 0.6]\n\
         [uncertain]\nsamples = 8\n\"ground.rectangular.amplitude_g\" = {{ from = 0.05, to = 0.75 }}\n"
    );
    fs::write(at.join("s.toml"), text).unwrap();
    let count = |told: &Value, name: &str| told[name].as_u64().unwrap();
    let said = printed(at, &["run", "s.toml", "--out", "r", "--no-report"]);
    let file = at.join("r/uncertain/uncertain.json");
    let told = json(&file);
    let incomplete = count(&told, "incomplete");
    assert!((1..8).contains(&incomplete) && count(&told, "failed") == 0);
    assert_eq!(count(&told, "answered") + incomplete, 8);
    assert!(warns_of_no_verdict(&file));
    let counted = format!(", and {incomplete} samples without a verdict");
    assert!(said.contains(&counted), "{said}");
    assert!(!said.contains("could not be computed"), "{said}");
    let threshold = ["threshold", "s.toml", "--out", "t", "--to", "3"];
    let said = printed(at, &threshold);
    let told = json(&at.join("t/uncertain_threshold/uncertain.json"));
    assert!(
        count(&told, "incomplete") > 0 && count(&told, "failed") == 0,
        "{said}"
    );
    // The amplitude of a map cannot be uncertain as well.
    let width = ["map", "s.toml", "--out", "m", "--set"];
    let text = fs::read_to_string(at.join("s.toml")).unwrap();
    let (kept, _) = text.split_once("\"ground.").unwrap();
    let text = format!("{kept}\"column.width_m\" = {{ from = 0.79, to = 0.81 }}\n");
    fs::write(at.join("s.toml"), text).unwrap();
    let said = done(at, &width[..4]);
    let file = at.join("m/uncertain_map/uncertain.json");
    let left_out = json(&file)["histories_without_outcome"].clone();
    assert_eq!(
        [count(&left_out, "incomplete"), count(&left_out, "failed")],
        [8, 0]
    );
    assert!(warns_of_no_verdict(&file), "{said}");
    let row = &Table::read(at.join("m/uncertain_map/map.csv")).rows[1];
    assert_eq!(
        ["samples", "incomplete", "failed"].map(|name| row[name].as_str()),
        ["0", "8", "0"]
    );
}

/// The ratio of the ground to the push that starts the structure is that of the side to which it pushes, as in the words.
#[test]
fn the_governing_side_is_compared_with_its_onset() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 150\nvoussoirs = 20\n\
                [[load]]\nmass_kg = 3000.0\nx_m = -2.0\n\
                [ground.half_sine]\namplitude_g = 0.6\nduration_s = 0.2\n";
    for (push_g, side) in [(0.6, "left"), (-0.6, "right")] {
        fs::write(at.join("s.toml"), text.replace("0.6", &push_g.to_string())).unwrap();
        let said = printed(
            at,
            &[
                "run",
                "s.toml",
                "--out",
                "o",
                "--no-report",
                "--dimensionless",
            ],
        );
        let told = summary(&at.join("o"));
        let starts_g =
            ["right", "left"].map(|side| told["incipient_acceleration_g"][side].as_f64().unwrap());
        assert!((starts_g[0] / starts_g[1] - 1.0).abs() > 0.05);
        let ratio = 0.6 / told["incipient_acceleration_g"][side].as_f64().unwrap();
        let own = &told["dimensionless"]["peak_acceleration_over_incipient"];
        assert!(
            (own.as_f64().unwrap() / ratio - 1.0).abs() < 1e-9,
            "{side}: {own} {ratio}"
        );
        shows(&said, &[ratio]);
        let column = Table::read(at.join("o/rotations.csv")).numbers("acceleration_over_incipient");
        let largest = column.into_iter().map(f64::abs).fold(0.0, f64::max);
        assert!((largest / ratio - 1.0).abs() < 1e-3);
    }
}

/// Slips and tie forces of the fall are no part of the largest ones.
#[test]
fn the_largest_slips_and_tie_forces_are_those_before_it_overturns() {
    let block = "[column]\nheight_m = 4.0\nwidth_m = 0.8\npedestal = true\n";
    let tie = "[[tie]]\nfrom_m = [-0.4, 3.5]\nto_m = [-3.4, 3.5]\nto_block = 0\nstiffness_n_m = 2e3\nprestress_n = 5000.0\n";
    let slides = "[column]\nheight_m = 1.0\nwidth_m = 1.0\npedestal = true\n[free_hinges]\nfriction_coefficient = 0.2\n\
                  [ground.rectangular]\namplitude_g = 1.5\nduration_s = 0.8\n";
    let ground = "[ground.half_sine]\namplitude_g = -1.2\nduration_s = 0.9\n";
    let tied = |model: &str| format!("{block}{tie}{model}{ground}");
    let mut grows = 0;
    for text in [
        slides.to_owned(),
        tied("[free_hinges]\n"),
        tied("[free_hinges]\nfriction_coefficient = 0.6\n"),
        tied("[elastic_joints]\nnormal_stiffness_gpa_m = 1.0\nfriction_coefficient = 0.6\n"),
    ] {
        let scenario = Scenario::parse(&text, "s.toml").unwrap();
        let model = scenario.model().unwrap();
        let history = model
            .history(scenario.ground_motion(), &scenario.request())
            .unwrap();
        let (summary, row) = (&history.summary, history.summary.row().unwrap());
        assert!(matches!(summary.outcome, Outcome::Overturned(_)), "{text}");
        let largest = |of: &dyn Fn(&Sample) -> f64, until_s: f64| {
            let before = history
                .samples
                .iter()
                .filter(|sample| sample.time_s <= until_s);
            before.map(|sample| of(&sample)).fold(0.0, f64::max)
        };
        let mut assert_is_before_the_fall = |reported: f64, of: &dyn Fn(&Sample) -> f64| {
            let [before, whole] =
                [summary.outcome_time_s, f64::INFINITY].map(|end_s| largest(of, end_s));
            grows += usize::from(whole > 1.05 * before);
            assert!(
                (reported / before - 1.0).abs() < 0.02,
                "{text}{reported} {before}"
            );
        };
        if let [tie] = &row.ties[..] {
            assert!(tie.peak_force_time_s <= summary.outcome_time_s);
            assert_is_before_the_fall(tie.peak_force_n, &|sample| sample.ties[0].force_n);
        } else {
            let slip_m = row.sliding.as_ref().unwrap().largest_offsets_m[0];
            assert_is_before_the_fall(slip_m, &|sample| sample.offsets_m[0].abs());
        }
    }
    assert!(grows >= 3, "{grows}");
}
