//! Thresholds: edges compared with closed forms and published numbers, bands and gaps with plain histories, and the
//! command as users see it.

use std::collections::BTreeSet;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::thread;
use std::time::Duration;

use crate::common::program::{archrock, printed, refused, scenarios, stderr, stdout};
use crate::common::prose::{golden, shows, skeleton};
use crate::common::pulse;
use crate::common::results::{Row, Table, json, named};
use crate::common::{GRAVITY, pairs, request, semicircle, seven_voussoirs};
use archrock::dynamics::{Cost, Details, Directions, MechanismSummary, Repetition};
use archrock::output::Figure;
use archrock::scenario::{MODELS, ReadOptions, Source};
use archrock::studies::threshold::{
    EDGE_WIDTH, FactorRange, FactorSample, Factors, RangeEnd, Threshold, draw, results, threshold,
};
use archrock::studies::{Progress, Runner, RunnerError, StudyError, Verdict, outcome_name};
use archrock::{
    Arch, Column, Ending, FreeHinges, GroundMotion, ImpactModel, Model, Outcome, Pulse, Recorder,
    Request, RockingColumn, Scenario, SimulationError, Summary, Sway,
};
use archrock_motion::internals::hybrid::engine::EngineError;
use nalgebra::Vector2;
use serde_json::Value;

fn found(model: &dyn Model, ground: &GroundMotion, end_s: f64, factors: &Factors) -> Threshold {
    let go_on = |_| ControlFlow::Continue(());
    threshold(
        ("model", model),
        (Directions::AsGiven, ground),
        &request(end_s),
        factors,
        &Runner::default(),
        go_on,
    )
    .unwrap()
}

fn factors(from: f64, to: f64, stride: f64) -> Factors {
    Factors::new(from, to, stride).unwrap()
}

/// All factors of a search without a known onset.
fn searched(factors: &Factors) -> Vec<f64> {
    factors.factors_to_search(None).unwrap().values()
}

/// Slender column, rectangular pulse `(a, t)`: `cosh(p t) = 1 + 1 / (2 x (x - 1))`, `x = a / (g alpha)`, solved
/// for `x`. Finite slenderness changes that by a small multiple of its square, 1e-4 here.
#[test]
fn rectangular_pulses_overturn_slender_columns_from_housners_amplitude_on() {
    let alpha: f64 = 0.01;
    let column = Column::new(4.0, 4.0 * alpha.tan()).unwrap();
    let column = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
    let p = (0.75 * GRAVITY / (2.0 / alpha.cos())).sqrt();
    for p_t in [0.3, 1.0, 2.5_f64] {
        let x = 0.5 + (0.25 + 0.5 / (p_t.cosh() - 1.0)).sqrt();
        // The factor is `x` itself.
        let ground = pulse(Pulse::Rectangular, alpha.tan(), p_t / p);
        let threshold = found(&column, &ground, 60.0, &factors(0.5, 12.0, 0.05));
        let lowest = threshold.lowest_factor().unwrap();
        assert!(
            (lowest / x - 1.0).abs() < 2.0 * EDGE_WIDTH,
            "{p_t}: {lowest} {x}"
        );
        assert_eq!((threshold.bands().len(), threshold.gaps().len()), (1, 0));
        assert_eq!(threshold.bands()[0].to_end, RangeEnd::Sampled);
        assert_eq!(threshold.bands()[0].to, 12.0);
    }
}

/// Amplitudes in g from which a step pair overturns within the first half cycle, by an independent integration.
/// There may be lower bands, which overturn after impacts.
#[test]
fn step_pairs_overturn_seven_voussoirs_without_impact_from_the_known_amplitudes_on() {
    let arch = seven_voussoirs();
    for (duration_s, without_impact_g, bands) in [(0.2, 3.066, 1), (0.5, 0.820, 2), (1.0, 0.465, 2)]
    {
        let ground = pulse(Pulse::StepPair, 1.0, duration_s);
        let threshold = found(&arch, &ground, 10.0, &factors(0.3, 10.0, 0.02));
        assert_eq!(threshold.bands().len(), bands, "{duration_s}");
        let last = threshold.bands()[bands - 1];
        // The numbers have three decimals.
        assert!(
            (last.from - without_impact_g).abs() < 5e-4 + EDGE_WIDTH,
            "{last:?}"
        );
        assert_eq!(
            (last.from_end, last.to_end),
            (RangeEnd::Edge, RangeEnd::Sampled)
        );
        for sample in &threshold.samples {
            let history = sample.result.as_ref().unwrap();
            let below = sample.factor < last.from && sample.verdict() == Some(Verdict::Overturns);
            assert!(!below || history.impacts > Some(0), "{}", sample.factor);
            assert!(sample.factor < last.from || history.impacts == Some(0));
        }
    }
}

