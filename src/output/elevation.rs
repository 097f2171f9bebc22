//! Drawing of a structure: blocks with the numbers of their joints, supports, fill and loads, dimensions.

use nalgebra::Vector2;

use super::page::Spot;
use super::scene::{Piece, Scene};
use super::{
    Anchor, Drawing, Figure, Frame, PartHeight, Sheet, Stroke, TEXT_PX, Text, color, text_px,
};
use crate::mechanics::{BodyPoint, HeldMechanism, Sides};
use crate::scenario::{Dimension, DimensionSide, Language, Structure, metres};
use crate::{OpenHinge, Pose, Sway};

/// Colour of blocks.
pub(crate) const STONE: &str = "#f3efe6";
/// Colour of fill.
const FILL: &str = "#e3d5bd";
const OUTLINE: Stroke = Stroke::new(color::BLACK, 1.1, "");
/// Colour of a wall behind the structure.
const WALL: &str = "#c9c9c9";
/// Outline of fill.
const FILL_LINE: Stroke = Stroke::new("#b59f78", 0.6, "");
const DIMENSION: Stroke = Stroke::new("#444444", 0.8, "");
const EXTENSION: Stroke = Stroke::new("#aaaaaa", 0.5, "");
/// Colours of the bodies of a mechanism, from left to right.
pub(crate) const BODIES: [&str; 3] = ["#cfe3f1", "#f6dcc4", "#cce9e0"];
/// Stroke of a tie.
pub(crate) const TIE: Stroke = Stroke::new(color::ORANGE, 1.8, "");
/// Stroke of the undeformed outline of displaced blocks.
const BUILT: Stroke = Stroke::new(color::GREY, 0.7, "3 3");
/// Stroke and radius of the circle at an open hinge.
pub(crate) const HINGE: Stroke = Stroke::new(color::VERMILION, 1.6, "");
/// Stroke of hinges of a second mechanism, that to the left.
const HINGE_TO_THE_LEFT: Stroke = Stroke::new("#6a3d9a", 1.6, "");
pub(crate) const HINGE_PX: f64 = 3.2;
/// Stroke of a thrust line.
const THRUST: Stroke = Stroke::new(color::BLUE, 1.6, "");
const LOAD: Stroke = Stroke::new("#7a3b00", 1.6, "");
/// Stroke of the axes of the frame of reference.
const AXIS: Stroke = Stroke::new(color::BLACK, 1.0, "");
/// Length of an axis.
const AXIS_PX: f64 = 34.0;
/// Stroke of the arrow of the ground acceleration.
const GROUND: Stroke = Stroke::new(color::BLUE, 2.0, "");

/// Distance from the structure to the first line of dimensions.
const BESIDE_PX: f64 = 34.0;
/// Distance between lines of dimensions.
const APART_PX: f64 = 26.0;
/// Length of the arrow of a load.
const ARROW_PX: f64 = 30.0;
/// Length of the arrow of the ground acceleration, or of a push of the ground.
pub(crate) const PUSH_PX: f64 = 46.0;

/// Converts metres to positions on the sheet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetTransform {
    /// A point of the structure.
    pub(crate) middle_m: Vector2<f64>,
    /// Position of that point on the sheet.
    pub(crate) at: Vector2<f64>,
    /// Pixels per metre.
    pub(crate) scale: f64,
}

impl SheetTransform {
    /// Scales a box, in metres, to the height of a part of the sheet, around the horizontal position `middle`.
    pub(crate) fn over([low_m, high_m]: [Vector2<f64>; 2], middle: f64, part: Frame) -> Self {
        Self {
            middle_m: Vector2::new(0.5 * (low_m.x + high_m.x), low_m.y),
            at: Vector2::new(middle, part.top + part.height),
            scale: (part.height / (high_m.y - low_m.y)).max(1e-9),
        }
    }

    /// Returns the position of a point on the sheet.
    pub(crate) fn px(&self, point_m: Vector2<f64>) -> Vector2<f64> {
        let away_m = point_m - self.middle_m;
        self.at + Vector2::new(away_m.x, -away_m.y) * self.scale
    }
}

