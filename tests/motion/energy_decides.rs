//! Verdicts by energy: on quiet ground a structure whose energy is below the barriers of all mechanisms that may follow cannot overturn.

use archrock::mechanics::four_link::HingeSites;
use archrock::mechanics::{
    BackWall, Column, FourLinks, ImpactLaw, ImpactModel, MechanismChain, PlacedLoad, RockingColumn,
    Sway,
};
use archrock::{GroundMotion, Initial, Model, Outcome, Pulse, Request, SimulationError, Summary};

use crate::common::program::{archrock, printed, scenarios, stderr, stdout};
use crate::common::results::json;
use crate::common::{Random, arch, pulse, random_masonry, request};

/// Counts of histories that were cut short soon after the ground motion.
#[derive(Debug, Default)]
struct Counts {
    /// Proved to survive by energy.
    proved: usize,
    /// Those whose energy exceeds nine tenths of the least barrier.
    close: usize,
    /// Without verdict, and those of them that overturn later.
    open: usize,
    overturns_later: usize,
    sides: [usize; 2],
}

impl Counts {
    /// Computes a history that ends soon after its ground motion, and the same history for 1000 s. If the short one survives, so does the long one.
    fn add(&mut self, model: &dyn Model, ground: &GroundMotion, after_s: f64) {
        let end_s = ground.end_s() + after_s;
        let history = |end_s: f64| -> Result<Summary, SimulationError> {
            model.simulate(ground, &request(end_s), None)
        };
        let short = history(end_s).unwrap();
        let ratio = short.remaining_over_barrier();
        if ratio.is_none() && short.outcome != Outcome::Incomplete {
            return;
        }
        let long = history(ground.end_s() + 1000.0).unwrap();
        let overturns = matches!(long.outcome, Outcome::Overturned(_));
        match (short.outcome, ratio) {
            (Outcome::StillRocking, Some(ratio)) => {
                assert!(!overturns, "{ratio} {model:?}");
                assert!(ratio < 1.0);
                self.proved += 1;
                self.close += usize::from(ratio > 0.9);
            }
            (Outcome::Incomplete, None) => {
                self.open += 1;
                self.overturns_later += usize::from(overturns);
                if let Outcome::Overturned(sway) = long.outcome {
                    self.sides[usize::from(sway == Sway::Left)] += 1;
                }
            }
            other => panic!("{other:?} {model:?}"),
        }
    }
}

fn random_pulse(random: &mut Random, onset_g: f64) -> GroundMotion {
    let kind = Pulse::ALL[random.pick(Pulse::ALL.len())];
    let amplitude_g = onset_g * random.within(1.1, 12.0) * [-1.0, 1.0][random.pick(2)];
    pulse(kind, amplitude_g, random.within(0.1, 1.5))
}

/// Blocks without and with a load on one side, with and without a wall behind them, with the theoretical and with given restitution.
#[test]
fn blocks_below_their_barrier_never_overturn() {
    let mut random = Random(5);
    let mut counts = [Counts::default(), Counts::default(), Counts::default()];
    for case in 0..900 {
        let height_m = random.within(0.5, 9.0);
        let column = Column::new(height_m, height_m * random.within(0.05, 0.5)).unwrap();
        let kind = case % 3;
        let column = match kind {
            0 => column,
            1 => {
                let load = PlacedLoad {
                    mass_kg: 300.0 * column.width_m * height_m,
                    x_m: random.within(-0.3, 0.3) * column.width_m,
                    ..PlacedLoad::default()
                };
                column.with_loads(vec![load], 9.81).unwrap()
            }
            _ => {
                let back = BackWall {
                    side: [Sway::Left, Sway::Right][random.pick(2)],
                    height_m: None,
                    rate_ratio: Some(random.within(0.2, 1.0)),
                };
                column.with_back(back).unwrap()
            }
        };
        let law: ImpactLaw = match random.chance(0.3) && kind < 2 {
            true => ImpactModel::Prescribed { restitution: 1.0 }.into(),
            false => ImpactModel::MaxRestitution.into(),
        };
        let block = RockingColumn::new(&column, law).unwrap();
        let onset_g = column.width_m / height_m;
        let ground = random_pulse(&mut random, onset_g);
        let after_s = random.within(0.01, 1.0);
        counts[kind].add(&block, &ground, after_s);
    }
    for counts in &counts {
        assert!(counts.proved >= 20 && counts.close >= 2, "{counts:?}");
        assert!(counts.overturns_later >= 3, "{counts:?}");
    }
    // Without a wall, both sides occur.
    assert!(counts[0].sides.iter().all(|side| *side > 0), "{counts:?}");
}

