//! Vertical ground acceleration along with the horizontal one.

use std::ops::ControlFlow;

use crate::common::motions::{G, Random, run, scaled, semicircle, synthetic};
use crate::common::program::{archrock, refused, scenarios, stdout};
use crate::common::results::Table;
use crate::common::{impact_times_s, pairs, parsed};
use archrock::dynamics::State;
use archrock::mechanics::four_link::Linkage;
use archrock::mechanics::{Mechanism as _, MechanismChain as _};
use archrock::output::Figure;
use archrock::studies::run::{self, RunOptions, Sinks};
use archrock::{GroundMotion, Initial, Outcome, Pulse, Scenario, Sway};
use nalgebra::Vector2;
use proptest::prelude::*;

fn release(rotation_rad: f64) -> Option<Initial> {
    Some(Initial {
        sway: Sway::Right,
        rotation_rad,
        rate_rad_s: 0.0,
    })
}

/// A constant upward acceleration of the ground is equivalent to more gravity.
#[test]
fn a_steady_vertical_acceleration_is_gravity() {
    let arch = semicircle();
    for vertical in [-3.0, 4.0] {
        let horizontal = scaled(&synthetic(11, 8.0, 0.02), 0.25 * (G + vertical));
        let steady = [(0.0, vertical), (50.0, vertical)];
        let lifted = GroundMotion::record(&horizontal, &steady, 0.0).unwrap();
        let plain = GroundMotion::record(&horizontal, &[], 0.0).unwrap();
        let ((a, rows_a), (b, rows_b)) = (
            run(&arch, &lifted, G, None, 9.0),
            run(&arch, &plain, G + vertical, None, 9.0),
        );
        assert!(b.summary.impacts > 20 && b.summary.peak_rotations_rad[0] > 1e-3);
        assert_eq!(a.summary.impacts, b.summary.impacts);
        for (x, y) in pairs(impact_times_s(&a), impact_times_s(&b)) {
            assert!((x - y).abs() < 1e-8, "{x} {y}");
        }
        // The plain ground is quiet for some time, which ends the run at rest; the rising ground is not.
        let (end, until) = rows_b.split_last().unwrap();
        assert_eq!((end.state, b.summary.outcome), (State::Rest, Outcome::Rest));
        let (before, after) = rows_a.split_at(until.len());
        assert!(until.len() > 1500 && rows_a.len() == 1801);
        for (x, y) in pairs(before, until) {
            assert_eq!(x.time_s, y.time_s);
            for (x, y) in pairs(&x.rotations_rad, &y.rotations_rad) {
                assert!((x - y).abs() < 1e-8);
            }
        }
        assert!(after.iter().all(|row| row.state == State::Rest));
    }
    // The same for a release on ground with pulses in both directions at once.
    let shake = Pulse::Rectangular
        .lasting_s(50.0)
        .inclined_m_s2(Vector2::new(0.05 * G, 2.0))
        .unwrap();
    let push = Pulse::Rectangular
        .lasting_s(50.0)
        .horizontal_m_s2(0.05 * G)
        .unwrap();
    let (_, rows_a) = run(&arch, &shake, G, release(0.03), 3.0);
    let (_, rows_b) = run(&arch, &push, G + 2.0, release(0.03), 3.0);
    for (x, y) in pairs(&rows_a, &rows_b) {
        assert!((x.rotations_rad[0] - y.rotations_rad[0]).abs() < 1e-8);
    }
}

/// Both components grow linearly: the tilt of gravity passes A_L when
/// `h t = A_L (g + v t)`.
#[test]
fn uplift_starts_at_the_tilt_of_gravity() {
    let arch = semicircle();
    let incipient = arch.incipient_g();
    for (h, v) in [
        (1.0, 0.0),
        (1.0, 2.0),
        (-1.0, -3.0),
        (2.0, 8.0),
        (0.1, -5.0),
    ] {
        let uplift = incipient * G / (f64::abs(h) - incipient * v);
        let outcome = |part: f64| {
            let end = part * uplift;
            let ground = GroundMotion::record(
                &[(0.0, 0.0), (end, h * end)],
                &[(0.0, 0.0), (end, v * end)],
                0.3,
            )
            .unwrap();
            run(&arch, &ground, G, None, end + 1.0).0.summary.outcome
        };
        assert_eq!(outcome(1.0 - 1e-9), Outcome::NeverMoved);
        assert_ne!(outcome(1.0 + 1e-3), Outcome::NeverMoved);
    }
    // The vertical motion reduces the weight while the push decreases: the largest tilt occurs neither at the largest push nor at
    // the largest downward acceleration, and lasts for an instant.
    let tilt = |t: f64| (1.2 - 0.3 * t) / (G - 4.0 * t.min(2.0 - t));
    assert!(tilt(1.0) > incipient && tilt(0.7) < incipient && tilt(1.1) < incipient);
    let ground = GroundMotion::record(
        &[(0.0, 1.2), (2.0, 0.6)],
        &[(0.0, 0.0), (1.0, -4.0), (2.0, 0.0)],
        0.0,
    )
    .unwrap();
    let (history, _) = run(&arch, &ground, G, None, 4.0);
    assert_ne!(history.summary.outcome, Outcome::NeverMoved);
}

