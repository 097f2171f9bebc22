//! The README and other pages: pictures are those that the program draws, printed output is the program's, links lead somewhere.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::program::{archrock, scenarios, stderr, stdout};
use crate::common::prose::skeleton;

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn run(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = archrock(folder.path(), arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// The commands are those of `docs/pictures/draw`.
#[test]
fn the_pictures_of_the_readme_are_up_to_date() {
    let script = fs::read_to_string(repository().join("docs/pictures/draw")).unwrap();
    let script = script.replace("\\\n", " ");
    let folder = tempfile::tempdir().unwrap();
    let drawn = folder.path().to_str().unwrap();
    let mut commands = 0;
    for line in script.lines() {
        let Some(arguments) = line.strip_prefix("\"$program\" ") else {
            continue;
        };
        let arguments = arguments.replace("../../scenarios", scenarios().to_str().unwrap());
        let arguments = arguments
            .replace("\"$folder/", &format!("{drawn}/"))
            .replace('"', "");
        run(&arguments.split_whitespace().collect::<Vec<_>>());
        commands += 1;
    }
    assert_eq!(commands, 4);
    for picture in [
        "free/snapshots.svg",
        "pulse/history.svg",
        "map/map.svg",
        "models/overlay.svg",
    ] {
        let name = Path::new(picture).file_name().unwrap();
        let committed = fs::read_to_string(repository().join("docs/pictures").join(name));
        let drawn = fs::read_to_string(folder.path().join(picture)).unwrap();
        assert!(
            committed.unwrap_or_default() == drawn,
            "{picture} is stale: draw it with docs/pictures/draw and look at it"
        );
    }
}

#[test]
fn the_readme_quotes_the_output_of_run() {
    let readme = fs::read_to_string(repository().join("README.md")).unwrap();
    let scenario = scenarios().join("semicircle-pulse.toml");
    let said = run(&["run", scenario.to_str().unwrap()]);
    let title = said.lines().next().unwrap();
    let (_, quoted) = readme.split_once(&format!("    {title}\n")).unwrap();
    let quoted = quoted.lines().map_while(|line| line.strip_prefix("    "));
    let mut lines = said.lines();
    for line in quoted.clone().filter(|line| *line != "...") {
        assert!(lines.any(|own| own == line), "{line}\n{said}");
    }
    assert!(quoted.count() > 5);
}

/// Below a paragraph of these pages with a command on a scenario are lines that the command prints, in their order.
#[test]
fn pages_quote_the_output_of_their_commands() {
    for (page, outputs) in [("docs/example.md", 3)] {
        let page = fs::read_to_string(repository().join(page)).unwrap();
        let mut blocks = page.split("\n\n").peekable();
        let mut quoted = 0;
        while let Some(paragraph) = blocks.next() {
            let paragraph = paragraph.replace('\n', " ");
            let mut code = paragraph.split('`').skip(1).step_by(2);
            let Some(command) = code.find(|code| code.contains(" scenarios/")) else {
                continue;
            };
            let folder = scenarios().display().to_string();
            let command = command.replace("scenarios", &folder);
            let said = run(&command.split(' ').skip(1).collect::<Vec<_>>());
            let mut lines = said.lines();
            assert!(blocks.peek().is_some_and(|next| next.starts_with("    ")));
            while let Some(output) = blocks.next_if(|next| next.starts_with("    ")) {
                for line in output.lines().filter_map(|line| line.strip_prefix("    ")) {
                    assert!(lines.any(|own| own == line), "{line}\n{said}");
                }
            }
            quoted += 1;
        }
        assert_eq!(quoted, outputs);
    }
}

/// Returns true if a line is the quoted one, in which "..." is any text.
fn is_quoted(quoted: &str, line: &str) -> bool {
    let mut parts = quoted.split("...");
    let Some(rest) = line.strip_prefix(parts.next().unwrap_or_default()) else {
        return false;
    };
    let rest = parts.try_fold(rest, |rest, part| Some(rest.split_once(part)?.1));
    rest.is_some_and(|rest| rest.is_empty() || quoted.ends_with("..."))
}

/// The first cells of the tables of docs/report.md below a command are lines that the command prints, in their order.
#[test]
fn the_page_on_the_printed_report_quotes_its_lines() {
    let page = fs::read_to_string(repository().join("docs/report.md")).unwrap();
    let mut tables = 0;
    for part in page.split("`archrock ").skip(1) {
        let Some((command, table)) = part.split_once("` prints") else {
            continue;
        };
        // A map has thousands of histories.
        if command.starts_with("map ") {
            continue;
        }
        // The motion of rows of blocks depends on the last digits of the machine, so only the words are compared.
        let is_exact = !["free-hinges", "elastic-joints"]
            .iter()
            .any(|name| command.contains(name));
        let shape = |text: &str| match is_exact {
            true => text.to_owned(),
            false => skeleton(text).0,
        };
        let (_, table) = table.split_once(":\n\n").unwrap();
        let rows = table.lines().take_while(|line| line.starts_with('|'));
        let cells = rows.skip(2).filter_map(|row| row.split('|').nth(1));
        let command = command.replace("scenarios", &scenarios().display().to_string());
        let folder = tempfile::tempdir().unwrap();
        let output = archrock(folder.path(), &command.split(' ').collect::<Vec<_>>());
        let said = stdout(&output) + &stderr(&output);
        let mut lines = said.lines();
        for quoted in cells.clone().map(|cell| cell.trim_matches([' ', '`'])) {
            let is_here = |own: &str| is_quoted(&shape(quoted), &shape(own.trim()));
            assert!(lines.any(is_here), "{quoted}\n{said}");
        }
        assert!(cells.count() > 1);
        tables += 1;
    }
    assert_eq!(tables, 8);
}

#[test]
fn the_readme_is_short() {
    let readme = fs::read_to_string(repository().join("README.md")).unwrap();
    let words = readme.split_whitespace();
    let words = words
        .filter(|word| word.contains(char::is_alphanumeric))
        .count();
    assert!(words <= 700, "{words} words");
}

#[test]
fn links_of_the_documents_have_targets() {
    let docs = fs::read_dir(repository().join("docs")).unwrap();
    let pages = docs.map(|entry| entry.unwrap().path());
    let mut pages: Vec<PathBuf> = pages
        .filter(|path| path.extension().is_some_and(|e| e == "md"))
        .collect();
    pages.push(repository().join("README.md"));
    let mut links = 0;
    for page in pages {
        let text = fs::read_to_string(&page).unwrap();
        for link in text
            .split("](")
            .skip(1)
            .filter_map(|after| after.split_once(')'))
        {
            let (path, anchor) = link.0.split_once('#').unwrap_or((link.0, ""));
            if path.starts_with("http") {
                continue;
            }
            let to = if path.is_empty() {
                page.clone()
            } else {
                page.with_file_name(path)
            };
            assert!(to.exists(), "{} links to {path}", page.display());
            if !anchor.is_empty() {
                let text = fs::read_to_string(&to).unwrap();
                let headings = text.lines().filter_map(|line| line.strip_prefix('#'));
                let found = headings.map(anchor_of).any(|known| known == anchor);
                assert!(found, "{} links to {path}#{anchor}", page.display());
            }
            links += 1;
        }
    }
    assert!(links > 30);
}

/// The anchor of a heading, as repository hosts form it.
fn anchor_of(heading: &str) -> String {
    let words = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = words
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}
