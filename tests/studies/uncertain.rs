//! Uncertain input: samples, distributions of results, and the influence of each number.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::fs;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::Path;

use archrock::Scenario;

use archrock::studies::ensemble::{
    Histories, HistoryAnswer, NoAnswer, SampleRow, sensitivities, total_indices,
};
use archrock::studies::{Runner, Share};

use crate::common::program::{
    archrock, done, files, names, printed, refused, scenarios, shown_commands,
};
use crate::common::prose::{golden, shows};
use crate::common::results::{Table, json};
use crate::common::{ARCH, COLUMN, GRAVITY, parsed};
use crate::scenario::keys::keys_of;

const PULSE: &str = "[ground.rectangular]\namplitude_g = 0.3\nduration_s = 0.21\n";

pub fn histories(scenario: &Scenario, threads: usize) -> Vec<SampleRow<HistoryAnswer>> {
    let study = Histories::of(scenario).unwrap();
    let runner = Runner {
        threads: NonZeroUsize::new(threads),
    };
    runner.rows(&study, |_| ControlFlow::Continue(())).unwrap()
}

/// Whether a free-standing block overturns under a push of this many g for this long, by Housner's equation with its sines, integrated
/// by the Runge-Kutta method: it overturns without impact or not at all.
fn block_overturns(height_m: f64, width_m: f64, push_g: f64, duration_s: f64) -> bool {
    let radius_m = 0.5 * height_m.hypot(width_m);
    let alpha = (width_m / height_m).atan();
    if push_g <= alpha.tan() {
        return false;
    }
    let p2 = 0.75 * GRAVITY / radius_m;
    let rate = |[angle, speed]: [f64; 2]| {
        [
            speed,
            p2 * (push_g * (alpha - angle).cos() - (alpha - angle).sin()),
        ]
    };
    let steps = 200;
    let step = duration_s / f64::from(steps);
    let mut state = [0.0, 0.0];
    let moved = |[a, b]: [f64; 2], [c, d]: [f64; 2], by: f64| [a + by * c, b + by * d];
    for _ in 0..steps {
        let k1 = rate(state);
        let k2 = rate(moved(state, k1, 0.5 * step));
        let k3 = rate(moved(state, k2, 0.5 * step));
        let k4 = rate(moved(state, k3, step));
        for (index, value) in state.iter_mut().enumerate() {
            *value += step / 6.0 * (k1[index] + 2.0 * k2[index] + 2.0 * k3[index] + k4[index]);
        }
    }
    // After the push energy decides: the energy left at the top.
    let [angle, speed] = state;
    angle >= alpha || 0.5 * speed * speed > p2 * (1.0 - (alpha - angle).cos())
}

