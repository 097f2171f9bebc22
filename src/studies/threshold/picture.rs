//! The picture of thresholds of overturning.

use nalgebra::Vector2;

use super::digits::format_edge;
use super::survival::{Survival, survival_in_words};
use super::{EDGE_WIDTH, FactorSample, RangeEnd, Threshold};
use crate::output::page::Spot;
use crate::output::{
    Anchor, Axes, BELOW_PX, Chart, Drawing, Figure, Frame, Key, LEFT_PX, Mark, PartHeight, Scale,
    Sheet, Stroke, color,
};
use crate::studies::ending::Verdict;
use crate::studies::ending::columns::are_over_critical;
use crate::studies::outcome_colors::{self, OutcomeColor};

/// Height of the labels of edges above a strip.
const EDGE_LABELS: f64 = 58.0;
const STRIP: f64 = 28.0;
/// Distance between neighbouring labels.
const LABEL_ADVANCE: f64 = 15.0;

const CRITICAL: Stroke = Stroke::new(color::BLACK, 1.0, "6 4");
const EDGE: Stroke = Stroke::new(color::GREY, 0.8, "");
const HATCH: Stroke = Stroke::new("#ffffff", 1.2, "");
/// Smallest width of a band, in pixels.
const LEAST_PX: f64 = 1.5;
/// Distance between hatching lines along the strip, in pixels.
const HATCH_PX: f64 = 6.0;

/// Draws the outcome against the factor: a strip for each model with the edges of its bands, and the largest rotation below. `peak_g` is the
/// peak ground acceleration at factor 1.
pub fn draw(figure: Figure, title: &str, peak_g: f64, thresholds: &[Threshold]) -> String {
    draw_marked(figure, title, peak_g, thresholds, &[])
}

/// Draws the same picture with marks for the histories of all models, in their order, on a page.
pub(super) fn draw_marked(
    figure: Figure,
    title: &str,
    peak_g: f64,
    thresholds: &[Threshold],
    spots: &[Spot],
) -> String {
    let thresholds: Vec<&Threshold> = thresholds.iter().flat_map(Threshold::directions).collect();
    let samples = thresholds.iter().flat_map(|threshold| &threshold.samples);
    let results = samples.clone().map(|sample| &sample.result);
    let kinds: Vec<OutcomeColor> = results.clone().map(OutcomeColor::of_result).collect();
    let names: Vec<String> = thresholds.iter().map(|one| one.name_in_words()).collect();
    let over_critical = are_over_critical(results);
    let peak = |sample: &FactorSample| sample.peak(over_critical);
    let (least, y_label) = match over_critical {
        true => (1.0, "peak rotation / critical rotation"),
        false => (0.01, "peak rotation (rad)"),
    };
    let mut keys = outcome_colors::keys(&OutcomeColor::ALL, &kinds);
    if over_critical {
        keys.push(Key::line("unstable equilibrium", CRITICAL));
    }
    if names.len() > 1 {
        let named = names.iter().zip(curves());
        keys.extend(named.map(|(name, stroke)| Key::line(name, stroke)));
    }
    let [first, last] = find_range(samples.map(|sample| sample.factor));
    let x = match last < 2.0 * first {
        true => Scale::exactly(first, last, figure.ticks(8)),
        false => Scale::logarithmic(first, last),
    };
    let y = scale(&thresholds, least, peak);
    let mut sheet = Sheet::new(figure, title);
    // A page has these words beside the picture.
    for (&threshold, name) in thresholds.iter().zip(&names).filter(|_| spots.is_empty()) {
        let words = survival_in_words(&Survival::of_threshold(threshold), "", Some(peak_g));
        sheet.caption(16.0, &format!("{name}: {words}"));
    }
    sheet.legend(LEFT_PX, keys);
    let (mut spots, mut on_curves) = (spots.iter(), Vec::new());
    for (&threshold, name) in thresholds.iter().zip(&names) {
        // Histories without a peak are marked on the strip.
        let mut on_strip = Vec::new();
        for (sample, spot) in threshold.samples.iter().zip(&mut spots) {
            match peak(sample) {
                Some(peak) => on_curves.push(spot.mark((sample.factor, peak))),
                None => on_strip.push(spot.bar((sample.factor, 0.5), STRIP)),
            }
        }
        sheet.gap(EDGE_LABELS);
        sheet.part(PartHeight::Fixed(STRIP), move |drawing, part| {
            let (frame, y) = (figure.right_of(LEFT_PX, part), Scale::exactly(0.0, 1.0, 1));
            let axes = Axes { frame, x, y };
            strip(drawing, &axes, threshold);
            on_strip.iter().for_each(|mark| mark.draw(drawing, &axes));
            let at = Vector2::new(frame.left - 8.0, frame.top + 0.5 * STRIP + 4.5);
            drawing.label(at, Anchor::End, 0.0, name);
        });
    }
    sheet.gap(16.0);
    let ends = [first, last].map(|factor| (factor, 1.0));
    let critical = over_critical.then(|| Mark::curve("", CRITICAL, ends));
    let mut marks = Vec::from_iter(critical);
    for (&threshold, stroke) in thresholds.iter().zip(curves()) {
        let faint = Stroke::new(stroke.color, 0.5, "2 3");
        marks.extend(edges(threshold).map(|edge| Mark::upright("", faint, edge, y)));
        let points = threshold.samples.iter();
        let points = points.map(|sample| (sample.factor, peak(sample).unwrap_or(f64::NAN)));
        let name = format!("{} peak", threshold.name());
        marks.push(Mark::curve(name, stroke, points));
    }
    let peak_g = format_edge(peak_g);
    let label = format!("factor on the ground motion (factor 1 = {peak_g} g)");
    let chart = Chart {
        marks: [vec![Mark::clipped(marks)], on_curves].concat(),
        ..Chart::new(320.0, (&label, x), (y_label, y))
    };
    chart.add_plot(&mut sheet);
    sheet.gap(BELOW_PX);
    sheet.finish()
}

