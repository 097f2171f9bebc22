//! Studies of a column with a wall behind it.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::common::parsed;
use crate::common::program::{archrock, printed, refused, scenarios, stderr, stdout};
use crate::common::results::{Table, json};
use archrock::output::Scene;
use archrock::scenario::CheckedSides;
use archrock::studies::capacity;
use archrock::studies::verify::{VerifySummary, verify, words};
use archrock::{Scenario, Sway};
use serde_json::Value;

const FREE: &str = "[column]\nheight_m = 8\nwidth_m = 0.6\n";
const FACADE: &str = "[column]\nheight_m = 8\nwidth_m = 0.6\n[column.back]\nside = 'left'\n";
const ELASTIC: &str = "[elastic_joints]\nnormal_stiffness_gpa_m = 10\nfriction_coefficient = 0.7\n";
const DEMAND: &str = "[demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.sld]\nag_g = 0.10\nf0 = 2.40\ntc_star_s = 0.28\n\
                      [demand.slv]\nag_g = 0.25\nf0 = 2.40\ntc_star_s = 0.35\n";

fn facade(more: &str) -> String {
    format!("{FACADE}{more}")
}

fn refusal(text: &str) -> String {
    let errors = Scenario::parse(text, "s.toml").unwrap_err();
    errors.to_string()
}

/// The results of a command on this text, as JSON.
fn answer(folder: &Path, arguments: &[&str], text: &str) -> Value {
    fs::write(folder.join("s.toml"), text).unwrap();
    let all = [arguments, &["s.toml", "--format", "json"]].concat();
    serde_json::from_str(&printed(folder, &all)).unwrap()
}

#[test]
fn limit_and_capacity_have_one_side() {
    let folder = tempfile::tempdir().unwrap();
    let both = answer(folder.path(), &["limit"], FREE);
    for (wall, held, away) in [("left", "left", "right"), ("right", "right", "left")] {
        let text = FACADE.replace("'left'", &format!("'{wall}'"));
        let one = answer(folder.path(), &["limit"], &text);
        assert_eq!(one["wall_behind"], wall);
        for key in ["incipient_acceleration_g", "incipient_acceleration_m_s2"] {
            assert!(one[key][held].is_null());
            assert_eq!(one[key][away], both[key][away]);
        }
        assert_eq!(one["mechanism"][held], serde_json::json!([]));
        assert_eq!(one["mechanism"][away], both["mechanism"][away]);
        assert_eq!(one["equivalent_block"], both["equivalent_block"]);
        let words = printed(folder.path(), &["limit", "s.toml"]);
        assert!(
            words.contains(&format!("no push to the {held} moves it")),
            "{words}"
        );
        assert!(one.get("to_the_left").is_none());
        let curves = capacity(&parsed(&text), None).unwrap();
        let of_free = capacity(&parsed(FREE), None).unwrap();
        let away: Sway = serde_json::from_value(away.into()).unwrap();
        assert!(curves.get(away.opposite()).is_none());
        assert_eq!(curves.get(away), of_free.get(away));
    }
    assert!(both.get("wall_behind").is_none());
    let words = printed(folder.path(), &["capacity", "s.toml"]);
    assert!(
        words.contains("to the left") && !words.contains("to the right"),
        "{words}"
    );
    let rows = Table::read(folder.path().join("results/s/capacity.csv")).rows;
    assert!(rows.len() > 10 && rows.iter().all(|row| row["sway"] == "left"));
}

