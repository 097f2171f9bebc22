//! Overturning spectra compared with closed forms, similarity, and single histories; and the command.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use crate::common::ARCH;
use crate::common::parsed;
use crate::program::{done, files, printed, refused};
use archrock::output::Figure;
use archrock::studies::runner::Study as _;
use archrock::studies::spectrum::picture::draw;
use archrock::studies::spectrum::{NoSpectrum, OverturningSpectrum, PointRow, StructureKind};
use archrock::{GroundMotion, MechanismModel, Outcome, Pulse, Request, Scenario, Sway};

fn pulse(kind: &str) -> String {
    format!("[ground.{kind}]\namplitude_g = -1.0\nduration_s = 1.0\n")
}

/// All points of a scenario.
fn spectrum(text: &str) -> Vec<PointRow> {
    let scenario = parsed(text);
    let points = OverturningSpectrum::new(&scenario).unwrap();
    (0..points.count()).map(|index| points.row(index)).collect()
}

/// Least accelerations without impact for a column of slenderness `atan(alpha)` under a pulse. The only acceleration
/// tried moves nothing.
fn without_impact(kind: &str, alpha: f64, p_t: &[f64]) -> Vec<f64> {
    let text = format!(
        "[column]\nheight_m = 2.0\nwidth_m = {}\n{}[spectrum]\np_t = {p_t:?}\n\
         acceleration_over_incipient = [0.5]\n",
        2.0 * alpha,
        pulse(kind)
    );
    let points = spectrum(&text);
    assert_eq!(points.len(), p_t.len());
    let given = points.iter().zip(p_t);
    given
        .map(|(point, p_t)| {
            assert!(point.structure == StructureKind::Column && point.p_t == *p_t);
            // The least is larger than the one tried.
            assert_eq!(point.minimum, None);
            point.no_impact_over_incipient.unwrap()
        })
        .collect()
}

/// Slender: `cosh(p t) = 1 + 1 / (2 x (x - 1))` (Housner), solved for `x`. Finite slenderness changes that by
/// a small multiple of its square.
#[test]
fn rectangular_pulses_and_slender_columns_are_housners() {
    let p_t = [0.05, 0.3, 1.0, 2.5, 6.0];
    let miss = |alpha: f64| -> Vec<f64> {
        let simulated = without_impact("rectangular", alpha, &p_t);
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
        // The longest pulse needs hardly more than the onset of the column, so the error is that of rounding.
        if p_t < 6.0 {
            let ratio = coarse[index] / fine[index];
            assert!((3.9..4.1).contains(&ratio), "{p_t}: {ratio}");
        }
    }
}

/// Only the impulse matters: `x p t -> 1`. The closed form continues `1 + p t / 2 - (p t)^2 (1/12 - 1/8)...`.
#[test]
fn short_pulses_overturn_by_their_impulse() {
    let p_t = [1e-3, 3e-3, 0.01, 0.03];
    for (x, p_t) in without_impact("rectangular", 1e-3, &p_t).iter().zip(p_t) {
        let miss = x * p_t - 1.0 - 0.5 * p_t;
        // The last term is the effect of a slenderness of a thousandth.
        assert!(miss.abs() < 0.1 * p_t * p_t + 1e-6, "{p_t}: {miss}");
    }
}

/// Half sine of the frequency `w = b p`, as derived in `tests/column.rs`:
/// `sqrt(x^2 - 1) + x exp(-(pi - asin(1/x)) / b) = b`.
#[test]
fn half_sines_and_slender_columns_are_the_linear_solution() {
    let b = [0.8, 1.5, 3.0, 6.0];
    let p_t = b.map(|b| PI / b);
    let ascending: Vec<f64> = p_t.iter().rev().copied().collect();
    let simulated = without_impact("half_sine", 0.01, &ascending);
    for (simulated, b) in simulated.iter().rev().zip(b) {
        let excess = |x: f64| (x * x - 1.0).sqrt() + x * (-(PI - (1.0 / x).asin()) / b).exp() - b;
        // Small errors of x follow from the residual by Newton's rule.
        let slope = (excess(simulated + 1e-6) - excess(simulated - 1e-6)) / 2e-6;
        let miss = excess(*simulated) / slope / simulated;
        assert!(miss.abs() < 1e-4, "{b}: {miss}");
    }
}

