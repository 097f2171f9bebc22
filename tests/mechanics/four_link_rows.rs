//! Four links on rows of blocks: circular voussoirs against the ring, static against kinematic theorem, mirror images.

use crate::common::{Random, random_masonry};
use archrock::dynamics::FreeHinges;
use archrock::mechanics::four_link::{closing_field, project};
use archrock::mechanics::masonry::{
    Dimensions, Masonry, MasonryShape, Material, Piers, PlacedLoad,
};
use archrock::mechanics::stability::{collapse_mechanism, onset};
use archrock::mechanics::{Block, Row, Supports};
use archrock::mechanics::{Hinge, Mechanism as _, MechanismChain as _, Ring};
use archrock::{
    Arch, FourLinkError, FourLinks, GroundMotion, ImpactLaw, ImpactModel, Initial, Model as _,
    Outcome, Pulse, Request, Sample, Sway,
};
use nalgebra::Vector2;

const SIDES: [Sway; 2] = [Sway::Right, Sway::Left];

fn ring(embrace_deg: f64) -> Ring {
    Ring::new(0.15, embrace_deg.to_radians()).unwrap()
}

fn circular(embrace_deg: f64, voussoirs: usize) -> (FourLinks, Row) {
    let arch = Arch::new(5.0, 0.15, embrace_deg).unwrap();
    let arch = arch.with_voussoirs(voussoirs).unwrap();
    let row = Row::arch(&arch.ring(), voussoirs, 5.0, 1.0, 2000.0).unwrap();
    let arch = FourLinks::of_arch(&arch, ImpactModel::MaxRestitution).unwrap();
    (arch, row)
}

fn rocking(row: &Row) -> FourLinks {
    FourLinks::of_row(row, ImpactModel::MaxRestitution).unwrap()
}

fn push(amplitude_g: f64) -> GroundMotion {
    Pulse::Rectangular
        .lasting_s(0.2)
        .horizontal_m_s2(amplitude_g * 9.81)
        .unwrap()
}

fn joints(model: &FourLinks, impacts: usize, sway: Sway) -> Vec<usize> {
    let hinges = model.hinges(impacts, sway).into_iter();
    hinges
        .map(|hinge| match hinge {
            Hinge::Joint { joint, .. } => joint,
            other => panic!("{other:?}"),
        })
        .collect()
}

/// The voussoirs of a ring as blocks without any knowledge of the ring.
#[test]
fn circular_voussoirs_as_a_row_are_those_of_the_ring() {
    for (embrace_deg, voussoirs) in [(157.5, 7), (180.0, 18), (180.0, 60)] {
        let (arch, row) = circular(embrace_deg, voussoirs);
        let model = rocking(&row);
        let sections = ring(embrace_deg).sections(voussoirs);
        for first in SIDES {
            let there = model.incipient_towards_g(first);
            assert!((there / arch.incipient_g() - 1.0).abs() < 1e-12, "{there}");
            for impacts in 0..8 {
                let (exact, own) = (
                    arch.link_from(first, impacts).unwrap(),
                    model.link_from(first, impacts).unwrap(),
                );
                assert!((own.restitution - exact.restitution).abs() < 1e-12);
                assert!((own.critical_rad / exact.critical_rad - 1.0).abs() < 1e-11);
                let sway = first.after(impacts);
                let at: Vec<f64> = joints(&model, impacts, sway)
                    .into_iter()
                    .map(|joint| sections[joint])
                    .collect();
                let hinges = arch.hinges(impacts, sway);
                for (angle, hinge) in at.iter().zip(hinges) {
                    let Hinge::Section { angle_rad, .. } = hinge else {
                        panic!("{hinge:?}");
                    };
                    assert!((angle - angle_rad).abs() < 1e-12);
                }
            }
        }
        let ground = push(-1.8 * arch.incipient_g());
        let request = Request {
            output_step_s: 0.01,
            ..Request::default()
        };
        let exact = arch.history(&ground, &request).unwrap();
        let own = model.history(&ground, &request).unwrap();
        assert_eq!(own.summary.outcome, exact.summary.outcome);
        assert_eq!(own.summary.impacts, exact.summary.impacts);
        let peaks = own.summary.peak_rotations_rad.iter();
        for (peak, there) in peaks.zip(&exact.summary.peak_rotations_rad) {
            assert!((peak / there - 1.0).abs() < 1e-9);
        }
        let thrusts = [&own, &exact].map(|history| history.summary.thrust.unwrap());
        let [excess, there] = thrusts.map(|thrust| thrust.largest_excess.value);
        assert!((excess - there).abs() < 1e-7, "{excess} {there}");
        let frictions = [&own, &exact].map(|history| history.summary.required_friction());
        let [friction, there] = frictions.map(Option::unwrap);
        assert!((friction - there).abs() < 1e-7, "{friction} {there}");
    }
}

