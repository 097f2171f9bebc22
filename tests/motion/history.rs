//! Whole histories: published numbers, exact invariances, and the ways in and out of rest.

use crate::common::{
    GRAVITY, REST_ENERGY_RATIO, four_links, impact_times_s, released, request, run, run_sampled,
    sampled, semicircle, seven_voussoirs, three,
};
use crate::common::{least, pulse};
use archrock::dynamics::Recording;
use archrock::mechanics::four_link::HingeSites;
use archrock::mechanics::{Mechanism as _, MechanismChain as _};
use archrock::{
    Arch, FourLinks, GroundMotion, History, ImpactModel, Model as _, Outcome, Pulse, Request,
    Sample, State, Sway,
};
use archrock_motion::internals::hybrid::rocking::Rocking;

/// All values of a history, for bit-by-bit comparisons.
fn fingerprint(history: &History) -> Vec<u64> {
    let summary = &history.summary;
    let mut bits = vec![
        summary.outcome_time_s.to_bits(),
        summary.end_s.to_bits(),
        summary.energy_defect_ratio.to_bits(),
        summary.cost.evaluations,
        summary.cost.steps,
    ];
    bits.extend(summary.peak_rotations_rad.iter().map(|peak| peak.to_bits()));
    for (time_s, impact) in history.impacts() {
        bits.push(time_s.to_bits());
        let rates = impact.rates_before_rad_s.iter();
        bits.extend(
            rates
                .chain(&impact.rates_after_rad_s)
                .map(|rate| rate.to_bits()),
        );
    }
    bits
}

#[test]
fn published_history_of_the_semicircle() {
    let arch = semicircle();
    let ground = pulse(Pulse::Rectangular, -0.30, 0.20);
    let (history, samples) = run_sampled(&arch, &ground, &sampled(30.0, 0.0005));
    let impacts: Vec<_> = history.impacts().collect();
    let [(first_s, first), (second_s, _), ..] = impacts[..] else {
        panic!("two impacts")
    };
    // Half a unit of the last printed digit everywhere.
    assert!((first_s - 1.0279).abs() <= 0.5e-4, "{first_s}");
    let (before, after) = (&first.rates_before_rad_s, &first.rates_after_rad_s);
    assert!((before[2].abs() - 0.1775).abs() <= 0.5e-4, "{before:?}");
    assert!((after[2].abs() - 0.0840).abs() <= 0.5e-4, "{after:?}");
    assert!((second_s - 1.2032).abs() <= 0.5e-4, "{second_s}");
    let peak = |from: f64, to: f64| {
        let inside = samples.iter().filter(|s| s.time_s > from && s.time_s < to);
        inside
            .map(|s| (s.rotations_rad[2].abs(), s.time_s))
            .fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a })
    };
    let (height, time_s) = peak(0.0, first_s);
    assert!((height - 0.035_25).abs() <= 0.5e-5, "{height}");
    // Published as 0.571; the rate passes zero between 0.5720 and 0.5721, and the maximum is so flat that the
    // rotation is the same to 1e-7.
    assert!((time_s - 0.572).abs() <= 0.5e-3 + 0.25e-3, "{time_s}");
    let (height, _) = peak(first_s, second_s);
    assert!((height - 0.003_68).abs() <= 0.5e-5, "{height}");
    // The largest rotation of the whole history, found inside a step and not at a sample.
    assert!((history.summary.peak_rotations_rad[2] - 0.035_25).abs() <= 0.5e-5);
    assert_eq!(history.summary.outcome, Outcome::Rest);
    assert_eq!(first.sway_before, Sway::Right);
    assert!((first.restitution - 0.681_185_59).abs() < 1e-8);
    assert!((first.energy_after_j / first.energy_before_j - 0.681_185_59).abs() < 1e-8);
}

#[test]
fn published_collapse_amplitudes_without_impact() {
    // With a positive amplitude the step pair first pushes left; by symmetry the result is the same.
    let arch = seven_voussoirs();
    for (duration_s, published) in [(0.2, 3.066), (0.5, 0.820), (1.0, 0.465)] {
        let falls = |amplitude_g: f64| {
            let ground = pulse(Pulse::StepPair, amplitude_g, duration_s);
            let history = run(&arch, &ground, &request(20.0));
            history.summary.outcome == Outcome::Overturned(Sway::Left)
                && history.summary.impacts == 0
        };
        // Around the least amplitude, collapse without impact is monotone in the amplitude.
        let [low, high] = [0.97 * published, 1.03 * published];
        assert!(!falls(low) && falls(high), "{duration_s}");
        let found = least([low, high], 1e-5, falls);
        assert!(
            (found - published).abs() <= 0.5e-3 + 1e-5,
            "{duration_s}: {found}"
        );
    }
}

