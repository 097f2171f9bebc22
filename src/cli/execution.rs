//! Executes a study of the scenarios of a command, publishes its results and prints them: one way for all commands.

use std::io::{self, Write as _};

use archrock::output::{Folder, PictureFormat};
use archrock::scenario::shown_lines;
use archrock::studies::{Options, StudyKind, Style};
use serde_json::Value;

use super::models::warn_of;
use super::results::{CommandResults, Detail};
use super::scenario_file::{Destination, FileTasks, ScenarioTask};
use super::study::{StudyJob, WorkOptions, has_uncertain};
use super::{Failure, Format, print, print_all};

/// The study of a command, and the options with which it is executed.
pub struct Execution {
    pub kind: StudyKind,
    pub style: Style,
    pub options: Options,
    pub work: WorkOptions,
    /// Format of the pictures in addition to SVG.
    pub pictures: Option<PictureFormat>,
    pub format: Format,
    pub detail: Detail,
    /// True if standard output carries a table and nothing else.
    pub has_words_apart: bool,
}

/// Tasks with one locked folder around their results, if files are written.
struct LockedTasks {
    name: String,
    root: Option<Folder>,
    tasks: Vec<ScenarioTask>,
}

impl Execution {
    /// Computes the study for the tasks of all files. A failed task does not keep others from being computed, but results in the same folder are then not
    /// published.
    pub fn execute(&self, files: Vec<FileTasks>) -> Result<(), Failure> {
        let tasks = files.iter().flat_map(|file| &file.tasks);
        let mut scenarios = tasks.clone().flat_map(|task| &task.scenarios);
        let count = tasks.count();
        if self.work.resume && !self.kind.has_parts() && !scenarios.any(has_uncertain) {
            let message = "--resume continues the samples of [uncertain], which the scenario lacks: leave it out";
            return Err(message.into());
        }
        let (mut summaries, mut failures, mut printed) = (Vec::new(), Vec::new(), Ok(()));
        for LockedTasks { name, root, tasks } in self.locked(files)? {
            let mut job = StudyJob {
                file: name,
                work: self.work,
                style: self.style,
                options: self.options.clone(),
                root,
                finished_parts: Vec::new(),
            };
            for task in &tasks {
                let folder = job.root.as_ref().map(|root| task.folder(root));
                job.check_results(self.kind, &task.scenarios, folder.as_ref())?;
            }
            let scenarios = tasks.iter().flat_map(|task| &task.scenarios);
            warn_of(scenarios, &self.options.varied());
            let mut failed = Vec::new();
            for (index, task) in tasks.iter().enumerate() {
                let folder = job.root.as_ref().map(|root| task.folder(root));
                let earlier_parts = job.finished_parts.len();
                let found = match job.compute_all(self.kind, &task.scenarios, folder.as_ref()) {
                    Err(Failure::Work(message)) if count > 1 => {
                        folder.iter().for_each(Folder::abandon);
                        // The file with the samples of the failed scenario stays, for --resume.
                        job.finished_parts.truncate(earlier_parts);
                        failed.push(format!("{}: {message}", task.name));
                        None
                    }
                    found => found.map_err(|failure| job.failed(failure))?,
                };
                // All results in a folder replace the earlier ones together, once the last of them is complete.
                if index + 1 == tasks.len() && failed.is_empty() {
                    job.publish()?;
                }
                let Some(found) = found else { continue };
                // A closed pipe ends the words, not the work.
                printed = printed.and_then(|()| self.print(&found, task, task.again.as_deref()));
                if matches!(self.format, Format::Json) {
                    summaries.push(found.summary(self.kind)?);
                }
            }
            if !failed.is_empty() {
                failures.append(&mut failed);
                failures.extend(job.unpublished());
            }
        }
        printed?;
        self.end(summaries, failures)
    }

    /// Prints the results of a task in words.
    fn print(
        &self,
        found: &CommandResults,
        task: &ScenarioTask,
        again: Option<&str>,
    ) -> Result<(), Failure> {
        let title = task.scenarios[0].title.as_deref();
        let words = || found.words(self.kind, title, self.detail, again);
        match self.format {
            Format::Json => Ok(()),
            Format::Text if !self.has_words_apart => print(&words()),
            Format::Text if self.detail == Detail::Quiet => Ok(()),
            Format::Text => {
                // When standard error fails there is nowhere to report it.
                let _ = io::stderr().write_all(shown_lines(&words()).as_bytes());
                Ok(())
            }
        }
    }

    /// Prints the summaries of all tasks as JSON, and reports failures.
    fn end(&self, summaries: Vec<Value>, failures: Vec<String>) -> Result<(), Failure> {
        if !summaries.is_empty() {
            print_all(summaries)?;
        }
        match failures.is_empty() {
            true => Ok(()),
            false => Err(Failure::Work(failures.join("\nerror: "))),
        }
    }

    /// Locks the folders around the results, and returns the tasks in each. Files of one name share a folder.
    fn locked(&self, files: Vec<FileTasks>) -> Result<Vec<LockedTasks>, Failure> {
        let mut all: Vec<LockedTasks> = Vec::new();
        for file in files {
            let path = file.destination.as_ref().map(|one| &*one.path);
            let mut known = all.iter_mut();
            let shared =
                known.find(|other| path.is_some() && other.root.as_ref().map(Folder::path) == path);
            if let Some(LockedTasks { root, tasks, .. }) = shared {
                if let Some(root) = root {
                    root.protect(&file.origin)?;
                }
                tasks.extend(file.tasks);
                continue;
            }
            let is_part = self.work.is_part();
            let lock =
                |one: Destination| one.lock(self.kind.name, file.origin, self.pictures, is_part);
            all.push(LockedTasks {
                name: file.name,
                root: file.destination.map(lock).transpose()?,
                tasks: file.tasks,
            });
        }
        Ok(all)
    }
}
