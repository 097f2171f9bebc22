//! The dynamic route of the check, C8.7.1.2.1.9: peaks compared with an independent integration and geometry, the choice of the
//! governing peak, both sides, and refusals.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use crate::common::browser;
use crate::common::program::{assert_shown_output_is_printed, printed, refused, scenarios};
use crate::common::prose::{shows, skeleton};
use archrock::mechanics::{Edge, Hinge};
use archrock::scenario::LimitState;
use archrock::studies::verify::{
    ComparedPeak, Histories, RecordPeaks, VerifyError, VerifySummary, verify, words,
};
use archrock::{Request, Scenario, State, Sway};
use nalgebra::{Rotation2, Vector2};
use serde_json::Value;

const GRAVITY: f64 = 9.81;
const COLUMN: &str = "[column]\nheight_m = 4\nwidth_m = 0.8\n";
const SEMICIRCLE: &str = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\n";
const DEMAND: &str = "[demand]\nsoil = 'B'\ntopography = 'T1'\n\
    [demand.slv]\nag_g = 0.25\nf0 = 2.40\ntc_star_s = 0.35\n\
    [demand.slc]\nag_g = 0.32\nf0 = 2.45\ntc_star_s = 0.36\n";

/// A folder with all records of the repository, in which `a.toml` has this text.
fn folder(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(scenarios().join("records")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    fs::write(folder.path().join("a.toml"), text).unwrap();
    folder
}

fn read(folder: &Path) -> Scenario {
    Scenario::read(&folder.join("a.toml")).unwrap_or_else(|errors| panic!("{errors}"))
}

fn check(folder: &Path) -> VerifySummary {
    verify(&read(folder)).unwrap_or_else(|error| panic!("{error}"))
}

/// The histories of SLV for a structure under records, given as an array of names.
fn of_slv(structure: &str, records: &str) -> Histories {
    let text = format!("{structure}{DEMAND}[verify]\nslv_records = {records}\n");
    let check = check(folder(&text).path());
    check.states[&LimitState::Slv].histories.clone().unwrap()
}

/// Of the semicircle, under seven records.
static SEVEN: LazyLock<Histories> = LazyLock::new(|| of_slv(SEMICIRCLE, "'slv-*.at2'"));

/// Sample interval and accelerations in m/s2 of an AT2 file, read by four lines of this test.
fn at2(name: &str) -> (f64, Vec<f64>) {
    let text = fs::read_to_string(scenarios().join("records").join(name)).unwrap();
    let values = text.lines().skip(4).flat_map(str::split_whitespace);
    (
        0.02,
        values
            .map(|word| word.parse::<f64>().unwrap() * GRAVITY)
            .collect(),
    )
}

/// Housner's block, 4 m by 0.8 m, with straight lines between samples.
struct Housner<'a> {
    dt_s: f64,
    samples: &'a [f64],
    sign: f64,
}

const ALPHA_TAN: f64 = 0.2;