#[test]
fn the_mirror_image_is_exact() {
    let arch = semicircle();
    for kind in Pulse::ALL.iter().copied() {
        for amplitude_g in [0.35, 0.9] {
            let at = sampled(12.0, 0.01);
            let (right, left) = (
                pulse(kind, -amplitude_g, 0.25),
                pulse(kind, amplitude_g, 0.25),
            );
            let (to_right, right_samples) = run_sampled(&arch, &right, &at);
            let (to_left, left_samples) = run_sampled(&arch, &left, &at);
            let (of_right, of_left) = (&to_right.summary, &to_left.summary);
            assert_eq!(
                of_right.end_s.to_bits(),
                of_left.end_s.to_bits(),
                "{kind:?}"
            );
            assert_eq!(
                of_right.outcome_time_s.to_bits(),
                of_left.outcome_time_s.to_bits()
            );
            assert_eq!(of_right.cost, of_left.cost);
            let mirrored =
                |of_bodies: &[f64]| -> Vec<f64> { of_bodies.iter().rev().map(|x| -x).collect() };
            assert_eq!(right_samples.len(), left_samples.len());
            for (r, l) in right_samples.iter().zip(&left_samples) {
                assert!(r.time_s == l.time_s && r.phase == l.phase);
                assert!(r.rotations_rad == mirrored(&l.rotations_rad));
                assert!(r.rates_rad_s == mirrored(&l.rates_rad_s));
                assert!(r.ground_acceleration_m_s2 == -l.ground_acceleration_m_s2);
                let other = match l.state {
                    State::Rest => State::Rest,
                    State::Rocking(sway) => State::Rocking(sway.opposite()),
                    State::Overturned(sway) => State::Overturned(sway.opposite()),
                };
                assert_eq!(r.state, other);
            }
            assert_eq!(of_right.impacts, of_left.impacts);
            for ((r_s, r), (l_s, l)) in to_right.impacts().zip(to_left.impacts()) {
                assert!(r_s == l_s && r.sway_before == l.sway_before.opposite());
                assert!(r.rates_before_rad_s == mirrored(&l.rates_before_rad_s));
                assert!(r.rates_after_rad_s == mirrored(&l.rates_after_rad_s));
            }
            let overturned = |outcome| match outcome {
                Outcome::Overturned(sway) => Outcome::Overturned(sway.opposite()),
                other => other,
            };
            assert_eq!(of_right.outcome, overturned(of_left.outcome));
            let [a, b, c] = three(&of_left.peak_rotations_rad);
            assert_eq!(of_right.peak_rotations_rad, [c, b, a]);
        }
    }
}

#[test]
fn size_and_gravity_only_stretch_time() {
    // R -> 4 R and t -> 2 t, or g -> g/4 and t -> 2 t with the same amplitude in g. These are powers of two, so only
    // the solver's cube roots of step sizes can differ, and times agree to its tolerance.
    let small = semicircle();
    let large = four_links(4.0 * 5.0, 0.15, 180.0, HingeSites::Anywhere);
    for kind in [Pulse::Rectangular, Pulse::OneSine, Pulse::Ricker] {
        let (short, long) = (pulse(kind, -0.4, 0.25), pulse(kind, -0.4, 0.5));
        let a = run(&small, &short, &request(20.0));
        let b = run(&large, &long, &request(40.0));
        let weak = kind.lasting_s(0.5).horizontal_m_s2(-0.1 * GRAVITY).unwrap();
        let at = Request {
            gravity_m_s2: 0.25 * GRAVITY,
            ..request(40.0)
        };
        let c = run(&small, &weak, &at);
        for scaled in [&b, &c] {
            let (long, short) = (&scaled.summary, &a.summary);
            assert_eq!(long.outcome, short.outcome);
            assert_eq!(long.impacts, short.impacts);
            assert!(
                (long.end_s - 2.0 * short.end_s).abs() < 1e-7 * short.end_s,
                "{kind:?}"
            );
            for (x, y) in impact_times_s(scaled).iter().zip(impact_times_s(&a)) {
                assert!((x - 2.0 * y).abs() < 1e-7);
            }
            for (x, y) in long
                .peak_rotations_rad
                .iter()
                .zip(&short.peak_rotations_rad)
            {
                assert!((x - y).abs() < 1e-8);
            }
        }
    }
}

