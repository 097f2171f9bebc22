//! Rigid joints between feet that move differently: the right support is a body whose motion is prescribed.

use std::f64::consts::TAU;

use archrock::dynamics::{Outcome, State};
use archrock::mechanics::Edge;
use archrock::mechanics::settling::{Follower, Movement, Movements};
use archrock::mechanics::{Anchor, Tie};
use archrock::mechanics::{Block, Row};
use archrock::{
    ElasticJoints, ElasticProperties, FreeHinges, GroundMotion, Hinge, Model, Pulse, RowOptions,
    Sample,
};
use nalgebra::{Rotation2, Vector2, Vector3};

use crate::common::{GRAVITY, pulse, ring, run_sampled, sampled};

const RADIUS_M: f64 = 5.0;
/// Friction coefficient of the joints that may slip.
const FRICTION: f64 = 1.5;

fn row(embrace_deg: f64, thickness_ratio: f64, voussoirs: usize) -> Row {
    Row::arch(
        &ring(thickness_ratio, embrace_deg),
        voussoirs,
        RADIUS_M,
        1.0,
        2000.0,
    )
    .unwrap()
}

/// The row with joints that cannot slip, and with joints that may slip.
fn models(row: &Row) -> [FreeHinges; 2] {
    let model = FreeHinges::new(row.clone()).unwrap();
    [model.clone(), slipping(model)]
}

fn slipping(model: FreeHinges) -> FreeHinges {
    let options = RowOptions {
        friction_coefficient: Some(FRICTION),
        ..RowOptions::default()
    };
    model.with_options(options).unwrap()
}

/// The model with steps of at most this length.
fn in_steps_of(longest_step_s: f64, model: &FreeHinges) -> FreeHinges {
    let options = RowOptions {
        longest_step_s: Some(longest_step_s),
        friction_coefficient: model.friction_coefficient(),
        ..RowOptions::default()
    };
    model.clone().with_options(options).unwrap()
}

/// Motion of the right foot by one sine of acceleration: its final displacement to the right and upwards, and its duration.
#[derive(Clone, Copy)]
struct FootMotion {
    displacement_m: [f64; 2],
    lasts_s: f64,
}

impl FootMotion {
    fn ground(&self) -> GroundMotion {
        let strong_m_s2 = Vector2::from(self.displacement_m) * (TAU / self.lasts_s.powi(2));
        let right = Pulse::OneSine
            .lasting_s(self.lasts_s)
            .inclined_m_s2(strong_m_s2);
        GroundMotion::still().with_right_foot(right.unwrap())
    }

    /// Displacement of the foot at a time.
    fn at_m(&self, time_s: f64) -> Vector2<f64> {
        let part = (time_s / self.lasts_s).min(1.0);
        Vector2::from(self.displacement_m) * (part - (TAU * part).sin() / TAU)
    }
}

/// Position of the middle of three pins joined by bars, for these positions of the outer pins: the upper intersection of two
/// circles.
fn middle_m(pins: [Vector2<f64>; 3], left: Vector2<f64>, right: Vector2<f64>) -> Vector2<f64> {
    let [own, other] = [pins[0], pins[2]].map(|pin| (pins[1] - pin).norm());
    let span = (right - left).norm();
    let along = (own * own - other * other + span * span) / (2.0 * span);
    let up = (own * own - along * along).sqrt();
    let unit = (right - left) / span;
    left + unit * along + Vector2::new(-unit.y, unit.x) * up
}

/// Rotation of a bar whose ends have moved, anticlockwise.
fn turned_rad([from, to]: [Vector2<f64>; 2], [moved_from, moved_to]: [Vector2<f64>; 2]) -> f64 {
    let angle = |bar: Vector2<f64>| bar.y.atan2(bar.x);
    angle(moved_to - moved_from) - angle(to - from)
}

/// Centre and rotation of a block after two of its points, the ends of `bar`, have moved.
fn moved(block: &Block, bar: [Vector2<f64>; 2], bar_moved: [Vector2<f64>; 2]) -> Vector3<f64> {
    let turn = turned_rad(bar, bar_moved);
    let centre = bar_moved[0] + Rotation2::new(turn) * (block.centre_m - bar[0]);
    Vector3::new(centre.x, centre.y, turn)
}