/// Draws a structure at rest with its dimensions, the numbers of its joints, the axes, the positive ground acceleration, and a text below. On moved
/// supports it is drawn displaced; dashed lines then show the undeformed structure, to which the dimensions refer.
pub fn draw(figure: Figure, title: &str, scene: &Scene, text: &str) -> String {
    draw_hinges(figure, title, (scene, text), &[], &[], &[])
}

/// Draws a structure as [`draw`], with the hinges of its mechanisms, each with its sway and its position in metres, with marks on them, and with a
/// thrust line by its points in metres.
pub(crate) fn draw_hinges(
    figure: Figure,
    title: &str,
    (scene, text): (&Scene, &str),
    hinges_m: &[(Sway, Vector2<f64>)],
    spots: &[Spot],
    thrust_line_m: &[Option<[f64; 2]>],
) -> String {
    let room = |side: DimensionSide| room_px(scene, side).max(24.0);
    let [low_m, high_m] = scene.frame_m();
    let size_m = high_m - low_m;
    let has_none = scene.load_arrows(&[]).is_empty();
    let above_px = if has_none { 6.0 } else { ARROW_PX + 26.0 };
    // Supports extend a little beyond the structure.
    let left_px = room(DimensionSide::Left) + 10.0;
    let width_px = figure.width_px - left_px - (room(DimensionSide::Right) + 10.0);
    let most_px = width_px / size_m.x * size_m.y;
    let mut sheet = Sheet::new(figure, title);
    sheet.gap(12.0 + above_px);
    let height = PartHeight::Structure(figure.height_px(520.0), most_px);
    sheet.part(height, |drawing, part| {
        let (poses, hinges) = &scene.stands;
        let place = SheetTransform::over([low_m, high_m], left_px + 0.5 * width_px, part);
        let view = View::new(scene, place, poses, hinges);
        draw_dimensions(drawing, &view.place, scene, Language::English);
        supports(drawing, &view.place, scene);
        view.draw_behind(drawing);
        if !poses.is_empty() {
            view.draw_built(drawing, "built");
        }
        view.draw_blocks(drawing, |_, _| ("block".to_owned(), STONE));
        view.draw_ties(drawing);
        view.draw_loads(drawing, Some(part.top), true);
        view.draw_hinges(drawing);
        let none = [f64::NAN; 2];
        let thrust_line = thrust_line_m
            .iter()
            .map(|at_m| place.px(at_m.unwrap_or(none).into()));
        drawing.curve("thrust line", thrust_line, THRUST);
        joint_numbers(drawing, &view.place, scene);
        draw_axes(drawing, &view.place, scene, thrust_line_m.is_empty());
        for (index, (sway, at_m)) in hinges_m.iter().enumerate() {
            // Size and colour differ, for prints in grey.
            let line = match sway {
                Sway::Right => HINGE,
                Sway::Left => HINGE_TO_THE_LEFT,
            };
            drawing.circle("hinge", place.px(*at_m), 6.0 + sway.sign(), line);
            if let Some(spot) = spots.get(index) {
                drawing.symbol(place.px(*at_m), &spot.symbol());
            }
        }
    });
    sheet.caption(room(DimensionSide::Below) + 22.0, text);
    sheet.gap(10.0);
    sheet.finish()
}

