//! The thrust line in motion, compared with statics, an independent formulation of dynamics, and published numbers.

use crate::common;
use std::ops::ControlFlow;

use crate::common::GRAVITY;
use crate::common::four_links;
use crate::common::run;
use crate::common::sampled;
use crate::common::semicircle;
use crate::common::seven_voussoirs;
use archrock::dynamics::{FreeHinges, Recorder, Summary, WithoutDemand};
use archrock::mechanics::four_link::{HingeSites, Linkage, SectionResultant, ThrustLine};
use archrock::mechanics::{
    Demand, Edge, Hinge, Mechanism as _, MechanismChain as _, MechanismState,
};
use archrock::{
    Arch, Column, FourLinks, GroundMotion, History, ImpactModel, Model, Pulse, RockingColumn,
    Sample, State, Sway,
};
use nalgebra::SMatrix;
use nalgebra::SVector;
use nalgebra::Vector2;

fn arches() -> [FourLinks; 4] {
    [
        semicircle(),
        four_links(5.0, 0.15, 157.5, HingeSites::Anywhere),
        four_links(5.0, 0.15, 157.5, HingeSites::Voussoirs(7)),
        four_links(5.0, 0.3, 140.0, HingeSites::Anywhere),
    ]
}

/// A motion that obeys the equation of motion, in the units of [`Motion`].
fn motion(linkage: &Linkage, q_rad: f64, rate: f64, push_g: f64) -> MechanismState {
    let coefficients = linkage.coefficients(q_rad);
    let force = push_g * coefficients.s_x - coefficients.s_y;
    MechanismState {
        q_rad,
        rate,
        acceleration: (force - 0.5 * coefficients.inertia_slope * rate * rate)
            / coefficients.inertia,
        body_force_g: Vector2::new(push_g, -1.0),
    }
}

/// A few motions: rising, falling, under a push, near the limit position, starting.
fn motions(linkage: &Linkage) -> Vec<MechanismState> {
    let limit = linkage.limit_rad();
    [
        (0.0, 0.0, 0.5),
        (0.1, 0.3, 0.0),
        (0.3, -0.4, 0.2),
        (0.6, 0.2, -0.3),
        (0.95, 0.1, 1.0),
    ]
    .map(|(part, rate, push)| motion(linkage, part * limit, rate, push))
    .to_vec()
}

#[test]
fn at_the_onset_it_is_the_line_of_limit_analysis() {
    for arch in arches() {
        let incipient = &arch.chain().incipient;
        let linkage = &arch.link(0).unwrap().mechanism;
        let push = incipient.acceleration_g;
        let onset = motion(linkage, 0.0, 0.0, push);
        // A_L is exact to rounding if joints are given; otherwise it is flat in the hinges, which are accurate to 1e-8.
        assert!(onset.acceleration.abs() < 1e-12, "{}", onset.acceleration);
        let line = linkage.thrust_line(&onset);
        let at_rest = ThrustLine::at_rest(
            incipient,
            incipient,
            arch.chain().profile(0),
            onset.body_force_g,
        );
        for i in 0..=50 {
            let angle = arch.chain().profile(0).end() * f64::from(i) / 50.0;
            let expected = incipient.thrust_line.resultant_at(angle);
            for line in [&line, &at_rest] {
                let difference = line.resultant_at(angle) - expected;
                assert!(difference.linear.norm() < 1e-12, "{angle}");
                assert!(difference.angular.abs() < 1e-12, "{angle}");
            }
        }
    }
}

