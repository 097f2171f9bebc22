//! Warnings about unlikely input: a mistake has one, with its key and the likely unit; correct scenarios have none.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use archrock::scenario::{Scenario, Unlikely, Varied};
use serde_json::Value;

use crate::common::program::{
    archrock, example, refusal, scenario_files, scenarios, stderr, stdout,
};

const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\ndensity_kg_m3 = 2500\n";
const PULSE: &str = "[ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.5\n";

/// Correct scenarios by their names.
fn correct(name: &str) -> String {
    let arch = "[arch]\nmeasured_at = 'intrados'\nspan_m = 6.0\nrise_m = 2.0\nthickness_m = 0.5\nvoussoirs = 15\n";
    let ring = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 150\n";
    let piers = "[pointed_arch]\nspan_m = 6.0\nrise_m = 4.0\nthickness_m = 0.6\nvoussoirs = 14\n[piers]\nheight_m = 3.0\nwidth_m = 1.6\n";
    let fill = "[fill]\nheight_m = 2.0\ndensity_kg_m3 = 1600\n[[load]]\nmass_kg = 1500\nx_m = 1.0\nwidth_m = 0.5\n[free_hinges]\n";
    let load = "[[load]]\nmass_kg = 1500\nx_m = -0.1\n[[load]]\nmass_kg = 2000\nmoves = false\nthrust_n = 1500\n";
    let tie = "[free_hinges]\n[[tie]]\nheight_m = 1.5\narea_mm2 = 261\nmodulus_gpa = 210\nprestress_n = 5000\nyield_stress_mpa = 235\nbreaks_at_strain = 0.05\n";
    let elastic = "[elastic_joints]\nstone_modulus_gpa = 20\nmortar_modulus_gpa = 2\nmortar_thickness_m = 0.01\ncompressive_strength_mpa = 20\nfriction_coefficient = 0.6\n";
    let moved = "[free_hinges]\n[supports]\nright = { spread_m = 0.05, settlement_m = 0.02, rotation_rad = 0.01 }\n";
    let demand = "[demand]\nsoil = 'B'\ntopography = 'T1'\nsld = { ag_g = 0.1, f0 = 2.4, tc_star_s = 0.28 }\nslv = { ag_g = 0.25, f0 = 2.4, tc_star_s = 0.35 }\n";
    let right = "[free_hinges]\n[ground.right]\n";
    let record = "[ground.record]\nfile = 'g.csv'\nunit = 'g'\n";
    match name {
        "column" => format!("{COLUMN}{PULSE}"),
        "wall" => format!("{COLUMN}{load}"),
        "arch" => format!("{arch}{PULSE}"),
        "ring" => format!("{ring}{PULSE}"),
        "piers" => format!("{piers}{fill}"),
        "tie" => format!("{arch}{tie}"),
        "vehicle" => format!("{arch}[vehicle]\naxles_kg = [6000, 11500]\nspacing_m = [3.6]\n"),
        "elastic" => format!("{arch}{elastic}"),
        "moved" => format!("{arch}{moved}"),
        "verify" => format!("{ring}{demand}"),
        "delay" => format!("{arch}{PULSE}{right}delay_s = 0.05\n"),
        "wave" => format!("{arch}{PULSE}{right}apparent_velocity_m_s = 500\n"),
        "blow" => {
            format!("{COLUMN}[initial]\nsway = 'right'\nimpulse_n_s = 3000\nheight_m = 3.5\n")
        }
        "rate" => format!("{COLUMN}[initial]\nsway = 'right'\nrate_rad_s = 0.3\n"),
        "released" => format!("{COLUMN}[initial]\nsway = 'right'\nrotation_rad = 0.1\n"),
        "record" => format!("{COLUMN}{record}"),
        "step" => format!("{COLUMN}{record}dt_s = 0.01\n").replace("g.csv", "one.csv"),
        "suite" => format!(
            "{COLUMN}[suite]\nrecords = 'g.csv'\nunit = 'g'\npeaks_g = [0.2, 0.4, 0.8]\nspectral_damping_percent = 5\n"
        ),
        "map" => {
            format!("{COLUMN}{PULSE}[map]\nduration_s = [0.2, 1.0]\namplitude_g = [0.2, 2.0]\n")
        }
        "samples" => format!(
            "{COLUMN}{PULSE}[uncertain]\nsamples = 9\n'column.width_m' = {{ from = 0.7, to = 0.9 }}\n"
        ),
        _ => panic!("{name}"),
    }
}

