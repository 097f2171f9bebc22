//! The README and other pages: pictures are those that the program draws, printed output is the program's, links lead somewhere.

use std::fs;
use std::os::unix::fs::symlink;

use crate::common::documents::{pages, repository, words};
use crate::common::program::{archrock, printed, scenarios, stderr, stdout, typed};

/// The commands of `docs/pictures/draw` that draw a picture: its name, the file among the results (none: the command draws it with --plot),
/// and the words of the command.
fn drawn_pictures() -> Vec<(String, Option<String>, Vec<String>)> {
    let script = fs::read_to_string(repository().join("docs/pictures/draw")).unwrap();
    let pictures = script.lines().filter_map(|line| {
        let mut words = line.split_whitespace().map(str::to_owned);
        match words.next()?.as_str() {
            "picture" => Some((words.next()?, Some(words.next()?), words.collect())),
            "plot" => Some((words.next()?, None, words.collect())),
            _ => None,
        }
    });
    pictures.collect()
}

#[test]
fn the_pictures_of_the_documents_are_up_to_date() {
    let folder = tempfile::tempdir().unwrap();
    symlink(scenarios(), folder.path().join("scenarios")).unwrap();
    let mut total = 0;
    let pictures = drawn_pictures();
    for (name, file, command) in &pictures {
        let mut arguments: Vec<&str> = command.iter().map(String::as_str).collect();
        let picture = format!("{name}.svg");
        match file {
            Some(_) => arguments.extend(["--out", name]),
            None => arguments.extend(["--plot", &picture]),
        }
        printed(folder.path(), &arguments);
        let drawn = match file {
            Some(file) => folder.path().join(name).join(file),
            None => folder.path().join(&picture),
        };
        let drawn = fs::read_to_string(drawn).unwrap();
        let committed = fs::read_to_string(repository().join("docs/pictures").join(&picture));
        assert!(
            committed.unwrap_or_default() == drawn,
            "{picture} is stale: draw it with docs/pictures/draw and look at it"
        );
        // The page of recipes has many of them; these are on other pages.
        let limit = match name.as_str() {
            "map" | "history" | "overlay" => 160_000,
            _ => 60_000,
        };
        assert!(drawn.len() < limit, "{picture}: {} bytes", drawn.len());
        total += drawn.len();
    }
    assert!(pictures.len() > 20 && total < 1_200_000, "{total} bytes");
}

/// A command below a picture of the recipes is the one that draws it. On the site such a picture is live.
#[test]
fn commands_below_pictures_draw_them() {
    let page = fs::read_to_string(repository().join("docs/recipes.md")).unwrap();
    let pictures = drawn_pictures();
    let mut shown = 0;
    for part in page.split("](pictures/").skip(1) {
        let (name, below) = part.split_once(".svg)").unwrap();
        if !below.starts_with("\n\n`archrock ") {
            continue;
        }
        let (_, file, command) = (pictures.iter().find(|(known, ..)| known == name)).unwrap();
        let mut expected = format!("`archrock {}", command.join(" "));
        if file.is_none() {
            expected += &format!(" --plot {name}.svg");
        }
        assert!(below.starts_with(&format!("\n\n{expected}`")), "{expected}");
        shown += 1;
    }
    assert_eq!(shown, 13);
}

#[test]
fn the_readme_quotes_the_output_of_run() {
    let readme = fs::read_to_string(repository().join("README.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    symlink(scenarios(), folder.path().join("scenarios")).unwrap();
    let said = stdout(&typed(
        folder.path(),
        &["run", "scenarios/semicircle-pulse.toml"],
    ));
    let title = said.lines().next().unwrap();
    let (_, quoted) = readme.split_once(&format!("    {title}\n")).unwrap();
    let quoted = quoted.lines().map_while(|line| line.strip_prefix("    "));
    let mut lines = said.lines();
    for line in quoted.clone().filter(|line| *line != "...") {
        assert!(lines.any(|own| own == line), "{line}\n{said}");
    }
    assert!(quoted.count() > 5);
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
        let (_, table) = table.split_once(":\n\n").unwrap();
        let rows = table.lines().take_while(|line| line.starts_with('|'));
        let cells = rows.skip(2).filter_map(|row| row.split('|').nth(1));
        let command = command.replace("scenarios", &scenarios().display().to_string());
        let folder = tempfile::tempdir().unwrap();
        let output = archrock(folder.path(), &command.split(' ').collect::<Vec<_>>());
        let said = stdout(&output) + &stderr(&output);
        let mut lines = said.lines();
        for quoted in cells.clone().map(|cell| cell.trim_matches([' ', '`'])) {
            let is_here = |own: &str| is_quoted(quoted, own.trim());
            assert!(lines.any(is_here), "{quoted}\n{said}");
        }
        assert!(cells.count() > 1);
        tables += 1;
    }
    assert_eq!(tables, 10);
}

#[test]
fn pages_for_a_first_look_are_short() {
    for (page, limit) in [
        ("README.md", 500),
        ("python/README.md", 200),
        ("docs/README.md", 200),
        ("docs/start.md", 900),
        ("docs/report.md", 2_400),
        ("docs/choose.md", 1_400),
        ("docs/recipes.md", 3_200),
        ("docs/questions.md", 900),
        ("docs/python.md", 900),
    ] {
        let text = fs::read_to_string(repository().join(page)).unwrap();
        let words = words(&text);
        assert!(words <= limit, "{page}: {words} words");
    }
}

#[test]
fn links_of_the_documents_have_targets() {
    let mut links = 0;
    for page in pages() {
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

/// The contents link every page. The keys of JSON are a reference for programs, to which the page of results leads.
#[test]
fn the_contents_name_every_page() {
    let contents = fs::read_to_string(repository().join("docs/README.md")).unwrap();
    let names = fs::read_dir(repository().join("docs")).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let is_read = |name: &String| name != "README.md" && name != "json.md";
    for name in names.filter(|name| name.ends_with(".md") && is_read(name)) {
        assert!(contents.contains(&format!("]({name})")), "{name}");
    }
}

/// The anchor of a heading, as repository hosts form it.
fn anchor_of(heading: &str) -> String {
    let words = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = words
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}