/// The nine equations of motion of three free bodies in nine unknowns, four hinge forces and `q''`, with
/// velocities and accelerations by finite differences of positions. Only the angles of the bodies are shared with
/// the closed form.
#[test]
fn hinge_forces_and_acceleration_solve_the_equilibrium_of_three_bodies() {
    for arch in arches() {
        let ring = arch.chain().profile(0);
        let mechanism = arch.chain().link(0).unwrap().mechanism;
        let linkage = &arch.link(0).unwrap().mechanism;
        let [a, b, c, d] = mechanism.hinges_rad;
        let [point_a, point_b, _, point_d] = mechanism.points;
        let bodies = [ring.sector(a, b), ring.sector(b, c), ring.sector(c, d)];
        let place = |q: f64| {
            let turns = linkage.rotations(q);
            let turned = |i: usize, v: Vector2<f64>| nalgebra::Rotation2::new(turns[i]) * v;
            let moved_b = point_a + turned(0, point_b - point_a);
            let moved_c = moved_b + turned(1, mechanism.points[2] - point_b);
            let centroids = [
                point_a + turned(0, bodies[0].centroid() - point_a),
                moved_b + turned(1, bodies[1].centroid() - point_b),
                point_d + turned(2, bodies[2].centroid() - point_d),
            ];
            (turns, centroids, [point_a, moved_b, moved_c, point_d])
        };
        for motion in motions(linkage).into_iter().skip(1).take(3) {
            let h = 1e-4;
            let (before, now, after) = (
                place(motion.q_rad - h),
                place(motion.q_rad),
                place(motion.q_rad + h),
            );
            let hinges = now.2;
            let mut matrix = SMatrix::<f64, 9, 9>::zeros();
            let mut right = SVector::<f64, 9>::zeros();
            for i in 0..3 {
                let (mass, polar) = (bodies[i].mass, bodies[i].central_polar());
                let path = (after.1[i] - before.1[i]) / (2.0 * h);
                let bend = (after.1[i] - now.1[i] * 2.0 + before.1[i]) / (h * h);
                let turn = (after.0[i] - before.0[i]) / (2.0 * h);
                let turn_bend = (after.0[i] - 2.0 * now.0[i] + before.0[i]) / (h * h);
                let square = motion.rate * motion.rate;
                // mass * (path q'' + bend q'^2) = weight + force before - force after, likewise moments.
                for axis in 0..2 {
                    let row = 3 * i + axis;
                    matrix[(row, 2 * i + axis)] = 1.0;
                    matrix[(row, 2 * i + 2 + axis)] = -1.0;
                    matrix[(row, 8)] = -mass * path[axis];
                    right[row] = mass * (bend[axis] * square - motion.body_force_g[axis]);
                }
                let row = 3 * i + 2;
                for (hinge, sign) in [(i, 1.0), (i + 1, -1.0)] {
                    let arm = hinges[hinge] - now.1[i];
                    matrix[(row, 2 * hinge)] = -sign * arm.y;
                    matrix[(row, 2 * hinge + 1)] = sign * arm.x;
                }
                matrix[(row, 8)] = -polar * turn;
                right[row] = polar * turn_bend * square;
            }
            let solution = matrix.lu().solve(&right).unwrap();
            // The errors of differences are h^2 times fourth derivatives, and 1e-16 / h^2.
            let tolerance = 3e-6 * solution.norm();
            assert!((solution[8] - motion.acceleration).abs() < tolerance);
            let line = linkage.thrust_line(&motion);
            let turns = [0.0, now.0[0], now.0[1], now.0[2], 0.0];
            for hinge in 0..4 {
                let force = nalgebra::Rotation2::new(turns[hinge])
                    * line.resultant_at(mechanism.hinges_rad[hinge]).linear;
                let expected = Vector2::new(solution[2 * hinge], solution[2 * hinge + 1]);
                assert!(
                    (force - expected).norm() < tolerance,
                    "hinge {hinge}: {force} {expected}"
                );
            }
        }
    }
}

#[test]
fn the_line_passes_through_the_hinges_from_both_sides() {
    for arch in arches() {
        let ring = arch.chain().profile(0);
        let embrace = ring.end();
        // The thick arch stops at its first impact, so it has only one mechanism.
        for link in (0..3).map_while(|index| arch.chain().link(index)) {
            let (mechanism, linkage) = (link.mechanism, &link.link.mechanism);
            for motion in motions(linkage) {
                let line = linkage.thrust_line(&motion);
                let parts = line.parts;
                assert!((parts[4].end_rad - embrace).abs() < 1e-15);
                for (hinge, angle) in mechanism.hinges_rad.into_iter().enumerate() {
                    let pole = mechanism.points[hinge];
                    // Resultants of both parts that meet there: the moment about the hinge is zero, and the forces
                    // are equal except for the rotation. For B, on its left side, this is the equation of motion.
                    let forces = [parts[hinge], parts[hinge + 1]].map(|part| {
                        let resultant = part.resultant_at(ring, angle);
                        let scale = 1.0 + resultant.linear.norm();
                        assert!(
                            resultant.moment_about(pole).abs() < 1e-12 * scale,
                            "{hinge}"
                        );
                        resultant.linear.norm()
                    });
                    assert!((forces[0] - forces[1]).abs() < 1e-12 * (1.0 + forces[0]));
                }
            }
        }
    }
}

