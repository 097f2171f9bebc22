//! The printed check: redone from the numbers on the page alone, with the formulas of the Circolare 7/2019 and NTC 2018 written here; in
//! English and in Italian, on paper and on a telephone.

use std::f64::consts::PI;
use std::path::Path;

use crate::common::browser;
use crate::common::parsed;
use crate::common::program::{printed as print_of, scenarios};
use crate::common::prose::golden;
use crate::common::{ARCH, COLUMN};
use archrock::Scenario;
use archrock::studies::verify::{VerifyPage, verify, words};
use nalgebra::Vector2;
use serde_json::Value;

const DEMAND: &str = "[demand]\nsoil = 'B'\ntopography = 'T1'\n\
    [demand.sld]\nag_g = 0.10\nf0 = 2.40\ntc_star_s = 0.28\n\
    [demand.slv]\nag_g = 0.25\nf0 = 2.40\ntc_star_s = 0.35\n\
    [demand.slc]\nag_g = 0.32\nf0 = 2.45\ntc_star_s = 0.36\n";
const HEIGHT: &str = "[demand.height]\nmodes = [\
    { gamma = 1.2857, psi = 0.75, sld = { t_s = 0.30, damping_percent = 5 }, slv = { t_s = 0.45, damping_percent = 10 }, \
      slc = { t_s = 0.60, damping_percent = 15 } },\
    { gamma = 0.4, psi = -0.5, sld = { t_s = 0.10, damping_percent = 5 }, slv = { t_s = 0.12, damping_percent = 8 }, \
      slc = { t_s = 0.15, damping_percent = 9 } }]\n";
const TIED: &str = "[column]\nheight_m = 4\nwidth_m = 0.8\n[[tie]]\nfrom_m = [0.0, 3.5]\nto_m = [-4.0, 3.5]\n\
    stiffness_n_m = 1e6\nprestress_n = 5000\nto_block = 0\n";
const LOADED: &str = "[column]\nheight_m = 8\nwidth_m = 0.8\n[[load]]\nmass_kg = 1500\nx_m = -0.1\n\
    [[load]]\nmass_kg = 2000\nx_m = -0.15\nheight_m = 5\nmoves = false\nthrust_n = 800\n";
/// It starts to move only beyond its capacity of displacement.
const STOUT: &str = "[column]\nheight_m = 0.3\nwidth_m = 0.12\n";
/// Its joints slide first.
const SLIPS: &str = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.2\nembrace_deg = 180\nvoussoirs = 20\n\
    [free_hinges]\nfriction_coefficient = 0.42\n";
const DRUMS: &str =
    "[column]\nheight_m = 4\nwidth_m = 0.8\ntop_width_m = 0.6\ndrums = 5\n[free_hinges]\n";
const FREE: &str =
    "[verify.free_standing]\nkappa = 6.2\nlength_m = 4\nthickness_m = 0.8\nmodulus_gpa = 1.5\n";

fn on_piers() -> String {
    std::fs::read_to_string(scenarios().join("pointed-arch-on-piers.toml")).unwrap()
}

/// The piers have another density than the arch.
fn on_light_piers() -> String {
    on_piers().replace("blocks = 2\n", "blocks = 2\ndensity_kg_m3 = 1700\n")
}

/// Three blocks from a file in this folder, each with a density of its own, one on top of the other.
fn given_blocks(folder: &Path) -> String {
    let joints: String = (0..4).map(|y| format!("0.4,{y},-0.4,{y}\n")).collect();
    let file = folder.join("joints.csv");
    std::fs::write(&file, joints).unwrap();
    format!(
        "[blocks]\njoints = '{}'\nsupports = 'left'\ndensity_kg_m3 = [2400, 2000, 1800]\n[free_hinges]\n",
        file.display()
    )
}

/// Spectra by points in a file in this folder. The largest displacement is between two points.
fn by_points(folder: &Path) -> String {
    let file = folder.join("points.csv");
    let points = "period_s,acceleration_g\n0,0.29\n0.15,0.7\n0.5,0.7\n1,0.35\n2,0.06\n4,0.03\n";
    std::fs::write(&file, points).unwrap();
    let spectrum = format!("spectrum = '{}'\n", file.display());
    format!("[demand.sld]\n{spectrum}[demand.slv]\n{spectrum}")
}

fn html_of(scenario: &Scenario) -> String {
    let check = verify(scenario).unwrap_or_else(|error| panic!("{error}"));
    VerifyPage::new(scenario, &check, Some("2025-01-31".to_owned())).html()
}

/// The text of a part of a page.
fn text_of(html: &str) -> String {
    let mut text = String::new();
    for piece in html.split('<') {
        text += piece.split_once('>').map_or(piece, |(_, after)| after);
    }
    let entities = [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&amp;", "&"),
    ];
    entities
        .iter()
        .fold(text, |text, (entity, sign)| text.replace(entity, sign))
}

/// A printed number, with half of its last digit.
#[derive(Clone, Copy, Debug)]
struct Shown {
    value: f64,
    half_unit: f64,
}

impl Shown {
    /// Reads the first number of a text.
    fn first_of(text: &str) -> Self {
        let is_digit = |c: char| c.is_ascii_digit();
        let begin = text
            .find(is_digit)
            .unwrap_or_else(|| panic!("no number in {text:?}"));
        let digits = &text[begin..];
        let end = digits.find(|c: char| !c.is_ascii_digit() && c != '.');
        let digits = digits[..end.unwrap_or(digits.len())].trim_end_matches('.');
        let value: f64 = digits.parse().unwrap();
        let decimals = digits.split_once('.').map_or(0, |(_, after)| after.len());
        let is_negative = text[..begin].ends_with('-') || text[..begin].ends_with('\u{2212}');
        Self {
            value: if is_negative { -value } else { value },
            half_unit: 0.5 * 0.1_f64.powi(i32::try_from(decimals).unwrap()),
        }
    }

    /// Asserts that a number, computed by hand from other rounded numbers, is this one, to its last digit.
    #[track_caller]
    fn is(self, computed: f64) {
        let off = (computed - self.value).abs();
        assert!(off <= 2.0 * self.half_unit * 1.0001, "{computed} {self:?}");
    }
}

