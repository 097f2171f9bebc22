//! Numbers that are changed in several ways: all ways compute one history, and later changes replace earlier ones.

use std::collections::BTreeSet;
use std::fs;

use crate::common::program::{done, refused};
use crate::common::results::Table;
use crate::common::{ARCH, COLUMN, pairs, parsed};
use crate::scenario::keys::tables_with_numbers;
use archrock::scenario::{Assignment, ReadOptions, Scenario, Source};
use archrock::studies::Study as _;
use archrock::studies::ensemble::Histories;
use archrock::studies::threshold::{Along, AlongOptions, AlongRow, Factors};
use archrock::{Outcome, OverturningMap, Pulse};

/// The scenario of a text, with the assignments.
#[track_caller]
fn read(text: &str, set: &[&str]) -> Scenario {
    let set: Vec<Assignment> = set.iter().map(|one| one.parse().unwrap()).collect();
    let options = ReadOptions {
        set: &set,
        ..ReadOptions::default()
    };
    let source = Source::of_text(text, "s.toml");
    Scenario::of(&source, &options).unwrap_or_else(|errors| panic!("{set:?}: {errors}"))
}

/// The largest rotation of the history that `run` computes, in radians.
fn peak_rad(scenario: &Scenario) -> f64 {
    let model = scenario.model().unwrap();
    let request = scenario.request();
    let summary = model.simulate(scenario.ground_motion(), &request, None);
    summary.unwrap().largest_rotation_rad()
}

/// The largest rotations of the scenario itself and of its samples, in radians; `None` for histories without a verdict.
fn sampled_peaks_rad(scenario: &Scenario) -> Vec<Option<f64>> {
    let study = Histories::of(scenario).unwrap();
    let rows = study.rows(&(0..study.count()).collect::<Vec<_>>());
    let peaks = rows
        .into_iter()
        .map(|row| Some(row.answer.ok()?.ending.peak_rotation_rad));
    peaks.collect()
}

/// The first threshold along a key from a value, among the factors 1 and 1.2.
#[track_caller]
fn along(scenario: &Scenario, key: &str, value: f64) -> AlongRow {
    let options = AlongOptions {
        along: format!("{key}={value:?}..{:?}:2", 1.001 * value)
            .parse()
            .unwrap(),
        factors: Factors::new(1.0, 1.2, 0.2).unwrap(),
        no_impact: false,
    };
    let study = Along::of(scenario, options);
    study
        .unwrap_or_else(|error| panic!("{key}: {error}"))
        .rows(&[0])
        .remove(0)
}

