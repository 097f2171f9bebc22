//! Histories outside the model of four links: the excess of the thrust line, their number, and their marks.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use archrock::dynamics::MODEL_LIMIT;
use archrock::{FreeHinges, GroundMotion, Model, Outcome, Pulse, Request, Sample};
use roxmltree::Document;
use serde_json::Value;

use crate::common::program::{done, scenarios};
use crate::common::results::{Table, data_of, json, named, strokes};
use crate::common::{self, ARCH, parsed, pulse, semicircle, seven_voussoirs};

fn ratio(model: &dyn Model, ground: &GroundMotion) -> (Outcome, f64) {
    let request = Request::default();
    let history = model.simulate(ground, &request, None).unwrap();
    (history.outcome, history.thrust_excess_ratio().unwrap())
}

/// The largest excess up to the largest rotation, or up to overturning, of samples at a short interval.
fn recorded(model: &dyn Model, ground: &GroundMotion, output_step_s: f64) -> f64 {
    let (mut turned, mut excess, mut found) = (0.0, 0.0_f64, 0.0);
    let mut record = |sample: &Sample| {
        excess = excess.max(sample.demand.excess_ratio);
        let now = sample.rotation_over_critical.unwrap().abs();
        if now > turned && turned < 1.0 {
            (turned, found) = (now, excess);
        }
        ControlFlow::Continue(())
    };
    let request = Request {
        output_step_s,
        end_s: 4.0,
        ..Request::default()
    };
    model.simulate(ground, &request, Some(&mut record)).unwrap();
    found
}

#[test]
fn the_excess_is_that_of_a_dense_recording() {
    let (arch, ring) = (seven_voussoirs(), semicircle());
    let mut ends = [0, 0];
    for (kind, amplitude_g, duration_s) in [
        (Pulse::OneCosine, 0.8, 0.4),
        (Pulse::OneSine, -1.2, 0.6),
        (Pulse::StepPair, 0.9, 0.3),
        (Pulse::HalfSine, 0.7, 0.5),
        (Pulse::Ricker, 1.5, 0.4),
        (Pulse::Rectangular, 0.6, 1.0),
    ] {
        let ground = pulse(kind, amplitude_g, duration_s);
        // The recording of a continuous ring has the maxima between the sections.
        for (model, step_s, tolerance) in [(&arch, 1e-4, 0.01), (&ring, 1e-3, 0.02)] {
            let (outcome, own) = ratio(model, &ground);
            let dense = recorded(model, &ground, step_s);
            let error = (own - dense).abs() / dense.max(1e-3);
            assert!(error < tolerance, "{kind:?} {outcome:?}: {own} {dense}");
            ends[usize::from(matches!(outcome, Outcome::Overturned(_)))] += 1;
        }
    }
    assert!(ends[0] > 2 && ends[1] > 2, "{ends:?}");
}

/// Amplitudes in g from which arches overturn with free hinges. With four links they survive far stronger pulses, whose histories are outside the
/// model; where both models agree, so do their thresholds.
#[test]
fn pulses_that_four_links_survive_only_outside_their_model() {
    let semicircle = fs::read_to_string(scenarios().join("semicircle-map.toml")).unwrap();
    let semicircle = semicircle.replace("= 180.0", "= 180.0\nvoussoirs = 36");
    let low = "[arch]\nspan_m = 6.0\nrise_m = 2.0\nthickness_m = 0.5\nmeasured_at = 'intrados'\nvoussoirs = 21\n\
               [ground.one_cosine]\namplitude_g = 1.0\nduration_s = 0.4\n";
    for (text, duration_s, four_g, free_g) in [
        (&*semicircle, 0.4, f64::INFINITY, 0.7996),
        (low, 0.4, 11.99, 2.660),
        (low, 0.5, 7.897, 1.812),
        (low, 0.7, 1.073, 1.114),
    ] {
        let scenario = parsed(text);
        let arch = scenario.structure.circular_arch().unwrap();
        let four = scenario.mechanisms().unwrap();
        let free = FreeHinges::of_arch(arch).unwrap();
        let overturns = |model: &dyn Model, amplitude_g: f64| {
            let ground = common::pulse(Pulse::OneCosine, amplitude_g, duration_s);
            let history = model.simulate(&ground, &Request::default(), None).unwrap();
            matches!(history.outcome, Outcome::Overturned(_))
        };
        let edge = |model: &dyn Model, edge_g: f64| {
            [0.998, 1.002].map(|part| overturns(model, part * edge_g))
        };
        assert_eq!(edge(&free, free_g), [false, true], "{text} {duration_s}");
        if four_g.is_finite() {
            assert_eq!(edge(&*four, four_g), [false, true], "{text} {duration_s}");
        } else {
            let all_g = (1..=40).map(|tenth| 0.1 * f64::from(tenth));
            assert!(
                all_g
                    .clone()
                    .all(|amplitude_g| !overturns(&*four, amplitude_g))
            );
        }
        // Between the thresholds, every history with four links is outside the model.
        for part in 0..10 {
            let amplitude_g = free_g + 0.1 * f64::from(part) * (four_g.min(4.0) - free_g);
            let ground = common::pulse(Pulse::OneCosine, amplitude_g, duration_s);
            let (_, excess) = ratio(&*four, &ground);
            assert!(excess > MODEL_LIMIT, "{duration_s} {amplitude_g}: {excess}");
        }
    }
}

