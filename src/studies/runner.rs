//! Computes the cases of a study on all processors and reports progress. The work can be cancelled and resumed.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use archrock::studies::runner::{Runner, Study};
//!
//! struct Squares;
//!
//! impl Study for Squares {
//!     type Row = usize;
//!     const NAME: &'static str = "squares";
//!
//!     fn count(&self) -> usize {
//!         1000
//!     }
//!
//!     fn rows(&self, indices: &[usize]) -> Vec<usize> {
//!         indices.iter().map(|index| index * index).collect()
//!     }
//! }
//!
//! let mut done = 0;
//! let rows = Runner::default().rows(&Squares, |progress| {
//!     done = progress.done;
//!     ControlFlow::Continue(())
//! })?;
//! assert_eq!((done, rows[30]), (1000, 900));
//! # Ok::<(), archrock::studies::runner::RunnerError>(())
//! ```

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::ops::{ControlFlow, RangeInclusive};
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, TryRecvError};
use std::time::Duration;
use std::{fs, thread};

use rayon::iter::{
    IndexedParallelIterator as _, IntoParallelRefIterator as _, ParallelIterator as _,
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use thiserror::Error;

use super::part::{Header, PartError, PartErrorKind, PartFile, Rows, Shard};
use crate::scenario::Scenario;

/// A study: many cases, each a function of its index alone. So the cases can be computed in any order, by any number of threads, on several
/// machines.
pub trait Study: Sync {
    /// The result of a case. A failed case also has a row; the row holds the reason.
    type Row: Serialize + DeserializeOwned + Send;

    /// Name of the study, in part files and in their names.
    const NAME: &'static str;

    /// Returns the scenario of the cases; `None` for a study without a scenario.
    fn base(&self) -> Option<&Scenario> {
        None
    }

    /// Returns the scenario as TOML with every default filled in. Apart from options and inputs, the rows depend only on the scenario.
    fn scenario(&self) -> String {
        self.base().map_or(String::new(), Scenario::to_toml)
    }

    /// Returns the options of the study, null without options. The rows depend on them.
    fn options(&self) -> Value {
        Value::Null
    }

    /// Returns the other input on which the rows depend: name and checksum of each file that the scenario names, separated by a space.
    fn inputs(&self) -> Vec<String> {
        self.base().map_or(Vec::new(), Scenario::record_checksums)
    }

    /// Returns the number of cases.
    fn count(&self) -> usize;

    /// Returns the family of a case; `None` if the case is computed alone. Cases of one family are computed faster together.
    fn family(&self, _index: usize) -> Option<usize> {
        None
    }

    /// Computes the rows of some cases of one family, in their order; their indices are below [`Study::count`]. No row depends on the other
    /// cases.
    fn rows(&self, indices: &[usize]) -> Vec<Self::Row>;
}

impl Header {
    /// Returns the header for a shard of a study, with the version of this program.
    pub fn new<S: Study>(study: &S, shard: Shard) -> Self {
        Self {
            program: env!("CARGO_PKG_NAME").to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            study: S::NAME.to_owned(),
            cases: study.count(),
            shard,
            scenario: study.scenario(),
            options: study.options(),
            inputs: study.inputs(),
        }
    }
}

/// The progress of the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Number of cases done, including those of an earlier run.
    pub done: usize,
    /// Number of all cases.
    pub all: usize,
}

/// Function that receives the progress of a study. The work stops when the function returns `Break`.
pub type Watch<'w> = &'w mut dyn FnMut(Progress) -> ControlFlow<()>;

/// Reasons why the rows of a study are incomplete.
#[derive(Debug, Error)]
pub enum RunnerError {
    /// The caller cancelled.
    #[error("cancelled: {} of {} cases are done", .0.done, .0.all)]
    Cancelled(Progress),
    /// The file of the part cannot be used.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The threads could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(String),
}

/// A task to compute in a folder.
#[derive(Clone, Copy, Debug)]
pub struct Task<'p> {
    /// The folder; it is created if necessary.
    pub folder: &'p Path,
    /// The cases to compute.
    pub shard: Shard,
    /// True to continue an interrupted run, if there is one.
    pub resume: bool,
}

/// The rows of all cases, `None` for a shard, and the part file. The part file is kept until the results are written.
pub type RowsInFile<R> = (Option<Vec<R>>, PartFile);

/// Computes the rows of studies.
#[derive(Clone, Copy, Debug, Default)]
pub struct Runner {
    /// The number of threads; `None`: as many as there are processors.
    pub threads: Option<NonZeroUsize>,
}

/// Number of cases of a family that are computed together: at least as many as the vectorized code takes side by side, and few enough that no
/// thread runs out of work.
const TOGETHER: RangeInclusive<usize> = 8..=64;

/// Interval at which rows are written and progress is reported.
const TICK: Duration = Duration::from_millis(100);

