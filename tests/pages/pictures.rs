//! The contents of pictures: read back from the SVG and compared with the mechanics.

use std::fs;
use std::path::Path;

use crate::common::program::{done, printed, refused, scenarios};
use crate::common::results::{Table, named, number, points, texts};
use crate::common::{ON_A_PIER, UNEVEN_ARCH};
use archrock::mechanics::Edge;
use archrock::mechanics::Profile;
use archrock::mechanics::four_link::Chain;
use archrock::output::{Figure, Scene};
use archrock::scenario::Structure;
use archrock::studies::map::{self, OverturningMap};
use archrock::studies::{LinkImpact, Study as _, Style, draw_impact, draw_limit, outcome_name};
use archrock::{Arch, FourLinks, ImpactModel, Scenario, Sway};
use nalgebra::Vector2;
use roxmltree::{Document, Node};

/// Coordinates are written to thousandths of a pixel, paths of curves to hundredths.
const PIXEL: f64 = 0.02;

/// An arch with the parts of it that are drawn.
fn drawn(arch: Arch) -> (FourLinks, Scene) {
    let model = FourLinks::of_arch(&arch, ImpactModel::MaxRestitution).unwrap();
    (model, Scene::new(&Structure::Arch(arch)))
}

fn arch(thickness_ratio: f64, embrace_deg: f64) -> (FourLinks, Scene) {
    drawn(Arch::new(5.0, thickness_ratio, embrace_deg).unwrap())
}

/// The impact that leads to a link of the chain after a first sway to the right.
fn impact(arch: &FourLinks, index: usize) -> LinkImpact<'_> {
    LinkImpact {
        model: arch,
        first: Sway::Right,
        index,
    }
}

fn center(node: &Node<'_, '_>) -> Vector2<f64> {
    Vector2::new(number(node, "cx"), number(node, "cy"))
}

/// Place and scale of a ring on the sheet, from its first and last hinge: centre and pixels per radius.
struct Sheet {
    center: Vector2<f64>,
    scale: f64,
}

impl Sheet {
    fn new(shown: [Vector2<f64>; 2], exact: [Vector2<f64>; 2]) -> Self {
        let scale = (shown[1].x - shown[0].x) / (exact[1].x - exact[0].x);
        let flipped = Vector2::new(exact[0].x, -exact[0].y);
        Self {
            center: shown[0] - flipped * scale,
            scale,
        }
    }

    fn back(&self, shown: Vector2<f64>) -> Vector2<f64> {
        let away = (shown - self.center) / self.scale;
        Vector2::new(away.x, -away.y)
    }
}

/// Checks the hinges A to D of a picture and returns the sheet they define.
fn check_hinges(document: &Document<'_>, chain: &Chain, link: usize, sway: Sway) -> Sheet {
    let mark = if link == 0 { "" } else { "'" };
    let ring = chain.profile(0);
    let mechanism = chain.link(link).unwrap().mechanism;
    let exact = mechanism
        .hinges_from_left(ring, sway)
        .map(|(angle, edge)| ring.point(angle, edge));
    let shown = ["A", "B", "C", "D"].map(|letter| {
        let circles = named(document, &format!("hinge {letter}{mark}"));
        assert_eq!(circles.len(), 1);
        center(&circles[0])
    });
    let sheet = Sheet::new([shown[0], shown[3]], [exact[0], exact[3]]);
    assert!(sheet.scale > 100.0);
    for (shown, exact) in shown.into_iter().zip(exact) {
        let error = (sheet.back(shown) - exact).norm() * sheet.scale;
        assert!(error < PIXEL, "{error}");
    }
    for letter in ["A", "B", "C", "D"] {
        assert!(texts(document).contains(&format!("{letter}{mark}")));
    }
    sheet
}

/// Distance of the curve's points from the axis over the thickness: the eccentricity drawn.
fn eccentricities(curve: &[Vector2<f64>], sheet: &Sheet, ring: &dyn Profile) -> Vec<f64> {
    let radius = |point: &Vector2<f64>| sheet.back(*point).norm();
    curve
        .iter()
        .map(|point| (radius(point) - 1.0) / ring.thickness(0.0))
        .collect()
}

