//! Baselines and the high-pass filter in every place that reads records, in words and JSON.

use std::fs;
use std::path::Path;

use archrock::scenario::{Baseline, Format, Ground, LimitState, Record, Scenario, Series};

use crate::common::program::{archrock, done, printed, refusal, stdout};
use crate::common::results::json;

const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";

/// A record of 12 s with an offset and a drift, and one with unequal steps.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (mut even, mut uneven) = (String::new(), String::new());
    for (time_s, acceleration) in drifting() {
        even += &format!("{time_s},{acceleration}\n");
        uneven += &format!(
            "{},{acceleration}\n",
            time_s + if time_s < 3.0 { 0.0 } else { 0.003 }
        );
    }
    fs::write(folder.path().join("a.csv"), even).unwrap();
    fs::write(folder.path().join("b.csv"), uneven).unwrap();
    folder
}

/// Times in s and accelerations in m/s2.
fn drifting() -> Vec<(f64, f64)> {
    let times = (0..1201).map(|index| f64::from(index) / 100.0);
    let acceleration =
        |time_s: f64| 4.0 * (6.0 * time_s).sin() * (-0.4 * time_s).exp() + 0.3 + 0.05 * time_s;
    times.map(|time_s| (time_s, acceleration(time_s))).collect()
}

fn read(folder: &Path, text: &str) -> Result<Scenario, String> {
    fs::write(folder.join("s.toml"), format!("{COLUMN}{text}")).unwrap();
    Scenario::read(&folder.join("s.toml")).map_err(|errors| errors.to_string())
}

fn record(folder: &Path, keys: &str) -> Record {
    let text = format!("[ground.record]\nfile = 'a.csv'\nunit = 'm/s2'\nstart_s = 60\n{keys}\n");
    let scenario = read(folder, &text).unwrap_or_else(|errors| panic!("{keys}: {errors}"));
    fs::write(folder.join("again.toml"), scenario.to_toml()).unwrap();
    assert_eq!(
        Scenario::read(&folder.join("again.toml")).as_ref(),
        Ok(&scenario)
    );
    match &scenario.ground {
        Some(Ground::Record(record)) => (**record).clone(),
        other => panic!("{other:?}"),
    }
}

/// Velocity at the end, in m/s.
fn end_velocity(series: &Series) -> f64 {
    let samples = series.accelerations_m_s2(9.81);
    let areas = samples
        .windows(2)
        .map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0));
    areas.sum()
}

#[test]
fn the_older_name_of_the_mean_gives_the_same_bits() {
    let folder = folder();
    let [older, newer] =
        ["remove_mean = true", "baseline = 'mean'"].map(|keys| record(folder.path(), keys));
    assert_eq!(older, newer);
    let given = drifting();
    let areas = given
        .windows(2)
        .map(|pair| 0.5 * (pair[0].1 + pair[1].1) * 0.01);
    let mean = areas.sum::<f64>() / 12.0;
    for ((_, given), (_, found)) in given.into_iter().zip(newer.main.samples.iter()) {
        assert!((given - mean - found).abs() < 1e-12);
    }
    let none = record(folder.path(), "remove_mean = false");
    assert_eq!(none, record(folder.path(), ""));
}

#[test]
fn corrected_records_end_without_velocity() {
    let folder = folder();
    for (keys, tolerance) in [
        ("baseline = 'mean'", 1e-12),
        ("baseline = 'linear'", 1e-12),
        ("high_pass_hz = 0.1", 1e-4),
        ("baseline = 'linear'\nhigh_pass_hz = 0.3\nscale = -2", 1e-6),
    ] {
        let record = record(folder.path(), keys);
        let velocity = end_velocity(&record.main);
        assert!(velocity.abs() < tolerance, "{keys}: {velocity}");
    }
    assert!(end_velocity(&record(folder.path(), "").main) > 5.0);
}

