//! Long work: the cases of a study on all processors, with progress, that can be interrupted and resumed.

use std::cell::Cell;
use std::fmt;
use std::fs;
use std::io::{self, IsTerminal as _, Write as _};
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::process;
use std::sync::mpsc::{self, TryRecvError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use archrock::output::part::{Header, Part, PartError, Rows, Shard};
use archrock::output::{OutputError, results};
use archrock::scenario::Scenario;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use rayon::ThreadPoolBuilder;
use rayon::iter::{
    IndexedParallelIterator as _, IntoParallelRefIterator as _, ParallelIterator as _,
};

use super::Failure;

/// What all long work can be told.
#[derive(clap::Args)]
pub struct Options {
    /// Scenario file (TOML).
    pub scenario: PathBuf,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How many threads work [default: as many as there are processors].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Go on where an interrupted run stopped, if there is one.
    #[arg(long)]
    resume: bool,
    /// Compute one part of n only, into a file that `archrock merge` joins with the others.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
}

impl From<PartError> for Failure {
    fn from(error: PartError) -> Self {
        match error {
            PartError::Output(error) => error.into(),
            PartError::Unusable { .. } => Self::Input(error.to_string()),
        }
    }
}

impl Options {
    /// The folder for the results.
    pub fn folder(&self) -> PathBuf {
        super::results_folder(self.out.as_deref(), &self.scenario)
    }

    /// The failure with the name of the scenario file.
    pub fn about_scenario(&self, failure: Failure) -> Failure {
        match failure {
            Failure::Input(message) => {
                Failure::Input(format!("{}: {message}", self.scenario.display()))
            }
            other => other,
        }
    }

    /// Runs `work` on as many threads as were asked for.
    pub fn on_threads<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
        let pool = ThreadPoolBuilder::new()
            .num_threads(self.threads.map_or(0, usize::from))
            .build()
            .map_err(|error| Failure::Work(format!("cannot start the threads: {error}")))?;
        Ok(pool.install(work))
    }

    /// Computes the rows of all cases, or of the part that was asked for, in a file of their own: the study
    /// when it is complete, with all rows, or `None` after a part, whose file is then the result.
    ///
    /// A row depends on its case alone, so neither threads nor interruptions nor parts change it.
    pub fn compute(
        &self,
        header: Header,
        quiet: bool,
        row: impl Fn(usize) -> Result<String, OutputError> + Sync,
    ) -> Result<Option<Computed>, Failure> {
        let shard = self.shard.unwrap_or(Shard::WHOLE);
        let header = Header { shard, ..header };
        let folder = self.folder();
        fs::create_dir_all(&folder).map_err(|error| {
            let folder = folder.display();
            Failure::Input(format!(
                "cannot make the folder {folder}: {error}; choose another with --out"
            ))
        })?;
        let path = folder.join(shard.file_name(&header.study));
        let (part, mut rows) = Part::open(&path, &header, self.resume)?;
        let todo: Vec<usize> = shard
            .cases(header.cases)
            .filter(|index| !rows.contains_key(index))
            .collect();
        let part = Arc::new(Mutex::new(part));
        let progress = Progress::new(rows.len(), rows.len() + todo.len(), quiet);
        stop_on_interrupt(&part, &progress);
        let new = self.work(&todo, &part, &progress, row)?;
        progress.finish();
        rows.extend(new);
        if shard.is_whole() {
            return Ok(Some(Computed { rows, part }));
        }
        if !quiet {
            let (count, path) = (rows.len(), path.display());
            say(&format!(
                "part {shard}: {count} of {} cases in {path}; join the parts with archrock merge",
                header.cases
            ));
        }
        Ok(None)
    }

    /// Computes the cases, and writes their rows as they come.
    fn work(
        &self,
        todo: &[usize],
        part: &Mutex<Part>,
        progress: &Progress,
        row: impl Fn(usize) -> Result<String, OutputError> + Sync,
    ) -> Result<Rows, Failure> {
        let (sender, receiver) = mpsc::channel();
        let compute = || {
            // Cases cost from microseconds to seconds: each is dealt out on its own.
            let todo = todo.par_iter().with_max_len(1);
            todo.try_for_each_with(sender, |sender, index| {
                let row = row(*index).map_err(Some)?;
                // When rows cannot be written any more, nobody listens.
                sender.send((*index, row)).map_err(|_| None::<OutputError>)
            })
        };
        let writer = thread::current();
        let on_threads = || {
            let done = self.on_threads(compute);
            writer.unpark();
            done
        };
        thread::scope(move |scope| {
            let working = scope.spawn(on_threads);
            let mut rows = Rows::new();
            let mut over = false;
            while !over {
                // What comes meanwhile is written in one go; nobody loses time in waking this thread.
                thread::park_timeout(TICK);
                let mut new: Vec<(usize, String)> = Vec::new();
                over = loop {
                    match receiver.try_recv() {
                        Ok(row) => new.push(row),
                        Err(error) => break error == TryRecvError::Disconnected,
                    }
                };
                lock(part).append(new.iter().map(|(index, row)| (*index, row.as_str())))?;
                progress.advance(new.len());
                rows.extend(new);
            }
            drop(receiver);
            match working
                .join()
                .unwrap_or_else(|panic| resume_unwind(panic))?
            {
                Err(Some(error)) => Err(error.into()),
                Ok(()) | Err(None) => Ok(rows),
            }
        })
    }
}

