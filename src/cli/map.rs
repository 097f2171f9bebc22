//! The command `map`.

use std::io::Write as _;

use archrock::dynamics::history::Outcome;
use archrock::output::map::{self as output, Look};
use archrock::output::{Figure, map_page};
use archrock::scenario::{Quantity, Scenario};
use archrock::studies::boundary::{MapRow, MapWithBoundary};
use archrock::studies::map::{CellResult, CellRow, OverturningMap};
use clap::ValueEnum;

use super::Failure;
use super::figure::FigureOption;
use super::scenario_file::Destination;
use super::study::{
    HingesOption, Options, counts, failed_in_words, in_words, say, uncertain_in_words,
    write_summary,
};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    boundary: BoundaryOption,
    #[command(flatten)]
    look: LookOption,
    #[command(flatten)]
    hinges: HingesOption,
    #[command(flatten)]
    figure: FigureOption,
}

/// What the results of a map may have besides.
#[derive(clap::Args, Clone, Copy)]
pub struct BoundaryOption {
    /// Also write the least amplitude that overturns without impact, as no_impact.csv.
    #[arg(long)]
    no_impact: bool,
}

/// How the picture of a map looks.
#[derive(clap::Args, Clone, Copy)]
pub struct LookOption {
    /// What the cells of a map that survive are coloured by.
    #[arg(long, value_enum, value_name = "WHAT", default_value_t)]
    color: Color,
    /// Draw a map over p t_p and a / A_L; its axes are duration_s and amplitude_g.
    #[arg(long)]
    dimensionless: bool,
}

/// What tells survivors apart.
#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum Color {
    /// Their outcome.
    #[default]
    Outcome,
    /// Their largest rotation over the critical one.
    Peak,
}

impl LookOption {
    /// For what is no map.
    pub fn refuse(self) -> Result<(), Failure> {
        if self.dimensionless || self.color != Color::Outcome {
            let message = "--color and --dimensionless are about maps";
            return Err(Failure::Input(message.to_owned()));
        }
        Ok(())
    }

    fn look(self, scenario: &Scenario, figure: Figure) -> Result<Look, Failure> {
        let by_peak = self.color == Color::Peak;
        if by_peak && scenario.free_hinges.is_some() {
            let message = "--color peak goes with four links and columns: free hinges have no critical rotation";
            return Err(Failure::Input(message.to_owned()));
        }
        let factors = self
            .dimensionless
            .then(|| Look::dimensionless(scenario))
            .transpose()
            .map_err(|wrong| Failure::Input(format!("--dimensionless {wrong}")))?;
        Ok(Look {
            figure,
            by_peak,
            factors,
        })
    }
}

const PICTURE: &str = "map.svg";
/// The same with a cursor.
const PAGE: &str = "map.html";
const SUMMARY: &str = "map.json";
const BOUNDARY: &str = "no_impact.csv";
/// Written last: a folder that has it is complete.
const TABLE: &str = "map.csv";

pub fn map(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let options = &arguments.options;
    let input = options.open()?;
    let scenario = arguments.hinges.read(&input, quiet)?;
    let map = overturning_map(&scenario).map_err(|failure| input.about(failure))?;
    let study = MapWithBoundary::new(&map);
    arguments.boundary.check(&study)?;
    let look = arguments.look.look(&scenario, arguments.figure.get())?;
    let place = options.results(&input)?;
    let Some((rows, part)) = options.compute(&study, &place, quiet)? else {
        return Ok(());
    };
    finish(&map, rows, &place, (arguments.boundary, look), quiet)?;
    Ok(part.remove()?)
}

fn overturning_map(scenario: &Scenario) -> Result<OverturningMap<'_>, Failure> {
    if scenario.initial.is_some() {
        let message = "the histories of a map start from rest: leave [initial] out";
        return Err(Failure::Input(message.to_owned()));
    }
    let map = OverturningMap::new(scenario).ok_or_else(|| {
        let message = "the scenario has no [map]: give it a table with two axes, such as\n\n\
                       [map]\n\
                       duration_s = { from = 0.05, to = 1.0, count = 40 }\n\
                       amplitude_g = { from = 0.1, to = 1.5, count = 40 }";
        Failure::Input(message.to_owned())
    })?;
    if let Some(fault) = map.fault() {
        let message = format!("no cell of [map] has a scenario: {fault}");
        return Err(Failure::Input(message));
    }
    Ok(map)
}

