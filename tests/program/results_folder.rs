//! A results folder holds one scenario: its lock, the files that a command removes and keeps, and its warnings.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Child;
use std::thread::sleep;
use std::time::Duration;

use archrock::studies::StudyKind;
use archrock::studies::{UNCERTAIN, UNCERTAIN_SUITE, UNCERTAIN_THRESHOLD};

use crate::common::program::{
    RUN_FILES, archrock, command, names, refused, result_names, scenarios, stderr,
};
use crate::common::results::json;

/// A column that overturns at once under a strong pulse, and stands still under a weak one.
fn column(amplitude_g: f64, samples: usize) -> String {
    format!(
        "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[ground.one_sine]\namplitude_g = {amplitude_g}\nduration_s = 0.5\n\
         [simulation]\nduration_s = 2.0\n[uncertain]\nsamples = {samples}\n\
         \"ground.one_sine.amplitude_g\" = {{ deviation = 0.01 }}\n"
    )
}

/// All files below a folder, as paths relative to it.
fn below(folder: &Path) -> Vec<String> {
    let mut all = Vec::new();
    for name in names(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            let inner = below(&path).into_iter();
            all.extend(inner.map(|inner| format!("{name}/{inner}")));
        } else {
            all.push(name);
        }
    }
    all
}

#[track_caller]
fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = archrock(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    stderr(&output)
}

/// Asserts that all results in a folder are sealed and come from a pulse of this amplitude.
#[track_caller]
fn assert_all_come_from(folder: &Path, amplitude_g: f64) {
    let of = |summary: &str| {
        json(&folder.join(summary))["scenario"]["ground"]["one_sine"]["amplitude_g"].clone()
    };
    assert_eq!(of("summary.json"), amplitude_g);
    let mut summaries = below(folder);
    summaries.retain(|name| name.ends_with(".json") && name != "archrock.json");
    for seal in summaries {
        assert_eq!(of(&seal), amplitude_g, "{seal}");
    }
}

/// Starts a run with samples that takes minutes, and waits until some of its samples are computed.
fn long_run(at: &Path, out: &str) -> Child {
    fs::write(at.join("long.toml"), column(0.9, 60_000)).unwrap();
    let arguments = [
        "run",
        "long.toml",
        "--hinges",
        "free",
        "--threads",
        "1",
        "--quiet",
        "--out",
        out,
    ];
    let mut run = command(at, &arguments).spawn().unwrap();
    let part = at.join(out).join("uncertain/uncertain.part");
    while fs::metadata(&part).map_or(0, |part| part.len()) < 3000 {
        assert!(run.try_wait().unwrap().is_none(), "the run is too short");
        sleep(Duration::from_millis(10));
    }
    run
}

#[test]
fn a_run_locks_its_folder_and_all_below_until_its_samples_are_done() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("weak.toml"), column(0.05, 4)).unwrap();
    succeeds(at, &["run", "weak.toml", "--out", "o/inner", "--quiet"]);
    let mut run = long_run(at, "o");
    let visible = || -> Vec<String> {
        let all = below(&at.join("o")).into_iter();
        all.filter(|name| !name.contains(".archrock-")).collect()
    };
    let before = visible();
    for out in ["o", "o/inner", "o/uncertain", "o/new/folder"] {
        for command in ["run", "threshold"] {
            let second = archrock(at, &[command, "weak.toml", "--out", out]);
            assert_eq!(second.status.code(), Some(2), "{command} {out}");
            let said = stderr(&second);
            assert!(
                said.contains("is being written to by another run"),
                "{said}"
            );
        }
    }
    // A folder beside it is free.
    succeeds(at, &["run", "weak.toml", "--out", "p/inner", "--quiet"]);
    assert_eq!(visible(), before);
    run.kill().unwrap();
    run.wait().unwrap();
    // Nor is a folder locked around one that is being written to.
    let mut inner = long_run(at, "q/inner");
    let second = archrock(at, &["run", "weak.toml", "--out", "q"]);
    assert_eq!(second.status.code(), Some(2));
    inner.kill().unwrap();
    inner.wait().unwrap();
}

