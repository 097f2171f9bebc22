//! Computes the cases of a study on all processors and reports progress. The work can be cancelled and resumed.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::ops::{ControlFlow, RangeInclusive};
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, TryRecvError};
use std::time::Duration;
use std::{fs, mem, thread};

use rayon::iter::{
    IndexedParallelIterator as _, IntoParallelRefIterator as _, ParallelIterator as _,
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use thiserror::Error;

use super::part::{Header, PartError, PartErrorKind, PartFile, Rows, Shard};
use super::study::Study;
use crate::clock;

/// The progress of the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Number done, including those of an earlier run.
    pub done: usize,
    /// Number to do in all.
    pub all: usize,
    /// Quantity that is counted.
    pub counted: Counted,
}

/// Quantity that a progress counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Counted {
    /// Cases of a study.
    Cases,
    /// Cases of a step of a search.
    Search(SearchStep),
    /// Milliseconds of simulated time; all are done while a history is repeated.
    Milliseconds,
    /// Pictures of a film.
    Pictures,
}

/// A step of a search for a threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchStep {
    /// The largest factor up to which all histories survive so far; `None` if none does.
    pub safe_up_to: Option<f64>,
    /// True if the step ends at the first collapse, so that it may have fewer cases.
    pub is_open: bool,
}

impl Progress {
    /// Makes the progress of a study of cases.
    pub const fn of_cases(done: usize, all: usize) -> Self {
        Self {
            done,
            all,
            counted: Counted::Cases,
        }
    }
}

/// Function that receives the progress of a study. The work stops when the function returns `Break`.
pub type Watch<'w> = &'w mut dyn FnMut(Progress) -> ControlFlow<()>;

/// Reasons why the rows of a study are incomplete.
#[derive(Debug, Error)]
#[non_exhaustive]
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
///
/// ```
/// use std::ops::ControlFlow;
///
/// use archrock::output::OutputError;
/// use archrock::studies::{Results, Runner, Study, Style};
///
/// struct Squares;
///
/// impl Study for Squares {
///     type Row = usize;
///     const NAME: &'static str = "squares";
///     const FILES: &'static [&'static str] = &[];
///
///     fn count(&self) -> usize {
///         1000
///     }
///
///     fn rows(&self, indices: &[usize]) -> Vec<usize> {
///         indices.iter().map(|index| index * index).collect()
///     }
///
///     fn results(&self, _: Vec<usize>, _: Style) -> Result<Results, OutputError> {
///         Ok(Results::default())
///     }
/// }
///
/// let mut done = 0;
/// let rows = Runner::default().rows(&Squares, |progress| {
///     done = progress.done;
///     ControlFlow::Continue(())
/// })?;
/// assert_eq!((done, rows[30]), (1000, 900));
/// # Ok::<(), archrock::studies::RunnerError>(())
/// ```
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
    /// `watch` receives the progress on this thread: at the beginning, ten times a second, and at the end. Without threads it is called between groups
    /// of cases. When `watch` returns `Break`, the cases under way are finished and no others are started.
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

    /// Computes the rows of a shard. Each is saved in a part file (see [`PartFile`]), so a killed program can resume the work. Returns the
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
        let mut is_cancelled = false;
        // Keeps new rows and reports the progress. Returns true once the work is cancelled.
        let mut add = |new: Vec<(usize, R)>| -> Result<bool, RunnerError> {
            keep(&new)?;
            rows.extend(new);
            let done = rows.len();
            is_cancelled = is_cancelled || watch(Progress::of_cases(done, all)).is_break();
            Ok(is_cancelled)
        };
        // Even with one thread for the cases, this thread reports the progress and can cancel while they are computed.
        if HAS_THREADS {
            let pool = self.pool()?;
            let groups = in_groups(todo, family, pool.current_num_threads());
            on_threads(&pool, &groups, rows_of, &mut add)?;
        } else {
            one_by_one(&in_groups(todo, family, 1), rows_of, &mut add)?;
        }
        let done = rows.len();
        match done < all {
            true => Err(RunnerError::Cancelled(Progress::of_cases(done, all))),
            false => Ok(()),
        }
    }
}

