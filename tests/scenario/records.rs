//! Records of ground motion: files, straight lines between samples, and whole histories.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::common::motions::{G, NGA_WEST2, Style, at2, run, scaled, semicircle, synthetic};
use crate::common::program::refused;
use crate::common::{impact_times_s, pairs};
use archrock::dynamics::GroundVelocity;
use archrock::scenario::Ground;
use archrock::{GroundMotion, Outcome, Pulse, Scenario};

const ARCH: &str =
    "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n[ground.record]\n";

/// The scenario with a record's keys, in a folder with these files.
fn scenario(folder: &Path, files: &[(&str, &str)], keys: &str) -> Result<Scenario, String> {
    for (name, text) in files {
        fs::write(folder.join(name), text).unwrap();
    }
    let path = folder.join("s.toml");
    fs::write(&path, format!("{ARCH}{keys}\n")).unwrap();
    Scenario::read(&path).map_err(|errors| errors.to_string())
}

/// The error of straight lines is h^2/8 times the second derivative: 7.7e-6 of the peak for h = 1 ms and a half sine
/// of 0.4 s, and 5e-6 of the resulting velocity.
#[test]
fn a_sampled_half_sine_gives_the_history_of_a_half_sine() {
    let arch = semicircle();
    let (peak, duration) = (-0.3 * G, 0.4);
    let samples: Vec<_> = (0..=400)
        .map(|i| f64::from(i) * 1e-3)
        .map(|t| (t, peak * (PI * t / duration).sin()))
        .collect();
    let sampled = GroundMotion::record(&samples, &[], 0.1).unwrap();
    let exact = Pulse::HalfSine
        .lasting_s(duration)
        .starting_at_s(0.1)
        .horizontal_m_s2(peak)
        .unwrap();
    let ((a, rows_a), (b, rows_b)) = (
        run(&arch, &sampled, G, None, 10.0),
        run(&arch, &exact, G, None, 10.0),
    );
    assert!(a.summary.outcome == Outcome::Rest && b.summary.outcome == Outcome::Rest);
    assert!(a.summary.impacts > 3 && a.summary.peak_rotations_rad[0] > 0.01);
    for (row_a, row_b) in pairs(&rows_a, &rows_b) {
        for (x, y) in pairs(&row_a.rotations_rad, &row_b.rotations_rad) {
            assert!((x - y).abs() < 1e-5, "{} s", row_a.time_s);
        }
    }
    for (x, y) in pairs(impact_times_s(&a), impact_times_s(&b)) {
        // The error of the rotation divided by the rate at which the hinges close.
        assert!((x - y).abs() < 1e-4);
    }
}

/// Additional corners change no value; only the steps of the integration, with errors up to 1e-10, begin elsewhere.
#[test]
fn further_corners_change_nothing() {
    let arch = semicircle();
    let record = scaled(&synthetic(3, 8.0, 0.02), 0.3 * G);
    let ground = GroundMotion::record(&record, &[], 0.0).unwrap();
    let corners: Vec<_> = (1..300).map(|i| f64::from(i) * 0.0251).collect();
    let cut = ground.cut_at(&corners);
    assert!(cut.pieces.len() > ground.pieces.len() + 250);
    for corner in &corners {
        let value = |ground: &GroundMotion| {
            let pieces = &ground.pieces;
            let piece = pieces.iter().rfind(|p| p.start_s <= *corner).unwrap();
            piece.acceleration_and_rate(*corner)
        };
        assert_eq!(value(&ground), value(&cut));
    }
    let ((a, _), (b, _)) = (
        run(&arch, &ground, G, None, 8.0),
        run(&arch, &cut, G, None, 8.0),
    );
    assert!(a.summary.impacts > 48 && a.summary.impacts == b.summary.impacts);
    for (x, y) in pairs(impact_times_s(&a), impact_times_s(&b)) {
        assert!((x - y).abs() < 1e-9);
    }
    let peaks_rad = pairs(a.summary.peak_rotations_rad, b.summary.peak_rotations_rad);
    for (x, y) in peaks_rad {
        assert!((x / y - 1.0).abs() < 1e-9);
    }
}

