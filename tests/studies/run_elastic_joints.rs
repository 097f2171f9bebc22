//! `[elastic_joints]`: reading, refusals, and the output of a run.

use std::f64::consts::PI;
use std::fs;

use archrock::scenario::{ELASTIC_JOINTS, Scenario};

use crate::common::parsed;
use crate::common::program::{printed, refused};
use crate::common::prose::{golden, shows};
use crate::common::results::{Table, data_of, json};

/// A block of 2700 kg/m3, 5 m high and 1 m wide, on a joint of 10 GPa/m.
fn block(keys: &str) -> String {
    format!(
        "[column]\nheight_m = 5.0\nwidth_m = 1.0\ndensity_kg_m3 = 2700.0\n[elastic_joints]\n{keys}\n[ground.rectangular]\namplitude_g = -0.3\n\
         duration_s = 0.3\n[simulation]\nduration_s = 3.0\n"
    )
}

#[test]
fn scenarios_with_elastic_joints_read_back() {
    for keys in [
        "normal_stiffness_gpa_m = 10.0",
        "normal_stiffness_gpa_m = 10.0\nshear_stiffness_gpa_m = 3.0\ncontact_points = 3\ncompressive_strength_mpa = 5.0",
        "stone_modulus_gpa = 20.0\nfriction_coefficient = 0.7\ncontact = \"continuous\"\nlongest_step_s = 1e-5",
        "stone_modulus_gpa = 20.0\nmortar_modulus_gpa = 1.0\nmortar_thickness_m = 0.01\ndamping_time_s = 0.0",
    ] {
        let scenario = parsed(&block(keys));
        assert_eq!(scenario.motion.kind, &ELASTIC_JOINTS);
        assert_eq!(parsed(&scenario.to_toml()), scenario, "{keys}");
    }
    // A fraction of critical damping gives a time.
    let keys = "normal_stiffness_gpa_m = 10.0\ndamping_ratio = 0.05\ndamping_frequency_hz = 1.7";
    let scenario = parsed(&block(keys));
    let due_s = 0.05 / (PI * 1.7);
    let by_time = format!("normal_stiffness_gpa_m = 10.0\ndamping_time_s = {due_s:?}");
    assert_eq!(scenario, parsed(&block(&by_time)));
    assert!(scenario.to_toml().contains("damping_ratio = 0.05\n"));
    assert_eq!(parsed(&scenario.to_toml()), scenario);
}

#[test]
fn invalid_joint_properties_are_refused_with_their_place() {
    let stiff = "normal_stiffness_gpa_m = 10.0\n";
    for (keys, place, words) in [
        (
            "",
            "5:1",
            ["lacks a stiffness", "the document on elastic joints"],
        ),
        (
            "normal_stiffness_gpa_m = -1.0",
            "6:26",
            ["out of range", "a number from"],
        ),
        (
            "normal_stiffness_gpa_m = 2000.0",
            "6:26",
            ["as good as rigid", "[free_hinges]"],
        ),
        (
            &format!("{stiff}stone_modulus_gpa = 20.0"),
            "7:21",
            ["cannot be combined", "give exactly one"],
        ),
        (
            &format!("{stiff}contact_points = 1"),
            "7:18",
            ["contact_points = 1", "2 (one does not hold a block)"],
        ),
        (
            &format!("{stiff}contact_points = 3\ncontact = \"continuous\""),
            "8:11",
            ["cannot be combined", "`contact_points`"],
        ),
        (
            &format!("{stiff}damping_ratio = 0.05"),
            "7:17",
            ["at a frequency", "damping_frequency_hz"],
        ),
        (
            &format!("{stiff}mortar_modulus_gpa = 1.0"),
            "7:22",
            ["needs", "mortar_thickness_m"],
        ),
        (
            &format!("{stiff}compressive_strength_mpa = -3.0"),
            "7:28",
            ["out of range", "a number from"],
        ),
        (
            &format!("{stiff}[impact]\nmodel = \"mirrored\""),
            "7:1",
            ["[elastic_joints]", "leave one out"],
        ),
        (
            &format!("{stiff}[free_hinges]"),
            "7:1",
            ["[elastic_joints]", "choose the model"],
        ),
    ] {
        let errors = Scenario::parse(&block(keys), "s.toml")
            .unwrap_err()
            .to_string();
        assert!(
            errors.starts_with(&format!("s.toml:{place}: ")),
            "{keys}: {errors}"
        );
        for word in words {
            assert!(errors.contains(word), "{keys}: {errors}");
        }
    }
}

