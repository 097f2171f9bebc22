//! `report.html`: its contents are compared with the tables, as text and in a real browser.

use crate::common::browser;
use crate::common::program;
use crate::common::results::{Table, data_of, summary};
use std::f64::consts::FRAC_PI_4;
use std::fs;
use std::path::Path;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

/// A run with its page and poses, in a folder.
fn run(folder: &Path, scenario: &str) -> String {
    let path = program::scenarios().join(scenario);
    let arguments = ["run", path.to_str().unwrap(), "--out", ".", "--poses"];
    let output = program::archrock(folder, &arguments);
    assert!(output.status.success(), "{}", program::stderr(&output));
    fs::read_to_string(folder.join("report.html")).unwrap()
}

/// The page of a scenario in a browser: every frame that is compared is one of the page's own, so nothing is interpolated.
fn check(scenario: &str, names: &[&str], least_hinges: usize, settings: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let page = run(folder.path(), scenario);
    assert!(page.len() < 500_000, "{} bytes", page.len());
    for foreign in ["src=", "@import", "<link", "url("] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    let (rotations, poses) = (
        Table::read(folder.path().join("rotations.csv")),
        Table::read(folder.path().join("poses.csv")),
    );
    assert_eq!(rotations.rows.len(), poses.rows.len());
    let last = rotations.rows.len() - 1;
    let peak = (0..=last)
        .step_by(16)
        .max_by(|a, b| {
            let column = key("rotation", names[0], "rad");
            let of = |row: usize| rotations.rows[row].number(&column).abs();
            of(*a).total_cmp(&of(*b))
        })
        .unwrap();
    let row = |row: usize| {
        let time_s = rotations.rows[row].number("time_s");
        assert_eq!(time_s, poses.rows[row].number("time_s"));
        let bodies = names.iter().map(|name| {
            let rotation_rad = rotations.rows[row].number(&key("rotation", name, "rad"));
            let [x, y] = ["x", "y"].map(|axis| poses.rows[row].number(&key(axis, name, "m")));
            assert_eq!(
                rotation_rad,
                poses.rows[row].number(&key("rotation", name, "rad"))
            );
            [rotation_rad, x, y]
        });
        json!({
            "time_s": time_s,
            "state": &rotations.rows[row]["state"],
            "bodies": bodies.collect::<Vec<_>>(),
        })
    };
    // Frames are every first, second, fourth or eighth row.
    let rows: Vec<Value> = (0..last).step_by(16).chain([last]).map(row).collect();
    let summary = summary(folder.path());
    let facts = json!({
        "largest_rad": names.iter().map(|name| {
            let column = rotations.numbers(&key("rotation", name, "rad"));
            column.iter().fold(0.0_f64, |most, one| most.max(one.abs()))
        }).fold(0.0, f64::max),
        "overturned_s": (summary["outcome"] == "overturned").then(|| summary["outcome_time_s"].clone()),
        "rows": rows,
        "peak_s": rotations.rows[peak].number("time_s"),
        "end_s": rotations.rows[last].number("time_s"),
        "least_hinges": least_hinges,
    });
    let script = include_str!("report.js");
    let page = folder.path().join("report.html");
    browser::assert_checked(&page, script, &facts.to_string(), settings, 100);
}

fn key(quantity: &str, body: &str, unit: &str) -> String {
    format!("{quantity}_{body}_{unit}").replace("__", "_")
}

#[test]
fn four_links_in_a_browser() {
    let bodies = ["left", "middle", "right"];
    check("semicircle-pulse.toml", &bodies, 4, &[]);
}

#[test]
fn a_fall_in_a_browser() {
    let bodies = ["left", "middle", "right"];
    check("overturning-after-impacts.toml", &bodies, 4, &[]);
}

#[test]
fn a_column_in_a_browser_with_reduced_motion() {
    let settings = ["--force-prefers-reduced-motion"];
    check("column-pulse.toml", &[""], 1, &settings);
}

#[test]
fn free_hinges_in_a_dark_browser() {
    let blocks: Vec<String> = (1..=36).map(|block| block.to_string()).collect();
    let names: Vec<&str> = blocks.iter().map(String::as_str).collect();
    check("free-hinges.toml", &names, 4, &["--force-dark-mode"]);
}

