//! Scenario files: their contents, errors with places, and scenarios written back as text.

use std::ops::ControlFlow;

use crate::common::schema::violations;
use crate::common::{ARCH, COLUMN};
use archrock::dynamics::{Directions, RowOptions};
use archrock::output::Figure;
use archrock::scenario::{
    FREE_HINGES, Ground, Quantity, Scenario, ScenarioErrors, Simulation, Source, Structure,
    TextPosition, shown, shown_lines,
};
use archrock::studies::run::{self, RunOptions, Sinks};
use archrock::{Arch, Column, GroundMotion, ImpactModel, Pulse, Sway};
use proptest::prelude::*;
use serde_json::json;

fn parse(text: &str) -> Result<Scenario, ScenarioErrors> {
    Scenario::parse(text, "s.toml")
}

/// Asserts that the text has these errors and no other: line, column and words of the message.
#[track_caller]
fn assert_errors(text: &str, expected: &[(usize, usize, &[&str])]) {
    let errors = parse(text).expect_err("the text is faulty");
    assert_eq!(errors.0.len(), expected.len(), "{errors}");
    for (error, &(line, column, words)) in errors.0.iter().zip(expected) {
        assert_eq!(error.place, Some(TextPosition { line, column }), "{error}");
        for word in words {
            assert!(error.message.contains(word), "{word:?} is not in: {error}");
        }
    }
}

/// Asserts the error of lines that follow a valid `[arch]`; its line is counted from 1.
#[track_caller]
fn assert_error_after_arch(lines: &str, (line, column): (usize, usize), words: &[&str]) {
    let before = ARCH.lines().count();
    assert_errors(&format!("{ARCH}{lines}"), &[(before + line, column, words)]);
}

/// The defaults of Python's keyword arguments are those of a scenario.
#[test]
fn python_has_the_same_defaults() {
    let scenario = parse(ARCH).unwrap();
    let mut settings = scenario.to_json()["simulation"].clone();
    settings["impact"] = json!(ImpactModel::MaxRestitution.name());
    settings["model"] = scenario.model_name().into();
    let ground = Scenario::schema()["properties"]["ground"]["properties"].clone();
    let mut trains = json!({});
    for kind in ["gabor", "windowed_sine"] {
        for (key, schema) in ground[kind]["properties"].as_object().unwrap() {
            if let Some(default) = schema.get("default") {
                trains[key] = default.clone();
            }
        }
    }
    let package = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("python/package/archrock");
    for (name, defaults) in [
        ("_settings.py", &settings),
        ("_scenario.py", &settings),
        ("_ground.py", &trains),
    ] {
        let source = std::fs::read_to_string(package.join(name)).unwrap();
        for (key, default) in defaults.as_object().unwrap() {
            let keyword = format!("{key}: ");
            let lines = source.lines().map(str::trim_start);
            let given = lines.filter_map(|line| line.strip_prefix(&keyword)?.split_once(" = "));
            let given = given.map(|(_, value)| value.trim_end_matches(','));
            let given: Vec<_> = given.filter(|value| *value != "None").collect();
            assert!(!given.is_empty(), "{key} in {name}");
            let default = default.to_string();
            assert!(
                given.iter().all(|value| *value == default),
                "{key} in {name}"
            );
        }
    }
}

#[test]
fn defaults() {
    let scenario = parse(ARCH).unwrap();
    let Structure::Arch(arch) = &scenario.structure else {
        panic!("an arch")
    };
    assert_eq!(
        [arch.mean_radius_m, arch.thickness_ratio, arch.embrace_deg],
        [5.0, 0.15, 180.0]
    );
    assert_eq!([arch.depth_m, arch.density_kg_m3], [1.0, 2000.0]);
    assert_eq!(arch.voussoirs, None);
    assert_eq!(
        scenario.simulation,
        Simulation {
            duration_s: None,
            output_step_s: 0.005,
            relative_tolerance: 1e-9,
            rest_energy_ratio: 1e-8,
            gravity_m_s2: 9.81,
            direction: Directions::Both,
        }
    );
    assert_eq!(scenario.motion.impact(), ImpactModel::MaxRestitution.into());
    assert!(scenario.title.is_none() && scenario.ground.is_none() && scenario.initial.is_none());
    assert!(!scenario.motion.kind.has_joints && scenario.map.is_none() && scenario.suite.is_none());
    assert_eq!(scenario.ground_motion(), &GroundMotion::still());

    let scenario = parse(&format!("{COLUMN}[free_hinges]\n")).unwrap();
    assert_eq!(scenario.motion.kind, &FREE_HINGES);
    assert_eq!(scenario.to_json()["free_hinges"], json!({}));
    let Structure::Column(column) = &scenario.structure else {
        panic!("a column")
    };
    assert_eq!(
        [column.height_m, column.width_m, column.top_width_m()],
        [4.0, 0.8, 0.8]
    );
    assert_eq!(column.drum_heights_m(), [4.0]);
    assert_eq!([column.depth_m, column.density_kg_m3], [1.0, 2000.0]);
    let none = RowOptions {
        longest_step_s: None,
        shortest_step_s: None,
        friction_coefficient: None,
    };
    assert_eq!(RowOptions::default(), none);
}

