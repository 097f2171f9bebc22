//! The command `threshold`.

use std::fmt::Write as _;
use std::io::Write as _;
use std::iter;
use std::ops::ControlFlow;
use std::path::PathBuf;

use archrock::dynamics::ground::GroundMotion;
use archrock::dynamics::history::Outcome;
use archrock::dynamics::model::Model;
use archrock::output::pretty;
use archrock::output::survival;
use archrock::output::threshold::{self as output, rounded};
use archrock::scenario::{Ground, Scenario, Structure};
use archrock::studies::ending::Verdict;
use archrock::studies::survival::Survival;
use archrock::studies::threshold::{
    FactorSample, Factors, NoHistory, RangeEnd, Threshold, ThresholdError, thresholds,
};
use serde_json::Value;

use super::figure::FigureOption;
use super::run::Models;
use super::scenario_file::{Destination, ScenarioFile, SuiteOption};
use super::study::{Display, Threads, impact_ignored, say};
use super::{Failure, Format, print};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    #[command(flatten)]
    suite: SuiteOption,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOption,
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
    let both = Models::read(arguments.hinges, &input)?;
    let about = |failure| input.about(failure);
    let place = input.results(arguments.out.as_deref())?;
    let (mut names, mut tasks) = (Vec::new(), Vec::new());
    for (record, (scenario, other)) in arguments.suite.choose(both).map_err(about)? {
        check(&scenario).map_err(|message| about(Failure::Input(message.to_owned())))?;
        let place = match &record {
            Some(record) => place.of_record(record)?,
            None => place.clone(),
        };
        let scenarios: Vec<Scenario> = iter::once(scenario).chain(other).collect();
        names.push(record.unwrap_or_default());
        tasks.push((scenarios, place));
    }
    let places = tasks.iter().map(|(_, place)| place);
    Destination::check_distinct(names.iter().map(String::as_str).zip(places)).map_err(about)?;
    if !quiet
        && let Some(ignored) = tasks
            .iter()
            .flat_map(|(scenarios, _)| scenarios)
            .find_map(impact_ignored)
    {
        say(ignored);
    }
    let mut texts = Vec::new();
    let mut results = Vec::new();
    for (scenarios, place) in &tasks {
        if !quiet {
            super::warn(&scenarios[0].unlikely());
        }
        let (text, json) = find(scenarios, place, &factors, arguments, quiet)?;
        texts.push(text);
        results.push(json);
    }
    match arguments.format {
        Format::Json => {
            let only = (results.len() == 1).then(|| results.pop()).flatten();
            print(&pretty(&only.unwrap_or(Value::Array(results))))
        }
        Format::Text => {
            let title = tasks[0].0[0].title.as_ref();
            let title = title.map_or(String::new(), |title| format!("{title}\n"));
            let sampled = sampled(&factors);
            print(&format!("{title}{}{sampled}", texts.concat()))
        }
    }
}

