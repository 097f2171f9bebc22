//! Ground motions from arbitrary numbers: either an error that names the number, or a motion that is sound.

use archrock::{GroundError, GroundMotion, Pulse, WaveTrain};
use nalgebra::Vector2;
use proptest::prelude::*;

/// Any number at all; often enough a valid one.
fn any_number() -> impl Strategy<Value = f64> {
    let special = [
        0.0,
        -0.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MIN_POSITIVE,
        5e-324,
        f64::MAX,
        1e9,
        1e-8,
        1e-12,
    ];
    prop_oneof![
        proptest::num::f64::ANY,
        proptest::sample::select(special.to_vec()),
        -20.0..20.0,
        1e-3..3.0,
    ]
}

fn any_samples() -> impl Strategy<Value = Vec<(f64, f64)>> {
    let any = proptest::collection::vec((any_number(), any_number()), 0..6);
    let rising = proptest::collection::vec((1e-9..1.0, -20.0..20.0_f64), 0..30);
    let rising = (-1.0..1.0, rising).prop_map(|(mut time_s, steps)| {
        let sample = |(step_s, acceleration)| {
            time_s += step_s;
            (time_s, acceleration)
        };
        steps.into_iter().map(sample).collect()
    });
    prop_oneof![any, rising]
}

/// A sound motion has pieces from zero to infinity without gaps, and finite values on them.
fn assert_works(ground: Result<GroundMotion, GroundError>, other: f64) {
    let ground = match ground {
        Ok(ground) => ground,
        Err(error) => {
            let words = error.to_string();
            assert!(words.contains('`') && words.len() < 300, "{words}");
            return;
        }
    };
    let pieces = &ground.pieces;
    assert_eq!(pieces[0].start_s, 0.0);
    for pair in pieces.windows(2) {
        assert!(pair[0].start_s < pair[0].end_s && pair[0].end_s == pair[1].start_s);
    }
    let last = pieces.last().unwrap();
    assert!(last.stays_still() && last.start_s.is_finite());
    for piece in pieces {
        let end_s = piece.end_s.min(piece.start_s + 1e9);
        for time_s in [piece.start_s, 0.5 * (piece.start_s + end_s), end_s] {
            let (acceleration, rate) = piece.acceleration_and_rate(time_s);
            assert!(
                acceleration.iter().chain(&rate).all(|x| x.is_finite()),
                "{piece:?}"
            );
            assert!(acceleration.norm() < 1e13, "{piece:?}");
        }
        assert!(piece.longest_step_s() > 0.0);
    }
    assert!(ground.end_s().is_finite());
    assert!(ground.peaks_m_s2(other).iter().all(|x| x.is_finite()));
    assert!(ground.free_fall_s(other).is_none_or(f64::is_finite));
    assert!(ground.cut_at(&[other]).pieces.len() <= pieces.len() + 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn pulses(
        pulse in proptest::sample::select(Pulse::ALL),
        (x, y) in (any_number(), any_number()),
        (duration_s, start_s) in (any_number(), any_number()),
        (cycles, phase_rad) in (any_number(), any_number()),
        other in any_number(),
    ) {
        assert_works(pulse.lasting_s(duration_s).starting_at_s(start_s).horizontal_m_s2(x), other);
        let train = WaveTrain { cycles, phase_rad };
        let along = pulse.lasting_s(duration_s).starting_at_s(start_s).with_train(train).inclined_m_s2(Vector2::new(x, y));
        assert_works(along, other);
    }

    #[test]
    fn records(
        horizontal in any_samples(),
        vertical in any_samples(),
        start_s in any_number(),
        other in any_number(),
    ) {
        assert_works(GroundMotion::record(&horizontal, &vertical, start_s), other);
        let accelerations: Vec<f64> = horizontal.iter().map(|sample| sample.1).collect();
        assert_works(GroundMotion::from_samples(start_s, &accelerations), other);
    }
}

#[test]
fn errors_name_the_number_and_its_range() {
    let pulse = |amplitude, duration_s, start_s| {
        let error = Pulse::HalfSine
            .lasting_s(duration_s)
            .starting_at_s(start_s)
            .horizontal_m_s2(amplitude);
        error.unwrap_err().to_string()
    };
    assert_eq!(
        pulse(1.0, -0.2, 0.0),
        "`duration_s = -0.2` is not allowed: it must be a number from 1e-12 to 1e9"
    );
    assert!(pulse(f64::NAN, 0.2, 0.0).starts_with("`amplitude_m_s2.x = NaN` is not allowed"));
    assert!(pulse(1.0, 0.2, f64::INFINITY).starts_with("`start_s = inf` is not allowed"));
    let train = WaveTrain {
        cycles: 0.5,
        phase_rad: 0.0,
    };
    let error = Pulse::Gabor
        .lasting_s(0.2)
        .with_train(train)
        .inclined_m_s2(Vector2::x())
        .unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("`cycles = 0.5` is not allowed")
    );

    let record = |horizontal: &[(f64, f64)], vertical: &[(f64, f64)], start_s| {
        let error = GroundMotion::record(horizontal, vertical, start_s);
        error.unwrap_err().to_string()
    };
    assert_eq!(
        record(&[], &[], 0.0),
        "`horizontal` has too few samples (0): it must have at least 2"
    );
    assert_eq!(
        record(&[], &[(0.0, 1.0)], 0.0),
        "`vertical` has too few samples (1): it must have at least 2"
    );
    assert_eq!(
        record(&[(0.0, 1.0), (0.5, f64::NAN)], &[], 0.0),
        "sample 1 of `horizontal`: `acceleration_m_s2 = NaN` is not allowed: it must be a number from \
         -1e12 to 1e12"
    );
    assert_eq!(
        record(&[(0.0, 1.0), (0.5, 0.0), (0.5, 1.0)], &[], 0.0),
        "sample 2 of `horizontal` is at 0.5 s and the one before at 0.5 s: times must rise by at least 1e-8 s"
    );
    assert!(
        record(&[(-1.0, 1.0), (0.5, 0.0)], &[], 0.5).starts_with("`start_s + first time = -0.5`")
    );
    let error = GroundMotion::from_samples(0.0, &[1.0, 2.0]).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("`step_s = 0.0` is not allowed")
    );
}

#[test]
fn a_record_of_samples_starts_at_time_zero() {
    let ground = GroundMotion::from_samples(0.25, &[1.0, -2.0, 0.5]).unwrap();
    let record = [(0.0, 1.0), (0.25, -2.0), (0.5, 0.5)];
    assert_eq!(ground, GroundMotion::record(&record, &[], 0.0).unwrap());
}