#[test]
fn a_run_removes_all_results_of_the_last_run_of_its_command() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("strong.toml"), column(0.9, 4)).unwrap();
    fs::write(at.join("weak.toml"), column(0.05, 4)).unwrap();
    let films = ["--film", "20", "--snapshots", "0.1", "--poses", "--quiet"];
    for first in [&["--hinges", "four,free"][..], &["--hinges", "free"], &[]] {
        let strong = [&["run", "strong.toml", "--out", "o"], first, &films].concat();
        succeeds(at, &strong);
        assert!(below(&at.join("o")).len() > 20);
        // The results of the scenario itself are written after those of its samples.
        let list = json(&at.join("o/archrock.json"));
        let files = list["results"]["run"]["files"].as_array().unwrap();
        let two = first.contains(&"four,free");
        assert_eq!(
            files.last().unwrap(),
            if two {
                "models/peaks.json"
            } else {
                "summary.json"
            }
        );
        fs::create_dir_all(at.join("o/film")).unwrap();
        fs::write(at.join("o/film/notes.txt"), "mine").unwrap();
        fs::write(at.join("o/uncertain.txt"), "mine").unwrap();
        let weak = [
            "run",
            "weak.toml",
            "--no-uncertain",
            "--out",
            "o",
            "--quiet",
        ];
        succeeds(at, &weak);
        let kept = ["film/notes.txt", "uncertain.txt", "archrock.json"].map(str::to_owned);
        let mut left = below(&at.join("o"));
        left.retain(|name| !kept.contains(name));
        assert_eq!(left, RUN_FILES, "{first:?}");
        assert_all_come_from(&at.join("o"), 0.05);
        assert!(kept.iter().all(|name| at.join("o").join(name).exists()));
    }
    // A run that fails leaves the last results unchanged.
    let before = below(&at.join("o"));
    let wrong = archrock(at, &["run", "weak.toml", "--point", "90,90", "--out", "o"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert_eq!(below(&at.join("o")), before);
    // Results that were written to a subfolder by a run of their own are not those of this folder.
    succeeds(at, &["run", "strong.toml", "--out", "o/four", "--quiet"]);
    succeeds(at, &["run", "weak.toml", "--out", "o", "--quiet"]);
    assert_all_come_from(&at.join("o/four"), 0.9);
}

#[test]
fn a_suite_removes_the_records_of_the_last_suite() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    for name in ["a.csv", "b.csv", "c.csv"] {
        fs::write(at.join(name), "0.0,0.0\n0.2,1.0\n0.4,-1.0\n0.6,0.0\n").unwrap();
    }
    let suite = |records: &str| {
        let text = format!(
            "[column]\nheight_m = 4\nwidth_m = 0.8\n[simulation]\nduration_s = 1\n\
             [suite]\nrecords = {records}\nunit = 'm/s2'\npeaks_g = [0.1]\n"
        );
        fs::write(at.join("s.toml"), text).unwrap();
    };
    for command in ["run", "threshold"] {
        suite("['a.csv', 'b.csv']");
        succeeds(
            at,
            &[command, "s.toml", "--suite", "--out", command, "--quiet"],
        );
        assert_eq!(result_names(&at.join(command)), ["a.csv", "b.csv"]);
        // A folder that is no result of a record stays, whatever its name.
        fs::create_dir(at.join(command).join("mine.csv")).unwrap();
        suite("['b.csv', 'c.csv']");
        succeeds(
            at,
            &[command, "s.toml", "--suite", "--out", command, "--quiet"],
        );
        assert_eq!(
            result_names(&at.join(command)),
            ["b.csv", "c.csv", "mine.csv"]
        );
    }
}

/// Two scenario files of one name have their records in one folder, which the command locks once.
#[test]
fn scenario_files_of_one_name_share_a_folder() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    for name in ["a", "b"] {
        fs::create_dir(at.join(name)).unwrap();
        let record = at.join(name).join(format!("{name}.csv"));
        fs::write(record, "0.0,0.0\n0.2,1.0\n0.4,-1.0\n0.6,0.0\n").unwrap();
        let text = format!(
            "[column]\nheight_m = 4\nwidth_m = 0.8\n[simulation]\nduration_s = 1\n\
             [suite]\nrecords = ['{name}.csv']\nunit = 'm/s2'\npeaks_g = [0.1]\n"
        );
        fs::write(at.join(name).join("x.toml"), text).unwrap();
    }
    let files = ["a/x.toml", "b/x.toml"];
    succeeds(
        at,
        &[
            "run", files[0], files[1], "--suite", "--out", "o", "--quiet",
        ],
    );
    assert_eq!(result_names(&at.join("o/x")), ["a.csv", "b.csv"]);
}

/// The inputs of all scenarios that share a folder are safe.
#[test]
fn no_scenario_of_a_shared_folder_loses_its_record() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let scenario = |name: &str, record: &str| {
        fs::create_dir_all(at.join(name)).unwrap();
        let text = format!(
            "[column]\nheight_m = 4\nwidth_m = 0.8\n[simulation]\nduration_s = 1\n\
             [suite]\nrecords = ['{record}']\nunit = 'm/s2'\npeaks_g = [0.1]\ntime_column = 1\nacceleration_column = 2\n"
        );
        fs::write(at.join(name).join("x.toml"), text).unwrap();
    };
    for name in ["a", "b"] {
        scenario(name, &format!("{name}.csv"));
        let record = at.join(name).join(format!("{name}.csv"));
        fs::write(record, "0.0,0.0\n0.2,1.0\n0.4,-1.0\n0.6,0.0\n").unwrap();
    }
    let both = [
        "run", "a/x.toml", "b/x.toml", "--suite", "--out", "o", "--quiet",
    ];
    succeeds(at, &both);
    let result = at.join("o/x/a.csv/rotations.csv");
    let before = fs::read(&result).unwrap();
    // The second scenario now reads a result of the first one.
    scenario("b", "../o/x/a.csv/rotations.csv");
    refused(
        at,
        &both,
        &["o/x/a.csv/rotations.csv is an input of the scenario"],
    );
    assert_eq!(fs::read(&result).unwrap(), before);
}

