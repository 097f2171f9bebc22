//! A single elastic joint: forces from its energy, conservation of momenta, and stresses compared with sums over many points.

use archrock::mechanics::Block;
use archrock::mechanics::elastic_joint::{
    BodyPosition, ElasticJoint, ElasticStructure, Fibre, JointGeometry, Memory,
};
use archrock::{Contact, ElasticProperties};
use archrock_motion::internals::lanes::Lanes;
use nalgebra::Vector2;

const ALONG: [f64; 2] = [0.6, 0.8];
const NORMAL_N_M: f64 = 3e9;
const LENGTH_M: f64 = 0.7;
/// Centres of the two undeformed bodies, and the middle of the joint.
const CENTRES_M: [[f64; 2]; 2] = [[0.5, -0.2], [-0.3, 0.6]];
const MIDDLE_M: [f64; 2] = [0.12, 0.2];

fn structure(
    contact: Contact,
    crushing_penetration_m: Option<f64>,
    damping_time_s: f64,
) -> ElasticStructure {
    let arm = |centre: [f64; 2]| [MIDDLE_M[0] - centre[0], MIDDLE_M[1] - centre[1]];
    let joint = ElasticJoint {
        geometry: JointGeometry::new([0, 1], CENTRES_M.map(arm), ALONG, 1.0, LENGTH_M),
        normal_n_m: NORMAL_N_M,
        shear_n_m: 0.4 * NORMAL_N_M,
        crushing_penetration_m: crushing_penetration_m.unwrap_or(f64::INFINITY),
        area_m2: LENGTH_M,
    };
    let properties = ElasticProperties {
        friction_coefficient: None,
        contact,
        damping_time_s,
        compressive_strength_pa: crushing_penetration_m.map(|_| 1e9),
        ..ElasticProperties::of_stiffness(1e9)
    };
    let body = Block {
        mass_kg: 1.0,
        centre_m: Vector2::zeros(),
        inertia_kg_m2: 1.0,
    };
    ElasticStructure::new(vec![body; 2], vec![joint], &properties)
}

fn places(q: [f64; 6]) -> [BodyPosition<Lanes<1>>; 2] {
    [
        BodyPosition::at(&[q[0], q[1], q[2]]),
        BodyPosition::at(&[q[3], q[4], q[5]]),
    ]
}

fn virgin(structure: &ElasticStructure) -> (Memory<Lanes<1>>, Vec<Fibre<Lanes<1>>>) {
    (Memory::none(), vec![Fibre::none(); structure.fibres()])
}

fn energy_j(structure: &ElasticStructure, q: [f64; 6]) -> f64 {
    let (mut memory, mut fibres) = virgin(structure);
    let [one, other] = places(q);
    let joint = &structure.joints[0];
    structure.act(joint, [&one, &other], None, &mut memory, &mut fibres);
    structure.energy_j(joint, &memory, &fibres).0[0]
}

/// Positions at which the joint is closed, partly open at either edge, and rotated far; the penetrations follow.
fn positions() -> Vec<[f64; 6]> {
    let normal = [-ALONG[1], ALONG[0]];
    let pressed = |depth: f64, turn: f64, common: f64, slip: f64| {
        // The second body is moved into the first and rotated; then both rotate together about the origin.
        let moved = [0, 1].map(|i| ALONG[i] * slip - normal[i] * depth);
        let arm = [MIDDLE_M[0] - CENTRES_M[1][0], MIDDLE_M[1] - CENTRES_M[1][1]];
        let swung = |a: f64, v: [f64; 2]| {
            [
                a.cos() * v[0] - a.sin() * v[1],
                a.sin() * v[0] + a.cos() * v[1],
            ]
        };
        let relative = swung(turn, arm);
        let second = [0, 1].map(|i| CENTRES_M[1][i] + moved[i] + arm[i] - relative[i]);
        let [first, second] = [swung(common, CENTRES_M[0]), swung(common, second)];
        [
            first[0] - CENTRES_M[0][0],
            first[1] - CENTRES_M[0][1],
            common,
            second[0] - CENTRES_M[1][0],
            second[1] - CENTRES_M[1][1],
            common + turn,
        ]
    };
    vec![
        pressed(1e-3, 1e-3, 0.0, 2e-4),
        pressed(1e-3, 5e-3, 0.4, -3e-4),
        pressed(1e-3, -9e-3, -1.1, 1e-3),
        pressed(-2e-2, 0.2, 0.7, 5e-3),
        pressed(-2e-2, -0.3, 2.9, -4e-3),
    ]
}