/// The filter applies after the baseline: for the filter an offset would be a step at both ends.
#[test]
fn an_offset_has_no_effect_with_baseline_and_filter() {
    let folder = folder();
    let keys = "baseline = 'mean'\nhigh_pass_hz = 0.5";
    let expected = record(folder.path(), keys);
    let shifted = drifting().into_iter();
    let shifted =
        shifted.map(|(time_s, acceleration)| format!("{time_s},{}\n", acceleration + 5.0));
    fs::write(folder.path().join("a.csv"), shifted.collect::<String>()).unwrap();
    let found = record(folder.path(), keys);
    let samples = found.main.samples.iter().zip(&*expected.main.samples);
    for (found, expected) in samples {
        assert!(
            (found.1 - expected.1).abs() < 1e-9,
            "{found:?} {expected:?}"
        );
    }
}

/// Files with other corrections are read anew.
#[test]
fn each_record_has_its_corrections() {
    let folder = folder();
    let found = record(
        folder.path(),
        "baseline = 'linear'\n[ground.record.vertical]\nfile = 'a.csv'\nunit = 'm/s2'\nscale = 0.1\nhigh_pass_hz = 0.1",
    );
    let vertical = found.vertical.unwrap();
    assert_eq!(
        (found.main.layout.baseline, found.main.layout.high_pass_hz),
        (Some(Baseline::Linear), None)
    );
    assert_eq!(
        (vertical.layout.baseline, vertical.layout.high_pass_hz),
        (None, Some(0.1))
    );
    assert_eq!(
        (found.main.samples.len(), vertical.samples.len()),
        (1201, 1201 + 6000)
    );
    let scenario = read(
        folder.path(),
        "[suite]\nscales = [0.5, 1.0]\nunit = 'm/s2'\nbaseline = 'mean'\nhigh_pass_hz = 0.5\n\
         [[suite.record]]\nfile = 'a.csv'\n\
         [[suite.record]]\nfile = 'b.csv'\nremove_mean = true\nhigh_pass_hz = 0.5\n",
    );
    let errors = scenario.unwrap_err();
    let words = "b.csv:1: `high_pass_hz` needs a constant step between samples";
    assert!(errors.contains(words), "{errors}");
    let scenario = read(
        folder.path(),
        "[ground.right.record]\nfile = 'b.csv'\nunit = 'm/s2'\nbaseline = 'linear'\n[suite]\n\
         records = 'a.csv'\nunit = 'm/s2'\nscales = [1.0]\nbaseline = 'linear'\nhigh_pass_hz = 0.5\n",
    );
    assert!(scenario.is_err(), "a suite changes the ground of both feet");
    let scenario = read(
        folder.path(),
        "[suite]\nrecords = 'a.csv'\nunit = 'm/s2'\nscales = [1.0]\nbaseline = 'linear'\nhigh_pass_hz = 0.5\n",
    );
    let scenario = scenario.unwrap();
    let series = &scenario.suite.as_ref().unwrap().records[0];
    assert_eq!(series.layout.baseline, Some(Baseline::Linear));
    assert_eq!(
        (series.samples.len(), series.samples[0].0),
        (1201 + 1200, -6.0)
    );
    fs::write(folder.path().join("again.toml"), scenario.to_toml()).unwrap();
    assert_eq!(
        Scenario::read(&folder.path().join("again.toml")),
        Ok(scenario)
    );
}

/// A folder of several formats has the same corrections, and its files without a header too.
#[test]
fn suites_correct_all_formats() {
    let folder = folder();
    let formats = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenario/formats");
    fs::copy(formats.join("smc.smc"), folder.path().join("c.smc")).unwrap();
    let scenario = read(
        folder.path(),
        "[suite]\nrecords = ['a.csv', 'c.smc']\nunit = 'm/s2'\nscales = [1.0]\nbaseline = 'mean'\nhigh_pass_hz = 1.0\n",
    );
    let suite = scenario.unwrap().suite.clone().unwrap();
    assert_eq!(suite.records[1].layout.format, Format::SMC);
    for series in &suite.records {
        assert_eq!(
            (series.layout.baseline, series.layout.high_pass_hz),
            (Some(Baseline::Mean), Some(1.0))
        );
        assert!(end_velocity(series).abs() < 1e-6, "{}", series.file);
    }
}