/// A structure with its ground motion, and keys of it with other values.
type Case = (String, Vec<(&'static str, f64)>);

/// Cases that cover all tables with numbers.
fn cases() -> Vec<Case> {
    let free = "[free_hinges]\nlongest_step_s = 2e-3\n";
    let elastic = "[elastic_joints]\nlongest_step_s = 1e-4\nnormal_stiffness_gpa_m = 1.0\n";
    let shape = "span_m = 4.0\nrise_m = 3.0\nthickness_m = 0.5\nvoussoirs = 6\n";
    let pointed = format!("[pointed_arch]\n{shape}");
    let arch = format!("{ARCH}voussoirs = 7\n");
    // Thick arches start to move under strong pulses.
    let strong = "[ground.one_sine]\namplitude_g = 1.2\nduration_s = 0.4\n";
    let sine = "[ground.one_sine]\namplitude_g = 0.45\nduration_s = 0.4\n";
    let record = "file = 'scenarios/synthetic.at2'\nscale = 0.8\n";
    let mut cases: Vec<Case> = vec![
        (format!("{ARCH}{sine}"), vec![("arch.thickness_m", 0.7), ("arch.embrace_deg", 175.0)]),
        (format!("{ARCH}[impact]\nmodel = 'prescribed'\nrestitution = 0.8\n{sine}"), vec![("impact.restitution", 0.7)]),
        (format!("{COLUMN}{sine}"), vec![("column.width_m", 0.7), ("simulation.gravity_m_s2", 9.0)]),
        // A given ratio of rates replaces that which follows from the height.
        (
            format!("{COLUMN}[column.back]\nside = 'left'\nrestitution = 0.5\n[ground.record]\n{record}").replace("scale = 0.8", "scale = 2.0"),
            vec![("column.back.restitution", 0.7)],
        ),
        (format!("{pointed}{free}{sine}"), vec![("pointed_arch.rise_m", 2.9), ("free_hinges.friction_coefficient", 0.6)]),
        (format!("[elliptic_arch]\n{shape}{free}{strong}").replace("rise_m = 3.0", "rise_m = 1.8"), vec![("elliptic_arch.span_m", 4.1)]),
        (format!("[basket_arch]\n{shape}{free}{strong}").replace("rise_m = 3.0", "rise_m = 1.6"), vec![("basket_arch.thickness_m", 0.55), ("basket_arch.crown_deg", 55.0)]),
        (format!("{pointed}[piers]\nheight_m = 1.0\nwidth_m = 1.0\n{free}{sine}"), vec![("piers.height_m", 1.2)]),
        (
            format!("{pointed}[piers]\nheight_m = 1.0\nwidth_m = 1.0\n[piers.left]\nwidth_m = 1.2\n[piers.right]\nheight_m = 0.8\n{free}{sine}"),
            vec![("piers.left.width_m", 1.3), ("piers.right.height_m", 1.1)],
        ),
        (format!("{pointed}[fill]\nabove_crown_m = 0.1\ndensity_kg_m3 = 1500.0\n{free}{sine}"), vec![("fill.height_m", 3.5), ("fill.density_kg_m3", 1600.0)]),
        (format!("{pointed}[[load]]\nmass_kg = 100.0\nx_m = 0.5\n{free}{sine}"), vec![("load.1.mass_kg", 400.0)]),
        (format!("{pointed}[[tie]]\nheight_m = 1.0\narea_mm2 = 300.0\nmodulus_gpa = 200.0\n{free}{sine}"), vec![("tie.1.stiffness_n_m", 1e7)]),
        (
            format!("{pointed}[supports.left]\nspread_m = 0.0\n{free}{sine}"),
            vec![("supports.left.spread_m", 0.02), ("supports.right.settlement_m", 0.02)],
        ),
        (
            format!("{COLUMN}drums = 2\n{elastic}damping_ratio = 0.05\ndamping_frequency_hz = 20.0\n{sine}"),
            vec![("elastic_joints.damping_time_s", 1e-3), ("elastic_joints.normal_stiffness_gpa_m", 2.0)],
        ),
        (
            format!("{COLUMN}{elastic}damping_ratio = 0.05\ndamping_frequency_hz = 20.0\n{sine}"),
            vec![("elastic_joints.rebound_ratio", 0.97), ("column.height_m", 2.6)],
        ),
        (
            "[blocks]\njoints = 'scenarios/straight-sided-voussoirs.csv'\ndensity_kg_m3 = 2700.0\n".to_owned()
                + free
                + "[ground.one_sine]\namplitude_g = 0.8\nduration_s = 0.4\n",
            vec![("blocks.depth_m", 1.3), ("free_hinges.friction_coefficient", 0.5)],
        ),
        (format!("{arch}{free}{sine}[ground.right]\ndelay_s = 0.01\n"), vec![("ground.right.delay_s", 0.05), ("free_hinges.longest_step_s", 1e-3)]),
        (format!("{COLUMN}[ground.record]\n{record}"), vec![("ground.record.peak_g", 0.27), ("ground.record.scale", 0.9)]),
        (
            format!("{COLUMN}[ground.record]\n{record}[ground.record.vertical]\n{record}"),
            vec![("ground.record.vertical.scale", 0.7)],
        ),
        (
            format!("{arch}{free}{sine}[ground.right.record]\n{record}"),
            vec![("ground.right.record.scale", 1.3)],
        ),
        (
            format!("{arch}{free}{sine}[ground.right.record]\n{record}[ground.right.record.vertical]\n{record}"),
            vec![("ground.right.record.vertical.scale", 0.7)],
        ),
        (
            format!("[body]\nmass_kg = 1200.0\ninertia_kg_m2 = 500.0\ncentre_m = [0.05, 1.2]\ntoes_x_m = [-0.25, 0.25]\n{sine}"),
            vec![("body.inertia_kg_m2", 600.0)],
        ),
        (
            "[column]\nheight_m = 4.0\nwidth_m = 1.0\n[initial]\nsway = 'left'\nimpulse_n_s = 2000.0\nheight_m = 2.0\n".to_owned(),
            vec![("initial.impulse_n_s", 2500.0), ("initial.height_m", 2.5)],
        ),
    ];
    for kind in Pulse::ALL {
        let table = format!(
            "[ground.{}]\namplitude_g = 0.25\nduration_s = 0.4\n",
            kind.name()
        );
        let key = format!("ground.{}.amplitude_g", kind.name());
        cases.push((format!("{COLUMN}{table}"), vec![(&*key.leak(), 0.26)]));
    }
    cases
}

/// A number of each table that a scenario may have: samples, `--along` and `--set` compute one history, with the same largest rotation and the same
/// threshold to the last bit. The steps are given, so that they do not depend on the study.
#[test]
fn all_ways_to_change_a_number_compute_one_history() {
    let (mut tables, mut verdicts) = (BTreeSet::new(), 0);
    for (structure, keys) in cases() {
        for (key, value) in keys {
            let is_one = structure.starts_with(COLUMN) || structure.starts_with("[body]");
            let is_block = is_one && !structure.contains("drums");
            let duration_s = if is_block { 20.0 } else { 0.8 };
            let text = format!(
                "{structure}[simulation]\nduration_s = {duration_s:?}\ndirection = 'as_given'\n"
            );
            let own = read(&text, &[]);
            let sample = format!(
                "uncertain={{samples=1, '{key}'={{from={value:?}, to={:?}}}}}",
                1.001 * value
            );
            let sampled = read(&text, &[&sample]);
            let value = sampled.uncertain.as_ref().unwrap().values(0)[0];
            let by_set = read(&text, &[&format!("{key}={value:?}")]);
            let due = peak_rad(&by_set);
            let uncertain = sampled.uncertain.as_ref().unwrap();
            let sample = uncertain.scenario(&sampled, &[value]).unwrap();
            assert_eq!(peak_rad(&sample), due, "{key}: sample");
            for (found, due) in pairs(sampled_peaks_rad(&sampled), [peak_rad(&own), due]) {
                assert!(
                    found.is_none_or(|found| found == due),
                    "{key}: {found:?} {due}"
                );
                verdicts += usize::from(found.is_some());
            }
            // A number that has no effect on the history would show nothing. The depth affects only masses.
            let effect = (due / peak_rad(&own) - 1.0).abs();
            assert!(effect > 1e-6 || key == "blocks.depth_m", "{key}: {effect}");
            if !text.contains("[initial]") {
                // Along a key that keeps its value.
                let gravity_m_s2 = by_set.simulation.gravity_m_s2;
                let expected = along(&by_set, "simulation.gravity_m_s2", gravity_m_s2);
                assert_eq!(along(&own, key, value).edge, expected.edge, "{key}: along");
            }
            let names = key.split('.').filter(|name| name.parse::<usize>().is_err());
            let names: Vec<&str> = names.collect();
            tables.insert(names[..names.len() - 1].join("."));
        }
    }
    assert!(verdicts > 20, "{verdicts}");
    let all = tables_with_numbers();
    // A held top has no histories.
    tables.insert("column.top".to_owned());
    let missing: Vec<_> = all.difference(&tables).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

const SINE: &str = "[ground.one_sine]\namplitude_g = 0.3\nduration_s = 0.8\n";

/// The largest rotations of the cells of a map, in radians.
fn map_peaks_rad(scenario: &Scenario) -> Vec<f64> {
    let map = OverturningMap::of(scenario).unwrap();
    // Rows that are computed together share their model.
    let cells = (0..map.count()).flat_map(|index| map.rows(&[index]));
    cells
        .map(|cell| cell.result.unwrap().peak_rotation_rad)
        .collect()
}

/// The width of a column is given by the file, then by `--set` once or twice, by a sample, and by an axis: each replaces those before it.
#[test]
fn later_changes_replace_earlier_ones() {
    let text = format!("{COLUMN}{SINE}");
    let alone =
        |width_m: f64| peak_rad(&parsed(&text.replace("0.8\n[", &format!("{width_m:?}\n["))));
    let [file, first, second] = [0.8, 0.9, 1.0].map(alone);
    assert!(file > first && first > second && second > 0.0);
    assert_eq!(peak_rad(&read(&text, &[])), file);
    let set = ["column.width_m=0.9", "column.width_m=1.0"];
    assert_eq!(peak_rad(&read(&text, &set)), second);
    assert_eq!(peak_rad(&read(&text, &[set[1], set[0]])), first);
    // A sample replaces the value of `--set`, which is that of the scenario itself.
    let sample = "uncertain={samples=1, 'column.width_m'={from=0.7, to=0.7001}}";
    for set in [[set[1], sample], [sample, set[1]]] {
        let scenario = read(&text, &set);
        let sampled = scenario.uncertain.as_ref().unwrap().values(0)[0];
        assert_eq!(
            sampled_peaks_rad(&scenario),
            [second, alone(sampled)].map(Some)
        );
    }
    // The centre of a deviation is the value of `--set`.
    let deviation = "uncertain={samples=8, 'column.width_m'={deviation=1e-6}}";
    let scenario = read(&text, &[deviation, set[1]]);
    for sample in 0..8 {
        let width_m = scenario.uncertain.as_ref().unwrap().values(sample)[0];
        assert!((width_m - 1.0).abs() < 1e-5, "{width_m}");
    }
    // An axis replaces the value of `--set`, and so do the short names of axes.
    for set in [
        &[][..],
        &set,
        &["ground.one_sine.amplitude_g=0.9", "column.width_m=3"],
    ] {
        let map = "map={'column.width_m'=[0.8, 0.9], amplitude_g=[0.3]}";
        let scenario = read(&text, &[set, &[map]].concat());
        assert_eq!(map_peaks_rad(&scenario), [file, first], "{set:?}");
        let scenario = read(&text, set);
        let expected = along(&parsed(&text), "column.width_m", 0.9).edge;
        let due = match set.contains(&"column.width_m=3") {
            // Factors multiply the amplitude of `--set`.
            true => along(&read(&text, &set[..1]), "column.width_m", 0.9).edge,
            false => expected,
        };
        assert_eq!(along(&scenario, "column.width_m", 0.9).edge, due);
    }
}

/// Each cell of an uncertain map has the values of its sample, and of its axes after them.
#[test]
fn axes_follow_samples() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = format!(
        "{COLUMN}{SINE}[uncertain]\nsamples = 1\n'column.height_m' = {{ from = 6.0, to = 6.001 }}\n\
         [map]\n'column.width_m' = [0.8, 1.2]\namplitude_g = [0.25, 0.5]\n"
    );
    fs::write(folder.join("s.toml"), &text).unwrap();
    let set = ["--set", "column.height_m=2.0"];
    done(
        folder,
        &[&["map", "s.toml", "--out", "."], &set[..]].concat(),
    );
    let own = Table::read(folder.join("map.csv")).rows;
    let sampled = Table::read(folder.join("uncertain_map/map.csv")).rows;
    let outcome = |height_m: f64, [width_m, amplitude_g]: [f64; 2]| {
        let set = [
            format!("column.height_m={height_m:?}"),
            format!("column.width_m={width_m:?}"),
            format!("ground.one_sine.amplitude_g={amplitude_g:?}"),
        ];
        let set = set.each_ref().map(String::as_str);
        let scenario = read(&format!("{COLUMN}{SINE}"), &set);
        let model = scenario.model().unwrap();
        let summary = model.simulate(scenario.ground_motion(), &scenario.request(), None);
        matches!(summary.unwrap().outcome, Outcome::Overturned(_))
    };
    let mut counts = [0, 0];
    for (own, sampled) in pairs(&own, &sampled) {
        let axes = [0, 1].map(|column| own.number(column));
        assert_eq!(axes, [0, 1].map(|column| sampled.number(column)));
        assert_eq!(own["outcome"] == "overturned", outcome(2.0, axes));
        let overturns = outcome(6.0005, axes);
        assert_eq!(
            sampled.number("overturned"),
            f64::from(u8::from(overturns)),
            "{axes:?}"
        );
        counts[usize::from(overturns)] += 1;
    }
    assert!(counts[0] > 0 && counts[1] > 0, "{counts:?}");
}

/// An axis of the key that is uncertain, or of its alternative, contradicts it: the order would leave one of them without effect.
#[test]
fn an_axis_of_an_uncertain_number_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (structure, uncertain, axis) in [
        (COLUMN, "column.width_m", "'column.width_m' = [0.8, 0.9]"),
        (
            ARCH,
            "arch.thickness_ratio",
            "'arch.thickness_m' = [0.75, 0.8]",
        ),
        (
            ARCH,
            "ground.one_sine.amplitude_g",
            "embrace_deg = [170.0, 180.0]",
        ),
        (
            ARCH,
            "ground.one_sine.duration_s",
            "frequency_hz = [0.5, 0.8]",
        ),
    ] {
        let text = format!(
            "{structure}{SINE}[uncertain]\nsamples = 2\n'{uncertain}' = {{ from = 0.14, to = 0.15 }}\n\
             [map]\n{axis}\namplitude_g = [0.3]\n"
        );
        fs::write(folder.join("s.toml"), text).unwrap();
        refused(
            folder,
            &["map", "s.toml", "--out", "o"],
            &["contradict", uncertain, "leave one of them out"],
        );
    }
}

/// The records of a suite replace the ground motion, however it is given: by the file, by `--set` or by a sample.
#[test]
fn records_of_a_suite_replace_the_ground_motion() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let record: String = (0..200)
        .map(|step| {
            let time_s = 0.01 * f64::from(step);
            format!("{time_s},{}\n", 0.3 * (8.0 * time_s).sin())
        })
        .collect();
    fs::write(folder.join("a.csv"), record).unwrap();
    let suite = "[suite]\nrecords = 'a.csv'\nunit = 'g'\nscales = [1.0, 1.2, 4.0]\n";
    let cases = |ground: &str, set: &[&str]| {
        fs::write(folder.join("s.toml"), format!("{COLUMN}{ground}{suite}")).unwrap();
        let set = set.iter().flat_map(|set| ["--set", set]);
        let arguments = ["suite", "s.toml", "--out", "o"].into_iter().chain(set);
        done(folder, &arguments.collect::<Vec<_>>());
        Table::read(folder.join("o/suite.csv")).rows
    };
    let own = cases("", &[]);
    let peaks: BTreeSet<_> = own
        .iter()
        .map(|row| row["peak_rotation_over_critical"].clone())
        .collect();
    assert!(own.len() == 3 && peaks.len() == 3, "{peaks:?}");
    assert_eq!(cases(SINE, &[]), own);
    assert_eq!(cases(SINE, &["ground.one_sine.amplitude_g=1.5"]), own);
    assert_eq!(
        cases("", &["ground.one_sine={amplitude_g=1.5, duration_s=1}"]),
        own
    );
    assert_eq!(
        cases("", &["ground.record={file='a.csv', unit='g', scale=3}"]),
        own
    );
    // Other keys of `--set` hold for all records.
    assert_ne!(cases(SINE, &["column.width_m=0.9"]), own);
    // So do samples; the record replaces a sample of the ground motion.
    let sampled = |key: &str, range: &str| {
        let uncertain = format!("uncertain={{samples=1, '{key}'={range}}}");
        assert_eq!(cases(SINE, &[&uncertain]), own);
        let mut rows = Table::read(folder.join("o/uncertain_suite/capacities.csv")).rows;
        rows.retain(|row| row["sign"] == "1");
        let [own, sample] = &rows[..] else {
            panic!("{rows:?}");
        };
        [own, sample].map(|row| row["intensity"].clone())
    };
    let [own, sample] = sampled("ground.one_sine.amplitude_g", "{from=0.5, to=0.6}");
    assert!(!own.is_empty() && own == sample, "{own} {sample}");
    let [own, sample] = sampled("column.width_m", "{from=0.7, to=0.7001}");
    assert!(!own.is_empty() && own != sample, "{own} {sample}");
}
