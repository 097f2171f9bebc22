//! The worked numbers of docs/theory.md, computed by the formulas of the page alone, and compared with what the program prints.

use std::fmt::Write as _;
use std::fs;
use std::os::unix::fs::symlink;

use crate::common::documents::{assert_generated, repository};
use crate::common::program::{printed, scenarios};
use crate::common::prose::{is_shown, skeleton};

const GRAVITY: f64 = 9.81;
const INTRADOS: f64 = 4.625;
const EXTRADOS: f64 = 5.375;

type Point = [f64; 2];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// A point of the ring, at an angle in degrees from the left springing.
fn point(angle_deg: f64, radius_m: f64) -> Point {
    let (sine, cosine) = angle_deg.to_radians().sin_cos();
    [-radius_m * cosine, radius_m * sine]
}

/// Mass, centre of gravity and moment of inertia of a part of the ring: equation (2a).
fn part([from_deg, to_deg]: [f64; 2]) -> (f64, Point, f64) {
    let (from, to) = (from_deg.to_radians(), to_deg.to_radians());
    let power = |exponent| EXTRADOS.powi(exponent) - INTRADOS.powi(exponent);
    let mass = (to - from) * power(2) / 2.0;
    let first = power(3) / 3.0 / mass;
    let centre = [
        first * (from.sin() - to.sin()),
        first * (from.cos() - to.cos()),
    ];
    let inertia = (to - from) * power(4) / 4.0 - mass * dot(centre, centre);
    (mass, centre, inertia)
}

/// Four hinges with their angles, points and rates: a mechanism.
struct Mechanism {
    angles_deg: [f64; 4],
    points: [Point; 4],
    rates: [f64; 4],
}

impl Mechanism {
    /// Hinges on edges of these radii, with the rates that solve (3) for `rates[index] = rate`.
    fn new(angles_deg: [f64; 4], radii: [f64; 4], index: usize, rate: f64) -> Self {
        let points: [Point; 4] = std::array::from_fn(|i| point(angles_deg[i], radii[i]));
        let area = |skipped: usize| {
            let others: Vec<Point> = (0..4)
                .filter(|i| *i != skipped)
                .map(|i| points[i])
                .collect();
            let (a, b) = (minus(others[1], others[0]), minus(others[2], others[0]));
            (a[0] * b[1] - a[1] * b[0]) * [1.0, -1.0][skipped % 2]
        };
        let areas: [f64; 4] = std::array::from_fn(area);
        let rates = areas.map(|area| area / areas[index] * rate);
        Self {
            angles_deg,
            points,
            rates,
        }
    }

    /// Rotation rate at a section, and the velocity of a point there: equation (4).
    fn velocity(&self, section_deg: f64, at: Point) -> (f64, Point) {
        let mut sum = (0.0, [0.0, 0.0]);
        for i in (0..4).filter(|i| self.angles_deg[*i] < section_deg) {
            let arm = minus(at, self.points[i]);
            sum.0 += self.rates[i];
            sum.1 = [
                sum.1[0] - self.rates[i] * arm[1],
                sum.1[1] + self.rates[i] * arm[0],
            ];
        }
        sum
    }
}

/// The product (2) of two fields on a part.
fn product(u: &Mechanism, w: &Mechanism, ends_deg: [f64; 2]) -> f64 {
    let (mass, centre, inertia) = part(ends_deg);
    let middle_deg = (ends_deg[0] + ends_deg[1]) / 2.0;
    let ((turn, v), (other_turn, other)) = (
        u.velocity(middle_deg, centre),
        w.velocity(middle_deg, centre),
    );
    mass * dot(v, other) + inertia * turn * other_turn
}

/// Heights of the centres of the three bodies when the left one has turned by `q` clockwise.
fn heights(hinges: &Mechanism, q: f64) -> [f64; 3] {
    let turned = |about: Point, at: Point, angle: f64| {
        let ([x, y], (sine, cosine)) = (minus(at, about), angle.sin_cos());
        [
            about[0] + cosine * x - sine * y,
            about[1] + sine * x + cosine * y,
        ]
    };
    let length = |a: Point, b: Point| dot(minus(a, b), minus(a, b)).sqrt();
    let direction = |from: Point, to: Point| {
        let [x, y] = minus(to, from);
        y.atan2(x)
    };
    let [a, b, c, d] = hinges.points;
    let b_now = turned(a, b, -q);
    let (bc, cd, bd) = (length(b, c), length(c, d), length(b_now, d));
    let inner = ((bc * bc + bd * bd - cd * cd) / (2.0 * bc * bd)).acos();
    let c_now = turned(
        b_now,
        [b_now[0] + bc, b_now[1]],
        direction(b_now, d) + inner,
    );
    let parts: [Point; 3] =
        std::array::from_fn(|i| part([hinges.angles_deg[i], hinges.angles_deg[i + 1]]).1);
    let turn = direction(b_now, c_now) - direction(b, c);
    let moved = [b_now[0] - b[0], b_now[1] - b[1]];
    let middle = [parts[1][0] + moved[0], parts[1][1] + moved[1]];
    [
        turned(a, parts[0], -q)[1],
        turned(b_now, middle, turn)[1],
        turned(d, parts[2], direction(d, c_now) - direction(d, c))[1],
    ]
}

