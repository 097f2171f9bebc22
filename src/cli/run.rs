//! The command `run`.

use std::path::{Path, PathBuf};

use archrock::output::{Origin, Panel};
use archrock::scenario::Scenario;
use archrock::studies::run::{RunOptions, check};
use archrock::studies::{Options, RUN, Style};
use nalgebra::Vector2;

use super::execution::Execution;
use super::figure::FigureOption;
use super::models::ModelsOption;
use super::parsers::{number, point_m};
use super::results::DetailsOption;
use super::scenario_file::{
    Destination, DirectionOption, FileTasks, SetOption, SuiteOption, check_distinct,
};
use super::study::WorkOptions;
use super::{Failure, Format, check_no_errors, collect_input_error};

#[derive(clap::Args)]
pub struct Arguments {
    /// Scenario files (TOML); `-` for standard input.
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    suite: SuiteOption,
    /// Folder for the results; with several scenarios, for their folders [default: results/<name of the scenario
    /// file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the rotations here instead of to a file: `-` for standard output. No other results are then
    /// written unless --out is given.
    #[arg(long, value_name = "-", value_parser = ["-"])]
    rotations: Option<String>,
    /// Format of the printed summary. JSON is that of summary.json, an array for several scenarios; files are then
    /// written with --out only.
    #[arg(long, value_enum, default_value_t, conflicts_with = "rotations")]
    format: Format,
    #[command(flatten)]
    details: DetailsOption,
    /// Add dimensionless columns to the rotations: p_t (time), acceleration_over_incipient and
    /// rotation_over_critical. For four links and columns only.
    #[arg(long)]
    dimensionless: bool,
    #[command(flatten)]
    models: ModelsOption,
    #[command(flatten)]
    direction: DirectionOption,
    /// Do not repeat a run with free hinges or elastic joints in other steps, nor elastic joints with other stiffness and contact.
    #[arg(long)]
    no_repeat: bool,
    /// Write no page for the browser (report.html, samples.html).
    #[arg(long)]
    no_report: bool,
    /// Draw the deformed structure at these times, in seconds, to snapshots.svg; each shows the nearest row of the
    /// rotations.
    #[arg(long, value_name = "T1,T2,...", value_delimiter = ',', value_parser = time_s, allow_negative_numbers = true)]
    snapshots: Vec<f64>,
    /// Draw the deformed structure at this rate per second, as numbered pictures in the folder film.
    #[arg(long, value_name = "FPS", value_parser = film_rate_hz, allow_negative_numbers = true)]
    film: Option<f64>,
    /// Factor on the displacements in snapshots and film.
    #[arg(long, value_name = "K", value_parser = factor, allow_negative_numbers = true)]
    exaggerate: Option<f64>,
    /// Write position and rotation of every body to poses.csv.
    #[arg(long)]
    poses: bool,
    /// Also report how far this point moves, for example the crown: its position in the undeformed structure, in metres. May be
    /// given up to three times.
    #[arg(long = "point", value_name = "X,Y", value_parser = point_m, allow_hyphen_values = true)]
    points_m: Vec<Vector2<f64>>,
    /// The driver of the samples of [uncertain].
    #[command(flatten)]
    work: WorkOptions,
    #[command(flatten)]
    figure: FigureOption,
    /// Panels of history.svg: ground, rotation, joints, slip, points, energy, thrust [default: all that show something; below 100 mm
    /// of width ground, rotation and energy].
    #[arg(long, value_name = "P1,P2,...", value_delimiter = ',')]
    panels: Vec<Panel>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let style = Style::of(arguments.figure.get()?);
    let options = Options {
        run: arguments.options()?,
        ..Options::default()
    };
    let (mut files, mut wrong) = (Vec::new(), Vec::new());
    for path in &arguments.scenarios {
        files.extend(collect_input_error(
            arguments.read(path, &options.run),
            &mut wrong,
        )?);
    }
    let count: usize = files.iter().map(|file| file.tasks.len()).sum();
    if count > 1 && arguments.to_stdout() {
        return Err("--rotations - takes one scenario; run them one by one".into());
    }
    let roots = files
        .iter()
        .flat_map(|file| Some(&file.tasks).zip(file.destination.as_ref()));
    let places = roots.flat_map(|(tasks, root)| tasks.iter().map(|task| task.place(root)));
    collect_input_error(check_distinct(places), &mut wrong)?;
    check_no_errors(&wrong)?;
    let execution = Execution {
        kind: RUN,
        style,
        options,
        work: arguments.work,
        pictures: arguments.figure.figure_format,
        format: arguments.format,
        detail: arguments.details.get(),
        has_words_apart: arguments.to_stdout(),
    };
    execution.execute(files)
}

