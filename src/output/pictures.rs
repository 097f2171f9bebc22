//! Pictures of mechanisms: incipient rocking, and an impact (Fig. 10 of the paper).

use nalgebra::Vector2;

use super::impact;
use super::svg::{Anchor, Drawing, Figure, Stroke, color};
use crate::mechanics::chain::Mechanism as _;
use crate::mechanics::four_link::chain::{ArchLink, Chain};
use crate::mechanics::four_link::impact::closing_field;
use crate::mechanics::four_link::mechanism::HingeSites;
use crate::mechanics::four_link::resultant::ResultantLine;
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::geometry::ring::{Edge, Ring};
use crate::mechanics::sway::Sway;

/// Part of the way to its limit position at which a mechanism is drawn, so that one sees it open.
const DRAWN_PART: f64 = 0.25;

/// Eccentricity, in parts of the thickness, beyond which a line of resultants is cut off.
const DRAWN_ECCENTRICITY: f64 = 1.5;

/// Places a ring of unit mean radius on the sheet.
struct Place {
    ring: Ring,
    center: Vector2<f64>,
    /// Pixels per mean radius.
    scale: f64,
}

impl Place {
    /// In a rectangle of that width, with the crown at `top`.
    fn new(ring: &Ring, middle: f64, top: f64, width: f64) -> Self {
        let outer = ring.radius(Edge::Extrados);
        let half = outer * (0.5 * ring.embrace_rad()).sin();
        let scale = 0.5 * width / half;
        Self {
            ring: *ring,
            center: Vector2::new(middle, top + outer * scale),
            scale,
        }
    }

    /// On the sheet, for a sway to that side, whose mirror image the coordinates are in.
    fn px(&self, point: Vector2<f64>, sway: Sway) -> Vector2<f64> {
        self.center + Vector2::new(sway.sign() * point.x, -point.y) * self.scale
    }

    /// Lowest point of the ring at rest.
    fn bottom(&self) -> f64 {
        let inner = self.ring.radius(Edge::Intrados);
        self.center.y - self.scale * inner * self.ring.radial(0.0).y
    }

    /// A sector, displaced.
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
        let corner = |angle: f64, edge: Edge| {
            let point = self.px(pose.of(self.ring.point(angle, edge)), sway);
            format!("{:.3} {:.3}", point.x, point.y)
        };
        let radius = |edge: Edge| self.ring.radius(edge) * self.scale;
        // Seen in a mirror the arcs turn the other way.
        let (there, back) = match sway {
            Sway::Right => (1, 0),
            Sway::Left => (0, 1),
        };
        let (inner, outer) = (radius(Edge::Intrados), radius(Edge::Extrados));
        let path = format!(
            "M{}A{inner:.3} {inner:.3} 0 0 {there} {}L{}A{outer:.3} {outer:.3} 0 0 {back} {}Z",
            corner(from, Edge::Intrados),
            corner(to, Edge::Intrados),
            corner(to, Edge::Extrados),
            corner(from, Edge::Extrados),
        );
        drawing.path(name, &path, fill, stroke);
    }

    /// The joints, where there are voussoirs.
    fn joints(&self, drawing: &mut Drawing, sites: HingeSites) {
        if let HingeSites::Voussoirs(count) = sites {
            for angle_rad in self.ring.sections(count) {
                let [inner, outer] = [Edge::Intrados, Edge::Extrados]
                    .map(|edge| self.px(self.ring.point(angle_rad, edge), Sway::Right));
                let stroke = Stroke::new(color::GREY, 0.8, "");
                drawing.curve("joint", [inner, outer], stroke);
            }
        }
    }

    fn whole(&self, drawing: &mut Drawing, fill: &str, stroke: Stroke) {
        let (all, still) = (
            (0.0, self.ring.embrace_rad()),
            (Pose::UNDEFORMED, Sway::Right),
        );
        self.sector(drawing, "ring", all, still, (fill, stroke));
    }

    /// The mechanism open, over the ring at rest; returns the rotations drawn, as seen.
    fn mechanism(&self, drawing: &mut Drawing, link: &ArchLink, sway: Sway) -> [f64; 3] {
        self.whole(drawing, "none", Stroke::new(color::GREY, 0.8, "3 3"));
        let linkage = &link.link.mechanism;
        let q_rad = DRAWN_PART * link.link.limit_rad;
        let (mut poses, mut hinges) = (Vec::new(), Vec::new());
        linkage.place(q_rad, &mut poses, &mut hinges);
        let [a, b, c, d] = link.mechanism.hinges_rad();
        let none = Pose::UNDEFORMED;
        let line = Stroke::new(color::BLACK, 1.2, "");
        // In the mirror of a sway to the left the first body is the one on the right.
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
            (still, (d, self.ring.embrace_rad()), none),
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

    /// The hinges with their letters, from the left; names `hinge A` and so on, with `mark` after the letter.
    fn hinges(&self, drawing: &mut Drawing, link: &ArchLink, sway: Sway, mark: &str) {
        let hinges = link.mechanism.hinges_from_left(&self.ring, sway);
        for (letter, (angle_rad, edge)) in ["A", "B", "C", "D"].into_iter().zip(hinges) {
            let at = self.px(self.ring.point(angle_rad, edge), Sway::Right);
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
            let radial = self.ring.radial(angle_rad);
            let away = Vector2::new(radial.x, -radial.y) * (side * 17.0);
            let text = at + away + Vector2::new(0.0, 4.5);
            drawing.label(text, Anchor::Middle, 0.0, &format!("{letter}{mark}"));
        }
    }

    /// A line of resultants in the frame of a sway, cut off far outside the ring.
    fn resultants(&self, drawing: &mut Drawing, name: &str, line: &ResultantLine, sway: Sway) {
        let sections = 720;
        let points = (0..=sections).map(|i| {
            let angle = self.ring.embrace_rad() * f64::from(i) / f64::from(sections);
            let e = line.section(angle).eccentricity_ratio;
            let e = if e.is_finite() { e } else { 0.0 };
            let e = e.clamp(-DRAWN_ECCENTRICITY, DRAWN_ECCENTRICITY);
            let radius = 1.0 + e * self.ring.thickness_ratio();
            self.px(self.ring.radial(angle) * radius, sway)
        });
        drawing.curve(name, points, Stroke::new(color::BLUE, 1.8, ""));
    }
}

