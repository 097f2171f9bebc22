//! Ties in limit analysis, compared with static programmes that have the tie forces as unknowns, and with independently computed
//! numbers; and reading and printing of ties.

use crate::common::program::{printed, refused, scenarios};
use crate::common::prose::{golden, shows};
use crate::common::{Random, parsed, pushes_g, ring};
use archrock::Scenario;
use archrock::mechanics::Edge;
use archrock::mechanics::Sway;
use archrock::mechanics::friction;
use archrock::mechanics::settling::Follower;
use archrock::mechanics::stability::{StabilityError, limit_with_yielding_ties, onset};
use archrock::mechanics::{Anchor, Tie, TieError};
use archrock::mechanics::{Row, Supports};
use archrock::studies::limit;
use archrock::studies::verify::{VerifyPage, verify};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver as _, NonnegativeConeT, SolverStatus,
};
use nalgebra::Vector2;
use serde_json::Value;

const GRAVITY_M_S2: f64 = 9.81;

/// A tie of which only the forces matter.
fn tie(ends: [Anchor; 2], prestress_n: f64, yield_force_n: f64) -> Tie {
    Tie {
        ends,
        stiffness_n_m: 1e9,
        prestress_n,
        yield_force_n,
        breaks_at_strain: f64::INFINITY,
    }
}

/// Anchors at the intrados corners of a joint and of the opposite joint, on the blocks above them.
fn level(row: &Row, joint: usize) -> [Anchor; 2] {
    let blocks = row.blocks.len();
    [(joint, joint), (blocks - joint, blocks - 1 - joint)].map(|(joint, block)| Anchor {
        block: Some(block),
        at_m: row.joints[joint].intrados_m,
    })
}

fn tied(row: &Row, ties: Vec<Tie>) -> Row {
    row.clone().with_ties(ties, GRAVITY_M_S2).unwrap()
}

/// The static theorem: the largest push for which the thrust at every joint lies between its corners. Unknowns are the reaction
/// at the first joint and the forces of the ties, each within its bounds. In units of weight and size; `None` if no push is
/// feasible.
fn statically(row: &Row, sway: Sway, bounds: &[[f64; 2]]) -> Option<f64> {
    extreme_push(row, sway, bounds, 1.0)
}

/// The smallest feasible push that is not negative: zero if the row stands without a push.
fn least_statically(row: &Row, sway: Sway, bounds: &[[f64; 2]]) -> Option<f64> {
    extreme_push(row, sway, bounds, -1.0)
}