#[test]
fn density_and_depth_change_no_bit() {
    let arch = semicircle();
    let heavy = Arch::new(5.0, 0.15, 180.0).unwrap();
    let heavy = heavy.with_density_kg_m3(2700.0).unwrap();
    let heavy = heavy.with_depth_m(3.3).unwrap();
    let heavy = FourLinks::of_arch(&heavy, ImpactModel::MaxRestitution).unwrap();
    let ground = pulse(Pulse::HalfSine, -0.5, 0.3);
    let (a, b) = (
        run(&arch, &ground, &request(20.0)),
        run(&heavy, &ground, &request(20.0)),
    );
    assert_eq!(fingerprint(&a), fingerprint(&b));
    assert!(heavy.mass_unit_kg() > 4.0 * arch.mass_unit_kg());
}

#[test]
fn a_repeated_history_is_bit_identical() {
    let run_anew = || {
        let arch = seven_voussoirs();
        let ground = pulse(Pulse::Ricker, 0.6, 0.5);
        fingerprint(&run(&arch, &ground, &request(20.0)))
    };
    assert_eq!(run_anew(), std::thread::spawn(run_anew).join().unwrap());
}

#[test]
fn below_the_incipient_acceleration_nothing_moves() {
    let arch = semicircle();
    let incipient_g = arch.incipient_g();
    for kind in Pulse::ALL.iter().copied() {
        for sign in [-1.0, 1.0] {
            let ground = pulse(kind, sign * incipient_g * (1.0 - 1e-9), 0.3);
            let (history, samples) = run_sampled(&arch, &ground, &sampled(5.0, 0.05));
            let summary = history.summary;
            assert_eq!(summary.outcome, Outcome::NeverMoved, "{kind:?}");
            assert!(summary.impacts == 0 && summary.peak_rotations_rad == [0.0; 3]);
            assert!(
                samples
                    .iter()
                    .all(|s| s.state == State::Rest && s.rotations_rad == [0.0; 3])
            );
            let ground = pulse(kind, sign * incipient_g * 1.01, 0.3);
            let summary = run(&arch, &ground, &request(5.0)).summary;
            assert!(summary.outcome != Outcome::NeverMoved, "{kind:?}");
            assert!(
                summary.peak_rotations_rad.iter().all(|peak| *peak > 0.0),
                "{kind:?}"
            );
        }
    }
    let still = GroundMotion::still();
    assert_eq!(
        run(&arch, &still, &request(5.0)).summary.outcome,
        Outcome::NeverMoved
    );
}

#[test]
fn motion_starts_when_the_push_passes_the_incipient_acceleration() {
    // A triangle of 2 A_L and 0.8 s passes A_L at 0.2 s; phase 1 begins there.
    let arch = semicircle();
    let ground = pulse(Pulse::Triangular, -2.0 * arch.incipient_g(), 0.8);
    let (_, samples) = run_sampled(&arch, &ground, &sampled(0.4, 1e-3));
    for sample in &samples {
        if sample.time_s < 0.2 - 1e-9 {
            assert_eq!((sample.phase, sample.state), (0, State::Rest));
        } else if sample.time_s > 0.2 + 1e-9 {
            assert_eq!(
                (sample.phase, sample.state),
                (1, State::Rocking(Sway::Right))
            );
        }
    }
    // From then on q'' grows in proportion to the elapsed time s: q = j s^3 / 6 to first order.
    let link = arch.link(0).unwrap();
    let coefficients = link.mechanism.coefficients(0.0);
    let jerk = 2.0 * arch.incipient_g() * GRAVITY / 0.4;
    let growth = jerk * coefficients.s_x / (arch.length_m() * coefficients.inertia);
    let near = samples.iter().find(|s| s.time_s > 0.2095).unwrap();
    let since: f64 = near.time_s - 0.2;
    let expected = growth * since.powi(3) / 6.0;
    // Relative deviation of the order of (p s)^2.
    assert!((near.rotations_rad[0].abs() / expected - 1.0).abs() < 1e-2);
}

