//! Formats of networks, recognised by their content: the smallest file of each (`formats/`, made up), and damaged ones.
//!
//! All files hold the same ten samples, in their unit.

use std::fs;
use std::path::{Path, PathBuf};

use archrock::scenario::{
    Contents, Format, Layout, LineFault, RecordedQuantity, Scenario, TableColumn, Unit,
    format_of_file,
};

use serde_json::{Value, json};

use crate::common::ARCH;
use crate::common::program::{archrock, refusal, stderr, stdout};

/// Accelerations of all files, in cm/s2.
const SAMPLES: [f64; 10] = [0.5, -1.25, 2.0, -0.75, 1.5, -2.5, 0.25, 0.0, 1.0, -0.5];
/// Velocities of the files that hold them, in cm/s.
const VELOCITIES: [f64; 10] = [
    0.0, -0.004, 0.004, 0.016, 0.024, 0.014, -0.009, -0.006, 0.004, 0.009,
];

/// The files, their formats and units, and the value of 1 cm/s2 in the file.
const FILES: [(&str, Format, Unit, f64); 10] = [
    ("smc.smc", Format::SMC, Unit::CentimetrePerS2, 1.0),
    ("csmip.v1", Format::CSMIP, Unit::Gravity, 0.001),
    ("csmip.v2", Format::CSMIP, Unit::CentimetrePerS2, 1.0),
    ("renadic.v1", Format::CSMIP, Unit::Gravity, 0.1),
    ("usc.m0a", Format::USC, Unit::Gravity, 0.1),
    ("usc.s0a", Format::USC, Unit::CentimetrePerS2, 1.0),
    ("cosmos.v2", Format::COSMOS, Unit::CentimetrePerS2, 1.0),
    ("geonet.v1a", Format::GEONET, Unit::MillimetrePerS2, 10.0),
    ("geonet.v2a", Format::GEONET, Unit::MillimetrePerS2, 10.0),
    ("csmnc.dat", Format::CSMNC, Unit::CentimetrePerS2, 1.0),
];

/// Files with several columns, and their channel with the samples.
const COLUMNS: [(&str, Format, &str, usize); 3] = [
    ("afad.txt", Format::AFAD, "N-S", 1),
    ("cwb.dat", Format::CWB, "n", 2),
    ("unam.asa", Format::UNAM, "n00e", 1),
];

fn path(name: &str) -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    tests.join("scenario/formats").join(name)
}

fn text(name: &str) -> String {
    fs::read_to_string(path(name)).unwrap()
}

fn format(name: &str) -> Format {
    FILES.iter().find(|file| file.0 == name).unwrap().1
}

fn parse(layout: &Layout, text: &str) -> Result<Contents, LineFault> {
    layout.parse(text.as_bytes())
}

#[track_caller]
fn assert_values(contents: &Contents, expected: &[f64], factor: f64) {
    assert_eq!(contents.samples.len(), expected.len());
    for (sample, expected) in contents.samples.iter().zip(expected) {
        assert!((sample.1 - factor * expected).abs() < 1e-12, "{sample:?}");
    }
}

/// The layout with this channel.
fn choose(format: Format, channel: usize) -> Layout {
    Layout {
        channel: Some(TableColumn::Number(channel)),
        ..Layout::new(format)
    }
}

/// A fault in the text with one part replaced.
#[track_caller]
fn assert_fault(name: &str, (old, new): (&str, &str), line: usize, words: &str) {
    let whole = text(name);
    assert!(whole.contains(old), "{old}");
    let text = whole.replacen(old, new, 1);
    let fault = parse(&Layout::new(format(name)), &text).expect_err(words);
    assert!(fault.message.contains(words), "{fault:?}");
    assert_eq!(fault.line, line, "{fault:?}");
}

#[test]
fn the_smallest_file_of_each_format_is_read() {
    for (name, format, unit, factor) in FILES {
        for (mark, end) in [("", "\n"), ("", "\r\n"), ("\u{feff}", "\r\n")] {
            let text = mark.to_owned() + &text(name).replace('\n', end);
            let contents = parse(&Layout::new(format), &text).expect(name);
            assert_eq!(contents.unit, unit, "{name}");
            assert_eq!(contents.difference, None, "{name}");
            assert_values(&contents, &SAMPLES, factor);
            for (index, sample) in contents.samples.iter().enumerate() {
                let uneven = name == "renadic.v1" && index == 3;
                let time_s = if uneven { 0.035 } else { 0.01 * index as f64 };
                assert!((sample.0 - time_s).abs() < 1e-12, "{name} {index}");
            }
        }
    }
}

#[test]
fn formats_are_recognised_by_their_content() {
    let folder = tempfile::tempdir().unwrap();
    let columns = COLUMNS.map(|(name, format, ..)| (name, format, Unit::CentimetrePerS2, 1.0));
    for (name, format, unit, _) in FILES.into_iter().chain(columns) {
        for ending in ["txt", "dat", "rec"] {
            let file = folder.path().join(format!("x.{ending}"));
            let text = text(name);
            let marked = format!("\u{feff}{}", text.replace('\n', "\r\n"));
            for text in [text, marked] {
                fs::write(&file, text).unwrap();
                assert_eq!(format_of_file(&file), Some(format), "{name} {ending}");
                let file = file.to_str().unwrap();
                let channel = ["--set", "channel=1"];
                let has_columns = COLUMNS.iter().any(|column| column.0 == name);
                let channel = &channel[..if has_columns { 2 } else { 0 }];
                let said = [&["check", file], channel].concat();
                let said = stdout(&archrock(folder.path(), &said));
                assert!(said.contains("10 samples every 0.01 s") || name == "renadic.v1");
                assert!(said.contains(unit.name()), "{said}");
            }
        }
    }
    // The older formats as well, but tables with keys of tables remain tables.
    let at2 = "A\nB\nACCELERATION IN UNITS OF G\nNPTS= 4, DT= .01 SEC\n.1 .2\n.3 .4\n";
    fs::write(folder.path().join("peer.txt"), at2).unwrap();
    let check = |keys: &[&str]| archrock(folder.path(), &[&["check", "peer.txt"], keys].concat());
    assert!(stdout(&check(&[])).starts_with("peer.txt: AT2 file"));
    let keys = ["unit=g", "dt_s=0.01", "wrapped=true", "skip_rows=4"];
    let keys = keys.map(|key| ["--set", key]).concat();
    assert!(stdout(&check(&keys)).starts_with("peer.txt: table with several samples a row"));
}