/// A block of 4 m whose width is normal, 0.8 m with 0.03 m: the share that overturns is that of the widths below the critical one, by
/// Simpson's rule. It lies inside the reported interval for at least 184 of 200 seeds; for independent samples 190 are
/// expected, with a deviation of 3.
#[test]
fn the_probability_that_a_block_overturns_is_inside_the_interval() {
    let (push_g, duration_s) = (0.35, 0.45);
    let (mut low, mut high) = (0.7, 0.9);
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if block_overturns(4.0, middle, push_g, duration_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let density = |deviations: f64| (-0.5 * deviations * deviations).exp();
    let integral = |to: f64| {
        let steps = 1000;
        let width = (to + 3.0) / f64::from(steps);
        let weight = |step: i32| match step {
            0 => 1.0,
            step if step == steps => 1.0,
            step if step % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let terms = (0..=steps).map(|step| weight(step) * density(-3.0 + width * f64::from(step)));
        width / 3.0 * terms.sum::<f64>()
    };
    let probability = integral((low - 0.8) / 0.03) / integral(3.0);
    assert!((0.2..0.8).contains(&probability), "{low} {probability}");
    let mut inside = 0;
    for seed in 1..=200 {
        let scenario = parsed(&format!(
            "{COLUMN}[ground.rectangular]\namplitude_g = {push_g}\nduration_s = {duration_s}\n\
             [simulation]\nduration_s = 40.0\noutput_step_s = 0.1\n\
             [uncertain]\nsamples = 24\nseed = {seed}\n'column.width_m' = {{ deviation = 0.03 }}\n"
        ));
        let rows = histories(&scenario, 2);
        let overturned = |row: &&SampleRow<HistoryAnswer>| {
            row.answer.as_ref().unwrap().overturned_weight() == 1.0
        };
        let share = Share::of(rows[1..].iter().filter(overturned).count(), 24).unwrap();
        inside += u32::from(share.low <= probability && probability <= share.high);
        // With one uncertain number, samples are spread evenly, so the share is right to a sample or two.
        assert!(
            (share.share - probability).abs() < 2.0 / 24.0,
            "{seed} {share:?} {probability}"
        );
    }
    assert!(inside >= 184, "{inside} of 200");
}

/// The function of Ishigami and Homma (1990) with a = 7 and b = 0.1, whose indices are known: 0.3139, 0.4424, 0.
#[test]
fn first_order_indices_are_those_of_ishigami() {
    let known = {
        let (a, b) = (7.0_f64, 0.1_f64);
        let first = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
        let second = a * a / 8.0;
        let all = a * a / 8.0 + b * PI.powi(4) / 5.0 + b * b * PI.powi(8) / 18.0 + 0.5;
        [first / all, second / all, 0.0]
    };
    assert!((known[0] - 0.3139).abs() < 1e-4 && (known[1] - 0.4424).abs() < 1e-4);
    let mut inside = 0;
    for seed in 1..=10 {
        let scenario = parsed(&format!(
            "{ARCH}{PULSE}[uncertain]\nsamples = 1024\nseed = {seed}\n\
             'arch.depth_m' = {{ from = 1.0, to = 2.0 }}\n\
             'arch.thickness_ratio' = {{ from = 0.12, to = 0.2 }}\n\
             'ground.rectangular.amplitude_g' = {{ from = 0.1, to = 1.0, spacing = 'logarithmic' }}\n"
        ));
        let uncertain = scenario.uncertain.as_ref().unwrap();
        let points: Vec<Vec<f64>> = (0..1024).map(|sample| uncertain.point(sample)).collect();
        let ishigami = |point: &Vec<f64>| {
            let x: Vec<f64> = point.iter().map(|part| PI * (2.0 * part - 1.0)).collect();
            x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin()
        };
        let answers: Vec<f64> = points.iter().map(ishigami).collect();
        let values: Vec<Vec<f64>> = (0..1024).map(|sample| uncertain.values(sample)).collect();
        let matters = sensitivities(&values, &answers).unwrap();
        for (known, matters) in known.iter().zip(&matters) {
            let error = matters.first_order - known;
            assert!(error.abs() < 0.02, "seed {seed}: {matters:?} {known}");
            let [low, high] = matters.first_order_interval;
            inside += u32::from(low <= *known && *known <= high);
        }
        // The first grows with its number in the middle half only; the rank correlation of x0 is that of its sine.
        assert!(matters[0].rank_correlation > 0.3 && matters[1].rank_correlation.abs() < 0.1);
    }
    // For 95 % intervals, 28.5 of 30 are expected, with a deviation of 1.2.
    assert!(inside >= 25, "{inside} of 30");
}

/// Total indices of the function of Ishigami and Homma are known as well: 0.5574, 0.4424, 0.2436. The design takes three further
/// samples for each of 1,024; these samples are the same without the design.
#[test]
fn total_indices_are_those_of_ishigami() {
    let known = {
        let (a, b) = (7.0_f64, 0.1_f64);
        let first = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
        let second = a * a / 8.0;
        let third = b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
        let all = first + second + third;
        [(first + third) / all, second / all, third / all]
    };
    assert!((known[0] - 0.5574).abs() < 1e-3 && (known[2] - 0.2436).abs() < 1e-3);
    let mut inside = 0;
    for seed in 1..=5 {
        let text = format!(
            "{ARCH}{PULSE}[uncertain]\nsamples = 1024\nseed = {seed}\n\
             'arch.depth_m' = {{ from = 1.0, to = 2.0 }}\n\
             'arch.thickness_ratio' = {{ from = 0.12, to = 0.2 }}\n\
             'ground.rectangular.amplitude_g' = {{ from = 0.1, to = 1.0 }}\n"
        );
        let plain = parsed(&text);
        let scenario = parsed(&text.replace("[uncertain]", "[uncertain]\ntotal_indices = true"));
        assert_eq!(parsed(&scenario.to_toml()), scenario);
        let uncertain = scenario.uncertain.as_ref().unwrap();
        assert_eq!(uncertain.cases(), 4 * 1024);
        assert_eq!(plain.uncertain.as_ref().unwrap().cases(), 1024);
        let ishigami = |sample: usize| {
            let point = uncertain.point(sample);
            let x: Vec<f64> = point.iter().map(|part| PI * (2.0 * part - 1.0)).collect();
            Some(x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin())
        };
        assert_eq!(
            uncertain.point(17),
            plain.uncertain.as_ref().unwrap().point(17)
        );
        let answers: Vec<Option<f64>> = (0..1024).map(ishigami).collect();
        let moved: Vec<Option<f64>> = (1024..4096).map(ishigami).collect();
        let totals = total_indices(&answers, &moved).unwrap();
        for (known, total) in known.iter().zip(&totals) {
            assert!(
                (total.total - known).abs() < 0.05,
                "seed {seed}: {total:?} {known}"
            );
            let [low, high] = total.total_interval;
            inside += u32::from(low <= *known && *known <= high);
        }
        // One number differs from the sample, and no other.
        let [own, moved_by_one] = [17, 1024 + 3 * 17 + 1].map(|sample| uncertain.values(sample));
        assert!(
            own[0] == moved_by_one[0] && own[1] != moved_by_one[1] && own[2] == moved_by_one[2]
        );
        // A sample without an answer is left out.
        let mut gaps = answers.clone();
        gaps[5] = None;
        let without = total_indices(&gaps, &moved).unwrap();
        assert!((without[0].total - totals[0].total).abs() < 0.01 && without != totals);
    }
    assert!(inside >= 12, "{inside} of 15");
}

/// For a sum, the shares are those of the squares, and ranks agree.
#[test]
fn shares_of_a_sum_are_those_of_its_squares() {
    let scenario = parsed(&format!(
        "{ARCH}{PULSE}[uncertain]\nsamples = 512\n'arch.depth_m' = {{ from = 1.0, to = 2.0 }}\n\
         'arch.mean_radius_m' = {{ from = 4.0, to = 5.0 }}\n"
    ));
    let uncertain = scenario.uncertain.as_ref().unwrap();
    let values: Vec<Vec<f64>> = (0..512).map(|sample| uncertain.values(sample)).collect();
    let answers: Vec<f64> = values
        .iter()
        .map(|values| 2.0 * values[0] - values[1])
        .collect();
    let matters = sensitivities(&values, &answers).unwrap();
    assert!((matters[0].first_order - 0.8).abs() < 0.02, "{matters:?}");
    assert!((matters[1].first_order - 0.2).abs() < 0.02, "{matters:?}");
    assert!(matters[0].rank_correlation > 0.85 && matters[1].rank_correlation < -0.35);
    // An answer that does not vary, and too few samples, decide nothing.
    assert_eq!(sensitivities(&values, &vec![1.0; 512]), None);
    assert_eq!(sensitivities(&values[..10], &answers[..10]), None);
}

fn uncertain_arch(samples: usize, seed: usize) -> String {
    format!(
        "{ARCH}{PULSE}[simulation]\noutput_step_s = 0.02\n[uncertain]\nsamples = {samples}\nseed = {seed}\n\
         'arch.thickness_ratio' = {{ deviation = 0.01 }}\n\
         'arch.depth_m' = {{ deviation = 0.2, distribution = 'lognormal' }}\n\
         'ground.rectangular.amplitude_g' = {{ from = 0.2, to = 1.2, spacing = 'logarithmic' }}\n"
    )
}

#[test]
fn samples_are_the_same_on_any_threads_and_continue() {
    let few = parsed(&uncertain_arch(7, 3));
    let many = parsed(&uncertain_arch(14, 3));
    let rows = histories(&few, 1);
    assert_eq!(rows, histories(&few, 3));
    assert_eq!(rows.len(), 8);
    assert_eq!(histories(&many, 2)[..8], rows);
    let other = parsed(&uncertain_arch(7, 4));
    let values = |scenario: &Scenario| scenario.uncertain.as_ref().unwrap().values(0);
    assert_ne!(values(&few), values(&other));
    // The same on every machine; these values were computed once.
    let first = values(&few);
    let known = KNOWN;
    for (value, known) in first.iter().zip(known) {
        assert!((value - known).abs() < 1e-12 * known, "{first:?}");
    }
    // Samples are distributed around the scenario's values as required.
    let all: Vec<Vec<f64>> = (0..1024)
        .map(|sample| few.uncertain.as_ref().unwrap().values(sample))
        .collect();
    let mean = |of: &dyn Fn(&Vec<f64>) -> f64| all.iter().map(of).sum::<f64>() / 1024.0;
    assert!((mean(&|values| values[0]) - 0.15).abs() < 2e-5);
    // A normal distribution cut off at three deviations has a variance of 0.9733.
    let variance = mean(&|values| (values[0] - 0.15).powi(2)) / 1e-4;
    assert!((variance - 0.9733).abs() < 0.005, "{variance}");
    assert!(mean(&|values| values[1].ln()).abs() < 1e-3);
    assert!((mean(&|values| values[2].ln()) - 0.24_f64.sqrt().ln()).abs() < 1e-3);
    // A written scenario reads back the same.
    assert_eq!(parsed(&few.to_toml()), few);
}

const KNOWN: [f64; 3] = [
    0.130_489_323_862_577_14,
    0.767_140_159_872_646_4,
    0.224_341_121_046_628_73,
];

/// The first row is the scenario itself, and each sample equals the scenario changed by `--set`.
#[test]
fn a_sample_is_the_scenario_with_its_values() {
    let scenario = parsed(&uncertain_arch(3, 1));
    let rows = histories(&scenario, 1);
    assert!(rows[0].values.is_empty());
    for row in &rows[1..] {
        let [thickness, depth, amplitude] = row.values[..] else {
            panic!("{row:?}");
        };
        let text = format!(
            "[arch]\nmean_radius_m = 5.0\nthickness_ratio = {thickness:?}\nembrace_deg = 180.0\ndepth_m = {depth:?}\n\
             [ground.rectangular]\namplitude_g = {amplitude:?}\nduration_s = 0.21\n"
        );
        let alone = parsed(&text);
        let model = alone.model().unwrap();
        let summary = model
            .simulate(alone.ground_motion(), &alone.request(), None)
            .unwrap();
        let is_outside = summary.thrust_excess_ratio() > Some(0.5);
        assert_eq!(row.answer == Err(NoAnswer::OutsideModel), is_outside);
        let Ok(went) = row.answer.as_ref() else {
            continue;
        };
        assert_eq!(went.ending.outcome, summary.outcome);
        assert_eq!(
            went.ending.peak_rotation_rad,
            summary.largest_rotation_rad()
        );
    }
}

#[test]
fn a_run_with_uncertain_input_prints_and_writes_its_results() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("s.toml"), uncertain_arch(64, 1)).unwrap();
    let said = printed(at, &["run", "s.toml", "--out", "one"]);
    golden("uncertain", &said);
    let results = at.join("one/uncertain");
    assert_eq!(
        names(&results),
        [
            "bands.csv",
            "bands.svg",
            "matters.svg",
            "samples.csv",
            "samples.html",
            "uncertain.json"
        ]
    );
    let summary = json(&results.join("uncertain.json"));
    let table = Table::read(results.join("samples.csv"));
    assert_eq!(table.rows.len(), 65);
    let overturned = table.rows[1..]
        .iter()
        .filter(|row| row["outcome"] == "overturned")
        .count();
    assert!((5..60).contains(&overturned), "{overturned}");
    let share = &summary["outcomes"]["overturned"];
    assert_eq!(share["count"], overturned);
    assert!(share["low"].as_f64().unwrap() < overturned as f64 / 64.0);
    // The bands are right: at the end, as many have overturned as reported.
    let bands = Table::read(results.join("bands.csv"));
    let last = bands.rows.last().unwrap();
    assert_eq!(last.number("overturned"), overturned as f64);
    let matters = summary["what_matters"]["overturning"].as_array().unwrap();
    let of = |index: usize| matters[index]["first_order"].as_f64().unwrap();
    // The depth does not matter for four links.
    assert!(of(2) > 0.5 && of(1) < 0.1, "{matters:?}");

    // Shards, also on one thread, and resumed after an interruption, give the same files.
    for (part, threads) in [("2/2", "1"), ("1/2", "2")] {
        let arguments = ["run", "s.toml", "--out", "parts", "--shard", part];
        done(at, &[&arguments[..], &["--threads", threads]].concat());
    }
    let first = at.join("parts/uncertain/uncertain-1-of-2.part");
    let complete = fs::read(&first).unwrap();
    fs::write(&first, &complete[..complete.len() * 9 / 10]).unwrap();
    let again = ["run", "s.toml", "--out", "parts", "--shard", "1/2"];
    done(at, &[&again[..], &["--resume"]].concat());
    assert_eq!(names(&at.join("parts")), ["uncertain"]);
    let parts = [
        "parts/uncertain/uncertain-1-of-2.part",
        "parts/uncertain/uncertain-2-of-2.part",
    ];
    done(at, &["merge", parts[0], parts[1], "--out", "merged"]);
    assert_eq!(files(&at.join("merged")), files(&results));
    // With `--no-uncertain` nothing is uncertain.
    let said = printed(at, &["run", "s.toml", "--out", "none", "--no-uncertain"]);
    assert!(!said.contains("samples of"), "{said}");
    assert!(!at.join("none/uncertain").exists());
    let table = archrock(at, &["check", "s.toml", "--no-uncertain"]);
    assert!(
        !String::from_utf8(table.stdout)
            .unwrap()
            .contains("[uncertain]")
    );
    refused(
        at,
        &["run", "s.toml", "--no-uncertain", "--shard", "1/2"],
        &["[uncertain]"],
    );
}

