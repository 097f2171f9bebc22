//! Scenarios and ground motions, read from text.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use archrock::scenario::{
    Assignment, FileContents, MODELS, ModelKind, ReadOptions, ScenarioErrors, Source,
};
use archrock::studies::{impact_chain, limit};
use archrock::{GroundMotion, MechanismModel, Model, Sway};
use numpy::{PyArray1, PyArrayMethods as _, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::json;

use crate::error::{errors_in_words, refused_value};

/// Files of a scenario that are held in memory, by the names that the scenario uses.
pub type Files<'py> = BTreeMap<String, Held<'py>>;

/// Contents of a file, or samples in its place.
#[derive(FromPyObject)]
pub enum Held<'py> {
    /// Samples of a record: a column of times and one of values.
    Samples {
        /// The columns.
        table: PyReadonlyArray2<'py, f64>,
    },
    /// The contents of a file.
    File(Vec<u8>),
}

impl From<Held<'_>> for FileContents {
    fn from(held: Held<'_>) -> Self {
        match held {
            Held::File(bytes) => Self::Bytes(bytes),
            Held::Samples { table } => {
                let table = table.as_array();
                let rows = table.rows().into_iter();
                let pair =
                    |row: numpy::ndarray::ArrayView1<'_, f64>| Some((*row.get(0)?, *row.get(1)?));
                Self::Samples(rows.filter_map(pair).collect())
            }
        }
    }
}

/// Contents of a file with these samples.
#[pyfunction]
pub fn file_of<'py>(py: Python<'py>, samples: Held<'py>) -> Bound<'py, PyBytes> {
    let contents = FileContents::from(samples);
    PyBytes::new(py, &contents.bytes())
}

/// The text of a scenario, and the place of its files.
struct Text {
    source: Source,
    /// Whether a person wrote the text and can look up a line in it.
    placed: bool,
}

impl Text {
    /// A text; `name` stands for its file. If files come with it, it reads no others.
    fn new(text: &str, name: Option<&str>, files: Files<'_>) -> PyResult<Self> {
        let placed = name.is_some();
        let source = Source::of_text(text, name.unwrap_or("the arguments"));
        if files.is_empty() {
            return Ok(Self { source, placed });
        }
        for file in files.keys() {
            let plain = Path::new(file)
                .components()
                .all(|part| matches!(part, Component::Normal(_)));
            if file.is_empty() || !plain {
                return Err(PyValueError::new_err(format!(
                    "{file:?} is no name of a file in a folder: leave out `..` and what makes it absolute"
                )));
            }
        }
        let files = files.into_iter();
        let source = source.with_files(files.map(|(name, held)| (PathBuf::from(name), held)));
        Ok(Self { source, placed })
    }

    /// Reads the text with the library's reader.
    fn read<T>(
        &self,
        read: impl FnOnce(&Source) -> Result<T, ScenarioErrors>,
    ) -> Result<T, String> {
        read(&self.source).map_err(|errors| errors_in_words(&errors, self.placed))
    }
}

/// A scenario, with every default filled in.
#[pyclass(frozen, module = "archrock._native")]
pub struct Scenario {
    /// It may be complete enough for statics alone: see [`Scenario::moving`].
    pub inner: Arc<archrock::Scenario>,
    /// Why the structure cannot be simulated: the errors of the reader, if they do not concern statics.
    unmovable: Option<String>,
    /// Its model of motion, built when first needed.
    model: OnceLock<Result<Arc<dyn Model>, String>>,
}

impl Scenario {
    pub fn new(inner: Arc<archrock::Scenario>) -> Self {
        Self {
            inner,
            unmovable: None,
            model: OnceLock::new(),
        }
    }

    /// The scenario for a computation that moves the structure: its ground motion and its model of motion were read.
    pub fn moving(&self) -> PyResult<&Arc<archrock::Scenario>> {
        match &self.unmovable {
            Some(errors) => Err(refused_value(errors)),
            None => Ok(&self.inner),
        }
    }

    /// Its model of motion.
    pub fn model(&self, py: Python<'_>) -> PyResult<&Arc<dyn Model>> {
        let make = || match self.inner.model() {
            Ok(model) => Ok(model.into()),
            Err(error) => Err(error.to_string()),
        };
        let model = match self.model.get() {
            Some(model) => model,
            None => py.detach(|| self.model.get_or_init(make)),
        };
        model.as_ref().map_err(refused_value)
    }

