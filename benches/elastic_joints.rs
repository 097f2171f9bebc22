//! Speed of elastic joints: a single history, and histories side by side.
//!
//! Run with `cargo bench --bench elastic_joints`; one step of one joint counts as an item.

use std::f64::consts::PI;

use archrock::mechanics::Ring;
use archrock::mechanics::{Anchor, Tie};
use archrock::{ElasticJoints, ElasticProperties, GroundMotion, Model, Pulse, Request, Row};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

fn model(stiffness_pa_m: f64) -> ElasticJoints {
    let ring = Ring::new(0.15, PI).expect("a ring");
    let row = Row::arch(&ring, 36, 5.0, 1.0, 2700.0).expect("an arch");
    ElasticJoints::new(row, ElasticProperties::of_stiffness(stiffness_pa_m)).expect("it stands")
}

fn case(amplitude_g: f64) -> (GroundMotion, Request) {
    let ground = Pulse::Rectangular
        .lasting_s(0.2)
        .horizontal_m_s2(-amplitude_g * 9.81);
    let request = Request {
        end_s: 3.0,
        ..Request::default()
    };
    (ground.expect("a pulse"), request)
}

/// The semicircle of 36 voussoirs under a pulse that it survives.
#[divan::bench(args = [1e10, 1e11])]
fn alone(bencher: Bencher, stiffness_pa_m: f64) {
    let (model, (ground, request)) = (model(stiffness_pa_m), case(0.2));
    let simulate = || model.simulate(&ground, &request, None).expect("a history");
    let steps = simulate().cost.steps * 37;
    bencher.counter(ItemsCount::new(steps)).bench(simulate);
}

/// The arch of `alone` with this number of ties across it, slack until it moves. A tie should cost no more than a joint.
#[divan::bench(args = [0, 1, 4, 16])]
fn tied(bencher: Bencher, count: usize) {
    let untied = model(1e10);
    let row = untied.row().clone();
    let tie = |index: usize| {
        // Between opposite voussoirs, from the haunches up.
        let joint = 6 + index % 8;
        let end = |joint: usize, block: usize| Anchor {
            block: Some(block),
            at_m: row.joints[joint].intrados_m,
        };
        Tie {
            ends: [end(joint, joint), end(36 - joint, 35 - joint)],
            stiffness_n_m: 1e7,
            prestress_n: 0.0,
            yield_force_n: 1e4,
            breaks_at_strain: f64::INFINITY,
        }
    };
    let row = row.clone().with_ties((0..count).map(tie).collect(), 9.81);
    let row = row.expect("it stands with its ties");
    let model = ElasticJoints::new(row, ElasticProperties::of_stiffness(1e10)).expect("it stands");
    let (ground, request) = case(0.2);
    let simulate = || model.simulate(&ground, &request, None).expect("a history");
    let steps = simulate().cost.steps * 37;
    bencher.counter(ItemsCount::new(steps)).bench(simulate);
}

/// The arch of `alone` with a right foot delayed by 0.05 s.
#[divan::bench]
fn on_two_feet(bencher: Bencher) {
    let (model, (ground, request)) = (model(1e10), case(0.2));
    let late = ground.delayed_by(0.05).expect("a delay");
    let ground = ground.with_right_foot(late);
    let simulate = || model.simulate(&ground, &request, None).expect("a history");
    let steps = simulate().cost.steps * 37;
    bencher.counter(ItemsCount::new(steps)).bench(simulate);
}

/// The arch of `alone` under 32 pulses from 0.10 to 0.22 g, like a row of a map.
#[divan::bench(args = [1e10, 1e11])]
fn side_by_side(bencher: Bencher, stiffness_pa_m: f64) {
    let model = model(stiffness_pa_m);
    let cases: Vec<_> = (0..32).map(|i| case(0.1 + 0.004 * f64::from(i))).collect();
    let simulate = || model.simulate_all(&cases);
    let answers = simulate().into_iter().flatten();
    let steps: u64 = answers.map(|summary| summary.cost.steps * 37).sum();
    bencher.counter(ItemsCount::new(steps)).bench(simulate);
}