/// The feasible push that maximises `sign` times the push.
fn extreme_push(row: &Row, sway: Sway, bounds: &[[f64; 2]], sign: f64) -> Option<f64> {
    let (size_m, mass_kg) = (row.size_m, row.mass_kg());
    let origin = row.joints[0].middle_m();
    // Wrench about the origin on the part before each joint, for each unknown (push, reaction, ties) and for the known loads.
    let width = 4 + bounds.len();
    let wrench = |point_m: Vector2<f64>, force: Vector2<f64>| {
        let arm = (point_m - origin) / size_m;
        [force.x, force.y, arm.perp(&force)]
    };
    let mut by_unknown = vec![[0.0; 3]; width];
    by_unknown[1] = [1.0, 0.0, 0.0];
    by_unknown[2] = [0.0, 1.0, 0.0];
    by_unknown[3] = [0.0, 0.0, 1.0];
    let mut known = [0.0; 3];
    let (mut rows, mut columns, mut values, mut right) = (vec![], vec![], vec![], vec![]);
    let mut bound = |coefficients: Vec<f64>, limit: f64| {
        for (column, value) in coefficients.into_iter().enumerate() {
            if value != 0.0 {
                rows.push(right.len());
                columns.push(column);
                values.push(value);
            }
        }
        right.push(limit);
    };
    for (index, joint) in row.joints.iter().enumerate() {
        // Normal force and moments on the part before the joint: compression at both corners.
        let along = joint.direction();
        let across = Vector2::new(-along.y, along.x) * -row.handedness;
        for corner in [Edge::Intrados, Edge::Extrados] {
            // The moment about one corner equals the force at the other times the distance.
            let other = match corner {
                Edge::Intrados => Edge::Extrados,
                Edge::Extrados => Edge::Intrados,
            };
            let (pole, at) = (joint.corner_m(other), joint.corner_m(corner));
            let arm = (pole - origin) / size_m;
            let about = |w: &[f64; 3]| w[2] - (arm.x * w[1] - arm.y * w[0]);
            let sense = ((at - pole) / size_m).perp(&across);
            // The part before the joint presses on the part behind it: its wrench has the sense of a push along `-across`.
            let coefficients = by_unknown.iter().map(|w| about(w) / sense).collect();
            bound(coefficients, -about(&known) / sense);
        }
        let Some(block) = row.blocks.get(index) else {
            continue;
        };
        let weight = block.mass_kg / mass_kg;
        let push = wrench(block.centre_m, Vector2::new(sway.sign() * weight, 0.0));
        let falls = wrench(block.centre_m, Vector2::new(0.0, -weight));
        for axis in 0..3 {
            by_unknown[0][axis] += push[axis];
            known[axis] += falls[axis];
        }
        for (number, tie) in row.ties.iter().enumerate() {
            for (anchor, towards) in tie.ends.iter().zip([tie.direction(), -tie.direction()]) {
                if anchor.block == Some(index) {
                    let pull = wrench(anchor.at_m, towards);
                    let sums = by_unknown[4 + number].iter_mut();
                    for (sum, pull) in sums.zip(&pull) {
                        *sum += pull;
                    }
                }
            }
        }
    }
    for (number, [least, most]) in bounds.iter().enumerate() {
        let mut coefficients = vec![0.0; width];
        coefficients[4 + number] = 1.0;
        bound(coefficients.clone(), *most);
        coefficients[4 + number] = -1.0;
        bound(coefficients, -least);
    }
    let mut objective = vec![0.0; width];
    objective[0] = -sign;
    // Pushes against the sway count as zero.
    let mut coefficients = vec![0.0; width];
    coefficients[0] = -1.0;
    bound(coefficients, 0.0);
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-12,
        tol_gap_rel: 1e-12,
        tol_feas: 1e-12,
        ..DefaultSettings::default()
    };
    let count = right.len();
    let mut solver = DefaultSolver::new(
        &CscMatrix::zeros((width, width)),
        &objective,
        &CscMatrix::new_from_triplets(count, width, rows, columns, values),
        &right,
        &[NonnegativeConeT(count)],
        settings,
    )
    .unwrap();
    solver.solve();
    let status = solver.solution.status;
    match status {
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => None,
        SolverStatus::Solved | SolverStatus::AlmostSolved => Some(solver.solution.x[0]),
        _ => panic!("{status:?} {:?}", solver.solution.x),
    }
}