/// Whether results may be computed on several threads: a browser has one. As a constant it leaves the code of threads out of its module.
const HAS_THREADS: bool = !cfg!(target_family = "wasm");

/// Computes a result for each item, in the order of the items.
pub(super) fn in_parallel<T: Sync, R: Send>(
    items: &[T],
    compute: impl Fn(&T) -> R + Sync + Send,
) -> Vec<R> {
    match HAS_THREADS {
        true => items.par_iter().with_max_len(1).map(compute).collect(),
        false => items.iter().map(compute).collect(),
    }
}

/// Receiver of new rows. It returns true once the work is cancelled.
type Add<'a, R> = &'a mut dyn FnMut(Vec<(usize, R)>) -> Result<bool, RunnerError>;

/// Computes the rows of groups of cases on this thread, where there are no others, as in a browser.
fn one_by_one<R>(
    groups: &[Vec<usize>],
    rows_of: impl Fn(&[usize]) -> Vec<R>,
    add: Add<'_, R>,
) -> Result<(), RunnerError> {
    let (mut new, mut added) = (Vec::new(), None);
    for indices in groups {
        let now = clock::elapsed();
        let since_added = now.zip(added).map(|(now, added)| now.saturating_sub(added));
        if since_added.is_none_or(|since_added| since_added >= TICK) {
            added = now;
            if add(mem::take(&mut new))? {
                return Ok(());
            }
        }
        new.extend(indices.iter().copied().zip(rows_of(indices)));
    }
    add(new).map(|_| ())
}

/// Computes the rows of groups of cases on the threads of a pool.
fn on_threads<R: Send>(
    pool: &ThreadPool,
    groups: &[Vec<usize>],
    rows_of: impl Fn(&[usize]) -> Vec<R> + Sync,
    add: Add<'_, R>,
) -> Result<(), RunnerError> {
    let cancelled = AtomicBool::new(false);
    let (sender, receiver) = mpsc::channel();
    let compute = || {
        // Cases cost from microseconds to seconds, so threads take groups one by one.
        let groups = groups.par_iter().with_max_len(1);
        groups.try_for_each_with(sender, |sender, indices| {
            if cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let mut rows = indices.iter().copied().zip(rows_of(indices));
            // Sending fails only if the receiver has given up.
            rows.try_for_each(|row| sender.send(row).ok())
        })
    };
    let keeper = thread::current();
    thread::scope(|scope| {
        let receiver = receiver;
        let working = scope.spawn(|| {
            pool.install(compute);
            keeper.unpark();
        });
        let (mut new, mut over) = (Vec::new(), false);
        loop {
            cancelled.store(add(mem::take(&mut new))?, Ordering::Relaxed);
            if over {
                break;
            }
            // Writes the rows of an interval together, so this thread does not wake up for each row.
            thread::park_timeout(TICK);
            over = loop {
                match receiver.try_recv() {
                    Ok(row) => new.push(row),
                    Err(error) => break error == TryRecvError::Disconnected,
                }
            };
        }
        working.join().map_err(|panic| resume_unwind(panic))
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Where there are no threads, cases are computed in their order, and a cancelled work starts no further group.
    #[test]
    fn groups_are_computed_one_by_one() {
        let groups = [vec![2, 0], vec![1], vec![3]];
        let square = |indices: &[usize]| indices.iter().map(|index| index * index).collect();
        let mut rows = Vec::new();
        let mut add = |new: Vec<(usize, usize)>| {
            rows.extend(new);
            Ok(false)
        };
        one_by_one(&groups, square, &mut add).unwrap();
        assert_eq!(rows, [(2, 4), (0, 0), (1, 1), (3, 9)]);
        let mut cancelled = |_: Vec<(usize, usize)>| Ok(true);
        let none = |_: &[usize]| -> Vec<usize> { panic!("a group was started") };
        one_by_one(&groups, none, &mut cancelled).unwrap();
    }
}