/// Both sides of every edge, the last factor and the quoted friction demand have the steps of a run; other samples have longer ones.
#[test]
fn answers_have_the_steps_of_a_run() {
    let arch = Arch::new(4.0, 0.15, 157.5).unwrap();
    let model = FreeHinges::of_arch(&arch.with_voussoirs(7).unwrap()).unwrap();
    let ground = pulse(Pulse::OneSine, 0.5, 0.4);
    let threshold = found(&model, &ground, 5.0, &factors(0.5, 3.0, 0.05));
    let run_s = model.longest_step_s(&request(5.0));
    let samples = &threshold.samples;
    let ending = |sample: &FactorSample| sample.result.clone().unwrap();
    let is_of_run = |sample: &FactorSample| ending(sample).steps.unwrap().longest_s == run_s;
    let edges = samples
        .windows(2)
        .filter(|pair| pair[0].verdict() != pair[1].verdict());
    assert!(edges.clone().count() > 0);
    assert!(edges.flatten().chain(samples.last()).all(is_of_run));
    assert!(!samples.iter().all(is_of_run));
    let safe = threshold.survives_up_to().unwrap();
    let needed = samples.iter().filter(|sample| {
        sample.factor <= safe && ending(sample).friction_demand == threshold.friction_demand
    });
    let [sample] = needed.collect::<Vec<_>>()[..] else {
        panic!("{:?}", threshold.friction_demand);
    };
    let scaled = ground.scaled(sample.factor).unwrap();
    let run = Ending::of(&model, &scaled, &request(5.0)).unwrap();
    assert_eq!(run.friction_demand, threshold.friction_demand);
}

fn overturns(model: &dyn Model, ground: &GroundMotion, end_s: f64, factor: f64) -> bool {
    let ground = ground.scaled(factor).unwrap();
    let summary = model.simulate(&ground, &request(end_s), None).unwrap();
    matches!(summary.outcome, Outcome::Overturned(_))
}

/// Strong cosine pulses throw the arch the other way before it can fall: a safe island between bands.
/// Plain histories at its ends, just beyond them and in its middle agree.
#[test]
fn safe_islands_of_cosine_pulses_are_gaps_between_bands() {
    let arch = semicircle();
    for duration_s in [0.7, 0.9, 1.2] {
        let ground = pulse(Pulse::OneCosine, 1.0, duration_s);
        let threshold = found(&arch, &ground, 10.0, &factors(0.1, 10.0, 0.02));
        assert_eq!((threshold.bands().len(), threshold.gaps().len()), (2, 1));
        let ([low, high], gap) = (
            [threshold.bands()[0], threshold.bands()[1]],
            threshold.gaps()[0],
        );
        assert!(low.to < gap.from && gap.from <= low.to * (1.0 + 2.0 * EDGE_WIDTH));
        assert!(gap.to < high.from && high.from <= gap.to * (1.0 + 2.0 * EDGE_WIDTH));
        assert_eq!((gap.from_end, gap.to_end), (RangeEnd::Edge, RangeEnd::Edge));
        let overturns = |factor| overturns(&arch, &ground, 10.0, factor);
        for (range, expected) in [(low, true), (gap, false), (high, true)] {
            let FactorRange { from, to, .. } = range;
            for factor in [from, 0.5 * (from + to), to] {
                assert_eq!(overturns(factor), expected, "{duration_s} {factor}");
            }
        }
        assert!(!overturns(low.from * (1.0 - 1.01 * EDGE_WIDTH)));
        assert_eq!(threshold.lowest_factor(), Some(low.from));
    }
}

/// Half the amplitude and twice the factors give the same motion, exactly, because they are powers of two.
#[test]
fn factor_times_amplitude_counts() {
    let arch = semicircle();
    let whole = pulse(Pulse::OneCosine, 1.0, 0.9);
    let half = pulse(Pulse::OneCosine, 0.5, 0.9);
    let a = found(&arch, &whole, 10.0, &factors(0.2, 2.0, 0.1));
    let b = found(&arch, &half, 10.0, &factors(0.4, 4.0, 0.1));
    for (a, b) in pairs(&a.samples, &b.samples) {
        assert!(2.0 * a.factor == b.factor && a.result == b.result);
    }
    let doubled = |range: &FactorRange| FactorRange {
        from: 2.0 * range.from,
        to: 2.0 * range.to,
        ..*range
    };
    assert!(!a.bands().is_empty());
    assert_eq!(a.bands().iter().map(doubled).collect::<Vec<_>>(), b.bands());
    assert_eq!(a.gaps().iter().map(doubled).collect::<Vec<_>>(), b.gaps());
}

/// If the vertical motion unloads the column completely, there is no history; the known range ends there.
#[test]
fn factors_with_free_falling_ground_are_reported() {
    let column = Column::new(4.0, 0.8).unwrap();
    let column = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
    let amplitude = Vector2::new(0.3, 0.2) * GRAVITY;
    let ground = Pulse::OneSine
        .lasting_s(1.2)
        .inclined_m_s2(amplitude)
        .unwrap();
    let threshold = found(&column, &ground, 20.0, &factors(0.5, 10.0, 0.1));
    for sample in &threshold.samples {
        assert_eq!(
            outcome_name(&sample.result) == "ground_falls",
            sample.factor >= 5.0,
            "{}",
            sample.factor
        );
    }
    let band = threshold.bands()[threshold.bands().len() - 1];
    assert_eq!(band.to_end, RangeEnd::Unknown);
    // The next sample is a stride of 10 % above.
    assert!(band.to < 5.0 && 1.1 * band.to > 5.0 - 1e-9);
}