/// Random arches with one or two ties: with the forces at rest, and with any force up to yielding.
#[test]
fn pushes_with_ties_agree_with_the_static_theorem() {
    let mut random = Random(23);
    let (mut compared, mut limits, mut fall) = (0, 0, 0);
    while compared < 50 {
        let mut number = |low: f64, high: f64| random.within(low, high);
        let (thickness, embrace) = (number(0.11, 0.22), number(130.0, 180.0));
        let voussoirs = number(9.0, 31.0) as usize;
        let row = Row::arch(&ring(thickness, embrace), voussoirs, 5.0, 1.0, 2000.0).unwrap();
        let weight_n = row.mass_kg() * GRAVITY_M_S2;
        let count = if number(0.0, 1.0) < 0.6 { 1 } else { 2 };
        let ties: Vec<Tie> = (0..count)
            .map(|_| {
                // From any block to a block far from it, or to the ground.
                let first = number(0.0, 0.45 * voussoirs as f64) as usize;
                let second = number(0.55 * voussoirs as f64, voussoirs as f64) as usize;
                let of_block = |block: usize| Anchor {
                    block: Some(block),
                    at_m: row.blocks[block].centre_m,
                };
                let ends = match number(0.0, 1.0) {
                    share if share < 0.7 => [of_block(first), of_block(second)],
                    _ => [
                        of_block(first),
                        Anchor {
                            block: None,
                            at_m: Vector2::new(-7.0, 2.0),
                        },
                    ],
                };
                let prestress_n = number(0.0, 0.3) * weight_n;
                tie(ends, prestress_n, prestress_n + number(0.0, 0.2) * weight_n)
            })
            .collect();
        let row = tied(&row, ties);
        let at_rest: Vec<[f64; 2]> = {
            let ties = row.ties.iter();
            ties.map(|tie| [tie.prestress_n / weight_n; 2]).collect()
        };
        let up_to_yield: Vec<[f64; 2]> = {
            let ties = row.ties.iter();
            ties.map(|tie| [0.0, tie.yield_force_n / weight_n])
                .collect()
        };
        for sway in Sway::ALL {
            let due_g = statically(&row, *sway, &at_rest);
            match onset(&row, *sway) {
                Ok(found) => {
                    let (found_g, due_g) = (found.unwrap().acceleration_g, due_g.unwrap());
                    assert!(
                        (found_g - due_g).abs() < 1e-8,
                        "{found_g} {due_g} {compared} {sway:?} {thickness} {embrace} {voussoirs} {:?} {at_rest:?}",
                        row.ties
                    );
                    let limit = limit_with_yielding_ties(&row, *sway).unwrap().unwrap();
                    let most_g = statically(&row, *sway, &up_to_yield).unwrap();
                    let limit_g = limit.onset.acceleration_g;
                    assert!((limit_g - most_g).abs() < 1e-8, "{limit_g} {most_g}");
                    assert!(limit_g > found_g - 1e-12);
                    for (force_n, tie) in limit.forces_n.iter().zip(&row.ties) {
                        assert!((0.0..=tie.yield_force_n).contains(force_n));
                    }
                    // Joints that do not slip, however large the force, give the same result.
                    let with_friction = friction::onset(&row, 50.0, *sway).unwrap().unwrap();
                    assert!((with_friction.acceleration_g - found_g).abs() < 1e-6);
                    limits += usize::from(limit_g > found_g + 1e-3);
                }
                Err(StabilityError::CannotStand(_)) => {
                    // The row may stand under a push and fall without one.
                    let least_g = least_statically(&row, *sway, &at_rest);
                    assert!(
                        least_g.is_none_or(|least_g| least_g > 1e-9),
                        "{least_g:?} {due_g:?}"
                    );
                    fall += 1;
                }
                Err(error) => panic!("{error}"),
            }
        }
        compared += 1;
    }
    assert!(limits > 10 && fall > 0 && fall < 50, "{limits} {fall}");
}

/// Worked numbers of an independent program: a constant tie force in units of the weight, and a yielding tie.
#[test]
fn pushes_of_tied_arches_agree_with_worked_numbers() {
    let cases = [
        (
            (0.15, 180.0, 36, 5.0, 9),
            231_142.679_5,
            [
                0.144_799_62,
                0.179_237_98,
                0.223_388_43,
                0.256_891_69,
                0.204_848_80,
            ],
            (0.259_315_56, 0.080_587_23),
        ),
        (
            (0.15, 157.5, 28, 10.0, 6),
            808_999.378_2,
            [
                0.354_685_79,
                0.373_518_99,
                0.394_070_71,
                0.383_331_83,
                0.308_467_03,
            ],
            (0.402_171_53, 0.064_788_59),
        ),
    ];
    for ((thickness, embrace, voussoirs, radius_m, joint), due_n, pushes_g, (most_g, best)) in cases
    {
        let row = Row::arch(&ring(thickness, embrace), voussoirs, radius_m, 1.0, 2000.0).unwrap();
        let weight_n = row.mass_kg() * GRAVITY_M_S2;
        assert!((weight_n - due_n).abs() < 1e-3);
        let pulled = |force: f64, yields: f64| {
            tied(
                &row,
                vec![tie(level(&row, joint), force * weight_n, yields * weight_n)],
            )
        };
        for sway in Sway::ALL {
            for (force, push_g) in [0.0, 0.02, 0.05, 0.1, 0.2].into_iter().zip(pushes_g) {
                let found = onset(&pulled(force, 1.0), *sway).unwrap().unwrap();
                assert!((found.acceleration_g - push_g).abs() < 1e-8, "{force}");
            }
            let limit = limit_with_yielding_ties(&pulled(0.0, 0.2), *sway)
                .unwrap()
                .unwrap();
            assert!((limit.onset.acceleration_g - most_g).abs() < 1e-8);
            let force = limit.forces_n[0] / weight_n;
            // If many forces give the same push, the smallest is reported. At the start of that plateau the push is flat to 1e-8.
            assert!((force - best).abs() < 1e-6, "{force} {best}");
            let weak = limit_with_yielding_ties(&pulled(0.0, 0.05), *sway)
                .unwrap()
                .unwrap();
            assert!((weak.onset.acceleration_g - pushes_g[2]).abs() < 1e-8);
            let falls = onset(&pulled(0.4, 1.0), *sway);
            assert!(matches!(falls, Err(StabilityError::CannotStand(_))));
        }
    }
    // One end on the ground.
    let row = Row::arch(&ring(0.15, 180.0), 36, 5.0, 1.0, 2000.0).unwrap();
    let weight_n = row.mass_kg() * GRAVITY_M_S2;
    let ends = [
        Anchor {
            block: Some(9),
            at_m: row.joints[9].extrados_m,
        },
        Anchor {
            block: None,
            at_m: Vector2::new(-5.582_868_863, 3.270_368_863),
        },
    ];
    for (sway, at_rest_g, yielding_g) in [
        (Sway::Right, 0.169_674_77, 0.169_674_77),
        (Sway::Left, 0.050_183_38, 0.144_799_62),
    ] {
        let row = tied(&row, vec![tie(ends, 0.05 * weight_n, 0.05 * weight_n)]);
        let found = onset(&row, sway).unwrap().unwrap();
        assert!((found.acceleration_g - at_rest_g).abs() < 1e-8);
        let limit = limit_with_yielding_ties(&row, sway).unwrap().unwrap();
        assert!((limit.onset.acceleration_g - yielding_g).abs() < 1e-8);
    }
}

