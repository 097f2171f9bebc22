//! The command `run`.

mod extras;
mod free_hinges;
mod progress;

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use archrock::dynamics::ground::GroundMotion;
use archrock::dynamics::history::{Event, Outcome, Sample, Summary};
use archrock::dynamics::model::{MechanismModel, Model, Recorder};
use archrock::dynamics::thrust::{EXCESS_LEVELS, Peak, ThrustRecord};
use archrock::mechanics::sway::Sway;
use archrock::output::mechanisms;
use archrock::output::overlay::{self, Curves};
use archrock::output::pretty;
use archrock::output::results::{self, EventsWriter};
use archrock::output::rotations::{RotationsWriter, Scales};
use archrock::output::scene::Scene;
use archrock::output::timeline::Timeline;
use archrock::output::{Figure, Folder, OutputError, Subject};
use archrock::scenario::{Ground, Hinges, Scenario, Series, Structure, shown_lines};
use clap::ValueEnum;
use serde_json::{Value, json};

use self::extras::{Extras, File, POSES, PosesTable};
use super::check::sampling_in_words;
use super::figure::FigureOption;
use super::scenario_file::{Destination, Input, SetOption, SuiteOption};
use super::{Failure, Format, commands, print};

#[derive(clap::Args)]
pub struct Arguments {
    /// Scenario files (TOML); `-` for standard input.
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    suite: SuiteOption,
    /// Folder for the results, or for the folders of several scenarios [default: results/<name of the scenario
    /// file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Where the rotations go instead of a file: `-` for standard output. No other results are then
    /// written unless --out is given.
    #[arg(long, value_name = "-", value_parser = ["-"])]
    rotations: Option<String>,
    /// How the summary is printed; as JSON, which is that of summary.json, files are written with --out only. Of
    /// several scenarios it is an array.
    #[arg(long, value_enum, default_value_t, conflicts_with = "rotations")]
    format: Format,
    /// Add dimensionless columns to the rotations: p_t (time), acceleration_over_incipient and
    /// rotation_over_critical. For four links and columns only.
    #[arg(long)]
    dimensionless: bool,
    /// Model of motion [default: free if the scenario has [free_hinges], else four].
    #[arg(long, value_enum)]
    hinges: Option<Models>,
    /// Do not repeat a run with free hinges with half and with double steps.
    #[arg(long)]
    no_spread: bool,
    #[command(flatten)]
    extras: extras::Options,
    #[command(flatten)]
    figure: FigureOption,
}

/// Models of motion.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Models {
    /// Four links, or Housner's column.
    Four,
    /// Blocks whose joints open and shut anywhere.
    Free,
    /// Both: results in the folders `four` and `free`, and a picture of both.
    Both,
}

const ROTATIONS: &str = "rotations.csv";
const JOINTS: &str = "joints.csv";
const EVENTS: &str = "events.csv";
const PICTURE: &str = "history.svg";
const IMPACTS: &str = "impacts.csv";
/// Written last: a folder that has it is complete.
const SUMMARY: &str = "summary.json";
/// Two models of motion in one picture.
const OVERLAY: &str = "overlay.svg";