/// How often rows are written and progress is shown.
const TICK: Duration = Duration::from_millis(100);

/// The part, which is only held to write lines, and that does not panic.
fn lock(part: &Mutex<Part>) -> MutexGuard<'_, Part> {
    part.lock().unwrap_or_else(PoisonError::into_inner)
}

/// All rows of a study, and the file that they are in until the results are complete.
pub struct Computed {
    /// The rows.
    pub rows: Rows,
    part: Arc<Mutex<Part>>,
}

impl Computed {
    /// Takes the file away when the results are complete.
    pub fn remove_part(&self) -> Result<(), Failure> {
        Ok(lock(&self.part).remove()?)
    }
}

/// On Ctrl-C: ends the program at once, between two lines of the part's file.
fn stop_on_interrupt(part: &Arc<Mutex<Part>>, progress: &Progress) {
    let (part, bar) = (part.clone(), progress.bar.clone());
    // Without the handler Ctrl-C ends the program as well; it then does so without a word.
    let _ = ctrlc::set_handler(move || {
        let _part = lock(&part);
        bar.abandon();
        say(&format!(
            "interrupted: {} of {} cases are done; go on with --resume",
            bar.position(),
            bar.length().unwrap_or_default()
        ));
        process::exit(INTERRUPTED);
    });
}

/// As shells tell of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// Writes what a study was of.
pub fn write_summary(
    mut file: impl io::Write,
    scenario: &Scenario,
    rows: &Rows,
) -> Result<(), Failure> {
    let summary = results::study_summary(scenario, rows.len());
    writeln!(file, "{summary:#}")
        .map_err(|error| Failure::Work(format!("cannot write the summary: {error}")))
}

/// Says something to a person.
pub fn say(text: &str) {
    // Nobody is left to be told when standard error fails.
    let _ = writeln!(io::stderr(), "{text}");
}

/// How far the work is: a bar on a terminal, a line a minute elsewhere.
struct Progress {
    bar: ProgressBar,
    /// When the last line was said, if lines are.
    said: Option<Cell<Instant>>,
}

/// Time between lines.
const MINUTE: Duration = Duration::from_secs(60);

impl Progress {
    fn new(done: usize, all: usize, quiet: bool) -> Self {
        let on_terminal = io::stderr().is_terminal();
        let target = if quiet || !on_terminal {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(all as u64), target);
        let template = "{bar:40} {pos}/{len} cases, {rate} a second, {eta} left";
        let style = ProgressStyle::with_template(template)
            .expect("the template is valid")
            .with_key("rate", |state: &ProgressState, out: &mut dyn fmt::Write| {
                // A bar that cannot be written does no harm.
                let _ = write!(out, "{:.0}", state.per_sec());
            });
        bar.set_style(style);
        bar.set_position(done as u64);
        bar.reset_eta();
        Self {
            bar,
            said: (!quiet && !on_terminal).then(|| Cell::new(Instant::now())),
        }
    }

    fn advance(&self, by: usize) {
        self.bar.inc(by as u64);
        if let Some(said) = &self.said
            && said.get().elapsed() >= MINUTE
        {
            said.set(Instant::now());
            say(&format!(
                "{} of {} cases, {:.0} a second, {} left",
                self.bar.position(),
                self.bar.length().unwrap_or_default(),
                self.bar.per_sec(),
                HumanDuration(self.bar.eta())
            ));
        }
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
