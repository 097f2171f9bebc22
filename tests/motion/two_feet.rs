//! Feet that move differently: the ground under both, motions of arches on them, and the output of the program about them.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use crate::common::program::{
    assert_shown_output_is_printed, done, files, printed, refused, scenarios,
};
use crate::common::prose::{golden, shows};
use crate::common::results::{Table, named};
use crate::common::{parsed, pulse, run_sampled, sampled};
use archrock::dynamics::SimulationError;
use archrock::mechanics::settling::{Movement, Movements};
use archrock::mechanics::{Drum, Row};
use archrock::{
    ElasticJoints, ElasticProperties, EndCondition, FreeHinges, GroundMotion, Model, Pulse,
    RowOptions,
};
use nalgebra::Vector2;
use roxmltree::Document;

/// An arch of 12 voussoirs on joints of 1 GPa/m.
fn arch() -> ElasticJoints {
    let ring = crate::common::ring(0.15, 157.5);
    let row = Row::arch(&ring, 12, 5.0, 1.0, 2000.0).unwrap();
    ElasticJoints::new(row, ElasticProperties::of_stiffness(1e9)).unwrap()
}

/// A record of smooth horizontal and vertical acceleration, in m/s2, that begins and ends with zero.
fn shaking(strong: [f64; 2], hz: [f64; 2]) -> GroundMotion {
    let of = |strong: f64, hz: f64| -> Vec<(f64, f64)> {
        let at = |step: i32| {
            let time_s = 0.01 * f64::from(step);
            let envelope = (PI * time_s / 0.8).sin().powi(2);
            (time_s, strong * envelope * (2.0 * PI * hz * time_s).sin())
        };
        (0..=80).map(at).collect()
    };
    GroundMotion::record(&of(strong[0], hz[0]), &of(strong[1], hz[1]), 0.0).unwrap()
}

#[test]
fn feet_separate_by_the_difference_of_their_motions() {
    // A rectangular pulse leaves the ground with a constant velocity, so a delayed foot stays behind by velocity times delay.
    let ground = pulse(Pulse::Rectangular, 0.3, 0.4);
    let late = ground.delayed_by(0.25).unwrap();
    let apart_m = ground
        .clone()
        .with_right_foot(late)
        .feet_apart_m(&[0.0, 0.25, 0.4, 0.65, 3.0]);
    let a = 0.3 * 9.81;
    let left_behind = -a * 0.4 * 0.25;
    let half = |time_s: f64| 0.5 * a * time_s * time_s;
    let due = [
        0.0,
        -half(0.25),
        half(0.15) - half(0.4),
        left_behind,
        left_behind,
    ];
    for (apart_m, due_m) in apart_m.iter().zip(due) {
        assert!(
            (apart_m.x - due_m).abs() < 1e-13 && apart_m.y == 0.0,
            "{apart_m} {due_m}"
        );
    }
    // A delay of zero changes nothing.
    assert_eq!(ground.delayed_by(0.0).unwrap(), ground);
    let same = ground.clone().with_right_foot(ground.clone());
    assert!(
        same.feet_apart_m(&[0.3, 7.0])
            .iter()
            .all(|apart| *apart == Vector2::zeros())
    );
    // A scale factor applies to both feet. This matters only for feet that move differently.
    let other = shaking([1.0, 0.4], [2.0, 5.0]);
    let both = ground.clone().with_right_foot(other.clone());
    let [once, twice] =
        [both.clone(), both.scaled(2.0).unwrap()].map(|ground| ground.feet_apart_m(&[0.37])[0]);
    assert!(once.norm() > 0.01 && once.y != 0.0 && (twice - once * 2.0).norm() < 1e-15);
    // A foot stays in place once its motion stops. Here the left foot moves alone from 0.2 s to 0.4 s, when both have ended.
    let stopped = ground
        .clone()
        .with_right_foot(pulse(Pulse::Rectangular, 0.3, 0.2).stopping());
    let apart_m = stopped.feet_apart_m(&[0.2, 0.4, 9.0]);
    assert!(apart_m[0].norm() < 1e-15 && apart_m[1] == apart_m[2]);
    assert!((apart_m[1].x - (half(0.2) - half(0.4))).abs() < 1e-13);
    assert_eq!(both.end_s(), 0.8);
    assert_eq!(both.ends_s(), [0.4, 0.8]);
    assert!(both.has_vertical() && !ground.has_vertical());
    assert!(ground.delayed_by(f64::NAN).is_err() && ground.delayed_by(-1.0).is_err());
}

