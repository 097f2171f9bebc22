//! Suites of records: rows compared with runs of the same scenario, parts with the whole, and the messages if
//! there is no curve.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use crate::common::program::{done, refused, scenarios};
use crate::common::prose::{golden, shows};
use crate::common::results::{Row, Table, json, named, texts};
use crate::common::{ON_A_PIER, UNEVEN_ARCH, pairs};
use archrock::dynamics::repeatability::OutcomeCount;
use archrock::dynamics::{Direction, Outcome};
use archrock::mechanics::Sway;
use archrock::output::Figure;
use archrock::scenario::{Format, Layout, Measure, Scenario};
use archrock::studies::suite::{CaseRow, SuiteFragility};
use archrock::studies::suite::{Heading, efficiencies};
use archrock::studies::threshold::VerdictRange;
use archrock::studies::{Ending, NoHistory, Steps, Verdict};
use roxmltree::Document;
use serde_json::Value;

const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[simulation]\nduration_s = 30.0\n";
const ARCH: &str = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n\
                    [simulation]\nduration_s = 30.0\n";
const FILES: [&str; 11] = [
    "suite.html",
    "suite.svg",
    "ida.svg",
    "peaks.svg",
    "ida.csv",
    "peaks.csv",
    "capacities.csv",
    "intensity.csv",
    "fragility.csv",
    "fragility.json",
    "suite.csv",
];

/// A folder with the first records of the repository, one of them also as a table in cm/s2.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let records = folder.path().join("records");
    fs::create_dir(&records).unwrap();
    for name in ["wave-1.at2", "wave-2.at2", "wave-6.at2"] {
        fs::copy(scenarios().join("records").join(name), records.join(name)).unwrap();
    }
    let mut table = String::from("t;up;a\n");
    for (time_s, acceleration_g) in samples(&records.join("wave-1.at2")) {
        // The table begins before time zero.
        table += &format!("{};0;{}\n", time_s - 1.0, 0.7 * acceleration_g);
    }
    fs::write(folder.path().join("north, \"old\".csv"), table).unwrap();
    folder
}

fn samples(path: &Path) -> Vec<(f64, f64)> {
    let layout = Layout::new(Format::AT2);
    layout.parse(&fs::read(path).unwrap()).unwrap().samples
}

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).unwrap();
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

fn rows(folder: &Path) -> Vec<Row> {
    let table = Table::read(folder.join("suite.csv"));
    let columns = "record,sign,scale,peak_g,outcome,overturning_sway,impacts,impacts_before_overturning,\
                   outcome_time_s,peak_rotation_over_critical,energy_defect_ratio,thrust_excess_ratio,friction_demand,\
                   peak_velocity_m_s,spectral_acceleration_g,arias_m_s";
    assert_eq!(table.header.join(","), columns);
    table.rows
}

/// Two records and a table, multiplied by factors or scaled to peaks.
fn mixed(levels: &str) -> String {
    format!(
        "{COLUMN}[suite]\nrecords = ['records/wave-[12].at2', 'north, \"old\".csv']\n\
         acceleration_column = 'a'\nunit = 'g'\n{levels}\n"
    )
}

/// Mirrored records of a column beside a wall are records with negative factors. A column alone is symmetric and has no such rows.
#[test]
fn rows_of_a_suite_equal_single_runs() {
    let folder = folder();
    let folder = folder.path();
    let wall = "[column.back]\nside = 'left'\nheight_m = 4.0\n";
    for (levels, more, signs) in [
        ("scales = [0.5, 1.5, 4.0]", "", 1),
        ("peaks_g = [0.15, 0.45, 1.2]", "", 1),
        ("scales = [0.5, 1.5, 4.0]", wall, 2),
        ("peaks_g = [0.15, 0.45, 1.2]", wall, 2),
    ] {
        write(folder, "s.toml", &format!("{}{more}", mixed(levels)));
        done(folder, &["suite", "s.toml", "--out", "o", "--quiet"]);
        let rows = rows(&folder.join("o"));
        assert_eq!(rows.len(), 3 * signs * 3);
        assert!(rows.iter().any(|row| row["outcome"] == "overturned"));
        assert!(rows.iter().any(|row| row["outcome"] == "rest"));
        for row in rows.iter().step_by(4).chain(rows.last()) {
            let signed = row.number(1) * row.number(2);
            let table = if row[0].ends_with(".csv") {
                "acceleration_column = 'a'\nunit = 'g'\nstart_s = 1.0\n"
            } else {
                ""
            };
            let file = &row[0];
            let text = format!(
                "{COLUMN}direction = 'as_given'\n[ground.record]\nfile = '{file}'\nscale = {signed:?}\n{table}{more}"
            );
            write(folder, "run.toml", &text);
            done(folder, &["run", "run.toml", "--out", "r", "--quiet"]);
            let run = json(&folder.join("r/summary.json"));
            assert_eq!(run["outcome"], row[4]);
            assert_eq!(
                run["overturning_sway"].as_str().unwrap_or_default(),
                &row[5]
            );
            assert_eq!(run["impacts"].to_string(), row[6]);
            // Scaling to a peak in g multiplies in another order.
            let time_s = run["outcome_time_s"].as_f64().unwrap();
            assert!((time_s - row.number(8)).abs() < 1e-6, "{row:?} {time_s}");
            let peak_g = samples_of(folder, file)
                .iter()
                .map(|s| s.1.abs())
                .fold(0.0, f64::max);
            let peak_g = peak_g * signed.abs();
            assert!((peak_g / row.number(3) - 1.0).abs() < 1e-14, "{row:?}");
            // Slenderness 0.8 / 4: the critical rotation is its angle.
            let rotation = run["peak_rotation_rad"].as_f64().unwrap() / 0.2_f64.atan();
            if row[4] != "overturned" {
                assert!(
                    (rotation - row.number(9)).abs() < 1e-6,
                    "{row:?} {rotation}"
                );
            }
        }
    }
}

/// Samples of a record of `folder()`, in g.
fn samples_of(folder: &Path, file: &str) -> Vec<(f64, f64)> {
    if file.ends_with(".at2") {
        return samples(&folder.join(file));
    }
    let text = read(&folder.join(file));
    let numbers =
        |line: &str| -> Vec<f64> { line.split(';').map(|cell| cell.parse().unwrap()).collect() };
    let lines = text.lines().skip(1).map(numbers);
    lines.map(|cells| (cells[0], cells[2])).collect()
}

/// In both directions a suite has the rows of each, unless a motion and its mirror image repeat to the last bit. The older key `both_signs` names the
/// same directions.
#[test]
fn a_suite_in_both_directions_has_the_rows_of_each() {
    let folder = folder();
    let folder = folder.path();
    let uneven = format!("{UNEVEN_ARCH}{ON_A_PIER}[simulation]\nduration_s = 30.0\n");
    for (structure, has_second) in [(COLUMN, false), (ARCH, false), (&*uneven, true)] {
        let rows_of = |name: &str, [direction, signs]: [&str; 2]| {
            let text = format!(
                "{structure}{direction}[suite]\nrecords = 'records/*.at2'\nscales = [0.5, 1.5, 3.0, 6.0]\n{signs}"
            );
            write(folder, "s.toml", &text);
            let out = format!("{name}-{}", structure.len());
            done(folder, &["suite", "s.toml", "--out", &out, "--quiet"]);
            rows(&folder.join(out))
        };
        let [both, given, mirrored] = ["both", "as_given", "mirrored"]
            .map(|name| rows_of(name, [&format!("direction = '{name}'\n"), ""]));
        assert_eq!(rows_of("default", ["", ""]), both);
        assert_eq!(rows_of("signs", ["", "both_signs = true\n"]), both);
        assert_eq!(rows_of("sign", ["", "both_signs = false\n"]), given);
        let signs = |rows: &[Row]| -> BTreeSet<String> {
            rows.iter().map(|row| row["sign"].clone()).collect()
        };
        assert_eq!(signs(&mirrored), BTreeSet::from(["-1".to_owned()]));
        if has_second {
            let of = |sign: &str| -> Vec<Row> {
                let rows = both.iter().filter(|row| row["sign"] == sign);
                rows.cloned().collect()
            };
            assert_eq!((of("1"), of("-1")), (given.clone(), mirrored.clone()));
            assert!(
                pairs(&given, &mirrored).any(|(one, other)| one["outcome"] != other["outcome"])
            );
            continue;
        }
        assert_eq!(both, given);
        let mut overturned = 0;
        for (row, mirrored) in pairs(&given, &mirrored) {
            // They agree to the last bit: no step distinguishes left from right.
            for column in [0, 2, 3, 4, 6, 7, 8, 9, 10] {
                assert_eq!(row[column], mirrored[column]);
            }
            if row[4] == "overturned" {
                overturned += 1;
                assert_ne!(row[5], mirrored[5]);
            }
        }
        assert!(overturned > 0);
    }
}

