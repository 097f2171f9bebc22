//! What the rest criterion costs: nothing that is reported.
#![expect(clippy::unwrap_used, reason = "tests")]

use std::path::Path;

use archrock::Scenario;

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
        let model = scenario.structure.model(scenario.impact).unwrap();
        let run = |part: f64| {
            let mut request = scenario.request();
            request.rest_energy_ratio *= part;
            let summary = model.simulate(&scenario.ground_motion(), &request, None);
            let summary = summary.unwrap();
            (summary.outcome, summary.peak_rotations_rad)
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