impl Arguments {
    /// Whether the rotations go to standard output.
    const fn to_stdout(&self) -> bool {
        self.rotations.is_some()
    }

    /// Whether files are written.
    const fn has_folder(&self) -> bool {
        self.out.is_some() || !(self.to_stdout() || matches!(self.format, Format::Json))
    }

    /// The options of a run.
    fn options(&self) -> Result<RunOptions, Failure> {
        if self.exaggerate.is_some() && self.snapshots.is_empty() && self.film.is_none() {
            return Err("--exaggerate goes with --snapshots or --film".into());
        }
        let writes = [
            (!self.snapshots.is_empty(), "--snapshots"),
            (self.film.is_some(), "--film"),
            (self.poses, "--poses"),
        ];
        let mut writes = writes.into_iter().filter(|(given, _)| *given);
        if let (Some((_, option)), false) = (writes.next(), self.has_folder()) {
            let message = format!("{option} writes a file: name a folder for it with --out");
            return Err(message.into());
        }
        Ok(RunOptions {
            no_rotations: self.to_stdout(),
            dimensionless: self.dimensionless,
            no_repeat: self.no_repeat,
            no_report: self.no_report,
            panels: self.panels.clone(),
            snapshots_s: self.snapshots.clone(),
            film_rate_hz: self.film,
            exaggeration: self.exaggerate,
            poses: self.poses,
            points_m: self.points_m.clone(),
        })
    }

    /// Reads the scenarios of a file.
    fn read(&self, path: &Path, options: &RunOptions) -> Result<FileTasks, Failure> {
        let input = self.set.open(path)?.in_direction(self.direction);
        let input = input.choosing(self.models.chosen());
        let models = self.models.read(&input)?;
        if models.len() > 1 && self.to_stdout() {
            return Err(input.input_error("--rotations - takes one model; choose with --hinges"));
        }
        if self.no_repeat && !models.iter().any(|one| one.motion.kind.is_repeated) {
            let message = "--no-repeat goes with free hinges and elastic joints: four links and columns are not repeated";
            return Err(input.input_error(message));
        }
        let origin = Origin::of(&models[0]);
        let destination = match &self.out {
            Some(out) if self.scenarios.len() > 1 => Destination::of(&out.join(input.stem())),
            out => input.results(out.as_deref()),
        };
        let check = |scenario: &Scenario| {
            scenario.check_for_run()?;
            check(scenario, options)
        };
        Ok(FileTasks {
            name: input.name(),
            tasks: self.suite.tasks(&input, models, check)?,
            origin,
            destination: self.has_folder().then_some(destination),
        })
    }
}

fn time_s(text: &str) -> Result<f64, String> {
    let remedy = "give times in seconds, such as 0.2,0.5,1.0";
    number(text, -1e9..=1e9, remedy)
}

fn film_rate_hz(text: &str) -> Result<f64, String> {
    let remedy = "give a number of pictures a second from 0.1 to 1000, such as 25";
    number(text, 0.1..=1e3, remedy)
}

fn factor(text: &str) -> Result<f64, String> {
    let remedy = "give a factor from 0.001 to 1000000, such as 10";
    number(text, 1e-3..=1e6, remedy)
}