/// An overturning structure falls on the page until a block has rotated by 45 degrees, with every model; no table contains the
/// fall.
#[test]
fn a_fall_is_drawn_but_not_tabulated() {
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 17\n\
                [ground.rectangular]\namplitude_g = -0.9\nduration_s = 0.45\n";
    let column = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[ground.half_sine]\namplitude_g = 0.9\nduration_s = 0.6\n";
    let elastic = "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\nfriction_coefficient = 0.7\n";
    let mut fallen = 0;
    for (structure, model) in [
        (arch, ""),
        (column, ""),
        (arch, "[free_hinges]\n"),
        (arch, "[free_hinges]\nfriction_coefficient = 0.6\n"),
        (arch, elastic),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("s.toml"), format!("{structure}{model}")).unwrap();
        let run = |out: &str, more: &[&str]| {
            let mut arguments = vec!["run", "s.toml", "--out", out];
            arguments.extend(more);
            if !model.is_empty() {
                arguments.push("--no-repeat");
            }
            let said = program::printed(folder.path(), &arguments);
            assert!(said.contains("overturns"), "{said}");
            program::files(&folder.path().join(out))
        };
        let (with, without) = (run("with", &[]), run("without", &["--no-report"]));
        for (name, bytes) in without.iter().filter(|(name, _)| name.ends_with(".csv")) {
            assert_eq!(&with[name], bytes, "{name}");
        }
        let data = data_of(&String::from_utf8(with["report.html"].clone()).unwrap());
        let decoded = |name: &str| BASE64_STANDARD.decode(data["frames"][name].as_str().unwrap());
        let times = decoded("times_s").unwrap();
        let last_s = times.rchunks(8).next().unwrap();
        let last_s = f64::from_le_bytes(last_s.try_into().unwrap());
        let bodies = data["bodies"].as_array().unwrap().len();
        let rotations = decoded("rotations").unwrap();
        let last = rotations.rchunks(2).take(bodies);
        let last = last.map(|pair| f64::from(i16::from_le_bytes(pair.try_into().unwrap())).abs());
        let unit_rad = data["frames"]["rotation_unit_rad"].as_f64().unwrap();
        let turned_rad = last.fold(0.0, f64::max) * unit_rad;
        assert!(
            turned_rad >= FRAC_PI_4 - unit_rad,
            "{model}: {turned_rad} {}",
            data["fall_end"]
        );
        fallen += usize::from(last_s > data["end_s"].as_f64().unwrap());
    }
    assert!(
        fallen >= 3,
        "cases that overturn before a block has rotated so far: {fallen}"
    );
}

/// An arch on piers with fill and loads under a scaled record, on a page as wide as a phone, and on paper.
#[test]
fn an_arch_on_piers_on_a_phone_and_on_paper() {
    let folder = tempfile::tempdir().unwrap();
    let own = fs::read_to_string(program::scenarios().join("pointed-arch-on-piers.toml")).unwrap();
    let (arch, _) = own.split_once("[ground.half_sine]").unwrap();
    let ground =
        "[ground.record]\nfile = \"synthetic.at2\"\npeak_g = 0.3\n[simulation]\nduration_s = 2.0\n";
    fs::write(folder.path().join("s.toml"), format!("{arch}{ground}")).unwrap();
    let record = program::scenarios().join("synthetic.at2");
    fs::copy(record, folder.path().join("synthetic.at2")).unwrap();
    let arguments = ["run", "s.toml", "--out", ".", "--no-repeat"];
    program::printed(folder.path(), &arguments);
    let page = folder.path().join("report.html");
    let text = fs::read_to_string(&page).unwrap();
    let data = data_of(&text);
    let layout = &data["layouts"][0];
    assert_eq!(layout["loads"].as_array().unwrap().len(), 1);
    assert!(layout["fill"].as_array().unwrap().len() >= 4);
    assert_eq!(data["dimensions"].as_array().unwrap().len(), 5);
    let script = "const what = document.getElementById('what').textContent;\
        for (const words of ['pointed arch', 'synthetic.at2', '0.3 g', 'fill', '1500 kg']) verify(what.includes(words), what);\
        verify(innerWidth === 400, `window ${innerWidth}`);\
        verify(document.documentElement.scrollWidth <= 400, `as wide as ${document.documentElement.scrollWidth}`);\
        for (const plot of document.querySelectorAll('.plot')) verify(/: -?[0-9]/.test(plot.querySelector('.legend').textContent), 'legend');";
    browser::assert_checked(&page, script, "null", &["--window-size=400,900"], 9);
    assert!(browser::sheets(&page).is_none_or(|sheets| sheets == 1));
}

