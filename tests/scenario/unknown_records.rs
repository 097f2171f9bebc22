//! Files that are neither scenarios nor records of a known format: the message names their kind and the remedy.

use std::fs;

use archrock::scenario::{ScenarioErrors, unknown_format};

use crate::common::ARCH;
use crate::common::program::{archrock, refusal, stdout};

/// The first bytes of a file and its kind in the message.
fn binaries() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    const SHEET: &str = "a spreadsheet: save its sheet as CSV";
    const SEED: &str = "SEED or MiniSEED: convert it to a table, with ObsPy for example";
    let zip = |name: &str| {
        [
            b"PK\x03\x04\x14\0\x06\0\x08\0",
            &[0; 20][..],
            name.as_bytes(),
            &[0; 40],
        ]
        .concat()
    };
    let sac = |version: [u8; 4]| {
        let mut header = vec![0x40; 632];
        header[304..308].copy_from_slice(&version);
        [header, vec![0; 40]].concat()
    };
    let seed =
        |start: &str| [start.as_bytes(), b"STATI  HHZNL", &[7, 209, 0, 1, 0, 0][..]].concat();
    vec![
        (
            "records.zip",
            zip("north.at2"),
            "an archive (ZIP): unpack it",
        ),
        ("sheet.xlsx", zip("[Content_Types].xml"), SHEET),
        (
            "sheet.ods",
            zip("mimetypeapplication/vnd.oasis.opendocument.spreadsheet"),
            SHEET,
        ),
        (
            "sheet.xls",
            b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1\0\0\0\0".to_vec(),
            SHEET,
        ),
        (
            "record.gz",
            b"\x1f\x8b\x08\0made up".to_vec(),
            "compressed (gzip): unpack it",
        ),
        ("record.mseed", seed("000001D "), SEED),
        ("record.msd", seed("763445R "), SEED),
        ("volume.seed", seed("000001V "), SEED),
        ("record.ms3", b"MS\x03\x04\0\0\0\0".to_vec(), SEED),
        (
            "little.sac",
            sac([6, 0, 0, 0]),
            "a SAC file: convert it to a table",
        ),
        (
            "big.sac",
            sac([0, 0, 0, 6]),
            "a SAC file: convert it to a table",
        ),
    ]
}

#[test]
fn binary_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, kind) in binaries() {
        // Under its own name, and as a table or record by mistake.
        for file in [name, "record.csv", "record.at2", "record"] {
            fs::write(folder.path().join(file), &bytes).unwrap();
            let said = refusal(&archrock(
                folder.path(),
                &["check", file, "--set", "unit=g"],
            ));
            assert!(said.starts_with(&format!("error: {file}:")), "{said}");
            assert!(
                said.contains(&format!("the file is {kind}")),
                "{name} {said}"
            );
            let record = format!("{ARCH}[ground.record]\nfile = '{file}'\nunit = 'g'\n");
            fs::write(folder.path().join("s.toml"), record).unwrap();
            let said = refusal(&archrock(folder.path(), &["run", "s.toml"]));
            assert!(
                said.contains("s.toml:") && said.contains(&format!("is {kind}")),
                "{said}"
            );
            let said = refusal(&archrock(folder.path(), &["run", file]));
            assert!(said.contains(&format!("the file is {kind}")), "{said}");
        }
    }
    // With the key `format` as well.
    let said = refusal(&archrock(
        folder.path(),
        &[
            "check",
            "records.zip",
            "--set",
            "format=csv",
            "--set",
            "unit=g",
        ],
    ));
    assert!(
        said.contains("records.zip:1: the file is an archive (ZIP)"),
        "{said}"
    );
}

#[test]
fn texts_without_a_reader_are_unknown_records() {
    let folder = tempfile::tempdir().unwrap();
    let lines = "  0.0063 0.0036\n 0.0010 -0.0042\n".repeat(400);
    let single = "0.1 ".repeat(3000);
    for (name, text) in [
        ("el_centro.th", &*lines),
        ("x.acc", "6.3e-03\n3.6e-03\n-1.1e-3\n2.2e-3\n"),
        ("one_line.g3", &single),
        (
            "x.v3",
            "Response and Fourier amplitude spectra (86 periods)\nMade up\nof a record\n 1 2 3\n",
        ),
        (
            "noname",
            "WID2 2009/05/18 06:47:20.255 STA2  HH CM6\nSTA2\nDAT2\n9Cv9LI8\n",
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        let said = refusal(&archrock(folder.path(), &["check", name]));
        let first = format!(
            "error: {name}: unknown record format; known: at2, asc, knet, smc, csmip, usc, bhrc, cosmos, geonet, afad, cwb, csmnc, unam, csv; \
             a table needs `format = \"csv\"`"
        );
        assert_eq!(said.lines().next(), Some(&*first));
        assert!(
            said.contains("keys of [ground.record] are given with --set"),
            "{said}"
        );
    }
    // As large as a record may be, but too large for a scenario.
    fs::write(folder.path().join("long.acc"), lines.repeat(200)).unwrap();
    let said = refusal(&archrock(folder.path(), &["check", "long.acc"]));
    assert!(said.contains("long.acc: unknown record format"), "{said}");
    // A table with the ending of another format.
    for (name, words) in [
        ("table.AT2", "is this an AT2 file?"),
        ("table.asc", "is this an ASC file?"),
        ("table.NS", "is this a file of K-NET?"),
    ] {
        fs::write(folder.path().join(name), "0.1 1\n0.2 -1\n0.3 0\n").unwrap();
        let said = refusal(&archrock(folder.path(), &["check", name]));
        assert!(
            said.contains(&format!("{words} Give `format = \"csv\"` if it is a table")),
            "{said}"
        );
        let read = ["check", name, "--set", "format=csv", "--set", "unit=g"];
        assert!(stdout(&archrock(folder.path(), &read)).contains("3 samples every 0.1 s"));
    }
}

/// Scenarios keep their messages, whatever their name.
#[test]
fn scenarios_are_no_unknown_records() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";
    let commented = format!("{}{scenario}", "# a long comment, made up\n".repeat(300));
    for (name, text) in [
        ("noname", scenario),
        ("commented.scenario", &*commented),
        ("x.acc", "column = { height_m = 4.0, width_m = 0.8 }\n"),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        assert_eq!(unknown_format(&folder.path().join(name)), None);
        assert!(stdout(&archrock(folder.path(), &["check", name])).contains("height_m = 4.0"));
    }
    for (name, text, words) in [
        ("x.toml", "0.1\n0.2\n0.3\n0.4\n", "this is no scenario: "),
        (
            "noname",
            "[column]\nheight_m 4.0\nwidth_m 0.8\nx y\n",
            "noname:2:",
        ),
        ("short", "column.height_m = 4..0\n", "not valid TOML"),
        ("missing.acc", "", "missing.acc: cannot be read"),
    ] {
        if name != "missing.acc" {
            fs::write(folder.path().join(name), text).unwrap();
        }
        assert_eq!(unknown_format(&folder.path().join(name)), None);
        let said = refusal(&archrock(folder.path(), &["check", name]));
        assert!(said.contains(words), "{said}");
    }
    fs::write(folder.path().join("x.acc"), "0.1\n0.2\n0.3\n").unwrap();
    let ScenarioErrors(errors) = unknown_format(&folder.path().join("x.acc")).unwrap();
    assert_eq!((errors.len(), errors[0].place), (1, None));
}