/// The page of a run begins with the report on its samples, which are computed after its motion.
#[test]
fn the_page_of_a_run_begins_with_the_probability() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("s.toml"), uncertain_arch(16, 1)).unwrap();
    let said = printed(at, &["run", "s.toml", "--out", "one"]);
    let page = fs::read_to_string(at.join("one/report.html")).unwrap();
    let first = said.lines().find(|line| line.contains("of [uncertain]"));
    let probability = page.find(first.unwrap().trim().trim_end_matches(';'));
    assert!(probability.unwrap() < page.find("id=\"outcome\"").unwrap());
    printed(at, &["run", "s.toml", "--out", "none", "--no-uncertain"]);
    let page = fs::read_to_string(at.join("none/report.html")).unwrap();
    assert!(!page.contains("of [uncertain]"));
    // Each model has its own.
    let arguments = ["run", "s.toml", "--out", "two", "--hinges", "both"];
    printed(
        at,
        &[&arguments[..], &["--set", "arch.voussoirs=7"]].concat(),
    );
    for name in ["four", "free"] {
        let page = fs::read_to_string(at.join("two").join(name).join("report.html")).unwrap();
        assert!(page.contains("of [uncertain]"), "{name}");
    }
}

/// A map of a block whose width is uncertain: the share of each cell is that of the widths that overturn, by quadrature, to a sample or
/// two of 64, since samples of one number are spread evenly; and the line of 50 % is where the block of the median width begins to overturn.
#[test]
fn maps_report_the_probability_of_each_cell() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = format!(
        "{COLUMN}[ground.rectangular]\namplitude_g = 0.3\nduration_s = 0.45\n[simulation]\nduration_s = 20.0\n\
         [map]\nduration_s = [0.4, 0.5]\namplitude_g = {{ from = 0.3, to = 0.5, count = 6 }}\n\
         [uncertain]\nsamples = 64\n'column.width_m' = {{ from = 0.7, to = 0.9 }}\n"
    );
    fs::write(at.join("s.toml"), &text).unwrap();
    let said = done(at, &["map", "s.toml", "--out", "r", "--threads", "2"]);
    golden("uncertain-map", &said);
    // Cells that the block of 0.8 m survives and narrower ones do not, counted from the tables.
    let of = |path: &str| Table::read(at.join(path));
    let (own, likely) = (of("r/map.csv"), of("r/uncertain_map/map.csv"));
    let doubtful = own.rows.iter().zip(&likely.rows);
    let doubtful = doubtful.filter(|(own, likely)| {
        own["outcome"] != "overturned" && likely.number("overturned") >= 0.05
    });
    let doubtful = doubtful.count();
    assert!(doubtful > 0);
    let in_others = format!("in {doubtful} of the others");
    assert!(said.contains(&in_others), "{said}");
    // The command of a cell is of that cell alone.
    for page in ["r/map.html", "r/uncertain_map/map.html"] {
        let data = crate::common::results::data_of(&fs::read_to_string(at.join(page)).unwrap());
        let command = data["command"].as_str().unwrap();
        assert!(
            command.contains("[column]") && !command.contains("uncertain"),
            "{command}"
        );
    }
    let results = at.join("r/uncertain_map");
    assert_eq!(
        names(&results),
        [
            "map.csv",
            "map.html",
            "map.svg",
            "matters.svg",
            "probability.csv",
            "uncertain.json"
        ]
    );
    let table = Table::read(results.join("map.csv"));
    let own = Table::read(at.join("r/map.csv"));
    assert_eq!([table.rows.len(), own.rows.len()], [12, 12]);
    let mut between = 0;
    for row in &table.rows {
        let (duration_s, push_g) = (row.number("duration_s"), row.number("amplitude_g"));
        // The part of the range below the width from which on the block stands.
        let widths = (0..2000).map(|index| 0.7 + 0.2 * (f64::from(index) + 0.5) / 2000.0);
        let overturned = widths.filter(|width| block_overturns(4.0, *width, push_g, duration_s));
        let probability = overturned.count() as f64 / 2000.0;
        let share = row.number("overturned");
        assert!(
            (share - probability).abs() < 1.6 / 64.0,
            "{probability} {row:?}"
        );
        assert!(row.number("overturned_low") <= share && share <= row.number("overturned_high"));
        let all = [
            "overturned",
            "uncertain",
            "rest",
            "never_moved",
            "vibrates",
            "still_rocking",
        ];
        let sum: f64 = all.iter().map(|name| row.number(*name)).sum();
        assert!(
            (sum - 1.0).abs() < 1e-12 && row["samples"] == "64",
            "{row:?}"
        );
        between += u32::from((0.1..0.9).contains(&share));
    }
    assert!(between >= 4, "{between}");
    // A single uncertain number has all of the influence.
    let summary = json(&results.join("uncertain.json"));
    let only = &summary["what_matters"]["part_that_overturns"][0];
    assert_eq!(
        [&only["first_order"], &only["first_order_interval"][0]],
        [1.0, 1.0]
    );
    let lines = Table::read(results.join("probability.csv"));
    for line in &lines.rows {
        let (mut low, mut high) = (0.2, 0.6);
        while high - low > 1e-6 {
            let middle = 0.5 * (low + high);
            if block_overturns(4.0, 0.8, middle, line.number("duration_s")) {
                high = middle;
            } else {
                low = middle;
            }
        }
        // The level is reached between two neighbouring cells.
        let cells = ["above_50", "overturned_50"].map(|end| line.number(end));
        assert!(
            cells[0] < low && low < cells[1] && (cells[1] - cells[0] - 0.04).abs() < 1e-9,
            "{line:?} {low}"
        );
    }
    // The picture has the colours of these probabilities, and the line.
    let picture = fs::read_to_string(results.join("map.svg")).unwrap();
    for words in [
        "probability of 50 %",
        "no sample overturns",
        "every sample overturns",
    ] {
        assert!(picture.contains(words), "{words}");
    }

    // Parts, threads and resuming give the same files; the map itself is no part of these.
    for part in ["2/3", "1/3", "3/3"] {
        let part = [
            "map",
            "s.toml",
            "--out",
            "p",
            "--shard",
            part,
            "--threads",
            "1",
            "--resume",
        ];
        done(at, &part);
    }
    assert_eq!(names(&at.join("p")), ["uncertain_map"]);
    let parts =
        ["1", "2", "3"].map(|part| format!("p/uncertain_map/uncertain_map-{part}-of-3.part"));
    let parts = parts.each_ref().map(String::as_str);
    done(at, &[&["merge"], &parts[..], &["--out", "m"]].concat());
    assert_eq!(files(&at.join("m")), files(&results));
    refused(
        at,
        &[&["merge"], &parts[..], &["--out", "n", "--color", "peak"]].concat(),
        &["--color"],
    );
    done(at, &["map", "s.toml", "--out", "none", "--no-uncertain"]);
    assert!(!at.join("none/uncertain_map").exists());
    assert_eq!(
        fs::read(at.join("none/map.csv")).unwrap(),
        fs::read(at.join("r/map.csv")).unwrap()
    );
    // An axis that is uncertain as well.
    let text = text.replace(
        "'column.width_m' = {",
        "'ground.rectangular.amplitude_g' = {",
    );
    fs::write(at.join("s.toml"), text).unwrap();
    refused(
        at,
        &["map", "s.toml", "--out", "two"],
        &[
            "`amplitude_g` of [map] and \"ground.rectangular.amplitude_g\" of [uncertain] contradict",
        ],
    );
}