/// The equation of motion with both accelerations, by the Runge-Kutta method of fourth order in 20000
/// steps, written here from the coefficients: until the first impact the history is the same.
#[test]
fn released_on_vertical_shaking_it_follows_the_equation_of_motion() {
    let arch = semicircle();
    let linkage: &Linkage = &arch.link(0).unwrap().mechanism;
    let (released, end) = (0.04, 0.5);
    let (horizontal, vertical, period) = (0.4, 5.0, 0.5);
    let wave = |t: f64| (2.0 * std::f64::consts::PI * t / period).sin() * f64::from(t < period);
    let bend = |t: f64, q: f64, rate: f64| {
        let c = linkage.coefficients(q);
        let force = (G + vertical * wave(t)) * c.s_y + horizontal * wave(t) * c.s_x;
        -(force / 5.0 + 0.5 * c.inertia_slope * rate * rate) / c.inertia
    };
    let h = 2.5e-5;
    let (mut q, mut rate) = (released, 0.0);
    let mut path = vec![q];
    for step in 0..20_000 {
        let t = f64::from(step) * h;
        // The wave ends at a step; each step stays on its own side of that instant.
        let (start, middle, finish) = (t + 1e-12, t + 0.5 * h, t + h - 1e-12);
        let k1 = (rate, bend(start, q, rate));
        let k2 = (
            rate + 0.5 * h * k1.1,
            bend(middle, q + 0.5 * h * k1.0, rate + 0.5 * h * k1.1),
        );
        let k3 = (
            rate + 0.5 * h * k2.1,
            bend(middle, q + 0.5 * h * k2.0, rate + 0.5 * h * k2.1),
        );
        let k4 = (rate + h * k3.1, bend(finish, q + h * k3.0, rate + h * k3.1));
        q += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        rate += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        path.push(q);
    }
    let amplitude = Vector2::new(horizontal, vertical);
    let ground = Pulse::OneSine
        .lasting_s(period)
        .inclined_m_s2(amplitude)
        .unwrap();
    let (history, rows) = run(&arch, &ground, G, release(released), end);
    assert!(history.summary.impacts == 0 && q > 0.0);
    // The ground moves all the time; on quiet ground the history would end once it is decided.
    assert_eq!(rows.len(), 101);
    for (i, row) in rows.iter().enumerate() {
        assert!(
            (row.rotations_rad[0] + path[200 * i]).abs() < 1e-9,
            "{}",
            row.time_s
        );
    }
    // Without the vertical part the arch is elsewhere.
    let plain = Pulse::OneSine
        .lasting_s(period)
        .horizontal_m_s2(horizontal)
        .unwrap();
    let (_, rows) = run(&arch, &plain, G, release(released), end);
    assert_eq!(rows.len(), 101);
    assert!((rows.last().unwrap().rotations_rad[0] + q).abs() > 1e-4);
    // The ground does work on an open arch: without it the energy would not balance.
    assert!(history.summary.energy_defect_ratio < 1e-8);
}

#[test]
fn ground_that_falls_freely_is_an_input_error() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("up.csv"), "0,0\n1,-20\n2,0\n").unwrap();
    std::fs::write(folder.path().join("side.csv"), "0,0\n1,1\n").unwrap();
    let check = |ground: &str| {
        let text = format!(
            "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n{ground}\n\
             [simulation]\ngravity_m_s2 = 10.0\n"
        );
        let name = folder.path().join("s.toml").display().to_string();
        Scenario::parse(&text, &name).map_err(|errors| errors.to_string())
    };
    let record = |scale: f64| {
        format!(
            "[ground.record]\nfile = 'side.csv'\nunit = 'm/s2'\nstart_s = 3.0\n\
             [ground.record.vertical]\nfile = 'up.csv'\nunit = 'm/s2'\nscale = {scale:?}"
        )
    };
    assert!(check(&record(0.49)).is_ok());
    let error = check(&record(1.0)).unwrap_err();
    assert!(
        error.contains("s.toml:10:8: `file = 'up.csv'` makes the ground fall"),
        "{error}"
    );
    assert!(error.contains("at 3.5 s"), "{error}");

    let pulse = |vertical: f64| {
        format!(
            "[ground.triangular]\namplitude_g = 0.1\nduration_s = 1.0\nvertical_amplitude_g = {vertical:?}"
        )
    };
    assert!(check(&pulse(-0.99)).is_ok() && check(&pulse(50.0)).is_ok());
    let error = check(&pulse(-2.0)).unwrap_err();
    assert!(
        error.contains("s.toml:8:24: `vertical_amplitude_g = -2.0` makes"),
        "{error}"
    );
    assert!(error.contains("at 0.25 s"), "{error}");
}

