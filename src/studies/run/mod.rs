//! A run: one history of a scenario, with its model of motion, as tables, pictures, a page, a summary and printed words.
//!
//! In this module `history` is the result of the model of motion, `summary` is `summary.json`, `report` is `report.html`, and `words` is the
//! printed text. A `sample` is the state of the structure at an instant; results of samples of `[uncertain]` are called `uncertainty`. A model
//! of blocks has a [`Model::row`]; all others are mechanisms.
//!
//! The tables are written during the computation, into files that were opened before it. All other files are [`Results`], as in all studies;
//! only the pictures of a film, whose number is unknown before, are added to the folder.

mod animation;
mod caveats;
mod comparison;
mod directions;
mod feet;
mod film;
mod impacts;
mod open_joints;
mod overlay;
mod packed;
mod picture;
mod points;
mod recorder;
mod report;
mod scales;
mod snapshots;
mod summary;
mod tables;
mod words;

use std::collections::BTreeMap;
use std::mem;
use std::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::Vector2;

use self::directions::{MirroredPage, MirroredRun};
pub use self::film::{Film, FilmOptions};
pub use self::impacts::NotableImpacts;
use self::overlay::Curves;
use self::picture::Timeline;
pub use self::points::MAX_POINTS;
use self::points::ObservedPoints;
use self::recorder::{MILLISECONDS, Output, RunRecorder, TableFiles, Tables, simulated};
pub use self::report::{Report, ReportPage, page_of};
pub use self::scales::Scales;
use self::snapshots::Snapshots;
use self::summary::FourLinkQuality;
pub use self::summary::{
    ComputedRun, MirroredSummary, OutcomeSummary, RunSummary, VariedRun, summary,
};
use self::words::records_in_words;
pub use self::words::words_of;
use self::words::{Printed, Words, WrittenFiles};
use super::comparison::Comparison;
use super::quotable::{self, ModelAnswer, free_hinges_instead};
use super::report::Statement;
use super::{Results, StudyError, Watch};
use crate::dynamics::repeatability::Repetitions;
use crate::dynamics::{Directions, FallEnd, Repeatability, Variations};
use crate::output::page::Spot;
use crate::output::{
    Figure, Folder, NewFile, OutputError, Panel, Scene, Subject, pretty, render, summary_of,
};
use crate::scenario::{ModelKind, Scenario};
use crate::{Event, Model, OpenHinge, Pose, Recorder, Sample, Summary, Sway};

const ROTATIONS: &str = "rotations.csv";
const REPORT: &str = "report.html";
const SNAPSHOTS: &str = "snapshots.svg";
const POSES: &str = "poses.csv";
const JOINTS: &str = "joints.csv";
const EVENTS: &str = "events.csv";
const IMPACTS: &str = "impacts.csv";
const PICTURE: &str = "history.svg";
/// Written last: a folder that contains it is complete.
const SUMMARY: &str = "summary.json";
/// Several models of motion in one picture, beside the folders of the models.
const OVERLAY: &str = "overlay.svg";
/// The folder of the pictures of a film, in that of the results.
const FILM: &str = "film";

/// All files that a run may write, except the pictures of a film, in the order in which they are listed.
pub const FILES: [&str; 10] = [
    ROTATIONS, REPORT, SNAPSHOTS, POSES, JOINTS, EVENTS, IMPACTS, PICTURE, OVERLAY, SUMMARY,
];

