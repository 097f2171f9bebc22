//! The list of all studies of a scenario. Each can be computed at once; those of many cases also in parts, which are merged.

use std::path::PathBuf;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::capacity::{self, capacity};
use super::ensemble::uncertain_map::CellsOfSamples;
use super::ensemble::uncertain_run::Histories;
use super::ensemble::uncertain_suite::Capacities;
use super::ensemble::uncertain_threshold::FirstEdges;
use super::limit;
use super::map::OverturningMap;
use super::part::{self, PartFile};
use super::quotable::free_hinges_instead;
use super::run::{self, RunOptions, Sinks};
use super::spread::{self, SpringingDirection};
use super::suite::{Heading, RecordSuite};
use super::threshold::along::{Along, AlongOptions};
use super::threshold::{self, Factors};
use super::{Results, Runner, Study, StudyError, Style, Task, Watch, verify};
use crate::output::{Figure, Origin};
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

/// The means with which a study is computed.
pub struct Work<'w> {
    /// The threads.
    pub runner: Runner,
    /// The task in a folder, where the work of many cases can be divided and resumed; `None`: it is done in memory.
    pub task: Option<Task<'w>>,
    /// Receives the progress, and can cancel the work.
    pub watch: Watch<'w>,
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

type ComputeModels =
    fn(&[Scenario], &Options, Figure, Work<'_>, Sinks<'_>) -> Result<Results, StudyError>;

/// Makes a study of many cases, or explains the change that the scenario needs.
type MakeStudy = for<'s> fn(&'s Scenario, &Options) -> Result<Box<dyn AnyStudy + 's>, String>;

/// The way from scenarios to results. The scenarios of a study differ only in their models of motion.
#[derive(Clone, Copy, Debug)]
enum Way {
    /// All models together, in a history or search for each.
    Models(ComputeModels),
    /// One model, without histories of its own cases.
    Whole(fn(&Scenario, &Options, Figure) -> Result<Results, StudyError>),
    /// One model and many cases, whose rows can be computed in parts.
    Cases(MakeStudy),
}

/// A study of many cases, whatever its rows are.
trait AnyStudy {
    fn compute(&self, style: Style, work: Work<'_>) -> Result<Computation, StudyError>;

    /// Makes the results of the rows in all parts.
    fn merge(&self, style: Style, parts: &[PathBuf]) -> Result<Results, StudyError>;

    /// Makes the results of rows given as JSON, in the order of the cases.
    fn results_of(&self, style: Style, rows: &[String]) -> Result<Results, StudyError>;
}

impl<S: Study> AnyStudy for S {
    fn compute(&self, style: Style, work: Work<'_>) -> Result<Computation, StudyError> {
        let Work {
            runner,
            task,
            watch,
        } = work;
        let (rows, part) = match task {
            None => (runner.rows(self, watch)?, None),
            // This arm leaves the code of parts out of the module for a browser.
            _ if cfg!(target_family = "wasm") => return Err(no_parts()),
            Some(task) => match runner.rows_in(self, task, watch)? {
                (Some(rows), part) => (rows, Some(part)),
                (None, part) => {
                    let all = self.count();
                    let cases = task.shard.cases(all).count();
                    return Ok(Computation::Partial { part, cases, all });
                }
            },
        };
        let results = Box::new(self.results(rows, style)?);
        Ok(Computation::Complete(results, part))
    }

    fn merge(&self, style: Style, parts: &[PathBuf]) -> Result<Results, StudyError> {
        match cfg!(target_family = "wasm") {
            true => Err(no_parts()),
            false => Ok(self.results(part::merge(parts)?.1, style)?),
        }
    }

    fn results_of(&self, style: Style, rows: &[String]) -> Result<Results, StudyError> {
        let rows = rows.iter().map(|row| serde_json::from_str(row));
        let rows = rows.collect::<Result<_, _>>().map_err(StudyError::failed)?;
        Ok(self.results(rows, style)?)
    }
}

fn no_parts() -> StudyError {
    StudyError::scenario("a browser keeps no parts of a study")
}

/// A study that a scenario describes.
#[derive(Clone, Copy, Debug)]
pub struct StudyKind {
    /// Its name.
    pub name: &'static str,
    /// The names of all files that its results may have, the seal last.
    pub files: &'static [&'static str],
    /// True if it writes its tables meanwhile, those of each model of motion into a folder of its own; options decide which of the files it writes.
    pub streams_tables: bool,
    /// True if its report includes that on the samples of `[uncertain]`.
    pub reports_samples: bool,
    /// True if the scenario needs a ground motion.
    pub needs_motion: bool,
    /// True if its words stand below the title of the scenario, indented; otherwise they are a table without a title.
    pub has_title: bool,
    /// True if it has the largest rotation of each case, by which models of motion are compared.
    pub has_rotations: bool,
    /// The study of the samples of `[uncertain]`; `None` without one.
    pub samples: Option<&'static Self>,
    way: Way,
}

