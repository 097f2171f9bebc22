//! Speed of four links: the right-hand side, the chain of mechanisms of an arch, whole histories, maps of them.
//!
//! The arch is a semicircle of mean radius 5 m and thickness ratio 0.15 whose hinges may sit anywhere.
//! Run with `cargo bench`.

use std::sync::LazyLock;

use archrock::{
    Arch, FourLinks, GroundMotion, ImpactModel, Model as _, Outcome, Pulse, Request, Sway,
};
use archrock_motion::internals::hybrid::engine::HybridSystem;
use archrock_motion::internals::hybrid::rocking::{Rocking, RockingState, SystemState};
use divan::Bencher;
use divan::counter::ItemsCount;

const GRAVITY_M_S2: f64 = 9.81;

/// The arch with its first links computed, which all histories share.
static ARCH: LazyLock<FourLinks> = LazyLock::new(|| {
    let arch = new_arch();
    let _ = arch.chain().link(30);
    arch
});

fn main() {
    divan::main();
}

fn new_arch() -> FourLinks {
    let arch = Arch::new(5.0, 0.15, 180.0).expect("an arch");
    FourLinks::of_arch(&arch, ImpactModel::MaxRestitution).expect("it stands")
}

fn pulse(amplitude_g: f64, duration_s: f64) -> GroundMotion {
    let amplitude_m_s2 = amplitude_g * GRAVITY_M_S2;
    Pulse::Rectangular
        .lasting_s(duration_s)
        .horizontal_m_s2(amplitude_m_s2)
        .expect("a pulse")
}

/// Limit analysis and thirty impacts of a new arch.
#[divan::bench]
fn chain_of_30_links(bencher: Bencher) {
    bencher.bench(|| {
        let arch = new_arch();
        arch.chain().link(30).map(|link| link.link.restitution)
    });
}

/// One evaluation of the equation of motion.
#[divan::bench]
fn right_hand_side(bencher: Bencher) {
    let ground = pulse(-0.3, 0.2);
    let rocking = Rocking::new(&*ARCH, &ground, GRAVITY_M_S2, 1e-8);
    let mode = rocking.released_mode(Sway::Right);
    let now = SystemState {
        time_s: 0.1,
        piece: 0,
        mode,
        state: RockingState::new(0.02, 0.1, 0.0),
    };
    bencher.bench(|| rocking.slope(divan::black_box(&now)));
}

/// From the start of a pulse to the end, which is rest or overturning.
#[divan::bench(args = [(-0.3, 0.2), (-0.6, 0.5)])]
fn history_of_a_rectangular_pulse(bencher: Bencher, (amplitude_g, duration_s): (f64, f64)) {
    let ground = pulse(amplitude_g, duration_s);
    let request = Request {
        end_s: 60.0,
        ..Request::default()
    };
    bencher.bench(|| {
        let summary = ARCH.simulate(&ground, &request, None);
        summary.map(|summary| summary.outcome)
    });
}

/// Histories of a grid of rectangular pulses, one after another on one thread: the cost of a study.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn map_of_30_by_30_pulses(bencher: Bencher) {
    let along = |part: u32| f64::from(part) / 29.0;
    let grounds: Vec<_> = (0..900)
        .map(|cell| {
            let (row, column) = (along(cell / 30), along(cell % 30));
            pulse(0.15 + 1.35 * row, 0.05 + 0.95 * column)
        })
        .collect();
    let request = Request::default();
    bencher.counter(ItemsCount::new(grounds.len())).bench(|| {
        let overturned = grounds.iter().filter(|ground| {
            let summary = ARCH.simulate(ground, &request, None);
            summary.is_ok_and(|summary| matches!(summary.outcome, Outcome::Overturned(_)))
        });
        overturned.count()
    });
}
