//! The command `suite`.

use std::io::Write as _;
use std::path::Path;

use archrock::output::part::{Header, Rows};
use archrock::output::suite::{self as output, Results};
use archrock::output::{Folder, verdict};
use archrock::scenario::{Scenario, Shakes};

use super::Failure;
use super::commands::pretty;
use super::study::{Options, say};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    options: Options,
}

/// Name of the study in its parts.
pub const STUDY: &str = "suite";

const PICTURE: &str = "suite.svg";
const LEVELS: &str = "fragility.csv";
const FRAGILITY: &str = "fragility.json";
/// Written last: a folder that has it is complete.
const TABLE: &str = "suite.csv";

pub fn suite(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let options = &arguments.options;
    let scenario = Scenario::read(&options.scenario)?;
    let shakes = shakes(&scenario).map_err(|failure| options.about_scenario(failure))?;
    let text = scenario.to_toml();
    let header = Header::new(STUDY, text.clone(), shakes.inputs(), shakes.count());
    let row = |index| output::row(&shakes, index);
    let Some(computed) = options.compute(header, quiet, row)? else {
        return Ok(());
    };
    finish(&text, &computed.rows, &options.folder(), quiet)?;
    computed.remove_part()
}

fn shakes(scenario: &Scenario) -> Result<Shakes<'_>, Failure> {
    if scenario.initial.is_some() {
        let message = "the histories of a suite start from rest: leave [initial] out";
        return Err(Failure::Input(message.to_owned()));
    }
    let suite = scenario.suite.as_ref().ok_or_else(|| {
        let message = "the scenario has no [suite]: give it a table with records and levels, such as\n\n\
                       [suite]\n\
                       records = \"records/*.at2\"\n\
                       peaks_g = { from = 0.1, to = 2.0, count = 20, spacing = \"logarithmic\" }";
        Failure::Input(message.to_owned())
    })?;
    Shakes::new(scenario, suite).map_err(|error| Failure::Input(error.to_string()))
}

/// Writes the results of a suite whose rows are all there, from one part or from several; the scenario is
/// that of their header.
pub fn finish(scenario: &str, rows: &Rows, path: &Path, quiet: bool) -> Result<(), Failure> {
    let results = Results::of(scenario, rows).ok_or_else(|| {
        let message = "the rows of the suite are damaged: compute it again without --resume";
        Failure::Input(message.to_owned())
    })?;
    let files = [PICTURE, LEVELS, FRAGILITY, TABLE];
    let mut folder = Folder::open(path, &files)?;
    results.write_levels(folder.file(LEVELS))?;
    for (name, text) in [
        (PICTURE, results.draw()),
        (FRAGILITY, pretty(&results.to_json()?)),
    ] {
        folder
            .file(name)
            .write_all(text.as_bytes())
            .map_err(|error| Failure::Work(format!("cannot write {name}: {error}")))?;
    }
    output::write_table(folder.file(TABLE), rows)?;
    folder.complete()?;
    if !quiet {
        say(&summary(&results));
        say(&format!(
            "  results in {}: {}",
            path.display(),
            files.join(", ")
        ));
    }
    Ok(())
}

/// What the results say, line by line.
fn summary(results: &Results) -> String {
    let mut lines = vec![counts(results)];
    lines.push(match results.curve_in_words() {
        Some(words) => format!("fragility over {}: {words}", results.measure.column()),
        None => format!(
            "no fragility curve: {}",
            results.no_fit().unwrap_or_default()
        ),
    });
    for (overturned, how) in [(false, "never"), (true, "always")] {
        let records = results.always(overturned);
        if !records.is_empty() {
            lines.push(format!("{how} overturn: {}", records.join(", ")));
        }
    }
    if results.outcome_count("still_rocking") > 0 {
        lines.push(
            "those still rocking at duration_s of [simulation] count as not overturned".to_owned(),
        );
    }
    if let Some(first) = results.first_failed() {
        lines.push(format!(
            "those that failed do not count; the first: {first}: `archrock run` says why"
        ));
    }
    lines.join("\n  ")
}

/// How many cases came to what.
fn counts(results: &Results) -> String {
    let outcomes = [
        ("never_moved", "never move"),
        ("rest", "come to rest"),
        ("overturned", "overturn"),
        ("still_rocking", "are still rocking"),
        (verdict::FAILED, "failed"),
    ];
    let counts: Vec<_> = outcomes
        .into_iter()
        .map(|(outcome, label)| (results.outcome_count(outcome), label))
        .filter(|(count, _)| *count > 0)
        .map(|(count, label)| format!("{count} {label}"))
        .collect();
    format!(
        "{} cases of {}: {}",
        results.count(),
        results.records_in_words(),
        counts.join(", ")
    )
}
