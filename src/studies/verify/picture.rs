//! Pictures of the page: the mechanism, and its capacity compared with the demand.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::{Check, Mechanism, StateCheck, Way};
use crate::dynamics::history::OpenHinge;
use crate::mechanics::geometry::field::turned;
use crate::output::elevation::{Place, TIE, draw_carried, draw_dimensions, room_px};
use crate::output::scene::{Piece, Scene};
use crate::output::svg::{Anchor, Axes, CURVES, Drawing, Figure, Key, Scale, Sign, Stroke, color};
use crate::scenario::DimensionSide;
use crate::scenario::{LimitState, Structure};

/// Colours of the bodies, one after another.
const BODIES: [&str; 3] = ["#cfe3f1", "#f6dcc4", "#cce9e0"];
/// Colour of the parts that stand still.
const STILL: &str = "#e9e9e9";

/// The mechanism in the undeformed structure: its bodies with their centres, numbered from the left like its hinges, and their
/// virtual displacements.
pub(super) fn mechanism(figure: Figure, structure: &Structure, mechanism: &Mechanism) -> String {
    let pieces = pieces(structure, mechanism);
    let scene = Scene::new(structure);
    let [low, high] = scene.frame_m();
    let size = high - low;
    let [left, right] =
        [DimensionSide::Left, DimensionSide::Right].map(|side| room_px(&scene, side).max(40.0));
    let width_px = figure.width_px() - left - right;
    let tall_px = figure.height_px(420.0);
    let scale = (width_px / size.x).min(tall_px / size.y);
    let top = 30.0;
    let place = Place {
        middle_m: Vector2::new(0.5 * (low.x + high.x), high.y),
        at: Vector2::new(left + 0.5 * width_px, top),
        scale,
    };
    let px = |point_m: Vector2<f64>| place.px(point_m);
    let mut drawing = Drawing::new(figure);
    draw_dimensions(&mut drawing, &place, &scene);
    draw_carried(&mut drawing, &place, &scene, &[], (&[], 1.0));
    let thin = Stroke::new("#777777", 0.6, "");
    for piece in &pieces {
        let (name, fill) = match piece.body {
            None => ("still".to_owned(), STILL),
            Some(body) => (format!("body {}", body + 1), BODIES[body % BODIES.len()]),
        };
        let outline = piece.outline_m.iter().map(|corner| px(*corner));
        drawing.polygon(&name, outline, fill, thin);
    }
    for tie in structure.ties() {
        let ends = tie.ends.map(|end| px(end.at_m));
        drawing.curve("tie", ends, TIE);
    }
    let fastest = mechanism.bodies.iter().map(|body| body.displacement.norm());
    let fastest = fastest.fold(f64::MIN_POSITIVE, f64::max);
    let arrow = Stroke::new(color::BLUE, 1.6, "");
    for (number, body) in (1..).zip(&mechanism.bodies) {
        let at = px(body.centre_m);
        let delta = Vector2::new(
            mechanism.sway.sign() * body.displacement.x,
            -body.displacement.y,
        ) * (46.0 / fastest);
        let end = at + delta;
        drawing.curve(&format!("delta {number}"), [at, end], arrow);
        if delta.norm() > 6.0 {
            let back = -delta.normalize() * 7.0;
            let across = turned(back) * 0.45;
            drawing.polygon(
                "",
                [end, end + back + across, end + back - across],
                color::BLUE,
                arrow,
            );
        }
        drawing.circle(
            &format!("centre {number}"),
            at,
            2.4,
            Stroke::new(color::BLACK, 1.2, ""),
        );
        let label = at + Vector2::new(0.0, 17.0);
        drawing.label(label, Anchor::Middle, 0.0, &number.to_string());
    }
    let red = Stroke::new(color::VERMILION, 1.8, "");
    let middle = px(0.5 * (low + high));
    for (name, hinge) in ('A'..='Z').zip(&mechanism.hinges) {
        let at = px(hinge.at_m);
        drawing.circle(&format!("hinge {name}"), at, 3.6, red);
        // Away from the middle of the picture, so that the label is beside the masonry.
        let away = at - middle;
        let side = if away.x < 0.0 { -13.0 } else { 13.0 };
        let label = at + Vector2::new(side, if away.y < 0.0 { -3.0 } else { 15.0 });
        drawing.label(label, Anchor::Middle, 0.0, &name.to_string());
    }
    drawing.finish(top + scale * size.y + room_px(&scene, DimensionSide::Below).max(26.0))
}

