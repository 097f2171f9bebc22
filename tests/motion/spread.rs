//! Arches of rigid blocks that rock on springings that have moved.

use archrock::dynamics::{GroundMotion, Outcome, Pulse, State};
use archrock::mechanics::Ring;
use archrock::mechanics::Row;
use archrock::mechanics::Sway;
use archrock::mechanics::elastic_joint::ElasticProperties;
use archrock::mechanics::friction;
use archrock::mechanics::settling::{Follower, Movement, Movements};
use archrock::mechanics::{Anchor, Tie};
use roxmltree::Document;

use archrock::{ElasticJoints, FreeHinges, Hinge, History, Model as _, Request, RowOptions};

use crate::common::program::{printed, refused};
use crate::common::results::{Table, json};
use crate::mechanics::spread::Blocks;

const GRAVITY: f64 = 9.81;
const RADIUS_M: f64 = 5.0;

fn arch(embrace_deg: f64, thickness_ratio: f64, voussoirs: usize) -> Row {
    let ring = Ring::new(thickness_ratio, embrace_deg.to_radians()).unwrap();
    Row::arch(&ring, voussoirs, RADIUS_M, 1.0, 2000.0).unwrap()
}

/// Supports whose right springing has moved outwards and down by these parts of the radius.
fn right(spread: f64, settlement: f64) -> Movements {
    Movements {
        right: Movement {
            spread_m: RADIUS_M * spread,
            settlement_m: RADIUS_M * settlement,
            rotation_rad: 0.0,
        },
        ..Movements::default()
    }
}

/// A semicircle of 16 voussoirs with a tie between its intrados corners at a quarter and three quarters of its joints; its stiffness in
/// weights per metre, its prestress in weights.
fn tied(stiffness: f64, prestress: f64) -> Row {
    let row = arch(180.0, 0.15, 16);
    let weight_n = row.mass_kg() * GRAVITY;
    let end = |block, joint: usize| Anchor {
        block: Some(block),
        at_m: row.joints[joint].intrados_m,
    };
    let tie = Tie {
        ends: [end(4, 4), end(11, 12)],
        stiffness_n_m: stiffness * weight_n,
        prestress_n: prestress * weight_n,
        yield_force_n: f64::INFINITY,
        breaks_at_strain: f64::INFINITY,
    };
    row.with_ties(vec![tie], GRAVITY).unwrap()
}

fn settled(row: &Row, movements: &Movements) -> FreeHinges {
    let model = FreeHinges::new(row.clone()).unwrap();
    model.on_supports(movements).unwrap()
}

fn slipping(model: FreeHinges, coefficient: f64) -> FreeHinges {
    let options = RowOptions {
        friction_coefficient: Some(coefficient),
        ..RowOptions::default()
    };
    model.with_options(options).unwrap()
}

/// A rectangular push to a side, in units of gravity.
fn push(push_g: f64, sway: Sway, duration_s: f64) -> GroundMotion {
    let acceleration = -sway.sign() * push_g * GRAVITY;
    Pulse::Rectangular
        .lasting_s(duration_s)
        .horizontal_m_s2(acceleration)
        .unwrap()
}

fn history(model: &dyn archrock::Model, ground: &GroundMotion, end_s: f64) -> History {
    let request = Request {
        end_s,
        output_step_s: 0.01,
        ..Request::default()
    };
    model.history(ground, &request).unwrap()
}

fn largest(rotations_rad: &[f64]) -> f64 {
    rotations_rad
        .iter()
        .fold(0.0, |most, now| most.max(now.abs()))
}

fn joint(hinge: Hinge) -> usize {
    match hinge {
        Hinge::Joint { joint, .. } => joint,
        Hinge::Section { .. } | Hinge::Toe(_) | Hinge::Face { .. } => panic!("a row has joints"),
    }
}

/// Ground that moves negligibly after four seconds, so that a history continues until then.
fn four_seconds() -> GroundMotion {
    Pulse::HalfSine
        .lasting_s(0.1)
        .starting_at_s(3.95)
        .horizontal_m_s2(1e-12)
        .unwrap()
}