/// Smallest and the largest factor.
fn find_range(factors: impl Iterator<Item = f64>) -> [f64; 2] {
    factors.fold([f64::INFINITY, 0.0], |[first, last], factor| {
        [first.min(factor), last.max(factor)]
    })
}

impl FactorSample {
    /// Largest rotation, over the critical rotation or in radians; `None` if the history itself overturned.
    fn peak(&self, over_critical: bool) -> Option<f64> {
        let ending = self.result.as_ref().ok();
        let ending = ending.filter(|ending| !ending.overturned_itself())?;
        match over_critical {
            true => ending.peak_over_critical,
            false => Some(ending.peak_rotation_rad),
        }
    }
}

/// Strokes for the curves of the models, in colours that no outcome has.
fn curves() -> impl Iterator<Item = Stroke> {
    const CURVES: [Stroke; 3] = [
        Stroke::new(color::BLACK, 1.6, ""),
        Stroke::new("#0033a0", 1.6, "7 3"),
        Stroke::new("#6a3d9a", 1.8, "2 2"),
    ];
    CURVES.into_iter().cycle()
}

/// Scale up to the largest rotation of a history that did not overturn.
fn scale(
    thresholds: &[&Threshold],
    least: f64,
    peak: impl Fn(&FactorSample) -> Option<f64>,
) -> Scale {
    let samples = thresholds.iter().flat_map(|threshold| &threshold.samples);
    let largest = samples.filter_map(peak).fold(least, f64::max);
    Scale::exactly(0.0, 1.15 * largest, 6)
}

/// Edges of the bands and of the uncertain ranges, ascending.
fn edges(threshold: &Threshold) -> impl Iterator<Item = f64> {
    let mut last = f64::NAN;
    let ranges = threshold
        .ranges
        .iter()
        .filter(|range| range.verdict != Some(Verdict::Survives));
    let ends = ranges
        .flat_map(|at| [(at.from, at.from_end), (at.to, at.to_end)])
        .filter_map(|(factor, end)| (end == RangeEnd::Edge).then_some(factor));
    // One of the two factors that enclose the edge between a band and an uncertain range is enough.
    ends.filter(move |factor| {
        let anew = factor - last > 2.0 * EDGE_WIDTH * factor || last.is_nan();
        last = *factor;
        anew
    })
}

/// Largest number of labelled edges of a model: those of the lowest factors.
const LABELLED: usize = 8;

