//! The output of models: poses, open hinges, columns of samples, energies. Models check every argument.

use std::fmt::Debug;
use std::ops::ControlFlow;

use crate::common::pulse;
use crate::common::{
    GRAVITY, four_links, number, run, run_sampled, sampled, semicircle, seven_voussoirs,
};
use archrock::dynamics::FreeHinges;
use archrock::mechanics::four_link::HingeSites;
use archrock::mechanics::{Mechanism as _, MechanismChain, Ring};
use archrock::{
    Arch, ArgumentError, Column, Event, FourLinkError, FourLinks, GroundMotion, Hinge, History,
    ImpactModel, Initial, MechanismModel, Model, OpenHinge, Pose, Pulse, Recorder, Request,
    RockingColumn, Sample, SimulationError, State, Sway,
};
use archrock_motion::internals::hybrid::rocking::{Rocking, RockingState};
use nalgebra::Vector2;
use proptest::prelude::*;

fn column() -> RockingColumn {
    RockingColumn::new(&Column::new(4.0, 0.8).unwrap(), ImpactModel::MaxRestitution).unwrap()
}

/// The same as a row of one block.
fn block() -> FreeHinges {
    FreeHinges::of_column(&Column::new(4.0, 0.8).unwrap()).unwrap()
}

/// One pulse leads to rest after impacts to both sides; a stronger one overturns to either side, where rotations are largest.
fn grounds() -> impl Iterator<Item = GroundMotion> {
    [0.4, -0.4, 2.0, -2.0]
        .into_iter()
        .map(|amplitude_g| pulse(Pulse::OneSine, amplitude_g, 0.3))
        .chain([
            pulse(Pulse::Rectangular, 1.0, 1.0),
            pulse(Pulse::Rectangular, -1.0, 1.0),
        ])
}

/// Each hinge joins two neighbours, of the bodies and the ground on both sides: its position is a point of
/// both.
#[track_caller]
fn assert_joined(sample: &Sample, point: impl Fn(Hinge) -> Vector2<f64>) {
    let ground = [Pose::UNDEFORMED];
    let bodies: Vec<&Pose> = ground.iter().chain(&sample.poses).chain(&ground).collect();
    for (i, open) in sample.hinges.iter().enumerate() {
        for body in [bodies[i], bodies[i + 1]] {
            let error_m = (body.current_position(point(open.hinge)) - open.position_m).norm();
            assert!(
                error_m < 1e-12,
                "{open:?} at {} s: {error_m}",
                sample.time_s
            );
        }
    }
}

#[test]
fn hinges_of_arches_are_points_of_both_bodies() {
    for arch in [
        four_links(1.0, 0.15, 180.0, HingeSites::Anywhere),
        four_links(1.0, 0.15, 157.5, HingeSites::Voussoirs(7)),
        four_links(2.0, 0.2, 140.0, HingeSites::Anywhere),
    ] {
        let (ring, radius_m) = (arch.chain().profile(0), arch.length_m());
        let (mut sways, mut largest_rad) = (Vec::new(), 0.0_f64);
        for ground in grounds() {
            for sample in run(&arch, &ground, &sampled(10.0, 0.01)).samples.iter() {
                let open = if sample.state == State::Rest { 0 } else { 4 };
                assert_eq!((sample.poses.len(), sample.hinges.len()), (3, open));
                assert_joined(&sample, |hinge| match hinge {
                    Hinge::Section { angle_rad, edge } => ring.point(angle_rad, edge) * radius_m,
                    other => panic!("{other:?} of an arch"),
                });
                sways.push(sample.state);
                let rotations = sample.rotations_rad.iter();
                largest_rad = rotations.fold(largest_rad, |most, x| most.max(x.abs()));
            }
        }
        for sway in [Sway::Right, Sway::Left] {
            assert!(
                sways.contains(&State::Rocking(sway)) && sways.contains(&State::Overturned(sway))
            );
        }
        assert!(largest_rad > 0.5, "{largest_rad}");
    }
}

#[test]
fn a_column_turns_about_a_toe_that_stays() {
    let mut sways = Vec::new();
    for ground in grounds() {
        for sample in run(&column(), &ground, &sampled(10.0, 0.01)).samples.iter() {
            assert_joined(&sample, |hinge| match hinge {
                Hinge::Toe(side) => Vector2::new(0.4 * side.sign(), 0.0),
                other => panic!("{other:?} of a column"),
            });
            assert_eq!(sample.poses.len(), 1);
            let toes: Vec<_> = sample.hinges.iter().map(|open| open.hinge).collect();
            assert_eq!(toes, Vec::from_iter(sample.state.sway().map(Hinge::Toe)));
            sways.push(sample.state);
        }
    }
    for sway in [Sway::Right, Sway::Left] {
        assert!(sways.contains(&State::Rocking(sway)) && sways.contains(&State::Overturned(sway)));
    }
}

