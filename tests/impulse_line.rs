//! The impulses of an impact against the momentum theorems, published numbers and statics by hand.
#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use archrock::mechanics::arch::Arch;
use archrock::mechanics::chain::Chain;
use archrock::mechanics::field::Side;
use archrock::mechanics::impact::{ImpactModel, MomentumTheorems, closing_field, impact};
use archrock::mechanics::mechanism::{EDGES, HingeSites, Sway};
use archrock::mechanics::ring::{Edge, Ring};
use nalgebra::Vector2;

const ANYWHERE: HingeSites = HingeSites::Anywhere;

fn chain(thickness_ratio: f64, embrace_deg: f64, sites: HingeSites, model: ImpactModel) -> Chain {
    let ring = Ring::new(thickness_ratio, embrace_deg.to_radians()).unwrap();
    Chain::new(ring, sites, model).unwrap()
}

fn chains() -> Vec<Chain> {
    let max = ImpactModel::MaxRestitution;
    vec![
        chain(0.15, 180.0, ANYWHERE, max),
        chain(0.12, 180.0, ANYWHERE, max),
        chain(0.30, 180.0, ANYWHERE, max),
        chain(0.15, 157.5, ANYWHERE, max),
        chain(0.15, 157.5, HingeSites::Voussoirs(7), max),
        chain(0.10, 120.0, ANYWHERE, max),
        chain(0.15, 180.0, ANYWHERE, ImpactModel::SameSections),
        chain(0.15, 180.0, ANYWHERE, ImpactModel::Mirrored),
    ]
}

#[test]
fn the_line_passes_through_all_four_hinges() {
    for chain in chains() {
        for index in 1..8 {
            let Some(link) = chain.link(index) else { break };
            let line = link.impulse_line.as_ref().unwrap();
            for (angle, edge) in link.mechanism.hinges_rad().into_iter().zip(EDGES) {
                let expected = match edge {
                    Edge::Intrados => -0.5,
                    Edge::Extrados => 0.5,
                };
                let found = line.resultants().section(angle).eccentricity_ratio;
                assert!((found - expected).abs() < 1e-10, "{index} {angle}: {found}");
            }
        }
    }
}

#[test]
fn outer_impulses_solve_the_equations_of_the_paper() {
    // The line is determined by the hinges A, B and D, Eqs. (7)-(10) by the momenta of whole bodies.
    for chain in chains() {
        for index in 1..8 {
            let Some(link) = chain.link(index) else { break };
            let closing = closing_field(&chain.link(index - 1).unwrap().mechanism, chain.ring());
            let theorems = MomentumTheorems::solve(&link.mechanism, &closing, chain.ring());
            let [first, .., last] = link.impulse_line.as_ref().unwrap().hinge_impulses();
            let size = first.norm() + last.norm();
            assert!((first - theorems.impulse_first).norm() < 1e-11 * size);
            assert!((last - theorems.impulse_last).norm() < 1e-11 * size);
        }
    }
}