/// Voussoirs whose curved sides are polygons with `n` sides: errors fall with the square of `n`.
#[test]
fn many_sided_voussoirs_converge_to_sectors() {
    let (arch, exact) = circular(157.5, 7);
    let sections = ring(157.5).sections(7);
    let errors = [8, 16, 32].map(|sides| {
        let outline = |ends: &[f64]| {
            let at = |i: u32| ends[0] + (ends[1] - ends[0]) * f64::from(i) / f64::from(sides);
            let point = |i, radius: f64| ring(157.5).radial_direction(at(i)) * (5.0 * radius);
            let outer = (0..=sides).map(|i| point(i, 1.075));
            outer
                .chain((0..=sides).rev().map(|i| point(i, 0.925)))
                .collect::<Vec<_>>()
        };
        let outlines = sections.windows(2).map(outline);
        let blocks = outlines.map(|outline| Block::prism(&outline, 1.0, 2000.0));
        let joints = exact.joints.to_vec();
        let row = Row::new(blocks.collect(), joints, Supports::Both, 5.0).unwrap();
        let model = rocking(&row);
        let ground = push(-0.5);
        let request = Request::default();
        let peak = |model: &dyn archrock::Model| {
            let summary = model.simulate(&ground, &request, None).unwrap();
            summary.peak_rotations_rad[0]
        };
        [
            model.incipient_g() / arch.incipient_g() - 1.0,
            model.link(1).unwrap().restitution - arch.link(1).unwrap().restitution,
            peak(&model) / peak(&arch) - 1.0,
        ]
    });
    let [coarse, middle, fine] = errors;
    for ((coarse, middle), fine) in coarse.into_iter().zip(middle).zip(fine) {
        for ratio in [coarse / middle, middle / fine] {
            assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
        }
        assert!(fine.abs() < 1e-4);
    }
}

/// If four links start (kinematic theorem, confirmed by the thrust line), they start at the push that the static
/// programme finds for any number of hinges. If four links are refused, that push is lower, or more joints open.
#[test]
fn static_and_kinematic_theorem_agree_on_random_shapes() {
    let mut random = Random(12);
    let (mut compared, mut refused, mut standing) = (0, 0, 0);
    while standing < 200 {
        let Some(masonry) = random_masonry(&mut random) else {
            continue;
        };
        let row = &masonry.row;
        if collapse_mechanism(row).unwrap().is_some() {
            continue;
        }
        standing += 1;
        let of_static = SIDES.map(|sway| onset(row, sway).unwrap());
        match FourLinks::of_row(row, ImpactModel::MaxRestitution) {
            Ok(model) => {
                let free = FreeHinges::new(row.clone()).unwrap();
                for (sway, of_static) in SIDES.into_iter().zip(&of_static) {
                    let (own, there) = (
                        model.incipient_towards_g(sway),
                        of_static.as_ref().unwrap().acceleration_g,
                    );
                    assert!(
                        (own / there - 1.0).abs() < 1e-8,
                        "{own} {there} {masonry:?}"
                    );
                    let free_g = free.incipient_acceleration_g(sway).unwrap();
                    assert!((own / free_g - 1.0).abs() < 1e-8);
                    compared += 1;
                }
            }
            Err(FourLinkError::Row(sway, _)) => {
                let side = usize::from(sway == Sway::Left);
                let openings = of_static[side]
                    .as_ref()
                    .map_or(0, |onset| onset.openings.len());
                assert_ne!(openings, 4, "{masonry:?}");
                refused += 1;
            }
            Err(error) => panic!("{error} {masonry:?}"),
        }
    }
    assert!(compared >= 200, "{compared} compared, {refused} refused");
}