/// Joints on which a structure has no equilibrium, and steps that are unstable or too many, are reported at the key that causes
/// this.
#[test]
fn unsuitable_joints_and_steps_are_refused_with_their_place() {
    let arch = |keys: &str| {
        format!(
            "[arch]\nmean_radius_m = 4.0\nthickness_ratio = 0.125\nembrace_deg = 180.0\nvoussoirs = 17\n[elastic_joints]\n{keys}\n"
        )
    };
    let stiff = "normal_stiffness_gpa_m = 10.0\n";
    let stiffest = "normal_stiffness_gpa_m = 1000.0\n";
    let long = |keys: &str| block(keys).replace("duration_s = 3.0", "duration_s = 300.0");
    for (text, place, words) in [
        (
            block(&format!("{stiff}compressive_strength_mpa = 0.1")),
            "7:28",
            "crush under the weight",
        ),
        (
            block(&format!("{stiff}longest_step_s = 0.1")),
            "7:18",
            "is too long",
        ),
        (
            long(&format!("{stiffest}damping_time_s = 1.0")),
            "7:18",
            "too many for a motion of 300 s",
        ),
        (
            long(&format!(
                "{stiffest}damping_ratio = 1.0\ndamping_frequency_hz = 0.32"
            )),
            "7:17",
            "too many for a motion of 300 s",
        ),
        (
            arch(&format!("{stiff}contact_points = 2")),
            "8:18",
            "the structure is a mechanism",
        ),
        (
            arch("normal_stiffness_gpa_m = 0.3"),
            "7:26",
            "needs a larger stiffness",
        ),
        (
            arch("stone_modulus_gpa = 0.1"),
            "7:21",
            "needs a larger stiffness",
        ),
        (
            arch(&format!("{stiff}friction_coefficient = 0.2")),
            "8:24",
            "friction_coefficient",
        ),
    ] {
        let errors = Scenario::parse(&text, "s.toml").unwrap_err().to_string();
        let placed = errors.starts_with(&format!("s.toml:{place}: "));
        assert!(placed && errors.contains(words), "{text}: {errors}");
    }
}

/// At rest a column stands on its weight: `N = m g`, evenly over the base.
#[test]
fn a_run_reports_joint_forces_and_stresses() {
    let folder = tempfile::tempdir().unwrap();
    let text = block(
        "normal_stiffness_gpa_m = 10.0\nfriction_coefficient = 0.7\ncompressive_strength_mpa = 20.0",
    );
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let said = printed(folder.path(), &["run", "s.toml", "--out", "o"]);
    golden("run-elastic-joints", &said);
    assert!(!said.contains("impact"), "{said}");
    let weight_n = 5.0 * 1.0 * 2700.0 * 9.81;
    let joints = Table::read(folder.path().join("o/joints.csv"));
    let first = |name: &str| joints.numbers(name)[0];
    assert!((first("normal_0_n") / weight_n - 1.0).abs() < 1e-9);
    assert!(first("shear_0_n").abs() < 1e-9 * weight_n);
    assert!(first("eccentricity_0_ratio").abs() < 1e-9);
    for edge in ["intrados", "extrados"] {
        let stress_pa = first(&format!("stress_0_{edge}_pa"));
        assert!((stress_pa / weight_n - 1.0).abs() < 1e-9, "{stress_pa}");
    }
    let summary = json(&folder.path().join("o/summary.json"));
    // No impacts are counted, and the friction has known bounds.
    assert!(summary["impacts"].is_null() && summary["friction_j"].is_number());
    assert_eq!(summary["unconverged_steps"], 0);
    // While it rocks, a part of the base carries the whole weight and more.
    let largest_pa = summary["largest_compressive_stress_pa"].as_f64().unwrap();
    assert!(largest_pa > 5.0 * weight_n && largest_pa <= 2e7 * (1.0 + 1e-9));
    // The energy from the ground is still in the motion, except for what was dissipated.
    let number = |name: &str| summary[name].as_f64().unwrap();
    let taken_j = number("damped_j") + number("friction_j") + number("crushed_j");
    assert!(taken_j > 0.0 && taken_j < 0.5 * number("ground_j"));
}

