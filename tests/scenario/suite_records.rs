//! Suites whose records have entries of their own, and folders of several formats.

use std::fs;
use std::path::Path;

use archrock::scenario::{
    Baseline, Format, Scaling, Scenario, Series, Suite, TableColumn, Times, Unit,
};

use crate::common::program::{done, printed, refused};
use crate::common::results::Table;

const COLUMN: &str = "[column]\nheight_m = 0.4\nwidth_m = 0.08\n[simulation]\nduration_s = 20.0\n";
/// The samples of all files in `formats/`, in cm/s2.
const SAMPLES: [f64; 10] = [0.5, -1.25, 2.0, -0.75, 1.5, -2.5, 0.25, 0.0, 1.0, -0.5];

/// A folder with the files of all networks, and tables with the same samples: in m/s2 with times, in g without them.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let all = folder.path().join("all");
    fs::create_dir(&all).unwrap();
    let formats = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenario/formats");
    for file in fs::read_dir(formats).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), all.join(file.file_name())).unwrap();
    }
    // One of the times of the first differs, and all have tenths of g.
    for other in ["renadic.v1", "usc.m0a", "bhrc.v1"] {
        fs::remove_file(all.join(other)).unwrap();
    }
    let (mut timed, mut even) = (String::from("t;up;north\n"), String::from("made up\n"));
    for (index, sample) in SAMPLES.into_iter().enumerate() {
        let time_s = 0.01 * index as f64;
        timed += &format!("{time_s};{};{}\n", 0.03 * sample, 0.01 * sample);
        even += &format!("{}\n", sample / 981.0);
    }
    fs::write(all.join("timed.csv"), timed).unwrap();
    fs::write(folder.path().join("even.dat"), even).unwrap();
    folder
}

fn read(folder: &Path, keys: &str) -> Result<Scenario, String> {
    let text = format!("{COLUMN}[suite]\n{keys}\n");
    fs::write(folder.join("s.toml"), text).unwrap();
    Scenario::read(&folder.join("s.toml")).map_err(|errors| errors.to_string())
}

fn suite(folder: &Path, keys: &str) -> Suite {
    let scenario = read(folder, keys).unwrap_or_else(|errors| panic!("{keys}: {errors}"));
    fs::write(folder.join("again.toml"), scenario.to_toml()).unwrap();
    let again = Scenario::read(&folder.join("again.toml"));
    assert_eq!(again.as_ref(), Ok(&scenario), "{}", scenario.to_toml());
    scenario.suite.clone().unwrap()
}

fn names(suite: &Suite) -> Vec<&str> {
    suite.records.iter().map(|series| &*series.name).collect()
}

#[track_caller]
fn assert_samples(series: &Series, factor: f64) {
    let found = series.accelerations_m_s2(9.81);
    assert_eq!(found.len(), 10, "{}", series.file);
    for ((index, (time_s, found)), expected) in found.into_iter().enumerate().zip(SAMPLES) {
        assert!((time_s - 0.01 * index as f64).abs() < 1e-12);
        let expected = 0.01 * factor * expected;
        assert!((found - expected).abs() < 1e-12, "{}: {found}", series.file);
    }
}

/// The rest of a folder is read with `records`, and only the files that need more keys have entries.
const ALL: &str = "records = 'all/*'\npeaks_g = [0.5, 3.0]\n\
    [[suite.record]]\nfile = 'all/[ac][fw][ab]*.*'\nchannel = 'n'\n\
    [[suite.record]]\nfile = 'all/unam.*'\nchannel = 'N00E;+'\n\
    [[suite.record]]\nfile = 'all/timed.csv'\nunit = 'm/s2'\nacceleration_column = 'north'\n\
    [[suite.record]]\nfile = 'even.dat'\nunit = 'g'\ndt_s = 0.01\nskip_rows = 1\n";

