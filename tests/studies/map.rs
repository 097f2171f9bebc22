//! The overturning map: its cells, and computing it in parts.

use crate::common;
use crate::common::parsed;
use crate::common::prose::golden;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::program::{command, done, files, refused};
use crate::common::{ARCH, GRAVITY, four_links, request};
use crate::studies::threshold_along::without_impact;
use archrock::mechanics::four_link::HingeSites;
use archrock::studies::map::OverturningMap;
use archrock::studies::{Ending, NoHistory, Study as _};
use archrock::{Outcome, Pulse, Scenario};

fn ending(map: &OverturningMap<'_>, index: usize) -> Ending {
    match map.rows(&[index]).remove(0).result {
        Ok(ending) => ending,
        other => panic!("cell {index}: {other:?}"),
    }
}

#[test]
fn a_cell_is_the_history_of_its_scenario() {
    let scenario = parsed(
        "[arch]\nmean_radius_m = 1.0\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 7\n\
         [ground.one_cosine]\namplitude_g = 0.3\nduration_s = 0.4\n\
         [map]\nmean_radius_m = [2.0, 10.0]\namplitude_g = [-0.8, 0.2, 1.5]",
    );
    let cells = OverturningMap::of(&scenario).unwrap();
    assert_eq!(cells.count(), 6);
    for index in 0..6 {
        let [mean_radius_m, amplitude_g] = cells.coordinates(index);
        let arch = four_links(mean_radius_m, 0.15, 157.5, HingeSites::Voussoirs(7));
        let ground = Pulse::OneCosine
            .lasting_s(0.4)
            .horizontal_m_s2(amplitude_g * GRAVITY)
            .unwrap();
        let expected = Ending::of(&arch, &ground, &request(10.0)).unwrap();
        assert_eq!(ending(&cells, index), expected);
    }
}

/// Several models have a folder each, with the results of each alone.
#[test]
fn a_map_of_several_models_has_a_folder_for_each() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n[ground.half_sine]\namplitude_g = 1.0\nduration_s = 1.0\n\
                [map]\nduration_s = [0.3]\namplitude_g = [0.1, 1.0]\n";
    fs::write(at.join("s.toml"), text).unwrap();
    done(
        at,
        &["map", "s.toml", "--hinges", "four,free", "--out", "both"],
    );
    for model in ["four", "free"] {
        done(at, &["map", "s.toml", "--hinges", model, "--out", model]);
        assert_eq!(
            files(&at.join("both").join(model)),
            files(&at.join(model)),
            "{model}"
        );
    }
    let printed = done(
        at,
        &["map", "s.toml", "--hinges", "four,free", "--format", "json"],
    );
    let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
    for model in ["four", "free"] {
        assert_eq!(json[model]["cases"], 2, "{model}");
    }
    let quiet = [
        "map", "s.toml", "--shard", "1/2", "--out", "part", "--quiet",
    ];
    assert_eq!(done(at, &quiet), "");
}

#[test]
fn the_frequency_is_the_inverse_of_the_duration() {
    let text = |map: &str| {
        format!("{ARCH}[ground.half_sine]\namplitude_g = 0.4\nduration_s = 0.5\n[map]\n{map}")
    };
    let by_duration = parsed(&text("duration_s = [0.25, 0.5]\namplitude_g = [0.4, 0.9]"));
    let by_frequency = parsed(&text("frequency_hz = [2.0, 4.0]\namplitude_g = [0.4, 0.9]"));
    let (by_duration, by_frequency) = (
        OverturningMap::of(&by_duration).unwrap(),
        OverturningMap::of(&by_frequency).unwrap(),
    );
    for (index, other) in [(0, 2), (1, 3), (2, 0), (3, 1)] {
        assert_eq!(ending(&by_duration, index), ending(&by_frequency, other));
    }
}

