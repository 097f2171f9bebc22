//! The commands `map` and `suite`, and `merge`, which joins the parts of a study.

use std::path::{Path, PathBuf};

use archrock::output::{Figure, Manifest, pretty};
use archrock::scenario::Scenario;
use archrock::studies;
use archrock::studies::ensemble::CellsOfSamples;
use archrock::studies::map::OverturningMap;
use archrock::studies::{MAP, Options, SUITE, StudyKind, Style, UNCERTAIN_MAP};
use clap::ValueEnum;

use super::figure::FigureOption;
use super::results::{CommandResults, DetailsOption, describe};
use super::scenario_file::Destination;
use super::study::publish;
use super::study_options::StudyArguments;
use super::{Failure, Format, print};

#[derive(clap::Args)]
pub struct MapArguments {
    #[command(flatten)]
    study: StudyArguments,
    #[command(flatten)]
    map: MapOption,
}

#[derive(clap::Args)]
pub struct MergeArguments {
    /// All parts of one study.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// Folder for the results [default: that of the first part].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Format of the printed summary; JSON goes to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    #[command(flatten)]
    details: DetailsOption,
    #[command(flatten)]
    map: MapOption,
    #[command(flatten)]
    figure: FigureOption,
}

/// The style of the picture of a map.
#[derive(clap::Args, Clone, Copy)]
pub struct MapOption {
    /// Colour of the surviving cells of a map.
    #[arg(long, value_enum, value_name = "WHAT", default_value_t)]
    color: Color,
    /// Draw the map over p t_p and a / A_L; its axes must be duration_s and amplitude_g.
    #[arg(long)]
    dimensionless: bool,
}

/// How surviving cells are coloured.
#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum Color {
    /// Their outcome.
    #[default]
    Outcome,
    /// Their largest rotation over the critical one.
    Peak,
}

impl MapOption {
    /// Returns the style of a map.
    fn style(self, scenario: &Scenario, figure: Figure) -> Result<Style, String> {
        let by_peak = self.color == Color::Peak;
        let model = scenario.motion.kind;
        if by_peak && !model.has_mechanism {
            return Err(format!(
                "--color peak goes with four links and columns: {} have no critical rotation",
                model.label
            ));
        }
        let factors = self.dimensionless.then(|| Style::dimensionless(scenario));
        let factors = factors.transpose();
        Ok(Style {
            figure,
            by_peak,
            factors: factors.map_err(|wrong| format!("--dimensionless {wrong}"))?,
        })
    }

    /// Returns the style of results that are merged.
    fn merged(
        self,
        kind: StudyKind,
        scenario: Option<&Scenario>,
        figure: Figure,
    ) -> Result<Style, String> {
        let by_peak = self.color == Color::Peak;
        let maps = [MAP, UNCERTAIN_MAP];
        match scenario.filter(|_| maps.contains(&kind)) {
            Some(_) if by_peak && kind == UNCERTAIN_MAP => {
                Err("--color applies to outcome maps only".to_owned())
            }
            Some(scenario) => self.style(scenario, figure),
            None if self.dimensionless || by_peak => {
                Err("--color and --dimensionless are for maps only".to_owned())
            }
            None => Ok(Style::of(figure)),
        }
    }
}

pub fn map(arguments: &MapArguments) -> Result<(), Failure> {
    let study = &arguments.study;
    let input = study.open()?;
    let scenarios = study.models.read(&input)?;
    let figure = study.figure.get()?;
    let mut style = Style::of(figure);
    for scenario in &scenarios {
        OverturningMap::of(scenario).map_err(|message| input.input_error(message))?;
        style = arguments.map.style(scenario, figure)?;
        if scenario.uncertain.is_some() {
            CellsOfSamples::of(scenario).map_err(|message| input.input_error(message))?;
        }
    }
    let file = study.file(&input, scenarios);
    let execution = study.execution(MAP, style, Options::default());
    execution.execute(vec![file])
}

pub fn suite(study: &StudyArguments) -> Result<(), Failure> {
    let input = study.open()?;
    let scenarios = study.models.read(&input)?;
    let mut known = scenarios.iter().map(Scenario::check_restitution);
    let known = known.find(Result::is_err).unwrap_or(Ok(()));
    known.map_err(|message| input.input_error(message))?;
    let style = Style::of(study.figure.get()?);
    let file = study.file(&input, scenarios);
    let execution = study.execution(SUITE, style, Options::default());
    execution.execute(vec![file])
}

pub fn merge(arguments: &MergeArguments) -> Result<(), Failure> {
    let (parts, figure) = (&arguments.parts, arguments.figure.get()?);
    let beside = parts[0].parent();
    let beside = beside.filter(|folder| !folder.as_os_str().is_empty());
    let beside = beside.unwrap_or(Path::new("."));
    let destination = Destination::of(arguments.out.as_deref().unwrap_or(beside));
    let mut style =
        |kind, scenario: Option<&Scenario>| arguments.map.merged(kind, scenario, figure);
    let merged = studies::merge(parts, None, &mut style)?;
    let (kind, results) = (merged.kind, merged.results);
    let origin = merged.origin.with_inputs(parts);
    // Samples are merged into a folder inside that of their command.
    let around = destination.path.parent();
    if let Some(around) = around.filter(|_| destination.path.ends_with(kind.name)) {
        let manifest = Manifest::read(around)?;
        super::warn(&manifest.warnings(around, kind.name, &origin));
    }
    let folder = destination.lock(kind.name, origin, arguments.figure.figure_format, false)?;
    folder.check(kind.files)?;
    results.write(&folder)?;
    publish(&folder)?;
    let place = describe(&folder, kind, &results, true);
    let found = CommandResults::alone(merged.model, results, place);
    match arguments.format {
        Format::Json => print(&pretty(&found.summary(kind)?)),
        Format::Text => {
            print(&found.words(kind, merged.title.as_deref(), arguments.details.get(), None))
        }
    }
}
