//! Incipient rocking compared with published numbers and with statics.
//!
//! The independent reference is the static theorem: the largest push under which some thrust line stays in
//! the ring, by linear programming over the reaction at the left springing. It uses no mechanism.

use std::fs;

use crate::common;
use crate::common::program::{archrock, printed, scenarios};
use crate::common::prose::shows;
use crate::common::{Random, assert_hinges, climb, parsed, ring};
use archrock::Sway;
use archrock::mechanics::Ring;
use archrock::mechanics::four_link::carries_its_weight;
use archrock::mechanics::four_link::{
    FourLink, HingeSites, LimitError, Linkage, acceleration_g, incipient, least_thickness_ratio,
};
use archrock::mechanics::{Edge, Mechanism, critical_rad};
use archrock::scenario::Scenario;
use archrock::studies::limit;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver as _, NonnegativeConeT, SolverStatus,
};
use proptest::prelude::*;
use serde_json::Value;

/// `row . x <= bound`.
pub type Constraint = (Vec<f64>, f64);

/// Maximises `goal . x` under the constraints, by Seidel's incremental algorithm. Constraints are added one by
/// one; the optimum moves onto the plane of each that it violates, where the problem has one variable less.
/// `None` if no `x` is feasible. Needs a bounding box among the first constraints (see `boxed`).
pub fn maximise(goal: &[f64], constraints: &[Constraint], half_width: f64) -> Option<Vec<f64>> {
    let n = goal.len();
    if n == 1 {
        let (mut low, mut high) = (-half_width, half_width);
        for (row, bound) in constraints {
            match row[0] {
                a if a > 1e-12 => high = high.min(bound / a),
                a if a < -1e-12 => low = low.max(bound / a),
                // The constraint is void, unless it cannot be satisfied.
                _ if *bound < -1e-9 => return None,
                _ => {}
            }
        }
        let feasible = low <= high + 1e-12 * (1.0 + high.abs());
        return feasible.then(|| vec![if goal[0] > 0.0 { high } else { low }]);
    }
    let mut x: Vec<f64> = goal
        .iter()
        .map(|g| if *g < 0.0 { -half_width } else { half_width })
        .collect();
    for (i, (row, bound)) in constraints.iter().enumerate() {
        let dot: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
        let reach: f64 = row.iter().zip(&x).map(|(a, x)| (a * x).abs()).sum();
        if dot <= bound + 1e-14 * (reach + bound.abs()) {
            continue;
        }
        let pivot = (0..n).max_by(|a, b| row[*a].abs().total_cmp(&row[*b].abs()))?;
        if row[pivot].abs() < 1e-12 {
            return None;
        }
        // x[pivot] = (bound - sum of the others) / row[pivot].
        let reduce = |other: &[f64], other_bound: f64| -> Constraint {
            let factor = other[pivot] / row[pivot];
            let rest = (0..n).filter(|j| *j != pivot);
            let reduced = rest.map(|j| other[j] - factor * row[j]).collect();
            (reduced, other_bound - factor * bound)
        };
        let mut axis = vec![0.0; n];
        axis[pivot] = 1.0;
        let upper = reduce(&axis, half_width);
        axis[pivot] = -1.0;
        let lower = reduce(&axis, half_width);
        let mut smaller = vec![upper, lower];
        smaller.extend(constraints[..i].iter().map(|(r, b)| reduce(r, *b)));
        let (reduced_goal, _) = reduce(goal, 0.0);
        let mut others = maximise(&reduced_goal, &smaller, half_width)?.into_iter();
        x = (0..n)
            .map(|j| {
                if j == pivot {
                    0.0
                } else {
                    others.next().unwrap()
                }
            })
            .collect();
        let rest: f64 = (0..n).map(|j| row[j] * x[j]).sum();
        x[pivot] = (bound - rest) / row[pivot];
    }
    Some(x)
}