/// Two blocks on three hinges: the position of the right foot determines theirs.
struct ThreeHinges<'a> {
    row: &'a Row,
    pins: [Vector2<f64>; 3],
}

impl<'a> ThreeHinges<'a> {
    fn new(row: &'a Row) -> Self {
        let edges = [Edge::Intrados, Edge::Extrados, Edge::Intrados];
        let pin = |joint: usize| row.joints[joint].corner_m(edges[joint]);
        let pins = [0, 1, 2].map(pin);
        Self { row, pins }
    }

    /// Centres and rotations of the blocks for a displacement of the right foot.
    fn blocks(&self, apart_m: Vector2<f64>) -> [Vector3<f64>; 2] {
        let [left, crown, right] = self.pins;
        let crown_moved = middle_m(self.pins, left, right + apart_m);
        let [one, other] = [&self.row.blocks[0], &self.row.blocks[1]];
        [
            moved(one, [left, crown], [left, crown_moved]),
            moved(other, [crown, right], [crown_moved, right + apart_m]),
        ]
    }

    /// Kinetic and potential energy relative to the undeformed arch at rest.
    fn energy_j(&self, foot: &FootMotion, time_s: f64) -> f64 {
        const H: f64 = 1e-4;
        let [before, now, after] = [-H, 0.0, H].map(|by| self.blocks(foot.at_m(time_s + by)));
        let energy_j = |block: usize| {
            let body = &self.row.blocks[block];
            let velocity = (after[block] - before[block]) / (2.0 * H);
            let [x, y, rate] = velocity.into();
            0.5 * (body.mass_kg * (x * x + y * y) + body.inertia_kg_m2 * rate * rate)
                + body.mass_kg * GRAVITY * (now[block].y - body.centre_m.y)
        };
        energy_j(0) + energy_j(1)
    }
}

fn open_joints(sample: &Sample) -> Vec<usize> {
    let joint = |hinge: Hinge| match hinge {
        Hinge::Joint { joint, .. } => joint,
        Hinge::Section { .. } | Hinge::Toe(_) | Hinge::Face { .. } => panic!("a row has joints"),
    };
    sample.hinges.iter().map(|open| joint(open.hinge)).collect()
}

/// Supports whose right springing has moved slowly to the right and upwards by these distances.
fn moved_supports([right_m, up_m]: [f64; 2]) -> Movements {
    Movements {
        left: Movement::default(),
        right: Movement {
            spread_m: right_m,
            settlement_m: -up_m,
            rotation_rad: 0.0,
        },
    }
}

/// Two voussoirs hinge at all three joints as the foot moves, and follow the closed form.
#[test]
fn three_hinges_follow_the_foot() {
    let row = row(157.5, 0.15, 2);
    let three = ThreeHinges::new(&row);
    for (displacement_m, lasts_s) in [([0.4, 0.0], 1.0), ([0.3, -0.2], 0.7)] {
        let foot = FootMotion {
            displacement_m,
            lasts_s,
        };
        let request = sampled(1.2 * lasts_s, 0.02);
        for model in models(&row) {
            let (history, samples) = run_sampled(&model, &foot.ground(), &request);
            for sample in &samples {
                let apart_m = foot.at_m(sample.time_s);
                // The program sums the displacements of the foot over all steps.
                assert!((sample.feet_apart_m - apart_m).norm() < 1e-13);
                let due = three.blocks(apart_m);
                for (rotation_rad, due) in sample.rotations_rad.iter().zip(due) {
                    // With slip, each step corrects the position error of the previous one.
                    assert!((rotation_rad - due.z).abs() < 1e-10, "{rotation_rad} {due}");
                }
                let due_j = three.energy_j(&foot, sample.time_s);
                // The closed form uses differences over 0.1 ms; the program has an error of the square of its step.
                assert!((sample.energy_j - due_j).abs() < 2e-3, "{due_j}");
            }
            let last = samples.last().unwrap();
            assert_eq!(open_joints(last), [0, 1, 2]);
            // At the end, the work of the foot equals the energy.
            let row = history.summary.row().unwrap();
            let due_j = three.energy_j(&foot, 1.1 * lasts_s);
            let work_j = row.right_foot_j;
            assert!((work_j / due_j - 1.0).abs() < 1e-8, "{work_j} {due_j}");
            assert_eq!((history.summary.impacts, row.ground_j), (0, 0.0));
            assert!(row.energy_taken_j.abs() < 1e-5, "{}", row.energy_taken_j);
        }
        // On moved springings the motion is the same; rotations count from the settled position.
        let from_m = [0.1, -0.05];
        let model = FreeHinges::new(row.clone()).unwrap();
        let settled = model.on_supports(&moved_supports(from_m)).unwrap();
        let (_, samples) = run_sampled(&settled, &foot.ground(), &request);
        let stood = three.blocks(from_m.into());
        for sample in samples {
            let due = three.blocks(foot.at_m(sample.time_s) + Vector2::from(from_m));
            for (block, rotation_rad) in sample.rotations_rad.iter().enumerate() {
                let due_rad = due[block].z - stood[block].z;
                assert!((rotation_rad - due_rad).abs() < 1e-12, "{rotation_rad}");
            }
        }
    }
}

