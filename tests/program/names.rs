//! Titles and names from outside: characters that would be invisible are shown escaped, everywhere.

use std::fs;
use std::path::Path;

use crate::common::ARCH;
use crate::common::program::{archrock, files, printed, refused, stderr};

const PULSE: &str = "[ground.rectangular]\namplitude_g = 0.3\nduration_s = 0.21\n";
const RECORD: &str = "A\nUNITS OF G\nNPTS= 5, DT= .1\n0 .3 .4 -.3 0\n";
/// Letters, a mark that reverses the following text, and more letters: it looks like `wave-2ta.gvs`.
const NAME: &str = "wave-\u{202e}svg.at2";
const SHOWN: &str = r"wave-\u202esvg.at2";

fn is_hidden(c: char) -> bool {
    let is_meant = matches!(c, '\n' | '\t');
    let turns = ('\u{202a}'..='\u{202e}').contains(&c) || ('\u{2066}'..='\u{2069}').contains(&c);
    c.is_control() && !is_meant
        || turns
        || "\u{61c}\u{200b}\u{200e}\u{200f}\u{2028}\u{2029}\u{feff}".contains(c)
}

#[track_caller]
fn assert_legible(what: &str, text: &str) {
    let hidden = text.chars().find(|c| is_hidden(*c));
    assert_eq!(hidden, None, "{what}");
}

/// All files in a folder are legible, and those that may contain a name contain these words.
#[track_caller]
fn assert_results(folder: &Path, words: &str, named: &[&str]) {
    let all = files(folder);
    for (name, contents) in &all {
        assert_legible(name, &String::from_utf8(contents.clone()).unwrap());
    }
    for file in named {
        let (_, contents) = all.iter().find(|(name, _)| name.ends_with(file)).unwrap();
        let text = String::from_utf8(contents.clone()).unwrap();
        // Strings in JSON and TOML have their backslashes doubled, unless they are escapes.
        let text = text.replace(r"\\u", r"\u");
        assert!(text.contains(words), "{file}");
    }
}

#[test]
fn titles_are_shown_escaped() {
    let folder = tempfile::tempdir().unwrap();
    let title = r#"title = "Pont \u202e\u001b[31m & \n \u2028\ufeffend""#;
    let shown = r"Pont \u202e\u001b[31m & \n \u2028\ufeffend";
    let map = "[map]\namplitude_g = [0.2, 0.4]\nduration_s = [0.2, 0.3]\n";
    fs::write(
        folder.path().join("s.toml"),
        format!("{title}\n{ARCH}{PULSE}{map}"),
    )
    .unwrap();
    let said = printed(folder.path(), &["run", "s.toml", "--out", "run"]);
    assert_legible("run", &said);
    assert!(said.starts_with(&format!("{shown}\n")), "{said}");
    let shown = shown.replace('&', "&amp;");
    assert_results(
        &folder.path().join("run"),
        &shown,
        &["report.html", "history.svg"],
    );
    printed(folder.path(), &["map", "s.toml", "--out", "map"]);
    assert_results(&folder.path().join("map"), &shown, &["map.svg", "map.html"]);
    let resolved = printed(folder.path(), &["check", "s.toml"]);
    assert_legible("check", &resolved);
}

/// The scenario on a page keeps its lines.
#[test]
fn pages_have_the_scenario_line_by_line() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), format!("{ARCH}{PULSE}")).unwrap();
    printed(folder.path(), &["run", "s.toml", "--out", "run"]);
    let page = fs::read_to_string(folder.path().join("run/report.html")).unwrap();
    assert!(page.contains("<pre>[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\n"));
}

