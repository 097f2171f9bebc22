//! Maps and suites of rows of blocks with free hinges: cells compared with single histories, parts of the work with the
//! whole, the influences on results, and refusals.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use crate::common::parsed;
use crate::common::program::{done, files, refused, scenarios};
use crate::common::prose::golden;
use crate::common::results::Table;
use archrock::dynamics::repeatability::Repeatability;
use archrock::dynamics::{Directions, FreeHinges, RowOptions};
use archrock::output::Figure;
use archrock::scenario::{
    FOUR_LINKS, FREE_HINGES, ModelKind, ReadOptions, Scenario, ScenarioErrors, Source,
};
use archrock::studies::map::{OverturningMap, draw};
use archrock::studies::threshold::{Factors, Threshold, threshold};
use archrock::studies::{Ending, NoHistory, Runner, Study as _, Style, Verdict, outcome_name};
use archrock::{Arch, Column, ImpactModel, Model, Pulse, Request, RockingColumn};

const ARCH: &str =
    "[arch]\nmean_radius_m = 10.0\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 7\n";
const PULSE: &str = "[ground.rectangular]\namplitude_g = -0.5\nduration_s = 0.2\n";
const AXES: &str = "[map]\nduration_s = [0.1, 0.2]\namplitude_g = [-1.2, 0.3, 0.6]\n";

const DRUMS: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\ndrums = 2\n[free_hinges]\n\
                     [simulation]\nduration_s = 30.0\n";

fn map_text() -> String {
    format!("{ARCH}[free_hinges]\n{PULSE}[simulation]\nduration_s = 4.0\n{AXES}")
}

fn arch(mean_radius_m: f64, thickness_ratio: f64, embrace_deg: f64) -> Arch {
    Arch::new(mean_radius_m, thickness_ratio, embrace_deg)
        .unwrap()
        .with_voussoirs(7)
        .unwrap()
}

/// The ending of a single history of a symmetric row, as a cell of `map` has it: its first repetition is mirrored.
fn single(row: &FreeHinges, map: &OverturningMap<'_>, amplitude_g: f64, duration_s: f64) -> Ending {
    let ground = Pulse::Rectangular
        .lasting_s(duration_s)
        .horizontal_m_s2(amplitude_g * 9.81)
        .unwrap();
    let request = map
        .scenario
        .request_on(map.scenario.ground_motion(), &map.scenario.structure);
    let case = [(ground, request)];
    let mut row = row
        .for_many_cases()
        .unwrap_or_else(|| Box::new(row.clone()));
    row.repeat_mirrored();
    Ending::of_all(&*row, &case).remove(0).unwrap()
}

fn ended(map: &OverturningMap<'_>, index: usize) -> Ending {
    match map.rows(&[index]).remove(0).result {
        Ok(ending) => ending,
        other => panic!("cell {index}: {other:?}"),
    }
}

#[test]
fn a_cell_is_the_history_of_its_row_under_its_pulse() {
    let scenario = parsed(&map_text());
    let map = OverturningMap::of(&scenario).unwrap();
    let row = FreeHinges::of_arch(&arch(10.0, 0.15, 157.5)).unwrap();
    let mut outcomes = Vec::new();
    for index in 0..map.count() {
        let [duration_s, amplitude_g] = map.coordinates(index);
        let expected = single(&row, &map, amplitude_g, duration_s);
        assert_eq!(ended(&map, index), expected);
        assert!(expected.peak_over_critical.is_none());
        outcomes.push(expected.outcome.name());
    }
    // If nothing moves, no block has rotated.
    assert_eq!(outcomes[1], "never_moved");
    assert_eq!(ended(&map, 1).peak_of_row_rad(), Some(0.0));
    assert!(outcomes.contains(&"overturned") && outcomes.contains(&"rest"));
}