/// A tie connects the ground at the right foot to the left block. Its force follows its elongation, and the foot works against
/// it.
#[test]
fn a_ground_tie_follows_the_foot() {
    let row = row(157.5, 0.15, 2);
    let three = ThreeHinges::new(&row);
    let held_m = [three.pins[2] + Vector2::new(0.3, 0.5), three.pins[1]];
    let tie = Tie {
        ends: [
            Anchor {
                block: None,
                at_m: held_m[0],
            },
            Anchor {
                block: Some(0),
                at_m: held_m[1],
            },
        ],
        stiffness_n_m: 1e5,
        prestress_n: 1e3,
        yield_force_n: f64::INFINITY,
        breaks_at_strain: f64::INFINITY,
    };
    let tied = row.clone().with_ties(vec![tie], GRAVITY).unwrap();
    let foot = FootMotion {
        displacement_m: [0.3, 0.0],
        lasts_s: 1.0,
    };
    let force_n = |time_s: f64| {
        let apart_m = foot.at_m(time_s);
        let crown = middle_m(three.pins, three.pins[0], three.pins[2] + apart_m);
        let longer_m = (held_m[0] + apart_m - crown).norm() - (held_m[0] - held_m[1]).norm();
        1e3 + 1e5 * longer_m
    };
    for model in models(&tied) {
        let (history, samples) = run_sampled(&model, &foot.ground(), &sampled(1.1, 0.02));
        for sample in &samples {
            let due_n = force_n(sample.time_s);
            let [tie] = sample.ties[..] else {
                panic!("one tie");
            };
            // With slip, positions are accurate to a tenth of a nanometre here.
            assert!((tie.force_n - due_n).abs() < 1e-4, "{tie:?} {due_n}");
        }
        let [first_n, last_n] = [0.0, 1.05].map(force_n);
        assert!(last_n > 2.0 * first_n, "{last_n}");
        let stored_j = (last_n * last_n - first_n * first_n) / 2e5;
        let due_j = three.energy_j(&foot, 1.05) + stored_j;
        let work_j = history.summary.row().unwrap().right_foot_j;
        assert!((work_j - due_j).abs() < 1e-6 * stored_j, "{work_j} {due_j}");
    }
}

