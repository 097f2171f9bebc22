//! The command `check`: prints the contents of a scenario or a record file.

use std::path::{Path, PathBuf};

use archrock::dynamics::Intensity;
use archrock::output::{Scene, draw_elevation, draw_record};
use archrock::scenario::{
    Format, Scenario, ScenarioErrors, Series, describes_tables, format_of_file, unknown_format,
};
use archrock::studies::run::{self, RunOptions};
use archrock::studies::{StudyError, record};
use archrock::{GroundMotion, Request};
use serde_json::Value;

use super::figure::FigureOption;
use super::scenario_file::{Input, SetOption};
use super::{
    Failure, Format as Printed, check_no_errors, collect_input_error, named_files, print, print_all,
};

#[derive(clap::Args)]
pub struct Arguments {
    #[arg(required = true, value_name = "FILE", help = files_help())]
    files: Vec<PathBuf>,
    #[command(flatten)]
    set: SetOption,
    /// Draw the structure with its dimensions and the numbers of its joints, or the record, to this file (SVG).
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Output format; JSON for several files or channels is an array.
    #[arg(long, value_enum, default_value_t)]
    format: Printed,
    #[command(flatten)]
    figure: FigureOption,
}

/// Returns the help of the files, with the formats of records.
fn files_help() -> String {
    let formats = Format::names();
    format!("Scenario files (TOML; `-` for standard input), or record files (formats: {formats})")
}

/// Gravity for record files without a scenario, in m/s2.
const GRAVITY_M_S2: f64 = 9.81;

