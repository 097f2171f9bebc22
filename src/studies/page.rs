//! The page of a study, beside its other results: verdict, pictures with all cases and their commands, words, assumptions and tables.
//!
//! A study provides its pictures, its cases in the order of its first table, and its assumptions. Words, warnings and tables are those of its
//! other files, so the page has no number of its own.

use std::iter;

use askama::Template;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::Results;
use super::page_cases::MOST_CASES;
pub(super) use super::page_cases::{PageCases, kind_of};
use crate::argument::plain;
use crate::output::caption::caption;
use crate::output::page::{BASE, OUTSIDE_MODEL, PROGRAM, STUDY, STYLE, SpotKind, script_safe};
use crate::output::{Figure, filters, render};
use crate::scenario::{ModelKind, Scenario};

/// Largest number of rows of the other tables.
const MOST_ROWS: usize = 100;

/// The page. Everything but the pictures is in its JSON.
#[derive(Default, Serialize, Deserialize, Template)]
#[template(path = "output/page/study.html")]
pub(super) struct Page {
    title: String,
    /// The verdict; empty for the answer that may be quoted, or without one the first line of the words.
    pub(super) verdict: String,
    /// The input of the study in one line.
    what: String,
    /// Warnings, without those of the summary.
    pub(super) warnings: Vec<String>,
    /// The command of a case, without `archrock` and its scenario; that of a run by default.
    pub(super) command: String,
    assumptions: Vec<String>,
    /// The picture with the cases, for wide and for narrow screens.
    #[serde(skip)]
    picture: [String; 2],
    /// The other pictures, side by side on wide screens.
    #[serde(skip)]
    more: Vec<String>,
    /// Number of cases with each outcome.
    legend: Vec<(SpotKind, usize)>,
    /// Number of cases outside the model of four links.
    outside: usize,
    #[serde(flatten)]
    all: PageCases,
    words: String,
    tables: Vec<PageTable>,
}

/// A table with rounded numbers.
#[derive(Serialize, Deserialize)]
struct PageTable {
    name: String,
    header: Vec<String>,
    rows: Vec<Vec<String>>,
    /// Number of rows in the file.
    all: usize,
}

/// Renders a page again from its picture for wide and for narrow screens, its other pictures, and the JSON inside it.
///
/// # Errors
/// When the JSON is not that of a page.
pub fn page_of(picture: [String; 2], more: Vec<String>, data: &str) -> serde_json::Result<String> {
    let page = serde_json::from_str::<Page>(data)?;
    Ok(render(&Page {
        picture,
        more,
        ..page
    }))
}

impl Page {
    /// Makes a page without cases, with assumptions of the study itself, of its models and of all models.
    pub(super) fn new(title: &str, what: String, own: &[&str], models: &[&ModelKind]) -> Self {
        const ALL: &str = "blocks are rigid and move in one plane, without tension in the joints, on springings or a base that move with the \
                           ground; not computed: motion in three dimensions, the soil, and the thrust of a fill";
        let models = models.iter().map(|model| model.assumptions);
        let all = own.iter().copied().chain(models).chain([ALL]);
        Self {
            title: title.to_owned(),
            what,
            command: "run - --out case".to_owned(),
            assumptions: all.map(str::to_owned).collect(),
            ..Self::default()
        }
    }

    /// Returns the name of all marks.
    fn marked(&self) -> &'static str {
        match self.command.starts_with("limit") {
            true => "Hinges",
            false => "Cases",
        }
    }

    /// Returns true if blanks align the words.
    fn is_aligned(&self) -> bool {
        let mut lines = self.words.lines().map(str::trim);
        lines.any(|line| line.contains("   "))
    }

    /// Returns true if a command names record files.
    fn has_files(&self) -> bool {
        let mut texts = self.all.texts.iter();
        texts.any(|text| text.contains("\nfile = "))
    }
}