#[test]
fn poses_turn_by_the_rotations() {
    let check = |model: &dyn Model| {
        for ground in grounds() {
            let history = model.history(&ground, &sampled(10.0, 0.01)).unwrap();
            for sample in history.samples.iter() {
                let turned: Vec<f64> = sample.poses.iter().map(Pose::rotation_rad).collect();
                assert_eq!(turned, sample.rotations_rad, "{} s", sample.time_s);
            }
        }
    };
    check(&semicircle());
    check(&seven_voussoirs());
    check(&column());
}

/// All numbers of the poses and of the hinges of a history, sample by sample, mirrored or not.
fn places(history: &History, in_a_mirror: bool) -> Vec<Vec<u64>> {
    let place = |mut sample: Sample| {
        if in_a_mirror {
            sample.poses = sample.poses.iter().rev().map(Pose::mirrored).collect();
            sample.hinges.reverse();
        }
        let sign = if in_a_mirror { -1.0 } else { 1.0 };
        let pose = |pose: &Pose| [pose.rotation_rad(), pose.translation.x, pose.translation.y];
        let hinge = |open: &OpenHinge| [sign * open.position_m.x, open.position_m.y, 0.0];
        let poses = sample.poses.iter().flat_map(pose);
        let hinges = sample.hinges.iter().flat_map(hinge);
        poses.chain(hinges).map(f64::to_bits).collect()
    };
    history.samples.iter().map(place).collect()
}

#[test]
fn mirrored_ground_mirrors_bodies_and_hinges_to_the_last_bit() {
    let check = |model: &dyn Model| {
        for kind in Pulse::ALL.iter().copied() {
            for amplitude_g in [0.4, 2.0] {
                let history = |amplitude_g| {
                    let ground = pulse(kind, amplitude_g, 0.3);
                    model.history(&ground, &sampled(6.0, 0.01)).unwrap()
                };
                let (right, left) = (history(-amplitude_g), history(amplitude_g));
                assert!(places(&right, false) == places(&left, true), "{kind:?}");
            }
        }
    };
    check(&semicircle());
    check(&column());
}

/// Keeps everything that it receives.
#[derive(Default)]
struct Received {
    samples: Vec<Sample>,
    events: Vec<Event>,
    most_samples: Option<usize>,
}

impl Recorder for Received {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.samples.push(sample.clone());
        match self.most_samples {
            Some(most) if self.samples.len() >= most => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }

    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        self.events.push(event.clone());
        ControlFlow::Continue(())
    }
}

fn assert_owned<T: Debug + Clone + Send + Sync + 'static>(_: &T) {}

#[test]
fn a_recorder_receives_the_data_of_the_history() {
    let check = |model: &dyn Model| {
        for ground in grounds() {
            let request = sampled(10.0, 0.01);
            let history = model.history(&ground, &request).unwrap();
            assert_owned(&history);
            assert_eq!(history.bodies, model.bodies());
            let mut received = Received::default();
            let summary = model
                .simulate(&ground, &request, Some(&mut received))
                .unwrap();
            assert_eq!(summary, history.summary);
            assert_eq!(received.events, history.events);
            assert!(history.samples.iter().eq(received.samples.iter().cloned()));

            let (columns, bodies) = (&history.samples, model.bodies().len());
            assert_eq!(columns.len(), received.samples.len());
            assert!(columns.get(columns.len()).is_none() && !columns.is_empty());
            for (i, sample) in received.samples.iter().enumerate() {
                let by_body = i * bodies..(i + 1) * bodies;
                assert_eq!(columns.rotations_rad[by_body.clone()], sample.rotations_rad);
                assert_eq!(columns.rates_rad_s[by_body.clone()], sample.rates_rad_s);
                let flat =
                    |pose: &Pose| [pose.rotation_rad(), pose.translation.x, pose.translation.y];
                let poses: Vec<_> = sample.poses.iter().map(flat).collect();
                assert_eq!(columns.poses[by_body], poses);
                let hinges = &columns.hinges[columns.first_hinge[i]..];
                assert!(hinges.starts_with(&sample.hinges));
                assert_eq!(
                    (columns.time_s[i], columns.phase[i]),
                    (sample.time_s, sample.phase)
                );
                assert_eq!(
                    (columns.state[i], columns.demand[i]),
                    (sample.state, sample.demand)
                );
                assert_eq!(columns.energy_ratio[i], sample.energy_ratio);
                assert_eq!(columns.energy_j[i], sample.energy_j);
            }
            let hinges: usize = received
                .samples
                .iter()
                .map(|sample| sample.hinges.len())
                .sum();
            assert_eq!(columns.hinges.len(), hinges);

            // Without a recorder: the same, except for the demand of samples.
            let alone = model.simulate(&ground, &request, None).unwrap();
            assert_eq!(alone.thrust, None);
            let thrust = summary.thrust;
            assert_eq!(archrock::Summary { thrust, ..alone }, summary);
            // A break ends the history.
            received = Received {
                most_samples: Some(3),
                ..Received::default()
            };
            let broken = model
                .simulate(&ground, &request, Some(&mut received))
                .unwrap();
            assert!(received.samples.len() == 3 && broken.end_s < 0.1);
            assert!(history.samples.iter().take(3).eq(received.samples));
        }
    };
    check(&semicircle());
    check(&column());
}

