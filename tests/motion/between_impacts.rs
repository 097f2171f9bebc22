//! Motion between impacts: energy, the work of the ground, and the instants of events.

use crate::common::{
    GRAVITY, REST_ENERGY_RATIO, four_links, impact_times_s, pairs, released, request, run,
    run_sampled, semicircle, seven_voussoirs, three,
};
use archrock::mechanics::four_link::{HingeSites, Linkage};
use archrock::mechanics::{Link, Mechanism as _, MechanismChain as _};
use archrock::{FourLinks, GroundMotion, Outcome, Pulse, Request, Sway};
use archrock_motion::internals::hybrid::rocking::Rocking;

/// `q''` at the start, by the equation of motion written out, with a ground acceleration.
fn acceleration_at_zero(arch: &FourLinks, link: &Link<Linkage>, ground_m_s2: f64) -> f64 {
    let c = link.mechanism.coefficients(0.0);
    -(GRAVITY * c.s_y + ground_m_s2 * c.s_x) / (arch.length_m() * c.inertia)
}

#[test]
fn at_rest_the_equation_of_motion_gives_the_incipient_acceleration() {
    for arch in [semicircle(), seven_voussoirs()] {
        let link = arch.link(0).unwrap();
        let c = link.mechanism.coefficients(0.0);
        assert!((c.s_y / c.s_x - arch.incipient_g()).abs() < 1e-12);
        assert!(acceleration_at_zero(&arch, link, -arch.incipient_g() * GRAVITY).abs() < 1e-12);
        // Every later link of the chain needs a larger push than the first.
        for index in 1..6 {
            let c = arch.link(index).unwrap().mechanism.coefficients(0.0);
            assert!(c.s_y / c.s_x >= arch.incipient_g() - 1e-12);
        }
    }
}

/// The energy is constant: `q''` from the sampled history must be the slope of the potential, by central
/// differences. Independent of the closed coefficients: the kinetic energy comes from the bodies' own rates.
#[test]
fn free_motion_keeps_the_energy_of_its_bodies() {
    let arch = semicircle();
    let still = GroundMotion::still();
    let link = arch.link(0).unwrap();
    let q0 = 0.9 * link.critical_rad;
    let request = Request {
        output_step_s: 0.005,
        ..released(0.9, Sway::Right, q0)
    };
    let (history, samples) = run_sampled(&arch, &still, &request);
    let ring = arch.chain().profile(0);
    let mechanism = arch.chain().link(0).unwrap().mechanism;
    let [a, b, c, d] = mechanism.hinges_rad;
    let [at_a, at_b, at_c, at_d] = mechanism.points;
    let turn = |v: nalgebra::Vector2<f64>, angle: f64| nalgebra::Rotation2::new(angle) * v;
    let spin = |v: nalgebra::Vector2<f64>, rate: f64| nalgebra::Vector2::new(-v.y, v.x) * rate;
    let end_s = history.impacts().next().map_or(0.9, |(time_s, _)| time_s);
    let scale = GRAVITY / arch.length_m();
    let barrier = scale * link.mechanism.displacement(link.critical_rad).y;
    let mut first = None;
    for sample in samples.iter().filter(|sample| sample.time_s < end_s) {
        let [left, middle, right] = three(&sample.rotations_rad);
        let rates = three(&sample.rates_rad_s);
        let [left_rate, middle_rate, right_rate] = rates;
        // Positions and velocities of the centres of gravity, from the rotations alone.
        let (bodies, bar) = (
            [ring.sector(a, b), ring.sector(b, c), ring.sector(c, d)],
            turn(at_b - at_a, left),
        );
        let g = bodies.map(|body| body.centroid());
        let arms = [
            turn(g[0] - at_a, left),
            turn(g[1] - at_b, middle),
            turn(g[2] - at_d, right),
        ];
        let heights = [
            at_a.y + arms[0].y,
            at_a.y + bar.y + arms[1].y,
            at_d.y + arms[2].y,
        ];
        let velocities = [
            spin(arms[0], left_rate),
            spin(bar, left_rate) + spin(arms[1], middle_rate),
            spin(arms[2], right_rate),
        ];
        let energy: f64 = (0..3)
            .map(|i| {
                let body = &bodies[i];
                0.5 * body.mass * velocities[i].norm_squared()
                    + 0.5 * body.central_polar() * rates[i] * rates[i]
                    + scale * body.mass * heights[i]
            })
            .sum();
        // The loop is closed at C, in position and in velocity.
        let gap = at_a + bar + turn(at_c - at_b, middle) - at_d - turn(at_c - at_d, right);
        assert!(gap.norm() < 1e-12, "{gap}");
        let opening = spin(bar, left_rate) + spin(turn(at_c - at_b, middle), middle_rate)
            - spin(turn(at_c - at_d, right), right_rate);
        assert!(opening.norm() < 1e-12);
        let start = *first.get_or_insert(energy);
        // Samples inside steps are interpolated, with an error of some 1e-8 of the barrier.
        assert!(
            (energy - start).abs() < 1e-7 * barrier,
            "{} {}",
            sample.time_s,
            (energy - start) / barrier
        );
    }
    assert!(samples.len() > 50);
}

