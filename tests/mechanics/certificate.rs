//! The projection onto all admissible velocity fields: published values, convergence, both sides of the optimality
//! conditions, and the four-link restitution coefficient below it.

use archrock::mechanics::four_link::{
    DEFAULT_JOINTS, FourLink, HingeSites, Impact, ImpactModel, Projection, closing_field, impact,
    incipient, joints_rad, project,
};
use archrock::mechanics::{Edge, Field, Momentum, Ring, Twist};

const ANYWHERE: HingeSites = HingeSites::Anywhere;

/// A first impact.
struct Case {
    ring: Ring,
    sites: HingeSites,
    before: Field,
    next: Impact,
}

/// The first mechanism; `None` for arches that do not start as four links.
fn first(thickness_ratio: f64, embrace_deg: f64, sites: HingeSites) -> Option<(Ring, FourLink)> {
    let ring = Ring::new(thickness_ratio, embrace_deg.to_radians()).unwrap();
    Some((ring, incipient(&ring, sites).ok()?.mechanism))
}

impl Case {
    /// `None` when no mechanism can follow.
    fn after(ring: Ring, sites: HingeSites, closing: &FourLink) -> Option<Self> {
        Some(Self {
            ring,
            sites,
            before: closing_field(closing, &ring),
            next: impact(closing, &ring, sites, ImpactModel::MaxRestitution)?,
        })
    }

    /// The first impact of an arch.
    fn new(thickness_ratio: f64, embrace_deg: f64, sites: HingeSites) -> Option<Self> {
        let (ring, closing) = first(thickness_ratio, embrace_deg, sites)?;
        Self::after(ring, sites, &closing)
    }

    fn project(&self, count: usize) -> Projection {
        let joints = joints_rad(&self.ring, self.sites, count, Some(&self.next.mechanism));
        project(&self.before, &self.ring, &joints).unwrap()
    }

    /// The field after the impact, built from the rotations at the joints alone.
    fn field(&self, projection: &Projection) -> Field {
        let jumps: Vec<_> = projection
            .joints
            .iter()
            .map(|joint| {
                let about =
                    |edge, rate| Twist::rotation(self.ring.point(joint.angle_rad, edge), rate);
                let [intrados, extrados] = joint.opening_rates;
                let jump = about(Edge::Intrados, -intrados) + about(Edge::Extrados, extrados);
                (joint.angle_rad, jump)
            })
            .collect();
        Field::from_jumps(&self.ring, &jumps)
    }
}

#[test]
fn published_restitutions_over_all_fields() {
    for (embrace_deg, thickness_ratio, restitution) in [
        (180.0, 0.15, 0.681_300),
        (157.5, 0.15, 0.606_527),
        (180.0, 0.12, 0.724_618),
    ] {
        let case = Case::new(thickness_ratio, embrace_deg, ANYWHERE).unwrap();
        let found = case.project(720).restitution;
        assert!(
            (found - restitution).abs() < 1e-5,
            "{embrace_deg} {thickness_ratio}: {found}"
        );
        // The reference cut the ring into equal parts.
        let equal = project(&case.before, &case.ring, &case.ring.sections(720)).unwrap();
        assert!(
            (equal.restitution - restitution).abs() < 1e-6,
            "{}",
            equal.restitution
        );
    }
    let seven = Case::new(0.15, 157.5, HingeSites::Voussoirs(7)).unwrap();
    let found = seven.project(DEFAULT_JOINTS).restitution;
    assert!((found - 0.5592).abs() < 0.5e-4, "{found}");
    assert!((seven.next.restitution - 0.5567).abs() < 0.5e-4);
}

#[test]
fn the_error_falls_with_the_square_of_the_number_of_joints() {
    for (embrace_deg, thickness_ratio) in
        [(180.0, 0.15), (157.5, 0.15), (180.0, 0.12), (120.0, 0.10)]
    {
        let case = Case::new(thickness_ratio, embrace_deg, ANYWHERE).unwrap();
        let found = [180, 360, 720, 1440, 2880].map(|count| {
            let sections = case.ring.sections(count);
            project(&case.before, &case.ring, &sections)
                .unwrap()
                .restitution
        });
        // Each set of joints contains the one before, so the cones grow.
        assert!(found.is_sorted_by(|a, b| *a < b + 1e-10), "{found:?}");
        let steps: Vec<f64> = found.windows(2).map(|pair| pair[1] - pair[0]).collect();
        // The ratio is four per step, except where joints happen to fall beside the ends of the zones that open.
        assert!(steps[0] / steps[3] > 16.0, "{steps:?}");
        // At that rate, the error after the last step is a third of the step.
        let error = found[4] + steps[3] / 3.0 - found[2];
        assert_eq!(DEFAULT_JOINTS, 720);
        assert!(error < 2e-6, "{error}");
    }
}

