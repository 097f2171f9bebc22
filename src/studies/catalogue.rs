//! The studies that a scenario can describe, each in the table of its name: computed and reported, whichever it is.

use std::ops::ControlFlow;
use std::path::PathBuf;

use thiserror::Error;

use super::ensemble::cells::CellsOfSamples;
use super::ensemble::edges::FirstEdges;
use super::ensemble::histories::Histories;
use super::ensemble::records::Capacities;
use super::ensemble::{Ensemble, Question};
use super::map::OverturningMap;
use super::part::{self, PartError, PartFile};
use super::results::{Look, Results};
use super::runner::{Computed, Progress, Runner, RunnerError, Study, Task};
use super::suite::{Heading, RecordSuite};
use super::threshold::Factors;
use super::threshold::along::{self, Along, AlongOptions};
use crate::output::OutputError;
use crate::scenario::{Scenario, ScenarioErrors};

named! {
    /// A study that a scenario describes.
    pub enum StudyKind {
        /// Which pulses overturn the structure, over two quantities.
        Map = "map",
        /// The threshold for each value of a key along a range.
        ThresholdAlong = "threshold_along",
        /// Which records overturn the structure.
        Suite = "suite",
        /// How histories end and proceed, for samples of the uncertain numbers.
        Uncertain = "uncertain",
        /// The factor from which samples of the uncertain numbers overturn.
        UncertainThreshold = "uncertain_threshold",
        /// Which records overturn samples of the uncertain numbers.
        UncertainSuite = "uncertain_suite",
        /// How likely pulses overturn, over two quantities, as far as samples of what is not known tell.
        UncertainMap = "uncertain_map",
    }
}

