//! Live loads and vehicles on arches, compared with published loads, and with the static theorem over the reaction at the left springing.

use std::f64::consts::PI;

use crate::common::program::{printed, refused};
use crate::common::{Random, parsed};
use crate::studies::limit::{Constraint, maximise};
use archrock::Sway;
use archrock::mechanics::masonry::MAX_AXLES;
use archrock::scenario::Scenario;
use archrock::studies::{LimitSummary, LiveAnswer, limit};
use serde_json::Value;

const GRAVITY_M_S2: f64 = 9.81;

fn summary(text: &str) -> LimitSummary {
    let found = limit(&parsed(text)).unwrap();
    serde_json::from_value(found.json).unwrap()
}

fn close(found: f64, due: f64, tolerance: f64) {
    assert!((found / due - 1.0).abs() < tolerance, "{found} {due}");
}

/// The reference problem of the package compas_dem: 30 voussoirs, 3 m deep, of 2400 kg/m3, friction 0.5. Two other programmes agree on these loads
/// within 2e-6.
#[test]
fn an_arch_of_21_metres_bears_the_published_loads() {
    let text = |x_m: f64| {
        format!(
            "[arch]\nspan_m = 21.213\nrise_m = 4.393\nmeasured_at = 'intrados'\nthickness_m = 0.5\nvoussoirs = 30\ndepth_m = 3.0\n\
             density_kg_m3 = 2400.0\n[[load]]\nmass_kg = 1000.0\nx_m = {x_m:?}\nlive = true\n[free_hinges]\nfriction_coefficient = 0.5\n"
        )
    };
    for (x_m, due_n) in [(-0.37, 261_456.0), (-5.3, 206_945.0), (-7.0, 223_807.0)] {
        let live = summary(&text(x_m)).live.unwrap();
        for answer in [Some(live.without_sliding), live.with_friction] {
            let answer = answer.unwrap();
            // The published loads are rounded to 1 N.
            close(answer.weight_n.unwrap(), due_n, 5e-6);
            close(
                answer.multiplier.unwrap() * 1000.0 * GRAVITY_M_S2,
                due_n,
                5e-6,
            );
            assert_eq!(answer.mechanism.len(), 4);
        }
    }
}

/// A circular arch with fill, given by numbers.
struct Bridge {
    mean_radius_m: f64,
    thickness_m: f64,
    embrace_deg: f64,
    voussoirs: usize,
    density_kg_m3: f64,
    depth_m: f64,
    /// Height of the fill above the crown, in metres, and its density.
    fill: Option<[f64; 2]>,
}

impl Bridge {
    fn random(random: &mut Random) -> Self {
        let mean_radius_m = random.within(2.0, 10.0);
        let fill = [
            random.within(0.05, 0.3) * mean_radius_m,
            random.within(1500.0, 2000.0),
        ];
        Self {
            mean_radius_m,
            thickness_m: mean_radius_m * random.within(0.13, 0.2),
            embrace_deg: random.within(90.0, 170.0),
            voussoirs: 9 + random.pick(20),
            density_kg_m3: random.within(1800.0, 2600.0),
            depth_m: random.within(0.5, 3.0),
            fill: (random.pick(2) == 0).then_some(fill),
        }
    }

    fn text(&self) -> String {
        let fill = self.fill.map(|[above_m, density_kg_m3]| {
            format!("[fill]\nabove_crown_m = {above_m:?}\ndensity_kg_m3 = {density_kg_m3:?}\n")
        });
        format!(
            "[arch]\nmean_radius_m = {:?}\nthickness_m = {:?}\nembrace_deg = {:?}\nvoussoirs = {}\ndensity_kg_m3 = {:?}\ndepth_m = {:?}\n{}",
            self.mean_radius_m,
            self.thickness_m,
            self.embrace_deg,
            self.voussoirs,
            self.density_kg_m3,
            self.depth_m,
            fill.unwrap_or_default()
        )
    }

