//! The command `merge`.

use std::path::{Path, PathBuf};

use archrock::output::part;

use super::Failure;
use super::map::{self, BoundaryOption};
use super::spectrum;
use super::suite;

#[derive(clap::Args)]
pub struct Arguments {
    /// The parts of one study, all of them.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// Folder for the results [default: that of the first part].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    boundary: BoundaryOption,
}

pub fn merge(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let (header, rows) = part::merge(&arguments.parts)?;
    let beside = arguments.parts[0].parent();
    let beside = beside.filter(|folder| !folder.as_os_str().is_empty());
    let beside = beside.unwrap_or(Path::new("."));
    let folder = arguments.out.as_deref().unwrap_or(beside);
    match header.study.as_str() {
        map::STUDY => map::merge(&header.scenario, &rows, folder, arguments.boundary, quiet),
        spectrum::STUDY => {
            arguments.boundary.refuse()?;
            spectrum::merge(&header.scenario, &rows, folder, quiet)
        }
        suite::STUDY => {
            arguments.boundary.refuse()?;
            suite::finish(&header.scenario, &rows, folder, quiet)
        }
        study => Err(Failure::Input(format!(
            "parts of a study that this program does not know: {study:?}"
        ))),
    }
}