/// Overturns or not as a function of the peak ground acceleration, in m/s2; or fails.
#[derive(Debug)]
struct Rule(fn(f64) -> Option<bool>);

impl Rule {
    fn new(rule: fn(f64) -> Option<bool>) -> Self {
        Self(rule)
    }
}

impl Model for Rule {
    fn bodies(&self) -> Vec<String> {
        vec![String::new()]
    }

    fn incipient_acceleration_g(&self, _: Sway) -> Option<f64> {
        None
    }

    /// As with elastic joints, the onset of motion is unknown.
    fn moves_below_incipient(&self) -> bool {
        true
    }

    fn simulate(
        &self,
        ground: &GroundMotion,
        _: &Request,
        _: Option<&mut dyn Recorder>,
    ) -> Result<Summary, SimulationError> {
        let overturns = (self.0)(ground.peaks_m_s2(f64::INFINITY).x);
        let failure = EngineError::TooManyTransitions(1.0, 1);
        let failure = || SimulationError::computation(failure);
        let outcome = match overturns.ok_or_else(failure)? {
            true => Outcome::Overturned(Sway::Left),
            false => Outcome::Rest,
        };
        Ok(Summary {
            outcome,
            outcome_time_s: 1.0,
            end_s: 1.0,
            is_cut: false,
            impacts: 0,
            peak_rotations_rad: vec![0.0],
            energy_defect_ratio: 0.0,
            thrust: None,
            friction: None,
            cost: Cost::default(),
            details: Details::Mechanisms(MechanismSummary::default()),
        })
    }
}

/// A rule, and another one for its repetition.
#[derive(Debug)]
struct Doubtful {
    own: fn(f64) -> Option<bool>,
    repeated: fn(f64) -> Option<bool>,
}

impl Model for Doubtful {
    fn bodies(&self) -> Vec<String> {
        vec![String::new()]
    }

    fn incipient_acceleration_g(&self, _: Sway) -> Option<f64> {
        None
    }

    fn moves_below_incipient(&self) -> bool {
        true
    }

    fn repetitions(&self) -> Vec<Repetition> {
        let model = Box::new(Rule::new(self.repeated));
        let name = "another rule";
        vec![Repetition { name, model }]
    }

    fn simulate(
        &self,
        ground: &GroundMotion,
        request: &Request,
        recorder: Option<&mut dyn Recorder>,
    ) -> Result<Summary, SimulationError> {
        Rule::new(self.own).simulate(ground, request, recorder)
    }
}

/// Where the repetition disagrees or fails, the factor is neither overturned nor survived. The edges of these ranges are found like
/// others, even if neighbouring samples lie on both sides of the range.
#[test]
fn uncertain_factors_are_ranges_of_their_own() {
    let doubtful = Doubtful {
        own: |x| Some((2.0..3.0).contains(&x) || x >= 4.0),
        // Overturns a little earlier, and later; and fails in one range.
        repeated: |x| {
            let fails = (6.0..6.5).contains(&x);
            (!fails).then_some((1.99..3.0).contains(&x) || x >= 4.4)
        },
    };
    let threshold = found(&doubtful, &unit_pulse(), 1.0, &factors(1.0, 8.0, 0.1));
    let expected = [
        (Verdict::Survives, 1.0, 1.99),
        (Verdict::Uncertain, 1.99, 2.0),
        (Verdict::Overturns, 2.0, 3.0),
        (Verdict::Survives, 3.0, 4.0),
        (Verdict::Uncertain, 4.0, 4.4),
        (Verdict::Overturns, 4.4, 6.0),
        (Verdict::Uncertain, 6.0, 6.5),
        (Verdict::Overturns, 6.5, 8.0),
    ];
    assert_eq!(threshold.ranges.len(), expected.len());
    for (range, (verdict, from, to)) in pairs(&threshold.ranges, &expected) {
        assert_eq!(range.verdict, Some(*verdict));
        // Edges beside an uncertain factor are enclosed to 1 %; only that at 3 lies between certain ones.
        let width = |edge: f64| if edge == 3.0 { EDGE_WIDTH } else { 0.01 };
        assert!((range.from / from - 1.0).abs() < width(*from), "{range:?}");
        assert!((range.to / to - 1.0).abs() < width(*to), "{range:?}");
    }
    assert_eq!((threshold.bands().len(), threshold.gaps().len()), (3, 1));
    // No sample of the strides lies between 1.99 and 2: the search met one.
    let strides = searched(&factors(1.0, 8.0, 0.1));
    let met: Vec<_> = threshold
        .samples
        .iter()
        .filter(|sample| !strides.contains(&sample.factor))
        .collect();
    assert_eq!(met.len(), 1);
    assert_eq!(met[0].verdict(), Some(Verdict::Uncertain));
    let reasons: BTreeSet<_> = threshold
        .samples
        .iter()
        .filter_map(|sample| sample.result.as_ref().unwrap().doubt())
        .map(ToString::to_string)
        .collect();
    let failed = "overturns in 1 of 1 repetitions; failed with another rule: more than 1 transitions by 1.0 s";
    assert_eq!(reasons.len(), 2);
    assert!(reasons.contains("overturns in 1 of 2 repetitions"));
    assert!(
        reasons.iter().any(|reason| reason.starts_with(failed)),
        "{reasons:?}"
    );
    assert_eq!(threshold.lowest_factor(), Some(threshold.bands()[0].from));
    assert_eq!(threshold.survives_up_to(), Some(threshold.ranges[0].to));

    let picture = draw(Figure::SCREEN, "Title", 0.1, &[threshold]);
    assert_eq!(picture.matches("data-name=\"model uncertain\"").count(), 3);
    assert!(picture.contains("uncertain whether it overturns"));
    assert!(picture.contains("survives up to 1.9"));
    // The curve of peaks includes uncertain factors whose own history survives (1.99 to 2), and is interrupted where it overturns.
    let document = roxmltree::Document::parse(&picture).unwrap();
    let curve = named(&document, "model peak")[0].attribute("d").unwrap();
    assert_eq!(curve.matches('M').count(), 2, "{curve}");
}