/// A record cut into two files, which share the sample at the cut, gives the same motion.
#[test]
fn a_record_in_two_files_is_the_same_motion() {
    let record = scaled(&synthetic(7, 6.0, 0.01), 0.3 * G);
    let (first, second) = (&record[..=250], &record[250..]);
    let samples: Vec<Vec<(f64, f64)>> = [&record[..], first, second]
        .into_iter()
        .map(|part| {
            let folder = tempfile::tempdir().unwrap();
            let mut text = String::from("t,a\n");
            for (time_s, acceleration) in part {
                writeln!(text, "{time_s:?},{acceleration:?}").unwrap();
            }
            let keys = "file = 'a.csv'\nunit = \"m/s2\"";
            let scenario = scenario(folder.path(), &[("a.csv", &text)], keys).unwrap();
            let Some(Ground::Record(read)) = scenario.ground.as_ref() else {
                panic!("a record")
            };
            read.main.samples.to_vec()
        })
        .collect();
    let joined = [&samples[1][..], &samples[2][1..]].concat();
    let arch = semicircle();
    let histories = [&samples[0], &joined].map(|samples| {
        let ground = GroundMotion::record(samples, &[], 0.0).unwrap();
        let (history, rows) = run(&arch, &ground, G, None, 12.0);
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
        let rotations: Vec<_> = rows.iter().map(|row| bits(&row.rotations_rad)).collect();
        (bits(&impact_times_s(&history)), rotations)
    });
    assert!(histories[0].0.len() > 20);
    assert_eq!(histories[0], histories[1]);
}

/// The same numbers give the same motion, whatever the file format.
#[test]
fn number_formats_of_a_record_change_no_bit() {
    let folder = tempfile::tempdir().unwrap();
    let record = synthetic(5, 4.0, 0.01);
    let text = at2(&record, "SYNTHETIC", &NGA_WEST2);
    let reference = scenario(folder.path(), &[("a.at2", &text)], "file = 'a.at2'").unwrap();
    let motion = reference.ground_motion();
    assert_eq!(motion.pieces.len(), record.len());
    let Some(Ground::Record(read)) = reference.ground.as_ref() else {
        panic!("a record")
    };
    // Seven digits were written.
    for (sample, original) in pairs(read.main.samples.iter(), &record) {
        assert!((sample.0 - original.0).abs() < 1e-14);
        assert!((sample.1 - original.1).abs() <= 0.5001e-6 * original.1.abs());
    }

    for style in [
        Style {
            counts: "NPTS= {npts} , DT= {dt} SEC,",
            line_end: "\r\n",
            ..NGA_WEST2
        },
        Style {
            counts: "  {npts}    {dt}    NPTS, DT",
            per_line: 8,
            ..NGA_WEST2
        },
        Style {
            counts: "NPTS {npts} DT {dt}SEC",
            gap: "",
            ..NGA_WEST2
        },
        Style {
            counts: "DT={dt} NPTS={npts}",
            per_line: 1,
            ..NGA_WEST2
        },
    ] {
        let text = at2(&record, "SYNTHETIC", &style);
        let read = scenario(folder.path(), &[("b.AT2", &text)], "file = 'b.AT2'").unwrap();
        assert_eq!(read.ground_motion(), motion, "{}", style.counts);
        let keys = "file = 'b.acc'\nformat = 'at2'";
        let read = scenario(folder.path(), &[("b.acc", &text)], keys).unwrap();
        assert_eq!(read.ground_motion(), motion);
    }
    let mut table = "time;x;\"north\"\n".to_owned();
    for (time, acceleration) in read.main.samples.iter() {
        let _ = writeln!(table, "{time:?};0;{acceleration:?}");
    }
    let keys = "file = 'c.csv'\nacceleration_column = 'north'\nunit = 'g'\ntime_column = 1";
    let read = scenario(folder.path(), &[("c.csv", &table)], keys).unwrap();
    assert_eq!(read.ground_motion(), motion);
    assert_eq!(
        Scenario::parse(
            &read.to_toml(),
            &folder.path().join("s.toml").display().to_string()
        ),
        Ok(read)
    );
}

