//! Records of which a part may be missing: peaks and numbers of samples in headers, and the times of tables.

use std::fs;
use std::path::Path;

use archrock::scenario::{Contents, Format, Layout, LineFault, TableColumn, Times, Unit};
use serde_json::Value;

use crate::common::ARCH;
use crate::common::program::{archrock, refusal, stderr, stdout};

/// Samples of the K-NET file, 12 s at 100 Hz.
const COUNT: usize = 1200;

/// Counts of 5000, of which one has 1 200 000 more: without the mean it is 1 199 000. A count is 0.001 gal.
fn knet_counts() -> Vec<i64> {
    let mut counts = vec![5000; COUNT];
    counts[600] += 1_200_000;
    counts
}

fn knet(counts: &[i64], duration_s: &str, peak: &str) -> String {
    let rows = counts.chunks(8).map(|row| {
        let row: String = row.iter().map(|count| format!("{count:>9}")).collect();
        row + "\n"
    });
    format!(
        "Origin Time       2024/01/02 03:04:05\nStation Code      XXX001\nSampling Freq(Hz) 100Hz\nDuration Time(s)  {duration_s}\n\
         Dir.              E-W\nScale Factor      1(gal)/1000\n{peak}\nMemo.\n{}",
        rows.collect::<String>()
    )
}

#[test]
fn a_file_of_knet_is_compared_with_its_header() {
    let read = |counts: &[i64], duration_s: &str, peak: &str| {
        Layout::new(Format::KNET).parse(knet(counts, duration_s, peak).as_bytes())
    };
    let whole = knet_counts();
    for peak in [
        "Max. Acc. (gal)   1199.000",
        "Max Acc. (gal)    1199.000",
        // The digits that the header gives, and 1 %.
        "Max. Acc. (gal)   1198.7",
        "Max. Acc. (gal)   1188",
        "Max. Acc. (gal)   1210",
    ] {
        assert_eq!(read(&whole, "12", peak).unwrap().difference, None, "{peak}");
    }
    let stated = "Max. Acc. (gal)   1199.000";
    let difference = |contents: Result<Contents, LineFault>| contents.unwrap().difference;
    for peak in ["1150.000", "1230.000", "1215.000"] {
        let warning = format!(
            "reaches 1199 cm/s2 without its mean, but its header states a peak of {} cm/s2: are samples damaged?",
            peak.trim_end_matches(".000")
        );
        let found = difference(read(&whole, "12", &stated.replace("1199.000", peak)));
        assert_eq!(found, Some(warning), "{peak}");
    }
    // 96 samples around the peak are cut out.
    let cut = [&whole[..552], &whole[648..]].concat();
    let fault = read(&cut, "12", stated).unwrap_err();
    assert_eq!(fault.line, 8 + 1104 / 8);
    let words = "the file ends after 1104 samples, 11.04 s: line 4 announces 12 s (Duration Time(s)), 1200 samples";
    assert_eq!(fault.message, words);
    // Whole seconds are cut out, and the header is corrected.
    let cut = [&whole[..550], &whole[650..]].concat();
    let found = difference(read(&cut, "11", stated)).unwrap();
    assert!(
        found.contains("reaches 0 cm/s2 without its mean"),
        "{found}"
    );
    // One sample more or less is a warning, two are an error.
    let missing = difference(read(&whole[1..], "12", stated));
    assert_eq!(
        missing.as_deref(),
        Some("has 1199 samples, but its header announces 1200")
    );
    let fault = read(&whole[2..], "12", stated).unwrap_err();
    assert!(fault.message.contains("after 1198 samples"), "{fault:?}");
    let more = [&whole[..], &[5000, 5000]].concat();
    let fault = read(&more, "12", stated).unwrap_err();
    let remedy =
        "1200 samples; delete the last 2, if they are not of this record, or correct line 4";
    assert!(fault.message.ends_with(remedy), "{fault:?}");
    // The warning reaches `check` and `run`.
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("k.EW"),
        knet(&whole, "12", &stated.replace("1199", "1499")),
    )
    .unwrap();
    let scenario =
        format!("{ARCH}[ground.record]\nfile = 'k.EW'\nscale = 0.1\nbaseline = 'mean'\n");
    fs::write(folder.path().join("s.toml"), scenario).unwrap();
    for arguments in [["check", "k.EW"], ["check", "s.toml"], ["run", "s.toml"]] {
        let warnings = stderr(&archrock(folder.path(), &arguments));
        let warning = "warning: k.EW reaches 1199 cm/s2 without its mean, but its header states a peak of 1499 cm/s2";
        assert!(warnings.contains(warning), "{arguments:?} {warnings}");
    }
}

