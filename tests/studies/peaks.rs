//! How close a structure came to overturning: a line per record, and the picture of incremental dynamic analysis.

use std::fs;

use crate::common::program::stdout;
use crate::common::program::{archrock, scenarios, stderr};
use crate::common::results::{Row, Table, json, named, strokes};
use archrock::dynamics::FreeHinges;
use archrock::mechanics::four_link::ImpactModel;
use archrock::mechanics::{FourLinks, Mechanism as _, MechanismChain as _};
use archrock::{Arch, GroundMotion, Initial, Model as _, Request, Sway};
use serde_json::Value;

const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[simulation]\nduration_s = 30\n";

/// A folder with two records and a scenario of them.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for record in ["wave-1.at2", "wave-2.at2"] {
        fs::copy(
            scenarios().join("records").join(record),
            folder.path().join(record),
        )
        .unwrap();
    }
    let text = format!(
        "{COLUMN}[ground.record]\nfile = 'wave-1.at2'\n\
         [suite]\nrecords = 'wave-*.at2'\npeaks_g = {{ from = 0.2, to = 4.0, count = 20, spacing = 'logarithmic' }}\n"
    );
    fs::write(folder.path().join("s.toml"), text).unwrap();
    folder
}

/// Four digits of a number, and four digits that are not above it.
fn four(value: f64) -> [String; 2] {
    let digits = (3.0 - value.log10().floor()).max(0.0) as usize;
    let long = format!("{value:.12}");
    let point = long.find('.').unwrap();
    [
        format!("{value:.digits$}"),
        long[..=point + digits].to_owned(),
    ]
}

/// A number with four digits that is not above the first, and the second with four digits, or with the digits by which they differ.
fn edge([safe, first]: [f64; 2]) -> [String; 2] {
    let ([_, below], [above, _]) = (four(safe), four(first));
    let more = |digits: usize| {
        let long = format!("{safe:.12}");
        let point = long.find('.').unwrap();
        [
            long[..=point + digits].to_owned(),
            format!("{first:.digits$}"),
        ]
    };
    let digits = above.len() - above.find('.').map_or(above.len(), |point| point + 1);
    let mut longer = [[below, above]]
        .into_iter()
        .chain((digits + 1..12).map(more));
    longer.find(|[below, above]| below != above).unwrap()
}

/// The words that follow from the bands and gaps of `threshold.json`.
fn words(threshold: &Value) -> String {
    let model = &threshold["models"][0];
    let number = |value: &Value| value.as_f64().unwrap();
    let peak_g = number(&threshold["peak_acceleration_g"]);
    let [safe, first] = ["survives_up_to_factor", "lowest_factor"].map(|key| number(&model[key]));
    // The safe factor is just below the edge.
    assert!(
        safe < first && first < safe * (1.0 + 2e-4),
        "{safe} {first}"
    );
    let [safe_g, first_g] = edge([safe, first].map(|factor| factor * peak_g));
    let ends = |from: &Value, to: &Value| {
        let [[from, _], [to, _]] = [from, to].map(|end| four(number(end)));
        format!("{from} to {to}")
    };
    let gaps = model["gaps"].as_array().unwrap().iter();
    let mut gaps: Vec<String> = gaps.map(|gap| ends(&gap["from"], &gap["to"])).collect();
    let last = model["bands"].as_array().unwrap().last().unwrap();
    if last["to_end"] == "edge" {
        gaps.push(ends(&last["to"], &threshold["factors"]["to"]));
    }
    let gaps = match gaps.join(", ") {
        none if none.is_empty() => none,
        gaps => format!(" (gaps above: {gaps})"),
    };
    let [safe, first] = edge([safe, first]);
    format!("survives up to {safe} ({safe_g} g); overturns from {first} ({first_g} g){gaps}")
}

const OPTIONS: [&str; 6] = ["--from", "0.5", "--to", "12", "--stride", "0.05"];