/// A half sine of duration t has the peak velocity 2 / pi a t.
#[test]
fn the_velocity_ratio_gives_the_duration() {
    let text = |map: &str| {
        parsed(&format!(
            "{ARCH}[ground.half_sine]\namplitude_g = 0.4\nduration_s = 0.5\n[map]\n{map}"
        ))
    };
    let by_duration = text("duration_s = [0.25, 0.5]\namplitude_g = [0.4, 0.9]");
    let ratios_s = [0.25, 0.5].map(|duration_s| 2.0 / PI * duration_s);
    let by_ratio = text(&format!(
        "pgv_over_pga_s = {ratios_s:?}\namplitude_g = [0.4, 0.9]"
    ));
    let maps = [&by_duration, &by_ratio].map(|scenario| OverturningMap::of(scenario).unwrap());
    for index in 0..4 {
        let [own, other] = maps.each_ref().map(|map| ending(map, index));
        assert_eq!((own.outcome, own.impacts), (other.outcome, other.impacts));
        let [own, other] = [own, other].map(|ending| ending.peak_over_critical.unwrap());
        assert!((own / other - 1.0).abs() < 1e-6, "{own} {other}");
    }
}

/// A pulse to the other side gives the mirror image, to the last bit. An arch four times as large under a pulse twice as long has
/// the motion of the small arch in twice the time.
#[test]
fn maps_have_the_symmetries_of_the_mechanics() {
    let text = |map: &str| {
        format!(
            "{ARCH}[ground.one_cosine]\namplitude_g = 0.5\nduration_s = 0.8\n\
             [simulation]\nduration_s = 60.0\n[map]\n{map}"
        )
    };
    let mirrored = parsed(&text(
        "duration_s = [0.6, 0.8, 1.2]\namplitude_g = [-2.0, -0.5, -0.2, 0.2, 0.5, 2.0]",
    ));
    let cells = OverturningMap::of(&mirrored).unwrap();
    for (column, row) in (0..3).flat_map(|column| (0..3).map(move |row| (column, row))) {
        let left = ending(&cells, column * 6 + row);
        let right = ending(&cells, column * 6 + 5 - row);
        let outcome = match left.outcome {
            Outcome::Overturned(sway) => Outcome::Overturned(sway.opposite()),
            other => other,
        };
        assert_eq!(Ending { outcome, ..left }, right);
    }
    let scaled = parsed(&text("mean_radius_m = [2.0, 8.0]\nduration_s = [0.4, 0.8]"));
    let cells = OverturningMap::of(&scaled).unwrap();
    assert_eq!(
        cells.axes.map(|axis| axis.quantity.name()),
        ["duration_s", "mean_radius_m"]
    );
    // Cells 0 and 3: 0.4 s at 2 m, 0.8 s at 8 m.
    let (small, large) = (ending(&cells, 0), ending(&cells, 3));
    assert_eq!(
        (small.outcome, small.impacts),
        (large.outcome, large.impacts)
    );
    let [small_peak, large_peak] = [&small, &large].map(|one| one.peak_over_critical.unwrap());
    assert!((small_peak - large_peak).abs() < 1e-9);
    assert!((2.0 * small.outcome_time_s - large.outcome_time_s).abs() < 1e-6);
    assert!(small.impacts > Some(0));
}

#[test]
fn shapes_without_four_link_mechanism_have_no_history() {
    let scenario = parsed(&format!(
        "{ARCH}[ground.rectangular]\namplitude_g = 0.4\nduration_s = 0.2\n\
         [map]\nthickness_ratio = [0.1, 0.15, 0.4]\nembrace_deg = [90.0, 180.0]"
    ));
    let cells = OverturningMap::of(&scenario).unwrap();
    let found: Vec<_> = (0..6)
        .map(|index| cells.rows(&[index]).remove(0).result)
        .collect();
    assert!(
        matches!(found[1], Err(NoHistory::CannotStand)),
        "0.10 at 180 degrees is too thin"
    );
    assert!(found[3].is_ok(), "0.15 at 180 degrees stands");
    assert!(
        matches!(found[4], Err(NoHistory::NotFourLinks)),
        "0.40 at 90 degrees has no four links"
    );
}