/// A sway to the right of a row is a sway to the left of its mirror image, and nothing else changes.
#[test]
fn mirror_images_of_uneven_rows() {
    let mut random = Random(3);
    let mut compared = 0;
    while compared < 10 {
        let Some(masonry) = random_masonry(&mut random) else {
            continue;
        };
        let mirrored = masonry.row.mirrored().unwrap();
        let Ok(own) = FourLinks::of_row(&masonry.row, ImpactModel::MaxRestitution) else {
            continue;
        };
        let there = rocking(&mirrored);
        let last = mirrored.joints.len() - 1;
        for first in SIDES {
            let (a, b) = (
                own.incipient_towards_g(first),
                there.incipient_towards_g(first.opposite()),
            );
            assert_eq!(a.to_bits(), b.to_bits());
            for impacts in 0..4 {
                let (a, b) = (
                    own.link_from(first, impacts),
                    there.link_from(first.opposite(), impacts),
                );
                assert_eq!(a.map(|l| l.restitution), b.map(|l| l.restitution));
                let sway = first.after(impacts);
                let mut hinges = joints(&own, impacts, sway);
                hinges.reverse();
                let hinges: Vec<usize> = hinges.into_iter().map(|joint| last - joint).collect();
                assert_eq!(hinges, joints(&there, impacts, sway.opposite()));
            }
        }
        let amplitude_g = 2.0 * own.incipient_g();
        let run = |model: &FourLinks, sign: f64| {
            model
                .history(&push(sign * amplitude_g), &Request::default())
                .unwrap()
        };
        let (history, image) = (run(&own, -1.0), run(&there, 1.0));
        assert_eq!(history.samples.len(), image.samples.len());
        for (sample, seen) in history.samples.iter().zip(image.samples.iter()) {
            let mirrored: Vec<f64> = seen.rotations_rad.iter().rev().map(|q| -q + 0.0).collect();
            assert_eq!(sample.rotations_rad, mirrored);
        }
        let mirrored = match image.summary.outcome {
            Outcome::Overturned(sway) => Outcome::Overturned(sway.opposite()),
            other => other,
        };
        assert_eq!(history.summary.outcome, mirrored);
        compared += 1;
    }
}

/// The cone of all motions that open joints bounds the restitution of four links. It also gives the energy that free
/// hinges keep when the same mechanism shuts all at once.
#[test]
fn the_certificate_bounds_the_impact_of_a_row() {
    let dimensions = Dimensions {
        span_m: 10.0,
        rise_m: 6.5,
        thickness_m: 0.9,
        voussoirs: 14,
        material: Material::default(),
    };
    let load = PlacedLoad::mass(2500.0, 1.5);
    let shape = MasonryShape::PointedArch(dimensions);
    let masonry = Masonry::new(shape, Piers::default(), None, vec![load]).unwrap();
    let model = rocking(&masonry.row);
    for first in SIDES {
        let chain = model.chain_from(first);
        let closing = &chain.link(0).unwrap().mechanism;
        let profile = chain.profile(1);
        let field = closing_field(closing, profile);
        let cone = project(&field, profile, &profile.sections(0)).unwrap();
        let own = chain.link(1).unwrap();
        let gap = cone.restitution - own.link.restitution;
        assert!((-1e-9..0.02).contains(&gap), "{gap}");
        let line = own.impulse_line.as_ref().unwrap();
        let admissible = line.resultants.extremes(chain.sites).is_admissible();
        assert_eq!(admissible, gap < 1e-7, "{gap}");
        // Impulses at the hinges carry no moment: the line passes through all four corners.
        for (section, edge) in own.mechanism.hinges_from_left(profile, Sway::Right) {
            let moment = line
                .resultants
                .resultant_at(section)
                .moment_about(profile.point(section, edge));
            assert!(moment.abs() < 1e-12);
        }
    }
}