/// The check of a façade is that of the free column to the side away from the wall.
#[test]
fn verify_checks_the_side_away_from_the_wall() {
    let held = verify(&parsed(&facade(DEMAND))).unwrap();
    assert_eq!(held.sides, CheckedSides::Right);
    let free = format!("{FREE}{DEMAND}[verify]\nsides = 'right'\n");
    let free = verify(&parsed(&free)).unwrap();
    assert_eq!((held.zeta_e, &held.states), (free.zeta_e, &free.states));
    assert_eq!(held.mechanisms.keys().collect::<Vec<_>>(), [&Sway::Right]);
    assert_eq!(
        (held.wall_behind, free.wall_behind),
        (Some(Sway::Left), None)
    );
    let words = words(&held);
    assert!(
        words.contains("To the right, away from the wall behind it, the structure"),
        "{words}"
    );
    let why = |check: &VerifySummary| {
        check
            .decisions
            .iter()
            .any(|one| one.text.contains("the wall prevents sway to the left"))
    };
    assert!(why(&held) && !why(&free));
    let wrong = format!("{}[verify]\nsides = 'left'\n", facade(DEMAND));
    let error = verify(&parsed(&wrong)).unwrap_err().to_string();
    assert!(error.contains("sides = \"right\""), "{error}");
}

/// Cells, samples and factors are the single histories with the same keys.
#[test]
fn studies_vary_the_wall() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let pulse = "[ground.one_sine]\namplitude_g = -0.25\nduration_s = 1\n[simulation]\nduration_s = 20\ndirection = 'as_given'\n";
    let text = facade(pulse);
    let run = |set: &[&str]| {
        let sets: Vec<&str> = set.iter().flat_map(|one| ["--set", *one]).collect();
        let all = [&["run"], &sets[..]].concat();
        let summary = answer(path, &all, &text);
        let number = |key: &str| summary[key].as_f64().unwrap();
        ["impacts", "outcome_time_s", "largest_peak_rotation_rad"].map(number)
    };
    let map = "[map]\n'column.back.restitution' = [0.2, 0.6]\namplitude_g = [-0.3, 0.3]\n";
    answer(path, &["map"], &format!("{text}{map}"));
    let cells = Table::read(path.join("results/s/map.csv")).rows;
    assert_eq!(cells.len(), 4);
    for cell in &cells {
        let sets = [
            format!(
                "column.back.restitution={}",
                cell["column.back.restitution"]
            ),
            format!("ground.one_sine.amplitude_g={}", cell["amplitude_g"]),
        ];
        let [impacts, ..] = run(&[&sets[0], &sets[1]]);
        assert_eq!(cell["impacts"], impacts.to_string());
    }
    // A stronger rebound takes longer to rest.
    let impacts = |ratio: f64| run(&[&format!("column.back.restitution={ratio}")])[0];
    assert!(impacts(0.0) < impacts(0.3) && impacts(0.3) < impacts(0.6));
    assert!(run(&["column.back.height_m=0"]) != run(&[]));
    let uncertain =
        "[uncertain]\nsamples = 16\n'column.back.restitution' = { from = 0.2, to = 0.6 }\n";
    fs::write(path.join("s.toml"), format!("{text}{uncertain}")).unwrap();
    printed(path, &["run", "s.toml"]);
    let samples = Table::read(path.join("results/s/uncertain/samples.csv")).rows;
    let mut times_s = BTreeSet::new();
    for row in &samples[1..] {
        let ratio = &row["column.back.restitution"];
        let [impacts, time_s, peak_rad] = run(&[&format!("column.back.restitution={ratio}")]);
        assert_eq!(row.number("impacts"), impacts);
        assert!((row.number("outcome_time_s") / time_s - 1.0).abs() < 1e-6);
        assert!((row.number("peak_rotation_rad") / peak_rad - 1.0).abs() < 1e-6);
        times_s.insert(row["outcome_time_s"].clone());
    }
    assert!(times_s.len() > 10);
    let of_height = |height: &str| run(&["column.back.restitution=0.4", height]);
    assert_eq!(
        of_height("column.back.height_m=4"),
        of_height("column.back.height_m=8")
    );
}

