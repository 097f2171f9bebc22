//! The documents as a whole: their length, and the output that they quote.

use std::fs;
use std::os::unix::fs::symlink;

use crate::common::documents::{pages, words};
use crate::common::program::{assert_shown_output_is_printed, scenarios};

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
    assert!(total <= 32_000, "{total} words: {counts:#?}");
}

/// Each page shows commands on the scenarios of the repository, with lines of their output.
#[test]
fn commands_print_the_output_shown_in_the_documents() {
    for (page, shown) in [
        ("docs/maps.md", 1),
        ("docs/suites.md", 1),
        ("docs/spectra.md", 1),
        ("docs/supports.md", 1),
    ] {
        let folder = tempfile::tempdir().unwrap();
        symlink(scenarios(), folder.path().join("scenarios")).unwrap();
        let commands = assert_shown_output_is_printed(page, folder.path());
        assert_eq!(commands, shown, "{page}");
    }
}