/// On moved springings the rotation below the drawing is that of the results, relative to the structure at rest.
#[test]
fn rotations_on_moved_springings_are_those_of_the_results() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 12\n\
                    [supports]\nright = { spread_m = 0.2, settlement_m = 0.05 }\n\
                    [ground.one_sine]\namplitude_g = -0.2\nduration_s = 0.5\n\
                    [simulation]\nduration_s = 1.0\ndirection = \"as_given\"\n";
    for model in [
        "[free_hinges]\n",
        "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n",
    ] {
        fs::write(folder.path().join("s.toml"), format!("{scenario}{model}")).unwrap();
        let arguments = ["run", "s.toml", "--out", ".", "--no-repeat"];
        program::printed(folder.path(), &arguments);
        let page = folder.path().join("report.html");
        let data = data_of(&fs::read_to_string(&page).unwrap());
        // The springing has turned the blocks at rest.
        let standing = data["standing_rad"].as_array().unwrap().iter();
        assert!(
            standing
                .filter_map(Value::as_f64)
                .any(|rad| rad.abs() > 0.01)
        );
        let table = Table::read(folder.path().join("rotations.csv"));
        let last = table.rows.len() - 1;
        let rows = (0..last).step_by(16).map(|row| {
            let turned = (1..=12).map(|block| {
                let column = key("rotation", &block.to_string(), "rad");
                table.rows[row].number(&column)
            });
            json!({ "time_s": table.rows[row].number("time_s"), "rotations_rad": turned.collect::<Vec<_>>() })
        });
        let rows = json!(rows.collect::<Vec<_>>()).to_string();
        let script = "const unit = archrock.data.frames.rotation_unit_rad;
for (const { time_s, rotations_rad } of data) {
  archrock.seek(time_s);
  const words = document.getElementById('now').textContent;
  const [, shown, block] = words.match(/largest rotation (-?[0-9.]+) rad \\(block ([0-9]+)\\)/);
  const due = rotations_rad[block - 1];
  const most = Math.max(...rotations_rad.map(Math.abs));
  const tolerance = 0.51 * unit + 0.51e-5;
  verify(Math.abs(shown - due) <= tolerance && Math.abs(due) >= most - 2 * tolerance, `${words}: ${due} of ${most}`);
}";
        browser::assert_checked(&page, script, &rows, &[], 10);
    }
}

/// Every plot has at least two numbers on its axis, on the screen and in print, for all strengths of the ground motion.
#[test]
fn plots_have_a_scale() {
    let folder = tempfile::tempdir().unwrap();
    let own = run(folder.path(), "semicircle-pulse.toml");
    // The library of the plots keeps no list of them.
    let recorded = "<script>window.plots = []; window.uPlot = new Proxy(uPlot, { construct(made, given) {\
        const plot = new made(...given); plots.push(plot); return plot; } });</script><script>\"use strict\";";
    let before = "<script>\"use strict\";";
    assert_eq!(own.matches(before).count(), 1);
    let page = folder.path().join("scales.html");
    fs::write(&page, own.replace(before, recorded)).unwrap();
    let script = "const encoded = (values) => btoa(String.fromCharCode(...new Uint8Array(new Float32Array(values).buffer)));
const labels = (plot) => plot.axes[1]._values.filter((text) => text !== null && text !== '');
const own = archrock.data;
for (const shape of [[0, 1], [-1, 1], [-0.5, 1]]) {
  for (let peak = 0.01; peak < 2; peak *= 1.03) {
    const curve = encoded([0, 0.1, 0.2, 0.3, 0, ...shape.map((part) => part * peak), 0]);
    plots.length = 0;
    await archrock.renew({ ...own, curves: { ...own.curves, ground_g: curve } });
    const shown = () => plots.every((plot) => labels(plot).length >= 2);
    verify(shown(), `${shape} ${peak}: ${plots.map(labels).join('; ')}`);
    dispatchEvent(new Event('beforeprint'));
    await null;
    verify(shown(), `in print, ${shape} ${peak}: ${plots.map(labels).join('; ')}`);
    dispatchEvent(new Event('afterprint'));
  }
}";
    browser::assert_checked(&page, script, "null", &[], 1000);
}

