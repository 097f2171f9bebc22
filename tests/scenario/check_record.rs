//! Records in common file formats: output of `check` and `run` about them, and unlikely input.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::common::ARCH;
use crate::common::program::{archrock, stderr};
use crate::common::program::{refusal, stdout};
use crate::common::results::named;

/// A full sine of 0.4 g and 1 s from 0.5 s on, 200 samples a second, in g.
fn sine() -> Vec<f64> {
    (0..=400)
        .map(|i| f64::from(i) / 200.0 - 0.5)
        .map(|t| {
            if (0.0..=1.0).contains(&t) {
                0.4 * (2.0 * PI * t).sin()
            } else {
                0.0
            }
        })
        .collect()
}

/// The same motion in each format, with the keys that read it.
fn files(folder: &Path) -> Vec<(&'static str, &'static str)> {
    let sine = sine();
    let mut at2 =
        "PEER\nX\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 401, DT= .0050 SEC\n".to_owned();
    let mut gal = at2.replace("UNITS OF G", "UNITS OF CM/SEC/SEC");
    let mut asc = "EVENT_ID: X\nSAMPLING_INTERVAL_S: 0.005\nNDATA: 401\nUNITS: cm/s^2\nDATA_TYPE: ACCELERATION\nUSER:\n"
        .to_owned();
    let mut comma = "Station X\nEpicentre; 12.5 E\ntime; acceleration\n".to_owned();
    let mut blanks = String::new();
    let mut single = "corrected acceleration, m/s2\n".to_owned();
    let mut six = String::new();
    let mut knet = "Origin Time       2024/01/02 03:04:05\nStation Code      XXX001\nSampling Freq(Hz) 200Hz\n\
                    Duration Time(s)  2\nDir.              E-W\nScale Factor      10(gal)/1000000\nMemo.\n"
        .to_owned();
    for (i, a) in sine.iter().enumerate() {
        let t = i as f64 * 0.005;
        let cm = 981.0 * a;
        let _ = writeln!(at2, " {a:.12E}");
        let _ = writeln!(gal, " {cm:.12E}");
        let _ = writeln!(asc, "{cm:.12}");
        let _ = writeln!(comma, "{t:.3}; {cm:.12}");
        let _ = writeln!(blanks, "  {t:10.4}   {a:18.14}");
        let _ = writeln!(single, "{:.12}", 9.81 * a);
        let end = |per_line: usize| {
            if i % per_line == per_line - 1 {
                "\n"
            } else {
                ""
            }
        };
        let _ = write!(six, "{a:14.10}{}", end(6));
        let _ = write!(knet, "{:>12.0}{}", 1e5 * cm, end(8));
    }
    for (name, text) in [
        ("g.AT2", &at2),
        ("gal.at2", &gal),
        ("esm.ASC", &asc),
        ("comma.csv", &comma.replace('.', ",")),
        ("blanks.txt", &blanks),
        ("tabs.dat", &blanks.replace("   ", "\t")),
        ("single.csv", &single),
        ("nameless.xyz", &blanks),
        ("six.txt", &six),
        ("station.EW", &knet),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
    vec![
        ("g.AT2", ""),
        ("gal.at2", ""),
        ("esm.ASC", ""),
        (
            "comma.csv",
            "unit = 'gal'\nskip_rows = 2\ndecimal = 'comma'\n",
        ),
        ("blanks.txt", "unit = 'g'\n"),
        ("single.csv", "unit = 'm/s^2'\ndt_s = 0.005\n"),
        ("nameless.xyz", "format = 'csv'\nunit = 'g'\n"),
        ("six.txt", "unit = 'g'\ndt_s = 0.005\nwrapped = true\n"),
        ("station.EW", ""),
    ]
}

/// The `--set` options for keys that are written as in a scenario.
fn set(keys: &str) -> Vec<String> {
    let lines = keys.lines().map(|line| line.replace(['\'', ' '], ""));
    lines.flat_map(|line| ["--set".to_owned(), line]).collect()
}

/// A sine of amplitude A and period T = 1 s has the velocity A / pi at half its period, and the displacement A / (2 pi) at its
/// end and ever after. The integral of the squares is A^2 / 2; a part p of it is reached where t - sin(4 pi t) / (4 pi) = p:
/// 5 % at 0.12945 s, and 95 % equally long before the end.
#[test]
fn check_describes_a_record_the_same_in_all_formats() {
    let folder = tempfile::tempdir().unwrap();
    for (file, keys) in files(folder.path()) {
        let set = set(keys);
        let mut arguments = vec!["check", file];
        arguments.extend(set.iter().map(String::as_str));
        let said = stdout(&archrock(folder.path(), &arguments));
        let velocity = 0.4 * 9.81 / PI;
        let displacement = 0.4 * 9.81 / (2.0 * PI);
        let arias = PI / (2.0 * 9.81) * (0.4 * 9.81_f64).powi(2) / 2.0;
        for words in [
            "401 samples every 0.005 s, 2 s long",
            "peak acceleration 0.4000 g = 3.9240 m/s2 at 0.750 s",
            "significant duration (5 to 95 %) 0.741 s, from 0.629 to 1.371 s",
        ] {
            assert!(said.contains(words), "{file}: {words} is not in {said}");
        }
        // Straight lines between 200 samples per second have errors of some 1e-4.
        for (what, exact) in [
            ("peak velocity ", velocity),
            ("peak displacement ", displacement),
            ("Arias intensity ", arias),
        ] {
            let (_, number) = said.split_once(what).unwrap();
            let number: f64 = number.split(' ').next().unwrap().parse().unwrap();
            assert!(
                (number / exact - 1.0).abs() < 3e-4,
                "{file}: {what}{number} {exact}"
            );
        }
        let unit = match file {
            "g.AT2" => "AT2 file (PEER), accelerations in g",
            "gal.at2" => "AT2 file (PEER), accelerations in cm/s2",
            "esm.ASC" => "ASC file (ESM), accelerations in cm/s2",
            "single.csv" => "table, accelerations in m/s2",
            "six.txt" => "table with several samples a row, accelerations in g, 6 a row",
            "station.EW" => "file of K-NET, accelerations in cm/s2",
            _ => "table, accelerations in ",
        };
        assert!(said.starts_with(&format!("{file}: {unit}")), "{said}");
    }
}

#[test]
fn a_record_gives_the_same_history_in_all_formats() {
    let folder = tempfile::tempdir().unwrap();
    let mut outcomes = Vec::new();
    for (file, keys) in files(folder.path()) {
        let text = format!("{ARCH}[ground.record]\nfile = '{file}'\n{keys}");
        fs::write(folder.path().join("s.toml"), text).unwrap();
        let said = stdout(&archrock(folder.path(), &["run", "s.toml"]));
        let (first, rest) = said.split_once('\n').unwrap();
        assert_eq!(
            first,
            format!("  {file}: 401 samples every 0.005 s, 2 s long, peak 0.4000 g")
        );
        // The resolved scenario reads back.
        let resolved = stdout(&archrock(folder.path(), &["check", "s.toml"]));
        fs::write(folder.path().join("t.toml"), &resolved).unwrap();
        assert_eq!(
            stdout(&archrock(folder.path(), &["check", "t.toml"])),
            resolved
        );
        // The line after the verdict.
        outcomes.push(rest.lines().nth(1).unwrap().to_owned());
    }
    assert!(outcomes[0].contains("came to rest") || outcomes[0].contains("overturned"));
    assert!(
        outcomes.iter().all(|outcome| *outcome == outcomes[0]),
        "{outcomes:?}"
    );
}

#[test]
fn several_files_are_checked_at_once_and_one_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path());
    fs::write(folder.path().join("s.toml"), ARCH).unwrap();
    let check = |arguments: &[&str]| archrock(folder.path(), &[&["check"], arguments].concat());
    let two = [
        "g.AT2",
        "comma.csv",
        "--set",
        "unit=cm/s2",
        "--set",
        "decimal=comma",
        "--set",
        "skip_rows=3",
    ];
    let said = stdout(&check(&two));
    assert!(
        said.starts_with("g.AT2: ") && said.contains("\ncomma.csv: table"),
        "{said}"
    );
    // Keys that are ignored for a file with its own unit cause a warning.
    let output = check(&two);
    assert!(
        stderr(&output).contains("g.AT2: ignored `unit`"),
        "{}",
        stderr(&output)
    );
    // Without a table among the files the unit is theirs: 0.4 cm/s2.
    let output = check(&["g.AT2", "g.AT2", "--set", "unit=cm/s2"]);
    let said = stderr(&output);
    assert_eq!(
        said.matches("g.AT2 peaks at 4.07747e-4 g").count(),
        2,
        "{said}"
    );
    // For an AT2 file alone, other keys of tables are refused.
    let said = refusal(&check(&["g.AT2", "--set", "skip_rows=3"]));
    assert!(
        said.contains("--set skip_rows=3: `skip_rows = 3` applies to `format = \"csv\"` only"),
        "{said}"
    );
    let said = refusal(&check(&["single.csv"]));
    assert!(
        said.contains("single.csv: the record lacks `unit`: give one of \"g\""),
        "{said}"
    );
    assert!(said.contains("--set unit=cm/s2"), "{said}");
    let said = refusal(&check(&["single.csv", "--set", "unit=m/s2"]));
    assert!(
        said.contains("single.csv:2: there is no column 2"),
        "{said}"
    );
    // Valid files are described, and faulty ones are reported.
    let output = check(&["g.AT2", "none.at2", "s.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("none.at2: cannot be read"));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains("g.AT2: AT2") && said.contains("[arch]"),
        "{said}"
    );

    stdout(&check(&["g.AT2", "--plot", "r.svg"]));
    let picture = fs::read_to_string(folder.path().join("r.svg")).unwrap();
    let picture = roxmltree::Document::parse(&picture).unwrap();
    for name in ["acceleration", "velocity", "displacement", "arias"] {
        assert!(!named(&picture, name).is_empty(), "{name}");
    }
    stdout(&check(&["s.toml", "--plot", "s.svg"]));
    assert!(folder.path().join("s.svg").exists());
    let both = refusal(&check(&["g.AT2", "gal.at2", "--plot", "r.svg"]));
    assert!(both.contains("--plot takes one file"));
}