#[test]
fn a_map_does_not_cut_pulses_off() {
    let text = |axis: &str| {
        format!(
            "{ARCH}[ground.ricker]\namplitude_g = 1\nduration_s = 1\nstart_s = 1.0\n\
             [simulation]\nduration_s = 10\n[map]\n{axis}\namplitude_g = [1, 2]"
        )
    };
    // Ricker wavelets last four durations.
    for axis in ["duration_s = [1, 2.25]", "frequency_hz = [0.44, 1]"] {
        let scenario = parsed(&text(axis));
        let whole = OverturningMap::of(&scenario);
        assert_eq!(whole.is_ok(), axis.contains("2.25"), "{axis}");
    }
    let scenario = parsed(&text("duration_s = [1, 2.5]"));
    let Err(error) = OverturningMap::of(&scenario) else {
        panic!("its pulses are cut off");
    };
    let words = "[map] has pulses that last until 11 s";
    assert!(error.contains(words), "{error}");
}

/// Above amplitudes that overturn there are some that do not; bisection would never find them. At a tolerance
/// a thousand times finer they are the same.
#[test]
fn safe_islands_above_the_first_overturning_amplitude_survive() {
    let outcomes = |tolerance: f64| {
        let scenario = parsed(&format!(
            "{ARCH}[ground.one_cosine]\namplitude_g = 1.0\nduration_s = 0.8\n\
             [simulation]\nduration_s = 30.0\nrelative_tolerance = {tolerance:e}\n\
             [map]\nduration_s = [0.8]\n\
             amplitude_g = {{ from = 0.2, to = 2.0, count = 37 }}"
        ));
        let cells = OverturningMap::of(&scenario).unwrap();
        let found: Vec<_> = (0..cells.count())
            .map(|index| {
                let verdict = ending(&cells, index);
                let overturns = matches!(verdict.outcome, Outcome::Overturned(_));
                (cells.coordinates(index)[1], overturns, verdict.impacts)
            })
            .collect();
        found
    };
    let found = outcomes(1e-9);
    let pulse = "[ground.one_cosine]\namplitude_g = 1.0\nduration_s = 0.8\n";
    let free_g = without_impact(&format!("{ARCH}{pulse}"), "one_cosine", &[0.8])[0];
    let first = found
        .iter()
        .position(|(_, overturns, _)| *overturns)
        .unwrap();
    let island: Vec<_> = found[first..]
        .iter()
        .filter(|(_, overturns, _)| !overturns)
        .map(|(amplitude_g, ..)| *amplitude_g)
        .collect();
    assert!(island.len() >= 3, "{found:?}");
    assert!(island.iter().all(|amplitude_g| *amplitude_g < free_g));
    // Below the island it overturns after impacts, above it without impact.
    assert!(found[first].2 > Some(0) && found.last().unwrap().2 == Some(0));
    let verdicts = |found: Vec<(f64, bool, Option<usize>)>| -> Vec<_> {
        found
            .into_iter()
            .map(|(a, overturns, n)| (a.to_bits(), overturns, overturns.then_some(n)))
            .collect()
    };
    assert_eq!(verdicts(found), verdicts(outcomes(1e-12)));
}

// The program, computing in parts.

/// A folder with `s.toml`: a map with this many cells along each side.
fn folder_with_map(count: usize) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "title = \"a, \\\"b\\\"\"\n{ARCH}[ground.one_sine]\namplitude_g = 0.4\nduration_s = 0.5\n\
         [map]\nduration_s = {{ from = 0.1, to = 1.5, count = {count} }}\n\
         amplitude_g = {{ from = 0.1, to = 2.0, count = {count}, spacing = \"logarithmic\" }}\n"
    );
    fs::write(folder.path().join("s.toml"), text).unwrap();
    folder
}