/// Every key of a row of blocks is read, and written back.
#[test]
fn every_key_of_a_row() {
    let scenario = parse(
        "[free_hinges]\nlongest_step_s = 3e-4\nshortest_step_s = 0.00001\n\
         [column]\nheight_m = 2\nwidth_m = 0.8\ndrum_heights_m = [0.8, 0.8, 0.4]\ntop_width_m = 0.6\n\
         depth_m = 0.5\ndensity_kg_m3 = 2400\n",
    )
    .unwrap();
    let steps = json!({ "longest_step_s": 3e-4, "shortest_step_s": 1e-5 });
    assert_eq!(scenario.to_json()["free_hinges"], steps);
    let column = Column::new(2.0, 0.8)
        .and_then(|column| column.with_drum_heights_m(vec![0.8, 0.8, 0.4]))
        .and_then(|column| column.with_top_width_m(0.6))
        .and_then(|column| column.with_depth_m(0.5))
        .and_then(|column| column.with_density_kg_m3(2400.0))
        .unwrap();
    assert_eq!(scenario.structure, Structure::Column(column));
    let text = scenario.to_toml();
    for lines in [
        "[free_hinges]\nlongest_step_s = 0.0003\nshortest_step_s = 1e-5\n",
        "[column]\nheight_m = 2.0\nwidth_m = 0.8\ndepth_m = 0.5\ndensity_kg_m3 = 2400.0\n\
         drum_heights_m = [0.8, 0.8, 0.4]\ntop_width_m = 0.6\n",
    ] {
        assert!(text.contains(lines), "{lines}\nis not in:\n{text}");
    }
    assert!(!text.contains("[impact]"), "{text}");
    assert_eq!(parse(&text), Ok(scenario));
}

/// A row is released in its first mechanism: drums turn about the base; a row that does not start as four links has none.
#[test]
fn releases_of_rows() {
    let released = |before: &str, rotation: &str| {
        parse(&format!(
            "{before}[free_hinges]\n[initial]\nsway = 'left'\nrotation_rad = {rotation}\n"
        ))
    };
    let drums = format!("{COLUMN}drums = 3\n");
    assert_eq!(
        released(&drums, "1.57")
            .unwrap()
            .initial
            .unwrap()
            .rotation_rad,
        1.57
    );
    let flat = released(&drums, "1.571")
        .expect_err("lies on its side")
        .to_string();
    assert!(flat.ends_with("must be below 1.57079"), "{flat}");
    let seven = format!("{ARCH}voussoirs = 7\n");
    assert!(released(&seven, "0.02").is_ok());
    let far = released(&seven, "0.9")
        .expect_err("beyond the limit")
        .to_string();
    assert!(
        far.starts_with("s.toml:9:16: `rotation_rad = 0.9` is beyond the limit"),
        "{far}"
    );
    let thick = seven.replace("0.15", "0.6").replace("180.0", "60.0");
    assert!(parse(&format!("{thick}[free_hinges]\n")).is_ok());
    let none = released(&thick, "1e-9")
        .expect_err("no mechanism")
        .to_string();
    assert!(
        none.starts_with("s.toml:7:1: [initial] releases from the first mechanism"),
        "{none}"
    );
    assert!(none.ends_with("leave [initial] out"), "{none}");
}

