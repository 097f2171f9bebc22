//! Rows of blocks from arbitrary numbers: either an error, or a row that can be shaken.

use crate::common::{between_faces, number, straight_sided_arch};
use archrock::dynamics::{FreeHinges, RowModelError, RowOptions};
use archrock::mechanics::Ring;
use archrock::mechanics::stability::StabilityError;
use archrock::mechanics::{Block, Drum, Joint, MAX_BLOCKS, Row, RowError, Supports};
use archrock::{Column, Model as _, Pulse, Request, SimulationError};
use nalgebra::Vector2;
use proptest::prelude::*;

/// A row gives a model whose summary has finite numbers, or the right error: for a faulty row, for one that falls,
/// or for a size that cannot be simulated. If all numbers are fine, there must be a row.
fn check(row: Result<Row, RowError>, fine: bool) -> Result<(), TestCaseError> {
    let row = match row {
        Ok(row) => row,
        Err(error) => {
            prop_assert!(!fine, "{error}");
            return Ok(());
        }
    };
    prop_assert!(row.mass_kg() > 0.0 && row.blocks.iter().all(|b| b.mass_kg.is_finite()));
    // A hundred steps of a length that suits the size.
    let time_s = (row.size_m / 9.81).sqrt();
    let sized = fine || (1e-3..1e6).contains(&row.size_m);
    let model = match FreeHinges::new(row) {
        Ok(model) => model,
        Err(RowModelError::Stability(StabilityError::CannotStand(opening))) => {
            prop_assert!(!fine || !opening.is_empty());
            return Ok(());
        }
        // If numbers of all magnitudes are mixed, the velocities are not always found.
        Err(RowModelError::Stability(StabilityError::Contact(error))) => {
            prop_assert!(!fine, "{error}");
            return Ok(());
        }
        Err(error) => return Err(TestCaseError::fail(error.to_string())),
    };
    let ground = match Pulse::Rectangular
        .lasting_s(0.01 * time_s)
        .horizontal_m_s2(-5.0)
    {
        Ok(ground) => ground,
        Err(error) => {
            prop_assert!(!sized, "{error}");
            return Ok(());
        }
    };
    // No samples are requested in between; they would need steps of their own.
    let end_s = 0.03 * time_s;
    let request = Request {
        end_s,
        output_step_s: end_s,
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
        Err(SimulationError::Row(error)) => prop_assert!(!fine, "{error}"),
        Err(SimulationError::Argument(error)) => prop_assert!(!sized, "{error}"),
        Err(error) => return Err(TestCaseError::fail(error.to_string())),
    }
    Ok(())
}