#[test]
fn the_curve_is_the_fit_of_the_rows() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenarios().join("column-suite.toml");
    let said = done(folder.path(), &["suite", file.to_str().unwrap()]);
    let results = folder.path().join("results/column-suite");
    let rows = rows(&results);
    let fragility = json(&results.join("fragility.json"));
    let levels = Table::read(results.join("fragility.csv"));
    assert_eq!(levels.header[0], "peak_g");
    let levels = levels.rows;
    assert_eq!((rows.len(), levels.len()), (160, 20));
    let median = fragility["median"].as_f64().unwrap();
    let mut log_likelihood = 0.0;
    for level in &levels {
        let at = rows
            .iter()
            .filter(|row| row[1] == "1" && row[3] == level[0]);
        let at: Vec<_> = at.collect();
        let overturned = at.iter().filter(|row| row[4] == "overturned").count();
        assert_eq!(level[1], at.len().to_string());
        assert_eq!(level[2], overturned.to_string());
        for none in ["still_rocking", "incomplete", "failed"] {
            assert_eq!(&level[none], "0");
        }
        let (overturned, all) = (overturned as f64, at.len() as f64);
        assert_eq!(level.number("fraction"), overturned / all);
        let [p, low, high] = ["probability", "probability_low", "probability_high"]
            .map(|column| level.number(column));
        assert!(0.0 < low && low < p && p < high && high < 1.0);
        assert_eq!(level.number(0) < median, p < 0.5);
        log_likelihood += overturned * p.ln() + (all - overturned) * (1.0 - p).ln();
    }
    let expected = fragility["log_likelihood"].as_f64().unwrap();
    // Probabilities near one keep fewer digits of their complements.
    assert!(
        (log_likelihood / expected - 1.0).abs() < 1e-9,
        "{log_likelihood} {expected}"
    );
    assert_eq!(fragility["no_fit"], Value::Null);
    assert_eq!(fragility["records"], 8);
    assert_eq!(fragility["cases"], 160);
    assert_eq!(fragility["intensity"], "peak_g");
    for key in ["median", "dispersion"] {
        let error = |which: &str| fragility[&format!("{key}_{which}")].as_f64().unwrap();
        let plain = error("standard_error");
        let by_record = error("standard_error_by_record");
        let value = fragility[key].as_f64().unwrap();
        assert!(plain > 0.0 && by_record > 0.0 && plain < value && by_record < value);
    }
    shows(&said, &[160.0, fragility["median"].as_f64().unwrap()]);
    golden("suite", &said);
    // The printed output has the edges of capacities.csv, and states where no edge was searched for.
    let capacities = Table::read(results.join("capacities.csv")).rows;
    for capacity in &capacities {
        let record = format!("  {}: ", &capacity["record"]);
        let line = said.lines().find(|line| line.starts_with(&record));
        shows(line.unwrap(), &[capacity.number("peak_g")]);
    }
    // The ranking of measures comes with its intervals: that of the factor on the peak is that of the chi-square distribution, from its table.
    let measures = Table::read(results.join("intensity.csv")).rows;
    let shares: f64 = measures.iter().map(|row| row.number("best_share")).sum();
    assert!((shares - 1.0).abs() < 1e-9, "{shares}");
    for (row, json) in measures
        .iter()
        .zip(fragility["intensity_measures"].as_array().unwrap())
    {
        let own = row.number("dispersion_of_factor");
        let [low, high] =
            ["low", "high"].map(|end| row.number(&*format!("dispersion_of_factor_{end}")));
        assert!(low < own && own < high, "{row:?}");
        assert_eq!(json["dispersion_of_factor_interval"][1], high);
        assert!(
            said.contains(&format!(" {own:.2} ({low:.2} to {high:.2})")),
            "{said}"
        );
    }
    let peaks: Vec<f64> = capacities
        .iter()
        .map(|row| row.number("peak_g").ln())
        .collect();
    let mean = peaks.iter().sum::<f64>() / 8.0;
    let squares: f64 = peaks.iter().map(|one| (one - mean).powi(2)).sum();
    let ends = [16.012_764, 1.689_869].map(|chi_square: f64| (squares / chi_square).sqrt());
    let peak = measures
        .iter()
        .find(|row| &row["measure"] == "peak_g")
        .unwrap();
    for (end, known) in ["low", "high"].into_iter().zip(ends) {
        let found = peak.number(&*format!("dispersion_of_factor_{end}"));
        assert!((found / known - 1.0).abs() < 1e-5, "{end} {found} {known}");
    }
    let picture = read(&results.join("suite.svg"));
    let picture = Document::parse(&picture).unwrap();
    let named = |name| named(&picture, name).len();
    assert_eq!((named("fraction"), named("fit"), named("band")), (20, 1, 1));
}

#[test]
fn the_records_of_the_repository_match_their_description() {
    for k in 1..=8_u32 {
        let frequency_hz = 0.6 + 0.1 * f64::from(k);
        let wave = |t: f64| {
            let sum: f64 = (1..=25)
                .map(f64::from)
                .map(|j| {
                    let phase = frequency_hz * t * j / 10.0 + j * j * f64::from(k + 1).sqrt();
                    (-((j - 10.0) / 5.0).powi(2)).exp() * (2.0 * PI * phase).cos()
                })
                .sum();
            (t / 1.5).powi(2) * (2.0 - 2.0 * t / 1.5).exp() * sum
        };
        let record = samples(&scenarios().join(format!("records/wave-{k}.at2")));
        let peak = record.iter().map(|s| wave(s.0).abs()).fold(0.0, f64::max);
        for (time_s, acceleration_g) in record {
            // Samples are written with seven digits.
            assert!((acceleration_g - 0.3 / peak * wave(time_s)).abs() < 1e-7);
        }
    }
}

#[test]
fn patterns_and_lists_are_the_same_suite() {
    let folder = folder();
    let folder = folder.path();
    fs::write(folder.join("records/.hidden.at2"), "no record").unwrap();
    fs::create_dir(folder.join("records/folder.at2")).unwrap();
    let suites = [
        "'records/*.at2'",
        "['./records/wave-6.at2', 'records/*.at2', 'records/wave-1.at2']",
        "['records/wave-6.at2', 'records/wave-1.at2', 'records/wave-2.at2']",
        "['*/wave-?.at2']",
    ];
    for (index, records) in suites.iter().enumerate() {
        let text = format!("{COLUMN}[suite]\nrecords = {records}\nscales = [1.0, 3.0]\n");
        write(folder, "s.toml", &text);
        let out = format!("o{index}");
        // Called from another folder: files are relative to the scenario.
        fs::create_dir_all(folder.join("elsewhere")).unwrap();
        let arguments = [
            "suite",
            "../s.toml",
            "--out",
            &format!("../{out}"),
            "--quiet",
        ];
        done(&folder.join("elsewhere"), &arguments);
        for file in FILES {
            assert_eq!(
                read(&folder.join(&out).join(file)),
                read(&folder.join("o0").join(file))
            );
        }
    }
    assert_eq!(rows(&folder.join("o0")).len(), 3 * 2);

    // The same files under other names count once.
    let records = "['records/*.at2', 'records/../records/*.at2']";
    let text = format!("{COLUMN}[suite]\nrecords = {records}\nscales = [1.0, 3.0]\n");
    write(folder, "s.toml", &text);
    done(folder, &["suite", "s.toml", "--out", "again", "--quiet"]);
    assert_eq!(rows(&folder.join("again")), rows(&folder.join("o0")));
}

#[test]
fn resolved_scenarios_read_back_the_same() {
    let folder = folder();
    let folder = folder.path();
    // A name that is a pattern, which would match another file.
    fs::copy(folder.join("records/wave-1.at2"), folder.join("[x]*.at2")).unwrap();
    fs::copy(folder.join("records/wave-1.at2"), folder.join("x1.at2")).unwrap();
    for text in [
        mixed("scales = [1, 2]\nboth_signs = false"),
        mixed("peaks_g = { from = 0.1, to = 1, count = 3, spacing = 'logarithmic' }"),
        format!("{COLUMN}[suite]\nrecords = '[x]*.at2'\nformat = 'at2'\nscales = [2]\n"),
    ] {
        write(folder, "s.toml", &text);
        let scenario = Scenario::read(&folder.join("s.toml")).unwrap();
        write(folder, "t.toml", &scenario.to_toml());
        assert_eq!(
            Scenario::read(&folder.join("t.toml")),
            Ok(scenario),
            "{text}"
        );
    }
    let text = read(&folder.join("t.toml"));
    assert!(
        text.contains("records = [\n    \"[x]*.at2\",\n]\nformat = \"at2\"\n"),
        "{text}"
    );
}