    /// Applies `read` to the scenario's mechanisms, even if the scenario uses another model.
    fn read_mechanisms<T: Send>(
        &self,
        py: Python<'_>,
        read: impl FnOnce(&dyn MechanismModel) -> T + Send,
    ) -> PyResult<T> {
        let has_mechanism = self.inner.motion.kind.has_mechanism;
        let own = has_mechanism.then(|| self.model(py)).transpose()?;
        py.detach(|| match own.and_then(|model| model.as_mechanisms()) {
            Some(model) => Ok(read(model)),
            None => Ok(read(
                &*self.inner.mechanisms().map_err(|error| error.to_string())?,
            )),
        })
        .map_err(|error: String| refused_value(error))
    }
}

fn model_kind(model: Option<&str>) -> PyResult<Option<&'static ModelKind>> {
    let Some(name) = model else {
        return Ok(None);
    };
    let mut known = MODELS.into_iter();
    let found = known.find(|model| [model.name, model.option].contains(&name));
    found.map(Some).ok_or_else(|| {
        let names = MODELS.map(|model| model.name).join(", ");
        PyValueError::new_err(format!("`model = {name:?}` is not one of {names}"))
    })
}

#[pymethods]
impl Scenario {
    /// Reads the text of a scenario, with the files that it names. Without such files, they are read from the folder of `name`.
    ///
    /// Errors that do not concern statics are kept until the structure is simulated. `unmovable` are those of an earlier reading of the
    /// scenario.
    #[new]
    #[pyo3(signature = (text, name, files, model, changes, unmovable=None))]
    fn read(
        py: Python<'_>,
        text: &str,
        name: Option<&str>,
        files: Files<'_>,
        model: Option<&str>,
        changes: Vec<String>,
        unmovable: Option<String>,
    ) -> PyResult<Self> {
        let model = model_kind(model)?;
        let set = changes
            .iter()
            .map(|change| change.parse::<Assignment>())
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused_value)?;
        let text = Text::new(text, name, files)?;
        let read = |statics: bool| {
            let changes = ReadOptions {
                model,
                set: &set,
                statics,
            };
            text.read(|source| archrock::Scenario::of(source, &changes))
        };
        let (inner, unmovable) = py
            .detach(|| match unmovable {
                Some(errors) => Ok((read(true)?, Some(errors))),
                None => match read(false) {
                    Ok(scenario) => Ok((scenario, None)),
                    Err(errors) => match read(true) {
                        Ok(scenario) => Ok((scenario, Some(errors))),
                        Err(_) => Err(errors),
                    },
                },
            })
            .map_err(refused_value)?;
        Ok(Self {
            unmovable,
            ..Self::new(Arc::new(inner))
        })
    }

    /// Why the structure cannot be simulated; `None` if it can.
    fn unmovable(&self) -> Option<&str> {
        self.unmovable.as_deref()
    }

    /// The scenario as TOML text.
    fn to_toml(&self) -> String {
        self.inner.to_toml()
    }

    /// The scenario as JSON.
    fn to_json(&self) -> String {
        self.inner.to_json().to_string()
    }

    /// The structure that stands on the ground, with its ties, as JSON with the dimensions that were given.
    fn structure_json(&self) -> PyResult<String> {
        let structure = serde_json::to_value(&self.inner.structure).map_err(refused_value)?;
        let mut all = self.inner.to_json();
        if let Some(all) = all.as_object_mut() {
            let is_beside = |table: &str| ["load", "tie"].contains(&table);
            all.retain(|table, _| is_beside(table) || structure.get(table).is_some());
        }
        Ok(all.to_string())
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.inner == other.inner && self.unmovable == other.unmovable
    }

    /// Largest memory that the samples of its history take, in bytes.
    fn memory_bytes(&self, py: Python<'_>) -> PyResult<u64> {
        self.moving()?;
        let (ground, request) = (self.inner.ground_motion(), self.inner.request());
        Ok(self.model(py)?.sample_bytes(ground, &request))
    }

    /// The acceleration that starts it to either side, as `archrock limit --format json`.
    fn limit_json(&self, py: Python<'_>) -> PyResult<String> {
        let answer = py.detach(|| limit(&self.inner)).map_err(refused_value)?;
        Ok(answer.json.to_string())
    }

    /// The mechanisms through which impacts lead after a first sway to a side, as `archrock impact --format json`.
    fn chain_json(&self, py: Python<'_>, sway: &str, count: usize) -> PyResult<String> {
        let first = Sway::ALL
            .iter()
            .copied()
            .find(|one| one.name() == sway)
            .ok_or_else(|| {
                refused_value(format!(
                    "`sway = {sway:?}` is not one of \"right\" and \"left\""
                ))
            })?;
        if self.inner.structure.wall_behind() == Some(first) {
            let away = first.opposite().name();
            return Err(refused_value(format!(
                "`sway = {sway:?}` points to the wall behind the column; choose {away:?}"
            )));
        }
        let impacts = self.read_mechanisms(py, |model| impact_chain(model, first, count))?;
        Ok(json!(impacts).to_string())
    }

    /// Its unlikely numbers, a sentence each.
    fn unlikely(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.inner.unlikely_values())
    }

    /// Names of the bodies.
    fn bodies(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(self.model(py)?.bodies())
    }
}

