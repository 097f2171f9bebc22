//! Thresholds along a range of values of one key, and overturning without impact: compared with closed forms, with other programs, with
//! similar structures and with single histories; and the command.

use std::f64::consts::PI;
use std::fs;

use crate::common::program::{done, files, printed, refused};
use crate::common::prose::golden;
use crate::common::results::Table;
use crate::common::{ARCH, COLUMN, GRAVITY, parsed};
use archrock::studies::Study as _;
use archrock::studies::threshold::{Along, AlongOptions, AlongRow, Factors, KeyRange};
use archrock::{Outcome, Pulse, Request, Sway};

/// The rows along a range of equally spaced values, such as `ground.ricker.duration_s=1..2:3`.
fn rows(text: &str, along: &str, factors: Factors) -> Vec<AlongRow> {
    let scenario = parsed(text);
    let options = AlongOptions {
        along: along.parse().unwrap(),
        factors,
        no_impact: true,
    };
    let study = Along::of(&scenario, options).unwrap();
    (0..study.count())
        .flat_map(|index| study.rows(&[index]))
        .collect()
}

/// The least factors that overturn without impact, for some durations of a pulse.
pub fn without_impact(text: &str, kind: &str, durations_s: &[f64]) -> Vec<f64> {
    // With so long a step the search for an edge with impacts computes only the ends of the range.
    let factors = Factors::new(1e-3, 1e3, 1.0).unwrap();
    let least = |duration_s: &f64| {
        let along = format!(
            "ground.{kind}.duration_s={duration_s:?}..{:?}:2",
            2.0 * duration_s
        );
        rows(text, &along, factors)
            .remove(0)
            .no_impact
            .unwrap()
            .unwrap()
            .unwrap()
    };
    durations_s.iter().map(least).collect()
}

fn pulse(kind: &str) -> String {
    format!("[ground.{kind}]\namplitude_g = 1.0\nduration_s = 1.0\n")
}

/// Least accelerations over `g A_L` without impact for a column of slenderness `atan(alpha)`, at these sizes `p t_p`.
fn of_column(kind: &str, alpha: f64, p_t: &[f64]) -> Vec<f64> {
    let width_m = 2.0 * alpha;
    let text = format!(
        "[column]\nheight_m = 2.0\nwidth_m = {width_m}\n{}",
        pulse(kind)
    );
    let p = (0.75 * GRAVITY / (0.5 * 2.0_f64.hypot(width_m))).sqrt();
    let durations_s: Vec<f64> = p_t.iter().map(|p_t| p_t / p).collect();
    let found = without_impact(&text, kind, &durations_s);
    found.into_iter().map(|least_g| least_g / alpha).collect()
}

/// Slender: `cosh(p t) = 1 + 1 / (2 x (x - 1))` (Housner), solved for `x`. Finite slenderness changes that by
/// a small multiple of its square.
#[test]
fn rectangular_pulses_on_slender_columns_agree_with_housner() {
    let p_t = [0.05, 0.3, 1.0, 2.5, 6.0];
    let miss = |alpha: f64| -> Vec<f64> {
        let simulated = of_column("rectangular", alpha, &p_t);
        let pairs = simulated.iter().zip(p_t);
        pairs
            .map(|(simulated, p_t)| {
                let x = 0.5 + (0.25 + 0.5 / (p_t.cosh() - 1.0)).sqrt();
                simulated / x - 1.0
            })
            .collect()
    };
    let (coarse, fine) = (miss(0.02), miss(0.01));
    for (index, p_t) in p_t.into_iter().enumerate() {
        assert!(fine[index].abs() < 1e-4, "{p_t}: {}", fine[index]);
        // The longest pulse needs little more than the onset of the column, so the error is that of rounding.
        if p_t < 6.0 {
            let ratio = coarse[index] / fine[index];
            assert!((3.9..4.1).contains(&ratio), "{p_t}: {ratio}");
        }
    }
}

/// Only the impulse matters: `x p t -> 1`. The closed form continues `1 + p t / 2 - (p t)^2 (1/12 - 1/8)...`.
#[test]
fn short_pulses_overturn_by_their_impulse() {
    let p_t = [1e-2, 0.03];
    for (x, p_t) in of_column("rectangular", 1e-3, &p_t).iter().zip(p_t) {
        let miss = x * p_t - 1.0 - 0.5 * p_t;
        // The last term is the effect of a slenderness of a thousandth.
        assert!(miss.abs() < 0.1 * p_t * p_t + 1e-6, "{p_t}: {miss}");
    }
}