/// If the lowest cell of a map or the smallest factor of a threshold already overturns, it is a bound, not an edge.
#[test]
fn the_smallest_tested_strength_is_no_edge() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = format!(
        "{COLUMN}[ground.rectangular]\namplitude_g = 0.4\nduration_s = 0.5\n[simulation]\nduration_s = 20.0\n\
         [map]\nduration_s = [0.1, 0.5]\namplitude_g = {{ from = 0.35, to = 0.5, count = 3 }}\n\
         [uncertain]\nsamples = 32\n'column.width_m' = {{ from = 0.7, to = 0.9 }}\n"
    );
    fs::write(at.join("s.toml"), &text).unwrap();
    let said = done(at, &["map", "s.toml", "--out", "r"]);
    shows(&said, &[0.1, 0.5, 0.35]);
    let lines = Table::read(at.join("r/uncertain_map/probability.csv"));
    let [none, bound] = [&lines.rows[0], &lines.rows[1]];
    assert_eq!([&none["overturned_05"], &none["at_most_05"]], ["", "no"]);
    assert_eq!(
        [&bound["overturned_05"], &bound["at_most_05"]],
        ["0.35", "yes"]
    );
    // A line of the picture needs a place inside the map.
    let picture = fs::read_to_string(at.join("r/uncertain_map/map.svg")).unwrap();
    assert!(!picture.contains("probability of 5 %"));

    let said = printed(
        at,
        &[
            "threshold",
            "s.toml",
            "--out",
            "t",
            "--from",
            "0.9",
            "--to",
            "2",
        ],
    );
    shows(&said, &[0.9]);
    let table = Table::read(at.join("t/uncertain_threshold/samples.csv"));
    let bounds = table.rows[1..]
        .iter()
        .filter(|row| &row["at_most"] == "yes");
    let bounds = bounds.count();
    let summary = json(&at.join("t/uncertain_threshold/uncertain.json"));
    assert!((1..32).contains(&bounds));
    assert_eq!(summary["at_smallest_factor"], bounds);
    // A structure that overturns at the smallest factor, above 1, may or may not overturn at 1.
    let said = printed(
        at,
        &[
            "threshold",
            "s.toml",
            "--out",
            "u",
            "--from",
            "1.1",
            "--to",
            "2",
        ],
    );
    golden("uncertain-threshold-above-1", &said);
    let summary = json(&at.join("u/uncertain_threshold/uncertain.json"));
    assert!(summary["overturned_up_to_factor_1"].is_null());
}

/// Histories that end too early leave the probability open: its interval contains both ends, and so the share of the complete histories, in a run,
/// a map and a threshold. Before, the incomplete samples did not count, and none of the others overturns. The wall is lower than the column: energy
/// below the barrier gives no verdict, and most of the incomplete samples survive later.
#[test]
fn intervals_contain_samples_without_a_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = |duration_s: f64| {
        format!(
            "{COLUMN}[column.back]\nside = 'right'\nheight_m = 3.0\nrestitution = 0.8\n\
             [ground.half_sine]\namplitude_g = 0.33\nduration_s = 1.0\n\
             [simulation]\nduration_s = {duration_s}\ndirection = 'as_given'\n\
             [map]\nduration_s = [0.9, 1.0]\namplitude_g = [0.33, 0.34]\n\
             [uncertain]\nsamples = 64\n'column.width_m' = {{ from = 0.7, to = 1.6 }}\n"
        )
    };
    fs::write(at.join("early.toml"), text(1.02)).unwrap();
    fs::write(at.join("late.toml"), text(60.0)).unwrap();
    for name in ["early", "late"] {
        let file = format!("{name}.toml");
        done(at, &["run", &file, "--out", name, "--no-report"]);
        done(at, &["map", &file, "--out", &format!("{name}-map")]);
        let factors = ["--from", "0.5", "--to", "1", "--stride", "0.5"];
        let out = format!("{name}-threshold");
        printed(
            at,
            &[&["threshold", &file, "--out", &out][..], &factors].concat(),
        );
    }
    let share = |name: &str| {
        json(&at.join(name).join("uncertain/uncertain.json"))["outcomes"]["overturned"].clone()
    };
    let (early, late) = (share("early"), share("late"));
    let number = |share: &serde_json::Value, key: &str| share[key].as_f64().unwrap();
    let unknown = number(&early, "no_verdict") as usize;
    assert!(unknown > 10 && early["count"] == 0 && late["no_verdict"] == 0);
    let overturned = number(&late, "count");
    assert!(2.0 * overturned < number(&early, "no_verdict"));
    let truth = number(&late, "share");
    assert!(truth > 0.1 && number(&early, "low") <= truth && truth <= number(&early, "high"));
    assert_eq!(number(&early, "high"), Share::of(unknown, 64).unwrap().high);
    let cells = |name: &str| Table::read(at.join(format!("{name}-map/uncertain_map/map.csv")));
    for (early, late) in cells("early").rows.iter().zip(&cells("late").rows) {
        let truth = late.number("overturned");
        assert!(
            truth > 0.05 && early.number("overturned_high") >= truth,
            "{early:?} {late:?}"
        );
    }
    let threshold = |name: &str| {
        json(&at.join(format!(
            "{name}-threshold/uncertain_threshold/uncertain.json"
        )))
    };
    let (early, late) = (threshold("early"), threshold("late"));
    let [one, other] = [&early, &late].map(|of| &of["overturned_up_to_factor_1"]);
    assert!(number(one, "high") >= number(other, "share") && number(other, "share") > 0.1);
}

