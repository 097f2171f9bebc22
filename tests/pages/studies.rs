//! The pages of studies: rendered again from their data, compared with their tables, and opened in a real browser. Their commands are run.

use crate::common::browser;
use crate::common::program::{archrock, printed, scenarios, stderr};
use crate::common::results::{Row, Table, data_of, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use archrock::studies::study_page_of;
use roxmltree::Document;
use serde_json::{Value, json};

/// A page in a folder, and the table whose rows are its cases.
struct Page {
    html: String,
    data: Value,
    rows: Vec<Row>,
}

/// Runs a command, and reads its page. Every page has one mark for each row of its table in each of two drawings, names no address, and follows from its
/// own data.
fn page(folder: &Path, arguments: &[&str], page: &str, table: &str) -> Page {
    let output = archrock(folder, &[arguments, &["--out", "o"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let html = fs::read_to_string(folder.join("o").join(page)).unwrap();
    let data = data_of(&html);
    for foreign in ["src=", "@import", "<link", "url(", "https:"] {
        assert!(!html.contains(foreign), "{foreign}");
    }
    let inside = |before: &str, after: &str| -> Vec<String> {
        let parts = html.split(before).skip(1);
        parts
            .map(|part| part.split_once(after).unwrap().0.to_owned())
            .collect()
    };
    let both = ["wide", "narrow"].map(|width| {
        let own = format!("<div class=\"{width}\">");
        inside(&own, "</div>").remove(0)
    });
    let mut more = inside("<div class=\"picture\">", "</div>");
    more.retain(|picture| picture.starts_with("<svg"));
    let text = inside("id=\"data\">", "</script>").remove(0);
    let again = study_page_of(both.clone(), more, &text).unwrap();
    assert!(again == html, "{arguments:?}");
    assert_balanced(&html);
    let rows = match table {
        "" => Vec::new(),
        table => Table::read(folder.join("o").join(table)).rows,
    };
    let count = data["cases"].as_array().unwrap().len();
    assert!(count == rows.len() || table.is_empty());
    for picture in both {
        let picture = Document::parse(&picture).unwrap();
        let spots = picture.descendants().filter(|node| {
            let class = node.attribute("class").unwrap_or_default();
            class.starts_with("spot")
        });
        let mut marked: Vec<usize> = spots
            .map(|spot| {
                let words = spot.first_element_child().unwrap();
                assert!(!words.text().unwrap().is_empty());
                spot.attribute("data-row").unwrap().parse().unwrap()
            })
            .collect();
        marked.sort_unstable();
        assert!(marked.into_iter().eq(0..count), "{arguments:?}");
    }
    Page { html, data, rows }
}

/// Every element of a page is closed, in order.
fn assert_balanced(html: &str) {
    // Data, scripts and styles are no elements.
    let mut text = html.to_owned();
    for name in ["script", "style"] {
        while let Some(from) = text.find(&format!("<{name}")) {
            let end = format!("</{name}>");
            let to = from + text[from..].find(&end).unwrap() + end.len();
            text.replace_range(from..to, "");
        }
    }
    let mut open: Vec<&str> = Vec::new();
    for tag in text.split('<').skip(1) {
        let tag = tag.split('>').next().unwrap();
        let name = tag.split([' ', '/', '\n']).find(|name| !name.is_empty());
        match (name.unwrap(), tag.starts_with('/'), tag.ends_with('/')) {
            ("!doctype" | "meta" | "link", ..) | (_, false, true) => {}
            (name, true, _) => assert_eq!(open.pop(), Some(name), "</{name}>"),
            (name, false, false) => open.push(name),
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

impl Page {
    /// The command of a row.
    fn command(&self, row: usize) -> String {
        let (data, case) = (&self.data, &self.data["cases"][row]);
        let text = usize::try_from(case["text"].as_u64().unwrap()).unwrap();
        let text = data["texts"][text].as_str().unwrap();
        let values = case["set"].as_array().unwrap().iter();
        let values = values.map(|value| format!(" --set {}", value.as_str().unwrap()));
        let (command, values) = (
            data["command"].as_str().unwrap(),
            values.collect::<String>(),
        );
        format!("archrock {command}{values} <<'END'\n{text}END\n")
    }

    /// Runs the command of a row in a shell, with further options; returns its standard output.
    fn run(&self, folder: &Path, row: usize, options: &str) -> Value {
        let own = format!("{} ", env!("CARGO_BIN_EXE_archrock"));
        let line = self.command(row).replacen("archrock ", &own, 1);
        let line = line.replacen(" - ", &format!(" - {options} "), 1);
        let mut shell = Command::new("sh");
        let output = shell.arg("-c").arg(&line).current_dir(folder).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{line}: {}", stderr(&output));
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// The first row with each outcome.
    fn one_of_each(&self, column: &str) -> Vec<usize> {
        let mut known = BTreeSet::new();
        let rows = self.rows.iter().enumerate();
        rows.filter(|(_, row)| known.insert(&row[column]))
            .map(|(index, _)| index)
            .collect()
    }

    /// Runs one row of each outcome as a history, and compares outcome and largest rotation.
    fn assert_histories(&self, folder: &Path) {
        let outcomes = self.one_of_each("outcome");
        assert!(outcomes.len() > 1);
        for index in outcomes {
            let row = &self.rows[index];
            let summary = self.run(folder, index, "--format json");
            assert_eq!(summary["outcome"], row["outcome"], "{row:?}");
            let time_s = summary["outcome_time_s"].as_f64().unwrap();
            assert!((time_s - row.number("outcome_time_s")).abs() < 1e-6 * time_s);
        }
    }
}

const COLUMN: &str =
    "title = \"A column & <b>more</b>\"\n[column]\nheight_m = 4.0\nwidth_m = 0.8\n";
const PULSE: &str =
    "[ground.one_sine]\namplitude_g = 0.4\nvertical_amplitude_g = 0.1\nduration_s = 0.6\n";
const ARCH: &str = "[arch]\nspan_m = 9.0\nrise_m = 3.0\nthickness_m = 0.9\nmeasured_at = \"mean\"\nvoussoirs = 9\n";
const UNCERTAIN: &str = "[uncertain]\nsamples = 5\n'column.width_m' = { from = 0.6, to = 1.1 }\n\
                         'ground.one_sine.duration_s' = { deviation = 0.05 }\n";

fn write(folder: &Path, parts: &[&str]) {
    fs::write(folder.join("s.toml"), parts.concat()).unwrap();
}

/// Copies the records of the suite in the scenarios.
fn write_suite(folder: &Path, more: &str) {
    fs::create_dir(folder.join("records")).unwrap();
    for name in ["wave-1.at2", "wave-2.at2"] {
        let from = scenarios().join("records").join(name);
        fs::copy(from, folder.join("records").join(name)).unwrap();
    }
    let suite = "[ground.record]\nfile = 'records/wave-1.at2'\n[suite]\nrecords = 'records/*.at2'\n\
                 peaks_g = { from = 0.3, to = 3.0, count = 4, spacing = 'logarithmic' }\n";
    write(folder, &[COLUMN, suite, more]);
}

#[test]
fn a_factor_on_a_page_is_run_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, &[COLUMN, PULSE]);
    let options = [
        "threshold",
        "s.toml",
        "--from=0.3",
        "--to=3",
        "--stride=0.2",
    ];
    let both = [&options[..], &["--hinges", "four,free"]].concat();
    let found = page(at, &both, "threshold.html", "threshold.csv");
    found.assert_histories(at);
    let models = found.one_of_each("model");
    let texts = models
        .iter()
        .map(|row| found.command(*row).contains("[free_hinges]"));
    assert_eq!(texts.collect::<Vec<_>>(), [false, true]);
    assert!(
        found
            .html
            .contains("<h1>A column &amp; &lt;b&gt;more&lt;/b&gt;</h1>")
    );
    assert_eq!(
        found.html.matches("&lt;b&gt;more").count(),
        2,
        "title and heading"
    );
    open_in_a_browser(&found, &at.join("o/threshold.html"));
    // Both scales of records, and no page.
    write_suite(at, "");
    for scale in ["", "--set=ground.record.peak_g=0.5"] {
        let set = if scale.is_empty() { &[][..] } else { &[scale] };
        let again = [&options[..], set].concat();
        page(at, &again, "threshold.html", "threshold.csv").assert_histories(at);
    }
    printed_without(at, &options, "threshold.html");
}

#[test]
fn a_value_of_a_threshold_is_computed_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, &[COLUMN, PULSE]);
    let options = [
        "threshold",
        "s.toml",
        "--from=0.3",
        "--to=2",
        "--stride=0.1",
    ];
    // A column without width is no valid structure, and the widest survives all factors.
    let along = [&options[..], &["--along", "column.width_m=0..1.8:4"]].concat();
    let found = page(at, &along, "threshold_along.html", "threshold_along.csv");
    assert_eq!(found.rows[0]["why_not"], "invalid");
    assert!(found.data["cases"][0]["text"].is_null());
    for row in [1, 3] {
        let summary = &found.run(at, row, "--format json")["models"][0];
        for (key, column) in [
            ("lowest_factor", "overturns_from_factor"),
            ("survives_up_to_factor", "survives_up_to_factor"),
        ] {
            match summary[key].as_f64() {
                Some(factor) => {
                    let known = found.rows[row].number(column);
                    assert!((factor / known - 1.0).abs() < 2e-4, "{factor} {known}");
                }
                None => assert_eq!(found.rows[row][column], ""),
            }
        }
    }
    let marks = ["unknown", "overturns", "survives"];
    let legend = marks.map(|mark| found.data["legend"].to_string().contains(mark));
    assert_eq!(legend, [true; 3], "{}", found.data["legend"]);
    let valid = [&options[..], &["--along", "column.width_m=0.6..1.8:3"]].concat();
    let found = page(at, &valid, "threshold_along.html", "threshold_along.csv");
    open_in_a_browser(&found, &at.join("o/threshold_along.html"));
    printed_without(at, &along, "threshold_along.html");
}

/// The peaks of suites and of samples, each with the case that has it.
#[test]
fn a_peak_of_several_models_is_computed_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write_suite(at, "");
    let suite = ["suite", "s.toml", "--hinges", "four,free"];
    let samples = ["run", "s.toml", "--hinges", "four,free"];
    for (options, more) in [(&suite[..], ""), (&samples[..], UNCERTAIN)] {
        if !more.is_empty() {
            write(at, &[COLUMN, PULSE, more]);
        }
        let found = page(at, options, "models/peaks.html", "models/peaks.csv");
        let models = found.one_of_each("model");
        assert_eq!(models.len(), 2);
        let last = found.rows.len() - 1;
        for (row, table) in [
            (0, "four_hinges"),
            (models[1] - 1, "four_hinges"),
            (last, "free_hinges"),
        ] {
            let summary = found.run(at, row, "--format json");
            let peak_rad = summary["largest_peak_rotation_rad"].as_f64().unwrap();
            let known_rad = found.rows[row].number("peak_rotation_rad");
            assert!(
                (peak_rad / known_rad - 1.0).abs() < 1e-6,
                "{options:?} {row}: {peak_rad} {known_rad}"
            );
            let is_free = found.command(row).contains("[free_hinges]");
            assert_eq!(is_free, table == "free_hinges");
        }
    }
    fs::remove_dir_all(at.join("o")).unwrap();
    let output = archrock(at, &[&samples[..], &["--out", "o", "--no-report"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(at.join("o/models/peaks.csv").exists() && !at.join("o/models/peaks.html").exists());
}

/// Moves over the cases of a page, on a wide and on a narrow screen, and prints it.
fn open_in_a_browser(found: &Page, page: &Path) {
    let rows = 0..found.rows.len();
    let commands: Vec<String> = rows.map(|row| found.command(row)).collect();
    let script = include_str!("studies.js");
    let data = json!({ "commands": commands }).to_string();
    for settings in [
        &["--window-size=1280,900"][..],
        &["--window-size=390,900", "--force-dark-mode"],
    ] {
        browser::assert_checked(page, script, &data, settings, 30);
    }
    assert!(browser::sheets(page).is_none_or(|sheets| sheets == 1));
}

/// A study without its page has all other files.
fn printed_without(folder: &Path, options: &[&str], page: &str) {
    let before: BTreeSet<String> = crate::common::program::names(&folder.join("o"))
        .into_iter()
        .collect();
    let output = archrock(folder, &[options, &["--out", "o", "--no-report"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let mut after: BTreeSet<String> = crate::common::program::names(&folder.join("o"))
        .into_iter()
        .collect();
    assert!(after.insert(page.to_owned()) && after == before);
}

/// Numbers of a table are rounded, and text is not, although it may look like a number.
#[test]
fn a_record_named_like_a_number_keeps_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let (at, name) = (folder.path(), "00123456789");
    let record = scenarios().join("records/wave-1.at2");
    fs::copy(record, at.join(name)).unwrap();
    let suite = format!("[suite]\nrecords = '{name}'\nformat = 'at2'\npeaks_g = [0.3, 1.0]\n");
    write(at, &[COLUMN, &suite]);
    let found = page(at, &["suite", "s.toml"], "suite.html", "suite.csv");
    let table = &found.data["tables"][0];
    assert_eq!(table["header"][0], "record");
    for row in table["rows"].as_array().unwrap() {
        assert_eq!(row[0], name);
    }
    assert!(found.html.contains(&format!("<td>{name}</td>")));
}

#[test]
fn a_record_that_acts_once_is_run_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write_suite(at, "");
    let text = fs::read_to_string(at.join("s.toml")).unwrap();
    let levels = |line: &&str| line.starts_with("peaks_g") || line.starts_with("scales");
    let as_they_are: Vec<&str> = text.lines().filter(|line| !levels(line)).collect();
    fs::write(at.join("s.toml"), as_they_are.join("\n")).unwrap();
    let found = page(at, &["suite", "s.toml"], "suite.html", "suite.csv");
    found.assert_histories(at);
}

#[test]
fn a_case_of_a_suite_is_run_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // A load beside the axis: mirrored records are cases of their own.
    write_suite(at, "[[load]]\nmass_kg = 800.0\nx_m = 0.2\n");
    let found = page(at, &["suite", "s.toml"], "suite.html", "suite.csv");
    found.assert_histories(at);
    // The column falls to the other side under a mirrored record.
    let falls = |sign: &str| {
        let mut rows = found.rows.iter().enumerate();
        let own = rows.find(|(_, row)| row["sign"] == sign && row["outcome"] == "overturned");
        let (index, row) = own.unwrap();
        let summary = found.run(at, index, "--format json");
        assert_eq!(summary["overturning_sway"], row["overturning_sway"]);
        row["overturning_sway"].clone()
    };
    assert_ne!(falls("1"), falls("-1"));
    assert!(
        found
            .html
            .contains("to be entered in the folder of the scenario file")
    );
    // Parts keep what the page needs.
    for part in ["1/2", "2/2"] {
        printed(at, &["suite", "s.toml", "--shard", part, "--out", "p"]);
    }
    fs::rename(at.join("records"), at.join("moved")).unwrap();
    printed(
        at,
        &[
            "merge",
            "p/suite-1-of-2.part",
            "p/suite-2-of-2.part",
            "--out",
            "m",
        ],
    );
    assert!(fs::read_to_string(at.join("m/suite.html")).unwrap() == found.html);
}

#[test]
fn a_sample_is_computed_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, &[COLUMN, PULSE, UNCERTAIN]);
    let of_kind = |command: &[&str], folder: &str| {
        let [html, table] = ["html", "csv"].map(|end| format!("{folder}/samples.{end}"));
        page(at, command, &html, &table)
    };
    of_kind(&["run", "s.toml"], "uncertain").assert_histories(at);
    let factors = ["--from", "0.3", "--to", "3", "--stride", "0.1"];
    let options = [&["threshold", "s.toml"], &factors[..]].concat();
    let found = of_kind(&options, "uncertain_threshold");
    for row in [0, 3] {
        let summary = found.run(at, row, "--format json");
        let factor = summary["models"][0]["lowest_factor"].as_f64().unwrap();
        let known = found.rows[row].number("first_factor");
        assert!((factor / known - 1.0).abs() < 2e-4, "{factor} {known}");
    }
    let widths = "both_signs = false\n[uncertain]\nsamples = 5\n'column.width_m' = { from = 0.6, to = 1.1 }\n";
    write_suite(at, widths);
    let found = of_kind(&["suite", "s.toml"], "uncertain_suite");
    for row in [0, 2] {
        found.run(at, row, "--format json");
        let capacities = Table::read(at.join("case/capacities.csv")).rows;
        let overturned = capacities
            .iter()
            .filter(|row| !row["scale"].is_empty())
            .count();
        assert_eq!(found.rows[row]["overturned"], overturned.to_string());
    }
}

#[test]
fn a_stage_of_a_moved_springing_is_computed_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, &[ARCH]);
    let found = page(at, &["spread", "s.toml"], "spread.html", "spread.csv");
    for index in found.one_of_each("angle_deg") {
        let row = &found.rows[index + 10];
        let summary = found.run(at, index + 10, "--format json");
        for side in ["right", "left"] {
            let push_g = summary["capacity_g"][side].as_f64().unwrap();
            let known_g = row.number(&format!("capacity_{side}_g"));
            assert!((push_g - known_g).abs() < 1e-9, "{row:?} {summary}");
        }
    }
}

#[test]
fn a_capacity_curve_is_computed_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, &[ARCH]);
    let options = ["capacity", "s.toml", "--point", "-1,4.8"];
    let found = page(at, &options, "capacity.html", "capacity.csv");
    found.run(at, 3, "--format json");
    let again = Table::read(at.join("case/capacity.csv"));
    assert_eq!(again.rows, found.rows);
}

