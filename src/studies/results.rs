//! Files and words of a study from its rows, identical for the program, for merged parts and for Python.

use askama::Template;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::page_cases::PageCases;
use super::page_table::PageTable;
use super::quotable::ModelAnswer;
use super::report::{Report, Statement};
use crate::output::{Figure, Folder, OutputError, Table, pretty, render, summary_of};

/// The results of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Results {
    /// Names and contents of the files. A folder that contains the last file is complete.
    pub files: Vec<(&'static str, Vec<u8>)>,
    /// The statements of the report.
    pub statement: Statement,
    /// The report in words: the first line is not indented, the others are, and the last has no line break.
    pub words: String,
    /// The summary as JSON.
    pub summary: Value,
    /// Tables for the page.
    pub(super) tables: Vec<PageTable>,
    /// The largest rotation of each case of a suite, or of the scenario itself and each sample of a run, in radians, for the comparison of models of
    /// motion. Infinite if the case overturned; `None` for the scenario itself, and without a complete history.
    pub largest_rotations_rad: Vec<Option<f64>>,
    /// The answer of a suite that may be quoted, for the comparison of models of motion.
    pub answer: Option<ModelAnswer>,
    /// The cases on the page.
    pub(super) cases: Box<PageCases>,
}

impl Results {
    /// Makes results of a report, whose JSON is a file.
    ///
    /// # Errors
    /// When a number of the report is not finite.
    pub(super) fn of<R: Report>(json: &'static str, report: &R) -> Result<Self, OutputError> {
        let (summary, statement) = (summary_of(report)?, Statement::of(report));
        Ok(Self {
            files: vec![(json, pretty(&summary).into_bytes())],
            words: statement.in_words(),
            statement,
            summary,
            ..Self::default()
        })
    }

    /// Adds a file, such as a picture.
    pub(super) fn with_file(mut self, name: &'static str, contents: impl Into<Vec<u8>>) -> Self {
        self.files.push((name, contents.into()));
        self
    }

    /// Adds a table. The page shows the first table first, with the cases in its rows.
    pub(super) fn with_table(mut self, name: &'static str, table: Table) -> Self {
        self.tables.push(PageTable::of(name, &table));
        self.with_file(name, table.csv)
    }

    /// Puts the files into the order of a list of names, which has all of them.
    pub(super) fn in_order(mut self, names: &[&'static str]) -> Self {
        let place = |name: &str| names.iter().position(|known| *known == name);
        debug_assert!(self.files.iter().all(|(name, _)| place(name).is_some()));
        self.files.sort_by_key(|(name, _)| place(name));
        self
    }

    /// Returns the names of the files, in their order.
    pub fn names(&self) -> Vec<&'static str> {
        self.files.iter().map(|(name, _)| *name).collect()
    }

    /// Writes the files into a folder, where they get their names when the results are published.
    ///
    /// # Errors
    /// When the system reports an error, or as for [`Folder::check`].
    pub fn write(&self, folder: &Folder) -> Result<(), OutputError> {
        let mut files = self.files.iter();
        files.try_for_each(|(name, contents)| folder.write(name, contents))
    }

    /// Returns the names of the columns with text, for each table.
    pub fn text_columns(&self) -> impl Iterator<Item = (&str, &[String])> {
        let tables = self.tables.iter();
        tables.map(|table| (table.name.as_str(), table.text_columns.as_slice()))
    }
}

/// Makes the words of a report of this type from its JSON alone.
///
/// # Errors
/// When it is not the JSON of such a report.
pub fn words_of_json<R: DeserializeOwned + Report>(json: &Value) -> serde_json::Result<String> {
    Ok(Statement::of(&R::deserialize(json)?).in_words())
}

/// Returns the words of a report, without a line break at the end.
pub(super) fn words_of(report: &impl Template) -> String {
    render(report).trim().to_owned()
}

/// A result without files, as JSON and in words.
#[derive(Clone, Debug, PartialEq)]
pub struct PrintedResult {
    /// All numbers.
    pub json: Value,
    /// The result in words.
    pub text: String,
}

impl PrintedResult {
    /// Makes the result of a summary, whose words are a template.
    pub(super) fn of(summary: &(impl Serialize + Template)) -> Result<Self, OutputError> {
        Ok(Self {
            json: summary_of(summary)?,
            text: render(summary),
        })
    }
}

/// The style of results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Width of the pictures, and the size of their text.
    pub figure: Figure,
    /// Colours surviving cells of a map by the ratio of the largest to the critical rotation, if the critical rotation is known.
    pub by_peak: bool,
    /// Factors that make the axes of a map, pulse duration and amplitude, dimensionless; `None`: the axes keep their units.
    pub factors: Option<[f64; 2]>,
}

impl Style {
    /// Returns the style of a map coloured by outcome, with units on its axes.
    pub const fn of(figure: Figure) -> Self {
        Self {
            figure,
            by_peak: false,
            factors: None,
        }
    }

    /// Returns the style with another layout.
    pub(super) const fn with(self, figure: Figure) -> Self {
        Self { figure, ..self }
    }
}