pub fn run(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let jobs = Job::all(arguments)?;
    let mut summaries = Vec::new();
    let mut failures = Vec::new();
    for job in &jobs {
        if !quiet {
            super::warn(&job.scenarios[0].unlikely());
        }
        let told = match job.run(arguments, quiet) {
            Ok(told) => told,
            // The others are run all the same.
            Err(Failure::Work(message)) if jobs.len() > 1 => {
                failures.push(format!("{}: {message}", job.name));
                continue;
            }
            Err(failure) => return Err(failure),
        };
        match arguments.format {
            Format::Json => summaries.push(told.summary),
            Format::Text if quiet => {}
            // What the rotations are read from gets nothing else.
            Format::Text if job.place.to_stdout => {
                // Nobody is left to be told when standard error fails.
                let _ = io::stderr().write_all(shown_lines(&told.text).as_bytes());
            }
            Format::Text => print(&told.text)?,
        }
    }
    if let Format::Json = arguments.format {
        let only = (jobs.len() == 1).then(|| summaries.pop()).flatten();
        print(&pretty(&only.unwrap_or(Value::Array(summaries))))?;
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
    /// Once for each model of motion that is asked for.
    scenarios: Vec<Scenario>,
    place: Place,
}

impl Job {
    /// All that are asked for, or all that is wrong with them.
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

    /// The scenario of a file, or what its records make of it.
    fn read(path: &Path, arguments: &Arguments) -> Result<Vec<Self>, Failure> {
        let input = arguments.set.open(path)?;
        let models = Models::read(arguments.hinges, &input)?;
        let about = |failure| input.about(failure);
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
                scenarios,
            })
        });
        jobs.collect()
    }

    /// Runs it, and says what happened.
    fn run(&self, arguments: &Arguments, quiet: bool) -> Result<Told, Failure> {
        let (scenario, place) = (&self.scenarios[0], &self.place);
        let title = scenario.title();
        let mut text = title.map_or(String::new(), |title| format!("{title}\n"));
        text += &records(scenario);
        if let Some(ignored) = self.scenarios.iter().find_map(Scenario::ignored) {
            let _ = writeln!(text, "  {ignored}");
        }
        let told = match (&self.scenarios[..], scenario.motion().row()) {
            ([four, free], _) => both(four, free, place, arguments, quiet)?,
            (_, Some(_)) => free_hinges::run(scenario, place, arguments.options(quiet)?, None)?,
            (_, None) => {
                if arguments.no_spread {
                    let message = "--no-spread goes with free hinges: four links and columns are not repeated";
                    return Err(Failure::Input(message.to_owned()));
                }
                four_links(scenario, place, arguments.dimensionless, None)?
            }
        };
        Ok(Told {
            text: text + &told.text,
            summary: told.summary,
        })
    }
}

/// The records that shake a scenario, a line each.
fn records(scenario: &Scenario) -> String {
    let Some(Ground::Record(record)) = scenario.ground() else {
        return String::new();
    };
    let line = |series: &Series| {
        let (file, sampling) = (series.name(), sampling_in_words(&series.sampling()));
        let peak_g = series.peak_g(scenario.gravity_m_s2());
        format!("  {file}: {sampling}, peak {peak_g:.4} g as scaled\n")
    };
    record.series().map(line).collect()
}

/// What a run says.
struct Told {
    /// For people.
    text: String,
    /// What `summary.json` has.
    summary: Value,
}

impl Models {
    /// Reads a scenario for each model that is asked for, or for the one that it chooses.
    pub fn read(asked: Option<Self>, input: &Input<'_>) -> Result<Vec<Scenario>, Failure> {
        let models: &[Option<Hinges>] = match asked {
            None => &[None],
            Some(Self::Four) => &[Some(Hinges::Four)],
            Some(Self::Free) => &[Some(Hinges::Free)],
            Some(Self::Both) => &[Some(Hinges::Four), Some(Hinges::Free)],
        };
        models.iter().map(|hinges| input.read(*hinges)).collect()
    }
}

impl Arguments {
    /// What concerns free hinges, or why it does not go with them.
    fn options(&self, quiet: bool) -> Result<free_hinges::Options, Failure> {
        if self.dimensionless {
            let message = "--dimensionless goes with four links and columns: free hinges have no unstable \
                           equilibrium to measure by";
            return Err(Failure::Input(message.to_owned()));
        }
        Ok(free_hinges::Options {
            spread: !self.no_spread,
            quiet,
        })
    }
}

