//! Structures that start with a rate, compared with energy integrals, quadratures and independent moments of inertia.

use archrock::dynamics::Details;
use archrock::mechanics::{MechanismChain as _, Ring, Row};
use archrock::{
    BackWall, Column, ElasticJoints, ElasticProperties, FourLinks, FreeHinges, GroundMotion,
    History, ImpactModel, Initial, Model, Outcome, Request, RockingColumn, RowOptions, Sample,
    Sway,
};

use crate::common::{GRAVITY, impact_times_s, integral, run, run_sampled, sampled};

/// Half diagonal of the column in metres.
const HALF_M: f64 = 2.0;

fn column(alpha: f64) -> Column {
    Column::new(2.0 * HALF_M * alpha.cos(), 2.0 * HALF_M * alpha.sin()).unwrap()
}

/// Housner's frequency parameter.
fn p() -> f64 {
    (0.75 * GRAVITY / HALF_M).sqrt()
}

fn started(end_s: f64, sway: Sway, rotation_rad: f64, rate_rad_s: f64) -> Request {
    Request {
        initial: Some(Initial {
            sway,
            rotation_rad,
            rate_rad_s,
        }),
        relative_tolerance: 1e-12,
        ..sampled(end_s, end_s)
    }
}

/// Models of the column as one block: four links, free hinges, and joints that slip.
fn models(alpha: f64) -> [Box<dyn Model>; 3] {
    let column = column(alpha);
    let free = FreeHinges::of_column(&column).unwrap();
    let options = RowOptions {
        friction_coefficient: Some(3.0),
        ..RowOptions::default()
    };
    let slipping = free.clone().with_options(options).unwrap();
    let housner = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
    [Box::new(housner), Box::new(free), Box::new(slipping)]
}

fn history(model: &dyn Model, request: &Request) -> History {
    model.history(&GroundMotion::still(), request).unwrap()
}

/// The first sample, or the last one.
fn sample(history: &History, first: bool) -> Sample {
    let mut samples = history.samples.iter();
    let found = if first {
        samples.next()
    } else {
        samples.last()
    };
    found.unwrap()
}

fn kinetic_j(alpha: f64, rate_rad_s: f64) -> f64 {
    let column = column(alpha);
    let mass_kg = column.density_kg_m3 * column.height_m * column.width_m * column.depth_m;
    2.0 / 3.0 * mass_kg * HALF_M.powi(2) * rate_rad_s.powi(2)
}

/// Largest rotation after a start at `theta` with a rate: `cos(alpha - peak) = cos(alpha - theta) + w^2/(2 p^2)`.
fn peak_rad(alpha: f64, theta: f64, rate_rad_s: f64) -> f64 {
    alpha - ((alpha - theta).cos() + 0.5 * (rate_rad_s / p()).powi(2)).acos()
}

/// Time from `from` up to the peak: the integral of `d theta / theta'` with `theta'^2 = 2 p^2 (cos(alpha - peak) - cos(alpha - theta))`. With
/// `theta = peak - span u^2` the integrand is smooth, and the difference of cosines is written as a product.
fn time_to_peak_s(alpha: f64, from: f64, peak: f64) -> f64 {
    let span = peak - from;
    let integrand = |u: f64| {
        let half = 0.5 * span * u * u;
        let over_square = 0.5 * span * if half == 0.0 { 1.0 } else { half.sin() / half };
        let square = 4.0 * p() * p() * over_square * (alpha - peak + half).sin();
        2.0 * span / square.sqrt()
    };
    integral(integrand)
}

