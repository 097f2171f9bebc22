//! The picture of the fragility under a suite of records.

use super::fragility::Fragility;
use super::told::{CurveInWords, Heading, curves_in_words, records_in_words};
use super::{FragilityRow, SuiteFragility};
use crate::output::svg::{Axes, Drawing, Figure, Scale, Sign, Stroke, color};
use crate::scenario::{Measure, Spacing};

/// Draws fractions, curve and band.
#[must_use]
pub fn draw(figure: Figure, heading: &Heading, results: &SuiteFragility) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(heading.title());
    let top = legend(&mut drawing, figure, top, results);
    let axes = Axes {
        frame: figure.plot(top, figure.height_px(405.0)),
        x: intensity_scale(heading, &results.levels, figure),
        y: Scale::exactly(0.0, 1.0, 5),
    };
    let curves = curves(results);
    draw_bands(&mut drawing, &axes, &curves);
    let label = intensity_label(results.measure);
    axes.draw(&mut drawing, Some(label), "fraction that overturns");
    for (fit, look) in &curves {
        let intensities = along(&axes.x, &curves).into_iter();
        let curve = intensities.map(|x| axes.place(x, fit.probability(x)));
        drawing.curve(look.name, curve, look.line);
    }
    for level in &results.levels {
        let fractions = level.fraction().zip(level.fraction_with_uncertain());
        let Some((certain, possible)) = fractions else {
            continue;
        };
        let [low, high] = [certain, possible].map(|part| axes.place(level.intensity, part));
        if possible > certain {
            drawing.curve("uncertain", [low, high], POINT);
            drawing.circle("fraction-with-uncertain", high, 4.5, POINT);
        }
        drawing.circle("fraction", low, 4.5, POINT);
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

/// The look of a curve.
struct Look {
    name: &'static str,
    label: &'static str,
    line: Stroke,
}

const CURVE: Look = Look {
    name: "fit",
    label: "lognormal curve",
    line: Stroke::new(color::BLUE, 2.0, ""),
};
const CURVE_WITH_UNCERTAIN: Look = Look {
    name: "fit-with-uncertain",
    label: "the same with uncertain cases as overturned",
    line: Stroke::new(color::BLUE, 2.0, "7 4"),
};

/// The curves to draw: with uncertain cases counted as survived, and, if there are any, also as overturned.
fn curves(results: &SuiteFragility) -> Vec<(&Fragility, Look)> {
    let with_uncertain = (&results.fit_with_uncertain, CURVE_WITH_UNCERTAIN);
    let with_uncertain = results.has_uncertain().then_some(with_uncertain);
    [(&results.fit, CURVE)]
        .into_iter()
        .chain(with_uncertain)
        .filter_map(|(fit, look)| Some((fit.as_ref().ok()?, look)))
        .collect()
}

/// The measure of the intensities, in words.
pub(super) const fn intensity_label(measure: Measure) -> &'static str {
    match measure {
        Measure::Scale => "scale factor",
        Measure::PeakG => "peak ground acceleration (g)",
    }
}

/// The scale from a little below the lowest level to a little above the highest.
pub(super) fn intensity_scale(heading: &Heading, levels: &[FragilityRow], figure: Figure) -> Scale {
    let ends = [levels.first(), levels.last()];
    let [low, high] = ends.map(|level| level.map_or(1.0, |level| level.intensity));
    match heading.spacing {
        Spacing::Logarithmic => {
            let margin = (high / low).powf(0.05);
            Scale::logarithmic(low / margin, high * margin)
        }
        Spacing::Linear => Scale::exactly(0.0, 1.05 * high, figure.ticks(8)),
    }
}

