//! The command `threshold`.

use std::ops::ControlFlow;
use std::path::PathBuf;

use archrock::dynamics::model::Model;
use archrock::scenario::Scenario;
use archrock::studies::catalogue::{StudyKind, thresholds_along as study_along};
use archrock::studies::results::{Look, Results};
use archrock::studies::threshold::along::{Along, AlongOptions, KeyRange};
use archrock::studies::threshold::{
    FILES, Factors, NoHistory, Threshold, ThresholdError, check, tell, thresholds, vary,
};

use super::figure::FigureOption;
use super::run::Models;
use super::scenario_file::{Destination, Input, ScenarioFile, SuiteOption};
use super::study::{Display, Pending, Work, say};
use super::uncertain::{Asked, ITSELF, Telling};
use super::{Failure, Format, print, print_all, show};
use archrock::studies::kept::{ALONG, Origin, THRESHOLD};

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
    /// Models of motion [default: elastic or free if the scenario has [elastic_joints] or [free_hinges], else four].
    #[arg(long, value_enum, value_delimiter = ',')]
    hinges: Vec<Models>,
    /// Smallest factor on the ground motion.
    #[arg(long, value_name = "FACTOR", default_value_t = Factors::default().first())]
    from: f64,
    /// Largest factor.
    #[arg(long, value_name = "FACTOR", default_value_t = Factors::default().last())]
    to: f64,
    /// Relative step from one factor to the next; narrower bands and gaps may be missed.
    #[arg(long, value_name = "PART", default_value_t = Factors::default().stride())]
    stride: f64,
    /// Find the least factor that overturns for each value of a key, such as --along arch.mean_radius_m=4..6:5.
    #[arg(
        long,
        value_name = "TABLE.KEY=FROM..TO:COUNT",
        conflicts_with = "suite"
    )]
    along: Option<KeyRange>,
    /// Also find the least factor that overturns before any impact.
    #[arg(long, requires = "along")]
    no_impact: bool,
    /// How the samples of [uncertain], and everything else, are computed.
    #[command(flatten)]
    work: Work,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

pub fn threshold(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let factors = Factors::new(arguments.from, arguments.to, arguments.stride)
        .map_err(|error| Failure::Input(format!("--from, --to, --stride: {error}")))?;
    let input = arguments.scenario.open()?;
    if let Some(along) = &arguments.along {
        return thresholds_along(arguments, along, factors, &input, quiet);
    }
    let models = Models::read(&arguments.hinges, &input)?;
    let origin = Origin::of(&models[0]);
    let about = |failure| input.about(failure);
    let is_part = arguments.work.is_part();
    let root = arguments
        .figure
        .printed(input.results(arguments.out.as_deref())?);
    let (mut names, mut tasks) = (Vec::new(), Vec::new());
    for (record, scenarios) in arguments.suite.choose(models).map_err(about)? {
        check(&scenarios[0]).map_err(|message| about(Failure::Input(message)))?;
        let place = match &record {
            Some(record) => root.of_record(record)?,
            None => root.clone(),
        };
        names.push(record.unwrap_or_default());
        tasks.push((scenarios, place));
    }
    let places = tasks.iter().map(|(_, place)| place);
    Destination::check_distinct(names.iter().map(String::as_str).zip(places)).map_err(about)?;
    if !quiet
        && let Some(ignored) = tasks
            .iter()
            .flat_map(|(scenarios, _)| scenarios)
            .find_map(Scenario::ignored)
    {
        say(ignored);
    }
    let root = if is_part {
        root.locked_for_a_part(THRESHOLD)?
    } else {
        root.locked_for(THRESHOLD, &origin, quiet)?
    };
    let title = tasks[0].0[0].title();
    let title = title.map_or(String::new(), |title| format!("{title}\n"));
    let mut found = Vec::new();
    for (scenarios, place) in tasks {
        let mut pending = Pending::default();
        let (scenarios, place) = (&scenarios, &place.locked_with(&root));
        if !quiet {
            super::warn(&scenarios[0].unlikely());
        }
        let samples = Telling {
            work: arguments.work,
            figure: arguments.figure.get()?,
            quiet,
        };
        let mut results = if samples.is_part(scenarios)? {
            Results::default()
        } else {
            find(scenarios, place, &factors, arguments, quiet)?
        };
        let mut likely = String::new();
        let several = scenarios.len() > 1;
        for scenario in scenarios {
            let name = scenario.motion().hinges().name();
            let place = if several { &place.within(name) } else { place };
            if let Some(told) =
                samples.tell(scenario, Asked::FirstEdges(factors), place, &mut pending)?
            {
                if several {
                    likely += &format!("{}\n", scenario.motion().words());
                }
                likely += &told.words;
                let summary = &mut results.summary["uncertain"];
                *(if several { &mut summary[name] } else { summary }) = told.summary;
            }
        }
        if !likely.is_empty() {
            results.words.insert_str(0, &(likely + ITSELF));
        }
        pending.publish(place)?;
        if !is_part && !quiet {
            say(&format!("results in {}", place.holds(&results)));
        }
        found.push(results);
    }
    match arguments.format {
        Format::Json => print_all(found.into_iter().map(|results| results.summary)),
        Format::Text => {
            let words: String = found.into_iter().map(|results| results.words).collect();
            print(&format!("{title}{words}  {}\n", factors.in_words()))
        }
    }
}

