//! Pictures of mechanisms: incipient rocking, and an impact (Fig. 10 of the paper).

use nalgebra::Vector2;

use super::impact::LinkImpact;
use crate::mechanics::four_link::{ArchLink, ResultantLine, closing_field};
use crate::mechanics::{Edge, MechanismChain as _, Profile};
use crate::output::elevation::{
    BODIES, PUSH_PX, SheetTransform, View, draw_arrow, draw_dimensions, room_px,
};
use crate::output::mechanisms::HINGES;
use crate::output::scene::FARTHEST;
use crate::output::{
    Anchor, Drawing, Figure, Frame, PartHeight, Scene, Sheet, Stroke, Text, color,
};
use crate::scenario::{DimensionSide, Language};
use crate::{FourLinks, Hinge, MechanismModel as _, OpenHinge, Pose, Sway};

/// Fraction of the limit rotation at which a mechanism is drawn, so that it is visibly open.
const DRAWN_PART: f64 = 0.25;
/// Number of parts into which a ring is divided for a line of resultants. Rows of blocks have a point at each joint.
const LINE_PARTS: usize = 720;
/// Space beside an arch for the letter of a hinge at its springing, in pixels.
const LETTER_PX: f64 = 32.0;
/// Space above an arch, for its hinges and a body that rises.
const ABOVE_PX: f64 = 42.0;

/// A structure that rocks as four links.
#[derive(Clone, Copy)]
struct FourLinkStructure<'a> {
    model: &'a FourLinks,
    /// First sway of the chain.
    first: Sway,
    scene: &'a Scene,
}

/// A mechanism at the rotations at which it is drawn.
struct DrawnMechanism<'a> {
    link: &'a ArchLink,
    sway: Sway,
    poses: Vec<Pose>,
    hinges: Vec<OpenHinge>,
}

impl DrawnMechanism<'_> {
    /// Rotations in words.
    fn rotations(&self) -> String {
        let names = ["left", "middle", "right"].iter().zip(&self.poses);
        let all = names.map(|(name, pose)| format!("{name} {:+.3}", pose.rotation_rad()));
        format!("{} rad", all.collect::<Vec<_>>().join(", "))
    }
}

impl<'a> FourLinkStructure<'a> {
    /// Mechanism after this number of impacts, opened for a picture; `None` if an impact before it stops the structure.
    fn drawn_mechanism(&self, impacts: usize) -> Option<DrawnMechanism<'a>> {
        let link = self.model.chain_from(self.first).link(impacts)?;
        let sway = self.first.after(impacts);
        let (mut poses, mut places_m) = (Vec::new(), Vec::new());
        let at = (DRAWN_PART * link.link.limit_rad, sway);
        let mechanism = &link.link.mechanism;
        self.model.place_m(mechanism, at, &mut poses, &mut places_m);
        let hinges = self.model.hinges(impacts, sway).into_iter().zip(places_m);
        Some(DrawnMechanism {
            link,
            sway,
            poses,
            hinges: hinges.map(|(hinge, at_m)| open_at(hinge, at_m)).collect(),
        })
    }

    /// Profile in the frame of a sway to this side.
    fn profile(&self, sway: Sway) -> &'a dyn Profile {
        let chain = self.model.chain_from(self.first);
        chain.profile(usize::from(sway != self.first))
    }

    /// Converts a point from the frame of a sway, which is mirrored for the left side, to metres.
    fn metres(&self, point: Vector2<f64>, sway: Sway) -> Vector2<f64> {
        Vector2::new(sway.sign() * point.x, point.y) * self.model.length_m()
    }

    /// Height at which the structure is drawn, in pixels, if its larger dimension is `width_px`.
    fn height_px(&self, width_px: f64) -> f64 {
        let [low_m, high_m] = self.scene.blocks_m();
        let size_m = high_m - low_m;
        width_px / size_m.amax() * size_m.y
    }

    /// Places the structure around `middle` in a part of the sheet.
    fn place_around(&self, middle: f64, part: Frame) -> PlacedStructure<'a> {
        let place = SheetTransform::over(self.scene.blocks_m(), middle, part);
        PlacedStructure { of: *self, place }
    }
}

fn open_at(hinge: Hinge, position_m: Vector2<f64>) -> OpenHinge {
    OpenHinge { hinge, position_m }
}

/// A structure on the sheet.
struct PlacedStructure<'a> {
    of: FourLinkStructure<'a>,
    place: SheetTransform,
}

