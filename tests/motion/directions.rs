//! Motions under mirrored ground: symmetric structures, repetitions that are mirrored, and cases in both directions.

use crate::common::{ARCH, COLUMN, ON_A_PIER, UNEVEN_ARCH, parsed};
use archrock::dynamics::{
    Direction, Directions, ElasticJoints, EndCondition, FreeHinges, HalfCycle, Job, Jobs,
    RowOptions, Summary, Verdict,
};
use archrock::mechanics::elastic_joint::ElasticProperties;
use archrock::mechanics::{Anchor, Block, Joint, Ring, Row, Supports, Tie};
use archrock::studies::{Ending, NoHistory};
use archrock::{Column, GroundMotion, Model, Pulse, Request, Scenario, SimulationError};
use nalgebra::Vector2;
use proptest::prelude::*;

/// A row with its mirror image on the right of it, whose two halves meet at a joint at the crown. The blocks of the half are sectors of a ring with
/// other masses; `shift_m` moves all of it.
fn symmetric_row(masses: &[f64], shift_m: f64) -> Row {
    let ring = Ring::new(0.2, 2.6).unwrap();
    let row = Row::arch(&ring, 2 * masses.len(), 4.0, 1.0, 2000.0).unwrap();
    let shifted = |point_m: Vector2<f64>| point_m + Vector2::new(shift_m, 0.0);
    let blocks = row.blocks.iter().enumerate().map(|(index, block)| {
        let factor = masses[index.min(2 * masses.len() - 1 - index)];
        Block {
            mass_kg: factor * block.mass_kg,
            centre_m: shifted(block.centre_m),
            inertia_kg_m2: factor * block.inertia_kg_m2,
        }
    });
    let joints = row.joints.iter().map(|joint| Joint {
        intrados_m: shifted(joint.intrados_m),
        extrados_m: shifted(joint.extrados_m),
    });
    Row::new(blocks.collect(), joints.collect(), Supports::Both, 4.0).unwrap()
}

/// The row with one block changed by a relative difference.
fn with_heavier_block(row: &Row, index: usize, difference: f64) -> Row {
    let mut blocks = row.blocks.clone();
    blocks[index].mass_kg *= 1.0 + difference;
    Row::new(blocks, row.joints.clone(), row.supports, row.size_m).unwrap()
}