/// A negative delay starts the right foot earlier. The left foot keeps its times; if the right foot accelerates before time zero, the motion
/// starts there.
#[test]
fn a_negative_delay_does_not_change_the_left_foot() {
    let at = |ground: &GroundMotion, time_s: f64| {
        let piece = ground.pieces.iter().rfind(|piece| piece.start_s <= time_s);
        piece.unwrap().acceleration_m_s2(time_s)
    };
    for (from_s, start_s) in [(0.0, -0.3), (0.2, -0.1), (0.3, 0.0), (1.0, 0.0)] {
        let ground = Pulse::OneSine
            .lasting_s(0.4)
            .starting_at_s(from_s)
            .horizontal_m_s2(3.0)
            .unwrap();
        let early = ground.clone().with_delayed_right_foot(-0.3).unwrap();
        let right = early.right_foot().unwrap();
        assert!((early.start_s() - start_s).abs() < 1e-15 && early.start_s() == right.start_s());
        assert_eq!(early.pieces[0].start_s, early.start_s());
        let [left_s, right_s] = early.ends_s();
        assert!(left_s == ground.end_s() && (left_s - right_s - 0.3).abs() < 1e-15);
        for time_s in [0.05, 0.11, 0.33, 0.55, 1.1, 1.3] {
            assert_eq!(at(&early, time_s), at(&ground, time_s));
            assert!((at(right, time_s) - at(&ground, time_s + 0.3)).abs() < 1e-13);
        }
        // The distance of the feet is that for the same motion with a positive delay, mirrored.
        let late = ground.clone().with_delayed_right_foot(0.3).unwrap();
        for (early, late) in early
            .feet_apart_m(&[0.05, 0.4, 2.0])
            .iter()
            .zip(late.feet_apart_m(&[0.35, 0.7, 2.3]))
        {
            assert!((early + late).norm() < 1e-13, "{early} {late}");
        }
        let scaled = early.scaled(-2.0).unwrap();
        assert_eq!(scaled.start_s(), early.start_s());
    }
    let record = shaking([3.0, 1.0], [1.5, 4.0]);
    let early = record.clone().with_delayed_right_foot(-0.25).unwrap();
    assert_eq!(
        (early.start_s(), early.ends_s()),
        (-0.25, [0.8, 0.8 - 0.25])
    );
    assert!(record.clone().with_delayed_right_foot(-2e9).is_err());
    assert!(record.with_delayed_right_foot(f64::NAN).is_err());
}

/// A history with a negative start equals the history on ground delayed by that time, with all times shifted.
#[test]
fn a_history_starts_when_the_right_foot_starts() {
    let row = Row::arch(&crate::common::ring(0.15, 157.5), 12, 5.0, 1.0, 2000.0).unwrap();
    let slipping = RowOptions {
        friction_coefficient: Some(0.8),
        ..RowOptions::default()
    };
    let rigid = FreeHinges::new(row).unwrap();
    let models: [&dyn Model; 3] = [
        &arch(),
        &rigid,
        &rigid.clone().with_options(slipping).unwrap(),
    ];
    for model in models {
        let history = |from_s: f64, end_s: f64| {
            let ground = Pulse::OneSine
                .lasting_s(0.4)
                .starting_at_s(from_s)
                .horizontal_m_s2(3.0)
                .unwrap();
            let ground = ground.with_delayed_right_foot(-0.05).unwrap();
            model.history(&ground, &sampled(end_s, 0.02)).unwrap()
        };
        let (early, later) = (history(0.0, 0.45), history(0.05, 0.5));
        let times_s = &early.samples.time_s;
        assert_eq!(times_s[..4], [-0.05, -0.04, -0.02, 0.0]);
        assert!((early.summary.end_s - 0.45).abs() < 1e-12);
        assert!(times_s.windows(2).all(|pair| pair[0] < pair[1]));
        let [first, at_zero] = [0, 3].map(|row| early.samples.get(row).unwrap());
        assert!(first.rotations_rad != at_zero.rotations_rad);
        // The rows show other instants of the motion, so peaks and half cycles are compared.
        let [one, other] = [&early.summary, &later.summary];
        let [peak, due] = [one, other].map(|summary| summary.largest_rotation_rad());
        assert!(
            due > 1e-3 && (peak - due).abs() < 0.02 * due,
            "{peak} {due}"
        );
        let [one, other] = [one, other].map(|summary| summary.half_cycles()[0]);
        assert!((one.start_s + 0.05 - other.start_s).abs() < 2e-3);
    }
}

