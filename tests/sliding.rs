//! Joints that slip: limit analysis, and the motion.

use std::f64::consts::PI;

use archrock::mechanics::blocks::Row;
use archrock::mechanics::friction::{FrictionError, least_coefficient, onset};
use archrock::mechanics::geometry::ring::Ring;
use archrock::mechanics::stability;
use archrock::mechanics::sway::Sway;

fn arch(embrace_deg: f64, thickness_ratio: f64, voussoirs: usize, radius_m: f64) -> Row {
    let ring = Ring::new(thickness_ratio, embrace_deg / 180.0 * PI).unwrap();
    Row::arch(&ring, voussoirs, radius_m, 1.0, 2000.0).unwrap()
}

/// Another computation of the same bound, printed with five digits.
#[test]
fn the_associated_bound_is_the_published_one() {
    let row = arch(157.5, 0.15, 7, 10.0);
    for (coefficient, acceleration_g, slides) in [
        (0.3, 0.14725, true),
        (0.35, 0.20748, true),
        (0.4, 0.26376, true),
        (0.5, 0.37001, false),
        (1.0, 0.37001, false),
    ] {
        for sway in [Sway::Right, Sway::Left] {
            let onset = onset(&row, coefficient, sway).unwrap().unwrap();
            let miss = onset.acceleration_g - acceleration_g;
            assert!(miss.abs() < 1e-5, "{coefficient} {miss}");
            assert_eq!(
                onset.sliding_governs(),
                slides,
                "{coefficient} {:?}",
                onset.yields
            );
        }
    }
    let semicircle = arch(180.0, 0.15, 36, 5.0);
    for coefficient in [0.3, 0.35] {
        let refused = onset(&semicircle, coefficient, Sway::Right);
        assert_eq!(refused, Err(FrictionError::CannotStand(coefficient)));
    }
}

/// With much friction the limit analysis without sliding, another programme, gives the same.
#[test]
fn much_friction_is_no_sliding() {
    for (embrace_deg, thickness_ratio, voussoirs) in
        [(157.5, 0.15, 7), (180.0, 0.15, 36), (120.0, 0.1, 20)]
    {
        let row = arch(embrace_deg, thickness_ratio, voussoirs, 5.0);
        let without = stability::onset(&row, Sway::Right).unwrap().unwrap();
        let with = onset(&row, 5.0, Sway::Right).unwrap().unwrap();
        assert!((with.acceleration_g / without.acceleration_g - 1.0).abs() < 1e-7);
        assert_eq!(with.yields.len(), without.openings.len());
        for (with, without) in with.yields.iter().zip(&without.openings) {
            assert_eq!(with.joint, without.joint);
            assert_eq!(with.slips, None);
        }
    }
}

/// A block on its base: it slides below the slope of its diagonal, and overturns above.
#[test]
fn a_block_slides_or_overturns() {
    let row = Row::tapered_stack(&[4.0], 0.8, 0.8, 1.0, 2000.0).unwrap();
    for (coefficient, acceleration_g) in [(0.1, 0.1), (0.19, 0.19), (0.21, 0.2), (0.7, 0.2)] {
        let onset = onset(&row, coefficient, Sway::Right).unwrap().unwrap();
        assert!((onset.acceleration_g - acceleration_g).abs() < 1e-7);
        assert_eq!(onset.sliding_governs(), coefficient < 0.2);
    }
}

/// At the least coefficient the push that the row bears vanishes; a column stands with any.
#[test]
fn below_the_least_coefficient_nothing_stands() {
    let row = arch(157.5, 0.15, 7, 10.0);
    let least = least_coefficient(&row).unwrap();
    assert!(onset(&row, least + 1e-6, Sway::Right).is_ok());
    assert!(onset(&row, least - 1e-6, Sway::Right).is_err());
    // A column stands with any friction.
    let column = Row::tapered_stack(&[1.0, 1.0], 0.8, 0.8, 1.0, 2000.0).unwrap();
    assert!(least_coefficient(&column).unwrap() <= 1e-6);
}