impl Housner<'_> {
    fn ground(&self, time_s: f64) -> f64 {
        let index = time_s / self.dt_s;
        let (whole, rest) = (index.floor() as usize, index.fract());
        match (self.samples.get(whole), self.samples.get(whole + 1)) {
            (Some(a), Some(b)) => self.sign * (a + (b - a) * rest),
            _ => 0.0,
        }
    }

    /// When it sways right (side 1) it turns clockwise, and ground that accelerates to the right pulls it back.
    fn slope(&self, time_s: f64, side: f64, theta: f64) -> f64 {
        let alpha = ALPHA_TAN.atan();
        let p2 = 0.75 * GRAVITY / (0.5 * 4.0_f64.hypot(0.8));
        let push = side * self.ground(time_s) / GRAVITY;
        -p2 * ((alpha - theta).sin() + push * (alpha - theta).cos())
    }

    /// A Runge-Kutta step.
    fn advance(&self, time_s: f64, side: f64, (x, v): (f64, f64), h: f64) -> (f64, f64) {
        let at = |h: f64, x: f64| self.slope(time_s + h, side, x);
        let (a1, b1) = (v, at(0.0, x));
        let (a2, b2) = (v + 0.5 * h * b1, at(0.5 * h, x + 0.5 * h * a1));
        let (a3, b3) = (v + 0.5 * h * b2, at(0.5 * h, x + 0.5 * h * a2));
        let (a4, b4) = (v + h * b3, at(h, x + h * a3));
        (
            x + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0,
            v + h * (b1 + 2.0 * b2 + 2.0 * b3 + b4) / 6.0,
        )
    }

    /// Its largest rotations to the right and left, with this many steps per sample, or `None` if it overturns. Impacts keep
    /// 1 - 1.5 sin^2 alpha of the rate.
    fn peaks(&self, parts: u32) -> Option<[f64; 2]> {
        let kept = 1.0 - 1.5 * ALPHA_TAN.atan().sin().powi(2);
        let step_s = self.dt_s / f64::from(parts);
        let (mut peaks, mut side, mut state) = ([0.0_f64; 2], 0.0, (0.0, 0.0));
        let steps = (u32::try_from(self.samples.len()).unwrap() + 500) * parts;
        for step in 0..steps {
            let mut time_s = f64::from(step) * step_s;
            if side == 0.0 {
                let push_g = -self.ground(time_s) / GRAVITY;
                if push_g.abs() <= ALPHA_TAN {
                    continue;
                }
                side = push_g.signum();
            }
            let mut left_s = step_s;
            while left_s > 1e-12 {
                let next = self.advance(time_s, side, state, left_s);
                if next.0 >= 0.0 {
                    state = next;
                    break;
                }
                let (mut low, mut high) = (0.0, left_s);
                for _ in 0..40 {
                    let middle = 0.5 * (low + high);
                    let below = self.advance(time_s, side, state, middle).0 < 0.0;
                    if below { high = middle } else { low = middle }
                }
                state = (0.0, -kept * self.advance(time_s, side, state, low).1);
                side = -side;
                time_s += low;
                left_s -= low;
                if state.1 < 1e-4 && self.ground(time_s).abs() < GRAVITY * ALPHA_TAN {
                    (side, state) = (0.0, (0.0, 0.0));
                    break;
                }
            }
            let index = usize::from(side < 0.0);
            peaks[index] = peaks[index].max(state.0);
            if state.0 > 1.5 {
                return None;
            }
        }
        Some(peaks)
    }
}

/// The displacement of a column is that of its centre. An integration that shares nothing with the program's has the same peaks, to
/// 0.2 %. Rocking amplifies small differences at every impact, so only peaks that do not depend on the steps of this integration are
/// compared.
#[test]
fn c8_7_1_2_1_9_peaks_of_a_column_are_those_of_housners_equation() {
    let found = of_slv(COLUMN, "'*.at2'");
    let alpha = ALPHA_TAN.atan();
    let displacement_m =
        |theta: f64| 0.5 * 4.0_f64.hypot(0.8) * (alpha.sin() - (alpha - theta).sin());
    let (mut compared, mut overturned) = (0, 0);
    for record in &found.records {
        let (dt_s, samples) = at2(&record.file);
        let by = |sign: f64, parts: u32| {
            let samples = &samples;
            Housner {
                dt_s,
                samples,
                sign,
            }
            .peaks(parts)
        };
        let [coarse, fine] = [40, 100].map(|parts| by(1.0, parts));
        let (Some(coarse), Some(fine)) = (coarse, fine) else {
            assert_eq!(coarse, fine);
            assert!(
                record.peaks.iter().all(|(_, peak)| peak.overturned),
                "{}",
                record.file
            );
            overturned += 1;
            continue;
        };
        // The other sign gives the mirror image, and the larger peak counts.
        let largest = |peaks: [f64; 2]| displacement_m(peaks[0].max(peaks[1]));
        // The peak is that of `run`, to the rounding error.
        let text = format!("{COLUMN}[ground.record]\nfile = '{}'\n", record.file);
        let scenario = read(folder(&text).path());
        let model = scenario.model().unwrap();
        let (ground, request) = (scenario.ground_motion(), scenario.request());
        let run = model.simulate(ground, &request, None).unwrap();
        let run_m = displacement_m(run.largest_rotation_rad());
        for (_, peak) in record.peaks.iter() {
            let ratio = peak.displacement_m / run_m;
            assert!((ratio - 1.0).abs() < 1e-12, "{} {ratio}", record.file);
        }
        let (coarse_m, fine_m) = (largest(coarse), largest(fine));
        if (coarse_m / fine_m - 1.0).abs() > 1e-3 {
            continue;
        }
        for (_, peak) in record.peaks.iter() {
            let ratio = peak.displacement_m / fine_m;
            assert!(
                (ratio - 1.0).abs() < 2e-3,
                "{} {peak:?} {fine_m}",
                record.file
            );
        }
        compared += 1;
    }
    assert!(compared >= 8 && overturned >= 1, "{compared} {overturned}");
    let restitution = (1.0 - 1.5 * alpha.sin().powi(2)).powi(2);
    assert!((found.sides[&Sway::Right].restitution.unwrap() / restitution - 1.0).abs() < 1e-12);
}

