//! The impulses of an impact compared with the momentum theorems, published numbers and statics by hand.

use std::f64::consts::PI;
use std::path::Path;

use crate::common::momentum::MomentumTheorems;
use crate::common::program::{printed, refused};
use crate::common::results::{Row, Table};
use archrock::mechanics::four_link::{EDGES, HingeSites, ImpactModel, closing_field, impact};
use archrock::mechanics::{Edge, Ring};
use archrock::mechanics::{Side, Sway};
use archrock::{Arch, FourLinks};
use nalgebra::Vector2;

const ANYWHERE: HingeSites = HingeSites::Anywhere;

fn arch(
    thickness_ratio: f64,
    embrace_deg: f64,
    sites: HingeSites,
    model: ImpactModel,
) -> FourLinks {
    let arch = Arch::new(3.0, thickness_ratio, embrace_deg).unwrap();
    let arch = match sites {
        HingeSites::Anywhere => arch,
        HingeSites::Voussoirs(voussoirs) => arch.with_voussoirs(voussoirs).unwrap(),
    };
    FourLinks::of_arch(&arch, model).unwrap()
}

fn arches() -> Vec<FourLinks> {
    let max = ImpactModel::MaxRestitution;
    vec![
        arch(0.15, 180.0, ANYWHERE, max),
        arch(0.12, 180.0, ANYWHERE, max),
        arch(0.30, 180.0, ANYWHERE, max),
        arch(0.15, 157.5, ANYWHERE, max),
        arch(0.15, 157.5, HingeSites::Voussoirs(7), max),
        arch(0.10, 120.0, ANYWHERE, max),
        arch(0.15, 180.0, ANYWHERE, ImpactModel::SameSections),
        arch(0.15, 180.0, ANYWHERE, ImpactModel::Mirrored),
    ]
}

#[test]
fn the_line_passes_through_all_four_hinges() {
    for arch in arches() {
        let chain = arch.chain();
        for index in 1..8 {
            let Some(link) = chain.link(index) else { break };
            let line = link.impulse_line.as_ref().unwrap();
            for (angle, edge) in link.mechanism.hinges_rad.into_iter().zip(EDGES) {
                let expected = match edge {
                    Edge::Intrados => -0.5,
                    Edge::Extrados => 0.5,
                };
                let found = line.resultants.section(angle).eccentricity_ratio;
                assert!((found - expected).abs() < 1e-10, "{index} {angle}: {found}");
            }
        }
    }
}

#[test]
fn outer_impulses_solve_the_equations_of_the_paper() {
    // The hinges A, B and D determine the line; Eqs. (7)-(10) are about the momenta of whole bodies.
    for arch in arches() {
        let chain = arch.chain();
        for index in 1..8 {
            let Some(link) = chain.link(index) else { break };
            let closing =
                closing_field(&chain.link(index - 1).unwrap().mechanism, chain.profile(0));
            let theorems = MomentumTheorems::solve(&link.mechanism, &closing, chain.profile(0));
            let [first, .., last] = link.impulse_line.as_ref().unwrap().hinge_impulses();
            let size = first.norm() + last.norm();
            assert!((first - theorems.impulse_first).norm() < 1e-11 * size);
            assert!((last - theorems.impulse_last).norm() < 1e-11 * size);
        }
    }
}

#[test]
fn impulses_change_the_momentum_of_each_body() {
    // Eqs. (7)-(10) use the outer hinges only. Here all three bodies are tested, in all three components: the impulses
    // on a body, and their moments, must equal the momentum that the body gains.
    for arch in arches() {
        let chain = arch.chain();
        let ring = chain.profile(0);
        for index in 1..6 {
            let Some(link) = chain.link(index) else { break };
            let closing = closing_field(&chain.link(index - 1).unwrap().mechanism, ring);
            let moved = link.mechanism.field().scaled(link.link.rate_ratio);
            let [a, b, c, d] = link.impulse_line.as_ref().unwrap().hinge_impulses();
            let on_bodies = [[a, -b], [b, c], [-c, d]];
            let (angles, points) = (link.mechanism.hinges_rad, link.mechanism.points);
            for (body, impulses) in on_bodies.into_iter().enumerate() {
                let part = |of: &archrock::mechanics::Field| {
                    of.momentum_to(ring, angles[body + 1]) - of.momentum_to(ring, angles[body])
                };
                let gain = part(&moved) - part(&closing);
                let force = impulses[0] + impulses[1];
                let moment = points[body].perp(&impulses[0]) + points[body + 1].perp(&impulses[1]);
                let size = impulses[0].norm() + impulses[1].norm();
                assert!(
                    (gain.linear - force).norm() < 1e-11 * size,
                    "{index} {body}"
                );
                assert!(
                    (gain.angular - moment).abs() < 1e-11 * size,
                    "{index} {body}"
                );
            }
        }
    }
}

