//! Housner's free-standing column compared with closed forms and independent quadratures.

use crate::common::{integral, least, pulse};
use std::f64::consts::PI;

use archrock::mechanics::MechanismChain as _;
use archrock::{
    Column, EventKind, GroundMotion, History, ImpactModel, Initial, Model as _, Outcome, Pulse,
    Request, RockingColumn, Sample, State, Sway,
};
use archrock_motion::internals::hybrid::engine::{EngineError, EngineSettings, Observer, simulate};
use archrock_motion::internals::hybrid::rocking::{Rocking, RockingState};

const GRAVITY_M_S2: f64 = 9.81;

/// A column of slenderness `alpha` and half diagonal 1.7 m.
fn column(alpha: f64) -> RockingColumn {
    let column = Column::new(3.4 * alpha.cos(), 3.4 * alpha.sin()).unwrap();
    RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap()
}

/// Housner's frequency parameter of [`column`].
fn p() -> f64 {
    (0.75 * GRAVITY_M_S2 / 1.7).sqrt()
}

/// Housner's restitution, energy after over before.
fn restitution(alpha: f64) -> f64 {
    (1.0 - 1.5 * alpha.sin().powi(2)).powi(2)
}

/// The only samples are those at the start and at the end.
const REQUEST: Request = Request {
    gravity_m_s2: GRAVITY_M_S2,
    end_s: 60.0,
    outcome_by_s: None,
    output_step_s: 60.0,
    initial: None,
    relative_tolerance: 1e-12,
    rest_energy_ratio: 1e-8,
};

fn released(sway: Sway, rotation_rad: f64) -> Request {
    Request {
        initial: Some(Initial {
            sway,
            rotation_rad,
            rate_rad_s: 0.0,
        }),
        ..REQUEST
    }
}

fn run(column: &RockingColumn, ground: &GroundMotion, request: &Request) -> History {
    column.history(ground, request).unwrap()
}

/// Time of the first impact after the release from `theta_0`.
fn quarter_period_s(alpha: f64, theta_0: f64) -> f64 {
    let (column, still) = (column(alpha), GroundMotion::still());
    let history = run(&column, &still, &released(Sway::Right, theta_0));
    history.impacts().next().unwrap().0
}

/// Energy integral `theta'^2 = 2 p^2 (cos(alpha - theta_0) - cos(alpha - theta))`. The substitution
/// `theta = theta_0 (1 - u^2)` removes the singularity at the turning point, and the difference of cosines is
/// written as a product. The tolerance is that of the integration.
#[test]
fn the_quarter_period_is_the_energy_integral() {
    for (alpha, part) in [(0.05, 0.3), (0.2, 0.5), (0.2, 0.99), (0.6, 0.7), (1.2, 0.4)] {
        let theta_0 = part * alpha;
        let quarter_s = integral(|u| {
            // (cos(alpha - theta_0) - cos(alpha - theta)) / u^2
            let half_gap = 0.5 * theta_0 * u * u;
            let sinc = if u > 0.0 {
                half_gap.sin() / (u * u)
            } else {
                0.5 * theta_0
            };
            let drop = 2.0 * (alpha - theta_0 + half_gap).sin() * sinc;
            2.0 * theta_0 / (2.0 * p() * p() * drop).sqrt()
        });
        let simulated_s = quarter_period_s(alpha, theta_0);
        assert!(
            (simulated_s / quarter_s - 1.0).abs() < 1e-10,
            "{alpha} {part}: {simulated_s} {quarter_s}"
        );
    }
}

/// Housner's period of the slender column: the error is of the order `alpha^2`, so it falls to a
/// quarter when the slenderness is halved.
#[test]
fn the_period_tends_to_the_slender_one() {
    let period_s = 4.0 / p() * (1.0_f64 / (1.0 - 0.6)).acosh();
    let miss = |alpha: f64| 4.0 * quarter_period_s(alpha, 0.6 * alpha) / period_s - 1.0;
    for alpha in [0.2, 0.1, 0.05] {
        let ratio = miss(alpha) / miss(0.5 * alpha);
        assert!((3.9..4.1).contains(&ratio), "{alpha}: {ratio}");
    }
    assert!(miss(1e-4).abs() < 1e-8);
}