#[test]
fn the_field_opens_joints_and_has_the_reported_energy() {
    for case in [
        Case::new(0.15, 180.0, ANYWHERE).unwrap(),
        Case::new(0.12, 180.0, ANYWHERE).unwrap(),
        Case::new(0.15, 157.5, HingeSites::Voussoirs(7)).unwrap(),
        Case::new(0.15, 157.5, HingeSites::Voussoirs(28)).unwrap(),
    ] {
        let projection = case.project(360);
        let field = case.field(&projection);
        for joint in &projection.joints {
            assert!(joint.opening_rates.into_iter().all(|rate| rate >= 0.0));
        }
        // Both springings stand still, so the rotations close. The tolerances are those of the solver, 1e-10,
        // summed over the joints.
        let end = projection.joints.last().unwrap().angle_rad;
        let right = field.twist_at(end, archrock::mechanics::Side::After);
        assert!(
            right.rate.abs() < 1e-8 && right.at_center.norm() < 1e-8,
            "{right:?}"
        );
        let before = case.before.product(&case.before, &case.ring);
        let after = field.product(&field, &case.ring) / before;
        let shared = field.product(&case.before, &case.ring) / before;
        assert!((after - projection.restitution).abs() < 1e-8, "{after}");
        assert!((shared - projection.restitution).abs() < 1e-8, "{shared}");
    }
}

#[test]
fn the_impulses_are_compressive_inside_the_ring_and_complementary() {
    for case in [
        Case::new(0.15, 180.0, ANYWHERE).unwrap(),
        Case::new(0.12, 180.0, ANYWHERE).unwrap(),
        Case::new(0.15, 157.5, HingeSites::Voussoirs(7)).unwrap(),
        Case::new(0.15, 157.5, HingeSites::Voussoirs(28)).unwrap(),
    ] {
        let projection = case.project(360);
        let change = case.before.minus(&case.field(&projection));
        let vector = |joint: &archrock::mechanics::four_link::Joint| {
            let (tangent, radial) = (
                case.ring.tangent(joint.angle_rad),
                case.ring.radial_direction(joint.angle_rad),
            );
            let impulse = tangent * joint.impulse.normal + radial * joint.impulse.tangential;
            let arm = radial * (1.0 + joint.impulse.eccentricity_ratio * case.ring.thickness_ratio);
            Momentum::applied_at(arm, impulse)
        };
        let start = vector(&projection.joints[0]);
        let size = start.linear.norm();
        for joint in &projection.joints {
            let section = joint.impulse;
            assert!(section.normal > 0.0, "{joint:?}");
            assert!(section.eccentricity_ratio.abs() <= 0.5, "{joint:?}");
            // The impulses are the momentum that the part before the joint lost, computed from the field alone.
            let passed = start + change.momentum_to(&case.ring, joint.angle_rad) - vector(joint);
            assert!(passed.linear.norm() < 1e-7 * size, "{passed:?}");
            assert!(passed.angular.abs() < 1e-7 * size, "{passed:?}");
            // A joint that turns about an edge carries its impulse at that edge: the impulse does no work
            // at the other edge, which parts.
            let [about_intrados, about_extrados] = joint.opening_rates;
            let from_extrados = 0.5 - section.eccentricity_ratio;
            let work = about_intrados * (1.0 - from_extrados) + about_extrados * from_extrados;
            assert!(work * section.normal < 1e-8 * size, "{joint:?}");
        }
    }
}

/// `[0, 1)` sequence that fills the square evenly (additive recurrence with the plastic number).
fn spread(index: u32) -> (f64, f64) {
    let step = f64::from(index) + 0.5;
    (
        (step * 0.754_877_666_246_692_7).fract(),
        (step * 0.569_840_290_998_053_3).fract(),
    )
}

#[test]
fn no_four_link_mechanism_keeps_more() {
    let mut largest: f64 = 0.0;
    let (mut count, mut outside, mut certified, mut stops) = (0, 0, 0, 0);
    for index in 0..200 {
        let (x, y) = spread(index);
        let (thickness_ratio, embrace_deg) = (0.04 + 0.36 * x, 60.0 + 120.0 * y);
        let Some((ring, closing)) = first(thickness_ratio, embrace_deg, ANYWHERE) else {
            continue;
        };
        let Some(first) = Case::after(ring, ANYWHERE, &closing) else {
            // Four hinges find that the impact stops the arch; so must any other number.
            stops += 1;
            let joints = joints_rad(&ring, ANYWHERE, 180, None);
            let stop = project(&closing_field(&closing, &ring), &ring, &joints).unwrap();
            assert!(stop.restitution < 1e-12, "{}", stop.restitution);
            assert!(stop.opening_joints().next().is_none());
            continue;
        };
        let second = Case::after(ring, ANYWHERE, &first.next.mechanism);
        for case in [Some(first), second].iter().flatten() {
            let gap = case.project(180).restitution - case.next.restitution;
            count += 1;
            // The cone contains the mechanism; the difference is the tolerance of the solver.
            assert!(gap > -1e-9, "{thickness_ratio} {embrace_deg}: {gap}");
            let extremes = case
                .next
                .impulse_line
                .as_ref()
                .unwrap()
                .resultants
                .extremes(ANYWHERE);
            // If a line leaves the ring, energy can be gained; by less than 1e-3 of the thickness it may
            // leave the ring between two of these joints.
            if extremes.eccentricity_ratio.value > 0.501 {
                outside += 1;
                assert!(gap > 1e-6, "{thickness_ratio} {embrace_deg}: {gap}");
            }
            // The theorem: if the line is admissible there is no gain beyond the tolerances.
            if extremes.is_admissible() {
                certified += 1;
                assert!(gap < 1e-9, "{thickness_ratio} {embrace_deg}: {gap}");
            }
            largest = largest.max(gap);
        }
    }
    assert!(count >= 150 && outside >= 50 && certified >= 1 && stops >= 30);
}

