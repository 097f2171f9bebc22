//! The commands `map` and `suite`, and `merge`, which joins the parts of a study.

use std::path::{Path, PathBuf};

use archrock::output::{Figure, pretty};
use archrock::scenario::Scenario;
use archrock::studies::catalogue::{self, Options, StudyKind, merge as merged};
use archrock::studies::ensemble::cells::CellsOfSamples;
use archrock::studies::kept::{MAP, Origin, SUITE, Writer};
use archrock::studies::map::OverturningMap;
use archrock::studies::peaks;
use archrock::studies::results::{Look, Results, StudyError};
use clap::ValueEnum;
use serde_json::Map;

use super::figure::FigureOption;
use super::models::{ModelsOption, warn_of};
use super::progress::say;
use super::scenario_file::Destination;
use super::study::{Arguments, Pending, Session};
use super::{Failure, Format, print};

#[derive(clap::Args)]
pub struct MapArguments {
    #[command(flatten)]
    study: Arguments,
    #[command(flatten)]
    map: MapOption,
    #[command(flatten)]
    models: ModelsOption,
    #[command(flatten)]
    figure: FigureOption,
}

#[derive(clap::Args)]
pub struct SuiteArguments {
    #[command(flatten)]
    study: Arguments,
    #[command(flatten)]
    models: ModelsOption,
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

pub fn map(arguments: &MapArguments, quiet: bool) -> Result<(), Failure> {
    let study = &arguments.study;
    let input = study.scenario.open()?;
    let scenario = arguments.models.read_one(&input, "map")?;
    let about = |message| input.about(Failure::Input(message));
    warn_of(std::slice::from_ref(&scenario), quiet);
    OverturningMap::of(&scenario).map_err(about)?;
    let look = arguments.map.look(&scenario, arguments.figure.get()?);
    let look = look.map_err(Failure::Input)?;
    if scenario.uncertain().is_some() {
        CellsOfSamples::of(&scenario).map_err(about)?;
    }
    let place = study.place(MAP, (&input, &scenario), arguments.figure, quiet)?;
    let mut pending = Pending::default();
    let session = Session {
        input: Some(&input),
        work: study.work,
        look,
        quiet,
    };
    let kinds = [catalogue::MAP, catalogue::UNCERTAIN_MAP];
    let results = with_samples(session, kinds, &scenario, &place, &mut pending)?;
    pending.publish(&place)?;
    results.map_or(Ok(()), |results| {
        show(&results, &place, study.format, quiet)
    })
}

/// Computes a study of a scenario, and then that of its samples, whose words come first. A part of a scenario with samples is one of
/// these. Returns the results, which are prepared; `None` for a part.
fn with_samples(
    session: Session<'_>,
    [own, samples]: [StudyKind; 2],
    scenario: &Scenario,
    place: &Destination,
    pending: &mut Pending,
) -> Result<Option<Results>, Failure> {
    let options = Options::default();
    let mut found = None;
    if scenario.uncertain().is_none() || !session.work.is_part() {
        found = session.compute(own, scenario, &options, place, pending)?;
    }
    let mut all = found.clone().unwrap_or_default();
    if scenario.uncertain().is_some() {
        all.words.insert_str(0, "  ");
    }
    let session = Session {
        look: session.look.of_samples(),
        ..session
    };
    let scenarios = std::slice::from_ref(scenario);
    session.add_samples(samples, scenarios, &options, place, pending, &mut all)?;
    Ok(found.map(|_| all))
}

pub fn suite(arguments: &SuiteArguments, quiet: bool) -> Result<(), Failure> {
    let study = &arguments.study;
    let input = study.scenario.open()?;
    let scenarios = arguments.models.read(&input)?;
    warn_of(&scenarios, quiet);
    let look = Look::of(arguments.figure.get()?);
    let place = study.place(SUITE, (&input, &scenarios[0]), arguments.figure, quiet)?;
    let mut pending = Pending::default();
    let session = Session {
        input: Some(&input),
        work: study.work,
        look,
        quiet,
    };
    let several = scenarios.len() > 1;
    let mut all = Vec::new();
    for scenario in &scenarios {
        let name = scenario.motion().hinges().name();
        let place = if several {
            place.within(name)
        } else {
            place.clone()
        };
        let kinds = [catalogue::SUITE, catalogue::UNCERTAIN_SUITE];
        if let Some(results) = with_samples(session, kinds, scenario, &place, &mut pending)? {
            all.push((scenario.motion().words(), results));
        }
    }
    let compared = compare(scenarios[0].title(), &all, &place, look.figure)?;
    pending.publish(&place)?;
    if let (false, [(_, results)]) = (several, &all[..]) {
        return show(results, &place, study.format, quiet);
    }
    let mut summaries = Map::new();
    for (scenario, (model, results)) in scenarios.iter().zip(&all) {
        let name = scenario.motion().hinges().name();
        if !quiet {
            say(model);
        }
        show(results, &place.within(name), Format::Text, quiet)?;
        summaries.insert(name.to_owned(), results.summary.clone());
    }
    if let (Some(compared), false) = (&compared, quiet) {
        say(&compared.words);
    }
    if let Format::Json = study.format {
        let peaks = compared.map(|compared| ("peaks".to_owned(), compared.summary));
        summaries.extend(peaks);
        print(&pretty(&summaries.into()))?;
    }
    Ok(())
}

/// Compares how far models of motion rock in the same cases, in a folder beside theirs. `None` where there are not several.
pub fn compare(
    title: Option<&str>,
    models: &[(&str, Results)],
    place: &Destination,
    figure: Figure,
) -> Result<Option<Results>, Failure> {
    if models.len() < 2 {
        return Ok(None);
    }
    let models: Vec<(&str, &[f64])> = models
        .iter()
        .map(|(name, results)| (*name, &results.peaks[..]))
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
    let mut look = |kind, scenario: Option<&Scenario>| match scenario {
        Some(scenario) if kind == catalogue::MAP => arguments.map.look(scenario, figure),
        Some(scenario) if kind == catalogue::UNCERTAIN_MAP => {
            arguments.map.of_samples(scenario, figure)
        }
        _ => arguments.map.of_no_map(figure),
    };
    let (kind, results) = merged(parts, None, &mut look)?;
    let origin = Origin::of_summary(&results.summary).unwrap_or_default();
    let writer = Writer::merge(kind);
    let place = place.locked_for(writer, &origin, quiet)?;
    // Samples are merged into a folder inside that of their command.
    let around = place.path().parent();
    let around = around.filter(|_| place.path().ends_with(kind.name) && !quiet);
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