/// Draws the outcomes of a model along the factors, with the edges of its bands above.
fn strip(drawing: &mut Drawing, axes: &Axes, threshold: &Threshold) {
    let edges: Vec<f64> = edges(threshold).collect();
    // The border between two colours is the edge, or without an edge the geometric mean of the factors.
    let border = |below: &FactorSample, above: &FactorSample| {
        let mut edges = edges.iter().copied();
        let edge = edges
            .find(|edge| (below.factor..=above.factor).contains(edge))
            .filter(|_| below.verdict() != above.verdict());
        edge.unwrap_or((below.factor * above.factor).sqrt())
    };
    let Frame { top, height, .. } = axes.frame;
    let place = |factor: f64| axes.place(factor, axes.y.low).x;
    let mut from = axes.x.low;
    let mut bands = Vec::new();
    let samples = &threshold.samples;
    let runs: Vec<_> = samples
        .chunk_by(|a, b| OutcomeColor::of_result(&a.result) == OutcomeColor::of_result(&b.result))
        .collect();
    for (index, run) in runs.iter().enumerate() {
        let last = &run[run.len() - 1];
        let next = runs.get(index + 1);
        let to = next.map_or(axes.x.high, |next| border(last, &next[0]));
        // Widens narrow bands so that they remain visible.
        let (left, wide) = (place(from), place(to) - place(from));
        let frame = Frame {
            left: left + 0.5 * (wide - wide.max(LEAST_PX)),
            top,
            width: wide.max(LEAST_PX),
            height,
        };
        bands.push((
            wide,
            frame,
            OutcomeColor::of_result(&last.result),
            last.verdict(),
        ));
        from = to;
    }
    // Narrow bands are drawn last, over their neighbours.
    bands.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, frame, kind, verdict) in bands {
        let name = format!("{} {}", threshold.name(), kind.name);
        drawing.band(&name, &frame, kind.fill, 1.0);
        if verdict == Some(Verdict::Uncertain) {
            hatch(drawing, &frame);
        }
    }
    let Frame { left, width, .. } = axes.frame;
    drawing.outline(&axes.frame, Stroke::new(color::BLACK, 0.8, ""));
    let labelled = &edges[..edges.len().min(LABELLED)];
    let places: Vec<f64> = labelled.iter().map(|edge| place(*edge)).collect();
    let besides = spread(&places, left, left + width);
    for ((edge, at), beside) in labelled.iter().zip(&places).zip(besides) {
        let foot = Vector2::new(*at, top);
        let head = Vector2::new(beside, top - 14.0);
        drawing.line(foot, head, EDGE);
        let text = head + Vector2::new(4.5, -3.0);
        drawing.label(text, Anchor::Start, 90.0, format_edge(*edge));
    }
}

/// Hatches a part of a strip.
fn hatch(drawing: &mut Drawing, frame: &Frame) {
    let (right, bottom) = (frame.left + frame.width, frame.top + frame.height);
    drawing.within(frame, |drawing| {
        let mut foot = frame.left - frame.height;
        while foot < right {
            let from = Vector2::new(foot, bottom);
            let to = from + Vector2::new(frame.height, -frame.height);
            drawing.line(from, to, HATCH);
            foot += HATCH_PX;
        }
    });
}

/// Positions for labels near the given ascending positions, without overlaps between `left` and `right`; fewer if there is not enough
/// space.
fn spread(places: &[f64], left: f64, right: f64) -> Vec<f64> {
    let room = ((right - left) / LABEL_ADVANCE) as usize + 1;
    let mut least = left;
    let mut spread: Vec<f64> = Vec::new();
    for place in places.iter().take(room) {
        let place = place.max(least);
        least = place + LABEL_ADVANCE;
        spread.push(place);
    }
    let mut most = right;
    for place in spread.iter_mut().rev() {
        *place = place.min(most);
        most = *place - LABEL_ADVANCE;
    }
    spread
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_numbers_have_four_digits() {
        let texts = [0.0, 0.012_345, 0.5, 2.113_06, 12.5, 123.456, 98_765.0].map(format_edge);
        assert_eq!(
            texts,
            [
                "0.000", "0.01235", "0.5000", "2.113", "12.50", "123.5", "98765"
            ]
        );
    }

    #[test]
    fn labels_stand_side_by_side() {
        assert_eq!(spread(&[10.0, 50.0], 0.0, 60.0), [10.0, 50.0]);
        assert_eq!(spread(&[10.0, 11.0, 59.0], 0.0, 60.0), [10.0, 25.0, 59.0]);
        assert_eq!(spread(&[58.0, 59.0], 0.0, 60.0), [45.0, 60.0]);
        assert_eq!(spread(&[1.0, 2.0, 3.0], 0.0, 20.0), [1.0, 16.0]);
    }
}
