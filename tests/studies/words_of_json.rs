//! The words of a report follow from its JSON alone: made again, they are those that the program printed.

use std::fs;
use std::path::Path;

use archrock::studies::ensemble::{
    UncertainMapSummary, UncertainRunSummary, UncertainSuiteSummary, UncertainThresholdSummary,
};
use archrock::studies::threshold::{self, AlongSummary};
use archrock::studies::{
    CapacitySummary, ImpactSummary, LimitSummary, PeaksSummary, SpreadSummary, map, suite, verify,
    words_of_json,
};
use serde_json::Value;

use crate::common::COLUMN;
use crate::common::program::{archrock, scenarios, stderr, stdout};
use crate::common::results::json;

/// Function that makes the words of a report of one type from its JSON.
type WordsOf = fn(&Value) -> serde_json::Result<String>;

/// Runs a command and compares its output with the words made of files in its results.
#[track_caller]
fn same_words(at: &Path, arguments: &[&str], reports: &[(&str, WordsOf)]) {
    let output = archrock(at, &[arguments, &["--out", "r"]].concat());
    let said = stdout(&output) + &stderr(&output);
    for (file, words_of) in reports {
        let words = words_of(&json(&at.join("r").join(file))).unwrap();
        assert!(!words.is_empty(), "{arguments:?}: {file}");
        let after = said.split_once(&format!("{words}\n"));
        let (_, after) = after.unwrap_or_else(|| panic!("{arguments:?}: {words}\n{said}"));
        // No line of the report follows.
        let other = ["  results in ", "  sampled from "];
        let is_end = !after.starts_with("  ") || other.iter().any(|line| after.starts_with(line));
        assert!(is_end, "{arguments:?}: {words}\n{said}");
    }
    fs::remove_dir_all(at.join("r")).unwrap();
}

/// Another outcome with the same verdict is no doubt, and another verdict is one.
#[test]
fn repetitions_with_another_outcome_are_named_by_their_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenarios().join("free-hinges.toml").display().to_string();
    let output = archrock(folder.path(), &["run", &file, "--no-report", "--out", "r"]);
    assert!(output.status.success());
    let mut summary = json(&folder.path().join("r/summary.json"));
    let outcomes = |summary: &Value| {
        let words = archrock::studies::run::words_of(summary).unwrap();
        let (_, after) = words
            .split_once("repeated (mirrored; landings merged): ")
            .unwrap();
        after.split(", peak").next().unwrap().to_owned()
    };
    assert_eq!(outcomes(&summary), "the same outcome");
    let repeated = &mut summary["repeatability"];
    assert_eq!(repeated["outcomes"]["mirrored"], "rest");
    repeated["outcomes"]["mirrored"] = "still_rocking".into();
    assert_eq!(
        outcomes(&summary),
        "the same verdict, still rocking with mirrored"
    );
    let repeated = &mut summary["repeatability"];
    repeated["outcomes"]["mirrored"] = "overturned".into();
    repeated["overturning_sways"]["mirrored"] = "left".into();
    assert_eq!(
        outcomes(&summary),
        "DIFFERENT OUTCOME, overturned to the left with mirrored"
    );
}

#[test]
fn studies_have_the_words_of_their_json() {
    let folder = tempfile::tempdir().unwrap();
    let small = [
        "--set",
        "map.duration_s.count=4",
        "--set",
        "map.amplitude_g.count=4",
    ];
    let free = ["--hinges", "free", "--set", "arch.voussoirs=7"];
    let few = ["--from", "0.5", "--to", "2", "--stride", "0.3"];
    let elastic = [
        "--hinges",
        "elastic",
        "--set",
        "elastic_joints.normal_stiffness_gpa_m=20",
    ];
    let along = ["--along", "arch.thickness_ratio=0.12..0.2:3"];
    let suite = ["--set", "suite.peaks_g.count=4"];
    for (report, file, command, options) in [
        (
            ("map.json", words_of_json::<map::MapSummary> as WordsOf),
            "semicircle-map.toml",
            "map",
            &small[..],
        ),
        (
            ("map.json", words_of_json::<map::MapSummary> as WordsOf),
            "semicircle-map.toml",
            "map",
            &[&small[..], &free].concat(),
        ),
        (
            (
                "threshold.json",
                words_of_json::<threshold::ThresholdSummary> as WordsOf,
            ),
            "semicircle-pulse.toml",
            "threshold",
            &few,
        ),
        (
            (
                "threshold.json",
                words_of_json::<threshold::ThresholdSummary> as WordsOf,
            ),
            "column-pulse.toml",
            "threshold",
            &[&few[..], &elastic].concat(),
        ),
        (
            (
                "threshold.json",
                words_of_json::<threshold::ThresholdSummary> as WordsOf,
            ),
            "semicircle-pulse.toml",
            "threshold",
            &[
                &few[..],
                &["--hinges", "four,free", "--set", "arch.voussoirs=5"],
            ]
            .concat(),
        ),
        (
            (
                "threshold_along.json",
                words_of_json::<AlongSummary> as WordsOf,
            ),
            "semicircle-pulse.toml",
            "threshold",
            &[&few[..], &along].concat(),
        ),
        (
            (
                "fragility.json",
                words_of_json::<suite::SuiteSummary> as WordsOf,
            ),
            "column-suite.toml",
            "suite",
            &suite,
        ),
        (
            ("capacity.json", words_of_json::<CapacitySummary> as WordsOf),
            "tie.toml",
            "capacity",
            &[],
        ),
        (
            (
                "verify.json",
                words_of_json::<verify::VerifySummary> as WordsOf,
            ),
            "semicircle-verify.toml",
            "verify",
            &[],
        ),
    ] {
        let file = scenarios().join(file);
        let arguments = [&[command, file.to_str().unwrap()], options].concat();
        same_words(folder.path(), &arguments, &[report]);
    }
}

