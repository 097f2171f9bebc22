//! Pictures of ensembles.

use nalgebra::Vector2;

use super::Told;
use super::edges::ProbabilityAt;
use super::histories::{BandAt, Histories, Went};
use super::records::{Capacities, Capacity};
use super::told::{Decides, spoken};
use crate::output::panels::{Curve, MAIN, Panels, Subject, around, draw_curves};
use crate::output::svg::{Anchor, Axes, Drawing, Figure, Frame, Scale, Sign, Stroke, color};
use crate::studies::threshold::first_edge::FirstEdge;

const BAND: &str = "#cfe3f1";
const MEDIAN: Stroke = Stroke::new(color::BLUE, 1.6, "");
const NO_LINE: Stroke = Stroke::new(BAND, 0.0, "");
const OWN: Stroke = Stroke::new(color::BLACK, 1.4, "6 4");
const INTERVAL: Stroke = Stroke::new(color::BLACK, 1.4, "");

fn title<'a, A>(told: &Told<'a, A>, otherwise: &'a str) -> &'a str {
    told.scenario.title().unwrap_or(otherwise)
}

/// Draws the rotation over time: the band of the samples, their median, and the history of the scenario itself.
pub(super) fn bands(
    figure: Figure,
    told: &Told<'_, Went>,
    bands: &[BandAt],
    asked: &Histories,
) -> String {
    let title = title(told, "What follows from what is not known");
    let end_s = bands.last().map_or(1.0, |at| at.time_s);
    let mut panels = Panels::new(figure, title, [0.0, end_s]);
    let subject = Subject {
        title,
        ground: told.scenario.ground_motion(),
        gravity_m_s2: told.scenario.gravity_m_s2(),
        incipient_g: [None; 2],
    };
    panels.ground(90.0, &subject, None);
    let values = bands
        .iter()
        .flat_map(|at| at.band_rad.into_iter().chain(at.own_rad));
    let y = around(values.filter(|value| value.is_finite()), 6);
    let label = match told.scenario.model() {
        Ok(model) => match model.bodies().get(asked.body).map(String::as_str) {
            Some("") | None => "Rotation (rad)".to_owned(),
            Some(name) => format!("Rotation of {} (rad)", name.replace('_', " ")),
        },
        Err(_) => "Rotation (rad)".to_owned(),
    };
    panels.panel(&label, 330.0, y, None, |drawing, axes| {
        // Values of samples that overturned are outside the picture.
        let place =
            |at: &BandAt, value: f64| axes.place(at.time_s, value.clamp(axes.y.low, axes.y.high));
        let low = bands.iter().map(|at| place(at, at.band_rad[0]));
        let high = bands.iter().rev().map(|at| place(at, at.band_rad[2]));
        let corners: Vec<Vector2<f64>> = low.chain(high).collect();
        drawing.polygon("band", corners, BAND, NO_LINE);
        drawing.curve(
            "median",
            bands.iter().map(|at| place(at, at.band_rad[1])),
            MEDIAN,
        );
        let own = bands.iter().filter_map(|at| Some((at.time_s, at.own_rad?)));
        draw_curves(drawing, axes, &[Curve::new("own", own, MAIN)]);
    });
    let shares: Vec<(f64, f64)> = bands
        .iter()
        .map(|at| {
            (
                at.time_s,
                at.overturned as f64 / told.answered().count().max(1) as f64,
            )
        })
        .collect();
    let y = Scale::exactly(0.0, 1.0, 2);
    panels.panel("Overturned", 70.0, y, None, |drawing, axes| {
        draw_curves(drawing, axes, &[Curve::new("overturned", shares, MEDIAN)]);
    });
    let keys = [
        ("the scenario itself", Sign::Line(MAIN)),
        ("median of the samples", Sign::Line(MEDIAN)),
        ("5 to 95 %; overturned is beyond", Sign::Band(BAND, 1.0)),
    ];
    panels.finish(&keys, false)
}

