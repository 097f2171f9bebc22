//! `spread.svg`: the pushes that the arch resists against the movement, and the arch at the end of each path.

use nalgebra::Vector2;

use super::{Push, SpreadPath, SpreadSummary, Stage};
use crate::Row;
use crate::mechanics::BodyPoint;
use crate::output::elevation::{HINGE, HINGE_PX, STONE, SheetTransform, View};
use crate::output::page::Spot;
use crate::output::scene::widened;
use crate::output::{
    Anchor, CURVES, Chart, Drawing, Figure, Frame, Key, Mark, PartHeight, Scene, Sheet, Stroke,
    color,
};

/// Largest number of pictures of the arch side by side.
const COLUMNS: usize = 3;
/// Smallest width of a picture.
const LEAST_PX: f64 = 180.0;
/// Width of the dashed lines of first motions.
const FIRST_MOTION_PX: f64 = 1.0;

/// Draws pushes and arches, with marks for all stages on a page.
pub(super) fn draw(
    figure: Figure,
    title: &str,
    spread: &SpreadSummary,
    (row, scene): (&Row, &Scene),
    spots: &[Spot],
) -> String {
    let mut sheet = Sheet::new(figure, title);
    draw_pushes(figure, spread, spots).add_to(&mut sheet);
    sheet.gap(10.0);
    let columns = figure.columns(spread.paths.len().clamp(1, COLUMNS), LEAST_PX);
    let cell_px = figure.width_px / columns as f64;
    for paths in spread.paths.chunks(columns) {
        let cells: Vec<DeformedArch<'_>> = paths
            .iter()
            .filter_map(|path| DeformedArch::new((row, scene), (spread, path), cell_px))
            .collect();
        let heights_px = cells.iter().map(|cell| cell.height_px);
        let height_px = heights_px.fold(0.0, f64::max);
        let height = PartHeight::Structure(height_px, height_px);
        sheet.part(height, move |drawing, part| {
            for (column, cell) in (0_u32..).zip(cells) {
                let middle = (f64::from(column) + 0.5) * cell_px;
                cell.draw(drawing, middle, part, part.height / height_px);
            }
        });
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

/// Draws the smaller push of both sides against the movement: capacity and first motion.
fn draw_pushes(figure: Figure, spread: &SpreadSummary, spots: &[Spot]) -> Chart {
    let thin = |color| Stroke::new(color, FIRST_MOTION_PX, "3 3");
    let (mut marks, mut keys) = (Vec::new(), Vec::new());
    for (path, stroke) in spread.paths.iter().zip(CURVES.into_iter().cycle()) {
        let direction = path.movement_in_words(&spread.support);
        let solid = Stroke::new(stroke.color, stroke.width, "");
        for (push, stroke) in [
            (Push::Capacity, solid),
            (Push::FirstMotion, thin(stroke.color)),
        ] {
            let points = path
                .stages
                .iter()
                .filter_map(|stage| Some((stage.movement_m, stage.smaller_push(push)?)));
            let name = format!("{}, {direction}", push.name());
            marks.push(Mark::curve(name, stroke, points));
        }
        keys.push(Key::line(direction, solid));
    }
    keys.push(Key::line("dashed: first motion", thin(color::BLACK)));
    let further = if spread.is_further() { "further " } else { "" };
    let movement = format!("{further}movement of the {} (m)", spread.support);
    let mut chart = Chart::around(figure, 300.0, [&movement, "push (g)"], marks);
    let stages = spread.paths.iter().flat_map(|path| &path.stages);
    chart.marks.extend(stages.zip(spots).map(|(stage, spot)| {
        let push_g = stage.smaller_push(Push::Capacity);
        spot.mark((stage.movement_m, push_g.unwrap_or(0.0)))
    }));
    Chart { keys, ..chart }
}

/// The arch at the end of a path.
struct DeformedArch<'a> {
    row: &'a Row,
    scene: &'a Scene,
    path: &'a SpreadPath,
    stage: &'a Stage,
    /// True if the movement is further to that of `[supports]`.
    is_further: bool,
    /// Lower left and upper right corner of the undeformed and the moved arch, in metres.
    bounds_m: [Vector2<f64>; 2],
    height_px: f64,
}

impl<'a> DeformedArch<'a> {
    fn new(
        (row, scene): (&'a Row, &'a Scene),
        (spread, path): (&SpreadSummary, &'a SpreadPath),
        width_px: f64,
    ) -> Option<Self> {
        let stage = path.stages.last()?;
        // Fill and loads hardly move farther than the blocks.
        let blocks = scene.pieces(&[]).into_iter();
        let moved = blocks.flat_map(|block| block.moved(&stage.poses, 1.0));
        let bounds_m = widened(scene.frame_m(), moved);
        let across_m = bounds_m[1] - bounds_m[0];
        let scale = ((width_px - 30.0) / across_m.x).min(width_px / across_m.y);
        Some(Self {
            row,
            scene,
            path,
            stage,
            is_further: spread.is_further(),
            bounds_m,
            height_px: scale * across_m.y,
        })
    }

    /// Draws the arch around `middle` at the bottom of a part, with its height multiplied by `height_factor`.
    fn draw(&self, drawing: &mut Drawing, middle: f64, part: Frame, height_factor: f64) {
        let height = height_factor * self.height_px;
        let top = part.top + part.height - height;
        let own = Frame {
            top,
            height,
            ..part
        };
        let place = SheetTransform::over(self.bounds_m, middle, own);
        let view = View::new(self.scene, place, &self.stage.poses, &[]);
        view.draw_behind(drawing);
        view.draw_built(drawing, "");
        view.draw_blocks(drawing, |block, _| (format!("block {}", block + 1), STONE));
        view.draw_loads(drawing, None, false);
        view.draw_ties(drawing);
        if let Some(state) = &self.stage.state {
            let joints = self.row.joints.iter().zip(&state.corners).enumerate();
            let thrust = joints.filter_map(|(index, (joint, [inner, outer]))| {
                let across = joint.extrados_m - joint.intrados_m;
                let at_m = joint.intrados_m + across * (outer / (inner + outer));
                (inner + outer > 0.0).then(|| view.px(&self.body_point(index, at_m)))
            });
            let stroke = Stroke::new(color::BLUE, 1.6, "");
            drawing.curve("thrust line", thrust, stroke);
            for hinge in &state.hinges {
                let corner_m = self.row.joints[hinge.joint].corner_m(hinge.edge);
                let at = view.px(&self.body_point(hinge.joint, corner_m));
                drawing.circle("hinge", at, HINGE_PX, HINGE);
            }
        }
        let further = if self.is_further { ", further" } else { "" };
        let words = format!("{}{further}", self.path.direction.label());
        let end_m = self.stage.movement_m;
        let text = match (self.path.falls_at_m, &self.path.lost) {
            (Some(at_m), _) => format!("{words} {at_m:.3} m: falls"),
            (None, Some(_)) => format!("{words} {end_m:.3} m: not followed further"),
            (None, None) => format!("{words} {end_m:.3} m: stands"),
        };
        let below = place.at + Vector2::new(0.0, 22.0);
        drawing.label(below, Anchor::Middle, 0.0, text);
    }

    /// Point of the body with the face of a joint: the block after the joint, or the last block.
    fn body_point(&self, joint: usize, at_m: Vector2<f64>) -> BodyPoint {
        let body = Some(joint.min(self.stage.poses.len() - 1));
        BodyPoint { body, at_m }
    }
}
