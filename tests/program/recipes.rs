//! The pages for a first look: their commands, run as printed there, give the output and the numbers shown there.

use std::fmt::Write as _;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use crate::common::motions::{NGA_WEST2, at2, scaled, synthetic};
use crate::common::program::{scenarios, shown_output};
use crate::common::prose::{is_shown, skeleton};
use archrock::Scenario;

/// Three records, generated as their titles describe: a PEER file of 0.45 g, an ESM file of 520 cm/s2, and a table of 380 cm/s2 after three
/// lines of text.
fn records() -> [(&'static str, String); 3] {
    let first = scaled(&synthetic(11, 16.0, 0.01), 0.45);
    let title = "Synthetic: tests/common/motions.rs, synthetic(11, 16 s, 0.01 s), peak 0.45 g";
    let samples = scaled(&synthetic(13, 8.0, 0.01), 520.0);
    let mut second = format!(
        "EVENT_NAME: SYNTHETIC, NOT OF AN EARTHQUAKE\n\
         STATION_NAME: synthetic(13, 8 s, 0.01 s) of tests/common/motions.rs, peak 520 cm/s^2\n\
         SAMPLING_INTERVAL_S: 0.010000\nNDATA: {}\nUNITS: cm/s^2\nDATA_TYPE: ACCELERATION\n",
        samples.len()
    );
    for (_, acceleration) in samples {
        let _ = writeln!(second, "{:.4}", acceleration + 0.0);
    }
    let mut third =
        "Synthetic: tests/common/motions.rs; synthetic(12, 12 s, 0.005 s), peak 380 cm/s2\n\
                     Not of an earthquake; for the recipes\ntime (s);acceleration (cm/s2)\n"
            .to_owned();
    for (time_s, acceleration) in scaled(&synthetic(12, 12.0, 0.005), 380.0) {
        let _ = writeln!(third, "{time_s:.3};{:.4}", acceleration + 0.0);
    }
    [
        ("nga1.at2", at2(&first, title, &NGA_WEST2)),
        ("esm.asc", second),
        ("station.csv", third),
    ]
}

#[test]
fn the_records_of_the_recipes_match_their_generator() {
    let folder = scenarios().join("recipes");
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
    let scenario = Scenario::read(&folder.join("records.toml")).unwrap();
    assert_eq!(scenario.by_record().len(), 3);
}

/// The sentences and tables of a part of a page, without code, and without the targets of links and pictures.
fn prose(part: &str) -> String {
    let mut is_code = false;
    let lines = part.lines().filter(|line| {
        is_code ^= line.starts_with("```");
        !is_code && !line.starts_with("    ") && !line.starts_with("```")
    });
    let text: Vec<&str> = lines.collect();
    let text = text.join("\n");
    let text: String = text.split('`').step_by(2).collect();
    let mut parts = text.split("](");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| {
        text + part.split_once(')').map_or("", |(_, after)| after)
    })
}

/// Asserts that every number of two or more digits in the sentences of a part is printed by its commands, or given in them, in the code
/// blocks, or in a scenario of the part.
#[track_caller]
fn assert_numbers_are_printed(part: &str, output: &str) {
    let mut known = output.to_owned();
    for line in part.lines().filter(|line| line.starts_with("    ")) {
        known += line;
    }
    known.extend(part.split("```").skip(1).step_by(2));
    for word in part.split([' ', '\n', '`']) {
        let file = word.strip_prefix("scenarios/").unwrap_or_default();
        if file.ends_with(".toml") {
            known += &fs::read_to_string(scenarios().join(file)).unwrap();
        }
    }
    let numbers = skeleton(&known).1;
    let values: Vec<f64> = numbers.iter().filter_map(|n| n.parse().ok()).collect();
    for number in skeleton(&prose(part)).1 {
        let digits = number.trim_start_matches(['-', '0', '.']).len();
        let size = |value: &f64| is_shown(number.trim_start_matches('-'), value.abs());
        assert!(
            digits < 2 || values.iter().any(size),
            "{number} is neither given nor printed in this part: {part}"
        );
    }
}

/// Runs the commands of a page beside the scenarios; compares the lines that it shows, and the numbers of parts with a command.
#[track_caller]
fn assert_page_is_true(page: &str, commands: usize) {
    let folder = tempfile::tempdir().unwrap();
    symlink(scenarios(), folder.path().join("scenarios")).unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
    let text = fs::read_to_string(path).unwrap();
    let mut run = 0;
    for part in text.split("\n## ") {
        let outputs = shown_output(part, folder.path());
        run += outputs.len();
        if !outputs.is_empty() {
            assert_numbers_are_printed(part, &outputs.join("\n"));
        }
    }
    assert_eq!(run, commands, "{page}");
}

#[test]
fn commands_print_the_output_shown_in_the_recipes() {
    assert_page_is_true("docs/recipes.md", 30);
}

#[test]
fn commands_print_the_output_shown_at_the_start() {
    assert_page_is_true("docs/start.md", 6);
}

#[test]
fn commands_print_the_output_shown_in_the_questions() {
    assert_page_is_true("docs/questions.md", 6);
}

#[test]
fn commands_print_the_output_shown_in_the_choice_of_a_model() {
    assert_page_is_true("docs/choose.md", 1);
}
