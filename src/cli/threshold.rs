//! The command `threshold`.

use archrock::output::Origin;
use archrock::studies::threshold::{AlongOptions, Factors, KeyRange, check};
use archrock::studies::{Options, Style, THRESHOLD, THRESHOLD_ALONG};

use super::Failure;
use super::scenario_file::{FileTasks, Input, SuiteOption, check_distinct};
use super::study_options::StudyArguments;

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
    let file = FileTasks {
        name: input.name(),
        tasks,
        origin,
        destination: Some(root),
    };
    study
        .execution(THRESHOLD, style, options)
        .execute(vec![file])
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
    let file = study.file(input, vec![scenario]);
    let execution = study.execution(THRESHOLD_ALONG, style, options);
    execution.execute(vec![file])
}
