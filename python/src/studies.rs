//! Studies: computed in memory or in parts, their results as the files that the program writes.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::slice;
use std::sync::Arc;

use archrock::output::{Figure, Folder, Origin};
use archrock::studies;
use archrock::studies::run::Sinks;
use archrock::studies::threshold::{AlongOptions, Factors};
use archrock::studies::{
    Computation, Options, Results, Runner, Shard, StudyError, StudyKind, Style, Task, Work,
};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::{not_run, not_written, refused_value, unusable_part};
use crate::scenario::Scenario;
use crate::watched::watch_work;

/// The files of results with their names; the seal comes last.
type Files<'py> = Vec<(&'static str, Bound<'py, PyBytes>)>;

/// The columns with text of each table, by the name of its file.
type TextColumns = Vec<(String, Vec<String>)>;

fn to_python(py: Python<'_>, results: Results) -> (Files<'_>, TextColumns, String) {
    let answer = results.statement.answer(true);
    let texts = results
        .text_columns()
        .map(|(name, columns)| (name.to_owned(), columns.to_vec()))
        .collect();
    let files = results
        .files
        .into_iter()
        .map(|(name, contents)| (name, PyBytes::new(py, &contents)));
    (files.collect(), texts, answer)
}

fn kind_of(name: &str) -> PyResult<StudyKind> {
    StudyKind::of_name(name).ok_or_else(|| {
        let names = StudyKind::ALL.map(|kind| kind.name).join(", ");
        PyValueError::new_err(format!("{name:?} is no study: give one of {names}"))
    })
}

pub fn failed(error: StudyError) -> PyErr {
    match error {
        StudyError::Scenario(message) => refused_value(message),
        StudyError::Read(error) => refused_value(error),
        StudyError::Runner(error) => not_run(error),
        StudyError::Part(error) => unusable_part(error),
        StudyError::Output(error) => not_written(error),
        _ => PyRuntimeError::new_err(error.to_string()),
    }
}

/// The look of all results.
const STYLE: Style = Style::of(Figure::SCREEN);

/// A runner with this many threads, or with as many as there are processors.
fn runner(threads: Option<u16>) -> Runner {
    Runner {
        threads: threads.and_then(|count| NonZeroUsize::new(count.into())),
    }
}

/// Computes a study, or a shard of it into a file in a folder, where an interrupted computation continues.
fn compute(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    kind: StudyKind,
    scenario: &Arc<archrock::Scenario>,
    options: Options,
    (runner, part): (Runner, Option<(Shard, PathBuf)>),
) -> PyResult<Computation> {
    let scenario = Arc::clone(scenario);
    watch_work(py, progress, move |watch| {
        let task = part.as_ref().map(|(shard, folder)| Task {
            folder,
            shard: *shard,
            resume: true,
        });
        let work = Work {
            runner,
            task,
            watch,
        };
        let (scenarios, sinks) = (slice::from_ref(&*scenario), Sinks::default());
        kind.compute(scenarios, &options, STYLE, work, sinks)
            .map_err(failed)
    })
}

/// Computes a study of a scenario, all in memory. Returns its files, their origin as JSON, the columns with text, and the answer in words. `factors` are
/// those of a threshold, and `along` its range and whether impacts are left out.
#[pyfunction]
pub fn study<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    kind: &str,
    factors: Option<(Option<f64>, Option<f64>, f64)>,
    along: Option<(String, bool)>,
    threads: Option<u16>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Files<'py>, String, TextColumns, String)> {
    let (kind, runner) = (kind_of(kind)?, runner(threads));
    let factors = factors.map(|(from, to, stride)| Factors::new(from, to, stride));
    let factors = factors
        .transpose()
        .map_err(refused_value)?
        .unwrap_or_default();
    let along = along.map(|(along, no_impact)| {
        Ok::<_, &str>(AlongOptions {
            along: along.parse()?,
            factors,
            no_impact,
        })
    });
    let options = Options {
        factors,
        along: along.transpose().map_err(refused_value)?,
        ..Options::default()
    };
    // Statics need no motion.
    let scenario = match kind.needs_motion {
        true => scenario.moving()?,
        false => &scenario.inner,
    };
    let done = compute(py, progress, kind, scenario, options, (runner, None))?;
    match done {
        Computation::Complete(results, _) => {
            let (files, texts, answer) = to_python(py, *results);
            Ok((files, to_json(&Origin::of(scenario))?, texts, answer))
        }
        Computation::Partial { .. } => unreachable!("a computation in memory is no part"),
    }
}

/// Computes a shard of a study into a part file, or continues it, and returns the path of the file.
#[pyfunction]
pub fn compute_part(
    py: Python<'_>,
    scenario: &Scenario,
    kind: &str,
    shard: &str,
    folder: PathBuf,
    threads: Option<u16>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PathBuf> {
    let (kind, runner) = (kind_of(kind)?, runner(threads));
    if !kind.has_parts() {
        return Err(refused_value(format!("{:?} has no parts", kind.name)));
    }
    let shard = shard.parse::<Shard>().map_err(refused_value)?;
    let part = (runner, Some((shard, folder)));
    let options = Options::default();
    let done = compute(py, progress, kind, scenario.moving()?, options, part)?;
    match done {
        Computation::Partial { part, .. } | Computation::Complete(_, Some(part)) => {
            Ok(part.path().to_owned())
        }
        Computation::Complete(_, None) => unreachable!("a study with parts has a file"),
    }
}

/// Joins the parts of a study: returns its name, the files of its results, their origin as JSON, the columns with text, and the answer in words. The
/// scenario is needed only if its records cannot be found from here.
#[pyfunction]
pub fn merge<'py>(
    py: Python<'py>,
    parts: Vec<PathBuf>,
    scenario: Option<&Scenario>,
) -> PyResult<(String, Files<'py>, String, TextColumns, String)> {
    let scenario = scenario
        .map(|scenario| scenario.moving().map(Arc::clone))
        .transpose()?;
    if parts.is_empty() {
        return Err(PyValueError::new_err("no parts given"));
    }
    let merged = watch_work(py, None, move |_| {
        studies::merge(&parts, scenario.as_deref(), &mut |_, _| Ok(STYLE)).map_err(failed)
    })?;
    let (files, texts, answer) = to_python(py, merged.results);
    let (name, origin) = (merged.kind.name.to_owned(), to_json(&merged.origin)?);
    Ok((name, files, origin, texts, answer))
}

fn to_json(origin: &Origin) -> PyResult<String> {
    serde_json::to_string(origin).map_err(refused_value)
}

/// Writes files of this origin into a folder: all of them, or none. They replace everything that the last run of the same command left there. Returns
/// warnings of results of other commands beside them that come from another scenario.
#[pyfunction]
pub fn save(
    py: Python<'_>,
    folder: PathBuf,
    files: Vec<(String, Vec<u8>)>,
    origin: &str,
) -> PyResult<Vec<String>> {
    let origin = serde_json::from_str(origin).map_err(refused_value)?;
    py.detach(|| write(&folder, &files, origin))
}

fn write(path: &Path, files: &[(String, Vec<u8>)], origin: Origin) -> PyResult<Vec<String>> {
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let command = StudyKind::of_files(&names).map_or("python", |kind| kind.name);
    let folder = Folder::lock(path, command, origin, true).map_err(not_written)?;
    let warnings = folder.warnings();
    for (name, contents) in files {
        folder.write(name, contents).map_err(not_written)?;
    }
    folder.publish().map_err(not_written)?;
    Ok(warnings)
}