/// Samples are computed for long: they stay when the history of their scenario fails, and another scenario succeeds.
#[test]
fn samples_of_a_failed_scenario_are_kept() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let long = column(0.3, 16).replace(
        "duration_s = 2.0",
        "duration_s = 2.0\noutput_step_s = 0.0001",
    );
    fs::write(at.join("long.toml"), long).unwrap();
    fs::write(at.join("short.toml"), column(0.3, 16)).unwrap();
    // The rotations of the first scenario are longer than the largest file.
    let limited =
        "trap '' XFSZ; ulimit -f 512; exec \"$0\" run long.toml short.toml --no-report --out o";
    let output = std::process::Command::new("sh")
        .current_dir(at)
        .args(["-c", limited, env!("CARGO_BIN_EXE_archrock")])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(at.join("o/short/summary.json").exists());
    assert!(at.join("o/long/uncertain/uncertain.part").exists());
    assert!(!at.join("o/short/uncertain/uncertain.part").exists());
}

/// A file that no command wrote is in the way of a comparison before anything is computed.
#[test]
fn a_foreign_file_in_the_folder_of_a_comparison_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), column(0.3, 8)).unwrap();
    fs::create_dir_all(at.join("o/models")).unwrap();
    fs::write(at.join("o/models/peaks.svg"), "mine").unwrap();
    let models = ["run", "s.toml", "--hinges", "four,free", "--out", "o"];
    refused(at, &models, &["o/models/peaks.svg is there"]);
    assert_eq!(names(&at.join("o")), ["models"]);
}

#[test]
fn a_part_without_a_folder_is_refused() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), column(0.4, 64)).unwrap();
    let part = ["run", "s.toml", "--shard", "1/2", "--format", "json"];
    let output = archrock(root.path(), &part);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(output.stdout.is_empty() && stderr(&output).contains("--out"));
}

/// Runs of two scenarios are killed at many instants. A folder then has the results of one of them, or none that are sealed.
#[test]
fn after_a_kill_a_folder_holds_one_scenario() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("strong.toml"), column(0.9, 40)).unwrap();
    fs::write(at.join("weak.toml"), column(0.05, 40)).unwrap();
    let strong = [
        "run",
        "strong.toml",
        "--hinges",
        "four,free",
        "--film",
        "20",
        "--out",
        "o",
        "--quiet",
    ];
    let weak = [
        "run",
        "weak.toml",
        "--no-uncertain",
        "--out",
        "o",
        "--quiet",
    ];
    let begun = std::time::Instant::now();
    succeeds(at, &strong);
    let whole = begun.elapsed();
    for turn in 1..=8_u32 {
        let mut run = command(at, &strong).spawn().unwrap();
        sleep(whole.mul_f64(f64::from(turn) / 8.0));
        run.kill().unwrap();
        run.wait().unwrap();
        succeeds(at, &weak);
        assert_all_come_from(&at.join("o"), 0.05);
        let left = below(&at.join("o"));
        // Rows of samples are never lost; they are no results.
        let others: Vec<_> = left
            .iter()
            .filter(|name| name.contains('/') && !name.ends_with(".part"))
            .collect();
        assert!(others.is_empty(), "{others:?}");
        for model in ["four", "free"] {
            let _ = fs::remove_file(at.join(format!("o/{model}/uncertain/uncertain.part")));
        }
    }
}