/// Peaks between impacts: `1 - cos` of the angle to the equilibrium is multiplied by `r` at every impact.
/// The samples are so dense that the highest is at most `p^2 alpha dt^2 / 8 = 5e-10` below the peak.
#[test]
fn peaks_decay_with_the_restitution() {
    let (alpha, theta_0) = (0.25, 0.2);
    let (column, still) = (column(alpha), GroundMotion::still());
    let request = Request {
        end_s: 12.0,
        output_step_s: 5e-5,
        ..released(Sway::Left, theta_0)
    };
    let mut peaks: Vec<f64> = Vec::new();
    let history = run(&column, &still, &request);
    for sample in history.samples.iter() {
        peaks.resize(sample.phase + 1, 0.0);
        let rotation = sample.rotations_rad[0];
        if sample.state == State::Rest {
            continue;
        }
        // Released to the left, it turns anticlockwise; then the sides alternate.
        let side = if sample.phase.is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
        assert!(
            side * rotation >= 0.0 && (sample.state == State::Rocking(Sway::Left)) == (side > 0.0)
        );
        peaks[sample.phase] = peaks[sample.phase].max(rotation.abs());
    }
    assert!(history.summary.peak_rotations_rad[0] == theta_0);
    assert!(peaks.len() > 8);
    let energy = |theta: f64| (alpha - theta).cos() - alpha.cos();
    // The last hop may be cut by the end of the simulation.
    for (impacts, peak) in (0_i32..).zip(&peaks[..peaks.len() - 1]) {
        let left = restitution(alpha).powi(impacts) * energy(theta_0);
        let expected = alpha - (alpha.cos() + left).acos();
        assert!(
            (peak - expected).abs() < 2e-9,
            "{impacts}: {peak} {expected}"
        );
    }
    for (_, impact) in history.impacts() {
        assert!(
            (impact.energy_after_j / impact.energy_before_j - restitution(alpha)).abs() < 1e-14
        );
    }
}

/// The same for slender columns: `1 - (1 - phi)^2`, where `phi` is the rotation over `alpha`. Energies before the
/// impacts stand for the peaks; the slender law has an error of `alpha^2`.
#[test]
fn slender_columns_decay_by_housners_law() {
    let (alpha, phi_0) = (1e-3, 0.7);
    let (column, still) = (column(alpha), GroundMotion::still());
    let history = run(&column, &still, &released(Sway::Right, phi_0 * alpha));
    // r is 1 - 3e-6, so the loss becomes visible only after many impacts.
    assert!(history.summary.impacts > 25);
    let energy = |phi: f64| 1.0 - (1.0_f64 - phi).powi(2);
    for (impacts, (_, impact)) in (0_i32..).zip(history.impacts()) {
        // theta'^2 = p^2 alpha^2 (1 - (1 - phi)^2) at the impact.
        let simulated = (impact.rates_before_rad_s[0] / (p() * alpha)).powi(2);
        let expected = restitution(alpha).powi(impacts) * energy(phi_0);
        assert!((simulated - expected).abs() < 1e-6, "{impacts}");
    }
}

#[test]
fn uplift_starts_at_the_slenderness() {
    for alpha in [0.01, 0.2, 0.9] {
        let column = column(alpha);
        assert!((column.incipient_g() - alpha.tan()).abs() < 1e-15);
        for side in [-1.0, 1.0] {
            let outcome = |amplitude_g: f64| {
                let ground = pulse(Pulse::Rectangular, side * amplitude_g, 1.0);
                run(&column, &ground, &REQUEST)
                    .events
                    .first()
                    .map(|event| event.state.sway())
            };
            assert_eq!(outcome(alpha.tan() * (1.0 - 1e-9)), None);
            let sway = if side < 0.0 { Sway::Right } else { Sway::Left };
            assert_eq!(outcome(alpha.tan() * (1.0 + 1e-9)), Some(Some(sway)));
        }
    }
    let column = column(0.2);
    let ground = pulse(Pulse::HalfSine, 0.2_f64.tan() * (1.0 - 1e-9), 1.0);
    assert_eq!(
        run(&column, &ground, &REQUEST).summary.outcome,
        Outcome::NeverMoved
    );
}