#[test]
fn numbers_that_touch_are_parted() {
    // Wide numbers fill their fields, and nothing but the width of the format parts them.
    let wide = text("csmip.v2").replacen(
        "   .500000 -1.250000  2.000000",
        " 10.500000-11.250000120.000000",
        1,
    );
    let contents = parse(&Layout::new(Format::CSMIP), &wide).unwrap();
    let values: Vec<_> = contents.samples[..3]
        .iter()
        .map(|sample| sample.1)
        .collect();
    assert_eq!(values, [10.5, -11.25, 120.0]);
    // 120 cm/s2 is not the peak of the header.
    let difference = contents.difference.unwrap();
    assert!(
        difference.contains("reaches 120 cm/s2, but its header states a peak of 2.5 cm/s2"),
        "{difference}"
    );
    // A line that lost a character cannot be divided by the width.
    assert_fault(
        "csmip.v2",
        (
            "   .500000 -1.250000  2.000000",
            "10.500000111.250000120.000000",
        ),
        46 + 1,
        "is not a finite number",
    );
    for (format, (name, old, new), channel, expected) in [
        (
            Format::SMC,
            (
                "smc.smc",
                " 5.0000E-1-1.2500E+0 2.0000E+0",
                "15.0000E-111.2500E+012.0000E+0",
            ),
            None,
            [1.5, 11.25, 12.0],
        ),
        (
            Format::COSMOS,
            (
                "cosmos.v2",
                " 0.50000-1.25000 2.00000",
                "10.5000011.2500012.00000",
            ),
            None,
            [10.5, 11.25, 12.0],
        ),
        (
            Format::CSMIP,
            (
                "renadic.v1",
                "  0.000  0.500  0.010 -1.250  0.020  2.000",
                "  0.000100.500  0.010101.250  0.020102.000",
            ),
            None,
            [10.05, 10.125, 10.2],
        ),
        (
            Format::CWB,
            (
                "cwb.dat",
                "    -0.050     0.500     0.150\n     0.010     0.125    -1.250    -0.375\n",
                "100000.050100000.500     0.150\n     0.010     0.125    -1.250    -0.375\n",
            ),
            Some(TableColumn::Number(2)),
            [100_000.5, -1.25, 2.0],
        ),
    ] {
        let text = text(name);
        assert!(text.contains(old), "{old}");
        let layout = Layout {
            channel,
            ..Layout::new(format)
        };
        let contents = parse(&layout, &text.replacen(old, new, 1)).expect(name);
        for (sample, expected) in contents.samples.iter().zip(expected) {
            assert!((sample.1 - expected).abs() < 1e-9, "{name} {sample:?}");
        }
    }
    let wide = text("geonet.v1a").replacen("     5.0   -12.5", "123456.1123456.2", 1);
    let contents = parse(&Layout::new(Format::GEONET), &wide).unwrap();
    assert_eq!(contents.samples[0].1, 123_456.1);
    assert_eq!(contents.samples[1].1, 123_456.2);
}

#[test]
fn headers_are_compared_with_the_samples() {
    // Wrong counts.
    let announces = "the number of samples is 10: line";
    let count = (
        "        10    -32768    -32768    -32768    -32768",
        "        11    -32768    -32768    -32768    -32768",
    );
    assert_fault("smc.smc", count, 31, announces);
    assert_fault("csmip.v1", ("10 Accel", "11 Accel"), 30, announces);
    assert_fault(
        "csmip.v2",
        ("10 points of acc", " 9 points of acc"),
        48,
        announces,
    );
    assert_fault("renadic.v1", ("=     10 ", "=     12 "), 29, announces);
    assert_fault("usc.m0a", ("=     10 ", "=     12 "), 29, announces);
    assert_fault(
        "usc.s0a",
        ("10 POINTS OF ACC", "11 POINTS OF ACC"),
        48,
        announces,
    );
    assert_fault("cosmos.v2", ("10 acc", "11 acc"), 47, announces);
    let wrong = (
        "      10       0       0      10",
        "      10       0       0      12",
    );
    assert_fault(
        "geonet.v1a",
        wrong,
        27,
        "the numbers of acceleration end here: line 20 announces 12",
    );
    let wrong = (
        "      10       0       0      10",
        "      10       0       0      30",
    );
    assert_fault("geonet.v2a", wrong, 29, "the numbers of velocity end here");
    let wrong = (
        "      10       0       0      10",
        "      10       0       0       9",
    );
    assert_fault("geonet.v1a", wrong, 27, announces);
    // Cut ends.
    for (name, last) in [
        ("smc.smc", "-5.0000E-1"),
        ("csmip.v1", " -.000500"),
        ("csmip.v2", " -.500000"),
        ("renadic.v1", " -0.500"),
        ("cosmos.v2", "-0.50000"),
        ("geonet.v1a", " -5.0"),
    ] {
        let whole = text(name);
        let cut = &whole[..whole.rfind(last).expect(name)];
        let fault = parse(&Layout::new(format(name)), cut).expect_err(name);
        let words = match name {
            "renadic.v1" => "has 9 numbers; must have a multiple of 2",
            _ => "the number of samples is 9: line",
        };
        assert!(fault.message.contains(words), "{name} {fault:?}");
    }
    // Peaks: a difference is a warning.
    let folder = tempfile::tempdir().unwrap();
    for (name, old, new) in [
        ("smc.smc", "-0.2500000E+01", "-0.3500000E+01"),
        ("csmip.v1", "Max  =   .003 g", "Max  =   .013 g"),
        ("csmip.v2", "=    -2.500 ", "=    -2.600 "),
        ("renadic.v1", "MAX  = -0.250", "MAX  = -0.350"),
        ("usc.s0a", "=    -2.50000  CMS", "=    -2.60000  CMS"),
        (
            "cosmos.v2",
            "    -2.500000     0.05",
            "    -2.600000     0.05",
        ),
        ("geonet.v1a", "\n -25.000", "\n -26.000"),
        ("geonet.v2a", "   0.000 -25.000", "   0.000 -26.000"),
    ] {
        let whole = text(name);
        assert!(whole.contains(old), "{name} {old}");
        fs::write(folder.path().join(name), whole.replacen(old, new, 1)).unwrap();
        let output = archrock(folder.path(), &["check", name]);
        stdout(&output);
        let said = stderr(&output);
        let warning = format!("warning: {name} reaches ");
        assert!(
            said.contains(&warning) && said.contains("its header states a peak of"),
            "{said}"
        );
    }
}

