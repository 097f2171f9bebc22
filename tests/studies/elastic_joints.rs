//! Studies of rows with elastic joints: histories computed side by side equal those of a run.

use std::fs;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;

use archrock::dynamics::Directions;
use archrock::studies::map::OverturningMap;
use archrock::studies::suite::RecordSuite;
use archrock::studies::threshold::{EDGE_WIDTH, Factors, threshold};
use archrock::studies::{Ending, Runner, Study};
use archrock::{EndCondition, Outcome, Pulse, Scenario, Summary, Verdict};

use crate::common::parsed;
use crate::common::program::{printed, scenarios};
use crate::common::results::json;

/// A slender block that rocks for two seconds.
fn block(more: &str) -> String {
    // With given steps, a map uses the steps of a run.
    format!(
        "[column]\nheight_m = 5.0\nwidth_m = 1.0\n\
         [elastic_joints]\nnormal_stiffness_gpa_m = 0.5\ndamping_time_s = 1e-3\nfriction_coefficient = 0.5\n\
         longest_step_s = 1e-3\n[simulation]\nduration_s = 2.5\n{more}"
    )
}

const PULSE: &str = "[ground.half_sine]\namplitude_g = -0.4\nduration_s = 0.3\n";

fn rows<S: Study>(study: &S, threads: usize) -> Vec<S::Row> {
    let runner = Runner {
        threads: NonZeroUsize::new(threads),
    };
    runner.rows(study, |_| ControlFlow::Continue(())).unwrap()
}

/// The run of a scenario with other values of its keys.
fn run(scenario: &Scenario, values: &[(&str, f64)]) -> Summary {
    let scenario = scenario.with_values(values).unwrap();
    let model = scenario.model().unwrap();
    let request = scenario.request();
    model
        .simulate(scenario.ground_motion(), &request, None)
        .unwrap()
}

/// Asserts that an ending is that of a run, to the last bit.
fn assert_is_of(ending: &Ending, own: &Summary, what: &str) {
    assert_eq!(
        (ending.outcome, ending.peak_of_row_rad()),
        (own.outcome, Some(own.largest_rotation_rad())),
        "{what}"
    );
    if ending.safe_from_s.is_some() {
        assert!(ending.energy_defect_ratio <= own.energy_defect_ratio);
        return;
    }
    assert_eq!(
        (ending.outcome_time_s, ending.energy_defect_ratio),
        (own.outcome_time_s, own.energy_defect_ratio),
        "{what}"
    );
}

/// Pulses of different length and strength are computed side by side; structures of different stiffness, on another axis, are not.
#[test]
fn cells_of_a_map_are_runs() {
    let pulses =
        "[map]\nduration_s = [0.2, 0.3, 0.41]\namplitude_g = [-1.2, -0.7, -0.5, -0.4, -0.25]\n";
    let joints = "[map]\n\"elastic_joints.normal_stiffness_gpa_m\" = [0.5, 1.0]\namplitude_g = [-0.9, -0.5, -0.3]\n";
    let both = "[map]\n\"elastic_joints.normal_stiffness_gpa_m\" = [0.5, 1.0]\n\"elastic_joints.friction_coefficient\" = [0.4, 0.6]\n";
    let (mut outcomes, mut uncertain) = (Vec::new(), 0);
    for (axes, keys) in [
        (
            pulses,
            [
                "ground.half_sine.duration_s",
                "ground.half_sine.amplitude_g",
            ],
        ),
        (
            joints,
            [
                "elastic_joints.normal_stiffness_gpa_m",
                "ground.half_sine.amplitude_g",
            ],
        ),
        (
            both,
            [
                "elastic_joints.normal_stiffness_gpa_m",
                "elastic_joints.friction_coefficient",
            ],
        ),
    ] {
        let scenario = parsed(&block(&format!("{PULSE}{axes}")));
        let map = OverturningMap::of(&scenario).unwrap();
        let cells = rows(&map, 1);
        assert_eq!(cells, rows(&map, 2), "{axes}");
        for (index, cell) in cells.iter().enumerate() {
            assert_eq!(*cell, map.rows(&[index])[0], "{axes}");
            let own = run(&scenario, &[(keys[0], cell.x), (keys[1], cell.y)]);
            let Ok(ending) = &cell.result else {
                panic!("{cell:?}")
            };
            assert_is_of(ending, &own, axes);
            outcomes.push(own.outcome.name());
            uncertain += usize::from(ending.doubt().is_some());
        }
    }
    for outcome in ["overturned", "still_rocking"] {
        assert!(outcomes.contains(&outcome), "{outcomes:?}");
    }
    assert!(uncertain < outcomes.len());
    // With all repetitions of all cells.
    let scenario = parsed(&block(&format!("{PULSE}{pulses}repeat = true\n")));
    let map = OverturningMap::of(&scenario).unwrap();
    let cells = rows(&map, 2);
    assert!(
        cells
            .iter()
            .all(|cell| matches!(cell.outcomes, Some(Ok(1..))))
    );
    assert_eq!(cells[7], map.rows(&[7])[0]);
}