/// The forces of a joint are minus the derivative of its energy, up to the truncation error of the differences. They change neither
/// momentum nor angular momentum, up to rounding.
#[test]
fn a_joint_acts_by_its_energy_and_keeps_momenta() {
    for (contact, crushing_penetration_m) in [
        (Contact::Continuous, None),
        (Contact::Continuous, Some(1.0)),
        (Contact::Points(5), None),
    ] {
        let structure = structure(contact, crushing_penetration_m, 0.0);
        let joint = &structure.joints[0];
        for q in positions() {
            let (mut memory, mut fibres) = virgin(&structure);
            let [one, other] = places(q);
            let (action, ..) = structure.act(joint, [&one, &other], None, &mut memory, &mut fibres);
            let [x, y] = action.force_n.map(|part| part.0[0]);
            let [first, second] = action.moments_n_m.map(|part| part.0[0]);
            let size = x.hypot(y);
            assert!(size > 1e3, "the joint is in compression");
            let on = [-x, -y, first, x, y, second];
            for (axis, force) in on.into_iter().enumerate() {
                let at = |step: f64| {
                    let mut there = q;
                    there[axis] += step;
                    energy_j(&structure, there)
                };
                let step = 1e-7;
                let due = -(at(step) - at(-step)) / (2.0 * step);
                assert!(
                    (force - due).abs() < 2e-4 * size,
                    "{q:?} {axis}: {force} {due}"
                );
            }
            let centre = |body: usize| [0, 1].map(|i| CENTRES_M[body][i] + q[3 * body + i]);
            let [a, b] = [centre(0), centre(1)];
            let turning = first + second + (b[0] - a[0]) * y - (b[1] - a[1]) * x;
            assert!(turning.abs() < 1e-12 * size, "{turning}");
        }
    }
}

/// Forces at the edges, with damping, compared with sums over many points of the joint; every part is in compression or has no force.
#[test]
fn the_stress_of_a_joint_is_that_of_its_parts() {
    let damping = 0.5;
    let edges = |contact, crushing_penetration_m, before: [f64; 6], after: [f64; 6]| {
        let structure = structure(contact, crushing_penetration_m, 1.0);
        let joint = &structure.joints[0];
        let (mut memory, mut fibres) = virgin(&structure);
        let [one, other] = places(before);
        structure.act(joint, [&one, &other], None, &mut memory, &mut fibres);
        let from = memory.penetrations_m.map(|end| end.0[0]);
        let [one, other] = places(after);
        let rates = Some(Lanes([damping]));
        let (_, pressing, rubbing) =
            structure.act(joint, [&one, &other], rates, &mut memory, &mut fibres);
        let to = memory.penetrations_m.map(|end| end.0[0]);
        (
            from,
            to,
            pressing.edges_n.map(|edge| edge.0[0]),
            pressing.damped_j.0[0] + rubbing.damped_j.0[0],
        )
    };
    let parts = 200_000;
    for before in positions() {
        for after in positions() {
            let (from, to, exact, damped_j) = edges(Contact::Continuous, None, before, after);
            assert!(damped_j >= 0.0);
            let mut due = [0.0; 2];
            for part in 0..parts {
                let at = (f64::from(part) + 0.5) / f64::from(parts);
                let between = |ends: [f64; 2]| ends[0] * (1.0 - at) + ends[1] * at;
                let (old, new) = (between(from), between(to));
                let stress = if new > 0.0 {
                    (new + damping * (new - old)).max(0.0)
                } else {
                    0.0
                };
                due[0] += stress * (1.0 - at) * NORMAL_N_M / f64::from(parts);
                due[1] += stress * at * NORMAL_N_M / f64::from(parts);
            }
            let size = due[0] + due[1];
            let cells = edges(Contact::Continuous, Some(1e3), before, after).2;
            let points = edges(Contact::Points(100), None, before, after).2;
            for end in [0, 1] {
                assert!(
                    (exact[end] - due[end]).abs() <= 1e-4 * size,
                    "{exact:?} {due:?}"
                );
                // Parts that may crush but do not are just as accurate; their intervals of damping may end anywhere.
                assert!(
                    (cells[end] - exact[end]).abs() <= 1e-9 * size,
                    "{exact:?} {cells:?}"
                );
                assert!(
                    (points[end] - exact[end]).abs() <= 0.05 * size,
                    "{exact:?} {points:?}"
                );
            }
        }
    }
}

/// A joint pressed beyond its strength carries the strength, gives back only the elastic energy, and dissipates the difference.
#[test]
fn a_crushing_joint_dissipates_strength_times_crushing() {
    for contact in [Contact::Continuous, Contact::Points(3)] {
        let crushing_penetration_m = 1e-3;
        let structure = structure(contact, Some(crushing_penetration_m), 0.0);
        let joint = &structure.joints[0];
        let (mut memory, mut fibres) = virgin(&structure);
        let normal = [-ALONG[1], ALONG[0]];
        let (mut taken_j, mut largest_n) = (0.0, 0.0_f64);
        let mut press = |depth_m: f64| {
            let q = [
                0.0,
                0.0,
                0.0,
                -normal[0] * depth_m,
                -normal[1] * depth_m,
                0.0,
            ];
            let [one, other] = places(q);
            let (_, pressing, _) =
                structure.act(joint, [&one, &other], None, &mut memory, &mut fibres);
            taken_j += pressing.crushed_j.0[0];
            largest_n = largest_n.max(pressing.edges_n[0].0[0] + pressing.edges_n[1].0[0]);
            pressing.edges_n[0].0[0] + pressing.edges_n[1].0[0]
        };
        for step in 0..=300 {
            press(1e-5 * f64::from(step));
        }
        // The force vanishes once the joint has sprung back by the elastic part.
        assert!(press(2e-3 + 1e-6) > 0.0 && press(2e-3 - 1e-6) == 0.0);
        let strength_n = NORMAL_N_M * crushing_penetration_m;
        assert!((largest_n / strength_n - 1.0).abs() < 1e-9, "{largest_n}");
        let due_j = strength_n * 2e-3;
        assert!((taken_j / due_j - 1.0).abs() < 1e-9, "{taken_j} {due_j}");
    }
}
