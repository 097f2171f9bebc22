//! The program in adverse conditions: killed, without a reader of its output, on a full disk, and with very long output.
#![cfg(target_os = "linux")]
use crate::common::program::{names, result_names, skip_without, stderr};
use crate::common::results::{Row, Table, json, summary};
use std::fs::{self, OpenOptions};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_archrock");

/// A column that loses no energy, so it rocks until the end of the run.
fn endless(rotation_rad: f64, duration_s: f64, output_step_s: f64) -> String {
    format!(
        "[column]\nheight_m = 4\nwidth_m = 0.8\n\
         [impact]\nmodel = 'prescribed'\nrestitution = 1\n\
         [initial]\nsway = 'right'\nrotation_rad = {rotation_rad}\n\
         [simulation]\nduration_s = {duration_s}\noutput_step_s = {output_step_s}\n"
    )
}

fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(arguments).stdin(Stdio::null());
    command
}

/// Rows of a table; the file ends with a whole line.
fn rows(path: &Path) -> Vec<Row> {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.ends_with('\n'), "{} is cut off", path.display());
    Table::parse(text).rows
}

/// Checks that result files in the folder are complete, and, if the seal calls them complete, that all of
/// them come from one run. Returns whether it does.
fn check_results(folder: &Path, duration_s: f64) -> bool {
    let found = |name: &str| folder.join(name).exists();
    if found("rotations.csv") {
        let rotations = rows(&folder.join("rotations.csv"));
        assert!(rotations.last().unwrap().number("time_s") == duration_s);
    }
    for name in ["events.csv", "impacts.csv"] {
        if found(name) {
            let first = rows(&folder.join(name)).len();
            assert!(first > 0, "{name} has no rows");
        }
    }
    if !found("archrock.json")
        || json(&folder.join("archrock.json"))["results"]["run"]["complete"] != true
    {
        return false;
    }
    let summary = summary(folder);
    let released = summary["scenario"]["initial"]["rotation_rad"]
        .as_f64()
        .unwrap();
    let rotations = rows(&folder.join("rotations.csv"));
    assert!(rotations[0].number(4) == -released);
    let (impacts, events) = (
        rows(&folder.join("impacts.csv")),
        rows(&folder.join("events.csv")),
    );
    assert_eq!(summary["impacts"], impacts.len());
    assert_eq!(events.len(), impacts.len());
    assert_eq!(
        events.last().unwrap()["time_s"],
        impacts.last().unwrap()["time_s"]
    );
    assert_eq!(
        rotations.last().unwrap()["phase"],
        events.last().unwrap()["phase"]
    );
    true
}

#[test]
fn a_killed_run_leaves_complete_results_or_none() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("results");
    let scenarios: Vec<_> = [0.05, 0.15]
        .map(|rotation| {
            let path = root.path().join(format!("{rotation}.toml"));
            fs::write(&path, endless(rotation, 40.0, 2e-3)).unwrap();
            path.to_str().unwrap().to_owned()
        })
        .to_vec();
    let spawn = |turn: usize| {
        let out = folder.to_str().unwrap();
        program(&["run", &scenarios[turn % 2], "--out", out, "--quiet"])
            .spawn()
            .unwrap()
    };
    let begin = Instant::now();
    assert!(spawn(0).wait().unwrap().success());
    let mut whole = begin.elapsed();
    assert!(check_results(&folder, 40.0));
    // Delays are spread over the run by the golden ratio, more densely at its end, when the files get their names. The machine
    // adds randomness and may be faster or slower by now: a run that ends in time shortens the next.
    let (mut killed, mut finished) = (0, 0);
    for turn in 1..=24_u32 {
        let part = (f64::from(turn) * 0.618_033_988_75).fract();
        let delay = whole.mul_f64(if turn % 3 == 0 {
            part
        } else {
            0.8 + 0.3 * part
        });
        let mut child = spawn(turn as usize);
        std::thread::sleep(delay);
        child.kill().unwrap();
        if child.wait().unwrap().success() {
            finished += 1;
            whole = whole.mul_f64(0.95);
            assert!(check_results(&folder, 40.0));
        } else {
            killed += 1;
            whole = whole.mul_f64(1.03);
            check_results(&folder, 40.0);
        }
    }
    assert!(killed > 5, "{killed} killed, {finished} finished");
    // The next run removes the files that they left.
    assert!(spawn(0).wait().unwrap().success());
    assert!(check_results(&folder, 40.0));
    assert_eq!(result_names(&folder), crate::common::program::RUN_FILES);
}

