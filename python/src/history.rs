//! Histories: simulated while the interpreter's lock is released, with columns moved out as arrays.

use std::mem;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use archrock::dynamics::repeatability::Repeatability;
use archrock::dynamics::{Direction, Directions, FallEnd, Summary};
use archrock::dynamics::{Recording, Samples};
use archrock::mechanics::Demand;
use archrock::output::{FilmFormat, Scene, StructurePoint, check_named_file, write_named_file};
use archrock::studies::run::{
    self, ComputedRun, Film, FilmOptions, MirroredSummary, OutcomeSummary, Report, ReportPage,
    VariedRun,
};
use archrock::{Event, GroundMotion, Model, Recorder, Sample, SimulationError, State};
use numpy::{Element, PyArray1, PyArrayMethods as _, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use serde_json::Value;

use crate::error::{not_written, panicked, refused_value, too_large};
use crate::scenario::{Ground, Scenario};
use crate::studies::failed;
use crate::watched::watch_work;

/// Interval at which a history looks for signals.
const TICK: Duration = Duration::from_millis(100);

/// Lets Ctrl-C end a history.
struct Signals {
    asked: Instant,
    /// The exception that a signal raised.
    raised: Option<PyErr>,
}

impl Signals {
    fn new() -> Self {
        Self {
            asked: Instant::now(),
            raised: None,
        }
    }

    /// Whether to continue.
    fn go_on(&mut self) -> ControlFlow<()> {
        if self.asked.elapsed() < TICK {
            return ControlFlow::Continue(());
        }
        self.raised = Python::attach(|py| py.check_signals()).err();
        self.asked = Instant::now();
        match self.raised {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        }
    }
}

/// Collects samples and events.
struct Watched {
    recording: Recording,
    signals: Signals,
}

impl Recorder for Watched {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.recording.sample(sample)?;
        self.signals.go_on()
    }

    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        self.recording.event(event)?;
        self.signals.go_on()
    }
}

/// Collects the data of a page.
struct Filming {
    report: Report,
    signals: Signals,
}

impl Recorder for Filming {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.report.push(sample);
        self.signals.go_on()
    }

    fn wants_thrust_line(&self) -> bool {
        true
    }

    fn wants_fall(&self) -> bool {
        true
    }

    fn fall_sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.report.push_fall(sample);
        self.signals.go_on()
    }

    fn fall_end(&mut self, end: FallEnd) {
        self.report.end_fall(end);
    }
}

/// Names of the columns of samples.
const COLUMNS: [&str; 19] = [
    "time_s",
    "ground_acceleration_m_s2",
    "vertical_acceleration_m_s2",
    "feet_apart_m",
    "phase",
    "state",
    "rotations_rad",
    "rates_rad_s",
    "poses",
    "gaps_m",
    "offsets_m",
    "pressures",
    "ties",
    "point_m",
    "open_hinges",
    "thrust_excess_ratio",
    "friction_demand",
    "energy_j",
    "energy_ratio",
];

/// A history.
#[pyclass(frozen, module = "archrock._native")]
pub struct History {
    scenario: Arc<archrock::Scenario>,
    /// The ground, if it is not the scenario's own.
    ground: Option<archrock::scenario::Ground>,
    model: Arc<dyn Model>,
    summary: Summary,
    /// The comparison with its repetitions, which is made when first needed; `None` if the model has none.
    repeated: OnceLock<Repeated>,
    /// The result under the mirrored ground motion, which is computed when first needed; `None` without a second direction.
    mirrored: OnceLock<Option<MirroredSummary>>,
    /// The results with other properties, which are computed when first needed.
    varied: OnceLock<Vec<VariedRun>>,
    events: Vec<Event>,
    /// Number of samples, of bodies, of joints with gaps, of joints that slip, of joints with contact forces, and of ties.
    counts: [usize; 6],
    /// Displacements of the observed point, to the right and upwards, for each sample.
    point_m: Mutex<Option<Vec<f64>>>,
    /// The columns that were not taken yet.
    samples: Mutex<Samples>,
    arrays: [PyOnceLock<Py<PyAny>>; COLUMNS.len()],
}

/// The comparison of a history with its repetitions; `None` if its model has none.
type Repeated = Option<Repeatability>;