impl PlacedStructure<'_> {
    /// Converts a point in the frame of a sway to pixels.
    fn px(&self, point: Vector2<f64>, sway: Sway) -> Vector2<f64> {
        self.place.px(self.of.metres(point, sway))
    }

    fn view<'v>(&'v self, poses: &'v [Pose], hinges: &'v [OpenHinge]) -> View<'v> {
        View::new(self.of.scene, self.place, poses, hinges)
    }

    /// Draws the open mechanism over the structure at rest.
    fn mechanism(&self, drawing: &mut Drawing, open: &DrawnMechanism<'_>) {
        let view = self.view(&open.poses, &open.hinges);
        view.draw_behind(drawing);
        view.draw_built(drawing, "built");
        view.draw_blocks(drawing, |_, body| match body {
            Some(body) => (["left", "middle", "right"][body].to_owned(), BODIES[body]),
            None => ("still".to_owned(), "#eeeeee"),
        });
        view.draw_loads(drawing, None, true);
        view.draw_hinges(drawing);
    }

    /// Draws the hinges with their letters, from left to right. The elements are named `hinge A` and so on, with `mark` after the letter.
    fn hinges(&self, drawing: &mut Drawing, open: &DrawnMechanism<'_>, mark: &str) {
        let profile = self.of.profile(Sway::Right);
        let hinges = open.link.mechanism.hinges_from_left(profile, open.sway);
        for (letter, (section, edge)) in HINGES.into_iter().zip(hinges) {
            let at = self.px(profile.point(section, edge), Sway::Right);
            let name = format!("hinge {letter}{mark}");
            drawing.circle(&name, at, 4.0, Stroke::new(color::VERMILION, 1.8, ""));
            let side = match edge {
                Edge::Intrados => -1.0,
                Edge::Extrados => 1.0,
            };
            let outward = profile.outward_direction(section);
            // A white ground keeps other lines off the letter.
            let named = Text::from(format!("{letter}{mark}"));
            let half = Vector2::new(0.5 * named.px() + 2.0, 7.5);
            let middle = at + Vector2::new(outward.x, -outward.y) * (side * 17.0);
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| middle + half.component_mul(&Vector2::new(x, y)));
            drawing.polygon("paper", corners, "#ffffff", Stroke::new("none", 0.0, ""));
            let text = middle + Vector2::new(0.0, 4.5);
            drawing.label(text, Anchor::Middle, 0.0, named);
        }
    }

    /// Draws a line of resultants in the frame of a sway. Points far outside the structure are moved to a limit.
    fn resultants(&self, drawing: &mut Drawing, name: &str, line: &ResultantLine, sway: Sway) {
        let profile = self.of.profile(sway);
        let points = profile.sections(LINE_PARTS).into_iter().map(|section| {
            let e = line.section(section).eccentricity_ratio;
            let e = if e.is_finite() { e } else { 0.0 };
            let out = profile.thickness(section) * e.clamp(-FARTHEST, FARTHEST);
            let at = profile.middle(section) + profile.outward_direction(section) * out;
            self.px(at, sway)
        });
        drawing.curve(name, points, Stroke::new(color::BLUE, 1.8, ""));
    }

    /// Draws the push that starts the structure, an arrow through the common centre of the masses that it moves.
    fn push(&self, drawing: &mut Drawing) {
        let first = self.of.first;
        let bodies = self.of.model.moving_bodies(first).unwrap_or_default();
        let whole_kg: f64 = bodies.iter().map(|body| body.mass_kg).sum();
        let bodies = bodies.iter();
        let centre_m = bodies.map(|body| body.centre_m * (body.mass_kg / whole_kg));
        let at = self.place.px(centre_m.sum());
        let half = Vector2::new(0.5 * PUSH_PX * first.sign(), 0.0);
        let green = Stroke::new(color::GREEN, 2.2, "");
        draw_arrow(drawing, "push", green, [at - half, at + half]);
        drawing.circle("centre", at, 2.4, Stroke::new(color::BLACK, 1.2, ""));
    }

    /// Draws the bodies into which the mechanisms before and after an impact divide the structure, the impulse line, and the hinges of both.
    fn impact(
        &self,
        drawing: &mut Drawing,
        before: &DrawnMechanism<'_>,
        after: &DrawnMechanism<'_>,
    ) {
        let (sway, seen) = (after.sway, self.of.profile(Sway::Right));
        // Both mechanisms are in the frame of the new one, which is mirrored if it sways left.
        let profile = self.of.profile(sway);
        let closing = closing_field(&before.link.mechanism, profile);
        let field = after.link.mechanism.field();
        let mut cuts: Vec<f64> = closing
            .minus(&field)
            .cuts_rad
            .into_iter()
            .map(|cut| sway.convert_section(profile, cut))
            .collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let hinges: Vec<OpenHinge> = cuts
            .iter()
            .map(|section| {
                let (angle_rad, edge) = (*section, Edge::Intrados);
                let in_ring = Hinge::Section { angle_rad, edge };
                let edge = Some(edge);
                let at_joint = seen.joint(angle_rad);
                let hinge = at_joint.map_or(in_ring, |joint| Hinge::Joint { joint, edge });
                open_at(hinge, Vector2::zeros())
            })
            .collect();
        let (view, greys) = (self.view(&[], &hinges), ["#eeeeee", "#e0e0e0"]);
        view.draw_behind(drawing);
        view.draw_blocks(drawing, |_, body| match body {
            Some(body) => (format!("body {}", body + 1), greys[body % 2]),
            None => ("still".to_owned(), "#ffffff"),
        });
        view.draw_loads(drawing, None, true);
        for (number, ends) in (1..).zip(cuts.windows(2)) {
            let middle = 0.5 * (ends[0] + ends[1]);
            let at = self.number_position(seen, middle) + Vector2::new(0.0, 4.5);
            drawing.label(at, Anchor::Middle, 0.0, format!("{number}"));
        }
        let change = closing.minus(&field.scaled(after.link.link.rate_ratio));
        let line = ResultantLine::through_hinges(profile, &after.link.mechanism, change);
        self.resultants(drawing, "impulse line", &line, sway);
        self.hinges(drawing, after, "'");
        for closed in self.of.scene.hinges(&before.hinges) {
            let at = self.place.px(closed.at_m);
            drawing.circle("hinge before", at, 2.5, Stroke::new(color::GREY, 1.2, ""));
        }
    }

    /// Position of the number of a body: outside the extrados of a ring. In a row it is inside the intrados, midway between two
    /// joints, because buttresses stand behind the extrados.
    fn number_position(&self, profile: &dyn Profile, section: f64) -> Vector2<f64> {
        let out = 30.0 / (self.place.scale * self.of.model.length_m());
        let at = |section: f64, edge: Edge, out: f64| {
            let at = profile.point(section, edge) + profile.outward_direction(section) * out;
            self.px(at, Sway::Right)
        };
        if profile.joint(section).is_none() {
            return at(section, Edge::Extrados, out);
        }
        let at = |section: f64| at(section, Edge::Intrados, -out);
        (at(section.floor()) + at(section.ceil())) * 0.5
    }
}