/// The needed friction counts joints that bear more than a hundredth of the weight; as an arch rocks, others are almost unloaded.
#[test]
fn needed_friction_counts_loaded_joints() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n\
                [elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n\
                [ground.rectangular]\namplitude_g = -0.30\nduration_s = 0.20\n";
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let said = printed(
        folder.path(),
        &["run", "s.toml", "--out", "o", "--no-repeat", "--no-report"],
    );
    let weight_n = 0.75 * 5.0 * PI * 2000.0 * 9.81;
    let joints = Table::read(folder.path().join("o/joints.csv"));
    let [mut needed, mut of_all] = [0.0_f64; 2];
    let summary = json(&folder.path().join("o/summary.json"));
    let until_s = summary["outcome_time_s"].as_f64().unwrap();
    let times_s = joints.numbers("time_s");
    for joint in 0..=36 {
        let normals_n = joints.numbers(&format!("normal_{joint}_n"));
        let shears_n = joints.numbers(&format!("shear_{joint}_n"));
        for ((normal_n, shear_n), time_s) in normals_n.iter().zip(&shears_n).zip(&times_s) {
            if *normal_n > 0.0 {
                of_all = of_all.max(shear_n.abs() / normal_n);
            }
            // The structure overturns: the fall itself does not count.
            if *normal_n > 0.01 * weight_n && *time_s <= until_s {
                needed = needed.max(shear_n.abs() / normal_n);
            }
        }
    }
    let reported = summary["largest_friction_demand"].as_f64().unwrap();
    let lasting = summary["lasting_friction_demand"].as_f64().unwrap();
    assert!(
        reported >= needed && lasting <= reported,
        "{reported} {needed} {lasting}"
    );
    assert!(of_all > 10.0 && needed < 2.0, "{of_all} {needed}");
    shows(&said, &[lasting]);
}

/// Every study gives the threshold of the block in the table; with rigid joints the same block stands up to 0.5017 g.
#[test]
fn studies_take_elastic_joints() {
    let folder = tempfile::tempdir().unwrap();
    let keys = "normal_stiffness_gpa_m = 1.0\nshear_stiffness_gpa_m = 1.0\nfriction_coefficient = 0.7\ndamping_time_s = 0.0";
    let text = block(keys)
        .replace("-0.3\n", "-1.0\n")
        .replace("duration_s = 3.0", "duration_s = 8.0");
    let map = "[map]\namplitude_g = [-0.46, -0.43]\nduration_s = [0.3]\n";
    fs::write(folder.path().join("s.toml"), format!("{text}{map}")).unwrap();
    printed(
        folder.path(),
        &[
            "threshold",
            "s.toml",
            "--from",
            "0.42",
            "--to",
            "0.48",
            "--out",
            "t",
        ],
    );
    let json = json(&folder.path().join("t/threshold.json"));
    let edge = json["models"][0]["lowest_factor"].as_f64();
    let edge = edge.unwrap_or_else(|| panic!("{json}"));
    assert!((edge / 0.4458 - 1.0).abs() < 0.005, "{edge}");
    printed(folder.path(), &["map", "s.toml", "--out", "m", "--quiet"]);
    let cells = Table::read(folder.path().join("m/map.csv"));
    let outcomes: Vec<&str> = cells
        .rows
        .iter()
        .map(|row| row["outcome"].as_str())
        .collect();
    assert_eq!(outcomes, ["overturned", "incomplete"]);
    let record = crate::common::program::scenarios().join("synthetic.at2");
    fs::copy(record, folder.path().join("r.at2")).unwrap();
    let text = text.replace("duration_s = 8.0", "duration_s = 22.0");
    let suite = "[suite]\nrecords = [\"r.at2\"]\npeaks_g = [0.1, 0.3]\n";
    fs::write(folder.path().join("u.toml"), format!("{text}{suite}")).unwrap();
    printed(folder.path(), &["suite", "u.toml", "--out", "u", "--quiet"]);
    let cases = Table::read(folder.path().join("u/suite.csv"));
    // Largest rotations in radians, as for every row of blocks.
    let peaks = cases.numbers("peak_rotation_rad");
    assert!(peaks.iter().any(|peak| *peak > 1e-3), "{peaks:?}");
    refused(
        folder.path(),
        &["run", "s.toml", "--hinges", "plastic"],
        &["elastic"],
    );
}