#[test]
fn motion_can_restart_on_either_side_after_rest() {
    let arch = semicircle();
    let incipient_g = arch.incipient_g();
    // A push just above A_L, a long calm in between, then a push to the other side: one period of a sine.
    let mut seen = Vec::new();
    for (kind, amplitude_g, duration_s) in [
        (Pulse::OneSine, 1.05 * incipient_g, 4.0),
        (Pulse::OneSine, -1.05 * incipient_g, 4.0),
        // A short strong step, then one of half its size, long enough for the rocking to die out under it
        // and for the structure to be pushed again and again.
        (Pulse::Ricker, -1.1 * incipient_g, 5.0),
        (Pulse::Ricker, 1.1 * incipient_g, 5.0),
    ] {
        let ground = pulse(kind, amplitude_g, duration_s);
        let (history, samples) = run_sampled(&arch, &ground, &sampled(60.0, 0.002));
        let mut states: Vec<State> = samples.iter().map(|s| s.state).collect();
        states.dedup();
        seen.push(history.summary.outcome);
        let starts = states
            .windows(2)
            .filter(|pair| pair[0] == State::Rest)
            .count();
        if kind == Pulse::OneSine {
            assert!(starts >= 2, "{states:?}");
            // Both sides, beginning with the one opposite to the ground.
            let sides: Vec<State> = states
                .windows(2)
                .filter(|pair| pair[0] == State::Rest)
                .map(|pair| pair[1])
                .collect();
            let expected = if amplitude_g > 0.0 {
                [Sway::Left, Sway::Right]
            } else {
                [Sway::Right, Sway::Left]
            };
            assert_eq!(sides, expected.map(State::Rocking));
        }
        // The chain begins anew at every start.
        let restarts = history
            .events
            .windows(2)
            .filter(|pair| pair[0].mechanism == Some(0) && pair[1].impact.is_some())
            .count();
        assert!(restarts >= starts.min(2), "{states:?}");
        assert!(history.summary.energy_defect_ratio < 1e-7);
    }
    assert!(seen.contains(&Outcome::Rest));
}

#[test]
fn a_push_just_above_the_onset_does_not_overturn() {
    // One-cosine starts at its peak, so the structure is lifted only for an instant, by as little as rounding.
    let arch = semicircle();
    for exponent in 1..=13 {
        for kind in [
            Pulse::OneCosine,
            Pulse::HalfSine,
            Pulse::Triangular,
            Pulse::Rectangular,
        ] {
            let amplitude_g = -arch.incipient_g() * (1.0 + 10_f64.powi(-exponent));
            let ground = pulse(kind, amplitude_g, 0.5);
            let result = arch.simulate(&ground, &request(20.0), None);
            let summary = result.unwrap_or_else(|error| panic!("{kind:?} 1e-{exponent}: {error}"));
            assert!(summary.energy_defect_ratio < 1e-7, "{kind:?} {exponent}");
            assert!(!matches!(summary.outcome, Outcome::Overturned(_)));
        }
    }
}

#[test]
fn the_peak_is_not_below_any_sample() {
    let arch = semicircle();
    let incipient_g = arch.incipient_g();
    let check = |kind: Pulse, amplitude_g: f64, duration_s: f64, end_s: f64| {
        let ground = pulse(kind, -amplitude_g, duration_s);
        let history = run(&arch, &ground, &sampled(end_s, end_s / 2000.0));
        // The peaks of a structure that overturns are those up to then.
        let until_s = history.summary.overturned_s().unwrap_or(f64::INFINITY);
        let before = |sample: &Sample| sample.time_s <= until_s;
        for sample in history.samples.iter().filter(before) {
            let peaks = &history.summary.peak_rotations_rad;
            for (rotation, peak) in sample.rotations_rad.iter().zip(peaks) {
                // Two ways lead to one turning point; each is accurate to the error of a step.
                assert!(
                    rotation.abs() <= peak * (1.0 + 1e-5),
                    "{kind:?} {amplitude_g}: {} s {rotation} {peak}",
                    sample.time_s
                );
            }
        }
    };
    for kind in Pulse::ALL.iter().copied() {
        for amplitude_g in [1.02 * incipient_g, 0.4] {
            check(kind, amplitude_g, 0.3, 3.0);
            // The history ends while the structure still moves outwards.
            check(kind, amplitude_g, 0.3, 0.2);
        }
    }
    // A peak that decreases: the whole first hop, from rest, is shorter than the first step.
    for exponent in 1..=5 {
        check(
            Pulse::OneCosine,
            incipient_g * (1.0 + 10_f64.powi(-exponent)),
            2.0,
            0.2,
        );
    }
}