#[test]
fn limit_shows_the_thrust_line_inside_the_ring_and_through_its_hinges() {
    for (thickness_ratio, embrace_deg) in [(0.15, 180.0), (0.15, 157.5), (0.1, 120.0)] {
        let (arch, scene) = arch(thickness_ratio, embrace_deg);
        let chain = arch.chain();
        let picture = draw_limit(Figure::SCREEN, &arch, Sway::Right, &scene);
        let document = Document::parse(&picture).unwrap();
        let sheet = check_hinges(&document, chain, 0, Sway::Right);
        let lines = named(&document, "thrust line");
        assert_eq!(lines.len(), 1);
        let curve = points(&lines[0]);
        let tolerance = 2.0 * PIXEL / (sheet.scale * thickness_ratio);
        for e in eccentricities(&curve, &sheet, chain.profile(0)) {
            assert!(e.abs() < 0.5 + tolerance, "{e}");
        }
        // Between points of the polyline, about half a pixel apart, it passes through the hinges.
        for point in chain.link(0).unwrap().mechanism.points {
            let nearest = curve
                .iter()
                .map(|shown| (sheet.back(*shown) - point).norm() * sheet.scale)
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 1.0, "{nearest}");
        }
        let acceleration = format!("{:.5} g", chain.incipient.acceleration_g);
        assert!(texts(&document)[0].contains(&acceleration));
    }
}

/// The push of `limit` is an arrow through the centre of the bodies, here the ring from the first hinge to the last: its centre is at the
/// radius `(R + t^2/(12 R)) sin(b)/b` for the half angle `b`.
#[test]
fn limit_shows_the_push_through_the_centre_of_the_moving_masses() {
    let ratio = 0.15;
    let (arch, scene) = arch(ratio, 180.0);
    let ring = arch.chain().profile(0);
    let mechanism = arch.chain().link(0).unwrap().mechanism;
    for sway in [Sway::Right, Sway::Left] {
        let picture = draw_limit(Figure::SCREEN, &arch, sway, &scene);
        let document = Document::parse(&picture).unwrap();
        let hinges = mechanism.hinges_from_left(ring, sway);
        let hinges = hinges.map(|(angle, edge)| ring.point(angle, edge));
        let shown = ["hinge A", "hinge D"].map(|name| center(&named(&document, name)[0]));
        let sheet = Sheet::new(shown, [hinges[0], hinges[3]]);
        let [from, to] = [0, 3].map(|end| f64::atan2(hinges[end].x, hinges[end].y));
        let (half, middle) = (0.5 * (to - from), 0.5 * (from + to));
        let radius = (1.0 + ratio * ratio / 12.0) * half.sin() / half;
        let expected = radius * Vector2::new(middle.sin(), middle.cos());
        let push = points(&named(&document, "push")[0]);
        let [tail, tip] = [push[0], push[1]];
        assert_eq!((tip.x - tail.x).signum(), sway.sign());
        assert_eq!(tip.y, tail.y);
        let off = sheet.back(0.5 * (tail + tip)) - expected;
        assert!(off.norm() * sheet.scale < 2.0 * PIXEL, "{off}");
        assert!(
            texts(&document)
                .join(" ")
                .contains(&format!("A_L to the {} (green arrow", sway.name()))
        );
    }
}

/// `check` draws the axes at the origin, or with the coordinates of their point if the origin is outside, and the positive ground
/// acceleration, to the right: it pushes to the left.
#[test]
fn check_shows_axes_and_the_positive_ground_acceleration() {
    let folder = tempfile::tempdir().unwrap();
    let circle = |embrace: f64| {
        format!("[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = {embrace}\n")
    };
    for (text, origin) in [
        (circle(180.0), None),
        ("[column]\nheight_m = 4\nwidth_m = 0.8\n".to_owned(), None),
        // The intrados of the springings, 4.625 m from the centre, at 45 degrees.
        (circle(90.0), Some("(0, 3.27) m")),
    ] {
        fs::write(folder.path().join("s.toml"), &text).unwrap();
        printed(folder.path(), &["check", "s.toml", "--plot", "s.svg"]);
        let picture = fs::read_to_string(folder.path().join("s.svg")).unwrap();
        let document = Document::parse(&picture).unwrap();
        let ends = |name: &str| points(&named(&document, name)[0]);
        let (x, y) = (ends("axis x"), ends("axis y"));
        assert!(
            x[0] == y[0]
                && x[1].x > x[0].x
                && x[1].y == x[0].y
                && y[1].y < y[0].y
                && y[1].x == y[0].x
        );
        // The supports are at the level of the origin, and symmetric about it.
        let supports: Vec<_> = named(&document, "support")
            .iter()
            .flat_map(points)
            .collect();
        let middle = supports.iter().sum::<Vector2<f64>>() / supports.len() as f64;
        assert!((middle.x - x[0].x).abs() < 2.0 * PIXEL, "{middle} {}", x[0]);
        let words = texts(&document);
        match origin {
            None => {
                assert!((middle.y - x[0].y).abs() < 2.0 * PIXEL);
                assert!(words.iter().any(|word| word == "0"));
            }
            Some(place) => assert!(words.iter().any(|word| word == place), "{words:?}"),
        }
        let ground = ends("ground acceleration");
        assert!(ground[1].x > ground[0].x && ground[1].y == ground[0].y);
        assert!(
            words
                .join(" ")
                .contains("positive ground acceleration, which pushes to the left")
        );
    }
}