#[test]
fn checks_correct_their_records() {
    let folder = folder();
    let folder = folder.path();
    for name in ["x-1.csv", "x-2.csv", "x-3.csv"] {
        fs::copy(folder.join("a.csv"), folder.join(name)).unwrap();
    }
    let demand = "[demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.slv]\nag_g = 0.25\nf0 = 2.4\ntc_star_s = 0.35\n";
    let keys = "[verify]\nslv_records = 'x-*.csv'\nunit = 'm/s2'\nbaseline = 'linear'\nhigh_pass_hz = 0.5\n";
    let scenario = read(folder, &format!("{demand}{keys}")).unwrap();
    fs::write(folder.join("again.toml"), scenario.to_toml()).unwrap();
    assert_eq!(
        Scenario::read(&folder.join("again.toml")).as_ref(),
        Ok(&scenario)
    );
    let verify = scenario.verify.as_ref().unwrap();
    let records = verify.records.records_of(LimitState::Slv);
    assert_eq!(records.len(), 3);
    for series in records {
        assert_eq!(
            (series.samples.len(), series.layout.high_pass_hz),
            (1201 + 1200, Some(0.5))
        );
        assert!(end_velocity(series).abs() < 1e-4);
    }
    let words = printed(folder, &["verify", "s.toml", "--out", "v"]);
    assert!(words.contains("SLV"), "{words}");
}

#[test]
fn corrections_are_stated() {
    let folder = folder();
    let folder = folder.path();
    let options = [
        "--set",
        "unit=m/s2",
        "--set",
        "baseline=linear",
        "--set",
        "high_pass_hz=0.2",
    ];
    let check = [&["check", "a.csv"][..], &options].concat();
    let words = printed(folder, &check);
    let first = "a.csv: table, accelerations in m/s2 from column 2, times from column 1, line of least squares subtracted, high-pass filter at 0.2 Hz\n";
    assert!(words.starts_with(first), "{words}");
    assert!(
        words.contains("4201 samples every 0.01 s, 42 s long"),
        "{words}"
    );
    assert!(words.contains("mean acceleration removed"), "{words}");
    assert!(words.contains("integrated from zero; g ="), "{words}");
    let found: serde_json::Value = serde_json::from_str(&printed(
        folder,
        &[&check[..], &["--format", "json"]].concat(),
    ))
    .unwrap();
    assert_eq!(
        (&found["baseline"], &found["high_pass_hz"]),
        (&"linear".into(), &0.2.into())
    );
    let plain = printed(folder, &["check", "a.csv", "--set", "unit=m/s2"]);
    assert!(
        plain.starts_with(
            "a.csv: table, accelerations in m/s2 from column 2, times from column 1\n"
        ),
        "{plain}"
    );
    assert!(plain.contains("without baseline correction"), "{plain}");
    let ground = "[simulation]\nduration_s = 40\n[ground.record]\nfile = 'a.csv'\nunit = 'm/s2'\nstart_s = 15\nbaseline = 'mean'\nhigh_pass_hz = 0.2\n";
    read(folder, ground).unwrap();
    let output = archrock(folder, &["run", "s.toml", "--out", "r"]);
    let words = stdout(&output);
    let line = "a.csv: 4201 samples every 0.01 s, 42 s long, peak ";
    assert!(words.contains(line), "{words}");
    assert!(
        words.contains("g, mean subtracted, high-pass filter at 0.2 Hz\n"),
        "{words}"
    );
    let summary = json(&folder.join("r/summary.json"));
    let record = &summary["scenario"]["ground"]["record"];
    assert_eq!(
        (&record["baseline"], &record["high_pass_hz"]),
        (&"mean".into(), &0.2.into())
    );
    done(folder, &["run", "s.toml", "--out", "r", "--quiet"]);
}

