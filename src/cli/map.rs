//! The command `map`.

use std::io::Write as _;
use std::path::Path;

use archrock::output::part::{Header, Rows};
use archrock::output::{Folder, map as output, verdict};
use archrock::scenario::{Boundary, Cell, Cells, Quantity, Scenario};
use rayon::iter::{IndexedParallelIterator as _, IntoParallelIterator as _, ParallelIterator as _};

use super::Failure;
use super::study::{Options, say, write_summary};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    boundary: BoundaryOption,
}

/// What the results of a map may have besides.
#[derive(clap::Args, Clone, Copy)]
pub struct BoundaryOption {
    /// Write the least amplitude that overturns without impact as well, as no_impact.csv.
    #[arg(long)]
    no_impact: bool,
}

/// Name of the study in its parts.
pub const STUDY: &str = "map";

const PICTURE: &str = "map.svg";
const SUMMARY: &str = "map.json";
const BOUNDARY: &str = "no_impact.csv";
/// Written last: a folder that has it is complete.
const TABLE: &str = "map.csv";

pub fn map(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let options = &arguments.options;
    let scenario = Scenario::read(&options.scenario)?;
    let cells = cells(&scenario).map_err(|failure| options.about_scenario(failure))?;
    arguments.boundary.check(&cells)?;
    let header = Header::new(STUDY, scenario.to_toml(), Vec::new(), cells.count());
    let row = |index| output::row(&cells, index);
    let Some(computed) = options.compute(header, quiet, row)? else {
        return Ok(());
    };
    options.on_threads(|| {
        let folder = options.folder();
        finish(
            &scenario,
            &computed.rows,
            &folder,
            arguments.boundary,
            quiet,
        )
    })??;
    computed.remove_part()
}

fn cells(scenario: &Scenario) -> Result<Cells<'_>, Failure> {
    if scenario.initial.is_some() {
        let message = "the histories of a map start from rest: leave [initial] out";
        return Err(Failure::Input(message.to_owned()));
    }
    Cells::new(scenario).ok_or_else(|| {
        let message = "the scenario has no [map]: give it a table with two axes, such as\n\n\
                       [map]\n\
                       duration_s = { from = 0.05, to = 1.0, count = 40 }\n\
                       amplitude_g = { from = 0.1, to = 1.5, count = 40 }";
        Failure::Input(message.to_owned())
    })
}

impl BoundaryOption {
    fn check(self, cells: &Cells<'_>) -> Result<(), Failure> {
        if has_boundary(cells) {
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

/// The amplitude, where it is one of the axes, goes upwards.
fn has_boundary(cells: &Cells<'_>) -> bool {
    cells.axes()[1].quantity == Quantity::Amplitude
}

/// The results of a map whose rows are all there, from a part of it or from several.
pub fn merge(
    scenario: &str,
    rows: &Rows,
    folder: &Path,
    boundary: BoundaryOption,
    quiet: bool,
) -> Result<(), Failure> {
    let scenario = Scenario::parse(scenario, "the scenario of the parts")?;
    boundary.check(&cells(&scenario)?)?;
    finish(&scenario, rows, folder, boundary, quiet)
}

/// Writes the results.
fn finish(
    scenario: &Scenario,
    rows: &Rows,
    path: &Path,
    boundary: BoundaryOption,
    quiet: bool,
) -> Result<(), Failure> {
    let cells = cells(scenario)?;
    let along_x = if has_boundary(&cells) {
        cells.values()[0].len()
    } else {
        0
    };
    let found: Vec<_> = (0..along_x)
        .into_par_iter()
        .with_max_len(1)
        .map(|x| cells.boundary(x))
        .collect();
    let failed = found.iter().filter_map(|found| found.as_ref().err()).next();
    let failed = failed.map(ToString::to_string);
    let boundaries: Vec<Boundary> = found.into_iter().filter_map(Result::ok).flatten().collect();
    let mut files = vec![PICTURE, SUMMARY, TABLE];
    if boundary.no_impact {
        files.insert(0, BOUNDARY);
    }
    let mut folder = Folder::open(path, &files)?;
    if boundary.no_impact {
        output::write_boundaries(folder.file(BOUNDARY), &cells, &boundaries)?;
    } else {
        folder.forget(BOUNDARY);
    }
    let title = scenario.title.as_deref().unwrap_or("Overturning map");
    let picture = output::draw(title, &cells, rows, &boundaries);
    folder
        .file(PICTURE)
        .write_all(picture.as_bytes())
        .map_err(|error| Failure::Work(format!("cannot write the picture: {error}")))?;
    write_summary(folder.file(SUMMARY), scenario, rows)?;
    output::write_table(folder.file(TABLE), &cells, rows)?;
    folder.complete()?;
    if !quiet {
        say(&summary(&cells, rows));
        if let Some(error) = failed {
            say(&format!("  the boundary without impact has gaps: {error}"));
        }
        say(&format!(
            "  results in {}: {}",
            path.display(),
            files.join(", ")
        ));
    }
    Ok(())
}

/// How many cells came to what, and why some to nothing.
fn summary(cells: &Cells<'_>, rows: &Rows) -> String {
    let counts = output::counts(rows);
    let outcomes = [
        ("never_moved", "never move"),
        ("rest", "come to rest"),
        ("overturned", "overturn"),
        (
            "still_rocking",
            "are still rocking at duration_s of [simulation]",
        ),
        ("cannot_stand", "cannot stand"),
        ("not_four_links", "are too thick for four links"),
        (verdict::FAILED, "failed"),
    ];
    let parts: Vec<_> = outcomes
        .into_iter()
        .filter_map(|(outcome, label)| Some(format!("{} {label}", counts.get(outcome)?)))
        .collect();
    let mut text = format!("{} cells: {}", rows.len(), parts.join(", "));
    let reason = rows.iter().find_map(|(index, row)| {
        (output::outcome(row) == verdict::FAILED).then(|| cells.cell(*index))
    });
    if let Some(Cell::Failed(error)) = reason {
        text += &format!("; the first that failed: {error}");
    }
    text
}