/// Simulates while the interpreter's lock is released. A panic becomes an error; so does an exception that a signal raises.
fn simulate<R: Recorder + Send>(
    py: Python<'_>,
    model: &dyn Model,
    scenario: &archrock::Scenario,
    ground: &GroundMotion,
    recorder: &mut R,
    raised: impl FnOnce(&mut R) -> Option<PyErr>,
) -> PyResult<Summary> {
    let request = scenario.request_under(ground);
    let simulated = py.detach(|| {
        catch_unwind(AssertUnwindSafe(|| {
            model.simulate(ground, &request, Some(&mut *recorder))
        }))
    });
    if let Some(error) = raised(recorder) {
        return Err(error);
    }
    let simulated: Result<Summary, SimulationError> =
        simulated.map_err(|panic| panicked(&*panic))?;
    simulated.map_err(refused_value)
}

impl History {
    /// Takes a column out of the samples, as an array of its shape.
    fn take<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let [count, bodies, joints, slipping, pressing, ties] = self.counts;
        let taken = |take: &mut dyn FnMut(&mut Samples) -> Vec<f64>, shape: &[usize]| {
            let values = take(&mut self.samples.lock().unwrap_or_else(PoisonError::into_inner));
            array(py, values, shape)
        };
        let demand = |of: fn(&Demand) -> f64| {
            let samples = self.samples.lock().unwrap_or_else(PoisonError::into_inner);
            samples.demand.iter().map(of).collect::<Vec<f64>>()
        };
        match name {
            "time_s" => taken(&mut |all| mem::take(&mut all.time_s), &[count]),
            "ground_acceleration_m_s2" => taken(
                &mut |all| mem::take(&mut all.ground_acceleration_m_s2),
                &[count],
            ),
            "vertical_acceleration_m_s2" => taken(
                &mut |all| mem::take(&mut all.vertical_acceleration_m_s2),
                &[count],
            ),
            "feet_apart_m" => taken(
                &mut |all| mem::take(&mut all.feet_apart_m).into_flattened(),
                &[count, 2],
            ),
            "rotations_rad" => taken(
                &mut |all| mem::take(&mut all.rotations_rad),
                &[count, bodies],
            ),
            "rates_rad_s" => taken(&mut |all| mem::take(&mut all.rates_rad_s), &[count, bodies]),
            "poses" => taken(
                &mut |all| mem::take(&mut all.poses).into_flattened(),
                &[count, bodies, 3],
            ),
            "gaps_m" => taken(
                &mut |all| mem::take(&mut all.gaps_m).into_flattened(),
                &[count, joints, 2],
            ),
            "offsets_m" => taken(&mut |all| mem::take(&mut all.offsets_m), &[count, slipping]),
            "pressures" => taken(
                &mut |all| {
                    let pressures = mem::take(&mut all.pressures).into_iter();
                    pressures
                        .flat_map(|joint| {
                            let [intrados_pa, extrados_pa] = joint.edge_stresses_pa;
                            let eccentricity = joint.eccentricity_ratio.unwrap_or(f64::NAN);
                            [
                                joint.normal_n,
                                joint.shear_n,
                                eccentricity,
                                joint.contact_ratio,
                                intrados_pa,
                                extrados_pa,
                            ]
                        })
                        .collect()
                },
                &[count, pressing, 6],
            ),
            "ties" => taken(
                &mut |all| {
                    let ties = mem::take(&mut all.ties).into_iter();
                    ties.flat_map(|tie| [tie.force_n, tie.elongation_m])
                        .collect()
                },
                &[count, ties, 2],
            ),
            "point_m" => {
                let point_m = self
                    .point_m
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .take();
                let axes = if point_m.is_some() { 2 } else { 0 };
                array(py, point_m.unwrap_or_default(), &[count, axes])
            }
            "energy_j" => taken(&mut |all| mem::take(&mut all.energy_j), &[count]),
            "energy_ratio" => taken(
                &mut |all| {
                    let known = mem::take(&mut all.energy_ratio);
                    known
                        .into_iter()
                        .map(|one| one.unwrap_or(f64::NAN))
                        .collect()
                },
                &[count],
            ),
            "thrust_excess_ratio" => array(py, demand(|one| one.excess_ratio), &[count]),
            "friction_demand" => array(py, demand(|one| one.friction), &[count]),
            "phase" => array(
                py,
                self.take_indices(|all| mem::take(&mut all.phase)),
                &[count],
            ),
            "open_hinges" => {
                let open = self.take_indices(|all| {
                    let ends = all
                        .first_hinge
                        .iter()
                        .skip(1)
                        .copied()
                        .chain([all.hinges.len()]);
                    let first = all.first_hinge.iter();
                    first.zip(ends).map(|(first, end)| end - first).collect()
                });
                array(py, open, &[count])
            }
            "state" => {
                let codes = self.take_indices(|all| {
                    let states = mem::take(&mut all.state);
                    states.into_iter().map(code).collect()
                });
                array(py, codes, &[count])
            }
            _ => Err(PyKeyError::new_err(name.to_owned())),
        }
    }

    fn take_indices(&self, take: impl FnOnce(&mut Samples) -> Vec<usize>) -> Vec<i64> {
        let values = take(&mut self.samples.lock().unwrap_or_else(PoisonError::into_inner));
        // Counts of things in memory are far below the largest of these.
        values.into_iter().map(|one| one as i64).collect()
    }

    /// The comparison with its repetitions.
    fn repeated(&self, py: Python<'_>) -> PyResult<&Repeated> {
        if self.repeated.get().is_none() {
            let (scenario, model) = (self.shaken_scenario(), Arc::clone(&self.model));
            let summary = self.summary.clone();
            let found = watch_work(py, None, move |_| {
                Ok(run::repeat(&scenario, &*model, &summary))
            })?;
            // Another thread may have repeated it meanwhile, with the same result.
            let _ = self.repeated.set(found);
        }
        Ok(self.repeated.get().unwrap_or(&None))
    }

    /// The result under the mirrored ground motion, with its repetitions.
    fn mirrored(&self, py: Python<'_>) -> PyResult<Option<&MirroredSummary>> {
        if self.mirrored.get().is_none() {
            let (scenario, model) = (self.shaken_scenario(), Arc::clone(&self.model));
            let found = watch_work(py, None, move |_| {
                Ok(MirroredSummary::compute(&scenario, &*model, true))
            })?;
            // Another thread may have computed it meanwhile, with the same result.
            let _ = self.mirrored.set(found);
        }
        Ok(self.mirrored.get().and_then(Option::as_ref))
    }

    /// The results with other properties.
    fn varied(&self, py: Python<'_>) -> PyResult<&[VariedRun]> {
        if self.varied.get().is_none() {
            let (scenario, model) = (self.shaken_scenario(), Arc::clone(&self.model));
            let found = watch_work(py, None, move |_| {
                run::compute_varied(&scenario, &*model).map_err(failed)
            })?;
            // Another thread may have computed them meanwhile, with equal results.
            let _ = self.varied.set(found);
        }
        Ok(self.varied.get().map_or(&[][..], |varied| varied))
    }

    /// The history alone in a scenario.
    fn run_alone<'a>(&'a self, scenario: &'a archrock::Scenario) -> ComputedRun<'a> {
        ComputedRun {
            scenario,
            model: &*self.model,
            history: &self.summary,
            impacts: self.events.iter().collect(),
            repeated: None,
            varied: &[],
            mirrored: None,
        }
    }

    /// The history in a scenario, with its repetitions, the mirrored ground motion and other properties.
    fn run_with_repetitions<'a>(
        &'a self,
        py: Python<'_>,
        scenario: &'a archrock::Scenario,
    ) -> PyResult<ComputedRun<'a>> {
        Ok(ComputedRun {
            repeated: self.repeated(py)?.as_ref(),
            mirrored: self.mirrored(py)?.cloned(),
            varied: self.varied(py)?,
            ..self.run_alone(scenario)
        })
    }

    /// Simulates a scenario in one direction again, and makes its page with this verdict.
    fn page(
        &self,
        py: Python<'_>,
        scenario: &archrock::Scenario,
        verdict: &str,
    ) -> PyResult<ReportPage> {
        let mut filming = Filming {
            report: Report::new(scenario, &*self.model),
            signals: Signals::new(),
        };
        let motion = scenario.ground_motion();
        let model = &*self.model;
        let history = simulate(py, model, scenario, motion, &mut filming, |filming| {
            filming.signals.raised.take()
        })?;
        let report = &filming.report;
        Ok(py.detach(|| report.page(scenario, &history, None, ["", verdict], "")))
    }

    /// The scenario with the ground on which it was simulated.
    fn shaken_scenario(&self) -> Arc<archrock::Scenario> {
        match &self.ground {
            Some(ground) => Arc::new(self.scenario.with_ground(Some(ground.clone()))),
            None => Arc::clone(&self.scenario),
        }
    }
}