/// Half sine of the frequency `w = b p`, as derived in `tests/motion/column.rs`: `sqrt(x^2 - 1) + x exp(-(pi - asin(1/x)) / b) =
/// b`.
#[test]
fn half_sines_on_slender_columns_agree_with_the_linear_solution() {
    let b = [0.8, 1.5, 3.0, 6.0];
    let simulated = of_column("half_sine", 0.01, &b.map(|b| PI / b));
    for (simulated, b) in simulated.iter().zip(b) {
        let excess = |x: f64| (x * x - 1.0).sqrt() + x * (-(PI - (1.0 / x).asin()) / b).exp() - b;
        // Small errors of x follow from the residual by Newton's rule.
        let slope = (excess(simulated + 1e-6) - excess(simulated - 1e-6)) / 2e-6;
        let miss = excess(*simulated) / slope / simulated;
        assert!(miss.abs() < 1e-4, "{b}: {miss}");
    }
}

/// Amplitudes in g from an independent integration (relative tolerance 1e-10), printed with three digits.
#[test]
fn step_pairs_overturn_seven_voussoirs_at_independently_computed_amplitudes() {
    let arch = "[arch]\nmean_radius_m = 10.0\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 7\n";
    let text = format!("{arch}{}", pulse("step_pair"));
    let found = without_impact(&text, "step_pair", &[0.2, 0.5, 1.0]);
    for (found_g, printed_g) in found.iter().zip([3.066, 0.820, 0.465]) {
        assert!(
            (found_g - printed_g).abs() < 5.1e-4,
            "{found_g} {printed_g}"
        );
    }
}

/// Pulses with side lobes overturn without impact within narrow windows, far below the amplitudes that surely do: one
/// lobe just carries the column over, and the next does not catch it. The windows were found by an integration
/// that shares nothing with this one (of order eight, relative tolerance 1e-11), and by maps of 300 amplitudes.
#[test]
fn narrow_windows_are_found() {
    for (kind, more, duration_s, low_g, high_g) in [
        ("ricker", "", 1.7494, 0.4422, 0.4426),
        ("antisymmetric_ricker", "", 1.2228, 0.70, 0.735),
        ("gabor", "gamma = 3\nphase_deg = 40\n", 0.9595, 0.70, 0.741),
        (
            "mavroeidis_papageorgiou",
            "gamma = 3\nphase_deg = 60\n",
            2.375,
            0.43,
            0.4425,
        ),
        (
            "windowed_sine",
            "cycles = 4\nphase_deg = 30\n",
            1.881,
            0.70,
            0.7165,
        ),
    ] {
        let found_g = without_impact(
            &format!("{COLUMN}{}{more}", pulse(kind)),
            kind,
            &[duration_s],
        )[0];
        assert!(low_g < found_g && found_g < high_g, "{kind}: {found_g}");
    }
}

/// An arch four times as large under pulses twice as long, and one on the moon, have similar motions at the same ratio of
/// acceleration to gravity.
#[test]
fn similar_structures_have_similar_thresholds() {
    let factors = Factors::new(0.1, 30.0, 0.3).unwrap();
    let text = |radius_m: f64, more: &str| {
        format!(
            "{}{}{more}",
            ARCH.replace("5.0", &radius_m.to_string()),
            pulse("one_cosine")
        )
    };
    let along = |slower: f64| {
        format!(
            "ground.one_cosine.duration_s={:?}..{:?}:3",
            0.4 * slower,
            1.2 * slower
        )
    };
    let here = rows(&text(5.0, ""), &along(1.0), factors);
    let larger = rows(&text(20.0, ""), &along(2.0), factors);
    let moon = "[simulation]\ngravity_m_s2 = 1.62\n";
    let lighter = rows(&text(5.0, moon), &along((9.81_f64 / 1.62).sqrt()), factors);
    for other in [larger, lighter] {
        for (here, other) in here.iter().zip(&other) {
            let least = |row: &AlongRow| row.no_impact.clone().unwrap().unwrap().unwrap();
            assert!((least(here) / least(other) - 1.0).abs() < 1e-7);
            let edge = |row: &AlongRow| row.edge.clone().unwrap();
            let [one, two] = [here, other].map(|row| edge(row).factor.unwrap());
            // Both are bisected to 1e-4.
            assert!((one / two - 1.0).abs() < 2e-4, "{one} {two}");
            // With impacts it overturns at weaker motions than without.
            assert!(one <= least(here) * 1.0001);
        }
    }
}