/// Mistakes: the scenario, its correct text, the wrong one, and key and likely unit of the only warning.
#[rustfmt::skip]
const MISTAKES: &[[&str; 5]] = &[
    ["ring", "mean_radius_m = 5.0", "mean_radius_m = 500", "arch.mean_radius_m", "centimetres"],
    ["ring", "mean_radius_m = 5.0", "mean_radius_m = 5000", "arch.mean_radius_m", "millimetres"],
    ["ring", "mean_radius_m = 5.0", "mean_radius_m = 50", "arch.thickness_m", "centimetres"],
    ["arch", "span_m = 6.0\nrise_m = 2.0\nthickness_m = 0.5", "span_m = 600\nrise_m = 200\nthickness_m = 50", "arch.span_m", "centimetres"],
    ["delay", "thickness_m = 0.5", "thickness_m = 500", "arch.thickness_m", "millimetres"],
    ["column", "height_m = 4.0\nwidth_m = 0.8", "height_m = 150\nwidth_m = 30", "column.height_m", "centimetres"],
    ["column", "width_m = 0.8", "width_m = 80", "column.width_m", "centimetres"],
    ["column", "height_m = 4.0\nwidth_m = 0.8", "height_m = 0.8\nwidth_m = 4.0", "column.width_m", ""],
    ["column", "density_kg_m3 = 2500", "density_kg_m3 = 24", "column.density_kg_m3", "kN/m3"],
    ["column", "density_kg_m3 = 2500", "density_kg_m3 = 24000", "column.density_kg_m3", "N/m3"],
    ["column", "density_kg_m3 = 2500", "density_kg_m3 = 2.5", "column.density_kg_m3", "t/m3"],
    ["column", "density_kg_m3 = 2500", "density_kg_m3 = 250", "column.density_kg_m3", ""],
    ["column", "density_kg_m3", "depth_m = 1000\ndensity_kg_m3", "column.depth_m", "millimetres"],
    ["piers", "height_m = 3.0", "height_m = 300", "piers.height_m", "centimetres"],
    ["piers", "width_m = 1.6", "width_m = 1600", "piers.width_m", "millimetres"],
    ["piers", "height_m = 2.0", "height_m = 200", "fill.height_m", "centimetres"],
    ["piers", "density_kg_m3 = 1600", "density_kg_m3 = 18", "fill.density_kg_m3", "kN/m3"],
    ["piers", "mass_kg = 1500", "mass_kg = 1.5", "load.1.mass_kg", "tonnes"],
    ["piers", "mass_kg = 1500", "mass_kg = 15", "load.1.mass_kg", "tonnes"],
    ["wall", "thrust_n = 1500", "thrust_n = 1.5", "load.2.thrust_n", "kN"],
    ["tie", "261\nmodulus_gpa = 210\nprestress_n = 5000", "2.61\nmodulus_gpa = 210\nprestress_n = 500", "tie.1.area_mm2", "cm2"],
    ["vehicle", "[6000, 11500]", "[6, 11.5]", "vehicle.axles_kg", ""],
    ["vehicle", "spacing_m = [3.6]", "spacing_m = [3600]", "vehicle.spacing_m", ""],
    ["tie", "modulus_gpa = 210", "modulus_gpa = 2100", "tie.1.modulus_gpa", "MPa"],
    ["tie", "prestress_n = 5000", "prestress_n = 5", "tie.1.prestress_n", "kN"],
    ["tie", "yield_stress_mpa = 235", "yield_stress_mpa = 23500", "tie.1.yield_stress_mpa", "kPa"],
    ["tie", "breaks_at_strain = 0.05", "breaks_at_strain = 5", "tie.1.breaks_at_strain", "per cent"],
    ["elastic", "friction_coefficient = 0.6", "friction_coefficient = 6", "elastic_joints.friction_coefficient", "degrees"],
    ["elastic", "friction_coefficient = 0.6", "friction_coefficient = 35", "elastic_joints.friction_coefficient", "degrees"],
    ["elastic", "stone_modulus_gpa = 20", "stone_modulus_gpa = 2000", "elastic_joints.stone_modulus_gpa", "MPa"],
    ["elastic", "mortar_modulus_gpa = 2", "mortar_modulus_gpa = 30", "elastic_joints.mortar_modulus_gpa", ""],
    ["elastic", "mortar_thickness_m = 0.01", "mortar_thickness_m = 1", "elastic_joints.mortar_thickness_m", "centimetres"],
    ["elastic", "compressive_strength_mpa = 20", "compressive_strength_mpa = 5000", "elastic_joints.compressive_strength_mpa", "kPa"],
    ["moved", "rotation_rad = 0.01", "rotation_rad = 0.573", "supports.right.rotation_rad", "degrees"],
    ["moved", "settlement_m = 0.02", "settlement_m = 2", "supports.right.settlement_m", "centimetres"],
    ["verify", "ag_g = 0.1,", "ag_g = 0.3,", "demand.sld.ag_g", ""],
    ["verify", "tc_star_s = 0.35", "tc_star_s = 0.035", "demand.slv.tc_star_s", ""],
    ["blow", "impulse_n_s = 3000", "impulse_n_s = 3", "initial.impulse_n_s", "kN s"],
    ["rate", "rate_rad_s = 0.3", "rate_rad_s = 17", "initial.rate_rad_s", "degrees"],
    ["released", "rotation_rad = 0.1", "rotation_rad = 1", "initial.rotation_rad", "degrees"],
    ["column", "duration_s = 0.5", "duration_s = 500", "ground.half_sine.duration_s", "milliseconds"],
    ["column", "amplitude_g = 0.3", "amplitude_g = 30", "ground.half_sine.amplitude_g", "per cent of gravity"],
    ["column", "amplitude_g = 0.3", "amplitude_g = 3.92", "ground.half_sine.amplitude_g", "m/s2"],
    ["delay", "delay_s = 0.05", "delay_s = 50", "ground.right.delay_s", "milliseconds"],
    ["wave", "velocity_m_s = 500", "velocity_m_s = 5", "ground.right.apparent_velocity_m_s", "km/s"],
    ["record", "unit = 'g'", "unit = 'm/s2'", "g.csv", "g"],
    ["record", "unit = 'g'", "unit = 'cm/s2'", "g.csv", "g"],
    ["record", "g.csv", "minutes.csv", "minutes.csv", "minutes"],
    ["record", "g.csv", "cut.csv", "cut.csv", ""],
    ["record", "g.csv", "offset.csv", "offset.csv", ""],
    ["step", "dt_s = 0.01", "dt_s = 0.1", "one.csv", ""],
    ["step", "dt_s = 0.01", "dt_s = 0.001", "one.csv", ""],
    ["step", "dt_s = 0.01", "dt_s = 10", "one.csv", "milliseconds"],
    ["suite", "[0.2, 0.4, 0.8]", "[10, 20, 30]", "suite.peaks_g", "per cent of gravity"],
    ["suite", "[0.2, 0.4, 0.8]", "[1.96, 3.92]", "suite.peaks_g", "m/s2"],
    ["suite", "[0.2, 0.4, 0.8]", "[0.02, 0.08]", "suite.peaks_g", ""],
    ["suite", "percent = 5", "percent = 0.05", "suite.spectral_damping_percent", "fractions of one"],
    ["map", "amplitude_g = [0.2, 2.0]", "amplitude_g = [1.96, 19.6]", "ground.half_sine.amplitude_g", "m/s2"],
    ["map", "duration_s = [0.2, 1.0]", "duration_s = [200, 1000]", "ground.half_sine.duration_s", "milliseconds"],
    ["map", "duration_s = [0.2, 1.0]", "'column.width_m' = [60, 90]", "column.width_m", "centimetres"],
    ["samples", "from = 0.7, to = 0.9", "from = 70, to = 90", "column.width_m", "centimetres"],
];