/// Free hinges halve their steps if the energy balance requires it, unless the scenario gives the step.
#[test]
fn steps_are_halved_for_a_small_wave() {
    let arch = "[arch]\nmean_radius_m = 10.0\nthickness_ratio = 0.156\nembrace_deg = 157.5\nvoussoirs = 6\n\
                [[tie]]\nheight_m = 8.4\nstiffness_n_m = 8500.0\n\
                [ground.ricker]\namplitude_g = 0.1\nduration_s = 0.08\n[ground.right]\ndelay_s = -0.12\n\
                [simulation]\nduration_s = 0.3\noutput_step_s = 0.02\n";
    let history = |joints: &str| {
        let scenario = parsed(&format!("{arch}[free_hinges]\n{joints}"));
        let model = scenario.model().unwrap();
        model.simulate(scenario.ground_motion(), &scenario.request(), None)
    };
    let halved = history("").unwrap();
    let row = halved.row().unwrap();
    assert!(row.halvings > 0 && row.energy_error < 1e-2);
    let fine = history("longest_step_s = 5e-5\n").unwrap();
    assert_eq!(fine.row().unwrap().halvings, 0);
    let (peak, due) = (halved.largest_rotation_rad(), fine.largest_rotation_rad());
    assert!((peak - due).abs() < 0.05 * due, "{peak} {due}");
    let refused = history("longest_step_s = 3.4e-4\n")
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("set `longest_step_s` in [free_hinges] to at most"),
        "{refused}"
    );
    assert!(!refused.contains("masonry"), "{refused}");
}

/// Two feet with equal motions are equivalent to one ground: bit-identical if the motions are written alike, and up to rounding
/// if one is cut into other pieces.
#[test]
fn feet_with_equal_motions_equal_one_ground() {
    let model = arch();
    let ground = shaking([6.0, 2.0], [1.5, 4.0]);
    let (whole, alone) = run_sampled(&model, &ground, &sampled(1.5, 0.01));
    assert!(whole.summary.largest_rotation_rad() > 1e-3);
    for (right, tolerance) in [
        (ground.clone(), 0.0),
        (ground.cut_at(&[0.1234, 0.333, 0.7]), 1e-9),
    ] {
        let both = ground.clone().with_right_foot(right);
        let (_, samples) = run_sampled(&model, &both, &sampled(1.5, 0.01));
        let first_half_cycle_s =
            whole.summary.half_cycles()[0].start_s + whole.summary.half_cycles()[0].duration_s;
        for (sample, alone) in samples.iter().zip(&alone) {
            if tolerance > 0.0 && sample.time_s > first_half_cycle_s {
                break;
            }
            for (one, other) in sample.rotations_rad.iter().zip(&alone.rotations_rad) {
                assert!(
                    (one - other).abs() <= tolerance,
                    "{} {one} {other}",
                    sample.time_s
                );
            }
        }
    }
}

/// The mirror image of an arch with exchanged feet moves as its mirror image. Positions count from the left foot, so the ground
/// motions of the two computations differ; results agree up to the square of the step.
#[test]
fn mirrored_feet_move_a_mirrored_arch() {
    let model = arch();
    let (one, other) = (([4.0, 2.0], [1.5, 4.0]), ([2.5, -1.0], [2.5, 3.0]));
    let shaken =
        |(strong, hz): ([f64; 2], [f64; 2]), side: f64| shaking([side * strong[0], strong[1]], hz);
    let request = sampled(0.6, 0.01);
    let (history, right) = run_sampled(
        &model,
        &shaken(one, 1.0).with_right_foot(shaken(other, 1.0)),
        &request,
    );
    let (_, left) = run_sampled(
        &model,
        &shaken(other, -1.0).with_right_foot(shaken(one, -1.0)),
        &request,
    );
    let largest = history.summary.largest_rotation_rad();
    assert!(largest > 1e-3, "{largest}");
    for (right, left) in right.iter().zip(&left) {
        assert!((right.feet_apart_m.x - left.feet_apart_m.x).abs() < 1e-14);
        for (right, left) in right
            .rotations_rad
            .iter()
            .zip(left.rotations_rad.iter().rev())
        {
            assert!((right + left).abs() < 1e-3 * largest, "{right} {left}");
        }
    }
}

/// If both supports move equally, the structure moves along with them and its equilibrium does not change.
#[test]
fn a_translation_of_both_supports_changes_nothing() {
    let model = arch();
    let load_m_s2 = [0.0, -9.81];
    let rest = model.structure.rest(load_m_s2).unwrap();
    let by_m = [0.4, -0.2, 0.0];
    let elsewhere = model.structure.clone().on_supports([by_m; 2]);
    let moved = elsewhere.rest(load_m_s2).unwrap();
    for (rest, moved) in rest.moved.iter().zip(&moved.moved) {
        for axis in 0..3 {
            // Forces balance to 1e-11 of the weight, which bends joints by some 1e-3 m.
            assert!(
                (moved[axis] - rest[axis] - by_m[axis]).abs() < 1e-9,
                "{moved:?} {rest:?}"
            );
        }
    }
}

