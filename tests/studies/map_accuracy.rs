//! A map of many pulses at the default tolerance equals the map at a thousandth of it.

use crate::common::{GRAVITY, request, semicircle};
use archrock::{Model as _, Outcome, Pulse, Request};

/// Cells along each side.
const CELLS: u32 = 20;

/// Errors of 1e-9 per step at the default tolerance accumulate over some tens of steps, and grow where a structure
/// passes slowly near the unstable equilibrium. Found: 5e-9.
const PEAK_TOLERANCE: f64 = 1e-7;

#[test]
fn a_map_of_rectangular_pulses_does_not_depend_on_the_tolerance() {
    let arch = semicircle();
    let between = |low: f64, high: f64, cell: u32| {
        low + (high - low) * f64::from(cell) / f64::from(CELLS - 1)
    };
    let mut on_the_boundary = Vec::new();
    let (mut overturned, mut rested) = (0, 0);
    for cell in 0..CELLS * CELLS {
        let amplitude_g = between(0.15, 1.5, cell / CELLS);
        let duration_s = between(0.05, 1.0, cell % CELLS);
        let name = format!("{amplitude_g:.4} g for {duration_s:.4} s");
        let ground = Pulse::Rectangular
            .lasting_s(duration_s)
            .horizontal_m_s2(amplitude_g * GRAVITY)
            .unwrap();
        let [usual, exact] = [1e-9, 1e-12].map(|relative_tolerance| {
            let request = Request {
                relative_tolerance,
                ..request(10.0)
            };
            arch.simulate(&ground, &request, None).unwrap()
        });
        // The outcome includes the sway.
        let [usual_end, exact_end] =
            [&usual, &exact].map(|summary| (summary.outcome, summary.impacts));
        if usual_end != exact_end {
            on_the_boundary.push(format!("{name}: {usual_end:?}, exactly {exact_end:?}"));
            continue;
        }
        match exact.outcome {
            Outcome::Overturned(_) => overturned += 1,
            Outcome::Rest => rested += 1,
            _ => {}
        }
        let [usual_peak, exact_peak] =
            [&usual, &exact].map(|end| end.peak_over_critical().unwrap());
        let difference = (usual_peak - exact_peak).abs();
        assert!(
            difference < PEAK_TOLERANCE,
            "{name}: {usual_peak} {exact_peak}"
        );
    }
    // A cell right on the boundary could go either way; none of this grid does.
    assert!(
        on_the_boundary.is_empty(),
        "{} cells: {on_the_boundary:#?}",
        on_the_boundary.len()
    );
    // Both sides of the boundary are on the map.
    assert!(overturned > 100 && rested > 20, "{overturned} {rested}");
}
