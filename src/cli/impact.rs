//! The command `impact`.

use std::path::{Path, PathBuf};

use archrock::mechanics::four_link::HingeSites;
use archrock::output::Scene;
use archrock::studies::{ImpactOptions, LinkImpact, chain_result, draw_impact, four_links_result};

use super::figure::FigureOption;
use super::parsers::FirstOption;
use super::scenario_file::ScenarioFile;
use super::{Failure, Format, limit, named_files, print, show, warn};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Number of impacts to print.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    count: u16,
    /// The impact for --models, --certificate, --line and --plot, numbered from 1.
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    link: u16,
    #[command(flatten)]
    first: FirstOption,
    /// Compare the impact models.
    #[arg(long)]
    models: bool,
    /// Compare with the largest restitution of any admissible motion, with any number of hinges.
    #[arg(long)]
    certificate: bool,
    /// Number of equal parts into which --certificate cuts an arch without voussoirs [default: 720].
    #[arg(long, value_name = "N", requires = "certificate", value_parser = clap::value_parser!(u16).range(12..=10_000))]
    joints: Option<u16>,
    /// Write the impulse line to this CSV file; `-` prints it instead of the chain.
    #[arg(long, value_name = "FILE")]
    line: Option<PathBuf>,
    /// Also draw the impact to this SVG file: mechanisms, bodies, impulse line.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOption,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Arguments {
    /// Returns true if an option for arches only is given.
    fn of_arches_only(&self) -> bool {
        self.models || self.certificate || self.line.is_some() || self.plot.is_some()
    }
}

pub fn impact(arguments: &Arguments) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = input.without_moved_springings(input.read(None)?)?;
    let fits = scenario.check_without_live_loads();
    fits.map_err(|message| input.input_error(message))?;
    warn(&scenario.unlikely_values());
    let (first, count) = (arguments.first.sway, usize::from(arguments.count));
    if !scenario.structure.has_horizontal_thrust() && !arguments.of_arches_only() {
        let model = scenario.mechanisms();
        let model = model.map_err(|error| input.input_error(error.to_string()))?;
        let answer = chain_result(&scenario, &*model, first, count)?;
        return show(&answer.json, &answer.text, arguments.format);
    }
    let options = "--models, --certificate, --line and --plot are";
    let model = limit::four_links(&scenario, options);
    let impact = LinkImpact {
        model: &model.map_err(|wrong| input.with_file_name(wrong))?,
        first: first.unwrap_or_default(),
        index: arguments.link.into(),
    };
    let index = impact.index;
    let line = arguments.line.as_deref();
    let (alone, others) = (
        line == Some(Path::new("-")),
        arguments.models || arguments.certificate || arguments.plot.is_some(),
    );
    if alone && others {
        let message = "--line - prints the impulse line only: drop --models, --certificate and --plot, or give \
                       --line a file";
        return Err(message.into());
    }
    if (others || line.is_some()) && impact.mechanism_before().is_none() {
        let message = "an earlier impact stops the arch; give a smaller number";
        return Err(format!("--link {index}: {message}").into());
    }
    if let Some(path) = line {
        write_line(path, &impact)?;
        if alone {
            return Ok(());
        }
    }
    if let Some(plot) = &arguments.plot {
        let scene = Scene::new(&scenario.structure);
        let picture = draw_impact(arguments.figure.get()?, &impact, &scene);
        let picture = picture.ok_or_else(|| {
            format!("--plot: impact {index} stops the arch; there is no mechanism after it to draw")
        })?;
        named_files::write_picture(plot, &picture)?;
    }
    let sites = impact.chain().sites;
    if let (HingeSites::Voussoirs(count), Some(_)) = (sites, arguments.joints) {
        let message = "voussoirs, whose joints are used; leave it out";
        return Err(format!("--joints: the arch has {count} {message}").into());
    }
    let options = ImpactOptions {
        count,
        models: arguments.models,
        certificate: arguments.certificate,
        joints: arguments.joints.map(usize::from),
    };
    let answer = four_links_result(&scenario, &impact, &options)?;
    show(&answer.json, &answer.text, arguments.format)
}

fn write_line(path: &Path, impact: &LinkImpact<'_>) -> Result<(), Failure> {
    if impact.mechanism_after().is_none() {
        let message = format!("no mechanism can follow impact {}", impact.index);
        return Err(format!("--line: {message}, so it has no impulse line").into());
    }
    let table = impact.line_table().ok_or(
        "--line: a prescribed restitution coefficient has no impulse line; \
         choose another impact model in the scenario",
    )??;
    if path == Path::new("-") {
        return print(&String::from_utf8_lossy(&table));
    }
    if path.exists() && !path.is_file() {
        let message = "not a regular file; use - for standard output";
        return Err(format!("--line {}: {message}", path.display()).into());
    }
    named_files::write_named(path, &table, "--line")
}