/// A ring, a row of blocks, a row with a tie, a column, and an arch on a moved springing, which no four links describe.
#[test]
fn hinges_of_limit_analysis_are_marked() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let ring = "[arch]\nembrace_deg = 157.5\nmean_radius_m = 5.0\nthickness_ratio = 0.2\n";
    let tie = "[[tie]]\nheight_m = 2.0\narea_mm2 = 300.0\nmodulus_gpa = 210.0\n";
    let moved = "[supports]\nright = { spread_m = 0.02 }\n";
    for (parts, pictures) in [
        (&[ring][..], 2),
        (&[ARCH], 2),
        // The scenario of a page gives every default.
        (&[ARCH, "density_kg_m3 = 2000.0\n", tie], 0),
        (&[COLUMN], 0),
        (&[ARCH, moved], 0),
    ] {
        write(at, parts);
        let printed = archrock(at, &["limit", "s.toml", "--format", "json"]);
        assert!(printed.status.success(), "{}", stderr(&printed));
        let known: Value = serde_json::from_slice(&printed.stdout).unwrap();
        let found = page(at, &["limit", "s.toml"], "limit.html", "");
        assert_eq!(json(&at.join("o/limit.json")), known);
        assert_eq!(found.run(at, 0, "--format json"), known);
        let more = found.html.matches("<div class=\"picture\"><svg").count();
        assert_eq!(more, pictures, "{parts:?}");
        // The words of a mark have the place of its hinge, and marks to the left are the mirror image of those to the right.
        let spots = found.html.split("<g class=\"spot hinge\"").skip(1);
        let spots: Vec<&str> = spots.collect();
        let sides = ["right", "left"].map(|side| known["mechanism"][side].as_array().unwrap());
        let hinges: Vec<&Value> = sides.into_iter().flatten().collect();
        assert!(hinges.len() > 1);
        let of_legend = 1;
        assert_eq!(spots.len(), of_legend + 2 * hinges.len());
        for (hinge, spot) in hinges.iter().zip(&spots[of_legend..]) {
            if let Some(x_m) = hinge["x_m"].as_f64() {
                let y_m = hinge["y_m"].as_f64().unwrap();
                assert!(spot.contains(&format!("({x_m:.5}, {y_m:.5}) m")), "{spot}");
            }
        }
        let x_px = |index: usize| -> f64 {
            let after = spots[of_legend + index].split_once("translate(").unwrap().1;
            after.split_once(' ').unwrap().0.parse().unwrap()
        };
        let middles = (0..sides[0].len()).map(|index| x_px(index) + x_px(hinges.len() - 1 - index));
        let middles: Vec<f64> = middles.collect();
        let is_symmetric = parts.len() == 1;
        let is_mirrored = middles.iter().all(|sum| (sum - middles[0]).abs() < 0.03);
        assert!(is_mirrored || !is_symmetric, "{middles:?}");
    }
    // A column 0.8 m wide and 4 m high starts at b/h, and turns about its toes; without hinges the command remains.
    write(at, &[COLUMN]);
    let found = page(at, &["limit", "s.toml"], "limit.html", "");
    let verdict = found.html.split_once("<p id=\"outcome\">").unwrap().1;
    let verdict = verdict.split_once("</p>").unwrap().0;
    assert!(verdict.contains("0.20000000 g"), "{verdict}");
    assert!(found.html.contains("right, (0.40000, ") && found.html.contains("left, (-0.40000, "));
    let flat = "[arch]\nspan_m = 9.0\nrise_m = 0.3\nthickness_m = 1.0\nmeasured_at = \"mean\"\nvoussoirs = 9\n[free_hinges]\n";
    write(at, &[flat]);
    let output = archrock(at, &["limit", "s.toml", "--out", "flat"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let html = fs::read_to_string(at.join("flat/limit.html")).unwrap();
    assert!(
        html.contains("<p id=\"outcome\">no push to the right moves it without sliding: a straight line fits into it")
    );
    assert!(!html.contains("spot hinge"));
    assert_eq!(data_of(&html)["cases"].as_array().unwrap().len(), 1);
    // Without a folder nothing is written.
    let before = fs::read_dir(at).unwrap().count();
    assert!(archrock(at, &["limit", "s.toml"]).status.success());
    assert_eq!(fs::read_dir(at).unwrap().count(), before);
}

#[test]
fn a_compared_model_is_run_by_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, &[ARCH, PULSE]);
    let options = [
        "run",
        "s.toml",
        "--hinges",
        "four,free",
        "--set",
        "ground.one_sine.amplitude_g=0.3",
    ];
    let found = page(at, &options, "report.html", "");
    for (index, model) in ["four", "free"].into_iter().enumerate() {
        let summary = found.run(at, index, "--format json");
        let own = json(&at.join("o").join(model).join("summary.json"));
        assert_eq!(summary["outcome"], own["outcome"]);
        assert_eq!(summary["peak_rotations_rad"], own["peak_rotations_rad"]);
    }
}
