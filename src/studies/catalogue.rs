//! The list of all studies of a scenario. Each can be computed at once; those of many cases also in parts, which are merged.

use std::path::PathBuf;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::capacity::{self, capacity};
use super::ensemble::uncertain_map::CellsOfSamples;
use super::ensemble::uncertain_run::Histories;
use super::ensemble::uncertain_suite::Capacities;
use super::ensemble::uncertain_threshold::FirstEdges;
use super::ensemble::{Ensemble, Question};
use super::limit;
use super::map::OverturningMap;
use super::part::{self, PartFile};
use super::run::{self, RunOptions, Sinks};
use super::spread::{self, SpringingDirection};
use super::suite::{Heading, RecordSuite};
use super::threshold::along::{Along, AlongOptions};
use super::threshold::{self, Factors};
use super::{ReportedStudy, Results, Runner, StudyError, Style, Task, Watch, verify};
use crate::output::Origin;
use crate::scenario::{ModelKind, Scenario, Varied};

/// Options of studies that are not part of the scenario.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Options {
    /// The factors on the ground motion that a threshold tries.
    pub factors: Factors,
    /// The range of a threshold along a key.
    pub along: Option<AlongOptions>,
    /// The control point of capacity curves, in metres.
    pub point_m: Option<Vector2<f64>>,
    /// The movements of a springing that `spread` follows.
    #[serde(skip_serializing)]
    pub directions: Vec<SpringingDirection>,
    /// The files and pictures of a run.
    #[serde(skip)]
    pub run: RunOptions,
}

impl Options {
    /// Returns the options that warnings about unlikely numbers need.
    pub fn varied(&self) -> Varied<'_> {
        let along = self.along.as_ref().map(AlongOptions::varied);
        along.unwrap_or_else(|| self.factors.varied())
    }
}

/// The source of the rows of a study.
pub enum RowSource<'w> {
    /// They are computed: for a task in its folder, where the work can be resumed, otherwise in memory.
    Compute(Runner, Option<Task<'w>>, Watch<'w>),
    /// They are read from all parts.
    Merge(&'w [PathBuf]),
    /// They are those of a map, given as JSON in the order of the cells.
    Given(&'w [String]),
}

/// Chooses the style of merged results, from the scenario of the parts if that is read, or refuses options that do not fit the study.
pub type ChooseStyle<'l> = &'l mut dyn FnMut(StudyKind, Option<&Scenario>) -> Result<Style, String>;

/// The result of a computation.
#[derive(Debug)]
pub enum Computation {
    /// All cases, and the file that keeps their rows until the results are written; `None` if the rows are in memory.
    Complete(Box<Results>, Option<PartFile>),
    /// A part of the cases.
    Partial {
        /// The file that keeps their rows.
        part: PartFile,
        /// The number of cases in the file.
        cases: usize,
        /// The number of cases of the study.
        all: usize,
    },
}

impl From<Results> for Computation {
    fn from(results: Results) -> Self {
        Self::Complete(Box::new(results), None)
    }
}

impl<'w> RowSource<'w> {
    /// Returns the threads and the progress of a study without parts.
    fn runner_and_watch(self) -> Result<(Runner, Watch<'w>), StudyError> {
        match self {
            Self::Compute(runner, _, watch) => Ok((runner, watch)),
            _ => Err(StudyError::scenario("this study has no parts")),
        }
    }
}

/// Computes a study of scenarios that differ only in their models of motion; most studies take one.
type Compute =
    fn(&[Scenario], &Options, Style, RowSource<'_>, Sinks<'_>) -> Result<Computation, StudyError>;

/// A study that a scenario describes.
#[derive(Clone, Copy, Debug)]
pub struct StudyKind {
    /// Its name.
    pub name: &'static str,
    /// The names of all files that its results may have, the seal last.
    pub files: &'static [&'static str],
    /// True if it computes one history for each model of motion, and writes the tables meanwhile. Its progress is in milliseconds of simulated
    /// time, and options decide which of the files it writes.
    pub is_history: bool,
    /// True if the scenario needs a ground motion.
    pub needs_motion: bool,
    /// True if its words stand below the title of the scenario, indented; otherwise they are a table without a title.
    pub has_title: bool,
    /// True if its rows are kept in a file, so the work can be divided and resumed.
    pub has_parts: bool,
    /// True if it computes scenarios that differ in their models of motion together; otherwise each alone.
    pub takes_models: bool,
    /// True if it has the largest rotation of each case, by which models of motion are compared.
    pub has_rotations: bool,
    /// The study of the samples of `[uncertain]`; `None` without one.
    pub samples: Option<&'static Self>,
    compute: Compute,
}