#[test]
fn joints_are_drawn_for_voussoirs() {
    let arch = Arch::new(10.0, 0.15, 157.5).unwrap();
    let (arch, scene) = drawn(arch.with_voussoirs(7).unwrap());
    let chain = arch.chain();
    let picture = draw_limit(Figure::SCREEN, &arch, Sway::Right, &scene);
    let document = Document::parse(&picture).unwrap();
    let count = |document: &Document<'_>, names: &[&str]| {
        let nodes = names.iter().map(|name| named(document, name).len());
        nodes.sum::<usize>()
    };
    assert_eq!(count(&document, &["block"]), 7);
    assert_eq!(count(&document, &["still", "left", "middle", "right"]), 7);
    // The hinges are at joints.
    check_hinges(&document, chain, 0, Sway::Right);
    let picture = draw_impact(Figure::SCREEN, &impact(&arch, 1), &scene).unwrap();
    let document = Document::parse(&picture).unwrap();
    let bodies = (1..9).map(|body| named(&document, &format!("body {body}")).len());
    // Those of the two mechanisms stand still beside the bodies.
    let moving = count(&document, &["left", "middle", "right"]);
    let still = count(&document, &["still"]) - (14 - moving);
    assert_eq!(bodies.sum::<usize>() + still, 7);
}

#[test]
fn limit_shows_rigid_bodies_joined_at_hinges() {
    let (arch, scene) = arch(0.15, 180.0);
    let chain = arch.chain();
    let picture = draw_limit(Figure::SCREEN, &arch, Sway::Right, &scene);
    let document = Document::parse(&picture).unwrap();
    let hinges: Vec<_> = named(&document, "hinge").iter().map(center).collect();
    assert_eq!(hinges.len(), 4);
    let body = |name: &str| points(&named(&document, name)[0]);
    // B is a corner of the left and the middle bodies, C of the middle and the right ones.
    for (hinge, bodies) in [
        (hinges[0], ["still", "left"]),
        (hinges[1], ["left", "middle"]),
        (hinges[2], ["middle", "right"]),
    ] {
        for name in bodies {
            let nearest = body(name)
                .iter()
                .map(|corner| (corner - hinge).norm())
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < PIXEL, "{name}: {nearest}");
        }
    }
    // Rigid: the bars A-B, B-C and C-D keep their lengths.
    let points = chain.link(0).unwrap().mechanism.points;
    let bar = |points: &[Vector2<f64>], i: usize| (points[i + 1] - points[i]).norm();
    let scale = bar(&hinges, 0) / bar(&points, 0);
    for i in [1, 2] {
        assert!((bar(&hinges, i) - scale * bar(&points, i)).abs() < PIXEL);
    }
    // It sways right, which lowers B.
    assert!(hinges[1].x - hinges[0].x > scale * (points[1].x - points[0].x));
}

