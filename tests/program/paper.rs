//! The paper for a journal: its sections, words, references, commands and numbers; and the citation file, which is in step with it.

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::symlink;

use crate::common::documents::{repository, words};
use crate::common::program::{scenarios, shown_output};

fn file(name: &str) -> String {
    fs::read_to_string(repository().join(name)).unwrap()
}

/// The metadata of the paper, and its text.
fn paper() -> (String, String) {
    let paper = file("paper/paper.md");
    let (metadata, text) = (paper.strip_prefix("---\n").unwrap())
        .split_once("\n---\n")
        .unwrap();
    (metadata.to_owned(), text.to_owned())
}

/// A section of the paper, without its heading.
fn section<'a>(text: &'a str, heading: &str) -> &'a str {
    let (_, after) = (text.split_once(&format!("\n# {heading}\n")))
        .unwrap_or_else(|| panic!("the paper has no section {heading}"));
    after.split("\n# ").next().unwrap()
}

/// The Journal of Open Source Software asks for these sections and for 750 to 1,750 words.
#[test]
fn the_paper_has_the_sections_and_the_length_that_the_journal_asks_for() {
    let (_, text) = paper();
    for heading in [
        "Summary",
        "Statement of need",
        "State of the field",
        "Software design",
        "Research impact statement",
        "AI usage disclosure",
        "Acknowledgements",
    ] {
        assert!(words(section(&text, heading)) > 10, "{heading}");
    }
    assert_eq!(section(&text, "References").trim(), "");
    let words = words(&text);
    assert!((750..=1_750).contains(&words), "{words} words");
}

/// Every citation has its entry, and every entry is cited.
#[test]
fn the_citations_of_the_paper_are_in_its_bibliography() {
    let (_, text) = paper();
    let cited = text.split('@').skip(1).map(|after| {
        let end = after.find(|c: char| !c.is_ascii_alphanumeric());
        after[..end.unwrap_or(after.len())].to_owned()
    });
    let cited: BTreeSet<String> = cited.collect();
    let bibliography = file("paper/paper.bib");
    let entries = bibliography.lines().filter(|line| line.starts_with('@'));
    let keys: Vec<String> = entries
        .filter_map(|line| Some(line.split_once('{')?.1.strip_suffix(',')?.to_owned()))
        .collect();
    assert_eq!(cited, keys.iter().cloned().collect());
    assert!(keys.len() == cited.len() && keys.len() > 15, "{keys:?}");
}

/// Numbers in the tables of the paper are in docs/evidence.md, and the benchmarks exist that measure the times.
#[test]
fn the_numbers_of_the_paper_are_those_of_the_evidence() {
    let (_, text) = paper();
    let evidence = file("docs/evidence.md");
    let is_number = |word: &&str| word.starts_with(|c: char| c.is_ascii_digit());
    let evidence: BTreeSet<&str> = evidence
        .split(|c: char| c.is_whitespace() || "|(),:;".contains(c))
        .map(|word| word.trim_end_matches('.'))
        .filter(is_number)
        .collect();
    let (mut numbers, mut benchmarks) = (0, 0);
    for heading in ["Validation", "Performance"] {
        let rows = section(&text, heading).lines();
        for row in rows.filter(|line| line.starts_with('|')).skip(2) {
            let results = row.split('`').next().unwrap();
            for number in results.split([' ', ',', '|']).filter(is_number) {
                assert!(evidence.contains(number), "{number} in {row}");
                numbers += 1;
            }
            if let Some(command) = row.split('`').nth(1) {
                let words: Vec<&str> = command.split(' ').collect();
                let ["cargo", "bench", "--bench", program, benchmark] = words[..] else {
                    panic!("{command}");
                };
                let program = file(&format!("benches/{program}.rs"));
                assert!(program.contains(&format!("fn {benchmark}(")), "{command}");
                benchmarks += 1;
            }
        }
    }
    assert!(numbers > 20 && benchmarks == 4, "{numbers}, {benchmarks}");
}

#[test]
fn commands_of_the_paper_print_the_output_shown() {
    let folder = tempfile::tempdir().unwrap();
    symlink(scenarios(), folder.path().join("scenarios")).unwrap();
    let (_, text) = paper();
    assert_eq!(shown_output(&text, folder.path()).len(), 3);
    let named = text.split('`').filter(|code| code.starts_with("docs/"));
    for page in named {
        assert!(repository().join(page).exists(), "{page}");
    }
}

/// The citation file has the version of the package, and its keywords are tags of the paper.
#[test]
fn the_citation_file_is_in_step_with_package_and_paper() {
    let citation = file("CITATION.cff");
    let version = format!("\nversion: {}\n", env!("CARGO_PKG_VERSION"));
    assert!(citation.contains(&version), "{version}");
    let (metadata, _) = paper();
    assert!(metadata.starts_with("title: 'archrock: "), "{metadata}");
    let (_, keywords) = citation.split_once("keywords:\n").unwrap();
    let keywords: Vec<&str> = keywords.lines().collect();
    assert!(keywords.len() > 4, "{keywords:?}");
    for keyword in keywords {
        assert!(metadata.contains(&format!("{keyword}\n")), "{keyword}");
    }
}