/// Exit code and standard error of the scenario, run with these arguments and standard output.
fn run_into(stdout: Stdio, arguments: &[&str]) -> (Option<i32>, String) {
    let root = tempfile::tempdir().unwrap();
    let scenario = root.path().join("s.toml");
    fs::write(&scenario, endless(0.1, 10.0, 1e-3)).unwrap();
    let mut command = program(arguments);
    let output = command.arg(scenario).stdout(stdout).stderr(Stdio::piped());
    let output = output.spawn().unwrap().wait_with_output().unwrap();
    (output.status.code(), stderr(&output))
}

#[test]
fn a_full_disk_is_reported_once() {
    for (arguments, what) in [
        (
            &["run", "--rotations", "-"][..],
            "cannot write the rotations",
        ),
        (&["limit"], "cannot write to standard output"),
        (
            &["impact", "--format", "json"],
            "cannot write to standard output",
        ),
        (&["check"], "cannot write to standard output"),
    ] {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let (code, message) = run_into(full.into(), arguments);
        assert_eq!(code, Some(1), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        let start = format!("error: {what}: No space left on device");
        assert!(message.starts_with(&start), "{message}");
    }
}

/// A limit on the size of files stands for a disk that fills up.
#[test]
fn a_disk_that_fills_up_leaves_nothing() {
    let root = tempfile::tempdir().unwrap();
    let (scenario, out) = (root.path().join("s.toml"), root.path().join("out"));
    fs::write(&scenario, endless(0.1, 10.0, 1e-3)).unwrap();
    let output = Command::new("sh")
        .args([
            "-c",
            "trap '' XFSZ; ulimit -f 64; exec \"$0\" run \"$1\" --out \"$2\"",
        ])
        .args([Path::new(PROGRAM), &scenario, &out])
        .output()
        .unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(
        message.starts_with("error: cannot write the rotations: "),
        "{message}"
    );
    assert_eq!(names(root.path()), ["s.toml"]);
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let root = tempfile::tempdir().unwrap();
    let scenario = root.path().join("s.toml");
    fs::write(&scenario, endless(0.1, 100.0, 1e-3)).unwrap();
    let path = scenario.to_str().unwrap();
    for arguments in [&["run", "--rotations", "-", path][..], &["check", path]] {
        let mut child = program(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut first = [0];
        let mut pipe = child.stdout.take().unwrap();
        pipe.read_exact(&mut first).unwrap();
        drop(pipe);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        assert_eq!(stderr(&output), "");
    }
}

/// Peak resident memory of a process, in KiB.
fn peak_memory_kib(process: u32) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    line.unwrap()
        .split_whitespace()
        .nth(1)
        .unwrap()
        .parse()
        .unwrap()
}

/// A million rows, some 60 MB: they are not kept, but the few hundred impacts among them are.
#[test]
fn a_long_output_streams() {
    let root = tempfile::tempdir().unwrap();
    let scenario = root.path().join("s.toml");
    fs::write(&scenario, endless(0.19, 1000.0, 1e-3)).unwrap();
    let mut child = program(&["run", "--quiet", "--rotations", "-"])
        .arg(&scenario)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut early_kib = 0;
    let mut count = 0_u32;
    for line in lines {
        line.unwrap();
        count += 1;
        if count == 20_000 {
            early_kib = peak_memory_kib(child.id());
        }
        // The program waits while the pipe is full, so its memory can be read.
        if count == 990_000 {
            let late_kib = peak_memory_kib(child.id());
            assert!(
                late_kib < early_kib + 1024,
                "{early_kib} KiB, {late_kib} KiB"
            );
        }
    }
    assert!(child.wait().unwrap().success());
    // The header, and the rows at both ends.
    assert_eq!(count, 1_000_002);
}

/// Runs `action` with the path of a folder to which a long run is writing.
fn while_being_written(root: &Path, action: impl FnOnce(&Path)) {
    let (scenario, folder) = (root.join("long.toml"), root.join("results"));
    fs::write(&scenario, endless(0.1, 9e3, 1e-3)).unwrap();
    let mut long = program(&["run", "--quiet", "--out"])
        .args([&folder, &scenario])
        .spawn()
        .unwrap();
    // Once a file exists the tables are open; the folder was locked before they were created.
    let begun = || {
        fs::read_dir(&folder).is_ok_and(|mut files| {
            files
                .any(|file| file.is_ok_and(|file| file.metadata().is_ok_and(|file| file.len() > 0)))
        })
    };
    while !begun() {
        assert!(long.try_wait().unwrap().is_none(), "the run is too short");
        std::thread::sleep(Duration::from_millis(10));
    }
    action(&folder);
    long.kill().unwrap();
    long.wait().unwrap();
}

#[test]
fn a_second_program_writing_to_one_folder_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let short = root.path().join("short.toml");
    fs::write(&short, endless(0.1, 1.0, 1e-2)).unwrap();
    let run = |folder: &Path| {
        let mut command = program(&["run", "--quiet", "--out"]);
        let output = command.args([folder, &short]).output().unwrap();
        let said = stderr(&output);
        (output.status.code(), said)
    };
    let results = root.path().join("results");
    while_being_written(root.path(), |folder| {
        let (code, said) = run(folder);
        assert_eq!(code, Some(2), "{said}");
        let folder = folder.display();
        assert_eq!(
            said,
            format!(
                "error: the folder {folder} is being written to by another run, or a program such as `flock` has locked it; choose another \
                 folder with --out\n"
            )
        );
    });
    // The lock of a killed run ends with it, and its files are removed.
    assert_eq!(run(&results), (Some(0), String::new()));
    assert!(names(&results).iter().all(|name| !name.starts_with('.')));
}