/// Returns the first number after a mark.
#[track_caller]
fn after(text: &str, mark: &str) -> Shown {
    let (_, rest) = text
        .split_once(mark)
        .unwrap_or_else(|| panic!("no {mark:?} in {text}"));
    Shown::first_of(rest)
}

/// Returns the rows of the tables of a class, as texts of their cells.
fn tables(html: &str, class: &str) -> Vec<Vec<Vec<String>>> {
    let begin = format!("<table class=\"{class}\">");
    let tables = html.split(&begin).skip(1);
    let rows = |table: &str| {
        let table = table.split_once("</table>").unwrap().0;
        let rows = table.split("<tr").skip(1).map(|row| {
            let cells = row.replace("<th", "<td");
            let cells = cells.split("<td").skip(1);
            cells.map(|cell| text_of(&format!("<td{cell}"))).collect()
        });
        rows.collect()
    };
    tables.map(rows).collect()
}

fn number(cell: &str) -> f64 {
    Shown::first_of(cell).value
}

/// Returns the points (x; y) of a cell.
fn points(cell: &str) -> Vec<Vector2<f64>> {
    let points = cell.split('(').skip(1).map(|point| {
        let (x, y) = point.split_once(';').unwrap();
        Vector2::new(number(x), number(y))
    });
    points.collect()
}

/// Area and centre of a polygon.
fn polygon(corners: &[Vector2<f64>]) -> (f64, Vector2<f64>) {
    let next = corners.iter().cycle().skip(1);
    let (mut area, mut first) = (0.0, Vector2::zeros());
    for (a, b) in corners.iter().zip(next) {
        area += 0.5 * a.perp(b);
        first += (a + b) * (a.perp(b) / 6.0);
    }
    (area.abs(), first / area)
}

/// A body of a mechanism: its weight, centre and hinge, and its displacement `theta (y - y_O), -sign theta (x - x_O)`.
#[derive(Clone, Copy, Debug)]
struct Link {
    weight_kn: f64,
    centre_m: Vector2<f64>,
    pole_m: Vector2<f64>,
    theta: f64,
}

impl Link {
    fn delta(&self, at_m: Vector2<f64>, sign: f64) -> Vector2<f64> {
        let arm = at_m - self.pole_m;
        self.theta * Vector2::new(arm.y, -sign * arm.x)
    }
}

/// Virtual displacements of a chain of one or three bodies from its hinges, for a unit displacement of the common centre.
fn chain(hinges: &[Vector2<f64>], bodies: &[(f64, Vector2<f64>)], sign: f64) -> Vec<Link> {
    let link = |index: usize, pole_m, theta| {
        let (weight_kn, centre_m) = bodies[index];
        Link {
            weight_kn,
            centre_m,
            pole_m,
            theta,
        }
    };
    let mut links = match *hinges {
        [toe] => vec![link(0, toe, 1.0)],
        [a, b, c, d] => {
            // The middle body turns about the intersection of the lines AB and CD.
            let (u, v) = (b - a, c - d);
            let pole = a + u * ((d - a).perp(&v) / u.perp(&v));
            let first = link(0, a, 1.0);
            let ratio = |at: Vector2<f64>, from: Vector2<f64>, to: Vector2<f64>| {
                let (one, other) = (at - from, at - to);
                one.dot(&other) / other.norm_squared()
            };
            let middle = ratio(b, a, pole);
            let last = middle * ratio(c, pole, d);
            vec![first, link(1, pole, middle), link(2, d, last)]
        }
        _ => panic!("{} hinges", hinges.len()),
    };
    let weight: f64 = links.iter().map(|one| one.weight_kn).sum();
    let moved: f64 = links
        .iter()
        .map(|one| one.weight_kn * one.delta(one.centre_m, sign).x)
        .sum();
    links.iter_mut().for_each(|one| one.theta *= weight / moved);
    links
}

/// The sums of [C8.7.1.1] and [C8.7.1.5].
struct Sums {
    p: f64,
    px: f64,
    pxx: f64,
    py: f64,
}

fn sums(links: &[Link], sign: f64) -> Sums {
    let sum = |term: &dyn Fn(Vector2<f64>) -> f64| -> f64 {
        let terms = links
            .iter()
            .map(|one| one.weight_kn * term(one.delta(one.centre_m, sign)));
        terms.sum()
    };
    Sums {
        p: sum(&|_| 1.0),
        px: sum(&|delta| delta.x),
        pxx: sum(&|delta| delta.x * delta.x),
        py: sum(&|delta| delta.y),
    }
}

/// The hazard of a state as printed, with the spectrum of NTC 2018, § 3.2.3.2, on soil B, C or D.
#[derive(Default)]
struct Ground {
    ag_g: f64,
    f0: f64,
    s: f64,
    t_b: f64,
    t_c: f64,
    t_d: f64,
    t_e: f64,
}

fn eta(percent: f64) -> f64 {
    (10.0 / (5.0 + percent)).sqrt().max(0.55)
}

impl Ground {
    fn of(row: &[String]) -> Self {
        let [ag_g, f0, tc_star] = [2, 3, 4].map(|cell| number(&row[cell]));
        // Tables 3.2.IV and 3.2.VIII.
        let (s_s, c_c, t_e) = match &*row[1] {
            "B" => (
                (1.40 - 0.40 * f0 * ag_g).clamp(1.0, 1.2),
                1.10 * tc_star.powf(-0.20),
                5.0,
            ),
            "C" => (
                (1.70 - 0.60 * f0 * ag_g).clamp(1.0, 1.5),
                1.05 * tc_star.powf(-0.33),
                6.0,
            ),
            "D" => (
                (2.40 - 1.50 * f0 * ag_g).clamp(0.9, 1.8),
                1.25 * tc_star.powf(-0.50),
                6.0,
            ),
            soil => panic!("{soil}"),
        };
        let s = s_s * number(&row[6]);
        let t_c = c_c * tc_star;
        let own = Self {
            ag_g,
            f0,
            s,
            t_b: t_c / 3.0,
            t_c,
            t_d: 4.0 * ag_g + 1.6,
            t_e,
        };
        let printed = [
            (5, s_s),
            (7, s),
            (9, own.t_b),
            (10, t_c),
            (11, own.t_d),
            (12, ag_g * s),
        ];
        for (cell, computed) in printed {
            Shown::first_of(&row[cell]).is(computed);
        }
        own
    }