fn shape(ring: &Ring) -> String {
    format!(
        "embrace angle {} deg, t/R = {}",
        rounded(ring.embrace_rad().to_degrees()),
        rounded(ring.thickness_ratio())
    )
}

/// A number for people, without rounding residue.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

fn rotations_text([left, middle, right]: [f64; 3]) -> String {
    format!("left {left:+.3}, middle {middle:+.3}, right {right:+.3} rad")
}

/// Incipient rocking to the right: the thrust line at `A_L` through its hinges, and the mechanism.
///
/// The mechanism is drawn to scale at finite rotations, at a quarter of the way to its limit position.
#[must_use]
pub fn limit(figure: Figure, chain: &Chain) -> String {
    let ring = chain.ring();
    let link = chain
        .link(0)
        .expect("a chain begins with the mechanism that starts");
    let mut drawing = Drawing::new(figure);
    let incipient = chain.incipient();
    let title = format!(
        "Incipient rocking at A_L = {:.5} g; {}",
        incipient.acceleration_g,
        shape(ring)
    );
    let top = drawing.title(&title);
    let cells = Cells::new(figure);

    let (left, middle) = cells.first(ring, top);
    left.whole(&mut drawing, "#f4f4f4", Stroke::new(color::BLACK, 1.2, ""));
    left.joints(&mut drawing, chain.sites());
    left.resultants(
        &mut drawing,
        "thrust line",
        &incipient.thrust_line,
        Sway::Right,
    );
    left.hinges(&mut drawing, link, Sway::Right, "");
    let text = "Thrust line under gravity and a push of A_L to the right; A to D: hinges, circles at the edge about \
                which the arch turns";
    let first_end = cells.caption(&mut drawing, middle, left.bottom(), text);

    let (right, middle) = cells.second(ring, top, first_end);
    let rotations = right.mechanism(&mut drawing, link, Sway::Right);
    let text = format!(
        "Mechanism, to scale, at rotations (anticlockwise) of {}",
        rotations_text(rotations)
    );
    let end = cells.caption(&mut drawing, middle, right.bottom(), &text);
    drawing.finish(end.max(first_end) + 12.0)
}

/// Two arches side by side, or one below the other where there is not the room.
struct Cells {
    /// Width of a cell in pixels.
    width: f64,
    side_by_side: bool,
}

/// Room above an arch, for its hinges and a body that rises.
const ABOVE_PX: f64 = 42.0;

impl Cells {
    fn new(figure: Figure) -> Self {
        let columns = figure.columns(2, 340.0);
        Self {
            width: figure.width_px() / if columns == 2 { 2.0 } else { 1.0 },
            side_by_side: columns == 2,
        }
    }

    /// The place of the first arch below `top`, and the middle of its cell.
    fn first(&self, ring: &Ring, top: f64) -> (Place, f64) {
        let middle = 0.5 * self.width;
        let place = Place::new(ring, middle, top + ABOVE_PX, 0.8 * self.width);
        (place, middle)
    }

    /// That of the second, where the first ends at `first_end`.
    fn second(&self, ring: &Ring, top: f64, first_end: f64) -> (Place, f64) {
        let (middle, top) = if self.side_by_side {
            (1.5 * self.width, top)
        } else {
            (0.5 * self.width, first_end)
        };
        let place = Place::new(ring, middle, top + ABOVE_PX, 0.8 * self.width);
        (place, middle)
    }