#[test]
fn three_models_in_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let text = block("normal_stiffness_gpa_m = 10.0");
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let said = printed(
        folder.path(),
        &[
            "run",
            "s.toml",
            "--hinges",
            "four,free,elastic",
            "--out",
            "o",
        ],
    );
    assert!(said.contains("all in o/overlay.svg"), "{said}");
    for model in ["four", "free", "elastic"] {
        assert!(
            folder
                .path()
                .join("o")
                .join(model)
                .join("summary.json")
                .exists()
        );
    }
}

/// The properties on which the motion of the arch of Lemos depends: with three points it stands at 0.15 g, with continuous contact it
/// falls. The other runs equal those of scenarios that have these properties.
#[test]
fn a_run_reports_its_dependence_on_stiffness() {
    let folder = tempfile::tempdir().unwrap();
    let arch = |joints: &str| {
        format!(
            "[arch]\nmean_radius_m = 4.0\nthickness_m = 0.5\nembrace_deg = 180.0\nvoussoirs = 17\ndensity_kg_m3 = 2700.0\n{joints}\n\
             [ground.half_sine]\namplitude_g = -0.15\nduration_s = 0.25\n[simulation]\nduration_s = 4.0\n"
        )
    };
    let elastic = |stiffness: &str, contact: &str| {
        arch(&format!(
            "[elastic_joints]\nnormal_stiffness_gpa_m = {stiffness}\nfriction_coefficient = 0.7\n{contact}"
        ))
    };
    let run = |name: &str, text: &str, options: &[&str]| {
        let file = format!("{name}.toml");
        fs::write(folder.path().join(&file), text).unwrap();
        let arguments = ["run", &file, "--out", name, "--no-report"];
        let said = printed(folder.path(), &[&arguments[..], options].concat());
        (said, json(&folder.path().join(name).join("summary.json")))
    };
    let points = "contact_points = 3";
    let (said, own) = run("own", &elastic("10", points), &[]);
    let variations = own["variations"].as_array().unwrap();
    let alone = ["--no-repeat"];
    for (with, text) in [
        ("21.5 GPa/m", elastic("21.544346900318838", points)),
        ("continuous contact", elastic("10", "")),
        (
            "rigid joints (free hinges)",
            arch("[free_hinges]\nfriction_coefficient = 0.7"),
        ),
    ] {
        let found = variations.iter().find(|one| one["with"] == with);
        let found = found.unwrap_or_else(|| panic!("{with}: {variations:?}"));
        let (_, due) = run("due", &text, &alone);
        for key in ["outcome", "outcome_time_s", "largest_peak_rotation_rad"] {
            assert_eq!(found[key], due[key], "{with}: {key}");
        }
        assert_eq!(found["first_peak_rad"], due["half_cycles"][0]["peak_rad"]);
    }
    assert_eq!(variations.len(), 6, "{variations:?}");
    golden("run-variations", &said);
    let (said, own) = run("own", &elastic("10", points), &alone);
    assert!(!said.contains("  with "), "{said}");
    assert_eq!(own["variations"], serde_json::Value::Null);
    // With rigid joints the output suggests elastic ones, unless the run also has a model with elastic joints.
    let (said, _) = run("rigid", &arch("[free_hinges]"), &alone);
    assert!(said.contains("compare with elastic joints"), "{said}");
    let models = ["--hinges", "free,elastic", "--no-repeat"];
    fs::write(folder.path().join("both.toml"), elastic("10", points)).unwrap();
    let arguments = [
        &["run", "both.toml", "--out", "both", "--no-report"][..],
        &models,
    ]
    .concat();
    let said = printed(folder.path(), &arguments);
    assert!(!said.contains("compare with elastic joints"), "{said}");
    // Elastic joints are not recommended where their stiffness or contact decides, nor where that was not computed.
    assert!(!said.contains("believe"), "{said}");
    golden("run-two-models", &said);
    let said = printed(folder.path(), &arguments[..arguments.len() - 1]);
    assert!(!said.contains("believe"), "{said}");
    golden("run-two-models-varied", &said);
}