#[test]
fn extremes_of_the_semicircles() {
    // The reference values were computed by sampling, to these digits.
    for (thickness_ratio, excess, tolerance, at_deg) in
        [(0.15, 0.501_99, 0.5e-5, 74.3), (0.12, 0.861, 0.5e-3, 29.6)]
    {
        let max = ImpactModel::MaxRestitution;
        let arch = arch(thickness_ratio, 180.0, ANYWHERE, max);
        let chain = arch.chain();
        let line = chain.link(1).unwrap().impulse_line.as_ref().unwrap();
        let extremes = line.extremes_from_left(ANYWHERE, Sway::Left);
        let found = extremes.eccentricity_ratio;
        assert!((found.value - excess).abs() <= tolerance, "{found:?}");
        assert!(
            (found.angle_rad.to_degrees() - at_deg).abs() <= 0.05,
            "{found:?}"
        );
        assert!(!extremes.is_admissible());
        assert!(extremes.normal.value > 0.0);
    }
}

#[test]
fn refined_extremes_are_not_below_fine_samples() {
    for arch in arches() {
        let chain = arch.chain();
        for index in 1..5 {
            let Some(link) = chain.link(index) else { break };
            let line = &link.impulse_line.as_ref().unwrap().resultants;
            let extremes = line.extremes(ANYWHERE);
            let samples = || {
                chain
                    .profile(0)
                    .sections(20_000)
                    .into_iter()
                    .map(|angle| line.section(angle))
            };
            let least = samples()
                .map(|section| section.normal)
                .fold(f64::INFINITY, f64::min);
            // A sample misses a smooth extreme by (PI/4e4)^2 times a curvature of at most about ten;
            // no line here has more, except at the poles that tension causes.
            let slack = 1e-7;
            assert!(extremes.normal.value <= least + 1e-15);
            assert!(extremes.normal.value >= least - slack);
            if extremes.normal.value <= 0.0 {
                assert!(extremes.eccentricity_ratio.value == f64::INFINITY);
                continue;
            }
            let eccentricity = samples()
                .map(|s| s.eccentricity_ratio.abs())
                .fold(0.0, f64::max);
            let friction = samples()
                .map(|s| (s.tangential / s.normal).abs())
                .fold(0.0, f64::max);
            for (found, sampled) in [
                (extremes.eccentricity_ratio.value, eccentricity),
                (extremes.friction_ratio.value, friction),
            ] {
                assert!(found >= sampled - 1e-12, "{found} {sampled}");
                assert!(found <= sampled + slack, "{found} {sampled}");
            }
            let there = line.section(extremes.friction_ratio.angle_rad);
            assert!((there.tangential / there.normal).abs() == extremes.friction_ratio.value);
        }
    }
}

#[test]
fn impulses_of_voussoirs_are_computed_at_joints_only() {
    let sites = HingeSites::Voussoirs(7);
    let arch = arch(0.15, 157.5, sites, ImpactModel::MaxRestitution);
    let chain = arch.chain();
    let line = &chain
        .link(1)
        .unwrap()
        .impulse_line
        .as_ref()
        .unwrap()
        .resultants;
    let (joints, all) = (line.extremes(sites), line.extremes(ANYWHERE));
    let by_hand = (0..=7_u32)
        .map(|i| {
            line.section(157.5_f64.to_radians() * f64::from(i) / 7.0)
                .eccentricity_ratio
                .abs()
        })
        .fold(0.0, f64::max);
    assert!((joints.eccentricity_ratio.value - by_hand).abs() < 1e-12);
    assert!(joints.eccentricity_ratio.value < all.eccentricity_ratio.value);
}