#[test]
fn the_parts_that_stand_carry_their_weight_to_the_springings() {
    let arch = semicircle();
    let ring = arch.chain().profile(0);
    let linkage = &arch.link(0).unwrap().mechanism;
    let a = arch.chain().link(0).unwrap().mechanism.hinges_rad[0];
    let line = linkage.thrust_line(&motion(linkage, 0.02, 0.1, 0.0));
    // Nothing accelerates before A: between springing and hinge the force grows by the weight.
    let weight = line.resultant_at(a).linear - line.resultant_at(0.0).linear;
    let expected = Vector2::new(0.0, -ring.sector(0.0, a).mass);
    assert!((weight - expected).norm() < 1e-14);
}

#[test]
fn at_rest_the_line_stays_inside_up_to_the_onset() {
    for arch in arches() {
        let ring = arch.chain().profile(0);
        let limit_g = arch.incipient_g();
        for part in [-1.0, -0.7, 0.0, 0.3, 0.999] {
            let body_force = Vector2::new(part * limit_g, -1.0);
            assert_eq!(arch.demand_at_rest(body_force).excess_ratio, 0.0, "{part}");
            // Equilibrium of the whole ring: the force at one end plus the load is the force at the other end.
            let line = ThrustLine::at_rest(
                &arch.chain().incipient,
                &arch.chain().incipient,
                ring,
                body_force,
            );
            let load = line.resultant_at(ring.end()).linear - line.resultant_at(0.0).linear;
            let mass = ring.moments_to(ring.end()).mass;
            assert!((load - body_force * mass).norm() < 1e-14);
        }
        // Mirror images have the same demand.
        let [left, right] = [-0.6, 0.6].map(|part| {
            arch.demand_at_rest(Vector2::new(part * limit_g, -1.0))
                .friction
        });
        assert!((left - right).abs() < 1e-12);
    }
}

#[test]
fn a_push_beyond_the_onset_at_rest_would_leave_the_ring() {
    let arch = semicircle();
    let demand = arch.demand_at_rest(Vector2::new(1.2 * arch.incipient_g(), -1.0));
    assert!(demand.excess_ratio > 0.01, "{demand:?}");
}

#[test]
fn a_section_in_tension_has_a_finite_excess_that_grows_with_it() {
    let of = |normal: f64, moment: f64| {
        let section = SectionResultant {
            normal,
            tangential: 0.3,
            moment,
            eccentricity_ratio: moment / (normal * 0.2),
            thickness: 0.2,
        };
        Demand::of_sections([section].into_iter(), 10.0)
    };
    // Moment 0.05 on N = 1 and t = 0.2: |e|/t = 0.25, inside; 0.12: 0.6, out by 0.1.
    assert_eq!(of(1.0, 0.05).excess_ratio, 0.0);
    assert!((of(1.0, -0.12).excess_ratio - 0.1).abs() < 1e-15);
    assert!((of(1.0, 0.0).friction - 0.3).abs() < 1e-15);
    // A tension of a tenth of a weight, relative to the minimum of a hundredth: half of its ten parts.
    assert!((of(-1.0, 0.0).excess_ratio - 5.0).abs() < 1e-14);
    let mut before = 0.0;
    for normal in [0.2, 0.1, 0.01, 0.0, -0.01, -0.1, -3.0] {
        let demand = of(normal, 0.03);
        assert!(demand.excess_ratio.is_finite() && demand.excess_ratio > before);
        before = demand.excess_ratio;
        // A section with less than a hundredth of the weight does not count.
        let needed = if normal >= 0.1 { 0.3 / normal } else { 0.0 };
        assert!((demand.friction - needed).abs() < 1e-14, "{normal}");
    }
}

fn pulse_history(
    arch: &FourLinks,
    amplitude_g: f64,
    (start_s, duration_s): (f64, f64),
    end_s: f64,
) -> History {
    let ground = Pulse::Rectangular
        .lasting_s(duration_s)
        .starting_at_s(start_s)
        .horizontal_m_s2(amplitude_g * GRAVITY)
        .unwrap();
    run(arch, &ground, &sampled(end_s, 0.001))
}

/// Eccentricity of the line at a sample of the first half cycle, swaying right.
fn eccentricity(arch: &FourLinks, sample: &Sample, angle_deg: f64) -> f64 {
    assert_eq!(sample.state, State::Rocking(Sway::Right));
    let linkage = &arch.link(0).unwrap().mechanism;
    let motion = motion(
        linkage,
        -sample.rotations_rad[0],
        -sample.rates_rad_s[0] * (arch.length_m() / GRAVITY).sqrt(),
        -sample.ground_acceleration_m_s2 / GRAVITY,
    );
    let line = linkage.thrust_line(&motion);
    line.section(angle_deg.to_radians()).eccentricity_ratio
}