#[test]
fn a_record_in_the_place_of_a_scenario_is_one_error() {
    let folder = tempfile::tempdir().unwrap();
    files(folder.path());
    for ending in ["smc", "acc", "g3", "th"] {
        let file = format!("x.{ending}");
        fs::copy(folder.path().join("blanks.txt"), folder.path().join(&file)).unwrap();
        let said = refusal(&archrock(folder.path(), &["check", &file]));
        let words = "unknown record format; known: at2, asc, ";
        assert!(said.contains(words), "{said}");
        let read = ["check", &file, "--set", "format=csv", "--set", "unit=g"];
        let said = stdout(&archrock(folder.path(), &read));
        let columns = "table, accelerations in g from column 2, times from column 1\n  401 samples";
        assert!(said.contains(columns), "{said}");
    }
    for file in ["g.AT2", "esm.ASC", "comma.csv", "blanks.txt"] {
        let said = refusal(&archrock(folder.path(), &["run", file]));
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.contains("this is no scenario: "), "{said}");
        assert!(said.contains("[ground.record]"), "{said}");
    }
}

#[test]
fn unlikely_input_is_pointed_out() {
    let folder = tempfile::tempdir().unwrap();
    let pulse = "[ground.rectangular]\namplitude_g = 0.05\nduration_s = 0.2\n";
    let record = "[ground.record]\nfile = 'r.csv'\nunit = 'g'\n";
    for (name, text) in [
        ("r.csv", "0,0\n0.01,35\n0.02,0\n"),
        ("small.csv", "0,0\n0.01,0.35\n0.02,0\n"),
        (
            "offset.NS",
            "Sampling Freq(Hz) 100Hz\nScale Factor      1000(gal)/1000000\nMemo.\n5100 5200 5090\n5130 5130 5131\n",
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let usual = format!("{ARCH}{pulse}");
    for (text, warning) in [
        (
            usual.replace("= 5.0", "= 500"),
            Some("the mean radius is 500 m: is it in centimetres?"),
        ),
        (
            usual.replace("= 5.0", "= 50"),
            Some("the thickness is 7.5 m: is it in centimetres?"),
        ),
        (
            usual.replace("= 5.0", "= 5000"),
            Some("the mean radius is 5000 m: is it in millimetres?"),
        ),
        (
            format!("[column]\nheight_m = 4000\nwidth_m = 800\n{pulse}"),
            Some("the column measures 4000 m: is it in millimetres?"),
        ),
        (
            format!(
                "{ARCH}voussoirs = 8\n[piers]\nheight_m = 3000\nwidth_m = 2000\n[free_hinges]\n{pulse}"
            ),
            Some("the height of [piers] is 3000 m: is it in millimetres?"),
        ),
        (
            usual.replace("180.0", "3.14159"),
            Some("the embrace angle is 3.14159 degrees: is it in radians?"),
        ),
        (
            format!("{usual}[simulation]\ngravity_m_s2 = 981"),
            Some("gravity is 981 m/s2, not that of the Earth"),
        ),
        (
            format!("{ARCH}{record}"),
            Some("r.csv peaks at 35 g: is its unit \"g\"?"),
        ),
        (
            usual.replace("0.05", "-4"),
            Some("the pulse peaks at 4 g: is its amplitude in units of gravity?"),
        ),
        // A block of 4 by 0.08 m starts at 0.02 g.
        (
            format!(
                "[column]\nheight_m = 4\nwidth_m = 0.08\n{}",
                pulse.replace("0.05", "0.5")
            ),
            Some(
                "the pulse pushes the structure with 0.5 g, 25 times as much as starts it: is its amplitude in units of gravity?",
            ),
        ),
        // With a load on the left, 0.01 g starts the arch to the right and 0.19 g to the left, to which the ground pushes it.
        (
            format!(
                "{ARCH}voussoirs = 24\n[[load]]\nmass_kg = 4000\nx_m = -2\n[free_hinges]\n{}",
                pulse.replace("0.05", "0.3")
            ),
            None,
        ),
        (
            format!("{ARCH}{record}scale = 1e-5"),
            Some("r.csv peaks at 3.5e-4 g: is its unit \"g\", and `scale` 1e-5?"),
        ),
        (
            format!("{ARCH}{record}peak_g = 9.81"),
            Some("r.csv peaks at 9.81 g: is `peak_g` in units of gravity?"),
        ),
        (
            format!("{ARCH}[ground.record]\nfile = 'small.csv'\nunit = 'cm/s2'\n"),
            Some("small.csv peaks at 3.56779e-4 g: is its unit \"cm/s2\"?"),
        ),
        (
            format!("{ARCH}[ground.record]\nfile = 'offset.NS'\n"),
            Some(
                "offset.NS has a mean of 0.00523252 g, the offset of the instrument: give `baseline = \"mean\"`",
            ),
        ),
        // The default longest step is 3.4e-4 times the square root of size over gravity.
        (
            format!(
                "{}voussoirs = 7\n[free_hinges]\nlongest_step_s = 1e-3\n{pulse}\
                 [simulation]\nduration_s = 1e6\noutput_step_s = 1\n",
                ARCH
            ),
            Some(
                "the simulation lasts 1e6 s, some 1e9 steps of 1.0e-3 s: unless it rests or overturns before, they take about \
                 35 minutes, and some 0.1 GB of memory",
            ),
        ),
        (
            format!("{usual}[simulation]\nduration_s = 1e6\noutput_step_s = 1\n"),
            Some(
                "the simulation lasts 1e6 s: unless it rests or overturns before, that takes minutes or more",
            ),
        ),
        (usual, None),
    ] {
        fs::write(folder.path().join("s.toml"), &text).unwrap();
        for command in ["run", "check"] {
            let output = archrock(folder.path(), &[command, "s.toml"]);
            let said = stderr(&output);
            match warning {
                // A thin arch of three degrees is also refused.
                Some(_) if output.status.code() == Some(2) => {
                    assert!(text.contains("3.14159"), "{said}");
                    let remedy = "too thick for its embrace angle of 3.14159 degrees";
                    assert!(said.contains(remedy), "{said}");
                    assert!(said.contains("is it in radians, 180 degrees?"), "{said}");
                }
                Some(warning) => {
                    assert!(
                        said.contains(&format!("warning: {warning}")),
                        "{text}: {said}"
                    );
                    let quiet = archrock(folder.path(), &[command, "s.toml", "--quiet"]);
                    assert!(quiet.stderr.is_empty());
                }
                None => assert!(said.is_empty(), "{said}"),
            }
        }
    }
}

/// Scenarios that no run accepts, with the messages of `check`.
#[test]
fn check_finds_faults_that_run_refuses() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let pulse =
        "[ground.half_sine]\namplitude_g = 0.2\nduration_s = 0.4\n[simulation]\nduration_s = 1\n";
    let arch = format!("{ARCH}voussoirs = 11\n");
    let elastic = "[elastic_joints]\nnormal_stiffness_gpa_m = 10\n";
    let stone =
        "[column]\nheight_m = 2800\nwidth_m = 900\n[elastic_joints]\nstone_modulus_gpa = 1.3\n";
    for (text, words) in [
        (
            stone.to_owned(),
            "s.toml:5:21: `stone_modulus_gpa = 1.3` gives a joint `normal_stiffness_pa_m = 9.28571e5`, which must be a number from 1e6",
        ),
        (
            format!("{arch}{elastic}shear_stiffness_gpa_m = 1e5\n"),
            "s.toml:7:26: `normal_stiffness_gpa_m = 10` gives a joint `shear_ratio = 10000`",
        ),
        (
            format!(
                "{arch}[free_hinges]\n[supports]\nright = {{ spread_m = 0.01 }}\n[initial]\nsway = 'left'\nrotation_rad = 0.01\n"
            ),
            "s.toml:9:1: table `initial` cannot be combined with [supports]",
        ),
        (
            format!("title = nan\n{arch}"),
            "s.toml:1:9: `title = nan` is not finite; must be a string",
        ),
    ] {
        fs::write(at.join("s.toml"), format!("{text}{pulse}")).unwrap();
        for command in ["check", "run"] {
            let said = refusal(&archrock(at, &[command, "s.toml"]));
            assert!(said.contains(words), "{words}: {said}");
        }
    }
    // Limit analysis and free hinges take this arch, four links do not.
    let thick = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.25\nembrace_deg = 100\nvoussoirs = 7\n[free_hinges]\n";
    fs::write(at.join("s.toml"), format!("{thick}{pulse}")).unwrap();
    for command in ["impact", "capacity"] {
        let said = refusal(&archrock(at, &[command, "s.toml"]));
        assert!(said.starts_with("error: s.toml: "), "{said}");
        let remedy = "; `limit` and [free_hinges] take any mechanism of voussoirs";
        assert!(said.contains(remedy), "{said}");
    }
    // Soft joints that would not carry the arch on the Earth do so under less gravity.
    let soft = format!("{arch}[elastic_joints]\nnormal_stiffness_gpa_m = 0.0015\n{pulse}");
    fs::write(at.join("s.toml"), &soft).unwrap();
    let said = refusal(&archrock(at, &["run", "s.toml"]));
    assert!(said.contains("with joints as soft as these"), "{said}");
    fs::write(at.join("s.toml"), format!("{soft}gravity_m_s2 = 0.07\n")).unwrap();
    for command in ["check", "run"] {
        stdout(&archrock(at, &[command, "s.toml"]));
    }
}

/// If weights differ by more than floating point can resolve, the error says so; otherwise there is no error.
#[test]
fn blocks_too_unlike_in_weight_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let text = |density: &str| {
        format!(
            "[pointed_arch]\nspan_m = 6.0\nrise_m = 5.2\nthickness_m = 0.5\nvoussoirs = 40\n\
             density_kg_m3 = {density}\n[piers]\nheight_m = 2\nwidth_m = 30\ndensity_kg_m3 = 2000\n\
             [free_hinges]\n[ground.one_sine]\namplitude_g = 2\nduration_s = 0.1\n[simulation]\nduration_s = 0.5\n"
        )
    };
    let run = |density: &str| {
        fs::write(folder.path().join("s.toml"), text(density)).unwrap();
        archrock(
            folder.path(),
            &["run", "s.toml", "--no-repeat", "--no-report"],
        )
    };
    let output = run("0.001");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let said = stderr(&output);
    assert!(said.contains("use more similar weights"), "{said}");
    stdout(&run("200"));
}