#[test]
fn a_settled_arch_stays_at_rest() {
    for (row, movements) in [
        (arch(180.0, 0.15, 36), right(0.0279, 0.0)),
        (arch(180.0, 0.15, 36), right(0.0, 0.13)),
        (arch(157.5, 0.15, 12), right(0.1, 0.03)),
        // Three hinges with a tie, and four that the tie holds.
        (tied(0.2, 0.05), right(0.06, 0.0)),
        (tied(30.0, 0.03), right(0.0, 0.12)),
    ] {
        let mut follower = Follower::new(&row).unwrap();
        let way = |part: f64| movements * part;
        follower.move_supports(way, 0.0, 1.0).unwrap();
        let model = settled(&row, &movements);
        for model in [model.clone(), slipping(model, 0.7)] {
            let history = history(&model, &four_seconds(), 4.1);
            let summary = &history.summary;
            assert_eq!(summary.outcome, Outcome::NeverMoved);
            assert!(summary.end_s > 4.0);
            // Rounding of angles of a tenth of a radian.
            let moved = largest(&summary.peak_rotations_rad);
            assert!(moved < 1e-13, "{moved:e}");
            for sample in history.samples.iter() {
                assert_eq!(sample.state, State::Rest);
                let open: Vec<usize> = sample.hinges.iter().map(|open| joint(open.hinge)).collect();
                let expected: Vec<usize> = follower
                    .hinges
                    .as_ref()
                    .unwrap()
                    .hinges
                    .iter()
                    .map(|hinge| hinge.joint)
                    .collect();
                assert_eq!(open, expected);
                for (pose, there) in sample.poses.iter().zip(&follower.stance.placement.poses) {
                    let centre = row.blocks[0].centre_m;
                    assert!(
                        (pose.current_position(centre) - there.current_position(centre)).norm()
                            < 1e-12
                    );
                }
            }
        }
    }
}

/// A settled arch starts to move at the push of the linear programme of forces in the moved position, to a millionth, and not
/// before.
#[test]
fn a_settled_arch_starts_at_the_push_of_limit_analysis() {
    for (embrace_deg, thickness, voussoirs, spread, settlement) in [
        (180.0, 0.15, 16, 0.04, 0.0),
        (180.0, 0.15, 16, 0.0, 0.1),
        (157.5, 0.15, 12, 0.08, 0.0),
    ] {
        let mut blocks = Blocks::new(embrace_deg, thickness, voussoirs);
        for step in 1..=20 {
            blocks.support = [spread, settlement].map(|part| part * f64::from(step) / 20.0);
            assert!(blocks.settle());
        }
        let due_g = blocks.first_motion();
        let row = arch(embrace_deg, thickness, voussoirs);
        let model = settled(&row, &right(spread, settlement));
        let told_g = model.incipient_acceleration_g(Sway::Right).unwrap();
        // The reference knows its position to 1e-7, and its push to 1e-9.
        assert!((told_g - due_g).abs() < 1e-6, "{told_g} {due_g}");
        for model in [model.clone(), slipping(model, 2.0)] {
            let starts = |factor: f64| {
                let ground = push(due_g * factor, Sway::Right, 0.1);
                history(&model, &ground, 0.2).summary.outcome != Outcome::NeverMoved
            };
            assert!(!starts(1.0 - 1e-6) && starts(1.0 + 1e-6), "{due_g}");
        }
    }
}

/// A settled arch with a tie starts to move at the push of the programme of corner forces that includes the force of the tie,
/// solved by an interior-point method.
#[test]
fn a_settled_tied_arch_starts_at_the_push_of_limit_analysis() {
    let row = tied(0.2, 0.05);
    let movements = right(0.06, 0.0);
    let mut follower = Follower::new(&row).unwrap();
    follower
        .move_supports(|part| movements * part, 0.0, 1.0)
        .unwrap();
    // So much friction that nothing slips.
    let onset = friction::onset_at(&row, &follower.stance, 20.0, Sway::Right).unwrap();
    let due_g = onset.unwrap().acceleration_g;
    let model = settled(&row, &movements);
    let told_g = model.incipient_acceleration_g(Sway::Right).unwrap();
    assert!((told_g - due_g).abs() < 1e-6, "{told_g} {due_g}");
    for model in [model.clone(), slipping(model, 2.0)] {
        let starts = |factor: f64| {
            let ground = push(told_g * factor, Sway::Right, 0.1);
            history(&model, &ground, 0.2).summary.outcome != Outcome::NeverMoved
        };
        assert!(!starts(1.0 - 1e-6) && starts(1.0 + 1e-6), "{due_g}");
    }
    // An arch that a tie holds on four hinges starts at once and swings about its position: rigid blocks on a spring, with
    // constant energy.
    let model = settled(&tied(30.0, 0.03), &right(0.0, 0.12));
    assert_eq!(model.incipient_acceleration_g(Sway::Right), Some(0.0));
    for model in [model.clone(), slipping(model, 3.0)] {
        let history = history(&model, &push(0.002, Sway::Right, 0.05), 0.6);
        let summary = &history.summary;
        let of_row = summary.row().unwrap();
        assert_eq!(summary.outcome, Outcome::StillRocking);
        assert!(summary.impacts == 0 && of_row.ties[0].peak_force_n > 0.0);
        assert!(
            summary.energy_defect_ratio < 1e-6,
            "{:e}",
            summary.energy_defect_ratio
        );
        let first: Vec<f64> = history
            .samples
            .iter()
            .map(|sample| sample.rotations_rad[8])
            .collect();
        let [least, most] = [f64::min, f64::max].map(|of| first.iter().copied().fold(0.0, of));
        assert!(most - least > 1e-6, "{least} {most}");
    }
}