/// The first factor of a sample equals the threshold of its own scenario.
#[test]
fn thresholds_have_a_distribution() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("s.toml"), uncertain_arch(16, 2)).unwrap();
    let strides = ["--from", "0.3", "--to", "4", "--stride", "0.2"];
    let arguments = [&["threshold", "s.toml", "--out", "all"][..], &strides].concat();
    let said = printed(at, &arguments);
    golden("uncertain-threshold", &said);
    let results = at.join("all/uncertain_threshold");
    let table = Table::read(results.join("samples.csv"));
    for sample in [1, 7, 16] {
        let row = &table.rows[sample];
        let keys = [
            "arch.thickness_ratio",
            "arch.depth_m",
            "ground.rectangular.amplitude_g",
        ];
        let sets: Vec<String> = keys
            .iter()
            .map(|key| format!("{key}={}", row[*key]))
            .collect();
        let sets = sets.iter().flat_map(|set| ["--set", set]);
        let alone = ["threshold", "s.toml", "--out", "alone", "--no-uncertain"].into_iter();
        let arguments: Vec<&str> = alone.chain(strides).chain(sets).collect();
        printed(at, &arguments);
        let alone = json(&at.join("alone/threshold.json"));
        assert_eq!(
            alone["models"][0]["lowest_factor"].as_f64(),
            row["first_factor"].parse().ok()
        );
    }
    // The distribution is a step curve of the samples.
    let steps = Table::read(results.join("probability.csv"));
    let factors = table.rows[1..].iter();
    let factors: Vec<f64> = factors
        .filter_map(|row| row["first_factor"].parse().ok())
        .collect();
    let distinct: BTreeSet<u64> = factors.iter().map(|factor| factor.to_bits()).collect();
    assert_eq!(distinct.len(), steps.rows.len());
    for row in &steps.rows {
        let reached = factors
            .iter()
            .filter(|factor| **factor <= row.number("factor"));
        assert_eq!(row.number("probability"), reached.count() as f64 / 16.0);
    }
}

/// Samples whose structure does not stand are counted and reported.
#[test]
fn samples_that_do_not_stand_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // A semicircle needs t/R of at least 0.1075. Thin short arches and thick long ones stand, so the reader allows these ranges.
    let text = uncertain_arch(32, 1).replace(
        "{ deviation = 0.01 }",
        "{ from = 0.08, to = 0.16 }\n'arch.embrace_deg' = { from = 120, to = 180 }",
    );
    fs::write(at.join("s.toml"), text).unwrap();
    let said = printed(at, &["run", "s.toml", "--out", "r", "--no-report"]);
    let summary = json(&at.join("r/uncertain/uncertain.json"));
    let count = |name: &str| summary[name].as_u64().unwrap();
    assert!(count("invalid") > 0);
    let invalid = format!("{} of 32 samples make no valid structure", count("invalid"));
    assert!(said.contains(&invalid), "{said}");
    let all = ["invalid", "answered", "outside"].map(count);
    assert_eq!(all.iter().sum::<u64>(), 32);
}

/// docs/uncertain.md shows the deviations of its scenario.
#[test]
fn the_page_shows_the_deviations_of_the_worked_case() {
    let scenario = Scenario::read(&scenarios().join("uncertain/arch.toml")).unwrap();
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/uncertain.md");
    let page = fs::read_to_string(page).unwrap();
    for line in scenario
        .to_toml()
        .lines()
        .filter(|line| line.contains("deviation"))
    {
        let line = line.replace(", distribution = \"normal\"", "");
        assert!(page.contains(&line), "{line}");
    }
}

/// The thickness of a circular arch varies at any mean radius, and the drums of a column vary in proportion to its height.
#[test]
fn related_dimensions_vary_together() {
    let scenario = parsed(&format!(
        "{ARCH}{PULSE}[uncertain]\n'arch.mean_radius_m' = {{ from = 4.0, to = 6.0 }}\n'arch.thickness_m' = {{ deviation = 0.02 }}\n"
    ));
    let uncertain = scenario.uncertain.as_ref().unwrap();
    assert_eq!(uncertain.keys[1].own, Some(0.75));
    let values = uncertain.values(3);
    let sample = uncertain.scenario(&scenario, &values).unwrap();
    let ratio = sample.structure.circular_arch().unwrap().thickness_ratio;
    assert!((ratio - values[1] / values[0]).abs() < 1e-15);
    let joints = parsed(&format!(
        "[arch]\nmean_radius_m = 3.0\nthickness_m = 0.6\nembrace_deg = 150.0\n\
         joints_deg = [0.0, 20.0, 50.0, 75.0, 100.0, 150.0]\n{PULSE}[free_hinges]\n"
    ));
    let wider = joints.with_values(&[("arch.embrace_deg", 165.0)]).unwrap();
    let angles = wider.to_json()["arch"]["joints_deg"].clone();
    for (angle, wanted) in angles
        .as_array()
        .unwrap()
        .iter()
        .zip([0.0, 22.0, 55.0, 82.5, 110.0, 165.0])
    {
        assert!((angle.as_f64().unwrap() - wanted).abs() < 1e-9, "{angles}");
    }
    let heights = "drum_heights_m = [1.0, 2.0, 0.5, 0.5]";
    for (drums, key, wanted) in [
        ("drums = 4", "column.height_m", [1.1; 4]),
        (heights, "column.height_m", [1.1, 2.2, 0.55, 0.55]),
        (heights, "column.drum_heights_m.2", [1.0, 4.4, 0.5, 0.5]),
    ] {
        let scenario = parsed(&format!("{COLUMN}{drums}\n{PULSE}[free_hinges]\n"));
        let changed = scenario.with_values(&[(key, 4.4)]).unwrap();
        let changed = serde_json::to_value(&changed.structure).unwrap();
        let heights = changed["column"]["drum_heights_m"].as_array().unwrap();
        let heights: Vec<f64> = heights
            .iter()
            .map(|height| height.as_f64().unwrap())
            .collect();
        for (height, wanted) in heights.iter().zip(wanted) {
            assert!((height - wanted).abs() < 1e-12, "{key} {heights:?}");
        }
        let sum: f64 = heights.iter().sum();
        assert!((changed["column"]["height_m"].as_f64().unwrap() - sum).abs() < 1e-9);
    }
}