/// Compares the words that a command prints with those made of the JSON that it prints.
#[track_caller]
fn same_printed(arguments: &[&str], words_of: WordsOf) {
    let at = Path::new("scenarios");
    let [words, json] = [&[][..], &["--format", "json"]].map(|format| {
        let output = archrock(at, &[arguments, format].concat());
        assert!(
            output.status.success(),
            "{arguments:?}: {}",
            stderr(&output)
        );
        stdout(&output)
    });
    let again = words_of(&serde_json::from_str(&json).unwrap()).unwrap();
    assert_eq!(again, words.trim_end(), "{arguments:?}");
}

#[test]
fn limits_have_the_words_of_their_json() {
    let slips = ["--set", "free_hinges.friction_coefficient=0.4"];
    let moves = ["--set", "supports.right.spread_m=0.001"];
    let cases: [(&str, &[&[&str]]); 9] = [
        ("recipes/road-bridge.toml", &[]),
        ("column-pulse.toml", &[]),
        ("semicircle-pulse.toml", &[]),
        ("drums-step-pair.toml", &[&slips]),
        ("voussoirs-step-pair.toml", &[&slips]),
        ("voussoirs-step-pair.toml", &[&slips, &moves]),
        ("pointed-arch-on-piers.toml", &[]),
        ("tie.toml", &[]),
        ("tie.toml", &[&moves]),
    ];
    for (file, set) in cases {
        let arguments = [&["limit", file], &set.concat()[..]].concat();
        same_printed(&arguments, words_of_json::<LimitSummary>);
    }
}

#[test]
fn impacts_have_the_words_of_their_json() {
    let details = ["--models", "--certificate"];
    let cases: [(&str, &[&str]); 6] = [
        ("column-pulse.toml", &[]),
        ("semicircle-pulse.toml", &[]),
        ("semicircle-pulse.toml", &details),
        ("voussoirs-step-pair.toml", &details),
        ("pointed-arch-on-piers.toml", &details),
        ("semicircle-pulse.toml", &["--set", "impact.model=mirrored"]),
    ];
    for (file, more) in cases {
        let arguments = [&["impact", file], more].concat();
        same_printed(&arguments, words_of_json::<ImpactSummary>);
    }
}

#[test]
fn spreads_have_the_words_of_their_json() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = |name: &str| fs::canonicalize(Path::new("scenarios").join(name)).unwrap();
    let slips = ["--set", "free_hinges.friction_coefficient=0.3"];
    let cases: [(&str, &[&str]); 3] = [
        ("voussoirs-step-pair.toml", &slips),
        ("pointed-arch-on-piers.toml", &["--angle", "30"]),
        ("tie.toml", &["--angle", "0"]),
    ];
    for (file, more) in cases {
        let file = scenario(file);
        let arguments = [&["spread", file.to_str().unwrap()], more].concat();
        let reports: [(&str, WordsOf); 1] = [("spread.json", words_of_json::<SpreadSummary>)];
        same_words(folder.path(), &arguments, &reports);
    }
}

#[test]
fn samples_have_the_words_of_their_json() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, second) in [("a", 0.9), ("b", 0.4)] {
        let table = format!("0.0,0.0\n0.3,1.0\n0.6,{second}\n0.9,0.0\n");
        fs::write(at.join(format!("{name}.csv")), table).unwrap();
    }
    let text = |end_s: f64| {
        format!(
            "{COLUMN}[ground.half_sine]\namplitude_g = 0.33\nduration_s = 1.0\n[simulation]\nduration_s = {end_s}\n\
             [map]\nduration_s = [0.9, 1.0]\namplitude_g = [0.33, 0.34]\n\
             [suite]\nrecords = '?.csv'\nunit = 'g'\npeaks_g = [0.2, 0.4, 0.8]\n\
             [uncertain]\nsamples = 20\n'column.width_m' = {{ from = 0.7, to = 1.0 }}\n'column.height_m' = {{ deviation = 0.1 }}\n"
        )
    };
    // Many of the histories that end early have no verdict.
    fs::write(at.join("early.toml"), text(1.02)).unwrap();
    fs::write(at.join("late.toml"), text(60.0)).unwrap();
    let questions: [(&str, &str, WordsOf); 4] = [
        ("run", "uncertain", words_of_json::<UncertainRunSummary>),
        (
            "threshold",
            "uncertain_threshold",
            words_of_json::<UncertainThresholdSummary>,
        ),
        (
            "suite",
            "uncertain_suite",
            words_of_json::<UncertainSuiteSummary>,
        ),
        ("map", "uncertain_map", words_of_json::<UncertainMapSummary>),
    ];
    for (command, folder, words_of) in questions {
        for file in ["early.toml", "late.toml"] {
            let report = format!("{folder}/uncertain.json");
            same_words(at, &[command, file], &[(&report, words_of)]);
        }
    }
    let models = ["run", "late.toml", "--hinges", "four,free"];
    let few = ["--set", "uncertain.samples=4"];
    let compared: [(&str, WordsOf); 3] = [
        ("four/uncertain/uncertain.json", questions[0].2),
        ("free/uncertain/uncertain.json", questions[0].2),
        ("models/peaks.json", words_of_json::<PeaksSummary>),
    ];
    same_words(at, &[&models[..], &few].concat(), &compared);
}