/// The energy balance of an arch on feet that move differently closes with the square of the step, and both feet do work.
#[test]
fn the_work_of_both_feet_balances_the_energy() {
    let properties = ElasticProperties {
        friction_coefficient: None,
        ..ElasticProperties::of_stiffness(1e9)
    };
    let model = ElasticJoints::new(arch().row().clone(), properties).unwrap();
    let both = shaking([2.0, 1.0], [1.5, 4.0]).with_right_foot(shaking([-2.0, 1.5], [1.0, 3.0]));
    let longest_s = 0.5 * model.longest_step_s();
    let defects = [1.0, 0.5, 0.25].map(|part| {
        let model = model.clone().with_longest_step_s(part * longest_s).unwrap();
        let summary = model.simulate(&both, &sampled(1.0, 0.01), None).unwrap();
        let row = summary.row().unwrap();
        assert!(
            row.right_foot_j.abs() > 10.0 && row.ground_j.abs() > 10.0,
            "{row:?}"
        );
        summary.energy_defect_ratio
    });
    assert!(defects[0] < 1e-5, "{defects:?}");
    // A quarter of the step should reduce the error by 16; contacts that open within steps disturb this.
    let ratio = defects[0] / defects[2];
    assert!((9.0..36.0).contains(&ratio), "{defects:?}");
}

/// After a foot has moved slowly for 10 s, the arch is in its equilibrium on springings moved by the same amount.
#[test]
fn a_slow_foot_ends_in_the_equilibrium_of_moved_supports() {
    let (spread_m, settlement_m) = (0.08, 0.03);
    // One sine of acceleration over 10 s moves the foot by its amplitude times 10^2/(2 pi).
    let samples = |way_m: f64| -> Vec<(f64, f64)> {
        let strong = way_m * 2.0 * PI / 100.0;
        let at = |step: i32| {
            let part = f64::from(step) / 1000.0;
            (10.0 * part, strong * (2.0 * PI * part).sin())
        };
        (0..=1000).map(at).collect()
    };
    let ramp = GroundMotion::record(&samples(spread_m), &samples(-settlement_m), 0.0).unwrap();
    let both = GroundMotion::still().with_right_foot(ramp);
    let end_m = both.feet_apart_m(&[10.0])[0];
    // Straight lines between samples deviate from the sine by 3e-6 of its amplitude.
    assert!(
        (end_m - Vector2::new(spread_m, -settlement_m)).norm() < 1e-6,
        "{end_m}"
    );
    let model = arch();
    let (_, way) = run_sampled(&model, &both, &sampled(11.0, 0.05));
    let settled = arch().on_supports(Movements {
        left: Movement::default(),
        right: Movement {
            spread_m,
            settlement_m,
            rotation_rad: 0.0,
        },
    });
    let (_, rest) = run_sampled(
        &settled.unwrap(),
        &GroundMotion::still(),
        &sampled(0.1, 0.05),
    );
    let (end, rest) = (way.last().unwrap(), &rest[0]);
    let turned = |pose: &archrock::mechanics::Pose| pose.rotation_rad();
    let largest = rest
        .poses
        .iter()
        .map(|pose| turned(pose).abs())
        .fold(0.0, f64::max);
    assert!(largest > 5e-3, "{largest}");
    // The remaining vibration, and friction after different paths, account for a thousandth of the rotation.
    for (end, rest) in end.poses.iter().zip(&rest.poses) {
        assert!(
            (turned(end) - turned(rest)).abs() < 1e-3 * largest,
            "{} {}",
            turned(end),
            turned(rest)
        );
        assert!(
            (end.translation - rest.translation).norm() < 1e-3 * spread_m,
            "{end:?} {rest:?}"
        );
    }
}

/// Histories computed side by side are bit-identical to single histories, whether the feet of the other cases move equally or
/// not.
#[test]
fn feet_computed_side_by_side_equal_single_histories() {
    let model = arch();
    let cases: Vec<_> = (0..7)
        .map(|case| {
            let ground = shaking([2.0 + 0.5 * f64::from(case), 1.0], [1.5, 4.0]);
            let late = ground.delayed_by(0.02 * f64::from(case)).unwrap();
            let ground = if case % 3 == 0 {
                ground
            } else {
                ground.with_right_foot(late)
            };
            (ground, sampled(0.8, 0.05))
        })
        .collect();
    for ((ground, request), together) in cases.iter().zip(model.simulate_all(&cases)) {
        let alone = model.simulate(ground, request, None).unwrap();
        assert_eq!(alone, together.unwrap());
    }
}