/// The page draws the stresses of `joints.csv`, to 1/256 of the largest.
#[test]
fn the_page_draws_joint_forces() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("s.toml"),
        block("normal_stiffness_gpa_m = 10.0").replace("duration_s = 3.0", "duration_s = 1.0"),
    )
    .unwrap();
    printed(
        folder.path(),
        &["run", "s.toml", "--out", "o", "--no-repeat"],
    );
    let page = fs::read_to_string(folder.path().join("o/report.html")).unwrap();
    let joints = Table::read(folder.path().join("o/joints.csv"));
    let rows: Vec<_> = (0..joints.rows.len())
        .map(|row| {
            let number = |name: &str| joints.rows[row].number(name);
            serde_json::json!([
                number("time_s"),
                number("stress_0_intrados_pa"),
                number("stress_0_extrados_pa"),
                number("contact_0_ratio")
            ])
        })
        .collect();
    let largest_pa = data_of(&page)["frames"]["largest_stress_pa"]
        .as_f64()
        .unwrap();
    let facts = serde_json::json!({ "rows": rows, "largest_pa": largest_pa });
    let script = "
        const { times, pressure } = archrock;
        verify(times.length === data.rows.length, 'every sample is a frame');
        data.rows.forEach(([time, inner, outer, contact], frame) => {
          verify(times[frame] === time, `time ${time}`);
          const { stresses, ends } = pressure(frame, 0);
          const near = Math.abs(stresses[0] - inner) + Math.abs(stresses[1] - outer) < data.largest_pa / 100;
          verify(near, `stresses at ${time}: ${stresses}, ${inner} ${outer}`);
          if (inner === 0 || outer === 0) {
            verify(Math.abs(ends[1] - ends[0] - contact) < 0.005, `contact at ${time}`);
            verify(outer > 0 ? ends[1] === 1 : ends[0] === 0, `edge at ${time}`);
          }
        });
        verify(!document.getElementById('stress').hidden, 'the wedges are explained');";
    let path = folder.path().join("o/report.html");
    crate::common::browser::assert_checked(&path, script, &facts.to_string(), &[], 300);
}

/// A threshold with other properties equals that of a scenario that has them.
#[test]
fn a_threshold_reports_its_dependence_on_stiffness() {
    let folder = tempfile::tempdir().unwrap();
    let text = |stiffness: &str| {
        let keys = format!("normal_stiffness_gpa_m = {stiffness}\nfriction_coefficient = 0.7");
        block(&keys)
            .replace("-0.3\n", "-1.0\n")
            .replace("duration_s = 3.0", "duration_s = 6.0")
    };
    let lowest = |stiffness: &str| {
        fs::write(folder.path().join("s.toml"), text(stiffness)).unwrap();
        let arguments = [
            "threshold",
            "s.toml",
            "--from",
            "0.455",
            "--to",
            "0.52",
            "--stride",
            "0.1",
            "--out",
            "t",
        ];
        let said = printed(folder.path(), &arguments);
        (
            said,
            json(&folder.path().join("t/threshold.json"))["models"][0].clone(),
        )
    };
    let (said, own) = lowest("3");
    let (_, stiffer) = lowest("6.46330407");
    let variations = own["variations"].as_array().unwrap();
    let names: Vec<&str> = variations
        .iter()
        .map(|one| one["with"].as_str().unwrap())
        .collect();
    // Three stiffnesses a decade, up to 100 GPa/m and one below.
    let stiffnesses = [
        "1.39 GPa/m",
        "6.46 GPa/m",
        "13.9 GPa/m",
        "30 GPa/m",
        "64.6 GPa/m",
    ];
    assert_eq!(names[..5], stiffnesses);
    let (found, due) = (&variations[1]["factor"], &stiffer["lowest_factor"]);
    let ratio = found.as_f64().unwrap() / due.as_f64().unwrap();
    // Both are found from the same samples, and enclosed to a ten-thousandth.
    assert!((ratio - 1.0).abs() < 1.01e-4, "{found} {due}");
    // A variation that overturns at the smallest factor may do so at smaller ones.
    assert_eq!(variations[0]["factor"], 0.455);
    assert_eq!(variations[0]["from_end"], "sampled");
    assert_eq!(variations[1]["from_end"], "edge");
    shows(&said, &[0.455, own["lowest_factor"].as_f64().unwrap()]);
    golden("threshold-elastic", &said);
}