#[test]
fn a_folder_may_mix_formats() {
    let folder = folder();
    let suite = suite(folder.path(), ALL);
    let listed = [
        "all/cosmos.v2",
        "all/csmip.v1",
        "all/csmip.v2",
        "all/csmnc.dat",
        "all/geonet.v1a",
        "all/geonet.v2a",
        "all/smc.smc",
        "all/usc.s0a",
        "all/afad.txt",
        "all/cwb.dat",
        "all/unam.asa",
        "all/timed.csv",
        "even.dat",
    ];
    assert_eq!(names(&suite), listed);
    for series in &suite.records {
        // This one rounds 1 cm/s2 to 0.001 g.
        let factor = if series.name == "all/csmip.v1" {
            0.981
        } else {
            1.0
        };
        assert_samples(series, factor);
    }
    let mut formats: Vec<_> = suite
        .records
        .iter()
        .map(|series| series.layout.format)
        .collect();
    formats.dedup();
    assert_eq!(formats.len(), 10, "{formats:?}");
}

/// The samples of all files are equal, so all records have the same results; parts of the suite and the whole as well.
#[test]
fn results_do_not_depend_on_the_format_of_a_record() {
    let folder = folder();
    let folder = folder.path();
    read(folder, ALL).unwrap();
    done(folder, &["suite", "s.toml", "--out", "whole"]);
    let table = Table::read(folder.join("whole/suite.csv"));
    assert_eq!(table.rows.len(), 13 * 2);
    for rows in table.rows.chunks(2) {
        for (row, first) in rows.iter().zip(&table.rows) {
            assert_eq!(row["outcome"], first["outcome"]);
            let [found, expected] =
                [row, first].map(|row| row.number("peak_rotation_over_critical"));
            assert!(
                (found - expected).abs() < 1e-6 * expected,
                "{}: {found} {expected}",
                row["record"]
            );
        }
    }
    assert!(table.rows[1].number("peak_rotation_over_critical") > 1e-3);
    for shard in ["1/2", "2/2"] {
        done(
            folder,
            &["suite", "s.toml", "--shard", shard, "--out", "parts"],
        );
    }
    // Parts need no records.
    fs::remove_dir_all(folder.join("all")).unwrap();
    let parts = ["parts/suite-1-of-2.part", "parts/suite-2-of-2.part"];
    done(folder, &["merge", parts[0], parts[1], "--out", "merged"]);
    for file in ["suite.csv", "fragility.json"] {
        let [merged, whole] =
            ["merged", "whole"].map(|place| fs::read(folder.join(place).join(file)).unwrap());
        assert_eq!(merged, whole, "{file}");
    }
}

/// The keys of `[suite]` are the defaults of entries, as far as they fit.
#[test]
fn entries_have_keys_of_their_own() {
    let folder = folder();
    let folder = folder.path();
    fs::copy(folder.join("all/timed.csv"), folder.join("all/timed2.csv")).unwrap();
    let found = suite(
        folder,
        "unit = 'm/s2'\ntime_column = 1\nacceleration_column = 'north'\nchannel = 2\nscales = [1, 2]\n\
         [[suite.record]]\nfile = 'all/timed2.csv'\nscale = 2\n\
         [[suite.record]]\nfile = 'all/timed.csv'\nacceleration_column = 'up'\nscale = -3\n\
         [[suite.record]]\nfile = 'even.dat'\nunit = 'g'\ndt_s = 0.01\nskip_rows = 1\nacceleration_column = 1\n\
         [[suite.record]]\nfile = 'all/cwb.dat'\npeak_g = 0.25\n\
         [[suite.record]]\nfile = 'all/timed.csv'\nunit = 'cm/s2'\n\
         [[suite.record]]\nfile = 'all/smc.smc'\n",
    );
    let expected = [
        "all/timed2.csv",
        "all/timed.csv up",
        "even.dat",
        "all/cwb.dat",
        "all/timed.csv north",
        "all/smc.smc",
    ];
    assert_eq!(names(&found), expected);
    let peak = 0.25 * 981.0 / 2.5;
    for (series, factor) in found.records.iter().zip([2.0, -9.0, 1.0, peak, 0.01, 1.0]) {
        assert_samples(series, factor);
    }
    let [even, cwb, smc] = [2, 3, 5].map(|index| &found.records[index]);
    assert_eq!(even.layout.unit, Some(Unit::Gravity));
    assert_eq!(cwb.layout.channel, Some(TableColumn::Number(2)));
    assert_eq!((cwb.layout.unit, cwb.scaling), (None, Scaling::PeakG(0.25)));
    assert_eq!(
        (smc.layout.format, smc.layout.channel.as_ref()),
        (Format::SMC, None)
    );
}