/// Options of a run; the defaults are those of the program without options.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunOptions {
    /// Whether rotations are not written to a file.
    pub no_rotations: bool,
    /// Whether that file has dimensionless columns; for mechanisms only.
    pub dimensionless: bool,
    /// Whether computations in steps are not repeated; repetitions find results that depend on the steps.
    pub no_repeat: bool,
    /// Whether to write no page with an animation of the structure.
    pub no_report: bool,
    /// The panels of the picture of a history; empty: those for which the picture has space.
    pub panels: Vec<Panel>,
    /// The times at which the deformed structure is drawn, in seconds.
    pub snapshots_s: Vec<f64>,
    /// Pictures a second of a film of the structure; `None` without film.
    pub film_rate_hz: Option<f64>,
    /// Factor on the displacements in snapshots and film; `None`: they are not exaggerated.
    pub exaggeration: Option<f64>,
    /// Whether to write a table of the poses of all bodies.
    pub poses: bool,
    /// Points of the undeformed structure, in metres, whose displacements are reported: at most [`MAX_POINTS`].
    pub points_m: Vec<Vector2<f64>>,
}

/// Receives the rotations in place of a file.
pub type RotationsOutput<'w> = Option<Output<'w>>;

/// The receivers of the tables of a run, which are written while it is computed, and the results that its report includes.
#[derive(Default)]
pub struct Sinks<'w> {
    /// The folder; with several models of motion each has a folder inside it. `None`: no files are written.
    pub folder: Option<Folder>,
    /// The files that the results of a single model without folder hold, by name; no others are made.
    pub in_memory: &'w [String],
    /// The output for the rotations in place of a file.
    pub rotations: RotationsOutput<'w>,
    /// The results on the samples of `[uncertain]` for each model, whose words begin the page and whose JSON ends the summary; empty without samples.
    pub samples: &'w [Results],
}

/// The results of one model of motion.
struct ModelResults {
    summary: RunSummary,
    answer: ModelAnswer,
    curves: Curves,
    /// The files in its folder, if there is one.
    files: Option<WrittenFiles>,
    /// Its files if they stay in memory.
    in_memory: Vec<(&'static str, Vec<u8>)>,
}

/// A scenario to run.
struct Run<'a> {
    scenario: &'a Scenario,
    /// The scenario in the mirrored direction alone; `None` without a second direction.
    mirrored: Option<Scenario>,
    model: Arc<dyn Model>,
    options: &'a RunOptions,
    figure: Figure,
    /// The models of motion of all runs whose words are printed together.
    all_models: &'a [&'static ModelKind],
    scales: Option<Scales>,
    points: ObservedPoints,
}

/// Checks that options of a run fit a scenario.
///
/// # Errors
/// Explains that the structure has no such model of motion, or that an option does not fit it.
pub fn check(scenario: &Scenario, options: &RunOptions) -> Result<(), String> {
    Run::new(scenario, options, Figure::SCREEN, &[]).map(drop)
}