/// Where results go.
struct Place {
    /// The folder, if there are to be files.
    results: Option<Destination>,
    /// Whether the rotations go to standard output.
    to_stdout: bool,
    /// What is written beside the tables.
    extras: extras::Options,
    figure: Figure,
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
        let results = match (results, record) {
            (Some(results), Some(record)) => Some(results.of_record(record)?),
            (results, _) => results,
        };
        Ok(Self {
            results,
            to_stdout,
            extras: arguments.extras.clone(),
            figure: arguments.figure.get(),
        })
    }

    /// A folder in that one.
    fn within(&self, name: &str) -> Self {
        Self {
            results: self.results.as_ref().map(|results| results.within(name)),
            to_stdout: false,
            extras: self.extras.clone(),
            figure: self.figure,
        }
    }

    /// The files for these results: before them the rotations unless they go elsewhere, and what else is asked for.
    fn files(&self, names: &[&'static str]) -> Vec<&'static str> {
        let rotations = (!self.to_stdout).then_some(ROTATIONS);
        let first = rotations.into_iter().chain(self.extras.files());
        first.chain(names.iter().copied()).collect()
    }

    /// Opens the folder for [`Place::files`]. Others that earlier runs may have left there go when these are complete.
    fn open(&self, names: &[&'static str]) -> Result<Option<Folder>, Failure> {
        let Some(results) = &self.results else {
            self.extras.check_folder()?;
            return Ok(None);
        };
        let all = self.files(names);
        let mut folder = results.open(&all)?;
        for name in [ROTATIONS, JOINTS, OVERLAY]
            .iter()
            .chain(&extras::Options::FILES)
        {
            if !all.contains(name) {
                folder.forget(name);
            }
        }
        Ok(Some(folder))
    }

    /// Where rotations go that do not go to a file.
    fn elsewhere<'a>(&self) -> Box<dyn io::Write + 'a> {
        if self.to_stdout {
            Box::new(BufWriter::new(io::stdout().lock()))
        } else {
            Box::new(io::sink())
        }
    }
}

/// Runs both models and draws them in one picture.
fn both(
    four: &Scenario,
    free: &Scenario,
    place: &Place,
    arguments: &Arguments,
    quiet: bool,
) -> Result<Told, Failure> {
    if arguments.rotations.is_some() {
        let message = "--rotations - is for one model: choose --hinges four or --hinges free";
        return Err(Failure::Input(message.to_owned()));
    }
    let options = arguments.options(quiet)?;
    // Neither is run where the other cannot be.
    let models = (commands::model(four)?, free_hinges::model(free)?);
    let mut folder = match &place.results {
        Some(results) => Some(results.open(&[OVERLAY])?),
        None => None,
    };
    let mut curves = [Curves::new(), Curves::new()];
    let [of_four, of_free] = &mut curves;
    let of_four = four_links(four, &place.within("four"), false, Some(of_four))?;
    let of_free = free_hinges::run(free, &place.within("free"), options, Some(of_free))?;
    let mut text = format!("four links\n{}free hinges\n{}", of_four.text, of_free.text);
    if let Some(mut folder) = folder.take() {
        let own = [SUMMARY, ROTATIONS, JOINTS, EVENTS, IMPACTS, PICTURE];
        for name in own.iter().chain(&extras::Options::FILES) {
            folder.forget(name);
        }
        let title = four.title().unwrap_or("Four links and free hinges");
        let [of_four, of_free] = &curves;
        let named = [("four links", of_four), ("free hinges", of_free)];
        let subject = subject(four, &*models.0, title);
        let picture = overlay::draw(place.figure, &subject, &named);
        folder
            .file(OVERLAY)
            .write_all(picture.as_bytes())
            .map_err(cannot_write("the picture"))?;
        let path = folder.path().join(OVERLAY);
        folder.complete()?;
        let _ = writeln!(text, "both in {}", path.display());
    }
    let summary = json!({ "four": of_four.summary, "free": of_free.summary });
    Ok(Told { text, summary })
}

fn cannot_write(what: &str) -> impl FnOnce(io::Error) -> Failure {
    move |error| Failure::Work(format!("cannot write {what}: {error}"))
}

/// Runs four links or a column, and says what happened.
fn four_links(
    scenario: &Scenario,
    place: &Place,
    dimensionless: bool,
    curves: Option<&mut Curves>,
) -> Result<Told, Failure> {
    let model = commands::model(scenario)?;
    let ground = scenario.ground_motion();
    let gravity_m_s2 = scenario.gravity_m_s2();
    let scales = dimensionless
        .then(|| {
            Scales::new(&*model, gravity_m_s2).ok_or_else(|| {
                Failure::Input(
                    "the mechanism has no unstable equilibrium to measure by: leave --dimensionless out"
                        .to_owned(),
                )
            })
        })
        .transpose()?;
    // Opened before the work starts, so that a folder that cannot be written costs no time.
    let mut folder = place.open(&[EVENTS, IMPACTS, PICTURE, SUMMARY])?;
    let bodies = model.bodies();
    let mut timeline = Timeline::new(&bodies);
    let scene = Scene::new(scenario.structure());
    let mut extras = Extras::new(
        &place.extras,
        folder.as_ref(),
        &scene,
        &bodies,
        gravity_m_s2,
    );
    let mut events = Vec::new();
    let (summary, rows) = {
        let (mut rotations, mut poses): (Option<File<'_>>, Option<File<'_>>) = (None, None);
        for (name, file) in folder.iter_mut().flat_map(Folder::files) {
            match name {
                ROTATIONS => rotations = Some(Box::new(file)),
                POSES => poses = Some(Box::new(file)),
                _ => {}
            }
        }
        let rotations = rotations.unwrap_or_else(|| place.elsewhere());
        let mut results = Results {
            table: RotationsWriter::new(rotations, &bodies, ground.has_vertical(), scales)?,
            poses: PosesTable::new(poses, &bodies)?,
            timeline: &mut timeline,
            extras: &mut extras,
            events: &mut events,
            curves,
            written: Ok(()),
        };
        let summary = model.simulate(ground, &scenario.request(), Some(&mut results))?;
        results.written?;
        results.poses.finish()?;
        (summary, results.table.finish()?)
    };
    let mut text = human_summary(scenario, &*model, ground, &summary, &events);
    let json = results::summary(scenario, &*model, ground, &summary)?;
    if let Some(mut folder) = folder {
        let mut table = EventsWriter::of_mechanisms(folder.file(EVENTS), &*model)?;
        for event in &events {
            table.write(event)?;
        }
        table.finish()?;
        results::write_impacts(folder.file(IMPACTS), &*model, &events)?;
        let title = scenario.title().unwrap_or("Rocking history");
        let subject = subject(scenario, &*model, title);
        let picture = timeline.draw(place.figure, &subject, &events, &summary);
        folder
            .file(PICTURE)
            .write_all(picture.as_bytes())
            .map_err(cannot_write("the picture"))?;
        extras.write(&mut folder, scenario, (place.figure, title), &mut text)?;
        folder
            .file(SUMMARY)
            .write_all(pretty(&json).as_bytes())
            .map_err(cannot_write("the summary"))?;
        let path = folder.path().to_owned();
        folder.complete()?;
        text += &written(&path, place, rows, &[EVENTS, IMPACTS, PICTURE, SUMMARY]);
    }
    Ok(Told {
        text,
        summary: json,
    })
}

/// What a history is of.
fn subject<'a>(
    scenario: &'a Scenario,
    model: &(impl Model + ?Sized),
    title: &'a str,
) -> Subject<'a> {
    Subject {
        title,
        ground: scenario.ground_motion(),
        gravity_m_s2: scenario.gravity_m_s2(),
        incipient_g: [Sway::Right, Sway::Left].map(|sway| model.incipient_acceleration_g(sway)),
    }
}