#[test]
fn the_energy_defect_is_small_under_every_pulse_and_falls_with_the_tolerance() {
    for arch in [semicircle(), seven_voussoirs()] {
        for kind in Pulse::ALL.iter().copied() {
            let ground = kind
                .lasting_s(0.3)
                .starting_at_s(0.1)
                .horizontal_m_s2(-1.6 * arch.incipient_g() * GRAVITY)
                .unwrap();
            let defect = |relative_tolerance: f64| {
                let request = Request {
                    relative_tolerance,
                    ..request(20.0)
                };
                let summary = run(&arch, &ground, &request).summary;
                assert!(
                    summary.outcome == Outcome::Rest
                        || summary.outcome == Outcome::Overturned(Sway::Right)
                );
                summary.energy_defect_ratio
            };
            let defects = [1e-5, 1e-7, 1e-9, 1e-11].map(defect);
            assert!(defects[2] < 1e-7, "{kind:?} {defects:?}");
            // The accumulated local errors are proportional to the tolerance, or smaller, down to rounding; the factor
            // is the number of steps (tens).
            for (defect, tolerance) in pairs(defects, [1e-5, 1e-7, 1e-9, 1e-11]) {
                assert!(
                    defect < 30.0 * tolerance + 1e-13,
                    "{kind:?} {tolerance}: {defect}"
                );
            }
            assert!(
                defects[3] < 1e-2 * defects[0] + 1e-13,
                "{kind:?} {defects:?}"
            );
        }
    }
}

#[test]
fn free_rocking_from_any_height_keeps_its_energy() {
    let arch = semicircle();
    let still = GroundMotion::still();
    for part in [1e-4, 0.1, 0.5, 0.9, 0.9999] {
        let q0 = part * arch.link(0).unwrap().critical_rad;
        let summary = run(&arch, &still, &released(60.0, Sway::Left, q0)).summary;
        assert_eq!(summary.outcome, Outcome::Rest);
        let defect = summary.energy_defect_ratio;
        assert!(defect < 1e-8, "{part}: {defect}");
        // Nothing rises above where it was released; when it sways left, the right body leads.
        assert!((summary.peak_rotations_rad[2] - q0).abs() < 1e-12);
    }
}

#[test]
fn a_small_hop_takes_the_time_of_a_constant_acceleration() {
    for arch in [semicircle(), seven_voussoirs()] {
        let still = GroundMotion::still();
        let link = arch.link(0).unwrap();
        let acceleration = acceleration_at_zero(&arch, link, 0.0).abs();
        let mut deviations = Vec::new();
        for part in [1e-2, 1e-3, 1e-4, 1e-5] {
            let q0 = part * link.critical_rad;
            let history = run(&arch, &still, &released(60.0, Sway::Right, q0));
            let impacts: Vec<_> = history.impacts().take(2).collect();
            let [(first_s, first), (second_s, _)] = impacts[..] else {
                panic!("two impacts")
            };
            let closed = (2.0 * q0 / acceleration).sqrt();
            let deviation = first_s / closed - 1.0;
            // The deviation is of first order in q0/q_c: the restoring force falls to zero at q_c, on average by a third of q0/q_c.
            assert!(deviation.abs() < part, "{part} {deviation}");
            deviations.push(deviation / part);
            // Rates just before the impact, and the next hop with its own constant acceleration.
            let rate = (2.0 * acceleration * q0).sqrt();
            // The coordinate is the rotation of the left body, clockwise; in the sway to the left, that of the right body.
            assert!((first.rates_before_rad_s[0] / rate - 1.0).abs() < part);
            let next = arch.link(1).unwrap();
            let back = acceleration_at_zero(&arch, next, 0.0).abs();
            let hop = 2.0 * first.rates_after_rad_s[2] / back;
            let took = second_s - first_s;
            assert!((took / hop - 1.0).abs() < part, "{took} {hop}");
        }
        // The deviation is indeed proportional to q0: the quotient has a limit.
        assert!(
            (deviations[3] / deviations[2] - 1.0).abs() < 0.01,
            "{deviations:?}"
        );
    }
}

#[test]
fn event_times_meet_those_of_the_smallest_tolerance() {
    for arch in [semicircle(), seven_voussoirs()] {
        let still = GroundMotion::still();
        for part in [1e-4, 1e-2, 0.3, 0.9] {
            let q0 = part * arch.link(0).unwrap().critical_rad;
            let times = |relative_tolerance: f64| {
                let request = Request {
                    relative_tolerance,
                    ..released(60.0, Sway::Right, q0)
                };
                impact_times_s(&run(&arch, &still, &request))
            };
            let (usual, exact) = (times(1e-9), times(1e-13));
            assert_eq!(usual.len(), exact.len());
            // The first event, and the last of a sequence of tens.
            assert!(
                (usual[0] - exact[0]).abs() < 1e-9 * exact[0],
                "{part} {}",
                usual[0] - exact[0]
            );
            for (usual, exact) in pairs(usual, exact) {
                assert!((usual - exact).abs() < 1e-8, "{part} {}", usual - exact);
            }
        }
    }
}