#[test]
fn if_four_joints_open_both_methods_agree() {
    let (mut agree, mut differ) = (0, 0);
    for voussoirs in [5, 6, 7, 8, 9, 11, 13, 16, 21] {
        for (embrace_deg, thickness_ratio) in [
            (180.0, 0.15),
            (157.5, 0.15),
            (157.5, 0.25),
            (140.0, 0.10),
            (120.0, 0.12),
            (180.0, 0.25),
        ] {
            let sites = HingeSites::Voussoirs(voussoirs);
            let Some(case) = Case::new(thickness_ratio, embrace_deg, sites) else {
                continue;
            };
            let projection = case.project(DEFAULT_JOINTS);
            let gap = projection.restitution - case.next.restitution;
            let opened: Vec<_> = projection.opening_joints().collect();
            let extremes = case
                .next
                .impulse_line
                .as_ref()
                .unwrap()
                .resultants
                .extremes(sites);
            if opened.len() == 4 {
                agree += 1;
                assert!(
                    gap.abs() < 1e-9,
                    "{voussoirs} {embrace_deg} {thickness_ratio}: {gap}"
                );
                for ((joint, _, _), hinge) in opened.iter().zip(case.next.mechanism.hinges_rad) {
                    assert!((projection.joints[*joint].angle_rad - hinge).abs() < 1e-12);
                }
                assert!(extremes.is_admissible(), "{extremes:?}");
            } else {
                differ += 1;
                assert!(gap > 1e-9 && !extremes.is_admissible(), "{opened:?} {gap}");
            }
        }
    }
    assert!(agree >= 5 && differ >= 5, "{agree} {differ}");
}

#[test]
fn a_ring_that_moves_admissibly_loses_nothing() {
    // The velocity is in the cone already, so it is its own projection.
    let case = Case::new(0.15, 157.5, HingeSites::Voussoirs(7)).unwrap();
    let sections = case.ring.sections(7);
    let opening = case.next.mechanism.field();
    let found = project(&opening, &case.ring, &sections).unwrap();
    assert!(
        (found.restitution - 1.0).abs() < 1e-9,
        "{}",
        found.restitution
    );
    let opened: Vec<_> = found.opening_joints().collect();
    for ((_, _, rate), expected) in opened.iter().zip(case.next.mechanism.openings) {
        // Impulses vanish together with openings at the other joints; this leaves the square root of the tolerance.
        assert!((rate - expected.abs()).abs() < 1e-5);
    }
    assert_eq!(opened.len(), 4);
}

#[test]
fn springings_and_hinges_are_always_joints() {
    let (ring, _) = first(0.15, 180.0, ANYWHERE).unwrap();
    let end = ring.embrace_rad;
    // Hinges close to both springings, at both, and almost at one.
    for hinges in [
        [1e-4, 1.4, 2.4, end - 1e-4],
        [0.0, 1.4, 2.4, end],
        [0.3, 1.4, 2.4, end - 1e-12],
    ] {
        let mechanism = FourLink::new(&ring, hinges).unwrap();
        for count in [12, 720] {
            let joints = joints_rad(&ring, ANYWHERE, count, Some(&mechanism));
            assert!(joints.is_sorted_by(|a, b| b - a > 1e-9));
            assert!(joints[0] == 0.0 && joints.last() == Some(&end));
            for hinge in hinges {
                assert!(joints.iter().any(|joint| (joint - hinge).abs() < 1e-11));
            }
            // The mechanism itself is in the cone, so its closing loses nothing.
            let kept = project(&mechanism.field(), &ring, &joints).unwrap();
            assert!(
                (kept.restitution - 1.0).abs() < 1e-8,
                "{}",
                kept.restitution
            );
        }
    }
    let free = joints_rad(&ring, ANYWHERE, 12, None);
    assert_eq!(free, ring.sections(12));
}
