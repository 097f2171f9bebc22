//! The picture of the fragility under a suite of records.

use super::fragility::Fragility;
use super::{Counts, Heading, SuiteFragility, records_in_words};
use crate::output::{
    BELOW_PX, Chart, Figure, Key, LEFT_PX, Mark, Scale, Shape, Sheet, Sign, Stroke, color,
};
use crate::studies::statistics::ascending;

/// Draws fractions, curve and band, with the curve in words.
pub(super) fn draw(
    figure: Figure,
    heading: &Heading,
    results: &SuiteFragility,
    words: &str,
) -> String {
    let (x_label, x) = heading.axis(results, figure);
    let curves = curves(results);
    let mut marks: Vec<Mark> = Vec::new();
    for (fit, (name, _, line)) in &curves {
        let intensities = axis_values(&x, &curves).into_iter();
        let points = intensities.map(|x| (x, fit.probability(x)));
        marks.push(Mark::curve(*name, *line, points));
    }
    let circle = |name, at| Mark::new(name, POINT, Shape::Circle(at, 4.5));
    for level in &results.levels {
        let Some((fraction, [certain, possible])) = level.fraction().zip(level.fraction_ends())
        else {
            continue;
        };
        let [low, high] = [certain, possible].map(|part| (level.intensity, part));
        if possible > certain {
            marks.push(Mark::curve("uncertain", POINT, [low, high]));
        }
        marks.push(circle("fraction", (level.intensity, fraction)));
    }
    let mut sheet = Sheet::new(figure, heading.title());
    sheet.legend(LEFT_PX, keys(results, &curves));
    sheet.caption(14.0, words);
    sheet.gap(10.0);
    let y_axis = ("fraction that overturns", Scale::exactly(0.0, 1.0, 5));
    let chart = Chart {
        below: bands(&x, &curves),
        marks,
        ..Chart::new(405.0, (x_label, x), y_axis)
    };
    chart.add_plot(&mut sheet);
    sheet.gap(BELOW_PX);
    sheet.finish()
}

/// Name, label and line of a curve.
type CurveStyle = (&'static str, &'static str, Stroke);

/// The curve with uncertain cases counted by their fractions, then those with doubtful cases as survived and as overturned.
const STYLES: [CurveStyle; 3] = [
    ("fit", "lognormal curve", line("")),
    ("fit-certain", "uncertain cases survive", line("2 4")),
    (
        "fit-with-uncertain",
        "uncertain cases overturn",
        line("7 4"),
    ),
];

const fn line(dashes: &'static str) -> Stroke {
    Stroke::new(color::BLUE, 2.0, dashes)
}

/// Curves to draw.
fn curves(results: &SuiteFragility) -> Vec<(&Fragility, CurveStyle)> {
    let all = results.fits().zip(STYLES);
    all.filter_map(|(fit, style)| Some((fit.as_ref().ok()?, style)))
        .collect()
}

/// Legend.
fn keys(results: &SuiteFragility, curves: &[(&Fragility, CurveStyle)]) -> Vec<Key> {
    let cases = Counts::of(&results.cases.iter().collect::<Vec<_>>()).cases;
    let text = format!(
        "fraction of {}, {cases} cases",
        records_in_words(results.record_count())
    );
    let mut keys = vec![Key::new(text, Sign::Circle(4.5, POINT))];
    let lines = curves
        .iter()
        .map(|(_, (_, label, line))| Key::line(*label, *line));
    keys.extend(lines);
    if curves.len() > 1 {
        keys.push(Key::new("between these", Sign::Band(BETWEEN, 1.0)));
    }
    if !curves.is_empty() {
        keys.push(Key::new("95 % band", Sign::Band(BAND, 1.0)));
    }
    keys
}

const POINT: Stroke = Stroke::new(color::VERMILION, 1.8, "");
const BAND: &str = "#d6e8f4";
const BETWEEN: &str = "#9cc7e3";

/// Number of points along the axis, and of points along the rise of each curve.
const POINTS: u32 = 200;
/// Half width of the rise of a curve around its median, in dispersions.
const RISES: f64 = 4.0;

/// Positive values along an axis: evenly spaced ones, and closer ones where a curve rises.
fn axis_values(scale: &Scale, curves: &[(&Fragility, CurveStyle)]) -> Vec<f64> {
    let parts = (0..=POINTS).map(|i| f64::from(i) / f64::from(POINTS));
    let even = parts.clone().map(|part| scale.at(part));
    let rising = curves.iter().flat_map(|(fit, _)| {
        parts
            .clone()
            .map(|part| fit.median * libm::exp(fit.dispersion * RISES * (2.0 * part - 1.0)))
    });
    let values = even.chain(rising);
    ascending(values.filter(|x| *x > 0.0 && (scale.low..=scale.high).contains(x)))
}

/// Draws the joint 95 % band of the curves, and the area between the curves.
fn bands(x: &Scale, curves: &[(&Fragility, CurveStyle)]) -> Vec<Mark> {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([1.0, 0.0], |[low, high]: [f64; 2], value| {
            [low.min(value), high.max(value)]
        })
    };
    let area = |name, color, ends: &dyn Fn(f64) -> [f64; 2]| {
        let xs = axis_values(x, curves);
        let [low, high] = [0, 1].map(|end: usize| xs.iter().map(move |x| (*x, ends(*x)[end])));
        Mark::between(name, color, low, high)
    };
    let band = |x: f64| {
        let bands = curves.iter();
        range(&mut bands.flat_map(|(fit, _)| <[f64; 2]>::from(fit.band(x))))
    };
    let between = |x: f64| range(&mut curves.iter().map(|(fit, _)| fit.probability(x)));
    match curves.len() {
        0 => Vec::new(),
        1 => vec![area("band", BAND, &band)],
        _ => vec![
            area("band", BAND, &band),
            area("between", BETWEEN, &between),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragility::{Observation, fit};
    use super::*;
    use crate::output::{Axes, Frame};

    /// However steep a curve is, it turns by a few degrees at most from one piece to the next on the sheet.
    #[test]
    fn steep_curves_have_no_kinks() {
        let case = |intensity, overturned: bool, record| Observation {
            intensity,
            overturned: f64::from(overturned),
            record,
        };
        let near = [0.99, 1.0, 1.01];
        let cases = near
            .into_iter()
            .zip([1, 5, 9])
            .flat_map(|(intensity, falls)| {
                (0..10).map(move |record| case(intensity, record < falls, record))
            });
        let fit = fit(&cases.collect::<Vec<_>>()).unwrap();
        assert!(fit.dispersion < 0.02, "{}", fit.dispersion);
        for x in [Scale::exactly(0.0, 3.0, 8), Scale::logarithmic(0.1, 10.0)] {
            let frame = Frame {
                height: 405.0,
                ..Frame::default()
            };
            let axes = Axes {
                frame: Figure::SCREEN.right_of(LEFT_PX, frame),
                x,
                y: Scale::exactly(0.0, 1.0, 5),
            };
            let curves = STYLES.map(|style| (&fit, style));
            let points: Vec<_> = axis_values(&x, &curves)
                .into_iter()
                .map(|x| axes.place(x, fit.probability(x)))
                .collect();
            let pieces: Vec<_> = points.windows(2).map(|ends| ends[1] - ends[0]).collect();
            let turns = pieces
                .windows(2)
                .map(|pair| pair[0].perp(&pair[1]).atan2(pair[0].dot(&pair[1])).abs());
            let sharpest = turns.fold(0.0, f64::max);
            assert!(sharpest.to_degrees() < 8.0, "{sharpest}");
        }
    }
}