/// A façade under a record overturns to one side only. Its factor in a suite is that of `threshold`.
#[test]
fn records_overturn_it_away_from_the_wall() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::copy(scenarios().join("records/wave-1.at2"), path.join("r.at2")).unwrap();
    let text = facade("[ground.record]\nfile = 'r.at2'\n");
    // Away from its wall the façade falls under the motion as given at this factor.
    let found = answer(path, &["threshold", "--direction", "as_given"], &text);
    let factor = found["models"][0]["survives_up_to_factor"]
        .as_f64()
        .unwrap();
    let suite = facade(&format!(
        "[suite]\nrecords = 'r.at2'\nboth_signs = false\nscales = [{}, {}]\n",
        0.99 * factor,
        1.01 * factor
    ));
    answer(path, &["suite"], &suite);
    let rows = Table::read(path.join("results/s/suite.csv")).rows;
    let sides: Vec<_> = rows
        .iter()
        .map(|row| row["overturning_sway"].as_str())
        .collect();
    assert_eq!(sides, ["", "right"]);
}

/// Drums with elastic joints: the statics of free drums to the side away from the wall, in all studies.
#[test]
fn drums_with_elastic_joints_have_one_side() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let drums = |back: &str| format!("{FREE}drums = 4\n{back}{ELASTIC}");
    let back = "[column.back]\nside = 'left'\nheight_m = 7.5\n";
    let [free, held] = ["", back].map(|back| answer(path, &["limit"], &drums(back)));
    let words = printed(path, &["limit", "s.toml"]);
    assert!(
        words.contains("no push to the left moves it: a wall stands there"),
        "{words}"
    );
    for key in ["incipient_acceleration_g", "mechanism"] {
        assert_eq!(free[key]["right"], held[key]["right"]);
        assert_ne!(free[key]["left"], held[key]["left"]);
    }
    assert!(held["incipient_acceleration_g"]["left"].is_null());
    assert!(held["friction"]["left"]["incipient_acceleration_g"].is_null());
    assert_eq!(held["friction"]["right"], free["friction"]["right"]);
    assert_eq!(
        (&held["wall_behind"], free.get("wall_behind")),
        (&Value::from("left"), None)
    );
    let curves = capacity(&parsed(&drums(back)), None).unwrap();
    let of_free = capacity(&parsed(&drums("")), None).unwrap();
    assert_eq!((curves.left, curves.right), (None, of_free.right));
    let push = |amplitude_g: f64| {
        let pulse = format!(
            "[ground.one_sine]\namplitude_g = {amplitude_g}\nduration_s = 0.4\n[simulation]\nduration_s = 2\n"
        );
        answer(path, &["run"], &format!("{}{pulse}", drums(back)))
    };
    let run = push(0.3);
    assert_eq!(run["wall_behind"], "left");
    assert!(run["incipient_acceleration_g"]["left"].is_null());
    let scenario = parsed(&drums(back));
    assert_eq!(parsed(&scenario.to_toml()), scenario);
    let names = |scenario: &Scenario| -> Vec<String> {
        let variations = scenario.variations().unwrap();
        variations
            .into_iter()
            .map(|variation| variation.name)
            .collect()
    };
    // Free hinges have no contact with the wall.
    let alone = parsed(&drums(""));
    let (with_wall, alone) = (names(&scenario), names(&alone));
    assert_eq!(with_wall[..], alone[..alone.len() - 1]);
    assert!(alone[alone.len() - 1].contains("free hinges"));
    // Static analysis needs no table of a model.
    let statics = format!("{FREE}drums = 4\n{back}");
    let limit = answer(path, &["limit"], &statics);
    assert_eq!(
        limit["incipient_acceleration_g"],
        held["incipient_acceleration_g"]
    );
    refused(
        path,
        &["limit", "s.toml", "--set", "column.back.height_m=6.9"],
        &["top drum"],
    );
    refused(
        path,
        &["run", "s.toml", "--hinges", "free"],
        &["at the first impact"],
    );
}