/// A repetition may also overturn, but to the other side: the verdict names it and does not claim agreement.
#[test]
fn the_verdict_names_repetitions_that_overturn_to_the_other_side() {
    let folder = tempfile::tempdir().unwrap();
    let record =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/recipes/nga1.at2");
    fs::copy(record, folder.path().join("nga1.at2")).unwrap();
    let text = "[arch]\nspan_m = 6.0\nmeasured_at = \"intrados\"\nembrace_deg = 150.0\nthickness_m = 0.5\nvoussoirs = 21\n\
                [elastic_joints]\nnormal_stiffness_gpa_m = 30.0\n[simulation]\nduration_s = 30.0\n\
                [ground.record]\nfile = \"nga1.at2\"\nscale = 1.25\n";
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let words = printed(folder.path(), &["run", "s.toml", "--no-report"]);
    assert!(
        words.contains("DIFFERENT OUTCOME, overturned to the right with quarter steps"),
        "{words}"
    );
    assert!(
        words.contains("overturns to the left, and to the right with quarter steps"),
        "{words}"
    );
    // The mirrored repetition is mirrored back: it overturns to the side of the motion as given.
    let summary = json(&folder.path().join("results/s/summary.json"));
    let sways = &summary["repeatability"]["overturning_sways"];
    assert_eq!([&sways["own"], &sways["mirrored"]], ["left"; 2]);
    assert!(!words.contains("the same with other steps"), "{words}");
}

/// The block on three contact points slips a little at each impact, and more with shorter steps. The printed range is that of the repetitions,
/// here computed again with two thirds of the steps.
#[test]
fn the_largest_slip_has_the_range_of_its_repetitions() {
    let scenario = "[column]\nheight_m = 5.44\nwidth_m = 1.922\n[elastic_joints]\nnormal_stiffness_gpa_m = 100\n\
                    friction_coefficient = 1.14\ndamping_time_s = 1e-4\ncontact_points = 3\n[ground.half_sine]\namplitude_g = 0.7\n\
                    duration_s = 0.3\n[simulation]\nduration_s = 2.0\n";
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), scenario).unwrap();
    let words = printed(folder.path(), &["run", "s.toml", "--out", "here"]);
    let summary = json(&folder.path().join("here/summary.json"));
    let slip_m = &summary["repeatability"]["largest_slip_m"];
    let [own_m, least_m, most_m] = ["own", "min", "max"].map(|key| slip_m[key].as_f64().unwrap());
    assert!(least_m <= own_m && own_m < most_m, "{slip_m}");
    let ends = format!(
        "LARGEST SLIP {:.3} to {:.3} mm",
        1e3 * least_m,
        1e3 * most_m
    );
    assert!(words.contains(&ends), "{words}");
    let finer_s = 2.0 / 3.0 * summary["longest_step_s"].as_f64().unwrap();
    let finer = format!("elastic_joints.longest_step_s={finer_s}");
    printed(
        folder.path(),
        &[
            "run",
            "s.toml",
            "--set",
            &finer,
            "--no-repeat",
            "--out",
            "finer",
        ],
    );
    let joints = Table::read(folder.path().join("finer/joints.csv"));
    let slips_m = joints.numbers("slip_0_m").into_iter().map(f64::abs);
    let finer_m = slips_m.fold(0.0, f64::max);
    // The table has a row every 5 ms, and may miss the largest slip.
    assert!(
        1.1 * own_m < finer_m && finer_m <= most_m,
        "{finer_m} {slip_m}"
    );
}