fn shape(profile: &dyn Profile) -> String {
    // Removes rounding errors.
    let rounded = |value: f64| (value * 1e6).round() / 1e6;
    match profile.joint(profile.end()) {
        Some(blocks) => format!("{blocks} blocks"),
        None => format!(
            "embrace angle {} deg, t/R = {}",
            rounded(profile.end().to_degrees()),
            rounded(profile.thickness(0.0))
        ),
    }
}

/// Draws incipient rocking to one side: the thrust line at `A_L` through its hinges, and the mechanism. The mechanism is to scale, at a quarter
/// of the rotations of its limit position.
pub fn limit(figure: Figure, model: &FourLinks, first: Sway, scene: &Scene) -> String {
    let of = FourLinkStructure {
        model,
        first,
        scene,
    };
    let open = of
        .drawn_mechanism(0)
        .expect("a chain begins with the mechanism that starts");
    let incipient = &model.chain_from(first).incipient;
    let title = format!(
        "Incipient rocking at A_L = {:.5} g; {}",
        incipient.acceleration_g,
        shape(of.profile(Sway::Right))
    );
    let texts = [
        &*format!(
            "Thrust line under gravity and a push of A_L to the {} (green arrow, at the centre of the moving masses); A to D: \
             hinges, circles at the edge about which the arch turns",
            first.name()
        ),
        &*format!(
            "Mechanism, to scale, at rotations (anticlockwise) of {}",
            open.rotations()
        ),
    ];
    let columns = figure.columns(2, 340.0);
    let cell_px = figure.width_px / columns as f64;
    let [left, right] =
        [DimensionSide::Left, DimensionSide::Right].map(|side| room_px(scene, side).max(LETTER_PX));
    let arch_px = of.height_px((0.8 * cell_px).min(cell_px - left - right));
    let mut sheet = Sheet::new(figure, &title);
    for (first_cell, texts) in (0..2).step_by(columns).zip(texts.chunks(columns)) {
        sheet.gap(ABOVE_PX);
        let cells = (first_cell..2).take(columns).zip([0.5, 1.5]);
        let (of, open) = (&of, &open);
        sheet.part(
            PartHeight::Structure(arch_px, arch_px),
            move |drawing, part| {
                for (cell, middle) in cells {
                    let middle = middle * cell_px + 0.5 * (left - right);
                    let placed = of.place_around(middle, part);
                    if cell == 1 {
                        placed.mechanism(drawing, open);
                        continue;
                    }
                    draw_dimensions(drawing, &placed.place, scene, Language::English);
                    let view = placed.view(&[], &[]);
                    view.draw_behind(drawing);
                    view.draw_blocks(drawing, |_, _| ("block".to_owned(), "#f4f4f4"));
                    view.draw_loads(drawing, None, true);
                    placed.resultants(drawing, "thrust line", &incipient.thrust_line, first);
                    placed.push(drawing);
                    placed.hinges(drawing, open, "");
                }
            },
        );
        if first_cell == 0 {
            sheet.gap(room_px(scene, DimensionSide::Below));
        }
        sheet.captions(34.0, texts);
    }
    sheet.gap(12.0);
    sheet.finish()
}