#[test]
fn impossible_corrections_are_refused() {
    let folder = folder();
    let ground = "[ground.record]\nfile = 'a.csv'\nunit = 'm/s2'\n";
    for (keys, words) in [
        (
            "baseline = 'mean'\nremove_mean = true",
            "`baseline = \"mean\"` is the newer name of `remove_mean = true`",
        ),
        ("baseline = 'cubic'", "must be one of \"mean\", \"linear\""),
        (
            "high_pass_hz = 0.2",
            "begins at -15 s; allowed is a `start_s` of at least 15",
        ),
        (
            "high_pass_hz = 50",
            "`high_pass_hz = 50` must be below half of the rate of the samples, 50 Hz",
        ),
        ("high_pass_hz = 0", "must be a number from 0.001 to 100"),
    ] {
        let errors = read(folder.path(), &format!("{ground}{keys}\n")).unwrap_err();
        assert!(errors.contains(words), "{keys}: {errors}");
    }
    let velocities = "[ground.record]\nfile = 'a.csv'\nunit = 'm/s'\nquantity = 'velocity'\n";
    for keys in [
        "baseline = 'linear'",
        "high_pass_hz = 1",
        "remove_mean = true",
    ] {
        let errors = read(folder.path(), &format!("{velocities}{keys}\n")).unwrap_err();
        assert!(
            errors.contains("applies to accelerations"),
            "{keys}: {errors}"
        );
        assert!(errors.contains(keys), "{keys}: {errors}");
        assert_eq!(errors.lines().count(), 1, "{errors}");
    }
    let output = archrock(
        folder.path(),
        &[
            "check",
            "b.csv",
            "--set",
            "unit=m/s2",
            "--set",
            "high_pass_hz=1",
        ],
    );
    let said = refusal(&output);
    assert!(said.contains("needs a constant step"), "{said}");
}

/// Other keys of a filtered record may be uncertain.
#[test]
fn filtered_records_may_be_uncertain() {
    let folder = folder();
    let folder = folder.path();
    let keys = "[simulation]\nduration_s = 40\n[ground.record]\nfile = 'a.csv'\nunit = 'm/s2'\nstart_s = 15\nbaseline = 'mean'\nhigh_pass_hz = 0.25\n\
                [uncertain]\nsamples = 8\n";
    for key in ["scale", "high_pass_hz"] {
        let range = if key == "scale" {
            "{ from = 1.0, to = 2.0 }"
        } else {
            "{ from = 0.2, to = 0.4 }"
        };
        read(
            folder,
            &format!("{keys}\"ground.record.{key}\" = {range}\n"),
        )
        .unwrap();
        done(folder, &["run", "s.toml", "--out", key]);
        let found = json(&folder.join(key).join("uncertain/uncertain.json"));
        assert_eq!(found["samples"], 8, "{key}");
    }
}

/// A filtered record begins three periods of the corner earlier, so `start_s = 3/f` puts its begin to time zero, in spite of rounding errors.
#[test]
fn a_filtered_record_may_begin_at_time_zero() {
    let folder = tempfile::tempdir().unwrap();
    for dt_s in [0.005, 0.01, 0.02] {
        let samples: String = (0..1000)
            .map(|step| format!("{}\n", (0.3 * f64::from(step)).sin()))
            .collect();
        fs::write(folder.path().join("a.csv"), samples).unwrap();
        for corner_hz in [
            0.05, 0.06, 0.075, 0.1, 0.12, 0.15, 0.2, 0.24, 0.25, 0.3, 0.5, 0.6,
        ] {
            let start_s = 3.0 / corner_hz;
            let text = format!(
                "[ground.record]\nfile = 'a.csv'\nunit = 'm/s2'\ndt_s = {dt_s}\nstart_s = {start_s}\nhigh_pass_hz = {corner_hz}\n"
            );
            let scenario = read(folder.path(), &text).unwrap();
            assert_eq!(
                scenario.ground_motion().start_s(),
                0.0,
                "{dt_s} {corner_hz}"
            );
        }
    }
}