/// At rest at the unstable equilibrium, every link has exactly the energy of its own barrier; samples are relative to
/// the barrier of the link that moves.
fn energies_are_over_the_barrier_of_the_link_that_moves<C: MechanismChain + MechanismModel>(
    chain: &C,
) {
    let still = GroundMotion::still();
    let rocking = Rocking::new(chain, &still, GRAVITY, 1e-8);
    for link in (0..12).map_while(|index| chain.link(index)) {
        let at_the_top = RockingState::new(link.critical_rad, 0.0, 0.0);
        let ratio = rocking.energy(link, &at_the_top) / rocking.barrier_of(link);
        assert!((ratio - 1.0).abs() < 1e-15, "{ratio}");
    }
    for sway in [Sway::Right, Sway::Left] {
        let critical_rad = chain.link(0).unwrap().critical_rad;
        let request = Request {
            initial: Some(Initial {
                sway,
                rotation_rad: critical_rad,
                rate_rad_s: 0.0,
            }),
            ..sampled(0.01, 0.01)
        };
        let start = run(chain, &still, &request).samples.get(0).unwrap();
        assert!((start.energy_ratio.unwrap() - 1.0).abs() < 1e-15);
        assert!((start.rotation_over_critical.unwrap() + sway.sign()).abs() < 1e-15);
    }
    let mut later = 0;
    for ground in grounds() {
        let (history, samples) = run_sampled(chain, &ground, &sampled(10.0, 0.01));
        for sample in samples {
            let event = sample
                .phase
                .checked_sub(1)
                .map(|last| &history.events[last]);
            let Some(index) = event.and_then(|event| event.mechanism) else {
                assert_eq!(sample.energy_ratio, Some(0.0));
                assert_eq!(
                    (sample.energy_j, sample.rotation_over_critical),
                    (0.0, Some(0.0))
                );
                continue;
            };
            let link = chain.link(index).unwrap();
            // The coordinate is the rotation of the body on the side from which it sways.
            let carrier = match sample.state.sway().unwrap() {
                Sway::Right => 0,
                Sway::Left => sample.rotations_rad.len() - 1,
            };
            let q_rad = sample.rotations_rad[carrier].abs();
            let rate_rad_s = sample.rates_rad_s[carrier];
            let inertia = link.mechanism.coefficients(q_rad).inertia;
            let kinetic = 0.5 * inertia * rate_rad_s.powi(2) * chain.length_m() / GRAVITY;
            let expected = (kinetic + link.mechanism.displacement(q_rad).y) / link.barrier;
            let error = sample.energy_ratio.unwrap() - expected;
            assert!(error.abs() < 1e-12 * (1.0 + expected.abs()), "{error}");
            let over_critical = q_rad / link.critical_rad;
            assert!((sample.rotation_over_critical.unwrap().abs() - over_critical).abs() < 1e-12);
            later += usize::from(index > 0);
        }
    }
    assert!(later > 50, "{later}");
}

#[test]
fn energies_of_arches_are_over_the_barrier_of_the_link_that_moves() {
    energies_are_over_the_barrier_of_the_link_that_moves(&semicircle());
    energies_are_over_the_barrier_of_the_link_that_moves(&seven_voussoirs());
}

#[test]
fn energies_of_columns_are_over_the_barrier_of_the_link_that_moves() {
    energies_are_over_the_barrier_of_the_link_that_moves(&column());
}