/// A spectrum with few points in which impacts matter.
fn small(structure: &str, kind: &str, more: &str) -> String {
    format!(
        "{structure}{}{more}[spectrum]\np_t = [1.2, 2.5, 5.0]\n\
         acceleration_over_incipient = {{ from = 1.0, to = 12.0, count = 60, spacing = \"logarithmic\" }}\n",
        pulse(kind)
    )
}

/// An arch four times as large, and one on the moon. Values found by bisection agree to the integration's tolerance,
/// sampled values are the same.
#[test]
fn similar_structures_have_the_same_spectrum() {
    let moon = "[simulation]\ngravity_m_s2 = 1.62\n";
    for kind in ["one_cosine", "half_sine"] {
        let here = spectrum(&small(ARCH, kind, ""));
        let larger = spectrum(&small(&ARCH.replace("5.0", "20.0"), kind, ""));
        let lighter = spectrum(&small(ARCH, kind, moon));
        assert!(here.iter().any(|point| point.minimum.is_some()));
        for (other, slower) in [(larger, 2.0), (lighter, (9.81_f64 / 1.62).sqrt())] {
            assert_eq!(other.len(), 6);
            for (here, other) in here.iter().zip(&other) {
                assert!(here.structure == other.structure && here.p_t == other.p_t);
                assert!((other.duration_s / here.duration_s / slower - 1.0).abs() < 1e-12);
                let edges = [here, other].map(|point| point.no_impact_over_incipient.unwrap());
                assert!((edges[0] / edges[1] - 1.0).abs() < 1e-7, "{edges:?}");
                match (here.minimum, other.minimum) {
                    (Some(a), Some(b)) => {
                        assert_eq!((a.impacts, a.sway), (b.impacts, b.sway), "{here:?}");
                        let tolerance = if a.impacts > 0 { 0.0 } else { 1e-7 };
                        let miss = a.over_incipient / b.over_incipient - 1.0;
                        assert!(miss.abs() <= tolerance, "{here:?}");
                    }
                    (a, b) => assert_eq!(a, b),
                }
            }
        }
    }
}

/// `A_L` agrees to rounding by construction, `p` to the accuracy of the second differences of the equivalent block.
#[test]
fn the_equivalent_column_has_the_a_l_and_the_p_of_the_arch() {
    let thin =
        "[arch]\nmean_radius_m = 10.0\nthickness_m = 1.5\nembrace_deg = 157.5\nvoussoirs = 7\n";
    for arch in [ARCH, thin] {
        for (impact, prescribed) in [
            ("", None),
            ("[impact]\nmodel = 'mirrored'\n", None),
            (
                "[impact]\nmodel = 'prescribed'\nrestitution = 0.7\n",
                Some(0.7),
            ),
        ] {
            let scenario = parsed(&format!("{arch}{}{impact}", pulse("ricker")));
            let points = OverturningSpectrum::new(&scenario).unwrap();
            // The defaults.
            assert_eq!(points.count(), 100);
            let [(StructureKind::Arch, arch), (StructureKind::Column, column)] =
                points.structures()
            else {
                panic!("an arch and a column");
            };
            assert!((incipient_g(&**arch) / incipient_g(&**column) - 1.0).abs() < 1e-14);
            let blocks = [arch, column].map(|one| one.equivalent(9.81).unwrap());
            let [p_arch, p_column] =
                blocks.map(|blocks| blocks.at_critical.unwrap().frequency_rad_s);
            assert!((p_arch / p_column - 1.0).abs() < 1e-10);
            let row = points.row(60);
            assert!((row.duration_s * p_arch / row.p_t - 1.0).abs() < 1e-14);
            let sin = blocks[0].slenderness_rad.sin();
            let expected = prescribed.unwrap_or((1.0 - 1.5 * sin * sin).powi(2));
            let restitution = column.restitution_after(1).unwrap();
            assert!((restitution - expected).abs() < 1e-14);
        }
    }
}

