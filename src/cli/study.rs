//! Computes a study of a scenario, and the study of its samples, for all commands.

use std::io::{self, BufWriter};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::Ordering;
use std::{process, slice};

use archrock::output::Folder;
use archrock::scenario::Scenario;
use archrock::studies::run::Sinks;
use archrock::studies::{
    Computation, Counted, Options, PEAKS_FILES, PartError, PartErrorKind, PartFile, Progress,
    Results, Runner, RunnerError, Shard, StudyError, StudyKind, Style, Task, Work, peak_results,
    rows_in,
};

use super::Failure;
use super::interrupts::{INTERRUPTED, INTERRUPTED_CODE, listen_to_interrupts, uninterrupted};
use super::progress::{Display, print_always, print_status};
use super::results::{CommandResults, ModelResults, Place, SampleResults, describe};

/// Options of long computations.
#[derive(clap::Args, Clone, Copy, Default)]
pub struct WorkOptions {
    /// Number of threads [default: number of processors].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Continue an interrupted run, if there is one.
    #[arg(long)]
    pub resume: bool,
    /// Compute only part I of N, into a file for `archrock merge PART...`.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
}

impl From<PartError> for Failure {
    fn from(PartError { kind, message }: PartError) -> Self {
        Self::Input(match kind {
            PartErrorKind::System => return Self::Work(message),
            PartErrorKind::Folder => format!("{message}; choose another with --out"),
            PartErrorKind::Other => {
                format!("{message}: remove it, or choose another folder with --out")
            }
            PartErrorKind::Interrupted => {
                format!("{message}: continue with --resume, or remove it to start over")
            }
            PartErrorKind::Incomplete(shard) => {
                format!("{message}: finish it with --shard {shard} --resume")
            }
            _ => message,
        })
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Scenario(message) => Self::Input(message),
            StudyError::Read(error) => error.into(),
            StudyError::Part(error) | StudyError::Runner(RunnerError::Part(error)) => error.into(),
            StudyError::Output(error) => error.into(),
            StudyError::Film(error) => error.into(),
            _ => Self::Work(error.to_string()),
        }
    }
}

impl WorkOptions {
    /// True if only a part is requested.
    pub const fn is_part(self) -> bool {
        self.shard.is_some()
    }
}

/// Computes the studies of a command.
pub struct StudyJob {
    /// Name of the scenario file, for errors about the scenario.
    pub file: String,
    pub work: WorkOptions,
    pub style: Style,
    pub options: Options,
    /// The locked folder for all results, if files are written.
    pub root: Option<Folder>,
    /// The files that keep the rows of results until these are published.
    pub finished_parts: Vec<PartFile>,
}

impl StudyJob {
    /// Publishes all results.
    pub fn publish(&mut self) -> Result<(), Failure> {
        self.root.as_ref().map_or(Ok(()), publish)?;
        let mut parts = self.finished_parts.drain(..);
        Ok(parts.try_for_each(PartFile::remove)?)
    }

    /// Adds to the failure of a task the complete results of other tasks, which stay under hidden names.
    pub fn failed(&self, failure: Failure) -> Failure {
        failure.map(|message| match self.unpublished() {
            Some(kept) => format!("{message}\nerror: {kept}"),
            None => message,
        })
    }

    /// Leaves the complete results of other tasks under hidden names, because a task failed, and returns the message about them; `None` without
    /// such results.
    pub fn unpublished(&self) -> Option<String> {
        let root = self.root.as_ref()?;
        let files = root.keep()?;
        let path = root.path().display();
        Some(format!(
            "{path}: nothing was published, so earlier results stay; {files}"
        ))
    }

    /// Returns an error if the results of a study cannot be written to the folder. Of a run, only the last name is known in advance.
    fn check_names(&self, kind: StudyKind, folder: Option<&Folder>) -> Result<(), Failure> {
        let first = if kind.streams_tables {
            kind.files.len() - 1
        } else {
            0
        };
        let names = match self.work.is_part() {
            true => &[],
            false => &kind.files[first..],
        };
        Ok(folder.map_or(Ok(()), |folder| folder.check(names))?)
    }

    /// Returns an error if results cannot be written: those of each scenario (one for each model of motion), of its samples, or of the comparison of
    /// the models.
    pub fn check_results(
        &self,
        kind: StudyKind,
        scenarios: &[Scenario],
        folder: Option<&Folder>,
    ) -> Result<(), Failure> {
        let Some(folder) = folder else { return Ok(()) };
        let (several, divided) = (scenarios.len() > 1, self.is_divided(kind, scenarios));
        let mut are_compared = several && divided && kind.has_rotations;
        for scenario in scenarios {
            let model = scenario.motion.kind;
            let own = folder.of_model(model, divided || (several && kind.streams_tables));
            self.check_names(kind, Some(&own))?;
            if let Some(samples) = kind.samples.filter(|_| has_uncertain(scenario)) {
                let samples_folder = folder.of_model(model, several).within(samples.name);
                self.check_names(*samples, Some(&samples_folder))?;
                are_compared |= several && !divided && samples.has_rotations;
            }
        }
        if are_compared && !self.work.is_part() {
            comparison_folder(folder, kind).check(&PEAKS_FILES)?;
        }
        Ok(())
    }

