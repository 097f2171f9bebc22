//! Studies: computed in memory or in parts, their results as the files that the program writes.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use archrock::output::{Batch, Figure};
use archrock::studies::capacity::{capacity as capacities, report as report_capacity};
use archrock::studies::catalogue::{self as studies, Done, StudyError, StudyKind};
use archrock::studies::kept::Writer;
use archrock::studies::part::Shard;
use archrock::studies::results::Look;
use archrock::studies::runner::{Runner, Task};
use archrock::studies::threshold::along::AlongOptions;
use archrock::studies::threshold::{Factors, ThresholdError, check, tell, thresholds};
use archrock::studies::verify::{Check, tell as tell_check};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::io::Write as _;

use crate::error::{not_run, not_written, refused, unusable};
use crate::scenario::Scenario;
use crate::watched::watched;

/// The files of results with their names; the seal comes last.
type Files = Vec<(&'static str, Vec<u8>)>;

/// The same for Python.
type PyFiles<'py> = Vec<(&'static str, Bound<'py, PyBytes>)>;

fn to_python(py: Python<'_>, files: Files) -> PyFiles<'_> {
    let files = files.into_iter();
    files
        .map(|(name, contents)| (name, PyBytes::new(py, &contents)))
        .collect()
}

fn kind_of(name: &str) -> PyResult<StudyKind> {
    StudyKind::of_name(name).ok_or_else(|| {
        PyValueError::new_err(format!(
            "{name:?} is no study: give \"map\", \"suite\", \"uncertain\", \"uncertain_threshold\", \"uncertain_suite\" or \"uncertain_map\""
        ))
    })
}

fn failed(error: StudyError) -> PyErr {
    match error {
        StudyError::Scenario(message) => refused(message),
        StudyError::Read(error) => refused(error),
        StudyError::Runner(error) => not_run(error),
        StudyError::Part(error) => unusable(error),
        StudyError::Output(error) => not_written(error),
    }
}

/// The look of all results.
const LOOK: Look = Look::of(Figure::SCREEN);

/// A runner with this many threads, or with as many as there are processors.
fn runner(threads: Option<u16>) -> Runner {
    Runner {
        threads: threads.and_then(|count| NonZeroUsize::new(count.into())),
    }
}

/// Computes the study that a scenario describes, all in memory.
#[pyfunction]
pub fn study<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    kind: &str,
    threads: Option<u16>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PyFiles<'py>> {
    let (kind, runner) = (kind_of(kind)?, runner(threads));
    let scenario = Arc::clone(scenario.moving()?);
    let done = watched(py, progress, move |watch| {
        kind.compute(&scenario, LOOK, runner, None, watch)
            .map_err(failed)
    })?;
    match done {
        Done::Whole(results, _) => Ok(to_python(py, results.files)),
        Done::Part { .. } => unreachable!("what is computed in memory is no part"),
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
    let shard = shard.parse::<Shard>().map_err(refused)?;
    let scenario = Arc::clone(scenario.moving()?);
    let done = watched(py, progress, move |watch| {
        let task = Task {
            folder: &folder,
            shard,
            resume: true,
        };
        kind.compute(&scenario, LOOK, runner, Some(task), watch)
            .map_err(failed)
    })?;
    match done {
        Done::Part { part, .. } | Done::Whole(_, Some(part)) => Ok(part.path().to_owned()),
        Done::Whole(_, None) => unreachable!("what is computed in a folder is in a file"),
    }
}

/// Joins the parts of a study: returns its name and the files of its results. The scenario is needed only if its records
/// cannot be found from here.
#[pyfunction]
pub fn merge<'py>(
    py: Python<'py>,
    parts: Vec<PathBuf>,
    scenario: Option<&Scenario>,
) -> PyResult<(String, PyFiles<'py>)> {
    let scenario = scenario.map(|scenario| scenario.moving().map(Arc::clone));
    let scenario = scenario.transpose()?;
    if parts.is_empty() {
        return Err(PyValueError::new_err("no parts given"));
    }
    let (kind, results) = watched(py, None, move |_| {
        studies::merge(&parts, scenario.as_deref(), |_, _| Ok(LOOK))
        .map_err(failed)
    })?;
    Ok((kind.name().to_owned(), to_python(py, results.files)))
}

/// Finds the factors on the ground motion at which a scenario overturns.
#[pyfunction]
pub fn threshold<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    factors: (f64, f64, f64),
    threads: Option<u16>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PyFiles<'py>> {
    let (from, to, stride) = factors;
    let factors = Factors::new(from, to, stride).map_err(refused)?;
    let runner = runner(threads);
    check(scenario.moving()?).map_err(refused)?;
    let model = Arc::clone(scenario.model(py)?);
    let scenario = Arc::clone(scenario.moving()?);
    let files = watched(py, progress, move |watch| {
        let ground = scenario.ground_motion();
        let models = [(scenario.model_name(), &*model)];
        let request = scenario.request();
        let found = thresholds(&models, ground, &request, &factors, &runner, watch);
        let found = found.map_err(|error| match error {
            ThresholdError::Argument(error) => refused(error),
            ThresholdError::Runner(error) => not_run(error),
        })?;
        let results = tell(&[&scenario], &factors, &found, Figure::SCREEN).map_err(not_written)?;
        Ok(results.files)
    })?;
    Ok(to_python(py, files))
}