fn incipient_g(model: &dyn MechanismModel) -> f64 {
    model.incipient_acceleration_g(Sway::Right).unwrap()
}

/// How a single history ends under a pulse to the left.
fn outcome(
    model: &dyn MechanismModel,
    kind: Pulse,
    over_incipient: f64,
    duration_s: f64,
) -> (Outcome, usize) {
    let amplitude_m_s2 = -9.81 * over_incipient * incipient_g(model);
    let ground = GroundMotion::pulse(kind, amplitude_m_s2, duration_s, 0.0).unwrap();
    let request = Request {
        // Longer than any of these histories takes.
        end_s: 1e3,
        ..Request::default()
    };
    let summary = model.simulate(&ground, &request, None).unwrap();
    (summary.outcome, summary.impacts)
}

/// Every amplitude is tried again, in its full history: none below the least overturns, and the least does as
/// reported. Somewhere impacts help to overturn, and above that least there are safe islands.
#[test]
fn the_least_is_the_least_of_what_overturns() {
    let (mut after_impacts, mut islands, mut still_rocking) = (0, 0, 0);
    for (name, kind) in [("one_cosine", Pulse::OneCosine), ("ricker", Pulse::Ricker)] {
        let scenario = parsed(&small(ARCH, name, ""));
        let points = OverturningSpectrum::new(&scenario).unwrap();
        let tried = points.over_incipient().to_vec();
        let mut below = 0;
        for index in 0..points.count() {
            let point = points.row(index);
            let (_, model) = &points.structures()[index / 3];
            let edge = point.no_impact_over_incipient.unwrap_or(f64::INFINITY);
            let least = point
                .minimum
                .map_or(f64::INFINITY, |one| one.over_incipient);
            assert!(least <= edge || edge > 12.0, "{point:?}");
            assert!(point.minimum.is_some() || edge > 12.0, "{point:?}");
            below += usize::from(least < edge);
            still_rocking += point.still_rocking;
            for x in &tried {
                let (outcome, impacts) = outcome(&**model, kind, *x, point.duration_s);
                match outcome {
                    Outcome::Overturned(sway) => {
                        assert!(*x >= least, "{x}: {point:?}");
                        assert!(impacts > 0 || *x >= edge, "{x}: {point:?}");
                        if let Some(one) = point.minimum.filter(|_| *x == least) {
                            assert_eq!((sway, impacts), (one.sway, one.impacts));
                            after_impacts += 1;
                        }
                    }
                    _ if *x > least && *x < edge => islands += 1,
                    _ => assert!(*x != least, "{point:?}"),
                }
            }
        }
        assert!(below >= 2, "{name}: {below}");
    }
    assert!(
        after_impacts >= 4 && islands > 0,
        "{after_impacts} {islands}"
    );
    // The column rocks for a long time; histories that the spectrum cut off are followed to the end here.
    assert!(still_rocking > 0);
}

/// Just above the edge the first fall overturns, just below it does not, in single histories.
#[test]
fn the_edge_without_impact_is_an_edge() {
    let scenario = parsed(&small(ARCH, "one_sine", ""));
    let points = OverturningSpectrum::new(&scenario).unwrap();
    for index in 0..points.count() {
        let point = points.row(index);
        let (_, model) = &points.structures()[index / 3];
        let edge = point.no_impact_over_incipient.unwrap();
        let at = |x: f64| outcome(&**model, Pulse::OneSine, x, point.duration_s);
        assert_eq!(
            at(edge * (1.0 + 1e-6)),
            (Outcome::Overturned(Sway::Right), 0)
        );
        let (below, impacts) = at(edge * (1.0 - 1e-6));
        assert!(impacts > 0 || !matches!(below, Outcome::Overturned(_)));
    }
}

