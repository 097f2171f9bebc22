//! Pages of the documents: parts that tests write, and the words that people wrote.

use std::path::{Path, PathBuf};
use std::{env, fs};

pub fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The pages of the folder `docs`, and those for a first look.
pub fn pages() -> Vec<PathBuf> {
    let docs = fs::read_dir(repository().join("docs")).unwrap();
    let docs = docs.map(|entry| entry.unwrap().path());
    let docs = docs.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    let first = ["README.md", "python/README.md"].map(|name| repository().join(name));
    first.into_iter().chain(docs).collect()
}

/// Asserts that the part of a page between the marks `Written by ...` and `end` is this text. `ARCHROCK_GOLDEN=write` writes it.
#[track_caller]
pub fn assert_generated(page: &str, written_by: &str, text: &str) {
    let path = repository().join(page);
    let old = fs::read_to_string(&path).unwrap();
    let begin = format!("<!-- Written by {written_by}. -->\n");
    let (before, after) = old.split_once(&begin).unwrap();
    let (known, after) = after.split_once("\n<!-- end -->").unwrap();
    if env::var("ARCHROCK_GOLDEN").is_ok_and(|value| value == "write") {
        fs::write(path, format!("{before}{begin}{text}\n<!-- end -->{after}")).unwrap();
        return;
    }
    let mut lines = known.lines().zip(text.lines());
    let first = lines.find(|(known, now)| known != now);
    assert!(
        known == text,
        "{page} is not up to date, first in {first:?}: run ARCHROCK_GOLDEN=write cargo test --test all -- summaries keys columns_have"
    );
}

/// Asserts that a file is this text. `ARCHROCK_GOLDEN=write` writes it.
#[track_caller]
pub fn assert_generated_file(path: &str, text: &str) {
    let file = repository().join(path);
    if env::var("ARCHROCK_GOLDEN").is_ok_and(|value| value == "write") {
        fs::write(file, text).unwrap();
        return;
    }
    let known = fs::read_to_string(file).unwrap();
    let mut lines = known.lines().zip(text.lines());
    let first = lines.find(|(known, now)| known != now);
    assert!(
        known == text,
        "{path} is not up to date, first in {first:?}: run ARCHROCK_GOLDEN=write cargo test --test all -- summaries"
    );
}

/// The number of words outside code blocks and outside the parts that tests write.
pub fn words(page: &str) -> usize {
    let (mut is_code, mut is_generated) = (false, false);
    let mut count = 0;
    for line in page.lines() {
        is_code ^= line.starts_with("```");
        is_generated = match line {
            "<!-- end -->" => false,
            _ => is_generated || line.starts_with("<!-- Written by "),
        };
        if !is_code && !is_generated && !line.starts_with("    ") {
            let words = line.split_whitespace();
            count += words
                .filter(|word| word.contains(char::is_alphanumeric))
                .count();
        }
    }
    count
}