#[test]
fn results_of_other_commands_stay_with_a_warning_for_other_scenarios() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let table = |peak: f64| format!("0.0,0.0\n0.2,{peak}\n0.4,-{peak}\n0.6,0.0\n");
    fs::write(at.join("a.csv"), table(1.0)).unwrap();
    let scenario = |width_m: f64| {
        let text = format!(
            "[column]\nheight_m = 4\nwidth_m = {width_m}\n[ground.record]\nfile = 'a.csv'\nunit = 'm/s2'\n\
             [simulation]\nduration_s = 2\n[suite]\nrecords = ['a.csv']\nunit = 'm/s2'\npeaks_g = [0.1]\n\
             [uncertain]\nsamples = 2\n'column.height_m' = {{ deviation = 0.01 }}\n"
        );
        fs::write(at.join("s.toml"), text).unwrap();
    };
    scenario(0.8);
    let quick = ["--from", "1", "--to", "2", "--stride", "0.5"];
    let commands: [(&[&str], &str, StudyKind); 3] = [
        (&["run", "s.toml", "--out", "o"], "summary.json", UNCERTAIN),
        (
            &["threshold", "s.toml", "--out", "o"],
            "threshold.json",
            UNCERTAIN_THRESHOLD,
        ),
        (
            &["suite", "s.toml", "--out", "o"],
            "suite.csv",
            UNCERTAIN_SUITE,
        ),
    ];
    let line = |arguments: &[&'static str]| -> Vec<&'static str> {
        let more = if arguments[0] == "threshold" {
            &quick[..]
        } else {
            &[]
        };
        [arguments, more].concat()
    };
    // The scenario is the same, whatever the model of motion and with or without samples.
    for more in [&[][..], &["--hinges", "free"], &["--no-uncertain"]] {
        for (arguments, ..) in commands {
            let said = succeeds(at, &[&line(arguments)[..], more].concat());
            assert!(!said.contains("another scenario"), "{said}");
        }
    }
    let all = commands.map(|(arguments, ..)| line(arguments));
    for arguments in &all {
        succeeds(at, arguments);
    }
    for ((_, seal, kind), arguments) in commands.iter().zip(&all) {
        assert!(at.join("o").join(seal).exists());
        let samples = at.join("o").join(kind.name);
        let mut expected: Vec<_> = kind.files.to_vec();
        expected.sort_unstable();
        assert_eq!(names(&samples), expected);
        // A command removes all of its own files, and no others.
        let others = |name: &&String| !name.starts_with(&format!("{}/", kind.name));
        let before = below(&at.join("o"));
        succeeds(at, &[&arguments[..], &["--no-uncertain"]].concat());
        assert!(!samples.exists());
        assert!(below(&at.join("o")).iter().eq(before.iter().filter(others)));
    }
    scenario(0.9);
    let said = succeeds(at, &all[0]);
    for other in ["threshold", "suite"] {
        let warning = format!(
            "warning: o holds results of `archrock {other}` from another scenario: [column] differs"
        );
        assert!(said.contains(&warning), "{said}");
    }
    assert!(at.join("o/threshold.json").exists() && at.join("o/suite.csv").exists());
    // A record with other contents makes another scenario.
    fs::write(at.join("a.csv"), table(1.5)).unwrap();
    let said = succeeds(at, &all[1]);
    let warning = "results of `archrock run` from another scenario: the contents of a.csv differ";
    assert!(said.contains(warning), "{said}");
}

/// A comparison of models belongs to the command that made it.
#[test]
fn comparisons_of_models_do_not_replace_one_another() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("a.csv"), "0.0,0.0\n0.2,2.0\n0.4,-2.0\n0.6,0.0\n").unwrap();
    let text =
        column(0.4, 8) + "[suite]\nrecords = ['a.csv']\nunit = 'm/s2'\npeaks_g = [0.1, 0.3]\n";
    fs::write(at.join("s.toml"), text).unwrap();
    let models = ["--hinges", "four,free", "--out", "o", "--quiet"];
    succeeds(at, &[&["suite", "s.toml"][..], &models].concat());
    let of_suite = fs::read(at.join("o/models/peaks.json")).unwrap();
    succeeds(
        at,
        &[
            &["run", "s.toml", "--no-report", "--no-repeat"][..],
            &models,
        ]
        .concat(),
    );
    assert_eq!(fs::read(at.join("o/models/peaks.json")).unwrap(), of_suite);
    assert!(at.join("o/models_run/peaks.json").exists() && at.join("o/four/suite.csv").exists());
    succeeds(
        at,
        &["run", "s.toml", "--no-uncertain", "--out", "o", "--quiet"],
    );
    assert!(!at.join("o/models_run").exists() && !at.join("o/four/summary.json").exists());
    assert!(at.join("o/models/peaks.json").exists() && at.join("o/four/suite.csv").exists());
}

/// A suite of these records of a structure that overturns at once.
fn suite(at: &Path, name: &str, records: &[&str], width_m: f64) {
    for record in records {
        fs::write(at.join(record), "0.0,0.0\n0.2,3.0\n0.4,-3.0\n0.6,0.0\n").unwrap();
    }
    let text = format!(
        "[column]\nheight_m = 4\nwidth_m = {width_m}\n[simulation]\nduration_s = 1\n\
         [suite]\nrecords = {records:?}\nunit = 'm/s2'\npeaks_g = [0.1]\n"
    );
    fs::write(at.join(name), text).unwrap();
}

/// All files below a folder with their contents.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let all = below(folder).into_iter();
    all.map(|name| (name.clone(), fs::read(folder.join(&name)).unwrap()))
        .collect()
}