#[test]
fn threads_and_parts_do_not_change_a_bit() {
    let folder = folder_with_map(13);
    let path = folder.path();
    let said = done(path, &["map", "s.toml", "--threads", "1"]);
    golden("map", &said);
    let whole = files(&path.join("results/s"));
    assert_eq!(
        whole.keys().collect::<Vec<_>>(),
        ["map.csv", "map.html", "map.json", "map.svg"]
    );
    let table = String::from_utf8(whole["map.csv"].clone()).unwrap();
    assert_eq!(table.lines().count(), 170);
    assert!(table.starts_with(
        "duration_s,amplitude_g,outcome,overturning_sway,impacts,impacts_before_overturning,\
         outcome_time_s,peak_rotation_over_critical,energy_defect_ratio,thrust_excess_ratio,friction_demand,direction\n\
         0.1,0.1,never_moved,,0,,"
    ));

    done(
        path,
        &[
            "--quiet",
            "map",
            "s.toml",
            "--threads",
            "3",
            "--out",
            "three",
        ],
    );
    assert_eq!(files(&path.join("three")), whole);

    for shard in ["1/3", "2/3", "3/3"] {
        let said = done(path, &["map", "s.toml", "--shard", shard, "--out", "parts"]);
        assert!(said.contains("archrock merge"), "{said}");
    }
    let parts = [
        "parts/map-2-of-3.part",
        "parts/map-1-of-3.part",
        "parts/map-3-of-3.part",
    ];
    done(path, &[&["merge", "--out", "merged"], &parts[..]].concat());
    assert_eq!(files(&path.join("merged")), whole);
    // The parts stay where they are.
    done(path, &[&["merge"], &parts[..]].concat());
    assert_eq!(
        fs::read(path.join("parts/map.csv")).unwrap(),
        whole["map.csv"]
    );
    assert_eq!(files(&path.join("parts")).len(), 7);
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let folder = folder_with_map(4);
    let path = folder.path();
    for shard in ["1/2", "2/2"] {
        done(path, &["map", "s.toml", "--shard", shard, "--out", "a"]);
    }
    done(path, &["map", "s.toml", "--shard", "1/4", "--out", "a"]);
    let (one, two) = ("a/map-1-of-2.part", "a/map-2-of-2.part");
    refused(
        path,
        &["merge", one],
        &["1 of 2 parts missing: the first is 2/2"],
    );
    refused(
        path,
        &["merge", one, two, one],
        &["part 1/2, and so is a/map-1-of-2.part"],
    );
    refused(
        path,
        &["merge", two, "a/map-1-of-4.part"],
        &["4 parts instead of 2"],
    );
    refused(path, &["merge", one, "s.toml"], &["s.toml: ", "not a part"]);
    // Before version 0.3.0, headers had no number of the row format.
    let rows = fs::read_to_string(path.join(two)).unwrap();
    let older = rows.replacen("\"row_format\":1,", "", 1);
    let older = older.replacen("\"version\":\"0.3.0\"", "\"version\":\"0.2.0\"", 1);
    assert_ne!(older, rows);
    fs::write(path.join(two), &older).unwrap();
    let words = [
        "archrock 0.2.0",
        "compute the part again, or use archrock 0.2.0",
    ];
    refused(path, &["merge", one, two], &words);
    let resume = ["map", "s.toml", "--shard", "2/2", "--out", "a", "--resume"];
    refused(path, &resume, &words);
    fs::write(path.join(two), &rows).unwrap();
    refused(
        path,
        &["merge", one, "nowhere"],
        &["nowhere: cannot be read"],
    );

    let text = fs::read_to_string(path.join("s.toml")).unwrap();
    fs::write(
        path.join("s.toml"),
        text.replace("amplitude_g = 0.4", "amplitude_g = 0.5"),
    )
    .unwrap();
    done(path, &["map", "s.toml", "--shard", "2/2", "--out", "b"]);
    refused(
        path,
        &["merge", one, "b/map-2-of-2.part"],
        &["\"amplitude_g = 0.5\" instead of \"amplitude_g = 0.4\""],
    );

    let part = fs::read_to_string(path.join(two)).unwrap();
    let older = part.replacen(env!("CARGO_PKG_VERSION"), "0.0.9", 1);
    fs::write(path.join("older.part"), older).unwrap();
    refused(path, &["merge", one, "older.part"], &["version \"0.0.9\""]);
    let lines: Vec<_> = part.lines().collect();
    fs::write(
        path.join("short.part"),
        lines[..lines.len() - 1].join("\n") + "\n",
    )
    .unwrap();
    refused(
        path,
        &["merge", one, "short.part"],
        &["7 of its 8 cases", "--shard 2/2 --resume"],
    );
    fs::write(path.join("twice.part"), format!("{part}{}\n", lines[3])).unwrap();
    refused(
        path,
        &["merge", one, "twice.part"],
        &["line 10", "appears twice"],
    );
    let other = fs::read_to_string(path.join(one)).unwrap();
    let alien = other.lines().last().unwrap();
    fs::write(path.join("alien.part"), format!("{part}{alien}\n")).unwrap();
    refused(
        path,
        &["merge", one, "alien.part"],
        &["line 10", "another part"],
    );
    // Whatever is changed in a row is detected.
    let row = lines[4];
    for edited in [
        row.replacen(',', ",1", 2),
        row.replacen(".", ".0", 1),
        format!("{row},0"),
        row[..row.len() - 1].to_owned(),
        row[9..].to_owned(),
    ] {
        assert!(edited != row);
        fs::write(path.join("edited.part"), part.replace(row, &edited)).unwrap();
        refused(
            path,
            &["merge", one, "edited.part"],
            &["edited.part: line 5: damaged", "compute this part again"],
        );
    }
}

