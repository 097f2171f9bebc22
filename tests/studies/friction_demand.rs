//! Friction that histories without slip require: the condition of an answer.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::program::{archrock, printed, stderr, stdout};
use crate::common::results::{Table, json};
use crate::common::{Random, noise, parsed, random_history, semicircle};
use archrock::{EndCondition, FreeHinges, Model, Outcome, Request, RowOptions};

/// The demand of a motion without slip up to three ends: early, early but later, and at its regular end, which is then doubled. All computations are
/// the same up to the early end, so the demand is the same to the last bit.
#[test]
fn the_demand_does_not_depend_on_the_end_of_a_history() {
    let cases = std::env::var("ARCHROCK_CASES").map_or(12, |cases| cases.parse().unwrap());
    let mut random = Random(29);
    let (mut early, mut condition) = (0, 0);
    for _ in 0..cases {
        let (row, ground) = random_history(&mut random, 6, 3.0);
        let Ok(model) = FreeHinges::new(row) else {
            continue;
        };
        let request = |end_s| Request {
            end_s,
            ..Request::default()
        };
        let until = |until, end_s| {
            let case = (ground.clone(), request(end_s));
            model.simulate_until(until, &case).ok()
        };
        let Some(whole) = until(EndCondition::End, 30.0) else {
            continue;
        };
        if matches!(whole.outcome, Outcome::Overturned(_) | Outcome::Incomplete) {
            continue;
        }
        let demand = whole.required_friction().unwrap();
        assert!(demand > 0.0);
        condition += usize::from(demand > 0.5);
        for (end, end_s) in [
            (EndCondition::Safe, 30.0),
            (EndCondition::Settled, 30.0),
            (EndCondition::End, 60.0),
        ] {
            let other = until(end, end_s).unwrap();
            early += usize::from(other.end_s < whole.end_s);
            assert_eq!(
                other.required_friction(),
                Some(demand),
                "{end:?} {} {}",
                other.end_s,
                whole.end_s
            );
        }
    }
    assert!(early > 0 && condition > 0, "{early} {condition}");
}

/// The demand of mechanisms depends neither on the duration, once the last large half cycle is over, nor on samples.
#[test]
fn the_demand_of_mechanisms_does_not_depend_on_duration_and_samples() {
    let arch = semicircle();
    let mut random = Random(7);
    for _ in 0..4 {
        let ground = noise(&mut random, [0.5, 0.0], 4.0);
        let request = |end_s, output_step_s| Request {
            end_s,
            output_step_s,
            ..Request::default()
        };
        let demand = |request: &Request| {
            let summary = arch.simulate(&ground, request, None).unwrap();
            assert!(!matches!(summary.outcome, Outcome::Overturned(_)));
            summary.required_friction()
        };
        let own = demand(&request(8.0, 0.01));
        assert!(own > Some(0.2));
        assert_eq!(own, demand(&request(20.0, 0.01)));
        let mut samples = |_: &archrock::Sample| std::ops::ControlFlow::Continue(());
        let sampled = arch.simulate(&ground, &request(8.0, 0.003), Some(&mut samples));
        assert_eq!(own, sampled.unwrap().required_friction());
    }
}

/// Steps end at output times, and are mostly shorter than a long `longest_step_s`, so the demand of rows hardly depends on it. Forces are means over a
/// step: they change by less than 1 % between steps of 1 ms and the default output step of 10 ms under a smooth pulse.
#[test]
fn long_steps_keep_the_demand() {
    let drums = "[column]\nheight_m = 4.0\nwidth_m = 0.8\ndrums = 3\n\
                 [ground.one_sine]\namplitude_g = 0.3\nduration_s = 0.8\n";
    let pointed = "[pointed_arch]\nspan_m = 6.0\nrise_m = 4.0\nthickness_m = 0.9\nvoussoirs = 8\n\
                   [ground.one_cosine]\namplitude_g = 0.4\nduration_s = 0.5\n";
    for text in [SLIDES, drums, pointed] {
        let demand = |steps: &str| {
            let scenario = parsed(&format!(
                "{text}[simulation]\nduration_s = 4.0\n[free_hinges]\n{steps}"
            ));
            let model = scenario.model().unwrap();
            let summary = model.simulate(scenario.ground_motion(), &scenario.request(), None);
            summary.unwrap().required_friction()
        };
        let due = demand("").unwrap();
        for longest_step_s in [0.1, 0.3, 1.0] {
            let found = demand(&format!("longest_step_s = {longest_step_s}\n"));
            let found = found.unwrap_or_else(|| panic!("{longest_step_s}: {text}"));
            assert!(
                (found / due - 1.0).abs() < 0.01,
                "{longest_step_s}: {found} {due}"
            );
        }
    }
}