/// Sector of the ring between two angles from the left springing: mass per metre of depth and unit density, and centroid.
fn sector([from, to]: [f64; 2]) -> (f64, Vector2<f64>) {
    let (inner, outer) = (4.625_f64, 5.375_f64);
    let half = 0.5 * (to - from);
    let area = half * (outer.powi(2) - inner.powi(2));
    let reach = 2.0 / 3.0 * (outer.powi(3) - inner.powi(3)) / (outer.powi(2) - inner.powi(2))
        * half.sin()
        / half;
    let middle = 0.5 * (from + to);
    (
        area,
        Vector2::new(-reach * middle.cos(), reach * middle.sin()),
    )
}

/// After impacts other hinges are open; then the motion is computed from the angles of the bodies and sectors of the ring.
#[test]
fn c8_7_1_2_1_9_displacements_of_an_arch_after_impacts_are_those_of_its_bodies() {
    let names = ["slv-2.at2", "slv-3.at2", "slv-5.at2"];
    let found = of_slv(SEMICIRCLE, "['slv-2.at2', 'slv-3.at2', 'slv-5.at2']");
    let text = format!("{SEMICIRCLE}{DEMAND}");
    let participating_kg = check(folder(&text).path()).mechanisms[&Sway::Right].m_star_kg;
    for (name, record) in names.iter().zip(&found.records) {
        assert_eq!(record.file, *name);
        let scenario =
            read(folder(&format!("{SEMICIRCLE}[ground.record]\nfile = '{name}'\n")).path());
        let request = Request {
            end_s: scenario.ground_motion().end_s() + 10.0,
            output_step_s: 0.002,
            ..scenario.request()
        };
        let history = scenario
            .model()
            .unwrap()
            .history(scenario.ground_motion(), &request)
            .unwrap();
        let mut peaks = [0.0_f64; 2];
        let mut links = 0;
        // The phase and the displacement of the two samples before.
        let mut before = [(0, 0.0); 2];
        for sample in history.samples.iter() {
            let State::Rocking(sway) = sample.state else {
                continue;
            };
            let event = &history.events[sample.phase - 1];
            links = links.max(event.mechanism.unwrap());
            let angles: Vec<(f64, f64)> = event
                .hinges
                .iter()
                .map(|hinge| match hinge {
                    Hinge::Section { angle_rad, edge } => (
                        *angle_rad,
                        if *edge == Edge::Intrados {
                            4.625
                        } else {
                            5.375
                        },
                    ),
                    other => panic!("{other:?}"),
                })
                .collect();
            let at = |(angle, radius): (f64, f64)| {
                Vector2::new(-radius * angle.cos(), radius * angle.sin())
            };
            let turn = |body: usize| Rotation2::new(sample.rotations_rad[body]);
            let b = at(angles[0]) + turn(0) * (at(angles[1]) - at(angles[0]));
            let pivots = [
                (at(angles[0]), at(angles[0])),
                (at(angles[1]), b),
                (at(angles[3]), at(angles[3])),
            ];
            let moments = (0..3).map(|body| {
                let (area, centre) = sector([angles[body].0, angles[body + 1].0]);
                let (pivot, moved) = pivots[body];
                2000.0 * area * (moved + turn(body) * (centre - pivot) - centre).x
            });
            let shift_m = moments.sum::<f64>() * sway.sign() / participating_kg;
            let side = usize::from(sway == Sway::Left);
            // The vertex of the parabola through three samples of a half cycle.
            let [(first, one_m), (second, two_m)] = before;
            let bend_m = one_m - 2.0 * two_m + shift_m;
            if first == sample.phase && second == first && two_m >= one_m.max(shift_m) {
                let vertex_m = two_m - (one_m - shift_m).powi(2) / (8.0 * bend_m);
                peaks[side] = peaks[side].max(vertex_m);
            }
            before = [before[1], (sample.phase, shift_m)];
        }
        assert!(links > 20, "{links}");
        // Either sign of the record acts; the arch is symmetric.
        let peak_m = peaks[0].max(peaks[1]);
        for (_, peak) in record.peaks.iter() {
            assert!(
                (peak.displacement_m / peak_m - 1.0).abs() < 1e-6,
                "{name} {peak:?} {peak_m}"
            );
        }
    }
}