/// The frames of a film are numbered and evenly spaced in time, and the next run removes them.
#[test]
fn a_film_is_numbered_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let own = program::scenarios().join("semicircle-pulse.toml");
    let own = own.to_str().unwrap();
    let frames = |a_second: &str| {
        let arguments = [
            "run",
            own,
            "--out",
            ".",
            "--film",
            a_second,
            "--exaggerate",
            "3",
        ];
        program::printed(folder.path(), &arguments);
        let names = fs::read_dir(folder.path().join("film")).unwrap();
        let mut names: Vec<_> = names
            .map(|file| file.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    let end_s = |folder: &Path| {
        Table::read(folder.join("rotations.csv"))
            .numbers("time_s")
            .pop()
            .unwrap()
    };
    let names = frames("20");
    let due = (end_s(folder.path()) * 20.0) as usize + 1;
    assert_eq!(names.len(), due);
    for (number, name) in (1..).zip(&names) {
        assert_eq!(*name, format!("frame-{number:04}.svg"));
        let frame = fs::read_to_string(folder.path().join("film").join(name)).unwrap();
        let time = format!(">{:.3} s, ", 0.05 * f64::from(number - 1));
        assert!(frame.contains(&time), "{time}");
    }
    assert!(frames("5").len() < due / 3, "old frames are removed");
    let said = program::refusal(&program::archrock(
        folder.path(),
        &["run", own, "--exaggerate", "3"],
    ));
    assert!(said.contains("--film"), "{said}");
}

#[test]
fn ten_seconds_of_thirty_six_blocks_are_small() {
    let folder = tempfile::tempdir().unwrap();
    let record = program::scenarios().join("synthetic.at2");
    fs::copy(record, folder.path().join("synthetic.at2")).unwrap();
    let scenario = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n\
                    [free_hinges]\n[ground.record]\nfile = \"synthetic.at2\"\npeak_g = 0.2\n\
                    [simulation]\nduration_s = 10.0\n";
    fs::write(folder.path().join("long.toml"), scenario).unwrap();
    let arguments = ["run", "long.toml", "--out", ".", "--no-repeat"];
    let output = program::archrock(folder.path(), &arguments);
    assert!(output.status.success(), "{}", program::stderr(&output));
    let table = Table::read(folder.path().join("rotations.csv"));
    assert_eq!(table.rows.len(), 2001);
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.len() < 500_000, "{} bytes", page.len());
}

#[test]
fn text_of_the_scenario_cannot_break_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "title = \"</title></script><script>alert(1)</script> %DATA% & more\"\n\
                    [column]\nheight_m = 4.0\nwidth_m = 0.8\n[ground.rectangular]\namplitude_g = 0.5\nduration_s = 0.1\n";
    fs::write(folder.path().join("odd.toml"), scenario).unwrap();
    let output = program::archrock(folder.path(), &["run", "odd.toml", "--out", "."]);
    assert!(output.status.success(), "{}", program::stderr(&output));
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(!page.contains("<script>alert"), "a title is shown as text");
    assert!(page.contains("&lt;script&gt;alert(1)&lt;/script&gt; %DATA% &amp; more"));
    assert_eq!(data_of(&page)["bodies"], json!([""]));
}

#[test]
fn without_a_report_the_old_one_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "never-moved.toml");
    let path = program::scenarios().join("never-moved.toml");
    let arguments = ["run", path.to_str().unwrap(), "--out", ".", "--no-report"];
    let output = program::archrock(folder.path(), &arguments);
    assert!(output.status.success(), "{}", program::stderr(&output));
    assert!(
        !String::from_utf8(output.stdout)
            .unwrap()
            .contains("report.html")
    );
    for gone in ["report.html", "poses.csv"] {
        assert!(!folder.path().join(gone).exists(), "{gone}");
    }
    assert!(folder.path().join("rotations.csv").exists());
}

/// A page opens in motion, from the start; on paper it shows the strongest instant. A tall structure has a tall picture.
#[test]
fn a_page_opens_in_motion() {
    let folder = tempfile::tempdir().unwrap();
    let file = program::scenarios().join("facade.toml");
    let arguments = ["run", file.to_str().unwrap(), "--out", "."];
    program::printed(
        folder.path(),
        &[&arguments[..], &["--direction", "as_given"]].concat(),
    );
    let script = "const wait = () => new Promise((resolve) => setTimeout(resolve, 300));\
        const first = archrock.shown();\
        await wait();\
        const later = archrock.shown();\
        verify(first.playing && later.playing, 'plays');\
        verify(later.time > first.time && later.time < archrock.data.opens_s, `${first.time} to ${later.time}`);\
        const { width, height } = document.getElementById('stage').getBoundingClientRect();\
        verify(Math.abs(width / height - 1.25) < 0.02, `${width} by ${height}`);\
        dispatchEvent(new Event('beforeprint'));\
        const printed = archrock.shown();\
        verify(!printed.playing && printed.time === archrock.data.opens_s, `prints ${printed.time}`);";
    let page = folder.path().join("report.html");
    browser::assert_checked(&page, script, "null", &[browser::IN_MOTION], 4);
}
