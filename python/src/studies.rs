//! Studies: computed in memory or in parts, their results as the files that the program writes.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use archrock::output::suite::Heading;
use archrock::output::{self, Figure, Folder};
use archrock::scenario::Structure;
use archrock::studies::boundary::{MapRow, MapWithBoundary};
use archrock::studies::map::OverturningMap;
use archrock::studies::part::{self, Shard};
use archrock::studies::runner::{Computed, Runner, Study, Task};
use archrock::studies::spectrum::{OverturningSpectrum, PointRow};
use archrock::studies::suite::{CaseRow, RecordSuite, SuiteFragility};
use archrock::studies::threshold::{Factors, ThresholdError, thresholds};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::Value;
use std::io::Write as _;

use crate::error::{not_run, not_written, refused, unusable};
use crate::scenario::Scenario;
use crate::watched::{Watch, watched};

/// The files of results, by their names, the last one last.
type Files = Vec<(&'static str, Vec<u8>)>;

/// The same for Python.
type PyFiles<'py> = Vec<(&'static str, Bound<'py, PyBytes>)>;

fn to_python(py: Python<'_>, files: Files) -> PyFiles<'_> {
    let files = files.into_iter();
    files
        .map(|(name, contents)| (name, PyBytes::new(py, &contents)))
        .collect()
}

/// A study that a scenario describes.
#[derive(Clone, Copy)]
enum Kind {
    Map,
    Spectrum,
    Suite,
}

impl Kind {
    fn of(name: &str) -> PyResult<Self> {
        match name {
            MapWithBoundary::NAME => Ok(Self::Map),
            OverturningSpectrum::NAME => Ok(Self::Spectrum),
            RecordSuite::NAME => Ok(Self::Suite),
            other => Err(PyValueError::new_err(format!(
                "{other:?} is no study: give \"map\", \"spectrum\" or \"suite\""
            ))),
        }
    }
}

/// Where rows go.
enum Place {
    /// All into memory.
    Memory,
    /// Those of a shard into the file of a part.
    Part { folder: PathBuf, shard: Shard },
}

/// What was computed.
enum Done {
    Files(Files),
    Part(PathBuf),
}

/// Computes a study, and makes files of its rows if they are all there.
fn compute<S: Study>(
    study: &S,
    place: &Place,
    runner: Runner,
    watch: &mut Watch<'_>,
    files: impl FnOnce(Vec<S::Row>) -> PyResult<Files>,
) -> PyResult<Done> {
    match place {
        Place::Memory => {
            let rows = runner.rows(study, watch).map_err(not_run)?;
            files(rows).map(Done::Files)
        }
        Place::Part { folder, shard } => {
            let task = Task {
                folder,
                shard: *shard,
                resume: true,
            };
            let computed = runner.rows_in(study, task, watch).map_err(not_run)?;
            let (Computed::Whole(_, part) | Computed::Shard(part)) = computed;
            Ok(Done::Part(part.path().to_owned()))
        }
    }
}

fn compute_kind(
    scenario: &archrock::Scenario,
    kind: Kind,
    place: &Place,
    runner: Runner,
    watch: &mut Watch<'_>,
) -> PyResult<Done> {
    if scenario.initial.is_some() {
        return Err(PyValueError::new_err(
            "the histories of a study start from rest: leave [initial] out",
        ));
    }
    match kind {
        Kind::Map => {
            let map = map_of(scenario)?;
            let study = MapWithBoundary::new(&map);
            compute(&study, place, runner, watch, |rows| map_files(&map, rows))
        }
        Kind::Spectrum => {
            let spectrum = OverturningSpectrum::new(scenario).map_err(refused)?;
            compute(&spectrum, place, runner, watch, |rows| {
                spectrum_files(&spectrum, scenario, &rows)
            })
        }
        Kind::Suite => {
            let Some(suite) = &scenario.suite else {
                return Err(lacks("[suite]"));
            };
            let study = RecordSuite::new(scenario, suite).map_err(refused)?;
            let heading = Heading::of(scenario, suite);
            compute(&study, place, runner, watch, |rows| {
                suite_files(&heading, rows)
            })
        }
    }
}

fn lacks(table: &str) -> PyErr {
    PyValueError::new_err(format!("the scenario has no {table}"))
}

fn map_of(scenario: &archrock::Scenario) -> PyResult<OverturningMap<'_>> {
    let map = OverturningMap::new(scenario).ok_or_else(|| lacks("[map]"))?;
    match map.fault() {
        None => Ok(map),
        Some(fault) => Err(refused(format!("no cell of [map] has a scenario: {fault}"))),
    }
}

fn pretty(value: &Value) -> Vec<u8> {
    output::pretty(value).into_bytes()
}

fn map_files(map: &OverturningMap<'_>, rows: Vec<MapRow>) -> PyResult<Files> {
    use output::map as written;
    let scenario = map.scenario();
    let (cells, boundaries) = MapRow::sorted(rows);
    let title = scenario.title.as_deref().unwrap_or("Overturning map");
    let look = written::Look::of(Figure::SCREEN);
    let picture = written::draw(title, map, &cells, &boundaries, look);
    let remarks = written::remarks(map, &cells, &boundaries);
    let summary = output::results::study_summary(scenario, cells.len(), &remarks);
    let mut files = Vec::new();
    if MapWithBoundary::new(map).has_boundary() {
        let mut boundary = Vec::new();
        written::write_boundaries(&mut boundary, map.axes()[0], &boundaries)
            .map_err(not_written)?;
        files.push(("no_impact.csv", boundary));
    }
    let mut table = Vec::new();
    written::write_table(&mut table, map, &cells).map_err(not_written)?;
    let page = output::map_page::page(title, map, &cells, &boundaries, look);
    files.extend([
        ("map.svg", picture.into_bytes()),
        ("map.html", page.into_bytes()),
        ("map.json", pretty(&summary)),
        ("map.csv", table),
    ]);
    Ok(files)
}

fn spectrum_files(
    spectrum: &OverturningSpectrum<'_>,
    scenario: &archrock::Scenario,
    rows: &[PointRow],
) -> PyResult<Files> {
    use output::spectrum as written;
    let title = scenario.title.as_deref().unwrap_or("Overturning spectrum");
    let picture = written::draw(Figure::SCREEN, title, spectrum, rows);
    let remarks = written::remarks(rows);
    let summary = output::results::study_summary(scenario, rows.len(), &remarks);
    let mut table = Vec::new();
    written::write_table(&mut table, rows).map_err(not_written)?;
    Ok(vec![
        ("spectrum.svg", picture.into_bytes()),
        ("spectrum.json", pretty(&summary)),
        ("spectrum.csv", table),
    ])
}

fn suite_files(heading: &Heading, rows: Vec<CaseRow>) -> PyResult<Files> {
    use output::suite as written;
    let results = SuiteFragility::new(heading.measure, rows);
    let mut levels = Vec::new();
    written::write_fragility(&mut levels, heading, &results).map_err(not_written)?;
    let json = written::to_json(heading, &results).map_err(not_written)?;
    let picture = written::draw(Figure::SCREEN, heading, &results);
    let curves = output::ida::draw(Figure::SCREEN, heading, &results);
    let mut table = Vec::new();
    written::write_table(&mut table, heading, &results.cases).map_err(not_written)?;
    Ok(vec![
        ("suite.svg", picture.into_bytes()),
        ("ida.svg", curves.into_bytes()),
        ("fragility.csv", levels),
        ("fragility.json", pretty(&json)),
        ("suite.csv", table),
    ])
}

/// On so many threads, or on all processors.
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
    let (kind, runner) = (Kind::of(kind)?, runner(threads));
    let scenario = Arc::clone(&scenario.inner);
    let done = watched(py, progress, move |watch| {
        compute_kind(&scenario, kind, &Place::Memory, runner, watch)
    })?;
    match done {
        Done::Files(files) => Ok(to_python(py, files)),
        Done::Part(_) => unreachable!("what is computed in memory is no part"),
    }
}