/// A tie stretched beyond its strength has broken in the settled position. This is an error, because the motion would start
/// without a tie that the arch has.
#[test]
fn an_arch_whose_tie_breaks_during_settlement_has_no_motion() {
    let movements = right(0.06, 0.0);
    let row = tied(0.2, 0.05);
    let mut follower = Follower::new(&row).unwrap();
    follower
        .move_supports(|part| movements * part, 0.0, 1.0)
        .unwrap();
    let stretch_m = follower.stance.ties[0].stretch_m.0[0];
    let on_supports = |bears: f64| {
        let tie = row.ties[0];
        let tie = Tie {
            breaks_at_strain: bears * stretch_m / tie.slack_length_m(),
            ..tie
        };
        let row = row.clone().with_ties(vec![tie], GRAVITY).unwrap();
        FreeHinges::new(row).unwrap().on_supports(&movements)
    };
    assert!(on_supports(1.0 + 1e-9).is_ok());
    let error = on_supports(1.0 - 1e-9).unwrap_err().to_string();
    assert!(error.contains("tie 1 breaks before"), "{error}");
}

/// Rotations of the blocks from the settled position, every 10 ms.
fn turned(history: &History) -> Vec<Vec<f64>> {
    let samples = history.samples.iter();
    samples
        .map(|sample| sample.rotations_rad.to_vec())
        .collect()
}

/// Largest difference of two motions in the first `until` samples.
fn apart(one: &[Vec<f64>], other: &[Vec<f64>], until: usize) -> f64 {
    let pairs = one.iter().zip(other).take(until);
    let apart = pairs.flat_map(|(one, other)| {
        one.iter()
            .zip(other)
            .map(|(one, other)| (one - other).abs())
    });
    apart.fold(0.0, f64::max)
}

/// Only the relative movement of the springings matters; and the mirror image moves to the other side.
#[test]
fn only_the_relative_movement_of_the_springings_counts() {
    let row = arch(157.5, 0.15, 12);
    let movement = |spread: f64, settlement: f64, rotation_rad: f64| Movement {
        spread_m: RADIUS_M * spread,
        settlement_m: RADIUS_M * settlement,
        rotation_rad,
    };
    let moved = Movements {
        left: Movement::default(),
        right: movement(0.05, 0.02, 0.01),
    };
    let mirrored = Movements {
        left: movement(0.05, 0.02, -0.01),
        right: Movement::default(),
    };
    let shifted = Movements {
        left: movement(-0.3, 0.1, 0.0),
        right: movement(0.35, 0.12, 0.01),
    };
    let pushed = |movements: &Movements, push_g, sway| {
        let model = settled(&row, movements);
        turned(&history(&model, &push(push_g, sway, 0.2), 1.0))
    };
    let built = pushed(&Movements::default(), 0.5, Sway::Right);
    let along = Movements {
        left: movement(-0.3, 0.1, 0.0),
        right: movement(0.3, 0.1, 0.0),
    };
    let as_one = pushed(&along, 0.5, Sway::Right);
    let motion = |movements: &Movements, sway| pushed(movements, 0.3, sway);
    assert!(largest(&built.concat()) > 1e-2);
    // Positions differ by rounding, some 1e-16 of 1.5 m.
    assert!(apart(&built, &as_one, 25) < 1e-11);
    let far = Movements {
        left: movement(-20.0, 8.0, 0.0),
        right: movement(20.0, 8.0, 0.0),
    };
    // At a distance of 100 m, rounding is 1e-14 m.
    assert!(apart(&built, &pushed(&far, 0.5, Sway::Right), 25) < 1e-9);
    let first = motion(&moved, Sway::Right);
    let elsewhere = motion(&shifted, Sway::Right);
    let mut image = motion(&mirrored, Sway::Left);
    for rotations in &mut image {
        rotations.reverse();
        for rotation in rotations {
            *rotation = -*rotation;
        }
    }
    assert!(largest(&first.concat()) > 1e-2);
    assert!(apart(&first, &elsewhere, 101) < 1e-11);
    // The last open joint on the right closes the row, with an error of the square of the steps: measured 1e-8 rad up to here.
    let off = apart(&first, &image, 25);
    assert!(off < 5e-8, "{off:e}");
}