/// Runs scenarios that differ only in their models of motion. The files of each are written to a folder of its own while it is computed.
/// `watch` receives the progress in milliseconds of simulated time; all of it is done while the history is repeated.
///
/// # Errors
/// When nothing moves the structure, the options do not fit, a motion cannot be computed, a result cannot be written, or the work is cancelled.
pub fn results(
    scenarios: &[Scenario],
    options: &RunOptions,
    figure: Figure,
    mut sinks: Sinks<'_>,
    watch: Watch<'_>,
) -> Result<Results, StudyError> {
    let all_models: Vec<_> = scenarios.iter().map(|one| one.motion.kind).collect();
    let runs: Result<Vec<Run<'_>>, String> = scenarios
        .iter()
        .map(|one| {
            one.check_for_run()?;
            Run::new(one, options, figure, &all_models)
        })
        .collect();
    let (runs, mut all) = (runs.map_err(StudyError::Scenario)?, Vec::new());
    for (number, run) in runs.iter().enumerate() {
        let folder = sinks
            .folder
            .as_ref()
            .map(|it| it.of_model(run.scenario.motion.kind, runs.len() > 1));
        let samples = sinks.samples.get(number);
        let sinks = Sinks {
            folder,
            in_memory: match runs.len() {
                1 => sinks.in_memory,
                _ => &[],
            },
            rotations: sinks.rotations.take(),
            samples: &[],
        };
        all.push(run.compute(sinks, samples, &mut *watch)?);
    }
    let mut results = Results {
        files: mem::take(&mut all[0].in_memory),
        ..Results::default()
    };
    let comparison = (all.len() > 1).then(|| {
        let answers: Vec<_> = all.iter().map(|one| one.answer.clone()).collect();
        let summaries = all.iter().map(|one| one.summary.clone());
        let models = all_models.iter().copied().zip(summaries);
        Comparison::new(models, quotable::quote_answers(&answers), None)
    });
    results.summary = match &comparison {
        None => summary_of(&all[0].summary)?,
        Some(comparison) => summary_of(comparison)?,
    };
    if comparison.is_some() && all[0].files.is_some() {
        results.files = vec![(OVERLAY, overlay(figure, &runs, &all, &[]).into_bytes())];
    }
    let quote = match &comparison {
        None => all[0].summary.to_quote.as_deref(),
        Some(comparison) => comparison.to_quote.as_deref(),
    };
    let words = |with_files: bool| {
        let printed = all.iter().map(|one| {
            let files = one.files.as_ref().filter(|_| with_files);
            (&one.summary, files)
        });
        super::results::words_of(&Printed {
            comparison: comparison.as_ref(),
            quote: quote.filter(|_| with_files),
            runs: printed.collect(),
        })
    };
    // The page may be opened elsewhere, so its words name no folder.
    results.statement = Statement {
        input: records_in_words(&scenarios[0]),
        next: next_command(scenarios, &all),
        ..statement(&all, quote, words(false))
    };
    results.words = words(true);
    if comparison.is_some() && !results.files.is_empty() && !options.no_report {
        results = comparison::with_page(results, &runs, &all).in_order(&FILES);
    }
    Ok(results)
}

/// The command that a user needs next: free hinges where four links are no answer, otherwise the strongest motion that the structure survives. `None`
/// for several models, or if nothing moves the ground.
fn next_command(scenarios: &[Scenario], all: &[ModelResults]) -> Option<String> {
    let ([scenario], [one]) = (scenarios, all) else {
        return None;
    };
    let is_outside = one.summary.four_links() == Some(FourLinkQuality::Outside);
    let quote = one.summary.to_quote.as_deref();
    let has_no_answer = quote.is_some_and(|quote| quote.starts_with(quotable::NO_ANSWER));
    let options = free_hinges_instead(scenario).filter(|_| is_outside || has_no_answer);
    let moves = one.summary.ground.whole_peak_g > 0.0;
    let threshold = moves.then(|| "threshold FILE".to_owned());
    options.map_or(threshold, |options| Some(format!("run FILE {options}")))
}

/// Statements about all models, with the answer and these details.
fn statement(all: &[ModelResults], quote: Option<&str>, details: String) -> Statement {
    let summaries = || all.iter().map(|one| &one.summary);
    let verdicts = summaries().map(|summary| {
        let verdict = summary.verdict_line();
        match all.len() {
            1 => verdict.trim().to_owned(),
            _ => format!("{}: {}", summary.label(), verdict.trim()),
        }
    });
    // Models share most warnings.
    let [mut unlikely, mut limits] = [Vec::new(), Vec::new()];
    for summary in summaries() {
        let own = summary.warnings.parts();
        for (all, own) in [&mut unlikely, &mut limits].into_iter().zip(own) {
            let new: Vec<_> = own.iter().filter(|one| !all.contains(*one)).collect();
            all.extend(new.into_iter().cloned());
        }
    }
    Statement {
        input: String::new(),
        verdict: verdicts.collect::<Vec<_>>().join("\n"),
        details,
        unlikely,
        limits,
        quote: quote.map(str::to_owned),
        numbers: summaries()
            .map(|summary| match all.len() {
                1 => summary.numbers_line(),
                _ => format!("{}: {}", summary.label(), summary.numbers_line()),
            })
            .collect(),
        next: None,
        is_table: true,
    }
}