    /// Text below an arch; returns where it ends.
    fn caption(&self, drawing: &mut Drawing, middle: f64, bottom: f64, text: &str) -> f64 {
        let at = Vector2::new(middle, bottom + 34.0);
        drawing.caption_at(at, self.width - 16.0, text)
    }
}

/// Impact number `index`, from 1, after a first sway to the right, as Fig. 10 of the paper: the mechanisms before
/// and after, the bodies that both together cut out of the ring (Eq. (3)), and the impulse line. `None` when
/// this impact or one before it stops the arch.
#[must_use]
pub fn impact(figure: Figure, chain: &Chain, index: usize) -> Option<String> {
    let ring = chain.ring();
    let (before, after) = (chain.link(index.checked_sub(1)?)?, chain.link(index)?);
    let sway_after = impact::sway(index);
    let sway_before = sway_after.opposite();
    let mut drawing = Drawing::new(figure);
    let title = format!(
        "Impact {index}: restitution (kinetic energy after/before) r = {:.6}; {}",
        after.link.restitution,
        shape(ring)
    );
    let top = drawing.title(&title);
    let cells = Cells::new(figure);
    let caption = |text: &str, mark: &str, rotations: [f64; 3]| {
        let rotations = rotations_text(rotations);
        format!("{text}, hinges A{mark} to D{mark}, drawn at rotations of {rotations}")
    };
    let (place, middle) = cells.first(ring, top);
    let rotations = place.mechanism(&mut drawing, before, sway_before);
    let text = caption("u before the impact", "", rotations);
    let first_end = cells.caption(&mut drawing, middle, place.bottom(), &text);
    let (place, middle) = cells.second(ring, top, first_end);
    let rotations = place.mechanism(&mut drawing, after, sway_after);
    let text = caption("u' after the impact", "'", rotations);
    let second_end = cells.caption(&mut drawing, middle, place.bottom(), &text);

    let lower_top = first_end.max(second_end) + ABOVE_PX + 14.0;
    let (wide, middle) = (0.71 * figure.width_px(), 0.5 * figure.width_px());
    let place = Place::new(ring, middle, lower_top, wide);
    let closing = closing_field(&before.mechanism, ring);
    let field = after.mechanism.field();
    // All in the frame of the new mechanism, which is drawn in a mirror if it sways left.
    let cut = closing.minus(&field);
    let mut bounds = [cut.cuts_rad(), &[0.0, ring.embrace_rad()]].concat();
    bounds.sort_by(f64::total_cmp);
    bounds.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let moves = |mechanism: [f64; 4], angle: f64| mechanism[0] < angle && angle < mechanism[3];
    let hinges_before = before
        .mechanism
        .hinges_rad()
        .map(|angle| ring.embrace_rad() - angle);
    let [a, b, c, d] = hinges_before;
    let mut number = 0;
    // The bodies are counted from the left.
    let mut sectors: Vec<&[f64]> = bounds.windows(2).collect();
    if sway_after == Sway::Left {
        sectors.reverse();
    }
    for pair in sectors {
        let (from, to) = (pair[0], pair[1]);
        let middle = 0.5 * (from + to);
        let moving = moves([d, c, b, a], middle) || moves(after.mechanism.hinges_rad(), middle);
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
            let out = 1.0 + 0.5 * ring.thickness_ratio() + 30.0 / place.scale;
            let at = place.px(ring.radial(middle) * out, sway_after);
            let at = at + Vector2::new(0.0, 4.5);
            drawing.label(at, Anchor::Middle, 0.0, &number.to_string());
        }
    }
    place.whole(&mut drawing, "none", Stroke::new(color::BLACK, 1.2, ""));
    place.joints(&mut drawing, chain.sites());
    let change = closing.minus(&field.scaled(after.link.rate_ratio));
    let line = ResultantLine::through_hinges(ring, &after.mechanism, change);
    place.resultants(&mut drawing, "impulse line", &line, sway_after);
    place.hinges(&mut drawing, after, sway_after, "'");
    for (angle, edge) in before.mechanism.hinges_from_left(ring, sway_before) {
        let at = place.px(ring.point(angle, edge), Sway::Right);
        drawing.circle("hinge before", at, 2.5, Stroke::new(color::GREY, 1.2, ""));
    }
    let text = "Impulse line through the hinges A' to D' of u', at the edges about which the arch turns after the \
                impact; grey circles: the hinges A to D of u, which close; 1, 2 ...: the bodies that both together cut \
                out of the arch";
    let end = drawing.caption(place.bottom() + 34.0, text);
    Some(drawing.finish(end + 12.0))
}
