//! The command `threshold`.

use std::fmt::Write as _;
use std::io::Write as _;
use std::iter;
use std::ops::ControlFlow;
use std::path::PathBuf;

use archrock::dynamics::ground::GroundMotion;
use archrock::dynamics::history::Outcome;
use archrock::dynamics::model::Model;
use archrock::output::threshold::{self as output, rounded};
use archrock::scenario::{Scenario, Structure};
use archrock::studies::threshold::{
    FactorRange, FactorSample, Factors, NoHistory, RangeEnd, Threshold, ThresholdError, thresholds,
};

use super::run::Models;
use super::scenario_file::ScenarioFile;
use super::study::{Display, Threads, impact_ignored, say};
use super::{Failure, Format, commands, print};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Model of motion [default: free if the scenario has [free_hinges], else four].
    #[arg(long, value_enum)]
    hinges: Option<Models>,
    /// Smallest factor on the ground motion.
    #[arg(long, value_name = "FACTOR", default_value_t = Factors::default().first())]
    from: f64,
    /// Largest factor.
    #[arg(long, value_name = "FACTOR", default_value_t = Factors::default().last())]
    to: f64,
    /// Relative step from one factor to the next; narrower bands and gaps may be missed.
    #[arg(long, value_name = "PART", default_value_t = Factors::default().stride())]
    stride: f64,
    #[command(flatten)]
    threads: Threads,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

const PICTURE: &str = "threshold.svg";
const TABLE: &str = "threshold.csv";
/// Written last: a folder that has it is complete.
const SUMMARY: &str = "threshold.json";

pub fn threshold(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let factors = Factors::new(arguments.from, arguments.to, arguments.stride)
        .map_err(|error| Failure::Input(format!("--from, --to, --stride: {error}")))?;
    let input = arguments.scenario.open()?;
    let (scenario, other) = Models::read(arguments.hinges, &input)?;
    check(&scenario).map_err(|message| input.about(Failure::Input(message.to_owned())))?;
    let scenarios: Vec<&Scenario> = iter::once(&scenario).chain(&other).collect();
    if !quiet
        && let Some(ignored) = scenarios
            .iter()
            .find_map(|scenario| impact_ignored(scenario))
    {
        say(ignored);
    }
    let models = scenarios
        .iter()
        .map(|scenario| model(scenario))
        .collect::<Result<Vec<_>, _>>()?;
    let models: Vec<(&str, &dyn Model)> = models
        .iter()
        .map(|(name, model)| (*name, &**model))
        .collect();
    let ground = scenario.ground_motion();
    // Opened before the work starts, so that a folder that cannot be written costs no time.
    let place = input.results(arguments.out.as_deref())?;
    let mut folder = place.open(&[PICTURE, TABLE, SUMMARY])?;

    let runner = arguments.threads.runner();
    let mut display = None;
    let watch = |progress| {
        let display = display.get_or_insert_with(|| Display::new(progress, quiet));
        display.show(progress);
        ControlFlow::Continue(())
    };
    let request = scenario.request();
    let found = thresholds(&models, ground, &request, &factors, &runner, watch)?;
    if let Some(display) = display {
        display.finish();
    }
    for threshold in &found {
        refuse_if_nothing_is_known(threshold)?;
    }

    let title = scenario
        .title
        .as_deref()
        .unwrap_or("Threshold of overturning");
    let peak_g = output::peak_g(&scenario, ground);
    let json = output::to_json(&scenarios, ground, &factors, &found)?;
    let json = commands::pretty(&json);
    let picture = output::draw(title, peak_g, &factors, &found);
    for (name, text) in [(PICTURE, &picture), (SUMMARY, &json)] {
        folder
            .file(name)
            .write_all(text.as_bytes())
            .map_err(|error| Failure::Work(format!("cannot write {name}: {error}")))?;
    }
    output::write_table(folder.file(TABLE), &found)?;
    folder.complete()?;
    if !quiet {
        say(&format!(
            "results in {}: {PICTURE}, {TABLE}, {SUMMARY}",
            place.path().display()
        ));
    }
    match arguments.format {
        Format::Json => print(&json),
        Format::Text => print(&words(&scenario, ground, &factors, &found)),
    }
}

/// A model of motion, and its name in the results.
type NamedModel = (&'static str, Box<dyn Model>);

/// The model that a scenario was read for.
fn model(scenario: &Scenario) -> Result<NamedModel, Failure> {
    let name = match (&scenario.free_hinges, &scenario.structure) {
        (Some(_), _) => "free_hinges",
        (None, Structure::Arch(_) | Structure::Masonry(_)) => "four_links",
        (None, Structure::Column(_)) => "column",
    };
    let model = scenario.model();
    Ok((
        name,
        model.map_err(|error| Failure::Input(error.to_string()))?,
    ))
}

/// Checks that the scenario has a ground motion to scale, and starts from rest.
fn check(scenario: &Scenario) -> Result<(), &'static str> {
    if scenario.initial.is_some() {
        return Err("the histories of a threshold start from rest: leave [initial] out");
    }
    if scenario.ground.is_none() {
        return Err(
            "a threshold needs a ground motion: give a table such as\n\n\
             [ground.one_cosine]\n\
             amplitude_g = 0.3\n\
             duration_s = 0.5",
        );
    }
    Ok(())
}

