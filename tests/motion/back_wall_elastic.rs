//! A column with elastic joints and a wall behind it, compared with hand statics, the column without a wall, and energy integrals.

use archrock::dynamics::Details;
use archrock::mechanics::PlacedLoad;
use archrock::{
    BackWall, Column, ElasticJoints, ElasticProperties, GroundMotion, History, ImpactModel,
    Initial, Model as _, Outcome, Pulse, Request, RockingColumn, Sample, Scenario, Sway,
};
use nalgebra::{Matrix3, Vector2, Vector3};

use crate::common::{GRAVITY, pulse, sampled};

const HEIGHT_M: f64 = 4.0;
const WIDTH_M: f64 = 1.0;

fn wall(side: Sway, height_m: f64) -> BackWall {
    BackWall {
        side,
        height_m: Some(height_m),
        rate_ratio: None,
    }
}

fn column(drums: usize, back: Option<BackWall>) -> Column {
    let column = Column::new(HEIGHT_M, WIDTH_M)
        .unwrap()
        .with_drums(drums)
        .unwrap();
    match back {
        Some(back) => column.with_back(back).unwrap(),
        None => column,
    }
}

fn model(drums: usize, back: Option<BackWall>, stiffness_pa_m: f64) -> ElasticJoints {
    let properties = ElasticProperties::of_stiffness(stiffness_pa_m);
    ElasticJoints::of_column(GRAVITY, &column(drums, back), properties).unwrap()
}

fn started(end_s: f64, sway: Sway, rate_rad_s: f64) -> Request {
    Request {
        initial: Some(Initial {
            sway,
            rotation_rad: 0.0,
            rate_rad_s,
        }),
        ..sampled(end_s, 0.01)
    }
}

fn history(model: &ElasticJoints, request: &Request) -> History {
    model.history(&GroundMotion::still(), request).unwrap()
}

fn error_of(history: &History) -> f64 {
    let Details::Elastic(row, _) = &history.summary.details else {
        unreachable!()
    };
    row.energy_error
}

/// A push towards the wall, and a thrust above the centre, from the stiffness of base and wall: both are pressed over their full length, so the
/// three equations of equilibrium of the block are linear.
#[test]
fn the_wall_carries_a_push_as_by_hand_statics() {
    let (stiffness_pa_m, push_m_s2) = (1e9, 2.0);
    let thrust_above_m = 0.15;
    for (side, sign, thrust_n) in [
        (Sway::Left, -1.0, 0.0),
        (Sway::Right, 1.0, 0.0),
        (Sway::Left, -1.0, 5e3),
        (Sway::Right, 1.0, 5e3),
    ] {
        let thrust = PlacedLoad {
            thrust_n: sign * thrust_n,
            height_m: Some(0.5 * HEIGHT_M + thrust_above_m),
            ..PlacedLoad::mass(0.0, 0.0)
        };
        let column = column(1, Some(wall(side, HEIGHT_M)));
        let column = column.with_loads(vec![thrust], GRAVITY).unwrap();
        let properties = ElasticProperties::of_stiffness(stiffness_pa_m);
        let model = ElasticJoints::of_column(GRAVITY, &column, properties).unwrap();
        let rest = model.structure.rest([sign * push_m_s2, -GRAVITY]).unwrap();
        let [base, shear, face] =
            [WIDTH_M, 0.4 * WIDTH_M, HEIGHT_M].map(|length_m| stiffness_pa_m * length_m);
        let turning = (base * WIDTH_M.powi(2) + face * HEIGHT_M.powi(2)) / 12.0;
        let half_m = 0.5 * HEIGHT_M;
        // Unknowns: displacements of the centre and rotation. The base moves sideways by `x + half theta`, the middle of the face by `x`.
        let stiffness = Matrix3::new(
            shear + face,
            0.0,
            shear * half_m,
            0.0,
            base,
            0.0,
            shear * half_m,
            0.0,
            shear * half_m * half_m + turning,
        );
        let mass_kg = 2000.0 * WIDTH_M * HEIGHT_M;
        let load_n = Vector3::new(sign * push_m_s2, -GRAVITY, 0.0) * mass_kg
            + Vector3::new(1.0, 0.0, -thrust_above_m) * sign * thrust_n;
        let moved = stiffness.lu().solve(&load_n).unwrap();
        for axis in 0..3 {
            let miss = (rest.moved[0][axis] - moved[axis]).abs();
            assert!(miss < 1e-4 * moved.norm(), "{:?} {moved}", rest.moved[0]);
        }
        let [low, high] = rest.memories[1].penetrations_m.map(|end| end.0[0]);
        let reaction_n = 0.5 * face * (low + high);
        assert!((reaction_n / (face * moved.x.abs()) - 1.0).abs() < 1e-4);
        assert!(low.min(high) > 0.0);
        assert!((0.8..1.0).contains(&(reaction_n / (mass_kg * push_m_s2 + thrust_n))));
    }
}