/// Whether a pulse to the left overturns the column to the right without impact.
fn overturns_at_once(column: &RockingColumn, ground: &GroundMotion) -> bool {
    let summary = column.simulate(ground, &REQUEST, None).unwrap();
    summary.outcome == Outcome::Overturned(Sway::Right) && summary.impacts == 0
}

/// Smallest `x = a / (g alpha)` that overturns at once, by bisection to `1e-9`.
fn overturning_x(kind: Pulse, alpha: f64, duration_s: f64) -> f64 {
    let column = column(alpha);
    least([1.0, 30.0], 1e-9, |x| {
        overturns_at_once(&column, &pulse(kind, -x * alpha, duration_s))
    })
}

/// Slender: `cosh(p t_1) = 1 + 1 / (2 x (x - 1))` (Housner), solved for `x`. The error is of the order
/// `alpha^2`.
#[test]
fn rectangular_pulses_overturn_slender_columns_at_housners_amplitude() {
    for time in [0.3, 0.8, 2.0_f64] {
        let duration_s = time / p();
        let product = 0.5 / (time.cosh() - 1.0);
        let x = 0.5 + (0.25 + product).sqrt();
        let miss = |alpha: f64| overturning_x(Pulse::Rectangular, alpha, duration_s) / x - 1.0;
        assert!(miss(0.01).abs() < 1e-4, "{time}: {}", miss(0.01));
        let ratio = miss(0.2) / miss(0.1);
        assert!((3.5..4.5).contains(&ratio), "{time}: {ratio}");
    }
}

/// Finite slenderness: while a push `a` lasts, the energy integral is
/// `theta'^2 = 2 p^2 (a/g (sin(alpha) - sin(alpha - theta)) - (cos(alpha - theta) - cos(alpha)))`. The pulse
/// just overturns if the energy at its end, `theta_1`, is that of the upright diagonal, which means
/// `sin(alpha - theta_1) = sin(alpha) - (1 - cos(alpha)) g / a`. Its duration is then the integral of
/// `d theta / theta'`, with `theta = theta_1 u^2` to remove the singularity of the start from rest.
#[test]
fn rectangular_pulses_overturn_fat_columns_by_the_energy_integral() {
    for (alpha, push_g) in [(0.3_f64, 0.8), (0.3, 0.35), (0.7, 1.5)] {
        let lost = alpha.sin() - (1.0 - alpha.cos()) / push_g;
        let theta_1 = alpha - lost.asin();
        let duration_s = integral(|u| {
            // theta' / u, differences of sines and cosines as products.
            let half = 0.5 * theta_1 * u * u;
            let sinc = if u > 0.0 {
                half.sin() / (u * u)
            } else {
                0.5 * theta_1
            };
            let gain = 2.0 * sinc * (push_g * (alpha - half).cos() - (alpha - half).sin());
            2.0 * theta_1 / (2.0 * p() * p() * gain).sqrt()
        });
        let column = column(alpha);
        let overturns = |duration_s| {
            overturns_at_once(&column, &pulse(Pulse::Rectangular, -push_g, duration_s))
        };
        assert!(overturns(duration_s * (1.0 + 1e-9)), "{alpha} {push_g}");
        assert!(!overturns(duration_s * (1.0 - 1e-9)), "{alpha} {push_g}");
    }
}