#[test]
fn cases_of_a_suite_are_runs() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(
        scenarios().join("synthetic.at2"),
        folder.path().join("r.at2"),
    )
    .unwrap();
    let suite = "[suite]\nrecords = [\"r.at2\"]\nscales = [0.2, 0.5, 1.0]\nboth_signs = true\n";
    let text = block(suite).replace("duration_s = 2.5", "duration_s = 21.0");
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let scenario = Scenario::read(&folder.path().join("s.toml")).unwrap();
    let suite = RecordSuite::of(&scenario).unwrap();
    let cases = rows(&suite, 1);
    assert_eq!(cases, rows(&suite, 2));
    for (index, case) in cases.iter().enumerate() {
        assert_eq!(*case, suite.rows(&[index]).remove(0));
        let sign = if case.mirrored { -1.0 } else { 1.0 };
        let scale = sign * case.scale;
        let record = format!("[ground.record]\nfile = \"r.at2\"\nscale = {scale:?}\n");
        let text = block(&record).replace("duration_s = 2.5", "duration_s = 21.0");
        fs::write(folder.path().join("one.toml"), text).unwrap();
        let one = Scenario::read(&folder.path().join("one.toml")).unwrap();
        let ending = case.result.as_ref().unwrap();
        assert_is_of(ending, &run(&one, &[]), "suite");
    }
}

/// Samples equal runs; the edge is that of a bisection that computes one history after another.
#[test]
fn thresholds_equal_those_of_single_runs() {
    let scenario = parsed(&block(PULSE));
    let model = scenario.model().unwrap();
    let (ground, request) = (scenario.ground_motion(), scenario.request());
    let factors = Factors::new(1.0, 2.5, 0.1).unwrap();
    let found = [1, 2].map(|threads| {
        let runner = Runner {
            threads: NonZeroUsize::new(threads),
        };
        let model = ("elastic", &*model);
        let go_on = |_| ControlFlow::Continue(());
        threshold(
            model,
            (Directions::AsGiven, ground),
            &request,
            &factors,
            &runner,
            go_on,
        )
        .unwrap()
    });
    assert_eq!(found[0], found[1]);
    let falls = |factor: f64| {
        let ground = ground.scaled(factor).unwrap();
        let own = model.simulate(&ground, &request, None).unwrap();
        (matches!(own.outcome, Outcome::Overturned(_)), own)
    };
    let samples = &found[0].samples;
    assert!(samples.len() >= factors.factors_to_search(None).unwrap().values().len());
    let mut first = None;
    for pair in samples.windows(2) {
        let (below, own) = falls(pair[0].factor);
        let above = &pair[1];
        let ending = pair[0].result.as_ref().unwrap();
        assert_is_of(ending, &own, "sample");
        if first.is_none() && !below && falls(above.factor).0 {
            first = Some([pair[0].factor, above.factor]);
        }
    }
    let [mut low, mut high] = first.expect("it overturns within the range");
    while high - low > EDGE_WIDTH * high {
        let middle = 0.5 * (low + high);
        *if falls(middle).0 { &mut high } else { &mut low } = middle;
    }
    assert_eq!(found[0].lowest_factor(), Some(high));
}

