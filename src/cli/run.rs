//! The command `run`.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::Duration;

use archrock::output::Folder;
use archrock::scenario::{Scenario, shown_lines};
use archrock::studies::catalogue::{self, Options};
use archrock::studies::kept::{Origin, RUN};
use archrock::studies::results::{Results, Style};
use archrock::studies::run::{
    FILES, OVERLAY, Run, RunError, RunOptions, RunResults, Stage, compared, heading, overlay,
};
use nalgebra::Vector2;
use serde_json::Value;

use super::figure::{FigureOption, PanelsOption};
use super::models::ModelsOption;
use super::number::{number, point_m};
use super::progress::{Display, left};
use super::scenario_file::{Destination, Input, SetOption, SuiteOption};
use super::study::{ITSELF, Session, Work};
use super::{Failure, Format, noted, print, print_all, refused};

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
    /// Add dimensionless columns to the rotations: p_t (time), acceleration_over_incipient and
    /// rotation_over_critical. For four links and columns only.
    #[arg(long)]
    dimensionless: bool,
    #[command(flatten)]
    models: ModelsOption,
    /// Do not repeat a run with free hinges or elastic joints in other steps, nor elastic joints with other stiffness and contact.
    #[arg(long)]
    no_repeat: bool,
    /// Write no report.html.
    #[arg(long)]
    no_report: bool,
    /// Draw the deformed structure at these times, in seconds, to snapshots.svg; each shows the nearest row of the
    /// rotations.
    #[arg(long, value_name = "T1,T2,...", value_delimiter = ',', value_parser = time_s, allow_negative_numbers = true)]
    snapshots: Vec<f64>,
    /// Draw the deformed structure at this rate per second, as numbered pictures in the folder film.
    #[arg(long, value_name = "FPS", value_parser = a_second, allow_negative_numbers = true)]
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
    work: Work,
    #[command(flatten)]
    figure: FigureOption,
    #[command(flatten)]
    panels: PanelsOption,
}

pub fn run(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let mut jobs = Job::all(arguments)?;
    Job::lock_all(&mut jobs, arguments.work)?;
    let mut summaries = Vec::new();
    let mut failures = Vec::new();
    for job in &jobs {
        super::warn(&job.scenarios[0].unlikely());
        let results = match job.run(arguments) {
            Ok(results) => results,
            // The other scenarios are still run.
            Err(Failure::Work(message)) if jobs.len() > 1 => {
                job.place.iter().for_each(Destination::abandon);
                failures.push(format!("{}: {message}", job.name));
                continue;
            }
            Err(failure) => return Err(failure),
        };
        match arguments.format {
            Format::Json => summaries.push(results.summary),
            Format::Text if quiet => {}
            // Standard output carries the rotations and nothing else.
            Format::Text if arguments.to_stdout() => {
                // When standard error fails there is nowhere to report it.
                let _ = io::stderr().write_all(shown_lines(&results.words).as_bytes());
            }
            Format::Text => print(&results.words)?,
        }
    }
    if let Format::Json = arguments.format {
        print_all(summaries)?;
    }
    match failures.is_empty() {
        true => Ok(()),
        false => Err(Failure::Work(failures.join("\nerror: "))),
    }
}

/// A scenario to run.
struct Job {
    /// Its file, and the record of the suite.
    name: String,
    /// One for each chosen model of motion.
    scenarios: Vec<Scenario>,
    /// The scenario of its file, whose suite may name the record.
    origin: Rc<Origin>,
    /// The folder to lock, which may be around those of a suite's records.
    root: Option<Destination>,
    /// The folder for results; `None`: no files are written.
    place: Option<Destination>,
}

impl Job {
    /// All jobs, or all errors in them.
    fn all(arguments: &Arguments) -> Result<Vec<Self>, Failure> {
        let (mut jobs, mut wrong) = (Vec::<Self>::new(), Vec::new());
        for path in &arguments.scenarios {
            let read = noted(Self::read(path, arguments), &mut wrong)?;
            jobs.extend(read.into_iter().flatten());
        }
        if jobs.len() > 1 && arguments.to_stdout() {
            return Err("--rotations - is for one scenario: run them one by one".into());
        }
        let places = jobs.iter();
        let places = places.filter_map(|job| Some((&*job.name, job.place.as_ref()?)));
        noted(Destination::check_distinct(places), &mut wrong)?;
        refused(&wrong)?;
        Ok(jobs)
    }

