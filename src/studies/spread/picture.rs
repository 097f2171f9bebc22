//! `spread.svg`: the pushes that are left against the movement, and the arch where it falls.

use nalgebra::Vector2;

use super::{Path, Push, SpreadPaths, Stage};
use crate::mechanics::blocks::Row;
use crate::mechanics::geometry::pose::Pose;
use crate::output::elevation::{BUILT, HINGE, Place, STONE, TIE, draw_carried};
use crate::output::scene::Scene;
use crate::output::svg::{Anchor, Axes, CURVES, Drawing, Figure, Key, Scale, Sign, Stroke, color};

/// Pictures of the arch side by side, at most, and how wide they are at least.
const COLUMNS: usize = 3;
const LEAST_PX: f64 = 180.0;
/// First motions are drawn thinner and dashed.
const FIRST_MOTION_PX: f64 = 1.0;

/// The picture.
pub(super) fn draw(figure: Figure, title: &str, spread: &SpreadPaths, scene: &Scene) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(title);
    let top = draw_pushes(&mut drawing, figure, top, spread);
    let columns = figure.columns(spread.paths.len().clamp(1, COLUMNS), LEAST_PX);
    let cell_px = figure.width_px() / columns as f64;
    let mut top = top;
    for paths in spread.paths.chunks(columns) {
        let cells: Vec<Cell<'_>> = paths
            .iter()
            .filter_map(|path| Cell::new(figure, &spread.row, scene, path, cell_px))
            .collect();
        let height = cells.iter().map(Cell::height_px).fold(0.0, f64::max);
        for (column, cell) in (0_u32..).zip(&cells) {
            let foot = Vector2::new((f64::from(column) + 0.5) * cell_px, top + height);
            cell.draw(&mut drawing, foot);
        }
        top += height + 58.0;
    }
    let how = "to scale; dashed: as built; circles: hinges; blue: line of thrust";
    let caption = match scene.sizes_in_words() {
        sizes if sizes.is_empty() => how.to_owned(),
        sizes => format!("{how}; {sizes}"),
    };
    let end = drawing.caption(top, &caption);
    drawing.finish(end + 8.0)
}

/// Capacity and first motion against the movement, to the weaker side; returns where the plot ends.
fn draw_pushes(drawing: &mut Drawing, figure: Figure, top: f64, spread: &SpreadPaths) -> f64 {
    let kinds = [(Push::Capacity, false), (Push::FirstMotion, true)];
    let strokes = || spread.paths.iter().zip(CURVES.into_iter().cycle());
    let style = |stroke: Stroke, thin: bool| {
        if thin {
            Stroke::new(stroke.color, FIRST_MOTION_PX, "3 3")
        } else {
            Stroke::new(stroke.color, stroke.width, "")
        }
    };
    let mut curves = Vec::new();
    for (path, stroke) in strokes() {
        for (push, thin) in kinds {
            let name = format!(
                "{}, {} {}",
                push.name(),
                path.way.springing.name(),
                path.way.words()
            );
            let points = path.stages.iter();
            let points: Vec<(f64, f64)> = points
                .filter_map(|stage| Some((stage.movement_m, stage.least(push)?)))
                .collect();
            curves.push((name, points, style(stroke, thin)));
        }
    }
    let ways = spread.paths.iter();
    let ways: Vec<String> = ways
        .map(|path| format!("{} {}", path.way.springing.name(), path.way.words()))
        .collect();
    let mut keys: Vec<Key<'_>> = ways
        .iter()
        .zip(strokes())
        .map(|(way, (_, stroke))| (way.as_str(), Sign::Line(style(stroke, false))))
        .collect();
    let dashed = style(Stroke::new(color::BLACK, 1.0, ""), true);
    keys.push(("dashed: first motion", Sign::Line(dashed)));
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys) + 8.0;
    let points = || curves.iter().flat_map(|(_, points, _)| points);
    let height = figure.height_px(300.0);
    let axes = Axes {
        frame: figure.plot(top, height),
        x: Scale::around(points().map(|point| point.0), figure.ticks(8)),
        y: Scale::around(points().map(|point| point.1).chain([0.0]), 6),
    };
    axes.draw(drawing, Some("movement of the springing (m)"), "push (g)");
    for (name, points, stroke) in &curves {
        let places = points.iter().map(|(x, y)| axes.place(*x, *y));
        drawing.curve(name, places, *stroke);
    }
    top + height + 66.0
}