#[test]
fn the_frame_of_the_ground_is_the_mirror_image_for_a_sway_to_the_left() {
    let arch = arch(0.15, 157.5, ANYWHERE, ImpactModel::MaxRestitution);
    let chain = arch.chain();
    let line = chain.link(1).unwrap().impulse_line.as_ref().unwrap();
    let own = line.hinge_impulses();
    assert_eq!(line.hinge_impulses_from_left(Sway::Right), own);
    for (seen, own) in line
        .hinge_impulses_from_left(Sway::Left)
        .into_iter()
        .zip(own.into_iter().rev())
    {
        assert_eq!(seen, Vector2::new(-own.x, own.y));
    }
    // In the frame of the ground, the impulse on the part right of a section has the same radial and axial
    // components as the vector reported for the hinge: at hinge A it is the impulse of the ground.
    let (ring, sway) = (chain.profile(0), Sway::Left);
    let (angle, _) = chain
        .link(1)
        .unwrap()
        .mechanism
        .hinges_from_left(ring, sway)[0];
    let section = line.section_from_left(angle, sway);
    let [at_a, ..] = line.hinge_impulses_from_left(sway);
    assert!((section.normal - at_a.dot(&ring.onward_normal(angle))).abs() < 1e-12);
    assert!((section.tangential - at_a.dot(&ring.outward_direction(angle))).abs() < 1e-12);
    let extremes = line.extremes_from_left(ANYWHERE, sway);
    let there = line.section_from_left(extremes.normal.angle_rad, sway);
    assert!((there.normal - extremes.normal.value).abs() < 1e-15);
}

#[test]
fn the_part_that_stands_is_stopped_by_its_own_impulses() {
    // Between a springing and the first hinge of the new mechanism the ring stops.
    let arch = arch(0.15, 180.0, ANYWHERE, ImpactModel::MaxRestitution);
    let chain = arch.chain();
    let link = chain.link(2).unwrap();
    let [first, ..] = link.mechanism.hinges_rad;
    let closing = closing_field(&chain.link(1).unwrap().mechanism, chain.profile(0));
    assert!(first > 0.09 && closing.twist_at(0.5 * first, Side::After).rate.abs() > 0.01);
    let line = &link.impulse_line.as_ref().unwrap().resultants;
    let gained = line.resultant_at(first) - line.resultant_at(0.0);
    let lost = closing.momentum_to(chain.profile(0), first);
    assert!((gained - lost).linear.norm() < 1e-14);
}

#[test]
fn a_prescribed_restitution_has_no_impulses() {
    let model = ImpactModel::Prescribed { restitution: 0.8 };
    let arch = arch(0.15, 180.0, ANYWHERE, model);
    let chain = arch.chain();
    assert!(chain.link(3).unwrap().impulse_line.is_none());
    assert!(chain.link(0).unwrap().impulse_line.is_none());
    let first = &chain.link(0).unwrap().mechanism;
    let mirrored = impact(first, chain.profile(0), ANYWHERE, ImpactModel::Mirrored).unwrap();
    assert!(mirrored.impulse_line.is_some());
}

#[test]
fn mirrored_hinges_put_the_ring_in_tension() {
    let arch = arch(0.15, 180.0, ANYWHERE, ImpactModel::Mirrored);
    let chain = arch.chain();
    let extremes = chain
        .link(1)
        .unwrap()
        .impulse_line
        .as_ref()
        .unwrap()
        .resultants
        .extremes(ANYWHERE);
    assert!(extremes.normal.value < 0.0 && !extremes.is_admissible());
}

#[test]
fn the_unit_of_impulses_scales_with_density_and_the_cube_of_the_radius() {
    let arch = Arch::new(3.0, 0.15, 180.0).unwrap().with_depth_m(7.0);
    let arch = FourLinks::of_arch(&arch.unwrap(), ImpactModel::MaxRestitution).unwrap();
    // Mass rho R^2 per metre of depth times velocity R q'.
    assert!((arch.impulse_unit_n_s_per_m() - 2000.0 * 27.0).abs() < 1e-9);
}