#[test]
fn linear_ranges_have_round_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{ARCH}[ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.3\n\
         [map]\nthickness_ratio = {{ from = 0.11, to = 0.2, count = 10 }}\n\
         amplitude_g = {{ from = -0.3, to = 0.3, count = 7 }}\n"
    );
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let output = archrock(folder.path(), &["map", "s.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = fs::read_to_string(folder.path().join("results/s/map.csv")).unwrap();
    let column = |index: usize| {
        let mut values: Vec<&str> = table
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(index).unwrap())
            .collect();
        values.dedup();
        values
    };
    assert_eq!(
        column(0),
        [
            "0.11", "0.12", "0.13", "0.14", "0.15", "0.16", "0.17", "0.18", "0.19", "0.2"
        ]
    );
    assert_eq!(
        column(1)[..7],
        ["-0.3", "-0.2", "-0.1", "0.0", "0.1", "0.2", "0.3"]
    );
}

#[test]
fn the_name_of_a_column_gives_the_unit_of_times() {
    let folder = tempfile::tempdir().unwrap();
    let table = |names: &str, times: [u32; 4]| {
        let rows = times.iter().zip([0.0, 2.0, -1.0, 0.0]);
        let rows: String = rows.map(|(time, a)| format!("{time},{a}\n")).collect();
        fs::write(folder.path().join("r.csv"), format!("{names}{rows}")).unwrap();
        archrock(folder.path(), &["check", "r.csv", "--set", "unit=m/s2"])
    };
    for (names, times, step) in [
        ("time_ms,acc\n", [0, 10, 20, 30], "every 0.01 s"),
        ("t [ms],a\n", [0, 10, 20, 30], "every 0.01 s"),
        ("Time (msec),a\n", [0, 10, 20, 30], "every 0.01 s"),
        ("t_us,a\n", [0, 5000, 10_000, 15_000], "every 0.005 s"),
        ("time_s,a\n", [0, 10, 20, 30], "every 10 s"),
        // The letters are part of a word.
        ("items,a\n", [0, 1, 2, 3], "every 1 s"),
        ("", [0, 10, 20, 30], "every 10 s"),
    ] {
        let output = table(names, times);
        let warnings = stderr(&output);
        assert!(stdout(&output).contains(step), "{names}");
        let asks = "r.csv has a sample every ";
        assert_eq!(
            warnings.contains(asks),
            !step.contains("0.0"),
            "{names}: {warnings}"
        );
        assert!(!warnings.contains(asks) || warnings.contains("are its times in milliseconds?"));
    }
    // The step of a key is checked as well.
    fs::write(folder.path().join("one.csv"), "0\n1\n0\n").unwrap();
    let arguments = ["check", "one.csv", "--set", "unit=m/s2", "--set", "dt_s=5"];
    let said = stderr(&archrock(folder.path(), &arguments));
    assert!(said.contains("a sample every 5 s"), "{said}");
}

