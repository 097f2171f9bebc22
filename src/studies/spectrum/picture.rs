//! The picture of an overturning spectrum.

use nalgebra::Vector2;

use super::{OverturningSpectrum, PointRow, StructureKind};
use crate::output::svg::{Axes, Drawing, Figure, Key, Scale, Sign, Stroke, color};

/// How a structure is drawn.
struct Look {
    name: &'static str,
    line: Stroke,
    point: Stroke,
}

const ARCH: Look = Look {
    name: "arch",
    line: Stroke::new(color::BLUE, 1.8, ""),
    point: Stroke::new(color::BLUE, 1.4, ""),
};

const COLUMN: Look = Look {
    name: "column",
    line: Stroke::new(color::VERMILION, 1.8, "7 3"),
    point: Stroke::new(color::VERMILION, 1.4, ""),
};

const RADIUS_PX: f64 = 3.0;

/// Draws the spectrum: curves for overturning without impact, and points for weaker pulses that overturn after
/// impacts.
#[must_use]
pub fn draw(
    figure: Figure,
    title: &str,
    spectrum: &OverturningSpectrum<'_>,
    rows: &[PointRow],
) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(title);
    let size = spectrum.sizes().len();
    let beside_arch = spectrum.structures().len() > 1;
    let structures: Vec<(&Look, &[PointRow], String)> = spectrum
        .structures()
        .iter()
        .zip(rows.chunks(size))
        .map(|((kind, _), rows)| {
            let look = match kind {
                StructureKind::Arch => &ARCH,
                StructureKind::Column => &COLUMN,
            };
            let called = match kind {
                StructureKind::Column if beside_arch => "equivalent column",
                _ => kind.name(),
            };
            (look, rows, called.to_owned())
        })
        .collect();
    let texts: Vec<(String, Sign)> = structures
        .iter()
        .flat_map(|(look, rows, called)| {
            let edge = rows
                .iter()
                .any(|row| row.no_impact_over_incipient.is_some());
            let less = rows.iter().any(|row| row.minimum_after_impacts().is_some());
            let edge = edge.then(|| (format!("{called}, without impact"), Sign::Line(look.line)));
            let less = less.then(|| {
                let text = format!("{called}, less after impacts (of those tried)");
                (text, Sign::Circle(RADIUS_PX, look.point))
            });
            edge.into_iter().chain(less)
        })
        .collect();
    let keys: Vec<Key<'_>> = texts
        .iter()
        .map(|(text, sign)| (text.as_str(), *sign))
        .collect();
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let axes = Axes {
        frame: figure.plot(top, figure.height_px(500.0)),
        x: scale(spectrum.sizes()),
        y: scale(&heights(spectrum, rows)),
    };
    axes.draw(
        &mut drawing,
        Some("size p t_p"),
        "peak acceleration / (g A_L)",
    );
    for (look, rows, _) in &structures {
        drawing.within(&axes.frame, |drawing| curves(drawing, &axes, look, rows));
    }
    // Circles at the edge of the frame are drawn whole.
    for (look, rows, _) in &structures {
        for row in *rows {
            let least = row.minimum_after_impacts();
            if let Some(least) = least.filter(|least| *least <= axes.y.high * (1.0 + 1e-9)) {
                let name = format!("{} least", look.name);
                drawing.circle(&name, axes.place(row.p_t, least), RADIUS_PX, look.point);
            }
        }
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

/// Peak accelerations to be drawn, ascending: from the least tried to the largest result. Results are cut off at the
/// largest acceleration tried, or at one and a half times the least result if that is larger.
fn heights(spectrum: &OverturningSpectrum<'_>, rows: &[PointRow]) -> Vec<f64> {
    let tried = spectrum.over_incipient();
    let last = tried[tried.len() - 1];
    let results: Vec<f64> = rows
        .iter()
        .flat_map(|row| [row.no_impact_over_incipient, row.minimum_after_impacts()])
        .flatten()
        .collect();
    let least = results.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = last.max(1.5 * least);
    let mut heights: Vec<f64> = results
        .into_iter()
        .map(|height| height.min(highest))
        .chain([tried[0]])
        .collect();
    heights.sort_by(f64::total_cmp);
    heights
}

fn curves(drawing: &mut Drawing, axes: &Axes, look: &Look, rows: &[PointRow]) {
    let edge = |row: &PointRow| row.no_impact_over_incipient;
    // The curve is interrupted where there is no value.
    for run in rows.chunk_by(|a, b| edge(a).is_some() == edge(b).is_some()) {
        let places: Vec<_> = run
            .iter()
            .filter_map(|row| Some(axes.place(row.p_t, edge(row)?)))
            .collect();
        // A single point is drawn as a short line.
        let name = format!("{} no-impact", look.name);
        if let [only] = places[..] {
            let reach = Vector2::new(6.0, 0.0);
            drawing.curve(&name, [only - reach, only + reach], look.line);
        } else {
            drawing.curve(&name, places, look.line);
        }
    }
}

/// The logarithmic scale that holds ascending positive values; a single value gets a margin.
fn scale(values: &[f64]) -> Scale {
    let (low, high) = (values[0], values[values.len() - 1]);
    if high > 1.01 * low {
        Scale::logarithmic(low, high)
    } else {
        Scale::logarithmic(0.5 * low, 2.0 * high)
    }
}