    /// Computes a study, and prepares its results in the folder, if there is one; those of a run include the results on `samples`. Of a part, reports
    /// the file and returns `None`.
    pub fn compute(
        &mut self,
        kind: StudyKind,
        scenarios: &[Scenario],
        folder: Option<&Folder>,
        samples: &[Results],
    ) -> Result<Option<Results>, Failure> {
        let work = self.work;
        let shard = work.shard.unwrap_or(Shard::WHOLE);
        let task = folder.map(|folder| Task {
            folder: folder.path(),
            shard,
            resume: work.resume,
        });
        self.check_names(kind, folder.filter(|_| !kind.streams_tables))?;
        let threads = work.threads.and_then(|n| NonZeroUsize::new(n.into()));
        let runner = Runner { threads };
        let (mut shown, mut last) = (None, (0, false));
        let samples_are_kept = !self.finished_parts.is_empty();
        let mut watch = |progress: Progress| {
            let Progress { done, counted, .. } = progress;
            // The history of the next model, or the next step of a search begins.
            let is_open = matches!(counted, Counted::Search(step) if step.is_open);
            let (before, was_open) = std::mem::replace(&mut last, (done, is_open));
            if done < before || is_open != was_open {
                shown = None;
            }
            let display = shown.get_or_insert_with(|| {
                // Ctrl-C ends a history at once, unless samples before it listen already.
                if counted != Counted::Milliseconds {
                    listen_to_interrupts();
                }
                Display::new(progress)
            });
            // No row is being written, and a study with a file has all finished rows in it, so it is safe to exit.
            if INTERRUPTED.load(Ordering::Relaxed) {
                display.abandon();
                print_always(&interrupted(kind, task, progress, samples_are_kept));
                process::exit(INTERRUPTED_CODE);
            }
            display.show(progress);
            ControlFlow::Continue(())
        };
        let sinks = Sinks {
            folder: folder.cloned(),
            rotations: self.options.run.no_rotations.then(stdout),
            samples,
            ..Sinks::default()
        };
        let work = Work {
            runner,
            task,
            watch: &mut watch,
        };
        let done = kind.compute(scenarios, &self.options, self.style, work, sinks);
        drop(shown);
        let done = done.map_err(|error| match error {
            StudyError::Scenario(message) => Failure::Input(format!("{}: {message}", self.file)),
            error => error.into(),
        });
        match done? {
            Computation::Complete(mut results, part) => {
                folder.map_or(Ok(()), |folder| self.write(&mut results, folder))?;
                self.finished_parts.extend(part);
                Ok(Some(*results))
            }
            Computation::Partial { part, cases, all } => {
                let path = part.path().display();
                print_status(&format!(
                    "part {shard}: {cases} of {all} cases in {path}; join all parts with `archrock merge PART...`"
                ));
                Ok(None)
            }
        }
    }

    /// Computes a study of scenarios that differ in their models of motion, and its comparison of the models. Of a part, returns `None`.
    pub fn compute_all(
        &mut self,
        kind: StudyKind,
        scenarios: &[Scenario],
        folder: Option<&Folder>,
    ) -> Result<Option<CommandResults>, Failure> {
        let (mut of_models, several) = (Vec::new(), self.is_divided(kind, scenarios));
        let groups = match several {
            true => scenarios.chunks(1),
            false => scenarios.chunks(scenarios.len()),
        };
        for group in groups {
            let folder = folder.map(|root| root.of_model(group[0].motion.kind, several));
            of_models.extend(self.compute_with_samples(kind, group, folder.as_ref())?);
        }
        if of_models.is_empty() {
            return Ok(None);
        }
        let results = of_models.iter().map(|one| &one.own);
        let models: Vec<_> = scenarios.iter().zip(results).collect();
        let compared = match several && kind.has_rotations {
            true => self.compare(kind, &models, folder)?,
            false => None,
        };
        Ok(Some(CommandResults {
            of_models,
            compared,
        }))
    }

    /// Returns true if each model is computed alone, with results in a folder of its own.
    fn is_divided(&self, kind: StudyKind, scenarios: &[Scenario]) -> bool {
        scenarios.len() > 1 && !kind.takes_models()
    }

