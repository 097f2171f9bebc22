//! The commands `map` and `suite`, and `merge`, which joins the parts of a study.

use std::path::{Path, PathBuf};

use archrock::output::{Figure, pretty};
use archrock::scenario::Scenario;
use archrock::studies::catalogue::{StudyError, StudyKind, merge as merged};
use archrock::studies::ensemble::cells::CellsOfSamples;
use archrock::studies::map::OverturningMap;
use archrock::studies::peaks;
use archrock::studies::results::{Look, Results};
use clap::ValueEnum;
use serde_json::Map;

use super::figure::FigureOption;
use super::run::Models;
use super::scenario_file::{Destination, Input};
use super::study::{HingesOption, Options, Pending, say};
use super::uncertain::{Asked, ITSELF, Telling};
use super::{Failure, Format, print};
use archrock::studies::kept::{MAP, Origin, SUITE, Writer};

#[derive(clap::Args)]
pub struct MapArguments {
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    map: MapOption,
    #[command(flatten)]
    hinges: HingesOption,
    #[command(flatten)]
    figure: FigureOption,
}

#[derive(clap::Args)]
pub struct SuiteArguments {
    #[command(flatten)]
    options: Options,
    /// Models of motion; several write to a folder each, named after the model, and the distributions of their peaks are compared
    /// [default: the scenario's own choice].
    #[arg(long, value_enum, value_delimiter = ',')]
    hinges: Vec<Models>,
    #[command(flatten)]
    figure: FigureOption,
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

/// How the picture of a map looks.
#[derive(clap::Args, Clone, Copy)]
pub struct MapOption {
    /// What colours the surviving cells of a map.
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
    /// The look of a map.
    fn look(self, scenario: &Scenario, figure: Figure) -> Result<Look, String> {
        let by_peak = self.color == Color::Peak;
        let free_hinges = scenario.motion().hinges().has_joints();
        if by_peak && free_hinges {
            return Err(
                "--color peak goes with four links and columns: free hinges have no critical rotation"
                    .to_owned(),
            );
        }
        let factors = self.dimensionless.then(|| Look::dimensionless(scenario));
        Ok(Look {
            figure,
            by_peak,
            factors: factors
                .transpose()
                .map_err(|wrong| format!("--dimensionless {wrong}"))?,
        })
    }

    /// The look of a map of probability.
    fn of_samples(self, scenario: &Scenario, figure: Figure) -> Result<Look, String> {
        if self.color != Color::Outcome {
            return Err(
                "--color is about maps of outcomes, and these are parts of a map of probability"
                    .to_owned(),
            );
        }
        self.look(scenario, figure)
    }

    /// The look of a study that is not a map.
    fn of_no_map(self, figure: Figure) -> Result<Look, String> {
        if self.dimensionless || self.color != Color::Outcome {
            return Err("--color and --dimensionless are for maps only".to_owned());
        }
        Ok(Look::of(figure))
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Scenario(message) => Self::Input(message),
            StudyError::Runner(error) => error.into(),
            StudyError::Part(error) => error.into(),
            StudyError::Read(error) => error.into(),
            StudyError::Output(error) => error.into(),
        }
    }
}

pub fn map(arguments: &MapArguments, quiet: bool) -> Result<(), Failure> {
    let options = &arguments.options;
    let input = options.open()?;
    let scenario = arguments.hinges.read(&input, quiet)?;
    OverturningMap::of(&scenario).map_err(|message| input.about(Failure::Input(message)))?;
    let look = arguments.map.look(&scenario, arguments.figure.get()?);
    let look = look.map_err(Failure::Input)?;
    if scenario.uncertain().is_some() {
        CellsOfSamples::of(&scenario).map_err(|message| input.about(Failure::Input(message)))?;
    }
    let place = options.place(MAP, (&input, &scenario), arguments.figure, quiet)?;
    let mut pending = Pending::default();
    let results = with_samples(
        StudyKind::Map,
        Asked::Map(look),
        options,
        (&input, &scenario),
        (look, &place),
        &mut pending,
        quiet,
    )?;
    publish_if_whole(results, &place, pending, options.format(), quiet)
}