/// A scenario with the arch of the paper, 3 m in radius, and further lines.
fn scenario(folder: &Path, more: &str) -> String {
    let path = folder.join("arch.toml");
    let text = format!(
        "[arch]\nmean_radius_m = 3.0\ndepth_m = 2.0\ndensity_kg_m3 = 1800.0\n\
         thickness_ratio = 0.15\nembrace_deg = 180.0\n{more}"
    );
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

fn text(arguments: &[&str]) -> String {
    printed(Path::new("."), arguments)
}

fn json(arguments: &[&str]) -> serde_json::Value {
    let arguments = [&["impact", "--format", "json"], arguments].concat();
    serde_json::from_str(&text(&arguments)).unwrap()
}

#[test]
fn impulses_models_and_certificate_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(folder.path(), "");
    let result = json(&[&path, "--models", "--certificate", "--count", "2"]);
    let arch = arch(0.15, 180.0, ANYWHERE, ImpactModel::MaxRestitution);
    let chain = arch.chain();
    // Impulses are per metre of depth, so the depth does not count.
    let unit = 1800.0 * 27.0;
    for (index, sway) in [(1, Sway::Left), (2, Sway::Right)] {
        let impact = &result["impacts"][index - 1];
        let line = chain.link(index).unwrap().impulse_line.as_ref().unwrap();
        for (i, impulse) in line.hinge_impulses_from_left(sway).into_iter().enumerate() {
            let reported = &impact["impulses"][i];
            assert_eq!(reported["hinge"], ["a", "b", "c", "d"][i]);
            assert!((reported["x_n_s_per_m"].as_f64().unwrap() / unit - impulse.x).abs() < 1e-14);
            assert!((reported["y_n_s_per_m"].as_f64().unwrap() / unit - impulse.y).abs() < 1e-14);
        }
    }
    let extremes = &result["impacts"][0]["impulse_line"];
    assert_eq!(extremes["admissible"], false);
    assert!((extremes["largest_eccentricity_ratio"].as_f64().unwrap() - 0.501_99).abs() < 0.5e-5);
    assert!((extremes["largest_eccentricity_angle_deg"].as_f64().unwrap() - 74.3).abs() < 0.05);
    // Published values, to the digits given.
    for (i, (model, restitution)) in [
        ("max_restitution", 0.681_185_59),
        ("same_sections", 0.565_36),
        ("mirrored", 0.210_85),
    ]
    .into_iter()
    .enumerate()
    {
        let reported = &result["models"][i];
        assert_eq!(reported["model"], model);
        assert!((reported["impact"]["restitution"].as_f64().unwrap() - restitution).abs() < 0.5e-5);
    }
    assert!(result["models"].get(3).is_none());
    // With tension the eccentricity is infinite, and JSON has no infinity.
    assert!(result["models"][2]["impact"]["impulse_line"]["largest_eccentricity_ratio"].is_null());
    let certificate = &result["certificate"];
    let value = |key: &str| certificate[key].as_f64().unwrap();
    assert!((value("restitution_all_fields") - 0.681_300).abs() < 1e-5);
    assert!((value("gap") - 0.000_114).abs() < 2e-6);
    assert_eq!(certificate["impulse_line_admissible"], false);
    let opened = certificate["opened_joints"].as_array().unwrap();
    let angles: Vec<f64> = opened
        .iter()
        .map(|joint| joint["angle_deg"].as_f64().unwrap())
        .collect();
    assert!(angles.is_sorted() && angles[0].abs() < 1e-9);
    assert_eq!(opened[0]["edge"], "extrados");
}

#[test]
fn a_prescribed_restitution_stands_beside_the_models() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(
        folder.path(),
        "[impact]\nmodel = \"prescribed\"\nrestitution = 0.8\n",
    );
    let result = json(&[&path, "--models"]);
    let compared = result["models"].as_array().unwrap().iter();
    let compared: Vec<_> = compared.map(|one| one["model"].as_str().unwrap()).collect();
    let all: Vec<_> = ImpactModel::ALL.iter().map(|model| model.name()).collect();
    assert_eq!(compared, all);
    assert_eq!(result["models"][3]["impact"]["restitution"], 0.8);
    assert!(result["impacts"][0]["impulses"].is_null());
    let arguments = ["impact", &path, "--line", "-"];
    refused(folder.path(), &arguments, &["prescribed"]);
}

