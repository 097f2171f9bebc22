//! The command `suite`.

use std::io::Write as _;

use archrock::output::Figure;
use archrock::output::ida;
use archrock::output::pretty;
use archrock::output::suite::{self as output, CurveInWords, Heading};
use archrock::output::survival;
use archrock::scenario::{Measure, Scenario, Suite};
use archrock::studies::suite::{CaseRow, RecordSuite, SuiteFragility};

use super::Failure;
use super::figure::FigureOption;
use super::scenario_file::Destination;
use super::study::{
    HingesOption, Options, counts, failed_in_words, in_words, say, uncertain_in_words,
};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    hinges: HingesOption,
    #[command(flatten)]
    figure: FigureOption,
}

const PICTURE: &str = "suite.svg";
/// How far each record drives the structure.
const IDA: &str = "ida.svg";
const LEVELS: &str = "fragility.csv";
const FRAGILITY: &str = "fragility.json";
/// Written last: a folder that has it is complete.
const TABLE: &str = "suite.csv";

pub fn suite(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let options = &arguments.options;
    let input = options.open()?;
    let scenario = arguments.hinges.read(&input, quiet)?;
    let suite = suite_of(&scenario).map_err(|failure| input.about(failure))?;
    let study = RecordSuite::new(&scenario, suite)
        .map_err(|error| input.about(Failure::Input(error.to_string())))?;
    let place = options.results(&input)?;
    let Some((rows, part)) = options.compute(&study, &place, quiet)? else {
        return Ok(());
    };
    let heading = Heading::of(&scenario, suite);
    finish(&heading, rows, &place, arguments.figure.get(), quiet)?;
    Ok(part.remove()?)
}

fn suite_of(scenario: &Scenario) -> Result<&Suite, Failure> {
    if scenario.initial.is_some() {
        let message = "the histories of a suite start from rest: leave [initial] out";
        return Err(Failure::Input(message.to_owned()));
    }
    scenario.suite.as_ref().ok_or_else(|| {
        let message = "the scenario has no [suite]: give it a table with records and levels, such as\n\n\
                       [suite]\n\
                       records = \"records/*.at2\"\n\
                       peaks_g = { from = 0.1, to = 2.0, count = 20, spacing = \"logarithmic\" }";
        Failure::Input(message.to_owned())
    })
}

/// The results of a suite whose rows are all there, from several parts of it; its records may be elsewhere.
pub fn merge(
    scenario: &str,
    rows: Vec<CaseRow>,
    place: &Destination,
    figure: Figure,
    quiet: bool,
) -> Result<(), Failure> {
    let heading = Heading::of_resolved(scenario).ok_or_else(|| {
        let message = "the scenario of the parts is damaged: compute them again";
        Failure::Input(message.to_owned())
    })?;
    finish(&heading, rows, place, figure, quiet)
}

/// Writes the results.
fn finish(
    heading: &Heading,
    rows: Vec<CaseRow>,
    place: &Destination,
    figure: Figure,
    quiet: bool,
) -> Result<(), Failure> {
    let results = SuiteFragility::new(heading.measure, rows);
    let files = [PICTURE, IDA, LEVELS, FRAGILITY, TABLE];
    let mut folder = place.open(&files)?;
    output::write_fragility(folder.file(LEVELS), heading, &results)?;
    for (name, text) in [
        (PICTURE, output::draw(figure, heading, &results)),
        (IDA, ida::draw(figure, heading, &results)),
        (FRAGILITY, pretty(&output::to_json(heading, &results)?)),
    ] {
        folder
            .file(name)
            .write_all(text.as_bytes())
            .map_err(|error| Failure::Work(format!("cannot write {name}: {error}")))?;
    }
    output::write_table(folder.file(TABLE), heading, &results.cases)?;
    folder.complete()?;
    if !quiet {
        say(&summary(&results));
        say(&format!(
            "  results in {}: {}",
            place.path().display(),
            files.join(", ")
        ));
    }
    Ok(())
}

/// What the results say, line by line.
fn summary(results: &SuiteFragility) -> String {
    let mut lines = vec![counted(results)];
    let column = results.measure.column();
    let curves = output::curves_in_words(results).into_iter();
    lines.extend(curves.map(|CurveInWords { taken, curve }| match curve {
        Ok(curve) => format!("fragility over {column}{taken}: {curve}"),
        Err(reason) => format!("no fragility curve{taken}: {reason}"),
    }));
    let unit = match results.measure {
        Measure::Scale => "",
        Measure::PeakG => " g",
    };
    for record in results.survivals() {
        let mirrored = if record.mirrored { " mirrored" } else { "" };
        let words = survival::in_words(&record.survival, unit);
        lines.push(format!("{}{mirrored}: {words}", record.record));
    }
    if results.cases.iter().any(CaseRow::still_rocking) {
        lines.push(
            "those still rocking at duration_s of [simulation] count as not overturned".to_owned(),
        );
    }
    let remarks = output::remarks(results);
    lines.extend(uncertain_in_words(&remarks.uncertain, FRAGILITY));
    if let Some(words) = failed_in_words(&remarks.failures, FRAGILITY) {
        lines.push(format!("{words}; what failed does not count"));
    }
    lines.join("\n  ")
}

/// How many cases came to what.
fn counted(results: &SuiteFragility) -> String {
    let words = |case: &CaseRow| case.result.as_ref().map_or((5, "failed"), in_words);
    format!(
        "{} cases of {}: {}",
        results.cases.len(),
        output::records_in_words(results),
        counts(results.cases.iter().map(words))
    )
}
