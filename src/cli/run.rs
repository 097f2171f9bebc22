//! The command `run`.

mod progress;

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use archrock::output::Folder;
use archrock::scenario::{Scenario, shown_lines};
use archrock::studies::catalogue::{self, Options};
use archrock::studies::results::{Results, Style};
use archrock::studies::run::{
    FILES, OVERLAY, Run, RunError, RunOptions, RunResults, compared, heading, overlay,
};
use nalgebra::Vector2;
use serde_json::Map;

use self::progress::RunProgress;
use super::figure::{FigureOption, PanelsOption};
use super::models::ModelsOption;
use super::number::{number, point_m};
use super::scenario_file::{Destination, Input, SetOption, SuiteOption};
use super::studies::compare;
use super::study::{ITSELF, Pending, Session, Work};
use super::{Failure, Format, print, print_all};
use archrock::studies::kept::{Origin, RUN};

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
    /// How the samples of [uncertain] are computed.
    #[command(flatten)]
    work: Work,
    #[command(flatten)]
    figure: FigureOption,
    #[command(flatten)]
    panels: PanelsOption,
}

pub fn run(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let mut jobs = Job::all(arguments)?;
    Job::lock_all(&mut jobs, arguments)?;
    let mut summaries = Vec::new();
    let mut failures = Vec::new();
    for job in &jobs {
        super::warn(&job.scenarios[0].unlikely());
        let results = match job.run(arguments, quiet) {
            Ok(results) => results,
            // The other scenarios are still run.
            Err(Failure::Work(message)) if jobs.len() > 1 => {
                job.place.results.iter().for_each(Destination::abandon);
                failures.push(format!("{}: {message}", job.name));
                continue;
            }
            Err(failure) => return Err(failure),
        };
        match arguments.format {
            Format::Json => summaries.push(results.summary),
            Format::Text if quiet => {}
            // Standard output carries the rotations and nothing else.
            Format::Text if job.place.to_stdout => {
                // When standard error fails there is nowhere to report it.
                let _ = io::stderr().write_all(shown_lines(&results.words).as_bytes());
            }
            Format::Text => print(&results.words)?,
        }
    }
    if let Format::Json = arguments.format {
        print_all(summaries)?;
    }
    if failures.is_empty() {
        Ok(())
    } else {
        Err(Failure::Work(failures.join("\nerror: ")))
    }
}

/// A scenario to run.
struct Job {
    /// Its file.
    name: String,
    /// One for each chosen model of motion.
    scenarios: Vec<Scenario>,
    /// The scenario of its file, whose suite may name the record.
    origin: Rc<Origin>,
    place: Place,
}

impl Job {
    /// All jobs, or all errors in them.
    fn all(arguments: &Arguments) -> Result<Vec<Self>, Failure> {
        let mut jobs: Vec<Self> = Vec::new();
        let mut wrong = Vec::new();
        for path in &arguments.scenarios {
            match Self::read(path, arguments) {
                Ok(read) => jobs.extend(read),
                Err(Failure::Input(message)) => wrong.push(message),
                Err(failure) => return Err(failure),
            }
        }
        if jobs.len() > 1 && arguments.rotations.is_some() {
            let message = "--rotations - is for one scenario: run them one by one";
            return Err(Failure::Input(message.to_owned()));
        }
        let places = jobs
            .iter()
            .filter_map(|job| Some((job.name.as_str(), job.place.results.as_ref()?)));
        if let Err(Failure::Input(message)) = Destination::check_distinct(places) {
            wrong.push(message);
        }
        if wrong.is_empty() {
            Ok(jobs)
        } else {
            Err(Failure::Input(wrong.join("\n")))
        }
    }

    /// The scenario of a file, or one for each record of its suite.
    fn read(path: &Path, arguments: &Arguments) -> Result<Vec<Self>, Failure> {
        let input = arguments.set.open(path)?;
        let models = arguments.models.read(&input)?;
        let about = |failure| input.about(failure);
        let origin = Rc::new(Origin::of(&models[0]));
        let chosen = arguments.suite.choose(models).map_err(about)?;
        let jobs = chosen.into_iter().map(|(record, scenarios)| {
            scenarios[0]
                .check_for_run()
                .map_err(|reason| about(Failure::Input(reason)))?;
            let file = path.display();
            Ok(Self {
                name: match &record {
                    Some(record) => format!("{file}, {record}"),
                    None => file.to_string(),
                },
                place: Place::of(arguments, &input, record.as_deref())?,
                origin: Rc::clone(&origin),
                scenarios,
            })
        });
        jobs.collect()
    }