#[test]
fn a_very_short_pulse_transfers_its_momentum() {
    // Rate just after: velocity of the ground times S_x / M. Gravity takes g dt S_y / M meanwhile.
    let arch = semicircle();
    let link = arch.link(0).unwrap();
    let at_zero = link.mechanism.coefficients(0.0);
    for start_s in [0.0, 3.7] {
        for duration_s in [1e-6, 1e-4] {
            let velocity_m_s = 0.5;
            let acceleration = -velocity_m_s / duration_s;
            let ground = Pulse::Rectangular
                .lasting_s(duration_s)
                .starting_at_s(start_s)
                .horizontal_m_s2(acceleration)
                .unwrap();
            let end_s = start_s + 2.0 * duration_s;
            let (_, samples) = run_sampled(&arch, &ground, &request(end_s));
            let rate = -samples.last().unwrap().rates_rad_s[0];
            let expected = velocity_m_s * at_zero.s_x / (at_zero.inertia * arch.length_m());
            // The error is of first order in the duration, with the acceleration of gravity as its scale.
            let relative = 2.0 * GRAVITY * at_zero.s_y / at_zero.s_x * duration_s / velocity_m_s;
            assert!(
                ((rate / expected) - 1.0).abs() < 2.0 * relative + 1e-8,
                "{rate} {expected}"
            );
            assert!(rate < expected);
            // The whole history continues from there, whenever the blow came.
            let summary = run(&arch, &ground, &request(start_s + 20.0)).summary;
            assert_ne!(summary.outcome, Outcome::NeverMoved);
            assert!(summary.peak_rotations_rad[0] > 1e-4);
        }
    }
}

#[test]
fn a_late_pulse_is_the_same_pulse() {
    let arch = semicircle();
    let now = pulse(Pulse::HalfSine, -0.6, 0.3);
    let later = Pulse::HalfSine
        .lasting_s(0.3)
        .starting_at_s(512.0)
        .horizontal_m_s2(-0.6 * GRAVITY)
        .unwrap();
    let (a, b) = (
        run(&arch, &now, &request(20.0)),
        run(&arch, &later, &request(532.0)),
    );
    assert_eq!(a.summary.impacts, b.summary.impacts);
    for (x, y) in impact_times_s(&a).into_iter().zip(impact_times_s(&b)) {
        // Times near 512 are rounded to 1e-13, once for every phase.
        assert!((y - 512.0 - x).abs() < 1e-8, "{x} {y}");
    }
    assert_eq!(a.summary.outcome, b.summary.outcome);
}

#[test]
fn a_release_beyond_the_critical_rotation_overturns_at_once() {
    let arch = semicircle();
    let still = GroundMotion::still();
    let critical = arch.link(0).unwrap().critical_rad;
    for sway in [Sway::Right, Sway::Left] {
        let lost = run(&arch, &still, &released(20.0, sway, 1.001 * critical)).summary;
        assert_eq!(lost.outcome, Outcome::Overturned(sway));
        assert!(lost.outcome_time_s == 0.0);
        let saved = run(&arch, &still, &released(60.0, sway, 0.999 * critical)).summary;
        assert_eq!(saved.outcome, Outcome::Rest);
        assert!(saved.energy_defect_ratio < 1e-7);
    }
}

#[test]
fn a_chain_without_end_dies_out_in_finite_time() {
    let arch = four_links(3.0, 0.15, 157.5, HingeSites::Anywhere);
    let still = GroundMotion::still();
    let history = run(&arch, &still, &released(30.0, Sway::Left, 0.02));
    assert_eq!(history.summary.outcome, Outcome::Rest);
    assert!(
        impact_times_s(&history)
            .windows(2)
            .all(|pair| pair[0] < pair[1])
    );
    // Energies after impacts fall, and the last is below the criterion for rest.
    let after_j: Vec<f64> = history
        .impacts()
        .map(|(_, impact)| impact.energy_after_j)
        .collect();
    assert!(after_j.windows(2).all(|pair| pair[0] > pair[1]));
    let [.., last_but_one_j, last_j] = after_j[..] else {
        panic!("{after_j:?}")
    };
    let rocking = Rocking::new(&arch, &still, GRAVITY, REST_ENERGY_RATIO);
    let least_j = REST_ENERGY_RATIO * rocking.barrier * arch.joules_per_unit();
    assert!(last_j < least_j && last_but_one_j >= least_j);
}

