//! The words and the pages of a run and of a map are functions of their JSON: they are rendered again from the files.

use std::fs;
use std::path::Path;

use crate::common::program::{archrock, printed, scenarios, stdout};
use crate::common::results::json;
use archrock::studies::map;
use archrock::studies::run::{page_of, words_of};
use serde_json::Value;

/// Removes the lines about files from printed words, and the heading before the first of these lines.
fn words(printed: &str, first: &str) -> String {
    let about_files = |line: &&str| {
        let begins = ["  results in ", "both in ", "all in ", "  snapshots at "];
        begins.iter().any(|begin| line.starts_with(begin))
    };
    let lines = printed.lines().skip_while(|line| line.trim() != first);
    let lines: Vec<&str> = lines.filter(|line| !about_files(line)).collect();
    lines.join("\n").trim().to_owned()
}

/// Runs a scenario, and compares the printed words with those of its `summary.json`. Returns them.
fn rendered_again(folder: &Path, scenario: &str, options: &[&str]) -> String {
    let arguments = [&["run", scenario, "--out", "o", "--no-report"], options].concat();
    let said = printed(folder, &arguments);
    let again = words_of(&json(&folder.join("o/summary.json"))).unwrap();
    assert_eq!(words(&said, again.lines().next().unwrap()), again);
    again
}

/// An arch whose outcome depends on the steps.
const UNCERTAIN_ARCH: &str = "[arch]\nmean_radius_m = 4.609197050803642\nthickness_ratio = 0.13306427265472975\nembrace_deg = 157.5\nvoussoirs = 5\n\
         [free_hinges]\nfriction_coefficient = 0.5969922684006939\n\
         [ground.one_sine]\namplitude_g = 0.808543\nduration_s = 0.46925101434657324\n[simulation]\noutput_step_s = 0.05\n";

#[test]
fn words_of_a_run_are_rendered_again_from_its_json() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("uncertain.toml"), UNCERTAIN_ARCH).unwrap();
    let varied = "[column]\nheight_m = 3.0\nwidth_m = 0.6\ndrums = 3\n[elastic_joints]\nnormal_stiffness_gpa_m = 20.0\ncompressive_strength_mpa = 10.0\n\
         [ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.4\n";
    fs::write(at.join("varied.toml"), varied).unwrap();
    let file = |name: &str| format!("{}", scenarios().join(name).display());
    for (scenario, options, shown) in [
        (file("semicircle-pulse.toml"), &[][..], "four links"),
        (file("column-pulse.toml"), &[], "restitution"),
        (file("never-moved.toml"), &[], "never moves"),
        (file("overturning-at-once.toml"), &[], "overturns to the"),
        (
            file("voussoirs-step-pair.toml"),
            &["--hinges", "free", "--point", "0,10"],
            "the point 0,10 moves",
        ),
        (file("two-feet.toml"), &[], "the right foot moves by"),
        (
            file("tie.toml"),
            &["--set", "simulation.duration_s=1"],
            "tie 1 pulled with",
        ),
        (
            file("drums-step-pair.toml"),
            &["--set", "simulation.duration_s=0.5"],
            "NO VERDICT",
        ),
        ("uncertain.toml".to_owned(), &[], "UNCERTAIN: overturns in"),
        ("varied.toml".to_owned(), &[], "with rigid joints"),
    ] {
        let words = rendered_again(at, &scenario, options);
        assert!(words.contains(shown), "{words}");
    }
}

#[test]
fn words_of_several_models_are_rendered_again_from_their_json() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenarios().join("semicircle-pulse.toml");
    let scenario = scenario.to_str().unwrap();
    let options = [
        "run",
        scenario,
        "--hinges",
        "four,free,elastic",
        "--set",
        "arch.voussoirs=7",
        "--set",
        "elastic_joints.normal_stiffness_gpa_m=20",
        "--no-report",
    ];
    let said = printed(folder.path(), &options);
    let answer = archrock(
        folder.path(),
        &[&options[..], &["--format", "json"]].concat(),
    );
    let json: Value = serde_json::from_str(&stdout(&answer)).unwrap();
    let again = words_of(&json).unwrap();
    assert_eq!(words(&said, again.lines().next().unwrap()), again);
    assert!(again.contains("compared with elastic joints"), "{again}");
}