/// Every key of a history is read, and written back.
#[test]
fn every_key() {
    let scenario = parse(
        r#"
        title = "all of it"
        arch = { mean_radius_m = 10, thickness_m = 1.5, embrace_deg = 157.5, depth_m = 2, density_kg_m3 = 0x7d0, voussoirs = 7 }
        [ground.mavroeidis_papageorgiou]
        amplitude_g = -1_000
        duration_s = 0.5
        start_s = 1
        gamma = 3
        phase_deg = 90
        [impact]
        model = "prescribed"
        restitution = 1
        [initial]
        sway = "left"
        rotation_rad = 0.02
        [simulation]
        duration_s = 20
        output_step_s = 20
        relative_tolerance = 1e-6
        rest_energy_ratio = 0.1
        gravity_m_s2 = 1.62
        [map]
        duration_s = { from = 0.1, to = 1, count = 3 }
        amplitude_g = [1, 2]
        "#,
    )
    .unwrap();
    assert_eq!(
        scenario.to_toml(),
        r#"title = "all of it"

[arch]
mean_radius_m = 10.0
thickness_m = 1.5
embrace_deg = 157.5
depth_m = 2.0
density_kg_m3 = 2000.0
voussoirs = 7

[ground.mavroeidis_papageorgiou]
amplitude_g = -1000.0
vertical_amplitude_g = 0.0
duration_s = 0.5
start_s = 1.0
gamma = 3.0
phase_deg = 90.0

[impact]
model = "prescribed"
restitution = 1.0

[initial]
sway = "left"
rotation_rad = 0.02

[simulation]
duration_s = 20.0
output_step_s = 20.0
relative_tolerance = 1e-6
rest_energy_ratio = 0.1
gravity_m_s2 = 1.62
direction = "both"

[map]
duration_s = { from = 0.1, to = 1.0, count = 3, spacing = "linear" }
amplitude_g = [1.0, 2.0]
"#
    );
    // The resolved scenario is written, not only the given keys.
    assert_eq!(scenario.title.as_deref(), Some("all of it"));
    let arch = Arch::new(10.0, 0.15, 157.5)
        .and_then(|arch| arch.with_depth_m(2.0))
        .and_then(|arch| arch.with_density_kg_m3(2000.0))
        .and_then(|arch| arch.with_voussoirs(7))
        .unwrap();
    assert_eq!(scenario.structure, Structure::Arch(arch));
    let pulse = json!({
        "amplitude_g": -1000.0,
        "vertical_amplitude_g": 0.0,
        "duration_s": 0.5,
        "start_s": 1.0,
        "gamma": 3.0,
        "phase_deg": 90.0,
    });
    let ground = scenario.ground.as_ref().unwrap();
    let kind = Pulse::MavroeidisPapageorgiou.name();
    assert_eq!(scenario.to_json()["ground"], json!({ kind: pulse }));
    for gravity_m_s2 in [f64::NAN, 0.0, 1e300] {
        let error = ground.ground_motion(gravity_m_s2).unwrap_err();
        assert_eq!(error.argument, "gravity_m_s2");
    }
    let simulation = Simulation {
        duration_s: Some(20.0),
        output_step_s: 20.0,
        relative_tolerance: 1e-6,
        rest_energy_ratio: 0.1,
        gravity_m_s2: 1.62,
        direction: Directions::Both,
    };
    assert_eq!(scenario.simulation, simulation);
    let map = scenario.map.as_ref().unwrap();
    let axes = [&map.x, &map.y].map(|axis| (axis.quantity, axis.sequence.values()));
    assert_eq!(axes[0], (Quantity::Duration, vec![0.1, 0.55, 1.0]));
    assert_eq!(axes[1], (Quantity::Amplitude, vec![1.0, 2.0]));
    assert!(!map.repeat);
    assert_eq!(
        scenario.motion.impact(),
        ImpactModel::Prescribed { restitution: 1.0 }.into()
    );
    let initial = scenario.initial.unwrap();
    assert_eq!((initial.sway, initial.rotation_rad), (Sway::Left, 0.02));
}

/// If nothing moves the structure, the error names the missing tables and the command that may be meant.
#[test]
fn a_run_needs_something_that_moves() {
    let says = |more: &str| parse(&format!("{ARCH}{more}")).unwrap().check_for_run();
    let nothing = says("").unwrap_err();
    assert_eq!(
        nothing,
        "nothing moves the structure: give a table [ground.<kind>], such as [ground.rectangular], or [initial]"
    );
    // The study refuses it, for whoever computes it.
    let scenarios = [parse(ARCH).unwrap()];
    let watch = &mut |_| ControlFlow::Continue(());
    let options = RunOptions::default();
    let refused = run::results(
        &scenarios,
        &options,
        Figure::SCREEN,
        Sinks::default(),
        watch,
    );
    assert_eq!(refused.unwrap_err().to_string(), nothing);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.csv"), "0,1\n1,0\n").unwrap();
    let path = folder.path().join("s.toml");
    let suite = "[suite]\nrecords = 'a.csv'\nunit = 'g'\nscales = [1]\n";
    std::fs::write(&path, format!("{ARCH}{suite}")).unwrap();
    let of_suite = Scenario::read(&path).unwrap().check_for_run().unwrap_err();
    assert!(of_suite.ends_with("the records of [suite] are run by `archrock suite SCENARIO`"));
    assert_eq!(
        says("[ground.ricker]\namplitude_g = 0\nduration_s = 1"),
        Ok(())
    );
    assert_eq!(
        says("[initial]\nsway = 'left'\nrotation_rad = 0.01"),
        Ok(())
    );
}

#[test]
fn an_empty_scenario_lists_what_is_missing() {
    for text in ["", "\n \n# nothing\n"] {
        assert_errors(text, &[(1, 1, &["needs exactly one of", "arch, column"])]);
    }
}

