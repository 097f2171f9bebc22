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
use crate::output::Figure;
use crate::output::elevation::{
    self, BODIES, FILL, FILL_LINE, draw_dimensions, draw_load, room_px,
};
use crate::output::scene::Scene;
use crate::output::sheet::{Height, Sheet};
use crate::output::svg::{Anchor, Drawing, Stroke, color};
use crate::output::text::Text;
use crate::scenario::DimensionSide;

/// Fraction of the way to the limit position at which a mechanism is drawn, so that it is visibly open.
const DRAWN_PART: f64 = 0.25;

/// Eccentricity, in thicknesses, at which a line of resultants is cut off.
const DRAWN_ECCENTRICITY: f64 = 1.5;

/// Number of parts of a ring between the points of a line of resultants; for a row of blocks the points are the joints.
const LINE_PARTS: usize = 720;

/// A structure and the chain of its mechanisms.
#[derive(Clone, Copy)]
struct Subject<'a> {
    chain: &'a Chain,
    /// First sway of the chain.
    first: Sway,
    /// Fill, loads and dimensions, where these are drawn.
    scene: Option<&'a Scene>,
}

impl<'a> Subject<'a> {
    /// The profile in the frame of a sway to this side.
    fn profile(&self, sway: Sway) -> &'a dyn Profile {
        self.chain.profile(usize::from(sway != self.first))
    }

    /// The height of the structure if it is as wide as that, and no higher than wide.
    fn height_px(&self, width_px: f64) -> f64 {
        let [low, high] = bounds(self.profile(Sway::Right));
        let size = high - low;
        (width_px / size.x).min(width_px / size.y) * size.y
    }

    /// Room for the dimensions on a side, in pixels.
    fn room_px(&self, side: DimensionSide) -> f64 {
        self.scene.map_or(0.0, |scene| room_px(scene, side))
    }

    /// The structure around this middle, from this top, with this height.
    fn place(self, middle: f64, top: f64, height_px: f64) -> Place<'a> {
        let [low, high] = bounds(self.profile(Sway::Right));
        let scale = height_px / (high.y - low.y);
        let middle = middle - scale * 0.5 * (low.x + high.x);
        Place {
            of: self,
            origin: Vector2::new(middle, top + high.y * scale),
            scale,
        }
    }
}

/// The position of a structure of unit size on the sheet.
struct Place<'a> {
    of: Subject<'a>,
    origin: Vector2<f64>,
    /// Pixels per unit of size.
    scale: f64,
}

/// Lower left and upper right corner of a structure at rest.
fn bounds(profile: &dyn Profile) -> [Vector2<f64>; 2] {
    let end = profile.end();
    let Some(outlines) = profile.outlines(0.0, end) else {
        let outer = |section| profile.point(section, Edge::Extrados);
        let lowest = profile.point(0.0, Edge::Intrados).y;
        return [
            Vector2::new(outer(0.0).x, lowest),
            Vector2::new(outer(end).x, outer(0.5 * end).y),
        ];
    };
    let nothing = [f64::INFINITY, f64::NEG_INFINITY].map(Vector2::repeat);
    let corners = outlines.iter().flatten();
    corners.fold(nothing, |[low, high], corner| {
        [low.inf(corner), high.sup(corner)]
    })
}