/// The two methods share only the row: steps that end at landings without slip, and equal steps with Coulomb's law with so much
/// friction that nothing slips. Both give the same motion until the first impact, the same outcome and a closed energy balance.
#[test]
fn both_methods_for_moved_rigid_blocks_agree() {
    let row = arch(157.5, 0.15, 12);
    let free = settled(&row, &right(0.08, 0.0));
    let ground = push(0.3, Sway::Right, 0.2);
    let [one, other] =
        [free.clone(), slipping(free, 3.0)].map(|model| history(&model, &ground, 0.26));
    let (one_rad, other_rad) = (turned(&one), turned(&other));
    assert!(largest(&one_rad.concat()) > 0.05 && one.summary.impacts == 0);
    // Equal steps have an error of 1.3e-8 rad here, which falls with the square of the step.
    let off = apart(&one_rad, &other_rad, 26);
    assert!(off < 5e-8, "{off:e}");
    let row = arch(180.0, 0.15, 36);
    let free = settled(&row, &right(0.0279, 0.0));
    for (push_g, falls) in [(0.05, false), (0.3, true)] {
        for model in [free.clone(), slipping(free.clone(), 3.0)] {
            let history = history(&model, &push(push_g, Sway::Right, 0.2), 10.0);
            let summary = &history.summary;
            let expected = if falls {
                Outcome::Overturned(Sway::Right)
            } else {
                Outcome::Rest
            };
            assert_eq!(summary.outcome, expected);
            let of_row = summary.row().unwrap();
            // In units of weight times radius: measured at most 1.3e-7, over some two thousand impacts.
            assert!(
                summary.energy_defect_ratio < 1e-6,
                "{:e}",
                summary.energy_defect_ratio
            );
            assert!(of_row.closure_error_m < 1e-9 && of_row.energy_taken_j > 0.0);
            if !falls {
                // The arch stands on three hinges again.
                let last = history.samples.iter().last().unwrap();
                assert_eq!(last.hinges.len(), 3, "{:?}", last.hinges);
            }
        }
    }
}

/// With stiffer elastic joints, the rotation of the block whose hinge passes from joint to joint approaches that of rigid joints.
/// Convergence is slow because elastic joints shift a hinge gradually and start a little earlier.
#[test]
fn a_settled_arch_on_stiff_joints_moves_as_on_rigid_ones() {
    let row = arch(157.5, 0.15, 12);
    let movements = right(0.08, 0.0);
    let ground = push(0.3, Sway::Right, 0.2);
    let turned_rad =
        |model: &dyn archrock::Model| turned(&history(model, &ground, 0.2)).last().unwrap()[1];
    let rigid_rad = turned_rad(&settled(&row, &movements));
    let mut last = f64::INFINITY;
    for stiffness_pa_m in [1e10, 1e11, 1e12] {
        let properties = ElasticProperties {
            friction_coefficient: None,
            ..ElasticProperties::of_stiffness(stiffness_pa_m)
        };
        let model = ElasticJoints::new(row.clone(), properties).unwrap();
        let elastic_rad = turned_rad(&model.on_supports(movements).unwrap());
        let off = (elastic_rad / rigid_rad - 1.0).abs();
        assert!(off < 0.75 * last, "{stiffness_pa_m:e}: {off}");
        last = off;
    }
    // Measured 0.19, 0.13 and 0.065.
    assert!(last < 0.08, "{last}");
}

const ARCH: &str = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n\
                    [supports]\nright = { spread_m = 0.13956 }\n\
                    [ground.rectangular]\namplitude_g = -0.05\nduration_s = 0.2\n[simulation]\nduration_s = 0.3\n";