/// Says which files there are.
fn written(path: &Path, place: &Place, rows: u64, names: &[&'static str]) -> String {
    let names = place.files(names).into_iter().map(|name| match name {
        ROTATIONS => format!("{ROTATIONS} ({rows} rows)"),
        name => name.to_owned(),
    });
    let (path, names) = (path.display(), names.collect::<Vec<_>>().join(", "));
    format!("  results in {path}: {names}\n")
}

/// Where samples and events go.
struct Results<'a, W: io::Write> {
    table: RotationsWriter<W>,
    timeline: &'a mut Timeline,
    poses: PosesTable<'a>,
    extras: &'a mut Extras,
    events: &'a mut Vec<Event>,
    curves: Option<&'a mut Curves>,
    /// Why the table could not be written, which ends the history.
    written: Result<(), OutputError>,
}

impl<W: io::Write> Recorder for Results<'_, W> {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.timeline.push(sample);
        self.extras.push(sample);
        if let Some(curves) = &mut self.curves {
            curves.push(sample);
        }
        self.written = self
            .table
            .write(sample)
            .and_then(|()| self.poses.write(sample));
        match self.written {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    }

    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        self.events.push(event.clone());
        ControlFlow::Continue(())
    }

    fn wants_thrust_line(&self) -> bool {
        self.extras.want_thrust_line()
    }
}