/// The contact never pulls: below the onset the column bends away from the wall as if there were none.
#[test]
fn the_wall_does_not_hold_the_column_back() {
    for drums in [1, 3] {
        let [held, free] =
            [Some(wall(Sway::Left, HEIGHT_M)), None].map(|back| model(drums, back, 1e10));
        let onset_g = WIDTH_M / HEIGHT_M;
        assert!((held.incipient_acceleration_g(Sway::Right).unwrap() / onset_g - 1.0).abs() < 1e-9);
        assert_eq!(held.incipient_acceleration_g(Sway::Left), None);
        assert_eq!(held.elastic_barrier_j(GRAVITY), None);
        let away = [0.9 * onset_g * GRAVITY, -GRAVITY];
        let [held, free] = [&held, &free].map(|model| model.structure.rest(away).unwrap());
        for (held, free) in held.moved.iter().zip(&free.moved) {
            for axis in 0..3 {
                assert!((held[axis] - free[axis]).abs() < 1e-13, "{held:?} {free:?}");
            }
        }
        for contact in &held.memories[drums..] {
            assert!(contact.penetrations_m.iter().all(|end| end.0[0] <= 0.0));
        }
    }
}

/// Away from the wall the column moves as without one. It returns after twice the integral of `d theta / theta'` up to the peak, with
/// `theta'^2 = 2 p^2 (cos(alpha - peak) - cos(alpha - theta))`, and rebounds to the same side.
#[test]
fn a_column_returns_after_the_time_of_the_rigid_one() {
    let alpha = (WIDTH_M / HEIGHT_M).atan();
    let p = (1.5 * GRAVITY / HEIGHT_M.hypot(WIDTH_M)).sqrt();
    let rate_rad_s = 0.35;
    let peak = alpha - (alpha.cos() + 0.5 * (rate_rad_s / p).powi(2)).acos();
    // `theta = peak (1 - u^2)`; the difference of cosines is a product.
    let intervals = 4000;
    let h = 1.0 / f64::from(intervals);
    let part = |index: i32| {
        let u = h * (f64::from(index) + 0.5);
        let half = 0.5 * peak * u * u;
        let square = 4.0 * p * p * half.sin() * (alpha - peak + half).sin();
        2.0 * peak * u / square.sqrt() * h
    };
    let return_s = 2.0 * (0..intervals).map(part).sum::<f64>();
    let [held, free] = [Some(wall(Sway::Left, HEIGHT_M)), None].map(|back| {
        let model = model(1, back, 1e11).with_longest_step_s(5e-6).unwrap();
        let request = Request {
            output_step_s: 0.002,
            ..started(2.0 * return_s, Sway::Right, rate_rad_s)
        };
        let history = history(&model, &request);
        assert!(error_of(&history) < 3e-3);
        history.samples.iter().collect::<Vec<Sample>>()
    });
    let turned = |sample: &Sample| -sample.rotations_rad[0];
    let returned_s = held
        .iter()
        .skip(10)
        .find(|sample| turned(sample) < 1e-4)
        .unwrap()
        .time_s;
    assert!(
        (returned_s / return_s - 1.0).abs() < 0.02,
        "{returned_s} {return_s}"
    );
    let before = held
        .iter()
        .zip(&free)
        .take_while(|(held, _)| held.time_s < 0.95 * return_s);
    let mut largest = 0.0_f64;
    for (held, free) in before {
        assert!(
            (turned(held) - turned(free)).abs() < 1e-12,
            "{}",
            held.time_s
        );
        largest = largest.max(turned(held));
    }
    assert!((largest / peak - 1.0).abs() < 0.02, "{largest} {peak}");
    let after = |samples: &[Sample]| {
        let later = samples
            .iter()
            .filter(|sample| sample.time_s > 1.1 * return_s);
        later
            .map(turned)
            .fold([0.0_f64; 2], |[least, most], turned| {
                [least.min(turned), most.max(turned)]
            })
    };
    let ([least, most], [other_least, _]) = (after(&held), after(&free));
    assert!(
        least > -1e-3 && most > 1e-3 && other_least < -0.05,
        "{least} {most} {other_least}"
    );
}