#[test]
fn all_errors_are_reported_in_the_order_of_the_file() {
    let text = r#"
title = 3
[simulation]
gravity_m_s2 = 0
duration_s = 1.0
output_step_s = 2.0
[impact]
model = "miror"
[arch]
mean_radius = 5.0
embrace_deg 180
thickness_ratio = "thin"
[ground.half_sine]
amplitude_g = 0.3
[ground.ricker]
amplitude_g = nan
duration_s = 1.0
"#;
    assert_errors(
        text,
        &[
            (2, 9, &["`title = 3`", "a whole number", "a string"]),
            (4, 16, &["`gravity_m_s2 = 0`", "from 0.001 to 1000"]),
            (
                6,
                17,
                &["`output_step_s = 2.0`", "longer than the run of 1 s"],
            ),
            (
                8,
                9,
                &["`model = \"miror\"`", "mirrored", "max_restitution"],
            ),
            (9, 1, &["[arch] lacks `mean_radius_m`", "from 0.001 to 1e6"]),
            (10, 1, &["`mean_radius`", "did you mean `mean_radius_m`?"]),
            (11, 13, &["embrace_deg 180", "expected `=`"]),
            (
                12,
                19,
                &["`thickness_ratio = \"thin\"` is a string", "below 2"],
            ),
            (
                13,
                1,
                &["[ground.half_sine] lacks `duration_s`", "from 1e-6"],
            ),
            (
                15,
                1,
                &[
                    "`ricker` cannot be combined with `half_sine`",
                    "exactly one",
                ],
            ),
            (16, 15, &["`amplitude_g = nan` is not finite", "to 1000"]),
        ],
    );
}

#[test]
fn errors_display_as_file_line_column_message() {
    let errors = parse(&format!("titel = 'é'\n{ARCH}voussoirs = 2\n")).expect_err("two errors");
    assert_eq!(
        errors.to_string(),
        "s.toml:1:1: unknown key `titel` in the scenario (did you mean `title`?); known keys: \
         title, free_hinges, elastic_joints, supports, simulation, piers, fill, vehicle, load, tie, arch, column, body, pointed_arch, \
         elliptic_arch, basket_arch, blocks, ground, impact, initial, map, suite, verify, demand, uncertain\n\
         s.toml:6:13: `voussoirs = 2` is out of range; must be a whole number from 3 (four \
         hinges need four joints) to 200"
    );
}

#[test]
fn columns_count_characters() {
    assert_errors(
        &format!("initial = {{ sway = 'é', rotation_rad = 9 }}\r\n{ARCH}"),
        &[
            (1, 20, &["`sway = 'é'` is unknown", "\"right\", \"left\""]),
            (1, 40, &["`rotation_rad = 9`", "below 3.14159"]),
        ],
    );
}

#[test]
fn structures() {
    let beside: &[&str] = &["`column` cannot be combined with `arch`", "exactly one"];
    assert_errors(&format!("{ARCH}{COLUMN}"), &[(5, 1, beside)]);
    assert_errors(
        "arch = 5",
        &[(1, 8, &["`arch = 5`", "a whole number", "a table"])],
    );
    assert_errors("[[arch]]\n", &[(1, 1, &["an array", "a table"])]);
}

#[test]
fn columns() {
    let scenario = parse(COLUMN).unwrap();
    let expected = Column::new(4.0, 0.8).unwrap();
    assert_eq!(scenario.structure, Structure::Column(expected));
    assert_errors(
        "[column]\nheight = 4\nwidth_m = -0.8\nmean_radius_m = 5\n",
        &[
            (1, 1, &["[column] lacks `height_m`", "from 0.001"]),
            (2, 1, &["`height` in [column] (did you mean `height_m`?"]),
            (3, 11, &["`width_m = -0.8` is out of range", "to 1e6"]),
            (4, 1, &["`mean_radius_m` in [column]", "height_m, width_m"]),
        ],
    );
    let released = |rotation: &str| {
        parse(&format!(
            "{COLUMN}[initial]\nsway = 'left'\nrotation_rad = {rotation}"
        ))
    };
    assert!(released("1.57").is_ok());
    let flat = released("1.571").expect_err("lies on its side");
    let words = "s.toml:6:16: `rotation_rad = 1.571` is beyond the limit position";
    assert!(flat.to_string().starts_with(words), "{flat}");
    assert!(flat.to_string().ends_with("below 1.57079"), "{flat}");
}

#[test]
fn thickness() {
    let arch =
        |thickness: &str| format!("[arch]\nmean_radius_m = 5\nembrace_deg = 180\n{thickness}");
    let one = "exactly one of the keys thickness_ratio, thickness_m";
    assert_errors(&arch(""), &[(1, 1, &["[arch] needs", one])]);
    assert_errors(
        &arch("thickness_m = 0.75\nthickness_ratio = 0.15"),
        &[(
            5,
            19,
            &[
                "`thickness_ratio` cannot be combined with `thickness_m`",
                one,
            ],
        )],
    );
    assert_errors(
        &arch("thickness_m = 10"),
        &[(
            4,
            15,
            &["`thickness_m = 10`", "2 mean radii of 5 m", "below twice"],
        )],
    );
    assert_errors(
        &arch("thickness_ratio = 0.0"),
        &[(
            4,
            19,
            &["`thickness_ratio = 0.0`", "at least 1e-6 and below 2"],
        )],
    );
}