/// At most eight edges have labels, those of the lowest factors.
#[test]
fn at_most_eight_edges_are_labelled() {
    let comb = Rule::new(|x| Some((12.0 * x).floor() % 2.0 == 1.0));
    let factors = factors(1.0, 4.0, 0.01);
    let threshold = found(&comb, &unit_pulse(), 1.0, &factors);
    assert_eq!(threshold.bands().len(), 18);
    let picture = draw(Figure::SCREEN, "Title", 0.1, &[threshold]);
    let document = roxmltree::Document::parse(&picture).unwrap();
    let upright = |node: &roxmltree::Node<'_, '_>| {
        let turned = node.attribute("transform");
        node.has_tag_name("text") && turned.is_some_and(|how| how.contains("rotate(-90"))
    };
    let labels = document.descendants().filter(upright);
    let labels = labels.filter_map(|node| node.text()?.parse::<f64>().ok());
    let labels: Vec<f64> = labels.collect();
    assert_eq!(labels.len(), 8, "{labels:?}");
    assert!((labels[0] - 13.0 / 12.0).abs() < 1e-3, "{labels:?}");
}

fn unit_pulse() -> GroundMotion {
    Pulse::Rectangular
        .lasting_s(1.0)
        .horizontal_m_s2(1.0)
        .unwrap()
}

#[test]
fn bands_and_gaps_of_any_models_side_by_side() {
    let islands = Rule::new(|x| Some((2.0..3.0).contains(&x) || x >= 4.0));
    let always = Rule::new(|_| Some(true));
    let never = Rule::new(|_| Some(false));
    let models: [(&str, &dyn Model); 3] = [
        ("islands", &islands),
        ("always", &always),
        ("never", &never),
    ];
    let all = factors(1.0, 8.0, 0.1);
    let runner = Runner::default();
    let found = models.map(|model| {
        let mut last = None;
        let watch = |progress: Progress| {
            last = Some((progress.done, progress.all));
            ControlFlow::Continue(())
        };
        let found = threshold(
            model,
            (Directions::AsGiven, &unit_pulse()),
            &request(1.0),
            &all,
            &runner,
            watch,
        )
        .unwrap();
        assert!(last.is_some_and(|(done, all)| done == all));
        assert_eq!(found.model, model.0);
        found
    });
    let near = |range: FactorRange, from: f64, to: f64| {
        (range.from / from - 1.0).abs() < EDGE_WIDTH && (range.to / to - 1.0).abs() < EDGE_WIDTH
    };
    let islands = &found[0];
    assert_eq!((islands.bands().len(), islands.gaps().len()), (2, 1));
    assert!(near(islands.bands()[0], 2.0, 3.0) && near(islands.bands()[1], 4.0, 8.0));
    assert!(near(islands.gaps()[0], 3.0, 4.0));
    // Each end has the outcome of its range.
    assert!(islands.bands()[0].from >= 2.0 && islands.bands()[0].to < 3.0);
    assert!(islands.gaps()[0].from >= 3.0 && islands.gaps()[0].to < 4.0);
    let whole = FactorRange {
        verdict: Some(Verdict::Overturns),
        from: 1.0,
        to: 8.0,
        from_end: RangeEnd::Sampled,
        to_end: RangeEnd::Sampled,
    };
    assert_eq!(found[1].bands(), [whole]);
    assert!(
        found[1].gaps().is_empty() && found[2].gaps().is_empty() && found[2].bands().is_empty()
    );
    assert_eq!(found[2].lowest_factor(), None);
}

/// A model that cannot be built is an error before the search with another one, which may take hours.
#[test]
fn models_are_built_before_any_search() {
    let source = Source::of_file(&scenarios().join("tie.toml")).unwrap();
    let [four_links, _, elastic_joints] = MODELS;
    let scenarios = [elastic_joints, four_links].map(|model| {
        let options = ReadOptions {
            model: Some(model),
            ..ReadOptions::default()
        };
        Scenario::of(&source, &options).unwrap()
    });
    let mut cases = 0;
    let error = results(
        &scenarios,
        &factors(0.5, 1.0, 0.5),
        Figure::SCREEN,
        &Runner::default(),
        &mut |_| {
            cases += 1;
            ControlFlow::Continue(())
        },
    );
    assert!(
        error
            .unwrap_err()
            .to_string()
            .contains("four links cannot have ties")
    );
    assert_eq!(cases, 0);
}