/// If an arch is given by its span, the span may vary while rise and thickness stay as measured. Joints of an arch scale with its
/// angle. The expected ring is that of the circle through springings and crown.
#[test]
fn measured_arches_vary_in_their_measured_dimensions() {
    let text = "[arch]\nspan_m = 6\nrise_m = 2\nthickness_m = 0.7\nmeasured_at = 'intrados'\n";
    let uncertain = "[uncertain]\n'arch.span_m' = { deviation = 0.05 }\n'arch.rise_m' = { from = 1.9, to = 2.1 }\n\
                     'arch.thickness_m' = { from = 0.6, to = 0.8 }\n";
    let scenario = parsed(&format!("{text}{PULSE}{uncertain}"));
    assert_eq!(parsed(&scenario.to_toml()), scenario);
    let known = scenario.uncertain.as_ref().unwrap();
    assert_eq!(known.keys[0].own, Some(6.0));
    let values = known.values(5);
    let sample = known.scenario(&scenario, &values).unwrap();
    let arch = sample.structure.circular_arch().unwrap();
    let [span_m, rise_m, thickness_m] = values[..] else {
        panic!("{values:?}");
    };
    let inner_m = (0.25 * span_m * span_m + rise_m * rise_m) / (2.0 * rise_m);
    let radius_m = arch.mean_radius_m;
    assert!((radius_m - inner_m - 0.5 * thickness_m).abs() < 1e-12);
    assert!((arch.thickness_ratio * radius_m - thickness_m).abs() < 1e-12);
    let half_rad = (0.5 * span_m / inner_m).asin();
    assert!((arch.embrace_deg - 2.0 * half_rad.to_degrees()).abs() < 1e-9);
    // The dimensions are printed as given, with uncertain numbers or without.
    let plain = scenario.without_uncertain().to_json();
    assert!(plain["arch"]["span_m"] == 6.0 && plain["arch"].get("mean_radius_m").is_none());
    // The joints stay where they are in proportion.
    let joints = text.replace(
        "thickness_m",
        "joints_deg = [0.0, 40.0, 70.0, 100.0, 134.76027010391914]\nthickness_m",
    );
    let joints = format!(
        "{joints}{PULSE}[free_hinges]\n[uncertain]\n'arch.span_m' = {{ from = 5.9, to = 6.1 }}\n"
    );
    let joints = parsed(&joints);
    let wider = joints
        .with_values(&[("arch.span_m", 6.1)])
        .unwrap()
        .to_json();
    let angles = wider["arch"]["joints_deg"].as_array().unwrap();
    let angle = |index: usize| angles[index].as_f64().unwrap();
    let embrace_deg = 4.0 * (2.0_f64 / (0.5 * 6.1)).atan().to_degrees();
    assert!((angle(4) - embrace_deg).abs() < 1e-9 && embrace_deg < 134.0);
    assert!((angle(1) - embrace_deg * 40.0 / 134.760_270_103_919).abs() < 1e-9);
}

/// The commands of the page run with the first eight of its 200 samples. Their output about the scenario itself is that of the
/// page, and their intervals contain the shares that the page shows.
#[test]
fn commands_print_the_output_shown_in_the_worked_case() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::copy(
        scenarios().join("uncertain/arch.toml"),
        at.join("arch.toml"),
    )
    .unwrap();
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/uncertain.md");
    let page = fs::read_to_string(page).unwrap();
    let (_, case) = page
        .split_once("## A worked case, in four commands")
        .unwrap();
    let commands = shown_commands(case);
    assert_eq!(commands.len(), 4);
    for (command, shown) in commands {
        // The shown lines of a threshold are those of the scenario itself.
        let fast: &[&str] = match command[0] == "run" {
            true => &["--no-report"],
            false => &["--set", "uncertain.samples=8"],
        };
        let command: Vec<&str> = command.iter().map(String::as_str).collect();
        let said = printed(at, &[&command[..], fast].concat());
        for line in shown.iter().filter(|line| *line != "...") {
            assert!(said.contains(line), "{line} is not in: {said}");
        }
    }
}

#[test]
fn keys_that_cannot_be_uncertain_are_refused() {
    let refusal = |keys: &str| {
        let text = format!("{ARCH}voussoirs = 7\n{PULSE}[uncertain]\n{keys}\n");
        let errors = Scenario::parse(&text, "s.toml").unwrap_err();
        errors.to_string()
    };
    for (keys, words) in [
        // A key that is a string, or a whole number, or no key.
        (
            "'impact.model' = { from = 1.0, to = 2.0 }",
            "is no number in the scenario",
        ),
        (
            "'arch.voussoirs' = { from = 5.5, to = 7.5 }",
            "is the whole number 7",
        ),
        (
            "'arch.size' = { from = 1.0, to = 2.0 }",
            "unknown key `size`",
        ),
        (
            "'map.duration_s' = { from = 1.0, to = 2.0 }",
            "[map] describes a study",
        ),
        (
            "'verify.confidence_factor' = { from = 1.0, to = 1.2 }",
            "[verify] describes a study",
        ),
        (
            "arch.depth_m = { from = 1.0, to = 2.0 }",
            "unknown key `arch` in [uncertain]",
        ),
        ("samples = 10", "needs 1 to 256 keys of other tables"),
        // A range that exceeds what is allowed: the message names the bound.
        (
            "'arch.embrace_deg' = { from = 170.0, to = 380.0 }",
            "reaches 380, which the scenario does not allow: `embrace_deg = 380",
        ),
        (
            "'arch.depth_m' = { from = -1.0, to = 1.0 }",
            "must be a number",
        ),
        (
            "'arch.thickness_ratio' = { deviation = 0.1 }",
            "reaches -0.15, which the scenario does not allow",
        ),
        // Three deviations of 0.05 below 0.15 are zero, up to rounding.
        (
            "'arch.thickness_ratio' = { deviation = 0.05 }",
            "reaches 0, which the scenario does not allow: `thickness_ratio = 0` is out of range",
        ),
        // Invalid numbers.
        (
            "samples = 0\n'arch.depth_m' = { deviation = 0.1 }",
            "must be a whole number from 1",
        ),
        (
            "seed = -1\n'arch.depth_m' = { deviation = 0.1 }",
            "must be a whole number from 0",
        ),
        (
            "'arch.depth_m' = { deviation = 0.0 }",
            "must be a number above 0",
        ),
        (
            "'arch.depth_m' = { from = 2.0, to = 1.0 }",
            "is not above `from`",
        ),
        (
            "'arch.depth_m' = { from = 0.0, to = 1.0, spacing = 'logarithmic' }",
            "needs numbers above 0",
        ),
        (
            "'arch.depth_m' = { from = 0.5, deviation = 0.1 }",
            "`deviation` cannot be combined with `from`",
        ),
        (
            "'arch.depth_m' = { from = 0.5 }",
            "`from = 0.5` needs `to` beside it",
        ),
        (
            "'arch.depth_m' = { spacing = 'linear' }",
            "must be a range, such as",
        ),
        ("'arch.depth_m' = 3.0", "must be a table"),
        // Keys that contradict each other.
        (
            "'arch.depth_m' = { deviation = 0.1 }\n'arch . depth_m' = { deviation = 0.2 }",
            "is the same as a key before it",
        ),
        (
            "'arch.thickness_m' = { deviation = 0.02 }\n'arch.thickness_ratio' = { deviation = 0.005 }",
            "contradicts the keys before it: ",
        ),
        (
            "'impact.restitution' = { deviation = 0.1 }",
            "has no value in the scenario from which it could deviate",
        ),
        (
            "'arch.span_m' = { from = 9.0, to = 11.0 }",
            "`span_m = 9` needs `measured_at` beside it",
        ),
        (
            "total_indices = 3\n'arch.depth_m' = { deviation = 0.1 }",
            "must be true or false",
        ),
    ] {
        let said = refusal(keys);
        assert!(said.contains(words), "{words:?} is not in: {said}");
        assert!(said.contains("s.toml:"), "{said}");
    }
    let nothing = parsed(&format!("{ARCH}{PULSE}"));
    let Err(reason) = Histories::of(&nothing) else {
        panic!("samples without [uncertain]");
    };
    assert!(reason.contains("no [uncertain]"), "{reason}");
}