/// A row with ties and its mirror image are overturned by mirrored pushes of equal size.
#[test]
fn mirrored_ties_have_mirrored_pushes() {
    let row = Row::arch(&ring(0.16, 170.0), 15, 4.0, 1.0, 2100.0).unwrap();
    let weight_n = row.mass_kg() * GRAVITY_M_S2;
    let ends = [
        Anchor {
            block: Some(2),
            at_m: row.blocks[2].centre_m,
        },
        Anchor {
            block: Some(9),
            at_m: row.joints[9].extrados_m,
        },
    ];
    let row = tied(&row, vec![tie(ends, 0.03 * weight_n, 0.05 * weight_n)]);
    let mirrored = row.mirrored().unwrap();
    for sway in Sway::ALL {
        let own = onset(&row, *sway).unwrap().unwrap().acceleration_g;
        let other = onset(&mirrored, sway.opposite()).unwrap().unwrap();
        let ratio = own / other.acceleration_g;
        assert!((ratio - 1.0).abs() < 1e-11, "{ratio:?}");
    }
}

fn numbers(answer: &Value, path: &str) -> f64 {
    answer
        .pointer(path)
        .and_then(Value::as_f64)
        .unwrap_or(f64::NAN)
}

fn on_piers() -> String {
    let text = std::fs::read_to_string(scenarios().join("pointed-arch-on-piers.toml")).unwrap();
    let (before, rest) = text.split_once("[fill]").unwrap();
    let (_, after) = rest.split_once("[ground").unwrap();
    format!("{before}[ground{after}")
}

