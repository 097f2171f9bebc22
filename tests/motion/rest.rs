//! The rest criterion changes nothing that is reported.

use crate::common::program::{scenario_files, scenarios};
use std::ops::ControlFlow;

use archrock::{
    Arch, FourLinks, ImpactModel, Model as _, Outcome, Pulse, Request, Sample, Scenario, Sway,
};

/// A structure that rests instead of hopping on loses a hundred-millionth of the barrier: its hops
/// would be 1e-8 of the critical rotation high. A later push finds it at `q = 0` instead, which shifts
/// the later motion by about that much. So peaks may change by 1e-6 of themselves, and mostly do not at all.
#[test]
fn halving_the_rest_energy_changes_no_scenario() {
    let mut scenarios = 0;
    for path in scenario_files() {
        scenarios += 1;
        let scenario = Scenario::read(&path).unwrap();
        // Models other than four links have a rest criterion of their own, and only they follow feet that move differently.
        let model = match scenario.mechanisms() {
            Ok(model) if scenario.right_foot.is_none() => model,
            _ => {
                assert!(scenario.motion.kind.has_joints);
                continue;
            }
        };
        let run = |part: f64| {
            let mut request = scenario.request();
            request.rest_energy_ratio *= part;
            let summary = model.simulate(scenario.ground_motion(), &request, None);
            let summary = summary.unwrap();
            (summary.outcome, summary.peak_rotations_rad)
        };
        let (outcome, peaks) = run(1.0);
        let (same_outcome, same_peaks) = run(0.5);
        assert_eq!(outcome, same_outcome, "{}", path.display());
        assert!(!peaks.is_empty() && peaks.len() == same_peaks.len());
        for (peak, same) in peaks.into_iter().zip(same_peaks) {
            let change = (peak - same).abs();
            assert!(change <= 1e-6 * peak, "{}: {change}", path.display());
        }
    }
    assert!(scenarios >= 2);
}

/// For an arch near instability, rounding makes the onset and the onset in the equation of motion differ. This difference was
/// once larger than the margin by which a push must exceed the onset: the arch lifted off and closed again at one instant,
/// endlessly.
#[test]
fn an_arch_that_barely_stands_does_not_lock() {
    let arch = Arch::new(1.619_540_616_883_977_4, 0.107_511_050_298_186_1, 180.0)
        .and_then(|arch| arch.with_voussoirs(200))
        .unwrap();
    let incipient_g = arch.incipient().unwrap().acceleration_g;
    assert!(incipient_g < 2e-4);
    let model = FourLinks::of_arch(&arch, ImpactModel::MaxRestitution).unwrap();
    let amplitude_m_s2 = 0.005_814_512_113_921_563 * 9.81;
    let ground = Pulse::AntisymmetricRicker
        .lasting_s(2_407.242_639_468_504)
        .horizontal_m_s2(amplitude_m_s2);
    let request = Request {
        end_s: 14_443.455_836_811_023,
        ..Request::default()
    };
    let summary = model.simulate(&ground.unwrap(), &request, None).unwrap();
    // The ground acceleration rises slowly, but to 33 times the onset; nothing brings the arch back.
    assert_eq!(summary.outcome, Outcome::Overturned(Sway::Right));
    assert_eq!(summary.impacts, 0);
}

/// The critical rotation is that of the mechanism that moved, not that of the first: a run may exceed the
/// latter and still come to rest.
#[test]
fn the_largest_rotation_is_measured_against_the_mechanism_that_moved() {
    let scenario = scenarios().join("semicircle-record.toml");
    let scenario = Scenario::read(&scenario).unwrap();
    let model = scenario.mechanisms().unwrap();
    let first_rad = model.critical_rotations_rad(Sway::Right)[0].abs();
    let summary = model
        .simulate(scenario.ground_motion(), &scenario.request(), None)
        .unwrap();
    assert_eq!(summary.outcome, Outcome::Rest);
    assert!(summary.largest_rotation_rad() > first_rad);
    // Samples measure it too, each relative to the mechanism that moves at the time.
    let over_critical = summary.peak_over_critical().unwrap();
    let mut largest = 0.0_f64;
    let history = model.simulate(
        scenario.ground_motion(),
        &scenario.request(),
        Some(&mut |sample: &Sample| {
            let ratio = sample.rotation_over_critical.unwrap_or(0.0);
            largest = largest.max(ratio.abs());
            ControlFlow::Continue(())
        }),
    );
    assert_eq!(history.unwrap().peak_over_critical(), Some(over_critical));
    // Samples miss the peak by the rotation within half an output step.
    assert!(
        largest <= over_critical && largest > 0.999 * over_critical,
        "{largest} {over_critical}"
    );
    assert!(over_critical < 1.0, "{over_critical}");
}