    fn acceleration_g(&self, t: f64, percent: f64) -> f64 {
        let most = self.ag_g * self.s * eta(percent) * self.f0;
        match t {
            t if t < self.t_b => {
                most * (t / self.t_b + (1.0 - t / self.t_b) / (eta(percent) * self.f0))
            }
            t if t < self.t_c => most,
            t if t < self.t_d => most * self.t_c / t,
            t => most * self.t_c * self.t_d / (t * t),
        }
    }
}

/// A mode of the building as printed.
struct Mode {
    t: f64,
    a_z: f64,
    f: f64,
}

/// The spectrum at the place of the mechanism. Without points it is that of the ground or of a floor.
struct Spectrum {
    ground: Ground,
    points: Vec<Vector2<f64>>,
    /// Damping of the points.
    points_percent: f64,
    modes: Vec<Mode>,
    a_z: f64,
}

impl Spectrum {
    fn new(html: &str, state: &str, percent: f64) -> Self {
        if let Some((_, own)) = html.split_once(&format!("<p><b>{state}</b>: ")) {
            let own = text_of(own.split_once("</p>").unwrap().0);
            let (_, all) = own.split_once("S in g):").unwrap();
            let points = points(all.split(" Limit:").next().unwrap());
            // Points begin at period zero, with the peak of the ground.
            let ground = Ground {
                ag_g: points[0].y,
                s: 1.0,
                ..Ground::default()
            };
            return Self {
                ground,
                points,
                points_percent: after(&own, "damping ").value,
                modes: Vec::new(),
                a_z: f64::NAN,
            };
        }
        let spectra = &tables(html, "spectra")[0];
        let ground = Ground::of(spectra.iter().find(|row| row[0] == state).unwrap());
        let of_modes = tables(html, "modes");
        let rows = of_modes.iter().flatten().filter(|row| row[0] == state);
        let mut printed_g = None;
        let modes = rows.map(|row| {
            let [t, xi, gamma, psi] = [2, 3, 4, 5].map(|cell| number(&row[cell]));
            let a_z = ground.acceleration_g(t, xi)
                * (gamma * psi).abs()
                * (1.0 + 0.0004 * xi * xi).sqrt();
            let f = 1.1 * eta(percent) / (xi / 100.0).sqrt();
            Shown::first_of(&row[7]).is(a_z);
            Shown::first_of(&row[9]).is(f);
            printed_g = Some(Shown::first_of(&row[8]));
            Mode { t, a_z, f }
        });
        let modes: Vec<Mode> = modes.collect();
        let squares: f64 = modes.iter().map(|mode| mode.a_z * mode.a_z).sum();
        let a_z = squares.sqrt().max(ground.ag_g * ground.s);
        printed_g.inspect(|printed| printed.is(a_z));
        Self {
            ground,
            points: Vec::new(),
            points_percent: 5.0,
            modes,
            a_z,
        }
    }

    /// [C7.2.5] and [C7.2.6], or [3.2.2] on the ground.
    fn acceleration_g(&self, t: f64, percent: f64) -> f64 {
        if !self.points.is_empty() {
            let mut pairs = self.points.windows(2);
            let pair = pairs.find(|pair| t <= pair[1].x).unwrap();
            let part = (t - pair[0].x) / (pair[1].x - pair[0].x);
            let own = pair[0].y + part * (pair[1].y - pair[0].y);
            return own * eta(percent) / eta(self.points_percent);
        }
        let squares = self.modes.iter().map(|mode| {
            let (low, high) = (t / (0.8 * mode.t), t / (1.1 * mode.t));
            let falls = match t {
                _ if low < 1.0 => (1.0 - low).powf(1.6),
                _ if high > 1.0 => (high - 1.0).powf(1.2),
                _ => 0.0,
            };
            (mode.f * mode.a_z / (1.0 + (mode.f - 1.0) * falls)).powi(2)
        });
        let own = squares.sum::<f64>().sqrt();
        own.max(self.ground.acceleration_g(t, percent))
    }

    /// Among many periods up to this one, the period of the largest displacement of points.
    fn largest_at(&self, t: f64, percent: f64) -> f64 {
        const PARTS: u32 = 200_000;
        let periods = (0..=PARTS).map(|part| t * f64::from(part) / f64::from(PARTS));
        let displacements = periods.map(|t| (self.acceleration_g(t, percent) * t * t, t));
        displacements
            .fold(
                (0.0, 0.0),
                |most, own| if own.0 > most.0 { own } else { most },
            )
            .1
    }

    /// [C8.7.1.12], or S_De on the ground up to T_E, or the largest displacement of points.
    fn displacement_m(&self, t: f64, percent: f64, g: f64) -> f64 {
        let at = |t: f64, a_g: f64| a_g * g * (t / (2.0 * PI)).powi(2);
        if !self.points.is_empty() {
            let t = self.largest_at(t, percent);
            return at(t, self.acceleration_g(t, percent));
        }
        let first = self.modes.iter().map(|mode| mode.t).fold(0.0, f64::max);
        if self.modes.is_empty() {
            let t = t.min(self.ground.t_e);
            return at(t, self.acceleration_g(t, percent));
        }
        let own = at(t, self.acceleration_g(t, percent));
        match t > 1.1 * first {
            true => own.max(at(1.1 * first, self.acceleration_g(first, percent))),
            false => own,
        }
    }
}

/// The part of a page of each side, from its sections of the mechanism and of the checks.
fn sides(html: &str) -> Vec<(f64, String, String)> {
    let section = |id: &str| {
        let (_, rest) = html.split_once(&format!("<section id=\"{id}\">")).unwrap();
        rest.split_once("</section>").unwrap().0
    };
    let pairs = |id: &str| {
        let pairs = section(id).split("<div class=\"pair\">").skip(1);
        pairs.map(str::to_owned).collect::<Vec<_>>()
    };
    let is_left = |index: usize| {
        let headings: Vec<&str> = section("mechanism").split("<h3>").skip(1).collect();
        let only = html
            .split_once("class=\"sentence\">")
            .unwrap()
            .1
            .starts_with("To the left");
        only || headings
            .get(index)
            .is_some_and(|heading| heading.starts_with("To the left"))
    };
    let both = pairs("mechanism")
        .into_iter()
        .zip(pairs("checks"))
        .enumerate();
    both.map(|(index, (one, other))| (if is_left(index) { -1.0 } else { 1.0 }, one, other))
        .collect()
}

