//! The command `threshold`.

use archrock::output::Origin;
use archrock::studies::threshold::{AlongOptions, Factors, KeyRange, check};
use archrock::studies::{Options, Style, THRESHOLD, THRESHOLD_ALONG, UNCERTAIN_THRESHOLD};

use super::models::warn_of;
use super::progress::print_status;
use super::scenario_file::{Input, SuiteOption, check_distinct};
use super::study::{StudyArguments, describe};
use super::{Failure, Format, print, print_all};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    study: StudyArguments,
    #[command(flatten)]
    suite: SuiteOption,
    /// Smallest factor on the ground motion. Default: the onset of motion, or 0.1 where it is unknown.
    #[arg(long, value_name = "FACTOR")]
    from: Option<f64>,
    /// Largest factor. Default: the first one that certainly overturns the structure.
    #[arg(long, value_name = "FACTOR")]
    to: Option<f64>,
    /// Relative step from one factor to the next, up to the first edge; below it the steps are finer.
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
    let input = study.open()?;
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
    let style = Style::of(study.figure.get()?);
    if arguments.along.is_some() {
        return thresholds_along(study, &input, style, options);
    }
    let models = study.models.read(&input)?;
    let origin = Origin::of(&models[0]);
    let tasks = arguments.suite.tasks(&input, models, |scenario| {
        check(scenario)?;
        scenario.check_restitution()
    })?;
    let root = input.results(study.out.as_deref());
    check_distinct(tasks.iter().map(|task| task.place(&root)))?;
    let scenarios = tasks.iter().flat_map(|task| &task.scenarios);
    warn_of(scenarios, &options.varied());
    let title = tasks[0].scenarios[0].title.as_deref();
    let title = title.map_or(String::new(), |title| format!("{title}\n"));
    let mut job = study.job(&input, style, options, THRESHOLD, origin)?;
    let mut all = Vec::new();
    for task in &tasks {
        let folder = job.root.as_ref().map(|root| task.folder(root));
        let kinds = [THRESHOLD, UNCERTAIN_THRESHOLD];
        let found = job.compute_with_samples(kinds, &task.scenarios, folder.as_ref());
        let found = found.map_err(|failure| match failure {
            Failure::Work(message) if tasks.len() > 1 => {
                job.failed(Failure::Work(format!("{}: {message}", task.name)))
            }
            failure => job.failed(failure),
        })?;
        all.extend(found.map(|found| (found, folder)));
    }
    job.publish()?;
    for (found, folder) in &all {
        if let Some(folder) = folder {
            print_status(&format!("results in {}", describe(folder, &found.own)));
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
            print(&format!("{title}{words}"))
        }
    }
}

/// Computes the threshold for each value of a key.
fn thresholds_along(
    study: &StudyArguments,
    input: &Input<'_>,
    style: Style,
    options: Options,
) -> Result<(), Failure> {
    let scenario = study.models.read_one(input, "--along")?;
    if scenario.uncertain.is_some() {
        let message = "--along varies one key and ignores [uncertain]: give --no-uncertain";
        return Err(input.input_error(message));
    }
    warn_of(std::slice::from_ref(&scenario), &options.varied());
    let job = study.job(
        input,
        style,
        options,
        THRESHOLD_ALONG,
        Origin::of(&scenario),
    )?;
    job.finish(THRESHOLD_ALONG, &scenario, study.format)
}