/// Every number in the examples of the page.
fn numbers_of_the_examples() -> Vec<f64> {
    let (low, high) = (INTRADOS, EXTRADOS);
    let first = [24.013_526_446, 81.787_414_042, 139.561_301_636, 180.0];
    let opening = Mechanism::new(first, [low, high, low, high], 0, -1.0);
    let bodies =
        |hinges: &Mechanism| [1, 2, 3].map(|i| hinges.angles_deg[i - 1..=i].try_into().unwrap());
    let (mut sums, mut own, mut values) = ([0.0, 0.0], 0.0, Vec::new());
    for ends in bodies(&opening) {
        let (mass, centre, inertia) = part(ends);
        let (turn, velocity) = opening.velocity((ends[0] + ends[1]) / 2.0, centre);
        sums = [sums[0] + mass * velocity[0], sums[1] + mass * velocity[1]];
        own += product(&opening, &opening, ends);
        values.extend([mass, centre[0], centre[1], inertia, turn]);
    }
    values.extend(opening.points.into_iter().flatten());
    values.extend(opening.rates);
    values.extend([sums[0], sums[1], sums[1] / sums[0], own]);
    values.push(GRAVITY * (0.28 * sums[0] - sums[1]) / own);
    let critical = 0.031_047_597;
    let [resting, raised] = [0.0, critical].map(|q| heights(&opening, q));
    let weight = |i: usize| part(bodies(&opening)[i]).0 * (raised[i] - resting[i]);
    let barrier: f64 = 2000.0 * GRAVITY * (0..3).map(weight).sum::<f64>();
    values.extend([critical, barrier]);

    let mirrored = [3, 2, 1, 0].map(|i| 180.0 - first[i]);
    let closing = Mechanism::new(mirrored, [high, low, high, low], 3, 1.0);
    let next = [0.0, 46.183_798_567, 103.623_891_304, 180.0];
    let next = Mechanism::new(next, [low, high, low, high], 0, -1.0);
    let mut cuts: Vec<f64> = (mirrored.into_iter().chain(next.angles_deg)).collect();
    cuts.sort_by(f64::total_cmp);
    let mut all = [0.0; 3];
    let mut table = "| φ_1 to φ_2 (degrees) | m | ω(u) | ω(w) | <u, u> | <u, w> | <w, w> |\n|---|---|---|---|---|---|---|\n".to_owned();
    for ends in cuts.windows(2).filter(|ends| ends[1] - ends[0] > 1e-6) {
        let ends = [ends[0], ends[1]];
        let pairs = [(&next, &next), (&next, &closing), (&closing, &closing)];
        let products = pairs.map(|(u, w)| product(u, w, ends));
        let middle_deg = (ends[0] + ends[1]) / 2.0;
        let turns = [&next, &closing].map(|one| one.velocity(middle_deg, [0.0, 0.0]).0);
        all = [0, 1, 2].map(|i| all[i] + products[i]);
        values.extend(ends.into_iter().chain(products).chain(turns));
        values.push(part(ends).0);
        // No sign of zero.
        let products = products.map(|product| (1e4 * product).round() / 1e4 + 0.0);
        let ([from, to], [uu, uw, ww], [u, w]) = (ends, products, turns);
        writeln!(
            table,
            "| {from:.5} to {to:.5} | {:.5} | {u:.5} | {w:.5} | {uu:.4} | {uw:.4} | {ww:.4} |",
            part(ends).0
        )
        .unwrap();
    }
    let [uu, uw, ww] = all;
    writeln!(table, "| sum | | | | {uu:.4} | {uw:.4} | {ww:.4} |").unwrap();
    assert_generated("docs/theory.md", "tests/program/worked.rs", &table);
    values.extend(next.rates);
    values.extend(all);
    values.extend([all[1] / all[0], all[1] * all[1] / (all[0] * all[2])]);

    let half_diagonal = f64::hypot(2.0, 0.4);
    let turn = 1.0 - 1.5 / 26.0;
    values.extend([
        0.2_f64.atan(),
        half_diagonal,
        (3.0 * GRAVITY / (4.0 * half_diagonal)).sqrt(),
    ]);
    values.extend([turn, turn * turn, 100.0 * (1.0 - turn * turn)]);
    let slope = (0.6_f64 / 8.0).atan();
    let [base, top] = [slope.sin(), slope.cos()].map(|part| 1.0 - 1.5 * part * part);
    values.extend([base, top, base * base * top]);

    // Until the pulse ends, the velocity is the integral of the sine minus friction; then friction alone stops the block.
    let (push, friction, end_s) = (0.9 * GRAVITY, 0.2 * GRAVITY, 0.5);
    let from_s = end_s / std::f64::consts::PI * (friction / push).asin();
    let frequency = std::f64::consts::PI / end_s;
    let cosine = (frequency * from_s).cos();
    let lasts_s = end_s - from_s;
    let speed = push / frequency * (cosine + 1.0) - friction * lasts_s;
    let slip = push / frequency * (cosine * lasts_s + (frequency * from_s).sin() / frequency)
        - friction * lasts_s * lasts_s / 2.0
        + speed * speed / (2.0 * friction);
    values.extend([from_s, end_s + speed / friction, slip]);

    let weight: f64 = 5.0 * 2700.0 * GRAVITY;
    let contact = (2.0 * weight / (0.01 * 10e9)).sqrt();
    values.extend([0.0475, 1.0 / 0.0475, weight, contact, contact / 3.0]);
    let length = 2.0 * (INTRADOS * INTRADOS - 1.5 * 1.5_f64).sqrt();
    let (stiffness, force) = (210e9 * 150e-6 / length, 235e6 * 150e-6);
    values.extend([
        length,
        stiffness / 1e6,
        force / 1e3,
        1e3 * force / stiffness,
    ]);
    values.push((0.25_f64 / 0.5316).ln() / 0.6067);
    // The normal distribution function there, from a table.
    values.push(0.106_84);
    values
}

