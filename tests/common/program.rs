//! Running the program in tests.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, Mutex, OnceLock};

use archrock::Scenario;
use archrock::scenario::{ReadOptions, Source};

/// The program with these arguments, in a folder, without a keyboard.
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_archrock"));
    command
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// Output of the program with exactly these arguments.
pub fn typed(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

/// Output of the program with these arguments, and with `--details` for a study that prints words: most tests read all numbers.
pub fn archrock(folder: &Path, arguments: &[&str]) -> Output {
    let has_answer = |name: &&str| ["run", "threshold", "map", "suite", "merge"].contains(name);
    let chooses = |one: &&str| ["--quiet", "--details", "--format", "--help"].contains(one);
    let details = arguments.first().is_some_and(has_answer) && !arguments.iter().any(chooses);
    let mut arguments = arguments.to_vec();
    if details {
        arguments.insert(1, "--details");
    }
    typed(folder, &arguments)
}

/// The thoughts of an answer below its title, as in `to_quote`: without line breaks and capitals.
pub fn thoughts(answer: &str) -> String {
    let mut joined = String::new();
    for line in answer.lines().skip(1) {
        let is_continued = line.starts_with("    ");
        joined += match joined.is_empty() {
            true => "",
            false if is_continued => " ",
            false => "; ",
        };
        joined += line.trim();
    }
    [
        "SURVIVES",
        "OVERTURNS",
        "NEVER MOVES",
        "VIBRATES",
        "NO ANSWER",
        "NO VERDICT",
    ]
    .into_iter()
    .fold(joined, |joined, verdict| {
        joined.replace(verdict, &verdict.to_lowercase())
    })
}

/// Says that a test cannot run without a tool, or fails if ARCHROCK_REQUIRE_TOOLS is 1 (`.ci/run`): a skipped test looks like one that passes.
#[track_caller]
#[expect(clippy::print_stderr, reason = "the reader of the test")]
pub fn skip_without(tool: &str) {
    let required = std::env::var("ARCHROCK_REQUIRE_TOOLS").is_ok_and(|value| value == "1");
    assert!(!required, "{tool} is not installed");
    eprintln!("{tool} is not installed: nothing tested");
}

/// Standard error of the program, with the lines in one that it has wrapped.
pub fn stderr(output: &Output) -> String {
    let printed = String::from_utf8(output.stderr.clone()).unwrap();
    printed.replace("\n  ", " ")
}

/// Standard output of a run that must have succeeded.
#[track_caller]
pub fn stdout(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Standard output of a command that must succeed.
#[track_caller]
pub fn printed(folder: &Path, arguments: &[&str]) -> String {
    stdout(&archrock(folder, arguments))
}

/// Everything that a command that must succeed prints: standard error, then standard output.
#[track_caller]
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = archrock(folder, arguments);
    let warnings = stderr(&output);
    warnings + &stdout(&output)
}

/// Message of a run that must have refused its input without printing anything.
#[track_caller]
pub fn refusal(output: &Output) -> String {
    let said = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(output.stdout.is_empty(), "{said}");
    said
}

/// Message of a command that must refuse its input with these words, without printing anything.
#[track_caller]
pub fn refused(folder: &Path, arguments: &[&str], words: &[&str]) -> String {
    let said = refusal(&archrock(folder, arguments));
    for words in words {
        assert!(said.contains(words), "{words:?} is not in: {said}");
    }
    said
}

/// Names of the entries of a folder, in order.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Names of the results in a folder, without the list of them.
pub fn result_names(folder: &Path) -> Vec<String> {
    let mut names = names(folder);
    names.retain(|name| name != "archrock.json");
    names
}

/// All results in a folder with their contents, without the list of them.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    result_names(folder)
        .into_iter()
        .map(|name| {
            let contents = fs::read(folder.join(&name)).unwrap();
            (name, contents)
        })
        .collect()
}

/// The files of a run without further options.
pub const RUN_FILES: [&str; 6] = [
    "events.csv",
    "history.svg",
    "impacts.csv",
    "report.html",
    "rotations.csv",
    "summary.json",
];