impl PartialEq for StudyKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for StudyKind {}

/// The history of a scenario, with one or several models of motion.
pub const RUN: StudyKind = StudyKind {
    streams_tables: true,
    reports_samples: true,
    samples: Some(&UNCERTAIN),
    ..StudyKind::of(
        "run",
        &run::FILES,
        Way::Models(|scenarios, options, figure, work, sinks| {
            run::results(scenarios, &options.run, figure, sinks, work.watch)
        }),
    )
};
/// The map of the pulses that overturn the structure, over two quantities.
pub const MAP: StudyKind = StudyKind {
    samples: Some(&UNCERTAIN_MAP),
    ..StudyKind::of_cases::<OverturningMap<'_>>(|scenario, _| {
        Ok(Box::new(OverturningMap::of(scenario)?))
    })
};
/// The records that overturn the structure.
pub const SUITE: StudyKind = StudyKind {
    has_rotations: true,
    samples: Some(&UNCERTAIN_SUITE),
    ..StudyKind::of_cases::<RecordSuite<'_>>(|scenario, _| Ok(Box::new(RecordSuite::of(scenario)?)))
};
/// The factors by which the ground motion overturns the structure, for one or several models of motion.
pub const THRESHOLD: StudyKind = StudyKind {
    samples: Some(&UNCERTAIN_THRESHOLD),
    ..StudyKind::of(
        "threshold",
        &threshold::FILES,
        Way::Models(|scenarios, options, figure, work, _| {
            let factors = &options.factors;
            threshold::results(scenarios, factors, figure, &work.runner, work.watch)
        }),
    )
};
/// The threshold for each value of a key along a range.
pub const THRESHOLD_ALONG: StudyKind = StudyKind::of_cases::<Along<'_>>(|scenario, options| {
    let along = options.along.clone();
    let along = along.ok_or("a threshold along a range needs its key and its values")?;
    Ok(Box::new(Along::of(scenario, along)?))
});
/// The push that starts the structure, and its mechanism.
pub const LIMIT: StudyKind = StudyKind {
    needs_motion: false,
    ..StudyKind::whole("limit", &limit::FILES, |scenario, _, figure| {
        limit::results(scenario, figure)
    })
};
/// The capacity curves of the first mechanism.
pub const CAPACITY: StudyKind = StudyKind {
    needs_motion: false,
    ..StudyKind::whole("capacity", &capacity::FILES, |scenario, options, figure| {
        scenario.check_as_built().map_err(StudyError::Scenario)?;
        let sides = capacity(scenario, options.point_m).map_err(StudyError::scenario)?;
        Ok(capacity::report(scenario, &sides, figure)?)
    })
};
/// The movement of a springing at which the arch falls.
pub const SPREAD: StudyKind = StudyKind {
    needs_motion: false,
    ..StudyKind::whole("spread", &spread::FILES, |scenario, options, figure| {
        let found = spread::spread(scenario, &options.directions)?;
        spread::report(scenario, &found, figure)
    })
};
/// The check of the first mechanism by the Circolare 7/2019.
pub const VERIFY: StudyKind = StudyKind {
    needs_motion: false,
    ..StudyKind::whole("verify", &verify::FILES, |scenario, _, _| {
        scenario.check_as_built().map_err(StudyError::Scenario)?;
        if scenario.right_foot.is_some() {
            let message =
                "`verify` applies one ground motion to both feet: leave [ground.right] out";
            return Err(StudyError::scenario(message));
        }
        let check = verify::verify(scenario).map_err(StudyError::scenario)?;
        Ok(verify::report(scenario, &check)?)
    })
};
/// Endings and courses of histories for samples of the uncertain numbers.
pub const UNCERTAIN: StudyKind = StudyKind {
    has_rotations: true,
    ..StudyKind::of_cases::<Histories<'_>>(|scenario, _| Ok(Box::new(Histories::of(scenario)?)))
};
/// The factor from which samples of the uncertain numbers overturn.
pub const UNCERTAIN_THRESHOLD: StudyKind =
    StudyKind::of_cases::<FirstEdges<'_>>(|scenario, options| {
        Ok(Box::new(FirstEdges::of(scenario, options.factors)?))
    });