#[test]
fn a_threshold_of_a_record_is_one_line() {
    let folder = folder();
    let path = folder.path();
    let said = stdout(&archrock(
        path,
        &[&["threshold", "s.toml"], &OPTIONS[..]].concat(),
    ));
    let found = json(&path.join("results/s/threshold.json"));
    let line = format!("  wave-1.at2: {}", words(&found));
    assert_eq!(said.lines().next().unwrap(), line, "{said}");
    assert_eq!(said.matches("overturns").count(), 1, "{said}");
}

#[test]
fn each_record_of_a_suite_can_be_run_and_have_its_threshold() {
    let folder = folder();
    let path = folder.path();
    let all = archrock(
        path,
        &[&["threshold", "s.toml", "--suite"], &OPTIONS[..]].concat(),
    );
    let said = stdout(&all);
    for record in ["wave-1.at2", "wave-2.at2"] {
        let mut lines = said.lines();
        let line = lines
            .find(|line| line.starts_with(&format!("  {record}: ")))
            .unwrap();
        let found = json(&path.join("results/s").join(record).join("threshold.json"));
        assert_eq!(line, format!("  {record}: {}", words(&found)));
        let scenario = &found["models"][0]["scenario"];
        assert_eq!(scenario["ground"]["record"]["file"], record);
        assert_eq!(scenario.get("suite"), None);
    }
    // The first record is also that of [ground].
    let single = archrock(
        path,
        &[&["threshold", "s.toml", "--out", "o"], &OPTIONS[..]].concat(),
    );
    assert_eq!(stdout(&single).lines().next(), said.lines().next());
    let both = [
        &["threshold", "s.toml", "--suite", "--format", "json"],
        &OPTIONS[..],
    ]
    .concat();
    let both: Value = serde_json::from_str(&stdout(&archrock(path, &both))).unwrap();
    assert_eq!(
        both[1],
        json(&path.join("results/s/wave-2.at2/threshold.json"))
    );

    let said = stdout(&archrock(path, &["run", "s.toml", "--suite"]));
    for record in ["wave-1.at2", "wave-2.at2"] {
        assert!(said.contains(&format!("  {record}: ")), "{said}");
        let summary = json(&path.join("results/s").join(record).join("summary.json"));
        let shaking = &summary["scenario"]["ground"]["record"];
        assert_eq!(shaking["file"], record);
        assert_eq!(shaking["start_s"].to_string(), "0.0");
    }
    // The same as if it were the ground of the scenario.
    stdout(&archrock(path, &["run", "s.toml", "--out", "o"]));
    assert_eq!(
        fs::read(path.join("o/rotations.csv")).unwrap(),
        fs::read(path.join("results/s/wave-1.at2/rotations.csv")).unwrap()
    );
    // If two records had the same name, the results of one would replace those of the other.
    for place in ["a", "b"] {
        fs::create_dir(path.join(place)).unwrap();
        fs::copy(path.join("wave-1.at2"), path.join(place).join("w.at2")).unwrap();
    }
    let text = fs::read_to_string(path.join("s.toml")).unwrap();
    let twins = text.replace("wave-*.at2", "*/w.at2");
    assert_ne!(text, twins);
    fs::write(path.join("twins.toml"), twins).unwrap();
    for command in ["run", "threshold"] {
        let refused = archrock(path, &[command, "twins.toml", "--suite"]);
        assert_eq!(refused.status.code(), Some(2));
        let said = stderr(&refused);
        let both = "b/w.at2 would both have their results in results/twins/w.at2: rename one";
        assert!(
            said.contains("a/w.at2 and ") && said.contains(both),
            "{said}"
        );
        assert!(!path.join("results/twins").exists());
    }
    fs::write(path.join("t.toml"), COLUMN).unwrap();
    for command in ["run", "threshold"] {
        let refused = archrock(path, &[command, "t.toml", "--suite"]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(
            stderr(&refused).contains("t.toml: --suite is for a scenario with a table [suite]")
        );
    }
}

#[test]
fn a_suite_prints_a_line_per_record_and_draws_the_peaks() {
    let folder = folder();
    let path = folder.path();
    let output = archrock(path, &["suite", "s.toml"]);
    let said = stdout(&output);
    let rows = Table::read(path.join("results/s/suite.csv")).rows;
    let capacities = Table::read(path.join("results/s/capacities.csv")).rows;
    let picture = fs::read_to_string(path.join("results/s/ida.svg")).unwrap();
    let picture = roxmltree::Document::parse(&picture).unwrap();
    let marks = |name: &str| named(&picture, name).len();
    let mut overturned = 0;
    for record in ["wave-1.at2", "wave-2.at2"] {
        let own: Vec<_> = rows
            .iter()
            .filter(|row| row["record"] == record && row["sign"] == "1")
            .collect();
        assert_eq!(own.len(), 20);
        overturned += own
            .iter()
            .filter(|row| row["outcome"] == "overturned")
            .count();
        // The least level that overturns; and beyond it the others, each run of survivors given by its ends.
        let first = own
            .iter()
            .position(|row| row["outcome"] == "overturned")
            .unwrap();
        let peak = |row: &Row| four(row.number("peak_g"))[0].clone();
        // That level is narrowed by bisection, as in capacities.csv.
        let mut capacity = capacities.iter();
        let edge = capacity
            .find(|row| row["record"] == record && row["sign"] == "1")
            .unwrap();
        assert!(edge.number("peak_g") < own[first].number("peak_g"));
        // The safe level is at most the width of the bisection below it.
        let scale = edge.number("survives_up_to_scale");
        assert!(scale < edge.number("scale") && edge.number("scale") < 1.0021 * scale);
        let safe_g = scale * edge.number("peak_g") / edge.number("scale");
        let [safe_g, first_g] = self::edge([safe_g, edge.number("peak_g")]);
        let expected = format!("  {record}: survives up to {safe_g} g; overturns from {first_g} g");
        let again: Vec<String> = own[first..]
            .chunk_by(|a, b| (a["outcome"] == "overturned") == (b["outcome"] == "overturned"))
            .filter(|run| run[0]["outcome"] != "overturned")
            .map(|run| match run {
                [only] => format!("{} g", peak(only)),
                [from, .., to] => format!("{} to {} g", peak(from), peak(to)),
                [] => unreachable!(),
            })
            .collect();
        // A finer search may find further gaps between the levels.
        let line = said.lines().find(|line| line.starts_with(&expected));
        let line = line.unwrap_or_else(|| panic!("{expected}\n{said}"));
        assert!(
            again.iter().all(|gap| line.contains(gap)),
            "{again:?} {line}"
        );
        assert_eq!(marks(record), 1, "a curve");
    }
    assert_eq!(marks("overturned"), overturned);
    assert_eq!(marks("survived"), 40 - overturned);
    // Mirrored records give mirrored results, and need no line of their own.
    assert!(!said.contains("mirrored"), "{said}");
}

/// Potential energy of a block at this rotation, relative to that at its unstable equilibrium, from Housner's diagonal.
fn potential_ratio(slenderness_rad: f64, rotation_rad: f64) -> f64 {
    ((slenderness_rad - rotation_rad).cos() - slenderness_rad.cos()) / (1.0 - slenderness_rad.cos())
}

#[test]
fn potential_ratio_of_a_block_follows_from_its_peak_rotation() {
    let slenderness_rad = 0.2_f64.atan();
    for (amplitude_g, overturns) in [(0.25, false), (0.35, false), (0.5, true)] {
        let folder = tempfile::tempdir().unwrap();
        let scenario = format!(
            "{COLUMN}[free_hinges]\n[ground.one_sine]\namplitude_g = {amplitude_g}\nduration_s = 0.8\n"
        );
        fs::write(folder.path().join("s.toml"), scenario).unwrap();
        let arguments = ["run", "s.toml", "--out", "o", "--no-repeat"];
        let said = stdout(&archrock(folder.path(), &arguments));
        let summary = json(&folder.path().join("o/summary.json"));
        assert_eq!(summary["outcome"] == "overturned", overturns);
        let peak_rad = summary["peak_rotation_1_rad"].as_f64().unwrap();
        let due = if overturns {
            1.0
        } else {
            potential_ratio(slenderness_rad, peak_rad)
        };
        let ratio = summary["peak_potential_over_barrier"].as_f64().unwrap();
        assert!((ratio - due).abs() < 1e-7, "{ratio} {due}");
        let words = if overturns {
            "  passed the barrier beyond which it overturns\n".to_owned()
        } else {
            let percent = (1e3 * due).floor() / 10.0;
            format!(
                "  reached {percent:.1} % of the potential energy at which its first mechanism overturns\n"
            )
        };
        assert!(said.contains(&words), "{said}");
    }
}

/// A structure released at rest on still ground never rises above the height of release.
#[test]
fn a_released_arch_has_the_potential_ratio_of_its_four_links() {
    let arch = Arch::new(5.0, 0.15, 180.0)
        .unwrap()
        .with_voussoirs(12)
        .unwrap();
    let links = FourLinks::of_arch(&arch, ImpactModel::MaxRestitution).unwrap();
    let link = links.link(0).unwrap();
    let free = FreeHinges::of_arch(&arch).unwrap();
    for (part, sway) in [(0.3, Sway::Right), (0.9, Sway::Left)] {
        let rotation_rad = part * link.critical_rad;
        let request = Request {
            end_s: 0.5,
            initial: Some(Initial {
                sway,
                rotation_rad,
                rate_rad_s: 0.0,
            }),
            ..Request::default()
        };
        let summary = free
            .simulate(&GroundMotion::still(), &request, None)
            .unwrap();
        let due = link.mechanism.displacement(rotation_rad).y / link.barrier;
        let ratio = summary.peak_potential_over_barrier().unwrap();
        assert!((ratio / due - 1.0).abs() < 1e-9, "{ratio} {due}");
    }
    // For two drums no barrier is known.
    let folder = tempfile::tempdir().unwrap();
    let drums = COLUMN.replace("width_m", "drums = 2\nwidth_m");
    let scenario =
        format!("{drums}[free_hinges]\n[ground.one_sine]\namplitude_g = 0.25\nduration_s = 0.8\n");
    fs::write(folder.path().join("s.toml"), scenario).unwrap();
    let said = stdout(&archrock(
        folder.path(),
        &["run", "s.toml", "--out", "o", "--no-repeat"],
    ));
    assert!(!said.contains("first mechanism"), "{said}");
    let summary = json(&folder.path().join("o/summary.json"));
    assert_eq!(
        summary.get("peak_potential_over_barrier"),
        Some(&Value::Null)
    );
}

/// The line in the panel of the energy is at 1. The energies of a freely rocking block before and after its first impact
/// give the scale. A structure that hardly moves has no such line.
#[test]
fn the_picture_marks_the_barrier() {
    let folder = tempfile::tempdir().unwrap();
    let slenderness_rad = 0.2_f64.atan();
    let curves = |part: f64| {
        let scenario = format!(
            "{COLUMN}[free_hinges]\n[initial]\nsway = 'right'\nrotation_rad = {}\n",
            part * slenderness_rad
        );
        fs::write(folder.path().join("s.toml"), scenario).unwrap();
        stdout(&archrock(
            folder.path(),
            &["run", "s.toml", "--out", "o", "--no-repeat"],
        ));
        let picture = fs::read_to_string(folder.path().join("o/history.svg")).unwrap();
        let picture = roxmltree::Document::parse(&picture).unwrap();
        ["energy", "barrier"].map(|name| -> Vec<f64> {
            let found = named(&picture, name);
            let strokes = found.first().map(strokes).unwrap_or_default();
            strokes.concat().iter().map(|point| point.y).collect()
        })
    };
    let [energy, barrier] = curves(0.7);
    let released = potential_ratio(slenderness_rad, 0.7 * slenderness_rad);
    let restitution = (1.0 - 1.5 * slenderness_rad.sin().powi(2)).powi(2);
    // On the sheet y points down; the first level is the highest.
    let second = energy.iter().find(|y| **y > energy[0] + 2.0).unwrap();
    let scale = (second - energy[0]) / (released * (1.0 - restitution));
    assert_eq!(barrier.len(), 2);
    for y in barrier {
        let level = released + (energy[0] - y) / scale;
        assert!((level - 1.0).abs() < 0.02, "{level}");
    }
    let [_, barrier] = curves(0.1);
    assert!(barrier.is_empty());
}
