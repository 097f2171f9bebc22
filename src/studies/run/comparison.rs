//! Comparison of several models of motion of one structure: the result of each, the most reliable one, and the differences of the others.

use askama::Template;

use super::summary::{FourLinkQuality, RunSummary};
use super::{ModelResults, REPORT, Run};
use crate::Verdict;
use crate::dynamics::OutcomeKind;
use crate::output::filters;
use crate::scenario::ModelKind;
use crate::studies::Results;
use crate::studies::comparison::Comparison;
use crate::studies::page::{CaseScenario, Page, PageCases, input_in_words, kind_of};

/// The outcome of a run, with its time.
#[derive(Template)]
#[template(path = "studies/run/words/outcome.txt")]
struct OutcomeCell<'a> {
    summary: &'a RunSummary,
}

impl Comparison<RunSummary> {
    /// Rows of the table, and the widths of its first two columns.
    pub(super) fn table(&self) -> (Vec<(&RunSummary, String)>, [usize; 2]) {
        let rows: Vec<_> = self
            .models()
            .map(|summary| (summary, OutcomeCell { summary }.to_string()))
            .collect();
        let widths = rows
            .iter()
            .map(|(summary, ends)| [summary.label().len(), ends.len()]);
        let header = ["model", "what happened"].map(str::len);
        let wide = widths.fold(header, |[a, b], [c, d]| [a.max(c), b.max(d)]);
        (rows, wide)
    }

    /// Pairs of the most reliable model and another one. Pairs without a verdict, and pairs in which nothing moves, are left out.
    pub(super) fn pairs(&self) -> Vec<[&RunSummary; 2]> {
        let best = self.models().max_by_key(|one| one.model.rank());
        let pairs = best.into_iter().flat_map(|best| {
            let others = self.models().filter(move |other| other.model != best.model);
            others.map(move |other| [best, other])
        });
        let differs = |[best, other]: &[&RunSummary; 2]| {
            let are_known = [best, other]
                .iter()
                .all(|one| one.verdict != Verdict::Incomplete);
            let both_survive = [best, other]
                .iter()
                .all(|one| one.verdict == Verdict::Survives);
            are_known && !(both_survive && best.worse_direction().largest_peak_rotation_rad == 0.0)
        };
        pairs.filter(differs).collect()
    }
}

/// Adds the page that compares several models of motion.
pub(super) fn with_page(results: Results, runs: &[Run<'_>], all: &[ModelResults]) -> Results {
    let mut cases = PageCases::default();
    for (run, one) in runs.iter().zip(all) {
        let kind = kind_of(Some(one.summary.verdict));
        let outside = one.summary.four_links() == Some(FourLinkQuality::Outside);
        let (label, verdict) = (run.scenario.motion.kind.label, one.summary.verdict_line());
        let words = format!("{label}: {}", verdict.trim());
        let text = cases.add_text(&run.scenario.to_json(), false);
        let scenario = || Some(CaseScenario::unchanged(text));
        cases.push((kind, outside), words, scenario);
    }
    let kinds: Vec<&ModelKind> = runs.iter().map(|run| run.scenario.motion.kind).collect();
    let scenario = runs[0].scenario;
    let own = "all models move the same structure under the same ground motion; the folder of each model has its own page";
    let title = scenario.title.as_deref().unwrap_or("Comparison of models");
    let what = input_in_words(&runs.iter().map(|run| run.scenario).collect::<Vec<_>>());
    let draw = |figure| super::overlay(figure, runs, all, &cases.spots);
    let page = Page::new(title, what, &[own], &kinds);
    results.with_page(REPORT, page, &cases, (&draw, &[]))
}

impl RunSummary {
    /// Name of its model in sentences.
    pub(super) fn label(&self) -> &'static str {
        self.model.label
    }
}
