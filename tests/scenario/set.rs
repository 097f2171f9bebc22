//! Values that replace those of a scenario: `--set`.

use std::fs;

use crate::common::program::{archrock, stderr};
use archrock::scenario::{Assignment, ReadOptions, Scenario, Source};

const TEXT: &str = "title = \"x\"\n\
                    [arch]\n\
                    mean_radius_m = 5.0\n\
                    thickness_ratio = 0.15\n\
                    embrace_deg = 180.0\n\
                    [ground.rectangular]\n\
                    amplitude_g = -0.3\n\
                    duration_s = 0.2\n";

fn read(set: &[&str]) -> Result<Scenario, String> {
    let set: Vec<Assignment> = set.iter().map(|one| one.parse().unwrap()).collect();
    let changes = ReadOptions {
        model: None,
        set: &set,
        ..ReadOptions::default()
    };
    Scenario::of(&Source::of_text(TEXT, "s.toml"), &changes).map_err(|errors| errors.to_string())
}

/// The scenario from the text as edited by hand.
fn edited(old: &str, new: &str) -> Scenario {
    assert!(TEXT.contains(old));
    Scenario::parse(&TEXT.replace(old, new), "s.toml").unwrap()
}

#[test]
fn an_assignment_equals_an_edit_of_the_text() {
    assert_eq!(
        read(&["arch.thickness_ratio=0.12"]).unwrap(),
        edited("0.15", "0.12")
    );
    assert_eq!(
        read(&["title = A title"]).unwrap(),
        edited("\"x\"", "\"A title\"")
    );
    // New keys, new tables, nested tables.
    assert_eq!(
        read(&["simulation.duration_s=3", "arch.voussoirs=21"]).unwrap(),
        edited(
            "embrace_deg = 180.0\n",
            "embrace_deg = 180.0\nvoussoirs = 21\n[simulation]\nduration_s = 3\n"
        )
    );
    assert_eq!(
        read(&["ground.rectangular.start_s=1"]).unwrap(),
        edited("duration_s = 0.2", "duration_s = 0.2\nstart_s = 1")
    );
    // If a key is set twice, the later value counts.
    assert_eq!(
        read(&["arch.embrace_deg=150", "arch.embrace_deg=157.5"]).unwrap(),
        edited("180.0", "157.5")
    );
    // A whole table.
    assert_eq!(
        read(&["ground={one_sine={amplitude_g=0.5, duration_s=1}}"]).unwrap(),
        edited(
            "[ground.rectangular]\namplitude_g = -0.3\nduration_s = 0.2",
            "[ground.one_sine]\namplitude_g = 0.5\nduration_s = 1"
        )
    );
    // A string needs no quotation marks; a list and a range are written as in the file.
    assert_eq!(
        read(&["impact.model=mirrored"]).unwrap(),
        read(&["impact.model=\"mirrored\""]).unwrap()
    );
    let map = read(&[
        "map.amplitude_g=[0.2, 0.3]",
        "map.duration_s={from=0.1, to=0.2, count=3}",
    ]);
    assert!(map.unwrap().map.is_some());
}