#[test]
fn numbers() {
    for (value, words) in [
        ("0", "`depth_m = 0` is out of range"),
        ("+inf", "`depth_m = +inf` is not finite"),
        ("1e999", "`depth_m = 1e999` is not finite"),
        (
            "99999999999999999999999999999999999999999",
            "is out of range",
        ),
        ("true", "`depth_m = true` is a boolean"),
        ("1979-05-27", "is a date or time"),
        ("[1, 2]", "`depth_m = [1, 2]` is an array"),
    ] {
        assert_error_after_arch(&format!("depth_m = {value}"), (1, 11), &[words]);
    }
    for value in ["7.0", "-7", "201", "99999999999999999999999"] {
        assert_error_after_arch(&format!("voussoirs = {value}"), (1, 13), &[value, "to 200"]);
    }
}

#[test]
fn grounds() {
    for kind in Pulse::ALL {
        let name = kind.name();
        let text = format!("{ARCH}[ground.{name}]\namplitude_g = 1\nduration_s = 1");
        let ground = parse(&text).unwrap().ground.clone().unwrap();
        let Ground::Pulse(ground) = ground else {
            panic!("{name} is a pulse")
        };
        assert_eq!(ground.kind, *kind);
    }
    assert_error_after_arch(
        "[ground]",
        (1, 1),
        &["[ground] needs exactly one", "ricker"],
    );
    assert_errors(
        &format!("{ARCH}[ground.halfsine]"),
        &[
            (5, 2, &["[ground] needs exactly one"]),
            (
                5,
                9,
                &[
                    "`halfsine` in [ground] (did you mean `half_sine`?)",
                    "record",
                ],
            ),
        ],
    );
}

#[test]
fn restitutions() {
    let other = "[impact]\nrestitution = 0.8";
    assert_error_after_arch(other, (2, 15), &["prescribed", "\"max_restitution\""]);
    let none = "[impact]\nmodel = 'prescribed'";
    assert_error_after_arch(
        none,
        (1, 1),
        &["[impact] lacks `restitution`", "from 0 to 1"],
    );
    let high = "[impact]\nmodel = 'prescribed'\nrestitution = 1.5";
    assert_error_after_arch(high, (3, 15), &["`restitution = 1.5`", "from 0 to 1"]);
}

#[test]
fn output_steps_point_at_the_key_that_is_given() {
    let short = "[simulation]\nduration_s = 0.001";
    assert_error_after_arch(short, (2, 14), &["`duration_s = 0.001`", "step of 0.005 s"]);
    let long = "[simulation]\nduration_s = 1e5";
    assert_error_after_arch(long, (2, 14), &["20000000 rows", "at most 10000000"]);
    let fine = "[simulation]\noutput_step_s = 2e-6\nduration_s = 100";
    assert_error_after_arch(fine, (2, 17), &["50000000 rows"]);
}

#[test]
fn syntax_errors_neither_hide_nor_cause_other_errors() {
    // A key on a faulty line is not missing, and the default does not replace it.
    assert_error_after_arch(
        "[simulation]\nduration_s = 60 s\noutput_step_s = 20",
        (2, 14),
        &["`duration_s = 60 s`"],
    );
    assert_errors(&ARCH.replace("0.15", "0,15"), &[(3, 20, &["0,15"])]);
    // Keys under a faulty header do not belong to the table before.
    assert_error_after_arch("[initial\nsway = 'right'\n", (1, 9), &["expected `]`"]);
    let twice = format!("{ARCH}[impact]\n{ARCH}title = 1");
    assert_errors(&twice, &[(6, 2, &["duplicate key"])]);
    assert_errors(
        &format!("title = \"\"\"\n{ARCH}"),
        &[(6, 1, &["multi-line"])],
    );
}

#[test]
fn overlong_keys_are_cut_and_escaped_in_messages() {
    let errors = parse(&format!("\"\\u001b[2J{}\" = 1", "x".repeat(500))).expect_err("unknown");
    assert!(errors.to_string().lines().all(|line| line.len() < 340));
    assert!(!errors.to_string().contains('\u{1b}'));
}

#[test]
fn hostile_nesting_does_not_overflow_the_stack() {
    let dotted = format!("{}a = 1", "a.".repeat(79));
    let inline = format!(
        "a = {}1{}",
        format!("{{{}a=", "a.".repeat(79)).repeat(79),
        "}".repeat(79)
    );
    for text in [
        "[".repeat(100_000),
        format!("a = {}", "[".repeat(100_000)),
        format!("a = {}{}", "[".repeat(100_000), "]".repeat(100_000)),
        format!("a = {}", "{a=".repeat(100_000)),
        format!("{}a = 1", "a.".repeat(100_000)),
        format!("[{}a]", "a.".repeat(100_000)),
        "[[a]]\n".repeat(100_000),
        "a\n".repeat(100_000),
        dotted,
        inline,
    ] {
        let errors = parse(&text).expect_err("hostile");
        assert!(errors.0.len() <= 40);
    }
}

#[test]
fn many_errors_take_linear_time() {
    // Quadratic work would take 1e11 steps here.
    let keys: Vec<_> = (0..50_000).map(|i| format!("k{i}=1")).collect();
    let errors = parse(&format!("arch = {{ {} }}", keys.join(", "))).expect_err("unknown keys");
    assert!(errors.0.len() > 50_000);
}