    /// Locks the folders of all jobs, before anything is written. The records of a suite share the lock of the folder around theirs.
    fn lock_all(jobs: &mut [Self], arguments: &Arguments) -> Result<(), Failure> {
        let mut locked: Vec<Destination> = Vec::new();
        for job in jobs {
            let (Some(results), Some(root)) = (&mut job.place.results, job.place.root.take())
            else {
                continue;
            };
            let known = locked.iter().find(|known| known.path() == root.path());
            let root = match known {
                Some(known) => known.clone(),
                None if arguments.work.is_part() => root.locked_for_a_part(RUN)?,
                None => root.locked_for(RUN, &job.origin)?,
            };
            *results = results.clone().locked_with(&root);
            locked.push(root);
        }
        Ok(())
    }

    /// Runs the job and returns its report.
    fn run(&self, arguments: &Arguments, quiet: bool) -> Result<Results, Failure> {
        let session = Session {
            input: None,
            work: arguments.work,
            style: Style::of(arguments.figure.get()?),
        };
        let (scenarios, mut pending) = (&self.scenarios, Pending::default());
        if session.is_part(scenarios)? {
            if let Some(place) = &self.place.results {
                self.run_samples(session, place, &mut pending, &mut Results::default())?;
            }
            return Ok(Results::default());
        }
        let runs = self.prepared(arguments)?;
        let several = runs.len() > 1;
        let folder = if several {
            self.place.open(&[OVERLAY])?
        } else {
            None
        };
        let (mut own, mut summaries) = (Vec::new(), Map::new());
        for (run, scenario) in runs.iter().zip(scenarios) {
            let name = scenario.motion().hinges().name();
            let inside = several.then(|| self.place.within(name));
            let place = inside.as_ref().unwrap_or(&self.place);
            let computed = place.run(run, scenario, quiet)?;
            summaries.insert(name.to_owned(), computed.summary.clone());
            own.push(computed);
        }
        let mut results = Results {
            summary: if several {
                summaries.into()
            } else {
                own[0].summary.clone()
            },
            ..Results::default()
        };
        let mut of_samples = Vec::new();
        if let Some(place) = &self.place.results {
            of_samples = self.run_samples(session, place, &mut pending, &mut results)?;
        }
        let heading = heading(&scenarios[0]);
        results.words.insert_str(0, &heading);
        if let Some(ignored) = scenarios.iter().find_map(Scenario::ignored) {
            results
                .words
                .insert_str(heading.len(), &format!("  {ignored}\n"));
        }
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
            folder
                .file(OVERLAY)
                .write_all(overlay(&own).as_bytes())
                .map_err(|error| Failure::Work(format!("cannot write the picture: {error}")))?;
            let path = folder.path().join(OVERLAY);
            folder.complete()?;
            let all = if runs.len() > 2 { "all" } else { "both" };
            let _ = writeln!(results.words, "{all} in {}", path.display());
        }
        if let Some(place) = &self.place.results {
            pending.publish(place)?;
        }
        Ok(results)
    }

    /// Runs the samples of `[uncertain]`, and adds their results and the comparison of several models. Returns the results of each model.
    fn run_samples(
        &self,
        session: Session<'_>,
        place: &Destination,
        pending: &mut Pending,
        results: &mut Results,
    ) -> Result<Vec<(&'static str, Results)>, Failure> {
        let (kind, options) = (catalogue::UNCERTAIN, Options::default());
        let models =
            session.add_samples(kind, &self.scenarios, &options, place, pending, results)?;
        let title = self.scenarios[0].title();
        if let Some(compared) = compare(title, &models, place, session.style.figure)? {
            // After the words on samples, before the heading of those on the scenario itself.
            let at = results.words.len() - ITSELF.len();
            results
                .words
                .insert_str(at, &format!("{}\n", compared.words));
            results.summary["peaks"] = compared.summary;
        }
        Ok(models)
    }

    /// The runs of all models. If one scenario cannot be run, none is.
    fn prepared(&self, arguments: &Arguments) -> Result<Vec<Run<'_>>, Failure> {
        let (scenarios, to_stdout) = (&self.scenarios, self.place.to_stdout);
        if scenarios.len() > 1 && to_stdout {
            let message = "--rotations - is for one model: choose one by --hinges";
            return Err(Failure::Input(message.to_owned()));
        }
        let in_steps = |one: &Scenario| one.motion().hinges().has_joints();
        if arguments.no_repeat && !scenarios.iter().any(in_steps) {
            let message = "--no-repeat goes with free hinges and elastic joints: four links and columns are not repeated";
            return Err(Failure::Input(message.to_owned()));
        }
        let beside = scenarios.iter().map(|one| one.motion().hinges());
        let wanted = RunOptions {
            beside: beside.collect(),
            ..arguments.run_options(to_stdout)?
        };
        let run = |scenario| Run::new(scenario, wanted.clone());
        let runs: Result<Vec<_>, String> = scenarios.iter().map(run).collect();
        runs.map_err(Failure::Input)
    }
}