    /// Angles of the joints from the vertical, to the right, in radians.
    fn joints_rad(&self) -> Vec<f64> {
        let half = 0.5 * self.embrace_deg * PI / 180.0;
        let part = |joint: usize| joint as f64 / self.voussoirs as f64;
        (0..=self.voussoirs)
            .map(|joint| half * (2.0 * part(joint) - 1.0))
            .collect()
    }

    fn outer_m(&self) -> f64 {
        self.mean_radius_m + 0.5 * self.thickness_m
    }

    /// Depth of the fill at a distance to the right of the middle, in metres.
    fn fill_m(&self, x_m: f64) -> f64 {
        let outer_m = self.outer_m();
        let height_m = (outer_m * outer_m - x_m * x_m).sqrt();
        self.fill
            .map_or(0.0, |[above_m, _]| outer_m + above_m - height_m)
    }

    /// Weight of a voussoir with its fill in N, and its moment about the middle in N m, by the midpoint rule over thin slices.
    fn dead_n(&self, from_rad: f64, to_rad: f64) -> [f64; 2] {
        const SLICES: u32 = 2000;
        let thin = (to_rad - from_rad) / f64::from(SLICES);
        let (radius_m, thick_m, outer_m) = (self.mean_radius_m, self.thickness_m, self.outer_m());
        // A sector of a ring: its centre is further out than its middle line.
        let centre_m = radius_m + thick_m * thick_m / (12.0 * radius_m);
        let mut sums = [0.0; 2];
        for slice in 0..SLICES {
            let angle = from_rad + thin * (f64::from(slice) + 0.5);
            let ring_n = self.density_kg_m3 * radius_m * thick_m * thin;
            let x_m = outer_m * angle.sin();
            let density_kg_m3 = self.fill.map_or(0.0, |[_, density]| density);
            let fill_n = density_kg_m3 * self.fill_m(x_m) * outer_m * angle.cos() * thin;
            sums[0] += ring_n + fill_n;
            sums[1] += ring_n * centre_m * angle.sin() + fill_n * x_m;
        }
        sums.map(|sum| sum * self.depth_m * GRAVITY_M_S2)
    }

    /// Largest factor on weights in N at distances to the right of the middle, over widths, by the static theorem: the reaction at the left springing
    /// gives the thrust in each joint, which stays between its edges, and inside the friction cone. `None` for any factor.
    fn bears(&self, live: &[[f64; 3]], friction: Option<f64>) -> Option<f64> {
        let joints = self.joints_rad();
        let edge_m = |angle: f64| self.outer_m() * angle.sin();
        let whole_n: f64 = joints
            .windows(2)
            .map(|ends| self.dead_n(ends[0], ends[1])[0])
            .sum();
        let mut constraints: Vec<Constraint> = Vec::new();
        let (mut dead, mut borne) = ([0.0; 2], [0.0; 2]);
        for (index, angle) in joints.iter().enumerate() {
            if index > 0 {
                let before = joints[index - 1];
                let [weight_n, moment] = self.dead_n(before, *angle);
                dead = [dead[0] + weight_n, dead[1] + moment];
                let [from_m, to_m] = [edge_m(before), edge_m(*angle)];
                for [weight_n, x_m, width_m] in live {
                    let [low_m, high_m] = [x_m - 0.5 * width_m, x_m + 0.5 * width_m];
                    let (start_m, end_m) = (low_m.max(from_m), high_m.min(to_m));
                    let (part, at_m) = match *width_m {
                        0.0 => (f64::from(from_m <= *x_m && *x_m < to_m), *x_m),
                        width_m => (
                            (end_m - start_m).max(0.0) / width_m,
                            0.5 * (start_m + end_m),
                        ),
                    };
                    borne = [
                        borne[0] + part * weight_n,
                        borne[1] + part * weight_n * at_m,
                    ];
                }
            }
            // Unknown: reaction (h, v) at the left springing, its moment about the centre of the circle, and the factor; forces over the weight.
            let (sin, cos) = angle.sin_cos();
            let [dead_n, dead_moment, live_n, live_moment] =
                [dead[0], dead[1], borne[0], borne[1]].map(|sum| sum / whole_n);
            // The force on the part after the joint is (h, v - dead - factor live); its axis is (cos, -sin).
            let normal = ([cos, -sin, 0.0, live_n * sin], dead_n * sin);
            let shear = ([sin, cos, 0.0, -live_n * cos], -dead_n * cos);
            let negative = |row: [f64; 4]| row.map(|value| -value);
            constraints.push((negative(normal.0).to_vec(), normal.1));
            for (radius_m, sign) in [
                (self.outer_m(), -1.0),
                (self.outer_m() - self.thickness_m, 1.0),
            ] {
                let (x_m, y_m) = (radius_m * sin, radius_m * cos);
                // Moment about a corner: that about the centre, less corner x force; weights at x turn clockwise.
                let row = [y_m, -x_m, 1.0, -live_moment + x_m * live_n];
                let fixed = -dead_moment + x_m * dead_n;
                constraints.push((row.map(|value| sign * value).to_vec(), -sign * fixed));
            }
            if let Some(friction) = friction {
                for sign in [-1.0, 1.0] {
                    let row = (0..4).map(|at| sign * shear.0[at] - friction * normal.0[at]);
                    constraints.push((row.collect(), friction * normal.1 - sign * shear.1));
                }
            }
        }
        let mut random = Random(7);
        for index in (1..constraints.len()).rev() {
            constraints.swap(index, random.pick(index + 1));
        }
        let found = maximise(&[0.0, 0.0, 0.0, 1.0], &constraints, BOX)?;
        let is_bounded = found.iter().all(|value| value.abs() < 0.99 * BOX);
        is_bounded.then_some(found[3])
    }
}

