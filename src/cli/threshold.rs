//! The command `threshold`.

use archrock::scenario::Scenario;
use archrock::studies::catalogue::{self, Options};
use archrock::studies::kept::{ALONG, THRESHOLD};
use archrock::studies::results::{Results, Style};
use archrock::studies::threshold::along::{Along, AlongOptions, KeyRange};
use archrock::studies::threshold::{FILES, Factors, check, results};

use super::models::warn_of;
use super::progress::say;
use super::scenario_file::{Destination, Input, SuiteOption};
use super::study::{Pending, Session, StudyArguments};
use super::{Failure, Format, print, print_all, show};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    study: StudyArguments,
    #[command(flatten)]
    suite: SuiteOption,
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
}

pub fn threshold(arguments: &Arguments) -> Result<(), Failure> {
    let study = &arguments.study;
    let factors = Factors::new(arguments.from, arguments.to, arguments.stride)
        .map_err(|error| format!("--from, --to, --stride: {error}"))?;
    let input = study.scenario.open()?;
    let session = Session {
        input: Some(&input),
        work: study.work,
        style: Style::of(study.figure.get()?),
    };
    if let Some(along) = &arguments.along {
        let options = AlongOptions {
            along: along.clone(),
            factors,
            no_impact: arguments.no_impact,
        };
        return thresholds_along(study, options, session, &input);
    }
    let models = study.models.read(&input)?;
    let own = models[0].clone();
    let root = study.place(&input)?;
    let tasks = tasks(arguments.suite, models, &root).map_err(|failure| input.about(failure))?;
    let mut scenarios = tasks.iter().flat_map(|(scenarios, _)| scenarios);
    if let Some(ignored) = scenarios.find_map(Scenario::ignored) {
        say(ignored);
    }
    let root = study.work.lock(root, THRESHOLD, &own)?;
    let title = tasks[0].0[0].title();
    let title = title.map_or(String::new(), |title| format!("{title}\n"));
    let mut all = Vec::new();
    for (scenarios, place) in tasks {
        super::warn(&scenarios[0].unlikely());
        all.push(find(
            &scenarios,
            &place.locked_with(&root),
            factors,
            session,
        )?);
    }
    match study.format {
        Format::Json => print_all(all.into_iter().map(|results| results.summary)),
        Format::Text => {
            let words: String = all.into_iter().map(|results| results.words).collect();
            print(&format!("{title}{words}  {}\n", factors.in_words()))
        }
    }
}

/// The scenarios, which differ in their models, and the folder for their results: one task, or one for each record of the suite.
fn tasks(
    suite: SuiteOption,
    models: Vec<Scenario>,
    root: &Destination,
) -> Result<Vec<(Vec<Scenario>, Destination)>, Failure> {
    let (mut names, mut tasks) = (Vec::new(), Vec::new());
    for (record, scenarios) in suite.choose(models)? {
        check(&scenarios[0])?;
        let place = match &record {
            Some(record) => root.of_record(record)?,
            None => root.clone(),
        };
        names.push(record.unwrap_or_default());
        tasks.push((scenarios, place));
    }
    let places = tasks.iter().map(|(_, place)| place);
    Destination::check_distinct(names.iter().map(String::as_str).zip(places))?;
    Ok(tasks)
}

/// Finds the thresholds of a scenario, for one model of motion or for several, and those of its samples, and writes them.
fn find(
    scenarios: &[Scenario],
    place: &Destination,
    factors: Factors,
    session: Session<'_>,
) -> Result<Results, Failure> {
    let (mut found, mut pending) = (Results::default(), Pending::default());
    let is_part = session.is_part(scenarios)?;
    if !is_part {
        // Opened before the work starts, so that a folder that cannot be written costs no time.
        let folder = place.open(&FILES)?;
        let scenarios: Vec<&Scenario> = scenarios.iter().collect();
        let (figure, runner) = (session.style.figure, session.work.runner());
        found = session.watch(
            |_| "interrupted".to_owned(),
            |watch| results(&scenarios, &factors, figure, &runner, watch),
        )?;
        found.write(folder)?;
    }
    let options = Options {
        factors,
        ..Options::default()
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
    if !is_part {
        say(&format!("results in {}", place.holds(&found)));
    }
    Ok(found)
}

/// Finds the threshold for each value of a key.
fn thresholds_along(
    study: &StudyArguments,
    along: AlongOptions,
    session: Session<'_>,
    input: &Input<'_>,
) -> Result<(), Failure> {
    let scenario = study.models.read_one(input, "--along")?;
    if scenario.uncertain().is_some() {
        let message = "--along varies one key and ignores [uncertain]: give --no-uncertain";
        return Err(input.wrong(message));
    }
    warn_of(std::slice::from_ref(&scenario));
    Along::of(&scenario, along.clone()).map_err(|message| input.wrong(message))?;
    let place = study.work.lock(study.place(input)?, ALONG, &scenario)?;
    let options = Options {
        along: Some(along),
        ..Options::default()
    };
    let mut pending = Pending::default();
    let kind = catalogue::THRESHOLD_ALONG;
    let found = session.compute(kind, &scenario, &options, &place, &mut pending)?;
    pending.publish(&place)?;
    found.map_or(Ok(()), |found| {
        say(&format!("results in {}", place.holds(&found)));
        show(&found, study.format)
    })
}