/// Numbers of the cells of a map outside the model: in the table, the summary, the words, the picture and the page.
fn counts(folder: &Path, words: &str, name: &str) -> [usize; 5] {
    let table = Table::read(folder.join("map.csv"));
    let cells = table.rows.iter().filter(|row| match name {
        "map.json" => row["thrust_excess_ratio"]
            .parse()
            .is_ok_and(|ratio: f64| ratio > MODEL_LIMIT),
        _ => row.number("outside_model") > row.number("samples"),
    });
    let summary = json(&folder.join(name));
    let picture = fs::read_to_string(folder.join("map.svg")).unwrap();
    let picture = Document::parse(&picture).unwrap();
    let hatched = named(&picture, "outside-model");
    let page = data_of(&fs::read_to_string(folder.join("map.html")).unwrap());
    let printed = words
        .lines()
        .find(|line| line.contains("outside the model"));
    let printed = printed.and_then(|line| line.split_whitespace().next()?.parse().ok());
    [
        cells.count(),
        summary["outside_model"]
            .as_u64()
            .map_or(usize::MAX, |count| count as usize),
        printed.unwrap_or(0),
        hatched.iter().flat_map(strokes).count(),
        page["outside"].as_array().unwrap().len(),
    ]
}

#[test]
fn cells_outside_the_model_are_hatched_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = format!(
        "{ARCH}[ground.one_cosine]\namplitude_g = 1\nduration_s = 1\n\
         [map]\nduration_s = [0.2, 0.4, 0.8]\namplitude_g = [0.12, 0.2, 0.5, 1.5]\n"
    );
    fs::write(at.join("m.toml"), &text).unwrap();
    let words = done(at, &["map", "m.toml", "--out", "o"]);
    let found = counts(&at.join("o"), &words, "map.json");
    assert!(found[0] > 2 && found[0] < 12, "{words}");
    assert_eq!(found, [found[0]; 5], "{words}");
    // Other models have none.
    let column = format!(
        "{}[map]\nduration_s = [0.4]\namplitude_g = [0.5]\n",
        common::COLUMN
    ) + "[ground.one_cosine]\namplitude_g = 1\nduration_s = 1\n";
    fs::write(at.join("c.toml"), column).unwrap();
    let words = done(at, &["map", "c.toml", "--out", "c"]);
    assert!(!words.contains("outside"), "{words}");
    let summary: Value = json(&at.join("c/map.json"));
    assert_eq!(summary.get("outside_model"), None);
    // A map of samples counts histories in words and summary.
    let samples = "[uncertain]\nsamples = 4\n'arch.thickness_ratio' = { deviation = 0.002 }\n";
    fs::write(at.join("u.toml"), text + samples).unwrap();
    let words = done(at, &["map", "u.toml", "--out", "u"]);
    let found = counts(&at.join("u/uncertain_map"), &words, "uncertain.json");
    assert_eq!([found[3], found[4]], [found[0]; 2]);
    let table = Table::read(at.join("u/uncertain_map/map.csv"));
    let histories: f64 = table.numbers("outside_model").iter().sum();
    assert_eq!(found[1] as f64, histories);
    let wanted = format!("{histories} of 48 histories are outside the model");
    assert!(words.contains(&wanted), "{words}");
}