/// Three blocks on four hinges between feet with different accelerations. The reference integrates Lagrange's equation for the
/// single free angle, with finite differences of the positions, and shares nothing with the program.
#[test]
fn four_hinges_between_two_feet_obey_lagranges_equation() {
    const H: f64 = 1e-4;
    let row = row(157.5, 0.2, 3);
    let [left_m_s2, right_m_s2] = [Vector2::new(6.0, 0.0), Vector2::new(7.0, -1.0)];
    let edges = [
        Edge::Extrados,
        Edge::Intrados,
        Edge::Extrados,
        Edge::Intrados,
    ];
    let pins = [0, 1, 2, 3].map(|joint: usize| row.joints[joint].corner_m(edges[joint]));
    // Relative to the left foot.
    let blocks = |angle: f64, time_s: f64| {
        let right = pins[3] + (right_m_s2 - left_m_s2) * (0.5 * time_s * time_s);
        let second = pins[0] + Rotation2::new(angle) * (pins[1] - pins[0]);
        let third = middle_m([pins[1], pins[2], pins[3]], second, right);
        let now = [pins[0], second, third, right];
        [0, 1, 2].map(|block: usize| {
            let bar = |pins: [Vector2<f64>; 4]| [pins[block], pins[block + 1]];
            moved(&row.blocks[block], bar(pins), bar(now))
        })
    };
    let rates = |time_s: f64, [angle, rate]: [f64; 2]| {
        let at = |by: f64| blocks(angle + rate * by, time_s + by);
        let [before, now, after] = [-H, 0.0, H].map(at);
        let [less, more] = [-H, H].map(|by| blocks(angle + by, time_s));
        let (mut inertia, mut force) = (0.0, 0.0);
        for (block, body) in row.blocks.iter().enumerate() {
            let weights = Vector3::new(body.mass_kg, body.mass_kg, body.inertia_kg_m2);
            let slope = (more[block] - less[block]) / (2.0 * H);
            let curved = (after[block] - now[block] * 2.0 + before[block]) / (H * H);
            let load = Vector3::new(-left_m_s2.x, -GRAVITY - left_m_s2.y, 0.0);
            let weighted = slope.component_mul(&weights);
            inertia += weighted.dot(&slope);
            force += weighted.dot(&(load - curved));
        }
        [rate, force / inertia]
    };
    let step = |time_s: f64, state: [f64; 2], h: f64| {
        let plus = |slope: [f64; 2], by: f64| [0, 1].map(|i| state[i] + by * slope[i]);
        let first = rates(time_s, state);
        let second = rates(time_s + 0.5 * h, plus(first, 0.5 * h));
        let third = rates(time_s + 0.5 * h, plus(second, 0.5 * h));
        let fourth = rates(time_s + h, plus(third, h));
        [0, 1]
            .map(|i| state[i] + h / 6.0 * (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i]))
    };
    let foot = |strong_m_s2: Vector2<f64>| {
        Pulse::Rectangular
            .lasting_s(0.3)
            .inclined_m_s2(strong_m_s2)
            .unwrap()
    };
    let ground = foot(left_m_s2).with_right_foot(foot(right_m_s2));
    for model in models(&row) {
        let (history, samples) = run_sampled(&model, &ground, &sampled(0.29, 0.01));
        let (mut time_s, mut state) = (0.0, [0.0; 2]);
        for sample in &samples[1..] {
            while time_s < sample.time_s - 1e-9 {
                state = step(time_s, state, 1e-3);
                time_s += 1e-3;
            }
            assert_eq!(open_joints(sample), [0, 1, 2, 3]);
            let due = blocks(state[0], time_s);
            for (rotation_rad, due) in sample.rotations_rad.iter().zip(due) {
                // Measured 7e-10: the square of the step, and rounding in the finite differences.
                assert!((rotation_rad - due.z).abs() < 3e-9, "{rotation_rad} {due}");
            }
        }
        assert!(state[0] > 0.01, "{state:?}");
        // No impact took energy, so the energy is the sum of both works, except for half a step by which they lag behind.
        let [.., before, last] = &samples[..] else {
            panic!("samples");
        };
        let of_row = history.summary.row().unwrap();
        let sampled_s = last.time_s - before.time_s;
        let step_s = sampled_s / (sampled_s / of_row.longest_step_s).ceil();
        let lags_j = 0.5 * step_s * (last.energy_j - before.energy_j) / sampled_s;
        let missing_j = last.energy_j - of_row.ground_j - of_row.right_foot_j;
        assert!(of_row.ground_j > 1e3, "{of_row:?}");
        // Measured 0.7 %: the reference takes the average power since the previous sample.
        assert!(
            (missing_j / lags_j - 1.0).abs() < 0.02,
            "{missing_j} {lags_j}"
        );
    }
}

/// The energy balance of an arch on two feet closes with the square of the step.
#[test]
fn the_energy_closes_with_the_square_of_the_step() {
    let row = row(157.5, 0.15, 2);
    let foot = FootMotion {
        displacement_m: [0.3, -0.2],
        lasts_s: 0.7,
    };
    for model in models(&row) {
        let defects = [4e-3, 2e-3, 1e-3].map(|longest_step_s| {
            let model = in_steps_of(longest_step_s, &model);
            let (history, _) = run_sampled(&model, &foot.ground(), &sampled(0.8, 0.02));
            history.summary.energy_defect_ratio
        });
        assert!(defects[0] < 1e-6, "{defects:?}");
        for pair in defects.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((3.9..4.1).contains(&ratio), "{defects:?}");
        }
    }
}