fn peaks(records: &[RecordPeaks], side: Sway) -> Vec<f64> {
    records
        .iter()
        .map(|record| record.peaks[&side].displacement_m)
        .collect()
}

/// Whether histories pass, as they are and with FC.
fn passes_of(histories: &Histories) -> [Option<bool>; 2] {
    [histories.passed, histories.passed_over_fc]
}

/// With seven records or more the mean counts, with fewer the largest; with FC and without. Records outside the model of four links never pass, and
/// a column has none.
#[test]
fn c8_7_1_2_1_9_and_7_3_5_the_mean_of_seven_or_the_largest_of_fewer() {
    let seven = &*SEVEN;
    assert!(seven.demand == ComparedPeak::Mean && passes_of(seven) == [None; 2]);
    assert!(
        seven
            .sides
            .values()
            .all(|own| own.records_outside_model == 7)
    );
    let column = of_slv(COLUMN, "'slv-*.at2'");
    assert!(column.demand == ComparedPeak::Mean && passes_of(&column) == [Some(true); 2]);
    assert!(
        column
            .sides
            .values()
            .all(|own| own.records_outside_model == 0)
    );
    for (side, own) in &seven.sides {
        let peaks_m = peaks(&seven.records, *side);
        let mean_m = peaks_m.iter().sum::<f64>() / 7.0;
        assert!((own.demand_m.unwrap() / mean_m - 1.0).abs() < 1e-12);
        // The mean scatters as the peaks do, over the root of their number; a bootstrap takes their own standard deviation.
        let count = peaks_m.len() as f64;
        let squares: f64 = peaks_m.iter().map(|peak_m| (peak_m - mean_m).powi(2)).sum();
        let error_m = squares.sqrt() / count;
        let [low_m, high_m] = own.mean_interval_m.unwrap();
        assert!(low_m < mean_m && mean_m < high_m);
        assert!(
            ((high_m - low_m) / (2.0 * 1.96 * error_m) - 1.0).abs() < 0.2,
            "{low_m} {high_m} {error_m}"
        );
        assert!((own.capacity_m / (0.4 * own.d0_m) - 1.0).abs() < 1e-12);
        assert!((own.capacity_over_fc_m * 1.35 / own.capacity_m - 1.0).abs() < 1e-12);
        assert_eq!(
            [own.records_beyond_d0, own.records_beyond_d0_over_fc],
            [0, 0]
        );
        // The worst of them exceeds the capacity, but the mean does not.
        assert!(
            peaks(&seven.records, *side)
                .iter()
                .any(|peak_m| *peak_m > own.capacity_m)
        );
    }
    for (records, passes) in [
        ("['slv-2.at2', 'slv-4.at2', 'slv-6.at2']", [true, true]),
        ("['slv-2.at2', 'slv-3.at2', 'slv-4.at2']", [true, false]),
        (
            "['slv-1.at2', 'slv-2.at2', 'slv-4.at2', 'slv-5.at2']",
            [false, false],
        ),
    ] {
        let few = of_slv(SEMICIRCLE, records);
        let own = few.sides[&Sway::Right];
        let largest_m = peaks(&few.records, Sway::Right)
            .into_iter()
            .fold(0.0, f64::max);
        assert!(few.demand == ComparedPeak::Largest && own.demand_m == Some(largest_m));
        assert_eq!(own.mean_interval_m, None);
        let within =
            [own.capacity_m, own.capacity_over_fc_m].map(|allowed_m| largest_m <= allowed_m);
        assert_eq!(
            (passes_of(&few), within),
            (passes.map(|passed| (!passed).then_some(false)), passes),
            "{records}"
        );
    }
}

