//! Comparison of several models of motion of one structure: the result of each, the most reliable one, and the differences of the others.

use askama::Template;
use serde::{Deserialize, Serialize};

use super::summary::Summary;
use crate::Verdict;
use crate::dynamics::OutcomeKind;
use crate::output::{Named, filters};

/// The runs of one structure with several models of motion.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Comparison {
    /// The answer of the model with the fewest assumptions, in words.
    pub to_quote: Option<String>,
    /// The runs, by the name of the model.
    #[serde(flatten)]
    pub models: Named<Summary>,
}

/// The outcome of a run, with its time.
#[derive(Template)]
#[template(path = "studies/run/words/outcome.txt")]
struct OutcomeCell<'a> {
    summary: &'a Summary,
}

impl Comparison {
    /// Returns the runs, in the order in which they were computed.
    pub(super) fn summaries(&self) -> impl Iterator<Item = &Summary> {
        self.models.0.iter().map(|(_, summary)| summary)
    }

    /// Returns the rows of the table, and the widths of its first two columns.
    pub(super) fn table(&self) -> (Vec<(&Summary, String)>, [usize; 2]) {
        let rows = self
            .summaries()
            .map(|summary| (summary, OutcomeCell { summary }.to_string()));
        let rows: Vec<_> = rows.collect();
        let widths = rows
            .iter()
            .map(|(summary, ends)| [summary.label().len(), ends.len()]);
        let header = ["model", "what happened"].map(str::len);
        let wide = widths.fold(header, |[a, b], [c, d]| [a.max(c), b.max(d)]);
        (rows, wide)
    }

    /// Returns pairs of the most reliable model and another one. Pairs without a verdict, and pairs in which nothing moves, are left out.
    pub(super) fn pairs(&self) -> Vec<[&Summary; 2]> {
        let best = self.summaries().max_by_key(|one| one.model.rank());
        let pairs = best.into_iter().flat_map(|best| {
            let others = self
                .summaries()
                .filter(move |other| other.model != best.model);
            others.map(move |other| [best, other])
        });
        let differs = |[best, other]: &[&Summary; 2]| {
            let are_known = [best, other]
                .iter()
                .all(|one| one.verdict != Verdict::Incomplete);
            let both_survive = [best, other]
                .iter()
                .all(|one| one.verdict == Verdict::Survives);
            are_known && !(both_survive && best.largest_peak_rotation_rad == 0.0)
        };
        pairs.filter(differs).collect()
    }
}

impl Summary {
    /// Returns the name of its model in sentences.
    pub(super) fn label(&self) -> &'static str {
        self.model.label
    }
}
