//! Long computations at the command line: their options, their progress on the terminal, and Ctrl-C.

use std::io::{self, IsTerminal as _, Write as _};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use archrock::scenario::{Hinges, Scenario, shown_lines};
use archrock::studies::catalogue::{Done, StudyError, StudyKind};
use archrock::studies::part::{PartError, PartFile, Shard};
use archrock::studies::results::{Look, Results};
use archrock::studies::runner::{Progress, Runner, RunnerError, Task};
use clap::ValueEnum;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::figure::FigureOption;
use super::scenario_file::{Destination, Input, ScenarioFile};
use super::{Failure, Format};
use archrock::studies::kept::Writer;

/// Options of every study.
#[derive(clap::Args)]
pub struct Options {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    work: Work,
    /// Format of the printed summary; JSON goes to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// How a long computation is done.
#[derive(clap::Args, Clone, Copy)]
pub struct Work {
    #[command(flatten)]
    threads: Threads,
    /// Continue an interrupted run, if there is one.
    #[arg(long)]
    resume: bool,
    /// Compute only part I of N, into a file for `archrock merge`.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
}

/// The number of threads.
#[derive(clap::Args, Clone, Copy)]
pub struct Threads {
    /// Number of threads [default: number of processors].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl Threads {
    /// The runner that computes on these threads.
    pub fn runner(self) -> Runner {
        Runner {
            threads: self.threads.and_then(|n| NonZeroUsize::new(n.into())),
        }
    }
}

/// The model of motion that is asked for.
#[derive(clap::Args, Clone, Copy)]
pub struct HingesOption {
    /// The model of motion; overrides the scenario's own choice.
    #[arg(long, value_enum, value_name = "MODEL")]
    hinges: Option<Model>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Model {
    /// Four links, or the column of Housner.
    Four,
    /// A row of blocks whose joints open and shut anywhere.
    Free,
    /// A row of blocks with elastic joints.
    Elastic,
}

impl HingesOption {
    /// Reads a scenario with that model.
    pub fn read(self, input: &Input<'_>, quiet: bool) -> Result<Scenario, Failure> {
        let hinges = self.hinges.map(|model| match model {
            Model::Four => Hinges::Four,
            Model::Free => Hinges::Free,
            Model::Elastic => Hinges::Elastic,
        });
        let scenario = input.read(hinges)?;
        if !quiet {
            super::warn(&scenario.unlikely());
            if let Some(ignored) = scenario.ignored() {
                say(ignored);
            }
        }
        Ok(scenario)
    }
}

impl From<PartError> for Failure {
    fn from(error: PartError) -> Self {
        let remedy = match &error {
            PartError::Io { .. } => return Self::Work(error.to_string()),
            PartError::Unusable { .. } => String::new(),
            PartError::Other { .. } => {
                ": remove it, or choose another folder with --out".to_owned()
            }
            PartError::Interrupted { .. } => {
                ": continue with --resume, or remove it to start over".to_owned()
            }
            PartError::Incomplete { shard, .. } => {
                format!(": finish it with --shard {shard} --resume")
            }
        };
        Self::Input(format!("{error}{remedy}"))
    }
}

impl From<RunnerError> for Failure {
    fn from(error: RunnerError) -> Self {
        match error {
            RunnerError::Part(error) => error.into(),
            RunnerError::Folder { .. } => {
                Self::Input(format!("{error}; choose another with --out"))
            }
            RunnerError::Cancelled(_) | RunnerError::Threads(_) => Self::Work(error.to_string()),
        }
    }
}

impl Options {
    /// Reads the text of the scenario.
    pub fn open(&self) -> Result<Input<'_>, Failure> {
        self.scenario.open()
    }

    /// How the study is computed.
    pub const fn work(&self) -> Work {
        self.work
    }

    /// The folder for results, locked for a command.
    pub fn place(
        &self,
        writer: Writer,
        (input, scenario): (&Input<'_>, &Scenario),
        figure: FigureOption,
        quiet: bool,
    ) -> Result<Destination, Failure> {
        let place = figure.printed(input.results(self.out.as_deref())?);
        if self.work.is_part() {
            place.locked_for_a_part(writer)
        } else {
            place.locked(writer, scenario, quiet)
        }
    }

    /// The format of the printed summary.
    pub const fn format(&self) -> Format {
        self.format
    }

    /// Computes the study of a scenario in a folder, and prepares its results there, which are returned; `None` for a part.
    pub fn compute(
        &self,
        kind: StudyKind,
        input: &Input<'_>,
        scenario: &Scenario,
        (look, place): (Look, &Destination),
        (pending, quiet): (&mut Pending, bool),
    ) -> Result<Option<Results>, Failure> {
        let done = self
            .work
            .compute(kind.name(), place, quiet, |runner, task, watch| {
                let done = kind.compute(scenario, look, runner, Some(task), watch);
                done.map_err(|error| match error {
                    StudyError::Scenario(_) => input.about(error.into()),
                    error => error.into(),
                })
            })?;
        let Some((results, part)) = done else {
            return Ok(None);
        };
        pending.prepare(place, &results, part)?;
        Ok(Some(results))
    }
}

/// The files that keep the rows of results until these are published.
#[derive(Default)]
pub struct Pending(Vec<PartFile>);

impl Pending {
    /// Prepares results in a folder. `part` keeps their rows.
    pub fn prepare(
        &mut self,
        place: &Destination,
        results: &Results,
        part: Option<PartFile>,
    ) -> Result<(), Failure> {
        place.prepare(results)?;
        self.0.extend(part);
        Ok(())
    }

