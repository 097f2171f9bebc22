//! The command `merge`.

use std::path::{Path, PathBuf};

use archrock::studies::boundary::MapWithBoundary;
use archrock::studies::part;
use archrock::studies::runner::Study as _;
use archrock::studies::spectrum::OverturningSpectrum;
use archrock::studies::suite::RecordSuite;

use super::Failure;
use super::figure::FigureOption;
use super::map::{self, BoundaryOption, LookOption};
use super::scenario_file::Destination;
use super::spectrum;
use super::suite;

#[derive(clap::Args)]
pub struct Arguments {
    /// All parts of one study.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// Folder for the results [default: that of the first part].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    boundary: BoundaryOption,
    #[command(flatten)]
    figure: FigureOption,
    #[command(flatten)]
    look: LookOption,
}

pub fn merge(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let (parts, figure) = (&arguments.parts, arguments.figure.get());
    let beside = parts[0].parent();
    let beside = beside.filter(|folder| !folder.as_os_str().is_empty());
    let beside = beside.unwrap_or(Path::new("."));
    let place = Destination::of(arguments.out.as_deref().unwrap_or(beside));
    match part::read_header(&parts[0])?.study.as_str() {
        MapWithBoundary::NAME => {
            let (header, rows) = part::merge(parts)?;
            map::merge(
                &header.scenario,
                rows,
                &place,
                (arguments.boundary, arguments.look),
                figure,
                quiet,
            )
        }
        OverturningSpectrum::NAME => {
            arguments.boundary.refuse()?;
            arguments.look.refuse()?;
            let (header, rows) = part::merge(parts)?;
            spectrum::merge(&header.scenario, &rows, &place, figure, quiet)
        }
        RecordSuite::NAME => {
            arguments.boundary.refuse()?;
            arguments.look.refuse()?;
            let (header, rows) = part::merge(parts)?;
            suite::merge(&header.scenario, rows, &place, figure, quiet)
        }
        study => Err(Failure::Input(format!(
            "unknown study {study:?}: merge with the version of archrock that wrote the parts"
        ))),
    }
}