/// Step pairs that overturn an arch of seven voussoirs without impact: amplitudes in g from an independent
/// integration, printed with three digits.
#[test]
fn step_pairs_overturn_an_arch_as_computed_elsewhere() {
    let printed = [(0.2, 3.066), (0.5, 0.820), (1.0, 0.465)];
    let arch = "[arch]\nmean_radius_m = 10.0\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 7\n";
    let text = format!("{arch}{}", pulse("step_pair"));
    let of_arch = parsed(&text);
    let of_arch = OverturningSpectrum::new(&of_arch).unwrap();
    let (_, model) = &of_arch.structures()[0];
    let block = model.equivalent(9.81).unwrap().at_critical.unwrap();
    let p_t = printed.map(|(duration_s, _)| duration_s * block.frequency_rad_s);
    let points = spectrum(&format!(
        "{text}[spectrum]\np_t = {p_t:?}\nacceleration_over_incipient = [1.0]\n"
    ));
    for (point, (duration_s, amplitude_g)) in points.iter().zip(printed) {
        assert!((point.duration_s / duration_s - 1.0).abs() < 1e-12);
        let least_g = point.no_impact_over_incipient.unwrap() * incipient_g(&**model);
        assert!(
            (least_g - amplitude_g).abs() < 5.1e-4,
            "{duration_s}: {least_g}"
        );
    }
}

/// A pulse to the other side is its mirror image.
#[test]
fn the_sign_of_the_amplitude_is_the_side() {
    let text = small(ARCH, "one_cosine", "");
    let left = spectrum(&text.replace("amplitude_g = -1.0", "amplitude_g = 0.01"));
    for (right, mut left) in spectrum(&text).into_iter().zip(left) {
        if let Some(least) = &mut left.minimum {
            least.sway = least.sway.opposite();
        }
        assert_eq!(right, left);
    }
}

/// The start of the pulse and the duration in `[simulation]` do not matter.
#[test]
fn start_and_duration_do_not_count() {
    let text = small(ARCH, "one_cosine", "");
    let late = text.replace("duration_s = 1.0\n", "duration_s = 7.0\nstart_s = 1e6\n");
    let short = small(ARCH, "one_cosine", "[simulation]\nduration_s = 0.01\n");
    let expected = spectrum(&text);
    assert_eq!(spectrum(&late), expected);
    assert_eq!(spectrum(&short), expected);
}

/// Accelerations that a scenario cannot have are not tried.
#[test]
fn accelerations_beyond_the_largest_of_a_scenario() {
    let wide = "[spectrum]\np_t = [1e-3, 1e3]\nacceleration_over_incipient = [1.0, 1e6]\n";
    let flat = "[column]\nheight_m = 0.001\nwidth_m = 1e6\n";
    for point in spectrum(&format!("{flat}{}{wide}", pulse("half_sine"))) {
        assert_eq!(
            (point.no_impact_over_incipient, point.minimum),
            (None, None)
        );
        assert_eq!((point.still_rocking, point.failures.len()), (0, 0));
    }
    let points = spectrum(&format!("{ARCH}{}{wide}", pulse("half_sine")));
    assert_eq!(points.len(), 4);
    // The pulse of a thousandth takes pi/2 times a thousand A_L, which is 227 g.
    assert!(points[0].no_impact_over_incipient.unwrap() > 1e3);
    assert_eq!(points[0].minimum, None);
    // The longest takes hardly more than A_L, but still more than the only one that can be tried.
    assert_eq!(points[1].minimum, None);
    assert!((points[1].no_impact_over_incipient.unwrap() - 1.0).abs() < 1e-2);
}

#[test]
fn what_has_no_spectrum_says_so() {
    let of = |text: &str| OverturningSpectrum::new(&parsed(text)).err();
    assert_eq!(of(ARCH), Some(NoSpectrum::NoPulse));
    let initial = "[initial]\nsway = 'right'\nrotation_rad = 0.01\n";
    let text = format!("{ARCH}{}{initial}", pulse("ricker"));
    assert_eq!(of(&text), Some(NoSpectrum::Initial));
}

