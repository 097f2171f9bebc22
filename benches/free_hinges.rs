//! Speed of free hinges: steps over a record, a history to rest, maps, and the most expensive step of a long row.
//!
//! Run with `cargo bench --bench free_hinges`.
#![allow(clippy::disallowed_methods, reason = "digits do not matter here")]

use std::f64::consts::PI;

use archrock::dynamics::{GroundMotion, Pulse};
use archrock::mechanics::four_link::{HingeSites, incipient};
use archrock::mechanics::{Ring, Row, Side, Twist};
use archrock::scenario::Scenario;
use archrock::studies::Study as _;
use archrock::studies::map::OverturningMap;
use archrock_motion::internals::contact::{ContactProgram, Load};
use archrock_motion::internals::free_hinges::{Settings, simulate};
use archrock_motion::internals::joints::Placement;
use divan::Bencher;
use divan::counter::ItemsCount;

const GRAVITY_M_S2: f64 = 9.81;

fn main() {
    divan::main();
}

fn arch(embrace_deg: f64, voussoirs: usize, radius_m: f64) -> Row {
    let ring = Ring::new(0.15, embrace_deg / 180.0 * PI).expect("a ring");
    Row::arch(&ring, voussoirs, radius_m, 1.0, 2000.0).expect("an arch")
}

/// A broadband record of 25 s, half as strong vertically: white noise through the filter of Kanai and Tajimi for firm ground
/// (15.7 rad/s, damping 0.6) and that of Clough and Penzien against drift (1.57 rad/s), under an envelope. It is the same on
/// every machine.
fn record(peak_g: f64) -> GroundMotion {
    let mut state = 1_u64;
    let mut component = |peak_g: f64| -> Vec<(f64, f64)> {
        let (ground, high_pass, damping) = (15.7, 1.57, 0.6);
        // Displacement and velocity of each filter.
        let (mut x, mut v, mut y, mut w) = (0.0, 0.0, 0.0, 0.0);
        let samples: Vec<(f64, f64)> = (0..2500_u32)
            .map(|i| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                let part =
                    f64::from(u32::try_from(state >> 33).unwrap_or(0)) / f64::from(1_u32 << 31);
                let mut acceleration = 0.0;
                for _ in 0..10 {
                    v += 1e-3
                        * (1.0 - 2.0 * part - 2.0 * damping * ground * v - ground * ground * x);
                    x += 1e-3 * v;
                    let soil = -2.0 * damping * ground * v - ground * ground * x;
                    w += 1e-3 * (-2.0 * damping * high_pass * w - high_pass * high_pass * y - soil);
                    y += 1e-3 * w;
                    acceleration =
                        -2.0 * damping * high_pass * w - high_pass * high_pass * y - soil;
                }
                let time_s = 0.01 * f64::from(i);
                (time_s, acceleration * (PI * time_s / 25.0).sin())
            })
            .collect();
        let most = samples.iter().fold(0.0_f64, |most, s| most.max(s.1.abs()));
        let scale = peak_g * GRAVITY_M_S2 / most;
        samples.iter().map(|s| (s.0, s.1 * scale)).collect()
    };
    let (horizontal, vertical) = (component(peak_g), component(0.5 * peak_g));
    GroundMotion::record(&horizontal, &vertical, 0.0).expect("a record")
}

/// Mean time of a step, for fixed steps of 0.1 ms over a record of 25 s.
#[divan::bench(args = [7, 36, 144], sample_count = 3, sample_size = 1)]
fn step_over_a_record(bencher: Bencher, voussoirs: usize) {
    steps_over_a_record(bencher, voussoirs, None);
}

/// Mean time of a step with joints that slip.
#[divan::bench(args = [7, 36, 144], sample_count = 3, sample_size = 1)]
fn step_over_a_record_with_friction(bencher: Bencher, voussoirs: usize) {
    steps_over_a_record(bencher, voussoirs, Some(0.7));
}

fn steps_over_a_record(bencher: Bencher, voussoirs: usize, friction_coefficient: Option<f64>) {
    let row = arch(157.5, voussoirs, 10.0);
    let ground = record(0.5);
    let settings = Settings {
        longest_step_s: 1e-4,
        shortest_step_s: 1e-5,
        friction_coefficient,
        ..Settings::to_landings(&row, GRAVITY_M_S2, 25.0)
    };
    let steps = simulate(&row, &ground, GRAVITY_M_S2, &settings, None, None)
        .map_or(1, |run| run.cost.steps);
    bencher
        .counter(ItemsCount::new(steps))
        .bench(|| simulate(&row, &ground, GRAVITY_M_S2, &settings, None, None).map(|r| r.end_s));
}

/// A pulse, and the whole motion until rest.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn history_of_the_semicircle(bencher: Bencher) {
    let row = arch(180.0, 36, 5.0);
    let ground = Pulse::Rectangular
        .lasting_s(0.2)
        .horizontal_m_s2(-0.25 * GRAVITY_M_S2)
        .expect("a pulse");
    let settings = Settings::to_landings(&row, GRAVITY_M_S2, 60.0);
    bencher.bench(|| simulate(&row, &ground, GRAVITY_M_S2, &settings, None, None).map(|r| r.end_s));
}

/// A map of 6 x 6 pulses as the study computes it, with its repetitions: cells per second on one core.
#[divan::bench(args = [7, 36], sample_count = 2, sample_size = 1)]
fn map_of_pulses(bencher: Bencher, voussoirs: usize) {
    let text = format!(
        "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = {voussoirs}\n\
         [free_hinges]\n[ground.rectangular]\namplitude_g = -0.3\nduration_s = 0.2\n\
         [simulation]\nduration_s = 30.0\n[map]\n\
         duration_s = {{ from = 0.1, to = 0.5, count = 6 }}\n\
         amplitude_g = {{ from = -0.65, to = -0.15, count = 6 }}\n"
    );
    let scenario = Scenario::parse(&text, "map.toml").expect("a scenario");
    bencher.counter(ItemsCount::new(36_usize)).bench(|| {
        let map = OverturningMap::of(&scenario).expect("a map");
        (0..map.count())
            .flat_map(|cell| map.rows(&[cell]))
            .collect::<Vec<_>>()
    });
}

/// All four hinges of a long arch close at once, starting from the active set of the previous motion: the most expensive step.
#[divan::bench(args = [36, 200])]
fn full_closure(bencher: Bencher, voussoirs: usize) {
    let ring = Ring::new(0.15, PI).expect("a ring");
    let row = Row::arch(&ring, voussoirs, 1.0, 1.0, 1.0).expect("an arch");
    let onset = incipient(&ring, HingeSites::Voussoirs(voussoirs)).expect("it stands");
    let closing = onset.mechanism.field().scaled(-1.0);
    let at = |angle_rad: f64| closing.twist_at(angle_rad, Side::After);
    let sections = ring.sections(voussoirs);
    let free: Vec<Twist> = sections
        .windows(2)
        .map(|ends| at(0.5 * (ends[0] + ends[1])))
        .collect();
    let placement = Placement::new(&row);
    let load = Load {
        free,
        ..Load::none(&row)
    };
    let mut program = ContactProgram::new(&row);
    bencher.bench_local(|| {
        program.set_positions(&placement);
        program.reset();
        program.solve(&load).map(|effort| effort.iterations)
    });
}