/// A stack stands on the left foot: the motion of the right foot changes no result, nor the time at which the stack is known to
/// be safe.
#[test]
fn a_stack_has_one_foot() {
    let drum = Drum {
        height_m: 2.0,
        base_width_m: 1.0,
        top_width_m: 1.0,
    };
    let stack = |drums: usize| Row::stack(&vec![drum; drums], 1.0, 2000.0).unwrap();
    let slipping = RowOptions {
        friction_coefficient: Some(0.6),
        ..RowOptions::default()
    };
    let rigid = FreeHinges::new(stack(1)).unwrap();
    let elastic = |drums: usize| {
        ElasticJoints::new(stack(drums), ElasticProperties::of_stiffness(1e9)).unwrap()
    };
    let slips = rigid.clone().with_options(slipping).unwrap();
    let models: [&dyn Model; 4] = [&rigid, &slips, &elastic(1), &elastic(2)];
    let left = pulse(Pulse::OneSine, 0.6, 0.4);
    let both = left
        .clone()
        .with_right_foot(pulse(Pulse::HalfSine, -0.8, 0.4));
    for model in models {
        let [end_s, safe_s] = [EndCondition::End, EndCondition::Safe].map(|until| {
            let of = |ground: &GroundMotion| {
                let case = (ground.clone(), sampled(1.0, 0.01));
                model.simulate_until(until, &case).unwrap()
            };
            let alone = of(&left);
            assert!(alone.largest_rotation_rad() > 1e-3);
            assert_eq!(of(&both), alone, "{until:?}");
            alone.end_s
        });
        assert!(safe_s < end_s, "{safe_s} {end_s}");
    }
}

#[test]
fn four_links_refuse_feet_that_move_differently() {
    let ground = pulse(Pulse::OneSine, 0.3, 0.4);
    let both = ground.clone().with_right_foot(ground);
    let error = crate::common::semicircle()
        .simulate(&both, &sampled(1.0, 0.01), None)
        .unwrap_err();
    assert!(matches!(error, SimulationError::Feet), "{error}");
}

const ARCH: &str = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 12\n\
                    [elastic_joints]\nnormal_stiffness_gpa_m = 1.0\n[simulation]\nduration_s = 1.5\n";
/// Replacements of the elastic joints in [`ARCH`]; the steps are those of runs in all studies.
const RIGID: [&str; 2] = [
    "[free_hinges]\nlongest_step_s = 3e-4\n",
    "[free_hinges]\nlongest_step_s = 3e-4\nfriction_coefficient = 1.0\n",
];

/// [`ARCH`] with elastic joints, and with each of [`RIGID`].
fn arches() -> [String; 3] {
    let rigid =
        |joints: &str| ARCH.replace("[elastic_joints]\nnormal_stiffness_gpa_m = 1.0\n", joints);
    [ARCH.to_owned(), rigid(RIGID[0]), rigid(RIGID[1])]
}

const PULSE: &str = "[ground.one_sine]\namplitude_g = 0.4\nduration_s = 0.4\n";

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).unwrap();
}

/// A record in a table, in g, one sample every hundredth of a second.
fn record(seconds: f64, strong_g: f64) -> String {
    let mut text = "time_s,a\n".to_owned();
    for step in 0..=(seconds * 100.0).round() as i32 {
        let time_s = 0.01 * f64::from(step);
        let _ = writeln!(
            text,
            "{time_s:.2},{:e}",
            strong_g * (2.0 * PI * time_s / 0.4).sin()
        );
    }
    text
}