#[test]
fn a_file_of_esm_is_compared_with_its_header() {
    let read = |peak: &str| {
        let text = format!(
            "EVENT_ID: X\nSAMPLING_INTERVAL_S: 0.005\nNDATA: 4\nUNITS: cm/s^2\n{peak}\nDATA_TYPE: ACCELERATION\nUSER5:\n0.5\n-1.631975\n0.75\n0.0\n"
        );
        Layout::new(Format::ASC)
            .parse(text.as_bytes())
            .unwrap()
            .difference
    };
    for peak in [
        "PGA_CM/S^2: -1.632",
        "PGA_CM/S^2: 1.631975",
        "PGA_CM/S^2: 1.6",
        "PGA_CM/S^2:",
        "PGV_CM/S: 9",
    ] {
        assert_eq!(read(peak), None, "{peak}");
    }
    let warning =
        "reaches 1.63197 cm/s2, but its header states a peak of 1.95 cm/s2: are samples damaged?";
    assert_eq!(read("PGA_CM/S^2: -1.950").as_deref(), Some(warning));
    let velocity = "EVENT_ID: X\nSAMPLING_INTERVAL_S: 0.005\nUNITS: cm/s\nPGV_CM/S: 3.0\nDATA_TYPE: VELOCITY\n0.5\n-1.6\n0.75\n";
    let layout = Layout {
        quantity: archrock::scenario::RecordedQuantity::Velocity,
        ..Layout::new(Format::ASC)
    };
    let difference = layout
        .parse(velocity.as_bytes())
        .unwrap()
        .difference
        .unwrap();
    assert!(difference.starts_with("reaches 1.6 cm/s, but its header states a peak of 3 cm/s"));
}

fn timed() -> Layout {
    Layout::table(Times::Column(TableColumn::Number(1)), Unit::MetrePerS2)
}

/// A table of 400 rows, each with its time as `write` writes it.
fn table(step_s: f64, from_s: f64, write: impl Fn(f64) -> String) -> Vec<String> {
    let row = |index: usize| {
        let time = write(from_s + index as f64 * step_s);
        format!("{time},{}\n", (index % 7) as f64 - 3.0)
    };
    (0..400).map(row).collect()
}

/// A number with six significant digits, as many programs print it.
fn six_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap();
    format!("{rounded}")
}

#[test]
fn gaps_of_a_table_have_a_line() {
    let rows = table(0.01, 0.0, |time| format!("{time:.2}"));
    let difference = |rows: &[String]| timed().parse(rows.concat().as_bytes()).unwrap().difference;
    assert_eq!(difference(&rows), None);
    let without = |index: usize, count: usize| [&rows[..index], &rows[index + count..]].concat();
    for (rows, words) in [
        (
            without(200, 1),
            "has a step of 0.02 s up to line 201, but the others take 0.01 s: are rows missing?",
        ),
        (without(1, 1), "has a step of 0.02 s up to line 2, but"),
        (without(398, 1), "has a step of 0.02 s up to line 399, but"),
        (without(100, 50), "has a step of 0.51 s up to line 101, but"),
        (
            [without(50, 1), vec!["4.02,1\n".to_owned()]].concat(),
            "up to line 51, and 1 more such steps, but",
        ),
        // A time that is wrong: the step before it is long, the one after it short.
        (
            [&rows[..10], &["0.108,1\n".to_owned()], &rows[11..]].concat(),
            "has a step of 0.018 s up to line 11, but",
        ),
    ] {
        let found = difference(&rows).expect(words);
        assert!(found.contains(words), "{found}");
    }
    // Few rows, names and comments above them.
    let few = "# made up\nt,a\n0,1\n0.01,2\n0.03,-1\n0.04,0\n";
    let found = timed().parse(few.as_bytes()).unwrap().difference.unwrap();
    assert!(
        found.starts_with("has a step of 0.02 s up to line 5, but"),
        "{found}"
    );
    // Corners of a line at unequal steps are no gap.
    for corners in ["0,1\n0.5,-2\n2,0.5\n", "0,0\n0.1,1\n0.5,-2\n0.6,3\n2,0.5\n"] {
        assert_eq!(timed().parse(corners.as_bytes()).unwrap().difference, None);
    }
}