/// Draws an impact as in Fig. 10 of the paper: the mechanisms before and after, the bodies into which both mechanisms divide the ring (Eq. (3)),
/// and the impulse line. `None` if this impact or one before it stops the arch.
pub fn impact(figure: Figure, impact: &LinkImpact<'_>, scene: &Scene) -> Option<String> {
    let of = FourLinkStructure {
        model: impact.model,
        first: impact.first,
        scene,
    };
    let before = of.drawn_mechanism(impact.index.checked_sub(1)?)?;
    let after = of.drawn_mechanism(impact.index)?;
    let title = format!(
        "Impact {}{}: restitution (kinetic energy after/before) r = {:.6}; {}",
        impact.index,
        impact.words_after_number(),
        after.link.link.restitution,
        shape(impact.profile())
    );
    // Narrow pictures have short captions, and dimensions in words.
    let is_wide = figure.columns(2, 340.0) == 2;
    let texts = if is_wide {
        let [old, new] = [&before, &after].map(DrawnMechanism::rotations);
        [
            format!("u before the impact, hinges A to D, drawn at rotations of {old}"),
            format!("u' after the impact, hinges A' to D', drawn at rotations of {new}"),
        ]
    } else {
        ["before: u, hinges A to D", "after: u', hinges A' to D'"].map(str::to_owned)
    };
    let mut sheet = Sheet::new(figure, &title);
    sheet.gap(ABOVE_PX);
    let half_px = 0.5 * figure.width_px;
    let arch_px = of.height_px((0.8 * half_px).min(half_px - 2.0 * LETTER_PX));
    sheet.part(PartHeight::Structure(arch_px, arch_px), |drawing, part| {
        for (open, middle) in [(&before, 0.5), (&after, 1.5)] {
            let placed = of.place_around(middle * half_px, part);
            placed.mechanism(drawing, open);
        }
    });
    sheet.captions(34.0, &[&texts[0], &texts[1]]);
    sheet.gap(ABOVE_PX + 14.0);
    let room = |side| if is_wide { room_px(scene, side) } else { 0.0 };
    let [left, right] = [DimensionSide::Left, DimensionSide::Right].map(room);
    let width_px = (0.71 * figure.width_px).min(figure.width_px - left - right);
    let middle = 0.5 * (figure.width_px + left - right);
    let arch_px = of.height_px(width_px);
    sheet.part(PartHeight::Structure(arch_px, arch_px), |drawing, part| {
        let placed = of.place_around(middle, part);
        if is_wide {
            draw_dimensions(drawing, &placed.place, scene, Language::English);
        }
        placed.impact(drawing, &before, &after);
    });
    let text = if is_wide {
        "Impulse line through the hinges A' to D' of u', at the edges about which the arch turns after the \
         impact; grey circles: the hinges A to D of u, which close; 1, 2 ...: the bodies that both together cut \
         out of the arch"
            .to_owned()
    } else {
        format!(
            "blue: impulse line through A' to D'; grey circles: A to D, which close; 1, 2 ...: bodies that both cut out; {}",
            scene.sizes_in_words()
        )
    };
    sheet.caption(room(DimensionSide::Below) + 34.0, &text);
    sheet.gap(12.0);
    Some(sheet.finish())
}