/// Histories of variations that end too early for a verdict are counted, in words, JSON and warnings.
#[test]
fn variations_count_histories_without_a_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let text = block(PULSE).replace("duration_s = 2.5", "duration_s = 1.3");
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let threshold = [
        "threshold",
        "s.toml",
        "--out",
        "o",
        "--from",
        "1",
        "--to",
        "4",
        "--stride",
        "0.2",
    ];
    let said = printed(folder.path(), &threshold);
    let reported = json(&folder.path().join("o/threshold.json"));
    let model = &reported["models"][0];
    assert!(model["lowest_factor"].is_number(), "{said}");
    assert!(!model["incomplete"].as_array().unwrap().is_empty());
    let variations = model["variations"].as_array().unwrap();
    assert!(!variations.is_empty());
    for variation in variations {
        let incomplete = variation["incomplete"].as_u64().unwrap();
        let name = variation["with"].as_str().unwrap();
        assert!(variation["factor"].is_number() && incomplete > 0, "{said}");
        let warnings = reported["warnings"].as_array().unwrap().iter();
        let mut own = warnings
            .filter_map(|warning| warning.as_str()?.strip_prefix("with ")?.strip_prefix(name));
        let words = own.next().unwrap().trim_start_matches(": ");
        let counted = format!("{incomplete} histories");
        assert!(words.contains(&counted), "{words}");
        assert!(said.contains(words), "{said}");
    }
}

/// Cells stop once their energy is small and decays. So a longer duration changes neither verdicts and peaks nor the number of steps of histories and
/// repetitions. Only the prediction that a row comes to rest depends on the duration, and costs some steps.
#[test]
fn cells_cost_the_same_for_every_duration() {
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 14\n\
                [elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n[ground.one_cosine]\namplitude_g = 0.3\nduration_s = 0.3\n";
    let axes = "[map]\nduration_s = [0.15, 0.3, 0.6]\namplitude_g = [0.2, 0.35, 0.5]\n";
    let cells_and_steps = |duration_s: f64| {
        let simulation = format!("[simulation]\nduration_s = {duration_s}\n");
        let scenario = Scenario::parse(&format!("{arch}{axes}{simulation}"), "s.toml").unwrap();
        let map = OverturningMap::of(&scenario).unwrap();
        let cells = rows(&map, 2).into_iter();
        let cells: Vec<Ending> = cells.map(|row| row.result.unwrap()).collect();
        let model = scenario.model_for_many_cases().unwrap();
        let cases: Vec<_> = (0..map.count())
            .map(|index| {
                let [duration_s, amplitude_g] = map.coordinates(index);
                let pulse = Pulse::OneCosine.lasting_s(duration_s);
                let ground = pulse.horizontal_m_s2(amplitude_g * scenario.gravity_m_s2());
                (ground.unwrap(), scenario.request())
            })
            .collect();
        let steps = |until| -> u64 {
            let answers = model.simulate_all_until(until, &cases).into_iter();
            answers.map(|answer| answer.unwrap().cost.steps).sum()
        };
        let steps = [EndCondition::Settled, EndCondition::Safe, EndCondition::End].map(steps);
        (cells, steps)
    };
    let [short, middle, long] = [30.0, 100.0, 300.0].map(cells_and_steps);
    for (cells, steps) in [&middle, &long] {
        for (cell, due) in cells.iter().zip(&short.0) {
            assert_eq!(cell.verdict(), due.verdict());
            assert_eq!(cell.peak_of_row_rad(), due.peak_of_row_rad());
        }
        for until in [0, 1] {
            let ratio = steps[until] as f64 / short.1[until] as f64;
            assert!((0.8..1.25).contains(&ratio), "{steps:?} {:?}", short.1);
        }
    }
    // Complete histories of survivors that vibrate take much longer.
    assert!(short.1[2] > 2 * short.1[0], "{:?}", short.1);
    let survives = |cell: &&Ending| cell.verdict() == Verdict::Survives;
    assert!(short.0.iter().filter(survives).count() >= 3);
}