/// Masses and centres of the bodies of a side, from the ring or the blocks.
fn bodies_by_hand(
    html: &str,
    hinges: &[Vector2<f64>],
    rows: &[Vec<String>],
) -> Vec<(f64, Vector2<f64>)> {
    let (_, structure) = html.split_once("<section id=\"structure\">").unwrap();
    let structure = structure.split_once("</section>").unwrap().0;
    let text = text_of(structure);
    let [b, rho, g] = ["b = ", "ρ = ", "g = "].map(|mark| after(&text, mark).value);
    if text.contains("Ring") {
        let [r, t] = ["R = ", "t = "].map(|mark| after(&text, mark).value);
        let bodies = hinges.windows(2).map(|ends| {
            let [from, to] = [0, 1].map(|end| f64::atan2(ends[end].x, ends[end].y));
            let (beta, middle) = (0.5 * (to - from), 0.5 * (from + to));
            let radius = (r + t * t / (12.0 * r)) * beta.sin() / beta;
            let centre = radius * Vector2::new(middle.sin(), middle.cos());
            (rho * g / 1000.0 * b * r * t * (to - from), centre)
        });
        return bodies.collect();
    }
    let table = &tables(structure, "blocks")[0];
    let has_densities = table[0].iter().any(|head| head == "ρ (kg/m³)");
    let parts = table[1..].iter().map(|row| {
        let corners = points(&row[1]);
        let rho = match has_densities {
            true => number(&row[2]),
            false => rho,
        };
        let masses: Vec<f64> = row[2 + usize::from(has_densities)..row.len() - 2]
            .iter()
            .map(|cell| number(cell))
            .collect();
        let centre = Vector2::new(number(&row[row.len() - 2]), number(&row[row.len() - 1]));
        let (area, middle) = polygon(&corners);
        // Chords of curved sides make a small difference.
        let tolerance = if corners.len() == 4 { 1e-5 } else { 2e-3 };
        assert!(
            (rho * b * area / masses[0] - 1.0).abs() < tolerance,
            "{row:?}"
        );
        if masses[1..].iter().all(|mass| *mass == 0.0) {
            assert!(
                (middle - centre).norm() < 2.0 * tolerance,
                "{middle} {row:?}"
            );
        }
        (masses.iter().sum::<f64>(), centre)
    });
    let parts: Vec<(f64, Vector2<f64>)> = parts.collect();
    let bodies = rows.iter().map(|row| {
        // A body of all blocks names none.
        let range = row[1].split_once('–');
        let range = range.map(|(first, last)| (first.parse().unwrap(), last.parse().unwrap()));
        let (first, last): (usize, usize) = range.unwrap_or((1, parts.len()));
        let own = &parts[first - 1..last];
        let mass: f64 = own.iter().map(|part| part.0).sum();
        let centre = own.iter().map(|part| part.1 * (part.0 / mass)).sum();
        (mass * g / 1000.0, centre)
    });
    bodies.collect()
}