#[test]
fn files() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        Scenario::read(&path)
    };
    let message = |result: Result<Scenario, ScenarioErrors>| {
        let errors = result.expect_err("unreadable");
        assert_eq!(errors.0.len(), 1, "{errors}");
        errors.to_string()
    };

    assert_eq!(read("good.toml", ARCH.as_bytes()), parse(ARCH));
    let latin = message(read("latin.toml", b"title = 'a'\n# \xe9t\xe9\n"));
    assert!(
        latin.ends_with("latin.toml:2:3: not UTF-8 text from here"),
        "{latin}"
    );
    let large = message(read("large.toml", &vec![b'#'; (1 << 20) + 1]));
    assert!(large.ends_with("large.toml: is larger than 1 MiB, too large for a scenario"));
    let none = message(Scenario::read(&folder.path().join("none.toml")));
    assert!(none.contains("none.toml: cannot be read: "), "{none}");
    let dir = message(Scenario::read(folder.path()));
    assert!(dir.ends_with(": is a folder, not a scenario file"), "{dir}");
}

/// A number in `low..high` with a random exponent, so that all notations of numbers occur.
fn magnitude(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(move |x| x.exp().clamp(low, high))
}

fn any_column() -> impl Strategy<Value = String> {
    let size = || magnitude(1e-3, 1e6);
    (size(), size(), size(), size()).prop_map(|(height_m, width_m, depth_m, density_kg_m3)| {
        format!(
            "[column]\nheight_m = {height_m:?}\nwidth_m = {width_m:?}\ndepth_m = {depth_m:?}\n\
             density_kg_m3 = {density_kg_m3:?}\n"
        )
    })
}

/// Columns of drums and arches, with free hinges.
fn any_row() -> impl Strategy<Value = String> {
    let size = || magnitude(0.1, 10.0);
    let step = || proptest::option::of(magnitude(1e-6, 1e-2));
    let key = |name: &str, value: Option<f64>| {
        value.map_or(String::new(), |value| format!("{name} = {value:?}\n"))
    };
    let steps = (step(), step()).prop_map(move |(one, other)| {
        // In either order, with the longest step not shorter than the shortest.
        let (longest, shortest) = match (one, other) {
            (Some(one), Some(other)) => (Some(one.max(other)), Some(one.min(other))),
            steps => steps,
        };
        let keys = key("longest_step_s", longest) + &key("shortest_step_s", shortest);
        format!("[free_hinges]\n{keys}")
    });
    let heights = proptest::collection::vec(size(), 1..6);
    let drummed = (heights, any::<bool>(), size(), proptest::option::of(size())).prop_map(
        move |(heights_m, equal, width_m, top_width_m)| {
            let height_m: f64 = heights_m.iter().sum();
            let drums = match equal {
                true => format!("drums = {}\n", heights_m.len()),
                false => format!("drum_heights_m = {heights_m:?}\n"),
            };
            let top = key("top_width_m", top_width_m);
            format!("[column]\nheight_m = {height_m:?}\nwidth_m = {width_m:?}\n{drums}{top}")
        },
    );
    let arch = any_arch().prop_filter("has joints", |arch| arch.contains("voussoirs"));
    (prop_oneof![drummed, arch], steps).prop_map(|(structure, steps)| structure + &steps)
}

/// Arches that stand and start as four-link mechanisms.
fn any_arch() -> impl Strategy<Value = String> {
    let size = || magnitude(1e-3, 1e6);
    let voussoirs = proptest::option::of(3..=20_usize);
    (size(), 0.13..0.3, 140.0..180.0, size(), size(), voussoirs)
        .prop_map(|(mean_radius_m, thickness_ratio, embrace_deg, depth_m, density_kg_m3, voussoirs)| {
            let voussoirs = voussoirs.map_or(String::new(), |count| format!("voussoirs = {count}\n"));
            format!(
                "[arch]\nmean_radius_m = {mean_radius_m:?}\nthickness_ratio = {thickness_ratio:?}\n\
                 embrace_deg = {embrace_deg:?}\ndepth_m = {depth_m:?}\ndensity_kg_m3 = {density_kg_m3:?}\n\
                 {voussoirs}"
            )
        })
        .prop_filter("stands", |arch| parse(arch).is_ok())
}

/// A ground motion read on its own, applied to a structure read without it, is that of the scenario with both.
#[test]
fn a_ground_motion_can_be_read_alone_and_applied_to_a_structure() {
    let simulation = "[simulation]\ngravity_m_s2 = 3.7\n";
    let shaken = |ground: &str| parse(&format!("{ARCH}{simulation}{ground}")).unwrap();
    let alone = |ground: &str| Ground::of(&Source::of_text(ground, "g.toml"), 9.81);
    let pulse = "[ground.half_sine]\namplitude_g = 0.4\nduration_s = 0.5\n";
    let record = "[ground.record]\nfile = \"scenarios/synthetic.at2\"\nscale = 2.0\n";
    let studied = parse(&format!(
        "{ARCH}{simulation}{pulse}[map]\nduration_s = [0.1]\namplitude_g = [0.2]\n"
    ));
    let studied = studied.unwrap();
    for ground in [pulse, record] {
        let moved = studied.with_ground(Some(alone(ground).unwrap()));
        assert_eq!(moved, shaken(ground));
    }
    assert_eq!(studied.with_ground(None), shaken(""));

    let message = |ground: &str| alone(ground).unwrap_err().to_string();
    let wrong = message(&pulse.replace("0.4", "-4e5"));
    assert!(wrong.starts_with("g.toml:2:15: `amplitude_g"), "{wrong}");
    assert!(message("").contains("lacks a ground motion"));
    assert!(message(&format!("{pulse}{ARCH}")).contains("arch"));
}