/// Blocks whose joints are in a file with the name of a result of free hinges.
#[test]
fn no_result_replaces_or_removes_an_input() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let table = scenarios().join("straight-sided-voussoirs.csv");
    let table = fs::read_to_string(table).unwrap();
    fs::write(at.join("joints.csv"), &table).unwrap();
    let text = "[blocks]\njoints = 'joints.csv'\n[ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.1\n\
                [simulation]\nduration_s = 0.2\n";
    fs::write(at.join("s.toml"), text).unwrap();
    let run = |hinges: &'static str| {
        let options = ["--hinges", hinges, "--no-report", "--quiet"];
        [&["run", "s.toml", "--out", "."][..], &options].concat()
    };
    let before = contents(at);
    refused(
        at,
        &run("free"),
        &["joints.csv is an input of the scenario", "--out"],
    );
    assert_eq!(contents(at), before);
    succeeds(at, &run("four"));
    assert_eq!(fs::read_to_string(at.join("joints.csv")).unwrap(), table);
    // Also if an earlier run wrote a file of that name.
    fs::rename(at.join("joints.csv"), at.join("input.csv")).unwrap();
    fs::write(at.join("s.toml"), text.replace("joints.csv", "input.csv")).unwrap();
    succeeds(at, &run("free"));
    fs::write(at.join("s.toml"), text).unwrap();
    fs::write(at.join("joints.csv"), &table).unwrap();
    let before = contents(at);
    for hinges in ["four", "free"] {
        refused(
            at,
            &run(hinges),
            &["joints.csv is an input of the scenario", "--out"],
        );
        assert_eq!(contents(at), before);
    }
    // Files that an option names.
    for (line, words) in [
        (
            &["limit", "s.toml", "--plot", "plain"][..],
            "did not write it",
        ),
        (&["impact", "s.toml", "--line", "plain"], "did not write it"),
        (
            &["impact", "s.toml", "--line", "s.toml"],
            "did not write it",
        ),
        (
            &["impact", "s.toml", "--line", "input.csv"],
            "did not write it",
        ),
    ] {
        fs::write(at.join("plain"), "my notes on archrock").unwrap();
        refused(at, line, &[words, "choose another file with"]);
    }
    for line in [
        ["limit", "s.toml", "--plot", "l.svg"],
        ["impact", "s.toml", "--line", "l.csv"],
    ] {
        for _ in 0..2 {
            let output = archrock(at, &line);
            assert!(output.status.success(), "{}", stderr(&output));
        }
    }
    let again = [
        "limit",
        "s.toml",
        "--plot",
        "l.svg",
        "--figure-width",
        "85mm",
    ];
    assert!(archrock(at, &again).status.success());
}

/// The list of a folder names the files of each command; others stay, such as results of earlier versions, which have no list.
#[test]
fn files_that_no_list_names_are_not_replaced() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    suite(at, "s.toml", &["wave-1.at2.csv"], 0.8);
    suite(at, "other.toml", &["b.csv"], 0.8);
    let run = ["run", "s.toml", "--suite", "--out", "o", "--quiet"];
    succeeds(at, &run);
    let list = json(&at.join("o/archrock.json"));
    let results = &list["results"]["run"];
    assert_eq!(results["complete"], true);
    let listed = results["files"].as_array().unwrap().iter();
    let mut listed: Vec<_> = listed.filter_map(|name| name.as_str()).collect();
    listed.sort_unstable();
    let mut found = below(&at.join("o"));
    found.retain(|name| name != "archrock.json");
    assert_eq!(listed, found);
    fs::remove_file(at.join("o/archrock.json")).unwrap();
    let before = contents(&at.join("o"));
    let remedy = "move what is there, or choose another folder with --out";
    refused(
        at,
        &run,
        &[
            "o/wave-1.at2.csv/",
            "archrock.json does not list it",
            remedy,
        ],
    );
    assert_eq!(contents(&at.join("o")), before);
    // The folder of a record of another scenario stays.
    succeeds(
        at,
        &["run", "other.toml", "--suite", "--out", "o", "--quiet"],
    );
    let mut after = contents(&at.join("o"));
    after.retain(|(name, _)| name.starts_with("wave"));
    assert_eq!(after, before);
    // A study says so before it computes anything.
    fs::write(at.join("o/suite.csv"), "mine").unwrap();
    refused(
        at,
        &["suite", "s.toml", "--out", "o"],
        &["o/suite.csv is there", "`archrock suite`", remedy],
    );
    assert!(!at.join("o/suite.part").exists());
    // A file named as the list is no list.
    fs::write(at.join("archrock.json"), "{}").unwrap();
    refused(
        at,
        &["suite", "s.toml", "--out", "."],
        &["does not list results", remedy],
    );
}