#[test]
fn a_rate_overturns_a_block_from_its_energy() {
    for alpha in [0.1, 0.3, 0.6_f64] {
        // `1/2 I w^2 = m g R (1 - cos(alpha))`.
        let least_rad_s = p() * (2.0 * (1.0 - alpha.cos())).sqrt();
        for (model, tolerance) in models(alpha).iter().zip([1e-9, 1e-5, 1e-3]) {
            for sway in [Sway::Right, Sway::Left] {
                let outcome = |factor: f64| {
                    let request = started(30.0, sway, 0.0, factor * least_rad_s);
                    history(&**model, &request).summary.outcome
                };
                assert_eq!(outcome(1.0 + tolerance), Outcome::Overturned(sway));
                assert!(!matches!(outcome(1.0 - tolerance), Outcome::Overturned(_)));
            }
        }
    }
}

#[test]
fn peaks_and_impacts_follow_from_the_energy_of_the_start() {
    for (alpha, theta, part) in [
        (0.2, 0.0, 0.5),
        (0.2, 0.0, 0.95),
        (0.4, 0.1, 0.5),
        (0.4, 0.1, -0.5),
        (0.15, 0.12, -0.1),
    ] {
        let barrier = f64::cos(alpha - theta);
        let rate_rad_s = part * p() * (2.0 * (1.0 - barrier)).sqrt();
        let peak = peak_rad(alpha, theta, rate_rad_s);
        let to_peak_s = time_to_peak_s(alpha, theta, peak);
        let to_impact_s = time_to_peak_s(alpha, 0.0, peak) + part.signum() * to_peak_s;
        let start_j = kinetic_j(alpha, rate_rad_s);
        for (model, tolerance) in models(alpha).iter().zip([1e-9, 1e-4, 3e-3]) {
            let request = started(20.0, Sway::Left, theta, rate_rad_s);
            let history = history(&**model, &request);
            let first = sample(&history, true);
            let rate = first.rates_rad_s[0];
            assert!(
                (rate / rate_rad_s - 1.0).abs() < 1e-12,
                "{rate} {rate_rad_s} {part} {theta}"
            );
            // `m g R`, from `1/2 (4/3 m R^2) w^2 = m g R (w / p)^2 / 2`.
            let unit_j = 2.0 * kinetic_j(alpha, p());
            let lifted_j = unit_j * ((alpha - theta).cos() - alpha.cos());
            assert!((first.energy_j / (start_j + lifted_j) - 1.0).abs() < 1e-9);
            let (time_s, _) = history.impacts().next().unwrap();
            assert!(
                (time_s / to_impact_s - 1.0).abs() < tolerance,
                "{alpha} {theta} {part}: {time_s} {to_impact_s}"
            );
            // Towards the position at rest, the largest rotation is that of the start.
            let largest = if part > 0.0 { peak } else { theta };
            let found = history.summary.peak_rotations_rad[0];
            assert!(
                (found / largest - 1.0).abs() < tolerance,
                "{found} {largest}"
            );
            assert!(history.summary.energy_defect_ratio < 1e-4);
            if let Some(row) = history.summary.row() {
                assert!(row.largest_kinetic_j >= start_j * (1.0 - 1e-12));
            }
        }
    }
}

/// Starts to the left and to the right give mirrored histories.
#[test]
fn a_start_to_the_other_side_is_the_mirror_image() {
    let arch = |sway| {
        let ring = Ring::new(0.15, 2.75).unwrap();
        let row = Row::arch(&ring, 7, 10.0, 1.0, 2000.0).unwrap();
        let model = FreeHinges::new(row).unwrap();
        sample(&history(&model, &started(3.0, sway, 0.0, 0.05)), false).rotations_rad
    };
    let (right, mut left) = (arch(Sway::Right), arch(Sway::Left));
    left.reverse();
    for (right, left) in right.iter().zip(left) {
        assert!((right + left).abs() < 1e-9, "{right} {left}");
    }
    for model in models(0.25) {
        let [right, left] =
            [Sway::Right, Sway::Left].map(|sway| history(&*model, &started(4.0, sway, 0.05, -0.2)));
        let [right_s, left_s] = [&right, &left].map(impact_times_s);
        assert!(right_s.len() > 2);
        for (right_s, left_s) in right_s.iter().zip(left_s) {
            assert!((right_s - left_s).abs() < 1e-9, "{right_s} {left_s}");
        }
        let rotation = |history: &History| sample(history, false).rotations_rad[0];
        assert!((rotation(&right) + rotation(&left)).abs() < 1e-9);
    }
}

