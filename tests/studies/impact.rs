//! The output of `impact` for rows of blocks, compared with the ring, the mirror image, the momentum of the blocks, and free
//! hinges.

use std::fs;
use std::path::Path;

use crate::common::ON_A_PIER;
use crate::common::UNEVEN_ARCH;
use crate::common::program::printed;
use crate::common::program::refused;
use crate::common::prose::golden;
use crate::common::results;
use crate::common::results::Table;
use archrock::mechanics::four_link::closing_field;
use archrock::mechanics::{Field, Row, Side, Twist};
use archrock::scenario::Structure;
use archrock::{FourLinks, ImpactModel, Scenario, Sway};
use archrock_motion::internals::contact::{ContactProgram, Load};
use nalgebra::Vector2;
use serde_json::Value;

const SIDES: [Sway; 2] = [Sway::Right, Sway::Left];

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let arguments = [&["impact", "--format", "json"], arguments].concat();
    serde_json::from_str(&printed(folder, &arguments)).unwrap()
}

/// Asserts equal outputs of a row and a ring, where the ring has sections in degrees and the row has joint numbers.
fn assert_same(row: &Value, ring: &Value, spacing_deg: f64, key: &str) {
    match (row, ring) {
        (Value::Object(row), Value::Object(ring)) => {
            assert_eq!(row.len(), ring.len(), "{key}");
            for (key, there) in ring {
                let here = &row[&key.replace("angle_deg", "joint")];
                assert_same(here, there, spacing_deg, key);
            }
        }
        (Value::Array(row), Value::Array(ring)) => {
            assert_eq!(row.len(), ring.len(), "{key}");
            for (here, there) in row.iter().zip(ring) {
                assert_same(here, there, spacing_deg, key);
            }
        }
        (Value::Number(here), Value::Number(there)) => {
            let (mut here, there) = (here.as_f64().unwrap(), there.as_f64().unwrap());
            if key.ends_with("angle_deg") {
                here *= spacing_deg;
            }
            let size = if key.ends_with("n_s_per_m") { 1e4 } else { 1.0 };
            let tolerance = match key {
                // The energy of the projection is accurate to 1e-11, and its rates to the square root of that.
                "opening_rate_ratio" => 1e-5,
                _ => 1e-9,
            };
            assert!(
                (here - there).abs() < tolerance * (size + there.abs()),
                "{key}: {here} {there}"
            );
        }
        _ => assert_eq!(row, ring, "{key}"),
    }
}

/// Equal voussoirs given one by one form a row of blocks; equal voussoirs given by their number are cut from a ring.
#[test]
fn equal_voussoirs_given_one_by_one_have_the_impact_of_the_ring() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (embrace_deg, voussoirs) in [(157.5, 7_u32), (180.0, 18)] {
        let spacing_deg = embrace_deg / f64::from(voussoirs);
        let arch = format!(
            "[arch]\nmean_radius_m = 3.0\nthickness_ratio = 0.15\nembrace_deg = {embrace_deg:?}\n\
             depth_m = 2.5\ndensity_kg_m3 = 1800.0\n"
        );
        let mut joints_deg: Vec<f64> = (0..voussoirs)
            .map(|joint| spacing_deg * f64::from(joint))
            .collect();
        joints_deg.push(embrace_deg);
        let row = format!("{arch}joints_deg = {joints_deg:?}\n");
        let ring = format!("{arch}voussoirs = {voussoirs}\n");
        fs::write(folder.join("row.toml"), row).unwrap();
        fs::write(folder.join("ring.toml"), ring).unwrap();
        for (side, key) in [("right", "impacts"), ("left", "impacts_after_left")] {
            for link in ["1", "2", "3"] {
                let options = ["--models", "--certificate", "--link", link, "--first", side];
                let row = json(folder, &[&["row.toml"], &options[..]].concat());
                let ring = json(folder, &[&["ring.toml"], &options[..]].concat());
                assert_same(&row[key], &ring["impacts"], spacing_deg, key);
                for part in ["models", "certificate"] {
                    assert_same(&row[part], &ring[part], spacing_deg, part);
                }

                let line = |file: &str| -> (String, Vec<[f64; 4]>) {
                    let options = ["--line", "-", "--link", link, "--first", side];
                    let text = printed(folder, &[&["impact", file], &options[..]].concat());
                    let table = Table::parse(text);
                    (
                        table.header[0].clone(),
                        table.rows.iter().map(four).collect(),
                    )
                };
                let ((row_key, row), (ring_key, ring)) = (line("row.toml"), line("ring.toml"));
                assert_eq!([&row_key[..], &ring_key], ["joint", "angle_deg"]);
                assert_eq!(row.len(), joints_deg.len());
                for ([joint, here @ ..], angle_deg) in row.iter().zip(&joints_deg) {
                    assert!((joint * spacing_deg - angle_deg).abs() < 1e-9);
                    let at = |row: &&[f64; 4]| (row[0] - angle_deg).abs() < 1e-9;
                    let [_, there @ ..] = ring.iter().find(at).unwrap();
                    for (here, there) in here.iter().zip(there) {
                        assert!((here - there).abs() < 1e-9 * (1e4 + there.abs()));
                    }
                }
            }
        }
    }
}