/// Largest push to the right, in units of gravity, for which a thrust line stays within the ring at all of the
/// given sections (sorted); `None` if not even the weight alone can be carried. The load is added up by
/// Simpson's rule over thin slices: the weight of a slice is at `1 + t^2/12` from the centre.
fn static_limit_g(ring: &Ring, sections: &[f64]) -> Option<f64> {
    let t = ring.thickness_ratio;
    let centre = 1.0 + t * t / 12.0;
    let half = 0.5 * ring.embrace_rad;
    // Position of a slice; angles from the left springing.
    let place = |angle: f64| (centre * (angle - half).sin(), centre * (angle - half).cos());
    // Unknown (h, v, m, a): force of the left springing on the ring, its moment about O, the push.
    let mut constraints: Vec<Constraint> = Vec::new();
    let (mut mass, mut mx, mut my, mut from) = (0.0, 0.0, 0.0, 0.0);
    for section in sections {
        let slices = 40;
        let width = (section - from) / f64::from(slices);
        for slice in 0..slices {
            let at = |part: f64| place(from + width * (f64::from(slice) + part));
            let (low, middle, high) = (at(0.0), at(0.5), at(1.0));
            mass += t * width;
            mx += t * width / 6.0 * (low.0 + 4.0 * middle.0 + high.0);
            my += t * width / 6.0 * (low.1 + 4.0 * middle.1 + high.1);
        }
        from = *section;
        let (sin, cos) = (section - half).sin_cos();
        // Resultant of everything before the section: force (h + a mass, v - mass), moment m - a my - mx about O
        // (a push a to +x at height y turns clockwise, and so does the weight -1 at x).
        // Axis towards the right springing: (cos, -sin). Point of the section at radius rho: rho (sin, cos).
        let normal = [cos, -sin, 0.0, mass * cos];
        let normal_fixed = mass * sin;
        // No tension.
        constraints.push((normal.map(|n| -n).to_vec(), normal_fixed));
        // Moment about the extrados point is >= 0, about the intrados point <= 0, where a force N along
        // the axis at radius r has the moment (rho - r)(..): see the sign check in the tests.
        for (rho, sign) in [(1.0 + 0.5 * t, -1.0), (1.0 - 0.5 * t, 1.0)] {
            let (px, py) = (rho * sin, rho * cos);
            // moment about p = moment about O - p x force = m - a my - mx - px (v - mass) + py (h + a mass)
            let row = [py, -px, 1.0, py * mass - my];
            let fixed = -mx + px * mass;
            constraints.push((row.map(|r| sign * r).to_vec(), -sign * fixed));
        }
    }
    // A fixed shuffle: the algorithm is fast if the constraints are in random order.
    let mut random = Random(7);
    for i in (1..constraints.len()).rev() {
        let j = random.pick(i + 1);
        constraints.swap(i, j);
    }
    maximise(&[0.0, 0.0, 0.0, 1.0], &constraints, BOX).map(|x| x[3])
}

/// Forces and pushes are searched below this bound.
const BOX: f64 = 1e3;

fn even_sections(ring: &Ring, count: u32) -> Vec<f64> {
    (0..=count)
        .map(|i| ring.embrace_rad * f64::from(i) / f64::from(count))
        .collect()
}

/// Even sections and the given hinges, where the thrust line touches the edges.
fn sections_with(ring: &Ring, count: u32, hinges: [f64; 4]) -> Vec<f64> {
    let mut sections = [even_sections(ring, count), hinges.to_vec()].concat();
    sections.sort_by(f64::total_cmp);
    sections
}

#[test]
fn published_accelerations_and_hinges() {
    for (t, embrace, sites, printed, digit, hinges) in [
        (
            0.15,
            180.0,
            HingeSites::Anywhere,
            0.144_326_44,
            1e-8,
            [24.013_53, 81.787_41, 139.561_30, 180.0],
        ),
        (
            0.15,
            157.5,
            HingeSites::Anywhere,
            0.353_383_86,
            1e-8,
            [1.513_53, 59.287_41, 117.061_30, 157.5],
        ),
        (
            0.15,
            157.5,
            HingeSites::Voussoirs(7),
            0.370_009_738,
            1e-9,
            [0.0, 67.5, 112.5, 157.5],
        ),
        (
            0.15,
            157.5,
            HingeSites::Voussoirs(28),
            0.354_69,
            1e-5,
            [0.0, 61.875, 118.125, 157.5],
        ),
    ] {
        let found = incipient(&ring(t, embrace), sites).unwrap();
        // Half a unit of the last printed digit.
        assert!(
            (found.acceleration_g - printed).abs() <= 0.5 * digit,
            "{}",
            found.acceleration_g
        );
        assert_hinges(found.mechanism.hinges_rad, hinges, 0.5e-5);
    }
    // The value printed in the paper.
    let semicircle = incipient(&ring(0.15, 180.0), HingeSites::Anywhere).unwrap();
    assert!((semicircle.acceleration_g - 0.1443).abs() <= 0.5e-4);

    let thick = incipient(&ring(0.30, 180.0), HingeSites::Anywhere).unwrap();
    assert!(
        (thick.acceleration_g - 0.518_069).abs() <= 0.5e-6,
        "{}",
        thick.acceleration_g
    );
    assert!(thick.mechanism.hinges_rad[0] == 0.0);
    let thin = incipient(&ring(0.10, 120.0), HingeSites::Anywhere).unwrap();
    assert!(
        (thin.acceleration_g - 0.580_005).abs() <= 0.5e-6,
        "{}",
        thin.acceleration_g
    );
    assert_hinges(
        thin.mechanism.hinges_rad,
        [0.0, 34.24, 85.83, 120.0],
        0.5e-2,
    );
}