/// The listed file has no channels, so `channel` is the default of the entry.
#[test]
fn a_default_may_apply_to_entries_only() {
    let folder = folder();
    let found = suite(
        folder.path(),
        "records = 'all/timed.csv'\nunit = 'm/s2'\nacceleration_column = 'north'\nchannel = 'N'\nscales = [1]\n\
         [[suite.record]]\nfile = 'all/cwb.dat'\n",
    );
    assert_eq!(names(&found), ["all/timed.csv", "all/cwb.dat"]);
    for series in &found.records {
        assert_samples(series, 1.0);
    }
}

/// Two columns of a table are two records; a scaled record gives what its scaled samples give, in every command.
#[test]
fn a_factor_multiplies_the_levels() {
    let folder = folder();
    let folder = folder.path();
    let mut scaled = String::from("t;up;north\n");
    for (index, sample) in SAMPLES.into_iter().enumerate() {
        let time_s = 0.01 * index as f64;
        scaled += &format!("{time_s};{};{}\n", 1.5 * sample, 0.5 * sample);
    }
    fs::write(folder.join("scaled.csv"), scaled).unwrap();
    let edges = [
        "threshold",
        "s.toml",
        "--suite",
        "--from",
        "50",
        "--to",
        "500",
    ];
    let compute = |keys: &str| {
        read(folder, keys).unwrap();
        done(folder, &["suite", "s.toml", "--out", "results"]);
        let rows = Table::read(folder.join("results/suite.csv")).rows;
        (rows, printed(folder, &edges))
    };
    let entry = |column: &str| {
        format!(
            "[[suite.record]]\nfile = 'all/timed.csv'\nscale = 50\nacceleration_column = '{column}'\n"
        )
    };
    let keys = "scales = [1.0, 12.0]\nunit = 'm/s2'\n";
    let (own, own_edges) = compute(&format!("{keys}{}{}", entry("up"), entry("north")));
    for (rows, column) in own.chunks(2).zip(["up", "north"]) {
        let (plain, edge) = compute(&format!(
            "{keys}records = 'scaled.csv'\nacceleration_column = '{column}'\n"
        ));
        assert_eq!(rows.len(), plain.len());
        for (row, plain) in rows.iter().zip(&plain) {
            assert_eq!(row["record"], format!("all/timed.csv {column}"));
            assert_eq!(
                (&row["outcome"], &row["scale"]),
                (&plain["outcome"], &plain["scale"])
            );
            for key in ["peak_g", "peak_rotation_over_critical"] {
                let [found, expected] = [row, plain].map(|row| row.number(key));
                assert!(
                    (found - expected).abs() <= 1e-6 * expected,
                    "{key}: {found} {expected}"
                );
            }
        }
        let edge = edge
            .lines()
            .next()
            .unwrap()
            .replace("scaled.csv", &format!("all/timed.csv {column}"));
        assert!(edge.contains("overturns from"), "{edge}");
        assert!(own_edges.contains(&edge), "{own_edges}: {edge}");
    }
}

/// Records of one file have their channels in their names, and the levels multiply their peaks.
#[test]
fn levels_multiply_peaks() {
    let folder = folder();
    let folder = folder.path();
    let entry = |channel: &str, peak_g: f64| {
        format!("[[suite.record]]\nfile = 'all/cwb.dat'\nchannel = {channel}\npeak_g = {peak_g}\n")
    };
    let keys = format!(
        "scales = [1.0, 3.0]\nboth_signs = false\n{}{}",
        entry("'E'", 0.25),
        entry("2", 0.75)
    );
    suite(folder, &keys);
    done(folder, &["suite", "s.toml", "--out", "results"]);
    let rows = Table::read(folder.join("results/suite.csv")).rows;
    let expected = [("E", 0.25), ("E", 0.75), ("2", 0.75), ("2", 2.25)];
    assert_eq!(rows.len(), expected.len());
    for (row, (channel, peak_g)) in rows.iter().zip(expected) {
        assert_eq!(row["record"], format!("all/cwb.dat {channel}"));
        assert!(
            (row.number("peak_g") - peak_g).abs() < 1e-9,
            "{}",
            row["peak_g"]
        );
    }
    // The channels are proportional, so equal peaks are equal motions.
    let key = "peak_rotation_over_critical";
    let [weak, strong, equal] = [0, 1, 2].map(|row| rows[row].number(key));
    assert!(weak < 0.5 * strong, "{weak} {strong}");
    assert!((strong - equal).abs() < 1e-6 * equal, "{strong} {equal}");
}