/// Repeats a history of a scenario as a run does, which gives its verdict; `None` if the model has no repetitions.
pub fn repeat(scenario: &Scenario, model: &dyn Model, history: &Summary) -> Option<Repeatability> {
    model.row()?;
    let (ground, request) = (scenario.ground_motion(), scenario.request());
    Some(Repetitions::start(model, ground, &request).compare(history))
}

/// Computes a history of a scenario with other properties as a run does, in all directions of the scenario.
///
/// # Errors
/// When the structure with another property has no model of motion.
pub fn compute_varied(
    scenario: &Scenario,
    model: &dyn Model,
) -> Result<Vec<VariedRun>, StudyError> {
    let turned = scenario
        .has_second_direction(model)
        .then(|| scenario.in_directions(Directions::Mirrored));
    let own = variations(scenario)?;
    let turned = turned
        .as_ref()
        .map(variations)
        .transpose()?
        .map_or_else(Vec::new, Variations::wait);
    Ok(directions::pair_results(own.wait(), &turned))
}

/// Starts the motions of a scenario with other properties.
fn variations(scenario: &Scenario) -> Result<Variations, StudyError> {
    let variations = scenario.variations().map_err(StudyError::failed)?;
    let (ground, request) = (scenario.ground_motion(), scenario.request());
    Ok(Variations::start(variations, ground, &request))
}