/// The kinetic energy of the first mechanism, from small displacements of the blocks: `M = sum(m |du/dq|^2 + I (dphi/dq)^2)`.
#[test]
fn an_arch_starts_with_the_energy_of_its_mechanism() {
    let ring = Ring::new(0.15, 2.75).unwrap();
    let row = Row::arch(&ring, 9, 10.0, 1.0, 2000.0).unwrap();
    let links = FourLinks::of_row(&row, ImpactModel::MaxRestitution).unwrap();
    let free = FreeHinges::new(row.clone()).unwrap();
    let slipping = free.clone().with_options(RowOptions {
        friction_coefficient: Some(2.0),
        ..RowOptions::default()
    });
    let slipping = slipping.unwrap();
    let rate_rad_s = 0.03;
    for sway in [Sway::Right, Sway::Left] {
        for theta in [0.0, 0.02] {
            let placed = |rotation_rad: f64| -> Sample {
                let request = started(1e-3, sway, rotation_rad, 0.0);
                let (_, samples) = run_sampled(&free, &GroundMotion::still(), &request);
                samples[0].clone()
            };
            // Central differences where the mechanism may be displaced to both sides.
            let small = 1e-5;
            let (from, to) = if theta > 0.0 {
                (theta - small, theta + small)
            } else {
                (1e-9, small)
            };
            let (before, after) = (placed(from), placed(to));
            let blocks = row.blocks.iter().zip(before.poses.iter().zip(&after.poses));
            let twice = blocks.map(|(block, (before, after))| {
                let moved_m = after.current_position(block.centre_m)
                    - before.current_position(block.centre_m);
                let turned = after.rotation_rad() - before.rotation_rad();
                (block.mass_kg * moved_m.norm_squared() + block.inertia_kg_m2 * turned * turned)
                    / (to - from).powi(2)
            });
            let kinetic_j = 0.5 * twice.sum::<f64>() * rate_rad_s * rate_rad_s;
            let models: [&dyn Model; 3] = [&links, &free, &slipping];
            for model in models {
                let start = |rate_rad_s: f64| {
                    let request = started(1e-3, sway, theta, rate_rad_s);
                    sample(&history(model, &request), true)
                };
                let lifted_j = if theta > 0.0 {
                    start(0.0).energy_j
                } else {
                    0.0
                };
                let first = start(rate_rad_s);
                let start_j = first.energy_j - lifted_j;
                let end_rates = [first.rates_rad_s.first(), first.rates_rad_s.last()];
                let own = end_rates[usize::from(sway == Sway::Left)].unwrap();
                assert!((own + sway.sign() * rate_rad_s).abs() < 1e-12, "{own}");
                assert!(
                    (start_j / kinetic_j - 1.0).abs() < 1e-3,
                    "{theta}: {start_j} {kinetic_j}"
                );
            }
        }
        let elastic =
            ElasticJoints::new(row.clone(), ElasticProperties::of_stiffness(1e10)).unwrap();
        let energy_j = |model: &dyn Model| {
            let request = started(1e-3, sway, 0.0, rate_rad_s);
            sample(&history(model, &request), true).energy_j
        };
        assert!((energy_j(&elastic) / energy_j(&links) - 1.0).abs() < 1e-9);
        // `1/2 M w^2 = g` times the rise to the unstable equilibrium.
        let link = links.link_from(sway, 0).unwrap();
        let barrier = 2.0 * GRAVITY * link.barrier / links.length_m();
        let least_rad_s = (barrier / link.at_zero.inertia).sqrt();
        let outcome = |factor: f64| {
            let request = started(60.0, sway, 0.0, factor * least_rad_s);
            history(&links, &request).summary.outcome
        };
        assert_eq!(outcome(1.0 + 1e-9), Outcome::Overturned(sway));
        assert!(!matches!(outcome(1.0 - 1e-9), Outcome::Overturned(_)));
    }
}