/// A part of a suite is not resumed after a change of a factor.
#[test]
fn parts_belong_to_their_factors() {
    let folder = folder();
    let folder = folder.path();
    let write = |scale: f64| {
        let keys =
            format!("scales = [1.0]\n[[suite.record]]\nfile = 'all/smc.smc'\nscale = {scale}\n");
        read(folder, &keys).unwrap();
    };
    write(2.0);
    let shard = [
        "suite", "s.toml", "--shard", "1/2", "--resume", "--out", "parts",
    ];
    done(folder, &shard);
    done(folder, &shard);
    write(3.0);
    refused(folder, &shard, &["another"]);
}

/// Corrections of `[suite]` are no defaults of velocities, and a key of an entry excludes its alternative.
#[test]
fn defaults_give_way_to_other_keys() {
    let folder = folder();
    fs::write(folder.path().join("two.csv"), "up,north\n1,2\n3,4\n0,9\n").unwrap();
    let found = suite(
        folder.path(),
        "scales = [1]\nunit = 'cm/s2'\nbaseline = 'linear'\nhigh_pass_hz = 1\ndt_s = 0.01\nwrapped = true\n\
         [[suite.record]]\nfile = 'all/csmip.v2'\nquantity = 'velocity'\n\
         [[suite.record]]\nfile = 'all/timed.csv'\nremove_mean = true\ntime_column = 't'\nacceleration_column = 2\n\
         [[suite.record]]\nfile = 'even.dat'\nskip_rows = 1\n\
         [[suite.record]]\nfile = 'two.csv'\nacceleration_column = 'north'\n",
    );
    let [velocities, timed, even, two] = &found.records[..] else {
        panic!("{:?}", names(&found));
    };
    let corrections = |series: &Series| (series.layout.baseline, series.layout.high_pass_hz);
    assert_eq!(corrections(velocities), (None, None));
    assert_eq!(corrections(timed), (Some(Baseline::Mean), Some(1.0)));
    assert_eq!(corrections(even), (Some(Baseline::Linear), Some(1.0)));
    assert_eq!((timed.layout.wrapped, even.layout.wrapped), (false, true));
    assert_eq!(even.layout.times, Some(Times::Step(0.01)));
    assert_eq!(two.layout.times, Some(Times::Step(0.01)));
    assert!(!two.layout.wrapped);
}

/// Samples of an uncertain structure shake under each record, by its name.
#[test]
fn records_with_entries_shake_samples() {
    let folder = folder();
    let folder = folder.path();
    read(
        folder,
        "scales = [500.0, 5000.0]\nunit = 'm/s2'\n\
         [[suite.record]]\nfile = 'all/timed.csv'\nacceleration_column = 'up'\nscale = 5\n\
         [[suite.record]]\nfile = 'all/timed.csv'\nacceleration_column = 'north'\nscale = 5\n\
         [uncertain]\nsamples = 3\n\"column.width_m\" = { from = 0.07, to = 0.09 }\n",
    )
    .unwrap();
    done(folder, &["suite", "s.toml", "--out", "results"]);
    let table = Table::read(folder.join("results/uncertain_suite/capacities.csv"));
    // With the scenario itself, and mirrored.
    assert_eq!(table.rows.len(), 4 * 2 * 2);
    for rows in table.rows.chunks(4) {
        let records: Vec<_> = rows.iter().map(|row| row["record"].as_str()).collect();
        let [up, north] = ["all/timed.csv up", "all/timed.csv north"];
        assert_eq!(records, [up, up, north, north]);
        // The samples of one column are three times those of the other.
        let [up, north] = [0, 2].map(|row| rows[row].number("intensity"));
        assert!((north / up - 3.0).abs() < 0.01, "{north} {up}");
    }
}