impl Runner {
    /// Computes the rows of all cases in memory. Returns them in the order of the cases.
    ///
    /// `watch` receives the progress at the beginning, ten times a second, and at the end, on this thread. When `watch` returns `Break`, the
    /// cases under way are finished and no others are started.
    ///
    /// # Errors
    /// When `watch` returns `Break` or threads cannot be started.
    pub fn rows<S: Study>(
        &self,
        study: &S,
        watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Vec<S::Row>, RunnerError> {
        let family = |index| study.family(index);
        let rows_of = |indices: &[usize]| study.rows(indices);
        self.each_of_families(study.count(), family, rows_of, watch)
    }

    /// Computes `row` for every index below `count` on all threads. Returns the results in order. For work that is not a study.
    ///
    /// # Errors
    /// As [`Runner::rows`].
    pub fn each<R: Send>(
        &self,
        count: usize,
        row: impl Fn(usize) -> R + Sync,
        watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Vec<R>, RunnerError> {
        let rows_of = |indices: &[usize]| indices.iter().map(|index| row(*index)).collect();
        self.each_of_families(count, |_| None, rows_of, watch)
    }

    /// Computes rows of cases in families, as in [`Study::family`] and [`Study::rows`].
    ///
    /// # Errors
    /// As [`Runner::rows`].
    pub fn each_of_families<R: Send>(
        &self,
        count: usize,
        family: impl Fn(usize) -> Option<usize>,
        rows_of: impl Fn(&[usize]) -> Vec<R> + Sync,
        watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Vec<R>, RunnerError> {
        let mut rows = Rows::new();
        self.complete(0..count, family, rows_of, &mut rows, |_| Ok(()), watch)?;
        Ok(rows.into_values().collect())
    }

    /// Computes the rows of a shard. Each is saved in a part file (see [`super::part`]), so a killed program can resume the work. Returns the
    /// file, and the rows if the shard is the whole study.
    ///
    /// `watch` is as in [`Runner::rows`]. All rows that its progress counts are already in the file.
    ///
    /// # Errors
    /// When `watch` returns `Break`, threads cannot be started, or the file cannot be used.
    pub fn rows_in<S: Study>(
        &self,
        study: &S,
        task: Task<'_>,
        watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<RowsInFile<S::Row>, RunnerError> {
        let (folder, shard) = (task.folder, task.shard);
        fs::create_dir_all(folder).map_err(|error| PartError {
            kind: PartErrorKind::Folder,
            message: format!("cannot make the folder {}: {error}", folder.display()),
        })?;
        let path = folder.join(shard.file_name(S::NAME));
        let header = Header::new(study, shard);
        let (mut part, mut rows) = PartFile::open(&path, &header, task.resume)?;
        let keep = |new: &[_]| part.append(new);
        let cases = shard.cases(study.count());
        let family = |index| study.family(index);
        let rows_of = |indices: &[usize]| study.rows(indices);
        self.complete(cases, family, rows_of, &mut rows, keep, watch)?;
        if !shard.is_whole() {
            part.check_there()?;
        }
        let rows = shard.is_whole().then(|| rows.into_values().collect());
        Ok((rows, part))
    }

    fn pool(&self) -> Result<ThreadPool, RunnerError> {
        ThreadPoolBuilder::new()
            .num_threads(self.threads.map_or(0, NonZeroUsize::get))
            .build()
            .map_err(|error| RunnerError::Threads(error.to_string()))
    }

    /// Computes the missing rows, and passes them to `keep` as they are computed.
    fn complete<R: Send>(
        &self,
        cases: impl Iterator<Item = usize>,
        family: impl Fn(usize) -> Option<usize>,
        rows_of: impl Fn(&[usize]) -> Vec<R> + Sync,
        rows: &mut Rows<R>,
        mut keep: impl FnMut(&[(usize, R)]) -> Result<(), PartError>,
        mut watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), RunnerError> {
        let todo: Vec<usize> = cases.filter(|index| !rows.contains_key(index)).collect();
        let all = rows.len() + todo.len();
        let pool = self.pool()?;
        let todo = in_groups(todo, family, pool.current_num_threads());
        let cancelled = AtomicBool::new(false);
        let (sender, receiver) = mpsc::channel();
        let compute = || {
            // Cases cost from microseconds to seconds, so threads take groups one by one.
            let todo = todo.par_iter().with_max_len(1);
            todo.try_for_each_with(sender, |sender, indices| {
                if cancelled.load(Ordering::Relaxed) {
                    return None;
                }
                let mut rows = indices.iter().copied().zip(rows_of(indices));
                // Sending fails only if the receiver has given up.
                rows.try_for_each(|row| sender.send(row).ok())
            })
        };
        let keeper = thread::current();
        let on_threads = || {
            pool.install(compute);
            keeper.unpark();
        };
        thread::scope(|scope| {
            let receiver = receiver;
            let working = scope.spawn(on_threads);
            let mut over = false;
            loop {
                let progress = Progress {
                    done: rows.len(),
                    all,
                };
                if !cancelled.load(Ordering::Relaxed) && watch(progress).is_break() {
                    cancelled.store(true, Ordering::Relaxed);
                }
                if over {
                    break;
                }
                // Writes the rows of an interval together, so this thread does not wake up for each row.
                thread::park_timeout(TICK);
                let mut new = Vec::new();
                over = loop {
                    match receiver.try_recv() {
                        Ok(row) => new.push(row),
                        Err(error) => break error == TryRecvError::Disconnected,
                    }
                };
                keep(&new)?;
                rows.extend(new);
            }
            if let Err(panic) = working.join() {
                resume_unwind(panic);
            }
            let done = rows.len();
            if done < all {
                return Err(RunnerError::Cancelled(Progress { done, all }));
            }
            Ok(())
        })
    }
}

/// Divides the cases into groups that are computed together. A group holds cases of one family, or a single case.
fn in_groups(
    cases: Vec<usize>,
    family: impl Fn(usize) -> Option<usize>,
    threads: usize,
) -> Vec<Vec<usize>> {
    let (least, most) = (*TOGETHER.start(), *TOGETHER.end());
    let together = (cases.len() / (2 * threads)).clamp(least, most);
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut open: BTreeMap<usize, usize> = BTreeMap::new();
    for case in cases {
        let family = family(case);
        let group = family.and_then(|family| open.get(&family));
        match group {
            Some(&group) if groups[group].len() < together => groups[group].push(case),
            _ => {
                open.extend(family.map(|family| (family, groups.len())));
                groups.push(vec![case]);
            }
        }
    }
    groups
}