fn at(history: &History, time_s: f64) -> Sample {
    let found = history
        .samples
        .iter()
        .find(|sample| sample.time_s >= time_s);
    found.expect("a sample at that time")
}

/// Published with two digits: |e|/t about 0.55 at the joint at 22.5 degrees, after the pulse.
#[test]
fn seven_voussoirs_leave_the_ring_at_the_second_joint() {
    let arch = common::seven_voussoirs();
    let history = pulse_history(&arch, -0.5, (0.0, 0.25), 0.5);
    for time_s in [0.26, 0.3, 0.4, 0.5] {
        let sample = at(&history, time_s);
        let e = eccentricity(&arch, &sample, 22.5);
        assert!((e + 0.55).abs() < 5e-3, "{e}");
        // No other joint has a larger value, so this is the demand.
        assert!((sample.demand.excess_ratio - (e.abs() - 0.5)).abs() < 1e-9);
    }
}

/// Published with two digits: about 0.52 near 30 and 86 degrees after the pulse; near 78 during it.
#[test]
fn the_semicircle_leaves_the_ring_beside_its_hinges() {
    let arch = semicircle();
    let history = pulse_history(&arch, -0.3, (0.0, 0.2), 1.0);
    for (time_s, angle_deg, edge) in [(0.05, 78.0, 1.0), (0.5, 30.0, -1.0), (0.5, 86.0, 1.0)] {
        let e = eccentricity(&arch, &at(&history, time_s), angle_deg);
        assert!((e * edge - 0.52).abs() < 6e-3, "{angle_deg}: {e}");
    }
}

/// The largest value over all sections: at steps of a thousandth of a degree, then a thousand times finer around the best.
fn densest(embrace_rad: f64, of: impl Fn(f64) -> f64) -> f64 {
    let best = |from: f64, to: f64, count: u32| {
        (0..=count)
            .map(|i| from + (to - from) * (f64::from(i) / f64::from(count)))
            .filter(|angle| (0.0..=embrace_rad).contains(angle))
            .map(|angle| (of(angle), angle))
            .max_by(|(a, _), (b, _)| a.total_cmp(b))
            .unwrap()
    };
    let (_, coarse) = best(0.0, embrace_rad, 180_000);
    best(coarse - 2e-5, coarse + 2e-5, 2000).0
}

#[test]
fn the_demand_of_a_continuous_ring_is_the_largest_over_all_sections() {
    for arch in arches() {
        if arch.chain().sites != HingeSites::Anywhere {
            continue;
        }
        let ring = arch.chain().profile(0);
        let weight = ring.moments_to(ring.end()).mass;
        let linkage = &arch.link(0).unwrap().mechanism;
        let lines = motions(linkage)
            .into_iter()
            .map(|motion| linkage.thrust_line(&motion));
        let push = Vector2::new(1.3 * arch.incipient_g(), -1.0);
        let at_rest =
            ThrustLine::at_rest(&arch.chain().incipient, &arch.chain().incipient, ring, push);
        for line in lines.chain([at_rest]) {
            let demand = line.demand(HingeSites::Anywhere);
            let of = |angle: f64| {
                let section = line.section(angle);
                Demand::of_sections([section].into_iter(), weight)
            };
            // Samples 2e-8 rad apart miss less than rounding. Where the line is far outside, the maximum is at the kink where
            // the normal force becomes too small to count, which is found to 1e-6 rad. Friction jumps at hinges, and
            // may be largest just after one.
            let excess = densest(ring.end(), |angle| of(angle).excess_ratio);
            let tolerance = if excess < 1.0 { 1e-9 } else { 1e-7 * excess };
            assert!(
                (demand.excess_ratio - excess).abs() < tolerance,
                "{demand:?} {excess}"
            );
            let friction = densest(ring.end(), |angle| of(angle).friction);
            let above = (demand.friction - friction) / (1.0 + friction);
            assert!(above.abs() < 1e-6, "{demand:?} {friction}");
        }
    }
}