impl Arguments {
    /// The options of a run.
    fn run_options(&self, to_stdout: bool) -> Result<RunOptions, Failure> {
        if self.exaggerate.is_some() && self.snapshots.is_empty() && self.film.is_none() {
            let message = "--exaggerate goes with --snapshots or --film";
            return Err(Failure::Input(message.to_owned()));
        }
        Ok(RunOptions {
            figure: self.panels.of(self.figure.get()?),
            rotations: !to_stdout,
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

    /// The name of a given option that writes a file.
    fn of_files(&self) -> Option<&'static str> {
        let options = [
            (!self.snapshots.is_empty(), "--snapshots"),
            (self.film.is_some(), "--film"),
            (self.poses, "--poses"),
        ];
        let given = options.into_iter().find(|(given, _)| *given);
        given.map(|(_, option)| option)
    }
}

/// The place of results: a folder, standard output, or both.
struct Place {
    /// The folder; `None`: no files are written.
    results: Option<Destination>,
    /// Folder to lock, which may be around those of a suite's records; `None` once it is locked.
    root: Option<Destination>,
    /// True: the rotations go to standard output.
    to_stdout: bool,
    /// The name of an option that needs a folder.
    of_files: Option<&'static str>,
}

impl Place {
    fn of(arguments: &Arguments, input: &Input<'_>, record: Option<&str>) -> Result<Self, Failure> {
        let to_stdout = arguments.rotations.is_some();
        let results = match &arguments.out {
            Some(out) if arguments.scenarios.len() > 1 => {
                Some(Destination::of(out).within(input.stem()))
            }
            None if to_stdout || matches!(arguments.format, Format::Json) => None,
            out => Some(input.results(out.as_deref())?),
        };
        let root = results.clone();
        let results = match (results, record) {
            (Some(results), Some(record)) => Some(results.of_record(record)?),
            (results, _) => results,
        };
        Ok(Self {
            root,
            results: results.map(|results| arguments.figure.printed(results)),
            to_stdout,
            of_files: arguments.of_files(),
        })
    }

    /// The folder inside this one for one of several models.
    fn within(&self, name: &str) -> Self {
        Self {
            results: self.results.as_ref().map(|results| results.within(name)),
            root: None,
            ..*self
        }
    }

    /// Opens the folder for these files. Other files that earlier runs left there are removed once these are complete.
    fn open(&self, names: &[&'static str]) -> Result<Option<Folder>, Failure> {
        let Some(results) = &self.results else {
            return Ok(None);
        };
        let mut folder = results.open(names)?;
        for name in FILES.iter().filter(|name| !names.contains(name)) {
            folder.forget(name);
        }
        Ok(Some(folder))
    }

    /// Runs a scenario and writes its results here.
    fn run<'r>(
        &self,
        run: &'r Run<'r>,
        scenario: &Scenario,
        quiet: bool,
    ) -> Result<RunResults<'r>, Failure> {
        if let (None, Some(option)) = (&self.results, self.of_files) {
            let message = format!("{option} writes a file: name a folder for it with --out");
            return Err(Failure::Input(message));
        }
        // Opened before the work starts, so that a folder that cannot be written costs no time.
        let folder = self.open(&run.files())?;
        let stdout = || -> Box<dyn io::Write> { Box::new(BufWriter::new(io::stdout().lock())) };
        let rotations = self.to_stdout.then(stdout);
        let progress = RunProgress::new(scenario.request().end_s, quiet);
        let results = run.compute(folder, rotations, &mut |stage| progress.show(stage))?;
        Ok(results)
    }
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
    number(
        text,
        -1e9..=1e9,
        "give times in seconds, such as 0.2,0.5,1.0",
    )
}

fn a_second(text: &str) -> Result<f64, String> {
    let remedy = "give a number of pictures a second from 0.1 to 1000, such as 25";
    number(text, 0.1..=1e3, remedy)
}

fn factor(text: &str) -> Result<f64, String> {
    let remedy = "give a factor from 0.001 to 1000000, such as 10";
    number(text, 1e-3..=1e6, remedy)
}