impl<'a> Run<'a> {
    fn new(
        scenario: &'a Scenario,
        options: &'a RunOptions,
        figure: Figure,
        all_models: &'a [&'static ModelKind],
    ) -> Result<Self, String> {
        if options.dimensionless && !scenario.motion.kind.has_mechanism {
            let why_not = "--dimensionless goes with four links and columns: free hinges have no unstable equilibrium to measure by";
            return Err(why_not.to_owned());
        }
        let model = scenario.model().map_err(|error| error.to_string())?;
        let scales = match model.as_mechanisms().filter(|_| options.dimensionless) {
            Some(model) => {
                let scales = Scales::new(model, scenario.gravity_m_s2());
                let why_not = "the mechanism has no unstable equilibrium to measure by: leave --dimensionless out";
                Some(scales.ok_or(why_not)?)
            }
            None => None,
        };
        let points = ObservedPoints::new(scene(scenario, &*model), &options.points_m)?;
        let has_second = scenario.has_second_direction(&*model);
        Ok(Self {
            scenario,
            mirrored: has_second.then(|| scenario.in_directions(Directions::Mirrored)),
            model: Arc::from(model),
            options,
            figure,
            all_models,
            scales,
            points,
        })
    }

    /// The files that it makes for the sinks, the seal last.
    fn files(&self, sinks: &Sinks<'_>) -> Vec<&'static str> {
        let is_made = |file: &&str| match *file {
            _ if sinks.folder.is_none() && !sinks.in_memory.iter().any(|name| name == file) => {
                false
            }
            ROTATIONS => !self.options.no_rotations,
            REPORT => !self.options.no_report,
            SNAPSHOTS => !self.options.snapshots_s.is_empty(),
            POSES => self.options.poses,
            JOINTS => self.model.row().is_some(),
            // Elastic joints have no impacts.
            IMPACTS => self.model.has_impacts(),
            OVERLAY => false,
            _ => true,
        };
        FILES.into_iter().filter(is_made).collect()
    }

    /// Simulates the scenario and writes its files into the sinks. The page begins with the words about the samples of `[uncertain]`.
    fn compute(
        &self,
        sinks: Sinks<'_>,
        samples: Option<&Results>,
        watch: Watch<'_>,
    ) -> Result<ModelResults, StudyError> {
        let names = self.files(&sinks);
        let (scenario, model) = (self.scenario, &*self.model);
        let (ground, request) = (scenario.ground_motion(), scenario.request());
        let mut drawings = Drawings::new(self, &names);
        // Created before the history starts, so a folder that cannot be written costs no simulation.
        let mut files = TableFiles::create(&sinks, &names)?;
        let repetitions = self
            .repeats()
            .then(|| Repetitions::start(model, ground, &request));
        let mirrored_request = self.mirrored.as_ref().map(Scenario::request);
        let has_page = names.contains(&REPORT);
        let mirrored = MirroredRun::start(self, mirrored_request.as_ref(), has_page)?;
        let variations = self.variations(scenario)?;
        let duration_ms = (request.end_s * MILLISECONDS).round() as usize;
        let (history, rows) = {
            let streamed = sinks.rotations.map(|output| (ROTATIONS, output));
            let mut recorder = RunRecorder {
                tables: Tables::new(self, streamed.into_iter().chain(files.outputs()))?,
                drawings: &mut drawings,
                watch: &mut *watch,
                duration_ms,
                status: Ok(()),
            };
            let history = model.simulate(ground, &request, Some(&mut recorder))?;
            recorder.status?;
            (history, recorder.tables.finish()?)
        };
        let repeated = repetitions.map(|repetitions| {
            // Repetitions that were started are finished.
            let all = duration_ms;
            let _ = watch(simulated(all, all));
            repetitions.compare(&history)
        });
        let mirrored = mirrored.map(MirroredRun::finish);
        let turned = mirrored.as_ref().map_or(&[][..], |run| &run.varied);
        let varied = directions::pair_results(variations.wait(), turned);
        let mut summary = RunSummary::of(&ComputedRun {
            scenario,
            model,
            history: &history,
            impacts: mem::take(&mut drawings.notable),
            repeated: repeated.as_ref(),
            varied: &varied,
            mirrored: mirrored.as_ref().map(|run| run.summary.clone()),
        });
        summary.points = drawings.points.peaks();
        self.add_study_words(&mut summary, &history, samples);
        let of_samples = samples.map_or("", |samples| &samples.words);
        let other = mirrored.and_then(|run| run.page);
        let mut texts = drawings.texts(self, &names, &history, (of_samples, other), &summary);
        if names.contains(&SUMMARY) {
            texts.insert(SUMMARY, pretty(&summary_of(&summary)?));
        }
        let named = sinks.folder.as_ref().map(|folder| {
            let film_pictures = drawings.add_film(self, folder)?;
            write(folder, &names, mem::take(&mut files.on_disk), &texts)?;
            Ok::<_, OutputError>(WrittenFiles {
                folder: folder.path().to_owned(),
                names,
                rows,
                film_pictures,
                outside_times_s: drawings.outside_times_s(),
            })
        });
        Ok(ModelResults {
            answer: summary.answer(scenario, model),
            summary,
            curves: drawings.curves,
            files: named.transpose()?,
            in_memory: match sinks.folder {
                Some(_) => Vec::new(),
                None => files.with_texts(texts),
            },
        })
    }

    /// Whether its motions are repeated.
    fn repeats(&self) -> bool {
        !self.options.no_repeat && self.model.row().is_some()
    }

    /// Starts the motions with other properties, in the direction of a scenario.
    fn variations(&self, scenario: &Scenario) -> Result<Variations, StudyError> {
        match self.options.no_repeat {
            true => Ok(Variations::default()),
            false => variations(scenario),
        }
    }

    /// Adds what a summary has of this computation and of the other models and samples.
    fn add_study_words(
        &self,
        summary: &mut RunSummary,
        history: &Summary,
        samples: Option<&Results>,
    ) {
        // [`summary`] omits the computing time, so that equal histories have equal summaries.
        let longest_step = history.row().and_then(|row| row.longest_step);
        summary.longest_step_us = longest_step.map(|step| (step.as_secs_f64() * 1e6).round());
        if self.all_models.len() > 1 {
            summary.to_quote = None;
            summary.compared_models = self.all_models.to_vec();
        }
        summary.uncertain = samples.map(|samples| samples.summary.clone());
    }

    /// The subject of the pictures.
    fn subject<'s>(&'s self, title: &'s str) -> Subject<'s> {
        let incipient_g = |sway| self.model.incipient_acceleration_g(sway);
        Subject {
            title,
            ground: self.scenario.ground_motion(),
            gravity_m_s2: self.scenario.gravity_m_s2(),
            incipient_g: [Sway::Right, Sway::Left].map(incipient_g),
        }
    }
}