fn pieces(structure: &Structure, mechanism: &Mechanism) -> Vec<Piece> {
    if !mechanism.body_of_block.is_empty()
        && let Ok(row) = structure.row()
    {
        let scene = Scene::of_row(&row);
        let blocks = scene.pieces(&[]).into_iter().zip(&mechanism.body_of_block);
        let found: Vec<Piece> = blocks
            .map(|(piece, body)| Piece {
                body: *body,
                outline_m: piece.outline_m,
            })
            .collect();
        return found;
    }
    let hinges = mechanism.hinges.iter().map(|placed| OpenHinge {
        hinge: placed.hinge,
        position_m: placed.at_m,
    });
    Scene::new(structure).pieces(&hinges.collect::<Vec<_>>())
}

/// Acceleration against displacement of the oscillator: its divided curve, the spectra of the limit states at their damping, and the
/// lines of their periods.
pub(super) fn capacity(figure: Figure, check: &Check, mechanism: &Mechanism, way: &Way) -> String {
    let divided = check.settings.confidence_factor;
    let states: Vec<&StateCheck> = check
        .states
        .iter()
        .filter(|one| one.state != LimitState::Sld)
        .collect();
    let sides = states.iter().filter_map(|one| {
        let side = one.sides.iter().find(|side| side.sway == mechanism.sway)?;
        Some((*one, side.displacement?, one.rule?))
    });
    let sides: Vec<_> = sides.collect();
    let end_m = way.centre.end().oscillator_displacement_m;
    let farthest_m = sides.iter().map(|(_, one, _)| 1.15 * one.demand_m);
    let farthest_m = farthest_m.fold(1.05 * end_m, f64::max);
    let start_g = way.centre.start().oscillator_acceleration_g / divided;
    let highest_g = sides.iter().map(|(_, one, _)| 1.3 * one.demand_g);
    let highest_g = highest_g.fold(1.6 * start_g, f64::max);
    let mut drawing = Drawing::new(figure);
    let mut names = vec![("capacity, a/FC".to_owned(), CURVES[0])];
    for ((one, _, rule), stroke) in sides.iter().zip(&CURVES[1..]) {
        let name = super::words::name(one.state);
        names.push((format!("{name}, {} %", rule.damping_percent), *stroke));
    }
    let keys: Vec<Key<'_>> = names
        .iter()
        .map(|(name, stroke)| (name.as_str(), Sign::Line(*stroke)))
        .collect();
    let top = drawing.legend(85.0, 4.0, &keys) + 6.0;
    let height = figure.height_px(400.0);
    let axes = Axes {
        frame: figure.plot(top, height),
        x: Scale::around([0.0, farthest_m], figure.ticks(8)),
        y: Scale::around([0.0, highest_g], 5),
    };
    axes.draw(
        &mut drawing,
        Some("spectral displacement (m)"),
        "spectral acceleration (g)",
    );
    let reach = [axes.x.high, axes.y.high];
    drawing.within(&axes.frame, |drawing| {
        for ((one, side, rule), stroke) in sides.iter().zip(&CURVES[1..]) {
            let name = super::words::name(one.state);
            let points = (1..=600).filter_map(|step| {
                let period_s = 0.01 * f64::from(step);
                let damping = rule.damping_percent;
                let acceleration_g = one.spectrum.acceleration_g(period_s, damping).ok()?;
                let circular = period_s / (2.0 * PI);
                let own_m = acceleration_g * check.gravity_m_s2 * circular * circular;
                Some(axes.place(own_m, acceleration_g))
            });
            drawing.curve(&format!("demand {name}"), points, *stroke);
            // The line of the period ends at the frame.
            let circular = 2.0 * PI / side.period_s;
            let g_per_m = circular * circular / check.gravity_m_s2;
            let d_m = reach[0].min(reach[1] / g_per_m);
            let faint = Stroke::new(stroke.color, 0.9, "1 3");
            drawing.curve(
                &format!("period {name}"),
                [axes.place(0.0, 0.0), axes.place(d_m, d_m * g_per_m)],
                faint,
            );
        }
        let points = way.centre.curve.iter();
        let points = points.map(|point| {
            axes.place(
                point.oscillator_displacement_m,
                point.oscillator_acceleration_g / divided,
            )
        });
        drawing.curve("capacity", points, CURVES[0]);
        for ((one, side, rule), stroke) in sides.iter().zip(&CURVES[1..]) {
            let name = super::words::name(one.state);
            let reached_m = rule.part_of_d0 * end_m;
            let grey = Stroke::new(color::GREY, 0.9, "3 2");
            drawing.curve(
                &format!("limit {name}"),
                [
                    axes.place(reached_m, 0.0),
                    axes.place(reached_m, side.acceleration_g),
                ],
                grey,
            );
            let own = Stroke::new(stroke.color, 1.6, "");
            drawing.circle(
                &format!("reached {name}"),
                axes.place(reached_m, side.acceleration_g),
                3.0,
                own,
            );
            drawing.circle(
                &format!("demanded {name}"),
                axes.place(side.demand_m, side.demand_g),
                3.0,
                own,
            );
        }
    });
    drawing.finish(top + height + 48.0)
}
