//! The library in a browser: a request as JSON in, an answer as JSON out.
//!
//! JavaScript asks for [`room`], writes the request there, calls [`compute`], and reads as many bytes from [`answer`]. A panic leaves its message in
//! the answer, and ends the module.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::panic;
use std::path::PathBuf;
use std::slice;

use archrock::mechanics::stability::onset;
use archrock::mechanics::{Edge, Supports};
use archrock::output::Figure;
use archrock::scenario::{ReadOptions, Scenario, ScenarioErrors, Source};
use archrock::studies::run::Sinks;
use archrock::studies::{
    Computation, Options, Progress, Study as _, StudyError, StudyKind, Style, Work,
};
use archrock::{Directions, OverturningMap, Runner, Sway};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A study of a scenario.
#[derive(Deserialize)]
struct Request {
    /// The scenario as TOML.
    scenario: String,
    /// Contents of the files that it names.
    #[serde(default)]
    files: BTreeMap<PathBuf, String>,
    /// Name of the study; `None` to read the scenario alone.
    study: Option<String>,
    /// Options of the study.
    #[serde(default)]
    options: Options,
    /// Whether computations in steps are not repeated.
    #[serde(default)]
    no_repeat: bool,
    /// Whether only the first sways of a row of blocks are computed, in one direction: a first picture at once.
    #[serde(default)]
    sways_only: bool,
    /// Names of the files to answer with; `*` for all.
    #[serde(default)]
    names: Vec<String>,
    /// Cells of a map to compute alone; `None` for a whole study.
    cells: Option<Vec<usize>>,
    /// All rows of a map, which are computed already, as JSON; `None` to compute them.
    rows: Option<Vec<String>>,
    /// Whether to answer with the statics alone.
    #[serde(default)]
    statics: bool,
}

/// The answer to a request.
#[derive(Default, Serialize)]
struct Answer {
    /// The scenario with all defaults.
    #[serde(skip_serializing_if = "Value::is_null")]
    scenario: Value,
    /// The report in words.
    words: String,
    /// The answer in lines: verdict with its conditions, limits and main numbers.
    answer: String,
    /// The report as JSON.
    #[serde(skip_serializing_if = "Value::is_null")]
    summary: Value,
    /// The files of the study that the request names.
    files: BTreeMap<&'static str, String>,
    /// The values of x and y of a map whose cells are computed alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    axes: Option<[Vec<f64>; 2]>,
    /// The rows of these cells, as JSON: numbers in JavaScript would lose the sign of zero.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    rows: Vec<String>,
    /// The statics of an arch of blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    statics: Option<Value>,
    /// The errors; empty for a result.
    errors: Vec<PlacedError>,
}

/// An error, with its place in the scenario if it has one.
#[derive(Serialize)]
struct PlacedError {
    message: String,
    line: Option<usize>,
    column: Option<usize>,
}

// All runs on the only thread of a worker.
thread_local! {
    static REQUEST: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static ANSWER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Part of the default time after the ground motion that a first picture shows: 0.6 s, and the first half cycle of a larger arch.
const SHOWN: f64 = 0.06;

unsafe extern "C" {
    /// Receives the progress: cases that are done, and all.
    safe fn progress(done: usize, all: usize);
}

/// Makes room for a request of so many bytes, and returns its place.
#[unsafe(no_mangle)]
pub extern "C" fn room(bytes: usize) -> *mut u8 {
    REQUEST.with_borrow_mut(|request| {
        request.clear();
        request.resize(bytes, 0);
        request.as_mut_ptr()
    })
}

/// Computes the answer to the request, and returns its length in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn compute() -> usize {
    panic::set_hook(Box::new(|panic| {
        keep(&Answer::of_error(format!("internal error: {panic}")));
    }));
    let request = REQUEST.take();
    let answer = match serde_json::from_slice::<Request>(&request) {
        Ok(request) => answer_to(request),
        Err(error) => Answer::of_error(format!("the request is wrong: {error}")),
    };
    keep(&answer)
}

/// Place of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    ANSWER.with_borrow(|answer| answer.as_ptr())
}

/// Length of the answer in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn length() -> usize {
    ANSWER.with_borrow(Vec::len)
}

fn keep(answer: &Answer) -> usize {
    // The keys are names, and all numbers of results are finite.
    ANSWER.set(serde_json::to_vec(answer).unwrap_or_default());
    length()
}

fn answer_to(request: Request) -> Answer {
    let files = request
        .files
        .into_iter()
        .map(|(name, text)| (name, text.into_bytes()));
    let source = Source::of_text(&request.scenario, "scenario.toml").with_files(files);
    let kind = request.study.as_deref().map(StudyKind::of_name);
    let options = ReadOptions {
        statics: request.statics || matches!(kind, Some(Some(kind)) if !kind.needs_motion),
        ..ReadOptions::default()
    };
    let scenario = match Scenario::of(&source, &options) {
        Ok(scenario) => scenario,
        Err(errors) => return Answer::of_errors(errors),
    };
    let json = scenario.to_json();
    let mut answer = match kind {
        None => Answer {
            statics: request.statics.then(|| statics(&scenario)).flatten(),
            ..Answer::default()
        },
        Some(None) => Answer::of_error("there is no such study".to_owned()),
        Some(Some(kind)) => {
            let mut options = request.options;
            options.run.no_repeat = request.no_repeat;
            let rows = request.rows.as_deref();
            let has_row = ["free_hinges", "elastic_joints"]
                .iter()
                .any(|table| json.get(table).is_some());
            let scenario = match request.sways_only && has_row {
                true => first_sways(&scenario),
                false => scenario,
            };
            let computed = match request.cells {
                Some(cells) => cells_of_map(&scenario, &cells),
                None => study(kind, &scenario, &options, &request.names, rows),
            };
            computed.unwrap_or_else(|error| Answer::of_error(error.to_string()))
        }
    };
    answer.scenario = json;
    answer
}