#[test]
fn names_of_records_are_shown_escaped() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(NAME), RECORD).unwrap();
    let reported = printed(folder.path(), &["check", NAME]);
    assert!(
        reported.starts_with(&format!("{SHOWN}: AT2 file")),
        "{reported}"
    );
    let text = format!("{ARCH}[ground.record]\nfile = '{NAME}'\n");
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let said = printed(folder.path(), &["run", "s.toml", "--out", "run"]);
    assert!(said.starts_with(&format!("  {SHOWN}: 5 samples")), "{said}");
    assert_legible("run", &said);
    assert_results(
        &folder.path().join("run"),
        SHOWN,
        &["report.html", "summary.json"],
    );
    // Output for programs reads back.
    let summary = fs::read_to_string(folder.path().join("run/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["scenario"]["ground"]["record"]["file"], NAME);
    let resolved = printed(folder.path(), &["check", "s.toml"]);
    assert!(
        resolved.contains(&format!("file = \"{SHOWN}\"")),
        "{resolved}"
    );
    fs::write(folder.path().join("t.toml"), &resolved).unwrap();
    assert_eq!(printed(folder.path(), &["check", "t.toml"]), resolved);

    fs::write(folder.path().join(NAME), "A\nNPTS= 5, DT= .1\n0 x\n").unwrap();
    let said = refused(folder.path(), &["run", "s.toml"], &[SHOWN, "`x` is not"]);
    assert_legible("run", &said);
}

#[test]
fn tables_of_suites_show_names_escaped() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(NAME), RECORD).unwrap();
    fs::write(folder.path().join("b.at2"), RECORD).unwrap();
    let text =
        format!("{ARCH}[suite]\nrecords = '*.at2'\nscales = [1.0, 2.0]\nboth_signs = false\n");
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let output = archrock(folder.path(), &["suite", "s.toml", "--out", "suite"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_legible("suite", &stderr(&output));
    assert_results(
        &folder.path().join("suite"),
        SHOWN,
        &["suite.csv", "ida.svg"],
    );
    let said = printed(folder.path(), &["run", "s.toml", "--suite", "--out", "run"]);
    assert_legible("run --suite", &said);
    assert!(said.contains(&format!("  {SHOWN}: 5 samples")), "{said}");
}

#[test]
fn names_like_formulas_are_refused_in_suites() {
    for name in ["=HYPERLINK(1).at2", "+1.at2", "-1.at2", "@x.at2"] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), RECORD).unwrap();
        for pattern in [name, "*.at2"] {
            let text = format!("{ARCH}{PULSE}[suite]\nrecords = \"{pattern}\"\nscales = [1.0]\n");
            fs::write(folder.path().join("s.toml"), text).unwrap();
            for command in ["suite", "check"] {
                let words = format!(
                    "s.toml:9:11: `records = \"{pattern}\"` names {name}, which spreadsheets that open the table of \
                     results would take for a formula: give the file a name that does not begin with any of = + - @"
                );
                refused(folder.path(), &[command, "s.toml"], &[&words]);
            }
        }
        // In a folder, or by itself, such a name begins no cell.
        let text = format!("{ARCH}[ground.record]\nfile = '{name}'\n");
        fs::write(folder.path().join("s.toml"), text).unwrap();
        printed(folder.path(), &["run", "s.toml"]);
    }
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("r")).unwrap();
    fs::write(folder.path().join("r/=1.at2"), RECORD).unwrap();
    let text = format!("{ARCH}{PULSE}[suite]\nrecords = 'r/*.at2'\nscales = [1.0]\n");
    fs::write(folder.path().join("s.toml"), text).unwrap();
    printed(folder.path(), &["check", "s.toml"]);
}

/// A file name with commands for a terminal does not issue them in an error.
#[cfg(unix)]
#[test]
fn names_of_scenarios_are_shown_escaped() {
    let folder = tempfile::tempdir().unwrap();
    let name = "a\u{1b}[2J\nb.toml";
    fs::write(folder.path().join(name), "[arch]\n").unwrap();
    let said = stderr(&archrock(folder.path(), &["run", name]));
    assert_legible("error", &said);
    assert!(said.contains(r"a\u001b[2J\nb.toml:1:1: "), "{said}");
    fs::write(folder.path().join(name), format!("{ARCH}{PULSE}")).unwrap();
    assert_legible("run", &printed(folder.path(), &["run", name]));
}