fn tie(from: (usize, [f64; 2]), to: (usize, [f64; 2]), prestress_n: f64) -> Tie {
    Tie {
        ends: [from, to].map(|(block, at_m)| Anchor {
            block: Some(block),
            at_m: at_m.into(),
        }),
        stiffness_n_m: 1e7,
        prestress_n,
        yield_force_n: f64::INFINITY,
        breaks_at_strain: f64::INFINITY,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// A row and its mirror image joined at the crown are symmetric, wherever they stand. A change of one mass by more than the tolerance makes
    /// them asymmetric; one of rounding level does not.
    #[test]
    fn rows_joined_with_their_mirror_image_are_symmetric(
        masses in proptest::collection::vec(0.3..3.0, 2..8),
        shift_m in -20.0..20.0,
        changed in 0..100_usize,
    ) {
        let row = symmetric_row(&masses, shift_m);
        prop_assert!(row.is_symmetric());
        let changed = changed % row.blocks.len();
        prop_assert!(with_heavier_block(&row, changed, 1e-12).is_symmetric());
        prop_assert!(!with_heavier_block(&row, changed, 1e-6).is_symmetric());
        let mut joints = row.joints.clone();
        joints[0].extrados_m.y += 1e-6;
        let moved = Row::new(row.blocks.clone(), joints, Supports::Both, 4.0).unwrap();
        prop_assert!(!moved.is_symmetric());
        prop_assert!(!row.clone().with_supports_that_extend([true, false]).is_symmetric());
        prop_assert!(row.with_supports_that_extend([true, true]).is_symmetric());
    }
}

#[test]
fn ties_and_forces_need_their_mirror_images() {
    let row = symmetric_row(&[1.0, 2.0], 0.0);
    let [left, right] = [[-3.0, 1.0], [3.0, 1.0]];
    let tied = |ties: Vec<Tie>| row.clone().with_ties(ties, 9.81).unwrap().is_symmetric();
    assert!(tied(vec![tie((0, left), (3, right), 1e3)]));
    assert!(tied(vec![tie((3, right), (0, left), 1e3)]));
    assert!(!tied(vec![tie((0, left), (3, [3.0, 1.1]), 1e3)]));
    let (steep, other) = ([-1.0, 3.0], [1.0, 3.0]);
    let pair = |prestress_n| {
        vec![
            tie((0, left), (2, other), 1e3),
            tie((1, steep), (3, right), prestress_n),
        ]
    };
    assert!(tied(pair(1e3)) && !tied(pair(2e3)));
    let forces = |forces: &[(usize, [f64; 2], [f64; 2])]| {
        let forces = forces
            .iter()
            .map(|(block, at_m, force_n)| (*block, (*at_m).into(), (*force_n).into()));
        let row = row.clone().with_constant_forces(forces, 9.81);
        row.is_symmetric()
    };
    assert!(forces(&[(0, left, [5.0, -9.0]), (3, right, [-5.0, -9.0])]));
    assert!(!forces(&[(0, left, [5.0, -9.0]), (3, right, [5.0, -9.0])]));
    assert!(!forces(&[(0, left, [0.0, -9.0])]));
}

#[test]
fn symmetric_scenarios_cover_the_mirrored_ground() {
    let ground = "[ground.one_sine]\namplitude_g = 0.5\nduration_s = 0.8\n";
    let covers = |structure: &str| {
        let scenario = parsed(&format!("{structure}{ground}"));
        let model = scenario.model().unwrap();
        let second = scenario.has_second_direction(&*model);
        assert_eq!(second, !model.covers_mirrored(), "{structure}");
        !second
    };
    let load = |x_m: f64| format!("[[load]]\nx_m = {x_m:?}\nheight_m = 0.5\nmass_kg = 500.0\n");
    let voussoirs = format!("{ARCH}voussoirs = 9\n");
    let circular_pier = |sides: &str| format!("{voussoirs}{sides}");
    let (left, right) = (
        "[piers.left]\nheight_m = 1.0\nwidth_m = 3.0\n",
        "[piers.right]\nheight_m = 1.0\nwidth_m = 3.0\n",
    );
    let free = "[free_hinges]\n";
    for (structure, expected) in [
        (ARCH.to_owned(), true),
        (COLUMN.to_owned(), true),
        (format!("{COLUMN}{}", load(0.0)), true),
        (format!("{COLUMN}{}", load(0.1)), false),
        (format!("{COLUMN}{}{}", load(0.1), load(-0.1)), true),
        (format!("{COLUMN}[column.back]\nside = 'left'\n"), false),
        (
            format!("{COLUMN}drums = 4\ntop_width_m = 0.6\n{free}"),
            true,
        ),
        (format!("{voussoirs}{free}"), true),
        (
            format!("{voussoirs}[elastic_joints]\nnormal_stiffness_gpa_m = 10\n"),
            true,
        ),
        (format!("{UNEVEN_ARCH}{free}"), true),
        (format!("{UNEVEN_ARCH}{ON_A_PIER}"), false),
        (format!("{UNEVEN_ARCH}{ON_A_PIER}{free}"), false),
        (circular_pier(&format!("{left}{right}{free}")), true),
        (circular_pier(&format!("{left}{free}")), false),
        (
            format!("{voussoirs}{free}[supports]\nright = {{ spread_m = 0.01 }}\n"),
            false,
        ),
    ] {
        assert_eq!(covers(&structure), expected, "{structure}");
    }
}

/// Neither feet that move differently nor a start on one side are their own mirror image. Without horizontal ground motion there is no direction.
#[test]
fn two_feet_and_a_release_have_a_second_direction() {
    let voussoirs = format!("{ARCH}voussoirs = 9\n[free_hinges]\n");
    let pulse = "[ground.one_sine]\namplitude_g = 0.5\nduration_s = 0.8\n";
    let up = "[ground.one_sine]\namplitude_g = 0.0\nvertical_amplitude_g = 0.3\nduration_s = 0.8\n";
    let release = "[initial]\nsway = 'right'\nrotation_rad = 0.01\n";
    let one_way = "[simulation]\ndirection = 'as_given'\n";
    for (tables, second) in [
        (format!("{voussoirs}{pulse}"), false),
        (
            format!("{voussoirs}{pulse}[ground.right]\ndelay_s = 0.1\n"),
            true,
        ),
        (format!("{voussoirs}{pulse}{release}"), true),
        (format!("{voussoirs}{release}"), false),
        (format!("{UNEVEN_ARCH}{ON_A_PIER}{pulse}"), true),
        (format!("{UNEVEN_ARCH}{ON_A_PIER}{pulse}{one_way}"), false),
        (format!("{UNEVEN_ARCH}{ON_A_PIER}{up}"), false),
    ] {
        let scenario = parsed(&tables);
        let model = scenario.model().unwrap();
        assert_eq!(scenario.has_second_direction(&*model), second, "{tables}");
        let names: Vec<&str> = model.repetitions().iter().map(|one| one.name).collect();
        let mirrored = names.first() == Some(&"mirrored");
        let expected = !second && !names.is_empty() && !tables.contains("rotation_rad");
        assert_eq!(mirrored, expected, "{tables}");
        assert!(names.is_empty() || names.len() == 6, "{names:?}");
    }
}

fn ground() -> GroundMotion {
    let amplitude_m_s2 = Vector2::new(4.5, 1.2);
    let pulse = Pulse::OneSine.lasting_s(0.6).inclined_m_s2(amplitude_m_s2);
    pulse.unwrap()
}

fn request() -> Request {
    Request {
        end_s: 2.0,
        ..Request::default()
    }
}

/// The first half cycles of two motions have the same sides, times and peaks. Landings at one time are found in another order under the mirrored
/// ground, so later half cycles differ.
#[track_caller]
fn assert_begin_alike(one: &Summary, other: &Summary, count: usize, tolerance: f64) {
    let cycles = |summary: &Summary| -> Vec<HalfCycle> {
        summary.half_cycles().into_iter().take(count).collect()
    };
    let [ones, others] = [one, other].map(cycles);
    assert_eq!((ones.len(), others.len()), (count, count));
    for (one, other) in ones.iter().zip(&others) {
        assert_eq!(one.sway, other.sway);
        let apart_s = (one.peak_time_s - other.peak_time_s).abs();
        let apart_rad = (one.peak_rad - other.peak_rad).abs();
        assert!(
            apart_s < tolerance && apart_rad < tolerance * one.peak_rad,
            "{one:?} {other:?}"
        );
    }
}

/// The result of the mirrored repetition is mirrored back: it begins as the motion itself, with the same sides, slips and peaks.
#[test]
fn the_mirrored_repetition_is_mirrored_back() {
    let ring = Ring::new(0.15, 2.7).unwrap();
    let row = Row::arch(&ring, 9, 5.0, 1.0, 2000.0).unwrap();
    let options = RowOptions {
        friction_coefficient: Some(0.4),
        ..RowOptions::default()
    };
    let mut free = FreeHinges::new(row.clone()).unwrap();
    let mut sliding = free.clone().with_options(options).unwrap();
    let mut elastic = ElasticJoints::new(row, ElasticProperties::of_stiffness(1e10)).unwrap();
    let models: [&mut dyn Model; 3] = [&mut free, &mut sliding, &mut elastic];
    for model in models {
        assert!(!model.covers_mirrored() && model.repetitions()[0].name != "mirrored");
        model.repeat_mirrored();
        assert!(model.covers_mirrored());
        let (ground, request) = (ground(), request());
        let own = model.simulate(&ground, &request, None).unwrap();
        let first = model.repetitions().remove(0);
        assert_eq!(first.name, "mirrored");
        let mirrored = first.model.simulate(&ground, &request, None).unwrap();
        assert_begin_alike(&own, &mirrored, 2, 1e-3);
        assert_eq!(own.outcome.kind(), mirrored.outcome.kind());
        // Mirrored twice it is the motion under the mirrored ground.
        let by_hand = model.simulate(&ground.mirrored(), &request, None).unwrap();
        assert_eq!(mirrored.mirrored(model.row()), by_hand);
    }
    // The slips of the first sway are those of the mirrored joints.
    let early = Request {
        end_s: 0.35,
        ..request()
    };
    let own = sliding.simulate(&ground(), &early, None).unwrap();
    let first = sliding.repetitions().remove(0).model;
    let mirrored = first.simulate(&ground(), &early, None).unwrap();
    let slips_m = |summary: &Summary| summary.row().unwrap().sliding.clone().unwrap().offsets_m;
    let (own_m, mirrored_m) = (slips_m(&own), slips_m(&mirrored));
    let most_m = own_m
        .iter()
        .fold(0.0, |most: f64, slip_m| most.max(slip_m.abs()));
    assert!(most_m > 1e-4, "{own_m:?}");
    for (one_m, other_m) in own_m.iter().zip(&mirrored_m) {
        assert!(
            (one_m - other_m).abs() < 1e-3 * most_m,
            "{own_m:?} {mirrored_m:?}"
        );
    }
}

/// Queue of the first repetitions of some cases.
struct FirstRepetitions {
    waiting: Vec<usize>,
    ended: Vec<Option<Summary>>,
}

impl Jobs for FirstRepetitions {
    fn next_job(&mut self) -> Option<Job> {
        Some(Job {
            case: self.waiting.pop()?,
            repetition: Some(0),
            until: EndCondition::End,
        })
    }

    fn receive_result(&mut self, job: Job, answer: Result<Summary, SimulationError>) {
        self.ended[job.case] = Some(answer.unwrap());
    }
}

/// Elastic joints compute the mirrored repetitions of several cases side by side, to the same bits as alone.
#[test]
fn mirrored_repetitions_side_by_side_have_the_same_bits() {
    let column = Column::new(4.0, 0.8).unwrap().with_drums(3).unwrap();
    let row = column.row().unwrap();
    let mut model = ElasticJoints::new(row, ElasticProperties::of_stiffness(1e9)).unwrap();
    model.repeat_mirrored();
    let cases: Vec<_> = [0.3, 0.5, 0.7, 0.9, 1.1, 1.3]
        .map(|factor| (ground().scaled(factor).unwrap(), request()))
        .into();
    let mut jobs = FirstRepetitions {
        waiting: (0..cases.len()).collect(),
        ended: vec![None; cases.len()],
    };
    model.work(&cases, &mut jobs);
    let first = model.repetitions().remove(0);
    assert_eq!(first.name, "mirrored");
    for ((ground, request), together) in cases.iter().zip(jobs.ended) {
        let alone = first.model.simulate(ground, request, None).unwrap();
        assert_eq!(together, Some(alone));
    }
}

/// Under a pulse to one side the uneven arch survives, and under the mirrored pulse it overturns; `checked_in` returns the motions that are computed
/// one by one, and the worse ending.
#[test]
fn the_worse_of_both_directions_counts() {
    let scenario = |tables: &str| parsed(&format!("{UNEVEN_ARCH}{ON_A_PIER}{tables}"));
    for (tables, factors) in [
        ("", vec![0.3, 0.55, 0.7, 0.9, 1.3]),
        ("[free_hinges]\n", vec![0.5, 0.7]),
    ] {
        let built = scenario(tables);
        let model = built.model().unwrap();
        let request = Request {
            end_s: 12.0,
            ..Request::default()
        };
        let cases: Vec<_> = factors
            .iter()
            .map(|factor| (ground().scaled(*factor).unwrap(), request))
            .collect();
        let one = |ground: &GroundMotion| Ending::of(&*model, ground, &request).unwrap();
        let both = Ending::of_all_in(Directions::Both, &*model, &cases);
        let mut differs = false;
        for ((ground, _), ended) in cases.iter().zip(both) {
            let (given, mirrored, ended) = (one(ground), one(&ground.mirrored()), ended.unwrap());
            let mut expected = given.clone();
            let severity = |one: &Ending| (one.verdict(), one.peak_or_infinite_rad());
            // The mirrored motion is not computed if the first one overturns.
            if given.verdict() != Verdict::Overturns {
                let demands = [given.friction_demand, mirrored.friction_demand];
                differs |= demands[0] != demands[1];
                if severity(&mirrored) > severity(&given) {
                    expected = Ending {
                        direction: Direction::Mirrored,
                        ..mirrored
                    };
                }
                expected.friction_demand = demands.into_iter().flatten().reduce(f64::max);
            }
            assert_eq!(ended, expected);
        }
        assert!(differs, "{tables}");
        let given = Ending::of_all_in(Directions::AsGiven, &*model, &cases);
        assert_eq!(given, Ending::of_all(&*model, &cases));
    }
}

/// An uneven arch and its mirror image, both built, exchange their directions.
#[test]
fn a_mirrored_structure_exchanges_the_directions() {
    let sides = |pier: &str, x_m: f64| {
        format!(
            "{UNEVEN_ARCH}[piers.{pier}]\nheight_m = 2.0\nwidth_m = 1.5\n\
             [[load]]\nmass_kg = 1500.0\nx_m = {x_m:?}\nwidth_m = 0.5\n"
        )
    };
    for tables in ["", "[free_hinges]\n"] {
        let [own, other] = [("right", 1.0), ("left", -1.0)].map(|(pier, x_m)| {
            let scenario = parsed(&format!("{}{tables}", sides(pier, x_m)));
            scenario.model().unwrap()
        });
        for factor in [0.45, 0.6] {
            let ground = ground().scaled(factor).unwrap();
            let history = |model: &dyn Model, ground: &GroundMotion| {
                model.simulate(ground, &request(), None).unwrap()
            };
            for ground in [ground.clone(), ground.mirrored()] {
                let one = history(&*own, &ground);
                let image = history(&*other, &ground.mirrored());
                assert_eq!(one.outcome.kind(), image.outcome.kind(), "{tables}");
                let [one_rad, image_rad] = [&one, &image].map(|it| it.peak_rotations_rad[0]);
                if tables.is_empty() {
                    // Four links: rounding errors only. Bodies are numbered from the left in both.
                    let mut image_rad = image.peak_rotations_rad.clone();
                    image_rad.reverse();
                    for (one_rad, other_rad) in one.peak_rotations_rad.iter().zip(image_rad) {
                        assert!((one_rad - other_rad).abs() < 1e-6 * (1.0 + one_rad));
                    }
                } else {
                    assert!(one_rad >= 0.0 && image_rad >= 0.0);
                    let back = image.mirrored(own.row());
                    assert_begin_alike(&one, &back, 1, 1e-3);
                }
            }
        }
    }
}

/// A scenario with the direction "mirrored" is the scenario with negated amplitudes, to the last bit.
#[test]
fn the_direction_mirrored_is_the_negated_ground() {
    let text = |amplitude_g: f64, direction: &str| {
        format!(
            "{UNEVEN_ARCH}{ON_A_PIER}[free_hinges]\n[ground.one_sine]\namplitude_g = {amplitude_g:?}\n\
             vertical_amplitude_g = 0.1\nduration_s = 0.6\n[ground.right]\ndelay_s = 0.02\n\
             [simulation]\nduration_s = 2.0\ndirection = '{direction}'\n"
        )
    };
    let history = |scenario: Scenario| {
        let model = scenario.model().unwrap();
        let history = model.history(scenario.ground_motion(), &scenario.request());
        history.unwrap()
    };
    let mirrored = parsed(&text(0.3, "mirrored"));
    let by_hand = parsed(&text(-0.3, "as_given"));
    assert_eq!(mirrored.ground_motion(), by_hand.ground_motion());
    assert_eq!(
        mirrored.ground_motion(),
        &parsed(&text(0.3, "both")).ground_motion().mirrored()
    );
    let [one, other] = [mirrored, by_hand].map(history);
    assert_eq!(one.summary, other.summary);
    assert!(one.samples == other.samples);
}

/// A mirrored history that fails leaves a survivor without a verdict; overturning decides without it.
#[test]
fn a_failed_mirrored_history_leaves_no_verdict() {
    let scenario = parsed(&format!(
        "{COLUMN}[ground.one_sine]\namplitude_g = 0.1\nduration_s = 0.5\n"
    ));
    let model = scenario.model().unwrap();
    let ending = Ending::of(&*model, scenario.ground_motion(), &scenario.request()).unwrap();
    let failed = || Some(Err(NoHistory::Failed("it broke".to_owned())));
    let error = ending.clone().or_worse(failed()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "with the mirrored ground motion: it broke"
    );
    assert_eq!(ending.clone().or_worse(None).as_ref(), Ok(&ending));
    let overturned = Ending::of(
        &*model,
        &scenario.ground_motion().scaled(20.0).unwrap(),
        &scenario.request(),
    );
    let overturned = overturned.unwrap();
    assert_eq!(overturned.verdict(), Verdict::Overturns);
    assert_eq!(
        overturned.clone().or_worse(failed()).as_ref(),
        Ok(&overturned)
    );
    let worse = ending.or_worse(Some(Ok(overturned))).unwrap();
    assert_eq!(
        (worse.direction, worse.verdict()),
        (Direction::Mirrored, Verdict::Overturns)
    );
}