#[test]
fn damaged_files_have_lines() {
    assert_fault(
        "smc.smc",
        ("2 CORRECTED", "CORRECTED"),
        1,
        "is this an SMC file?",
    );
    assert_fault("smc.smc", ("|made up\n", ""), 29, "does not begin with `|`");
    assert_fault(
        "smc.smc",
        ("0.1000000E+03", "0.0000000E+00"),
        18,
        "the rate is 0; must be above 0",
    );
    assert_fault(
        "csmip.v1",
        ("points at 100 pts", "points at 0 pts"),
        28,
        "the rate is 0; must be above 0",
    );
    assert_fault(
        "cosmos.v2",
        ("   10.000000     0.1", "    0.000000     0.1"),
        25,
        "the step is 0 s",
    );
    assert_fault(
        "smc.smc",
        ("2.0000E+0", "2.0x00E+0"),
        30,
        "`2.0x00E+0` is not a finite number",
    );
    assert_fault(
        "csmip.v2",
        ("at  .010 sec, in cm/sec2", "at 0.000 sec, in cm/sec2"),
        46,
        "the step is 0 s",
    );
    assert_fault(
        "csmip.v2",
        ("in cm/sec2.", "in counts. "),
        46,
        "the unit is counts; such samples are not read",
    );
    assert_fault(
        "csmip.v1",
        ("10 Accelerogram points", "10 numbers"),
        27,
        "the number of samples is 0: line 11 announces 10",
    );
    assert_fault(
        "csmip.v2",
        ("points of accel", "numbers of accel"),
        49,
        "the file holds velocity and displacement; must be acceleration",
    );
    assert_fault("renadic.v1", ("G/10", "G/0"), 11, "the factor");
    assert_fault(
        "renadic.v1",
        ("0.040  1.500", "0.030  1.500"),
        28,
        "the time does not increase",
    );
    assert_fault(
        "cosmos.v2",
        ("   10.000000     0.1", " 1000.000000     0.1"),
        45,
        "last 0 s, but at the step of 1 s in the header they last 10 s",
    );
    assert_fault(
        "cosmos.v2",
        ("Real-header", "Real"),
        45,
        "precedes these samples",
    );
    assert_fault(
        "geonet.v2a",
        ("Site", "Sitz"),
        1,
        "is this a file of GeoNet?",
    );
    assert_fault(
        "geonet.v2a",
        ("   0.010   0.010", "   0.010   0.000"),
        23,
        "the step is 0 s",
    );
    let text = text("geonet.v1a");
    let lines = text.split_inclusive('\n').take(22).collect::<String>();
    let fault = parse(&Layout::new(Format::GEONET), &lines).unwrap_err();
    assert!(
        fault
            .message
            .contains("the header has 20 numbers from line 21"),
        "{fault:?}"
    );
    for format in [Format::SMC, Format::CSMIP, Format::COSMOS, Format::GEONET] {
        let fault = parse(&Layout::new(format), "").unwrap_err();
        assert_eq!(fault.line, 1);
        assert!(fault.message.contains("is this a"), "{fault:?}");
    }
}

#[test]
fn one_of_several_channels_is_chosen() {
    let doubled = |name: &str, old: &str, new: &str| {
        let text = text(name);
        assert!(text.contains(old));
        let halved = text
            .replace(old, new)
            .replace(" 1.500", " 1.250")
            .replace(".001500", ".001250")
            .replace("    15.0", "    12.0");
        text + &halved
    };
    for (name, old, new, first) in [
        ("csmip.v1", "90 Deg", "Up", "90 Deg"),
        ("csmip.v2", "90 Deg", "Up", "90 deg"),
        ("renadic.v1", "EW ", "Up ", "ew (sta"),
        ("cosmos.v2", "90 deg", "Up", "90 deg"),
        ("geonet.v1a", "Component N28W", "Component Up", "n28w"),
        (
            "geonet.v2a",
            "Component N28W",
            "Component Up",
            "N28W Longitudinal",
        ),
    ] {
        let text = doubled(name, old, new);
        let layout = Layout::new(format(name));
        let fault = parse(&layout, &text).unwrap_err();
        let words = "the file has 2 channels: set `channel` to the number or to a part of the name of one of them: 1 `";
        assert!(fault.message.starts_with(words), "{name} {fault:?}");
        let choose = |channel| {
            let channel = Some(channel);
            parse(
                &Layout {
                    channel,
                    ..layout.clone()
                },
                &text,
            )
        };
        let named = |name: &str| TableColumn::Name(name.to_owned());
        let one = choose(TableColumn::Number(1)).unwrap();
        let two = choose(TableColumn::Number(2)).unwrap();
        assert_eq!(choose(named(first)), Ok(one.clone()), "{name}");
        assert_eq!(choose(named("UP")), Ok(two.clone()), "{name}");
        assert!(
            one.columns.starts_with(" of channel 1 of 2 `"),
            "{}",
            one.columns
        );
        assert_ne!(one.samples, two.samples, "{name}");
        for (wrong, words) in [
            (
                TableColumn::Number(3),
                "there is no channel 3; the file has",
            ),
            (named("zz"), "no channel matches `zz`"),
            (named(""), "several channels match ``"),
        ] {
            let fault = choose(wrong).unwrap_err();
            assert!(fault.message.contains(words), "{fault:?}");
        }
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("two.v2"),
        doubled("csmip.v2", "90 Deg", "Up"),
    )
    .unwrap();
    let check = |keys: &[&str]| archrock(folder.path(), &[&["check", "two.v2"], keys].concat());
    let of = |channel: &str| {
        format!("two.v2: file of CSMIP, accelerations in cm/s2 of channel {channel}`\n")
    };
    let said = stdout(&check(&[]));
    let [first, second] = ["1 of 2 `90 Deg", "2 of 2 `Up"].map(of);
    assert!(said.starts_with(&first) && said.contains(&second), "{said}");
    let all: Value = serde_json::from_str(&stdout(&check(&["--format", "json"]))).unwrap();
    for (index, name) in ["90 Deg", "Up"].into_iter().enumerate() {
        let channel = &all[index];
        assert_eq!(channel["channel"], index + 1);
        assert_eq!(channel["channel_name"], name);
        let own = [
            "--format",
            "json",
            "--set",
            &format!("channel={}", index + 1),
        ];
        let own: Value = serde_json::from_str(&stdout(&check(&own))).unwrap();
        assert_eq!(channel, &own);
        assert_eq!(
            [&own["samples"], &own["unit"]],
            [&json!(10), &json!("cm/s2")]
        );
        assert_eq!(
            [&own["dt_s"], &own["duration_s"]],
            [&json!(0.01), &json!(0.09)]
        );
        // The peak of both is 2.5 cm/s2.
        let peak_m_s2 = own["peak_acceleration_m_s2"].as_f64().unwrap();
        assert!((peak_m_s2 - 0.025).abs() < 1e-15, "{peak_m_s2}");
    }
    // Each warning names its channel.
    let warnings = stderr(&check(&[]));
    for number in 1..=2 {
        let warning = format!("warning: two.v2, channel {number} peaks at 0.00254842 g");
        assert!(warnings.contains(&warning), "{warnings}");
    }
    let said = refusal(&check(&["--plot", "two.svg"]));
    assert!(
        said.contains("two.v2: --plot draws one channel of 2"),
        "{said}"
    );
    // A motion needs one of them.
    fs::write(
        folder.path().join("s.toml"),
        format!("{ARCH}[ground.record]\nfile = 'two.v2'\n"),
    )
    .unwrap();
    let said = refusal(&archrock(folder.path(), &["run", "s.toml"]));
    assert!(
        said.contains("set `channel`") && said.contains("1 `90 Deg`, 2 `Up`"),
        "{said}"
    );
    let said = stdout(&check(&["--set", "channel=up"]));
    assert!(
        said.contains("two.v2: file of CSMIP, accelerations in cm/s2 of channel 2 of 2 `Up`"),
        "{said}"
    );
    let said = refusal(&archrock(
        folder.path(),
        &[
            "check",
            path("smc.smc").to_str().unwrap(),
            "--set",
            "channel=1",
        ],
    ));
    assert!(
        said.contains("applies to formats with several channels only"),
        "{said}"
    );
}