/// Finds the threshold for each value of a key.
#[pyfunction]
pub fn threshold_along<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    along: &str,
    no_impact: bool,
    factors: (f64, f64, f64),
    threads: Option<u16>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PyFiles<'py>> {
    let (from, to, stride) = factors;
    let options = AlongOptions {
        along: along.parse().map_err(refused)?,
        factors: Factors::new(from, to, stride).map_err(refused)?,
        no_impact,
    };
    let runner = runner(threads);
    let scenario = Arc::clone(scenario.moving()?);
    let done = watched(py, progress, move |watch| {
        studies::thresholds_along(&scenario, options, LOOK, runner, None, watch).map_err(failed)
    })?;
    match done {
        Done::Whole(results, _) => Ok(to_python(py, results.files)),
        Done::Part { .. } => unreachable!("what is computed in memory is no part"),
    }
}

/// The capacity curves of a scenario to both sides, as `archrock capacity`.
#[pyfunction]
pub fn capacity<'py>(py: Python<'py>, scenario: &Scenario) -> PyResult<PyFiles<'py>> {
    let scenario = Arc::clone(&scenario.inner);
    scenario.check_as_built().map_err(refused)?;
    let files = watched(py, None, move |_| {
        let sides = capacities(&scenario, None).map_err(refused)?;
        let results = report_capacity(&scenario, &sides, Figure::SCREEN).map_err(not_written)?;
        Ok(results.files)
    })?;
    Ok(to_python(py, files))
}

/// Checks the first mechanism of a scenario by the Circolare 7/2019, as `archrock verify`.
#[pyfunction]
pub fn verify<'py>(py: Python<'py>, scenario: &Scenario) -> PyResult<PyFiles<'py>> {
    let scenario = Arc::clone(scenario.moving()?);
    scenario.check_as_built().map_err(refused)?;
    let files = watched(py, None, move |_| {
        let check = Check::new(&scenario).map_err(refused)?;
        Ok(tell_check(&scenario, &check).map_err(not_written)?.files)
    })?;
    Ok(to_python(py, files))
}

/// Writes files into a folder: all of them, or none. They replace everything that the last run of the same command left there. Returns
/// warnings of results of other commands beside them that come from another scenario.
#[pyfunction]
pub fn save(
    py: Python<'_>,
    folder: PathBuf,
    files: Vec<(String, Vec<u8>)>,
) -> PyResult<Vec<String>> {
    py.detach(|| write(&folder, &files))
}

fn write(path: &Path, files: &[(String, Vec<u8>)]) -> PyResult<Vec<String>> {
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let batch = Batch::lock(path, true).map_err(not_written)?;
    let mut warnings = Vec::new();
    if let Some(writer) = names.last().and_then(|seal| Writer::of_seal(seal)) {
        batch.replace(writer.last_run(path));
        if let Some(origin) = writer.origin_in(files) {
            warnings = writer.warnings(path, &origin);
        }
    }
    let mut folder = batch.folder(path, &names).map_err(not_written)?;
    for (name, contents) in files {
        folder.file(name).write_all(contents)?;
    }
    folder.complete().map_err(not_written)?;
    batch.publish().map_err(not_written)?;
    Ok(warnings)
}