impl PartialEq for StudyKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for StudyKind {}

/// The history of a scenario, with one or several models of motion.
pub const RUN: StudyKind = StudyKind {
    is_history: true,
    takes_models: true,
    samples: Some(&UNCERTAIN),
    ..StudyKind::without_cases(
        "run",
        &run::FILES,
        |scenarios, options, style, rows, sinks| {
            let (_, watch) = rows.runner_and_watch()?;
            let results = run::results(scenarios, &options.run, style.figure, sinks, watch)?;
            Ok(results.into())
        },
    )
};
/// The map of the pulses that overturn the structure, over two quantities.
pub const MAP: StudyKind = StudyKind {
    samples: Some(&UNCERTAIN_MAP),
    ..StudyKind::of::<OverturningMap<'_>>(|scenarios, _, style, rows, _| {
        let map = OverturningMap::of(&scenarios[0]);
        let RowSource::Given(rows) = rows else {
            return compute_reported(map, style, rows);
        };
        let rows = rows.iter().map(|row| serde_json::from_str(row));
        let rows: Result<_, _> = rows.collect();
        let map = map.map_err(StudyError::Scenario)?;
        Ok(map
            .results(rows.map_err(StudyError::failed)?, style)?
            .into())
    })
};
/// The records that overturn the structure.
pub const SUITE: StudyKind = StudyKind {
    has_rotations: true,
    samples: Some(&UNCERTAIN_SUITE),
    ..StudyKind::of::<RecordSuite<'_>>(|scenarios, _, style, rows, _| {
        compute_reported(RecordSuite::of(&scenarios[0]), style, rows)
    })
};
/// The factors by which the ground motion overturns the structure, for one or several models of motion.
pub const THRESHOLD: StudyKind = StudyKind {
    takes_models: true,
    samples: Some(&UNCERTAIN_THRESHOLD),
    ..StudyKind::without_cases(
        "threshold",
        &threshold::FILES,
        |scenarios, options, style, rows, _| {
            let (runner, watch) = rows.runner_and_watch()?;
            let factors = &options.factors;
            Ok(threshold::results(scenarios, factors, style.figure, &runner, watch)?.into())
        },
    )
};
/// The threshold for each value of a key along a range.
pub const THRESHOLD_ALONG: StudyKind =
    StudyKind::of::<Along<'_>>(|scenarios, options, style, rows, _| {
        let along = options.along.clone();
        let along =
            along.ok_or("a threshold along a range needs its key and its values".to_owned());
        let study = along.and_then(|along| Along::of(&scenarios[0], along));
        compute_reported(study, style, rows)
    });