#[test]
fn the_least_thickness_of_a_semicircle_is_milankovitchs() {
    let least = least_thickness_ratio(std::f64::consts::PI, HingeSites::Anywhere, 1e-6).unwrap();
    assert!((least - 0.10748).abs() <= 0.5e-5, "{least}");
    // Just below the least thickness it falls under its own weight, by statics as well.
    let sections = |t| static_limit_g(&ring(t, 180.0), &even_sections(&ring(t, 180.0), 720));
    assert!(sections(least - 1e-4).is_none_or(|push| push < 0.0));
    assert!(sections(least + 1e-4).unwrap() > 0.0);
    assert_eq!(
        incipient(&ring(least - 1e-5, 180.0), HingeSites::Anywhere).unwrap_err(),
        LimitError::CannotStand
    );
}

/// A thick shallow arch does not start as four links at its joints. Limit analysis finds the mechanism that governs, in which a joint parts.
#[test]
fn voussoirs_that_start_with_another_mechanism_have_a_limit() {
    let text = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.25\nembrace_deg = 100\nvoussoirs = 7\n[free_hinges]\n";
    let scenario = Scenario::parse(text, "s.toml").unwrap();
    assert!(scenario.mechanisms().unwrap_err().is_other_mechanism());
    let arch = ring(0.25, 100.0);
    let statics_g = static_limit_g(&arch, &even_sections(&arch, 7)).unwrap();
    let found = limit(&scenario).unwrap().json;
    for side in ["right", "left"] {
        let starts_g = found["incipient_acceleration_g"][side].as_f64().unwrap();
        assert!(
            (starts_g - statics_g).abs() < 1e-6,
            "{starts_g} {statics_g}"
        );
    }
}

/// The margin by which the moments of the best thrust line under gravity are on the right side of all edge
/// points: a linear programme over the three components of the reaction at the left springing. At most one;
/// `None` if the solver fails.
fn room_for_a_line(ring: &Ring, sections: &[f64]) -> Option<f64> {
    let (mut rows, mut bounds) = (vec![[0.0, 0.0, 0.0, 1.0]], vec![1.0]);
    for &section in sections {
        let weight = ring.moments_to(section);
        for (edge, side) in [(Edge::Extrados, 1.0), (Edge::Intrados, -1.0)] {
            // The moment about the point, times its side, is at least the margin.
            let point = ring.point(section, edge);
            let of_weight = point.x * weight.mass - weight.first.x;
            rows.push([-side * point.y, side * point.x, -side, 1.0]);
            bounds.push(side * of_weight);
        }
    }
    let settings = DefaultSettings {
        verbose: false,
        ..DefaultSettings::default()
    };
    let mut solver = DefaultSolver::new(
        &CscMatrix::zeros((4, 4)),
        &[0.0, 0.0, 0.0, -1.0],
        &CscMatrix::from(&rows),
        &bounds,
        &[NonnegativeConeT(bounds.len())],
        settings,
    )
    .unwrap();
    solver.solve();
    (solver.solution.status == SolverStatus::Solved).then(|| solver.solution.x[3])
}

#[test]
fn arches_that_stand_are_not_refused() {
    // The search for mechanisms alone once took both for arches that cannot stand, or that stand at no
    // thickness.
    let found = incipient(&ring(0.05, 141.8), HingeSites::Anywhere).unwrap();
    assert!((found.acceleration_g - 0.047_379).abs() < 1e-6);
    let least = least_thickness_ratio(141.8_f64.to_radians(), HingeSites::Anywhere, 1e-6).unwrap();
    assert!((least - 0.043_325).abs() < 2e-6, "{least}");
    for (t, embrace) in [(1.269_78, 155.812), (1.0, 141.8), (1.0, 142.0)] {
        let ring = ring(t, embrace);
        assert!(carries_its_weight(&ring, HingeSites::Anywhere));
        assert!(room_for_a_line(&ring, &even_sections(&ring, 360)).unwrap() > 0.1);
        let error = incipient(&ring, HingeSites::Anywhere).unwrap_err();
        let LimitError::OtherMechanism(acceleration_g) = error else {
            panic!("{t} {embrace}: {error}");
        };
        assert!(acceleration_g > 1.0, "{acceleration_g}");
        assert!(error.to_string().contains("stands, but does not start"));
    }
}