/// Every number that may be fractional can be uncertain, in every kind of structure, ground and model.
#[test]
fn all_numbers_may_be_uncertain() {
    let voussoirs = "thickness_m = 0.5\nvoussoirs = 9\n";
    let mut tried = 0;
    let mut names_tried = BTreeSet::new();
    for structure in [
        ARCH.to_owned(),
        format!(
            "{ARCH}voussoirs = 9\n[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\nfriction_coefficient = 0.7\n"
        ),
        format!(
            "{ARCH}voussoirs = 9\n[free_hinges]\nlongest_step_s = 3e-4\nfriction_coefficient = 0.7\n"
        ),
        format!("{ARCH}[impact]\nmodel = 'prescribed'\nrestitution = 0.8\n"),
        COLUMN.to_owned(),
        format!(
            "{COLUMN}drums = 3\ntop_width_m = 0.7\n[free_hinges]\nlongest_step_s = 3e-4\nshortest_step_s = 1e-5\n"
        ),
        format!("{COLUMN}drum_heights_m = [1.0, 2.5, 0.5]\n[free_hinges]\n"),
        "[arch]\nmean_radius_m = 3.0\nthickness_m = 0.6\nembrace_deg = 150.0\n\
         joints_deg = [0.0, 20.0, 50.0, 75.0, 100.0, 150.0]\n[free_hinges]\n"
            .to_owned(),
        // The arch as it is measured.
        "[arch]\nspan_m = 6\nrise_m = 2.2\nthickness_m = 0.7\nmeasured_at = 'intrados'\n".to_owned(),
        "[arch]\nspan_m = 6.0\nembrace_deg = 150.0\nthickness_ratio = 0.2\nmeasured_at = 'extrados'\nvoussoirs = 9\n\
         [elastic_joints]\nstone_modulus_gpa = 20.0\nmortar_modulus_gpa = 1.0\nmortar_thickness_m = 0.01\n\
         damping_ratio = 0.05\ndamping_frequency_hz = 20.0\ncompressive_strength_mpa = 10.0\nlongest_step_s = 1e-6\n\
         [supports]\nright = { spread_m = 1e-3, settlement_m = 1e-3, rotation_rad = 1e-4 }\n"
            .to_owned(),
        format!(
            "{ARCH}voussoirs = 9\n[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\nshear_stiffness_gpa_m = 3.0\ndamping_time_s = 1e-4\n"
        ),
        // Ties.
        format!(
            "{ARCH}voussoirs = 9\n[[tie]]\nheight_m = 2.0\narea_mm2 = 491.0\nmodulus_gpa = 210.0\nprestress_n = 1e3\n\
             yield_stress_mpa = 235.0\nbreaks_at_strain = 0.05\n[[tie]]\nfrom_m = [-4.95, 1.0]\nto_m = [4.95, 1.0]\n\
             stiffness_n_m = 1e6\nyield_force_n = 1e4\n[free_hinges]\n"
        ),
        // Blocks from a file.
        "[blocks]\njoints = 'scenarios/straight-sided-voussoirs.csv'\ndepth_m = 1.2\ndensity_kg_m3 = 2700.0\n[free_hinges]\n".to_owned(),
        "[blocks]\njoints = 'scenarios/straight-sided-voussoirs.csv'\ndensity_kg_m3 = 2700.0\n\
         [elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n[ground.right]\ndelay_s = 0.05\n"
            .to_owned(),
        // Feet that move differently.
        format!(
            "{ARCH}voussoirs = 9\n[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n[ground.right]\napparent_velocity_m_s = 300.0\n"
        ),
        format!(
            "{ARCH}voussoirs = 9\n[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n[ground.right.record]\nfile = 'scenarios/synthetic.at2'\n\
             scale = 0.5\nstart_s = 0.1\n"
        ),
        "[column]\nheight_m = 4\nwidth_m = 1\n[initial]\nsway = 'left'\nimpulse_n_s = 100\nheight_m = 2\n".to_owned(),
        "[column]\nheight_m = 4\nwidth_m = 1\n[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\ncontact_points = 2\nfriction_coefficient = 0.7\n\
         rebound_ratio = 0.93\n"
            .to_owned(),
        format!("{ARCH}[initial]\nsway = 'right'\nrotation_rad = 0.01\nrate_rad_s = 0.02\n[impact]\nrestitution_factor = 0.9\n"),
        format!("[pointed_arch]\nspan_m = 4.0\nrise_m = 3.0\n{voussoirs}[free_hinges]\n"),
        format!("[elliptic_arch]\nspan_m = 6.0\nrise_m = 2.5\n{voussoirs}[free_hinges]\n"),
        format!("[basket_arch]\nspan_m = 6.0\nrise_m = 2.5\n{voussoirs}[free_hinges]\n"),
        format!(
            "[pointed_arch]\nspan_m = 4.0\nrise_m = 3.0\n{voussoirs}[piers]\nheight_m = 2.0\nwidth_m = 1.0\n\
             [fill]\nabove_crown_m = 0.2\ndensity_kg_m3 = 1500.0\n[[load]]\nmass_kg = 1500.0\nx_m = 0.5\n"
        ),
    ] {
        for ground in [
            PULSE,
            "[ground.gabor]\namplitude_g = 0.3\nduration_s = 0.5\n",
            "[ground.windowed_sine]\namplitude_g = 0.3\nduration_s = 0.5\nstart_s = 0.1\n",
        ] {
            // All kinds of ground are tested with the first structure.
            if ground != PULSE && structure != ARCH {
                continue;
            }
            let text = format!("{structure}{ground}");
            let scenario = parsed(&text);
            let given: serde_json::Value = toml::from_str(&text).unwrap();
            let tables = [scenario.to_resolved_json(), given];
            let tables = tables.iter().flat_map(|tables| tables.as_object().unwrap());
            let mut done = BTreeSet::new();
            for (table, keys) in tables {
                let mut all = Vec::new();
                numbers(table, keys, &mut all);
                for (key, value) in all {
                    if !done.insert(key.clone()) {
                        continue;
                    }
                    let mut names = key.split('.').filter(|part| part.parse::<usize>().is_err());
                    names_tried.insert((table.clone(), names.next_back().unwrap().to_owned()));
                    // The first and the last joint are the springings: they follow the embrace angle.
                    if ["arch.joints_deg.1", "arch.joints_deg.6"].contains(&&*key) {
                        continue;
                    }
                    // The value itself may be a bound: an arch of 180 degrees, a phase of zero.
                    let [from, to] = if value > 0.0 {
                        [0.999 * value, value]
                    } else {
                        [value, value + 1e-3]
                    };
                    let text = format!(
                        "{structure}{ground}[uncertain]\nsamples = 1\n'{key}' = {{ from = {from:?}, to = {to:?} }}\n"
                    );
                    let scenario = Scenario::parse(&text, "s.toml")
                        .unwrap_or_else(|errors| panic!("{key}: {errors}"));
                    let uncertain = scenario.uncertain.as_ref().unwrap();
                    let changed = uncertain.scenario(&scenario, &uncertain.values(0)).unwrap();
                    assert_ne!(
                        changed.to_json(),
                        scenario.clone().without_uncertain().to_json(),
                        "{key}"
                    );
                    tried += 1;
                }
            }
        }
    }
    assert!(tried > 150, "{tried}");
    // All numbers of the reference were among them.
    let whole = [
        "voussoirs",
        "drums",
        "contact_points",
        "from_block",
        "to_block",
    ];
    let no_numbers = [
        "measured_at",
        "pedestal",
        // Its numbers are tested in studies::walls.
        "back",
        // Only motion has uncertain numbers.
        "top",
        "contact",
        "left",
        "right",
        "between",
        "model",
        "sway",
        "record",
        "direction",
    ];
    for (paths, table) in [
        (&["arch"][..], "arch"),
        (&["column"], "column"),
        (&["free_hinges"], "free_hinges"),
        (&["elastic_joints"], "elastic_joints"),
        (&["supports", "supports.right"], "supports"),
        (&["[tie]"], "tie"),
        (&["ground.gabor", "ground.windowed_sine"], "ground"),
        (&["ground.right"], "ground"),
        (&["impact"], "impact"),
        (&["initial"], "initial"),
        (&["simulation"], "simulation"),
    ] {
        for key in keys_of(paths) {
            let is_number = !whole.contains(&&*key) && !no_numbers.contains(&&*key);
            let was_tried = names_tried.contains(&(table.to_owned(), key.clone()));
            assert!(!is_number || was_tried, "`{key}` of {paths:?}");
        }
    }
}