/// Redoes the check of a page; returns the number of ratios found.
fn redo(text: &str) -> usize {
    let html = html_of(&parsed(text));
    let whole = text_of(html.split_once("<section id=\"structure\">").unwrap().1);
    let g = after(&whole, "g = ").value;
    let results = html.split_once("<section id=\"result\">").unwrap().1;
    let results = tables(
        &results.replacen("<table>", "<table class=\"result\">", 1),
        "result",
    );
    let mut count = 0;
    for (sign, mechanism, checks) in sides(&html) {
        let name = if html.contains("mirror image") {
            "either side"
        } else if sign > 0.0 {
            "right"
        } else {
            "left"
        };
        let rows = |class: &str| {
            tables(&mechanism, class)
                .first()
                .map_or_else(Vec::new, |table| table[1..].to_vec())
        };
        let at = |row: &[String], x: usize| Vector2::new(number(&row[x]), number(&row[x + 1]));
        let hinges: Vec<_> = rows("hinges").iter().map(|row| at(row, 2)).collect();
        let table = rows("bodies");
        let x = table[0].len() - 5;
        let by_hand = bodies_by_hand(&html, &hinges, &table);
        let links = chain(&hinges, &by_hand, sign);
        for (row, link) in table.iter().zip(&links) {
            let delta = link.delta(link.centre_m, sign);
            let own = [
                link.weight_kn,
                link.centre_m.x,
                link.centre_m.y,
                delta.x,
                delta.y,
                link.theta,
            ];
            for (cell, computed) in row[x - 1..].iter().zip(own) {
                let shown = Shown::first_of(cell);
                assert!(
                    (computed - shown.value).abs() < 40.0 * shown.half_unit,
                    "{computed} {shown:?} {row:?}"
                );
            }
        }
        // Ties and constant forces.
        let ties = rows("ties").into_iter().map(|row| {
            let ends = points(&row[1]);
            let delta = ends
                .iter()
                .zip(row[1].split('(').skip(1))
                .map(|(end, words)| match words.contains("block") {
                    true => links[0].delta(*end, sign),
                    false => Vector2::zeros(),
                });
            let delta: Vec<_> = delta.collect();
            let along = (ends[1] - ends[0]).normalize();
            let lengthening = along.dot(&Vector2::new(
                sign * (delta[1] - delta[0]).x,
                (delta[1] - delta[0]).y,
            ));
            Shown::first_of(&row[3]).is(lengthening);
            number(&row[2]) * lengthening
        });
        let held: f64 = ties.sum();
        let forces: Vec<_> = rows("forces")
            .iter()
            .map(|row| (at(row, 1), at(row, 3)))
            .collect();
        let pushed: f64 = forces
            .iter()
            .map(|(at, force)| force.dot(&links[0].delta(*at, sign)))
            .sum();
        let text = text_of(&mechanism);
        let own = sums(&links, sign);
        let (alpha0, e) = (
            (own.py + held - pushed) / own.px,
            own.px * own.px / (own.p * own.pxx),
        );
        after(&text, "AL = α0 g = ").is(alpha0);
        let (_, divided) = text.split_once("α0 g/(e* FC) = ").unwrap();
        let fc = after(divided, " · ").value;
        let a0 = alpha0 / (e * fc);
        after(divided, ") g = ").is(a0);
        // The displaced positions: d and a, and the end of the curve.
        let positions = tables(&mechanism, "positions");
        let mut curve: Vec<[f64; 3]> = Vec::new();
        for column in 0..positions.first().map_or(0, |table| table[0].len() - 1) {
            let table = &positions[0];
            let rows: Vec<_> = table[2..]
                .iter()
                .map(|row| at(row, 1 + 2 * column))
                .collect();
            let (moved, centres) = rows.split_at(hinges.len());
            let bodies: Vec<_> = by_hand
                .iter()
                .zip(centres)
                .map(|(own, centre)| (own.0, *centre))
                .collect();
            let there = chain(moved, &bodies, sign);
            let shift: f64 = by_hand
                .iter()
                .zip(centres)
                .map(|(own, centre)| own.0 / own_weight(&by_hand) * (centre - own.1).x)
                .sum();
            let turned = |at: Vector2<f64>| {
                let (before, now) = (by_hand[0].1 - hinges[0], centres[0] - moved[0]);
                let turn = nalgebra::Rotation2::new(before.perp(&now).atan2(before.dot(&now)));
                moved[0] + turn * (at - hinges[0])
            };
            let pushed: f64 = forces
                .iter()
                .map(|(at, force)| force.dot(&there[0].delta(turned(*at), sign)))
                .sum();
            let sum = sums(&there, sign);
            let (d, a) = (sign * shift / e, (sum.py - pushed) / sum.px / e);
            let [d_shown, a_shown] =
                [1, 2].map(|cell| Shown::first_of(&table[1][cell + 2 * column]));
            assert!((d - d_shown.value).abs() < 2e-5, "{d} {d_shown:?}");
            assert!((a - a_shown.value).abs() < 6e-5, "{a} {a_shown:?}");
            let part = if table[0][1 + column].starts_with('d') {
                1.0
            } else {
                number(&table[0][1 + column])
            };
            curve.push([part, d_shown.value, a_shown.value]);
        }
        if let Some([_, d0, _]) = curve.iter().find(|at| at[0] == 1.0).copied() {
            after(&text, "d0 = dC0/e* = ").is(d0);
            // The rows of the curve contain the straight lines to these points.
            let rows = &tables(&mechanism, "curve")[0][1..];
            let pairs = rows
                .iter()
                .flat_map(|row| row.chunks(2))
                .map(|pair| [number(&pair[0]), number(&pair[1])]);
            let mut pairs: Vec<[f64; 2]> = pairs.collect();
            pairs.sort_by(|one, other| one[0].total_cmp(&other[0]));
            assert!(
                (pairs[0][1] - alpha0 / e).abs() < 2e-5 && pairs[0][0] == 0.0 && pairs.len() == 21
            );
            for [_, d, a] in &curve {
                let next = pairs
                    .iter()
                    .position(|pair| pair[0] >= d - 1e-6)
                    .unwrap()
                    .max(1);
                let [from, to] = [pairs[next - 1], pairs[next]];
                let straight = from[1] + (to[1] - from[1]) * (d - from[0]) / (to[0] - from[0]);
                assert!((straight - a).abs() < 5e-3 * pairs[0][1], "{straight} {a}");
            }
        }
        let checks = text_of(&checks);
        let t0 = text.contains("T0 =").then(|| {
            let density = after(&whole, "ρ = ").value;
            let (_, from) = text.split_once("κ λ L √(W/(E g)) = ").unwrap();
            let [kappa, length, thickness, modulus] =
                ["", " · ", "/", "/ ("].map(|mark| after(from, mark).value);
            let t0 = kappa * length / thickness * length * (density / (modulus * 1e9)).sqrt();
            after(&text, " · 109)) = ").is(t0);
            t0
        });
        let mut start = None;
        for state in ["SLD", "SLV", "SLC"] {
            let Some((_, own)) = checks.split_once(&format!("{state}: ")) else {
                continue;
            };
            let own = ["SLV: ", "SLC: "].iter().fold(own, |own, next| {
                own.split_once(next).map_or(own, |both| both.0)
            });
            let printed: Vec<Shown> = own
                .match_indices("ζE = ")
                .map(|(at, _)| {
                    let ratio = &own[at + "ζE = ".len()..];
                    let line = ratio.split('\n').next().unwrap();
                    Shown::first_of(
                        line.rsplit_once(" = ")
                            .filter(|_| line.contains(" / "))
                            .map_or(line, |both| both.1),
                    )
                })
                .collect();
            let percent = if state == "SLD" {
                5.0
            } else {
                own.split_once("ξ = ").map_or(5.0, |(_, rest)| number(rest))
            };
            let spectrum = Spectrum::new(&html, state, percent);
            let mut ratios = Vec::new();
            if state == "SLD" {
                let demand = match t0 {
                    Some(t0) => spectrum.acceleration_g(t0, 5.0),
                    None if spectrum.modes.is_empty() => spectrum.ground.ag_g * spectrum.ground.s,
                    None => spectrum.a_z,
                };
                let start_g = spectrum.ground.ag_g * a0 / demand;
                let (_, computed) = own.split_once("ag,SLD = ").unwrap();
                after(computed, " = ").is(start_g);
                start = Some(start_g);
                ratios.push(("activation", a0 / demand));
            }
            if own.contains("√(d/a)") {
                let part = after(own, &format!("d{state} = ")).value;
                let [_, d, a] = *curve.iter().find(|at| at[0] == part).unwrap();
                let (factor, a) = (after(own, "T = ").value, a / fc);
                let t = factor * PI * (d / (a * g)).sqrt();
                let demand = spectrum.displacement_m(t, percent, g);
                after(own, &format!(" · {g})) = ")).is(t);
                let mark = match (spectrum.points.is_empty(), spectrum.modes.is_empty()) {
                    (false, _) => "up to T is ",
                    (true, true) => "SDe = Se g T²/4π² = ",
                    (true, false) => "; demand ",
                };
                after(own, mark).is(demand);
                if !spectrum.points.is_empty() {
                    after(own, "m, at T = ").is(spectrum.largest_at(t, percent));
                }
                ratios.push(("displacement", d / demand));
                if let Some((_, crown)) = own.split_once("as control point d = ") {
                    let d = part * after(crown, " · ").value;
                    // Points name no confidence factor, but the number that divides a.
                    let (_, divided) = crown.split_once("a/").unwrap();
                    let a = after(divided, " = ").value;
                    let t = factor * PI * (d / (a * g)).sqrt();
                    after(crown, " T = ").is(t);
                    ratios.push(("", d / spectrum.displacement_m(t, percent, g)));
                }
                let borne = spectrum.ground.ag_g * d / demand;
                if let Some(start) = start.filter(|start| *start > borne) {
                    ratios.push(("activation", start / spectrum.ground.ag_g));
                }
            }
            if let Some((_, simple)) = own.split_once("= q ag,SLD = ") {
                ratios.push((
                    "q times activation",
                    number(simple) * start.unwrap() / spectrum.ground.ag_g,
                ));
            }
            assert_eq!(ratios.len(), printed.len(), "{own}");
            for ((method, ratio), shown) in ratios.iter().zip(&printed) {
                shown.is(*ratio);
                count += 1;
                if !method.is_empty() {
                    let row = results[0].iter().find(|row| {
                        row[0] == state && row[1].starts_with(method) && row[2] == name
                    });
                    let row = row.unwrap_or_else(|| panic!("no row {state} {method} {name}"));
                    Shown::first_of(&row[7]).is(*ratio);
                    let passed = if *ratio >= 1.0 {
                        "passed"
                    } else {
                        "not passed"
                    };
                    assert_eq!(row[8].trim(), passed);
                }
            }
        }
    }
    count
}

