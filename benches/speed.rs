//! How fast it is: the right-hand side, the chain of mechanisms of an arch, whole histories, maps of them.
//!
//! The arch is a semicircle of mean radius 5 m and thickness ratio 0.15 whose hinges may sit anywhere.
//! Run with `cargo bench`.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::{Arc, LazyLock};

use archrock::dynamics::ground::{GroundMotion, Pulse};
use archrock::dynamics::history::{Outcome, Request, history};
use archrock::dynamics::hybrid::engine::HybridSystem;
use archrock::dynamics::hybrid::rocking::{Rocking, RockingState};
use archrock::mechanics::arch::Arch;
use archrock::mechanics::four_link::chain::Chain;
use archrock::mechanics::four_link::impact::ImpactModel;
use archrock::mechanics::four_link::mechanism::{HingeSites, Sway};
use archrock::mechanics::geometry::ring::Ring;
use divan::Bencher;
use divan::counter::ItemsCount;

const GRAVITY_M_S2: f64 = 9.81;
const REST_ENERGY_RATIO: f64 = 1e-8;
const RELATIVE_TOLERANCE: f64 = 1e-9;

/// The arch with its first links computed, which histories share.
static ARCH: LazyLock<Arch> = LazyLock::new(|| {
    let chain = new_chain();
    let _ = chain.link(30);
    Arch {
        mean_radius_m: 5.0,
        depth_m: 1.0,
        density_kg_m3: 2000.0,
        chain: Arc::new(chain),
    }
});

fn main() {
    divan::main();
}

fn new_chain() -> Chain {
    let ring = Ring::new(0.15, PI).expect("a ring");
    Chain::new(ring, HingeSites::Anywhere, ImpactModel::MaxRestitution).expect("it stands")
}

fn pulse(amplitude_g: f64, duration_s: f64) -> GroundMotion {
    let amplitude_m_s2 = amplitude_g * GRAVITY_M_S2;
    GroundMotion::pulse(Pulse::Rectangular, amplitude_m_s2, duration_s, 0.0)
}

/// Limit analysis and thirty impacts of a new arch.
#[divan::bench]
fn chain_of_30_links(bencher: Bencher) {
    bencher.bench(|| new_chain().link(30).map(|link| link.link.restitution));
}

/// One evaluation of the equation of motion.
#[divan::bench]
fn right_hand_side(bencher: Bencher) {
    let ground = pulse(-0.3, 0.2);
    let rocking = Rocking::new(&*ARCH, &ground, GRAVITY_M_S2, REST_ENERGY_RATIO);
    let mode = rocking.released(Sway::Right);
    let state = RockingState::new(0.02, 0.1, 0.0);
    bencher.bench(|| rocking.slope(mode, 0, 0.1, divan::black_box(&state)));
}

/// From the start of a pulse to the end, rest or overturning, in the time that it takes.
#[divan::bench(args = [(-0.3, 0.2), (-0.6, 0.5)])]
fn history_of_a_rectangular_pulse(bencher: Bencher, (amplitude_g, duration_s): (f64, f64)) {
    let ground = pulse(amplitude_g, duration_s);
    let rocking = Rocking::new(&*ARCH, &ground, GRAVITY_M_S2, REST_ENERGY_RATIO);
    let request = Request {
        end_s: 60.0,
        relative_tolerance: RELATIVE_TOLERANCE,
        initial: None,
        output_step_s: None,
    };
    bencher.bench(|| {
        let history = history(&rocking, &request, |_| ControlFlow::Continue(()));
        history.map(|history| history.outcome)
    });
}

/// Histories of a grid of rectangular pulses, one after another on one thread: what a study costs.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn map_of_30_by_30_pulses(bencher: Bencher) {
    let along = |part: u32| f64::from(part) / 29.0;
    let grounds: Vec<_> = (0..900)
        .map(|cell| {
            let (row, column) = (along(cell / 30), along(cell % 30));
            pulse(0.15 + 1.35 * row, 0.05 + 0.95 * column)
        })
        .collect();
    let request = Request {
        end_s: 10.0,
        relative_tolerance: RELATIVE_TOLERANCE,
        initial: None,
        output_step_s: None,
    };
    bencher.counter(ItemsCount::new(grounds.len())).bench(|| {
        let overturned = grounds.iter().filter(|ground| {
            let rocking = Rocking::new(&*ARCH, ground, GRAVITY_M_S2, REST_ENERGY_RATIO);
            let history = history(&rocking, &request, |_| ControlFlow::Continue(()));
            history.is_ok_and(|history| matches!(history.outcome, Outcome::Overturned(_)))
        });
        overturned.count()
    });
}
