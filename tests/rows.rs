//! Rows of blocks from numbers of any kind: an error, or a row that can be shaken.

use archrock::dynamics::free_hinges::{FreeHinges, Steps};
use archrock::mechanics::blocks::{Block, Drum, Joint, Row, RowError, Supports};
use archrock::mechanics::geometry::ring::Ring;
use archrock::{Column, GroundMotion, Model as _, Pulse, Request};
use nalgebra::Vector2;
use proptest::prelude::*;

/// Mostly fine, so that one wrong number is found among right ones.
fn number(fine: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    let special = vec![
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        0.0,
        -1.0,
        5e-324,
        f64::MAX,
        1e-9,
        1e9,
    ];
    prop_oneof![
        8 => fine,
        1 => proptest::num::f64::ANY,
        1 => proptest::sample::select(special),
    ]
}

/// What is made of a row is a model whose summary has finite numbers, or an error that says something.
fn check(row: Result<Row, RowError>) -> Result<(), TestCaseError> {
    let row = match row {
        Ok(row) => row,
        Err(error) => {
            prop_assert!(!error.to_string().is_empty());
            return Ok(());
        }
    };
    prop_assert!(row.mass_kg() > 0.0 && row.blocks().iter().all(|b| b.mass_kg.is_finite()));
    // A hundred steps of whatever length suits the size.
    let time_s = (row.size_m() / 9.81).sqrt();
    let end_s = 0.03 * time_s;
    let model = match FreeHinges::new(row) {
        Ok(model) => model,
        Err(error) => {
            prop_assert!(!error.to_string().is_empty());
            return Ok(());
        }
    };
    let Ok(ground) = GroundMotion::pulse(Pulse::Rectangular, -5.0, 0.01 * time_s, 0.0) else {
        return Ok(());
    };
    let request = Request {
        end_s,
        ..Request::default()
    };
    match model.simulate(&ground, &request, None) {
        Ok(summary) => {
            let numbers = [
                summary.outcome_time_s,
                summary.end_s,
                summary.energy_defect_ratio,
            ];
            prop_assert!(numbers.iter().all(|x| x.is_finite()), "{summary:?}");
            prop_assert!(summary.peak_rotations_rad.iter().all(|x| x.is_finite()));
        }
        Err(error) => prop_assert!(!error.to_string().is_empty()),
    }
    Ok(())
}

fn point(scale: f64) -> impl Strategy<Value = Vector2<f64>> {
    (number(-scale..scale), number(-scale..scale)).prop_map(|(x, y)| Vector2::new(x, y))
}

fn joint() -> impl Strategy<Value = Joint> {
    (point(5.0), point(5.0)).prop_map(|(intrados_m, extrados_m)| Joint {
        intrados_m,
        extrados_m,
    })
}

fn supports() -> impl Strategy<Value = Supports> {
    proptest::sample::select(vec![Supports::Left, Supports::Both])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn arches(
        (t, embrace_rad, voussoirs) in (0.05..0.4, 1.0..3.1, 0..20_usize),
        radius_m in number(0.5..20.0),
        depth_m in number(0.5..2.0),
        density_kg_m3 in number(1e3..3e3),
    ) {
        let ring = Ring::new(t, embrace_rad).unwrap();
        check(Row::arch(&ring, voussoirs, radius_m, depth_m, density_kg_m3))?;
        check(Row::straight_sided_arch(&ring, voussoirs, radius_m, depth_m, density_kg_m3))?;
    }

    #[test]
    fn stacks(
        sizes in proptest::collection::vec((number(0.2..2.0), number(0.3..2.0), number(0.3..2.0)), 0..6),
        depth_m in number(0.5..2.0),
        density_kg_m3 in number(1e3..3e3),
    ) {
        let drums: Vec<Drum> = sizes
            .into_iter()
            .map(|(height_m, base_width_m, top_width_m)| Drum { height_m, base_width_m, top_width_m })
            .collect();
        check(Row::stack(&drums, depth_m, density_kg_m3))?;
    }

    #[test]
    fn blocks_between_any_faces(
        faces in proptest::collection::vec(joint(), 0..6),
        supports in supports(),
        size_m in number(1.0..10.0),
    ) {
        check(Row::between_faces(&faces, supports, size_m, 1.0, 2000.0))?;
    }

    #[test]
    fn any_blocks(
        masses in proptest::collection::vec((number(1.0..1e4), point(5.0), number(1.0..1e4)), 0..5),
        joints in proptest::collection::vec(joint(), 0..6),
        supports in supports(),
    ) {
        let blocks = masses
            .into_iter()
            .map(|(mass_kg, centre_m, inertia_kg_m2)| Block { mass_kg, centre_m, inertia_kg_m2 })
            .collect();
        check(Row::new(blocks, joints, supports, 5.0))?;
    }

    #[test]
    fn columns_of_drums(
        (height_m, width_m, top_width_m) in (number(1.0..9.0), number(0.3..2.0), number(0.3..2.0)),
        drums in 0..700_usize,
        heights_m in proptest::collection::vec(number(0.1..2.0), 0..4),
    ) {
        let column = Column::new(height_m, width_m).and_then(|column| column.with_top_width_m(top_width_m));
        let Ok(column) = column else { return Ok(()) };
        for cut in [column.clone().with_drums(drums), column.with_drum_heights_m(heights_m)] {
            match cut {
                Ok(column) => {
                    let sum_m: f64 = column.drum_heights_m().iter().sum();
                    prop_assert!((sum_m - height_m).abs() <= 2e-6 * height_m);
                    if drums < 8 {
                        let model = FreeHinges::of_column(&column);
                        prop_assert!(model.is_ok() || !model.unwrap_err().to_string().is_empty());
                    }
                }
                Err(error) => prop_assert!(error.to_string().contains("drum")),
            }
        }
    }

    #[test]
    fn steps(longest_s in number(1e-5..1e-3), shortest_s in number(1e-6..1e-4)) {
        let column = Column::new(4.0, 0.8).unwrap();
        let steps = Steps { longest_step_s: Some(longest_s), shortest_step_s: Some(shortest_s) };
        match FreeHinges::of_column(&column).unwrap().with_steps(steps) {
            Ok(_) => prop_assert!(longest_s >= shortest_s && shortest_s > 0.0 && longest_s <= 1e9),
            Err(error) => prop_assert!(error.argument.ends_with("_step_s")),
        }
    }
}