#[test]
fn errors_have_a_place_and_a_remedy() {
    let begin = format!("{ARCH}{}[spectrum]\n", pulse("ricker"));
    let first = begin.lines().count();
    for (lines, place, words) in [
        ("p_t = [0.0]", (1, 7), "from 0.001 to 1000"),
        ("p_t = 1", (1, 7), "an array of ascending numbers"),
        (
            "p_t = { from = 1, to = 0.5, count = 3 }",
            (1, 24),
            "above 1",
        ),
        (
            "\nacceleration_over_incipient = [2, 1]",
            (2, 31),
            "does not ascend",
        ),
        (
            "acceleration_over_incipient = [-1]",
            (1, 31),
            "above 0 and at most 1e6",
        ),
        ("pt = [1]", (1, 1), "did you mean `p_t`?"),
    ] {
        let errors = Scenario::parse(&format!("{begin}{lines}\n"), "s.toml").unwrap_err();
        let [error] = errors.as_slice() else {
            panic!("{errors}");
        };
        let found = error.place.unwrap();
        assert_eq!((found.line - first, found.column), place, "{error}");
        assert!(error.message.contains(words), "{error}");
    }
    let still = Scenario::parse(&format!("{ARCH}[spectrum]\n"), "s.toml").unwrap_err();
    let words = "s.toml:5:1: [spectrum] needs a pulse: give a table [ground.<kind>]";
    assert!(still.to_string().starts_with(words), "{still}");
    let huge = "[column]\nheight_m = 1e6\nwidth_m = 1e3\n[simulation]\ngravity_m_s2 = 0.001\n";
    let long = format!("{huge}{}[spectrum]\np_t = [1000]\n", pulse("ricker"));
    let long = Scenario::parse(&long, "s.toml").unwrap_err();
    let words = "s.toml:10:7: `p_t = [1000]` makes a pulse of";
    assert!(long.to_string().starts_with(words), "{long}");
    assert!(long.to_string().ends_with("from 1e-6 to 1e6"), "{long}");
}

/// Missing values leave gaps, a single size gets a margin, and every number is finite.
#[test]
fn pictures_of_much_and_of_little() {
    let picture = |text: &str| {
        let scenario = parsed(text);
        let points = OverturningSpectrum::new(&scenario).unwrap();
        let rows: Vec<_> = (0..points.count()).map(|index| points.row(index)).collect();
        let picture = draw(Figure::SCREEN, "a title", &points, &rows);
        assert!(
            !picture.contains("NaN") && !picture.contains("inf"),
            "{picture}"
        );
        let document = roxmltree::Document::parse(&picture).unwrap();
        let names = document.descendants();
        let names: Vec<String> = names
            .filter_map(|node| node.attribute("data-name"))
            .filter(|name| !name.is_empty())
            .map(str::to_owned)
            .collect();
        names
    };
    let count = |names: &[String], name: &str| names.iter().filter(|n| *n == name).count();
    let much = picture(&small(ARCH, "one_cosine", ""));
    assert_eq!(count(&much, "arch no-impact"), 1);
    assert_eq!(count(&much, "column no-impact"), 1);
    assert!(count(&much, "arch least") > 0 && count(&much, "column least") > 0);
    let column = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";
    let single = small(column, "one_cosine", "").replace("[1.2, 2.5, 5.0]", "[2.5]");
    assert_eq!(picture(&single), ["column no-impact", "column least"]);
    let none = single.replace("[2.5]", "[0.001]");
    assert!(picture(&none).is_empty());
}

const FILES: [&str; 3] = ["spectrum.csv", "spectrum.json", "spectrum.svg"];

fn results(folder: &Path) -> [Vec<u8>; 3] {
    let mut all = files(folder);
    all.retain(|name, _| !name.contains("-of-"));
    assert!(all.keys().eq(&FILES), "{:?}", all.keys());
    FILES.map(|name| all[name].clone())
}