/// Forces over the weight, and factors, are searched below this bound.
const BOX: f64 = 1e4;

/// Both answers of forty random arches, half of them with fill, under one or two loads at points or over widths, are those of the static theorem over
/// four unknowns. The midpoint rule and the interior-point solver of the program are exact to 1e-6.
#[test]
fn random_arches_bear_the_loads_of_the_static_theorem() {
    let mut random = Random(62);
    let (mut compared, mut slides) = (0, 0);
    while compared < 40 {
        let bridge = Bridge::random(&mut random);
        let end_m = bridge.outer_m() * bridge.joints_rad()[bridge.voussoirs].sin();
        let count = 1 + random.pick(2);
        let live: Vec<[f64; 3]> = (0..count)
            .map(|_| {
                let width_m = if random.pick(2) == 0 {
                    0.0
                } else {
                    random.within(0.1, 0.5) * end_m
                };
                let most_m = end_m - 0.5 * width_m;
                [
                    random.within(1e3, 1e5),
                    random.within(-0.9, 0.9) * most_m,
                    width_m,
                ]
            })
            .collect();
        let friction = random.within(0.25, 0.8);
        let loads = live.iter().map(|[weight_n, x_m, width_m]| {
            let mass_kg = weight_n / GRAVITY_M_S2;
            let width = if *width_m > 0.0 {
                format!("width_m = {width_m:?}\n")
            } else {
                String::new()
            };
            format!("[[load]]\nmass_kg = {mass_kg:?}\nx_m = {x_m:?}\n{width}live = true\n")
        });
        let text = bridge.text()
            + &loads.collect::<String>()
            + &format!("[free_hinges]\nfriction_coefficient = {friction:?}\n");
        // Some random arches fall, or slide, under their own weight.
        let Some(found) = Scenario::parse(&text, "s.toml")
            .ok()
            .and_then(|it| limit(&it).ok())
        else {
            continue;
        };
        let found: LimitSummary = serde_json::from_value(found.json).unwrap();
        let found = found.live.unwrap();
        let answers = [
            (found.without_sliding, None),
            (found.with_friction.unwrap(), Some(friction)),
        ];
        for (answer, friction) in answers {
            match (answer.multiplier, bridge.bears(&live, friction)) {
                (Some(found), Some(due)) => close(found, due, 2e-6),
                (found, due) => assert!(
                    found.is_none_or(|found| found > 0.9 * BOX) && due.is_none(),
                    "{found:?} {due:?}\n{text}"
                ),
            }
            slides += usize::from(
                answer
                    .mechanism
                    .iter()
                    .any(|joint| joint.slips_towards.is_some()),
            );
            thrust_line_is_inside(&bridge, &answer);
        }
        compared += 1;
    }
    assert!(slides >= 5, "{slides}");
}