/// Completes the tables and writes the other files, the seal last.
fn write(
    folder: &Folder,
    names: &[&'static str],
    mut tables: BTreeMap<&'static str, NewFile>,
    texts: &BTreeMap<&'static str, String>,
) -> Result<(), OutputError> {
    for name in names {
        match tables.remove(name) {
            Some(table) => folder.complete(table)?,
            None => folder.write(name, texts[name].as_bytes())?,
        }
    }
    Ok(())
}

/// One picture of several models of motion.
fn overlay(figure: Figure, runs: &[Run<'_>], all: &[ModelResults], spots: &[Spot]) -> String {
    let names: Vec<_> = runs
        .iter()
        .map(|run| run.scenario.motion.kind.label)
        .collect();
    let first = &runs[0];
    let mut title = names.join(" and ");
    if let Some(initial) = title.get_mut(..1) {
        initial.make_ascii_uppercase();
    }
    let subject = first.subject(first.scenario.title.as_deref().unwrap_or(&title));
    let curves = all.iter().map(|one| &one.curves);
    let named: Vec<_> = names.into_iter().zip(curves).collect();
    overlay::draw(figure, &subject, &named, spots)
}

/// The drawable parts of a structure, as a model moves them.
pub fn scene(scenario: &Scenario, model: &dyn Model) -> Scene {
    let Some(row) = model.row() else {
        return Scene::new(&scenario.structure);
    };
    let mut scene = Scene::of_row(row, &scenario.structure);
    if let Some(movements) = scenario.motion.supports() {
        scene.supports = movements.poses(row);
    }
    scene
}

/// Title of the pictures and the page of a scenario.
fn title(scenario: &Scenario) -> &str {
    scenario.title.as_deref().unwrap_or("Rocking history")
}

/// Collects the samples and events of a history for its pictures, its page, its words and its summary.
struct Drawings {
    timeline: Timeline,
    report: Option<Report>,
    film: Option<Snapshots>,
    snapshots: Option<Snapshots>,
    notable: NotableImpacts,
    points: ObservedPoints,
    curves: Curves,
}

impl Drawings {
    /// Times of snapshots before the start and after the end, in seconds.
    fn outside_times_s(&self) -> [Vec<f64>; 2] {
        let snapshots = self.snapshots.as_ref();
        snapshots.map_or_else(Default::default, Snapshots::outside_times_s)
    }

    /// The page, the film and the snapshots are collected only for files.
    fn new(run: &Run<'_>, files: &[&str]) -> Self {
        let (model, options) = (&*run.model, &run.options);
        let factor = options.exaggeration.unwrap_or(1.0);
        let snapshots = || Snapshots::new(scene(run.scenario, model), factor);
        let film_rate_hz = options.film_rate_hz.filter(|_| !files.is_empty());
        let times_s = files.contains(&SNAPSHOTS).then_some(&options.snapshots_s);
        Self {
            timeline: Timeline::new(model),
            report: files
                .contains(&REPORT)
                .then(|| Report::new(run.scenario, model)),
            film: film_rate_hz.map(|rate_hz| snapshots().every(1.0 / rate_hz)),
            snapshots: times_s.map(|times_s| snapshots().at(times_s)),
            notable: NotableImpacts::default(),
            points: run.points.clone(),
            curves: Curves::default(),
        }
    }

    /// Makes the page of a history, with these words about samples, and the verdict; `None` without page.
    fn page(
        &self,
        scenario: &Scenario,
        history: &Summary,
        opening: [&str; 2],
        summary: &RunSummary,
    ) -> Option<ReportPage> {
        let points = Some(&self.points);
        let words = render(&Words { summary });
        let report = self.report.as_ref()?;
        Some(report.page(scenario, history, points, opening, &words))
    }

    /// Makes those of the pictures, and of the page with the words, that are among the files. `other` is the history under the mirrored ground
    /// motion; the page opens with the worse one.
    fn texts(
        &self,
        run: &Run<'_>,
        files: &[&str],
        history: &Summary,
        (uncertainty, other): (&str, Option<MirroredPage>),
        summary: &RunSummary,
    ) -> BTreeMap<&'static str, String> {
        let (figure, title) = (run.figure, title(run.scenario));
        let subject = run.subject(title);
        let panels = &run.options.panels;
        let draw = || {
            self.timeline
                .draw(figure, panels, &subject, history, &self.points)
        };
        let opening = [uncertainty, &summary.verdict_line()];
        let own = self.page(run.scenario, history, opening, summary);
        let other = other.and_then(|other| {
            let (history, summary) = (&other.history, &other.summary);
            let drawings = &other.drawings;
            drawings.page(run.mirrored.as_ref()?, history, opening, summary)
        });
        let report = own.map(|own| match (other, summary.worse_mirrored()) {
            (Some(other), Some(_)) => other.with_other_direction(own).html(),
            (Some(other), None) => own.with_other_direction(other).html(),
            (None, _) => own.html(),
        });
        let snapshots = self.snapshots.as_ref();
        let snapshots = snapshots.map(|snapshots| snapshots.draw(figure, title));
        let texts = [
            (PICTURE, files.contains(&PICTURE).then(draw)),
            (REPORT, report),
            (SNAPSHOTS, snapshots),
        ]
        .into_iter();
        texts
            .filter_map(|(name, text)| Some((name, text?)))
            .collect()
    }

    /// Adds the film to the folder. Returns the number of its pictures; `None` without film.
    fn add_film(&self, run: &Run<'_>, folder: &Folder) -> Result<Option<usize>, OutputError> {
        let Some(film) = &self.film else {
            return Ok(None);
        };
        let pictures = film.film_pictures(run.figure, title(run.scenario));
        for (number, picture) in (1..).zip(&pictures) {
            let name = format!("{FILM}/frame-{number:04}.svg");
            folder.add(&name, picture.as_bytes())?;
        }
        Ok(Some(pictures.len()))
    }
}

impl Recorder for Drawings {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.timeline.sample(sample);
        if let Some(report) = &mut self.report {
            report.push(sample);
        }
        for snapshots in self.film.iter_mut().chain(&mut self.snapshots) {
            snapshots.push(sample);
        }
        let placed = (&sample.poses[..], &sample.hinges[..]);
        self.points.push(sample.time_s, placed, true);
        self.curves.push(sample);
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        self.notable.add_event(event);
        self.timeline.event(event);
        ControlFlow::Continue(())
    }

    fn wants_thrust_line(&self) -> bool {
        self.report.is_some() || self.film.is_some() || self.snapshots.is_some()
    }

    fn step(&mut self, time_s: f64, poses: &[Pose], hinges: &[OpenHinge]) {
        self.points.push(time_s, (poses, hinges), false);
    }

    fn wants_fall(&self) -> bool {
        self.report.is_some() || self.film.is_some()
    }

    fn fall_sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        if let Some(report) = &mut self.report {
            report.push_fall(sample);
        }
        if let Some(film) = &mut self.film {
            film.push(sample);
        }
        ControlFlow::Continue(())
    }

    fn fall_end(&mut self, end: FallEnd) {
        if let Some(report) = &mut self.report {
            report.end_fall(end);
        }
    }
}
