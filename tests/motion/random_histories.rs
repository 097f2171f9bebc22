//! Random structures, grounds and starts: every history is sound, whatever the input.

use crate::common;
use crate::common::three;
use archrock::mechanics::four_link::HingeSites;
use archrock::mechanics::{Mechanism as _, MechanismChain as _};
use archrock::{
    FourLinks, GroundMotion, ImpactModel, Initial, Model as _, Outcome, Pulse, Request, Sample,
    State, Sway,
};
use archrock_motion::internals::hybrid::rocking::Rocking;
use proptest::prelude::*;

fn model() -> impl Strategy<Value = ImpactModel> {
    prop_oneof![
        6 => Just(ImpactModel::MaxRestitution),
        1 => Just(ImpactModel::SameSections),
        1 => Just(ImpactModel::Mirrored),
        2 => (0.0_f64..0.95).prop_map(|restitution| ImpactModel::Prescribed { restitution }),
    ]
}

fn sites() -> impl Strategy<Value = HingeSites> {
    prop_oneof![
        1 => Just(HingeSites::Anywhere),
        2 => (5_usize..30).prop_map(HingeSites::Voussoirs),
    ]
}

fn ground() -> impl Strategy<Value = Option<(Pulse, f64, f64, f64)>> {
    let pulse = (
        proptest::sample::select(Pulse::ALL.to_vec()),
        // Multiples of the incipient acceleration, to either side; durations from a blow to a swell.
        prop_oneof![-6.0_f64..6.0, 0.98_f64..1.05, -300.0_f64..300.0],
        (-5.0_f64..0.7).prop_map(|exponent| 10_f64.powf(exponent)),
        prop_oneof![Just(0.0), 0.0_f64..3.0],
    );
    proptest::option::weighted(0.9, pulse)
}

fn start() -> impl Strategy<Value = Option<(Sway, f64)>> {
    let side = prop_oneof![Just(Sway::Right), Just(Sway::Left)];
    // Fractions of the critical rotation.
    proptest::option::weighted(0.3, (side, prop_oneof![1e-6_f64..1.0, 1.0_f64..1.2]))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]

    #[test]
    fn a_history_is_sound(
        (t, embrace) in (0.08_f64..0.35, 100.0_f64..180.0),
        (sites, model) in (sites(), model()),
        radius in 0.5_f64..40.0,
        gravity in prop_oneof![Just(9.81), 1.0_f64..30.0],
        (ground, start) in (ground(), start()),
        exponent in -10.0_f64..-6.0,
    ) {
        let arch = common::arch(radius, t, embrace, sites).with_depth_m(0.7).unwrap();
        let arch = arch.with_density_kg_m3(1900.0).unwrap();
        let Ok(arch) = FourLinks::of_arch(&arch, model) else { return Ok(()) };
        let incipient = arch.incipient_g() * gravity;
        let ground = ground.map_or_else(GroundMotion::still, |(pulse, factor, duration_s, start_s)| {
            pulse.lasting_s(duration_s).starting_at_s(start_s).horizontal_m_s2(factor * incipient).unwrap()
        });
        let link = arch.link(0).unwrap();
        let request = Request {
            gravity_m_s2: gravity,
            end_s: 15.0,
            outcome_by_s: None,
            output_step_s: 0.01,
            initial: start.map(|(sway, part)| Initial {
                sway,
                rotation_rad: (part * link.critical_rad).min(0.9 * link.limit_rad),
                rate_rad_s: 0.0,
            }),
            relative_tolerance: 10_f64.powf(exponent),
            rest_energy_ratio: 1e-8,
        };
        let history = arch
            .history(&ground, &request)
            .map_err(|error| TestCaseError::fail(error.to_string()))?;

        let summary = &history.summary;
        let samples: Vec<Sample> = history.samples.iter().collect();

        // Time is strictly monotone from zero to the end.
        prop_assert!(samples[0].time_s == 0.0);
        prop_assert!(samples.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
        prop_assert!(samples.last().unwrap().time_s == summary.end_s);
        prop_assert!(samples.windows(2).all(|pair| pair[0].phase <= pair[1].phase));
        // A vanishing hop at the end of a sequence may be shorter than the spacing of times.
        prop_assert!(common::impact_times_s(&history).windows(2).all(|pair| pair[0] <= pair[1]));
        prop_assert!(summary.end_s <= request.end_s);
        prop_assert!(summary.outcome_time_s.is_finite() && summary.outcome_time_s <= summary.end_s);

        // Rounding, and interpolation within a step, in units of the critical rotation.
        let slack = link.critical_rad * (1e-12 + request.relative_tolerance);
        let falls_s = summary.overturned_s().unwrap_or(f64::INFINITY);
        for sample in &samples {
            let all = sample.rotations_rad.iter().chain(&sample.rates_rad_s);
            prop_assert!(all.chain([&sample.ground_acceleration_m_s2]).all(|x| x.is_finite()));
            // All hinges are open. When it sways right, the left body turns clockwise, and between two bodies
            // intrados hinges close clockwise, extrados hinges anticlockwise; a sway to the left is the mirror image.
            let [left, middle, right] = three(&sample.rotations_rad);
            let openings = match sample.state {
                State::Rocking(Sway::Right) => [-left, middle - left, middle - right, -right],
                State::Rocking(Sway::Left) => [right, right - middle, left - middle, left],
                State::Rest | State::Overturned(_) => [0.0; 4],
            };
            for opening in openings {
                prop_assert!(opening >= -20.0 * slack, "{openings:?} at {} s", sample.time_s);
            }
            // Peaks are those up to the instant of overturning.
            let stands = sample.time_s <= falls_s;
            for (rotation, peak) in sample.rotations_rad.iter().zip(&summary.peak_rotations_rad).filter(|_| stands) {
                prop_assert!(rotation.abs() <= peak * (1.0 + 1e-5) + 20.0 * slack, "{rotation} {peak}");
            }
        }
        // Energies never grow at an impact.
        for (_, impact) in history.impacts() {
            prop_assert!(impact.energy_after_j <= impact.energy_before_j * (1.0 + 1e-12));
        }
        // The defect adds up the errors of tens of steps, relative to the largest energy: the barrier, or the
        // energy that a blow many times stronger gave.
        let barrier = Rocking::new(&arch, &ground, gravity, 1e-8).barrier;
        let rates = history.samples.rates_rad_s.iter();
        let fastest = rates.fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let inertia = link.mechanism.coefficients(0.0).inertia;
        let energy_ratio = 1.0 + 0.5 * inertia * fastest * fastest / barrier;
        let bound = (300.0 * request.relative_tolerance + 1e-12) * energy_ratio;
        prop_assert!(summary.energy_defect_ratio <= bound, "{} {bound}", summary.energy_defect_ratio);
        match summary.outcome {
            Outcome::NeverMoved => prop_assert!(summary.impacts == 0 && request.initial.is_none()),
            Outcome::Overturned(_) => prop_assert!(summary.peak_rotations_rad.iter().any(|peak| *peak > 0.0)),
            Outcome::StillRocking | Outcome::Incomplete => prop_assert!(summary.end_s == request.end_s),
            Outcome::Rest => prop_assert!(summary.impacts > 0),
            outcome => prop_assert!(false, "mechanisms are rigid: {outcome}"),
        }
    }
}