fn any_model() -> impl Strategy<Value = ImpactModel> {
    prop_oneof![
        Just(ImpactModel::MaxRestitution),
        Just(ImpactModel::SameSections),
        Just(ImpactModel::Mirrored),
        number(0.0..1.0).prop_map(|restitution| ImpactModel::Prescribed { restitution }),
    ]
}

/// Checks that the error is about one of these arguments, and gives its name and its value.
fn check_named(error: &ArgumentError, arguments: &[(&str, f64)]) -> Result<(), TestCaseError> {
    let is_it = |(name, value): &(&str, f64)| {
        *name == error.argument && (*value == error.value || value.is_nan() && error.value.is_nan())
    };
    prop_assert!(arguments.iter().any(is_it), "{error:?} of {arguments:?}");
    let message = error.to_string();
    let start = format!(
        "`{} = {:?}` is not allowed: it must be ",
        error.argument, error.value
    );
    prop_assert!(
        message.starts_with(&start) && message.len() > start.len(),
        "{message}"
    );
    Ok(())
}

fn restitution(model: ImpactModel) -> f64 {
    match model {
        ImpactModel::Prescribed { restitution } => restitution,
        _ => 0.5,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]

    #[test]
    fn arches_from_random_numbers_are_valid_or_errors(
        sizes in (number(0.1..50.0), number(0.05..0.5), number(60.0..180.0)),
        others in (number(0.1..10.0), number(500.0..3000.0)),
        again in (number(0.1..50.0), number(0.05..0.5), number(60.0..180.0)),
        voussoirs in prop_oneof![3 => Just(None), 2 => (0_usize..230).prop_map(Some), 1 => any::<usize>().prop_map(Some)],
        model in any_model(),
    ) {
        let cut = |arch: Arch| match voussoirs {
            Some(voussoirs) => arch.with_voussoirs(voussoirs),
            None => Ok(arch),
        };
        let arch = Arch::new(sizes.0, sizes.1, sizes.2)
            .and_then(|arch| arch.with_depth_m(others.0))
            .and_then(|arch| arch.with_density_kg_m3(others.1))
            .and_then(|arch| arch.with_mean_radius_m(again.0))
            .and_then(|arch| arch.with_thickness_ratio(again.1))
            .and_then(|arch| arch.with_embrace_deg(again.2))
            .and_then(cut);
        let arch = match arch {
            Ok(arch) => arch,
            Err(error) => {
                let arguments = [
                    ("mean_radius_m", sizes.0), ("thickness_ratio", sizes.1), ("embrace_deg", sizes.2),
                    ("depth_m", others.0), ("density_kg_m3", others.1),
                    ("mean_radius_m", again.0), ("thickness_ratio", again.1), ("embrace_deg", again.2),
                    ("voussoirs", voussoirs.map_or(0.0, |voussoirs| voussoirs as f64)),
                ];
                return check_named(&error, &arguments);
            }
        };
        prop_assert_eq!(arch.voussoirs, voussoirs);
        prop_assert_eq!((arch.mean_radius_m, arch.depth_m, arch.density_kg_m3), (again.0, others.0, others.1));
        match FourLinks::of_arch(&arch, model) {
            Ok(model) => {
                prop_assert!(model.incipient_g().is_finite() && model.incipient_g() > 0.0);
                prop_assert!(model.joules_per_unit().is_finite() && model.joules_per_unit() > 0.0);
                let unit_n_s_per_m = model.with_size_of(&arch).impulse_unit_n_s_per_m();
                prop_assert_eq!(unit_n_s_per_m, model.impulse_unit_n_s_per_m());
            }
            Err(FourLinkError::Argument(error)) => check_named(&error, &[("restitution", restitution(model))])?,
            Err(FourLinkError::Limit(error)) => prop_assert!(error.to_string().contains("the arch")),
            Err(error) => prop_assert!(false, "a ring is no row: {}", error),
        }
    }

    #[test]
    fn rings_from_random_numbers_are_valid_or_errors(t in number(0.0..2.0), embrace_rad in number(0.0..3.2)) {
        match Ring::new(t, embrace_rad) {
            Ok(ring) => {
                let mass = ring.moments_to(ring.embrace_rad).mass;
                prop_assert!(mass.is_finite() && mass >= 0.0);
            }
            Err(error) => check_named(&error, &[("thickness_ratio", t), ("embrace_rad", embrace_rad)])?,
        }
    }

    #[test]
    fn columns_from_random_numbers_are_valid_or_errors(
        (height_m, width_m) in (number(1e-9..1e12), number(1e-9..1e12)),
        (depth_m, density_kg_m3) in (number(1e-9..1e12), number(1e-9..1e12)),
        model in any_model(),
    ) {
        let column = Column::new(height_m, width_m)
            .and_then(|column| column.with_depth_m(depth_m))
            .and_then(|column| column.with_density_kg_m3(density_kg_m3))
            .map_err(FourLinkError::from)
            .and_then(|column| RockingColumn::new(&column, model));
        match column {
            Ok(column) => {
                prop_assert!(column.incipient_g() > 0.0 && column.incipient_g().is_finite());
                prop_assert!(column.joules_per_unit() > 0.0 && column.joules_per_unit().is_finite());
                let barrier = column.link(0).unwrap().barrier;
                prop_assert!(barrier > 0.0 && barrier.is_finite());
            }
            Err(FourLinkError::Argument(error)) => check_named(&error, &[
                ("height_m", height_m), ("width_m", width_m), ("depth_m", depth_m),
                ("density_kg_m3", density_kg_m3), ("restitution", restitution(model)),
            ])?,
            Err(error) => prop_assert!(false, "{}", error),
        }
    }

    #[test]
    fn requests_with_random_numbers_succeed_or_are_errors(
        (gravity_m_s2, end_s) in (number(1.0..30.0), number(0.1..20.0)),
        output_step_s in number(0.001..1.0),
        rotation_rad in proptest::option::of(number(0.0..0.3)),
        (relative_tolerance, rest_energy_ratio) in (number(1e-12..1e-4), number(1e-12..1e-2)),
        sway in proptest::sample::select(vec![Sway::Right, Sway::Left]),
    ) {
        let request = Request {
            gravity_m_s2,
            end_s,
            outcome_by_s: None,
            output_step_s,
            initial: rotation_rad.map(|rotation_rad| Initial { sway, rotation_rad, rate_rad_s: 0.0 }),
            relative_tolerance,
            rest_energy_ratio,
        };
        let ground = pulse(Pulse::OneSine, 0.4, 0.3);
        let models: [&dyn Model; 3] = [&*ARCH, &column(), &block()];
        for model in models {
            // A number of samples that is quick to test.
            let mut received = Received { most_samples: Some(1000), ..Received::default() };
            match model.simulate(&ground, &request, Some(&mut received)) {
                Ok(summary) => {
                    prop_assert!(summary.end_s <= end_s && summary.energy_defect_ratio.is_finite());
                    let energies = received.samples.iter().map(|sample| sample.energy_j);
                    let rotations = received.samples.iter().flat_map(|sample| &sample.rotations_rad);
                    prop_assert!(energies.chain(rotations.copied()).all(f64::is_finite));
                }
                Err(SimulationError::Argument(error)) => check_named(&error, &[
                    ("gravity_m_s2", gravity_m_s2), ("end_s", end_s), ("output_step_s", output_step_s),
                    ("rotation_rad", rotation_rad.unwrap_or(1.0)),
                    ("relative_tolerance", relative_tolerance), ("rest_energy_ratio", rest_energy_ratio),
                ])?,
                Err(error) => return Err(TestCaseError::fail(error.to_string())),
            }
        }
    }
}