#[test]
fn files_say_which_quantity_they_hold() {
    let velocities = |format| Layout {
        quantity: RecordedQuantity::Velocity,
        ..Layout::new(format)
    };
    // Corrected files hold velocities as well.
    for (name, unit, factor) in [
        ("csmip.v2", Unit::CentimetrePerS, 1.0),
        ("usc.s0a", Unit::CentimetrePerS, 1.0),
        ("geonet.v2a", Unit::MillimetrePerS, 10.0),
    ] {
        let contents = parse(&velocities(format(name)), &text(name)).expect(name);
        assert_eq!(contents.unit, unit);
        assert_eq!(contents.difference, None, "{name}");
        assert_values(&contents, &VELOCITIES, factor);
    }
    let unless = "the file holds acceleration; must be velocity, unless you leave out `quantity";
    for name in ["smc.smc", "csmip.v1", "cosmos.v2", "geonet.v1a"] {
        let fault = parse(&velocities(format(name)), &text(name)).unwrap_err();
        assert!(fault.message.contains(unless), "{fault:?}");
    }
    let smc = |kind: &str| text("smc.smc").replace("2 CORRECTED ACCELEROGRAM", kind);
    let unless = "holds velocity; must be acceleration, unless you give `quantity = \"velocity\"`";
    for (kind, words) in [
        ("3 VELOCITY", unless),
        (
            "4 DISPLACEMENT",
            "the file holds displacement; must be acceleration",
        ),
        (
            "5 RESPONSE SPECTRA",
            "the file holds response spectra; must be acceleration",
        ),
    ] {
        let fault = parse(&Layout::new(Format::SMC), &smc(kind)).unwrap_err();
        assert!(
            fault.message.ends_with(words)
                || !words.contains("unless") && fault.message.contains(words),
            "{fault:?}"
        );
    }
    let contents = parse(&velocities(Format::SMC), &smc("3 VELOCITY")).unwrap();
    assert_eq!(contents.unit, Unit::CentimetrePerS);
    let cosmos = text("cosmos.v2").replace("10 acceleration pts", "10 displacement pts");
    let fault = parse(&Layout::new(Format::COSMOS), &cosmos).unwrap_err();
    assert!(
        fault.message.contains("the file holds displacement"),
        "{fault:?}"
    );
}

/// Uncorrected SMC files without a sampling rate have the time of every sample.
#[test]
fn smc_files_without_a_rate_hold_pairs() {
    let pairs = text("smc.smc").replacen("0.1000000E+03", "0.1700000E+39", 1);
    let (header, _) = pairs.split_once(" 5.0000E-1").unwrap();
    let rows = " 0.0000E+0-2.0000E+0 1.4000E-3 5.0000E-1 3.1000E-3 2.5000E+0 4.0000E-3-1.0000E+0\n 6.0000E-3 0.0000E+0\n";
    let contents = parse(&Layout::new(Format::SMC), &format!("{header}{rows}")).unwrap();
    let expected = [
        (0.0, -2.0),
        (0.0014, 0.5),
        (0.0031, 2.5),
        (0.004, -1.0),
        (0.006, 0.0),
    ];
    assert_eq!(contents.samples, expected);
    assert_eq!(contents.difference, None);
}

#[test]
fn columns_of_a_text_are_channels() {
    let folder = tempfile::tempdir().unwrap();
    for (name, format, channel, number) in COLUMNS {
        let text = text(name);
        let fault = parse(&Layout::new(format), &text).unwrap_err();
        let words = "the file has 3 channels: set `channel`";
        assert!(fault.message.starts_with(words), "{fault:?}");
        let choose = |channel| Layout {
            channel: Some(channel),
            ..Layout::new(format)
        };
        for channel in [
            TableColumn::Number(number),
            TableColumn::Name(channel.to_owned()),
        ] {
            let layout = choose(channel);
            for text in [
                text.clone(),
                format!("\u{feff}{}", text.replace('\n', "\r\n")),
            ] {
                let contents = parse(&layout, &text).unwrap();
                assert_eq!(contents.unit, Unit::CentimetrePerS2);
                assert_eq!(contents.difference, None);
                assert_values(&contents, &SAMPLES, 1.0);
                assert_eq!(contents.samples[3].0, 0.03);
            }
        }
        let last = parse(&choose(TableColumn::Number(3)), &text).unwrap();
        let factor = if name == "cwb.dat" { 0.3 } else { -0.1 };
        assert_values(&last, &SAMPLES, factor);
        // The header shows the format, whatever the ending.
        let file = folder.path().join("x.rec");
        fs::write(&file, &text).unwrap();
        assert_eq!(format_of_file(&file), Some(format));
        // A peak that differs.
        let text = text
            .replace("(N-S) 2.5", "(N-S) 3.5")
            .replace("-2.500\n", "-3.500\n")
            .replace(": /-2.5/", ": /-3.5/");
        let contents = parse(&choose(TableColumn::Number(number)), &text).unwrap();
        let difference = contents.difference.expect(name);
        assert!(difference.contains("reaches 2.5 cm/s2, but its header states a peak of 3.5"));
    }
}