#[test]
fn scales_units_and_starts() {
    let folder = tempfile::tempdir().unwrap();
    let table = "0,1\n0.5,-2\n2,0.5\n";
    let motion = |keys: &str| {
        let keys = format!("file = 'a.csv'\n{keys}\n[simulation]\ngravity_m_s2 = 10.0");
        scenario(folder.path(), &[("a.csv", table)], &keys)
            .unwrap()
            .ground_motion()
            .clone()
    };
    let expected = |factor: f64, start: f64| {
        GroundMotion::record(
            &[(0.0, factor), (0.5, -2.0 * factor), (2.0, 0.5 * factor)],
            &[],
            start,
        )
        .unwrap()
    };
    assert_eq!(motion("unit = 'g'"), expected(10.0, 0.0));
    assert_eq!(motion("unit = 'm/s2'\nscale = -0.5"), expected(-0.5, 0.0));
    assert_eq!(motion("unit = 'cm/s2'\nstart_s = 1.5"), expected(0.01, 1.5));
    for unit in ["g", "m/s2", "cm/s2"] {
        assert_eq!(
            motion(&format!("unit = '{unit}'\npeak_g = 0.4")),
            expected(2.0, 0.0)
        );
    }
    let vertical = motion("unit = 'm/s2'\ncomponent = 'vertical'");
    assert_eq!(
        vertical,
        GroundMotion::record(&[], &[(0.0, 1.0), (0.5, -2.0), (2.0, 0.5)], 0.0).unwrap()
    );
}

/// Straight lines of velocity are constant accelerations, so a step pair of accelerations is a velocity record of three
/// samples: the same history, to rounding.
#[test]
fn a_record_of_velocities_is_the_pulse_that_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let (a_g, duration_s) = (-0.35, 0.25);
    let top_cm_s = 100.0 * a_g * G * duration_s;
    // A constant velocity before and after has no effect.
    let table = format!("0.1,7\n0.35,{:?}\n0.85,7\n", 7.0 + top_cm_s);
    let keys = "file = 'v.csv'\nunit = 'cm/s'\nquantity = 'velocity'";
    let read = scenario(folder.path(), &[("v.csv", &table)], keys).unwrap();
    let pulse = Pulse::StepPair
        .lasting_s(duration_s)
        .starting_at_s(0.1)
        .horizontal_m_s2(a_g * G)
        .unwrap();
    let arch = semicircle();
    let ((a, rows_a), (b, rows_b)) = (
        run(&arch, read.ground_motion(), G, None, 10.0),
        run(&arch, &pulse, G, None, 10.0),
    );
    assert_eq!(a.summary.outcome, b.summary.outcome);
    assert!(a.summary.impacts > 3 && a.summary.peak_rotations_rad[0] > 0.01);
    for (row_a, row_b) in pairs(&rows_a, &rows_b) {
        for (x, y) in pairs(&row_a.rotations_rad, &row_b.rotations_rad) {
            assert!((x - y).abs() < 1e-8, "{} s", row_a.time_s);
        }
    }
    // The steepest line is the peak acceleration, and the resolved scenario reads back.
    let Some(Ground::Record(record)) = read.ground.as_ref() else {
        panic!("a record")
    };
    assert!((record.main.peak_g(G) - 0.35).abs() < 1e-12);
    let name = folder.path().join("s.toml").display().to_string();
    assert_eq!(Scenario::parse(&read.to_toml(), &name), Ok(read));
}

/// The ground has the recorded velocities at the times of the samples, and the displacements of the trapezoids below them.
#[test]
fn the_ground_has_the_recorded_velocities() {
    let folder = tempfile::tempdir().unwrap();
    let velocities: Vec<(f64, f64)> = synthetic(7, 3.0, 0.02)
        .iter()
        .enumerate()
        .map(|(i, (t, v))| (t + 0.003 * (i as f64).sin(), v - 0.3))
        .map(|(t, v)| (t.max(0.0), v))
        .collect();
    let mut table = String::new();
    for (t, v) in &velocities {
        let _ = writeln!(table, "{t:?} {v:?}");
    }
    let keys = "file = 'v.txt'\nunit = 'm/s'\nquantity = 'velocity'\nscale = -0.05\nstart_s = 0.7";
    for (component, axis) in [("horizontal", 0), ("vertical", 1)] {
        let keys = format!("{keys}\ncomponent = '{component}'");
        let read = scenario(folder.path(), &[("v.txt", &table)], &keys).unwrap();
        let velocity = GroundVelocity::new(read.ground_motion());
        let times: Vec<f64> = velocities.iter().map(|(t, _)| 0.7 + t).collect();
        let displacements = velocity.displacements_m(&times);
        let mut expected_m = 0.0;
        for (i, (t, v)) in velocities.iter().enumerate() {
            let gained = |v: f64| -0.05 * (v - velocities[0].1);
            if i > 0 {
                let (t0, v0) = velocities[i - 1];
                expected_m += 0.5 * (gained(*v) + gained(v0)) * (t - t0);
            }
            assert!(
                (velocity.velocity_at(0.7 + t)[axis] - gained(*v)).abs() < 1e-11,
                "{t}"
            );
            assert!((displacements[i][axis] - expected_m).abs() < 1e-11, "{t}");
        }
    }
}

