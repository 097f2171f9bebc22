//! Pictures of the page: the mechanism, and its capacity compared with the demand.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::{CheckedMechanism, MechanismBody, VerifySummary};
use crate::mechanics::quarter_turn;
use crate::output::elevation::{BODIES, SheetTransform, View, draw_dimensions, room_px};
use crate::output::{
    Anchor, CURVES, Chart, Drawing, Figure, Key, Mark, PartHeight, Scale, Scene, Shape, Sheet,
    Stroke, color,
};
use crate::scenario::{DimensionSide, Language, Structure};
use crate::{OpenHinge, Sway};

/// Colour of parts that do not move.
const STILL: &str = "#e9e9e9";

/// Draws the mechanism in the undeformed structure: bodies with their centres, numbered from the left, hinges with letters, and virtual
/// displacements.
pub(super) fn mechanism(
    figure: Figure,
    language: Language,
    structure: &Structure,
    sway: Sway,
    mechanism: &CheckedMechanism,
) -> String {
    let scene = match (&mechanism.held_row, structure.row()) {
        (Some(row), _) => Scene::of_row(row, structure),
        (None, Ok(row)) if !mechanism.body_of_block.is_empty() => Scene::of_row(&row, structure),
        _ => Scene::new(structure),
    };
    let [low, high] = scene.frame_m();
    let size = high - low;
    let [left, right] =
        [DimensionSide::Left, DimensionSide::Right].map(|side| room_px(&scene, side).max(40.0));
    let width_px = figure.width_px - left - right;
    let scale = (width_px / size.x).min(figure.height_px(420.0) / size.y);
    let mut sheet = Sheet::new(figure, "");
    sheet.gap(26.0);
    let tall_px = scale * size.y;
    sheet.part(PartHeight::Structure(tall_px, tall_px), |drawing, part| {
        let place = SheetTransform::over([low, high], left + 0.5 * width_px, part);
        draw_dimensions(drawing, &place, &scene, language);
        draw_mechanism(drawing, place, &scene, (sway, mechanism));
    });
    sheet.gap(room_px(&scene, DimensionSide::Below).max(26.0));
    sheet.finish()
}

fn draw_mechanism(
    drawing: &mut Drawing,
    place: SheetTransform,
    scene: &Scene,
    (sway, mechanism): (Sway, &CheckedMechanism),
) {
    let px = |point_m: Vector2<f64>| place.px(point_m);
    let [low, high] = scene.frame_m();
    let hinges: Vec<OpenHinge> = mechanism
        .hinges
        .iter()
        .map(|placed| OpenHinge {
            hinge: placed.hinge,
            position_m: Vector2::new(placed.x_m, placed.y_m),
        })
        .collect();
    let view = View {
        outline: Stroke::new("#777777", 0.6, ""),
        ..View::new(scene, place, &[], &hinges)
    };
    view.draw_behind(drawing);
    let known = &mechanism.body_of_block;
    view.draw_blocks(drawing, |block, body| {
        match known.get(block).copied().unwrap_or(body) {
            None => ("still".to_owned(), STILL),
            Some(body) => (format!("body {}", body + 1), BODIES[body % BODIES.len()]),
        }
    });
    view.draw_loads(drawing, None, false);
    view.draw_ties(drawing);
    let moves = |body: &MechanismBody| Vector2::new(sway.sign() * body.delta_x, -body.delta_y);
    let fastest = mechanism
        .bodies
        .iter()
        .map(|body| moves(body).norm())
        .fold(f64::MIN_POSITIVE, f64::max);
    let arrow = Stroke::new(color::BLUE, 1.6, "");
    for (number, body) in (1..).zip(&mechanism.bodies) {
        let at = px(Vector2::new(body.x_m, body.y_m));
        let delta = moves(body) * (46.0 / fastest);
        let end = at + delta;
        drawing.curve(&format!("delta {number}"), [at, end], arrow);
        if delta.norm() > 6.0 {
            let back = -delta.normalize() * 7.0;
            let across = quarter_turn(back) * 0.45;
            let barbs = [end, end + back + across, end + back - across];
            drawing.polygon("", barbs, color::BLUE, arrow);
        }
        let black = Stroke::new(color::BLACK, 1.2, "");
        drawing.circle(&format!("centre {number}"), at, 2.4, black);
        let label = at + Vector2::new(0.0, 17.0);
        drawing.label(label, Anchor::Middle, 0.0, number.to_string());
    }
    let red = Stroke::new(color::VERMILION, 1.8, "");
    let middle = px(0.5 * (low + high));
    for (name, hinge) in ('A'..='Z').zip(&mechanism.hinges) {
        let at = px(Vector2::new(hinge.x_m, hinge.y_m));
        drawing.circle(&format!("hinge {name}"), at, 3.6, red);
        // Away from the middle of the picture, so that the label is outside the masonry.
        let away = at - middle;
        let side = if away.x < 0.0 { -13.0 } else { 13.0 };
        let label = at + Vector2::new(side, if away.y < 0.0 { -3.0 } else { 15.0 });
        drawing.label(label, Anchor::Middle, 0.0, name.to_string());
    }
}

