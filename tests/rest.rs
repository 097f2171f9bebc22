//! What the rest criterion costs: nothing that is reported.
#![expect(clippy::unwrap_used, reason = "tests")]

use std::ops::ControlFlow;
use std::path::Path;

use archrock::dynamics::history::{Outcome, history};
use archrock::dynamics::hybrid::rocking::Rocking;
use archrock::mechanics::chain::Structure;
use archrock::scenario::{self, Scenario};

fn outcome_and_peaks<S: Structure>(
    structure: &S,
    scenario: &Scenario,
    rest_energy_ratio: f64,
) -> (Outcome, Vec<f64>) {
    let ground = scenario.ground_motion();
    let gravity_m_s2 = scenario.simulation.gravity_m_s2;
    let rocking = Rocking::new(structure, &ground, gravity_m_s2, rest_energy_ratio);
    let history = history(&rocking, &scenario.request(), |_| ControlFlow::Continue(())).unwrap();
    (
        history.outcome,
        history.peak_rotations_rad.as_ref().to_vec(),
    )
}

/// A structure that rests instead of hopping on has a hundred-millionth of the barrier less: its hops
/// would be 1e-8 of the critical rotation high. A later push finds it at `q = 0` instead, which shifts
/// what follows by about that much; peaks may so change by 1e-6 of themselves, and mostly do not at all.
#[test]
fn halving_the_rest_energy_changes_no_scenario() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut scenarios = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        scenarios += 1;
        let scenario = Scenario::read(&path).unwrap();
        let run = |part: f64| {
            let ratio = scenario.simulation.rest_energy_ratio * part;
            match &scenario.structure {
                scenario::Structure::Arch(arch) => {
                    outcome_and_peaks(&arch.build(scenario.impact).unwrap(), &scenario, ratio)
                }
                scenario::Structure::Column(column) => {
                    outcome_and_peaks(&column.build(scenario.impact), &scenario, ratio)
                }
            }
        };
        let (outcome, peaks) = run(1.0);
        let (same_outcome, same_peaks) = run(0.5);
        assert_eq!(outcome, same_outcome, "{}", path.display());
        for (peak, same) in peaks.into_iter().zip(same_peaks) {
            let change = (peak - same).abs();
            assert!(change <= 1e-6 * peak, "{}: {change}", path.display());
        }
    }
    assert!(scenarios >= 2);
}