/// Runs the program, which must end by itself.
fn within_a_minute(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = Command::new("timeout")
        .args(["60", PROGRAM])
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said = stderr(&output);
    (output.status.code(), said)
}

#[test]
fn a_pipe_among_the_results_does_not_block() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path();
    let folder = path.join("results/s");
    fs::create_dir_all(&folder).unwrap();
    let pipe = |name: &str| {
        let made = Command::new("mkfifo").arg(folder.join(name)).status();
        assert!(made.unwrap().success());
    };
    let map = "[ground.one_sine]\namplitude_g = 0.1\nduration_s = 0.1\n\
               [map]\nduration_s = [0.1, 0.2]\namplitude_g = [0.2, 0.3]\n";
    let scenario = format!("[column]\nheight_m = 4\nwidth_m = 0.8\n{map}");
    fs::write(path.join("s.toml"), scenario).unwrap();
    for name in [
        ".archrock-rotations.csv-x",
        "summary.json",
        "rotations.csv",
        "archrock.json",
    ] {
        pipe(name);
    }
    // The program reads and replaces none of them.
    for name in ["archrock.json", "summary.json", "rotations.csv"] {
        let (code, said) = within_a_minute(path, &["run", "s.toml"]);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains(&format!("results/s/{name} ")), "{said}");
        fs::remove_file(folder.join(name)).unwrap();
    }
    let (code, said) = within_a_minute(path, &["run", "s.toml"]);
    assert_eq!(code, Some(0), "{said}");
    pipe("map.part");
    for arguments in [&["map", "s.toml"][..], &["map", "s.toml", "--resume"]] {
        let (code, said) = within_a_minute(path, arguments);
        assert_eq!(code, Some(2), "{said}");
        assert_eq!(said, "error: results/s/map.part: is not a file\n");
    }
    let (code, said) = within_a_minute(path, &["merge", "results/s/map.part"]);
    assert_eq!(code, Some(2), "{said}");
    fs::remove_file(folder.join("map.part")).unwrap();
    let (code, said) = within_a_minute(path, &["map", "s.toml"]);
    assert_eq!(code, Some(0), "{said}");
}

#[test]
fn a_folder_that_is_removed_during_a_map_is_made_again() {
    let root = tempfile::tempdir().unwrap();
    let (scenario, folder) = (root.path().join("s.toml"), root.path().join("gone"));
    let map = "[ground.one_sine]\namplitude_g = 0.1\nduration_s = 0.1\n\
               [map]\nduration_s = { from = 0.1, to = 1, count = 70 }\n\
               amplitude_g = { from = 0.1, to = 1, count = 70 }\n";
    let text = format!("[column]\nheight_m = 4\nwidth_m = 0.8\n{map}");
    fs::write(&scenario, text).unwrap();
    let study = |shard: &[&str], part: &str| {
        let mut child = program(&["map", "--quiet", "--threads", "1", "--out"])
            .args([&folder, &scenario])
            .args(shard)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let written = || fs::metadata(folder.join(part)).is_ok_and(|part| part.len() > 2000);
        while !written() {
            assert!(child.try_wait().unwrap().is_none(), "the map is too short");
            std::thread::sleep(Duration::from_millis(5));
        }
        fs::remove_dir_all(&folder).unwrap();
        let output = child.wait_with_output().unwrap();
        let said = stderr(&output);
        (output.status.code(), said)
    };
    assert_eq!(study(&[], "map.part"), (Some(0), String::new()));
    assert_eq!(
        result_names(&folder),
        ["map.csv", "map.html", "map.json", "map.svg"]
    );
    assert_eq!(rows(&folder.join("map.csv")).len(), 4900);
    // With `--shard` the part file is the result.
    fs::remove_dir_all(&folder).unwrap();
    let (code, said) = study(&["--shard", "1/2"], "map-1-of-2.part");
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains(
            "map-1-of-2.part: it was removed while it was written; compute this part again"
        ),
        "{said}"
    );
}