/// One record beyond d0 is one too many, whatever the mean; so is one that overturns.
#[test]
fn c8_7_1_2_1_9_d0_is_exceeded_in_no_record() {
    let beyond = of_slv(SEMICIRCLE, "['slv-*.at2', 'wave-6.at2']");
    let own = beyond.sides[&Sway::Right];
    let over = |limit_m: f64| {
        peaks(&beyond.records, Sway::Right)
            .into_iter()
            .filter(|peak_m| *peak_m > limit_m)
            .count()
    };
    assert_eq!(own.records_beyond_d0, over(own.d0_m));
    assert_eq!(own.records_beyond_d0_over_fc, over(own.d0_m / 1.35));
    assert!(own.records_beyond_d0 == 1 && !beyond.records[7].peaks[&Sway::Right].overturned);
    assert_eq!(passes_of(&beyond), [Some(false); 2]);
    let slv = of_slv(COLUMN, "['slv-*.at2', 'wave-6.at2']").sides[&Sway::Right];
    assert!(slv.demand_m.is_some());
    // With more of the small ones the mean is allowed, but the check still does not pass.
    let many: Vec<String> = (0..30).map(|i| format!("'small-{i}.csv'")).collect();
    let text = format!(
        "{SEMICIRCLE}{DEMAND}[verify]\nslv_records = ['wave-6.at2', {}]\nunit = 'g'\n",
        many.join(", ")
    );
    let folder = folder(&text);
    for i in 0..30 {
        fs::write(
            folder.path().join(format!("small-{i}.csv")),
            "0,0.01\n0.1,0.02\n0.2,0.0\n",
        )
        .unwrap();
    }
    let check = check(folder.path());
    let histories = check.states[&LimitState::Slv].histories.as_ref();
    let own = histories.unwrap().sides[&Sway::Right];
    assert!(own.demand_m.unwrap() < own.capacity_over_fc_m);
    assert_eq!([own.passed, own.passed_over_fc], [Some(false); 2]);
    let overturns = of_slv(SEMICIRCLE, "['slv-2.at2', 'slv-4.at2', 'wave-1.at2']");
    assert_eq!(overturns.sides[&Sway::Right].demand_m, None);
    assert_eq!(passes_of(&overturns), [Some(false); 2]);
    assert!(overturns.sides[&Sway::Right].records_beyond_d0 >= 1);
}

/// The load makes the sides differ; in the mirror image they are exchanged.
#[test]
fn c8_7_1_2_1_9_both_sides_of_an_uneven_arch() {
    let arch = "[pointed_arch]\nspan_m = 6\nrise_m = 4\nthickness_m = 0.6\nvoussoirs = 14\n\
        [[load]]\nmass_kg = 1500\nx_m = 1\n";
    let records = "['wave-3.at2', 'wave-7.at2', 'slv-5.at2']";
    let own = of_slv(arch, records);
    let image = of_slv(&arch.replace("x_m = 1", "x_m = -1"), records);
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * a.abs().max(b.abs());
    let mut moved = 0;
    for (a, b) in own.records.iter().zip(&image.records) {
        for (side, a) in a.peaks.iter() {
            let b = &b.peaks[&side.opposite()];
            assert_eq!(a.overturned, b.overturned);
            assert!(
                a.overturned || near(a.displacement_m, b.displacement_m),
                "{a:?} {b:?}"
            );
            moved += usize::from(a.displacement_m > 1e-4);
        }
    }
    assert!(moved >= 2);
    assert!(
        near(own.sides[&Sway::Right].d0_m, image.sides[&Sway::Left].d0_m)
            && !near(own.sides[&Sway::Right].d0_m, own.sides[&Sway::Left].d0_m)
    );
}