/// Mistakes that give possible scenarios, as docs/records.md says, and possible numbers that are no mistakes.
#[rustfmt::skip]
const UNNOTICED: &[[&str; 3]] = &[
    ["arch", "span_m = 6.0", "span_m = 60.0"],
    ["column", "height_m = 4.0", "height_m = 40.0"],
    ["elastic", "stone_modulus_gpa = 20", "stone_modulus_gpa = 2"],
    ["tie", "yield_stress_mpa = 235", "yield_stress_mpa = 2350"],
    ["column", "amplitude_g = 0.3", "amplitude_g = 2.94"],
    ["column", "duration_s = 0.5", "duration_s = 5"],
    ["record", "unit = 'g'", "unit = 'g'\nscale = 9.81"],
    // Normalised density, joints that never slip, and a unit of gravity.
    ["column", "density_kg_m3 = 2500", "density_kg_m3 = 1"],
    ["elastic", "friction_coefficient = 0.6", "friction_coefficient = 1000"],
];

/// Writes a record of 14 s that shakes at some 2 Hz with a peak of about 0.3 g, and records made of it by mistakes.
fn write_records(folder: &Path) {
    let samples: Vec<f64> = (0..1400)
        .map(|index| {
            let time_s = f64::from(index) * 0.01;
            let envelope = (std::f64::consts::PI * time_s / 14.0).sin();
            0.2 * envelope * ((10.0 * time_s).sin() + 0.5 * (21.0 * time_s).sin())
        })
        .collect();
    let write = |name: &str, rows: &mut dyn Iterator<Item = (f64, f64)>| {
        let mut text = String::new();
        for (time_s, acceleration) in rows {
            writeln!(text, "{time_s:.6},{acceleration:.6}").unwrap();
        }
        fs::write(folder.join(name), text).unwrap();
    };
    let timed = |step: f64| {
        let samples = samples.iter().enumerate();
        samples.map(move |(index, sample)| (index as f64 * step, *sample))
    };
    let largest = samples.iter().copied().fold(0.0, f64::max);
    let late = samples.iter().rposition(|sample| *sample > 0.9 * largest);
    write("g.csv", &mut timed(0.01));
    write("minutes.csv", &mut timed(0.01 / 60.0));
    write("cut.csv", &mut timed(0.01).take(late.unwrap() + 1));
    write(
        "offset.csv",
        &mut timed(0.01).map(|(time_s, sample)| (time_s, sample + 0.02)),
    );
    let one: Vec<String> = samples
        .iter()
        .map(|sample| format!("{sample:.6}\n"))
        .collect();
    fs::write(folder.join("one.csv"), one.concat()).unwrap();
}