#[test]
fn impacts_keep_the_side() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let right = FACADE.replace("'left'", "'right'");
    let chain = answer(path, &["impact"], &right);
    assert_eq!(chain, answer(path, &["impact", "--first", "left"], &right));
    let towards = ["impact", "s.toml", "--first", "right"];
    refused(path, &towards, &["where a wall stands", "choose left"]);
    assert_eq!(chain["model"], "back_wall");
    let text = chain.to_string();
    assert!(
        text.contains("\"left\"") && !text.contains("\"right\""),
        "{text}"
    );
    let text = facade("[ground.one_sine]\namplitude_g = -0.25\nduration_s = 1\n");
    fs::write(path.join("s.toml"), &text).unwrap();
    printed(path, &["run", "s.toml"]);
    let impacts = Table::read(path.join("results/s/impacts.csv")).rows;
    assert!(impacts.len() > 5);
    for row in &impacts {
        assert_eq!(
            [&row["sway_before"], &row["sway_after"]],
            ["right", "right"]
        );
        let rate = |key: &str| row.number(key);
        let ratio = -rate("rate_after_rad_s") / rate("rate_before_rad_s");
        assert!((ratio * ratio - rate("restitution")).abs() < 1e-12);
    }
    // The law of `[impact]` is a ratio of energies.
    let law = "[impact]\nmodel = 'prescribed'\nrestitution = 0.36\n";
    let model = parsed(&format!("{FACADE}{law}")).mechanisms().unwrap();
    assert_eq!(model.restitution_from(Sway::Right, 3), Some(0.36));
    assert_eq!(model.restitution_from(Sway::Left, 3), None);
    assert_eq!(model.incipient_acceleration_g(Sway::Left), None);
}

#[test]
fn what_a_wall_cannot_have_is_refused() {
    let overturns = refusal(&facade("height_m = 0.01\nrestitution = 0.48\n"));
    assert!(
        overturns.contains("s.toml:6:12") && overturns.contains("at least 4.0 m"),
        "{overturns}"
    );
    let wide = FREE.replace("0.6", "6") + "[column.back]\nside = 'left'\n";
    let unknown = parsed(&wide).check_restitution().unwrap_err();
    assert!(
        unknown.contains("0.75 times as wide as high") && unknown.contains("above 0.7071"),
        "{unknown}"
    );
    let given = parsed(&format!("{wide}restitution = 0.3\n"));
    assert_eq!(given.check_restitution(), Ok(()));
    let high = refusal(&facade("height_m = 8.5\nrestitution = 0.4\n"));
    assert!(
        high.contains("s.toml:6:12") && high.contains("8.0 m"),
        "{high}"
    );
    let elastic = refusal(&facade("restitution = 1.5\n"));
    assert!(elastic.contains("s.toml:6:15"), "{elastic}");
    let rigid = refusal(&facade("[free_hinges]\n"));
    assert!(
        rigid.contains("s.toml:4:1") && rigid.contains("at the first impact"),
        "{rigid}"
    );
    for (keys, place, why) in [
        ("top_width_m = 0.5\n", "s.toml:4:15", "at its foot only"),
        (
            "drums = 4\n",
            "s.toml:7:12",
            "7 m, the centre of the top drum",
        ),
    ] {
        let column = format!("{FREE}{keys}[column.back]\nside = 'left'\nheight_m = 6.9\n{ELASTIC}");
        let wrong = refusal(&column);
        assert!(wrong.contains(place) && wrong.contains(why), "{wrong}");
    }
    let towards = refusal(&facade("[initial]\nsway = 'left'\nrotation_rad = 0.01\n"));
    assert!(
        towards.contains("s.toml:7:8") && towards.contains("other side"),
        "{towards}"
    );
    let twice = refusal(&facade(
        "restitution = 0.5\n[impact]\nrestitution_factor = 0.9\n",
    ));
    assert!(
        twice.contains("s.toml:8:22") && twice.contains("ratio of energies"),
        "{twice}"
    );
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("s.toml"),
        facade("[ground.one_sine]\namplitude_g = 0.2\nduration_s = 1\n"),
    )
    .unwrap();
    let arguments = ["run", "s.toml", "--hinges", "free"];
    refused(folder.path(), &arguments, &["leave [column.back] out"]);
}