/// Finds the thresholds of a scenario, for one model of motion or for both, and writes them. Returns what was found in
/// words and as JSON.
fn find(
    scenarios: &[Scenario],
    place: &Destination,
    factors: &Factors,
    arguments: &Arguments,
    quiet: bool,
) -> Result<(String, Value), Failure> {
    let scenario = &scenarios[0];
    let models = scenarios.iter().map(model).collect::<Result<Vec<_>, _>>()?;
    let models: Vec<(&str, &dyn Model)> = models
        .iter()
        .map(|(name, model)| (*name, &**model))
        .collect();
    let ground = scenario.ground_motion();
    // Opened before the work starts, so that a folder that cannot be written costs no time.
    let mut folder = place.open(&[PICTURE, TABLE, SUMMARY])?;

    let runner = arguments.threads.runner();
    let mut display = None;
    let watch = |progress| {
        let display = display.get_or_insert_with(|| Display::new(progress, quiet));
        display.show(progress);
        ControlFlow::Continue(())
    };
    let request = scenario.request();
    let found = thresholds(&models, ground, &request, factors, &runner, watch)?;
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
    let peak_g = output::peak_g(scenario, ground);
    let of_models: Vec<&Scenario> = scenarios.iter().collect();
    let json = output::to_json(&of_models, ground, factors, &found)?;
    let picture = output::draw(arguments.figure.get(), title, peak_g, factors, &found);
    let summary = pretty(&json);
    for (name, text) in [(PICTURE, &picture), (SUMMARY, &summary)] {
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
    Ok((words(scenario, ground, &found), json))
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

/// What was found: of a record in a line, of a pulse a line per range.
fn words(scenario: &Scenario, ground: &GroundMotion, thresholds: &[Threshold]) -> String {
    let mut text = String::new();
    let peak_g = output::peak_g(scenario, ground);
    for threshold in thresholds {
        let model = threshold.model.replace('_', " ");
        let several = thresholds.len() > 1;
        if let Some(Ground::Record(record)) = &scenario.ground {
            let model = if several {
                format!(", {model}")
            } else {
                String::new()
            };
            let line = survival::in_words(&Survival::of_threshold(threshold), "");
            let file = record.main.name();
            let _ = writeln!(text, "  {file}{model}: {line} (1 is {} g)", rounded(peak_g));
        } else {
            if several {
                let _ = writeln!(text, "{model}");
            }
            ranges(&mut text, peak_g, threshold);
        }
        doubts(&mut text, threshold);
    }
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

/// Which factors were tried.
fn sampled(factors: &Factors) -> String {
    format!(
        "  sampled from {} to {} in strides of {} %: narrower bands and gaps may be missed\n",
        factors.first(),
        factors.last(),
        (1e6 * factors.stride()).round() / 1e4,
    )
}

fn ranges(text: &mut String, peak_g: f64, threshold: &Threshold) {
    let at = |factor: f64| format!("{} ({} g)", rounded(factor), rounded(factor * peak_g));
    let certainly = if threshold.uncertain().is_empty() {
        ""
    } else {
        "certainly "
    };
    if threshold.bands().is_empty() {
        let mut known = threshold.samples.iter().rev();
        let last = known.find(|sample| sample.result.is_ok());
        let last = at(last.map_or(0.0, |sample| sample.factor));
        let _ = writeln!(text, "  does not {certainly}overturn up to factor {last}");
    }
    if let Some((verdict, first)) = threshold.ranges.first()
        && *verdict != Verdict::Survives
        && first.from_end == RangeEnd::Sampled
    {
        let (what, range) = match verdict {
            Verdict::Overturns => ("overturns", "band"),
            _ => ("uncertain", "range"),
        };
        let _ = writeln!(
            text,
            "  {what} at the smallest factor already: a smaller --from finds where this {range} begins"
        );
    }
    // A line for each band, with what follows it.
    let mut lines: Vec<String> = Vec::new();
    for (verdict, range) in &threshold.ranges {
        let to = at(range.to);
        let (ends, beyond) = match range.to_end {
            RangeEnd::Sampled => ("up to the largest factor".to_owned(), ""),
            RangeEnd::Unknown => (format!("to {to}"), "; not known beyond"),
            RangeEnd::Edge => (format!("to {to}"), ""),
        };
        let begins = at(range.from);
        match (verdict, lines.last_mut()) {
            (Verdict::Overturns, _) => {
                lines.push(format!("overturns from factor {begins} {ends}{beyond}"));
            }
            (Verdict::Survives, None) => {}
            (Verdict::Uncertain, None) => {
                lines.push(format!("uncertain from factor {begins} {ends}{beyond}"));
            }
            (verdict, Some(line)) => {
                let what = match verdict {
                    Verdict::Uncertain => "uncertain",
                    _ => "survives",
                };
                *line += &match range.to_end {
                    RangeEnd::Sampled => format!("; {what} from there on"),
                    _ if what == "survives" => format!("; survives again up to {to}{beyond}"),
                    _ => format!("; {what} up to {to}{beyond}"),
                };
            }
        }
    }
    for line in lines {
        let _ = writeln!(text, "  {line}");
    }
}

/// What is doubtful about the ranges.
fn doubts(text: &mut String, threshold: &Threshold) {
    let uncertain = threshold.samples.iter().filter_map(|sample| {
        let reason = sample.result.as_ref().ok()?.uncertain.as_ref()?;
        Some((sample.factor, reason))
    });
    let uncertain: Vec<_> = uncertain.collect();
    if let Some((factor, reason)) = uncertain.first() {
        let _ = writeln!(
            text,
            "  uncertain: {} of {} histories; the first, at factor {}: {reason}",
            uncertain.len(),
            threshold.samples.len(),
            rounded(*factor)
        );
    }
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