/// The mechanism after the second impact sways right again, so nothing is mirrored.
#[test]
fn the_second_impact_has_a_picture_of_its_own() {
    let (arch, scene) = arch(0.15, 180.0);
    let chain = arch.chain();
    let picture = draw_impact(Figure::SCREEN, &impact(&arch, 2), &scene).unwrap();
    let document = Document::parse(&picture).unwrap();
    check_hinges(&document, chain, 2, Sway::Right);
    let title = &texts(&document)[0];
    assert!(
        title.contains("Impact 2: ") && title.contains("r = 0.737099"),
        "{title}"
    );
    // Bodies are counted from the left, as at the first impact.
    let left = |name: &str| {
        let bodies = named(&document, name);
        points(&bodies[0])
            .iter()
            .map(|corner| corner.x)
            .fold(f64::INFINITY, f64::min)
    };
    assert!(left("body 1") < left("body 2") && left("body 2") < left("body 3"));
    assert!(draw_impact(Figure::SCREEN, &impact(&arch, 0), &scene).is_none());

    let folder = tempfile::tempdir().unwrap();
    let text = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\n";
    fs::write(folder.path().join("s.toml"), text).unwrap();
    printed(
        folder.path(),
        &["impact", "s.toml", "--link", "2", "--plot", "2.svg"],
    );
    assert_eq!(
        fs::read_to_string(folder.path().join("2.svg")).unwrap(),
        picture
    );
}

/// Fig. 10 and Eq. (3) of the paper: for the semicircle, whose last hinges share the right springing, the
/// seventh body is empty.
#[test]
fn impact_shows_the_bodies_of_the_paper_and_the_impulse_line() {
    let (arch, scene) = arch(0.15, 180.0);
    let chain = arch.chain();
    let picture = draw_impact(Figure::SCREEN, &impact(&arch, 1), &scene).unwrap();
    let document = Document::parse(&picture).unwrap();
    let sheet = check_hinges(&document, chain, 1, Sway::Left);
    assert!(
        texts(&document)[0].contains("Impact 1: ") && texts(&document)[0].contains("r = 0.681186")
    );
    let angles: [f64; 7] = [
        0.0, 24.01353, 76.37611, 81.78741, 133.81620, 139.56130, 180.0,
    ];
    for (index, pair) in angles.windows(2).enumerate() {
        let bodies = named(&document, &format!("body {}", index + 1));
        assert_eq!(bodies.len(), 1);
        assert!(texts(&document).contains(&(index + 1).to_string()));
        let expected: Vec<_> = pair
            .iter()
            .flat_map(|angle| {
                [Edge::Intrados, Edge::Extrados]
                    .map(|edge| chain.profile(0).point(angle.to_radians(), edge))
            })
            .collect();
        let shown = points(&bodies[0]);
        for point in expected {
            let nearest = shown
                .iter()
                .map(|corner| (sheet.back(*corner) - point).norm() * sheet.scale)
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < PIXEL, "{nearest}");
        }
        // No part of the line lies beyond its sections.
        for corner in shown.iter().map(|corner| sheet.back(*corner)) {
            let angle = corner.x.atan2(corner.y).to_degrees() + 90.0;
            let slack = PIXEL / sheet.scale * 57.3;
            assert!(
                pair[0] - slack < angle && angle < pair[1] + slack,
                "{angle}"
            );
        }
    }
    assert!(named(&document, "body 7").is_empty());
    let lines = named(&document, "impulse line");
    assert_eq!(lines.len(), 1);
    let drawn = eccentricities(&points(&lines[0]), &sheet, chain.profile(0));
    let worst = drawn
        .into_iter()
        .fold(0.0, |worst: f64, e| worst.max(e.abs()));
    // Published: |e|/t = 0.50199 at most; a hundredth of a pixel is 3e-4 of t.
    assert!((worst - 0.50199).abs() < 5e-4, "{worst}");
}