/// Finds the threshold for each value of a key.
fn thresholds_along(
    arguments: &Arguments,
    along: &KeyRange,
    factors: Factors,
    input: &Input<'_>,
    quiet: bool,
) -> Result<(), Failure> {
    let models = Models::read(&arguments.hinges, input)?;
    let about = |message: &str| input.about(Failure::Input(message.to_owned()));
    let [scenario] = &models[..] else {
        return Err(about("--along is for one model: choose it by --hinges"));
    };
    if scenario.uncertain().is_some() {
        return Err(about(
            "--along varies one key and ignores [uncertain]: give --no-uncertain",
        ));
    }
    if !quiet {
        super::warn(&scenario.unlikely());
        scenario.ignored().into_iter().for_each(say);
    }
    let options = AlongOptions {
        along: along.clone(),
        factors,
        no_impact: arguments.no_impact,
    };
    Along::of(scenario, options.clone()).map_err(|message| about(&message))?;
    let look = Look::of(arguments.figure.get()?);
    let place = arguments
        .figure
        .printed(input.results(arguments.out.as_deref())?);
    let place = if arguments.work.is_part() {
        place.locked_for_a_part(ALONG)?
    } else {
        place.locked(ALONG, scenario, quiet)?
    };
    let kind = StudyKind::ThresholdAlong;
    let done = arguments
        .work
        .compute(kind.name(), &place, quiet, |runner, task, watch| {
            let task = Some(task);
            Ok(study_along(scenario, options, look, runner, task, watch)?)
        })?;
    let mut pending = Pending::default();
    let results = done.map(|(results, part)| {
        pending.prepare(&place, &results, part)?;
        Ok::<_, Failure>(results)
    });
    let results = results.transpose()?;
    pending.publish(&place)?;
    let Some(results) = results else {
        return Ok(());
    };
    if !quiet {
        say(&format!("results in {}", place.holds(&results)));
    }
    show(&results, arguments.format)
}

/// Finds the thresholds of a scenario, for one model of motion or for several, and writes them.
fn find(
    scenarios: &[Scenario],
    place: &Destination,
    factors: &Factors,
    arguments: &Arguments,
    quiet: bool,
) -> Result<Results, Failure> {
    let scenario = &scenarios[0];
    let models: Vec<Box<dyn Model>> = scenarios
        .iter()
        .map(Scenario::model)
        .collect::<Result<_, _>>()
        .map_err(|error| Failure::Input(error.to_string()))?;
    let names = scenarios.iter().map(Scenario::model_name);
    let models: Vec<(&str, &dyn Model)> = names.zip(models.iter().map(|model| &**model)).collect();
    let ground = scenario.ground_motion();
    // Opened before the work starts, so that a folder that cannot be written costs no time.
    let folder = place.open(&FILES)?;

    let runner = arguments.work.runner();
    let mut display = None;
    let watch = |progress| {
        let display = display.get_or_insert_with(|| Display::new(progress, quiet));
        display.show(progress);
        ControlFlow::Continue(())
    };
    let request = scenario.request();
    let mut found = thresholds(&models, ground, &request, factors, &runner, watch)?;
    if let Some(display) = display {
        display.finish();
    }
    for threshold in &found {
        refuse_if_nothing_is_known(threshold)?;
    }
    for (threshold, scenario) in found.iter_mut().zip(scenarios) {
        let variations = scenario.variations();
        let variations = variations.map_err(|error| Failure::Work(error.to_string()))?;
        let mut display = None;
        let watch = |progress| {
            let display = display.get_or_insert_with(|| Display::new(progress, quiet));
            display.show(progress);
            ControlFlow::Continue(())
        };
        threshold.varied = vary(
            threshold,
            &variations,
            factors,
            ground,
            &request,
            &runner,
            watch,
        )?;
        if let Some(display) = display {
            display.finish();
        }
    }

    let of_models: Vec<&Scenario> = scenarios.iter().collect();
    let results = tell(&of_models, factors, &found, arguments.figure.get()?)?;
    results.write(folder)?;
    Ok(results)
}

impl From<ThresholdError> for Failure {
    fn from(error: ThresholdError) -> Self {
        match error {
            ThresholdError::Argument(_) => Self::Input(error.to_string()),
            ThresholdError::Runner(error) => error.into(),
        }
    }
}

/// Refuses to report a threshold if not a single history could be computed.
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