#[test]
fn rings_of_vanishing_thickness_cannot_stand() {
    for t in [1e-320, 1e-100, 1e-17] {
        let error = incipient(&ring(t, 180.0), HingeSites::Anywhere).unwrap_err();
        assert_eq!(error, LimitError::CannotStand);
    }
    assert!(least_thickness_ratio(4.0, HingeSites::Anywhere, 1e-6).is_err());
    assert!(least_thickness_ratio(f64::NAN, HingeSites::Anywhere, 1e-6).is_err());
}

#[test]
fn the_thickness_advised_for_a_thin_arch_is_accepted() {
    let mut as_thin_as_can_be = Vec::new();
    for embrace in [
        1.0, 10.0, 12.5, 20.0, 45.0, 90.0, 120.0, 141.8, 142.0, 157.5, 170.0, 180.0,
    ] {
        for voussoirs in ["", "voussoirs = 4\n", "voussoirs = 7\n", "voussoirs = 60\n"] {
            let read = |thickness: &str| {
                let text = format!(
                    "[arch]\nmean_radius_m = 5.0\nembrace_deg = {embrace:?}\n{voussoirs}\
                     thickness_ratio = {thickness}\n"
                );
                Scenario::parse(&text, "s.toml")
            };
            let Err(errors) = read("1e-6") else {
                as_thin_as_can_be.push((embrace, voussoirs));
                continue;
            };
            let message = errors.to_string();
            let (_, advice) = message.split_once("must be at least ").expect(&message);
            let (advised, _) = advice.split_once(' ').unwrap();
            assert!(read(advised).is_ok(), "{message}");
            // The margin is no more than rounding to these digits.
            let less = advised.parse::<f64>().unwrap() * (1.0 - 2e-3);
            assert!(read(&format!("{less:?}")).is_err(), "{message}");
        }
    }
    // The thrust line follows the middle of a ring of 1 degree to less than a millionth, and so it does at the few
    // joints of one of 10 degrees.
    let (shallowest, others) = as_thin_as_can_be.split_at(4);
    assert!(shallowest.iter().all(|(embrace, _)| *embrace == 1.0));
    assert_eq!(others, [(10.0, "voussoirs = 4\n")]);
}

#[test]
fn thick_shallow_rings_are_out_of_scope() {
    // With hinges A and B kept apart by 0.001 rad the best four-link mechanism needs 9.6828 and 7.4102 g.
    // The infimum is lower and equals statics (9.6633 and 7.3966): A and B merge in one section at the
    // springing, which parts altogether. The reported value is not below the true one, and exceeds it by no
    // more than is due to the 1e-7 rad by which the search keeps hinges apart.
    for (t, embrace, statics) in [(0.30, 90.0, 9.6633), (0.60, 120.0, 7.3966)] {
        let ring = ring(t, embrace);
        let Err(LimitError::OtherMechanism(acceleration_g)) =
            incipient(&ring, HingeSites::Anywhere)
        else {
            panic!("{t} {embrace} must be refused");
        };
        assert!(
            acceleration_g > statics - 0.5e-4 && acceleration_g < statics + 1e-4,
            "{acceleration_g}"
        );
        // 720 sections miss little of the places where the line touches: the error falls with their square.
        let push = static_limit_g(&ring, &even_sections(&ring, 720)).unwrap();
        assert!((push - statics).abs() < 1e-4, "{push}");
    }
    for (t, embrace) in [(0.40, 90.0), (0.80, 120.0)] {
        let ring = ring(t, embrace);
        assert_eq!(
            incipient(&ring, HingeSites::Anywhere).unwrap_err(),
            LimitError::NoPush
        );
        // Statics carries any push, up to the bounds of the search.
        assert!(static_limit_g(&ring, &even_sections(&ring, 180)).unwrap() > 50.0);
    }
}

#[test]
fn statics_finds_the_same_push_at_the_joints_of_voussoirs() {
    // Over joints the linear programme is exact. The error of Simpson's rule is (width/40)^4; that of the programme
    // is rounding, which its eliminations amplify: 1e-9 in all.
    for (t, embrace, count) in [
        (0.15, 157.5, 7),
        (0.15, 157.5, 28),
        (0.12, 180.0, 60),
        (0.2, 140.0, 11),
    ] {
        let ring = ring(t, embrace);
        let found = incipient(&ring, HingeSites::Voussoirs(count)).unwrap();
        let push =
            static_limit_g(&ring, &even_sections(&ring, u32::try_from(count).unwrap())).unwrap();
        assert!(
            (found.acceleration_g - push).abs() < 1e-9,
            "{} {push}",
            found.acceleration_g
        );
    }
}