#[test]
fn the_record_of_a_history_is_that_of_its_samples() {
    let arch = common::seven_voussoirs();
    let history = pulse_history(&arch, -0.4, (0.5, 0.1), 3.0);
    let record = history.summary.thrust.unwrap();
    let samples: Vec<Sample> = history.samples.iter().collect();
    let (still, moving): (Vec<&Sample>, Vec<&Sample>) = samples
        .iter()
        .partition(|sample| sample.state == State::Rest);
    assert!(still.len() > 400 && moving.len() > 100);
    assert!(still.iter().all(|sample| sample.demand.excess_ratio == 0.0));
    let largest = |of: &dyn Fn(&Sample) -> f64| {
        let values = samples.iter().map(|sample| (of(sample), sample.time_s));
        values.fold(
            (0.0, 0.0),
            |best, new| if new.0 > best.0 { new } else { best },
        )
    };
    let peak = record.largest_excess;
    let expected = largest(&|sample| sample.demand.excess_ratio);
    assert_eq!((peak.value, peak.time_s), expected);
    let shares = record.shares_within().unwrap();
    for (share, level) in shares.into_iter().zip([0.01, 0.05]) {
        let count = moving
            .iter()
            .filter(|sample| sample.demand.excess_ratio <= level)
            .count();
        assert_eq!(share, count as f64 / moving.len() as f64);
    }
    assert!(shares[0] < shares[1]);
}

#[test]
fn at_rest_there_are_no_shares() {
    let arch = semicircle();
    let history = pulse_history(&arch, 0.1, (0.0, 0.5), 1.0);
    let record = history.summary.thrust.unwrap();
    assert_eq!(record.shares_within(), None);
    assert_eq!(record.largest_excess.value, 0.0);
    assert!(history.summary.required_friction().unwrap() > 0.1);
}

/// Keeps the lines of thrust of a history.
#[derive(Default)]
struct Lines(Vec<Sample>);

impl Recorder for Lines {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.0.push(sample.clone());
        ControlFlow::Continue(())
    }

    fn wants_thrust_line(&self) -> bool {
        true
    }
}

fn lines(model: &impl Model, ground: &GroundMotion) -> Vec<Sample> {
    let mut lines = Lines::default();
    model
        .simulate(ground, &sampled(3.0, 0.01), Some(&mut lines))
        .unwrap();
    lines.0
}

/// The excess is that of the worst joint, and at open hinges the line is at their edge; both come from other computations.
#[test]
fn lines_of_thrust_pass_through_the_hinges_and_give_the_excess() {
    let arch = seven_voussoirs();
    let ring = arch.chain().profile(0);
    let sections = ring.sections(7);
    let mut swayed = [0, 0];
    for amplitude in [-0.5, 0.5] {
        let ground = Pulse::Rectangular
            .lasting_s(0.25)
            .starting_at_s(0.1)
            .horizontal_m_s2(amplitude * GRAVITY)
            .unwrap();
        for sample in lines(&arch, &ground) {
            let ratios = &sample.eccentricity_ratios;
            assert_eq!(ratios.len(), 8);
            let worst = ratios
                .iter()
                .map(|ratio| ratio.unwrap().abs())
                .fold(0.0, f64::max);
            let excess = (worst - 0.5).max(0.0);
            // In an almost unloaded section the excess is defined differently, and is larger than anything drawn.
            if worst < 3.0 {
                let miss = (excess - sample.demand.excess_ratio).abs();
                assert!(miss < 1e-6, "{} {worst} {:?}", sample.time_s, sample.demand);
            }
            for open in &sample.hinges {
                let Hinge::Section { angle_rad, edge } = open.hinge else {
                    panic!("{open:?}")
                };
                let at = sections
                    .iter()
                    .position(|s| (s - angle_rad).abs() < 1e-9)
                    .unwrap();
                let due = if edge == Edge::Extrados { 0.5 } else { -0.5 };
                let ratio = ratios[at].unwrap();
                assert!(
                    (ratio - due).abs() < 1e-6,
                    "{} {ratio} {due}",
                    sample.time_s
                );
            }
            match sample.state.sway() {
                Some(Sway::Right) => swayed[0] += 1,
                Some(Sway::Left) => swayed[1] += 1,
                None => {}
            }
        }
    }
    assert!(swayed.iter().all(|count| *count > 50), "{swayed:?}");
}