/// Two commands never write a file of one name into one folder.
#[test]
fn each_result_has_the_name_of_one_command() {
    let mut kinds = StudyKind::ALL.to_vec();
    // Samples have a folder of their own.
    kinds.retain(|kind| !kind.name.starts_with("uncertain"));
    for (index, kind) in kinds.iter().enumerate() {
        for other in &kinds[index + 1..] {
            let both = kind.files.iter().find(|file| other.files.contains(file));
            assert_eq!(both, None, "{} {}", kind.name, other.name);
        }
    }
    // A map of samples has some names of a map, so the two are not merged into one folder.
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let map = "[map]\namplitude_g = [0.2, 0.4]\nduration_s = [0.2, 0.3]\n";
    let text = column(0.4, 2).replace("\"ground.one_sine.amplitude_g\"", "\"column.height_m\"");
    fs::write(at.join("s.toml"), text + map).unwrap();
    succeeds(at, &["map", "s.toml", "--no-uncertain", "--out", "o"]);
    succeeds(at, &["map", "s.toml", "--shard", "1/2", "--out", "p"]);
    succeeds(at, &["map", "s.toml", "--shard", "2/2", "--out", "p"]);
    let before = contents(&at.join("o"));
    let parts = ["1", "2"].map(|part| format!("p/uncertain_map/uncertain_map-{part}-of-2.part"));
    let merge = ["merge", &parts[0], &parts[1], "--out", "o"];
    refused(
        at,
        &merge,
        &["o/map.svg is there", "choose another folder with --out"],
    );
    assert_eq!(contents(&at.join("o")), before);
}

/// Results of a suite are replaced together, by `run` and by `threshold`. A killed suite leaves the last ones, and its hidden files only until
/// the next run.
#[test]
fn a_killed_suite_leaves_the_last_results() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    for command_name in ["run", "threshold"] {
        let line = [
            command_name,
            "s.toml",
            "--suite",
            "--out",
            command_name,
            "--quiet",
        ];
        suite(at, "s.toml", &["a.csv", "b.csv"], 0.8);
        succeeds(at, &line);
        let out = at.join(command_name);
        let before = contents(&out);
        // The last record takes long.
        let mut slow = "0.0,0.0\n".to_owned();
        for index in 1..50_000 {
            let acceleration = (f64::from(index) * 0.2).sin() * 4.0;
            slow += &format!("{},{acceleration}\n", f64::from(index) * 0.01);
        }
        suite(at, "s.toml", &["a.csv", "b.csv", "c.csv"], 0.9);
        fs::write(at.join("c.csv"), slow).unwrap();
        let text = fs::read_to_string(at.join("s.toml")).unwrap();
        fs::write(
            at.join("s.toml"),
            text.replace("duration_s = 1", "duration_s = 510"),
        )
        .unwrap();
        let mut killed = command(at, &line).spawn().unwrap();
        let hidden = || {
            let names = names(&out).into_iter();
            names.filter(|name| name.starts_with(".archrock-")).count()
        };
        // `run` opens the files of a record before its history, `threshold` after it.
        let of_two = if command_name == "run" { 13 } else { 6 };
        while hidden() < of_two {
            assert!(
                killed.try_wait().unwrap().is_none(),
                "the suite is too short"
            );
            sleep(Duration::from_millis(2));
        }
        killed.kill().unwrap();
        killed.wait().unwrap();
        assert!(hidden() > 0);
        let mut after = contents(&out);
        after.retain(|(name, _)| !name.starts_with(".archrock-"));
        assert_eq!(after, before);
        suite(at, "s.toml", &["a.csv", "b.csv"], 0.8);
        succeeds(at, &line);
        assert_eq!(contents(&out), before);
    }
}

/// A folder in the place of a result, which no file can replace, costs neither the earlier results nor a computation.
#[test]
fn a_result_that_cannot_be_replaced_loses_nothing() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("strong.toml"), column(0.9, 4)).unwrap();
    fs::write(at.join("weak.toml"), column(0.05, 4)).unwrap();
    succeeds(at, &["run", "strong.toml", "--out", "o", "--quiet"]);
    fs::remove_file(at.join("o/events.csv")).unwrap();
    fs::create_dir(at.join("o/events.csv")).unwrap();
    fs::write(at.join("o/events.csv/x"), "mine").unwrap();
    let before = contents(&at.join("o"));
    let weak = ["run", "weak.toml", "--out", "o"];
    refused(at, &weak, &["o/events.csv is not a file", "--out"]);
    assert_eq!(contents(&at.join("o")), before);
    fs::remove_dir_all(at.join("o/events.csv")).unwrap();
    succeeds(at, &weak);
    assert_all_come_from(&at.join("o"), 0.05);
}