/// Arches of voussoirs and of continuous rings, and arches of other shapes, whose mechanisms differ to the two sides.
#[test]
fn four_links_below_all_barriers_never_overturn() {
    let mut random = Random(8);
    let mut counts = [Counts::default(), Counts::default()];
    for _ in 0..70 {
        let sites = match random.chance(0.2) {
            true => HingeSites::Anywhere,
            false => HingeSites::Voussoirs(5 + random.pick(10)),
        };
        let arch = arch(
            random.within(1.0, 10.0),
            random.within(0.12, 0.2),
            random.within(120.0, 180.0),
            sites,
        );
        let Ok(model) = FourLinks::of_arch(&arch, ImpactModel::MaxRestitution) else {
            continue;
        };
        for _ in 0..6 {
            let ground = random_pulse(&mut random, model.incipient_g());
            counts[0].add(&model, &ground, random.within(0.005, 0.3));
        }
    }
    for _ in 0..120 {
        let Some(masonry) = random_masonry(&mut random) else {
            continue;
        };
        let Ok(model) = FourLinks::of_row(&masonry.row, ImpactModel::MaxRestitution) else {
            continue;
        };
        for _ in 0..6 {
            let ground = random_pulse(&mut random, model.incipient_g());
            counts[1].add(&model, &ground, random.within(0.005, 0.3));
        }
    }
    for counts in &counts {
        assert!(counts.proved >= 20, "{counts:?}");
        assert!(counts.overturns_later >= 1, "{counts:?}");
    }
}

/// A block that starts from rest with a rate has the kinetic energy `2/3 m R^2 w^2`, and its barrier is `m g R (1 - cos(alpha))`. Just below the rate at
/// which they are equal, a history of a hundredth of a second has a verdict; just above it has none.
#[test]
fn the_rate_of_the_barrier_is_that_of_closed_form() {
    let alpha = 0.2_f64;
    let radius_m = 3.0;
    let column = Column::new(2.0 * radius_m * alpha.cos(), 2.0 * radius_m * alpha.sin()).unwrap();
    let rate_rad_s = (1.5 * 9.81 / radius_m * (1.0 - alpha.cos())).sqrt();
    let summary = |column: &Column, factor: f64, sway| {
        let request = Request {
            initial: Some(Initial {
                sway,
                rotation_rad: 0.0,
                rate_rad_s: factor * rate_rad_s,
            }),
            gravity_m_s2: 9.81,
            ..request(0.01)
        };
        let block = RockingColumn::new(column, ImpactModel::MaxRestitution).unwrap();
        block
            .simulate(&GroundMotion::still(), &request, None)
            .unwrap()
    };
    for sway in [Sway::Right, Sway::Left] {
        for factor in [0.6, 0.9, 1.0 - 1e-6] {
            let below = summary(&column, factor, sway);
            assert_eq!(below.outcome, Outcome::StillRocking);
            // The error of the energy balance counts as energy.
            assert!((below.remaining_over_barrier().unwrap() - factor * factor).abs() < 1e-8);
        }
        let above = summary(&column, 1.0 + 1e-6, sway);
        assert_eq!(
            (above.outcome, above.remaining_over_barrier()),
            (Outcome::Incomplete, None)
        );
    }
    // Over a wall of its own height it cannot turn, over a lower one it may.
    let behind = |height_m| BackWall {
        side: Sway::Left,
        height_m,
        rate_ratio: Some(0.5),
    };
    let low = 0.8 * column.height_m;
    for (height_m, outcome) in [
        (None, Outcome::StillRocking),
        (Some(column.height_m), Outcome::StillRocking),
        (Some(low), Outcome::Incomplete),
    ] {
        let before_wall = column.clone().with_back(behind(height_m)).unwrap();
        assert_eq!(summary(&before_wall, 0.9, Sway::Right).outcome, outcome);
    }
}

