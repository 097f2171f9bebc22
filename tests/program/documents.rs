//! The documents as a whole: their length, and the output that they quote.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;
use std::{env, fs};

use crate::common::documents::{assert_generated, pages, repository, words};
use crate::common::program::{assert_shown_output_is_printed, scenarios, skip_without};

/// A page is read if it is short. Words in code blocks and in parts that tests write do not count.
#[test]
fn the_documents_are_short() {
    let pages = pages();
    assert!(pages.len() > 20, "{pages:?}");
    let mut counts: Vec<(usize, String)> = pages
        .iter()
        .map(|page| {
            (
                words(&fs::read_to_string(page).unwrap()),
                page.display().to_string(),
            )
        })
        .collect();
    counts.sort();
    let total: usize = counts.iter().map(|(words, _)| words).sum();
    assert!(total <= 33_900, "{total} words: {counts:#?}");
    let count = Command::new("python3")
        .args([".ci/lines", "--words"])
        .current_dir(repository())
        .output();
    let Ok(counted) = count else {
        skip_without("python3");
        return;
    };
    let counted = String::from_utf8(counted.stdout).unwrap();
    assert!(
        counted.ends_with(&format!("{total} words in all\n")),
        "{counted}"
    );
}

/// Each page shows commands on the scenarios of the repository, with lines of their output.
#[test]
fn commands_print_the_output_shown_in_the_documents() {
    for (page, shown) in [
        ("docs/maps.md", 2),
        ("docs/suites.md", 2),
        ("docs/supports.md", 1),
    ] {
        let folder = tempfile::tempdir().unwrap();
        symlink(scenarios(), folder.path().join("scenarios")).unwrap();
        let commands = assert_shown_output_is_printed(page, folder.path());
        assert_eq!(commands, shown, "{page}");
        columns_are_those_of_the_page(&folder.path().join("results"));
    }
}

/// The page with the columns of a file.
fn page_of(file: &str) -> &'static str {
    match file {
        "capacity.csv" => "docs/shapes.md",
        "spread.csv" => "docs/supports.md",
        "map.csv" | "threshold_along.csv" => "docs/maps.md",
        "bands.csv" | "probability.csv" => "docs/uncertain.md",
        "intensity.csv" | "ida.csv" | "peaks.csv" | "capacities.csv" | "fragility.csv" => {
            "docs/suites.md"
        }
        _ => "docs/results.md",
    }
}

/// The meanings of columns in the documents are those of the program, which checks in tests that every column of a table has one.
#[test]
fn columns_have_the_meanings_of_the_program() {
    let text = fs::read_to_string(repository().join("src/output/columns.txt")).unwrap();
    let mut pages: BTreeMap<&str, String> = BTreeMap::new();
    for section in text.split("\n\n[").skip(1) {
        let (files, lines) = section.split_once("]\n").unwrap();
        let first = files.split(']').next().unwrap();
        let all = pages.entry(page_of(first)).or_default();
        let files = files.replace("] [", "`, `");
        let _ = write!(all, "\n### `{files}`\n\n| column | meaning |\n|---|---|\n");
        for line in lines.lines() {
            let (names, meaning) = line.split_once(": ").unwrap();
            let names = if names == "*" {
                "any other"
            } else {
                &format!("`{names}`")
            };
            let _ = writeln!(all, "| {names} | {meaning} |");
        }
    }
    let written_by = "tests/program/documents.rs from src/output/columns.txt";
    assert_eq!(pages.len(), 6);
    for (page, text) in pages {
        assert_generated(page, written_by, &text);
    }
}

/// The dependency in docs/library.md has the version of the package, and the library builds with its features.
#[test]
fn the_dependency_of_the_library_page_is_this_package() {
    let page = fs::read_to_string(repository().join("docs/library.md")).unwrap();
    let (_, manifest) = page.split_once("```toml\n").unwrap();
    let manifest: toml::Table = manifest.split("```").next().unwrap().parse().unwrap();
    let package = &manifest["dependencies"]["archrock"];
    assert_eq!(package["version"].as_str(), Some(env!("CARGO_PKG_VERSION")));
    assert_eq!(package["default-features"].as_bool(), Some(false));
}

/// Every path and every file in docs/architecture.md stands in the sources.
#[test]
fn the_architecture_names_what_exists() {
    let mut sources = String::new();
    let mut folders = ["src", "tests", "python"]
        .map(|folder| repository().join(folder))
        .to_vec();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            sources += &format!("{}\n", path.display());
            if path.is_dir() && !path.ends_with("target") {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                sources += &fs::read_to_string(&path).unwrap();
            }
        }
    }
    let page = fs::read_to_string(repository().join("docs/architecture.md")).unwrap();
    let names = page.split('`').skip(1).step_by(2);
    let names = names.filter(|name| name.contains("::") || name.ends_with(".rs"));
    let mut count = 0;
    for name in names.filter(|name| !name.contains(' ')) {
        let last = name.rsplit("::").next().unwrap();
        let last = last.trim_end_matches("()");
        assert!(last.is_empty() || sources.contains(last), "{name}");
        count += 1;
    }
    assert!(count > 50, "{count}");
}