/// Whatever fraction of a part file is left, resuming it gives the same results.
#[test]
fn a_torn_part_is_resumed_to_the_same_results() {
    let folder = folder_with_map(7);
    let path = folder.path();
    done(path, &["map", "s.toml", "--out", "whole"]);
    let whole = files(&path.join("whole"));
    // Part 1 of 1 is the whole.
    done(path, &["map", "s.toml", "--out", "one", "--shard", "1/1"]);
    assert_eq!(files(&path.join("one")), whole);
    done(path, &["map", "s.toml", "--out", "parts", "--shard", "1/2"]);
    done(path, &["map", "s.toml", "--out", "parts", "--shard", "2/2"]);
    let part = fs::read(path.join("parts/map-1-of-2.part")).unwrap();
    let header = part.iter().position(|byte| *byte == b'\n').unwrap();
    for cut in [
        0,
        1,
        header,
        header + 1,
        header + 2,
        header + 200,
        part.len() - 1,
        part.len(),
    ] {
        fs::write(path.join("parts/map-1-of-2.part"), &part[..cut]).unwrap();
        done(
            path,
            &[
                "map", "s.toml", "--out", "parts", "--shard", "1/2", "--resume",
            ],
        );
        let parts = ["parts/map-1-of-2.part", "parts/map-2-of-2.part"];
        done(path, &[&["merge", "--out", "merged"], &parts[..]].concat());
        assert_eq!(files(&path.join("merged")), whole, "cut at {cut}");
    }
}