#[test]
fn failed_histories_keep_their_reasons_and_stop_no_others() {
    // One failure among the samples, and one only in the search for the edge near 4.05.
    let rule = Rule::new(|x| match x {
        _ if (2.9..3.1).contains(&x) => None,
        _ if (4.04..4.06).contains(&x) => None,
        _ => Some((2.0..4.05).contains(&x)),
    });
    let threshold = found(&rule, &unit_pulse(), 1.0, &factors(1.0, 8.0, 0.03));
    let failed: Vec<_> = threshold
        .samples
        .iter()
        .filter(|sample| sample.result.is_err())
        .collect();
    assert!(
        failed
            .iter()
            .all(|sample| outcome_name(&sample.result) == "failed")
    );
    assert!(
        failed[0]
            .result
            .as_ref()
            .unwrap_err()
            .to_string()
            .contains("transitions")
    );
    assert!(
        failed
            .iter()
            .any(|sample| (4.04..4.06).contains(&sample.factor))
    );
    assert!(threshold.samples.is_sorted_by(|a, b| a.factor < b.factor));
    let ends: Vec<_> = threshold
        .bands()
        .iter()
        .map(|band| (band.from_end, band.to_end))
        .collect();
    assert_eq!(
        ends,
        [
            (RangeEnd::Edge, RangeEnd::Unknown),
            (RangeEnd::Unknown, RangeEnd::Unknown)
        ]
    );
    assert!(threshold.bands()[0].to < 2.9 && threshold.bands()[1].from >= 3.1);
    // An unknown range is not safe.
    assert!(threshold.gaps().is_empty());
}

#[test]
fn a_threshold_can_be_cancelled_and_refuses_invalid_requests() {
    let rule = Rule::new(|_| {
        thread::sleep(Duration::from_millis(1));
        Some(false)
    });
    let model: (&str, &dyn Model) = ("rule", &rule);
    let all = factors(1.0, 8.0, 0.001);
    let runner = Runner::default();
    let stop = |_: Progress| ControlFlow::Break(());
    let error = threshold(
        model,
        (Directions::AsGiven, &unit_pulse()),
        &request(1.0),
        &all,
        &runner,
        stop,
    )
    .unwrap_err();
    let StudyError::Runner(RunnerError::Cancelled(progress)) = error else {
        panic!("{error}");
    };
    assert!(progress.done < 1000 && progress.all <= searched(&all).len());
    let error = threshold(
        model,
        (Directions::AsGiven, &unit_pulse()),
        &request(f64::NAN),
        &all,
        &runner,
        stop,
    )
    .unwrap_err();
    assert!(matches!(error, StudyError::Scenario(error) if error.contains("end_s")));
}

const SCENARIO: &str = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n\
                        [ground.one_cosine]\namplitude_g = 0.5\nduration_s = 0.9\n";

fn file(folder: &Path, text: &str) {
    fs::write(folder.join("s.toml"), text).unwrap();
}

