//! Equivalent blocks and the dimensionless view, compared with the motions that they represent.

use archrock::mechanics::{Mechanism as _, MechanismChain, equivalent_towards};
use archrock::studies::run::Scales;
use archrock::{
    Arch, Column, FourLinks, GroundMotion, ImpactModel, Initial, MechanismModel, Model as _, Pulse,
    Request, RockingColumn, Sway,
};

const GRAVITY_M_S2: f64 = 9.81;

fn arch(thickness_ratio: f64, embrace_deg: f64, mean_radius_m: f64) -> FourLinks {
    let arch = Arch::new(mean_radius_m, thickness_ratio, embrace_deg).unwrap();
    FourLinks::of_arch(&arch, ImpactModel::Mirrored).unwrap()
}

const ARCHES: [(f64, f64); 3] = [(0.15, 180.0), (0.15, 157.5), (0.2, 140.0)];

/// Released a little before the unstable equilibrium, a structure falls back as `cosh(p_c t)`. The next
/// terms are of the order of the distance, 1e-5 of `q_c` at the start and 12 times that at the end.
#[test]
fn an_arch_leaves_its_unstable_equilibrium_at_the_rate_of_the_block() {
    for (thickness_ratio, embrace_deg) in ARCHES {
        let arch = arch(thickness_ratio, embrace_deg, 3.0);
        let critical_rad = arch.link(0).unwrap().critical_rad;
        let blocks = equivalent_towards(&arch, Sway::Right, GRAVITY_M_S2).unwrap();
        let p_c = blocks.at_critical.unwrap().frequency_rad_s;
        let still = GroundMotion::still();
        let distance = 1e-5;
        let request = Request {
            end_s: 3.2 / p_c,
            relative_tolerance: 1e-13,
            initial: Some(Initial {
                sway: Sway::Right,
                rotation_rad: critical_rad * (1.0 - distance),
                rate_rad_s: 0.0,
            }),
            output_step_s: 0.1 / p_c,
            ..Request::default()
        };
        for sample in arch.history(&still, &request).unwrap().samples.iter() {
            let left = 1.0 + sample.rotation_over_critical.unwrap();
            let expected = distance * (p_c * sample.time_s).cosh();
            assert!((left / expected - 1.0).abs() < 1e-3, "{left} {expected}");
        }
    }
}

/// A hop that starts at the rate `v` against the deceleration `k`, both in the coordinate of unit mass, obeys
/// `s'' = n^2 s - k` up to the order `s^2` and lasts `2 atanh(n v / k) / n = 2 v / k (1 + (n v / k)^2 / 3)`. With
/// `n^2 = p_0^2 cos(alpha)`, the first term beyond `2 v / k` gives `p_0`. The third derivative of the
/// potential adds the next order, smaller by `v^2`, which extrapolation from two hops removes.
#[test]
fn small_hops_last_as_long_as_those_of_the_block() {
    for (thickness_ratio, embrace_deg) in ARCHES {
        let arch = arch(thickness_ratio, embrace_deg, 3.0);
        let link = arch.link(0).unwrap();
        let blocks = equivalent_towards(&arch, Sway::Right, GRAVITY_M_S2).unwrap();
        let at_zero = link.mechanism.coefficients(0.0);
        let still = GroundMotion::still();
        // n^2 from half a hop: after release at q, it closes with the rate v after atanh(n v / k) / n.
        let measured = |part: f64| {
            let request = Request {
                end_s: 10.0,
                relative_tolerance: 1e-13,
                initial: Some(Initial {
                    sway: Sway::Left,
                    rotation_rad: part * link.critical_rad,
                    rate_rad_s: 0.0,
                }),
                ..Request::default()
            };
            let history = arch.history(&still, &request).unwrap();
            let (time_s, impact) = history.impacts().next().unwrap();
            let deceleration = GRAVITY_M_S2 / 3.0 * at_zero.s_y / at_zero.inertia.sqrt();
            // In a sway to the left the coordinate is the rotation of the right body.
            let straight_s = -impact.rates_before_rad_s[2] * at_zero.inertia.sqrt() / deceleration;
            (time_s / straight_s - 1.0) * 3.0 / (straight_s * straight_s)
        };
        let (coarse, fine) = (measured(2e-2), measured(1e-2));
        let growth_squared = 2.0 * fine - coarse;
        let p_0 = blocks.at_rest.unwrap().frequency_rad_s;
        let expected = p_0 * p_0 * blocks.slenderness_rad.cos();
        assert!(
            (growth_squared / expected - 1.0).abs() < 1e-3,
            "{growth_squared} {expected}"
        );
    }
}

/// Dimensionless history: time, acceleration and rotation of the samples, and the instants of the impacts.
fn dimensionless(
    structure: &(impl MechanismChain + MechanismModel),
    p_t_p: f64,
    amplitude: f64,
) -> (Vec<[f64; 3]>, Vec<f64>) {
    let scales = Scales::new(structure, GRAVITY_M_S2).unwrap();
    let p = scales.frequency_rad_s;
    let ground = Pulse::OneSine
        .lasting_s(p_t_p / p)
        .horizontal_m_s2(amplitude * scales.incipient_m_s2[0])
        .unwrap();
    let request = Request {
        end_s: 12.1 / p,
        relative_tolerance: 1e-12,
        output_step_s: 0.25 / p,
        ..Request::default()
    };
    let history = structure.history(&ground, &request).unwrap();
    let rows = history.samples.iter().map(|sample| {
        [
            sample.time_s * p,
            sample.ground_acceleration_m_s2 / scales.incipient_m_s2[0],
            sample.rotation_over_critical.unwrap(),
        ]
    });
    let impacts = history.impacts().map(|(time_s, _)| time_s * p);
    (rows.collect(), impacts.collect())
}

#[track_caller]
fn assert_same(a: &(Vec<[f64; 3]>, Vec<f64>), b: &(Vec<[f64; 3]>, Vec<f64>), tolerance: f64) {
    assert_eq!((a.0.len(), a.1.len()), (b.0.len(), b.1.len()));
    assert!(a.1.len() > 2, "{} impacts", a.1.len());
    let values = |x: &(Vec<[f64; 3]>, Vec<f64>)| [x.0.concat(), x.1.clone()].concat();
    for (a, b) in values(a).into_iter().zip(values(b)) {
        assert!((a - b).abs() < tolerance, "{a} {b}");
    }
}

fn column(height_m: f64, width_m: f64, model: ImpactModel) -> RockingColumn {
    RockingColumn::new(&Column::new(height_m, width_m).unwrap(), model).unwrap()
}

/// Size cancels out of the dimensionless view.
#[test]
fn scaled_structures_have_similar_motions() {
    let of_arch = |radius_m| dimensionless(&arch(0.15, 157.5, radius_m), 1.0, 2.0);
    assert_same(&of_arch(1.0), &of_arch(37.0), 1e-9);
    let of_column = |size: f64| {
        dimensionless(
            &column(4.0 * size, size, ImpactModel::SameSections),
            1.0,
            2.0,
        )
    };
    assert_same(&of_column(0.1), &of_column(7.0), 1e-9);
}

/// For slender columns with equal loss of energy, the slenderness cancels as well, up to its square.
#[test]
fn slender_columns_have_similar_motions() {
    let of_column = |width_m: f64| {
        let model = ImpactModel::Prescribed { restitution: 0.8 };
        dimensionless(&column(4.0, width_m, model), 1.0, 2.0)
    };
    assert_same(&of_column(0.004), &of_column(0.002), 1e-5);
}