/// Twice the motion has twice the spectrum; the records of the repository fit that of SLV.
#[test]
fn par_3_2_3_6_the_mean_spectrum_of_the_records() {
    assert_eq!(SEVEN.mean_spectrum.fits, Some(true));
    let text = format!("{COLUMN}{DEMAND}[verify]\nunit = 'g'\nslv_records = 'twice-*.csv'\n");
    let folder = folder(&text);
    for number in 1..=3 {
        let (dt_s, samples) = at2(&format!("slv-{number}.at2"));
        let rows = samples.iter().zip(0..).map(|(sample, index)| {
            format!("{},{}\n", dt_s * f64::from(index), 2.0 * sample / GRAVITY)
        });
        fs::write(
            folder.path().join(format!("twice-{number}.csv")),
            rows.collect::<String>(),
        )
        .unwrap();
    }
    let once = of_slv(COLUMN, "['slv-1.at2', 'slv-2.at2', 'slv-3.at2']");
    let check = check(folder.path());
    let twice = check.states[&LimitState::Slv].histories.as_ref().unwrap();
    let ratios = |one: &Histories| {
        let spectrum = one.mean_spectrum;
        [
            spectrum.least_ratio.unwrap(),
            spectrum.largest_ratio.unwrap(),
        ]
    };
    for (a, b) in ratios(&once).into_iter().zip(ratios(twice)) {
        assert!((b / a - 2.0).abs() < 1e-6, "{a} {b}");
    }
    assert!(words(&check).contains("§ 3.2.3.6"));
}

#[test]
fn records_that_make_no_check_are_refused() {
    let few = "slv_records = ['slv-1.at2', 'slv-2.at2']\n";
    for (structure, verify, words) in [
        (
            COLUMN,
            few,
            &[
                "a.toml:16:15",
                "2 records",
                "at least 3",
                "NTC 2018, § 7.3.5",
            ][..],
        ),
        (
            COLUMN,
            "slv_records = 'none-*.at2'\n",
            &["a.toml:16:15", "matches no file"],
        ),
        (
            COLUMN,
            "sides = 'left'\nslv_records = 'slv-*.at2'\n",
            &["a.toml:17:15", "sides = \"both\""],
        ),
        (
            COLUMN,
            "sld_records = 'slv-*.at2'\n",
            &["unknown key `sld_records`"],
        ),
        (COLUMN, "unit = 'g'\n", &["unknown key `unit`"]),
        (
            COLUMN,
            "slv_records = 'zero-*.csv'\nunit = 'g'\n",
            &["zero throughout"],
        ),
        (
            "[column]\nheight_m = 4\nwidth_m = 0.8\ndrums = 5\n[free_hinges]\n",
            "slv_records = 'slv-*.at2'\n",
            &["histories of slv_records are not possible", "drums"],
        ),
    ] {
        let demand = DEMAND.replace(
            "[demand.slv]",
            "[demand.sld]\nag_g = 0.1\nf0 = 2.4\ntc_star_s = 0.3\n[demand.slv]",
        );
        let demand = if structure == COLUMN {
            DEMAND.to_owned()
        } else {
            demand
        };
        let folder = folder(&format!("{structure}{demand}[verify]\n{verify}"));
        for number in 1..=3 {
            fs::write(
                folder.path().join(format!("zero-{number}.csv")),
                "0,0\n1,0\n",
            )
            .unwrap();
        }
        refused(folder.path(), &["verify", "a.toml"], words);
    }
    let without = DEMAND.split_once("[demand.slc]").unwrap().0;
    let folder = folder(&format!(
        "{COLUMN}{without}[verify]\nslc_records = 'slv-*.at2'\n"
    ));
    refused(
        folder.path(),
        &["verify", "a.toml"],
        &["a.toml:12:15", "[demand.slc]"],
    );
    assert!(!matches!(
        verify(&Scenario::parse(COLUMN, "a").unwrap()),
        Err(VerifyError::Histories { .. })
    ));
}