/// A column with a wall on its left, and a roof that leans to the wall.
fn roofed_column() -> Column {
    let roof = PlacedLoad::mass(4000.0, -0.2);
    let column = column(1, Some(wall(Sway::Left, HEIGHT_M)));
    column.with_loads(vec![roof], GRAVITY).unwrap()
}

/// With a roof the column returns as Housner's column with this roof and this wall does, and strikes the wall with its face, not with the roof.
#[test]
fn a_column_with_a_roof_returns_as_the_rigid_one() {
    let column = roofed_column();
    let properties = ElasticProperties::of_stiffness(1e11);
    let model = ElasticJoints::of_column(GRAVITY, &column, properties).unwrap();
    assert_eq!(model.structure.joints[1].area_m2, HEIGHT_M);
    let model = model.with_longest_step_s(5e-6).unwrap();
    // Compared up to the first impact.
    let law = ImpactModel::Prescribed { restitution: 0.1 };
    let rigid = RockingColumn::new(&column, law).unwrap();
    let request = Request {
        output_step_s: 0.002,
        ..started(2.0, Sway::Right, 0.2)
    };
    let still = GroundMotion::still();
    let rigid = rigid.history(&still, &request).unwrap();
    let (return_s, _) = rigid.impacts().next().unwrap();
    let elastic = model.history(&still, &request).unwrap();
    let mut turned = elastic.samples.iter().skip(10);
    let returned = turned.find(|sample| -sample.rotations_rad[0] < 1e-4);
    let returned_s = returned.unwrap().time_s;
    assert!(
        (returned_s / return_s - 1.0).abs() < 0.02,
        "{returned_s} {return_s}"
    );
}

/// The barrier of a column before a wall is that of the free side, also if its roof leans to the wall.
#[test]
fn the_barrier_is_that_of_the_free_side() {
    let column = roofed_column();
    let properties = ElasticProperties::of_stiffness(1e10);
    let model = ElasticJoints::of_column(GRAVITY, &column, properties).unwrap();
    let history = history(&model, &started(1.0, Sway::Right, 0.1));
    let Details::Elastic(row, _) = &history.summary.details else {
        unreachable!()
    };
    let barrier_j = row.largest_potential_j / row.peak_potential_over_barrier.unwrap();
    // Two masses, 8000 kg and 4000 kg, at 0.5 and 0.7 m from the right toe.
    let centre_m = [
        (8.0 * 0.5 + 4.0 * 0.7) / 12.0,
        (8.0 * 2.0 + 4.0 * 4.0) / 12.0_f64,
    ];
    let due_j = 12_000.0 * GRAVITY * (centre_m[1].hypot(centre_m[0]) - centre_m[1]);
    assert!(
        (barrier_j / due_j - 1.0).abs() < 1e-9,
        "{barrier_j} {due_j}"
    );
}

/// No corner of a drum enters the wall, the energy balance holds, and the other side is the mirror image.
#[test]
fn drums_stay_before_the_wall() {
    for (drums, damping_time_s) in [(1, 1e-5), (2, 1e-4), (4, 1e-4)] {
        let histories = [Sway::Left, Sway::Right].map(|side| {
            let properties = ElasticProperties {
                damping_time_s,
                ..ElasticProperties::of_stiffness(1e10)
            };
            let column = column(drums, Some(wall(side, HEIGHT_M)));
            let model = ElasticJoints::of_column(GRAVITY, &column, properties).unwrap();
            history(&model, &started(4.0, side.opposite(), 0.4))
        });
        let [left, right] = histories.each_ref().map(|history| {
            assert!(error_of(history) < 5e-3, "{}", error_of(history));
            history.samples.iter().collect::<Vec<Sample>>()
        });
        let part_m = HEIGHT_M / drums as f64;
        for sample in &left {
            for (drum, pose) in sample.poses.iter().enumerate() {
                for corner in [drum, drum + 1] {
                    let y_m = part_m * corner as f64;
                    let at_m = pose.current_position(Vector2::new(-0.5 * WIDTH_M, y_m));
                    assert!(
                        at_m.x > -0.5 * WIDTH_M - 2e-3 || at_m.y > HEIGHT_M,
                        "{at_m}"
                    );
                }
            }
        }
        // Drums that rattle amplify rounding errors, so compare up to the first return.
        for (left, right) in left
            .iter()
            .zip(&right)
            .take_while(|(left, _)| left.time_s < 1.0)
        {
            for (left, right) in left.rotations_rad.iter().zip(&right.rotations_rad) {
                assert!((left + right).abs() < 1e-9, "{left} {right}");
            }
        }
    }
}