#[test]
fn scenarios_have_a_right_foot_in_three_ways() {
    let foot = |keys: &str| parsed(&format!("{ARCH}{PULSE}[ground.right]\n{keys}\n"));
    let reads_back = |scenario: &archrock::scenario::Scenario| {
        assert_eq!(parsed(&scenario.to_toml()), *scenario);
    };
    let late = foot("delay_s = 0.05");
    reads_back(&late);
    let times_s = [0.1, 0.3, 0.7];
    let own = parsed(&format!("{ARCH}{PULSE}"));
    let ground = own.ground_motion().clone();
    let due = ground
        .clone()
        .with_right_foot(ground.delayed_by(0.05).unwrap());
    assert_eq!(late.ground_motion(), &due);
    // The feet are the middles of the springings.
    let wave = foot("apparent_velocity_m_s = 200.0");
    reads_back(&wave);
    let apart_m = 2.0 * 5.0 * (0.5 * 157.5_f64).to_radians().sin();
    let by_delay = foot(&format!("delay_s = {:?}", apart_m / 200.0));
    for (one, other) in wave
        .ground_motion()
        .feet_apart_m(&times_s)
        .iter()
        .zip(by_delay.ground_motion().feet_apart_m(&times_s))
    {
        assert!((one - other).norm() < 1e-14 && one.norm() > 1e-3);
    }
    // A wave travelling to the left reaches the right foot first.
    let back = foot("apparent_velocity_m_s = -200.0");
    let [left_s, right_s] = back.ground_motion().ends_s();
    assert!((left_s - right_s - apart_m / 200.0).abs() < 1e-12);
    // Keys that vary in a study apply to feet as well.
    let varied = late.with_values(&[
        ("ground.right.delay_s", 0.1),
        ("ground.one_sine.amplitude_g", 0.2),
    ]);
    let varied = varied.unwrap();
    assert_eq!(
        varied,
        parsed(&format!(
            "{ARCH}{}[ground.right]\ndelay_s = 0.1\n",
            PULSE.replace("0.4\nd", "0.2\nd")
        ))
    );
    assert!(
        late.with_values(&[("ground.right.delay_s", 1e9)])
            .unwrap_err()
            .contains("out of range")
    );
    assert_eq!(own.with_ground(late.ground.clone()).right_foot, None);
}

#[test]
fn a_run_reports_its_feet() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "left.csv", &record(0.8, 0.3));
    write(folder.path(), "right.csv", &record(0.5, 0.2));
    let table = |file: &str| format!("file = \"{file}\"\nunit = \"g\"\n");
    for (arch, stem) in arches().iter().zip(["elastic", "free", "friction"]) {
        let text = format!(
            "{arch}[ground.record]\n{}[ground.right.record]\n{}",
            table("left.csv"),
            table("right.csv")
        );
        write(folder.path(), "s.toml", &text);
        let said = assert_reports_feet(folder.path());
        if stem == "free" {
            golden("run-two-feet", &said);
        }
    }
}

/// Asserts the printed and written output of a run about the feet; returns the printed output.
fn assert_reports_feet(folder: &Path) -> String {
    let said = printed(
        folder,
        &[
            "run",
            "s.toml",
            "--out",
            "r",
            "--no-repeat",
            "--snapshots",
            "0.2",
        ],
    );
    let rotations = Table::read(folder.join("r/rotations.csv"));
    let [apart_m, upwards_m] =
        ["right_foot_x_m", "right_foot_y_m"].map(|column| rotations.numbers(column));
    assert!(apart_m[0] == 0.0 && upwards_m.iter().all(|up_m| *up_m == 0.0));
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.join("r/summary.json")).unwrap()).unwrap();
    let farthest = apart_m
        .iter()
        .map(|apart_m| apart_m.abs())
        .fold(0.0, f64::max);
    let reported = summary["feet_farthest_apart_m"][0].as_f64().unwrap();
    // Between the rows it may be slightly larger.
    let between = reported.abs() / farthest - 1.0;
    assert!((-1e-9..1e-3).contains(&between) && farthest > 1e-3);
    let last = summary["feet_apart_at_end_m"][0].as_f64().unwrap();
    assert!((last - apart_m.last().unwrap()).abs() < 1e-12);
    // Then the ends of both records.
    shows(&said, &[reported.abs(), last.abs(), 0.5, 0.8]);
    let side = if last < 0.0 { "left" } else { "right" };
    assert!(said.contains(&format!(" m to the {side} and ")), "{said}");
    assert!(summary["right_foot_j"].as_f64().unwrap().abs() > 1.0);
    assert!(summary["peak_potential_over_barrier"].is_null());
    let picture = fs::read_to_string(folder.join("r/history.svg")).unwrap();
    let picture = Document::parse(&picture).unwrap();
    assert_eq!(named(&picture, "right foot to the right").len(), 1);
    let page = fs::read_to_string(folder.join("r/report.html")).unwrap();
    assert!(page.contains("\"right_foot_m\":\""));
    said
}

