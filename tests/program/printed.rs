//! The printed results of every study: the answer on standard output, all numbers with `--details`, the answer alone with `--quiet`, and nothing beside JSON.

use std::os::unix::fs::symlink;

use serde_json::Value;

use crate::common::program::{archrock, scenarios, stderr, stdout, thoughts, typed};
use crate::common::{ARCH, COLUMN};

/// A command of each study, on the scenarios of the repository.
const STUDIES: [&[&str]; 9] = [
    &["run", "scenarios/column-pulse.toml"],
    &["threshold", "scenarios/column-pulse.toml"],
    &[
        "threshold",
        "scenarios/column-pulse.toml",
        "--along",
        "column.height_m=3..4:2",
    ],
    &[
        "map",
        "scenarios/semicircle-map.toml",
        "--set",
        "map.duration_s=[0.3]",
        "--set",
        "map.amplitude_g=[0.5]",
    ],
    &[
        "suite",
        "scenarios/column-suite.toml",
        "--set",
        "suite.peaks_g=[0.3, 1.0]",
    ],
    &["limit", "scenarios/semicircle-pulse.toml"],
    &["capacity", "scenarios/semicircle-pulse.toml"],
    &["spread", "scenarios/tie.toml", "--angle", "0"],
    &["verify", "scenarios/semicircle-verify.toml"],
];

#[test]
fn every_study_prints_its_report_on_standard_output() {
    for study in STUDIES {
        let folder = tempfile::tempdir().unwrap();
        symlink(scenarios(), folder.path().join("scenarios")).unwrap();
        let print = |options: &[&str]| {
            let output = archrock(folder.path(), &[study, options].concat());
            assert_eq!(stderr(&output), "", "{study:?} {options:?}");
            stdout(&output)
        };
        let all = print(&["--out", "o"]);
        let json: Value = serde_json::from_str(&print(&["--format", "json"])).unwrap();
        let brief = print(&["--quiet"]);
        assert!(all.contains("results in o"), "{all}");
        // Nothing is unlikely here, so that every warning limits the answer, which contains some of them.
        let joined = thoughts(&brief);
        let warnings = json["warnings"].as_array().unwrap();
        for warning in warnings.iter().map(|one| one.as_str().unwrap()) {
            let parts = warning
                .split("; ")
                .map(|part| part.trim_start_matches("needs "));
            let is_said = |part| joined.contains(part) || brief.contains(part);
            assert!(parts.clone().all(is_said), "{warning}: {brief}");
        }
        if let Some(quote) = json["to_quote"].as_str() {
            assert!(joined.contains(quote), "{brief}");
            assert!(all.contains(quote), "{all}");
        }
        // A study with histories begins with the title.
        if !["limit", "capacity", "spread", "verify"].contains(&study[0]) {
            assert_eq!(all.lines().next(), brief.lines().next(), "{all}");
            assert!(all.lines().nth(1).unwrap().starts_with("  "), "{all}");
        }
    }
}

/// Without an option a study prints its answer in short lines; that of the JSON is the same text. The command that it names next runs as printed.
#[test]
fn studies_print_their_answer_in_a_few_lines() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let title = "title = 'Shaken'\n";
    let arch = "title = 'Seven blocks'\n[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.2\nembrace_deg = 150.0\n";
    let pulse = "[ground.rectangular]\namplitude_g = -0.35\nduration_s = 0.2\n[simulation]\nduration_s = 4.0\n";
    let blocks = "voussoirs = 7\n";
    let map = "[map]\nduration_s = [0.2]\namplitude_g = [0.3, 0.6]\n";
    let outside = "[ground.one_cosine]\namplitude_g = 0.5\nduration_s = 0.3\n";
    for (command, text, options, next) in [
        (
            "run",
            format!("{arch}{blocks}{pulse}"),
            "",
            Some("threshold"),
        ),
        (
            "run",
            format!("{arch}{blocks}[free_hinges]\n{pulse}"),
            "",
            Some("threshold"),
        ),
        ("run", format!("{title}{ARCH}{outside}"), "", Some("run")),
        (
            "run",
            format!("{title}{COLUMN}{pulse}"),
            "",
            Some("threshold"),
        ),
        (
            "run",
            format!("{arch}{blocks}{pulse}"),
            "--hinges four,free",
            None,
        ),
        (
            "threshold",
            format!("{arch}{blocks}{pulse}"),
            "",
            Some("threshold"),
        ),
        (
            "threshold",
            format!("{arch}{blocks}[free_hinges]\n{pulse}"),
            "",
            None,
        ),
        (
            "threshold",
            format!("{title}{COLUMN}{pulse}"),
            "--set ground.rectangular.duration_s=0.4",
            None,
        ),
        (
            "map",
            format!("{arch}{blocks}{pulse}{map}"),
            "",
            Some("map"),
        ),
    ] {
        std::fs::write(at.join("s.toml"), text).unwrap();
        let mut arguments = vec![command, "s.toml"];
        arguments.extend(options.split_whitespace());
        let printed = |more: &[&str]| {
            let output = typed(at, &[&arguments[..], more].concat());
            assert!(output.status.success(), "{}", stderr(&output));
            stdout(&output)
        };
        let answer = printed(&[]);
        let json: Value = serde_json::from_str(&printed(&["--format", "json"])).unwrap();
        let last = answer.lines().last().unwrap();
        assert!(last.ends_with(".html; all numbers: --details"), "{answer}");
        assert!(
            answer
                .lines()
                .all(|line| line.chars().count() < 100 || line.contains("archrock ")),
            "{answer}"
        );
        if let Some(quote) = json["to_quote"].as_str() {
            // Commands of the answer name the scenario.
            let quote = quote.replace("FILE", "s.toml");
            let answer = thoughts(&answer);
            assert!(answer.starts_with(&quote), "{quote}: {answer}");
        }
        let line = answer
            .lines()
            .find_map(|line| line.trim().strip_prefix("next: archrock "));
        let words: Vec<&str> = line.into_iter().flat_map(|line| line.split(' ')).collect();
        assert_eq!(words.first().copied(), next, "{answer}");
        if next.is_some() {
            let output = typed(at, &words);
            assert!(output.status.success(), "{words:?}: {}", stderr(&output));
        }
    }
}

/// A motion without special conditions has six lines: title, verdict, conditions, numbers, next command and page.
#[test]
fn a_plain_answer_has_six_lines() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenarios().join("free-hinges.toml");
    let output = typed(
        folder.path(),
        &["run", file.to_str().unwrap(), "--out", "o"],
    );
    let answer = stdout(&output);
    let lines: Vec<&str> = answer.lines().map(str::trim).collect();
    assert_eq!(lines.len(), 6, "{answer}");
    assert_eq!(
        lines[1],
        "SURVIVES this motion in both directions, with free hinges; the same in all repetitions"
    );
    assert_eq!(
        lines[3],
        "starts at 0.145 g (ground: 0.300 g), rotates by 0.042 rad (69 % of overturning), rests at 2.99 s"
    );
}
