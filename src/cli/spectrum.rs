//! The command `spectrum`.

use std::io::Write as _;

use archrock::output::ending::Remark;
use archrock::output::{Figure, spectrum as output};
use archrock::scenario::Scenario;
use archrock::studies::spectrum::{NoSpectrum, OverturningSpectrum, PointRow};

use super::Failure;
use super::figure::FigureOption;
use super::scenario_file::Destination;
use super::study::{Options, failed_in_words, say, write_summary};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    figure: FigureOption,
}

const PICTURE: &str = "spectrum.svg";
const SUMMARY: &str = "spectrum.json";
/// Written last: a folder that has it is complete.
const TABLE: &str = "spectrum.csv";

impl From<NoSpectrum> for Failure {
    fn from(error: NoSpectrum) -> Self {
        Self::Input(error.to_string())
    }
}

pub fn spectrum(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let options = &arguments.options;
    let input = options.open()?;
    let scenario = input.read(None)?;
    let spectrum =
        OverturningSpectrum::new(&scenario).map_err(|error| input.about(error.into()))?;
    let place = options.results(&input)?;
    let Some((rows, part)) = options.compute(&spectrum, &place, quiet)? else {
        return Ok(());
    };
    finish(
        &scenario,
        &spectrum,
        &rows,
        &place,
        arguments.figure.get(),
        quiet,
    )?;
    Ok(part.remove()?)
}

/// The results of a spectrum whose rows are all there, from several parts of it.
pub fn merge(
    scenario: &str,
    rows: &[PointRow],
    place: &Destination,
    figure: Figure,
    quiet: bool,
) -> Result<(), Failure> {
    let scenario = Scenario::parse(scenario, "the scenario of the parts")?;
    finish(
        &scenario,
        &OverturningSpectrum::new(&scenario)?,
        rows,
        place,
        figure,
        quiet,
    )
}

/// Writes the results.
fn finish(
    scenario: &Scenario,
    spectrum: &OverturningSpectrum<'_>,
    rows: &[PointRow],
    place: &Destination,
    figure: Figure,
    quiet: bool,
) -> Result<(), Failure> {
    let mut folder = place.open(&[PICTURE, SUMMARY, TABLE])?;
    let title = scenario.title.as_deref().unwrap_or("Overturning spectrum");
    folder
        .file(PICTURE)
        .write_all(output::draw(figure, title, spectrum, rows).as_bytes())
        .map_err(|error| Failure::Work(format!("cannot write the picture: {error}")))?;
    let remarks = output::remarks(rows);
    write_summary(folder.file(SUMMARY), scenario, rows.len(), &remarks)?;
    output::write_table(folder.file(TABLE), rows)?;
    folder.complete()?;
    if !quiet {
        say(&summary(spectrum, rows, &remarks.failures));
        say(&format!(
            "  results in {}: {PICTURE}, {SUMMARY}, {TABLE}",
            place.path().display()
        ));
    }
    Ok(())
}

/// Counts the points by outcome, and says what is uncertain.
fn summary(spectrum: &OverturningSpectrum<'_>, rows: &[PointRow], failures: &[Remark]) -> String {
    let count = |wanted: fn(Option<usize>) -> bool| {
        let impacts = rows
            .iter()
            .map(|row| row.minimum.map(|least| least.impacts));
        impacts.filter(|impacts| wanted(*impacts)).count()
    };
    let mut text = format!(
        "{} points: the weakest pulse that overturns does so without impact at {}, after impacts at {}",
        rows.len(),
        count(|impacts| impacts == Some(0)),
        count(|impacts| impacts > Some(0)),
    );
    let none = count(|impacts| impacts.is_none());
    if let Some(last) = spectrum.over_incipient().last()
        && none > 0
    {
        text += &format!("; at {none} no pulse up to {last} A_L overturns");
    }
    let rocking: usize = rows.iter().map(|row| row.still_rocking).sum();
    if rocking > 0 {
        text += &format!(
            "; {rocking} histories were still rocking long after their pulse, and count as survived"
        );
    }
    if let Some(words) = failed_in_words(failures, SUMMARY) {
        text += &format!("; {words}");
    }
    text
}
