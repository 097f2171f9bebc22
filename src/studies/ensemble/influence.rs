//! The influence of each uncertain number on an answer: JSON, words and bars.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::sensitivity::Sensitivity;
use crate::output::{
    Anchor, Axes, Drawing, Figure, Frame, LEFT_PX, PartHeight, Scale, Sheet, Stroke, color,
};

/// An answer that uncertain numbers influence.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum InfluencedAnswer {
    Overturning,
    PeakRotationRank,
    FirstFactor,
    MedianIntensity,
    PartThatOverturns,
}

impl InfluencedAnswer {
    /// Words that follow "explains 60 % of the variance of".
    const fn in_words(self) -> &'static str {
        match self {
            Self::Overturning => "the outcome",
            Self::PeakRotationRank => "the largest rotation",
            Self::FirstFactor => "the first factor that overturns",
            Self::MedianIntensity => "the median intensity that overturns",
            Self::PartThatOverturns => "the part of the map that overturns",
        }
    }
}

/// The influence of an uncertain number on an answer.
#[derive(Serialize, Deserialize)]
pub(super) struct NumberInfluence {
    /// Key of the number.
    pub(super) key: String,
    #[serde(flatten)]
    pub(super) sensitivity: Sensitivity,
}

/// The influences on each answer, in the order of the keys; `None` if the samples do not differ or are too few.
#[derive(Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct Influences(pub(super) BTreeMap<InfluencedAnswer, Option<Vec<NumberInfluence>>>);

impl Influences {
    /// Influences on the first answer with known ones in words: `friction coefficient explains 60 % (95 %: 51 % to 67 %) of the variance of
    /// the first factor that overturns, thickness ratio 25 % (...)`. The rest is due to several numbers together, or, if the intervals allow that no rest is
    /// left, perhaps to chance.
    pub(super) fn in_words(&self) -> String {
        const LEAST: f64 = 0.05;
        let known = self.0.iter().find(|(_, numbers)| numbers.is_some());
        let Some((answer, numbers)) = known.or(self.0.last_key_value()) else {
            return String::new();
        };
        let answer = answer.in_words();
        let Some(numbers) = numbers else {
            return format!(
                "no influence on {answer} is known: the samples do not differ, or are too few"
            );
        };
        if let [only] = &numbers[..] {
            return format!(
                "{} alone explains the variance of {answer}",
                only.key_in_words(numbers)
            );
        }
        let mut sorted: Vec<&NumberInfluence> = numbers.iter().collect();
        sorted.sort_by(|a, b| {
            b.sensitivity
                .first_order
                .total_cmp(&a.sensitivity.first_order)
        });
        sorted.retain(|number| number.sensitivity.first_order >= LEAST);
        let share = |number: &NumberInfluence| {
            let Sensitivity {
                first_order,
                first_order_interval: [low, high],
                ..
            } = number.sensitivity;
            let [share, low, high] = [first_order, low, high].map(percent);
            format!("{share} (95 %: {low} to {high})")
        };
        let Some((first, others)) = sorted.split_first() else {
            return format!(
                "no number alone explains the variance of {answer}: several together do, or chance"
            );
        };
        let (name, share_of_first) = (first.key_in_words(numbers), share(first));
        let mut words = format!("{name} explains {share_of_first} of the variance of {answer}");
        for other in others {
            words += &format!(", {} {}", other.key_in_words(numbers), share(other));
        }
        let all = numbers.iter().map(|number| &number.sensitivity);
        let known: f64 = all.clone().map(|one| one.first_order).sum();
        let at_most: f64 = all.map(|one| one.first_order_interval[1]).sum();
        if known < 1.0 - LEAST {
            let chance = if at_most < 1.0 { "" } else { ", or to chance" };
            let left = percent(1.0 - known);
            words += &format!("; {left} is due to several together{chance}");
        }
        words
    }

    /// Index of the number with the largest influence on the first answer with known influences.
    pub(super) fn find_strongest(&self) -> Option<usize> {
        let shares = self
            .0
            .values()
            .flatten()
            .next()?
            .iter()
            .map(|number| number.sensitivity.first_order);
        let strongest = shares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        strongest.map(|(index, _)| index)
    }