impl BoundaryOption {
    fn check(self, study: &MapWithBoundary<'_>) -> Result<(), Failure> {
        if self.no_impact && study.map().has_free_hinges() {
            let message = "--no-impact is about four links, and the hinges of this map are free: leave it out, or \
                           give --hinges four";
            return Err(Failure::Input(message.to_owned()));
        }
        if study.has_boundary() {
            return Ok(());
        }
        self.refuse()
    }

    /// For what has no such boundary.
    pub fn refuse(self) -> Result<(), Failure> {
        if self.no_impact {
            let message = "--no-impact is about maps one of whose axes is amplitude_g";
            return Err(Failure::Input(message.to_owned()));
        }
        Ok(())
    }
}

/// The results of a map whose rows are all there, from several parts of it.
pub fn merge(
    scenario: &str,
    rows: Vec<MapRow>,
    place: &Destination,
    (boundary, look): (BoundaryOption, LookOption),
    figure: Figure,
    quiet: bool,
) -> Result<(), Failure> {
    let scenario = Scenario::parse(scenario, "the scenario of the parts")?;
    let map = overturning_map(&scenario)?;
    boundary.check(&MapWithBoundary::new(&map))?;
    let look = look.look(&scenario, figure)?;
    finish(&map, rows, place, (boundary, look), quiet)
}

/// Writes the results.
fn finish(
    map: &OverturningMap<'_>,
    rows: Vec<MapRow>,
    place: &Destination,
    (boundary, look): (BoundaryOption, Look),
    quiet: bool,
) -> Result<(), Failure> {
    let scenario = map.scenario();
    let (cells, boundaries) = MapRow::sorted(rows);
    let mut files = vec![PICTURE, PAGE, SUMMARY, TABLE];
    if boundary.no_impact {
        files.insert(0, BOUNDARY);
    }
    let mut folder = place.open(&files)?;
    if boundary.no_impact {
        output::write_boundaries(folder.file(BOUNDARY), map.axes()[0], &boundaries)?;
    } else {
        folder.forget(BOUNDARY);
    }
    let title = scenario.title.as_deref().unwrap_or("Overturning map");
    let picture = output::draw(title, map, &cells, &boundaries, look);
    folder
        .file(PICTURE)
        .write_all(picture.as_bytes())
        .map_err(|error| Failure::Work(format!("cannot write the picture: {error}")))?;
    let page = map_page::page(title, map, &cells, &boundaries, look);
    folder
        .file(PAGE)
        .write_all(page.as_bytes())
        .map_err(|error| Failure::Work(format!("cannot write the page: {error}")))?;
    let remarks = output::remarks(map, &cells, &boundaries);
    write_summary(folder.file(SUMMARY), scenario, cells.len(), &remarks)?;
    output::write_table(folder.file(TABLE), map, &cells)?;
    folder.complete()?;
    if !quiet {
        say(&summary(&cells));
        if map.has_spread() {
            say(&format!(
                "  {} of them have another outcome in a repetition, be it only rest instead of rocking on",
                output::doubtful(&cells)
            ));
        }
        if map.has_free_hinges() && map.axes()[1].quantity == Quantity::Amplitude {
            say(
                "  free hinges: without the boundary of overturning without impact, which is of four links",
            );
        }
        if let Some(words) = uncertain_in_words(&remarks.uncertain, SUMMARY) {
            say(&format!("  {words}"));
        }
        if let Some(words) = failed_in_words(&remarks.failures, SUMMARY) {
            say(&format!("  {words}"));
        }
        say(&format!(
            "  results in {}: {}",
            place.path().display(),
            files.join(", ")
        ));
    }
    Ok(())
}

/// How many cells came to what.
fn summary(cells: &[CellRow]) -> String {
    let words = |cell: &CellRow| match &cell.result {
        CellResult::Ended(ending)
            if ending.uncertain.is_none() && ending.outcome == Outcome::StillRocking =>
        {
            (3, "are still rocking at duration_s of [simulation]")
        }
        CellResult::Ended(ending) => in_words(ending),
        CellResult::CannotStand => (5, "cannot stand"),
        CellResult::NotFourLinks => (6, "are too thick for four links"),
        CellResult::Failed(_) => (7, "failed"),
    };
    format!("{} cells: {}", cells.len(), counts(cells.iter().map(words)))
}