/// A pointed arch on piers, tied at its springings or higher: onset, limit with a yielding tie, and rows that no longer stand.
#[test]
fn pushes_of_a_tied_arch_on_piers_agree_with_worked_numbers() {
    let text = on_piers();
    let answer = |tie: &str| {
        limit(&parsed(&format!(
            "{text}\n[[tie]]\n{tie}\nstiffness_n_m = 1e8\n"
        )))
    };
    let onsets = |tie: &str| {
        let answer = answer(tie).unwrap().json;
        numbers(&answer, "/incipient_acceleration_g/right")
    };
    for (force_n, due_g) in [
        (5e3, 0.253_886_85),
        (10e3, 0.253_886_85),
        (20e3, 0.236_842_74),
        (40e3, 0.163_233_00),
    ] {
        let found_g = onsets(&format!(
            "between = 'springings'\nprestress_n = {force_n:?}"
        ));
        assert!((found_g - due_g).abs() < 1e-8, "{force_n} {found_g}");
    }
    let springings = answer("between = 'springings'\nyield_force_n = 2e4")
        .unwrap()
        .json;
    assert!(
        (numbers(&springings, "/ties/yielding/right/incipient_acceleration_g") - 0.253_886_85)
            .abs()
            < 1e-8
    );
    assert!((numbers(&springings, "/ties/without/left") - 0.253_886_85).abs() < 1e-8);
    let higher = "from_m = [-2.1461413, 1.994094904]\nfrom_block = 6\nto_m = [2.1461413, 1.994094904]\nto_block = 13\n";
    assert!((onsets(&format!("{higher}prestress_n = 5e3")) - 0.281_963_65).abs() < 1e-8);
    assert!((onsets(&format!("{higher}prestress_n = 20e3")) - 0.198_486_38).abs() < 1e-8);
    let yielding = answer(&format!("{higher}yield_force_n = 2e4")).unwrap();
    let json = &yielding.json;
    assert!(
        (numbers(json, "/ties/yielding/right/incipient_acceleration_g") - 0.293_824_34).abs()
            < 1e-8
    );
    assert!((numbers(json, "/ties/yielding/right/forces_n/0") - 9916.90).abs() < 0.01);
    assert_eq!(
        json["ties"]["yielding"]["right"]["mechanism"]
            .as_array()
            .unwrap()
            .len(),
        5
    );
    let force_n = numbers(json, "/ties/yielding/right/forces_n/0");
    shows(&yielding.text, &[0.253_886_85, 0.293_824_34, force_n / 1e3]);
    golden("limit-of-ties", &yielding.text);
    let too_much = Scenario::parse(
        &format!(
            "{text}\n[[tie]]\nbetween = 'springings'\nstiffness_n_m = 1e8\nprestress_n = 8e4\n"
        ),
        "s.toml",
    );
    let said = too_much.unwrap_err().to_string();
    assert!(
        said.contains("`[[tie]]` overturns the structure, which stands without ties"),
        "{said}"
    );
}

const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";
const TIE: &str = "[[tie]]\nfrom_m = [-0.4, 3.5]\nto_m = [-3.4, 3.5]\nto_block = 0\nstiffness_n_m = 1e6\nprestress_n = 5000.0\n";

/// A block held by a level tie, by moments about its toe. The check by the Circolare has the same multiplier.
#[test]
fn a_tied_column_turns_about_its_toe() {
    let weight_n = 6400.0 * GRAVITY_M_S2;
    let due = |sign: f64| (weight_n * 0.4 + sign * 5000.0 * 3.5) / (weight_n * 2.0);
    assert!((due(1.0) - 0.339_366_718).abs() < 5e-10);
    let scenario = parsed(&format!("{COLUMN}{TIE}"));
    let json = limit(&scenario).unwrap().json;
    assert!((numbers(&json, "/incipient_acceleration_g/right") - due(1.0)).abs() < 1e-12);
    assert!((numbers(&json, "/incipient_acceleration_g/left") - due(-1.0)).abs() < 1e-12);
    // A tie that does not yield holds against any push to the right.
    assert!(json["ties"]["yielding"]["right"]["incipient_acceleration_g"].is_null());
    assert!((numbers(&json, "/ties/yielding/left/incipient_acceleration_g") - 0.2).abs() < 1e-9);

    let demand = "[demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.sld]\nag_g = 0.1\nf0 = 2.4\ntc_star_s = 0.28\n\
                  [demand.slv]\nag_g = 0.25\nf0 = 2.4\ntc_star_s = 0.35\n";
    let scenario = parsed(&format!("{COLUMN}{TIE}{demand}"));
    let check = verify(&scenario).unwrap();
    for (sway, mechanism) in &check.mechanisms {
        let alpha0 = mechanism.alpha0;
        assert!((alpha0 - due(sway.sign())).abs() < 1e-12, "{alpha0}");
    }
    let json = serde_json::to_value(&check).unwrap();
    let right = &json["mechanisms"]["right"];
    let sums = [
        "/sum_p_delta_y_kn",
        "/sum_f_delta_l_kn",
        "/sum_p_delta_x_kn",
    ];
    let [rise, held, sway] = sums.map(|sum| numbers(right, sum));
    assert!(
        ((rise + held) / sway - 0.339_366_718).abs() < 5e-10,
        "{right}"
    );
    let reported = VerifyPage::new(&scenario, &check, None).html();
    for words in ["F (kN)", "5.000", "0.33937"] {
        assert!(reported.contains(words), "{words}");
    }
}