fn any_ground() -> impl Strategy<Value = String> {
    let kind = proptest::sample::select(Pulse::ALL);
    let train = (1.0001..100.0, -360.0..360.0_f64);
    let amplitudes = (-1e3..1e3, -0.9..0.9);
    (kind, amplitudes, magnitude(1e-6, 1e6), 0.0..1e6, train).prop_map(
        |(kind, (amplitude_g, vertical_g), duration_s, start_s, (cycles, phase_deg))| {
            let train = match kind {
                Pulse::WindowedSine => format!("cycles = {cycles:?}\nphase_deg = {phase_deg:?}\n"),
                _ if kind.is_wave_train() => format!("gamma = {cycles:?}\nphase_deg = {phase_deg:?}\n"),
                _ => String::new(),
            };
            format!(
                "[ground.{}]\namplitude_g = {amplitude_g:?}\nvertical_amplitude_g = {vertical_g:?}\n\
                 duration_s = {duration_s:?}\nstart_s = {start_s:?}\n{train}",
                kind.name()
            )
        },
    )
}

fn any_impact() -> impl Strategy<Value = String> {
    let plain = proptest::sample::select(vec!["max_restitution", "same_sections", "mirrored"]);
    prop_oneof![
        plain.prop_map(|model| format!("[impact]\nmodel = '{model}'\n")),
        (0.0..=1.0).prop_map(|restitution| {
            format!("[impact]\nmodel = 'prescribed'\nrestitution = {restitution:?}\n")
        }),
    ]
}

fn any_initial() -> impl Strategy<Value = String> {
    (proptest::sample::select(Sway::ALL), magnitude(1e-9, 0.05)).prop_map(|(sway, rotation_rad)| {
        format!(
            "[initial]\nsway = '{}'\nrotation_rad = {rotation_rad:?}\n",
            sway.name()
        )
    })
}

fn any_simulation() -> impl Strategy<Value = String> {
    (
        magnitude(1e-5, 1e6),
        magnitude(2e-7, 1.0),
        magnitude(1e-13, 1e-3),
        magnitude(1e-16, 0.1),
        magnitude(1e-3, 1e3),
    )
        .prop_map(
            |(duration_s, step, tolerance, rest_energy_ratio, gravity_m_s2)| {
                let step_s = (duration_s * step).max(1e-6);
                format!(
                    "[simulation]\nduration_s = {duration_s:?}\noutput_step_s = {step_s:?}\n\
                 relative_tolerance = {tolerance:?}\nrest_energy_ratio = {rest_energy_ratio:?}\n\
                 gravity_m_s2 = {gravity_m_s2:?}\n"
                )
            },
        )
}

proptest! {
    /// A written scenario reads back the same, and TOML and JSON have the same contents.
    #[test]
    fn a_scenario_reads_back_from_its_toml(
        title in proptest::option::of(any::<String>()),
        structure in prop_oneof![
            (prop_oneof![any_arch(), any_column()], any_impact()).prop_map(|(four, impact)| four + &impact),
            any_row(),
        ],
        ground in proptest::option::of(any_ground()),
        initial in proptest::option::of(any_initial()),
        simulation in any_simulation(),
    ) {
        // JSON escapes the same characters as TOML, except one.
        let title = title.map_or(String::new(), |title| {
            format!("title = {}\n", serde_json::Value::from(title.replace('\u{7f}', "")))
        });
        let (ground, initial) = (ground.unwrap_or_default(), initial.unwrap_or_default());
        let scenario = parse(&[title, structure, ground, initial, simulation].concat()).unwrap();
        let text = scenario.to_toml();
        let json: serde_json::Value = toml::from_str(&text).unwrap();
        prop_assert_eq!(violations(&Scenario::schema(), &json, ""), [""; 0]);
        prop_assert_eq!(json, scenario.to_json());
        prop_assert_eq!(parse(&text), Ok(scenario));
    }

    #[test]
    fn random_text_is_read_or_refused(text in any::<String>()) {
        prop_assert!(parse(&text).map_or_else(|errors| !errors.0.is_empty(), |_| true));
    }

    /// Damage to a valid text gets further into the reader than noise would.
    #[test]
    fn a_damaged_scenario_is_read_or_refused(
        damage in proptest::collection::vec((0..200_usize, proptest::sample::select(DAMAGE)), 1..8),
    ) {
        let mut text = format!(
            "title = 'a'\n{ARCH}[ground.ricker]\namplitude_g = 1.0\nduration_s = 1\n[initial]\n"
        );
        for (at, piece) in damage {
            if text.is_char_boundary(at) {
                text.insert_str(at, piece);
            }
        }
        prop_assert!(parse(&text).map_or_else(|errors| !errors.0.is_empty(), |_| true));
    }
}