/// The arch at the end of a way.
struct Cell<'a> {
    row: &'a Row,
    scene: &'a Scene,
    path: &'a Path,
    stage: &'a Stage,
    low_m: Vector2<f64>,
    high_m: Vector2<f64>,
    /// Pixels per metre.
    scale: f64,
}

impl<'a> Cell<'a> {
    fn new(
        figure: Figure,
        row: &'a Row,
        scene: &'a Scene,
        path: &'a Path,
        width_px: f64,
    ) -> Option<Self> {
        let stage = path.stages.last()?;
        let blocks = row.outlines_m().iter().zip(&stage.poses);
        let corners = blocks.flat_map(|(outline, pose)| {
            let corners = outline.iter();
            corners.flat_map(|corner| [*corner, pose.of(*corner)])
        });
        // What it carries hardly moves farther than its blocks.
        let [low_m, high_m] = corners.fold(scene.frame_m(), |[low, high], corner: Vector2<f64>| {
            [low.inf(&corner), high.sup(&corner)]
        });
        let across_m = high_m - low_m;
        Some(Self {
            row,
            scene,
            path,
            stage,
            low_m,
            high_m,
            scale: figure.squeezed_px(((width_px - 30.0) / across_m.x).min(width_px / across_m.y)),
        })
    }

    fn height_px(&self) -> f64 {
        self.scale * (self.high_m.y - self.low_m.y)
    }

    /// Draws it above the middle of its foot.
    fn draw(&self, drawing: &mut Drawing, foot: Vector2<f64>) {
        let place = Place {
            middle_m: Vector2::new(0.5 * (self.low_m.x + self.high_m.x), self.low_m.y),
            at: foot,
            scale: self.scale,
        };
        let px = |point: Vector2<f64>| place.px(point);
        draw_carried(drawing, &place, self.scene, &[], (&self.stage.poses, 1.0));
        let solid = Stroke::new(color::BLACK, 1.1, "");
        for outline in self.row.outlines_m() {
            drawing.polygon("", outline.iter().map(|corner| px(*corner)), "none", BUILT);
        }
        for (block, (outline, pose)) in self
            .row
            .outlines_m()
            .iter()
            .zip(&self.stage.poses)
            .enumerate()
        {
            let corners = outline.iter().map(|corner| px(pose.of(*corner)));
            drawing.polygon(&format!("block {}", block + 1), corners, STONE, solid);
        }
        for ends in self.scene.ties(&[]) {
            let ends = ends.map(|mark| px(mark.moved(&self.stage.poses, 1.0)));
            drawing.curve("tie", ends, TIE);
        }
        if let Some(state) = &self.stage.state {
            let joints = self.row.joints().iter().zip(&state.corners);
            let thrust = joints
                .enumerate()
                .filter_map(|(index, (joint, [inner, outer]))| {
                    let across = joint.extrados_m - joint.intrados_m;
                    let at_m = joint.intrados_m + across * (outer / (inner + outer));
                    (inner + outer > 0.0).then(|| px(self.pose_at(index).of(at_m)))
                });
            let stroke = Stroke::new(color::BLUE, 1.6, "");
            drawing.curve("thrust line", thrust, stroke);
            for hinge in &state.hinges {
                let corner_m = self.row.joints()[hinge.joint].corner_m(hinge.edge);
                let at = px(self.pose_at(hinge.joint).of(corner_m));
                drawing.circle("hinge", at, 3.2, HINGE);
            }
        }
        let words = self.path.way.words();
        let text = match (self.path.falls_at_m, &self.path.lost) {
            (Some(at_m), _) => format!("{words} {at_m:.3} m: falls"),
            (None, Some(_)) => format!(
                "{words} {:.3} m: not followed further",
                self.stage.movement_m
            ),
            (None, None) => format!("{words} {:.3} m: stands", self.stage.movement_m),
        };
        let below = foot + Vector2::new(0.0, 22.0);
        drawing.label(below, Anchor::Middle, 0.0, &text);
    }

    /// The pose of the body whose face a joint lies on: the block after it, or where there is none the one before.
    fn pose_at(&self, joint: usize) -> Pose {
        let poses = &self.stage.poses;
        poses[joint.min(poses.len() - 1)]
    }
}