#[test]
fn parts_merge_to_the_same_files_without_the_records() {
    let folder = folder();
    let folder = folder.path();
    write(
        folder,
        "s.toml",
        &format!(
            "title = 'parts'\n{}",
            mixed("peaks_g = { from = 0.2, to = 2, count = 5, spacing = 'logarithmic' }")
        ),
    );
    let whole = done(
        folder,
        &["suite", "s.toml", "--out", "whole", "--threads", "1"],
    );
    for shard in ["1/3", "2/3", "3/3"] {
        done(
            folder,
            &[
                "suite", "s.toml", "--out", "parts", "--shard", shard, "--quiet",
            ],
        );
    }
    // A killed program leaves a torn last line.
    let part = folder.join("parts/suite-2-of-3.part");
    let complete = read(&part);
    fs::write(&part, &complete[..complete.len() - 30]).unwrap();
    let parts: Vec<String> = (1..=3)
        .map(|i| format!("parts/suite-{i}-of-3.part"))
        .collect();
    let mut merge = vec!["merge", "--out", "merged"];
    merge.extend(parts.iter().map(String::as_str));
    let said = refused(folder, &merge, &[]);
    assert!(
        said.contains("finish it with --shard 2/3 --resume"),
        "{said}"
    );
    done(
        folder,
        &[
            "suite", "s.toml", "--out", "parts", "--shard", "2/3", "--resume", "--quiet",
        ],
    );
    fs::remove_dir_all(folder.join("records")).unwrap();
    fs::remove_file(folder.join("s.toml")).unwrap();
    let merged = done(folder, &merge);
    for file in FILES {
        assert_eq!(
            read(&folder.join("merged").join(file)),
            read(&folder.join("whole").join(file))
        );
    }
    assert_eq!(whole.replace("whole", "merged"), merged);
    let names = crate::common::program::result_names(&folder.join("whole"));
    assert_eq!(names.len(), FILES.len());

    let damaged = read(&folder.join(&parts[0])).replace("\"mirrored\":false", "\"mirrored\":true");
    write(folder, &parts[0], &damaged);
    refused(folder, &merge, &["damaged"]);
}

#[test]
fn a_part_with_other_records_is_not_resumed() {
    let folder = folder();
    let folder = folder.path();
    let text = format!("{COLUMN}[suite]\nrecords = 'records/*.at2'\nscales = [1.0, 3.0]\n");
    write(folder, "s.toml", &text);
    let arguments = [
        "suite", "s.toml", "--out", "o", "--shard", "1/2", "--resume", "--quiet",
    ];
    done(folder, &arguments);
    // The title of a record is not part of its samples.
    let record = folder.join("records/wave-2.at2");
    let original = read(&record);
    fs::write(
        &record,
        original.replace("NO REAL EARTHQUAKE", "STILL NONE"),
    )
    .unwrap();
    done(folder, &arguments);
    let sample = original
        .lines()
        .nth(40)
        .unwrap()
        .split_whitespace()
        .next()
        .unwrap();
    fs::write(&record, original.replace(sample, "1.234567E-02")).unwrap();
    let said = refused(folder, &arguments, &[]);
    assert!(
        said.contains("other contents of records/wave-2.at2"),
        "{said}"
    );
    fs::write(&record, &original).unwrap();
    fs::copy(&record, folder.join("records/wave-3.at2")).unwrap();
    let said = refused(folder, &arguments, &[]);
    assert!(said.contains(": no records/wave-3.at2"), "{said}");
}

#[test]
fn without_a_fragility_curve_the_reason_is_reported() {
    let folder = folder();
    let folder = folder.path();
    for (scales, never, always) in [
        ("[1.5, 2.0]", None, None),
        ("[0.1, 0.2]", Some("records/wave-1.at2"), None),
        ("[4, 5.5]", None, Some("records/wave-1.at2")),
    ] {
        let text = format!(
            "{COLUMN}[suite]\nrecords = 'records/wave-1.at2'\nscales = {scales}\nboth_signs = false\n"
        );
        write(folder, "s.toml", &text);
        let said = done(folder, &["suite", "s.toml", "--out", "o"]);
        let fragility = json(&folder.join("o/fragility.json"));
        let reason = fragility["no_fit"].as_str().unwrap();
        assert!(said.contains(reason), "{said}");
        for key in [
            "median",
            "dispersion_standard_error",
            "median_standard_error_by_record",
            "log_likelihood",
        ] {
            assert_eq!(fragility.get(key), Some(&Value::Null), "{key}");
        }
        let list = |name: Option<&str>| Value::from(name.into_iter().collect::<Vec<_>>());
        assert_eq!(fragility["records_that_never_overturn"], list(never));
        assert_eq!(fragility["records_that_always_overturn"], list(always));
        let line = said.lines().find(|line| line.contains("wave-1.at2: "));
        if never.is_some() {
            shows(line.unwrap(), &[0.2]);
        }
        // Below the lowest level, the edge is searched down to the onset.
        if always.is_some() {
            let edge = Table::read(folder.join("o/capacities.csv")).numbers("scale")[0];
            shows(line.unwrap(), &[edge]);
            let both = format!("[{}, {edge}]", edge / 1.0021);
            write(folder, "edge.toml", &text.replace(scales, &both));
            done(folder, &["suite", "edge.toml", "--out", "e"]);
            let rows = Table::read(folder.join("e/suite.csv")).rows;
            let outcomes: Vec<&str> = rows.iter().map(|row| &*row["outcome"]).collect();
            assert_eq!(outcomes, ["rest", "overturned"], "{edge}");
        }
        let picture = read(&folder.join("o/suite.svg"));
        // The picture wraps it.
        let (begins, _) = reason.split_once(' ').unwrap();
        assert!(picture.contains(&format!("{begins} ")), "{picture}");
        assert!(!picture.contains("data-name=\"fit\""));
        let levels = read(&folder.join("o/fragility.csv"));
        assert!(
            levels.lines().skip(1).all(|line| line.contains(",,,,")),
            "{levels}"
        );
    }
}

/// Results from rows given by record, level and outcome, if there is one.
fn results(rows: &[(&str, f64, Option<Outcome>)]) -> SuiteFragility {
    let rows = rows.iter().map(|(record, scale, outcome)| CaseRow {
        record: (*record).to_owned(),
        mirrored: false,
        scale: *scale,
        peak_g: 0.3 * scale,
        edge: None,
        edge_at_most: false,
        safe_below_edge: None,
        friction_below_edge: None,
        found_below: None,
        searched_from: None,
        strength: None,
        result: outcome
            .ok_or(NoHistory::Failed("it broke".to_owned()))
            .map(|outcome| Ending {
                direction: Direction::AsGiven,
                outcome,
                outcome_time_s: 1.0,
                impacts: Some(0),
                peak_over_critical: Some(0.5),
                thrust_excess_ratio: None,
                peak_rotation_rad: 0.1,
                energy_defect_ratio: 0.0,
                friction_demand: None,
                steps: None,
                safe_from_s: None,
                count: None,
            }),
    });
    SuiteFragility::new(Measure::Scale, rows.collect())
}

/// Cases of records that overturn (`x`), survive (`.`) or are uncertain (`~`, whose own history overturned), one letter per
/// level; a minus sign before a record means that it is mirrored.
fn levels_of(records: &[(&str, &str)]) -> Vec<CaseRow> {
    let case = |(record, letters): &(&str, &str)| {
        let mirrored = record.starts_with('-');
        let record = record.trim_start_matches('-').to_owned();
        let rows = letters.bytes().zip(1..).map(move |(letter, level)| {
            let side = if mirrored { Sway::Right } else { Sway::Left };
            let outcome = match letter {
                b'.' => Outcome::Rest,
                _ => Outcome::Overturned(side),
            };
            let count = (letter == b'~').then(|| OutcomeCount {
                overturns_in: 3,
                of: 7,
                ..OutcomeCount::default()
            });
            CaseRow {
                record: record.clone(),
                mirrored,
                scale: f64::from(level),
                peak_g: 0.3 * f64::from(level),
                edge: None,
                edge_at_most: false,
                safe_below_edge: None,
                friction_below_edge: None,
                found_below: None,
                searched_from: None,
                strength: None,
                result: Ok(Ending {
                    direction: Direction::AsGiven,
                    outcome,
                    outcome_time_s: 1.0,
                    impacts: Some(0),
                    peak_over_critical: None,
                    thrust_excess_ratio: None,
                    peak_rotation_rad: 0.5,
                    energy_defect_ratio: 0.0,
                    friction_demand: None,
                    steps: Some(Steps {
                        longest_s: 1e-4,
                        shortest_s: 1e-5,
                    }),
                    safe_from_s: None,
                    count,
                }),
            }
        });
        rows.collect::<Vec<_>>()
    };
    records.iter().flat_map(case).collect()
}

fn free_heading() -> Heading {
    heading_of("free")
}