/// Returns a scenario whose ground accelerations are multiplied by a factor.
pub(super) fn under_factor(scenario: &Value, factor: f64) -> Value {
    fn multiply(table: &mut Value, factor: f64) {
        let Value::Object(table) = table else { return };
        if table.contains_key("file") && !table.contains_key("peak_g") {
            table.entry("scale").or_insert(json!(1.0));
        }
        for (key, value) in table {
            match (&**key, value.as_f64()) {
                ("amplitude_g" | "vertical_amplitude_g" | "scale" | "peak_g", Some(number)) => {
                    *value = json!(number * factor);
                }
                _ => multiply(value, factor),
            }
        }
    }
    let mut scenario = scenario.clone();
    multiply(&mut scenario["ground"], factor);
    scenario
}

/// Returns the input of a study in one line; without the model if there are several.
pub(super) fn input_in_words(scenarios: &[&Scenario]) -> String {
    let all = caption(scenarios[0], &[]);
    match all.rsplit_once("; ") {
        Some((others, _)) if scenarios.len() > 1 => others.to_owned(),
        _ => all,
    }
}

/// Draws a picture of a page.
pub(super) type DrawPicture<'a> = &'a dyn Fn(Figure) -> String;

impl Results {
    /// Adds the page, before all other files: with its cases, a picture of them, other pictures, and the words, warnings and tables of the results,
    /// the last table first.
    pub(super) fn with_page(
        mut self,
        name: &'static str,
        mut page: Page,
        cases: &PageCases,
        (picture, more): (DrawPicture<'_>, &[DrawPicture<'_>]),
    ) -> Self {
        let (summary, spots) = (&self.summary, &cases.spots);
        let warnings = summary["warnings"].as_array().into_iter().flatten();
        page.warnings
            .extend(warnings.flat_map(Value::as_str).map(str::to_owned));
        page.warnings
            .retain(|warning| !self.words.contains(warning));
        let tables = self
            .files
            .iter()
            .rev()
            .filter(|(name, _)| name.ends_with(".csv"));
        let most = [MOST_CASES].into_iter().chain(iter::repeat(MOST_ROWS));
        let tables = tables.zip(most);
        let tables = tables.map(|((name, contents), most)| table_of(name, contents, most));
        page.tables = tables.collect();
        let lines = self.words.lines();
        let lines = lines.map(|line| line.strip_prefix("  ").unwrap_or(line));
        if page.verdict.is_empty() {
            let first = lines.clone().next();
            let verdict = summary["to_quote"].as_str().or(first);
            page.verdict = verdict.unwrap_or_default().to_owned();
        }
        let words: Vec<&str> = lines.filter(|line| *line != page.verdict).collect();
        page.words = words.join("\n");
        let count = |kind| spots.iter().filter(|spot| spot.kind == kind).count();
        let counts = SpotKind::ALL.iter().map(|kind| (*kind, count(*kind)));
        page.legend = counts.filter(|(_, count)| *count > 0).collect();
        page.outside = spots.iter().filter(|spot| spot.outside).count();
        page.picture = [Figure::PAGE, Figure::PHONE].map(picture);
        page.more = more.iter().map(|draw| draw(Figure::PHONE)).collect();
        page.all = cases.clone();
        self.files.insert(0, (name, render(&page).into_bytes()));
        self.cases = Box::new(page.all);
        self
    }
}

/// Reads the first rows of a table, and rounds its numbers.
fn table_of(name: &str, contents: &[u8], most: usize) -> PageTable {
    let mut reader = csv::Reader::from_reader(contents);
    let header = reader.headers().cloned().unwrap_or_default();
    let rows: Vec<csv::StringRecord> = reader.records().flatten().collect();
    let rounded = |cell: &str| match cell.parse::<f64>() {
        Ok(number) => plain(number),
        Err(_) => cell.to_owned(),
    };
    PageTable {
        name: name.to_owned(),
        header: header.iter().map(str::to_owned).collect(),
        all: rows.len(),
        rows: rows
            .iter()
            .take(most)
            .map(|row| row.iter().map(rounded).collect())
            .collect(),
    }
}
