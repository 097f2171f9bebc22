//! Pictures of ensembles.

use nalgebra::Vector2;

use super::Told;
use super::edges::ProbabilityAt;
use super::histories::{BandAt, Histories, Went};
use super::matters::Matters;
use super::records::{Capacities, Capacity};
use super::told::{Decides, spoken};
use crate::output::Figure;
use crate::output::axes::{Axes, Scale};
use crate::output::chart::{Chart, LEFT_PX, Mark};
use crate::output::panels::{MAIN, Panels, Subject, around};
use crate::output::sheet::{Height, Key, Sheet, Sign};
use crate::output::svg::{Anchor, Drawing, Frame, Stroke, color};
use crate::studies::statistics::Share;
use crate::studies::threshold::first_edge::FirstEdge;

const BAND: &str = "#cfe3f1";
const MEDIAN: Stroke = Stroke::new(color::BLUE, 1.6, "");
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
    let title = title(told, "Histories with uncertain data");
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
    let y = around(&[], values, 6);
    let model = told.scenario.model().ok();
    let body = model.and_then(|model| model.bodies().get(asked.body).cloned());
    let label = match body.filter(|name| !name.is_empty()) {
        Some(name) => format!("Rotation of {} (rad)", name.replace('_', " ")),
        None => "Rotation (rad)".to_owned(),
    };
    // Values of samples that overturned are outside the picture.
    let at = |which: usize| {
        let clamped = move |value: f64| value.clamp(y.low, y.high);
        bands
            .iter()
            .map(move |at| (at.time_s, clamped(at.band_rad[which])))
    };
    let own = bands.iter().filter_map(|at| Some((at.time_s, at.own_rad?)));
    let marks = vec![
        Mark::between("band", BAND, at(0), at(2)),
        Mark::curve("median", MEDIAN, at(1)),
        Mark::curve("own", MAIN, own),
    ];
    panels.panel(&label, 330.0, y, None, marks);
    let samples = told.answered().count().max(1) as f64;
    let shares = bands
        .iter()
        .map(|at| (at.time_s, at.overturned as f64 / samples));
    let shares = vec![Mark::curve("overturned", MEDIAN, shares)];
    panels.panel(
        "Overturned",
        70.0,
        Scale::exactly(0.0, 1.0, 2),
        None,
        shares,
    );
    panels.keys = vec![
        Key::line("the scenario itself", MAIN),
        Key::line("median of the samples", MEDIAN),
        Key::new(
            "5 to 95 %; overturned samples are beyond",
            Sign::Band(BAND, 1.0),
        ),
    ];
    panels.finish(false)
}

/// Draws the probability of overturning against the factor, with its interval, and the factor of the scenario itself.
pub(super) fn probability(
    figure: Figure,
    told: &Told<'_, FirstEdge>,
    probabilities: &[ProbabilityAt],
) -> String {
    let own = told.own.as_ref().ok().and_then(|edge| edge.factor);
    let factors = probabilities.iter().map(|at| at.factor).chain(own);
    let ends = factors
        .chain([1.0])
        .flat_map(|factor| [0.97 * factor, 1.03 * factor]);
    let x = Scale::around(ends, figure.ticks(8));
    let y = Scale::exactly(0.0, 1.0, 5);
    // The share rises at each factor at which a sample overturns.
    let steps = |name, of: fn(&ProbabilityAt) -> f64, first: f64| {
        let rises = probabilities.iter().map(|at| (at.factor, of(at)));
        Mark::staircase(name, MEDIAN, (x, first), rises)
    };
    let none = Share::of(0, told.answered().count());
    let [low, high] = [
        steps("", |at| at.share.low, 0.0),
        steps("", |at| at.share.high, none.map_or(1.0, |none| none.high)),
    ];
    let [low, high] = [&low, &high].map(|curve| curve.points().iter().copied());
    let mut marks = vec![steps("probability", |at| at.share.share, 0.0)];
    marks.extend(own.map(|own| Mark::upright("own", OWN, own, y)));
    let x_axis = ("factor on the ground motion", x);
    let chart = Chart {
        keys: vec![
            Key::line("share of the samples", MEDIAN),
            Key::new("95 % interval", Sign::Band(BAND, 1.0)),
            Key::line("the scenario itself", OWN),
        ],
        below: vec![Mark::between("band", BAND, low, high)],
        marks,
        ..Chart::new(405.0, x_axis, ("probability of overturning", y))
    };
    chart.draw(figure, title(told, "Probability of overturning"))
}

