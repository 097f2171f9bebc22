//! A run in both directions of its ground motion: summary, words and page, for all models.

use std::fs;

use crate::common::program::{archrock, printed, scenarios, stdout};
use crate::common::results::{data_of, json};
use crate::common::{COLUMN, ON_A_PIER, UNEVEN_ARCH, pairs};
use archrock::studies::run::{page_of, words_of};
use serde_json::Value;

/// Keys of `mirrored` that are also keys of the summary in that direction alone.
const COMMON: [&str; 7] = [
    "outcome",
    "outcome_time_s",
    "overturning_sway",
    "largest_peak_rotation_rad",
    "peak_rotation_over_critical",
    "peak_potential_over_barrier",
    "thrust_excess_ratio",
];

/// The summary of a run of the scenario in the file `s.toml`.
fn run(folder: &std::path::Path, more: &[&str]) -> Value {
    let arguments = [&["run", "s.toml", "--format", "json"], more].concat();
    let output = archrock(folder, &arguments);
    assert!(output.status.success(), "{output:?}");
    serde_json::from_str(&stdout(&output)).unwrap()
}

/// The quote has these words, unless there is no answer.
#[track_caller]
fn assert_quotes(summary: &Value, words: &str) {
    let quote = summary["to_quote"].as_str().unwrap();
    assert!(
        quote.contains(words) || quote.contains("no answer"),
        "{quote}: {words}"
    );
}

/// The mirrored result of `both` is the result in that direction alone; the other numbers are those of the motion as given; and the verdict is the
/// worse one. Returns the verdicts as given and mirrored.
fn assert_both_are_the_runs_alone(folder: &std::path::Path, more: &[&str]) -> [String; 2] {
    let alone = |direction: &str| run(folder, &[more, &["--direction", direction]].concat());
    let (given, turned) = (alone("as_given"), alone("mirrored"));
    assert!(given.get("mirrored").is_none() && turned.get("mirrored").is_none());
    let both = run(folder, more);
    let mirrored = &both["mirrored"];
    assert_eq!(mirrored["verdict"], turned["verdict"]);
    for key in COMMON {
        if let Some(value) = mirrored.get(key) {
            assert_eq!(value, &turned[key], "{key}");
        }
        assert_eq!(both.get(key), given.get(key), "{key}");
    }
    let demand = |summary: &Value| summary["friction_demand"].as_f64();
    assert_eq!(demand(mirrored), demand(&turned));
    let demands = [demand(&given), demand(&turned)];
    assert_eq!(
        demand(&both),
        demands.into_iter().flatten().reduce(f64::max)
    );
    let count = |summary: &Value| ["overturns_in", "of"].map(|key| summary[key].clone());
    if let Some(certainty) = mirrored.get("certainty") {
        assert_eq!(count(certainty), count(&turned["repeatability"]));
    }
    assert_eq!(both.get("repeatability"), given.get("repeatability"));
    let order = ["survives", "incomplete", "uncertain", "overturns"];
    let severity = |summary: &Value| order.iter().position(|one| summary["verdict"] == *one);
    let verdicts = [&given, &turned].map(severity);
    assert_eq!(severity(&both), *verdicts.iter().max().unwrap());
    assert!(verdicts.iter().all(Option::is_some));
    let directions = ["direction as given", "mirrored direction"];
    for (alone, direction) in [&given, &turned].into_iter().zip(directions) {
        // A survivor of one direction may overturn in the other.
        let only = if alone["verdict"] == "survives" {
            " only"
        } else {
            ""
        };
        assert_quotes(alone, &format!("this motion in the {direction}{only}"));
    }
    let overturns = [&given, &turned].map(|alone| alone["verdict"] == "overturns");
    let peak = |summary: &Value| summary["largest_peak_rotation_rad"].as_f64();
    let due = match overturns {
        [true, true] => "overturns under this motion in both directions",
        [true, false] => "overturns under this motion in the direction as given",
        [false, true] => "overturns under this motion in the mirrored direction",
        [false, false] if peak(&turned) > peak(&given) => {
            "survives this motion in both directions (the mirrored one governs)"
        }
        [false, false] => "survives this motion in both directions",
    };
    assert_quotes(&both, due);
    [given, turned].map(|alone| alone["verdict"].as_str().unwrap().to_owned())
}