#[test]
fn event_times_under_a_pulse_meet_those_of_the_smallest_tolerance() {
    let arch = semicircle();
    let mut compared = 0;
    for kind in Pulse::ALL.iter().copied() {
        let ground = kind
            .lasting_s(0.25)
            .horizontal_m_s2(-0.25 * GRAVITY)
            .unwrap();
        let times = |relative_tolerance: f64| {
            let request = Request {
                relative_tolerance,
                ..request(20.0)
            };
            impact_times_s(&run(&arch, &ground, &request))
        };
        let (usual, exact) = (times(1e-9), times(1e-13));
        // If it overturns at once there are no impacts; otherwise errors grow from impact to impact.
        assert_eq!(usual.is_empty(), exact.is_empty(), "{kind:?}");
        for (usual, exact) in usual.iter().zip(&exact).take(3) {
            assert!((usual - exact).abs() < 2e-8, "{kind:?} {}", usual - exact);
            compared += 1;
        }
    }
    assert!(compared >= 2 * Pulse::ALL.len(), "{compared}");
}

#[test]
fn cuts_in_the_ground_motion_change_nothing() {
    let arch = semicircle();
    let mut compared = 0;
    for kind in Pulse::ALL.iter().copied() {
        let ground = kind
            .lasting_s(0.3)
            .starting_at_s(0.05)
            .horizontal_m_s2(-0.3 * GRAVITY)
            .unwrap();
        let whole = run(&arch, &ground, &request(20.0));
        for cuts in [
            &[0.21][..],
            &[0.01, 0.0501, 0.111, 0.25, 0.7, 1.3],
            &[0.3, 0.3 + 1e-9],
        ] {
            let cut_ground = ground.cut_at(cuts);
            assert!(cut_ground.pieces.len() > ground.pieces.len());
            let cut = run(&arch, &cut_ground, &request(20.0));
            let times_s = [&cut, &whole].map(impact_times_s);
            assert_eq!(times_s[0].is_empty(), times_s[1].is_empty(), "{kind:?}");
            for (x, y) in times_s[0].iter().zip(&times_s[1]).take(3) {
                compared += 1;
                // Other steps have other errors, within the tolerance.
                assert!((x - y).abs() < 2e-8, "{kind:?} {}", x - y);
            }
            let (cut, whole) = (cut.summary, &whole.summary);
            assert_eq!(cut.outcome, whole.outcome, "{kind:?}");
            if let Outcome::Overturned(_) = whole.outcome {
                // The history ends at the last passage of q_c, but is followed on while a cut lies ahead.
                assert!(
                    (cut.outcome_time_s - whole.outcome_time_s).abs() < 2e-8,
                    "{kind:?}"
                );
                continue;
            }
            let peaks_rad = pairs(cut.peak_rotations_rad, &whole.peak_rotations_rad);
            for (x, y) in peaks_rad {
                assert!((x - y).abs() < 1e-8, "{kind:?} {x} {y}");
            }
        }
    }
    // Each pulse is cut three times.
    assert!(compared >= 2 * 3 * Pulse::ALL.len(), "{compared}");
}

#[test]
fn beyond_the_critical_rotation_it_overturns() {
    // Released just above and just below, on ground that moves a little first, so that the end is not decided yet.
    let arch = four_links(8.0, 0.15, 157.5, HingeSites::Anywhere);
    let link = arch.link(0).unwrap();
    let top = link.mechanism.displacement(link.critical_rad).y;
    for offset in [-1e-3, 1e-3] {
        assert!(link.mechanism.displacement(link.critical_rad + offset).y < top);
    }
    assert!(link.mechanism.coefficients(link.critical_rad).s_y.abs() < 1e-14);
    assert!(link.limit_rad > link.critical_rad);
    // The energy decides: pulses that give just less or just more than the barrier.
    let c = link.mechanism.coefficients(0.0);
    let barrier = GRAVITY / arch.length_m() * top;
    let duration_s = 1e-7;
    for (factor, lost) in [(0.999, false), (1.001, true)] {
        let rate = factor * (2.0 * barrier / c.inertia).sqrt();
        let velocity = rate * c.inertia * arch.length_m() / c.s_x;
        let ground = Pulse::Rectangular
            .lasting_s(duration_s)
            .horizontal_m_s2(-velocity / duration_s)
            .unwrap();
        let rocking = Rocking::new(&arch, &ground, GRAVITY, REST_ENERGY_RATIO);
        assert!((rocking.barrier / barrier - 1.0).abs() < 1e-14);
        let summary = run(&arch, &ground, &request(60.0)).summary;
        assert_eq!(
            summary.outcome == Outcome::Overturned(Sway::Right),
            lost,
            "{factor}"
        );
    }
}