/// An uneven arch on piers, whose blocks, onset and hinges are known from the row and the static programme.
#[test]
fn rows_are_drawn_by_their_outlines_and_hinges_at_corners_of_joints() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = format!("{UNEVEN_ARCH}{ON_A_PIER}");
    fs::write(folder.join("s.toml"), text).unwrap();
    let scenario = Scenario::read(&folder.join("s.toml")).unwrap();
    let Structure::Masonry(masonry) = &scenario.structure else {
        panic!("{:?}", &scenario.structure);
    };
    let outlines_m = &masonry.row.outlines_m;
    let corner = |outlines: &[Vec<Vector2<f64>>], block: usize| outlines[block][0];
    let printed_json = printed(folder, &["limit", "s.toml", "--format", "json"]);
    let onset: serde_json::Value = serde_json::from_str(&printed_json).unwrap();
    for side in ["right", "left"] {
        let options = ["--first", side, "--plot"];
        printed(
            folder,
            &[&["limit", "s.toml"], &options[..], &["l.svg"]].concat(),
        );
        printed(
            folder,
            &[&["impact", "s.toml"], &options[..], &["i.svg"]].concat(),
        );
        let [limit, impact] =
            ["l.svg", "i.svg"].map(|file| fs::read_to_string(folder.join(file)).unwrap());
        let (limit, impact) = (
            Document::parse(&limit).unwrap(),
            Document::parse(&impact).unwrap(),
        );
        let last = outlines_m.len() - 1;
        let exact = [corner(outlines_m, 0), corner(outlines_m, last)];
        let mut sheets = Vec::new();
        for document in [&limit, &impact] {
            // Wherever the structure at rest is drawn whole, it is similar to its blocks.
            let whole = ["block", "built"].into_iter();
            let whole: Vec<_> = whole.flat_map(|name| named(document, name)).collect();
            assert!(!whole.is_empty());
            for nodes in whole.chunks(outlines_m.len()) {
                let drawn: Vec<_> = nodes.iter().map(points).collect();
                assert_eq!(drawn.len(), outlines_m.len());
                let sheet = Sheet::new([corner(&drawn, 0), corner(&drawn, last)], exact);
                for (drawn, outline_m) in drawn.iter().zip(outlines_m) {
                    assert_eq!(drawn.len(), outline_m.len());
                    for (drawn, corner_m) in drawn.iter().zip(outline_m) {
                        assert!((sheet.back(*drawn) - corner_m).norm() * sheet.scale < PIXEL);
                    }
                }
                sheets.push(sheet);
            }
        }
        // Hinges of the first mechanism lie on the thrust line, at the joints that the static programme opens.
        let mechanism = onset["mechanism"][side].as_array().unwrap();
        assert_eq!(mechanism.len(), 4);
        let mut line = points(&named(&limit, "thrust line")[0]);
        assert_eq!(line.len(), outlines_m.len() + 1);
        let moved: Vec<_> = named(&limit, "hinge").iter().map(center).collect();
        if side == "left" {
            // Drawn in the frame of the sway, hence reversed.
            line.reverse();
        }
        for (letter, opening) in ["A", "B", "C", "D"].into_iter().zip(mechanism) {
            let shown = center(&named(&limit, &format!("hinge {letter}"))[0]);
            let [x_m, y_m] = ["x_m", "y_m"].map(|key| opening[key].as_f64().unwrap());
            let exact = Vector2::new(x_m, y_m);
            assert!((sheets[0].back(shown) - exact).norm() * sheets[0].scale < PIXEL);
            let joint = usize::try_from(opening["joint"].as_u64().unwrap()).unwrap();
            assert!((line[joint] - shown).norm() < PIXEL, "{letter}");
        }
        // Rigid bodies share their hinges: left and middle the second, middle and right the third.
        for (name, hinges) in [("left", [0, 1]), ("middle", [1, 2]), ("right", [2, 3])] {
            let body = named(&limit, name);
            for hinge in hinges {
                let corners = body.iter().flat_map(points);
                let distances = corners.map(|corner| (corner - moved[hinge]).norm());
                assert!(
                    distances.fold(f64::INFINITY, f64::min) < PIXEL,
                    "{name} {hinge}"
                );
            }
        }
        let drawn: usize = ["still", "left", "middle", "right"]
            .iter()
            .map(|name| named(&limit, name).len())
            .sum();
        assert_eq!(drawn, outlines_m.len());
        // It sways to that side: the hinge between the left and middle bodies moves there.
        let at_rest = center(&named(&limit, "hinge B")[0]);
        let sway = sheets[1].back(moved[1]).x - sheets[0].back(at_rest).x;
        assert_eq!(sway > 0.0, side == "right");
        // The impulse line passes through the hinges of the new mechanism, and all its bodies are numbered.
        let line = points(&named(&impact, "impulse line")[0]);
        for letter in ["A'", "B'", "C'", "D'"] {
            let shown = center(&named(&impact, &format!("hinge {letter}"))[0]);
            let distances = line.iter().map(|point| (point - shown).norm());
            assert!(distances.fold(f64::INFINITY, f64::min) < PIXEL);
        }
        let bodies = (1..9).take_while(|n| !named(&impact, &format!("body {n}")).is_empty());
        assert!(bodies.count() >= 3);
    }
}

