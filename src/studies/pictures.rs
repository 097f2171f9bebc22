//! Pictures of mechanisms: incipient rocking, and an impact (Fig. 10 of the paper).

use std::fmt::Write as _;

use nalgebra::Vector2;

use super::impact::LinkImpact;
use crate::mechanics::chain::Mechanism as _;
use crate::mechanics::four_link::chain::{ArchLink, Chain};
use crate::mechanics::four_link::impact::closing_field;
use crate::mechanics::four_link::mechanism::HingeSites;
use crate::mechanics::four_link::resultant::ResultantLine;
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::geometry::profile::Profile;
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::sway::Sway;
use crate::output::elevation::{self, FILL, FILL_LINE, draw_dimensions, draw_load, room_px};
use crate::output::figure::text_px;
use crate::output::scene::Scene;
use crate::output::svg::{Anchor, Drawing, Figure, Stroke, color};
use crate::scenario::DimensionSide;

/// Fraction of the way to the limit position at which a mechanism is drawn, so that it is visibly open.
const DRAWN_PART: f64 = 0.25;

/// Eccentricity, in thicknesses, at which a line of resultants is cut off.
const DRAWN_ECCENTRICITY: f64 = 1.5;

/// Number of parts of a ring between the points of a line of resultants; for a row of blocks the points are the joints.
const LINE_PARTS: usize = 720;

/// The position of a structure of unit size on the sheet.
struct Place<'a> {
    chain: &'a Chain,
    /// First sway of the chain.
    first: Sway,
    origin: Vector2<f64>,
    /// Pixels per unit of size.
    scale: f64,
    /// Lowest point of the structure at rest.
    bottom: f64,
    /// What the structure carries, where that is drawn.
    scene: Option<&'a Scene>,
}

/// Left, lower, right and upper bounds of a structure at rest.
fn bounds(profile: &dyn Profile) -> [f64; 4] {
    let end = profile.end();
    let Some(outlines) = profile.outlines(0.0, end) else {
        let outer = |section| profile.point(section, Edge::Extrados);
        let lowest = profile.point(0.0, Edge::Intrados).y;
        return [outer(0.0).x, lowest, outer(end).x, outer(0.5 * end).y];
    };
    let corners = outlines.iter().flatten();
    let nothing = [1.0, 1.0, -1.0, -1.0].map(|sign| sign * f64::INFINITY);
    corners.fold(nothing, |[left, low, right, high], corner| {
        [
            left.min(corner.x),
            low.min(corner.y),
            right.max(corner.x),
            high.max(corner.y),
        ]
    })
}

impl<'a> Place<'a> {
    /// Fits the structure into a rectangle of that width, no higher than wide, with the crown at `top`.
    fn new(
        (chain, scene): (&'a Chain, Option<&'a Scene>),
        first: Sway,
        middle: f64,
        top: f64,
        width: f64,
    ) -> Self {
        let mut place = Self {
            chain,
            first,
            origin: Vector2::zeros(),
            scale: 1.0,
            bottom: 0.0,
            scene,
        };
        let [left, low, right, high] = bounds(place.profile(Sway::Right));
        place.scale = (width / (right - left)).min(width / (high - low));
        let middle = middle - place.scale * 0.5 * (left + right);
        place.origin = Vector2::new(middle, top + high * place.scale);
        place.bottom = place.origin.y - place.scale * low;
        place
    }

