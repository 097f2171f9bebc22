//! Scenarios to start from, shell completions, and manual pages.

use std::f64::consts::PI;
use std::fs;

use crate::common::program::{archrock, printed, stderr};
use archrock::Scenario;

/// Optional keys, which stand in comments with their defaults.
const OPTIONAL: [&str; 14] = [
    "depth_m",
    "density_kg_m3",
    "start_s",
    "vertical_amplitude_g",
    "direction",
    "output_step_s",
    "gravity_m_s2",
    "time_column",
    "wrapped",
    "format",
    "scale",
    "confidence_factor",
    "behaviour_factor",
    "sides",
];

/// The text with the optional keys taken out of the comments.
fn with_comments_taken_in(text: &str) -> String {
    let lines = text.lines().map(|line| match line.strip_prefix("# ") {
        Some(rest)
            if OPTIONAL
                .iter()
                .any(|key| rest.starts_with(&format!("{key} = "))) =>
        {
            rest
        }
        _ => line,
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn every_kind_runs_at_once_and_its_comments_are_true() {
    for (kind, command) in [
        ("arch", "run"),
        ("column", "run"),
        ("record", "run"),
        ("map", "map"),
        ("suite", "suite"),
        ("verify", "verify"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let init = archrock(folder.path(), &["init", kind]);
        assert_eq!(init.status.code(), Some(0), "{}", stderr(&init));
        let name = format!("{kind}.toml");
        assert!(stderr(&init).contains(&format!("Next: archrock {command} {name}")));
        let run = archrock(folder.path(), &[command, &name]);
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        assert!(folder.path().join("results").join(kind).is_dir());

        let path = folder.path().join(&name);
        let plain = Scenario::read(&path).unwrap();
        let text = with_comments_taken_in(&fs::read_to_string(&path).unwrap());
        fs::write(&path, text).unwrap();
        assert_eq!(Scenario::read(&path).unwrap(), plain, "{kind}");

        // No file is overwritten.
        let again = archrock(folder.path(), &["init", kind]);
        assert_eq!(again.status.code(), Some(2));
        assert!(stderr(&again).contains(&format!("{name} exists already")));
    }
}

#[test]
fn a_starting_scenario_can_be_written_to_a_file_or_printed() {
    let folder = tempfile::tempdir().unwrap();
    let printed = archrock(folder.path(), &["init", "column", "-"]);
    assert!(printed.status.success() && printed.stderr.is_empty());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let named = archrock(folder.path(), &["init", "column", "mine.toml"]);
    assert!(named.status.success());
    assert_eq!(
        fs::read(folder.path().join("mine.toml")).unwrap(),
        printed.stdout
    );
    // Without a kind, an arch is written.
    assert!(archrock(folder.path(), &["init"]).status.success());
    assert!(folder.path().join("arch.toml").exists());
    // Two scenarios of records share the record file beside them.
    for kind in ["record", "suite"] {
        assert!(archrock(folder.path(), &["init", kind]).status.success());
    }
}

#[test]
fn the_generated_record_has_its_stated_properties() {
    let folder = tempfile::tempdir().unwrap();
    assert!(
        archrock(folder.path(), &["init", "record"])
            .status
            .success()
    );
    let text = fs::read_to_string(folder.path().join("record.csv")).unwrap();
    let rows: Vec<(f64, f64)> = text
        .lines()
        .skip(2)
        .map(|line| {
            let (t, a) = line.split_once(',').unwrap();
            (t.parse().unwrap(), a.parse().unwrap())
        })
        .collect();
    assert_eq!(rows.len(), 401);
    for (index, (t, a)) in (0_u32..).zip(rows) {
        assert!((t - 0.02 * f64::from(index)).abs() < 1e-12);
        let exact = 0.3 * (2.5 * PI * t).sin() * (PI * t / 8.0).sin().powi(2);
        assert!((a - exact).abs() < 6e-6, "{t} {a} {exact}");
    }
}

#[test]
fn completions_name_every_command() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let printed = archrock(folder.path(), &["completions", shell]);
        assert!(printed.status.success(), "{}", stderr(&printed));
        let script = String::from_utf8(printed.stdout).unwrap();
        // Fish lists options without their dashes.
        for word in ["threshold", "completions", "set"] {
            assert!(script.contains(word), "{shell} {word}");
        }
    }
}

/// The pages are not in the help: packages of the program contain them.
#[test]
fn manual_pages_describe_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let help = printed(folder.path(), &["--help"]);
    let (_, commands) = help.split_once("Commands:\n").unwrap();
    let commands = commands
        .lines()
        .map_while(|line| line.split_whitespace().next());
    let commands: Vec<&str> = commands.filter(|command| *command != "help").collect();
    assert!(commands.len() > 12 && !commands.contains(&"manual"));
    printed(folder.path(), &["manual", "man/man1"]);
    let page = |name: &str| {
        let page = fs::read_to_string(folder.path().join("man/man1").join(name)).unwrap();
        page.replace("\\-", "-")
    };
    let main = page("archrock.1");
    for command in commands {
        assert!(
            main.contains(&format!("archrock-{command}(1)")),
            "{command}"
        );
        assert!(page(&format!("archrock-{command}.1")).contains(&format!("archrock {command}")));
    }
    let usage = page("archrock-run.1");
    for words in ["[--hinges <MODELS>]", "[--out <DIR>]", " <SCENARIO>..."] {
        assert!(usage.contains(words), "{words}");
    }
    fs::write(folder.path().join("file"), "").unwrap();
    let output = archrock(folder.path(), &["manual", "file"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("cannot write manual pages into file: "));
}