/// The thrust line at collapse is in all joints, and at an edge of those that open.
fn thrust_line_is_inside(bridge: &Bridge, answer: &LiveAnswer) {
    if answer.multiplier.is_none() {
        return;
    }
    assert_eq!(answer.thrust_line_m.len(), bridge.voussoirs + 1);
    let half_m = 0.5 * bridge.thickness_m;
    let out = |at_m: [f64; 2]| (at_m[0].hypot(at_m[1]) - bridge.mean_radius_m) / half_m;
    for at_m in answer.thrust_line_m.iter().flatten() {
        assert!(out(*at_m).abs() < 1.0 + 1e-9);
    }
    for joint in answer
        .mechanism
        .iter()
        .filter(|joint| joint.opens_intrados != joint.opens_extrados)
    {
        if let Some(at_m) = answer.thrust_line_m[joint.joint] {
            let due = if joint.opens_intrados { 1.0 } else { -1.0 };
            assert!((out(at_m) - due).abs() < 1e-4, "{} {due}", out(at_m));
        }
    }
}

const LORRY: &str = "[vehicle]\naxles_kg = [6000.0, 11500.0]\nspacing_m = [3.6]\n";

/// A vehicle is worst where an own search finds it, with the static theorem at many positions, and on both sides of each joint that an axle passes: the
/// factor jumps there. Each axle spreads over the depth of the fill below it. A symmetric arch has one answer for both ways.
#[test]
fn a_vehicle_is_worst_where_an_own_search_finds_it() {
    let arch = "[arch]\nmean_radius_m = 4.0\nthickness_m = 0.6\nembrace_deg = 140.0\nvoussoirs = 14\ndepth_m = 2.5\n\
                [fill]\nabove_crown_m = 0.5\ndensity_kg_m3 = 1800.0\n[free_hinges]\nfriction_coefficient = 0.34\n";
    let bridge = Bridge {
        mean_radius_m: 4.0,
        thickness_m: 0.6,
        embrace_deg: 140.0,
        voussoirs: 14,
        density_kg_m3: 2000.0,
        depth_m: 2.5,
        fill: Some([0.5, 1800.0]),
    };
    let joints_m: Vec<f64> = bridge
        .joints_rad()
        .iter()
        .map(|angle| bridge.outer_m() * angle.sin())
        .collect();
    let end_m = joints_m[bridge.voussoirs];
    for spread in ["", "spread = '2:1'\n"] {
        let live = summary(&format!("{arch}{LORRY}{spread}")).live.unwrap();
        let own = |x_m: f64, friction: Option<f64>| {
            let axles = [(6000.0, x_m), (11500.0, x_m - 3.6)].map(|(kg, x_m)| {
                // An axle beyond the arch spreads as at its end.
                let width_m = if spread.is_empty() {
                    0.0
                } else {
                    bridge.fill_m(x_m.clamp(-end_m, end_m))
                };
                [kg * GRAVITY_M_S2, x_m, width_m]
            });
            bridge.bears(&axles, friction).unwrap_or(f64::INFINITY)
        };
        for (worst, friction) in [
            (live.without_sliding, None),
            (live.with_friction.unwrap(), Some(0.34)),
        ] {
            let least = worst.multiplier.unwrap();
            let passes = joints_m.iter().flat_map(|x_m| [*x_m, x_m + 3.6]);
            let sides = passes.flat_map(|x_m| [x_m - 1e-7, x_m + 1e-7]);
            let steps = (0..300).map(|step| -end_m + (2.0 * end_m + 3.6) * f64::from(step) / 300.0);
            let found = steps
                .chain(sides)
                .map(|x_m| own(x_m, friction))
                .fold(f64::INFINITY, f64::min);
            // The search is exact for axles at points, whose factor is least where one of them passes a joint; others are found within a step.
            assert!(found > least * (1.0 - 2e-6), "{found} {least}");
            close(found, least, if spread.is_empty() { 2e-6 } else { 1e-3 });
            // The axles of the answer, as the vehicle drives to the right.
            let front_m = worst.axles[0].x_m * worst.towards.unwrap().sign();
            let there = [-1e-8, 1e-8].map(|side| own(front_m + side, friction));
            close(there[0].min(there[1]), least, 2e-6);
        }
        let places = live.positions.iter();
        let way = |side: Sway| places.clone().filter(move |place| place.towards == side);
        for (right, left) in way(Sway::Right).zip(way(Sway::Left)) {
            assert!((right.x_m + left.x_m).abs() < 1e-12);
            match right.multiplier.zip(left.multiplier) {
                Some((right, left)) if right < 100.0 => close(right, left, 1e-6),
                _ => {}
            }
        }
    }
}