/// Uncertain cases count by their fractions. If they are counted as survived or as overturned, the results equal those of suites in which they did
/// so.
#[test]
fn uncertain_cases_are_counted_by_fractions_as_surviving_and_as_overturning() {
    let with = |letter: &str| {
        let records = [
            ("a", "..~xx"),
            ("b", ".~.xx"),
            ("c", "..xx~"),
            ("d", ".xx.x"),
        ];
        let records = records.map(|(record, letters)| (record, letters.replace('~', letter)));
        let records: Vec<_> = records.iter().map(|(a, b)| (*a, b.as_str())).collect();
        SuiteFragility::new(Measure::Scale, levels_of(&records))
    };
    let (doubtful, survived, overturned) = (with("~"), with("."), with("x"));
    assert_eq!(doubtful.ends, [survived.fit, overturned.fit]);
    let medians = [&overturned, &doubtful, &survived].map(|of| of.fit.as_ref().unwrap().median);
    assert!(medians.is_sorted() && medians[0] < medians[1] && medians[1] < medians[2]);
    assert_eq!(survived.ends, [survived.fit, survived.fit]);
    assert!(doubtful.has_uncertain() && !survived.has_uncertain());
    for (level, (low, high)) in pairs(
        &doubtful.levels,
        &pairs(&survived.levels, &overturned.levels).collect::<Vec<_>>(),
    ) {
        assert_eq!(level.counts.cases, 4);
        let ends = [low.fraction().unwrap(), high.fraction().unwrap()];
        assert_eq!(level.fraction_ends(), Some(ends));
        // Uncertain cases overturn in 3 of 7 repetitions.
        let fraction = ends[0] + 3.0 / 7.0 * (ends[1] - ends[0]);
        assert!((level.fraction().unwrap() - fraction).abs() < 1e-12);
        // The band contains those of both ends.
        let [at, from, to] = level.curve.unwrap();
        let [low, high] = [low.curve.unwrap(), high.curve.unwrap()];
        assert!(from <= low[1] && low[0] <= at && at <= high[0] && high[2] <= to);
    }
    assert_eq!(doubtful.records_with(Verdict::Survives), [""; 0]);
    let survivals = doubtful.survivals();
    assert_eq!(survivals[0].1.overturns_from, Some(4.0));
    assert_eq!(survivals[0].1.survives_up_to, Some(2.0));
    let doubtful_range = VerdictRange {
        verdict: Some(Verdict::Uncertain),
        from: 3.0,
        to: 3.0,
    };
    assert_eq!(survivals[0].1.ranges[1], doubtful_range);

    let files = result_files(&free_heading(), &doubtful);
    let Table { header, rows } = Table::parse(&files["fragility.csv"]);
    assert!(
        header
            .windows(3)
            .any(|names| *names == ["uncertain", "fraction_certain", "fraction_with_uncertain"])
    );
    let counts: Vec<_> = rows
        .iter()
        .map(|row| [&row["overturned"], &row["uncertain"]])
        .collect();
    assert_eq!(
        counts,
        [["0", "0"], ["1", "1"], ["2", "1"], ["3", "0"], ["3", "1"]]
    );
    for row in &rows {
        assert!(row.number("fraction") <= row.number("fraction_with_uncertain"));
    }
    let json: Value = files["fragility.json"].parse().unwrap();
    assert_eq!(
        (&json["overturned"], &json["uncertain"]),
        (&9.into(), &3.into())
    );
    assert_eq!(json["median"], medians[1]);
    assert_eq!(json["with_uncertain_as_survived"]["median"], medians[2]);
    let with_uncertain = &json["with_uncertain_as_overturned"];
    assert_eq!(
        with_uncertain["median"],
        overturned.fit.as_ref().unwrap().median
    );
    assert_eq!(json["uncertain_cases"].as_array().unwrap().len(), 3);
    let first = &json["uncertain_cases"][0];
    assert_eq!(first["case"], "a, scale 3");
    assert_eq!(first["reason"], "overturns in 3 of 7 repetitions");
    assert_eq!(
        (&first["overturns_in"], &first["of"]),
        (&3.into(), &7.into())
    );
    assert_eq!(json["longest_step_s"]["max"], 1e-4);
    // Neither the side nor impacts before overturning are given.
    assert_eq!(files["suite.csv"].matches(",uncertain,,0,,1.0,").count(), 3);

    let named =
        |picture: &str, name: &str| picture.matches(&format!("data-name=\"{name}\"")).count();
    let picture = &files["suite.svg"];
    for name in [
        "fit",
        "fit-certain",
        "fit-with-uncertain",
        "band",
        "between",
    ] {
        assert_eq!(named(picture, name), 1, "{name}");
    }
    assert_eq!(named(picture, "uncertain"), 3);
    let picture = Document::parse(picture).unwrap();
    let words = texts(&picture).join(" ");
    assert!(
        words.contains("3 uncertain cases by their fractions"),
        "{words}"
    );
    assert_eq!(named(&files["ida.svg"], "uncertain"), 3);
    let plain = result_files(&free_heading(), &survived);
    for name in ["fit-with-uncertain", "between", "uncertain"] {
        assert_eq!(named(&plain["suite.svg"], name), 0, "{name}");
    }
}

/// Capacities that are only upper bounds have the order of the levels, and rank no measure of intensity.
#[test]
fn upper_bounds_rank_no_measure() {
    let of = |letters: [&str; 4]| {
        let records = ["a", "b", "c", "d"].into_iter().zip(letters);
        let records: Vec<(&str, &str)> = records.collect();
        SuiteFragility::new(Measure::Scale, levels_of(&records))
    };
    for (letters, bounds, ranked) in [
        (["xxx"; 4], 4, 0),
        (["xxx", "xxx", ".xx", "..x"], 2, 0),
        (["xxx", ".xx", ".xx", "..x"], 1, 1),
    ] {
        let results = of(letters);
        let capacities = results.capacities();
        let at_most = capacities.iter().filter(|one| one.at_most).count();
        assert_eq!(at_most, bounds, "{letters:?}");
        assert_eq!(efficiencies(&capacities).len(), ranked, "{letters:?}");
    }
}

/// A contradiction between `both_signs` and `direction` is refused, with the place of the older key.
#[test]
fn both_signs_may_not_contradict_the_direction() {
    let folder = folder();
    let folder = folder.path();
    let suite = "[suite]\nrecords = 'records/*.at2'\nscales = [1.0]\nboth_signs = ";
    let named = |direction: &str, signs: bool| {
        let direction = format!("direction = '{direction}'\n");
        write(
            folder,
            "s.toml",
            &format!("{COLUMN}{direction}{suite}{signs}\n"),
        );
        Scenario::read(&folder.join("s.toml"))
    };
    for (direction, signs) in [("both", false), ("mirrored", false), ("as_given", true)] {
        let errors = named(direction, signs).unwrap_err();
        let place = errors.0[0].place.unwrap();
        assert_eq!(
            (errors.0.len(), place.line),
            (1, COLUMN.lines().count() + 5)
        );
        let said = errors.to_string();
        assert!(
            said.contains(&format!("gives \"{direction}\"; leave `both_signs` out")),
            "{said}"
        );
    }
    for (direction, signs) in [("both", true), ("as_given", false)] {
        let scenario = named(direction, signs).unwrap();
        assert_eq!(scenario.simulation.direction.name(), direction);
        // The directions are written by their newer name.
        write(folder, "again.toml", &scenario.to_toml());
        let again = Scenario::read(&folder.join("again.toml")).unwrap();
        assert_eq!(again, scenario);
    }
}

/// Samples have the directions of their scenario, also by the older name `both_signs`.
#[test]
fn samples_have_the_directions_of_both_signs() {
    let folder = folder();
    let folder = folder.path();
    let capacities = |direction: &str, signs: &str| {
        let text = format!(
            "{COLUMN}{direction}[suite]\nrecords = 'records/wave-[12].at2'\nscales = [0.5, 1.5, 4.0]\n{signs}\
             [column.back]\nside = 'left'\nheight_m = 4.0\n\
             [uncertain]\nsamples = 2\n'column.width_m' = {{ from = 0.7, to = 0.9 }}\n"
        );
        write(folder, "s.toml", &text);
        done(folder, &["suite", "s.toml", "--out", "o", "--quiet"]);
        Table::read(folder.join("o/uncertain_suite/capacities.csv")).rows
    };
    let given = capacities("direction = 'as_given'\n", "");
    assert_eq!(given, capacities("", "both_signs = false\n"));
    let both = capacities("", "both_signs = true\n");
    assert_eq!(both, capacities("", ""));
    // Two records shake the scenario and both samples.
    assert_eq!((given.len(), both.len()), (3 * 2, 3 * 2 * 2));
    let mirrored = capacities("direction = 'mirrored'\n", "");
    assert_eq!(mirrored.len(), given.len());
    assert!(mirrored.iter().all(|row| row["sign"] == "-1"));
    // Each direction of both is that direction alone, for the scenario and each of its samples.
    let [own, other] = ["1", "-1"].map(|sign| {
        let rows = both.iter().filter(|row| row["sign"] == sign).cloned();
        rows.collect::<Vec<Row>>()
    });
    assert_eq!((&given, &mirrored), (&own, &other));
    let samples: BTreeSet<_> = both.iter().map(|row| row["sample"].clone()).collect();
    assert_eq!(samples.len(), 3);
    // The wall makes the directions different.
    let intensities =
        |rows: &[Row]| -> Vec<String> { rows.iter().map(|row| row["intensity"].clone()).collect() };
    for (own, other) in intensities(&own).iter().zip(intensities(&other)) {
        assert!(!own.is_empty() && *own != other, "{own} {other}");
    }
}