/// Draws the probability of overturning against the factor, with its interval, and the factor of the scenario itself.
pub(super) fn probability(
    figure: Figure,
    told: &Told<'_, FirstEdge>,
    probabilities: &[ProbabilityAt],
) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(title(told, "Probability of overturning"));
    let keys = [
        ("share of the samples", Sign::Line(MEDIAN)),
        ("95 % interval", Sign::Band(BAND, 1.0)),
        ("the scenario itself", Sign::Line(OWN)),
    ];
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let own = told.own.as_ref().ok().and_then(|edge| edge.factor);
    let factors = probabilities.iter().map(|at| at.factor).chain(own);
    let factors: Vec<f64> = factors.chain([1.0]).collect();
    let axes = Axes {
        frame: figure.plot(top, figure.height_px(405.0)),
        x: Scale::around(
            factors
                .iter()
                .flat_map(|factor| [0.97 * factor, 1.03 * factor]),
            figure.ticks(8),
        ),
        y: Scale::exactly(0.0, 1.0, 5),
    };
    // A step curve: the share rises at each factor at which a sample overturns.
    let steps = |of: fn(&ProbabilityAt) -> f64, first: f64| {
        axes.staircase(first, probabilities.iter().map(|at| (at.factor, of(at))))
    };
    let none = super::statistics::Share::of(0, told.answered().count());
    let low = steps(|at| at.share.low, 0.0);
    let high = steps(|at| at.share.high, none.map_or(1.0, |none| none.high));
    drawing.polygon(
        "band",
        low.into_iter().chain(high.into_iter().rev()),
        BAND,
        NO_LINE,
    );
    axes.draw(
        &mut drawing,
        Some("factor on the ground motion"),
        "probability of overturning",
    );
    drawing.curve("probability", steps(|at| at.share.share, 0.0), MEDIAN);
    if let Some(own) = own {
        let ends = [0.0, 1.0].map(|y| axes.place(own, y));
        drawing.curve("own", ends, OWN);
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

/// Draws the share that overturns against the intensity: for the scenario itself under all records, for each sample, and for all together.
pub(super) fn fragility(figure: Figure, told: &Told<'_, Capacity>, asked: &Capacities) -> String {
    const MOST_FAINT: usize = 20;
    const FAINT: Stroke = Stroke::new("#b9d3e8", 0.9, "");
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(title(told, "Fragility with what is not known"));
    let keys = [
        ("all samples and records", Sign::Line(MEDIAN)),
        ("single samples", Sign::Line(FAINT)),
        (
            "the scenario itself, from record to record",
            Sign::Line(OWN),
        ),
    ];
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let levels = asked.levels();
    let ends = [levels.first(), levels.last()].map(|level| level.copied().unwrap_or(1.0));
    let axes = Axes {
        frame: figure.plot(top, figure.height_px(405.0)),
        x: Scale::logarithmic(0.95 * ends[0], 1.05 * ends[1]),
        y: Scale::exactly(0.0, 1.0, 5),
    };
    let steps = |edges: &mut dyn Iterator<Item = &FirstEdge>| -> Vec<Vector2<f64>> {
        let mut strengths: Vec<f64> = edges.map(FirstEdge::strength).collect();
        strengths.sort_by(f64::total_cmp);
        let all = strengths.len().max(1) as f64;
        let shares = (1..).map(|count| f64::from(count) / all);
        let rises = strengths.into_iter().zip(shares);
        axes.staircase(0.0, rises.filter(|(strength, _)| strength.is_finite()))
    };
    let label = asked.measure().column().replace('_', " ");
    axes.draw(&mut drawing, Some(&label), "share that overturns");
    for (_, capacity) in told.answered().take(MOST_FAINT) {
        drawing.curve("sample", steps(&mut capacity.0.iter()), FAINT);
    }
    let mut all = told.answered().flat_map(|(_, capacity)| &capacity.0);
    drawing.curve("both", steps(&mut all), MEDIAN);
    if let Ok(own) = told.own {
        drawing.curve("own", steps(&mut own.0.iter()), OWN);
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

/// Draws how much each number matters for each answer: a bar with its interval.
pub(super) fn matters<A>(figure: Figure, told: &Told<'_, A>, decides: &[Decides<'_>]) -> String {
    const ROW_PX: f64 = 42.0;
    const BAR_PX: f64 = 14.0;
    let mut drawing = Drawing::new(figure);
    let mut top = drawing.title(title(told, "What matters")) + 10.0;
    for Decides { what, of, .. } in decides {
        let caption = match of {
            Some(_) => {
                format!("share in {what}, alone, with its 95 % interval; (r) rank correlation")
            }
            None => {
                format!("nothing can be said of {what}: the samples do not differ, or are too few")
            }
        };
        top = drawing.caption(top + 14.0, &caption) + 6.0;
        let Some(of) = of else {
            continue;
        };
        let height = ROW_PX * of.len() as f64;
        let axes = Axes {
            frame: figure.plot(top, height),
            x: Scale::exactly(0.0, 1.0, 5),
            y: Scale::exactly(0.0, 1.0, 1),
        };
        let frame = axes.frame;
        for (part, text) in axes.x.ticks() {
            let x = axes.place(part, 0.0).x;
            let [above, below] = [frame.top, frame.top + height].map(|y| Vector2::new(x, y));
            drawing.line(above, below, Stroke::new(color::GREY, 0.6, ""));
            drawing.label(below + Vector2::new(0.0, 17.0), Anchor::Middle, 0.0, &text);
        }
        let mut row = frame.top;
        for (key, matters) in of {
            let at = |part: f64| axes.place(part, 0.0).x;
            let name = spoken(&key.key, told.uncertain);
            let total = matters.total.map_or(String::new(), |total| {
                format!(", {:.2} in all", total.total)
            });
            let text = format!(
                "{name}: {:.2}{total} (r {:+.2})",
                matters.first_order, matters.rank_correlation
            );
            let label = Vector2::new(frame.left + 4.0, row + 15.0);
            drawing.label(label, Anchor::Start, 0.0, &text);
            let bar = Frame {
                left: frame.left,
                top: row + 20.0,
                width: at(matters.first_order) - frame.left,
                height: BAR_PX,
            };
            if let Some(total) = matters.total {
                let width = at(total.total) - frame.left;
                drawing.band("total", &Frame { width, ..bar }, color::BLUE, 0.2);
            }
            drawing.band(&key.key, &bar, color::BLUE, 0.6);
            let middle = row + 20.0 + 0.5 * BAR_PX;
            let ends = matters
                .first_order_interval
                .map(|part| Vector2::new(at(part), middle));
            drawing.curve("interval", ends, INTERVAL);
            row += ROW_PX;
        }
        top = row + 34.0;
    }
    drawing.finish(top + 12.0)
}
