//! The recorder of a run: it passes samples and events on to tables and drawings while the history is computed.

use std::collections::BTreeMap;
use std::io;
use std::ops::ControlFlow;
use std::time::Duration;

use super::{Drawings, EVENTS, IMPACTS, JOINTS, POSES, ROTATIONS, Run, Sinks, tables};
use crate::clock;
use crate::dynamics::FallEnd;
use crate::output::{Column, NewFile, OutputError, TableWriter, columns};
use crate::studies::{Counted, Progress, RunnerError, StudyError, Watch};
use crate::{Event, OpenHinge, Pose, Recorder, Sample};

/// The tables of a run while they are written, by their names.
#[derive(Default)]
pub(super) struct TableFiles {
    pub(super) on_disk: BTreeMap<&'static str, NewFile>,
    pub(super) in_memory: BTreeMap<&'static str, Vec<u8>>,
}

impl TableFiles {
    /// Creates the tables among the files of these names, on disk in a folder to which all these files can be written.
    pub(super) fn create(sinks: &Sinks<'_>, names: &[&'static str]) -> Result<Self, OutputError> {
        let tables = names.iter().filter(|name| name.ends_with(".csv"));
        let mut files = Self::default();
        if let Some(folder) = &sinks.folder {
            folder.check(names)?;
            let created = tables.map(|name| Ok((*name, folder.create(name)?)));
            files.on_disk = created.collect::<Result<_, OutputError>>()?;
        } else {
            files.in_memory = tables.map(|name| (*name, Vec::new())).collect();
        }
        Ok(files)
    }

    pub(super) fn outputs(&mut self) -> impl Iterator<Item = (&'static str, Output<'_>)> {
        let on_disk = self
            .on_disk
            .iter_mut()
            .map(|(name, file)| (*name, boxed(&mut file.writer)));
        let in_memory = self.in_memory.iter_mut();
        on_disk.chain(in_memory.map(|(name, bytes)| (*name, boxed(bytes))))
    }

    /// Tables in memory together with the other files.
    pub(super) fn with_texts(
        self,
        texts: BTreeMap<&'static str, String>,
    ) -> Vec<(&'static str, Vec<u8>)> {
        let texts = texts
            .into_iter()
            .map(|(name, text)| (name, text.into_bytes()));
        self.in_memory.into_iter().chain(texts).collect()
    }
}

/// The output of a table.
pub(super) type Output<'f> = Box<dyn io::Write + 'f>;

/// A table that is written during the computation.
pub(super) type StreamedTable<'f, R> = TableWriter<'static, R, Output<'f>>;

pub(super) fn boxed<'f>(output: impl io::Write + 'f) -> Output<'f> {
    Box::new(output)
}

/// Begins a table.
fn streamed<'f, R>(
    name: &str,
    file: Output<'f>,
    columns: Vec<Column<'static, R>>,
) -> Result<StreamedTable<'f, R>, OutputError> {
    columns::check(name, columns.iter().flat_map(Column::names));
    let what = format!("cannot write the {}", name.trim_end_matches(".csv"));
    TableWriter::new(file, what, columns)
}

/// The tables of a run.
#[derive(Default)]
pub(super) struct Tables<'f> {
    samples: Vec<StreamedTable<'f, Sample>>,
    /// Each with whether it has rows for impacts alone.
    events: Vec<(bool, StreamedTable<'f, Event>)>,
}

impl<'f> Tables<'f> {
    pub(super) fn new(
        run: &Run<'_>,
        outputs: impl Iterator<Item = (&'static str, Output<'f>)>,
    ) -> Result<Self, OutputError> {
        let model = &*run.model;
        let mut tables = Self::default();
        for (name, file) in outputs {
            let columns = match name {
                ROTATIONS => {
                    let ground = run.scenario.ground_motion();
                    let mut columns = tables::rotations(model, ground, run.scales);
                    columns.extend(run.points.columns());
                    columns
                }
                POSES => tables::poses(&model.bodies()),
                JOINTS => tables::joints(model),
                EVENTS | IMPACTS => {
                    let columns = match model.as_mechanisms() {
                        _ if name == EVENTS => tables::events(model),
                        Some(model) => tables::impacts(model),
                        None => tables::landings(model),
                    };
                    let table = streamed(name, file, columns)?;
                    tables.events.push((name == IMPACTS, table));
                    continue;
                }
                _ => continue,
            };
            tables.samples.push(streamed(name, file, columns)?);
        }
        Ok(tables)
    }

    fn sample(&mut self, sample: &Sample) -> Result<(), OutputError> {
        let mut tables = self.samples.iter_mut();
        tables.try_for_each(|table| table.write(sample))
    }

    fn event(&mut self, event: &Event) -> Result<(), OutputError> {
        let mut tables = self
            .events
            .iter_mut()
            .filter(|(of_impacts, _)| !of_impacts || event.impact.is_some());
        tables.try_for_each(|(_, table)| table.write(event))
    }

    /// Completes the tables and returns the number of samples.
    pub(super) fn finish(self) -> Result<usize, OutputError> {
        for (_, table) in self.events {
            table.finish()?;
        }
        let mut samples = self.samples.into_iter();
        samples.try_fold(0, |_, table| table.finish())
    }
}

/// Passes samples and events on to the tables and pictures.
pub(super) struct RunRecorder<'r, 'f> {
    pub(super) tables: Tables<'f>,
    pub(super) drawings: &'r mut Drawings,
    pub(super) watch: Watch<'r>,
    /// The simulated time, in milliseconds.
    pub(super) duration_ms: usize,
    /// The error that ends the history: a table could not be written, or the work was cancelled.
    pub(super) status: Result<(), StudyError>,
}

/// Milliseconds in a second, for the progress.
pub(super) const MILLISECONDS: f64 = 1e3;

impl RunRecorder<'_, '_> {
    /// Ends the history after an error.
    const fn flow(&self) -> ControlFlow<()> {
        match self.status {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    }
}

/// Makes the progress of a history from milliseconds of simulated time.
pub(super) const fn simulated(done: usize, all: usize) -> Progress {
    Progress {
        done,
        all,
        counted: Counted::Milliseconds,
    }
}

impl Recorder for RunRecorder<'_, '_> {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        // All is done only while the history is repeated.
        let (done, all) = ((sample.time_s * MILLISECONDS) as usize, self.duration_ms);
        let done = done.min(all.saturating_sub(1));
        let progress = simulated(done, all);
        let _ = self.drawings.sample(sample);
        self.status = match (self.watch)(progress) {
            ControlFlow::Continue(()) => self.tables.sample(sample).map_err(StudyError::from),
            ControlFlow::Break(()) => Err(RunnerError::Cancelled(progress).into()),
        };
        self.flow()
    }

    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        let _ = self.drawings.event(event);
        // If a failed table ended the history, that end is not an event.
        if self.status.is_ok() {
            self.status = self.tables.event(event).map_err(StudyError::from);
        }
        self.flow()
    }

    fn wants_thrust_line(&self) -> bool {
        self.drawings.wants_thrust_line()
    }

    fn clock(&self) -> Option<Duration> {
        clock::elapsed()
    }

    fn step(&mut self, time_s: f64, poses: &[Pose], hinges: &[OpenHinge]) {
        self.drawings.step(time_s, poses, hinges);
    }

    fn wants_fall(&self) -> bool {
        self.drawings.wants_fall()
    }

    fn fall_sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.drawings.fall_sample(sample)
    }

    fn fall_end(&mut self, end: FallEnd) {
        self.drawings.fall_end(end);
    }
}