#[test]
fn a_wrong_assignment_is_refused_like_a_wrong_line() {
    for (set, message) in [
        (
            "arch.thickness_ratio=3",
            "--set arch.thickness_ratio=3: `thickness_ratio = 3` is out of range; must be a number",
        ),
        (
            "arch.thickness_ratio=0,12",
            "--set arch.thickness_ratio=0,12: `thickness_ratio = \"0,12\"` is a string; must be a number",
        ),
        (
            "arch.tickness_ratio=0.1",
            "--set arch.tickness_ratio=0.1: unknown key `tickness_ratio` in [arch] (did you mean `thickness_ratio`?)",
        ),
        (
            "title.x=1",
            "--set title.x=1: table `title` is a table; must be a string",
        ),
        (
            "ground.one_sine.duration_s=1",
            "--set ground.one_sine.duration_s=1: `one_sine` cannot be combined with `rectangular`",
        ),
        (
            "arch.thickness_ratio=0.01",
            "--set arch.thickness_ratio=0.01: `thickness_ratio = 0.01` makes an arch that cannot carry its own weight",
        ),
    ] {
        let errors = read(&[set]).unwrap_err();
        assert!(
            errors.lines().any(|line| line.starts_with(message)),
            "{errors}"
        );
    }
    // Errors of the text keep their places.
    let errors = read(&["arch.embrace_deg=200", "ground.rectangular.amplitude_g=x"]).unwrap_err();
    assert_eq!(errors.lines().count(), 2, "{errors}");
    let text = TEXT.replace("5.0", "-5.0");
    let set = ["arch.embrace_deg=200".parse().unwrap()];
    let changes = ReadOptions {
        model: None,
        set: &set,
        ..ReadOptions::default()
    };
    let errors = Scenario::of(&Source::of_text(&text, "s.toml"), &changes).unwrap_err();
    let errors = errors.to_string();
    let mut lines = errors.lines();
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("s.toml:3:17: `mean_radius_m = -5.0`")
    );
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("--set arch.embrace_deg=200:")
    );
}

/// Keys of list entries, named by their numbers, for `--set` and for the axes of a map.
#[test]
fn entries_of_lists_are_counted_from_one() {
    let loads = |masses: [f64; 2]| {
        let [one, two] = masses.map(|mass| format!("[[load]]\nmass_kg = {mass}\nx_m = 1.0\n"));
        let arch = TEXT.replace("180.0\n", "180.0\nvoussoirs = 20\n");
        format!("{arch}{one}{two}")
    };
    let text = loads([500.0, 800.0]);
    let read = |set: &str| {
        let set = [set.parse().unwrap()];
        let changes = ReadOptions {
            model: None,
            set: &set,
            ..ReadOptions::default()
        };
        Scenario::of(&Source::of_text(&text, "s.toml"), &changes)
    };
    let parsed = |text: &str| Scenario::parse(text, "s.toml").unwrap();
    let set = read("load.2.mass_kg=600").unwrap();
    assert_eq!(set, parsed(&loads([500.0, 600.0])));
    let set = read("load.1={mass_kg=600, x_m=1}").unwrap();
    assert_eq!(set, parsed(&loads([600.0, 800.0])));
    let varied = parsed(&text).with_values(&[("load.1.mass_kg", 700.0)]);
    assert_eq!(varied.unwrap(), parsed(&loads([700.0, 800.0])));
    for (set, message) in [
        (
            "load.3.mass_kg=600",
            "--set load.3.mass_kg=600: `load` is a list, whose entries are `load.1` to `load.2`: `load.3` is none",
        ),
        (
            "load.0.mass_kg=600",
            "--set load.0.mass_kg=600: `load` is a list",
        ),
        (
            "load.mass_kg=600",
            "--set load.mass_kg=600: `load` is a list",
        ),
        (
            "load.2.mass_kg=-1",
            "--set load.2.mass_kg=-1: `mass_kg = -1` is out of range",
        ),
        (
            "load.2.mas_kg=1",
            "--set load.2.mas_kg=1: unknown key `mas_kg`",
        ),
    ] {
        let errors = read(set).unwrap_err().to_string();
        assert!(errors.starts_with(message), "{errors}");
    }
}