#[test]
fn files_agree_and_threads_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, SCENARIO);
    let said = printed(
        folder,
        &[
            "threshold",
            "s.toml",
            "--from",
            "0.1",
            "--to",
            "10",
            "--threads",
            "1",
        ],
    );
    // The semicircle overturns from 0.266 to 0.990 g and from 1.26 g on.
    golden("threshold", &said);
    let (_, shown) = skeleton(&said);
    for known in ["0.5325", "0.2662", "1.98", "2.52"] {
        assert!(shown.iter().any(|shown| shown.starts_with(known)), "{said}");
    }
    let json = ["--out", "r", "--threads", "3", "--format", "json"];
    let result = printed(
        folder,
        &[
            &["threshold", "s.toml", "--from", "0.1", "--to", "10"][..],
            &json,
        ]
        .concat(),
    );
    let read = |folder_name: &str, name: &str| {
        fs::read_to_string(folder.join(folder_name).join(name)).unwrap()
    };
    for name in ["threshold.json", "threshold.csv", "threshold.svg"] {
        assert!(read("results/s", name) == read("r", name), "{name}");
    }
    assert_eq!(result, read("r", "threshold.json"));

    let json: Value = serde_json::from_str(&result).unwrap();
    assert_eq!(
        (&json["program"], &json["models"][0]["model"]),
        (&"archrock".into(), &"four_links".into())
    );
    assert_eq!(json["peak_acceleration_g"], 0.5);
    let model = &json["models"][0];
    let (bands, gaps) = (
        model["bands"].as_array().unwrap(),
        model["gaps"].as_array().unwrap(),
    );
    assert_eq!((bands.len(), gaps.len()), (2, 1));
    assert_eq!(model["lowest_factor"], bands[0]["from"]);
    let rows = Table::read(folder.join("r/threshold.csv")).rows;
    let samples = model["samples"].as_array().unwrap();
    assert_eq!((rows.len(), samples.len()), (234, 234));
    for (row, sample) in pairs(&rows, samples) {
        assert_eq!(&row[0], "four_links");
        assert_eq!(
            row[1].parse::<f64>().unwrap(),
            sample["factor"].as_f64().unwrap()
        );
        assert_eq!(&row[2], sample["outcome"].as_str().unwrap());
        assert_eq!(
            &row[3],
            sample["overturning_sway"].as_str().unwrap_or_default()
        );
        assert_eq!(
            row[4].parse::<u64>().unwrap(),
            sample["impacts"].as_u64().unwrap()
        );
        let peak = sample["peak_rotation_over_critical"].as_f64().unwrap();
        assert_eq!(row[6].parse::<f64>().unwrap(), peak);
    }

    let svg = read("r", "threshold.svg");
    let document = roxmltree::Document::parse(&svg).unwrap();
    let named = |start: &str| {
        let nodes = document.descendants();
        let names = nodes.filter_map(|node| node.attribute("data-name"));
        names.filter(|name| name.starts_with(start)).count()
    };
    // The curve begins anew in each stretch of factors that it survives.
    let overturns = |row: &Row| row[2] == *"overturned";
    let stretches = rows.chunk_by(|a, b| overturns(a) == overturns(b));
    let survived = stretches.filter(|stretch| !overturns(&stretch[0]));
    let mut curves = document.descendants();
    let curve = curves.find(|node| node.attribute("data-name") == Some("four_links peak"));
    let begins = curve.unwrap().attribute("d").unwrap().matches('M');
    assert_eq!(begins.count(), survived.count());
    let runs = rows.chunk_by(|a, b| {
        let kind = |row: &Row| {
            (
                row[2].to_owned(),
                row[2] == *"overturned",
                row[4].to_owned(),
            )
        };
        let (a, b) = (kind(a), kind(b));
        a.0 == b.0
            && (!a.1
                || a.2 == b.2
                || [a.2, b.2]
                    .iter()
                    .all(|count| count.parse::<u32>().unwrap() > 2))
    });
    let bands = named("four_links ") - named("four_links peak");
    assert_eq!(bands, runs.count());
    for edge in [
        "0.5325",
        "factor on the ground motion (factor 1 = 0.5000 g)",
    ] {
        assert!(svg.contains(&format!(">{edge}<")), "{edge}");
    }
}

/// The example of the documents overturns certainly from 1.2585 to 1.2668, a band that strides of 2 % step over: single histories say so. The quote is
/// below the band. The search begins at the onset, `A_L` over the peak of the pulse, and ends at the first factor that certainly overturns.
#[test]
fn a_narrow_band_below_an_edge_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenarios().join("recipes/own-arch.toml");
    let own = file.to_str().unwrap();
    for factor in [1.2590, 1.2620, 1.2660] {
        let set = format!("ground.one_sine.amplitude_g={}", -0.6 * factor);
        let run = ["run", own, "--no-repeat", "--no-report", "--set", &set];
        assert!(
            printed(folder.path(), &run).contains("overturned"),
            "{factor}"
        );
    }
    let limit = printed(folder.path(), &["limit", own, "--format", "json"]);
    let limit: Value = serde_json::from_str(&limit).unwrap();
    let start_g = limit["incipient_acceleration_g"]["right"].as_f64().unwrap();
    printed(
        folder.path(),
        &["threshold", own, "--no-report", "--out", "t"],
    );
    let found = json(&folder.path().join("t/threshold.json"));
    let model = &found["models"][0];
    let safe = model["survives_up_to_factor"].as_f64().unwrap();
    assert!(safe < 1.2585 && safe > 1.2, "{safe}");
    let first = model["searched_factors"]["from"].as_f64().unwrap();
    assert!(
        (first * 0.6 / start_g - 1.0).abs() < 2.0 * EDGE_WIDTH,
        "{first} {start_g}"
    );
    let samples = model["samples"].as_array().unwrap();
    let outcomes: Vec<&str> = samples
        .iter()
        .map(|one| one["outcome"].as_str().unwrap())
        .collect();
    assert_eq!(outcomes.last(), Some(&"overturned"));
    assert_eq!(
        outcomes.iter().filter(|one| **one == "overturned").count(),
        1
    );
    assert_eq!(model["searched_factors"]["lower_not_tried"], false);
    let quote = found["to_quote"].as_str().unwrap();
    assert!(!quote.contains("not tried"), "{quote}");
}

/// A search that begins above the onset, or where the onset is unknown, says so in its quote; with a smaller first factor the quote is smaller.
#[test]
fn a_quote_names_the_first_factor_if_lower_ones_may_overturn() {
    let folder = tempfile::tempdir().unwrap();
    let column = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[ground.one_sine]\namplitude_g = 0.5\nduration_s = 0.6\n";
    let elastic = format!("{column}[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n");
    let vertical = column.replace("duration_s", "vertical_amplitude_g = 0.05\nduration_s");
    for (text, more, first) in [
        (column, "--stride 0.1", None),
        (column, "--from 0.3 --stride 0.1", None),
        (column, "--from 0.5 --stride 0.1", Some("0.5")),
        (&vertical, "--stride 0.1", Some("0.1")),
        (&elastic, "--stride 0.3 --to 2", Some("0.1")),
    ] {
        self::file(folder.path(), text);
        let all = format!("threshold s.toml {more}");
        let said = printed(folder.path(), &all.split(' ').collect::<Vec<_>>());
        let quote = said.lines().find(|line| line.contains(", with ")).unwrap();
        match first {
            None => assert!(!quote.contains("not tried"), "{quote}"),
            Some(first) => {
                let words = format!("lower factors than {first} not tried");
                assert!(quote.contains(&words), "{quote}");
            }
        }
    }
}