fn unlikely(folder: &Path, text: &str) -> Vec<Unlikely> {
    let name = folder.join("s.toml");
    let scenario = Scenario::parse(text, name.to_str().unwrap());
    let scenario = scenario.unwrap_or_else(|errors| panic!("{text}\n{errors}"));
    scenario.unlikely_in(&Varied::default())
}

#[test]
fn each_mistake_has_one_warning_with_its_key_and_the_likely_unit() {
    let folder = tempfile::tempdir().unwrap();
    write_records(folder.path());
    let mut known = BTreeSet::new();
    for [name, right, wrong, key, likely] in MISTAKES {
        let text = correct(name);
        assert!(text.contains(right), "{name}: {right}");
        if known.insert(name) {
            assert_eq!(unlikely(folder.path(), &text), [], "{name}");
        }
        let found = unlikely(folder.path(), &text.replacen(right, wrong, 1));
        let [one] = &found[..] else {
            panic!("{name}, {wrong}: {found:#?}");
        };
        let found = (&*one.key, one.likely.as_deref().unwrap_or_default());
        assert_eq!(found, (*key, *likely), "{name}, {wrong}: {one}");
        // The warning has the number of the key, or a number that follows from it.
        let value = one.value.unwrap();
        assert!(value != 0.0 && !one.to_string().is_empty(), "{one:?}");
    }
    for [name, right, wrong] in UNNOTICED {
        let text = correct(name);
        assert!(text.contains(right), "{name}: {right}");
        let found = unlikely(folder.path(), &text.replacen(right, wrong, 1));
        assert_eq!(found, [], "{name}, {wrong}");
    }
}

/// The scenarios of the repository are correct.
#[test]
fn scenarios_of_the_repository_cause_no_warnings() {
    let others = ["recipes", "uncertain"].map(|folder| scenarios().join(folder));
    let others = others
        .iter()
        .flat_map(|folder| fs::read_dir(folder).unwrap());
    let others = others.map(|entry| entry.unwrap().path());
    let others = others.filter(|file| file.extension().is_some_and(|ending| ending == "toml"));
    let files: Vec<_> = scenario_files().into_iter().chain(others).collect();
    assert!(files.len() > 25);
    for file in files {
        let scenario = example(&file);
        assert_eq!(
            scenario.unlikely_in(&Varied::default()),
            [],
            "{}",
            file.display()
        );
    }
}