#[test]
fn interrupted_work_is_kept_and_not_mixed() {
    let folder = folder_with_map(5);
    let path = folder.path();
    done(path, &["map", "s.toml", "--out", "r", "--shard", "1/2"]);
    let part = fs::read_to_string(path.join("r/map-1-of-2.part")).unwrap();
    let some = part
        .lines()
        .take(4)
        .map(|line| format!("{line}\n"))
        .collect::<String>();
    fs::write(path.join("r/map-1-of-2.part"), &some).unwrap();
    let again = ["map", "s.toml", "--out", "r", "--shard", "1/2"];
    refused(path, &again, &["3 cases", "--resume", "remove it"]);
    // A part file under the name of another part.
    let renamed = ["map", "s.toml", "--out", "r", "--shard", "2/2", "--resume"];
    fs::copy(
        path.join("r/map-1-of-2.part"),
        path.join("r/map-2-of-2.part"),
    )
    .unwrap();
    refused(
        path,
        &renamed,
        &["map-2-of-2.part", "part 1/2 instead of 2/2"],
    );
    assert_eq!(
        fs::read_to_string(path.join("r/map-2-of-2.part")).unwrap(),
        some
    );
    // A changed scenario has different cells.
    let text = fs::read_to_string(path.join("s.toml")).unwrap();
    fs::write(path.join("s.toml"), text.replace("5.0", "6.0")).unwrap();
    let resume = [&again[..], &["--resume"]].concat();
    let difference = "\"mean_radius_m = 5.0\" instead of \"mean_radius_m = 6.0\"";
    refused(path, &resume, &[difference, "another folder"]);
    refused(path, &again, &[difference, "another folder"]);
    assert_eq!(
        fs::read_to_string(path.join("r/map-1-of-2.part")).unwrap(),
        some
    );
    // A complete part is not computed again.
    fs::write(path.join("s.toml"), text).unwrap();
    fs::write(path.join("r/map-1-of-2.part"), &part).unwrap();
    done(path, &again);
    done(path, &resume);
    assert_eq!(
        fs::read_to_string(path.join("r/map-1-of-2.part")).unwrap(),
        part
    );
}