/// Invalid ties are refused with a remedy.
#[test]
fn invalid_ties_are_refused() {
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 20\n";
    let section = "stiffness_n_m = 1e7\n";
    for (tie, words) in [
        (
            "from_m = [0.0, 1.0]\nto_m = [-5.0, 0.5]\n",
            "in no block; the nearest",
        ),
        (
            "from_m = [-5.0, 0.5]\nto_m = [-5.01, 0.6]\n",
            "both ends on block 1, which is rigid",
        ),
        (
            "from_m = [-5.0, 0.5]\nto_m = [5.0, 0.5]\nto_block = 1\n",
            "away from block 1",
        ),
        (
            "from_m = [-5.0, 0.5]\nto_m = [-5.0, 0.5]\nto_block = 0\n",
            "both ends at one point",
        ),
        (
            "from_m = [-5.0, 0.5]\nto_m = [5.0, 0.5]\nto_block = 21\n",
            "there are 20 blocks, counted from 1",
        ),
        ("from_m = [-5.0, 0.5]\n", "needs `to_m` beside it"),
        (
            "from_m = [-5.0]\nto_m = [5.0, 0.5]\n",
            "must be a point [x, y]",
        ),
        (
            "from_m = [-9.0, 0.5]\nfrom_block = 0\nto_m = [5.0, 0.5]\nto_block = 0\n",
            "both ends on the ground",
        ),
        ("between = 'springings'\n", "stand on rigid ground"),
        ("height_m = 9.0\n", "give a height between 0.0000 and"),
        (
            "height_m = 2.0\nbetween = 'springings'\n",
            "exactly one of the keys between, height_m, from_m",
        ),
        ("height_m = 2.0\nprestress_n = -1.0\n", "out of range"),
        (
            "height_m = 2.0\nprestress_n = 1e5\nyield_force_n = 1e4\n",
            "above the force at which it yields",
        ),
        (
            "height_m = 2.0\nprestress_n = 1e4\nbreaks_at_strain = 1e-6\n",
            "its prestress alone strains it",
        ),
        ("height_m = 2.0\nprestress_n = 1e9\n", "it is only"),
        (
            "height_m = 2.0\narea_mm2 = 100.0\nmodulus_gpa = 210.0\n",
            "cannot be combined with `area_mm2`",
        ),
        (
            "height_m = 2.0\nyield_stress_mpa = 235.0\n",
            "needs `area_mm2` beside it",
        ),
        (
            "height_m = 2.0\nmodulus_gpa = 235.0\n",
            "needs `area_mm2` beside it",
        ),
        ("height_m = 2.0\nslack = true\n", "unknown key `slack`"),
    ] {
        let text = format!("{arch}[[tie]]\n{tie}{section}");
        let said = Scenario::parse(&text, "s.toml").unwrap_err().to_string();
        assert!(said.contains(words), "{tie}{said}");
        assert!(said.starts_with("s.toml:"), "{said}");
    }
    let corner = "from_m = [-4.625, 0.0]\nto_m = [5.0, 0.5]\n";
    assert!(Scenario::parse(&format!("{arch}[[tie]]\n{corner}{section}"), "s").is_ok());
    let ring = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n[[tie]]\nheight_m = 2.0\n";
    let said = Scenario::parse(&format!("{ring}{section}"), "s")
        .unwrap_err()
        .to_string();
    assert!(said.contains("vehicles and ties need"), "{said}");
    let none = |error: TieError, words: &str| assert!(error.to_string().contains(words), "{error}");
    none(TieError::NoBlock(3), "no block 4");
    none(TieError::OnSupports, "supports");
}