#[test]
fn critical_and_limit_rotations() {
    let semicircle = ring(0.15, 180.0);
    let found = incipient(&semicircle, HingeSites::Anywhere).unwrap();
    let linkage = Linkage::new(&semicircle, &found.mechanism);
    let (limit, critical) = (
        linkage.limit_rad(),
        critical_rad(&linkage, linkage.limit_rad()),
    );
    let right = |q| -linkage.rotations(q)[2];
    // The right body's rotation at the maximum of the potential, by numerical differentiation, with the
    // loop solved by SciPy's fsolve: 0.0734080 (a published value of 0.0735 is rounded up by 1e-4).
    assert!(
        (right(critical) - 0.073_408_0).abs() <= 0.5e-6,
        "{}",
        right(critical)
    );
    assert!((right(limit) - 0.557).abs() <= 0.5e-3, "{}", right(limit));
    let shallow = ring(0.15, 157.5);
    let found = incipient(&shallow, HingeSites::Voussoirs(7)).unwrap();
    let linkage = Linkage::new(&shallow, &found.mechanism);
    let critical = critical_rad(&linkage, linkage.limit_rad());
    assert!((critical - 0.069_065).abs() <= 0.5e-6, "{critical}");
}

/// The answer of the reference if it has one; otherwise another case is tried, which may happen only a few times.
fn reference_answer<T>(verdict: Option<T>) -> Result<T, TestCaseError> {
    verdict.ok_or_else(|| TestCaseError::reject("no verdict"))
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        max_global_rejects: 12,
        ..ProptestConfig::with_cases(24)
    })]

    /// Both theorems of limit analysis: statics can carry the push that was found, and no larger one.
    #[test]
    fn the_push_is_the_largest_that_statics_carries(
        t in 0.03_f64..0.35, embrace in 60.0_f64..180.0, voussoirs in 0_usize..40,
    ) {
        let ring = ring(t, embrace);
        let sites = if voussoirs < 5 { HingeSites::Anywhere } else { HingeSites::Voussoirs(voussoirs) };
        let sections = |hinges| match sites {
            HingeSites::Anywhere => sections_with(&ring, 180, hinges),
            HingeSites::Voussoirs(count) => even_sections(&ring, u32::try_from(count).unwrap()),
        };
        match incipient(&ring, sites) {
            Ok(found) => {
                prop_assert!(found.acceleration_g > 0.0);
                let hinges = found.mechanism.hinges_rad;
                // The line passes through the hinges, so no line can carry more; it stays inside
                // everywhere, so this one carries as much.
                let push = static_limit_g(&ring, &sections(hinges)).unwrap();
                // The programme solves four equations whose condition number is 1/t^2.
                let tolerance = 1e-9 / (t * t) * (1.0 + push);
                prop_assert!((push - found.acceleration_g).abs() < tolerance, "{} {}", push, found.acceleration_g);
                for section in sections(hinges) {
                    let there = found.thrust_line.section(section);
                    prop_assert!(there.normal > 0.0);
                    prop_assert!(there.eccentricity_ratio.abs() < 0.5 + 1e-6, "{there:?}");
                }
            }
            Err(LimitError::CannotStand) => {
                // No line fits, or only one that leaves the ring between sections. An arch that cannot stand
                // may still stand while it is pushed.
                let room = reference_answer(room_for_a_line(&ring, &sections([0.0; 4])))?;
                prop_assert!(room < 1e-5, "{room}");
                if let Some(push) = static_limit_g(&ring, &sections([0.0; 4])) {
                    prop_assert!(push < 0.05, "{push}");
                }
            }
            Err(LimitError::OtherMechanism(acceleration_g)) => {
                // The programme of the test finds no starting corner in some of these rings.
                let push = reference_answer(static_limit_g(&ring, &sections([0.0; 4])))?;
                // Statics at 180 sections constrains the line less than the whole ring would, by the square of their
                // distance; the mechanism is the best one even where its hinges merge.
                prop_assert!(push <= acceleration_g * (1.0 + 1e-3), "{push} {acceleration_g}");
            }
            Err(LimitError::NoPush) => {
                // Thin rings always move; with few joints a shallow ring counts as thick earlier.
                prop_assert!(t > 0.05);
            }
            Err(error) => prop_assert!(false, "{error}"),
        }
    }

    /// Which rings stand, by a programme over all three components of the reaction, without using symmetry.
    #[test]
    fn rings_stand_if_a_thrust_line_fits_into_them(
        log_t in -3.0_f64..0.6, embrace in 30.0_f64..180.0, voussoirs in 0_usize..40,
    ) {
        let ring = ring(log_t.exp(), embrace);
        let (sites, sections) = if voussoirs < 3 {
            (HingeSites::Anywhere, even_sections(&ring, 1440))
        } else {
            let joints = even_sections(&ring, u32::try_from(voussoirs).unwrap());
            (HingeSites::Voussoirs(voussoirs), joints)
        };
        let room = reference_answer(room_for_a_line(&ring, &sections))?;
        // The tolerance covers how far the line may leave the ring between sections, and the error of the solver.
        if room.abs() > 1e-5 {
            prop_assert_eq!(carries_its_weight(&ring, sites), room > 0.0, "{}", room);
        }
        // If a ring stands, a thicker ring stands too.
        let thicker = common::ring(1.3 * log_t.exp().min(1.5), embrace);
        if log_t.exp() < 1.5 && carries_its_weight(&ring, sites) {
            prop_assert!(carries_its_weight(&thicker, sites));
        }
    }

    /// At the least thickness a thrust line just fits.
    #[test]
    fn at_the_least_thickness_a_thrust_line_just_fits(embrace in 60.0_f64..180.0, voussoirs in 4_usize..40) {
        let sites = HingeSites::Voussoirs(voussoirs);
        let least = least_thickness_ratio(embrace.to_radians(), sites, 1e-9).unwrap();
        for (factor, stands) in [(1.0 - 1e-3, false), (1.0 + 1e-3, true)] {
            let ring = ring(least * factor, embrace);
            let joints = even_sections(&ring, u32::try_from(voussoirs).unwrap());
            let room = reference_answer(room_for_a_line(&ring, &joints))?;
            prop_assert_eq!(room > 0.0, stands, "{}", room);
        }
    }

    /// The kinematic theorem: no admissible mechanism moves under a smaller push.
    #[test]
    fn no_mechanism_moves_earlier(t in 0.11_f64..0.3, embrace in 100.0_f64..180.0, seed in 0_u64..1 << 60) {
        let ring = ring(t, embrace);
        let found = reference_answer(incipient(&ring, HingeSites::Anywhere).ok())?;
        let score = |angles: [f64; 4]| {
            let mechanism = FourLink::new(&ring, angles)?;
            let push = acceleration_g(&mechanism, &ring);
            // A mechanism that only a push to the left moves does not count.
            (push > 0.0).then_some(-push)
        };
        let mut random = Random(seed);
        for _ in 0..200 {
            if let Some(push) = score(random.quadruple(ring.embrace_rad)) {
                prop_assert!(-push >= found.acceleration_g - 1e-12);
            }
        }
        let mut climbs = 0;
        while climbs < 6 {
            let start = random.quadruple(ring.embrace_rad);
            if let Some((value, angles)) = climb(start, ring.embrace_rad, score) {
                climbs += 1;
                prop_assert!(-value >= found.acceleration_g - 1e-12, "{value} {angles:?} {}", found.acceleration_g);
            }
        }
    }
}