#[test]
fn texts_of_networks_are_compared_with_their_header() {
    let fault = |name: &str, (old, new): (&str, &str), line: usize, words: &str| {
        let whole = text(name);
        assert!(whole.contains(old), "{old}");
        let (_, format, ..) = COLUMNS.into_iter().find(|file| file.0 == name).unwrap();
        let fault = parse(&choose(format, 1), &whole.replacen(old, new, 1)).expect_err(words);
        assert!(fault.message.contains(words), "{fault:?}");
        assert_eq!(fault.line, line, "{fault:?}");
    };
    fault(
        "afad.txt",
        (": 10\n", ": 11\n"),
        20,
        "is 10: line 6 announces 11",
    );
    fault(
        "afad.txt",
        ("INTERVAL (sec) : 0.01", "INTERVAL (sec) : 0"),
        7,
        "the step is 0 s",
    );
    fault(
        "afad.txt",
        ("    -0.100000\n", "\n"),
        19,
        "has 2 numbers; must have 3",
    );
    // A later row with a number too many would hide the missing one.
    let text_of_afad = text("afad.txt");
    let shifted = text_of_afad.replacen("    -0.050000\n", "\n", 1);
    let shifted = shifted.replacen("     0.125000\n", "     0.125000     0.1\n", 1);
    let message = parse(&choose(Format::AFAD, 1), &shifted).unwrap_err();
    assert_eq!(message.line, 11);
    assert!(message.message.contains("has 2 numbers; must have 3"));
    fault(
        "afad.txt",
        ("VALUES (gal)", "VALUES (counts)"),
        6,
        "the unit is counts",
    );
    fault(
        "cwb.dat",
        ("Rate(Hz): 100", "Rate(Hz): 0"),
        8,
        "the rate is 0; must be above 0",
    );
    fault(
        "cwb.dat",
        ("    -0.375\n", "    -0.375     0.100\n"),
        16,
        "has 5 numbers; must have 4",
    );
    fault(
        "afad.txt",
        ("NUMBER OF DATA", "NUMBER"),
        10,
        "the header has no `number of data :`",
    );
    fault(
        "afad.txt",
        ("E-W          U-D", "E-W"),
        10,
        "must name three components",
    );
    let cut = text("cwb.dat").replace("#RecordLength(sec): 0.1", "#RecordLength(sec): 2");
    let message = parse(&choose(Format::CWB, 1), &cut).unwrap_err().message;
    assert!(
        message.contains("ends after 0.1 s") && message.contains("line 7 announces 2 s"),
        "{message}"
    );
    fault(
        "cwb.dat",
        ("gal. DC", "counts. DC"),
        7,
        "the unit is counts",
    );
    fault(
        "cwb.dat",
        ("     0.020", "     0.005"),
        17,
        "the time does not increase: 0.005 s follows 0.01 s",
    );
    for (old, new, line, words) in [
        ("/10/10/10", "/11/11/11", 44, "is 10: line 24 announces 11"),
        ("/.01/.01/.01", "/.01/0/.01", 18, "the step is 0 s"),
        (
            "/.01/.01/.01",
            "/.01/.01",
            18,
            "channels differs: 2 in this line, 3 in line 24",
        ),
        (
            "/N00E;+/N90E;+/V;+",
            "/V;+",
            16,
            "channels differs: 1 in this line",
        ),
        (
            "UNIDADES DE",
            "UNIDAD",
            34,
            "the header has no `unidades de los datos` up to here",
        ),
        ("cm/s^2 (Gal)", "cuentas", 24, "the unit is cuentas"),
        ("      0.0750\n", "\n", 38, "has 2 numbers; must have 3"),
    ] {
        let whole = text("unam.asa");
        assert!(whole.contains(old), "{old}");
        let fault = parse(&choose(Format::UNAM, 1), &whole.replacen(old, new, 1)).expect_err(words);
        assert!(fault.message.contains(words), "{fault:?}");
        assert_eq!(fault.line, line, "{fault:?}");
    }
    // As many readers find the unit: in brackets, or alone.
    let alone = text("unam.asa")
        .replacen("cm/s^2 (Gal)", "cm/s2", 1)
        .replacen(": /-2.5/", ": /-2.6/", 1);
    let contents = parse(&choose(Format::UNAM, 1), &alone).unwrap();
    assert_values(&contents, &SAMPLES, 1.0);
    assert!(
        contents
            .difference
            .unwrap()
            .contains("states a peak of 2.6 cm/s2")
    );
    assert_fault(
        "csmnc.dat",
        ("POINTS:  10", "POINTS:  11"),
        14,
        "is 10: line 8 announces 11",
    );
    assert_fault(
        "csmnc.dat",
        ("UNIT: CM/SEC/SEC", "UNIT: CM"),
        8,
        "the unit is CM",
    );
    assert_fault(
        "csmnc.dat",
        ("CORRECTED ACCELERATION", "CORRECTED DISPLACEMENT"),
        8,
        "the file holds displacement",
    );
}

/// Another record in the same file is refused, or its numbers would be read with the header of the first.
#[test]
fn a_text_holds_one_record() {
    let ew = text("csmnc.dat");
    let rows = "  0.000000E0".repeat(8) + "\n";
    let long = ew.replace("POINTS:  10", "POINTS:  810") + &rows.repeat(100);
    for (format, first, line) in [
        (Format::CSMNC, ew.clone(), 15),
        (Format::CSMNC, long, 115),
        (Format::AFAD, text("afad.txt"), 21),
        (Format::CWB, text("cwb.dat"), 25),
        (Format::UNAM, text("unam.asa"), 46),
    ] {
        let layout = match format == Format::CSMNC {
            true => Layout::new(format),
            false => choose(format, 1),
        };
        parse(&layout, &first).unwrap();
        let second = first.replace("COMP. EW", "COMP. NS");
        let fault = parse(&layout, &(first + &second)).unwrap_err();
        assert_eq!(fault.line, line, "{format:?} {fault:?}");
        assert!(
            fault.message.contains("if another record begins here"),
            "{fault:?}"
        );
    }
}