/// The push that starts the structure, and its mechanism.
pub const LIMIT: StudyKind = StudyKind {
    needs_motion: false,
    has_title: false,
    ..StudyKind::without_cases("limit", &limit::FILES, |scenarios, _, style, _, _| {
        Ok(limit::results(&scenarios[0], style.figure)?.into())
    })
};
/// The capacity curves of the first mechanism.
pub const CAPACITY: StudyKind = StudyKind {
    needs_motion: false,
    has_title: false,
    ..StudyKind::without_cases(
        "capacity",
        &capacity::FILES,
        |scenarios, options, style, _, _| {
            let scenario = &scenarios[0];
            scenario.check_as_built().map_err(StudyError::Scenario)?;
            let sides = capacity(scenario, options.point_m).map_err(StudyError::scenario)?;
            Ok(capacity::report(scenario, &sides, style.figure)?.into())
        },
    )
};
/// The movement of a springing at which the arch falls.
pub const SPREAD: StudyKind = StudyKind {
    needs_motion: false,
    has_title: false,
    ..StudyKind::without_cases(
        "spread",
        &spread::FILES,
        |scenarios, options, style, _, _| {
            let (scenario, directions) = (&scenarios[0], &options.directions);
            let found = spread::spread(scenario, directions)?;
            Ok(spread::report(scenario, &found, style.figure)?.into())
        },
    )
};
/// The check of the first mechanism by the Circolare 7/2019.
pub const VERIFY: StudyKind = StudyKind {
    has_title: false,
    ..StudyKind::without_cases("verify", &verify::FILES, |scenarios, _, _, _, _| {
        let scenario = &scenarios[0];
        scenario.check_as_built().map_err(StudyError::Scenario)?;
        if scenario.right_foot.is_some() {
            let message =
                "`verify` applies one ground motion to both feet: leave [ground.right] out";
            return Err(StudyError::scenario(message));
        }
        let check = verify::verify(scenario).map_err(StudyError::scenario)?;
        Ok(verify::report(scenario, &check)?.into())
    })
};
/// Endings and courses of histories for samples of the uncertain numbers.
pub const UNCERTAIN: StudyKind = StudyKind {
    has_rotations: true,
    ..StudyKind::of_samples::<Histories>()
};
/// The factor from which samples of the uncertain numbers overturn.
pub const UNCERTAIN_THRESHOLD: StudyKind = StudyKind::of_samples::<FirstEdges>();
/// The records that overturn samples of the uncertain numbers.
pub const UNCERTAIN_SUITE: StudyKind = StudyKind::of_samples::<Capacities>();
/// The probability that pulses overturn samples of the uncertain numbers, over two quantities.
pub const UNCERTAIN_MAP: StudyKind =
    StudyKind::of::<CellsOfSamples<'_>>(|scenarios, _, style, rows, _| {
        compute_reported(CellsOfSamples::of(&scenarios[0]), style, rows)
    });

impl StudyKind {
    /// All studies.
    pub const ALL: [Self; 13] = [
        RUN,
        MAP,
        SUITE,
        THRESHOLD,
        THRESHOLD_ALONG,
        LIMIT,
        CAPACITY,
        SPREAD,
        VERIFY,
        UNCERTAIN,
        UNCERTAIN_THRESHOLD,
        UNCERTAIN_SUITE,
        UNCERTAIN_MAP,
    ];

    /// The study with this name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name == name)
    }

    /// The study whose results have these files, the seal last.
    pub fn of_files(names: &[&str]) -> Option<Self> {
        let has_all = |kind: &Self| names.iter().all(|name| kind.files.contains(name));
        let mut kinds = Self::ALL.into_iter();
        kinds.find(|kind| has_all(kind) && kind.files.last() == names.last())
    }

    const fn without_cases(
        name: &'static str,
        files: &'static [&'static str],
        compute: Compute,
    ) -> Self {
        Self {
            name,
            files,
            is_history: false,
            needs_motion: true,
            has_title: true,
            has_parts: false,
            takes_models: false,
            has_rotations: false,
            samples: None,
            compute,
        }
    }

    const fn of<S: ReportedStudy>(compute: Compute) -> Self {
        Self {
            has_parts: true,
            ..Self::without_cases(S::NAME, S::FILES, compute)
        }
    }

    const fn of_samples<Q: Question>() -> Self {
        Self::of::<Ensemble<'_, Q>>(|scenarios, options, style, rows, _| {
            let study = Ensemble::<Q>::of(&scenarios[0], options.factors);
            compute_reported(study, style, rows)
        })
    }

    /// Computes the study of scenarios that differ only in their models of motion. A run and a threshold take several; the others use the first.
    /// A run writes its tables into the sinks.
    ///
    /// # Errors
    /// When the scenario does not describe the study, or its rows could not be completed.
    pub fn compute(
        self,
        scenarios: &[Scenario],
        options: &Options,
        style: Style,
        rows: RowSource<'_>,
        sinks: Sinks<'_>,
    ) -> Result<Computation, StudyError> {
        (self.compute)(scenarios, options, style, rows, sinks)
    }
}

