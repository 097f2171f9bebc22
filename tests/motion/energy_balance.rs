//! The energy balance of a row: a doubtful balance is reported, and a wrong one is an error.

use crate::common::{GRAVITY, released, request};
use archrock::dynamics::{
    DOUBTFUL_ENERGY_ERROR, FreeHinges, GroundMotion, Model as _, Pulse, RowMotionError, RowOptions,
    SimulationError,
};
use archrock::mechanics::Column;
use archrock::mechanics::Sway;

const COEFFICIENTS: [Option<f64>; 2] = [None, Some(0.8)];

fn block(friction_coefficient: Option<f64>, longest_step_s: Option<f64>) -> FreeHinges {
    let column = Column::new(4.0, 0.8).unwrap();
    let options = RowOptions {
        longest_step_s,
        friction_coefficient,
        ..RowOptions::default()
    };
    let model = FreeHinges::of_column(&column).unwrap();
    model.with_options(options).unwrap()
}

/// A released block gains the energy by which its centre comes down, from sine and cosine of its rotation, half its width and height.
/// The first impact is within a step of the largest kinetic energy.
#[test]
fn the_largest_kinetic_energy_is_recorded() {
    let angle_rad = 0.1_f64;
    for coefficient in COEFFICIENTS {
        let model = block(coefficient, None);
        let request = released(5.0, Sway::Right, angle_rad);
        let summary = model
            .simulate(&GroundMotion::still(), &request, None)
            .unwrap();
        let row = summary.row().unwrap();
        let rise_m = 2.0 * (angle_rad.cos() - 1.0) + 0.4 * angle_rad.sin();
        let due_j = model.row().mass_kg() * GRAVITY * rise_m;
        let miss = row.largest_kinetic_j / due_j - 1.0;
        assert!(miss.abs() < 2e-3, "{coefficient:?} {miss}");
        assert!(row.energy_error < 1e-6);
    }
}

/// With ever longer steps the energy balance gets worse, then doubtful. An error of more than a hundredth of the larger of the barrier,
/// `m g (R - h)`, and the largest kinetic energy is refused; the message names a step with which it is not.
#[test]
fn a_wrong_energy_balance_fails() {
    let push = Pulse::Rectangular
        .lasting_s(0.1)
        .horizontal_m_s2(-0.8 * GRAVITY)
        .unwrap();
    for coefficient in COEFFICIENTS {
        let (mut doubtful, mut wrong) = (0, 0);
        let mut longest_step_s = 1e-3;
        while longest_step_s < 0.9 {
            let model = block(coefficient, Some(longest_step_s));
            match model.simulate(&push, &request(6.0), None) {
                Ok(summary) => {
                    let row = summary.row().unwrap();
                    let mass_kg = model.row().mass_kg();
                    let barrier_j = mass_kg * GRAVITY * (2.0_f64.hypot(0.4) - 2.0);
                    let defect_j =
                        summary.energy_defect_ratio * mass_kg * GRAVITY * model.row().size_m;
                    let due = defect_j / barrier_j.max(row.largest_kinetic_j);
                    let error = row.energy_error;
                    assert!((error / due - 1.0).abs() < 1e-12 || error < 1e-12);
                    assert!(error <= 1e-2, "{coefficient:?} {longest_step_s} {error}");
                    doubtful += usize::from(error > DOUBTFUL_ENERGY_ERROR);
                }
                Err(SimulationError::Row(RowMotionError::Energy {
                    error,
                    longest_step_s: proposed_s,
                    ..
                })) => {
                    assert!(error > 1e-2);
                    assert!((proposed_s / (0.2 * longest_step_s) - 1.0).abs() < 1e-12);
                    let shorter = block(coefficient, Some(0.02 * longest_step_s));
                    assert!(shorter.simulate(&push, &request(6.0), None).is_ok());
                    wrong += 1;
                }
                Err(other) => panic!("{coefficient:?} {longest_step_s} {other}"),
            }
            longest_step_s *= 1.3;
        }
        assert!(
            doubtful > 0 && wrong > 0,
            "{coefficient:?}: {doubtful} {wrong}"
        );
    }
}
