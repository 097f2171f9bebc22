//! The runner as a library: in memory and in files, cancelled, resumed, merged; and with rows that failed.

use std::fs;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::sleep;
use std::time::Duration;

use crate::common::parsed;
use crate::common::{GRAVITY, pairs, request};
use crate::program::{archrock, stderr};
use archrock::studies::map::boundary::{ImpactFreeBoundary, MapRow, MapWithBoundary};
use archrock::studies::map::{CellResult, OverturningMap};
use archrock::studies::part::{self, Header, PartError, PartFile, Shard};
use archrock::studies::runner::{Computed, Progress, Runner, RunnerError, Study, Task};
use archrock::{
    Column, GroundMotion, ImpactModel, MechanismModel as _, Model as _, Pulse, RockingColumn, Sway,
};

/// Cases of a few milliseconds whose rows are hard to write exactly; some of them fail.
#[derive(Default)]
struct Slow {
    begun: AtomicUsize,
}

const COUNT: usize = 60;

impl Study for Slow {
    type Row = Result<f64, String>;

    const NAME: &'static str = "slow";

    fn scenario(&self) -> String {
        "a = 1\n".to_owned()
    }

    fn count(&self) -> usize {
        COUNT
    }

    fn row(&self, index: usize) -> Self::Row {
        self.begun.fetch_add(1, Ordering::Relaxed);
        sleep(Duration::from_millis(10));
        expected(index)
    }
}

fn expected(index: usize) -> Result<f64, String> {
    if index % 7 == 3 {
        return Err(format!("case {index}, \"quoted\",\nin two lines"));
    }
    // Numbers of all kinds of digits and magnitudes.
    let index = index as f64;
    Ok((index + 0.1).sin() * 10.0_f64.powf(10.0 * (index - 30.0)))
}

fn all() -> Vec<Result<f64, String>> {
    (0..COUNT).map(expected).collect()
}

const fn threads(count: usize) -> Runner {
    Runner {
        threads: NonZeroUsize::new(count),
    }
}

fn task<'p>(folder: &'p Path, shard: &str, resume: bool) -> Task<'p> {
    Task {
        folder,
        shard: shard.parse().unwrap(),
        resume,
    }
}

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Breaks when this many are done.
fn until(most: usize) -> impl FnMut(Progress) -> ControlFlow<()> {
    move |progress| {
        if progress.done >= most {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

#[test]
fn rows_come_in_order_on_any_number_of_threads() {
    for count in [1, 2, 5] {
        let mut told = Vec::new();
        let rows = threads(count).rows(&Slow::default(), |progress| {
            told.push(progress);
            ControlFlow::Continue(())
        });
        assert_eq!(rows.unwrap(), all());
        assert_eq!(
            told[0],
            Progress {
                done: 0,
                all: COUNT
            }
        );
        assert_eq!(told[told.len() - 1].done, COUNT);
        assert!(told.is_sorted_by_key(|progress| progress.done));
    }
}

#[test]
fn cancelled_work_stops_soon_and_is_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let study = Slow::default();
    let cancelled = threads(2).rows(&study, until(1));
    assert!(matches!(cancelled, Err(RunnerError::Cancelled(_))));
    assert!(study.begun.load(Ordering::Relaxed) < COUNT);

    let study = Slow::default();
    let cancelled = threads(2).rows_in(&study, task(folder.path(), "1/1", false), until(1));
    let Err(RunnerError::Cancelled(Progress { done, all: COUNT })) = cancelled else {
        panic!("{cancelled:?}");
    };
    // The cases under way were finished, and no row is lost.
    assert_eq!(done, study.begun.load(Ordering::Relaxed));
    assert!(0 < done && done < COUNT);
    let path = folder.path().join("slow.part");
    assert_eq!(
        part::read_header(&path).unwrap(),
        Header::new(&study, Shard::WHOLE)
    );
    let header = Header::new(&study, Shard::WHOLE);
    let (file, rows) = PartFile::open::<Result<f64, String>>(&path, &header, true).unwrap();
    assert!(rows.len() == done && rows.iter().all(|(index, row)| *row == expected(*index)));
    drop(file);

    let study = Slow::default();
    let again = threads(2).rows_in(&study, task(folder.path(), "1/1", false), go_on);
    assert!(matches!(
        again,
        Err(RunnerError::Part(PartError::Interrupted { done: found, .. })) if found == done
    ));
    let mut first = None;
    let resumed = threads(2).rows_in(&study, task(folder.path(), "1/1", true), |progress| {
        first.get_or_insert(progress.done);
        ControlFlow::Continue(())
    });
    let Ok(Computed::Whole(rows, file)) = resumed else {
        panic!("{resumed:?}");
    };
    assert_eq!(first, Some(done));
    assert_eq!(study.begun.load(Ordering::Relaxed), COUNT - done);
    assert_eq!(rows, all());
    file.remove().unwrap();
    assert!(!path.exists());
}

#[test]
fn shards_are_merged_to_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let paths: Vec<_> = ["1/3", "2/3", "3/3"]
        .into_iter()
        .map(|shard| {
            let task = task(folder.path(), shard, false);
            match threads(3).rows_in(&Slow::default(), task, go_on) {
                Ok(Computed::Shard(file)) => file.path().to_owned(),
                other => panic!("{other:?}"),
            }
        })
        .collect();
    let (header, rows) = part::merge::<Result<f64, String>>(&paths).unwrap();
    assert_eq!(header, Header::new(&Slow::default(), Shard::WHOLE));
    assert_eq!(rows, all());
    // Rows are not read as another type.
    assert!(matches!(
        part::merge::<bool>(&paths),
        Err(PartError::Unusable { .. })
    ));
}

#[test]
fn a_folder_that_cannot_be_made_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let refused = Runner::default().rows_in(&Slow::default(), task(&file, "1/1", false), go_on);
    assert!(matches!(refused, Err(RunnerError::Folder { .. })));
}

