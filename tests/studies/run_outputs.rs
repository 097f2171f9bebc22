//! Printed output, page, picture and tables of a run agree, for random scenarios with every model.

use std::fs;

use crate::common::Random;
use crate::common::browser;
use crate::common::program::printed;
use crate::common::results::{Row, Table, data_of, summary, texts};
use serde_json::{Value, json};

/// A random structure on a random pulse, and its number of blocks; `None` if links or a whole column move.
fn scenario(random: &mut Random, model: &str) -> String {
    let voussoirs = 7 + 2 * random.pick(3);
    let structure = if random.pick(2) == 0 {
        let ratio = random.within(0.14, 0.2);
        format!(
            "[arch]\nmean_radius_m = {}\nthickness_ratio = {ratio}\nembrace_deg = 180.0\nvoussoirs = {voussoirs}\n",
            random.within(2.0, 8.0)
        )
    } else {
        let drums = if model.is_empty() { "" } else { "drums = 4\n" };
        format!(
            "[column]\nheight_m = {}\nwidth_m = 0.9\n{drums}",
            random.within(3.0, 6.0)
        )
    };
    let side = if random.pick(2) == 0 { 1.0 } else { -1.0 };
    format!(
        "{structure}{model}[ground.half_sine]\namplitude_g = {}\nduration_s = {}\n[simulation]\nduration_s = 1.5\noutput_step_s = 0.002\n",
        side * random.within(0.2, 0.8),
        random.within(0.15, 0.5)
    )
}

#[test]
fn words_page_picture_and_tables_of_a_run_agree() {
    let mut random = Random(26);
    let elastic = "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\nfriction_coefficient = 0.7\n";
    let (mut overturned, mut stood) = (0, 0);
    let mut shown = Vec::new();
    for case in 0..20 {
        let model = ["", "[free_hinges]\n", elastic][case % 3];
        let folder = tempfile::tempdir().unwrap();
        let text = scenario(&mut random, model);
        fs::write(folder.path().join("s.toml"), &text).unwrap();
        let mut arguments = vec!["run", "s.toml", "--out", "o"];
        if !model.is_empty() {
            arguments.push("--no-repeat");
        }
        let said = printed(folder.path(), &arguments);
        let out = folder.path().join("o");
        let (reported, rotations) = (summary(&out), Table::read(out.join("rotations.csv")));
        let page = fs::read_to_string(out.join("report.html")).unwrap();
        let verdict = said.lines().next().unwrap().trim();
        assert!(
            page.contains(&format!("<p id=\"outcome\">{verdict}</p>")),
            "{said}"
        );
        // The outcome and its time.
        let time_s = reported["outcome_time_s"].as_f64().unwrap();
        let (begins, happens) = match reported["outcome"].as_str().unwrap() {
            "overturned" => {
                overturned += 1;
                let sway = reported["overturning_sway"].as_str().unwrap();
                let to = format!("overturned to the {sway} at {time_s:.4} s");
                (format!("overturns to the {sway}"), to)
            }
            "rest" => (
                "survives".to_owned(),
                format!("came to rest at {time_s:.4} s"),
            ),
            "still_rocking" => (
                "survives".to_owned(),
                format!("still rocking at {time_s:.4} s"),
            ),
            "vibrates" => (
                "survives: it vibrates".to_owned(),
                "vibrated, and no joint opened".to_owned(),
            ),
            "incomplete" => (
                "NO VERDICT".to_owned(),
                format!("incomplete: the run ended at {time_s:.4} s"),
            ),
            _ => ("never moves".to_owned(), "never moved".to_owned()),
        };
        assert!(
            verdict.starts_with(&begins) && said.contains(&happens),
            "{text}{said}"
        );
        let is_down = reported["verdict"] == "overturns";
        assert_eq!(is_down, reported["outcome"] == "overturned", "{said}");
        stood += usize::from(!is_down);
        shown.push((
            page.clone(),
            facts(&reported, &rotations, verdict, &happens),
        ));
        if model.is_empty() || reported["outcome"] == "never_moved" {
            continue;
        }
        // The block that rotates most, by how much, and when, compared with the table.
        let number = |from: &str, to: &str| {
            let (_, after) = said.split_once(from).unwrap();
            after.split_once(to).unwrap().0.to_owned()
        };
        let peak_rad: f64 = number("largest rotation ", " rad, of block")
            .parse()
            .unwrap();
        let block: usize = number("rad, of block ", " of ").parse().unwrap();
        let own_rad = reported["largest_peak_rotation_rad"].as_f64().unwrap();
        assert!((own_rad - peak_rad).abs() <= 5.1e-7, "{said}");
        assert_eq!(
            reported[format!("peak_rotation_{block}_rad")],
            reported["largest_peak_rotation_rad"]
        );
        // The largest rotation of a structure that overturns is that up to then.
        let until_s = if is_down { time_s } else { f64::INFINITY };
        let column = format!("rotation_{block}_rad");
        let before = rotations
            .rows
            .iter()
            .filter(|row| row.number("time_s") <= until_s);
        let sampled_rad = before.fold(0.0_f64, |most, row| most.max(row.number(&column).abs()));
        // Samples are 2 ms apart; peaks are those over all steps.
        assert!(
            sampled_rad <= own_rad * (1.0 + 1e-12) && sampled_rad > 0.97 * own_rad,
            "{said}"
        );
        assert_eq!(data_of(&page)["largest_body"], block - 1);
        let picture = fs::read_to_string(out.join("history.svg")).unwrap();
        let picture = roxmltree::Document::parse(&picture).unwrap();
        let named = format!("block {block}, which turns most");
        assert!(texts(&picture).contains(&named), "{named}");
    }
    assert!(overturned > 1 && stood > 3, "{overturned} {stood}");
    check_in_a_browser(&shown);
}