/// Histories at both limit states appear in words, JSON and page, resolve and read back; with spectra by points no clause is cited.
#[test]
fn words_json_and_page_agree_on_histories() {
    let text = format!(
        "{SEMICIRCLE}{DEMAND}[verify]\nslv_records = 'slv-*.at2'\nslc_records = ['wave-1.at2', 'wave-3.at2', 'wave-6.at2']\n"
    );
    let folder = folder(&text);
    let scenario = read(folder.path());
    fs::write(folder.path().join("b.toml"), scenario.to_toml()).unwrap();
    assert_eq!(
        Scenario::read(&folder.path().join("b.toml")).unwrap(),
        scenario
    );
    let said = printed(folder.path(), &["verify", "a.toml", "--out", "out"]);
    let json = fs::read_to_string(folder.path().join("out/verify.json")).unwrap();
    let data: Value = serde_json::from_str(&json).unwrap();
    let slv = &data["states"]["slv"]["histories"];
    let mean_m = slv["right"]["demand_m"].as_f64().unwrap();
    let (_, mean) = said.split_once("mean of 7 peaks ").unwrap();
    shows(mean, &[mean_m]);
    let slc = &data["states"]["slc"]["histories"];
    assert!(slc["right"]["demand_m"].is_null() && slc["records"][0]["right"]["peak_m"].is_null());
    assert_eq!(
        (&slc["passed"], &slv["passed_over_fc"]),
        (&false.into(), &Value::Null)
    );
    assert!(
        said.contains(": no answer: outside the model of four links\n"),
        "{said}"
    );
    let italian = [
        "verify",
        "a.toml",
        "--set",
        "verify.language=it",
        "--out",
        "it",
    ];
    let italian = printed(folder.path(), &italian);
    assert!(
        italian.contains(": senza esito: fuori dal modello di quattro cerniere\n"),
        "{italian}"
    );
    // The check by displacement decides the verdict of the state.
    assert_eq!(data["verdict"]["slv"], "not_passed");
    let mut decisions = data["decisions"].as_array().unwrap().iter();
    assert!(decisions.any(|one| {
        one["text"]
            .as_str()
            .unwrap()
            .contains("four-link mechanisms")
    }));
    let page = folder.path().join("out/verify.html");
    let html = fs::read_to_string(&page).unwrap();
    assert!(html.contains("C8.7.1.2.1.9") && !html.contains("omplian"));
    let script = browser::DATA_ARE_IN_THE_JSON.to_owned() + "
const tables = [...document.querySelectorAll('#checks table')].filter((table) => table.textContent.includes('CRC'));
for (const [index, state] of ['slv', 'slc'].entries()) {
  const histories = data.states[state].histories;
  const rows = [...tables[index].querySelectorAll('tbody tr')];
  verify(rows.length === histories.records.length, `${state} rows`);
  rows.forEach((row, number) => {
    const { file, crc32, right, left } = histories.records[number];
    const [name, , toRight, toLeft] = [...row.children].map((cell) => cell.textContent);
    verify(name === `${file} CRC ${crc32}`, name);
    for (const [text, peak] of [[toRight, right], [toLeft, left]]) {
      verify(text === (peak.overturned ? 'overturns' : peak.peak_m.toFixed(5)), `${file} ${text}`);
    }
  });
  const shown = [...document.querySelectorAll('#result tr')].find((row) => row.textContent.includes('histories') &&
    row.textContent.startsWith(state.toUpperCase()));
  const word = { null: { null: 'no answer: outside the model of four links' }, false: { true: 'passed without FC only', false: 'not passed' } };
  verify(shown.lastElementChild.textContent === word[histories.passed_over_fc][histories.passed], state);
}
";
    browser::assert_checked(&page, &script, &json, &[], 100);
}