    /// The profile in the frame of a sway to this side.
    fn profile(&self, sway: Sway) -> &'a dyn Profile {
        self.chain.profile(usize::from(sway != self.first))
    }

    /// The place on the sheet of a point in the frame of a sway to this side; the frame of a sway to the left is mirrored.
    fn px(&self, point: Vector2<f64>, sway: Sway) -> Vector2<f64> {
        self.origin + Vector2::new(sway.sign() * point.x, -point.y) * self.scale
    }

    /// Draws a displaced sector.
    fn sector(
        &self,
        drawing: &mut Drawing,
        name: &str,
        (from, to): (f64, f64),
        (pose, sway): (Pose, Sway),
        (fill, stroke): (&str, Stroke),
    ) {
        if to - from < 1e-9 {
            return;
        }
        let profile = self.profile(sway);
        let px = |point: Vector2<f64>| {
            let point = self.px(pose.of(point), sway);
            format!("{:.3} {:.3}", point.x, point.y)
        };
        let mut path = String::new();
        if let Some(outlines) = profile.outlines(from, to) {
            for outline in outlines {
                let corners: Vec<String> = outline.iter().map(|corner| px(*corner)).collect();
                let _ = write!(path, "M{}Z", corners.join("L"));
            }
        } else {
            let corner = |section: f64, edge: Edge| px(profile.point(section, edge));
            let radius = |edge: Edge| profile.point(from, edge).norm() * self.scale;
            // In a mirror image the arcs turn the other way.
            let (there, back) = match sway {
                Sway::Right => (1, 0),
                Sway::Left => (0, 1),
            };
            let (inner, outer) = (radius(Edge::Intrados), radius(Edge::Extrados));
            let _ = write!(
                path,
                "M{}A{inner:.3} {inner:.3} 0 0 {there} {}L{}A{outer:.3} {outer:.3} 0 0 {back} {}Z",
                corner(from, Edge::Intrados),
                corner(to, Edge::Intrados),
                corner(to, Edge::Extrados),
                corner(from, Edge::Extrados),
            );
        }
        drawing.path(name, &path, fill, stroke);
    }

    /// Profiles have units of their own: how many a metre has, and the lower left corner of the structure in metres and in them.
    fn units(&self, scene: &Scene) -> (f64, Vector2<f64>, Vector2<f64>) {
        let [left, low, right, _] = bounds(self.profile(Sway::Right));
        let [low_m, high_m] = scene.blocks_m();
        let per_metre = (right - left) / (high_m.x - low_m.x);
        (per_metre, low_m, Vector2::new(left, low))
    }

    /// The dimensions of the structure at rest.
    fn dimensions(&self, drawing: &mut Drawing) {
        let Some(scene) = self.scene else { return };
        let (per_metre, low_m, low) = self.units(scene);
        let place = elevation::Place {
            middle_m: low_m,
            at: self.px(low, Sway::Right),
            scale: self.scale * per_metre,
        };
        draw_dimensions(drawing, &place, scene);
    }

    /// What the structure carries: the fill behind its blocks, and its loads; with the mechanism as it is drawn, or at rest.
    fn carried(&self, drawing: &mut Drawing, mechanism: Option<(&ArchLink, Sway)>) {
        let Some(scene) = self.scene else { return };
        let profile = self.profile(Sway::Right);
        let (per_metre, low_m, low) = self.units(scene);
        let seen = |at_m: Vector2<f64>| (at_m - low_m) * per_metre + low;
        let mut poses = Vec::new();
        if let Some((link, _)) = mechanism {
            let q_rad = DRAWN_PART * link.link.limit_rad;
            link.link
                .mechanism
                .place(q_rad, &mut poses, &mut Vec::new());
        }
        let px = |block: Option<usize>, at_m: Vector2<f64>| {
            let Some((link, sway)) = mechanism else {
                return self.px(seen(at_m), Sway::Right);
            };
            let at = seen(at_m);
            let mirrored = Vector2::new(sway.sign() * at.x, at.y);
            let section = block.map_or(0.0, |block| block as f64 + 0.5);
            let section = match sway {
                Sway::Right => section,
                Sway::Left => profile.end() - section,
            };
            let before = link.mechanism.hinges_rad.into_iter();
            let before = before.filter(|hinge| *hinge < section).count();
            let pose = before.checked_sub(1).and_then(|body| poses.get(body));
            self.px(pose.map_or(mirrored, |pose| pose.of(mirrored)), sway)
        };
        for piece in scene.fill_of_blocks() {
            let corners = piece.outline_m.iter();
            let outline = corners.map(|corner| px(piece.body, *corner));
            drawing.polygon("fill", outline, FILL, FILL_LINE);
        }
        for (mark, load) in scene.loads_of_blocks() {
            draw_load(drawing, px(mark.body, mark.at_m), load.mass_kg);
        }
    }

    /// Draws the joints, if there are voussoirs.
    fn joints(&self, drawing: &mut Drawing) {
        if let HingeSites::Voussoirs(count) = self.chain.sites {
            let profile = self.profile(Sway::Right);
            for section in profile.sections(count) {
                let [inner, outer] = [Edge::Intrados, Edge::Extrados]
                    .map(|edge| self.px(profile.point(section, edge), Sway::Right));
                let stroke = Stroke::new(color::GREY, 0.8, "");
                drawing.curve("joint", [inner, outer], stroke);
            }
        }
    }

    fn whole(&self, drawing: &mut Drawing, fill: &str, stroke: Stroke) {
        let all = (0.0, self.profile(Sway::Right).end());
        let still = (Pose::UNDEFORMED, Sway::Right);
        self.sector(drawing, "ring", all, still, (fill, stroke));
    }

    /// Draws the open mechanism over the ring at rest; returns the rotations drawn, as seen.
    fn mechanism(&self, drawing: &mut Drawing, link: &ArchLink, sway: Sway) -> [f64; 3] {
        self.carried(drawing, Some((link, sway)));
        self.whole(drawing, "none", Stroke::new(color::GREY, 0.8, "3 3"));
        let linkage = &link.link.mechanism;
        let q_rad = DRAWN_PART * link.link.limit_rad;
        let (mut poses, mut hinges) = (Vec::new(), Vec::new());
        linkage.place(q_rad, &mut poses, &mut hinges);
        let [a, b, c, d] = link.mechanism.hinges_rad;
        let none = Pose::UNDEFORMED;
        let line = Stroke::new(color::BLACK, 1.2, "");
        // In the mirrored frame of a sway to the left, the first body is the one on the right.
        let mut looks = [
            ("left", "#cfe3f1"),
            ("middle", "#f6dcc4"),
            ("right", "#cce9e0"),
        ];
        if sway == Sway::Left {
            looks.reverse();
        }
        let still = ("still", "#eeeeee");
        for ((name, fill), bounds, pose) in [
            (still, (0.0, a), none),
            (looks[0], (a, b), poses[0]),
            (looks[1], (b, c), poses[1]),
            (looks[2], (c, d), poses[2]),
            (still, (d, self.profile(sway).end()), none),
        ] {
            self.sector(drawing, name, bounds, (pose, sway), (fill, line));
        }
        for hinge in hinges {
            let stroke = Stroke::new(color::VERMILION, 1.6, "");
            drawing.circle("moved hinge", self.px(hinge, sway), 3.5, stroke);
        }
        let rotations = linkage.rotations(q_rad);
        match sway {
            Sway::Right => rotations,
            Sway::Left => {
                let [left, middle, right] = rotations;
                [-right, -middle, -left]
            }
        }
    }

    /// Draws the hinges with their letters, from the left. They are named `hinge A` and so on, with `mark` after the letter.
    fn hinges(&self, drawing: &mut Drawing, link: &ArchLink, sway: Sway, mark: &str) {
        let profile = self.profile(Sway::Right);
        let hinges = link.mechanism.hinges_from_left(profile, sway);
        for (letter, (section, edge)) in ["A", "B", "C", "D"].into_iter().zip(hinges) {
            let at = self.px(profile.point(section, edge), Sway::Right);
            drawing.circle(
                &format!("hinge {letter}{mark}"),
                at,
                4.0,
                Stroke::new(color::VERMILION, 1.8, ""),
            );
            let side = match edge {
                Edge::Intrados => -1.0,
                Edge::Extrados => 1.0,
            };
            let outward = profile.outward(section);
            let away = Vector2::new(outward.x, -outward.y) * (side * 17.0);
            let named = format!("{letter}{mark}");
            // On white, so that no line strikes it through.
            let half = Vector2::new(0.5 * text_px(&named) + 2.0, 7.5);
            let middle = at + away;
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let corners = corners.map(|(x, y)| middle + half.component_mul(&Vector2::new(x, y)));
            drawing.polygon("paper", corners, "#ffffff", Stroke::new("none", 0.0, ""));
            let text = middle + Vector2::new(0.0, 4.5);
            drawing.label(text, Anchor::Middle, 0.0, &named);
        }
    }

    /// Draws a line of resultants in the frame of a sway, cut off far outside the structure.
    fn resultants(&self, drawing: &mut Drawing, name: &str, line: &ResultantLine, sway: Sway) {
        let profile = self.profile(sway);
        let points = profile.sections(LINE_PARTS).into_iter().map(|section| {
            let e = line.section(section).eccentricity_ratio;
            let e = if e.is_finite() { e } else { 0.0 };
            let e = e.clamp(-DRAWN_ECCENTRICITY, DRAWN_ECCENTRICITY);
            let out = profile.outward(section) * (e * profile.thickness(section));
            self.px(profile.middle(section) + out, sway)
        });
        drawing.curve(name, points, Stroke::new(color::BLUE, 1.8, ""));
    }
}