#[test]
fn axes_of_size_and_shape_change_the_row() {
    let scenario = parsed(&map_text().replace(
        AXES,
        "[map]\nmean_radius_m = [5.0, 10.0]\namplitude_g = [0.6]",
    ));
    let map = OverturningMap::of(&scenario).unwrap();
    for (index, mean_radius_m) in [5.0, 10.0].into_iter().enumerate() {
        let row = FreeHinges::of_arch(&arch(mean_radius_m, 0.15, 157.5)).unwrap();
        assert_eq!(ended(&map, index), single(&row, &map, 0.6, 0.2));
    }
    assert_ne!(ended(&map, 0), ended(&map, 1));

    let shapes = "[map]\nthickness_ratio = [0.05, 0.15, 0.4]\nembrace_deg = [120.0, 179.0]";
    let scenario = parsed(&map_text().replace(AXES, shapes));
    let map = OverturningMap::of(&scenario).unwrap();
    for index in 0..map.count() {
        let [thickness_ratio, embrace_deg] = map.coordinates(index);
        match FreeHinges::of_arch(&arch(10.0, thickness_ratio, embrace_deg)) {
            Ok(row) => assert_eq!(ended(&map, index), single(&row, &map, -0.5, 0.2)),
            Err(_) => assert_eq!(
                map.rows(&[index]).remove(0).result,
                Err(NoHistory::CannotStand)
            ),
        }
    }
    // An arch of 179 degrees and 0.05 cannot stand; one of 120 degrees and 0.4, too thick for four links, can.
    assert_eq!(map.rows(&[1]).remove(0).result, Err(NoHistory::CannotStand));
    ended(&map, 4);
}

#[test]
fn a_cell_of_drums_is_the_history_of_their_column() {
    let scenario = parsed(&format!(
        "[column]\nheight_m = 4.0\nwidth_m = 0.8\ndrums = 3\n[free_hinges]\nlongest_step_s = 2e-3\n{PULSE}\
         [simulation]\nduration_s = 3.0\n{AXES}"
    ));
    let map = OverturningMap::of(&scenario).unwrap();
    let column = Column::new(4.0, 0.8).unwrap().with_drums(3).unwrap();
    let steps = RowOptions {
        longest_step_s: Some(2e-3),
        shortest_step_s: None,
        ..RowOptions::default()
    };
    let row = FreeHinges::of_column(&column).unwrap();
    let row = row.with_options(steps).unwrap();
    for index in 0..map.count() {
        let [duration_s, amplitude_g] = map.coordinates(index);
        assert_eq!(
            ended(&map, index),
            single(&row, &map, amplitude_g, duration_s)
        );
    }
}

#[test]
fn a_cell_counts_the_outcomes_of_all_repetitions() {
    // Drums of 4 m under pulses up to beyond overturning. With steps this long, some repetitions still rock too much at the end for a verdict.
    let text = |repeat: &str| {
        format!(
            "[column]\nheight_m = 4.0\nwidth_m = 0.8\ndrums = 2\n\
             [free_hinges]\nlongest_step_s = 2e-2\nshortest_step_s = 1e-2\n\
             [ground.one_sine]\namplitude_g = 0.5\nduration_s = 1.0\n\
             [simulation]\nduration_s = 12.0\noutput_step_s = 1.0\n\
             [map]\nduration_s = [0.6, 0.7]\n\
             amplitude_g = {{ from = 0.3, to = 0.9, count = 100 }}\n{repeat}"
        )
    };
    let scenario = parsed(&text("repeat = true"));
    let map = OverturningMap::of(&scenario).unwrap();
    let request = scenario.request_on(scenario.ground_motion(), &scenario.structure);
    let row = scenario.model_for_many_cases().unwrap();
    let mut rows = Vec::new();
    for index in 0..map.count() {
        let [duration_s, amplitude_g] = map.coordinates(index);
        let ground = Pulse::OneSine
            .lasting_s(duration_s)
            .horizontal_m_s2(amplitude_g * 9.81)
            .unwrap();
        let history = |model: &dyn Model| model.simulate(&ground, &request, None).unwrap();
        let others = row.repetitions().into_iter();
        let others = others.map(|other| (other.name, Ok(history(&*other.model))));
        let all = Repeatability::new(&history(&*row), &others.collect::<Vec<_>>());
        let mut outcomes: Vec<&str> = all.outcomes.iter().map(|one| one.name()).collect();
        let own = outcomes[0];
        let overturned = outcomes
            .iter()
            .filter(|other| **other == "overturned")
            .count();
        let incomplete = outcomes.iter().filter(|other| **other == "incomplete");
        let of = 7 - incomplete.count();
        assert_eq!((all.count.overturns_in, all.count.of), (overturned, of));
        let certain = own == "incomplete" || of > 3 && (overturned == 0 || overturned == of);
        outcomes.sort_unstable();
        outcomes.dedup();
        let cell = map.rows(&[index]).remove(0);
        assert_eq!(cell.outcomes, Some(Ok(outcomes.len())), "cell {index}");
        let expected = if certain { own } else { "uncertain" };
        assert_eq!(outcome_name(&cell.result), expected, "cell {index}");
        rows.push(cell);
    }
    let doubtful = rows
        .iter()
        .filter(|row| matches!(row.outcomes, Some(Ok(outcomes)) if outcomes > 1))
        .count();
    assert!(0 < doubtful && doubtful < rows.len() / 2, "{doubtful}");
    let style = Style::of(Figure::SCREEN);
    let picture = draw("Title", &map, &rows, style);
    assert!(picture.contains("another outcome in a repetition"));
    let hatch = picture.lines().find(|line| line.contains("\"doubtful\""));
    assert_eq!(hatch.unwrap().matches('M').count(), doubtful);

    // Without this option fewer cells are repeated: cells that overturn at once are not.
    let plain = parsed(&text(""));
    let map = OverturningMap::of(&plain).unwrap();
    for (index, with) in rows.iter().enumerate() {
        let without = map.rows(&[index]).remove(0);
        let (Ok(less), Ok(more)) = (&without.result, &with.result) else {
            panic!("cell {index} has no history");
        };
        assert_eq!((less.outcome, without.outcomes), (more.outcome, None));
        assert!(less.doubt().is_none() || less.count == more.count);
    }
    assert!(!draw("Title", &map, &rows, style).contains("in a repetition"));
}