/// `limit` and `verify` describe the position of each tie as `check` does.
#[test]
fn limit_describes_ties_as_check_does() {
    use crate::common::program::printed;
    let text = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 150\nvoussoirs = 12\n\
                [[tie]]\nfrom_m = [-4.2, 2.5]\nto_m = [-7, 0]\nto_block = 0\nstiffness_n_m = 1e6\nprestress_n = 1000\n\
                [demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.sld]\nag_g = 0.1\nf0 = 2.4\ntc_star_s = 0.28\n[demand.slv]\nag_g = 0.2\nf0 = 2.4\ntc_star_s = 0.3\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let checked = printed(folder.path(), &["check", "s.toml"]);
    let notes: Vec<&str> = checked
        .lines()
        .map_while(|line| line.strip_prefix("# "))
        .filter(|note| !note.starts_with("default duration_s"))
        .collect();
    assert_eq!(notes.len(), 2);
    assert!(notes[1].contains("intrados"), "{}", notes[1]);
    for command in ["limit", "verify"] {
        let said = printed(folder.path(), &[command, "s.toml"]);
        for note in &notes {
            assert!(
                said.lines().any(|line| line.trim() == *note),
                "{command}: {said}"
            );
        }
    }
    let page = folder.path().join("results/s/verify.html");
    let page = std::fs::read_to_string(page).unwrap();
    // The page has the frame in a sentence, and the ends of the tie in a table.
    let part = [
        "y = 0 at the centre of the circle",
        ">-4.20000</data>; <data value=\"2.5\">",
    ];
    assert!(part.iter().all(|part| page.contains(part)));
}