fn scenario(folder: &Path, more: &str) {
    let text = format!(
        "title = \"A < B & C\"\n[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\n\
         embrace_deg = 180.0\n{more}"
    );
    fs::write(folder.join("s.toml"), text).unwrap();
}

#[test]
fn run_draws_the_history() {
    let folder = tempfile::tempdir().unwrap();
    scenario(
        folder.path(),
        "[ground.rectangular]\namplitude_g = -0.30\nduration_s = 0.20\n\
         [simulation]\noutput_step_s = 1e-4\n",
    );
    done(folder.path(), &["run", "s.toml", "--out", "out"]);
    let text = fs::read_to_string(folder.path().join("out/history.svg")).unwrap();
    // Thirty thousand samples of six quantities, thinned.
    assert!(text.len() < 400_000, "{}", text.len());
    let document = Document::parse(&text).unwrap();
    assert_eq!(texts(&document)[0], "A < B & C");
    for label in [
        "Ground (g)",
        "Rotation (rad)",
        "Total energy / barrier",
        "Time (s)",
    ] {
        assert!(texts(&document).iter().any(|text| text == label), "{label}");
    }
    let curve = |name: &str| {
        let found = named(&document, name);
        let curves: Vec<_> = found
            .iter()
            .filter(|node| node.has_tag_name("path"))
            .collect();
        assert_eq!(curves.len(), 1, "{name}");
        points(curves[0])
    };
    // The largest rotations have the ratios of the published peaks, measured from zero, where all curves start.
    let peak = |name: &str| {
        let points = curve_of(&document, name);
        let start = points[0].y;
        points
            .iter()
            .map(|point| point.y - start)
            .fold(
                0.0,
                |peak: f64, y| if y.abs() > peak.abs() { y } else { peak },
            )
    };
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("out/summary.json")).unwrap())
            .unwrap();
    let key = |name: &str| summary[name].as_f64().unwrap();
    let scale = peak("right") / key("peak_rotation_right_rad");
    for (name, sign) in [("left", 1.0), ("middle", -1.0)] {
        let expected = sign * scale * key(&format!("peak_rotation_{name}_rad"));
        assert!((peak(name) - expected).abs() < 0.1, "{name}");
    }
    // Only the first half cycle goes far: its line is at the left body's unstable equilibrium, as `limit` prints it.
    let unstable = curve("unstable");
    for end in &unstable {
        let from_zero = end.y - curve_of(&document, "left")[0].y;
        assert!((from_zero - scale * 0.031_048).abs() < 0.1);
    }
    // One time axis: the curves begin and end together, at the frame.
    let (left, right) = (66.0, 875.0);
    for name in ["ground", "middle", "energy", "excess"] {
        let points = curve(name);
        assert!((points[0].x - left).abs() < PIXEL);
        assert!((points[points.len() - 1].x - right).abs() < PIXEL);
    }
    assert!((unstable[0].x - left).abs() < PIXEL);
    // The first impact, published at 1.0279 s, is marked at that fraction of the time.
    let end_s = key("outcome_time_s");
    let marks = named(&document, "impact");
    let foot: f64 = marks[0].attribute("d").unwrap()[1..]
        .split(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    let expected = left + (right - left) * 1.0279 / end_s;
    assert!((foot - expected).abs() < 0.05, "{foot} {expected}");
    assert!(marks.len() > 10);
    // It sways right until then, in each of four panels.
    let bands = named(&document, "right");
    let bands: Vec<_> = bands
        .iter()
        .filter(|node| node.has_tag_name("rect"))
        .filter(|node| (number(node, "x") - left).abs() < PIXEL)
        .collect();
    assert_eq!(bands.len(), 4);
    assert!((number(bands[0], "width") - (expected - left)).abs() < 0.1);
}

fn curve_of(document: &Document<'_>, name: &str) -> Vec<Vector2<f64>> {
    let found = named(document, name);
    points(found.iter().find(|node| node.has_tag_name("path")).unwrap())
}

#[test]
fn a_run_without_motion_has_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let weak = "[ground.rectangular]\namplitude_g = 0.01\nduration_s = 0.1\n";
    scenario(
        folder.path(),
        &format!("{weak}[simulation]\nduration_s = 1.0\n"),
    );
    done(folder.path(), &["run", "s.toml", "--out", "out"]);
    let text = fs::read_to_string(folder.path().join("out/history.svg")).unwrap();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    Document::parse(&text).unwrap();
}

