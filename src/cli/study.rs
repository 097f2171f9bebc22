//! Computes a study of a scenario, and the study of its samples, for all commands.

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process;
use std::sync::atomic::Ordering;

use archrock::scenario::Scenario;
use archrock::studies::catalogue::{Done, Options, Rows, StudyKind};
use archrock::studies::kept::{Origin, Writer};
use archrock::studies::part::{PartError, PartFile, Shard};
use archrock::studies::results::{Results, StudyError, Style};
use archrock::studies::runner::{Progress, Runner, RunnerError, Task};

use super::figure::FigureOption;
use super::models::ModelsOption;
use super::progress::{
    Display, INTERRUPTED, INTERRUPTED_CODE, listen_to_interrupts, say, say_always,
};
use super::scenario_file::{Destination, Input, ScenarioFile};
use super::{Failure, Format};

/// Options of every study.
#[derive(clap::Args)]
pub struct StudyArguments {
    #[command(flatten)]
    pub scenario: ScenarioFile,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub models: ModelsOption,
    #[command(flatten)]
    pub figure: FigureOption,
    #[command(flatten)]
    pub work: Work,
    /// Format of the printed summary; JSON goes to standard output.
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// Options of long computations.
#[derive(clap::Args, Clone, Copy)]
pub struct Work {
    /// Number of threads [default: number of processors].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Continue an interrupted run, if there is one.
    #[arg(long)]
    resume: bool,
    /// Compute only part I of N, into a file for `archrock merge`.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
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

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Scenario(message) => Self::Input(message),
            StudyError::Failed(message) => Self::Work(message),
            StudyError::Runner(error) => error.into(),
            StudyError::Part(error) => error.into(),
            StudyError::Read(error) => error.into(),
            StudyError::Output(error) => error.into(),
        }
    }
}

impl Work {
    /// The runner that computes on these threads.
    pub fn runner(self) -> Runner {
        Runner {
            threads: self.threads.and_then(|n| NonZeroUsize::new(n.into())),
        }
    }

    /// True if only a part is requested.
    pub const fn is_part(self) -> bool {
        self.shard.is_some()
    }

    /// Locks the folder for the results of a command, or for a part of them.
    pub fn lock(
        self,
        place: Destination,
        writer: Writer,
        scenario: &Scenario,
    ) -> Result<Destination, Failure> {
        match self.is_part() {
            true => place.locked_for_a_part(writer),
            false => place.locked_for(writer, &Origin::of(scenario)),
        }
    }
}

impl StudyArguments {
    /// The folder for results.
    pub fn place(&self, input: &Input<'_>) -> Result<Destination, Failure> {
        let place = input.results(self.out.as_deref())?;
        Ok(self.figure.printed(place))
    }
}

/// The files that keep the rows of results until these are published.
#[derive(Default)]
pub struct Pending(Vec<PartFile>);

impl Pending {
    /// Publishes the results of a command.
    pub fn publish(self, place: &Destination) -> Result<(), Failure> {
        place.publish()?;
        for part in self.0 {
            part.remove()?;
        }
        Ok(())
    }
}

/// Common settings of the studies of a command.
#[derive(Clone, Copy)]
pub struct Session<'s> {
    /// The scenario file, which errors about the scenario name.
    pub input: Option<&'s Input<'s>>,
    pub work: Work,
    pub style: Style,
}

/// Heading before the report on the scenario itself. The report on its samples comes first, with the probability of overturning.
pub const ITSELF: &str = "the scenario itself:\n";