/// Without `--to` the search ends at the first certain collapse, with it at the given factor; both have the same first edge.
#[test]
fn a_search_without_a_last_factor_ends_at_the_first_collapse() {
    let islands = Rule::new(|x| Some((2.0..3.0).contains(&x) || x >= 4.0));
    let found = |to: Option<f64>| {
        let factors = Factors::new(0.5, to, 0.1).unwrap();
        found(&islands, &unit_pulse(), 1.0, &factors)
    };
    let (open, closed) = (found(None), found(Some(8.0)));
    assert_eq!((open.bands().len(), closed.bands().len()), (1, 2));
    assert_eq!(open.survives_up_to(), closed.survives_up_to());
    assert_eq!(open.lowest_factor(), closed.lowest_factor());
    assert!(open.samples.len() < 20 && closed.samples.len() > 28);
    // A band of 1.5 % below the edge, which strides of 10 % step over.
    let narrow = Rule::new(|x| Some((1.7..1.726).contains(&x) || x >= 2.0));
    let factors = Factors::new(0.5, None, 0.1).unwrap();
    let found = self::found(&narrow, &unit_pulse(), 1.0, &factors);
    let safe = found.survives_up_to().unwrap();
    assert!(
        safe < 1.7 && safe > 1.7 * (1.0 - 2.0 * EDGE_WIDTH),
        "{safe}"
    );
}

#[test]
fn strides_and_limits_can_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, SCENARIO);
    let arguments = "threshold s.toml --from 1 --to 2 --stride 0.25 --out r";
    let said = printed(folder, &arguments.split(' ').collect::<Vec<_>>());
    golden("threshold-from-the-smallest", &said);
    let factors = Table::read(folder.join("r/threshold.csv")).numbers("factor");
    assert_eq!(factors, [1.0, 1.25, 1.5625, 1.953125, 2.0]);
    let said = printed(
        folder,
        &["threshold", "s.toml", "--to", "0.4", "--out", "r"],
    );
    shows(&said, &[0.4, 0.2]);
}

#[test]
fn a_scenario_without_a_threshold_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n";
    let initial = format!("{SCENARIO}[initial]\nsway = \"left\"\nrotation_rad = 0.01\n");
    let falling = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[ground.one_sine]\namplitude_g = 0.3\n\
                   vertical_amplitude_g = 0.5\nduration_s = 1.0\n";
    for (text, more, words) in [
        (arch, "", "needs a ground motion"),
        (&initial, "", "leave [initial] out"),
        (falling, "--from 3", "falls as fast as a free body"),
        (SCENARIO, "--from 3 --to 2", "`to = 2.0` is not allowed"),
        (SCENARIO, "--stride 0", "`stride = 0.0` is not allowed"),
        (SCENARIO, "--from nan", "`from = NaN` is not allowed"),
        (SCENARIO, "--threads 0", "--threads"),
        (
            SCENARIO,
            "--resume",
            "which the scenario lacks: leave it out",
        ),
    ] {
        file(folder, text);
        let arguments = format!("threshold s.toml {more}");
        refused(
            folder,
            &arguments.split_whitespace().collect::<Vec<_>>(),
            &[words],
        );
        assert!(!folder.join("results").exists());
    }
    // The ground accelerates downwards with 0.5 g, and as a free body at a factor of 2.
    file(folder, falling);
    let said = printed(
        folder,
        &[
            "threshold",
            "s.toml",
            "--from",
            "1.95",
            "--to",
            "3",
            "--stride",
            "0.1",
        ],
    );
    assert!(
        said.contains("from factor 2.000 on, the ground falls"),
        "{said}"
    );
    golden(
        "threshold-of-free-fall",
        &printed(folder, &["threshold", "s.toml", "--from", "1"]),
    );
}

/// The result of `threshold` for each model, by the name of the model.
fn models(folder: &Path, arguments: &str) -> Vec<(String, Value)> {
    models_and_remarks(folder, arguments).0
}

fn models_and_remarks(folder: &Path, arguments: &str) -> (Vec<(String, Value)>, String) {
    let all = format!("threshold s.toml --from 0.5 --to 8 --stride 1 --format json {arguments}");
    let output = archrock(folder, &all.split_whitespace().collect::<Vec<_>>());
    let json: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let models = json["models"].as_array().unwrap().iter();
    let models = models
        .map(|model| (model["model"].as_str().unwrap().to_owned(), model.clone()))
        .collect();
    (models, stderr(&output))
}

fn names(models: &[(String, Value)]) -> Vec<&str> {
    models.iter().map(|(name, _)| name.as_str()).collect()
}