/// A rate back to the wall behind a column strikes it as the free column strikes its base, and leaves to the same side.
#[test]
fn a_rate_back_to_the_wall_strikes_it_first() {
    let free = column(0.2);
    let held = free.clone().with_back(BackWall {
        side: Sway::Left,
        height_m: None,
        rate_ratio: Some(0.5),
    });
    let [held, free] = [held.unwrap(), free].map(|column| {
        let model = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
        let history = history(&model, &started(1.5, Sway::Right, 0.1, -0.3));
        history
            .impacts()
            .next()
            .map(|(time_s, impact)| (time_s, impact.clone()))
    });
    let ((held_s, held), (free_s, free)) = (held.unwrap(), free.unwrap());
    assert_eq!(held_s, free_s);
    assert_eq!(held.rates_before_rad_s, free.rates_before_rad_s);
    assert!((held.rates_after_rad_s[0] + 0.5 * held.rates_before_rad_s[0]).abs() < 1e-12);
    assert!(held.strikes_wall && !free.strikes_wall);
}

/// Elastic joints start with the velocities of rigid ones. The stiffer the joints, the closer is the rate that overturns.
#[test]
fn elastic_joints_start_with_the_rate_of_rigid_ones() {
    let alpha = 0.25_f64;
    let least_rad_s = p() * (2.0 * (1.0 - alpha.cos())).sqrt();
    for (drums, stiffness_pa_m, low, high) in [
        (1, 1e10, 0.97, 1.03),
        (3, 1e10, 0.95, 1.05),
        (1, 1e9, 0.9, 1.06),
    ] {
        let row = column(alpha).with_drums(drums).unwrap().row().unwrap();
        let properties = ElasticProperties {
            friction_coefficient: None,
            ..ElasticProperties::of_stiffness(stiffness_pa_m)
        };
        let model = ElasticJoints::new(row, properties).unwrap();
        let mut ends = Vec::new();
        for factor in [low, high] {
            let request = started(20.0, Sway::Right, 0.0, factor * least_rad_s);
            let history = run(&model, &GroundMotion::still(), &request);
            let start_j = sample(&history, true).energy_j;
            let due_j = kinetic_j(alpha, factor * least_rad_s);
            assert!((start_j / due_j - 1.0).abs() < 1e-9, "{start_j} {due_j}");
            let Details::Elastic(row, _) = &history.summary.details else {
                unreachable!()
            };
            assert!(row.energy_error < 1e-2, "{}", row.energy_error);
            assert!(row.largest_kinetic_j >= start_j * (1.0 - 1e-9));
            ends.push(matches!(
                history.summary.outcome,
                Outcome::Overturned(Sway::Right)
            ));
        }
        assert_eq!(ends, [false, true], "{drums} {stiffness_pa_m}");
        let rotated = started(1.0, Sway::Right, 0.01, 0.1);
        let error = model.history(&GroundMotion::still(), &rotated).unwrap_err();
        assert!(error.to_string().contains("elastic joints"), "{error}");
    }
}

#[test]
fn a_start_without_motion_is_refused() {
    for (rotation_rad, rate_rad_s) in [
        (0.0, 0.0),
        (0.0, -0.1),
        (1e-200, 1.0),
        (-0.1, 1.0),
        (0.1, 101.0),
    ] {
        for model in models(0.2) {
            let request = started(1.0, Sway::Right, rotation_rad, rate_rad_s);
            assert!(model.history(&GroundMotion::still(), &request).is_err());
        }
    }
}