/// Blocks without tension keep the line inside; it touches the edge at open joints.
#[test]
fn lines_of_thrust_of_free_hinges_stay_inside() {
    let arch = Arch::new(5.0, 0.15, 180.0)
        .unwrap()
        .with_voussoirs(18)
        .unwrap();
    let model = FreeHinges::of_arch(&arch).unwrap();
    let ground = Pulse::Rectangular
        .lasting_s(0.2)
        .horizontal_m_s2(-0.3 * GRAVITY)
        .unwrap();
    let mut open = 0;
    for sample in lines(&model, &ground) {
        assert_eq!(sample.eccentricity_ratios.len(), 19);
        for ratio in sample.eccentricity_ratios.iter().flatten() {
            assert!(ratio.abs() < 0.5 + 1e-9, "{ratio}");
        }
        for hinge in &sample.hinges {
            let Hinge::Joint {
                joint,
                edge: Some(edge),
            } = hinge.hinge
            else {
                continue;
            };
            let due = if edge == Edge::Extrados { 0.5 } else { -0.5 };
            if let Some(ratio) = sample.eccentricity_ratios[joint] {
                assert!(
                    (ratio - due).abs() < 1e-9,
                    "joint {joint} at {}: {ratio}",
                    sample.time_s
                );
                open += 1;
            }
        }
    }
    assert!(open > 300, "{open}");
    // Recorders that do not request lines get none.
    let history = run(&model, &ground, &sampled(0.5, 0.01));
    assert!(
        history
            .samples
            .iter()
            .all(|sample| sample.eccentricity_ratios.is_empty())
    );
}

/// A column presses on the ground at the toe about which it turns; the mirrored ground gives the mirror image.
#[test]
fn lines_of_thrust_of_a_column_pass_through_its_toe() {
    let column = Column::new(4.0, 0.8).unwrap();
    let model = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
    let run = |amplitude: f64| {
        let ground = Pulse::OneSine
            .lasting_s(0.8)
            .starting_at_s(0.1)
            .horizontal_m_s2(amplitude * GRAVITY)
            .unwrap();
        lines(&model, &ground)
    };
    let (samples, mirrored) = (run(0.35), run(-0.35));
    assert_eq!(samples.len(), mirrored.len());
    let mut swayed = [0, 0, 0];
    for (sample, other) in samples.iter().zip(&mirrored) {
        let ratios = &sample.eccentricity_ratios;
        assert_eq!(ratios.len(), column.thrust_sections_m().len());
        for (ratio, other) in ratios.iter().zip(&other.eccentricity_ratios) {
            assert!((ratio.unwrap() + other.unwrap()).abs() < 1e-9);
        }
        let base = ratios[0].unwrap();
        let due = match sample.state.sway() {
            Some(Sway::Right) => 0.5,
            Some(Sway::Left) => -0.5,
            // Height times push over width, halved, because the centre is at half the height.
            None => -0.5 * 5.0 * sample.ground_acceleration_m_s2 / GRAVITY,
        };
        assert!((base - due).abs() < 1e-9, "{} {base}", sample.time_s);
        // Towards the top there is less and less mass that leans and is pushed.
        assert!(ratios[20].unwrap().abs() < 0.1, "{:?}", ratios[20]);
        swayed[match sample.state.sway() {
            Some(Sway::Right) => 0,
            Some(Sway::Left) => 1,
            None => 2,
        }] += 1;
    }
    assert!(swayed.iter().all(|count| *count > 5), "{swayed:?}");
}

/// A recorder that does not want the demand gets the same motion without it.
#[test]
fn samples_without_demand_are_the_same() {
    let arch = common::seven_voussoirs();
    let ground = Pulse::Rectangular
        .lasting_s(0.1)
        .starting_at_s(0.5)
        .horizontal_m_s2(-0.4 * GRAVITY)
        .unwrap();
    let request = sampled(3.0, 0.01);
    let (mut with, mut without): (Vec<Sample>, Vec<Sample>) = Default::default();
    let mut all = |sample: &Sample| {
        with.push(sample.clone());
        ControlFlow::Continue(())
    };
    let own = arch.simulate(&ground, &request, Some(&mut all)).unwrap();
    let mut bare = WithoutDemand(|sample: &Sample| {
        without.push(sample.clone());
        ControlFlow::Continue(())
    });
    let spared = arch.simulate(&ground, &request, Some(&mut bare)).unwrap();
    assert!(own.thrust.is_some() && spared.thrust.is_none());
    assert_eq!(
        own,
        Summary {
            thrust: own.thrust,
            ..spared
        }
    );
    assert!(
        without
            .iter()
            .all(|sample| sample.demand == Demand::default())
    );
    assert!(with.iter().any(|sample| sample.demand.friction > 0.1));
    for sample in &mut with {
        sample.demand = Demand::default();
    }
    assert!(with == without);
}
