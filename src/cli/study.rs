//! Computes a study of a scenario, and the study of its samples, for all commands.

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process;
use std::slice;
use std::sync::atomic::Ordering;
use std::time::Duration;

use archrock::scenario::Scenario;
use archrock::studies::catalogue::{Done, Options, Rows, StudyKind, THRESHOLD};
use archrock::studies::kept::{Origin, Writer};
use archrock::studies::part::{PartError, PartFile, Shard};
use archrock::studies::peaks;
use archrock::studies::results::{Results, StudyError, Style};
use archrock::studies::runner::{Progress, Runner, RunnerError, Task};

use super::figure::FigureOption;
use super::models::ModelsOption;
use super::progress::{
    Display, INTERRUPTED, INTERRUPTED_CODE, listen_to_interrupts, pace, say, say_always,
};
use super::scenario_file::{Destination, Input, ScenarioFile};
use super::{Failure, Format, show};

/// Options of every study of many histories.
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
#[derive(clap::Args, Clone, Copy, Default)]
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

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Scenario(message) => Self::Input(message),
            StudyError::Read(error) => error.into(),
            StudyError::Part(error) | StudyError::Runner(RunnerError::Part(error)) => error.into(),
            StudyError::Runner(error @ RunnerError::Folder { .. }) => {
                Self::Input(format!("{error}; choose another with --out"))
            }
            StudyError::Output(error) => error.into(),
            StudyError::Failed(_) | StudyError::Runner(_) => Self::Work(error.to_string()),
        }
    }
}

impl Work {
    /// True if only a part is requested.
    pub const fn is_part(self) -> bool {
        self.shard.is_some()
    }

    /// Locks the folder for the results of a command, or for a part of them.
    pub fn lock(
        self,
        place: Destination,
        writer: Writer,
        origin: &Origin,
    ) -> Result<Destination, Failure> {
        match self.is_part() {
            true => place.locked_for_a_part(writer),
            false => place.locked_for(writer, origin),
        }
    }
}

impl StudyArguments {
    /// The folder for results.
    pub fn place(&self, input: &Input<'_>) -> Result<Destination, Failure> {
        Ok(self.figure.printed(input.results(self.out.as_deref())?))
    }

    /// The studies of this command.
    pub fn session<'s>(&self, input: &'s Input<'s>, style: Style, options: Options) -> Session<'s> {
        Session::new(Some(input), self.work, style, options)
    }
}

/// The studies of a command.
pub struct Session<'s> {
    /// The scenario file, which errors about the scenario name.
    input: Option<&'s Input<'s>>,
    work: Work,
    style: Style,
    options: Options,
    /// The files that keep the rows of results until these are published.
    pending: Vec<PartFile>,
}

/// Heading before the report on the scenario itself. The report on its samples comes first, with the probability of overturning.
pub const ITSELF: &str = "the scenario itself:\n";

impl<'s> Session<'s> {
    /// The studies of a command, none of which is computed yet.
    pub const fn new(
        input: Option<&'s Input<'s>>,
        work: Work,
        style: Style,
        options: Options,
    ) -> Self {
        Self {
            input,
            work,
            style,
            options,
            pending: Vec::new(),
        }
    }

    /// Publishes the results in a folder.
    pub fn publish(&mut self, place: &Destination) -> Result<(), Failure> {
        place.publish()?;
        let mut pending = self.pending.drain(..);
        Ok(pending.try_for_each(PartFile::remove)?)
    }