/// The JSON of a command on several models with samples also has the comparison of their largest rotations.
#[test]
fn words_of_models_with_samples_are_rendered_again() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[column]\nheight_m = 4\nwidth_m = 0.8\n[ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.5\n\
                [uncertain]\nsamples = 3\n'column.width_m' = { from = 0.7, to = 0.9 }\n";
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let options = ["run", "s.toml", "--hinges", "four,free", "--out", "o"];
    let answer = archrock(
        folder.path(),
        &[&options[..], &["--format", "json"]].concat(),
    );
    let json: Value = serde_json::from_str(&stdout(&answer)).unwrap();
    assert!(json["peaks"].is_object() && json["free"]["uncertain"].is_object());
    let said = printed(folder.path(), &options);
    let again = words_of(&json).unwrap();
    assert_eq!(words(&said, again.lines().next().unwrap()), again);
}

#[test]
fn the_page_of_a_run_is_rendered_again_from_its_data() {
    let folder = tempfile::tempdir().unwrap();
    for (scenario, options) in [
        ("column-pulse.toml", &[][..]),
        ("overturning-at-once.toml", &["--point", "0,5"]),
        ("tie.toml", &["--no-repeat"]),
        ("two-feet.toml", &["--no-repeat"]),
    ] {
        let scenario = scenarios().join(scenario);
        let arguments = [&["run", scenario.to_str().unwrap(), "--out", "o"], options].concat();
        printed(folder.path(), &arguments);
        let page = fs::read_to_string(folder.path().join("o/report.html")).unwrap();
        let data = between(&page, "id=\"data\">", "</script>");
        assert!(page_of(data).unwrap() == page, "{scenario:?}");
    }
}

/// Returns the part of a page between two marks.
fn between<'p>(page: &'p str, before: &str, after: &str) -> &'p str {
    let (_, rest) = page.split_once(before).unwrap();
    rest.split_once(after).unwrap().0
}

/// The page is a function of the picture and the data inside it. Cells that are uncertain, or outside the model of four links, are in the data.
#[test]
fn the_page_of_a_map_is_rendered_again_from_its_data() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let uncertain = UNCERTAIN_ARCH.to_owned()
        + "[map]\nduration_s = [0.46925101434657324, 0.5]\namplitude_g = [0.6, 0.8215]\n";
    fs::write(at.join("uncertain.toml"), uncertain).unwrap();
    let semicircle = scenarios().join("semicircle-map.toml");
    let semicircle = semicircle.to_str().unwrap();
    let samples = "uncertain={ samples = 3, \"arch.thickness_ratio\" = { deviation = 0.005 } }";
    let few = [
        "--set",
        "map.duration_s.count=4",
        "--set",
        "map.amplitude_g.count=4",
    ];
    for (scenario, options, page, shown) in [
        (semicircle, &[][..], "map.html", "\"outside\":[1,"),
        (
            semicircle,
            &["--color", "peak", "--dimensionless"],
            "map.html",
            "\"outside\":[1,",
        ),
        (
            semicircle,
            &["--set", samples],
            "uncertain_map/map.html",
            "\"kinds\"",
        ),
        (
            "uncertain.toml",
            &["--set", "map.repeat=true"],
            "map.html",
            "\"doubts\":{\"1\":\"overturns in 1 of 7 repetitions\"}",
        ),
    ] {
        let few = if scenario == semicircle {
            &few[..]
        } else {
            &[]
        };
        let arguments = [&["map", scenario, "--out", "o"], few, options].concat();
        printed(at, &arguments);
        let page = fs::read_to_string(at.join("o").join(page)).unwrap();
        let picture = between(
            &page,
            "aria-describedby=\"numbers\">\n",
            "<div id=\"cell\">",
        );
        let data = between(&page, "id=\"data\">", "</script>");
        assert!(data.contains(shown), "{options:?}: {data}");
        assert!(map::page_of(picture, data).unwrap() == page, "{options:?}");
        fs::remove_dir_all(at.join("o")).unwrap();
    }
}
