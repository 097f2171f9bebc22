//! Lists of names in documents, in Python and on the page to try: those of the program, in its order.

use std::fs;
use std::path::Path;

use archrock::scenario::Format;
use archrock::{ImpactModel, Pulse};

use crate::common::program::{archrock, stdout};

/// Returns the names in a file of the repository that stand between two words, from one line to another.
fn names(file: &str, [from, to]: [&str; 2], [before, after]: [&str; 2]) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let text = fs::read_to_string(path).unwrap();
    let (_, part) = text.split_once(from).expect(from);
    let (part, _) = part.split_once(to).expect(to);
    let names = part.split(before).skip(1);
    let names = names.map(|rest| rest.split_once(after).expect(after).0.to_owned());
    names.collect()
}

#[test]
fn pulses_are_those_of_the_program() {
    let known: Vec<_> = Pulse::ALL.iter().map(|pulse| pulse.name()).collect();
    let page = names(
        "web/page/choices.js",
        ["const PULSES = [", "];"],
        ["\n  [\"", "\""],
    );
    assert_eq!(page, known);
    let python = "python/package/archrock/_ground.py";
    let class = ["class Pulse(Ground)", "class Record(Ground)"];
    let python = names(python, class, ["@classmethod\n    def ", "("]);
    assert_eq!(python[0], "_of");
    assert_eq!(python[1..], known);
    let rows = ["| kind | acceleration |\n|---|---|", "\n\n"];
    assert_eq!(names("docs/scenario.md", rows, ["\n| `", "`"]), known);
}

#[test]
fn impact_models_are_those_of_the_program() {
    let known: Vec<_> = ImpactModel::ALL.iter().map(|model| model.name()).collect();
    let settings = "python/package/archrock/_scenario.py";
    let line = ["impact model of four links: ", ".\n"];
    assert_eq!(names(settings, line, ["``\"", "\"``"]), known);
    let template = fs::read_to_string("src/cli/init/arch.toml").unwrap();
    assert!(known.iter().all(|name| template.contains(name)));
}

/// `archrock check --help` has the names of the formats, and the documents a row for each.
#[test]
fn formats_of_records_are_those_of_the_program() {
    let known: Vec<_> = Format::ALL.iter().map(|format| format.name()).collect();
    let rows = ["| format | source |", "\n\n"];
    assert_eq!(names("docs/records.md", rows, ["\n| `", "`"]), known);
    let help = stdout(&archrock(Path::new("."), &["check", "--help"]));
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains(&known.join(", ")), "{help}");
}