/// A ground motion.
#[pyclass(frozen, module = "archrock._native")]
pub struct Ground {
    pub inner: archrock::scenario::Ground,
    /// Its motion for the gravity of the latest use.
    latest: Mutex<Option<(f64, Arc<GroundMotion>)>>,
}

impl Ground {
    /// The motion for the given gravity.
    pub fn motion(&self, gravity_m_s2: f64) -> PyResult<Arc<GroundMotion>> {
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        match &*latest {
            Some((of, motion)) if *of == gravity_m_s2 => Ok(Arc::clone(motion)),
            _ => {
                let motion = Arc::new(
                    self.inner
                        .ground_motion(gravity_m_s2)
                        .map_err(refused_value)?,
                );
                *latest = Some((gravity_m_s2, Arc::clone(&motion)));
                Ok(motion)
            }
        }
    }
}

/// Gravity with which a ground motion on its own is read.
const GRAVITY_M_S2: f64 = 9.81;

/// Most samples of a ground motion.
const MAX_SAMPLES: f64 = 1.8e6;

/// Times in s and samples, in the unit of their file.
type TimesAndSamples<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl Ground {
    /// Reads the tables of `[ground]`.
    #[new]
    fn read(py: Python<'_>, text: &str, files: Files<'_>) -> PyResult<Self> {
        let text = Text::new(text, None, files)?;
        let inner = py
            .detach(|| text.read(|source| archrock::scenario::Ground::of(source, GRAVITY_M_S2)))
            .map_err(refused_value)?;
        Ok(Self {
            inner,
            latest: Mutex::default(),
        })
    }

    /// The tables of `[ground]` as JSON.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.inner).map_err(refused_value)
    }

    /// Unit of a record's samples; `None` for a pulse.
    fn unit(&self) -> Option<&'static str> {
        match &self.inner {
            archrock::scenario::Ground::Record(record) => Some(record.main.unit.name()),
            archrock::scenario::Ground::Pulse(_) => None,
        }
    }

    /// Times in s from the start of the motion to its end, and horizontal accelerations in m/s2.
    fn sample<'py>(&self, py: Python<'py>, step_s: f64) -> PyResult<TimesAndSamples<'py>> {
        let motion = self.motion(GRAVITY_M_S2)?;
        let (start_s, end_s) = (motion.start_s(), motion.end_s());
        let count = (end_s - start_s) / step_s;
        if !(step_s > 0.0 && count < MAX_SAMPLES) {
            return Err(refused_value(format!(
                "`step_s = {step_s}` must be positive, and make at most {MAX_SAMPLES} samples until {end_s} s"
            )));
        }
        // A small whole number; the last sample is at the end, or just after it.
        let count = (count - 1e-9).ceil() as usize;
        let times: Vec<f64> = (0..=count)
            .map(|index| start_s + index as f64 * step_s)
            .collect();
        let mut pieces = motion.pieces.iter().peekable();
        let accelerations = times.iter().map(|time_s| {
            while pieces.next_if(|piece| piece.end_s <= *time_s).is_some() {}
            pieces
                .peek()
                .map_or(0.0, |piece| piece.acceleration_m_s2(*time_s))
        });
        let accelerations: Vec<f64> = accelerations.collect();
        Ok((
            PyArray1::from_vec(py, times),
            PyArray1::from_vec(py, accelerations),
        ))
    }

    /// Times and samples of a record as in its file; `None` for a pulse.
    fn samples<'py>(&self, py: Python<'py>) -> Option<TimesAndSamples<'py>> {
        let archrock::scenario::Ground::Record(record) = &self.inner else {
            return None;
        };
        let column = |which: fn(&(f64, f64)) -> f64| {
            let values: Vec<f64> = record.main.samples.iter().map(which).collect();
            PyArray1::from_vec(py, values)
        };
        let columns = (column(|sample| sample.0), column(|sample| sample.1));
        columns.0.readwrite().make_nonwriteable();
        columns.1.readwrite().make_nonwriteable();
        Some(columns)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.inner == other.inner
    }
}