fn shape(profile: &dyn Profile) -> String {
    match profile.joint(profile.end()) {
        Some(blocks) => format!("{blocks} blocks"),
        None => format!(
            "embrace angle {} deg, t/R = {}",
            rounded(profile.end().to_degrees()),
            rounded(profile.thickness(0.0))
        ),
    }
}

/// A number without rounding errors, for people.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

fn rotations_text([left, middle, right]: [f64; 3]) -> String {
    format!("left {left:+.3}, middle {middle:+.3}, right {right:+.3} rad")
}

/// Incipient rocking to one side: the thrust line at `A_L`, through its hinges, and the mechanism. The chain must begin
/// with that sway.
///
/// The mechanism is drawn to scale at finite rotations, at a quarter of the way to its limit position; of a scene, with its
/// dimensions and what it carries.
#[must_use]
pub fn limit(figure: Figure, chain: &Chain, first: Sway, scene: Option<&Scene>) -> String {
    figure.fitted(|figure| draw_limit(figure, chain, first, scene))
}

fn draw_limit(figure: Figure, chain: &Chain, first: Sway, scene: Option<&Scene>) -> String {
    let link = chain
        .link(0)
        .expect("a chain begins with the mechanism that starts");
    let mut drawing = Drawing::new(figure);
    let incipient = &chain.incipient;
    let title = format!(
        "Incipient rocking at A_L = {:.5} g; {}",
        incipient.acceleration_g,
        shape(chain.profile(0))
    );
    let top = drawing.title(&title);
    let cells = Cells::new(figure, (chain, scene), first);

    let (left, middle) = cells.first(top);
    left.dimensions(&mut drawing);
    left.carried(&mut drawing, None);
    left.whole(&mut drawing, "#f4f4f4", Stroke::new(color::BLACK, 1.2, ""));
    left.joints(&mut drawing);
    left.resultants(&mut drawing, "thrust line", &incipient.thrust_line, first);
    left.hinges(&mut drawing, link, first, "");
    let text = format!(
        "Thrust line under gravity and a push of A_L to the {}; A to D: hinges, circles at the edge about which the arch \
         turns",
        first.name()
    );
    let below = left.bottom + sizes_px(scene, DimensionSide::Below);
    let first_end = cells.caption(&mut drawing, middle, below, &text);

    let (right, middle) = cells.second(top, first_end);
    let rotations = right.mechanism(&mut drawing, link, first);
    let text = format!(
        "Mechanism, to scale, at rotations (anticlockwise) of {}",
        rotations_text(rotations)
    );
    let end = cells.caption(&mut drawing, middle, right.bottom, &text);
    drawing.finish(end.max(first_end) + 12.0)
}