/// Draws a wall whose top is held, bent by a push to the right and to the left, and marks on its hinges.
pub(crate) fn draw_bent(
    figure: Figure,
    title: &str,
    structure: &Structure,
    mechanisms: &Sides<HeldMechanism>,
    spots: &[Spot],
) -> String {
    let mut sheet = Sheet::new(figure, title);
    sheet.gap(ARROW_PX + 38.0);
    let [low_m, high_m] = Scene::new(structure).frame_m();
    let size_m = high_m - low_m;
    let most_px = 0.4 * figure.width_px / size_m.x * size_m.y;
    let height = PartHeight::Structure(figure.height_px(460.0), most_px);
    sheet.part(height, |drawing, part| {
        for ((sway, held), first) in mechanisms.iter().zip([0, 2]) {
            let scene = Scene::of_row(&held.row, structure);
            let middle = figure.width_px * (0.5 - 0.24 * sway.sign());
            let place = SheetTransform::over(scene.frame_m(), middle, part);
            let bent = held.displaced(held.unstable_rad().map_or(0.0, |end_rad| 0.25 * end_rad));
            let pose = |drum| {
                held.body_of(drum)
                    .map_or(Pose::UNDEFORMED, |body| bent.poses[body])
            };
            let poses: Vec<Pose> = (0..held.row.blocks.len()).map(pose).collect();
            let view = View::new(&scene, place, &poses, &[]);
            view.draw_built(drawing, "built");
            supports(drawing, &place, &scene);
            view.draw_blocks(drawing, |drum, _| match held.body_of(drum) {
                Some(body) => (format!("body {}", body + 1), BODIES[body]),
                None => ("still".to_owned(), STONE),
            });
            view.draw_ties(drawing);
            view.draw_loads(drawing, Some(part.top - 24.0), true);
            for (hinge_m, spot) in bent.hinges_m.iter().zip(first..) {
                drawing.circle("hinge", place.px(*hinge_m), 5.0, HINGE);
                if let Some(spot) = spots.get(spot) {
                    drawing.symbol(place.px(*hinge_m), &spot.symbol());
                }
            }
            let below = Vector2::new(middle, part.top + part.height + 28.0);
            let push = format!("push to the {}", sway.name());
            drawing.label(below, Anchor::Middle, 0.0, push);
        }
    });
    sheet.caption(46.0, BENT);
    sheet.gap(10.0);
    sheet.finish()
}

/// Text below a wall whose top is held.
const BENT: &str = "a quarter of the way to the unstable equilibrium; circles: hinges; dashed: at rest; the top stays on its vertical line";

/// A structure on a sheet, with its bodies at an instant.
pub(crate) struct View<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) place: SheetTransform,
    /// Poses of the bodies; empty for the undeformed structure.
    pub(crate) poses: &'a [Pose],
    /// Open hinges.
    pub(crate) hinges: &'a [OpenHinge],
    /// Factor on the displacements.
    pub(crate) exaggeration: f64,
    /// Outline of the blocks.
    pub(crate) outline: Stroke,
}

impl<'a> View<'a> {
    /// Makes a view of a structure to scale.
    pub(crate) const fn new(
        scene: &'a Scene,
        place: SheetTransform,
        poses: &'a [Pose],
        hinges: &'a [OpenHinge],
    ) -> Self {
        Self {
            scene,
            place,
            poses,
            hinges,
            exaggeration: 1.0,
            outline: OUTLINE,
        }
    }

    /// Returns the position of a point on the sheet.
    pub(crate) fn px(&self, point: &BodyPoint) -> Vector2<f64> {
        self.place
            .px(point.current_position(self.poses, self.exaggeration))
    }

    fn corners(&self, piece: &Piece) -> impl Iterator<Item = Vector2<f64>> {
        let corners = piece.moved(self.poses, self.exaggeration).into_iter();
        corners.map(|corner| self.place.px(corner))
    }

    /// Draws the undeformed blocks with dashed lines.
    pub(crate) fn draw_built(&self, drawing: &mut Drawing, name: &str) {
        for piece in self.scene.pieces(&[]) {
            let outline = piece.outline_m.iter().map(|corner| self.place.px(*corner));
            drawing.polygon(name, outline, "none", BUILT);
        }
    }

    /// Draws the wall behind the structure, and its fill. Blocks are drawn over them, and loads over the blocks.
    pub(crate) fn draw_behind(&self, drawing: &mut Drawing) {
        self.draw_wall(drawing);
        self.draw_fill(drawing);
    }

    /// Draws the wall behind the structure.
    fn draw_wall(&self, drawing: &mut Drawing) {
        if let Some(wall) = self.scene.wall() {
            drawing.polygon("wall behind", self.corners(&wall), WALL, BUILT);
        }
    }

    fn draw_fill(&self, drawing: &mut Drawing) {
        for piece in self.scene.fill(self.hinges) {
            drawing.polygon("fill", self.corners(&piece), FILL, FILL_LINE);
        }
    }