/// Just above the edge the first fall overturns, just below it does not, in single histories.
#[test]
fn histories_change_at_the_edge_without_impact() {
    let text = format!("{ARCH}{}", pulse("one_sine"));
    let model = parsed(&text).mechanisms().unwrap();
    for duration_s in [0.4, 0.9] {
        let edge_g = without_impact(&text, "one_sine", &[duration_s])[0];
        let at = |amplitude_g: f64| {
            let ground = Pulse::OneSine
                .lasting_s(duration_s)
                .horizontal_m_s2(9.81 * amplitude_g);
            let request = Request {
                end_s: 100.0,
                ..Request::default()
            };
            let summary = model.simulate(&ground.unwrap(), &request, None).unwrap();
            (summary.outcome, summary.impacts)
        };
        assert_eq!(
            at(edge_g * (1.0 + 1e-6)),
            (Outcome::Overturned(Sway::Left), 0)
        );
        let (below, impacts) = at(edge_g * (1.0 - 1e-6));
        assert!(impacts > 0 || !matches!(below, Outcome::Overturned(_)));
    }
}

const RANGE: &str = "arch.mean_radius_m=4..7:7";

#[test]
fn parts_threads_and_interruptions_change_nothing() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let text = format!("{ARCH}[ground.one_cosine]\namplitude_g = 0.5\nduration_s = 0.8\n");
    fs::write(at.join("s.toml"), text).unwrap();
    let command = |more: &[&'static str]| {
        let all = [
            "threshold",
            "s.toml",
            "--along",
            RANGE,
            "--no-impact",
            "--stride",
            "0.2",
        ];
        [&all[..], more].concat()
    };
    let said = printed(at, &command(&["--threads", "1"]));
    golden("threshold-along", &said);
    let whole = files(&at.join("results/s"));
    let names: Vec<&str> = whole.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "threshold_along.csv",
            "threshold_along.html",
            "threshold_along.json",
            "threshold_along.svg"
        ]
    );
    let table = String::from_utf8(whole["threshold_along.csv"].clone()).unwrap();
    assert!(table.starts_with(
        "arch.mean_radius_m,survives_up_to_factor,survives_up_to_g,overturns_from_factor,"
    ));
    assert_eq!(table.lines().count(), 8);

    for part in ["1/3", "3/3", "2/3"] {
        done(at, &command(&["--out", "parts", "--shard", part]));
    }
    let parts = [2, 1, 3].map(|part| format!("parts/threshold_along-{part}-of-3.part"));
    let merge: Vec<&str> = ["merge", "--out", "merged"]
        .into_iter()
        .chain(parts.iter().map(String::as_str))
        .collect();
    done(at, &merge);
    assert_eq!(files(&at.join("merged")), whole);
    // Parts of other factors do not belong to these.
    let other = [
        "threshold",
        "s.toml",
        "--along",
        RANGE,
        "--shard",
        "1/3",
        "--resume",
        "--out",
        "parts",
    ];
    refused(at, &other, &["belongs to another study: the options"]);

    // The file looks as if the program had been killed while writing its third row.
    fs::create_dir(at.join("killed")).unwrap();
    let part = fs::read_to_string(at.join(&parts[1])).unwrap();
    let killed = part.replace("\"1/3\"", "\"1/1\"");
    let cut = killed.trim_end().len() - 5;
    fs::write(at.join("killed/threshold_along.part"), &killed[..cut]).unwrap();
    refused(
        at,
        &command(&["--out", "killed"]),
        &["2 cases of this study"],
    );
    printed(at, &command(&["--out", "killed", "--resume"]));
    assert_eq!(files(&at.join("killed")), whole);
}

/// Words never say "no factor overturns the structure" of values without a verdict, or whose ground falls freely from some factor on; such
/// values are counted. The ground falls as fast as a free body from 1 / 0.7 times these motions on.
#[test]
fn values_without_a_verdict_or_with_falling_ground_are_counted() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    // The run ends while the ground moves.
    let cut = format!(
        "{ARCH}{}[simulation]\nduration_s = 0.5\n",
        pulse("one_cosine")
    );
    fs::write(at.join("cut.toml"), cut).unwrap();
    let along = [
        "threshold",
        "cut.toml",
        "--along",
        "arch.mean_radius_m=4..5:2",
    ];
    let said = printed(at, &along);
    assert!(
        said.starts_with("  2 values of arch.mean_radius_m from 4 to 5: no verdict at 2 values"),
        "{said}"
    );
    let falling = "[column]\nheight_m = 4.0\nwidth_m = 2.0\n[ground.one_sine]\namplitude_g = 0.1\n\
                   vertical_amplitude_g = 0.7\nduration_s = 0.5\n";
    fs::write(at.join("falling.toml"), falling).unwrap();
    let along = "threshold falling.toml --from 0.5 --stride 0.3 --along column.width_m=2..3:2";
    let said = printed(at, &along.split(' ').collect::<Vec<_>>());
    assert!(
        said.contains("not known beyond") && said.contains("at 2 values"),
        "{said}"
    );
    assert!(!said.contains("no factor"), "{said}");
    let rows = Table::read(at.join("results/falling/threshold_along.csv")).rows;
    for row in &rows {
        assert_eq!(
            (&*row["failed_beyond"], &*row["overturns_from_factor"]),
            ("true", "")
        );
        let tried_to = row.number("tried_to_factor");
        assert_eq!(row.number("survives_up_to_factor"), tried_to);
        assert!(
            tried_to < 1.0 / 0.7 && 1.3 * tried_to >= 1.0 / 0.7,
            "{tried_to}"
        );
    }
}