    /// Computes a study in a folder, and prepares its results there, which are returned. Of a part, reports the file and returns
    /// `None`.
    pub fn compute(
        &mut self,
        kind: StudyKind,
        scenarios: &[Scenario],
        place: &Destination,
    ) -> Result<Option<Results>, Failure> {
        let work = self.work;
        let task = Task {
            folder: place.path(),
            shard: work.shard.unwrap_or(Shard::WHOLE),
            resume: work.resume,
        };
        let threads = work.threads.and_then(|n| NonZeroUsize::new(n.into()));
        let runner = Runner { threads };
        let mut shown = None;
        let mut watch = |progress: Progress| {
            let Progress { done, all } = progress;
            let (display, before) = shown.get_or_insert_with(|| {
                listen_to_interrupts();
                (Display::new(Duration::ZERO), done)
            });
            // All finished rows are in the file and none is being written, so it is safe to exit.
            if INTERRUPTED.load(Ordering::Relaxed) {
                display.abandon();
                say_always(&interrupted(kind, task, progress));
                process::exit(INTERRUPTED_CODE);
            }
            display.show(done as f64 / all.max(1) as f64, |elapsed| {
                let new = done.saturating_sub(*before);
                let pace = pace(new, all.saturating_sub(done), elapsed);
                format!("{done} of {all} cases, {pace}")
            });
            ControlFlow::Continue(())
        };
        let rows = Rows::Compute(runner, Some(task), &mut watch);
        let done = kind.compute(scenarios, &self.options, self.style, rows);
        drop(shown);
        let done = done.map_err(|error| match (error, self.input) {
            (StudyError::Scenario(message), Some(input)) => input.wrong(message),
            (error, _) => error.into(),
        });
        match done? {
            Done::Whole(results, part) => {
                place.prepare(&results)?;
                self.pending.extend(part);
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

    /// Computes a study of one scenario, publishes its results and prints them.
    pub fn finish(
        mut self,
        kind: StudyKind,
        scenario: &Scenario,
        place: &Destination,
        format: Format,
    ) -> Result<(), Failure> {
        let found = self.compute(kind, slice::from_ref(scenario), place)?;
        self.publish(place)?;
        found.map_or(Ok(()), |found| {
            say(&format!("results in {}", place.holds(&found)));
            show(&found, format)
        })
    }

    /// Computes a study, and that of the samples of its scenarios. Of a part, only the samples are computed if there are any.
    pub fn with_samples(
        &mut self,
        [own, samples]: [StudyKind; 2],
        scenarios: &[Scenario],
        place: &Destination,
    ) -> Result<Option<Results>, Failure> {
        let has_samples = scenarios.iter().any(|one| one.uncertain.is_some());
        let mut found = match has_samples && self.work.is_part() {
            true => None,
            false => self.compute(own, scenarios, place)?,
        };
        let mut of_part = Results::default();
        let results = found.as_mut().unwrap_or(&mut of_part);
        self.add_samples(samples, scenarios, place, results)?;
        Ok(found)
    }

    /// Whether only a part of the samples is requested; an error if a scenario has no samples.
    pub fn is_part(&self, scenarios: &[Scenario]) -> Result<bool, Failure> {
        if self.work.is_part() && scenarios.iter().any(|one| one.uncertain.is_none()) {
            let message =
                "--shard computes a part of the samples of [uncertain], which the scenario lacks";
            return Err(message.into());
        }
        Ok(self.work.is_part())
    }

    /// Computes the samples of scenarios that differ in their models of motion and have `[uncertain]`. Prepares their results in folders
    /// of their own inside `place`, and adds them to `results`, of which their words come first. Returns the results of each model.
    pub fn add_samples(
        &mut self,
        kind: StudyKind,
        scenarios: &[Scenario],
        place: &Destination,
        results: &mut Results,
    ) -> Result<Vec<(&'static str, Results)>, Failure> {
        let several = scenarios.len() > 1;
        let (mut words, mut of_models) = (String::new(), Vec::new());
        for scenario in scenarios.iter().filter(|one| one.uncertain.is_some()) {
            let (name, model) = (scenario.motion.hinges().name(), scenario.motion.words());
            let place = place.of_model(scenario, several).within(kind.name);
            let Some(found) = self.compute(kind, slice::from_ref(scenario), &place)? else {
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
            let is_indented = results.words.starts_with(' ') || results.words.is_empty();
            let indent = if is_indented { "" } else { "  " };
            results.words.insert_str(0, &(words + ITSELF + indent));
        }
        Ok(of_models)
    }

    /// Compares how far models of motion rock in the same cases, in a folder beside theirs. `None` where there are not several.
    pub fn compare(
        &self,
        title: Option<&str>,
        models: &[(&str, Results)],
        place: &Destination,
    ) -> Result<Option<Results>, Failure> {
        if models.len() < 2 {
            return Ok(None);
        }
        let models = models.iter().map(|(name, found)| (*name, &found.peaks[..]));
        let models: Vec<(&str, &[f64])> = models.collect();
        let title = title.unwrap_or("Largest rotations of several models");
        let results = peaks::results(title, &models, self.style.figure);
        let results = results.map_err(StudyError::from)?;
        place.of_models().prepare(&results)?;
        Ok(Some(results))
    }
}

/// The message when Ctrl-C ends a computation.
fn interrupted(kind: StudyKind, task: Task<'_>, Progress { done, all }: Progress) -> String {
    let file = task.folder.join(task.shard.file_name(kind.name));
    if file.exists() {
        format!("interrupted: {done} of {all} cases are done; continue with --resume")
    } else if kind == THRESHOLD {
        "interrupted".to_owned()
    } else {
        format!("interrupted; {} was removed meanwhile", file.display())
    }
}
