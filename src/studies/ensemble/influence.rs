//! The influence of each uncertain number on an answer: words, JSON and bars.

use nalgebra::Vector2;
use serde::Serialize;

use super::matters::{Matters, Total};
use crate::output::{
    Anchor, Axes, Drawing, Figure, Frame, LEFT_PX, PartHeight, Scale, Sheet, Stroke, color,
};
use crate::scenario::Uncertain;

/// The influence of the uncertain numbers on an answer.
pub struct Influence<'a> {
    /// Name of the answer in JSON.
    pub(super) name: &'static str,
    /// The answer in words that follow "decides 60 % of".
    answer: &'static str,
    /// The influence of each number, in the order of the keys; `None` if the samples do not differ or are too few.
    pub(super) numbers: Option<Vec<Number<'a>>>,
}

/// The influence of an uncertain number.
#[derive(Serialize)]
pub(super) struct Number<'a> {
    /// Key of the number.
    key: &'a str,
    #[serde(skip)]
    spoken: String,
    #[serde(flatten)]
    matters: Matters,
}

impl<'a> Influence<'a> {
    pub(super) fn new(
        [name, answer]: [&'static str; 2],
        uncertain: &'a Uncertain,
        mut matters: Option<Vec<Matters>>,
    ) -> Self {
        // A number without others has all of the influence.
        if let Some([only]) = matters.as_deref_mut() {
            (only.first_order, only.first_order_interval) = (1.0, [1.0; 2]);
            only.total = only.total.map(|_| Total {
                total: 1.0,
                total_interval: [1.0; 2],
            });
        }
        let number = |(key, matters): (&'a str, Matters)| Number {
            key,
            spoken: spoken(key, uncertain),
            matters,
        };
        let keys = uncertain.keys.iter().map(|key| &*key.key);
        Self {
            name,
            answer,
            numbers: matters.map(|matters| keys.zip(matters).map(number).collect()),
        }
    }

    /// Returns the influence in words: `friction coefficient decides 60 % (95 %: 51 % to 67 %) of the first factor that overturns, thickness
    /// ratio 25 % (...)`. The rest is due to several numbers together, or, if the intervals allow that no rest is left, perhaps to chance.
    pub(super) fn in_words(&self) -> String {
        const LEAST: f64 = 0.05;
        let answer = self.answer;
        let Some(numbers) = &self.numbers else {
            return format!(
                "no influence on {answer} is known: the samples do not differ, or are too few"
            );
        };
        if let [only] = &numbers[..] {
            return format!("{} alone decides {answer}", only.spoken);
        }
        let mut sorted: Vec<&Number<'_>> = numbers.iter().collect();
        sorted.sort_by(|a, b| b.matters.first_order.total_cmp(&a.matters.first_order));
        sorted.retain(|number| number.matters.first_order >= LEAST);
        let share = |Matters {
                         first_order,
                         first_order_interval: [low, high],
                         ..
                     }: &Matters| {
            let [share, low, high] = [*first_order, *low, *high].map(percent);
            format!("{share} (95 %: {low} to {high})")
        };
        let Some((first, others)) = sorted.split_first() else {
            return format!("no number alone decides {answer}: several together do, or chance");
        };
        let (name, first) = (&first.spoken, share(&first.matters));
        let mut words = format!("{name} decides {first} of {answer}");
        for other in others {
            words += &format!(", {} {}", other.spoken, share(&other.matters));
        }
        let all = numbers.iter().map(|number| &number.matters);
        let known: f64 = all.clone().map(|matters| matters.first_order).sum();
        let at_most: f64 = all.map(|matters| matters.first_order_interval[1]).sum();
        if known < 1.0 - LEAST {
            let chance = if at_most < 1.0 { "" } else { ", or by chance" };
            let left = percent(1.0 - known);
            words += &format!("; {left} is decided by several together{chance}");
        }
        words
    }
}

/// Returns a key in words: `thickness ratio` for `arch.thickness_ratio`; the key itself if another key has the same last part.
fn spoken(key: &str, uncertain: &Uncertain) -> String {
    const UNITS: [&str; 12] = [
        "_m_s2", "_kg_m3", "_gpa_m", "_mpa", "_gpa", "_rad", "_deg", "_hz", "_kn", "_m", "_s", "_g",
    ];
    let last = |key: &str| -> String {
        let last = key.rsplit('.').next().unwrap_or(key).trim();
        let unit = UNITS.iter().find_map(|unit| last.strip_suffix(unit));
        unit.unwrap_or(last).replace('_', " ")
    };
    let own = last(key);
    let keys = uncertain.keys.iter();
    let is_shared = keys.filter(|other| last(&other.key) == own).count() > 1;
    if is_shared { key.to_owned() } else { own }
}

/// Returns a share in percent, with one decimal near 0 and near 100 %.
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

/// Draws the influence of each number on each answer: a bar with its interval.
pub(super) fn draw(figure: Figure, title: &str, influences: &[Influence<'_>]) -> String {
    let mut sheet = Sheet::new(figure, title);
    sheet.gap(10.0);
    for Influence {
        answer, numbers, ..
    } in influences
    {
        let Some(numbers) = numbers else {
            let nothing =
                format!("no shares in {answer}: the samples do not differ, or are too few");
            sheet.caption(14.0, &nothing);
            sheet.gap(6.0);
            continue;
        };
        let caption =
            format!("share in {answer}, alone, with its 95 % interval; (r) rank correlation");
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
                bar(drawing, &axes, row, number);
                row += ROW_PX;
            }
        });
        sheet.gap(34.0);
    }
    sheet.gap(12.0);
    sheet.finish()
}

/// Draws text and bar of an uncertain number, below `top`.
fn bar(drawing: &mut Drawing, axes: &Axes, top: f64, number: &Number<'_>) {
    let (left, matters) = (axes.frame.left, &number.matters);
    let at = |share: f64| axes.place(share, 0.0).x;
    let total = matters.total.map_or(String::new(), |total| {
        format!(", {:.2} in all", total.total)
    });
    let text = format!(
        "{}: {:.2}{total} (r {:+.2})",
        number.spoken, matters.first_order, matters.rank_correlation
    );
    let place = Vector2::new(left + 4.0, top + 15.0);
    drawing.label(place, Anchor::Start, 0.0, text);
    let bar = |share: f64| Frame {
        left,
        top: top + 20.0,
        width: at(share) - left,
        height: BAR_PX,
    };
    if let Some(total) = matters.total {
        drawing.band("total", &bar(total.total), color::BLUE, 0.2);
    }
    drawing.band(number.key, &bar(matters.first_order), color::BLUE, 0.6);
    let middle = top + 20.0 + 0.5 * BAR_PX;
    let ends = matters.first_order_interval;
    let ends = ends.map(|share| Vector2::new(at(share), middle));
    drawing.curve("interval", ends, INTERVAL);
}
