//! The command `threshold`.

use std::path::PathBuf;

use archrock::scenario::Scenario;
use archrock::studies::catalogue::{self, Options};
use archrock::studies::kept::{ALONG, Origin, THRESHOLD};
use archrock::studies::results::{Look, Results};
use archrock::studies::threshold::along::{Along, AlongOptions, KeyRange};
use archrock::studies::threshold::{FILES, Factors, check, results};

use super::figure::FigureOption;
use super::models::{ModelsOption, warn_of};
use super::progress::say;
use super::scenario_file::{Destination, Input, ScenarioFile, SuiteOption};
use super::study::{Pending, Session, Work};
use super::{Failure, Format, print, print_all, show};

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
    #[command(flatten)]
    models: ModelsOption,
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
    let session = Session {
        input: Some(&input),
        work: arguments.work,
        look: Look::of(arguments.figure.get()?),
        quiet,
    };
    if let Some(along) = &arguments.along {
        return thresholds_along(arguments, along, factors, session, &input);
    }
    let models = arguments.models.read(&input)?;
    let origin = Origin::of(&models[0]);
    let about = |failure| input.about(failure);
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
    let is_part = arguments.work.is_part();
    let root = if is_part {
        root.locked_for_a_part(THRESHOLD)?
    } else {
        root.locked_for(THRESHOLD, &origin, quiet)?
    };
    let title = tasks[0].0[0].title();
    let title = title.map_or(String::new(), |title| format!("{title}\n"));
    let options = Options {
        factors,
        ..Options::default()
    };
    let mut all = Vec::new();
    for (scenarios, place) in tasks {
        let mut pending = Pending::default();
        let (scenarios, place) = (&scenarios[..], &place.locked_with(&root));
        if !quiet {
            super::warn(&scenarios[0].unlikely());
        }
        let mut found = if session.is_part(scenarios)? {
            Results::default()
        } else {
            find(scenarios, place, &factors, session)?
        };
        let samples = catalogue::UNCERTAIN_THRESHOLD;
        session.add_samples(
            samples,
            scenarios,
            &options,
            place,
            &mut pending,
            &mut found,
        )?;
        pending.publish(place)?;
        if !is_part && !quiet {
            say(&format!("results in {}", place.holds(&found)));
        }
        all.push(found);
    }
    match arguments.format {
        Format::Json => print_all(all.into_iter().map(|results| results.summary)),
        Format::Text => {
            let words: String = all.into_iter().map(|results| results.words).collect();
            print(&format!("{title}{words}  {}\n", factors.in_words()))
        }
    }
}

/// Finds the thresholds of a scenario, for one model of motion or for several, and writes them.
fn find(
    scenarios: &[Scenario],
    place: &Destination,
    factors: &Factors,
    session: Session<'_>,
) -> Result<Results, Failure> {
    // Opened before the work starts, so that a folder that cannot be written costs no time.
    let folder = place.open(&FILES)?;
    let scenarios: Vec<&Scenario> = scenarios.iter().collect();
    let (figure, runner) = (session.look.figure, session.work.runner());
    let found = session.watch(
        |_| "interrupted".to_owned(),
        |watch| results(&scenarios, factors, figure, &runner, watch),
    )?;
    found.write(folder)?;
    Ok(found)
}

/// Finds the threshold for each value of a key.
fn thresholds_along(
    arguments: &Arguments,
    along: &KeyRange,
    factors: Factors,
    session: Session<'_>,
    input: &Input<'_>,
) -> Result<(), Failure> {
    let about = |message| input.about(Failure::Input(message));
    let scenario = arguments.models.read_one(input, "--along")?;
    if scenario.uncertain().is_some() {
        let message = "--along varies one key and ignores [uncertain]: give --no-uncertain";
        return Err(about(message.to_owned()));
    }
    warn_of(std::slice::from_ref(&scenario), session.quiet);
    let along = AlongOptions {
        along: along.clone(),
        factors,
        no_impact: arguments.no_impact,
    };
    Along::of(&scenario, along.clone()).map_err(about)?;
    let place = arguments
        .figure
        .printed(input.results(arguments.out.as_deref())?);
    let place = arguments
        .work
        .lock(place, ALONG, &scenario, session.quiet)?;
    let options = Options {
        along: Some(along),
        ..Options::default()
    };
    let mut pending = Pending::default();
    let kind = catalogue::THRESHOLD_ALONG;
    let found = session.compute(kind, &scenario, &options, &place, &mut pending)?;
    pending.publish(&place)?;
    let Some(found) = found else {
        return Ok(());
    };
    if !session.quiet {
        say(&format!("results in {}", place.holds(&found)));
    }
    show(&found, arguments.format)
}