/// Computes a study of a scenario, and then that of its samples, whose words come first. A part of a scenario with samples is one of
/// these. Returns the results, which are prepared; `None` for a part.
fn with_samples(
    kind: StudyKind,
    asked: Asked,
    options: &Options,
    (input, scenario): (&Input<'_>, &Scenario),
    (look, place): (Look, &Destination),
    pending: &mut Pending,
    quiet: bool,
) -> Result<Option<Results>, Failure> {
    let samples = Telling {
        work: options.work(),
        figure: look.figure,
        quiet,
    };
    let mut own = None;
    if scenario.uncertain().is_none() || !samples.work.is_part() {
        own = options.compute(kind, input, scenario, (look, place), (pending, quiet))?;
    }
    let likely = samples.tell(scenario, asked, place, pending)?;
    if let (Some(own), Some(likely)) = (&mut own, likely) {
        own.words.insert_str(0, &(likely.words + ITSELF + "  "));
        own.summary["uncertain"] = likely.summary;
    }
    Ok(own)
}

/// Publishes and reports results; a part has none.
fn publish_if_whole(
    results: Option<Results>,
    place: &Destination,
    pending: Pending,
    format: Format,
    quiet: bool,
) -> Result<(), Failure> {
    pending.publish(place)?;
    results.map_or(Ok(()), |results| show(&results, place, format, quiet))
}

pub fn suite(arguments: &SuiteArguments, quiet: bool) -> Result<(), Failure> {
    let options = &arguments.options;
    let input = options.open()?;
    let scenarios = Models::read(&arguments.hinges, &input)?;
    if !quiet {
        super::warn(&scenarios[0].unlikely());
        if let Some(ignored) = scenarios.iter().find_map(Scenario::ignored) {
            say(ignored);
        }
    }
    let look = Look::of(arguments.figure.get()?);
    let place = options.place(SUITE, (&input, &scenarios[0]), arguments.figure, quiet)?;
    let mut pending = Pending::default();
    let mut compute = |scenario: &Scenario, place: &Destination| {
        let asked = Asked::Suite;
        with_samples(
            StudyKind::Suite,
            asked,
            options,
            (&input, scenario),
            (look, place),
            &mut pending,
            quiet,
        )
    };
    if let [scenario] = &scenarios[..] {
        let results = compute(scenario, &place)?;
        return publish_if_whole(results, &place, pending, options.format(), quiet);
    }
    let mut all = Vec::new();
    for scenario in &scenarios {
        let name = scenario.motion().hinges().name();
        let place = place.within(name);
        if let Some(results) = compute(scenario, &place)? {
            all.push((scenario, place, results));
        }
    }
    let (mut models, mut summaries) = (Vec::new(), Map::new());
    for (scenario, _, results) in &all {
        let motion = scenario.motion();
        models.push((motion.words(), results.peaks.clone()));
        summaries.insert(motion.hinges().name().to_owned(), results.summary.clone());
    }
    let compared = compare(scenarios[0].title(), &models, &place, look.figure)?;
    pending.publish(&place)?;
    for (scenario, place, results) in &all {
        if !quiet {
            say(scenario.motion().words());
        }
        show(results, place, Format::Text, quiet)?;
    }
    if let (Some(compared), false) = (&compared, quiet) {
        say(&compared.words);
    }
    if let Format::Json = options.format() {
        let peaks = compared.map(|compared| ("peaks".to_owned(), compared.summary));
        summaries.extend(peaks);
        print(&pretty(&summaries.into()))?;
    }
    Ok(())
}

/// Compares how far models of motion rock in the same cases, in a folder beside theirs. `None` where there are not several.
pub fn compare(
    title: Option<&str>,
    models: &[(&str, Vec<f64>)],
    place: &Destination,
    figure: Figure,
) -> Result<Option<Results>, Failure> {
    if models.len() < 2 {
        return Ok(None);
    }
    let models: Vec<(&str, &[f64])> = models
        .iter()
        .map(|(name, peaks)| (*name, &peaks[..]))
        .collect();
    let results = peaks::results(
        title.unwrap_or("Largest rotations of several models"),
        &models,
        figure,
    );
    let results = results.map_err(StudyError::from)?;
    place.of_models().prepare(&results)?;
    Ok(Some(results))
}

pub fn merge(arguments: &MergeArguments, quiet: bool) -> Result<(), Failure> {
    let (parts, figure) = (&arguments.parts, arguments.figure.get()?);
    let beside = parts[0].parent();
    let beside = beside.filter(|folder| !folder.as_os_str().is_empty());
    let beside = beside.unwrap_or(Path::new("."));
    let place = Destination::of(arguments.out.as_deref().unwrap_or(beside));
    let place = arguments.figure.printed(place);
    let (kind, results) = merged(parts, None, |kind, scenario| match (kind, scenario) {
        (StudyKind::Map, Some(scenario)) => arguments.map.look(scenario, figure),
        (StudyKind::UncertainMap, Some(scenario)) => arguments.map.of_samples(scenario, figure),
        _ => arguments.map.of_no_map(figure),
    })?;
    let origin = Origin::of_summary(&results.summary).unwrap_or_default();
    let writer = Writer::merge(kind);
    let place = place.locked_for(writer, &origin, quiet)?;
    // Samples are merged into a folder inside that of their command.
    let around = place.path().parent();
    let around = around.filter(|_| place.path().ends_with(kind.name()) && !quiet);
    if let Some(around) = around {
        super::warn(&writer.warnings(around, &origin));
    }
    place.prepare(&results)?;
    place.publish()?;
    show(&results, &place, arguments.format, quiet)
}

/// Reports results that are published.
fn show(
    results: &Results,
    place: &Destination,
    format: Format,
    quiet: bool,
) -> Result<(), Failure> {
    if let Format::Json = format {
        print(&pretty(&results.summary))?;
    } else if !quiet {
        say(&results.words);
        say(&format!("  results in {}", place.holds(results)));
    }
    Ok(())
}