/// CWB states the length of a record: ten seconds are a thousand rows, or one more or less if the file counts steps.
#[test]
fn the_length_of_a_record_is_that_of_the_header() {
    let whole = text("cwb.dat").replace("#RecordLength(sec): 0.1", "#RecordLength(sec): 10");
    let (header, _) = whole.split_once("     0.000").unwrap();
    let record = |count: usize, step_s: f64| {
        let row = |index: usize| {
            let time_s = step_s * index as f64;
            format!("{time_s:10.3}{:10.3}{:10.3}{:10.3}\n", 0.25, -2.5, 0.75)
        };
        (0..count).map(row).collect::<Vec<_>>()
    };
    let read = |rows: &[String]| {
        let text = format!("{header}{}", rows.concat());
        let contents = parse(&choose(Format::CWB, 2), &text);
        contents.map(|contents| contents.samples.len())
    };
    let rows = record(1000, 0.01);
    assert_eq!(read(&rows), Ok(1000));
    assert_eq!(read(&rows[..999]), Ok(999));
    assert_eq!(read(&record(1001, 0.01)), Ok(1001));
    for (rows, line, words) in [
        (&rows[..905], 919, "the file ends after 9.05 s"),
        (&rows[..998], 1012, "the file ends after 9.98 s"),
        (
            &record(1002, 0.01),
            1016,
            "line 7 announces 10 s; delete the last 2, if they are not of this record, or correct line 7",
        ),
        (&record(1000, 0.02), 1014, "1000 rows take 19.98 s: line 8"),
        (
            &[&rows[..500], &rows[501..]].concat(),
            1013,
            "999 rows take 9.99 s",
        ),
    ] {
        let fault = read(rows).expect_err(words);
        assert!(fault.message.contains(words), "{fault:?}");
        assert_eq!(fault.line, line, "{fault:?}");
    }
    for damaged in [0, 45, 950] {
        let mut rows = rows.clone();
        rows[damaged] = rows[damaged].replace("    -2.500", "       NaN");
        let fault = read(&rows).unwrap_err();
        assert_eq!(fault.line, 15 + damaged, "{fault:?}");
        assert!(
            fault.message.contains("is not a row of numbers"),
            "{fault:?}"
        );
    }
}

#[test]
fn headers_state_the_unit() {
    for (unit, found, factor) in [
        ("0.5 mm/s/s", Unit::MillimetrePerS2, 5.0),
        ("1.00 cm/s/s", Unit::CentimetrePerS2, 10.0),
        ("cm/s/s", Unit::CentimetrePerS2, 10.0),
        ("g", Unit::Gravity, 10.0),
    ] {
        let text = text("geonet.v1a").replacen("1.00 mm/s/s", unit, 1);
        let contents = parse(&Layout::new(Format::GEONET), &text).expect(unit);
        assert_eq!(contents.unit, found, "{unit}");
        // The header has the peak in mm/s2 alone.
        assert_eq!(
            contents.difference.is_some(),
            unit == "0.5 mm/s/s",
            "{unit}"
        );
        assert_values(&contents, &SAMPLES, factor);
    }
    for (unit, line, words) in [
        ("1.0O mm/s/s", 11, "`1.0O` is not a finite number"),
        ("1.00 counts", 20, "the unit is counts"),
        ("counts", 20, "the unit is counts"),
        ("0 mm/s/s", 20, "the factor 0"),
    ] {
        assert_fault("geonet.v1a", ("1.00 mm/s/s", unit), line, words);
    }
    // The peaks of UNAM are in gal, of the channels that have one.
    let unam = text("unam.asa");
    for (old, new) in [
        ("cm/s^2 (Gal)", "m/s2"),
        ("-2.5/-0.75/0.25", "-2.6/-0.75"),
        ("ACEL. MAX.", "ACEL."),
    ] {
        assert!(unam.contains(old), "{old}");
        let contents = parse(&choose(Format::UNAM, 1), &unam.replacen(old, new, 1)).unwrap();
        assert_eq!(contents.difference, None, "{old}");
    }
    let afad = text("afad.txt").replace("VALUES (gal)", "VALUES (g)");
    let contents = parse(&choose(Format::AFAD, 1), &afad).unwrap();
    assert_eq!(contents.unit, Unit::Gravity);
    assert_eq!(contents.difference, None);
}

#[test]
fn blank_lines_part_components() {
    let first = text("geonet.v1a");
    let second = first.replace("N28W", "Up");
    for blank in ["", "\n", "\n  \n\u{1a}\n"] {
        let text = format!("{blank}{first}{blank}{second}{blank}");
        let fault = parse(&Layout::new(Format::GEONET), &text).unwrap_err();
        assert!(
            fault.message.contains("the file has 2 channels"),
            "{fault:?}"
        );
        let contents = parse(&choose(Format::GEONET, 2), &text).unwrap();
        assert_values(&contents, &SAMPLES, 10.0);
    }
    let more = first + "\n     1.0     2.0\n";
    let fault = parse(&Layout::new(Format::GEONET), &more).unwrap_err();
    assert_eq!(fault.line, 29);
    assert!(
        fault.message.contains("no component begins here"),
        "{fault:?}"
    );
}

/// The formats whose extension shows them have tests of their own.
#[test]
fn every_format_has_its_smallest_file() {
    let files = fs::read_dir(path("")).unwrap();
    let mut shown: Vec<_> = files
        .filter_map(|file| Format::of_contents(&fs::read(file.unwrap().path()).unwrap()))
        .collect();
    shown.extend([Format::AT2, Format::ASC, Format::KNET, Format::CSV]);
    let without_file: Vec<_> = Format::ALL
        .iter()
        .filter(|one| !shown.contains(one))
        .collect();
    assert!(without_file.is_empty(), "{without_file:?}");
}