/// What happened, when, and what it compares with.
fn human_summary(
    scenario: &Scenario,
    model: &dyn MechanismModel,
    ground: &GroundMotion,
    history: &Summary,
    events: &[Event],
) -> String {
    let mut text = outcome(history);
    let first = events
        .iter()
        .find_map(|event| Some((event.time_s, event.impact.as_ref()?)));
    if let Some((time_s, impact)) = first {
        let _ = writeln!(
            text,
            "  first impact at {time_s:.4} s, restitution (energy after/before) {:.4}",
            impact.restitution,
        );
    }
    if history.outcome != Outcome::NeverMoved {
        let _ = writeln!(
            text,
            "  peak rotation in rad: {}",
            mechanisms::by_body(&model.bodies(), &history.peak_rotations_rad),
        );
        let unstable = "the unstable rotation of the mechanism that moved";
        let _ = match (history.outcome, history.peak_over_critical) {
            // How far it fell on until the run ended says nothing.
            (Outcome::Overturned(_), Some(_)) => writeln!(text, "  passed {unstable}"),
            (_, Some(peak)) => {
                // Rounded down, so that what was not reached is not said to be.
                let percent = (1e3 * peak).floor() / 10.0;
                writeln!(text, "  reached {percent:.1} % of {unstable}")
            }
            (_, None) => Ok(()),
        };
        let _ = writeln!(
            text,
            "  energy defect {:.1e} of the first mechanism's barrier, {} steps, {} evaluations",
            history.energy_defect_ratio, history.cost.steps, history.cost.evaluations
        );
    }
    text += &incipient(scenario, model, ground, history);
    text += &cut_short(scenario, ground, history);
    if let Some(thrust) = &history.thrust {
        text += &trust(thrust, scenario.structure());
    }
    text
}

/// How it ended.
fn outcome(history: &Summary) -> String {
    let time_s = history.outcome_time_s;
    let impacts = match history.impacts {
        0 => "without impact".to_owned(),
        1 => "after 1 impact".to_owned(),
        count => format!("after {count} impacts"),
    };
    match history.outcome {
        Outcome::NeverMoved => "  never moved\n".to_owned(),
        Outcome::Rest => format!("  came to rest at {time_s:.4} s {impacts}\n"),
        Outcome::Overturned(sway) => {
            let sway = sway.name();
            format!("  overturned to the {sway} at {time_s:.4} s {impacts}\n")
        }
        Outcome::StillRocking => format!("  still rocking at {time_s:.4} s {impacts}\n"),
    }
}