/// The records that overturn samples of the uncertain numbers.
pub const UNCERTAIN_SUITE: StudyKind =
    StudyKind::of_cases::<Capacities<'_>>(|scenario, _| Ok(Box::new(Capacities::of(scenario)?)));
/// The probability that pulses overturn samples of the uncertain numbers, over two quantities.
pub const UNCERTAIN_MAP: StudyKind = StudyKind::of_cases::<CellsOfSamples<'_>>(|scenario, _| {
    Ok(Box::new(CellsOfSamples::of(scenario)?))
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

    const fn of(name: &'static str, files: &'static [&'static str], way: Way) -> Self {
        Self {
            name,
            files,
            streams_tables: false,
            reports_samples: false,
            needs_motion: true,
            has_title: true,
            has_rotations: false,
            samples: None,
            way,
        }
    }

    const fn of_cases<S: Study>(study: MakeStudy) -> Self {
        Self::of(S::NAME, S::FILES, Way::Cases(study))
    }

    const fn whole(
        name: &'static str,
        files: &'static [&'static str],
        results: fn(&Scenario, &Options, Figure) -> Result<Results, StudyError>,
    ) -> Self {
        Self {
            has_title: false,
            ..Self::of(name, files, Way::Whole(results))
        }
    }

    /// True if its rows are kept in a file, so the work can be divided and resumed.
    pub const fn has_parts(self) -> bool {
        matches!(self.way, Way::Cases(_))
    }

    /// True if it computes scenarios that differ in their models of motion together; otherwise each alone.
    pub const fn takes_models(self) -> bool {
        matches!(self.way, Way::Models(_))
    }

    /// Computes the study of scenarios that differ only in their models of motion; of several, most studies compute the first. A run writes its
    /// tables into the sinks.
    ///
    /// # Errors
    /// When the scenario does not describe the study, or its rows could not be completed.
    pub fn compute(
        self,
        scenarios: &[Scenario],
        options: &Options,
        style: Style,
        work: Work<'_>,
        sinks: Sinks<'_>,
    ) -> Result<Computation, StudyError> {
        let (scenario, figure) = (&scenarios[0], style.figure);
        if self != LIMIT {
            let fits = scenario.check_without_live_loads();
            fits.map_err(StudyError::Scenario)?;
        }
        let complete = |results| Computation::Complete(Box::new(results), None);
        let mut done = match self.way {
            Way::Models(results) => results(scenarios, options, figure, work, sinks).map(complete),
            Way::Whole(results) => results(scenario, options, figure).map(complete),
            Way::Cases(_) => self.study(scenario, options)?.compute(style, work),
        }?;
        if let (Computation::Complete(results, _), [_]) = (&mut done, scenarios) {
            let next = &mut results.statement.next;
            *next = next.take().or_else(|| self.with_free_hinges(scenario));
        }
        Ok(done)
    }

    /// The command of this study with free hinges, which answer where four links are a guide; `None` for other models and for a run, which has its own.
    fn with_free_hinges(self, scenario: &Scenario) -> Option<String> {
        let is_command = [MAP, SUITE, THRESHOLD].contains(&self);
        let options = free_hinges_instead(scenario).filter(|_| is_command)?;
        Some(format!("{} FILE {options}", self.name))
    }

    /// Makes the results of rows given as JSON, in the order of the cases.
    ///
    /// # Errors
    /// When the scenario does not describe the study, the study has no cases, or the rows are not its own.
    pub fn results_of(
        self,
        scenario: &Scenario,
        options: &Options,
        style: Style,
        rows: &[String],
    ) -> Result<Results, StudyError> {
        self.study(scenario, options)?.results_of(style, rows)
    }

    /// Makes the study of many cases.
    fn study<'s>(
        self,
        scenario: &'s Scenario,
        options: &Options,
    ) -> Result<Box<dyn AnyStudy + 's>, StudyError> {
        match self.way {
            Way::Cases(study) => study(scenario, options).map_err(StudyError::Scenario),
            _ => Err(StudyError::scenario(format!(
                "`{}` has no cases",
                self.name
            ))),
        }
    }
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
    let kind = StudyKind::of_name(study).filter(|kind| kind.has_parts());
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
    let study = kind.study(&scenario, &options.unwrap_or_default())?;
    let results = study.merge(style, parts)?;
    Ok(Merged {
        kind,
        results,
        title: scenario.title.clone(),
        model: scenario.motion.kind,
        origin: Origin::of(&scenario).with_records(header.inputs.clone()),
    })
}