/// Draws acceleration against displacement of the oscillator: the divided curve, the spectra of the limit states at their damping, and the lines
/// of their periods. `None` without a curve.
pub(super) fn capacity(
    figure: Figure,
    check: &VerifySummary,
    sway: Sway,
    mechanism: &CheckedMechanism,
) -> Option<String> {
    let (curve, end_m) = (mechanism.curve_m_g.as_ref()?, mechanism.d0_m?);
    let divided = |[d_m, a_g]: &[f64; 2]| (*d_m, a_g / check.confidence_factor);
    let curve: Vec<(f64, f64)> = curve.iter().map(divided).collect();
    let sides: Vec<_> = check
        .states
        .iter()
        .filter_map(|(state, one)| {
            let side = one.sides.get(&sway)?;
            Some(((state, one), side.displacement?, one.rule?))
        })
        .zip(&CURVES[1..])
        .collect();
    let demands = || sides.iter().map(|((_, side, _), _)| side);
    let farthest_m = demands().map(|side| 1.15 * side.demand_m);
    let x = farthest_m.chain([0.0, 1.05 * end_m]);
    let highest_g = demands().map(|side| 1.3 * side.demand_acceleration_g);
    let y = highest_g.chain([0.0, 1.6 * curve[0].1]);
    let (x, y) = (Scale::around(x, figure.ticks(8)), Scale::around(y, 5));
    let language = check.language;
    let capacity = language.choose("capacity, a/FC", "capacità, a/FC");
    let mut keys = vec![Key::line(capacity, CURVES[0])];
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for (((state, one), side, rule), stroke) in &sides {
        let (name, percent) = (state.name().to_uppercase(), rule.damping_percent);
        let shown = language.number(percent.to_string());
        keys.push(Key::line(format!("{name}, {shown} %"), **stroke));
        let points = (1..=600).filter_map(|step| {
            let period_s = 0.01 * f64::from(step);
            let acceleration_g = one.demand.acceleration_g(period_s, percent).ok()?;
            let circular = period_s / (2.0 * PI);
            let own_m = acceleration_g * check.gravity_m_s2 * circular * circular;
            Some((own_m, acceleration_g))
        });
        below.push(Mark::curve(format!("demand {name}"), **stroke, points));
        // The line of the period ends at the frame.
        let circular = 2.0 * PI / side.period_s;
        let g_per_m = circular * circular / check.gravity_m_s2;
        let d_m = x.high.min(y.high / g_per_m);
        let faint = Stroke::new(stroke.color, 0.9, "1 3");
        let ends = [(0.0, 0.0), (d_m, d_m * g_per_m)];
        below.push(Mark::curve(format!("period {name}"), faint, ends));
        let reached = (side.reached_m, side.acceleration_g);
        let grey = Stroke::new(color::GREY, 0.9, "3 2");
        let limit = [(side.reached_m, 0.0), reached];
        above.push(Mark::curve(format!("limit {name}"), grey, limit));
        let own = Stroke::new(stroke.color, 1.6, "");
        let demanded = (side.demand_m, side.demand_acceleration_g);
        for (what, at) in [("reached", reached), ("demanded", demanded)] {
            let circle = Shape::Circle(at, 3.0);
            above.push(Mark::new(format!("{what} {name}"), own, circle));
        }
    }
    below.push(Mark::curve("capacity", CURVES[0], curve));
    below.extend(above);
    let x_label = language.choose("spectral displacement (m)", "spostamento spettrale (m)");
    let y_label = language.choose("spectral acceleration (g)", "accelerazione spettrale (g)");
    let chart = Chart {
        keys,
        marks: vec![Mark::clipped(below)],
        ..Chart::new(400.0, (x_label, x), (y_label, y))
    };
    Some(chart.draw(figure, ""))
}