#[test]
fn scenarios_and_tables_are_no_records_of_networks() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let scenario = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";
    for first in [
        "# NPTS= 4000, DT= .01 SEC",
        "# my column (format v1)",
        "title = 'NPTS= 4000, DT= .01 SEC'",
        "# Corrected acceleration (Format v01.20 with 13 text lines)",
    ] {
        fs::write(path("s.toml"), format!("{first}\n{scenario}")).unwrap();
        assert_eq!(format_of_file(&path("s.toml")), None, "{first}");
        let said = stdout(&archrock(folder.path(), &["check", "s.toml"]));
        assert!(said.contains("height_m = 4.0"), "{said}");
    }
    fs::write(path("x.csv"), "# exported (format v2)\n0,1\n1,2\n").unwrap();
    assert_eq!(format_of_file(&path("x.csv")), Some(Format::CSV));
}

#[test]
fn channels_match_by_whole_words() {
    let named = |name: &str| TableColumn::Name(name.to_owned());
    let two = |first: &str, second: &str| {
        let text = text("csmip.v2");
        text.replace("90 Deg", first) + &text.replace("90 Deg", second).replace(" 1.500", " 1.250")
    };
    // A channel also begins at its first line, without an end of the data above.
    let parts: Vec<_> = ["360 Deg", "Up"]
        .map(|name| text("csmip.v2").replace("90 Deg", name))
        .map(|text| text.split("/&").next().unwrap().to_owned())
        .into();
    for (text, channel, found) in [
        (two("360 Deg", "Up"), "60", Err("no channel matches `60`")),
        (two("360 Deg", "Up"), "360", Ok("channel 1 of 2 `360 Deg`")),
        (two("Up 2", "Up"), "up", Ok("channel 2 of 2 `Up`")),
        (
            two("Up 2", "Up 3"),
            "up",
            Err("several channels match `up`"),
        ),
        (two("Up 2", "Up 3"), "p 3", Err("no channel matches `p 3`")),
        (parts.concat(), "up", Ok("channel 2 of 2 `Up`")),
    ] {
        let layout = Layout {
            channel: Some(named(channel)),
            ..Layout::new(Format::CSMIP)
        };
        match (parse(&layout, &text), found) {
            (Ok(contents), Ok(words)) => {
                assert!(contents.columns.contains(words), "{}", contents.columns);
            }
            (Err(fault), Err(words)) => assert!(fault.message.contains(words), "{fault:?}"),
            (read, found) => panic!("{channel} {read:?} {found:?}"),
        }
    }
    let pairs = text("renadic.v1").split("/&").next().unwrap().to_owned();
    let pairs = pairs.clone() + &pairs.replace("EW ", "Up ");
    let contents = parse(&choose(Format::CSMIP, 2), &pairs).unwrap();
    assert!(contents.columns.contains("channel 2 of 2 `Up"));
}

/// The time to read a file grows with its length, not with its square: thousands of blocks take less than a second.
#[test]
fn many_blocks_are_read_in_time() {
    let block =
        "2 points of accel data equally spaced at .01 sec, in cm/sec2. (8f10.6)\n 1.0 2.0\n";
    let text = format!("Corrected accelerogram\n{}", block.repeat(10_000));
    let begun = std::time::Instant::now();
    let contents = parse(&choose(Format::CSMIP, 10_000), &text).unwrap();
    assert_eq!(contents.samples, [(0.0, 1.0), (0.01, 2.0)]);
    assert!(begun.elapsed().as_secs() < 20, "{:?}", begun.elapsed());
}

#[test]
fn suites_choose_a_channel() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let first = text("csmip.v2");
    let second = first.replace("90 Deg", "Up").replace(" 1.500", " 1.250");
    fs::write(folder.join("b.v2"), first + &second).unwrap();
    let at2 = "A\nB\nACCELERATION IN UNITS OF G\nNPTS= 4, DT= .01 SEC\n.1 .2\n.3 .4\n";
    fs::write(folder.join("a.at2"), at2).unwrap();
    fs::write(folder.join("c.csv"), "0,1\n0.01,2\n").unwrap();
    let column = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";
    let suite = |keys: &str| {
        let text = format!("{column}[suite]\nscales = [1]\n{keys}\n");
        fs::write(folder.join("s.toml"), text).unwrap();
        Scenario::read(&folder.join("s.toml"))
    };
    for keys in [
        "records = ['a.at2', 'b.v2']\nchannel = 'up'",
        "records = ['b.v2', 'c.csv']\nchannel = 2\nunit = 'g'",
        "records = ['b.v2']\nchannel = 2",
    ] {
        let scenario = suite(keys).expect(keys);
        let records = &scenario.suite.as_ref().unwrap().records;
        for series in records {
            let is_csmip = series.layout.format == Format::CSMIP;
            assert_eq!(series.layout.channel.is_some(), is_csmip, "{keys}");
            assert_eq!(series.columns == " of channel 2 of 2 `Up`", is_csmip);
        }
        fs::write(folder.join("t.toml"), scenario.to_toml()).unwrap();
        assert_eq!(
            Scenario::read(&folder.join("t.toml")),
            Ok(scenario),
            "{keys}"
        );
    }
    let wrong = suite("records = ['a.at2']\nchannel = 2").unwrap_err();
    let words = "applies to formats with several channels only";
    assert!(wrong.to_string().contains(words), "{wrong}");
}

/// The format follows from the start of a file, so even one that is too large to read has a format.
#[test]
fn formats_are_recognised_by_the_start_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let large = folder.path().join("large.rec");
    fs::write(&large, text("smc.smc")).unwrap();
    let file = fs::OpenOptions::new().write(true).open(&large).unwrap();
    file.set_len((64 << 20) + 1).unwrap();
    assert_eq!(format_of_file(&large), Some(Format::SMC));
    let said = refusal(&archrock(folder.path(), &["check", "large.rec"]));
    assert!(said.contains("is larger than 64 MiB"), "{said}");
}

/// Each difference between header and samples is a warning of its own; other warnings name the first record.
#[test]
fn suites_list_all_differences() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let smc = text("smc.smc");
    for (name, peak) in [("a.smc", "-0.3500000E+01"), ("b.smc", "-0.4500000E+01")] {
        let text = smc.replacen("-0.2500000E+01", peak, 1);
        fs::write(folder.join(name), text).unwrap();
    }
    fs::write(folder.join("c.smc"), smc).unwrap();
    let text =
        "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[suite]\nscales = [1]\nrecords = '*.smc'\n";
    fs::write(folder.join("s.toml"), text).unwrap();
    let said = stderr(&archrock(folder, &["check", "s.toml"]));
    for words in [
        "a.smc reaches 2.5 cm/s2, but its header states a peak of 3.5 cm/s2",
        "b.smc reaches 2.5 cm/s2, but its header states a peak of 4.5 cm/s2",
        "a.smc peaks at 0.00254842 g",
        "2 more records of the suite are like that",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert_eq!(said.matches("states a peak").count(), 2, "{said}");
}