/// A load on a joint is on its worse side: the crown of an arch of eight voussoirs, with a dead load that makes it unsymmetric. Slivers of patches and of
/// fill without depth are no obstacle.
#[test]
fn a_load_on_a_joint_is_on_its_worse_side() {
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_m = 1.4\nembrace_deg = 150.0\nvoussoirs = 8\n[[load]]\nmass_kg = 500.0\nx_m = -1.5\n\
                [free_hinges]\nfriction_coefficient = 0.5\n";
    let factor = |x_m: f64| {
        let text = format!("{arch}[[load]]\nmass_kg = 1e4\nx_m = {x_m:?}\nlive = true\n");
        summary(&text)
            .live
            .unwrap()
            .with_friction
            .unwrap()
            .multiplier
            .unwrap()
    };
    let [left, at, right] = [-1e-6, 0.0, 1e-6].map(factor);
    assert!((left / right - 1.0).abs() > 1e-3, "{left} {right}");
    close(at, left.min(right), 1e-5);
    // By another linear programme, just right of the joint.
    let vehicle = "[vehicle]\naxles_kg = [1e4, 1e4]\nspacing_m = [3.6]\n";
    let worst = summary(&format!("{arch}{vehicle}"))
        .live
        .unwrap()
        .with_friction
        .unwrap();
    close(worst.multiplier.unwrap(), 3.08667, 2e-6);
    let flush = "[arch]\nmean_radius_m = 4.0\nthickness_m = 0.8\nembrace_deg = 180.0\nvoussoirs = 24\n[fill]\nabove_crown_m = 0.0\ndensity_kg_m3 = 1800.0\n\
                 [vehicle]\naxles_kg = [1000.0]\nspread = '2:1'\n";
    assert!(
        summary(flush)
            .live
            .unwrap()
            .without_sliding
            .multiplier
            .is_some()
    );
}