/// The first lines of tables are those in a page, where `...` stands for the first column or columns.
fn columns_are_those_of_the_page(results: &Path) {
    let pages = ["maps", "shapes", "suites", "supports", "uncertain"];
    let pages = pages.map(|name| repository().join(format!("docs/{name}.md")));
    let page = pages
        .map(|page| fs::read_to_string(page).unwrap())
        .join("\n");
    let mut compared = 0;
    for folder in fs::read_dir(results).unwrap() {
        for file in fs::read_dir(folder.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "csv") {
                continue;
            }
            let name = path.file_name().unwrap().to_str().unwrap();
            let text = fs::read_to_string(&path).unwrap();
            let columns = text.lines().next().unwrap();
            let mut lines = page.lines().filter_map(|line| line.strip_prefix(name));
            let shown = lines
                .next()
                .unwrap_or_else(|| panic!("{name} is not on the page"))
                .trim();
            match shown.strip_prefix("...") {
                Some(last) => assert!(columns.ends_with(last), "{name}: {columns}"),
                None => assert_eq!(columns, shown, "{name}"),
            }
            compared += 1;
        }
    }
    assert!(compared > 0);
}

/// The picture of the failure domain shows the numbers of the table below it. `ARCHROCK_GOLDEN=write` draws it.
#[test]
fn the_picture_of_the_failure_domain_shows_its_table() {
    let page = fs::read_to_string(repository().join("docs/evidence.md")).unwrap();
    let (_, table) = page.split_once("\n| t_p (s) |").unwrap();
    let (codes, rows) = table.split_once('\n').unwrap();
    let codes: Vec<&str> = codes.trim_matches('|').split('|').map(str::trim).collect();
    let rows = rows.lines().skip(1).take_while(|row| row.starts_with('|'));
    let rows: Vec<Vec<Option<f64>>> = rows
        .map(|row| {
            row.trim_matches('|')
                .split('|')
                .map(|cell| cell.trim().parse().ok())
                .collect()
        })
        .collect();
    assert_eq!((codes.len(), rows.len()), (4, 18));
    let (left, right, top, bottom) = (60.0, 620.0, 20.0, 360.0);
    let x = |duration_s: f64| left + duration_s / 1.05 * (right - left);
    let y = |amplitude_g: f64| {
        bottom - (amplitude_g / 0.15).ln() / (6.0_f64 / 0.15).ln() * (bottom - top)
    };
    let mut svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 410\" font-family=\"sans-serif\" font-size=\"13\">\n\
                   <rect width=\"640\" height=\"410\" fill=\"#ffffff\"/>\n"
        .to_owned();
    for amplitude_g in [0.2, 0.5, 1.0, 2.0, 5.0] {
        let at = y(amplitude_g);
        writeln!(
            svg,
            "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#d0d0d0\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{amplitude_g}</text>",
            left - 6.0,
            at + 4.0
        )
        .unwrap();
    }
    for duration_s in [0.2, 0.4, 0.6, 0.8, 1.0] {
        let at = x(duration_s);
        writeln!(
            svg,
            "<path d=\"M{at:.1} {bottom}V{top}\" stroke=\"#d0d0d0\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{duration_s}</text>",
            bottom + 16.0
        )
        .unwrap();
    }
    let marks = [
        ("#0072b2", "m-4 -4h8v8h-8z"),
        ("#d55e00", "m0 -5l5 8h-10z"),
        ("#009e73", "m0 -5l5 5l-5 5l-5 -5z"),
        ("#000000", "m-5 0h10m-5 -5v10"),
    ];
    for (code, (name, (color, mark))) in codes.iter().zip(marks).enumerate() {
        let style = format!("fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"");
        let points = rows
            .iter()
            .filter_map(|row| Some([x(row[0]?), y(row[code + 1]?)]));
        let points: Vec<[f64; 2]> = points.collect();
        assert!(points.len() >= 13, "{name}");
        let legend = [left + 360.0, top + 20.0 + 20.0 * code as f64];
        for [x, y] in points.iter().chain([&legend]) {
            writeln!(svg, "<path d=\"M{x:.1} {y:.1}{mark}\" {style}/>").unwrap();
        }
        let [x, y] = legend;
        writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\">{name}</text>",
            x + 14.0,
            y + 5.0
        )
        .unwrap();
        if *name == "archrock" {
            let line: Vec<String> = points
                .iter()
                .map(|[x, y]| format!("{x:.1} {y:.1}"))
                .collect();
            writeln!(svg, "<path d=\"M{}\" {style}/>", line.join("L")).unwrap();
        }
    }
    svg += "<text x=\"340\" y=\"400\" text-anchor=\"middle\">duration t_p of the step pair (s)</text>\n\
            <text transform=\"translate(16 190)rotate(-90)\" text-anchor=\"middle\">least amplitude that overturns (g)</text>\n</svg>\n";
    let path = repository().join("docs/pictures/failure-domain.svg");
    if env::var("ARCHROCK_GOLDEN").is_ok_and(|value| value == "write") {
        fs::write(&path, &svg).unwrap();
    }
    assert!(
        fs::read_to_string(path).unwrap() == svg,
        "draw it with ARCHROCK_GOLDEN=write, and look at it"
    );
}