#[test]
fn an_unlikely_peak_raises_a_warning_about_the_unit() {
    let folder = tempfile::tempdir().unwrap();
    for (peak, asks) in [(0.09, true), (0.1, false), (29.0, false), (30.0, true)] {
        fs::write(
            folder.path().join("r.csv"),
            format!("0,0\n0.01,{peak}\n0.02,0\n"),
        )
        .unwrap();
        let output = archrock(folder.path(), &["check", "r.csv", "--set", "unit=m/s2"]);
        let warnings = stderr(&output);
        assert_eq!(
            warnings.contains("is its unit \"m/s2\"?"),
            asks,
            "{peak}: {warnings}"
        );
    }
}

#[test]
fn a_damaged_first_number_is_no_name_of_a_column() {
    let folder = tempfile::tempdir().unwrap();
    let check = |first: &str, more: &[&str]| {
        fs::write(
            folder.path().join("r.csv"),
            format!("{first}\n1.0\n-1.0\n0.5\n"),
        )
        .unwrap();
        let arguments = ["check", "r.csv", "--set", "unit=m/s2", "--set", "dt_s=0.01"];
        archrock(folder.path(), &[&arguments[..], more].concat())
    };
    for damaged in [
        "0.0O12", "1.2.3", "-0.0l", "nan", "inf", "***", "1e", "+0.5E-",
    ] {
        for more in [&[][..], &["--set", "wrapped=true"]] {
            let said = refusal(&check(damaged, more));
            assert!(said.contains("r.csv:1:"), "{damaged}: {said}");
            assert!(
                said.contains("numbers begin on line 2"),
                "{damaged}: {said}"
            );
        }
    }
    for name in ["acceleration", "a (m/s2)", "Acc. NS", "\"a\"", "acc_10Hz"] {
        let said = stdout(&check(name, &[]));
        assert!(said.contains("3 samples"), "{name}: {said}");
    }
}