/// The peaks of the dynamic route are those of `run` in both directions of the record: `u = b (1 - cos q) + h sin q` of the centre, with half the
/// width `b` and half the height `h`, since `M*` of one block is its mass.
#[test]
fn histories_of_verify_move_away_from_the_wall_only() {
    let folder = tempfile::tempdir().unwrap();
    let records = ["slv-1.at2", "slv-2.at2", "slv-3.at2"];
    for record in records {
        let from = scenarios().join("records").join(record);
        fs::copy(from, folder.path().join(record)).unwrap();
    }
    let text = format!("{}[verify]\nslv_records = 'slv-*.at2'\n", facade(DEMAND));
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let arguments = ["verify", "s.toml", "--out", "out", "--format", "json"];
    let answer: Value = serde_json::from_str(&printed(folder.path(), &arguments)).unwrap();
    let slv = &answer["states"]["slv"]["histories"];
    assert!(
        slv["left"].is_null() && slv["records"][0]["left"].is_null(),
        "{slv}"
    );
    assert!((slv["right"]["restitution"].as_f64().unwrap() - 0.483_f64.powi(2)).abs() < 1e-3);
    let mut largest_m = 0.0_f64;
    for (record, found) in records.into_iter().zip(slv["records"].as_array().unwrap()) {
        let peaks_m = [1.0, -1.0_f64].map(|scale| -> f64 {
            let ground = format!(
                "[ground.record]\nfile = '{record}'\nscale = {scale}\n[simulation]\nduration_s = 60\noutput_step_s = 0.002\n"
            );
            fs::write(folder.path().join("r.toml"), facade(&ground)).unwrap();
            let rotations = printed(folder.path(), &["run", "r.toml", "--rotations", "-"]);
            let table = Table::parse(&rotations);
            let turned = table.numbers("rotation_rad").into_iter();
            let turned = turned.fold(0.0, |most: f64, rotation: f64| most.max(-rotation));
            0.3 * (1.0 - turned.cos()) + 4.0 * turned.sin()
        });
        let peak_m = peaks_m[0].max(peaks_m[1]);
        let found_m = found["right"]["peak_m"].as_f64().unwrap();
        assert!(
            peak_m > 0.0 && (found_m / peak_m - 1.0).abs() < 1e-4,
            "{found_m} {peak_m}"
        );
        largest_m = largest_m.max(found_m);
    }
    assert_eq!(slv["right"]["demand_m"].as_f64().unwrap(), largest_m);
    let page = fs::read_to_string(folder.path().join("out/verify.html")).unwrap();
    assert!(page.contains("<th>peak d to the right (m)</th></tr>"));
}

/// A wall of height 0 is no wall, in all studies and models.
#[test]
fn a_wall_of_height_zero_is_no_wall() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let pulse = "[ground.one_sine]\namplitude_g = -0.25\nduration_s = 1\n";
    let zero = "[column.back]\nside = 'left'\nheight_m = 0\n";
    let own = |mut answer: Value| {
        for key in [
            "scenario",
            "scenario_sha256",
            "files",
            "longest_step_us",
            "results",
        ] {
            answer.as_object_mut().unwrap().remove(key);
        }
        answer
    };
    for (command, more) in [
        (&["limit"][..], ""),
        (&["capacity"], ""),
        (&["impact"], ""),
        (&["verify"], DEMAND),
        (&["run"], pulse),
        (&["run", "--hinges", "free"], pulse),
        (&["limit"], "[free_hinges]\n"),
    ] {
        let [free, held] =
            ["", zero].map(|back| own(answer(path, command, &format!("{FREE}{back}{more}"))));
        assert_eq!(free, held, "{command:?}");
    }
    let drums = |back: &str| parsed(&format!("{FREE}drums = 4\n{back}[free_hinges]\n"));
    let starts_g = |text: &str| {
        drums(text)
            .model()
            .unwrap()
            .incipient_acceleration_g(Sway::Left)
    };
    assert_eq!(starts_g(zero), starts_g(""));
}