/// A mirrored record counts as the same record.
#[test]
fn mirrored_records_count_as_their_record() {
    let own = [("a", "..xx"), ("b", ".x.x"), ("c", ".xxx")];
    let other = [
        own[0],
        ("-a", "..x."),
        own[1],
        ("-b", ".x.x"),
        own[2],
        ("-c", ".xxx"),
    ];
    let other = SuiteFragility::new(Measure::Scale, levels_of(&other));
    assert_eq!((other.record_count(), other.levels[0].counts.cases), (3, 6));
    // Each sign is a case; both belong to one record, which the errors by record treat as dependent. So these errors
    // are larger than for the same cases of six records.
    let six = [
        own[0],
        ("d", "..x."),
        own[1],
        ("e", ".x.x"),
        own[2],
        ("f", ".xxx"),
    ];
    let six = SuiteFragility::new(Measure::Scale, levels_of(&six));
    let (other, six) = (other.fit.unwrap(), six.fit.unwrap());
    assert_eq!(
        (other.median, other.independent),
        (six.median, six.independent)
    );
    assert!(other.clustered.unwrap().median > six.clustered.unwrap().median);
}

/// The files of the results, by their names.
fn result_files(heading: &Heading, results: &SuiteFragility) -> BTreeMap<&'static str, String> {
    let results = heading
        .report(results.cases.clone(), Figure::SCREEN)
        .unwrap();
    let files = results.files.into_iter();
    files
        .map(|(name, contents)| (name, String::from_utf8(contents).unwrap()))
        .collect()
}

/// The heading of a suite with linear levels.
fn heading() -> Heading {
    heading_of("four")
}

fn heading_of(model: &str) -> Heading {
    let heading = serde_json::json!({
        "title": null, "scenario": {}, "model": model, "is_arch": true, "measure": "scale", "spacing": "linear",
        "has_both": false, "directions": "both", "spectral": { "period_s": 1.0, "damping_percent": 5.0 }, "warnings": [],
    });
    serde_json::from_value(heading).unwrap()
}

const FAILED: Option<Outcome> = None;
const OVERTURNED: Option<Outcome> = Some(Outcome::Overturned(Sway::Left));

#[test]
fn failed_cases_are_excluded_and_rocking_ones_survive() {
    let results = results(&[
        ("a, b.at2", 1.0, FAILED),
        ("a, b.at2", 2.0, OVERTURNED),
        ("c.at2", 1.0, Some(Outcome::StillRocking)),
        ("c.at2", 2.0, FAILED),
        ("d.at2", 1.0, FAILED),
        ("d.at2", 2.0, FAILED),
        ("e.at2", 1.0, OVERTURNED),
        ("e.at2", 2.0, Some(Outcome::Rest)),
        ("e.at2", 2.0, OVERTURNED),
    ]);
    let counts: Vec<_> = results
        .levels
        .iter()
        .map(|level| {
            (
                level.intensity,
                level.counts.cases,
                level.counts.overturned,
                level.counts.still_rocking,
                level.counts.failed,
            )
        })
        .collect();
    assert_eq!(counts, [(1.0, 2, 1, 1, 2), (2.0, 3, 2, 0, 2)]);
    let json: Value = result_files(&heading(), &results)["fragility.json"]
        .parse()
        .unwrap();
    assert_eq!(json["cases"], 5);
    assert_eq!(json["records"], 4);
    assert_eq!(json["failed_left_out"], 4);
    assert_eq!(json["still_rocking_counted_as_not_overturned"], 1);
    assert_eq!(
        json["records_that_always_overturn"],
        serde_json::json!(["a, b.at2"])
    );
    // Nothing is known of d.
    assert_eq!(
        json["records_that_never_overturn"],
        serde_json::json!(["c.at2"])
    );
    assert_eq!(json["failures"].as_array().unwrap().len(), 4);
    assert_eq!(
        json["failures"][0],
        serde_json::json!({ "case": "a, b.at2, scale 1", "reason": "it broke" })
    );
    // Two levels fit exactly: Phi(-ln(m)/b) = 1/2 at 1 and Phi(ln(2/m)/b) = 2/3 at 2.
    let fit = results.fit.unwrap();
    assert!((fit.median - 1.0).abs() < 1e-9);
    assert!((fit.dispersion - 2.0_f64.ln() / 0.430_727_299_295_457_5).abs() < 1e-9);
}

#[test]
fn a_level_with_only_failed_cases_has_no_fraction() {
    let results = results(&[("a.at2", 1.0, FAILED), ("a.at2", 2.0, OVERTURNED)]);
    let files = result_files(&heading(), &results);
    let levels = &files["fragility.csv"];
    assert!(
        levels.contains("\n1.0,0,0,0,0,1,,,,,0,,\n2.0,1,1,0,0,0,1.0,,,,0,1.0,1.0\n"),
        "{levels}"
    );
    let json: Value = files["fragility.json"].parse().unwrap();
    let reason = json["no_fit"].as_str().unwrap();
    assert!(reason.contains("down to the intensity 2:"), "{reason}");
    assert_eq!(
        files["suite.svg"].matches("data-name=\"fraction\"").count(),
        1
    );
}

#[test]
fn cases_still_rocking_are_reported() {
    let folder = folder();
    let folder = folder.path();
    let text = format!(
        "{}[suite]\nrecords = 'records/*.at2'\nscales = [0.9]\n",
        COLUMN.replace("30.0", "6.0")
    );
    write(folder, "s.toml", &text);
    let said = done(folder, &["suite", "s.toml", "--out", "o"]);
    golden("suite-still-rocking", &said);
}

/// Asserts that a suite has these faults and no others: line and column within the file, and words.
#[track_caller]
fn assert_faults(folder: &Path, suite: &str, expected: &[(usize, usize, &[&str])]) {
    write(folder, "s.toml", &format!("{COLUMN}[suite]\n{suite}\n"));
    let before = COLUMN.lines().count() + 1;
    let errors = Scenario::read(&folder.join("s.toml")).unwrap_err();
    assert_eq!(errors.0.len(), expected.len(), "{errors}");
    for (error, (line, column, words)) in errors.0.iter().zip(expected) {
        let place = error.place.unwrap();
        assert_eq!(
            (place.line - before, place.column),
            (*line, *column),
            "{error}"
        );
        for word in *words {
            assert!(error.message.contains(word), "{word:?} is not in: {error}");
        }
    }
}

#[test]
fn faults_of_the_table_have_places() {
    let folder = folder();
    let folder = folder.path();
    let all = "records = 'records/*.at2'";
    assert_faults(
        folder,
        "recrods = 'x'\nboth_signs = 1",
        &[
            (0, 1, &["[suite] lacks `records`", "a string or an array"]),
            (1, 1, &["did you mean `records`?"]),
            (
                2,
                14,
                &["`both_signs = 1` is a whole number", "true or false"],
            ),
        ],
    );
    assert_faults(
        folder,
        &format!("{all}\nscales = [1]\npeaks_g = [1]"),
        &[(
            3,
            11,
            &[
                "`peaks_g` cannot be combined with `scales`",
                "give one of them",
            ],
        )],
    );
    assert_faults(
        folder,
        &format!("{all}\nscales = [0.0, 1.0]"),
        &[(2, 10, &["(number 1) that is out of range", "above 0 and"])],
    );
    assert_faults(
        folder,
        &format!("{all}\npeaks_g = {{ from = -1, to = 2000, count = 3 }}"),
        &[
            (2, 20, &["`from = -1` is out of range", "above 0 and"]),
            (2, 29, &["`to = 2000` is out of range", "at most 1000"]),
        ],
    );
    assert_faults(
        folder,
        "records = []\nscales = [1]",
        &[(1, 11, &["`records = []` is empty"])],
    );
    assert_faults(
        folder,
        "records = ['records/*.at2', 'none/*.at2', 'none.at2', 'records', '***']\nscales = [1]",
        &[
            (1, 29, &["`'none/*.at2'` in `records` matches no file"]),
            (
                1,
                43,
                &[
                    "`'none.at2'` in `records` does not exist",
                    "a file or a pattern",
                ],
            ),
            (1, 55, &["is a folder", "folder/*.at2"]),
            (1, 66, &["is not a valid file pattern"]),
        ],
    );
    // Keys of tables are for tables only.
    assert_faults(
        folder,
        &format!("{all}\nscales = [1]\ntime_column = 1"),
        &[(3, 15, &["applies to `format = \"csv\"` only"])],
    );
    assert_faults(
        folder,
        "records = '*.csv'\nscales = [1]",
        &[(0, 1, &["[suite] lacks `unit`", "cm/s2"])],
    );
    assert_faults(
        folder,
        &format!("{all}\nscales = {{ from = 1, to = 2, count = 10000 }}\ntitle = 'x'"),
        &[(
            3,
            1,
            &[
                "unknown key `title` in [suite]",
                "records, format, scales, peaks_g",
            ],
        )],
    );
}