/// Bands wide enough to be seen have the sway between the events on either side; narrower hops
/// share one shade, which is neither.
#[test]
fn bands_have_the_sway_of_the_events() {
    let folder = tempfile::tempdir().unwrap();
    scenario(
        folder.path(),
        "[ground.rectangular]\namplitude_g = -0.30\nduration_s = 0.20\n",
    );
    done(folder.path(), &["run", "s.toml", "--out", "out"]);
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    let picture = read("history.svg");
    let document = Document::parse(&picture).unwrap();
    let mut events: Vec<(f64, String)> = vec![(0.0, String::new())];
    for row in Table::read(folder.path().join("out/events.csv")).rows {
        events.push((row.number("time_s"), row["sway"].to_owned()));
    }
    let summary: serde_json::Value = serde_json::from_str(&read("summary.json")).unwrap();
    let end_s = summary["outcome_time_s"].as_f64().unwrap();
    let place = |time_s: f64| 66.0 + 809.0 * time_s / end_s;
    let mut hops = 0;
    let mut swaying = [0, 0];
    for name in ["right", "left", "hops"] {
        let bands = named(&document, name);
        let bands = bands.iter().filter(|node| node.has_tag_name("rect"));
        for band in bands {
            let (left, width) = (number(band, "x"), number(band, "width"));
            let inside = |&&(time_s, _): &&(f64, String)| {
                let x = place(time_s);
                left + 0.05 < x && x < left + width - 0.05
            };
            let within: Vec<_> = events.iter().filter(inside).collect();
            if name == "hops" {
                hops += within.len();
                continue;
            }
            // Events inside a visible band that have another sway take less than a pixel together.
            let first = within.iter().map(|(time_s, _)| place(*time_s) - left);
            assert!(first.fold(0.0, f64::max) < 1.0, "{name} {left} {width}");
            let middle_s = (left + 0.5 * width - 66.0) / 809.0 * end_s;
            let here = events
                .iter()
                .rfind(|(time_s, _)| *time_s <= middle_s)
                .unwrap();
            assert_eq!(here.1, name, "{left} {width}");
            swaying[usize::from(name == "left")] += 1;
        }
    }
    // In each of four panels, for each event that a visible interval follows; there are several to each side.
    let seen = |side: &str| {
        let ends = events
            .iter()
            .skip(1)
            .map(|(time_s, _)| *time_s)
            .chain([end_s]);
        let visible = |((time_s, sway), end_s): &(&(f64, String), f64)| {
            sway == side && place(*end_s) - place(*time_s) > 5.0
        };
        events.iter().zip(ends).filter(visible).count()
    };
    for (count, side) in swaying.into_iter().zip(["right", "left"]) {
        assert!(
            count >= 4 * seen(side) && seen(side) >= 3,
            "{side}: {count}"
        );
    }
    // In each of four panels, at the end of the decay.
    assert!(hops > 4 * 20, "{hops}");
}

/// Rectangles of a path of cells: left, right, top, bottom.
fn rectangles(document: &Document<'_>, name: &str) -> Vec<[f64; 4]> {
    let paths = named(document, name);
    let paths = paths.iter().map(|node| node.attribute("d").unwrap());
    paths
        .flat_map(|path| path.split_terminator('Z'))
        .map(|part| {
            let numbers: Vec<f64> = part
                .split(['M', ' ', 'H', 'V'])
                .filter(|text| !text.is_empty())
                .map(|text| text.parse().unwrap())
                .collect();
            [numbers[0], numbers[2], numbers[3], numbers[1]]
        })
        .collect()
}