/// A folder in which one record of a suite fails keeps the earlier results of all.
#[test]
fn a_suite_with_a_failing_record_publishes_nothing() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    suite(at, "s.toml", &["a.csv", "b.csv"], 0.8);
    succeeds(at, &["run", "s.toml", "--suite", "--out", "o", "--quiet"]);
    let before = contents(&at.join("o"));
    // The rotations of the second record are longer than the largest file.
    let text = fs::read_to_string(at.join("s.toml")).unwrap();
    let text = text.replace("duration_s = 1", "output_step_s = 0.001");
    fs::write(at.join("s.toml"), text).unwrap();
    let long: String = (0..200).map(|s| format!("{s},{}\n", s % 2)).collect();
    fs::write(at.join("b.csv"), long).unwrap();
    let limited =
        "trap '' XFSZ; ulimit -f 4096; exec \"$0\" run s.toml --suite --no-report --out o --quiet";
    let output = std::process::Command::new("sh")
        .current_dir(at)
        .args(["-c", limited, env!("CARGO_BIN_EXE_archrock")])
        .output()
        .unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.starts_with("error: s.toml, b.csv: cannot write"),
        "{said}"
    );
    assert!(said.contains("error: o: nothing was published"), "{said}");
    let (hidden, shown): (Vec<_>, Vec<_>) = contents(&at.join("o"))
        .into_iter()
        .partition(|(name, _)| name.starts_with(".archrock-"));
    assert_eq!(shown, before);
    assert!(
        hidden
            .iter()
            .all(|(name, _)| said.contains(&format!("o/{name}")))
    );
    let of_first = |name: &str| {
        let prefix = format!(".archrock-a.csv-{name}-");
        let mut found = hidden.iter().filter(|(name, _)| name.starts_with(&prefix));
        found
            .next()
            .map_or_else(Vec::new, |(_, contents)| contents.clone())
    };
    assert!(of_first("rotations.csv").len() > 10_000);
    assert_eq!(hidden.len(), RUN_FILES.len() - 1, "{said}");
    assert!(of_first("summary.json").starts_with(b"{"));
}

/// Signals that end the program wait while results get their names.
#[test]
fn a_signal_never_leaves_an_incomplete_seal() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("strong.toml"), column(0.9, 4)).unwrap();
    fs::write(at.join("weak.toml"), column(0.05, 4)).unwrap();
    let run = |name| {
        let options = ["--film", "50", "--no-report", "--quiet", "--out", "o"];
        command(at, &[&["run", name][..], &options].concat())
    };
    let begun = std::time::Instant::now();
    assert!(run("strong.toml").status().unwrap().success());
    let whole = begun.elapsed();
    let mut ended = 0;
    for (turn, signal) in (0..30_u32).zip(["-INT", "-TERM", "-HUP"].into_iter().cycle()) {
        let name = ["weak.toml", "strong.toml"][turn as usize % 2];
        let mut child = run(name).spawn().unwrap();
        // Most of the delays are at the end of the run, which may take less time than the first one.
        sleep(whole.mul_f64(1.1 - 0.8 * (f64::from(turn) / 30.0).powi(2)));
        let id = child.id().to_string();
        let _ = std::process::Command::new("kill")
            .args([signal, &id])
            .output();
        ended += u32::from(!child.wait().unwrap().success());
        let seal = json(&at.join("o/archrock.json"));
        let results = &seal["results"]["run"];
        assert_eq!(results["complete"], true, "{turn} {signal}");
        let files = results["files"].as_array().unwrap().iter();
        for file in files.filter_map(|file| file.as_str()) {
            assert!(at.join("o").join(file).exists(), "{turn} {signal}: {file}");
        }
    }
    assert!(ended > 0, "no run was ended by a signal");
}

/// The default folder of a scenario file is safe from other files of its name, even if --out put the results there.
#[test]
fn a_default_folder_filled_by_out_belongs_to_its_scenario() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    for (folder, amplitude_g) in [("a", 0.05), ("b", 0.9)] {
        fs::create_dir(at.join(folder)).unwrap();
        fs::write(at.join(folder).join("x.toml"), column(amplitude_g, 2)).unwrap();
    }
    succeeds(at, &["run", "a/x.toml", "--out", "results/x", "--quiet"]);
    let before = contents(&at.join("results/x"));
    let words = [
        "results/x holds the results of another scenario",
        "[ground] differs",
        "--out",
    ];
    refused(at, &["run", "b/x.toml"], &words);
    assert_eq!(contents(&at.join("results/x")), before);
    // Its own scenario may replace them, and the user may choose the folder.
    succeeds(at, &["run", "a/x.toml", "--quiet"]);
    succeeds(at, &["run", "b/x.toml", "--out", "results/x", "--quiet"]);
    assert_all_come_from(&at.join("results/x"), 0.9);
}