/// Ranges in options are part of a study.
#[test]
fn ranges_of_options_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let name = folder.path().join("s.toml");
    let scenario = Scenario::parse(&correct("column"), name.to_str().unwrap()).unwrap();
    let along = |key, ends| Varied {
        key_range: Some((key, ends)),
        ..Varied::default()
    };
    let of_factor = |factor| Varied {
        factor: Some(factor),
        ..Varied::default()
    };
    for (study, key, value) in [
        (
            along("column.width_m", [60.0, 90.0]),
            "column.width_m",
            60.0,
        ),
        (
            along("ground.half_sine.amplitude_g", [1.96, 4.0]),
            "ground.half_sine.amplitude_g",
            1.96,
        ),
        // A hundred times 0.3 g.
        (of_factor(100.0), "factors.to", 30.0),
    ] {
        let found = scenario.unlikely_in(&study);
        let found: Vec<_> = found.iter().map(|one| (&*one.key, one.value)).collect();
        assert_eq!(found, [(key, Some(value))]);
    }
    assert_eq!(
        scenario.unlikely_in(&along("column.width_m", [0.6, 0.9])),
        []
    );
    assert_eq!(scenario.unlikely_in(&of_factor(10.0)), []);
}

/// Every command prints each warning once, and its JSON has the sentences and their numbers.
#[test]
fn commands_print_the_warnings_of_their_study_once() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write_records(at);
    let dense = |name: &str| correct(name).replace("density_kg_m3 = 2500", "density_kg_m3 = 25");
    let suite = dense("suite").replace("peaks_g = [0.2, 0.4, 0.8]", "scales = [1]");
    let short = "[simulation]\nduration_s = 14.0\n";
    for (name, text) in [
        ("column", dense("column")),
        ("suite", suite),
        ("map", dense("map")),
    ] {
        fs::write(
            at.join(name).with_extension("toml"),
            format!("{text}{short}"),
        )
        .unwrap();
    }
    let density = "the density of [column] is 25 kg/m3: is it in kN/m3?";
    let factor = "the largest factor on the ground motion reaches 30 g: is it in per cent?";
    let width = "the width of the column is 60 m: is it in centimetres?";
    let along = ["--along", "column.width_m=0.6..60:2", "--to", "1.1"];
    for (command, file, more, warnings) in [
        ("run", "column.toml", &[][..], &[density][..]),
        ("run", "suite.toml", &["--suite"], &[density]),
        ("map", "map.toml", &[], &[density]),
        ("suite", "suite.toml", &[], &[density]),
        ("run", "column.toml", &["--hinges", "both"], &[density]),
        (
            "threshold",
            "column.toml",
            &["--to", "100", "--stride", "1"],
            &[density, factor],
        ),
        (
            "threshold",
            "suite.toml",
            &["--suite", "--stride", "1", "--to", "2"],
            &[density],
        ),
        ("threshold", "column.toml", &along, &[density, width]),
        ("limit", "column.toml", &[], &[density]),
        ("capacity", "column.toml", &[], &[density]),
        ("impact", "column.toml", &[], &[density]),
        ("check", "column.toml", &[], &[density]),
    ] {
        let arguments = [&[command, file, "--format", "json"], more].concat();
        let output = archrock(at, &arguments);
        let said = stderr(&output);
        let printed = said
            .lines()
            .filter_map(|line| line.strip_prefix("warning: "));
        assert_eq!(
            printed.collect::<Vec<_>>(),
            warnings,
            "{arguments:?}: {said}"
        );
        let json: Value = serde_json::from_str(&stdout(&output)).unwrap();
        if command == "check" || more.contains(&"--hinges") {
            continue;
        }
        let sentences = json["warnings"].as_array().unwrap();
        let numbers = json["unlikely"].as_array().unwrap();
        assert_eq!(sentences[..numbers.len()], *warnings, "{arguments:?}");
        let of_density = numbers
            .iter()
            .find(|one| one["key"] == "column.density_kg_m3");
        let due = serde_json::json!({ "key": "column.density_kg_m3", "value": 25.0, "unit": "kg/m3", "likely": "kN/m3" });
        assert_eq!(of_density, Some(&due), "{arguments:?}");
    }
}

/// `check` refuses a scenario whose motion `run` refuses, with the same message.
#[test]
fn check_refuses_what_run_refuses() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("damaged.csv"), "0,0\n0.01,x\n0.02,0\n").unwrap();
    let thick =
        "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.25\nembrace_deg = 100\nvoussoirs = 7\n";
    let record = |file: &str| format!("{COLUMN}[ground.record]\nfile = '{file}'\nunit = 'g'\n");
    for (text, words) in [
        (record("nowhere.csv"), "nowhere.csv"),
        (record("damaged.csv"), "damaged.csv:2"),
        (format!("{COLUMN}drums = 3\n{PULSE}"), "[free_hinges]"),
        (format!("{thick}{PULSE}"), "four"),
    ] {
        fs::write(at.join("s.toml"), &text).unwrap();
        let [checked, run] =
            ["check", "run"].map(|command| refusal(&archrock(at, &[command, "s.toml"])));
        assert!(checked.contains(words), "{checked}");
        assert_eq!(checked, run);
    }
    // Without a motion the structure is for `limit`.
    fs::write(at.join("s.toml"), format!("{COLUMN}drums = 3\n")).unwrap();
    let output = archrock(at, &["check", "s.toml"]);
    assert!(
        output.status.success()
            && stderr(&output).contains("only `limit`, `spread`, `capacity` and `verify` work")
    );
}