/// The reason of a failure passes from the row through the part to the program's words; the other rows stay as they
/// are.
#[test]
fn failed_cells_keep_their_reason() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = parsed(
        "[column]\nheight_m = 4\nwidth_m = 0.8\n[ground.half_sine]\namplitude_g = 1\nduration_s = 1\n\
         [simulation]\nduration_s = 60\n[map]\nduration_s = [0.3, 0.6]\namplitude_g = [0.1, 0.4, 1.6]",
    );
    let map = OverturningMap::new(&scenario).unwrap();
    let study = MapWithBoundary::new(&map);
    let mut rows = Runner::default().rows(&study, go_on).unwrap();
    for (index, reason) in [(1, "the first reason"), (4, "another")] {
        let MapRow::Cell(cell) = &mut rows[index] else {
            panic!("cells come first");
        };
        cell.result = CellResult::Failed(reason.to_owned());
    }
    let MapRow::Boundary(last) = &mut rows[7] else {
        panic!("boundaries come last");
    };
    last.result = Err("no boundary".to_owned());
    let path = folder.path().join("map.part");
    let header = Header::new(&study, Shard::WHOLE);
    let (mut part, _) = PartFile::open::<MapRow>(&path, &header, false).unwrap();
    let rows: Vec<_> = rows.into_iter().enumerate().collect();
    part.append(&rows).unwrap();
    drop(part);
    let output = archrock(folder.path(), &["merge", "map.part", "--no-impact"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(
        said.contains(": the first reason; all are in map.json\n")
            && said.contains("failed: 3; the first: "),
        "{said}"
    );
    let summary = fs::read_to_string(folder.path().join("map.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let reasons: Vec<_> = summary["failures"]
        .as_array()
        .unwrap()
        .iter()
        .map(|failed| &failed["reason"])
        .collect();
    assert_eq!(reasons, ["the first reason", "another", "no boundary"]);
    let lines = |name| {
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        text.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let table = lines("map.csv");
    assert_eq!(
        (&*table[2], &*table[5]),
        ("0.3,0.4,failed,,,,,,", "0.6,0.4,failed,,,,,,")
    );
    assert_eq!(lines("no_impact.csv").len(), 2);
}

/// The edge by a plain search, in which every pulse is built from scratch.
fn plain_edge_g(column: &RockingColumn, pulse: Pulse, duration_s: f64) -> Option<f64> {
    let overturns = |amplitude_g: f64| {
        let ground = GroundMotion::pulse(pulse, amplitude_g * GRAVITY, duration_s, 0.0).unwrap();
        let overturns = column.overturns_without_impact(&ground, &request(60.0));
        overturns.unwrap().is_some()
    };
    let one_sided = matches!(
        pulse,
        Pulse::Rectangular | Pulse::HalfSine | Pulse::Triangular
    );
    let stride = if one_sided { 1.5 } else { 1.005 };
    let mut low_g = column.incipient_acceleration_g(Sway::Right).unwrap();
    let mut high_g = low_g;
    while !overturns(high_g) {
        if high_g >= 1000.0 {
            return None;
        }
        (low_g, high_g) = (high_g, (high_g * stride).min(1000.0));
    }
    while high_g - low_g > 1e-9 * high_g {
        let middle_g = 0.5 * (low_g + high_g);
        if overturns(middle_g) {
            high_g = middle_g;
        } else {
            low_g = middle_g;
        }
    }
    Some(high_g)
}

/// They are equal to the last bit.
#[test]
fn the_boundary_is_that_of_the_plain_search() {
    let mut edges = 0;
    for (width_m, durations_s) in [(0.4, [0.2, 2.0]), (1.7, [0.9, 5.5])] {
        let column = Column::new(4.0, width_m).unwrap();
        let column = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
        for pulse in Pulse::ALL {
            let scenario = parsed(&format!(
                "[column]\nheight_m = 4.0\nwidth_m = {width_m}\n\
                 [ground.{}]\namplitude_g = 1\nduration_s = 1\n[simulation]\nduration_s = 60\n\
                 [map]\nduration_s = {durations_s:?}\namplitude_g = [0.0001]",
                pulse.name()
            ));
            let map = OverturningMap::new(&scenario).unwrap();
            let rows = Runner::default()
                .rows(&ImpactFreeBoundary::new(&map).unwrap(), go_on)
                .unwrap();
            for (row, duration_s) in pairs(&rows, durations_s) {
                let found = row.result.clone().unwrap().unwrap();
                let expected_g = plain_edge_g(&column, *pulse, duration_s);
                assert_eq!(row.x, duration_s);
                edges += usize::from(expected_g.is_some());
                assert_eq!(
                    Some(found.incipient_g),
                    column.incipient_acceleration_g(Sway::Right)
                );
                assert_eq!(
                    found.impact_free_g.map(f64::to_bits),
                    expected_g.map(f64::to_bits),
                    "{pulse:?} of {duration_s} s: {found:?} {expected_g:?}"
                );
            }
        }
    }
    // All but a few durations have an amplitude that overturns.
    assert!(edges > 3 * Pulse::ALL.len(), "{edges}");
}