fn own_weight(bodies: &[(f64, Vector2<f64>)]) -> f64 {
    bodies.iter().map(|body| body.0).sum()
}

/// Every ratio of the page follows from its other numbers: corners, masses, hinges, displaced positions, hazard and modes.
#[test]
fn the_check_is_redone_by_hand_from_the_printed_page() {
    let folder = tempfile::tempdir().unwrap();
    for (text, ratios) in [
        (format!("{ARCH}{DEMAND}"), 6),
        (format!("{ARCH}{}", DEMAND.replace("'B'", "'C'")), 6),
        (format!("{COLUMN}{}", DEMAND.replace("'B'", "'D'")), 6),
        (format!("{COLUMN}{}", by_points(folder.path())), 3),
        (format!("{ARCH}{DEMAND}{HEIGHT}"), 6),
        (format!("{}{DEMAND}{HEIGHT}", on_piers()), 12),
        (format!("{}{DEMAND}", on_light_piers()), 12),
        (format!("{}{DEMAND}", given_blocks(folder.path())), 6),
        (format!("{COLUMN}{DEMAND}{FREE}"), 6),
        (format!("{COLUMN}{DEMAND}{HEIGHT}{FREE}"), 6),
        (format!("{LOADED}{DEMAND}"), 12),
        (format!("{STOUT}{DEMAND}"), 8),
        (format!("{DRUMS}{DEMAND}"), 6),
        (format!("{TIED}{DEMAND}"), 4),
        (
            format!("{COLUMN}{DEMAND}[verify]\nsides = 'left'\nconfidence_factor = 1.2\n"),
            6,
        ),
    ] {
        assert_eq!(redo(&text), ratios, "{text}");
    }
}

/// Loads name their block and point, fill its level.
#[test]
fn the_page_lists_loads_and_fill() {
    let drums = DRUMS.replace("top_width_m = 0.6\n", "");
    let page = |text: String| text_of(&html_of(&parsed(&text)));
    let of_drums = page(format!(
        "{drums}[[load]]\nmass_kg = 500\nx_m = 0.1\nheight_m = 3\n\
         [[load]]\nmass_kg = 200\nmoves = false\nthrust_n = 100\n{DEMAND}"
    ));
    for line in [
        "Load 1: block 4, at (0.10000; 3.00000) m: 500.00 kg.",
        "Load 2: block 5, at (0.00000; 4.00000) m: 200.00 kg (weight only, without inertia), thrust 0.1000 kN.",
    ] {
        assert!(of_drums.contains(line), "{line}");
    }
    let of_arch = page(format!("{}{DEMAND}", on_piers()));
    let level = on_piers().replace("height_m = 2.0", "above_crown_m = 0.2");
    let above_crown = page(format!("{level}{DEMAND}"));
    let of_piers = page(format!("{}{DEMAND}", on_light_piers()));
    for (page, words) in [
        (
            &of_arch,
            "Fill up to 2.0000 m above the springing of the extrados, 1600.00 kg/m³.",
        ),
        (&of_arch, "over a width of 0.5000 m: 1500.00 kg."),
        (&of_arch, "ρ = 2000.00 kg/m³; g"),
        (
            &above_crown,
            "Fill up to 0.2000 m above the crown of the extrados",
        ),
        (&of_piers, "ρ = 2000.00 kg/m³ of the arch; g"),
    ] {
        assert!(page.contains(words), "{words}");
    }
}

/// The verdict is the first sentence; decisions are numbered without holes; a governing activation stands beside the displacements.
#[test]
fn the_page_begins_with_its_verdict_and_numbers_its_decisions() {
    for text in [
        format!("{STOUT}{DEMAND}"),
        format!("{ARCH}{DEMAND}{HEIGHT}"),
        format!("{TIED}{DEMAND}{FREE}"),
    ] {
        let html = html_of(&parsed(&text));
        let (_, after_title) = html.split_once("</h1>\n").unwrap();
        assert!(after_title.starts_with("<p class=\"sentence\">The structure"));
        let names: Vec<&str> = html
            .split("<dt>")
            .skip(1)
            .map(|rest| rest.split_once('<').unwrap().0)
            .collect();
        let numbered: Vec<String> = (1..=names.len())
            .map(|number| format!("D{number}"))
            .collect();
        assert_eq!(names, numbered);
    }
    let html = html_of(&parsed(&format!("{STOUT}{DEMAND}")));
    let rows: Vec<&str> = html
        .split("<tr")
        .filter(|row| row.contains(">SLV</td>"))
        .collect();
    assert!(rows[0].starts_with(" class=\"counts\"") && rows[0].contains(">activation"));
    assert!(
        rows[1].contains(">displacement")
            && rows[1].contains(" m</td>")
            && !rows[1].contains("counts")
    );
}