/// Live loads change nothing of the structure: its push is that without them, and no other command computes them.
#[test]
fn live_loads_are_no_part_of_the_structure() {
    let arch = "[arch]\nmean_radius_m = 4.0\nthickness_m = 0.7\nembrace_deg = 150.0\nvoussoirs = 15\n[ground.rectangular]\namplitude_g = -0.4\n\
                duration_s = 0.2\n[demand.slv]\nag_g = 0.2\nf0 = 2.4\ntc_star_s = 0.3\n[demand]\nsoil = 'B'\ntopography = 'T1'\n";
    let load = "[[load]]\nmass_kg = 100.0\nx_m = 0.5\n";
    let folder = tempfile::tempdir().unwrap();
    let write = |text: &str| std::fs::write(folder.path().join("s.toml"), text).unwrap();
    for (table, dead) in [
        (format!("{load}{load}live = true\n"), load),
        (LORRY.to_owned(), ""),
    ] {
        let [with, without] = [&*table, dead].map(|loads| summary(&format!("{arch}{loads}")));
        let push = |of: &LimitSummary| of.incipient_acceleration_g.right.unwrap();
        close(push(&with), push(&without), 1e-9);
        assert!(with.live.is_some() && without.live.is_none());
        write(&format!("{arch}{table}"));
        for command in [
            &["run"][..],
            &["threshold"],
            &["capacity"],
            &["verify"],
            &["impact"],
            &["spread"],
        ] {
            let message = refused(folder.path(), &[command, &["s.toml"]].concat(), &[]);
            assert!(
                message.contains("live loads are computed by `limit` alone"),
                "{command:?}: {message}"
            );
        }
    }
    let words = printed(folder.path(), &["limit", "s.toml", "--out", "o"]);
    assert!(
        words.starts_with("without sliding, it collapses under "),
        "{words}"
    );
    for file in [
        "limit.html",
        "limit.svg",
        "vehicle.svg",
        "limit.csv",
        "limit.json",
    ] {
        assert!(folder.path().join("o").join(file).exists(), "{file}");
    }
    let json = std::fs::read_to_string(folder.path().join("o/limit.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    // 201 steps, and two axles on sixteen joints, less the two ends of the way; to either side.
    assert_eq!(
        json["live"]["positions"].as_array().unwrap().len(),
        2 * (201 + 2 * 16 - 2)
    );
}

/// Every wrong table is refused with its key and a remedy.
#[test]
fn wrong_live_loads_and_vehicles_are_refused() {
    let arch =
        "[arch]\nmean_radius_m = 4.0\nthickness_m = 0.7\nembrace_deg = 150.0\nvoussoirs = 15\n";
    let column = "[column]\nheight_m = 4.0\nwidth_m = 1.0\n";
    for (text, due) in [
        (
            format!("{arch}[[load]]\nx_m = 0.0\nthrust_n = 5.0\nlive = true\n"),
            "`thrust_n = 5.0` has no effect on a live load",
        ),
        (
            format!("{arch}[[load]]\nx_m = 0.0\nlive = true\n"),
            "mass_kg",
        ),
        (
            format!("{arch}[[load]]\nmass_kg = 10.0\nlive = true\n"),
            "a load on the extrados has a position",
        ),
        (
            format!("{arch}[[load]]\nmass_kg = 10.0\nx_m = 9.0\nlive = true\n"),
            "so that it stands on the extrados",
        ),
        (
            format!("{column}[[load]]\nmass_kg = 10.0\nlive = true\n"),
            "applies to arches",
        ),
        (format!("{column}{LORRY}"), "applies to an arch"),
        (format!("{arch}{LORRY}spread = '2:1'\n"), "give [fill]"),
        (
            format!("{arch}[vehicle]\naxles_kg = [1e3, 2e3]\n"),
            "has 2 axles and 0 distances between them",
        ),
        (format!("{arch}[vehicle]\naxles_kg = []\n"), "axles_kg"),
        (format!("{arch}[vehicle]\naxles_kg = [-1.0]\n"), "axles_kg"),
        (
            format!("{arch}{LORRY}[[load]]\nmass_kg = 10.0\nx_m = 0.0\nlive = true\n"),
            "cannot be combined with a live load",
        ),
        (
            format!("{}{LORRY}", arch.replace("voussoirs = 15\n", "")),
            "lacks `voussoirs`",
        ),
    ] {
        let message = Scenario::parse(&text, "s.toml").unwrap_err().to_string();
        assert!(message.contains(due), "{due}: {message}");
    }
    // The keys name the largest number of axles.
    let keys = Scenario::schema()["properties"]["vehicle"].to_string();
    assert!(keys.contains(&format!("at most {MAX_AXLES}")), "{keys}");
    let moved = format!("{arch}{LORRY}[free_hinges]\n[supports.left]\nspread_m = 0.01\n");
    let message = limit(&parsed(&moved)).unwrap_err().to_string();
    assert!(message.contains("leave [supports] out"), "{message}");
}