/// Returns what a thrust line drawn by hand needs: corners of the joints (intrados, extrados) and outlines of the blocks in metres, their centres with
/// their weights in N, and the first motions to both sides with their hinges (joint; 0 at the intrados, 1 at the extrados) and velocities. `None` if the
/// structure is not a row of blocks between two springings that its weight alone holds.
fn statics(scenario: &Scenario) -> Option<Value> {
    let row = scenario.structure.row().ok()?;
    let is_plain = row.supports == Supports::Both && row.ties.is_empty();
    if !is_plain || scenario.motion.supports().is_some() {
        return None;
    }
    let first_motion = |sway| {
        let onset = onset(&row, sway).ok()??;
        let hinges = onset.openings.iter().map(|opening| {
            let is_extrados = opening.hinge == Some(Edge::Extrados);
            (opening.joint, usize::from(is_extrados))
        });
        let velocities = onset.velocities.iter();
        let velocities = velocities.map(|twist| (twist.at_center, twist.rate));
        Some(json!({
            "acceleration_g": onset.acceleration_g,
            "hinges": hinges.collect::<Vec<_>>(),
            "velocities": velocities.collect::<Vec<_>>(),
        }))
    };
    let joints = row.joints.iter();
    let corners = joints.map(|joint| [joint.intrados_m, joint.extrados_m]);
    let blocks = row.blocks.iter();
    let weights = blocks.map(|block| (block.centre_m, block.mass_kg * scenario.gravity_m_s2()));
    Some(json!({
        "joints": corners.collect::<Vec<_>>(),
        "blocks": weights.collect::<Vec<_>>(),
        "outlines": row.outlines_m,
        "first_motions": [first_motion(Sway::Right)?, first_motion(Sway::Left)?],
    }))
}

/// Returns a scenario whose history ends soon after the ground motion, in its first direction. Most of the work of a history is its decay.
fn first_sways(scenario: &Scenario) -> Scenario {
    let directions = match scenario.simulation.direction {
        Directions::Both => Directions::AsGiven,
        one => one,
    };
    let first = scenario.in_directions(directions);
    let ground_end_s = scenario.ground_motion().end_s();
    let after_s = scenario.request().end_s - ground_end_s;
    match scenario.simulation.duration_s {
        Some(_) => first,
        None => {
            let end = [("simulation.duration_s", ground_end_s + SHOWN * after_s)];
            first.with_values(&end).unwrap_or(first)
        }
    }
}

fn watch(Progress { done, all, .. }: Progress) -> ControlFlow<()> {
    progress(done, all);
    ControlFlow::Continue(())
}

/// Computes some cells of a map.
fn cells_of_map(scenario: &Scenario, cells: &[usize]) -> Result<Answer, StudyError> {
    let map = OverturningMap::of(scenario).map_err(StudyError::Scenario)?;
    let numbers = |group: &[usize]| group.iter().map(|index| cells[*index]).collect::<Vec<_>>();
    let rows = Runner::default().each_of_families(
        cells.len(),
        |index| map.family(cells[index]),
        |group| map.rows(&numbers(group)),
        watch,
    )?;
    let json = rows.iter().map(serde_json::to_string);
    Ok(Answer {
        rows: json.filter_map(Result::ok).collect(),
        axes: Some(map.values),
        ..Answer::default()
    })
}

fn study(
    kind: StudyKind,
    scenario: &Scenario,
    options: &Options,
    names: &[String],
    rows: Option<&[String]>,
) -> Result<Answer, StudyError> {
    let sinks = Sinks {
        in_memory: names,
        ..Sinks::default()
    };
    let style = Style::of(Figure::SCREEN);
    let results = match rows {
        Some(rows) => kind.results_of(scenario, options, style, rows)?,
        None => {
            let work = Work {
                runner: Runner::default(),
                task: None,
                watch: &mut watch,
            };
            match kind.compute(slice::from_ref(scenario), options, style, work, sinks)? {
                Computation::Complete(results, _) => *results,
                Computation::Partial { .. } => {
                    return Ok(Answer::of_error("the study is incomplete".to_owned()));
                }
            }
        }
    };
    let files = results.files.into_iter();
    let named = files.filter(|(name, _)| names.iter().any(|one| one == name || one == "*"));
    let texts = named.map(|(name, bytes)| (name, String::from_utf8_lossy(&bytes).into_owned()));
    Ok(Answer {
        words: results.words,
        answer: results.statement.answer(true),
        summary: results.summary,
        files: texts.collect(),
        ..Answer::default()
    })
}

impl Answer {
    fn of_error(message: String) -> Self {
        let error = PlacedError {
            message,
            line: None,
            column: None,
        };
        Self {
            errors: vec![error],
            ..Self::default()
        }
    }

    fn of_errors(ScenarioErrors(errors): ScenarioErrors) -> Self {
        // A link to the page holds the text of the scenario alone.
        let missing = "is not among the given files";
        let chosen = format!("{missing}: choose it, because a link holds no files");
        let errors = errors.into_iter().map(|error| PlacedError {
            message: error.message.replace(missing, &chosen),
            line: error.place.map(|place| place.line),
            column: error.place.map(|place| place.column),
        });
        Self {
            errors: errors.collect(),
            ..Self::default()
        }
    }
}