#[test]
fn an_invalid_assignment_is_reported() {
    for wrong in ["", "x", "x=", "=1", "a b=1", "a..b=1", "[arch]=1"] {
        let error = wrong.parse::<Assignment>().unwrap_err();
        assert!(error.contains("arch.thickness_ratio=0.12"), "{error}");
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), TEXT).unwrap();
    let refused = archrock(folder.path(), &["check", "s.toml", "--set", "x"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        stderr(&refused).contains("must be a key, `=` and a value"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn every_command_takes_assignments() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), TEXT).unwrap();
    for command in [
        "check",
        "limit",
        "impact",
        "run",
        "map",
        "suite",
        "threshold",
    ] {
        let refused = archrock(
            folder.path(),
            &[command, "s.toml", "--set", "arch.embrace_deg=200"],
        );
        assert_eq!(refused.status.code(), Some(2), "{command}");
        assert!(
            stderr(&refused).contains("--set arch.embrace_deg=200: "),
            "{command}: {}",
            stderr(&refused)
        );
    }
    let thinner = archrock(
        folder.path(),
        &["check", "s.toml", "--set", "arch.thickness_ratio=0.12"],
    );
    let printed = String::from_utf8(thinner.stdout).unwrap();
    assert_eq!(
        Scenario::parse(&printed, "s.toml").unwrap(),
        edited("0.15", "0.12")
    );
}

/// Faults of loads name their assignment, or the line of their key.
#[test]
fn faults_of_loads_have_places() {
    let loads = "[[load]]\nmass_kg = 100\n[[load]]\nthrust_n = 500\nheight_m = 5\n";
    let column = "[column]\nheight_m = 8\nwidth_m = 0.6\n";
    let errors = |text: &str, set: &str| {
        let set: Vec<Assignment> = set
            .split_whitespace()
            .map(|one| one.parse().unwrap())
            .collect();
        let options = ReadOptions {
            set: &set,
            ..ReadOptions::default()
        };
        let read = Scenario::of(&Source::of_text(text, "s.toml"), &options);
        read.unwrap_err().to_string()
    };
    let text = format!("{column}{loads}");
    for (text, set, message) in [
        (
            &text,
            "load.1.height_m=8.5",
            "--set load.1.height_m=8.5: `height_m = 8.5` of load 1 is not allowed; must be from 0 to",
        ),
        (
            &text,
            "load.1.mass_kg=200 load.2.thrust_n=1e9",
            "--set load.2.thrust_n=1e9: `[[load]]` overturns the column to the right",
        ),
        (
            &text.replace("= 5\n", "= 9\n"),
            "",
            "s.toml:8:12: `height_m = 9` of load 2 is not allowed",
        ),
        (
            &text.replace("500", "1e9"),
            "",
            "s.toml:4:1: `[[load]]` overturns the column",
        ),
        (
            &column.to_owned(),
            "load.1.thrust_n=5",
            "--set load.1.thrust_n=5: `load.1` is an entry of a list, and the scenario has no `load`",
        ),
        (
            &text.replace("mass_kg = 100\n", ""),
            "",
            "s.toml:4:1: [[load]] needs one of the keys mass_kg, thrust_n",
        ),
        (
            &format!("{text}[initial]\nsway = 'right'\nimpulse_n_s = 10\nheight_m = 9\n"),
            "",
            "s.toml:12:12: `height_m = 9` is above the column; must be at most 8 m",
        ),
        (
            &text,
            "column.back={side='left'} load.1.mass_kg=3000 load.1.x_m=-1.5",
            "--set load.1.x_m=-1.5: `[[load]]` turns the column over the top of the wall on its left",
        ),
    ] {
        let errors = errors(text, set);
        assert!(errors.starts_with(message), "{errors}");
        assert_eq!(errors.lines().count(), 1, "{errors}");
    }
    let nested = errors(
        &format!("{column}[suite]\nscales = [1]\n"),
        "suite.record.1.scale=2",
    );
    assert!(
        nested.contains("no `suite.record`; give the list, as [[suite.record]] in the file"),
        "{nested}"
    );
    let varied = |range: &str| {
        errors(
            &format!("{text}[uncertain]\n\"load.2.thrust_n\" = {range}\n"),
            "",
        )
    };
    let varied = varied("{ from = 0, to = 1e9 }");
    assert!(
        varied.contains(
            "`load.2.thrust_n` reaches 1e9, which the scenario does not allow: `[[load]]` overturns the column"
        ),
        "{varied}"
    );
}