impl Session<'_> {
    /// Calls `compute` with a function that shows the progress. At Ctrl-C that function prints the message of `interrupted` and ends the
    /// program.
    pub fn watch<T>(
        self,
        interrupted: impl Fn(Progress) -> String,
        compute: impl FnOnce(&mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<T, StudyError>,
    ) -> Result<T, Failure> {
        listen_to_interrupts();
        let mut display = None;
        let done = compute(&mut |progress| {
            let display = display.get_or_insert_with(|| Display::new(progress));
            // All finished rows are in the file and none is being written, so it is safe to exit.
            if INTERRUPTED.load(Ordering::Relaxed) {
                display.abandon();
                say_always(&interrupted(progress));
                process::exit(INTERRUPTED_CODE);
            }
            display.show(progress);
            ControlFlow::Continue(())
        });
        if let Some(display) = display {
            display.finish();
        }
        done.map_err(|error| match (error, self.input) {
            (StudyError::Scenario(message), Some(input)) => input.wrong(message),
            (error, _) => error.into(),
        })
    }

    /// Computes a study in a folder, and prepares its results there, which are returned. Of a part, reports the file and returns
    /// `None`.
    pub fn compute(
        self,
        kind: StudyKind,
        scenario: &Scenario,
        options: &Options,
        place: &Destination,
        pending: &mut Pending,
    ) -> Result<Option<Results>, Failure> {
        let task = Task {
            folder: place.path(),
            shard: self.work.shard.unwrap_or(Shard::WHOLE),
            resume: self.work.resume,
        };
        let interrupted = |Progress { done, all }| {
            let file = task.folder.join(task.shard.file_name(kind.name));
            if file.exists() {
                format!("interrupted: {done} of {all} cases are done; continue with --resume")
            } else {
                format!("interrupted; {} was removed meanwhile", file.display())
            }
        };
        let runner = self.work.runner();
        match self.watch(interrupted, |watch| {
            let rows = Rows::Compute(runner, Some(task), watch);
            kind.compute(scenario, options, self.style, rows)
        })? {
            Done::Whole(results, part) => {
                place.prepare(&results)?;
                pending.0.extend(part);
                Ok(Some(results))
            }
            Done::Part { part, cases, all } => {
                let (shard, path) = (task.shard, part.path().display());
                say(&format!(
                    "part {shard}: {cases} of {all} cases in {path}; join the parts with archrock merge"
                ));
                Ok(None)
            }
        }
    }

    /// Whether only a part of the samples is requested; an error if a scenario has no samples.
    pub fn is_part(self, scenarios: &[Scenario]) -> Result<bool, Failure> {
        if self.work.is_part() && scenarios.iter().any(|one| one.uncertain().is_none()) {
            let message =
                "--shard computes a part of the samples of [uncertain], which the scenario lacks";
            return Err(message.into());
        }
        Ok(self.work.is_part())
    }

    /// Computes the samples of scenarios that differ in their models of motion and have `[uncertain]`. Prepares their results in folders
    /// of their own inside `place`, and adds them to `results`, of which their words come first. Returns the results of each model.
    pub fn add_samples(
        self,
        kind: StudyKind,
        scenarios: &[Scenario],
        options: &Options,
        place: &Destination,
        pending: &mut Pending,
        results: &mut Results,
    ) -> Result<Vec<(&'static str, Results)>, Failure> {
        let several = scenarios.len() > 1;
        let (mut words, mut of_models) = (String::new(), Vec::new());
        for scenario in scenarios.iter().filter(|one| one.uncertain().is_some()) {
            let (name, model) = (scenario.motion().hinges().name(), scenario.motion().words());
            let place = place.of_model(scenario, several).within(kind.name);
            let Some(found) = self.compute(kind, scenario, options, &place, pending)? else {
                continue;
            };
            if several {
                words += &format!("{model}\n");
            }
            let (found_words, place) = (&found.words, place.holds(&found));
            words += &format!("  {found_words}\n  results in {place}\n");
            let summary = &mut results.summary;
            let summary = if several { &mut summary[name] } else { summary };
            summary["uncertain"] = found.summary.clone();
            of_models.push((model, found));
        }
        if !words.is_empty() {
            results.words.insert_str(0, &(words + ITSELF));
        }
        Ok(of_models)
    }
}