impl From<ThresholdError> for Failure {
    fn from(error: ThresholdError) -> Self {
        match error {
            ThresholdError::Argument(_) => Self::Input(error.to_string()),
            ThresholdError::Runner(error) => error.into(),
        }
    }
}

/// Where no history could be computed there is no result.
fn refuse_if_nothing_is_known(threshold: &Threshold) -> Result<(), Failure> {
    let samples = &threshold.samples;
    if samples.iter().any(|sample| sample.result.is_ok()) {
        return Ok(());
    }
    match samples
        .iter()
        .find_map(|sample| sample.result.as_ref().err())
    {
        Some(NoHistory::GroundFalls(reason)) => Err(Failure::Input(reason.clone())),
        Some(NoHistory::Failed(reason)) => Err(Failure::Work(reason.clone())),
        None => Ok(()),
    }
}

/// What was found, a line per band.
fn words(
    scenario: &Scenario,
    ground: &GroundMotion,
    factors: &Factors,
    thresholds: &[Threshold],
) -> String {
    let mut text = String::new();
    if let Some(title) = &scenario.title {
        let _ = writeln!(text, "{title}");
    }
    let peak_g = output::peak_g(scenario, ground);
    for threshold in thresholds {
        if thresholds.len() > 1 {
            let _ = writeln!(text, "{}", threshold.model.replace('_', " "));
        }
        bands(&mut text, peak_g, threshold);
        doubts(&mut text, threshold);
    }
    let _ = writeln!(
        text,
        "  sampled from {} to {} in strides of {} %: narrower bands and gaps may be missed",
        factors.first(),
        factors.last(),
        (1e6 * factors.stride()).round() / 1e4,
    );
    let end_s = scenario.simulation.duration_s;
    if ground.end_s() > end_s {
        let _ = writeln!(
            text,
            "  the histories end at {end_s:.4} s and the ground moves until {:.4} s: a longer duration_s in \
             [simulation] shows the rest",
            ground.end_s()
        );
    }
    text
}

fn bands(text: &mut String, peak_g: f64, threshold: &Threshold) {
    let at = |factor: f64| format!("{} ({} g)", rounded(factor), rounded(factor * peak_g));
    let Some(first) = threshold.bands.first() else {
        let mut known = threshold.samples.iter().rev();
        let last = known.find(|sample| sample.result.is_ok());
        let last = last.map_or(0.0, |sample| sample.factor);
        let _ = writeln!(text, "  does not overturn up to factor {}", at(last));
        return;
    };
    if first.from_end == RangeEnd::Sampled {
        let _ = writeln!(
            text,
            "  overturns at the smallest factor already: a smaller --from finds where this band begins"
        );
    }
    for band in &threshold.bands {
        let _ = write!(text, "  overturns from factor {}", at(band.from));
        let _ = match (band.to_end, gap_after(threshold, band)) {
            (RangeEnd::Sampled, _) => writeln!(text, " up to the largest factor"),
            (RangeEnd::Unknown, _) => {
                writeln!(text, " to {}; not known beyond", at(band.to))
            }
            (RangeEnd::Edge, None) => writeln!(text, " to {}; survives from there on", at(band.to)),
            (RangeEnd::Edge, Some(gap)) => {
                let (from, to) = (at(band.to), at(gap.to));
                writeln!(text, " to {from}; survives again up to {to}")
            }
        };
    }
}

/// The safe gap that follows a band.
fn gap_after<'a>(threshold: &'a Threshold, band: &FactorRange) -> Option<&'a FactorRange> {
    let mut gaps = threshold.gaps.iter();
    gaps.find(|gap| gap.from > band.to)
}

/// What is uncertain about the bands.
fn doubts(text: &mut String, threshold: &Threshold) {
    let falls = |sample: &&FactorSample| matches!(sample.result, Err(NoHistory::GroundFalls(_)));
    let samples = &threshold.samples;
    if let Some(first) = samples.iter().find(falls) {
        let _ = writeln!(
            text,
            "  from factor {} on, the ground falls as fast as a free body at some time, which this model does \
             not cover",
            rounded(first.factor)
        );
    }
    let failed: Vec<_> = samples
        .iter()
        .filter(|sample| !falls(sample))
        .filter_map(|sample| Some((sample.factor, sample.result.as_ref().err()?)))
        .collect();
    if let Some((factor, reason)) = failed.first() {
        let _ = writeln!(
            text,
            "  failed: {} of {} histories; the first, at factor {}: {reason}",
            failed.len(),
            samples.len(),
            rounded(*factor)
        );
    }
    let rocking = samples.iter().filter(|sample| {
        let ending = sample.result.as_ref();
        ending.is_ok_and(|ending| ending.outcome == Outcome::StillRocking)
    });
    let rocking = rocking.count();
    if rocking > 0 {
        let _ = writeln!(
            text,
            "  still rocking at duration_s of [simulation], which counts as survived: {rocking} of {} histories",
            samples.len()
        );
    }
}