    /// The scenario of a file, or one for each record of its suite.
    fn read(path: &Path, arguments: &Arguments) -> Result<Vec<Self>, Failure> {
        let input = arguments.set.open(path)?;
        let models = arguments.models.read(&input)?;
        let origin = Rc::new(Origin::of(&models[0]));
        let root = arguments.root(&input)?;
        let suite = arguments.suite;
        let tasks = suite.tasks(models, root.as_ref(), Scenario::check_for_run);
        let tasks = tasks.map_err(|failure| input.about(failure))?.into_iter();
        let file = path.display();
        let job = |(record, scenarios, place): (String, _, _)| Self {
            name: match record.is_empty() {
                true => file.to_string(),
                false => format!("{file}, {record}"),
            },
            scenarios,
            origin: Rc::clone(&origin),
            root: root.clone(),
            place,
        };
        Ok(tasks.map(job).collect())
    }

    /// Locks the folders of all jobs, before anything is written. The records of a suite share the lock of the folder around theirs.
    fn lock_all(jobs: &mut [Self], work: Work) -> Result<(), Failure> {
        let mut locked: Vec<Destination> = Vec::new();
        for job in jobs {
            let (Some(place), Some(root)) = (&mut job.place, job.root.take()) else {
                continue;
            };
            let known = locked.iter().find(|known| known.path() == root.path());
            let root = match known {
                Some(known) => known.clone(),
                None => work.lock(root, RUN, &job.origin)?,
            };
            *place = place.clone().locked_with(&root);
            locked.push(root);
        }
        Ok(())
    }

    /// Runs the job and returns its report.
    fn run(&self, arguments: &Arguments) -> Result<Results, Failure> {
        let style = Style::of(arguments.figure.get()?);
        let mut session = Session::new(None, arguments.work, style, Options::default());
        let scenarios = &self.scenarios;
        if session.is_part(scenarios)? {
            self.run_samples(&mut session, &mut Results::default())?;
            return Ok(Results::default());
        }
        let runs = self.prepared(arguments)?;
        let several = runs.len() > 1;
        let folder = self.place.as_ref().filter(|_| several);
        let folder = folder.map(|place| open(place, &[OVERLAY])).transpose()?;
        let mut own = Vec::new();
        for (run, scenario) in runs.iter().zip(scenarios) {
            let place = self.place.as_ref();
            let place = place.map(|place| place.of_model(scenario, several));
            own.push(arguments.compute(run, scenario, place.as_ref())?);
        }
        let name = |(one, own): (&Scenario, &RunResults<'_>)| {
            (one.motion.hinges().name().to_owned(), own.summary.clone())
        };
        let summaries = scenarios.iter().zip(&own).map(name);
        let mut results = Results {
            summary: match &own[..] {
                [only] => only.summary.clone(),
                _ => Value::Object(summaries.collect()),
            },
            ..Results::default()
        };
        let of_samples = self.run_samples(&mut session, &mut results)?;
        let heading = heading(&scenarios[0]);
        let ignored = scenarios.iter().find_map(Scenario::ignored);
        let ignored = ignored.map_or(String::new(), |ignored| format!("  {ignored}\n"));
        results.words.insert_str(0, &(heading + &ignored));
        for (model, own) in runs.iter().zip(&mut own) {
            let samples = of_samples.iter().find(|(name, _)| *name == model.name());
            own.complete(samples.map_or("", |(_, samples)| &samples.words))?;
        }
        if several {
            results.words += &compared(&own);
        }
        for (run, own) in runs.iter().zip(&own) {
            if several {
                let _ = writeln!(results.words, "{}", run.name());
            }
            let _ = write!(results.words, "  {}{}", own.verdict, own.words);
        }
        if let Some(mut folder) = folder {
            folder.write(OVERLAY, overlay(&own))?;
            let path = folder.path().join(OVERLAY);
            folder.complete()?;
            let all = if runs.len() > 2 { "all" } else { "both" };
            let _ = writeln!(results.words, "{all} in {}", path.display());
        }
        self.place
            .iter()
            .try_for_each(|place| session.publish(place))?;
        Ok(results)
    }

    /// Runs the samples of `[uncertain]`, and adds their results and the comparison of several models. Returns the results of each model;
    /// none without a folder.
    fn run_samples(
        &self,
        session: &mut Session<'_>,
        results: &mut Results,
    ) -> Result<Vec<(&'static str, Results)>, Failure> {
        let Some(place) = &self.place else {
            return Ok(Vec::new());
        };
        let models = session.add_samples(catalogue::UNCERTAIN, &self.scenarios, place, results)?;
        let title = self.scenarios[0].title.as_deref();
        if let Some(compared) = session.compare(title, &models, place)? {
            // After the words on samples, before the heading of those on the scenario itself.
            let at = results.words.len() - ITSELF.len();
            let words = format!("{}\n", compared.words);
            results.words.insert_str(at, &words);
            results.summary["peaks"] = compared.summary;
        }
        Ok(models)
    }