#[test]
fn parts_threads_and_interruptions_change_nothing() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    fs::write(folder.join("s.toml"), small(ARCH, "one_cosine", "")).unwrap();
    let said = done(folder, &["spectrum", "s.toml", "--threads", "1"]);
    assert!(said.starts_with("6 points: "), "{said}");
    assert!(
        said.ends_with("results in results/s: spectrum.svg, spectrum.json, spectrum.csv\n"),
        "{said}"
    );
    let whole = results(&folder.join("results/s"));
    let table = String::from_utf8(whole[0].clone()).unwrap();
    assert_eq!(table.lines().count(), 7);
    assert!(table.starts_with(
        "structure,p_t,duration_s,no_impact_over_incipient,least_over_incipient,\
         impacts_before_overturning,overturning_sway,still_rocking,incomplete,failed\narch,1.2,"
    ));

    for part in ["1/4", "3/4", "2/4", "4/4"] {
        done(
            folder,
            &["spectrum", "s.toml", "--out", "parts", "--shard", part],
        );
    }
    let parts = [4, 2, 3, 1].map(|part| format!("parts/spectrum-{part}-of-4.part"));
    let merge = || {
        ["merge"]
            .into_iter()
            .chain(parts.iter().map(String::as_str))
    };
    let said = done(folder, &merge().collect::<Vec<_>>());
    assert!(said.starts_with("6 points: "), "{said}");
    assert_eq!(results(&folder.join("parts")), whole);
    let no_impact: Vec<_> = merge().chain(["--no-impact"]).collect();
    refused(
        folder,
        &no_impact,
        &["--no-impact is for maps with amplitude_g as an axis"],
    );

    // As if it had been killed while writing its third row.
    fs::create_dir(folder.join("killed")).unwrap();
    let mut text = String::new();
    for part in [1, 2] {
        let path = folder.join(format!("parts/spectrum-{part}-of-4.part"));
        let part = fs::read_to_string(path).unwrap();
        let (header, rows) = part.split_once('\n').unwrap();
        if text.is_empty() {
            text = header.replace("\"1/4\"", "\"1/1\"") + "\n";
        }
        text += rows;
    }
    let cut = text.trim_end().len() - 5;
    fs::write(folder.join("killed/spectrum.part"), &text[..cut]).unwrap();
    let again = ["spectrum", "s.toml", "--out", "killed"];
    refused(folder, &again, &["3 cases of this study"]);
    done(folder, &[&again[..], &["--resume"]].concat());
    assert_eq!(results(&folder.join("killed")), whole);
}

#[test]
fn check_prints_the_table_resolved_where_it_is_given() {
    let root = tempfile::tempdir().unwrap();
    let check = |text: &str| {
        fs::write(root.path().join("s.toml"), text).unwrap();
        printed(root.path(), &["check", "s.toml"])
    };
    let text = format!("{ARCH}{}", pulse("ricker"));
    assert!(!check(&text).contains("[spectrum]"));
    let resolved = "[spectrum]\n\
        p_t = { from = 0.2, to = 10.0, count = 50, spacing = \"logarithmic\" }\n\
        acceleration_over_incipient = { from = 1.0, to = 20.0, count = 400, spacing = \"logarithmic\" }\n";
    let first = check(&format!("{text}[spectrum]\n"));
    assert!(first.ends_with(resolved), "{first}");
    assert_eq!(check(&first), first);
    let own = check(&format!("{text}[spectrum]\np_t = [1, 2]\n"));
    assert!(
        own.contains("p_t = [1.0, 2.0]\nacceleration_over_incipient = { from = 1.0,"),
        "{own}"
    );
}

#[test]
fn the_command_refuses_what_has_no_spectrum() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), ARCH).unwrap();
    let words = "error: s.toml: a spectrum needs a pulse: give a table [ground.<kind>]";
    let said = refused(root.path(), &["spectrum", "s.toml"], &[]);
    assert!(said.starts_with(words), "{said}");
    assert!(!root.path().join("results").exists());
}