/// Three channels, of which the others are -0.5 and 2 times the first. Two digits of exponents, as in real files, leave no blank before a minus sign.
#[test]
fn files_of_bhrc_hold_three_channels() {
    let text = text("bhrc.v1");
    assert_eq!(Format::of_contents(text.as_bytes()), Some(Format::BHRC));
    for (number, name, factor) in [(1, "L1", 0.1), (2, "V2", -0.05), (3, "T3", 0.2)] {
        for channel in [
            TableColumn::Number(number),
            TableColumn::Name(name.to_owned()),
        ] {
            for text in [text.clone(), text.replace('\n', "\r\n")] {
                let layout = Layout {
                    channel: Some(channel.clone()),
                    ..Layout::new(Format::BHRC)
                };
                let contents = parse(&layout, &text).unwrap();
                assert_eq!(contents.unit, Unit::Gravity);
                assert_values(&contents, &SAMPLES, factor);
                assert_eq!(contents.samples[3].0, 0.03);
            }
        }
    }
    for (old, new, line, words) in [
        (
            "POINTS =     10",
            "POINTS =     11",
            28,
            "is 10: line 11 announces 11",
        ),
        (
            "DURATION =    .100",
            "DURATION =    .000",
            11,
            "the duration per sample is 0 s",
        ),
        (
            "DURATION =    .100",
            "DURATION",
            11,
            "is not a finite number",
        ),
        (
            "SECONDS AND G/10",
            "SECONDS AND counts",
            11,
            "the unit is counts",
        ),
        (
            "-1.250000E+00",
            "-1.25.000E+00",
            28,
            "is not a finite number",
        ),
    ] {
        assert!(text.contains(old), "{old}");
        let damaged = text.replacen(old, new, 1);
        let fault = parse(&choose(Format::BHRC, 1), &damaged).expect_err(words);
        assert!(fault.message.contains(words), "{fault:?}");
        assert_eq!(fault.line, line, "{fault:?}");
    }
}

/// In volume 2 of USC the line before samples may have their unit.
#[test]
fn volume_2_of_usc_has_its_unit_in_either_line() {
    let without = text("usc.s0a");
    let named = without.replace(
        "OF ACC DATA EQUALLY SPACED AT   .010 SEC.",
        "OF ACC DATA EQUALLY SPACED AT   .010 SEC.  IN UNITS CM/SEC/SEC",
    );
    assert_ne!(without, named);
    let layout = Layout::new(Format::USC);
    assert_eq!(parse(&layout, &without), parse(&layout, &named));
    let unknown = without.replace("CMS/SEC/SEC", "counts");
    let fault = parse(&layout, &unknown).unwrap_err();
    assert!(fault.message.contains("the unit is counts"), "{fault:?}");
}

/// The first of two samples at the same time is kept: 1.5 at 0.02 s here.
#[test]
fn a_repeated_time_drops_its_second_sample() {
    let pairs = text("smc.smc").replacen("0.1000000E+03", "0.1700000E+39", 1);
    let (header, _) = pairs.split_once(" 5.0000E-1").unwrap();
    let rows = " 0.0000E+0-2.0000E+0 1.0000E-2 5.0000E-1 2.0000E-2 1.5000E+0 2.0000E-2-2.5000E+0\n 3.0000E-2 0.0000E+0\n";
    let contents = parse(&Layout::new(Format::SMC), &format!("{header}{rows}")).unwrap();
    let expected = [(0.0, -2.0), (0.01, 0.5), (0.02, 1.5), (0.03, 0.0)];
    assert_eq!(contents.samples, expected);
    let warning = "repeats the time 0.02 s on line 30: its second sample, -2.5, is left out";
    assert_eq!(contents.difference.as_deref(), Some(warning));
    let twice = text("cwb.dat").replacen("     0.020", "     0.010", 1);
    let contents = parse(&choose(Format::CWB, 2), &twice).unwrap();
    let samples = SAMPLES.iter().zip(0..).filter(|(_, index)| *index != 2);
    assert_eq!(contents.samples.len(), 9);
    for (sample, (expected, _)) in contents.samples.iter().zip(samples) {
        assert_eq!(sample.1, *expected);
    }
    assert!(
        contents
            .difference
            .unwrap()
            .starts_with("repeats the time 0.01 s on line 17")
    );
}

/// Real files of uncorrected accelerations end with a line that is left from another record.
#[test]
fn samples_beyond_the_announced_number_have_a_remedy() {
    let pairs = text("smc.smc").replacen("0.1000000E+03", "0.1700000E+39", 1);
    let (header, _) = pairs.split_once(" 5.0000E-1").unwrap();
    let rows = " 0.0000E+0-2.0000E+0 1.0000E-2 5.0000E-1 2.0000E-2 1.5000E+0 3.0000E-2-2.5000E+0\n 4.0000E-2 0.0000E+0\n";
    let left = " 1.0000E-2 3.0000E-1 2.0000E-2 1.0000E-1\n";
    let remedy = "the number of samples is 7: line 14 announces 5 (samples); delete the last 2, if they are not of this record, or correct line 14";
    let fault = parse(&Layout::new(Format::SMC), &format!("{header}{rows}{left}")).unwrap_err();
    assert_eq!((fault.line, &*fault.message), (32, remedy));
    // Fewer samples than announced have no such remedy.
    let fault = parse(
        &Layout::new(Format::SMC),
        &format!("{header}{rows}").replace(" 4.0000E-2 0.0000E+0\n", ""),
    )
    .unwrap_err();
    assert!(
        fault.message.ends_with("announces 5 (samples)"),
        "{fault:?}"
    );
}

#[test]
fn a_unit_may_end_with_a_stop() {
    let text = text("cosmos.v2");
    assert!(text.contains("units=cm/sec2(04)"));
    let stop = text.replace("units=cm/sec2(04)", "units=g.     (02)");
    let contents = parse(&Layout::new(Format::COSMOS), &stop).unwrap();
    assert_eq!(contents.unit, Unit::Gravity);
    assert_values(&contents, &SAMPLES, 1.0);
}
