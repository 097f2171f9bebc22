//! Caveats and warnings: each command gives them, in words and in its JSON file.

use std::fs;

use serde_json::Value;

use crate::common::program::{archrock, scenarios, stderr};
use crate::common::results::json;
use crate::common::{ARCH, COLUMN, parsed};

const PULSE: &str = "[ground.one_sine]\namplitude_g = 0.4\nduration_s = 0.8\n";
const OUTSIDE: &str =
    " are outside the model of four links (the thrust line leaves the arch by more than ";
const LIMITS: &str =
    "four links are a rough guide, not on the safe side: the thrust line leaves the arch by up to ";

/// The warnings in a JSON file.
fn warnings(file: &Value) -> Vec<&str> {
    let all = file["warnings"].as_array().unwrap();
    all.iter()
        .map(|warning| warning.as_str().unwrap())
        .collect()
}

/// Every study follows the line of thrust, and counts the histories outside the model of four links; a column has no line of thrust that could leave
/// it.
#[test]
fn histories_outside_the_model_of_four_links_are_counted_in_every_study() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::copy(scenarios().join("records/wave-1.at2"), at.join("w.at2")).unwrap();
    let tables = "[map]\nduration_s = [0.4, 0.8]\namplitude_g = [0.2, 3.0]\n\
                  [suite]\nrecords = 'w.at2'\npeaks_g = [0.2, 3.0]\n\
                  [simulation]\nduration_s = 60.0\n[uncertain]\nsamples = 2\n";
    let arch = format!("{ARCH}{PULSE}{tables}'arch.thickness_ratio' = {{ deviation = 0.001 }}\n");
    let column = format!("{COLUMN}{PULSE}{tables}'column.width_m' = {{ deviation = 0.001 }}\n");
    fs::write(at.join("arch.toml"), &arch).unwrap();
    fs::write(at.join("column.toml"), &column).unwrap();
    for (command, files) in [
        ("map", &["map.json", "uncertain_map/uncertain.json"][..]),
        (
            "suite",
            &["fragility.json", "uncertain_suite/uncertain.json"],
        ),
        (
            "threshold",
            &["threshold.json", "uncertain_threshold/uncertain.json"],
        ),
    ] {
        for (name, is_arch) in [("arch.toml", true), ("column.toml", false)] {
            let out = format!("{command}-{name}");
            let mut arguments = vec![command, name, "--out", &out];
            if command == "threshold" {
                arguments.extend(["--stride", "0.5"]);
            }
            let output = archrock(at, &arguments);
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
            let said = stderr(&output) + &String::from_utf8(output.stdout).unwrap();
            assert_eq!(said.contains(OUTSIDE), is_arch, "{command}: {said}");
            for file in files {
                let file = json(&at.join(&out).join(file));
                let mut reported = warnings(&file);
                let looking = "a map of four links is for looking";
                let is_map = is_arch && command == "map";
                assert_eq!(said.contains(looking), is_map, "{command}: {said}");
                let looked_at = |warning: &&str| warning.contains(looking);
                let is_own = is_map && file.get("outcomes").is_some();
                assert_eq!(reported.iter().any(looked_at), is_own, "{reported:?}");
                reported.retain(|warning| {
                    !warning.contains("friction coefficient") && !warning.contains(looking)
                });
                assert_eq!(
                    reported.len(),
                    usize::from(is_arch),
                    "{command} {reported:?}"
                );
                // Thresholds of samples may be inside the model.
                assert!(
                    reported
                        .iter()
                        .all(|warning| warning.contains("not on the safe side"))
                );
            }
        }
    }
}

/// A run follows the line of thrust, and its summary has the printed numbers and warnings.
#[test]
fn the_summary_lists_the_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = format!("{ARCH}{PULSE}");
    fs::write(at.join("s.toml"), &text).unwrap();
    let output = archrock(at, &["run", "s.toml", "--out", "o", "--no-report"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains(LIMITS), "{said}");
    let summary = json(&at.join("o/summary.json"));
    let reported = warnings(&summary);
    assert!(reported[0].starts_with(LIMITS), "{reported:?}");
    assert!(
        reported
            .iter()
            .any(|warning| warning.contains("needs a friction coefficient of ")),
        "{reported:?}"
    );
    // Unlikely numbers, which the program prints as warnings.
    let text = text.replace("= 5.0", "= 500").replace("= 0.4", "= 30");
    fs::write(at.join("s.toml"), text).unwrap();
    let output = archrock(at, &["run", "s.toml", "--out", "o", "--no-report"]);
    let summary = json(&at.join("o/summary.json"));
    for unlikely in [
        "the mean radius is 500 m: is it in centimetres?",
        "the pulse peaks at 30 g: is its amplitude in units of gravity? It looks like per cent of gravity",
    ] {
        assert!(warnings(&summary).contains(&unlikely), "{summary:#}");
        assert!(stderr(&output).contains(&format!("warning: {unlikely}")));
    }
    // Static commands give these warnings too, and their JSON lists them.
    let demand = "[demand]\nsoil = 'B'\ntopography = 'T1'\nslv = { ag_g = 0.2, f0 = 2.4, tc_star_s = 0.3 }\n";
    let arch = ARCH.replace("= 5.0", "= 500") + "voussoirs = 15\n";
    fs::write(at.join("s.toml"), arch + demand).unwrap();
    for command in ["limit", "impact", "capacity", "spread", "verify"] {
        let output = archrock(at, &[command, "s.toml", "--format", "json"]);
        let (said, radius) = (stderr(&output), "the mean radius is 500 m");
        assert!(
            said.contains(&format!("warning: {radius}")),
            "{command}: {said}"
        );
        let found = serde_json::from_slice(&output.stdout).unwrap();
        let mut reported = warnings(&found).into_iter();
        assert!(reported.any(|warning| warning.contains(radius)), "{found}");
    }
    // A column that barely rocks has none.
    fs::write(
        at.join("s.toml"),
        format!("{COLUMN}{}", PULSE.replace("0.4", "0.21")),
    )
    .unwrap();
    archrock(at, &["run", "s.toml", "--out", "o", "--no-report"]);
    assert!(warnings(&json(&at.join("o/summary.json"))).is_empty());
}

/// On springings that have moved far, a small fraction of the strength of the undeformed arch starts motion; this raises no doubt
/// about the unit of a pulse.
#[test]
fn moved_springings_cause_no_warning_about_units() {
    let arch = format!(
        "{ARCH}voussoirs = 16\n[free_hinges]\n[supports]\nright = {{ spread_m = 0.5 }}\n\
         [ground.rectangular]\namplitude_g = 0.7\nduration_s = 0.2\n"
    );
    let scenario = parsed(&arch);
    let model = scenario.model().unwrap();
    let starts = [archrock::Sway::Right, archrock::Sway::Left];
    let starts = starts.map(|sway| model.incipient_acceleration_g(sway).unwrap());
    assert!(starts[0].min(starts[1]) < 0.7 / 20.0, "{starts:?}");
    assert_eq!(scenario.unlikely_values(), [""; 0]);
    // A pulse in a wrong unit still causes the warning.
    let strong = parsed(&arch.replace("= 0.7\nd", "= 30\nd"));
    assert!(strong.unlikely_values()[0].contains("in units of gravity"));
}
