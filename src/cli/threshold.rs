//! The command `threshold`.

use archrock::output::Origin;
use archrock::scenario::Scenario;
use archrock::studies::threshold::{AlongOptions, Factors, KeyRange, check};
use archrock::studies::{Options, Style, THRESHOLD, THRESHOLD_ALONG, UNCERTAIN_THRESHOLD};

use super::models::warn_of;
use super::progress::print_status;
use super::scenario_file::{Destination, Input, SuiteOption};
use super::study::{Session, StudyArguments};
use super::{Failure, Format, print, print_all};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    study: StudyArguments,
    #[command(flatten)]
    suite: SuiteOption,
    /// Smallest factor on the ground motion.
    #[arg(long, value_name = "FACTOR", default_value_t = Factors::default().from)]
    from: f64,
    /// Largest factor.
    #[arg(long, value_name = "FACTOR", default_value_t = Factors::default().to)]
    to: f64,
    /// Relative step from one factor to the next; narrower bands and gaps may be missed.
    #[arg(long, value_name = "PART", default_value_t = Factors::default().stride)]
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
    let along = arguments.along.clone();
    let options = Options {
        factors,
        along: along.map(|along| AlongOptions {
            along,
            factors,
            no_impact: arguments.no_impact,
        }),
        ..Options::default()
    };
    let mut session = study.session(&input, Style::of(study.figure.get()?), options);
    if arguments.along.is_some() {
        return thresholds_along(study, session, &input);
    }
    let models = study.models.read(&input)?;
    let origin = Origin::of(&models[0]);
    let root = study.place(&input)?;
    let tasks = arguments.suite.tasks(&input, models, Some(&root), check)?;
    Destination::check_distinct(&tasks)?;
    let mut scenarios = tasks.iter().flat_map(|(_, scenarios, _)| scenarios);
    if let Some(ignored) = scenarios.find_map(Scenario::ignored) {
        print_status(ignored);
    }
    let title = tasks[0].1[0].title.as_deref();
    let title = title.map_or(String::new(), |title| format!("{title}\n"));
    root.lock(THRESHOLD, origin, study.work.is_part())?;
    let mut all = Vec::new();
    for (_, scenarios, place) in &tasks {
        super::warn(&scenarios[0].unlikely());
        let kinds = [THRESHOLD, UNCERTAIN_THRESHOLD];
        let found = session.with_samples(kinds, scenarios, place.as_ref())?;
        all.extend(found.map(|found| (found, place)));
    }
    session.publish(Some(&root))?;
    for (found, place) in &all {
        if let Some(place) = place {
            print_status(&format!("results in {}", place.describe(&found.own)));
        }
    }
    match study.format {
        Format::Json => {
            let summaries = all.iter().map(|(found, _)| found.summary(THRESHOLD));
            print_all(summaries.collect::<Result<Vec<_>, _>>()?)
        }
        Format::Text => {
            let words = all.iter().map(|(found, _)| found.words("  ") + "\n");
            let words: String = words.collect();
            print(&format!("{title}{words}  {}\n", factors.in_words()))
        }
    }
}

/// Computes the threshold for each value of a key.
fn thresholds_along(
    study: &StudyArguments,
    session: Session<'_>,
    input: &Input<'_>,
) -> Result<(), Failure> {
    let scenario = study.models.read_one(input, "--along")?;
    if scenario.uncertain.is_some() {
        let message = "--along varies one key and ignores [uncertain]: give --no-uncertain";
        return Err(input.input_error(message));
    }
    warn_of(std::slice::from_ref(&scenario));
    let place = study.place(input)?;
    place.lock(THRESHOLD_ALONG, Origin::of(&scenario), study.work.is_part())?;
    session.finish(THRESHOLD_ALONG, &scenario, &place, study.format)
}