#[test]
fn two_programs_do_not_work_on_one_part() {
    let folder = folder_with_map(300);
    let path = folder.path();
    let locked = "the folder r is being written to by another run";
    let same_part = "another archrock is writing this file: wait until it ends";
    for (shard, part, same) in [
        (&[][..], "r/map.part", locked),
        (&["--shard", "1/2"], "r/map-1-of-2.part", same_part),
    ] {
        let mut child = start_long_work(path, shard);
        let begun = Instant::now();
        while fs::metadata(path.join(part)).map_or(0, |file| file.len()) < 10_000 {
            assert!(begun.elapsed() < Duration::from_secs(30), "no rows");
            sleep(Duration::from_millis(5));
        }
        for more in [&[][..], &["--resume"]] {
            let again = ["map", "s.toml", "--out", "r"];
            refused(path, &[&again, shard, more].concat(), &[same]);
            // The whole study has the folder for itself.
            refused(path, &[&again, more].concat(), &[locked]);
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
}

/// A map that takes some seconds on one thread.
fn start_long_work(folder: &Path, more: &[&str]) -> Child {
    let arguments = ["map", "s.toml", "--out", "r", "--resume", "--threads", "2"];
    command(folder, &[&arguments[..], more].concat())
        .spawn()
        .unwrap()
}

#[test]
fn work_killed_at_any_moment_resumes_to_the_same_results() {
    let folder = folder_with_map(36);
    let path = folder.path();
    let begun = Instant::now();
    done(path, &["map", "s.toml", "--out", "whole"]);
    let whole_s = begun.elapsed().as_secs_f64();
    let mut kills = 0;
    let mut random = common::Random(7);
    for _ in 0..40 {
        let mut child = start_long_work(path, &[]);
        sleep(Duration::from_secs_f64(0.4 * whole_s * random.next()));
        if child.try_wait().unwrap().is_none() {
            child.kill().unwrap();
            kills += 1;
        }
        child.wait().unwrap();
        // Results are either complete or absent.
        if let Ok(table) = fs::read(path.join("r/map.csv")) {
            assert!(table == fs::read(path.join("whole/map.csv")).unwrap());
            for name in ["map.svg", "map.json"] {
                assert!(path.join("r").join(name).exists(), "{name}");
            }
            break;
        }
    }
    assert!(kills >= 2, "{kills} kills");
    let again = ["map", "s.toml", "--out", "r", "--resume"];
    done(path, &again);
    assert_eq!(files(&path.join("r")), files(&path.join("whole")));
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_within_a_second_and_prints_how_to_resume() {
    let folder = folder_with_map(200);
    let path = folder.path();
    let child = start_long_work(path, &[]);
    let part = path.join("r/map.part");
    let begun = Instant::now();
    while fs::metadata(&part).map_or(0, |file| file.len()) < 10_000 {
        assert!(begun.elapsed() < Duration::from_secs(30), "no rows");
        sleep(Duration::from_millis(5));
    }
    let interrupt = |signal: &str| {
        Command::new("kill")
            .args([signal, &child.id().to_string()])
            .status()
    };
    assert!(interrupt("-INT").unwrap().success());
    let begun = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(
        begun.elapsed() < Duration::from_secs(1),
        "{:?}",
        begun.elapsed()
    );
    assert_eq!(output.status.code(), Some(130));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("interrupted: ") && said.contains("--resume"),
        "{said}"
    );
    let done = fs::read_to_string(&part).unwrap().lines().count() - 1;
    assert!(done > 50 && done < 40_000, "{done}");
}

#[track_caller]
fn assert_error(map: &str, place: &str, words: &[&str]) {
    let text = format!("{ARCH}[ground.ricker]\namplitude_g = 1\nduration_s = 1\n[map]\n{map}");
    let errors = Scenario::parse(&text, "s.toml").unwrap_err().to_string();
    assert_eq!(errors.lines().count(), 1, "{errors}");
    assert!(errors.starts_with(&format!("s.toml:{place}: ")), "{errors}");
    for word in words {
        assert!(errors.contains(word), "{word:?} is not in: {errors}");
    }
}

#[test]
fn errors_of_a_map_name_their_place_and_remedy() {
    let both = |second: &str| format!("duration_s = [0.1, 0.2]\n{second}");
    assert_error(
        "duration_s = [0.1]",
        "8:1",
        &["exactly two of the keys", "amplitude_g"],
    );
    assert_error(
        &both("embrace_deg = [90]\namplitude_g = [1]"),
        "8:1",
        &["exactly two"],
    );
    for other in ["frequency_hz", "pgv_over_pga_s"] {
        let column = other.len() + 4;
        let expected = ["both give the duration", "duration_s"];
        assert_error(
            &both(&format!("{other} = [1]")),
            &format!("10:{column}"),
            &expected,
        );
    }
    let long = format!(
        "{ARCH}[ground.one_cosine]\namplitude_g = 0.4\nduration_s = 0.5\n[map]\npgv_over_pga_s = [1e6]\namplitude_g = [1]\n"
    );
    let refused = OverturningMap::of(&parsed(&long)).unwrap_err();
    assert!(
        refused.contains("duration is 6.28319e6") && refused.contains("to 1e6"),
        "{refused}"
    );
    assert_error(
        "pgv_over_pga_s = [1]\n\"ground.gabor.gamma\" = [2]",
        "9:18",
        &["change the shape of the pulse"],
    );
    assert_error(
        &both("amplitude_g = [2, 1]"),
        "10:15",
        &["does not ascend", "from = "],
    );
    assert_error(
        "frequency_hz = [1e-9, 1]\namplitude_g = [1]",
        "9:16",
        &["from 1e-6"],
    );
    assert_error(&both("amplitude_g = []"), "10:15", &["is empty"]);
    assert_error(
        &both("amplitude_g = [1, 'x']"),
        "10:15",
        &["element (number 2)", "is a string"],
    );
    assert_error(
        &both("amplitude_g = [1, 2000]"),
        "10:15",
        &["number 2", "out of range", "to 1000"],
    );
    assert_error(
        &both("amplitude_g = 3"),
        "10:15",
        &["is a single number", "an array of ascending numbers"],
    );
    assert_error(
        &both("amplitude_g = { from = 1, to = 2, count = 1 }"),
        "10:43",
        &["`count = 1`", "2 (the ends)"],
    );
    assert_error(
        &both("amplitude_g = { from = 2, to = 1, count = 3 }"),
        "10:32",
        &["`to = 1`", "above 2"],
    );
    assert_error(
        &both("amplitude_g = { from = -1, to = 1, count = 3, spacing = 'logarithmic' }"),
        "10:57",
        &["one sign"],
    );
    assert_error(
        &both("amplitude_g = { from = 1, to = 1.0000000000000002, count = 3 }"),
        "10:60",
        &["`count = 3`", "give a smaller one"],
    );
    assert_error(
        &both("amplitude_g = { from = 1, count = 3 }"),
        "10:15",
        &["lacks `to`"],
    );
    assert_error(
        &both("amplitude_g = [1, 2]\nvoussoirs = [5, 7]"),
        "11:1",
        &["unknown key", "thickness_ratio"],
    );
    assert_error(&both("restitution = [0.5]"), "10:15", &["prescribed"]);
    let cells = "duration_s = { from = 1, to = 2, count = 2000 }\n\
                 amplitude_g = { from = 1, to = 2, count = 2000 }";
    assert_error(cells, "8:1", &["4000000 cells", "1000000"]);
}

#[test]
fn a_map_needs_a_ground_motion_and_a_column_has_no_radius() {
    let map = "[map]\nmean_radius_m = [1, 2]\namplitude_g = [1, 2]\n";
    let column =
        "[column]\nheight_m = 4\nwidth_m = 1\n[ground.ricker]\namplitude_g = 1\nduration_s = 1\n";
    let errors = Scenario::parse(&format!("{column}{map}"), "s.toml").unwrap_err();
    assert!(
        errors.to_string().contains("applies to a circular [arch]"),
        "{errors}"
    );
    let still = parsed(&format!("{ARCH}{map}"));
    let Err(error) = OverturningMap::of(&still) else {
        panic!("a map without a ground motion");
    };
    assert!(error.contains("[map] needs a ground motion"), "{error}");
    assert!(OverturningMap::of(&still).is_err());

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("s.toml"), ARCH).unwrap();
    refused(path, &["map", "s.toml"], &["no [map]", "amplitude_g = {"]);
    refused(path, &["map", "s.toml", "--shard", "3/2"], &["1 <= I <= N"]);
    let shapes = "[ground.ricker]\namplitude_g = 1\nduration_s = 1\n\
                  [map]\nthickness_ratio = [0.15]\nembrace_deg = [180]\n";
    fs::write(path.join("s.toml"), format!("{ARCH}{shapes}")).unwrap();
    let initial = "[initial]\nsway = \"left\"\nrotation_rad = 0.01\n";
    fs::write(path.join("s.toml"), format!("{ARCH}{initial}{shapes}")).unwrap();
    refused(path, &["map", "s.toml"], &["leave [initial] out"]);
}

#[test]
fn a_map_reads_back() {
    for map in [
        "restitution = [0.2, 0.5]\namplitude_g = { from = -3, to = -0.1, count = 5, spacing = 'logarithmic' }",
        "thickness_ratio = { from = 0.12, to = 0.2, count = 4 }\nembrace_deg = [160, 180]",
        "frequency_hz = [0.5]\nmean_radius_m = { from = 1, to = 100, count = 3, spacing = 'logarithmic' }",
    ] {
        let scenario = parsed(&format!(
            "{ARCH}[ground.ricker]\namplitude_g = 1\nduration_s = 1\n\
             [impact]\nmodel = 'prescribed'\nrestitution = 0.5\n[map]\n{map}"
        ));
        assert_eq!(parsed(&scenario.to_toml()), scenario);
        for axis in OverturningMap::of(&scenario).unwrap().values {
            assert!(axis.is_sorted_by(|earlier, later| earlier < later));
        }
    }
}