/// A statue of 1.2 t and 500 kg m2 in the units of its keys, and in others.
#[test]
fn units_of_a_body_are_checked() {
    let warnings = |keys: &str| {
        let text = format!("[body]\n{keys}\n{PULSE}");
        Scenario::parse(&text, "statue.toml")
            .unwrap()
            .unlikely_values()
    };
    let right =
        "mass_kg = 1200\ninertia_kg_m2 = 500\ncentre_m = [0.05, 0.9]\ntoes_x_m = [-0.4, 0.4]";
    assert_eq!(warnings(right), [""; 0]);
    for (wrong, words) in [
        (
            right.replace("1200", "1.2").replace("500", "0.5"),
            "the mass of the body is 1.2 kg: is it in t?",
        ),
        (
            right.replace("500", "5e5"),
            "the radius of gyration of the body is 20.4124 m",
        ),
        (
            right.replace("500", "0.5"),
            "the radius of gyration of the body is 0.0204124 m",
        ),
        (
            "mass_kg = 1200\ninertia_kg_m2 = 5e5\ncentre_m = [5, 90]\ntoes_x_m = [-40, 40]"
                .to_owned(),
            "the centre of gravity is at 90 m",
        ),
    ] {
        let found = warnings(&wrong);
        assert!(found.iter().any(|one| one.starts_with(words)), "{found:?}");
    }
}

/// The default density is a condition of A_L where A_L depends on it, and the program computes that: 1800 and 2400 kg/m3 give other pushes.
#[test]
fn a_default_density_is_named_where_the_push_depends_on_it() {
    let pointed = "[pointed_arch]\nspan_m = 6.0\nrise_m = 4.0\nthickness_m = 0.6\nvoussoirs = 14\n";
    let fill = "[fill]\nabove_crown_m = 0.3\ndensity_kg_m3 = 1600\n";
    let limit = |text: &str| {
        let scenario = Scenario::parse(&format!("{text}[free_hinges]\n"), "arch.toml").unwrap();
        let found = archrock::studies::limit(&scenario).unwrap().json;
        let warnings: Vec<String> = serde_json::from_value(found["warnings"].clone()).unwrap();
        let push_g = found["incipient_acceleration_g"]["right"].as_f64();
        (push_g.unwrap(), warnings)
    };
    let named = "the density is the default, 2000 kg/m3: with [fill]";
    let (bare_g, warnings) = limit(pointed);
    assert!(warnings.is_empty());
    let (default_g, warnings) = limit(&format!("{pointed}{fill}"));
    assert!(
        warnings.len() == 1 && warnings[0].starts_with(named),
        "{warnings:?}"
    );
    for density in [1800.0, 2000.0, 2400.0] {
        let given = format!("{pointed}density_kg_m3 = {density}\n");
        let (push_g, warnings) = limit(&format!("{given}{fill}"));
        assert!(warnings.is_empty());
        assert_eq!(
            (push_g / default_g - 1.0).abs() > 0.01,
            density != 2000.0,
            "{push_g}"
        );
        assert!((limit(&given).0 / bare_g - 1.0).abs() < 1e-9);
    }
    // A floor on a held top, in limit and capacity.
    let folder = tempfile::tempdir().unwrap();
    let wall = "[column]\nheight_m = 3.5\nwidth_m = 0.45\n[column.top]\nweight_n = 25e3\n";
    let named = "the density is the default, 2000 kg/m3: with [column.top]";
    for (text, is_named) in [
        (wall.to_owned(), true),
        (
            wall.replace("0.45\n", "0.45\ndensity_kg_m3 = 2000\n"),
            false,
        ),
    ] {
        fs::write(folder.path().join("s.toml"), text).unwrap();
        for command in ["limit", "capacity"] {
            let words = stdout(&archrock(folder.path(), &[command, "s.toml"]));
            assert_eq!(words.contains(named), is_named, "{command}: {words}");
        }
    }
}