#[test]
fn a_run_on_moved_springings_reports_both_pushes() {
    let folder = tempfile::tempdir().unwrap();
    let write = |more: &str| {
        std::fs::write(folder.path().join("arch.toml"), format!("{ARCH}{more}")).unwrap()
    };
    write("[free_hinges]\n");
    let reported = printed(folder.path(), &["limit", "arch.toml", "--format", "json"]);
    let reported: serde_json::Value = serde_json::from_str(&reported).unwrap();
    for side in ["right", "left"] {
        // At a quarter of the movement capacity of this semicircle, by an independent program. Its numbers and the movement have
        // six digits.
        let number = |key: &str| reported[key][side].as_f64().unwrap();
        assert!((number("incipient_acceleration_g") - 0.006_437_48).abs() < 2e-7);
        assert!((number("capacity_g") - 0.115_773).abs() < 1e-5);
    }
    assert_eq!(
        reported["hinges"],
        serde_json::json!([
            { "joint": 6, "edge": "intrados" },
            { "joint": 18, "edge": "extrados" },
            { "joint": 30, "edge": "intrados" },
        ])
    );
    let words = printed(folder.path(), &["limit", "arch.toml"]);
    let hinges = "joint 6 (intrados), joint 18 (extrados), joint 30 (intrados)";
    assert!(words.contains(hinges), "{words}");
    let run = ["--quiet", "run", "arch.toml", "--no-repeat", "--no-report"];
    printed(folder.path(), &run);
    let reported = json(&folder.path().join("results/arch/summary.json"));
    let told_g = reported["incipient_acceleration_g"]["right"]
        .as_f64()
        .unwrap();
    assert!((told_g - 0.006_437_48).abs() < 2e-7, "{told_g}");
    // The settled position, from which rotations count.
    let first = |table: &str, column: &str| {
        Table::read(folder.path().join("results/arch").join(table)).numbers(column)[0]
    };
    assert_eq!(first("rotations.csv", "rotation_18_rad"), 0.0);
    // The hinge at the crown turns by 0.04627, on the extrados, over a thickness of 0.75 m.
    assert!((first("joints.csv", "gap_18_intrados_m") - 0.0347).abs() < 1e-4);
    // The settled arch on its hinges, and the undeformed arch: the springings and the outer corners are farther apart by the
    // movement.
    printed(folder.path(), &["check", "arch.toml", "--plot", "arch.svg"]);
    let picture = std::fs::read_to_string(folder.path().join("arch.svg")).unwrap();
    assert_eq!(picture.matches("data-name=\"hinge\"").count(), 3);
    let wide_px = |name: &str| {
        let all = Document::parse(&picture).unwrap();
        let paths = all
            .descendants()
            .filter(|node| node.attribute("data-name") == Some(name));
        let corners: Vec<f64> = paths
            .flat_map(|node| {
                let path = node.attribute("points").or(node.attribute("d")).unwrap();
                let numbers = path.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
                let numbers = numbers.filter_map(|number| number.parse::<f64>().ok());
                numbers.step_by(2).collect::<Vec<_>>()
            })
            .collect();
        let [least, most] =
            [f64::min, f64::max].map(|of| corners.iter().copied().reduce(of).unwrap());
        most - least
    };
    let parts = (wide_px("block") / wide_px("built") - 1.0) * 10.75;
    // Coordinates have three digits of a pixel.
    assert!((parts - 0.13956).abs() < 1e-4, "{parts}");
    write("[free_hinges]\nfriction_coefficient = 0.7\n");
    let words = printed(folder.path(), &["limit", "arch.toml"]);
    assert!(words.contains(" 0.7"), "{words}");
    for (more, set, message) in [
        (
            "[free_hinges]\n",
            "supports.right.spread_m=0.7",
            "makes the arch fall at 79.75 % of this movement",
        ),
        (
            "[free_hinges]\nfriction_coefficient = 0.36\n",
            "title=slides",
            "does not hold the structure on its moved springings",
        ),
        (
            "[free_hinges]\n[[tie]]\nheight_m = 2.0\nstiffness_n_m = 1e5\nbreaks_at_strain = 0.01\n",
            "title=tied",
            "`[[tie]]` in `tie` breaks before the end of the movement of [supports]",
        ),
        (
            "[impact]\nmodel = \"max_restitution\"\n",
            "title=four",
            "four links start undeformed; choose [free_hinges]",
        ),
    ] {
        write(more);
        refused(
            folder.path(),
            &["run", "arch.toml", "--set", set],
            &[message],
        );
    }
    write("[free_hinges]\n");
    refused(
        folder.path(),
        &["capacity", "arch.toml"],
        &["the studies `limit` and `spread` compute its capacity"],
    );
}