#[test]
fn a_suite_has_a_largest_size() {
    let folder = folder();
    let folder = folder.path();
    // If there are too many records, none is read.
    for index in 0..51 {
        write(folder, &format!("{index}.at2"), "no record");
    }
    assert_faults(
        folder,
        "records = '*.at2'\nscales = { from = 1, to = 2, count = 10000 }",
        &[(
            0,
            1,
            &[
                "[suite] has 1020000 cases, 51 records at 10000 levels",
                "at most 1000000",
            ],
        )],
    );
}

/// Records that the given duration cuts off are one fault with all of them.
#[test]
fn records_that_are_cut_off_are_one_fault() {
    let folder = folder();
    let folder = folder.path();
    for (name, step_s) in [("long.at2", 20), ("longer.at2", 25)] {
        write(
            folder,
            name,
            &format!("A\nNPTS= 3, DT= {step_s} SEC\n1 2 3\n"),
        );
    }
    let parts: &[&str] = &[
        "has records that last longer than `duration_s` and would be cut off at 30 s: long.at2 (40 s), longer.at2 (50 s)",
        "give at least 50 s in [simulation]",
    ];
    let suite = "records = ['records/*.at2', 'long*.at2']\nscales = [1]";
    assert_faults(folder, suite, &[(1, 11, parts)]);
}

#[test]
fn faults_of_records_name_the_file() {
    let folder = folder();
    let folder = folder.path();
    let head = "A\nB\nUNITS OF G\nNPTS= 3, DT= .01 SEC\n";
    for (name, text) in [
        ("zero.at2", format!("{head}0 0 0\n")),
        ("short.at2", format!("{head}1 2\n")),
        ("word.at2", format!("{head}1 2 x\n")),
        ("tiny.at2", format!("{head}0 1e-9 0\n")),
        ("fine.rec", format!("{head}1 2 3\n")),
    ] {
        write(folder, name, &text);
    }
    // All faults are reported together, each at the pattern that names the file.
    assert_faults(
        folder,
        "records = ['records/*.at2', '*.at2']\nscales = [1]",
        &[
            (
                1,
                29,
                &[
                    "names short.at2, which is faulty: ",
                    "short.at2:5: ",
                    "the number of samples is 2: line 4 announces 3",
                ],
            ),
            (
                1,
                29,
                &["names word.at2, which is faulty: ", "word.at2:5: `x`"],
            ),
            (1, 29, &["names zero.at2, which is zero throughout"]),
        ],
    );
    let at = |levels: &str| format!("records = 'tiny.at2'\n{levels}");
    assert_faults(
        folder,
        &at("peaks_g = [0.5]"),
        &[(
            1,
            11,
            &["names tiny.at2, which has a peak of 1e-9 g", "to 0.5 g"],
        )],
    );
    assert_faults(
        folder,
        "records = 'records/wave-1.at2'\nscales = [1, 5000]",
        &[(
            1,
            11,
            &["names records/wave-1.at2, which reaches 1500 g as scaled"],
        )],
    );
    write(folder, "nameless.rec", "0 1\n0.01 2\n");
    assert_faults(
        folder,
        "records = 'nameless.*'\nscales = [1]",
        &[(
            1,
            11,
            &["names nameless.rec, which has an unknown extension"],
        )],
    );
    write(
        folder,
        "s.toml",
        &format!("{COLUMN}[suite]\nrecords = 'fine.*'\nscales = [1]\n"),
    );
    // The content shows the format.
    assert!(Scenario::read(&folder.join("s.toml")).is_ok());
}

#[cfg(unix)]
#[test]
fn names_that_would_break_lines_are_refused() {
    let folder = folder();
    let folder = folder.path();
    fs::copy(folder.join("records/wave-1.at2"), folder.join("a\nb.at2")).unwrap();
    assert_faults(
        folder,
        "records = '*.at2'\nscales = [1]",
        &[(
            1,
            11,
            &["names \"a\\nb.at2\"", "without control characters"],
        )],
    );
    assert_faults(
        folder,
        "records = \"a\\nb.at2\"\nscales = [1]",
        &[(
            1,
            11,
            &["names \"a\\nb.at2\"", "without control characters"],
        )],
    );
}

#[test]
fn suites_need_a_table_and_start_from_rest() {
    let folder = folder();
    let folder = folder.path();
    write(folder, "s.toml", COLUMN);
    let said = refused(folder, &["suite", "s.toml"], &[]);
    assert!(
        said.contains("the scenario has no [suite]") && said.contains("records = "),
        "{said}"
    );
    let text = mixed("scales = [1]");
    write(
        folder,
        "s.toml",
        &format!("{text}[initial]\nsway = 'left'\nrotation_rad = 0.1\n"),
    );
    let said = refused(folder, &["suite", "s.toml"], &[]);
    assert!(said.contains("leave [initial] out"), "{said}");
}

/// Sines of one period, sampled closely: their measures of intensity have closed forms, and the spectral acceleration follows from the
/// equation of an oscillator by the method of Runge and Kutta. Capacities are where runs begin to overturn.
#[test]
fn capacities_are_reported_in_several_measures() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let gravity = 9.81;
    let durations_s = [0.4, 0.8, 1.6];
    for duration_s in durations_s {
        let line = |sample: u32| {
            let time_s = duration_s * f64::from(sample) / 400.0;
            format!(
                "{time_s:.6},{:.9}\n",
                (2.0 * PI * time_s / duration_s).sin()
            )
        };
        let table: String = (0..=400).map(line).collect();
        write(folder, &format!("sine-{duration_s}.csv"), &table);
    }
    let text = format!(
        "{COLUMN}[suite]\nrecords = 'sine-*.csv'\nunit = 'g'\nspectral_period_s = 0.5\nspectral_damping_percent = 2\n\
         peaks_g = {{ from = 0.1, to = 6.0, count = 14, spacing = 'logarithmic' }}\n"
    );
    write(folder, "s.toml", &text);
    let said = done(folder, &["suite", "s.toml", "--out", "o"]);
    assert!(said.contains("at 0.5 s and 2 %"), "{said}");
    let cases = rows(&folder.join("o"));
    let capacities = Table::read(folder.join("o/capacities.csv")).rows;
    // Mirrored records are mirror images, and no further evidence.
    assert_eq!(capacities.len(), 3);
    for (capacity, duration_s) in capacities.iter().zip(durations_s) {
        assert_eq!(capacity["record"], format!("sine-{duration_s}.csv"));
        let peak_g = capacity.number("peak_g");
        let close = |name: &str, known: f64, part: f64| {
            let found = capacity.number(name);
            assert!((found / known - 1.0).abs() < part, "{name} {found} {known}");
        };
        // Straight lines between 400 samples take a part of (2 pi / 400)^2 / 12 off an integral.
        close("scale", peak_g, 1e-4);
        close(
            "peak_velocity_m_s",
            peak_g * gravity * duration_s / PI,
            1e-4,
        );
        close(
            "arias_m_s",
            0.25 * PI * gravity * peak_g * peak_g * duration_s,
            1e-4,
        );
        close(
            "spectral_acceleration_g",
            peak_g * spectral(duration_s, 0.5, 0.02),
            3e-3,
        );
        // The first level that overturns, and the one before.
        let own = cases
            .iter()
            .filter(|row| row["record"] == capacity["record"] && row["sign"] == "1");
        let own: Vec<_> = own.collect();
        let first = own.iter().position(|row| row["outcome"] == "overturned");
        let first = first.unwrap();
        assert!(own[first - 1].number("peak_g") < peak_g && peak_g <= own[first].number("peak_g"));
        for (factor, overturns) in [(1.0, true), (0.996, false)] {
            let text = format!(
                "{COLUMN}[ground.record]\nfile = '{}'\nunit = 'g'\npeak_g = {:?}\n",
                capacity["record"],
                factor * peak_g
            );
            write(folder, "run.toml", &text);
            done(
                folder,
                &["run", "run.toml", "--out", "r", "--quiet", "--no-report"],
            );
            let outcome = json(&folder.join("r/summary.json"))["outcome"].clone();
            assert_eq!(outcome == "overturned", overturns, "{capacity:?} {factor}");
        }
    }
    // The table has the dispersions of these, the smallest first.
    let measures = Table::read(folder.join("o/intensity.csv")).rows;
    assert_eq!(measures.len(), 4);
    let mut before = 0.0;
    for measure in &measures {
        let logarithms = capacities
            .iter()
            .map(|capacity| capacity.number(measure["measure"].as_str()).ln());
        let mean = logarithms.clone().sum::<f64>() / 3.0;
        let squares: f64 = logarithms.map(|value| (value - mean).powi(2)).sum();
        let dispersion = (squares / 2.0).sqrt();
        assert!((measure.number("dispersion") - dispersion).abs() < 1e-9);
        let power = if measure["measure"] == "arias_m_s" {
            2.0
        } else {
            1.0
        };
        let of_factor = measure.number("dispersion_of_factor");
        assert!((of_factor - dispersion / power).abs() < 1e-9 && of_factor >= before);
        before = of_factor;
    }
    let fragility = json(&folder.join("o/fragility.json"));
    assert_eq!(
        fragility["intensity_measures"][0]["measure"],
        measures[0]["measure"]
    );
    // The fractiles of three peaks are the smallest, the middle and the largest; overturned cases lie beyond all.
    let ida = Table::read(folder.join("o/ida.csv")).rows;
    for level in &ida {
        let peak_g = level.number("peak_g");
        let mut peaks: Vec<f64> = cases
            .iter()
            .filter(|row| row["sign"] == "1" && (row.number("peak_g") / peak_g - 1.0).abs() < 1e-9)
            .map(|row| match row["outcome"].as_str() {
                "overturned" => f64::INFINITY,
                _ => row.number("peak_rotation_over_critical"),
            })
            .collect();
        peaks.sort_by(f64::total_cmp);
        assert_eq!(peaks.len(), 3);
        for (name, peak) in ["peak_16", "peak_50", "peak_84"].into_iter().zip(peaks) {
            let found = level[name].parse().unwrap_or(f64::INFINITY);
            assert_eq!(found, peak, "{level:?}");
        }
    }
    // The distribution of all peaks ends at the share that survives.
    let peaks = Table::read(folder.join("o/peaks.csv"));
    let survived = cases
        .iter()
        .filter(|row| row["sign"] == "1" && row["outcome"] != "overturned");
    let share = survived.count() as f64 / 42.0;
    assert!((peaks.numbers("share").last().unwrap() - share).abs() < 1e-12);
    assert!(peaks.numbers("peak").is_sorted());
}

