//! The command `limit`.

use std::path::PathBuf;

use archrock::output::Scene;
use archrock::scenario::Scenario;
use archrock::studies::{LIMIT, Options, draw_limit};
use archrock::{FourLinkError, FourLinks};

use super::Failure;
use super::capacity_spread_verify::{CommonArguments, execution};
use super::figure::FigureOption;
use super::named_files::write_picture;
use super::parsers::FirstOption;
use super::scenario_file::Destination;

#[derive(clap::Args)]
#[command(mut_arg("out", |out| out
    .help("Also write a page, the picture and the JSON to this folder")
    .conflicts_with_all(["plot", "sway"])))]
pub struct LimitArguments {
    #[command(flatten)]
    common: CommonArguments,
    /// Also draw the mechanism and the thrust line to this SVG file.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    first: FirstOption,
    #[command(flatten)]
    figure: FigureOption,
}

pub fn limit(arguments: &LimitArguments) -> Result<(), Failure> {
    let common = &arguments.common;
    let input = common.scenario.open()?;
    let mut scenario = input.read_statics()?;
    if let Some(plot) = &arguments.plot {
        scenario = input.without_moved_springings(scenario)?;
        let first = arguments.first.sway.unwrap_or_default();
        let model =
            four_links(&scenario, "--plot is").map_err(|wrong| input.with_file_name(wrong))?;
        let (figure, scene) = (arguments.figure.get()?, Scene::new(&scenario.structure));
        let picture = draw_limit(figure, &model, first, &scene);
        write_picture(plot, &picture)?;
    }
    let out = common.out.as_deref();
    let file = input.task(vec![scenario], out.map(Destination::of));
    let execution = execution(LIMIT, common, arguments.figure, Options::default())?;
    execution.execute(vec![file])
}

/// Makes the four-link model of a scenario. `what` is the subject and verb of the error for a column.
pub fn four_links(scenario: &Scenario, what: &str) -> Result<FourLinks, Failure> {
    let model = scenario.structure.four_links(scenario.motion.impact());
    model
        .map_err(|error| {
            Failure::Input(match error {
                FourLinkError::Ties => {
                    format!("{what} for arches without ties only: four links take none")
                }
                error => error.to_string(),
            })
        })?
        .ok_or_else(|| Failure::Input(format!("{what} for arches only; the scenario has a column")))
}