/// A scenario with ties reads back, whether ties are given by section or by stiffness. `--set` changes keys of a tie by its
/// number.
#[test]
fn scenarios_with_ties_read_back() {
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 20\n";
    let ties = "[[tie]]\nheight_m = 2.0\narea_mm2 = 491.0\nmodulus_gpa = 210.0\nprestress_n = 1e4\nyield_stress_mpa = 235.0\n\
                breaks_at_strain = 0.05\n[[tie]]\nfrom_m = [-5.0, 0.5]\nto_m = [5.0, 0.5]\nstiffness_n_m = 1e7\n";
    let scenario = parsed(&format!("{arch}{ties}"));
    assert_eq!(parsed(&scenario.to_toml()), scenario);
    let [first, second] = scenario.structure.ties() else {
        panic!("two ties");
    };
    let length_m = 2.0 * first.ends[1].at_m.x;
    assert!((first.stiffness_n_m - 491e-6 * 210e9 / length_m).abs() < 1e-3);
    assert!((first.yield_force_n - 491.0 * 235.0).abs() < 1e-6);
    assert!((second.slack_length_m() - 10.0).abs() < 1e-12);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), format!("{arch}{ties}")).unwrap();
    let said = printed(
        folder.path(),
        &["check", "s.toml", "--set", "tie.1.area_mm2=982"],
    );
    assert!(said.contains("area_mm2 = 982.0"), "{said}");
    refused(
        folder.path(),
        &["check", "s.toml", "--set", "tie.3.area_mm2=982"],
        &["tie"],
    );
    let stack = archrock::mechanics::Column::new(2.0, 0.5)
        .unwrap()
        .row()
        .unwrap();
    assert_eq!(stack.supports, Supports::Left);
}

/// 200 ties over the height of an arch have nearly the capacity of 50 ties four times as stiff at the same heights: the capacity
/// depends on the distance of the ties only by its square.
#[test]
fn many_ties_have_the_capacity_of_fewer_stiffer_ones() {
    let capacity_g = |count: u32| {
        let tie = |index: u32| {
            let height_m = 0.5 + 3.5 * (f64::from(index) + 0.5) / f64::from(count);
            let stiffness_n_m = 2e8 / f64::from(count);
            format!("[[tie]]\nheight_m = {height_m:?}\nstiffness_n_m = {stiffness_n_m:?}\n")
        };
        let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 24\n";
        let ties: String = (0..count).map(tie).collect();
        let row = parsed(&format!("{arch}{ties}")).structure.row().unwrap();
        let follower = Follower::new(&row).unwrap();
        pushes_g(&follower, Sway::Right)[1]
    };
    let [many_g, fewer_g] = [200, 50].map(capacity_g);
    assert!(
        (many_g - fewer_g).abs() < 1e-3 * many_g,
        "{many_g} {fewer_g}"
    );
}

/// Two hundred ties side by side have the capacity of one tie of their total strength. One more tie, or a stiffer one, is refused
/// with the limit.
#[test]
fn the_number_of_ties_is_limited_and_many_equal_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n";
    let ties = |count: usize, force_n: f64| {
        let tie =
            format!("[[tie]]\nheight_m = 3.3\nstiffness_n_m = 1e10\nyield_force_n = {force_n:?}\n");
        tie.repeat(count)
    };
    let push_g = |count: usize, force_n: f64| {
        let answer = limit(&parsed(&format!("{arch}{}", ties(count, force_n)))).unwrap();
        answer.json["ties"]["yielding"]["right"]["incipient_acceleration_g"]
            .as_f64()
            .unwrap_or_else(|| panic!("{}", answer.json))
    };
    let (one_g, many_g) = (push_g(1, 1e4), push_g(200, 50.0));
    assert!(one_g > 0.17, "{one_g}");
    assert!((many_g - one_g).abs() < 1e-8, "{many_g} {one_g}");
    let wrong = |text: &str, words: &str| {
        std::fs::write(folder.join("s.toml"), format!("{arch}{text}")).unwrap();
        refused(folder, &["limit", "s.toml"], &[words]);
    };
    wrong(&ties(201, 50.0), "one of 201 ties; must be at most 200");
    let stiff = ties(1, 50.0);
    wrong(
        &stiff.replace("1e10", "1.1e10"),
        "must be a number from 0.001 to 1e10",
    );
    let section = "area_mm2 = 1e6\nmodulus_gpa = 210.0";
    wrong(
        &stiff.replace("stiffness_n_m = 1e10", section),
        "must be at most 1e10 N/m: give a smaller `area_mm2` or `modulus_gpa`",
    );
}