/// English words that must not remain on an Italian page.
const ENGLISH: [&str; 52] = [
    "the",
    "of",
    "to",
    "and",
    "or",
    "is",
    "are",
    "by",
    "for",
    "from",
    "at",
    "with",
    "without",
    "no",
    "not",
    "it",
    "side",
    "right",
    "left",
    "passed",
    "passes",
    "check",
    "checked",
    "displacement",
    "demand",
    "capacity",
    "state",
    "structure",
    "blocks",
    "block",
    "hinge",
    "force",
    "tie",
    "load",
    "fill",
    "span",
    "rise",
    "spectral",
    "peak",
    "mean",
    "record",
    "joint",
    "toe",
    "crown",
    "top",
    "ring",
    "depth",
    "density",
    "curve",
    "activation",
    "times",
    "width",
];

/// Numbers of a text in their order, with a decimal point.
fn numbers(text: &str) -> Vec<String> {
    let text = text.replace(',', ".");
    let pieces = text.split(|c: char| !(c.is_ascii_digit() || c == '.'));
    let pieces = pieces.map(|piece| piece.trim_matches('.').to_owned());
    pieces.filter(|piece| !piece.is_empty()).collect()
}

fn both_languages(text: &str) -> [Scenario; 2] {
    let english = parsed(text);
    let verify = if text.contains("[verify]") {
        ""
    } else {
        "[verify]\n"
    };
    let italian = match verify {
        "" => text.replace("[verify]", "[verify]\nlanguage = 'it'"),
        _ => format!("{text}[verify]\nlanguage = 'it'\n"),
    };
    [english, parsed(&italian)]
}

/// Both languages have the same elements and numbers; the Italian page has no English word and decimal commas.
#[test]
fn the_italian_check_mirrors_the_english_one() {
    let left =
        "[verify]\nsides = 'left'\nconfidence_factor = 1.2\nfree_standing = { t0_s = 0.15 }\n";
    for text in [
        format!("{ARCH}{DEMAND}"),
        format!("{}{DEMAND}{HEIGHT}", on_piers()),
        format!("{COLUMN}[column.back]\nside = 'left'\n{DEMAND}"),
        format!("{LOADED}{DEMAND}"),
        format!("{STOUT}{DEMAND}"),
        format!("{SLIPS}{DEMAND}"),
        format!("{TIED}{DEMAND}"),
        format!("{DRUMS}{DEMAND}{left}"),
        format!("{}{DEMAND}", on_light_piers()),
        format!("{COLUMN}{}", DEMAND.replace("'B'", "'D'")),
    ] {
        let scenarios = both_languages(&text);
        let pages = scenarios.each_ref().map(|scenario| {
            let html = html_of(scenario);
            // Title, hashes and the scenario itself are those of the user.
            let (before, rest) = html.split_once("<tr><th>File").unwrap();
            let (main, _) = rest
                .split_once("</td></tr>")
                .unwrap()
                .1
                .split_once("<details>")
                .unwrap();
            let before = before.split_once("</h1>").unwrap().1;
            format!("{before}{main}")
        });
        let tags = pages.each_ref().map(|html| {
            let tags = html
                .split('<')
                .skip(1)
                .map(|tag| tag.split(['>', ' ']).next().unwrap().to_owned());
            tags.collect::<Vec<_>>()
        });
        assert_eq!(tags[0], tags[1], "{text}");
        let values = pages.each_ref().map(|html| {
            let values = html.split("<data value=\"").skip(1).map(|rest| {
                let (value, shown) = rest.split_once("\">").unwrap();
                (
                    value.to_owned(),
                    shown.split_once('<').unwrap().0.to_owned(),
                )
            });
            values.collect::<Vec<_>>()
        });
        assert_eq!(values[0].len(), values[1].len());
        for ((value, shown), (same, comma)) in values[0].iter().zip(&values[1]) {
            assert_eq!((value, shown), (same, &comma.replace(',', ".")));
            assert!(!comma.contains('.'));
        }
        let texts = pages.each_ref().map(|html| text_of(html));
        assert_eq!(numbers(&texts[0]), numbers(&texts[1]), "{text}");
        let page_words = texts[1].split(|c: char| !(c.is_alphabetic() || c == '_' || c == '’'));
        for word in page_words {
            assert!(!ENGLISH.contains(&&*word.to_lowercase()), "{word}: {text}");
        }
        // Points remain only in numbers of clauses and tables, in the version and after words.
        let points = texts[1].match_indices('.').filter(|(at, _)| {
            let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
            digit(texts[1][..*at].chars().next_back()) && digit(texts[1][at + 1..].chars().next())
        });
        for (at, _) in points {
            let before = texts[1][..at].rsplit([' ', '[', '(']).next().unwrap();
            let mark = &texts[1][..at - before.len()];
            let is_clause = before.starts_with('C')
                || ["§ ", "Tab. ", "[", "§\u{a0}", "archrock "]
                    .iter()
                    .any(|end| mark.ends_with(end));
            assert!(is_clause, "{}", &texts[1][mark.len()..at + 3]);
        }
        let checks = scenarios
            .each_ref()
            .map(|scenario| verify(scenario).unwrap());
        let said = checks.each_ref().map(words);
        // The frame of reference of ties has no numbers in Italian, and heights above the springings.
        if !text.contains("[[tie]]") {
            assert_eq!(numbers(&said[0]), numbers(&said[1]));
        }
        for word in said[1].split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '’')) {
            assert!(
                !ENGLISH.contains(&&*word.to_lowercase()),
                "{word}: {}",
                said[1]
            );
        }
        let [english, mut italian] = checks
            .each_ref()
            .map(|check| serde_json::to_value(check).unwrap());
        assert_eq!(italian["language"], "it");
        assert_eq!(english.get("language"), None);
        for texts in [
            "decisions",
            "assumptions",
            "not_covered",
            "warnings",
            "scenario",
            "scenario_sha256",
            "files",
        ] {
            let lengths = [&english, &italian].map(|json| json[texts].as_array().map(Vec::len));
            assert_eq!(lengths[0], lengths[1], "{texts}");
            italian[texts] = english[texts].clone();
        }
        italian.as_object_mut().unwrap().remove("language");
        let because = [&english, &italian].map(|json| json.get("no_zeta_e_because").is_some());
        assert_eq!(because, [text.contains("friction_coefficient"); 2]);
        if because[0] {
            italian["no_zeta_e_because"] = english["no_zeta_e_because"].clone();
        }
        assert_eq!(english, italian);
    }
}