/// Names of the states; the index of each is its code.
const STATES: [&str; 4] = ["rest", "right", "left", "overturned"];

fn code(state: State) -> usize {
    let name = state.name();
    STATES.iter().position(|one| *one == name).unwrap_or(0)
}

/// A point of a structure, given by its undeformed position.
fn structure_point(scene: &Scene, at_m: [f64; 2]) -> PyResult<StructurePoint> {
    scene.point(at_m).map_err(|nearest_m| {
        refused_value(format!(
            "`point = ({:?}, {:?})` is in no block: the nearest place of one is ({:.3}, {:.3})",
            at_m[0], at_m[1], nearest_m.x, nearest_m.y
        ))
    })
}

/// Values as an array that cannot be written to. The array takes ownership; nothing is copied.
fn array<'py, T: Element>(
    py: Python<'py>,
    values: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let array = PyArray1::from_vec(py, values).reshape(shape)?;
    array.readwrite().make_nonwriteable();
    debug_assert_eq!(array.shape(), shape);
    Ok(array.into_any())
}

/// An event as JSON; its impact with its own time, and with the sway of the mechanism that opened.
fn event(event: &Event) -> PyResult<Value> {
    let mut json = serde_json::to_value(event).map_err(refused_value)?;
    if let (Some(impact), Some(fields)) = (&event.impact, json["impact"].as_object_mut()) {
        fields.insert("time_s".to_owned(), event.time_s.into());
        fields.insert("sway_after".to_owned(), impact.sway_after().name().into());
    }
    Ok(json)
}