/// A table with rows as PEER writes them, with the header before it or not, gives the motion of the AT2 file; so does one
/// with six columns.
#[test]
fn rows_of_several_samples_are_the_samples_one_after_another() {
    let folder = tempfile::tempdir().unwrap();
    // 401 samples do not fill lines of 5, 400 do.
    for (count, header_counts) in [(401, false), (400, true), (400, false)] {
        let record: Vec<_> = synthetic(5, 4.2, 0.01).into_iter().take(count).collect();
        let text = at2(&record, "SYNTHETIC", &NGA_WEST2);
        let reference = scenario(folder.path(), &[("a.at2", &text)], "file = 'a.at2'").unwrap();
        let silent = Style {
            counts: "many samples, one every {dt} s",
            ..NGA_WEST2
        };
        let text = match header_counts {
            true => text,
            false => at2(&record, "SYNTHETIC", &silent),
        };
        let keys = "file = 'a.txt'\nunit = 'g'\ndt_s = 0.01\nskip_rows = 4";
        let read = |keys: &str| scenario(folder.path(), &[("a.txt", &text)], keys);
        let message = read(keys).unwrap_err();
        assert!(
            message.contains("a.txt:5: there are 5 columns"),
            "{message}"
        );
        let found = read(&format!("{keys}\nwrapped = true")).unwrap();
        assert_eq!(found.ground_motion(), reference.ground_motion());
        let name = folder.path().join("s.toml").display().to_string();
        assert_eq!(Scenario::parse(&found.to_toml(), &name), Ok(found));
        // A single column is read if it is chosen, and no row is cut.
        if count == 401 {
            continue;
        }
        let first = read(&format!("{keys}\nacceleration_column = 1")).unwrap();
        let Some(Ground::Record(first)) = first.ground.as_ref() else {
            panic!("a record")
        };
        assert_eq!(first.main.samples.len(), count.div_ceil(5));
    }
}

/// Excel's "Unicode text" and the text of old Macs are recognised, also for scenarios.
#[test]
fn files_that_are_not_plain_text_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    let text = format!("{ARCH}file = 'a.at2'\n");
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for (bytes, words) in [
        (wide, "s.toml: the file is UTF-16 text"),
        (
            text.replace('\n', "\r").into_bytes(),
            "s.toml: the lines end with a carriage return alone (CR)",
        ),
    ] {
        fs::write(&path, bytes).unwrap();
        let message = Scenario::read(&path).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
    let table = "t,a\n0,0\n1,1\n";
    let utf_16 = |order: fn(u16) -> [u8; 2], mark: &[u16]| -> Vec<u8> {
        let units = mark.iter().copied().chain(table.encode_utf16());
        units.flat_map(order).collect()
    };
    for bytes in [
        utf_16(u16::to_le_bytes, &[0xfeff]),
        utf_16(u16::to_be_bytes, &[0xfeff]),
        utf_16(u16::to_le_bytes, &[]),
    ] {
        fs::write(folder.path().join("a.csv"), bytes).unwrap();
        for keys in [
            "file = 'a.csv'\nunit = 'g'",
            "file = 'a.csv'\nformat = 'at2'",
        ] {
            let message = scenario(folder.path(), &[], keys).unwrap_err();
            assert!(
                message.contains("a.csv:1: the file is UTF-16 text"),
                "{message}"
            );
            assert!(message.contains("save it as UTF-8"), "{message}");
        }
    }
}