#[test]
fn the_worked_numbers_of_the_theory_are_right() {
    let folder = tempfile::tempdir().unwrap();
    symlink(scenarios(), folder.path().join("scenarios")).unwrap();
    let arch = "scenarios/semicircle-pulse.toml";
    let said = [
        printed(folder.path(), &["limit", arch]),
        printed(folder.path(), &["impact", arch, "--count", "1"]),
        printed(folder.path(), &["impact", arch, "--certificate"]),
        printed(folder.path(), &["impact", "scenarios/column-map.toml"]),
    ]
    .join("\n");
    let of_the_program = skeleton(&said).1;
    let of_the_program = of_the_program
        .iter()
        .filter_map(|number| number.parse().ok());
    let mut values: Vec<f64> = of_the_program.collect();
    // The growth of a deviation follows from the frequency parameter and the slenderness of the equivalent block.
    let [p, slenderness] = [2.849_742, 0.143_337];
    assert!(values.contains(&p) && values.contains(&slenderness));
    values.push(p * p * slenderness.cos());
    let computed = numbers_of_the_examples();
    for shown in [0.144_326_44, 0.681_186, 0.887_944, 0.031_048] {
        let agrees = |value: &f64| (value - shown).abs() < 1e-6;
        assert!(
            values
                .iter()
                .any(|value| (value.abs() - shown).abs() < 1e-6),
            "{shown}"
        );
        assert!(computed.iter().any(agrees), "{shown}");
    }
    values.extend(computed);
    // Two pairs of peaks, of which the first agrees: equation (49).
    let agree = |[y, z]: [f64; 2]| (y - z).abs() <= 0.01 * y.max(z);
    let (near, far) = ([0.0360, 0.0363], [0.0360, 0.0364]);
    assert!(agree(near) && !agree(far));
    values.extend(near.into_iter().chain(far));
    // Numbers that an example gives.
    values.extend([
        0.28, 9.81, 2000.0, 150.0, 1.5, 0.01, 0.75, 10.0, 2700.0, 0.25, 0.3, 0.5316, 0.6067, 26.0,
        20.0, INTRADOS, EXTRADOS,
    ]);
    let page = fs::read_to_string(repository().join("docs/theory.md")).unwrap();
    let mut checked = 0;
    for after in page.split("**In numbers").skip(2) {
        let mut paragraphs = after.split("\n\n");
        let mut example = paragraphs.next().unwrap().to_owned();
        // A table may follow, and the rest of the example.
        if paragraphs
            .next()
            .is_some_and(|table| table.starts_with("<!--"))
        {
            example += paragraphs.nth(1).unwrap();
        }
        let example: String = example.split('`').step_by(2).collect();
        let equations = ["(2)", "(3)", "(14)", "(22)", "(26)"];
        let without = |text: String, equation: &&str| text.replace(equation, "");
        let example = equations.iter().fold(example, without);
        let example = example
            .replace(", ", " , ")
            .replace("² ×", " ×")
            .replace("²/", " /");
        for number in skeleton(&example).1 {
            let digits = number.trim_start_matches(['-', '0', '.']).len();
            let size = number.trim_start_matches('-');
            assert!(
                digits < 2 || values.iter().any(|value| is_shown(size, value.abs())),
                "{number} in {example}"
            );
            checked += 1;
        }
    }
    assert!(checked > 120, "{checked}");
}