fn numbers(key: &str, value: &serde_json::Value, all: &mut Vec<(String, f64)>) {
    match value {
        serde_json::Value::Object(table) => {
            for (name, value) in table {
                numbers(&format!("{key}.{name}"), value, all);
            }
        }
        serde_json::Value::Array(entries) => {
            for (number, value) in (1..).zip(entries) {
                numbers(&format!("{key}.{number}"), value, all);
            }
        }
        // Lengths may be written without a point.
        serde_json::Value::Number(number) if number.is_f64() || key.ends_with("span_m") => {
            all.push((key.to_owned(), number.as_f64().unwrap()));
        }
        _ => {}
    }
}

/// Records overturn a column of uncertain width from a certain intensity on. The intensities of the scenario itself lie between
/// the levels at which its suite changes, and the width decides.
#[test]
fn suites_split_fragility_into_records_and_uncertain_input() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, second) in [("a", 0.9), ("b", 0.4), ("c", 0.2)] {
        let table = format!("0.0,0.0\n0.3,1.0\n0.6,{second}\n0.9,-0.8\n1.2,0.0\n");
        fs::write(at.join(format!("{name}.csv")), table).unwrap();
    }
    let text = format!(
        "{COLUMN}[suite]\nrecords = '?.csv'\nunit = 'g'\nboth_signs = false\n\
         peaks_g = {{ from = 0.15, to = 2.0, count = 12, spacing = 'logarithmic' }}\n\
         [simulation]\nduration_s = 40.0\n\
         [uncertain]\nsamples = 24\n'column.width_m' = {{ deviation = 0.05 }}\n\
         'column.depth_m' = {{ from = 1.0, to = 2.0 }}\n"
    );
    fs::write(at.join("s.toml"), text).unwrap();
    let said = done(at, &["suite", "s.toml", "--out", "r"]);
    // The program first asks about records of so few samples.
    let (asked, said) = said.split_once("of the suite are like that\n").unwrap();
    assert!(asked.contains("a.csv has a sample every 0.3 s"), "{asked}");
    golden("uncertain-suite", said);
    let results = at.join("r/uncertain_suite");
    let capacities = Table::read(results.join("capacities.csv"));
    assert_eq!(capacities.rows.len(), 3 * 25);
    // The scenario itself, compared with the histories of its suite.
    let suite = Table::read(at.join("r/suite.csv"));
    for record in ["a.csv", "b.csv", "c.csv"] {
        let own = capacities
            .rows
            .iter()
            .find(|row| row["sample"] == "0" && row["record"] == record);
        let first = suite
            .rows
            .iter()
            .find(|row| row["record"] == record && row["outcome"] == "overturned");
        let level = first.map(|row| row.number("peak_g"));
        let capacity: Option<f64> = own.unwrap()["intensity"].parse().ok();
        assert_eq!(capacity.is_some(), level.is_some(), "{record}");
        if let (Some(capacity), Some(level)) = (capacity, level) {
            assert!(
                capacity <= level && capacity > level / 1.27,
                "{record} {capacity} {level}"
            );
        }
    }
    let summary = json(&results.join("uncertain.json"));
    assert_eq!(summary["quote"], "both");
    // The answer that may be quoted is that of the samples, and the scenario itself has none.
    let both = &summary["fragility"]["both"];
    let quote = summary["to_quote"].as_str().unwrap();
    shows(
        quote,
        &[
            both["median"].as_f64().unwrap(),
            both["dispersion"].as_f64().unwrap(),
        ],
    );
    shows(
        quote,
        &["median_interval", "dispersion_interval"].map(|key| both[key][1].as_f64().unwrap()),
    );
    let own = json(&at.join("r/fragility.json"));
    assert!(
        own["to_quote"]
            .as_str()
            .unwrap()
            .contains("quote the answer of the samples")
    );
    assert!(!said.contains("survives all records"), "{said}");
    let dispersion = |of: &str| summary["fragility"][of]["dispersion"].as_f64().unwrap();
    // The width is uncertain by 6 %, which changes the capacity by more than that. Over the three records, records and width
    // together scatter more than the width alone.
    assert!(
        (0.03..0.3).contains(&dispersion("uncertain_data")),
        "{summary:#}"
    );
    assert!(
        dispersion("both") > dispersion("uncertain_data"),
        "{summary:#}"
    );
    let matters = summary["what_matters"]["median_intensity"]
        .as_array()
        .unwrap();
    assert!(
        matters[0]["first_order"].as_f64().unwrap() > 0.8,
        "{matters:?}"
    );
    assert!(
        matters[0]["rank_correlation"].as_f64().unwrap() > 0.9,
        "{matters:?}"
    );
    // Computing in parts gives the same.
    for part in ["1/2", "2/2"] {
        done(at, &["suite", "s.toml", "--out", "p", "--shard", part]);
    }
    let parts =
        ["1", "2"].map(|part| format!("p/uncertain_suite/uncertain_suite-{part}-of-2.part"));
    done(at, &["merge", &parts[0], &parts[1], "--out", "m"]);
    assert_eq!(files(&at.join("m")), files(&results));
}

/// Reading eight uncertain numbers takes about as long as reading one: all are tried together.
#[test]
fn many_uncertain_numbers_are_read_quickly() {
    let keys = [
        "arch.mean_radius_m",
        "arch.thickness_ratio",
        "arch.depth_m",
        "arch.density_kg_m3",
        "free_hinges.friction_coefficient",
        "ground.rectangular.amplitude_g",
        "ground.rectangular.duration_s",
        "simulation.gravity_m_s2",
    ];
    let read_s = |count: usize| {
        let keys: String = keys[..count]
            .iter()
            .map(|key| format!("'{key}' = {{ deviation = 1e-4 }}\n"))
            .collect();
        let text = format!(
            "{ARCH}voussoirs = 40\ndepth_m = 1.0\ndensity_kg_m3 = 2000.0\n[free_hinges]\nfriction_coefficient = 0.7\n{PULSE}\
             [simulation]\ngravity_m_s2 = 9.81\n[uncertain]\n{keys}"
        );
        let once = |_| {
            let begun = std::time::Instant::now();
            let read = parsed(&text);
            assert_eq!(read.uncertain.as_ref().unwrap().keys.len(), count);
            begun.elapsed().as_secs_f64()
        };
        (0..9).map(once).fold(f64::INFINITY, f64::min)
    };
    let [one, all] = [1, 8].map(read_s);
    // Trying each key alone takes ten times as long.
    assert!(all < 6.0 * one, "{one} s, {all} s");
}