/// Errors in the keys and in the file, each with its place.
#[test]
fn faulty_records_are_input_errors() {
    let folder = tempfile::tempdir().unwrap();
    let short = "A\nNPTS= 3, DT= .01\n.1 .2\n";
    let files = [
        ("short.at2", short),
        ("zero.csv", "0,0\n1,0\n"),
        ("early.csv", "-2,0\n1,0\n"),
        ("good.csv", "0,0\n1,1\n"),
        ("six.csv", "0,1,2\n3,4,5\n"),
        ("huge.csv", "0,0\n1,1e308\n"),
        ("mac.csv", "0,0\r1,1\r"),
    ];
    for (keys, place, words) in [
        (
            "file = 'short.at2'",
            "6:8",
            "short.at2:3: the number of samples is 2: line 2 announces 3 (NPTS)",
        ),
        (
            "file = 'none.at2'",
            "6:8",
            "`file = 'none.at2'` cannot be read",
        ),
        (
            "file = '.'\nformat = 'csv'\nunit = 'g'",
            "6:8",
            "is not a file",
        ),
        (
            "file = 'x.rec'",
            "6:8",
            "has an unknown extension: give `format`",
        ),
        (
            "scale = 1.0\nformat = 'at2'",
            "5:1",
            "[ground.record] lacks `file`",
        ),
        (
            "file = 'good.csv'",
            "5:1",
            "lacks `unit`: give one of \"g\", \"m/s2\", \"cm/s2\"",
        ),
        (
            "file = 'good.csv'\nunit = 'g'\nscale = 1\npeak_g = 1",
            "9:10",
            "cannot be combined with `scale`",
        ),
        (
            "file = 'zero.csv'\nunit = 'g'\npeak_g = 1",
            "8:10",
            "zero throughout",
        ),
        (
            "file = 'early.csv'\nunit = 'g'",
            "6:8",
            "`start_s` of at least 2,",
        ),
        (
            "file = 'good.csv'\nunit = 'g'\nscale = 2000",
            "6:8",
            "reaches 2000 g",
        ),
        (
            "file = 'good.csv'\nunit = 'g'\nacceleration_column = 0",
            "8:23",
            "a whole number from 1",
        ),
        (
            "file = 'good.csv'\nunit = 'g'\ntime_column = 'tt'",
            "6:8",
            "good.csv:1: there is no column named `tt`",
        ),
        (
            "file = 'six.csv'\nunit = 'g'\ndt_s = 0.01",
            "6:8",
            "six.csv:1: there are 3 columns: set `acceleration_column` to the column to read, or `wrapped = true`, if a row \
             holds samples",
        ),
        (
            "file = 'six.csv'\nunit = 'g'",
            "6:8",
            "six.csv:1: there are 3 columns: set `acceleration_column` to the column to read, or `dt_s` and `wrapped = true`, if a row holds samples",
        ),
        (
            "file = 'six.csv'\nunit = 'g'\ndt_s = 0.01\nwrapped = true\nacceleration_column = 1",
            "9:11",
            "`wrapped = true` cannot be combined with `acceleration_column`",
        ),
        (
            "file = 'six.csv'\nunit = 'g'\nwrapped = true",
            "8:11",
            "`wrapped = true` needs `dt_s`",
        ),
        (
            "file = 'good.csv'\nunit = 'cm/s'",
            "7:8",
            "`unit = 'cm/s'` is a unit of velocity; give `quantity = \"velocity\"`",
        ),
        (
            "file = 'good.csv'\nunit = 'g'\nquantity = 'velocity'",
            "7:8",
            "`unit = 'g'` is a unit of acceleration; leave out `quantity",
        ),
        (
            "file = 'good.csv'\nunit = 'm/s'\nquantity = 'velocity'\nremove_mean = true",
            "9:15",
            "applies to accelerations",
        ),
        (
            "file = 'x.NS2'\nquantity = 'velocity'",
            "7:12",
            "does not apply to a file of K-NET",
        ),
        (
            "file = 'x.ud'\nunit = 'g'",
            "7:8",
            "does not apply to a file of K-NET, whose header has a Scale Factor",
        ),
        (
            "file = 'huge.csv'\nunit = 'g'",
            "6:8",
            "huge.csv:2: `1e308` is out of range; samples must be at most 1e12 in magnitude",
        ),
        (
            "file = 'mac.csv'\nunit = 'g'",
            "6:8",
            "mac.csv:1: the lines end with a carriage return alone (CR)",
        ),
        (
            "file = 'short.at2'\ntime_column = 1",
            "7:15",
            "applies to `format = \"csv\"` only",
        ),
        (
            "file = 'good.csv'\nunit = 'g'\ncomponent = 'vertical'\nscale = 0.1\n[ground.record.vertical]\nfile = 'good.csv'\nunit = 'g'",
            "10:1",
            "cannot be combined with `component = \"vertical\"`",
        ),
    ] {
        let message = scenario(folder.path(), &files, keys).expect_err(keys);
        assert!(
            message.contains(&format!("s.toml:{place}: ")),
            "{keys}: {message}"
        );
        assert!(message.contains(words), "{keys}: {message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn a_faulty_record_ends_the_program_with_two() {
    let folder = tempfile::tempdir().unwrap();
    let text = "A\nNPTS= 3, DT= .01\n.1 oops .2\n";
    let _ = scenario(folder.path(), &[("a.at2", text)], "file = 'a.at2'");
    let words = "s.toml:6:8: `file = 'a.at2'` is faulty: a.at2:3: `oops` is not a finite number";
    refused(
        folder.path(),
        &["run", "--out", "results", "s.toml"],
        &[words],
    );
    assert!(!folder.path().join("results").exists());
}

/// A minute of strong motion, in both directions: the work of the ground, summed by the integrator, equals the
/// energy that the impacts took plus that of the arch.
#[test]
fn energy_balances_over_a_minute() {
    let arch = semicircle();
    let horizontal = scaled(&synthetic(1, 60.0, 0.005), 0.25 * G);
    let vertical = scaled(&synthetic(2, 60.0, 0.005), 0.15 * G);
    for vertical in [Vec::new(), vertical] {
        let ground = GroundMotion::record(&horizontal, &vertical, 0.0).unwrap();
        assert!(ground.pieces.len() >= 12_000);
        let (history, _) = run(&arch, &ground, G, None, 70.0);
        assert_eq!(history.summary.outcome, Outcome::Rest);
        assert!(history.summary.impacts > 48);
        let defect = history.summary.energy_defect_ratio;
        assert!(defect > 0.0 && defect < 1e-6, "{defect}");
    }
}

/// The mirrored record makes the mirrored history, to the last bit.
#[test]
fn a_mirrored_record_mirrors_the_history() {
    let arch = semicircle();
    let record = scaled(&synthetic(7, 10.0, 0.02), 0.35 * G);
    let vertical = scaled(&synthetic(8, 10.0, 0.02), 0.2 * G);
    let ground = GroundMotion::record(&record, &vertical, 0.0).unwrap();
    let mirrored = GroundMotion::record(&scaled(&record, -1.0), &vertical, 0.0).unwrap();
    let ((a, rows_a), (b, rows_b)) = (
        run(&arch, &ground, G, None, 12.0),
        run(&arch, &mirrored, G, None, 12.0),
    );
    assert!(a.summary.impacts > 10 && a.summary.impacts == b.summary.impacts);
    for (x, y) in pairs(&rows_a, &rows_b) {
        let from_right = y.rotations_rad.iter().rev();
        let seen_in_mirror: Vec<f64> = from_right.map(|rotation| 0.0 - rotation).collect();
        assert_eq!(x.rotations_rad, seen_in_mirror);
    }
}

/// The record among the scenarios comes from this generator: run with ARCHROCK_REGENERATE=1 to write it again.
#[test]
fn the_repository_record_matches_its_generator() {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let generated = scaled(&synthetic(2024, 20.0, 0.02), 0.3);
    let title = "Synthetic: tests/common/motions.rs, synthetic(2024, 20 s, 0.02 s), peak 0.3 g";
    let file = scenarios.join("synthetic.at2");
    if std::env::var_os("ARCHROCK_REGENERATE").is_some() {
        fs::write(&file, at2(&generated, title, &NGA_WEST2)).unwrap();
    }
    assert!(fs::read_to_string(&file).unwrap().contains(title));
    let scenario = Scenario::read(&scenarios.join("semicircle-record.toml")).unwrap();
    let Some(Ground::Record(record)) = scenario.ground.as_ref() else {
        panic!("a record")
    };
    for (sample, original) in pairs(record.main.samples.iter(), &generated) {
        // Seven digits, and sines that differ between platforms in the last digit.
        assert!((sample.1 - original.1).abs() < 0.51e-6 * original.1.abs() + 1e-15);
    }
}