/// Finds the rows of a study, and turns them into results if they are those of all cases.
fn compute_reported<S: ReportedStudy>(
    study: Result<S, String>,
    style: Style,
    rows: RowSource<'_>,
) -> Result<Computation, StudyError> {
    let study = study.map_err(StudyError::Scenario)?;
    let (rows, part) = match rows {
        RowSource::Given(_) => {
            return Err(StudyError::scenario("only the rows of a map can be given"));
        }
        RowSource::Compute(runner, None, watch) => (runner.rows(&study, watch)?, None),
        // This arm leaves the code of parts out of the module for a browser.
        _ if cfg!(target_family = "wasm") => {
            return Err(StudyError::scenario("a browser keeps no parts of a study"));
        }
        RowSource::Merge(parts) => (part::merge(parts)?.1, None),
        RowSource::Compute(runner, Some(task), watch) => {
            match runner.rows_in(&study, task, watch)? {
                (Some(rows), part) => (rows, Some(part)),
                (None, part) => {
                    let all = study.count();
                    let cases = task.shard.cases(all).count();
                    return Ok(Computation::Partial { part, cases, all });
                }
            }
        }
    };
    let results = Box::new(study.results(rows, style)?);
    Ok(Computation::Complete(results, part))
}

/// The results of parts that were joined.
#[derive(Debug)]
pub struct Merged {
    /// The study.
    pub kind: StudyKind,
    /// The results of all cases.
    pub results: Results,
    /// Title of the scenario.
    pub title: Option<String>,
    /// Model of motion.
    pub model: &'static ModelKind,
    /// The scenario of the results, and its records.
    pub origin: Origin,
}

/// Joins the parts of a study. The scenario is `given`, or is read from the parts; a suite needs none, because its records
/// may have moved.
///
/// # Errors
/// When parts are missing, do not belong to one study or belong to a scenario other than the given one, or `style` refuses.
pub fn merge(
    parts: &[PathBuf],
    given: Option<&Scenario>,
    style: ChooseStyle<'_>,
) -> Result<Merged, StudyError> {
    let header = parts.first().map(|part| part::read_header(part));
    let header = header.transpose()?;
    let study = header.as_ref().map_or("", |header| &header.study);
    let kind = StudyKind::of_name(study).filter(|kind| kind.has_parts);
    let (Some(kind), Some(header)) = (kind, &header) else {
        return Err(StudyError::Scenario(format!(
            "unknown study {study:?}: merge with the version of archrock that wrote the parts"
        )));
    };
    let damaged = |_| {
        let message = "the parts are damaged, or of another version: compute them again";
        StudyError::scenario(message)
    };
    if kind == SUITE {
        let style = style(kind, None).map_err(StudyError::Scenario)?;
        let (header, rows) = part::merge(parts)?;
        let heading: Heading = serde_json::from_value(header.options).map_err(damaged)?;
        return Ok(Merged {
            kind,
            results: heading.report(rows, style.figure)?,
            title: heading.title.clone(),
            model: heading.model,
            origin: heading.origin().with_records(header.inputs),
        });
    }
    let scenario = match given {
        None => Scenario::parse(&header.scenario, "the scenario of the parts")?,
        Some(given) if given.to_toml() == header.scenario => given.clone(),
        Some(_) => {
            let message = "the parts are of another scenario than the one given";
            return Err(StudyError::scenario(message));
        }
    };
    let options: Option<Options> =
        serde_json::from_value(header.options.clone()).map_err(damaged)?;
    let style = style(kind, Some(&scenario)).map_err(StudyError::Scenario)?;
    let (scenarios, options) = (std::slice::from_ref(&scenario), options.unwrap_or_default());
    match kind.compute(
        scenarios,
        &options,
        style,
        RowSource::Merge(parts),
        Sinks::default(),
    )? {
        Computation::Complete(results, _) => Ok(Merged {
            kind,
            results: *results,
            title: scenario.title.clone(),
            model: scenario.motion.kind,
            origin: Origin::of(&scenario).with_records(header.inputs.clone()),
        }),
        Computation::Partial { .. } => unreachable!("all parts are joined"),
    }
}