#[test]
fn faulty_entries_are_refused() {
    let folder = folder();
    let folder = folder.path();
    let entry_of = |keys: &str| format!("[[suite.record]]\n{keys}\n");
    let entry = |keys: &str| format!("scales = [1]\n{}", entry_of(keys));
    fs::write(folder.join("zero.csv"), "0,0\n1,0\n").unwrap();
    fs::write(folder.join("long.csv"), "0,0,0\n30,1,1\n").unwrap();
    fs::copy(folder.join("all/timed.csv"), folder.join("all/timed.csv 2")).unwrap();
    let long = |column: &str| {
        entry_of(&format!(
            "file = 'long.csv'\nunit = 'm/s2'\nacceleration_column = {column}"
        ))
    };
    let smc = "file = 'all/smc.smc'\n";
    let timed = "file = 'all/timed.csv'\nunit = 'm/s2'\nacceleration_column = 2";
    let cases = [
        (
            "scales = [1]\n".to_owned(),
            "[suite] lacks `records`: give a string or an array of at least one, or entries [[suite.record]]",
        ),
        (
            "scales = [1]\nrecord = []\n".to_owned(),
            "[suite] has no records",
        ),
        (
            entry("file = 'zero.csv'\nunit = 'g'\npeak_g = 1"),
            "is zero throughout",
        ),
        (
            "scales = [1]\nrecord = 'smc.smc'\n".to_owned(),
            "must be an array of tables: write [[suite.record]]",
        ),
        (entry(""), "lacks `file`"),
        (entry("file = 'none.smc'"), "does not exist"),
        (
            entry(&format!("{smc}unit = 'g'")),
            "`unit = 'g'` does not apply to this format",
        ),
        (
            entry(&format!("{smc}colour = 'g'")),
            "unknown key `colour` in [suite.record]",
        ),
        (
            entry(&format!("{smc}scale = 0")),
            "scales all accelerations to zero",
        ),
        (
            entry(&format!("{smc}scale = 1\npeak_g = 1")),
            "`peak_g` cannot be combined with `scale`",
        ),
        (
            format!("peaks_g = [1]\n[[suite.record]]\n{smc}scale = 2"),
            "`scale = 2` has no effect beside `peaks_g`",
        ),
        (
            entry(&format!("{smc}[[suite.record]]\n{smc}")),
            "reads all/smc.smc twice",
        ),
        (
            entry(&format!("{timed}\n[[suite.record]]\n{timed}")),
            "reads all/timed.csv 2 twice",
        ),
        // The name of a file is that of a column of another file.
        (
            format!(
                "{}{}{}",
                entry(timed),
                entry_of(&timed.replace("= 2", "= 3")),
                entry_of(
                    &timed
                        .replace(".csv", ".csv 2")
                        .replace("unit", "format = 'csv'\nunit")
                )
            ),
            "reads all/timed.csv 2 twice",
        ),
        (
            format!(
                "records = 'all/smc.smc'\nscales = [1]\n{}{}",
                long("2"),
                long("3")
            ),
            "[suite] has records that last longer than `duration_s` and would be cut off at 20 s: long.csv 2 (30 s), long.csv 3 (30 s)",
        ),
        (
            format!("unit = 'gg'\n{}", entry("file = 'all/timed.csv'")),
            "`unit = 'gg'`",
        ),
        // Defaults that apply to no record.
        (
            format!("unit = 'g'\n{}", entry("file = 'all/smc.smc'")),
            "`unit = 'g'` does not apply to this format",
        ),
        (
            format!("channel = 2\n{}", entry("file = 'all/smc.smc'")),
            "`channel = 2` applies to formats with several channels only",
        ),
        (
            format!("dt_s = 0.1\n{}", entry("file = 'all/smc.smc'")),
            "`dt_s = 0.1` applies to `format = \"csv\"` only",
        ),
        (
            entry("file = 'all/cwb.dat'"),
            "the file has 3 channels: set `channel`",
        ),
        (entry(&format!("{smc}scale = 999999")), "must be at most"),
    ];
    for (keys, words) in cases {
        let errors = read(folder, &keys).expect_err(&keys);
        assert!(errors.contains(words), "{keys}: {errors}");
        assert_eq!(errors.lines().count(), 1, "{keys}: {errors}");
    }
    // The line is that of the key in `[suite]` if it is a default.
    let errors = read(
        folder,
        "unit = 'm/s'\nscales = [1]\n[[suite.record]]\nfile = 'all/timed.csv'",
    )
    .unwrap_err();
    assert!(errors.contains("s.toml:7:8: "), "{errors}");
}