/// Rounding makes equal steps unequal: by six digits up to 0.001 s beyond 100 s.
#[test]
fn rounded_times_are_equal_steps() {
    let folder = tempfile::tempdir().unwrap();
    for step_s in [
        0.0025,
        0.004,
        0.005,
        1.0 / 128.0,
        1.0 / 256.0,
        1.0 / 300.0,
        0.01,
        0.02,
    ] {
        for from_s in [0.0, 9.0, 42.0, 99.0, 250.0] {
            let rows = table(step_s, from_s, six_digits);
            let contents = timed().parse(rows.concat().as_bytes()).unwrap();
            assert_eq!(contents.difference, None, "{step_s} {from_s}");
            fs::write(folder.path().join("r.csv"), rows.concat()).unwrap();
            let said = archrock(
                folder.path(),
                &["check", "r.csv", "--set", "unit=m/s2", "--format", "json"],
            );
            let said: Value = serde_json::from_str(&stdout(&said)).unwrap();
            let found_s = said["dt_s"].as_f64().expect("a constant step");
            // Both ends are rounded to half of the last digit.
            assert!(
                (found_s - step_s).abs() < 1.1e-3 / 399.0,
                "{step_s} {from_s} {found_s}"
            );
            assert_eq!(said["samples"], 400);
            // A row that is missing there is found as well, unless the rounding is as large as the step.
            let gap = [&rows[..300], &rows[301..]].concat();
            fs::write(folder.path().join("r.csv"), gap.concat()).unwrap();
            let output = archrock(
                folder.path(),
                &["check", "r.csv", "--set", "unit=m/s2", "--format", "json"],
            );
            let said: Value = serde_json::from_str(&stdout(&output)).unwrap();
            assert!(said["dt_s"].is_null(), "{step_s} {from_s}");
            let warnings = stderr(&output);
            assert!(
                warnings.contains(" s up to line 301, but the others"),
                "{step_s} {from_s} {warnings}"
            );
        }
    }
    // Times with too few digits repeat.
    let rows = table(0.004, 0.0, |time| format!("{time:.2}"));
    let fault = timed().parse(rows.concat().as_bytes()).unwrap_err();
    assert_eq!(fault.line, 2);
    let words = "times repeat the one before; allowed are steps of at least 1e-6 s: if times are rounded, give them with more digits, or the step";
    assert!(fault.message.contains(words), "{fault:?}");
}

#[test]
fn repeated_times_of_a_table_drop_their_second_sample() {
    let mut rows = table(0.01, 0.0, |time| format!("{time:.2}"));
    rows.insert(12, "0.11,99\n".to_owned());
    let contents = timed().parse(rows.concat().as_bytes()).unwrap();
    assert_eq!(contents.samples.len(), 400);
    assert!(contents.samples.iter().all(|sample| sample.1 < 99.0));
    let warning = "repeats the time 0.11 s on line 13: its second sample, 99, is left out";
    assert_eq!(contents.difference.as_deref(), Some(warning));
    rows.insert(100, rows[99].clone());
    rows.insert(300, rows[299].clone());
    let found = timed()
        .parse(rows.concat().as_bytes())
        .unwrap()
        .difference
        .unwrap();
    assert!(
        found.ends_with("is left out, as are those at 2 more"),
        "{found}"
    );
    // A file that also has a gap gets both phrases.
    let found = timed().parse([&rows[..50], &rows[51..]].concat().concat().as_bytes());
    let found = found.unwrap().difference.unwrap();
    assert!(
        found.contains("2 more. It also has a step of 0.02 s up to line 51, but"),
        "{found}"
    );
}

#[test]
fn blank_lines_among_samples_are_doubtful() {
    let step = Layout::table(Times::Step(0.01), Unit::MetrePerS2);
    for (layout, text, line) in [
        (&step, "1\n2\n\n-3\n4\n", Some("line 3")),
        (
            &step,
            "# made up\na\n1\n2\n \n-3\n\n4\n",
            Some("line 5 and 1 more"),
        ),
        (
            &timed(),
            "0,1\r\n0.01,2\r\n\r\n0.02,-3\r\n0.03,4\r\n",
            Some("line 3"),
        ),
        // Above, below, beside comments, and after each row.
        (&step, "\n1\n2\n-3\n4\n\n\n", None),
        (&step, "a\n\n1\n# half\n2\n% half\n-3\n4", None),
        (&step, "1\n\n2\n\n-3\n\n4\n", None),
    ] {
        let found = layout.parse(text.as_bytes()).unwrap().difference;
        let warning = line
            .map(|line| format!("has a blank line among its samples ({line}): are rows missing?"));
        assert_eq!(found, warning, "{text:?}");
    }
}