/// With steps that the scenario gives, a map takes those of `run`: outcome and peak are bit-identical, and so are the impacts and
/// the time if it overturns. A history that comes to rest is followed only until that is known.
#[test]
fn cells_with_the_steps_of_runs_have_their_bits() {
    let map_text = || {
        map_text().replace(
            "[free_hinges]\n",
            "[free_hinges]\nlongest_step_s = 0.0002\n",
        )
    };
    let scenario = parsed(&map_text());
    let map = OverturningMap::of(&scenario).unwrap();
    let mut moved = 0;
    for index in [0, 2, 4, 5] {
        let [duration_s, amplitude_g] = map.coordinates(index);
        let text = map_text()
            .replace(
                "amplitude_g = -0.5",
                &format!("amplitude_g = {amplitude_g:?}"),
            )
            .replace(
                "duration_s = 0.2\n",
                &format!("duration_s = {duration_s:?}\n"),
            );
        let work = folder(&text);
        done(work.path(), &["run", "s.toml", "--out", "r", "--quiet"]);
        let summary = fs::read(work.path().join("r/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
        let cell = ended(&map, index);
        assert_eq!(cell.doubt(), None);
        assert_eq!(summary["outcome"], cell.outcome.name());
        assert!(cell.known_time_s().is_some() == cell.known_impacts().is_some());
        if let (Some(time_s), Some(impacts)) = (cell.known_time_s(), cell.known_impacts()) {
            assert_eq!(summary["outcome_time_s"], time_s);
            assert_eq!(summary["impacts"], impacts);
        } else {
            assert_eq!(summary["outcome"], "rest");
        }
        // A run also checks the energy at its samples.
        assert!(summary["energy_defect_ratio"].as_f64().unwrap() >= cell.energy_defect_ratio);
        assert_eq!(
            summary["largest_peak_rotation_rad"],
            cell.peak_of_row_rad().unwrap()
        );
        moved += usize::from(cell.impacts > Some(0));
    }
    assert!(moved > 2);
}

/// A step pair of 0.2 s on a block of 4 x 0.8 m: one band, from the same factor as for Housner's column, without the safe gaps that
/// merged landings once caused. Around it the amplitudes are 5e-4 g apart.
#[test]
fn a_block_under_a_step_pair_has_one_band_without_gaps() {
    let column = Column::new(4.0, 0.8).unwrap();
    let row = FreeHinges::of_column(&column).unwrap();
    let housner = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
    let models: [(&str, &dyn Model); 2] = [("free_hinges", &row), ("column", &housner)];
    let ground = Pulse::StepPair
        .lasting_s(0.2)
        .horizontal_m_s2(9.81)
        .unwrap();
    let request = Request {
        end_s: 30.0,
        ..Request::default()
    };
    let factors = Factors::new(0.655, 0.658, 5e-4).unwrap();
    let runner = Runner::default();
    let go_on = |_| ControlFlow::Continue(());
    let found = models.map(|model| {
        threshold(
            model,
            (Directions::AsGiven, &ground),
            &request,
            &factors,
            &runner,
            go_on,
        )
        .unwrap()
    });
    for threshold in &found {
        let verdicts: Vec<_> = threshold.ranges.iter().map(|range| range.verdict).collect();
        let expected = [Verdict::Survives, Verdict::Overturns].map(Some);
        assert_eq!(verdicts, expected);
        let edge = threshold.lowest_factor().unwrap();
        assert!((edge - 0.65649).abs() < 1e-4, "{} {edge}", threshold.model);
    }
    let edges: Vec<_> = found.iter().filter_map(Threshold::lowest_factor).collect();
    // Each edge is enclosed to a relative width of 1e-4.
    assert!((edges[0] / edges[1] - 1.0).abs() < 1e-4, "{edges:?}");
}

// The program.

fn folder(scenario: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.toml"), scenario).unwrap();
    folder
}

#[test]
fn results_do_not_depend_on_threads_and_parts() {
    let work = folder(&format!("{}repeat = true\n", map_text()));
    let path = work.path();
    let said = done(path, &["map", "s.toml", "--threads", "1", "--out", "one"]);
    golden("map-free-hinges", &said);
    let whole = files(&path.join("one"));
    let table = String::from_utf8(whole["map.csv"].clone()).unwrap();
    let header = table.lines().next().unwrap();
    let last = "friction_demand,peak_rotation_rad,overturns_in,of,direction,outcomes";
    assert!(header.ends_with(last), "{header}");

    done(path, &["map", "s.toml", "--threads", "3", "--out", "three"]);
    assert_eq!(files(&path.join("three")), whole);

    for shard in ["1/2", "2/2"] {
        done(path, &["map", "s.toml", "--shard", shard, "--out", "parts"]);
    }
    // One of the parts was interrupted in its last line, and is resumed.
    let part = path.join("parts/map-2-of-2.part");
    let complete = fs::read(&part).unwrap();
    fs::write(&part, &complete[..complete.len() - 20]).unwrap();
    let (first, second) = ("parts/map-1-of-2.part", "parts/map-2-of-2.part");
    refused(path, &["merge", first, second], &["--shard 2/2 --resume"]);
    let resume = [
        "map", "s.toml", "--shard", "2/2", "--resume", "--out", "parts",
    ];
    // Nor does it continue with the other model of motion.
    let four = [&resume[..], &["--hinges", "four"]].concat();
    refused(
        path,
        &four,
        &["goes with a table [free_hinges] or [elastic_joints]"],
    );
    done(path, &resume);
    done(path, &["merge", first, second, "--out", "merged"]);
    assert_eq!(files(&path.join("merged")), whole);
}

/// With far too long steps the ends of an arch may separate in the computation. The reason for the failure of such a cell passes
/// from the part file to the merged results.
#[test]
fn a_cell_that_fails_keeps_its_reason_to_the_end() {
    // Rounding decides which steps cause this; among a few, one makes some cells fail.
    let steps_s = [0.04, 0.06, 0.08, 0.1, 0.13, 0.16, 0.2, 0.3, 0.5];
    let found = steps_s.into_iter().find_map(|step_s| {
        let text = format!(
            "{ARCH}[free_hinges]\nlongest_step_s = {step_s}\n\
             [ground.rectangular]\namplitude_g = 0.6\nduration_s = 0.2\n\
             [simulation]\nduration_s = 4.0\noutput_step_s = 1.0\n\
             [map]\nduration_s = [0.2, 0.3]\namplitude_g = [0.1, 0.5, 0.6, 0.8]\n"
        );
        let scenario = parsed(&text);
        let map = OverturningMap::of(&scenario).unwrap();
        let cells = (0..map.count()).map(|index| map.rows(&[index]).remove(0).result);
        let reasons: Vec<_> = cells
            .filter_map(|cell| match cell {
                Err(NoHistory::Failed(reason)) => Some(reason),
                _ => None,
            })
            .collect();
        (!reasons.is_empty()).then_some((text, reasons))
    });
    let (text, reasons) = found.expect("a cell that fails");
    let work = folder(&text);
    let path = work.path();
    let mut parts = Vec::new();
    for shard in ["1/2", "2/2"] {
        done(path, &["map", "s.toml", "--shard", shard, "--out", "parts"]);
        let name = format!("parts/map-{}.part", shard.replace('/', "-of-"));
        parts.push(fs::read_to_string(path.join(name)).unwrap());
    }
    for reason in &reasons {
        let written = serde_json::to_string(reason).unwrap();
        assert!(
            parts.iter().any(|part| part.contains(&written)),
            "{written}"
        );
    }
    let (first, second) = ("parts/map-1-of-2.part", "parts/map-2-of-2.part");
    let said = done(path, &["merge", first, second, "--out", "merged"]);
    assert!(said.contains(&reasons[0]), "{said}");
    let failed = format!("  failed: {}; the first: ", reasons.len());
    assert!(said.contains(&failed), "{said}");
    let summary = fs::read(path.join("merged/map.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
    let listed: Vec<_> = summary["failures"].as_array().unwrap().iter().collect();
    assert_eq!(listed.len(), reasons.len());
    for (failure, reason) in listed.into_iter().zip(&reasons) {
        assert_eq!(failure["reason"], **reason);
    }
    let table = fs::read_to_string(path.join("merged/map.csv")).unwrap();
    assert_eq!(table.matches(",failed,").count(), reasons.len());
    // Computed at once it is the same.
    done(path, &["map", "s.toml", "--out", "whole"]);
    assert_eq!(files(&path.join("merged")), files(&path.join("whole")));
}

#[test]
fn the_model_of_motion_can_be_chosen_on_the_command_line() {
    let four = map_text().replace("[free_hinges]\n", "");
    let prescribed = "[impact]\nmodel = \"prescribed\"\nrestitution = 0.5\n";
    let work = folder(&four);
    let path = work.path();
    fs::write(path.join("free.toml"), map_text()).unwrap();
    fs::write(path.join("impact.toml"), format!("{prescribed}{four}")).unwrap();
    let map = |file: &str, options: &[&str], out: &str| {
        let said = done(path, &[&["map", file, "--out", out], options].concat());
        (said, files(&path.join(out)))
    };
    let (_, as_four) = map("s.toml", &[], "a");
    let (said, as_free) = map("free.toml", &[], "b");
    assert!(!said.contains("[impact]"));
    assert_eq!(map("free.toml", &["--hinges", "four"], "c").1, as_four);
    assert_eq!(map("s.toml", &["--hinges", "free"], "d").1, as_free);
    let (said, files) = map("impact.toml", &["--hinges", "free"], "e");
    assert!(said.contains("[impact]"), "{said}");
    assert_eq!(files, as_free);
    assert_ne!(as_four["map.csv"], as_free["map.csv"]);

    // A part computed with one model does not belong to the other.
    let shard = ["map", "s.toml", "--shard", "1/2", "--out", "f"];
    done(path, &shard);
    let free = [&shard[..], &["--resume", "--hinges", "free"]].concat();
    refused(path, &free, &["belongs to another study"]);
}

#[test]
fn keys_of_four_links_are_refused_for_free_hinges() {
    let work = folder(&map_text());
    let path = work.path();
    let out = ["map", "s.toml", "--shard", "1/1", "--out", "part"];
    done(path, &out);

    for (axes, words) in [
        (
            "[map]\nrestitution = [0.4, 0.6]\namplitude_g = [0.5]\n",
            "s.toml:13:15: `restitution = [0.4, 0.6]` goes with four links",
        ),
        (
            "[map]\nrepeat = 2\nduration_s = [0.2]\namplitude_g = [0.5]\n",
            "s.toml:13:10: `repeat = 2`",
        ),
    ] {
        let errors = Scenario::parse(&map_text().replace(AXES, axes), "s.toml").unwrap_err();
        assert!(errors.to_string().contains(words), "{errors}");
    }
    let repeat = format!("{}repeat = true\n", map_text());
    assert!(
        Scenario::parse(&repeat, "s.toml")
            .unwrap()
            .map
            .clone()
            .unwrap()
            .repeat
    );
    let four = repeat.replace("[free_hinges]\n", "");
    let errors = Scenario::parse(&four, "s.toml").unwrap_err();
    let words = "`repeat = true` goes with a table [free_hinges] or [elastic_joints]";
    assert!(errors.to_string().contains(words), "{errors}");
}

fn read_with(file: &Path, model: &'static ModelKind) -> Result<Scenario, ScenarioErrors> {
    let changes = ReadOptions {
        model: Some(model),
        set: &[],
        ..ReadOptions::default()
    };
    Scenario::of(&Source::of_file(file)?, &changes)
}

#[test]
fn a_scenario_with_another_model_reads_back() {
    let work = folder(&map_text());
    let file = work.path().join("s.toml");
    let chosen = Scenario::read(&file).unwrap();
    let free = read_with(&file, &FREE_HINGES).unwrap();
    assert_eq!(free, chosen);
    let four = read_with(&file, &FOUR_LINKS).unwrap();
    assert_eq!(four.motion.kind, &FOUR_LINKS);
    for scenario in [free, four] {
        assert_eq!(parsed(&scenario.to_toml()), scenario);
    }
    // Free hinges need joints.
    fs::write(
        &file,
        map_text().replace("voussoirs = 7\n[free_hinges]\n", ""),
    )
    .unwrap();
    let errors = read_with(&file, &FREE_HINGES).unwrap_err();
    assert!(errors.to_string().contains("lacks `voussoirs`"), "{errors}");
}

#[test]
fn rows_of_a_suite_of_drums_equal_single_histories() {
    let work = folder(&format!(
        "{DRUMS}[suite]\nrecords = [\"wave-1.at2\", \"wave-2.at2\"]\npeaks_g = [0.15, 0.6, 3.0]\n\
         both_signs = false\n"
    ));
    let path = work.path();
    for name in ["wave-1.at2", "wave-2.at2"] {
        fs::copy(scenarios().join("records").join(name), path.join(name)).unwrap();
    }
    let said = done(path, &["suite", "s.toml", "--threads", "1", "--out", "one"]);
    assert!(said.contains("6 cases of 2 records"), "{said}");
    let whole = files(&path.join("one"));
    for (shard, threads) in [("1/2", "1"), ("2/2", "2")] {
        let arguments = ["suite", "s.toml", "--shard", shard, "--threads", threads];
        done(path, &[&arguments[..], &["--out", "parts"]].concat());
    }
    let parts = ["parts/suite-1-of-2.part", "parts/suite-2-of-2.part"];
    done(path, &["merge", parts[0], parts[1], "--out", "merged"]);
    assert_eq!(files(&path.join("merged")), whole);

    // The rows equal single histories under the scaled records.
    let mut overturned = 0;
    for row in Table::parse(&whole["suite.csv"]).rows {
        let text = format!(
            "{DRUMS}[ground.record]\nfile = {:?}\npeak_g = {}\n",
            &row["record"], &row["peak_g"]
        );
        fs::write(path.join("single.toml"), text).unwrap();
        let single = Scenario::read(&path.join("single.toml")).unwrap();
        let model = single.model().unwrap();
        let ending = Ending::of(&*model, single.ground_motion(), &single.request()).unwrap();
        assert_eq!(&row["outcome"], ending.outcome.name());
        let expected_rad = ending.peak_of_row_rad().unwrap();
        assert_eq!(row.number("peak_rotation_rad"), expected_rad);
        overturned += usize::from(row["outcome"] == "overturned");
    }
    assert!(0 < overturned && overturned < 6, "{overturned}");
}