/// The scenario of the issue: as given it survives, mirrored it overturns. A negated pulse exchanges the directions.
#[test]
fn an_arch_on_piers_overturns_under_the_mirrored_motion() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(scenarios().join("pointed-arch-on-piers.toml")).unwrap();
    fs::write(folder.path().join("s.toml"), &text).unwrap();
    let verdicts = assert_both_are_the_runs_alone(folder.path(), &["--no-repeat"]);
    assert_eq!(verdicts, ["survives", "overturns"]);
    assert!(text.contains("amplitude_g = -0.35"));
    let negated = ["--set", "ground.half_sine.amplitude_g=0.35", "--no-repeat"];
    let [own, other] = [&["--no-repeat"][..], &negated].map(|more| run(folder.path(), more));
    assert_eq!(own["mirrored"]["outcome_time_s"], other["outcome_time_s"]);
    assert_eq!(other["mirrored"]["outcome_time_s"], own["outcome_time_s"]);
    assert_eq!([&own["verdict"], &other["verdict"]], ["overturns"; 2]);
}

/// Elastic joints of other stiffnesses, with more contact points, and rigid ones: each is computed in both directions with the results
/// of that direction alone, and printed in one line.
fn assert_varied_in_both(folder: &std::path::Path, both: &Value) {
    let alone = ["as_given", "mirrored"].map(|direction| run(folder, &["--direction", direction]));
    let varied = |summary: &Value| summary["variations"].as_array().unwrap().clone();
    let names = [
        "2.32 GPa/m",
        "10.8 GPa/m",
        "23.2 GPa/m",
        "50 GPa/m",
        "three contact points",
        "rigid joints (free hinges)",
    ];
    let words = words_of(both).unwrap();
    let all = pairs(varied(both), names).zip(pairs(varied(&alone[0]), varied(&alone[1])));
    for ((both, name), (given, turned)) in all {
        assert_eq!(both["with"], name);
        for key in [
            "outcome",
            "outcome_time_s",
            "overturning_sway",
            "first_peak_rad",
            "largest_peak_rotation_rad",
        ] {
            assert_eq!(both[key], given[key], "{key}");
            assert_eq!(both["mirrored"][key], turned[key], "{key}");
        }
        assert!(given.get("mirrored").is_none());
        assert_ne!(given["first_peak_rad"], turned["first_peak_rad"]);
        let in_words = |end: &Value| match end["outcome"] == "overturned" {
            true => format!(
                "overturns to the {} at {:.4} s",
                end["overturning_sway"].as_str().unwrap(),
                end["outcome_time_s"].as_f64().unwrap()
            ),
            false => format!(
                "survives, largest rotation {:.6} rad",
                end["largest_peak_rotation_rad"].as_f64().unwrap()
            ),
        };
        let line = format!(
            "  with {name}: {}; mirrored: {}",
            in_words(&given),
            in_words(&turned)
        );
        assert_eq!(words.matches(&line).count(), 1, "{line}: {words}");
    }
    // Each direction has its own repetitions.
    let counts = [&both["mirrored"]["certainty"], &both["repeatability"]];
    for (count, alone) in pairs(counts, [&alone[1], &alone[0]]) {
        assert_eq!(count["of"], alone["repeatability"]["of"]);
        assert!([3, 7].contains(&count["of"].as_u64().unwrap()), "{count}");
    }
}

