//! The tour in the documentation: its commands, run as printed there, give the output shown there.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::common::motions::{NGA_WEST2, at2, scaled, synthetic};
use crate::common::program::{assert_shown_output_is_printed, scenarios};
use archrock::Scenario;

/// The two records of the tour, generated as their titles describe: the first as a PEER file of 0.45 g, the second as a table of
/// 380 cm/s2 after three lines of text.
fn records() -> [(&'static str, String); 2] {
    let first = scaled(&synthetic(11, 16.0, 0.01), 0.45);
    let title = "Synthetic: tests/common/motions.rs, synthetic(11, 16 s, 0.01 s), peak 0.45 g";
    let mut second =
        "Synthetic: tests/common/motions.rs; synthetic(12, 12 s, 0.005 s), peak 380 cm/s2\n\
                      Not of an earthquake; for the tour\ntime (s);acceleration (cm/s2)\n"
            .to_owned();
    for (time_s, acceleration) in scaled(&synthetic(12, 12.0, 0.005), 380.0) {
        let _ = writeln!(second, "{time_s:.3};{:.4}", acceleration + 0.0);
    }
    [
        ("nga1.at2", at2(&first, title, &NGA_WEST2)),
        ("station.csv", second),
    ]
}

#[test]
fn the_records_of_the_tour_match_their_generator() {
    let folder = scenarios().join("tour");
    for (name, text) in records() {
        let file = folder.join(name);
        if std::env::var_os("ARCHROCK_REGENERATE").is_some() {
            fs::write(&file, &text).unwrap();
        }
        // Sines differ between platforms in the last digit, so last digits of the files may differ too.
        let own = fs::read_to_string(&file).unwrap();
        assert_eq!(own.lines().count(), text.lines().count());
        let differ = own.lines().zip(text.lines()).filter(|(a, b)| a != b);
        assert!(differ.count() < 10, "{name}");
    }
    let scenario = Scenario::read(&folder.join("tour.toml")).unwrap();
    assert_eq!(scenario.by_record().len(), 2);
}

#[test]
fn commands_print_the_output_shown_in_the_tour() {
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(scenarios().join("tour")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
        }
    }
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/tour.md");
    let page = fs::read_to_string(page).unwrap();
    // The page shows the scenario that is run.
    let scenario = fs::read_to_string(scenarios().join("tour/tour.toml")).unwrap();
    let (_, scenario) = scenario.split_once("\n\n").unwrap();
    assert!(page.contains(&format!("```toml\n{scenario}```")));
    let commands = assert_shown_output_is_printed("docs/tour.md", folder.path());
    assert!((2..=4).contains(&commands));
    // The files to which the page refers.
    for record in ["nga1.at2", "station.csv"] {
        let results = folder.path().join("results/tour").join(record);
        for file in [
            "report.html",
            "history.svg",
            "threshold.svg",
            "summary.json",
        ] {
            assert!(results.join(file).exists(), "{record} {file}");
        }
    }
}