/// Slender column under a half sine `x g alpha sin(w t)`, `b = w / p`.
///
/// It lifts off at `t_0` with `x sin(w t_0) = 1`. With `y = theta / alpha - 1` the motion is
/// `y'' = p^2 (y + x sin(w t))`. So `v = y' + p y`, the amplitude of the growing exponential, obeys
/// `v' = p v + p^2 x sin(w t)` from `v(t_0) = -p`. The column overturns if `v >= 0` at the end `pi / w`, that
/// is if `p x int_{t_0}^{pi/w} exp(-p (t - t_0)) sin(w t) dt >= 1`. The integral is elementary and gives
///
/// `sqrt(x^2 - 1) + x exp(-(pi - asin(1/x)) / b) >= b`.
#[test]
fn half_sines_overturn_slender_columns_by_the_linear_solution() {
    for b in [1.5, 3.0, 6.0_f64] {
        let excess = |x: f64| (x * x - 1.0).sqrt() + x * (-(PI - (1.0 / x).asin()) / b).exp() - b;
        let due = least([1.0, 30.0], 1e-12, |x| excess(x) > 0.0);
        let duration_s = PI / (b * p());
        let miss = |alpha: f64| overturning_x(Pulse::HalfSine, alpha, duration_s) / due - 1.0;
        assert!(miss(0.01).abs() < 1e-4, "{b}: {}", miss(0.01));
        let ratio = miss(0.2) / miss(0.1);
        assert!((3.3..4.7).contains(&ratio), "{b}: {ratio}");
    }
}

#[test]
fn mirrored_pulses_give_mirrored_motions_to_the_last_bit() {
    let column = column(0.2);
    for kind in Pulse::ALL.iter().copied() {
        let record = |sign: f64| {
            let ground = pulse(kind, sign * 0.5, 0.3);
            let request = Request {
                output_step_s: 0.01,
                ..REQUEST
            };
            let history = run(&column, &ground, &request);
            let row = |sample: Sample| {
                let values = [sample.rotations_rad[0], sample.rates_rad_s[0]];
                (sample.time_s, values.map(|value| sign * value + 0.0))
            };
            let rows: Vec<_> = history.samples.iter().map(row).collect();
            let events: Vec<_> = history
                .events
                .iter()
                .map(|event| (event.time_s, event.kind, sign * event.rates_rad_s[0]))
                .collect();
            (rows, events)
        };
        assert_eq!(record(1.0), record(-1.0), "{kind:?}");
    }
}

/// The defect is relative to the barrier, over a history of up to some hundred hops.
#[test]
fn energy_is_kept() {
    for alpha in [0.02, 0.2, 0.7] {
        let column = column(alpha);
        for kind in Pulse::ALL.iter().copied() {
            for x in [1.2, 2.0, 4.0] {
                let ground = pulse(kind, x * alpha.tan(), 0.25);
                let defect = run(&column, &ground, &REQUEST).summary.energy_defect_ratio;
                assert!(defect < 1e-10, "{alpha} {kind:?} {x}: {defect}");
            }
        }
    }
}

/// The ground pushes all the time, but too little to lift the column off; the smaller the hops, the more
/// the push holds it down. Whatever the push, the energy at `q = 0` falls by the factor `r` at every impact, so the
/// number of impacts follows; their instants accumulate.
#[test]
fn chattering_on_a_pushing_ground_ends_in_rest() {
    let (alpha, theta_0) = (0.3, 0.01);
    let column = column(alpha);
    let push = 0.6;
    let ground = pulse(Pulse::Rectangular, -push * alpha.tan(), 50.0);
    let history = run(&column, &ground, &released(Sway::Left, theta_0));
    assert_eq!(history.summary.outcome, Outcome::Rest);
    let energy = |theta: f64| {
        let against = push * alpha.tan() * (alpha.sin() - (alpha - theta).sin());
        (alpha - theta).cos() - alpha.cos() + against
    };
    let at_impact = energy(theta_0) / (1.0 - alpha.cos());
    let impacts = ((1e-8 / at_impact).ln() / restitution(alpha).ln()).ceil();
    assert!(
        (history.summary.impacts as f64 - impacts).abs() < 0.5,
        "{impacts}"
    );
    assert!(history.summary.outcome_time_s < 10.0);
    let last = history.events.last().unwrap();
    assert!(last.kind == EventKind::Rest && last.time_s == history.summary.outcome_time_s);
}