/// Every cell has its colour in its place, on axes whose edges lie halfway between the values.
#[test]
fn the_map_shows_every_cell() {
    let text = "title = 'a < b'\n[column]\nheight_m = 4.0\nwidth_m = 0.8\n\
                [ground.rectangular]\namplitude_g = 1\nduration_s = 1\n\
                [simulation]\nduration_s = 60\n[map]\nduration_s = [0.2, 0.3, 0.6]\n\
                amplitude_g = { from = 0.1, to = 1.6, count = 5, spacing = 'logarithmic' }";
    let scenario = Scenario::parse(text, "s.toml").unwrap();
    let cells = OverturningMap::of(&scenario).unwrap();
    let rows: Vec<_> = (0..cells.count())
        .map(|index| cells.rows(&[index]).remove(0))
        .collect();
    let picture = map::draw("a < b", &cells, &rows, Style::of(Figure::SCREEN));
    let document = Document::parse(&picture).unwrap();
    assert!(texts(&document).iter().any(|text| text == "a < b"));

    // The frame is 790 by 560 pixels; x from 0.15 to 0.75 s, y over five octaves from 0.1 g / sqrt(2).
    let (left, width, height) = (85.0, 790.0, 560.0);
    let kinds = ["never_moved", "rest", "overturned-0"];
    let all: Vec<_> = kinds
        .iter()
        .flat_map(|name| rectangles(&document, name))
        .collect();
    // Below title and legend.
    let top = all
        .iter()
        .map(|[_, _, top, _]| *top)
        .fold(f64::INFINITY, f64::min);
    let bottom = all
        .iter()
        .map(|[_, _, _, bottom]| *bottom)
        .fold(0.0, f64::max);
    assert!((bottom - top - height).abs() < PIXEL);
    let x_edges = [0.15, 0.25, 0.45, 0.75].map(|x: f64| left + width * (x - 0.15) / 0.6);
    let y_edge = |row: u32| top + height * (1.0 - f64::from(row) / 5.0);
    let mut shown = 0;
    for (name, wanted) in [
        ("never_moved", "never_moved"),
        ("rest", "rest"),
        ("overturned-0", "overturned"),
    ] {
        for [l, r, t, b] in rectangles(&document, name) {
            let column = x_edges.iter().position(|x| (x - l).abs() < PIXEL).unwrap();
            assert!((x_edges[column + 1] - r).abs() < PIXEL);
            let at = |y: f64| {
                (0..=5)
                    .find(|row| (y_edge(*row) - y).abs() < PIXEL)
                    .unwrap()
            };
            for row in at(b)..at(t) {
                let row = &rows[column * 5 + row as usize];
                assert_eq!(outcome_name(&row.result), wanted);
                shown += 1;
            }
        }
    }
    assert_eq!(shown, 15);
}

/// Every picture of an arch shows its fill, loads and dimensions; small pictures give the dimensions in words.
#[test]
fn pictures_of_an_arch_have_fill_loads_and_dimensions() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenarios().join("pointed-arch-on-piers.toml");
    let scenario = scenario.to_str().unwrap();
    let draw = |arguments: &[&str], picture: &str| {
        let mut all = vec![arguments[0], scenario];
        all.extend(&arguments[1..]);
        printed(folder.path(), &all);
        fs::read_to_string(folder.path().join(picture)).unwrap()
    };
    let narrow = ["impact", "--plot", "n.svg", "--figure-width", "84mm"];
    for (arguments, picture, draws_sizes) in [
        (&["check", "--plot", "c.svg"][..], "c.svg", true),
        (&["limit", "--plot", "l.svg"][..], "l.svg", true),
        (&["impact", "--plot", "i.svg"][..], "i.svg", true),
        (&narrow[..], "n.svg", false),
        (
            &["spread", "--angle", "0", "--out", "."],
            "spread.svg",
            false,
        ),
        (
            &[
                "run",
                "--no-repeat",
                "--no-report",
                "--snapshots",
                "0.3",
                "--out",
                ".",
            ],
            "snapshots.svg",
            false,
        ),
    ] {
        let picture = draw(arguments, picture);
        let document = Document::parse(&picture).unwrap();
        // Span, rise, fill, and the height and width of its equal piers.
        let dimensions = if draws_sizes { 5 } else { 0 };
        assert_eq!(
            named(&document, "dimension").len(),
            dimensions,
            "{arguments:?}"
        );
        let words = texts(&document).join(" ");
        assert!(
            words.contains("span 6 m") && words.contains("1500 kg"),
            "{words}"
        );
        assert!(named(&document, "fill").len() >= 4, "{arguments:?}");
        assert!(!named(&document, "load").is_empty(), "{arguments:?}");
    }
}

/// The picture of `limit` shows four links. If ties rule them out, the error does not suggest a table that the scenario already
/// has.
#[test]
fn the_picture_of_a_tied_limit_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 15\n[free_hinges]\n\
                [[tie]]\nheight_m = 2.5\nstiffness_n_m = 1e6\n";
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    refused(
        folder.path(),
        &["limit", "s.toml", "--plot", "l.svg"],
        &["--plot is for arches without ties only: four links take none"],
    );
}
