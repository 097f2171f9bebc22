//! `spread.svg`: the pushes that the arch resists against the movement, and the arch at the end of each way.

use nalgebra::Vector2;

use super::{Path, Push, Stage, Summary};
use crate::mechanics::blocks::Row;
use crate::mechanics::geometry::pose::Pose;
use crate::output::Figure;
use crate::output::chart::{Chart, Mark};
use crate::output::elevation::{HINGE, HINGE_PX, Place, STONE, View};
use crate::output::scene::Scene;
use crate::output::sheet::{Height, Key, Sheet};
use crate::output::svg::{Anchor, CURVES, Drawing, Stroke, color};

/// Largest number of pictures of the arch side by side.
const COLUMNS: usize = 3;
/// Least width of a picture.
const LEAST_PX: f64 = 180.0;
/// First motions are drawn thinner and dashed.
const FIRST_MOTION_PX: f64 = 1.0;

/// The picture.
pub(super) fn draw(figure: Figure, title: &str, spread: &Summary, scene: &Scene) -> String {
    let mut sheet = Sheet::new(figure, title);
    pushes(figure, spread).add_to(&mut sheet);
    sheet.gap(10.0);
    let columns = figure.columns(spread.paths.len().clamp(1, COLUMNS), LEAST_PX);
    let cell_px = figure.width_px / columns as f64;
    for paths in spread.paths.chunks(columns) {
        let cells: Vec<Cell<'_>> = paths
            .iter()
            .filter_map(|path| Cell::new(&spread.row, scene, path, cell_px))
            .collect();
        let height_px = cells.iter().map(Cell::height_px).fold(0.0, f64::max);
        sheet.part(
            Height::Structure(height_px, height_px),
            move |drawing, part| {
                for (column, cell) in (0_u32..).zip(cells) {
                    let middle = (f64::from(column) + 0.5) * cell_px;
                    let foot = Vector2::new(middle, part.top + part.height);
                    cell.draw(drawing, foot, part.height / height_px);
                }
            },
        );
        sheet.gap(58.0);
    }
    let how = "to scale; dashed: as built; circles: hinges; blue: line of thrust";
    let caption = match scene.sizes_in_words() {
        sizes if sizes.is_empty() => how.to_owned(),
        sizes => format!("{how}; {sizes}"),
    };
    sheet.caption(0.0, &caption);
    sheet.gap(8.0);
    sheet.finish()
}

/// Capacity and first motion against the movement, to the weaker side.
fn pushes(figure: Figure, spread: &Summary) -> Chart {
    let thin = |color| Stroke::new(color, FIRST_MOTION_PX, "3 3");
    let (mut marks, mut keys) = (Vec::new(), Vec::new());
    for (path, stroke) in spread.paths.iter().zip(CURVES.into_iter().cycle()) {
        let way = format!("{} {}", path.way.springing.name(), path.way.words());
        let solid = Stroke::new(stroke.color, stroke.width, "");
        for (push, stroke) in [
            (Push::Capacity, solid),
            (Push::FirstMotion, thin(stroke.color)),
        ] {
            let points = path.stages.iter();
            let points = points.filter_map(|stage| Some((stage.movement_m, stage.least(push)?)));
            marks.push(Mark::curve(
                format!("{}, {way}", push.name()),
                stroke,
                points,
            ));
        }
        keys.push(Key::line(way, solid));
    }
    keys.push(Key::line("dashed: first motion", thin(color::BLACK)));
    let labels = ["movement of the springing (m)", "push (g)"];
    Chart {
        keys,
        ..Chart::around(figure, 300.0, labels, marks)
    }
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
    fn new(row: &'a Row, scene: &'a Scene, path: &'a Path, width_px: f64) -> Option<Self> {
        let stage = path.stages.last()?;
        let blocks = row.outlines_m.iter().zip(&stage.poses);
        let corners = blocks.flat_map(|(outline, pose)| {
            let corners = outline.iter();
            corners.flat_map(|corner| [*corner, pose.of(*corner)])
        });
        // Fill and loads hardly move farther than the blocks.
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
            scale: ((width_px - 30.0) / across_m.x).min(width_px / across_m.y),
        })
    }

    fn height_px(&self) -> f64 {
        self.scale * (self.high_m.y - self.low_m.y)
    }

    /// Draws it above the middle of its foot, squeezed to this part.
    fn draw(&self, drawing: &mut Drawing, foot: Vector2<f64>, squeezed: f64) {
        let place = Place {
            middle_m: Vector2::new(0.5 * (self.low_m.x + self.high_m.x), self.low_m.y),
            at: foot,
            scale: squeezed * self.scale,
        };
        let px = |point: Vector2<f64>| place.px(point);
        let view = View {
            scene: self.scene,
            place,
            poses: &self.stage.poses,
            hinges: &[],
            exaggeration: 1.0,
        };
        view.draw_carried(drawing, false);
        view.draw_built(drawing, "");
        view.draw_blocks(drawing, |block, _| (format!("block {}", block + 1), STONE));
        view.draw_ties(drawing);
        if let Some(state) = &self.stage.state {
            let joints = self.row.joints.iter().zip(&state.corners);
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
                let corner_m = self.row.joints[hinge.joint].corner_m(hinge.edge);
                let at = px(self.pose_at(hinge.joint).of(corner_m));
                drawing.circle("hinge", at, HINGE_PX, HINGE);
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
        drawing.label(below, Anchor::Middle, 0.0, text);
    }

    /// The pose of the body whose face a joint lies on: the block after it, or the last block.
    fn pose_at(&self, joint: usize) -> Pose {
        let poses = &self.stage.poses;
        poses[joint.min(poses.len() - 1)]
    }
}
