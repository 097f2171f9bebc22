//! Input and output of `run`: standard input, several scenarios, the summary on standard output, and folders that
//! hold the results of another scenario.

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Output, Stdio};

use crate::common::program::{archrock, command, refusal, stderr, stdout, thoughts};
use crate::common::results::json;
use serde_json::Value;

const TEXT: &str = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n\
                    [ground.rectangular]\namplitude_g = -0.3\nduration_s = 0.2\n";

/// Runs the program with a scenario on standard input.
fn piped(folder: &Path, arguments: &[&str], text: &str) -> Output {
    let mut child = command(folder, arguments)
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(text.as_bytes()).unwrap();
    drop(stdin);
    child.wait_with_output().unwrap()
}

#[test]
fn the_summary_goes_to_standard_output_unless_data_do() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), TEXT).unwrap();
    let run = archrock(folder.path(), &["run", "s.toml"]);
    assert!(stdout(&run).contains("came to rest at 3.3656 s after 78 impacts"));
    assert!(run.stderr.is_empty());

    // The answer and its limits remain.
    let quiet = archrock(folder.path(), &["run", "s.toml", "--quiet"]);
    let brief = stdout(&quiet);
    assert!(quiet.stderr.is_empty());
    let reported = json(&folder.path().join("results/s/summary.json"));
    let quote = reported["to_quote"].as_str().unwrap();
    let limits = reported["warnings"].as_array().unwrap();
    let limits = limits.iter().map(|limit| limit.as_str().unwrap());
    // It has no title.
    let joined = thoughts(&format!("\n{brief}"));
    assert!(joined.contains(quote), "{brief}");
    let mut parts = limits.flat_map(|limit| limit.split("; "));
    assert!(
        parts.all(|part| joined.contains(part.trim_start_matches("needs "))),
        "{brief}"
    );
    let quiet = ["run", "s.toml", "--rotations", "-", "--quiet"];
    let quiet = archrock(folder.path(), &quiet);
    assert!(stdout(&quiet).starts_with("time_s,") && quiet.stderr.is_empty());

    let data = archrock(folder.path(), &["run", "s.toml", "--rotations", "-"]);
    assert!(stdout(&data).starts_with("time_s,"));
    assert!(stderr(&data).contains("came to rest"));
}

#[test]
fn the_printed_json_summary_equals_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{TEXT}[free_hinges]\n").replace("[ground", "voussoirs = 9\n[ground");
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let run = |options: &[&str]| {
        let mut arguments = vec!["run", "s.toml", "--format", "json", "--no-repeat"];
        arguments.extend(options);
        archrock(folder.path(), &arguments)
    };
    let printed = run(&["--hinges", "free"]);
    assert!(printed.stderr.is_empty());
    assert!(!folder.path().join("results").exists());
    let printed: Value = serde_json::from_str(&stdout(&printed)).unwrap();
    let written = run(&["--hinges", "free", "--out", "o"]);
    assert_eq!(
        stdout(&written),
        fs::read_to_string(folder.path().join("o/summary.json")).unwrap()
    );
    assert_eq!(printed["outcome"], "rest");

    let mut both: Value = serde_json::from_str(&stdout(&run(&["--hinges", "both"]))).unwrap();
    // The computing time of a step varies, and several models have one answer together.
    let mut printed = printed;
    assert!(
        printed
            .as_object_mut()
            .unwrap()
            .remove("to_quote")
            .is_some()
    );
    assert!(both["to_quote"].is_string());
    printed["longest_step_us"] = both["free"]["longest_step_us"].clone();
    let of_free = both["free"].as_object_mut().unwrap();
    let models = of_free.shift_remove("compared_models");
    assert_eq!(models, Some(serde_json::json!(["four", "free"])));
    assert_eq!(both["free"], printed);
    assert_eq!(both["four"]["outcome"], "rest");
    assert!(!folder.path().join("results").exists());
}

#[test]
fn a_scenario_can_be_read_from_standard_input() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), TEXT).unwrap();
    let of_file = archrock(folder.path(), &["check", "s.toml"]);
    let piped_in = piped(folder.path(), &["check", "-"], TEXT);
    assert_eq!(stdout(&piped_in), stdout(&of_file));

    let wrong = piped(folder.path(), &["run", "-"], &TEXT.replace("0.15", "15"));
    assert!(refusal(&wrong).contains("<stdin>:3:19: `thickness_ratio = 15`"));

    // Records are relative to the current folder.
    fs::write(folder.path().join("r.csv"), "0,0\n0.5,0.4\n1,0\n").unwrap();
    let (arch, _) = TEXT.split_once("[ground").unwrap();
    let record = format!("{arch}[ground.record]\nfile = \"r.csv\"\nunit = \"g\"\n");
    for _ in 0..2 {
        let run = piped(folder.path(), &["run", "-"], &record);
        assert!(stdout(&run).contains("results/stdin/report.html"));
    }
    assert!(folder.path().join("results/stdin/summary.json").exists());
}