/// A row of a table of four columns.
fn four(row: &results::Row) -> [f64; 4] {
    [0, 1, 2, 3].map(|column| row.number(column))
}

/// An uneven arch and its mirror image.
const UNEVEN: &str =
    "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\ndepth_m = 2.5\n";
const JOINTS_DEG: [f64; 15] = [
    0.0, 9.0, 21.0, 35.0, 44.0, 60.0, 71.0, 88.0, 97.0, 111.0, 128.0, 140.0, 155.0, 166.0, 180.0,
];

fn uneven(folder: &Path) {
    let mirrored: Vec<f64> = JOINTS_DEG.iter().rev().map(|deg| 180.0 - deg).collect();
    for (file, joints_deg, x_m) in [
        ("own.toml", JOINTS_DEG.to_vec(), 2.0),
        ("mirrored.toml", mirrored, -2.0),
    ] {
        let load = format!("[[load]]\nmass_kg = 3000.0\nx_m = {x_m:?}\n");
        let text = format!("{UNEVEN}joints_deg = {joints_deg:?}\n{load}");
        fs::write(folder.join(file), text).unwrap();
    }
}

/// The output for the mirror image, mirrored back.
fn seen_in_a_mirror(reported: &Value, key: &str, last: u64) -> Value {
    match reported {
        Value::Object(map) => {
            let inside =
                |(key, value): (&String, &Value)| (key.clone(), seen_in_a_mirror(value, key, last));
            map.iter().map(inside).collect()
        }
        Value::Array(list) => {
            let seen = list.iter().map(|value| seen_in_a_mirror(value, key, last));
            match key {
                "impulses" => {
                    let names = ["a", "b", "c", "d"].into_iter();
                    let named = names.zip(seen.rev()).map(|(name, mut seen)| {
                        seen["hinge"] = name.into();
                        seen
                    });
                    named.collect()
                }
                "hinges" | "opened_joints" | "zones" => seen.rev().collect(),
                _ => seen.collect(),
            }
        }
        Value::String(side) if key == "sway" => match &side[..] {
            "left" => "right".into(),
            _ => "left".into(),
        },
        _ if key == "joint" || key.ends_with("_joint") => {
            (last - reported.as_u64().unwrap()).into()
        }
        _ if key == "x_n_s_per_m" => (-reported.as_f64().unwrap()).into(),
        _ => reported.clone(),
    }
}

#[test]
fn a_mirror_image_has_the_mirrored_impact() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    uneven(folder);
    let last = JOINTS_DEG.len() - 1;
    for link in ["1", "2", "3"] {
        for (side, other) in [("right", "left"), ("left", "right")] {
            let options = ["--models", "--certificate", "--link", link, "--first"];
            let own = json(folder, &[&["own.toml"], &options[..], &[side]].concat());
            let there = json(
                folder,
                &[&["mirrored.toml"], &options[..], &[other]].concat(),
            );
            for (key, there_key) in [
                ("impacts", "impacts_after_left"),
                ("impacts_after_left", "impacts"),
                ("models", "models"),
                ("certificate", "certificate"),
            ] {
                let seen = seen_in_a_mirror(&there[there_key], key, last as u64);
                assert_same(&own[key], &seen, 1.0, key);
            }
            assert_ne!(own["impacts"][0], there["impacts"][0]);
            // Among the compared models, the scenario's own gives the impact of the chain.
            let chain = match side {
                "right" => &own["impacts"],
                _ => &own["impacts_after_left"],
            };
            let impact = &chain[link.parse::<usize>().unwrap() - 1];
            let model = &own["models"][0]["impact"];
            for key in ["restitution", "after", "impulses", "impulse_line"] {
                assert_same(&model[key], &impact[key], 1.0, key);
            }

            let line = |file: &str, side: &str| -> Vec<[f64; 4]> {
                let options = ["--line", "-", "--link", link, "--first", side];
                let text = printed(folder, &[&["impact", file], &options[..]].concat());
                Table::parse(text).rows.iter().map(four).collect()
            };
            let (own, there) = (line("own.toml", side), line("mirrored.toml", other));
            assert_eq!([own.len(), there.len()], [last + 1; 2]);
            for ([_, e, normal, tangential], [_, seen @ ..]) in own.iter().zip(there.iter().rev()) {
                // The part before a section is the part after it in the mirror image.
                let seen = [seen[0], seen[1], -seen[2]];
                for (here, there) in [e, normal, tangential].into_iter().zip(seen) {
                    assert!((here - there).abs() < 1e-9 * (1.0 + there.abs()));
                }
            }
        }
    }
}