#[test]
fn impulses_change_the_momentum_of_each_body() {
    // Eqs. (7)-(10) name the outer hinges only. Here all three bodies, in all three components: the impulses
    // on a body and their moments against the momentum that the body gains.
    for chain in chains() {
        let ring = chain.ring();
        for index in 1..6 {
            let Some(link) = chain.link(index) else { break };
            let closing = closing_field(&chain.link(index - 1).unwrap().mechanism, ring);
            let moved = link.mechanism.field().scaled(link.link.rate_ratio);
            let [a, b, c, d] = link.impulse_line.as_ref().unwrap().hinge_impulses();
            let on_bodies = [[a, -b], [b, c], [-c, d]];
            let (angles, points) = (link.mechanism.hinges_rad(), link.mechanism.points());
            for (body, impulses) in on_bodies.into_iter().enumerate() {
                let part = |of: &archrock::mechanics::field::Field| {
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
    // The reference values were computed by sampling, to the digits given.
    for (thickness_ratio, excess, tolerance, at_deg) in
        [(0.15, 0.501_99, 0.5e-5, 74.3), (0.12, 0.861, 0.5e-3, 29.6)]
    {
        let chain = chain(
            thickness_ratio,
            180.0,
            ANYWHERE,
            ImpactModel::MaxRestitution,
        );
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
    for chain in chains() {
        for index in 1..5 {
            let Some(link) = chain.link(index) else { break };
            let line = link.impulse_line.as_ref().unwrap().resultants();
            let extremes = line.extremes(ANYWHERE);
            let samples = || {
                chain
                    .ring()
                    .sections(100_000)
                    .into_iter()
                    .map(|angle| line.section(angle))
            };
            let least = samples()
                .map(|section| section.normal)
                .fold(f64::INFINITY, f64::min);
            // A sample misses a smooth extreme by (PI/2e5)^2 times a curvature of the order of ten at most;
            // the lines here have no more, but for the poles that tension leaves.
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
fn voussoirs_are_asked_at_their_joints_only() {
    let sites = HingeSites::Voussoirs(7);
    let chain = chain(0.15, 157.5, sites, ImpactModel::MaxRestitution);
    let line = chain
        .link(1)
        .unwrap()
        .impulse_line
        .as_ref()
        .unwrap()
        .resultants();
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
    let chain = chain(0.15, 157.5, ANYWHERE, ImpactModel::MaxRestitution);
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
    // In the frame of the ground the impulse on the part right of a section has the same components along
    // the radius and the axis as the vector that the hinges tell: at hinge A that is the ground's impulse.
    let (ring, sway) = (chain.ring(), Sway::Left);
    let (angle, _) = chain
        .link(1)
        .unwrap()
        .mechanism
        .hinges_from_left(ring, sway)[0];
    let section = line.section_from_left(angle, sway);
    let [at_a, ..] = line.hinge_impulses_from_left(sway);
    assert!((section.normal - at_a.dot(&ring.tangent(angle))).abs() < 1e-12);
    assert!((section.tangential - at_a.dot(&ring.radial(angle))).abs() < 1e-12);
    let extremes = line.extremes_from_left(ANYWHERE, sway);
    let there = line.section_from_left(extremes.normal.angle_rad, sway);
    assert!((there.normal - extremes.normal.value).abs() < 1e-15);
}

#[test]
fn the_part_that_stands_is_stopped_by_its_own_impulses() {
    // Between a springing and the first hinge of the new mechanism the ring comes to a stand.
    let chain = chain(0.15, 180.0, ANYWHERE, ImpactModel::MaxRestitution);
    let link = chain.link(2).unwrap();
    let [first, ..] = link.mechanism.hinges_rad();
    let closing = closing_field(&chain.link(1).unwrap().mechanism, chain.ring());
    assert!(first > 0.09 && closing.at(0.5 * first, Side::After).rate.abs() > 0.01);
    let line = link.impulse_line.as_ref().unwrap().resultants();
    let gained = line.at(first) - line.at(0.0);
    let lost = closing.momentum_to(chain.ring(), first);
    assert!((gained - lost).linear.norm() < 1e-14);
}

#[test]
fn a_prescribed_restitution_has_no_impulses() {
    let model = ImpactModel::Prescribed { restitution: 0.8 };
    let chain = chain(0.15, 180.0, ANYWHERE, model);
    assert!(chain.link(3).unwrap().impulse_line.is_none());
    assert!(chain.link(0).unwrap().impulse_line.is_none());
    let first = &chain.link(0).unwrap().mechanism;
    let mirrored = impact(first, chain.ring(), ANYWHERE, ImpactModel::Mirrored).unwrap();
    assert!(mirrored.impulse_line.is_some());
}

#[test]
fn mirrored_hinges_put_the_ring_in_tension() {
    let chain = chain(0.15, 180.0, ANYWHERE, ImpactModel::Mirrored);
    let extremes = chain
        .link(1)
        .unwrap()
        .impulse_line
        .as_ref()
        .unwrap()
        .resultants()
        .extremes(ANYWHERE);
    assert!(extremes.normal.value < 0.0 && !extremes.is_admissible());
}

#[test]
fn the_unit_of_impulses_scales_with_density_and_the_cube_of_the_radius() {
    let arch = Arch {
        mean_radius_m: 3.0,
        depth_m: 7.0,
        density_kg_m3: 2000.0,
        chain: chain(0.15, PI.to_degrees(), ANYWHERE, ImpactModel::MaxRestitution).into(),
    };
    // Mass rho R^2 per metre of depth times velocity R q'.
    assert!((arch.impulse_unit_n_s_per_m() - 2000.0 * 27.0).abs() < 1e-9);
}
