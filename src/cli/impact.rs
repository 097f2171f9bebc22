//! The command `impact`.

use std::path::{Path, PathBuf};

use archrock::mechanics::four_link::mechanism::HingeSites;
use archrock::output::Folder;
use archrock::output::scene::Scene;
use archrock::studies::impact::{LinkImpact, Question, chain_answer, four_links_answer};
use archrock::studies::pictures;

use super::figure::FigureOption;
use super::first::FirstOption;
use super::scenario_file::ScenarioFile;
use super::{Failure, Format, commands, print};

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
    /// Whether an option for arches only is given.
    fn of_arches_only(&self) -> bool {
        self.models || self.certificate || self.line.is_some() || self.plot.is_some()
    }
}

pub fn impact(arguments: &Arguments) -> Result<(), Failure> {
    let scenario = arguments.scenario.open()?.read_as_built()?;
    let (first, count) = (arguments.first.get(), usize::from(arguments.count));
    if !scenario.structure().thrusts() && !arguments.of_arches_only() {
        let model = commands::model(&scenario)?;
        let answer = chain_answer(&scenario, &*model, first, count)?;
        return commands::answer(&answer, arguments.format);
    }
    let options = "--models, --certificate, --line and --plot are";
    let model = commands::four_links(&scenario, options)?;
    let model = &model;
    let impact = LinkImpact {
        model,
        first,
        index: arguments.link.into(),
    };
    let chosen = || choose(&impact);
    if let Some(path) = &arguments.line {
        let others = arguments.models || arguments.certificate || arguments.plot.is_some();
        if path == Path::new("-") && others {
            return Err(Failure::Input(
                "--line - prints the impulse line only: drop --models, --certificate and --plot, or give \
                 --line a file"
                    .to_owned(),
            ));
        }
        chosen()?;
        write_line(path, &impact)?;
        if path == Path::new("-") {
            return Ok(());
        }
    }
    if let Some(plot) = &arguments.plot {
        chosen()?;
        let scene = Scene::new(scenario.structure());
        let picture = pictures::impact(arguments.figure.get()?, &impact, &scene);
        let picture = picture.ok_or_else(|| {
            Failure::Input(format!(
                "--plot: impact {} stops the arch; there is no mechanism after it to draw",
                arguments.link
            ))
        })?;
        commands::write_picture(plot, &picture)?;
    }
    if arguments.models || arguments.certificate {
        chosen()?;
    }
    let sites = impact.chain().sites;
    if let (HingeSites::Voussoirs(count), Some(_)) = (sites, arguments.joints) {
        return Err(Failure::Input(format!(
            "--joints: the arch has {count} voussoirs, whose joints are used; leave it out"
        )));
    }
    let question = Question {
        count,
        models: arguments.models,
        certificate: arguments.certificate,
        joints: arguments.joints.map(usize::from),
    };
    let answer = four_links_answer(&scenario, &impact, &question)?;
    commands::answer(&answer, arguments.format)
}

/// Refuses an impact that never happens because an earlier one stops the arch.
fn choose(impact: &LinkImpact<'_>) -> Result<(), Failure> {
    if impact.before().is_some() {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "--link {}: an earlier impact stops the arch; give a smaller number",
        impact.index
    )))
}

fn write_line(path: &Path, impact: &LinkImpact<'_>) -> Result<(), Failure> {
    if impact.after().is_none() {
        return Err(Failure::Input(format!(
            "--line: no mechanism can follow impact {}, so it has no impulse line",
            impact.index
        )));
    }
    let table = impact.line_table().ok_or_else(|| {
        Failure::Input(
            "--line: a prescribed restitution coefficient has no impulse line; \
             choose another impact model in the scenario"
                .to_owned(),
        )
    })??;
    if path == Path::new("-") {
        return print(&String::from_utf8_lossy(&table));
    }
    let name = path.file_name().and_then(|name| name.to_str());
    let (Some(name), false) = (name, path.exists() && !path.is_file()) else {
        return Err(Failure::Input(format!(
            "--line {}: not a regular file; use - for standard output",
            path.display()
        )));
    };
    let parent = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut folder = Folder::open(parent, &[name])
        .map_err(|error| Failure::Input(format!("{error}; choose another file with --line")))?;
    folder.write(name, &table)?;
    Ok(folder.complete()?)
}