/// Two arches side by side, or one below the other if there is not enough room.
struct Cells<'a> {
    figure: Figure,
    chain: (&'a Chain, Option<&'a Scene>),
    /// First sway of the chain.
    first: Sway,
    /// Width of a cell in pixels.
    width: f64,
    /// Room on the left and the right of an arch for its dimensions, in pixels.
    beside: [f64; 2],
    side_by_side: bool,
}

/// Room for the dimensions on a side, in pixels.
fn sizes_px(scene: Option<&Scene>, side: DimensionSide) -> f64 {
    scene.map_or(0.0, |scene| room_px(scene, side))
}

/// Room beside an arch for the letter of a hinge at its springing, in pixels.
const LETTER_PX: f64 = 32.0;
/// Space above an arch, for its hinges and a body that rises.
const ABOVE_PX: f64 = 42.0;

impl<'a> Cells<'a> {
    /// Whether two arches have room for their captions side by side.
    fn fit_side_by_side(figure: Figure) -> bool {
        figure.columns(2, 340.0) == 2
    }

    /// Two arches side by side, however narrow.
    fn pair(figure: Figure, chain: (&'a Chain, Option<&'a Scene>), first: Sway) -> Self {
        Self {
            figure,
            chain,
            first,
            width: 0.5 * figure.width_px(),
            beside: [0.0; 2],
            side_by_side: true,
        }
    }

