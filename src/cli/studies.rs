//! The commands `map` and `suite`, and `merge`, which joins the parts of a study.

use std::path::{Path, PathBuf};
use std::slice;

use archrock::output::{Figure, Folder, Manifest, Origin, pretty};
use archrock::scenario::{Scenario, Varied};
use archrock::studies::ensemble::CellsOfSamples;
use archrock::studies::map::OverturningMap;
use archrock::studies::{
    MAP, Options, SUITE, StudyKind, Style, UNCERTAIN_MAP, UNCERTAIN_SUITE, merge as merged,
    quoted_in_words, read_header,
};
use clap::ValueEnum;
use serde_json::Value;

use super::figure::FigureOption;
use super::models::warn_of;
use super::progress::print_status;
use super::scenario_file::{Destination, Input};
use super::study::{CommandResults, StudyArguments, describe, publish};
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
        if by_peak && model.has_joints {
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
    let scenario = study.models.read_one(&input, "map")?;
    warn_of(slice::from_ref(&scenario), &Varied::default());
    OverturningMap::of(&scenario).map_err(|message| input.input_error(message))?;
    let style = arguments.map.style(&scenario, study.figure.get()?)?;
    if scenario.uncertain.is_some() {
        CellsOfSamples::of(&scenario).map_err(|message| input.input_error(message))?;
    }
    let kinds = [MAP, UNCERTAIN_MAP];
    compute(kinds, study, &input, &[scenario], style)
}

pub fn suite(study: &StudyArguments) -> Result<(), Failure> {
    let input = study.open()?;
    let scenarios = study.models.read(&input)?;
    let mut known = scenarios.iter().map(Scenario::check_restitution);
    let known = known.find(Result::is_err).unwrap_or(Ok(()));
    known.map_err(|message| input.input_error(message))?;
    warn_of(&scenarios, &Varied::default());
    let style = Style::of(study.figure.get()?);
    let kinds = [SUITE, UNCERTAIN_SUITE];
    compute(kinds, study, &input, &scenarios, style)
}

/// Computes a study and the study of its samples, for each of the scenarios, which differ in their models of motion. Publishes and prints the
/// results.
fn compute(
    kinds: [StudyKind; 2],
    study: &StudyArguments,
    input: &Input<'_>,
    scenarios: &[Scenario],
    style: Style,
) -> Result<(), Failure> {
    let mut job = study.job(
        input,
        style,
        Options::default(),
        kinds[0],
        Origin::of(&scenarios[0]),
    )?;
    let (root, several) = (job.root.clone(), scenarios.len() > 1);
    let mut all = Vec::new();
    for one in scenarios.chunks(1) {
        let model = one[0].motion.kind;
        let folder = root.as_ref().map(|root| root.of_model(model, several));
        let found = job.compute_with_samples(kinds, one, folder.as_ref())?;
        all.extend(found.map(|found| (&one[0], folder, found)));
    }
    let models = all.iter().map(|(one, _, found)| (*one, &found.own));
    let models: Vec<_> = models.collect();
    let compared = job.compare(kinds[0], &models, root.as_ref())?;
    job.publish()?;
    if let (false, [(_, folder, found)]) = (several, &all[..]) {
        return show(found, kinds[0], folder.as_ref(), study.format);
    }
    let mut summaries = Vec::new();
    for (one, folder, found) in &all {
        let model = one.motion.kind;
        print_status(model.label);
        show(found, kinds[0], folder.as_ref(), Format::Text)?;
        summaries.push((model.option.to_owned(), found.summary(kinds[0])?));
    }
    let answers = all
        .iter()
        .filter_map(|(.., found)| found.own.answer.clone());
    let to_quote = quoted_in_words(&answers.collect::<Vec<_>>());
    if let Some(compared) = compared {
        print_status(&compared.words);
        summaries.push(("peaks".to_owned(), compared.summary));
    }
    if let Some(to_quote) = to_quote {
        print_status(&to_quote);
        summaries.push(("to_quote".to_owned(), to_quote.into()));
    }
    match study.format {
        Format::Json if !all.is_empty() => {
            print(&pretty(&summaries.into_iter().collect::<Value>()))
        }
        _ => Ok(()),
    }
}

pub fn merge(arguments: &MergeArguments) -> Result<(), Failure> {
    let (parts, figure) = (&arguments.parts, arguments.figure.get()?);
    let beside = parts[0].parent();
    let beside = beside.filter(|folder| !folder.as_os_str().is_empty());
    let beside = beside.unwrap_or(Path::new("."));
    let destination = Destination::of(arguments.out.as_deref().unwrap_or(beside));
    let mut style =
        |kind, scenario: Option<&Scenario>| arguments.map.merged(kind, scenario, figure);
    let (kind, results) = merged(parts, None, &mut style)?;
    let header = read_header(&parts[0])?;
    let origin = Origin::of_summary(&results.summary).with_records(header.inputs);
    let origin = origin.with_inputs(parts);
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
    let found = CommandResults::alone(results);
    show(&found, kind, Some(&folder), arguments.format)
}

/// Prints published results.
fn show(
    found: &CommandResults,
    kind: StudyKind,
    folder: Option<&Folder>,
    format: Format,
) -> Result<(), Failure> {
    if let Format::Json = format {
        return print(&pretty(&found.summary(kind)?));
    }
    print_status(&found.words(""));
    if let Some(folder) = folder {
        print_status(&format!("  results in {}", describe(folder, &found.own)));
    }
    Ok(())
}