const DAMAGE: &[&str] = &[
    "[", "]", "\"", "'", "\"\"\"", "=", "\n", "\r", ".", ",", "{", "}", "#", "é", "\\u12",
    "\u{feff}",
];

/// Characters without width, in keys, values and names of files, are escaped in messages and in the lines that they quote.
#[test]
fn messages_show_characters_without_width() {
    for hidden in [
        "\u{feff}", "\u{200b}", "\u{ad}", "\u{2060}", "\u{202e}", "\u{200d}",
    ] {
        let escaped = shown(hidden);
        assert!(escaped.starts_with("\\u"), "{escaped}");
        let texts = [
            format!("{ARCH}\"voussoi{hidden}rs\" = 9\n"),
            format!("{ARCH}voussoi{hidden}rs = 9\n"),
            format!("{ARCH}voussoirs = \"ni{hidden}ne\"\n"),
            format!("{ARCH}[ground.record]\nfile = \"wa{hidden}ve.at2\"\n"),
            format!("{ARCH}[uncertain]\n\"arch.mean{hidden}_m\" = {{ deviation = 0.1 }}\n"),
        ];
        for text in texts {
            let errors = parse(&text).unwrap_err().to_string();
            assert!(errors.contains(&escaped), "{errors}");
            assert_eq!(shown_lines(&errors), errors);
        }
    }
}

/// A pedestal is read for a column, for both piers or for one; everything else stands on unlimited ground.
#[test]
fn pedestals() {
    let goes_on = |text: &str| {
        let scenario = parse(text).unwrap();
        assert_eq!(parse(&scenario.to_toml()).unwrap(), scenario);
        let model = scenario
            .structure
            .free_hinges(RowOptions::default())
            .unwrap();
        model.row().supports_extend
    };
    let free = "[free_hinges]\nfriction_coefficient = 0.7\n";
    let column = |pedestal: &str| format!("{COLUMN}{pedestal}drums = 3\n{free}");
    assert_eq!(goes_on(&column("")), [true, false]);
    assert_eq!(goes_on(&column("pedestal = false\n")), [true, false]);
    assert_eq!(goes_on(&column("pedestal = true\n")), [false, false]);
    let arch = |piers: &str| format!("{ARCH}voussoirs = 9\n{piers}{free}");
    let both = "[piers]\nheight_m = 3.0\nwidth_m = 2.0\n";
    assert_eq!(goes_on(&arch("")), [false, false]);
    assert_eq!(goes_on(&arch(both)), [true, true]);
    assert_eq!(
        goes_on(&arch(&format!("{both}pedestal = true\n"))),
        [false, false]
    );
    let left = "[piers.left]\nheight_m = 3.0\nwidth_m = 2.0\n";
    assert_eq!(goes_on(&arch(left)), [true, false]);
    assert_eq!(
        goes_on(&arch(&format!("{left}pedestal = true\n"))),
        [false, false]
    );
    assert_eq!(
        goes_on(&arch(&format!("[piers]\npedestal = true\n{left}"))),
        [false, false]
    );
    let other = format!("{both}pedestal = true\n[piers.right]\npedestal = false\n");
    assert_eq!(goes_on(&arch(&other)), [false, true]);
    assert_errors(
        &format!("{COLUMN}pedestal = 1\n"),
        &[(4, 12, &["`pedestal", "true or false"])],
    );
}

#[test]
fn control_characters_of_keys_are_escaped_in_messages() {
    for text in [
        "[uncertain]\n\"ground.\tone_sine.amplitude_g\" = { deviation = 0.1 }\nduration_s = 1\n",
        "[uncertain]\n\"arch.\\u0007x\" = { deviation = 0.1, form = 'normal' }\n",
        "[map]\n\"arch.\tx\" = [0.2]\n\"arch.\\u001by\" = 3\n",
        "\"a\\nb\" = 1\n",
    ] {
        for text in [text.to_owned(), format!("{ARCH}{text}")] {
            let errors = parse(&text).expect_err("the text is faulty");
            for error in &errors.0 {
                let control = error.message.chars().any(char::is_control);
                assert!(!control, "{text:?}: {:?}", error.message);
            }
        }
    }
}

#[test]
fn a_table_that_is_refused_as_a_whole_has_no_unknown_keys() {
    let text = format!(
        "{ARCH}voussoirs = 12\n[elastic_joints]\nnormal_stiffness_gpa_m = 10\n[initial]\nsway = 'right'\nrotation_rad = 0.1\n"
    );
    let errors = parse(&text).expect_err("nothing to release").to_string();
    assert!(errors.contains("leave [initial] out"), "{errors}");
    assert!(!errors.contains("unknown key"), "{errors}");
}