#[test]
fn a_push_overturns_it_away_from_the_wall_only() {
    for drums in [1, 3] {
        let model = model(drums, Some(wall(Sway::Left, HEIGHT_M)), 1e9);
        let outcome = |push_g: f64| {
            // The ground moves against the push.
            let ground = pulse(Pulse::Rectangular, -push_g, 0.5);
            let history = model.history(&ground, &sampled(10.0, 0.1)).unwrap();
            assert!(error_of(&history) < 1e-2);
            history.summary.outcome
        };
        assert_eq!(outcome(1.0), Outcome::Overturned(Sway::Right));
        assert!(!matches!(outcome(-1.0), Outcome::Overturned(_)));
        assert!(!matches!(outcome(0.2), Outcome::Overturned(_)));
        // Variations of the stiffness keep the wall.
        let towards = pulse(Pulse::Rectangular, 1.0, 0.5);
        for variation in model.variations() {
            let history = variation.model.unwrap();
            let history = history.history(&towards, &sampled(1.0, 0.1)).unwrap();
            let peaks_rad = &history.summary.peak_rotations_rad;
            assert!(peaks_rad.iter().all(|peak| *peak < 0.01), "{peaks_rad:?}");
        }
    }
}

/// A push below the onset bends the column away from the wall. This gap at the wall is no open joint.
#[test]
fn a_gap_at_the_wall_is_no_rocking() {
    for back in [Some(wall(Sway::Left, HEIGHT_M)), None] {
        let model = model(1, back, 1e9);
        let ground = pulse(Pulse::HalfSine, -0.3 * WIDTH_M / HEIGHT_M, 1.0);
        let history = model.history(&ground, &sampled(1.5, 0.1)).unwrap();
        assert_eq!(history.summary.outcome, Outcome::Vibrates);
    }
}

#[test]
fn a_wall_of_height_zero_changes_no_bit() {
    let run = |back| {
        let history = history(&model(3, back, 1e9), &started(1.0, Sway::Right, 0.3));
        history
            .samples
            .iter()
            .map(|sample| sample.rotations_rad.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(run(None), run(Some(wall(Sway::Left, 0.0))));
}

#[test]
fn columns_that_a_wall_does_not_hold_are_refused() {
    let properties = ElasticProperties::of_stiffness(1e9);
    let refusal = |column: Column| {
        let model = ElasticJoints::of_column(GRAVITY, &column, properties);
        model.unwrap_err().to_string()
    };
    let low = refusal(column(4, Some(wall(Sway::Left, 3.4))));
    assert!(low.contains("3.5 m, the centre of the top drum"), "{low}");
    let tapered = column(4, Some(wall(Sway::Left, 4.0)))
        .with_top_width_m(0.8)
        .unwrap();
    let tapered = refusal(tapered);
    assert!(tapered.contains("top_width_m"), "{tapered}");
    // A roof raises the centre of the top drum, from 3.5 m: 2000 kg and 2000 kg at the top.
    let roofed = column(4, Some(wall(Sway::Left, 3.7)));
    let roofed = roofed.with_loads(vec![PlacedLoad::mass(2000.0, 0.0)], GRAVITY);
    let roofed = refusal(roofed.unwrap());
    assert!(
        roofed.contains("3.75 m, the centre of the top drum"),
        "{roofed}"
    );
    // A thrust that the wall carries: the column would fall to the left without it, and to the right away from it.
    let leaning = |thrust_n: f64| {
        let text = format!(
            "[column]\nheight_m = 8\nwidth_m = 0.6\n[column.back]\nside = 'left'\n[[load]]\nmass_kg = 1000\nthrust_n = {thrust_n}\n\
             [elastic_joints]\nnormal_stiffness_gpa_m = 10\n"
        );
        Scenario::parse(&text, "s.toml").unwrap_err().to_string()
    };
    assert!(leaning(-8000.0).contains("leans the column on the wall on its left"));
    assert!(!leaning(8000.0).contains("leans the column"));
    // One block needs no restitution.
    let low = column(1, Some(wall(Sway::Left, 2.5)));
    assert!(low.wall_rate_ratio().is_err());
    assert!(ElasticJoints::of_column(GRAVITY, &low, properties).is_ok());
}