/// Why a study has no results.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The scenario does not describe it.
    #[error("{0}")]
    Scenario(String),
    /// Its rows could not be completed.
    #[error(transparent)]
    Runner(#[from] RunnerError),
    /// Its parts cannot be joined.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The scenario of its parts cannot be read.
    #[error(transparent)]
    Read(#[from] ScenarioErrors),
    /// A result is not a number.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// The result of a computation.
#[derive(Debug)]
pub enum Done {
    /// All cases, and the file that keeps their rows until the results are written; `None` if the rows are in memory.
    Whole(Results, Option<PartFile>),
    /// A part of the cases.
    Part {
        /// The file that keeps their rows.
        part: PartFile,
        /// The number of cases in the file.
        cases: usize,
        /// The number of cases of the study.
        all: usize,
    },
}

impl StudyKind {
    /// The kind with this name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// The names of all files that its results may have, the seal last.
    #[must_use]
    pub const fn files(self) -> &'static [&'static str] {
        match self {
            Self::Map => &["map.svg", "map.html", "map.json", "map.csv"],
            Self::ThresholdAlong => &along::FILES,
            Self::Suite => &[
                "suite.svg",
                "ida.svg",
                "peaks.svg",
                "ida.csv",
                "peaks.csv",
                "capacity.csv",
                "intensity.csv",
                "fragility.csv",
                "fragility.json",
                "suite.csv",
            ],
            Self::Uncertain => &[
                "bands.svg",
                "matters.svg",
                "bands.csv",
                "samples.csv",
                "uncertain.json",
            ],
            Self::UncertainThreshold => &[
                "probability.svg",
                "matters.svg",
                "probability.csv",
                "samples.csv",
                "uncertain.json",
            ],
            Self::UncertainSuite => &[
                "fragility.svg",
                "matters.svg",
                "fragility.csv",
                "capacities.csv",
                "samples.csv",
                "uncertain.json",
            ],
            Self::UncertainMap => &[
                "map.svg",
                "map.html",
                "matters.svg",
                "probability.csv",
                "map.csv",
                "uncertain.json",
            ],
        }
    }

    /// Computes the study of a scenario, in a folder, where it can be resumed, or in memory. `watch` is as in [`Runner::rows`].
    ///
    /// # Errors
    /// When the scenario does not describe the study, or its rows could not be completed.
    pub fn compute(
        self,
        scenario: &Scenario,
        look: Look,
        runner: Runner,
        task: Option<Task<'_>>,
        watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Done, StudyError> {
        match self {
            Self::Map => {
                let map = OverturningMap::of(scenario).map_err(StudyError::Scenario)?;
                complete(&map, runner, task, watch, |rows| map.tell(&rows, look))
            }
            Self::ThresholdAlong => Err(StudyError::Scenario(
                "a threshold along a range needs its key and its values".to_owned(),
            )),
            Self::Suite => {
                let study = RecordSuite::of(scenario).map_err(StudyError::Scenario)?;
                let heading = study.heading();
                complete(&study, runner, task, watch, |rows| {
                    heading.tell(rows, look.figure)
                })
            }
            Self::Uncertain => {
                let question = Histories::of(scenario).map_err(StudyError::Scenario)?;
                let study = ensemble(scenario, question)?;
                complete(&study, runner, task, watch, |rows| study.tell(&rows, look))
            }
            Self::UncertainThreshold => {
                first_edges(scenario, Factors::default(), look, runner, task, watch)
            }
            Self::UncertainSuite => {
                let question = Capacities::of(scenario).map_err(StudyError::Scenario)?;
                let study = ensemble(scenario, question)?;
                complete(&study, runner, task, watch, |rows| study.tell(&rows, look))
            }
            Self::UncertainMap => {
                let study = CellsOfSamples::of(scenario).map_err(StudyError::Scenario)?;
                complete(&study, runner, task, watch, |rows| study.tell(&rows, look))
            }
        }
    }
}

/// The same for [`StudyKind::UncertainThreshold`], with these factors.
///
/// # Errors
/// As [`StudyKind::compute`].
pub fn first_edges(
    scenario: &Scenario,
    factors: Factors,
    look: Look,
    runner: Runner,
    task: Option<Task<'_>>,
    watch: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<Done, StudyError> {
    let question = FirstEdges::of(scenario, factors).map_err(StudyError::Scenario)?;
    let study = ensemble(scenario, question)?;
    complete(&study, runner, task, watch, |rows| study.tell(&rows, look))
}

/// [`StudyKind::compute`] for [`StudyKind::ThresholdAlong`], with its options.
///
/// # Errors
/// As [`StudyKind::compute`].
pub fn thresholds_along(
    scenario: &Scenario,
    options: AlongOptions,
    look: Look,
    runner: Runner,
    task: Option<Task<'_>>,
    watch: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<Done, StudyError> {
    let study = Along::of(scenario, options).map_err(StudyError::Scenario)?;
    complete(&study, runner, task, watch, |rows| {
        study.results(&rows, look.figure)
    })
}

fn ensemble<Q: Question>(scenario: &Scenario, question: Q) -> Result<Ensemble<'_, Q>, StudyError> {
    Ensemble::new(scenario, question).map_err(StudyError::Scenario)
}

/// Computes the requested cases, and turns them into results if they are all cases.
fn complete<S: Study>(
    study: &S,
    runner: Runner,
    task: Option<Task<'_>>,
    watch: impl FnMut(Progress) -> ControlFlow<()>,
    tell: impl FnOnce(Vec<S::Row>) -> Result<Results, OutputError>,
) -> Result<Done, StudyError> {
    let Some(task) = task else {
        let rows = runner.rows(study, watch)?;
        return Ok(Done::Whole(tell(rows)?, None));
    };
    Ok(match runner.rows_in(study, task, watch)? {
        Computed::Whole(rows, part) => Done::Whole(tell(rows)?, Some(part)),
        Computed::Shard(part) => {
            let all = study.count();
            let cases = task.shard.cases(all).count();
            Done::Part { part, cases, all }
        }
    })
}

/// Joins the parts of a study. The scenario is `given`, or is read from the parts; a suite needs none, because its records
/// may have moved. `look` decides how the results look, and may refuse options that do not fit the study.
///
/// # Errors
/// When parts are missing, do not belong to one study or belong to a scenario other than the given one, or `look` refuses.
pub fn merge(
    parts: &[PathBuf],
    given: Option<&Scenario>,
    look: impl FnOnce(StudyKind, Option<&Scenario>) -> Result<Look, String>,
) -> Result<(StudyKind, Results), StudyError> {
    let first = parts.first().map(|part| part::read_header(part));
    let study = first
        .transpose()?
        .map_or(String::new(), |first| first.study);
    let kind = StudyKind::of_name(&study).ok_or_else(|| {
        StudyError::Scenario(format!(
            "unknown study {study:?}: merge with the version of archrock that wrote the parts"
        ))
    })?;
    let read = |text: &str| match given {
        None => Ok(Scenario::parse(text, "the scenario of the parts")?),
        Some(given) if given.to_toml() == text => Ok(given.clone()),
        Some(_) => Err(StudyError::Scenario(
            "the parts are of another scenario than the one given".to_owned(),
        )),
    };
    let results = match kind {
        StudyKind::Map => {
            let (header, rows) = part::merge(parts)?;
            let scenario = read(&header.scenario)?;
            let map = OverturningMap::of(&scenario).map_err(StudyError::Scenario)?;
            let look = look(kind, Some(&scenario)).map_err(StudyError::Scenario)?;
            map.tell(&rows, look)?
        }
        StudyKind::ThresholdAlong => {
            let look = look(kind, None).map_err(StudyError::Scenario)?;
            let (header, rows) = part::merge(parts)?;
            let scenario = read(&header.scenario)?;
            let options = serde_json::from_value(header.options)
                .map_err(|error| StudyError::Scenario(error.to_string()))?;
            let study = Along::of(&scenario, options).map_err(StudyError::Scenario)?;
            study.results(&rows, look.figure)?
        }
        StudyKind::Suite => {
            let look = look(kind, None).map_err(StudyError::Scenario)?;
            let (header, rows) = part::merge(parts)?;
            let heading =
                Heading::of_resolved(&header.scenario, header.warnings).ok_or_else(|| {
                    let message = "the scenario of the parts is damaged: compute them again";
                    StudyError::Scenario(message.to_owned())
                })?;
            heading.tell(rows, look.figure)?
        }
        StudyKind::Uncertain => {
            let look = look(kind, None).map_err(StudyError::Scenario)?;
            let (header, rows) = part::merge(parts)?;
            let scenario = read(&header.scenario)?;
            let question = Histories::of(&scenario).map_err(StudyError::Scenario)?;
            ensemble(&scenario, question)?.tell(&rows, look)?
        }
        StudyKind::UncertainThreshold => {
            let look = look(kind, None).map_err(StudyError::Scenario)?;
            let (header, rows) = part::merge(parts)?;
            let scenario = read(&header.scenario)?;
            // The rows themselves know the range of the factors.
            let question = FirstEdges::of(&scenario, Factors::default());
            let question = question.map_err(StudyError::Scenario)?;
            ensemble(&scenario, question)?.tell(&rows, look)?
        }
        StudyKind::UncertainSuite => {
            let look = look(kind, None).map_err(StudyError::Scenario)?;
            let (header, rows) = part::merge(parts)?;
            let scenario = read(&header.scenario)?;
            let question = Capacities::of(&scenario).map_err(StudyError::Scenario)?;
            ensemble(&scenario, question)?.tell(&rows, look)?
        }
        StudyKind::UncertainMap => {
            let (header, rows) = part::merge(parts)?;
            let scenario = read(&header.scenario)?;
            let study = CellsOfSamples::of(&scenario).map_err(StudyError::Scenario)?;
            let look = look(kind, Some(&scenario)).map_err(StudyError::Scenario)?;
            study.tell(&rows, look)?
        }
    };
    Ok((kind, results))
}