/// With slip or elastic joints nothing depends on the friction of joints that cannot slip.
#[test]
fn models_that_slip_or_are_elastic_have_no_demand() {
    for table in [
        "[free_hinges]\nfriction_coefficient = 0.7",
        "[elastic_joints]\nnormal_stiffness_gpa_m = 10\nfriction_coefficient = 0.7",
        "[elastic_joints]\nnormal_stiffness_gpa_m = 10",
    ] {
        let scenario = parsed(&format!("{SLIDES}{table}\n"));
        let model = scenario.model().unwrap();
        let request = scenario.request();
        let summary = model.simulate(scenario.ground_motion(), &request, None);
        assert_eq!(summary.unwrap().required_friction(), None, "{table}");
    }
    let row = parsed(&format!("{SLIDES}[free_hinges]\n"));
    let row = row.model().unwrap().row().unwrap().clone();
    let options = RowOptions {
        friction_coefficient: Some(0.9),
        ..RowOptions::default()
    };
    assert!(
        FreeHinges::new(row)
            .unwrap()
            .with_options(options)
            .unwrap()
            .slips()
    );
}

/// An arch whose joints slip under motions that it survives without slip.
const SLIDES: &str = "[arch]\nmean_radius_m = 4.4\nthickness_ratio = 0.249\nembrace_deg = 162.0\nvoussoirs = 5\n\
                      [ground.rectangular]\namplitude_g = 1.0\nduration_s = 0.23\n";

fn with(folder: &Path, name: &str, text: &str) -> String {
    fs::write(folder.join(name), text).unwrap();
    name.to_owned()
}

/// Returns the summary of `threshold`.
fn threshold(folder: &Path, file: &str, arguments: &[&str]) -> Value {
    let all = [&["threshold", file, "--out", "t"], arguments].concat();
    printed(folder, &all);
    json(&folder.join("t/threshold.json"))
}

/// `run` and `threshold` at the same factor need the same friction, to the last bit, for all models without slip. So does the words' condition.
#[test]
fn run_and_threshold_need_the_same_friction() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let block = "[column]\nheight_m = 4.0\nwidth_m = 2.6\n[ground.one_sine]\namplitude_g = 0.9\nduration_s = 0.8\n";
    let piers = "[pointed_arch]\nspan_m = 6.0\nrise_m = 4.0\nthickness_m = 0.9\nvoussoirs = 8\n\
                 [ground.one_cosine]\namplitude_g = 0.4\nduration_s = 0.5\n";
    for (number, text) in [
        format!("{SLIDES}[free_hinges]\n"),
        format!("{block}[simulation]\nduration_s = 6.0\n"),
        SLIDES.replace("0.249", "0.16"),
        piers.to_owned(),
    ]
    .into_iter()
    .enumerate()
    {
        let file = with(folder, &format!("s{number}.toml"), &text);
        let found = threshold(folder, &file, &["--from", "0.98", "--to", "1"]);
        let words = printed(folder, &["run", &file, "--out", "r"]);
        let run = json(&folder.join("r/summary.json"));
        // The last factor, which may be quoted, has the steps of a run.
        let sample = found["models"][0]["samples"].as_array().unwrap().last();
        let sample = sample.unwrap();
        assert_eq!(sample["factor"], 1.0);
        let demand = run["friction_demand"].as_f64().unwrap();
        assert_eq!(sample["friction_demand"].as_f64(), Some(demand), "{text}");
        let table = Table::read(folder.join("t/threshold.csv"));
        assert_eq!(table.numbers("friction_demand").last(), Some(&demand));
        let needs = format!("friction coefficient of {demand:.2}");
        assert_eq!(words.contains(&needs), demand > 0.5, "{words}");
        // At another factor as well; the quote has the largest demand up to its factor.
        let found = threshold(folder, &file, &["--from", "1.24", "--to", "1.25"]);
        let given = text.split("amplitude_g = ").nth(1).unwrap();
        let given = given.lines().next().unwrap();
        let scaled_g = 1.25 * given.parse::<f64>().unwrap();
        let scaled = text.replace(
            &format!("amplitude_g = {given}"),
            &format!("amplitude_g = {scaled_g:?}"),
        );
        let file = with(folder, "scaled.toml", &scaled);
        printed(folder, &["run", &file, "--out", "r"]);
        let run = json(&folder.join("r/summary.json"));
        let model = &found["models"][0];
        let samples = model["samples"].as_array().unwrap();
        let [due, sample] = [
            &run["friction_demand"],
            &samples.last().unwrap()["friction_demand"],
        ]
        .map(|demand| demand.as_f64().unwrap());
        // Products of amplitude, factor and gravity are rounded in another order.
        assert!((sample / due - 1.0).abs() < 1e-6, "{sample} {due}");
        if let Some(safe) = model["survives_up_to_factor"].as_f64() {
            let up_to = samples
                .iter()
                .filter(|one| one["factor"].as_f64() <= Some(safe));
            let demands = up_to.filter_map(|one| one["friction_demand"].as_f64());
            let quoted = model["friction_demand"].as_f64();
            assert!(quoted >= demands.reduce(f64::max), "{model}");
            let rounded_up = (100.0 * quoted.unwrap() - 1e-9).ceil() / 100.0;
            let needs = format!("friction coefficient of {rounded_up:.2}");
            let words = found["to_quote"].as_str().unwrap();
            assert_eq!(
                words.contains(&needs),
                quoted > Some(0.5) && !words.contains("no answer"),
                "{words}"
            );
        }
    }
}