/// The words of a run: the wall carries a push towards it, and `[impact]` may replace the restitution of the wall.
#[test]
fn words_name_the_wall() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let towards = "[ground.rectangular]\namplitude_g = 2\nduration_s = 1\n";
    fs::write(path.join("s.toml"), facade(towards)).unwrap();
    let words = printed(path, &["run", "s.toml"]);
    for part in [
        "never moves: the wall carries pushes to the left, and the ground is too weak to start it to the right",
        "a wall carries pushes to the left",
    ] {
        assert!(words.contains(part), "{words}");
    }
    assert_eq!(
        answer(path, &["run"], &facade(towards))["wall_behind"],
        "left"
    );
    let law = "[impact]\nmodel = 'prescribed'\nrestitution = 0.36\n";
    for more in ["", law] {
        let words = parsed(&facade(more)).structure.describe();
        assert!(
            words.contains("against a wall of 8 m on its left;") && !words.contains("restitution"),
            "{words}"
        );
    }
}

/// The wall is drawn beside the column: in the drawing of `check` and in the data of the page.
#[test]
fn the_wall_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let pulse = "[ground.one_sine]\namplitude_g = -0.25\nduration_s = 1\n";
    for (height, named) in [("", 0), ("height_m = 6\n", 1)] {
        fs::write(path.join("s.toml"), facade(&format!("{height}{pulse}"))).unwrap();
        printed(path, &["check", "s.toml", "--plot", "s.svg"]);
        let drawing = fs::read_to_string(path.join("s.svg")).unwrap();
        assert_eq!(drawing.matches("wall behind 6 m").count(), named);
        assert!(drawing.contains("#c9c9c9"));
    }
    for (side, sign) in [("left", -1.0), ("right", 1.0)] {
        let scenario = parsed(&FACADE.replace("left", side));
        let corners_m = scenario.structure.wall_outline_m().unwrap();
        let reach_m = corners_m.map(|corner_m| sign * corner_m.x);
        assert!(reach_m.into_iter().all(|x_m| (0.3..=0.9001).contains(&x_m)));
        assert_eq!(corners_m.map(|corner_m| corner_m.y), [0.0, 8.0, 8.0, 0.0]);
        let wall = Scene::new(&scenario.structure).wall().unwrap();
        assert_eq!(wall.outline_m, corners_m);
    }
    let resolved = parsed(&facade(pulse)).to_toml();
    assert!(
        resolved.contains("[column.back]\nside = \"left\"\n"),
        "{resolved}"
    );
    assert_eq!(parsed(&resolved), parsed(&facade(pulse)));
    fs::write(path.join("s.toml"), facade(pulse)).unwrap();
    printed(path, &["run", "s.toml"]);
    let page = fs::read_to_string(path.join("results/s/report.html")).unwrap();
    assert!(page.contains("\"body\":-1"));
}

const PULSE: &str = "[ground.windowed_sine]\namplitude_g = 0.3\nduration_s = 0.8\ncycles = 8\n";
const LOW: &str = "height_m = 6\n";
const ROOF: &str = "[[load]]\nmass_kg = 1500\nx_m = -0.15\n";
const ALONG: &str = "archrock threshold FILE --along column.back.restitution=0.2..0.9:8";

