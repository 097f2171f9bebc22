//! The command `chart`.

use std::io::Write as _;
use std::path::PathBuf;

use archrock::mechanics::four_link::limit::least_thickness_ratio;
use archrock::output::chart;
use archrock::scenario::Structure;
use archrock::studies::survey::shape_results;

use super::figure::FigureOption;
use super::scenario_file::ScenarioFile;
use super::study::say;
use super::{Failure, commands};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    figure: FigureOption,
}

const PICTURE: &str = "chart.svg";
/// Written last: a folder that has it is complete.
const TABLE: &str = "chart.csv";

/// Embrace angles charted beside that of the scenario, in degrees.
const EMBRACES_DEG: [f64; 5] = [180.0, 170.0, 157.5, 140.0, 120.0];

/// Thickness ratios of a curve, from the thinnest arch that stands to the thickest charted.
const THICKNESSES: u32 = 24;

/// Largest thickness ratio charted, unless the scenario's is larger.
const MAX_THICKNESS_RATIO: f64 = 0.3;

pub fn chart(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let input = arguments.scenario.open()?;
    let scenario = input.read(None)?;
    let Structure::Arch(arch) = &scenario.structure else {
        let message = "chart is for arches only; the scenario has a column";
        return Err(Failure::Input(message.to_owned()));
    };
    // An arch without results of its own is refused, with the reason.
    commands::model(&scenario)?;
    let place = input.results(arguments.out.as_deref())?;
    let mut folder = place.open(&[PICTURE, TABLE])?;
    let mut embraces_deg = EMBRACES_DEG.to_vec();
    if !embraces_deg.contains(&arch.embrace_deg()) {
        embraces_deg.push(arch.embrace_deg());
        embraces_deg.sort_by(|a, b| b.total_cmp(a));
    }
    let sites = arch.sites();
    let largest = MAX_THICKNESS_RATIO.max(arch.thickness_ratio());
    let shapes: Vec<(f64, f64)> = embraces_deg
        .into_iter()
        .flat_map(|embrace_deg| {
            let least = least_thickness_ratio(embrace_deg.to_radians(), sites, 1e-6)
                .expect("the scenario's embrace angle was checked, and the others are constants");
            thicknesses(least, largest).map(move |thickness_ratio| (embrace_deg, thickness_ratio))
        })
        .collect();
    let results = shape_results(&shapes, sites, scenario.impact);
    let own = [(arch.embrace_deg(), arch.thickness_ratio())];
    let own = shape_results(&own, sites, scenario.impact);
    chart::write_table(folder.file(TABLE), &results)?;
    folder
        .file(PICTURE)
        .write_all(chart::draw(arguments.figure.get(), &results, own.first()).as_bytes())
        .map_err(|error| Failure::Work(format!("cannot write the chart: {error}")))?;
    folder.complete()?;
    if !quiet {
        let count = results.len();
        say(&format!(
            "{count} arches in {}: {PICTURE}, {TABLE}",
            place.path().display()
        ));
    }
    Ok(())
}

/// From just above the least thickness ratio at which an arch stands to the largest charted.
fn thicknesses(least: f64, largest: f64) -> impl Iterator<Item = f64> {
    let least = 1.001 * least;
    let step = (largest - least) / f64::from(THICKNESSES - 1);
    (0..THICKNESSES).map(move |i| least + f64::from(i) * step)
}