/// With both models, each has the scenario from which it was computed, and the same results as alone.
#[test]
fn both_models_have_their_own_scenario() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    let impact = "[impact]\nmodel = \"same_sections\"\n[simulation]\nduration_s = 8.0\n";
    file(
        folder,
        &SCENARIO.replace("[ground", &format!("voussoirs = 7\n{impact}[ground")),
    );
    let (both, said_of_both) = models_and_remarks(folder, "--hinges both --out both");
    assert_eq!(names(&both), ["four_links", "free_hinges"]);
    let [(_, four), (_, free)] = &both[..] else {
        panic!("two models")
    };
    assert_eq!(four["scenario"]["impact"]["model"], "same_sections");
    assert_eq!(four["scenario"].get("free_hinges"), None);
    assert!(free["scenario"]["free_hinges"].is_object());
    assert_eq!(free["scenario"].get("impact"), None);
    assert_ne!(four["samples"], free["samples"]);
    let (four, said_of_four) = models_and_remarks(folder, "--hinges four --out four");
    let (free, said_of_free) = models_and_remarks(folder, "--hinges free --out free");
    assert_eq!([&four[..], &free[..]], [&both[..1], &both[1..]]);
    assert_eq!(models(folder, "--out default"), both[..1]);
    let table = fs::read_to_string(folder.join("both/threshold.csv")).unwrap();
    let of = |model: &str| table.lines().filter(|line| line.starts_with(model)).count();
    assert_eq!((of("four_links,"), of("free_hinges,")), (5, 5));
    // The remark that the scenario's impact model is ignored appears if blocks decide impacts, and only then.
    for (said, ignored) in [
        (said_of_four, false),
        (said_of_free, true),
        (said_of_both, true),
    ] {
        assert_eq!(
            said.contains("[impact] is ignored: with free hinges"),
            ignored,
            "{said}"
        );
    }
}

/// Drums are blocks with free hinges. Housner's column has no drums, so `four` and `both` are not available.
#[test]
fn a_column_of_drums_has_a_threshold_with_free_hinges() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    let drums = |free_hinges: &str| {
        format!(
            "[column]\nheight_m = 4.0\nwidth_m = 0.8\ndrums = 3\n{free_hinges}[ground.one_sine]\n\
             amplitude_g = 0.3\nduration_s = 0.8\n[simulation]\nduration_s = 4.0\n"
        )
    };
    file(folder, &drums(""));
    let chosen = models(folder, "--hinges free --out free");
    assert_eq!(names(&chosen), ["free_hinges"]);
    let (_, drummed) = &chosen[0];
    // The scenario has the key that was given.
    let column = &drummed["scenario"]["column"];
    assert_eq!(column["drums"], 3);
    assert_eq!(column.get("drum_heights_m"), None);
    let words = "`drums = 3` needs a table [free_hinges]";
    for more in [&[][..], &["--hinges", "four"], &["--hinges", "both"]] {
        refused(folder, &[&["threshold", "s.toml"], more].concat(), &[words]);
    }
    file(folder, &drums("[free_hinges]\n"));
    assert_eq!(models(folder, "--out default"), chosen);
    for hinges in ["four", "both"] {
        refused(
            folder,
            &["threshold", "s.toml", "--hinges", hinges],
            &["`drums = 3`"],
        );
    }
    // Its samples equal plain histories, with the steps of a run or of many cases.
    let scenario = Scenario::read(&folder.join("s.toml")).unwrap();
    let model = scenario.model().unwrap();
    let samples = drummed["samples"].as_array().unwrap();
    let faster = model.for_many_cases().unwrap();
    assert!(samples.len() >= 5);
    for sample in samples {
        let factor = sample["factor"].as_f64().unwrap();
        let ground = scenario.ground_motion().scaled(factor).unwrap();
        let is_of = |model: &dyn Model| {
            let summary = model.simulate(&ground, &scenario.request(), None).unwrap();
            sample["outcome"] == summary.outcome.name()
                && sample["peak_rotation_rad"] == summary.largest_rotation_rad()
        };
        assert!(is_of(&*model) || is_of(&*faster), "{sample}");
    }
    let outcomes: Vec<_> = samples.iter().map(|sample| &sample["outcome"]).collect();
    assert!(
        outcomes.contains(&&"overturned".into()) && outcomes[0] != "overturned",
        "{outcomes:?}"
    );
}

/// Histories are counted once: factors at which the ground falls freely have none, and are in no total.
#[test]
fn all_totals_of_histories_agree() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[column]\nheight_m = 4.0\nwidth_m = 1.0\n[free_hinges]\n[ground.half_sine]\namplitude_g = 0.9\n\
                duration_s = 0.3\nvertical_amplitude_g = -0.9\n[simulation]\nduration_s = 3.0\n";
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let words = printed(folder.path(), &["threshold", "s.toml", "--to", "10"]);
    assert!(
        words.contains("the ground falls as fast as a free body"),
        "{words}"
    );
    let totals: Vec<&str> = words
        .lines()
        .filter(|line| line.contains("histories"))
        .map(|line| {
            let (before, _) = line.split_once(" histories").unwrap();
            before.rsplit(' ').next().unwrap()
        })
        .collect();
    assert!(
        totals.len() > 1 && totals.iter().all(|total| *total == totals[0]),
        "{words}"
    );
}