/// A column with a wall of no height is one without a wall: symmetric, with the same directions, histories, verdicts and thresholds.
#[test]
fn a_wall_without_height_keeps_the_symmetry() {
    let ground =
        "[ground.one_sine]\namplitude_g = 0.35\nduration_s = 0.8\n[simulation]\nduration_s = 5.0\n";
    let back = "[column.back]\nside = 'right'\nheight_m = 0.0\n";
    for (table, more) in [
        ("", &[][..]),
        ("[free_hinges]\nlongest_step_s = 1e-3\n", &[]),
        (
            "[elastic_joints]\nlongest_step_s = 1e-4\nnormal_stiffness_gpa_m = 1.0\n",
            &[],
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let of = |column: &str| {
            fs::write(folder.join("s.toml"), format!("{column}{ground}{table}")).unwrap();
            let mut summary = run(folder, more);
            let keys = summary.as_object_mut().unwrap();
            // The scenario has the wall, and the measured time of a step differs.
            keys.remove("scenario");
            keys.remove("longest_step_us");
            let factors = [
                "threshold",
                "s.toml",
                "--from",
                "1",
                "--to",
                "1.4",
                "--stride",
                "0.2",
                "--out",
                "o",
            ];
            let words = printed(folder, &factors);
            let mut threshold = json(&folder.join("o/threshold.json"));
            let model = threshold["models"][0].as_object_mut().unwrap();
            model.remove("scenario");
            (summary, threshold, words)
        };
        let alone = of(COLUMN);
        assert!(alone.0.get("mirrored").is_none());
        assert_eq!(of(&format!("{COLUMN}{back}")), alone, "{table}");
        // A wall of any height has a side.
        let walled = format!("{COLUMN}{}restitution = 0.4\n", back.replace("0.0", "3.9"));
        if !table.contains("free_hinges") {
            assert!(of(&walled).0["mirrored"].is_object(), "{table}");
        }
    }
}

#[test]
fn the_verdict_of_a_run_is_that_of_the_worse_direction() {
    let ground =
        "[ground.one_sine]\namplitude_g = 0.35\nvertical_amplitude_g = 0.1\nduration_s = 0.6\n";
    let load = "[[load]]\nx_m = 0.25\nheight_m = 4.0\nmass_kg = 4000.0\n";
    let elastic = "[elastic_joints]\nnormal_stiffness_gpa_m = 5.0\n";
    for (structure, model) in [
        (format!("{UNEVEN_ARCH}{ON_A_PIER}"), ""),
        (format!("{UNEVEN_ARCH}{ON_A_PIER}"), "[free_hinges]\n"),
        (format!("{COLUMN}{load}"), ""),
        (format!("{COLUMN}{load}"), elastic),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.toml");
        fs::write(&path, format!("{structure}{model}{ground}")).unwrap();
        assert_both_are_the_runs_alone(folder.path(), &[]);
        if model == elastic {
            let summary = run(folder.path(), &[]);
            assert_varied_in_both(folder.path(), &summary);
        }
    }
}

/// The page opens with the worse direction and has the other one; both have the frames of the runs in one direction.
#[test]
fn the_page_has_both_directions() {
    let folder = tempfile::tempdir().unwrap();
    let ground = "[ground.one_sine]\namplitude_g = 0.3\nduration_s = 0.6\n";
    let scenario = format!("{UNEVEN_ARCH}{ON_A_PIER}{ground}");
    fs::write(folder.path().join("s.toml"), scenario).unwrap();
    let page = |out: &str, direction: &str| {
        let arguments = ["run", "s.toml", "--out", out, "--direction", direction];
        let words = printed(folder.path(), &arguments);
        let page = fs::read_to_string(folder.path().join(out).join("report.html")).unwrap();
        (words, data_of(&page), page)
    };
    let [(_, given, alone), (_, turned, _)] = ["as_given", "mirrored"].map(|name| page(name, name));
    let (words, both, html) = page("both", "both");
    assert!(alone.matches("id=\"direction\"").count() == 0);
    assert!(html.matches("id=\"direction\"").count() == 1);
    let is_mirrored = both["direction"] == "mirrored";
    let (first, second) = match is_mirrored {
        true => (&turned, &given),
        false => (&given, &turned),
    };
    for key in ["frames", "curves", "end_s", "opens_s", "layouts"] {
        assert_eq!(both[key], first[key], "{key}");
        assert_eq!(both["other"][key], second[key], "{key}");
    }
    let summary = json(&folder.path().join("both").join("summary.json"));
    let larger = summary["mirrored"]["largest_peak_rotation_rad"]
        .as_f64()
        .unwrap()
        > summary["largest_peak_rotation_rad"].as_f64().unwrap();
    let verdicts = [&summary["mirrored"]["verdict"], &summary["verdict"]];
    assert!(
        verdicts[0] != verdicts[1] || is_mirrored == larger,
        "{words}"
    );
    assert_eq!(page_of(&both.to_string()).unwrap(), html);
    let rendered = words_of(&summary).unwrap();
    // The words begin without indentation, and the lines about files are missing.
    let beginning = format!("{rendered}\n  results in ");
    assert!(
        words.trim_start().starts_with(&beginning),
        "{words}\n{rendered}"
    );
    assert!(
        words.lines().next().unwrap().contains("mirrored: "),
        "{words}"
    );
}