/// The commands in docs/verify.md print the output shown there, and the rows of its table equal those of the JSON.
#[test]
fn commands_print_the_output_shown_in_docs_verify() {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(scenarios(), folder.path().join("scenarios")).unwrap();
    assert_eq!(
        assert_shown_output_is_printed("docs/verify.md", folder.path()),
        6
    );
    let json = folder.path().join("results/semicircle-verify/verify.json");
    let json: Value = serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap();
    let slv = &json["states"]["slv"];
    let number = |value: &Value| value.as_f64().unwrap();
    let (linear, displacement) = (&slv["right"]["simplified"], &slv["right"]["displacement"]);
    let histories = &slv["histories"]["right"];
    let expected = [
        [
            number(&linear["ag_capacity_g"]),
            number(&linear["ag_g"]),
            number(&linear["zeta_e"]),
        ],
        [
            number(&displacement["capacity_m"]),
            number(&displacement["demand_m"]),
            number(&displacement["zeta_e"]),
        ],
        [
            number(&histories["capacity_over_fc_m"]),
            number(&histories["demand_m"]),
            number(&histories["capacity_over_fc_m"]) / number(&histories["demand_m"]),
        ],
    ];
    let passed = [
        &linear["passed"],
        &displacement["passed"],
        &histories["passed_over_fc"],
    ];
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/verify.md");
    let page = fs::read_to_string(page).unwrap();
    let (_, table) = page.split_once("| SLV, to either side |").unwrap();
    for ((line, expected), passed) in table.lines().skip(2).zip(expected).zip(passed) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        assert_eq!(cells[2], format!("{:.4}", expected[0]), "{line}");
        assert_eq!(cells[3], format!("{:.4}", expected[1]), "{line}");
        assert_eq!(cells[4], format!("{:.3}", expected[2]), "{line}");
        let word = match passed.as_bool() {
            Some(true) => "passed",
            Some(false) => "not passed",
            None => "no answer: outside the model",
        };
        assert_eq!(cells[5], word, "{line}");
    }
}

/// A history that ends with too much energy for a verdict does not pass silently: words, page and JSON say so. A record that
/// overturns the structure decides all the same. Before a wall below its top, energy does not prove that a column survives.
#[test]
fn histories_without_a_verdict_do_not_pass() {
    let text = format!(
        "[column]\nheight_m = 20\nwidth_m = 1.6\n[column.back]\nside = 'left'\nheight_m = 15\nrestitution = 0.999\n{DEMAND}[verify]\nslv_records = ['slv-1.at2', 'slv-2.at2', 'slv-3.at2']\n"
    );
    let folder = folder(&text);
    let said = printed(folder.path(), &["verify", "a.toml", "--out", "out"]);
    let json = fs::read_to_string(folder.path().join("out/verify.json")).unwrap();
    let data: Value = serde_json::from_str(&json).unwrap();
    let slv = &data["states"]["slv"]["histories"];
    let incomplete = slv["incomplete"].as_u64().unwrap();
    assert!(incomplete > 0, "{slv}");
    let html = fs::read_to_string(folder.path().join("out/verify.html")).unwrap();
    let warnings = data["warnings"].as_array().unwrap();
    let mut warnings = warnings.iter().map(|warning| warning.as_str().unwrap());
    let counts = [incomplete.to_string(), "3".to_owned()];
    let warning =
        warnings.find(|warning| skeleton(warning).1.starts_with(&[&*counts[0], &counts[1]]));
    let warning = warning.unwrap_or_else(|| panic!("{}", data["warnings"]));
    assert!(said.contains(warning) && html.contains(warning), "{said}");
    // The wall is on the left.
    let side = "right";
    assert!(slv[side]["demand_m"].is_null() && slv[side]["passed"] != true);
    assert!(
        slv["records"]
            .as_array()
            .unwrap()
            .iter()
            .any(|record| record[side]["incomplete"] == true)
    );
}