/// A column of a few drums must form a row with these heights; if there is none, the sizes must be the reason.
fn check_column(column: &Column) -> Result<(), TestCaseError> {
    let heights_m = column.drum_heights_m();
    if heights_m.len() >= 8 {
        return Ok(());
    }
    let sizes = [column.height_m, column.width_m, column.top_width_m()];
    let usual = |size_m: &f64| (1e-3..1e6).contains(size_m);
    match FreeHinges::of_column(column) {
        Ok(model) => {
            let joints = &model.row().joints;
            prop_assert_eq!(joints.len(), heights_m.len());
            for (pair, height_m) in joints.windows(2).zip(&heights_m) {
                let rise_m = pair[1].intrados_m.y - pair[0].intrados_m.y;
                prop_assert!((rise_m - height_m).abs() <= 1e-9 * column.height_m);
            }
        }
        Err(error) => {
            prop_assert!(
                !(heights_m.iter().all(usual) && sizes.iter().all(usual)),
                "{error}"
            );
        }
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

#[test]
fn an_arch_has_at_most_five_hundred_voussoirs() {
    let ring = Ring::new(0.1, 2.4).unwrap();
    let arch = |voussoirs| Row::arch(&ring, voussoirs, 5.0, 1.0, 2000.0);
    check(arch(MAX_BLOCKS), true).unwrap();
    assert_eq!(
        arch(MAX_BLOCKS + 1).unwrap_err(),
        RowError::Count(MAX_BLOCKS + 1)
    );
    let straight = straight_sided_arch(&ring, MAX_BLOCKS + 1, 5.0, 1.0, 2000.0);
    assert_eq!(straight.unwrap_err(), RowError::Count(MAX_BLOCKS + 1));
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
        let counted = (1..=MAX_BLOCKS).contains(&voussoirs);
        let size = [radius_m, depth_m, density_kg_m3];
        let usual = counted && size.iter().all(|x| (1e-3..1e6).contains(x));
        for row in [
            Row::arch(&ring, voussoirs, radius_m, depth_m, density_kg_m3),
            straight_sided_arch(&ring, voussoirs, radius_m, depth_m, density_kg_m3),
        ] {
            match &row {
                Err(RowError::Count(count)) => prop_assert!(*count == voussoirs && !counted),
                Err(RowError::Dimension(_, value)) => {
                    prop_assert!(size.iter().any(|x| x == value || x.is_nan() && value.is_nan()));
                }
                // Relative to the other sizes, a size or its powers may vanish.
                Err(RowError::Thickness(..) | RowError::Block(..) | RowError::Crossing(_) | RowError::Order { .. }) => {
                    prop_assert!(!usual);
                }
                Err(error) => return Err(TestCaseError::fail(error.to_string())),
                Ok(row) => prop_assert_eq!(row.blocks.len(), voussoirs),
            }
            check(row, usual)?;
        }
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
        let sizes = drums.iter().flat_map(|d| [d.height_m, d.base_width_m, d.top_width_m]);
        let sizes: Vec<f64> = sizes.chain([depth_m, density_kg_m3]).collect();
        let row = Row::stack(&drums, depth_m, density_kg_m3);
        match &row {
            Err(RowError::Count(count)) => prop_assert!(*count == 0 && drums.is_empty()),
            Err(RowError::Dimension(_, value)) => {
                prop_assert!(!(*value > 0.0 && *value < f64::INFINITY));
                prop_assert!(sizes.iter().any(|x| x == value || x.is_nan() && value.is_nan()));
            }
            // A drum may vanish next to another one.
            Err(RowError::Thickness(..) | RowError::Block(..) | RowError::Crossing(_) | RowError::Order { .. }) => {
                prop_assert!(!sizes.iter().all(|x| (1e-3..1e6).contains(x)));
            }
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
            Ok(row) => prop_assert_eq!(row.blocks.len(), drums.len()),
        }
        let fine = drums.iter().all(|drum| {
            (0.2..2.0).contains(&drum.height_m)
                && [drum.base_width_m, drum.top_width_m].iter().all(|width_m| (0.3..2.0).contains(width_m))
        });
        check(row, fine && !drums.is_empty() && [depth_m, density_kg_m3].iter().all(|x| (0.5..3e3).contains(x)))?;
    }

    #[test]
    fn blocks_between_any_faces(
        faces in proptest::collection::vec(joint(), 0..6),
        supports in supports(),
        size_m in number(1.0..10.0),
    ) {
        let row = between_faces(&faces, supports, size_m, 1.0, 2000.0);
        match &row {
            Err(RowError::Count(count)) => prop_assert!(*count == 0 && faces.len() < 2),
            Err(RowError::Dimension(..)) => prop_assert!(!(size_m > 0.0 && size_m < f64::INFINITY)),
            Err(RowError::Joints { .. } | RowError::NoVoussoirs) => {
                return Err(TestCaseError::fail("the joints are counted by the row"));
            }
            Err(RowError::Size { size_m, extent_m }) => prop_assert!(*size_m < 1e-6 * extent_m),
            Err(RowError::Thickness(..) | RowError::Block(..) | RowError::Crossing(_) | RowError::Order { .. }) | Ok(_) => {}
            Err(error) => prop_assert!(false, "{error}"),
        }
        // Steps follow the size: a joint far larger than the row would need steps without end.
        if let Ok(row) = &row {
            prop_assert!(row.joints.iter().all(|joint| row.size_m >= 1e-6 * joint.thickness_m()));
        }
        check(row, false)?;
    }

    #[test]
    fn any_blocks(
        masses in proptest::collection::vec((number(1.0..1e4), point(5.0), number(1.0..1e4)), 0..5),
        joints in proptest::collection::vec(joint(), 0..6),
        supports in supports(),
    ) {
        let blocks = masses
            .iter()
            .map(|&(mass_kg, centre_m, inertia_kg_m2)| Block { mass_kg, centre_m, inertia_kg_m2 })
            .collect();
        let counts = (masses.len(), joints.len());
        let row = Row::new(blocks, joints, supports, 5.0);
        let expected = counts.0 + usize::from(supports == Supports::Both);
        match &row {
            Err(RowError::Count(count)) => prop_assert!(*count == 0 && counts.0 == 0),
            Err(RowError::Joints { blocks, joints }) => {
                prop_assert!((*blocks, *joints) == counts && counts.1 != expected);
            }
            Err(RowError::Dimension(..)) => return Err(TestCaseError::fail("the size is fine")),
            Err(RowError::Size { extent_m, .. }) => prop_assert!(*extent_m > 5e6),
            _ => prop_assert!(counts.0 > 0 && counts.1 == expected),
        }
        check(row, false)?;
    }

    #[test]
    fn columns_of_drums(
        (height_m, width_m, top_width_m) in (number(1.0..9.0), number(0.3..2.0), number(0.3..2.0)),
        drums in 0..700_usize,
        parts in proptest::collection::vec(number(0.1..2.0), 0..4),
        adds_up in proptest::option::of(proptest::sample::select(vec![0.0, 5e-7, 3e-6, 1e-3])),
    ) {
        // Heights whose sum is right, or off by a given part; otherwise the test would see only errors.
        let scale = adds_up.map_or(1.0, |off| (1.0 + off) * height_m / parts.iter().sum::<f64>());
        let heights_m: Vec<f64> = parts.iter().map(|part| part * scale).collect();
        let made = Column::new(height_m, width_m).and_then(|column| column.with_top_width_m(top_width_m));
        let allowed = |size_m: &f64| (1e-9..=1e12).contains(size_m);
        let column = match made {
            Ok(column) => column,
            Err(error) => {
                prop_assert!(!allowed(&error.value), "{error}");
                return Ok(());
            }
        };
        match column.clone().with_drums(drums) {
            Ok(cut) => {
                prop_assert_eq!(cut.drum_heights_m(), vec![height_m / drums as f64; drums]);
                check_column(&cut)?;
            }
            Err(error) => prop_assert!(
                error.argument == "drums" && error.value == drums as f64 && !(1..=MAX_BLOCKS).contains(&drums),
                "{error}"
            ),
        }
        let sum_m: f64 = heights_m.iter().sum();
        match column.with_drum_heights_m(heights_m.clone()) {
            Ok(cut) => {
                prop_assert_eq!(cut.drum_heights_m(), heights_m);
                prop_assert!((sum_m - height_m).abs() <= 1e-6 * height_m);
                check_column(&cut)?;
            }
            Err(error) => match error.argument {
                "drums" => prop_assert!(heights_m.is_empty()),
                "drum_heights_m" => prop_assert!(!heights_m.iter().all(allowed)),
                "sum of drum_heights_m" => {
                    prop_assert!(error.value == sum_m && (sum_m - height_m).abs() > 1e-6 * height_m);
                }
                _ => return Err(TestCaseError::fail(error.to_string())),
            },
        }
    }

    #[test]
    fn steps(longest_s in number(1e-5..1e-3), shortest_s in number(1e-6..1e-4)) {
        let column = Column::new(4.0, 0.8).unwrap();
        let options = RowOptions { longest_step_s: Some(longest_s), shortest_step_s: Some(shortest_s), ..RowOptions::default() };
        let allowed = |step_s: f64| (1e-9..=1.0).contains(&step_s);
        match FreeHinges::of_column(&column).unwrap().with_options(options) {
            Ok(_) => prop_assert!(longest_s >= shortest_s && allowed(shortest_s) && allowed(longest_s)),
            Err(RowModelError::Argument(error)) => match error.argument {
                "longest_step_s" => prop_assert!(!allowed(longest_s) || longest_s < shortest_s),
                "shortest_step_s" => prop_assert!(!allowed(shortest_s)),
                _ => return Err(TestCaseError::fail(error.to_string())),
            },
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        }
    }
}

/// Outlines are for pictures. They enclose the mass that the row has by other formulas, except that arcs are drawn as chords of 3
/// degrees, which cut off 2e-4 of the area.
#[test]
fn outlines_hold_the_blocks() {
    let ring = Ring::new(0.15, 170_f64.to_radians()).unwrap();
    let rows = [
        Row::arch(&ring, 5, 4.0, 0.7, 2100.0).unwrap(),
        straight_sided_arch(&ring, 9, 4.0, 0.7, 2100.0).unwrap(),
        Row::tapered_stack(&[0.8, 0.8, 0.4], 1.0, 0.7, 0.7, 2100.0).unwrap(),
    ];
    for row in rows {
        assert_eq!(row.outlines_m.len(), row.blocks.len());
        for (outline, block) in row.outlines_m.iter().zip(&row.blocks) {
            let drawn = Block::prism(outline, 0.7, 2100.0);
            assert!((drawn.mass_kg / block.mass_kg - 1.0).abs() < 1e-3);
            assert!((drawn.centre_m - block.centre_m).norm() < 1e-3 * row.size_m);
        }
    }
}