/// The remedy for a column of samples is its step: without a line it would lack its first sample.
#[test]
fn a_column_below_a_comment_needs_its_step() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# points: 4, dt: 0.005\n0.0\n0.1\n0.2\n0.1\n";
    fs::write(folder.path().join("c.txt"), text).unwrap();
    let check = |keys: &[&str]| {
        let keys = keys.iter().flat_map(|key| ["--set", *key]);
        let arguments: Vec<_> = ["check", "c.txt", "--set", "unit=g"]
            .into_iter()
            .chain(keys)
            .collect();
        archrock(folder.path(), &arguments)
    };
    let said = refusal(&check(&[]));
    assert!(said.contains("c.txt:2: there is no column 2 in `0.0`; if the file has accelerations only, give `dt_s`\n"), "{said}");
    let said = stdout(&check(&["dt_s=0.005"]));
    assert!(said.contains("4 samples every 0.005 s"), "{said}");
    // A number of samples above a table is no row of it.
    fs::write(
        folder.path().join("c.txt"),
        "3\n0 0.1\n0.01 0.2\n0.02 0.1\n",
    )
    .unwrap();
    let said = refusal(&check(&[]));
    assert!(
        said.contains("numbers begin on line 2: give `skip_rows = 1`"),
        "{said}"
    );
}

/// Tenths of gravity, and no question about a unit that the file states.
#[test]
fn units_of_files_are_not_questioned() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let check = |file: &str, keys: &[&str]| {
        let keys = keys.iter().flat_map(|key| ["--set", *key]);
        let arguments: Vec<_> = ["check", file].into_iter().chain(keys).collect();
        let output = archrock(folder.path(), &arguments);
        (stdout(&output), stderr(&output))
    };
    write("t.csv", "0,1\n0.01,-5\n0.02,2\n");
    let (said, _) = check("t.csv", &["unit=G/10"]);
    assert!(said.contains("accelerations in g/10 "), "{said}");
    assert!(
        said.contains("peak acceleration 0.5000 g = 4.9050 m/s2"),
        "{said}"
    );
    let at2 = |unit: &str, factor: f64| {
        let samples = [0.1, -0.3, 0.2]
            .map(|sample| format!("{}\n", factor * sample))
            .concat();
        format!("PEER\nACCELERATION TIME SERIES{unit}\nNPTS= 3, DT= .01 SEC\n{samples}")
    };
    write("weak.at2", &at2(" IN UNITS OF G", 0.01));
    write("strong.at2", &at2(" IN UNITS OF G", 20.0));
    write("silent.at2", &at2("", 20.0));
    write("named.csv", "t,a (g)\n0,0.001\n0.01,-0.002\n0.02,0\n");
    for (file, keys, warning) in [
        (
            "weak.at2",
            &[][..],
            "weak.at2 peaks at 0.003 g: weaker motions than 0.01 g move no masonry\n",
        ),
        (
            "strong.at2",
            &[],
            "strong.at2 peaks at 6 g: are its samples damaged?\n",
        ),
        (
            "named.csv",
            &["unit=g"],
            "named.csv peaks at 0.002 g: weaker motions than 0.01 g move no masonry\n",
        ),
        // A unit that the user gives, or that is only a default, is questioned.
        (
            "strong.at2",
            &["unit=g"],
            "strong.at2 peaks at 6 g: is its unit \"g\"? It looks like m/s2\n",
        ),
        (
            "silent.at2",
            &[],
            "silent.at2 peaks at 6 g: is its unit \"g\"? It looks like m/s2\n",
        ),
        (
            "t.csv",
            &["unit=g"],
            "t.csv peaks at 5 g: is its unit \"g\"? It looks like m/s2\n",
        ),
    ] {
        let (_, warnings) = check(file, keys);
        assert_eq!(warnings, format!("warning: {warning}"), "{file}");
    }
    let scaled = |keys: &str| {
        write(
            "s.toml",
            &format!("{ARCH}[ground.record]\nfile = 'weak.at2'\n{keys}\n"),
        );
        stderr(&archrock(folder.path(), &["check", "s.toml"]))
    };
    assert_eq!(
        scaled("scale = 2"),
        "warning: weak.at2 peaks at 0.006 g: is `scale` 2?\n"
    );
    assert!(Path::new("weak.at2").is_relative() && scaled("scale = 100").is_empty());
}