struct Nobody;

impl Observer<Rocking<'_, RockingColumn>, 3> for Nobody {}

#[test]
fn too_many_events_are_an_error_with_a_remedy() {
    let (column, still) = (column(0.2), GroundMotion::still());
    let rocking = Rocking::new(&column, &still, GRAVITY_M_S2, 1e-8);
    let settings = |max_transitions| EngineSettings {
        end_s: 60.0,
        relative_tolerance: 1e-9,
        max_transitions,
    };
    let start = RockingState::new(0.1, 0.0, 0.0);
    let result = |most| {
        let mode = rocking.released_mode(Sway::Right);
        simulate(&rocking, mode, start, &settings(most), &mut Nobody)
    };
    let error = result(5).unwrap_err();
    let sixth_s = run(
        &column,
        &still,
        &Request {
            relative_tolerance: 1e-9,
            ..released(Sway::Right, 0.1)
        },
    )
    .events[5]
        .time_s;
    assert!(matches!(error, EngineError::TooManyTransitions(time_s, 5) if time_s == sixth_s));
    let message = error.to_string();
    for word in [
        "5 transitions",
        "rest_energy_ratio",
        "duration_s",
        &sixth_s.to_string(),
    ] {
        assert!(message.contains(word), "{message}");
    }
    assert!(result(1000).is_ok());
}

#[test]
fn a_flat_column_falls_back_and_lies_still() {
    let alpha = 1.0;
    let column = column(alpha);
    let still = GroundMotion::still();
    let history = run(&column, &still, &released(Sway::Left, 0.3));
    assert_eq!(history.summary.outcome, Outcome::Rest);
    let impacts: Vec<_> = history.impacts().collect();
    let [(_, impact)] = impacts[..] else {
        panic!("one impact");
    };
    assert!(impact.opened.is_empty() && impact.restitution == 0.0);
    assert!(impact.rates_after_rad_s == [0.0]);
    // From the left, where its rotation was anticlockwise, it falls back clockwise.
    assert!(impact.rates_before_rad_s[0] < 0.0);
}

/// At the ends of the ranges of the scenario nothing overflows or loses its digits. A column as slender as
/// `1e-9` is pushed by the acceleration that would lift it.
#[test]
fn columns_of_all_proportions_rock() {
    for height_m in [1e-3, 1.0, 1e6] {
        for width_m in [1e-3, 1.0, 1e6] {
            let column = Column::new(height_m, width_m).unwrap();
            let column = column.with_depth_m(1e6).unwrap();
            let column = column.with_density_kg_m3(1e6).unwrap();
            let column = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
            let time_s = (column.length_m() / GRAVITY_M_S2).sqrt();
            for x in [1.5, 10.0] {
                let ground = pulse(Pulse::OneSine, x * column.incipient_g(), time_s);
                let request = Request {
                    end_s: 30.0 * time_s,
                    output_step_s: 30.0 * time_s,
                    relative_tolerance: 1e-9,
                    ..REQUEST
                };
                let history = run(&column, &ground, &request);
                // It lifts off if and only if the push is large enough.
                let uplifts = history
                    .events
                    .iter()
                    .filter(|e| e.kind == EventKind::Uplift);
                assert_eq!(uplifts.count(), 1);
                assert!(history.summary.peak_rotations_rad[0] > 0.0);
                assert!((0.0..=0.5 * PI).contains(&history.summary.peak_rotations_rad[0]));
                // A flat column starts at accelerations whose work is far larger than the barrier.
                let defect = history.summary.energy_defect_ratio;
                assert!(defect.is_finite() && (width_m > height_m || defect < 1e-7));
            }
        }
    }
}