    /// Draws the blocks. `look` returns name and colour of a block, from its index and its body.
    pub(crate) fn draw_blocks(
        &self,
        drawing: &mut Drawing,
        look: impl Fn(usize, Option<usize>) -> (String, &'static str),
    ) {
        for (number, piece) in self.scene.pieces(self.hinges).iter().enumerate() {
            let (name, fill) = look(number, piece.body);
            drawing.polygon(&name, self.corners(piece), fill, self.outline);
        }
    }

    pub(crate) fn draw_ties(&self, drawing: &mut Drawing) {
        for ends in self.scene.ties(self.hinges) {
            drawing.curve("tie", ends.each_ref().map(|end| self.px(end)), TIE);
        }
    }

    pub(crate) fn draw_hinges(&self, drawing: &mut Drawing) {
        for hinge in self.scene.hinges(self.hinges) {
            drawing.circle("hinge", self.px(&hinge), HINGE_PX, HINGE);
        }
    }

    /// Draws arrows for loads, from the height `from` if it is given, with their labels if there is space.
    pub(crate) fn draw_loads(&self, drawing: &mut Drawing, from: Option<f64>, has_labels: bool) {
        let mut farthest = f64::NEG_INFINITY;
        let mut loads = self.scene.load_arrows(self.hinges);
        loads.sort_by(|a, b| a.at.at_m.x.total_cmp(&b.at.at_m.x));
        for load in loads {
            let tip = self.px(&load.at);
            if load.sideways != 0.0 {
                let tail = tip - Vector2::new(load.sideways * ARROW_PX, 0.0);
                draw_arrow(drawing, "load", LOAD, [tail, tip]);
                if has_labels {
                    // A wall and its dimension leave no space at the tail: the label is beyond the other face.
                    let (x, to) = match self.face_before_wall(-load.sideways) {
                        Some(face) => (face + 6.0 * load.sideways, load.sideways),
                        None => (tail.x - 4.0 * load.sideways, -load.sideways),
                    };
                    let anchor = if to > 0.0 { Anchor::Start } else { Anchor::End };
                    drawing.label(Vector2::new(x, tip.y + 4.5), anchor, 0.0, load.label);
                }
                continue;
            }
            let from = from.filter(|_| !load.is_beside);
            let tail = from.map_or(tip.y - 20.0, |top| top - 8.0);
            let tail = Vector2::new(tip.x, tail);
            draw_arrow(drawing, "load", LOAD, [tail, tip]);
            if load.width_m > 0.0 {
                let edge = |side: f64| {
                    let at_m = load.at.at_m + Vector2::new(0.5 * side * load.width_m, 0.0);
                    Vector2::new(self.px(&BodyPoint { at_m, ..load.at }).x, tail.y)
                };
                drawing.curve("load width", [edge(-1.0), edge(1.0)], LOAD);
            }
            if has_labels {
                let text = Text::from(load.label);
                let half = 0.5 * text.px();
                // Labels without space are omitted here; the text below the drawing lists all loads.
                if load.is_beside || tip.x - half > farthest {
                    if !load.is_beside {
                        farthest = tip.x + half + 8.0;
                    }
                    let at = tail - Vector2::new(0.0, 6.0);
                    drawing.label(at, Anchor::Middle, 0.0, text);
                }
            }
        }
    }

    /// Returns the horizontal position of the face opposite to a wall on this side; `None` without a wall there.
    fn face_before_wall(&self, side: f64) -> Option<f64> {
        let wall = self.scene.wall()?;
        let pieces = self.scene.pieces(self.hinges);
        let corners = pieces.iter().flat_map(|piece| self.corners(piece));
        let away = corners.map(|corner| -side * corner.x);
        let face = -side * away.fold(f64::NEG_INFINITY, f64::max);
        let is_beside = |corner: Vector2<f64>| (corner.x - face) * side > 0.0;
        self.corners(&wall).all(is_beside).then_some(face)
    }
}

/// Draws a horizontal or vertical arrow.
pub(crate) fn draw_arrow(
    drawing: &mut Drawing,
    name: &str,
    stroke: Stroke,
    [tail, tip]: [Vector2<f64>; 2],
) {
    drawing.curve(name, [tail, tip], stroke);
    let along = (tip - tail).normalize();
    let barb = |side: f64| tip - along * 7.0 + along.yx().abs() * (4.0 * side);
    drawing.polygon("", [tip, barb(-1.0), barb(1.0)], stroke.color, stroke);
}

/// Draws the axes x and y at the origin, and, if the ground shakes, below it the arrow of its positive acceleration. If the origin is outside the structure, as the
/// centre of a flat arch, the axes are at the nearest point inside, with its coordinates.
fn draw_axes(drawing: &mut Drawing, place: &SheetTransform, scene: &Scene, is_shaken: bool) {
    let [low_m, high_m] = scene.frame_m();
    let at_m = Vector2::zeros().sup(&low_m).inf(&high_m);
    let at = place.px(at_m);
    for (name, along, anchor, label) in [
        ("x", Vector2::x(), Anchor::Start, Vector2::new(5.0, 4.5)),
        ("y", -Vector2::y(), Anchor::Middle, Vector2::new(0.0, -5.0)),
    ] {
        let tip = at + along * AXIS_PX;
        draw_arrow(drawing, &format!("axis {name}"), AXIS, [at, tip]);
        drawing.label(tip + label, anchor, 0.0, name);
    }
    let [x, y] = [at_m.x, at_m.y].map(|at_m| metres(at_m + 0.0));
    let (label, origin) = match at_m.norm() > 1e-9 * (high_m - low_m).norm() {
        true => (Vector2::new(8.0, -8.0), format!("({x}, {y}) m")),
        false => (Vector2::new(6.0, 14.0), "0".to_owned()),
    };
    drawing.label(at + label, Anchor::Start, 0.0, origin);
    if !is_shaken {
        return;
    }
    let tip = Vector2::new(at.x - 12.0, place.px(low_m).y + 13.0);
    let tail = tip - Vector2::new(PUSH_PX, 0.0);
    draw_arrow(drawing, "ground acceleration", GROUND, [tail, tip]);
}

/// Returns the space that the dimensions on a side of a structure need, in pixels.
pub(crate) fn room_px(scene: &Scene, side: DimensionSide) -> f64 {
    let levels = levels(&scene.dimensions);
    let own = scene.dimensions.iter().zip(&levels);
    let own = own.filter(|(dimension, _)| dimension.side == side);
    let lines = own.map(|(_, level)| BESIDE_PX + APART_PX * f64::from(*level) + 20.0);
    lines.fold(0.0, f64::max)
}

/// Draws the dimensions of a structure beside it.
pub(crate) fn draw_dimensions(
    drawing: &mut Drawing,
    place: &SheetTransform,
    scene: &Scene,
    language: Language,
) {
    let levels = levels(&scene.dimensions);
    let [low, high] = scene.frame_m().map(|corner| place.px(corner));
    for (dimension, level) in scene.dimensions.iter().zip(levels) {
        let away = BESIDE_PX + APART_PX * f64::from(level);
        let ends = dimension.ends_m.map(|end| place.px(end));
        let tick = Vector2::new(4.0, -4.0);
        let feet = ends.map(|end| match dimension.side {
            DimensionSide::Below => Vector2::new(end.x, low.y + away),
            DimensionSide::Left => Vector2::new(low.x - away, end.y),
            DimensionSide::Right => Vector2::new(high.x + away, end.y),
        });
        for (end, foot) in ends.into_iter().zip(feet) {
            drawing.line(end, foot, EXTENSION);
            drawing.line(foot - tick, foot + tick, DIMENSION);
        }
        drawing.curve("dimension", feet, DIMENSION);
        let middle = 0.5 * (feet[0] + feet[1]);
        let beside = 5.0;
        let label = dimension.label(language);
        let is_short = (feet[1].x - feet[0].x) < text_px(&label) + 2.0 * beside;
        let outside = Vector2::new(beside + 0.75 * TEXT_PX, 0.0);
        let (at, anchor, turn_deg) = match dimension.side {
            // A text that does not fit between the ends is to their right.
            DimensionSide::Below if is_short => {
                let end = feet[0].sup(&feet[1]);
                (end + Vector2::new(beside + 3.0, 4.5), Anchor::Start, 0.0)
            }
            DimensionSide::Below => (middle - Vector2::new(0.0, beside), Anchor::Middle, 0.0),
            // Vertical texts are on the outer side, where ticks do not reach them.
            DimensionSide::Left => (middle - Vector2::new(beside, 0.0), Anchor::Middle, 90.0),
            DimensionSide::Right => (middle + outside, Anchor::Middle, 90.0),
        };
        drawing.label(at, anchor, turn_deg, label);
    }
}

/// Draws hatched ground under the supports of the structure.
fn supports(drawing: &mut Drawing, place: &SheetTransform, scene: &Scene) {
    let mut faces = scene.supports_m(1.0);
    let [low_m, high_m] = scene.bounds_m();
    if faces.is_empty() {
        faces.push([low_m, Vector2::new(high_m.x, low_m.y)]);
    }
    let centre = place.px(0.5 * (low_m + high_m));
    for face in faces {
        let [a, b] = face.map(|end| place.px(end));
        let along = (b - a).normalize();
        let (from, to) = (a - along * 10.0, b + along * 10.0);
        drawing.curve("support", [from, to], Stroke::new(color::BLACK, 2.0, ""));
        // Away from the structure.
        let across = Vector2::new(-along.y, along.x);
        let away = across * across.dot(&(0.5 * (a + b) - centre)).signum();
        let hatches = ((to - from).norm() / 7.0 - 2.0 / 7.0).ceil() as u32;
        for hatch in 0..hatches {
            let foot = from + along * (2.0 + 7.0 * f64::from(hatch));
            let end = foot + away * 7.0 - along * 5.0;
            drawing.line(foot, end, Stroke::new(color::BLACK, 0.7, ""));
        }
    }
}

/// Returns the line of each dimension, counted from the structure, without overlaps.
fn levels(dimensions: &[Dimension]) -> Vec<u32> {
    let mut levels: Vec<u32> = Vec::new();
    for (index, own) in dimensions.iter().enumerate() {
        let span = |dimension: &Dimension| {
            let [from, to] = dimension.ends_m;
            match dimension.side {
                DimensionSide::Below => [from.x, to.x],
                DimensionSide::Left | DimensionSide::Right => [from.y, to.y],
            }
        };
        let [low, high] = span(own);
        let meets = |other: &Dimension| {
            let [l, h] = span(other);
            let tolerance = 1e-6 * (high - low);
            other.side == own.side && low < h - tolerance && l < high - tolerance
        };
        let taken: Vec<u32> = (0..index)
            .filter(|other| meets(&dimensions[*other]))
            .map(|other| levels[other])
            .collect();
        let free = (0..).find(|level| !taken.contains(level));
        levels.push(free.unwrap_or(0));
    }
    levels
}

/// Draws the numbers of the joints inside the intrados, or left of a column: all, or every second, fifth, tenth and so on if there is not enough
/// space.
fn joint_numbers(drawing: &mut Drawing, place: &SheetTransform, scene: &Scene) {
    let joints = scene.joints_m();
    let last = joints.len().saturating_sub(1);
    let numbers: Vec<(Text, Vector2<f64>)> = joints
        .iter()
        .enumerate()
        .map(|(joint, [intrados_m, extrados_m])| {
            let (inner, outer) = (place.px(*intrados_m), place.px(*extrados_m));
            // Supports extend beyond their faces.
            let is_end = joint == 0 || joint == last;
            let away = (inner - outer).normalize() * if is_end { 22.0 } else { 15.0 };
            (Text::from(joint.to_string()), inner + away)
        })
        .collect();
    let apart = |(text, at): &(Text, Vector2<f64>), (other, to): &(Text, Vector2<f64>)| {
        let wide = 0.5 * (text.px() + other.px()) + 4.0;
        (at.x - to.x).abs() >= wide || (at.y - to.y).abs() >= TEXT_PX
    };
    let of_every = |step: usize| numbers.iter().step_by(step).collect::<Vec<_>>();
    let steps = [1, 2, 5, 10, 20, 50, 100, 200, 500];
    let shown = steps.into_iter().map(of_every).find(|shown| {
        let mut pairs = shown.windows(2);
        pairs.all(|pair| apart(pair[0], pair[1]))
    });
    for (text, at) in shown.unwrap_or_default() {
        let at = at + Vector2::new(0.0, 4.5);
        drawing.label(at, Anchor::Middle, 0.0, text.clone());
    }
}