    /// Computes a study of scenarios that differ in their models of motion, after the samples of those that have `[uncertain]`, whose results
    /// are in folders of their own inside `folder`. Of a part, only the samples are computed if there are any; without a folder there are none.
    fn compute_with_samples(
        &mut self,
        kind: StudyKind,
        scenarios: &[Scenario],
        folder: Option<&Folder>,
    ) -> Result<Option<ModelResults>, Failure> {
        let several = scenarios.len() > 1;
        let samples = kind.samples.filter(|_| scenarios.iter().any(has_uncertain));
        let has_samples = samples.is_some();
        if self.work.is_part() && folder.is_none() {
            return Err("--shard writes a file: name a folder for it with --out".into());
        }
        if self.work.is_part() && !has_samples && !kind.has_parts() {
            let message =
                "--shard computes a part of the samples of [uncertain], which the scenario lacks";
            return Err(message.into());
        }
        if let Some((folder, samples)) = folder.zip(kind.samples).filter(|_| !has_samples) {
            warn_of_rows(folder, *samples);
        }
        let (mut models, mut of_samples) = (Vec::new(), Vec::new());
        let with_samples = scenarios.iter().filter(|one| has_uncertain(one));
        let with_samples = with_samples.flat_map(|one| samples.zip(folder).map(|it| (one, it)));
        for (scenario, (samples, folder)) in with_samples {
            let model = scenario.motion.kind;
            let folder = folder.of_model(model, several).within(samples.name);
            if let Some(results) =
                self.compute(*samples, slice::from_ref(scenario), Some(&folder), &[])?
            {
                models.push((model, self.place(&folder, *samples, &results)));
                of_samples.push(results);
            }
        }
        if self.work.is_part() && has_samples {
            return Ok(None);
        }
        // The page of a run begins with the words about its samples, and its JSON contains theirs.
        let own = self.compute(kind, scenarios, folder, &of_samples)?;
        let of_samples = of_samples.into_iter();
        let Some(own) = own else { return Ok(None) };
        let of_samples = of_samples
            .zip(models)
            .map(|(results, (model, place))| SampleResults {
                model,
                results,
                place,
            });
        let of_samples: Vec<SampleResults> = of_samples.collect();
        let with_samples = scenarios.iter().filter(|one| has_uncertain(one));
        let compared = with_samples.zip(&of_samples);
        let compared = compared.filter(|_| samples.is_some_and(|samples| samples.has_rotations));
        let models: Vec<_> = compared
            .map(|(scenario, one)| (scenario, &one.results))
            .collect();
        Ok(Some(ModelResults {
            model: scenarios[0].motion.kind,
            compared: self.compare(kind, &models, folder)?,
            samples: of_samples,
            place: folder.map(|folder| self.place(folder, kind, &own)),
            own,
        }))
    }

    /// Compares the largest rotations of several models in the same cases, and prepares the comparison beside their folders. `None` for one model, or
    /// without a folder.
    pub fn compare(
        &self,
        kind: StudyKind,
        models: &[(&Scenario, &Results)],
        folder: Option<&Folder>,
    ) -> Result<Option<Results>, Failure> {
        let (2.., Some(folder)) = (models.len(), folder) else {
            return Ok(None);
        };
        let results = peak_results(models, self.style.figure);
        let mut results = results.map_err(StudyError::from)?;
        self.write(&mut results, &comparison_folder(folder, kind))?;
        Ok(Some(results))
    }

    fn place(&self, folder: &Folder, kind: StudyKind, results: &Results) -> Place {
        describe(folder, kind, results, !self.options.run.no_report)
    }

    /// Writes results into a folder, without their page if the user wants none.
    fn write(&self, results: &mut Results, folder: &Folder) -> Result<(), Failure> {
        if self.options.run.no_report {
            results.files.retain(|(name, _)| !name.ends_with(".html"));
        }
        Ok(results.write(folder)?)
    }
}

/// Publishes the results in a locked folder. Signals wait until it is done.
pub fn publish(folder: &Folder) -> Result<(), Failure> {
    Ok(uninterrupted(|| folder.publish())?)
}

/// Returns the folder for the comparison of models of motion: `models`, or another one if another command has compared models there.
fn comparison_folder(folder: &Folder, kind: StudyKind) -> Folder {
    let models = folder.within("models");
    let [.., seal] = PEAKS_FILES;
    match models.is_of_other_command(seal) {
        true => folder.within(format!("models_{}", kind.name)),
        false => models,
    }
}

pub fn has_uncertain(scenario: &Scenario) -> bool {
    scenario.uncertain.is_some()
}

/// Warns about rows of an interrupted study of samples. A command without samples does not remove them.
fn warn_of_rows(folder: &Folder, samples: StudyKind) {
    let part = folder.path().join(samples.name);
    let part = part.join(Shard::WHOLE.file_name(samples.name));
    if let Some(rows) = rows_in(&part).filter(|rows| *rows > 0) {
        let kept = "cases of samples from an interrupted run; they are not part of the results of this run";
        super::warn(&[format!("{} has {rows} {kept}", part.display())]);
    }
}

/// The message when Ctrl-C ends a computation.
fn interrupted(
    kind: StudyKind,
    task: Option<Task<'_>>,
    Progress { done, all, .. }: Progress,
    samples_are_kept: bool,
) -> String {
    let file = task.map(|task| task.folder.join(task.shard.file_name(kind.name)));
    match file {
        _ if !kind.has_parts() && samples_are_kept => {
            "interrupted: the samples are kept; continue with --resume".to_owned()
        }
        _ if !kind.has_parts() => "interrupted".to_owned(),
        Some(file) if !file.exists() => {
            format!("interrupted; {} was removed meanwhile", file.display())
        }
        _ => format!("interrupted: {done} of {all} cases are done; continue with --resume"),
    }
}

fn stdout() -> Box<dyn io::Write> {
    Box::new(BufWriter::new(io::stdout().lock()))
}
