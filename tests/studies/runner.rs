//! The runner as a library: in memory and in files, cancelled, resumed, merged; and with rows that failed.

use std::fs;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::sleep;
use std::time::Duration;

use crate::common::parsed;
use crate::common::program::{archrock, stdout};
use archrock::output::OutputError;
use archrock::studies::map::{CellRow, OverturningMap};
use archrock::studies::{
    Header, NoHistory, PartErrorKind, PartFile, Progress, Results, Runner, RunnerError, Shard,
    Study, Style, Task, merge_parts, read_header,
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
    const FILES: &'static [&'static str] = &[];

    fn scenario(&self) -> String {
        "a = 1\n".to_owned()
    }

    fn count(&self) -> usize {
        COUNT
    }

    fn rows(&self, indices: &[usize]) -> Vec<Self::Row> {
        let row = |index: &usize| {
            self.begun.fetch_add(1, Ordering::Relaxed);
            sleep(Duration::from_millis(10));
            expected(*index)
        };
        indices.iter().map(row).collect()
    }

    fn results(&self, _: Vec<Self::Row>, _: Style) -> Result<Results, OutputError> {
        Ok(Results::default())
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
        let mut reported = Vec::new();
        let rows = threads(count).rows(&Slow::default(), |progress| {
            reported.push(progress);
            ControlFlow::Continue(())
        });
        assert_eq!(rows.unwrap(), all());
        assert_eq!(reported[0], Progress::of_cases(0, COUNT));
        assert_eq!(reported[reported.len() - 1].done, COUNT);
        assert!(reported.is_sorted_by_key(|progress| progress.done));
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
    let Err(RunnerError::Cancelled(Progress {
        done, all: COUNT, ..
    })) = cancelled
    else {
        panic!("{cancelled:?}");
    };
    // The cases under way were finished, and no row is lost.
    assert_eq!(done, study.begun.load(Ordering::Relaxed));
    assert!(0 < done && done < COUNT);
    let path = folder.path().join("slow.part");
    assert_eq!(
        read_header(&path).unwrap(),
        Header::new(&study, Shard::WHOLE)
    );
    let header = Header::new(&study, Shard::WHOLE);
    let (file, rows) = PartFile::open::<Result<f64, String>>(&path, &header, true).unwrap();
    assert!(rows.len() == done && rows.iter().all(|(index, row)| *row == expected(*index)));
    drop(file);

    let study = Slow::default();
    let again = threads(2).rows_in(&study, task(folder.path(), "1/1", false), go_on);
    let Err(RunnerError::Part(error)) = again else {
        panic!("{again:?}");
    };
    assert_eq!(error.kind, PartErrorKind::Interrupted);
    assert!(
        error.message.contains(&format!("has {done} cases")),
        "{error}"
    );
    let mut first = None;
    let resumed = threads(2).rows_in(&study, task(folder.path(), "1/1", true), |progress| {
        first.get_or_insert(progress.done);
        ControlFlow::Continue(())
    });
    let Ok((Some(rows), file)) = resumed else {
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
                Ok((None, file)) => file.path().to_owned(),
                other => panic!("{other:?}"),
            }
        })
        .collect();
    let (header, rows) = merge_parts::<Result<f64, String>>(&paths).unwrap();
    assert_eq!(header, Header::new(&Slow::default(), Shard::WHOLE));
    assert_eq!(rows, all());
    // Rows are not read as another type.
    let error = merge_parts::<bool>(&paths).unwrap_err();
    assert_eq!(error.kind, PartErrorKind::Unusable);
}

#[test]
fn a_folder_that_cannot_be_created_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let refused = Runner::default().rows_in(&Slow::default(), task(&file, "1/1", false), go_on);
    let Err(RunnerError::Part(error)) = refused else {
        panic!("{refused:?}");
    };
    assert_eq!(error.kind, PartErrorKind::Folder);
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
    let study = OverturningMap::of(&scenario).unwrap();
    let mut rows = Runner::default().rows(&study, go_on).unwrap();
    for (index, reason) in [(1, "the first reason"), (4, "another")] {
        rows[index].result = Err(NoHistory::Failed(reason.to_owned()));
    }
    let path = folder.path().join("map.part");
    let header = Header::new(&study, Shard::WHOLE);
    let (mut part, _) = PartFile::open::<CellRow>(&path, &header, false).unwrap();
    let rows: Vec<_> = rows.into_iter().enumerate().collect();
    part.append(&rows).unwrap();
    drop(part);
    let output = archrock(folder.path(), &["merge", "map.part"]);
    let said = stdout(&output);
    assert!(
        said.contains(": the first reason; all are in map.json\n")
            && said.contains("failed: 2; the first: "),
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
    assert_eq!(reasons, ["the first reason", "another"]);
    let lines = |name| {
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        text.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let table = lines("map.csv");
    assert_eq!(
        (&*table[2], &*table[5]),
        ("0.3,0.4,failed,,,,,,,,,", "0.6,0.4,failed,,,,,,,,,")
    );
}