/// An uneven arch on one pier, with its depth.
fn on_a_pier(folder: &Path) -> (Row, f64) {
    let text = format!("{UNEVEN_ARCH}depth_m = 2.5\n{ON_A_PIER}");
    fs::write(folder.join("s.toml"), text).unwrap();
    let scenario = Scenario::read(&folder.join("s.toml")).unwrap();
    let Structure::Masonry(masonry) = &scenario.structure else {
        panic!("{:?}", &scenario.structure);
    };
    (masonry.row.clone(), 2.5)
}

/// Velocities of the blocks in m/s and rad/s.
fn velocities(field: &Field, row: &Row) -> Vec<Twist> {
    let blocks = 0..row.blocks.len();
    let twists = blocks.map(|block| field.twist_at(block as f64 + 0.5, Side::After));
    twists
        .map(|twist| Twist {
            at_center: twist.at_center * row.size_m,
            ..twist
        })
        .collect()
}

/// The row in the frame in which the mechanism after the first impact sways right.
fn after_one_impact(row: &Row, first: Sway) -> Row {
    match first {
        Sway::Right => row.mirrored().unwrap(),
        Sway::Left => row.clone(),
    }
}

/// The impulses of the ground, at the outer hinges, equal the momentum gained by the blocks, added up block by block in kg and m/s.
#[test]
fn impulses_of_the_ground_are_the_momentum_that_blocks_gain() {
    let folder = tempfile::tempdir().unwrap();
    let (row, depth_m) = on_a_pier(folder.path());
    let model = FourLinks::of_row(&row, ImpactModel::MaxRestitution).unwrap();
    let result = json(folder.path(), &["s.toml"]);
    for (first, key) in SIDES.into_iter().zip(["impacts", "impacts_after_left"]) {
        let chain = model.chain_from(first);
        let after = chain.link(1).unwrap();
        let closing = closing_field(&chain.link(0).unwrap().mechanism, chain.profile(1));
        let moved = after.mechanism.field().scaled(after.link.rate_ratio);
        let blocks = after_one_impact(&row, first);
        let momentum = |field: &Field| -> Vector2<f64> {
            let moving = blocks.blocks.iter().zip(velocities(field, &blocks));
            moving
                .map(|(block, twist)| twist.velocity_at(block.centre_m) * block.mass_kg)
                .sum()
        };
        let gained = momentum(&moved) - momentum(&closing);
        let impulses = &result[key][0]["impulses"];
        let total = |component: &str| -> f64 {
            [0, 3]
                .map(|hinge| impulses[hinge][component].as_f64().unwrap())
                .iter()
                .sum()
        };
        let sign = first.after(1).sign();
        let reported = Vector2::new(sign * total("x_n_s_per_m"), total("y_n_s_per_m")) * depth_m;
        assert!(
            (reported - gained).norm() < 1e-10 * gained.norm(),
            "{reported} {gained}"
        );
    }
}