/// A quote of joints that cannot slip says how much friction it needs. Above that friction, joints that slip survive as much; with less, they survive
/// less. The printed command computes it.
#[test]
fn a_quote_needs_its_friction() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let file = with(folder, "s.toml", &format!("{SLIDES}[free_hinges]\n"));
    let factors = ["--from", "1.29", "--to", "1.7", "--stride", "0.1"];
    let quoted = |more: &[&str]| threshold(folder, &file, &[&factors[..], more].concat());
    let own = quoted(&[]);
    let (safe, demand) = (
        &own["models"][0]["survives_up_to_factor"],
        &own["models"][0]["friction_demand"],
    );
    let (safe, demand) = (safe.as_f64().unwrap(), demand.as_f64().unwrap());
    assert!(demand > 0.6);
    let words = own["to_quote"].as_str().unwrap();
    let command = "archrock threshold FILE --from 1.29 --to 1.7 --stride 0.1 --set free_hinges.friction_coefficient=0.6";
    assert!(
        words.contains("joints may slip") && words.contains(command),
        "{words}"
    );
    let warnings = own["warnings"].as_array().unwrap();
    assert!(
        warnings
            .iter()
            .any(|warning| warning.as_str().unwrap().contains(command))
    );
    let slipping = |friction: f64| {
        let set = format!("free_hinges.friction_coefficient={friction}");
        let found = quoted(&["--set", &set]);
        assert_eq!(found["models"][0]["friction_demand"], Value::Null);
        assert!(!found["to_quote"].as_str().unwrap().contains("friction"));
        found["models"][0]["survives_up_to_factor"].as_f64()
    };
    // Joints with more friction than needed slip for less than 1 % of the time, which changes the answer by less than the agreement of repetitions.
    assert!((slipping(1.05 * demand).unwrap() / safe - 1.0).abs() < 0.01);
    // It overturns at the first factor.
    assert!(1.29 < 0.8 * safe);
    assert_eq!(slipping(0.5), None);
}

/// The command that a study prints for friction above 0.6 runs as printed, also with four links, whose joints cannot slip: its joints slip, and it gives
/// an answer.
#[test]
fn printed_commands_of_friction_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let record: String = (0..60)
        .map(|step| {
            format!(
                "{},{}\n",
                0.01 * f64::from(step),
                f64::from(u8::from(step < 23))
            )
        })
        .collect();
    fs::write(folder.join("a.csv"), record).unwrap();
    let four = SLIDES.to_owned();
    let free = format!("{SLIDES}[free_hinges]\n");
    let map = "[map]\namplitude_g = [1.0]\nduration_s = [0.23]\n";
    let suite = "[suite]\nrecords = 'a.csv'\nunit = 'g'\nscales = [1.0]\n";
    let factors = ["--from", "1", "--to", "1.02", "--stride", "0.02"];
    for (text, study, more) in [
        (four.clone(), "threshold", &factors[..]),
        (free.clone(), "threshold", &factors),
        (four.clone(), "run", &[]),
        (format!("{four}{map}"), "map", &[]),
        (format!("{free}{suite}"), "suite", &[]),
    ] {
        let file = with(folder, "s.toml", &text);
        let all = [&[study, &file, "--out", "o"], more].concat();
        let output = archrock(folder, &all);
        let words = stdout(&output) + &stderr(&output);
        let (_, after) = words
            .split_once("run `archrock ")
            .unwrap_or_else(|| panic!("{words}"));
        let (command, _) = after.split_once('`').unwrap();
        let slips = "free_hinges.friction_coefficient=0.6";
        assert!(
            command.starts_with(study) && command.contains(slips),
            "{command}"
        );
        assert_eq!(
            command.contains("--hinges free"),
            !text.contains("[free_hinges]"),
            "{command}"
        );
        let command = command.replace("FILE", &file);
        let arguments: Vec<&str> = command.split(' ').chain(["--out", "p"]).collect();
        let output = archrock(folder, &arguments);
        let again = stdout(&output) + &stderr(&output);
        assert!(!again.contains("joints may slip"), "{again}");
        let number = match study {
            "threshold" => {
                json(&folder.join("p/threshold.json"))["models"][0]["survives_up_to_factor"].clone()
            }
            "run" => json(&folder.join("p/summary.json"))["largest_peak_rotation_rad"].clone(),
            study => {
                let rows = Table::read(folder.join(format!("p/{study}.csv"))).rows;
                assert!(rows.iter().all(|row| row["friction_demand"].is_empty()));
                Value::from(rows[0].number("peak_rotation_rad"))
            }
        };
        assert!(number.as_f64() > Some(0.0), "{command}: {again}");
    }
}