#[pymethods]
impl History {
    /// Simulates a scenario, on other ground than its own if that is given, within this memory, and observes one of its points.
    #[staticmethod]
    #[pyo3(signature = (scenario, ground, memory_bytes, point=None))]
    fn of(
        py: Python<'_>,
        scenario: &Scenario,
        ground: Option<&Ground>,
        memory_bytes: u64,
        point: Option<[f64; 2]>,
    ) -> PyResult<Self> {
        let inner = scenario.moving()?;
        let motion = |ground: &Ground| ground.motion(inner.gravity_m_s2());
        let mut other = ground.map(motion).transpose()?;
        if inner.simulation.direction.first() == Direction::Mirrored {
            other = other.map(|as_given| Arc::new(as_given.mirrored()));
        }
        let motion = match &other {
            Some(motion) => motion,
            None => {
                inner.check_for_run().map_err(refused_value)?;
                inner.ground_motion()
            }
        };
        let model = scenario.model(py)?;
        let scene = run::scene(inner, &**model);
        let point = point
            .map(|[x, y]| structure_point(&scene, [x, y]))
            .transpose()?;
        let needed_bytes = model.sample_bytes(motion, &inner.request_under(motion));
        let recording = Recording::new(needed_bytes, memory_bytes).map_err(too_large)?;
        let mut watched = Watched {
            recording,
            signals: Signals::new(),
        };
        let summary = simulate(py, &**model, inner, motion, &mut watched, |watched| {
            watched.signals.raised.take()
        })?;
        let (samples, events) = watched.recording.finish().map_err(too_large)?;
        let displaced = |point: &StructurePoint| {
            let moved_m = samples.iter().map(|sample| {
                let carried = scene.body_point(point, &sample.hinges);
                carried.current_position(&sample.poses, 1.0) - point.at_m
            });
            moved_m.flat_map(|moved_m| [moved_m.x, moved_m.y]).collect()
        };
        let point_m = point.as_ref().map(displaced);
        let count = samples.len();
        let each = |all: usize| all.checked_div(count).unwrap_or(0);
        Ok(Self {
            scenario: Arc::clone(inner),
            ground: ground.map(|ground| ground.inner.clone()),
            model: Arc::clone(model),
            summary,
            repeated: OnceLock::new(),
            mirrored: OnceLock::new(),
            varied: OnceLock::new(),
            events,
            counts: [
                count,
                each(samples.rotations_rad.len()),
                each(samples.gaps_m.len()),
                each(samples.offsets_m.len()),
                each(samples.pressures.len()),
                each(samples.ties.len()),
            ],
            point_m: Mutex::new(point_m),
            samples: Mutex::new(samples),
            arrays: [const { PyOnceLock::new() }; COLUMNS.len()],
        })
    }