/// Numbers beside a verdict do not round across their limit: a ratio of 0.99969 is not 1.000 beside "not passed".
#[test]
fn numbers_beside_a_verdict_do_not_round_across_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("points.csv");
    // A rigid column starts to move at its slenderness, 0.8 m over 4 m, divided by FC.
    let capacity_g = 0.8 / 4.0 / 1.35;
    for (ratio, shown) in [
        (0.99, "0.990"),
        (0.999_69, "0.9997"),
        (0.999_999_2, "0.999999"),
        (1.000_04, "1.00004"),
        (1.01, "1.010"),
    ] {
        let demand_g = capacity_g / ratio;
        let points = format!("period_s,acceleration_g\n0,{demand_g}\n4,{demand_g}\n");
        std::fs::write(&file, points).unwrap();
        let spectrum = format!("spectrum = '{}'\n", file.display());
        let text = format!("{COLUMN}[demand.sld]\n{spectrum}[demand.slv]\n{spectrum}");
        for (scenario, verdict) in both_languages(&text)
            .iter()
            .zip([["not passed", "passed"], ["non soddisfatta", "soddisfatta"]])
        {
            let html = html_of(scenario);
            let row = html.split("<tr").find(|row| row.contains(">SLD<")).unwrap();
            let point = |text: &str| text.replace(',', ".");
            let numbers = row.split("<data value=\"").skip(1).map(|rest| {
                let (_, rest) = rest.split_once('>').unwrap();
                point(rest.split_once('<').unwrap().0)
            });
            let numbers: Vec<String> = numbers.collect();
            assert_eq!(numbers.last().unwrap(), shown, "{row}");
            let own = verdict[usize::from(ratio >= 1.0)];
            assert!(row.contains(&format!(">{own}</span>")), "{row}");
            let printed = numbers.iter().map(|number| number.parse::<f64>().unwrap());
            let printed: Vec<f64> = printed.collect();
            // Capacity and demand, as spectral and as ground accelerations.
            for pair in printed[..4].chunks(2) {
                assert_eq!(pair[0] < pair[1], ratio < 1.0, "{row}");
                assert_eq!(pair[0] > pair[1], ratio > 1.0, "{row}");
            }
            let said = point(&words(&verify(scenario).unwrap()));
            let line = said.lines().find(|line| line.starts_with("SLD")).unwrap();
            let zeta_e = line.split_once("zeta_E ").unwrap().1;
            let zeta_e: f64 = zeta_e.split(' ').next().unwrap().parse().unwrap();
            assert_eq!(zeta_e < 1.0, ratio < 1.0, "{line}");
            assert!((zeta_e - ratio).abs() < 5.1e-6, "{line}");
        }
    }
}

#[test]
fn the_language_is_set_on_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), format!("{ARCH}{DEMAND}")).unwrap();
    let said = print_of(
        folder.path(),
        &[
            "verify",
            "a.toml",
            "--set",
            "verify.language=it",
            "--out",
            "o",
        ],
    );
    golden("verify-it", &said);
    let html = std::fs::read_to_string(folder.path().join("o/verify.html")).unwrap();
    assert!(html.contains("<html lang=\"it\">") && html.contains("Verifica di meccanismi locali"));
    let json: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("o/verify.json")).unwrap())
            .unwrap();
    assert_eq!(json["scenario"]["verify"]["language"], "it");
}

/// Histories, too, have both languages.
#[test]
fn histories_are_reported_in_italian() {
    let path = scenarios().join("semicircle-verify.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("records")).unwrap();
    for record in (1..=7).map(|record| format!("records/slv-{record}.at2")) {
        std::fs::copy(scenarios().join(&record), folder.path().join(&record)).unwrap();
    }
    let text = text.split_once("[simulation]").unwrap().0;
    let pages = ["en", "it"].map(|language| {
        let own = text.replace("[verify]", &format!("[verify]\nlanguage = \"{language}\""));
        let file = folder.path().join("a.toml");
        std::fs::write(&file, own).unwrap();
        let scenario = Scenario::read(&file).unwrap();
        let html = html_of(&scenario);
        let (_, checks) = html.split_once("<section id=\"checks\">").unwrap();
        let result = html.split_once("<section id=\"result\">").unwrap().1;
        let result = result.split_once("</section>").unwrap().0;
        text_of(&format!(
            "{result} {}",
            checks.split_once("<details>").unwrap().0
        ))
    });
    assert_eq!(numbers(&pages[0]), numbers(&pages[1]));
    for word in pages[1].split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '’')) {
        assert!(!ENGLISH.contains(&&*word.to_lowercase()), "{word}");
    }
    assert!(pages[1].contains("accelerogrammi su 7 sono fuori dal modello"));
}

/// On a telephone the page stacks, tables scroll, and no text is below 12 px; on paper it has few sheets.
#[test]
fn the_page_fits_telephones_and_paper() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("arch", format!("{ARCH}{DEMAND}")),
        ("piers", format!("{}{DEMAND}{HEIGHT}", on_piers())),
    ] {
        for scenario in both_languages(&text) {
            let page = folder.path().join(format!("{name}.html"));
            std::fs::write(&page, html_of(&scenario)).unwrap();
            let script = "
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (walker.nextNode()) {
  const parent = walker.currentNode.parentElement;
  if (!walker.currentNode.textContent.trim() || parent.closest('script, pre, style')) continue;
  const svg = parent.closest('svg');
  const scale = svg ? svg.getBoundingClientRect().width / svg.viewBox.baseVal.width : 1;
  const px = parseFloat(getComputedStyle(parent).fontSize) * scale;
  verify(px >= 11.99, `${px} px: ${walker.currentNode.textContent}`);
}
verify(document.documentElement.scrollWidth <= innerWidth, `${document.documentElement.scrollWidth} wide`);
document.querySelectorAll('table').forEach((table) => {
  const box = table.getBoundingClientRect();
  verify(box.right <= innerWidth + 0.5, `table ${table.className} ends at ${box.right}`);
});
";
            for size in ["--window-size=390,800", "--window-size=1280,900"] {
                browser::assert_checked(&page, script, "null", &[size], 100);
            }
            if let Some(sheets) = browser::sheets(&page) {
                assert!(sheets <= 7, "{name}: {sheets} sheets");
            }
        }
    }
}