/// The fixed columns stay the same; the vertical acceleration follows only if there is one.
#[test]
fn the_vertical_acceleration_is_the_last_column_if_present() {
    for vertical_g in [0.0, -0.15] {
        let scenario = parsed(&format!(
            "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n\
             [ground.rectangular]\namplitude_g = -0.2\nvertical_amplitude_g = {vertical_g:?}\nduration_s = 0.1\n\
             [simulation]\nduration_s = 0.2\ngravity_m_s2 = 10.0\n"
        ));
        let mut text = Vec::new();
        run::results(
            &[scenario],
            &RunOptions::default(),
            Figure::SCREEN,
            Sinks {
                rotations: Some(Box::new(&mut text)),
                ..Sinks::default()
            },
            &mut |_| ControlFlow::Continue(()),
        )
        .unwrap();
        let text = String::from_utf8(text).unwrap();
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines[0][11], "friction_demand");
        if vertical_g == 0.0 {
            assert!(lines.iter().all(|line| line.len() == 12));
        } else {
            assert_eq!(lines[0][12], "vertical_acceleration_m_s2");
            assert!(lines[1][12] == "-1.5" && lines.last().unwrap()[12] == "0.0");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Short rough records, around the threshold and far beyond, in both directions: every history ends, and
    /// its energy balances.
    #[test]
    fn rough_records_do_no_harm(
        seed in any::<u64>(),
        push in 0.1_f64..0.6,
        lift in 0.0_f64..0.9,
        step_s in 0.002_f64..0.1,
    ) {
        let mut random = Random(seed);
        let mut rough = |peak: f64| -> Vec<_> {
            let value = |i| (f64::from(i) * step_s, peak * G * (2.0 * random.next() - 1.0));
            (0..100).map(value).collect()
        };
        let ground = GroundMotion::record(&rough(push), &rough(lift), 0.0).unwrap();
        let arch = semicircle();
        let (history, rows) = run(&arch, &ground, G, None, 15.0);
        prop_assert!(history.summary.energy_defect_ratio < 1e-6);
        prop_assert!(rows.iter().all(|row| row.rotations_rad.iter().all(|x| x.is_finite())));
    }
}

/// No model follows a structure on ground that falls away: `run` refuses such ground, and `threshold` and `map` have no histories
/// on it.
#[test]
fn ground_that_falls_away_has_no_history_in_any_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let text = "[column]\nheight_m = 4.0\nwidth_m = 1.0\n[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n\
                [ground.half_sine]\namplitude_g = 0.3\nvertical_amplitude_g = -0.9\nduration_s = 0.3\n\
                [map]\n'column.width_m' = [1.0]\nscale = [1.0, 8.0]\n\
                [simulation]\nduration_s = 8.0\n";
    std::fs::copy(scenarios().join("records/wave-1.at2"), path.join("r.at2")).unwrap();
    for hinges in ["four", "free", "elastic"] {
        let text = if hinges == "elastic" {
            text.to_owned()
        } else {
            let joints = "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n";
            text.replace(
                joints,
                if hinges == "free" {
                    "[free_hinges]\n"
                } else {
                    ""
                },
            )
        };
        std::fs::write(path.join("s.toml"), &text).unwrap();
        let words = ["falls as fast as a free body at"];
        refused(
            path,
            &["threshold", "s.toml", "--from", "2", "--to", "3"],
            &words,
        );
        let falls = [
            "run",
            "s.toml",
            "--set",
            "ground.half_sine.vertical_amplitude_g=-1.8",
        ];
        refused(path, &falls, &["fall as fast as a free body at"]);
        let pulse = "[ground.half_sine]\namplitude_g = 0.3\nvertical_amplitude_g = -0.9\nduration_s = 0.3\n";
        let record = "[ground.record]\nfile = 'r.at2'\ncomponent = 'vertical'\n";
        std::fs::write(path.join("s.toml"), text.replace(pulse, record)).unwrap();
        refused(
            path,
            &["run", "s.toml", "--set", "ground.record.scale=8"],
            &["fall as fast as a free body at"],
        );
        stdout(&archrock(path, &["map", "s.toml", "--out", hinges]));
        let cells = Table::read(path.join(hinges).join("map.csv")).rows;
        assert_ne!(cells[0]["outcome"], "failed", "{hinges}");
        assert_eq!(cells[1]["outcome"], "failed", "{hinges}");
        let summary = std::fs::read_to_string(path.join(hinges).join("map.json")).unwrap();
        assert!(summary.contains(words[0]), "{hinges}: {summary}");
    }
}