/// Parts are inputs of `merge`, and files that are no parts are never written to.
#[test]
fn no_result_replaces_a_part_and_no_part_another_file() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let map = "[map]\namplitude_g = [0.2, 0.4]\nduration_s = [0.2, 0.3]\n";
    let text = column(0.4, 2)
        .split("[uncertain]")
        .next()
        .unwrap()
        .to_owned();
    fs::write(at.join("s.toml"), text + map).unwrap();
    succeeds(at, &["map", "s.toml", "--out", "o"]);
    for part in ["1/2", "2/2"] {
        succeeds(at, &["map", "s.toml", "--shard", part, "--out", "p"]);
    }
    // A part has the place of an earlier result.
    fs::copy(at.join("p/map-1-of-2.part"), at.join("o/map.csv")).unwrap();
    let before = contents(&at.join("o"));
    let merge = ["merge", "o/map.csv", "p/map-2-of-2.part", "--out", "o"];
    refused(
        at,
        &merge,
        &["o/map.csv is an input", "a part to be merged"],
    );
    assert_eq!(contents(&at.join("o")), before);
    succeeds(
        at,
        &[
            "merge",
            "p/map-1-of-2.part",
            "p/map-2-of-2.part",
            "--out",
            "q",
        ],
    );
    // A file without a line end; an empty file and the beginning of a header are of a killed program.
    let again = ["map", "s.toml", "--out", "r"];
    fs::create_dir(at.join("r")).unwrap();
    for mine in ["my notes", "{\"program\":\"other\"", "\u{feff}{"] {
        fs::write(at.join("r/map.part"), mine).unwrap();
        for more in [&[][..], &["--resume"]] {
            let line = [&again[..], more].concat();
            refused(at, &line, &["r/map.part: is not a part of a study"]);
            assert_eq!(fs::read_to_string(at.join("r/map.part")).unwrap(), mine);
        }
    }
    for killed in ["", "{\"prog", "{\"program\":\"archrock\",\"row_fo"] {
        fs::write(at.join("r/map.part"), killed).unwrap();
        succeeds(at, &again);
    }
    // Links lead out of the folder.
    fs::write(at.join("mine"), "").unwrap();
    symlink(at.join("mine"), at.join("r/map.part")).unwrap();
    refused(at, &again, &["r/map.part: is a link"]);
    fs::create_dir(at.join("away")).unwrap();
    fs::write(at.join("u.toml"), column(0.4, 4)).unwrap();
    fs::create_dir(at.join("l")).unwrap();
    symlink(at.join("away"), at.join("l/uncertain")).unwrap();
    for more in [&[][..], &["--shard", "1/2"]] {
        let line = [&["run", "u.toml", "--out", "l"][..], more].concat();
        refused(at, &line, &["l/uncertain is a link", "--out"]);
    }
    assert!(names(&at.join("away")).is_empty());
    assert_eq!(fs::read(at.join("mine")).unwrap(), b"");
}

/// A page may be opened elsewhere: it names no folder of the machine that made it.
#[test]
fn no_page_names_the_folder_of_its_results() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), column(0.3, 4)).unwrap();
    let out = "a-folder-of-my-own";
    succeeds(
        at,
        &[
            "run",
            "s.toml",
            "--hinges",
            "four,free",
            "--out",
            out,
            "--quiet",
        ],
    );
    let all = contents(&at.join(out));
    let pages = all.iter().filter(|(name, _)| name.ends_with(".html"));
    assert_eq!(pages.clone().count(), 6, "{:?}", below(&at.join(out)));
    for (name, page) in pages {
        assert!(!String::from_utf8_lossy(page).contains(out), "{name}");
    }
}

/// The seal of a check lists the records of its histories.
#[test]
fn the_seal_of_a_check_lists_its_records() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let copied = ["semicircle-verify.toml", "records"];
    for name in copied.map(|name| scenarios().join(name)) {
        let status = std::process::Command::new("cp")
            .arg("-rL")
            .arg(name)
            .arg(at)
            .status();
        assert!(status.unwrap().success());
    }
    let line = ["verify", "semicircle-verify.toml", "--out", "o"];
    assert!(archrock(at, &line).status.success());
    let list = json(&at.join("o/archrock.json"));
    let listed = list["results"]["verify"]["records"].as_array().unwrap();
    let check = json(&at.join("o/verify.json"));
    let files = check["files"].as_array().unwrap().iter();
    let files = files.filter_map(|file| file["file"].as_str());
    let records: Vec<&str> = files.filter(|name| name.ends_with(".at2")).collect();
    assert!(records.len() >= 3, "{records:?}");
    let names = listed.iter().filter_map(|it| it.as_str()?.rsplit_once(' '));
    let mut names: Vec<&str> = names.map(|(name, _)| name).collect();
    // The first is that of the ground motion, which is one of them.
    assert_eq!(names[0], "records/slv-5.at2");
    names.sort_unstable();
    assert_eq!(names, records);
}
