//! The printed results of every study: all of them on standard output, the essential ones with `--quiet`, and nothing beside JSON.

use std::os::unix::fs::symlink;

use serde_json::Value;

use crate::common::program::{archrock, scenarios, stderr, stdout};

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
        let brief: Vec<&str> = brief.lines().map(str::trim).collect();
        assert!(all.contains("results in o"), "{all}");
        // Nothing is unlikely here, so that every warning limits the answer. The verdict and the answer contain some of them.
        let warnings = json["warnings"].as_array().unwrap();
        for warning in warnings.iter().map(|one| one.as_str().unwrap()) {
            assert!(brief.iter().any(|line| line.contains(warning)), "{brief:?}");
        }
        if let Some(quote) = json["to_quote"].as_str() {
            assert_eq!(brief.last(), Some(&quote));
            assert!(all.contains(quote), "{all}");
        }
        // Title, verdict, and at most a line for each warning and the answer.
        assert!((1..=3 + warnings.len()).contains(&brief.len()), "{brief:?}");
        assert!(brief.len() < all.lines().count(), "{all}");
        // A study with histories begins with the title.
        if !["limit", "capacity", "spread", "verify"].contains(&study[0]) {
            assert_eq!(all.lines().next(), brief.first().copied(), "{all}");
            assert!(all.lines().nth(1).unwrap().starts_with("  "), "{all}");
        }
    }
}