/// A pulse that reaches the right foot after a delay.
fn late(amplitude_g: f64, lasts_s: f64, delay_s: f64) -> GroundMotion {
    let ground = pulse(Pulse::OneSine, amplitude_g, lasts_s);
    let late = ground.delayed_by(delay_s).unwrap();
    ground.with_right_foot(late)
}

/// Including the work of the foot, an impact dissipates half of mass times the squared change of velocity, which is never
/// negative.
#[test]
fn impacts_between_two_feet_take_energy() {
    let row = row(157.5, 0.15, 12);
    // With slip, each step corrects the position error of the previous one: measured 1.4e-9.
    for (model, tolerance) in models(&row).into_iter().zip([0.0, 1e-8]) {
        let (history, _) = run_sampled(&model, &late(0.7, 0.4, 0.1), &sampled(1.0, 0.01));
        let mut impacts = 0;
        for (time_s, impact) in history.impacts() {
            let [before_j, after_j] = [impact.energy_before_j, impact.energy_after_j];
            assert!(
                after_j <= before_j * (1.0 + tolerance),
                "{time_s} {before_j} {after_j}"
            );
            impacts += 1;
        }
        assert!(impacts > 100, "{impacts}");
    }
}

/// Two feet with equal motions are equivalent to one ground: bit-identical if the motions are written alike, and up to rounding
/// if one is cut into other pieces.
#[test]
fn feet_with_equal_motions_equal_one_ground() {
    let row = row(157.5, 0.15, 12);
    let ground = pulse(Pulse::OneSine, 0.7, 0.4);
    let request = sampled(3.0, 0.01);
    for model in models(&row) {
        let (whole, alone) = run_sampled(&model, &ground, &request);
        assert_eq!(whole.summary.outcome, Outcome::Rest);
        let first = whole.summary.half_cycles()[0];
        assert!(first.peak_rad > 0.01, "{first:?}");
        let cut = ground.cut_at(&[0.0123, 0.1234, 0.333]);
        for (right, same) in [
            (ground.clone(), true),
            (ground.delayed_by(0.0).unwrap(), true),
            (cut, false),
        ] {
            let both = ground.clone().with_right_foot(right);
            let (both, samples) = run_sampled(&model, &both, &request);
            if same {
                assert_eq!(both.summary.outcome_time_s, whole.summary.outcome_time_s);
            }
            for (sample, alone) in samples.iter().zip(&alone) {
                if same {
                    assert_eq!(sample.rotations_rad, alone.rotations_rad);
                } else if sample.time_s < first.start_s + first.duration_s {
                    let both = sample.rotations_rad.iter().zip(&alone.rotations_rad);
                    for (one, other) in both {
                        assert!((one - other).abs() < 1e-9, "{one} {other}");
                    }
                }
            }
        }
    }
}

/// The mirror image of an arch with exchanged feet moves as its mirror image. Positions count from the left foot, so the ground
/// motions of the two computations differ; results agree up to the square of the step.
#[test]
fn mirrored_feet_move_a_mirrored_arch() {
    let row = row(157.5, 0.15, 12);
    let foot = |side: f64, strong_m_s2: [f64; 2], delay_s: f64| {
        let strong_m_s2 = Vector2::new(side * strong_m_s2[0], strong_m_s2[1]);
        Pulse::OneSine
            .lasting_s(0.5)
            .starting_at_s(delay_s)
            .inclined_m_s2(strong_m_s2)
            .unwrap()
    };
    let (one, other) = (([5.0, 1.0], 0.0), ([4.0, -0.5], 0.05));
    let request = sampled(0.4, 0.01);
    for model in models(&row) {
        let history = |side: f64, [left, right]: [([f64; 2], f64); 2]| {
            let [left, right] = [left, right].map(|(strong, delay_s)| foot(side, strong, delay_s));
            run_sampled(&model, &left.with_right_foot(right), &request)
        };
        let (_, samples) = history(1.0, [one, other]);
        let (mirrored, images) = history(-1.0, [other, one]);
        let largest = mirrored.summary.largest_rotation_rad();
        assert!(largest > 5e-3, "{largest}");
        let mut worst = 0.0_f64;
        for (sample, image) in samples.iter().zip(&images) {
            assert!((sample.feet_apart_m.x - image.feet_apart_m.x).abs() < 1e-12);
            let images = image.rotations_rad.iter().rev();
            for (rotation, image) in sample.rotations_rad.iter().zip(images) {
                worst = worst.max((rotation + image).abs());
            }
        }
        // Measured 7e-9: the square of the step, and the order of events within a step.
        assert!(worst < 1e-7, "{worst:e}");
    }
}