#[test]
fn several_scenarios_run_one_after_another() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::create_dir(path.join("other")).unwrap();
    fs::write(path.join("a.toml"), TEXT).unwrap();
    fs::write(path.join("b.toml"), TEXT.replace("-0.3", "-0.1")).unwrap();
    fs::write(path.join("other/a.toml"), TEXT.replace("-0.3", "0.3")).unwrap();
    let run = archrock(path, &["run", "a.toml", "b.toml"]);
    let said = stdout(&run);
    let place = |words: &str| said.find(words).unwrap();
    assert!(place("came to rest") < place("results/a:"));
    assert!(place("results/a:") < place("never moved"));
    assert!(place("never moved") < place("results/b:"));

    let run = archrock(path, &["run", "a.toml", "b.toml", "--out", "o"]);
    stdout(&run);
    for name in ["a", "b"] {
        assert_eq!(
            fs::read(path.join("o").join(name).join("summary.json")).unwrap(),
            fs::read(path.join("results").join(name).join("summary.json")).unwrap()
        );
    }
    let json = stdout(&archrock(
        path,
        &["run", "a.toml", "b.toml", "--format", "json"],
    ));
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json[0]["outcome"], "rest");
    assert_eq!(json[1]["outcome"], "never_moved");

    // All errors are reported before anything runs.
    fs::remove_dir_all(path.join("results")).unwrap();
    fs::write(path.join("c.toml"), "[arch]\n").unwrap();
    let said = refusal(&archrock(
        path,
        &["run", "a.toml", "c.toml", "d.toml", "other/a.toml"],
    ));
    assert!(said.contains("c.toml:1:1: [arch] lacks `mean_radius_m`"));
    assert!(said.contains("d.toml: cannot be read"));
    assert!(said.contains("a.toml and other/a.toml would both have their results in results/a"));
    assert!(!path.join("results").exists());
    let said = refusal(&archrock(
        path,
        &["run", "a.toml", "b.toml", "--rotations", "-"],
    ));
    assert!(said.contains("--rotations - takes one scenario"));
}

#[test]
fn results_of_another_scenario_of_the_same_name_are_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::create_dir(path.join("other")).unwrap();
    fs::write(path.join("s.toml"), TEXT).unwrap();
    fs::write(path.join("other/s.toml"), TEXT.replace("-0.3", "0.3")).unwrap();
    let map = "[map]\nduration_s = [0.1, 0.2]\namplitude_g = [0.2, 0.3]\n";
    for (command, file) in [
        ("run", "summary.json"),
        ("threshold", "threshold.json"),
        ("map", "map.csv"),
    ] {
        fs::write(path.join("s.toml"), format!("{TEXT}{map}")).unwrap();
        let options: &[&str] = if command == "threshold" {
            &["--from", "1", "--to", "1.1", "--stride", "0.1"]
        } else {
            &[]
        };
        let run = |scenario: &str, more: &[&str]| {
            let mut arguments = vec![command, scenario];
            arguments.extend(options);
            arguments.extend(more);
            archrock(path, &arguments)
        };
        stdout(&run("s.toml", &[]));
        let before = fs::read(path.join("results/s").join(file)).unwrap();
        fs::write(
            path.join("other/s.toml"),
            format!("{TEXT}{map}").replace("5.0", "6.0"),
        )
        .unwrap();
        let said = refusal(&run("other/s.toml", &[]));
        assert!(
            said.contains(
                "results/s holds the results of s.toml: choose another folder with --out"
            ),
            "{said}"
        );
        assert_eq!(fs::read(path.join("results/s").join(file)).unwrap(), before);
        // The same scenario file, by whatever path and however edited, replaces its results.
        fs::write(
            path.join("s.toml"),
            format!("{TEXT}{map}").replace("0.15", "0.16"),
        )
        .unwrap();
        stdout(&run("./other/../s.toml", &[]));
        if command != "map" {
            stdout(&run("other/s.toml", &["--out", "mine"]));
        }
        fs::remove_dir_all(path.join("results")).unwrap();
        stdout(&run("other/s.toml", &[]));
        fs::remove_dir_all(path.join("results")).unwrap();
    }
}
