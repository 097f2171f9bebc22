//! The page of a study, beside its other results: verdict, pictures with all cases and their commands, words, assumptions and tables.
//!
//! A study provides its pictures, its cases in the order of its first table, and its assumptions. Verdict, words, warnings and tables are those of
//! its report, so the page has no number of its own.

use askama::Template;
use serde::{Deserialize, Serialize};

use super::Results;
pub(super) use super::page_cases::{CaseScenario, PageCases, kind_of, text_without_studies};
use super::page_table::PageTable;
use crate::output::caption::{caption, caption_without_model};
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
    /// The answer that may be quoted; the verdict if the study quotes none.
    verdict: String,
    /// The input of the study in one line.
    what: String,
    warnings: Vec<String>,
    /// The marks of the picture.
    pub(super) marked: Marked,
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
    /// True if blanks align the words.
    is_aligned: bool,
    tables: Vec<PageTable>,
}

/// The marks of the picture of a page.
#[derive(Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Marked {
    /// The cases of a study.
    #[default]
    Cases,
    /// The hinges of a mechanism.
    Hinges,
}

impl Marked {
    /// Returns the name of all marks.
    const fn name(self) -> &'static str {
        match self {
            Self::Cases => "Cases",
            Self::Hinges => "Hinges",
        }
    }
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
        Self {
            title: title.to_owned(),
            what,
            command: "run - --out case".to_owned(),
            assumptions: assumptions(own, models),
            ..Self::default()
        }
    }
}

/// Returns the assumptions of a study itself, of its models, and of all models.
pub(super) fn assumptions(own: &[&str], models: &[&ModelKind]) -> Vec<String> {
    const ALL: &str = "blocks are rigid and move in one plane, without tension in the joints, on springings or a base that move with the \
                       ground; not considered: motion in three dimensions, the soil, and the thrust of a fill";
    let models = models.iter().map(|model| model.assumptions);
    let all = own.iter().copied().chain(models).chain([ALL]);
    all.map(str::to_owned).collect()
}

/// Returns the input of a study in one line; without the model if there are several.
pub(super) fn input_in_words(scenarios: &[&Scenario]) -> String {
    match scenarios {
        [one] => caption(one, &[]),
        _ => caption_without_model(scenarios[0], &[]),
    }
}

/// Draws a picture of a page.
pub(super) type DrawPicture<'a> = &'a dyn Fn(Figure) -> String;

impl Results {
    /// Adds the page of a study, with its cases, a picture of them, and other pictures.
    pub(super) fn with_page(
        mut self,
        name: &'static str,
        mut page: Page,
        cases: &PageCases,
        (picture, more): (DrawPicture<'_>, &[DrawPicture<'_>]),
    ) -> Self {
        let (said, spots) = (&self.statement, &cases.spots);
        page.warnings = said.warnings();
        page.is_aligned = said.is_table;
        let verdict = said.verdict.replace('\n', "; ");
        let details = said.details_outdented();
        page.words = match &said.quote {
            Some(_) if !said.is_table => format!("{}\n{details}", said.verdict),
            _ => details,
        };
        page.verdict = said.quote.clone().unwrap_or(verdict);
        page.tables = self.tables.clone();
        for other in page.tables.iter_mut().skip(1) {
            other.rows.truncate(MOST_ROWS);
        }
        let count = |kind| spots.iter().filter(|spot| spot.kind == kind).count();
        let counts = SpotKind::ALL.iter().map(|kind| (*kind, count(*kind)));
        page.legend = counts.filter(|(_, count)| *count > 0).collect();
        page.outside = spots.iter().filter(|spot| spot.outside).count();
        page.picture = [Figure::PAGE, Figure::PHONE].map(picture);
        page.more = more.iter().map(|draw| draw(Figure::PHONE)).collect();
        page.all = cases.clone();
        self.cases = Box::new(page.all.clone());
        self.with_file(name, render(&page))
    }
}
