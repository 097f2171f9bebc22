//! Meanings of the columns of tables, for pages and for the reference in the documents.

use glob::Pattern;

/// Sections, each headed by the names of files in brackets, with a line `column: meaning` for each column.
const COLUMNS: &str = include_str!("columns.txt");

/// Returns the meaning of a column of a file: that of the first line in the section of the file that fits.
pub(crate) fn meaning(file: &str, column: &str) -> Option<&'static str> {
    let mut sections = COLUMNS.split("\n\n[").skip(1);
    let lines = sections.find_map(|section| {
        let (files, lines) = section.split_once("]\n")?;
        files.split("] [").any(|name| name == file).then_some(lines)
    })?;
    let mut lines = lines.lines().filter_map(|line| line.split_once(": "));
    let fits = |names: &str| Pattern::new(names).is_ok_and(|names| names.matches(column));
    lines.find_map(|(names, meaning)| fits(names).then_some(meaning))
}

/// Checks in builds for tests that each column of a file has a meaning.
pub(crate) fn check<'n>(file: &str, mut columns: impl Iterator<Item = &'n str>) {
    if cfg!(debug_assertions) {
        let unknown = columns.find(|column| meaning(file, column).is_none());
        assert_eq!(unknown, None, "columns.txt lacks this column of {file}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_fits_its_pattern() {
        let gap = meaning("joints.csv", "gap_12_extrados_m").unwrap();
        assert!(gap.starts_with("gap of a joint"), "{gap}");
        let key = meaning("map.csv", "arch.thickness_ratio").unwrap();
        assert!(key.starts_with("value of the key"), "{key}");
        assert_eq!(meaning("joints.csv", "gaps"), None);
        assert_eq!(meaning("other.csv", "time_s"), None);
    }
}