    /// The runs of all models. If one scenario cannot be run, none is.
    fn prepared(&self, arguments: &Arguments) -> Result<Vec<Run<'_>>, Failure> {
        let scenarios = &self.scenarios;
        if scenarios.len() > 1 && arguments.to_stdout() {
            return Err("--rotations - is for one model: choose one by --hinges".into());
        }
        let mut models = scenarios.iter().map(|one| one.motion.hinges());
        if arguments.no_repeat && !models.clone().any(|model| model.has_joints()) {
            let message = "--no-repeat goes with free hinges and elastic joints: four links and columns are not repeated";
            return Err(message.into());
        }
        let wanted = RunOptions {
            beside: models.by_ref().collect(),
            ..arguments.run_options()?
        };
        let run = |scenario| Run::new(scenario, wanted.clone());
        let runs: Result<Vec<_>, String> = scenarios.iter().map(run).collect();
        Ok(runs?)
    }
}

impl Arguments {
    /// Whether the rotations go to standard output.
    const fn to_stdout(&self) -> bool {
        self.rotations.is_some()
    }

    /// The options of a run.
    fn run_options(&self) -> Result<RunOptions, Failure> {
        if self.exaggerate.is_some() && self.snapshots.is_empty() && self.film.is_none() {
            return Err("--exaggerate goes with --snapshots or --film".into());
        }
        Ok(RunOptions {
            figure: self.panels.of(self.figure.get()?),
            rotations: !self.to_stdout(),
            dimensionless: self.dimensionless,
            repeat: !self.no_repeat,
            report: !self.no_report,
            snapshots_s: self.snapshots.clone(),
            film_a_second: self.film,
            exaggeration: self.exaggerate.unwrap_or(1.0),
            poses: self.poses,
            points_m: self.points_m.clone(),
            ..RunOptions::default()
        })
    }

    /// The folder for the results of a scenario file; `None`: no files are written.
    fn root(&self, input: &Input<'_>) -> Result<Option<Destination>, Failure> {
        let place = match &self.out {
            Some(out) if self.scenarios.len() > 1 => Destination::of(out).within(input.stem()),
            None if self.to_stdout() || matches!(self.format, Format::Json) => return Ok(None),
            out => input.results(out.as_deref())?,
        };
        Ok(Some(self.figure.printed(place)))
    }

    /// Runs a scenario and writes its results into a folder, if there is one.
    fn compute<'r>(
        &self,
        run: &'r Run<'r>,
        scenario: &Scenario,
        place: Option<&Destination>,
    ) -> Result<RunResults<'r>, Failure> {
        let writes = [
            (!self.snapshots.is_empty(), "--snapshots"),
            (self.film.is_some(), "--film"),
            (self.poses, "--poses"),
        ];
        let mut writes = writes.into_iter().filter(|(given, _)| *given);
        if let (Some((_, option)), None) = (writes.next(), place) {
            let message = format!("{option} writes a file: name a folder for it with --out");
            return Err(message.into());
        }
        // Opened before the work starts, so that a folder that cannot be written costs no time.
        let folder = place.map(|place| open(place, &run.files())).transpose()?;
        let stdout = || -> Box<dyn io::Write> { Box::new(BufWriter::new(io::stdout().lock())) };
        let rotations = self.to_stdout().then(stdout);
        let (mut display, end_s) = (Display::new(PATIENCE), scenario.request().end_s);
        Ok(run.compute(folder, rotations, &mut |stage| match stage {
            Stage::Reached(time_s) => display.show(time_s / end_s, |elapsed| {
                let left = left(time_s / end_s, elapsed);
                format!("{time_s:.2} of {end_s} s simulated, {left} left")
            }),
            Stage::Repeating => {
                display.show(1.0, |_| "repeating the history with other steps".to_owned());
            }
        })?)
    }
}

/// A shorter run shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// Opens a folder for these files. Other files that earlier runs left there are removed once these are complete.
fn open(place: &Destination, names: &[&'static str]) -> Result<Folder, Failure> {
    let mut folder = place.open(names)?;
    for name in FILES.iter().filter(|name| !names.contains(name)) {
        folder.forget(name);
    }
    Ok(folder)
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Simulation(error) => error.into(),
            RunError::Output(error) => error.into(),
        }
    }
}

fn time_s(text: &str) -> Result<f64, String> {
    let remedy = "give times in seconds, such as 0.2,0.5,1.0";
    number(text, -1e9..=1e9, remedy)
}

fn a_second(text: &str) -> Result<f64, String> {
    let remedy = "give a number of pictures a second from 0.1 to 1000, such as 25";
    number(text, 0.1..=1e3, remedy)
}

fn factor(text: &str) -> Result<f64, String> {
    let remedy = "give a factor from 0.001 to 1000000, such as 10";
    number(text, 1e-3..=1e6, remedy)
}