/// Facts that a page must show: the row of the table with the largest rotation, the outcome, and the printed summary.
fn facts(reported: &Value, rotations: &Table, verdict: &str, happens: &str) -> Value {
    let names = rotations.header.iter();
    let columns: Vec<&String> = names
        .filter(|name| name.starts_with("rotation_") && name.ends_with("rad"))
        .collect();
    let largest = |row: &Row| {
        let turned = columns.iter().map(|name| row.number(*name).abs());
        turned.fold(0.0, f64::max)
    };
    let rows = &rotations.rows;
    let peak = rows
        .iter()
        .max_by(|a, b| largest(a).total_cmp(&largest(b)))
        .unwrap();
    json!({
        "verdict": verdict,
        "happens": happens,
        "peak_s": peak.number("time_s"),
        "peak_rad": largest(peak),
        "state": &peak["state"],
        "end_s": rows[rows.len() - 1].number("time_s"),
        "overturned": reported["outcome"] == "overturned",
    })
}

/// All pages at once, each in a frame of one: a browser takes long to start.
fn check_in_a_browser(shown: &[(String, Value)]) {
    let folder = tempfile::tempdir().unwrap();
    let frames = shown.iter().map(|(page, _)| {
        let page = page.replace('&', "&amp;").replace('"', "&quot;");
        let page = page.replace('<', "&lt;");
        format!("<iframe width=\"1000\" height=\"900\" srcdoc=\"{page}\"></iframe>")
    });
    let frames: String = frames.collect();
    let path = folder.path().join("all.html");
    fs::write(
        &path,
        format!("<!doctype html><html><head></head><body>{frames}</body></html>"),
    )
    .unwrap();
    let facts: Vec<&Value> = shown.iter().map(|(_, facts)| facts).collect();
    let script = include_str!("../pages/run_outputs.js");
    browser::assert_checked(
        &path,
        script,
        &json!(facts).to_string(),
        &[],
        5 * shown.len(),
    );
}