/// Statics do not depend on the ground motion: neither with half of gravity taken away nor when the ground falls freely.
#[test]
fn statics_do_not_depend_on_the_vertical_ground() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 7\n[free_hinges]\n\
                [ground.half_sine]\namplitude_g = 0.9\nduration_s = 0.3\n";
    fs::write(folder.path().join("s.toml"), text).unwrap();
    for command in ["limit", "capacity", "spread"] {
        let words = ["0", "-0.5", "-1.2"].map(|amplitude_g| {
            let set = format!("ground.half_sine.vertical_amplitude_g={amplitude_g}");
            printed(folder.path(), &[command, "s.toml", "--set", &set])
        });
        assert!(words[0] == words[1] && words[1] == words[2], "{words:#?}");
        assert!(!words[0].is_empty());
    }
}

/// The numbers of `limit`.
fn numbers_of(text: &str) -> Value {
    let found = archrock::studies::limit(&parsed(text)).unwrap_or_else(|error| panic!("{error}"));
    found.json
}

/// A coefficient slightly above the one that `limit` names lets the structure start at the same push, and no joint slides with a clearly larger
/// one. Slightly below it joints slide at a smaller push. A semicircle of voussoirs (four links), a pointed arch on piers, a column, drums, a leaning stack with a tie.
#[test]
fn limit_names_the_friction_coefficient_that_its_mechanism_needs() {
    let semicircle =
        "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.2\nembrace_deg = 180\nvoussoirs = 20\n";
    let on_piers = fs::read_to_string(scenarios().join("pointed-arch-on-piers.toml")).unwrap();
    let on_piers = on_piers
        .split_once("[free_hinges]")
        .map_or(&*on_piers, |(text, _)| text);
    let loaded = "[column]\nheight_m = 2\nwidth_m = 1\n[[load]]\nmass_kg = 1500\nx_m = -0.3\n";
    let tied = "[column]\nheight_m = 4\nwidth_m = 0.8\ndrums = 4\n[[tie]]\nfrom_m = [0.0, 3.5]\nto_m = [-4.0, 3.5]\n\
                stiffness_n_m = 1e6\nprestress_n = 5000\nto_block = 0\n";
    for (text, known) in [
        (semicircle, [None; 2]),
        (on_piers, [None; 2]),
        ("[column]\nheight_m = 4\nwidth_m = 0.8\n", [Some(0.2); 2]),
        (
            "[column]\nheight_m = 4\nwidth_m = 0.8\ndrums = 5\n",
            [Some(0.2); 2],
        ),
        (loaded, [None; 2]),
        (tied, [None; 2]),
    ] {
        let rigid = numbers_of(&format!("{text}[free_hinges]\n"));
        for (sway, known) in ["right", "left"].into_iter().zip(known) {
            let needed = rigid["friction_demand"][sway].as_f64().unwrap();
            let push_g = rigid["incipient_acceleration_g"][sway].as_f64().unwrap();
            if let Some(known) = known {
                // The push is computed to 1e-7 of gravity, the coefficient to 1e-7 more.
                assert!(f64::abs(needed - known) < 1e-6, "{needed} {text}");
            }
            let with = |coefficient: f64| {
                let own = format!("{text}[free_hinges]\nfriction_coefficient = {coefficient:?}\n");
                let found = &numbers_of(&own)["friction"];
                let push_g = found[sway]["incipient_acceleration_g"].as_f64().unwrap();
                let slides = found[sway]["sliding_governs"].as_bool().unwrap();
                (push_g, slides, found["least_coefficient"].as_f64().unwrap())
            };
            let (above_g, _, at_rest) = with(needed + 1e-4);
            assert!(
                f64::abs(above_g - push_g) < 1e-6,
                "{above_g} {push_g} {sway} {text}"
            );
            assert!(!with(needed + 0.05).1, "{sway} {text}");
            assert!(needed > at_rest - 1e-6);
            if needed > at_rest + 1e-3 {
                let (below_g, slides, _) = with(needed - 1e-3);
                assert!(
                    slides && below_g < push_g - 1e-5,
                    "{below_g} {push_g} {sway} {text}"
                );
            } else {
                // The pull of the tie needs that friction already at rest.
                assert!(text == tied && sway == "right");
            }
        }
    }
}

