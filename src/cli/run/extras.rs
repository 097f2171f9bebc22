//! What `run` writes beside tables and history: the page, snapshots and poses.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use archrock::dynamics::history::Sample;
use archrock::output::poses::PosesWriter;
use archrock::output::report::Report;
use archrock::output::scene::Scene;
use archrock::output::snapshots::Snapshots;
use archrock::output::{Figure, Folder, OutputError};
use archrock::scenario::Scenario;

use super::cannot_write;
use crate::cli::Failure;

/// A page with the structure in motion.
pub const REPORT: &str = "report.html";
/// The deformed structure at chosen times.
pub const SNAPSHOTS: &str = "snapshots.svg";
/// Where every body is.
pub const POSES: &str = "poses.csv";

/// What is asked for.
#[derive(clap::Args, Clone, Debug)]
pub struct Options {
    /// Write no report.html.
    #[arg(long)]
    no_report: bool,
    /// Draw the deformed structure at these times, in seconds, to snapshots.svg; each shows the nearest row of the
    /// rotations.
    #[arg(long, value_name = "T1,T2,...", value_delimiter = ',', value_parser = time_s, allow_negative_numbers = true)]
    snapshots: Vec<f64>,
    /// Displacements in the snapshots are drawn so many times as large.
    #[arg(long, value_name = "K", default_value_t = 1.0, value_parser = factor, requires = "snapshots", allow_negative_numbers = true)]
    exaggerate: f64,
    /// Write position and rotation of every body to poses.csv.
    #[arg(long)]
    poses: bool,
}

fn time_s(text: &str) -> Result<f64, String> {
    let time_s = text
        .parse()
        .ok()
        .filter(|time_s| (0.0..=1e9).contains(time_s));
    time_s.ok_or_else(|| "give times in seconds from 0 on, such as 0.2,0.5,1.0".to_owned())
}

fn factor(text: &str) -> Result<f64, String> {
    let factor = text
        .parse()
        .ok()
        .filter(|factor| (1e-3..=1e6).contains(factor));
    factor.ok_or_else(|| "give a factor from 0.001 to 1000000, such as 10".to_owned())
}

impl Options {
    /// All files that may be asked for.
    pub const FILES: [&str; 3] = [REPORT, SNAPSHOTS, POSES];

    /// The files that are asked for.
    pub fn files(&self) -> impl Iterator<Item = &'static str> {
        let asked = [!self.no_report, !self.snapshots.is_empty(), self.poses];
        Self::FILES
            .into_iter()
            .zip(asked)
            .filter_map(|(file, asked)| asked.then_some(file))
    }

    /// Refuses files where there is no folder for them.
    pub fn check_folder(&self) -> Result<(), Failure> {
        let option = match (self.snapshots.is_empty(), self.poses) {
            (false, _) => "--snapshots",
            (true, true) => "--poses",
            (true, false) => return Ok(()),
        };
        let message = format!("{option} writes a file: name a folder for it with --out");
        Err(Failure::Input(message))
    }
}

/// Collects samples for page and snapshots.
pub struct Extras {
    report: Option<Report>,
    snapshots: Option<Snapshots>,
}

impl Extras {
    /// Nothing where there is no folder.
    pub fn new(
        options: &Options,
        folder: Option<&Folder>,
        scene: &Scene,
        bodies: &[String],
        gravity_m_s2: f64,
    ) -> Self {
        let report = folder.is_some() && !options.no_report;
        let snapshots = folder.is_some() && !options.snapshots.is_empty();
        Self {
            report: report.then(|| Report::new(scene.clone(), bodies, gravity_m_s2)),
            snapshots: snapshots
                .then(|| Snapshots::new(scene.clone(), &options.snapshots, options.exaggerate)),
        }
    }

    /// Whether samples are to come with the line of thrust.
    pub const fn want_thrust_line(&self) -> bool {
        self.report.is_some() || self.snapshots.is_some()
    }

    pub fn push(&mut self, sample: &Sample) {
        if let Some(report) = &mut self.report {
            report.push(sample);
        }
        if let Some(snapshots) = &mut self.snapshots {
            snapshots.push(sample);
        }
    }

    /// Writes page and snapshots of a scenario, with what was said of its run; adds to that what is to be said of them.
    pub fn write(
        &self,
        folder: &mut Folder,
        scenario: &Scenario,
        (figure, title): (Figure, &str),
        said: &mut String,
    ) -> Result<(), Failure> {
        if let Some(report) = &self.report {
            let page = report.page(scenario, scenario.ground_motion(), said);
            folder
                .file(REPORT)
                .write_all(page.as_bytes())
                .map_err(cannot_write("the report"))?;
        }
        if let Some(snapshots) = &self.snapshots {
            folder
                .file(SNAPSHOTS)
                .write_all(snapshots.draw(figure, title).as_bytes())
                .map_err(cannot_write("the snapshots"))?;
            let beyond: Vec<_> = snapshots.beyond_s().iter().map(f64::to_string).collect();
            if !beyond.is_empty() {
                let _ = writeln!(
                    said,
                    "  snapshots at {} s are after the end: they show its last instant",
                    beyond.join(", ")
                );
            }
        }
        Ok(())
    }
}

/// A file of results, whatever it is.
pub type File<'a> = Box<dyn io::Write + 'a>;

/// The table of poses, where it is asked for.
pub struct PosesTable<'a>(Option<PosesWriter<File<'a>>>);

impl<'a> PosesTable<'a> {
    pub fn new(file: Option<File<'a>>, bodies: &[String]) -> Result<Self, OutputError> {
        let writer = file.map(|file| PosesWriter::new(file, bodies));
        Ok(Self(writer.transpose()?))
    }

    pub fn write(&mut self, sample: &Sample) -> Result<(), OutputError> {
        self.0
            .as_mut()
            .map_or(Ok(()), |writer| writer.write(sample))
    }

    pub fn finish(self) -> Result<(), OutputError> {
        self.0.map_or(Ok(()), PosesWriter::finish)
    }
}