/// From the time of rest to the end, the rotations of elastic rows stay within a hundredth of the largest one; rows that move more still vibrate.
/// A row that slipped stays deformed.
#[test]
fn an_elastic_row_at_rest_hardly_moves() {
    let column = "[column]\nheight_m = 4.6\nwidth_m = 1.25\n[elastic_joints]\nnormal_stiffness_gpa_m = 10\ndamping_time_s = ";
    let gabor = "\n[ground.gabor]\namplitude_g = -0.39\nduration_s = 0.63\n";
    let arch = "[arch]\nmean_radius_m = 5.4\nthickness_ratio = 0.15\nembrace_deg = 110\nvoussoirs = 12\n[elastic_joints]\n\
                normal_stiffness_gpa_m = 30\nfriction_coefficient = 0.66\ncontact_points = 3\ndamping_time_s = 1e-4\n\
                [ground.one_cosine]\namplitude_g = 0.3\nduration_s = 0.9\n";
    let slips = "[arch]\nmean_radius_m = 3.1\nthickness_ratio = 0.19\nembrace_deg = 143\nvoussoirs = 8\n[elastic_joints]\n\
                 normal_stiffness_gpa_m = 10\nfriction_coefficient = 0.47\ndamping_time_s = 1e-3\n\
                 [ground.windowed_sine]\namplitude_g = -1.6\nduration_s = 0.47\n";
    // A rate of 1e-16 is no motion.
    let pointed = "[pointed_arch]\nspan_m = 2.94\nrise_m = 2.48\nthickness_m = 0.36\nvoussoirs = 10\n\
                   [piers]\nheight_m = 1.05\nwidth_m = 0.98\nblocks = 2\n[elastic_joints]\n\
                   normal_stiffness_gpa_m = 100.0\nfriction_coefficient = 0.84\ndamping_time_s = 0.0003\n\
                   [ground.gabor]\namplitude_g = -0.34\nduration_s = 0.15\nphase_deg = 120.0\n[simulation]\nduration_s = 4.0\n";
    let mut outcomes = Vec::new();
    for text in [
        &format!("{column}1e-4{gabor}"),
        &format!("{column}1e-3{gabor}[simulation]\nduration_s = 12.0\n"),
        arch,
        slips,
        pointed,
    ] {
        let scenario = Scenario::parse(text, "s.toml").unwrap();
        let model = scenario.model().unwrap();
        let mut rotations: Vec<(f64, Vec<f64>)> = Vec::new();
        let mut record = |sample: &Sample| {
            rotations.push((sample.time_s, sample.rotations_rad.clone()));
            ControlFlow::Continue(())
        };
        let ground = scenario.ground_motion();
        let summary = model.simulate(ground, &scenario.request(), Some(&mut record));
        let summary = summary.unwrap();
        let elastic = summary.elastic_summary().unwrap();
        outcomes.push(summary.outcome);
        if summary.outcome == Outcome::Rest {
            let (_, last) = rotations.last().unwrap();
            let apart = |all: &[f64]| {
                let apart = all.iter().zip(last).map(|(one, end)| (one - end).abs());
                apart.fold(0.0, f64::max)
            };
            let after = rotations
                .iter()
                .filter(|(time_s, _)| *time_s >= summary.outcome_time_s);
            let most = after.map(|(_, all)| apart(all)).fold(0.0, f64::max);
            assert!(
                most < 0.01 * summary.largest_rotation_rad(),
                "{text}: {most}"
            );
            assert!(summary.end_s >= ground.end_s());
        }
        // The vibration alone counts neither as rest nor as rocking.
        assert!(elastic.vibrates_since_s.unwrap() <= summary.outcome_time_s);
    }
    let rest = Outcome::Rest;
    assert_eq!(outcomes, [Outcome::StillRocking, rest, rest, rest, rest]);
}