/// The coefficient is the largest ratio of shear to normal force over the joints of the mechanism, whose forces follow from equilibrium. Without
/// joints an arch may slide at any section, and many voussoirs come close to that.
#[test]
fn the_friction_of_four_links_is_that_of_their_thrust_line() {
    let arch = |voussoirs: &str| {
        format!("[arch]\nmean_radius_m = 5\nthickness_ratio = 0.2\nembrace_deg = 180\n{voussoirs}")
    };
    let needed = |text: &str| {
        let both = &numbers_of(text)["friction_demand"];
        ["right", "left"].map(|sway| both[sway].as_f64().unwrap())
    };
    let of_line = |text: &str| {
        let scenario = parsed(text);
        let model = scenario.mechanisms().unwrap();
        [Sway::Right, Sway::Left].map(|sway| model.displaced_mechanism(sway, 0.0).unwrap().friction)
    };
    for count in [12, 20, 33] {
        let text = arch(&format!("voussoirs = {count}\n"));
        for (own, line) in needed(&text).into_iter().zip(of_line(&text)) {
            assert!(f64::abs(own - line) < 1e-5, "{own} {line} {count}");
        }
    }
    let continuous = needed(&arch(""));
    assert_eq!(continuous, of_line(&arch("")));
    let many = needed(&arch("voussoirs = 160\n[free_hinges]\n"));
    assert!(
        f64::abs(many[0] - continuous[0]) < 0.01,
        "{many:?} {continuous:?}"
    );
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), arch("")).unwrap();
    let said = printed(folder.path(), &["limit", "s.toml"]);
    let line = said.lines().find(|line| line.contains("friction")).unwrap();
    shows(line, &[continuous[0]]);
    assert!(line.contains("to either side"), "{line}");
}

/// No push moves an arch into which a straight line fits. In an even number of voussoirs that line is level: it passes below the extrados of the
/// springings and above the intrados of the crown. Any other such arch has a positive push of first motion.
#[test]
fn no_push_moves_an_arch_into_which_a_straight_line_fits() {
    let mut random = Random(58);
    let mut straight = 0;
    for _ in 0..120 {
        let (thickness, embrace_deg) = (random.within(0.06, 0.4), random.within(8.0, 110.0));
        let half = 0.5 * f64::to_radians(embrace_deg);
        let room = (1.0 + 0.5 * thickness) * half.cos() - (1.0 - 0.5 * thickness);
        let voussoirs = 2 * (2 + random.pick(40));
        let found = numbers_of(&format!(
            "[arch]\nmean_radius_m = 3.0\nthickness_ratio = {thickness}\nembrace_deg = {embrace_deg}\n\
             voussoirs = {voussoirs}\n[free_hinges]\n"
        ));
        for side in ["right", "left"] {
            let push_g = found["incipient_acceleration_g"][side].as_f64();
            let case = format!("{thickness} {embrace_deg} {voussoirs}: {push_g:?}");
            assert_eq!(push_g.is_none(), room > 0.0, "{case}");
            assert!(push_g.is_none_or(|push_g| push_g > 0.0), "{case}");
            assert!(
                room < 0.0 || found["friction_demand"][side].is_null(),
                "{case}"
            );
        }
        assert_eq!(found["no_push_because"].is_string(), room > 0.0);
        straight += usize::from(room > 0.0);
    }
    assert!((30..90).contains(&straight), "{straight}");
}

/// Every command says so of such an arch, of 150 voussoirs: `limit` once printed pushes of -6.50 and -16.7 g.
#[test]
fn commands_agree_that_no_push_moves_a_flat_arch() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[arch]\nmean_radius_m = 1.0\nthickness_ratio = 0.2\nembrace_deg = 10.0\nvoussoirs = 150\n[free_hinges]\n\
                [demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.slv]\nag_g = 0.25\nf0 = 2.4\ntc_star_s = 0.35\n\
                [ground.rectangular]\namplitude_g = 2.0\nduration_s = 0.2\n";
    fs::write(folder.path().join("flat.toml"), text).unwrap();
    let of = |command: &str| {
        let output = archrock(folder.path(), &[command, "flat.toml"]);
        String::from_utf8([output.stdout, output.stderr].concat()).unwrap()
    };
    let limit = of("limit");
    for side in ["right", "left"] {
        let line =
            format!("no push to the {side} moves it without sliding: a straight line fits into it");
        assert!(limit.contains(&line), "{limit}");
    }
    let run = of("run");
    assert!(
        run.contains("never moves: no push moves it without sliding"),
        "{run}"
    );
    for (command, reason) in [
        ("capacity", "no horizontal push moves it"),
        ("verify", "no push moves it"),
        ("threshold", "no push of the ground moves the structure"),
    ] {
        let refused = of(command);
        assert!(
            refused.starts_with("error: flat.toml: ") && refused.contains(reason),
            "{refused}"
        );
    }
}