/// During motion the thrust line passes through the four hinges, by the equation of motion; at the release it is that of
/// gravity.
#[test]
fn the_thrust_line_in_motion_passes_through_the_hinges() {
    let (_, row) = circular(180.0, 18);
    let row = row.with_body(
        12,
        &Block {
            mass_kg: 900.0,
            centre_m: Vector2::new(2.0, 5.0),
            inertia_kg_m2: 10.0,
        },
    );
    let model = rocking(&row);
    for first in SIDES {
        let chain = model.chain_from(first);
        let link = chain.link(0).unwrap();
        let linkage = &link.link.mechanism;
        let q_rad = 0.3 * link.link.critical_rad;
        let c = linkage.coefficients(q_rad);
        let (rate, body_force_g) = (0.2, Vector2::new(0.15, -1.0));
        let acceleration = (body_force_g.x * c.s_x + body_force_g.y * c.s_y
            - 0.5 * c.inertia_slope * rate * rate)
            / c.inertia;
        let motion = archrock::mechanics::MechanismState {
            q_rad,
            rate,
            acceleration,
            body_force_g,
        };
        let line = linkage.thrust_line(&motion);
        let profile = chain.profile(0);
        for (section, edge) in link.mechanism.hinges_from_left(profile, Sway::Right) {
            let moment = line
                .resultant_at(section)
                .moment_about(profile.point(section, edge));
            assert!(moment.abs() < 1e-12, "{moment}");
        }
    }
}

/// Shapes of any kind, with fill, piers and loads, released in their first mechanism. With free hinges they have the energy of the
/// linkage, and fall back as it does until a fifth hinge opens or hinges close. The error of the leapfrog is of the square of its step.
#[test]
fn a_row_with_free_hinges_is_released_as_its_four_links() {
    let mut random = Random(29);
    let (mut compared, mut samples) = (0, 0);
    while compared < 12 {
        let Some(masonry) = random_masonry(&mut random) else {
            continue;
        };
        let Ok(four) = FourLinks::of_row(&masonry.row, ImpactModel::MaxRestitution) else {
            continue;
        };
        let free = FreeHinges::new(masonry.row.clone()).unwrap();
        let joules = four.joules_per_unit() * 9.81 / four.length_m();
        let sway = SIDES[compared % 2];
        let first = four.link_from(sway, 0).unwrap();
        let least = SIDES.map(|sway| four.link_from(sway, 0).unwrap().barrier);
        let barrier_j = free.barrier_j(9.81).unwrap();
        assert!((barrier_j / (joules * least[0].min(least[1])) - 1.0).abs() < 1e-12);
        let rotation_rad = 0.4 * first.critical_rad;
        let request = Request {
            initial: Some(Initial {
                sway,
                rotation_rad,
                rate_rad_s: 0.0,
            }),
            output_step_s: 0.005,
            end_s: 1.0,
            ..Request::default()
        };
        let still = GroundMotion::still();
        let [four, free] = [
            four.history(&still, &request).unwrap(),
            free.history(&still, &request).unwrap(),
        ];
        let height_j = joules * first.mechanism.displacement(rotation_rad).y;
        let start = free.samples.get(0).unwrap();
        assert!((start.energy_j / height_j - 1.0).abs() < 1e-9);
        let impact_s = four
            .events
            .iter()
            .map(|event| event.time_s)
            .fold(f64::INFINITY, f64::min);
        for (own, there) in free.samples.iter().zip(four.samples.iter()) {
            let hinges = |sample: &Sample| -> Vec<Hinge> {
                sample.hinges.iter().map(|open| open.hinge).collect()
            };
            if there.time_s > impact_s - 0.01 || (own.time_s > 0.0 && own.hinges.len() > 4) {
                break;
            }
            assert_eq!(hinges(&own), hinges(&there), "at {} s", own.time_s);
            for (hinge, there) in own.hinges.iter().zip(&there.hinges) {
                let miss_m = (hinge.position_m - there.position_m).norm();
                assert!(miss_m < 1e-6, "{miss_m} at {} s", own.time_s);
            }
            samples += 1;
        }
        compared += 1;
    }
    assert!(samples > 200, "{samples}");
}

