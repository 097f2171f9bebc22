//! Speed of elastic joints: a single history, and histories side by side.
//!
//! Run with `cargo bench --bench elastic_joints`; one step of one joint counts as an item.

use std::f64::consts::PI;

use archrock::mechanics::geometry::ring::Ring;
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
    let ground = GroundMotion::pulse(Pulse::Rectangular, -amplitude_g * 9.81, 0.2, 0.0);
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

/// The same under 32 pulses from 0.10 to 0.22 g, like a row of a map.
#[divan::bench(args = [1e10, 1e11])]
fn side_by_side(bencher: Bencher, stiffness_pa_m: f64) {
    let model = model(stiffness_pa_m);
    let cases: Vec<_> = (0..32).map(|i| case(0.1 + 0.004 * f64::from(i))).collect();
    let simulate = || model.simulate_all(&cases);
    let answers = simulate().into_iter().flatten();
    let steps: u64 = answers.map(|summary| summary.cost.steps * 37).sum();
    bencher.counter(ItemsCount::new(steps)).bench(simulate);
}