#[test]
fn the_line_as_csv_touches_the_edges_at_the_hinges() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(folder.path(), "");
    let file = folder.path().join("line.csv");
    let file = file.to_str().unwrap();
    for (link, hinges) in [
        (
            "1",
            [
                (0.0, 0.5),
                (76.376_11, -0.5),
                (133.816_20, 0.5),
                (180.0, -0.5),
            ],
        ),
        (
            "2",
            [
                (5.658_52, -0.5),
                (71.715_17, 0.5),
                (137.012_00, -0.5),
                (180.0, 0.5),
            ],
        ),
    ] {
        text(&["impact", &path, "--line", file, "--link", link]);
        let table = Table::read(file);
        let expected = [
            "angle_deg",
            "eccentricity_ratio",
            "normal_n_s_per_m",
            "tangential_n_s_per_m",
        ];
        assert_eq!(*table.header, expected);
        assert!(table.numbers("angle_deg").is_sorted_by(|a, b| a < b));
        for (angle_deg, eccentricity) in hinges {
            let near = |row: &&Row| (row.number("angle_deg") - angle_deg).abs() < 1e-5;
            let row = table.rows.iter().find(near).unwrap();
            let found = row.number("eccentricity_ratio");
            assert!((found - eccentricity).abs() < 1e-10, "{row:?}");
        }
        let piped = text(&["impact", &path, "--line", "-", "--link", link]);
        assert_eq!(piped, std::fs::read_to_string(file).unwrap());
    }
    refused(
        folder.path(),
        &["impact", &path, "--line", "."],
        &["--line"],
    );
}

#[test]
fn impulses_of_a_run_are_in_newton_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(
        folder.path(),
        "[ground.rectangular]\namplitude_g = -0.3\nduration_s = 0.15\n",
    );
    let out = folder.path().join("out");
    text(&["run", &path, "--quiet", "--out", out.to_str().unwrap()]);
    let rows = Table::read(out.join("impacts.csv")).rows;
    assert!(rows.len() > 3);
    let ring = Ring::new(0.15, PI).unwrap();
    for row in &rows {
        let value = |name: &str| row.number(name);
        // The right body turns about hinge D with the rate after the impact. The test is the angular momentum theorem
        // about hinge C for it (Eq. (9) or (10) of the paper), with the impulse at D, all in SI. Its momentum before
        // is that of the bodies of the closing mechanism inside it; only for the first impact, whose mechanisms are
        // published, can it be computed here from the table.
        let impulses = |name: &str| {
            Vector2::new(
                value(&format!("impulse_{name}_x_n_s")),
                value(&format!("impulse_{name}_y_n_s")),
            )
        };
        let [a, b, c, d] = ["a", "b", "c", "d"].map(impulses);
        assert!([a, b, c, d].into_iter().all(|impulse| impulse.norm() > 0.0));
        // Thrusts: the ground and the neighbouring bodies compress the arch.
        assert!(b.x > 0.0 && c.x < 0.0);
        if row["impact"] != "1" {
            continue;
        }
        let radius = 3.0;
        let mass = 1800.0 * 2.0 * radius * radius;
        let hinge = |angle_deg: f64, edge| ring.point(f64::to_radians(angle_deg), edge);
        let (point_c, point_d) = (
            hinge(value("hinge_c_deg"), Edge::Extrados),
            hinge(value("hinge_d_deg"), Edge::Intrados),
        );
        let from = value("hinge_c_deg").to_radians();
        // Before: up to the hinge at 139.56130 degrees the middle body of the first mechanism; from there the
        // right body, which turns about its hinge D on the extrados at the springing.
        let closing_c = 139.561_301_636_45_f64;
        let (right_before, middle_before) = (
            value("rate_right_before_rad_s"),
            value("rate_middle_before_rad_s"),
        );
        let about = |pole, rate| archrock::mechanics::Twist::rotation(pole, rate);
        let right = about(hinge(180.0, Edge::Extrados), right_before);
        let at_c = hinge(closing_c, Edge::Intrados);
        let middle = right + about(at_c, middle_before - right_before);
        let before = middle.momentum(&ring.sector(from, closing_c.to_radians()))
            + right.momentum(&ring.sector(closing_c.to_radians(), PI));
        let after =
            about(point_d, value("rate_right_after_rad_s")).momentum(&ring.sector(from, PI));
        let gain = (after - before).moment_about(point_c) * (mass * radius * radius);
        let moment = ((point_d - point_c) * radius).perp(&d);
        assert!(
            (gain - moment).abs() < 1e-8 * moment.abs(),
            "{gain} {moment}"
        );
    }
}