/// The folder of the scenarios of the repository.
pub fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios")
}

/// The single scenarios among them.
pub fn scenario_files() -> Vec<PathBuf> {
    let names = names(&scenarios()).into_iter();
    let files = names.filter(|name| name.ends_with(".toml"));
    files.map(|name| scenarios().join(name)).collect()
}

/// Reads a scenario of the repository; some are for statics alone.
pub fn example(path: &Path) -> Scenario {
    let options = ReadOptions {
        statics: is_for_statics(path),
        ..ReadOptions::default()
    };
    Scenario::of(&Source::of_file(path).unwrap(), &options).unwrap()
}

/// True for a scenario that has no model of motion.
pub fn is_for_statics(path: &Path) -> bool {
    path.ends_with("vertical-bending.toml")
}

/// The commands that a page of the documentation shows, each with the lines of its output that are shown.
pub fn shown_commands(page: &str) -> Vec<(Vec<String>, Vec<String>)> {
    let mut commands: Vec<(Vec<String>, Vec<String>)> = Vec::new();
    let mut is_fenced = false;
    for line in page.lines() {
        is_fenced ^= line.starts_with("```");
        let Some(line) = line.strip_prefix("    ").filter(|_| !is_fenced) else {
            continue;
        };
        match line.strip_prefix("$ archrock ") {
            Some(command) => {
                // None of the words has a blank, so a shell would only drop the quotation marks.
                let words = command
                    .split_whitespace()
                    .map(|word| word.trim_matches('\'').to_owned());
                commands.push((words.collect(), Vec::new()));
            }
            None => commands.last_mut().unwrap().1.push(line.to_owned()),
        }
    }
    commands
}

/// The cells of the row of docs/evidence.md whose label begins with `label`, as the numbers in each cell.
#[track_caller]
pub fn validated(label: &str) -> Vec<Vec<f64>> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/evidence.md");
    let page = fs::read_to_string(page).unwrap();
    let start = format!("| {label}");
    let row = page.lines().find(|line| line.starts_with(&start)).unwrap();
    let cells = row.trim_matches('|').split('|').skip(1);
    let numbers = |cell: &str| {
        let words = cell.split([' ', ',']);
        words.filter_map(|word| word.parse().ok()).collect()
    };
    cells.map(numbers).collect()
}

/// Runs the commands of a page, as printed there, in a folder; each must print the lines shown, in their order. Returns
/// the number of commands.
#[track_caller]
pub fn assert_shown_output_is_printed(page: &str, folder: &Path) -> usize {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
    shown_output(&fs::read_to_string(page).unwrap(), folder).len()
}

/// All that a command prints, which must end well.
#[track_caller]
fn all_printed(folder: &Path, arguments: &[&str]) -> String {
    let output = typed(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    String::from_utf8(output.stdout.clone()).unwrap() + &stderr(&output)
}

/// Runs the commands of a text, as printed there, in a folder; each must print the lines shown, in their order. Returns all that they print.
/// A threshold that two pages show is computed once.
#[track_caller]
pub fn shown_output(text: &str, folder: &Path) -> Vec<String> {
    type Known = OnceLock<String>;
    static THRESHOLDS: Mutex<BTreeMap<Vec<String>, Arc<Known>>> = Mutex::new(BTreeMap::new());
    let commands = shown_commands(text).into_iter();
    let outputs = commands.map(|(command, shown)| {
        let arguments: Vec<&str> = command.iter().map(String::as_str).collect();
        let known = match arguments[0] {
            "threshold" => THRESHOLDS
                .lock()
                .unwrap()
                .entry(command.clone())
                .or_default()
                .clone(),
            _ => Arc::default(),
        };
        let said = known
            .get_or_init(|| all_printed(folder, &arguments))
            .clone();
        let mut lines = said.lines();
        assert!(!shown.is_empty(), "{arguments:?}");
        for line in shown {
            assert!(
                line == "..." || lines.any(|said| said == line),
                "{arguments:?} does not say {line:?}, or not after the line before:\n{said}"
            );
        }
        said
    });
    outputs.collect()
}