pub fn check(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.plot.is_some() && arguments.files.len() > 1 {
        return Err("--plot takes one file".into());
    }
    let (mut texts, mut contents, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    for file in &arguments.files {
        let described = collect_input_error(check_file(file, arguments), &mut wrong)?;
        for (text, json) in described.into_iter().flatten() {
            texts.push(text);
            contents.push(json);
        }
    }
    match arguments.format {
        Printed::Text => print(&texts.join("\n"))?,
        Printed::Json if contents.is_empty() => {}
        Printed::Json => print_all(contents)?,
    }
    check_no_errors(&wrong)
}

/// The contents of a scenario or of a record, as text and as JSON.
type Described = (String, Value);

/// Returns the contents of a file. A record file has those of all its channels.
fn check_file(file: &Path, arguments: &Arguments) -> Result<Vec<Described>, Failure> {
    let format = format_of_file(file);
    if format.is_some() || is_format_given(arguments) {
        return check_record(file, format, arguments);
    }
    if let Some(errors) = unknown_format(file) {
        return Err(with_hint(&errors));
    }
    let scenario = read(&arguments.set.open(file)?)?;
    super::warn(&scenario.unlikely_values());
    if let Some(plot) = &arguments.plot {
        let scene = drawn(&scenario)?;
        let title = scenario.title.as_deref().unwrap_or("Structure");
        let mut text = scenario.structure.describe();
        text += "; blue arrow: positive ground acceleration, which pushes to the left";
        if scene.has_settled() {
            text += "; dashed: as built; circles: open hinges";
        }
        let picture = draw_elevation(arguments.figure.get()?, title, &scene, &text);
        named_files::write_picture(plot, &picture)?;
    }
    let notes = scenario.structure.tie_places();
    let notes: String = notes.iter().map(|note| format!("# {note}\n")).collect();
    Ok(vec![(
        notes + &scenario.to_resolved_toml(),
        scenario.to_resolved_json(),
    )])
}

/// Reads the scenario, and refuses what `run` refuses. Without a motion of the ground or of the structure, faults that concern motion alone are
/// warnings: the scenario is for static analysis.
fn read(input: &Input<'_>) -> Result<Scenario, Failure> {
    let refused = match input.read(None) {
        Ok(scenario) => match why_not_run(&scenario) {
            None => return Ok(scenario),
            Some(wrong) => input.input_error(wrong),
        },
        Err(refused) => refused,
    };
    let Failure::Input(wrong) = &refused else {
        return Err(refused);
    };
    match input.read_statics() {
        Ok(scenario) if !scenario.gives_motion() => {
            super::warn(&[format!(
                "only `limit`, `spread`, `capacity` and `verify` work: {wrong}"
            )]);
            Ok(scenario)
        }
        _ => Err(refused),
    }
}

/// Returns the reason for which `run` refuses the structure of a scenario.
fn why_not_run(scenario: &Scenario) -> Option<String> {
    // The reader has tried elastic joints, whose equilibrium takes long to find.
    if scenario.motion.kind.has_stiffness {
        return None;
    }
    match scenario.check_restitution() {
        // `threshold --along` computes the scenario for several restitutions.
        Err(missing) => {
            super::warn(&[missing]);
            None
        }
        Ok(()) => run::check(scenario, &RunOptions::default()).err(),
    }
}

/// Returns the blocks of the model of motion, or the structure itself if the model has no blocks. On moved supports blocks are in their
/// positions at time 0.
fn drawn(scenario: &Scenario) -> Result<Scene, Failure> {
    let joints = scenario.motion.kind.has_joints;
    let Some(row) = scenario.structure.row().ok().filter(|_| joints) else {
        return Ok(Scene::new(&scenario.structure));
    };
    let mut scene = Scene::of_row(&row, &scenario.structure);
    let Some(movements) = scenario.motion.supports() else {
        return Ok(scene);
    };
    let model = scenario
        .model()
        .map_err(|error| Failure::Work(error.to_string()))?;
    let request = scenario.request_on(scenario.ground_motion(), &scenario.structure);
    let request = Request {
        end_s: request.output_step_s,
        outcome_by_s: None,
        ..request
    };
    let history = model.history(&GroundMotion::still(), &request);
    let history = history.map_err(StudyError::from)?;
    let first = history.samples.iter().next();
    scene.stands = first.map_or_else(Default::default, |first| {
        (first.poses.to_vec(), first.hinges.to_vec())
    });
    scene.supports = movements.poses(&row);
    Ok(scene)
}

/// Returns true if `--set` gives the key `format`: the file is then a record.
fn is_format_given(arguments: &Arguments) -> bool {
    let mut keys = arguments.set.assignments().iter();
    keys.any(|assignment| assignment.key() == "format")
}

/// Returns the error of a record file, with the way to give keys.
fn with_hint(errors: &ScenarioErrors) -> Failure {
    let hint =
        "keys of [ground.record] are given with --set, as in --set unit=cm/s2 --set skip_rows=3";
    Failure::Input(format!("{errors}\n{hint}"))
}

/// Returns the contents of a record file: of all its channels unless one is chosen.
fn check_record(
    file: &Path,
    format: Option<Format>,
    arguments: &Arguments,
) -> Result<Vec<Described>, Failure> {
    // Keys of tables do not apply to files of other formats among the arguments.
    let is_table = |format: Option<Format>| match format {
        Some(format) => format == Format::CSV,
        None => is_format_given(arguments),
    };
    let mut files = arguments.files.iter();
    let has_all = is_table(format) || !files.any(|file| is_table(format_of_file(file)));
    let (keys, left_out): (Vec<_>, Vec<_>) = arguments
        .set
        .assignments()
        .iter()
        .cloned()
        .partition(|assignment| has_all || !describes_tables(assignment.key()));
    if left_out.iter().any(|assignment| assignment.key() == "unit") {
        super::warn(&[format!(
            "{}: ignored `unit`: this file states its unit",
            file.display()
        )]);
    }
    let all = Series::read_file(file, &keys).map_err(|errors| with_hint(&errors))?;
    if arguments.plot.is_some() && all.len() > 1 {
        let count = all.len();
        let wrong = format!(
            "{}: --plot draws one channel of {count}: set its number, as in --set channel=1",
            file.display()
        );
        return Err(Failure::Input(wrong));
    }
    let all = all.iter();
    all.map(|series| describe(file, series, arguments))
        .collect()
}

/// Returns the contents of a record, and draws it if that is requested.
fn describe(file: &Path, series: &Series, arguments: &Arguments) -> Result<Described, Failure> {
    super::warn(&series.unlikely(GRAVITY_M_S2));
    let samples = series.accelerations_m_s2(GRAVITY_M_S2);
    let intensity = Intensity::of(&samples, GRAVITY_M_S2);
    if let Some(plot) = &arguments.plot {
        let title = file.file_name().unwrap_or_default().to_string_lossy();
        let figure = arguments.figure.get()?;
        let picture = draw_record(figure, &title, &samples, &intensity, GRAVITY_M_S2);
        named_files::write_picture(plot, &picture)?;
    }
    let found = record(series, &intensity, GRAVITY_M_S2);
    let found = found.map_err(StudyError::from)?;
    Ok((found.text, found.json))
}