/// Text that a terminal shows for a command; `None` if no terminal can be emulated.
fn on_a_terminal(folder: &Path, command: &str) -> Option<String> {
    let ran = Command::new("script")
        .args(["--quiet", "--return", "--command", command, "/dev/null"])
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .ok()?;
    assert!(
        ran.status.success(),
        "{}",
        String::from_utf8_lossy(&ran.stdout)
    );
    Some(String::from_utf8(ran.stdout).unwrap())
}

#[test]
fn a_long_run_shows_its_progress_on_a_terminal() {
    let root = tempfile::tempdir().unwrap();
    // A second is some 200 kB of rotations, more than a pipe holds.
    let scenario = |duration_s: f64| {
        format!(
            "[column]\nheight_m = 4\nwidth_m = 1\n[ground.one_sine]\namplitude_g = 0.35\nduration_s = 1\n\
             [simulation]\nduration_s = {duration_s}\noutput_step_s = 1e-3\n"
        )
    };
    fs::write(root.path().join("long.toml"), scenario(8.0)).unwrap();
    fs::write(root.path().join("short.toml"), scenario(1e-2)).unwrap();
    // The program waits for a slow reader of its rotations.
    let run = |more: &str| {
        format!(
            "({PROGRAM} run --rotations - {more}; echo code $? >&2) | (sleep 2.5; cat > rotations.csv)"
        )
    };
    let Some(said) = on_a_terminal(root.path(), &run("long.toml")) else {
        skip_without("script");
        return;
    };
    assert!(said.contains(" of 8 s simulated, "), "{said}");
    assert!(!said.contains("repeating the history"), "{said}");
    assert_eq!(rows(&root.path().join("rotations.csv")).len(), 8001);
    for more in ["long.toml --quiet", "short.toml"] {
        let said = on_a_terminal(root.path(), &run(more)).unwrap();
        assert!(!said.contains(" s simulated"), "{said}");
        assert!(said.contains("code 0"), "{said}");
    }
    // Progress is not written to a file.
    let ran = Command::new("sh")
        .args(["-c", &run("long.toml --details")])
        .current_dir(root.path())
        .output()
        .unwrap();
    let said = stderr(&ran);
    assert!(said.contains("still rocking at 8.0000 s"), "{said}");
    assert!(said.ends_with("code 0\n"), "{said}");
    assert!(!said.contains(" s simulated"), "{said}");
}

#[test]
fn a_study_shows_its_pace_on_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let map = "[column]\nheight_m = 4\nwidth_m = 1\n[ground.one_sine]\namplitude_g = 1\nduration_s = 1\n[map]\n\
               amplitude_g = { from = 0.3, to = 3, count = 100 }\nduration_s = { from = 0.1, to = 2, count = 100 }\n";
    fs::write(folder.path().join("map.toml"), map).unwrap();
    let command = format!("{PROGRAM} map map.toml --out out");
    let Some(said) = on_a_terminal(folder.path(), &command) else {
        skip_without("script");
        return;
    };
    assert!(said.contains(" cases, none finished yet"), "{said}");
    assert!(said.contains(" a second, "), "{said}");
    assert!(said.contains(" left"), "{said}");
}

/// Errors of the system name the exhausted resource and its remedy, and the result, not its hidden file.
#[test]
fn exhausted_resources_are_named() {
    let root = tempfile::tempdir().unwrap();
    let scenario = root.path().join("s.toml");
    fs::write(&scenario, endless(0.1, 40.0, 1e-3)).unwrap();
    let limited = |limit: &str, more: &[&str]| {
        let line = format!("trap '' XFSZ; {limit}; exec \"$0\" run s.toml --quiet \"$@\"");
        let mut shell = Command::new("sh");
        let output = shell
            .current_dir(root.path())
            .args(["-c", &line, PROGRAM])
            .args(more);
        let output = output.output().unwrap();
        (output.status.code(), stderr(&output))
    };
    for files in 5..9 {
        let (code, said) = limited(&format!("ulimit -n {files}"), &["--out", "o"]);
        assert_eq!(code, Some(1), "{files} files: {said}");
        let words = "Too many open files (os error 24): allow more with `ulimit -n`\n";
        assert!(said.ends_with(words) && !said.contains("--out"), "{said}");
    }
    let (code, said) = limited("ulimit -f 64", &["--out", "o"]);
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains("File too large") && !said.contains(".archrock-"),
        "{said}"
    );
    let pulse = crate::common::program::scenarios().join("semicircle-pulse.toml");
    let pulse = pulse.to_str().unwrap();
    for (arguments, words) in [
        (
            ["init", "column", "none/s.toml"].as_slice(),
            "error: cannot write none/s.toml: there is no folder none\n",
        ),
        (
            &["impact", "--line", "none/line.csv", pulse],
            "error: cannot write none/line.csv: there is no folder none; choose another file with --line\n",
        ),
    ] {
        let output = program(arguments)
            .current_dir(root.path())
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert_eq!(stderr(&output), words);
    }
}