    /// With room for dimensions beside the first.
    fn new(figure: Figure, chain: (&'a Chain, Option<&'a Scene>), first: Sway) -> Self {
        let side_by_side = Self::fit_side_by_side(figure);
        Self {
            figure,
            chain,
            first,
            width: figure.width_px() / if side_by_side { 2.0 } else { 1.0 },
            beside: [DimensionSide::Left, DimensionSide::Right].map(|side| sizes_px(chain.1, side)),
            side_by_side,
        }
    }

    /// The place of the first arch, below `top`, and the middle of its cell.
    fn first(&self, top: f64) -> (Place<'a>, f64) {
        self.place(0.5 * self.width, top)
    }

    fn place(&self, middle: f64, top: f64) -> (Place<'a>, f64) {
        let [left, right] = self.beside.map(|room_px| room_px.max(LETTER_PX));
        let width = (0.8 * self.width).min(self.width - left - right);
        let width = self.figure.squeezed_px(width);
        let shifted = middle + 0.5 * (left - right);
        let place = Place::new(self.chain, self.first, shifted, top + ABOVE_PX, width);
        (place, middle)
    }

    /// The same for the second arch, when the first ends at `first_end`.
    fn second(&self, top: f64, first_end: f64) -> (Place<'a>, f64) {
        if self.side_by_side {
            self.place(1.5 * self.width, top)
        } else {
            self.place(0.5 * self.width, first_end)
        }
    }

    /// Writes text below an arch; returns the position of its lower end.
    fn caption(&self, drawing: &mut Drawing, middle: f64, bottom: f64, text: &str) -> f64 {
        let at = Vector2::new(middle, bottom + 34.0);
        drawing.caption_at(at, self.width - 16.0, text)
    }
}

/// An impact, as in Fig. 10 of the paper: the mechanisms before and after, the bodies into which both together cut the
/// ring (Eq. (3)), and the impulse line. `None` if this impact or one before it stops the arch.
#[must_use]
pub fn impact(figure: Figure, impact: &LinkImpact<'_>, scene: Option<&Scene>) -> Option<String> {
    let (before, after) = (impact.before()?, impact.after()?);
    Some(figure.fitted(|figure| draw_impact(figure, impact, scene, (before, after))))
}

