//! The tables of a page, with rounded numbers.

use serde::{Deserialize, Serialize};

use crate::output::{Table, columns};

/// A table with rounded numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PageTable {
    /// Name of its file.
    pub(super) name: String,
    pub(super) header: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
    /// Number of rows in the file.
    pub(super) all: usize,
    /// Names of the columns with text.
    #[serde(skip)]
    pub(super) text_columns: Vec<String>,
}

impl PageTable {
    /// Returns the meaning of a column.
    pub(super) fn meaning(&self, column: &str) -> &'static str {
        columns::meaning(&self.name, column).unwrap_or_default()
    }

    /// Takes the first rows of a table, with rounded numbers.
    pub(super) fn of(name: &str, table: &Table) -> Self {
        columns::check(name, table.header.iter().map(String::as_str));
        Self {
            name: name.to_owned(),
            header: table.header.clone(),
            rows: table.first.clone(),
            all: table.rows,
            text_columns: table.text_columns(),
        }
    }
}