#[test]
fn an_uneven_row_is_released_and_overturns_by_side() {
    let (_, row) = circular(180.0, 18);
    let load = Block {
        mass_kg: 3000.0,
        centre_m: Vector2::new(2.5, 5.0),
        inertia_kg_m2: 0.0,
    };
    let model = rocking(&row.with_body(13, &load));
    let [right, left] = SIDES.map(|sway| model.incipient_towards_g(sway));
    assert!((right / left - 1.0).abs() > 0.05);
    // A pulse between the two moves it only to the weaker side.
    let between_g = 0.5 * (right + left);
    let weaker = if right < left {
        Sway::Right
    } else {
        Sway::Left
    };
    for (side, moves) in [(weaker, true), (weaker.opposite(), false)] {
        let ground = push(-side.sign() * between_g);
        let summary = model.simulate(&ground, &Request::default(), None).unwrap();
        assert_eq!(summary.outcome != Outcome::NeverMoved, moves, "{side:?}");
    }
    for sway in SIDES {
        let critical_rad = model.link_from(sway, 0).unwrap().critical_rad;
        for (part, falls) in [(0.999, false), (1.001, true)] {
            let request = Request {
                initial: Some(Initial {
                    sway,
                    rotation_rad: part * critical_rad,
                    rate_rad_s: 0.0,
                }),
                ..Request::default()
            };
            let summary = model
                .simulate(&GroundMotion::still(), &request, None)
                .unwrap();
            assert_eq!(summary.outcome == Outcome::Overturned(sway), falls);
        }
    }
}

#[test]
fn measured_restitution_scales_that_of_the_model() {
    let (_, row) = circular(157.5, 7);
    let law = |restitution_factor| ImpactLaw {
        model: ImpactModel::MaxRestitution,
        restitution_factor,
    };
    let theory = rocking(&row);
    for (factor, most) in [(0.67, 1.0), (0.96, 1.0), (1.9, 1.0)] {
        let measured = FourLinks::of_row(&row, law(factor)).unwrap();
        let arch = Arch::new(10.0, 0.15, 157.5)
            .unwrap()
            .with_voussoirs(7)
            .unwrap();
        let arch = FourLinks::of_arch(&arch, law(factor)).unwrap();
        for impacts in 1..4 {
            let own = measured.link(impacts).unwrap();
            let there = theory.link(impacts).unwrap();
            let expected = f64::min(factor * there.restitution, most);
            assert!((own.restitution - expected).abs() < 1e-15);
            // The fraction of the energy, from the ratio of the rates.
            let before = measured.link(impacts - 1).unwrap();
            let kept = own.rate_ratio.powi(2) * own.at_zero.inertia / before.at_zero.inertia;
            assert!((kept - expected).abs() < 1e-12);
            assert!((arch.link(impacts).unwrap().restitution - expected).abs() < 1e-12);
        }
    }
    let refused = FourLinks::of_row(&row, law(-0.1)).unwrap_err().to_string();
    assert!(refused.contains("restitution_factor"), "{refused}");
    // No energy is left.
    let stopped = FourLinks::of_row(&row, law(0.0)).unwrap();
    let summary = stopped
        .simulate(&push(-0.5), &Request::default(), None)
        .unwrap();
    assert_eq!((summary.outcome, summary.impacts), (Outcome::Rest, 1));
}

#[test]
fn the_factor_is_read_and_written() {
    let text = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\n[impact]\nrestitution_factor = 0.95\n";
    let scenario = archrock::Scenario::parse(text, "a.toml").unwrap();
    assert_eq!(scenario.motion.impact().restitution_factor, 0.95);
    assert_eq!(
        archrock::Scenario::parse(&scenario.to_toml(), "a.toml").unwrap(),
        scenario
    );
    let refused = archrock::Scenario::parse(&text.replace("0.95", "-1"), "a.toml").unwrap_err();
    assert!(
        refused
            .to_string()
            .starts_with("a.toml:6:22: `restitution_factor = -1` is out of range")
    );
}