    /// Publishes the results of a command.
    pub fn publish(self, place: &Destination) -> Result<(), Failure> {
        place.publish()?;
        for part in self.0 {
            part.remove()?;
        }
        Ok(())
    }
}

/// Receives the progress; the work stops when it returns a break.
type Watch<'w> = &'w mut dyn FnMut(Progress) -> ControlFlow<()>;

impl Work {
    /// The runner that computes on these threads.
    pub fn runner(self) -> Runner {
        self.threads.runner()
    }

    /// Whether only a part is asked for.
    pub const fn is_part(self) -> bool {
        self.shard.is_some()
    }

    /// Computes the study of this name for a folder. Returns its results and the file that keeps its rows until the results are
    /// written; or, for a part, prints a message and returns `None`.
    pub fn compute(
        self,
        name: &str,
        place: &Destination,
        quiet: bool,
        compute: impl FnOnce(Runner, Task<'_>, Watch<'_>) -> Result<Done, Failure>,
    ) -> Result<Option<(Results, Option<PartFile>)>, Failure> {
        let task = Task {
            folder: place.path(),
            shard: self.shard.unwrap_or(Shard::WHOLE),
            resume: self.resume,
        };
        listen_to_interrupts();
        let mut display = None;
        let mut watch = |progress| {
            let display = display.get_or_insert_with(|| Display::new(progress, quiet));
            // All rows so far are in the file and none is being written, so it is safe to exit.
            if INTERRUPTED.load(Ordering::Relaxed) {
                display.bar.abandon();
                let Progress { done, all } = progress;
                let file = task.folder.join(task.shard.file_name(name));
                say(&if file.exists() {
                    format!("interrupted: {done} of {all} cases are done; continue with --resume")
                } else {
                    format!("interrupted; {} was removed meanwhile", file.display())
                });
                process::exit(INTERRUPTED_CODE);
            }
            display.show(progress);
            ControlFlow::Continue(())
        };
        let done = compute(self.runner(), task, &mut watch)?;
        if let Some(display) = display {
            display.finish();
        }
        match done {
            Done::Whole(results, part) => Ok(Some((results, part))),
            Done::Part { part, cases, all } => {
                if !quiet {
                    let (shard, path) = (task.shard, part.path().display());
                    say(&format!(
                        "part {shard}: {cases} of {all} cases in {path}; join the parts with archrock merge"
                    ));
                }
                Ok(None)
            }
        }
    }
}

/// Whether Ctrl-C was pressed.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// On Ctrl-C: ends the work between two lines of its file; on a second Ctrl-C, at once.
fn listen_to_interrupts() {
    // Without the handler Ctrl-C still ends the program, without a message.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            process::exit(INTERRUPTED_CODE);
        }
    });
}

/// The exit code of shells for a program ended by Ctrl-C.
const INTERRUPTED_CODE: i32 = 130;

/// Prints a line on standard error.
pub fn say(text: &str) {
    // When standard error fails there is nowhere to report it.
    let _ = writeln!(io::stderr(), "{}", shown_lines(text));
}

/// Progress: a bar on a terminal, a line a minute elsewhere.
pub struct Display {
    bar: ProgressBar,
    /// The number of cases done before this start: they do not count in the pace.
    before: usize,
    begun: Instant,
    /// When the last line was printed; `None` when no lines are.
    said: Option<Instant>,
}

/// Time between lines.
const MINUTE: Duration = Duration::from_secs(60);

impl Display {
    pub fn new(begin: Progress, quiet: bool) -> Self {
        let on_terminal = io::stderr().is_terminal();
        let target = if quiet || !on_terminal {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(begin.all as u64), target);
        let style = ProgressStyle::with_template("{bar:40} {pos}/{len} cases, {msg}")
            .expect("the template is valid");
        bar.set_style(style);
        bar.set_position(begin.done as u64);
        bar.set_message(pace(0, begin.all, Duration::ZERO));
        Self {
            bar,
            before: begin.done,
            begun: Instant::now(),
            said: (!quiet && !on_terminal).then(Instant::now),
        }
    }

    pub fn show(&mut self, progress: Progress) {
        let pace = pace(
            progress.done.saturating_sub(self.before),
            progress.all.saturating_sub(progress.done),
            self.begun.elapsed(),
        );
        self.bar.set_length(progress.all as u64);
        self.bar.set_position(progress.done as u64);
        self.bar.set_message(pace.clone());
        if let Some(said) = &mut self.said
            && said.elapsed() >= MINUTE
        {
            *said = Instant::now();
            say(&format!(
                "{} of {} cases, {pace}",
                progress.done, progress.all
            ));
        }
    }

    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}

/// "12 a second, 3 minutes left", from the mean of all cases so far: a moving mean would let one slow case spoil the estimate.
fn pace(done: usize, left: usize, elapsed: Duration) -> String {
    if done == 0 {
        return "none finished yet".to_owned();
    }
    let each = elapsed.div_f64(done as f64);
    let rate = 1.0 / each.as_secs_f64().max(1e-6);
    let rate = match rate {
        10.0.. => format!("{rate:.0} a second"),
        1.0.. => format!("{rate:.1} a second"),
        _ => format!("one in {:.1} s", each.as_secs_f64()),
    };
    format!("{rate}, {} left", HumanDuration(each.mul_f64(left as f64)))
}