/// In so short a time the errors of a step are below the resolution of numbers, and no tolerance can be met.
#[test]
fn a_history_of_less_than_a_microsecond_is_refused() {
    let ground = pulse(Pulse::OneSine, 0.4, 0.3);
    for end_s in [5e-324, 9.9e-7] {
        let error = column()
            .simulate(&ground, &sampled(end_s, 0.001), None)
            .unwrap_err();
        assert!(matches!(error, SimulationError::Argument(error) if error.argument == "end_s"));
    }
    assert!(
        column()
            .simulate(&ground, &sampled(1e-6, 0.001), None)
            .is_ok()
    );
}

#[test]
fn more_samples_than_a_history_may_have_are_refused() {
    let ground = pulse(Pulse::OneSine, 0.4, 0.3);
    let models: [&dyn Model; 2] = [&column(), &block()];
    for output_step_s in [5e-324, 1e-7, 1e-6] {
        let request = sampled(11.0, output_step_s);
        let start = format!("`output_step_s = {output_step_s:?}` is not allowed");
        for model in models {
            let error = model.history(&ground, &request).unwrap_err();
            assert!(error.to_string().starts_with(&start), "{error}");
            // Without samples as well: rows end their steps at output times anyway.
            let error = model.simulate(&ground, &request, None).unwrap_err();
            assert!(error.to_string().starts_with(&start), "{error}");
        }
    }
}

/// Its chain is computed once.
static ARCH: std::sync::LazyLock<FourLinks> = std::sync::LazyLock::new(semicircle);