/// After a foot has moved slowly for 10 s, the arch is in its equilibrium on springings moved by the same amount: three hinges
/// allow no other position.
#[test]
fn a_slow_foot_ends_in_the_equilibrium_of_moved_supports() {
    let row = row(157.5, 0.15, 12);
    let foot = FootMotion {
        displacement_m: [0.25, -0.1],
        lasts_s: 10.0,
    };
    // Steps of 0.5 ms are fine enough for so slow a motion.
    for model in models(&row).map(|model| in_steps_of(5e-4, &model)) {
        let (history, samples) = run_sampled(&model, &foot.ground(), &sampled(12.0, 0.5));
        assert_eq!(history.summary.outcome, Outcome::Rest);
        let rest = model
            .on_supports(&moved_supports(foot.displacement_m))
            .unwrap();
        let (_, there) = run_sampled(&rest, &GroundMotion::still(), &sampled(0.01, 0.01));
        let (there, here) = (&there[0], samples.last().unwrap());
        assert_eq!(open_joints(here).len(), 3);
        assert_eq!(
            (open_joints(here), here.state),
            (open_joints(there), State::Rest)
        );
        for (here, there) in here.poses.iter().zip(&there.poses) {
            let turned = here.rotation_rad() - there.rotation_rad();
            let off_m = (here.translation - there.translation).norm();
            assert!(
                turned.abs() < 1e-12 && off_m < 1e-11,
                "{turned:e} {off_m:e}"
            );
        }
    }
}

/// An arch falls once its feet have slowly moved apart by the movement capacity of its springings, and not before.
#[test]
fn an_arch_falls_when_a_slow_foot_passes_the_movement_capacity() {
    let row = row(157.5, 0.15, 20);
    let model = FreeHinges::new(row.clone()).unwrap();
    for (displacement_m, part) in [([1.2, 0.0], 0.97), ([1.2, 0.0], 1.03), ([0.0, -3.0], 1.03)] {
        let mut follower = Follower::new(&row).unwrap();
        let slowly = |part: f64| moved_supports(displacement_m) * part;
        let Some(falls) = follower.move_supports(slowly, 0.0, 1.0).unwrap() else {
            panic!("it falls");
        };
        let foot = FootMotion {
            displacement_m: displacement_m.map(|displacement_m| displacement_m * falls * part),
            lasts_s: 10.0,
        };
        let request = sampled(13.0, 0.5);
        let summary = model.simulate(&foot.ground(), &request, None).unwrap();
        if part > 1.0 {
            assert!(matches!(summary.outcome, Outcome::Overturned(_)));
            // The last hundredths of the movement take a second or two.
            assert!(summary.outcome_time_s > 7.0, "{}", summary.outcome_time_s);
        } else {
            assert_eq!(summary.outcome, Outcome::Rest);
        }
    }
}

/// Under a delayed right foot, the first peak with elastic joints tends to that with rigid joints as the stiffness grows.
#[test]
fn stiff_joints_tend_to_rigid_ones() {
    let row = row(157.5, 0.15, 12);
    let ground = late(0.8, 0.4, 0.1);
    let request = sampled(0.5, 0.5);
    let first = |model: &dyn Model| {
        let summary = model.simulate(&ground, &request, None).unwrap();
        summary.half_cycles()[0].peak_rad
    };
    let [rigid, slipping] = models(&row).map(|model| first(&model));
    assert!((slipping / rigid - 1.0).abs() < 1e-4, "{slipping} {rigid}");
    let off = [1e9, 1e10, 1e11].map(|stiffness_pa_m| {
        let properties = ElasticProperties {
            friction_coefficient: None,
            ..ElasticProperties::of_stiffness(stiffness_pa_m)
        };
        first(&ElasticJoints::new(row.clone(), properties).unwrap()) / rigid - 1.0
    });
    // Measured: 8.9, 2.6 and 1.8 %.
    assert!(
        off[2] > 0.0 && off[2] < off[1] && off[1] < off[0],
        "{off:?}"
    );
    assert!(off[2] < 0.02, "{off:?}");
}