fn draw_impact(
    figure: Figure,
    impact: &LinkImpact<'_>,
    scene: Option<&Scene>,
    (before, after): (&ArchLink, &ArchLink),
) -> String {
    let (chain, first, index) = (impact.chain(), impact.first, impact.index);
    let (profile, sway_after) = (impact.profile(), impact.sway());
    let sway_before = sway_after.opposite();
    let mut drawing = Drawing::new(figure);
    let title = format!(
        "Impact {index}{}: restitution (kinetic energy after/before) r = {:.6}; {}",
        impact.after_first(),
        after.link.restitution,
        shape(profile)
    );
    let top = drawing.title(&title);
    // Narrow pictures have short captions, and dimensions in words.
    let wide = Cells::fit_side_by_side(figure);
    let cells = Cells::pair(figure, (chain, scene), first);
    let caption = |text: &str, mark: &str, rotations: [f64; 3]| {
        let rotations = match wide {
            true => format!(", drawn at rotations of {}", rotations_text(rotations)),
            false => String::new(),
        };
        format!("{text}, hinges A{mark} to D{mark}{rotations}")
    };
    let (place, middle) = cells.first(top);
    let rotations = place.mechanism(&mut drawing, before, sway_before);
    let text = caption(
        if wide {
            "u before the impact"
        } else {
            "before: u"
        },
        "",
        rotations,
    );
    let first_end = cells.caption(&mut drawing, middle, place.bottom, &text);
    let (place, middle) = cells.second(top, first_end);
    let rotations = place.mechanism(&mut drawing, after, sway_after);
    let text = caption(
        if wide {
            "u' after the impact"
        } else {
            "after: u'"
        },
        "'",
        rotations,
    );
    let second_end = cells.caption(&mut drawing, middle, place.bottom, &text);

    let lower_top = first_end.max(second_end) + ABOVE_PX + 14.0;
    let [left, right, below] = [
        DimensionSide::Left,
        DimensionSide::Right,
        DimensionSide::Below,
    ]
    .map(|side| sizes_px(scene.filter(|_| wide), side));
    let width = (0.71 * figure.width_px()).min(figure.width_px() - left - right);
    let width = figure.squeezed_px(width);
    let middle = 0.5 * (figure.width_px() + left - right);
    let place = Place::new((chain, scene), first, middle, lower_top, width);
    if wide {
        place.dimensions(&mut drawing);
    }
    place.carried(&mut drawing, None);
    let closing = closing_field(&before.mechanism, profile);
    let field = after.mechanism.field();
    // Everything is in the frame of the new mechanism, which is mirrored if it sways left.
    let cut = closing.minus(&field);
    let mut bounds = [cut.cuts_rad.as_slice(), &[0.0, profile.end()]].concat();
    bounds.sort_by(f64::total_cmp);
    bounds.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let moves =
        |mechanism: [f64; 4], section: f64| mechanism[0] < section && section < mechanism[3];
    let hinges_before = before
        .mechanism
        .hinges_rad
        .map(|section| profile.end() - section);
    let [a, b, c, d] = hinges_before;
    let mut number = 0;
    // Bodies are counted from the left.
    let mut sectors: Vec<&[f64]> = bounds.windows(2).collect();
    if sway_after == Sway::Left {
        sectors.reverse();
    }
    for pair in sectors {
        let (from, to) = (pair[0], pair[1]);
        let middle = 0.5 * (from + to);
        let moving = moves([d, c, b, a], middle) || moves(after.mechanism.hinges_rad, middle);
        let fill = match (moving, number % 2) {
            (false, _) => "#ffffff",
            (true, 0) => "#eeeeee",
            (true, _) => "#e0e0e0",
        };
        let name = if moving {
            number += 1;
            format!("body {number}")
        } else {
            "still".to_owned()
        };
        place.sector(
            &mut drawing,
            &name,
            (from, to),
            (Pose::UNDEFORMED, sway_after),
            (fill, Stroke::new(color::GREY, 0.9, "")),
        );
        if moving {
            let at = place.px(beside(profile, middle, 30.0 / place.scale), sway_after);
            let at = at + Vector2::new(0.0, 4.5);
            drawing.label(at, Anchor::Middle, 0.0, &number.to_string());
        }
    }
    place.whole(&mut drawing, "none", Stroke::new(color::BLACK, 1.2, ""));
    place.joints(&mut drawing);
    let change = closing.minus(&field.scaled(after.link.rate_ratio));
    let line = ResultantLine::through_hinges(profile, &after.mechanism, change);
    place.resultants(&mut drawing, "impulse line", &line, sway_after);
    place.hinges(&mut drawing, after, sway_after, "'");
    let seen = place.profile(Sway::Right);
    for (section, edge) in before.mechanism.hinges_from_left(seen, sway_before) {
        let at = place.px(seen.point(section, edge), Sway::Right);
        drawing.circle("hinge before", at, 2.5, Stroke::new(color::GREY, 1.2, ""));
    }
    let text = match scene.map(Scene::sizes_in_words).filter(|_| !wide) {
        None => "Impulse line through the hinges A' to D' of u', at the edges about which the arch turns after the \
                 impact; grey circles: the hinges A to D of u, which close; 1, 2 ...: the bodies that both together cut \
                 out of the arch"
            .to_owned(),
        Some(sizes) => format!(
            "blue: impulse line through A' to D'; grey circles: A to D, which close; 1, 2 ...: bodies that both cut out; {sizes}"
        ),
    };
    let end = drawing.caption(place.bottom + below + 34.0, &text);
    drawing.finish(end + 12.0)
}

/// The place for the number of a body: for a ring, at a distance outside the extrados. For a row, at a distance inside
/// the intrados, because buttresses stand behind the extrados, and midway between the joints on either side.
fn beside(profile: &dyn Profile, section: f64, distance: f64) -> Vector2<f64> {
    let at = |section: f64, edge: Edge, out: f64| {
        profile.point(section, edge) + profile.outward(section) * out
    };
    if profile.joint(section).is_none() {
        return at(section, Edge::Extrados, distance);
    }
    let at = |section: f64| at(section, Edge::Intrados, -distance);
    (at(section.floor()) + at(section.ceil())) * 0.5
}