#[test]
fn the_time_of_overturning_is_the_last_passage_outwards() {
    // A cosine pushes out, pulls back and pushes again: the structure may pass the critical rotation, come back, and
    // pass it once more. After the reported instant it is never inside again.
    let arch = semicircle();
    let link = arch.link(0).unwrap();
    let (mut overturned, mut passed_before) = (0, 0);
    for duration_s in [0.6, 1.0, 1.5] {
        for step in 0..60 {
            let amplitude_g = 0.16 + 0.012 * f64::from(step);
            let ground = pulse(Pulse::OneCosine, -amplitude_g, duration_s);
            let summary = run(&arch, &ground, &request(20.0)).summary;
            if summary.outcome != Outcome::Overturned(Sway::Right) || summary.impacts > 0 {
                continue;
            }
            let (_, samples) = run_sampled(&arch, &ground, &sampled(20.0, 1e-3));
            overturned += 1;
            let inside = |s: &&Sample| -s.rotations_rad[0] < link.critical_rad * (1.0 - 1e-9);
            let last_inside = samples.iter().rfind(inside).unwrap().time_s;
            assert!(
                last_inside <= summary.outcome_time_s,
                "{duration_s} {amplitude_g}"
            );
            assert!(
                summary.outcome_time_s <= last_inside + 1.001e-3,
                "{duration_s} {amplitude_g}"
            );
            let first_outside = samples.iter().find(|s| !inside(s)).unwrap().time_s;
            passed_before += usize::from(first_outside < last_inside);
        }
    }
    assert!(
        overturned > 10 && passed_before > 0,
        "{overturned} {passed_before}"
    );
}

/// Memory that the lists of samples take, in bytes.
fn bytes(samples: &archrock::Samples) -> usize {
    fn of<T>(list: &[T]) -> usize {
        size_of_val(list)
    }
    of(&samples.time_s)
        + of(&samples.ground_acceleration_m_s2)
        + of(&samples.vertical_acceleration_m_s2)
        + of(&samples.phase)
        + of(&samples.state)
        + of(&samples.rotations_rad)
        + of(&samples.rates_rad_s)
        + of(&samples.poses)
        + of(&samples.hinges)
        + of(&samples.first_hinge)
        + of(&samples.demand)
        + of(&samples.energy_j)
        + of(&samples.energy_ratio)
        + of(&samples.rotation_over_critical)
        + of(&samples.gaps_m)
        + of(&samples.offsets_m)
}

#[test]
fn the_memory_of_a_history_is_known_before_and_bounded() {
    let column = "[column]\nheight_m = 4\nwidth_m = 0.8\n";
    let arch =
        "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\nvoussoirs = 9\n";
    for (structure, free) in [
        (column.to_owned(), ""),
        (arch.to_owned(), ""),
        (arch.to_owned(), "[free_hinges]\n"),
        (
            format!("{column}drums = 5\n"),
            "[free_hinges]\nfriction_coefficient = 0.6\n",
        ),
    ] {
        let text = format!(
            "{structure}{free}[ground.one_sine]\namplitude_g = 0.4\nduration_s = 0.4\n\
             [simulation]\nduration_s = 1\noutput_step_s = 1e-3\n"
        );
        let scenario = archrock::Scenario::parse(&text, "s.toml").unwrap();
        let (model, request) = (scenario.model().unwrap(), scenario.request());
        let history = model.history(scenario.ground_motion(), &request).unwrap();
        let count = request.most_samples(scenario.ground_motion());
        assert!((1001..=1003).contains(&count) && history.samples.len() as u64 <= count);
        // Not all hinges that may be open are always open; the bound is too large by that.
        let needed = model.sample_bytes(scenario.ground_motion(), &request);
        let taken = bytes(&history.samples) as u64;
        assert!(taken <= needed && needed < 2 * taken, "{taken} {needed}");
        let within = |bytes| {
            let mut recording = Recording::new(needed, bytes)?;
            let summary = model.simulate(scenario.ground_motion(), &request, Some(&mut recording));
            summary.unwrap();
            recording.finish()
        };
        // The events also need memory.
        let Err(error) = within(needed) else {
            panic!("the events have no room")
        };
        assert!(error.needed_bytes > needed && error.allowed_bytes == needed);
        let (samples, events) = within(needed + 1_000_000).unwrap();
        assert!(samples == history.samples && events == history.events);
        let Err(error) = within(needed - 1) else {
            panic!("the samples have no room")
        };
        assert_eq!(error.needed_bytes, needed);
        let words = error.to_string();
        assert!(
            words.contains(" MB of memory, and ") && words.contains("output_step_s"),
            "{words}"
        );
    }
}