#[test]
fn faults_are_refused_with_a_remedy() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), format!("{ARCH}{}", pulse("ricker"))).unwrap();
    let along = |range: &'static str| ["threshold", "s.toml", "--along", range];
    for range in [
        "arch.depth_m",
        "arch.depth_m=1..2",
        "arch.depth_m=2..1:3",
        "arch.depth_m=1..2:1",
    ] {
        refused(at, &along(range), &["must be TABLE.KEY=FROM..TO:COUNT"]);
        assert!(range.parse::<KeyRange>().is_err());
    }
    let unknown = "no value of `arch.depht_m` makes a valid scenario: unknown key `depht_m`";
    refused(at, &along("arch.depht_m=1..2:2"), &["s.toml: ", unknown]);
    let two = [
        &along(RANGE)[..],
        &["--hinges", "four,free", "--set", "arch.voussoirs=7"],
    ]
    .concat();
    refused(at, &two, &["--along takes one model"]);
    let free = [
        &along(RANGE)[..],
        &[
            "--no-impact",
            "--hinges",
            "free",
            "--set",
            "arch.voussoirs=7",
        ],
    ]
    .concat();
    refused(at, &free, &["--no-impact is for four links and columns"]);
    refused(at, &["threshold", "s.toml", "--no-impact"], &["--along"]);
    fs::write(at.join("s.toml"), ARCH).unwrap();
    refused(
        at,
        &along(RANGE),
        &["s.toml: a threshold needs a ground motion"],
    );
    assert!(!at.join("results").exists());
}

/// Where the smallest factor overturns the structure, its threshold is an upper bound, in words as in the table: three times 0.5 g here.
#[test]
fn an_upper_bound_reads_at_most() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{COLUMN}[ground.half_sine]\namplitude_g = 0.5\nduration_s = 0.5\n");
    fs::write(folder.path().join("s.toml"), text).unwrap();
    let along = "column.width_m=0.30..0.40:2";
    let words = |range: &[&str]| {
        let arguments = [&["threshold", "s.toml", "--along", along][..], range].concat();
        printed(folder.path(), &arguments)
    };
    let bound = words(&["--from", "3", "--to", "4"]);
    assert!(
        bound.contains("certainly overturns from at most 1.500 g (lowest, at 0.3)"),
        "{bound}"
    );
    let known = words(&["--from", "0.1", "--to", "4", "--stride", "0.2"]);
    assert!(known.contains("certainly overturns from "), "{known}");
    assert!(!known.contains("at most"), "{known}");
}

/// Names of earlier versions are errors that name what replaces them.
#[test]
fn replaced_names_have_a_successor() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(
        at.join("s.toml"),
        format!("{ARCH}{}[spectrum]\np_t = [1]\n", pulse("ricker")),
    )
    .unwrap();
    let map = "[map]\nspread = true\nduration_s = [1]\namplitude_g = [1]\n";
    fs::write(at.join("m.toml"), format!("{ARCH}{}{map}", pulse("ricker"))).unwrap();
    for (arguments, successor) in [
        (
            &["spectrum", "s.toml"][..],
            "--along TABLE.KEY=FROM..TO:COUNT",
        ),
        (&["chart", "s.toml"], "python/examples/shapes_of_arches.py"),
        (&["run", "s.toml", "--no-spread"], "`--no-repeat`"),
        (
            &["map", "s.toml", "--no-impact"],
            "--along TABLE.KEY=FROM..TO:COUNT",
        ),
        (
            &["merge", "--no-impact", "a.part"],
            "--along TABLE.KEY=FROM..TO:COUNT",
        ),
        (
            &["check", "s.toml"],
            "s.toml:8:2: `spectrum` in the scenario was removed: `archrock threshold SCENARIO --along",
        ),
        (
            &["map", "m.toml"],
            "m.toml:9:1: `spread` in [map] is now called `repeat`",
        ),
    ] {
        let message = refused(at, arguments, &[successor]);
        assert!(!message.contains("\n\n\n"), "{message}");
    }
}