/// All four hinges shut at once: the energy that free hinges keep, by their own contact program, is that of the
/// certificate.
#[test]
fn the_certificate_is_the_full_closure_of_free_hinges() {
    let folder = tempfile::tempdir().unwrap();
    let (row, _) = on_a_pier(folder.path());
    let model = FourLinks::of_row(&row, ImpactModel::MaxRestitution).unwrap();
    for first in SIDES {
        let chain = model.chain_from(first);
        let closing = closing_field(&chain.link(0).unwrap().mechanism, chain.profile(1));
        let blocks = after_one_impact(&row, first);
        let free = velocities(&closing, &blocks);
        let joints = blocks.joints.len();
        let mut program = ContactProgram::new(&blocks);
        let load = Load {
            free: free.clone(),
            ..Load::none(&blocks)
        };
        program.solve(&load).unwrap();
        let energy = |twists: &[Twist]| -> f64 {
            let moving = blocks.blocks.iter().zip(twists);
            moving
                .map(|(block, twist)| {
                    twist.power(&twist.momentum(&block.moments_at(block.centre_m)))
                })
                .sum()
        };
        let kept = energy(&program.velocities) / energy(&free);
        let options = ["--certificate", "--first", first.name()];
        let result = json(folder.path(), &[&["s.toml"], &options[..]].concat());
        let certificate = &result["certificate"];
        let reported = certificate["restitution_all_fields"].as_f64().unwrap();
        assert!((reported - kept).abs() < 1e-8, "{reported} {kept}");
        assert_eq!(certificate["joints"], joints);
        // The same motion, joint by joint.
        let opened = certificate["opened_joints"].as_array().unwrap();
        let velocities = program.velocities;
        let rate = |block: Option<usize>| {
            let block = block.and_then(|block| velocities.get(block));
            block.map_or(0.0, |twist| twist.rate)
        };
        for opening in opened {
            let from_left = usize::try_from(opening["joint"].as_u64().unwrap()).unwrap();
            let joint = match first.after(1) {
                Sway::Right => from_left,
                Sway::Left => joints - 1 - from_left,
            };
            let turn = rate(Some(joint)) - rate(joint.checked_sub(1));
            let reported = opening["opening_rate_ratio"].as_f64().unwrap();
            // The part to the right of a joint turns clockwise about the intrados, anticlockwise about the extrados.
            let sign = if opening["edge"] == "intrados" {
                -1.0
            } else {
                1.0
            };
            assert!((sign * turn - reported).abs() < 1e-4, "{turn} {opening}");
        }
    }
}

#[test]
fn impact_prints_a_row_in_words() {
    let folder = tempfile::tempdir().unwrap();
    uneven(folder.path());
    let options = ["--models", "--certificate", "--first", "left"];
    let text = printed(
        folder.path(),
        &[&["impact", "own.toml"], &options[..]].concat(),
    );
    golden("impact", &text);
    for words in ["deg", "ring"] {
        let of_ring = text
            .lines()
            .find(|line| line.split(' ').any(|word| word == words));
        assert_eq!(of_ring, None);
    }
}

#[test]
fn requests_that_do_not_suit_the_structure_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    uneven(folder);
    fs::write(
        folder.join("column.toml"),
        "[column]\nheight_m = 4.0\nwidth_m = 0.8\n",
    )
    .unwrap();
    // Thick and shallow: another mechanism governs.
    let thick = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.6\nembrace_deg = 60.0\n\
                 joints_deg = [0, 10, 20, 30, 40, 50, 60]\n";
    fs::write(folder.join("thick.toml"), thick).unwrap();
    let plot = ["--plot", "p.svg"];
    for (arguments, words) in [
        (
            &["impact", "own.toml", "--certificate", "--joints", "100"][..],
            &["--joints", "14", "leave it out"][..],
        ),
        (&["impact", "own.toml", "--first", "up"], &["right, left"]),
        (
            &["impact", "column.toml", "--models"],
            &["for arches only", "column"],
        ),
        (
            &["limit", "column.toml", plot[0], plot[1]],
            &["for arches only", "column"],
        ),
        (
            &["limit", "thick.toml", plot[0], plot[1]],
            &["four links do not describe", "[free_hinges]"],
        ),
        (
            &["impact", "thick.toml", "--certificate"],
            &["four links do not describe", "[free_hinges]"],
        ),
    ] {
        refused(folder, arguments, words);
    }
    assert!(!folder.join("p.svg").exists());
    // A column sways equally to both sides.
    let [left, right] =
        ["left", "right"].map(|side| printed(folder, &["impact", "column.toml", "--first", side]));
    let words =
        |text: &str| -> Vec<String> { text.split_whitespace().map(str::to_owned).collect() };
    let other_way = right
        .replace("right", "-")
        .replace("left", "right")
        .replace('-', "left");
    assert_eq!(words(&left), words(&other_way));
}
