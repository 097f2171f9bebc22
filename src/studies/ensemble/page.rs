//! The page of samples: an answer of each sample against its most influential number.

use super::report::SampleSummary;
use super::{NoAnswer, SampleRow, Samples};
use crate::argument::plain;
use crate::output::page::{Spot, SpotKind};
use crate::output::{Chart, Figure, Scale};
use crate::studies::Results;
use crate::studies::page::{CaseScenario, DrawPicture, Page, PageCases, input_in_words};

/// The answer of a sample on a page: its outcome, true if it is outside the model of four links, and the number on the y axis, `None` if it is beyond
/// the axis.
pub(super) type PageAnswer = (SpotKind, bool, Option<f64>);

/// The parts of a page of samples that depend on the question.
pub(super) struct SamplePage<'a, A> {
    pub(super) title: &'a str,
    /// Label of the y axis.
    pub(super) label: &'static str,
    /// The command of a sample, without `archrock` and its scenario.
    pub(super) command: String,
    /// True if that is a suite.
    pub(super) are_suites: bool,
    pub(super) answer: &'a dyn Fn(&A) -> PageAnswer,
    /// The picture of all samples.
    pub(super) picture: DrawPicture<'a>,
}

/// Name of the page.
pub(super) const SAMPLES: &str = "samples.html";

impl<A> SamplePage<'_, A> {
    /// Adds the page of the samples to their results.
    pub(super) fn add_to(
        &self,
        results: Results,
        samples: &Samples<'_, A>,
        all: &SampleSummary,
    ) -> Results {
        let scenario = samples.scenario;
        let mut cases = PageCases::default();
        let text = cases.add_text(&scenario.to_json(), self.are_suites);
        let keys = &samples.uncertain.keys;
        for (number, row) in samples.lines() {
            let case = match number {
                0 => "the scenario itself".to_owned(),
                number => format!("sample {number}"),
            };
            let label = self.label;
            let (kind, outside, words) = match self.page_answer(row) {
                Ok((kind, outside, number)) => {
                    let number = number.map_or("beyond the axis".to_owned(), plain);
                    let outcome = match kind {
                        SpotKind::Point => String::new(),
                        _ => format!("{}; ", kind.label()),
                    };
                    (kind, outside, format!("{outcome}{label} {number}"))
                }
                Err(why) => (SpotKind::Unknown, false, why.reason().to_owned()),
            };
            cases.push((kind, outside), format!("{case}: {words}"), || {
                let is_valid = !matches!(row.answer, Err(NoAnswer::Invalid(_)));
                let values = keys.iter().map(|key| &key.key).zip(&row.values);
                is_valid.then(|| CaseScenario::of(text, values))
            });
        }
        let key = all.what_matters.find_strongest().unwrap_or(0);
        let draw = |figure: Figure| self.draw(figure, samples, key, &cases.spots);
        let numbers = format!(
            "numbers are independent, and distributed as [uncertain] says; {}",
            all.not_considered
        );
        // The records of a suite replace the ground motion of the scenario.
        let what = match self.are_suites {
            true => input_in_words(&[&scenario.with_ground(None)]),
            false => input_in_words(&[scenario]),
        };
        let mut page = Page::new(self.title, what, &[&numbers], &[scenario.motion.kind]);
        page.command = self.command.clone();
        let influences = |figure| all.draw_influences(samples, figure);
        results.with_page(SAMPLES, page, &cases, (&draw, &[self.picture, &influences]))
    }

    fn page_answer<'r>(&self, row: &'r SampleRow<A>) -> Result<PageAnswer, &'r NoAnswer> {
        row.answer.as_ref().map(self.answer)
    }

    /// Draws the answers of all samples against the number with this index.
    fn draw(&self, figure: Figure, samples: &Samples<'_, A>, key: usize, spots: &[Spot]) -> String {
        let uncertain = &samples.uncertain.keys[key];
        let at = |(number, row): (usize, &SampleRow<A>)| match number {
            0 => uncertain.own,
            _ => row.values.get(key).copied(),
        };
        let numbers = samples
            .lines()
            .filter_map(|(_, row)| self.page_answer(row).ok()?.2);
        let y = Scale::around(numbers.chain([0.0]), 6);
        let x = Scale::around(samples.lines().filter_map(at), figure.ticks(8));
        let marks = samples.lines().zip(spots).map(|(line, spot)| {
            let y = match self.page_answer(line.1) {
                Ok((.., number)) => number.unwrap_or(y.high),
                Err(_) => y.low,
            };
            spot.mark((at(line).unwrap_or(x.low), y))
        });
        let chart = Chart {
            marks: marks.collect(),
            ..Chart::new(405.0, (&uncertain.key, x), (self.label, y))
        };
        chart.draw(figure, self.title)
    }
}