/// Draws the legend, with the curves in words or the reason why there are none; returns the position of its lower end.
fn legend(drawing: &mut Drawing, figure: Figure, top: f64, results: &SuiteFragility) -> f64 {
    let cases: usize = results.levels.iter().map(|level| level.cases).sum();
    let text = format!("fraction of {}, {cases} cases", records_in_words(results));
    let mut keys = vec![(text.as_str(), Sign::Circle(4.5, POINT))];
    let curves = curves(results);
    let lines = curves.iter();
    keys.extend(lines.map(|(_, look)| (look.label, Sign::Line(look.line))));
    if curves.len() > 1 {
        keys.push(("between these", Sign::Band(BETWEEN, 1.0)));
    }
    if !curves.is_empty() {
        keys.push(("95 % band", Sign::Band(BAND, 1.0)));
    }
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys);
    let words = curves_in_words(results).into_iter();
    let words = words.map(|CurveInWords { taken, curve }| match curve {
        Ok(curve) => format!("{curve}{taken}"),
        Err(reason) => format!("no curve: {reason}{taken}"),
    });
    let words: Vec<String> = words.collect();
    drawing.caption(top + 14.0, &words.join("; ")) + 10.0
}

const POINT: Stroke = Stroke::new(color::VERMILION, 1.8, "");
const BAND: &str = "#d6e8f4";
const BETWEEN: &str = "#9cc7e3";

/// Number of points along the axis, and of those where a curve rises.
const POINTS: u32 = 200;
/// A curve rises within so many dispersions of its median.
const RISES: f64 = 4.0;

/// Positive values along an axis: evenly, and closer together where a curve rises, however steep it is.
fn along(scale: &Scale, curves: &[(&Fragility, Look)]) -> Vec<f64> {
    let parts = (0..=POINTS).map(|i| f64::from(i) / f64::from(POINTS));
    let even = parts.clone().map(|part| scale.at(part));
    let rising = curves.iter().flat_map(|(fit, _)| {
        parts
            .clone()
            .map(|part| fit.median * (fit.dispersion * RISES * (2.0 * part - 1.0)).exp())
    });
    let mut values: Vec<f64> = even.chain(rising).collect();
    values.retain(|x| *x > 0.0 && (scale.low..=scale.high).contains(x));
    values.sort_by(f64::total_cmp);
    values
}

/// Draws the joint 95 % band of the curves, and the area between them.
fn draw_bands(drawing: &mut Drawing, axes: &Axes, curves: &[(&Fragility, Look)]) {
    let mut fill = |name: &str, color: &'static str, ends: &dyn Fn(f64) -> [f64; 2]| {
        let (low, mut high): (Vec<_>, Vec<_>) = along(&axes.x, curves)
            .into_iter()
            .map(|x| {
                let [low, high] = ends(x).map(|probability| axes.place(x, probability));
                (low, high)
            })
            .unzip();
        high.reverse();
        let corners = low.into_iter().chain(high);
        drawing.polygon(name, corners, color, Stroke::new(color, 0.0, ""));
    };
    if curves.is_empty() {
        return;
    }
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([1.0, 0.0], |[low, high]: [f64; 2], value| {
            [low.min(value), high.max(value)]
        })
    };
    fill("band", BAND, &|x| {
        let bands = curves.iter();
        range(&mut bands.flat_map(|(fit, _)| <[f64; 2]>::from(fit.band(x))))
    });
    if curves.len() > 1 {
        fill("between", BETWEEN, &|x| {
            range(&mut curves.iter().map(|(fit, _)| fit.probability(x)))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragility::{Observation, fit};
    use super::*;

    /// However steep a curve is, it turns by a few degrees at most from one piece to the next on the sheet.
    #[test]
    fn steep_curves_have_no_kinks() {
        let case = |intensity, overturned, record| Observation {
            intensity,
            overturned,
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
            let axes = Axes {
                frame: Figure::SCREEN.plot(0.0, 405.0),
                x,
                y: Scale::exactly(0.0, 1.0, 5),
            };
            let curves = [(&fit, CURVE)];
            let points: Vec<_> = along(&x, &curves)
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