/// Draws the share that overturns against the intensity: for the scenario itself under all records, for each sample, and for all together.
pub(super) fn fragility(figure: Figure, told: &Told<'_, Capacity>, asked: &Capacities) -> String {
    const MOST_FAINT: usize = 20;
    const FAINT: Stroke = Stroke::new("#b9d3e8", 0.9, "");
    let levels = asked.levels();
    let ends = [levels.first(), levels.last()].map(|level| level.copied().unwrap_or(1.0));
    let x = Scale::logarithmic(0.95 * ends[0], 1.05 * ends[1]);
    let steps = |name, stroke, edges: &mut dyn Iterator<Item = &FirstEdge>| {
        let mut strengths: Vec<f64> = edges.map(FirstEdge::strength).collect();
        strengths.sort_by(f64::total_cmp);
        let all = strengths.len().max(1) as f64;
        let shares = (1..).map(|count| f64::from(count) / all);
        let rises = strengths.into_iter().zip(shares);
        let rises = rises.filter(|(strength, _)| strength.is_finite());
        Mark::staircase(name, stroke, (x, 0.0), rises)
    };
    let samples = told.answered().take(MOST_FAINT);
    let mut marks: Vec<Mark> = samples
        .map(|(_, capacity)| steps("sample", FAINT, &mut capacity.0.iter()))
        .collect();
    let mut all = told.answered().flat_map(|(_, capacity)| &capacity.0);
    marks.push(steps("both", MEDIAN, &mut all));
    if let Ok(own) = told.own {
        marks.push(steps("own", OWN, &mut own.0.iter()));
    }
    let label = asked.measure().column().replace('_', " ");
    let y_axis = ("share that overturns", Scale::exactly(0.0, 1.0, 5));
    let chart = Chart {
        keys: vec![
            Key::line("all samples and records", MEDIAN),
            Key::line("single samples", FAINT),
            Key::line("the scenario itself, from record to record", OWN),
        ],
        marks,
        ..Chart::new(405.0, (&label, x), y_axis)
    };
    chart.draw(figure, title(told, "Fragility with uncertain data"))
}

/// Draws how much of each answer each uncertain number explains: a bar with its interval.
pub(super) fn matters<A>(figure: Figure, told: &Told<'_, A>, decides: &[Decides<'_>]) -> String {
    let mut sheet = Sheet::new(figure, title(told, "Influence of uncertain data"));
    sheet.gap(10.0);
    for Decides { what, of, .. } in decides {
        let Some(of) = of else {
            let nothing = format!("no shares in {what}: the samples do not differ, or are too few");
            sheet.caption(14.0, &nothing);
            sheet.gap(6.0);
            continue;
        };
        let caption =
            format!("share in {what}, alone, with its 95 % interval; (r) rank correlation");
        sheet.caption(14.0, &caption);
        sheet.gap(6.0);
        let height = Height::Fixed(ROW_PX * of.len() as f64);
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
            for (key, matters) in of {
                bar(
                    drawing,
                    &axes,
                    row,
                    (&spoken(&key.key, told.uncertain), &key.key),
                    matters,
                );
                row += ROW_PX;
            }
        });
        sheet.gap(34.0);
    }
    sheet.gap(12.0);
    sheet.finish()
}

/// Height of the text and the bar of an uncertain number.
const ROW_PX: f64 = 42.0;
const BAR_PX: f64 = 14.0;

/// Draws text and bar of an uncertain number, below `top`.
fn bar(drawing: &mut Drawing, axes: &Axes, top: f64, (name, key): (&str, &str), matters: &Matters) {
    let left = axes.frame.left;
    let at = |share: f64| axes.place(share, 0.0).x;
    let total = matters.total.map_or(String::new(), |total| {
        format!(", {:.2} in all", total.total)
    });
    let text = format!(
        "{name}: {:.2}{total} (r {:+.2})",
        matters.first_order, matters.rank_correlation
    );
    drawing.label(
        Vector2::new(left + 4.0, top + 15.0),
        Anchor::Start,
        0.0,
        text,
    );
    let bar = |share: f64| Frame {
        left,
        top: top + 20.0,
        width: at(share) - left,
        height: BAR_PX,
    };
    if let Some(total) = matters.total {
        drawing.band("total", &bar(total.total), color::BLUE, 0.2);
    }
    drawing.band(key, &bar(matters.first_order), color::BLUE, 0.6);
    let middle = top + 20.0 + 0.5 * BAR_PX;
    let ends = matters.first_order_interval;
    let ends = ends.map(|share| Vector2::new(at(share), middle));
    drawing.curve("interval", ends, INTERVAL);
}