    /// Draws the influence of each number on each answer: a bar with its interval.
    pub(super) fn draw(&self, figure: Figure, title: &str) -> String {
        let mut sheet = Sheet::new(figure, title);
        sheet.gap(10.0);
        for (answer, numbers) in &self.0 {
            let answer = answer.in_words();
            let Some(numbers) = numbers else {
                let nothing =
                    format!("no indices for {answer}: the samples do not differ, or are too few");
                sheet.caption(14.0, &nothing);
                sheet.gap(6.0);
                continue;
            };
            let caption =
                format!("first-order index for {answer}, 95 % interval; r: rank correlation");
            sheet.caption(14.0, &caption);
            sheet.gap(6.0);
            let height = PartHeight::Fixed(ROW_PX * numbers.len() as f64);
            sheet.part(height, move |drawing, part| {
                let axes = Axes {
                    frame: figure.right_of(LEFT_PX, part),
                    x: Scale::exactly(0.0, 1.0, 5),
                    y: Scale::exactly(0.0, 1.0, 1),
                };
                for (share, text) in axes.x.ticks() {
                    let [above, below] = [1.0, 0.0].map(|y| axes.place(share, y));
                    drawing.line(above, below, Stroke::new(color::GREY, 0.6, ""));
                    drawing.label(below + Vector2::new(0.0, 17.0), Anchor::Middle, 0.0, text);
                }
                let mut row = axes.frame.top;
                for number in numbers {
                    bar(drawing, &axes, row, (&number.key_in_words(numbers), number));
                    row += ROW_PX;
                }
            });
            sheet.gap(34.0);
        }
        sheet.gap(12.0);
        sheet.finish()
    }
}

impl NumberInfluence {
    /// Key in words: `thickness ratio` for `arch.thickness_ratio`; the key itself if another key has the same last part.
    fn key_in_words(&self, all: &[Self]) -> String {
        const UNITS: [&str; 12] = [
            "_m_s2", "_kg_m3", "_gpa_m", "_mpa", "_gpa", "_rad", "_deg", "_hz", "_kn", "_m", "_s",
            "_g",
        ];
        let last = |key: &str| -> String {
            let last = key.rsplit('.').next().unwrap_or(key).trim();
            let unit = UNITS.iter().find_map(|unit| last.strip_suffix(unit));
            unit.unwrap_or(last).replace('_', " ")
        };
        let own = last(&self.key);
        let is_shared = all.iter().filter(|other| last(&other.key) == own).count() > 1;
        if is_shared { self.key.clone() } else { own }
    }
}

/// Share in percent, with one decimal near 0 and near 100 %.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals =
        usize::from(percent > 0.0 && percent < 9.95 || percent > 90.05 && percent < 100.0);
    format!("{percent:.decimals$} %")
}

/// Height of the text and the bar of an uncertain number.
const ROW_PX: f64 = 42.0;
const BAR_PX: f64 = 14.0;
const INTERVAL: Stroke = Stroke::new(color::BLACK, 1.4, "");

/// Draws text and bar of an uncertain number, below `top`.
fn bar(drawing: &mut Drawing, axes: &Axes, top: f64, (name, number): (&str, &NumberInfluence)) {
    let (left, sensitivity) = (axes.frame.left, &number.sensitivity);
    let at = |share: f64| axes.place(share, 0.0).x;
    let total = sensitivity.total.map_or(String::new(), |total| {
        format!(", {:.2} in all", total.total)
    });
    let text = format!(
        "{name}: {:.2}{total} (r {:+.2})",
        sensitivity.first_order, sensitivity.rank_correlation
    );
    let place = Vector2::new(left + 4.0, top + 15.0);
    drawing.label(place, Anchor::Start, 0.0, text);
    let bar = |share: f64| Frame {
        left,
        top: top + 20.0,
        width: at(share) - left,
        height: BAR_PX,
    };
    if let Some(total) = sensitivity.total {
        drawing.band("total", &bar(total.total), color::BLUE, 0.2);
    }
    drawing.band(&number.key, &bar(sensitivity.first_order), color::BLUE, 0.6);
    let middle = top + 20.0 + 0.5 * BAR_PX;
    let ends = sensitivity
        .first_order_interval
        .map(|share| Vector2::new(at(share), middle));
    drawing.curve("interval", ends, INTERVAL);
}