/// While the ground moves, vertically as well, energy decides nothing.
#[test]
fn energy_does_not_decide_while_the_ground_moves() {
    let column = Column::new(4.0, 0.8).unwrap();
    let block = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
    let horizontal = [(0.0, 0.0), (0.1, 3.0), (0.3, 3.0), (0.4, 0.0)];
    let vertical = [(0.0, 0.0), (0.2, 0.5), (2.0, 0.5), (2.1, 0.0)];
    let ground = |vertical: &[(f64, f64)]| GroundMotion::record(&horizontal, vertical, 0.0);
    for (vertical, outcome) in [
        (&[][..], Outcome::StillRocking),
        (&vertical[..], Outcome::Incomplete),
    ] {
        let ground = ground(vertical).unwrap();
        let summary = block.simulate(&ground, &request(0.6), None).unwrap();
        assert_eq!(summary.outcome, outcome);
    }
}

/// The least barrier of a sequence is that of all its mechanisms, one by one.
#[test]
fn the_least_barrier_is_that_of_all_mechanisms() {
    for (thickness_ratio, embrace_deg, sites) in [
        (0.15, 157.5, HingeSites::Voussoirs(7)),
        (0.13, 180.0, HingeSites::Voussoirs(12)),
        (0.15, 180.0, HingeSites::Anywhere),
    ] {
        let arch = arch(5.0, thickness_ratio, embrace_deg, sites);
        let model = FourLinks::of_arch(&arch, ImpactModel::MaxRestitution).unwrap();
        for impacts in [0, 1, 5, 40] {
            let links = (impacts..300).map_while(|index| model.link_from(Sway::Right, index));
            let mut restitutions = Vec::new();
            let barriers = links.map(|link| {
                restitutions.push(link.restitution);
                link.barrier
            });
            let due = barriers.fold(f64::INFINITY, f64::min);
            assert_eq!(model.least_barrier_from(Sway::Right, impacts), Some(due));
            assert!(restitutions.iter().all(|ratio| *ratio <= 1.0));
        }
    }
}

/// A façade-like block of slenderness 20 under a record. It still rocks at the end of the run, and words and JSON say why it survives, also with a given
/// duration. The threshold is the one that complete histories of 1000 s give.
#[test]
fn a_slender_block_has_a_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let record = scenarios().join("records/slv-1.at2");
    let text = format!(
        "[column]\nheight_m = 8.0\nwidth_m = 0.4\n[ground.record]\nfile = {:?}\n",
        record.to_str().unwrap()
    );
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let longer = |duration_s| format!("simulation.duration_s={duration_s}");
    for (name, options) in [
        ("default", vec![]),
        ("given", vec!["--set".to_owned(), longer(40.0)]),
    ] {
        let mut arguments = vec!["run", "s.toml", "--out", name, "--no-report"];
        arguments.extend(options.iter().map(String::as_str));
        let said = printed(folder.path(), &arguments);
        let summary = json(&folder.path().join(name).join("summary.json"));
        assert_eq!(
            (&summary["outcome"], &summary["verdict"]),
            (&"still_rocking".into(), &"survives".into())
        );
        let part = summary["remaining_energy_over_barrier"].as_f64().unwrap();
        assert!((0.25..1.0).contains(&part), "{part}");
        let words = format!(
            "it cannot overturn any more: its energy is {:.1} % of the barrier",
            100.0 * part
        );
        assert!(said.contains(&words), "{said}");
    }
    let factor = |name: &str, options: &[&str]| {
        let arguments = [
            "threshold",
            "s.toml",
            "--from",
            "0.1",
            "--to",
            "1.5",
            "--out",
            name,
        ];
        let output = archrock(folder.path(), &[&arguments[..], options].concat());
        let said = stdout(&output) + &stderr(&output);
        let quoted = said.lines().find(|line| line.contains(", with ")).unwrap();
        let factor = quoted
            .split("up to ")
            .nth(1)
            .unwrap()
            .split(' ')
            .next()
            .unwrap();
        factor.parse::<f64>().unwrap()
    };
    let complete = factor("complete", &["--set", &longer(1000.0)]);
    let default = factor("default-threshold", &[]);
    assert!((complete - default).abs() < 1e-3, "{complete} {default}");
    assert!((default - 0.606).abs() < 2e-3, "{default}");
}