/// Largest `omega^2` times displacement of an oscillator under a sine of 1 g, in g, by Runge and Kutta's method, until the sine ends.
fn spectral(duration_s: f64, period_s: f64, damping: f64) -> f64 {
    let omega = 2.0 * PI / period_s;
    let rate = |time_s: f64, [x, v]: [f64; 2]| {
        let ground = (2.0 * PI * time_s / duration_s).sin();
        [v, -ground - 2.0 * damping * omega * v - omega * omega * x]
    };
    let steps = 4000;
    let step = duration_s / f64::from(steps);
    let (mut state, mut peak) = ([0.0_f64; 2], 0.0_f64);
    for index in 0..steps {
        let time_s = step * f64::from(index);
        let to = |[a, b]: [f64; 2], by: f64| [state[0] + by * a, state[1] + by * b];
        let k1 = rate(time_s, state);
        let k2 = rate(time_s + 0.5 * step, to(k1, 0.5 * step));
        let k3 = rate(time_s + 0.5 * step, to(k2, 0.5 * step));
        let k4 = rate(time_s + step, to(k3, step));
        for (part, value) in state.iter_mut().enumerate() {
            *value += step / 6.0 * (k1[part] + 2.0 * k2[part] + 2.0 * k3[part] + k4[part]);
        }
        peak = peak.max(state[0].abs());
    }
    omega * omega * peak
}

/// Five levels step over the band in which the weakest record overturns a block from 0.2426 g on, as single histories say. The search finds it, for
/// every record up to the lowest edge; other capacities are those of the levels.
#[test]
fn a_band_between_few_levels_is_found() {
    let folder = folder();
    let at = folder.path();
    let block = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";
    for (peak_g, verdict) in [(0.2420, Verdict::Survives), (0.2430, Verdict::Overturns)] {
        let record =
            format!("{block}[ground.record]\nfile = 'records/wave-1.at2'\npeak_g = {peak_g}\n");
        write(at, "one.toml", &record);
        let scenario = Scenario::read(&at.join("one.toml")).unwrap();
        let ending = Ending::of(
            &*scenario.model().unwrap(),
            scenario.ground_motion(),
            &scenario.request(),
        );
        assert_eq!(ending.unwrap().verdict(), verdict, "{peak_g}");
    }
    let levels = "peaks_g = { from = 0.2, to = 3.0, count = 5, spacing = 'logarithmic' }";
    let suite = format!("{block}[suite]\nrecords = 'records/*.at2'\n{levels}\n");
    write(at, "s.toml", &suite);
    done(at, &["suite", "s.toml", "--out", "o"]);
    let found = json(&at.join("o/fragility.json"));
    let survivals = found["survivals"].as_array().unwrap();
    let safe = |one: &Value| one["survives_up_to"].as_f64().unwrap();
    let weakest = safe(&survivals[0]);
    assert!((weakest / 0.2424 - 1.0).abs() < 2e-3, "{weakest}");
    let quote = found["to_quote"].as_str().unwrap();
    assert!(
        quote.contains("0.242") && !quote.contains("of the levels tried"),
        "{quote}"
    );
    let of_levels = survivals.iter().map(|one| one["levels_only"] == true);
    assert_eq!(of_levels.collect::<Vec<_>>(), [false, false, true]);
    let table = Table::read(at.join("o/capacities.csv"));
    let of_levels = table.rows.iter().map(|row| row["levels_only"].to_owned());
    assert_eq!(of_levels.collect::<Vec<_>>(), ["no", "no", "yes"]);
    assert!(safe(&survivals[2]) > 0.5);
}

/// The edge of a record may lie in a band of another one that survives both levels: the search of the other goes down from there, and the band ends
/// below its level.
#[test]
fn a_search_may_begin_in_a_band() {
    let folder = folder();
    let at = folder.path();
    for name in ["wave-2.at2", "wave-5.at2"] {
        fs::copy(scenarios().join("records").join(name), at.join(name)).unwrap();
    }
    let suite = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[suite]\nscales = [0.667, 1.312]\n[[suite.record]]\nfile = 'wave-5.at2'\n\
                 [[suite.record]]\nfile = 'wave-2.at2'\nscale = 0.8\n";
    write(at, "s.toml", suite);
    done(at, &["suite", "s.toml", "--out", "o"]);
    let found = json(&at.join("o/fragility.json"));
    let survival = &found["survivals"][0];
    assert_eq!(survival["levels_only"], false);
    let from = survival["overturns_from"].as_f64().unwrap();
    let scenario = |scale: f64| {
        let text = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[ground.record]\nfile = 'wave-5.at2'";
        write(at, "one.toml", &format!("{text}\nscale = {scale}\n"));
        Scenario::read(&at.join("one.toml")).unwrap()
    };
    // Single histories: the edge, and the band above it.
    for (scale, verdict) in [
        (0.998 * from, Verdict::Survives),
        (from, Verdict::Overturns),
        (1.01 * from, Verdict::Overturns),
        (1.312, Verdict::Survives),
    ] {
        let one = scenario(scale);
        let ending = Ending::of(&*one.model().unwrap(), one.ground_motion(), &one.request());
        assert_eq!(ending.unwrap().verdict(), verdict, "{scale}");
    }
    let last = survival["ranges"].as_array().unwrap().last().unwrap();
    assert_eq!(
        [&last["verdict"], &last["from"]],
        [&Value::from("survives"), &Value::from(1.312)]
    );
}

/// The share of peaks up to a value, for peaks in any order; overturned cases count as infinite.
fn share(peaks: &[f64], up_to: f64) -> f64 {
    peaks.iter().filter(|peak| **peak <= up_to).count() as f64 / peaks.len() as f64
}