impl<'a> Place<'a> {
    fn profile(&self, sway: Sway) -> &'a dyn Profile {
        self.of.profile(sway)
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
        let [low, high] = bounds(self.profile(Sway::Right));
        let [low_m, high_m] = scene.blocks_m();
        let per_metre = (high.x - low.x) / (high_m.x - low_m.x);
        (per_metre, low_m, low)
    }

    /// The dimensions of the structure at rest.
    fn dimensions(&self, drawing: &mut Drawing) {
        let Some(scene) = self.of.scene else { return };
        let (per_metre, low_m, low) = self.units(scene);
        let place = elevation::Place {
            middle_m: low_m,
            at: self.px(low, Sway::Right),
            scale: self.scale * per_metre,
        };
        draw_dimensions(drawing, &place, scene);
    }

    /// Draws the fill behind the blocks and the loads, with the mechanism or at rest.
    fn carried(&self, drawing: &mut Drawing, mechanism: Option<(&ArchLink, Sway)>) {
        let Some(scene) = self.of.scene else { return };
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
        let px = |block: usize, at_m: Vector2<f64>| {
            let at = seen(at_m);
            let Some((link, sway)) = mechanism else {
                return self.px(at, Sway::Right);
            };
            let mirrored = Vector2::new(sway.sign() * at.x, at.y);
            let section = match sway {
                Sway::Right => block as f64 + 0.5,
                Sway::Left => profile.end() - (block as f64 + 0.5),
            };
            let before = link.mechanism.hinges_rad.into_iter();
            let before = before.filter(|hinge| *hinge < section).count();
            let pose = before.checked_sub(1).and_then(|body| poses.get(body));
            self.px(pose.map_or(mirrored, |pose| pose.of(mirrored)), sway)
        };
        for (block, outline_m) in &scene.fill_m {
            let outline = outline_m.iter().map(|corner| px(*block, *corner));
            drawing.polygon("fill", outline, FILL, FILL_LINE);
        }
        for load in &scene.loads {
            draw_load(drawing, px(load.block, load.at_m), load.mass_kg);
        }
    }

    /// Draws the joints, if there are voussoirs.
    fn joints(&self, drawing: &mut Drawing) {
        if let HingeSites::Voussoirs(count) = self.of.chain.sites {
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

    /// Draws the open mechanism over the ring at rest.
    fn mechanism(&self, drawing: &mut Drawing, link: &ArchLink, sway: Sway) {
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
        let [left, middle, right] = BODIES;
        let mut looks = [("left", left), ("middle", middle), ("right", right)];
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
            let named = Text::from(named);
            let half = Vector2::new(0.5 * named.px() + 2.0, 7.5);
            let middle = at + away;
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let corners = corners.map(|(x, y)| middle + half.component_mul(&Vector2::new(x, y)));
            drawing.polygon("paper", corners, "#ffffff", Stroke::new("none", 0.0, ""));
            let text = middle + Vector2::new(0.0, 4.5);
            drawing.label(text, Anchor::Middle, 0.0, named);
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

/// The rotations at which a mechanism is drawn, as seen, in words.
fn rotations_text(link: &ArchLink, sway: Sway) -> String {
    let [a, b, c] = link
        .link
        .mechanism
        .rotations(DRAWN_PART * link.link.limit_rad);
    let [left, middle, right] = match sway {
        Sway::Right => [a, b, c],
        Sway::Left => [-c, -b, -a],
    };
    format!("left {left:+.3}, middle {middle:+.3}, right {right:+.3} rad")
}

/// Incipient rocking to one side: the thrust line at `A_L`, through its hinges, and the mechanism. The chain must begin
/// with that sway.
///
/// The mechanism is drawn to scale at finite rotations, at a quarter of the way to its limit position; with a scene also dimensions,
/// fill and loads are drawn.
#[must_use]
pub fn limit(figure: Figure, chain: &Chain, first: Sway, scene: Option<&Scene>) -> String {
    let of = Subject {
        chain,
        first,
        scene,
    };
    let link = chain
        .link(0)
        .expect("a chain begins with the mechanism that starts");
    let incipient = &chain.incipient;
    let title = format!(
        "Incipient rocking at A_L = {:.5} g; {}",
        incipient.acceleration_g,
        shape(chain.profile(0))
    );
    let still = |drawing: &mut Drawing, place: &Place<'_>| {
        place.dimensions(drawing);
        place.carried(drawing, None);
        place.whole(drawing, "#f4f4f4", Stroke::new(color::BLACK, 1.2, ""));
        place.joints(drawing);
        place.resultants(drawing, "thrust line", &incipient.thrust_line, first);
        place.hinges(drawing, link, first, "");
    };
    let texts = [
        format!(
            "Thrust line under gravity and a push of A_L to the {}; A to D: hinges, circles at the edge about which the \
             arch turns",
            first.name()
        ),
        format!(
            "Mechanism, to scale, at rotations (anticlockwise) of {}",
            rotations_text(link, first)
        ),
    ];
    let is_wide = fits_side_by_side(figure);
    let cell_px = figure.width_px / if is_wide { 2.0 } else { 1.0 };
    let [left, right] =
        [DimensionSide::Left, DimensionSide::Right].map(|side| of.room_px(side).max(LETTER_PX));
    let arch_px = of.height_px((0.8 * cell_px).min(cell_px - left - right));
    let shift = 0.5 * (left - right);
    let below_px = of.room_px(DimensionSide::Below);
    let mut sheet = Sheet::new(figure, &title);
    sheet.gap(ABOVE_PX);
    sheet.part(Height::Structure(arch_px, arch_px), |drawing, part| {
        let place = |cell: f64| of.place(cell * cell_px + shift, part.top, part.height);
        still(drawing, &place(0.5));
        if is_wide {
            place(1.5).mechanism(drawing, link, first);
        }
    });
    sheet.gap(below_px);
    if is_wide {
        sheet.captions(34.0, &[&texts[0], &texts[1]]);
    } else {
        sheet.caption(34.0, &texts[0]);
        sheet.gap(ABOVE_PX);
        sheet.part(Height::Structure(arch_px, arch_px), |drawing, part| {
            let place = of.place(0.5 * cell_px + shift, part.top, part.height);
            place.mechanism(drawing, link, first);
        });
        sheet.caption(34.0, &texts[1]);
    }
    sheet.gap(12.0);
    sheet.finish()
}

/// Whether two arches have room for their captions side by side.
fn fits_side_by_side(figure: Figure) -> bool {
    figure.columns(2, 340.0) == 2
}

/// Room beside an arch for the letter of a hinge at its springing, in pixels.
const LETTER_PX: f64 = 32.0;
/// Space above an arch, for its hinges and a body that rises.
const ABOVE_PX: f64 = 42.0;

/// An impact, as in Fig. 10 of the paper: the mechanisms before and after, the bodies into which both together cut the
/// ring (Eq. (3)), and the impulse line. `None` if this impact or one before it stops the arch.
#[must_use]
pub fn impact(figure: Figure, impact: &LinkImpact<'_>, scene: Option<&Scene>) -> Option<String> {
    let (before, after) = (impact.before()?, impact.after()?);
    let of = Subject {
        chain: impact.chain(),
        first: impact.first,
        scene,
    };
    let sway_after = impact.sway();
    let sway_before = sway_after.opposite();
    let title = format!(
        "Impact {}{}: restitution (kinetic energy after/before) r = {:.6}; {}",
        impact.index,
        impact.after_first(),
        after.link.restitution,
        shape(impact.profile())
    );
    // Narrow pictures have short captions, and dimensions in words.
    let is_wide = fits_side_by_side(figure);
    let texts = match is_wide {
        true => {
            let [old, new] = [(before, sway_before), (after, sway_after)].map(|(link, sway)| {
                format!(", drawn at rotations of {}", rotations_text(link, sway))
            });
            [
                format!("u before the impact, hinges A to D{old}"),
                format!("u' after the impact, hinges A' to D'{new}"),
            ]
        }
        false => ["before: u, hinges A to D", "after: u', hinges A' to D'"].map(str::to_owned),
    };
    let mut sheet = Sheet::new(figure, &title);
    sheet.gap(ABOVE_PX);
    let half_px = 0.5 * figure.width_px;
    let arch_px = of.height_px((0.8 * half_px).min(half_px - 2.0 * LETTER_PX));
    sheet.part(Height::Structure(arch_px, arch_px), |drawing, part| {
        let place = |cell: f64| of.place(cell * half_px, part.top, part.height);
        place(0.5).mechanism(drawing, before, sway_before);
        place(1.5).mechanism(drawing, after, sway_after);
    });
    sheet.captions(34.0, &[&texts[0], &texts[1]]);
    sheet.gap(ABOVE_PX + 14.0);
    let [left, right, below] = [
        DimensionSide::Left,
        DimensionSide::Right,
        DimensionSide::Below,
    ]
    .map(|side| if is_wide { of.room_px(side) } else { 0.0 });
    let width_px = (0.71 * figure.width_px).min(figure.width_px - left - right);
    let middle = 0.5 * (figure.width_px + left - right);
    let arch_px = of.height_px(width_px);
    sheet.part(Height::Structure(arch_px, arch_px), |drawing, part| {
        let place = of.place(middle, part.top, part.height);
        if is_wide {
            place.dimensions(drawing);
        }
        place.carried(drawing, None);
        place.impact(drawing, impact, (before, after));
    });
    let text = match scene.map(Scene::sizes_in_words).filter(|_| !is_wide) {
        None => "Impulse line through the hinges A' to D' of u', at the edges about which the arch turns after the \
                 impact; grey circles: the hinges A to D of u, which close; 1, 2 ...: the bodies that both together cut \
                 out of the arch"
            .to_owned(),
        Some(sizes) => format!(
            "blue: impulse line through A' to D'; grey circles: A to D, which close; 1, 2 ...: bodies that both cut out; {sizes}"
        ),
    };
    sheet.caption(below + 34.0, &text);
    sheet.gap(12.0);
    Some(sheet.finish())
}

impl Place<'_> {
    /// Draws the bodies into which both mechanisms of an impact cut the structure, the impulse line, and the hinges of both.
    fn impact(
        &self,
        drawing: &mut Drawing,
        impact: &LinkImpact<'_>,
        (before, after): (&ArchLink, &ArchLink),
    ) {
        let (profile, sway) = (impact.profile(), impact.sway());
        let closing = closing_field(&before.mechanism, profile);
        let field = after.mechanism.field();
        // Everything is in the frame of the new mechanism, which is mirrored if it sways left.
        let cut = closing.minus(&field);
        let mut bounds = [cut.cuts_rad.as_slice(), &[0.0, profile.end()]].concat();
        bounds.sort_by(f64::total_cmp);
        bounds.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let moves =
            |mechanism: [f64; 4], section: f64| mechanism[0] < section && section < mechanism[3];
        let hinges_before = before.mechanism.hinges_rad;
        let [a, b, c, d] = hinges_before.map(|section| profile.end() - section);
        let mut number = 0;
        // Bodies are counted from the left.
        let mut sectors: Vec<&[f64]> = bounds.windows(2).collect();
        if sway == Sway::Left {
            sectors.reverse();
        }
        for pair in sectors {
            let middle = 0.5 * (pair[0] + pair[1]);
            let is_moving =
                moves([d, c, b, a], middle) || moves(after.mechanism.hinges_rad, middle);
            let fill = match (is_moving, number % 2) {
                (false, _) => "#ffffff",
                (true, 0) => "#eeeeee",
                (true, _) => "#e0e0e0",
            };
            number += usize::from(is_moving);
            let name = match is_moving {
                true => format!("body {number}"),
                false => "still".to_owned(),
            };
            let look = (fill, Stroke::new(color::GREY, 0.9, ""));
            let still = (Pose::UNDEFORMED, sway);
            self.sector(drawing, &name, (pair[0], pair[1]), still, look);
            if is_moving {
                let at = self.px(beside(profile, middle, 30.0 / self.scale), sway);
                let at = at + Vector2::new(0.0, 4.5);
                drawing.label(at, Anchor::Middle, 0.0, number.to_string());
            }
        }
        self.whole(drawing, "none", Stroke::new(color::BLACK, 1.2, ""));
        self.joints(drawing);
        let change = closing.minus(&field.scaled(after.link.rate_ratio));
        let line = ResultantLine::through_hinges(profile, &after.mechanism, change);
        self.resultants(drawing, "impulse line", &line, sway);
        self.hinges(drawing, after, sway, "'");
        let seen = self.profile(Sway::Right);
        let closed = before.mechanism.hinges_from_left(seen, sway.opposite());
        for (section, edge) in closed {
            let at = self.px(seen.point(section, edge), Sway::Right);
            drawing.circle("hinge before", at, 2.5, Stroke::new(color::GREY, 1.2, ""));
        }
    }
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