/// A half sine leaves the right foot displaced: the largest displacement has the time at which it is reached, whatever the output step.
#[test]
fn a_constant_displacement_of_the_feet_has_its_first_time() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 7\n[free_hinges]\n\
                [ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.3\n[ground.right]\ndelay_s = -0.2\n[simulation]\nduration_s = 0.8\n";
    fs::write(folder.path().join("s.toml"), text).unwrap();
    for step_s in ["0.7", "0.005"] {
        let set = format!("simulation.output_step_s={step_s}");
        let arguments = ["run", "s.toml", "--out", "o", "--no-repeat", "--set", &set];
        printed(folder.path(), &arguments);
        let file = fs::read_to_string(folder.path().join("o/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&file).unwrap();
        let time_s = summary["feet_farthest_apart_time_s"].as_f64().unwrap();
        assert!((0.2998..0.3001).contains(&time_s), "{time_s}");
        let [farthest_m, end_m] = ["feet_farthest_apart_m", "feet_apart_at_end_m"]
            .map(|key| summary[key][0].as_f64().unwrap());
        // Velocity of a half sine after its end, times the delay.
        let due_m = 0.3 * 9.81 * 2.0 * 0.3 / std::f64::consts::PI * 0.2;
        assert!(
            (farthest_m.abs() / due_m - 1.0).abs() < 1e-6,
            "{farthest_m} {due_m}"
        );
        assert!((farthest_m - end_m).abs() < 1e-8 * due_m);
    }
}

/// If the right foot starts before time zero, every file of the run starts then.
#[test]
fn files_of_a_run_start_when_the_right_foot_starts() {
    let folder = tempfile::tempdir().unwrap();
    for (arch, stem) in arches().iter().zip(["elastic", "free", "friction"]) {
        let text = format!("{arch}{PULSE}[ground.right]\ndelay_s = -0.052\n");
        write(folder.path(), "s.toml", &text);
        let run = [
            "run",
            "s.toml",
            "--no-repeat",
            "--snapshots=-0.03,-1",
            "--film",
            "50",
            "--out",
            stem,
        ];
        let said = printed(folder.path(), &run);
        shows(&said, &[-0.052]);
        assert!(said.contains("snapshots at -1 s"), "{said}");
        let results = folder.path().join(stem);
        for table in ["rotations.csv", "joints.csv"] {
            let times_s = Table::read(results.join(table)).numbers("time_s");
            assert!(times_s[0] == -0.052 && (times_s[1] + 0.05).abs() < 1e-12);
        }
        let events_s = Table::read(results.join("events.csv")).numbers("time_s");
        let begins = if stem == "elastic" { 1.0 } else { 0.0 };
        assert!((-0.052..begins).contains(&events_s[0]), "{events_s:?}");
        let picture = fs::read_to_string(results.join("history.svg")).unwrap();
        let picture = Document::parse(&picture).unwrap();
        // The curves of all panels begin at the left edge of the frame, and none lies left of it.
        let left = |name: &str| -> f64 {
            let path = named(&picture, name)[0].attribute("d").unwrap();
            path[1..].split([' ', 'L']).next().unwrap().parse().unwrap()
        };
        assert!((left("ground") - left("right foot to the right")).abs() < 0.1);
        let summary = fs::read_to_string(results.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["start_s"].as_f64(), Some(-0.052));
        let first = fs::read_to_string(results.join("film/frame-0001.svg")).unwrap();
        assert!(
            first.contains("-0.052") || first.contains("\u{2212}0.052"),
            "{first:.2000}"
        );
    }
}

/// The commands in docs/two-feet.md print the output shown there.
#[test]
fn commands_print_the_output_shown_in_docs_two_feet() {
    let folder = tempfile::tempdir().unwrap();
    symlink(scenarios(), folder.path().join("scenarios")).unwrap();
    assert_eq!(
        assert_shown_output_is_printed("docs/two-feet.md", folder.path()),
        4
    );
}

#[test]
fn studies_shake_both_feet() {
    for arch in arches() {
        let folder = tempfile::tempdir().unwrap();
        study_both_feet(&arch, folder.path());
    }
}

fn study_both_feet(arch: &str, folder: &Path) {
    let feet = format!("{arch}{PULSE}[ground.right]\ndelay_s = 0.1\n");
    write(folder, "s.toml", &feet);
    let alike = format!("{arch}{PULSE}");
    write(folder, "alike.toml", &alike);
    // A factor of two on both feet equals a pulse of twice the amplitude under both.
    let peak_rad = |file: &str| {
        let arguments = [
            "threshold",
            file,
            "--out",
            "t",
            "--from",
            "1.9",
            "--to",
            "2",
            "--stride",
            "0.3",
        ];
        printed(folder, &arguments);
        // The last factor in a direction has the steps of a run.
        Table::read(folder.join("t/threshold.csv")).numbers("peak_rotation_rad")[1]
    };
    let late = peak_rad("s.toml");
    assert_ne!(late, peak_rad("alike.toml"));
    let run = [
        "run",
        "s.toml",
        "--out",
        "r",
        "--no-repeat",
        "--no-report",
        "--set",
        "ground.one_sine.amplitude_g=0.8",
    ];
    done(folder, &run);
    let summary = fs::read_to_string(folder.join("r/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let due = summary["largest_peak_rotation_rad"].as_f64().unwrap();
    assert!((late / due - 1.0).abs() < 1e-9, "{late} {due}");
    let map =
        format!("{feet}[map]\n\"ground.right.delay_s\" = [0.0, 0.1]\namplitude_g = [0.4, 1.2]\n");
    write(folder, "map.toml", &map);
    done(folder, &["map", "map.toml", "--out", "map"]);
    let cells = Table::read(folder.join("map/map.csv"));
    assert_eq!(cells.rows.len(), 4);
    if arch == ARCH {
        for shard in ["1/2", "2/2"] {
            let map = ["map", "map.toml", "--shard", shard, "--out", "parts"];
            done(folder, &map);
        }
        let parts = ["parts/map-1-of-2.part", "parts/map-2-of-2.part"];
        done(folder, &["merge", parts[0], parts[1], "--out", "merged"]);
        let [whole, merged] = ["map", "merged"].map(|name| files(&folder.join(name)));
        assert_eq!(whole, merged);
    }
    write(folder, "a.csv", &record(0.4, 0.4));
    let suite = format!(
        "{arch}[ground.one_sine]\namplitude_g = 0.1\nduration_s = 0.2\n[ground.right]\ndelay_s = 0.1\n[suite]\nrecords = [\"a.csv\"]\nunit = \"g\"\nscales = [1.0, 3.0]\n"
    );
    write(folder, "suite.toml", &suite);
    done(folder, &["suite", "suite.toml", "--out", "suite"]);
}

#[test]
fn invalid_feet_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.csv", &record(0.4, 0.4));
    let refuses = |text: &str, more: &[&str], words: &str| {
        write(folder.path(), "s.toml", text);
        let arguments: Vec<&str> = ["run", "s.toml", "--out", "none"]
            .into_iter()
            .chain(more.iter().copied())
            .collect();
        refused(folder.path(), &arguments, &[words]);
    };
    let foot = |keys: &str| format!("{ARCH}{PULSE}[ground.right]\n{keys}\n");
    let late = foot("delay_s = 0.1");
    for hinges in ["four", "four,elastic"] {
        refuses(
            &late,
            &["--hinges", hinges],
            "s.toml:13:1: table `right` needs free hinges or elastic joints: four links assume that all hinges close at once",
        );
    }
    refuses(
        &foot("delay_s = 0.1\napparent_velocity_m_s = 100.0"),
        &[],
        "s.toml:15:25: `apparent_velocity_m_s` cannot be combined with `delay_s`",
    );
    refuses(
        &foot(""),
        &[],
        "needs exactly one of the keys delay_s, apparent_velocity_m_s, record",
    );
    refuses(
        &foot("apparent_velocity_m_s = 0.1"),
        &[],
        "s.toml:14:25: `apparent_velocity_m_s = 0.1` is slower than any wave",
    );
    refuses(&foot("delay_s = nan"), &[], "s.toml:14:11:");
    refuses(
        &foot("delay_s = 0.1\nvelocity = 3"),
        &[],
        "unknown key `velocity` in [ground.right]",
    );
    refuses(
        &foot("[ground.right.record]\nfile = \"none.csv\"\nunit = \"g\""),
        &[],
        "none.csv",
    );
    let alone = format!("{ARCH}[ground.right]\ndelay_s = 0.1\n");
    refuses(&alone, &[], "needs exactly one of the tables");
    let column =
        "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[elastic_joints]\nnormal_stiffness_gpa_m = 1.0\n";
    refuses(
        &format!("{column}{PULSE}[ground.right]\ndelay_s = 0.1\n"),
        &[],
        "needs two feet",
    );
    let record = foot("[ground.right.record]\nfile = \"a.csv\"\nunit = \"g\"");
    refuses(
        &format!("{record}[map]\namplitude_g = [0.1, 0.2]\nduration_s = [0.1, 0.2]\n"),
        &[],
        "table `map` changes the motion of the ground",
    );
    write(folder.path(), "late.toml", &late);
    refused(
        folder.path(),
        &["verify", "late.toml"],
        &["leave [ground.right] out"],
    );
    // Limit analysis needs no ground motion.
    let alike = printed(folder.path(), &["limit", "late.toml"]);
    write(folder.path(), "late.toml", &format!("{ARCH}{PULSE}"));
    assert_eq!(alike, printed(folder.path(), &["limit", "late.toml"]));
}