/// A key of `[suite]` that no record takes, because each entry gives its own value or cannot have it, is refused at its place. One record without its own
/// value is enough.
#[test]
fn keys_that_all_entries_replace_are_refused() {
    let folder = folder();
    let folder = folder.path();
    fs::copy(folder.join("all/timed.csv"), folder.join("all/timed2.csv")).unwrap();
    let timed = "[[suite.record]]\nfile = 'all/timed.csv'\n";
    let own = format!("{timed}unit = 'm/s2'\nacceleration_column = 2\n");
    let other = own.replace("timed", "timed2");
    let smc = "[[suite.record]]\nfile = 'all/smc.smc'\n";
    let cwb = "[[suite.record]]\nfile = 'all/cwb.dat'\n";
    let listed = "records = 'all/smc.smc'\n";
    for (key, entries) in [
        ("unit = 'g'", format!("{own}{other}")),
        ("unit = 'g'", format!("{own}{smc}")),
        ("acceleration_column = 3", own.clone()),
        ("skip_rows = 1", format!("{own}skip_rows = 0\n")),
        (
            "decimal = 'comma'",
            format!("{own}decimal = 'point'\n{smc}"),
        ),
        (
            "format = 'csv'",
            format!("{own}format = 'csv'\n{smc}format = 'smc'\n"),
        ),
        ("channel = 2", format!("{cwb}channel = 1\n{smc}")),
        ("time_column = 2", format!("{own}dt_s = 0.01\n")),
        (
            "quantity = 'velocity'",
            format!("{smc}quantity = 'acceleration'\n"),
        ),
        (
            "baseline = 'mean'",
            format!("{smc}baseline = 'linear'\n{own}remove_mean = true\n"),
        ),
        ("high_pass_hz = 1", format!("{smc}high_pass_hz = 2\n")),
    ] {
        let faulty = format!("scales = [1]\n{key}\n{entries}");
        let errors = read(folder, &faulty).expect_err(&faulty);
        let message = format!(
            "s.toml:8:{}: `{key}` has no effect: each entry [[suite.record]] gives",
            key.find(" = ").unwrap() + 4
        );
        assert!(
            errors.contains(&message) && errors.ends_with("leave it out"),
            "{faulty}: {errors}"
        );
        assert_eq!(errors.lines().count(), 1, "{faulty}: {errors}");
        read(folder, &format!("scales = [1]\n{entries}"))
            .unwrap_or_else(|errors| panic!("{entries}: {errors}"));
    }
    // A listed file or an entry uses the key.
    for used in [
        format!(
            "unit = 'm/s2'\n{own}{}",
            other.replace("unit = 'm/s2'\n", "")
        ),
        format!("records = 'all/timed2.csv'\nunit = 'm/s2'\nacceleration_column = 2\n{own}"),
        format!("{listed}high_pass_hz = 1\n{own}high_pass_hz = 2\n"),
    ] {
        suite(folder, &format!("scales = [1]\n{used}"));
    }
    // A listed file of another format does not use the keys of tables.
    let errors = read(folder, &format!("scales = [1]\n{listed}unit = 'g'\n{own}"));
    let errors = errors.unwrap_err();
    assert!(errors.contains("`unit = 'g'` has no effect"), "{errors}");
    // The place is the assignment.
    fs::write(
        folder.join("s.toml"),
        format!("{COLUMN}[suite]\nscales = [1]\n{own}"),
    )
    .unwrap();
    let arguments = ["check", "s.toml", "--set", "suite.unit=g"];
    refused(folder, &arguments, &["--set suite.unit=g", "has no effect"]);
}