/// A block rocks equally as Housner's block and as a row of one block, so the distributions of peaks do not differ. Those of a
/// block with half of Housner's restitution do. The tables of the models give the same peaks, and the distance is that of their
/// shares.
#[test]
fn distributions_of_models_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, second) in [("a", 0.9), ("b", 0.4), ("c", 0.2)] {
        let table = format!("0.0,0.0\n0.3,1.0\n0.6,{second}\n0.9,-0.8\n1.2,0.0\n");
        write(at, &format!("{name}.csv"), &table);
    }
    let suite = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[simulation]\nduration_s = 30.0\n[suite]\nrecords = '?.csv'\nunit = 'g'\n\
                 both_signs = false\npeaks_g = [0.22, 0.26, 0.3, 0.35, 1.2]\n[impact]\n";
    write(at, "s.toml", suite);
    let said = done(
        at,
        &["suite", "s.toml", "--hinges", "four,free", "--out", "r"],
    );
    // A busy machine also prints the progress.
    let is_result = |line: &&str| !line.ends_with(" left");
    let results: Vec<&str> = said.lines().filter(is_result).collect();
    golden("suite-two-models", &(results.join("\n") + "\n"));
    let summary = json(&at.join("r/models/peaks.json"));
    let pair = &summary["pairs"][0];
    let table = Table::read(at.join("r/models/peaks.csv"));
    let of = |model: &str| -> Vec<f64> {
        let rows = table.rows.iter().filter(|row| row["model"] == *model);
        rows.map(|row| row.number("peak_rotation_rad")).collect()
    };
    // The critical rotation of Housner's block is the slenderness.
    let slenderness_rad = (0.8_f64 / 4.0).atan();
    let mut all = Vec::new();
    for (name, words, column, unit_rad) in [
        (
            "four",
            "four links",
            "peak_rotation_over_critical",
            slenderness_rad,
        ),
        ("free", "free hinges", "peak_rotation_rad", 1.0),
    ] {
        let suite = Table::read(at.join("r").join(name).join("suite.csv"));
        let peak = |row: &Row| {
            if row["outcome"] == "overturned" {
                f64::INFINITY
            } else {
                unit_rad * row.number(column)
            }
        };
        let mut peaks: Vec<f64> = suite.rows.iter().map(peak).collect();
        peaks.sort_by(f64::total_cmp);
        let finite = peaks.iter().filter(|peak| peak.is_finite());
        for (printed, known) in of(words).iter().zip(finite.clone()) {
            assert!((printed - known).abs() < 1e-9, "{name}: {printed} {known}");
        }
        assert_eq!(of(words).len(), finite.count());
        assert!((6..15).contains(&of(words).len()), "{name}");
        all.push(peaks);
    }
    let finite = || all.iter().flatten().filter(|peak| peak.is_finite());
    let apart = finite().map(|peak| (share(&all[0], *peak) - share(&all[1], *peak)).abs());
    let distance = pair["kolmogorov_distance"].as_f64().unwrap();
    assert!((apart.fold(0.0, f64::max) - distance).abs() < 1e-12);
    // Small differences of peaks from the steps of the row may exchange two neighbours of the fifteen.
    assert!(distance < 1.01 / 15.0, "{pair}");
    for name in ["models/peaks.svg", "four/suite.csv", "free/peaks.svg"] {
        assert!(at.join("r").join(name).exists(), "{name}");
    }

    // The same comparison for the samples of a run, with a model that differs.
    let run = suite.replace("[suite]\nrecords = '?.csv'\nunit = 'g'\nboth_signs = false\npeaks_g = [0.22, 0.26, 0.3, 0.35, 1.2]\n", "")
        + "model = 'prescribed'\nrestitution = 0.3\n[ground.one_sine]\namplitude_g = 0.3\nduration_s = 0.8\n\
           [uncertain]\nsamples = 16\n'ground.one_sine.duration_s' = { from = 0.4, to = 0.9 }\n";
    write(at, "run.toml", &run);
    let options = [
        "run",
        "run.toml",
        "--hinges",
        "four,free",
        "--no-report",
        "--no-repeat",
        "--out",
        "u",
    ];
    let said = String::from_utf8(crate::common::program::archrock(at, &options).stdout).unwrap();
    assert!(said.contains("four links against free hinges: "), "{said}");
    let table = Table::read(at.join("u/models/peaks.csv"));
    for (name, words) in [("four", "four links"), ("free", "free hinges")] {
        let samples = Table::read(at.join("u").join(name).join("uncertain/samples.csv"));
        let survived = samples.rows[1..]
            .iter()
            .filter(|row| row["outcome"] != "overturned");
        let rows = table.rows.iter().filter(|row| row["model"] == *words);
        assert_eq!(survived.count(), rows.count(), "{name}");
    }
}

/// Without levels each record acts once, unscaled and as given: outcomes are those of runs with `[ground.record]`, and the picture has a circle for each
/// at the measures of a sine in closed form.
#[test]
fn records_act_once_without_levels() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let gravity = 9.81;
    let sines = [(0.3, 0.4), (0.5, 0.8), (0.9, 0.5), (0.6, 1.6), (0.1, 1.0)];
    for (at, (peak_g, duration_s)) in sines.into_iter().enumerate() {
        let line = |sample: u32| {
            let time_s = duration_s * f64::from(sample) / 400.0;
            let sine = (2.0 * PI * time_s / duration_s).sin();
            format!("{time_s:.6},{:.9}\n", peak_g * sine)
        };
        let table: String = (0..=400).map(line).collect();
        write(folder, &format!("sine-{at}.csv"), &table);
    }
    let suite = "[suite]\nrecords = 'sine-*.csv'\nunit = 'g'\n";
    write(folder, "s.toml", &format!("{COLUMN}{suite}"));
    let said = done(folder, &["suite", "s.toml", "--out", "o", "--details"]);
    let cases = rows(&folder.join("o"));
    assert_eq!(cases.len(), sines.len());
    let runs = sines.into_iter().enumerate().map(|(at, _)| {
        let text = format!(
            "{COLUMN}direction = 'as_given'\n[ground.record]\nfile = 'sine-{at}.csv'\nunit = 'g'\n"
        );
        write(folder, "run.toml", &text);
        done(folder, &["run", "run.toml", "--out", "r", "--quiet"]);
        json(&folder.join("r/summary.json"))
    });
    let runs: Vec<Value> = runs.collect();
    for ((case, run), (peak_g, duration_s)) in cases.iter().zip(&runs).zip(sines) {
        assert_eq!(run["outcome"], case["outcome"], "{case:?}");
        assert_eq!([&case["sign"], &case["scale"]], ["1", "1.0"]);
        assert!((case.number("peak_g") / peak_g - 1.0).abs() < 1e-6);
        let velocity_m_s = peak_g * gravity * duration_s / PI;
        assert!((case.number("peak_velocity_m_s") / velocity_m_s - 1.0).abs() < 1e-4);
    }
    let overturned = |run: &&Value| run["outcome"] == "overturned";
    let overturned = runs.iter().filter(overturned).count();
    assert!(0 < overturned && overturned < sines.len());

    let report = json(&folder.join("o/fragility.json"));
    let found = &report["as_recorded"];
    assert_eq!(found["records_that_overturn"], overturned);
    assert_eq!(found["share"], overturned as f64 / sines.len() as f64);
    assert_eq!(found["records_in_doubt"], 0);
    assert!(report["median"].is_null() && report["survivals"].as_array().unwrap().is_empty());
    assert_eq!(report["scenario"]["simulation"]["direction"], "as_given");
    let quote = report["to_quote"].as_str().unwrap();
    let percent = 100.0 * overturned as f64 / sines.len() as f64;
    let answer = format!("{overturned} of 5 records ({percent:.1} %) overturn it unscaled");
    assert!(quote.starts_with(&answer), "{quote}");
    assert!(said.contains(&answer), "{said}");
    for absent in ["survives up to", "median", "of the levels tried"] {
        assert!(!said.contains(absent), "{said}");
    }
    for absent in [
        "fragility.csv",
        "ida.svg",
        "ida.csv",
        "capacities.csv",
        "intensity.csv",
    ] {
        assert!(!folder.join("o").join(absent).exists(), "{absent}");
    }

    let picture = read(&folder.join("o/suite.svg"));
    let picture = Document::parse(&picture).unwrap();
    let circles = |name: &str| {
        let nodes = picture.descendants();
        let named = nodes.filter(|node| node.attribute("data-name") == Some(name));
        let at = |node: roxmltree::Node<'_, '_>| {
            ["cx", "cy"].map(|of| node.attribute(of).unwrap().parse::<f64>().unwrap())
        };
        named.map(at).collect::<Vec<_>>()
    };
    assert_eq!(circles("overturns").len(), overturned);
    let all = [circles("survives"), circles("overturns")].concat();
    let own: Vec<_> = sines.into_iter().enumerate().collect();
    let (survive, overturn): (Vec<_>, Vec<_>) = own
        .into_iter()
        .partition(|(at, _)| runs[*at]["outcome"] != "overturned");
    let places = [survive, overturn].concat();
    // Both axes are logarithmic: distances on the sheet are proportional to those of the logarithms.
    for (axis, sign) in [(0, 1.0), (1, -1.0)] {
        let value = |at: usize| match places[at].1 {
            (peak_g, _) if axis == 1 => peak_g.ln(),
            (_, duration_s) => (duration_s / PI).ln(),
        };
        let px = |at: usize| sign * all[at][axis];
        let (low, high) = (0..5).fold((0, 0), |(low, high), at| {
            let low = if value(at) < value(low) { at } else { low };
            (low, if value(at) > value(high) { at } else { high })
        });
        let per = (px(high) - px(low)) / (value(high) - value(low));
        for at in 0..5 {
            let expected = px(low) + per * (value(at) - value(low));
            assert!((px(at) - expected).abs() < 0.1, "{axis} {at}");
        }
    }

    // In both directions a record overturns if one of its cases does.
    let load = "[[load]]\nmass_kg = 800.0\nx_m = 0.2\n";
    write(
        folder,
        "both.toml",
        &format!("{COLUMN}direction = 'both'\n{load}{suite}"),
    );
    done(folder, &["suite", "both.toml", "--out", "both", "--quiet"]);
    let cases = rows(&folder.join("both"));
    assert_eq!(cases.len(), 2 * sines.len());
    let fallen = cases.iter().filter(|case| case["outcome"] == "overturned");
    let records: BTreeSet<&str> = fallen.map(|case| case["record"].as_str()).collect();
    let report = json(&folder.join("both/fragility.json"));
    assert_eq!(
        report["as_recorded"]["records_that_overturn"],
        records.len()
    );
    assert!(
        report["to_quote"]
            .as_str()
            .unwrap()
            .contains("in at least one direction")
    );

    // Samples need levels.
    let uncertain = "[uncertain]\n'column.width_m' = { deviation = 0.01 }\n";
    write(folder, "u.toml", &format!("{COLUMN}{suite}{uncertain}"));
    let said = refused(folder, &["suite", "u.toml"], &[]);
    assert!(said.contains("give `scales` or `peaks_g`"), "{said}");
}