/// One rigid block before a low wall, or with a moving roof, has no restitution of its own: every study of impacts refuses it, with the command that
/// answers without one. Statics, elastic joints, and a given or prescribed value need none.
#[test]
fn low_walls_and_roofs_need_a_restitution() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::copy(scenarios().join("records/wave-1.at2"), path.join("r.at2")).unwrap();
    let suite = "[suite]\nrecords = 'r.at2'\nscales = [1]\n";
    let map = "[map]\nduration_s = [0.5]\namplitude_g = [0.1]\n";
    for (more, why) in [
        (
            LOW,
            "the wall behind the column is 6 m high, the column 8 m",
        ),
        (ROOF, "1500 kg of loads move with the column"),
    ] {
        for (command, tables) in [
            ("run", PULSE),
            ("threshold", PULSE),
            ("suite", suite),
            ("impact", ""),
            ("verify", DEMAND),
            ("map", &format!("{PULSE}{map}")),
        ] {
            fs::write(path.join("s.toml"), facade(&format!("{more}{tables}"))).unwrap();
            let all = [why, ALONG, "quote its lowest value", "s.toml"];
            refused(path, &[command, "s.toml"], &all);
            let known = ["run", "s.toml", "--set", "column.back.restitution=0.3"];
            if command == "run" {
                printed(path, &known);
            }
        }
        let statics = [more, ""].map(|more| {
            let mut found = answer(path, &["limit"], &facade(more));
            found["mechanism"].take()
        });
        assert_eq!(statics[0], statics[1]);
        answer(path, &["capacity"], &facade(more));
        let elastic = parsed(&facade(&format!("{more}{ELASTIC}")));
        assert_eq!(elastic.check_restitution(), Ok(()));
        let law = "[impact]\nmodel = 'prescribed'\nrestitution = 0.36\n";
        let model = parsed(&facade(&format!("{more}{law}")))
            .mechanisms()
            .unwrap();
        assert_eq!(model.restitution_from(Sway::Right, 1), Some(0.36));
    }
    // A roof that other walls hold, and a thrust, change no momentum in an impact.
    let held = "[[load]]\nmass_kg = 1500\nmoves = false\nthrust_n = 100\nx_m = -0.15\n";
    let [held, full] = [held, ""].map(|more| parsed(&facade(more)).mechanisms().unwrap());
    let ratio = held.restitution_from(Sway::Right, 1).unwrap();
    assert!((ratio - full.restitution_from(Sway::Right, 1).unwrap()).abs() < 1e-14);
    fs::write(path.join("s.toml"), facade(&format!("{LOW}{PULSE}"))).unwrap();
    let checked = archrock(path, &["check", "s.toml"]);
    assert!(checked.status.success() && stderr(&checked).contains(ALONG));
}

/// The offered command answers for a file without restitution. Its values are those of `threshold` with this restitution, and the lowest one is lower
/// than the value of the former default, 0.176.
#[test]
fn the_offered_command_answers_without_a_restitution() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let text = facade(&format!("{LOW}{PULSE}"));
    let along = ["threshold", "--along", "column.back.restitution=0.2..0.9:3"];
    let found = answer(path, &along, &text);
    let safe: Vec<f64> = found["values"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["survives_up_to_g"].as_f64().unwrap())
        .collect();
    let threshold = |ratio: f64| {
        let set = format!("column.back.restitution={ratio}");
        let found = answer(path, &["threshold", "--set", &set], &text);
        let factor = found["models"][0]["survives_up_to_factor"].as_f64();
        factor.unwrap() * found["peak_acceleration_g"].as_f64().unwrap()
    };
    assert_eq!(safe.len(), 3);
    for (ratio, safe) in [0.2, 0.55, 0.9].into_iter().zip(&safe) {
        assert!(
            (safe / threshold(ratio) - 1.0).abs() < 0.01,
            "{ratio} {safe}"
        );
    }
    let least = safe.into_iter().fold(f64::INFINITY, f64::min);
    // The quote is the lowest value, rounded down to four digits.
    let words = found["to_quote"].as_str().unwrap();
    let quoted = words.strip_prefix("survives up to ").unwrap();
    let (quoted, conditions) = quoted.split_once(" g").unwrap();
    let quoted: f64 = quoted.parse().unwrap();
    assert!(quoted <= least && quoted > 0.999 * least, "{words}");
    let lowest = conditions.contains("the lowest of 3 values of column.back.restitution (at 0.9)");
    assert!(
        lowest && conditions.contains("restitution 0.900 at the wall (rates, given)"),
        "{words}"
    );
    assert!(least < 0.6 * threshold(0.176), "{least}");
}