/// What starts the structure to either side, beside what the ground reaches.
fn incipient<M: Model + ?Sized>(
    scenario: &Scenario,
    model: &M,
    ground: &GroundMotion,
    history: &Summary,
) -> String {
    let sides = [Sway::Right, Sway::Left].map(|sway| model.incipient_acceleration_g(sway));
    let least_g = sides
        .iter()
        .flatten()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let (reaches, uneven) = (
        reaches(scenario, ground, history, least_g),
        "the smaller one",
    );
    let options = scenario.motion().row().unwrap_or_default();
    let incipient = match options.friction_coefficient {
        None => "incipient acceleration A_L",
        Some(_) => "incipient acceleration with friction",
    };
    match sides {
        [Some(right), Some(left)] if (right - left).abs() > 1e-9 * right => format!(
            "  {incipient} {right:.4} g to the right, {left:.4} g to the left; the ground {}\n",
            reaches.replacen("times as much", &format!("times {uneven}"), 1)
        ),
        [None, None] => {
            format!("  {incipient} none, no push starts it; the ground {reaches}\n")
        }
        _ => format!("  {incipient} {least_g:.4} g; the ground {reaches}\n"),
    }
}

/// What the ground reaches, beside what starts the structure.
fn reaches(
    scenario: &Scenario,
    ground: &GroundMotion,
    history: &Summary,
    incipient_g: f64,
) -> String {
    let peaks_g = ground.peaks_m_s2(history.end_s) / scenario.gravity_m_s2();
    let mut reaches = if peaks_g.x > 0.0 {
        format!(
            "reaches {:.4} g, {:.2} times as much",
            peaks_g.x,
            peaks_g.x / incipient_g
        )
    } else {
        "stays still".to_owned()
    };
    if peaks_g.y > 0.0 {
        let _ = write!(
            reaches,
            " sideways;\n    vertically it reaches {:.4} g, and A_L counts in gravity plus that",
            peaks_g.y
        );
    }
    reaches
}

/// Warns of a run that ends before the ground does.
fn cut_short(scenario: &Scenario, ground: &GroundMotion, history: &Summary) -> String {
    if history.end_s >= scenario.simulation().duration_s && ground.end_s() > history.end_s {
        return format!(
            "  the run ends at {:.4} s and the ground moves until {:.4} s: a longer duration_s in [simulation] \
             shows the rest\n",
            history.end_s,
            ground.end_s()
        );
    }
    String::new()
}

/// How far the motion can be trusted to be that of four links, or of a column on its toe.
fn trust(thrust: &ThrustRecord, structure: &Structure) -> String {
    let Some([_, near]) = thrust.shares_within() else {
        return String::new();
    };
    let Peak { value, time_s } = thrust.largest_excess;
    let [close, most] = EXCESS_LEVELS;
    let excess =
        format!("the thrust line leaves the arch by up to {value:.3} t (at {time_s:.4} s)");
    let mut text = match structure {
        Structure::Column(_) if value > 0.0 => format!(
            "  the ground would have to hold the column down (at {time_s:.4} s): it flies off\n"
        ),
        Structure::Column(_) => String::new(),
        Structure::Arch(_) | Structure::Masonry(_) if value <= close => {
            format!(
                "  four links suffice: the thrust line leaves the arch by {value:.4} t at most\n"
            )
        }
        Structure::Arch(_) | Structure::Masonry(_) => {
            let grade = if value <= most {
                "four links are close"
            } else {
                "four links are a rough guide, not on the safe side"
            };
            let compare = match structure {
                Structure::Arch(arch) if arch.voussoirs().is_none() => {
                    "give `voussoirs` and compare with --hinges both"
                }
                _ => "compare with --hinges both",
            };
            format!(
                "  {grade}: {excess},\n    and stays within {most} t for {:.1} % of the rocking time; {compare}\n",
                100.0 * near
            )
        }
    };
    let _ = writeln!(
        text,
        "  friction coefficient needed to prevent sliding: {:.3} (at {:.4} s)",
        thrust.largest_friction.value, thrust.largest_friction.time_s
    );
    text
}