    /// Names of the states; the index of each is its code in the column `state`.
    #[classattr]
    const STATES: [&'static str; 4] = STATES;

    /// A column of the samples; the same array every time.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let index = COLUMNS
            .iter()
            .position(|column| *column == name)
            .ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        let array =
            self.arrays[index].get_or_try_init(py, || self.take(py, name).map(Bound::unbind))?;
        Ok(array.bind(py).clone())
    }

    /// Names of the columns.
    #[classattr]
    const COLUMNS: [&'static str; COLUMNS.len()] = COLUMNS;

    /// Names of the bodies.
    fn bodies(&self) -> Vec<String> {
        self.model.bodies()
    }

    /// Index of the body that turns most.
    fn largest_body(&self) -> usize {
        self.summary.largest_body()
    }

    /// Number of samples.
    fn __len__(&self) -> usize {
        self.counts[0]
    }

    /// The outcome, as in `summary.json`.
    fn ended_json(&self) -> PyResult<String> {
        serde_json::to_string(&OutcomeSummary::of(&self.summary)).map_err(refused_value)
    }

    /// The events as JSON.
    fn events_json(&self) -> PyResult<String> {
        let events = self.events.iter().map(event);
        Ok(Value::Array(events.collect::<PyResult<_>>()?).to_string())
    }

    /// The scenario with the ground on which it was simulated.
    fn scenario(&self) -> Scenario {
        Scenario::new(self.shaken_scenario())
    }

    /// `summary.json` of the program; without `repeat`, `verdict` is that of the history alone.
    fn summary_json(&self, py: Python<'_>, repeat: bool) -> PyResult<String> {
        let scenario = self.shaken_scenario();
        let computed = match repeat {
            true => self.run_with_repetitions(py, &scenario)?,
            false => self.run_alone(&scenario),
        };
        let summary = run::summary(&computed);
        Ok(summary.map_err(not_written)?.to_string())
    }

    /// `warnings` of `summary.json`.
    fn warnings(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| {
            run::RunSummary::of(&self.run_alone(&self.shaken_scenario()))
                .warnings
                .all()
                .to_vec()
        })
    }

    /// Writes a film; `factors` are its speed and that on the displacements. Simulates the history again, with the line of thrust.
    fn film(
        &self,
        py: Python<'_>,
        path: PathBuf,
        size_px: [u32; 2],
        factors: (f64, f64),
        background: &str,
        caption: Option<String>,
    ) -> PyResult<()> {
        let format = FilmFormat::of_file(&path).map_err(refused_value)?;
        let (speed, exaggeration) = factors;
        let options = FilmOptions {
            speed,
            size_px,
            background: background.parse().map_err(refused_value)?,
            caption,
            exaggeration,
        };
        options.check().map_err(refused_value)?;
        check_named_file(&path).map_err(not_written)?;
        let (scenario, model) = (self.shaken_scenario(), Arc::clone(&self.model));
        let film = watch_work(py, None, move |watch| {
            let film = Film::simulate(&scenario, &*model, &options, &mut *watch);
            film.and_then(|film| film.encode(format, watch))
                .map_err(failed)
        })?;
        write_named_file(&path, &film).map_err(not_written)
    }

    /// `report.html` with the verdict on it, which opens with the worse direction. Simulates the history again, with the line of thrust.
    fn report(&self, py: Python<'_>) -> PyResult<String> {
        let scenario = self.shaken_scenario();
        let mirrored = self.mirrored(py)?;
        let summary = run::RunSummary::of(&self.run_with_repetitions(py, &scenario)?);
        let verdict = summary.verdict_line();
        let own = self.page(py, &scenario, &verdict)?;
        let computed = mirrored.filter(|mirrored| mirrored.failed.is_none());
        let page = match computed {
            None => own,
            Some(_) => {
                let turned = scenario.in_directions(Directions::Mirrored);
                let other = self.page(py, &turned, &verdict)?;
                match summary.worse_mirrored() {
                    Some(_) => other.with_other_direction(own),
                    None => own.with_other_direction(other),
                }
            }
        };
        Ok(py.detach(|| page.html()))
    }
}