/// Cells and samples whose wall is lower than the façade have no value, and say so; a sample counts as unknown, not as no structure. Values with a full
/// wall are those of `run`.
#[test]
fn cells_and_samples_without_a_restitution_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let map = "[map]\n'column.back.height_m' = [6, 8]\namplitude_g = [-0.3, 0.3]\n";
    let pulse =
        "[ground.one_sine]\namplitude_g = -0.25\nduration_s = 1\n[simulation]\nduration_s = 20\n";
    let summary = answer(path, &["map"], &facade(&format!("{pulse}{map}")));
    let cells = Table::read(path.join("results/s/map.csv")).rows;
    assert_eq!(cells.len(), 4);
    for cell in &cells {
        let is_full = cell.number("column.back.height_m") == 8.0;
        assert_eq!(cell["outcome"] == "failed", !is_full);
    }
    assert!(summary.to_string().contains("6 m high, the column 8 m"));
    let along = ["threshold", "--along", "column.back.height_m=6..8:2"];
    let found = answer(path, &along, &facade(pulse));
    let values = found["values"].as_array().unwrap();
    assert_eq!(
        (&values[0]["why_not"], &values[1]["why_not"]),
        (&Value::from("failed"), &Value::Null)
    );
    let uncertain = "[uncertain]\nsamples = 8\n'column.back.height_m' = { from = 6, to = 8 }\n";
    fs::write(path.join("s.toml"), facade(&format!("{pulse}{uncertain}"))).unwrap();
    printed(path, &["run", "s.toml"]);
    let found = json(&path.join("results/s/uncertain/uncertain.json"));
    let without = found["without_answer"].as_array().unwrap();
    assert_eq!(without.len(), 8, "{found}");
    for one in without {
        assert_eq!(one["why"], "failed");
        assert!(one.to_string().contains("high, the column 8 m"), "{one}");
    }
}

/// With several models only the rigid one is left out, with a warning; the answer is that of elastic joints alone.
#[test]
fn elastic_joints_answer_where_the_rigid_block_cannot() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let pulse =
        "[ground.one_sine]\namplitude_g = -0.1\nduration_s = 0.5\n[simulation]\nduration_s = 1\n";
    fs::write(
        path.join("s.toml"),
        facade(&format!("{LOW}{ELASTIC}{pulse}")),
    )
    .unwrap();
    let run = |hinges: &str| {
        let all = [
            "run",
            "s.toml",
            "--hinges",
            hinges,
            "--no-repeat",
            "--format",
            "json",
        ];
        let output = archrock(path, &all);
        let summary: Value = serde_json::from_str(&stdout(&output)).unwrap();
        (summary, stderr(&output))
    };
    let ((both, warned), (alone, silent)) = (run("four,elastic"), run("elastic"));
    assert!(
        warned.contains("one rigid block is not computed") && warned.contains(ALONG),
        "{warned}"
    );
    assert!(!silent.contains("one rigid block"), "{silent}");
    for key in ["outcome", "largest_peak_rotation_rad", "to_quote"] {
        assert_eq!(both[key], alone[key], "{key}");
        assert!(!both[key].is_null(), "{key}");
    }
    refused(path, &["run", "s.toml", "--hinges", "four"], &[ALONG]);
}