/// Computes a shard of a study into the file of a part, or goes on with it, and returns the path of that.
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
    let (kind, runner) = (Kind::of(kind)?, runner(threads));
    let shard = shard.parse::<Shard>().map_err(refused)?;
    let scenario = Arc::clone(&scenario.inner);
    let done = watched(py, progress, move |watch| {
        compute_kind(
            &scenario,
            kind,
            &Place::Part { folder, shard },
            runner,
            watch,
        )
    })?;
    match done {
        Done::Part(path) => Ok(path),
        Done::Files(_) => unreachable!("what is computed in a folder is a part"),
    }
}

/// Joins the parts of a study: its name and the files of its results. The scenario need only be given where its records
/// are not found from here.
#[pyfunction]
pub fn merge<'py>(
    py: Python<'py>,
    parts: Vec<PathBuf>,
    scenario: Option<&Scenario>,
) -> PyResult<(String, PyFiles<'py>)> {
    let scenario = scenario.map(|scenario| Arc::clone(&scenario.inner));
    let (study, files) = watched(py, None, move |_| merged(&parts, scenario))?;
    Ok((study, to_python(py, files)))
}

fn merged(parts: &[PathBuf], given: Option<Arc<archrock::Scenario>>) -> PyResult<(String, Files)> {
    let Some(first) = parts.first() else {
        return Err(PyValueError::new_err("no parts given"));
    };
    let study = part::read_header(first).map_err(unusable)?.study;
    let read = |text: &str| match &given {
        None => archrock::Scenario::parse(text, "the scenario of the parts")
            .map(Arc::new)
            .map_err(refused),
        Some(given) if given.to_toml() == text => Ok(Arc::clone(given)),
        Some(_) => Err(refused(
            "the parts are of another scenario than the one given",
        )),
    };
    let files = match Kind::of(&study)? {
        Kind::Map => {
            let (header, rows) = part::merge(parts).map_err(unusable)?;
            let scenario = read(&header.scenario)?;
            map_files(&map_of(&scenario)?, rows)?
        }
        Kind::Spectrum => {
            let (header, rows) = part::merge::<PointRow>(parts).map_err(unusable)?;
            let scenario = read(&header.scenario)?;
            let spectrum = OverturningSpectrum::new(&scenario).map_err(refused)?;
            spectrum_files(&spectrum, &scenario, &rows)?
        }
        Kind::Suite => {
            // Its records may be elsewhere.
            let (header, rows) = part::merge(parts).map_err(unusable)?;
            let heading = Heading::of_resolved(&header.scenario).ok_or_else(|| {
                refused("the scenario of the parts is damaged: compute them again")
            })?;
            suite_files(&heading, rows)?
        }
    };
    Ok((study, files))
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
    if scenario.inner.initial.is_some() {
        return Err(refused(
            "the histories of a threshold start from rest: leave [initial] out",
        ));
    }
    if scenario.inner.ground.is_none() {
        return Err(refused("a threshold needs a ground motion"));
    }
    let standing = scenario.standing(py)?.clone();
    let scenario = Arc::clone(&scenario.inner);
    let files = watched(py, progress, move |watch| {
        use output::threshold as written;
        let name = match (&scenario.free_hinges, &scenario.structure) {
            (Some(_), _) => "free_hinges",
            (None, Structure::Arch(_) | Structure::Masonry(_)) => "four_links",
            (None, Structure::Column(_)) => "column",
        };
        let ground = scenario.ground_motion();
        let models = [(name, standing.model())];
        let request = scenario.request();
        let found = thresholds(&models, ground, &request, &factors, &runner, watch);
        let found = found.map_err(|error| match error {
            ThresholdError::Argument(error) => refused(error),
            ThresholdError::Runner(error) => not_run(error),
        })?;
        let json = written::to_json(&[&scenario], ground, &factors, &found).map_err(not_written)?;
        let title = scenario
            .title
            .as_deref()
            .unwrap_or("Threshold of overturning");
        let peak_g = written::peak_g(&scenario, ground);
        let picture = written::draw(Figure::SCREEN, title, peak_g, &factors, &found);
        let mut table = Vec::new();
        written::write_table(&mut table, &found).map_err(not_written)?;
        Ok(vec![
            ("threshold.svg", picture.into_bytes()),
            ("threshold.csv", table),
            ("threshold.json", pretty(&json)),
        ])
    })?;
    Ok(to_python(py, files))
}

/// Writes files into a folder: all of them, or none.
#[pyfunction]
pub fn save(py: Python<'_>, folder: PathBuf, files: Vec<(String, Vec<u8>)>) -> PyResult<()> {
    py.detach(|| write(&folder, &files))
}

fn write(folder: &Path, files: &[(String, Vec<u8>)]) -> PyResult<()> {
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let mut folder = Folder::open(folder, &names).map_err(not_written)?;
    for (name, contents) in files {
        folder.file(name).write_all(contents)?;
    }
    folder.complete().map_err(not_written)
}
